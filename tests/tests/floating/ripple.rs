//! A spindle that does nothing wrong: whatever its ripple, at any phase of it and at any tick, the hole is tapped
//! without an alarm and to its bottom. Also where S is more than the spindle can be stopped from in the hole, so that
//! it comes down to the speed of the hole while the tap waits.

use core::f64::consts::TAU;

use leadscrew_board_sim::plant::{DriveOptions, PlantOptions, Ripple};
use leadscrew_core::call::CallKind;
use leadscrew_core::cycle;
use leadscrew_core::params::Params;
use leadscrew_core::signals::Signals;
use leadscrew_core::units::{Axis, Lead};
use leadscrew_tests::machine::{calls, run};
use leadscrew_tests::params::with;
use leadscrew_tests::random::Random;

use super::hole::Hole;
use super::watch::{depth, judge_uneven};

fn holes() -> u32 {
    leadscrew_seed::amount(100, 600)
}

/// What reading counts without their edges' times is worth as acceleration of the axis, in m/s²: the bound that
/// `check` goes by.
fn noise(hole: &Hole, params: &Params) -> f64 {
    let lead = Lead::new(hole.lead * 1_000, 1).expect("a lead");
    let noise = params.count_noise(lead, Axis::Z);
    noise.map_or(0.0, |noise| noise.nm_per_s2() as f64 * 1e-9)
}

pub fn is_feasible(text: &str, params: &Params) -> bool {
    calls(text, params).iter().all(|call| match &call.kind {
        CallKind::Tap(tap) => cycle::tap_report(tap, Signals::default(), call.span, params).is_ok(),
        _ => true,
    })
}

#[test]
fn a_rippling_spindle_is_no_alarm() {
    leadscrew_seed::volume(0x0051_BB1E, |seed| {
        let mut random = Random(seed);
        let mut tapped = 0;
        while tapped < holes() {
            let r = &mut random;
            let tick = r.of(&[500, 1000, 2000]);
            let latency = r.of(&[0, 1000, 3000]);
            let edges = r.within(0, 1);
            let params = with(&[
                ("9000", tick),
                ("9003.X", latency),
                ("9003.Z", latency),
                ("9004", r.of(&[200, 500, 500, 1500])),
                ("9006.0", edges),
                ("1620.Z", r.within(1_500, 4_000) * 1_000_000),
                ("1622.Z", r.within(30, 120) * 1_000_000_000),
                ("1828.Z", 6_000_000),
            ]);
            let rpm = r.within(200, 2_500);
            let hole = Hole {
                rpm: (rpm * r.sign()) as i32,
                lead: r.within(400, (3_500_000 / rpm).min(2_500)),
                depth: r.within(2_000, 15_000),
                approach: r.within(1_000, 5_000),
                peck: (0, 0),
                dwell: 0,
            };
            // The phase of the ripple when the hole begins, and perhaps more than the speed of the hole before it.
            let wait = r.within(1, 400);
            let before = (rpm + r.of(&[0, 0, 1]) * r.within(0, 1_000)).min(3_000);
            let turn = if hole.rpm < 0 { "M4" } else { "M3" };
            let block = hole.block(0);
            let text = format!("G18 {turn} S{before}\nG4 P{wait}\nS{rpm}\n{block}\nG80\nM30\n");
            if !is_feasible(&text, &params) {
                continue;
            }
            tapped += 1;
            let (percent, hertz) = (r.within(0, 5_000), r.within(500, 15_000));
            let plant = PlantOptions {
                ripple: Ripple::new(percent as u32, hertz as u32),
                drives: DriveOptions {
                    transmission: params.drive_status_syncs() as u8,
                    settling: r.within(0, 20) as u16,
                    lag: r.of(&[0, 0, 3]),
                    ..DriveOptions::default()
                },
                ..PlantOptions::default()
            };
            let ran = run(&text, &params, &plant, |_, _| {});
            assert_eq!(ran.alarm, None, "{hole:?} {params:?} {plant:?}");
            let deepest = ran.rows.iter().map(|row| depth(row, &hole)).max();
            let short = hole.total() - deepest.expect("rows");
            assert!((0..=2).contains(&short), "{short} nm short: {hole:?}");
            let feed = rpm as f64 / 60.0 * hole.lead as f64 * 1e-6;
            let ripple = percent as f64 * 1e-5 * hertz as f64 * 1e-3 * TAU * feed;
            judge_uneven(&ran, &hole, &params, ripple + noise(&hole, &params));
        }
    });
}

/// The machine and the program of a soak in which the tap stopped 0.03 mm before its bottom: the spindle comes down from
/// 1492 rpm to 994 rpm, from which it can just be stopped in the hole, and ripples at the wrong moment.
#[test]
fn a_tap_waits_until_the_spindle_has_come_down() {
    let params = with(&[
        ("9000", 2000),
        ("9003.X", 3000),
        ("9003.Z", 3000),
        ("9004", 500),
        ("1620.X", 2_392_000_000),
        ("1620.Z", 3_083_000_000),
        ("1622.X", 78_000_000_000),
        ("1622.Z", 64_000_000_000),
        ("1828.X", 6_000_000),
        ("1828.Z", 6_000_000),
    ]);
    let plant = PlantOptions {
        ripple: Ripple::new(2_728, 3_354),
        drives: DriveOptions {
            settling: 19,
            lag: 3,
            ..DriveOptions::default()
        },
        ..PlantOptions::default()
    };
    // Ticks apart, so that the ripple is at any phase when the hole begins.
    for wait in (2..300).step_by(7) {
        let text = format!(
            "G18\nG0 X97.478 Z16.159\nM3 S1227\nG4 P{wait}\nG0 X22.170 Z6.786\nM3 S1492\n\
             G99 G84 Z-3.969 R-2.538 F2.071\nG80\nM30\n"
        );
        let ran = run(&text, &params, &plant, |_, _| {});
        assert_eq!(ran.alarm, None, "{wait}");
        let deepest = ran.rows.iter().map(|row| row.position.z.nm()).min();
        assert_eq!(deepest, Some(-3_969_000), "{wait}");
    }
}
