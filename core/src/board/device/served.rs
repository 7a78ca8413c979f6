//! The objects as an SDO server sees them: values by object, in pieces.
//!
//! A value is put together in one buffer before a read and after a write. So a value cannot change in the middle of a
//! transfer, and a write has no effect before its end. Two images are longer than the buffer: that of the parameters is
//! made and taken value by value, that of the offsets has buffers of its own.

use super::change::Change;
use super::dictionary::{Access, Kind, ObjectSource, find};
use super::objects::{BATCH, IMAGE, OFFSETS, STAGED_IMAGE, STAGED_OFFSETS};
use super::values::ObjectValues;
use crate::board::store::copy;
use crate::bus::{Abort, Object, Objects};
use crate::link::{BATCH_BYTES, ImageReader, ImageWriter};
use crate::offsets::image as offsets;
use crate::params::Params;

/// True for the parameter set as a whole, while it is written.
fn is_image(object: Object) -> bool {
    object == IMAGE || object == STAGED_IMAGE
}

/// The values of the objects together with the set in force: the data of an SDO server.
pub struct Served<'a> {
    pub values: &'a mut ObjectValues,
    pub params: &'a Params,
}

impl Objects for Served<'_> {
    fn size(&mut self, object: Object) -> Result<u32, Abort> {
        let place = find(object)?;
        if place.access() == Access::Write {
            return Err(Abort::WriteOnly);
        }
        if object == IMAGE {
            return Ok(ImageWriter::BYTES);
        }
        if object == OFFSETS {
            return Ok(offsets::BYTES as u32);
        }
        let values = &mut *self.values;
        let length = match (place.kind(), place) {
            (Kind::Text, ObjectSource::Row(row)) => copy(row.text().as_bytes(), &mut values.buffer),
            (Kind::Domain, _) => values.domain(object, self.params)?,
            (kind, _) => {
                let number = values.number(object, place, self.params)?;
                copy(&number.to_le_bytes(), &mut values.buffer);
                kind.bytes().unwrap_or(0)
            }
        };
        values.length = length;
        Ok(length as u32)
    }

    fn read(&mut self, object: Object, offset: u32, into: &mut [u8]) -> Result<usize, Abort> {
        if object == IMAGE {
            let params = self.values.current(self.params);
            return Ok(ImageWriter::new(params).read(offset, into));
        }
        let start = usize::try_from(offset).unwrap_or(usize::MAX);
        let whole = if object == OFFSETS {
            Some(&self.values.offset_store.in_force[..])
        } else {
            self.values.buffer.get(..self.values.length)
        };
        let bytes = whole.and_then(|whole| whole.get(start..)).unwrap_or(&[]);
        Ok(copy(bytes, into))
    }

    fn begin_write(&mut self, object: Object, size: Option<u32>) -> Result<(), Abort> {
        let place = find(object)?;
        if matches!(place.access(), Access::Read | Access::Const) {
            return Err(Abort::ReadOnly);
        }
        let values = &mut *self.values;
        values.length = 0;
        values.buffer = [0; BATCH_BYTES];
        if is_image(object) {
            values.admit(self.params, Change::Whole)?;
            values.image = ImageReader::new();
        }
        if object == STAGED_OFFSETS {
            values.admit_offsets()?;
        }
        let Some(size) = size else { return Ok(()) };
        let fixed = place.kind().bytes();
        let most = match fixed {
            Some(bytes) => bytes as u32,
            None if is_image(object) => ImageWriter::BYTES,
            None if object == STAGED_OFFSETS => offsets::BYTES as u32,
            None => BATCH_BYTES as u32,
        };
        if size > most {
            return Err(Abort::TooLong);
        }
        if fixed.is_some() && size < most {
            return Err(Abort::TooShort);
        }
        Ok(())
    }

    fn write(&mut self, object: Object, offset: u32, bytes: &[u8]) -> Result<(), Abort> {
        let values = &mut *self.values;
        if is_image(object) {
            let taken = values.image.take(bytes, &mut values.draft);
            return taken.or_else(|error| values.refuse_image(error));
        }
        if object == STAGED_OFFSETS {
            return values.offset_store.write(offset, bytes);
        }
        let start = usize::try_from(offset).unwrap_or(usize::MAX);
        let end = start.saturating_add(bytes.len());
        let place = values.buffer.get_mut(start..end).ok_or(Abort::TooLong)?;
        copy(bytes, place);
        values.length = end;
        Ok(())
    }

    fn end_write(&mut self, object: Object, length: u32) -> Result<(), Abort> {
        let place = find(object)?;
        let values = &mut *self.values;
        if is_image(object) {
            values.admit(self.params, Change::Whole)?;
            if let Err(error) = values.image.finish(&values.draft) {
                return values.refuse_image(error);
            }
            return if object == STAGED_IMAGE {
                values.put_aside(self.params)
            } else {
                values.look_and_stage(self.params)
            };
        }
        if object == STAGED_OFFSETS {
            return values.stage_offsets(length);
        }
        if object == BATCH {
            let snapshot = &values.snapshot;
            let (ready, at_rest) = (snapshot.takes_calls(), snapshot.is_at_rest());
            let bytes = values.buffer.get(..values.length).unwrap_or(&[]);
            let taken = values.program_buffer.take(bytes, ready, at_rest);
            if values.program_buffer.is_loading() {
                values.recorder.threads.await_reader();
            }
            return taken;
        }
        let kind = place.kind();
        let bytes = kind.bytes().ok_or(Abort::Access)? as u32;
        if length > bytes {
            return Err(Abort::TooLong);
        }
        if length < bytes {
            return Err(Abort::TooShort);
        }
        let raw = values
            .buffer
            .first_chunk::<8>()
            .copied()
            .unwrap_or_default();
        let number = kind.number(raw);
        place.admit(number)?;
        if let ObjectSource::Parameter(entry) = place {
            return values.take_parameter(entry, number, self.params);
        }
        values.take_number(object, number as u32, self.params)
    }

    fn abandon(&mut self, _object: Object) {
        self.values.length = 0;
    }
}
