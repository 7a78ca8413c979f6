//! Something goes wrong at any tick of a homing: the machine comes to rest on an alarm and is not referenced, no drive
//! jumps, and after a reset it homes as if nothing had been.

use leadscrew_board_sim::plant::Trouble;
use leadscrew_core::alarm::Code;
use leadscrew_core::board::{Command, State};
use leadscrew_core::units::{Axes, Axis};
use leadscrew_seed::{amount, volume};
use leadscrew_tests::random::Random;

use crate::bench::{Bench, MARK, SWITCHES};

const METHODS: [(u8, i64); 4] = [(24, 300_000), (23, 299_800), (8, 312_500), (14, 262_500)];

#[derive(Clone, Copy, Debug)]
enum Fault {
    Drive(Trouble),
    Stop,
    Halt,
    Restart,
}

const FAULTS: [Fault; 8] = [
    Fault::Drive(Trouble::Silent),
    Fault::Drive(Trouble::CutOff),
    Fault::Drive(Trouble::Fault(0x3210)),
    Fault::Drive(Trouble::Fault(0x7305)),
    Fault::Drive(Trouble::TorqueOff),
    Fault::Stop,
    Fault::Halt,
    Fault::Restart,
];

/// The alarms of a fault.
fn expected(fault: Fault) -> &'static [Code] {
    match fault {
        Fault::Drive(Trouble::Silent | Trouble::CutOff) => &[Code::DriveSilent],
        Fault::Drive(Trouble::Fault(_)) => &[Code::DriveFault],
        Fault::Drive(_) => &[Code::DriveLost],
        Fault::Stop => &[Code::EmergencyStop],
        Fault::Halt => &[Code::HomeCancelled],
        Fault::Restart => &[Code::DriveRestarted],
    }
}

#[test]
fn at_any_tick() {
    volume(17, |seed| {
        let mut random = Random(seed);
        for _ in 0..amount(150, 600) {
            let fault = random.of(&FAULTS);
            let (method, mark) = random.of(&METHODS);
            let start = random.within(200_000, 500_000);
            let at = random.within(1, 4_000) as u64;
            try_out(fault, method, mark, start, at);
        }
    });
}

/// The tick in which an undisturbed homing ends.
fn ticks_of_homing(method: u8, start: i64) -> u64 {
    let mut bench = Bench::new(start, SWITCHES, method);
    bench.home(Axes::NONE.with(Axis::X));
    bench.until("undisturbed", |bench| bench.state() != State::Homing);
    bench.ticks
}

fn try_out(fault: Fault, method: u8, mark: i64, start: i64, at: u64) {
    let what = format!("{fault:?} at {at}, method {method} from {start}");
    let mut bench = Bench::new(start, SWITCHES, method);
    bench.home(Axes::NONE.with(Axis::X));
    while bench.ticks < at && bench.state() == State::Homing {
        bench.tick();
    }
    let was_homing = bench.state() == State::Homing;
    match fault {
        Fault::Drive(trouble) => bench.drive().trouble(trouble),
        Fault::Stop => bench.sim.command(Command::Stop),
        Fault::Halt => bench.sim.command(Command::Halt(Code::HomeCancelled)),
        Fault::Restart => bench.drive().restart(),
    }
    bench.until(&what, |bench| matches!(bench.state(), State::Alarm(_)));
    // The mark may be found in the ticks in which the fault comes to be known, and no sooner.
    let found = was_homing && bench.referenced().contains(Axis::X);
    if found {
        let ends = ticks_of_homing(method, start);
        assert!(at + 3 >= ends, "{what}: {ends}");
    }
    let was_homing = was_homing && !found;
    let alarm = bench.alarm(&what);
    assert!(expected(fault).contains(&alarm.code), "{what}: {alarm:?}");
    bench.judge(&what, 1);
    // It stands, and goes on standing; a drive that hears nothing still homes by itself.
    let deaf = matches!(fault, Fault::Drive(Trouble::CutOff));
    for _ in 0..if deaf { 0 } else { 300 } {
        bench.tick();
    }
    bench.judge(&what, if deaf { 1 } else { 290 });
    bench.drive().trouble(Trouble::None);
    bench.prepare(method);
    bench.sim.command(Command::Reset);
    bench.tick();
    bench.until(&what, |bench| bench.state() != State::Starting);
    assert_eq!(bench.state(), State::Idle, "{what}: {:?}", bench.events);
    let kept = !was_homing
        && matches!(
            fault,
            Fault::Stop
                | Fault::Halt
                | Fault::Drive(
                    Trouble::Silent | Trouble::CutOff | Trouble::TorqueOff | Trouble::Fault(0x3210)
                )
        );
    assert_eq!(bench.referenced().contains(Axis::X), kept, "{what}");
    let at = bench.home_x(&what);
    assert_eq!(at, MARK + (bench.drive().place() - mark) * 100, "{what}");
    bench.judge(&what, 8);
}
