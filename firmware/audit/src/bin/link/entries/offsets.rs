//! The table of offsets and tools: its bytes, and what is read from it.

use audit::any::{any, sink};
use leadscrew_core::offsets::image::{BYTES, check};
use leadscrew_core::offsets::{Offsets, Source};
use leadscrew_core::params::Params;

/// Calls all entries of this module.
pub fn all() {
    image();
    source();
}

#[inline(never)]
fn image() {
    let bytes: [u8; BYTES + 8] = any();
    let bytes = bytes.get(..any()).unwrap_or(&bytes);
    sink(check(bytes));
    if let Ok(table) = Offsets::decode(bytes) {
        sink(table.encode());
    }
}

#[inline(never)]
fn source() {
    let params: Params = any();
    let table = Offsets::of_params(&params).ok();
    let source = Source {
        params: &params,
        table: table.as_ref(),
    };
    sink((source.zero(any()), source.tool(any()), source.nose(any())));
}
