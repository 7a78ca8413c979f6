//! From a profile to the figures of the simulated drive.

use leadscrew_board_sim::plant::{Interpolation, Late, ServoOptions};
use leadscrew_core::units::{Acceleration, Axis, Feed, Length};

use super::facts::{Value, decimals};
use super::{Profile, TYPICAL};
use crate::failure::{Failure, Outcome};
use crate::values::decimal;
use crate::words::{Both, both};

/// The mode in which a board streams.
const STREAMED: &str = "mode.8";

impl Profile {
    /// The simulated drive of an axis under this profile, for a board with this tick.
    ///
    /// # Errors
    /// The drive cannot be on the bus of such a board.
    pub fn servo(&self, axis: Axis, tick_us: u32) -> Outcome<ServoOptions> {
        self.refuse(tick_us).map_err(Failure::WrongBecause)?;
        let typical = Self::named(TYPICAL);
        let figure = |key: &str| {
            let of = |profile: &Self| profile.figure(axis, key);
            of(self)
                .or_else(|| typical.as_ref().and_then(of))
                .unwrap_or(0)
        };
        let small = |key: &str| u32::try_from(figure(key)).unwrap_or(u32::MAX);
        let acceleration = |key: &str| Acceleration::from_nm_per_s2(figure(key));
        let streamed = |key: &str| self.whole(&format!("{STREAMED}.{key}"));
        let following = figure("following_mm");
        Ok(ServoOptions {
            buffer: streamed("buffer.default").unwrap_or(0) as u8,
            interpolation: match self.word(&format!("{STREAMED}.interpolation")) {
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

    /// Why such a drive cannot be streamed to.
    pub(crate) fn refuse(&self, tick_us: u32) -> Result<(), Both> {
        let name = &self.name;
        if let Some(fact) = self.fact(&format!("{STREAMED}.supported"))
            && fact.value == Value::Flag(false)
        {
            let source = fact.source.words();
            return Err(both!(
                "`{name}` has no mode 8 on CAN ({en}), and the board streams in no other: choose another drive",
                "`{name}` 在 CAN 上没有模式 8（{zh}），而控制板只用该模式发送设定值：请选择其他驱动器",
                en = source.en,
                zh = source.zh
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

    fn word(&self, path: &str) -> Option<&str> {
        match &self.fact(path)?.value {
            Value::Text(text) => Some(text),
            _ => None,
        }
    }
}
