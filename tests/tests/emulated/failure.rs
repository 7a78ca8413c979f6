//! A board whose firmware fails starts anew, moves nothing, and says what happened.

use crate::board::{Board, field};

/// Fails like this in the middle of coming up or idling, and is asked what happened.
#[track_caller]
fn fails(way: &str, number: &str, words: &str) {
    let board = Board::start_with(&[&format!("provoke={way}@1000")]);
    board.wait_for("it has failed", |status| field(status, "state") == "alarm");
    let said = board.good(&["status"]);
    assert!(said.contains(number) && said.contains(words), "{said}");
    assert!(said.contains("1000 ticks after power-up"), "{said}");
    board.order("reset");
    board.wait_for("it is ready", |status| field(status, "state") == "idle");
}

#[test]
fn a_panic() {
    fails("panic", "4365", "panic in line");
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
    board.order("reset");
    let status = board.good(&["status", "--json"]);
    assert_eq!(field(&status, "state"), "alarm", "no reset helps");
}
