//! What is left of the declared stock while a program is checked, and whether a rapid goes through it [D251].
//!
//! The stock is cut into short cells along Z, each a ring between a bore and an outside. What remains here is never more
//! than what remains in truth: where a cut may have been made from outside or from inside, nothing is left of the cell.
//! So a rapid that is told really goes through material. It knows points in millimetres, and neither text nor calls.

use leadscrew_language::stock::Stock;

/// A point: Z and the radius, in millimetres.
pub type Point = (f64, f64);

/// Cells of the whole length.
const CELLS: usize = 2048;
/// A move this deep below a skin still lies on it.
const SKIN: f64 = 0.010_001;
/// No cut is deeper, and no blade wider.
const DEEPEST: f64 = 10.0;
/// The depth of cut of a usual insert.
pub const EDGE: f64 = 8.0;
/// What is known to be left of a wall whose hole a drill of unknown diameter has made.
const WALL: f64 = 0.05;
/// Below this two lengths are one.
const SAME: f64 = 1e-7;

/// What is left.
#[derive(Debug)]
pub struct Remains {
    /// The end toward the chuck.
    back: f64,
    /// The length of a cell.
    cell: f64,
    /// From the chuck to the face.
    cells: Vec<Ring>,
}

/// What is left of a cell: nothing where the outside is not above the bore.
#[derive(Clone, Copy, Debug)]
struct Ring {
    outside: f64,
    bore: f64,
    /// A drill has been here.
    drilled: bool,
}

impl Ring {
    const GONE: Self = Self {
        outside: 0.0,
        bore: 0.0,
        drilled: false,
    };

    /// The radii between which there is material for certain.
    fn solid(&self) -> (f64, f64) {
        let bore = match (self.drilled, self.bore > 0.0) {
            (true, _) => self.bore.max(self.outside - WALL),
            (false, true) => self.bore,
            // Solid to beyond the centre line.
            (false, false) => -1.0,
        };
        (bore, self.outside)
    }

    fn is_gone(&self) -> bool {
        self.outside <= self.bore + SAME
    }

    fn has(&self, radius: f64) -> bool {
        let (bore, outside) = self.solid();
        !self.is_gone() && bore < radius && radius < outside
    }

    /// Takes away what a cut between two radii takes at least, and all that it may take.
    fn cut(&mut self, low: f64, high: f64) {
        let is_bored = self.drilled || self.bore > 0.0;
        if self.is_gone() || low >= self.outside - SAME || (is_bored && high <= self.bore + SAME) {
            return;
        }
        let from_outside = high >= self.outside - SAME;
        let from_inside = is_bored && low <= self.bore + SAME;
        let may_outside = self.outside - low <= DEEPEST;
        let may_inside = is_bored && (self.drilled || high - self.bore <= DEEPEST);
        match (from_outside, from_inside) {
            (true, false) => self.outside = low,
            (false, true) => self.open(high),
            (true, true) => *self = Self::GONE,
            (false, false) if !is_bored || (may_outside && !may_inside) => self.outside = low,
            (false, false) if may_inside && !may_outside => self.open(high),
            (false, false) => *self = Self::GONE,
        }
        if self.is_gone() {
            *self = Self::GONE;
        }
    }

    /// How deep a cut between two radii is at least: from outside, or from inside where there is a bore.
    fn depth(&self, low: f64, high: f64) -> f64 {
        if self.is_gone() || self.drilled {
            return 0.0;
        }
        let outside = self.outside - high.max(self.bore);
        if self.bore > 0.0 {
            outside.min(low.min(self.outside) - self.bore).max(0.0)
        } else {
            outside.max(0.0)
        }
    }

    fn open(&mut self, radius: f64) {
        (self.bore, self.drilled) = (self.bore.max(radius), false);
    }
}

impl Remains {
    /// Nothing has been cut yet.
    #[must_use]
    pub fn new(stock: &Stock) -> Self {
        let mm = |nm: i64| nm as f64 / 1e6;
        let ring = Ring {
            outside: mm(stock.outside),
            bore: mm(stock.bore),
            drilled: false,
        };
        Self {
            back: mm(stock.face - stock.length),
            cell: mm(stock.length) / CELLS as f64,
            cells: vec![ring; CELLS],
        }
    }

    /// The first point at which a rapid is in the material.
    #[must_use]
    pub fn entered(&self, from: Point, to: Point) -> Option<Point> {
        folded(from, to)
            .into_iter()
            .flatten()
            .find_map(|(from, to)| {
                let cells = self.touched(from.0, to.0);
                let hit = |n: usize| self.hit(n, from, to);
                if to.0 < from.0 {
                    cells.rev().find_map(hit)
                } else {
                    cells.clone().find_map(hit)
                }
            })
    }

    /// Where a way is in the material of a cell.
    fn hit(&self, n: usize, from: Point, to: Point) -> Option<Point> {
        let ring = self.cells.get(n).filter(|ring| !ring.is_gone())?;
        let (low, high) = (self.edge(n), self.edge(n + 1));
        let within = |low: f64, high: f64| {
            let (start, end) = clipped(from, to, low, high)?;
            let (bore, outside) = ring.solid();
            let least = start.1.min(end.1).max(bore + SKIN);
            let most = start.1.max(end.1).min(outside - SKIN);
            (least <= most).then_some((start, least, most))
        };
        let (_, least, most) = within(low, high)?;
        // At a side where the material ends there is a skin.
        let middle = (least + most) / 2.0;
        let skin = |beside: Option<usize>| {
            let goes_on = beside.and_then(|n| self.cells.get(n));
            match goes_on {
                Some(ring) if ring.has(middle) => 0.0,
                _ => SKIN,
            }
        };
        let low = low + skin(n.checked_sub(1));
        let high = high - skin(n.checked_add(1));
        let (start, least, most) = within(low, high)?;
        Some((start.0, start.1.clamp(least, most)))
    }

    /// How deep a cut along the axis is for certain, in millimetres, over more than [`EDGE`] of its way: there it is the
    /// depth of an insert, and not a shoulder that the tool comes up against. 0 for a cut across the axis, which may be
    /// that of a blade.
    #[must_use]
    pub fn depth(&self, from: Point, to: Point) -> f64 {
        let mut depths: Vec<(f64, f64)> = Vec::new();
        for (from, to) in folded(from, to).into_iter().flatten() {
            if (to.1 - from.1).abs() >= (to.0 - from.0).abs() {
                continue;
            }
            for n in self.touched(from.0, to.0) {
                if let Some((start, end)) = clipped(from, to, self.edge(n), self.edge(n + 1)) {
                    let depth = self.cells[n].depth(start.1.min(end.1), start.1.max(end.1));
                    depths.push((depth, (end.0 - start.0).abs()));
                }
            }
        }
        // The deepest stretches first, until they are as long as an edge.
        depths.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut length = 0.0;
        let deep = depths.into_iter().find(|(_, long)| {
            length += long;
            length > EDGE
        });
        deep.map_or(0.0, |(depth, _)| depth)
    }

    /// A cut along a straight way.
    pub fn cut(&mut self, from: Point, to: Point) {
        if from.1.abs() < SAME && to.1.abs() < SAME {
            return self.drill(from.0, to.0);
        }
        for (from, to) in folded(from, to).into_iter().flatten() {
            let ways = (from.0.min(to.0), from.0.max(to.0));
            self.take(
                ways,
                |low, high| {
                    let (start, end) = clipped(from, to, low, high)?;
                    Some((start.1.min(end.1), start.1.max(end.1)))
                },
                (to.1 - from.1, to.0 - from.0),
                to.1,
            );
        }
    }

    /// Columns side by side, all cut from one radius to another.
    pub fn groove(&mut self, first: f64, last: f64, from: f64, to: f64) {
        let (low, high) = (from.min(to), from.max(to));
        let ways = (first.min(last), first.max(last));
        self.take(ways, |_, _| Some((low, high)), (to - from, 0.0), to);
    }

    /// A hole on the centre line, of unknown diameter.
    pub fn drill(&mut self, from: f64, to: f64) {
        for n in self.touched(from, to) {
            self.cells[n].drilled = true;
        }
    }

    /// Rings into the face: what is left up to there is not known.
    pub fn trepan(&mut self, to: f64) {
        for n in self.touched(to, f64::MAX) {
            self.cells[n] = Ring::GONE;
        }
    }

    /// Takes radii out of all cells between two Z. A way that leads across the axis also takes what lies in front of it, as
    /// deep as a cut or a blade may be; and where nothing is left, what lies in front has fallen off.
    fn take(
        &mut self,
        (low, high): (f64, f64),
        radii: impl Fn(f64, f64) -> Option<(f64, f64)>,
        (across, along): (f64, f64),
        end: f64,
    ) {
        let (mut opened, mut lowered, mut gone) = (false, false, None);
        for n in self.touched(low, high) {
            let Some((least, most)) = radii(self.edge(n), self.edge(n + 1)) else {
                continue;
            };
            let before = self.cells[n];
            self.cells[n].cut(least, most);
            let after = &self.cells[n];
            opened |= after.bore > before.bore;
            lowered |= after.outside < before.outside;
            if after.is_gone() && !before.is_gone() {
                gone = Some(n);
            }
        }
        if across.abs() <= along.abs() {
            return;
        }
        for n in self.touched(high, high + DEEPEST) {
            let ring = &mut self.cells[n];
            if lowered && across < 0.0 {
                ring.outside = ring.outside.min(end.abs());
            }
            if opened && across > 0.0 {
                ring.bore = ring.bore.max(end.abs());
            }
        }
        if let Some(n) = gone {
            self.cells[n..].fill(Ring::GONE);
        }
    }

    fn edge(&self, n: usize) -> f64 {
        self.back + self.cell * n as f64
    }

    /// The cells that have a part of this stretch, also those that it only touches.
    fn touched(&self, from: f64, to: f64) -> std::ops::Range<usize> {
        let (low, high) = (from.min(to), from.max(to));
        // A cast to an unsigned number stops at its ends.
        let first = ((low - self.back - SAME) / self.cell).floor() as usize;
        let last = ((high - self.back + SAME) / self.cell).floor();
        let behind = if last < 0.0 {
            0
        } else {
            (last as usize).saturating_add(1)
        };
        first.min(CELLS)..behind.min(CELLS)
    }
}

/// A way in radii that are not negative: two of them where it crosses the centre line.
fn folded(from: Point, to: Point) -> [Option<(Point, Point)>; 2] {
    let fold = |(z, x): Point| (z, x.abs());
    if from.1 * to.1 >= 0.0 {
        return [Some((fold(from), fold(to))), None];
    }
    let share = from.1 / (from.1 - to.1);
    let middle = (from.0 + share * (to.0 - from.0), 0.0);
    [Some((fold(from), middle)), Some((middle, fold(to)))]
}

/// The part of a way between two Z; `None` where it has none.
fn clipped(from: Point, to: Point, low: f64, high: f64) -> Option<(Point, Point)> {
    let length = to.0 - from.0;
    if length.abs() < SAME {
        let is_in = low - SAME <= from.0 && from.0 <= high + SAME;
        return is_in.then_some((from, to));
    }
    let at = |z: f64| ((z - from.0) / length).clamp(0.0, 1.0);
    let (first, last) = if length > 0.0 {
        (at(low), at(high))
    } else {
        (at(high), at(low))
    };
    let point = |share: f64| (from.0 + share * length, from.1 + share * (to.1 - from.1));
    ((last - first) * length.abs() > SAME).then(|| (point(first), point(last)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bar(bore: i64, face: i64) -> Remains {
        Remains::new(&Stock {
            outside: 30_000_000,
            bore: bore * 1_000_000,
            length: 100_000_000,
            face: face * 1_000_000,
        })
    }

    fn hits(remains: &Remains, from: Point, to: Point) -> bool {
        remains.entered(from, to).is_some()
    }

    #[test]
    fn the_skin_is_no_material_and_what_is_below_it_is() {
        let bar = bar(0, 0);
        assert!(!hits(&bar, (5.0, 40.0), (0.0, 30.0)));
        assert!(!hits(&bar, (2.0, 30.0), (-50.0, 30.0)));
        assert!(!hits(&bar, (2.0, 29.99), (-50.0, 29.99)));
        assert!(hits(&bar, (2.0, 29.98), (-50.0, 29.98)));
        // Along the face, and just behind it.
        assert!(!hits(&bar, (0.0, 40.0), (0.0, -1.0)));
        assert!(!hits(&bar, (-0.01, 40.0), (-0.01, 0.0)));
        assert!(hits(&bar, (-0.02, 40.0), (-0.02, 0.0)));
        // Along the centre line, and across it; behind its end there is nothing.
        assert!(hits(&bar, (5.0, 0.0), (-5.0, 0.0)));
        assert!(hits(&bar, (-50.0, 40.0), (-50.0, -40.0)));
        assert!(!hits(&bar, (-100.02, 40.0), (-100.02, 0.0)));
        let (z, x) = bar.entered((10.0, 20.0), (-10.0, 20.0)).unwrap();
        assert!(
            (z + SKIN).abs() < 1e-6 && (x - 20.0).abs() < 1e-6,
            "{z} {x}"
        );
    }

    #[test]
    fn what_is_turned_is_free_up_to_the_shoulder() {
        let mut bar = bar(0, 0);
        bar.cut((2.0, 25.0), (-40.0, 25.0));
        assert!(!hits(&bar, (-40.0, 25.0), (2.0, 25.0)));
        assert!(!hits(&bar, (2.0, 26.0), (-40.0, 26.0)));
        assert!(hits(&bar, (2.0, 26.0), (-40.2, 26.0)));
        assert!(hits(&bar, (2.0, 24.9), (-40.0, 24.9)));
        // A taper.
        bar.cut((-40.0, 25.0), (-50.0, 30.0));
        assert!(!hits(&bar, (-40.0, 25.0), (-50.0, 30.0)));
        assert!(hits(&bar, (-41.0, 25.0), (-50.0, 29.5)));
    }

    #[test]
    fn a_face_takes_what_is_in_front_of_it_and_a_cut_to_the_bore_lets_it_fall() {
        let mut bar = bar(0, 1);
        assert!(hits(&bar, (0.5, 40.0), (0.5, 0.0)));
        bar.cut((0.0, 31.0), (0.0, -0.8));
        assert!(!hits(&bar, (0.0, 40.0), (0.0, 0.0)) && !hits(&bar, (0.5, 40.0), (0.5, 0.0)));
        // Toward the hub only.
        bar.cut((-5.0, 31.0), (-5.0, 20.0));
        assert!(!hits(&bar, (-2.0, 40.0), (-2.0, 20.0)));
        assert!(hits(&bar, (-2.0, 40.0), (-2.0, 19.0)));
        let mut tube = self::bar(20, 0);
        tube.groove(-40.0, -40.0, 31.0, 20.0);
        assert!(!hits(&tube, (-20.0, 40.0), (-20.0, 0.0)));
        assert!(hits(&tube, (-41.0, 40.0), (-41.0, 0.0)));
    }

    #[test]
    fn a_bore_grows_and_a_cut_that_may_be_on_either_side_leaves_nothing_known() {
        let mut tube = bar(10, 0);
        assert!(!hits(&tube, (2.0, 9.5), (-60.0, 9.5)) && hits(&tube, (2.0, 11.0), (-60.0, 11.0)));
        tube.cut((2.0, 12.0), (-30.0, 12.0));
        assert!(
            !hits(&tube, (2.0, 12.0), (-30.0, 12.0)) && hits(&tube, (2.0, 12.0), (-31.0, 12.0))
        );
        assert!(hits(&tube, (-20.0, 40.0), (-20.0, 29.0)));
        tube.cut((2.0, 21.0), (-30.0, 21.0));
        assert!(!hits(&tube, (-20.0, 40.0), (-20.0, 0.0)));
    }

    #[test]
    fn a_drilled_hole_has_an_unknown_diameter() {
        let mut bar = bar(0, 0);
        bar.cut((3.0, 0.0), (-40.0, 0.0));
        assert!(!hits(&bar, (3.0, 0.0), (-40.0, 0.0)) && hits(&bar, (3.0, 0.0), (-41.0, 0.0)));
        assert!(!hits(&bar, (3.0, 8.0), (-30.0, 8.0)));
        assert!(hits(&bar, (-20.0, 40.0), (-20.0, 29.9)));
    }
}
