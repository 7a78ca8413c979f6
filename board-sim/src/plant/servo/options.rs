//! The figures of a drive as they are stated, and as the steps need them.

use super::grid::Grid;
use crate::plant::sine::{PLACES as SINE, sin_cos};
use leadscrew_core::units::{Acceleration, Feed, Length};

/// How a drive moves between two targets.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Interpolation {
    /// On a straight line.
    #[default]
    Linear,
    /// On a cubic with the slopes of the neighbours, which costs one period more.
    Cubic,
}

/// What a drive does when no new target has come by a SYNC.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Late {
    /// It goes on by its last step for so many SYNCs.
    pub extrapolate: u8,
    /// At this SYNC in a row it goes into fault.
    pub fault: u8,
}

/// Supervision of the following error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Following {
    /// 6065h in increments; [`Self::OFF`] switches it off.
    pub window: u32,
    /// 6066h: the error has to be too large for longer than this.
    pub timeout_ms: u16,
}

impl Following {
    /// The window of a drive that does not supervise.
    pub const OFF: u32 = u32::MAX;
}

/// Errors of a screw's pitch: how far the slide is beside the place that its drive has turned to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ScrewErrors {
    /// Nanometres a metre, towards plus: a lead that is too long by so much.
    pub nm_per_m: i32,
    /// Height of a sine over the travel.
    pub wave: Length,
    /// Its length; zero for none.
    pub wave_length: Length,
}

impl ScrewErrors {
    /// The error at a place, both in 2⁻¹⁶ nanometres.
    pub(super) fn at(&self, place: i64) -> i64 {
        let lead = i128::from(place).wrapping_mul(self.nm_per_m.into()) / 1_000_000_000;
        // In 2⁻⁶⁴ turns, of which whole ones are dropped.
        let turns = i128::from(place)
            .wrapping_shl(48)
            .checked_div(self.wave_length.nm().into());
        let (sine, _) = sin_cos(turns.unwrap_or(0) as u64);
        let wave = i128::from(sine).wrapping_mul(self.wave.nm().into()) >> (SINE - 16);
        lead.wrapping_add(wave) as i64
    }
}

/// The figures of a drive with its axis. Figures that are factors of time are a thousandth of their unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ServoOptions {
    /// Targets that wait in the drive, up to [`Self::LONGEST_BUFFER`].
    pub buffer: u8,
    /// Between two targets.
    pub interpolation: Interpolation,
    /// Kv of the position loop, in thousandths of 1/s.
    pub kv_milli: u32,
    /// Feed-forward of the speed, in thousandths; up to 1500.
    pub feed_forward_milli: u16,
    /// The speed loop, in thousandths of rad/s.
    pub speed_loop_milli: u32,
    /// Its integral time in microseconds; 0 for none.
    pub integral_us: u32,
    /// The current loop, in thousandths of rad/s; 0 for one without delay.
    pub current_loop_milli: u32,
    /// The highest speed.
    pub speed_limit: Feed,
    /// The acceleration at the limit of the current.
    pub acceleration_limit: Acceleration,
    /// Friction at rest, as an acceleration.
    pub sticking: Acceleration,
    /// Friction in motion, as an acceleration.
    pub sliding: Acceleration,
    /// Friction that grows with speed, in thousandths of 1/s.
    pub viscous_milli: u32,
    /// Play between motor and tool.
    pub play: Length,
    /// Errors of the screw's pitch.
    pub screw: ScrewErrors,
    /// A count of the encoder; zero for one increment of the drive.
    pub count: Length,
    /// Supervision of the following error: 6065h as a length, `None` for none, and 6066h in milliseconds.
    pub following: Option<(Length, u16)>,
    /// 60F4h and its supervision take the newest target, which still waits in the buffer.
    pub undelayed: bool,
    /// Age of 6064h at its SYNC in microseconds, up to [`Self::OLDEST`] periods.
    pub age_us: u32,
    /// Targets that have not come; `None`: the last one stays.
    pub late: Option<Late>,
}

impl ServoOptions {
    /// The most targets that wait.
    pub const LONGEST_BUFFER: u8 = 16;
    /// The most periods of age.
    pub const OLDEST: u32 = 4;

    /// The loops alone, Kv 30 1/s: no feed-forward, no integral, a current without delay, neither friction nor play, and
    /// limits far away. What the formulas are about, and what shows the lag of a drive.
    pub const LOOPS_ALONE: Self = Self {
        buffer: 0,
        interpolation: Interpolation::Linear,
        kv_milli: 30_000,
        feed_forward_milli: 0,
        speed_loop_milli: 400_000,
        integral_us: 0,
        current_loop_milli: 0,
        speed_limit: Feed::from_nm_per_min(120_000_000_000),
        acceleration_limit: Acceleration::from_nm_per_s2(50_000_000_000),
        sticking: Acceleration::from_nm_per_s2(0),
        sliding: Acceleration::from_nm_per_s2(0),
        viscous_milli: 0,
        play: Length::ZERO,
        screw: ScrewErrors {
            nm_per_m: 0,
            wave: Length::ZERO,
            wave_length: Length::ZERO,
        },
        count: Length::ZERO,
        following: None,
        undelayed: false,
        age_us: 0,
        late: None,
    };

    /// What the drive supervises as delivered, where so many increments are so many nanometres.
    pub(in crate::plant) fn following(&self, increments: (u32, u32)) -> Option<Following> {
        let Some((window, timeout_ms)) = self.following else {
            return Some(Following {
                window: Following::OFF,
                timeout_ms: 0,
            });
        };
        let scale = Grid::new(increments.0, increments.1)?;
        let window = scale.nearest(window.nm().checked_shl(16)?);
        let window = u32::try_from(window)
            .ok()
            .filter(|of| *of != Following::OFF)?;
        Some(Following { window, timeout_ms })
    }
}

/// What the steps need.
#[derive(Clone, Copy, Debug)]
pub(super) struct Constants {
    pub(super) tick_us: u32,
    pub(super) scale: Grid,
    pub(super) encoder: Grid,
    /// Kv · h, in 2⁻³².
    pub(super) kv: i64,
    /// In 2⁻¹⁶.
    pub(super) feed_forward: i64,
    /// ωv · h, in 2⁻³².
    pub(super) speed_gain: i64,
    /// ωv · h² / Ti, in 2⁻³².
    pub(super) integral_gain: i64,
    /// 1 − e^(−ωi · h), in 2⁻³².
    pub(super) current: i64,
    /// In 2⁻³² nanometres a step.
    pub(super) speed_limit: i64,
    /// In 2⁻⁴⁰ nanometres a step².
    pub(super) acceleration_limit: i64,
    pub(super) sticking: i64,
    pub(super) sliding: i64,
    /// In 2⁻³².
    pub(super) viscous: i64,
    /// In 2⁻¹⁶ nanometres.
    pub(super) half_play: i64,
    pub(super) screw: ScrewErrors,
    pub(super) undelayed: bool,
    /// Inner steps of the age of 6064h, in 2⁻¹⁶.
    pub(super) age: i64,
    pub(super) late: Option<Late>,
}

/// Steps in a second times microseconds of a tick.
const STEP_US: i128 = 1_000_000 * super::STEPS as i128;
/// The longest tick.
const LONGEST_TICK_US: u32 = 20_000;

impl Constants {
    /// `None` where a figure is out of its range. `increments`: so many increments are so many nanometres.
    pub(super) fn new(
        options: &ServoOptions,
        increments: (u32, u32),
        tick_us: u32,
    ) -> Option<Self> {
        let late = options
            .late
            .is_none_or(|late| late.fault > late.extrapolate);
        if tick_us == 0
            || tick_us > LONGEST_TICK_US
            || options.buffer > ServoOptions::LONGEST_BUFFER
            || options.feed_forward_milli > 1500
            || options.age_us > tick_us.wrapping_mul(ServoOptions::OLDEST)
            || !late
        {
            return None;
        }
        let scale = Grid::new(increments.0, increments.1)?;
        let encoder = match u32::try_from(options.count.nm()).ok()? {
            0 => scale,
            nm => Grid::new(1, nm)?,
        };
        let tick = i128::from(tick_us);
        // A thousandth of 1/s in a step, in 2⁻³².
        let rate = |milli: u32| {
            let value = i128::from(milli).wrapping_mul(tick).wrapping_shl(32);
            let value = value.checked_div(STEP_US.wrapping_mul(1000))?;
            // The loops are stable below 1.
            (value < 1 << 32).then_some(value as i64)
        };
        let speed_gain = rate(options.speed_loop_milli)?;
        let acceleration = |of: Acceleration| {
            let per_step = i128::from(of.nm_per_s2()).checked_mul(tick.wrapping_mul(tick))?;
            let value = per_step
                .checked_mul(1 << 40)?
                .checked_div(STEP_US.wrapping_mul(STEP_US))?;
            (0..1 << 52).contains(&value).then_some(value as i64)
        };
        let integral_gain = match options.integral_us {
            0 => 0,
            time => i128::from(speed_gain)
                .wrapping_mul(tick.wrapping_mul(1_000_000))
                .checked_div(STEP_US.wrapping_mul(i128::from(time)))?
                .min(1 << 32) as i64,
        };
        let current = match options.current_loop_milli {
            0 => 1 << 32,
            milli => {
                let exponent = i128::from(milli).wrapping_mul(tick).wrapping_shl(60);
                let exponent = exponent.checked_div(STEP_US.wrapping_mul(1000))?;
                (ONE.wrapping_sub(decay(exponent)) >> 28) as i64
            }
        };
        let speed = i128::from(options.speed_limit.nm_per_min())
            .checked_mul(tick)?
            .checked_mul(1 << 32)?
            .checked_div(STEP_US.wrapping_mul(60))?;
        let speed_limit = (0..1 << 56).contains(&speed).then_some(speed as i64)?;
        let play = options.play.nm();
        Some(Self {
            tick_us,
            scale,
            encoder,
            kv: rate(options.kv_milli)?,
            feed_forward: i64::from(options.feed_forward_milli).wrapping_shl(16) / 1000,
            speed_gain,
            integral_gain,
            current,
            speed_limit,
            acceleration_limit: acceleration(options.acceleration_limit)?,
            sticking: acceleration(options.sticking)?,
            sliding: acceleration(options.sliding)?,
            viscous: rate(options.viscous_milli)?,
            half_play: (0..1_000_000_000)
                .contains(&play)
                .then_some(play.wrapping_shl(15))?,
            screw: options.screw,
            undelayed: options.undelayed,
            age: i64::from(options.age_us)
                .wrapping_mul(super::STEPS << 16)
                .checked_div(tick_us.into())?,
            late: options.late,
        })
    }
}

/// 1 in 2⁻⁶⁰.
const ONE: i128 = 1 << 60;

/// e^−x for x ≥ 0, both in 2⁻⁶⁰.
fn decay(x: i128) -> i128 {
    if x >= ONE.wrapping_mul(40) {
        return 0;
    }
    // e^−x = (e^(−x/2¹⁰))^1024; the series is short there.
    let small = x >> 10;
    let mut sum = ONE;
    for divisor in (1..=8_i128).rev() {
        let term = (small.wrapping_mul(sum) >> 60).checked_div(divisor);
        sum = ONE.wrapping_sub(term.unwrap_or(0));
    }
    for _ in 0..10 {
        sum = sum.wrapping_mul(sum) >> 60;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_decay_is_the_exponential() {
        for x in [0.0_f64, 1e-6, 0.01, 0.628_318, 1.0, 5.0, 20.0, 39.9] {
            let told = decay((x * ONE as f64) as i128) as f64 / ONE as f64;
            assert!((told - (-x).exp()).abs() < 1e-14, "{x}: {told}");
        }
        assert_eq!(decay(ONE * 41), 0);
    }
}
