//! Verifies a program without a machine: text, geometry, physics. `check` reports the result; `simulate` and `run` need it
//! before any motion.

use std::io::{BufReader, Read as _};

use leadscrew_core::alarm::{Alarm, Arg, Code, Span};
use leadscrew_core::call::{Call, CallKind, Position};
use leadscrew_core::moves::Move;
use leadscrew_core::program::Event;
use leadscrew_core::units::{Axis, Length};
use leadscrew_language::behind::not_carried_out;
use leadscrew_language::dialect::{Looks, Written, lengths};
use leadscrew_language::flow::Passes;
use leadscrew_language::heading::Allowed;
use leadscrew_language::lines::Lines;
use leadscrew_language::text::span;
use leadscrew_language::whose::Whose;
use leadscrew_verification::{CycleFigures, Findings, Machine, Verifier};

use crate::diagnostics::{self, Diagnostic, Place};
use crate::failure::{Doing, Failure, Outcome};
use crate::json::Json;
use crate::number;
use crate::place::SourceLine;
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
    pub cycles: Vec<CycleFigures>,
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

/// The place of a warning in the coordinates of its work zero: Z and radius in millimetres.
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
    let unreadable = |error| Failure::file(Doing::Read, source.name(), &error);
    let program = Program::open(source, &setup.params, setup.begin()).map_err(unreadable)?;
    let stock = program.stock().copied();
    let mut verifier = Verifier::new(Machine {
        params: &setup.params,
        offsets: setup.offsets.as_ref(),
        signals: setup.signals,
        at: setup.options().position,
        tap: setup.tap,
        tool: setup.tool,
        turning: setup.turning,
        dry_run: setup.global.dry_run,
        stock: stock.as_ref(),
    });
    let mut checker = Checker {
        setup,
        source,
        detail,
        report: Report::default(),
        inch: false,
        beyond: Vec::new(),
        program,
        last: Span::default(),
        end: None,
        again: false,
    };
    loop {
        let next = checker.program.next_event().map_err(unreadable)?;
        checker.inch = checker.program.is_inch();
        match next {
            None => break,
            Some(Ok(Event::Warning(warning))) => {
                checker.again |= warning.code == Code::MainRepeats;
                checker.tell(&warning);
            }
            Some(Ok(Event::Call(call))) => {
                checker.last = call.span;
                if let CallKind::End(_) = call.kind {
                    checker.end = Some(call.span);
                }
                let tip = checker.program.offsets().tip(verifier.tool().number());
                verifier.call(&call, tip, &mut checker);
            }
            Some(Err(alarm)) => checker.tell(&alarm),
        }
    }
    verifier.end(&mut checker);
    if checker.report.alarms.is_empty() {
        checker.mind_end()?;
    }
    checker.points()?;
    checker.look()?;
    Ok(Report {
        moves: verifier.moves(),
        path_nm: verifier.path_nm(),
        tappers: verifier.tappers(),
        ..checker.report
    })
}

/// What is told of a program, and its text.
struct Checker<'a> {
    setup: &'a Setup<'a>,
    source: &'a SourceFile,
    program: Program<'a>,
    detail: Detail,
    report: Report,
    /// The program is in inches where it is now.
    inch: bool,
    /// Alarms of travel on lines in millimetres.
    beyond: Vec<Alarm>,
    /// The latest action.
    last: Span,
    /// M30 or M02 that was carried out.
    end: Option<Span>,
    /// M99 begins the main program again.
    again: bool,
}

impl Findings for Checker<'_> {
    /// Keeps an alarm or a warning that is new on its line, and counts those beyond the list.
    fn tell(&mut self, alarm: &Alarm) {
        let again = Alarm::new(Code::MainBeginsAgain, alarm.span);
        let of_line = Alarm::new(Code::LineRepeats, alarm.span);
        let alarm = match (alarm.code, self.setup.passes) {
            (Code::MainRepeats, _) if self.setup.carried.is_some() => &of_line,
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
            list.push(Diagnostic::new(
                alarm,
                self.source,
                self.setup.lang,
                self.inch,
            ));
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

    /// Tells what looks wrong, but not on a line that is refused anyway.
    fn doubt(&mut self, alarm: &Alarm) {
        let refused = |known: &Diagnostic| {
            known.counted == alarm.span.line && !Allowed::may_have(known.number)
        };
        if !self.report.alarms.iter().any(refused) {
            self.tell(alarm);
        }
    }

    /// Keeps where a warning is, also where its line is known already.
    fn mark(&mut self, alarm: &Alarm, (z, x): (f64, f64), call: &Call, at: Position, step: &Move) {
        if self.report.marks.len() == MARKS || self.program.allows(alarm) {
            return;
        }
        let place = |position: Position| {
            let (z, x) = (position.z - call.origin.z, position.x - call.origin.x);
            (z.nm() as f64 / 1e6, x.nm() as f64 / 1e6)
        };
        self.report.marks.push(Mark {
            number: alarm.number(),
            line: alarm.span.line,
            from: place(at),
            to: place(step.to),
            at: (z, x),
        });
    }

    fn beyond(&mut self, alarm: &Alarm) {
        if !self.inch && self.beyond.len() < LISTED {
            self.beyond.push(*alarm);
        }
    }

    fn cycle(&mut self, mut figures: CycleFigures) {
        if figures.thread.is_some() && self.program.is_in_one_block(self.last) {
            figures.cycle = "G76";
        }
        if self.wants_figures() {
            self.report.cycles.push(figures);
        } else if self.detail == Detail::Cycles {
            self.report.further_cycles += 1;
        }
    }

    /// The next cycle is kept with its figures: those that cost much need not be found for others.
    fn wants_figures(&self) -> bool {
        self.detail == Detail::Cycles && self.report.cycles.len() < CYCLES
    }
}

impl Checker<'_> {
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
        // Those of lines in inches were not kept.
        self.inch = false;
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
                self.tell(&told.word(word.letter).with([figure]));
            }
        }
        Ok(())
    }

    /// Warns of a program without an end, and of one behind the end, or behind blocks that have none, that somebody may
    /// expect to run. A line that goes on behind others is no program [D444].
    fn mind_end(&mut self) -> Outcome {
        if self.end.is_none() && (self.again || self.setup.carried.is_some()) {
            return Ok(());
        }
        if self.end.is_none() && self.last.line > 0 {
            self.tell(&Alarm::new(Code::EndMissing, self.last));
        }
        let line = self.end.unwrap_or(self.last).line;
        if let Whose::Program = Whose::line(line) {
            let unreadable = |error| Failure::file(Doing::Read, self.source.name(), &error);
            let text = self.front()?;
            let told = not_carried_out(&mut Lines::new(&text[..]), line).map_err(unreadable)?;
            if let Some(told) = told {
                self.tell(&told);
            }
        }
        Ok(())
    }

    /// The first bytes of the text, in whole lines.
    fn front(&self) -> Outcome<Vec<u8>> {
        let unreadable = |error| Failure::file(Doing::Read, self.source.name(), &error);
        let mut text = Vec::new();
        let opened = self.source.open().map_err(unreadable)?;
        // A text is not read byte by byte.
        let mut front = BufReader::new(opened).take(LOOKED_AT as u64);
        front.read_to_end(&mut text).map_err(unreadable)?;
        // The line at its end may go on.
        if text.len() == LOOKED_AT {
            let whole = text.iter().rposition(|byte| *byte == b'\n');
            text.truncate(whole.map_or(0, |end| end + 1));
        }
        Ok(text)
    }

    /// Warns where the text looks as if it was written for another control; the remedy of what is refused first says so
    /// where it is for none that is read here.
    fn look(&mut self) -> Outcome {
        let assumed = self.program.assumed();
        if assumed.is_none() && self.report.alarms.is_empty() {
            return Ok(());
        }
        let text = self.front()?;
        let lines = || text.split(|byte| *byte == b'\n');
        let mut looks = Looks::default();
        for (number, line) in (1..).zip(lines()) {
            looks.line(number, line);
        }
        // A line that was typed comes from no post.
        if self.setup.carried.is_none()
            && looks.is_foreign()
            && let Some(first) = self.report.alarms.first_mut()
        {
            let words = both!(
                "this program is for Mach or LinuxCNC, and no dialect here reads it: let the post write it for a FANUC, a Haas or \
                 a GSK, and choose that with `--dialect`",
                "此程序用于 Mach 或 LinuxCNC，本系统的任何方言都不读取：请用后处理改为 FANUC、Haas 或 GSK 程序，并用 `--dialect` 选择"
            );
            first.help = words.get(self.setup.lang).to_owned();
        }
        let Some((set, (like, line))) = assumed.and_then(|set| Some((set, looks.like(set)?)))
        else {
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
                json.object(|json| cycle_fields(cycle, json));
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

fn cycle_fields(figures: &CycleFigures, json: &mut Json) {
    SourceLine(figures.line).fields(json);
    json.text("cycle", figures.cycle);
    json.integer("passes", i64::from(figures.passes));
    if let Some(speed) = figures.tap_speed {
        if let Some(lead_in) = figures.tap_lead_in_nm {
            json.decimal::<6>("lead_in_mm", lead_in);
        }
        json.integer("rpm_max", speed / 100);
    }
    if let Some(thread) = &figures.thread {
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
    json.decimal::<6>("time_s", figures.time_us);
}

/// One line for a person.
#[must_use]
pub fn cycle_text(figures: &CycleFigures) -> Both {
    let (line, cycle) = (SourceLine(figures.line), figures.cycle);
    let time = number::rounded::<6>(figures.time_us, 1);
    if let Some(speed) = figures.tap_speed {
        let join = figures.tap_lead_in_nm.map_or(Both::default(), |lead_in| {
            let lead_in = number::rounded::<6>(lead_in, 3);
            both!(
                "R at least {lead_in} mm before the material; ",
                "R 至少在材料前 {lead_in} mm；"
            )
        });
        return both!(
            "line {line}: {cycle}, {holes}, {time} s; {join_en}up to {rpm} rpm",
            "第 {line} 行：{cycle}，{passes} 个孔，{time} s；{join_zh}最高 {rpm} r/min",
            holes = plural(figures.passes, "hole"),
            passes = figures.passes,
            join_en = join.en,
            join_zh = join.zh,
            rpm = number::rounded::<2>(speed, 1),
        );
    }
    let Some(thread) = &figures.thread else {
        return both!(
            "line {line}: {cycle}, {columns}, {time} s",
            "第 {line} 行：{cycle}，{passes} 列，{time} s",
            columns = plural(figures.passes, "column"),
            passes = figures.passes,
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
        // In whole micrometres, rounded up: it is never none.
        let error = number::rounded::<6>(error.saturating_add(499), 3);
        both!(
            "; the encoder knows the angle to {error} mm along the lead, where the spindle swings with its turn or as 9034 says",
            "；编码器在导程方向的误差不超过 {error} mm（主轴随转动或按 9034 摆动时）"
        )
    });
    both!(
        "line {line}: {cycle}, {plural}, {time} s; start at least {before} mm before the material (largest Z shift \
         {shift} + lead-in {lead_in}); up to {rpm} rpm{variable_en}{error_en}",
        "第 {line} 行：{cycle}，{passes} 刀，{time} s；起点至少在材料前 {before} mm（Z 向最大偏移 {shift} + 导入段 \
         {lead_in}）；最高 {rpm} r/min{variable_zh}{error_zh}",
        plural = plural(figures.passes, "pass"),
        passes = figures.passes,
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

/// `1 pass`, `2 passes`.
pub fn plural(count: impl Into<u64>, noun: &str) -> String {
    let count = count.into();
    match (count, noun.ends_with('s')) {
        (1, _) => format!("1 {noun}"),
        (_, true) => format!("{count} {noun}es"),
        (_, false) => format!("{count} {noun}s"),
    }
}
