//! The error of an axis that is held to the spindle, over all ticks of a thread or of a run.
//!
//! There are two errors: by the true angle of the spindle, which only a simulation knows, and by the angle that the board
//! measures, which is all that a machine knows of itself [D172].

use leadscrew_core::alarm::Lang;
use leadscrew_core::link::{Certificate, Tally};

use crate::json::Json;
use crate::number;
use crate::words::{Both, both};

/// Sums of errors of synchronism.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Synchronism {
    /// Ticks with an error.
    pub ticks: u64,
    /// The largest error.
    pub worst_nm: i64,
    /// Sum of the squares.
    pub squares: f64,
}

impl Synchronism {
    /// Adds the error of the next tick.
    pub fn push(&mut self, error_nm: i64) {
        self.ticks += 1;
        self.worst_nm = self.worst_nm.max(error_nm.abs());
        self.squares += (error_nm as f64) * (error_nm as f64);
    }

    /// Adds the errors of a thread.
    pub fn add(&mut self, tally: &Tally) {
        self.ticks += u64::from(tally.measured);
        self.worst_nm = self.worst_nm.max(tally.largest.nm());
        self.squares += tally.squares as f64;
    }

    /// Root mean square in picometres.
    pub fn rms_pm(&self) -> i64 {
        let nm = (self.squares / self.ticks.max(1) as f64).sqrt();
        (nm * 1000.0).round() as i64
    }

    /// `"key": {"max", "rms"}` in micrometres; both null where there was none.
    pub fn field(&self, key: &str, json: &mut Json) {
        json.object_at(key, |json| {
            if self.ticks == 0 {
                json.null("max");
                json.null("rms");
            } else {
                json.decimal::<3>("max", self.worst_nm);
                json.decimal::<6>("rms", self.rms_pm());
            }
        });
    }

    /// The largest in micrometres, for a person.
    pub fn worst(&self) -> Both {
        micrometres(self.worst_nm)
    }

    /// Root mean square in micrometres, for a person.
    pub fn rms(&self) -> String {
        number::rounded::<6>(self.rms_pm(), 3)
    }

    /// The end of a line: the measured errors after the true ones. Empty where there are none.
    pub fn as_measured(&self, lang: Lang) -> String {
        if self.ticks == 0 {
            return String::new();
        }
        let (worst, rms) = (self.worst(), self.rms());
        both!(
            ", as measured {worst_en} µm ({rms} µm RMS)",
            "，测得 {worst_zh} µm（均方根 {rms} µm）",
            worst_en = worst.en,
            worst_zh = worst.zh
        )
        .get(lang)
        .to_owned()
    }
}

impl From<&Tally> for Synchronism {
    fn from(tally: &Tally) -> Self {
        let mut all = Self::default();
        all.add(tally);
        all
    }
}

impl From<&Certificate> for Synchronism {
    fn from(run: &Certificate) -> Self {
        Self {
            ticks: run.measured,
            worst_nm: run.largest.nm(),
            squares: run.squares as f64,
        }
    }
}

/// An error in micrometres for a person, with nanometres.
pub fn micrometres(nm: i64) -> Both {
    match nm {
        0 => Both {
            en: "below 0.001".into(),
            zh: "小于 0.001".into(),
        },
        nm => Both::same(number::text::<3>(nm)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use leadscrew_core::units::Length;

    #[test]
    fn errors_are_summed_up_one_by_one_and_by_threads() {
        let mut one = Synchronism::default();
        assert_eq!(one.as_measured(Lang::En), "");
        for error in [300, -400, 0] {
            one.push(error);
        }
        let tally = Tally {
            measured: 3,
            largest: Length::from_nm(400),
            squares: 250_000,
            ..Tally::NONE
        };
        assert_eq!(one, Synchronism::from(&tally));
        assert_eq!((one.worst_nm, one.rms_pm()), (400, 288_675));
        assert_eq!(
            one.as_measured(Lang::En),
            ", as measured 0.4 µm (0.289 µm RMS)"
        );
        assert_eq!(
            one.as_measured(Lang::Zh),
            "，测得 0.4 µm（均方根 0.289 µm）"
        );
        one.add(&tally);
        assert_eq!((one.ticks, one.squares), (6, 500_000.0));
        let mut json = Json::new();
        json.object(|json| {
            one.field("here", json);
            Synchronism::default().field("none", json);
        });
        let value: serde_json::Value = serde_json::from_slice(&json.into_bytes()).unwrap();
        assert_eq!(
            value,
            serde_json::json!({"here": {"max": 0.4, "rms": 0.288675}, "none": {"max": null, "rms": null}})
        );
    }
}
