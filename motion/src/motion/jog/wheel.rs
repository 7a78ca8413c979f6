//! An axis that a handwheel leads.
//!
//! ```text
//! how far the wheel is turned ─► (within the travel, at most so fast) ─► target ─► two running means ─► position
//! ```
//!
//! The target moves at most at the speed of the press and never leaves the travel. A mean never leaves the range of what it
//! is made of, so neither does the position; and it loses nothing, so the axis comes to rest exactly on the target. What
//! cannot be moved is dropped where the wheel is turned against the end of the travel, and where the target is too far
//! behind the wheel [D312].
//!
//! Must not know counts, or what one of them is worth.

use super::{AxisPress, AxisTravel, JogAxis, Press};
use crate::operating::Towards;
use crate::units::Length;

/// How a handwheel leads an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wheel {
    /// How far the target may be behind the wheel. What is beyond that is dropped.
    pub lag: Length,
    /// The operator is told where something is dropped.
    pub warns: bool,
}

/// What the wheel asks of an axis in this tick.
pub(super) struct Turned<'a> {
    wanted: &'a AxisPress,
    /// How far it is turned since its claim.
    way: Length,
    wheel: Wheel,
}

impl<'a> Turned<'a> {
    /// What a press asks of an axis, if it is a wheel that leads this one.
    pub(super) fn of(wanted: Option<&'a AxisPress>, press: Option<&Press>) -> Option<Self> {
        let press = press?;
        Some(Self {
            wanted: wanted?,
            way: press.way?,
            wheel: press.wheel?,
        })
    }
}

/// The motion of an axis that a wheel leads. Ways in 1/256 nm, with their sign.
#[derive(Debug)]
pub(super) struct Follower {
    /// How much of the wheel's way is in the target, or dropped.
    taken: i64,
    /// How far the target is from where this motion began.
    target: i64,
    /// Ticks until the means are empty; 0: the axis stands.
    left: u32,
    /// The operator has been told.
    warned: bool,
}

impl Follower {
    pub(super) const NEW: Self = Self {
        taken: 0,
        target: 0,
        left: 0,
        warned: false,
    };

    /// The way of the wheel counts from here. What is under way goes on.
    pub(super) const fn begin_claim(&mut self) {
        self.taken = 0;
        self.warned = false;
    }

    /// How far its target is from where this motion began, rounded away from there, while it leads the axis.
    pub(super) fn target(&self) -> Option<Length> {
        let nm = self.target.unsigned_abs().div_ceil(256);
        let way = Length::from_nm(i64::try_from(nm).unwrap_or(i64::MAX));
        self.is_under_way().then(|| way.times(self.target.signum()))
    }

    pub(super) const fn is_under_way(&self) -> bool {
        self.left > 0
    }

    /// How far the target moves in this tick, if the axis may go `[back, on]` from it; and whether something is dropped
    /// that the operator has to know of.
    fn aim(&mut self, turned: &Turned<'_>, [back, on]: [i64; 2]) -> (i32, bool) {
        let ahead = units(turned.way).saturating_sub(self.taken);
        let lag = units(turned.wheel.lag).max(0);
        let near = ahead.clamp(lag.saturating_neg(), lag);
        let drops = near != ahead && turned.wheel.warns && !self.warned;
        self.warned |= drops;
        let kept = near.max(back.saturating_neg()).min(on);
        let most = i64::from(turned.wanted.speed.raw());
        // Within 31 bits, as the speed is.
        let step = kept.clamp(most.saturating_neg(), most);
        self.taken = units(turned.way).saturating_sub(kept).saturating_add(step);
        self.target = self.target.saturating_add(step);
        (step as i32, drops)
    }
}

impl JogAxis {
    /// One tick of an axis that a wheel leads, or has led. True where the operator has to know that counts were dropped.
    // Both axes call it.
    #[inline(never)]
    pub(super) fn follow(
        &mut self,
        at: &mut Length,
        turned: Option<&Turned<'_>>,
        travel: &AxisTravel,
    ) -> bool {
        if !self.moves {
            let begins = turned.is_some_and(|turned| {
                units(turned.way) != self.follower.taken
                    && self.profile.begin_open(turned.wanted.ramp)
            });
            if !begins {
                return false;
            }
            (self.moves, self.from, self.follower.target) = (true, *at, 0);
        }
        let mut step = (0, false);
        if let Some(turned) = turned {
            let target = units(self.from).saturating_add(self.follower.target);
            // No way where the axis is beyond its travel already.
            let free = |towards| match towards {
                Towards::Minus => target.saturating_sub(units(travel.low)).max(0),
                Towards::Plus => units(travel.high).saturating_sub(target).max(0),
            };
            let room = [Towards::Minus, Towards::Plus].map(free);
            step = self.follower.aim(turned, room);
        }
        let (input, drops) = step;
        self.follower.left = match input {
            0 => self.follower.left.saturating_sub(1),
            _ => self.profile.ticks_of_ramp(),
        };
        let gone = self.profile.put_in_signed(input);
        // Whole nanometres, rounded to the nearest.
        *at = self.from + Length::from_nm(gone.saturating_add(1 << 15) >> 16);
        self.moves = self.follower.is_under_way();
        drops
    }
}

/// In 1/256 nm.
const fn units(length: Length) -> i64 {
    length.nm().saturating_mul(256)
}
