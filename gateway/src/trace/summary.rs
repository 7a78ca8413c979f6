//! The closing summary of a run: figures, certificate and hash.

use super::{Peaks, Setpoint, SetpointHash};
use crate::json::Json;
use crate::number;
use crate::values::Tolerance;

/// Everything that is said about a stream of setpoints at its end.
#[derive(Debug)]
pub struct Summary {
    tick_us: u32,
    ticks: u64,
    moves: u64,
    last: Option<(i64, i64)>,
    path_nm: f64,
    locked: u64,
    error_max_nm: i64,
    error_squares: f64,
    peaks: Peaks,
    hash: SetpointHash,
}

impl Summary {
    /// Nothing yet.
    pub fn new(tick_us: u32) -> Self {
        Self {
            tick_us,
            ticks: 0,
            moves: 0,
            last: None,
            path_nm: 0.0,
            locked: 0,
            error_max_nm: 0,
            error_squares: 0.0,
            peaks: Peaks::default(),
            hash: SetpointHash::default(),
        }
    }

    /// Takes in the next tick; gives the speeds of X, Z and C in nanometres per tick.
    pub fn push(&mut self, point: &Setpoint) -> [i64; 3] {
        self.ticks = point.tick;
        self.moves = self.moves.max(point.step);
        if let Some((x, z)) = self.last.replace((point.x_nm, point.z_nm)) {
            // Per tick far below 2⁵³ nm, so nothing is lost in the conversion.
            self.path_nm += ((point.x_nm - x) as f64).hypot((point.z_nm - z) as f64);
        }
        if let Some(error) = point.error_nm {
            self.locked += 1;
            self.error_max_nm = self.error_max_nm.max(error.abs());
            self.error_squares += (error as f64) * (error as f64);
        }
        self.hash.push(point);
        self.peaks.push(point)
    }

    /// The worst synchronism error is within `tolerance`; true where nothing was synchronised.
    pub fn within(&self, tolerance: Tolerance) -> bool {
        self.error_max_nm.saturating_mul(1000) <= tolerance.pm
    }

    /// Why a tolerance is not met.
    pub fn above(&self, tolerance: Tolerance) -> String {
        format!(
            "the worst synchronism error {} µm is above the tolerance of {} µm",
            number::text::<3>(self.error_max_nm),
            number::text::<6>(tolerance.pm),
        )
    }

    /// The hash of the setpoints.
    pub fn hash(&self) -> String {
        self.hash.text()
    }

    /// Root mean square of the error in picometres.
    fn error_rms_pm(&self) -> i64 {
        let nm = (self.error_squares / self.locked.max(1) as f64).sqrt();
        (nm * 1000.0).round() as i64
    }

    fn path(&self) -> i64 {
        self.path_nm.round() as i64
    }

    fn time_us(&self) -> i64 {
        i64::try_from(self.ticks.saturating_mul(u64::from(self.tick_us))).unwrap_or(i64::MAX)
    }

    /// The contract's fields, without the brackets around them.
    pub fn fields(&self, json: &mut Json) {
        json.integer("moves", i64::try_from(self.moves).unwrap_or(i64::MAX));
        json.integer("ticks", i64::try_from(self.ticks).unwrap_or(i64::MAX));
        json.decimal::<6>("time_s", self.time_us());
        json.decimal::<6>("path_mm", self.path());
        json.text("setpoint_hash", &self.hash.text());
        json.object_at("sync_error_um", |json| {
            if self.locked == 0 {
                json.null("max");
                json.null("rms");
            } else {
                json.decimal::<3>("max", self.error_max_nm);
                json.decimal::<6>("rms", self.error_rms_pm());
            }
        });
        json.object_at("peak", |json| {
            for (axis, peak) in ["x", "z", "c"].into_iter().zip(self.peaks.overall()) {
                json.object_at(axis, |json| {
                    json.decimal::<6>("speed_mm_min", self.per_minute(peak.speed));
                    json.decimal::<6>(
                        "acceleration_m_s2",
                        self.per_second(peak.acceleration, 2) / 1000,
                    );
                    json.decimal::<6>("jerk_m_s3", self.per_second(peak.jerk, 3) / 1000);
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

    /// The worst error for a person; the simulation tells nanometres apart.
    fn worst(&self) -> String {
        match self.error_max_nm {
            0 => "below 0.001".into(),
            nm => number::text::<3>(nm),
        }
    }

    /// One line: moves, time, path, synchronism.
    pub fn line(&self) -> String {
        let mut line = format!(
            "{} moves · {} s · path {} mm",
            self.moves,
            number::rounded::<6>(self.time_us(), 3),
            number::rounded::<6>(self.path(), 3),
        );
        if self.locked > 0 {
            line.push_str(&format!(
                " · worst synchronism error {} µm ({} µm RMS)",
                self.worst(),
                number::rounded::<6>(self.error_rms_pm(), 3),
            ));
        }
        line
    }

    /// For a person: a few lines with a table of peaks.
    pub fn text(&self) -> String {
        let mut text = format!(
            "moves       {}\ntime        {} s ({} ticks of {} µs)\npath        {} mm\n",
            self.moves,
            number::rounded::<6>(self.time_us(), 6),
            self.ticks,
            self.tick_us,
            number::rounded::<6>(self.path(), 3),
        );
        if self.locked > 0 {
            text.push_str(&format!(
                "synchronism worst {} µm, {} µm RMS over {} locked ticks\n",
                self.worst(),
                number::rounded::<6>(self.error_rms_pm(), 3),
                self.locked,
            ));
        } else {
            text.push_str("synchronism nothing was locked to the spindle\n");
        }
        text.push_str(&format!("setpoints   {}\n", self.hash.text()));
        text.push_str("peaks            speed mm/min   acceleration m/s²   jerk m/s³\n");
        self.peak_rows(&mut text, "", &self.peaks.free);
        if self.locked > 0 {
            self.peak_rows(&mut text, " locked", &self.peaks.locked);
        }
        text
    }

    fn peak_rows(&self, text: &mut String, label: &str, peaks: &[super::Peak; 3]) {
        for (axis, peak) in ["X", "Z", "C"].into_iter().zip(peaks) {
            if *peak == super::Peak::default() {
                continue;
            }
            let row = format!(
                "  {:<13} {:>13} {:>19} {:>11}\n",
                format!("{axis}{label}"),
                number::rounded::<6>(self.per_minute(peak.speed), 1),
                number::rounded::<9>(self.per_second(peak.acceleration, 2), 4),
                number::rounded::<9>(self.per_second(peak.jerk, 3), 2),
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
        let mut summary = Summary::new(1000);
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
                state: Doing::Run,
                error_nm,
                ..Setpoint::default()
            });
        }
        assert!(summary.within(Tolerance { pm: 400_000 }));
        assert!(!summary.within(Tolerance { pm: 399_999 }));
        assert_eq!(
            summary.line(),
            "1 moves · 0.002 s · path 0.01 mm · worst synchronism error 0.4 µm (0.354 µm RMS)"
        );
        let mut json = Json::new();
        json.object(|json| summary.fields(json));
        let value: serde_json::Value = serde_json::from_slice(&json.into_bytes()).unwrap();
        assert_eq!(value["path_mm"], 0.01);
        assert_eq!(value["sync_error_um"]["max"], 0.4);
        assert_eq!(value["peak"]["z"]["speed_mm_min"], 240.0);
        assert_eq!(value["late"], 0);
    }
}
