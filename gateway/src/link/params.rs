//! Changing the parameter set of a board: one image, taken whole or not at all.
//!
//! ```text
//! stage (the board looks at it) ─► changes (what it would change) ─► commit by its hash ─► stored? ─► hash read back
//! ```

use std::time::{Duration, Instant};

use leadscrew_core::alarm::{Alarm, Code, Span};
use leadscrew_core::board::device::objects::{
    CHANGE_STATE, COMMIT, LAST_GOOD_SET, REFUSAL, SET_CHECKSUM, SET_COMMAND, SET_PASSWORD,
    STAGED_CHANGES, STAGED_IMAGE, STORED_SET, TABLE_CHECKSUM,
};
use leadscrew_core::bus::{Abort, BoardState, Object};
use leadscrew_core::link::{ImageWriter, decode_alarm, decode_changes, identity};
use leadscrew_core::params::{Entry, Params, TABLE_KEY};

use super::{Link, LinkResult, Trouble};

/// 5010h:02h: none since power-up.
const NONE: u64 = 0;
/// 5010h:02h: being stored.
const UNDER_WAY: u64 = 1;
/// 5010h:02h: stored and in force.
const DONE: u64 = 2;
/// 5010h:02h: refused, or not stored.
const REFUSED: u64 = 3;
/// 5010h:05h: the last good set.
const RECALL: u32 = 1;

/// The longest time for storing a set: every page is erased once, with some reserve.
const LONGEST: Duration = Duration::from_secs(10);
/// The pause between two questions whether the set is stored. It doubles each time, to send few frames.
const PAUSE: Duration = Duration::from_millis(5);
const LONGEST_PAUSE: Duration = Duration::from_millis(80);

impl Link {
    /// Checks that the board has this program's parameter table.
    ///
    /// # Errors
    /// [`Trouble::Table`].
    pub fn check_table(&mut self) -> LinkResult {
        let theirs = self.read_number(TABLE_CHECKSUM)?;
        if theirs == u64::from(TABLE_KEY) {
            return Ok(());
        }
        Err(Trouble::Table {
            node: self.node().get(),
            theirs: theirs as u32,
            ours: TABLE_KEY,
        })
    }

    /// Gives the password that opens writing.
    ///
    /// # Errors
    /// [`Trouble::Parameters`] for a wrong one.
    pub fn open_parameters(&mut self, password: u32) -> LinkResult {
        let written = self.write(SET_PASSWORD, &password.to_le_bytes());
        self.explained(written)
    }

    /// Waits until the machine stands. Drives that fell silent stop it.
    ///
    /// # Errors
    /// The board does not answer.
    pub fn wait_at_rest(&mut self) -> LinkResult {
        let end = Instant::now() + LONGEST;
        while Instant::now() < end {
            let state = self.status()?.state;
            if matches!(
                state,
                BoardState::Alarm | BoardState::Starting | BoardState::Idle | BoardState::Hold
            ) {
                return Ok(());
            }
            self.idle(PAUSE)?;
        }
        Ok(())
    }

    /// Stages a set: the board checks the set, and whether it may change now. Nothing has changed yet.
    ///
    /// # Errors
    /// [`Trouble::Parameters`] where the board would refuse it.
    pub fn stage(&mut self, params: &Params) -> LinkResult {
        let mut image = vec![0; ImageWriter::BYTES as usize];
        // With the password: a 1 in its place keeps the present one.
        ImageWriter::with_password(params).read(0, &mut image);
        let written = self.write(STAGED_IMAGE, &image);
        self.explained(written)
    }

    /// Stages a set that was made from `old`, the set in force when it was read.
    ///
    /// # Errors
    /// As [`stage`](Self::stage), and [`Code::StagedSetGone`] where another client has changed parameters since: the staged
    /// set would restore their old values. A later change makes the staged set void by itself.
    pub fn stage_over(&mut self, old: &Params, params: &Params) -> LinkResult {
        self.stage(params)?;
        if self.parameters_identity()? == identity(old) {
            return Ok(());
        }
        Err(Trouble::Parameters {
            node: self.node().get(),
            reason: Some(Alarm::new(Code::StagedSetGone, Span::default())),
        })
    }

    /// The set in force, from the changes that the staged set would make; read as a whole where these are too many.
    ///
    /// # Errors
    /// [`Trouble::Strange`], also where another client has changed parameters meanwhile.
    pub fn before(&mut self, staged: &Params) -> LinkResult<Params> {
        match self.read(STAGED_CHANGES) {
            Ok(bytes) => decode_changes(&bytes, staged).map_err(|_| self.strange(STAGED_CHANGES)),
            Err(trouble) if trouble.is_abort(Abort::OutOfMemory) => Ok(self.parameters()?.params),
            Err(trouble) => Err(trouble),
        }
    }

    /// Commits the staged set by the checksum of its image, and waits until it is stored and in force. Then the board's
    /// identity is read back.
    ///
    /// # Errors
    /// [`Trouble::Parameters`] where the board refuses the set or cannot store it: the old set is then in force and stored.
    /// [`Trouble::Unsettled`] where the board does not tell the result.
    pub fn commit(&mut self, params: &Params) -> LinkResult {
        let staged = ImageWriter::with_password(params).checksum();
        let written = self.write(COMMIT, &staged.to_le_bytes());
        self.explained(written)?;
        self.wait_until_stored(LONGEST)?;
        self.is_in_force(identity(params))
    }

    /// Writes the single value that the board takes even where it refuses a whole set: the write enable.
    ///
    /// # Errors
    /// As [`commit`](Self::commit).
    pub fn commit_value(&mut self, entry: &Entry, params: &Params) -> LinkResult {
        let object = Object::new(0x2000 + entry.no, 0);
        let byte = u8::try_from(params.get(entry)).unwrap_or(0);
        let written = self.write(object, &[byte]);
        self.explained(written)?;
        self.wait_until_stored(LONGEST)?;
        self.is_in_force(identity(params))
    }

    /// The identity of the last good set before the stored one; `None` where there is none.
    ///
    /// # Errors
    /// The board does not answer.
    pub fn last_good(&mut self) -> LinkResult<Option<u32>> {
        let raw = self.read_number(LAST_GOOD_SET)?;
        Ok(u32::try_from(raw).ok().filter(|identity| *identity != 0))
    }

    /// Takes the last good set into force and waits until this is stored.
    ///
    /// # Errors
    /// As [`commit`](Self::commit).
    pub fn recall(&mut self) -> LinkResult {
        let written = self.write(SET_COMMAND, &RECALL.to_le_bytes()[..1]);
        self.explained(written)?;
        self.wait_until_stored(LONGEST)
    }

    /// Waits until the accepted change is stored.
    pub(super) fn wait_until_stored(&mut self, longest: Duration) -> LinkResult {
        let end = Instant::now() + longest;
        let mut pause = PAUSE;
        loop {
            match self.read_number(CHANGE_STATE)? {
                DONE => return Ok(()),
                UNDER_WAY if Instant::now() < end => {
                    self.idle(pause)?;
                    pause = LONGEST_PAUSE.min(pause * 2);
                }
                REFUSED => return Err(self.refused()),
                // Only a refusal means that the old set is in force. A change under way may still be stored, and a stored
                // set without its mark counts when the board starts again [D114].
                UNDER_WAY => return Err(self.unsettled(false)),
                NONE => return Err(self.unsettled(true)),
                _ => return Err(self.strange(CHANGE_STATE)),
            }
        }
    }

    fn unsettled(&self, restarted: bool) -> Trouble {
        Trouble::Unsettled {
            node: self.node().get(),
            restarted,
        }
    }

    fn is_in_force(&mut self, expected: u32) -> LinkResult {
        let in_force = self.parameters_identity()?;
        let stored = self.read_number(STORED_SET)?;
        if in_force == expected && stored == u64::from(expected) {
            return Ok(());
        }
        Err(self.strange(SET_CHECKSUM))
    }

    /// Adds the board's reason to a refusal.
    fn explained(&mut self, written: LinkResult) -> LinkResult {
        match written {
            Err(trouble) if trouble.refusal().is_some() => {
                let told = self.refused();
                Err(match told {
                    Trouble::Parameters {
                        reason: Some(_), ..
                    } => told,
                    _ => trouble,
                })
            }
            written => written,
        }
    }

    fn refused(&mut self) -> Trouble {
        Trouble::Parameters {
            node: self.node().get(),
            reason: self.reason_in(REFUSAL),
        }
    }

    /// The reason that the board gives in this object for its last refusal of a change; `None` where it gives none.
    pub(super) fn reason_in(&mut self, object: Object) -> Option<Alarm> {
        let bytes = self.read(object).ok()?;
        decode_alarm(&bytes).ok().flatten()
    }
}
