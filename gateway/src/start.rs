//! `run --from N`: a program is started at a line [D258].
//!
//! ```text
//! lines 1 to N-1, without motion ─► what they leave ─► shown, and N typed ─► spindle and coolant ─► approach ─► line N
//! ```
//!
//! Must not know boards or the simulated machine: it makes calls for either.

mod shown;

use std::collections::VecDeque;
use std::fmt::Write as _;
use std::io::{self, IsTerminal as _};

use leadscrew_core::alarm::{Alarm, Arg, Code, Lang, Span};
use leadscrew_core::call::{Aux, Call, CallKind, FeedRate, Position, SpindleCall, SpindleMode};
use leadscrew_core::params::{Params, gear_of_code};
use leadscrew_core::units::{Axis, Feed, Length, Rpm};
use leadscrew_core::zones::Zones;

use crate::commands::board::modal_words;
use crate::diagnostics::{self, Diagnostic, alarm_words};
use crate::failure::{Doing, Failure, Outcome};
use crate::number;
use crate::program::{Program, Start, Unfit};
use crate::setup::Setup;
use crate::source::SourceFile;
use crate::words::{Both, both};
pub use shown::Shown;

/// The approach goes at this part of rapid: at no feed override more than a quarter of it.
const PART: i64 = 6;

/// Why a line is no start.
#[derive(Debug)]
pub enum Unfound {
    /// The program is wrong before it.
    Wrong(Box<Diagnostic>),
    /// 4590; the file cannot be read.
    Because(Failure),
}

impl From<Failure> for Unfound {
    fn from(failure: Failure) -> Self {
        Self::Because(failure)
    }
}

/// A line that is a start.
#[derive(Debug)]
pub struct Found<'p> {
    /// What the lines before leave.
    pub start: Start,
    /// What comes next of it are the events of the line.
    program: Program<'p>,
}

/// How whoever starts it agrees to what would happen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Consent {
    /// It is shown now, and the number of the line has to be typed.
    Asked,
    /// In advance, whatever it is.
    Given,
    /// It was shown before, and what would happen now has to be just that [D499].
    To(Shown),
}

/// Finds the line, shows what would happen, and lets the operator agree. This alone decides whether what was shown is what
/// starts.
///
/// # Errors
/// 4590; the operator does not agree; it is not what was shown.
pub fn agree(setup: &Setup, source: &SourceFile, line: u32, consent: Consent) -> Outcome<Start> {
    let found = find(setup, source, line).map_err(|unfound| match unfound {
        Unfound::Wrong(told) => {
            diagnostics::print(&told, setup.colour);
            Failure::Wrong
        }
        Unfound::Because(failure) => failure,
    })?;
    if let Consent::To(shown) = consent {
        let (start, now) = Shown::of(found, setup, source)?;
        return shown.has_to_be(now).map(|()| start);
    }
    let start = found.start;
    let rows = shown(&start, setup);
    let text = both!(
        "{name}: start at line {line}\n{en}",
        "{name}：从第 {line} 行开始\n{zh}",
        name = source.shown(),
        en = rows.en,
        zh = rows.zh
    );
    diagnostics::say(text.get(setup.lang));
    if consent == Consent::Asked {
        confirm(line, setup.lang)?;
    }
    Ok(start)
}

/// Finds the line. Nothing is shown by it.
///
/// # Errors
/// The line is no start.
pub fn find<'p>(setup: &'p Setup, source: &SourceFile, line: u32) -> Result<Found<'p>, Unfound> {
    if setup.tap.is_some_and(|record| record.in_hole) {
        return Err(refusal(line, &both!("a tap is in its hole", "丝锥仍在孔中")).into());
    }
    let cannot = |error: io::Error| Failure::file(Doing::Read, source.name(), &error);
    let mut program = Program::open(source, &setup.params, setup.begin()).map_err(cannot)?;
    match program.start_at(line).map_err(cannot)? {
        Ok(start) => Ok(Found { start, program }),
        Err(Unfit::Wrong(alarm)) => {
            let told = Diagnostic::new(&alarm, source, setup.lang, program.is_inch());
            Err(Unfound::Wrong(Box::new(told)))
        }
        Err(Unfit::NotReached) if source.line(line).is_none() => Err(refusal(
            line,
            &both!("the file has fewer lines", "程序文件没有这么多行"),
        )
        .into()),
        Err(unfit) => Err(refusal(line, &why(&unfit)).into()),
    }
}

/// The number of the line has to be typed.
fn confirm(line: u32, lang: Lang) -> Outcome {
    let ask = both!("type {line} to begin: ", "输入 {line} 开始：");
    if io::stdin().is_terminal() {
        diagnostics::say(ask.get(lang));
    }
    let mut typed = String::new();
    let _ = io::stdin().read_line(&mut typed);
    if typed.trim() == line.to_string() {
        return Ok(());
    }
    Err(Failure::WrongBecause(both!(
        "not begun: {line} was not typed; nothing has moved",
        "未开始：没有输入 {line}；机床未移动"
    )))
}

fn refusal(line: u32, why: &Both) -> Failure {
    let alarm = Alarm::of(Code::NoStartHere, &[Arg::Int(line.into())]);
    let told = alarm_words(&alarm);
    Failure::WrongBecause(both!(
        "{why}: {told}",
        "{zh}：{told_zh}",
        why = why.en,
        told = told.en,
        zh = why.zh,
        told_zh = told.zh
    ))
}

fn why(unfit: &Unfit) -> Both {
    match unfit {
        Unfit::NotReached | Unfit::Wrong(_) => both!(
            "the program carries out no block of its own there",
            "该行没有独立执行的程序段"
        ),
        Unfit::Inside => both!(
            "the line belongs to a contour, a cycle of holes, a subprogram, a compensated path or a corner that began before it",
            "该行属于此前开始的轮廓、孔循环、子程序、刀补路径或倒角"
        ),
        Unfit::InCycle => both!(
            "the line goes on with a cycle that began before it",
            "该行是此前开始的循环的延续"
        ),
        Unfit::InChain => both!(
            "the line is a stroke that goes on from the one before",
            "该行的螺纹行程由前一行程延续"
        ),
        Unfit::Arc => both!("the line is an arc", "该行是圆弧"),
        Unfit::Incremental => both!("the line is incremental (U, W)", "该行为增量值（U、W）"),
        Unfit::Rigid => both!(
            "the spindle is in position mode there (M29)",
            "此处主轴处于位置方式（M29）"
        ),
        Unfit::Offsets => both!("G10 before it writes offsets", "此前的 G10 写入了偏置"),
        Unfit::Shift => both!(
            "G50 before it sets the zero by where the tool stands",
            "此前的 G50 按刀具当前位置设定零点"
        ),
    }
}

/// What would happen, for people: a row for each.
pub fn shown(start: &Start, setup: &Setup) -> Both {
    let in_lang = |lang: Lang| {
        let zh = lang == Lang::Zh;
        let mut text = String::new();
        let mut row = |en: &str, chinese: &str, value: &str| {
            let name = if zh { chinese } else { en };
            let _ = writeln!(text, "  {name}  {value}");
        };
        row("in force ", "模态    ", &modal_words(&start.carried));
        if let Some(tool) = start.tool {
            let said = both!("T{tool:04} has to be in place", "T{tool:04} 须已就位");
            row("tool     ", "刀具    ", said.get(lang));
        }
        if let Some(code) = gear(start, setup) {
            row("gear     ", "档位    ", &format!("M{code}"));
        }
        if let Some(spindle) = &start.spindle {
            row("spindle  ", "主轴    ", turning(spindle).get(lang));
        }
        if start.coolant {
            row("coolant  ", "冷却    ", "M08");
        }
        let given = |m: &&u16| gear_of_code(**m).is_some() && setup.params.has_gears();
        let left = start.functions.iter().filter(|m| !given(m));
        let codes: Vec<_> = left.map(|m| format!("M{m:02}")).collect();
        if !codes.is_empty() {
            row("not again", "不再执行", &codes.join(" "));
        }
        let zero = start.origin;
        let from = setup.options().position;
        row("begins at", "起点    ", &point(start.at, zero));
        let legs: Vec<_> = legs(from, start.at)
            .map(|(axis, to)| match axis {
                Axis::X => format!("X {}", diameter(to.x - zero.x)),
                _ => format!("Z {}", length(to.z - zero.z)),
            })
            .collect();
        let way = match legs.is_empty() {
            true => both!("none: the tool is there", "无：刀具已在该处"),
            false => both!(
                "{legs} at a sixth of rapid",
                "{legs}，快速的六分之一",
                legs = legs.join(", ")
            ),
        };
        row("approach ", "接近    ", way.get(lang));
        row("first    ", "首段    ", first(start, zero).get(lang));
        text
    };
    Both {
        en: in_lang(Lang::En),
        zh: in_lang(Lang::Zh),
    }
}

/// What the spindle does when the line begins.
fn turning(spindle: &SpindleCall) -> Both {
    let rpm = spindle.rpm.get();
    match spindle.mode {
        SpindleMode::Orient(angle) => {
            let angle = number::text::<6>(angle.udeg());
            both!(
                "at {angle}°, and held there (M19)",
                "定向在 {angle}° 并保持（M19）"
            )
        }
        SpindleMode::Surface(_) => both!(
            "{rpm} rpm, by the distance from the centre (G96)",
            "{rpm} rpm，随直径变化（G96）"
        ),
        SpindleMode::Speed | SpindleMode::Rigid(_) => Both::same(format!("{rpm} rpm")),
    }
}

fn first(start: &Start, zero: Position) -> Both {
    match start.first {
        Some(CallKind::Rapid(to)) => Both::same(format!("G00 {}", point(to, zero))),
        Some(CallKind::Line(to, _)) => Both::same(format!("G01 {}", point(to, zero))),
        Some(_) => both!("a cycle", "循环"),
        None => both!("no move in this line", "该行无移动"),
    }
}

fn point(at: Position, zero: Position) -> String {
    format!(
        "X {}  Z {}  (machine X {}  Z {})",
        diameter(at.x - zero.x),
        length(at.z - zero.z),
        diameter(at.x),
        length(at.z)
    )
}

fn diameter(x: Length) -> String {
    number::text::<6>(x.nm().saturating_mul(2))
}

fn length(z: Length) -> String {
    number::text::<6>(z.nm())
}

/// One axis after the other: X out as far as either of the two points, Z, X.
fn legs(from: Position, to: Position) -> impl Iterator<Item = (Axis, Position)> {
    let out = from.x.max(to.x);
    let legs = [
        (Axis::X, Position { x: out, ..from }),
        (
            Axis::Z,
            Position {
                x: out,
                z: to.z,
                ..from
            },
        ),
        (Axis::X, Position { c: from.c, ..to }),
    ];
    let mut at = from;
    legs.into_iter()
        .filter(move |(_, to)| std::mem::replace(&mut at, *to) != *to)
}

/// The programs before the rest of this one: spindle and coolant, then the approach. Each leaves the spindle as it is.
pub fn lead(start: &Start, setup: &Setup) -> VecDeque<VecDeque<Call>> {
    let call = |kind| Call {
        span: Span {
            line: start.line,
            ..Span::default()
        },
        origin: start.origin,
        kind,
    };
    let programs = [
        spindle_and_coolant(start, setup),
        approach(setup.options().position, start.at, &setup.params),
    ];
    programs
        .into_iter()
        .map(|kinds| {
            kinds
                .into_iter()
                .chain([CallKind::LineOver])
                .map(call)
                .collect()
        })
        .collect()
}

/// Where zones are set, the board has to know whose tip comes: the tool is in place, and its T word says so.
fn spindle_and_coolant(start: &Start, setup: &Setup) -> Vec<CallKind> {
    let gear = gear(start, setup).map(|code| CallKind::Aux(Aux::M(code)));
    let tool = start.tool.filter(|_| !Zones::of(&setup.params).are_off());
    let tool = tool.map(|code| CallKind::Aux(Aux::T(code)));
    let spindle = start.spindle.map(CallKind::Spindle);
    let coolant = start.coolant.then_some(CallKind::Aux(Aux::M(8)));
    let beside = gear.into_iter().chain(tool).chain(spindle);
    beside.chain(coolant).collect()
}

/// The M code of the gear that the lines before have selected, where that is not in.
fn gear(start: &Start, setup: &Setup) -> Option<u16> {
    let code = start.gear.filter(|_| setup.params.has_gears())?;
    (gear_of_code(code) != Some(setup.gear)).then_some(code)
}

fn approach(from: Position, to: Position, params: &Params) -> Vec<CallKind> {
    let slow = |axis| {
        let rapid = params.rapid(axis).nm_per_min() / PART;
        let most = params.max_feed(axis).nm_per_min();
        FeedRate::PerMinute(Feed::from_nm_per_min(rapid.min(most)))
    };
    let moves = legs(from, to).map(|(axis, to)| CallKind::Line(to, slow(axis)));
    [CallKind::ExactStop(true)]
        .into_iter()
        .chain(moves)
        .collect()
}

/// The spindle turns as it is told.
#[must_use]
pub fn has_arrived(speed: Rpm, command: Rpm, params: &Params) -> bool {
    let (speed, command) = (i64::from(speed.get()), i64::from(command.get()));
    let off = (speed - command).abs() * 100;
    off <= command.abs() * i64::from(params.spindle_tolerance_percent())
}

#[cfg(test)]
mod tests;
