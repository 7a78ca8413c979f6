//! The observer.

use audit::any::{any, sink};
use leadscrew_core::spindle::Observer;
use leadscrew_core::units::{Ticks, TurnRate};

/// Calls all entries of this module.
pub fn all() {
    observer();
    rates();
}

#[inline(never)]
fn observer() {
    let mut observer = Observer::new(any(), any(), any()).for_ramp(any());
    while any() {
        sink(observer.tick(any()));
        sink(observer.predict(Ticks::one_and(any(), any())));
        sink((
            observer.angle(),
            observer.speed(),
            observer.indexed(),
            observer.is_turning(),
        ));
    }
}

#[inline(never)]
fn rates() {
    sink(TurnRate::of_rpm(any()).rpm());
    sink((any::<TurnRate>().abs(), any::<TurnRate>().is_negative()));
    sink(Ticks::whole(any()).raw());
}
