//! Linker arguments of the image.

fn main() {
    let here = std::env::var("CARGO_MANIFEST_DIR").unwrap_or_default();
    println!("cargo:rustc-link-search={here}");
    println!("cargo:rerun-if-changed=memory.x");
    println!("cargo:rerun-if-changed=second.x");
    println!("cargo:rustc-link-arg-bins=--nmagic");
    // The relocations hold the call graph, for the bound of the stack. They stay on the host.
    println!("cargo:rustc-link-arg-bins=--emit-relocs");
    // Before `link.x`, which would take the same sections.
    println!("cargo:rustc-link-arg-bins=-Tpanicking.x");
    println!("cargo:rustc-link-arg-bins=-Tsecond.x");
    println!("cargo:rustc-link-arg-bins=-Tlink.x");
    if std::env::var_os("CARGO_FEATURE_DEFMT").is_some() {
        println!("cargo:rustc-link-arg-bins=-Tdefmt.x");
    }
}
