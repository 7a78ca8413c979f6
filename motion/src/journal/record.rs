//! The entry of the tap journal and its bytes.
//!
//! | bytes | field |
//! |---|---|
//! | 0 | version, 1 |
//! | 1 | bit 0: in the hole; bit 1: axis Z (else X); bit 2: left hand; bit 3: inches |
//! | 2 | spindle, 1–4 |
//! | 3 | plane, 17–19 |
//! | 4–7 | sequence number |
//! | 8–15, 16–23 | R plane, bottom: nm |
//! | 24–31, 32–39 | lead: nm, turns |
//! | 40–43 | speed of the infeed: hundredths of a turn a minute |
//! | 44–47, 48–51 | extraction override: part, whole |
//! | 52–59 | position of the tap axis: nm |
//! | 60–67 | angle of the spindle: 2⁻³² turns |
//! | 68–71 | CRC-32 (ISO-HDLC) of all before |
//!
//! Values are little-endian, signed numbers in two's complement.

use super::bytes::{Reader, Writer};
use crate::alarm::Arg;
use crate::call::{Extraction, Hand, LengthUnit, Plane, TapAxis, TapNotes, TapSpindle};
use crate::checksum::crc32;
use crate::units::{CentiRpm, Diameter, Lead, Length, Turns};

const IN_HOLE: u8 = 1 << 0;
const AXIS_Z: u8 = 1 << 1;
const LEFT: u8 = 1 << 2;
const INCH: u8 = 1 << 3;

/// The data of a hole that the way out needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TapHole {
    /// The axis that carries the tap.
    pub axis: TapAxis,
    /// Coordinate of the R plane on that axis, in machine coordinates; X is a radius.
    pub level: Length,
    /// Coordinate of the programmed bottom; never equal to the R plane.
    pub bottom: Length,
    /// Travel of the axis per turn.
    pub lead: Lead,
    /// The direction of the spindle on the way in.
    pub hand: Hand,
    /// The spindle that turns the tap.
    pub spindle: TapSpindle,
    /// Speed of the spindle on the way in, above zero.
    pub speed: CentiRpm,
    /// Plane and unit of the hole in the program, and the extraction override.
    pub notes: TapNotes,
}

impl TapHole {
    /// −1 or +1: the direction into the hole along its axis.
    #[must_use]
    pub const fn inward(&self) -> i64 {
        if self.bottom.nm() < self.level.nm() {
            -1
        } else {
            1
        }
    }

    /// Letter of its axis.
    #[must_use]
    pub const fn letter(&self) -> u8 {
        match self.axis {
            TapAxis::X => b'X',
            TapAxis::Z => b'Z',
        }
    }

    /// A coordinate of its axis as an argument of a message: a diameter on X.
    #[must_use]
    pub const fn figure(&self, coordinate: Length) -> Arg {
        match self.axis {
            TapAxis::X => Arg::Diameter(Diameter::of_radius(coordinate)),
            TapAxis::Z => Arg::Length(coordinate),
        }
    }

    /// The depth of a coordinate below the R plane; negative above the R plane.
    #[must_use]
    pub fn depth(&self, coordinate: Length) -> Length {
        (coordinate - self.level).times(self.inward())
    }
}

/// The entry of the tap journal: a hole, and the positions of axis and spindle at the time of writing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TapRecord {
    /// Sequence number: one more in each entry; it wraps.
    pub sequence: u32,
    /// The tap is in the hole, or may be. Cleared after the tap has come out.
    pub in_hole: bool,
    /// The hole.
    pub hole: TapHole,
    /// Target position of the tap axis.
    pub position: Length,
    /// Target angle of the spindle.
    pub angle: Turns,
}

/// Why bytes are no entry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RecordError {
    /// An entry of another version: the version in the bytes, and the known version.
    Version(u8, u8),
    /// The number of bytes is wrong.
    Length(usize),
    /// The checksum is wrong.
    Damaged,
    /// The checksum is right, but a field has a value that no hole can have.
    Impossible,
}

impl TapRecord {
    /// Length of an entry.
    pub const BYTES: usize = 72;
    /// The version of written entries.
    pub const VERSION: u8 = 1;

    /// The entry as bytes.
    #[must_use]
    pub fn encode(&self) -> [u8; Self::BYTES] {
        let hole = &self.hole;
        let flag = |is: bool, bit: u8| if is { bit } else { 0 };
        let flags = flag(self.in_hole, IN_HOLE)
            | flag(hole.axis == TapAxis::Z, AXIS_Z)
            | flag(hole.hand == Hand::Left, LEFT)
            | flag(hole.notes.unit == LengthUnit::Inch, INCH);
        let spindle = hole.spindle.number();
        let plane = hole.notes.plane.code();
        let mut bytes = [0; Self::BYTES];
        let mut to = Writer::new(&mut bytes);
        to.word(u32::from_le_bytes([Self::VERSION, flags, spindle, plane]));
        to.word(self.sequence);
        to.long(hole.level.nm());
        to.long(hole.bottom.nm());
        to.long(hole.lead.numerator());
        to.long(hole.lead.denominator());
        to.word(hole.speed.get() as u32);
        to.word(hole.notes.extraction.part());
        to.word(hole.notes.extraction.whole());
        to.long(self.position.nm());
        to.long(self.angle.raw());
        if let Some((content, sum)) = bytes.split_last_chunk_mut() {
            *sum = crc32(0, content).to_le_bytes();
        }
        bytes
    }

    /// The entry in `bytes`; `None` where no entry was ever written: no bytes, or erased flash.
    ///
    /// # Errors
    /// Why the bytes are no entry.
    pub fn decode(bytes: &[u8]) -> Result<Option<Self>, RecordError> {
        if bytes.iter().all(|byte| *byte == 0xFF) {
            return Ok(None);
        }
        let Ok(entry) = <&[u8; Self::BYTES]>::try_from(bytes) else {
            return Err(RecordError::Length(bytes.len()));
        };
        let Some((content, sum)) = entry.split_last_chunk::<4>() else {
            return Err(RecordError::Length(bytes.len()));
        };
        if crc32(0, content) != u32::from_le_bytes(*sum) {
            return Err(RecordError::Damaged);
        }
        if let Some(version) = content.first()
            && *version != Self::VERSION
        {
            return Err(RecordError::Version(*version, Self::VERSION));
        }
        Self::read(content).map(Some).ok_or(RecordError::Impossible)
    }

    /// Reads the fields, with the same bounds as for a hole in a program.
    fn read(content: &[u8]) -> Option<Self> {
        let mut from = Reader::new(content);
        let [_, flags, spindle, plane] = from.take()?;
        if flags & !(IN_HOLE | AXIS_Z | LEFT | INCH) != 0 {
            return None;
        }
        let is = |bit: u8| flags & bit != 0;
        let sequence = u32::from_le_bytes(from.take()?);
        let level = length(from.take()?)?;
        let bottom = length(from.take()?)?;
        let lead = Lead::new(
            i64::from_le_bytes(from.take()?),
            i64::from_le_bytes(from.take()?),
        )?;
        let speed = i32::from_le_bytes(from.take()?);
        let extraction = Extraction::new(
            u32::from_le_bytes(from.take()?),
            u32::from_le_bytes(from.take()?),
        )?;
        let position = length(from.take()?)?;
        let angle = Turns::from_raw(i64::from_le_bytes(from.take()?));
        if speed <= 0 || level == bottom {
            return None;
        }
        Some(Self {
            sequence,
            in_hole: is(IN_HOLE),
            hole: TapHole {
                axis: if is(AXIS_Z) { TapAxis::Z } else { TapAxis::X },
                level,
                bottom,
                lead,
                hand: if is(LEFT) { Hand::Left } else { Hand::Right },
                spindle: TapSpindle::new(u32::from(spindle))?,
                speed: CentiRpm::new(speed),
                notes: TapNotes {
                    unit: if is(INCH) {
                        LengthUnit::Inch
                    } else {
                        LengthUnit::Metric
                    },
                    plane: Plane::new(plane)?,
                    extraction,
                },
            },
            position,
            angle,
        })
    }
}

/// A length within the range of the machine's arithmetic.
fn length(bytes: [u8; 8]) -> Option<Length> {
    let length = Length::from_nm(i64::from_le_bytes(bytes));
    length.is_in_range().then_some(length)
}

#[cfg(test)]
#[allow(clippy::arithmetic_side_effects, clippy::indexing_slicing)]
mod tests {
    use super::*;

    fn record() -> TapRecord {
        TapRecord {
            sequence: 0x0102_0304,
            in_hole: true,
            hole: TapHole {
                axis: TapAxis::Z,
                level: Length::from_nm(2_000_000),
                bottom: Length::from_nm(-50_000_000),
                lead: Lead::new(2_000_000_000, 1001).unwrap(),
                hand: Hand::Left,
                spindle: TapSpindle::Third,
                speed: CentiRpm::new(100_100),
                notes: TapNotes {
                    unit: LengthUnit::Inch,
                    plane: Plane::G19,
                    extraction: Extraction::new(150, 100).unwrap(),
                },
            },
            position: Length::from_nm(-1_234_567),
            angle: Turns::from_raw(-9_876_543_210),
        }
    }

    #[test]
    fn an_entry_comes_back_as_it_was() {
        let other = TapRecord {
            in_hole: false,
            hole: TapHole {
                axis: TapAxis::X,
                hand: Hand::Right,
                spindle: TapSpindle::First,
                notes: TapNotes::default(),
                ..record().hole
            },
            ..record()
        };
        for record in [record(), other] {
            assert_eq!(TapRecord::decode(&record.encode()), Ok(Some(record)));
        }
    }

    /// The layout is a contract with entries written by earlier versions.
    #[test]
    fn every_field_has_its_place() {
        let bytes = record().encode();
        assert_eq!(bytes[..4], [1, 0b1111, 3, 19]);
        assert_eq!(bytes[4..8], [4, 3, 2, 1]);
        assert_eq!(bytes[8..16], 2_000_000_i64.to_le_bytes());
        assert_eq!(bytes[16..24], (-50_000_000_i64).to_le_bytes());
        assert_eq!(bytes[24..32], 2_000_000_000_i64.to_le_bytes());
        assert_eq!(bytes[32..40], 1001_i64.to_le_bytes());
        assert_eq!(bytes[40..44], 100_100_i32.to_le_bytes());
        assert_eq!(bytes[44..48], 150_u32.to_le_bytes());
        assert_eq!(bytes[48..52], 100_u32.to_le_bytes());
        assert_eq!(bytes[52..60], (-1_234_567_i64).to_le_bytes());
        assert_eq!(bytes[60..68], (-9_876_543_210_i64).to_le_bytes());
        assert_eq!(bytes[68..], 0x0918_12BF_u32.to_le_bytes());
    }

    #[test]
    fn nothing_written_is_no_entry() {
        assert_eq!(TapRecord::decode(&[]), Ok(None));
        assert_eq!(TapRecord::decode(&[0xFF; TapRecord::BYTES]), Ok(None));
    }

    #[test]
    fn a_change_of_any_bit_is_noticed() {
        let bytes = record().encode();
        for bit in 0..bytes.len() * 8 {
            let mut changed = bytes;
            changed[bit / 8] ^= 1 << (bit % 8);
            assert_eq!(TapRecord::decode(&changed), Err(RecordError::Damaged));
        }
        for length in 1..bytes.len() {
            let short = &bytes[..length];
            assert_eq!(TapRecord::decode(short), Err(RecordError::Length(length)));
        }
    }

    fn with_sum(mut bytes: [u8; TapRecord::BYTES]) -> [u8; TapRecord::BYTES] {
        let sum = crc32(0, &bytes[..68]).to_le_bytes();
        bytes[68..].copy_from_slice(&sum);
        bytes
    }

    #[test]
    fn what_no_hole_can_give_is_refused_though_its_sum_fits() {
        let good = record().encode();
        assert_eq!(with_sum(good), good);
        let refused = |place: usize, field: &[u8]| {
            let mut bytes = good;
            bytes[place..place + field.len()].copy_from_slice(field);
            TapRecord::decode(&with_sum(bytes)).unwrap_err()
        };
        assert_eq!(refused(0, &[2]), RecordError::Version(2, 1));
        let beyond = ((1_i64 << 42) + 1).to_le_bytes();
        for (place, field) in [
            (1, &[0x10][..]),
            (2, &[0]),
            (2, &[5]),
            (3, &[16]),
            (8, &beyond),
            (16, &beyond),
            (16, &2_000_000_i64.to_le_bytes()),
            (24, &[0; 8]),
            (24, &(-1_i64).to_le_bytes()),
            (32, &[0; 8]),
            (40, &[0; 4]),
            (40, &(-1_i32).to_le_bytes()),
            (44, &[0; 4]),
            (48, &[0; 4]),
            (52, &beyond),
        ] {
            assert_eq!(refused(place, field), RecordError::Impossible, "{place}");
        }
    }

    #[test]
    fn depth_counts_from_r_into_the_hole() {
        let hole = record().hole;
        assert_eq!(hole.inward(), -1);
        assert_eq!(hole.depth(Length::ZERO), Length::from_nm(2_000_000));
        let turned = TapHole {
            level: hole.bottom,
            bottom: hole.level,
            ..hole
        };
        assert_eq!(turned.inward(), 1);
        assert_eq!(turned.depth(Length::from_nm(-50_000_001)).nm(), -1);
    }
}
