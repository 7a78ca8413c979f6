//! A handwheel at the board's own input, and the hand that turns it. Must not know what it leads.

/// A hand turns two detents in ten milliseconds.
const COUNT_US: u32 = 5_000;

/// The wheel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Wheel {
    /// Where it is, in detents.
    count: u16,
    /// How far it is still to be turned.
    left: i32,
    /// Since the last detent.
    time_us: u32,
}

impl Wheel {
    /// It is to be turned by so many detents more.
    pub const fn turn(&mut self, counts: i32) {
        self.left = self.left.saturating_add(counts);
    }

    /// It is being turned.
    #[must_use]
    pub const fn is_turning(&self) -> bool {
        self.left != 0
    }

    /// Where it is after a tick.
    pub const fn tick(&mut self, tick_us: u32) -> u16 {
        if self.left == 0 {
            self.time_us = 0;
            return self.count;
        }
        self.time_us = self.time_us.saturating_add(tick_us);
        while self.time_us >= COUNT_US && self.left != 0 {
            self.time_us = self.time_us.wrapping_sub(COUNT_US);
            let one = self.left.signum();
            self.left = self.left.wrapping_sub(one);
            self.count = self.count.wrapping_add_signed(one as i16);
        }
        self.count
    }
}
