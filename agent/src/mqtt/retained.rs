//! What a broker retains below some topics, heard once: for a program that asks, prints and ends.
//!
//! A broker does not say when it has told all. Once it has taken the subscription it is asked to answer, and what it had to
//! tell has mostly come before that answer; then it has to be quiet for a moment. All of it is bounded: the time, the size
//! of a message (by the client), their number and their bytes.

use std::collections::{BTreeMap, BTreeSet};
use std::time::{Duration, Instant};

use super::client::{Client, Fault, Said};
use super::wire::{Address, Login, Tls, Wire, WireError};

/// A broker that has been silent so long behind its answer has told all.
const QUIET: Duration = Duration::from_millis(500);
/// The longest wait for the broker before the time is looked at again.
const GLANCE: Duration = Duration::from_millis(50);
/// Messages that are kept, and their bytes.
const MESSAGES: usize = 10_000;
const BYTES: usize = 64 << 20;
/// Topics of messages that were too large, which are named.
const NAMED: usize = 20;

/// What was heard.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Heard {
    /// The newest message of each topic.
    pub messages: BTreeMap<String, Vec<u8>>,
    /// Topics of messages that were too large to be read, the first of them.
    pub huge: BTreeSet<String>,
    /// Messages for which there was no room.
    pub left_out: u64,
}

/// Why nothing could be heard.
#[derive(Debug)]
pub enum Deaf {
    /// On the way to the broker.
    Wire(WireError),
    /// By what the broker says.
    Broker(Fault),
    /// The time was over before the broker had answered at all.
    NoAnswer,
    /// The time was over, and the broker had still not told all.
    NoEnd,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    Connecting,
    Subscribing,
    Asked,
    /// The broker has answered; what it retains came last at this time.
    Answered(Duration),
}

/// One connection without its socket.
#[derive(Debug)]
pub struct Listener {
    client: Client,
    topics: String,
    stage: Stage,
    heard: Heard,
    bytes: usize,
}

impl Listener {
    /// Begins. `name`: what this client is called at the broker, as no other.
    #[must_use]
    pub fn new(name: &str, login: Option<&Login>, topics: &str) -> Self {
        Self {
            client: Client::new(name, login, None, Duration::ZERO),
            topics: topics.to_owned(),
            stage: Stage::Connecting,
            heard: Heard::default(),
            bytes: 0,
        }
    }

    /// Bytes for the broker; who has sent them removes them.
    pub const fn output(&mut self) -> &mut bytes::BytesMut {
        self.client.output()
    }

    /// What has been heard.
    #[must_use]
    pub const fn heard(&self) -> &Heard {
        &self.heard
    }

    /// Takes what the broker says.
    ///
    /// # Errors
    /// The connection is over.
    pub fn take(&mut self, bytes: &[u8], now: Duration) -> Result<(), Fault> {
        for said in self.client.take(bytes, now)? {
            match said {
                Said::Accepted => {
                    self.client.look(&self.topics, now);
                    self.stage = Stage::Subscribing;
                }
                Said::Subscribed => {
                    self.client.ping(now);
                    self.stage = Stage::Asked;
                }
                Said::Alive => {
                    if self.stage == Stage::Asked {
                        self.stage = Stage::Answered(now);
                    }
                }
                Said::Message {
                    topic,
                    payload,
                    retained,
                } => {
                    self.keep(topic, payload);
                    // What is told anew meanwhile is no reason to wait.
                    if let Stage::Answered(last) = &mut self.stage
                        && retained
                    {
                        *last = now;
                    }
                }
                Said::Huge(topic) => {
                    if self.heard.huge.len() < NAMED {
                        self.heard.huge.insert(topic);
                    } else {
                        self.heard.left_out += 1;
                    }
                }
                Said::Has(_) => {}
            }
        }
        // A broker that has much to tell would else end this connection.
        self.client.attend(now)
    }

    fn keep(&mut self, topic: String, payload: Vec<u8>) {
        let messages = &mut self.heard.messages;
        if let Some(before) = messages.remove(&topic) {
            self.bytes -= before.len() + topic.len();
        }
        // An empty message says that there is none.
        if payload.is_empty() {
            return;
        }
        let bytes = self.bytes + payload.len() + topic.len();
        if messages.len() < MESSAGES && bytes <= BYTES {
            self.bytes = bytes;
            messages.insert(topic, payload);
        } else {
            self.heard.left_out += 1;
        }
    }

    /// The broker has told all.
    #[must_use]
    pub fn is_done(&self, now: Duration) -> bool {
        matches!(self.stage, Stage::Answered(last) if now.saturating_sub(last) >= QUIET)
    }

    const fn late(&self) -> Deaf {
        match self.stage {
            Stage::Answered(_) => Deaf::NoEnd,
            Stage::Connecting | Stage::Subscribing | Stage::Asked => Deaf::NoAnswer,
        }
    }
}

/// Hears what a broker retains.
///
/// # Errors
/// [`Deaf`]; after `limit` at the latest, and the time that the network takes for a connection.
pub fn hear(
    address: &Address,
    login: Option<&Login>,
    tls: Option<&Tls>,
    name: &str,
    topics: &str,
    limit: Duration,
) -> Result<Heard, Deaf> {
    let began = Instant::now();
    let mut wire = Wire::open(address, tls, GLANCE).map_err(Deaf::Wire)?;
    let mut listener = Listener::new(name, login, topics);
    let mut room = [0; 1 << 16];
    loop {
        let output = listener.output();
        wire.write(output).map_err(Deaf::Wire)?;
        output.clear();
        let bytes = wire.read(&mut room).map_err(Deaf::Wire)?;
        listener
            .take(bytes, began.elapsed())
            .map_err(Deaf::Broker)?;
        if listener.is_done(began.elapsed()) {
            listener.client.disconnect();
            // It has told all; whether it hears this does not matter.
            let _ = wire.write(listener.output());
            return Ok(listener.heard);
        }
        if began.elapsed() >= limit {
            return Err(listener.late());
        }
    }
}
