//! The set of parameters that a machine has in force, as one message that the broker retains: for those who come later.
//!
//! ```text
//! leadscrew/v1/GROUP/NODE/MACHINE/set   {"serial":"0000a01f","firmware":"0.1.0","parameters":"1a2b3c4d","schema":2,
//!                                        "since":1764150000123,"after":null,"seen":1764150900000,
//!                                        "values":{"rapid_rate.X":"11000 mm/min"}}
//! ```
//!
//! It is a state and no record: the newest counts, and nothing of it is kept here. What a value means is not known here.
//! Whoever hears such a topic hears what anybody has put there, so nothing is taken that is not of this form.

use std::collections::BTreeMap;
use std::fmt;

use serde::{Deserialize, Serialize};

use crate::record::Moment;

/// The beginning of all topics, and their end.
const ROOT: &str = "leadscrew/v1";
const SET: &str = "set";
/// Digits of a number in a message.
const DIGITS: usize = 8;
/// The longest name of a firmware, in bytes.
const FIRMWARE: usize = 64;
/// The end of the year 9999, in milliseconds: no time is later.
const LAST: u64 = 253_402_300_799_999;

/// Where the set of a machine stands.
#[must_use]
pub fn topic(group: &str, node: &str, machine: &str) -> String {
    format!("{ROOT}/{group}/{node}/{machine}/{SET}")
}

/// Where those of all machines of a group stand.
#[must_use]
pub fn topics(group: &str) -> String {
    topic(group, "+", "+")
}

/// Whose a set is. Machines stand in the order of their names.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Whose {
    /// The machine.
    pub machine: String,
    /// The agent that reads it.
    pub node: String,
}

impl Whose {
    /// Whose the set at a topic is; `None` for a topic of no set, or one with control characters, which no agent has.
    #[must_use]
    pub fn of(topic: &str) -> Option<Self> {
        let rest = topic.strip_prefix(ROOT)?.strip_prefix('/')?;
        let parts: Vec<&str> = rest.split('/').collect();
        let [group, node, machine, SET] = parts[..] else {
            return None;
        };
        let is_name = |name: &str| !name.is_empty() && !name.contains(char::is_control);
        let are_names = [group, node, machine].into_iter().all(is_name);
        are_names.then(|| Self {
            machine: machine.to_owned(),
            node: node.to_owned(),
        })
    }
}

/// A set in force.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Set {
    /// Serial number of the board.
    pub serial: u32,
    /// Its firmware.
    pub firmware: String,
    /// Checksum of its parameters.
    pub parameters: u32,
    /// Version of the table that they are of.
    pub schema: u32,
    /// In force since then at the latest.
    pub since: Moment,
    /// Others were in force then; `None`: none were ever seen.
    pub after: Option<Moment>,
    /// When the agent read their checksum last.
    pub seen: Moment,
    /// What is not the built-in machine's, by the names of a machine file; `None` where the agent does not know the table.
    pub values: Option<BTreeMap<String, String>>,
}

/// A set as it stands in the message.
#[derive(Serialize, Deserialize)]
struct Written {
    serial: String,
    firmware: String,
    parameters: String,
    schema: u32,
    since: u64,
    after: Option<u64>,
    seen: u64,
    values: Option<BTreeMap<String, String>>,
}

/// Why a message is no set.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NoSet {
    /// It is not of this form; where that is seen.
    Form {
        /// The line.
        line: usize,
        /// The column.
        column: usize,
    },
    /// A field says what it cannot say.
    Field(&'static str),
}

impl fmt::Display for NoSet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Form { line, column } => {
                write!(f, "not the JSON of a set, at line {line}, column {column}")
            }
            Self::Field(name) => write!(f, "`{name}` cannot be so"),
        }
    }
}

impl std::error::Error for NoSet {}

impl Set {
    /// The message.
    #[must_use]
    pub fn written(&self) -> Vec<u8> {
        let written = Written {
            serial: format!("{:08x}", self.serial),
            firmware: self.firmware.clone(),
            parameters: format!("{:08x}", self.parameters),
            schema: self.schema,
            since: self.since.0,
            after: self.after.map(|after| after.0),
            seen: self.seen.0,
            values: self.values.clone(),
        };
        // Strings and numbers can always be written.
        serde_json::to_vec(&written).unwrap_or_default()
    }

    /// Reads a message.
    ///
    /// # Errors
    /// [`NoSet`].
    pub fn read(message: &[u8]) -> Result<Self, NoSet> {
        let written: Written = serde_json::from_slice(message).map_err(|error| NoSet::Form {
            line: error.line(),
            column: error.column(),
        })?;
        let moment = |name, at: u64| {
            let possible = (at <= LAST).then_some(Moment(at));
            possible.ok_or(NoSet::Field(name))
        };
        let firmware = written.firmware;
        if firmware.len() > FIRMWARE || firmware.contains(char::is_control) {
            return Err(NoSet::Field("firmware"));
        }
        Ok(Self {
            serial: number("serial", &written.serial)?,
            firmware,
            parameters: number("parameters", &written.parameters)?,
            schema: written.schema,
            since: moment("since", written.since)?,
            after: match written.after {
                Some(after) => Some(moment("after", after)?),
                None => None,
            },
            seen: moment("seen", written.seen)?,
            values: written.values,
        })
    }
}

fn number(name: &'static str, digits: &str) -> Result<u32, NoSet> {
    let is_number = digits.len() == DIGITS && digits.bytes().all(|byte| byte.is_ascii_hexdigit());
    let number = u32::from_str_radix(digits, 16).ok();
    number.filter(|_| is_number).ok_or(NoSet::Field(name))
}

/// The sets of an agent's machines, each with a number that tells it apart from those before.
#[derive(Debug, Default)]
pub struct Sets {
    last: u64,
    of: BTreeMap<String, (u64, Vec<u8>)>,
}

impl Sets {
    /// Takes the set of a machine in the place of the one before.
    pub fn take(&mut self, machine: &str, set: &Set) {
        self.last += 1;
        self.of
            .insert(machine.to_owned(), (self.last, set.written()));
    }

    /// Machine, number and message of each.
    pub fn iter(&self) -> impl Iterator<Item = (&str, u64, &[u8])> {
        self.of
            .iter()
            .map(|(machine, (number, message))| (machine.as_str(), *number, &message[..]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn set() -> Set {
        Set {
            serial: 0xA01F,
            firmware: "0.1.0".to_owned(),
            parameters: 0x1A2B_3C4D,
            schema: 2,
            since: Moment(1_764_150_000_123),
            after: None,
            seen: Moment(1_764_150_900_000),
            values: Some(BTreeMap::from([(
                "rapid_rate.X".to_owned(),
                "11000 mm/min".to_owned(),
            )])),
        }
    }

    #[test]
    fn a_set_comes_back_from_its_message() {
        let text = r#"{"serial":"0000a01f","firmware":"0.1.0","parameters":"1a2b3c4d","schema":2,"since":1764150000123,"after":null,"seen":1764150900000,"values":{"rapid_rate.X":"11000 mm/min"}}"#;
        assert_eq!(String::from_utf8(set().written()).unwrap(), text);
        for known in [
            set(),
            Set {
                after: Some(Moment(7)),
                values: None,
                ..set()
            },
        ] {
            assert_eq!(Set::read(&known.written()), Ok(known));
        }
        // A later version may say more.
        let more = text.replacen('{', r#"{"drives":[1],"#, 1);
        assert_eq!(Set::read(more.as_bytes()), Ok(set()));
    }

    #[test]
    fn what_anybody_may_put_there_is_refused() {
        let text = String::from_utf8(set().written()).unwrap();
        let refused = |from: &str, to: &str| {
            assert!(text.contains(from), "{from}");
            Set::read(text.replacen(from, to, 1).as_bytes()).unwrap_err()
        };
        for (from, to, field) in [
            ("0000a01f", "+000a01f", "serial"),
            ("1a2b3c4d", "1a2b3c4", "parameters"),
            ("0.1.0", "\\u001b[2J", "firmware"),
            ("0.1.0", &"9".repeat(65), "firmware"),
            ("1764150000123", "253402300800000", "since"),
            ("1764150900000", "18446744073709551615", "seen"),
            (":null", ":253402300800000", "after"),
        ] {
            assert_eq!(refused(from, to), NoSet::Field(field), "{to}");
        }
        for (from, to) in [
            ("\"schema\":2", "\"schema\":-2"),
            ("1764150000123", "1e99"),
            ("\"11000 mm/min\"", "11000"),
            ("{", "["),
        ] {
            assert!(matches!(refused(from, to), NoSet::Form { .. }), "{to}");
        }
        for bytes in [&b""[..], b"\xff\xfe", b"null", &b"[".repeat(1 << 16)[..]] {
            assert!(matches!(Set::read(bytes), Err(NoSet::Form { .. })));
        }
    }

    #[test]
    fn a_topic_tells_whose_it_is() {
        assert_eq!(topics("shop"), "leadscrew/v1/shop/+/+/set");
        let whose = Whose::of(&topic("shop", "desk", "lathe 1")).unwrap();
        assert_eq!((&*whose.machine, &*whose.node), ("lathe 1", "desk"));
        for bad in [
            "leadscrew/v1/a/b/set",
            "leadscrew/v1/a/b/c/d/set",
            "leadscrew/v1/a//c/set",
            "leadscrew/v1/a/b/c/sets",
            "leadscrew/v1/a/b/\u{9b}31m/set",
            "leadscrew/v10/a/b/c/set",
            "",
        ] {
            assert_eq!(Whose::of(bad), None, "{bad:?}");
        }
    }
}
