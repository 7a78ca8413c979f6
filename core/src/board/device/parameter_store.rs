//! A change of the parameter set as a transaction [D116]: staged, checked as a whole, stored, marked as the newest, in
//! force. The permission is checked before. A failure on the way leaves the old set in force.
//!
//! ```text
//! Idle ─► Load ─► Set ─► Mark ─► Idle, the draft comes into force
//!   └──────────────┘
//! ```
//!
//! Loading, storing and marking are effects: the store asks, the owner carries them out and answers. Meanwhile no call goes
//! to the planner, so the machine still stands when the new set comes into force.
//!
//! Knows which set is stored in which place; must not know flash, objects or frames.

use crate::alarm::{Alarm, Code};
use crate::board::kept::{Found, KeptSet, Mark, PowerUp, Shelved, Slot};
use crate::board::request::{Content, StoreRequest};
use crate::board::store::{Region, StoreError};
use crate::bus::Abort;
use crate::link::identity;
use crate::params::Params;

/// The result of the last change: 5010h:02.
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

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Step {
    #[default]
    Idle,
    /// A stored set is read into the draft.
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

/// The parameter sets of a board and the change under way.
#[derive(Debug, Default)]
pub struct ParameterStore {
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

impl ParameterStore {
    /// Takes the result of power-up.
    pub fn power_up(&mut self, up: &PowerUp) {
        self.found = up.found;
        self.shelved = up.shelved;
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

    /// The identity of the stored set; 0: none.
    pub fn stored(&self) -> u32 {
        self.shelved.stored.map_or(0, |(_, identity)| identity)
    }

    /// The identity of the last good set before it; 0: none.
    pub fn before(&self) -> u32 {
        self.shelved.before.map_or(0, |(_, identity)| identity)
    }

    /// True where the set in force is also the stored set.
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

    /// The requested set is in force and stored already.
    pub const fn nothing_to_do(&mut self) {
        self.state = CommitState::Done;
        self.reason = None;
    }

    /// Reads the last good set into the draft.
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
        Some(slot.region())
    }

    /// The content of that region. A set becomes the draft.
    pub fn loaded(
        &mut self,
        held: Result<Option<&[u8]>, StoreError>,
        draft: &mut Params,
    ) -> Progress {
        let Step::Load(..) = self.step else {
            return Progress::default();
        };
        let bytes = held.ok().flatten().unwrap_or_default();
        if KeptSet::decode(bytes, draft).is_ok() {
            self.begin();
            return Progress::default();
        }
        self.fail(Code::ParametersLost)
    }

    /// The next write, once.
    pub fn store<'a>(&mut self, draft: &'a Params) -> Option<StoreRequest<'a>> {
        let number = self.shelved.number.saturating_add(1);
        let (step, region, content) = match self.step {
            Step::Set(slot, Effect::Wanted) => (
                Step::Set(slot, Effect::UnderWay),
                slot.region(),
                Content::Set(KeptSet {
                    number,
                    params: draft,
                }),
            ),
            Step::Mark(Effect::Wanted) => (
                Step::Mark(Effect::UnderWay),
                Region::ParametersMark,
                Content::Mark(Mark(self.shelved.number).encode()),
            ),
            _ => return None,
        };
        self.step = step;
        Some(StoreRequest { region, content })
    }

    /// The owner has carried out the write, or has failed.
    pub fn has_stored(
        &mut self,
        region: Region,
        result: Result<(), StoreError>,
        draft: &Params,
    ) -> Progress {
        match self.step {
            Step::Set(slot, Effect::UnderWay) if region == slot.region() => {
                if result.is_err() {
                    return self.fail(Code::ParametersNotStored);
                }
                let shelved = &mut self.shelved;
                let before = shelved.stored.or(shelved.before);
                shelved.before = before.filter(|(before, _)| *before != slot);
                shelved.stored = Some((slot, identity(draft)));
                shelved.foreign = None;
                shelved.number = shelved.number.saturating_add(1);
                self.step = Step::Mark(Effect::Wanted);
                Progress::default()
            }
            Step::Mark(Effect::UnderWay) if region == Region::ParametersMark => {
                self.step = Step::Idle;
                self.found = Found::Newest;
                self.state = CommitState::Done;
                // The set itself is stored. Without its mark, only later damage could go unnoticed.
                Progress {
                    in_force: true,
                    warning: result.is_err().then_some(Code::ParametersUnmarked),
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

    fn fail(&mut self, code: Code) -> Progress {
        self.give_up(&Alarm::of(code, &[]));
        Progress {
            in_force: false,
            warning: Some(code),
        }
    }
}
