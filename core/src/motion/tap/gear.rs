//! The gear of a tap: spindle angle as a pure function of the axis position.
//!
//! Knows a lead, a hand and a level; knows nothing of time.

use crate::motion::wide::mul_div_up;
use crate::program::{Hand, Position, TapAxis};
use crate::units::{Lead, Length, Turns, mul_high, narrow_div, product, signed, signed_product};

/// Turns of the spindle for a position of the tap axis, counted from the R plane: `±|p − p_R| / lead`, plus into the hole
/// for a right-hand tap [G84/G88 sheet].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Gear {
    axis: TapAxis,
    level: Length,
    lead: Lead,
    /// 2⁻³² turns per nanometre, in 2^−`shift`, rounded up.
    factor: u64,
    shift: u32,
    /// A coordinate above the level is a negative angle.
    falling: bool,
    /// The bottom lies at a smaller coordinate than the level.
    downwards: bool,
}

impl Gear {
    /// The gear of a hole whose R plane is at `level` and whose bottom lies `inward` (−1 or +1) of it. `None` for a lead
    /// beyond 2³⁰ m or below 2⁻³⁰ nm a turn.
    #[must_use]
    pub fn new(axis: TapAxis, level: Length, inward: i64, lead: Lead, hand: Hand) -> Option<Self> {
        let (nm, turns) = (lead.numerator(), lead.denominator());
        let (short, room) = (nm.leading_zeros(), turns.leading_zeros());
        // The factor has 62 to 64 bits: turns · 2³² / nm in that many, which is turns in 63 bits times the highest bit
        // of nm over nm. Neither is negative, so that each has a bit to spare.
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

    /// How deep `position` is below R; negative above it.
    #[must_use]
    pub fn depth(&self, position: Position) -> Length {
        let way = self.axis.of(position) - self.level;
        if self.downwards { -way } else { way }
    }

    /// Turns from R to `position`, rounded towards zero to 2⁻³² turns; exact where they are a whole number of those. What
    /// is rounded may be too large by 2⁻⁶¹ of itself, so what is that near to the next 2⁻³² is that. No division: made for
    /// the tick.
    #[must_use]
    pub fn turns(&self, position: Position) -> Turns {
        let way = (self.axis.of(position) - self.level).nm();
        if way == 0 {
            // Where a tap begins, in a tick that has enough to do.
            return Turns::ZERO;
        }
        let size = way.unsigned_abs();
        // way · factor / 2^shift. The factor has 62 bits at least and is less than 1 too large, so
        // the product is above the exact one by less than 2⁻⁶¹ of itself: by less than one
        // unit wherever the lead is above 8 µm and the way below 2⁴³.
        let magnitude = if self.shift >= 64 {
            mul_high(size, self.factor).wrapping_shr(self.shift.wrapping_sub(64))
        } else if self.shift >= 44 && size < 1 << 44 {
            // The quick way for all leads above 16 µm: what is shifted out below need not be made.
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

    /// Where the tap axis would stand at so many turns from R, rounded to the nearest nanometre: the inverse, to judge by.
    /// A 128-bit division: not for the tick.
    #[must_use]
    pub fn position(&self, turns: Turns) -> Length {
        let scaled = signed_product(turns.raw(), self.lead.numerator());
        let turns = self.lead.parts().1;
        let unit = u128::from(turns) << 32;
        let above = scaled.wrapping_add((unit >> 1) as i128);
        // Rounded down, below zero as above it.
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

/// The line on which axis and spindle of a hole are, whatever the tick: the gear, and the spindle's angle at R.
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

    /// How far the tap axis is from where it should stand at a spindle angle.
    #[must_use]
    pub fn error(&self, position: Position, angle: Turns) -> Length {
        self.gear.axis.of(position) - self.gear.position(angle - self.origin)
    }
}
