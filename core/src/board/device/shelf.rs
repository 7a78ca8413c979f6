//! What a board keeps in two places with a mark, and its change as a transaction [D116]: staged, checked as a whole,
//! stored, marked as the newest, in force. Permission and checks come before. A failure on the way leaves the old content
//! in force.
//!
//! ```text
//! Idle ─► Load ─► Set ─► Mark ─► Idle, the draft comes into force
//!   └──────────────┘
//! ```
//!
//! Loading, storing and marking are effects: the shelf asks, the owner carries them out and answers. Meanwhile no call goes
//! to the planner, so the machine still stands when the new content comes into force.
//!
//! Knows which content is stored in which place, by number and identity; must not know the content itself, flash, objects
//! or frames.

use crate::alarm::{Alarm, Code};
use crate::board::kept::{Kept, Mark, Shelved, Slot};
use crate::board::store::Region;
use crate::bus::Abort;
use crate::tick::{Found, StoreError};

/// The result of the last change: 5010h:02 and 5011h:02.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum CommitState {
    /// None since power-up.
    #[default]
    None = 0,
    /// Being stored.
    UnderWay = 1,
    /// Stored and in force.
    Done = 2,
    /// Refused, or not stored: nothing has changed.
    Refused = 3,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Step {
    Idle,
    /// A stored content is read into the draft.
    Load(Slot, Effect),
    /// The draft is written to its place.
    Set(Slot, Effect),
    /// The mark is written.
    Mark(Effect),
}

/// An effect for the owner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Effect {
    Wanted,
    UnderWay,
}

/// The next write.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Write {
    /// The draft, under this number.
    Draft(Region, u32),
    /// The mark.
    Mark(Region, [u8; Mark::BYTES]),
}

/// The two places of a content, and the change under way.
#[derive(Debug)]
pub struct Shelf {
    of: Kept,
    found: Found,
    shelved: Shelved,
    step: Step,
    state: CommitState,
    reason: Option<Alarm>,
}

/// The result of an effect.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Progress {
    /// The draft comes into force.
    pub in_force: bool,
    /// A warning to report.
    pub warning: Option<Code>,
}

impl Shelf {
    pub fn new(of: Kept) -> Self {
        Self {
            of,
            found: Found::default(),
            shelved: Shelved::default(),
            step: Step::Idle,
            state: CommitState::None,
            reason: None,
        }
    }

    /// Takes the result of power-up.
    pub const fn power_up(&mut self, found: Found, shelved: Shelved) {
        self.found = found;
        self.shelved = shelved;
    }

    pub const fn found(&self) -> Found {
        self.found
    }

    pub const fn state(&self) -> CommitState {
        self.state
    }

    /// The reason for the last refusal or failure.
    pub const fn reason(&self) -> Option<&Alarm> {
        self.reason.as_ref()
    }

    /// A change is under way.
    pub fn is_busy(&self) -> bool {
        self.step != Step::Idle
    }

    /// The highest number given.
    pub const fn number(&self) -> u32 {
        self.shelved.number
    }

    /// The identity of what is stored; 0: none.
    pub fn stored(&self) -> u32 {
        self.shelved.stored.map_or(0, |(_, identity)| identity)
    }

    /// The identity of the last good content before it; 0: none.
    pub fn before(&self) -> u32 {
        self.shelved.before.map_or(0, |(_, identity)| identity)
    }

    /// True where the content in force is also the stored one.
    pub const fn is_stored(&self) -> bool {
        self.shelved.stored.is_some()
    }

    /// Refuses a change for this reason. A change under way goes on.
    pub fn refuse(&mut self, reason: &Alarm) {
        if !self.is_busy() {
            self.state = CommitState::Refused;
            self.reason = Some(*reason);
        }
    }

    /// The draft is good and will be stored.
    pub fn begin(&mut self) {
        self.step = Step::Set(self.shelved.next(), Effect::Wanted);
        self.state = CommitState::UnderWay;
        self.reason = None;
    }

    /// What was asked for is in force and stored already.
    pub const fn nothing_to_do(&mut self) {
        self.state = CommitState::Done;
        self.reason = None;
    }

    /// Reads the last good content into the draft.
    ///
    /// # Errors
    /// [`Abort::NoData`] where there is none.
    pub fn recall(&mut self) -> Result<(), Abort> {
        let (slot, _) = self.shelved.before.ok_or(Abort::NoData)?;
        self.step = Step::Load(slot, Effect::Wanted);
        self.state = CommitState::UnderWay;
        self.reason = None;
        Ok(())
    }

    /// The next region to read, once.
    pub const fn load(&mut self) -> Option<Region> {
        let Step::Load(slot, Effect::Wanted) = self.step else {
            return None;
        };
        self.step = Step::Load(slot, Effect::UnderWay);
        Some(self.of.region(slot))
    }

    /// True while the content of that region is awaited.
    pub const fn awaits_content(&self) -> bool {
        matches!(self.step, Step::Load(..))
    }

    /// The next write, once.
    pub fn store(&mut self) -> Option<Write> {
        let (step, write) = match self.step {
            Step::Set(slot, Effect::Wanted) => (
                Step::Set(slot, Effect::UnderWay),
                Write::Draft(self.of.region(slot), self.shelved.number.saturating_add(1)),
            ),
            Step::Mark(Effect::Wanted) => (
                Step::Mark(Effect::UnderWay),
                Write::Mark(self.of.mark(), Mark(self.shelved.number).encode()),
            ),
            _ => return None,
        };
        self.step = step;
        Some(write)
    }

    /// The owner has carried out the write, or has failed. `identity`: that of the draft.
    pub fn has_stored(
        &mut self,
        region: Region,
        result: Result<(), StoreError>,
        identity: impl Fn() -> u32,
    ) -> Progress {
        match self.step {
            Step::Set(slot, Effect::UnderWay) if region == self.of.region(slot) => {
                if result.is_err() {
                    return self.fail(self.of.not_stored());
                }
                let shelved = &mut self.shelved;
                let before = shelved.stored.or(shelved.before);
                shelved.before = before.filter(|(before, _)| *before != slot);
                shelved.stored = Some((slot, identity()));
                shelved.foreign = None;
                shelved.number = shelved.number.saturating_add(1);
                self.step = Step::Mark(Effect::Wanted);
                Progress::default()
            }
            Step::Mark(Effect::UnderWay) if region == self.of.mark() => {
                self.step = Step::Idle;
                self.found = Found::Newest;
                self.state = CommitState::Done;
                // The content itself is stored. Without its mark, only later damage could go unnoticed.
                Progress {
                    in_force: true,
                    warning: result.is_err().then_some(self.of.unmarked()),
                }
            }
            _ => Progress::default(),
        }
    }

    /// Stores nothing more, for this reason.
    pub fn give_up(&mut self, reason: &Alarm) {
        self.step = Step::Idle;
        self.refuse(reason);
    }

    /// The same with a warning.
    pub fn fail(&mut self, code: Code) -> Progress {
        self.give_up(&Alarm::of(code, &[]));
        Progress {
            in_force: false,
            warning: Some(code),
        }
    }
}
