//! What goes wrong while a machine works, at every place of a program, and the program after it: the alarm comes in
//! time, everything comes to rest, and behind a reset nothing is left of what was.

use std::collections::VecDeque;

use leadscrew_board_sim::plant::{PlantOptions, Trouble};
use leadscrew_board_sim::{Doing, Row, Sim};
use leadscrew_core::alarm::Alarm;
use leadscrew_core::board::{Command, Event, State};
use leadscrew_core::params::Params;
use leadscrew_core::program::{Call, Position};
use leadscrew_core::units::Axis;
use leadscrew_tests::limits::{first_excess, first_excess_with};
use leadscrew_tests::machine::{calls, machine};
use leadscrew_tests::params::with;

/// A thread without a run-out, two passes, then a groove of one column, short ways.
const WORK: &str = "M3 S600\nG0 X64 Z6\nG76 P010060 Q800 R0.1\nG76 X60 Z-6 P8000 Q7000 F1\nG0 X61 Z-3\n\
                    G98 G75 R0.2\nG75 X58 P10000 F600\nG0 X70 Z8\nM30\n";

/// What comes after: it must do what it would have done first.
const NEXT: &str =
    "M3 S600\nG0 X63 Z5\nG76 P010560 Q800 R0.1\nG76 X61 Z-4 P4000 Q4000 F1\nG0 X80 Z10\nM30\n";

/// Ticks within which any stop must be over: the deepest retract, a rapid out, two seconds for the spindle.
const PATIENCE: u64 = 6_000;

/// A machine, what is still to be handed over, and what it has done.
struct Bench {
    sim: Sim,
    params: Params,
    waiting: VecDeque<Call>,
    rows: Vec<Row>,
    events: Vec<Event>,
    alarm: Option<Alarm>,
    ticks: u64,
}

impl Bench {
    fn new(params: &Params) -> Self {
        Self {
            sim: machine(params, &PlantOptions::default()),
            params: params.clone(),
            waiting: VecDeque::new(),
            rows: Vec::new(),
            events: Vec::new(),
            alarm: None,
            ticks: 0,
        }
    }

    fn load(&mut self, text: &str) {
        self.waiting = calls(text, &self.params).into();
    }

    fn state(&self) -> State {
        self.sim.board().ticker().state()
    }

    fn at(&self) -> Position {
        self.sim.board().ticker().executor().position()
    }

    fn tick(&mut self) {
        while self
            .waiting
            .front()
            .is_some_and(|call| self.sim.offer(call))
        {
            self.waiting.pop_front();
        }
        self.rows.extend(self.sim.step());
        self.ticks += 1;
        while let Some(event) = self.sim.event() {
            if let Event::Alarm(alarm) = event {
                assert_eq!(self.alarm, None, "a second alarm without a reset");
                self.alarm = Some(alarm);
                self.waiting.clear();
            }
            self.events.push(event);
        }
    }

    /// Ticks until the machine has nothing to do or stands on an alarm.
    fn finish(&mut self, what: &str) {
        let begun = self.ticks;
        while !self.waiting.is_empty() || self.sim.is_busy() {
            self.tick();
            assert!(
                self.ticks - begun < 60_000,
                "{what}: stuck in {:?}",
                self.state()
            );
        }
    }

    /// Ticks until `done`, at most `most`.
    fn until(&mut self, what: &str, most: u64, mut done: impl FnMut(&Self) -> bool) {
        let begun = self.ticks;
        while !done(self) {
            self.tick();
            assert!(
                self.ticks - begun <= most,
                "{what}: still {:?} after {most} ticks",
                self.state()
            );
        }
    }

    /// Stands for a while: nothing may move, the spindle not be commanded.
    fn stands(&mut self, what: &str) {
        let at = self.at();
        for _ in 0..50 {
            self.tick();
            assert_eq!(self.at(), at, "{what}: it moves again");
            assert_eq!(self.sim.spindle_command().get(), 0, "{what}: the spindle");
        }
    }

    /// Clears an alarm and comes up again.
    fn reset(&mut self, what: &str) {
        self.sim.command(Command::Reset);
        self.alarm = None;
        self.tick();
        self.until(what, 2_000, |bench| bench.state() == State::Idle);
        assert_eq!(self.alarm, None, "{what}");
    }

    /// Runs a program that must end well at `x`, `z` (nm).
    fn runs(&mut self, what: &str, text: &str, x: i64, z: i64) {
        self.load(text);
        self.finish(what);
        assert_eq!(self.alarm, None, "{what}");
        assert_eq!(
            (self.at().x.nm(), self.at().z.nm()),
            (x, z),
            "{what}: not where it ends"
        );
    }

    fn next(&mut self, what: &str) {
        let from = self.rows.len();
        self.runs(what, NEXT, 40_000_000, 10_000_000);
        let worst = self.rows[from..]
            .iter()
            .filter_map(|row| row.error)
            .map(|error| error.nm().abs())
            .max()
            .unwrap_or_else(|| panic!("{what}: no thread"));
        assert!(worst <= 1_000, "{what}: {worst} nm off the helix");
    }
}

/// How the ticks of a test are chosen: all of them where the machine is fast enough.
fn stride(release: usize, debug: usize) -> usize {
    if cfg!(debug_assertions) {
        debug
    } else {
        release
    }
}

fn calm(params: &Params) -> Vec<Row> {
    let mut bench = Bench::new(params);
    bench.runs("calm", WORK, 35_000_000, 8_000_000);
    bench.rows
}

/// Ticks of `calm`'s program at which something can happen.
fn places(rows: &[Row], step: usize) -> impl Iterator<Item = u64> {
    (1..rows.len() as u64 - 1).step_by(step)
}

fn retracting() -> Params {
    with(&[("9008.0", 1)])
}

#[test]
fn a_reset_anywhere_and_the_next_program() {
    let params = Params::slant_bed();
    let calm = calm(&params);
    // The thread's crest is at X60 + 2 · 0.8 mm.
    let crest = 30_000_000 + 800_000;
    for tick in places(&calm, stride(1, 61)) {
        let what = format!("reset at {tick}");
        let mut bench = Bench::new(&params);
        bench.load(WORK);
        bench.until(&what, tick, |bench| bench.ticks == tick);
        let in_thread = calm[tick as usize].line == 4 && bench.at().z.nm() < 5_000_000;
        bench.waiting.clear();
        bench.sim.command(Command::Reset);
        bench.tick();
        bench.until(&what, PATIENCE, |bench| bench.state() == State::Idle);
        bench.stands(&what);
        assert!(
            !in_thread || bench.at().x.nm() >= crest,
            "{what}: X stays in the thread at {}",
            bench.at().x.nm()
        );
        assert_eq!(first_excess(&bench.rows, &params), None, "{what}");
        bench.next(&what);
    }
}

#[test]
fn an_emergency_stop_anywhere_and_the_next_program() {
    let params = Params::slant_bed();
    let calm = calm(&params);
    for tick in places(&calm, stride(1, 61)) {
        let what = format!("stop at {tick}");
        let mut bench = Bench::new(&params);
        bench.load(WORK);
        bench.until(&what, tick, |bench| bench.ticks == tick);
        bench.sim.command(Command::Stop);
        bench.tick();
        assert_eq!(
            bench.alarm.map(|alarm| alarm.number()),
            Some(4300),
            "{what}"
        );
        bench.until(&what, PATIENCE, |bench| {
            matches!(bench.state(), State::Alarm(_))
        });
        bench.stands(&what);
        let stood = bench.at();
        bench.reset(&what);
        bench.stands(&what);
        assert_eq!(bench.at(), stood, "{what}: the position is not kept");
        assert_eq!(first_excess_with(&bench.rows, &params, 2.0), None, "{what}");
        bench.next(&what);
    }
}

#[test]
fn commands_one_after_another_in_any_order() {
    let orders: [&[Command]; 10] = [
        &[Command::Hold, Command::Reset],
        &[Command::Hold, Command::Stop],
        &[Command::Reset, Command::Reset],
        &[Command::Reset, Command::Stop],
        &[Command::Stop, Command::Reset],
        &[Command::Resume, Command::Reset],
        &[Command::Reset, Command::Hold],
        &[Command::Reset, Command::Resume],
        &[Command::Hold, Command::Resume, Command::Reset],
        &[Command::Hold, Command::Resume, Command::Stop],
    ];
    for params in [Params::slant_bed(), retracting()] {
        let calm = calm(&params);
        for (index, tick) in places(&calm, stride(7, 401)).enumerate() {
            let order = orders[index % orders.len()];
            let gap = [0, 1, 3, 17, 60, 250][index / orders.len() % 6];
            let what = format!("{order:?} from {tick} on, {gap} ticks apart");
            let mut bench = Bench::new(&params);
            bench.load(WORK);
            bench.until(&what, tick, |bench| bench.ticks == tick);
            let stopped = order.contains(&Command::Stop);
            for command in order {
                if *command == Command::Reset {
                    bench.waiting.clear();
                    bench.alarm = None;
                }
                bench.sim.command(*command);
                for _ in 0..gap {
                    bench.tick();
                }
            }
            bench.waiting.clear();
            bench.tick();
            bench.until(&what, PATIENCE, |bench| {
                matches!(bench.state(), State::Idle | State::Alarm(_))
            });
            if order.last() == Some(&Command::Stop) {
                assert!(matches!(bench.state(), State::Alarm(_)), "{what}");
            }
            if stopped && matches!(bench.state(), State::Alarm(_)) {
                let at = bench.at();
                bench.stands(&what);
                assert_eq!(bench.at(), at);
                bench.reset(&what);
            }
            bench.stands(&what);
            assert_eq!(first_excess_with(&bench.rows, &params, 2.0), None, "{what}");
            bench.sim.command(Command::Resume);
            bench.tick();
            bench.stands(&what);
            bench.next(&what);
        }
    }
}

#[test]
fn a_stop_while_a_reset_retracts_leaves_the_tool_where_it_stops() {
    let params = Params::slant_bed();
    let calm = calm(&params);
    let strokes: Vec<u64> = calm
        .iter()
        .filter(|row| row.error.is_some())
        .map(|row| row.tick)
        .collect();
    for tick in strokes.iter().step_by(stride(3, 31)).copied() {
        for later in [1, 5, 20, 60, 120] {
            let what = format!("reset at {tick}, stop {later} later");
            let mut bench = Bench::new(&params);
            bench.load(WORK);
            bench.until(&what, tick, |bench| bench.ticks == tick);
            bench.waiting.clear();
            bench.sim.command(Command::Reset);
            for _ in 0..later {
                bench.tick();
            }
            bench.sim.command(Command::Stop);
            bench.tick();
            // A stop takes 0.2 s at most here; whoever moves then sets out anew.
            let mut still = 0;
            let mut at = bench.at();
            while still < 2 {
                bench.tick();
                still = if bench.at() == at { still + 1 } else { 0 };
                at = bench.at();
            }
            for _ in 0..500 {
                bench.tick();
                assert_eq!(bench.at(), at, "{what}: sets out again");
            }
        }
    }
}

/// All that a drive can do wrong, at every place; then it is mended, and the next program runs.
#[test]
fn a_failing_drive_anywhere_and_the_next_program() {
    let params = Params::slant_bed();
    let calm = calm(&params);
    let troubles = [
        Trouble::Silent,
        Trouble::Stuck,
        Trouble::Fault(0x3210),
        Trouble::TorqueOff,
    ];
    for (turn, tick) in places(&calm, stride(5, 293)).enumerate() {
        let trouble = troubles[turn % 4];
        let which = turn / 4 % 4;
        // A spindle has no position to be away from; a standing axis does not miss one.
        if trouble == Trouble::Stuck {
            continue;
        }
        let what = format!("{trouble:?} of drive {which} at {tick}");
        let mut bench = Bench::new(&params);
        bench.load(WORK);
        bench.until(&what, tick, |bench| bench.ticks == tick);
        let drive = |bench: &mut Bench, trouble| {
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
        bench.until(&what, PATIENCE, |bench| {
            matches!(bench.state(), State::Alarm(_))
        });
        bench.stands(&what);
        // Not mended: the reset ends in an alarm again, and still nothing moves.
        bench.alarm = None;
        bench.sim.command(Command::Reset);
        bench.tick();
        bench.until(&what, 5_000, |bench| bench.alarm.is_some());
        bench.until(&what, 5_000, |bench| {
            matches!(bench.state(), State::Alarm(_))
        });
        bench.stands(&what);
        drive(&mut bench, Trouble::None);
        for _ in 0..10 {
            bench.tick();
        }
        bench.reset(&what);
        bench.stands(&what);
        bench.next(&what);
    }
}

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
    let params = Params::slant_bed();
    let calm = calm(&params);
    for nth in (0..600).step_by(stride(37, 199)) {
        let tick = locked(&calm, nth);
        let what = format!("spindle at {percent} % from {tick} on");
        let mut bench = Bench::new(&params);
        bench.load(WORK);
        bench.until(&what, tick, |bench| bench.ticks == tick);
        bench.sim.plant().spindle().disturb(percent);
        bench.until(&what, within, |bench| bench.alarm.is_some());
        assert_eq!(
            bench.alarm.map(|alarm| alarm.number()),
            Some(alarm),
            "{what}"
        );
        bench.until(&what, PATIENCE, |bench| {
            matches!(bench.state(), State::Alarm(_))
        });
        brakes_at_once(&bench.rows, &params, &what);
        bench.stands(&what);
        bench.sim.plant().spindle().disturb(100);
        bench.reset(&what);
        bench.stands(&what);
        bench.next(&what);
    }
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
    let params = Params::slant_bed();
    let calm = calm(&params);
    for tick in places(&calm, stride(11, 293)) {
        let what = format!("slip at {tick}");
        let mut bench = Bench::new(&params);
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
    let params = Params::slant_bed();
    let mut bench = Bench::new(&params);
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
    bench.until("stop", 50, |bench| matches!(bench.state(), State::Alarm(_)));
    bench.sim.plant().encoder().break_index(false);
    bench.reset("no index");
    bench.next("no index");
    // And lost later on, the counts still right: the next stroke does not begin.
    bench.sim.plant().encoder().break_index(true);
    bench.load(NEXT);
    bench.finish("lost");
    assert_eq!(bench.alarm.map(|alarm| alarm.number()), Some(4260));
}

#[test]
fn a_tapered_thread_is_left_outwards() {
    let params = Params::slant_bed();
    let text = "M3 S600\nG0 X90 Z8\nG76 P010060 Q800 R0.1\nG76 X60 Z-12 R-8 P8000 Q7000 F1\nG0 X100 Z8\nM30\n";
    let mut calm = Bench::new(&params);
    calm.runs("calm", text, 50_000_000, 8_000_000);
    let strokes: Vec<Row> = calm
        .rows
        .iter()
        .filter(|row| row.error.is_some())
        .copied()
        .collect();
    for row in strokes.iter().step_by(stride(7, 97)) {
        let what = format!("reset at {}", row.tick);
        let mut bench = Bench::new(&params);
        bench.load(text);
        bench.until(&what, row.tick, |bench| bench.ticks == row.tick);
        bench.waiting.clear();
        bench.sim.command(Command::Reset);
        let mut x = bench.at().x.nm();
        bench.tick();
        while bench.state() != State::Idle {
            bench.tick();
            // The line itself rises: it never goes down.
            assert!(bench.at().x.nm() >= x, "{what}: into the work");
            x = bench.at().x.nm();
        }
        assert!(x >= 30_800_000, "{what}: X stays at {x}");
        assert_eq!(first_excess(&bench.rows, &params), None, "{what}");
    }
}

#[test]
fn the_spindle_override_is_frozen_in_a_thread() {
    let params = Params::slant_bed();
    let text = WORK.replace("Q7000", "Q2000");
    let mut calm = Bench::new(&params);
    calm.runs("calm", &text, 35_000_000, 8_000_000);
    for tick in places(&calm.rows, stride(41, 401)) {
        for percent in [50, 80, 120] {
            let what = format!("{percent} % at {tick}");
            let mut bench = Bench::new(&params);
            bench.load(&text);
            bench.until(&what, tick, |bench| bench.ticks == tick);
            bench.sim.command(Command::SpindleOverride(percent));
            bench.finish(&what);
            assert_eq!(bench.alarm, None, "{what}");
            assert_eq!(first_excess(&bench.rows, &params), None, "{what}");
        }
    }
}

/// Nobody is in a hurry to hand over: the machine waits, never in the thread, and does the same.
#[test]
fn calls_that_come_slowly_change_nothing_but_the_time() {
    let params = Params::slant_bed();
    let swift = calm(&params);
    let mut bench = Bench::new(&params);
    for call in calls(WORK, &params) {
        for _ in 0..700 {
            bench.tick();
        }
        while !bench.sim.offer(&call) {
            bench.tick();
        }
    }
    bench.finish("slow");
    assert_eq!(bench.alarm, None);
    assert_eq!(first_excess(&bench.rows, &params), None);
    let ends = |rows: &[Row]| {
        let mut ends: Vec<(u32, Position)> = Vec::new();
        for row in rows.iter().filter(|row| row.number != 0) {
            match ends.last_mut() {
                Some(last) if last.0 == row.number => last.1 = row.position,
                _ => ends.push((row.number, row.position)),
            }
        }
        ends
    };
    assert_eq!(ends(&swift), ends(&bench.rows));
    let starved: Vec<&Row> = bench
        .rows
        .iter()
        .filter(|row| row.number == 0 && row.doing != Doing::Idle)
        .collect();
    assert!(starved.len() > 100, "{}", starved.len());
    for row in starved {
        assert_eq!(row.doing, Doing::Wait, "at {}", row.tick);
        assert!(row.position.x.nm() == 0 || row.position.x.nm() > 30_000_000);
    }
}

/// Calls that come while the machine is stopping, stands on an alarm, or comes up again are not taken, so that nothing of
/// them is carried out when the alarm is cleared.
#[test]
fn calls_for_a_machine_on_alarm_are_not_taken() {
    let params = Params::slant_bed();
    let mut bench = Bench::new(&params);
    bench.load(WORK);
    for _ in 0..100 {
        bench.tick();
    }
    bench.sim.command(Command::Stop);
    bench.tick();
    let offered = calls("G0 X90 Z3\nG0 X91\nM3 S500\nM30\n", &params);
    bench.until("stop", 500, |bench| {
        matches!(bench.state(), State::Alarm(_))
    });
    for call in &offered {
        assert!(!bench.sim.offer(call), "a call on alarm is taken");
        bench.tick();
    }
    bench.stands("alarm");
    bench.reset("alarm");
    bench.stands("reset");
    bench.next("reset");
}

/// A cycle of hundreds of moves is given up within as many ticks as it takes to stop.
#[test]
fn a_reset_does_not_wait_for_the_rest_of_the_cycle() {
    let params = Params::slant_bed();
    let mut bench = Bench::new(&params);
    bench.load("M3 S600\nG0 X61 Z-3\nG98 G75 R0.2\nG75 X20 Z-30 P2000 Q10000 F600\nM30\n");
    for _ in 0..3_000 {
        bench.tick();
    }
    bench.waiting.clear();
    bench.sim.command(Command::Reset);
    bench.tick();
    bench.until("reset", 250, |bench| bench.state() == State::Idle);
    bench.stands("reset");
}

/// A hold that is there before the program: the machine says that it is held.
#[test]
fn a_program_under_hold_waits_and_says_so() {
    let params = Params::slant_bed();
    let mut bench = Bench::new(&params);
    bench.sim.command(Command::Hold);
    bench.load(NEXT);
    bench.until("hold", 10, |bench| bench.state() == State::Held);
    bench.stands("hold");
    assert_eq!(
        bench
            .events
            .iter()
            .filter(|event| **event == Event::Held)
            .count(),
        1
    );
    // A hold that comes with a resume is a hold.
    bench.sim.command(Command::Resume);
    bench.sim.command(Command::Hold);
    bench.stands("hold again");
    bench.sim.command(Command::Resume);
    bench.finish("resumed");
    assert_eq!(
        (bench.at().x.nm(), bench.at().z.nm()),
        (40_000_000, 10_000_000)
    );
}
