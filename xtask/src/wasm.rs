//! The WebAssembly target of the compiler, for the page.

use std::fs;

use anyhow::{Result, bail};

use crate::target;

pub const TARGET: &str = "wasm32-unknown-unknown";

/// Makes sure that the compiler has WebAssembly.
pub fn ensure() -> Result<()> {
    if is_there()? || target::by_rustup(TARGET) && is_there()? {
        return Ok(());
    }
    bail!(
        "the page needs the target {TARGET}: `rustup target add {TARGET}` fails; with a connection to its server it is \
         all that is needed"
    )
}

fn is_there() -> Result<bool> {
    let lib = target::rustlib()?.join(TARGET).join("lib");
    Ok(fs::read_dir(lib).is_ok_and(|mut entries| {
        entries.any(|entry| {
            entry.is_ok_and(|entry| entry.file_name().to_string_lossy().starts_with("libstd-"))
        })
    }))
}
