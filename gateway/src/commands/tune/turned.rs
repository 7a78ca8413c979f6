//! What `tune spindle` has found, for people, as JSON and as a picture.

use std::fmt::Write as _;

use leadscrew_core::alarm::Lang;
use svg::Document;
use svg::node::element::{Line, Polyline};

use super::telling::{Tells, label};
use crate::failure::Failure;
use crate::json::Json;
use crate::tuning::spindle::{Found, Kind, Known, Look, Refusal, Source};
use crate::words::{Both, both, pick};

/// What is told.
pub struct Told {
    /// 9004 before.
    pub ramp_ms: u32,
    /// 9010 before, in per cent.
    pub variation: u32,
    pub swing: Swing,
    pub known: Known,
    pub looks: Vec<Look>,
    pub found: Found,
}

/// What the machine has of the drive's swing.
pub struct Swing {
    /// 9034 before, in 0.001 Hz; 0: not known.
    pub before: u32,
    /// The encoder has so few counts that it learns a swing whose frequency is known.
    pub is_learned: bool,
}

/// A swing that is smaller, as a share of the speed, is not worth being learned.
const LEAST_SWING: f64 = 0.01;

impl Told {
    /// 9034 for this spindle, in 0.001 Hz: the largest swing of its own, where the encoder learns it.
    fn swing(&self) -> Option<u32> {
        let own = |source: &Source| match source.kind {
            Kind::Hertz(hertz) if source.share >= LEAST_SWING => Some(hertz),
            _ => None,
        };
        let found = self.found.sources.iter().find_map(own);
        let hertz = found.filter(|_| self.swing.is_learned)?;
        Some((hertz * 1000.0).round() as u32)
    }

    /// 9004 for this spindle: no shorter than what was found.
    fn ramp(&self) -> u32 {
        (self.found.ramp * 1000.0).ceil() as u32
    }

    /// 9010 for this spindle. Without a cut the speed varies least, so the figure is never made smaller.
    fn room(&self) -> u32 {
        let found = (self.found.variation * 100.0).ceil() as u32;
        found.max(self.variation)
    }

    /// A line of the spectrum.
    fn source(&self, source: &Source) -> Both {
        let (share, seen) = (source.share * 100.0, source.seen);
        let all = self.found.run_ups.len();
        match source.kind {
            Kind::Order(order) => both!(
                "  {share:.2} % {order} times a turn, at {seen} of {all} speeds: it turns with the spindle\n",
                "  {share:.2} %，每转 {order} 次，在 {all} 个转速中的 {seen} 个出现：随主轴转动\n"
            ),
            Kind::Hertz(hertz) => both!(
                "  {share:.2} % at {hertz:.2} Hz, at {seen} of {all} speeds: it swings by itself (drive, belt, mains)\n",
                "  {share:.2} %，{hertz:.2} Hz，在 {all} 个转速中的 {seen} 个出现：自由振荡（驱动、皮带、电源）\n"
            ),
            Kind::Unknown(hertz) => both!(
                "  {share:.2} % at {hertz:.2} Hz: these speeds do not tell whether it turns with the spindle\n",
                "  {share:.2} %，{hertz:.2} Hz：这些转速无法判断是否随主轴转动\n"
            ),
        }
    }
}

impl Tells for Told {
    fn title(&self) -> String {
        "tune spindle".to_owned()
    }

    fn values(&self) -> Vec<String> {
        let mut values = vec![
            format!("9004={}", self.ramp()),
            format!("9010={}", self.room()),
        ];
        values.extend(self.swing().map(|swing| format!("9034={swing}")));
        values
    }

    fn words(&self) -> Both {
        let (mut en, mut zh) = (String::new(), String::new());
        for run_up in &self.found.run_ups {
            let (asked, mean) = (run_up.asked, run_up.mean);
            let off = (mean / asked - 1.0) * 100.0;
            let [up, down] = [run_up.up, run_up.down].map(|ramp| ramp * 1000.0);
            let varies = run_up.variation * 100.0;
            let _ = writeln!(
                en,
                "S{asked:.0}: {mean:.1} rpm ({off:+.1} %), for 1000 rpm {up:.0} ms up and {down:.0} ms down; varies by {varies:.2} %"
            );
            let _ = writeln!(
                zh,
                "S{asked:.0}：{mean:.1} r/min（{off:+.1} %），每 1000 r/min 升速 {up:.0} ms、降速 {down:.0} ms；波动 {varies:.2} %"
            );
        }
        let (ramp, before) = (self.ramp(), self.ramp_ms);
        let (room, percent) = (self.room(), self.variation);
        let _ = writeln!(
            en,
            "9004 {ramp} ms for 1000 rpm (now {before}); 9010 {room} % (now {percent}; never made smaller: a cut varies it more)"
        );
        let _ = writeln!(
            zh,
            "9004 每 1000 r/min {ramp} ms（现为 {before}）；9010 {room} %（现为 {percent}；不会减小：切削时波动更大）"
        );
        if let Some(swing) = self.swing() {
            let [hertz, before] = [swing, self.swing.before].map(|of| f64::from(of) / 1000.0);
            let _ = writeln!(
                en,
                "9034 {hertz:.3} Hz (now {before:.3}; 0 is not known): an encoder of so few counts learns this swing"
            );
            let _ = writeln!(
                zh,
                "9034 {hertz:.3} Hz（现为 {before:.3}；0 表示未知）：这样少线数的编码器会学习此波动"
            );
        }
        for source in &self.found.sources {
            let of = self.source(source);
            en += &of.en;
            zh += &of.zh;
        }
        let band = self.known.band;
        let _ = writeln!(
            en,
            "nothing is known of what is faster than {band:.0} Hz; an eccentric encoder looks as a true order 1"
        );
        let _ = writeln!(
            zh,
            "高于 {band:.0} Hz 的变化无法得知；编码器偏心与真实的 1 阶波动看起来相同"
        );
        Both { en, zh }
    }

    fn fields(&self, json: &mut Json) {
        json.flag("ok", true);
        json.array_at("run_ups", |json| {
            for run_up in &self.found.run_ups {
                json.object(|json| {
                    json.number("asked_rpm", format!("{:.0}", run_up.asked));
                    json.number("mean_rpm", format!("{:.3}", run_up.mean));
                    json.number("up_ms", format!("{:.1}", run_up.up * 1000.0));
                    json.number("down_ms", format!("{:.1}", run_up.down * 1000.0));
                    json.number("variation_percent", percent(run_up.variation));
                });
            }
        });
        json.integer("ramp_ms", self.ramp().into());
        json.integer("ramp_ms_before", self.ramp_ms.into());
        json.integer("variation_percent", self.room().into());
        json.integer("variation_percent_before", self.variation.into());
        match self.swing() {
            Some(swing) => json.number("swing_hz", format!("{:.3}", f64::from(swing) / 1000.0)),
            None => json.null("swing_hz"),
        }
        json.number(
            "swing_hz_before",
            format!("{:.3}", f64::from(self.swing.before) / 1000.0),
        );
        json.array_at("lines", |json| {
            for source in &self.found.sources {
                json.object(|json| {
                    match source.kind {
                        Kind::Order(order) => json.integer("order", order.into()),
                        Kind::Hertz(hertz) => json.number("hz", format!("{hertz:.3}")),
                        Kind::Unknown(hertz) => json.number("hz_or_order", format!("{hertz:.3}")),
                    }
                    json.number("percent", percent(source.share));
                    json.number("speeds", source.seen);
                });
            }
        });
        json.number("band_hz", format!("{:.0}", self.known.band));
    }

    /// The speed over time, and below it the lines of each speed over their frequency.
    fn picture(&self, lang: Lang) -> String {
        let first = self.looks.first().map_or(0.0, |look| look.time);
        let time = self.looks.last().map_or(1.0, |look| look.time - first);
        let speeds = self.looks.iter().map(|look| look.speed.abs());
        let highest = speeds.fold(1.0, f64::max);
        let (left, right) = (70.0, 870.0);
        let points = self.looks.iter().map(|look| {
            let x = left + (right - left) * (look.time - first) / time;
            let y = 220.0 - 180.0 * look.speed.abs() / highest;
            format!("{x:.1},{y:.1}")
        });
        let points: Vec<String> = points.collect();
        let curve = Polyline::new()
            .set("points", points.join(" "))
            .set("fill", "none")
            .set("stroke", "#06c")
            .set("stroke-width", 1);
        let title = pick(lang, "speed over time", "转速与时间");
        let mut drawn = Document::new()
            .set("viewBox", (0, 0, 900, 480))
            .add(label(left, 24.0, title.to_owned()))
            .add(axis([left, 220.0], [right, 220.0]))
            .add(axis([left, 40.0], [left, 220.0]))
            .add(label(4.0, 46.0, format!("{highest:.0} rpm")))
            .add(label(right - 60.0, 240.0, format!("{time:.0} s")))
            .add(curve);
        let title = pick(lang, "ripple over its frequency", "波动与频率");
        let lines = self.found.run_ups.iter().flat_map(|run_up| &run_up.lines);
        let largest = lines.map(|line| line.share).fold(1e-3, f64::max);
        drawn = drawn
            .add(label(left, 274.0, title.to_owned()))
            .add(axis([left, 440.0], [right, 440.0]))
            .add(axis([left, 290.0], [left, 440.0]))
            .add(label(4.0, 296.0, format!("{:.1} %", largest * 100.0)))
            .add(label(
                right - 60.0,
                460.0,
                format!("{:.0} Hz", self.known.band),
            ));
        for (place, run_up) in self.found.run_ups.iter().enumerate() {
            let colour = COLOURS[place % COLOURS.len()];
            let name = format!("S{:.0}", run_up.asked);
            drawn = drawn.add(label(320.0 + 90.0 * place as f64, 274.0, name).set("fill", colour));
            for line in &run_up.lines {
                // Lines of one frequency stand beside each other.
                let beside = 4.0 * place as f64;
                let x = left + (right - left) * line.hertz / self.known.band + beside;
                let y = 440.0 - 150.0 * line.share / largest;
                drawn = drawn.add(
                    axis([x, 440.0], [x, y])
                        .set("stroke", colour)
                        .set("stroke-width", 3),
                );
            }
        }
        drawn.to_string()
    }
}

/// Colours that the colour-blind can tell apart.
const COLOURS: [&str; 6] = [
    "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9",
];

fn axis([x1, y1]: [f64; 2], [x2, y2]: [f64; 2]) -> Line {
    Line::new()
        .set("x1", x1)
        .set("y1", y1)
        .set("x2", x2)
        .set("y2", y2)
        .set("stroke", "#888")
}

/// A share as per cent.
fn percent(share: f64) -> String {
    format!("{:.3}", share * 100.0)
}

/// Why nothing is told.
pub fn refusal(why: &Refusal) -> Failure {
    Failure::WrongBecause(match *why {
        Refusal::Turning { asked } => both!(
            "S{asked:.0}: the spindle was not at rest before it: it still turned, or somebody turned it",
            "S{asked:.0}：开始前主轴未静止：仍在转动，或有人转动了它"
        ),
        Refusal::NotReached { asked } => both!(
            "S{asked:.0}: the spindle did not stay at its speed for long enough: it takes more than three times what 9004 says, or did not turn",
            "S{asked:.0}：主轴在该转速停留时间不足：升速时间超过 9004 的三倍，或未转动"
        ),
        Refusal::NotSettled { asked, share } => both!(
            "S{asked:.0}: the speed has changed by {percent:.1} % while it was looked at: let the drive warm up, or name more `--seconds`",
            "S{asked:.0}：观察期间转速变化了 {percent:.1} %：请先预热驱动器，或增加 `--seconds`",
            percent = share * 100.0
        ),
        Refusal::NotAtRest { asked } => both!(
            "S{asked:.0}: after M5 the spindle did not come to rest within three times what 9004 says: it has no brake, or 9004 is far \
             too short",
            "S{asked:.0}：M5 之后主轴未在 9004 的三倍时间内停止：没有制动，或 9004 设得太短"
        ),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(sources: &[(Kind, f64)], is_learned: bool) -> Told {
        let source = |&(kind, share): &(Kind, f64)| Source {
            kind,
            share,
            seen: 3,
        };
        Told {
            ramp_ms: 500,
            variation: 15,
            swing: Swing {
                before: 0,
                is_learned,
            },
            known: Known {
                seconds: 20.0,
                band: 35.0,
            },
            looks: Vec::new(),
            found: Found {
                run_ups: Vec::new(),
                ramp: 0.8,
                variation: 0.2,
                sources: sources.iter().map(source).collect(),
            },
        }
    }

    #[test]
    fn the_largest_swing_of_its_own_is_written_where_it_is_learned() {
        let both = [
            (Kind::Order(1), 0.06),
            (Kind::Hertz(5.3004), 0.04),
            (Kind::Hertz(13.1), 0.02),
        ];
        let values = told(&both, true).values();
        assert_eq!(values, ["9004=800", "9010=20", "9034=5300"]);
        assert_eq!(told(&both, false).values(), ["9004=800", "9010=20"]);
        // Too small, and a line that may as well turn with the spindle.
        let none = [(Kind::Unknown(4.0), 0.04), (Kind::Hertz(5.3), 0.009)];
        assert_eq!(told(&none, true).values(), ["9004=800", "9010=20"]);
    }
}
