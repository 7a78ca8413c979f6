//! The observer; a step is a tick.

use leadscrew_core::params::Params;
use leadscrew_core::spindle::{EncoderSample, Observer, SpindleEvent};
use leadscrew_core::units::{Rpm, Ticks, TurnRate, Turns};

use super::Work;

/// The speed of all works with a spindle.
const SPINDLE: Rpm = Rpm::new(300);
const TICKS_PER_TURN: usize = 200;

/// The spindle's speed.
pub fn speed() -> TurnRate {
    TurnRate::of_rpm(SPINDLE)
}

/// The spindle's angle at tick `number`.
pub fn angle(number: usize) -> Turns {
    Turns::from_raw(number as i64 * Turns::ONE.raw() / TICKS_PER_TURN as i64)
}

/// An encoder with the time of the last edge and one index a turn, at constant speed. The angle is asked for one tick
/// later, as in a thread.
pub struct Tracking(Params);

impl Tracking {
    /// The work.
    pub fn at_300_rpm() -> Self {
        Self(Params::sheets())
    }
}

impl Work for Tracking {
    type State = Observer;
    type Out = (Option<SpindleEvent>, Turns);

    fn steps(&self) -> usize {
        2000
    }

    fn begin(&self) -> Observer {
        Observer::new(
            self.0.encoder_counts(),
            self.0.observer_bandwidth_hz(),
            self.0.tick_us(),
        )
    }

    fn step(&self, observer: &mut Observer, number: usize) -> Self::Out {
        let counts = self.0.encoder_counts();
        let turn = (number / TICKS_PER_TURN) as i32 * counts as i32;
        let event = observer.tick(EncoderSample {
            count: turn
                + ((number % TICKS_PER_TURN) as u32 * counts / TICKS_PER_TURN as u32) as i32,
            edge_age_ns: Some(7 * (number as u32 % 7000)),
            index: (number % TICKS_PER_TURN == 100).then_some(turn),
        });
        (event, observer.predict(Ticks::ONE))
    }
}
