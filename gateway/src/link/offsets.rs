//! The table of offsets and tools of a board: read whole, and changed whole or not at all.
//!
//! ```text
//! read (image, last revision) ─► change ─► stage with the next revision ─► commit by its checksum ─► stored?
//! ```

use std::time::{Duration, Instant};

use leadscrew_core::alarm::{Alarm, Arg, Code};
use leadscrew_core::board::device::UNMARKED;
use leadscrew_core::board::device::objects::{
    COMMIT_OFFSETS, MARK_X, MARK_Z, OFFSETS, OFFSETS_FOUND, OFFSETS_REFUSAL, OFFSETS_REVISION,
    OFFSETS_STATE, STAGED_OFFSETS,
};
use leadscrew_core::bus::Object;
use leadscrew_core::offsets::image::{Image, sum};
use leadscrew_core::offsets::{Offsets, Revision};
use leadscrew_core::units::Axis;

use super::{Link, LinkResult, Trouble};

/// 5011h:02h: none since power-up.
const NONE: u64 = 0;
/// 5011h:02h: being stored.
const UNDER_WAY: u64 = 1;
/// 5011h:02h: stored and in force.
const DONE: u64 = 2;
/// 5011h:02h: refused, or not stored.
const REFUSED: u64 = 3;
/// 5011h:04h up to here: nothing is damaged.
const WHOLE: u64 = 1;
/// Somebody may write a table while it is read.
const TRIES: usize = 3;
/// The longest time for storing a table: every page is erased once, with some reserve.
const LONGEST: Duration = Duration::from_secs(10);
/// The pause between two questions whether the table is stored.
const PAUSE: Duration = Duration::from_millis(10);

/// The table of a board.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoardOffsets {
    /// The table in force; revision 0: none was ever written.
    pub table: Offsets,
    /// The last revision that the board has given.
    pub last: Revision,
    /// The newest table that was stored is also the one in force.
    pub whole: bool,
}

impl BoardOffsets {
    /// The table that programs are resolved with; `None` where the board has none.
    ///
    /// # Errors
    /// [`Code::OffsetsDamaged`]: the board runs no program with it.
    pub fn resolving(&self) -> Result<Option<Offsets>, Alarm> {
        if !self.whole {
            let figures = [Arg::Int(self.table.revision.0.into())];
            return Err(Alarm::of(Code::OffsetsDamaged, &figures));
        }
        Ok((self.table.revision != Revision::default()).then_some(self.table))
    }
}

impl Link {
    /// Reads the table.
    ///
    /// # Errors
    /// The board does not answer.
    pub fn offsets(&mut self) -> LinkResult<BoardOffsets> {
        for _ in 0..TRIES {
            let whole = self.read_number(OFFSETS_FOUND)? <= WHOLE;
            let last = Revision(self.read_number(OFFSETS_REVISION)? as u32);
            let bytes = self.read(OFFSETS)?;
            if let Ok(table) = Offsets::decode(&bytes) {
                return Ok(BoardOffsets { table, last, whole });
            }
        }
        Err(self.strange(OFFSETS))
    }

    /// The last revision that the board has given.
    ///
    /// # Errors
    /// The board does not answer.
    pub fn offsets_revision(&mut self) -> LinkResult<Revision> {
        Ok(Revision(self.read_number(OFFSETS_REVISION)? as u32))
    }

    /// Stores a table, made from one that was read with this last revision; gives its revision.
    ///
    /// # Errors
    /// [`Trouble::Offsets`] where the board refuses it or cannot store it: the old one is then in force.
    /// [`Trouble::UnsettledOffsets`] where the board does not tell the result.
    pub fn commit_offsets(&mut self, table: &Offsets, last: Revision) -> LinkResult<Revision> {
        let table = Offsets {
            revision: last.next(),
            ..*table
        };
        let image = table.encode().map_err(|record| {
            let figures = [Arg::Int(record.number().into())];
            self.no_offsets(Some(Alarm::of(Code::OffsetsOutOfRange, &figures)))
        })?;
        self.leave_reference()?;
        let stored = self.store_offsets(&image);
        // Clients of one board hear each other's answers: that to another client's table may have been taken for ours. The
        // table in force tells whose was stored.
        let now = self.offsets()?;
        if now.table == table {
            return Ok(table.revision);
        }
        match stored {
            Err(Trouble::Offsets { reason: None, .. }) | Ok(()) if now.last != last => {
                let figures = [last, now.last].map(|revision| Arg::Int(revision.0.into()));
                Err(self.no_offsets(Some(Alarm::of(Code::OffsetsOtherRevision, &figures))))
            }
            Err(trouble) => Err(trouble),
            Ok(()) => Err(self.strange(OFFSETS_REVISION)),
        }
    }

    /// Stages an image, commits it and waits until it is stored or refused.
    fn store_offsets(&mut self, image: &Image) -> LinkResult {
        let staged = self.write(STAGED_OFFSETS, image);
        self.explained_offsets(staged)?;
        let committed = self.write(COMMIT_OFFSETS, &sum(image).to_le_bytes());
        self.explained_offsets(committed)?;
        self.wait_for_offsets(LONGEST)
    }

    /// Waits until the accepted table is stored.
    pub(super) fn wait_for_offsets(&mut self, longest: Duration) -> LinkResult {
        let end = Instant::now() + longest;
        loop {
            match self.read_number(OFFSETS_STATE)? {
                DONE => return Ok(()),
                UNDER_WAY if Instant::now() < end => self.idle(PAUSE)?,
                REFUSED => return Err(self.refused_offsets()),
                // Only a refusal means that the old table stays in force.
                state @ (UNDER_WAY | NONE) => {
                    return Err(Trouble::UnsettledOffsets {
                        node: self.node().get(),
                        restarted: state == NONE,
                    });
                }
                _ => return Err(self.strange(OFFSETS_STATE)),
            }
        }
    }

    /// The marked position of an axis in 0.1 µm, X in diameter; `None` where none is marked.
    ///
    /// # Errors
    /// The board does not answer.
    pub fn mark(&mut self, axis: Axis) -> LinkResult<Option<i32>> {
        let object = mark_of(axis);
        let raw = self.read(object)?;
        let mark = <[u8; 4]>::try_from(raw).map_err(|_| self.strange(object))?;
        let mark = i32::from_le_bytes(mark);
        Ok((mark != UNMARKED).then_some(mark))
    }

    /// Marks a position, or none.
    ///
    /// # Errors
    /// [`Trouble::Offsets`] where the board refuses it.
    pub fn set_mark(&mut self, axis: Axis, mark: Option<i32>) -> LinkResult {
        let raw = mark.unwrap_or(UNMARKED);
        self.leave_reference()?;
        let marked = self.write(mark_of(axis), &raw.to_le_bytes());
        self.explained_offsets(marked)
    }

    fn no_offsets(&self, reason: Option<Alarm>) -> Trouble {
        Trouble::Offsets {
            node: self.node().get(),
            reason,
        }
    }

    /// Adds the board's reason to a refusal.
    fn explained_offsets(&mut self, written: LinkResult) -> LinkResult {
        match written {
            Err(trouble) if trouble.refusal().is_some() => Err(self.refused_offsets()),
            written => written,
        }
    }

    fn refused_offsets(&mut self) -> Trouble {
        let reason = self.reason_in(OFFSETS_REFUSAL);
        self.no_offsets(reason)
    }
}

const fn mark_of(axis: Axis) -> Object {
    match axis {
        Axis::X => MARK_X,
        _ => MARK_Z,
    }
}
