//! The tap axis' position at a spindle angle: a pure function of the angle, without any state.

use crate::call::{Hand, Position};
use crate::motion::ease::whole;
use crate::motion::ease::{Ease, Fine};
use crate::motion::lead::turns_of;
use crate::motion::tap::Gear;
use crate::motion::thread::HelixTravel;
use crate::units::{Lead, Length, Turns};

/// The part of the law to which an angle belongs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Region {
    /// At rest at R: the helix is above it.
    Out,
    /// Moving onto the helix, or leaving it.
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
    /// A left-hand tap: the angle falls on the way in.
    reverse: bool,
    travel: HelixTravel,
    /// From R to the bottom.
    length: Fine,
    join: Ease,
    brake: Ease,
}

impl Law {
    /// The law of a hole `depth` deep, with its gear and eases.
    #[inline(never)]
    pub(super) fn new(
        gear: &Gear,
        hand: Hand,
        lead: Lead,
        depth: Length,
        join: &Ease,
        brake: &Ease,
    ) -> Self {
        let length = depth.nm().wrapping_shl(16);
        let joined = turns_of(lead, join.half());
        let done = turns_of(lead, length.wrapping_add(brake.half()));
        Self {
            gear: *gear,
            reverse: hand == Hand::Left,
            travel: HelixTravel::new(lead, joined, done, 0),
            length,
            join: *join,
            brake: *brake,
        }
    }

    /// The angle, inwards, of the ease at R: from R's own angle to the angle at which the axis is on the helix. Rounded
    /// up.
    pub(super) fn join_turns(&self) -> i64 {
        // `low` is one turn further out.
        self.travel.low.raw().saturating_neg().wrapping_sub(1 << 32)
    }

    /// H, and the distance before and after the bottom to which the rounding reaches.
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
        let place = self.gear.place(Position::ZERO, depth);
        self.inward(self.gear.turns(place)).raw()
    }

    /// The helix' travel for an angle since it was at R, limited to a turn around the hole.
    pub(super) fn travel(&self, angle: Turns) -> Fine {
        self.travel.at(angle)
    }

    /// The axis' depth below R when the helix has travelled `travel`.
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
        self.gear.place(place, whole(way))
    }
}
