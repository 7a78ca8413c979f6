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
    /// From the norm's tables, by size and pitch.
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
    /// Where all of them come from.
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

/// Tolerance of the pitch diameter by the formula of ISO 965-1, micrometres; of a nut `1.32` times that of a bolt.
pub(crate) fn by_formula(side: Side, d: f64, p: f64, grade: u8) -> f64 {
    let six = 90.0 * p.powf(0.4) * tables::mean_diameter(d).powf(0.1);
    let nut = if side == Side::Internal { 1.32 } else { 1.0 };
    of_grade(tables::r40(six * nut), grade)
}

/// The tolerance of another grade than the sixth: grades are steps of R40.
fn of_grade(six: f64, grade: u8) -> f64 {
    let steps = match grade {
        ..=3 => -12,
        4 => -8,
        5 => -4,
        6 => 0,
        7 => 4,
        8 => 8,
        9.. => 12,
    };
    tables::steps_on(six, steps)
}

/// What ISO 965-1 has of a thread, micrometres, and where it is from.
struct Metric {
    /// Distance of the tolerance from the basic profile, positive.
    off: f64,
    pitch: f64,
    crest: f64,
    origin: Origin,
}

impl Metric {
    fn of(side: Side, d: f64, p: f64, pitch: (u8, char), crest: (u8, char)) -> Self {
        let row = tables::BY_PITCH.iter().find(|row| row.pitch == p);
        let (off, off_by) = match pitch.1 {
            'g' | 'G' => (row.map(|row| row.g), 15.0),
            'f' => (row.and_then(|row| row.f), 30.0),
            'e' => (row.and_then(|row| row.e), 50.0),
            _ => (Some(0.0), 0.0),
        };
        let six = tables::pitch_diameter(d, p);
        let (six, of_crest, crest_by) = match side {
            Side::External => (
                six.map(|[bolt, _]| bolt),
                row.map(|row| row.major),
                180.0 * p.powf(2.0 / 3.0) - 3.15 / p.sqrt(),
            ),
            Side::Internal => (
                six.map(|[_, nut]| nut),
                row.and_then(|row| row.minor),
                if p >= 1.0 {
                    230.0 * p.powf(0.7)
                } else {
                    433.0 * p - 190.0 * p.powf(1.22)
                },
            ),
        };
        let is_table = off.is_some() && six.is_some() && of_crest.is_some();
        Self {
            off: off.unwrap_or_else(|| tables::r40(off_by + 11.0 * p)),
            pitch: six.map_or_else(
                || by_formula(side, d, p, pitch.0),
                |six| of_grade(six, pitch.0),
            ),
            crest: of_grade(of_crest.unwrap_or_else(|| tables::r40(crest_by)), crest.0),
            origin: if is_table {
                Origin::Table
            } else {
                Origin::Formula
            },
        }
    }
}

/// Rounded as ISO 965-2 prints: to a micrometre.
fn whole(mm: Mm) -> Mm {
    Mm((mm.0 * 1e3).round() / 1e3)
}

fn metric(thread: &Designation, pitch: (u8, char), crest: (u8, char)) -> Limits {
    let norm = Metric::of(thread.side, thread.major.0, thread.pitch.0, pitch, crest);
    let [off, of_pitch, of_crest] = [norm.off, norm.pitch, norm.crest].map(Mm::from_um);
    let basic = whole(thread.pitch_diameter());
    let (major, pitch, minor) = match thread.side {
        Side::External => {
            let (highest, crest) = (basic - off, thread.major - off);
            let minor = Band {
                low: None,
                high: Some(thread.minor() - off),
            };
            (
                Band::new(crest - of_crest, crest),
                Band::new(highest - of_pitch, highest),
                minor,
            )
        }
        Side::Internal => {
            let (lowest, crest) = (basic + off, whole(thread.minor()) + off);
            let major = Band {
                low: Some(thread.major + off),
                high: None,
            };
            (
                major,
                Band::new(lowest, lowest + of_pitch),
                Band::new(crest, crest + of_crest),
            )
        }
    };
    Limits {
        major,
        pitch,
        minor,
        origin: norm.origin,
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
                    small.min(0.394 * p)
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
