//! What is odd about a drive, one thing a test.

use leadscrew_board_sim::plant::{HomingOptions, Power};
use leadscrew_core::alarm::{Arg, Code};
use leadscrew_core::board::{Command, Event, State};
use leadscrew_core::units::{Axes, Axis};
use leadscrew_tests::params::set;

use crate::bench::{Bench, MARK, SWITCHES, params};

/// The home switch from the left, where the axis stands on the left of it.
const METHOD: u8 = 24;
const START: i64 = 290_000;
/// The edge.
const EDGE: i64 = 300_000;

fn with(options: HomingOptions) -> Bench {
    Bench::new(START, options, METHOD)
}

/// The machine's position, where the mark is at this place.
fn machine(bench: &mut Bench, mark: i64) -> i64 {
    MARK + (bench.drive().place() - mark) * 100
}

#[test]
fn the_order_on_the_wire() {
    let mut bench = with(SWITCHES);
    bench.home_x("once");
    let mut words: Vec<u16> = bench.told.iter().map(|(control, ..)| *control).collect();
    words.dedup();
    assert_eq!(words, [0x0F, 0x1F, 0x0F]);
    assert_eq!(bench.modes, [6, 8]);
    bench.judge("once", 8);
}

/// 607Ch has to be 0: with another value the mark is not where it is taken to be, and to which side depends on the drive.
#[test]
fn the_sign_of_607c() {
    for (adds_offset, sign) in [(false, 1), (true, -1)] {
        let mut bench = with(HomingOptions {
            adds_offset,
            ..SWITCHES
        });
        bench.write(0x607C, 0, 4, 1_000);
        let at = bench.home_x("607Ch");
        assert_eq!(at, machine(&mut bench, EDGE + sign * 1_000));
        bench.judge("607Ch", 8);
    }
}

/// Bits of the homing before that stand for less than 100 ms do not count: neither "not started" nor "done".
#[test]
fn stale_bits() {
    for stale in [1, 20, 60, 98] {
        let mut bench = with(HomingOptions { stale, ..SWITCHES });
        for round in ["first", "second"] {
            let what = format!("{stale} {round}");
            let at = bench.home_x(&what);
            assert_eq!(at, machine(&mut bench, EDGE), "{what}");
            bench.judge(&what, 8);
        }
    }
}

/// "Not started" that stands for longer is believed.
#[test]
fn it_does_not_start() {
    let mut bench = with(HomingOptions {
        stale: 400,
        ..SWITCHES
    });
    let alarm = bench.fails("400");
    assert_eq!(alarm.code, Code::HomeError);
    bench.judge("400", 8);
    goes_on(&mut bench, "400");
}

#[test]
fn it_never_ends() {
    let mut bench = with(HomingOptions {
        never: true,
        ..SWITCHES
    });
    let alarm = bench.fails("never");
    assert_eq!(alarm.code, Code::HomeNotFound);
    assert!((30_000..30_200).contains(&bench.ticks), "{}", bench.ticks);
    bench.judge("never", 8);
    goes_on(&mut bench, "never");
}

#[test]
fn it_goes_too_far() {
    let mut params = params();
    // 20 mm; the switch is 40 mm away.
    set(&mut params, "9062.X", 20_000_000);
    let mut bench = Bench::with(&params, -100_000, SWITCHES, METHOD);
    let alarm = bench.fails("far");
    assert_eq!(alarm.code, Code::HomeNotFound);
    let place = bench.drive().place();
    // 20 mm, a status, and the brakes: 20 mm/s at 0.2 m/s² take 1 mm.
    assert!((100_000..112_000).contains(&place), "{place}");
    bench.judge("far", 8);
    goes_on(&mut bench, "far");
}

/// An index that lies behind the limit switch.
#[test]
fn the_drive_reports_an_error() {
    let mut bench = Bench::new(980_000, SWITCHES, 34);
    let alarm = bench.fails("limit");
    assert_eq!(alarm.code, Code::HomeError);
    assert_eq!(alarm.args[0], Arg::Letter(b'X'));
    let mut words: Vec<u16> = bench.told.iter().map(|(control, ..)| *control).collect();
    words.dedup();
    assert_eq!(words, [0x0F, 0x1F, 0x10F, 0x0F]);
    assert_eq!(bench.modes, [6, 8]);
    bench.judge("limit", 8);
}

#[test]
fn a_slow_6061() {
    for slow in [3, 50, 400] {
        let mut bench = with(HomingOptions { slow, ..SWITCHES });
        let at = bench.home_x("slow");
        assert_eq!(at, machine(&mut bench, EDGE), "{slow}");
        bench.judge("slow", 8);
    }
}

#[test]
fn a_6061_that_does_not_come() {
    let mut bench = with(HomingOptions {
        slow: 5_000,
        ..SWITCHES
    });
    let alarm = bench.fails("mode");
    assert_eq!(
        (alarm.code, alarm.args[1]),
        (Code::HomeModeRefused, Arg::Int(8))
    );
    bench.judge("mode", 8);
}

/// It homes, and does not come back to position mode: it gets quick stop.
#[test]
fn a_6061_that_does_not_come_back() {
    let mut bench = with(SWITCHES);
    bench.home(Axes::NONE.with(Axis::X));
    bench.until("running", |bench| {
        bench.told.iter().any(|told| told.0 == 0x1F)
    });
    bench.drive().set_homing(HomingOptions {
        slow: 5_000,
        ..SWITCHES
    });
    bench.until("alarm", |bench| matches!(bench.state(), State::Alarm(_)));
    let alarm = bench.alarm("mode");
    assert_eq!(
        (alarm.code, alarm.args[2]),
        (Code::DriveNotInMode, Arg::Int(6))
    );
    assert!(!bench.referenced().contains(Axis::X));
    bench.tick();
    bench.tick();
    assert_eq!(bench.drive().power(), Power::QuickStop);
    bench.judge("mode", 8);
}

/// The drive is switched off and on at every place of a homing: it has forgotten its mode and its count.
#[test]
fn power_lost_inside() {
    for off in (2..900).step_by(leadscrew_seed::amount(97, 7)) {
        let what = format!("off at {off}");
        let mut bench = with(HomingOptions {
            forgets: true,
            ..SWITCHES
        });
        bench.home(Axes::NONE.with(Axis::X));
        bench.until(&what, |bench| bench.ticks == off);
        bench.drive().restart();
        bench.until(&what, |bench| matches!(bench.state(), State::Alarm(_)));
        assert_eq!(bench.alarm(&what).code, Code::DriveRestarted, "{what}");
        assert!(!bench.referenced().contains(Axis::X), "{what}");
        goes_on(&mut bench, &what);
    }
}

/// Feed hold: the axis halts on its way, with its homing under way, and goes on after it.
#[test]
fn held_on_its_way() {
    for at in (4..900).step_by(leadscrew_seed::amount(97, 7)) {
        let what = format!("held at {at}");
        let mut bench = with(SWITCHES);
        bench.home(Axes::NONE.with(Axis::X));
        bench.until(&what, |bench| bench.ticks == at);
        bench.sim.command(Command::Hold);
        for _ in 0..600 {
            bench.tick();
        }
        bench.judge(&what, 400);
        if bench.state() == State::Homing {
            bench.sim.command(Command::Resume);
            bench.until(&what, |bench| bench.state() != State::Homing);
        }
        assert_eq!(bench.state(), State::Idle, "{what} {:?}", bench.events);
        let at = bench.at().x.nm();
        assert_eq!(at, machine(&mut bench, EDGE), "{what}");
        bench.judge(&what, 8);
    }
}

/// A reset in homing: 4521 as a warning, and the machine is ready.
#[test]
fn cancelled_by_reset() {
    for at in (1..900).step_by(leadscrew_seed::amount(89, 7)) {
        let what = format!("reset at {at}");
        let mut bench = with(SWITCHES);
        bench.home(Axes::NONE.with(Axis::X));
        bench.until(&what, |bench| bench.ticks == at);
        if bench.state() == State::Idle {
            continue;
        }
        bench.sim.command(Command::Reset);
        bench.tick();
        bench.until(&what, |bench| bench.state() == State::Idle);
        let told = bench.events.iter().any(
            |event| matches!(event, Event::Warning(alarm) if alarm.code == Code::HomeCancelled),
        );
        assert!(told, "{what}");
        assert!(!bench.referenced().contains(Axis::X), "{what}");
        bench.judge(&what, 2);
        let at = bench.home_x(&what);
        assert_eq!(at, machine(&mut bench, EDGE), "{what}");
        bench.judge(&what, 8);
    }
}

/// After the alarm the drive is mended and the machine reset: it homes.
fn goes_on(bench: &mut Bench, what: &str) {
    bench.drive().set_homing(SWITCHES);
    // A drive that was switched off has forgotten these.
    bench.prepare(METHOD);
    bench.sim.command(Command::Reset);
    bench.tick();
    bench.until(what, |bench| bench.state() == State::Idle);
    assert!(!bench.referenced().contains(Axis::X), "{what}");
    let place = bench.drive().place();
    if place > 400_000 {
        return;
    }
    if bench.sim.board().params().home_travel(Axis::X) == params().home_travel(Axis::X) {
        let at = bench.home_x(what);
        assert_eq!(at, machine(bench, EDGE), "{what}");
        bench.judge(what, 8);
    }
}
