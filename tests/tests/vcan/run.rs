//! `leadscrew run` against `board-sim` over the wire: the program goes through the board's memory as it has room, and the
//! setpoints are those of `--bus sim`.

use std::path::Path;

use crate::bus::{ours, tool};
use crate::machine::{
    Board, both, err, example, field, finish, good, leadscrew, out, program, run, wait_for_status,
};

/// What `--bus sim` makes of it.
fn simulated(path: &Path) -> String {
    let args = ["run", path.to_str().unwrap(), "--json"];
    let output = tool(ours("leadscrew").to_str().unwrap(), &args);
    out(&output)
}

/// Runs it in virtual time and compares all that the simulation says as well.
fn same_as_simulated(path: &Path) {
    same(path, &["max", "rms"]);
}

/// The same for what the two must always agree on, and for these.
fn same(path: &Path, more: &[&str]) {
    let simulated = simulated(path);
    let board = Board::start(&["--lockstep"]);
    let ran = good(&leadscrew(&["run", path.to_str().unwrap(), "--json"]));
    let always = ["ok", "moves", "setpoint_hash", "late", "warnings"];
    for name in always.iter().chain(more) {
        assert_eq!(
            field(&ran, name),
            field(&simulated, name),
            "{name} of {}\n{ran}\n{simulated}\n{}",
            path.display(),
            board.words()
        );
    }
    assert_eq!(threads(&ran), threads(&simulated), "{}", path.display());
    assert_eq!(field(&ran, "late"), "0");
    let (code, words) = board.interrupt();
    assert_eq!(code, Some(0), "{words}");
    assert!(words.contains(" 0 dropped"), "{words}");
}

/// The certificates of the threads, which the board keeps a few of and the gateway reads in time. Which of the drive's
/// positions are judged depends on the tick in which a program begins, so what is said of the cut is left out.
fn threads(result: &str) -> String {
    let (_, rest) = result.split_once("\"threads\":").expect("certificates");
    let (threads, _) = rest
        .split_once(",\"cut_apart_um\"")
        .expect("the cut behind them");
    assert!(threads.ends_with(",\"threads_missing\":0"), "{threads}");
    let (first, rest) = threads.split_once("\"cut\":{").unwrap_or((threads, ""));
    let cuts = rest
        .split("\"cut\":{")
        .filter_map(|cut| cut.split_once('}'));
    cuts.fold(first.to_owned(), |all, (_, behind)| all + behind)
}

/// Many times as many as the board keeps.
#[test]
fn no_certificate_of_forty_holes_is_missed() {
    let mut text = String::from("G98\nG0 X40 Z5 C0\nM29 S1500\nG84 C0 Z-4 R-3 F1500\n");
    for hole in 1..40 {
        text.push_str(&format!("C{}\n", hole * 9));
    }
    text.push_str("G80\nM30\n");
    let path = program("holes.nc", &text);
    assert_eq!(
        threads(&simulated(&path)).matches("\"rigid_tap\"").count(),
        40
    );
    same(&path, &[]);
}

#[test]
fn a_thread_by_g76_has_the_setpoints_of_the_simulation() {
    same_as_simulated(&example("o0013-g76-m68x6.nc"));
}

#[test]
fn grooves_by_g75_have_the_setpoints_of_the_simulation() {
    let path = program(
        "grooves.nc",
        "O0075\nG50 X40 Z20\nM3 S800\nG0 X34 Z-10\nG75 R0.3\nG75 X30 Z-16 P1000 Q6000 F200\nG0 X40 Z20\nM30\n",
    );
    same_as_simulated(&path);
}

#[test]
fn taps_rigid_and_floating_have_the_setpoints_of_the_simulation() {
    // The simulation judges a tap by the true angle of its spindle, a board by the one it measures.
    same(&example("g84-peck.nc"), &[]);
    same(&example("g84-floating.nc"), &[]);
}

#[test]
fn a_shaft_with_turning_grooves_and_thread_has_the_setpoints_of_the_simulation() {
    same_as_simulated(&example("shaft.nc"));
}

/// Calls wait in 2 KiB on the board; this is many times as much.
#[test]
fn a_program_far_larger_than_the_board_s_memory_goes_through() {
    let mut text = String::from("G50 X80 Z20\nM3 S1000\nG0 X60 Z2\nG98 G1 F8000\n");
    for n in 0..1_000 {
        text.push_str(&format!("X60.0{} Z2.0{}\n", n % 2 * 2, n % 2));
    }
    text.push_str("M30\n");
    same_as_simulated(&program("long.nc", &text));
}

/// Others on the wire may talk CAN FD: neither board nor gateway takes such a frame for a classical one, whatever its
/// identifier.
#[test]
fn fd_frames_of_others_do_no_harm() {
    let path = example("o0013-g76-m68x6.nc");
    let simulated = simulated(&path);
    let _board = Board::start(&["--lockstep"]);
    let mut running = run(&path, &[]);
    let mut rounds = 0;
    while running.try_wait().unwrap().is_none() {
        // NMT stop, a stop by RPDO1, a request to the board's server, an answer of it, a drive's status, a heartbeat. Only
        // a setpoint would tell of a second master.
        for frame in [
            "000##10200",
            "201##10705FFFFFFFF",
            "601##14000100000000000",
            "581##18020500000000206",
            "190##1370600000000",
            "701##100",
        ] {
            tool("cansend", &["vcan0", frame]);
        }
        rounds += 1;
    }
    assert!(rounds > 0);
    let ran = good(&finish(running));
    for name in ["ok", "moves", "setpoint_hash", "late"] {
        assert_eq!(field(&ran, name), field(&simulated, name), "{name}");
    }
}

#[test]
fn a_gateway_that_is_killed_in_a_thread_is_missed_and_the_machine_holds() {
    // Long enough for the five seconds, and whoever is slow besides.
    let path = program(
        "strokes.nc",
        "M3 S300\nG0 X64 Z6\nG76 P010060 Q400 R0.1\nG76 X60 Z-60 P8000 Q2000 F1\nM30\n",
    );
    let board = Board::start(&["--set", "9000=5000", "--set", "9024=5000"]);
    let mut running = run(&path, &[]);
    wait_for_status("a stroke runs", |status| {
        field(status, "state") == "run" && field(status, "sync_error_um") != "null"
    });
    running.kill().unwrap();
    running.wait().unwrap();
    wait_for_status("the machine holds", |status| {
        field(status, "state") == "hold"
    });
    let events = board.words();
    assert!(!events.contains("alarm"), "{events}");
    good(&leadscrew(&["reset"]));
    wait_for_status("it can be used again", |status| {
        field(status, "state") == "idle"
    });
}

#[test]
fn a_board_that_is_taken_away_in_mid_run_is_lost() {
    let board = Board::start(&["--set", "9000=5000", "--set", "9024=0"]);
    let running = run(&example("shaft.nc"), &[]);
    wait_for_status("the program runs", |status| {
        field(status, "state") == "run" && field(status, "line") != "0"
    });
    board.kill();
    let output = finish(running);
    assert_eq!(output.status.code(), Some(3), "{}", both(&output));
    let words = err(&output);
    assert!(
        words.contains("node 1") && words.contains("silent"),
        "{words}"
    );
}
