//! The single-producer queues between the two contexts.

use heapless::spsc::{Consumer, Producer, Queue};

use super::event::Event;
use crate::motion::Segment;
use crate::program::Call;

/// Calls a board holds; one place of a ring stays empty.
pub const CALLS: usize = 4;
/// Segments planned ahead.
pub const SEGMENTS: usize = 8;
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
