//! Gives the module of the page a stack that its machine fits on.

/// A machine is built on the stack before it has its place: more than the 1 MiB that a WebAssembly module has by itself.
const STACK: usize = 8 << 20;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    if std::env::var("CARGO_CFG_TARGET_ARCH").as_deref() == Ok("wasm32") {
        println!("cargo::rustc-link-arg-cdylib=-zstack-size={STACK}");
    }
}
