//! `params restore`: the last good set before the stored one comes back into force, and is stored.
//!
//! A board whose newest set is damaged offers it: it has loaded it, and moves nothing until somebody has agreed.

use super::home::Home;
use super::push::{self, Done};
use crate::cli::{Global, Restore};
use crate::failure::{Failure, Outcome};
use crate::interrupt::{self, UnderWay};
use crate::params::difference::changes;
use crate::words::both;

/// Takes it back.
pub fn run(global: &Global, args: &Restore) -> Outcome {
    let Home::Board(mut machine) = Home::open(global)? else {
        return Err(push::no_board());
    };
    let link = &mut machine.link;
    let Some(identity) = link.last_good()? else {
        return Err(Failure::WrongBecause(both!(
            "the board has no good set from before: push one (`leadscrew params push FILE`)",
            "控制板中没有更早的完好参数集：请写入一份（`leadscrew params push FILE`）"
        )));
    };
    let old = machine.params.clone();
    let mut done = Done {
        identity,
        restored: true,
        ..Done::default()
    };
    if global.dry_run {
        done.notes.push(both!(
            "the last good set has identity {identity:08x}",
            "最后一份完好的参数集标识为 {identity:08x}"
        ));
    } else {
        // From here on the board changes and stores its set: an interruption waits until its answer has been told.
        interrupt::defer(UnderWay::Machine);
        link.attend()?;
        if let Some(password) = args.password {
            link.open_parameters(password)?;
        }
        let recalled = link.recall();
        machine.keep()?;
        recalled?;
        let set = machine.link.parameters()?;
        done.identity = set.identity;
        done.changes = changes(&old, &set.params);
    }
    push::tell(global, &done)
}
