//! Reading and writing one value of a set, with its range.

use super::{Entry, PASSWORD_KEPT, PASSWORD_SLOT, Params, Part, ValueError, Writing};

/// Why a value was not taken; the set is unchanged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SetError {
    /// The text is no value of the unit.
    Value(ValueError),
    /// The value is outside the range of the entry.
    OutOfRange,
}

impl Entry {
    /// Place of the value in a set.
    pub const fn place(&self) -> usize {
        self.slot as usize
    }

    /// Where its 16 bits begin in its place; `None` where it has all of the place, or is a bit of it.
    fn shift(&self) -> Option<u32> {
        let quarter = self.quarter.checked_sub(1)?;
        Some(u32::from(quarter).wrapping_mul(16))
    }

    /// The bits of this number that mean something.
    pub fn byte_mask(&self) -> i64 {
        let same = Self::all().iter().filter(|entry| entry.slot == self.slot);
        same.fold(0, |mask, entry| match entry.part {
            Part::Bit(bit) => mask | 1_i64.wrapping_shl(u32::from(bit)),
            Part::Whole | Part::Axis(_) => mask,
        })
    }

    /// Whether `raw` may be stored.
    #[must_use]
    pub fn allows(&self, raw: i64) -> bool {
        (self.min()..=self.max()).contains(&raw) || self.none() == Some(raw)
    }

    /// The raw value of a text; `none` where the entry allows that.
    ///
    /// # Errors
    /// [`SetError`].
    pub fn parse(&self, text: &str, writing: Writing) -> Result<i64, SetError> {
        if let Some(none) = self.none()
            && text.trim().eq_ignore_ascii_case("none")
        {
            return Ok(none);
        }
        let raw = match self.unit().parse(text, writing) {
            Ok(raw) => raw,
            Err(ValueError::TooLarge) => return Err(SetError::OutOfRange),
            Err(e) => return Err(SetError::Value(e)),
        };
        // The value that stands for "none" has no number.
        if (self.min()..=self.max()).contains(&raw) {
            Ok(raw)
        } else {
            Err(SetError::OutOfRange)
        }
    }
}

impl Params {
    /// The value in a place of the set. An image of the set consists of these values.
    pub fn slot(&self, place: usize) -> Option<i64> {
        self.raw.get(place).copied()
    }

    /// What may be told of the value in a place: of a password only whether there is one.
    pub fn told_slot(&self, place: usize) -> Option<i64> {
        let raw = self.slot(place)?;
        if place == PASSWORD_SLOT && raw != 0 {
            return Some(PASSWORD_KEPT);
        }
        Some(raw)
    }

    /// What may be told of a value: of a number with bits all of it, of a password only whether there is one.
    #[must_use]
    pub fn told(&self, entry: &Entry) -> i64 {
        match entry.shift() {
            Some(_) => self.get(entry),
            None => self.told_slot(entry.place()).unwrap_or(0),
        }
    }

    /// The number that an entry is, or is a bit of.
    #[must_use]
    pub fn number(&self, entry: &Entry) -> i64 {
        match entry.part {
            Part::Bit(_) => self.whole(entry),
            Part::Whole | Part::Axis(_) => self.get(entry),
        }
    }

    /// Puts any value into a place of the set. Whoever does so asks [`first_out_of_range`](Self::first_out_of_range)
    /// before the set is used.
    pub fn put_slot(&mut self, place: usize, raw: i64) {
        if let Some(value) = self.raw.get_mut(place) {
            *value = raw;
        }
    }

    /// The number of the first value outside its range, undefined bits included; `None` where all may be stored.
    pub fn first_out_of_range(&self) -> Option<u16> {
        let beyond = Entry::all().iter().find(|entry| match entry.part {
            Part::Bit(_) => self.whole(entry) & !entry.byte_mask() != 0,
            Part::Whole | Part::Axis(_) => !entry.allows(self.get(entry)),
        })?;
        Some(beyond.no)
    }

    /// The whole value that an entry is, or is a bit of.
    pub(crate) fn whole(&self, entry: &Entry) -> i64 {
        self.slot(entry.place()).unwrap_or(0)
    }

    /// The raw value of an entry: whole steps of its unit; a bit is 0 or 1.
    #[must_use]
    pub fn get(&self, entry: &Entry) -> i64 {
        let raw = self.raw.get(usize::from(entry.slot)).copied().unwrap_or(0);
        match entry.part {
            Part::Bit(bit) => raw.wrapping_shr(u32::from(bit)) & 1,
            Part::Whole | Part::Axis(_) => match entry.shift() {
                Some(shift) => i64::from(raw.wrapping_shr(shift) as i16),
                None => raw,
            },
        }
    }

    /// Stores a raw value.
    ///
    /// # Errors
    /// [`SetError::OutOfRange`]; the set is unchanged.
    pub fn set(&mut self, entry: &Entry, raw: i64) -> Result<(), SetError> {
        if !entry.allows(raw) {
            return Err(SetError::OutOfRange);
        }
        if let Some(place) = self.raw.get_mut(usize::from(entry.slot)) {
            *place = match entry.part {
                Part::Bit(bit) => {
                    let mask = 1_i64.wrapping_shl(u32::from(bit));
                    if raw == 0 {
                        *place & !mask
                    } else {
                        *place | mask
                    }
                }
                Part::Whole | Part::Axis(_) => match entry.shift() {
                    Some(shift) => {
                        let mask = 0xFFFF_i64.wrapping_shl(shift);
                        *place & !mask | raw.wrapping_shl(shift) & mask
                    }
                    None => raw,
                },
            };
        }
        Ok(())
    }
}
