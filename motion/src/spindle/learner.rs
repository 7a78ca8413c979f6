//! The learned angle of a spindle whose encoder has few counts, at the instants at which setpoints take effect.
//!
//! A pass asks for these angles several times in a tick, and its judge once more. So they are worked out once in each tick
//! of a pass. This module knows the two instants, and nothing of what follows them.

use leadscrew_spindle::{Prediction, Tracker};

use super::Observer;
use crate::units::{Rpm, Ticks, TurnRate, Turns};

/// A tracker, and the angles that it predicts.
#[derive(Clone, Copy, Debug)]
pub struct Learner {
    tracker: Tracker,
    /// What the spindle is told.
    commanded: Rpm,
    ahead: [Ticks; 2],
    /// At the instants at which setpoints of X and of Z take effect.
    at: [Prediction; 2],
}

impl Learner {
    /// A learner that has seen nothing yet, for setpoints that take effect `ahead_x` and `ahead_z` after the sample.
    #[must_use]
    pub fn new(tracker: Tracker, ahead_x: Ticks, ahead_z: Ticks) -> Self {
        Self {
            tracker,
            commanded: Rpm::STOPPED,
            ahead: [ahead_x, ahead_z],
            at: [Prediction::default(); 2],
        }
    }

    /// Takes the speed that the spindle is told. Where it is another one, the spindle has to be learned at that speed
    /// before a pass begins: what arrives within its tolerance is still on its way, and a tracker is slow.
    pub fn expect(&mut self, commanded: Rpm) {
        if commanded != self.commanded {
            self.commanded = commanded;
            self.tracker.expect_other_speed();
        }
    }

    /// Takes what the tick shows: the observer after it, and the age of the last edge. `anew`: the angle has got another
    /// zero. The predicted angles are those of this tick where they are `wanted`.
    #[cold]
    #[inline(never)]
    pub fn tick(
        &mut self,
        observer: &Observer,
        edge_age_ns: Option<u32>,
        anew: bool,
        wanted: bool,
    ) {
        self.tracker.tick(&observer.look(edge_age_ns), anew);
        if wanted {
            let [ahead_x, ahead_z] = self.ahead;
            let on_z = self.tracker.predict(ahead_z.raw());
            let on_x = if ahead_x == ahead_z {
                on_z
            } else {
                self.tracker.predict(ahead_x.raw())
            };
            self.at = [on_x, on_z];
        }
    }

    /// The tracker.
    #[must_use]
    pub const fn tracker(&self) -> &Tracker {
        &self.tracker
    }

    /// The angle at the instant at which a setpoint of X (else of Z) takes effect.
    #[must_use]
    pub const fn at(&self, on_x: bool) -> &Prediction {
        let [x, z] = &self.at;
        if on_x { x } else { z }
    }

    /// The same a tick before, and by how much it has grown since the sample.
    #[must_use]
    pub fn before(&self, on_x: bool) -> (Turns, Turns) {
        let [ahead_x, ahead_z] = self.ahead;
        let ahead = if on_x { ahead_x } else { ahead_z };
        let at = self.at(on_x);
        let since = at.grown(ahead.raw()).wrapping_sub(at.learned.speed >> 16);
        (Turns::from_raw(at.before()), Turns::from_raw(since))
    }

    /// The speed at the instant at which a setpoint of X (else of Z) takes effect.
    #[must_use]
    pub fn speed(&self, on_x: bool) -> TurnRate {
        TurnRate::from_raw(self.tracker.speed_at(self.at(on_x)))
    }
}
