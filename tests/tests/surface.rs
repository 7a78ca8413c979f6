//! Constant surface speed on a machine: the spindle follows the tool, the feed follows the spindle, and the limits hold.

use leadscrew_board_sim::Sim;
use leadscrew_board_sim::plant::PlantOptions;
use leadscrew_core::board::{Command, State};
use leadscrew_core::call::SurfaceSpeed;
use leadscrew_core::params::Params;
use leadscrew_core::units::{Feed, Length};
use leadscrew_tests::limits::first_excess;
use leadscrew_tests::machine::{Ran, run};
use leadscrew_tests::params::with;

/// From X100 across the centre line at 150 m/min, with 2000 rpm as the limit.
const FACE: &str = "G0 X100 Z5\nG50 S2000\nG96 S150 M3\nG4 P2000\nG99 G1 X0 F0.2\nG0 X50\nG4 P3000\nG97\nG0 Z10\nM5\nG4 P3000\nM30\n";

/// What the spindle was told after a tick, and where the tool was then.
#[derive(Clone, Copy, Debug)]
struct Look {
    rpm: i32,
    x: Length,
    line: u32,
    state: State,
}

fn watched(
    text: &str,
    params: &Params,
    mut operate: impl FnMut(&mut Sim, u64),
) -> (Ran, Vec<Look>) {
    let mut looks: Vec<Look> = Vec::new();
    let ran = run(text, params, &PlantOptions::default(), |sim, tick| {
        let ticker = sim.board().ticker();
        looks.push(Look {
            rpm: ticker.spindle_command().get(),
            x: ticker.executor().position().x,
            line: 0,
            state: ticker.state(),
        });
        operate(sim, tick);
    });
    for (look, row) in looks.iter_mut().skip(1).zip(&ran.rows) {
        look.line = row.line;
    }
    (ran, looks)
}

fn law() -> SurfaceSpeed {
    SurfaceSpeed {
        speed: Feed::from_nm_per_min(150_000_000_000),
        centre: Length::ZERO,
        least: 0,
        most: 2000,
    }
}

/// The command in whole turns a minute where the tool is at `x`.
fn wanted(x: Length) -> i32 {
    (law().milli_rpm(x) as i32 + 500) / 1000
}

#[test]
fn the_spindle_follows_the_tool_and_the_feed_follows_the_spindle() {
    let params = Params::sheets();
    let (ran, looks) = watched(FACE, &params, |_, _| {});
    assert_eq!(ran.alarm, None);
    assert_eq!(first_excess(&ran.rows, &params), None);
    // At rest at X100, and on the way to the centre: no faster than the law says, and not slower than the ramp explains.
    let face: Vec<&Look> = looks.iter().filter(|look| look.line == 5).collect();
    assert_eq!(face.first().map(|look| look.rpm), Some(477));
    for look in &face {
        let wanted = wanted(look.x);
        assert!(
            (wanted - 20..=wanted).contains(&look.rpm),
            "{look:?}, wanted {wanted}"
        );
    }
    assert_eq!(face.iter().map(|look| look.rpm).max(), Some(2000));
    let steps = |looks: &[Look]| {
        looks
            .windows(2)
            .filter(|pair| pair[1].rpm != 0)
            .map(|pair| (pair[1].rpm - pair[0].rpm).abs())
            .max()
    };
    // 500 ms for 1000 rpm, a command every 4 ms, until M5.
    assert!(steps(&looks) <= Some(8), "{:?}", steps(&looks));
    // 0.2 mm a turn: where the radius is 40 and 20 mm, the tool moves 0.2 mm · 597 and 1194 rpm.
    for (radius, rpm) in [(40_000_000, 596.83), (20_000_000, 1193.66)] {
        let at = ran
            .rows
            .windows(2)
            .find(|pair| pair[1].line == 5 && pair[1].position.x.nm() <= radius)
            .map(|pair| (pair[0].position.x - pair[1].position.x).nm() as f64)
            .unwrap();
        let exact = 200_000.0 * rpm / 60_000.0;
        assert!(
            (at / exact - 1.0).abs() < 0.01,
            "{at} nm a tick, exact {exact}"
        );
    }
    // The rapid goes out with the speed of its end; G97 holds that speed.
    let rapid = looks.iter().find(|look| look.line == 6).unwrap();
    assert!(rapid.rpm < 2000);
    let out: Vec<&Look> = looks.iter().filter(|look| look.line == 9).collect();
    // M5 takes effect in the last tick of the rapid.
    let (_, out) = out.split_last().unwrap();
    assert!(out.iter().all(|look| look.rpm == 955), "{out:?}");
    assert_eq!(looks.last().map(|look| look.rpm), Some(0));
}

#[test]
fn feed_hold_holds_the_speed_and_the_override_stops_at_the_limit() {
    let params = Params::sheets();
    let mut held_at = None;
    let (ran, looks) = watched(FACE, &params, |sim, tick| {
        let x = sim.board().ticker().executor().position().x;
        let held = sim.board().ticker().state() == State::Held;
        match held_at {
            None if x > Length::ZERO && x.nm() < 30_000_000 && tick > 3000 => {
                held_at = Some(tick);
                sim.command(Command::Hold);
            }
            Some(at) if tick == at + 3000 => sim.command(Command::SpindleOverride(50)),
            Some(at) if tick == at + 6000 => sim.command(Command::SpindleOverride(120)),
            Some(at) if tick == at + 9000 && held => sim.command(Command::Resume),
            _ => {}
        }
    });
    assert_eq!(ran.alarm, None);
    assert_eq!(first_excess(&ran.rows, &params), None);
    let at = held_at.expect("held") as usize;
    let x = looks[at + 2990].x;
    assert_eq!(looks[at + 2990].state, State::Held);
    assert!((looks[at + 2990].rpm - wanted(x)).abs() <= 1);
    assert!((looks[at + 5990].rpm - wanted(x) / 2).abs() <= 1);
    assert!((looks[at + 8990].rpm - wanted(x) * 6 / 5).abs() <= 1);
    assert_eq!(looks.iter().map(|look| look.rpm).max(), Some(2000));
}

#[test]
fn an_alarm_and_a_reset_stop_the_spindle_for_good() {
    for order in [Command::Stop, Command::Reset] {
        let (_, looks) = watched(FACE, &Params::sheets(), |sim, tick| {
            if tick == 4000 {
                sim.command(order);
            }
        });
        assert!(looks[3999].rpm > 0);
        assert_eq!(looks.last().map(|look| look.rpm), Some(0), "{order:?}");
    }
}

#[test]
fn the_least_speed_holds_far_out() {
    let params = with(&[("3771", 900)]);
    let (ran, looks) = watched(FACE, &params, |_, _| {});
    assert_eq!(ran.alarm, None);
    let first = looks.iter().find(|look| look.line == 5).unwrap();
    assert_eq!(first.rpm, 900);
}
