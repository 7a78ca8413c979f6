//! From a profile to the figures of the simulated drive.

use leadscrew_board_sim::plant::{Interpolation, Late, ScrewErrors, ServoOptions};
use leadscrew_core::bus::Mode;
use leadscrew_core::units::{Acceleration, Axis, Feed, Length};

use super::facts::{Value, decimals};
use super::{Profile, TYPICAL};
use crate::failure::{Failure, Outcome};
use crate::values::decimal;
use crate::words::{Both, both};

/// The quirk of a drive that wants the way of a tick in 60C1h:02 beside the target.
const DIFFERENCE: &str = "ip-target";

impl Profile {
    /// The simulated drive of an axis under this profile, for a board that gives it its setpoints in this mode and with
    /// this tick.
    ///
    /// # Errors
    /// The drive cannot be on the bus of such a board.
    pub fn servo(&self, axis: Axis, mode: Mode, tick_us: u32) -> Outcome<ServoOptions> {
        self.refuse(mode, tick_us).map_err(Failure::WrongBecause)?;
        let typical = Self::named(TYPICAL);
        let figure = |key: &str| {
            let of = |profile: &Self| profile.figure(axis, key);
            of(self)
                .or_else(|| typical.as_ref().and_then(of))
                .unwrap_or(0)
        };
        let small = |key: &str| u32::try_from(figure(key)).unwrap_or(u32::MAX);
        let acceleration = |key: &str| Acceleration::from_nm_per_s2(figure(key));
        let streamed = |key: &str| self.whole(&format!("mode.{}.{key}", mode as u8));
        let following = figure("following_mm");
        Ok(ServoOptions {
            buffer: streamed("buffer.default").unwrap_or(0) as u8,
            interpolation: match self.word(&format!("mode.{}.interpolation", mode as u8)) {
                Some("cubic") => Interpolation::Cubic,
                _ => Interpolation::Linear,
            },
            kv_milli: small("kv_per_s"),
            feed_forward_milli: figure("feed_forward") as u16,
            speed_loop_milli: small("speed_loop_rad_s"),
            integral_us: small("integral_ms"),
            current_loop_milli: small("current_loop_rad_s"),
            speed_limit: Feed::from_nm_per_min(figure("speed_m_min")),
            acceleration_limit: acceleration("acceleration_m_s2"),
            sticking: acceleration("sticking_m_s2"),
            sliding: acceleration("sliding_m_s2"),
            viscous_milli: small("viscous_per_s"),
            play: Length::from_nm(figure("backlash_um")),
            screw: ScrewErrors {
                nm_per_m: i32::try_from(figure("pitch_um_per_m")).unwrap_or(0),
                wave: Length::from_nm(figure("pitch_wave_um")),
                wave_length: Length::from_nm(figure("pitch_wave_mm")),
            },
            count: Length::from_nm(figure("count_um")),
            following: (following > 0)
                .then_some((Length::from_nm(following), figure("following_ms") as u16)),
            undelayed: self.word("actual.following_error") == Some("undelayed"),
            age_us: self
                .whole("actual.age_us")
                .and_then(|age| u32::try_from(age).ok())
                .unwrap_or(0),
            late: streamed("late.extrapolate")
                .zip(streamed("late.fault"))
                .map(|(extrapolate, fault)| Late {
                    extrapolate: extrapolate as u8,
                    fault: fault as u8,
                }),
        })
    }

    /// Why such a drive cannot get its setpoints in this mode, or at this tick.
    pub(crate) fn refuse(&self, mode: Mode, tick_us: u32) -> Result<(), Both> {
        let name = &self.name;
        let own = mode as u8;
        let other = if mode == Mode::Interpolated { 8 } else { 7 };
        let supports = |mode: u8| self.flag(&format!("mode.{mode}.supported"));
        if supports(own) == Some(false) {
            let source = self.fact(&format!("mode.{own}.supported"));
            let source = source.map_or_else(|| both!("", ""), |fact| fact.source.words());
            return Err(if supports(other) == Some(true) {
                both!(
                    "`{name}` has no mode {own} on CAN ({en}), but mode {other}: set parameter 9076 of its axis to {other}",
                    "`{name}` 在 CAN 上没有模式 {own}（{zh}），但有模式 {other}：请将该轴的参数 9076 设为 {other}",
                    en = source.en,
                    zh = source.zh
                )
            } else {
                both!(
                    "`{name}` has no mode {own} on CAN ({en}), and the board sends setpoints in modes 7 and 8 alone: choose \
                     another drive",
                    "`{name}` 在 CAN 上没有模式 {own}（{zh}），而控制板只在模式 7 和 8 下发送设定值：请选择其他驱动器",
                    en = source.en,
                    zh = source.zh
                )
            });
        }
        if mode == Mode::Interpolated && self.quirks.iter().any(|quirk| quirk.id == DIFFERENCE) {
            return Err(both!(
                "`{name}` wants more than the target in mode 7, and the board sends it alone: set parameter 9076 of its axis \
                 to 8",
                "`{name}` 在模式 7 下除目标外还需要其他数据，而控制板只发送目标：请将该轴的参数 9076 设为 8"
            ));
        }
        let tick = i64::from(tick_us);
        let of = |key: &str| self.whole(&format!("sync.period_us.{key}"));
        let (low, high, step) = (of("min").unwrap_or(1), of("max"), of("step").unwrap_or(1));
        if tick < low || high.is_some_and(|high| tick > high) || tick % step.max(1) != 0 {
            let high = high.map_or_else(|| "…".to_owned(), |high| high.to_string());
            return Err(both!(
                "`{name}` takes SYNC periods from {low} to {high} µs in steps of {step} µs, and parameter 9000 is {tick} µs: \
                 change 9000, or choose another drive",
                "`{name}` 的 SYNC 周期为 {low} 至 {high} µs，步长 {step} µs，而参数 9000 为 {tick} µs：请修改 9000，或选择其他驱动器"
            ));
        }
        Ok(())
    }

    /// A figure in units of its last decimal: that of the axis, else the common one.
    fn figure(&self, axis: Axis, key: &str) -> Option<i64> {
        let axis = char::from(axis.letter());
        let own = self.fact(&format!("figures.{axis}.{key}"));
        let fact = own.or_else(|| self.fact(&format!("figures.{key}")))?;
        match &fact.value {
            Value::Number(text) => decimal(text, decimals(key)).ok(),
            _ => None,
        }
    }

    /// A whole number.
    pub(crate) fn whole(&self, path: &str) -> Option<i64> {
        match &self.fact(path)?.value {
            Value::Number(text) => decimal(text, 0).ok(),
            _ => None,
        }
    }

    /// Whole numbers.
    pub(crate) fn numbers(&self, path: &str) -> Option<Vec<i64>> {
        let words = self.words(path)?.into_iter();
        words.map(|word| decimal(word, 0).ok()).collect()
    }

    /// Several numbers or words.
    pub(crate) fn words(&self, path: &str) -> Option<Vec<&str>> {
        match &self.fact(path)?.value {
            Value::List(all) => Some(all.iter().map(String::as_str).collect()),
            _ => None,
        }
    }

    /// True or false.
    pub(crate) fn flag(&self, path: &str) -> Option<bool> {
        match &self.fact(path)?.value {
            Value::Flag(flag) => Some(*flag),
            _ => None,
        }
    }

    pub(crate) fn word(&self, path: &str) -> Option<&str> {
        match &self.fact(path)?.value {
            Value::Text(text) => Some(text),
            _ => None,
        }
    }
}
