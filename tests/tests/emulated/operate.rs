//! What an operator asks of the board between two programs.

use crate::board::{Board, example, field};

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
