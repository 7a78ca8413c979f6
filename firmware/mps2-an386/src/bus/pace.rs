//! When a tick may run.
//!
//! In virtual time. The simulated board in lock-step has the same rules.
//!
//! - A tick waits for the program: while more of it is to come and there is room for it, time stands still.
//! - A tick waits for the gateway's heartbeat where the machine would run ahead of it: a living gateway is not lost.
//! - A machine with nothing to do runs whole turns of the SYNC counter, 240 ticks each, in real time. So every program
//!   begins at the same count, and its frames are the same at any time of its start.
//!
//! In real time (`time=real`) a tick comes at each of its times, at the speed that the hand says. A host that is too slow
//! lets time slip, and a program that is late is waited for as in virtual time.

use leadscrew_core::board::{BackgroundSide, State};
use leadscrew_core::bus::SyncProducer;
use leadscrew_core::params::Params;

use crate::clock::Clock;
use crate::hand::Hand;
use crate::interrupts;
use crate::outside::Outside;
use crate::watchdog;

/// The number of ticks in a turn of the SYNC counter.
const TURN: u64 = SyncProducer::LAST as u64;

/// The longest wait for a program or a gateway, in milliseconds. The host may be slow.
const LOST_MS: u64 = 10_000;

/// Later than this, in microseconds, a tick of real time is not made up for. The thread may sleep for a millisecond.
const LATE_US: u64 = 20_000;

/// The times in the parameters.
#[derive(Clone, Copy, Debug)]
pub struct Times {
    tick_us: u64,
    /// Ticks without a heartbeat after which the gateway counts as lost; 0: never.
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

/// Real time.
struct Real {
    /// The speed of machine time, in thousandths.
    thousandths: u32,
    /// The time of the next tick, in microseconds.
    next: u64,
}

impl Real {
    fn is_due(&mut self, us: u64, tick_us: u64) -> bool {
        let Some(late) = us.checked_sub(self.next) else {
            return false;
        };
        if late > LATE_US {
            self.next = us;
        }
        self.next += tick_us * 1000 / u64::from(self.thousandths);
        true
    }
}

/// The state on which time depends.
pub struct Pace {
    clock: Clock,
    /// `None` in virtual time.
    real: Option<Real>,
    times: Times,
    ticks: u64,
    /// Ticks up to and including tick 0: the first tick in which the machine is up and stands.
    up: Option<u64>,
    /// The tick of the gateway's newest heartbeat, and its real time.
    beat: Option<(u64, u64)>,
    /// The time when the wait for the program began.
    waits_since: Option<u64>,
    /// The time of the last tick.
    last: u64,
}

impl Pace {
    pub fn new(params: &Params, real: bool) -> Self {
        Self {
            clock: Clock::new(),
            real: real.then_some(Real {
                thousandths: 1000,
                next: 0,
            }),
            times: Times::of(params),
            ticks: 0,
            up: None,
            beat: None,
            waits_since: None,
            last: 0,
        }
    }

    /// The main loop of the thread.
    pub fn run(
        mut self,
        mut background: BackgroundSide<'static>,
        outside: &mut Outside,
        hand: &mut Hand,
    ) -> ! {
        loop {
            let us = self.clock.us();
            let now = us / 1000;
            if let Some(thousandths) = hand.pump(now)
                && let Some(real) = &mut self.real
            {
                *real = Real {
                    thousandths,
                    next: us,
                };
            }
            let came = outside.pump(now);
            if outside.has_heard_gateway() {
                self.beat = Some((self.ticks, now));
            }
            if leadscrew_app::step(&mut background, outside) || came {
                continue;
            }
            if let Some(times) = outside.new_times() {
                self.times = times;
            }
            if outside.takes_tick() && self.is_due(&background, us) {
                interrupts::tick();
                self.ticks += 1;
                self.last = now;
                if self.up.is_none() && background.state().snapshot().state == State::Idle {
                    // This is the tick after the machine has come up: the axes stand, and nothing was handed over yet.
                    self.up = Some(self.ticks);
                }
            } else {
                // Time stands still on purpose: the board does not hang.
                watchdog::feed();
                if outside.is_quiet() {
                    // A byte or the next millisecond ends this wait.
                    cortex_m::asm::wfi();
                }
            }
        }
    }

    fn is_due(&mut self, background: &BackgroundSide<'_>, us: u64) -> bool {
        let now = us / 1000;
        if self.real.is_some() && self.waits_for_program(background, now) {
            return false;
        }
        if let Some(real) = &mut self.real {
            return real.is_due(us, self.times.tick_us);
        }
        let Some(up) = self.up else {
            // While the machine comes up, a tick takes a millisecond at least, as the drives need.
            return now > self.last;
        };
        let snapshot = background.state().snapshot();
        let busy = background.is_busy() || snapshot.in_program;
        if busy || !self.ticks.wrapping_sub(up).is_multiple_of(TURN) {
            // Without a program a gateway may come and go.
            let outruns = snapshot.in_program && self.outruns_gateway(now);
            if self.waits_for_program(background, now) || outruns {
                return false;
            }
            // Only a person ends a hold.
            return snapshot.state != State::Held || now > self.last;
        }
        (now - self.last) * 1000 >= TURN * self.times.tick_us
    }

    fn waits_for_program(&mut self, background: &BackgroundSide<'_>, now: u64) -> bool {
        if !background.state().awaits_program() {
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
