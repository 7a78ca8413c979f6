//! Ramps of axis and spindle: 5261, 5271, the axis' own, and holes too shallow for S.

use leadscrew_core::alarm::{Arg, At, Code, Span};
use leadscrew_core::call::{SpindleChoice, TapCall, TapSpindle};
use leadscrew_core::cycle;
use leadscrew_core::signals::Signals;
use leadscrew_core::units::{CentiRpm, Lead, Rpm};
use leadscrew_tests::machine::Ran;
use leadscrew_tests::params::with;

use super::hole::{bottom, deep, high_speed, program, sheet};
use super::watch::{locked, run, set, tap};

fn peak_rpm(ran: &Ran) -> f64 {
    let rows: Vec<_> = locked(ran).collect();
    rows.windows(2)
        .map(|rows| ((set(rows[1]) - set(rows[0])).raw() as f64 / 2f64.powi(32)).abs() * 60_000.0)
        .fold(0.0, f64::max)
}

#[test]
fn every_ramp_keeps_axis_and_spindle_within_their_limits() {
    for ramp in [0, 1, 30, 500, 1500, 4000] {
        for retract in [0, 10, 2500] {
            let params = with(&[("5261", ramp), ("5271", retract), ("5201.2", 1)]);
            let hole = bottom(sheet(), -30_000);
            tap(&hole, &params);
            tap(&high_speed(hole, 7_000, 900), &params);
            tap(&deep(hole, 7_000, 900), &params);
        }
    }
}

#[test]
fn the_retract_has_a_ramp_of_its_own() {
    let ticks = |settings: &[(&str, i64)]| {
        let ran = tap(&sheet(), &with(settings));
        let deepest = locked(&ran)
            .min_by_key(|row| row.position.z)
            .map(|row| row.tick)
            .expect("rows");
        let (first, last) = (
            locked(&ran).next().map(|row| row.tick).expect("rows"),
            locked(&ran).last().map(|row| row.tick).expect("rows"),
        );
        (deepest - first, last - deepest)
    };
    let (in_same, out_same) = ticks(&[("5271", 100)]);
    let (in_own, out_own) = ticks(&[("5271", 100), ("5201.2", 1)]);
    assert_eq!(in_own, in_same);
    assert!(out_own + 350 < out_same, "{out_own} {out_same}");
}

#[test]
fn s_is_reached_where_the_depth_allows_and_never_exceeded() {
    let params = with(&[]);
    let report =
        cycle::tap_report(&sheet(), Signals::default(), Span::default(), &params).expect("a hole");
    assert_eq!((report.infeeds, report.warning), (1, None));
    let ran = tap(&sheet(), &params);
    assert!(
        (999.0..=1000.1).contains(&peak_rpm(&ran)),
        "{}",
        peak_rpm(&ran)
    );
}

#[test]
fn a_shallow_hole_is_triangular_and_says_so() {
    let params = with(&[]);
    let hole = bottom(sheet(), -8_000);
    let report =
        cycle::tap_report(&hole, Signals::default(), Span::default(), &params).expect("a hole");
    let warning = report.warning.expect("a warning");
    assert_eq!(warning.code, Code::TapSpeedNotReached);
    let ran = tap(&hole, &params);
    let reported = f64::from(report.fastest.get()) / 100.0;
    assert!(
        (peak_rpm(&ran) - reported).abs() < 1.0,
        "{} {reported}",
        peak_rpm(&ran)
    );
    // 4 mm to speed up at 1000 rpm in 500 ms times 2 mm: √(2 · 66.7 mm/s² · 4 mm) = 23.1 mm/s = 693 rpm.
    assert!((680.0..693.0).contains(&reported), "{reported}");
    // The board says it too.
    let said = ran.events.iter().any(|event| {
        matches!(event, leadscrew_core::board::Event::Warning(alarm) if alarm.code == Code::TapSpeedNotReached)
    });
    assert!(said);
}

/// A ramp longer than the profile remembers: slower, in phase, reported.
#[test]
fn a_ramp_too_long_for_the_profile_makes_the_tap_slower() {
    let params = with(&[("5261", 4000)]);
    let hole = TapCall {
        speed: CentiRpm::of_rpm(Rpm::new(2000)),
        ..bottom(sheet(), -200_000)
    };
    let report =
        cycle::tap_report(&hole, Signals::default(), Span::default(), &params).expect("a hole");
    assert_eq!(
        report.warning.map(|w| w.code),
        Some(Code::TapSpeedNotReached)
    );
    let ran = tap(&hole, &params);
    assert!(
        (400.0..520.0).contains(&peak_rpm(&ran)),
        "{}",
        peak_rpm(&ran)
    );
}

#[test]
fn too_fast_for_the_axis_is_an_alarm_before_anything_moves() {
    // 1000 rpm times 9 mm is above the 8 m/min of Z.
    let hole = TapCall {
        lead: At::new(Lead::new(9_000_000, 1).expect("a lead"), Span::default()),
        ..sheet()
    };
    let ran = run(program(&[hole]), &with(&[]));
    assert_eq!(ran.alarm.map(|alarm| alarm.code), Some(Code::LeadTooFast));
    let first = ran.rows[0].position;
    assert!(ran.rows.iter().all(|row| row.position == first));
    // The retract counts too.
    let hole = TapCall {
        extract: CentiRpm::of_rpm(Rpm::new(4001)),
        ..sheet()
    };
    let ran = run(program(&[hole]), &with(&[]));
    assert_eq!(ran.alarm.map(|alarm| alarm.code), Some(Code::LeadTooFast));
}

#[test]
fn a_spindle_without_a_drive_is_an_alarm() {
    let hole = TapCall {
        spindle: SpindleChoice::Written(TapSpindle::Third),
        ..sheet()
    };
    let ran = run(program(&[hole]), &with(&[("9014", 2)]));
    let alarm = ran.alarm.expect("there is no spindle 3");
    assert_eq!(alarm.code, Code::TapSpindleNotAvailable);
    assert_eq!(alarm.args[..2], [Arg::Int(3), Arg::Int(2)]);
    let first = ran.rows[0].position;
    assert!(ran.rows.iter().all(|row| row.position == first));
}

#[test]
fn a_faster_extraction_is_as_fast_as_asked() {
    let hole = TapCall {
        extract: CentiRpm::of_rpm(Rpm::new(2000)),
        ..bottom(sheet(), -100_000)
    };
    let ran = tap(&hole, &with(&[]));
    assert!(
        (1999.0..=2000.1).contains(&peak_rpm(&ran)),
        "{}",
        peak_rpm(&ran)
    );
}
