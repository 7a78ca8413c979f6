//! A board on the bus against other people's CANopen: the Python packages `canopen` and `python-can`.

use std::process::Command;

use crate::bus::ours;

/// What the set-up has prepared for these tests.
pub fn given(name: &str) -> String {
    std::env::var(name).unwrap_or_else(|_| {
        panic!("the variable {name} is not set; `cargo xtask vcan` prepares Python and the data sheet and sets it")
    })
}

/// Runs these tests; they are so many.
#[track_caller]
fn passes(tests: &str, count: u32) {
    let output = Command::new("timeout")
        .arg("600")
        .arg(given("CANOPEN_PYTHON"))
        .args(["-B", "-m", "unittest", tests])
        .current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/python"))
        .env("CANOPEN_EDS", given("CANOPEN_EDS"))
        .env("BOARD_SIM", ours("board-sim"))
        .env("LEADSCREW", ours("leadscrew"))
        .output()
        .unwrap();
    let report = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{report}");
    assert!(report.contains(&format!("Ran {count} test")), "{report}");
}

#[test]
fn the_python_package_canopen_operates_a_board() {
    passes("on_a_bus", 4);
}

#[test]
fn an_axis_homes_with_a_drive_of_other_making() {
    passes("home_on_a_bus", 5);
}

#[test]
fn a_drive_of_other_making_is_set_up_by_its_profile() {
    passes("profile_on_a_bus", 2);
}

#[test]
fn a_block_of_other_making_is_set_up_by_a_push() {
    passes("block_on_a_bus", 2);
}
