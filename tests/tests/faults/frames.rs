//! Frames that are lost, arrive twice, or arrive after the next frame, in both directions.

use leadscrew_board_sim::line::{Faults, Noise, Way};
use leadscrew_core::alarm::Code;
use leadscrew_core::bus::{BoardState, Object, Order, SdoProtocol};
use leadscrew_core::link::{ImageWriter, identity};
use leadscrew_core::operating::OperatingMode;
use leadscrew_core::params::Params;
use leadscrew_tests::gateway::{BATCH, NODE, Upload, fresh};
use leadscrew_tests::machine::calls;

use crate::bench::{AnyBench as _, Bench, TAP, WORK, calm};
use leadscrew_tests::params::with;

/// What a wire to the drives may do without a drive counting as silent.
const WORN: Noise = Noise {
    lose: 5,
    double: 20,
    swap: 20,
};

/// What a transfer may meet.
const BAD: Noise = Noise {
    lose: 20,
    double: 20,
    swap: 20,
};

fn drives(seed: u64, noise: Noise) -> Faults {
    let mut faults = Faults {
        seed,
        ..Faults::NONE
    };
    for way in [Way::Setpoints, Way::Statuses] {
        *faults.noise_mut(way) = noise;
    }
    faults
}

fn gateway(seed: u64, noise: Noise) -> Faults {
    let mut faults = Faults {
        seed,
        ..Faults::NONE
    };
    for way in [Way::In, Way::Out] {
        *faults.noise_mut(way) = noise;
    }
    faults
}

/// Positions are absolute: the next frame makes up for what a drive misses, and the end of the work is exact.
#[test]
fn between_board_and_drives_they_cost_a_step_and_never_a_position() {
    leadscrew_seed::volume(1, |first| {
        let params = Params::sheets();
        let mut silent = 0;
        for seed in (0..8).map(|n| first.wrapping_add(n)) {
            let what = format!("seed {seed}");
            let mut bench = Bench::at_work(&params, WORK, drives(seed, WORN));
            while !bench.waiting.is_empty() || bench.sim.is_busy() {
                bench.tick();
            }
            if bench
                .alarm
                .is_some_and(|alarm| alarm.code == Code::DriveSilent)
            {
                // The wire has lost three statuses of a drive one after the other.
                silent += 1;
                assert!(silent <= 2, "{what}");
                continue;
            }
            assert_eq!(bench.alarm, None, "{what}");
            let harm = bench.sim.harm();
            assert!(
                harm.lost > 20 && harm.doubled > 100 && harm.swapped > 100,
                "{harm:?}"
            );
            bench.never_jumps(&what, 0, 6);
            bench.sim.spoil(Faults::NONE);
            bench.ticks(5);
            assert_eq!(bench.drives(), [35_000_000, 8_000_000], "{what}");
            bench.next(&what);
        }
    });
}

/// Mode and speed of a spindle go out on change: if that frame is lost, the next repetition makes up for it.
#[test]
fn a_spindle_is_told_again_what_it_did_not_hear() {
    let params = Params::sheets();
    let rows = calm(&params, TAP);
    let first = rows.iter().find(|row| row.is_rigid()).expect("a tap").tick;
    for tick in first - 10..first + 10 {
        let what = format!("nothing reaches the drives at {tick}");
        let mut bench = Bench::new(&params);
        bench.load(TAP);
        bench.until(&what, tick, |bench| bench.ticks == tick);
        let mut deaf = Faults::NONE;
        deaf.noise_mut(Way::Setpoints).lose = 1000;
        bench.sim.spoil(deaf);
        bench.tick();
        bench.sim.spoil(Faults::NONE);
        while !bench.waiting.is_empty() || bench.sim.is_busy() {
            bench.tick();
        }
        assert_eq!(bench.alarm, None, "{what}");
        // Without its mode for 16 periods the spindle has hardly begun to turn; with none at all it is half a millimetre.
        let errors = bench.rows.iter().filter_map(|row| row.error);
        let worst = errors.map(|error| error.nm().abs()).max().expect("a tap");
        assert!(worst < 20_000, "{what}: {worst} nm");
        bench.ticks(20);
        assert_eq!(bench.drives(), [25_000_000, 5_000_000], "{what}");
        let tap = bench.sim.board().tap_record();
        assert!(tap.is_some_and(|tap| !tap.in_hole), "{what}");
    }
}

/// Nothing is heard of a drive for three answers in a row: that is silence, and nothing else of all this is an alarm.
#[test]
fn a_wire_that_loses_every_frame_of_a_drive_is_silence() {
    let noise = Noise {
        lose: 1000,
        ..Noise::default()
    };
    let mut faults = Faults::NONE;
    *faults.noise_mut(Way::Statuses) = noise;
    let mut bench = Bench::at_work(&Params::sheets(), WORK, Faults::NONE);
    bench.ticks(300);
    bench.sim.spoil(faults);
    bench.stops_with("silence", 4360, 20);
}

/// Sends a whole program; a transfer that fails is begun again.
fn upload(bench: &mut Bench, upload: &mut Upload) -> usize {
    let mut failed = 0;
    while !upload.is_done() {
        let credit = loop {
            bench.ticks(2);
            if let Ok(credit) = bench.gateway.number(&mut bench.lathe.sim, 0x5020, 5) {
                break credit;
            }
            failed += 1;
            bench.ticks(1_100);
            assert!(failed < 300, "nothing goes through");
        };
        let Some((bytes, count)) = upload.batch(credit as u16) else {
            bench.ticks(10);
            continue;
        };
        loop {
            let sent = bench
                .gateway
                .write(&mut bench.lathe.sim, BATCH, &bytes, upload.protocol);
            match sent {
                Ok(()) => break,
                // The board gives up a transfer that does not go on.
                Err(_) => failed += 1,
            }
            assert!(failed < 300, "nothing goes through");
            bench.ticks(1_100);
        }
        upload.taken(count);
    }
    failed
}

/// The program that arrives is the one that was sent, whole, once and in order.
#[test]
fn between_gateway_and_board_a_program_arrives_whole_or_not_at_all() {
    leadscrew_seed::volume(1, |first| {
        let params = Params::sheets();
        let mut good = Bench::new(&params);
        Upload::new(1, &calls(WORK, &params)).feed(&mut good.gateway, &mut good.lathe.sim);
        good.gateway.order(&mut good.lathe.sim, Order::Run);
        good.until("good", 60_000, |bench| bench.state_is_idle_again());
        let mut spoilt = 0;
        for (seed, protocol) in [
            (first, SdoProtocol::Block),
            (first.wrapping_add(1), SdoProtocol::Short),
            (first.wrapping_add(2), SdoProtocol::Block),
        ] {
            let what = format!("seed {seed}");
            let mut bench = Bench::new(&params);
            let mut program = Upload::new(1, &calls(WORK, &params));
            program.protocol = protocol;
            program.most = 2;
            bench.sim.spoil(gateway(seed, BAD));
            spoilt += upload(&mut bench, &mut program);
            // An order is repeated until its count is read in the status.
            for (order, last) in [
                (Order::Mode(OperatingMode::Automatic), 40),
                (Order::Run, 41),
            ] {
                while bench.gateway.status.count != last + 1 {
                    let command = fresh(&bench.lathe.sim, order, last);
                    bench.sim.receive(&command.frame(NODE));
                    bench.ticks(10);
                }
            }
            bench.until(&what, 60_000, |bench| bench.state_is_idle_again());
            assert_eq!(bench.alarm, None, "{what}");
            assert_eq!(bench.started(), good.started(), "{what}");
            assert_eq!(bench.drives(), good.drives(), "{what}");
        }
        assert!(spoilt > 0, "seed {first}: nothing was spoilt");
    });
}

/// Twice the same order is one; two are two, whatever happens to their frames.
#[test]
fn orders_act_once_each() {
    leadscrew_seed::volume(5, |seed| {
        let params = Params::sheets();
        let mut bench = Bench::new(&params);
        let text = "G98 G1 X40 Z-100 F500\nG1 X20 Z0\nM30\n";
        Upload::new(1, &calls(text, &params)).feed(&mut bench.gateway, &mut bench.lathe.sim);
        bench.gateway.order(&mut bench.lathe.sim, Order::Run);
        bench.ticks(100);
        let noise = Noise {
            lose: 300,
            double: 300,
            swap: 100,
        };
        bench.sim.spoil(gateway(seed, noise));
        for round in 0..40 {
            let (order, state) = match round % 2 {
                0 => (Order::Hold, BoardState::Hold),
                _ => (Order::Resume, BoardState::Run),
            };
            let mut tries = 0;
            while bench.gateway.status.count != 101 + round {
                let command = fresh(&bench.lathe.sim, order, 100 + round);
                bench.sim.receive(&command.frame(NODE));
                bench.ticks(10);
                tries += 1;
                assert!(tries < 100, "round {round}");
            }
            bench.ticks(300);
            assert_eq!(bench.gateway.status.state, state, "round {round}");
        }
        assert_eq!(bench.alarm, None);
    });
}

/// A parameter set comes into force as a whole, or the earlier set stays.
#[test]
fn a_parameter_set_arrives_whole_or_not_at_all() {
    leadscrew_seed::volume(1, |first| {
        let old = Params::sheets();
        let new = with(&[("9022", 20), ("9023", 100), ("1828.X", 400_000)]);
        let mut image = vec![0; ImageWriter::BYTES as usize];
        ImageWriter::new(&new).read(0, &mut image);
        for seed in (0..6).map(|n| first.wrapping_add(n)) {
            let mut bench = Bench::new(&old);
            let mut failed = 0;
            loop {
                bench
                    .sim
                    .spoil(gateway(seed.wrapping_add(100 * failed), BAD));
                let object = Object::new(0x5010, 1);
                let sent =
                    bench
                        .gateway
                        .write(&mut bench.lathe.sim, object, &image, SdoProtocol::Block);
                bench.sim.spoil(Faults::NONE);
                bench.ticks(1_200);
                let force = bench
                    .gateway
                    .number(&mut bench.lathe.sim, 0x1020, 1)
                    .expect("it answers");
                let (was, is) = (u64::from(identity(&old)), u64::from(identity(&new)));
                assert!(force == was || force == is, "seed {seed}: a mixture");
                if sent.is_ok() {
                    assert_eq!(force, is, "seed {seed}");
                    break;
                }
                failed += 1;
                assert!(failed < 200, "seed {seed}: never through");
            }
            assert_eq!(bench.alarm, None);
        }
    });
}
