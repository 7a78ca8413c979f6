//! What the moves of a call depend on beside its words.

use crate::call::Position;
use crate::journal::TapRecord;
use crate::signals::Signals;

/// Everything that the moves of a call depend on in addition to its words.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Context<'a> {
    /// Where the tool stands.
    pub at: Position,
    /// The inputs at the moment when the call begins.
    pub signals: Signals,
    /// The newest entry of the tap journal, if there is one.
    pub tap: Option<&'a TapRecord>,
}

impl Context<'_> {
    /// A tool that stands at `at`, all inputs as at power-up, nothing in the tap journal.
    #[must_use]
    pub fn standing(at: Position) -> Self {
        Self {
            at,
            signals: Signals::default(),
            tap: None,
        }
    }
}
