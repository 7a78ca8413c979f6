//! The corpora of the fuzzers, replayed: what was once found hostile stays survived.

use std::fs;
use std::path::Path;

use leadscrew_tests::hostile;

fn replay(corpus: &str, door: fn(&[u8])) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../fuzz/corpus")
        .join(corpus);
    let mut files: Vec<_> = fs::read_dir(&folder)
        .unwrap_or_else(|error| panic!("{}: {error}", folder.display()))
        .map(|entry| entry.expect("an entry of the folder").path())
        .collect();
    files.sort();
    assert!(!files.is_empty(), "{} is empty", folder.display());
    for file in files {
        println!("{}", file.display());
        door(&fs::read(&file).expect("a file of the corpus"));
    }
}

#[test]
fn program_text() {
    replay("program", hostile::program);
}

#[test]
fn machine_and_operator() {
    replay("machine", hostile::machine);
}

#[test]
fn parameter_files() {
    replay("parameters", hostile::parameters);
}

#[test]
fn frames_of_sdo() {
    replay("sdo", hostile::sdo);
}

#[test]
fn messages_of_the_link() {
    replay("link", hostile::link);
}

#[test]
fn frames_of_anybody() {
    replay("station", hostile::station);
}

#[test]
fn sets_that_are_staged() {
    replay("staging", hostile::staging);
}

#[test]
fn lines_of_an_adapter() {
    replay("slcan", hostile::slcan);
}

#[test]
fn what_is_found_in_flash() {
    replay("stored", hostile::stored);
}
