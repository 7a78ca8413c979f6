//! A table as bytes: object 5011h, and what a board stores of it.
//!
//! ```text
//! schema (u16) · 0 (u16) · revision (u32) · shift X Z
//! 6 × ( X Z · 0 (u64) )                                                        G54 to G59
//! 32 × ( geometry X Z · wear X Z · radius · tip · station · measured · 0 )     lengths i32, the rest bytes
//! X Z · angle (u32) · 0 (u32)                                                  the picked-up thread
//! CRC-32 of all before
//! ```
//!
//! All is little-endian; a length is in 0.1 µm, of X in diameter. `measured`: bit 0 X, bit 1 Z. The
//! angle of a picked-up thread is in 0.0001° and one more than it is, 0 where there is none. A board [checks](check) the
//! bytes, and reads of them their head and the tool in place.

use super::{Offset, Offsets, PickedUp, Record, Revision, STEP_NM, SYSTEMS, Source, TOOLS, Tool};
use crate::checksum::crc32;
use crate::params::Params;
use crate::units::{Angle, Diameter, Length};

/// Layout of these bytes.
const SCHEMA: u16 = 2;

const HEAD: usize = 16;
const WORK: usize = 16;
const TOOL: usize = 24;
const THREAD: usize = 16;
const SUM: usize = 4;
const TOOLS_END: usize = HEAD + SYSTEMS * WORK + TOOLS * TOOL;
const END: usize = TOOLS_END + THREAD;

/// Bytes of an image.
pub const BYTES: usize = END + SUM;

/// The bytes of a table.
pub type Image = [u8; BYTES];

/// Why bytes are no table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ImageFault {
    /// Too short, too long, or damaged.
    Damaged,
    /// A whole image of another layout, with this schema and revision.
    Schema(u16, Revision),
    /// This record has a value out of its range.
    Range(Record),
}

/// What identifies a whole image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Head {
    /// Its revision.
    pub revision: Revision,
    /// The CRC-32 at its end.
    pub sum: u32,
}

/// Checks an image: length, checksum, schema, and the range of every value.
///
/// # Errors
/// [`ImageFault`].
pub fn check(bytes: &[u8]) -> Result<Head, ImageFault> {
    let (content, sum) = bytes.split_last_chunk::<SUM>().ok_or(ImageFault::Damaged)?;
    let sum = u32::from_le_bytes(*sum);
    let (head, rest) = content
        .split_first_chunk::<HEAD>()
        .ok_or(ImageFault::Damaged)?;
    if crc32(0, content) != sum {
        return Err(ImageFault::Damaged);
    }
    let [a, b, zero @ .., r, s, t, u, _, _, _, _, _, _, _, _] = *head;
    let revision = Revision(u32::from_le_bytes([r, s, t, u]));
    let schema = u16::from_le_bytes([a, b]);
    if schema != SCHEMA {
        return Err(ImageFault::Schema(schema, revision));
    }
    if bytes.len() != BYTES {
        return Err(ImageFault::Damaged);
    }
    let beyond = |record| Err(ImageFault::Range(record));
    if zero != [0; 2] || !are_within(&head[8..], Offsets::WORK) {
        return beyond(Record::Shift);
    }
    let (work, tools) = rest.split_at_checked(SYSTEMS * WORK).unwrap_or_default();
    for (code, record) in (54..).zip(work.as_chunks::<WORK>().0) {
        let (offset, zero) = record.split_at_checked(8).unwrap_or_default();
        if !are_within(offset, Offsets::WORK) || zero != [0; 8] {
            return beyond(Record::Work(code));
        }
    }
    let (tools, thread) = tools.split_at_checked(TOOLS * TOOL).unwrap_or_default();
    for (number, record) in (1..).zip(tools.as_chunks::<TOOL>().0) {
        let (geometry, rest) = record.split_at_checked(8).unwrap_or_default();
        let (wear, rest) = rest.split_at_checked(8).unwrap_or_default();
        let good = are_within(geometry, Offsets::GEOMETRY)
            && are_within(wear, Offsets::WEAR)
            && matches!(*rest, [a, b, c, d, tip, station, measured, 0]
                if u32::from_le_bytes([a, b, c, d]) <= steps(Offsets::RADIUS)
                    && tip <= Offsets::TIP
                    && usize::from(station) <= TOOLS
                    && measured <= 3);
        if !good {
            return beyond(Record::Tool(number));
        }
    }
    let good = matches!(thread, [tip @ .., a, b, c, d, 0, 0, 0, 0]
        if are_within(tip, Offsets::WORK) && u32::from_le_bytes([*a, *b, *c, *d]) <= Offsets::ANGLE_STEPS);
    if !good {
        return beyond(Record::Thread);
    }
    Ok(Head { revision, sum })
}

/// The checksum at the end of an image, right or not.
#[must_use]
pub fn sum(image: &Image) -> u32 {
    image.last_chunk().map_or(0, |sum| u32::from_le_bytes(*sum))
}

/// The image of a table with nothing in it and revision 0.
#[must_use]
pub fn empty() -> Image {
    let mut image = [0; BYTES];
    let [a, b] = SCHEMA.to_le_bytes();
    [image[0], image[1]] = [a, b];
    seal(&mut image);
    image
}

/// The tool with this number in an image; `None` for 0 and for numbers that no tool has.
#[must_use]
pub fn tool(image: &Image, number: u8) -> Option<Tool> {
    let index = usize::from(number).checked_sub(1)?;
    let tools = image.get(HEAD.saturating_add(SYSTEMS.saturating_mul(WORK))..TOOLS_END)?;
    let record = tools.as_chunks::<TOOL>().0.get(index)?;
    Some(Reader(record).tool())
}

/// Where the machine is with the tip of a tool at zero, by a board's table or by its parameters; `None` where nobody knows.
#[must_use]
pub fn tip_of(number: u8, params: &Params, image: &Image) -> Option<[Length; 2]> {
    if revision(image) == Revision::default() {
        return Source {
            params,
            table: None,
        }
        .tip(number);
    }
    tool(image, number)?.tip()
}

/// The revision of an image.
#[must_use]
pub fn revision(image: &Image) -> Revision {
    let [_, _, _, _, a, b, c, d, ..] = *image;
    Revision(u32::from_le_bytes([a, b, c, d]))
}

/// Puts the checksum at the end.
fn seal(image: &mut Image) {
    if let Some((content, sum)) = image.split_last_chunk_mut::<SUM>() {
        *sum = crc32(0, content).to_le_bytes();
    }
}

/// True where all lengths in `bytes` are of this magnitude at most.
fn are_within(bytes: &[u8], most: Length) -> bool {
    let (lengths, _) = bytes.as_chunks::<4>();
    let mut lengths = lengths.iter().map(|length| i32::from_le_bytes(*length));
    lengths.all(|length| length.unsigned_abs() <= steps(most))
}

const fn steps(length: Length) -> u32 {
    (length.nm() / STEP_NM) as u32
}

impl Offsets {
    /// The image of the table.
    ///
    /// # Errors
    /// The first record with a value out of its range.
    pub fn encode(&self) -> Result<Image, Record> {
        if let Some(record) = self.beyond() {
            return Err(record);
        }
        let mut image = [0; BYTES];
        let mut at = Writer(&mut image);
        at.put(&SCHEMA.to_le_bytes());
        at.put(&[0; 2]);
        at.put(&self.revision.0.to_le_bytes());
        at.offset(self.shift);
        for work in &self.work {
            at.offset(*work);
            at.put(&[0; 8]);
        }
        for tool in &self.tools {
            at.offset(tool.geometry);
            at.offset(tool.wear);
            at.length(tool.radius.nm());
            let measured = u8::from(tool.measured_x) | u8::from(tool.measured_z) << 1;
            at.put(&[tool.tip, tool.station, measured, 0]);
        }
        let PickedUp { tip, angle } = self.thread;
        at.offset(tip);
        let steps = angle.map_or(0, |angle| {
            ((angle.udeg() / Self::ANGLE_STEP_UDEG) as u32).saturating_add(1)
        });
        at.put(&steps.to_le_bytes());
        seal(&mut image);
        Ok(image)
    }

    /// The table of an image.
    ///
    /// # Errors
    /// As [`check`].
    pub fn decode(bytes: &[u8]) -> Result<Self, ImageFault> {
        let head = check(bytes)?;
        let mut table = Self {
            revision: head.revision,
            ..Self::default()
        };
        let mut from = Reader(bytes.get(8..).unwrap_or_default());
        table.shift = from.offset();
        for work in &mut table.work {
            *work = from.offset();
            let _: [u8; 8] = from.take();
        }
        for tool in &mut table.tools {
            *tool = from.tool();
        }
        let tip = from.offset();
        let steps = u32::from_le_bytes(from.take()).checked_sub(1);
        let angle =
            |steps| Angle::from_udeg(i64::from(steps).saturating_mul(Self::ANGLE_STEP_UDEG));
        table.thread = PickedUp {
            tip,
            angle: steps.map(angle),
        };
        Ok(table)
    }
}

/// Writes front to back.
struct Writer<'a>(&'a mut [u8]);

impl Writer<'_> {
    fn put(&mut self, bytes: &[u8]) {
        let place = core::mem::take(&mut self.0);
        if let Some((place, rest)) = place.split_at_mut_checked(bytes.len()) {
            place.copy_from_slice(bytes);
            self.0 = rest;
        }
    }

    fn length(&mut self, nm: i64) {
        self.put(&((nm / STEP_NM) as i32).to_le_bytes());
    }

    fn offset(&mut self, offset: Offset) {
        self.length(offset.x.nm());
        self.length(offset.z.nm());
    }
}

/// Reads front to back; zeros behind the end.
struct Reader<'a>(&'a [u8]);

impl Reader<'_> {
    fn take<const N: usize>(&mut self) -> [u8; N] {
        let Some((bytes, rest)) = self.0.split_first_chunk() else {
            return [0; N];
        };
        self.0 = rest;
        *bytes
    }

    fn length(&mut self) -> i64 {
        i64::from(i32::from_le_bytes(self.take())).saturating_mul(STEP_NM)
    }

    fn offset(&mut self) -> Offset {
        Offset {
            x: Diameter::from_nm(self.length()),
            z: Length::from_nm(self.length()),
        }
    }

    fn tool(&mut self) -> Tool {
        let (geometry, wear) = (self.offset(), self.offset());
        let radius = Length::from_nm(self.length());
        let [tip, station, measured, _] = self.take();
        Tool {
            geometry,
            wear,
            radius,
            tip,
            station,
            measured_x: measured & 1 != 0,
            measured_z: measured & 2 != 0,
        }
    }
}
