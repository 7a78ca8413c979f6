//! Drives that fail.

use leadscrew_board_sim::plant::Trouble;
use leadscrew_core::board::Command;
use leadscrew_core::params::Params;
use leadscrew_core::units::Axis;
use leadscrew_tests::bench::{Bench, Lathe, PATIENCE, WORK};

use crate::bench::{Recovers, calm, places, stride};

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
        let mut bench = Lathe::new(&params);
        bench.load(WORK);
        bench.until(&what, tick, |bench| bench.ticks == tick);
        let drive = |bench: &mut Lathe, trouble| {
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
        bench.until_on_alarm(&what, PATIENCE);
        bench.stands(&what);
        // Not mended: the reset ends in an alarm again, and still nothing moves.
        bench.alarm = None;
        bench.sim.command(Command::Reset);
        bench.tick();
        bench.until(&what, 5_000, |bench| bench.alarm.is_some());
        bench.until_on_alarm(&what, 5_000);
        bench.stands(&what);
        drive(&mut bench, Trouble::None);
        bench.ticks(10);
        bench.reset(&what);
        bench.stands(&what);
        bench.next(&what);
    }
}
