//! The GO gauge: the smallest perfect counterpart that screws on.

use crate::groove::{Course, Grooves};
use crate::units::{Mm, Side};
use crate::work::Work;

/// The pitch diameter that a gauge needs to go on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Functional {
    /// Pitch diameter of the perfect thread with the nominal lead and angle that just fits; the worst place counts.
    pub diameter: Mm,
    /// Length of the gauge, or of the thread where that is shorter.
    pub length: Mm,
}

/// The counterpart: angle of a flank, the height of its crest, its length.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Counterpart {
    pub(crate) side: Side,
    /// Half the angle between the flanks, degrees.
    pub(crate) flank: f64,
    /// Nothing of the part that is lower touches it.
    pub(crate) crest: f64,
    pub(crate) length: f64,
}

/// Parts of a pitch in which the need of the thread is kept.
const PARTS: f64 = 4.0;
const NM: f64 = 1e6;

impl Functional {
    /// Screws the counterpart along the thread. It may shift along the axis, and goes on everywhere or not at all.
    pub(crate) fn of(
        work: &Work,
        grooves: &Grooves,
        course: &Course,
        counterpart: &Counterpart,
    ) -> Option<Self> {
        let cot = 1.0 / counterpart.flank.to_radians().tan();
        let way = work.course();
        let (from, step) = (work.stock().from.0, work.grid().step.0);
        let place = |groove: &crate::groove::Groove| {
            groove.number as f64 + groove.angle as f64 / grooves.angles as f64 * course.starts
        };
        let first = grooves.list.iter().map(place).fold(f64::INFINITY, f64::min);
        let last = grooves
            .list
            .iter()
            .map(place)
            .fold(f64::NEG_INFINITY, f64::max);
        let parts = ((last - first) * PARTS) as usize + 1;
        let mut needs = vec![[f64::NEG_INFINITY; 2]; parts];
        for groove in &grooves.list {
            let at = place(groove);
            let middle = grooves.reference + way * course.pitch * at;
            let need = &mut needs[((at - first) * PARTS) as usize];
            let nodes = work.line(groove.angle);
            let node = |z: f64| ((z - from) / step).clamp(0.0, nodes.len() as f64) as usize;
            let reach = course.pitch / 2.0;
            let (begin, end) = (node(middle - reach), node(middle + reach));
            for (n, nm) in (begin..).zip(&nodes[begin..end]) {
                let z = work.z(n);
                let height = f64::from(*nm) / NM - course.taper * (z - work.stock().face.0);
                if height > counterpart.crest {
                    let off = z - middle;
                    let side = usize::from(off > 0.0);
                    let asked = height + (course.pitch / 4.0 - off.abs()) * cot;
                    need[side] = need[side].max(asked);
                }
            }
        }
        let whole = (last - first) * course.pitch;
        let length = counterpart.length.min(whole);
        let window = ((length / course.pitch * PARTS).ceil() as usize).clamp(1, parts);
        let worst = needs.windows(window).map(|needs| {
            let most = |side: usize| {
                needs
                    .iter()
                    .map(|n| n[side])
                    .fold(f64::NEG_INFINITY, f64::max)
            };
            (most(0) + most(1)) / 2.0
        });
        let height = worst.fold(f64::NEG_INFINITY, f64::max);
        height.is_finite().then(|| Self {
            diameter: Mm(2.0 * counterpart.side.height(height)),
            length: Mm(length),
        })
    }
}
