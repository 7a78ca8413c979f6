//! Faults: drives, spindle, encoder, flash, and the wire between the board and all other nodes.

use leadscrew_board_sim::line::{Faults, Intruder, Noise, Span};
use leadscrew_board_sim::plant::Trouble;
use leadscrew_core::alarm::Code;
use leadscrew_core::bus::NodeId;
use leadscrew_core::units::Axis;

use super::bench::Bench;

/// Alarms of a faulty drive.
pub(super) const OF_DRIVES: [Code; 14] = [
    Code::DriveNoAnswer,
    Code::DriveNotInitialised,
    Code::DriveNotReleased,
    Code::DriveNotReady,
    Code::DriveNotSwitchedOn,
    Code::DriveNotEnabled,
    Code::DriveFaultNotReset,
    Code::DriveFault,
    Code::DriveLost,
    Code::DriveRestarted,
    Code::DriveSilent,
    Code::FollowingError,
    Code::SpindleStands,
    Code::DriveJump,
];

/// Alarms of the bus itself.
pub(super) const OF_BUS: [Code; 5] = [
    Code::BusOff,
    Code::BusPassive,
    Code::SecondSync,
    Code::SecondSetpoints,
    Code::SecondManager,
];

/// Breaks a part of the machine.
pub(super) fn break_something(bench: &mut Bench) {
    bench.counts.troubles += 1;
    bench.operator.broken = true;
    let axis = bench.random.of(&Axis::ALL);
    let trouble = bench.random.of(&[
        Trouble::Silent,
        Trouble::Stuck,
        Trouble::Fault(0x2310),
        Trouble::TorqueOff,
    ]);

    match bench.random.within(0, 14) {
        0..=3 => {
            bench.operator.cause(&OF_DRIVES);
            bench.random.act(|| format!("drive {axis:?}: {trouble:?}"));
            bench.sim.plant().drive(axis).trouble(trouble);
        }
        4 => {
            bench.operator.cause(&OF_DRIVES);
            bench.operator.break_spindle();
            bench
                .random
                .act(|| format!("drive of the spindle: {trouble:?}"));
            bench.sim.plant().spindle_drive().trouble(trouble);
        }
        5 => {
            bench.operator.cause(&OF_DRIVES);
            bench.random.act(|| format!("drive {axis:?} restarts"));
            bench.sim.plant().drive(axis).restart();
        }
        6 => {
            bench.operator.cause(&[Code::IndexSlipped, Code::NoIndex]);
            bench.operator.break_spindle();
            let counts = bench.random.within(1, 400) * bench.random.sign();
            bench
                .random
                .act(|| format!("the encoder slips by {counts}"));
            bench.sim.plant().encoder().slip(counts as i32);
            bench.slipped = true;
            bench.watch.set_slipped(true);
        }
        7 => {
            bench.operator.cause(&[Code::NoIndex]);
            bench.random.act(|| "the encoder loses its index".into());
            bench.sim.plant().encoder().break_index(true);
        }
        8 => {
            bench.operator.break_spindle();
            let percent = bench.random.of(&[0, 40, 80, 130]);
            bench
                .random
                .act(|| format!("the spindle turns at {percent} % of what it is told"));
            bench.sim.plant().spindle().disturb(percent);
        }
        10..=14 => spoil(bench),
        _ => {
            bench.operator.cause(&[Code::TapJournalNotWritten]);
            bench.random.act(|| "the flash refuses".into());
            bench.sim.flash_mut().set_broken(true);
        }
    }
}

/// Spoils the wire: frames of the drives are lost, doubled and swapped by chance; the controller leaves the bus or nearly
/// does; another node sends SYNC, moves a drive or stops one.
fn spoil(bench: &mut Bench) {
    if bench.operator.spoilt.is_some() {
        return;
    }
    bench.operator.break_spindle();
    for causes in [&OF_DRIVES[..], &OF_BUS, &[Code::GatewayLost]] {
        bench.operator.cause(causes);
    }
    let from = bench.watch.tick_to_come();
    let r = &mut bench.random;
    let span = Span {
        from,
        to: from + r.within(1, 150) as u64,
    };
    let mut faults = Faults {
        seed: r.within(1, i64::MAX - 1) as u64,
        ..Faults::NONE
    };
    let node = r.of(&[
        NodeId::DRIVE_X,
        NodeId::DRIVE_Z,
        NodeId::DRIVE_C,
        NodeId::SPINDLE_1,
    ]);
    match r.within(0, 5) {
        0 => faults.bus_off = Some(span),
        1 => faults.error_passive = Some(span),
        2 => faults.intruder = Some((Intruder::Sync, span)),
        3 => faults.intruder = Some((Intruder::Setpoint(node), span)),
        4 => faults.intruder = Some((Intruder::Stop(node), span)),
        _ => {
            let mut noise = || Noise {
                lose: r.within(0, 20) as u16,
                double: r.within(0, 20) as u16,
                swap: r.within(0, 20) as u16,
            };
            faults.noise = [noise(), noise(), Noise::default(), Noise::default()];
        }
    }
    bench.operator.spoilt = Some(if faults.noise == Faults::NONE.noise {
        span.to
    } else {
        0
    });
    bench.random.act(|| format!("the wire: {faults:?}"));
    bench.sim.spoil(faults);
}

/// Ends the random faults of the wire. The others must end by themselves.
pub(super) fn mend_wire(bench: &mut Bench) {
    match bench.operator.spoilt {
        Some(0) => bench.sim.spoil(Faults::NONE),
        // A controller that has left the bus comes back when the board lets it.
        Some(until) if bench.watch.tick_to_come() <= until => return,
        _ => {}
    }
    bench.operator.spoilt = None;
}
