//! What a program cuts, feature by feature: its threads with their passes, its grooves with their columns, its turned
//! contours, its tapped holes with their strokes, and its drilled ones with their pecks. Made from the moves of a program
//! that has been checked; must not know how they are drawn.

mod depth;
mod drill;
mod tap;
mod thread;
mod typed;
mod width;

use std::ops::RangeInclusive;

use leadscrew_core::alarm::Lang;
use leadscrew_core::call::{Aux, Call, Position};
use leadscrew_core::moves::{Cycle, Move, MoveKind, Stage, Tag, TapMove};
use leadscrew_core::units::Length;
use leadscrew_inspection::{Edge, Wish, tool_of};
use leadscrew_language::drilling::Kind as Drilling;
use leadscrew_language::stock::Stock as Declared;
use leadscrew_verification::arc;

pub use self::typed::tell_idle;
pub use self::width::Width;

use self::tap::Holes;
use self::thread::{Lathe, Threads};
use crate::checking::Report;
use crate::drawing::mm;
use crate::failure::Outcome;
use crate::inspection::plan::plan;
use crate::movelist::cycle_name;
use crate::number::measured;
use crate::plot::{Across, Column, Contour, Feature, Groove, Piece, Shape, Stock};
use crate::setup::Setup;
use crate::source::SourceFile;
use crate::walk::Walk;
use crate::words::{both, pick};

/// The most features of a picture.
const FEATURES: usize = 24;
/// The most pieces of one of them.
const PIECES: usize = 5_000;

/// What is known of the tools.
#[derive(Clone, Debug, Default)]
pub struct Tools {
    /// Edges of threading tools.
    pub edges: Vec<Edge>,
    /// Widths of grooving tools.
    pub widths: Vec<Width>,
}

/// The features of a program.
#[derive(Clone, Debug, Default)]
pub struct Features {
    /// In the order of cutting.
    pub list: Vec<Feature>,
    /// What there is before the first cut, where the program declares it.
    pub stock: Option<Stock>,
    /// The number of those, and of pieces of them, that did not fit.
    pub left_out: u64,
}

/// A feature with what its name is made of.
#[derive(Debug)]
struct Found {
    /// First and last line as the machine counts them.
    lines: (u32, u32),
    /// The moves of a tapped hole, by their numbers.
    steps: Vec<RangeInclusive<u64>>,
    tool: u32,
    cycle: Option<Cycle>,
    shape: Kind,
}

#[derive(Debug)]
enum Kind {
    /// The number of a thread.
    Thread(usize),
    Groove(Groove),
    Contour(Contour),
    Tap(Box<Holes>),
    Drilled(Box<drill::Holes>),
}

/// Collects them.
///
/// # Errors
/// The program cannot be read.
pub fn collect(
    setup: &Setup,
    source: &SourceFile,
    report: &Report,
    tools: &Tools,
) -> Outcome<Features> {
    let mut walk = Walk::open(setup, source)?;
    let declared = walk.stock().copied();
    let stock = declared.map(|stock| Stock {
        outside: mm(stock.outside),
        bore: mm(stock.bore),
        face: mm(stock.face),
        length: mm(stock.length),
    });
    let wish = Wish {
        tools: tools.edges.clone(),
        ..Wish::default()
    };
    let planned = plan(setup, source, &wish)?;
    let rim = stock.map(|stock| stock.outside);
    let mut finder = Finder {
        tools,
        stock: declared,
        threads: Threads::new(planned, rim),
        found: Vec::new(),
        at: setup.options().position,
        tool: 0,
        step: 0,
        left_out: 0,
    };
    while let Some(call) =
        walk.next_with_drilling(|call, step, drilling| finder.push(call, step, drilling))?
    {
        finder.threads.lead_in(&call, &setup.params);
    }
    let mut features = finder.finish(report, setup.lang);
    features.stock = stock;
    Ok(features)
}

struct Finder<'a> {
    tools: &'a Tools,
    stock: Option<Declared>,
    threads: Threads,
    found: Vec<Found>,
    at: Position,
    tool: u32,
    step: u64,
    left_out: u64,
}

impl Finder<'_> {
    fn push(&mut self, call: &Call, step: &Move, drilling: Option<Drilling>) {
        self.step += 1;
        let of_work = |position: &Position| {
            let (z, x) = (position.z - call.origin.z, position.x - call.origin.x);
            (mm(z.nm()), mm(x.nm()))
        };
        let (from, to) = (of_work(&self.at), of_work(&step.to));
        let start = std::mem::replace(&mut self.at, step.to);
        let line = step.span.line;
        match step.kind {
            MoveKind::Aux(Aux::T(code)) => self.tool = tool_of(code.into()),
            MoveKind::Thread(thread) => {
                let lathe = Lathe { from, to, line };
                if let Some(number) = self.threads.push(self.step, step, &thread, lathe) {
                    self.thread(number, line, step.tag.map(|tag| tag.cycle));
                }
            }
            MoveKind::Feed(_) if let Some(kind) = drilling => {
                self.drill(kind, (&start, &step.to), &call.origin, line);
            }
            MoveKind::Feed(_) => match step.tag {
                Some(tag) if matches!(tag.cycle, Cycle::G74 | Cycle::G75) => {
                    if tag.stage == Stage::Peck {
                        self.peck(line, tag, from, to);
                    }
                }
                tag => self.piece(line, tag.map(|tag| tag.cycle), vec![from, to]),
            },
            MoveKind::Arc {
                i, k, clockwise, ..
            } => {
                let centre = (from.0 + mm(k.nm()), from.1 + mm(i.nm()));
                self.piece(line, None, arc(from, to, centre, clockwise));
            }
            MoveKind::Tap(tap) => {
                let way = (tap.axis.of(start), tap.axis.of(step.to));
                self.tap(&tap, step, way, tap.axis.of(call.origin));
            }
            MoveKind::Rapid => {
                if let Some(Found {
                    shape: Kind::Drilled(holes),
                    ..
                }) = self.found.last_mut()
                {
                    holes.rapid(&step.to);
                }
            }
            // At the bottom of a hole the tap is held to its spindle.
            MoveKind::Dwell(_) if step.tag.is_some() => {
                if let Some(found) = self.found.last_mut() {
                    join(&mut found.steps, self.step);
                }
            }
            MoveKind::Dwell(_) | MoveKind::Spindle(_) | MoveKind::Aux(_) => {}
        }
    }

    /// The last feature, where the tool goes on in it.
    fn last(&mut self, cycle: Option<Cycle>) -> Option<&mut Found> {
        let tool = self.tool;
        let last = self.found.last_mut();
        last.filter(|last| last.tool == tool && last.cycle == cycle)
    }

    fn begin(&mut self, cycle: Option<Cycle>, line: u32, shape: Kind) {
        if self.found.len() == FEATURES {
            self.left_out += 1;
            return;
        }
        self.found.push(Found {
            lines: (line, line),
            steps: Vec::new(),
            tool: self.tool,
            cycle,
            shape,
        });
    }

    fn thread(&mut self, number: usize, line: u32, cycle: Option<Cycle>) {
        let known = self.found.iter_mut().rev();
        let mut same = known.filter(|found| matches!(found.shape, Kind::Thread(n) if n == number));
        match same.next() {
            Some(found) => found.lines.1 = line,
            None => self.begin(cycle, line, Kind::Thread(number)),
        }
    }

    fn tap(&mut self, tap: &TapMove, step: &Move, way: (Length, Length), zero: Length) {
        let (line, cycle) = (step.span.line, step.tag.map(|tag| tag.cycle));
        let is_alike =
            |found: &Found| matches!(&found.shape, Kind::Tap(holes) if holes.is_alike(tap));
        if !self.last(cycle).is_some_and(|last| is_alike(last)) {
            let holes = Holes::new(tap, zero, self.stock.as_ref());
            self.begin(cycle, line, Kind::Tap(Box::new(holes)));
        }
        let number = self.step;
        let last = self.last(cycle).filter(|last| is_alike(last));
        let Some(Found {
            shape: Kind::Tap(holes),
            lines,
            steps,
            ..
        }) = last
        else {
            return;
        };
        lines.1 = line;
        if !join(steps, number) && steps.len() < PIECES {
            steps.push(number..=number);
        }
        if !holes.push(tap, step.tag, line, way) {
            self.left_out += 1;
        }
    }

    fn drill(&mut self, kind: Drilling, way: (&Position, &Position), origin: &Position, line: u32) {
        let is_of = |found: &Found| {
            let same = |holes: &drill::Holes| holes.is_of(kind, way.0);
            found.lines.0 == line && matches!(&found.shape, Kind::Drilled(holes) if same(holes))
        };
        if !self.last(None).is_some_and(|last| is_of(last)) {
            let holes = drill::Holes::new(kind, way, origin, self.stock);
            self.begin(None, line, Kind::Drilled(Box::new(holes)));
        }
        let last = self.last(None).filter(|last| is_of(last));
        if let Some(Found {
            shape: Kind::Drilled(holes),
            ..
        }) = last
            && !holes.feed(way, origin, line)
        {
            self.left_out += 1;
        }
    }

    fn piece(&mut self, line: u32, cycle: Option<Cycle>, points: Vec<(f64, f64)>) {
        let piece = Piece { line, points };
        let mut is_full = false;
        if let Some(Found {
            shape: Kind::Contour(contour),
            lines,
            ..
        }) = self.last(cycle)
        {
            lines.1 = line;
            is_full = contour.pieces.len() == PIECES;
            if !is_full {
                contour.pieces.push(piece);
                return;
            }
        }
        if is_full {
            self.left_out += 1;
        } else {
            let pieces = vec![piece];
            self.begin(cycle, line, Kind::Contour(Contour { pieces }));
        }
    }

    fn peck(&mut self, line: u32, tag: Tag, from: (f64, f64), to: (f64, f64)) {
        let cycle = Some(tag.cycle);
        let across = match tag.cycle {
            Cycle::G74 => Across::Z,
            _ => Across::X,
        };
        let (from, to) = (across.of(from), across.of(to));
        let width = self
            .tools
            .widths
            .iter()
            .find(|width| width.tool == self.tool);
        let width = width.map(|width| width.mm);
        let mut column = Column {
            number: 1,
            line,
            from,
            pecks: vec![to],
        };
        // Each block makes a groove of its own; carried out again, it cuts further columns of it.
        let is_same = self.found.last().is_some_and(|last| last.lines.0 == line);
        let last = self.last(cycle).filter(|_| is_same);
        let Some(Found {
            shape: Kind::Groove(groove),
            ..
        }) = last
        else {
            let groove = Groove {
                across,
                columns: vec![column],
                width,
            };
            return self.begin(cycle, line, Kind::Groove(groove));
        };
        let has_room = groove.columns.len() < PIECES;
        match groove.columns.last_mut() {
            Some(last) if last.from.0 == column.from.0 && tag.peck > 1 => {
                if last.pecks.len() < PIECES {
                    last.pecks.push(to);
                } else {
                    self.left_out += 1;
                }
            }
            _ if has_room => {
                column.number = u32::try_from(groove.columns.len() + 1).unwrap_or(u32::MAX);
                groove.columns.push(column);
            }
            _ => self.left_out += 1,
        }
    }

    fn finish(self, report: &Report, lang: Lang) -> Features {
        let threads = self.threads;
        let left_out = self.left_out + threads.left_out;
        let features = self.found.into_iter().map(|found| {
            let warnings = report
                .warnings
                .iter()
                .filter(|warning| (found.lines.0..=found.lines.1).contains(&warning.counted))
                .map(|warning| format!("{} {}", warning.number, warning.message));
            let mut warnings: Vec<String> = warnings.collect();
            // One of many lines is told once.
            warnings.dedup();
            let name = name(&found, lang);
            let mut steps = found.steps;
            let (figures, shape) = match found.shape {
                Kind::Thread(number) => {
                    steps = threads.steps(number);
                    threads.feature(number, lang)
                }
                Kind::Groove(groove) => (columns(&groove, found.tool, lang), Shape::Groove(groove)),
                Kind::Contour(contour) => (Vec::new(), Shape::Contour(contour)),
                Kind::Tap(holes) => {
                    let (figures, tap) = holes.feature(lang);
                    (figures, Shape::Tap(tap))
                }
                Kind::Drilled(holes) => {
                    let (figures, drilled) = holes.feature(lang);
                    (figures, Shape::Drilled(drilled))
                }
            };
            Feature {
                name,
                steps,
                phase: None,
                figures,
                warnings,
                shape,
            }
        });
        Features {
            list: features.collect(),
            stock: None,
            left_out,
        }
    }
}

/// Adds a move to the last of these, where it is the next one.
fn join(steps: &mut [RangeInclusive<u64>], number: u64) -> bool {
    let last = steps.last_mut();
    let last = last.filter(|last| *last.end() + 1 == number);
    last.map(|last| *last = *last.start()..=number).is_some()
}

/// `line 43-44 · T3 · G76`.
fn name(found: &Found, lang: Lang) -> String {
    let lines = match found.lines {
        (a, b) if a == b => crate::place::SourceLine(a).to_string(),
        (a, b) => format!(
            "{}–{}",
            crate::place::SourceLine(a),
            crate::place::SourceLine(b)
        ),
    };
    let lines = both!("line {lines}", "第 {lines} 行");
    let tool = match found.tool {
        0 => String::new(),
        tool => format!(" · T{tool}"),
    };
    let what = match (&found.shape, found.cycle) {
        (Kind::Drilled(holes), _) => holes.code(),
        (Kind::Contour(_), None) => pick(lang, "turning", "车削"),
        (_, Some(cycle)) => cycle_name(cycle),
        (_, None) => pick(lang, "thread", "螺纹"),
    };
    format!("{what}{tool} · {}", lines.get(lang))
}

/// The figures of a groove.
fn columns(groove: &Groove, tool: u32, lang: Lang) -> Vec<String> {
    let bottoms = groove.columns.iter().map(|column| column.bottom().1);
    let (deepest, highest) = bottoms.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), at| {
        (low.min(at), high.max(at))
    });
    let pecks: usize = groove.columns.iter().map(|column| column.pecks.len()).sum();
    let count = groove.columns.len();
    let bottom = groove.across.size(deepest);
    let bottom = match groove.across.size(highest) {
        other if other != bottom => both!(
            "bottoms from {other} to {bottom}",
            "槽底 {other} 至 {bottom}"
        ),
        _ => both!("bottom {bottom}", "槽底 {bottom}"),
    };
    let told = both!(
        "{en} · columns: {count}, feeds: {pecks}",
        "{zh} · {count} 列，进给 {pecks} 次",
        en = bottom.en,
        zh = bottom.zh
    );
    let mut lines = vec![told.get(lang).to_owned()];
    let told = match groove.width.map(measured) {
        Some(width) if groove.is_drilled() => {
            both!("tool of ⌀{width}, on the axis", "刀具 ⌀{width}，在轴线上")
        }
        Some(width) if groove.across == Across::Z => both!(
            "tool {width} mm wide, programmed at its corner toward the axis",
            "刀宽 {width} mm，刀位点为靠轴线侧刀尖"
        ),
        Some(width) => both!(
            "tool {width} mm wide, programmed at its corner toward -Z",
            "刀宽 {width} mm，刀位点为 -Z 侧刀尖"
        ),
        None => both!(
            "tool width not known, its corner is drawn: add `--tool-width T{tool}=MM`",
            "刀宽未知，只画刀位点：请加 `--tool-width T{tool}=MM`"
        ),
    };
    lines.push(told.get(lang).to_owned());
    lines
}
