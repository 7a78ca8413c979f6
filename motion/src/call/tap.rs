//! The words of a tap and of the way out of a hole, resolved: G84, G88, G30 P99 ([G84/G88 sheet]).

use core::num::NonZeroU8;

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

use super::Position;
use super::choice::{HandChoice, SpindleChoice};
use super::tap_notes::{LengthUnit, TapNotes};
use crate::alarm::At;
use crate::units::{CentiRpm, Lead, Length, Millis};

/// Which tapping cycle [G84/G88 sheet].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum TapCycle {
    /// Face.
    G84,
    /// Side.
    G88,
}

/// The linear axis that carries a tap.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, Schema)]
pub enum TapAxis {
    /// Lead and travel are on the radius.
    X,
    /// Along the spindle.
    Z,
}

impl TapAxis {
    /// The coordinate of this axis.
    #[must_use]
    pub const fn of(self, position: Position) -> Length {
        match self {
            Self::X => position.x,
            Self::Z => position.z,
        }
    }

    /// The other one.
    #[must_use]
    pub const fn other(self) -> Self {
        match self {
            Self::X => Self::Z,
            Self::Z => Self::X,
        }
    }

    /// `position` with this axis at `coordinate`.
    #[must_use]
    pub const fn with(self, mut position: Position, coordinate: Length) -> Position {
        self.set(&mut position, coordinate);
        position
    }

    /// Puts this axis of `position` to `coordinate`.
    pub const fn set(self, position: &mut Position, coordinate: Length) {
        match self {
            Self::X => position.x = coordinate,
            Self::Z => position.z = coordinate,
        }
    }
}

/// How a tap goes down: the three forms of the [G84/G88 sheet].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum TapForm {
    /// At once (Q missing or zero).
    Standard,
    /// High-speed peck (5200.5 = 0): back by d after each infeed.
    HighSpeed(TapPeck),
    /// Deep peck (5200.5 = 1): back to R after each infeed, down again to d above the depth reached.
    Deep(TapPeck),
}

/// The lengths of a peck, on the radius.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct TapPeck {
    /// q: depth of an infeed, positive.
    pub infeed: At<Length>,
    /// d: D word or 5213, not negative, at most q.
    pub back: At<Length>,
}

/// How often a tap call taps, and whether it comes back (K word).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum TapRepeat {
    /// So many holes, 1…99, each `step` from the one before.
    Holes(NonZeroU8),
    /// K198: one hole, and the tap stays at its bottom, locked.
    Stay,
}

/// How a tap's axis is tied to its spindle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, Schema)]
pub enum TapMode {
    /// Rigid: the spindle is in position mode, and one master moves both.
    #[default]
    Rigid,
    /// Ordinary: the spindle turns in speed mode, the axis follows its encoder through stop and reversal, and a floating
    /// holder takes what is left between them.
    Floating,
}

/// G30 P99: the way out of a hole in which a tap was stopped. Which hole, the tap journal says.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct TapReturn {
    /// S: speed of the spindle before the extraction override, above zero; `None`: that of the hole.
    pub speed: Option<CentiRpm>,
    /// The highest speed of a tap (5241, 3772).
    pub highest: CentiRpm,
    /// How far beyond R it goes (5382), not negative.
    pub beyond: Length,
    /// G20 or G21 in force: the hole must have been tapped in the same.
    pub unit: LengthUnit,
}

/// A G84 or G88 with every word resolved: one block, one or more holes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct TapCall {
    /// Which cycle.
    pub cycle: TapCycle,
    /// Rigid or ordinary.
    pub mode: TapMode,
    /// The tap axis (5209.0, plane).
    pub axis: TapAxis,
    /// Where the tool stands: at the initial level, or in the hole where the call goes on after K198.
    pub start: Position,
    /// The first hole, its tap axis where the tool leaves it: at the initial level, or at R.
    pub hole: Position,
    /// From hole to hole: what was written as increments, zero for the rest and for the tap axis.
    pub step: Position,
    /// Coordinate of the R plane on the tap axis.
    pub level: At<Length>,
    /// Coordinate of the bottom on the tap axis.
    pub bottom: At<Length>,
    /// Standard, high-speed peck or deep peck.
    pub form: TapForm,
    /// Dwell at the bottom (P), zero for none.
    pub dwell: Millis,
    /// F/S (G98) or F (G99).
    pub lead: At<Lead>,
    /// By the sign of S, or by signal; in ordinary tapping by M03 or M04.
    pub hand: HandChoice,
    /// Spindle speed of the infeed, above zero (its magnitude). In ordinary tapping zero where the spindle stands: `expand`
    /// does not mind.
    pub speed: CentiRpm,
    /// Spindle speed of retracts and, in deep peck, of the re-entry, above zero: the infeed's with the extraction override.
    pub extract: CentiRpm,
    /// Which spindle turns the tap: by E, by signal, or by M24–M27.
    pub spindle: SpindleChoice,
    /// K.
    pub repeat: TapRepeat,
    /// M: C-axis clamp code before the R plane, its successor after the return.
    pub clamp: Option<u16>,
    /// True where the tap stands in the hole since a K198: it goes on from there.
    pub continues: bool,
    /// For the tap journal.
    pub notes: TapNotes,
}
