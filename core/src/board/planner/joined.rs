//! Cuts that are joined to others (G64): when they wait, and when they leave for the queue.
//!
//! A cut leaves with all that is known of the way after it. So it waits until the window of [`Lookahead`] is full, or until
//! something follows that begins with a stop, or until the tick would have nothing to do otherwise.

use super::Settings;
use crate::call::{Call, CallKind};
use crate::lookahead::{Due, Lookahead};
use crate::motion::{Segment, Timed};
use crate::tick::queue::SegmentIn;

/// With fewer segments than these, the tick soon has nothing to do.
const FEW: usize = 2;
/// Where the tick stands still: how long the first cuts wait for more, as a part of a second. A gateway sends its calls
/// within this time.
const PATIENCE: u32 = 20;

/// The cuts that wait.
#[derive(Debug)]
pub(super) struct Joined {
    lookahead: Lookahead,
    due: Due,
    /// G61: nothing is joined.
    exact: bool,
    /// When the newest cut came.
    came: u32,
}

/// True for a call that the cuts before it may flow into.
pub(super) const fn goes_on(call: &Call) -> bool {
    matches!(call.kind, CallKind::Line(..) | CallKind::Arc(_))
}

impl Joined {
    /// None, and G64.
    // [D146]
    #[inline(always)]
    pub(super) const fn new() -> Self {
        Self {
            lookahead: Lookahead::new(),
            due: Due::NONE,
            exact: false,
            came: 0,
        }
    }

    /// Drops everything; G64.
    pub(super) fn begin_anew(&mut self) {
        self.lookahead.clear();
        self.exact = false;
    }

    /// G61 (true) or G64.
    pub(super) const fn set_exact(&mut self, exact: bool) {
        self.exact = exact;
    }

    /// Something else than a cut goes into the queue. No cut may wait.
    pub(super) const fn interrupt(&mut self) {
        self.lookahead.interrupt();
    }

    /// True where no cut waits.
    pub(super) fn is_empty(&self) -> bool {
        self.lookahead.is_empty()
    }

    /// True for a cut that waits here to be joined to others.
    pub(super) fn takes(&self, timed: &Timed, settings: &Settings<'_>) -> bool {
        !self.exact && Lookahead::joins(timed, settings.limits)
    }

    /// Takes a cut. False where there is no room: [`must_leave`](Self::must_leave) comes first.
    #[must_use]
    pub(super) fn push(&mut self, segment: &Segment, settings: &Settings<'_>) -> bool {
        self.came = settings.now;
        self.lookahead.push(segment, settings.limits)
    }

    /// True where the oldest cut has to leave before anything else is planned.
    pub(super) fn must_leave(&self) -> bool {
        self.lookahead.is_full()
    }

    /// The oldest cut leaves, and the way after the window goes on. False where the queue has no room.
    pub(super) fn leave(&mut self, segments: &mut SegmentIn<'_>, settings: &Settings<'_>) -> bool {
        self.hand_over(segments, settings, false)
    }

    /// The oldest cut leaves, and after the window comes a stop. False where the queue has no room.
    pub(super) fn close(&mut self, segments: &mut SegmentIn<'_>, settings: &Settings<'_>) -> bool {
        self.hand_over(segments, settings, true)
    }

    /// No call has come: the oldest cut leaves if the tick would have nothing to do soon. False where it waits.
    pub(super) fn wait(&mut self, segments: &mut SegmentIn<'_>, settings: &Settings<'_>) -> bool {
        let patience = 1_000_000_u32
            .checked_div(settings.limits.tick_us())
            .unwrap_or(0)
            / PATIENCE;
        let stands = segments.filled() == 0;
        !self.is_empty()
            && segments.filled() < FEW
            && (!stands || settings.now.wrapping_sub(self.came) >= patience)
            && self.leave(segments, settings)
    }

    #[inline(never)]
    fn hand_over(
        &mut self,
        segments: &mut SegmentIn<'_>,
        settings: &Settings<'_>,
        closed: bool,
    ) -> bool {
        if segments.room() == 0 || !segments.takes_cut() {
            return false;
        }
        if !self.lookahead.pop(settings.limits, closed, &mut self.due) {
            return false;
        }
        // The queues have room. The segment goes first: the tick never is ahead of it.
        if let Some(segment) = &self.due.segment {
            let _ = segments.put(segment);
        }
        for stretch in &self.due.stretches {
            let _ = segments.put_stretch(stretch);
        }
        true
    }
}
