//! The client of one connection: bytes and times in, bytes and what the broker says out.
//!
//! Every message goes with quality of service 1: in order, and repeated by whoever keeps it until the broker has said that
//! it has it. This client repeats nothing itself; a connection that ends is over, and the next is another client [D408].

use std::collections::VecDeque;
use std::fmt;
use std::time::Duration;

use bytes::{Buf as _, BytesMut};
use mqttbytes::v4::{
    Connect, ConnectReturnCode, LastWill, Packet, PubAck, Publish, Subscribe, SubscribeReasonCode,
    read,
};
use mqttbytes::{Error, QoS};

use super::wire::Login;
use crate::sparkplug::Message;

/// A broker drops a client that is silent for one and a half times this.
const KEEP_ALIVE: Duration = Duration::from_secs(30);
/// A client that has sent nothing for this time says that it is there.
const PING: Duration = Duration::from_secs(15);
/// A broker that is silent for this time is gone, whatever the network says.
const SILENCE: Duration = Duration::from_secs(45);
/// The same of one that has not taken this client yet: it has nothing else to do.
const ANSWER: Duration = Duration::from_secs(10);
/// The largest packet that is read: orders are small, and a set of parameters has a third of it. Of a larger message the
/// topic is read, and the rest is dropped as it comes.
const LARGEST: usize = 64 << 10;
/// The upper half of the first byte of a `PUBLISH`.
const PUBLISH: u8 = 3;
/// The first byte of `CONNACK`, which a broker begins with.
const ACCEPTANCE: u8 = 0x20;
/// The first two bytes of an alert and of a handshake in TLS, of any version of it.
const TLS: [[u8; 2]; 2] = [[0x15, 3], [0x16, 3]];
/// Bytes of an answer that is no MQTT, which are quoted.
const QUOTED: usize = 16;
/// `PINGREQ`, which has no content.
const PING_REQUEST: [u8; 2] = [0xC0, 0];
/// `DISCONNECT`.
const DISCONNECT: [u8; 2] = [0xE0, 0];

/// What the broker says.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Said {
    /// It takes this client.
    Accepted,
    /// It has all messages up to this one, by the number that was given with it.
    Has(u64),
    /// A message to this client.
    Message {
        /// Its topic.
        topic: String,
        /// Its content.
        payload: Vec<u8>,
        /// The broker has kept it, and tells it because this client has just come.
        retained: bool,
    },
    /// A message that is too large to be read: its topic.
    Huge(String),
    /// This client hears what it has subscribed to.
    Subscribed,
    /// The broker has answered a ping.
    Alive,
}

/// Why a connection is over.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Fault {
    /// Its name or password is wrong.
    Login,
    /// The broker refuses this client otherwise.
    Refused(Refusal),
    /// The broker does not let it hear orders.
    Orders,
    /// The broker has never said anything.
    Mute,
    /// The broker says nothing any more.
    Silent,
    /// It answers in TLS, where nobody has asked for that.
    Tls,
    /// What it says is no MQTT: how it begins.
    Nonsense(String),
}

/// Why a broker takes nobody of this name and kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// It does not speak MQTT 3.1.1.
    Version,
    /// It does not like what the client is called.
    Name,
    /// It is not in service.
    Closed,
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Version => "it does not speak MQTT 3.1.1",
            Self::Name => "it does not take the name of this client",
            Self::Closed => "it is not in service",
        })
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Login => f.write_str("the broker refuses user and password"),
            Self::Refused(why) => write!(f, "the broker refuses the connection: {why}"),
            Self::Orders => f.write_str("the broker refuses the subscription to its orders"),
            Self::Mute => f.write_str("the connection is taken, and nobody answers on it"),
            Self::Silent => f.write_str("the broker has gone silent"),
            Self::Tls => f.write_str("what answers speaks TLS"),
            Self::Nonsense(what) => write!(f, "what answers is no MQTT broker: it says {what}"),
        }
    }
}

/// A client.
#[derive(Debug)]
pub struct Client {
    input: BytesMut,
    output: BytesMut,
    last_id: u16,
    /// Messages that the broker has not said it has, in order, each with its number where it has one.
    under_way: VecDeque<(u16, Option<u64>)>,
    /// So many bytes of a message that is too large are still to come.
    skip: usize,
    /// The broker has taken this client.
    accepted: bool,
    heard: Duration,
    sent: Duration,
}

impl Client {
    /// Begins a connection; the times here are those since any beginning. Who only listens leaves no will.
    #[must_use]
    pub fn new(name: &str, login: Option<&Login>, will: Option<Message>, now: Duration) -> Self {
        let mut connect = Connect::new(name);
        connect.keep_alive = KEEP_ALIVE.as_secs() as u16;
        connect.last_will =
            will.map(|will| LastWill::new(will.topic, will.payload, QoS::AtLeastOnce, false));
        if let Some(login) = login {
            connect.set_login(&login.user, &login.password);
        }
        let mut client = Self {
            input: BytesMut::new(),
            output: BytesMut::new(),
            last_id: 0,
            under_way: VecDeque::new(),
            skip: 0,
            accepted: false,
            heard: now,
            sent: now,
        };
        // Its length is bounded by those of names and payload; the packet has room for more.
        let _ = connect.write(&mut client.output);
        client
    }

    /// Bytes for the broker; who has sent them removes them.
    pub const fn output(&mut self) -> &mut BytesMut {
        &mut self.output
    }

    /// Messages that the broker has not said it has.
    #[must_use]
    pub fn under_way(&self) -> usize {
        self.under_way.len()
    }

    fn id(&mut self) -> u16 {
        self.last_id = self.last_id.checked_add(1).unwrap_or(1);
        self.last_id
    }

    /// Hears a topic from now on.
    pub fn subscribe(&mut self, topic: &str, now: Duration) {
        self.subscribe_as(topic, QoS::AtLeastOnce, now);
    }

    /// The same without answers: a broker then keeps no queue for this client, whose end would be dropped where it is long.
    pub fn look(&mut self, topic: &str, now: Duration) {
        self.subscribe_as(topic, QoS::AtMostOnce, now);
    }

    fn subscribe_as(&mut self, topic: &str, qos: QoS, now: Duration) {
        let mut packet = Subscribe::new(topic, qos);
        packet.pkid = self.id();
        self.put(now, |output| packet.write(output));
    }

    /// Sends a message. The broker's answer tells its number.
    pub fn publish(&mut self, message: Message, number: Option<u64>, now: Duration) {
        self.publish_as(message, number, false, now);
    }

    /// Sends a message that the broker keeps for those who come later, in the place of the one before.
    pub fn retain(&mut self, message: Message, now: Duration) {
        self.publish_as(message, None, true, now);
    }

    fn publish_as(&mut self, message: Message, number: Option<u64>, retain: bool, now: Duration) {
        let mut packet = Publish::new(message.topic, QoS::AtLeastOnce, message.payload);
        packet.retain = retain;
        packet.pkid = self.id();
        self.under_way.push_back((packet.pkid, number));
        self.put(now, |output| packet.write(output));
    }

    /// Asks the broker to answer.
    pub fn ping(&mut self, now: Duration) {
        self.sent = now;
        self.output.extend_from_slice(&PING_REQUEST);
    }

    /// Ends the connection without a will.
    pub fn disconnect(&mut self) {
        self.output.extend_from_slice(&DISCONNECT);
    }

    fn put(&mut self, now: Duration, write: impl FnOnce(&mut BytesMut) -> Result<usize, Error>) {
        self.sent = now;
        let whole = self.output.len();
        if write(&mut self.output).is_err() {
            // Beyond the 256 MiB of a packet: no record is so long. Half a packet would spoil those behind it.
            self.output.truncate(whole);
        }
    }

    /// Says that it is there where it has been silent.
    ///
    /// # Errors
    /// The broker is.
    pub fn attend(&mut self, now: Duration) -> Result<(), Fault> {
        let silent = now.saturating_sub(self.heard);
        if !self.accepted && silent > ANSWER {
            return Err(Fault::Mute);
        }
        if silent > SILENCE {
            return Err(Fault::Silent);
        }
        if now.saturating_sub(self.sent) > PING {
            self.ping(now);
        }
        Ok(())
    }

    /// Takes bytes of the broker.
    ///
    /// # Errors
    /// The connection is over.
    pub fn take(&mut self, bytes: &[u8], now: Duration) -> Result<Vec<Said>, Fault> {
        self.heard = now;
        self.input.extend_from_slice(bytes);
        let mut said = Vec::new();
        if !self.accepted {
            self.first()?;
        }
        loop {
            let skipped = self.skip.min(self.input.len());
            self.input.advance(skipped);
            self.skip -= skipped;
            if self.skip > 0 {
                return Ok(said);
            }
            // What is read is gone, also where it is not understood.
            let start = quoted(&self.input);
            match read(&mut self.input, LARGEST) {
                Ok(packet) => said.extend(self.packet(packet, now)?),
                Err(Error::InsufficientBytes(_)) => return Ok(said),
                Err(Error::PayloadSizeLimitExceeded(length)) => match self.huge(length, now)? {
                    Some(topic) => said.push(Said::Huge(topic)),
                    None => return Ok(said),
                },
                Err(_) => return Err(Fault::Nonsense(start)),
            }
        }
    }

    /// Looks at how an answer begins: what is no broker may be understood as the beginning of a long message, which would
    /// be waited for.
    fn first(&self) -> Result<(), Fault> {
        match &self.input[..] {
            [] | [ACCEPTANCE, ..] => Ok(()),
            [one, two, ..] if TLS.contains(&[*one, *two]) => Err(Fault::Tls),
            // The second byte tells.
            [one] if TLS.iter().any(|[first, _]| first == one) => Ok(()),
            other => Err(Fault::Nonsense(quoted(other))),
        }
    }

    /// The topic of a message that is too large, whose rest is dropped from now on; `None` where it has not come whole.
    /// `length`: of the message behind its first bytes.
    fn huge(&mut self, length: usize, now: Duration) -> Result<Option<String>, Fault> {
        let start = quoted(&self.input);
        let nonsense = || Fault::Nonsense(start.clone());
        let first = self.input.first().copied().unwrap_or_default();
        if first >> 4 != PUBLISH {
            return Err(nonsense());
        }
        // The kind, and the length in up to four bytes, each but the last with its highest bit.
        let rest = self.input.get(1..).unwrap_or_default();
        let head = 2 + rest.iter().take_while(|byte| **byte >= 0x80).count();
        let Some([high, low]) = self.input.get(head..head + 2) else {
            return Ok(None);
        };
        let topic = head + 2..head + 2 + usize::from(u16::from_be_bytes([*high, *low]));
        let qos = first >> 1 & 3;
        let content = topic.end + if qos > 0 { 2 } else { 0 };
        if content > head + length {
            return Err(nonsense());
        }
        if self.input.len() < content {
            return Ok(None);
        }
        let name = String::from_utf8_lossy(&self.input[topic.clone()]).into_owned();
        if let (1, [high, low]) = (qos, &self.input[topic.end..content]) {
            let answer = PubAck::new(u16::from_be_bytes([*high, *low]));
            self.put(now, |output| answer.write(output));
        }
        self.input.advance(content);
        self.skip = head + length - content;
        Ok(Some(name))
    }

    fn packet(&mut self, packet: Packet, now: Duration) -> Result<Option<Said>, Fault> {
        match packet {
            Packet::ConnAck(answer) => match answer.code {
                ConnectReturnCode::Success => {
                    self.accepted = true;
                    Ok(Some(Said::Accepted))
                }
                ConnectReturnCode::BadUserNamePassword | ConnectReturnCode::NotAuthorized => {
                    Err(Fault::Login)
                }
                ConnectReturnCode::RefusedProtocolVersion => Err(Fault::Refused(Refusal::Version)),
                ConnectReturnCode::BadClientId => Err(Fault::Refused(Refusal::Name)),
                ConnectReturnCode::ServiceUnavailable => Err(Fault::Refused(Refusal::Closed)),
            },
            Packet::PubAck(answer) => Ok(self.has(answer.pkid)),
            Packet::SubAck(answer) => {
                let refused = answer.return_codes.contains(&SubscribeReasonCode::Failure);
                if refused {
                    Err(Fault::Orders)
                } else {
                    Ok(Some(Said::Subscribed))
                }
            }
            Packet::Publish(message) => {
                if message.qos == QoS::AtLeastOnce {
                    let answer = PubAck::new(message.pkid);
                    self.put(now, |output| answer.write(output));
                }
                Ok(Some(Said::Message {
                    topic: message.topic,
                    payload: message.payload.to_vec(),
                    retained: message.retain,
                }))
            }
            Packet::PingResp => Ok(Some(Said::Alive)),
            _ => Err(Fault::Nonsense("what only a client says".to_owned())),
        }
    }

    /// A broker answers in order. Where it has a later message, it has those before.
    fn has(&mut self, id: u16) -> Option<Said> {
        let place = self.under_way.iter().position(|(known, _)| *known == id)?;
        let done = self.under_way.drain(..=place);
        done.filter_map(|(_, number)| number).max().map(Said::Has)
    }
}

/// The first bytes of an answer, as text where they are.
fn quoted(bytes: &[u8]) -> String {
    let start = &bytes[..bytes.len().min(QUOTED)];
    format!("\"{}\"", start.escape_ascii())
}
