//! The single-producer queues between the two contexts.

use heapless::spsc::{Consumer, Producer, Queue};

use super::event::Event;
use crate::motion::Segment;
use crate::program::Call;

/// Calls a board holds; one place of a ring stays empty.
pub const CALLS: usize = 4;
/// Segments planned ahead, the one under way and the place that stays empty.
pub const SEGMENTS: usize = 9;
/// Events not yet read.
pub const EVENTS: usize = 32;

/// Calls on their way to the background.
pub type Calls = Queue<Call, CALLS>;
/// Segments on their way to the tick.
pub type Segments = Queue<Segment, SEGMENTS>;
/// Events on their way out.
pub type Events = Queue<Event, EVENTS>;

/// The background's end of the calls.
pub type CallOut<'a> = Consumer<'a, Call>;
/// The background's end of the segments.
pub type SegmentIn<'a> = Producer<'a, Segment>;
/// The tick's end of the segments.
pub type SegmentOut<'a> = Consumer<'a, Segment>;
/// The tick's end of the events.
pub type EventIn<'a> = Producer<'a, Event>;

// The ends do not carry the size of their ring in their type, and heapless divides by it. Each door below first says
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

/// True where something waits behind the oldest entry.
pub fn has_second<T>(queue: &Consumer<'_, T>) -> bool {
    queue.capacity() != usize::MAX && queue.len() > 1
}

/// Takes the oldest entry.
pub fn take<T>(queue: &mut Consumer<'_, T>) -> Option<T> {
    if queue.capacity() == usize::MAX {
        return None;
    }
    queue.dequeue()
}

/// How many entries still have room.
pub fn room<T>(queue: &Producer<'_, T>) -> usize {
    let capacity = queue.capacity();
    if capacity == usize::MAX {
        return 0;
    }
    capacity.saturating_sub(queue.len())
}
