//! A simulated machine whose power comes and goes while its axes stay: the switches that it is fitted with, and where its
//! axes stand. Must not know what the board makes of them.

use leadscrew_core::bus::{Increments, Scale};
use leadscrew_core::call::Position;
use leadscrew_core::params::Params;
use leadscrew_core::units::{Angle, Axis, Length};

use crate::plant::{HomingOptions, Plant};

fn scale(params: &Params, axis: Axis) -> Option<Scale> {
    Scale::new(params.drive_numerator(axis), params.drive_denominator(axis))
}

/// Gives each axis that homes its reference switch, at the plus end, with its edge at the position of the mark [D310].
pub fn fit_switches(plant: &mut Plant, params: &Params) {
    for axis in Axis::ALL {
        let mark = scale(params, axis)
            .and_then(|scale| scale.increments(params.home_position(axis)))
            .filter(|_| params.home_method(axis) != 0);
        if let Some(mark) = mark {
            let drive = plant.drive(axis);
            drive.set_homing(HomingOptions::at_plus_end(mark.get().into()));
            drive.set_homing_method(HomingOptions::OFF_THE_PLUS_END);
        }
    }
}

/// Where the axes stand, whatever their drives count.
pub fn places(plant: &mut Plant, params: &Params) -> Option<Position> {
    let mut at = |axis| {
        let place = i32::try_from(plant.drive(axis).place()).ok()?;
        Some(scale(params, axis)?.position(Increments::new(place)))
    };
    Some(Position {
        x: Length::from_nm(at(Axis::X)?),
        z: Length::from_nm(at(Axis::Z)?),
        c: Angle::from_udeg(at(Axis::C)?),
    })
}
