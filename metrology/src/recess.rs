//! A groove with upright walls, measured as an inspector does: its floor across the part, its walls and its width at half
//! of its depth.

use crate::measure::Spread;
use crate::units::Mm;
use crate::work::Work;

/// What was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Recess {
    /// The floor: half of the sum of opposite places, millimetres; a radius, or the height of an inner groove.
    pub floor: Spread,
    /// The walls towards −Z and +Z.
    pub walls: [Spread; 2],
    /// Between the walls.
    pub width: Spread,
}

/// Less than this is no groove.
const LEAST: Mm = Mm(0.001);
/// The share of the width at either wall that is not floor.
const EDGE: f64 = 0.1;

/// The groove that was cut into the stock; `None` where nothing was cut.
#[must_use]
pub fn recess(work: &Work) -> Option<Recess> {
    let angles = work.grid().angles;
    let uncut = Work::new(*work.stock(), work.grid());
    let top = uncut.line(0);
    let cuts: Vec<Option<Cut>> = (0..angles).map(|n| Cut::of(work, n, top)).collect();
    let walls = |pick: fn(&Cut) -> f64| Spread::of(cuts.iter().flatten().map(pick));
    let (minus, plus) = (walls(|cut| cut.minus)?, walls(|cut| cut.plus)?);
    let room = EDGE * (plus.mean - minus.mean);
    let (from, to) = (minus.mean + room, plus.mean - room);
    let half = angles / 2;
    let across = (0..half).flat_map(|n| {
        let (here, there) = (work.line(n), work.line(n + half));
        let nodes = (0..here.len()).filter(|k| (from..=to).contains(&work.z(*k)));
        nodes.map(|k| (f64::from(here[k]) + f64::from(there[k])) / 2e6)
    });
    let side = work.stock().side;
    let floor = Spread::of(across.map(|height| side.height(height)))?;
    Some(Recess {
        floor,
        walls: [minus, plus],
        width: walls(|cut| cut.plus - cut.minus)?,
    })
}

/// The groove at one angle.
struct Cut {
    minus: f64,
    plus: f64,
}

impl Cut {
    fn of(work: &Work, angle: usize, top: &[i32]) -> Option<Self> {
        let line = work.line(angle);
        let depth = |k: usize| f64::from(top[k]) - f64::from(line[k]);
        let deepest = (0..line.len()).map(depth).fold(0.0, f64::max);
        if deepest < LEAST.0 * 1e6 {
            return None;
        }
        let level = deepest / 2.0;
        let is_in = |k: &usize| depth(*k) >= level;
        let (first, last) = ((0..line.len()).find(is_in)?, (0..line.len()).rfind(is_in)?);
        // Between the nodes on either side of a wall.
        let wall = |inner: usize, outer: usize| {
            let (low, high) = (depth(outer), depth(inner));
            let part = (level - low) / (high - low);
            work.z(outer) + part * (work.z(inner) - work.z(outer))
        };
        Some(Self {
            minus: wall(first, first.checked_sub(1)?),
            plus: wall(last, (last + 1 < line.len()).then_some(last + 1)?),
        })
    }
}
