//! Several clients on one bus, and what happens around the board.

use std::io::{Read as _, Write as _};
use std::os::unix::net::UnixStream;
use std::process::Stdio;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

use crate::{LONG, User, bad, good};

/// Reads until 3000 lines have come since it is `over`.
fn lines_until(client: &mut UnixStream, over: &AtomicBool) -> Vec<String> {
    const REST: usize = 3000;
    let (mut text, mut rest) = (Vec::new(), REST);
    while rest > 0 {
        let mut bytes = [0; 4096];
        let read = client.read(&mut bytes).unwrap();
        assert!(read > 0, "the machine has closed the connection");
        let read = &bytes[..read];
        if over.load(Ordering::Relaxed) {
            rest = rest.saturating_sub(read.iter().filter(|byte| **byte == b'\r').count());
        }
        text.extend(read);
    }
    let text = String::from_utf8(text).unwrap();
    // The last one may be cut.
    let whole = text.matches('\r').count();
    text.split('\r').take(whole).map(str::to_owned).collect()
}

#[test]
fn two_clients_see_the_same_frames_in_the_same_order() {
    let user = User::with_machine();
    let (mut a, mut b) = (user.client(), user.client());
    // Both read from the beginning: a client that does not is dropped.
    let over = [AtomicBool::new(false), AtomicBool::new(false)];
    let (seen_by_a, seen_by_b) = thread::scope(|scope| {
        let [a_is_over, b_is_over] = &over;
        let a = scope.spawn(move || lines_until(&mut a, a_is_over));
        let b = scope.spawn(move || lines_until(&mut b, b_is_over));
        // Two commands at once, whose frames and answers are among those of the board.
        let looks: Vec<_> = (0..2)
            .map(|_| {
                let mut look = user.command(&["status", "--json"]);
                look.stdout(Stdio::piped()).spawn().unwrap()
            })
            .collect();
        for look in looks {
            assert!(look.wait_with_output().unwrap().status.success());
        }
        // A reads on where B has ended.
        b_is_over.store(true, Ordering::Relaxed);
        let b = b.join().unwrap();
        a_is_over.store(true, Ordering::Relaxed);
        (a.join().unwrap(), b)
    });
    // Two answers to commands come first; B has begun to listen when A was listening, or the other way round.
    let (seen_by_a, seen_by_b) = (&seen_by_a[2..], &seen_by_b[2..]);
    assert!(
        seen_by_b.iter().any(|line| line.starts_with("t601")),
        "a request"
    );
    assert!(
        seen_by_b.iter().any(|line| line.starts_with("t581")),
        "an answer"
    );
    let all_of = |all: &[String], part: &[String]| all.windows(part.len()).any(|at| at == part);
    let from_b = &seen_by_b[100..];
    assert!(all_of(seen_by_a, from_b));
}

#[test]
fn a_client_that_does_not_read_is_dropped_and_a_program_runs_on() {
    let user = User::with_machine();
    good(&user.does(&["sim", "speed", "4"]));
    let deaf = user.client();
    let run = user.run(LONG);
    let end = std::time::Instant::now() + crate::LIMIT;
    while user.machine()["dropped"] == 0 {
        assert!(std::time::Instant::now() < end);
    }
    assert_eq!(user.json(&["status"])["state"], "run");
    drop(deaf);
    good(&user.does(&["reset"]));
    assert_eq!(run.wait_with_output().unwrap().status.code(), Some(4));
}

#[test]
fn the_emergency_stop_stops_and_waits_for_its_release_and_a_reset() {
    let user = User::with_machine();
    let run = user.run(LONG);
    let pressed = user.json(&["sim", "estop", "press"]);
    assert_eq!(pressed["machine"]["estop"], true);
    let told = bad(&run.wait_with_output().unwrap(), 4);
    assert!(told.contains("4300"), "{told}");
    let status = user.wait_for("alarm");
    assert_eq!(
        (&status["alarm"]["no"], &status["emergency_stop"]),
        (&4300.into(), &true.into())
    );
    // As long as it is pressed, a reset does not help.
    let told = bad(&user.does(&["reset"]), 4);
    assert!(told.contains("4300"), "{told}");
    assert_eq!(user.wait_for("alarm")["emergency_stop"], true);
    good(&user.does(&["sim", "estop", "release"]));
    good(&user.does(&["reset"]));
    assert_eq!(user.wait_for("idle")["emergency_stop"], false);
}

#[test]
fn a_pressed_feed_hold_holds_until_release_and_resume() {
    let user = User::with_machine();
    let run = user.run(LONG);
    good(&user.does(&["sim", "hold", "press"]));
    assert_eq!(user.wait_for("hold")["feed_hold"], true);
    good(&user.does(&["resume"]));
    user.wait_for("hold");
    good(&user.does(&["sim", "hold", "release"]));
    user.wait_for("hold");
    good(&user.does(&["resume"]));
    user.wait_for("run");
    good(&user.does(&["reset"]));
    assert_eq!(run.wait_with_output().unwrap().status.code(), Some(4));
}

#[test]
fn the_door_is_told_and_that_nothing_follows() {
    let user = User::with_machine();
    let open = user.json(&["sim", "door", "open"]);
    assert_eq!(open["machine"]["door"], "open");
    let note = open["note"]["en"].as_str().unwrap();
    assert!(note.contains("no input for the door"), "{note}");
    let told = good(&user.does(&["sim", "state"]));
    assert!(
        told.contains("power on, door open, emergency stop released"),
        "{told}"
    );
    assert_eq!(
        user.json(&["sim", "door", "close"])["machine"]["door"],
        "close"
    );
}

#[test]
fn machine_time_can_be_changed() {
    let user = User::with_machine();
    assert_eq!(
        user.json(&["sim", "speed", "0.25"])["machine"]["speed"],
        250
    );
    assert_eq!(user.json(&["sim", "speed", "2"])["machine"]["speed"], 2000);
    let program = user.program(crate::SHORT);
    good(&user.does(&["run", &program]));
    let told = good(&user.does(&["sim", "state"]));
    assert!(told.contains(" s at 2 times real time"), "{told}");
}

#[test]
fn whoever_speaks_the_language_of_the_socket_is_answered_line_by_line() {
    let user = User::with_machine();
    let mut caller = UnixStream::connect(user.socket("desk.ctl")).unwrap();
    caller.set_read_timeout(Some(crate::LIMIT)).unwrap();
    caller
        .write_all(b"{\"do\":\"fly\"}\n{\"do\":\"hold\",\"to\":\"press\"}\nx\n{\"do\":\"sta")
        .unwrap();
    caller.write_all(b"te\"}\n").unwrap();
    let mut text = String::new();
    while text.matches('\n').count() < 4 {
        let mut bytes = [0; 4096];
        let read = caller.read(&mut bytes).unwrap();
        assert!(read > 0, "{text}");
        text += std::str::from_utf8(&bytes[..read]).unwrap();
    }
    let answers: Vec<serde_json::Value> = text
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    assert_eq!(answers[0]["ok"], false);
    let why = answers[0]["error"]["en"].as_str().unwrap();
    assert!(
        why.contains("`fly`") && why.contains("another version"),
        "{why}"
    );
    assert_eq!(answers[1]["machine"]["hold"], true);
    assert_eq!(answers[2]["ok"], false);
    assert_eq!(
        answers[3]["machine"],
        answers[1]["machine"].clone().with(&answers[3])
    );
}

/// The same machine later: its time has gone on.
trait Later {
    fn with(self, other: &serde_json::Value) -> serde_json::Value;
}

impl Later for serde_json::Value {
    fn with(mut self, other: &serde_json::Value) -> Self {
        for time in ["ticks", "slips", "lost_ticks"] {
            self[time] = other["machine"][time].clone();
        }
        self
    }
}
