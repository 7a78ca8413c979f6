//! The closing summary of a run: figures, certificate and hash.

use std::collections::BTreeMap;

use leadscrew_core::alarm::Lang;
use leadscrew_core::params::Params;
use leadscrew_core::units::Axis;

use super::{Cuts, Peaks, Setpoint, SetpointHash, Taps};
use crate::checking::plural;
use crate::json::Json;
use crate::number;
use crate::synchronism::Synchronism;
use crate::threads::Above;
use crate::values::Tolerance;
use crate::words::{Both, both, pick};

/// Everything that is said about a stream of setpoints at its end.
#[derive(Debug)]
pub struct Summary {
    tick_us: u32,
    /// Of X, Z and C.
    limits: [Limits; 3],
    ticks: u64,
    moves: u64,
    /// Those of the passes before this one.
    before: u64,
    /// The number of the last move, and whether the machine has stood since.
    step: (u64, bool),
    last: Option<(i64, i64)>,
    path_nm: f64,
    /// By the true angle of the spindle.
    errors: Synchronism,
    /// The largest of these errors, by line.
    worst: BTreeMap<u32, i64>,
    peaks: Peaks,
    taps: Taps,
    cuts: Cuts,
    /// The drives, where one of them is not ideal.
    drives: Option<Both>,
    hash: SetpointHash,
}

/// What an axis may do: nanometres (C: millionths of a degree) per minute, per second squared and cubed.
#[derive(Clone, Copy, Debug)]
struct Limits {
    /// Its rapid rate: no motion is faster.
    speed: i64,
    acceleration: i64,
    jerk: i64,
}

impl Limits {
    fn of(params: &Params, axis: Axis) -> Self {
        Self {
            speed: params.rapid(axis).nm_per_min(),
            acceleration: params.motion_acceleration(axis).nm_per_s2(),
            jerk: params.motion_jerk(axis).nm_per_s3(),
        }
    }
}

impl Summary {
    /// Nothing yet, of this machine.
    pub fn new(params: &Params) -> Self {
        Self {
            tick_us: params.tick_us(),
            limits: Axis::ALL.map(|axis| Limits::of(params, axis)),
            ticks: 0,
            moves: 0,
            before: 0,
            step: (0, false),
            last: None,
            path_nm: 0.0,
            errors: Synchronism::default(),
            worst: BTreeMap::new(),
            peaks: Peaks::default(),
            taps: Taps::default(),
            cuts: Cuts::default(),
            drives: None,
            hash: SetpointHash::default(),
        }
    }

    /// Says of the cut, too, as these drives do it; `None`: all of them are ideal.
    #[must_use]
    pub fn with_drives(mut self, drives: Option<Both>) -> Self {
        self.drives = drives;
        self
    }

    /// Takes in the next tick; gives the speeds of X, Z and C in nanometres per tick.
    pub fn push(&mut self, point: &Setpoint) -> [i64; 3] {
        self.ticks = point.tick;
        self.count(point.step);
        if let Some((x, z)) = self.last.replace((point.x_nm, point.z_nm)) {
            // Per tick far below 2⁵³ nm, so nothing is lost in the conversion.
            self.path_nm += ((point.x_nm - x) as f64).hypot((point.z_nm - z) as f64);
        }
        if let Some(error) = point.error_nm {
            self.errors.push(error);
            let worst = self.worst.entry(point.line).or_default();
            *worst = error.abs().max(*worst);
        }
        self.taps.push(point.tap);
        self.cuts.push(point);
        self.hash.push(point);
        self.peaks.push(point)
    }

    /// Counts a move. The passes of a program that repeats itself each number their moves from the front.
    fn count(&mut self, step: u64) {
        let (last, stood) = self.step;
        if step == 0 {
            self.step.1 = true;
            return;
        }
        if step < last || (stood && step == last) {
            self.before += last;
        }
        self.step = (step, false);
        self.moves = self.before + step;
    }

    /// The lines in which the true error is above `tolerance`, and the largest of all.
    pub fn above(&self, tolerance: Tolerance) -> Option<Above> {
        let beyond = |(_, nm): &(&u32, &i64)| tolerance.is_below(**nm);
        let lines: Vec<u32> = self
            .worst
            .iter()
            .filter(beyond)
            .map(|(line, _)| *line)
            .collect();
        (!lines.is_empty()).then_some(Above {
            worst_nm: self.errors.worst_nm,
            cut_nm: None,
            lines,
        })
    }

    /// The hash of the setpoints.
    pub fn hash(&self) -> String {
        self.hash.text()
    }

    fn path(&self) -> i64 {
        self.path_nm.round() as i64
    }

    fn time_us(&self) -> i64 {
        i64::try_from(self.ticks.saturating_mul(u64::from(self.tick_us))).unwrap_or(i64::MAX)
    }

    /// The contract's fields, without the brackets around them, and the errors as the board has `measured` them.
    pub fn fields(&self, measured: &Synchronism, json: &mut Json) {
        json.integer("moves", i64::try_from(self.moves).unwrap_or(i64::MAX));
        json.integer("ticks", i64::try_from(self.ticks).unwrap_or(i64::MAX));
        json.decimal::<6>("time_s", self.time_us());
        json.decimal::<6>("path_mm", self.path());
        json.text("setpoint_hash", &self.hash.text());
        self.errors.field("sync_error_um", json);
        measured.field("measured_error_um", json);
        self.taps.fields(json, self.tick_us);
        if let Some(drives) = &self.drives {
            self.cuts.field(drives, json);
        }
        json.object_at("peak", |json| {
            let peaks = self.peaks.overall().into_iter().zip(self.limits);
            for (axis, (peak, limits)) in ["x", "z", "c"].into_iter().zip(peaks) {
                json.object_at(axis, |json| {
                    json.decimal::<6>("speed_mm_min", self.per_minute(peak.speed));
                    json.decimal::<6>(
                        "acceleration_m_s2",
                        self.per_second(peak.acceleration, 2) / 1000,
                    );
                    json.decimal::<6>("jerk_m_s3", self.per_second(peak.jerk, 3) / 1000);
                    json.decimal::<6>("speed_limit_mm_min", limits.speed);
                    json.decimal::<6>("acceleration_limit_m_s2", limits.acceleration / 1000);
                    json.decimal::<6>("jerk_limit_m_s3", limits.jerk / 1000);
                });
            }
        });
        // The simulated machine takes virtual time: a setpoint cannot come late.
        json.integer("late", 0);
    }

    /// Nanometres per minute.
    fn per_minute(&self, per_tick: i64) -> i64 {
        let value = i128::from(per_tick) * 60_000_000 / i128::from(self.tick_us.max(1));
        i64::try_from(value).unwrap_or(i64::MAX)
    }

    /// Nanometres per second to the power `n`.
    fn per_second(&self, per_tick: i64, n: u32) -> i64 {
        let value =
            i128::from(per_tick) * 1_000_000i128.pow(n) / i128::from(self.tick_us.max(1)).pow(n);
        i64::try_from(value).unwrap_or(i64::MAX)
    }

    /// One line: moves, time, path, synchronism.
    pub fn line(&self, lang: Lang) -> String {
        let moves = self.moves;
        let time = number::rounded::<6>(self.time_us(), 3);
        let path = number::rounded::<6>(self.path(), 3);
        let mut line = both!(
            "{words} · {time} s · path {path} mm",
            "移动 {moves} 段 · {time} s · 路径 {path} mm",
            words = plural(moves, "move")
        )
        .get(lang)
        .to_owned();
        if self.errors.ticks > 0 {
            let rms = self.errors.rms();
            let worst = self.errors.worst();
            let worst = worst.get(lang);
            let synchronism = both!(
                " · worst synchronism error {worst} µm ({rms} µm RMS)",
                " · 最大同步误差 {worst} µm（均方根 {rms} µm）"
            );
            line.push_str(synchronism.get(lang));
        }
        line
    }

    /// What the taps did, in a line.
    pub fn taps(&self) -> Option<Both> {
        self.taps.words(self.tick_us)
    }

    /// The cuts, where a drive is not ideal.
    pub fn cuts(&self, lang: Lang) -> Option<String> {
        let drives = self.drives.as_ref()?;
        Some(self.cuts.text(drives, lang))
    }

    /// For a person: a few lines with a table of peaks; the errors as the board has `measured` them, too.
    pub fn text(&self, measured: &Synchronism, lang: Lang) -> String {
        let (moves, ticks, tick) = (self.moves, self.ticks, self.tick_us);
        let time = number::rounded::<6>(self.time_us(), 6);
        let path = number::rounded::<6>(self.path(), 3);
        let mut text = both!(
            "moves       {moves}\ntime        {time} s ({ticks} ticks of {tick} µs)\npath        {path} mm\n",
            "移动        {moves} 段\n时间        {time} s（{ticks} 个周期，每个 {tick} µs）\n路径        {path} mm\n"
        )
        .get(lang)
        .to_owned();
        let synchronism = if self.errors.ticks > 0 {
            let (errors, locked) = (&self.errors, self.errors.ticks);
            let ([true_worst, worst], [true_rms, rms]) = (
                [errors.worst(), measured.worst()],
                [errors.rms(), measured.rms()],
            );
            let (true_worst, worst) = (true_worst.get(lang), worst.get(lang));
            both!(
                "synchronism worst {true_worst} µm, {true_rms} µm RMS over {locked} locked ticks, by the spindle's true angle\n\
                 measured    worst {worst} µm, {rms} µm RMS, by the angle that the board measures\n",
                "同步        最大误差 {true_worst} µm，均方根 {true_rms} µm，锁定 {locked} 个周期，按主轴真实角度\n\
                 测得        最大误差 {worst} µm，均方根 {rms} µm，按控制板测得的角度\n"
            )
        } else {
            both!(
                "synchronism nothing was locked to the spindle\n",
                "同步        没有与主轴锁定的运动\n"
            )
        };
        text.push_str(synchronism.get(lang));
        if let Some(taps) = self.taps() {
            text.push_str(pick(lang, "taps        ", "攻丝        "));
            text.push_str(taps.get(lang));
            text.push('\n');
        }
        if let Some(cuts) = self.cuts(lang) {
            text.push_str(&cuts);
        }
        text.push_str(pick(lang, "setpoints   ", "设定值校验  "));
        text.push_str(&self.hash.text());
        text.push_str(pick(
            lang,
            "\npeaks / what the axis may do\n                       speed mm/min   acceleration m/s²           jerk m/s³\n",
            "\n峰值 / 该轴的允许值\n                        速度 mm/min         加速度 m/s²      加加速度 m/s³\n",
        ));
        self.peak_rows(&mut text, "", &self.peaks.free);
        if self.errors.ticks > 0 {
            self.peak_rows(
                &mut text,
                pick(lang, " locked", " 锁定"),
                &self.peaks.locked,
            );
        }
        // Half a nanometre either way, in differences of the second and the third order.
        let acceleration = number::rounded::<9>(self.per_second(2, 2), 4);
        let jerk = number::rounded::<9>(self.per_second(4, 3), 2);
        let rounding = both!(
            "  (setpoints are whole nanometres: that alone can add {acceleration} m/s² and {jerk} m/s³)\n",
            "  （设定值取整到纳米：仅此一项即可增加 {acceleration} m/s² 和 {jerk} m/s³）\n"
        );
        text.push_str(rounding.get(lang));
        text
    }

    fn peak_rows(&self, text: &mut String, label: &str, peaks: &[super::Peak; 3]) {
        let peaks = peaks.iter().zip(self.limits);
        for (axis, (peak, limits)) in ["X", "Z", "C"].into_iter().zip(peaks) {
            if *peak == super::Peak::default() {
                continue;
            }
            let speed = number::rounded::<6>(self.per_minute(peak.speed), 1);
            let acceleration = number::rounded::<9>(self.per_second(peak.acceleration, 2), 4);
            let jerk = number::rounded::<9>(self.per_second(peak.jerk, 3), 2);
            let row = format!(
                "  {:<13} {:>19} {:>19} {:>19}\n",
                format!("{axis}{label}"),
                format!("{speed} / {}", number::rounded::<6>(limits.speed, 1)),
                format!(
                    "{acceleration} / {}",
                    number::rounded::<9>(limits.acceleration, 4)
                ),
                format!("{jerk} / {}", number::rounded::<9>(limits.jerk, 2)),
            );
            text.push_str(&row);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use leadscrew_board_sim::Doing;

    #[test]
    fn sums_up_what_went_by() {
        let params = Params::sheets();
        let mut summary = Summary::new(&params);
        for (tick, (x_nm, z_nm, error_nm)) in [
            (0, 0, None),
            (3_000, 4_000, Some(300)),
            (6_000, 8_000, Some(-400)),
        ]
        .into_iter()
        .enumerate()
        {
            summary.push(&Setpoint {
                tick: tick as u64,
                x_nm,
                z_nm,
                step: 1,
                line: 7,
                state: Doing::Run,
                error_nm,
                ..Setpoint::default()
            });
        }
        assert_eq!(summary.above(Tolerance { pm: 400_000 }), None);
        assert_eq!(
            summary.above(Tolerance { pm: 399_999 }),
            Some(Above {
                worst_nm: 400,
                cut_nm: None,
                lines: vec![7]
            })
        );
        assert_eq!(
            summary.line(Lang::En),
            "1 move · 0.002 s · path 0.01 mm · worst synchronism error 0.4 µm (0.354 µm RMS)"
        );
        assert_eq!(
            summary.line(Lang::Zh),
            "移动 1 段 · 0.002 s · 路径 0.01 mm · 最大同步误差 0.4 µm（均方根 0.354 µm）"
        );
        let mut json = Json::new();
        json.object(|json| summary.fields(&Synchronism::default(), json));
        let value: serde_json::Value = serde_json::from_slice(&json.into_bytes()).unwrap();
        assert_eq!(value["path_mm"], 0.01);
        assert_eq!(value["sync_error_um"]["max"], 0.4);
        assert_eq!(value["peak"]["z"]["speed_mm_min"], 240.0);
        let limits = |axis: &str| {
            [
                "speed_limit_mm_min",
                "acceleration_limit_m_s2",
                "jerk_limit_m_s3",
            ]
            .map(|key| value["peak"][axis][key].as_f64())
        };
        assert_eq!(limits("x"), [12_000.0, 2.0, 60.0].map(Some));
        assert_eq!(limits("z"), [16_000.0, 3.0, 60.0].map(Some));
        assert_eq!(limits("c")[..2], [432_000.0, 20.0].map(Some));
        let text = summary.text(&Synchronism::default(), Lang::En);
        assert!(text.contains(" 240 / 16000 "), "{text}");
        assert_eq!(value["late"], 0);
    }
}
