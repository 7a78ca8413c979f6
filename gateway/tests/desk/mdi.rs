//! `mdi`: lines that are typed, one after the other.

use std::io::{Read as _, Write as _};
use std::process::Stdio;

use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;
use serde_json::Value;

use crate::{SHORT, User, bad, good, text};

/// What is in force before a line and after it, without S and M.
fn typed(user: &User, line: &str) -> (Value, Value) {
    let mut done = user.json(&["mdi", line]);
    (done["before"].take(), done["after"].take())
}

const POWER_ON: &str = "G00 G18 G21 G54 G98 G97 S0 M05 T--00";

#[test]
fn what_a_line_sets_holds_for_the_next_and_the_spindle_goes_on() {
    let user = User::with_machine();
    let (before, after) = typed(&user, "M3 S600");
    assert_eq!(before["modal"], POWER_ON);
    assert_eq!(after["modal"], "G00 G18 G21 G54 G98 G97 S600 M03 T--00");
    let (before, after) = typed(&user, "G99 G1 X-4 F0.5");
    assert_eq!(before["modal"], "G00 G18 G21 G54 G98 G97 S600 M03 T--00");
    assert_eq!(
        after["modal"],
        "G01 G18 G21 G54 G99 G97 F0.5 S600 M03 T--00"
    );
    // G1, F and S are those of the lines before.
    let (_, after) = typed(&user, "W-1");
    assert_eq!((&after["mx"], &after["mz"]), (&(-4).into(), &(-1).into()));
    assert_eq!(user.json(&["status"])["rpm_commanded"], 600);
    // G50 shifts the work zero, and the machine stays.
    let (before, after) = typed(&user, "G50 X20 T0203");
    assert_eq!(
        (&before["x"], &after["x"], &after["mx"]),
        (&(-4).into(), &20.into(), &(-4).into())
    );
    assert_eq!(
        after["modal"],
        "G01 G18 G21 G54 G99 G97 F0.5 S600 M03 T--03"
    );
    let (_, after) = typed(&user, "G0 X21; G98 F77");
    assert_eq!((&after["x"], &after["mx"]), (&21.into(), &(-3).into()));
    let (_, after) = typed(&user, "M5");
    assert_eq!(after["modal"], "G00 G18 G21 G54 G98 G97 F77 S600 M05 T--03");
    assert_eq!(user.json(&["status"])["rpm_commanded"], 0);
    // M30 ends it all.
    let (_, after) = typed(&user, "M30");
    assert_eq!(
        (&after["modal"], &after["x"]),
        (&POWER_ON.into(), &(-3).into())
    );
}

#[test]
fn a_refused_line_changes_nothing_and_moves_nothing() {
    let user = User::with_machine();
    typed(&user, "G1 X-4 F3000");
    for (line, number) in [
        ("G1 X-5 Q", "4003"),
        ("X-9999", "4258"),
        ("G1 X-5 L2", "0051"),
    ] {
        let told = bad(&user.does(&["mdi", line]), 1);
        assert!(told.contains(&format!("alarm[{number}")), "{line}: {told}");
        assert!(told.contains("--> mdi:1:"), "{line}: {told}");
    }
    let (before, after) = typed(&user, "Z-1");
    assert_eq!(
        before["modal"],
        "G01 G18 G21 G54 G98 G97 F3000 S0 M05 T--00"
    );
    assert_eq!((&after["mx"], &after["mz"]), (&(-4).into(), &(-1).into()));
}

#[test]
fn a_line_that_would_not_end_is_refused_by_name() {
    let user = User::with_machine();
    for (line, number) in [
        ("M99", "4867"),
        ("G0 U1; M99", "4867"),
        ("N1 G0 U1; G0 U-1; M99 P1", "4867"),
        ("N1 G0 U1; U-1; GOTO 1", "4852"),
        ("WHILE[1]DO1; G0 U1; U-1; END1", "4852"),
    ] {
        let told = bad(&user.does(&["mdi", line]), 1);
        assert!(told.contains(&format!("alarm[{number}")), "{line}: {told}");
    }
    let status = user.json(&["status"]);
    assert_eq!(
        (&status["mx"], &status["state"]),
        (&0.into(), &"idle".into())
    );
    // One that ends does.
    let (_, after) = typed(
        &user,
        "#1=0; WHILE[#1LT9]DO1; G0 U1; U-1; #1=#1+1; END1; U2",
    );
    assert_eq!(after["mx"], 2);
}

#[test]
fn what_ends_or_stops_a_program_does_so_in_a_line() {
    let user = User::with_machine();
    for end in ["M30", "M2"] {
        typed(&user, "M3 S600 F77");
        let (_, after) = typed(&user, end);
        assert_eq!(after["modal"], POWER_ON, "{end}");
        let status = user.json(&["status"]);
        assert_eq!(
            (&status["rpm_commanded"], &status["state"]),
            (&0.into(), &"idle".into())
        );
    }
    let mut line = user.command(&["mdi", "M3 S600; M0; G0 U1"]);
    let line = line.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn();
    user.wait_for("hold");
    good(&user.does(&["resume"]));
    let line = line.unwrap().wait_with_output().unwrap();
    good(&line);
    // Nobody has pressed feed hold.
    let told = String::from_utf8_lossy(&line.stderr);
    assert!(
        told.contains("M00 stops the program (line 1)") && !told.contains("feed hold"),
        "{told}"
    );
    assert_eq!(user.json(&["status"])["mx"], 1);
    // At the machine that lives in one command nobody could resume it.
    let program = user.program("G0 X1\nM0\nG0 X2\nM30\n");
    assert_eq!(user.json(&["run", &program, "--bus", "sim"])["ok"], true);
}

#[test]
fn it_begins_anew_behind_a_program_and_a_power_up() {
    let user = User::with_machine();
    let line = "G1 X-4 F3000 S500";
    let anew = |user: &User| typed(user, "G4 P1").0["modal"] == POWER_ON;
    typed(&user, line);
    assert!(!anew(&user));
    let program = user.program(SHORT);
    good(&user.does(&["run", &program]));
    assert!(anew(&user));
    typed(&user, line);
    good(&user.does(&["sim", "power", "cycle"]));
    assert!(anew(&user));
    typed(&user, line);
    good(&user.does(&["params", "set", "rapid_rate.X=9000"]));
    assert!(anew(&user));
}

#[test]
fn lines_from_a_pipe_end_at_the_first_that_is_wrong() {
    let user = User::with_machine();
    let mut mdi = user.command(&["mdi"]);
    let piped = mdi.stdin(Stdio::piped()).stdout(Stdio::piped());
    let mut mdi = piped.stderr(Stdio::piped()).spawn().unwrap();
    let mut lines = mdi.stdin.take().unwrap();
    lines.write_all(b"G0 X1\n\nX2\nnonsense\nX3\n").unwrap();
    drop(lines);
    let ended = mdi.wait_with_output().unwrap();
    bad(&ended, 1);
    let told = text(&ended.stdout);
    let starts: Vec<&str> = told
        .lines()
        .filter_map(|line| line.split("  ").next())
        .collect();
    assert_eq!(
        starts,
        ["before", "after", "before", "after", "before"],
        "{told}"
    );
    assert_eq!(user.json(&["status"])["mx"], 2);
    let told = bad(&user.does(&["mdi", "--json"]), 2);
    assert!(told.contains("gives one result"), "{told}");
}

#[test]
fn at_a_prompt_the_arrow_brings_the_line_before() {
    let user = User::with_machine();
    let terminal = crate::pty::open(None);
    let end = || terminal.slave.try_clone().unwrap();
    let mut mdi = user.command(&["mdi"]);
    mdi.env("TERM", "xterm");
    let mut mdi = mdi
        .stdin(end())
        .stdout(end())
        .stderr(end())
        .spawn()
        .unwrap();
    let mut master = std::fs::File::from(terminal.master);
    let mut shown = String::new();
    // Waits until a prompt stands after what has been shown, and types.
    let mut type_behind = |words: &str, typed: &[u8]| {
        let from = shown.len();
        let comes = |shown: &str| {
            let at = shown[from..].find(words)?;
            shown[from + at..].find("mdi> ")
        };
        while comes(&shown).is_none() {
            let mut bytes = [0; 4096];
            let count = master.read(&mut bytes).unwrap();
            shown += &String::from_utf8_lossy(&bytes[..count]);
        }
        master.write_all(typed).unwrap();
    };
    type_behind("", b"G0 U1\r");
    type_behind("after", b"G0 U1 Q\r");
    type_behind("alarm", b"\x1b[A\x1b[A\r");
    type_behind("after", b"\x04");
    assert_eq!(mdi.wait().unwrap().code(), Some(0));
    assert_eq!(user.json(&["status"])["mx"], 2);
}

/// G10 in a program and in a line: the board keeps what the program has written when it has ended, and nothing of one that
/// has not.
#[test]
fn offsets_that_a_program_writes_are_kept_when_it_has_ended() {
    let user = User::with_machine();
    let value = |key: &str| user.json(&["offsets", "get", key])["values"][0]["value"].clone();
    good(&user.does(&["offsets", "set", "G54.Z=-10"]));
    let kept = user.program("G10 L2 P2 X4 Z-20\nG10 P0 Z1\nG55 G0 X0 Z0\nM30\n");
    let done = user.json(&["run", &kept]);
    assert_eq!(done["offsets_revision"], 2);
    let status = user.json(&["status"]);
    assert_eq!((&status["mx"], &status["mz"]), (&4.into(), &(-19).into()));
    assert_eq!(
        [value("G55.X"), value("G55.Z")],
        [Value::from(4), Value::from(-20)]
    );
    assert_eq!(
        [value("shift.Z"), value("G54.Z")],
        [Value::from(1), Value::from(-10)]
    );
    let (_, after) = typed(&user, "G10 L2 P2 W0.5");
    assert_eq!(value("G55.Z"), Value::from(-19.5));
    // The coordinates of the next line are those of the new table.
    assert_eq!((&after["x"], &after["z"]), (&4.into(), &(-10).into()));
    let broken = user.program("G10 L2 P3 X7\nG0 X1\nG77\nM30\n");
    bad(&user.does(&["run", &broken]), 1);
    assert_eq!(value("G56.X"), Value::from(0));
    let plain = user.program("G0 X0 Z-19\nM30\n");
    assert_eq!(user.json(&["run", &plain])["offsets_revision"], Value::Null);
}

/// `timeout` and service managers signal a process and then its group.
#[test]
fn two_signals_that_come_at_once_are_one_interruption() {
    let user = User::with_machine();
    for _ in 0..4 {
        let mut line = user.command(&["mdi", "G98 G1 Z-30 F1"]);
        let line = line.stdout(Stdio::piped()).stderr(Stdio::piped());
        let line = line.spawn().unwrap();
        user.wait_for("run");
        let pid = Pid::from_raw(i32::try_from(line.id()).unwrap());
        for signal in [Signal::SIGTERM, Signal::SIGINT] {
            kill(pid, signal).unwrap();
        }
        let told = bad(&line.wait_with_output().unwrap(), 130);
        assert!(told.contains("error: interrupted"), "{told}");
        // What it has begun is at its end.
        assert_eq!(user.json(&["status"])["state"], "idle", "{told}");
    }
}
