//! What outlives a reset of the board: what its flash has kept, and the machine
//! around it. The firmware fails in the middle of a program, on purpose.

use crate::board::{Board, both, field, program, scratch};

/// Runs it, and the board fails in it; what `status --json` says behind that.
#[track_caller]
fn fails_in(board: &Board, text: &str) -> String {
    let output = board.leadscrew(&["run", &program(text), "--json"]);
    assert_eq!(output.status.code(), Some(3), "{}", both(&output));
    board.wait_for("it has started anew", |status| {
        field(status, "state") == "alarm"
    })
}

#[test]
fn parameters_are_those_that_were_pushed() {
    let board = Board::start_with(&["provoke=panic@line3+10"]);
    let file = scratch("pushed.toml");
    std::fs::write(&file, "rapid_rate.X = \"11 m/min\"\n9007 = \"14 %\"\n").expect("a file");
    board.good(&["params", "push", &file.display().to_string()]);
    let idle = |status: &str| field(status, "state") == "idle";
    let pushed = board.wait_for("the drives come up again", idle);
    let status = fails_in(&board, "O0001\nG98\nG1 Z-20 F6000\nM30\n");
    assert!(status.contains("4365"), "{status}");
    assert_eq!(field(&status, "parameters"), field(&pushed, "parameters"));
    board.order("reset");
    board.wait_for("it is ready", idle);
    assert_eq!(
        board.bad(&["params", "diff"], 1),
        "1004.1  increment_is_c             0             → 1\n\
         1420.X  rapid_rate.X               12000 mm/min  → 11000 mm/min\n\
         9007    spindle_tolerance_percent  15 %          → 14 %\n"
    );
}

/// The watchdog ends a tick that does not end; the tap that was in its hole then is known, and comes out in phase.
#[test]
fn a_tap_in_its_hole_is_known_behind_a_tick_that_hangs_and_is_brought_out() {
    let board = Board::start_with(&["provoke=hang@line5+4000"]);
    let status = fails_in(
        &board,
        "O0084\nG98\nG0 X50 Z0\nM29 S1000\nG84 Z-30 P9999 F1000\nG80\nM30\n",
    );
    assert!(status.contains("4363"), "{status}");
    assert!(status.contains("\"in_hole\":true"), "{status}");
    let refused = board.bad(&["retract"], 4);
    assert!(refused.contains("leadscrew reset"), "{refused}");
    board.order("reset");
    let status = board.wait_for("it is ready", |status| field(status, "state") == "idle");
    // The drives have kept their power, and are asked.
    assert_eq!(
        (field(&status, "mx"), field(&status, "mz")),
        ("50", "-30"),
        "{status}"
    );
    let refused = board.bad(&["run", &program("G98\nG0 Z5\nM30\n")], 1);
    assert!(refused.contains("a tap is in its hole"), "{refused}");
    board.good(&["retract"]);
    let status = board.good(&["status", "--json"]);
    assert!(status.contains("\"in_hole\":false"), "{status}");
    assert_ne!(field(&status, "mz"), "-30", "{status}");
}
