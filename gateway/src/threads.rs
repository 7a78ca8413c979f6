//! The certificates of the threads and holes of a run. A board tells the last few; they are collected here and reported.

use std::collections::BTreeMap;

use leadscrew_core::alarm::Lang;
use leadscrew_core::link::{ThreadCertificate, ThreadKind, ThreadRecord, ThreadState};

use crate::certified::{Judge, Verdict};
use crate::json::Json;
use crate::number;
use crate::place::SourceLine;
use crate::synchronism::Synchronism;
use crate::values::Tolerance;
use crate::words::{Both, both, pick};

/// The most lines that are named where more threads are out of tolerance.
const NAMED: usize = 8;

/// The threads of a run, each by its number on the board.
#[derive(Clone, Debug, Default)]
pub struct Threads {
    /// The last number before the run.
    before: u32,
    /// The newest number.
    newest: u32,
    records: BTreeMap<u32, ThreadRecord>,
}

impl Threads {
    /// The threads after those that the board reports before the run.
    pub fn behind(told: &[ThreadCertificate]) -> Self {
        let before = told.iter().map(|thread| thread.number).max().unwrap_or(0);
        Self {
            before,
            newest: before,
            records: BTreeMap::new(),
        }
    }

    /// Takes certificates from the board. A repeated certificate replaces the earlier one. Returns the number of new ones.
    pub fn take(&mut self, told: impl IntoIterator<Item = ThreadCertificate>) -> usize {
        let known = self.records.len();
        for thread in told {
            if thread.number > self.before {
                self.newest = self.newest.max(thread.number);
                self.records.insert(thread.number, thread.record);
            }
        }
        self.records.len() - known
    }

    /// Number of the newest certificate.
    pub const fn newest(&self) -> u32 {
        self.newest
    }

    /// True while the newest thread is being cut.
    pub fn is_under_way(&self) -> bool {
        let newest = self.records.get(&self.newest);
        newest.is_some_and(|record| record.state == ThreadState::UnderWay)
    }

    /// The program is given up and no more certificates come: a thread under way has been cut short.
    pub fn give_up(&mut self) {
        if let Some(record) = self.records.get_mut(&self.newest)
            && record.state == ThreadState::UnderWay
        {
            record.state = ThreadState::CutShort;
        }
    }

    /// Certificates up to this number do not change any more.
    pub fn whole(&self) -> u32 {
        self.newest - u32::from(self.is_under_way())
    }

    /// Number of certificates that the board overwrote before they were read.
    pub fn missing(&self) -> u64 {
        u64::from(self.newest - self.before) - self.records.len() as u64
    }

    /// All certificates, counted from 1 in the run.
    fn numbered(&self) -> impl Iterator<Item = (u32, &ThreadRecord)> {
        let before = self.before;
        self.records
            .iter()
            .map(move |(number, record)| (number - before, record))
    }

    /// The lines of threads whose largest error is above `tolerance`, each once, and the largest error: of the setpoint, or
    /// of the cut, where it is beyond it whatever its uncertainty.
    pub fn above(&self, tolerance: Tolerance, judge: &Judge) -> Option<Above> {
        let mut above: Option<Above> = None;
        for record in self.records.values() {
            let setpoint = record.tally.largest.nm();
            let set = tolerance.is_below(setpoint).then_some(setpoint);
            let is_beyond = judge.verdict(record) == Some(Verdict::Beyond);
            let cut = is_beyond.then(|| record.cut.worst().nm());
            if set.is_none() && cut.is_none() {
                continue;
            }
            let above = above.get_or_insert_default();
            above.worst_nm = above.worst_nm.max(set.unwrap_or(0));
            above.cut_nm = above.cut_nm.max(cut);
            if !above.lines.contains(&record.line) {
                above.lines.push(record.line);
            }
        }
        above
    }

    /// The lines of threads whose cut is not known well enough for the tolerance, each once.
    fn open(&self, judge: &Judge) -> Vec<u32> {
        let mut lines: Vec<u32> = self
            .records
            .values()
            .filter(|record| judge.verdict(record) == Some(Verdict::Open))
            .map(|record| record.line)
            .collect();
        lines.sort_unstable();
        lines.dedup();
        lines
    }

    /// Their errors as measured by the board, together.
    pub fn measured(&self) -> Synchronism {
        let mut all = Synchronism::default();
        for record in self.records.values() {
            all.add(&record.tally);
        }
        all
    }

    /// `threads`, `threads_missing` and `cut_apart_um` of a result.
    pub fn fields(&self, judge: &Judge, json: &mut Json) {
        json.array_at("threads", |json| {
            for (number, record) in self.numbered() {
                json.object(|json| {
                    fields(json, number, record);
                    judge.field(record, json);
                });
            }
        });
        json.number("threads_missing", self.missing());
        match judge.shift(self.records.values()) {
            Some(shift) => shift.fields("cut_apart_um", json),
            None => json.null("cut_apart_um"),
        }
    }

    /// A line for each thread and one for its cut, a line for the shift between threads, one where a tolerance cannot be
    /// judged, and one where certificates are missing.
    pub fn text(&self, judge: &Judge, lang: Lang) -> String {
        let mut text = String::new();
        for (number, record) in self.numbered() {
            text.push_str(line(number, record).get(lang));
            text.push('\n');
            if let Some(cut) = judge.words(record) {
                let told = both!(
                    "   cut: {en}\n",
                    "   切削：{zh}\n",
                    en = cut.en,
                    zh = cut.zh
                );
                text.push_str(told.get(lang));
            }
        }
        if let Some(shift) = judge.shift(self.records.values()) {
            text.push_str(&judge.shift_words(shift, lang));
        }
        let open = self.open(judge);
        if !open.is_empty() {
            let lines = named(&open);
            let told = both!(
                "tolerance: not judged by the cut, which is not known well enough{en}\n",
                "公差：切削结果的不确定度过大，未据此判断{zh}\n",
                en = lines.en,
                zh = lines.zh
            );
            text.push_str(told.get(lang));
        }
        if self.missing() > 0 {
            let missing = both!(
                "threads: {n} more were cut before their certificates could be read\n",
                "螺纹：另有 {n} 个，其精度证书未能及时读取\n",
                n = self.missing()
            );
            text.push_str(missing.get(lang));
        }
        text
    }
}

/// The threads out of tolerance.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Above {
    /// The largest error of a setpoint in nanometres; 0 where all are within.
    pub worst_nm: i64,
    /// The largest error of a cut.
    pub cut_nm: Option<i64>,
    /// Source lines of the threads and holes; empty where they are unknown.
    pub lines: Vec<u32>,
}

impl Above {
    /// Adds the findings of another judgement.
    pub fn join(&mut self, other: &Self) {
        self.worst_nm = self.worst_nm.max(other.worst_nm);
        self.cut_nm = self.cut_nm.max(other.cut_nm);
        self.lines.extend(&other.lines);
        self.lines.sort_unstable();
        self.lines.dedup();
    }

    /// Text: why a tolerance is not met.
    pub fn words(&self, tolerance: Tolerance) -> Both {
        let place = named(&self.lines);
        let most = number::text::<6>(tolerance.pm);
        if let Some(cut) = self.cut_nm
            && self.worst_nm == 0
        {
            return both!(
                "the worst error of the cut {error} µm is above the tolerance of {most} µm{en}",
                "切削的最大误差 {error} µm，超过允许值 {most} µm{zh}",
                error = number::rounded::<3>(cut, 1),
                en = place.en,
                zh = place.zh
            );
        }
        let cut = self.cut_nm.map_or_else(Both::default, |cut| {
            both!(
                " and that of the cut {error} µm",
                "、切削的最大误差 {error} µm",
                error = number::rounded::<3>(cut, 1)
            )
        });
        both!(
            "the worst synchronism error {error} µm{cut_en} is above the tolerance of {most} µm{en}",
            "最大同步误差 {error} µm{cut_zh}，超过允许值 {most} µm{zh}",
            error = number::text::<3>(self.worst_nm),
            cut_en = cut.en,
            cut_zh = cut.zh,
            en = place.en,
            zh = place.zh
        )
    }
}

/// `: line 4, 7 and 3 more`; nothing for no lines.
fn named(lines: &[u32]) -> Both {
    let named: Vec<String> = lines
        .iter()
        .take(NAMED)
        .map(|line| SourceLine(*line).to_string())
        .collect();
    let further = match lines.len().saturating_sub(NAMED) {
        0 => both!("", ""),
        more => both!(" and {more} more", "，另有 {more} 行"),
    };
    match &named[..] {
        [] => Both::default(),
        named => both!(
            ": line {lines}{en}",
            "：第 {lines} 行{zh}",
            lines = named.join(", "),
            en = further.en,
            zh = further.zh
        ),
    }
}

fn fields(json: &mut Json, number: u32, record: &ThreadRecord) {
    let tally = &record.tally;
    json.number("n", number);
    SourceLine(record.line).fields(json);
    json.text("kind", record.kind.name());
    json.text("state", record.state.name());
    json.number("passes", tally.passes);
    json.number("measured", tally.measured);
    Synchronism::from(tally).field("sync_error_um", json);
    json.number("late", tally.late);
}

/// Text for a person.
fn line(number: u32, record: &ThreadRecord) -> Both {
    let tally = &record.tally;
    let what = match record.kind {
        ThreadKind::Thread if tally.passes == 1 => both!("thread, 1 pass", "螺纹，走刀 1 次"),
        ThreadKind::Thread => both!(
            "thread, {passes} passes",
            "螺纹，走刀 {passes} 次",
            passes = tally.passes
        ),
        ThreadKind::RigidTap => both!("rigid tap", "刚性攻丝"),
        ThreadKind::FloatingTap => both!("ordinary tap", "普通攻丝"),
    };
    let state = |en, zh| Both {
        en: pick(Lang::En, en, zh).to_owned(),
        zh: pick(Lang::Zh, en, zh).to_owned(),
    };
    let state = match record.state {
        // At the end of a run whose last certificate of this thread is missing.
        ThreadState::UnderWay => state(", not known how it ended", "，如何结束不得而知"),
        ThreadState::Finished => Both::default(),
        ThreadState::CutShort => state(", cut short", "，中途停止"),
    };
    let errors = Synchronism::from(tally);
    let worst = errors.worst();
    let late = match tally.late {
        0 => Both::default(),
        late => both!(", {late} setpoints late", "，迟到设定值 {late} 个"),
    };
    both!(
        "{number}: line {line}: {en}{state_en}: worst {worst_en} µm, {rms} µm RMS over {ticks} ticks{late_en}",
        "{number}：第 {line} 行：{zh}{state_zh}：最大 {worst_zh} µm，均方根 {rms} µm，{ticks} 个周期{late_zh}",
        number = number,
        line = SourceLine(record.line),
        en = what.en,
        zh = what.zh,
        state_en = state.en,
        state_zh = state.zh,
        worst_en = worst.en,
        worst_zh = worst.zh,
        rms = errors.rms(),
        ticks = tally.measured,
        late_en = late.en,
        late_zh = late.zh
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use leadscrew_core::link::{CutTally, Tally};
    use leadscrew_core::params::Params;
    use leadscrew_core::units::Length;

    fn thread(number: u32, line: u32, state: ThreadState, nm: i64) -> ThreadCertificate {
        ThreadCertificate {
            number,
            record: ThreadRecord {
                line,
                kind: ThreadKind::Thread,
                state,
                tally: Tally {
                    passes: 6,
                    late: 0,
                    measured: 4,
                    largest: Length::from_nm(nm),
                    squares: 16,
                },
                cut: CutTally::NONE,
            },
        }
    }

    fn judge() -> Judge {
        Judge::new(&Params::slant_bed(), None)
    }

    const UNKNOWN: &str = "   cut: not known: no position of the drive came that could be judged (9021; a lead that \
                           changes is not judged)\n";

    use ThreadState::{CutShort, Finished, UnderWay};

    #[test]
    fn what_is_told_twice_counts_once_and_what_is_overtaken_is_missing() {
        let mut threads = Threads::behind(&[thread(7, 1, Finished, 9), thread(6, 1, Finished, 9)]);
        assert_eq!(threads.take([thread(7, 1, Finished, 9)]), 0);
        assert_eq!(threads.take([thread(8, 5, UnderWay, 3)]), 1);
        assert!(threads.is_under_way());
        assert_eq!(threads.whole(), 7);
        assert_eq!(
            threads.text(&judge(), Lang::En),
            format!(
                "1: line 5: thread, 6 passes, not known how it ended: worst 0.003 µm, 0.002 µm RMS over 4 ticks\n{UNKNOWN}"
            )
        );
        assert!(
            threads
                .text(&judge(), Lang::Zh)
                .contains("，如何结束不得而知：")
        );
        let mut given_up = threads.clone();
        given_up.give_up();
        assert!(given_up.text(&judge(), Lang::En).contains("cut short"));
        assert_eq!(given_up.whole(), 8);
        assert_eq!(
            threads.take([thread(9, 6, CutShort, 5), thread(8, 5, Finished, 4)]),
            1
        );
        assert_eq!((threads.newest(), threads.missing()), (9, 0));
        assert!(!threads.is_under_way());
        assert_eq!(threads.whole(), 9);
        assert_eq!(
            threads.text(&judge(), Lang::En),
            format!(
                "1: line 5: thread, 6 passes: worst 0.004 µm, 0.002 µm RMS over 4 ticks\n{UNKNOWN}\
                 2: line 6: thread, 6 passes, cut short: worst 0.005 µm, 0.002 µm RMS over 4 ticks\n{UNKNOWN}"
            )
        );
        threads.take([thread(12, 7, Finished, 1)]);
        assert_eq!(threads.missing(), 2);
        assert!(
            threads
                .text(&judge(), Lang::En)
                .ends_with("\nthreads: 2 more were cut before their certificates could be read\n")
        );
        assert!(threads.text(&judge(), Lang::Zh).starts_with(
            "1：第 5 行：螺纹，走刀 6 次：最大 0.004 µm，均方根 0.002 µm，4 个周期\n"
        ));
        let mut json = Json::new();
        json.object(|json| threads.fields(&judge(), json));
        let value: serde_json::Value = serde_json::from_slice(&json.into_bytes()).unwrap();
        assert_eq!(value["threads_missing"], 2);
        assert_eq!(
            value["threads"][1],
            serde_json::json!({
                "n": 2, "line": 6, "kind": "thread", "state": "cut_short", "passes": 6, "measured": 4,
                "sync_error_um": {"max": 0.005, "rms": 0.002}, "late": 0, "cut": null
            })
        );
    }

    #[test]
    fn each_is_judged_and_named_by_its_line() {
        let mut threads = Threads::default();
        threads.take([
            thread(1, 5, Finished, 3000),
            thread(2, 6, Finished, 1300),
            thread(3, 6, Finished, 1301),
        ]);
        let tolerance = |nm: i64| Tolerance { pm: nm * 1000 };
        assert_eq!(threads.above(tolerance(3000), &judge()), None);
        let above = threads.above(tolerance(1300), &judge()).unwrap();
        assert_eq!((above.worst_nm, &above.lines[..]), (3000, &[5, 6][..]));
        assert_eq!(
            above.words(tolerance(1300)).en,
            "the worst synchronism error 3 µm is above the tolerance of 1.3 µm: line 5, 6"
        );
        let many = Above {
            worst_nm: 1,
            cut_nm: None,
            lines: (1..=10).collect(),
        };
        assert!(
            many.words(tolerance(0))
                .en
                .ends_with("line 1, 2, 3, 4, 5, 6, 7, 8 and 2 more")
        );
    }

    /// Two lines that a loop cuts in turn are named once each.
    #[test]
    fn a_line_whose_cut_is_not_known_is_named_once() {
        let mut threads = Threads::default();
        threads.take(
            (1..=4)
                .rev()
                .map(|number| thread(number, 5 + number % 2, Finished, 1)),
        );
        let judge = Judge::new(&Params::slant_bed(), Some(Tolerance { pm: 1_000_000 }));
        assert_eq!(threads.open(&judge), [5, 6]);
    }
}
