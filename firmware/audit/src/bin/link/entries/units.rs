//! Quantities.

use audit::any::{any, sink};
use leadscrew_core::call::{FeedRate, start_angle};
use leadscrew_core::units::{
    Angle, Diameter, Direction, Divisor, Lead, Length, StartAngle, Turns, mul_div,
};

/// Calls all entries of this module.
pub fn all() {
    lead();
    feed();
    angles();
    lengths();
    directions();
    division();
}

#[inline(never)]
fn lead() {
    if let Some(lead) = Lead::new(any(), any()) {
        sink((lead.numerator(), lead.denominator(), lead.rounded()));
    }
}

#[inline(never)]
fn feed() {
    sink(any::<FeedRate>().nominal());
}

#[inline(never)]
fn angles() {
    sink(start_angle(any(), any()).turns());
    sink(any::<StartAngle>().turns());
    sink(any::<Angle>() + any() - -any::<Angle>());
    sink(any::<Turns>() + any() - -any::<Turns>());
    sink(Turns::whole(any()));
}

#[inline(never)]
fn lengths() {
    let length: Length = any();
    sink(length + any() - -any::<Length>());
    sink((
        length.abs(),
        length.signum(),
        length.times(any()),
        length.is_in_range(),
    ));
    sink(Diameter::of_radius(any()).radius());
}

#[inline(never)]
fn directions() {
    sink(Direction::of_vector(any(), any()));
    sink(Direction::of_turns(any()).turned(any()).sin_cos());
}

#[inline(never)]
fn division() {
    sink(Divisor::new(any()).divide(any()));
    sink(mul_div(any(), any(), any()));
}
