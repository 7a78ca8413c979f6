//! The board, the plant around it, and the wire between them and to other nodes.

use std::io::{self, Write as _};
use std::path::Path;
use std::time::{Duration, Instant};

use leadscrew_board_sim::line::{Line, Span, Way};
use leadscrew_board_sim::plant::{Flash, Plant, PlantError, PlantOptions};
use leadscrew_board_sim::{
    Around, Wheel, count_start, keep, show_pins, stored_params, stored_start, stored_tap,
};
use leadscrew_can::MachineName;
use leadscrew_common::diagnostics::Diagnostic;
use leadscrew_common::failure::{Failure, Outcome};
use leadscrew_common::profiles::Chosen;
use leadscrew_common::source::SourceFile;
use leadscrew_common::state::StateFile;
use leadscrew_common::words::Both;
use leadscrew_core::alarm::{Alarm, Lang};
use leadscrew_core::board::{Board, DriveNodes, Event, Output, PowerUp, State};
use leadscrew_core::bus::{BusState, Frame, NmtCommand, NodeId, Service};
use leadscrew_core::call::Position;
use leadscrew_core::params::Params;
use leadscrew_core::signals::Signals;
use leadscrew_core::units::Axis;
use leadscrew_desk::clock::Speed;
use leadscrew_desk::hand::Contacts;

use self::handled::fitted;
use crate::claim::Claim;
use crate::cli;
use crate::hand::Hand;
use crate::program::Feeder;
use crate::when::Script;
use crate::wire::{Heard, Wire};

/// A board and its surroundings.
pub struct Machine {
    board: Board,
    /// The board's flash.
    flash: Flash,
    /// The file that keeps the flash between runs.
    state: Option<StateFile>,
    plant: Plant,
    /// How the plant is made when its power comes.
    options: PlantOptions,
    drives: Chosen,
    /// Neither board nor drives have power: somebody has switched it off.
    unplugged: bool,
    /// What is pressed or open, and what is around the board.
    contacts: Contacts,
    around: Around,
    wheel: Wheel,
    speed: Speed,
    hand: Option<Hand>,
    wire: Wire,
    line: Line,
    script: Script,
    /// The ticks in which the board has no power.
    cut: Option<Span>,
    node: NodeId,
    /// The board's serial number: a machine with a name has one.
    serial: u32,
    signals: Signals,
    /// The parameter set of a board without stored parameters.
    built_in: Params,
    feeder: Option<Feeder>,
    /// The ticks in which the feeder gives nothing.
    stall: Option<Span>,
    /// The version that the board claims.
    claim: Option<Claim>,
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
    /// The tick of the gateway's newest heartbeat, and its real time.
    beat: Option<(u64, Instant)>,
    /// Ticks without a heartbeat after which the gateway counts as lost; 0: never.
    silence: u64,
    /// Ticks up to and including tick 0: the first tick in which the machine is up and stands.
    up: Option<u64>,
    last: Option<u64>,
    late: u64,
    alarm: bool,
    /// The controller of the wire has left the bus.
    off: Option<Off>,
}

/// A controller that has left the bus.
#[derive(Clone, Copy, Debug, Default)]
struct Off {
    /// The controller waits for a silent bus since this tick, at which its restart was permitted.
    waits: Option<u64>,
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
        let mut up = match &state {
            Some(_) => stored_params(&mut flash, &built_in).map_err(no_board)?,
            None => PowerUp::given(&built_in),
        };
        up.start = count_start(&mut flash);
        if let Some(state) = &state {
            state.save(&flash)?;
        }
        if let Some(writes) = args.spoil.flash_fails {
            flash.fail_after(writes);
        }
        if let Some(pages) = args.spoil.flash_worn {
            flash.wear_out_after(pages);
        }
        if let Some(torn) = args.spoil.torn_write {
            flash.set_tear(torn.tear);
            flash.cut_after(torn.bytes);
        }
        let params = &up.params;
        let drives = args.common.drives()?;
        let options = PlantOptions {
            servos: drives.servos(params)?,
            ..options
        };
        let plant = fitted(params, &options)?;
        let mut board = Board::power_up(&up, Some(options.at), tap).map_err(no_board)?;
        let node = args.node;
        let serial = args.name.as_ref().map_or(0, MachineName::serial);
        board.set_serial(serial);
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
        let nodes = DriveNodes::of(params);
        let away: Vec<NodeId> = Axis::ALL
            .into_iter()
            .zip(options.away)
            .filter_map(|(axis, away)| away.then_some(nodes.axis(axis)))
            .collect();
        let silence = u64::from(params.gateway_silence_ms()) * 1000 / u64::from(params.tick_us());
        let hand = args.name.as_ref().map(Hand::open).transpose()?;
        let wire = Wire::open(args.common.address(), params)?;
        say(&format!(
            "node {} on {}, tick {} µs, {}{}",
            node.get(),
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
            options,
            drives,
            unplugged: false,
            contacts: Contacts::default(),
            around: Around::default(),
            wheel: Wheel::default(),
            speed: Speed::REAL,
            hand,
            wire,
            line: Line::new(args.spoil.faults(args.seed, &nodes)),
            cut: args.spoil.cut_power.map(|ticks| ticks.0),
            node,
            serial,
            signals,
            script: Script {
                troubles: args.trouble.clone(),
                slips: args.slip.clone(),
                lost_index: args.lost_index,
                drags: args.drag.clone(),
            },
            feeder,
            stall: args.stall.map(|ticks| ticks.0),
            claim: args.link_key.map(|key| Claim::new(node, key)),
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
            off: None,
            built_in,
        })
    }

    /// The real time between two SYNCs.
    pub fn period(&self) -> Duration {
        let real = Speed::REAL.thousandths();
        Duration::from_micros(u64::from(self.tick_us)) * real / self.speed.thousandths()
    }

    /// Ticks after tick 0; `None` before it.
    pub fn since_up(&self) -> Option<u64> {
        self.ticks.checked_sub(self.up?)
    }

    /// Nodes of the axis drives that are elsewhere.
    pub fn away(&self) -> &[NodeId] {
        &self.away
    }

    /// The drives answer at every n-th SYNC.
    pub const fn transmission(&self) -> u8 {
        self.transmission
    }

    /// Counts a setpoint that came late for its SYNC.
    pub fn note_late(&mut self) {
        self.late += 1;
        self.tell_late();
    }

    fn tell_late(&mut self) {
        let late = self.late + u64::from(self.line.harm().late);
        self.board.set_late(u32::try_from(late).unwrap_or(u32::MAX));
    }

    /// Reads the frames on the wire, and waits for one at most `patience`. True where there were any. Requests are
    /// answered at once.
    pub fn listen(&mut self, patience: Duration) -> Outcome<bool> {
        self.be_handled();
        let has_power = self.has_power();
        let (mut heard, mut heard_fd) = (Vec::new(), Vec::new());
        let line = &mut self.line;
        let count = self.wire.listen(patience, |sent| match sent {
            Heard::Frame(frame) => line.pass(Way::In, frame, |frame| heard.push(frame)),
            Heard::Fd(frame) => {
                line.pass_together(Way::In, frame, |frame| heard_fd.push(*frame));
            }
        })?;
        let mut beat = false;
        for frame in &heard {
            beat |= frame.id().service() == Some((Service::Heartbeat, NodeId::GATEWAY));
            self.hear(frame, has_power)?;
        }
        for frame in heard_fd.iter().filter(|_| !self.unplugged) {
            self.plant.tell_together(frame);
            if has_power {
                self.board.receive_fd(frame.id());
            }
        }
        if beat {
            self.beat = Some((self.ticks, Instant::now()));
        }
        if count > 0 && has_power {
            self.keep()?;
            if self.has_power() {
                self.serve()?;
            }
        }
        Ok(count > 0)
    }

    /// A frame of another node.
    fn hear(&mut self, frame: &Frame, has_power: bool) -> Outcome {
        if self.unplugged {
            return Ok(());
        }
        let mut answers = Vec::new();
        self.plant.hear(frame, |answer| answers.push(answer));
        if has_power
            && self.board.receive(frame)
            && let Some((_, node)) = frame.id().service()
            && self.away.contains(&node)
        {
            self.waiting.push(*frame);
        }
        self.wire.send(&answers)
    }

    /// Sends the waiting frames, as far as the faults of the wire permit.
    fn send(&mut self) -> Outcome {
        if self.line.is_quiet() {
            return self.wire.send(&self.out);
        }
        let mut left = Vec::new();
        for frame in &self.out {
            self.line.pass(Way::Out, frame, |frame| left.push(frame));
        }
        self.wire.send(&left)
    }

    /// False while the board's power is cut, or switched off.
    fn has_power(&self) -> bool {
        let tick = self.since_up();
        !self.unplugged && !tick.zip(self.cut).is_some_and(|(tick, cut)| cut.has(tick))
    }

    /// Applies the faults of the wire to this tick.
    fn suffer(&mut self, tick: u64) -> Outcome {
        let rejoin = self.board.device().may_rejoin();
        self.mind_controller(tick, rejoin);
        let second = self.line.tick(tick, rejoin);
        self.out.clear();
        self.out.extend(self.line.release(Way::Out));
        self.waiting.extend(self.line.release(Way::Statuses));
        if let Some(frame) = self.line.release(Way::In) {
            self.hear(&frame, true)?;
        }
        if let Some(frame) = second {
            self.out.push(frame);
            // `hear` passes no process data to the drives.
            if NmtCommand::decode(&frame).is_none() {
                let waiting = &mut self.waiting;
                self.plant.exchange(&[frame], |answer| waiting.push(answer));
            }
            self.hear(&frame, true)?;
        }
        self.wire.send(&self.out)?;
        self.tell_late();
        let of_line = self.line.controller();
        self.board.bus_state(match of_line.state {
            BusState::Active => self.wire.controller(),
            BusState::Passive | BusState::Off | BusState::Restricted => of_line,
        });
        Ok(())
    }

    /// Follows the controller of the wire, by its error frames. The kernel restarts a real controller by itself
    /// (restart-ms) or on request, and reports that. An interface without a controller gets a model of one: it may
    /// restart when the machine stands, and is back after 128 times 11 bits of a silent bus [D196].
    fn mind_controller(&mut self, tick: u64, rejoin: bool) {
        const BITS: u64 = 128 * 11;
        let name = self.wire.name();
        if self.wire.controller().state != BusState::Off {
            if self.off.take().is_some() {
                say(&format!(
                    "{name}: the controller is on the bus again; the alarm waits for a reset"
                ));
            }
            return;
        }
        let Some(off) = &mut self.off else {
            let then = if self.wire.is_virtual() {
                "it is started again when the machine stands".to_owned()
            } else {
                format!(
                    "the kernel starts it again if the interface has a restart-ms, else `ip link set {name} type can restart` \
                     does, once wiring, termination and bit rate are looked at"
                )
            };
            say(&format!(
                "{name}: bus-off, as an error frame says: the controller has left the bus; {then}"
            ));
            self.off = Some(Off::default());
            return;
        };
        if !rejoin || !self.wire.is_virtual() {
            return;
        }
        let since = *off.waits.get_or_insert(tick);
        let kbit = u64::from(self.board.params().bus_kbit()).max(1);
        let ticks = (BITS * 1000).div_ceil(kbit * u64::from(self.tick_us).max(1));
        if tick - since >= ticks {
            self.wire.restart();
        }
    }

    /// Lets time pass without a board: drives and spindle follow their last commands. True where the board has its
    /// power again.
    fn wait_for_power(&mut self) -> Outcome<bool> {
        if !self.unplugged {
            self.plant.advance();
            self.pass_block()?;
        }
        self.ticks += 1;
        self.waiting.clear();
        if !self.has_power() {
            return Ok(false);
        }
        self.begin_anew(None)?;
        Ok(true)
    }

    /// The board starts with what its flash has kept; `at`: it remembers where its axes stand.
    fn begin_anew(&mut self, at: Option<Position>) -> Outcome {
        let no_board = |alarm: Alarm| Failure::WrongBecause(Both::same(words(&alarm, None)));
        self.flash.power(true);
        let tap = stored_tap(&mut self.flash).map_err(no_board)?;
        let up = stored_start(&mut self.flash, &self.built_in).map_err(no_board)?;
        if let Some(state) = &self.state {
            state.save(&self.flash)?;
        }
        self.board = Board::power_up(&up, at, tap).map_err(no_board)?;
        self.board.set_serial(self.serial);
        self.board.join(self.node).map_err(no_board)?;
        self.board.signals(self.signals);
        // The board has forgotten the program, so nothing more is fed.
        self.feeder = None;
        self.beat = None;
        self.alarm = false;
        self.waiting.clear();
        say("the power is back");
        Ok(())
    }

    /// True where the gateway would soon count as lost in virtual time, but was heard within this real time.
    pub fn outruns_gateway(&self, patience: Duration) -> bool {
        self.beat.is_some_and(|(tick, when)| {
            self.silence > 0
                && self.ticks.saturating_sub(tick) > self.silence / 2
                && when.elapsed() < patience
        })
    }

    /// True where this drive's status waits for the next tick.
    pub fn has_status_of(&self, node: NodeId) -> bool {
        self.waiting
            .iter()
            .any(|frame| frame.id().service() == Some((Service::Tpdo1, node)))
    }

    /// Runs the background until no work is left, and sends their frames.
    fn serve(&mut self) -> Outcome {
        loop {
            let mut worked = self.board.serve();
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
            self.plant.hear_board(&frame, |_| ());
            self.out.push(match &mut self.claim {
                Some(claim) => claim.pass(frame),
                None => frame,
            });
        }
        self.send()
    }

    fn feed(&mut self) -> Outcome<bool> {
        let stalled = |tick| self.stall.is_some_and(|stall| stall.has(tick));
        let comes = self.since_up().is_some_and(|tick| !stalled(tick));
        let Some(feeder) = self.feeder.as_mut().filter(|_| comes) else {
            return Ok(false);
        };
        feeder.feed(&mut self.board).map_err(|alarm| {
            Failure::WrongBecause(Both::same(words(&alarm, Some(feeder.source()))))
        })
    }

    /// Runs one SYNC period.
    pub fn tick(&mut self) -> Outcome {
        if !self.has_power() && !self.wait_for_power()? {
            return Ok(());
        }
        if let Some(tick) = self.since_up() {
            self.script.act(tick + 1, &mut self.plant);
            self.suffer(tick + 1)?;
        }
        let sample = self.plant.advance();
        let pins = self.contacts.pins();
        show_pins(&mut self.board, &mut self.plant, &mut self.around, pins);
        self.board.tick(sample, &self.waiting, &mut self.output);
        self.keep()?;
        self.waiting.clear();
        if !self.has_power() {
            self.ticks += 1;
            return Ok(());
        }
        self.ticks += 1;
        self.out.clear();
        self.out.extend_from_slice(&self.output.frames);
        self.exchange();
        self.send()?;
        self.tell_together()?;
        while let Some(event) = self.board.event() {
            self.tell(&event);
        }
        self.board.own_wheel(self.wheel.tick(self.tick_us));
        self.pass_block()?;
        self.serve()
    }

    /// Sends the frame with all setpoints, where the drives get them in one frame: to the drives here, and to the wire.
    fn tell_together(&mut self) -> Outcome {
        let together = self.output.together.as_ref();
        let Some(frame) = together.and_then(|together| together.frame(self.node)) else {
            return Ok(());
        };
        // A new parameter set may have switched this frame on.
        self.wire.use_fd(self.board.params().fd_kbit())?;
        let (line, plant, wire) = (&mut self.line, &mut self.plant, &mut self.wire);
        line.pass_together(Way::Setpoints, &frame, |frame| plant.tell_together(frame));
        let mut sent = Ok(());
        line.pass_together(Way::Out, &frame, |frame| sent = wire.send_fd(frame));
        sent
    }

    /// A SYNC period of the block on the bus, where it is here.
    fn pass_block(&mut self) -> Outcome {
        let has_power = self.has_power();
        let (plant, board, out) = (&mut self.plant, &mut self.board, &mut self.out);
        out.clear();
        plant.elapse_block(|frame| {
            out.push(frame);
            if has_power {
                // It is no frame of a drive.
                let _ = board.receive(&frame);
            }
        });
        self.send()
    }

    /// Passes the board's frames to the drives that are here; their answers go to the wire too.
    fn exchange(&mut self) {
        let (line, plant, out, waiting) = (
            &mut self.line,
            &mut self.plant,
            &mut self.out,
            &mut self.waiting,
        );
        let mut arrived = Vec::new();
        for frame in &self.output.frames {
            line.pass(Way::Setpoints, frame, |frame| arrived.push(frame));
        }
        plant.exchange(&arrived, |answer| {
            out.push(answer);
            line.pass(Way::Statuses, &answer, |answer| waiting.push(answer));
        });
    }

    /// Carries out the writes that the board requests. A changed flash is saved to the file before anything else happens.
    fn keep(&mut self) -> Outcome {
        let before = self.flash.written();
        keep(&mut self.board, &mut self.flash);
        if !self.flash.is_on() && self.cut.is_none() {
            say("the power goes in the middle of a write");
            let from = self.since_up().unwrap_or(0);
            let away = 100_000 / u64::from(self.tick_us).max(1);
            self.cut = Some(Span {
                from,
                to: from.saturating_add(away),
            });
        }
        match &self.state {
            Some(state) if self.flash.written() != before => state.save(&self.flash),
            _ => Ok(()),
        }
    }

    fn tell(&mut self, event: &Event) {
        let source = self.feeder.as_ref().map(Feeder::source);
        match event {
            // The tick after this one is tick 0: the axes stand, and nothing was handed over yet.
            Event::Ready if self.up.is_none() => {
                self.up = Some(self.ticks + 1);
                say("ready");
            }
            Event::Alarm(alarm) => {
                self.alarm = true;
                say(&format!("alarm: {}", words(alarm, source)));
            }
            Event::Warning(alarm) => say(&format!("warning: {}", words(alarm, source))),
            Event::Refused(alarm) => say(&format!("refused: {}", words(alarm, source))),
            Event::Reset => {
                self.alarm = false;
                say("reset");
            }
            _ => {}
        }
    }

    /// True where a program runs, or waits to run.
    pub fn is_busy(&self) -> bool {
        let works = self.board.is_busy() || self.board.ticker().in_program();
        self.has_power() && (works || self.is_feeding())
    }

    fn is_feeding(&self) -> bool {
        !self.alarm && self.feeder.as_ref().is_some_and(|feeder| !feeder.is_over())
    }

    /// True where a program runs and there is room for its next call, which has not come.
    pub fn awaits_program(&self) -> bool {
        self.has_power() && self.board.awaits_program()
    }

    /// True where the machine stands in a hold.
    pub fn is_held(&self) -> bool {
        matches!(self.board.ticker().state(), State::Held)
    }

    /// True where the task of this run is done.
    pub fn is_over(&self) -> bool {
        let ran = self.feeder.is_some()
            && self.since_up().is_some()
            && (self.alarm && !self.board.is_busy() || !self.is_busy());
        let for_good = self.cut.is_some_and(|cut| cut.to == u64::MAX);
        ran || for_good && !self.has_power() || self.last.is_some_and(|last| self.ticks >= last)
    }

    /// Prints the figures of the run.
    pub fn conclude(&self) -> Outcome {
        let [sent, received] = self.wire.counts;
        let harm = self.line.harm();
        say(&format!(
            "{} ticks, {} setpoints late, {sent} frames sent, {received} received, {} dropped{}",
            self.ticks,
            self.late + u64::from(harm.late),
            self.wire.dropped(),
            if self.line.is_good() {
                String::new()
            } else {
                format!(
                    ", by intent {} lost, {} doubled, {} swapped",
                    harm.lost, harm.doubled, harm.swapped
                )
            }
        ));
        if !self.has_power() {
            say("the power is cut");
            return Err(Failure::Machine);
        }
        if self.alarm && self.feeder.is_some() {
            return Err(Failure::Machine);
        }
        Ok(())
    }
}

/// Why there is no plant.
fn no_plant(error: &PlantError) -> Failure {
    Failure::WrongBecause(Both::same(format!(
        "the parameters make no simulated machine: {error:?}"
    )))
}

/// The text of an alarm.
fn words(alarm: &Alarm, source: Option<&SourceFile>) -> String {
    let nowhere = SourceFile::new(Path::new("the board"));
    let source = source.unwrap_or(&nowhere);
    let diagnostic = Diagnostic::new(alarm, source, Lang::En, false);
    match alarm.span.line {
        0 => diagnostic.message,
        _ => {
            let (file, line) = (diagnostic.file, diagnostic.line);
            format!("{file}:{line}: {}", diagnostic.message)
        }
    }
}

/// Prints a message for the user.
pub fn say(text: &str) {
    // A closed standard error cannot be reported to anybody.
    let _ = writeln!(io::stderr(), "board-sim: {text}");
}

mod handled;
#[cfg(test)]
mod tests;
