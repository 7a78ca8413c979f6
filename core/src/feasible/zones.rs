//! Zones (9091 to 9097): the whole path of every move, with the ways that a hold or a reset may take from it.
//!
//! A rapid, a cut and a tap are their path. Cuts that may be joined leave it by the tolerance of corners (9033) at most.
//! From a stroke of a thread the tool is drawn back straight to the level where the cycle began, from any of its points;
//! run-in and run-out are not exactly straight, so the whole rectangle of their ends counts. A stroke of G32 has no such
//! level: it is finished. The way out of a hole is never refused [D346].

use super::way::{Met, Way, met};
use crate::alarm::{Alarm, Arg, Code, Span};
use crate::call::Position;
use crate::moves::{Cycle, Move, MoveKind, Stage};
use crate::params::Params;
use crate::units::{Axis, Diameter, Length};
use crate::zones::{CLEARANCE, Extent, Point, Zones};

/// What moves have to keep out of.
#[derive(Clone, Copy, Debug)]
pub struct Forbidden {
    /// The zones.
    pub zones: Zones,
    /// Number of the tool's offset; 0: no tool was called.
    pub tool: u8,
    /// Where the machine is with the tip at zero: geometry and wear. `None`: nobody has measured it.
    pub tip: Option<Point>,
    /// How far joined cuts may leave their path.
    beside: Length,
}

impl Forbidden {
    /// The zones of a parameter set, for the tip of a tool.
    #[must_use]
    pub fn of(params: &Params, tool: u8, tip: Option<Point>) -> Self {
        Self {
            zones: Zones::of(params),
            tool,
            tip,
            beside: params.corner_tolerance(),
        }
    }

    /// Checks a way of the machine.
    ///
    /// # Errors
    /// [`Code::ZoneEntered`]; [`Code::TipUnknown`].
    pub(crate) fn way(
        &self,
        from: Position,
        to: Position,
        way: &Way,
        beside: Length,
        span: Span,
    ) -> Result<(), Alarm> {
        let Some([tip_x, tip_z]) = self.tip else {
            let figures = [Arg::Int(self.tool.into())];
            return Err(Alarm::new(Code::TipUnknown, span).with(figures));
        };
        let way = match *way {
            Way::DownToX(level) => Way::DownToX(level - tip_x),
            Way::DownToZ(level) => Way::DownToZ(level - tip_z),
            Way::Arc {
                centre: [x, z],
                clockwise,
            } => Way::Arc {
                centre: [x - tip_x, z - tip_z],
                clockwise,
            },
            Way::Line | Way::Box => *way,
        };
        let of_tip = |at: Position| [at.x - tip_x, at.z - tip_z];
        let met = met(&self.zones, of_tip(from), of_tip(to), &way, beside);
        met.map_or(Ok(()), |met| Err(entered(&met, span)))
    }

    /// Checks a step of `axis` from `from`, by hand, while the other axis stands at `at`: it ends where any motion by hand
    /// would. The zones do not count for a tip that was not measured.
    ///
    /// # Errors
    /// [`Code::ZoneEntered`].
    pub(crate) fn step(
        &self,
        axis: Axis,
        from: Length,
        way: Length,
        at: Position,
    ) -> Result<(), Alarm> {
        let Some([tip_x, tip_z]) = self.tip else {
            return Ok(());
        };
        let (x, z) = (at.x - tip_x, at.z - tip_z);
        let (own, other) = match axis {
            Axis::X => (from - tip_x, z),
            Axis::Z | Axis::C => (from - tip_z, x),
        };
        let others = Extent::between(other, other);
        let free = self.zones.travel(axis, own, others, Extent::UNLIMITED);
        let end = own + way;
        let by = (end - free.high).max(free.low - end);
        let [begins, ends] = [own, end].map(|own| match axis {
            Axis::X => [own, other],
            Axis::Z | Axis::C => [other, own],
        });
        match met(&self.zones, begins, ends, &Way::Line, CLEARANCE) {
            Some(met) if by > Length::ZERO => {
                Err(entered(&Met { axis, by, ..met }, Span::default()))
            }
            _ => Ok(()),
        }
    }

    /// Checks all ways along the axes, one after the other, from where a program was left to the point: one after the other
    /// is enough, and in which order is not known here.
    ///
    /// # Errors
    /// [`Code::ZoneEntered`].
    pub(crate) fn hull(&self, from: Position, to: Position) -> Result<(), Alarm> {
        if self.tip.is_none() || self.zones.are_off() {
            return Ok(());
        }
        self.way(from, to, &Way::Box, Length::ZERO, Span::default())
    }

    /// The coordinates of X or Z that a zone has, of the machine with this tip, for each zone.
    pub(crate) fn extents(&self, axis: Axis) -> impl Iterator<Item = Extent> {
        let tip = self.tip.unwrap_or_default();
        self.zones.extents(axis).map(move |extent| {
            extent.moved(match axis {
                Axis::X => tip[0],
                Axis::Z | Axis::C => tip[1],
            })
        })
    }

    /// The tip stands in a zone.
    #[must_use]
    pub fn is_in_zone(&self, at: Position) -> bool {
        self.tip
            .is_some_and(|[x, z]| self.zones.have([at.x - x, at.z - z]))
    }
}

#[cold]
fn entered(met: &Met, span: Span) -> Alarm {
    let by = match met.axis {
        Axis::X => Arg::Diameter(Diameter::of_radius(met.by)),
        Axis::Z | Axis::C => Arg::Length(met.by),
    };
    let figures = [Arg::Zone(met.zone), Arg::Letter(met.axis.letter()), by];
    Alarm::new(Code::ZoneEntered, span).with(figures)
}

/// Checks that no move of `moves` leads the tip into a zone. The first move begins at `from`.
///
/// # Errors
/// As [`Forbidden::way`].
pub(crate) fn each_clear_of_zones(
    moves: impl Iterator<Item = Move>,
    from: Position,
    forbidden: &Forbidden,
) -> Result<(), Alarm> {
    let mut at = from;
    for next in moves {
        let way = way(&next, at, from);
        let moves = matches!(way, Way::Arc { .. }) || (next.to.x, next.to.z) != (at.x, at.z);
        if moves && !is_of(&next, &[Cycle::G30P99]) {
            let joined = matches!(next.kind, MoveKind::Feed(_) | MoveKind::Arc { .. });
            let beside = if joined && next.tag.is_none() {
                forbidden.beside
            } else {
                Length::ZERO
            };
            forbidden.way(at, next.to, &way, beside, next.span)?;
        }
        at = next.to;
    }
    Ok(())
}

/// The way of a move from `at`, in a cycle that began at `home`.
fn way(next: &Move, at: Position, home: Position) -> Way {
    match next.kind {
        MoveKind::Arc {
            i, k, clockwise, ..
        } => Way::Arc {
            centre: [at.x + i, at.z + k],
            clockwise,
        },
        MoveKind::Thread(thread) => {
            let is = |stages: &[Stage]| next.tag.is_some_and(|tag| stages.contains(&tag.stage));
            if thread.part.is_joined() || is(&[Stage::RunIn, Stage::RunOut]) {
                Way::Box
            } else if is_of(next, &[Cycle::G32, Cycle::G34]) {
                Way::Line
            } else if thread.long_x {
                Way::DownToZ(home.z)
            } else {
                Way::DownToX(home.x)
            }
        }
        _ => Way::Line,
    }
}

fn is_of(next: &Move, cycles: &[Cycle]) -> bool {
    next.tag.is_some_and(|tag| cycles.contains(&tag.cycle))
}
