//! Entries of the tap journal and their bytes.

use audit::any::{any, sink};
use leadscrew_core::journal::TapRecord;

/// All of this room.
pub fn all() {
    record();
}

#[inline(never)]
fn record() {
    let record: TapRecord = any();
    sink(record.encode());
    sink(record.hole.depth(any()));
    let bytes: [u8; TapRecord::BYTES + 8] = any();
    let bytes = bytes.get(..any()).unwrap_or(&bytes);
    if let Ok(Some(record)) = TapRecord::decode(bytes) {
        sink(record);
    }
}
