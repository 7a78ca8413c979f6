//! What an operator asks of the board between two programs.

use crate::board::{Board, example, field, program};

#[test]
fn a_stop_is_an_alarm_until_a_reset_and_a_program_runs_behind_it() {
    let board = Board::start();
    let status = board.good(&["status", "--json"]);
    assert_eq!(field(&status, "state"), "idle");
    board.order("stop");
    let status = board.wait_for("it stands", |status| field(status, "state") == "alarm");
    assert!(status.contains("4300"), "{status}");
    let refused = board.bad(&["run", &example("g84-tap.nc")], 4);
    assert!(refused.contains("leadscrew reset"), "{refused}");
    board.order("reset");
    board.wait_for("it is ready", |status| field(status, "state") == "idle");
    let ran = board.good(&["run", &example("g84-tap.nc"), "--json"]);
    assert_eq!(field(&ran, "ok"), "true");
}

/// One gateway at a time has the line: who has started the program is gone when another one lets it go on.
#[test]
fn a_program_in_feed_hold_outlives_its_gateway_and_is_resumed() {
    let board = Board::start();
    // Before it starts, so that nothing depends on how fast its time goes.
    board.order("hold");
    let path = program("O0001\nG98\nG0 X50 Z0\nG1 Z-20 F6000\nG0 Z5\nM30\n");
    let mut running = board.start_leadscrew(&["run", &path]);
    running.wait_for_words("in feed hold");
    running.end();
    let held = board.wait_for("it holds", |status| field(status, "state") == "hold");
    for (name, value) in [("program", "true"), ("mx", "0"), ("mz", "0")] {
        assert_eq!(field(&held, name), value, "{held}");
    }
    board.order("resume");
    let status = board.wait_for("it is over", |status| {
        // On a slow host the board misses the gateway that was killed only now, and holds once more.
        if field(status, "state") == "hold" {
            board.order("resume");
        }
        field(status, "state") == "idle"
    });
    for (name, value) in [("program", "false"), ("mx", "50"), ("mz", "5")] {
        assert_eq!(field(&status, name), value, "{status}");
    }
}
