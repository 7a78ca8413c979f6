//! What a ticker needs of a parameter set.

use super::home::Wanted;
use super::limits::Switches;
use super::search::Switch;
use super::surface;
use crate::motion::{Arrival, AxisTravel};
use crate::params::Params;
use crate::spindle::{Learner, Observer};
use crate::tick::drives::Figures;
use crate::tick::gear::Gears;
use crate::tick::machine::Wiring;
use crate::tick::stored::Found;
use crate::tick::turret::Changer;
use crate::units::{Axis, Ticks};
use crate::zones::Zones;

/// All that a ticker needs of a parameter set, checked. The background makes it, because that takes longer than a tick may
/// [D131].
#[derive(Clone, Copy, Debug)]
pub struct Setup {
    pub(super) given: Given,
    /// An observer that has seen nothing yet.
    pub(super) observer: Observer,
    /// What learns the angle that it says, where the encoder has few counts.
    pub(super) learner: Option<Learner>,
    pub(super) figures: Figures,
    pub(super) found: Found,
}

impl Setup {
    /// What a parameter set says. `found`: the state of the stored parameters; where it is an alarm, the ticker withholds
    /// motion. `None` where the set cannot work (a scale or a tick of zero); the checks of the parameter set refuse such a
    /// set.
    #[inline(never)]
    #[must_use]
    pub fn of(params: &Params, found: Found) -> Option<Self> {
        let observer = Observer::new(
            params.encoder_counts(),
            params.observer_bandwidth_hz(),
            params.tick_us(),
        );
        let given = Given::of(params)?;
        Some(Self {
            observer: observer.for_ramp(params.spindle_ramp_ms()),
            learner: params
                .tracker()
                .map(|tracker| Learner::new(tracker, given.ahead_x, given.ahead_z)),
            given,
            figures: Figures::of(params)?,
            found,
        })
    }
}

/// Values from the parameters.
#[derive(Clone, Copy, Debug)]
pub(super) struct Given {
    /// Time from the sample to the instant at which a setpoint takes effect, on X and on Z.
    pub ahead_x: Ticks,
    pub ahead_z: Ticks,
    pub arrival: Arrival,
    /// The travel of the axes that can be moved by hand.
    pub travel_x: AxisTravel,
    pub travel_z: AxisTravel,
    /// The zones that the tip of the tool may not enter.
    pub zones: Zones,
    /// Ticks in a second.
    pub second: u32,
    /// Leaving position mode waits for RGTAP = 0 (5200.2).
    pub waits_for_rgtap: bool,
    pub edge_time: bool,
    pub hold_retracts: bool,
    /// The most that a command under constant surface speed changes to the next, thousandths of a turn per minute.
    pub surface_step: u32,
    pub home: Wanted,
    /// The switches at the board by which X and Z find their references.
    pub switches: [Option<Switch>; 2],
    pub limits: Switches,
    pub wiring: Wiring,
    pub gears: Gears,
    /// Highest speed of spindle 1, in turns per minute.
    pub most_rpm: u32,
    pub changer: Changer,
}

impl Given {
    /// `None` for a tick of zero length.
    fn of(params: &Params) -> Option<Self> {
        let tick_us = params.tick_us();
        let ticks_per_minute = 60_000_000_u32.checked_div(tick_us)?;
        let ramp_ms = u64::from(params.spindle_ramp_ms())
            .saturating_mul(u64::from(params.spindle_max_rpm()))
            / 1000;
        // Twice the time from rest to the highest speed, plus a second.
        let speed_ticks = ramp_ms
            .saturating_mul(2)
            .saturating_add(1000)
            .saturating_mul(u64::from(ticks_per_minute / 60))
            / 1000;
        let ahead = |axis| Ticks::one_and(params.latency_us(axis), tick_us);
        Some(Self {
            ahead_x: ahead(Axis::X),
            ahead_z: ahead(Axis::Z),
            arrival: Arrival {
                tolerance_percent: params.spindle_tolerance_percent(),
                speed_ticks: u32::try_from(speed_ticks).unwrap_or(u32::MAX),
                ticks_per_minute,
            },
            travel_x: AxisTravel::of(params, Axis::X),
            travel_z: AxisTravel::of(params, Axis::Z),
            zones: Zones::of(params),
            second: ticks_per_minute / 60,
            waits_for_rgtap: params.tap_wait_rgtap(),
            edge_time: params.encoder_edge_time(),
            hold_retracts: params.thread_hold_retracts(),
            surface_step: surface_step(params),
            home: Wanted::of(params),
            switches: [Axis::X, Axis::Z].map(|axis| Switch::of(params, axis)),
            limits: Switches::of(params),
            wiring: Wiring::of(params),
            gears: Gears::of(params),
            most_rpm: params.spindle_max_rpm(),
            changer: Changer::of(params),
        })
    }
}

/// 1000 rpm in the time of 9004.
fn surface_step(params: &Params) -> u32 {
    let step = params.tick_us().saturating_mul(1000 * surface::TICKS);
    step.checked_div(params.spindle_ramp_ms())
        .unwrap_or(1)
        .max(1)
}
