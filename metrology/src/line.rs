//! A straight line through points of a flank.

/// `z = at + lean · u`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Line {
    pub(crate) at: f64,
    pub(crate) lean: f64,
}

impl Line {
    /// The line with the least sum of squared distances from the points `(u, z)`; `None` for fewer than three.
    pub(crate) fn through(points: impl Iterator<Item = (f64, f64)> + Clone) -> Option<Self> {
        let n = points.clone().count();
        if n < 3 {
            return None;
        }
        let share = 1.0 / n as f64;
        let (mut u0, mut z0) = (0.0, 0.0);
        for (u, z) in points.clone() {
            u0 += u * share;
            z0 += z * share;
        }
        let (mut uu, mut zz, mut uz) = (0.0, 0.0, 0.0);
        for (u, z) in points {
            uu += (u - u0) * (u - u0);
            zz += (z - z0) * (z - z0);
            uz += (u - u0) * (z - z0);
        }
        // The direction of the larger spread.
        let angle = 0.5 * (2.0 * uz).atan2(uu - zz);
        let lean = angle.tan();
        lean.is_finite().then_some(Self {
            at: z0 - lean * u0,
            lean,
        })
    }

    pub(crate) fn z(&self, u: f64) -> f64 {
        self.at + self.lean * u
    }
}
