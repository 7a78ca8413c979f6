//! What `tune` has found, for people, as JSON and as a picture.

use leadscrew_core::alarm::Lang;
use svg::Document;
use svg::node::element::Line;

use super::telling::{Tells, label};
use crate::failure::Failure;
use crate::json::Json;
use crate::tuning::{Found, Known, Refusal};
use crate::words::{Both, both, pick};

/// What held before.
pub struct Before {
    pub letter: char,
    /// The lag that the board took off, in seconds.
    pub taken_off: f64,
    pub increment: f64,
    pub tick: f64,
    pub others: Others,
}

/// The lags of what moves together with the axis.
#[derive(Clone, Copy)]
pub struct Others {
    /// X for Z, and Z for X; its 9070 and 9003.
    pub letter: char,
    pub gain: u32,
    pub latency: u32,
    /// 9073, where this axis taps rigidly.
    pub spindle_gain: Option<u32>,
}

impl Others {
    /// What does not go together with this gain of the axis. Equal lags cancel on a contour and in a tap; one that is taken
    /// off does not.
    fn differ(&self, own: char, gain: u32) -> Vec<Both> {
        let mut all = Vec::new();
        let other = self.letter;
        if self.latency == 0 || (self.gain == 0) != (gain == 0) {
            all.push(both!(
                "{own} and {other} differ: with {own} alone tuned a contour is off by the lag of {other}; tune {other} too before \
                 anything is cut\n",
                "{own} 与 {other} 不一致：只整定 {own} 时，轮廓误差为 {other} 的滞后；切削前请同样整定 {other}\n"
            ));
        }
        if let Some(spindle) = self.spindle_gain
            && (spindle == 0) != (gain == 0)
        {
            all.push(both!(
                "{own} and the spindle differ: 9070.{own} is {gain} and 9073 {spindle}; a rigid tap is pulled by the lag of the one \
                 that keeps it: set both, or none\n",
                "{own} 与主轴不一致：9070.{own} 为 {gain}，9073 为 {spindle}；刚性攻丝时丝锥受未补偿一方滞后的拉力：两者都设，或都不设\n"
            ));
        }
        all
    }
}

/// 9075 with this age: as it was typed, and 0 (not known) where another age was typed without it.
pub fn age_within(typed: Option<u32>, age: u32, before: u32) -> Option<u32> {
    typed.or((age != before).then_some(0))
}

/// How far a loop of this gain (0.1 /s; 0: not known) and feed-forward (0.1 %) is behind at constant speed, in seconds.
pub fn behind(gain: u32, feed_forward: u32) -> f64 {
    if gain == 0 {
        return 0.0;
    }
    (1.0 - f64::from(feed_forward) / 1000.0) * 10.0 / f64::from(gain)
}

/// What is told.
pub struct Told {
    pub before: Before,
    /// In µs.
    pub dead_time: u32,
    /// In 0.1 %.
    pub feed_forward: u32,
    /// In µs.
    pub age: u32,
    /// How well that is known, where this is to be written.
    pub age_within: Option<u32>,
    pub found: Found,
    pub known: Known,
}

impl Told {
    /// 9070 in 0.1 /s: 0 where the lag is dead time alone.
    fn gain(&self) -> u32 {
        let gain = self.found.model.kv;
        gain.map_or(0, |kv| (kv * 10.0).round() as u32)
    }

    /// The total lag of the drive, in seconds.
    fn total(&self) -> f64 {
        self.found.lag.total.mean - f64::from(self.age) * 1e-6
    }

    /// 9003 in µs: what the gain, which has whole tenths, leaves of the lag.
    fn latency(&self) -> u32 {
        let left = self.total() - behind(self.gain(), self.feed_forward);
        (left * 1e6).round().max(0.0) as u32
    }

    /// The lag that 9003, 9070 and 9071 do not take off, in seconds: before and after.
    fn left(&self) -> [f64; 2] {
        let after = f64::from(self.latency()) * 1e-6 + behind(self.gain(), self.feed_forward);
        [self.before.taken_off, after].map(|taken_off| self.total() - taken_off)
    }
}

impl Tells for Told {
    fn title(&self) -> String {
        format!("tune {}", self.before.letter)
    }

    fn values(&self) -> Vec<String> {
        let letter = self.before.letter;
        let mut values = vec![
            format!("9003.{letter}={}", self.latency()),
            format!("9070.{letter}={}", self.gain()),
            format!("9071.{letter}={}", self.feed_forward),
            format!("9072.{letter}={}", self.age),
        ];
        values.extend(
            self.age_within
                .map(|within| format!("9075.{letter}={within}")),
        );
        values
    }

    fn words(&self) -> Both {
        let (lag, model) = (&self.found.lag, &self.found.model);
        let us = |value: f64| value * 1e6;
        let [before, after] = self.left();
        let letter = self.before.letter;
        let (d, sd) = (us(lag.total.mean), us(2.0 * lag.total.sd));
        let (plus, plus_sd) = (us(lag.plus.mean), us(2.0 * lag.plus.sd));
        let (minus, minus_sd) = (us(lag.minus.mean), us(2.0 * lag.minus.sd));
        let kv = model
            .kv
            .map_or_else(|| "-".to_owned(), |kv| format!("{kv:.1}/s"));
        let ff = f64::from(self.feed_forward) / 10.0;
        let at_rest = self
            .found
            .noise_at_rest
            .map_or_else(|| "-".to_owned(), |of| format!("{of:.2} µm"));
        let at_speed = self.found.noise_at_speed;
        let rms = model
            .rms
            .map_or_else(|| "-".to_owned(), |rms| format!("{rms:.2} µm"));
        let (offset, dead, age) = (lag.offset, self.dead_time, self.age);
        let (count, slow) = (self.known.quantum, self.known.tick * 1e6);
        let (before, after) = (us(before) * 0.05, us(after) * 0.05);
        let mut told = both!(
            "{letter}: total lag {d:.1} ± {sd:.1} µs; towards plus {plus:.1} ± {plus_sd:.1}, minus {minus:.1} ± {minus_sd:.1}\n\
             equivalent model: dead time {dead} µs, age of 6064h {age} µs, Kv {kv}, feed-forward {ff} %; {rms} from the drive\n\
             \x20 the bus does not show the parts of the lag: with another dead time or feed-forward another Kv fits\n\
             noise at rest {at_rest}, at speed {at_speed:.2} µm; count {count:.3} µm, SYNC {slow:.0} µs\n\
             directions {offset:.2} µm apart; friction unknown (no current on the bus), 60F4h not read\n\
             predicted lag error at 50 mm/s that nothing takes off: {before:.1} µm before, {after:.1} µm with these figures\n",
            "{letter}：总滞后 {d:.1} ± {sd:.1} µs；正向 {plus:.1} ± {plus_sd:.1}，负向 {minus:.1} ± {minus_sd:.1}\n\
             等效模型：死区时间 {dead} µs，6064h 滞后 {age} µs，Kv {kv}，前馈 {ff} %；与驱动相差 {rms}\n\
             \x20 总线上无法区分滞后的各部分：死区时间或前馈不同时，Kv 也不同\n\
             静止噪声 {at_rest}，运动噪声 {at_speed:.2} µm；分辨率 {count:.3} µm，SYNC {slow:.0} µs\n\
             两方向相差 {offset:.2} µm；摩擦未知（总线上无电流），未读取 60F4h\n\
             50 mm/s 时未被补偿的预计滞后误差：之前 {before:.1} µm，采用这些数值后 {after:.1} µm\n"
        );
        for one in self.before.others.differ(letter, self.gain()) {
            told.en.push_str(&one.en);
            told.zh.push_str(&one.zh);
        }
        told
    }

    fn fields(&self, json: &mut Json) {
        let (lag, model) = (&self.found.lag, &self.found.model);
        let [before, after] = self.left();
        json.flag("ok", true);
        json.text("axis", &self.before.letter.to_string());
        for (key, value) in [
            ("lag_us", lag.total),
            ("lag_plus_us", lag.plus),
            ("lag_minus_us", lag.minus),
        ] {
            json.object_at(key, |json| {
                json.number("value", format!("{:.3}", value.mean * 1e6));
                json.number("two_sd", format!("{:.3}", value.sd * 2e6));
            });
        }
        json.number("offset_um", format!("{:.3}", lag.offset));
        json.integer("dead_time_us", self.dead_time.into());
        json.integer("age_us", self.age.into());
        match model.kv {
            Some(kv) => json.number("kv_per_s", format!("{kv:.3}")),
            None => json.null("kv_per_s"),
        }
        json.number(
            "feed_forward",
            format!("{:.3}", f64::from(self.feed_forward) / 1000.0),
        );
        json.number("speed_loop_rad_s", format!("{:.0}", model.speed_loop));
        match model.rms {
            Some(rms) => json.number("model_rms_um", format!("{rms:.3}")),
            None => json.null("model_rms_um"),
        }
        match self.found.noise_at_rest {
            Some(noise) => json.number("noise_at_rest_um", format!("{noise:.3}")),
            None => json.null("noise_at_rest_um"),
        }
        json.number(
            "noise_at_speed_um",
            format!("{:.3}", self.found.noise_at_speed),
        );
        json.number("increment_um", format!("{:.4}", self.before.increment));
        json.number("tick_us", format!("{:.0}", self.before.tick * 1e6));
        json.null("friction");
        json.array_at("warnings", |json| {
            for one in self.before.others.differ(self.before.letter, self.gain()) {
                json.text_item(one.en.trim_end());
            }
        });
        json.number("left_before_us", format!("{:.3}", before * 1e6));
        json.number("left_after_us", format!("{:.3}", after * 1e6));
    }

    /// The predicted lag error over the speed, before and after.
    fn picture(&self, lang: Lang) -> String {
        let left = self.left();
        let most = left[0].abs().max(left[1].abs()).max(1e-6);
        let line = |x: f64, y: f64, colour: &str| {
            Line::new()
                .set("x1", 80)
                .set("y1", 220)
                .set("x2", x)
                .set("y2", y)
                .set("stroke", colour)
                .set("stroke-width", 2)
        };
        let mut drawn = Document::new()
            .set("viewBox", (0, 0, 900, 440))
            .add(label(
                80.0,
                24.0,
                format!(
                    "{} {}",
                    self.before.letter,
                    pick(lang, "predicted lag error over speed", "预计滞后误差与速度")
                ),
            ))
            .add(line(620.0, 220.0, "#888"))
            .add(label(560.0, 425.0, "50 mm/s".to_owned()));
        for (left, colour, name) in [
            (left[0], "#c33", pick(lang, "before", "之前")),
            (left[1], "#283", pick(lang, "after", "之后")),
        ] {
            let y = 220.0 - 170.0 * left / most;
            let um = left * 50_000.0;
            drawn = drawn.add(line(620.0, y, colour)).add(label(
                630.0,
                y,
                format!("{name}: {um:.1} µm"),
            ));
        }
        drawn.to_string()
    }
}

/// Why nothing is told.
pub fn refusal(why: &Refusal) -> Failure {
    let us = |value: f64| value * 1e6;
    Failure::WrongBecause(match *why {
        Refusal::Speeds { plus } => {
            let way = if plus { '+' } else { '-' };
            both!(
                "no three speeds towards {way} with actual positions: an axis without a reference is slowed to 9043, a feed \
                 override of 0 stops it, and the drive has to send its TPDO1",
                "{way} 方向没有三种速度的实际位置：未回参考点的轴限速为 9043，进给倍率为 0 则停止，驱动器须发送 TPDO1"
            )
        }
        Refusal::NotSettled { speed } => both!(
            "the lag has not settled at {speed:.1} mm/s: the current is at its limit, the axis sticks, or Kv is below 15/s",
            "在 {speed:.1} mm/s 时滞后未稳定：电流达到极限、轴爬行，或 Kv 低于 15/s",
            speed = speed / 1000.0
        ),
        Refusal::Residual { rms, limit } => both!(
            "the lag is no line over the speed: {rms:.1} µm are left, at most {limit:.1} µm are taken: the current is at its limit, or \
             the axis sticks and slips",
            "滞后与速度不成线性：剩余 {rms:.1} µm，最多允许 {limit:.1} µm：电流达到极限，或轴爬行"
        ),
        Refusal::Directions { plus, minus } => both!(
            "the lag depends on the direction: {plus:.1} µs towards plus, {minus:.1} µs towards minus: look for friction, a weight \
             or a current limit of one direction",
            "滞后与方向有关：正向 {plus:.1} µs，负向 {minus:.1} µs：请检查摩擦、重力或单方向的电流极限",
            plus = us(plus),
            minus = us(minus)
        ),
        Refusal::Runs { first, second } => both!(
            "two runs say different things: {first:.1} µs and {second:.1} µs: let the machine warm up, and look for lost frames",
            "两次测量结果不同：{first:.1} µs 与 {second:.1} µs：请先预热机床，并检查是否丢失报文",
            first = us(first),
            second = us(second)
        ),
        Refusal::Following { periods } => both!(
            "60F4h of the drive is {periods:.1} SYNC periods from the lag on the bus: it takes another target, or the dead time is wrong",
            "驱动器的 60F4h 与总线上的滞后相差 {periods:.1} 个 SYNC 周期：它采用了另一个目标，或死区时间有误"
        ),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_that_is_tuned_alone_names_the_other_and_the_spindle() {
        let told = |gain: u32, latency: u32, spindle_gain: Option<u32>, own: u32| {
            let others = Others {
                letter: 'X',
                gain,
                latency,
                spindle_gain,
            };
            let all = others.differ('Z', own);
            all.into_iter().map(|one| one.en).collect::<String>()
        };
        assert_eq!(told(300, 1000, Some(200), 300), "");
        assert_eq!(told(300, 1000, None, 300), "");
        // Drives without a loop's lag: only what 9003 has.
        assert_eq!(told(0, 1000, Some(0), 0), "");
        assert!(told(0, 0, None, 300).contains("tune X too"));
        assert!(told(0, 1000, None, 300).contains("tune X too"));
        assert!(told(300, 1000, None, 0).contains("tune X too"));
        assert!(told(0, 0, None, 0).contains("tune X too"));
        assert!(told(300, 1000, Some(0), 300).contains("9073 0"));
        assert!(told(0, 1000, Some(200), 0).contains("9073 200"));
    }

    #[test]
    fn another_age_is_not_known_as_well_as_the_one_before() {
        assert_eq!(age_within(None, 600, 100), Some(0));
        assert_eq!(age_within(Some(30), 600, 100), Some(30));
        assert_eq!(age_within(None, 100, 100), None);
        assert_eq!(age_within(Some(30), 100, 100), Some(30));
    }
}
