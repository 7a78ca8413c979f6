//! Verifies a program without a machine: text, geometry, physics. `check` reports the result; `simulate` and `run` need it
//! before any motion.

mod threads;

use std::io::{BufRead as _, BufReader};

use leadscrew_core::alarm::{Alarm, Arg, Code, Span};
use leadscrew_core::call::{
    Aux, Call, CallKind, FeedRate, Position, SpindleCall, SpindleChoice, SpindleMode, TapCall,
    TapCycle, TapRepeat, ThreadCall,
};
use leadscrew_core::cycle::{self, Forbidden, GrooveMoves, Moves};
use leadscrew_core::moves::{Move, MoveKind};
use leadscrew_core::offsets::InPlace;
use leadscrew_core::program::Event;
use leadscrew_core::units::{Axis, Length};
use leadscrew_language::dialect::{Control, Looks, Written, lengths};
use leadscrew_language::flow::Passes;
use leadscrew_language::heading::Allowed;
use leadscrew_language::text::span;

use crate::diagnostics::{self, Diagnostic, Place};
use crate::failure::{Doing, Failure, Outcome};
use crate::hole::Hole;
use crate::json::Json;
use crate::length;
use crate::movelist::cycle_name;
use crate::number;
use crate::place::SourceLine;
use crate::plausible::Plausible;
use crate::program::Program;
use crate::setup::Setup;
use crate::source::SourceFile;
use crate::words::{Both, both};

/// The result for one program.
#[derive(Debug, Default)]
pub struct Report {
    /// Alarms: for each kind one per line, up to [`LISTED`] of them.
    pub alarms: Vec<Diagnostic>,
    /// Warnings, in the same way.
    pub warnings: Vec<Diagnostic>,
    /// Kinds with further lines.
    pub unlisted: Vec<Unlisted>,
    /// Its cycles in order, up to [`CYCLES`] of them.
    pub cycles: Vec<CycleReport>,
    /// Number of cycles after those [D277].
    pub further_cycles: u64,
    /// Number of moves that could be made.
    pub moves: u64,
    /// The length of their path in the Z–X plane, in nanometres.
    pub path_nm: f64,
    /// True for each of the spindles 2 to 4 that taps.
    pub tappers: [bool; 3],
    /// A lead-in is longer than the way before the material.
    pub lead_in_too_short: bool,
    /// Where warnings of moves are, up to [`MARKS`] of them.
    pub marks: Vec<Mark>,
}

/// The place of a warning: machine coordinates, Z and radius in millimetres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mark {
    /// Number of the warning.
    pub number: u16,
    /// The line of the program as the machine counts it.
    pub line: u32,
    /// Where its move begins.
    pub from: (f64, f64),
    /// Where its move ends.
    pub to: (f64, f64),
    /// Where the warning is.
    pub at: (f64, f64),
}

/// Bytes of a program that are looked at for its control.
const LOOKED_AT: usize = 1 << 20;

/// From here on a length without a point is hardly millimetres, in a program without any point, too.
const LARGE: f64 = 1000.0;

/// The most alarms or warnings of a kind in the list, so that the report of any program is bounded.
pub const LISTED: usize = 10;

/// The most cycles in the list. A program of one part has fewer by far.
pub const CYCLES: usize = 10_000;

/// The most places of warnings. A picture with more cannot be read.
pub const MARKS: usize = 200;

/// A kind with more lines than the list has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unlisted {
    /// Its number.
    pub number: u16,
    /// It is a warning.
    pub warning: bool,
    /// Number of further lines.
    pub lines: u64,
    /// The last of these lines.
    last: u32,
}

impl Unlisted {
    /// Text for a person.
    #[must_use]
    pub fn words(&self) -> Both {
        let Self { number, lines, .. } = self;
        both!(
            "{number:04}: on {more}, too",
            "{number:04}：另有 {lines} 行也有",
            more = plural(*lines, "further line")
        )
    }
}

/// Figures of a cycle.
#[derive(Clone, Copy, Debug)]
pub struct CycleReport {
    /// Source line.
    pub line: u32,
    /// Its name.
    pub cycle: &'static str,
    /// Passes of a thread, columns of a groove, holes of a tap.
    pub passes: u32,
    /// The highest speed of a tap on the way in, in hundredths of a turn per minute.
    pub tap_speed: Option<i64>,
    /// The least distance of R from the material for an ordinary tap, in nanometres.
    pub tap_lead_in_nm: Option<i64>,
    /// Figures of a thread.
    pub thread: Option<ThreadFigures>,
    /// Approximate time in microseconds.
    pub time_us: i64,
}

/// Figures of a thread.
#[derive(Clone, Copy, Debug)]
pub struct ThreadFigures {
    /// Largest shift of its starts along Z, nanometres.
    pub z_shift_max_nm: i64,
    /// Distance from B to the point where the lead is reached, in nanometres.
    pub lead_in_nm: i64,
    /// The least distance of the start from the material, in nanometres.
    pub start_before_nm: i64,
    /// How far beside its place the encoder may leave it, in nanometres; `None` where that is nothing.
    pub encoder_error_nm: Option<i64>,
    /// The highest speed of the spindle that the axes can follow.
    pub rpm_max: i64,
    /// Where the lead changes: turns of the stroke in millionths, and the lead at its end in nanometres.
    pub variable: Option<(i64, i64)>,
}

/// How much of a program's result is kept: bounded memory for any length.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Detail {
    /// Alarms, warnings and figures.
    Verdict,
    /// Its first cycles in addition.
    Cycles,
}

/// Verifies a program.
pub fn check(setup: &Setup, source: &SourceFile, detail: Detail) -> Outcome<Report> {
    let options = setup.options();
    let program = Program::open(source, &setup.params, setup.begin())
        .map_err(|error| Failure::file(Doing::Read, source.name(), &error))?;
    let mut checker = Checker {
        setup,
        source,
        detail,
        report: Report::default(),
        at: options.position,
        hole: Hole::new(setup.tap),
        spindle: Spindle::at_start(setup),
        tool: setup.tool,
        beyond: Vec::new(),
        plausible: Plausible::new(&setup.params, setup.offsets.as_ref(), program.stock()),
        chain: Vec::new(),
        chain_us: 0,
        program,
    };
    loop {
        let next = checker
            .program
            .next_event()
            .map_err(|error| Failure::file(Doing::Read, source.name(), &error))?;
        let inch = checker.program.is_inch();
        match next {
            None => {
                let mut plausible = std::mem::take(&mut checker.plausible);
                plausible.end(&mut |alarm| checker.doubt(&alarm, inch));
                checker.points()?;
                if let Some(control) = checker.program.assumed() {
                    checker.look(control)?;
                }
                return Ok(checker.report);
            }
            Some(Ok(Event::Warning(warning))) => checker.tell(&warning, inch),
            Some(Ok(Event::Call(call))) => checker.call(&call, inch),
            Some(Err(alarm)) => checker.tell(&alarm, inch),
        }
    }
}

/// The state of a check.
struct Checker<'a> {
    setup: &'a Setup<'a>,
    source: &'a SourceFile,
    program: Program<'a>,
    detail: Detail,
    report: Report,
    at: Position,
    hole: Hole,
    spindle: Spindle,
    tool: InPlace,
    /// Alarms of travel on lines in millimetres.
    beyond: Vec<Alarm>,
    plausible: Plausible,
    /// The strokes of a chain, until the last one.
    chain: Vec<(ThreadCall, Span)>,
    chain_us: i64,
}

/// Whether the work piece, or the tool, turns during a feed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Spindle {
    /// It turns, or another spindle does.
    Turns,
    /// It stands.
    Stands,
    /// It stands, and a warning has said so.
    Told,
}

impl Spindle {
    const fn at_start(setup: &Setup) -> Self {
        if setup.turning {
            Self::Turns
        } else {
            Self::Stands
        }
    }

    /// The state after this call. M24–M27 select another spindle, whose state is unknown here.
    const fn behind(self, call: &Call) -> Self {
        match call.kind {
            CallKind::Spindle(call) if call.turns() => Self::Turns,
            CallKind::Spindle(_) => match self {
                Self::Turns => Self::Stands,
                stands => stands,
            },
            CallKind::Aux(Aux::M(24..=27)) => Self::Turns,
            _ => self,
        }
    }
}

impl Checker<'_> {
    /// Keeps an alarm or a warning that is new on its line, and counts those beyond the list.
    fn tell(&mut self, alarm: &Alarm, inch: bool) {
        let again = Alarm::new(Code::MainBeginsAgain, alarm.span);
        let alarm = match (alarm.code, self.setup.passes) {
            (Code::MainRepeats, Passes::UntilStopped) => &again,
            // It ends after as many passes as are wanted.
            (Code::MainRepeats, Passes::Number(_)) => return,
            _ => alarm,
        };
        let (number, line) = (alarm.number(), alarm.span.line);
        if self.program.allows(alarm) {
            return;
        }
        let report = &mut self.report;
        let list = if alarm.code.is_warning() {
            &mut report.warnings
        } else {
            &mut report.alarms
        };
        report.lead_in_too_short |= alarm.code == Code::LeadInLong;
        let mut of_kind = list.iter().filter(|known| known.number == number);
        if of_kind.clone().any(|known| known.counted == line) {
            return;
        }
        if of_kind.by_ref().count() < LISTED {
            list.push(Diagnostic::new(alarm, self.source, self.setup.lang, inch));
            return;
        }
        match report
            .unlisted
            .iter_mut()
            .find(|kind| kind.number == number)
        {
            Some(kind) if kind.last == line => {}
            Some(kind) => {
                kind.lines += 1;
                kind.last = line;
            }
            None => report.unlisted.push(Unlisted {
                number,
                warning: alarm.code.is_warning(),
                lines: 1,
                last: line,
            }),
        }
    }

    fn call(&mut self, call: &Call, inch: bool) {
        let at = self.at;
        self.check_call(call, inch);
        let mut plausible = std::mem::take(&mut self.plausible);
        plausible.call(call, at, &mut |alarm| self.doubt(&alarm, inch));
        self.plausible = plausible;
    }

    /// Warns of a word without a point that leads beyond the travel, where increments would not, if others have points or
    /// it is [`LARGE`].
    fn points(&mut self) -> Outcome {
        if self.beyond.is_empty() {
            return Ok(());
        }
        let text = self.front()?;
        let lines = || text.split(|byte| *byte == b'\n');
        let has_points = lines().any(|line| lengths(line).any(|word| word.has_point));
        let params = &self.setup.params;
        if !params.whole_units() {
            return Ok(());
        }
        let step = if params.increment_is_c() {
            100.0
        } else {
            1000.0
        };
        for alarm in std::mem::take(&mut self.beyond) {
            // X is told as a diameter, and its limits are radii.
            let (axis, to, letters, share) = match alarm.args {
                [Arg::Letter(b'X'), Arg::Diameter(to), ..] => {
                    (Axis::X, to.radius(), [b'X', b'U'], 0.5)
                }
                [Arg::Letter(b'Z'), Arg::Length(to), ..] => (Axis::Z, to, [b'Z', b'W'], 1.0),
                _ => continue,
            };
            let line = lines()
                .nth((alarm.span.line as usize).saturating_sub(1))
                .unwrap_or_default();
            let is_meant = |word: &Written| !word.has_point && letters.contains(&word.letter);
            let Some(word) = lengths(line).find(is_meant) else {
                continue;
            };
            if !has_points && word.value.abs() < LARGE {
                continue;
            }
            let increments = (word.value * step).round() as i64;
            let less = (word.value * (1e6 - step) * share).round() as i64;
            let would = to.nm() - less;
            if params.soft_limit_minus(axis) <= would && would <= params.soft_limit_plus(axis) {
                let span = span(alarm.span.line, word.from, word.to);
                let figure = Arg::Length(Length::from_nm(increments));
                let told = Alarm::new(Code::PointMissing, span);
                self.tell(&told.word(word.letter).with([figure]), false);
            }
        }
        Ok(())
    }

    /// The first bytes of the text, in whole lines.
    fn front(&self) -> Outcome<Vec<u8>> {
        let unreadable = |error| Failure::file(Doing::Read, self.source.name(), &error);
        let mut text = Vec::new();
        let mut opened = BufReader::new(self.source.open().map_err(unreadable)?);
        while text.len() < LOOKED_AT && opened.read_until(b'\n', &mut text).map_err(unreadable)? > 0
        {
        }
        Ok(text)
    }

    /// Warns where the text looks as if it was written for another control.
    fn look(&mut self, set: Control) -> Outcome {
        let text = self.front()?;
        let lines = || text.split(|byte| *byte == b'\n');
        let mut looks = Looks::default();
        for (number, line) in (1..).zip(lines()) {
            looks.line(number, line);
        }
        let Some((like, line)) = looks.like(set) else {
            return Ok(());
        };
        let shown = lines().nth(line as usize - 1).unwrap_or_default();
        let shown = String::from_utf8_lossy(shown);
        let shown = shown.trim_end();
        let place = Place {
            file: self.source.name(),
            line,
            column: 1,
            end_column: shown.chars().count() + 1,
            text: shown.into(),
        };
        let figures = [like, set].map(|control| control.name().to_owned());
        let told = Diagnostic::of_option(Code::LooksLike, &figures, &place, self.setup.lang);
        self.report.warnings.push(told);
        Ok(())
    }

    /// Tells what looks wrong, but not on a line that is refused anyway.
    fn doubt(&mut self, alarm: &Alarm, inch: bool) {
        let refused = |known: &Diagnostic| {
            known.counted == alarm.span.line && !Allowed::may_have(known.number)
        };
        if !self.report.alarms.iter().any(refused) {
            self.tell(alarm, inch);
        }
    }

    /// Keeps where a warning is, also where its line is known already.
    fn mark(
        &mut self,
        alarm: &Alarm,
        (z, x): (f64, f64),
        (call, at, step): (&Call, Position, &Move),
    ) {
        if self.report.marks.len() == MARKS || self.program.allows(alarm) {
            return;
        }
        let place =
            |position: Position| (position.z.nm() as f64 / 1e6, position.x.nm() as f64 / 1e6);
        let zero = place(call.origin);
        self.report.marks.push(Mark {
            number: alarm.number(),
            line: alarm.span.line,
            from: place(at),
            to: place(step.to),
            at: (zero.0 + z, zero.1 + x),
        });
    }

    fn check_call(&mut self, call: &Call, inch: bool) {
        let moves = match cycle::expand(call, &self.setup.context(self.at, &self.hole)) {
            Ok(moves) => moves,
            Err(alarm) => {
                // The interpreter goes on at the end of the block. Cycles end where they begin, a stroke does not.
                if let CallKind::Thread(thread) = &call.kind
                    && thread.cycle.is_stroke()
                {
                    (self.at.x, self.at.z) = (thread.end_x.value, thread.end_z.value);
                }
                self.causes(call, inch);
                return self.tell(&alarm, inch);
            }
        };
        if let Err(alarm) = self.hole.admit(call, &moves) {
            self.tell(&alarm, inch);
        }
        if let Some(warning) = moves.warning() {
            self.tell(&warning, inch);
        }
        self.mind_spindle(call, inch);
        let params = &self.setup.params;
        let within = cycle::within_limits(&moves, self.at, params);
        let clear = cycle::clear_of_zones(&moves, self.at, &self.forbidden());
        if let CallKind::Aux(Aux::T(code)) = call.kind {
            self.tool = self.tool.after(code);
        }
        let time = cycle::time(&moves, self.at, params);
        // The move that went beyond the limit has been reported already.
        if let Err(alarm) = within
            && moves.into_iter().any(|step| step.to != self.at)
        {
            if !inch && self.beyond.len() < LISTED {
                self.beyond.push(alarm);
            }
            self.tell(&alarm, inch);
        }
        if let Err(alarm) = clear {
            self.tell(&alarm, inch);
        }
        let time_us = match time {
            Ok(time) => i64::try_from(time.as_micros()).unwrap_or(i64::MAX),
            // The findings for a thread say the same with more figures.
            Err(_) if matches!(call.kind, CallKind::Thread(_)) => 0,
            Err(alarm) => {
                self.tell(&alarm, inch);
                0
            }
        };
        match &call.kind {
            CallKind::Thread(thread) => self.thread(thread, call.span, time_us, inch),
            CallKind::Groove(groove) => {
                if let Some(warning) = cycle::groove_warning(groove) {
                    self.tell(&warning, inch);
                }
            }
            CallKind::Tap(tap) => self.tap(tap, call.span, time_us, inch),
            _ => {
                if let Err(alarm) = cycle::tap_spindle(call, self.setup.signals, params) {
                    self.tell(&alarm, inch);
                }
            }
        }
        if let Moves::Groove(groove) = &moves {
            // A cycle ends where it began.
            return self.groove(groove, call.span, time_us);
        }
        let mut plausible = std::mem::take(&mut self.plausible);
        for step in moves {
            let at = self.at;
            plausible.step(call, at, &step, &mut |alarm, place| {
                self.mark(&alarm, place, (call, at, &step));
                self.doubt(&alarm, inch);
            });
            self.report.moves += 1;
            if let Some(used) = tapper(&step).and_then(|n| self.report.tappers.get_mut(n)) {
                *used = true;
            }
            self.hole.push(&step);
            self.report.path_nm += length::nanometres(&self.at, &step);
            self.at = step.to;
        }
        self.plausible = plausible;
    }

    /// What the tip of the tool in place has to keep out of.
    fn forbidden(&self) -> Forbidden {
        let number = self.tool.number();
        let tip = self.program.offsets().tip(number);
        Forbidden::of(&self.setup.params, number, tip)
    }

    /// A feed per minute goes on even if the spindle stands; a feed per turn and a thread would not [D199]. The first of
    /// several such moves in a row is reported.
    fn mind_spindle(&mut self, call: &Call, inch: bool) {
        let at = self.at;
        let feed = match &call.kind {
            CallKind::Line(to, feed) if to.c == at.c && *to != at => Some(feed),
            CallKind::Arc(arc) => Some(&arc.feed),
            CallKind::Groove(groove) => Some(&groove.feed),
            _ => None,
        };
        let cuts = matches!(feed, Some(FeedRate::PerMinute(_))) && !self.setup.global.dry_run;
        self.spindle = self.spindle.behind(call);
        if cuts && self.spindle == Spindle::Stands {
            self.spindle = Spindle::Told;
            self.tell(&Alarm::new(Code::CutStanding, call.span), inch);
        }
    }

    fn keep(&mut self, cycle: CycleReport) {
        if self.lists_cycles() {
            self.report.cycles.push(cycle);
        } else if self.detail == Detail::Cycles {
            self.report.further_cycles += 1;
        }
    }

    /// The next cycle is kept with its figures: those that cost much need not be found for others.
    fn lists_cycles(&self) -> bool {
        self.detail == Detail::Cycles && self.report.cycles.len() < CYCLES
    }

    /// A groove: each different move with its number of repeats.
    fn groove(&mut self, groove: &GrooveMoves, span: Span, time_us: i64) {
        let report = &mut self.report;
        let counted = groove.tally(&mut |from, step, times| {
            report.moves += times;
            report.path_nm += length::nanometres(from, step) * times as f64;
            Ok(())
        });
        debug_assert_eq!(counted, Ok(()));
        self.keep(CycleReport {
            line: span.line,
            cycle: cycle_name(groove.cycle()),
            passes: u32::try_from(groove.totals().columns).unwrap_or(u32::MAX),
            tap_speed: None,
            tap_lead_in_nm: None,
            thread: None,
            time_us,
        });
    }

    /// A thread may be refused by its geometry for another reason: a feed rate in place of the lead makes a run-out that is
    /// longer than the thread. Physics can still be checked without run-in and run-out.
    fn causes(&mut self, call: &Call, inch: bool) {
        let CallKind::Thread(thread) = &call.kind else {
            return;
        };
        let mut bare = *thread;
        bare.run_in.value = Length::ZERO;
        bare.run_out = None;
        if let Ok(findings) = cycle::thread_findings(&bare, call.span, &self.setup.params) {
            for alarm in findings.alarms.iter().flatten() {
                self.tell(alarm, inch);
            }
        }
    }

    fn tap(&mut self, call: &TapCall, span: Span, time_us: i64, inch: bool) {
        let report = match cycle::tap_report(call, self.setup.signals, span, &self.setup.params) {
            Ok(report) => report,
            Err(alarm) => return self.tell(&alarm, inch),
        };
        for warning in report.warnings() {
            self.tell(&warning, inch);
        }
        self.keep(CycleReport {
            line: span.line,
            cycle: match call.cycle {
                TapCycle::G84 => "G84",
                TapCycle::G88 => "G88",
            },
            passes: match call.repeat {
                TapRepeat::Holes(holes) => u32::from(holes.get()),
                TapRepeat::Stay => 1,
            },
            tap_speed: Some(i64::from(report.fastest.get())),
            tap_lead_in_nm: report.join.map(|join| join.lead_in.nm()),
            thread: None,
            time_us,
        });
    }
}

impl Report {
    /// The JSON fields of a file.
    pub fn fields(&self, source: &SourceFile, machine: Option<&str>, json: &mut Json) {
        json.text("file", &source.name());
        match machine {
            Some(file) => json.text("machine", file),
            None => json.null("machine"),
        }
        self.diagnostics(json);
        json.array_at("cycles", |json| {
            for cycle in &self.cycles {
                json.object(|json| cycle.fields(json));
            }
        });
        if self.further_cycles > 0 {
            let further = i64::try_from(self.further_cycles).unwrap_or(i64::MAX);
            json.integer("further_cycles", further);
        }
    }

    /// Prints the list for a person, and the number of further lines.
    pub fn print(&self, setup: &Setup) {
        for diagnostic in self.alarms.iter().chain(&self.warnings) {
            diagnostics::print(diagnostic, setup.colour);
        }
        for kind in &self.unlisted {
            diagnostics::say(&format!("{}\n", kind.words().get(setup.lang)));
        }
    }

    /// Number of all alarms or of all warnings, listed or not.
    #[must_use]
    pub fn count(&self, warning: bool) -> u64 {
        let listed = if warning {
            &self.warnings
        } else {
            &self.alarms
        };
        let further = self.unlisted.iter().filter(|kind| kind.warning == warning);
        listed.len() as u64 + further.map(|kind| kind.lines).sum::<u64>()
    }

    /// `alarms` and `warnings`, and the number of those not listed.
    pub fn diagnostics(&self, json: &mut Json) {
        for (key, list) in [("alarms", &self.alarms), ("warnings", &self.warnings)] {
            json.array_at(key, |json| {
                for diagnostic in list {
                    json.object(|json| diagnostic.fields(json, true));
                }
            });
        }
        if !self.unlisted.is_empty() {
            json.array_at("further", |json| {
                for kind in &self.unlisted {
                    json.object(|json| {
                        json.integer("no", i64::from(kind.number));
                        json.integer("lines", i64::try_from(kind.lines).unwrap_or(i64::MAX));
                    });
                }
            });
        }
    }
}

impl CycleReport {
    fn fields(&self, json: &mut Json) {
        SourceLine(self.line).fields(json);
        json.text("cycle", self.cycle);
        json.integer("passes", i64::from(self.passes));
        if let Some(speed) = self.tap_speed {
            if let Some(lead_in) = self.tap_lead_in_nm {
                json.decimal::<6>("lead_in_mm", lead_in);
            }
            json.integer("rpm_max", speed / 100);
        }
        if let Some(thread) = &self.thread {
            json.decimal::<6>("z_shift_max_mm", thread.z_shift_max_nm);
            json.decimal::<6>("lead_in_mm", thread.lead_in_nm);
            json.decimal::<6>("start_before_mm", thread.start_before_nm);
            json.integer("rpm_max", thread.rpm_max);
            if let Some(error) = thread.encoder_error_nm {
                json.decimal::<6>("encoder_error_mm", error);
            }
            if let Some((turns, lead)) = thread.variable {
                json.decimal::<6>("turns", turns);
                json.decimal::<6>("lead_end_mm", lead);
            }
        }
        json.decimal::<6>("time_s", self.time_us);
    }

    /// One line for a person.
    pub fn text(&self) -> Both {
        let (line, cycle) = (SourceLine(self.line), self.cycle);
        let time = number::rounded::<6>(self.time_us, 1);
        if let Some(speed) = self.tap_speed {
            let join = self.tap_lead_in_nm.map_or(Both::default(), |lead_in| {
                let lead_in = number::rounded::<6>(lead_in, 3);
                both!(
                    "R at least {lead_in} mm before the material; ",
                    "R 至少在材料前 {lead_in} mm；"
                )
            });
            return both!(
                "line {line}: {cycle}, {holes}, {time} s; {join_en}up to {rpm} rpm",
                "第 {line} 行：{cycle}，{passes} 个孔，{time} s；{join_zh}最高 {rpm} r/min",
                holes = plural(self.passes, "hole"),
                passes = self.passes,
                join_en = join.en,
                join_zh = join.zh,
                rpm = number::rounded::<2>(speed, 1),
            );
        }
        let Some(thread) = &self.thread else {
            return both!(
                "line {line}: {cycle}, {columns}, {time} s",
                "第 {line} 行：{cycle}，{passes} 列，{time} s",
                columns = plural(self.passes, "column"),
                passes = self.passes,
            );
        };
        let variable = thread.variable.map_or(Both::default(), |(turns, lead)| {
            let (turns, lead) = (number::text::<6>(turns), number::text::<6>(lead));
            both!(
                "; {turns} turns, the lead at the end {lead} mm",
                "；{turns} 转，终点导程 {lead} mm"
            )
        });
        let error = thread.encoder_error_nm.map_or(Both::default(), |error| {
            let error = number::rounded::<6>(error, 3);
            both!(
                "; the encoder knows the angle to {error} mm along the lead",
                "；编码器在导程方向的误差不超过 {error} mm"
            )
        });
        both!(
            "line {line}: {cycle}, {plural}, {time} s; start at least {before} mm before the material (largest Z shift \
             {shift} + lead-in {lead_in}); up to {rpm} rpm{variable_en}{error_en}",
            "第 {line} 行：{cycle}，{passes} 刀，{time} s；起点至少在材料前 {before} mm（Z 向最大偏移 {shift} + 导入段 \
             {lead_in}）；最高 {rpm} r/min{variable_zh}{error_zh}",
            plural = plural(self.passes, "pass"),
            passes = self.passes,
            before = number::rounded::<6>(thread.start_before_nm, 3),
            shift = number::rounded::<6>(thread.z_shift_max_nm, 3),
            lead_in = number::rounded::<6>(thread.lead_in_nm, 3),
            rpm = thread.rpm_max,
            variable_en = variable.en,
            variable_zh = variable.zh,
            error_en = error.en,
            error_zh = error.zh,
        )
    }
}

/// The place, among spindles 2 to 4, of the spindle that a move taps with.
fn tapper(step: &Move) -> Option<usize> {
    let spindle = match step.kind {
        MoveKind::Tap(tap) => tap.spindle,
        MoveKind::Spindle(SpindleCall {
            mode: SpindleMode::Rigid(SpindleChoice::Written(spindle)),
            ..
        }) => spindle,
        _ => return None,
    };
    usize::from(spindle.number()).checked_sub(2)
}

/// `1 pass`, `2 passes`.
pub fn plural(count: impl Into<u64>, noun: &str) -> String {
    let count = count.into();
    match (count, noun.ends_with('s')) {
        (1, _) => format!("1 {noun}"),
        (_, true) => format!("{count} {noun}es"),
        (_, false) => format!("{count} {noun}s"),
    }
}
