//! The lock of a board's own timer to the SYNC of another one.
//!
//! A board that follows does not tick when SYNC comes: a frame on the wire is not stopped, SYNC waits for its end, and an
//! encoder sampled with that jitter has its thread up to 13 µm out of place (135
//! µs, lead 2 mm, 3000 rpm). So its tick stays with its timer, and the timer is led
//! to the *early edge* of the SYNCs, for a wire can only make them late [D167].
//!
//! ```text
//! SYNC as it is meant  │         │         │         │           the early edge, which nobody sees
//! SYNC on the wire     █         │ █       █         │  █        later by what the wire was busy with
//! own beats            ╵         ╵         ╵         ╵           the length of the next period but one is what is set
//! ```
//!
//! How: of the SYNCs in a window of periods the one that came earliest, seen from the own
//! beat next to it, is the error. Half of it is made good over the next window, and a part
//! of it goes to the rate. Windows begin short (8 periods), to pull in, and end long (64),
//! to rest. Lengths are whole steps of the timer; what makes no step yet is carried.
//!
//! What it guarantees, whatever comes in:
//! - a period is within 1/64 and 1/2048 of its nominal length, to a step: there is no jump, not even while it pulls in;
//! - while it is locked, the rate is within 1/2048 (488 ppm) of the nominal one, and a phase is made good by no more than
//!   1/16 384 of a period (61 ppm) in each where SYNC is early, by a quarter of that
//!   where it is late; a SYNC that is more than a quarter of a period away moves nothing,
//!   one that is late among others neither, and without any it goes on at its rate;
//! - it is locked behind six long windows in a row that were at most 1/128 of a period off. It is no more behind two in
//!   a row (128 periods) in which none was near, or the earliest came early by more than 1/16; behind eight in which it
//!   was late by as much, which the wire can do for a while; and where its owner [forgets](SyncLock::forget);
//! - a SYNC that begins in the half of a period before a beat, or in the half behind it, counts for that beat.
//!
//! What it reaches in steps of 1 µs, clocks up to 200 ppm apart, from any phase (tests below): locked after 440 to 1
//! 480 periods, and from then on its beats within 7 µs of the early edge at a period of 1 ms, 11 µs at 2 ms, with SYNC
//! late by anything up to 135 µs, every tenth missing; that is 1.1 µm of a thread of 2 mm at 3000 rpm. Bursts in which
//! every SYNC of 400 periods is 135 µs late move it by 12 µs at 1 ms, 23 µs at 2 ms, 92 µs at 10 ms.
//!
//! What it cannot know: a wire on which no SYNC of 64 periods is in time has an edge that is later. What delays each
//! one for seconds is followed slowly, and where it then ends, SYNC is early for all the lock knows.
//!
//! Knows no timer and no frame; stamps go in, lengths come out. No division.

use super::sync::{SyncConsumer, SyncHeard};

/// Windows are of 2³ to 2⁶ periods.
const SHORT: u32 = 3;
const LONGER: u32 = 3;
/// So many long windows in a row that are right begin the lock, and so many that are far off end it.
const PROOF: i32 = 6;
const PATIENCE: i32 = -8;
/// For so many of them counts one whose SYNC cannot be late by the wire.
const OTHER: i32 = 4;
/// Bits of a fraction of a step.
const FRACTION: u32 = 14;
/// Steps behind its beat that no SYNC near it can be: half a period is less.
const LATEST: i32 = 1 << 15;

/// Leads a timer to the SYNCs of somebody else.
// All zero where nothing has come: of one in a static there is nothing in the flash of a chip.
#[derive(Clone, Copy, Debug)]
pub struct SyncLock {
    /// Steps of a nominal period, of the one under way, and of the one behind it.
    nominal: i32,
    running: i32,
    next: i32,
    /// What is to be added to each period, in 1/16 384 of a step: for the rate, and for the phase; and what of both has not
    /// made a step yet.
    rate: i32,
    slew: i32,
    rest: i32,
    /// Of those near their beat in this window the SYNC that came earliest, in
    /// steps before the [`LATEST`] there can be; zero where there was none.
    earliest: i32,
    /// Periods of this window so far.
    at: u32,
    /// How much longer than short a window is, as a power of two.
    longer: u32,
    /// Long windows in a row that were right; below zero, windows that were far off.
    right: i32,
    locked: bool,
    consumer: SyncConsumer,
    /// SYNCs of the last beat and of the one to come, and what was missing before those since the last beat.
    count: u8,
    early: u8,
    missed: u8,
}

impl SyncLock {
    /// For nominal periods of so many steps of the timer; it runs freely at first.
    #[must_use]
    pub const fn new(nominal_steps: u16) -> Self {
        let nominal = nominal_steps as i32;
        Self {
            nominal,
            running: nominal,
            next: nominal,
            rate: 0,
            slew: 0,
            rest: 0,
            earliest: 0,
            at: 0,
            longer: 0,
            right: 0,
            locked: false,
            consumer: SyncConsumer::new(),
            count: 0,
            early: 0,
            missed: 0,
        }
    }

    /// A SYNC that has been read began so many steps behind the last own beat, or before it. Before half a period it
    /// counts for that beat, from there on for the next.
    pub fn hear(&mut self, since_steps: i32, counter: Option<u8>) {
        let half = self.nominal >> 1;
        let (count, offset) = match since_steps < half {
            true => (&mut self.count, since_steps),
            false => (&mut self.early, since_steps.wrapping_sub(self.running)),
        };
        *count = count.saturating_add(1);
        let missed = self.consumer.count(counter).missed;
        self.missed = self.missed.saturating_add(missed);
        let gate = if self.locked { half >> 1 } else { half };
        if (gate.wrapping_neg()..=gate).contains(&offset) {
            self.earliest = self.earliest.max(LATEST.wrapping_sub(offset));
        }
    }

    /// The own beat: all SYNCs heard before it have been given. What the beat before it has brought.
    pub fn beat(&mut self) -> SyncHeard {
        let heard = SyncHeard {
            count: core::mem::replace(&mut self.count, core::mem::take(&mut self.early)),
            missed: core::mem::take(&mut self.missed),
            locked: self.locked,
        };
        self.at = self.at.wrapping_add(1);
        if self.at.wrapping_shr(self.width()) > 0 {
            self.judge();
        }
        self.running = self.next;
        let rest = self.rest.wrapping_add(self.rate).wrapping_add(self.slew);
        self.next = self.nominal.wrapping_add(rest >> FRACTION);
        self.rest = rest & ((1 << FRACTION) - 1);
        heard
    }

    /// The SYNC of the beat that has begun has come already.
    #[must_use]
    pub const fn is_early(&self) -> bool {
        self.count > 0
    }

    /// There was no SYNC for longer than can be borne: the next may have any phase.
    /// The lock begins again, at the rate it had.
    pub const fn forget(&mut self) {
        self.longer = 0;
        self.right = 0;
        self.locked = false;
    }

    /// Steps of the nominal period.
    #[must_use]
    pub const fn nominal_steps(&self) -> u16 {
        self.nominal as u16
    }

    /// Steps of the period behind the one that has begun with the last beat.
    #[must_use]
    pub const fn next_steps(&self) -> u32 {
        self.next.cast_unsigned()
    }

    /// Periods of a window as a power of two.
    const fn width(&self) -> u32 {
        self.longer.wrapping_add(SHORT)
    }

    /// The end of a window.
    #[cold]
    #[inline(never)]
    fn judge(&mut self) {
        self.at = 0;
        self.slew = 0;
        let nominal = self.nominal << FRACTION;
        let earliest = core::mem::take(&mut self.earliest);
        let mut error = LATEST.wrapping_sub(earliest) << FRACTION;
        let away = error.wrapping_abs();
        let is_near = earliest > 0 && away <= nominal >> 4;
        if !is_near {
            // Late may be the wire, for a while. Early, or none near, is another beat.
            let is_other = error.cast_unsigned() >= (LATEST << FRACTION).cast_unsigned();
            let far = if is_other { OTHER } else { 1 };
            self.right = self.right.min(0).wrapping_sub(far);
            if !self.locked || self.right <= PATIENCE {
                self.forget();
            }
        } else if away > nominal >> 7 {
            self.right = 0;
        } else if self.longer < LONGER {
            self.longer = self.longer.wrapping_add(1);
        } else {
            self.right = self.right.max(0).wrapping_add(1).min(PROOF);
            self.locked |= self.right == PROOF;
        }
        if earliest == 0 {
            return;
        }
        let mut part = 3;
        let mut most = nominal >> 2;
        if self.locked {
            // Late may be the wire, early is they.
            error = error.min(nominal >> 9);
            most = nominal >> 7;
            part = 4;
        }
        error = within(error, most).wrapping_shr(self.width());
        self.slew = error >> 1;
        if is_near {
            let rate = self.rate.wrapping_add(error >> part);
            self.rate = within(rate, nominal >> 11);
        }
    }
}

/// A value no further from zero than `most`, which is not negative.
fn within(value: i32, most: i32) -> i32 {
    value.min(most).max(most.wrapping_neg())
}

#[cfg(test)]
mod tests;
