//! A change of the parameter set: who may begin it, how it is put together, and its result.
//!
//! The change is put together in the draft and checked as a whole. The
//! [`Shelf`](super::shelf::Shelf) does the rest. Must not know how a value travels.

use super::dictionary;
use super::shelf::{Progress, Write};
use super::table::{LOAD, SAVE};
use super::values::ObjectValues;
use crate::alarm::{Alarm, Arg, Code};
use crate::board::kept::KeptSet;
use crate::board::request::{Content, StoreRequest};
use crate::board::store::Region;
use crate::bus::Abort;
use crate::link::Event;
use crate::link::{ImageError, ImageWriter, identity};
use crate::params::{Entry, PASSWORD, PASSWORD_KEPT, PASSWORD_SLOT, Params, Part, TABLE_KEY};
use crate::tick::{DriveNodes, StoreError};

impl ObjectValues {
    /// True while a change of the set is under way. No call goes to the planner in this time.
    pub fn is_changing(&self) -> bool {
        self.staged || self.parameter_store.is_busy()
    }

    /// Refuses a change of parameters and keeps the reason.
    fn refuse(&mut self, code: Code, abort: Abort) -> Result<(), Abort> {
        self.refuse_with(&Alarm::of(code, &[]), abort)
    }

    fn refuse_with(&mut self, reason: &Alarm, abort: Abort) -> Result<(), Abort> {
        self.parameter_store.refuse(reason);
        Err(abort)
    }

    /// Checks whether parameters may change now.
    pub(super) fn admit(&mut self, params: &Params, change: Change) -> Result<(), Abort> {
        // The last value cannot be repeated after another change.
        self.wrote = None;
        let moves = !self.snapshot.is_at_rest() || self.is_about_to_move();
        let under_way = moves || self.program_buffer.awaits_more();
        if under_way || self.is_changing() || self.offset_store.shelf.is_busy() {
            return self.refuse(Code::ParametersAtWork, Abort::State);
        }
        // A set that was loaded for communication only cannot be changed by single values: it must be replaced as a whole.
        let undecided = self.parameter_store.found().alarm();
        if let (Change::Value | Change::Switch, Some(alarm)) = (change, undecided) {
            return self.refuse_with(&alarm, Abort::State);
        }
        // The write enable itself can be switched back, and a set that is loaded already can be accepted as it is.
        let free = change == Change::Switch || change == Change::Recall && undecided.is_some();
        if !free && !params.parameter_write_enable() {
            return self.refuse(Code::ParametersProtected, Abort::LocalControl);
        }
        if !self.protection.is_open(params) {
            return self.refuse(Code::PasswordMissing, Abort::LocalControl);
        }
        Ok(())
    }

    pub(super) fn current<'a>(&'a self, params: &'a Params) -> &'a Params {
        if self.staged { &self.draft } else { params }
    }

    /// The set that comes into force, once.
    pub fn take_params(&mut self) -> Option<&Params> {
        core::mem::take(&mut self.staged).then_some(&self.draft)
    }

    /// The set in force comes into force again.
    pub fn begin_anew(&mut self, params: &Params) {
        self.draft.clone_from(params);
        self.staged = true;
    }

    pub(super) fn take_parameter(
        &mut self,
        entry: &'static Entry,
        number: i64,
        params: &Params,
    ) -> Result<(), Abort> {
        if self.repeats(entry, number, params) {
            return Ok(());
        }
        let change = if entry.no == PARAMETER_WRITE_ENABLE {
            Change::Switch
        } else {
            Change::Value
        };
        self.admit(params, change)?;
        self.draft.clone_from(params);
        match entry.part {
            Part::Bit(_) => {
                if number & !entry.byte_mask() != 0 {
                    return Err(Abort::Value);
                }
                self.draft.put_slot(entry.place(), number);
            }
            Part::Whole | Part::Axis(_) => {
                let raw = dictionary::taken(entry, number);
                self.draft.set(entry, raw).map_err(|_| Abort::Value)?;
            }
        }
        self.look_and_stage(params)?;
        self.wrote = Some(entry);
        Ok(())
    }

    /// True where the last accepted value comes again and no other change was requested in between: its answer was lost, or
    /// its frame came twice. Its request is done or under way. This is checked before the question who may change
    /// parameters, because this very value may protect the board now. A password cannot be found by trial this way: another
    /// password is another change [D184].
    fn repeats(&mut self, entry: &Entry, number: i64, params: &Params) -> bool {
        if self.wrote != Some(entry) || self.draft.number(entry) != number {
            return false;
        }
        if self.is_changing() {
            return true;
        }
        let there = self.is_there(params);
        if there {
            self.parameter_store.nothing_to_do();
        }
        there
    }

    /// Checks whether the draft can work on this board. A draft that only says that there is a password keeps the present
    /// one.
    fn look(&mut self, params: &Params) -> Result<(), Abort> {
        if self.draft.slot(PASSWORD_SLOT) == Some(PASSWORD_KEPT) {
            let kept = params.slot(PASSWORD_SLOT).unwrap_or(0);
            if kept == 0 {
                return self.refuse_with(&out_of_range(PASSWORD), Abort::Value);
            }
            self.draft.put_slot(PASSWORD_SLOT, kept);
        }
        let nodes = DriveNodes::of(&self.draft);
        let here = nodes.spare(self.node).and_then(|()| self.can_send());
        if let Err(alarm) = self.draft.validate().and(here) {
            return self.refuse_with(&alarm, Abort::Incompatible);
        }
        Ok(())
    }

    /// Checks whether this board's controller can send the frames that the draft asks for.
    fn can_send(&self) -> Result<(), Alarm> {
        let kbit = self.draft.fd_kbit();
        if self.draft.setpoint_frame() == 0 || self.data_rates.has(kbit) {
            return Ok(());
        }
        Err(match self.data_rates.near(kbit) {
            Some(near) => Alarm::of(
                Code::FdRateOfBoard,
                &[Arg::Int(kbit.into()), Arg::Int(near.into())],
            ),
            None => Alarm::of(Code::NoFd, &[]),
        })
    }

    /// True where the draft is in force and stored already.
    fn is_there(&self, params: &Params) -> bool {
        self.draft == *params && self.parameter_store.is_stored()
    }

    /// Stores the checked draft and takes it into force.
    fn stage(&mut self, params: &Params) {
        if self.is_there(params) {
            self.parameter_store.nothing_to_do();
        } else {
            self.parameter_store.begin();
        }
    }

    pub(super) fn look_and_stage(&mut self, params: &Params) -> Result<(), Abort> {
        self.look(params)?;
        self.stage(params);
        Ok(())
    }

    /// Stores the staged set and takes it into force, if the image it came in ended with this checksum. A draft that was
    /// changed since has another checksum. A repeated request, because the answer was lost, is done once.
    pub(super) fn commit(&mut self, checksum: u32, params: &Params) -> Result<(), Abort> {
        let same = self.is_draft(checksum, params);
        if same && self.is_changing() {
            return Ok(());
        }
        // This comes before the question who may change parameters, because this very set may protect the board now.
        if same && self.is_there(params) {
            self.parameter_store.nothing_to_do();
            return Ok(());
        }
        self.admit(params, Change::Whole)?;
        if !same || self.draft.first_out_of_range().is_some() {
            return self.refuse(Code::StagedSetGone, Abort::Value);
        }
        self.look_and_stage(params)
    }

    /// True where the image that brought the draft ended with this checksum. A draft that holds the password in force can
    /// be named until another checksum is named; so a password cannot be found by trial without the waiting times after a
    /// wrong one [D163].
    fn is_draft(&mut self, checksum: u32, params: &Params) -> bool {
        let stays = self.draft.slot(PASSWORD_SLOT) == params.slot(PASSWORD_SLOT);
        self.named = (self.named || !stays)
            && ImageWriter::with_password(&self.draft).checksum() == checksum;
        self.named || stays && identity(&self.draft) == checksum
    }

    /// Keeps the draft, which came as an image, for its commit.
    pub(super) fn put_aside(&mut self, params: &Params) -> Result<(), Abort> {
        self.named = self.draft.slot(PASSWORD_SLOT) != Some(PASSWORD_KEPT);
        self.look(params)
    }

    pub(super) fn refuse_image(&mut self, error: ImageError) -> Result<(), Abort> {
        let (alarm, abort) = match error {
            ImageError::Table(key) => (
                Alarm::of(Code::ImageForeign, &[Arg::Key(key), Arg::Key(TABLE_KEY)]),
                Abort::Incompatible,
            ),
            ImageError::Length => (incomplete(), Abort::Length),
            ImageError::Checksum => (incomplete(), Abort::Crc),
            ImageError::Range(no) => (out_of_range(no), Abort::Value),
        };
        self.refuse_with(&alarm, abort)
    }

    /// 1010h: every change is stored by itself. Only the built-in set of a new board remains to be stored.
    pub(super) fn save(&mut self, signature: u32, params: &Params) -> Result<(), Abort> {
        if signature != SAVE {
            return Err(Abort::NotStored);
        }
        if let Some(alarm) = self.parameter_store.found().alarm() {
            return self.refuse_with(&alarm, Abort::State);
        }
        if self.parameter_store.is_stored() || self.is_changing() {
            return Ok(());
        }
        self.admit(params, Change::Whole)?;
        self.draft.clone_from(params);
        self.look_and_stage(params)
    }

    /// 1011h: the built-in set.
    pub(super) fn restore(&mut self, signature: u32, params: &Params) -> Result<(), Abort> {
        if signature != LOAD {
            return Err(Abort::NotStored);
        }
        self.admit(params, Change::Whole)?;
        self.draft = Params::slant_bed();
        // This does not remove a password.
        let kept = params.slot(PASSWORD_SLOT).unwrap_or(0);
        self.draft.put_slot(PASSWORD_SLOT, kept);
        self.look_and_stage(params)
    }

    pub(super) fn password(&mut self, password: u32, params: &Params) -> Result<(), Abort> {
        self.protection.knock(password, params).or_else(|alarm| {
            self.log.push(self.tick, &Event::Warning(alarm));
            self.refuse_with(&alarm, Abort::LocalControl)
        })
    }

    /// The content of the region that was to be read. A set becomes the draft. It was good when it was stored, but the
    /// board may have had another number then.
    pub fn loaded(&mut self, held: Result<Option<&[u8]>, StoreError>) {
        if !self.parameter_store.awaits_content() {
            return;
        }
        let bytes = held.ok().flatten().unwrap_or_default();
        if KeptSet::decode(bytes, &mut self.draft).is_err() {
            let progress = self.parameter_store.fail(Code::ParametersLost);
            self.go_on(progress);
        } else if let Err(alarm) = DriveNodes::of(&self.draft).spare(self.node) {
            self.parameter_store.give_up(&alarm);
        } else {
            self.parameter_store.begin();
        }
    }

    /// The next write for the storage, once.
    pub fn store(&mut self) -> Option<StoreRequest<'_>> {
        let (region, content) = match self.parameter_store.store() {
            Some(Write::Draft(region, number)) => {
                let params = &self.draft;
                (region, Content::Set(KeptSet { number, params }))
            }
            Some(Write::Mark(region, mark)) => (region, Content::Mark(mark)),
            None => return self.store_offsets(),
        };
        Some(StoreRequest { region, content })
    }

    /// The write has been done, or has failed.
    pub fn has_stored(&mut self, region: Region, result: Result<(), StoreError>) {
        let draft = &self.draft;
        let progress = self
            .parameter_store
            .has_stored(region, result, || identity(draft));
        self.go_on(progress);
        let progress = self.has_stored_offsets(region, result);
        if let Some(warning) = progress.warning {
            self.warn(warning);
        }
    }

    fn go_on(&mut self, progress: Progress) {
        self.staged |= progress.in_force;
        if let Some(warning) = progress.warning {
            self.warn(warning);
        }
    }
}

/// A kind of change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    /// One value.
    Value,
    /// The write enable.
    Switch,
    /// The whole set.
    Whole,
    /// The last good set again.
    Recall,
}

fn incomplete() -> Alarm {
    Alarm::of(Code::ParametersIncomplete, &[])
}

fn out_of_range(no: u16) -> Alarm {
    Alarm::of(Code::ParametersOutOfRange, &[Arg::Int(no.into())])
}

/// Number of the parameter that allows writing the others.
const PARAMETER_WRITE_ENABLE: u16 = 9026;
