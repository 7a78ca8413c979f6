//! A tap that is stopped in its hole, at any tick and by anything, and the way out of it (G30 P99).

use leadscrew_board_sim::plant::{Flash, PlantOptions, Truth};
use leadscrew_board_sim::{Row, Sim};
use leadscrew_core::alarm::{Alarm, Code};
use leadscrew_core::board::{Command, Event, State};
use leadscrew_core::call::{Call, Hand, Position};
use leadscrew_core::journal::TapHole;
use leadscrew_core::params::Params;
use leadscrew_core::units::{Length, Turns};
use leadscrew_tests::machine::{calls, machine};
use leadscrew_tests::params::with;

/// Ticks a machine may take for what is asked of it here.
const LONGEST: usize = 20_000;

/// What a machine did: every row, and what it said.
#[derive(Debug, Default)]
pub struct Told {
    pub rows: Vec<Row>,
    pub events: Vec<Event>,
}

impl Told {
    pub fn alarm(&self) -> Option<Alarm> {
        self.events.iter().find_map(|event| match event {
            Event::Alarm(alarm) => Some(*alarm),
            _ => None,
        })
    }
}

/// Feeds calls until `end` or until nothing is left to do.
pub fn go(sim: &mut Sim, calls: &[Call], told: &mut Told, mut operate: impl FnMut(&mut Sim, u64)) {
    let mut waiting = calls.iter().peekable();
    let mut ticks = 0;
    while waiting.peek().is_some() || sim.is_busy() {
        while waiting.peek().is_some_and(|call| sim.offer(call)) {
            waiting.next();
        }
        operate(sim, ticks);
        told.rows.extend(sim.step());
        ticks += 1;
        assert!(ticks < LONGEST as u64, "it does not come to an end");
        while let Some(event) = sim.event() {
            if matches!(event, Event::Reset | Event::Alarm(_)) {
                waiting = [].iter().peekable();
            }
            told.events.push(event);
        }
        if !sim.has_power() {
            break;
        }
    }
}

/// Reset out of an alarm, if there is one, and until the drives are up.
pub fn ready(sim: &mut Sim, told: &mut Told) {
    if matches!(sim.board().ticker().state(), State::Alarm(_)) {
        sim.command(Command::Reset);
        for _ in 0..200 {
            told.rows.extend(sim.step());
        }
        while let Some(event) = sim.event() {
            told.events.push(event);
        }
    }
    assert_eq!(sim.board().ticker().state(), State::Idle);
}

pub fn position(sim: &Sim) -> Position {
    sim.board().ticker().executor().position()
}

/// A program with one hole, stopped at `tick`, and what the journal then says of the hole, if the tap is in it.
pub fn stopped(
    text: &str,
    params: &Params,
    stop: impl Fn(&mut Sim),
    tick: u64,
) -> (Sim, Told, Option<TapHole>) {
    let mut sim = machine(params, &PlantOptions::default());
    let mut told = Told::default();
    go(&mut sim, &calls(text, params), &mut told, |sim, ticks| {
        if ticks == tick {
            stop(sim);
        }
    });
    let hole = sim
        .board()
        .tap_record()
        .filter(|record| record.in_hole)
        .map(|record| record.hole);
    (sim, told, hole)
}

/// The line of a hole through a setpoint: `θ = θ₀ ± depth / lead`; how far `row` is off it, in nanometres of the axis.
fn off_line(row: &Row, hole: &TapHole, from: (Length, Turns)) -> i64 {
    let sign = match hole.hand {
        Hand::Right => 1,
        Hand::Left => -1,
    };
    let angle = row.spindle_set.expect("position mode");
    let turned = i128::from((angle - from.1).raw()) * sign;
    let way = hole.depth(hole.axis.of(row.position)) - hole.depth(from.0);
    let lead = hole.lead;
    let by_spindle = (turned * i128::from(lead.numerator()) / i128::from(lead.denominator())) >> 32;
    (i128::from(way.nm()) - by_spindle) as i64
}

/// G30 P99 from where the tap stands: it ends at R and 5382 beyond, on the line all the way, and never goes deeper.
pub fn returns(sim: &mut Sim, params: &Params, hole: &TapHole) {
    let start = position(sim);
    let begins = hole.depth(hole.axis.of(start));
    let mut told = Told::default();
    let written = sim.flash().written();
    go(sim, &calls("G30 P99\nM30\n", params), &mut told, |_, _| {});
    assert_eq!(told.alarm(), None);
    // The spindle stands once its counter has not moved for 59 ticks; then it leaves position mode.
    for _ in 0..80 {
        told.rows.extend(sim.step());
    }
    sim.last_rows(|row| told.rows.push(row));
    let locked: Vec<&Row> = told.rows.iter().filter(|row| row.error.is_some()).collect();
    let beyond = params.tap_return_extra();
    let end = hole.level - beyond.times(hole.inward());
    assert_eq!(hole.axis.of(position(sim)), end, "R and 5382 beyond");
    let others = |position: Position| hole.axis.with(position, Length::ZERO);
    assert_eq!(others(position(sim)), others(start), "the other axes");
    assert_eq!(sim.board().tap_record().map(|tap| tap.in_hole), Some(false));
    if locked.is_empty() {
        assert_eq!(begins, hole.depth(end), "nothing had to be done");
        return;
    }
    // The spindle stood here before it began.
    let first = locked[0];
    let before = told
        .rows
        .iter()
        .rev()
        .find(|row| row.tick < first.tick && row.spindle_set.is_some())
        .expect("it stands first");
    assert_eq!(hole.axis.of(before.position), hole.axis.of(start));
    let from = (
        hole.axis.of(before.position),
        before.spindle_set.expect("position mode"),
    );
    let mut depth = begins;
    for row in &locked {
        assert!(off_line(row, hole, from).abs() <= 1, "{row:?}");
        // The true spindle is where it is told to be, within an increment of the drive.
        assert!(row.error.expect("locked").nm().abs() <= 100, "{row:?}");
        let now = hole.depth(hole.axis.of(row.position));
        assert!(now <= depth, "it goes inwards at {row:?}");
        depth = now;
    }
    assert_eq!(depth, hole.depth(end));
    // The journal was cleared, and it stands in speed mode again.
    assert!(sim.flash().written() > written);
    let last = told.rows.last().expect("rows");
    assert_eq!(last.spindle_set, None);
    assert_eq!(last.position, position(sim));
}

/// Every tick of a program: stop, return. How many of the stops left the tap in its hole.
fn sweep(text: &str, params: &Params, stride: usize, stop: impl Fn(&mut Sim)) -> u32 {
    let (_, calm, _) = stopped(text, params, |_| {}, u64::MAX);
    assert_eq!(calm.alarm(), None);
    let locked = calm.rows.iter().filter(|row| row.error.is_some());
    let bottom = locked.map(|row| row.tick).max().expect("a tap");
    let mut in_hole = 0;
    for tick in (0..bottom + 30).step_by(stride) {
        let (mut sim, mut told, hole) = stopped(text, params, &stop, tick);
        ready(&mut sim, &mut told);
        let Some(hole) = hole else {
            continue;
        };
        in_hole += 1;
        let deepest = told
            .rows
            .iter()
            .filter(|row| row.error.is_some())
            .map(|row| hole.depth(hole.axis.of(row.position)))
            .max();
        assert!(deepest <= Some(hole.depth(hole.bottom)), "stop at {tick}");
        returns(&mut sim, params, &hole);
    }
    in_hole
}

/// 4 mm at lead 2 in pecks of 1.5 mm.
pub const HIGH_SPEED: &str =
    "G98 G0 X50 Z5\nM29 S1000\nG84 Z-4 R-5 Q1.5 D0.4 P20 F2000\nG80\nM30\n";

fn stride() -> usize {
    leadscrew_seed::amount(23, 1)
}

#[test]
fn a_reset_at_any_tick_of_a_peck_tap_then_the_return() {
    let params = with(&[("5382", 2_000_000)]);
    let in_hole = sweep(HIGH_SPEED, &params, stride(), |sim| {
        sim.command(Command::Reset);
    });
    assert!(in_hole as usize * stride() > 1_000, "{in_hole}");
}

#[test]
fn an_emergency_stop_at_any_tick_of_a_peck_tap_then_the_return() {
    let params = with(&[("5382", 2_000_000)]);
    let in_hole = sweep(HIGH_SPEED, &params, stride(), |sim| {
        sim.command(Command::Stop);
    });
    assert!(in_hole as usize * stride() > 1_000, "{in_hole}");
}

/// The power goes at a tick. The machine that comes up again has lost its references: its drives say 0, its spindle stands
/// at another angle.
#[test]
fn a_loss_of_power_at_any_tick_then_the_return() {
    let params = with(&[("5382", 2_000_000)]);
    let (_, calm, _) = stopped(HIGH_SPEED, &params, |_| {}, u64::MAX);
    let locked = || calm.rows.iter().filter(|row| row.error.is_some());
    let first = locked().map(|row| row.tick).min().expect("a tap");
    let last = locked().map(|row| row.tick).max().expect("a tap");
    let mut in_hole = 0;
    let mut through = 0;
    for tick in (0..last + 30).step_by(stride()) {
        let (dead, _, _) = stopped(HIGH_SPEED, &params, Sim::cut_power, tick);
        let options = PlantOptions {
            angle: Turns::from_raw(0x4000_1234),
            ..PlantOptions::default()
        };
        let image = dead.flash().image();
        let flash = Flash::from_image(&image).expect("an image");
        let mut sim = Sim::with_flash(&params, &options, flash).expect("it starts");
        let record = sim.board().tap_record().filter(|record| record.in_hole);
        let Some(hole) = record.map(|record| record.hole) else {
            assert!(!(first + 2..last).contains(&tick), "cut at {tick}");
            continue;
        };
        assert!(tick + 3 > first && tick <= last + 2, "cut at {tick}");
        in_hole += 1;
        // Wherever it really is: the bottom is taken for it, and the message says so.
        assert_eq!(hole.axis.of(position(&sim)), hole.bottom);
        let said = sim.event();
        let warning =
            matches!(said, Some(Event::Warning(alarm)) if alarm.code == Code::TapInHoleSincePower);
        assert!(warning, "{said:?}");
        let before = sim.plant().truth();
        returns(&mut sim, &params, &hole);
        // What really happened: out by the whole depth and 5382, in turns of the spindle and in increments of the drive.
        let after = sim.plant().truth();
        let increments = |at: &Truth| i64::from(at.positions[1].get());
        assert_eq!(increments(&after) - increments(&before), 40_000 + 20_000);
        let turned = (after.angle.turns() - before.angle.turns()).raw();
        let exact = -3_i64 << 32;
        assert!((turned - exact).abs() < 1 << 20, "{turned}");
        through += 1;
    }
    assert_eq!(in_hole, through);
    assert!(in_hole as usize * stride() > 1_000, "{in_hole}");
}

/// Every form, hand and axis, with a wider stride; the emergency stop takes torque from the drives with its reset.
#[test]
fn forms_hands_and_axes_come_out_the_same_way() {
    let deep = with(&[("5200.5", 1), ("5382", 1_500_000)]);
    let plain = with(&[("5382", 1_500_000)]);
    let wide = leadscrew_seed::amount(97, 5);
    for (text, params) in [
        // Deep pecks, left hand, both ways along Z, along X, a lead that does not end.
        (HIGH_SPEED, &deep),
        (
            "G98 G0 X50 Z5\nM29 S-1000\nG84 Z-4 R-5 Q1.5 D0.4 F2000\nG80\nM30\n",
            &plain,
        ),
        (
            "G98 G0 X50 Z-5\nM29 S1000\nG84 Z4 R5 F2000\nG80\nM30\n",
            &plain,
        ),
        (
            "G98 G0 X60 Z-10\nM29 S1000\nG88 X42 R-5 Q1.5 D0.4 F2000\nG80\nM30\n",
            &plain,
        ),
        (
            "G98 G0 X60 Z-10\nM29 S-700\nG88 X42 R-5 F1000\nG80\nM30\n",
            &deep,
        ),
    ] {
        for command in [Command::Reset, Command::Stop] {
            let in_hole = sweep(text, params, wide, |sim| sim.command(command));
            assert!(in_hole > 3, "{in_hole} of {text}");
        }
    }
}

/// A return that is stopped itself is begun again from where it stands.
#[test]
fn a_return_that_is_stopped_goes_on_with_the_next_one() {
    let params = with(&[("5382", 2_000_000)]);
    let wide = leadscrew_seed::amount(31, 3);
    let mut again = 0;
    for command in [Command::Reset, Command::Stop] {
        for tick in (0..600).step_by(wide) {
            let (mut sim, mut told, hole) = stopped(
                HIGH_SPEED,
                &params,
                |sim| sim.command(Command::Reset),
                1_100,
            );
            let hole = hole.expect("in the hole");
            ready(&mut sim, &mut told);
            let back = calls("G30 P99\nM30\n", &params);
            go(&mut sim, &back, &mut told, |sim, ticks| {
                if ticks == tick {
                    sim.command(command);
                }
            });
            ready(&mut sim, &mut told);
            if sim
                .board()
                .tap_record()
                .is_some_and(|record| record.in_hole)
            {
                again += 1;
                returns(&mut sim, &params, &hole);
            }
        }
    }
    assert!(again as usize * wide > 300, "{again}");
}

/// K198 leaves the tap at the bottom: G30 P99 in the same program brings it out, and the program goes on; so it does after
/// a reset.
#[test]
fn out_of_a_hole_left_by_k198() {
    const LOCKED: &str = "G98 G0 X50 Z5\nM29 S1000\nG84 Z-4 R-5 F2000 K198\n";
    let params = with(&[("5382", 3_000_000)]);
    let mut sim = machine(&params, &PlantOptions::default());
    let mut told = Told::default();
    let text = format!("{LOCKED}G30 P99 S400\nG0 X60 Z20\nM3 S100\nM30\n");
    go(&mut sim, &calls(&text, &params), &mut told, |_, _| {});
    assert_eq!(told.alarm(), None);
    let end = Position {
        x: Length::from_nm(30_000_000),
        z: Length::from_nm(20_000_000),
        ..Position::ZERO
    };
    assert_eq!(position(&sim), end);
    let mut depths = told.rows.iter().filter(|row| row.error.is_some());
    let deepest = depths.clone().map(|row| row.position.z).min();
    assert_eq!(deepest, Some(Length::from_nm(-4_000_000)));
    let last = depths.next_back().expect("a tap");
    assert_eq!(last.position.z, Length::from_nm(3_000_000), "R and 3 mm");

    let text = format!("{LOCKED}G4 P500\nG84 Z-6 F2000\nG80\nM30\n");
    let (mut sim, _, hole) = stopped(&text, &params, |sim| sim.command(Command::Reset), 1_300);
    let hole = hole.expect("in the hole");
    assert_eq!(position(&sim).z, hole.bottom);
    returns(&mut sim, &params, &hole);
}

/// S, the extraction override and 5241 decide how fast it comes out.
#[test]
fn speed_of_the_way_out() {
    let fastest = |settings: &[(&str, i64)], s: &str| {
        let params = with(settings);
        let text = "G98 G0 X50 Z5\nM29 S1000\nG84 Z-20 R-5 F1000\nG80\nM30\n";
        let (mut sim, _, hole) = stopped(text, &params, |sim| sim.command(Command::Reset), 1_900);
        assert!(hole.is_some());
        let mut told = Told::default();
        go(
            &mut sim,
            &calls(&format!("G30 P99{s}\nM30\n"), &params),
            &mut told,
            |_, _| {},
        );
        assert_eq!(told.alarm(), None);
        let steps = told.rows.windows(2).map(|pair| {
            let turned = |row: &Row| row.spindle_set.unwrap_or_default().raw();
            let both = pair.iter().all(|row| row.error.is_some());
            if both {
                (turned(&pair[1]) - turned(&pair[0])).abs()
            } else {
                0
            }
        });
        // In turns a minute.
        (steps.max().expect("rows") * 60_000 + (1 << 31)) >> 32
    };
    assert_eq!(fastest(&[], ""), 1000);
    assert_eq!(fastest(&[], " S500"), 500);
    let by_half = [("5200.4", 1), ("5211", 150)];
    assert_eq!(fastest(&by_half, ""), 1500);
    assert_eq!(fastest(&by_half, " S400"), 600);
    assert_eq!(
        fastest(&[("5200.4", 1), ("5211", 150), ("5241", 1200)], ""),
        1200
    );
}
