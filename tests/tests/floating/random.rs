//! Random holes: any speed, lead, depth and form, any ripple and encoder.

use leadscrew_board_sim::plant::{PlantOptions, Ripple};
use leadscrew_core::call::CallKind;
use leadscrew_core::cycle;
use leadscrew_core::signals::Signals;
use leadscrew_core::units::Turns;
use leadscrew_tests::machine::{calls, run};
use leadscrew_tests::params::with;
use leadscrew_tests::random::Random;

use super::hole::Hole;
use super::watch::{depth, judge, locked};

fn holes() -> usize {
    leadscrew_seed::amount(150, 300)
}

#[test]
fn random_holes() {
    leadscrew_seed::volume(0xF10A7, |seed| {
        let mut random = Random(seed);
        let mut tapped = 0;
        while tapped < holes() {
            let r = &mut random;
            let deep = i64::from(r.chance(50));
            let edge = i64::from(r.chance(50));
            let params = with(&[
                ("5200.5", deep),
                ("9006.0", edge),
                ("9004", r.of(&[50, 200, 500, 1500])),
                ("9000", r.of(&[500, 1000, 2000])),
            ]);
            let depth_um = r.within(800, 30_000);
            let infeed = if r.chance(40) {
                0
            } else {
                r.within(300, depth_um)
            };
            let hole = Hole {
                rpm: (r.within(30, 2_500) * r.sign()) as i32,
                lead: r.within(200, 4_000),
                depth: depth_um,
                approach: r.within(0, 5_000),
                peck: (infeed, r.within(0, infeed.max(1))),
                dwell: if r.chance(50) {
                    0
                } else {
                    r.within(1, 100) as u32
                },
            };
            // Minutes of the machine's time, not hours: a deep peck goes the whole way back each time.
            let pecks = if infeed == 0 {
                1
            } else {
                depth_um / infeed + 1
            };
            let ways = if deep == 1 { 2 * pecks } else { 6 };
            let turns = ways * (depth_um + hole.approach) / hole.lead;
            if turns > 10 * i64::from(hole.rpm.abs()) {
                continue;
            }
            let feasible = calls(&hole.program(), &params)
                .iter()
                .all(|call| match &call.kind {
                    CallKind::Tap(tap) => {
                        cycle::tap_report(tap, Signals::default(), call.span, &params).is_ok()
                    }
                    _ => true,
                });
            if !feasible {
                continue;
            }
            tapped += 1;
            let plant = PlantOptions {
                ripple: Ripple::new(r.within(0, 8) as u32 * 1000, r.within(2, 15) as u32 * 1000),
                // The board counts whole turns from where the spindle was at power-up.
                angle: Turns::from_raw(r.within(-(1 << 30), 1 << 30)),
                ..PlantOptions::default()
            };
            let ran = run(&hole.program(), &params, &plant, |_, _| {});
            assert_eq!(ran.alarm, None, "{hole:?} {plant:?}");
            judge(&ran, &hole, &params);
            let deepest = ran.rows.iter().map(|row| depth(row, &hole)).max();
            let short = hole.total() - deepest.expect("rows");
            assert!((0..=2).contains(&short), "{short} nm short: {hole:?}");
            assert_eq!(ran.rows.last().expect("rows").position.z.nm(), 0);
            for row in locked(&ran) {
                let error = row.error.expect("locked").nm();
                assert!(
                    error.abs() <= 30_000,
                    "{error} nm at {}: {hole:?}",
                    row.tick
                );
            }
        }
    });
}
