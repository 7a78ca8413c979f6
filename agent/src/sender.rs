//! Sends what is kept, in order, and removes it when the broker has it.
//!
//! Where the shop names a primary host, nothing is sent while that is away: what the broker takes then, nobody might hear
//! [D436].
//!
//! The set in force of each machine is a state: it is sent where no record waits, and the newest is what counts [D417].
//!
//! A connection that ends is begun anew after a pause; what the broker had not said it has is sent again, with the number
//! that it had.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use crate::mqtt::{Address, Client, Fault, Login, Said, Tls, Wire, WireError};
use crate::record::{Moment, Numbered};
use crate::set::{Set, Sets};
use crate::sparkplug::{Host, Machines, Message, Names, Session};
use crate::store::{Store, StoreError};

/// Messages on their way at a time: a broker gives each of its readers about as many.
const WINDOW: usize = 16;
/// The longest wait for the broker before the store is looked at again.
const GLANCE: Duration = Duration::from_millis(100);
/// The first pause behind a connection that failed, and the longest.
const PAUSES: [Duration; 2] = [Duration::from_secs(1), Duration::from_secs(60)];
/// A connection that lasted so long has worked: the next pause is the first again.
const WORKED: Duration = Duration::from_secs(60);
/// Between two looks at the end during a pause.
const NAP: Duration = Duration::from_millis(50);
/// What a broker retains of the primary host has come by then.
const RETAINED: Duration = Duration::from_secs(2);
/// For the last messages of an agent that ends.
pub const FAREWELL: Duration = Duration::from_secs(2);

/// Where to send, and as whom.
#[derive(Clone, Debug)]
pub struct Broker {
    /// Its address.
    pub address: Address,
    /// User and password.
    pub login: Option<Login>,
    /// TLS, where the address wants it.
    pub tls: Option<Tls>,
    /// What the agent is called there.
    pub names: Names,
    /// The host that has to be there.
    pub primary: Option<Host>,
}

/// Why a connection has ended.
#[derive(Debug)]
pub enum Trouble {
    /// On the way to the broker.
    Wire(WireError),
    /// By what the broker says.
    Broker(Fault),
    /// The store cannot be read or written.
    Store(StoreError),
    /// The primary host has gone.
    Host,
}

/// What there is to say of the sending.
#[derive(Debug)]
pub enum News {
    /// The broker takes what is kept.
    Connected,
    /// It would, and the primary host is not there.
    Waiting,
    /// A message to this agent is too large to be an order, and was dropped: its topic.
    Huge(String),
    /// It does not any more.
    Trouble(Trouble),
}

/// What the sender and the side of the bus share.
#[derive(Debug, Default)]
pub struct Shared {
    machines: Mutex<Machines>,
    sets: Mutex<Sets>,
    over: AtomicBool,
    connected: AtomicBool,
}

impl Shared {
    fn machines(&self) -> MutexGuard<'_, Machines> {
        self.machines.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Takes what records say that have been kept.
    pub fn take(&self, kept: &[Numbered]) {
        let mut machines = self.machines();
        kept.iter().for_each(|record| machines.take(record));
    }

    fn sets(&self) -> MutexGuard<'_, Sets> {
        self.sets.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Takes the set that a machine has in force.
    pub fn set(&self, machine: &str, set: &Set) {
        self.sets().take(machine, set);
    }

    /// The sender is to end.
    pub fn end(&self) {
        self.over.store(true, Ordering::Relaxed);
    }

    /// A broker takes what is kept.
    #[must_use]
    pub fn is_connected(&self) -> bool {
        self.connected.load(Ordering::Relaxed)
    }

    fn is_over(&self) -> bool {
        self.over.load(Ordering::Relaxed)
    }
}

/// The time of the computer's clock.
#[must_use]
pub fn now() -> Moment {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    Moment(since.map_or(0, |since| since.as_millis() as u64))
}

/// Sends until it is to end.
pub fn send(broker: &Broker, store: &Store, shared: &Arc<Shared>, mut tell: impl FnMut(News)) {
    let [first, longest] = PAUSES;
    let mut pause = first;
    while !shared.is_over() {
        let began = Instant::now();
        let ended = connection(broker, store, shared, &mut tell);
        shared.connected.store(false, Ordering::Relaxed);
        if let Err(trouble) = ended {
            tell(News::Trouble(trouble));
        }
        if began.elapsed() > WORKED {
            pause = first;
        }
        let until = Instant::now() + pause;
        while !shared.is_over() && Instant::now() < until {
            std::thread::sleep(NAP);
        }
        pause = (pause * 2).min(longest);
    }
}

fn connection(
    broker: &Broker,
    store: &Store,
    shared: &Shared,
    tell: &mut impl FnMut(News),
) -> Result<(), Trouble> {
    let mut wire =
        Wire::open(&broker.address, broker.tls.as_ref(), GLANCE).map_err(Trouble::Wire)?;
    let began = Instant::now();
    let mut sending = Sending::new(broker, store, began.elapsed()).map_err(Trouble::Store)?;
    let mut room = [0; 4096];
    let mut last = None;
    let mut is_told = false;
    loop {
        let output = sending.client.output();
        wire.write(output).map_err(Trouble::Wire)?;
        output.clear();
        let bytes = wire.read(&mut room).map_err(Trouble::Wire)?;
        let was_born = sending.born;
        let taken = sending.take(bytes, &shared.machines(), now(), began.elapsed());
        if matches!(taken, Err(Trouble::Host)) {
            sending.farewell(began.elapsed());
            wire.write(sending.client.output()).map_err(Trouble::Wire)?;
        }
        taken?;
        if let Some(topic) = sending.huge() {
            tell(News::Huge(topic));
        }
        sending.retain(&shared.sets(), began.elapsed());
        if sending.born && !was_born {
            shared.connected.store(true, Ordering::Relaxed);
            tell(News::Connected);
        }
        if sending.accepted && !sending.born && !is_told && began.elapsed() > RETAINED {
            is_told = true;
            tell(News::Waiting);
        }
        if shared.is_over() {
            let end = *last.get_or_insert(began.elapsed() + FAREWELL);
            if !sending.born || sending.is_done() || began.elapsed() > end {
                sending.farewell(began.elapsed());
                return wire.write(sending.client.output()).map_err(Trouble::Wire);
            }
        }
    }
}

/// One connection without its socket.
pub struct Sending<'a> {
    store: &'a Store,
    client: Client,
    session: Session,
    names: Names,
    accepted: bool,
    /// The births have been told.
    born: bool,
    host: Option<Host>,
    /// The last number that was handed to the client.
    handed: u64,
    /// All that was kept at the last look has been handed.
    empty: bool,
    /// Which set of each machine the broker has been given.
    sets: BTreeMap<String, u64>,
    /// The topic of the first message that was too large, until it is taken.
    huge: Option<String>,
    /// There was such a message.
    had_huge: bool,
}

impl<'a> Sending<'a> {
    /// Begins.
    ///
    /// # Errors
    /// The store cannot be read or written.
    pub fn new(broker: &Broker, store: &'a Store, now: Duration) -> Result<Self, StoreError> {
        let count = store.connect()?;
        let made = store.figures()?.made;
        let session = Session::new(broker.names.clone(), count, made);
        let name = broker.names.client();
        Ok(Self {
            store,
            client: Client::new(&name, broker.login.as_ref(), Some(session.death()), now),
            session,
            names: broker.names.clone(),
            accepted: false,
            born: false,
            // What was heard of it in another connection may be over.
            host: broker.primary.clone(),
            handed: 0,
            empty: false,
            sets: BTreeMap::new(),
            huge: None,
            had_huge: false,
        })
    }

    /// Bytes for the broker; who has sent them removes them.
    pub const fn output(&mut self) -> &mut bytes::BytesMut {
        self.client.output()
    }

    /// The broker has all that was kept.
    #[must_use]
    pub fn is_done(&self) -> bool {
        self.empty && self.client.under_way() == 0
    }

    /// Takes what the broker says, and hands it what is kept.
    ///
    /// # Errors
    /// The connection is over.
    pub fn take(
        &mut self,
        bytes: &[u8],
        machines: &Machines,
        at: Moment,
        now: Duration,
    ) -> Result<(), Trouble> {
        if !bytes.is_empty() {
            let mut has = None;
            for said in self.client.take(bytes, now).map_err(Trouble::Broker)? {
                match said {
                    Said::Accepted => {
                        self.accepted = true;
                        self.client.subscribe(&self.names.orders(), now);
                        match &self.host {
                            Some(host) => self.client.subscribe(host.topic(), now),
                            None => self.births(machines, at, now).map_err(Trouble::Store)?,
                        }
                    }
                    Said::Has(number) => has = has.max(Some(number)),
                    Said::Message { topic, payload, .. } => {
                        if self.born && self.session.asks_for_births(&topic, &payload) {
                            self.births(machines, at, now).map_err(Trouble::Store)?;
                        }
                        if let Some(host) = &mut self.host {
                            host.take(&topic, &payload);
                        }
                    }
                    Said::Huge(topic) => {
                        if !std::mem::replace(&mut self.had_huge, true) {
                            self.huge = Some(topic);
                        }
                    }
                    Said::Subscribed | Said::Alive => {}
                }
            }
            if let Some(number) = has {
                self.store.acknowledge(number).map_err(Trouble::Store)?;
            }
        }
        match self.host.as_ref().map(Host::is_online) {
            Some(true) if !self.born => {
                self.births(machines, at, now).map_err(Trouble::Store)?;
            }
            Some(false) if self.born => return Err(Trouble::Host),
            _ => {}
        }
        if self.born {
            self.hand(machines, at, now).map_err(Trouble::Store)?;
        }
        self.client.attend(now).map_err(Trouble::Broker)
    }

    /// The topic of a message that was too large to be read. The first in a connection, once: who sends one may send
    /// thousands.
    pub const fn huge(&mut self) -> Option<String> {
        self.huge.take()
    }

    fn births(&mut self, machines: &Machines, at: Moment, now: Duration) -> Result<(), StoreError> {
        let newest = self.store.figures()?.newest;
        self.born = true;
        for message in self.session.births(at, newest, machines) {
            self.client.publish(message, None, now);
        }
        Ok(())
    }

    fn hand(&mut self, machines: &Machines, at: Moment, now: Duration) -> Result<(), StoreError> {
        let room = WINDOW.saturating_sub(self.client.under_way());
        if room == 0 {
            return Ok(());
        }
        let records = self.store.hand(self.handed, room)?;
        self.empty = records.len() < room;
        for record in records {
            self.handed = record.number;
            let messages = self.session.data(at, &record, machines);
            let last = messages.len().saturating_sub(1);
            for (place, message) in messages.into_iter().enumerate() {
                let number = (place == last).then_some(record.number);
                self.client.publish(message, number, now);
            }
        }
        if self.empty {
            for message in self.session.settle(at, machines) {
                self.client.publish(message, None, now);
            }
        }
        Ok(())
    }

    /// Gives the broker the sets that it has not been given, where there is room. [`Sending::take`] has filled that with
    /// records before: where one waits, there is none.
    pub fn retain(&mut self, sets: &Sets, now: Duration) {
        if !self.born {
            return;
        }
        for (machine, number, payload) in sets.iter() {
            if self.client.under_way() >= WINDOW {
                return;
            }
            if self.sets.get(machine) != Some(&number) {
                self.sets.insert(machine.to_owned(), number);
                let (topic, payload) = (self.names.set(machine), payload.to_vec());
                self.client.retain(Message { topic, payload }, now);
            }
        }
    }

    /// The death that the broker would tell, told in time, and the end.
    fn farewell(&mut self, now: Duration) {
        if self.born {
            let death = self.session.death();
            self.client.publish(death, None, now);
        }
        self.client.disconnect();
    }
}
