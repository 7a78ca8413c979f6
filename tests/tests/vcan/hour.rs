//! The first hour at a machine on the bus: `board-sim` in one process, `leadscrew` in others. It is what the machine of
//! `leadscrew up` does, command by command.

use std::path::PathBuf;

use leadscrew_tests::hour::{AT, NAME, PARAMS, PATIENT, POWER, Place, repository, type_hour};

use crate::bus::{INTERFACE, PATIENCE, ours, scratch};
use crate::machine::Board;

/// What the page shows otherwise: of its text, and what stands for it here.
const OTHERWISE: [(&str, &str); 4] = [
    ("sim:desk", INTERFACE),
    // Nothing is asserted about time.
    ("· 0 setpoints late ·", "· ... setpoints late ·"),
    (
        "error: no simulated machine `desk` is running; `leadscrew up --name desk` starts it\n",
        "error: no board answers as node 1 on ...\n",
    ),
    POWER,
];

/// A tick that a kernel booted as a program keeps up with, and what such a tick asks of observer and C.
const SLOW: [&str; 4] = ["9000=5000", "9005=15", "1420.C=200000", "1430.C=100000"];

/// Where the sockets of a machine may be: not on the files of another kernel.
fn sockets() -> PathBuf {
    let folder = match std::env::var_os("LEADSCREW_BOOTED") {
        Some(_) => PathBuf::from("/run/leadscrew-hour"),
        None => scratch("hour-sockets"),
    };
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

#[test]
fn the_first_hour_is_the_same_on_the_bus() {
    let folder = scratch("hour");
    std::fs::create_dir_all(&folder).unwrap();
    let sockets = sockets();
    let flash = scratch("hour.flash");
    let params = repository().join(PARAMS);
    let [x, z] = AT;
    let at = format!("X={x},Z={z}");
    let mut args = vec!["--name", NAME, "--params", params.to_str().unwrap()];
    args.extend(["--at", &at]);
    let settings = SLOW.iter().chain(&PATIENT);
    args.extend(settings.flat_map(|setting| ["--set", setting]));
    args.extend(["--state", flash.to_str().unwrap()]);
    let board = Board::start_with(INTERFACE, &args, &[("XDG_RUNTIME_DIR", &sockets)]);
    board.wait_for("ready");
    let place = Place {
        folder,
        sockets,
        program: ours("leadscrew"),
        patience: PATIENCE,
    };
    type_hour(&place, &OTHERWISE, &[" setpoints came late for their SYNC"]);
    // `down` has ended it.
    let (code, words) = board.wait();
    assert_eq!(code, Some(0), "{words}");
}
