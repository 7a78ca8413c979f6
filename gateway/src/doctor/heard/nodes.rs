//! Nodes: what each has sent, its boot-ups, heartbeats and emergencies, and what NMT has told it.

use std::collections::BTreeMap;
use std::time::Duration;

use leadscrew_can::{Packet, Stamp};
use leadscrew_core::bus::{Emcy, NmtCommand, NmtState};

use crate::doctor::hits::Hits;

/// Two boot-ups closer than this are those of two nodes.
const TWINS: Duration = Duration::from_millis(500);
/// A boot-up after an NMT reset comes within this time.
const RESET: Duration = Duration::from_secs(5);
/// A node that waits for NMT start longer than this has been forgotten.
const START: Duration = Duration::from_secs(2);
/// Times between heartbeats that are kept.
const GAPS: usize = 4096;

/// What was heard of a node.
#[derive(Clone, Debug, Default)]
pub struct Node {
    /// Frames that it has sent.
    pub frames: u64,
    /// Those of CAN FD that say that it is error passive.
    pub passive: Hits,
    /// The first and the last of them.
    pub first: Option<Stamp>,
    /// See `first`.
    pub last: Option<Stamp>,
    /// What was sent to it: setpoints and SDO requests.
    pub asked: Hits,
    /// Heartbeats, without boot-ups.
    pub beats: u64,
    /// Times between two heartbeats.
    pub gaps: Vec<(Stamp, Duration)>,
    /// Boot-ups.
    pub boots: Vec<Stamp>,
    /// Two boot-ups at once.
    pub twins: Hits,
    /// Boot-ups that no NMT reset has asked for.
    pub unasked: Hits,
    /// It waits for NMT start.
    pub waits: Hits,
    /// It is stopped.
    pub stopped: Hits,
    /// Emergencies by code.
    pub emergencies: BTreeMap<u16, Hits>,
    last_beat: Option<Stamp>,
    reset: Option<Stamp>,
    /// When it last came to the state in which it waits for a start.
    waiting: Option<Stamp>,
    state: Option<NmtState>,
}

impl Node {
    /// It has sent a frame.
    pub fn sent(&mut self, at: Stamp) {
        self.frames += 1;
        self.first.get_or_insert(at);
        self.last = Some(at);
    }

    /// It was told this by NMT.
    pub fn told(&mut self, at: Stamp, command: NmtCommand) {
        match command {
            NmtCommand::ResetNode | NmtCommand::ResetCommunication => {
                self.reset = Some(at);
                self.twins.end(at);
            }
            NmtCommand::Start => {
                self.waiting = None;
                self.waits.end(at);
            }
            NmtCommand::Stop | NmtCommand::PreOperational => {}
        }
    }

    /// A heartbeat or boot-up of it. `waits_counts`: a node that waits is a sign by itself.
    pub fn beat(&mut self, at: Stamp, state: NmtState, packet: &Packet, waits_counts: bool) {
        if state == NmtState::BootUp {
            self.boot(at, packet);
            return;
        }
        self.beats += 1;
        if let Some(last) = self.last_beat.replace(at)
            && self.gaps.len() < GAPS
        {
            self.gaps.push((at, at.since(last)));
        }
        match state {
            NmtState::PreOperational => {
                let since = *self.waiting.get_or_insert(at);
                if at.since(since) > START && waits_counts {
                    self.waits.go_on(at, packet);
                }
            }
            _ => {
                self.waiting = None;
                self.waits.end(at);
            }
        }
        match state {
            NmtState::Stopped => self.stopped.go_on(at, packet),
            _ => self.stopped.end(at),
        }
        self.state = Some(state);
    }

    fn boot(&mut self, at: Stamp, packet: &Packet) {
        let asked = self.reset.is_some_and(|reset| at.since(reset) <= RESET);
        let before = self.boots.last().copied();
        self.boots.push(at);
        self.waiting = Some(at);
        self.last_beat = None;
        // Its emergencies are over with it.
        for hits in self.emergencies.values_mut() {
            hits.end(at);
        }
        if asked {
            return;
        }
        match before {
            Some(before) if at.since(before) <= TWINS => self.twins.begin(at, packet),
            _ => {
                self.twins.end(at);
                self.unasked.hit(at, packet);
            }
        }
    }

    /// An emergency of it.
    pub fn emergency(&mut self, at: Stamp, emergency: &Emcy, packet: &Packet) {
        if emergency.code == 0 {
            for hits in self.emergencies.values_mut() {
                hits.end(at);
            }
        } else {
            let hits = self.emergencies.entry(emergency.code).or_default();
            hits.go_on(at, packet);
        }
    }

    /// Something is wanted of it, and by its last heartbeat it waits for a start.
    pub fn wanted(&mut self, at: Stamp, packet: &Packet) {
        if self.state == Some(NmtState::PreOperational) && self.waiting.is_some() {
            self.waits.hit(at, packet);
        }
    }

    /// Nothing comes any more.
    pub fn close(&mut self, at: Stamp) {
        for hits in [&mut self.twins, &mut self.waits, &mut self.stopped] {
            hits.end(at);
        }
        for hits in self.emergencies.values_mut() {
            hits.end(at);
        }
    }
}
