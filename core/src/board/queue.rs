//! The single-producer queues between the two contexts.
//!
//! What is bound to the spindle has a plan several times as large as a segment, and few of the segments queued at a time
//! are such: so there are two queues, one of segments and one of [plans](Plan), in the same order [D139]. A plan is put in
//! before the segment it belongs to and goes with it: where the oldest segment is [`Action::Planned`], the oldest plan is
//! its own.

use heapless::spsc::{Consumer, Producer, Queue};

use super::event::Event;
use crate::motion::{Action, Plan, Segment, Task};
use crate::program::Call;

/// Calls a board holds; one place of a ring stays empty.
pub const CALLS: usize = 4;
/// Segments planned ahead, the one under way and the place that stays empty.
pub const SEGMENTS: usize = 9;
/// Plans among them: one under way, the next, and the place that stays empty. A stroke begins when what follows it is in
/// the queue: for strokes of a thread that follow each other without a move between them, the next one.
pub const PLANS: usize = 3;
/// Segments of a detour: two legs and the mark behind them, what may be left of the detour before, and the place that
/// stays empty. The tick drops what is left before it begins a leg.
pub const DETOURS: usize = 7;
/// Events not yet read, and the place that stays empty. Each segment makes two at
/// most, and while the background plans, which is the longest it does without
/// reading, no more than the segments queued are begun; what is left is for a stop.
pub const EVENTS: usize = 2 * (SEGMENTS - 1) + 4;

/// Calls on their way to the background.
pub type Calls = Queue<Call, CALLS>;
/// Segments of a detour on their way to the tick; none of them has a plan.
pub type Detours = Queue<Segment, DETOURS>;
/// Events on their way out.
pub type Events = Queue<Event, EVENTS>;

/// The background's end of the calls.
pub type CallOut<'a> = Consumer<'a, Call>;
/// The background's end of the detours.
pub type DetourIn<'a> = Producer<'a, Segment>;
/// The tick's end of the detours.
pub type DetourOut<'a> = Consumer<'a, Segment>;
/// The tick's end of the events.
pub type EventIn<'a> = Producer<'a, Event>;

/// Segments on their way to the tick, with their plans.
#[derive(Debug)]
pub struct Segments {
    segments: Queue<Segment, SEGMENTS>,
    plans: Queue<Plan, PLANS>,
}

/// The background's end of the segments.
pub struct SegmentIn<'a> {
    segments: Producer<'a, Segment>,
    plans: Producer<'a, Plan>,
}

/// The tick's end of the segments.
pub struct SegmentOut<'a> {
    segments: Consumer<'a, Segment>,
    plans: Consumer<'a, Plan>,
}

impl Segments {
    /// None yet.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            segments: Queue::new(),
            plans: Queue::new(),
        }
    }

    /// The two ends.
    pub fn split(&mut self) -> (SegmentIn<'_>, SegmentOut<'_>) {
        let (segments_in, segments_out) = self.segments.split();
        let (plans_in, plans_out) = self.plans.split();
        (
            SegmentIn {
                segments: segments_in,
                plans: plans_in,
            },
            SegmentOut {
                segments: segments_out,
                plans: plans_out,
            },
        )
    }

    /// The oldest one.
    #[must_use]
    pub fn peek(&self) -> Option<Task<'_>> {
        let segment = self.segments.peek()?;
        Some(task(segment, || self.plans.peek()))
    }

    /// True where there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.segments.is_empty()
    }
}

impl Default for Segments {
    fn default() -> Self {
        Self::new()
    }
}

impl SegmentIn<'_> {
    /// How many segments still have room.
    #[must_use]
    pub fn room(&self) -> usize {
        room(&self.segments)
    }

    /// True where a plan has room, too.
    #[must_use]
    pub fn takes_plan(&self) -> bool {
        room(&self.plans) > 0
    }

    /// How many segments there are.
    #[must_use]
    pub fn filled(&self) -> usize {
        filled(&self.segments)
    }

    /// Puts a plan in: that of the next segment that has one. False where there is no room.
    #[must_use]
    pub fn put_plan(&mut self, plan: &Plan) -> bool {
        put(&mut self.plans, *plan).is_ok()
    }

    /// Puts a segment in. False where there is no room.
    #[must_use]
    pub fn put(&mut self, segment: &Segment) -> bool {
        put(&mut self.segments, *segment).is_ok()
    }
}

impl SegmentOut<'_> {
    /// The oldest one.
    #[must_use]
    pub fn peek(&self) -> Option<Task<'_>> {
        let segment = self.segments.peek()?;
        Some(task(segment, || self.plans.peek()))
    }

    /// Lets the oldest one go, its plan with it.
    pub fn take(&mut self) {
        // Looked at before it goes: taken out to be looked at it would be copied.
        let planned = self
            .head()
            .is_some_and(|oldest| matches!(oldest.action, Action::Planned));
        drop_oldest(&mut self.segments);
        if planned {
            drop_oldest(&mut self.plans);
        }
    }

    /// The oldest one, without its plan.
    #[must_use]
    pub fn head(&self) -> Option<&Segment> {
        self.segments.peek()
    }

    /// Lets all of them go, and every plan. Nothing is put in meanwhile.
    pub fn clear(&mut self) {
        while take(&mut self.segments).is_some() {}
        while take(&mut self.plans).is_some() {}
    }

    /// True where something waits behind the oldest one.
    #[must_use]
    pub fn has_second(&self) -> bool {
        self.segments.capacity() != usize::MAX && self.segments.len() > 1
    }
}

fn task<'a>(segment: &'a Segment, plan: impl FnOnce() -> Option<&'a Plan>) -> Task<'a> {
    let plan = match segment.action {
        Action::Planned => plan(),
        _ => None,
    };
    Task { segment, plan }
}

// The ends do not carry the size of their ring in their type, and heapless divides by it. Each function below first says
// that it is not zero (a ring of no places would have a capacity of −1), so that no panic is left to be reached.

/// Puts `value` into a queue, or gives it back where there is no room.
pub fn put<T>(queue: &mut Producer<'_, T>, value: T) -> Result<(), T> {
    if queue.capacity() == usize::MAX {
        return Err(value);
    }
    queue.enqueue(value)
}

/// How many entries a producer's queue holds.
pub fn filled<T>(queue: &Producer<'_, T>) -> usize {
    queue.capacity().saturating_sub(room(queue))
}

/// Takes the oldest entry.
pub fn take<T>(queue: &mut Consumer<'_, T>) -> Option<T> {
    if queue.capacity() == usize::MAX {
        return None;
    }
    queue.dequeue()
}

/// Lets the oldest entry go where it is.
#[inline(always)]
fn drop_oldest<T: Copy>(queue: &mut Consumer<'_, T>) {
    if queue.ready() && queue.capacity() != usize::MAX {
        let _ = queue.dequeue();
    }
}

/// How many entries still have room.
pub fn room<T>(queue: &Producer<'_, T>) -> usize {
    let capacity = queue.capacity();
    if capacity == usize::MAX {
        return 0;
    }
    capacity.saturating_sub(queue.len())
}
