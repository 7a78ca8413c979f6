//! The faults of the wire and of the storage, as options of the command line.

use std::str::FromStr;

use leadscrew_board_sim::line::{self, Faults, Intruder, Noise, Way};
use leadscrew_board_sim::plant::{Order, Tear};
use leadscrew_core::board::DriveNodes;
use leadscrew_core::bus::NodeId;
use leadscrew_core::call::TapSpindle;
use leadscrew_core::units::Axis;

/// A span of ticks on the command line: `4000` (from there on), `4000..4500`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ticks(pub line::Span);

impl FromStr for Ticks {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let tick = |text: &str| text.parse::<u64>().ok();
        let span = match text.split_once("..") {
            None => tick(text).map(|from| (from, u64::MAX)),
            Some((from, to)) => tick(from).zip(tick(to)),
        };
        match span {
            Some((from, to)) if from < to => Ok(Self(line::Span { from, to })),
            _ => Err(format!(
                "`{text}`: expected ticks, as `4000` or `4000..4500`"
            )),
        }
    }
}

/// The part of the frames of one direction that a fault hits, in thousandths.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Chance {
    /// `None`: every direction.
    way: Option<Way>,
    per_mille: u16,
}

impl FromStr for Chance {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (way, number) = text.split_once('=').unwrap_or(("in", text));
        let way = match way {
            "in" => Some(Way::In),
            "out" => Some(Way::Out),
            "setpoints" => Some(Way::Setpoints),
            "statuses" => Some(Way::Statuses),
            "all" => None,
            _ => {
                return Err(format!(
                    "`{way}`: expected in, out, setpoints, statuses or all"
                ));
            }
        };
        match number.parse() {
            Ok(per_mille @ 0..=1000) => Ok(Self { way, per_mille }),
            _ => Err("expected a whole number of thousandths, 0 to 1000".into()),
        }
    }
}

/// A second master, and the ticks of its presence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Second(pub Deed, pub line::Span);

/// The action of a second master, before the nodes of the drives are known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Deed {
    /// See [`Intruder::Sync`].
    Sync,
    /// See [`Intruder::Setpoint`].
    Setpoint(Whose),
    /// See [`Intruder::Stop`].
    Stop(Whose),
}

/// The drive that a second master addresses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Whose {
    /// The drive of an axis.
    Axis(Axis),
    /// The drive of spindle 1.
    Spindle,
}

impl Deed {
    fn among(self, drives: &DriveNodes) -> Intruder {
        match self {
            Self::Sync => Intruder::Sync,
            Self::Setpoint(whose) => Intruder::Setpoint(whose.among(drives)),
            Self::Stop(whose) => Intruder::Stop(whose.among(drives)),
        }
    }
}

impl Whose {
    fn among(self, drives: &DriveNodes) -> NodeId {
        match self {
            Self::Axis(axis) => drives.axis(axis),
            Self::Spindle => drives.spindle(TapSpindle::First),
        }
    }
}

impl FromStr for Second {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong =
            || format!("`{text}`: expected `sync@4000`, `setpoint:X@4000` or `stop:Z@4000`");
        let (what, ticks) = text.rsplit_once('@').ok_or_else(wrong)?;
        let Ticks(span) = ticks.parse()?;
        let deed = match what.split_once(':') {
            None if what == "sync" => Deed::Sync,
            Some(("setpoint", name)) => Deed::Setpoint(drive(name).ok_or_else(wrong)?),
            Some(("stop", name)) => Deed::Stop(drive(name).ok_or_else(wrong)?),
            _ => return Err(wrong()),
        };
        Ok(Self(deed, span))
    }
}

fn drive(name: &str) -> Option<Whose> {
    match name {
        "X" | "x" => Some(Whose::Axis(Axis::X)),
        "Z" | "z" => Some(Whose::Axis(Axis::Z)),
        "C" | "c" => Some(Whose::Axis(Axis::C)),
        "S" | "s" => Some(Whose::Spindle),
        _ => None,
    }
}

/// The place where a write is cut, and how the torn word reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Torn {
    /// Bytes that are still written.
    pub bytes: u32,
    /// How the torn word reads.
    pub tear: Tear,
}

impl FromStr for Torn {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (bytes, unreadable) = match text.strip_suffix(":half") {
            Some(bytes) => (bytes, false),
            None => (text, true),
        };
        let bytes = bytes.parse().map_err(|_| {
            format!("`{text}`: expected a number of bytes, as `1000` or `1000:half`")
        })?;
        let tear = Tear {
            unreadable,
            order: Order::Rising,
        };
        Ok(Self { bytes, tear })
    }
}

/// The options.
#[derive(clap::Args, Debug, Default)]
#[command(next_help_heading = "Faults of the wire and of the storage")]
pub struct Options {
    /// Frames that are lost, in thousandths (repeatable): in (default; from others
    /// to the board), out, setpoints, statuses, all
    #[arg(long, value_name = "[WAY=]PER_MILLE")]
    pub lose: Vec<Chance>,
    /// Frames that come twice
    #[arg(long, value_name = "[WAY=]PER_MILLE")]
    pub double: Vec<Chance>,
    /// Frames that come after the next one
    #[arg(long, value_name = "[WAY=]PER_MILLE")]
    pub swap: Vec<Chance>,
    /// The board's cable is out
    #[arg(long, value_name = "TICK[..TICK]")]
    pub cable_out: Option<Ticks>,
    /// The board's controller is bus-off; it comes back after the end, once the board lets it
    #[arg(long, value_name = "TICK[..TICK]")]
    pub bus_off: Option<Ticks>,
    /// The board's controller is error passive
    #[arg(long, value_name = "TICK[..TICK]")]
    pub error_passive: Option<Ticks>,
    /// Setpoints leave the board after the SYNC that was to latch them
    #[arg(long, value_name = "TICK[..TICK]")]
    pub late: Option<Ticks>,
    /// A second master: sync, setpoint:DRIVE or stop:DRIVE (NMT), with X, Z, C or S
    #[arg(long, value_name = "WHAT@TICK[..TICK]")]
    pub second_master: Option<Second>,
    /// The flash refuses everything after so many writes
    #[arg(long, value_name = "WRITES")]
    pub flash_fails: Option<u32>,
    /// The flash is worn: it refuses to erase after so many pages
    #[arg(long, value_name = "PAGES")]
    pub flash_worn: Option<u32>,
    /// The board's power goes in a write of its flash, after so many more bytes, and is back a tenth of a second of its
    /// time later; the torn word cannot be read, or reads half written
    #[arg(long, value_name = "BYTES[:half]", conflicts_with = "cut_power")]
    pub torn_write: Option<Torn>,
    /// The board loses its power, its drives do not; without an end board-sim ends there, with exit code 4
    #[arg(long, value_name = "TICK[..TICK]")]
    pub cut_power: Option<Ticks>,
}

impl Options {
    /// The faults of the wire, for a machine with these drives.
    pub fn faults(&self, seed: u64, drives: &DriveNodes) -> Faults {
        let mut faults = Faults {
            seed,
            cable_out: self.cable_out.map(|ticks| ticks.0),
            bus_off: self.bus_off.map(|ticks| ticks.0),
            error_passive: self.error_passive.map(|ticks| ticks.0),
            late: self.late.map(|ticks| ticks.0),
            intruder: self
                .second_master
                .map(|Second(deed, span)| (deed.among(drives), span)),
            ..Faults::NONE
        };
        let mut put = |chances: &[Chance], set: fn(&mut Noise, u16)| {
            for chance in chances {
                for way in Way::ALL {
                    if chance.way.is_none_or(|only| only == way) {
                        set(faults.noise_mut(way), chance.per_mille);
                    }
                }
            }
        };
        put(&self.lose, |noise, chance| noise.lose = chance);
        put(&self.double, |noise, chance| noise.double = chance);
        put(&self.swap, |noise, chance| noise.swap = chance);
        faults
    }
}

#[cfg(test)]
mod tests {
    use leadscrew_core::params::{Entry, Params};

    use super::*;

    #[test]
    fn a_torn_word_is_unreadable_unless_said_otherwise() {
        let torn = |bytes, unreadable| {
            let tear = Tear {
                unreadable,
                order: Order::Rising,
            };
            Ok(Torn { bytes, tear })
        };
        assert_eq!("1000".parse(), torn(1000, true));
        assert_eq!("7:half".parse(), torn(7, false));
        for wrong in ["", ":half", "7:whole", "-1", "x"] {
            assert!(wrong.parse::<Torn>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn ticks_have_a_beginning_and_may_have_an_end() {
        let span = |from, to| Ok(Ticks(line::Span { from, to }));
        assert_eq!("40".parse(), span(40, u64::MAX));
        assert_eq!("40..50".parse(), span(40, 50));
        for wrong in ["", "40..", "..50", "50..40", "50..50", "x"] {
            assert!(wrong.parse::<Ticks>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn chances_name_a_way_or_mean_what_comes_in() {
        let options = Options {
            lose: vec!["5".parse().unwrap(), "statuses=7".parse().unwrap()],
            double: vec!["all=3".parse().unwrap()],
            ..Options::default()
        };
        let noise = |lose, double| Noise {
            lose,
            double,
            swap: 0,
        };
        // Setpoints, statuses, in, out.
        let expected = [noise(0, 3), noise(7, 3), noise(5, 3), noise(0, 3)];
        let drives = DriveNodes::of(&Params::slant_bed());
        assert_eq!(options.faults(9, &drives).noise, expected);
        assert_eq!(Options::default().faults(1, &drives), Faults::NONE);
        for wrong in ["1001", "up=3", "in=", "in=-1"] {
            assert!(wrong.parse::<Chance>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_second_master_says_what_it_does_and_when() {
        let from = |from| line::Span { from, to: u64::MAX };
        assert_eq!("sync@9".parse(), Ok(Second(Deed::Sync, from(9))));
        let stop = Second(Deed::Stop(Whose::Axis(Axis::Z)), from(7));
        assert_eq!("stop:Z@7".parse(), Ok(stop));
        let mut params = Params::slant_bed();
        let entry = Entry::find_text("drive_node.Z").unwrap();
        params.set(entry, 70).unwrap();
        let drives = DriveNodes::of(&params);
        let options = Options {
            second_master: Some(stop),
            ..Options::default()
        };
        let expected = Intruder::Stop(NodeId::new(70).unwrap());
        assert_eq!(
            options.faults(1, &drives).intruder,
            Some((expected, from(7)))
        );
        for wrong in ["sync", "stop@3", "setpoint:Y@3", "sync:X@3", "sync@"] {
            assert!(wrong.parse::<Second>().is_err(), "{wrong}");
        }
    }
}
