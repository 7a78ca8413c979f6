//! The choices that a tapping program may leave to the machine's signals: hand and spindle ([G84/G88 sheet]). The answers
//! of the signals are in [`Signals`](crate::signals::Signals).

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

use super::tapper::{Hand, TapSpindle};

/// The source that decides the hand of a tap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, Schema)]
pub enum HandChoice {
    /// The program does: S is negative.
    Written(Hand),
    /// Signal G61.2: S is positive.
    #[default]
    Signal,
}

/// The signals that select a spindle (5200.7).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, Schema)]
pub enum Selection {
    /// SWS1–SWS4.
    #[default]
    Sws,
    /// RGTSP1–RGTSP4.
    Rgtsp,
}

/// The source that selects the tapping spindle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, Schema)]
pub enum SpindleChoice {
    /// E does.
    Written(TapSpindle),
    /// The selection signals do.
    Signals {
        /// Which of them.
        by: Selection,
        /// Where none is on: M24–M27, or spindle 1.
        otherwise: TapSpindle,
    },
}

impl Default for SpindleChoice {
    /// No E, no M24–M27, 5200.7 = 0.
    fn default() -> Self {
        Self::Signals {
            by: Selection::Sws,
            otherwise: TapSpindle::First,
        }
    }
}
