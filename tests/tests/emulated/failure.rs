//! A board whose firmware fails starts anew, moves nothing, and says what happened.

use addr2line::gimli::{Dwarf, EndianSlice, LittleEndian, SectionId};
use object::{Object as _, ObjectSection as _};

use crate::board::{Board, IMAGE, field, image_of};

/// Fails like this in the middle of coming up or idling, and is asked what happened.
#[track_caller]
fn fails(way: &str, number: &str, words: &str) -> String {
    let board = Board::start_with(&[&format!("provoke={way}@1000")]);
    board.wait_for("it has failed", |status| field(status, "state") == "alarm");
    let said = board.good(&["status"]);
    assert!(said.contains(number) && said.contains(words), "{said}");
    assert!(said.contains("1000 ticks after power-up"), "{said}");
    board.order("reset");
    board.wait_for("it is ready", |status| field(status, "state") == "idle");
    said
}

/// The addresses that it told, each as the lines of source it is from in the image:
/// innermost first, as `addr2line -i` has them.
fn told_lines(said: &str) -> Vec<Vec<String>> {
    let image = std::fs::read(image_of(IMAGE)).expect("the image");
    let file = object::File::parse(image.as_slice()).expect("an image");
    let dwarf = Dwarf::load(|id: SectionId| {
        let section = file.section_by_name(id.name());
        let data = section.and_then(|section| section.data().ok());
        Ok::<_, addr2line::gimli::Error>(EndianSlice::new(data.unwrap_or(&[]), LittleEndian))
    });
    let context = addr2line::Context::from_dwarf(dwarf.expect("sections"));
    let context = context.expect("debug information");
    let words = said.split([' ', ',']);
    let addresses = words.filter_map(|word| {
        let digits = word.strip_suffix('h').filter(|digits| digits.len() == 8)?;
        u64::from_str_radix(digits, 16).ok()
    });
    let lines = |address| {
        let mut frames = context.find_frames(address).skip_all_loads().expect("read");
        let mut lines = Vec::new();
        while let Some(frame) = frames.next().expect("read") {
            if let Some(location) = frame.location {
                let (file, line) = (location.file.unwrap_or("?"), location.line.unwrap_or(0));
                lines.push(format!("{file}:{line}"));
            }
        }
        lines
    };
    addresses.map(lines).collect()
}

/// Where these words stand in the source of what fails on purpose.
fn line_of(words: &str) -> String {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../firmware/mps2-an386/src/bus/provoke.rs"
    );
    let source = std::fs::read_to_string(path).expect("the source");
    let line = source.lines().position(|line| line.contains(words));
    format!(
        "src/bus/provoke.rs:{}",
        line.expect("the words stand in it") + 1
    )
}

/// The place is the line with these words, and what it was called from is in the image too.
#[track_caller]
fn panics_at(way: &str, words: &str) {
    let said = fails(way, "4365", "panic at");
    let told = told_lines(&said);
    let [place, within, ..] = told.as_slice() else {
        panic!("no addresses: {said}");
    };
    let first = place.first().expect("a line");
    assert!(first.ends_with(&line_of(words)), "{said} {told:?}");
    assert!(!within.is_empty(), "{said} {told:?}");
}

#[test]
fn a_panic() {
    panics_at("panic", "assert!(number > 0");
}

/// What stands between it and the line is left out.
#[test]
fn a_panic_of_the_library() {
    panics_at("divide", "1000 / number");
}

#[test]
fn a_fault_of_the_processor() {
    fails("fault", "4364", "processor fault at");
}

#[test]
fn a_stack_that_runs_over() {
    fails("stack", "4366", "its stack ran over");
}

#[test]
fn again_and_again_until_it_stays_at_rest() {
    let board = Board::start_with(&["provoke=panic@500*3"]);
    board.wait_for("it has failed three times", |status| {
        status.contains("4368")
    });
    let said = board.good(&["status"]);
    assert!(
        said.contains("3 times in a row") && said.contains("alarm 4365"),
        "{said}"
    );
    let refused = board.ordered(&["reset"], 4);
    assert!(refused.contains("4368"), "{refused}");
}
