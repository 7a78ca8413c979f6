//! G10: a program writes offsets.
//!
//! ```text
//! G10 P0 X Z               the shift of all work coordinate systems
//! G10 P1–P32 X Z Q         wear of an offset number, the direction of its nose    (Haas: L11)
//! G10 P10001–P10032 X Z R Q  its geometry, the radius and direction of its nose   (Haas: L10 P1–P32; L12: R alone)
//! G10 L2 P0–P6 X Z         the same shift, and the zeros of G54 to G59
//! ```
//!
//! X Z R set a value, U W C add to it. What is written counts from this block on for whatever reads offsets [D294]. This
//! module changes the table of the program that is read; who stores the table is not known here.

use super::state::{State, needs_words};
use crate::alarm::{Alarm, Arg, Code};
use crate::offsets::{Offset, Offsets, Record, SYSTEMS, TOOLS, Tool};
use crate::text::{Block, Letters, Word};
use crate::units::{Diameter, Length};

/// Words that give a value.
const VALUES: Letters = Letters::of(b"XUZWRCQ");
/// P of a geometry is this much more than the offset's number.
const GEOMETRY: u32 = 10_000;
/// One step of a table.
const STEP_NM: i64 = 100;

/// What a block writes to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Destination {
    Shift,
    Work(u8),
    Wear(u8),
    Geometry(u8),
    /// The radius of the nose, and no more.
    Radius(u8),
}

impl Destination {
    const fn record(self) -> Record {
        match self {
            Self::Shift => Record::Shift,
            Self::Work(index) => Record::Work(index.saturating_add(54)),
            Self::Wear(number) | Self::Geometry(number) | Self::Radius(number) => {
                Record::Tool(number)
            }
        }
    }

    /// The words that this place has values for.
    const fn letters(self) -> Letters {
        match self {
            Self::Shift | Self::Work(_) => Letters::of(b"LPXUZW"),
            Self::Wear(_) | Self::Geometry(_) => Letters::of(b"LPXUZWRCQ"),
            Self::Radius(_) => Letters::of(b"LPRC"),
        }
    }
}

impl State<'_> {
    /// G10.
    pub(super) fn write_offsets(&mut self, block: &Block, word: &Word) -> Result<(), Alarm> {
        let place = place(block, word)?;
        if !block.has_any(VALUES) {
            return Err(needs_words(word));
        }
        block.only(place.letters())?;
        let beyond = |record: Record| {
            let args = [Arg::Int(record.number().into())];
            word.alarm(Code::OffsetsOutOfRange).with(args)
        };
        let modal = &mut self.modal;
        // Without a table the parameters count; what they say begins one.
        let mut table = match modal.options.offsets {
            Some(table) => table,
            None => Offsets::of_params(modal.params).map_err(beyond)?,
        };
        self.write_to(&mut table, place, block)?;
        if table.beyond().is_some() {
            return Err(beyond(place.record()));
        }
        self.modal.options.offsets = Some(table);
        self.offsets_written = (self.offsets_written.0.saturating_add(1), word.span);
        self.modal.place_origin();
        Ok(())
    }

    fn write_to(
        &self,
        table: &mut Offsets,
        place: Destination,
        block: &Block,
    ) -> Result<(), Alarm> {
        let by_x = block.has_any(Letters::of(b"XU"));
        let by_z = block.has_any(Letters::of(b"ZW"));
        match place {
            Destination::Shift => self.write_offset(&mut table.shift, block),
            Destination::Work(index) => match table.work.get_mut(usize::from(index)) {
                Some(offset) => self.write_offset(offset, block),
                None => Ok(()),
            },
            Destination::Wear(number) => match table.tool_mut(number) {
                Some(tool) => {
                    // R0 stands in programs that clear all wear. The table has no other radius than that of the tool.
                    for word in [b'R', b'C']
                        .into_iter()
                        .filter_map(|letter| block.find(letter))
                    {
                        if self.modal.scale.length(&word)? != Length::ZERO {
                            return Err(word.alarm(Code::WearRadius));
                        }
                    }
                    self.write_offset(&mut tool.wear, block)?;
                    write_tip(tool, block)
                }
                None => Ok(()),
            },
            Destination::Geometry(number) | Destination::Radius(number) => {
                let Some(tool) = table.tool_mut(number) else {
                    return Ok(());
                };
                self.write_offset(&mut tool.geometry, block)?;
                tool.measured_x |= by_x;
                tool.measured_z |= by_z;
                tool.radius = self.written(block, b'R', b'C', tool.radius)?;
                write_tip(tool, block)
            }
        }
    }

    fn write_offset(&self, offset: &mut Offset, block: &Block) -> Result<(), Alarm> {
        let x = Length::from_nm(offset.x.nm());
        offset.x = Diameter::from_nm(self.written(block, b'X', b'U', x)?.nm());
        offset.z = self.written(block, b'Z', b'W', offset.z)?;
        Ok(())
    }

    /// The value that the words `set` or `add` make of `old`, in whole steps of a table. X is a diameter.
    fn written(&self, block: &Block, set: u8, add: u8, old: Length) -> Result<Length, Alarm> {
        let value = match (block.find(set), block.find(add)) {
            (Some(word), _) => self.modal.scale.length(&word)?,
            (None, Some(word)) => old + self.modal.scale.length(&word)?,
            (None, None) => return Ok(old),
        };
        let steps = value.nm().saturating_add(STEP_NM / 2).div_euclid(STEP_NM);
        Ok(Length::from_nm(steps.saturating_mul(STEP_NM)))
    }
}

/// Q: the direction of the nose, which is that of the number, whether its geometry or its wear is written.
fn write_tip(tool: &mut Tool, block: &Block) -> Result<(), Alarm> {
    if let Some(word) = block.find(b'Q') {
        tool.tip = word.count(Offsets::TIP.into())? as u8;
    }
    Ok(())
}

/// What P and L name.
fn place(block: &Block, g10: &Word) -> Result<Destination, Alarm> {
    const LIMIT: u32 = 99_999;
    const TOOL: u32 = TOOLS as u32;
    const LAST_SYSTEM: u32 = SYSTEMS as u32 - 1;
    let number = |letter| {
        let word = block.find(letter);
        word.map(|word| word.count(LIMIT)).transpose()
    };
    let kind = number(b'L')?.unwrap_or(0);
    let Some(p) = number(b'P')? else {
        return Err(g10.alarm(Code::DataPlace));
    };
    let within = |place: fn(u8) -> Destination, from: u32, last: u32| {
        let index = p.checked_sub(from).filter(|index| *index <= last);
        index.and_then(|index| u8::try_from(index).ok()).map(place)
    };
    let tool = |place: fn(u8) -> Destination| within(place, 0, TOOL).filter(|_| p != 0);
    let named = match kind {
        0 if p == 0 => Some(Destination::Shift),
        0 if p <= TOOL => tool(Destination::Wear),
        0 => within(Destination::Geometry, GEOMETRY, TOOL).filter(|_| p != GEOMETRY),
        2 if p == 0 => Some(Destination::Shift),
        2 => within(Destination::Work, 1, LAST_SYSTEM),
        10 => tool(Destination::Geometry),
        11 => tool(Destination::Wear),
        12 => tool(Destination::Radius),
        _ => None,
    };
    let blamed = block.find(b'P').unwrap_or(*g10);
    named.ok_or_else(|| blamed.alarm(Code::DataPlace))
}
