//! The faults that `board-sim` offers on its command line, each in a process of its own with its own program: what it says,
//! and how it ends. What the machine does about each stands in the tests of `faults`.

use crate::bus::tool;
use crate::machine::{
    Board, bad, both, err, example, field, finish, good, leadscrew, program, run, wait_for_status,
};

/// What `board-sim` says at its end: how many ticks it has taken.
fn ticks(said: &str) -> u64 {
    let line = said.lines().find(|line| line.contains(" setpoints late, "));
    let number = line.and_then(|line| line.strip_prefix("board-sim: ")?.split(' ').next());
    let number = number.and_then(|number| number.parse().ok());
    number.unwrap_or_else(|| panic!("no number of ticks: {said}"))
}

/// A thread of two passes and a groove: some 4 000 ticks.
const WORK: &str = "M3 S600\nG0 X64 Z6\nG76 P010060 Q800 R0.1\nG76 X60 Z-6 P8000 Q7000 F1\nG0 X61 Z-3\n\
                    G98 G75 R0.2\nG75 X58 P10000 F600\nG0 X70 Z8\nM30\n";

/// Ticks after which a machine that does not come to its end is given up.
const LIMIT: u64 = 150_000;

/// Runs the program with these options and without a gateway, in virtual time: exit code and words.
fn alone(text: &str, options: &[&str]) -> (Option<i32>, String) {
    let limit = LIMIT.to_string();
    let path = program("faults.nc", text);
    let mut args = vec![
        "--lockstep",
        "--program",
        path.to_str().unwrap(),
        "--ticks",
        &limit,
    ];
    args.extend(options);
    let (code, said) = Board::start_on(crate::bus::INTERFACE, &args).wait();
    // There it ends with exit code 0, too.
    assert!(ticks(&said) < LIMIT, "{options:?}: {said}");
    (code, said)
}

#[test]
fn every_option_has_its_alarm_or_none() {
    let cases: [(&[&str], Option<i32>, &str); 20] = [
        (&[], Some(0), "0 setpoints late"),
        (
            &["--bus-off", "2500"],
            Some(4),
            "alarm: bus-off: the board's CAN controller has left the bus (255 errors sending, 96 receiving)",
        ),
        (
            &["--error-passive", "2500..2600"],
            Some(4),
            "alarm: the board's CAN controller is error passive (136 errors sending, 40 receiving)",
        ),
        (
            &["--cable-out", "2500..2700"],
            Some(4),
            "has sent no status for 12 ticks",
        ),
        (&["--cable-out", "2500..2502"], Some(0), "by intent"),
        (
            &["--late", "2500..2511"],
            Some(4),
            "alarm: 11 setpoints came late for their SYNC within a second, limit 10",
        ),
        (&["--late", "2500..2510"], Some(0), "10 setpoints late"),
        (
            &["--late", "2500..2511", "--set", "9027=0"],
            Some(0),
            "11 setpoints late",
        ),
        (
            &["--second-master", "sync@2500..2501"],
            Some(4),
            "alarm: another node on the bus sends SYNC",
        ),
        (
            &["--second-master", "setpoint:Z@2500..2501"],
            Some(4),
            "alarm: another node sends setpoints to drive Z (node 17)",
        ),
        (
            &["--second-master", "stop:X@2500"],
            Some(4),
            "alarm: another node has stopped or restarted drive X (node 16) by NMT",
        ),
        (
            &["--lose", "statuses=1000"],
            Some(4),
            "has sent no status for 12 ticks",
        ),
        (
            &[
                "--lose", "all=2", "--double", "all=20", "--swap", "all=20", "--seed", "3",
            ],
            Some(0),
            "doubled",
        ),
        (
            &["--trouble", "Z=silent@2500"],
            Some(4),
            "alarm: drive Z (node 17) has sent no status for 12 ticks",
        ),
        (
            &["--trouble", "Z=cut-off@2500", "--trouble", "Z=none@2530"],
            Some(4),
            "alarm: drive Z (node 17) has sent no status for 12 ticks",
        ),
        (
            &["--trouble", "X=fault:7305@2500"],
            Some(4),
            "alarm: drive X (node 16) has a fault: statusword 0218h",
        ),
        (
            &["--trouble", "X=torque-off@2500"],
            Some(4),
            "alarm: drive X (node 16) left operation enabled by itself",
        ),
        (
            &["--trouble", "X=restart@2500"],
            Some(4),
            "alarm: drive X (node 16) restarted",
        ),
        (
            &["--lost-index", "10"],
            Some(4),
            "no index pulse from the spindle encoder",
        ),
        (&["--cut-power", "2500"], Some(4), "the power is cut"),
    ];
    for (options, code, words) in cases {
        let (got, said) = alone(WORK, options);
        assert_eq!(got, code, "{options:?}: {said}");
        assert!(said.contains(words), "{options:?}: {said}");
    }
}

#[test]
fn flash_that_fails_stops_a_tap_before_its_hole() {
    let tap = "G98 G0 X50 Z5\nM29 S1000\nG84 Z-12 R-5 F2000\nG80\nM30\n";
    assert_eq!(alone(tap, &[]).0, Some(0));
    let (code, said) = alone(tap, &["--flash-fails", "0"]);
    assert_eq!(code, Some(4), "{said}");
    assert!(
        said.contains("the tap journal could not be written"),
        "{said}"
    );
}

/// A parameter set that is torn on its way into the flash, at its beginning, in the middle and near its end.
#[test]
fn power_that_goes_in_a_write_leaves_the_old_set_or_the_new_one() {
    let mut outcomes = [0, 0];
    for torn in ["1", "100:half", "700", "1200:half", "100000"] {
        let board = Board::start(&["--lockstep", "--torn-write", torn]);
        let pushed = leadscrew(&["params", "push", "--set", "9007=12"]);
        let whole = torn == "100000";
        assert_eq!(
            pushed.status.code() == Some(0),
            whole,
            "{torn}: {}",
            both(&pushed)
        );
        if !whole {
            board.wait_for("the power goes in the middle of a write");
            board.wait_for("the power is back");
        }
        let status = wait_for_status("it is idle", |status| field(status, "state") == "idle");
        assert!(status.contains("\"alarm\":null"), "{torn}: {status}");
        let has = good(&leadscrew(&["params", "get", "9007"]));
        let new = has.contains("= 12 %");
        assert!(new || has.contains("= 15 %"), "{torn}: {has}");
        assert_eq!(new, whole, "{torn}: {has}");
        outcomes[usize::from(new)] += 1;
        drop(board);
    }
    assert_eq!(outcomes, [4, 1]);
}

#[test]
fn a_program_that_stalls_is_waited_for_outside_the_thread_and_goes_on() {
    // More than waits in the machine at any time.
    let once = WORK.trim_end_matches("M30\n");
    let text = format!("{}{WORK}", once.repeat(5));
    let (code, calm) = alone(&text, &[]);
    assert_eq!(code, Some(0), "{calm}");
    for (from, to) in [(0, 15_000), (1_000, 15_000)] {
        let stall = format!("{from}..{to}");
        let (code, said) = alone(&text, &["--stall", &stall]);
        assert_eq!(code, Some(0), "{stall}: {said}");
        assert!(!said.contains("alarm"), "{stall}: {said}");
        // The work that was left when the stall began is done after it, except what waited in the machine already.
        let left = ticks(&calm) - from;
        let behind = ticks(&said) - to;
        assert!(
            behind > left / 2 && behind < left + 1_000,
            "{stall}: {calm}{said}"
        );
    }
}

#[test]
fn a_board_of_another_version_is_refused_with_both_named() {
    let _board = Board::start(&["--lockstep", "--link-key", "0123abcd"]);
    let ours = leadscrew_core::link::VERSION.to_string();
    let program = example("o0013-g76-m68x6.nc");
    let commands: [&[&str]; 3] = [
        &["run", program.to_str().unwrap()],
        &["params", "list"],
        &["params", "push", "--set", "9007=12"],
    ];
    for args in commands {
        let words = bad(&leadscrew(args), 3);
        assert!(
            words.contains("(key 0123abcd)") && words.contains(&ours),
            "{args:?}: {words}"
        );
    }
}

#[test]
fn a_controller_that_comes_back_is_started_and_reset_by_the_gateway() {
    let board = Board::start(&["--lockstep", "--bus-off", "2500..2600"]);
    let path = program("bus-off.nc", WORK);
    let output = finish(run(&path, &[]));
    // Silent for long enough, or back on the bus with its alarm.
    assert!(
        matches!(output.status.code(), Some(3 | 4)),
        "{}",
        both(&output)
    );
    let status = wait_for_status("it is back", |status| status.contains("\"no\":4370"));
    assert_eq!(field(&status, "state"), "alarm");
    wait_for_status("it can be used again", |status| {
        // On a slow machine an order may go unconfirmed; a reset more does no harm.
        field(status, "state") == "idle" || {
            leadscrew(&["reset"]);
            false
        }
    });
    good(&finish_well(&path));
    drop(board);
}

/// Nobody but the simulated board itself is there to start a controller of a virtual bus again [D196].
#[test]
fn a_controller_that_an_error_frame_calls_off_is_told_of_and_comes_back() {
    let board = Board::start(&["--lockstep"]);
    wait_for_status("it is idle", |status| field(status, "state") == "idle");
    tool("cansend", &["vcan0", "20000040#0000000000000000"]);
    board.wait_for("vcan0: bus-off, as an error frame says");
    board.wait_for("vcan0: the controller is on the bus again; the alarm waits for a reset");
    wait_for_status("it is back", |status| status.contains("\"no\":4370"));
    good(&leadscrew(&["reset"]));
    wait_for_status("it is idle", |status| field(status, "state") == "idle");
    good(&finish_well(&program("behind.nc", WORK)));
}

/// Whatever the board does, it goes on with it [D196]. In real time: where time is virtual, another client that asks
/// meanwhile may be too slow for a transfer.
#[test]
fn communication_that_somebody_begins_anew_ends_no_run() {
    let path = program("anew.nc", WORK);
    // The gateway is not watched: this computer has other work.
    let board = Board::start(&["--set", "9000=5000", "--set", "9024=0"]);
    let running = run(&path, &[]);
    wait_for_status("it runs", |status| field(status, "program") == "true");
    tool("cansend", &["vcan0", "000#8201"]);
    let output = finish(running);
    let told = err(&output);
    good(&output);
    assert!(told.contains("NMT reset communication"), "{told}");
    drop(board);
}

fn finish_well(path: &std::path::Path) -> std::process::Output {
    finish(run(path, &[]))
}

#[test]
fn a_board_that_starts_again_in_a_thread_is_noticed_and_the_program_is_not_gone_on_with() {
    let board = Board::start(&["--lockstep", "--cut-power", "3500..3600"]);
    let output = finish(run(&example("o0013-g76-m68x6.nc"), &[]));
    let words = bad(&output, 3);
    assert!(
        words.contains("has started again in the middle of the program"),
        "{words}"
    );
    board.wait_for("the power is back");
    wait_for_status("it is idle", |status| field(status, "state") == "idle");
    good(&finish_well(&program("after.nc", WORK)));
}

#[test]
fn a_gateway_on_a_bad_wire_does_the_same_or_says_why_not() {
    let path = program("bad.nc", WORK);
    let calm = Board::start(&["--lockstep"]);
    let ran = good(&finish_well(&path));
    let hash = field(&ran, "setpoint_hash").to_owned();
    drop(calm);
    let _board = Board::start(&[
        "--lockstep",
        "--lose",
        "in=5",
        "--lose",
        "out=5",
        "--double",
        "in=20",
        "--double",
        "out=20",
        "--seed",
        "11",
    ]);
    let output = finish(run(&path, &[]));
    match output.status.code() {
        Some(0) => assert_eq!(field(&good(&output), "setpoint_hash"), hash),
        Some(3) => assert!(err(&output).contains("error: "), "{}", both(&output)),
        other => panic!("{other:?}: {}", both(&output)),
    }
}
