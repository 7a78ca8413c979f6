//! Linker arguments of the image.

fn main() {
    let here = std::env::var("CARGO_MANIFEST_DIR").unwrap_or_default();
    println!("cargo:rustc-link-search={here}");
    println!("cargo:rerun-if-changed=memory.x");
    println!("cargo:rustc-link-arg-bins=--nmagic");
    // Who calls whom, for the bound of the stack. It stays on the host.
    println!("cargo:rustc-link-arg-bins=--emit-relocs");
    // First, for what it takes is not left for the other.
    println!("cargo:rustc-link-arg-bins=-Tpanicking.x");
    println!("cargo:rustc-link-arg-bins=-Tlink.x");
    if std::env::var_os("CARGO_FEATURE_DEFMT").is_some() {
        println!("cargo:rustc-link-arg-bins=-Tdefmt.x");
    }
}
