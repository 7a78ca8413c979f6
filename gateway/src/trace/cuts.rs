//! What a tool truly cuts where drives are not ideal: the error of each pass of a thread, and the shift between passes.
//!
//! Only a simulation knows it. The error is that of the tool from the exact helix at the true angle of the spindle, both
//! at one instant. The drive settles in the first half of a pass; mean and slope are of the second half, so passes at
//! different speeds are compared where each has settled. The worst is of the whole pass.

use leadscrew_core::alarm::Lang;

use super::{Cut, Setpoint};
use crate::json::Json;
use crate::number;
use crate::place::SourceLine;
use crate::words::{Both, both};

/// The most points kept of a pass; a longer one keeps every second, every fourth.
const KEPT: usize = 1 << 14;

/// The most passes that a person is told of one by one.
const NAMED: usize = 24;

/// Leads that differ by less are one: half a nanometre of rounding at both ends.
const SAME_LEAD_NM: i64 = 2;

/// The cut of a pass.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Pass {
    line: u32,
    /// The way of the helix in a turn.
    lead_nm: i64,
    /// Mean error of the second half: where its groove lies.
    mean_nm: f64,
    /// Change of the error in a turn there: the error of its lead.
    slope_nm: f64,
    worst_nm: i64,
}

/// A pass that is being cut.
#[derive(Debug)]
struct Open {
    line: u32,
    lead_nm: i64,
    worst_nm: i64,
    /// Turns since its first point, and the error in nanometres.
    points: Vec<(f64, f64)>,
    first_raw: i64,
    /// Of so many ticks one is kept.
    every: u64,
    seen: u64,
}

impl Open {
    fn new(point: &Setpoint, cut: Cut) -> Self {
        Self {
            line: point.line,
            lead_nm: cut.lead_nm,
            worst_nm: 0,
            points: Vec::new(),
            first_raw: cut.angle_raw,
            every: 1,
            seen: 0,
        }
    }

    fn push(&mut self, cut: Cut) {
        self.worst_nm = self.worst_nm.max(cut.error_nm.abs());
        let wanted = self.seen.is_multiple_of(self.every);
        self.seen += 1;
        if !wanted {
            return;
        }
        let turns = (cut.angle_raw - self.first_raw) as f64 / 2_f64.powi(32);
        self.points.push((turns, cut.error_nm as f64));
        if self.points.len() >= KEPT {
            let mut odd = false;
            self.points.retain(|_| {
                odd = !odd;
                odd
            });
            self.every *= 2;
        }
    }

    fn close(self) -> Pass {
        let last = self.points.last().map_or(0.0, |point| point.0);
        let settled = |point: &&(f64, f64)| point.0.abs() >= last.abs() / 2.0;
        let half: Vec<(f64, f64)> = self.points.iter().filter(settled).copied().collect();
        let n = half.len().max(1) as f64;
        let mean = |of: fn(&(f64, f64)) -> f64| half.iter().map(of).sum::<f64>() / n;
        let (turns, error) = (mean(|p| p.0), mean(|p| p.1));
        let (mut square, mut product) = (0.0, 0.0);
        for point in &half {
            square += (point.0 - turns) * (point.0 - turns);
            product += (point.0 - turns) * (point.1 - error);
        }
        Pass {
            line: self.line,
            lead_nm: self.lead_nm,
            mean_nm: error,
            slope_nm: if square > 0.0 { product / square } else { 0.0 },
            worst_nm: self.worst_nm,
        }
    }
}

/// The cuts of a run.
#[derive(Debug, Default)]
pub struct Cuts {
    passes: Vec<Pass>,
    open: Option<Open>,
}

impl Cuts {
    /// Takes in the next tick.
    pub fn push(&mut self, point: &Setpoint) {
        // Stroke and run-out are two moves of one pass.
        let is_next = |open: &Open| open.line != point.line;
        if point.cut.is_none() || self.open.as_ref().is_some_and(is_next) {
            self.passes.extend(self.open.take().map(Open::close));
        }
        if let Some(cut) = point.cut {
            let open = self.open.get_or_insert_with(|| Open::new(point, cut));
            open.push(cut);
        }
    }

    /// All passes, the last one too.
    fn all(&self) -> &[Pass] {
        debug_assert!(self.open.is_none(), "the machine stands at the end");
        &self.passes
    }

    /// The largest distance between grooves of passes that follow each other with the same lead; `None` where no two do.
    fn shift_nm(&self) -> Option<f64> {
        let same = |a: &Pass, b: &Pass| (a.lead_nm - b.lead_nm).abs() <= SAME_LEAD_NM;
        let threads = self.all().chunk_by(same).filter(|passes| passes.len() > 1);
        let spread = |passes: &[Pass]| {
            let means = || passes.iter().map(|pass| pass.mean_nm);
            means().fold(f64::MIN, f64::max) - means().fold(f64::MAX, f64::min)
        };
        threads.map(spread).reduce(f64::max)
    }

    /// For a person, with what the drives are.
    pub fn text(&self, drives: &Both, lang: Lang) -> String {
        let mut text = both!(
            "cut         {en}\n",
            "切削        {zh}\n",
            en = drives.en,
            zh = drives.zh
        )
        .get(lang)
        .to_owned();
        for pass in self.all().iter().take(NAMED) {
            let line = SourceLine(pass.line);
            let [mean, worst] = [pass.mean_nm, pass.worst_nm as f64].map(micrometres);
            let slope = number::rounded::<6>((pass.slope_nm * 1000.0).round() as i64, 3);
            let told = both!(
                "  line {line}: groove {mean} µm off, lead {slope} µm a turn off, worst {worst} µm\n",
                "  第 {line} 行：螺旋槽偏移 {mean} µm，导程每转偏差 {slope} µm，最大 {worst} µm\n"
            );
            text.push_str(told.get(lang));
        }
        let more = self.all().len().saturating_sub(NAMED);
        if more > 0 {
            let told = both!(
                "  and {more} passes more; `--json` has them all\n",
                "  另有 {more} 次走刀；`--json` 可列出全部\n"
            );
            text.push_str(told.get(lang));
        }
        if let Some(shift) = self.shift_nm() {
            let shift = micrometres(shift);
            let told = both!(
                "  shift between passes {shift} µm\n",
                "  各次走刀之间的偏移 {shift} µm\n"
            );
            text.push_str(told.get(lang));
        }
        text
    }

    /// `cut` of a result.
    pub fn field(&self, drives: &Both, json: &mut Json) {
        json.object_at("cut", |json| {
            json.text("drives", &drives.en);
            json.array_at("passes", |json| {
                for pass in self.all() {
                    json.object(|json| {
                        let line = SourceLine(pass.line);
                        if let Some(file) = line.file() {
                            json.text("file", &file);
                        }
                        json.number("line", line.in_file());
                        json.decimal::<6>("lead_mm", pass.lead_nm);
                        json.decimal::<6>("groove_um", (pass.mean_nm * 1000.0).round() as i64);
                        json.decimal::<6>(
                            "lead_um_per_turn",
                            (pass.slope_nm * 1000.0).round() as i64,
                        );
                        json.decimal::<3>("worst_um", pass.worst_nm);
                    });
                }
            });
            match self.shift_nm() {
                Some(shift) => json.decimal::<6>("shift_um", (shift * 1000.0).round() as i64),
                None => json.null("shift_um"),
            }
        });
    }
}

fn micrometres(nm: f64) -> String {
    number::rounded::<3>(nm.round() as i64, 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A pass of ten turns whose error settles from 0 to `groove` in the first half and then grows by `slope` a turn.
    fn cut(cuts: &mut Cuts, line: u32, lead_nm: i64, groove: i64, slope: i64) {
        for tick in 0..=1000_i64 {
            let settled = tick >= 500;
            let grown = (tick - 750) * slope / 100;
            cuts.push(&Setpoint {
                line,
                // The run-out is a move of its own.
                step: u64::from(line) + u64::from(tick > 900),
                cut: Some(Cut {
                    angle_raw: (tick << 32) / 100,
                    error_nm: if settled { groove + grown } else { 0 },
                    lead_nm,
                }),
                ..Setpoint::default()
            });
        }
        cuts.push(&Setpoint::default());
    }

    #[test]
    fn a_pass_has_a_groove_a_lead_and_a_worst_error() {
        let mut cuts = Cuts::default();
        cut(&mut cuts, 7, 6_000_000, -2_000, 100);
        let [pass] = cuts.all() else {
            panic!("one pass");
        };
        assert_eq!(
            (pass.line, pass.lead_nm, pass.worst_nm),
            (7, 6_000_000, 2_250)
        );
        assert!((pass.mean_nm + 2_000.0).abs() < 1.0, "{pass:?}");
        assert!((pass.slope_nm - 100.0).abs() < 0.1, "{pass:?}");
        assert_eq!(cuts.shift_nm(), None);
    }

    #[test]
    fn the_shift_is_between_passes_of_one_thread() {
        let mut cuts = Cuts::default();
        cut(&mut cuts, 1, 6_000_000, 0, 0);
        cut(&mut cuts, 2, 6_000_001, 1_000, 0);
        cut(&mut cuts, 3, 2_000_000, 90_000, 0);
        assert_eq!(cuts.shift_nm(), Some(1_000.0));
        let drives = Both::same("Z kv30");
        let told = cuts.text(&drives, Lang::En);
        let expected = "cut         Z kv30\n  line 1: groove 0 µm off, lead 0 µm a turn off, worst 0 µm\n  \
                        line 2: groove 1 µm off, lead 0 µm a turn off, worst 1 µm\n  \
                        line 3: groove 90 µm off, lead 0 µm a turn off, worst 90 µm\n  shift between passes 1 µm\n";
        assert_eq!(told, expected);
        let mut json = Json::new();
        json.object(|json| cuts.field(&drives, json));
        let value: serde_json::Value = serde_json::from_slice(&json.into_bytes()).unwrap();
        assert_eq!(value["cut"]["shift_um"], 1.0);
        assert_eq!(value["cut"]["passes"][2]["groove_um"], 90.0);
        assert_eq!(value["cut"]["passes"][2]["lead_mm"], 2);
    }

    #[test]
    fn a_long_pass_is_thinned_out_and_says_the_same() {
        let mut cuts = Cuts::default();
        let ticks = 3 * KEPT as i64;
        for tick in 0..ticks {
            cuts.push(&Setpoint {
                line: 1,
                step: 1,
                cut: Some(Cut {
                    angle_raw: tick << 24,
                    error_nm: tick,
                    lead_nm: 1,
                }),
                ..Setpoint::default()
            });
        }
        assert!(
            cuts.open
                .as_ref()
                .is_some_and(|open| open.points.len() < KEPT)
        );
        cuts.push(&Setpoint::default());
        let pass = cuts.all()[0];
        assert!((pass.mean_nm - ticks as f64 * 0.75).abs() < 4.0, "{pass:?}");
        assert!((pass.slope_nm - 256.0).abs() < 1e-6, "{pass:?}");
        assert_eq!(pass.worst_nm, ticks - 1);
    }
}
