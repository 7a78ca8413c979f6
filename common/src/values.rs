//! Values on the command line with a form of their own. They are exact: decimals are read as integers, never as floats.

use std::fmt;
use std::str::FromStr;

use leadscrew_core::signals::Signal;

use crate::words::Both;

/// The reason why a value cannot be read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mistake(pub Both);

impl fmt::Display for Mistake {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0.en)
    }
}

impl std::error::Error for Mistake {}

/// A `Mistake` from both texts.
#[macro_export]
macro_rules! mistake {
    ($($words:tt)*) => { $crate::values::Mistake($crate::both!($($words)*)) };
}
pub use crate::mistake;

/// Reads a decimal as an integer with `decimals` digits after the point; refuses more digits than that.
pub fn decimal(text: &str, decimals: usize) -> Result<i64, Mistake> {
    let (negative, digits) = match text.strip_prefix('-') {
        Some(rest) => (true, rest),
        None => (false, text.strip_prefix('+').unwrap_or(text)),
    };
    let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
    let fraction = fraction.trim_end_matches('0');
    let no_number = || mistake!("`{text}` is not a number", "`{text}` 不是数字");
    if whole.is_empty() && fraction.is_empty() && !digits.contains('0') {
        return Err(no_number());
    }
    if fraction.len() > decimals {
        return Err(mistake!(
            "`{text}` has more than {decimals} decimals",
            "`{text}` 的小数超过 {decimals} 位"
        ));
    }
    let mut value: i64 = 0;
    let padding = std::iter::repeat_n(b'0', decimals - fraction.len());
    for byte in whole.bytes().chain(fraction.bytes()).chain(padding) {
        if !byte.is_ascii_digit() {
            return Err(no_number());
        }
        value = value
            .checked_mul(10)
            .and_then(|v| v.checked_add(i64::from(byte - b'0')))
            .ok_or_else(|| mistake!("`{text}` is too large", "`{text}` 太大"))?;
    }
    Ok(if negative { -value } else { value })
}

/// Power-up position: machine coordinates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct At {
    /// Radius in nanometres.
    pub x_nm: i64,
    /// Nanometres.
    pub z_nm: i64,
    /// Millionths of a degree.
    pub c_udeg: i64,
}

impl FromStr for At {
    type Err = Mistake;

    fn from_str(text: &str) -> Result<Self, Mistake> {
        let mut at = Self::default();
        let mut seen = Vec::new();
        for part in text.split(',') {
            let (axis, value) = part.split_once('=').ok_or_else(|| {
                mistake!(
                    "`{part}`: expected `X=100,Z=50` (X is a diameter, in mm)",
                    "`{part}`：应写成 `X=100,Z=50`（X 为直径，单位 mm）"
                )
            })?;
            let axis = axis.trim().to_ascii_uppercase();
            let value = decimal(value.trim(), 6)?;
            if value.abs() > 1 << 42 {
                return Err(mistake!(
                    "`{part}` is outside of any machine",
                    "`{part}` 超出任何机床的范围"
                ));
            }
            match axis.as_str() {
                // A diameter in nanometres is twice the radius; an odd one has no radius.
                "X" if value % 2 != 0 => {
                    return Err(mistake!(
                        "`{part}`: half of it is no whole nanometre",
                        "`{part}`：它的一半不是整数纳米"
                    ));
                }
                "X" => at.x_nm = value / 2,
                "Z" => at.z_nm = value,
                "C" => at.c_udeg = value,
                _ => {
                    return Err(mistake!(
                        "there is no axis `{axis}`: X, Z and C are",
                        "没有轴 `{axis}`：只有 X、Z 和 C"
                    ));
                }
            }
            if seen.contains(&axis) {
                return Err(mistake!("`{axis}` stands there twice", "`{axis}` 写了两次"));
            }
            seen.push(axis);
        }
        Ok(at)
    }
}

/// `NAME=0|1`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SetSignal {
    /// The input.
    pub signal: Signal,
    /// Its level.
    pub level: bool,
}

impl FromStr for SetSignal {
    type Err = Mistake;

    fn from_str(text: &str) -> Result<Self, Mistake> {
        let (name, level) = match text.split_once('=') {
            Some((name, "0")) => (name, false),
            Some((name, "1")) => (name, true),
            _ => {
                return Err(mistake!(
                    "expected `NAME=0` or `NAME=1`",
                    "应写成 `NAME=0` 或 `NAME=1`"
                ));
            }
        };
        match Signal::find(name) {
            Some(signal) => Ok(Self { signal, level }),
            None => Err(mistake!(
                "there is no signal `{name}`; there are {all}",
                "没有信号 `{name}`；有 {all}",
                all = Signal::ALL.map(Signal::name).join(", ")
            )),
        }
    }
}

/// Speed ripple of the spindle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ripple {
    /// Amplitude in thousandths of a percent of the commanded speed.
    pub milli_percent: u32,
    /// Frequency in thousandths of a hertz.
    pub milli_hz: u32,
}

impl FromStr for Ripple {
    type Err = Mistake;

    fn from_str(text: &str) -> Result<Self, Mistake> {
        let (percent, hz) = text.split_once('@').ok_or_else(|| {
            mistake!(
                "expected PERCENT@HZ, for example `10@5`",
                "应写成 PERCENT@HZ，例如 `10@5`"
            )
        })?;
        let milli_percent = decimal(percent.trim_end_matches('%'), 3)?;
        let milli_hz = decimal(hz, 3)?;
        if !(0..=90_000).contains(&milli_percent) {
            return Err(mistake!(
                "{percent} % is outside 0 to 90 %",
                "{percent} % 超出 0 至 90 %"
            ));
        }
        if !(10..=1_000_000).contains(&milli_hz) {
            return Err(mistake!(
                "{hz} Hz is outside 0.01 to 1000 Hz",
                "{hz} Hz 超出 0.01 至 1000 Hz"
            ));
        }
        // Both were checked above.
        Ok(Self {
            milli_percent: u32::try_from(milli_percent).unwrap_or_default(),
            milli_hz: u32::try_from(milli_hz).unwrap_or_default(),
        })
    }
}

/// A synchronism tolerance in picometres.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Tolerance {
    /// Millionths of a micrometre.
    pub pm: i64,
}

impl FromStr for Tolerance {
    type Err = Mistake;

    fn from_str(text: &str) -> Result<Self, Mistake> {
        let pm = decimal(text, 6)?;
        if pm < 0 {
            return Err(mistake!("a tolerance is not negative", "公差不能为负"));
        }
        Ok(Self { pm })
    }
}

impl Tolerance {
    /// True for an error above the tolerance.
    #[must_use]
    pub const fn is_below(self, error_nm: i64) -> bool {
        error_nm.saturating_mul(1000) > self.pm
    }
}

/// A whole percentage. The range of each override is checked elsewhere.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Percent(pub u16);

impl FromStr for Percent {
    type Err = Mistake;

    fn from_str(text: &str) -> Result<Self, Mistake> {
        match text.trim_end_matches('%').parse() {
            Ok(percent) => Ok(Self(percent)),
            Err(_) => Err(mistake!(
                "expected a whole number of percent, as `80`",
                "应为整数百分比，如 `80`"
            )),
        }
    }
}

/// A factor, in thousandths.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Factor(pub u32);

impl FromStr for Factor {
    type Err = Mistake;

    fn from_str(text: &str) -> Result<Self, Mistake> {
        let thousandths = decimal(text, 3)?;
        u32::try_from(thousandths).map(Self).map_err(|_| {
            mistake!(
                "`{text}` is no factor; `2` is twice as fast, `0.5` half as fast",
                "`{text}` 不是倍数；`2` 为两倍速，`0.5` 为半速"
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_factor_is_positive_and_has_three_decimals() {
        for (text, thousandths) in [("1", 1000), ("0.05", 50), ("2.5", 2500), ("0", 0)] {
            assert_eq!(text.parse(), Ok(Factor(thousandths)), "{text}");
        }
        for wrong in ["", "x", "-1", "0.0001", "9999999"] {
            assert!(wrong.parse::<Factor>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn decimals_are_exact() {
        assert_eq!(decimal("60.64", 6), Ok(60_640_000));
        assert_eq!(decimal("-.5", 6), Ok(-500_000));
        assert_eq!(decimal("7.", 3), Ok(7_000));
        assert_eq!(decimal("0", 3), Ok(0));
        assert_eq!(decimal("1.2000", 1), Ok(12));
        for wrong in [
            "",
            "-",
            ".",
            "1e3",
            "1.25x",
            "--1",
            "99999999999999999999",
            "1.23",
        ] {
            assert!(decimal(wrong, 1).is_err(), "{wrong}");
        }
    }

    #[test]
    fn at_takes_a_diameter() {
        assert_eq!(
            "X=100,Z=-50.5".parse::<At>().unwrap(),
            At {
                x_nm: 50_000_000,
                z_nm: -50_500_000,
                c_udeg: 0
            }
        );
        for wrong in ["100", "X=1,X=2", "Y=1", "X=0.000001", "X=9999999999"] {
            assert!(wrong.parse::<At>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_signal_has_a_name_and_a_level() {
        assert_eq!(
            "G61.2=1".parse::<SetSignal>(),
            Ok(SetSignal {
                signal: Signal::G61Dot2,
                level: true
            })
        );
        assert_eq!(
            "rgtap=0".parse::<SetSignal>(),
            Ok(SetSignal {
                signal: Signal::Rgtap,
                level: false
            })
        );
        for wrong in ["", "G61.2", "G61.2=2", "G61.2=", "=1", "G61.2=10"] {
            assert!(wrong.parse::<SetSignal>().is_err(), "{wrong}");
        }
        let told = "SWS5=1".parse::<SetSignal>().unwrap_err().to_string();
        for signal in Signal::ALL {
            assert!(told.contains(signal.name()), "{told}");
        }
    }

    #[test]
    fn ripple_and_tolerance_have_bounds() {
        assert_eq!(
            "10@5".parse::<Ripple>(),
            Ok(Ripple {
                milli_percent: 10_000,
                milli_hz: 5_000
            })
        );
        assert_eq!("1.3".parse::<Tolerance>(), Ok(Tolerance { pm: 1_300_000 }));
        for wrong in ["10", "91@5", "10@0", "-1@5"] {
            assert!(wrong.parse::<Ripple>().is_err(), "{wrong}");
        }
        assert!("-1".parse::<Tolerance>().is_err());
    }
}
