//! A simulated machine whose power comes and goes while its axes stay: the switches that it is fitted with, and where its
//! axes stand. Must not know what the board makes of them.

use leadscrew_core::bus::Scale;
use leadscrew_core::call::Position;
use leadscrew_core::params::{BY_DRIVE, Params};
use leadscrew_core::units::{Angle, Axis, Length};

use crate::plant::{HomingOptions, Plant};

/// Gives the drive of each axis that homes by itself its reference switch.
pub fn fit_switches(plant: &mut Plant, params: &Params) {
    for axis in Axis::ALL {
        if let Some(options) = switch(axis, params) {
            let drive = plant.drive(axis);
            drive.set_homing(options);
            drive.set_homing_method(HomingOptions::OFF_THE_PLUS_END);
        }
    }
}

/// The reference switch of an axis whose drive homes by itself: at the plus end, with its edge at the position of the mark
/// [D310].
#[must_use]
pub fn switch(axis: Axis, params: &Params) -> Option<HomingOptions> {
    let scale = Scale::new(params.drive_numerator(axis), params.drive_denominator(axis))?;
    let mark = scale.increments(params.home_position(axis))?;
    (params.home_method(axis) == BY_DRIVE).then(|| HomingOptions::at_plus_end(mark.get().into()))
}

/// Where the axes stand, whatever their drives count.
pub fn places(plant: &Plant, params: &Params) -> Option<Position> {
    let at = |axis| plant.place(params, axis);
    Some(Position {
        x: Length::from_nm(at(Axis::X)?),
        z: Length::from_nm(at(Axis::Z)?),
        c: Angle::from_udeg(at(Axis::C)?),
    })
}
