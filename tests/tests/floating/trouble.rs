//! A spindle that does not do as it is told, an encoder that loses counts, drives that fail: an alarm with the right
//! number, and the axis at rest within its limits and never beyond the bottom.

use leadscrew_board_sim::Sim;
use leadscrew_board_sim::plant::{PlantOptions, Trouble};
use leadscrew_core::units::Axis;
use leadscrew_tests::machine::{Ran, run};
use leadscrew_tests::params::with;

use super::hole::{Hole, plain};
use super::stops::{rests, ticks_of};
use super::watch::{depth, judge, locked};

fn number(ran: &Ran) -> Option<u16> {
    ran.alarm.map(|alarm| alarm.number())
}

/// The commanded speed of the spindle, in turns a second.
fn told(sim: &Sim) -> Option<f64> {
    let rate = sim.board().ticker().executor().spindle_speed()?;
    Some(rate.raw() as f64 / 2f64.powi(32))
}

/// It turns on at S, whatever it is told: the axis comes to rest before the bottom, and the holder gives way.
#[test]
fn a_spindle_that_does_not_stop_for_the_bottom() {
    for rpm in [200, 500, -500, 1500] {
        let params = with(&[]);
        let hole = Hole {
            rpm,
            depth: 20_000,
            ..plain()
        };
        let s = f64::from(rpm.abs()) / 60.0;
        let mut began = false;
        let ran = run(
            &hole.program(),
            &params,
            &PlantOptions::default(),
            |sim, _| {
                if let Some(speed) = told(sim) {
                    let floating = sim.board().float_line().is_some();
                    began |= floating;
                    if floating && speed.abs() > s * 0.01 {
                        let percent = (100.0 * s / speed.abs()).min(30_000.0);
                        sim.plant().spindle().disturb(percent as i16);
                    }
                } else if began {
                    sim.plant().spindle().disturb(100);
                }
            },
        );
        assert_eq!(number(&ran), Some(4270), "{rpm}");
        judge(&ran, &hole, &params);
        let last = ran.rows.last().expect("rows");
        let short = hole.total() - depth(last, &hole);
        assert!(
            (0..400_000).contains(&short),
            "{rpm}: {short} nm before the bottom"
        );
    }
}

#[test]
fn a_spindle_that_stalls_is_dragged_or_races() {
    let params = with(&[]);
    let hole = plain();
    let ticks = ticks_of(&hole, &params);
    let middle = ticks.start + 700;
    for (percent, expected) in [(0, 4250), (-60, 4250), (140, 4257)] {
        let ran = run(
            &hole.program(),
            &params,
            &PlantOptions::default(),
            |sim, ticks| {
                if ticks == middle {
                    sim.plant().spindle().disturb(percent);
                }
                if sim.board().ticker().executor().is_aborting() {
                    sim.plant().spindle().disturb(100);
                }
            },
        );
        assert_eq!(number(&ran), Some(expected), "{percent}");
        rests(&ran, &hole, &params, middle);
    }
}

#[test]
fn a_spindle_that_does_not_come_to_speed_or_has_no_index() {
    let params = with(&[]);
    let hole = plain();
    let ran = run(
        &hole.program(),
        &params,
        &PlantOptions::default(),
        |sim, _| {
            sim.plant().spindle().disturb(70);
        },
    );
    assert_eq!(number(&ran), Some(4303));
    assert_eq!(locked(&ran).count(), 0);
    let ran = run(
        &hole.program(),
        &params,
        &PlantOptions::default(),
        |sim, ticks| {
            if ticks == 0 {
                sim.plant().encoder().break_index(true);
            }
        },
    );
    assert_eq!(number(&ran), Some(4260));
    let last = ran.rows.last().expect("rows");
    assert_eq!(depth(last, &hole), 0);
}

/// The counts are wrong, the thread is in the hole: it goes on by them, without a jump, until the spindle stands.
#[test]
fn lost_counts_in_the_hole() {
    let params = with(&[]);
    let hole = plain();
    for tick in ticks_of(&hole, &params).step_by(61) {
        let ran = run(
            &hole.program(),
            &params,
            &PlantOptions::default(),
            |sim, ticks| {
                if ticks == tick {
                    sim.plant().encoder().slip(4);
                }
            },
        );
        judge(&ran, &hole, &params);
        let floating = number(&ran);
        assert!(matches!(floating, None | Some(4261)), "{floating:?}");
    }
}

#[test]
fn a_drive_that_fails_in_the_hole() {
    let params = with(&[]);
    let hole = Hole {
        depth: 6_000,
        ..plain()
    };
    for tick in ticks_of(&hole, &params).step_by(61) {
        let fails = |drive: Option<Axis>, trouble: Trouble| {
            run(
                &hole.program(),
                &params,
                &PlantOptions::default(),
                |sim, ticks| {
                    if ticks == tick {
                        match drive {
                            Some(axis) => sim.plant().drive(axis).trouble(trouble),
                            None => sim.plant().spindle_drive().trouble(trouble),
                        }
                    }
                },
            )
        };
        let ran = fails(Some(Axis::X), Trouble::Fault(0x3210));
        assert_eq!(number(&ran), Some(4357));
        rests(&ran, &hole, &params, tick);
        // The spindle's own drive lets go: the axis goes with the spindle until it stands.
        let ran = fails(None, Trouble::TorqueOff);
        assert!(ran.alarm.is_some(), "{tick}");
        rests(&ran, &hole, &params, tick);
        let ran = fails(None, Trouble::Silent);
        assert!(ran.alarm.is_some(), "{tick}");
        judge(&ran, &hole, &params);
    }
}
