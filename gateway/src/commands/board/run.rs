//! `run` on a real bus: checks the whole program against the board's own parameters, feeds it, watches it, and tells the
//! result.

use std::io::IsTerminal as _;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use leadscrew_can::Address;
use leadscrew_core::alarm::Lang;
use leadscrew_core::board::{DriveNodes, Event};
use leadscrew_core::bus::{BoardCommand, BoardState, NodeId, Order};
use leadscrew_core::journal::TapRecord;
use leadscrew_core::link::{Certificate, Logged, Status};
use leadscrew_core::program::Position;
use leadscrew_core::units::Rpm;

use super::{Machine, state_words};
use crate::checking::{Report, plural};
use crate::cli::{Drive, Global};
use crate::diagnostics::alarm_words;
use crate::diagnostics::{self, Diagnostic};
use crate::execution::tell_report;
use crate::failure::{Doing, Failure, Outcome};
use crate::feeder::{Feeder, placed};
use crate::interrupt::{self, UnderWay};
use crate::json::Json;
use crate::link::{Feed, Link};
use crate::number;
use crate::origin::Origin;
use crate::output;
use crate::setup::{Answer, Setup, alone_in};
use crate::source::SourceFile;
use crate::synchronism::Synchronism;
use crate::threads::Threads;
use crate::values::Tolerance;
use crate::words::{Both, both, pick};

/// Pause between two looks at the board while nothing can be fed.
const LOOK: Duration = Duration::from_millis(5);
/// Time between two readings of the event log.
const LOG: Duration = Duration::from_millis(250);
/// Time between two readings of the certificates of threads: while many are cut, and while few are cut. A board keeps
/// eight.
const THREADS: [Duration; 2] = [Duration::from_millis(10), Duration::from_millis(250)];
/// A cut under way when an alarm comes is at rest after this time.
const REST: Duration = Duration::from_secs(5);
/// A controlled stop ends a stroke first. After this time the present state is reported.
const STOP: Duration = Duration::from_secs(120);

/// The result of a run.
#[derive(Debug, Default)]
struct Ran {
    alarms: Vec<Diagnostic>,
    warnings: Vec<Diagnostic>,
    moves: u64,
    late: u32,
    /// The board's certificate of the run.
    certificate: Option<Certificate>,
    /// The certificates of its threads.
    threads: Threads,
    line: u32,
    finished: bool,
    /// Another client has reset the board.
    reset: bool,
    /// The drives have been enabled again.
    ready: bool,
    interrupted: bool,
}

/// Refuses an option that only a simulated machine can do.
fn refuse(global: &Global, drive: &Drive) -> Outcome {
    let option = if drive.spindle_ripple.is_some() {
        "--spindle-ripple"
    } else if drive.tick_us.is_some() {
        "--tick-us"
    } else if global.at.is_some() {
        "--at"
    } else {
        return Ok(());
    };
    let bus = &global.bus;
    Err(Failure::Usage(both!(
        "`{option}` is for the simulated machine; behind `--bus {bus}` stands a real one",
        "`{option}` 只用于模拟机床；`--bus {bus}` 后面是真实机床"
    )))
}

/// Runs a program on a board.
pub fn run(
    global: &Global,
    source: &SourceFile,
    drive: &Drive,
    tolerance: Option<Tolerance>,
) -> Outcome {
    refuse(global, drive)?;
    // A mistyped name needs no board.
    source
        .open()
        .map_err(|error| Failure::file(Doing::Read, source.name(), &error))?;
    let program = source.name();
    let answer = Answer::Run { program: &program };
    alone_in(global, &global.params, &global.set, answer)?;
    let machine = Machine::meet(global)?;
    let mut setup = Setup::over(global, Some(machine.params.clone()), answer)?;
    machine.agrees_with(&setup)?;
    let mut link = machine.link;
    let status = link.status()?;
    ready(&status, &link, global)?;
    setup.position = Some(status.position);
    setup.turning = status.command != Rpm::STOPPED;
    setup.tap = TapRecord::decode(&link.journal()?).ok().flatten();
    let origin = Origin {
        program: program.clone(),
        parameters: Some(status.parameters),
        board: Some((link.board_name()?, SystemTime::now())),
    };
    let report = tell_report(&setup, source)?;
    if !report.alarms.is_empty() {
        if global.json {
            result(&setup, &report, &Ran::default(), &origin, false)?;
        }
        return Err(Failure::Wrong);
    }
    interrupt::defer(UnderWay::Machine);
    let (_, link_threads) = link.certificates()?;
    let mut runner = Runner {
        setup: &setup,
        source,
        link: &mut link,
        ran: Ran {
            threads: Threads::behind(&link_threads),
            ..Ran::default()
        },
        pace: Pace::new(),
        last_event: status.newest_event,
        late: status.late,
        checked: status,
        held: false,
        bar: bar(report.moves, global.json, setup.lang),
    };
    let outcome = runner.all();
    runner.bar.finish_and_clear();
    let ran = runner.ran;
    for diagnostic in ran.alarms.iter().chain(&ran.warnings) {
        diagnostics::print(diagnostic, setup.colour);
    }
    if let Err(lost) = outcome {
        // The result so far: the board may still finish its work.
        if global.json {
            output::json(|json| {
                lost.fields(setup.lang, json);
                ran.threads.fields(json);
                for (key, told) in [("alarms", &ran.alarms), ("warnings", &ran.warnings)] {
                    json.array_at(key, |json| {
                        for diagnostic in told {
                            json.object(|json| diagnostic.fields(json, true));
                        }
                    });
                }
            })?;
        } else {
            output::write(ran.threads.text(setup.lang).as_bytes())?;
        }
        return Err(lost);
    }
    let verdict = if !ran.alarms.is_empty() {
        Err(Failure::Machine)
    } else if ran.interrupted {
        Err(Failure::Interrupted)
    } else if ran.reset {
        Err(Failure::MachineBecause(both!(
            "the board was reset by somebody else; the program has ended in line {line}",
            "控制板被其它操作者复位；程序在第 {line} 行结束",
            line = ran.line
        )))
    } else {
        within(&ran, tolerance)
    };
    if global.json {
        result(&setup, &report, &ran, &origin, verdict.is_ok())?;
    } else {
        let word = match &verdict {
            Ok(()) => pick(setup.lang, "done", "完成"),
            Err(Failure::Interrupted) => pick(setup.lang, "interrupted", "已中断"),
            Err(Failure::WrongBecause(_)) => pick(setup.lang, "out of tolerance", "超差"),
            Err(_) => pick(setup.lang, "stopped", "已停止"),
        };
        let figures = Figures::of(&ran, &setup);
        let error = if figures.errors.ticks > 0 {
            let (worst, rms) = (figures.errors.worst(), figures.errors.rms());
            both!(
                " · worst synchronism error {worst_en} µm ({rms} µm RMS), as measured",
                " · 测得的最大同步误差 {worst_zh} µm（均方根 {rms} µm）",
                worst_en = worst.en,
                worst_zh = worst.zh
            )
        } else {
            both!("", "")
        };
        let text = both!(
            "{name}: {word}: {words} · {time} s · {late} setpoints late{en}\nsetpoints {hash}\n",
            "{name}：{word}：移动 {moves} 段 · {time} s · 迟到设定值 {late} 个{zh}\n设定值校验 {hash}\n",
            name = source.shown(),
            words = plural(ran.moves, "move"),
            moves = ran.moves,
            time = number::rounded::<6>(figures.time_us, 3),
            late = ran.late,
            hash = figures
                .hash
                .as_deref()
                .unwrap_or(pick(setup.lang, "unknown", "未知")),
            en = error.en,
            zh = error.zh
        );
        output::write(text.get(setup.lang).as_bytes())?;
        output::write(ran.threads.text(setup.lang).as_bytes())?;
        if let Some(line) = origin.line() {
            output::write(line.get(setup.lang).as_bytes())?;
        }
    }
    verdict
}

/// Refuses a board that cannot take a program now.
fn ready(status: &Status, link: &Link, global: &Global) -> Outcome {
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
                "node {node} stands on an alarm: {en}; it takes programs again behind `leadscrew reset`",
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

/// The certificate in the contract's units.
#[derive(Debug, Default)]
struct Figures {
    ticks: u64,
    time_us: i64,
    hash: Option<String>,
    /// As measured by the board.
    errors: Synchronism,
}

impl Figures {
    fn of(ran: &Ran, setup: &Setup) -> Self {
        let Some(certificate) = &ran.certificate else {
            return Self::default();
        };
        let time = certificate
            .ticks
            .saturating_mul(u64::from(setup.params.tick_us()));
        let hash = certificate.setpoint_hash;
        Self {
            ticks: certificate.ticks,
            time_us: i64::try_from(time).unwrap_or(i64::MAX),
            hash: hash.map(|hash| format!("{hash:016x}")),
            errors: certificate.into(),
        }
    }

    /// Writes the known values, with what was seen of the run.
    fn fields(&self, bus: &Address, ran: &Ran, path_nm: Option<i64>, json: &mut Json) {
        json.text("bus", &bus.to_string());
        json.number("moves", ran.moves);
        json.number("ticks", self.ticks);
        json.decimal::<6>("time_s", self.time_us);
        match path_nm {
            Some(nm) => json.decimal::<6>("path_mm", nm),
            None => json.null("path_mm"),
        }
        match &self.hash {
            Some(hash) => json.text("setpoint_hash", hash),
            None => json.null("setpoint_hash"),
        }
        // A machine knows only the measured values.
        self.errors.field("sync_error_um", json);
        self.errors.field("measured_error_um", json);
        json.integer("late", i64::from(ran.late));
        ran.threads.fields(json);
    }
}

/// The figures of a run that has not begun.
pub fn no_figures(bus: &Address, json: &mut Json) {
    Figures::default().fields(bus, &Ran::default(), None, json);
}

/// Compares the board's measurements of each thread, and of the run, with the requested tolerance.
fn within(ran: &Ran, tolerance: Option<Tolerance>) -> Outcome {
    let Some(tolerance) = tolerance else {
        return Ok(());
    };
    let mut above = ran.threads.above(tolerance);
    if let Some(run) = &ran.certificate
        && tolerance.is_below(run.largest.nm())
    {
        // The run stands for a thread whose own certificate is missing.
        let above = above.get_or_insert_default();
        above.worst_nm = above.worst_nm.max(run.largest.nm());
    }
    match above {
        Some(above) => Err(Failure::WrongBecause(above.words(tolerance))),
        None => Ok(()),
    }
}

/// The result object. The path is the sum of the moves; it is known where all of them were carried out.
fn result(setup: &Setup, report: &Report, ran: &Ran, origin: &Origin, ok: bool) -> Outcome {
    let figures = Figures::of(ran, setup);
    let path_nm = ok.then(|| report.path_nm.round() as i64);
    output::json(|json| {
        json.flag("ok", ok);
        figures.fields(&setup.global.bus, ran, path_nm, json);
        for (key, first, then) in [
            ("alarms", &report.alarms, &ran.alarms),
            ("warnings", &report.warnings, &ran.warnings),
        ] {
            json.array_at(key, |json| {
                for diagnostic in first.iter().chain(then) {
                    json.object(|json| diagnostic.fields(json, true));
                }
            });
        }
        origin.fields(json);
    })
}

/// A progress bar over the moves, only on a terminal.
fn bar(moves: u64, json: bool, lang: Lang) -> ProgressBar {
    if json || !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::with_draw_target(Some(moves), ProgressDrawTarget::stderr());
    let template = pick(
        lang,
        "{bar:40} move {pos}/{len}  {msg}",
        "{bar:40} 移动 {pos}/{len}  {msg}",
    );
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    bar
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
    bar: ProgressBar,
    /// The hold has been reported.
    held: bool,
    /// Times of reading the certificates of threads.
    pace: Pace,
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
            feed: Feed::new(program_number()),
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
            self.bring_to_rest()?;
            // Reads the faults on the way.
            self.read_log(feeder)?;
            return self.conclude(feed);
        }
        let fed = self.feed(feeder, feed)?;
        if !*started && (!fed || feeder.is_over() && feed.is_empty()) {
            // In virtual time the board waits from here on before it overwrites a certificate.
            self.link.take_threads(self.ran.threads.whole())?;
            self.link.order(Order::Run)?;
            *started = true;
        }
        if !fed {
            self.link.idle(LOOK)?;
        }
        self.link.check_alive()?;
        let own = self.link.step_aside(drives)?;
        self.tell_number(own);
        self.look();
        self.tell_hold();
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
        if self.ran.finished || self.ran.reset || !self.ran.alarms.is_empty() {
            return self.conclude(feed);
        }
        Ok(false)
    }

    /// Another client may have begun a program while this one was checked. Its board is left alone, above all the node
    /// number that the board supervises. A program that has ended meanwhile has left the machine at another position.
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
        (self.last_event, self.late) = (now.newest_event, now.late);
        Ok(())
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

    /// Sets inputs and switches by the options.
    fn prepare_board(&mut self) -> Outcome {
        let global = self.setup.global;
        if !global.signal.is_empty() {
            let mut signals = self.link.signals()?;
            for set in &global.signal {
                signals.set(set.signal, set.level);
            }
            self.link.set_signals(signals)?;
        }
        self.link.set_levels(BoardCommand {
            single_block: Some(global.single_block),
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
    fn tell_hold(&mut self) {
        let hold = self
            .link
            .seen
            .status
            .is_some_and(|status| status.state == BoardState::Hold);
        if hold && !self.held {
            let told = both!(
                "the machine is in feed hold (line {line}): `leadscrew resume` goes on\n",
                "机床处于进给保持（第 {line} 行）：`leadscrew resume` 可继续\n",
                line = self.ran.line
            );
            self.bar
                .suspend(|| diagnostics::say(told.get(self.setup.lang)));
        }
        self.held = hold;
    }

    /// Takes the values of the statuses.
    fn look(&mut self) {
        let seen = &self.link.seen;
        if let Some(place) = seen.place {
            self.ran.moves = self.ran.moves.max(u64::from(place.number));
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
            line = self.ran.line,
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
                self.ran.moves = self.ran.moves.max(u64::from(number));
                self.ran.line = line;
            }
            Event::Alarm(alarm) => {
                let alarm = placed(alarm, self.ran.line);
                self.ran.alarms.push(feeder.words(&alarm));
            }
            Event::Warning(warning) => {
                let known = |w: &Diagnostic| w.number == warning.number();
                if !self.ran.warnings.iter().any(known) {
                    self.ran.warnings.push(feeder.words(&warning));
                }
            }
            Event::Finished => self.ran.finished = true,
            Event::Reset => self.ran.reset = true,
            Event::Ready => self.ran.ready = true,
            _ => {}
        }
    }

    /// A controlled stop: feed hold until the machine stands, then a reset drops the rest of the program.
    fn bring_to_rest(&mut self) -> Outcome {
        self.link.order(Order::Hold)?;
        let end = Instant::now() + STOP;
        let mut boots = self.link.seen.boots;
        let rests = |state| {
            matches!(
                state,
                BoardState::Hold | BoardState::Idle | BoardState::Alarm
            )
        };
        while Instant::now() < end {
            self.link.idle(LOOK)?;
            self.link.check_alive()?;
            if self.link.seen.boots != boots {
                // Until the node is started, the last status is an old one.
                boots = self.link.seen.boots;
                self.link.start_node()?;
            }
            if self
                .link
                .seen
                .status
                .is_some_and(|status| rests(status.state))
            {
                break;
            }
        }
        let alarm = self.link.seen.status.and_then(|status| status.alarm);
        if alarm.is_none() {
            self.link.order(Order::Reset)?;
        }
        Ok(())
    }
}

/// A number that no recent program had.
fn program_number() -> u32 {
    let since = SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .unwrap_or_default();
    (since.as_micros() as u32) | 1
}
