//! Drives as they are, in a third of the machines of the soak: those of the profiles that ship, and boards that are set up
//! for them. What the tool cuts behind them is judged once it has settled.

use leadscrew_board_sim::plant::{Interpolation, PlantOptions, Ripple, ServoOptions};
use leadscrew_common::profiles::Profile;
use leadscrew_core::bus::Mode;
use leadscrew_core::call::Position;
use leadscrew_core::params::Params;
use leadscrew_core::units::{Axis, Length};

use super::encoder;
use super::script::Draws;
use crate::params::set;

/// How far a tool at rest may be from where it is told to be, in nanometres: half the play of its screw, and what friction
/// leaves.
pub const AT_REST_NM: i64 = 8_000;

/// True where a machine that has come up again stands at the same place. The board takes it from its drives: ideal ones are
/// where they were told to be. The others are where friction has left them, or where they lost their torque as soon as
/// their setpoint was at rest, which they were still coming to.
pub fn is_kept(params: &Params, options: &PlantOptions, before: Position, after: Position) -> bool {
    let [x, z] = options.servos;
    // All axes are taken anew, to the count of their drives.
    let count = if options.servos == [None; 2] { 0 } else { 100 };
    let near = |axis: Axis, servo: Option<ServoOptions>, one: Length, other: Length| {
        let most = servo.map_or(count, |servo| {
            let started = params.acceleration(axis).nm_per_s2() as f64 * left(&servo);
            AT_REST_NM + started as i64
        });
        (one - other).nm().abs() <= most
    };
    near(Axis::X, x, before.x, after.x)
        && near(Axis::Z, z, before.z, after.z)
        && (before.c - after.c).udeg().abs() <= count
}

/// Nanometres for each nm/s²: what the inverse of the position loop alone leaves of an acceleration.
fn left(servo: &ServoOptions) -> f64 {
    1e6 / (f64::from(servo.kv_milli) * f64::from(servo.speed_loop_milli))
}

/// The drives of X and Z, and the parameters of a board with them. `None` for ideal ones.
pub fn draw(r: &mut Draws, params: &mut Params) -> [Option<ServoOptions>; 2] {
    if !r.chance(33) {
        return [None; 2];
    }
    let last = Profile::built_in().count() as i64 - 1;
    let (first, second) = (r.within(0, last), r.within(0, last));
    let second = r.of(&[first, first, second]);
    // The share of the speed that somebody has set the drives to.
    let ahead = r.of(&[0, 0, 500, 1_000]);
    let mut drive = |axis, place| {
        let profile = Profile::built_in().nth(place as usize)?;
        let (servo, fitted) = fit(&profile, axis, ahead, params)?;
        *params = fitted;
        Some(servo)
    };
    [drive(Axis::X, first), drive(Axis::Z, second)]
}

/// A drive of this profile, and the board's parameters for it; `None` where it cannot be on the bus of such a board.
fn fit(
    profile: &Profile,
    axis: Axis,
    ahead: u16,
    params: &Params,
) -> Option<(ServoOptions, Params)> {
    let mut fitted = params.clone();
    let letter = char::from(axis.letter());
    let tick = params.tick_us();
    let servo = [8, 7].iter().find_map(|mode| {
        set(&mut fitted, &format!("9076.{letter}"), *mode);
        let mode = Mode::of_setpoints(fitted.drive_mode(axis));
        profile.servo(axis, mode, tick).ok()
    })?;
    let waits = i64::from(servo.buffer) + i64::from(servo.interpolation == Interpolation::Cubic);
    let (tick, kv) = (i64::from(tick), i64::from(servo.kv_milli));
    let mut own = |number: &str, value| set(&mut fitted, &format!("{number}.{letter}"), value);
    own("9070", kv / 100);
    own("9071", i64::from(ahead));
    own("9072", i64::from(servo.age_us));
    // What waits and the interpolation, less an inner step of the simulated drive.
    own("9003", (waits + 1) * tick - tick / 8);
    // Half as much again as the drive is behind in a rapid, and a way for the start.
    let speed = params.rapid(axis).nm_per_min() / 60;
    let behind = speed * (1_000 - i64::from(ahead)) / kv + speed * (waits + 3) * tick / 1_000_000;
    let limit = (behind * 3 / 2 + 2_000_000).max(6_000_000);
    own("1828", limit);
    let servo = ServoOptions {
        feed_forward_milli: ahead,
        following: Some((Length::from_nm(limit), 100)),
        // One that counts missing setpoints goes into fault (8250h) when a set is taken: the board is silent then [D478].
        late: None,
        ..servo
    };
    fitted.validate().is_ok().then_some((servo, fitted))
}

/// Setpoints that are calculated for up to so much later are within what a thread may be beside its helix.
const SOON_US: u32 = 3_000;

/// How much further a setpoint may be beside its helix where targets wait in the drives, in nanometres: it is for an
/// instant so far away (9003) that the spindle has another speed by then, by its swing or at the end of its ramp.
pub fn foreseen(params: &Params, options: &PlantOptions) -> i64 {
    let latency = params.latency_us(Axis::X).max(params.latency_us(Axis::Z));
    if latency <= SOON_US {
        return 0;
    }
    let (ripple, swing) = ripple(options);
    let longest = 4_000_000.0;
    let ramp = longest * 1_000.0 / 60.0 / (f64::from(params.spindle_ramp_ms()) / 1_000.0);
    let acceleration = encoder::FASTEST_NM_PER_S as f64 * ripple * swing + ramp;
    let seconds = f64::from(latency) / 1e6;
    (acceleration * seconds * seconds) as i64
}

/// How far the speed of the spindle swings, as a share of it, and how often in radians a second.
fn ripple(options: &PlantOptions) -> (f64, f64) {
    let milli_percent = options.ripple.map_or(0, Ripple::milli_percent);
    let swing = f64::from(encoder::swing_mhz(options)) / 1_000.0;
    (
        f64::from(milli_percent) / 100_000.0,
        swing * core::f64::consts::TAU,
    )
}

/// How the tool keeps to a thread behind the drives of a machine.
#[derive(Clone, Copy, Debug)]
pub struct Tool {
    /// After so many ticks on the helix it has settled.
    pub settles: u64,
    /// How far it may then be beside the helix, in nanometres, in addition to the setpoint.
    pub beside: i64,
    /// The speed of the spindle is even within this share of it.
    pub even: f64,
}

impl Tool {
    /// That of a machine; `None` where its drives are ideal ones.
    pub fn of(params: &Params, options: &PlantOptions) -> Option<Self> {
        let (ripple, swing) = ripple(options);
        let drives = options.servos.iter().zip([Axis::X, Axis::Z]);
        let drives = drives.filter_map(|(servo, axis)| servo.map(|servo| (servo, axis)));
        drives
            .map(|(servo, axis)| {
                let (kv, loops) = (
                    f64::from(servo.kv_milli) / 1_000.0,
                    f64::from(servo.speed_loop_milli) / 1_000.0,
                );
                let left = left(&servo);
                let started = params.acceleration(axis).nm_per_s2() as f64 * left;
                let slowest = kv.min(loops / 4.0);
                let seconds = (started / 1_000.0).max(1.0).ln() / slowest;
                let swings = encoder::FASTEST_NM_PER_S as f64 * ripple * swing * left;
                Self {
                    settles: (seconds * 1e6 / f64::from(params.tick_us())) as u64
                        + u64::from(servo.buffer)
                        + 4,
                    beside: servo.play.nm() / 2 + 20_000 + (2.0 * swings) as i64,
                    even: 2.0 * ripple + 0.005,
                }
            })
            .reduce(|one, other| Self {
                settles: one.settles.max(other.settles),
                beside: one.beside.max(other.beside),
                even: one.even,
            })
    }
}
