//! The parameter sets that a board keeps: their bytes, and the choice between them at power-up.
//!
//! ```text
//! format (u16) · schema (u16) · number (u32) · image of the set (its table's key, values) · CRC-32 of all before
//! ```
//!
//! The board uses two places in turn. It stores a new set in the other place under the next number. Then it stores a *mark*
//! with the number of the newest set. So a loss of power leaves the old set or the new one, and the set before stays in its
//! place. A newest set that is damaged is noticed, although the storage may then return an older set in its place [D114].
//!
//! A fault is never passed over. The board starts with the last good set, or with the built-in set, so that it can
//! communicate; but it moves nothing until an operator has decided [D115]. A set of another parameter table is not read.
//!
//! Pure: bytes in, a decision out. Knows nothing of flash, of writing, or of the bus.

use super::kept_offsets::KeptOffsets;
use super::store::Region;
use crate::alarm::Code;
use crate::checksum::crc32;
use crate::link::{ImageReader, ImageWriter, identity};
use crate::params::{Params, SCHEMA, TABLE_KEY};
use crate::tick::{Found, StoreError};

/// Layout of these bytes.
const FORMAT: u16 = 1;
const HEAD: usize = 8;
const SUM: usize = 4;

/// One of the two places for a set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slot {
    /// The first place.
    A,
    /// The second place.
    B,
}

impl Slot {
    /// The other place.
    #[must_use]
    pub const fn other(self) -> Self {
        match self {
            Self::A => Self::B,
            Self::B => Self::A,
        }
    }
}

/// What is kept in two places with a mark.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kept {
    /// Parameter sets.
    Parameters,
    /// Tables of offsets and tools.
    Offsets,
}

impl Kept {
    /// The region of a place.
    pub const fn region(self, slot: Slot) -> Region {
        match (self, slot) {
            (Self::Parameters, Slot::A) => Region::ParametersA,
            (Self::Parameters, Slot::B) => Region::ParametersB,
            (Self::Offsets, Slot::A) => Region::OffsetsA,
            (Self::Offsets, Slot::B) => Region::OffsetsB,
        }
    }

    /// The region of the mark.
    pub const fn mark(self) -> Region {
        match self {
            Self::Parameters => Region::ParametersMark,
            Self::Offsets => Region::OffsetsMark,
        }
    }

    /// Why a change ends whose bytes could not be stored.
    pub const fn not_stored(self) -> Code {
        match self {
            Self::Parameters => Code::ParametersNotStored,
            Self::Offsets => Code::OffsetsNotStored,
        }
    }

    /// The warning where they are stored and their mark is not.
    pub const fn unmarked(self) -> Code {
        match self {
            Self::Parameters => Code::ParametersUnmarked,
            Self::Offsets => Code::OffsetsUnmarked,
        }
    }
}

/// A set on its way to its place.
#[derive(Clone, Copy, Debug)]
pub struct KeptSet<'a> {
    /// Its number: the highest is the newest.
    pub number: u32,
    /// The set, password included.
    pub params: &'a Params,
}

/// Bytes that are no set of this table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeptError {
    /// Damaged, or not a set at all.
    Damaged,
    /// A whole set of another table: its number, schema and key.
    Foreign {
        /// Number of the set.
        number: u32,
        /// Number of its table.
        schema: u16,
        /// Key of its table.
        key: u32,
    },
}

impl KeptSet<'_> {
    /// Bytes of a set.
    pub const BYTES: usize = HEAD + ImageWriter::BODY + SUM;

    /// Writes the bytes to the beginning of `into`. Returns the number of bytes that had room.
    pub fn fill(&self, into: &mut [u8]) -> usize {
        let [a, b] = FORMAT.to_le_bytes();
        let [c, d] = SCHEMA.to_le_bytes();
        let [e, f, g, h] = self.number.to_le_bytes();
        let head = [a, b, c, d, e, f, g, h];
        for (place, byte) in into.iter_mut().zip(head) {
            *place = byte;
        }
        if let Some(body) = into.get_mut(HEAD..Self::BYTES.saturating_sub(SUM)) {
            let _ = ImageWriter::with_password(self.params).read(0, body);
        }
        let sum = into
            .get(..Self::BYTES.saturating_sub(SUM))
            .map_or(0, |content| crc32(0, content));
        let tail = into.iter_mut().skip(Self::BYTES.saturating_sub(SUM));
        for (place, byte) in tail.zip(sum.to_le_bytes()) {
            *place = byte;
        }
        Self::BYTES.min(into.len())
    }

    /// Decodes `bytes` into `params` and returns the number of the set. Every value is then in its range, and the set has
    /// passed its own checks.
    ///
    /// # Errors
    /// [`KeptError`]; `params` is then no usable set.
    pub fn decode(bytes: &[u8], params: &mut Params) -> Result<u32, KeptError> {
        let (content, number) = open(bytes)?;
        let body = content.get(HEAD..).ok_or(KeptError::Damaged)?;
        let mut reader = ImageReader::new();
        let whole = reader.take(body, params).is_ok() && reader.has_body();
        if whole && params.first_out_of_range().is_none() && params.validate().is_ok() {
            return Ok(number);
        }
        Err(KeptError::Damaged)
    }
}

/// The bytes before the checksum, and the number of the set.
fn open(bytes: &[u8]) -> Result<(&[u8], u32), KeptError> {
    let (content, sum) = bytes.split_last_chunk::<SUM>().ok_or(KeptError::Damaged)?;
    if crc32(0, content) != u32::from_le_bytes(*sum) {
        return Err(KeptError::Damaged);
    }
    let (head, rest) = content
        .split_first_chunk::<HEAD>()
        .ok_or(KeptError::Damaged)?;
    let [a, b, c, d, e, f, g, h] = *head;
    let number = u32::from_le_bytes([e, f, g, h]);
    let schema = u16::from_le_bytes([c, d]);
    let key = rest
        .first_chunk::<4>()
        .map_or(0, |key| u32::from_le_bytes(*key));
    let ours = u16::from_le_bytes([a, b]) == FORMAT && key == TABLE_KEY;
    if !ours {
        return Err(KeptError::Foreign {
            number,
            schema,
            key,
        });
    }
    if bytes.len() != KeptSet::BYTES {
        return Err(KeptError::Damaged);
    }
    Ok((content, number))
}

/// A number by itself: of the newest set that has been stored, of the board's starts, or of erased pages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mark(pub u32);

impl Mark {
    /// Number of bytes.
    pub const BYTES: usize = 8;

    /// The bytes: the number and its CRC-32.
    #[must_use]
    pub fn encode(self) -> [u8; Self::BYTES] {
        let [a, b, c, d] = self.0.to_le_bytes();
        let [e, f, g, h] = crc32(0, &[a, b, c, d]).to_le_bytes();
        [a, b, c, d, e, f, g, h]
    }

    /// The mark in `bytes`; `None` where they are no mark.
    #[must_use]
    pub fn decode(bytes: &[u8]) -> Option<Self> {
        let bytes = <[u8; Self::BYTES]>::try_from(bytes).ok()?;
        let [a, b, c, d, ..] = bytes;
        let mark = Self(u32::from_le_bytes([a, b, c, d]));
        (mark.encode() == bytes).then_some(mark)
    }
}

/// Content of a region at power-up. `None`: nothing was ever stored in it.
pub type Held<'a> = Result<Option<&'a [u8]>, StoreError>;

/// The known state of the storage.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Shelved {
    /// The highest number given.
    pub number: u32,
    /// Slot and identity of the set that counts.
    pub stored: Option<(Slot, u32)>,
    /// Slot and identity of the last good set before it.
    pub before: Option<(Slot, u32)>,
    /// Slot of a set of another table.
    pub foreign: Option<Slot>,
}

impl Shelved {
    /// The place for the next set: never the place of a set that must stay.
    pub fn next(&self) -> Slot {
        match (self.stored, self.before, self.foreign) {
            (Some((slot, _)), ..) | (None, Some((slot, _)), _) | (None, None, Some(slot)) => {
                slot.other()
            }
            (None, None, None) => Slot::A,
        }
    }
}

/// The result of power-up: the parameter set of the board and the state of the storage.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PowerUp {
    /// The set to start with. Where [`found`](Self::found) is an alarm, it serves for communication only.
    pub params: Params,
    /// The state of the storage.
    pub found: Found,
    /// The table of offsets and tools.
    pub offsets: KeptOffsets,
    /// Which of its starts this is, from 1; 0: not known.
    pub start: u32,
    /// How often each page of the storage has been erased; 0 also where the count cannot be read.
    pub erases: u32,
    pub(super) shelved: Shelved,
}

impl PowerUp {
    /// For a board that is given its set and has none stored: simulations and tests that begin with a machine of their own.
    #[must_use]
    pub fn given(params: &Params) -> Self {
        Self {
            params: params.clone(),
            found: Found::Newest,
            offsets: KeptOffsets::default(),
            start: 0,
            erases: 0,
            shelved: Shelved::default(),
        }
    }

    /// Decides from the contents of the regions. `built_in` makes the board's built-in set. No table of offsets is known.
    #[must_use]
    pub fn of(built_in: impl Fn() -> Params, mark: Held<'_>, a: Held<'_>, b: Held<'_>) -> Self {
        let mut up = Self::given(&built_in());
        up.take(built_in, mark, a, b);
        up
    }

    /// The same in place: a chip's stack has no room for copies [D146].
    pub fn take(
        &mut self,
        built_in: impl Fn() -> Params,
        mark: Held<'_>,
        a: Held<'_>,
        b: Held<'_>,
    ) {
        let places = [
            SlotContent::of(a, &mut self.params),
            SlotContent::of(b, &mut self.params),
        ];
        (self.shelved, self.found) = decide(mark, places);
        let source = match self.found {
            Found::Newest => self.shelved.stored,
            Found::Older => self.shelved.before,
            Found::Nothing | Found::Lost | Found::Foreign { .. } => None,
        };
        let held = match source {
            Some((Slot::A, _)) => a,
            Some((Slot::B, _)) => b,
            None => Ok(None),
        };
        let loaded = held
            .ok()
            .flatten()
            .is_some_and(|bytes| KeptSet::decode(bytes, &mut self.params).is_ok());
        if !loaded {
            self.params = built_in();
        }
    }
}

/// What the contents of two places and of their mark mean.
pub(super) fn decide(mark: Held<'_>, [a, b]: [SlotContent; 2]) -> (Shelved, Found) {
    let unmarked = mark == Ok(None);
    let mark = mark.ok().flatten().and_then(Mark::decode);
    let number = [a.number(), b.number(), mark.map(|mark| mark.0)];
    let number = number.into_iter().flatten().max().unwrap_or(0);

    // `None` is below every number.
    let (newest, slot, other) = if b.number() > a.number() {
        (b, Slot::B, a)
    } else {
        (a, Slot::A, b)
    };
    let whole = |place: SlotContent, slot: Slot| place.identity().map(|identity| (slot, identity));
    let (first, second) = (whole(newest, slot), whole(other, slot.other()));
    // A set that is stored and not marked yet counts as stored.
    let is_newest = match mark {
        Some(mark) => newest.number() >= Some(mark.0),
        None => other != SlotContent::Damaged,
    };
    let mut shelved = Shelved {
        number,
        ..Shelved::default()
    };
    let found = match newest {
        SlotContent::Empty if unmarked && other == SlotContent::Empty => Found::Nothing,
        SlotContent::Empty | SlotContent::Damaged => Found::Lost,
        SlotContent::Foreign { schema, key, .. } => {
            shelved.before = second;
            shelved.foreign = Some(slot);
            Found::Foreign { schema, key }
        }
        SlotContent::Whole { .. } if is_newest => {
            (shelved.stored, shelved.before) = (first, second);
            Found::Newest
        }
        SlotContent::Whole { .. } => {
            shelved.before = first;
            Found::Older
        }
    };
    (shelved, found)
}

/// Content of one of the two slots.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SlotContent {
    Empty,
    Damaged,
    Foreign { number: u32, schema: u16, key: u32 },
    Whole { number: u32, identity: u32 },
}

impl SlotContent {
    fn of(held: Held<'_>, params: &mut Params) -> Self {
        match held {
            Ok(None) => Self::Empty,
            Err(_) => Self::Damaged,
            Ok(Some(bytes)) => match KeptSet::decode(bytes, params) {
                Ok(number) => Self::Whole {
                    number,
                    identity: identity(params),
                },
                Err(KeptError::Damaged) => Self::Damaged,
                Err(KeptError::Foreign {
                    number,
                    schema,
                    key,
                }) => Self::Foreign {
                    number,
                    schema,
                    key,
                },
            },
        }
    }

    const fn number(self) -> Option<u32> {
        match self {
            Self::Empty | Self::Damaged => None,
            Self::Foreign { number, .. } | Self::Whole { number, .. } => Some(number),
        }
    }

    const fn identity(self) -> Option<u32> {
        match self {
            Self::Whole { identity, .. } => Some(identity),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NONE: Held<'static> = Ok(None);

    const fn whole(number: u32) -> SlotContent {
        SlotContent::Whole {
            number,
            identity: number,
        }
    }

    const FOREIGN: SlotContent = SlotContent::Foreign {
        number: 2,
        schema: 9,
        key: 7,
    };

    fn decided(mark: Held<'_>, a: SlotContent, b: SlotContent) -> (Found, [Option<u32>; 2], Slot) {
        let (shelved, found) = decide(mark, [a, b]);
        let sets = [shelved.stored, shelved.before].map(|set| set.map(|(_, identity)| identity));
        (found, sets, shelved.next())
    }

    #[test]
    fn what_is_found_decides_what_counts_and_where_the_next_set_goes() {
        use Slot::{A, B};
        use SlotContent::{Damaged, Empty};
        let foreign = Found::Foreign { schema: 9, key: 7 };
        let marks = [1, 2, 3, 4].map(|number| Mark(number).encode());
        let [one, two, three, four] = marks.each_ref().map(|mark| Ok(Some(&mark[..])));
        let bad = Ok(Some(&[0_u8; 3][..]));
        let gone = Err(StoreError::Device);
        for (mark, a, b, expected) in [
            (NONE, Empty, Empty, (Found::Nothing, [None, None], A)),
            (one, Empty, Empty, (Found::Lost, [None, None], A)),
            (bad, Empty, Empty, (Found::Lost, [None, None], A)),
            (gone, Empty, Empty, (Found::Lost, [None, None], A)),
            // The set was stored, and the power went before the mark.
            (NONE, whole(1), Empty, (Found::Newest, [Some(1), None], B)),
            (
                two,
                whole(3),
                whole(2),
                (Found::Newest, [Some(3), Some(2)], B),
            ),
            (
                three,
                whole(3),
                whole(4),
                (Found::Newest, [Some(4), Some(3)], A),
            ),
            // The set before the newest does not matter.
            (two, Damaged, whole(2), (Found::Newest, [Some(2), None], A)),
            // The newest is gone, or may be.
            (two, whole(1), Damaged, (Found::Older, [None, Some(1)], B)),
            (four, whole(3), whole(2), (Found::Older, [None, Some(3)], B)),
            (bad, whole(1), Damaged, (Found::Older, [None, Some(1)], B)),
            (NONE, whole(1), Damaged, (Found::Older, [None, Some(1)], B)),
            (two, Damaged, Damaged, (Found::Lost, [None, None], A)),
            (NONE, Damaged, Empty, (Found::Lost, [None, None], A)),
            // Neither a set of another table nor the last good one is written over before there is a third.
            (two, FOREIGN, whole(1), (foreign, [None, Some(1)], A)),
            (two, Damaged, FOREIGN, (foreign, [None, None], A)),
            (one, whole(3), FOREIGN, (Found::Newest, [Some(3), None], B)),
        ] {
            assert_eq!(decided(mark, a, b), expected, "{mark:?} {a:?} {b:?}");
        }
    }

    #[test]
    fn a_number_is_never_given_twice() {
        let mark = Mark(9).encode();
        for (mark, a, b, number) in [
            (Ok(Some(&mark[..])), whole(3), SlotContent::Damaged, 9),
            (NONE, whole(3), FOREIGN, 3),
            (NONE, SlotContent::Empty, SlotContent::Empty, 0),
        ] {
            assert_eq!(decide(mark, [a, b]).0.number, number);
        }
    }
}
