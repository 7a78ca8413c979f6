//! The shape of a cutting edge in the axial plane.

use crate::units::{Degrees, Mm};

/// The end of the edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Nose {
    /// A circle of this radius.
    Round(Mm),
    /// A flat of this width.
    Flat(Mm),
}

/// An edge: a nose and two flanks. Its reference is the lowest point of the nose, in the middle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tool {
    /// The nose.
    pub nose: Nose,
    /// Angle of the flank towards −Z, from the normal of the axis.
    pub minus: Degrees,
    /// Angle of the flank towards +Z, from the normal of the axis.
    pub plus: Degrees,
}

/// One half of an edge: what it is at a distance from the middle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Half {
    radius: f64,
    /// Where the flank begins: distance and height.
    pub(crate) begin: (f64, f64),
    /// Height per distance on the flank; infinite for a flank normal to the axis.
    pub(crate) slope: f64,
}

impl Tool {
    /// A V of a whole angle, both flanks alike.
    #[must_use]
    pub fn vee(angle: Degrees, nose: Nose) -> Self {
        Self {
            nose,
            minus: angle * 0.5,
            plus: angle * 0.5,
        }
    }

    /// A grooving tool: a flat with flanks normal to the axis.
    #[must_use]
    pub fn flat(width: Mm) -> Self {
        Self::vee(Degrees(0.0), Nose::Flat(width))
    }

    /// Its outline from −Z to +Z: distance from the reference along Z, and height above it, up to `height`.
    #[must_use]
    pub fn outline(&self, height: Mm) -> Vec<(Mm, Mm)> {
        /// Points of half a round nose.
        const STEPS: u32 = 24;
        let half = |half: &Half| {
            let (end, low) = half.begin;
            let top = height.0.max(0.0);
            let end = end.min(half.reach(top));
            let mut points: Vec<(f64, f64)> = (1..=STEPS)
                .map(|n| end * f64::from(n) / f64::from(STEPS))
                .map(|distance| (distance, half.nose(distance)))
                .collect();
            if top > low {
                points.push((half.reach(top), top));
            }
            points
        };
        let [minus, plus] = self.halves();
        let left = half(&minus).into_iter().rev().map(|(z, u)| (Mm(-z), Mm(u)));
        let right = half(&plus).into_iter().map(|(z, u)| (Mm(z), Mm(u)));
        left.chain([(Mm(0.0), Mm(0.0))]).chain(right).collect()
    }

    fn half(&self, flank: Degrees) -> Half {
        let (sin, cos) = flank.0.to_radians().sin_cos();
        let slope = if sin > 1e-9 { cos / sin } else { f64::INFINITY };
        match self.nose {
            Nose::Round(Mm(radius)) => Half {
                radius,
                begin: (radius * cos, radius * (1.0 - sin)),
                slope,
            },
            Nose::Flat(Mm(width)) => Half {
                radius: 0.0,
                begin: (width / 2.0, 0.0),
                slope,
            },
        }
    }

    /// The half towards −Z and that towards +Z.
    pub(crate) fn halves(&self) -> [Half; 2] {
        [self.half(self.minus), self.half(self.plus)]
    }
}

impl Half {
    /// Height above the lowest point on the nose, at a distance within it.
    pub(crate) fn nose(&self, distance: f64) -> f64 {
        if self.radius > 0.0 {
            let r = self.radius;
            r - (r * r - distance * distance).max(0.0).sqrt()
        } else {
            0.0
        }
    }

    /// The distance at which the edge reaches a height.
    pub(crate) fn reach(&self, height: f64) -> f64 {
        let (distance, low) = self.begin;
        if height >= low {
            return if self.slope.is_finite() {
                distance + (height - low) / self.slope
            } else {
                distance
            };
        }
        let below = self.radius - height;
        (self.radius * self.radius - below * below).max(0.0).sqrt()
    }
}
