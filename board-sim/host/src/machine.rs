//! The board, the plant around it, and the wire between them and to everybody else.

use std::io::{self, Write as _};
use std::path::Path;
use std::time::{Duration, Instant};

use leadscrew::diagnostics::Diagnostic;
use leadscrew::failure::{Failure, Outcome};
use leadscrew::source::SourceFile;
use leadscrew::state::StateFile;
use leadscrew::words::Both;
use leadscrew_board_sim::plant::{Flash, Plant};
use leadscrew_board_sim::{keep, stored_params, stored_tap};
use leadscrew_core::alarm::{Alarm, Lang};
use leadscrew_core::board::{Board, Event, Output, PowerUp, State};
use leadscrew_core::bus::{Frame, NodeId, Periods, Service};
use leadscrew_core::signals::Signals;

use crate::cli;
use crate::program::Feeder;
use crate::when::Script;
use crate::wire::Wire;

/// A board and what is around it.
pub struct Machine {
    board: Board,
    /// What it keeps.
    flash: Flash,
    /// Where that is kept between runs.
    state: Option<StateFile>,
    plant: Plant,
    wire: Wire,
    script: Script,
    feeder: Option<Feeder>,
    output: Output,
    /// Drives' frames for the next tick.
    waiting: Vec<Frame>,
    /// Frames to be sent at once.
    out: Vec<Frame>,
    /// Nodes of the axis drives that are elsewhere.
    away: Vec<NodeId>,
    transmission: u8,
    tick_us: u32,
    /// Ticks since power-up.
    ticks: u64,
    /// The tick of the gateway's newest heartbeat, and when that was.
    beat: Option<(u64, Instant)>,
    /// Ticks without one after which it counts as lost; 0: never.
    silence: u64,
    /// Ticks up to and with tick 0: the first in which the machine is up and stands.
    up: Option<u64>,
    last: Option<u64>,
    late: u64,
    alarm: bool,
}

impl Machine {
    /// A machine at power-up.
    pub fn new(args: &cli::Board) -> Outcome<Self> {
        let built_in = args.common.load()?;
        let unusable = |why: String| Failure::WrongBecause(Both::same(why));
        let options = args
            .plant()
            .ok_or_else(|| unusable("the spindle cannot have this ripple".into()))?;
        let no_board = |alarm: Alarm| unusable(words(&alarm, None));
        let state = args.state.as_deref().map(StateFile::new);
        let mut flash = match &state {
            Some(state) => state.load_or_new()?,
            None => Flash::erased(),
        };
        flash.power(true);
        let tap = stored_tap(&mut flash).map_err(no_board)?;
        let up = match &state {
            Some(_) => stored_params(&mut flash, &built_in).map_err(no_board)?,
            None => PowerUp::given(&built_in),
        };
        let params = &up.params;
        let plant = Plant::new(params, &options).map_err(|error| {
            unusable(format!(
                "the parameters make no simulated machine: {error:?}"
            ))
        })?;
        let mut board = Board::power_up(&up, Some(options.at), tap).map_err(no_board)?;
        let node = NodeId::new(args.node).unwrap_or(NodeId::BOARD);
        board.join(node).map_err(no_board)?;
        let mut signals = Signals::default();
        for set in &args.signal {
            signals.set(set.signal, set.level);
        }
        board.signals(signals);
        let feeder = match &args.program {
            Some(path) => Some(Feeder::open(path, params, options.at)?),
            None => None,
        };
        let nodes = [NodeId::DRIVE_X, NodeId::DRIVE_Z, NodeId::DRIVE_C];
        let away: Vec<NodeId> = nodes
            .into_iter()
            .zip(options.away)
            .filter_map(|(node, away)| away.then_some(node))
            .collect();
        let silence = u64::from(params.gateway_silence_ms()) * 1000 / u64::from(params.tick_us());
        let wire = Wire::open(args.common.address(), params, args.lose, args.seed)?;
        say(&format!(
            "node {} on {}, tick {} µs, {}{}",
            args.node,
            wire.name(),
            params.tick_us(),
            if args.lockstep {
                "virtual time"
            } else {
                "real time"
            },
            if away.is_empty() {
                ""
            } else {
                ", drives elsewhere"
            }
        ));
        Ok(Self {
            board,
            flash,
            state,
            plant,
            wire,
            script: Script {
                troubles: args.trouble.clone(),
                slips: args.slip.clone(),
                lost_index: args.lost_index,
                drags: args.drag.clone(),
            },
            feeder,
            output: Output::default(),
            waiting: Vec::new(),
            out: Vec::new(),
            away,
            transmission: args.common.transmission,
            tick_us: params.tick_us(),
            ticks: 0,
            beat: None,
            silence,
            up: None,
            last: args.ticks,
            late: 0,
            alarm: false,
        })
    }

    /// The time between two SYNCs.
    pub fn period(&self) -> Duration {
        Duration::from_micros(u64::from(self.tick_us))
    }

    /// Ticks behind tick 0; `None` before it.
    pub fn since_up(&self) -> Option<u64> {
        self.ticks.checked_sub(self.up?)
    }

    /// Nodes of the axis drives that are elsewhere.
    pub fn away(&self) -> &[NodeId] {
        &self.away
    }

    /// They answer every so many SYNCs.
    pub const fn transmission(&self) -> u8 {
        self.transmission
    }

    /// A setpoint came late for its SYNC.
    pub fn note_late(&mut self) {
        self.late += 1;
        self.board
            .set_late(u32::try_from(self.late).unwrap_or(u32::MAX));
    }

    /// Takes what is on the wire, waiting for it at most so long; true where there was anything. Requests are answered at
    /// once.
    pub fn listen(&mut self, patience: Duration) -> Outcome<bool> {
        let (board, waiting, away) = (&mut self.board, &mut self.waiting, &self.away);
        let plant = &mut self.plant;
        let mut answers = Vec::new();
        let mut beat = false;
        let count = self.wire.listen(patience, |frame| {
            beat |= frame.id().service() == Some((Service::Heartbeat, NodeId::GATEWAY));
            plant.hear(frame, |answer| answers.push(answer));
            if board.receive(frame)
                && let Some((_, node)) = frame.id().service()
                && away.contains(&node)
            {
                waiting.push(*frame);
            }
        })?;
        if beat {
            self.beat = Some((self.ticks, Instant::now()));
        }
        self.wire.send(&answers)?;
        if count > 0 {
            self.keep()?;
            self.serve(0)?;
        }
        Ok(count > 0)
    }

    /// True where the gateway would soon count as lost in virtual time, and has been heard within this real time.
    pub fn outruns_gateway(&self, patience: Duration) -> bool {
        self.beat.is_some_and(|(tick, when)| {
            self.silence > 0
                && self.ticks.saturating_sub(tick) > self.silence / 2
                && when.elapsed() < patience
        })
    }

    /// True where this drive's status is among what waits for the next tick.
    pub fn has_status_of(&self, node: NodeId) -> bool {
        self.waiting
            .iter()
            .any(|frame| frame.id().service() == Some((Service::Tpdo1, node)))
    }

    /// Lets the station and the background go on until there is nothing left to do, and sends what they have to say.
    fn serve(&mut self, elapsed: u32) -> Outcome {
        let mut elapsed = Periods::new(elapsed);
        loop {
            let mut worked = self.board.serve(elapsed, &self.output.setpoint);
            elapsed = Periods::new(0);
            worked |= self.feed()?;
            while self.board.background() {
                worked = true;
            }
            if !worked {
                break;
            }
        }
        self.out.clear();
        while let Some(frame) = self.board.transmit() {
            self.out.push(frame);
        }
        self.wire.send(&self.out)
    }

    fn feed(&mut self) -> Outcome<bool> {
        let up = self.since_up().is_some();
        let Some(feeder) = self.feeder.as_mut().filter(|_| up) else {
            return Ok(false);
        };
        feeder.feed(&mut self.board).map_err(|alarm| {
            Failure::WrongBecause(Both::same(words(&alarm, Some(feeder.source()))))
        })
    }

    /// One SYNC period.
    pub fn tick(&mut self) -> Outcome {
        if let Some(tick) = self.since_up() {
            self.script.act(tick + 1, &mut self.plant);
        }
        let sample = self.plant.advance();
        self.board.tick(sample, &self.waiting, &mut self.output);
        self.keep()?;
        self.ticks += 1;
        self.waiting.clear();
        self.out.clear();
        self.out.extend_from_slice(&self.output.frames);
        let waiting = &mut self.waiting;
        self.plant
            .exchange(&self.output.frames, |frame| waiting.push(frame));
        self.out.extend_from_slice(&self.waiting);
        self.wire.send(&self.out)?;
        while let Some(event) = self.board.event() {
            self.tell(&event);
        }
        self.serve(1)
    }

    /// Carries out the writes that the board asks for; what has changed is in the file before anything else happens.
    fn keep(&mut self) -> Outcome {
        let before = self.flash.written();
        keep(&mut self.board, &mut self.flash);
        match &self.state {
            Some(state) if self.flash.written() != before => state.save(&self.flash),
            _ => Ok(()),
        }
    }

    fn tell(&mut self, event: &Event) {
        let source = self.feeder.as_ref().map(Feeder::source);
        match event {
            // The tick after this one is tick 0: the axes stand, and nothing has been handed over yet.
            Event::Ready if self.up.is_none() => {
                self.up = Some(self.ticks + 1);
                say("ready");
            }
            Event::Alarm(alarm) => {
                self.alarm = true;
                say(&format!("alarm: {}", words(alarm, source)));
            }
            Event::Warning(alarm) => say(&format!("warning: {}", words(alarm, source))),
            Event::Reset => {
                self.alarm = false;
                say("reset");
            }
            _ => {}
        }
    }

    /// A program is being carried out, or waits to be.
    pub fn is_busy(&self) -> bool {
        self.board.is_busy() || self.board.ticker().in_program() || self.is_feeding()
    }

    fn is_feeding(&self) -> bool {
        !self.alarm && self.feeder.as_ref().is_some_and(|feeder| !feeder.is_over())
    }

    /// A program is under way, there is room for more of it, and it has not come yet.
    pub fn awaits_program(&self) -> bool {
        self.board.awaits_program()
    }

    /// The machine stands and waits for somebody.
    pub fn is_held(&self) -> bool {
        matches!(self.board.ticker().state(), State::Held)
    }

    /// What it was started for is done.
    pub fn is_over(&self) -> bool {
        let ran = self.feeder.is_some()
            && self.since_up().is_some()
            && (self.alarm && !self.board.is_busy() || !self.is_busy());
        ran || self.last.is_some_and(|last| self.ticks >= last)
    }

    /// Sums up.
    pub fn conclude(&self) -> Outcome {
        let [sent, received, lost] = self.wire.counts;
        say(&format!(
            "{} ticks, {} setpoints late, {sent} frames sent, {received} received, {} dropped{}",
            self.ticks,
            self.late,
            self.wire.dropped(),
            if lost > 0 {
                format!(", {lost} lost by intent")
            } else {
                String::new()
            }
        ));
        if self.alarm && self.feeder.is_some() {
            return Err(Failure::Machine);
        }
        Ok(())
    }
}

/// An alarm in words.
fn words(alarm: &Alarm, source: Option<&SourceFile>) -> String {
    let nowhere = SourceFile::new(Path::new("the board"));
    let source = source.unwrap_or(&nowhere);
    let diagnostic = Diagnostic::new(alarm, source, Lang::En, false);
    match alarm.span.line {
        0 => diagnostic.message,
        line => format!("{}:{line}: {}", source.name(), diagnostic.message),
    }
}

/// Tells the user.
pub fn say(text: &str) {
    // A closed standard error leaves nobody to tell.
    let _ = writeln!(io::stderr(), "board-sim: {text}");
}
