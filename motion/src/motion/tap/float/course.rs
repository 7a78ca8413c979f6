//! The legs of a hole, in order and one at a time. They are the same strokes as the cycle's moves, computed from the
//! same few lengths.

use crate::call::TapForm;
use crate::units::Length;

/// One leg: a stroke, or the dwell at the bottom.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Leg {
    /// In, by q or to the bottom.
    Infeed,
    /// Back by d, or to R between deep pecks.
    Back,
    /// In again, to d above the cut depth.
    Reenter,
    /// Standing at the bottom.
    Dwell,
    /// Out to R, at the end.
    Extract,
}

/// The figures from which the legs of a hole follow. Lengths are depths below R.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Course {
    total: Length,
    /// q and d.
    peck: Option<(Length, Length)>,
    deep: bool,
    dwell: u32,
}

/// The position of a tap in its course.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Place {
    /// The leg under way, or the leg that begins.
    pub(super) leg: Leg,
    /// Depth to which the hole is cut when the leg ends.
    cut: Length,
    /// Depth at which the leg ends.
    pub(super) depth: Length,
}

impl Course {
    /// A hole `total` deep; `dwell` in ticks.
    #[must_use]
    pub const fn new(total: Length, form: &TapForm, dwell: u32) -> Self {
        let (peck, deep) = match form {
            TapForm::Standard => (None, false),
            TapForm::HighSpeed(peck) => (Some((peck.infeed.value, peck.back.value)), false),
            TapForm::Deep(peck) => (Some((peck.infeed.value, peck.back.value)), true),
        };
        Self {
            total,
            peck,
            deep,
            dwell,
        }
    }

    /// The depths below R at which the legs end, in order.
    pub fn depths(&self) -> impl Iterator<Item = Length> + '_ {
        core::iter::successors(Some(self.first()), |place| self.after(place))
            .map(|place| place.depth)
    }

    /// Ticks of the dwell.
    pub(super) const fn dwell(&self) -> u32 {
        self.dwell
    }

    /// True if the leg ends at the bottom.
    pub(super) fn is_bottom(&self, place: &Place) -> bool {
        place.depth == self.total
    }

    /// The first leg.
    pub(super) fn first(&self) -> Place {
        self.infeed(Length::ZERO)
    }

    /// The leg after `place`; `None` after the extraction. Legs of length zero are left out.
    pub(super) fn after(&self, place: &Place) -> Option<Place> {
        let cut = place.cut;
        match place.leg {
            Leg::Infeed if self.is_bottom(place) && self.dwell > 0 => Some(Place {
                leg: Leg::Dwell,
                ..*place
            }),
            Leg::Infeed if self.is_bottom(place) => Some(self.extract()),
            Leg::Infeed => {
                let depth = if self.deep {
                    Length::ZERO
                } else {
                    self.gap(cut)
                };
                if depth == cut {
                    return Some(self.infeed(cut));
                }
                Some(Place {
                    leg: Leg::Back,
                    cut,
                    depth,
                })
            }
            Leg::Back if self.deep && self.gap(cut) > Length::ZERO => Some(Place {
                leg: Leg::Reenter,
                cut,
                depth: self.gap(cut),
            }),
            Leg::Back | Leg::Reenter => Some(self.infeed(cut)),
            Leg::Dwell => Some(self.extract()),
            Leg::Extract => None,
        }
    }

    /// The infeed q deeper than `cut`, but at most to the bottom.
    fn infeed(&self, cut: Length) -> Place {
        let depth = match self.peck {
            Some((q, _)) => (cut + q).min(self.total),
            None => self.total,
        };
        Place {
            leg: Leg::Infeed,
            cut: depth,
            depth,
        }
    }

    const fn extract(&self) -> Place {
        Place {
            leg: Leg::Extract,
            cut: self.total,
            depth: Length::ZERO,
        }
    }

    /// The depth d above the cut depth, but at most up to R.
    fn gap(&self, cut: Length) -> Length {
        let back = self.peck.map_or(Length::ZERO, |(_, d)| d);
        (cut - back).max(Length::ZERO)
    }
}
