//! What the journal and the tapping return refuse, before anything moves.

use leadscrew_board_sim::plant::{Flash, PlantOptions};
use leadscrew_board_sim::{Sim, SimError};
use leadscrew_core::alarm::Code;
use leadscrew_core::board::{Command, Event};
use leadscrew_core::bus::{Object, SdoProtocol};
use leadscrew_core::call::{Call, CallKind};
use leadscrew_core::cycle::{Context, expand};
use leadscrew_core::moves::{Cycle, MoveKind, Stage};
use leadscrew_core::params::Params;
use leadscrew_core::units::{CentiRpm, Length};
use leadscrew_tests::gateway::Gateway;
use leadscrew_tests::machine::{calls, machine};
use leadscrew_tests::params::with;

use super::ways_out::{HIGH_SPEED, Told, go, position, returns, stopped};

fn codes(told: &Told) -> Vec<Code> {
    let told = told.events.iter().filter_map(|event| match event {
        Event::Alarm(alarm) | Event::Warning(alarm) => Some(alarm.code),
        _ => None,
    });
    // The hole is too shallow for its S.
    told.filter(|code| *code != Code::TapSpeedNotReached)
        .collect()
}

/// A machine with a tap in its hole since a reset.
fn in_the_hole(params: &Params) -> Sim {
    stopped(HIGH_SPEED, params, |sim| sim.command(Command::Reset), 1_100).0
}

/// The same machine after a cut of its power.
fn powered_anew(mut sim: Sim, params: &Params) -> Sim {
    sim.cut_power();
    let flash = sim.flash().clone();
    Sim::with_flash(params, &PlantOptions::default(), flash).expect("it starts")
}

/// A machine whose tap is out does what it is asked to.
fn goes_on(sim: &mut Sim, params: &Params) {
    let mut told = Told::default();
    go(
        sim,
        &calls("G0 X20 Z7\nM30\n", params),
        &mut told,
        |_, _| {},
    );
    assert_eq!(told.alarm(), None);
    assert_eq!(position(sim).z, Length::from_nm(7_000_000));
}

/// The alarm of a program on a machine, which must not move for it.
fn refused(sim: &mut Sim, text: &str, params: &Params) -> Code {
    let before = (position(sim), sim.plant().truth().angle);
    let mut told = Told::default();
    go(sim, &calls(text, params), &mut told, |_, _| {});
    assert_eq!((position(sim), sim.plant().truth().angle), before, "{text}");
    told.alarm()
        .unwrap_or_else(|| panic!("no alarm: {text}"))
        .code
}

/// No reader lets these pass after K198. A board need not have been fed by one.
#[test]
fn behind_k198_a_board_itself_refuses_what_takes_the_tap_out_of_phase() {
    const LOCKED: &str = "G98 G0 X50 Z5\nM29 S1000\nG84 Z-4 R-5 F2000 K198\nG4 P500\nG30 P99\n";
    let params = with(&[("5382", 3_000_000)]);
    let is_return = |call: &Call| matches!(call.kind, CallKind::TapReturn(_));
    for text in [
        "G0 Z20\n",
        "G0 X60\n",
        "G98 G1 Z1 F100\n",
        "M3 S300\n",
        "M29 S1000\nG84 Z-5 F1\n",
        "M30\n",
        "M8\nG4 P20\nM30\n",
    ] {
        let mut sim = machine(&params, &PlantOptions::default());
        let mut told = Told::default();
        let mut program = calls(LOCKED, &params);
        program.truncate(program.iter().position(is_return).expect("G30 P99"));
        program.extend(calls(text, &params));
        go(&mut sim, &program, &mut told, |_, _| {});
        let alarm = told.alarm().unwrap_or_else(|| panic!("no alarm: {text}"));
        assert_eq!(alarm.code, Code::TapInHole, "{text}");
        assert_eq!(position(&sim).z, Length::from_nm(-4_000_000), "{text}");
        // The way out is free after a reset.
        sim.command(Command::Reset);
        let mut told = Told::default();
        go(
            &mut sim,
            &calls("G30 P99\nM30\n", &params),
            &mut told,
            |_, _| {},
        );
        assert_eq!(told.alarm(), None, "{text}");
        assert_eq!(position(&sim).z, Length::from_nm(3_000_000), "{text}");
    }
}

#[test]
fn nothing_moves_while_a_tap_is_in_its_hole() {
    let params = with(&[]);
    for text in [
        "G0 Z20\n",
        "G0 X60\n",
        "G0 C90\n",
        "G98 G1 Z1 F100\n",
        "M3 S300\n",
        "M29 S1000\nG84 Z-5 F1\n",
        "G98 G0 X50 Z0\n",
        "G75 R0.5\nG75 X40 P3000 F100\n",
        "M8\nG4 P20\nG0 W5\n",
    ] {
        // After a reset.
        let mut sim = in_the_hole(&params);
        assert_eq!(refused(&mut sim, text, &params), Code::TapInHole, "{text}");
        // After power-up.
        let mut sim = powered_anew(in_the_hole(&params), &params);
        assert_eq!(refused(&mut sim, text, &params), Code::TapInHole, "{text}");
    }
    // What moves nothing is let in.
    let mut sim = in_the_hole(&params);
    let mut told = Told::default();
    go(
        &mut sim,
        &calls("M8\nG4 P20\nM9\nM30\n", &params),
        &mut told,
        |_, _| {},
    );
    assert_eq!(told.alarm(), None);
}

#[test]
fn a_dropped_entry_frees_the_machine() {
    let params = with(&[]);
    let mut sim = in_the_hole(&params);
    let stands = position(&sim);
    assert!(sim.discard_tap());
    sim.step();
    assert!(!sim.discard_tap(), "once");
    assert_eq!(position(&sim), stands);
    assert_eq!(
        refused(&mut sim, "G30 P99\n", &params),
        Code::TapReturnNothing
    );

    // After power-up the drive's own position counts again.
    let options = PlantOptions::default();
    let mut sim = powered_anew(in_the_hole(&params), &params);
    assert_eq!(position(&sim).z, Length::from_nm(-4_000_000));
    assert!(sim.discard_tap());
    sim.step();
    assert_eq!(position(&sim), options.at);
    goes_on(&mut sim, &params);
    // And it stays dropped.
    let sim = Sim::with_flash(&params, &options, sim.flash().clone()).expect("it starts");
    assert!(!sim.board().tap_record().expect("an entry").in_hole);
}

/// On an alarm the drives may go on following: what the entry said of the axis ends without a motion, and so does what
/// makes up for lag and backlash.
#[test]
fn an_entry_that_is_dropped_on_an_alarm_or_behind_it_moves_nothing() {
    for on_alarm in [true, false] {
        let params = with(&[("9070.Z", 300), ("1851.Z", 40_000)]);
        let options = PlantOptions::default();
        let mut sim = powered_anew(in_the_hole(&params), &params);
        assert_eq!(position(&sim).z, Length::from_nm(-4_000_000));
        if on_alarm {
            refused(&mut sim, "G0 X20\n", &params);
        }
        let stands = sim.plant().truth().positions;
        assert!(sim.discard_tap());
        for _ in 0..500 {
            sim.step();
            assert_eq!(sim.plant().truth().positions, stands);
        }
        if on_alarm {
            sim.command(Command::Reset);
            for _ in 0..500 {
                sim.step();
            }
        }
        assert_eq!(sim.plant().truth().positions, stands);
        assert_eq!(position(&sim), options.at);
        goes_on(&mut sim, &params);
    }
}

#[test]
fn nothing_to_return_from() {
    let params = with(&[]);
    let mut sim = machine(&params, &PlantOptions::default());
    assert_eq!(
        refused(&mut sim, "G30 P99 S500\nM30\n", &params),
        Code::TapReturnNothing
    );
    // Nor after a hole that was finished.
    let mut sim = machine(&params, &PlantOptions::default());
    let mut told = Told::default();
    go(&mut sim, &calls(HIGH_SPEED, &params), &mut told, |_, _| {});
    assert_eq!(told.alarm(), None);
    assert_eq!(
        refused(&mut sim, "G30 P99\n", &params),
        Code::TapReturnNothing
    );
}

#[test]
fn a_change_of_unit_and_a_soft_limit() {
    let params = with(&[]);
    let mut sim = in_the_hole(&params);
    assert_eq!(
        refused(&mut sim, "G20\nG30 P99\n", &params),
        Code::TapReturnUnit
    );
    // R is at 0 and 5382 leads beyond the limit.
    let tight = with(&[("5382", 6_000_000), ("1320.Z", 5_500_000)]);
    let mut sim = in_the_hole(&tight);
    assert_eq!(refused(&mut sim, "G30 P99\n", &tight), Code::SoftLimit);
    // Lead times S above what the axis may do.
    let slow = with(&[("1430.Z", 2_500_000_000)]);
    let mut sim = in_the_hole(&slow);
    assert_eq!(
        refused(&mut sim, "G30 P99 S3000\n", &slow),
        Code::LeadTooFast
    );
}

#[test]
fn a_journal_that_cannot_be_written_stops_a_tap_before_the_hole_only() {
    let params = with(&[]);
    let mut sim = machine(&params, &PlantOptions::default());
    sim.flash_mut().set_broken(true);
    let mut told = Told::default();
    go(&mut sim, &calls(HIGH_SPEED, &params), &mut told, |_, _| {});
    assert_eq!(codes(&told), [Code::TapJournalNotWritten]);
    assert!(told.rows.iter().all(|row| row.error.is_none()), "no tap");
    assert!(!sim.board().tap_record().expect("an entry").in_hole);

    // Inside, the hole is finished, with a warning for every write.
    let mut sim = machine(&params, &PlantOptions::default());
    let mut told = Told::default();
    let mut inside = 0;
    go(
        &mut sim,
        &calls(HIGH_SPEED, &params),
        &mut told,
        |sim, _| {
            if sim.board().ticker().executor().is_tapping() {
                inside += 1;
                sim.flash_mut().set_broken(inside > 50);
            }
        },
    );
    assert_eq!(told.alarm(), None);
    let codes = codes(&told);
    assert!(codes.len() > 3, "{codes:?}");
    assert!(
        codes.iter().all(|code| *code == Code::TapJournalStale),
        "{codes:?}"
    );
    assert_eq!(position(&sim).z, Length::from_nm(5_000_000), "home");
}

#[test]
fn power_that_goes_in_a_write_of_the_journal() {
    let params = with(&[("5382", 1_000_000)]);
    let mut after = 0;
    for cut in (0..1_400).step_by(leadscrew_seed::amount(37, 1)) {
        let mut sim = machine(&params, &PlantOptions::default());
        sim.flash_mut().cut_after(cut);
        let mut told = Told::default();
        go(&mut sim, &calls(HIGH_SPEED, &params), &mut told, |_, _| {});
        if sim.has_power() {
            continue;
        }
        let options = PlantOptions::default();
        let mut sim = Sim::with_flash(&params, &options, sim.flash().clone()).expect("it starts");
        let record = sim.board().tap_record().filter(|record| record.in_hole);
        if let Some(hole) = record.map(|record| record.hole) {
            after += 1;
            returns(&mut sim, &params, &hole);
        } else {
            // The first entry: nothing had gone in yet. Or the last one, which says that it is out.
            let mut inside = told.rows.iter().filter(|row| row.error.is_some());
            let last = inside.next_back().map(|row| row.position.z.nm());
            assert!(matches!(last, None | Some(0)), "cut at {cut}: {last:?}");
        }
    }
    assert!(after > 10, "{after}");
}

#[test]
fn a_damaged_journal_is_an_alarm_and_not_forgotten() {
    let params = with(&[]);
    let options = PlantOptions::default();
    let sim = in_the_hole(&params);
    let mut flash = sim.flash().clone();
    // An entry of a version that is not known: whole, as far as the flash can tell.
    let mut entry = sim.board().tap_record().expect("an entry").encode();
    entry[0] = 9;
    let mut store = leadscrew_store::Store::new(&mut flash).expect("a store");
    let region = leadscrew_store::Region::TapJournal;
    store.write(region, &entry).expect("written");
    let refused = Sim::with_flash(&params, &options, flash).err();
    let damaged =
        matches!(refused, Some(SimError::Board(alarm)) if alarm.code == Code::TapJournalDamaged);
    assert!(damaged, "{refused:?}");
    assert!(Sim::with_flash(&params, &options, Flash::erased()).is_ok());
}

/// The entry as any CANopen tool reads it.
#[test]
fn object_5030_is_the_entry() {
    let params = with(&[]);
    let mut sim = in_the_hole(&params);
    let mut gateway = Gateway::connect(&mut sim);
    let record = *sim.board().tap_record().expect("an entry");
    let read = gateway.read(&mut sim, Object::new(0x5030, 1), SdoProtocol::Segmented);
    assert_eq!(read, Ok(record.encode().to_vec()));
}

/// As `expand` prints it.
#[test]
fn the_one_move_of_a_return() {
    let params = with(&[("5382", 1_000_000)]);
    let sim = in_the_hole(&params);
    let record = *sim.board().tap_record().expect("an entry");
    let context = Context {
        tap: Some(&record),
        ..Context::standing(position(&sim))
    };
    let call = calls("G30 P99 S500\n", &params)[0];
    let moves: Vec<_> = expand(&call, &context).expect("legal").collect();
    let [out] = moves[..] else {
        panic!("{moves:?}")
    };
    let tag = out.tag.expect("a cycle");
    assert_eq!((tag.cycle, tag.stage), (Cycle::G30P99, Stage::Extract));
    assert_eq!(tag.depth, Length::from_nm(-1_000_000));
    assert_eq!(out.to.z, Length::from_nm(1_000_000));
    let MoveKind::Tap(tap) = out.kind else {
        panic!("{out:?}")
    };
    assert_eq!(tap.speed, CentiRpm::new(-50_000));
    // Lead 2: as many half turns as millimetres, backwards.
    let way = (out.to.z - position(&sim).z).nm();
    assert_eq!(
        i128::from(tap.turns.numerator()) * 2_000_000,
        -i128::from(way) * i128::from(tap.turns.denominator())
    );
}
