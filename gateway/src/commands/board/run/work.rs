//! Feeds a checked program to a board and watches it to its end.
//!
//! Knows the board and the program's calls; must not know how the result is told.

use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use indicatif::ProgressBar;
use leadscrew_core::alarm::{Alarm, Arg, Code};
use leadscrew_core::board::{DriveNodes, Event};
use leadscrew_core::bus::{BoardCommand, BoardState, BoardStatus, NodeId, Order};
use leadscrew_core::call::{Aux, Position};
use leadscrew_core::link::{Certificate, Logged, Status, ThreadCertificate, identity};
use leadscrew_core::offsets::{Offsets, Revision};
use leadscrew_core::program::Carried;

use super::super::{single_block, state_words};
use leadscrew_language::variables::Kept;

use crate::cli::Global;
use crate::diagnostics::{self, Diagnostic, alarm_words};
use crate::failure::{Failure, Outcome};
use crate::feeder::{Feeder, placed};
use crate::interrupt;
use crate::link::{BY_MODE, Feed, Link};
use crate::place::SourceLine;
use crate::setup::Setup;
use crate::source::SourceFile;
use crate::start;
use crate::threads::Threads;
use crate::words::{Both, both};

/// Pause between two looks at the board while nothing can be fed.
const LOOK: Duration = Duration::from_millis(5);
/// Time between two readings of the event log.
const LOG: Duration = Duration::from_millis(250);
/// Time between two readings of the certificates of threads: while many are cut, and while few are cut. A board keeps
/// five.
const THREADS: [Duration; 2] = [Duration::from_millis(10), Duration::from_millis(250)];
/// A cut under way when an alarm comes is at rest after this time.
const REST: Duration = Duration::from_secs(5);
/// A controlled stop ends a stroke first. After this time it is only told that the stroke is still under way.
const STOP: Duration = Duration::from_secs(120);
/// A spindle comes to its speed within this time.
const ARRIVAL: Duration = Duration::from_secs(60);

/// The result of a run.
#[derive(Debug, Default)]
pub struct Ran {
    pub alarms: Vec<Diagnostic>,
    pub warnings: Vec<Diagnostic>,
    pub moves: u64,
    pub late: u32,
    /// The board's certificate of the run.
    pub certificate: Option<Certificate>,
    /// The certificates of its threads.
    pub threads: Threads,
    pub line: u32,
    finished: bool,
    /// The board has refused to begin it.
    pub refused: bool,
    /// Another client has reset the board.
    pub reset: bool,
    /// The drives have been enabled again.
    ready: bool,
    pub interrupted: bool,
    /// Its number on the board.
    pub program: u32,
    /// What a program that came to its end has left in force.
    pub carried: Option<Carried>,
    /// The variables that the program has left, or its last pass that came to its end.
    pub variables: Option<Kept>,
    /// The table of offsets and tools, where the program has written to it by G10 and came to its end.
    pub offsets: Option<Offsets>,
    /// The revision under which the board keeps that table.
    pub revision: Option<Revision>,
}

/// Runs a program on a board that was checked for it with this `status`. Returns the result also where the board was lost.
pub fn carry_out(
    setup: &Setup,
    source: &SourceFile,
    link: &mut Link,
    status: Status,
    threads: &[ThreadCertificate],
    by_wheel: bool,
    bar: ProgressBar,
) -> (Ran, Outcome) {
    let mut runner = Runner {
        setup,
        source,
        link,
        ran: Ran {
            threads: Threads::behind(threads),
            ..Ran::default()
        },
        pace: Pace::new(),
        spindle_asked: None,
        last_event: status.newest_event,
        late: status.late,
        before: 0,
        checked: status,
        by_wheel,
        held: false,
        stopped_by: None,
        bar,
    };
    let outcome = runner.all();
    runner.bar.finish_and_clear();
    (runner.ran, outcome)
}

/// Refuses a board that cannot take a program now.
pub fn ready(status: &Status, link: &Link, global: &Global) -> Outcome {
    let node = link.node().get();
    let lang = global.lang();
    match status.state {
        BoardState::Idle => Ok(()),
        BoardState::Alarm => {
            let alarm = status
                .alarm
                .as_ref()
                .map_or_else(Both::default, alarm_words);
            Err(Failure::MachineBecause(both!(
                "node {node} stands on an alarm: {en}; it takes programs again after `leadscrew reset`",
                "节点 {node} 处于报警状态：{zh}；执行 `leadscrew reset` 后才接受程序",
                en = alarm.en,
                zh = alarm.zh
            )))
        }
        BoardState::Starting => Err(Failure::Bus(both!(
            "node {node} is still starting its drives: try again when they are on",
            "节点 {node} 还在启动驱动器：请等驱动器就绪后重试"
        ))),
        other => Err(Failure::Bus(both!(
            "node {node} is busy ({state}): wait for its program to end, or `leadscrew reset` it",
            "节点 {node} 正忙（{state}）：请等它的程序结束，或用 `leadscrew reset` 复位",
            state = state_words(other, lang)
        ))),
    }
}

/// Refuses a machine that does not know where it is, as the board would: what a check says of its travel may be wrong.
pub fn referenced(status: &Status, link: &Link) -> Outcome {
    if status.unreferenced.is_empty() {
        return Ok(());
    }
    let axes = status.unreferenced.each();
    let figures: Vec<Arg> = axes.map(|axis| Arg::Letter(axis.letter())).collect();
    let reason = Alarm::of(Code::NotReferenced, &figures);
    Err(link.refused_by(reason).into())
}

/// A program that runs on a board.
struct Runner<'a> {
    setup: &'a Setup<'a>,
    source: &'a SourceFile,
    link: &'a mut Link,
    ran: Ran,
    /// The board's status for which the program was checked.
    checked: Status,
    last_event: u32,
    /// Late setpoints before the run.
    late: u32,
    /// Moves of the passes before this one.
    before: u64,
    bar: ProgressBar,
    /// The program follows a handwheel.
    by_wheel: bool,
    /// The hold has been reported.
    held: bool,
    /// M00 or M01, of which no block behind it has begun.
    stopped_by: Option<u16>,
    /// Times of reading the certificates of threads.
    pace: Pace,
    /// When the spindle was looked at first.
    spindle_asked: Option<Instant>,
}

/// The program on its way to the board.
struct Feeding<'a> {
    feeder: Feeder<'a>,
    feed: Feed,
    started: bool,
    /// Time of the last reading of the event log.
    looked: Instant,
}

/// The board's program, and its progress in it.
fn place(status: &Status) -> (u32, u32, Position) {
    (status.program, status.next_call, status.position)
}

/// Times of reading the certificates of threads. They are read after something was cut, and sooner the more there were.
#[derive(Debug)]
struct Pace {
    last: Instant,
    every: Duration,
    /// The line at the last reading.
    line: u32,
    /// An axis has been held to the spindle since.
    locked: bool,
}

impl Pace {
    fn new() -> Self {
        let [_, every] = THREADS;
        Self {
            last: Instant::now(),
            every,
            line: 0,
            locked: false,
        }
    }

    /// True when it is time to read, by the board's status and place.
    fn is_due(&mut self, locked: bool, line: u32) -> bool {
        self.locked |= locked;
        (self.locked || line != self.line) && self.last.elapsed() >= self.every
    }

    /// Notes a reading in `line` with so many new certificates.
    fn read(&mut self, new: usize, line: u32, locked: bool) {
        let [shortest, longest] = THREADS;
        (self.last, self.line, self.locked) = (Instant::now(), line, locked);
        self.every = match new {
            0 | 1 => (self.every * 2).min(longest),
            2 | 3 => self.every,
            _ => (self.every / 4).max(shortest),
        };
    }
}

impl Runner<'_> {
    fn all(&mut self) -> Outcome {
        let drives = DriveNodes::of(&self.setup.params);
        self.link.hear_gateways()?;
        let mut boots = self.link.seen.boots;
        self.still_ready()?;
        let own = self.link.attend_alone(&drives)?;
        self.tell_number(own);
        self.link.hear_status()?;
        // From here on the board belongs to this program: a hold acts at once, whatever is under way.
        self.link.hold_when(interrupt::requested);
        self.prepare_board()?;
        let mut under_way = Feeding {
            feeder: Feeder::new(self.setup, self.source)?,
            feed: Feed::new(program_number(), self.setup.revision()),
            started: false,
            looked: Instant::now(),
        };
        loop {
            let done = self.round(&mut under_way, &drives);
            let anew = self.link.seen.boots != boots;
            match done {
                Ok(true) => return Ok(()),
                // A board that has started again refuses what it no longer knows and drops transfers, so its state is read
                // first.
                Err(error) if !anew => return Err(error),
                Ok(false) | Err(_) => {}
            }
            if anew {
                boots = self.link.seen.boots;
                self.after_boot_up(&under_way, &drives)?;
            }
        }
    }

    /// One round of the loop. True where the run is over.
    fn round(&mut self, under_way: &mut Feeding, drives: &DriveNodes) -> Outcome<bool> {
        let Feeding {
            feeder,
            feed,
            started,
            looked,
        } = under_way;
        if interrupt::requested() {
            self.ran.interrupted = true;
            self.end_by_hold()?;
            // Reads the faults on the way.
            self.read_log(feeder)?;
            return self.conclude(feed);
        }
        let fed = self.feed(feeder, feed)?;
        // A pass that the text refuses at its first block has nothing to begin.
        if !*started && !fed && feed.taken() == 0 && !self.ran.alarms.is_empty() {
            return self.conclude(feed);
        }
        if !*started && (!fed || feeder.is_over() && feed.is_empty()) {
            if feeder.awaits_spindle() && !self.spindle_has_arrived()? {
                return Ok(false);
            }
            // In virtual time the board waits from here on before it overwrites a certificate.
            self.link.take_threads(self.ran.threads.whole())?;
            self.link.set_by_wheel(self.by_wheel)?;
            // *Run* names no program: it begins the one that was loaded last.
            let now = self.still_loaded(feed)?;
            self.same_parameters(&now)?;
            self.link.order(Order::Run)?;
            *started = true;
            let now = self.still_loaded(feed)?;
            if let Err(changed) = self.same_parameters(&now) {
                // They have changed between the two looks: it must not go on, if it has begun.
                self.end_by_hold()?;
                return Err(changed);
            }
        }
        if !fed {
            self.link.idle(LOOK)?;
        }
        self.link.check_alive()?;
        let own = self.link.step_aside(drives)?;
        self.tell_number(own);
        self.look();
        self.tell_hold(feeder)?;
        let status = self.link.seen.status.unwrap_or_default();
        let rests = *started && !status.flags.program && status.state != BoardState::Run;
        let alarm = status.state == BoardState::Alarm;
        if alarm || rests || looked.elapsed() >= LOG {
            *looked = Instant::now();
            self.read_log(feeder)?;
        }
        let (locked, line) = (status.flags.locked, self.ran.line);
        if *started && self.pace.is_due(locked, line) {
            let (_, told) = self.link.certificates()?;
            let whole = self.ran.threads.whole();
            let new = self.ran.threads.take(told);
            if self.ran.threads.whole() != whole {
                self.link.take_threads(self.ran.threads.whole())?;
            }
            self.pace.read(new, line, locked);
        }
        if self.ran.refused {
            self.ran.program = feed.program();
        }
        if self.ran.finished || self.ran.reset || !self.ran.alarms.is_empty() {
            if self.ran.finished && !self.ran.reset && self.ran.alarms.is_empty() {
                self.ran.variables = Some(feeder.variables().clone());
                self.ran.offsets = feeder.written_offsets().copied();
                self.ran.carried = feeder.carried();
                self.ran.program = feed.program();
                if feeder.next_pass() {
                    // Each pass is a program of its own for the board.
                    (*feed, *started) = (Feed::new(program_number(), self.setup.revision()), false);
                    self.ran.finished = false;
                    // The number that was seen last is one of the pass before.
                    (self.before, self.link.seen.place) = (self.ran.moves, None);
                    return Ok(false);
                }
            }
            return self.conclude(feed);
        }
        Ok(false)
    }

    /// True where the spindle turns as it was told to, before the approach to a line.
    fn spindle_has_arrived(&mut self) -> Outcome<bool> {
        self.link.idle(LOOK)?;
        self.link.check_alive()?;
        let now = self.link.status()?;
        if start::has_arrived(now.speed.rpm(), now.command, &self.setup.params) {
            return Ok(true);
        }
        let begun = *self.spindle_asked.get_or_insert_with(Instant::now);
        if begun.elapsed() < ARRIVAL && now.alarm.is_none() {
            return Ok(false);
        }
        Err(Failure::MachineBecause(both!(
            "the spindle turns at {speed} rpm and not at {command}: nothing has been approached",
            "主轴转速为 {speed} r/min，而不是 {command}：未开始接近",
            speed = now.speed.rpm().get(),
            command = now.command.get()
        )))
    }

    /// Another client may have begun a program while this one was checked. Its board is left alone, above all the node
    /// number that the board supervises. A program that has ended meanwhile has left the machine at another position, and
    /// under other parameters it would be another machine. An operator who has changed the mode wants no program to begin
    /// [D534].
    fn still_ready(&mut self) -> Outcome {
        let now = self.link.status()?;
        ready(&now, self.link, self.setup.global)?;
        if place(&now) != place(&self.checked) {
            let node = self.link.node().get();
            return Err(Failure::Bus(both!(
                "node {node} was given another program while this one was checked: run it again",
                "检查本程序期间，节点 {node} 收到了另一个程序：请重新运行"
            )));
        }
        self.same_parameters(&now)?;
        self.link.ready_to_run()?;
        (self.last_event, self.late) = (now.newest_event, now.late);
        Ok(())
    }

    /// Refuses a board whose parameters are not those that the program was checked with.
    fn same_parameters(&self, now: &Status) -> Outcome {
        if now.parameters == identity(&self.setup.params) {
            return Ok(());
        }
        let node = self.link.node().get();
        Err(Failure::Bus(both!(
            "the parameters of node {node} have changed since this program was checked: run it again",
            "检查本程序之后，节点 {node} 的参数已改变：请重新运行"
        )))
    }

    /// Another command may have loaded a program at the same moment: then that one runs, or is about to, and this one
    /// does not. Gives the board's status.
    fn still_loaded(&mut self, feed: &Feed) -> Outcome<Status> {
        let now = self.link.status()?;
        if now.program == feed.program() {
            return Ok(now);
        }
        let node = self.link.node().get();
        Err(Failure::Bus(both!(
            "node {node} was given another program at the same moment, and this one is not run: look at the machine before \
             you run it again",
            "节点 {node} 同时收到了另一个程序，本程序未执行：重新运行前请查看机床"
        )))
    }

    /// Reports that this side has taken another node number.
    fn tell_number(&self, own: Option<NodeId>) {
        if let Some(own) = own {
            let told = both!(
                "another gateway is on this bus; this one is node {own} meanwhile\n",
                "此总线上另有网关；本网关暂用节点号 {own}\n",
                own = own.get()
            );
            self.bar
                .suspend(|| diagnostics::say(told.get(self.setup.lang)));
        }
    }

    /// Ends the run with the board's certificates.
    fn conclude(&mut self, feed: &Feed) -> Outcome<bool> {
        let (mut certificate, told) = self.link.certificates()?;
        self.ran.threads.take(told);
        // On an alarm the axes may still be coming to rest.
        let end = Instant::now() + REST;
        while self.ran.threads.is_under_way() && Instant::now() < end {
            self.link.idle(LOOK)?;
            let (now, told) = self.link.certificates()?;
            self.ran.threads.take(told);
            certificate = now;
        }
        // The board counts from power-up, and its status counts only up to 255.
        self.ran.late = certificate.late.saturating_sub(self.late);
        self.ran.certificate = (certificate.program == feed.program()).then_some(certificate);
        Ok(true)
    }

    /// The board has sent a boot-up message, which tells nothing about the machine. After an NMT reset of the communication
    /// everything goes on; after a loss of power the program is gone. So the status record (5001h) is read before anything
    /// is reported [D196].
    fn after_boot_up(&mut self, under_way: &Feeding, drives: &DriveNodes) -> Outcome {
        let Feeding { feeder, feed, .. } = under_way;
        let now = self.link.status()?;
        let same = if feed.taken() > 0 {
            now.program == feed.program()
        } else {
            place(&now) == place(&self.checked)
        };
        self.read_log(feeder)?;
        if !same
            && self.ran.alarms.is_empty()
            && let Some(alarm) = &now.alarm
        {
            // The events before its start are gone with the program. The present alarm tells the reason.
            let alarm = placed(*alarm, self.ran.line);
            self.ran.alarms.push(feeder.words(&alarm));
        }
        if !self.ran.alarms.is_empty() || self.ran.finished || self.ran.reset {
            return Ok(());
        }
        if !same || self.ran.ready || now.state == BoardState::Starting {
            return Err(self.link.begun_anew().into());
        }
        let told = both!(
            "somebody on this bus has begun the communication of node {node} anew (NMT reset communication); its program goes on, \
             and so does this one\n",
            "此总线上有人重置了节点 {node} 的通信（NMT reset communication）；控制板的程序继续运行，本程序也继续\n",
            node = self.link.node().get()
        );
        self.bar
            .suspend(|| diagnostics::say(told.get(self.setup.lang)));
        // The supervised node (1016h) is reset to that of power-up, and process data wait for a start.
        let own = self.link.attend_alone(drives)?;
        self.tell_number(own);
        Ok(self.link.hear_status()?)
    }

    /// Sets inputs and switches by the options. Single block stays as the operator has it where nobody gives it; dry run
    /// is how the program was read, and the board tells it [D513].
    fn prepare_board(&mut self) -> Outcome {
        let global = self.setup.global;
        if !global.signal.is_empty() {
            let mut signals = self.link.signals()?;
            for set in &global.signal {
                signals.set(set.signal, set.level);
            }
            self.link.set_signals(signals)?;
        }
        single_block(global, self.link)?;
        self.link.set_levels(BoardCommand {
            dry_run: Some(global.dry_run),
            ..BoardCommand::default()
        })?;
        Ok(())
    }

    /// Sends one batch, as much as there is room for. False where there was no room, or nothing is left.
    fn feed(&mut self, feeder: &mut Feeder, feed: &mut Feed) -> Outcome<bool> {
        while feed.has_room()
            && let Some(call) = feeder.next_call(&mut self.ran.alarms)?
        {
            feed.push(&call);
        }
        Ok(feed.send(self.link)?)
    }

    /// Reports once that the machine waits for the operator.
    fn tell_hold(&mut self, feeder: &Feeder) -> Outcome {
        let hold = self
            .link
            .seen
            .status
            .is_some_and(|status| status.state == BoardState::Hold);
        if hold && !self.held {
            // Whether it is the program that has asked for it.
            self.read_log(feeder)?;
            let line = SourceLine(self.ran.line);
            let told = if let Some(code) = self.stopped_by {
                both!(
                    "M{code:02} stops the program (line {line}): `leadscrew resume` goes on\n",
                    "M{code:02} 使程序停止（第 {line} 行）：`leadscrew resume` 可继续\n"
                )
            } else if self.link.seen.status.is_some_and(stops_by_single_block) {
                both!(
                    "single block is on, and the machine has stopped (line {line}): `leadscrew resume` goes on, `leadscrew resume \
                     --single-block=off` without further stops\n",
                    "单段已打开，机床已停止（第 {line} 行）：`leadscrew resume` 可继续，`leadscrew resume --single-block=off` \
                     则不再停\n"
                )
            } else {
                both!(
                    "the machine is in feed hold (line {line}): `leadscrew resume` goes on\n",
                    "机床处于进给保持（第 {line} 行）：`leadscrew resume` 可继续\n"
                )
            };
            self.bar
                .suspend(|| diagnostics::say(told.get(self.setup.lang)));
        }
        self.held = hold;
        Ok(())
    }

    /// Takes the values of the statuses.
    fn look(&mut self) {
        let seen = &self.link.seen;
        if let Some(place) = seen.place {
            self.ran.moves = self.ran.moves.max(self.before + u64::from(place.number));
            if place.line > 0 {
                self.ran.line = place.line;
            }
        }
        if self.bar.is_hidden() {
            return;
        }
        self.bar.set_position(self.ran.moves);
        let status = seen.status.unwrap_or_default();
        let lang = self.setup.lang;
        let message = both!(
            "line {line}, {state}",
            "第 {line} 行，{state}",
            line = SourceLine(self.ran.line),
            state = state_words(status.state, lang)
        );
        self.bar.set_message(message.get(lang).to_owned());
    }

    /// Reads the new entries of the event log.
    fn read_log(&mut self, feeder: &Feeder) -> Outcome {
        loop {
            let entries = self.link.events_behind(self.last_event)?;
            if entries.is_empty() {
                return Ok(());
            }
            for entry in &entries {
                self.last_event = self.last_event.max(entry.number);
                self.note(entry, feeder);
            }
        }
    }

    fn note(&mut self, entry: &Logged, feeder: &Feeder) {
        match entry.event {
            Event::Started { number, line } => {
                self.stopped_by = None;
                self.ran.moves = self.ran.moves.max(self.before + u64::from(number));
                self.ran.line = line;
            }
            Event::Alarm(alarm) => {
                let alarm = placed(alarm, self.ran.line);
                self.ran.alarms.push(feeder.words(&alarm));
            }
            Event::Warning(warning)
                if matches!(warning.code, Code::RunsByItself | Code::ToolByHand) =>
            {
                let words = feeder.words(&warning);
                self.bar
                    .suspend(|| diagnostics::print(&words, self.setup.colour));
            }
            // What an operator was refused is told where it was asked.
            Event::Warning(warning) if BY_MODE.contains(&warning.number()) => {}
            Event::Warning(warning) => {
                let known = |w: &Diagnostic| w.number == warning.number();
                if !self.ran.warnings.iter().any(known) {
                    self.ran.warnings.push(feeder.words(&warning));
                }
            }
            Event::Aux(Aux::M(code @ (0 | 1))) => self.stopped_by = Some(code),
            Event::Finished => self.ran.finished = true,
            Event::Refused(alarm) => {
                self.ran.refused = true;
                self.ran.alarms.push(feeder.words(&alarm));
            }
            Event::Reset => self.ran.reset = true,
            Event::Ready => self.ran.ready = true,
            _ => {}
        }
    }

    /// A controlled stop. Where a stroke takes longer than that is waited for, the machine goes on with it though the run
    /// ends here, and that is told.
    fn end_by_hold(&mut self) -> Outcome {
        if bring_to_rest(self.link, STOP)? {
            return Ok(());
        }
        let told = both!(
            "the stroke is still under way after {seconds} s (line {line}), and the machine holds at its end: \
             `leadscrew reset` then drops the rest of the program; `leadscrew stop` ends the stroke at once\n",
            "行程在 {seconds} s 后仍未结束（第 {line} 行），机床将在其末端保持：届时用 `leadscrew reset` 放弃程序的其余部分；\
             `leadscrew stop` 可立即停止\n",
            seconds = STOP.as_secs(),
            line = SourceLine(self.ran.line)
        );
        self.bar
            .suspend(|| diagnostics::say(told.get(self.setup.lang)));
        Ok(())
    }
}

/// A controlled stop: feed hold until the machine stands, then a reset drops the rest of the program. False where it does
/// not stand within this time: a reset would then act on a machine that moves, and only the hold has been ordered.
///
/// # Errors
/// The board does not answer.
pub fn bring_to_rest(link: &mut Link, limit: Duration) -> Outcome<bool> {
    link.order(Order::Hold)?;
    let end = Instant::now() + limit;
    let mut boots = link.seen.boots;
    let rests = |state| {
        matches!(
            state,
            BoardState::Hold | BoardState::Idle | BoardState::Alarm
        )
    };
    let mut stands = false;
    while !stands && Instant::now() < end {
        link.idle(LOOK)?;
        link.check_alive()?;
        if link.seen.boots != boots {
            // Until the node is started, the last status is an old one.
            boots = link.seen.boots;
            link.start_node()?;
        }
        stands = link.seen.status.is_some_and(|status| rests(status.state));
    }
    let alarm = link.seen.status.and_then(|status| status.alarm);
    if stands && alarm.is_none() {
        link.order(Order::Reset)?;
    }
    Ok(stands)
}

/// A machine in hold stands so for single block, as far as nobody holds it as well.
const fn stops_by_single_block(status: BoardStatus) -> bool {
    status.flags.single_block && !status.flags.hold
}

/// A number that no recent program had.
fn program_number() -> u32 {
    let since = SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .unwrap_or_default();
    (since.as_micros() as u32) | 1
}
