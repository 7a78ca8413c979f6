//! A chain of strokes: collected until its last stroke is here, checked whole, and then planned stroke by stroke.
//!
//! So nothing of a chain moves before all of it can be cut, and the tick never waits for a call in mid-thread.

use super::{Planner, Settings};
use crate::alarm::Alarm;
use crate::call::{ChainPart, Position};
use crate::motion::{Chain, WaysOut};
use crate::moves::{Move, MoveKind};
use crate::tick::overridden;
use crate::units::{Length, Rpm, TurnRate};

/// The strokes of a chain, and how far they are.
#[derive(Debug)]
pub(super) struct Chained {
    chain: Chain,
    /// Strokes that are checked, and strokes that are planned.
    checked: usize,
    planned: usize,
}

impl Chained {
    /// No stroke.
    pub(super) const fn new() -> Self {
        Self {
            chain: Chain::new(),
            checked: 0,
            planned: 0,
        }
    }

    /// Forgets all strokes.
    pub(super) fn begin_anew(&mut self) {
        self.chain.clear();
        (self.checked, self.planned) = (0, 0);
    }

    /// The last stroke is here, and not all of them are planned.
    pub(super) const fn is_whole(&self) -> bool {
        self.chain.is_whole()
    }

    /// False where a call of this part cannot come now.
    pub(super) fn admits(&self, part: ChainPart) -> bool {
        self.chain.admits(part)
    }

    /// Takes the next move of a stroke.
    pub(super) fn take(&mut self, from: Position, next: &Move, number: u32) -> Result<(), Alarm> {
        self.chain.push(from, next, number)
    }
}

impl Planner {
    /// Checks or plans one stroke.
    #[inline(never)]
    pub(super) fn go_on_with_chain(&mut self, settings: &Settings<'_>) -> Result<(), Alarm> {
        let Some(last) = self.chain.chain.last() else {
            self.chain.begin_anew();
            return Ok(());
        };
        let rpm = match &last.kind {
            MoveKind::Thread(thread) => overridden(thread.rpm, self.percent),
            _ => Rpm::STOPPED,
        };
        let (params, speed) = (settings.params, TurnRate::of_rpm(rpm));
        let count = self.chain.chain.len();
        if self.chain.checked < count {
            let index = self.chain.checked;
            self.chain.checked = index.saturating_add(1);
            return self.chain.chain.examine(index, params, None, speed);
        }
        let index = self.chain.planned;
        let made = self.chain.chain.plan(index, params, None, speed);
        let plan = match &made {
            Ok(plan) => plan,
            Err(alarm) => return Err(*alarm),
        };
        self.chain.planned = index.saturating_add(1);
        let is_last = self.chain.planned == count;
        let Some((number, _)) = self.chain.chain.place(index) else {
            return Ok(());
        };
        // A stroke begins where the tool is, and the tool stays where it ends.
        let home = self.chain.chain.start(index);
        let ways = WaysOut::new(plan, home, Length::ZERO, params.thread_clearance());
        self.cut.last = is_last;
        self.put_pass(number, plan, ways, rpm, &last, settings)?;
        self.complete = true;
        if is_last {
            self.chain.begin_anew();
        }
        Ok(())
    }
}
