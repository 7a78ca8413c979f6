//! Error frames: which faults they tell, whose frames they came with, and the counters of the controller.

use std::collections::BTreeMap;
use std::time::Duration;

use leadscrew_can::{ErrorFrame, Fault, Packet, Stamp};
use leadscrew_core::bus::NodeId;

use crate::doctor::hits::Hits;

/// A frame that follows an error frame within this time is the one that was disturbed, sent again.
const AGAIN: Duration = Duration::from_millis(2);

/// What error frames have told.
#[derive(Clone, Debug, Default)]
pub struct Errors {
    /// A frame broke the rules of the line.
    pub line: Hits,
    /// Those of them behind which a frame of this node came.
    pub with: BTreeMap<NodeId, u64>,
    /// Nobody acknowledged.
    pub no_acknowledge: Hits,
    /// Frames of others that came behind the first such report.
    pub heard_since: u64,
    /// This computer's controller is error passive.
    pub passive: Hits,
    /// It is bus-off.
    pub bus_off: Hits,
    /// The highest counters, sending and receiving, at first and later.
    pub counters: Option<[(u8, u8); 2]>,
    pending: Option<Stamp>,
}

impl Errors {
    /// An error frame.
    pub fn note(&mut self, at: Stamp, error: &ErrorFrame, packet: &Packet) {
        if let Some((tx, rx)) = error.counters() {
            let [_, most] = self.counters.get_or_insert([(tx, rx); 2]);
            *most = (most.0.max(tx), most.1.max(rx));
        }
        let mut on_line = false;
        let mut unacknowledged = false;
        for fault in error.faults() {
            match fault {
                Fault::NoAcknowledge => unacknowledged = true,
                Fault::Protocol | Fault::BusError => on_line = true,
                Fault::Passive => self.passive.begin(at, packet),
                Fault::BusOff => self.bus_off.begin(at, packet),
                Fault::Active => self.passive.end(at),
                Fault::Restarted => self.bus_off.end(at),
                Fault::TransmitTimeout
                | Fault::LostArbitration
                | Fault::ControllerOverflow
                | Fault::Warning
                | Fault::Transceiver => {}
            }
        }
        // A missing acknowledgement is told as an error on the line, too.
        if unacknowledged {
            self.no_acknowledge.go_on(at, packet);
        } else if on_line {
            self.line.hit(at, packet);
            self.pending = Some(at);
        }
    }

    /// A good frame of this node; `None`: it does not say whose.
    pub fn good(&mut self, at: Stamp, from: Option<NodeId>) {
        if let Some(pending) = self.pending.take()
            && at.since(pending) <= AGAIN
            && let Some(node) = from
        {
            *self.with.entry(node).or_default() += 1;
        }
        if let Some(node) = from
            && node != NodeId::GATEWAY
        {
            self.heard_since += u64::from(self.no_acknowledge.count > 0);
            self.no_acknowledge.end(at);
            self.bus_off.end(at);
        }
    }

    /// Nothing comes any more.
    pub fn close(&mut self, at: Stamp) {
        for hits in [
            &mut self.no_acknowledge,
            &mut self.passive,
            &mut self.bus_off,
        ] {
            hits.end(at);
        }
    }
}
