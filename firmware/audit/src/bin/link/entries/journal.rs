//! Entries of the tap journal, their bytes and their checksum.

use audit::any::{any, sink};
use leadscrew_core::checksum::crc32;
use leadscrew_core::journal::TapRecord;

/// Calls all entries of this module.
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
    sink(crc32(any(), bytes));
    if let Ok(Some(record)) = TapRecord::decode(bytes) {
        sink(record);
    }
}
