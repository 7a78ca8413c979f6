//! How far the program has come: which segment is under way, which segments still count, and where single block stops.
//!
//! Knows the heads of the two queues. Must not know drives, the spindle or the state of the machine.

use super::super::queue::take;
use super::Ends;
use crate::motion::{Cut, Epoch, Segment, Stops, Stretch, Task};

/// Which queue the segment under way is in. It stays at the head of its queue until it is done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Source {
    /// No segment is under way.
    #[default]
    None,
    /// The program's.
    Program,
    /// The detour's.
    Detour,
}

/// What is under way. Until its end, an empty queue is a wait, not idleness.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Work {
    #[default]
    None,
    /// A line that was typed, of which nothing has been done yet.
    FreshLine,
    /// A program, or a line of which something has been done.
    Program,
}

/// How far the program has come.
#[derive(Debug)]
pub(super) struct Course {
    work: Work,
    source: Source,
    /// Single block has stopped between two segments.
    paused: bool,
    /// Single block stops before the next segment unless that segment belongs to a hole.
    pauses_unless_hole: bool,
    /// Segments of this epoch count. Others were queued before the last restart.
    epoch: Epoch,
    /// The thread or hole of the program's last segment that was carried to its end.
    done: Cut,
}

impl Course {
    /// No program has been seen.
    pub(super) fn new() -> Self {
        Self {
            work: Work::None,
            source: Source::None,
            paused: false,
            pauses_unless_hole: false,
            epoch: Epoch::default(),
            done: Cut::NONE,
        }
    }

    /// The application starts again: the program is forgotten, and what is queued does not count any more. The last thread
    /// or hole stays. Returns the new epoch.
    pub(super) fn begin_anew(&mut self) -> Epoch {
        let epoch = self.drop_queued();
        *self = Self {
            done: self.done,
            epoch,
            ..Self::new()
        };
        epoch
    }

    /// A program begins; `typed`: it is a line that was typed.
    pub(super) const fn begin_program(&mut self, typed: bool) {
        self.work = match self.work {
            Work::None if typed => Work::FreshLine,
            Work::None => Work::Program,
            begun => begun,
        };
    }

    /// Something of it is done from now on.
    pub(super) const fn do_something(&mut self) {
        self.work = Work::Program;
    }

    /// The program has ended, or is given up.
    pub(super) const fn end_program(&mut self) {
        self.work = Work::None;
    }

    /// A program has begun and not ended.
    pub(super) const fn in_program(&self) -> bool {
        !matches!(self.work, Work::None)
    }

    /// A line that was typed has begun, and nothing of it has been done.
    pub(super) const fn in_fresh_line(&self) -> bool {
        matches!(self.work, Work::FreshLine)
    }

    /// The thread or hole of the last segment that was carried to its end without a stop.
    pub(super) const fn done(&self) -> Cut {
        self.done
    }

    /// Segments of this epoch count.
    pub(super) const fn epoch(&self) -> Epoch {
        self.epoch
    }

    /// Segments that are queued now do not count any more, nor those planned before the background has heard of this.
    /// Returns the new epoch.
    pub(super) fn drop_queued(&mut self) -> Epoch {
        self.epoch = self.epoch.next();
        self.epoch
    }

    /// Drops a segment and a stretch that do not count any more, one of each in a tick.
    pub(super) fn drop_stale(&self, ends: &mut Ends<'_>) {
        let epoch = ends.segments.head().map(|oldest| oldest.epoch);
        if epoch.is_some_and(|epoch| epoch != self.epoch) {
            ends.segments.take();
        }
        if let Some(oldest) = ends.segments.stretch()
            && oldest.epoch != self.epoch
        {
            ends.segments.drop_stretch();
        }
    }

    /// The next stretch of joined cuts, if it counts.
    pub(super) fn stretch<'a>(&self, ends: &'a Ends<'_>) -> Option<&'a Stretch> {
        let epoch = self.epoch;
        ends.segments.stretch().filter(|next| next.epoch == epoch)
    }

    /// The oldest segment of the program, if it counts.
    pub(super) fn next<'a>(&self, ends: &'a Ends<'_>) -> Option<&'a Segment> {
        let epoch = self.epoch;
        ends.segments.head().filter(|next| next.epoch == epoch)
    }

    /// The next segment is the retract of a stroke, so the machine must not rest here.
    pub(super) fn must_go_on(&self, ends: &Ends<'_>) -> bool {
        !self.paused
            && ends
                .segments
                .head()
                .is_some_and(|next| next.stops.hold_not_before)
    }

    /// The segment at the head of this queue is under way from now on.
    pub(super) const fn take_from(&mut self, source: Source) {
        self.source = source;
    }

    /// The segment under way belongs to the program.
    pub(super) fn is_in_program_segment(&self) -> bool {
        self.source == Source::Program
    }

    /// The segment under way, with its plan.
    pub(super) fn current<'a>(&self, ends: &'a Ends<'_>) -> Option<Task<'a>> {
        match self.source {
            Source::None => None,
            Source::Program => ends.segments.peek(),
            Source::Detour => ends.detours.peek().map(|segment| Task {
                segment,
                plan: None,
            }),
        }
    }

    /// The program is left: nothing is under way, and nothing begins before the operator lets it go on. Gives the queue of
    /// the segment that was held.
    pub(super) const fn set_aside(&mut self) -> Source {
        self.paused = true;
        core::mem::replace(&mut self.source, Source::None)
    }

    /// Removes the finished segment from its queue. `is_left`: a segment of the program stays, because it is repeated.
    /// `is_whole`: nothing has stopped the segment.
    pub(super) fn release(&mut self, is_left: bool, is_whole: bool, ends: &mut Ends<'_>) {
        match core::mem::take(&mut self.source) {
            Source::None => {}
            Source::Program if is_left => {}
            Source::Program => {
                if let Some(head) = ends.segments.head()
                    && is_whole
                {
                    self.done = head.cut;
                }
                ends.segments.take();
            }
            Source::Detour => {
                take(&mut ends.detours);
            }
        }
    }

    /// Single block has stopped the program.
    pub(super) const fn is_paused(&self) -> bool {
        self.paused
    }

    /// The program stops before the next segment.
    pub(super) const fn pause(&mut self) {
        self.paused = true;
    }

    /// The operator lets the program go on.
    pub(super) const fn resume(&mut self) {
        self.paused = false;
    }

    /// A reset: single block stops nothing any more.
    pub(super) const fn forget_pauses(&mut self) {
        self.paused = false;
        self.pauses_unless_hole = false;
    }

    /// Stops after a segment if single block is on and the segment allows a stop.
    pub(super) const fn pause_after(&mut self, stops: Stops, single_block: bool) {
        if stops.single_block && single_block {
            self.pauses_unless_hole = stops.stops_after_last_hole;
            self.paused = !stops.stops_after_last_hole;
        }
    }

    /// Stops before `next` if single block is on and the segment before it was the last hole of its cycle. Returns true
    /// while stopped.
    pub(super) fn pauses_before(&mut self, next: Stops, single_block: bool) -> bool {
        if core::mem::take(&mut self.pauses_unless_hole) && !next.tap_cycle {
            self.paused = single_block;
        }
        self.paused
    }
}
