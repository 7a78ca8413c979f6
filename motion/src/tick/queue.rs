//! The single-producer queues between the two contexts.
//!
//! A segment that follows the spindle has a plan, which is several times as large as a segment, and only few segments in
//! the queue have one. So there are two queues in the same order: one of segments and one of [plans](Plan) [D139]. A plan
//! is put in before its segment and removed together with it: if the oldest segment is [`Action::Planned`], the oldest plan
//! belongs to it.
//!
//! The way of joined cuts is a third queue, of [stretches](Stretch). The tick takes them ahead of the tool, so a stretch
//! leaves its queue before its segment leaves its own. A segment is put in before its stretches.

use heapless::spsc::{Consumer, Producer, Queue};

use crate::motion::{Action, CUTS_AHEAD, Plan, STRETCHES_OF_A_CUT, Segment, Stretch, Task};
use crate::tick::Event;

/// Segments: those planned ahead, the one under way, and the place that stays empty. Where many short cuts are joined, all
/// those between the profile's input and the tool are here.
pub const SEGMENTS: usize = 32;
const _: () = assert!(
    (CUTS_AHEAD as usize) < SEGMENTS - 2,
    "the ramp of joined cuts counts on them"
);
/// Stretches of joined cuts. Most cuts have one to three.
pub const STRETCHES: usize = 64;
/// Plans: the one under way, the next, and the place that stays empty. A stroke begins only when the segment after it is in
/// the queue. For strokes of a thread without a move between them, this is the next stroke.
pub const PLANS: usize = 3;
/// Segments of a detour: two legs and the mark after them, the rest of an earlier detour, and the place that stays empty.
/// The tick drops the rest before it begins a leg.
pub const DETOURS: usize = 7;
/// Events that are not read yet, and the place that stays empty. A segment makes at most two events. The longest time
/// without reading is while the background plans; in this time, only segments that are already in the queue begin. The
/// other places are for a stop.
pub const EVENTS: usize = 2 * (SEGMENTS - 1) + 4;

/// Segments of a detour on their way to the tick. None of them has a plan.
pub type Detours = Queue<Segment, DETOURS>;
/// Events on their way to the owner.
pub type Events = Queue<Event, EVENTS>;

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
    stretches: Queue<Stretch, STRETCHES>,
}

/// The background's end of the segments.
pub struct SegmentIn<'a> {
    segments: Producer<'a, Segment>,
    plans: Producer<'a, Plan>,
    stretches: Producer<'a, Stretch>,
}

/// The tick's end of the segments.
pub struct SegmentOut<'a> {
    segments: Consumer<'a, Segment>,
    plans: Consumer<'a, Plan>,
    stretches: Consumer<'a, Stretch>,
}

impl Segments {
    /// Empty queues.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            segments: Queue::new(),
            plans: Queue::new(),
            stretches: Queue::new(),
        }
    }

    /// The two ends.
    pub fn split(&mut self) -> (SegmentIn<'_>, SegmentOut<'_>) {
        let (segments_in, segments_out) = self.segments.split();
        let (plans_in, plans_out) = self.plans.split();
        let (stretches_in, stretches_out) = self.stretches.split();
        (
            SegmentIn {
                segments: segments_in,
                plans: plans_in,
                stretches: stretches_in,
            },
            SegmentOut {
                segments: segments_out,
                plans: plans_out,
                stretches: stretches_out,
            },
        )
    }

    /// The oldest segment, with its plan.
    #[must_use]
    pub fn peek(&self) -> Option<Task<'_>> {
        let segment = self.segments.peek()?;
        Some(task(segment, || self.plans.peek()))
    }

    /// True where there is no segment.
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
    /// Free places for segments.
    #[must_use]
    pub fn room(&self) -> usize {
        room(&self.segments)
    }

    /// True where there is a free place for a plan.
    #[must_use]
    pub fn takes_plan(&self) -> bool {
        room(&self.plans) > 0
    }

    /// True where there is room for the stretches of a cut.
    #[must_use]
    pub fn takes_cut(&self) -> bool {
        room(&self.stretches) >= STRETCHES_OF_A_CUT
    }

    /// Appends a stretch. It belongs to the last segment. False where there is no room.
    #[must_use]
    pub fn put_stretch(&mut self, stretch: &Stretch) -> bool {
        put(&mut self.stretches, *stretch).is_ok()
    }

    /// Number of segments.
    #[must_use]
    pub fn filled(&self) -> usize {
        filled(&self.segments)
    }

    /// Appends a plan. It belongs to the next segment that has a plan. False where there is no room.
    #[must_use]
    pub fn put_plan(&mut self, plan: &Plan) -> bool {
        put(&mut self.plans, *plan).is_ok()
    }

    /// Appends a segment. False where there is no room.
    #[must_use]
    pub fn put(&mut self, segment: &Segment) -> bool {
        put(&mut self.segments, *segment).is_ok()
    }
}

impl SegmentOut<'_> {
    /// The oldest segment, with its plan.
    #[inline]
    #[must_use]
    pub fn peek(&self) -> Option<Task<'_>> {
        let segment = self.segments.peek()?;
        Some(task(segment, || self.plans.peek()))
    }

    /// Removes the oldest segment and its plan.
    pub fn take(&mut self) {
        // Looked at while it is in the queue: after removal it would be a copy.
        let planned = self
            .head()
            .is_some_and(|oldest| matches!(oldest.action, Action::Planned));
        drop_oldest(&mut self.segments);
        if planned {
            drop_oldest(&mut self.plans);
        }
    }

    /// The oldest stretch.
    #[must_use]
    pub fn stretch(&self) -> Option<&Stretch> {
        self.stretches.peek()
    }

    /// Removes the oldest stretch.
    pub fn drop_stretch(&mut self) {
        drop_oldest(&mut self.stretches);
    }

    /// The oldest segment without its plan.
    #[must_use]
    pub fn head(&self) -> Option<&Segment> {
        self.segments.peek()
    }

    /// Removes all segments, plans and stretches. Nobody may append meanwhile.
    pub fn clear(&mut self) {
        while take(&mut self.stretches).is_some() {}
        while take(&mut self.segments).is_some() {}
        while take(&mut self.plans).is_some() {}
    }

    /// True where the oldest segment is not the only one.
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

// The ends do not have the size of their ring in their type, and heapless divides by this size. Each function below first
// makes sure that the size is not zero (a ring without places would have a capacity of −1), so that no panic can be
// reached.

/// Appends `value`, or returns it where there is no room.
pub fn put<T>(queue: &mut Producer<'_, T>, value: T) -> Result<(), T> {
    if queue.capacity() == usize::MAX {
        return Err(value);
    }
    queue.enqueue(value)
}

/// Number of entries in a producer's queue.
pub fn filled<T>(queue: &Producer<'_, T>) -> usize {
    queue.capacity().saturating_sub(room(queue))
}

/// Removes and returns the oldest entry.
pub fn take<T>(queue: &mut Consumer<'_, T>) -> Option<T> {
    if queue.capacity() == usize::MAX {
        return None;
    }
    queue.dequeue()
}

/// Removes the oldest entry in place.
#[inline(always)]
pub fn drop_oldest<T: Copy>(queue: &mut Consumer<'_, T>) {
    if queue.ready() && queue.capacity() != usize::MAX {
        let _ = queue.dequeue();
    }
}

/// Number of free places.
pub fn room<T>(queue: &Producer<'_, T>) -> usize {
    let capacity = queue.capacity();
    if capacity == usize::MAX {
        return 0;
    }
    capacity.saturating_sub(queue.len())
}
