//! A simulated board that has kept a parameter set in its flash: it counts, and what is wrong with it stops the machine.

use leadscrew_board_sim::plant::Flash;
use leadscrew_core::board::{KeptSet, Mark, Region};
use leadscrew_core::params::{Entry, Params};
use leadscrew_store::Store;

use super::{Folder, code, leadscrew, stderr, stdout};

const PROGRAM: &str = "examples/shop/shaft-roughing.nc";

/// A board whose rapid rate on X is 9 m/min.
fn slow() -> Params {
    let mut params = Params::sheets();
    let rapid = Entry::find_text("1420.X").unwrap();
    params.set(rapid, 9_000_000_000).unwrap();
    params
}

/// Its flash in a file; `damage` for the bytes of the set.
fn state(folder: &Folder, damage: u8) -> String {
    let params = slow();
    let mut bytes = [0; Region::LONGEST];
    KeptSet {
        number: 1,
        params: &params,
    }
    .fill(&mut bytes);
    bytes[100] ^= damage;
    let mut store = Store::new(Flash::erased()).unwrap();
    store.write(Region::ParametersA, &bytes).unwrap();
    store
        .write(Region::ParametersMark, &Mark(1).encode())
        .unwrap();
    let file = folder.file("board.flash");
    std::fs::write(&file, store.into_flash().image()).unwrap();
    file
}

fn ticks(args: &[&str]) -> u64 {
    let output = leadscrew(&[&["run", PROGRAM, "--json"], args].concat());
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let text = stdout(&output);
    let last: serde_json::Value = serde_json::from_str(text.lines().last().unwrap()).unwrap();
    last["ticks"].as_u64().unwrap_or_else(|| panic!("{last}"))
}

#[test]
fn a_stored_set_is_the_boards_own() {
    let folder = Folder::new("kept");
    let file = state(&folder, 0);
    let built_in = ticks(&[]);
    let kept = ticks(&["--state", &file]);
    assert!(kept > built_in, "{kept} and {built_in}");
    // The same machine may be named; another may not.
    let same = ["--state", &file, "--set", "1420.X=9000"];
    assert_eq!(ticks(&same), kept);
    let output = leadscrew(&["run", PROGRAM, "--state", &file, "--set", "1420.X=10000"]);
    assert_eq!(code(&output), 2);
    assert!(
        stderr(&output).contains("params push --state"),
        "{}",
        stderr(&output)
    );
}

#[test]
fn a_damaged_one_stops_everything_and_says_so() {
    let folder = Folder::new("kept-damaged");
    let file = state(&folder, 1);
    let before = std::fs::read(&file).unwrap();
    let output = leadscrew(&["run", PROGRAM, "--state", &file]);
    assert_eq!(code(&output), 4, "{}", stderr(&output));
    assert!(stderr(&output).contains("4341"), "{}", stderr(&output));
    assert_eq!(std::fs::read(&file).unwrap(), before);
    let output = leadscrew(&["run", PROGRAM, "--state", &file, "--lang", "zh"]);
    assert!(
        stderr(&output).contains("内置参数集"),
        "{}",
        stderr(&output)
    );
}

#[test]
fn a_new_board_says_that_it_has_none() {
    let folder = Folder::new("kept-none");
    let file = folder.file("new.flash");
    let output = leadscrew(&["run", PROGRAM, "--state", &file]);
    assert_eq!(code(&output), 0);
    assert!(stderr(&output).contains("4972"), "{}", stderr(&output));
}
