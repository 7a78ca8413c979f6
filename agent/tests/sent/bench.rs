//! The broker's side, and records to send.

use bytes::BytesMut;
use leadscrew_agent::record::{Presence, State};
use leadscrew_agent::sender::{Broker, Sending};
use leadscrew_agent::sparkplug::payload::{Metric, Payload, Value};
use leadscrew_agent::sparkplug::{Machines, Names, metrics};
use leadscrew_agent::{Body, Memory, Moment, Numbered, Record, Store};
use mqttbytes::QoS;
use mqttbytes::v4::{ConnAck, ConnectReturnCode, Packet, PubAck, Publish, read};
use prost::Message as _;

pub const BIRTH: Moment = Moment(5_000);
const MOST: usize = 1 << 20;

pub fn names() -> Names {
    Names::new("shop", "agent", ["lathe"]).unwrap()
}

/// Nobody is there: for sessions without sockets.
pub fn nowhere() -> Broker {
    Broker {
        address: "mqtt://127.0.0.1:1".parse().unwrap(),
        login: None,
        tls: None,
        names: names(),
        primary: None,
    }
}

pub fn state(line: u32) -> Body {
    Body::State(State {
        line,
        ..State::default()
    })
}

pub fn presence(alive: bool) -> Body {
    Body::Presence(Presence {
        alive,
        why: String::new(),
    })
}

/// Keeps records, and has the values know them.
pub fn keep(
    store: &Store,
    machines: &mut Machines,
    at: u64,
    bodies: impl IntoIterator<Item = Body>,
) {
    keep_of("lathe", store, machines, at, bodies);
}

/// The same of another machine.
pub fn keep_of(
    machine: &str,
    store: &Store,
    machines: &mut Machines,
    at: u64,
    bodies: impl IntoIterator<Item = Body>,
) {
    let record = |body| Record {
        at: Moment(at),
        machine: machine.to_owned(),
        body,
    };
    let records: Vec<Record> = bodies.into_iter().map(record).collect();
    let kept: Vec<Numbered> = store.keep(machine, &records, &Memory::default()).unwrap();
    kept.iter().for_each(|record| machines.take(record));
}

/// Packets of some bytes.
pub fn packets(bytes: &mut BytesMut) -> Vec<Packet> {
    std::iter::from_fn(|| read(bytes, MOST).ok()).collect()
}

/// What has been published, in words: topic without its beginning, sequence number, line, `old` where historical.
pub fn told(publish: &Publish) -> String {
    assert_eq!((publish.qos, publish.retain), (QoS::AtLeastOnce, false));
    let topic = publish.topic.strip_prefix("spBv1.0/shop/").unwrap();
    let payload = Payload::decode(&publish.payload[..]).unwrap();
    let seq = payload.seq.map_or("-".to_owned(), |seq| seq.to_string());
    let mut words = format!("{topic} {seq}");
    if let Some(line) = metric(&payload, "Program/Line") {
        if let Some(Value::Int(line)) = &line.value {
            words.push_str(&format!(" line {line}"));
        }
        if line.is_historical == Some(true) {
            words.push_str(" old");
        }
    }
    words
}

/// A metric by its name, or by its alias, which says what row of the table it is, whichever machine it is of.
pub fn metric<'a>(payload: &'a Payload, name: &str) -> Option<&'a Metric> {
    let rows = metrics::TABLE.len() as u64;
    let row = metrics::TABLE.iter().position(|row| row.name == name);
    let row = row.map(|row| row as u64);
    payload.metrics.iter().find(|metric| {
        let own = metric.alias.map(|alias| alias % rows);
        metric.name.as_deref() == Some(name) || (own.is_some() && own == row)
    })
}

/// What the client has sent since: published messages in words, and their numbers to acknowledge.
pub fn sent(sending: &mut Sending<'_>) -> (Vec<String>, Vec<u16>) {
    let mut bytes = sending.output().split();
    let mut words = Vec::new();
    let mut ids = Vec::new();
    for packet in packets(&mut bytes) {
        if let Packet::Publish(publish) = packet {
            ids.push(publish.pkid);
            words.push(told(&publish));
        }
    }
    (words, ids)
}

pub fn accept() -> Vec<u8> {
    let mut bytes = BytesMut::new();
    let answer = ConnAck::new(ConnectReturnCode::Success, false);
    answer.write(&mut bytes).unwrap();
    bytes.to_vec()
}

pub fn acknowledge(ids: &[u16]) -> Vec<u8> {
    let mut bytes = BytesMut::new();
    for id in ids {
        PubAck::new(*id).write(&mut bytes).unwrap();
    }
    bytes.to_vec()
}
