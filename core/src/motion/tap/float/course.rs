//! The legs of a hole in their order, one at a time: the same strokes as the cycle's moves, from the same few lengths.

use crate::program::TapForm;
use crate::units::Length;

/// One leg: a stroke, or the dwell at the bottom.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Leg {
    /// In, q further or to the bottom.
    Infeed,
    /// Back by d, or to R between deep pecks.
    Back,
    /// In again, to d above the depth reached.
    Reenter,
    /// Standing at the bottom.
    Dwell,
    /// Out to R, at the end.
    Extract,
}

/// What the legs of a hole are made of. Lengths are depths below R.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Course {
    total: Length,
    /// q and d.
    peck: Option<(Length, Length)>,
    deep: bool,
    dwell: u32,
}

/// Where in its course a tap is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Place {
    /// The leg under way, or the one that begins.
    pub(super) leg: Leg,
    /// How far the hole is cut when it ends.
    cut: Length,
    /// Where it ends.
    pub(super) depth: Length,
}

impl Course {
    /// A hole `total` deep; `dwell` in ticks.
    pub(super) const fn new(total: Length, form: &TapForm, dwell: u32) -> Self {
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

    /// Ticks of the dwell.
    pub(super) const fn dwell(&self) -> u32 {
        self.dwell
    }

    /// True where a leg ends in the bottom.
    pub(super) fn is_bottom(&self, place: &Place) -> bool {
        place.depth == self.total
    }

    /// The first leg.
    pub(super) fn first(&self) -> Place {
        self.infeed(Length::ZERO)
    }

    /// The leg after `place`; none after the extraction. A leg of no length is none.
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

    /// q deeper than `cut`, the bottom at most.
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

    /// d above what is cut, R at the most.
    fn gap(&self, cut: Length) -> Length {
        let back = self.peck.map_or(Length::ZERO, |(_, d)| d);
        (cut - back).max(Length::ZERO)
    }
}
