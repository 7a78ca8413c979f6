//! A program is started at a line.

use std::io::{BufRead as _, BufReader, Write as _};
use std::process::Stdio;

use crate::{User, bad, good, text};

const PART: &str = "O1\nG98 G97 S500 M3\nT0101\nM8\nG0 X-30 Z-5\nG1 X-40 F2000\nZ-20\nG61\nX-30\nG0 Z-5\nG2 X-34 Z-7 R2 F500\nG0 X-10\nM30\n(end)\n";

/// Starts it with something typed.
fn from(user: &User, line: &str, typed: &str) -> std::process::Output {
    let program = user.program(PART);
    let mut command = user.command(&["run", &program, "--from", line]);
    let piped = command.stdin(Stdio::piped()).stdout(Stdio::piped());
    let mut run = piped.stderr(Stdio::piped()).spawn().unwrap();
    let mut input = run.stdin.take().unwrap();
    let _ = writeln!(input, "{typed}");
    drop(input);
    run.wait_with_output().unwrap()
}

#[test]
fn the_number_of_the_line_is_typed_and_the_rest_runs() {
    let user = User::with_machine();
    let before = user.json(&["status"]);
    for typed in ["6", "", "70"] {
        let told = bad(&from(&user, "7", typed), 1);
        assert!(
            told.contains("7 was not typed; nothing has moved"),
            "{told}"
        );
    }
    let after = user.json(&["status"]);
    assert_eq!(before["mx"], after["mx"]);
    let output = from(&user, "7", "7");
    let told = text(&output.stderr);
    good(&output);
    for row in [
        "in force   G01 G18 G21 G54 G98 G97 F2000 S500 M03 T--01",
        "tool       T0101 has to be in place",
        "spindle    500 rpm",
        "coolant    M08",
        "begins at  X -40  Z -5  (machine X -40  Z -5)",
        "approach   Z -5, X -40 at a sixth of rapid",
        "first      G01 X -40  Z -20  (machine X -40  Z -20)",
    ] {
        assert!(told.contains(row), "{row}: {told}");
    }
    let end = user.json(&["status"]);
    assert_eq!((&end["mx"], &end["mz"]), (&(-10).into(), &(-7).into()));
    assert_eq!(end["rpm_commanded"], 0);
    // The tool is farther out than the start now, and as far along.
    let told = text(&from(&user, "12", "12").stderr);
    assert!(
        told.contains("approach   X -34 at a sixth of rapid"),
        "{told}"
    );
}

#[test]
fn what_cannot_be_a_start_is_refused() {
    let user = User::with_machine();
    for (line, why) in [
        ("11", "the line is an arc"),
        ("14", "carries out no block of its own there"),
        ("99", "the file has fewer lines"),
    ] {
        let told = bad(&from(&user, line, line), 1);
        assert!(told.contains(why) && told.contains("4590"), "{told}");
    }
    let idle = user.json(&["status"]);
    assert_eq!((&idle["mx"], &idle["state"]), (&0.into(), &"idle".into()));
}

/// The mode is changed while the question waits: nothing begins, and the mode stays as it was changed.
#[test]
fn a_mode_that_was_changed_while_the_program_was_checked_keeps_it_from_beginning() {
    let user = User::with_machine();
    let program = user.program(PART);
    let mut command = user.command(&["run", &program, "--from", "7"]);
    let piped = command.stdin(Stdio::piped()).stdout(Stdio::piped());
    let mut run = piped.stderr(Stdio::piped()).spawn().unwrap();
    // It is asked once it has changed the mode itself.
    let mut told = BufReader::new(run.stderr.take().unwrap()).lines();
    assert!(told.any(|line| line.unwrap().contains("first      G01")));
    good(&user.does(&["mode", "manual"]));
    writeln!(run.stdin.take().unwrap(), "7").unwrap();
    let why: String = told.map(Result::unwrap).collect();
    assert!(why.contains("4501"), "{why}");
    assert!(!run.wait().unwrap().success());
    let after = user.json(&["status"]);
    assert_eq!(
        (&after["mode"], &after["state"], &after["mx"]),
        (&"manual".into(), &"idle".into(), &0.into())
    );
}

/// With the machine inside the command, too; `--yes` asks nothing.
#[test]
fn the_machine_inside_the_command_starts_there() {
    let user = User::new();
    let program = user.program(PART);
    let ran = user.json(&["run", &program, "--bus", "sim", "--from", "7", "--yes"]);
    // Approach, and the lines from 7 on with a quarter of a circle.
    let way = 5.0 + 20.0 + 15.0 + 5.0 + 15.0 + std::f64::consts::PI + 12.0;
    let path = ran["path_mm"].as_f64().unwrap();
    assert!((path - way).abs() < 0.001, "{path} {way}");
}
