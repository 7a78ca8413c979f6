//! Drives alone: they take the frames of a board elsewhere, move at its SYNC, and answer.

use std::time::Duration;

use leadscrew_board_sim::plant::{
    Drive, PlantError, PlantOptions, ServoOptions, Tapper, axis_drive, tapper,
};
use leadscrew_common::failure::{Failure, Outcome};
use leadscrew_common::interrupt;
use leadscrew_common::words::Both;
use leadscrew_core::bus::{Frame, is_sync};
use leadscrew_core::call::TapSpindle;
use leadscrew_core::params::Params;
use leadscrew_core::units::Axis;

use crate::cli::{Drives, Here};
use crate::machine::say;
use crate::wire::{Heard, Wire};

/// The longest wait for a frame, before a check whether the user wants to end.
const PATIENCE: Duration = Duration::from_millis(200);

/// A drive of an axis or of a spindle.
enum One {
    Axis(Box<Drive>),
    Spindle(Box<Tapper>),
}

impl One {
    fn drive(&mut self) -> &mut Drive {
        match self {
            Self::Axis(drive) => drive,
            Self::Spindle(spindle) => spindle.drive(),
        }
    }

    fn sync(&mut self, send: impl FnMut(Frame)) {
        match self {
            Self::Axis(drive) => {
                drive.elapse();
                drive.sync(None, send);
            }
            Self::Spindle(spindle) => {
                spindle.advance();
                spindle.sync(send);
            }
        }
    }
}

/// The drives that the command line asks for.
fn wanted(
    args: &Drives,
    params: &Params,
    servos: [Option<ServoOptions>; 2],
) -> Result<Vec<One>, PlantError> {
    let Here(here) = args.axes;
    let plant = PlantOptions {
        servos,
        ..args.plant()
    };
    let axes = Axis::ALL.into_iter().zip(here).filter(|(_, here)| *here);
    let mut all: Vec<One> = axes
        .map(|(axis, _)| axis_drive(params, &plant, axis).map(|drive| One::Axis(Box::new(drive))))
        .collect::<Result<_, _>>()?;
    if args.spindles {
        for spindle in TapSpindle::ALL.iter().take(params.tap_spindles().into()) {
            let spindle = tapper(params, &plant, *spindle)?;
            all.push(One::Spindle(Box::new(spindle)));
        }
    }
    Ok(all)
}

/// Runs until the user ends it.
pub fn run(args: &Drives) -> Outcome {
    let params = args.common.load()?;
    let servos = args.common.servos(&params)?;
    let mut drives = wanted(args, &params, servos).map_err(|error| {
        let reason = format!("the parameters make no drive: {error:?}");
        Failure::WrongBecause(Both::same(reason))
    })?;
    let mut wire = Wire::open(args.common.address(), &params)?;
    let nodes: Vec<String> = drives
        .iter_mut()
        .map(|drive| drive.drive().node().get().to_string())
        .collect();
    say(&format!("drives {} on {}", nodes.join(", "), wire.name()));
    let mut answers = Vec::new();
    while !interrupt::requested() {
        // Frames that arrive together are answered together, SYNC by SYNC.
        wire.listen(PATIENCE, |heard| {
            for one in &mut drives {
                match heard {
                    Heard::Frame(frame) if is_sync(frame) => {
                        one.sync(|answer| answers.push(answer));
                    }
                    Heard::Frame(frame) => {
                        let drive = one.drive();
                        drive.receive(frame);
                        drive.serve(frame, |answer| answers.push(answer));
                    }
                    Heard::Fd(frame) => one.drive().receive_fd(frame),
                }
            }
        })?;
        wire.send(&answers)?;
        answers.clear();
    }
    Ok(())
}
