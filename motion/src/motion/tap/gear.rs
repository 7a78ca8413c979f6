//! The gear of a tap: the spindle angle as a pure function of the axis position.
//!
//! This module knows a lead, a hand and a level; it knows nothing of time.

use crate::call::{Hand, Position, TapAxis};
use crate::motion::wide::mul_div_up;
use crate::units::{Lead, Length, Turns, mul_high, narrow_div, product, signed, signed_product};

/// Turns of the spindle for a position of the tap axis, counted from the R plane: `±|p − p_R| / lead`. The sign is plus
/// into the hole for a right-hand tap [G84/G88 sheet].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Gear {
    axis: TapAxis,
    level: Length,
    lead: Lead,
    /// 2⁻³² turns per nanometre, in 2^−`shift`, rounded up.
    factor: u64,
    shift: u32,
    /// A coordinate above the level has a negative angle.
    falling: bool,
    /// The bottom lies at a smaller coordinate than the level.
    downwards: bool,
}

impl Gear {
    /// The gear of a hole with its R plane at `level`. The bottom lies `inward` (−1 or +1) of this plane. `None` for a
    /// lead beyond 2³⁰ m or below 2⁻³⁰ nm a turn.
    #[must_use]
    pub fn new(axis: TapAxis, level: Length, inward: i64, lead: Lead, hand: Hand) -> Option<Self> {
        let (nm, turns) = (lead.numerator(), lead.denominator());
        let (short, room) = (nm.leading_zeros(), turns.leading_zeros());
        // The factor turns · 2³² / nm has 62 to 64 bits. It is computed as turns in 63 bits, times the highest bit of
        // nm, over nm. Both numbers are not negative, so each has a bit to spare.
        let shift = 30_u32.wrapping_add(room).checked_sub(short)?;
        if shift > 90 {
            return None;
        }
        let scaled = turns.wrapping_shl(room.wrapping_sub(1)) as u64;
        let factor = mul_div_up(scaled, (1_u64 << 63).wrapping_shr(short), nm as u64);
        Some(Self {
            axis,
            level,
            lead,
            factor,
            shift,
            falling: (inward < 0) == (hand == Hand::Right),
            downwards: inward < 0,
        })
    }

    /// The axis that travels.
    #[must_use]
    pub const fn axis(&self) -> TapAxis {
        self.axis
    }

    /// The R plane.
    #[must_use]
    pub const fn level(&self) -> Length {
        self.level
    }

    /// `position` with the tap axis `depth` below R.
    #[must_use]
    pub(super) fn place(&self, position: Position, depth: Length) -> Position {
        let at = if self.downwards {
            self.level - depth
        } else {
            self.level + depth
        };
        self.axis.with(position, at)
    }

    /// Depth of `position` below R; negative above R.
    #[must_use]
    pub fn depth(&self, position: Position) -> Length {
        let way = self.axis.of(position) - self.level;
        if self.downwards { -way } else { way }
    }

    /// Turns from R to `position`, rounded towards zero to 2⁻³² turns; exact if the turns are a whole number of 2⁻³²
    /// turns. Before rounding the value may be too large by 2⁻⁶¹ of itself, so a value this close to the next 2⁻³²
    /// turns becomes that value. No division, for use in the tick.
    #[must_use]
    pub fn turns(&self, position: Position) -> Turns {
        let way = (self.axis.of(position) - self.level).nm();
        if way == 0 {
            // A tap begins here, in a tick that already has much to do.
            return Turns::ZERO;
        }
        let size = way.unsigned_abs();
        // way · factor / 2^shift. The factor has at least 62 bits and is too large by less than 1. So the product
        // exceeds the exact one by less than 2⁻⁶¹ of itself: by less than one unit wherever the lead is above 8 µm and
        // the way below 2⁴³.
        let magnitude = if self.shift >= 64 {
            mul_high(size, self.factor).wrapping_shr(self.shift.wrapping_sub(64))
        } else if self.shift >= 44 && size < 1 << 44 {
            // The quick way for all leads above 16 µm: it does not compute the low bits that the shift would drop.
            mul_high(
                size.wrapping_shl(64_u32.wrapping_sub(self.shift)),
                self.factor,
            )
        } else {
            let wide = product(size, self.factor);
            (wide >> self.shift) as u64
        };
        let magnitude = signed(magnitude);
        if (way < 0) == self.falling {
            Turns::from_raw(magnitude)
        } else {
            Turns::from_raw(magnitude.wrapping_neg())
        }
    }

    /// The position of the tap axis at this number of turns from R, rounded to the nearest nanometre. This is the
    /// inverse, for checks. It has a 128-bit division, so it is not for the tick.
    #[must_use]
    pub fn position(&self, turns: Turns) -> Length {
        let scaled = signed_product(turns.raw(), self.lead.numerator());
        let turns = self.lead.parts().1;
        let unit = u128::from(turns) << 32;
        let above = scaled.wrapping_add((unit >> 1) as i128);
        // Rounded down, below zero too.
        let rounding = if above < 0 { unit.wrapping_sub(1) } else { 0 };
        let way = narrow_div(above.unsigned_abs().wrapping_add(rounding) >> 32, turns);
        let way = Length::from_nm(signed(way));
        let way = if above < 0 { -way } else { way };
        if self.falling {
            self.level - way
        } else {
            self.level + way
        }
    }
}

/// The line on which axis and spindle of a hole are in every tick: the gear, and the spindle's angle at R.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TapLine {
    /// The gear.
    pub gear: Gear,
    /// Commanded spindle angle at R.
    pub origin: Turns,
}

impl TapLine {
    /// The line through a position and an angle.
    #[must_use]
    pub fn through(gear: Gear, position: Position, angle: Turns) -> Self {
        Self {
            gear,
            origin: angle - gear.turns(position),
        }
    }

    /// The angle at a position.
    #[must_use]
    pub fn angle(&self, position: Position) -> Turns {
        self.origin + self.gear.turns(position)
    }

    /// The tap axis' distance from its exact position for a spindle angle.
    #[must_use]
    pub fn error(&self, position: Position, angle: Turns) -> Length {
        self.gear.axis.of(position) - self.gear.position(angle - self.origin)
    }
}
