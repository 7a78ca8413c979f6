//! Linker arguments of the images.

fn main() {
    let here = std::env::var("CARGO_MANIFEST_DIR").unwrap_or_default();
    println!("cargo:rustc-link-search={here}");
    println!("cargo:rerun-if-changed=memory.x");
    println!("cargo:rustc-link-arg-bins=--nmagic");
    println!("cargo:rustc-link-arg-bin=link=-eentry");
    println!("cargo:rustc-link-arg-bin=board=-eentry");
    println!("cargo:rustc-link-arg-bin=ticks=-Tlink.x");
    println!("cargo:rustc-link-arg-bin=copies=-Tlink.x");
    if std::env::var_os("CARGO_FEATURE_DIAGNOSE").is_some() {
        // Keeps the call graph in the image.
        println!("cargo:rustc-link-arg-bin=link=--emit-relocs");
    }
}
