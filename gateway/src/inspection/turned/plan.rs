//! The grooves and the turned contours of a program that has been checked, and which of its moves cut them.

use leadscrew_core::call::{Aux, Call, Position};
use leadscrew_core::moves::{Cycle, Move, MoveKind, Stage};
use leadscrew_metrology::{Element, Mm, Place, Side};

use super::{Groove, Outline, Piece, Plan};
use crate::drawing::mm;
use crate::failure::Outcome;
use crate::features::Width;
use crate::plot::Across;
use crate::setup::Setup;
use crate::source::SourceFile;
use crate::walk::Walk;
use leadscrew_inspection::tool_of;

/// The most cuts of a contour: more are a picture, not a part that is measured.
const PIECES: usize = 5_000;
/// A length below this is none.
const NONE: Mm = Mm(1e-6);

/// Finds them.
///
/// # Errors
/// The program cannot be read.
pub fn plan(setup: &Setup, source: &SourceFile, widths: &[Width]) -> Outcome<Plan> {
    let mut finder = Finder {
        widths,
        plan: Plan::default(),
        at: setup.options().position,
        tool: 0,
        step: 0,
        goes_on: false,
        away: 0,
    };
    let mut walk = Walk::open(setup, source)?;
    while walk
        .next_call(|call, each| finder.push(call, each))?
        .is_some()
    {}
    finder.end_outline();
    Ok(finder.plan)
}

struct Finder<'a> {
    widths: &'a [Width],
    plan: Plan,
    at: Position,
    tool: u32,
    step: u64,
    /// The last contour is not over.
    goes_on: bool,
    /// Rapids away from its cuts: those outwards minus those inwards.
    away: i32,
}

impl Finder<'_> {
    fn push(&mut self, call: &Call, each: &Move) {
        self.step += 1;
        let of_work = |at: &Position| -> Place {
            let (z, x) = (at.z - call.origin.z, at.x - call.origin.x);
            (Mm(mm(z.nm())), Mm(mm(x.nm())))
        };
        let (from, to) = (of_work(&self.at), of_work(&each.to));
        self.at = each.to;
        let origin = (Mm(mm(call.origin.x.nm())), Mm(mm(call.origin.z.nm())));
        match each.kind {
            MoveKind::Aux(Aux::T(code)) => {
                self.tool = tool_of(code.into());
                self.end_outline();
            }
            MoveKind::Thread(_) | MoveKind::Tap(_) => self.end_outline(),
            MoveKind::Feed(_) => match each.tag {
                Some(tag) if matches!(tag.cycle, Cycle::G74 | Cycle::G75) => {
                    self.end_outline();
                    if tag.stage == Stage::Peck {
                        self.peck(each.span.line, tag.cycle, from, to, origin);
                    }
                }
                _ => self.cut(
                    each.span.line,
                    Element {
                        from,
                        to,
                        arc: None,
                    },
                    origin,
                ),
            },
            MoveKind::Arc {
                i, k, clockwise, ..
            } => {
                let centre = (from.0 + Mm(mm(k.nm())), from.1 + Mm(mm(i.nm())));
                let arc = Some((centre, clockwise));
                self.cut(each.span.line, Element { from, to, arc }, origin);
            }
            MoveKind::Rapid => self.leave(to.1 - from.1),
            MoveKind::Dwell(_) | MoveKind::Spindle(_) | MoveKind::Aux(_) => {}
        }
    }

    /// The first rapid after a cut says on which side there is no material; one along Z leaves it to the last cut, where
    /// that comes away from another.
    fn leave(&mut self, outward: Mm) {
        let pieces = self
            .plan
            .outlines
            .last()
            .map(|outline| outline.pieces.as_slice());
        let Some([before @ .., last]) = pieces.filter(|_| self.goes_on) else {
            return;
        };
        if last.step + 1 != self.step {
            return;
        }
        let mut outward = outward;
        let Element { from, to, .. } = last.element;
        let comes_away = |before: &Piece| before.element.to == from && !is_face(&before.element);
        // To the axis it is a face that was cut.
        if outward.0.abs() <= NONE.0 && before.last().is_some_and(comes_away) && to.1 > Mm(0.5) {
            outward = to.1 - from.1;
        }
        self.away += i32::from(outward > NONE) - i32::from(outward < -NONE);
    }

    fn cut(&mut self, line: u32, element: Element, origin: (Mm, Mm)) {
        if element.from == element.to && element.arc.is_none() {
            return;
        }
        let tool = self.tool;
        if !self.goes_on {
            self.plan.outlines.push(Outline {
                tool,
                side: Side::External,
                pieces: Vec::new(),
                origin,
            });
            (self.goes_on, self.away) = (true, 0);
        }
        if let Some(outline) = self.plan.outlines.last_mut()
            && outline.pieces.len() < PIECES
        {
            outline.pieces.push(Piece {
                line,
                element,
                stays: true,
                step: self.step,
            });
        }
    }

    fn end_outline(&mut self) {
        if !std::mem::take(&mut self.goes_on) {
            return;
        }
        if let Some(outline) = self.plan.outlines.last_mut() {
            if self.away < 0 {
                outline.side = Side::Internal;
            }
            outline.mark();
        }
    }

    fn peck(&mut self, line: u32, cycle: Cycle, from: Place, to: Place, origin: (Mm, Mm)) {
        let across = match cycle {
            Cycle::G74 => Across::Z,
            _ => Across::X,
        };
        let of = |(z, radius): Place| {
            let (along, up) = across.of((z.0, radius.0));
            (Mm(along), Mm(up))
        };
        let ((_, begin), (along, floor)) = (of(from), of(to));
        if across == Across::Z && along.0 == 0.0 {
            // A hole on the axis has no width to measure.
            return;
        }
        let width = self.widths.iter().find(|width| width.tool == self.tool);
        let width = width.map(|width| Mm(width.mm));
        let moves = (self.step, self.step + 1);
        let reach = width.unwrap_or(Mm(f64::INFINITY));
        let last = self.plan.grooves.last_mut().filter(|last| {
            let (low, high) = last.corners;
            last.line == line && along >= low - reach && along <= high + reach
        });
        match last {
            Some(groove) => {
                let (low, high) = groove.corners;
                groove.corners = (Mm(low.0.min(along.0)), Mm(high.0.max(along.0)));
                groove.moves.1 = moves.1;
                groove.floor = floor;
            }
            None => self.plan.grooves.push(Groove {
                line,
                tool: self.tool,
                across,
                width,
                corners: (along, along),
                begin,
                floor,
                moves,
                origin,
            }),
        }
    }
}

/// Z does not change, X does.
fn is_face(element: &Element) -> bool {
    let (z, r) = (element.to.0 - element.from.0, element.to.1 - element.from.1);
    element.arc.is_none() && z.0.abs() < NONE.0 && r.0.abs() > NONE.0
}

/// The height of an element at a Z within it: the radius of an outer surface, minus that of an inner one.
fn height(element: &Element, z: f64, side: Side) -> Option<f64> {
    let (a, b) = (element.from.0.0, element.to.0.0);
    if z <= a.min(b) + NONE.0 || z >= a.max(b) - NONE.0 {
        return None;
    }
    let radius = match element.arc {
        None => {
            let share = (z - a) / (b - a);
            element.from.1.0 + share * (element.to.1 - element.from.1).0
        }
        Some((centre, _)) => {
            let radius = (element.from.0 - centre.0)
                .0
                .hypot((element.from.1 - centre.1).0);
            let off = (radius * radius - (z - centre.0.0).powi(2)).max(0.0).sqrt();
            // The half that it runs through.
            let middle = f64::midpoint(element.from.1.0, element.to.1.0);
            centre.1.0 + off.copysign(middle - centre.1.0)
        }
    };
    Some(side.height(radius))
}

impl Outline {
    /// Finds the cuts that are the surface in the end.
    fn mark(&mut self) {
        /// What is deeper by less is another cut of the same surface.
        const DEEPER: f64 = 0.001;
        /// What is looked at on either side of a face.
        const BESIDE: f64 = 0.01;
        let side = self.side;
        let all: Vec<Element> = self.pieces.iter().map(|piece| piece.element).collect();
        let lowest = |z: f64| {
            let heights = all.iter().filter_map(|other| height(other, z, side));
            heights.fold(f64::INFINITY, f64::min)
        };
        for piece in self
            .pieces
            .iter_mut()
            .filter(|piece| !is_face(&piece.element))
        {
            let (a, b) = (piece.element.from.0.0, piece.element.to.0.0);
            let mut places = [0.25, 0.5, 0.75]
                .map(|share| a + share * (b - a))
                .into_iter();
            piece.stays = places.any(|z| {
                let own = height(&piece.element, z, side);
                own.is_some_and(|own| own <= lowest(z) + DEEPER)
            });
        }
        for piece in self
            .pieces
            .iter_mut()
            .filter(|piece| is_face(&piece.element))
        {
            let middle = |element: &Element| f64::midpoint(element.from.1.0, element.to.1.0);
            let (z, r) = (piece.element.from.0.0, middle(&piece.element));
            let own = side.height(r);
            let has_material = [z - BESIDE, z + BESIDE]
                .map(lowest)
                .iter()
                .any(|low| *low >= own);
            let mut others = all.iter().filter(|other| is_face(other));
            piece.stays = has_material
                && !others.any(|other| {
                    let (a, b) = (other.from.1.0, other.to.1.0);
                    let at = other.from.0.0;
                    let covers = r > a.min(b) && r < a.max(b) && at < z - DEEPER;
                    // Material between the two keeps them apart.
                    let between = lowest(f64::midpoint(at, z));
                    covers && (between.is_infinite() || between < own)
                });
        }
    }
}
