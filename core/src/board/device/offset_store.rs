//! The table of offsets and tools on a board: object 5011h. Bytes are staged, checked and stored; nothing here knows what
//! an offset is for.
//!
//! A change is a whole image with the revision after the board's last one: whoever has not seen the last change makes none
//! [D286]. It needs no write enable and no password, and it does not restart the application [D287].

use super::mode::Request;
use super::operating::not_referenced;
use super::shelf::{Progress, Shelf, Write};
use super::values::ObjectValues;
use crate::alarm::{Alarm, Arg, Code};
use crate::board::kept::Kept;
use crate::board::kept_offsets::KeptOffsets;
use crate::board::request::{Content, StoreRequest};
use crate::board::store::{Region, copy};
use crate::bus::Abort;
use crate::offsets::Revision;
use crate::offsets::image::{self, BYTES, Image, ImageFault, check};
use crate::tick::{Found, StoreError};
use crate::units::{Axes, Axis};

/// A position that nobody has marked.
pub const UNMARKED: i32 = i32::MAX;
/// The axes with a mark.
const MARKED: [Axis; 2] = [Axis::X, Axis::Z];

/// The table in force and the one that is staged.
#[derive(Debug)]
pub struct OffsetStore {
    pub shelf: Shelf,
    pub in_force: Image,
    draft: Image,
    /// 5011h:08: position of X that a touch begins with, in 0.1 µm, a diameter.
    pub mark_x: i32,
    /// 5011h:09: that of Z.
    pub mark_z: i32,
}

impl OffsetStore {
    pub fn new() -> Self {
        Self {
            shelf: Shelf::new(Kept::Offsets),
            in_force: [0; BYTES],
            draft: [0; BYTES],
            mark_x: UNMARKED,
            mark_z: UNMARKED,
        }
    }

    /// Takes the result of power-up.
    #[inline(never)]
    pub fn power_up(&mut self, up: &KeptOffsets) {
        self.shelf.power_up(up.found, up.shelved);
        self.in_force = up.table;
    }

    /// The revision in force.
    pub fn revision(&self) -> Revision {
        image::revision(&self.in_force)
    }

    const fn mark(&mut self, axis: Axis) -> &mut i32 {
        match axis {
            Axis::X => &mut self.mark_x,
            Axis::Z | Axis::C => &mut self.mark_z,
        }
    }

    /// Takes a piece of an image.
    pub fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Abort> {
        let start = usize::try_from(offset).unwrap_or(usize::MAX);
        let end = start.saturating_add(bytes.len());
        let place = self.draft.get_mut(start..end).ok_or(Abort::TooLong)?;
        copy(bytes, place);
        Ok(())
    }

    /// Why a program that names this revision does not run.
    pub fn refuses(&self, named: Revision) -> Option<Alarm> {
        let now = self.revision();
        let [named, told] = [named, now].map(|revision| Arg::Int(revision.0.into()));
        if !matches!(self.shelf.found(), Found::Newest | Found::Nothing) {
            return Some(Alarm::of(Code::OffsetsDamaged, &[told]));
        }
        (named != told).then(|| Alarm::of(Code::OffsetsOtherRevision, &[named, told]))
    }

    fn refuse(&mut self, reason: &Alarm, abort: Abort) -> Result<(), Abort> {
        self.shelf.refuse(reason);
        Err(abort)
    }

    /// Checks the staged image: it is the next one.
    fn check(&mut self) -> Result<u32, Abort> {
        let next = Revision(self.shelf.number()).next();
        let (alarm, abort) = match check(&self.draft) {
            Ok(head) if head.revision == next => return Ok(head.sum),
            Ok(head) => {
                // The revision that the change was made with.
                let made = i64::from(head.revision.0).saturating_sub(1);
                let figures = [Arg::Int(made), Arg::Int(self.shelf.number().into())];
                (
                    Alarm::of(Code::OffsetsOtherRevision, &figures),
                    Abort::State,
                )
            }
            Err(ImageFault::Range(record)) => {
                let figures = [Arg::Int(record.number().into())];
                (Alarm::of(Code::OffsetsOutOfRange, &figures), Abort::Value)
            }
            Err(ImageFault::Damaged) => (incomplete(), Abort::Crc),
            Err(ImageFault::Schema(..)) => (incomplete(), Abort::Incompatible),
        };
        self.refuse(&alarm, abort).map(|()| 0)
    }
}

impl ObjectValues {
    /// Checks whether offsets may change now.
    pub(super) fn admit_offsets(&mut self) -> Result<(), Abort> {
        let busy = self.program_buffer.awaits_more()
            || self.is_changing()
            || self.offset_store.shelf.is_busy();
        let admitted = match busy {
            true => Err(Alarm::of(Code::OffsetsAtWork, &[])),
            false => self.let_in(Request::Offsets),
        };
        admitted.or_else(|reason| self.offset_store.refuse(&reason, Abort::State))
    }

    /// An image of `length` bytes has come: it is checked and put aside.
    pub(super) fn stage_offsets(&mut self, length: u32) -> Result<(), Abort> {
        self.admit_offsets()?;
        if length as usize != BYTES {
            return self.offset_store.refuse(&incomplete(), Abort::Length);
        }
        self.offset_store.check().map(drop)
    }

    /// Stores the staged image that ends with this checksum. A repeated request, because the answer was lost, is done once.
    pub(super) fn commit_offsets(&mut self, checksum: u32) -> Result<(), Abort> {
        let store = &mut self.offset_store;
        if store.shelf.is_busy() && image::sum(&store.draft) == checksum {
            return Ok(());
        }
        if store.shelf.is_stored() && image::sum(&store.in_force) == checksum {
            store.shelf.nothing_to_do();
            return Ok(());
        }
        self.admit_offsets()?;
        let store = &mut self.offset_store;
        if store.check()? != checksum {
            return store.refuse(&incomplete(), Abort::Value);
        }
        store.shelf.begin();
        Ok(())
    }

    /// The next write of a table.
    pub(super) fn store_offsets(&mut self) -> Option<StoreRequest<'_>> {
        let (region, content) = match self.offset_store.shelf.store()? {
            Write::Draft(region, _) => (region, Content::Table(&self.offset_store.draft)),
            Write::Mark(region, mark) => (region, Content::Mark(mark)),
        };
        Some(StoreRequest { region, content })
    }

    /// The write has been done, or has failed.
    pub(super) fn has_stored_offsets(
        &mut self,
        region: Region,
        result: Result<(), StoreError>,
    ) -> Progress {
        let store = &mut self.offset_store;
        let draft = &store.draft;
        let progress = store.shelf.has_stored(region, result, || image::sum(draft));
        if progress.in_force {
            copy(&store.draft, &mut store.in_force);
        }
        progress
    }

    /// 5011h:08 and :09. A mark is where an axis stands now: it is let in as a change of the table is, for an axis whose
    /// reference is known or not needed. To forget one is always possible.
    pub(super) fn mark_position(&mut self, axis: Axis, value: u32) -> Result<(), Abort> {
        let value = value as i32;
        if value != UNMARKED {
            self.admit_offsets()?;
            let missing = self.snapshot.unreferenced;
            if missing.contains(axis) {
                let reason = not_referenced(Axes::NONE.with(axis));
                return self.offset_store.refuse(&reason, Abort::State);
            }
        }
        *self.offset_store.mark(axis) = value;
        Ok(())
    }

    /// The axes whose reference has been lost or found: what was marked of them counts from another point.
    pub(super) fn forget_marks(&mut self, now: Axes) {
        let before = self.snapshot.referenced;
        for axis in MARKED {
            if before.contains(axis) != now.contains(axis) {
                *self.offset_store.mark(axis) = UNMARKED;
            }
        }
    }
}

fn incomplete() -> Alarm {
    Alarm::of(Code::OffsetsIncomplete, &[])
}
