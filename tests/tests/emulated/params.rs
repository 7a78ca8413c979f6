//! Parameters of the board: pulled, pushed as a whole or one by one, compared.

use crate::board::{Board, field, scratch};

/// Whatever carries the frames.
pub fn pulled_pushed_and_compared(board: &Board) {
    let pulled = scratch("pulled.toml");
    let pulled = pulled.display().to_string();
    board.good(&["params", "pull", "-o", &pulled]);
    assert_eq!(board.good(&["params", "diff", &pulled]), "no difference\n");

    let file = scratch("pushed.toml");
    std::fs::write(
        &file,
        "increment_is_c = 1\nrapid_rate.X = \"11 m/min\"\n[drive.X]\nmax_profile_velocity = 500000\n",
    )
    .expect("a place for a file");
    let file = file.display().to_string();
    let changes = "1420.X   rapid_rate.X                    12000 mm/min  → 11000 mm/min\n\
                   drive X  607Fh:00h max_profile_velocity  10000000      → 500000\n";
    assert!(
        board
            .bad(&["params", "diff", &file], 1)
            .starts_with(changes)
    );
    let told = board.good(&["params", "push", &file]);
    assert!(
        told.starts_with(changes) && told.contains("stored and in force"),
        "{told}"
    );
    board.wait_for("the drives come up again", |status| {
        field(status, "state") == "idle"
    });
    let told = board.bad(&["params", "diff", &pulled], 1);
    assert_eq!(told, "1420.X  rapid_rate.X  11000 mm/min  → 12000 mm/min\n");

    board.good(&["params", "set", "9007=14"]);
    board.wait_for("the drives come up again", |status| {
        field(status, "state") == "idle"
    });
    board.good(&["params", "restore"]);
    board.wait_for("the drives come up again", |status| {
        field(status, "state") == "idle"
    });
    let told = board.bad(&["params", "diff", &pulled], 1);
    assert_eq!(told, "1420.X  rapid_rate.X  11000 mm/min  → 12000 mm/min\n");
}

#[test]
fn over_the_serial_line() {
    pulled_pushed_and_compared(&Board::start());
}
