//! Door, chuck, its pressure and that of the tailstock: what starts without them, and what stops when they go.

use super::*;

#[test]
fn no_program_starts_with_a_door_or_a_chuck_open_or_without_pressure() {
    let params = guarded();
    for (interlock, pin) in PINS {
        let mut bench = Bench::new(&params, WELL);
        assert_eq!(bench.order(Order::Mode(OperatingMode::Automatic)), 0);
        // Output 4 demands the tailstock.
        let program = calls("M12\n", &params);
        for call in &program {
            assert!(bench.sim.offer(call));
        }
        bench.run(50);
        bench.sim.command(Command::Reset);
        bench.run(50);
        bench.sim.set_pins(inputs(WELL & !pin));
        bench.run(5);
        assert_eq!(bench.order(Order::Run), 4506, "{interlock:?}");
        bench.sim.set_pins(inputs(WELL));
        bench.run(5);
        // Nothing has been loaded: the interlock is not what refuses it now.
        assert_ne!(bench.order(Order::Run), 4506, "{interlock:?}");
    }
}

#[test]
fn the_spindle_is_not_switched_on_with_a_door_or_a_chuck_open_or_without_pressure() {
    let params = guarded();
    for (interlock, pin) in PINS {
        let mut sim = machine(&params, &PlantOptions::default());
        sim.set_pins(inputs(WELL & !pin));
        sim.step();
        let (rows, alarm) = until_alarm_on(sim, "M12\nM3 S300\nM30\n", &params, |_| WELL & !pin);
        assert_eq!(alarm.code.number(), 4506, "{interlock:?}");
        assert_eq!(alarm.args[0], Arg::Interlock(interlock));
        assert_eq!(alarm.span.line, 2);
        // Nothing has turned.
        assert_eq!(
            rows.first().map(|row| row.spindle),
            rows.last().map(|row| row.spindle)
        );
    }
    // A tailstock that nobody demands keeps nothing.
    let ran = with_inputs("M3 S300\nM30\n", &params, |_| WELL & !(1 << 7));
    assert_eq!(ran.alarm, None);
}

#[test]
fn inputs_that_nobody_tells_are_the_worse_value() {
    let params = guarded();
    let mut bench = Bench::new(&params, WELL);
    assert!(
        bench
            .sim
            .board()
            .ticker()
            .interlocks()
            .against_start()
            .is_none()
    );
    bench.sim.around().open_door(false);
    bench.sim.set_pins(Inputs {
        machine: Some(0),
        ..Inputs::default()
    });
    bench.run(2);
    let interlocks = bench.sim.board().ticker().interlocks();
    assert_eq!(interlocks.against_start(), Some(Interlock::Door));
    assert!(interlocks.contains(Interlock::Chuck));
}

#[test]
fn pressure_lost_in_a_thread_leaves_it_and_is_an_alarm() {
    let params = guarded();
    let text = &format!("M12\n{THREAD}");
    let strokes = locked_ticks(text, &params);
    for (interlock, pin) in &PINS[1..] {
        for tick in strokes.iter().step_by(411) {
            let levels = |now| if now < *tick { WELL } else { WELL & !pin };
            let (rows, alarm) = until_alarm(text, &params, levels);
            assert_eq!(alarm.code.number(), 4555, "{interlock:?} {tick}");
            assert_eq!(alarm.args[0], Arg::Interlock(*interlock));
            // A millimetre clear of the crests, which are at X76.4.
            let last = rows.last().expect("rows").position;
            assert!(last.x.nm() >= 39_200_000, "{interlock:?} {tick} {last:?}");
            assert_eq!(first_excess(&rows, &params), None, "{interlock:?} {tick}");
        }
    }
}

/// On its way out behind a stroke the tool is in the thread still: it goes on until it is clear.
#[test]
fn pressure_lost_behind_a_stroke_lets_the_tool_out_of_the_thread() {
    let params = guarded();
    // Without a run-out: X moves when Z stands.
    let text = &format!("M12\n{THREAD}").replace("P010560", "P010060");
    let calm = with_inputs(text, &params, |_| WELL);
    let ends = calm
        .rows
        .windows(2)
        .filter(|two| two[0].error.is_some() && two[1].error.is_none());
    let mut met = 0;
    for end in ends.map(|two| two[1].tick) {
        let rows = calm.rows.iter().skip_while(|row| row.tick < end);
        let inside = rows.take_while(|row| row.position.x.nm() < 39_200_000);
        for tick in inside.map(|row| row.tick).step_by(7) {
            met += 1;
            let levels = |now| if now < tick { WELL } else { WELL & !PINS[1].1 };
            let (rows, alarm) = until_alarm(text, &params, levels);
            assert_eq!(alarm.code.number(), 4555, "{tick}");
            let last = rows.last().expect("rows").position;
            assert!(last.x.nm() >= 39_200_000, "{tick} {last:?}");
            assert_eq!(first_excess(&rows, &params), None, "{tick}");
        }
    }
    assert!(met > 10, "{met}");
}

#[test]
fn pressure_lost_in_a_cut_stops_it() {
    let params = guarded();
    let text = "M3 S300\nG4 P500\nG98 G1 Z-40 F300\nM30\n";
    for (interlock, pin) in &PINS[1..3] {
        let mut commanded = None;
        let ran = run(text, &params, &PlantOptions::default(), |sim, now| {
            sim.set_pins(inputs(if now < 2_000 { WELL } else { WELL & !pin }));
            commanded = Some(sim.spindle_command().get());
        });
        assert_eq!(alarm(&ran).0, 4555, "{interlock:?}");
        assert_eq!(commanded, Some(0));
    }
    // While nothing turns nobody minds.
    let ran = with_inputs("G98 G1 Z-40 F300\nM30\n", &params, |now| {
        if now < 2_000 { WELL } else { WELL & !(1 << 6) }
    });
    assert_eq!(ran.alarm, None);
}

#[test]
fn the_chuck_opens_a_second_after_the_spindle_stands() {
    let params = guarded();
    // Told to turn: refused at once.
    let ran = with_inputs("M3 S300\nG4 P500\nM11\nM30\n", &params, |_| WELL);
    assert_eq!(alarm(&ran).0, 4506);
    assert_eq!(alarm(&ran).1[0], Arg::Interlock(Interlock::Spindle));
    // Told to stop: it waits until the spindle has stood for a second, in ticks of a millisecond.
    let (mut stood, mut opened) = (0, None);
    let text = "M10\nM3 S300\nG4 P500\nM5\nM11\nM30\n";
    let ran = run(text, &params, &PlantOptions::default(), |sim, tick| {
        let ticker = sim.board().ticker();
        let closed = ticker.machine_outputs() as u16 & 0b100;
        let turns = ticker.observer().is_turning();
        sim.set_pins(inputs(WELL | closed << 1));
        if tick > 500 && closed == 0 && opened.is_none() {
            opened = Some(stood);
        }
        stood = if turns { 0 } else { stood + 1 };
    });
    assert_eq!(ran.alarm, None);
    assert_eq!(opened, Some(1_000));
}
