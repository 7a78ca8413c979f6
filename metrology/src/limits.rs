//! The limits that a norm gives for a thread.

use crate::designation::{Designation, Series};
use crate::tables;
use crate::units::{Mm, Side};

/// From where to where.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Band {
    /// Nothing smaller, where there is a limit.
    pub low: Option<Mm>,
    /// Nothing larger, where there is a limit.
    pub high: Option<Mm>,
}

impl Band {
    /// Both limits.
    #[must_use]
    pub const fn new(low: Mm, high: Mm) -> Self {
        Self {
            low: Some(low),
            high: Some(high),
        }
    }

    /// True where there is a limit at all.
    #[must_use]
    pub const fn exists(&self) -> bool {
        self.low.is_some() || self.high.is_some()
    }

    /// Nothing of `low` to `high` is outside; a tenth of a micrometre is not asked.
    #[must_use]
    pub fn holds(&self, low: Mm, high: Mm) -> bool {
        const FINEST: f64 = 1e-4;
        self.low.is_none_or(|limit| low.0 >= limit.0 - FINEST)
            && self.high.is_none_or(|limit| high.0 <= limit.0 + FINEST)
    }
}

/// Where limits come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// Printed in the norm.
    Table,
    /// Computed as the norm says; of ISO 965 within one step of R40 of what is printed.
    Formula,
    /// There is no norm.
    None,
}

/// Limits of the three diameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Of the major diameter.
    pub major: Band,
    /// Of the pitch diameter; of a pipe thread at its plane L1.
    pub pitch: Band,
    /// Of the minor diameter.
    pub minor: Band,
    /// Where those of the pitch diameter come from.
    pub origin: Origin,
}

impl Limits {
    /// The limits of a thread.
    #[must_use]
    pub fn of(thread: &Designation) -> Self {
        match thread.series {
            Series::Metric { pitch, crest } => metric(thread, pitch, crest),
            Series::Unified { class, engagement } => unified(thread, class, engagement),
            Series::Pipe { .. } => {
                // A turn more or less at the gauge: 1:16 on the diameter.
                let (e1, turn) = (thread.pitch_diameter(), thread.pitch * (1.0 / 16.0));
                Self {
                    major: Band::default(),
                    pitch: Band::new(e1 - turn, e1 + turn),
                    minor: Band::default(),
                    origin: Origin::Table,
                }
            }
            Series::Free => Self {
                major: Band::default(),
                pitch: Band::default(),
                minor: Band::default(),
                origin: Origin::None,
            },
        }
    }
}

/// Tolerance of the pitch diameter of a bolt by grade, micrometres; that of a nut is `1.32` times the one of grade 6.
pub(crate) fn pitch_tolerance(side: Side, d: f64, p: f64, grade: u8) -> f64 {
    let six = 90.0 * p.powf(0.4) * tables::mean_diameter(d).powf(0.1);
    let nut = if side == Side::Internal { 1.32 } else { 1.0 };
    tables::r40(six * nut * factor(grade))
}

fn factor(grade: u8) -> f64 {
    match grade {
        ..=3 => 0.5,
        4 => 0.63,
        5 => 0.8,
        6 => 1.0,
        7 => 1.25,
        8 => 1.6,
        9.. => 2.0,
    }
}

/// Distance of the tolerance from the basic profile, micrometres, positive.
fn deviation(letter: char, p: f64) -> f64 {
    match letter {
        'g' | 'G' => tables::r40(15.0 + 11.0 * p),
        'f' => tables::r40(30.0 + 11.0 * p),
        'e' => tables::r40(50.0 + 11.0 * p),
        _ => 0.0,
    }
}

fn metric(thread: &Designation, pitch: (u8, char), crest: (u8, char)) -> Limits {
    let (d, p) = (thread.major.0, thread.pitch.0);
    let off = Mm::from_um(deviation(pitch.1, p));
    let tolerance = Mm::from_um(pitch_tolerance(thread.side, d, p, pitch.0));
    let printed = tables::ISO_965_2
        .iter()
        .find(|row| row[0] == d && row[1] == p);
    match thread.side {
        Side::External => {
            let six = 180.0 * p.powf(2.0 / 3.0) - 3.15 / p.sqrt();
            let of_crest = Mm::from_um(tables::r40(six * factor(crest.0)));
            let highest = thread.pitch_diameter() - off;
            let (band, origin) = match printed.filter(|_| pitch == (6, 'g')) {
                Some(row) => (Band::new(Mm(row[3]), Mm(row[2])), Origin::Table),
                None => (Band::new(highest - tolerance, highest), Origin::Formula),
            };
            Limits {
                major: Band::new(thread.major - off - of_crest, thread.major - off),
                pitch: band,
                minor: Band {
                    low: None,
                    high: Some(thread.minor() - off),
                },
                origin,
            }
        }
        Side::Internal => {
            let six = if p >= 1.0 {
                230.0 * p.powf(0.7)
            } else {
                433.0 * p - 190.0 * p.powf(1.22)
            };
            let of_crest = Mm::from_um(tables::r40(six * factor(crest.0)));
            let lowest = thread.pitch_diameter() + off;
            let (band, origin) = match printed.filter(|_| pitch == (6, 'H')) {
                Some(row) => (Band::new(Mm(row[4]), Mm(row[5])), Origin::Table),
                None => (Band::new(lowest, lowest + tolerance), Origin::Formula),
            };
            Limits {
                major: Band {
                    low: Some(thread.major + off),
                    high: None,
                },
                pitch: band,
                minor: Band::new(thread.minor() + off, thread.minor() + off + of_crest),
                origin,
            }
        }
    }
}

/// Rounded as B1.1 prints: to a ten-thousandth of an inch.
fn printed(inches: f64) -> f64 {
    (inches * 1e4).round() / 1e4
}

fn unified(thread: &Designation, class: u8, engagement: Mm) -> Limits {
    let inch = |mm: Mm| mm.0 / 25.4;
    let (d, p, e) = (inch(thread.major), inch(thread.pitch), inch(engagement));
    let two_a = 0.0015 * d.cbrt() + 0.0015 * e.sqrt() + 0.015 * p.powf(2.0 / 3.0);
    let basic = printed(inch(thread.pitch_diameter()));
    let band = |low: f64, high: f64| Band::new(Mm::from_inch(low), Mm::from_inch(high));
    let (major, pitch, minor) = match thread.side {
        Side::External => {
            let share = [1.5, 1.0, 0.75][usize::from(class.clamp(1, 3)) - 1];
            let allowance = if class == 3 {
                0.0
            } else {
                printed(0.3 * two_a)
            };
            let (top, crest) = (basic - allowance, d - allowance);
            let wide = if class == 1 { 0.090 } else { 0.060 };
            (
                band(crest - printed(wide * p.powf(2.0 / 3.0)), crest),
                band(top - printed(two_a * share), top),
                Band {
                    low: None,
                    high: Some(thread.minor() - Mm::from_inch(allowance)),
                },
            )
        }
        Side::Internal => {
            let share = [1.95, 1.3, 0.975][usize::from(class.clamp(1, 3)) - 1];
            let low = printed(inch(thread.minor()));
            // Class 3B has a minor diameter of its own, which no formula here gives: only its lower limit is judged.
            let high = (class < 3).then(|| {
                let small = 0.05 * p.powf(2.0 / 3.0) + 0.03 * p / d - 0.002;
                let wide = if d < 0.25 {
                    small
                } else {
                    0.25 * p - 0.4 * p * p
                };
                Mm::from_inch(low + printed(wide))
            });
            (
                Band {
                    low: Some(thread.major),
                    high: None,
                },
                band(basic, basic + printed(two_a * share)),
                Band {
                    low: Some(Mm::from_inch(low)),
                    high,
                },
            )
        }
    };
    Limits {
        major,
        pitch,
        minor,
        origin: Origin::Formula,
    }
}
