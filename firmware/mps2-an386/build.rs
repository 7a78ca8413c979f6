//! Linker arguments of the image, and the examples it runs.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

fn main() {
    let here = PathBuf::from(std::env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default());
    println!("cargo:rustc-link-search={}", here.display());
    println!("cargo:rerun-if-changed=memory.x");
    println!("cargo:rustc-link-arg-bins=--nmagic");
    // Before `link.x`, which would take the same sections.
    println!("cargo:rustc-link-arg-bins=-Tpanicking.x");
    println!("cargo:rustc-link-arg-bins=-Tlink.x");
    if std::env::var_os("CARGO_FEATURE_DEFMT").is_some() {
        println!("cargo:rustc-link-arg-bins=-Tdefmt.x");
    }

    let examples = here.join("../../examples");
    println!("cargo:rerun-if-changed={}", examples.display());
    let out = PathBuf::from(std::env::var_os("OUT_DIR").unwrap_or_default());
    std::fs::write(out.join("examples.rs"), table(&examples))
        .expect("the build folder is writable");
}

/// The name and text of every example, sorted by name.
fn table(folder: &Path) -> String {
    let entries = std::fs::read_dir(folder).expect("there are examples");
    let mut paths: Vec<PathBuf> = entries
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.extension().is_some_and(|ending| ending == "nc"))
        .collect();
    paths.sort();
    let mut text = String::from("&[\n");
    for path in paths {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        // Writing to a string cannot fail.
        let _ = writeln!(text, "    ({name:?}, include_bytes!({path:?})),");
    }
    text.push(']');
    text
}
