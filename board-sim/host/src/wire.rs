//! The board's side of the bus, with the noise that was asked for.

use std::time::Duration;

use leadscrew::failure::{Failure, Outcome};
use leadscrew::words::Both;
use leadscrew_can::{Address, BitRate, Can, Received};
use leadscrew_core::bus::Frame;
use leadscrew_core::params::Params;

use crate::when::Loss;

/// A bus that may lose frames.
pub struct Wire {
    can: Box<dyn Can>,
    heard: Vec<Received>,
    loss: Loss,
    /// State of a linear congruential generator: the same losses for the same seed.
    noise: u64,
    /// Frames sent, received, and lost by intent.
    pub counts: [u64; 3],
}

impl Wire {
    /// Opens the bus; an adapter at the bit rate of the parameters (9020).
    pub fn open(address: &Address, params: &Params, loss: Loss, seed: u64) -> Outcome<Self> {
        let kbit = params.bus_kbit();
        let rate = BitRate::of_kbit(kbit).ok_or_else(|| {
            Failure::WrongBecause(Both::same(format!("no adapter has {kbit} kbit/s (9020)")))
        })?;
        Ok(Self {
            can: leadscrew_can::open(address, rate).map_err(Failure::bus)?,
            heard: Vec::new(),
            loss,
            noise: seed,
            counts: [0; 3],
        })
    }

    /// What the user called it.
    pub fn name(&self) -> &str {
        self.can.name()
    }

    /// Sends these.
    pub fn send(&mut self, frames: &[Frame]) -> Outcome {
        if frames.is_empty() {
            return Ok(());
        }
        let [sent, ..] = &mut self.counts;
        *sent += frames.len() as u64;
        self.can.send(frames).map_err(Failure::bus)
    }

    /// Waits for something at most so long, and hands each CANopen frame on; how many these were.
    pub fn listen(&mut self, patience: Duration, mut to: impl FnMut(&Frame)) -> Outcome<usize> {
        self.heard.clear();
        self.can
            .receive(&mut self.heard, patience)
            .map_err(Failure::bus)?;
        let mut count = 0;
        let [_, received, lost] = &mut self.counts;
        for heard in &self.heard {
            // Other kinds of frames are nothing that a node of CANopen hears.
            let Some(frame) = heard.packet.frame() else {
                continue;
            };
            *received += 1;
            self.noise = self
                .noise
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            if (self.noise >> 33) % 1000 < u64::from(self.loss.0) {
                *lost += 1;
                continue;
            }
            to(frame);
            count += 1;
        }
        Ok(count)
    }

    /// Frames that found the receive buffer full.
    pub fn dropped(&self) -> u64 {
        self.can.dropped().unwrap_or(0)
    }
}
