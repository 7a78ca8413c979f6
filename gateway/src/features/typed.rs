//! Tools that were typed and that a program cuts nothing with: a slip that would else go unseen.

use std::collections::BTreeSet;

use leadscrew_core::call::Aux;
use leadscrew_core::moves::MoveKind;
use leadscrew_inspection::tool_of;

use super::Tools;
use crate::diagnostics;
use crate::failure::Outcome;
use crate::setup::Setup;
use crate::source::SourceFile;
use crate::walk::Walk;
use crate::words::both;

/// Tells each of them.
///
/// # Errors
/// The program cannot be read.
pub fn tell_idle(setup: &Setup, source: &SourceFile, tools: &Tools) -> Outcome {
    let edges = tools.edges.iter().filter_map(|edge| edge.tool);
    let mut idle: BTreeSet<u32> = tools.widths.iter().map(|width| width.tool).collect();
    idle.extend(edges);
    if idle.is_empty() {
        return Ok(());
    }
    let mut tool = 0;
    let mut walk = Walk::open(setup, source)?;
    while walk
        .next_call(|_, step| match step.kind {
            MoveKind::Aux(Aux::T(code)) => tool = tool_of(code.into()),
            MoveKind::Feed(_) | MoveKind::Arc { .. } | MoveKind::Thread(_) | MoveKind::Tap(_) => {
                idle.remove(&tool);
            }
            MoveKind::Rapid | MoveKind::Dwell(_) | MoveKind::Spindle(_) | MoveKind::Aux(_) => {}
        })?
        .is_some()
    {}
    for tool in idle {
        let told = both!(
            "T{tool} was typed, and the program cuts nothing with it: what was typed for it does nothing\n",
            "输入了 T{tool}，但程序没有用它切削：为它输入的内容不起作用\n"
        );
        diagnostics::say(told.get(setup.lang));
    }
    Ok(())
}
