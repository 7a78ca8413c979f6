//! The path of a program for the page: the moves that are made of it, in the coordinates of their own work zero.
//!
//! ```text
//! walk ─► moves ─► segments in 0.1 µm, each with line, move and kind; where the zero changes, the pen is lifted
//! ```
//!
//! It must not know a canvas. What moves are made of a program is not decided here.

use leadscrew_core::call::Position;
use leadscrew_core::moves::{Move, MoveKind};
use leadscrew_core::units::{Axis, Length};
use leadscrew_core::zones::Zones;
use leadscrew_language::stock::Stock;
use leadscrew_language::whose::Whose;
use leadscrew_verification::arc;

use super::object;
use crate::drawing::mm;
use crate::failure::Outcome;
use crate::json::Json;
use crate::setup::Setup;
use crate::source::SourceFile;
use crate::walk::Walk;

/// The most segments: a few megabytes, and more than a screen can show.
const MOST: usize = 200_000;

/// A piece of the way.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Segment {
    /// `r`apid, `f`eed, `t`hread, ta`p`; `m`: the same place by another zero.
    kind: char,
    line: u32,
    number: u32,
    /// Its end: Z, radius, in tenths of µm: half a thousandth of a diameter is told by five.
    to: (i64, i64),
}

/// A zero, from a segment on.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Zero {
    from: usize,
    /// Machine coordinates.
    origin: Position,
    /// The same without the tool.
    work: [Length; 2],
}

#[derive(Debug)]
struct Path {
    segments: Vec<Segment>,
    zeros: Vec<Zero>,
    /// Machine coordinates.
    at: Position,
    number: u32,
    is_whole: bool,
}

impl Path {
    fn push(&mut self, step: &Move, zero: Zero) {
        self.number = self.number.saturating_add(1);
        let from = std::mem::replace(&mut self.at, step.to);
        if self.zeros.last().map(|last| (last.origin, last.work)) != Some((zero.origin, zero.work))
        {
            self.zeros.push(Zero {
                from: self.segments.len(),
                ..zero
            });
            self.add('m', step, place(&from, &zero.origin));
        }
        let (start, end) = (place(&from, &zero.origin), place(&step.to, &zero.origin));
        let kind = match step.kind {
            MoveKind::Rapid => 'r',
            MoveKind::Feed(_) => 'f',
            MoveKind::Thread(_) => 't',
            MoveKind::Tap(_) => 'p',
            MoveKind::Arc {
                i, k, clockwise, ..
            } => {
                let centre = (start.0 + mm(k.nm()), start.1 + mm(i.nm()));
                for point in arc(start, end, centre, clockwise).into_iter().skip(1) {
                    self.add('f', step, point);
                }
                return;
            }
            MoveKind::Dwell(_) | MoveKind::Spindle(_) | MoveKind::Aux(_) => return,
        };
        self.add(kind, step, end);
    }

    fn add(&mut self, kind: char, step: &Move, (z, x): (f64, f64)) {
        if self.segments.len() == MOST {
            self.is_whole = false;
            return;
        }
        let line = match Whose::line(step.span.line) {
            Whose::Program => step.span.line,
            Whose::Subprogram(_) => 0,
        };
        let tenths = |mm: f64| (mm * 1e4).round() as i64;
        self.segments.push(Segment {
            kind,
            line,
            number: self.number,
            to: (tenths(z), tenths(x)),
        });
    }
}

/// Z and radius in millimetres by a zero.
fn place(at: &Position, origin: &Position) -> (f64, f64) {
    (mm((at.z - origin.z).nm()), mm((at.x - origin.x).nm()))
}

/// The path of a program, as far as its first alarm, and what is around it.
pub fn json(setup: &Setup, source: &SourceFile, by: &str) -> Outcome<String> {
    let mut path = Path {
        segments: Vec::new(),
        zeros: Vec::new(),
        at: setup.options().position,
        number: 0,
        is_whole: true,
    };
    let mut walk = Walk::open(setup, source)?;
    while path.is_whole {
        let mut moves = Vec::new();
        let Some(call) = walk.next_call(|_, step| {
            // One call may have more than there is room for.
            if moves.len() <= MOST {
                moves.push(*step);
            }
        })?
        else {
            break;
        };
        let zero = Zero {
            from: 0,
            origin: call.origin,
            work: walk.work_zero(&call.origin),
        };
        for step in &moves {
            path.push(step, zero);
        }
    }
    let stock = walk.stock().copied();
    Ok(object(|json| {
        json.text("by", by);
        start(&setup.options().position, json);
        json.flag("whole", path.is_whole);
        fields(json, &path);
        around(json, setup, stock.as_ref());
    }))
}

/// Where a path begins, in machine coordinates.
pub fn start(at: &Position, json: &mut Json) {
    json.text("from", &format!("{} {}", at.x.nm(), at.z.nm()));
}

fn fields(json: &mut Json, path: &Path) {
    let kinds: String = path.segments.iter().map(|segment| segment.kind).collect();
    json.text("kinds", &kinds);
    // Differences are short.
    let list = |json: &mut Json, key: &str, of: &dyn Fn(&Segment) -> i64| {
        json.array_at(key, |json| {
            let mut last = 0;
            for segment in &path.segments {
                let value = of(segment);
                json.item(&(value - last).to_string());
                last = value;
            }
        });
    };
    list(json, "lines", &|segment| i64::from(segment.line));
    list(json, "numbers", &|segment| i64::from(segment.number));
    list(json, "z", &|segment| segment.to.0);
    list(json, "x", &|segment| segment.to.1);
    json.array_at("zeros", |json| {
        for zero in &path.zeros {
            json.object(|json| {
                json.integer("from", i64::try_from(zero.from).unwrap_or(i64::MAX));
                json.decimal::<6>("x", zero.origin.x.nm());
                json.decimal::<6>("z", zero.origin.z.nm());
                json.decimal::<6>("work_x", zero.work[0].nm());
                json.decimal::<6>("work_z", zero.work[1].nm());
            });
        }
    });
}

/// Limits of the travel (of the machine's zero), zones (of the spindle's), and the stock (of the work's); X are radii.
fn around(json: &mut Json, setup: &Setup, stock: Option<&Stock>) {
    let params = &setup.params;
    let [x, z] = [Axis::X, Axis::Z].map(|axis| {
        let ends = [params.soft_limit_minus(axis), params.soft_limit_plus(axis)];
        ends.map(Length::from_nm)
    });
    json.object_at("limits", |json| corners(json, x, z));
    match stock {
        Some(stock) => json.object_at("stock", |json| {
            let [bore, outside] = [stock.bore, stock.outside].map(Length::from_nm);
            let [back, front] = [stock.face - stock.length, stock.face].map(Length::from_nm);
            corners(json, [bore, outside], [back, front]);
        }),
        None => json.null("stock"),
    }
    json.array_at("zones", |json| {
        for (_, zone) in Zones::of(params).each() {
            let (x, z) = ([zone.x.low, zone.x.high], [zone.z.low, zone.z.high]);
            json.object(|json| corners(json, x, z));
        }
    });
}

fn corners(json: &mut Json, x: [Length; 2], z: [Length; 2]) {
    for (key, at) in [("x0", x[0]), ("x1", x[1]), ("z0", z[0]), ("z1", z[1])] {
        json.decimal::<6>(key, at.nm());
    }
}
