//! The background's orders to the tick, from their queue to the report that they are carried out.

use crate::board::planner::Calls;
use crate::call::Call;
use crate::motion::Epoch;
use crate::tick::queue::{put, room};
use crate::tick::{BackgroundEnds, Order};

/// The most orders that one piece of work asks for.
const SPARE: usize = 3;

/// Orders are numbered. The numbers wrap; far fewer are on their way at a time.
#[derive(Debug, Default)]
pub(super) struct Orders {
    /// The number of the last one.
    asked: u32,
    /// The number of the last one that the tick has reported as carried out.
    done: u32,
    /// The order to begin anew, until it is carried out.
    anew: Option<u32>,
    /// The last order that begins a program, until it is carried out.
    program: Option<u32>,
}

impl Orders {
    /// The tick has carried out this number of orders. True where the application has begun anew with that.
    pub(super) fn hear(&mut self, done: u32) -> bool {
        self.done = done;
        let outstanding = self.asked.wrapping_sub(done);
        let waits = |number: &u32| {
            let ahead = number.wrapping_sub(done);
            ahead != 0 && ahead <= outstanding
        };
        self.program = self.program.filter(waits);
        let asked = self.anew.is_some();
        self.anew = self.anew.filter(waits);
        asked && self.anew.is_none()
    }

    /// An order has not been carried out.
    pub(super) const fn wait(&self) -> bool {
        self.asked != self.done
    }

    /// The order to begin anew has not been carried out.
    pub(super) const fn begin_anew(&self) -> bool {
        self.anew.is_some()
    }

    /// An order that begins a program has not been carried out.
    pub(super) const fn begin_program(&self) -> bool {
        self.program.is_some()
    }

    /// Gives an order. The caller has seen that there is [room](has_room).
    pub(super) fn give(&mut self, ends: &mut BackgroundEnds<'_>, order: Order) {
        if put(&mut ends.orders, order).is_err() {
            return;
        }
        self.asked = self.asked.wrapping_add(1);
        match order {
            Order::BeginAnew => self.anew = Some(self.asked),
            Order::ProgramBegins { .. } => self.program = Some(self.asked),
            _ => {}
        }
    }

    /// Hands a call over to the planner; `typed`: it is of a line that was typed. Returns false and changes nothing where
    /// there is no room.
    pub(super) fn offer(
        &mut self,
        ends: &mut BackgroundEnds<'_>,
        calls: &mut Calls,
        (epoch, typed): (Epoch, bool),
        call: &Call,
    ) -> bool {
        let taken = has_room(ends) && calls.enqueue(*call).is_ok();
        if taken {
            self.give(ends, Order::ProgramBegins { epoch, typed });
        }
        taken
    }
}

/// True where there is room for the orders of one piece of work.
pub(super) fn has_room(ends: &BackgroundEnds<'_>) -> bool {
    room(&ends.orders) >= SPARE
}
