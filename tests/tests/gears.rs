//! Gears on the simulated machine: what its drive is told, when a gear is selected, and what is refused.

#![expect(
    clippy::inconsistent_digit_grouping,
    reason = "a row is written by its fields: CCC H OO A II TTTT"
)]

use leadscrew_board_sim::plant::PlantOptions;
use leadscrew_board_sim::{Doing, Row};
use leadscrew_core::alarm::{Alarm, Code};
use leadscrew_core::board::{Inputs, State};
use leadscrew_core::bus::SpindleCommand;
use leadscrew_core::call::{Aux, Call, CallKind, SpindleCall};
use leadscrew_core::params::Params;
use leadscrew_core::units::Rpm;
use leadscrew_tests::machine::{calls, machine};
use leadscrew_tests::params::with;

/// Gear 1 has 4 turns of the motor for one of the spindle, gear 2 has 2 for 3. M41 switches output 1 on, M42 off; input 1
/// answers within a second: on in gear 1.
fn geared() -> Params {
    with(&[
        ("9401", 41_1_01_1_01_0100),
        ("9402", 42_2_01_2_01_0100),
        ("9431", 4),
        ("9436", 1),
        ("9441", 600),
        ("9432", 2),
        ("9437", 3),
        ("9442", 3000),
    ])
}

/// What happened until the program was over, or an alarm stood.
struct Seen {
    rows: Vec<Row>,
    alarm: Option<Alarm>,
    /// Each speed that the drive of the spindle was told, in thousandths of a turn a minute, once.
    told: Vec<i32>,
    /// The gear after each tick.
    gears: Vec<u8>,
    /// Measured speed of the spindle in each tick.
    rpm: Vec<i32>,
}

/// Runs calls with input 1 as output 1 is, `late` ticks behind it; `None`: it stays off.
fn run(params: &Params, calls: Vec<Call>, late: Option<usize>) -> Seen {
    let mut sim = machine(params, &PlantOptions::default());
    let mut calls = calls.into_iter().peekable();
    let mut seen = Seen {
        rows: Vec::new(),
        alarm: None,
        told: Vec::new(),
        gears: Vec::new(),
        rpm: Vec::new(),
    };
    let mut outputs = Vec::new();
    for tick in 0..60_000_usize {
        while calls.peek().is_some_and(|call| sim.offer(call)) {
            calls.next();
        }
        let level = late.and_then(|late| outputs.get(tick.checked_sub(late + 1)?).copied());
        sim.set_pins(Inputs {
            machine: Some(level.unwrap_or(0)),
            ..Inputs::default()
        });
        let told = &mut seen.told;
        let row = sim.step_on(&mut |_, frame| {
            if let Some((node, command)) = SpindleCommand::decode(frame)
                && node.get() == 32
                && told.last() != Some(&command.velocity.get())
            {
                told.push(command.velocity.get());
            }
        });
        seen.rows.extend(row);
        let ticker = sim.board().ticker();
        outputs.push(ticker.machine_outputs() as u16);
        seen.gears.push(ticker.gear());
        seen.rpm.push(ticker.observer().speed().rpm().get());
        if let State::Alarm(alarm) = ticker.state() {
            seen.alarm = Some(alarm);
            return seen;
        }
        if tick > 100 && calls.peek().is_none() && !ticker.in_program() {
            return seen;
        }
    }
    panic!("neither an end nor an alarm");
}

fn run_text(params: &Params, text: &str, late: Option<usize>) -> Seen {
    run(params, calls(text, params), late)
}

#[test]
fn the_drive_turns_as_the_gear_asks_and_the_spindle_as_the_program_does() {
    let params = geared();
    let text = "M41\nM3 S500\nG4 P2000\nM5\nM42\nM3 S1500\nG4 P3000\nM5\nM30\n";
    let seen = run_text(&params, text, Some(50));
    assert_eq!(seen.alarm, None);
    assert_eq!(seen.told, [0, 2_000_000, 0, 1_000_000, 0]);
    for speed in [500, 1500] {
        let there = seen.rpm.iter().filter(|rpm| **rpm == speed);
        assert!(there.count() > 500, "{speed}");
    }
    let mut gears = seen.gears.clone();
    gears.dedup();
    // None is known while a row waits for its answer.
    assert_eq!(gears, [0, 1, 0, 2]);
}

#[test]
fn a_gear_waits_until_the_spindle_has_stood_for_a_second() {
    let params = geared();
    let seen = run_text(&params, "M41\nM3 S500\nG4 P1000\nM5\nM42\nM30\n", Some(0));
    assert_eq!(seen.alarm, None);
    let shifts = seen
        .gears
        .windows(2)
        .position(|two| two == [1, 0] || two == [1, 2]);
    let shifts = shifts.expect("a shift");
    let turned = seen
        .rpm
        .iter()
        .rposition(|rpm| *rpm != 0)
        .expect("it turned");
    // The observer tells rest a little later than it tells a speed of less than half a turn.
    assert!(
        (1000..1400).contains(&(shifts - turned)),
        "{shifts} {turned}"
    );
    let waits = seen
        .rows
        .iter()
        .filter(|row| row.doing == Doing::Wait && row.line == 5);
    assert!(waits.count() > 1000);
}

#[test]
fn the_board_itself_refuses_a_speed_without_a_gear_or_above_it() {
    let params = geared();
    let call = |kind| {
        let mut call = calls("M41\nM30\n", &params)[0];
        call.kind = kind;
        call
    };
    let speed = |rpm| call(CallKind::Spindle(SpindleCall::speed(Rpm::new(rpm))));
    let gear = |code| call(CallKind::Aux(Aux::M(code)));
    let code = |calls: Vec<Call>| run(&params, calls, Some(0)).alarm.map(|alarm| alarm.code);
    assert_eq!(code(vec![speed(100)]), Some(Code::GearUnknown));
    assert_eq!(code(vec![gear(41), speed(601)]), Some(Code::SpeedAboveGear));
    // A gear while the spindle is told to turn.
    let told = code(vec![gear(41), speed(100), gear(42)]);
    assert_eq!(told, Some(Code::Interlocked));
    // An answer that does not come leaves no gear.
    let late = run(&params, vec![gear(41)], None);
    assert_eq!(late.alarm.map(|alarm| alarm.code), Some(Code::AnswerLate));
    assert_eq!(late.gears.last(), Some(&0));
}

#[test]
fn a_gear_without_a_row_is_known_at_once() {
    let params = with(&[("9433", 3), ("9438", 1), ("9443", 1000)]);
    let seen = run_text(&params, "M43\nM3 S400\nG4 P500\nM5\nM30\n", None);
    assert_eq!(seen.alarm, None);
    assert_eq!(seen.told, [0, 1_200_000, 0]);
}

#[test]
fn a_rigid_tap_is_cut_in_a_gear_as_without_one() {
    let text = "M3 S200\nG4 P500\nM5\nG0 X0 Z5\nM29 S300\nG84 Z-10 F450\nG80\nM30\n";
    let plain = run_text(&with(&[]), text, None);
    assert_eq!(plain.alarm, None);
    let geared = run_text(&geared(), &format!("M41\n{text}"), Some(0));
    assert_eq!(geared.alarm, None);
    let deepest = |seen: &Seen| seen.rows.iter().map(|row| row.position.z.nm()).min();
    assert_eq!(deepest(&plain), deepest(&geared));
    // The spindle follows the axis in the hole: to an increment of its drive, which is finer in this gear.
    let worst = |seen: &Seen| {
        let cut = seen.rows.iter().filter(|row| row.error.is_some());
        cut.filter_map(|row| row.error)
            .map(|error| error.nm().abs())
            .max()
    };
    assert!(
        worst(&geared) <= worst(&plain),
        "{:?} {:?}",
        worst(&geared),
        worst(&plain)
    );
}

/// Increments mean other angles in another gear, so the drive would be told a leap.
#[test]
fn no_gear_is_selected_while_the_spindle_is_held_at_an_angle() {
    let params = geared();
    let text = "M41\nM3 S100\nG4 P1000\nM19 R90\nG4 P100\nM42\nG4 P200\nM30\n";
    let seen = run(&params, calls(text, &params), Some(1));
    let alarm = seen.alarm.expect("M42 is refused");
    assert_eq!((alarm.code, alarm.span.line), (Code::Interlocked, 6));
    assert_eq!(seen.gears.last(), Some(&1));
    let stood = seen.rows.iter().filter(|row| row.spindle_set.is_some());
    assert!(stood.count() > 100, "it stood at its angle");
}
