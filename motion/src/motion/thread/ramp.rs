//! Ramps of the short axis over the long axis' way: how the short axis leaves the pass's line and comes back to it.
//!
//! A ramp has the length K. Over its first part ℓ, the corner, the slope grows from zero to m, as fast as the axis'
//! limits allow at the planned speed. Over the rest the slope stays m. So the ramp reaches the whole displacement
//! `J = m·(K − ℓ/2)` exactly at its end: the axis lags in the corner and makes up for this inside K. The run-in is the
//! same ramp backwards.

use crate::motion::ease::{Bounds, Ease, Fine};
use crate::motion::wide::{mul_div_up, ratio, root_mul_div_up};
use crate::units::{mul_div, signed, signed_product};

/// Short-axis travel per long-axis travel in 2⁻⁴⁰.
pub(crate) type Slope = i64;

const SLOPE_BITS: u32 = 40;

/// A slope of one: 45°.
pub(crate) const DIAGONAL: u64 = 1 << SLOPE_BITS;

/// A ramp of the short axis away from (or back to) the pass's line. The default is no ramp.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Ramp {
    /// Signed slope after the corner; 0 for no ramp.
    pub slope: Slope,
    pub ease: Ease,
    /// Position along the long axis, from the start: a run-in ends here, a run-out begins here.
    pub at: Fine,
}

impl Ramp {
    /// Distance from the line at which a run-in begins.
    pub(super) fn beside_at_start(&self) -> Fine {
        along(
            self.ease.at(self.at.wrapping_sub(self.ease.half())),
            self.slope,
        )
    }
}

/// `way` · `slope`, rounded to the nearest 2⁻¹⁶ nm.
pub(crate) fn along(way: Fine, slope: Slope) -> Fine {
    let wide = signed_product(way, slope);
    (wide.wrapping_add(1 << (SLOPE_BITS - 1)) >> SLOPE_BITS) as i64
}

/// The slope that rises by `rise` over `way`.
pub(crate) fn slope(rise: Fine, way: u64) -> Slope {
    directed(mean(rise.unsigned_abs(), way), rise)
}

/// The magnitude of this slope.
fn mean(rise: u64, way: u64) -> u64 {
    ratio(rise, way, SLOPE_BITS)
}

/// A slope of this magnitude, with the sign of `rise`.
pub(crate) fn directed(magnitude: u64, rise: Fine) -> Slope {
    let magnitude = signed(magnitude);
    if rise < 0 {
        magnitude.wrapping_neg()
    } else {
        magnitude
    }
}

/// The inverse of a slope's magnitude, also in 2⁻⁴⁰.
pub(crate) fn inverse(slope: u64) -> Slope {
    signed(mul_div(DIAGONAL, DIAGONAL, slope.max(1)))
}

/// The speed (nm/s) of the short axis that follows from a speed of the long axis.
pub(crate) fn seen(speed: u64, slope: u64) -> u64 {
    // Rounded up, so that the rounding hides no exceeded limit.
    mul_div_up(speed, slope, DIAGONAL)
}

/// Limits of the long axis that keep an axis following it with `slope` within `bounds`.
#[inline(never)]
fn through(bounds: &Bounds, slope: u64) -> Bounds {
    Bounds {
        acceleration: mul_div(bounds.acceleration, DIAGONAL, slope),
        jerk: mul_div(bounds.jerk, DIAGONAL, slope),
    }
}

/// Speeds and limits of the axes in a pass.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Machine {
    /// The long axis' greatest speed in the pass, nm/s.
    pub speed: u64,
    /// Limits of the long axis.
    pub long: Bounds,
    /// Limits of the short axis.
    pub short: Bounds,
    /// Greatest speed of the short axis, nm/s.
    pub short_speed: u64,
    /// Magnitude of the taper's slope.
    pub taper: u64,
}

/// A corner of the short axis together with the long axis' ease next to it (join or brake).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Corner {
    /// Magnitude of the slope after the corner, 2⁻⁴⁰.
    pub slope: u64,
    /// Rounds the corner; its `half` is ℓ/2.
    pub ease: Ease,
    /// The long axis' join or brake.
    pub long: Ease,
    /// True if the ramp reaches its whole displacement.
    pub whole: bool,
}

impl Machine {
    /// Three fifths of the accelerations; the rest is for a stop over a corner.
    pub fn sharing(self) -> Self {
        let part = |bounds: Bounds| Bounds {
            acceleration: mul_div(bounds.acceleration, 3, 5),
            ..bounds
        };
        Self {
            long: part(self.long),
            short: part(self.short),
            ..self
        }
    }

    /// The steepest slope that the short axis' speed allows in addition to the taper.
    pub fn steepest(&self) -> u64 {
        mul_div(self.short_speed, DIAGONAL, self.speed.max(1)).saturating_sub(self.taper)
    }

    /// The long axis' ease while the short axis follows only the taper.
    pub fn plain(&self) -> Ease {
        self.straight(0)
    }

    /// The long axis' ease while the short axis follows a slope in addition to the taper, away from its corners.
    pub fn straight(&self, slope: u64) -> Ease {
        self.following(slope, &self.short)
    }

    /// The long axis' ease for a stop on this slope. Where the latencies of the drives differ by τ, the short axis is ahead
    /// by v·τ, which goes with the pace v: that takes τ·v″ beside v′. Half of its acceleration is for each.
    pub fn stop(&self, slope: u64, apart_us: u64) -> Ease {
        if apart_us == 0 {
            return self.straight(slope);
        }
        let half = self.short.acceleration / 2;
        let jerk = mul_div(half, 1_000_000, apart_us);
        let bounds = Bounds {
            acceleration: half,
            jerk: self.short.jerk.min(jerk),
        };
        self.following(slope, &bounds)
    }

    /// The long axis' ease while the short axis follows a slope in addition to the taper within `bounds`.
    #[inline(never)]
    fn following(&self, slope: u64, bounds: &Bounds) -> Ease {
        let bounds = self
            .long
            .least(&through(bounds, slope.saturating_add(self.taper)));
        Ease::new(self.speed, self.speed, &bounds)
    }

    /// Rounds a corner between two strokes: for each way on the helix the long axis gains `long`, the short one `short`.
    #[inline(never)]
    pub fn turn(&self, long: u64, short: u64) -> Ease {
        if long == 0 && short == 0 {
            return Ease::default();
        }
        let bounds = through(&self.long, long).least(&through(&self.short, short));
        Ease::new(self.speed, self.speed, &bounds)
    }

    /// The ramp that displaces the short axis by `rise` over `way`, next to a join or a brake.
    ///
    /// While only one of corner and ease is active, it has the short axis' limits to itself. If the ramp's corner
    /// reaches into the join or the brake, both share the limits: half of the acceleration each and a third of the jerk
    /// each. The last third of the jerk is for the product of both.
    #[inline(never)]
    pub fn corner(&self, rise: u64, way: u64) -> Corner {
        let alone = self.fit(rise, way, false);
        let used = alone.ease.half().saturating_mul(2);
        let used = used.saturating_add(alone.long.half());
        if alone.whole && used as u64 <= way {
            alone
        } else {
            self.fit(rise, way, true)
        }
    }

    /// The shortest way over which `rise` is possible, rounded up to a hundredth of a millimetre.
    pub fn way_needed(&self, rise: u64) -> u64 {
        let mut way = 0;
        for shared in [false, true] {
            // The shortest way is either all corner (rise = m·ℓ/2) or as steep as the speed allows.
            let (mut low, mut high) = (0_u64, self.steepest());
            if !self.is_corner(high, rise, shared) {
                for _ in 0..STEPS {
                    let middle = low.midpoint(high);
                    if self.is_corner(middle, rise, shared) {
                        low = middle;
                    } else {
                        high = middle;
                    }
                }
                high = low;
            }
            let mut straight = mul_div_up(rise, DIAGONAL, high);
            if straight > i64::MAX as u64 {
                straight = 1 << 59;
            }
            way = straight.saturating_add(self.half(high, shared));
            // Add a little to the result of the bisection, then round up to whole hundredths.
            way = way.saturating_add(way >> 10);
            way = mul_div_up(way, 1, HUNDREDTH)
                .saturating_mul(HUNDREDTH)
                .min(1 << 60);
            if self.corner(rise, way).whole {
                break;
            }
        }
        way
    }

    /// True while a corner into `slope` alone displaces the short axis by no more than `rise`.
    fn is_corner(&self, slope: u64, rise: u64, shared: bool) -> bool {
        seen(self.half(slope, shared), slope) <= rise
    }

    #[inline(never)]
    fn fit(&self, rise: u64, way: u64, shared: bool) -> Corner {
        let way = way.max(1);
        let mut low = 0_u64;
        // A corner as long as the way needs twice the mean slope. A steeper slope is of no use.
        let mut high = mean(rise, way).saturating_mul(2).min(self.steepest());
        let (mut found, mut whole) = (0, false);
        let mut middle = high;
        for _ in 0..STEPS {
            let half = self.half(middle, shared);
            let fits = half << 1 <= way;
            if fits && seen(way.wrapping_sub(half), middle) < rise {
                low = middle;
                if middle == high {
                    // The slope is as steep as the speed allows, and still not enough.
                    break;
                }
            } else {
                high = middle;
                if fits {
                    (found, whole) = (middle, true);
                }
            }
            middle = low.midpoint(high);
        }
        let chosen = if whole { found } else { low };
        let ease = self.round(chosen, shared);
        let slope = if whole {
            // The slope that reaches its target exactly, but not steeper than the slope for which the corner was made.
            mean(rise, way.wrapping_sub(ease.half() as u64)).min(chosen)
        } else {
            chosen
        };
        Corner {
            slope,
            ease,
            long: self.following(slope, &self.share(slope, shared)),
            whole,
        }
    }

    /// Half length of the ease into `slope`.
    fn half(&self, slope: u64, shared: bool) -> u64 {
        Ease::half_for(
            self.speed,
            seen(self.speed, slope),
            &self.share(slope, shared),
        )
    }

    /// The ease into `slope`.
    fn round(&self, slope: u64, shared: bool) -> Ease {
        Ease::new(
            self.speed,
            seen(self.speed, slope),
            &self.share(slope, shared),
        )
    }

    /// The short axis' limits for turning into a slope, and for following the long axis' acceleration along this slope.
    #[inline(never)]
    fn share(&self, slope: u64, shared: bool) -> Bounds {
        if !shared {
            return self.short;
        }
        // x‴ has the term 3·x″(turn)·x″(follow)/(slope·speed). It must stay below the last third.
        let steep = slope.saturating_add(self.taper);
        let product = root_mul_div_up(seen(self.speed, steep), self.short.jerk, 9);
        Bounds {
            acceleration: (self.short.acceleration / 2).min(product),
            jerk: self.short.jerk / 3,
        }
    }
}

/// Number of bisection steps for a slope.
const STEPS: u32 = 16;

/// 0.01 mm in 2⁻¹⁶ nm.
const HUNDREDTH: u64 = 10_000 << 16;
