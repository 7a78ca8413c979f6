//! What a board says of the cut of a thread, with how well it can know it [D381].
//!
//! The board compares its drive's own positions with the measured angle. What it cannot know is the instant of such a
//! position (9072, within 9075), what lies within a count of the drive or of the spindle's encoder, and whatever is behind
//! the motor. From the first three follows the uncertainty of each figure.

use leadscrew_core::alarm::Lang;
use leadscrew_core::link::{CutTally, ThreadKind, ThreadRecord};
use leadscrew_core::params::Params;
use leadscrew_core::units::{Axis, Length};

use crate::json::Json;
use crate::number;
use crate::values::Tolerance;
use crate::words::{Both, both};

/// Roundings of the board, in nanometres: of the helix, and of the position.
const ROUNDED: f64 = 2.0;

/// Leads that differ by less are one, in nanometres.
const SAME_LEAD: i64 = 2;

/// A figure and its uncertainty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figure {
    /// In nanometres.
    pub nm: f64,
    /// Its uncertainty, plus or minus.
    pub u_nm: f64,
}

impl Figure {
    fn new(of: Length, u_nm: f64) -> Self {
        Self {
            nm: of.nm() as f64,
            u_nm,
        }
    }

    /// `1.2 ± 0.3`, in micrometres.
    fn text(&self) -> String {
        format!("{} ± {}", micrometres(self.nm), upwards(self.u_nm))
    }

    /// Both in whole nanometres; an uncertainty is rounded up.
    pub fn whole(&self) -> [i64; 2] {
        [self.nm.round() as i64, self.u_nm.ceil() as i64]
    }

    /// `"key"` and `"key_u"`, in micrometres.
    pub fn fields(&self, key: &str, json: &mut Json) {
        let [nm, u_nm] = self.whole();
        json.decimal::<3>(key, nm);
        json.decimal::<3>(&format!("{key}_u"), u_nm);
    }
}

fn micrometres(nm: f64) -> String {
    number::rounded::<3>(nm.round() as i64, 1)
}

/// An uncertainty is rounded up.
fn upwards(nm: f64) -> String {
    micrometres((nm / 100.0).ceil() * 100.0)
}

/// How a cut stands to a tolerance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Within it, uncertainty included.
    Within,
    /// Beyond it, whatever the uncertainty.
    Beyond,
    /// Not known well enough, or not at all.
    Open,
}

/// What is known of the actual positions of an axis.
#[derive(Clone, Copy, Debug)]
struct Known {
    letter: char,
    /// The age of a position is known to within so many seconds.
    within: f64,
    is_known: bool,
    /// A count of the drive in nanometres.
    count: f64,
}

impl Known {
    /// Why the uncertainties are as large as they are, where the age of a position is not known.
    fn doubt(&self) -> Option<Both> {
        (!self.is_known).then(|| {
            both!(
                "the age of 6064h is not known: 9072.{letter}, 9075.{letter}",
                "6064h 的滞后时间未知：9072.{letter}、9075.{letter}",
                letter = self.letter
            )
        })
    }
}

/// Nothing is known of a cut.
pub fn nothing() -> Both {
    both!(
        "not known: no position of the drive came that could be judged (9021; a lead that changes is not judged)",
        "未知：没有可供判断的驱动器位置（9021；变导程不作判断）"
    )
}

/// No pass has a groove.
fn too_few() -> Both {
    both!(
        "groove not known (a pass has too few positions of the drive: 9021)",
        "螺旋槽位置未知（每次走刀的驱动器位置太少：9021）"
    )
}

/// Each pass has its groove; 255 also stands for more.
pub fn is_complete(record: &ThreadRecord) -> bool {
    let passes = record.cut.passes;
    passes == u8::MAX || (passes > 0 && u16::from(passes) >= record.tally.passes)
}

/// Judges the cuts that a board with these parameters has measured.
#[derive(Clone, Copy, Debug)]
pub struct Judge {
    axes: [Known; 2],
    /// Seconds between two positions.
    period: f64,
    /// Of the spindle's encoder in a turn.
    counts: f64,
    timed: bool,
    tolerance: Option<Tolerance>,
}

/// A cut with its uncertainties.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// The lowest and the highest groove; `None` where no pass has enough positions.
    pub grooves: Option<[Figure; 2]>,
    /// How far they are apart; `None` with fewer than two.
    pub apart: Option<Figure>,
    /// The largest error of the lead, in a turn.
    pub lead: Option<Figure>,
    /// The largest error.
    pub worst: Figure,
}

/// Where no thread is judged: for the built-in machine.
impl Default for Judge {
    fn default() -> Self {
        Self::new(&Params::slant_bed(), None)
    }
}

impl Judge {
    /// For a board with these parameters.
    pub fn new(params: &Params, tolerance: Option<Tolerance>) -> Self {
        let tick = f64::from(params.tick_us()) * 1e-6;
        let known = |axis: Axis| {
            let counts = f64::from(params.drive_numerator(axis).max(1));
            Known {
                letter: char::from(axis.letter()),
                within: f64::from(params.actual_age_doubt_us(axis)) * 1e-6,
                is_known: params.actual_age_within_us(axis) != 0,
                count: f64::from(params.drive_denominator(axis)) / counts,
            }
        };
        Self {
            axes: [known(Axis::X), known(Axis::Z)],
            period: tick * f64::from(params.drive_status_syncs()),
            counts: f64::from(params.encoder_counts().max(1)),
            timed: params.encoder_edge_time(),
            tolerance,
        }
    }

    const fn of(&self, cut: &CutTally) -> &Known {
        let [x, z] = &self.axes;
        if cut.on_x { x } else { z }
    }

    /// The figures of a cut; `None` where nothing was judged.
    pub fn found(&self, cut: &CutTally) -> Option<Found> {
        if cut.samples == 0 {
            return None;
        }
        let known = self.of(cut);
        let [slowest, fastest] = cut.per_second().map(|way| way.nm() as f64);
        let lead = cut.lead().nm() as f64;
        // Half a count of the encoder; the mean over many edges whose times are known has none of it.
        let angle = lead / (2.0 * self.counts);
        // Whether a drive rounds its count or cuts it off is not known.
        let coarse = known.count + if self.timed { 0.0 } else { angle } + ROUNDED;
        let mean = coarse + cut.scatter().nm() as f64;
        let by_age = fastest * known.within;
        let grooves = (cut.passes > 0).then(|| cut.grooves());
        let apart = (cut.passes > 1).then(|| {
            let [least, most] = cut.grooves();
            Figure::new(most - least, (fastest - slowest) * known.within + mean)
        });
        let slope = (cut.passes > 0).then(|| {
            // The two means that make the slope are a quarter of a pass apart: so many turns.
            let samples = f64::from(cut.samples) / f64::from(cut.passes);
            let turns = samples * self.period * (slowest + fastest) / (2.0 * lead.max(1.0));
            Figure::new(
                cut.slope(),
                2.0 * (mean + mean - coarse) / (turns / 4.0).max(0.01),
            )
        });
        // Between two positions, and before the first one of a pass, the error may be larger.
        let unseen = (cut.reach() - cut.worst()).nm().max(0) as f64;
        Some(Found {
            grooves: grooves.map(|both| both.map(|of| Figure::new(of, by_age + mean))),
            apart,
            lead: slope,
            worst: Figure::new(cut.worst(), by_age + known.count + angle + ROUNDED + unseen),
        })
    }

    /// How the cut of a thread stands to the tolerance; `None` without one, and for a hole.
    pub fn verdict(&self, record: &ThreadRecord) -> Option<Verdict> {
        let tolerance = self.tolerance?.pm as f64 / 1000.0;
        if record.kind != ThreadKind::Thread {
            return None;
        }
        let Some(found) = self.found(&record.cut) else {
            return Some(Verdict::Open);
        };
        let Figure { nm, u_nm } = found.worst;
        // A pass with hardly a position may be anywhere beside it.
        Some(if nm - u_nm > tolerance {
            Verdict::Beyond
        } else if nm + u_nm <= tolerance && is_complete(record) {
            Verdict::Within
        } else {
            Verdict::Open
        })
    }

    /// For a person; `None` for a hole, whose cut is not measured.
    pub fn words(&self, record: &ThreadRecord) -> Option<Both> {
        if record.kind != ThreadKind::Thread {
            return None;
        }
        let cut = &record.cut;
        let Some(found) = self.found(cut) else {
            return Some(nothing());
        };
        let grooves = match found.grooves {
            None => {
                let Both { en, zh } = too_few();
                both!("{en}, ", "{zh}，")
            }
            Some([one, _]) if cut.passes == 1 => both!(
                "groove {one} µm off, ",
                "螺旋槽偏移 {one} µm，",
                one = one.text()
            ),
            Some([least, most]) => both!(
                "grooves {least} to {most} µm off, ",
                "螺旋槽偏移 {least} 至 {most} µm，",
                least = micrometres(least.nm),
                most = most.text()
            ),
        };
        let apart = found.apart.map_or_else(Both::default, |apart| {
            both!(
                "{apart} µm apart, ",
                "相互偏移 {apart} µm，",
                apart = apart.text()
            )
        });
        let lead = found.lead.map_or_else(Both::default, |lead| {
            both!(
                "lead {lead} µm a turn off, ",
                "导程每转偏差 {lead} µm，",
                lead = lead.text()
            )
        });
        let known = self.of(cut);
        let age = known
            .doubt()
            .map_or_else(Both::default, |Both { en, zh }| both!("; {en}", "；{zh}"));
        let (seen_en, seen_zh) = if is_complete(record) {
            ("", "")
        } else {
            ("seen ", "（仅所见位置）")
        };
        Some(both!(
            "{grooves_en}{apart_en}{lead_en}worst {seen_en}{worst} µm{age_en}",
            "{grooves_zh}{apart_zh}{lead_zh}最大{seen_zh} {worst} µm{age_zh}",
            grooves_en = grooves.en,
            grooves_zh = grooves.zh,
            apart_en = apart.en,
            apart_zh = apart.zh,
            lead_en = lead.en,
            lead_zh = lead.zh,
            worst = found.worst.text(),
            age_en = age.en,
            age_zh = age.zh
        ))
    }

    /// What is not known of a cut that has figures, and why; `None` where all is known.
    pub fn missing(&self, record: &ThreadRecord) -> Option<Both> {
        let cut = &record.cut;
        let strokes = record.tally.passes;
        let grooves = match u16::from(cut.passes) {
            0 => Some(too_few()),
            _ if is_complete(record) => None,
            passes => Some(both!(
                "groove known of {passes} passes of {strokes} alone (the others have too few positions of the drive: 9021)",
                "{strokes} 次走刀中仅知 {passes} 次的螺旋槽位置（其余走刀的驱动器位置太少：9021）"
            )),
        };
        match (grooves, self.of(cut).doubt()) {
            (Some(grooves), Some(age)) => Some(both!(
                "{grooves_en}; {age_en}",
                "{grooves_zh}；{age_zh}",
                grooves_en = grooves.en,
                grooves_zh = grooves.zh,
                age_en = age.en,
                age_zh = age.zh
            )),
            (grooves, age) => grooves.or(age),
        }
    }

    /// Letter of the long axis, and whether the age of its positions is known.
    pub const fn axis(&self, cut: &CutTally) -> (char, bool) {
        let known = self.of(cut);
        (known.letter, known.is_known)
    }

    /// `cut` of a thread.
    pub fn field(&self, record: &ThreadRecord, json: &mut Json) {
        let cut = &record.cut;
        let Some(found) = self.found(cut) else {
            return json.null("cut");
        };
        let known = self.of(cut);
        json.object_at("cut", |json| {
            json.text("axis", known.letter.encode_utf8(&mut [0; 4]));
            json.number("positions", cut.samples);
            json.number("passes", cut.passes);
            json.decimal::<6>("lead_mm", cut.lead().nm());
            for (key, of) in [
                ("least_um", found.grooves.map(|of| of[0])),
                ("most_um", found.grooves.map(|of| of[1])),
                ("apart_um", found.apart),
                ("lead_um_per_turn", found.lead),
                ("worst_um", Some(found.worst)),
            ] {
                match of {
                    Some(of) => of.fields(key, json),
                    None => json.null(key),
                }
            }
            json.flag("age_known", known.is_known);
            match self.verdict(record) {
                Some(Verdict::Within) => json.flag("within_tolerance", true),
                Some(Verdict::Beyond) => json.flag("within_tolerance", false),
                Some(Verdict::Open) | None => json.null("within_tolerance"),
            }
        });
    }

    /// The largest distance between grooves of threads that follow each other with the same lead, such as passes that are
    /// blocks of their own.
    pub fn shift<'a>(&self, records: impl Iterator<Item = &'a ThreadRecord>) -> Option<Figure> {
        let cuts: Vec<&CutTally> = records
            .filter(|record| record.kind == ThreadKind::Thread && record.cut.passes > 0)
            .map(|record| &record.cut)
            .collect();
        let same = |a: &&CutTally, b: &&CutTally| {
            a.on_x == b.on_x && (a.lead().nm() - b.lead().nm()).abs() <= SAME_LEAD
        };
        let groups = cuts.chunk_by(same).filter(|group| group.len() > 1);
        let apart = groups.filter_map(|group| {
            let (first, others) = group.split_first()?;
            let mut all = **first;
            for cut in others {
                all.join(cut);
            }
            self.found(&all)?.apart
        });
        apart.reduce(|a, b| if b.nm > a.nm { b } else { a })
    }

    /// [`shift`](Self::shift) for a person.
    pub fn shift_words(&self, shift: Figure, lang: Lang) -> String {
        both!(
            "cut: grooves of the same lead {shift} µm apart\n",
            "切削：相同导程的螺旋槽相互偏移 {shift} µm\n",
            shift = shift.text()
        )
        .get(lang)
        .to_owned()
    }
}

#[cfg(test)]
mod tests {
    use leadscrew_core::link::{PassCut, Tally, ThreadState};

    use super::*;

    /// A thread of two passes of 3 µm, of which so many had positions for their groove.
    fn thread(grooves: u8) -> ThreadRecord {
        let nm = Length::from_nm;
        let mut cut = CutTally::NONE;
        for _ in 0..2 + 40 * u16::from(grooves) {
            cut.take(nm(3_000), nm(0), nm(1_500_000), nm(10_000_000));
        }
        for _ in 0..grooves {
            cut.close(&PassCut {
                groove: nm(3_000),
                slope: nm(0),
                scatter: nm(0),
            });
        }
        ThreadRecord {
            line: 1,
            kind: ThreadKind::Thread,
            state: ThreadState::Finished,
            tally: Tally {
                passes: 2,
                ..Tally::NONE
            },
            cut,
        }
    }

    #[test]
    fn a_thread_is_good_only_where_each_pass_was_seen() {
        let judge = |um: i64| {
            let tolerance = Tolerance { pm: um * 1_000_000 };
            Judge::new(&Params::slant_bed(), Some(tolerance))
        };
        for (grooves, verdict) in [(0, Verdict::Open), (1, Verdict::Open), (2, Verdict::Within)] {
            let record = thread(grooves);
            assert_eq!(judge(40).verdict(&record), Some(verdict), "{grooves}");
            let told = judge(40).words(&record).unwrap();
            assert_eq!(told.en.contains("worst seen"), grooves < 2, "{}", told.en);
            // What was seen beyond it is beyond it.
            let narrow = judge(1).verdict(&record);
            assert_ne!(narrow, Some(Verdict::Within));
        }
    }
}
