//! A spindle that does not turn as it should, and an encoder that does not count as it should.

use leadscrew_board_sim::{Doing, Row};
use leadscrew_core::board::Command;
use leadscrew_core::params::Params;
use leadscrew_core::units::Axis;
use leadscrew_seed::amount;
use leadscrew_tests::bench::{Bench, Lathe, NEXT, PATIENCE, WORK};

use crate::bench::{Recovers, calm, places};

/// The first tick of the n-th row held to the helix.
fn locked(rows: &[Row], nth: usize) -> u64 {
    let row = rows.iter().filter(|row| row.error.is_some()).nth(nth);
    row.expect("a locked row").tick
}

/// From the tick of an alarm on the axes brake by time: no tick in which they stand and then go on.
fn brakes_at_once(rows: &[Row], params: &Params, what: &str) {
    let first = rows.iter().position(|row| row.doing == Doing::Alarm);
    let first = first.unwrap_or_else(|| panic!("{what}: no row of the alarm"));
    let tick = f64::from(params.tick_us()) * 1e-6;
    for axis in [Axis::X, Axis::Z] {
        let limit = params.acceleration(axis).nm_per_s2() as f64 * tick * tick + 2.0;
        for window in rows[first - 2..].windows(3) {
            let [a, b, c] = [0, 1, 2].map(|i| match axis {
                Axis::X => window[i].position.x.nm(),
                _ => window[i].position.z.nm(),
            });
            let second = (c - 2 * b + a) as f64;
            assert!(
                second.abs() <= limit,
                "{what}: {axis:?} accelerates by {second} nm at {}",
                window[2].tick
            );
        }
    }
}

/// Disturbs the spindle in a stroke: percent, and the alarm that must come within so many ticks.
fn spindle_trouble(percent: i16, alarm: u16, within: u64) {
    let params = Params::sheets();
    let calm = calm(&params);
    for nth in (0..600).step_by(amount(199, 61)) {
        let tick = locked(&calm, nth);
        let what = format!("spindle at {percent} % from {tick} on");
        let mut bench = Lathe::new(&params);
        bench.load(WORK);
        bench.until(&what, tick, |bench| bench.ticks == tick);
        bench.sim.plant().spindle().disturb(percent);
        bench.until(&what, within, |bench| bench.alarm.is_some());
        assert_eq!(
            bench.alarm.map(|alarm| alarm.number()),
            Some(alarm),
            "{what}"
        );
        bench.until_on_alarm(&what, PATIENCE);
        brakes_at_once(&bench.rows, &params, &what);
        bench.stands(&what);
        bench.sim.plant().spindle().disturb(100);
        bench.reset(&what);
        bench.stands(&what);
        bench.next(&what);
    }
}

/// The feed stands with its spindle, as long as the spindle may take to its speed, and no longer.
#[test]
fn a_spindle_that_stands_in_a_feed_per_turn() {
    const TURNING: &str = "G99\nM3 S300\nG0 X40 Z2\nG1 Z-20 F0.2\nM30\n";
    let params = Params::sheets();
    for tick in (3_000..20_000).step_by(amount(6_000, 1_000)) {
        let what = format!("from {tick} on");
        let mut bench = Lathe::new(&params);
        bench.load(TURNING);
        bench.until(&what, tick, |bench| bench.ticks == tick);
        // A short stall ends by itself, and whoever holds the feed may turn the spindle by hand.
        bench.sim.plant().spindle().disturb(0);
        bench.until(&what, 2_000, |bench| bench.ticks == tick + 2_000);
        bench.sim.command(Command::Hold);
        bench.until(&what, 10_000, |bench| bench.ticks == tick + 12_000);
        bench.sim.plant().spindle().disturb(100);
        bench.until(&what, 1_000, |bench| bench.ticks == tick + 13_000);
        bench.sim.command(Command::Resume);
        bench.until(&what, 1_000, |bench| bench.ticks == tick + 14_000);
        assert_eq!(bench.alarm, None, "{what}");
        bench.sim.plant().spindle().disturb(0);
        // Twice the ramp to 3000 rpm and a second: 4 s, and the ramp down.
        bench.until(&what, 4_500, |bench| bench.alarm.is_some());
        let number = bench.alarm.map(|alarm| alarm.number());
        assert_eq!(number, Some(4303), "{what}");
        bench.until_on_alarm(&what, PATIENCE);
        brakes_at_once(&bench.rows, &params, &what);
        bench.sim.plant().spindle().disturb(100);
        bench.reset(&what);
        bench.next(&what);
    }
}

/// The same where a feed by time goes over into it without a stop: the tool stands at the end of a cut that asks for no
/// turns.
#[test]
fn a_spindle_that_stands_before_a_feed_per_turn_of_joined_cuts() {
    const JOINED: &str =
        "G98 G64\nM3 S300\nG0 X40 Z2\nG1 Z0 F100\nG1 Z-0.1\nG99 G1 Z-20 F0.2\nM30\n";
    let params = Params::sheets();
    let mut bench = Lathe::new(&params);
    bench.load(JOINED);
    bench.until(JOINED, 20_000, |bench| {
        bench
            .rows
            .last()
            .is_some_and(|row| row.position.z.nm() < 1_000_000)
    });
    bench.sim.plant().spindle().disturb(0);
    bench.until(JOINED, 7_000, |bench| bench.alarm.is_some());
    assert_eq!(bench.alarm.map(|alarm| alarm.number()), Some(4303));
    let at = bench.rows.last().expect("a row").position;
    assert_eq!(at.z.nm(), -100_000);
}

#[test]
fn a_spindle_that_stops_in_a_stroke() {
    spindle_trouble(0, 4250, 2_000);
}

#[test]
fn a_spindle_that_reverses_in_a_stroke() {
    spindle_trouble(-100, 4250, 2_000);
}

#[test]
fn a_spindle_far_too_fast_in_a_stroke() {
    spindle_trouble(400, 4257, 2_000);
}

/// The index and the counts disagree: at once in a stroke, before the next one otherwise.
#[test]
fn an_encoder_that_slips_anywhere_and_the_next_program() {
    let params = Params::sheets();
    let calm = calm(&params);
    for tick in places(&calm, amount(293, 23)) {
        let what = format!("slip at {tick}");
        let mut bench = Lathe::new(&params);
        bench.load(WORK);
        bench.until(&what, tick, |bench| bench.ticks == tick);
        let before = bench.rows.len();
        bench.sim.plant().encoder().slip(40);
        bench.finish(&what);
        if bench.alarm.is_some() {
            assert_eq!(
                bench.alarm.map(|alarm| alarm.number()),
                Some(4261),
                "{what}"
            );
            bench.stands(&what);
            bench.reset(&what);
        } else {
            // Nothing was cut by the wrong angle.
            let worst = bench.rows[before..]
                .iter()
                .filter_map(|row| row.error)
                .map(|error| error.nm().abs())
                .max();
            assert!(
                worst.is_none_or(|worst| worst <= 1_000),
                "{what}: {worst:?}"
            );
        }
        bench.next(&what);
    }
}

#[test]
fn an_encoder_without_index_is_an_alarm_in_time() {
    let params = Params::sheets();
    let mut bench = Lathe::new(&params);
    bench.sim.plant().encoder().break_index(true);
    bench.load(
        "M3 S600\nG4 P2000\nG0 X64 Z6\nG76 P010060 Q800 R0.1\nG76 X60 Z-6 P8000 Q7000 F1\nM30\n",
    );
    bench.until("ready", 5_000, |bench| {
        bench.sim.board().ticker().executor().thread().is_none()
            && bench
                .rows
                .last()
                .is_some_and(|row| row.line == 5 && row.position.x.nm() < 31_000_000)
            && bench.at().x.nm() < 30_200_000
    });
    let reached = bench.ticks;
    bench.until("no index", 1_300, |bench| bench.alarm.is_some());
    // Two turns at 600 rpm and a second.
    assert!(
        (1_190..1_260).contains(&(bench.ticks - reached)),
        "{}",
        bench.ticks - reached
    );
    assert_eq!(bench.alarm.map(|alarm| alarm.number()), Some(4260));
    bench.until_on_alarm("stop", 50);
    bench.sim.plant().encoder().break_index(false);
    bench.reset("no index");
    bench.next("no index");
    // And lost later on, the counts still right: the next stroke does not begin.
    bench.sim.plant().encoder().break_index(true);
    bench.load(NEXT);
    bench.finish("lost");
    assert_eq!(bench.alarm.map(|alarm| alarm.number()), Some(4260));
}
