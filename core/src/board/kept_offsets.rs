//! The tables of offsets and tools that a board keeps: the choice between them at power-up.
//!
//! A table is kept as a parameter set is ([`kept`](super::kept)): two places in turn and a mark. Its revision is its
//! number, and its bytes are its image. A fault withholds no motion: what is withheld is `run`, for a program names the
//! revision it was resolved with [D288].
//!
//! Pure: bytes in, a decision out.

use super::kept::{Held, Shelved, Slot, SlotContent, decide};
use crate::offsets::image::{self, Image, ImageFault, check, empty};
use crate::tick::Found;

/// The result of power-up: the table of the board and the state of its storage.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct KeptOffsets {
    /// The table in force: the newest, the one before where that is damaged, or one with nothing in it.
    pub table: Image,
    /// The state of the storage.
    pub found: Found,
    pub(super) shelved: Shelved,
}

impl Default for KeptOffsets {
    /// Nothing was ever stored.
    fn default() -> Self {
        Self {
            table: empty(),
            found: Found::Nothing,
            shelved: Shelved::default(),
        }
    }
}

impl KeptOffsets {
    /// Takes the contents of the regions.
    pub fn take(&mut self, mark: Held<'_>, a: Held<'_>, b: Held<'_>) {
        (self.shelved, self.found) = decide(mark, [place(a), place(b)]);
        let source = self.shelved.stored.or(self.shelved.before);
        let held = match source {
            Some((Slot::A, _)) => a,
            Some((Slot::B, _)) => b,
            None => return,
        };
        if let Ok(Some(bytes)) = held
            && let Some(table) = bytes.first_chunk::<{ image::BYTES }>()
        {
            self.table = *table;
        }
    }
}

fn place(held: Held<'_>) -> SlotContent {
    match held {
        Ok(None) => SlotContent::Empty,
        Err(_) => SlotContent::Damaged,
        Ok(Some(bytes)) => match check(bytes) {
            Ok(head) => SlotContent::Whole {
                number: head.revision.0,
                identity: head.sum,
            },
            Err(ImageFault::Schema(schema, revision)) => SlotContent::Foreign {
                number: revision.0,
                schema,
                key: 0,
            },
            Err(ImageFault::Damaged | ImageFault::Range(_)) => SlotContent::Damaged,
        },
    }
}
