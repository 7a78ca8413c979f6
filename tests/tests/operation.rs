//! What an operator, a spindle and a drive may do to a running machine: a thread is finished before it is held, nothing
//! catches up later, and no limit is exceeded.

use leadscrew_board_sim::plant::{PlantOptions, Ripple};
use leadscrew_board_sim::{Doing, Row};
use leadscrew_core::board::{Command, Event, State};
use leadscrew_core::call::Position;
use leadscrew_core::params::Params;
use leadscrew_core::units::{Axis, Length};
use leadscrew_tests::limits::{first_excess, first_excess_with};
use leadscrew_tests::machine::{Ran, run};
use leadscrew_tests::params::with;

/// One coarse thread, three passes, with a run-out.
const THREAD: &str = "M3 S300\nG4 P500\nG0 X80 Z10\nG76 P010560 Q1500 R0.1\nG76 X76 Z-30 P2000 Q1500 F3\nG0 X100 Z50\nM30\n";

fn plain(text: &str) -> Ran {
    run(text, &Params::sheets(), &PlantOptions::default(), |_, _| {})
}

fn ends_at(ran: &Ran, x: i64, z: i64) {
    let last = ran.rows.last().expect("there are rows");
    assert_eq!((last.position.x.nm(), last.position.z.nm()), (x, z));
    assert_eq!(ran.alarm, None);
}

fn within(ran: &Ran, params: &Params) {
    assert_eq!(first_excess(&ran.rows, params), None);
}

fn worst(rows: &[Row]) -> i64 {
    rows.iter()
        .filter_map(|row| row.error)
        .map(|error| error.nm().abs())
        .max()
        .expect("something was locked")
}

#[test]
fn a_thread_obeys_every_limit_where_the_spindle_does_not_lead() {
    let ran = plain(THREAD);
    ends_at(&ran, 50_000_000, 50_000_000);
    within(&ran, &Params::sheets());
}

#[test]
fn ripple_of_ten_percent_stays_within_the_figures() {
    let params = Params::sheets();
    let options = PlantOptions {
        ripple: Ripple::new(10_000, 5_000),
        ..PlantOptions::default()
    };
    let ran = run(
        &THREAD.replace("F3", "F6").replace("Z-30", "Z-60"),
        &params,
        &options,
        |_, _| {},
    );
    ends_at(&ran, 50_000_000, 50_000_000);
    within(&ran, &params);
    assert!(worst(&ran.rows) <= 1_300, "{} nm", worst(&ran.rows));
}

/// Where the tool is on the helix at whole turns of the spindle, for the locked rows of a move: the groove.
fn groove(ran: &Ran, number: u32, lead_nm: f64) -> f64 {
    let phases: Vec<f64> = ran
        .rows
        .iter()
        .filter(|row| row.number == number && row.error.is_some())
        .map(|row| {
            let turns = row.spindle.raw() as f64 / 2f64.powi(64);
            (row.position.z.nm() as f64 + turns * lead_nm).rem_euclid(lead_nm)
        })
        .collect();
    assert!(phases.len() > 50, "{} rows of move {number}", phases.len());
    phases.iter().sum::<f64>() / phases.len() as f64
}

#[test]
fn passes_fall_into_one_groove_at_any_speed() {
    let slow = plain(&THREAD.replace("S300", "S100"));
    let fast = plain(THREAD);
    let lead = 3e6;
    // Finishing passes of both: the last stroke's move number is the same.
    let stroke = fast
        .rows
        .iter()
        .filter(|row| row.error.is_some())
        .map(|row| row.number)
        .max()
        .expect("locked rows");
    let difference = groove(&slow, stroke, lead) - groove(&fast, stroke, lead);
    let wrapped = (difference + lead / 2.0).rem_euclid(lead) - lead / 2.0;
    assert!(wrapped.abs() <= 1_500.0, "{wrapped} nm");
}

/// A machine that retracts at once on feed hold.
fn retracting() -> Params {
    with(&[("9008.0", 1)])
}

#[test]
fn feed_hold_with_immediate_retract_cuts_the_same_groove_again() {
    let params = retracting();
    let calm = plain(THREAD);
    let strokes: Vec<&Row> = calm.rows.iter().filter(|row| row.error.is_some()).collect();
    for row in strokes.iter().step_by(41) {
        let (ran, rest) = held(THREAD, &params, row.tick);
        assert_eq!(rest.doing, Doing::Hold, "hold at {}", row.tick);
        // At the start of the cycle, or where the stroke was all but over: after its X retract.
        let at = (rest.position.x.nm(), rest.position.z.nm());
        assert!(
            at == (40_000_000, 10_000_000) || at == (40_000_000, -30_000_000),
            "hold at {} rests at {at:?}",
            row.tick
        );
        assert_eq!(
            first_excess(&ran.rows, &params),
            None,
            "hold at {}",
            row.tick
        );
        ends_at(&ran, 50_000_000, 50_000_000);
        assert!(worst(&ran.rows) <= 1_000, "hold at {}", row.tick);
    }
}

/// Runs `text` with a hold at `tick`, resumed 400 ticks after the machine says it is held.
fn held(text: &str, params: &Params, tick: u64) -> (Ran, Row) {
    let mut rest = None;
    let mut resume_at = None;
    let ran = run(text, params, &PlantOptions::default(), |sim, ticks| {
        if ticks == tick {
            sim.command(Command::Hold);
        }
        if resume_at == Some(ticks) {
            sim.command(Command::Resume);
        }
        if ticks > tick && resume_at.is_none() && sim.board().ticker().state() == State::Held {
            resume_at = Some(ticks + 400);
            rest = Some(ticks + 200);
        }
    });
    let rest = rest.expect("the machine was held");
    let row = *ran.rows.iter().find(|row| row.tick == rest).expect("a row");
    (ran, row)
}

#[test]
fn feed_hold_in_a_stroke_waits_for_the_x_retract() {
    let params = Params::sheets();
    let calm = plain(THREAD);
    let middle = calm
        .rows
        .iter()
        .filter(|row| row.error.is_some())
        .nth(200)
        .expect("a locked row")
        .tick;
    let (ran, rest) = held(THREAD, &params, middle);
    // At rest at the start level on X, in D's plane on Z.
    assert_eq!(rest.doing, Doing::Hold);
    assert_eq!(rest.position.x.nm(), 40_000_000);
    assert_eq!(rest.position.z.nm(), -30_000_000);
    ends_at(&ran, 50_000_000, 50_000_000);
    within(&ran, &params);
    assert!(worst(&ran.rows) <= 1_000);
}

#[test]
fn feed_hold_anywhere_stops_within_the_limits_and_loses_nothing() {
    let params = Params::sheets();
    let calm = plain(THREAD);
    let last = calm.rows.last().expect("rows").position;
    for tick in (5..calm.rows.len() as u64 - 10).step_by(97) {
        let (ran, rest) = held(THREAD, &params, tick);
        assert_eq!(rest.doing, Doing::Hold, "hold at {tick}");
        assert_eq!(
            ran.rows.last().expect("rows").position,
            last,
            "hold at {tick}"
        );
        assert_eq!(first_excess(&ran.rows, &params), None, "hold at {tick}");
    }
}

#[test]
fn overrides_change_the_speed_and_nothing_else() {
    let params = Params::sheets();
    let text = "G98 G1 X20 Z-40 F500\nG0 X0 Z0\nM30\n";
    let full = plain(text);
    let mut feeds = [50_u8, 150, 0, 10, 120, 100].into_iter().cycle();
    let mut rapids = [25_u8, 100, 0, 50].into_iter().cycle();
    let ran = run(text, &params, &PlantOptions::default(), |sim, ticks| {
        if ticks % 61 == 7 {
            sim.command(Command::FeedOverride(feeds.next().expect("endless")));
        }
        if ticks % 43 == 3 {
            sim.command(Command::RapidOverride(rapids.next().expect("endless")));
        }
    });
    ends_at(&ran, 0, 0);
    within(&ran, &params);
    assert_ne!(ran.rows.len(), full.rows.len());
}

/// A reset at every so many ticks: the tool is out of the thread, nothing moves afterwards, and the next program starts
/// from where the machine stands.
#[test]
fn reset_anywhere_leaves_nothing_latent() {
    let params = Params::sheets();
    let calm = plain(THREAD);
    // Height of the thread 0.2 mm, and the clearance of parameter 9009.
    let clear = 76_000_000 / 2 + 200_000 + params.thread_clearance().nm();
    for tick in (5..calm.rows.len() as u64 - 10).step_by(101) {
        let ran = run(THREAD, &params, &PlantOptions::default(), |sim, ticks| {
            if ticks == tick {
                sim.command(Command::Reset);
            }
        });
        assert_eq!(ran.alarm, None, "reset at {tick}: {:?}", ran.events);
        assert_eq!(first_excess(&ran.rows, &params), None, "reset at {tick}");
        let row = &calm.rows[tick as usize];
        let last = ran.rows.last().expect("rows");
        assert_eq!(last.doing, Doing::Idle, "reset at {tick}");
        if row.error.is_some() {
            assert!(
                last.position.x.nm() >= clear,
                "reset at {tick} leaves X at {}",
                last.position.x.nm()
            );
            assert!(last.position.z.nm() >= -30_000_000, "reset at {tick}");
        }
    }
}

/// An emergency stop brings both axes to rest together, on the path, and the alarm stays until reset.
#[test]
fn an_emergency_stop_in_a_stroke_stops_both_axes_on_the_path() {
    let params = Params::sheets();
    let calm = plain(THREAD);
    let locked: Vec<u64> = calm
        .rows
        .iter()
        .filter(|row| row.error.is_some())
        .map(|row| row.tick)
        .collect();
    for tick in locked.iter().copied().step_by(53) {
        let ran = run(THREAD, &params, &PlantOptions::default(), |sim, ticks| {
            if ticks == tick {
                sim.command(Command::Stop);
            }
        });
        assert_eq!(ran.alarm.expect("an alarm").number(), 4300);
        // Inside the rounded corner of a run-out the stop's jerk and the corner's may add [D53].
        let excess = first_excess_with(&ran.rows, &params, 2.0);
        assert_eq!(excess, None, "stop at {tick}");
        let last = ran.rows.last().expect("rows");
        assert_eq!(last.doing, Doing::Alarm);
        assert!(last.position.z.nm() >= -30_000_000);
    }
}

/// Stopped at `stop`, and `also` done `behind` ticks later.
fn stopped(text: &str, stop: u64, behind: u64, also: &[Command]) -> Ran {
    run(
        text,
        &Params::sheets(),
        &PlantOptions::default(),
        |sim, ticks| {
            if ticks == stop {
                sim.command(Command::Stop);
            }
            if ticks == stop + behind {
                for &command in also {
                    sim.command(command);
                }
            }
        },
    )
}

/// A reset that comes while the machine is still on its way to rest waits until it stands, whenever it comes, and is not
/// lost [D110]. The way to rest is the same as without it.
#[test]
fn a_reset_during_a_stop_acts_when_the_machine_stands() {
    let params = Params::sheets();
    let tap = "G98 G0 X0 Z5\nM29 S500\nG84 Z-12 R3 P200 F500\nG80\nM30\n";
    for (text, inside) in [
        (THREAD, Doing::Run),
        (THREAD, Doing::Wait),
        ("G98 G1 X200 Z-100 F8000\nM30\n", Doing::Run),
        (tap, Doing::Run),
    ] {
        let calm = plain(text);
        let rows: Vec<&Row> = calm.rows.iter().filter(|row| row.doing == inside).collect();
        let stop = rows[rows.len() / 2].tick;
        let alone = stopped(text, stop, 0, &[]);
        let stands = alone
            .rows
            .iter()
            .rposition(|row| row.position != alone.rows[alone.rows.len() - 1].position);
        let ticks = stands.map_or(0, |row| alone.rows[row].tick.saturating_sub(stop)) + 3;
        // A wait for the spindle stands already.
        assert!(ticks > 10 || inside == Doing::Wait, "{text}: {ticks}");
        for behind in 0..ticks {
            let ran = stopped(text, stop, behind, &[Command::Reset]);
            let told = format!("{text}stop at {stop}, reset {behind} later");
            assert_eq!(ran.alarm.expect(&told).number(), 4300);
            assert_eq!(ran.events.last(), Some(&Event::Ready), "{told}");
            let last = ran.rows.last().expect("rows");
            assert_eq!(last.doing, Doing::Idle, "{told}");
            let way = |ran: &Ran| {
                let mut way: Vec<Position> = ran.rows.iter().map(|row| row.position).collect();
                way.dedup();
                way
            };
            assert_eq!(way(&ran), way(&alone), "{told}");
            assert_eq!(first_excess_with(&ran.rows, &params, 2.0), None, "{told}");
        }
    }
}

/// If orders contradict each other, the last order counts: a stop makes an earlier reset void, a hold after a reset
/// stays.
#[test]
fn a_stop_behind_a_waiting_reset_keeps_the_alarm_and_a_hold_stays() {
    let stop = 1500;
    for behind in 1..40 {
        let again = [Command::Reset, Command::Stop];
        let ran = stopped(THREAD, stop, behind, &again);
        assert_eq!(ran.rows.last().expect("rows").doing, Doing::Alarm);
        assert!(!ran.events.contains(&Event::Reset));
    }
    let mut held = false;
    let ran = run(
        THREAD,
        &Params::sheets(),
        &PlantOptions::default(),
        |sim, ticks| {
            match ticks.checked_sub(stop) {
                Some(0) => sim.command(Command::Stop),
                Some(1) => sim.command(Command::Reset),
                Some(2) => sim.command(Command::Hold),
                _ => {}
            }
            held = sim.board().ticker().operator().hold;
        },
    );
    assert_eq!(ran.rows.last().expect("rows").doing, Doing::Idle);
    assert!(held);
}

#[test]
fn single_block_stops_after_every_pass_of_a_thread() {
    let params = Params::sheets();
    let ran = run(THREAD, &params, &PlantOptions::default(), |sim, ticks| {
        if ticks == 0 {
            sim.command(Command::SingleBlock(true));
        }
        if ticks % 50 == 0 && sim.board().ticker().state() == State::Held {
            sim.command(Command::Resume);
        }
    });
    ends_at(&ran, 50_000_000, 50_000_000);
    // After the dwell, the rapid, the rough and the finishing pass, the rapid, M30.
    let stops = ran.events.iter().filter(|event| **event == Event::Held);
    assert_eq!(stops.count(), 6);
}

#[test]
fn a_standing_spindle_is_an_alarm_before_the_cycle_moves() {
    let ran = plain("G0 X80 Z10\nG76 P010560 Q1500 R0.1\nG76 X76 Z-30 P2000 Q1500 F3\nM30\n");
    let alarm = ran.alarm.expect("an alarm");
    assert_eq!(alarm.number(), 4250);
    assert_eq!(alarm.span.line, 3);
    let last = ran.rows.last().expect("rows").position;
    assert_eq!(
        last,
        Position {
            x: Length::from_nm(40_000_000),
            z: Length::from_nm(10_000_000),
            ..Position::default()
        }
    );
}

#[test]
fn a_drive_fault_in_a_stroke_stops_everything_and_names_the_drive() {
    use leadscrew_board_sim::plant::Trouble;
    let params = Params::sheets();
    let calm = plain(THREAD);
    let tick = calm
        .rows
        .iter()
        .filter(|row| row.error.is_some())
        .nth(300)
        .expect("a row")
        .tick;
    let ran = run(THREAD, &params, &PlantOptions::default(), |sim, ticks| {
        if ticks == tick {
            sim.plant().drive(Axis::X).trouble(Trouble::Silent);
        }
    });
    let alarm = ran.alarm.expect("an alarm");
    assert_eq!(alarm.args[0], leadscrew_core::alarm::Arg::Letter(b'X'));
    assert_eq!(first_excess(&ran.rows, &params), None);
}
