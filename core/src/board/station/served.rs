//! The shelf as an SDO server sees it: values by object, in pieces.
//!
//! A value is put together in one buffer before it is read and after it is written, so nothing changes in the middle of a
//! transfer and nothing takes effect before its end. Only the parameter image is longer than the buffer: it is made and
//! taken value by value.

use super::change::Change;
use super::dictionary::{Access, Initial, Kind, find};
use super::shelf::Shelf;
use crate::bus::{Abort, Object, Objects};
use crate::link::{BATCH_BYTES, ImageReader, ImageWriter, encode_alarm, encode_changes};
use crate::params::Params;

/// The image of the parameter set.
const IMAGE: Object = Object::new(0x5010, 1);
/// The same, staged and looked at, and no more than that.
const STAGED: Object = Object::new(0x5010, 9);
/// What the staged set would change.
const CHANGES: Object = Object::new(0x5010, 10);
/// A batch of calls.
const BATCH: Object = Object::new(0x5020, 1);

/// The parameter set as a whole, on its way in.
fn is_image(object: Object) -> bool {
    object == IMAGE || object == STAGED
}

/// The shelf together with the set in force: what an SDO server serves.
pub struct Served<'a> {
    pub shelf: &'a mut Shelf,
    pub params: &'a Params,
}

impl Objects for Served<'_> {
    fn size(&mut self, object: Object) -> Result<u32, Abort> {
        let item = find(object)?;
        if item.access == Access::Write {
            return Err(Abort::WriteOnly);
        }
        let shelf = &mut *self.shelf;
        let length = match (item.kind, object.index) {
            (Kind::Text, _) => {
                let text = match item.initial {
                    Initial::Text(text) => text.as_bytes(),
                    _ => &[],
                };
                let length = text.len().min(BATCH_BYTES);
                for (place, &byte) in shelf.buffer.iter_mut().zip(text) {
                    *place = byte;
                }
                length
            }
            (Kind::Domain, 0x5010) if object == IMAGE => return Ok(ImageWriter::BYTES),
            (Kind::Domain, 0x5010) if object == CHANGES => {
                let (before, after) = (self.params, &shelf.draft);
                encode_changes(before, after, &mut shelf.buffer).map_err(|_| Abort::OutOfMemory)?
            }
            (Kind::Domain, 0x5010) => {
                let reason = shelf.keeper.reason();
                encode_alarm(reason, &mut shelf.buffer).map_err(|_| Abort::Internal)?
            }
            (Kind::Domain, 0x5001) => {
                let status = shelf.record(self.params);
                status
                    .encode(&mut shelf.buffer)
                    .map_err(|_| Abort::Internal)?
            }
            (Kind::Domain, 0x5030) => {
                let record = shelf.snapshot.tap.ok_or(Abort::NoData)?.encode();
                for (place, &byte) in shelf.buffer.iter_mut().zip(&record) {
                    *place = byte;
                }
                record.len()
            }
            (Kind::Domain, 0x5041) => {
                let certificate = shelf.ledger.certificate(shelf.late);
                certificate
                    .encode(&mut shelf.buffer)
                    .map_err(|_| Abort::Internal)?
            }
            (Kind::Domain, 0x5040) => shelf.log.read(shelf.log_from, &mut shelf.buffer),
            (Kind::Domain, _) => return Err(Abort::NoData),
            (kind, _) => {
                let number = shelf.number(&item, self.params)?;
                for (place, byte) in shelf.buffer.iter_mut().zip(number.to_le_bytes()) {
                    *place = byte;
                }
                kind.bytes().unwrap_or(0)
            }
        };
        shelf.length = length;
        u32::try_from(length).map_err(|_| Abort::Internal)
    }

    fn read(&mut self, object: Object, offset: u32, into: &mut [u8]) -> Result<usize, Abort> {
        if object == IMAGE {
            let params = self.shelf.current(self.params);
            return Ok(ImageWriter::new(params).read(offset, into));
        }
        let start = usize::try_from(offset).unwrap_or(usize::MAX);
        let bytes = self
            .shelf
            .buffer
            .get(start..self.shelf.length)
            .unwrap_or(&[]);
        for (place, &byte) in into.iter_mut().zip(bytes) {
            *place = byte;
        }
        Ok(bytes.len().min(into.len()))
    }

    fn begin_write(&mut self, object: Object, size: Option<u32>) -> Result<(), Abort> {
        let item = find(object)?;
        if matches!(item.access, Access::Read | Access::Const) {
            return Err(Abort::ReadOnly);
        }
        let shelf = &mut *self.shelf;
        shelf.length = 0;
        shelf.buffer = [0; BATCH_BYTES];
        if is_image(object) {
            shelf.admit(self.params, Change::Whole)?;
            shelf.image = ImageReader::new();
        }
        let Some(size) = size else { return Ok(()) };
        let most = match item.kind.bytes() {
            Some(bytes) => bytes as u32,
            None if is_image(object) => ImageWriter::BYTES,
            None => BATCH_BYTES as u32,
        };
        if size > most {
            return Err(Abort::TooLong);
        }
        if item.kind.bytes().is_some() && size < most {
            return Err(Abort::TooShort);
        }
        Ok(())
    }

    fn write(&mut self, object: Object, offset: u32, bytes: &[u8]) -> Result<(), Abort> {
        let shelf = &mut *self.shelf;
        if is_image(object) {
            let taken = shelf.image.take(bytes, &mut shelf.draft);
            return taken.or_else(|error| shelf.refuse_image(error));
        }
        let start = usize::try_from(offset).unwrap_or(usize::MAX);
        let end = start.saturating_add(bytes.len());
        let place = shelf.buffer.get_mut(start..end).ok_or(Abort::TooLong)?;
        for (place, &byte) in place.iter_mut().zip(bytes) {
            *place = byte;
        }
        shelf.length = end;
        Ok(())
    }

    fn end_write(&mut self, object: Object, length: u32) -> Result<(), Abort> {
        let item = find(object)?;
        let shelf = &mut *self.shelf;
        if is_image(object) {
            shelf.admit(self.params, Change::Whole)?;
            if let Err(error) = shelf.image.finish(&shelf.draft) {
                return shelf.refuse_image(error);
            }
            shelf.look(self.params)?;
            if object == IMAGE {
                shelf.stage(self.params);
            }
            return Ok(());
        }
        if object == BATCH {
            let snapshot = &shelf.snapshot;
            let (ready, at_rest) = (snapshot.takes_calls(), snapshot.is_at_rest());
            let bytes = shelf.buffer.get(..shelf.length).unwrap_or(&[]);
            return shelf.inbox.take(bytes, ready, at_rest);
        }
        let bytes = item.kind.bytes().ok_or(Abort::Access)?;
        match (length as usize).cmp(&bytes) {
            core::cmp::Ordering::Greater => return Err(Abort::TooLong),
            core::cmp::Ordering::Less => return Err(Abort::TooShort),
            core::cmp::Ordering::Equal => {}
        }
        let raw = shelf.buffer.first_chunk::<8>().copied().unwrap_or_default();
        let number = item.kind.number(raw);
        let none = item.entry.is_some_and(|entry| entry.none() == Some(number));
        if let Some((low, high)) = item.range
            && !none
        {
            if number < low {
                return Err(Abort::TooLow);
            }
            if number > high {
                return Err(Abort::TooHigh);
            }
        }
        shelf.take_number(&item, number, self.params)
    }

    fn abandon(&mut self, _object: Object) {
        self.shelf.length = 0;
    }
}
