//! Reads the parameter definitions (`params/*.toml`) and the built-in machine, and writes the typed table of
//! `motion/src/params`.
//!
//! A `[[param]]` has `no`, sometimes `alias` (a second number of the same record) or `bit`, `name` (its key in machine
//! files), `accessor` (its function, where that is not `name`), `en` and `zh` (what it is), `type`, `unit`, `range` (as
//! printed in the sheets, in the unit), `default` (absent where the value belongs to a machine) and `sheet` (where it
//! comes from). `axes` makes one value an axis; `x_unit`, `rotary_unit` and `rotary_range` are those of X and C where
//! they differ. `rotary_none` ("max" or "min") allows C the value `none`, kept as the largest or smallest integer.
//! Values of the type `i16` share a place of the set, four of an axis.
//! `members` makes one parameter of each, with consecutive numbers; `{}` in the texts is the member.
// At build time a panic is the error message.
#![allow(
    clippy::panic,
    clippy::indexing_slicing,
    clippy::arithmetic_side_effects
)]

mod definition;
mod machine;
mod output;

// One parser of values for definitions, machine files and command lines.
#[allow(dead_code)]
#[path = "../src/params/unit.rs"]
mod unit;

use std::path::{Path, PathBuf};

fn main() {
    let manifest = PathBuf::from(std::env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default());
    let params = manifest.join("params");
    let mut tables = definition::Tables::default();
    for file in ["gsk980td.toml", "gsk988.toml", "motion.toml"] {
        definition::read_definitions(&params.join(file), &mut tables);
    }
    definition::check_unique(&tables.definitions);
    machine::read_machine(
        &params.join("machines/slant-bed.toml"),
        &mut tables.definitions,
    );
    tables.definitions.sort_by_key(|d| (d.no, d.values[0].part));
    let out = PathBuf::from(std::env::var_os("OUT_DIR").unwrap_or_default()).join("params.rs");
    if let Err(e) = std::fs::write(&out, output::generate(&tables)) {
        panic!("{}: {e}", out.display());
    }
    println!("cargo::rerun-if-changed=build");
    println!("cargo::rerun-if-changed=src/params/unit.rs");
}

fn read(path: &Path) -> String {
    println!("cargo::rerun-if-changed={}", path.display());
    match std::fs::read_to_string(path) {
        Ok(text) => text,
        Err(e) => panic!("{}: {e}", path.display()),
    }
}
