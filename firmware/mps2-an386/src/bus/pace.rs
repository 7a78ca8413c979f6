//! Virtual time: when a tick may happen. The same rules as those of the simulated board in lock-step.
//!
//! - A tick waits for the program: while more of it is to come and there is room for it, time stands still.
//! - A tick waits for the gateway's heartbeat, where the machine would outrun it: a gateway that is there is not lost.
//! - A machine with nothing to do goes on in turns of the SYNC counter, 240 ticks each, one after another in real time; so
//!   every program begins at the same count, and its frames are the same whenever it is started.

use leadscrew_app::BackgroundSide;
use leadscrew_core::board::State;
use leadscrew_core::bus::SyncProducer;
use leadscrew_core::params::Params;

use crate::clock::Clock;
use crate::interrupts;
use crate::outside::Outside;
use crate::watchdog;

/// Ticks after which the SYNC counter shows the same again.
const TURN: u64 = SyncProducer::LAST as u64;

/// A program or a gateway that does not go on for so many milliseconds is not waited for any more. The host may be slow.
const LOST_MS: u64 = 10_000;

/// What the parameters say of time.
#[derive(Clone, Copy, Debug)]
pub struct Times {
    tick_us: u64,
    /// Ticks without a heartbeat of the gateway after which it counts as lost; 0: never.
    silence: u64,
}

impl Times {
    pub fn of(params: &Params) -> Self {
        let tick_us = u64::from(params.tick_us());
        Self {
            tick_us,
            silence: u64::from(params.gateway_silence_ms()) * 1000 / tick_us,
        }
    }
}

/// What time depends on.
pub struct Pace {
    clock: Clock,
    times: Times,
    ticks: u64,
    /// Ticks up to and with tick 0: the first in which the machine is up and stands.
    up: Option<u64>,
    /// The tick of the gateway's newest heartbeat, and when that was.
    beat: Option<(u64, u64)>,
    /// When the program was waited for first.
    waits_since: Option<u64>,
    /// When the last tick was.
    last: u64,
}

impl Pace {
    pub fn new(params: &Params) -> Self {
        Self {
            clock: Clock::new(),
            times: Times::of(params),
            ticks: 0,
            up: None,
            beat: None,
            waits_since: None,
            last: 0,
        }
    }

    /// The thread.
    pub fn run(mut self, background: &mut BackgroundSide, outside: &mut Outside) -> ! {
        loop {
            let now = self.clock.ms();
            let came = outside.pump(now);
            if outside.has_heard_gateway() {
                self.beat = Some((self.ticks, now));
            }
            if background.step(outside) || came {
                continue;
            }
            if let Some(times) = outside.new_times() {
                self.times = times;
            }
            if outside.takes_tick() && self.is_due(background, now) {
                interrupts::tick();
                self.ticks += 1;
                self.last = now;
                if self.up.is_none() && background.snapshot().state == State::Idle {
                    // The tick after the one that brought it up: the axes stand, and nothing has been handed over yet.
                    self.up = Some(self.ticks);
                }
            } else {
                // Time stands still, and nobody hangs.
                watchdog::feed();
                if outside.is_quiet() {
                    // A byte or the next millisecond ends this.
                    cortex_m::asm::wfi();
                }
            }
        }
    }

    fn is_due(&mut self, background: &BackgroundSide, now: u64) -> bool {
        let Some(up) = self.up else {
            // At the pace of drives.
            return now > self.last;
        };
        let snapshot = background.snapshot();
        let busy = background.is_busy() || snapshot.in_program;
        if busy || !self.ticks.wrapping_sub(up).is_multiple_of(TURN) {
            // Without a program a gateway may come and go.
            let outruns = snapshot.in_program && self.outruns_gateway(now);
            if self.waits_for_program(background, now) || outruns {
                return false;
            }
            // Nothing but a person ends a hold.
            return snapshot.state != State::Held || now > self.last;
        }
        (now - self.last) * 1000 >= TURN * self.times.tick_us
    }

    fn waits_for_program(&mut self, background: &BackgroundSide, now: u64) -> bool {
        if !background.awaits_program() {
            self.waits_since = None;
            return false;
        }
        now - *self.waits_since.get_or_insert(now) < LOST_MS
    }

    fn outruns_gateway(&self, now: u64) -> bool {
        self.beat.is_some_and(|(tick, when)| {
            self.times.silence > 0
                && self.ticks - tick > self.times.silence / 2
                && now - when < LOST_MS
        })
    }
}
