//! `mode`, `jog`, `handwheel`, `home` and `override`: what is typed to operate a machine by hand.

use std::str::FromStr;

use clap::{ArgGroup, Args, ValueEnum};
use leadscrew_core::bus::StepRequest;
use leadscrew_core::operating::{Led, OperatingMode, Towards, WheelFactor};
use leadscrew_core::units::Axis;

use crate::values::{Mistake, decimal, mistake};

/// A mode of the machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ModeName {
    /// Axes move while a key is held.
    Manual,
    /// Axes move in steps.
    Step,
    /// Axes follow the handwheel.
    Wheel,
    /// Reference.
    Reference,
    /// Single lines.
    Mdi,
    /// Programs.
    Automatic,
}

impl ModeName {
    /// The mode.
    #[must_use]
    pub const fn mode(self) -> OperatingMode {
        match self {
            Self::Manual => OperatingMode::Manual,
            Self::Step => OperatingMode::Step,
            Self::Wheel => OperatingMode::Wheel,
            Self::Reference => OperatingMode::Reference,
            Self::Mdi => OperatingMode::Mdi,
            Self::Automatic => OperatingMode::Automatic,
        }
    }
}

/// An axis and a direction: `X-`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AxisWay {
    /// Z, not X.
    pub on_z: bool,
    /// The direction.
    pub towards: Towards,
}

impl FromStr for AxisWay {
    type Err = Mistake;

    fn from_str(text: &str) -> Result<Self, Mistake> {
        let (on_z, towards) = match text {
            "X+" | "x+" => (false, Towards::Plus),
            "X-" | "x-" => (false, Towards::Minus),
            "Z+" | "z+" => (true, Towards::Plus),
            "Z-" | "z-" => (true, Towards::Minus),
            _ => {
                return Err(mistake!(
                    "expected an axis and a direction: `X+`, `X-`, `Z+` or `Z-`",
                    "应写轴与方向：`X+`、`X-`、`Z+` 或 `Z-`"
                ));
            }
        };
        Ok(Self { on_z, towards })
    }
}

/// What is moved by hand as long as it is held, and which way: an axis, or the spindle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HandWay {
    /// An axis.
    Axis(AxisWay),
    /// The spindle: plus as M03, minus as M04.
    Spindle(Towards),
}

impl HandWay {
    /// What a frame says of X or of Z.
    #[must_use]
    pub fn of_axis(self, on_z: bool) -> Option<Towards> {
        match self {
            Self::Axis(way) => (way.on_z == on_z).then_some(way.towards),
            Self::Spindle(_) => None,
        }
    }

    /// What a frame says of the spindle.
    #[must_use]
    pub const fn of_spindle(self) -> Option<Towards> {
        match self {
            Self::Axis(_) => None,
            Self::Spindle(towards) => Some(towards),
        }
    }
}

impl FromStr for HandWay {
    type Err = Mistake;

    fn from_str(text: &str) -> Result<Self, Mistake> {
        match text {
            "S+" | "s+" => return Ok(Self::Spindle(Towards::Plus)),
            "S-" | "s-" => return Ok(Self::Spindle(Towards::Minus)),
            _ => {}
        }
        text.parse().map(Self::Axis).map_err(|_: Mistake| {
            mistake!(
                "expected an axis and a direction, `X+`, `X-`, `Z+` or `Z-`, or the spindle, `S+` (as M03) or `S-` (as M04)",
                "应写轴与方向：`X+`、`X-`、`Z+` 或 `Z-`，或主轴：`S+`（同 M03）或 `S-`（同 M04）"
            )
        })
    }
}

/// A length in millimetres above zero, to the tenth of a micrometre: of Z, or of the diameter of X.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StepLength {
    /// In 0.1 µm.
    pub tenths: i64,
}

impl FromStr for StepLength {
    type Err = Mistake;

    fn from_str(text: &str) -> Result<Self, Mistake> {
        let tenths = decimal(text, 4)?;
        if tenths <= 0 {
            return Err(mistake!(
                "a step is longer than 0; its direction stands with the axis",
                "步距须大于 0；方向写在轴名之后"
            ));
        }
        Ok(Self { tenths })
    }
}

impl StepLength {
    /// The way of the slide in 0.1 µm.
    ///
    /// # Errors
    /// The slide cannot make it in one step: too long, or half of a tenth of a micrometre.
    pub fn of_slide(self, way: AxisWay) -> Result<i32, Mistake> {
        let slide = if way.on_z {
            self.tenths
        } else if self.tenths % 2 == 0 {
            self.tenths / 2
        } else {
            return Err(mistake!(
                "X is a diameter, and its slide moves by whole tenths of a micrometre: give an even last digit",
                "X 为直径值，滑板按 0.1 微米移动：末位须为偶数"
            ));
        };
        let signed = match way.towards {
            Towards::Plus => slide,
            Towards::Minus => -slide,
        };
        match i32::try_from(signed) {
            Ok(signed) if signed.abs() <= StepRequest::LONGEST => Ok(signed),
            _ => Err(mistake!(
                "the longest step is 838.8607 mm of the slide",
                "最大步距为滑板 838.8607 mm"
            )),
        }
    }
}

/// `jog`.
#[derive(Args, Debug)]
#[command(group = ArgGroup::new("how far").args(["by", "hold"]).required(true))]
pub struct Jog {
    /// Axis and direction: `X+`, `X-`, `Z+`, `Z-`; with `--hold` one of each axis, or the spindle: `S+` as M03, `S-` as M04
    #[arg(required = true, num_args = 1..=2, value_name = "AXIS")]
    pub ways: Vec<HandWay>,
    /// Go this far, in mm (X: of the diameter), and stop; at the speed of parameter 9041
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    pub by: Option<StepLength>,
    /// Go until Enter or Ctrl-C, or until this program is gone
    #[arg(long)]
    pub hold: bool,
    /// With `--hold`: speed of the slide in mm/min [default: parameter 9041]
    #[arg(long, value_name = "MM/MIN", value_parser = clap::value_parser!(u16).range(1..), conflicts_with = "rapid")]
    pub feed: Option<u16>,
    /// With `--hold`: at jog rapid (parameter 9042)
    #[arg(long)]
    pub rapid: bool,
    /// Of the spindle: its speed in rpm, on which the override acts [default: parameter 9049]
    #[arg(long, value_name = "RPM", value_parser = clap::value_parser!(u16).range(1..), conflicts_with_all = ["feed", "rapid", "by"])]
    pub speed: Option<u16>,
}

/// What a handwheel leads.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum WheelAxis {
    /// Cross slide.
    #[value(name = "X", alias = "x")]
    X,
    /// Carriage.
    #[value(name = "Z", alias = "z")]
    Z,
    /// The program under way along its path (`run --handwheel`).
    Path,
}

impl WheelAxis {
    /// The same for the board.
    #[must_use]
    pub const fn led(self) -> Led {
        match self {
            Self::X => Led::X,
            Self::Z => Led::Z,
            Self::Path => Led::Path,
        }
    }
}

/// How many increments a count is worth.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum FactorName {
    /// One.
    #[value(name = "x1", aliases = ["×1", "1"])]
    One,
    /// Ten.
    #[value(name = "x10", aliases = ["×10", "10"])]
    Ten,
    /// A hundred.
    #[value(name = "x100", aliases = ["×100", "100"])]
    Hundred,
}

impl FactorName {
    /// The same for the board.
    #[must_use]
    pub const fn factor(self) -> WheelFactor {
        match self {
            Self::One => WheelFactor::One,
            Self::Ten => WheelFactor::Ten,
            Self::Hundred => WheelFactor::Hundred,
        }
    }
}

/// `handwheel`.
#[derive(Args, Debug)]
pub struct Handwheel {
    /// What it leads: `X`, `Z`, or `path`, a program that follows it
    #[arg(value_enum, value_name = "AXIS")]
    pub axis: WheelAxis,
    /// How many increments a count is worth (path: micrometres)
    #[arg(value_enum, value_name = "FACTOR")]
    pub factor: FactorName,
    /// How far it is turned; below 0 towards minus
    #[arg(value_name = "COUNTS", allow_negative_numbers = true)]
    pub counts: i32,
    /// How fast it is turned, in counts a second
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u16).range(1..=20_000))]
    pub rate: u16,
}

/// The axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum HomeAxis {
    /// Cross slide.
    #[value(name = "X")]
    X,
    /// Carriage.
    #[value(name = "Z")]
    Z,
    /// Rotary axis.
    #[value(name = "C")]
    C,
}

impl HomeAxis {
    /// The axis.
    #[must_use]
    pub const fn axis(self) -> Axis {
        match self {
            Self::X => Axis::X,
            Self::Z => Axis::Z,
            Self::C => Axis::C,
        }
    }
}

/// The overrides.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum OverrideName {
    /// Feed.
    Feed,
    /// Rapid.
    Rapid,
    /// Spindle.
    Spindle,
}

impl OverrideName {
    /// The lowest and the highest percentage.
    #[must_use]
    pub const fn range(self) -> (u8, u8) {
        match self {
            Self::Feed => (0, 150),
            Self::Rapid => (0, 100),
            Self::Spindle => (50, 120),
        }
    }
}

/// What is tuned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tuned {
    /// The drive of an axis.
    Axis(AxisWay),
    /// The spindle.
    Spindle,
}

impl FromStr for Tuned {
    type Err = Mistake;

    fn from_str(text: &str) -> Result<Self, Mistake> {
        if text.eq_ignore_ascii_case("spindle") {
            return Ok(Self::Spindle);
        }
        text.parse().map(Self::Axis).map_err(|_: Mistake| {
            mistake!(
                "expected an axis and a direction, `X+`, `X-`, `Z+` or `Z-`, or `spindle`",
                "应写轴与方向：`X+`、`X-`、`Z+` 或 `Z-`，或写 `spindle`"
            )
        })
    }
}

/// Options of `tune`.
#[derive(Debug, Args)]
pub struct Tune {
    /// The axis, and the direction of its first stroke: `X+`, `X-`, `Z+` or `Z-`; each stroke goes back again. Or
    /// `spindle`
    #[arg(value_name = "WAY|spindle")]
    pub what: Tuned,
    /// Spindle: two to six speeds in turns a minute to which it runs up from rest; no multiples of each other tell most
    #[arg(long, value_name = "RPM,RPM,…", value_delimiter = ',', value_parser = clap::value_parser!(u16).range(10..=9999))]
    pub speeds: Vec<u16>,
    /// Spindle: its speed is looked at for so long, at each [default: 20]
    #[arg(long, value_name = "S", value_parser = clap::value_parser!(u16).range(5..=120))]
    pub seconds: Option<u16>,
    /// Time of buffer and interpolation in the drive; 9003 of the axis where it is not given
    #[arg(long, value_name = "US", value_parser = clap::value_parser!(u32).range(1..=20_000))]
    pub dead_time: Option<u32>,
    /// Feed-forward of the speed that the drive is set to, in per cent; 9071 of the axis where it is not given
    #[arg(long, value_name = "PERCENT", value_parser = clap::value_parser!(u32).range(0..=100))]
    pub feed_forward: Option<u32>,
    /// Age of 6064h at the SYNC that it is sent for, as its maker tells it; 9072 of the axis where it is not given
    #[arg(long, value_name = "US", value_parser = clap::value_parser!(u32).range(0..=20_000))]
    pub age: Option<u32>,
    /// How well that age is known, plus or minus; with `--write` it becomes 9075 of the axis. Another age than 9072 without
    /// it makes 9075 0: not known
    #[arg(long, value_name = "US", requires = "age", value_parser = clap::value_parser!(u32).range(1..=20_000))]
    pub age_within: Option<u32>,
    /// Write 9003, 9070, 9071 and 9072 of the axis, or 9004 of the spindle, 9010 where its speed varies more, and
    /// 9034 where its encoder learns a swing, as one transaction
    #[arg(long)]
    pub write: bool,
    /// Write the result: `.svg`, `.png`, `.html` or `.json`
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<std::path::PathBuf>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_of_x_is_of_the_diameter() {
        let way = |text: &str| text.parse::<AxisWay>().unwrap();
        let step = |text: &str| text.parse::<StepLength>().unwrap();
        assert_eq!(step("0.02").of_slide(way("X-")), Ok(-100));
        assert_eq!(step("25").of_slide(way("Z+")), Ok(250_000));
        assert_eq!(step("838.8607").of_slide(way("Z-")), Ok(-8_388_607));
        for (text, on) in [("0.0001", "X+"), ("838.8608", "Z+"), ("1677.7216", "X-")] {
            assert!(step(text).of_slide(way(on)).is_err(), "{text} {on}");
        }
        for text in ["0", "-1", "0.00001", "a"] {
            assert!(text.parse::<StepLength>().is_err(), "{text}");
        }
        assert!("C+".parse::<AxisWay>().is_err());
    }
}
