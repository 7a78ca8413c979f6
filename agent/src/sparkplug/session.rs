//! One connection to a broker in Sparkplug B: births, data, deaths, and the sequence number that runs through them.
//!
//! It has no socket and no clock. The agent is the edge node, its machines are the devices.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

use prost::Message as _;

use super::metrics::{Machines, TABLE, Values, of_record};
use super::payload::{Kind, Metric, Payload, Value};
use crate::record::{Moment, Numbered};
use crate::set;

/// The name of the order to tell all births anew; no other order is known.
const REBIRTH: &str = "Node Control/Rebirth";
/// The number that binds a death to its birth.
const BIRTH_NUMBER: &str = "bdSeq";
const VERSION: &str = "Properties/Agent Version";
const STORE_MADE: &str = "Properties/Store Made";
const NAMESPACE: &str = "spBv1.0";
/// Numbers of births and of messages are of one byte.
const NUMBERS: u64 = 256;

/// What the agent is called on the broker.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Names {
    group: String,
    node: String,
}

/// A name that cannot be part of a topic.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NameError(pub String);

impl fmt::Display for NameError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "`{}` is no part of a topic", self.0)
    }
}

impl std::error::Error for NameError {}

impl Names {
    /// Names of the group and of this agent, where its machines have these.
    ///
    /// # Errors
    /// One is empty, or has a `/`, `+`, `#` or a control character in it.
    pub fn new<'a>(
        group: &'a str,
        node: &'a str,
        machines: impl IntoIterator<Item = &'a str>,
    ) -> Result<Self, NameError> {
        // What the agent is called may be made of a machine's name, and nobody has typed that.
        for name in machines.into_iter().chain([group, node]) {
            let is_bad = |c: char| "/+#".contains(c) || c.is_control();
            if name.is_empty() || name.contains(is_bad) {
                return Err(NameError(name.to_owned()));
            }
        }
        Ok(Self {
            group: group.to_owned(),
            node: node.to_owned(),
        })
    }

    fn node_topic(&self, kind: &str) -> String {
        format!("{NAMESPACE}/{}/{kind}/{}", self.group, self.node)
    }

    fn device_topic(&self, kind: &str, machine: &str) -> String {
        format!("{}/{machine}", self.node_topic(kind))
    }

    /// Where orders to the edge node come.
    #[must_use]
    pub fn orders(&self) -> String {
        self.node_topic("NCMD")
    }

    /// Where what a machine tells goes, with any kind of message.
    #[must_use]
    pub fn machine(&self, machine: &str) -> String {
        self.device_topic("+", machine)
    }

    /// Where the set of a machine is retained. It is no topic of Sparkplug's.
    #[must_use]
    pub fn set(&self, machine: &str) -> String {
        set::topic(&self.group, &self.node, machine)
    }

    /// What a client of a broker is called: one agent of a name is connected at a time.
    #[must_use]
    pub fn client(&self) -> String {
        format!("leadscrew-{}-{}", self.group, self.node)
    }
}

/// A message to the broker.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Message {
    /// Its topic.
    pub topic: String,
    /// Its content.
    pub payload: Vec<u8>,
}

/// One connection.
#[derive(Debug)]
pub struct Session {
    names: Names,
    /// The number of the birth, from the count of connections.
    number: u64,
    store_made: Moment,
    seq: u64,
    /// When the births were told, and the newest record that was kept then.
    born: (Moment, u64),
    /// The machines that have been born and have not died.
    living: BTreeSet<String>,
    /// The first alias of each machine that was born: no two metrics of an edge node have the same.
    aliases: BTreeMap<String, u64>,
}

impl Session {
    /// The session of a connection with this count.
    #[must_use]
    pub const fn new(names: Names, connection: u64, store_made: Moment) -> Self {
        Self {
            names,
            number: connection % NUMBERS,
            store_made,
            seq: 0,
            born: (Moment(0), 0),
            living: BTreeSet::new(),
            aliases: BTreeMap::new(),
        }
    }

    /// What the broker tells others when this connection ends: it is left there when it begins.
    #[must_use]
    pub fn death(&self) -> Message {
        let payload = Payload {
            metrics: vec![self.number_of_birth()],
            ..Payload::default()
        };
        message(self.names.node_topic("NDEATH"), &payload)
    }

    fn number_of_birth(&self) -> Metric {
        named(BIRTH_NUMBER, Kind::Int64, Value::Long(self.number), None)
    }

    /// Births of the edge node, and of each machine that answers, at the beginning and where they are asked for. `newest`:
    /// the number of the last record that was kept.
    pub fn births(&mut self, at: Moment, newest: u64, machines: &Machines) -> Vec<Message> {
        (self.seq, self.born) = (0, (at, newest));
        self.living.clear();
        let made = Value::Long(self.store_made.0);
        let version = Value::String(env!("CARGO_PKG_VERSION").to_owned());
        let metrics = vec![
            self.number_of_birth(),
            named(REBIRTH, Kind::Boolean, Value::Boolean(false), Some(at)),
            named(VERSION, Kind::String, version, Some(at)),
            named(STORE_MADE, Kind::DateTime, made, Some(at)),
        ];
        let node = self.numbered(at, metrics);
        let mut births = vec![message(self.names.node_topic("NBIRTH"), &node)];
        births.extend(self.settle(at, machines));
        births
    }

    fn first_alias(&mut self, machine: &str) -> u64 {
        let next = (self.aliases.len() * TABLE.len()) as u64;
        *self.aliases.entry(machine.to_owned()).or_insert(next)
    }

    fn machine_birth(&mut self, at: Moment, machine: &str, values: &Values) -> Message {
        self.living.insert(machine.to_owned());
        let first = self.first_alias(machine);
        let payload = self.numbered(at, values.birth(at, first));
        message(self.names.device_topic("DBIRTH", machine), &payload)
    }

    /// A record. A machine that has died is born again first: what it said before its death is still told. So is what is
    /// kept of a machine that the agent reads no more.
    pub fn data(&mut self, at: Moment, record: &Numbered, machines: &Machines) -> Vec<Message> {
        let mut messages = Vec::new();
        let machine = record.record.machine.as_str();
        if !self.living.contains(machine) {
            let birth = match machines.get(machine) {
                Some(values) => self.machine_birth(at, machine, values),
                None => self.machine_birth(at, machine, &Values::default()),
            };
            messages.push(birth);
        }
        // A clock that is set back makes nothing old that was kept after the births.
        let (born, newest) = self.born;
        let historical = record.record.at < born && record.number <= newest;
        let first = self.first_alias(machine);
        let payload = self.numbered(at, of_record(record, first, historical));
        messages.push(message(self.names.device_topic("DDATA", machine), &payload));
        messages
    }

    /// Once all records are told: the death of each machine whose board does not answer, the birth of each whose board does
    /// again.
    pub fn settle(&mut self, at: Moment, machines: &Machines) -> Vec<Message> {
        let is_alive = |machine: &str| machines.get(machine).is_some_and(Values::is_alive);
        let dead = self.living.iter().filter(|machine| !is_alive(machine));
        let dead: Vec<String> = dead.cloned().collect();
        let mut messages = Vec::new();
        for machine in dead {
            self.living.remove(&machine);
            let payload = self.numbered(at, Vec::new());
            messages.push(message(
                self.names.device_topic("DDEATH", &machine),
                &payload,
            ));
        }
        for (machine, values) in machines.iter() {
            if values.is_alive() && !self.living.contains(machine) {
                messages.push(self.machine_birth(at, machine, values));
            }
        }
        messages
    }

    /// True where a message asks for all births anew. Nothing else is obeyed.
    #[must_use]
    pub fn asks_for_births(&self, topic: &str, payload: &[u8]) -> bool {
        let is_it = |metric: &Metric| {
            metric.name.as_deref() == Some(REBIRTH) && metric.value == Some(Value::Boolean(true))
        };
        topic == self.names.orders()
            && Payload::decode(payload).is_ok_and(|payload| payload.metrics.iter().any(is_it))
    }

    fn numbered(&mut self, at: Moment, metrics: Vec<Metric>) -> Payload {
        let seq = self.seq;
        self.seq = (seq + 1) % NUMBERS;
        Payload {
            timestamp: Some(at.0),
            metrics,
            seq: Some(seq),
        }
    }
}

fn named(name: &str, kind: Kind, value: Value, at: Option<Moment>) -> Metric {
    Metric {
        name: Some(name.to_owned()),
        timestamp: at.map(|at| at.0),
        datatype: Some(kind as u32),
        value: Some(value),
        ..Metric::default()
    }
}

fn message(topic: String, payload: &Payload) -> Message {
    Message {
        topic,
        payload: payload.encode_to_vec(),
    }
}
