//! Spindles 2 to 4: they tap like spindle 1, one at a time, and cost the bus one drive.

use leadscrew_board_sim::plant::{PlantOptions, Trouble};
use leadscrew_board_sim::{Direction, Row};
use leadscrew_core::alarm::Code;
use leadscrew_core::board::Command;
use leadscrew_core::bus::{NodeId, Service};
use leadscrew_core::call::{SpindleChoice, TapAxis, TapCall, TapCycle, TapSpindle};
use leadscrew_tests::machine::{machine as power_up, run_calls, run_calls_on};
use leadscrew_tests::params::with;

use super::hole::{bottom, deep, high_speed, program, sheet};
use super::watch::{judge, locked, run, tap};

const TAPPERS: [TapSpindle; 3] = [TapSpindle::Second, TapSpindle::Third, TapSpindle::Fourth];

fn on(spindle: TapSpindle, hole: TapCall) -> TapCall {
    TapCall {
        spindle: SpindleChoice::Written(spindle),
        ..hole
    }
}

fn stands(row: &Row, spindle: TapSpindle) -> bool {
    let angle = row.angle(spindle);
    angle.set.is_none() && angle.truth.raw() == 0
}

#[test]
fn every_spindle_taps_like_the_first() {
    let params = with(&[]);
    let shallow = bottom(sheet(), -9_000);
    let forms = [
        shallow,
        high_speed(shallow, 2_500, 700),
        deep(shallow, 2_500, 700),
    ];
    for hole in forms {
        let path = |ran: &leadscrew_tests::machine::Ran| -> Vec<_> {
            locked(ran).map(|row| row.position).collect()
        };
        let first = path(&tap(&hole, &params));
        for spindle in TAPPERS {
            let ran = tap(&on(spindle, hole), &params);
            assert_eq!(path(&ran), first, "{spindle:?}");
            for row in &ran.rows {
                for other in TAPPERS.into_iter().filter(|other| *other != spindle) {
                    assert!(stands(row, other), "{other:?} at tick {}", row.tick);
                }
                assert_eq!(row.spindle.raw(), 0, "spindle 1 at tick {}", row.tick);
            }
            assert!(locked(&ran).all(|row| row.angle(spindle).set.is_some()));
            assert!(ran.rows.last().is_some_and(|row| !row.is_rigid()));
        }
    }
}

#[test]
fn holes_may_change_over_from_spindle_to_spindle() {
    let params = with(&[]);
    let hole = bottom(sheet(), -6_000);
    let order = [
        TapSpindle::Third,
        TapSpindle::First,
        TapSpindle::Fourth,
        TapSpindle::Fourth,
        TapSpindle::Second,
    ];
    let holes = order.map(|spindle| on(spindle, hole));
    let ran = run(program(&holes), &params);
    assert_eq!(ran.alarm, None);
    let mut seen = Vec::new();
    for row in locked(&ran) {
        let rigid: Vec<_> = TapSpindle::ALL
            .into_iter()
            .filter(|spindle| row.angle(*spindle).set.is_some())
            .collect();
        assert_eq!(rigid.len(), 1, "tick {}", row.tick);
        assert!(row.error.expect("locked").nm().abs() <= 1, "{row:?}");
        if seen.last() != Some(&(row.line, rigid[0])) {
            seen.push((row.line, rigid[0]));
        }
    }
    let expected: Vec<_> = (2..).zip(order).collect();
    assert_eq!(seen, expected);
    // Each is back where it began.
    let last = ran.rows.last().expect("rows");
    assert!(TapSpindle::ALL.iter().all(|spindle| stands(last, *spindle)));
}

#[test]
fn a_stop_in_a_hole_keeps_any_spindle_in_phase() {
    let params = with(&[("5200.6", 1)]);
    let hole = on(TapSpindle::Fourth, bottom(sheet(), -9_000));
    let ticks = tap(&hole, &params).rows.len() as u64;
    for command in [Command::Hold, Command::Reset, Command::Stop] {
        for at in (60..ticks - 60).step_by(97) {
            let mut resume = None;
            let options = PlantOptions::default();
            let ran = run_calls(program(&[hole]), &params, &options, |sim, tick| {
                if tick == at {
                    sim.command(command);
                    resume = (command == Command::Hold).then_some(tick + 400);
                }
                if resume == Some(tick) {
                    sim.command(Command::Resume);
                }
            });
            judge(&ran, &hole, &params);
        }
    }
}

#[test]
fn the_bus_carries_one_spindle_more_and_not_three() {
    let params = with(&[]);
    let hole = on(TapSpindle::Third, bottom(sheet(), -6_000));
    let mut sim = power_up(&params, &PlantOptions::default());
    let mut waiting = program(&[hole]).into_iter().peekable();
    let mut told = [0_u32; 4];
    let nodes = [
        NodeId::SPINDLE_1,
        NodeId::SPINDLE_2,
        NodeId::SPINDLE_3,
        NodeId::SPINDLE_4,
    ];
    let mut ticks = 0;
    let mut rigid = 0;
    while waiting.peek().is_some() || sim.is_busy() {
        while waiting.peek().is_some_and(|call| sim.offer(call)) {
            waiting.next();
        }
        let mut setpoints = 0;
        let row = sim.step_on(&mut |direction, frame| {
            let Some((Service::Rpdo1, node)) = frame.id().service() else {
                return;
            };
            assert_eq!(direction, Direction::FromBoard);
            setpoints += 1;
            if let Some(place) = nodes.iter().position(|known| *known == node) {
                told[place] += 1;
            }
        });
        // X, Z, C, the selected spindle, and one of the others in turn.
        assert!((4..=5).contains(&setpoints), "tick {ticks}: {setpoints}");
        rigid += u32::from(row.is_some_and(|row| row.angle(TapSpindle::Third).set.is_some()));
        ticks += 1;
    }
    // The selected one in every tick, the others in every fourth: in all, less than two drives.
    assert!(told[2] >= rigid && rigid > 500, "{told:?} of {rigid}");
    for place in [1, 3] {
        assert!(told[place].abs_diff(ticks / 4) <= 1, "{told:?} of {ticks}");
    }
    assert!(
        told.iter().sum::<u32>() <= ticks + ticks * 3 / 4 + 8,
        "{told:?}"
    );
}

#[test]
fn a_spindle_that_fails_stops_the_machine_whether_it_taps_or_not() {
    let params = with(&[]);
    let hole = on(TapSpindle::Third, bottom(sheet(), -9_000));
    let troubles = [
        (Trouble::Fault(0x7300), Code::DriveFault),
        (Trouble::Silent, Code::DriveSilent),
        (Trouble::TorqueOff, Code::DriveLost),
    ];
    for place in 0..3 {
        for (trouble, code) in troubles {
            let sim = power_up(&params, &PlantOptions::default());
            let mut told = None;
            let ran = run_calls_on(sim, program(&[hole]), |sim, tick| {
                if tick == 400 {
                    let tapper = sim.plant().tappers().nth(place).expect("three");
                    tapper.drive().trouble(trouble);
                }
                if told.is_none() && sim.board().ticker().takes_calls() {
                    return;
                }
                told = told.or(Some(tick));
            });
            assert_eq!(ran.alarm.map(|alarm| alarm.code), Some(code), "{place}");
            let told = told.expect("an alarm");
            assert!((400..430).contains(&told), "{place} {trouble:?}: {told}");
        }
    }
}

#[test]
fn a_side_tap_needs_drives_that_act_together() {
    let side = on(
        TapSpindle::Second,
        TapCall {
            cycle: TapCycle::G88,
            axis: TapAxis::X,
            ..bottom(sheet(), -9_000)
        },
    );
    tap(&side, &with(&[]));
    tap(&side, &with(&[("9003.X", 2000), ("9003.Z", 2000)]));
    let ran = run(program(&[side]), &with(&[("9003.Z", 2000)]));
    assert_eq!(
        ran.alarm.map(|alarm| alarm.code),
        Some(Code::TapDrivesApart)
    );
    let first = ran.rows[0].position;
    assert!(ran.rows.iter().all(|row| row.position == first));
    // Along Z the spindle's drive acts with Z's.
    let face = on(TapSpindle::Second, bottom(sheet(), -9_000));
    tap(&face, &with(&[("9003.Z", 2000)]));
}
