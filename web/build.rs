//! Puts the examples into the machine of the page, each folder with the parameters of the machine file in it.

use std::fmt::Write as _;
use std::path::Path;

use leadscrew_common::params::{difference, load_text};
use leadscrew_core::alarm::Lang;
use leadscrew_core::params::{Params, Part};

/// A machine is built on the stack before it has its place: more than the 1 MiB that a WebAssembly module has by itself.
const STACK: usize = 8 << 20;

fn main() {
    if std::env::var("CARGO_CFG_TARGET_ARCH").as_deref() == Ok("wasm32") {
        println!("cargo::rustc-link-arg-cdylib=-zstack-size={STACK}");
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples");
    println!("cargo::rerun-if-changed={}", root.display());
    let mut out = String::from("&[\n");
    for folder in ["", "shop"] {
        let dir = root.join(folder);
        let file = std::fs::read_to_string(dir.join("leadscrew.toml")).expect("a machine file");
        let loaded = load_text("leadscrew.toml", &file, Lang::En);
        assert!(loaded.is_good(), "the machine file of {folder} is right");
        let mut programs: Vec<_> = std::fs::read_dir(&dir)
            .expect("a folder of examples")
            .filter_map(|entry| Some(entry.ok()?.path()))
            .filter(|path| path.extension().is_some_and(|end| end == "nc"))
            .collect();
        programs.sort();
        let _ = write!(out, "Folder {{ name: {folder:?}, values: &[");
        for change in difference::changes(&Params::slant_bed(), &loaded.params) {
            let part = match change.entry.part {
                Part::Whole => "Part::Whole".to_owned(),
                Part::Bit(bit) => format!("Part::Bit({bit})"),
                Part::Axis(axis) => format!("Part::Axis(Axis::{axis:?})"),
            };
            let _ = write!(out, "({}, {part}, {}),", change.entry.no, change.new);
        }
        out.push_str("], programs: &[\n");
        for path in programs {
            let name = path.file_name().expect("a name").to_string_lossy();
            let _ = writeln!(
                out,
                "({name:?}, include_str!({:?})),",
                path.canonicalize().expect("a path")
            );
        }
        out.push_str("] },\n");
    }
    out.push_str("]\n");
    let to = Path::new(&std::env::var("OUT_DIR").expect("cargo says where")).join("examples.rs");
    std::fs::write(to, out).expect("the examples can be written");
}
