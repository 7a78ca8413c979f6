//! A simulated machine whose power comes and goes while its axes stay: the switches that it is fitted with, and where its
//! axes stand. Must not know what the board makes of them.

use leadscrew_core::bus::Scale;
use leadscrew_core::call::Position;
use leadscrew_core::operating::Towards;
use leadscrew_core::params::{BY_DRIVE, HomeSwitch, Params};
use leadscrew_core::units::{Angle, Axis, Length};

use crate::around::OVERRUN_NM;
use crate::plant::{HomingOptions, Plant};

/// Gives each axis its switches that are wired to its drive.
pub fn fit_switches(plant: &mut Plant, params: &Params) {
    for axis in Axis::ALL {
        if let Some(options) = switch(axis, params) {
            let drive = plant.drive(axis);
            drive.set_homing(options);
            drive.set_homing_method(HomingOptions::OFF_THE_PLUS_END);
        }
    }
}

/// The switches of an axis that are wired to its drive: that of its reference, and hard limit switches, which come on 5 mm
/// beyond the travel.
#[must_use]
pub fn switch(axis: Axis, params: &Params) -> Option<HomingOptions> {
    let home = home_switch(axis, params);
    let scale = Scale::new(params.drive_numerator(axis), params.drive_denominator(axis))?;
    let limit = |bit, towards, end: i64| {
        let at_drive = params.limit_switch(axis, towards) == Some(HomeSwitch::Drive(bit));
        let place = scale.increments(end)?.get();
        at_drive.then_some(i64::from(place))
    };
    let beyond = |end: i64, sign: i64| end.saturating_add(OVERRUN_NM.saturating_mul(sign));
    let minus = limit(1, Towards::Minus, beyond(params.soft_limit_minus(axis), -1));
    let plus = limit(2, Towards::Plus, beyond(params.soft_limit_plus(axis), 1));
    if minus.is_none() && plus.is_none() {
        return home;
    }
    let far = HomingOptions::FAR;
    let fitted = home.unwrap_or(far);
    let free = |place, far, end: Option<i64>| {
        if place == far {
            end.unwrap_or(far)
        } else {
            place
        }
    };
    Some(HomingOptions {
        // One by which the axis is homed is where its mark is.
        negative: free(fitted.negative, far.negative, minus),
        positive: free(fitted.positive, far.positive, plus),
        ..fitted
    })
}

/// The reference switch of an axis that is wired to its drive, with its edge at the position of the mark. Of an axis whose
/// drive homes by itself it is a home switch at the plus end [D310]; of one whose switch the board looks for it is the one
/// of 9051, a home switch on the side of 9052.
fn home_switch(axis: Axis, params: &Params) -> Option<HomingOptions> {
    let scale = Scale::new(params.drive_numerator(axis), params.drive_denominator(axis))?;
    let mark = scale.increments(params.home_position(axis))?;
    let mark = i64::from(mark.get());
    if params.home_method(axis) == BY_DRIVE {
        return Some(HomingOptions::at_plus_end(mark));
    }
    let HomeSwitch::Drive(bit) = params.home_switch(axis)? else {
        return None;
    };
    let far = HomingOptions::FAR;
    Some(match bit {
        1 => HomingOptions {
            negative: mark,
            ..far
        },
        2 => HomingOptions {
            positive: mark,
            ..far
        },
        _ => HomingOptions {
            home: match params.home_towards(axis) {
                Some(0) => (far.negative, mark),
                _ => (mark, far.positive),
            },
            ..far
        },
    })
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
