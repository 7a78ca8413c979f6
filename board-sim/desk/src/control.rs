//! The language of `leadscrew sim`: one JSON object a line in each direction, over a socket of its own.
//!
//! ```text
//! {"do":"door","to":"open"}          {"ok":true,"machine":{"name":"desk","power":true,…}}
//! {"do":"speed","thousandths":9}     {"ok":false,"error":{"en":"…","zh":"…"}}
//! ```
//!
//! Every request that is carried out is answered with the machine as it is then. A new verb is a variant of [`Request`] and
//! an arm in [`hand`](crate::hand); what a machine tells more is a field of [`View`]. It must not know how a request is
//! carried out.

use std::io::{BufRead as _, BufReader, ErrorKind, Write as _};
use std::time::Duration;

use clap::ValueEnum;
use leadscrew_can::{CanError, MachineName, Port, connect};
use leadscrew_common::words::Both;
use serde::{Deserialize, Serialize};

/// The longest wait for an answer: the computer may have stood still.
const ANSWER: Duration = Duration::from_secs(10);

/// The longest line.
pub(crate) const LONGEST: usize = 1 << 16;

/// What is to be done with a machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(tag = "do", rename_all = "snake_case")]
pub enum Request {
    /// Opens or closes the door.
    Door {
        /// How it is then.
        to: Door,
    },
    /// Presses or releases the emergency stop.
    Estop {
        /// How it is then.
        to: Contact,
    },
    /// Presses or releases the contact of feed hold.
    Hold {
        /// How it is then.
        to: Contact,
    },
    /// Sets an input of the board, or lets the simulated devices have it again.
    Input {
        /// Its number, from 1 on.
        number: u8,
        /// How it is then.
        to: Level,
    },
    /// Turns the handwheel at the board's own input.
    Wheel {
        /// By so many detents.
        counts: i32,
    },
    /// Spoils the turret, or mends it.
    Turret {
        /// How it is then.
        to: Turret,
    },
    /// Spoils the block of inputs and outputs on the bus, or mends it.
    Block {
        /// How it is then.
        to: Block,
    },
    /// Spoils a drive, or mends it.
    Drive {
        /// Which one.
        which: Drive,
        /// How it is then.
        to: DriveFault,
    },
    /// The spindle turns at another speed than it is told.
    Spindle {
        /// In hundredths of what it is told: 100 is as it is told.
        percent: i16,
    },
    /// Spoils the spindle's encoder, or mends it.
    Encoder {
        /// How it is then.
        to: Encoder,
    },
    /// Spoils the wire between the board, its drives and all others, or mends it.
    Bus {
        /// How it is then.
        to: Bus,
    },
    /// Spoils the board's flash, or mends it.
    Flash {
        /// How it is then.
        to: Flash,
    },
    /// Takes the power of board and drives, or gives it.
    Power {
        /// What happens to it.
        to: Power,
    },
    /// Machine time against real time.
    Speed {
        /// In thousandths.
        thousandths: u32,
    },
    /// Nothing: only tells how the machine is.
    State,
    /// Ends the machine.
    Down,
}

/// A door.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ValueEnum)]
#[serde(rename_all = "snake_case")]
pub enum Door {
    /// It is opened.
    Open,
    /// It is closed.
    #[default]
    Close,
}

/// A contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ValueEnum)]
#[serde(rename_all = "snake_case")]
pub enum Contact {
    /// It is pressed, and stays so.
    Press,
    /// It is released.
    Release,
}

/// An input.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ValueEnum)]
#[serde(rename_all = "snake_case")]
pub enum Level {
    /// It is on, and stays so.
    On,
    /// It is off, and stays so.
    Off,
    /// The simulated devices have it.
    Auto,
}

/// A turret.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ValueEnum)]
#[serde(rename_all = "snake_case")]
pub enum Turret {
    /// Nothing is wrong with it.
    Well,
    /// It does not turn.
    Stuck,
    /// It goes on to the next station before it is clamped.
    Slips,
    /// It never says that it is clamped.
    Loose,
}

/// A block of inputs and outputs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ValueEnum)]
#[serde(rename_all = "snake_case")]
pub enum Block {
    /// Nothing is wrong with it.
    #[default]
    Well,
    /// It has no power.
    Off,
    /// Its wire is cut.
    Silent,
    /// It sends heartbeats and no inputs.
    Mute,
    /// Its supply drops for a moment, once.
    Restart,
    /// Somebody stops it on the network, once.
    Stopped,
}

/// A drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ValueEnum)]
#[serde(rename_all = "lowercase")]
#[value(rename_all = "UPPER")]
pub enum Drive {
    /// Of X.
    X,
    /// Of Z.
    Z,
    /// Of C.
    C,
    /// Of the spindle.
    S,
}

impl Drive {
    /// All of them, in the order of their numbers.
    pub const ALL: [Self; 4] = [Self::X, Self::Z, Self::C, Self::S];
}

/// What is wrong with a drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum DriveFault {
    /// Nothing.
    Well,
    /// It moves as it is told, and sends nothing.
    Silent,
    /// Its cable is out.
    Unplugged,
    /// It does not move, whatever it is told.
    Blocked,
    /// It is in fault, and stays so.
    Fault,
    /// Safe torque off.
    TorqueOff,
    /// Its own supply has dropped: it starts again, once.
    Restart,
    /// Homing does not find its mark.
    NoMark,
    /// Homing ends with an error.
    HomingError,
    /// It stays in the mode that it has.
    KeepsMode,
    /// It does not finish starting.
    Starting,
    /// It is held in quick stop.
    QuickStop,
    /// Its motor has no power: it does not switch on.
    NoPower,
    /// Its enable input is open.
    NotEnabled,
}

/// An encoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Encoder {
    /// Nothing is wrong with it.
    Well,
    /// The wire of its index is broken.
    NoIndex,
    /// It counts 40 more, once.
    Slip,
}

/// A wire.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Bus {
    /// Nothing is wrong with it.
    Well,
    /// The board's cable is out.
    Unplugged,
    /// So bad that the board's controller goes bus-off.
    Off,
    /// So bad that the board's controller is error passive.
    Passive,
    /// Setpoints come after their SYNC.
    Late,
    /// Another node sends SYNC, too.
    SecondSync,
    /// Another node moves the drive of X.
    SecondMaster,
    /// Another node stops the drive of X by NMT, once.
    StopsDrive,
    /// Another node stops the board by NMT, once.
    StopsBoard,
    /// Another node has the board's number.
    Namesake,
}

/// A flash.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Flash {
    /// Nothing is wrong with it.
    Well,
    /// It takes nothing any more, and keeps what it has.
    Worn,
    /// The journal of a tap goes bad, once; the board sees it when its power comes.
    BadJournal,
    /// The newest parameter set goes bad, once.
    BadSet,
    /// All parameter sets go bad, once.
    BadSets,
    /// The newest parameter set becomes one of a board of another release, once.
    ForeignSet,
    /// The newest table of offsets and tools goes bad, once.
    BadTable,
}

/// The power of board and drives.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ValueEnum)]
#[serde(rename_all = "snake_case")]
pub enum Power {
    /// It goes.
    Off,
    /// It comes.
    On,
    /// It goes and comes.
    Cycle,
}

/// Words in both languages.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Text {
    /// English.
    pub en: String,
    /// Chinese.
    pub zh: String,
}

impl From<Both> for Text {
    fn from(words: Both) -> Self {
        Self {
            en: words.en,
            zh: words.zh,
        }
    }
}

impl From<Text> for Both {
    fn from(text: Text) -> Self {
        Self {
            en: text.en,
            zh: text.zh,
        }
    }
}

/// A machine as it is.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct View {
    /// Its name.
    pub name: String,
    /// Its process.
    pub pid: u32,
    /// The board's node number.
    pub node: u8,
    /// Board and drives have power.
    pub power: bool,
    /// The door.
    pub door: Door,
    /// The emergency stop is pressed.
    pub estop: bool,
    /// The contact of feed hold is pressed.
    pub hold: bool,
    /// The board's inputs that are on, from 1 on.
    pub inputs: Vec<u8>,
    /// Its outputs that are on.
    pub outputs: Vec<u8>,
    /// Machine time in thousandths of real time.
    pub speed: u32,
    /// The length of a tick.
    pub tick_us: u32,
    /// Ticks since the machine was started.
    pub ticks: u64,
    /// How often machine time has slipped.
    pub slips: u64,
    /// Ticks that slipped in all.
    pub lost_ticks: u64,
    /// Clients on the bus.
    pub clients: u32,
    /// Clients that were dropped because they did not read.
    pub dropped: u32,
    /// The board's parameters are others than those that drives and spindle were made with.
    pub outdated: bool,
}

/// An answer.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Answer {
    /// The request was carried out.
    pub ok: bool,
    /// Why it was not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error: Option<Text>,
    /// What the user should know about it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub note: Option<Text>,
    /// The machine then.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub machine: Option<View>,
}

impl Answer {
    pub(crate) fn refused(why: Both) -> Self {
        Self {
            ok: false,
            error: Some(why.into()),
            note: None,
            machine: None,
        }
    }
}

/// Asks a machine, and waits for its answer.
///
/// # Errors
/// The machine does not run, or its answer cannot be read.
pub fn ask(name: &MachineName, request: &Request) -> Result<Answer, CanError> {
    let failed = |error: std::io::Error| match error.kind() {
        ErrorKind::WouldBlock | ErrorKind::TimedOut => CanError::Stuck {
            name: format!("sim:{name}"),
        },
        _ => CanError::System {
            name: format!("sim:{name}"),
            doing: "talk to",
            error,
        },
    };
    let mut line = connect(name, Port::Control)?;
    line.set_read_timeout(Some(ANSWER)).map_err(failed)?;
    line.set_write_timeout(Some(ANSWER)).map_err(failed)?;
    let mut text = serde_json::to_vec(request).map_err(|error| failed(error.into()))?;
    text.push(b'\n');
    line.write_all(&text).map_err(failed)?;
    let mut answer = String::new();
    let read = BufReader::new(line)
        .read_line(&mut answer)
        .map_err(failed)?;
    if read == 0 {
        return Err(CanError::Closed {
            name: format!("sim:{name}"),
        });
    }
    serde_json::from_str(&answer).map_err(|error| failed(error.into()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_request_is_a_short_line_that_a_person_can_write() {
        for (request, text) in [
            (
                Request::Door { to: Door::Open },
                r#"{"do":"door","to":"open"}"#,
            ),
            (
                Request::Estop { to: Contact::Press },
                r#"{"do":"estop","to":"press"}"#,
            ),
            (
                Request::Hold {
                    to: Contact::Release,
                },
                r#"{"do":"hold","to":"release"}"#,
            ),
            (
                Request::Input {
                    number: 3,
                    to: Level::Auto,
                },
                r#"{"do":"input","number":3,"to":"auto"}"#,
            ),
            (
                Request::Power { to: Power::Cycle },
                r#"{"do":"power","to":"cycle"}"#,
            ),
            (
                Request::Speed { thousandths: 500 },
                r#"{"do":"speed","thousandths":500}"#,
            ),
            (
                Request::Drive {
                    which: Drive::X,
                    to: DriveFault::TorqueOff,
                },
                r#"{"do":"drive","which":"x","to":"torque-off"}"#,
            ),
            (
                Request::Spindle { percent: -50 },
                r#"{"do":"spindle","percent":-50}"#,
            ),
            (
                Request::Encoder {
                    to: Encoder::NoIndex,
                },
                r#"{"do":"encoder","to":"no-index"}"#,
            ),
            (
                Request::Bus {
                    to: Bus::SecondSync,
                },
                r#"{"do":"bus","to":"second-sync"}"#,
            ),
            (
                Request::Flash { to: Flash::Worn },
                r#"{"do":"flash","to":"worn"}"#,
            ),
            (Request::State, r#"{"do":"state"}"#),
            (Request::Down, r#"{"do":"down"}"#),
        ] {
            assert_eq!(serde_json::to_string(&request).unwrap(), text);
            assert_eq!(serde_json::from_str::<Request>(text).unwrap(), request);
        }
        for wrong in [
            r#"{"do":"fly"}"#,
            r#"{"do":"door"}"#,
            r#"{"do":"door","to":"ajar"}"#,
            "x",
        ] {
            assert!(serde_json::from_str::<Request>(wrong).is_err(), "{wrong}");
        }
    }
}
