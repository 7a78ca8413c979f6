//! A door that is opened in a cut, in a thread, in a stroke, and while axes are moved by hand.

use super::*;

/// Opens the door at `tick`, closes it 4 s later, and resumes a second after that; the row just before it is closed, and
/// the spindle's speed then.
fn door(text: &str, params: &Params, tick: u64) -> (Ran, Row, i32, State) {
    let mut speed = None;
    let ran = run(text, params, &PlantOptions::default(), |sim, now| {
        let opened = now >= tick && now < tick + 4_000;
        sim.set_pins(inputs(if opened { WELL & !(1 << 4) } else { WELL }));
        if now == tick + 4_500 {
            let ticker = sim.board().ticker();
            speed = Some((ticker.observer().speed().rpm().get(), ticker.state()));
        }
        if now == tick + 5_000 {
            sim.command(Command::Resume);
        }
    });
    assert_eq!(ran.alarm, None, "{tick}");
    let row = *ran
        .rows
        .iter()
        .find(|row| row.tick == tick + 4_500)
        .expect("a row");
    let (speed, state) = speed.expect("it was looked at");
    (ran, row, speed, state)
}

#[test]
fn a_door_opened_in_a_thread_leaves_it_at_once_and_the_same_groove_is_cut_again() {
    let params = guarded();
    let strokes = locked_ticks(THREAD, &params);
    for tick in strokes.iter().step_by(97) {
        let (ran, rest, speed, state) = door(THREAD, &params, *tick);
        assert_eq!(state, State::Held, "{tick}");
        assert_eq!(speed, 0, "{tick}");
        // At the start of the cycle, or, where the stroke was all but over, after its retract.
        let at = (rest.position.x.nm(), rest.position.z.nm());
        let both = [(40_000_000, 10_000_000), (40_000_000, -30_000_000)];
        assert!(both.contains(&at), "{tick} {at:?}");
        assert_eq!(ran.alarm, None, "{tick}");
        assert_eq!(first_excess(&ran.rows, &params), None, "{tick}");
        let last = ran.rows.last().expect("rows").position;
        assert_eq!(
            (last.x.nm(), last.z.nm()),
            (50_000_000, 50_000_000),
            "{tick}"
        );
        let worst = ran
            .rows
            .iter()
            .filter_map(|row| row.error)
            .map(|error| error.nm().abs());
        assert!(worst.max() <= Some(1_000), "{tick}");
    }
}

#[test]
fn a_door_does_not_let_a_stroke_be_finished() {
    let params = guarded();
    let strokes = locked_ticks(THREAD, &params);
    let tick = strokes[strokes.len() / 8];
    let (ran, ..) = door(THREAD, &params, tick);
    // The stroke ends at Z-30; the tool is off the work long before.
    let deep = ran
        .rows
        .iter()
        .filter(|row| row.tick > tick && row.tick < tick + 4_000);
    let cut = deep.filter(|row| row.position.x.nm() < 40_000_000);
    let ticks = cut.count();
    assert!((1..400).contains(&ticks), "{ticks}");
}

#[test]
fn a_door_opened_in_a_stroke_that_has_no_way_out_stops_on_an_alarm() {
    let params = guarded();
    let text = "M3 S300\nG4 P500\nG0 X40 Z10\nG32 Z-60 F2\nG0 X60\nM30\n";
    let strokes = locked_ticks(text, &params);
    let tick = strokes[strokes.len() / 2];
    let ran = with_inputs(text, &params, |now| {
        if now < tick { WELL } else { WELL & !(1 << 4) }
    });
    assert_eq!(alarm(&ran).0, 4506);
    assert_eq!(alarm(&ran).1[0], Arg::Interlock(Interlock::Door));
    let last = ran.rows.last().expect("rows").position;
    assert!(last.z.nm() > -59_000_000, "{last:?}");
}

#[test]
fn a_door_opened_in_a_cut_holds_it_and_closing_it_starts_nothing() {
    let params = guarded();
    let text = "M3 S300\nG4 P500\nG98 G1 Z-40 F300\nM30\n";
    let (ran, rest, speed, state) = door(text, &params, 2_000);
    assert_eq!((state, speed), (State::Held, 0));
    assert_eq!(rest.doing, Doing::Hold);
    assert_eq!(ran.alarm, None);
    // The spindle is at its speed before the axis moves again.
    let stands = ran
        .rows
        .iter()
        .filter(|row| row.tick >= 7_000 && row.position.z == rest.position.z);
    assert!(stands.count() > 100);
    let last = ran.rows.last().expect("rows").position;
    assert_eq!(last.z.nm(), -40_000_000);
    assert_eq!(first_excess(&ran.rows, &params), None);
}

#[test]
fn nothing_is_resumed_with_the_door_open() {
    let params = guarded();
    let mut states = Vec::new();
    let ran = run(
        "M3 S300\nG4 P500\nG98 G1 Z-9 F300\nM30\n",
        &params,
        &PlantOptions::default(),
        |sim, now| {
            let opened = (1_000..3_000).contains(&now);
            sim.set_pins(inputs(if opened { WELL & !(1 << 4) } else { WELL }));
            if now == 2_000 || now == 4_000 {
                sim.command(Command::Resume);
            }
            if now == 2_900 || now == 3_900 {
                states.push(sim.board().ticker().state());
            }
        },
    );
    assert_eq!(states, [State::Held, State::Held]);
    let warned = |event: &&Event| {
        matches!(
            event,
            Event::Warning(Alarm {
                code: Code::Interlocked,
                ..
            })
        )
    };
    assert_eq!(ran.events.iter().filter(warned).count(), 1);
    assert_eq!(ran.alarm, None);
}

/// A rapid override of 0 holds no way out of a groove, and so no reset.
#[test]
fn a_rapid_override_of_0_leaves_no_tool_in_a_groove() {
    let params = with(&[("5130", 0)]);
    let text = "G97 M3 S600\nG0 X-50 Z-20\nG92 X-61 Z-40 F1.5\nX-62\nM30\n";
    let locked = locked_ticks(text, &params);
    let (first, last) = (locked[0], *locked.last().expect("a thread"));
    for tick in (first..last + 600).step_by(leadscrew_seed::amount(487, 97)) {
        let mut sim = machine(&params, &PlantOptions::default());
        let mut calls = calls(text, &params).into_iter().peekable();
        let mut stands = None;
        for now in 0..tick + 20_000 {
            while calls.peek().is_some_and(|call| sim.offer(call)) {
                calls.next();
            }
            if now == tick {
                sim.command(Command::RapidOverride(0));
            }
            if now == tick + 15_000 {
                stands = Some(sim.board().ticker().executor().position());
                sim.command(Command::Reset);
                calls = Vec::new().into_iter().peekable();
            }
            sim.step();
        }
        // Outside of the groove, or in front of it on the way to its depth.
        let at = stands.expect("it was looked at");
        let is_out = at.x.nm() > -30_000_000 || at.z.nm() == -20_000_000;
        assert!(is_out, "{tick}: {at:?}");
        assert_eq!(sim.board().ticker().state(), State::Idle, "{tick}");
    }
    // And where the reset comes within it.
    for tick in (first..last + 100).step_by(leadscrew_seed::amount(487, 97)) {
        for percent in [0, 1] {
            let mut sim = machine(&params, &PlantOptions::default());
            let mut calls = calls(text, &params).into_iter().peekable();
            for now in 0..tick + 6_000 {
                while calls.peek().is_some_and(|call| sim.offer(call)) {
                    calls.next();
                }
                if now == tick {
                    sim.command(Command::RapidOverride(percent));
                    sim.command(Command::Reset);
                    calls = Vec::new().into_iter().peekable();
                }
                sim.step();
            }
            assert_eq!(sim.board().ticker().state(), State::Idle, "{tick}");
        }
    }
}

/// How far Z goes in a second of jogging at rapid.
fn jogged(levels: u16, params: &Params) -> (i64, u16) {
    let mut bench = Bench::new(params, levels);
    bench.order(Order::Mode(OperatingMode::Manual));
    for _ in 0..50 {
        bench.press();
        bench.run(20);
    }
    let z = bench.sim.board().ticker().executor().position().z.nm();
    (z, bench.gateway.beat.refused)
}

#[test]
fn axes_are_slow_with_the_door_open() {
    let params = guarded();
    let (free, refused) = jogged(WELL, &params);
    assert_eq!(refused, 0);
    let (slow, refused) = jogged(WELL & !(1 << 4), &params);
    assert_eq!(refused, 0);
    // 9043 is 1000 mm/min: 16.7 mm in a second.
    assert!((-16_700_000..-12_000_000).contains(&slow), "{slow}");
    assert!(free < 3 * slow, "{free} {slow}");
    // An open chuck and lost pressure do not matter to axes.
    let (other, refused) = jogged(WELL & 0b1_0000, &params);
    assert_eq!((other, refused), (free, 0));
}

#[test]
fn with_the_door_open_axes_need_the_enabling_switch_where_there_is_one() {
    let mut values: Vec<(&str, i64)> = vec![("9423", 5), ("9429", 9)];
    values.extend(rows());
    let params = with(&values);
    let (moved, refused) = jogged(0, &params);
    assert_eq!((moved, refused), (0, 4506));
    let (moved, refused) = jogged(1 << 8, &params);
    assert_eq!(refused, 0);
    assert!(moved < -12_000_000, "{moved}");
    let (moved, refused) = jogged(1 << 4, &params);
    assert_eq!(refused, 0);
    assert!(moved < -40_000_000, "{moved}");
}

#[test]
fn a_door_that_is_opened_ends_a_press() {
    let params = guarded();
    let mut bench = Bench::new(&params, WELL);
    bench.order(Order::Mode(OperatingMode::Manual));
    for turn in 0..60 {
        bench.press();
        bench
            .sim
            .set_pins(inputs(if turn < 20 { WELL } else { WELL & !(1 << 4) }));
        bench.run(20);
    }
    let ticker = bench.sim.board().ticker();
    assert_eq!(ticker.state(), State::Idle);
    let z = ticker.executor().position().z;
    bench.run(200);
    // The press is over: its renewals move nothing.
    assert_eq!(bench.sim.board().ticker().executor().position().z, z);
}

#[test]
fn the_door_stops_a_spindle_that_no_program_turns() {
    let params = guarded();
    let mut bench = Bench::new(&params, WELL);
    let program = calls("M3 S300\n", &params);
    for call in &program {
        assert!(bench.sim.offer(call));
    }
    bench.run(1_500);
    bench.sim.set_pins(inputs(WELL & !(1 << 4)));
    bench.run(3_000);
    bench.sim.set_pins(inputs(WELL));
    bench.run(3_000);
    assert_eq!(bench.sim.spindle_command().get(), 0);
}
