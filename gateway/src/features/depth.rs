//! How deep a hole goes, from R on, and where the material of the declared stock is.

use leadscrew_core::alarm::Lang;
use leadscrew_core::call::TapAxis;
use leadscrew_core::units::Length;
use leadscrew_language::stock::Stock;

use crate::drawing::mm;
use crate::number::measured;
use crate::words::{both, pick};

/// Depths below R in millimetres.
#[derive(Debug)]
pub(super) struct Depth {
    /// Name of the axis along which the hole goes.
    pub(super) axis: &'static str,
    /// Where R and the bottom are in the work, millimetres; X is a diameter.
    pub(super) ends: (f64, f64),
    /// From R to the bottom.
    pub(super) bottom: f64,
    /// From R to where the material begins and to where it ends, where that is known.
    pub(super) material: (Option<f64>, Option<f64>),
    /// The surface is not declared but assumed.
    is_assumed: bool,
}

impl Depth {
    /// From R to the bottom, coordinates of the machine. `zero`: the work's zero on the axis.
    pub(super) fn new(
        axis: TapAxis,
        (level, bottom): (Length, Length),
        zero: Length,
        stock: Option<&Stock>,
    ) -> Self {
        let [level, bottom] = [level, bottom].map(|at| mm(at.nm() - zero.nm()));
        let inward = if bottom > level { 1.0 } else { -1.0 };
        let below = |at: f64| (at - level) * inward;
        let deep = below(bottom);
        let known = match (axis, stock) {
            (TapAxis::Z, Some(stock)) => {
                let face = mm(stock.face);
                Some((face, face - mm(stock.length)))
            }
            (TapAxis::X, Some(stock)) => Some((mm(stock.outside), mm(stock.bore))),
            (_, None) => None,
        };
        // From the other side the hole begins where it would end.
        let known = known.map(|(near, far)| (below(near), below(far)));
        let known = known.map(|(near, far)| (near.min(far), near.max(far)));
        let assumed = (known.is_none() && axis == TapAxis::Z).then(|| below(0.0));
        let assumed = assumed.filter(|face| (0.0..deep).contains(face));
        let (axis, written) = match axis {
            TapAxis::X => ("X", 2.0),
            TapAxis::Z => ("Z", 1.0),
        };
        Self {
            axis,
            ends: (written * level, written * bottom),
            bottom: deep,
            material: (
                known.map(|known| known.0).or(assumed),
                known.map(|known| known.1),
            ),
            is_assumed: assumed.is_some(),
        }
    }

    /// What is known of the surface, and of the far side.
    pub(super) fn surface(&self, lang: Lang) -> String {
        let Some(surface) = self.material.0 else {
            return pick(
                lang,
                "surface not known: declare the stock, `(STOCK X60 L100)`",
                "工件表面未知：请声明毛坯 `(STOCK X60 L100)`",
            )
            .to_owned();
        };
        let above = measured(surface);
        let mut told = both!(
            "from R to the surface {above} mm",
            "R 至工件表面 {above} mm"
        );
        if self.is_assumed {
            told = both!(
                "{en}, which is assumed at Z0",
                "{zh}（假定表面在 Z0）",
                en = told.en,
                zh = told.zh
            );
        }
        if let Some(end) = self.material.1.filter(|end| *end < self.bottom) {
            let beyond = measured(self.bottom - end);
            told = both!(
                "{en} · comes out {beyond} mm behind",
                "{zh} · 穿出 {beyond} mm",
                en = told.en,
                zh = told.zh
            );
        }
        told.get(lang).to_owned()
    }
}
