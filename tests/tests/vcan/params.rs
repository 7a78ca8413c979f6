//! Parameters of a board on the bus: pushed, kept over a loss of power, compared.

use crate::bus::scratch;
use crate::machine::{Board, field, good, leadscrew, wait_for_status};

#[test]
fn what_is_pushed_is_there_after_the_power_was_gone() {
    let flash = scratch("pushed.flash");
    let file = scratch("pushed.toml");
    std::fs::write(
        &file,
        "# lathe\n9007 = \"14 %\"\nrapid_rate.X = \"11 m/min\"\n[drive.X]\nmax_profile_velocity = 500000\n",
    )
    .unwrap();
    let (flash, file) = (flash.to_str().unwrap(), file.to_str().unwrap());
    let board = Board::start(&["--state", flash]);
    let told = good(&leadscrew(&["params", "push", file]));
    assert!(
        told.starts_with(
            "1420.X   rapid_rate.X                    12000 mm/min  → 11000 mm/min\n\
             9007     spindle_tolerance_percent       15 %          → 14 %\n\
             drive X  607Fh:00h max_profile_velocity  10000000      → 500000\nstored and in force"
        ),
        "{told}"
    );
    let status = wait_for_status("the drives come up again", |status| {
        field(status, "state") == "idle"
    });
    let identity = field(&status, "parameters");
    board.kill();
    let _board = Board::start(&["--state", flash]);
    let status = wait_for_status("the board is up", |status| field(status, "state") == "idle");
    assert_eq!(field(&status, "parameters"), identity);
    let told = leadscrew(&["params", "diff"]);
    assert_eq!(told.status.code(), Some(1));
    assert_eq!(
        String::from_utf8(told.stdout).unwrap(),
        "1420.X  rapid_rate.X               12000 mm/min  → 11000 mm/min\n\
         9007    spindle_tolerance_percent  15 %          → 14 %\n\
         9027    late_setpoints             10            → 0\n",
        "a board in real time is started so that it only counts late setpoints"
    );
}
