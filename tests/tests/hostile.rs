//! Inputs that the fuzzers have found: each of them once did harm, and must not do so again. Besides them, pieces of them
//! that are changed at random, by the seed of the commit.

use std::fs;
use std::path::Path;

use leadscrew_tests::hostile;
use leadscrew_tests::random::Random;

/// Inputs at random for each door.
fn random_inputs() -> u32 {
    leadscrew_seed::amount(200, 1_500)
}
/// The longest of them.
const LONGEST: usize = 4096;

fn replay(corpus: &str, protection: fn(&[u8])) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../fuzz/corpus")
        .join(corpus);
    let mut files: Vec<_> = fs::read_dir(&folder)
        .unwrap_or_else(|error| panic!("{}: {error}", folder.display()))
        .map(|entry| entry.expect("an entry of the folder").path())
        .collect();
    files.sort();
    assert!(!files.is_empty(), "{} is empty", folder.display());
    let mut inputs = Vec::new();
    for file in files {
        println!("{}", file.display());
        let input = fs::read(&file).expect("a file of the corpus");
        protection(&input);
        inputs.push(input);
    }
    leadscrew_seed::only_fresh(|seed| {
        let mut random = Random(seed);
        for _ in 0..random_inputs() {
            let shown = Shown(changed(&mut random, &inputs));
            protection(&shown.0);
        }
    });
}

/// An input that is shown where it does harm, to be put into the corpus.
struct Shown(Vec<u8>);

impl Drop for Shown {
    fn drop(&mut self) {
        if std::thread::panicking() {
            eprintln!("the input: {}", self.0.escape_ascii());
        }
    }
}

fn place(random: &mut Random, length: usize) -> usize {
    random.within(0, length as i64) as usize
}

/// One of the inputs, changed in a few places.
fn changed(random: &mut Random, inputs: &[Vec<u8>]) -> Vec<u8> {
    let one = |random: &mut Random| &inputs[place(random, inputs.len() - 1)];
    let mut input = one(random).clone();
    for _ in 0..random.within(1, 8) {
        let at = place(random, input.len());
        let size = random.of(&[1, 1, 2, 4, 8, 100]);
        let end = (at + place(random, size)).min(input.len());
        match random.within(0, 6) {
            0 => input.insert(at, random.next_bits() as u8),
            1 => drop(input.drain(at..end)),
            2 => {
                let again = input[at..end].to_vec();
                input.splice(at..at, again);
            }
            3 => {
                // The rest of another input, or a piece of it.
                let other = one(random);
                let from = place(random, other.len());
                let piece = &other[from..];
                input.splice(at..end, piece.iter().copied());
            }
            4 => {
                let edge = random.of(&[0, 1, 0x7F, 0x80, 0xFE, 0xFF]);
                input[at..end].fill(edge);
            }
            _ => {
                if let Some(byte) = input.get_mut(at) {
                    *byte ^= 1 << random.within(0, 7);
                }
            }
        }
    }
    input.truncate(LONGEST);
    input
}

#[test]
fn program_text() {
    replay("program", hostile::program);
}

#[test]
fn macros_and_program_flow() {
    replay("language", hostile::language);
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
    replay("device", hostile::device);
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
