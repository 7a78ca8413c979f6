//! Values on the command line that have a form of their own. Exact: decimals are read as integers, never as floats.

use std::str::FromStr;

use leadscrew_core::signals::Signal;

/// Reads a decimal as an integer with `decimals` digits after the point; refuses more digits than that.
fn decimal(text: &str, decimals: usize) -> Result<i64, String> {
    let (negative, digits) = match text.strip_prefix('-') {
        Some(rest) => (true, rest),
        None => (false, text.strip_prefix('+').unwrap_or(text)),
    };
    let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
    let fraction = fraction.trim_end_matches('0');
    if whole.is_empty() && fraction.is_empty() && !digits.contains('0') {
        return Err(format!("`{text}` is not a number"));
    }
    if fraction.len() > decimals {
        return Err(format!("`{text}` has more than {decimals} decimals"));
    }
    let mut value: i64 = 0;
    let padding = std::iter::repeat_n(b'0', decimals - fraction.len());
    for byte in whole.bytes().chain(fraction.bytes()).chain(padding) {
        if !byte.is_ascii_digit() {
            return Err(format!("`{text}` is not a number"));
        }
        value = value
            .checked_mul(10)
            .and_then(|v| v.checked_add(i64::from(byte - b'0')))
            .ok_or_else(|| format!("`{text}` is too large"))?;
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
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut at = Self::default();
        let mut seen = Vec::new();
        for part in text.split(',') {
            let (axis, value) = part.split_once('=').ok_or_else(|| {
                format!("`{part}`: expected `X=100,Z=50` (X is a diameter, in mm)")
            })?;
            let axis = axis.trim().to_ascii_uppercase();
            let value = decimal(value.trim(), 6)?;
            if value.abs() > 1 << 42 {
                return Err(format!("`{part}` is outside of any machine"));
            }
            match axis.as_str() {
                // A diameter in nanometres is twice the radius; an odd one has no radius.
                "X" if value % 2 != 0 => {
                    return Err(format!("`{part}`: half of it is no whole nanometre"));
                }
                "X" => at.x_nm = value / 2,
                "Z" => at.z_nm = value,
                "C" => at.c_udeg = value,
                _ => return Err(format!("there is no axis `{axis}`: X, Z and C are")),
            }
            if seen.contains(&axis) {
                return Err(format!("`{axis}` stands there twice"));
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
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, level) = match text.split_once('=') {
            Some((name, "0")) => (name, false),
            Some((name, "1")) => (name, true),
            _ => return Err("expected `NAME=0` or `NAME=1`".into()),
        };
        match Signal::find(name) {
            Some(signal) => Ok(Self { signal, level }),
            None => Err(format!(
                "there is no signal `{name}`; there are {}",
                Signal::ALL.map(Signal::name).join(", ")
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
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (percent, hz) = text
            .split_once('@')
            .ok_or("expected PERCENT@HZ, for example `10@5`")?;
        let milli_percent = decimal(percent.trim_end_matches('%'), 3)?;
        let milli_hz = decimal(hz, 3)?;
        if !(0..=90_000).contains(&milli_percent) {
            return Err(format!("{percent} % is outside 0 to 90 %"));
        }
        if !(10..=1_000_000).contains(&milli_hz) {
            return Err(format!("{hz} Hz is outside 0.01 to 1000 Hz"));
        }
        Ok(Self {
            milli_percent: u32::try_from(milli_percent).map_err(|e| e.to_string())?,
            milli_hz: u32::try_from(milli_hz).map_err(|e| e.to_string())?,
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
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let pm = decimal(text, 6)?;
        if pm < 0 {
            return Err("a tolerance is not negative".into());
        }
        Ok(Self { pm })
    }
}

/// A whole percentage; how far each override goes is not known here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Percent(pub u16);

impl FromStr for Percent {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.trim_end_matches('%').parse() {
            Ok(percent) => Ok(Self(percent)),
            Err(_) => Err("expected a whole number of percent, as `80`".into()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let told = "SWS5=1".parse::<SetSignal>().unwrap_err();
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
