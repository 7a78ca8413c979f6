//! Drives that fail.

use leadscrew_board_sim::Sim;
use leadscrew_board_sim::plant::{DriveOptions, PlantOptions, Power, Trouble};
use leadscrew_core::alarm::{Arg, Code};
use leadscrew_core::board::{Command, Event, Outcome, State};
use leadscrew_core::bus::{NmtCommand, NodeId};
use leadscrew_core::call::Position;
use leadscrew_core::params::Params;
use leadscrew_core::units::{Angle, Axis, Length};
use leadscrew_seed::amount;
use leadscrew_tests::bench::{Bench, Lathe, PATIENCE, WORK};
use leadscrew_tests::params::with;

use crate::bench::{Recovers, calm, places};

/// All that a drive can do wrong, at every place; then it is mended, and the next program runs.
#[test]
fn a_failing_drive_anywhere_and_the_next_program() {
    let params = Params::sheets();
    let calm = calm(&params);
    let troubles = [
        Trouble::Silent,
        Trouble::Stuck,
        Trouble::Fault(0x3210),
        Trouble::TorqueOff,
    ];
    for (turn, tick) in places(&calm, amount(293, 11)).enumerate() {
        let trouble = troubles[turn % 4];
        let which = turn / 4 % 4;
        // A spindle has no position to be away from; a standing axis does not miss one.
        if trouble == Trouble::Stuck {
            continue;
        }
        let what = format!("{trouble:?} of drive {which} at {tick}");
        let mut bench = Lathe::new(&params);
        bench.load(WORK);
        bench.until(&what, tick, |bench| bench.ticks == tick);
        let drive = |bench: &mut Lathe, trouble| {
            let plant = bench.sim.plant();
            match which {
                0 => plant.drive(Axis::X),
                1 => plant.drive(Axis::Z),
                2 => plant.drive(Axis::C),
                _ => plant.spindle_drive(),
            }
            .trouble(trouble);
        };
        drive(&mut bench, trouble);
        bench.until(&what, 20, |bench| bench.alarm.is_some());
        bench.until_on_alarm(&what, PATIENCE);
        bench.stands(&what);
        // Not mended: the reset ends in an alarm again, and still nothing moves.
        bench.alarm = None;
        bench.sim.command(Command::Reset);
        bench.tick();
        bench.until(&what, 5_000, |bench| bench.alarm.is_some());
        bench.until_on_alarm(&what, 5_000);
        bench.stands(&what);
        drive(&mut bench, Trouble::None);
        bench.ticks(10);
        bench.reset(&what);
        bench.stands(&what);
        bench.next(&what);
    }
}

/// What fails while the machine stops or stands on an alarm is acted on, and not told: the first cause stays. A reset that
/// is carried out ends that alarm, and what is still wrong then is the next one [D181].
#[test]
fn a_second_failure_is_let_go_and_told_behind_the_reset() {
    let params = Params::sheets();
    let calm = calm(&params);
    for tick in places(&calm, amount(601, 59)) {
        // In the same tick, while it stops, and when it stands.
        for later in [0, 1, 7, 400] {
            let what = format!("X at {tick}, Z {later} later");
            let mut bench = Lathe::new(&params);
            bench.load(WORK);
            bench.until(&what, tick, |bench| bench.ticks == tick);
            let fault = Trouble::Fault(0x3210);
            bench.sim.plant().drive(Axis::X).trouble(fault);
            bench.until(&what, 20, |bench| bench.alarm.is_some());
            let first = bench.alarm.expect("an alarm");
            assert_eq!(first.args[0], Arg::Letter(b'X'), "{what}");
            bench.ticks(later);
            bench.sim.plant().drive(Axis::Z).trouble(fault);
            bench.sim.command(Command::Stop);
            for _ in 0..500 {
                bench.tick();
                let shown = match bench.state() {
                    State::Alarm(alarm) | State::Stopping(Outcome::Alarm(alarm)) => Some(alarm),
                    _ => None,
                };
                assert_eq!(shown, Some(first), "{what}");
            }
            bench.stands(&what);
            for axis in [Axis::X, Axis::Z] {
                assert_eq!(
                    bench.sim.plant().drive(axis).power(),
                    Power::Fault,
                    "{what}"
                );
            }
            let told = |bench: &Lathe| {
                let alarms = bench.events.iter();
                alarms
                    .filter(|event| matches!(event, Event::Alarm(_)))
                    .count()
            };
            assert_eq!(told(&bench), 1, "{what}");
            // X is well again, and Z is not.
            bench.sim.plant().drive(Axis::X).trouble(Trouble::None);
            bench.alarm = None;
            bench.sim.command(Command::Reset);
            bench.until(&what, 5_000, |bench| bench.alarm.is_some());
            let second = bench.alarm.expect("an alarm");
            assert_eq!(second.code, Code::DriveFaultNotReset, "{what}");
            assert_eq!(second.args[0], Arg::Letter(b'Z'), "{what}");
            bench.until_on_alarm(&what, PATIENCE);
            bench.sim.plant().drive(Axis::Z).trouble(Trouble::None);
            bench.ticks(10);
            bench.reset(&what);
            bench.next(&what);
        }
    }
}

/// Drives that take their time come up one after the other where they hear one frame of CAN FD (9031): the first is held
/// where it stands until the last is there, which takes longer than a step of one may, and nothing is said of a jump.
#[test]
fn a_drive_that_is_up_first_waits_for_the_last_where_it_stands() {
    for (together, settling) in [(0, 60), (1, 60), (1, 110)] {
        let what = format!("9031 = {together}, {settling} periods");
        let params = with(&[("9031", together)]);
        let options = PlantOptions {
            at: Position {
                x: Length::from_nm(31_000_000),
                z: Length::from_nm(-4_000_000),
                c: Angle::from_udeg(70_000_000),
            },
            drives: DriveOptions {
                settling,
                ..DriveOptions::default()
            },
            ..PlantOptions::default()
        };
        let mut sim =
            Sim::new(&params, &options).unwrap_or_else(|error| panic!("{what}: {error:?}"));
        for _ in 0..50 {
            sim.step();
        }
        assert_eq!(sim.event(), None, "{what}");
        let at = sim.board().ticker().executor().position();
        assert_eq!(at, options.at, "{what}");
        for axis in [Axis::X, Axis::Z, Axis::C] {
            assert_eq!(sim.plant().drive(axis).power(), Power::Enabled, "{what}");
        }
    }
}

/// NMT reset node makes the application anew: the alarm that it stood on is over. A fault that is still there is told
/// again, with the error code of the emergency that came before: the drive does not say it twice.
#[test]
fn a_fault_keeps_its_code_when_the_node_is_reset() {
    let mut bench = Lathe::new(&Params::sheets());
    bench.sim.join(NodeId::BOARD).expect("there is room");
    bench.ticks(20);
    for spindle in [false, true] {
        let what = format!("spindle {spindle}");
        let trouble = |bench: &mut Lathe, trouble| {
            let plant = bench.sim.plant();
            match spindle {
                false => plant.drive(Axis::Z),
                true => plant.spindle_drive(),
            }
            .trouble(trouble);
        };
        trouble(&mut bench, Trouble::Fault(0x2310));
        for anew in [false, true] {
            if anew {
                let reset = NmtCommand::ResetNode.frame(Some(NodeId::BOARD));
                bench.alarm = None;
                bench.sim.receive(&reset);
                // The device asks for it in this period, the tick carries it out in the next.
                bench.ticks(2);
                assert_eq!(bench.state(), State::Starting, "{what}");
            }
            bench.until(&what, 50, |bench| bench.alarm.is_some());
            let alarm = bench.alarm.expect("an alarm");
            assert_eq!(alarm.code, Code::DriveFault, "{what}");
            let named = match spindle {
                false => [Arg::Letter(b'Z'), Arg::Int(17)],
                true => [Arg::Letter(b'S'), Arg::Int(32)],
            };
            assert_eq!(alarm.args[..2], named, "{what}");
            assert_eq!(alarm.args[3], Arg::Hex(0x2310), "{what}, anew {anew}");
            bench.until_on_alarm(&what, 50);
        }
        trouble(&mut bench, Trouble::None);
        bench.ticks(10);
        bench.reset(&what);
    }
}
