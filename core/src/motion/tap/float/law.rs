//! Where the tap axis stands at a spindle angle: a pure function of it, without any state.

use crate::motion::ease::{Ease, Fine};
use crate::motion::tap::Gear;
use crate::motion::thread::HelixTravel;
use crate::motion::wide::mul_div_up;
use crate::program::{Hand, Position, TapAxis};
use crate::units::{Lead, Length, Turns, mul_div};

/// Which part of the law an angle belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Region {
    /// At rest at R: the helix is above it.
    Out,
    /// Getting onto the helix, or leaving it.
    Joining,
    /// On the helix.
    Locked,
    /// In the last micrometres before the bottom, or at rest there.
    Bottom,
}

/// The law of one hole.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Law {
    gear: Gear,
    /// The way in is towards minus.
    backward: bool,
    /// A left-hand tap: the way in is a falling angle.
    reverse: bool,
    travel: HelixTravel,
    /// From R to the bottom.
    length: Fine,
    join: Ease,
    brake: Ease,
}

impl Law {
    /// The law of a hole `length` deep. `None` for a lead that cannot be geared.
    #[inline(never)]
    pub(super) fn new(
        axis: TapAxis,
        level: Length,
        bottom: Length,
        lead: Lead,
        hand: Hand,
        join: Ease,
        brake: Ease,
    ) -> Option<Self> {
        let inward = (bottom - level).signum();
        let gear = Gear::new(axis, level, inward, lead, hand)?;
        let (nm, turns) = lead.parts();
        let whole = mul_div(nm, 1, turns);
        let below = nm.wrapping_sub(whole.wrapping_mul(turns));
        let length = (bottom - level).abs().nm().wrapping_shl(16);
        let before = turns_of(lead, join.half()).saturating_add(1 << 32);
        let behind = turns_of(lead, length.saturating_add(brake.half())).saturating_add(1 << 32);
        Some(Self {
            gear,
            backward: inward < 0,
            reverse: hand == Hand::Left,
            travel: HelixTravel {
                low: Turns::from_raw(before.saturating_neg()),
                high: Turns::from_raw(behind),
                lead: (whole, mul_div(below, 1 << 32, turns)),
            },
            length,
            join,
            brake,
        })
    }

    /// The angle, inwards, of the ease at R: from R's own angle to where the axis is on the helix. Rounded up.
    pub(super) fn join_turns(&self) -> i64 {
        // One turn more counts.
        self.travel.low.raw().saturating_neg().wrapping_sub(1 << 32)
    }

    /// H, and how far before and behind the bottom its rounding reaches.
    pub(super) const fn halves(&self) -> (Fine, Fine) {
        (self.join.half(), self.brake.half())
    }

    /// From R to the bottom.
    pub(super) const fn length(&self) -> Fine {
        self.length
    }

    pub(super) const fn gear(&self) -> &Gear {
        &self.gear
    }

    /// An angle counted inwards.
    pub(super) fn inward(&self, angle: Turns) -> Turns {
        if self.reverse { -angle } else { angle }
    }

    /// The angle, inwards, from R to a depth.
    pub(super) fn turns_to(&self, depth: Length) -> i64 {
        let at = if self.backward {
            self.gear.level() - depth
        } else {
            self.gear.level() + depth
        };
        let place = self.gear.axis().with(Position::ZERO, at);
        self.inward(self.gear.turns(place)).raw()
    }

    /// The helix' travel for an angle since it was at R, limited to a turn around the hole.
    pub(super) fn travel(&self, angle: Turns) -> Fine {
        self.travel.at(angle)
    }

    /// How far below R the axis stands where the helix has travelled `travel`.
    pub(super) fn at(&self, travel: Fine) -> (Fine, Region) {
        let join = self.join.half();
        if travel <= join.wrapping_neg() {
            return (0, Region::Out);
        }
        if travel < join {
            return (self.join.at(travel), Region::Joining);
        }
        let left = self.length.wrapping_sub(travel);
        if left >= self.brake.half() {
            return (travel, Region::Locked);
        }
        (
            self.length.wrapping_sub(self.brake.at(left)),
            Region::Bottom,
        )
    }

    /// `place` with the tap axis `way` below R.
    pub(super) fn position(&self, place: Position, way: Fine) -> Position {
        let way = Length::from_nm(way.wrapping_add(1 << 15) >> 16);
        let at = if self.backward {
            self.gear.level() - way
        } else {
            self.gear.level() + way
        };
        self.gear.axis().with(place, at)
    }
}

/// The angle of a travel, rounded up: background work.
fn turns_of(lead: Lead, travel: Fine) -> i64 {
    let (nm, turns) = lead.parts();
    let scaled = mul_div_up(
        travel.max(0).unsigned_abs(),
        turns.saturating_mul(1 << 16),
        nm,
    );
    i64::try_from(scaled).unwrap_or(i64::MAX).min(1 << 61)
}
