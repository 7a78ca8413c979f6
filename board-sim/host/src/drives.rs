//! The drives of the axes alone: they hear what a board elsewhere tells them, move at its SYNC, and answer.

use std::time::Duration;

use leadscrew::failure::{Failure, Outcome};
use leadscrew::interrupt;
use leadscrew::words::Both;
use leadscrew_board_sim::plant::{Drive, axis_drive};
use leadscrew_core::bus::is_sync;
use leadscrew_core::units::Axis;

use crate::cli::{Drives, Here};
use crate::machine::say;
use crate::wire::{Heard, Wire};

/// How long to listen before a look at whether the user wants to end.
const PATIENCE: Duration = Duration::from_millis(200);

/// Runs until the user ends it.
pub fn run(args: &Drives) -> Outcome {
    let params = args.common.load()?;
    let Here(here) = args.axes;
    let mut drives = Axis::ALL
        .into_iter()
        .zip(here)
        .filter(|(_, here)| *here)
        .map(|(axis, _)| axis_drive(&params, &args.plant(), axis))
        .collect::<Result<Vec<Drive>, _>>()
        .map_err(|error| {
            let reason = format!("the parameters make no drive: {error:?}");
            Failure::WrongBecause(Both::same(reason))
        })?;
    let mut wire = Wire::open(args.common.address(), &params)?;
    let nodes: Vec<String> = drives
        .iter()
        .map(|drive| drive.node().get().to_string())
        .collect();
    say(&format!("drives {} on {}", nodes.join(", "), wire.name()));
    let mut answers = Vec::new();
    while !interrupt::requested() {
        // Whatever came at once is answered at once, SYNC by SYNC.
        wire.listen(PATIENCE, |_, heard| {
            for drive in &mut drives {
                match heard {
                    Heard::Frame(frame) if is_sync(frame) => {
                        drive.sync(None, |answer| answers.push(answer));
                    }
                    Heard::Frame(frame) => {
                        drive.receive(frame);
                        drive.serve(frame, |answer| answers.push(answer));
                    }
                    Heard::Fd(frame) => drive.receive_fd(frame),
                }
            }
        })?;
        wire.send(&answers)?;
        answers.clear();
    }
    Ok(())
}
