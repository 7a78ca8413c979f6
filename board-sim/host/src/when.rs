//! Faults of the plant, each with its tick. Ticks count, as in `simulate`, from the tick at which the machine is up.

use std::str::FromStr;

use leadscrew_board_sim::plant::{self, Plant};
use leadscrew_core::units::Axis;

/// Splits `WHAT@TICK`.
fn at(text: &str) -> Result<(&str, u64), String> {
    text.rsplit_once('@')
        .and_then(|(what, tick)| Some((what, tick.parse().ok()?)))
        .ok_or_else(|| format!("`{text}`: expected a tick at the end, as `…@4000`"))
}

/// A fault of a drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Trouble {
    /// The axis; `None` for the spindle.
    axis: Option<Axis>,
    what: What,
    tick: u64,
}

/// The kind of fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum What {
    /// The drive is in this state from then on.
    Trouble(plant::Trouble),
    /// The drive loses its power for a moment, and restarts at its position.
    Restart,
}

impl FromStr for Trouble {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (which, tick) = at(text)?;
        let (name, what) = which
            .split_once('=')
            .ok_or_else(|| format!("`{text}`: expected `X=silent@4000`"))?;
        let axis = match name.to_ascii_uppercase().as_str() {
            "X" => Some(Axis::X),
            "Z" => Some(Axis::Z),
            "C" => Some(Axis::C),
            "S" => None,
            _ => return Err(format!("there is no drive `{name}`: X, Z, C and S are")),
        };
        let what = match what {
            "none" => What::Trouble(plant::Trouble::None),
            "silent" => What::Trouble(plant::Trouble::Silent),
            "cut-off" => What::Trouble(plant::Trouble::CutOff),
            "stuck" => What::Trouble(plant::Trouble::Stuck),
            "torque-off" => What::Trouble(plant::Trouble::TorqueOff),
            "restart" => What::Restart,
            _ => match what
                .strip_prefix("fault:")
                .map(|code| u16::from_str_radix(code, 16))
            {
                Some(Ok(code)) => What::Trouble(plant::Trouble::Fault(code)),
                _ => {
                    return Err(format!(
                        "`{what}`: expected silent, cut-off, stuck, torque-off, restart, none, or fault: and an emergency code, \
                         as `fault:7305`"
                    ));
                }
            },
        };
        Ok(Self { axis, what, tick })
    }
}

/// Counts that the encoder loses or gains.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Slip {
    counts: i32,
    tick: u64,
}

impl FromStr for Slip {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (counts, tick) = at(text)?;
        let counts = counts
            .parse()
            .map_err(|_| format!("`{counts}` is no number of counts"))?;
        Ok(Self { counts, tick })
    }
}

/// The spindle is dragged to another speed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Disturbance {
    percent: i16,
    tick: u64,
}

impl FromStr for Disturbance {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (percent, tick) = at(text)?;
        let percent = percent
            .trim_end_matches('%')
            .parse()
            .map_err(|_| format!("`{percent}` is no whole percentage"))?;
        Ok(Self { percent, tick })
    }
}

/// All faults of the plant.
#[derive(Clone, Debug, Default)]
pub struct Script {
    /// Faults of drives.
    pub troubles: Vec<Trouble>,
    /// Slips of the encoder.
    pub slips: Vec<Slip>,
    /// The tick at which the index is lost.
    pub lost_index: Option<u64>,
    /// Disturbances of the spindle.
    pub drags: Vec<Disturbance>,
}

impl Script {
    /// Applies the faults of this tick.
    pub fn act(&self, tick: u64, plant: &mut Plant) {
        for trouble in self.troubles.iter().filter(|one| one.tick == tick) {
            let drive = match trouble.axis {
                Some(axis) => plant.drive(axis),
                None => plant.spindle_drive(),
            };
            match trouble.what {
                What::Trouble(what) => drive.trouble(what),
                What::Restart => drive.restart(),
            }
        }
        for slip in self.slips.iter().filter(|one| one.tick == tick) {
            plant.encoder().slip(slip.counts);
        }
        for drag in self.drags.iter().filter(|one| one.tick == tick) {
            plant.spindle().disturb(drag.percent);
        }
        if self.lost_index == Some(tick) {
            plant.encoder().break_index(true);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn troubles_name_drive_kind_and_tick() {
        assert_eq!(
            "x=fault:7305@4000".parse(),
            Ok(Trouble {
                axis: Some(Axis::X),
                what: What::Trouble(plant::Trouble::Fault(0x7305)),
                tick: 4000
            })
        );
        assert_eq!(
            "Z=restart@9".parse::<Trouble>().map(|trouble| trouble.what),
            Ok(What::Restart)
        );
        assert_eq!(
            "S=silent@0".parse::<Trouble>().map(|trouble| trouble.axis),
            Ok(None)
        );
        for wrong in ["X=silent", "Y=silent@1", "X=broken@1", "X=fault:@1", "X@1"] {
            assert!(wrong.parse::<Trouble>().is_err(), "{wrong}");
        }
        assert_eq!(
            "-4@10".parse(),
            Ok(Slip {
                counts: -4,
                tick: 10
            })
        );
        assert_eq!(
            "-20%@10".parse(),
            Ok(Disturbance {
                percent: -20,
                tick: 10
            })
        );
    }
}
