use leadscrew_core::link::{PassCut, Tally};
use leadscrew_core::params::Params;
use leadscrew_core::units::Length;
use serde_json::Value;

use super::*;

/// A thread whose passes have these grooves, of so many strokes begun.
fn told(number: u32, state: ThreadState, strokes: u16, grooves: &[i64]) -> ThreadCertificate {
    let nm = Length::from_nm;
    let mut cut = CutTally::NONE;
    cut.take(nm(-2_500), nm(10), nm(1_500_000), nm(10_000_000));
    for groove in grooves {
        cut.close(&PassCut {
            groove: nm(*groove),
            slope: nm(0),
            scatter: nm(64),
        });
    }
    ThreadCertificate {
        number,
        record: ThreadRecord {
            line: 3,
            kind: ThreadKind::Thread,
            state,
            tally: Tally {
                passes: strokes,
                ..Tally::NONE
            },
            cut,
        },
    }
}

fn judge() -> Judge {
    Judge::new(&Params::slant_bed(), None)
}

fn take(cuts: &mut Cuts, told: &[ThreadCertificate]) -> bool {
    cuts.take(told, &judge(), 0, Instant::now())
}

/// Of each pass of each thread: lowest and highest in µm.
fn passes(cuts: &Cuts) -> Vec<Vec<Option<[f64; 2]>>> {
    let value: Value = serde_json::from_str(&cuts.json(&judge())).unwrap();
    let of = |pass: &Value| Some([pass["least"].as_f64()?, pass["most"].as_f64()?]);
    let of_thread = |thread: &Value| {
        thread["passes"]
            .as_array()
            .unwrap()
            .iter()
            .map(of)
            .collect()
    };
    let list = value["threads"].as_array().unwrap();
    list.iter().map(of_thread).collect()
}

use ThreadState::{CutShort, Finished, UnderWay};

#[test]
fn a_pass_is_known_where_it_widens_the_range_and_else_lies_within_it() {
    let mut cuts = Cuts::default();
    assert!(take(&mut cuts, &[told(1, UnderWay, 1, &[])]));
    assert_eq!(passes(&cuts), [vec![]]);
    take(&mut cuts, &[told(1, UnderWay, 1, &[500])]);
    // The next one has begun: nothing new is known.
    take(&mut cuts, &[told(1, UnderWay, 2, &[500])]);
    let known = |nm: f64| Some([nm, nm]);
    assert_eq!(passes(&cuts), [[known(0.5)]]);
    take(&mut cuts, &[told(1, UnderWay, 2, &[500, -700])]);
    take(&mut cuts, &[told(1, UnderWay, 3, &[500, -700, 100])]);
    take(&mut cuts, &[told(1, UnderWay, 4, &[500, -700, 100, 600])]);
    // Two between readings: the one that widens the range may be either.
    let end = [told(1, Finished, 6, &[500, -700, 100, 600, 900, 0])];
    take(&mut cuts, &end);
    let wide = Some([-0.7, 0.9]);
    let all = vec![
        known(0.5),
        known(-0.7),
        Some([-0.7, 0.5]),
        known(0.6),
        wide,
        wide,
    ];
    assert_eq!(passes(&cuts), [all]);
    assert!(!take(&mut cuts, &end));
}

#[test]
fn a_pass_without_a_groove_is_unknown_once_it_is_over() {
    let mut cuts = Cuts::default();
    take(&mut cuts, &[told(1, UnderWay, 1, &[])]);
    take(&mut cuts, &[told(1, UnderWay, 2, &[])]);
    assert_eq!(passes(&cuts), [[None]]);
    // Of two one is known, and not which.
    take(&mut cuts, &[told(1, UnderWay, 4, &[200])]);
    assert_eq!(passes(&cuts), [[None, None, None]]);
    take(&mut cuts, &[told(1, CutShort, 4, &[200])]);
    assert_eq!(passes(&cuts), [[None; 4]]);
    // A hole has none, and neither has a board that has started again.
    let mut hole = told(2, Finished, 1, &[]);
    hole.record.kind = ThreadKind::RigidTap;
    take(&mut cuts, &[hole, told(1, CutShort, 4, &[200])]);
    assert_eq!(passes(&cuts), [vec![None; 4], vec![]]);
    assert!(cuts.take(&[], &judge(), 1, Instant::now()));
    assert!(passes(&cuts).is_empty());
}

#[test]
fn what_is_kept_has_an_end() {
    let mut cuts = Cuts::default();
    for number in 1..=40 {
        take(&mut cuts, &[told(number, Finished, 200, &[0; 200])]);
    }
    let kept = passes(&cuts);
    assert_eq!((kept.len(), kept[0].len()), (KEPT, PASSES));
    let value: Value = serde_json::from_str(&cuts.json(&judge())).unwrap();
    let newest = &value["threads"][KEPT - 1];
    assert_eq!((&newest["n"], &newest["before"]), (&40.into(), &136.into()));
    let words = newest["en"].as_str().unwrap();
    assert!(
        words.contains("the age of 6064h is not known") != newest["age_known"].as_bool().unwrap()
    );
}

#[test]
fn nothing_is_read_while_nothing_is_cut() {
    let mut cuts = Cuts::default();
    let begin = Instant::now();
    let at = |ms: u64| begin + Duration::from_millis(ms);
    assert!(cuts.is_due(false, begin));
    cuts.take(&[], &judge(), 0, begin);
    assert!(!cuts.is_due(false, at(60_000)));
    // A pass under way is looked at now and then, and soon when it is over.
    assert!(cuts.is_due(true, at(60_100)));
    cuts.take(&[told(1, UnderWay, 1, &[])], &judge(), 0, at(60_100));
    assert!(!cuts.is_due(true, at(60_600)));
    assert!(cuts.is_due(false, at(60_610)));
    cuts.take(&[told(1, UnderWay, 1, &[1])], &judge(), 0, at(60_610));
    assert!(!cuts.is_due(false, at(61_100)));
    // The thread has not ended yet.
    assert!(cuts.is_due(false, at(62_200)));
    cuts.take(&[told(1, Finished, 1, &[1])], &judge(), 0, at(62_200));
    assert!(!cuts.is_due(false, at(90_000)));
    // One that is over between two looks has been told by its flag.
    assert!(!cuts.is_due(true, at(62_300)));
    assert!(cuts.is_due(false, at(62_700)));
}
