//! Units of parameters, and values as text, exactly.
//!
//! A value is kept as a whole number of the smallest step of its unit (`raw`): nanometres for `mm`, nanometres per
//! minute for `mm/min`, and so on. Text becomes raw without floating point and without rounding: what is finer than the
//! step is refused. This file knows nothing of the rest of the core, because the build script reads the definitions
//! with it too.

use core::fmt;

/// Unit of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// A count, a code, a switch: no unit.
    Number,
    /// Tenths of the lead of a thread.
    TenthLead,
    /// Tenths of a turn per minute.
    TenthRpm,
    /// Tenths of one per second: the gain of a position loop.
    TenthPerSecond,
    /// Tenths of a per cent.
    TenthPercent,
    /// Whole degrees.
    WholeDegree,
    /// Per cent.
    Percent,
    /// Hertz.
    Hertz,
    /// Turns per minute.
    Rpm,
    /// Milliseconds.
    Millisecond,
    /// Microseconds.
    Microsecond,
    /// Micrometres; raw in tenths of one.
    Micrometre,
    /// Millimetres; raw in nanometres.
    Millimetre,
    /// Millimetres on the diameter; raw in nanometres on the radius.
    DiameterMillimetre,
    /// Millimetres per minute; raw in nanometres per minute.
    MillimetrePerMinute,
    /// Metres per second squared; raw in nanometres per second squared.
    MetrePerSecond2,
    /// Metres per second cubed; raw in nanometres per second cubed.
    MetrePerSecond3,
    /// Degrees; raw in millionths of a degree.
    Degree,
    /// Degrees per minute; raw in millionths of a degree per minute.
    DegreePerMinute,
    /// Degrees per second squared; raw in millionths.
    DegreePerSecond2,
    /// Degrees per second cubed; raw in millionths.
    DegreePerSecond3,
}

/// Why a text is no value of a unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ValueError {
    /// It does not begin with a decimal number.
    NoNumber,
    /// A unit follows the number, but not a unit of this kind.
    WrongUnit,
    /// There is no unit, and the place asks for one.
    UnitMissing,
    /// A digit beyond the smallest step of the unit.
    TooFine,
    /// More digits than any range holds.
    TooLarge,
}

/// Whether a value must say its unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Writing {
    /// The unit may be left out: it is the parameter's own.
    UnitOptional,
    /// A value that has a unit must be written with it.
    UnitRequired,
}

/// More digits than this are refused, zeros at the end of the fraction aside; it keeps the product below 2¹²⁷.
const MAX_DIGITS: u32 = 18;

const MM: i64 = 1_000_000;
const INCH: i64 = 25_400_000;

impl Unit {
    /// The unit as it is printed.
    #[must_use]
    pub const fn symbol(self) -> &'static str {
        match self {
            Self::Number => "",
            Self::TenthLead => "0.1 lead",
            Self::TenthRpm => "0.1 rpm",
            Self::TenthPerSecond => "0.1 /s",
            Self::TenthPercent => "0.1 %",
            Self::WholeDegree | Self::Degree => "°",
            Self::Percent => "%",
            Self::Hertz => "Hz",
            Self::Rpm => "rpm",
            Self::Millisecond => "ms",
            Self::Microsecond => "µs",
            Self::Micrometre => "µm",
            Self::Millimetre | Self::DiameterMillimetre => "mm",
            Self::MillimetrePerMinute => "mm/min",
            Self::MetrePerSecond2 => "m/s²",
            Self::MetrePerSecond3 => "m/s³",
            Self::DegreePerMinute => "°/min",
            Self::DegreePerSecond2 => "°/s²",
            Self::DegreePerSecond3 => "°/s³",
        }
    }

    /// True where a bare number says all: there is no unit, or only a step of its own.
    #[must_use]
    pub const fn is_bare(self) -> bool {
        matches!(
            self,
            Self::Number
                | Self::TenthLead
                | Self::TenthRpm
                | Self::TenthPerSecond
                | Self::TenthPercent
        )
    }

    /// True for an X value that is written as a diameter.
    #[must_use]
    pub const fn is_diameter(self) -> bool {
        matches!(self, Self::DiameterMillimetre)
    }

    /// Every way to write the unit, with the raw steps in one of it; the first is the unit itself.
    #[must_use]
    pub const fn spellings(self) -> &'static [(&'static str, i64)] {
        match self {
            Self::Number => &[("", 1)],
            Self::TenthLead => &[("", 1), ("× 0.1 lead", 1), ("lead", 10)],
            Self::TenthRpm => &[("", 1), ("× 0.1 rpm", 1), ("rpm", 10)],
            Self::TenthPerSecond => &[("", 1), ("× 0.1 /s", 1), ("/s", 10), ("1/s", 10)],
            Self::TenthPercent => &[("", 1), ("× 0.1 %", 1), ("%", 10)],
            Self::WholeDegree => &[("°", 1), ("deg", 1)],
            Self::Percent => &[("%", 1)],
            Self::Hertz => &[("Hz", 1), ("kHz", 1_000)],
            Self::Rpm => &[("rpm", 1), ("r/min", 1), ("1/min", 1)],
            Self::Millisecond => &[("ms", 1), ("s", 1_000)],
            // The second µ is the Greek letter, the first the micro sign; both come out of keyboards.
            Self::Microsecond => &[("µs", 1), ("μs", 1), ("us", 1), ("ms", 1_000)],
            Self::Micrometre => &[("µm", 10), ("μm", 10), ("um", 10), ("mm", 10_000)],
            Self::Millimetre => &[
                ("mm", MM),
                ("µm", 1_000),
                ("μm", 1_000),
                ("um", 1_000),
                ("nm", 1),
                ("cm", 10 * MM),
                ("m", 1_000 * MM),
                ("in", INCH),
                ("inch", INCH),
            ],
            Self::DiameterMillimetre => &[
                ("mm", MM / 2),
                ("µm", 500),
                ("μm", 500),
                ("um", 500),
                ("in", INCH / 2),
                ("inch", INCH / 2),
            ],
            Self::MillimetrePerMinute => &[
                ("mm/min", MM),
                ("m/min", 1_000 * MM),
                ("mm/s", 60 * MM),
                ("m/s", 60_000 * MM),
                ("in/min", INCH),
                ("inch/min", INCH),
            ],
            Self::MetrePerSecond2 => &[
                ("m/s²", 1_000 * MM),
                ("m/s2", 1_000 * MM),
                ("mm/s²", MM),
                ("mm/s2", MM),
            ],
            Self::MetrePerSecond3 => &[
                ("m/s³", 1_000 * MM),
                ("m/s3", 1_000 * MM),
                ("mm/s³", MM),
                ("mm/s3", MM),
            ],
            Self::Degree => &[("°", MM), ("deg", MM)],
            Self::DegreePerMinute => &[
                ("°/min", MM),
                ("deg/min", MM),
                ("°/s", 60 * MM),
                ("deg/s", 60 * MM),
                ("rpm", 360 * MM),
            ],
            Self::DegreePerSecond2 => &[("°/s²", MM), ("deg/s²", MM), ("deg/s2", MM)],
            Self::DegreePerSecond3 => &[("°/s³", MM), ("deg/s³", MM), ("deg/s3", MM)],
        }
    }

    /// Printed value = raw · `.0` / 10^`.1`.
    const fn decimal(self) -> (i64, u32) {
        match self {
            Self::Number
            | Self::TenthLead
            | Self::TenthRpm
            | Self::TenthPerSecond
            | Self::TenthPercent
            | Self::WholeDegree
            | Self::Percent
            | Self::Hertz
            | Self::Rpm
            | Self::Millisecond
            | Self::Microsecond => (1, 0),
            Self::Millimetre
            | Self::MillimetrePerMinute
            | Self::Degree
            | Self::DegreePerMinute
            | Self::DegreePerSecond2
            | Self::DegreePerSecond3 => (1, 6),
            Self::Micrometre => (1, 1),
            Self::DiameterMillimetre => (2, 6),
            Self::MetrePerSecond2 | Self::MetrePerSecond3 => (1, 9),
        }
    }

    /// The raw value of `text`: a decimal number, followed by any spelling of the unit.
    ///
    /// # Errors
    /// What [`ValueError`] says; never a rounded value.
    pub fn parse(self, text: &str, writing: Writing) -> Result<i64, ValueError> {
        let text = text.trim();
        let (number, unit) = text
            .split_at_checked(number_len(text))
            .unwrap_or((text, ""));
        let (mantissa, decimals) = decimal(number)?;
        let unit = unit.trim();
        let scale = if unit.is_empty() {
            if unit.is_empty() && writing == Writing::UnitRequired && !self.is_bare() {
                return Err(ValueError::UnitMissing);
            }
            self.spellings().first().map(|&(_, scale)| scale)
        } else {
            let known = self.spellings().iter().find(|(name, _)| *name == unit);
            known.map(|&(_, scale)| scale)
        };
        let scale = scale.ok_or(ValueError::WrongUnit)?;
        let product = i128::from(mantissa).checked_mul(i128::from(scale));
        let power = 10_i128.checked_pow(decimals);
        let (Some(product), Some(power)) = (product, power) else {
            return Err(ValueError::TooLarge);
        };
        if product.checked_rem(power) != Some(0) {
            return Err(ValueError::TooFine);
        }
        let raw = product.checked_div(power).ok_or(ValueError::TooLarge)?;
        i64::try_from(raw).map_err(|_| ValueError::TooLarge)
    }

    /// `raw` as a decimal number in this unit, without the unit, with as many decimals as are exact.
    #[must_use]
    pub const fn number(self, raw: i64) -> Shown {
        Shown {
            raw,
            unit: self,
            symbol: false,
        }
    }

    /// `raw` as a decimal number with its unit; [`Unit::parse`] gives `raw` back.
    #[must_use]
    pub const fn text(self, raw: i64) -> Shown {
        Shown {
            raw,
            unit: self,
            symbol: true,
        }
    }
}

/// A value to print.
#[derive(Clone, Copy, Debug)]
pub struct Shown {
    raw: i64,
    unit: Unit,
    symbol: bool,
}

impl fmt::Display for Shown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (factor, decimals) = self.unit.decimal();
        let value = i128::from(self.raw).saturating_mul(i128::from(factor));
        let one = 10_u128.checked_pow(decimals).unwrap_or(1);
        let magnitude = value.unsigned_abs();
        let whole = magnitude.checked_div(one).unwrap_or(0);
        let mut rest = magnitude.checked_rem(one).unwrap_or(0);
        let mut width = decimals as usize;
        while width > 0 && rest % 10 == 0 {
            rest /= 10;
            width = width.saturating_sub(1);
        }
        if value < 0 {
            f.write_str("-")?;
        }
        write!(f, "{whole}")?;
        if width > 0 {
            write!(f, ".{rest:0width$}")?;
        }
        match (self.symbol, self.unit) {
            (false, _) | (true, Unit::Number) => Ok(()),
            (true, unit) if unit.is_bare() => write!(f, " × {}", self.unit.symbol()),
            (true, unit) => write!(f, " {}", unit.symbol()),
        }
    }
}

/// Length of the leading part of `text` that can belong to a number.
fn number_len(text: &str) -> usize {
    text.bytes()
        .position(|b| !(b.is_ascii_digit() || matches!(b, b'+' | b'-' | b'.')))
        .unwrap_or(text.len())
}

/// The number as `mantissa · 10^−decimals`.
fn decimal(text: &str) -> Result<(i64, u32), ValueError> {
    let (negative, digits) = match text.as_bytes().first() {
        Some(b'-') => (true, text.get(1..)),
        Some(b'+') => (false, text.get(1..)),
        _ => (false, Some(text)),
    };
    let digits = digits.unwrap_or("");
    let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
    let all_digits = |s: &str| s.bytes().all(|b| b.is_ascii_digit());
    if (whole.is_empty() && fraction.is_empty()) || !all_digits(whole) || !all_digits(fraction) {
        return Err(ValueError::NoNumber);
    }
    let whole = whole.trim_start_matches('0');
    let fraction = fraction.trim_end_matches('0');
    let (mut mantissa, mut count, mut decimals) = (0_i64, 0_u32, 0_u32);
    for (byte, is_decimal) in whole
        .bytes()
        .map(|b| (b, false))
        .chain(fraction.bytes().map(|b| (b, true)))
    {
        count = count.saturating_add(1);
        if count > MAX_DIGITS {
            // Digits that far after the point are finer than any step; before the point they are beyond any range.
            return Err(if is_decimal {
                ValueError::TooFine
            } else {
                ValueError::TooLarge
            });
        }
        mantissa = mantissa
            .wrapping_mul(10)
            .wrapping_add(i64::from(byte.wrapping_sub(b'0')));
        decimals = decimals.wrapping_add(u32::from(is_decimal));
    }
    Ok((
        if negative {
            mantissa.wrapping_neg()
        } else {
            mantissa
        },
        decimals,
    ))
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::format;

    const ALL: [Unit; 21] = [
        Unit::Number,
        Unit::TenthLead,
        Unit::TenthRpm,
        Unit::TenthPerSecond,
        Unit::TenthPercent,
        Unit::WholeDegree,
        Unit::Percent,
        Unit::Hertz,
        Unit::Rpm,
        Unit::Millisecond,
        Unit::Microsecond,
        Unit::Micrometre,
        Unit::Millimetre,
        Unit::DiameterMillimetre,
        Unit::MillimetrePerMinute,
        Unit::MetrePerSecond2,
        Unit::MetrePerSecond3,
        Unit::Degree,
        Unit::DegreePerMinute,
        Unit::DegreePerSecond2,
        Unit::DegreePerSecond3,
    ];

    fn optional(unit: Unit, text: &str) -> Result<i64, ValueError> {
        unit.parse(text, Writing::UnitOptional)
    }

    #[test]
    fn values_are_exact() {
        for (unit, text, raw) in [
            (Unit::Millimetre, "0.5", 500_000),
            (Unit::Millimetre, "-0.000001 mm", -1),
            (Unit::Millimetre, "+1 in", 25_400_000),
            (Unit::Millimetre, ".1", 100_000),
            (Unit::Millimetre, "1.", 1_000_000),
            (Unit::Millimetre, "1.00000000000000000000000", 1_000_000),
            (Unit::Millimetre, "000000000000000000000001", 1_000_000),
            (Unit::Millimetre, "300 nm", 300),
            (Unit::DiameterMillimetre, "0.0001", 50),
            (Unit::DiameterMillimetre, "0.00001 inch", 127),
            (Unit::MillimetrePerMinute, "12 m/min", 12_000_000_000),
            (Unit::MillimetrePerMinute, "12000mm/min", 12_000_000_000),
            (Unit::MetrePerSecond2, "2 m/s²", 2_000_000_000),
            (Unit::MetrePerSecond3, "60000 mm/s3", 60_000_000_000),
            (Unit::DegreePerMinute, "7200 °/s", 432_000_000_000),
            (Unit::Number, "007", 7),
            (Unit::Microsecond, "1 ms", 1_000),
            (Unit::TenthRpm, "1 rpm", 10),
            (Unit::TenthLead, "0.5 lead", 5),
            (Unit::TenthLead, "5 × 0.1 lead", 5),
        ] {
            assert_eq!(optional(unit, text), Ok(raw), "{unit:?} {text}");
        }
    }

    #[test]
    fn what_is_no_value_is_refused_with_the_reason() {
        for (unit, text, error) in [
            (Unit::Millimetre, "", ValueError::NoNumber),
            (Unit::Millimetre, "-", ValueError::NoNumber),
            (Unit::Millimetre, ".", ValueError::NoNumber),
            (Unit::Millimetre, "--1", ValueError::NoNumber),
            (Unit::Millimetre, "1.2.3", ValueError::NoNumber),
            (Unit::Millimetre, "1-2", ValueError::NoNumber),
            (Unit::Millimetre, "mm", ValueError::NoNumber),
            (Unit::Millimetre, "1e3", ValueError::WrongUnit),
            (Unit::Millimetre, "1,5", ValueError::WrongUnit),
            (Unit::Millimetre, "5 mm/min", ValueError::WrongUnit),
            (Unit::Number, "5 mm", ValueError::WrongUnit),
            (Unit::Millimetre, "0.0000001", ValueError::TooFine),
            (
                Unit::Millimetre,
                "0.0000000000000000000000001",
                ValueError::TooFine,
            ),
            (Unit::DiameterMillimetre, "0.000001", ValueError::TooFine),
            (Unit::Number, "0.5", ValueError::TooFine),
            (Unit::Number, "1000000000000000000", ValueError::TooLarge),
            (Unit::Millimetre, "99999999999999999", ValueError::TooLarge),
        ] {
            assert_eq!(optional(unit, text), Err(error), "{unit:?} {text:?}");
        }
    }

    #[test]
    fn a_unit_can_be_demanded() {
        let demand = |unit: Unit, text| unit.parse(text, Writing::UnitRequired);
        assert_eq!(demand(Unit::Millimetre, "5"), Err(ValueError::UnitMissing));
        assert_eq!(demand(Unit::Millimetre, "5 mm"), Ok(5_000_000));
        assert_eq!(demand(Unit::Number, "5"), Ok(5));
        assert_eq!(demand(Unit::TenthLead, "5"), Ok(5));
    }

    #[test]
    fn what_is_printed_reads_back() {
        for unit in ALL {
            for raw in [
                0,
                1,
                -1,
                10,
                999,
                123_456_789,
                -1_000_000,
                99_999_999_900_000,
            ] {
                let text = format!("{}", unit.text(raw));
                assert_eq!(
                    unit.parse(&text, Writing::UnitRequired),
                    Ok(raw),
                    "{unit:?} {text}"
                );
            }
        }
        assert_eq!(format!("{}", Unit::Millimetre.text(-1_500)), "-0.0015 mm");
        assert_eq!(
            format!("{}", Unit::DiameterMillimetre.number(1)),
            "0.000002"
        );
        assert_eq!(
            format!("{}", Unit::MillimetrePerMinute.text(12_000_000_000)),
            "12000 mm/min"
        );
    }
}
