//! The holes that a drilling cycle makes, peck by peck, with what a picture says of them. Holes of one block of the cycle,
//! and of those that only place further ones, are one feature where they begin at one R.

use leadscrew_core::alarm::Lang;
use leadscrew_core::call::{Position, TapAxis};
use leadscrew_core::units::Length;
use leadscrew_language::drilling::Kind;
use leadscrew_language::stock::Stock;

use super::PIECES;
use super::depth::Depth;
use crate::drawing::mm;
use crate::number::measured;
use crate::plot::{Drilled, Hole, Peck};
use crate::words::both;

/// Places that are written out.
const PLACES: usize = 8;

/// Holes with one R.
#[derive(Debug)]
pub(super) struct Holes {
    kind: Kind,
    /// R and the deepest place so far, coordinates of the machine.
    level: Length,
    bottom: Length,
    zero: Length,
    stock: Option<Stock>,
    /// Where the hole under way is; `None` between two of them.
    place: Option<(Length, i64)>,
    /// How deep it is already.
    cut: f64,
    holes: Vec<Hole>,
    pecks: Vec<Peck>,
}

/// The axis of a cycle.
const fn axis(kind: Kind) -> TapAxis {
    if kind.is_side() {
        TapAxis::X
    } else {
        TapAxis::Z
    }
}

/// Where a hole of this kind is: the other axis, and C.
const fn place(kind: Kind, at: &Position) -> (Length, i64) {
    let across = if kind.is_side() { at.z } else { at.x };
    (across, at.c.udeg())
}

impl Holes {
    /// Those of a cycle whose first feed begins at `from` and ends at `to`. `origin`: the work's zero.
    pub(super) fn new(
        kind: Kind,
        (from, to): (&Position, &Position),
        origin: &Position,
        stock: Option<Stock>,
    ) -> Self {
        let axis = axis(kind);
        Self {
            kind,
            level: axis.of(*from),
            bottom: axis.of(*to),
            zero: axis.of(*origin),
            stock,
            place: None,
            cut: 0.0,
            holes: Vec::new(),
            pecks: Vec::new(),
        }
    }

    /// The code of the cycle.
    pub(super) const fn code(&self) -> &'static str {
        self.kind.code()
    }

    fn below(&self, at: &Position) -> f64 {
        self.below_level(axis(self.kind).of(*at))
    }

    fn below_level(&self, at: Length) -> f64 {
        let inward = (self.bottom - self.level).nm().signum();
        mm((at - self.level).nm() * inward)
    }

    /// A feed from here to there is one of these holes.
    pub(super) fn is_of(&self, kind: Kind, from: &Position) -> bool {
        let is_open = self.place == Some(place(kind, from));
        kind == self.kind && (is_open || axis(kind).of(*from) == self.level)
    }

    /// Adds a feed; false where it did not fit.
    pub(super) fn feed(
        &mut self,
        (from, to): (&Position, &Position),
        origin: &Position,
        line: u32,
    ) -> bool {
        let depth = (self.below(from), self.below(to));
        // G85 and G89 come out at feed.
        if depth.1 <= depth.0 {
            return true;
        }
        if self.holes.len().max(self.pecks.len()) >= PIECES {
            return false;
        }
        let place = place(self.kind, from);
        if self.place.replace(place) != Some(place) {
            self.cut = 0.0;
            let (x, z) = (mm((to.x - origin.x).nm()), mm((to.z - origin.z).nm()));
            self.holes.push(Hole {
                angle: mm((to.c - origin.c).udeg()),
                radius: x,
                z,
                pecks: 0,
            });
        }
        let Some(hole) = self.holes.last_mut() else {
            return false;
        };
        hole.pecks += 1;
        let peck = hole.pecks;
        if depth.1 > self.below_level(self.bottom) {
            self.bottom = axis(self.kind).of(*to);
        }
        self.pecks.push(Peck {
            hole: u32::try_from(self.holes.len()).unwrap_or(u32::MAX),
            number: peck,
            line,
            depth,
            fresh: depth.0.max(self.cut).min(depth.1),
        });
        self.cut = self.cut.max(depth.1);
        true
    }

    /// A rapid to beyond R leaves the hole.
    pub(super) fn rapid(&mut self, to: &Position) {
        if self.below(to) < 0.0 {
            self.place = None;
        }
    }

    /// The figures of the holes, and their geometry.
    pub(super) fn feature(self, lang: Lang) -> (Vec<String>, Drilled) {
        let axis = axis(self.kind);
        let ends = (self.level, self.bottom);
        let depth = Depth::new(axis, ends, self.zero, self.stock.as_ref());
        let figures = vec![
            self.figures(&depth, lang),
            self.places(lang),
            depth.surface(lang),
        ];
        let drilled = Drilled {
            axis: depth.axis,
            level: depth.ends.0,
            bottom: depth.bottom,
            material: depth.material,
            holes: self.holes,
            pecks: self.pecks,
        };
        (figures, drilled)
    }

    fn figures(&self, depth: &Depth, lang: Lang) -> String {
        let axis = depth.axis;
        let [level, bottom, deep] = [depth.ends.0, depth.ends.1, depth.bottom].map(measured);
        let (holes, pecks) = (
            self.holes.len(),
            self.holes.iter().map(|hole| hole.pecks).max(),
        );
        let longest = self.pecks.iter().map(Peck::cuts).fold(0.0, f64::max);
        let told = both!(
            "along {axis} · R {axis}{level}, bottom {axis}{bottom}: {deep} mm · holes: {holes} · pecks of a hole: {pecks}, the \
             longest {longest} mm",
            "沿 {axis} · R {axis}{level}，孔底 {axis}{bottom}：{deep} mm · 孔数 {holes} · 每孔进给 {pecks} 次，最长 {longest} mm",
            pecks = pecks.unwrap_or(0),
            longest = measured(longest)
        );
        told.get(lang).to_owned()
    }

    /// Where the holes are.
    fn places(&self, lang: Lang) -> String {
        if !self.kind.is_side() && self.holes.iter().all(|hole| hole.radius == 0.0) {
            return both!("on the axis", "在轴线上").get(lang).to_owned();
        }
        let one = |hole: &Hole| {
            let angle = measured(hole.angle);
            if self.kind.is_side() {
                format!("Z{} C{angle}", measured(hole.z))
            } else {
                format!("X{} C{angle}", measured(2.0 * hole.radius))
            }
        };
        let mut places: Vec<String> = self.holes.iter().take(PLACES).map(one).collect();
        if self.holes.len() > PLACES {
            places.push("…".to_owned());
        }
        let places = places.join(" · ");
        both!("at {places}", "位置 {places}").get(lang).to_owned()
    }
}
