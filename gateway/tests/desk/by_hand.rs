//! Axes moved by hand from two terminals at a time, and steps that something else cuts short.

use std::process::{Child, Stdio};
use std::time::Instant;

use serde_json::Value;

use crate::{LIMIT, User, bad, good, text};

/// A command that moves an axis by hand.
#[track_caller]
fn moves(user: &User, args: &[&str]) -> Child {
    moves_until(user, args, |status| status["state"] == "run")
}

/// The same once the board says so. One that has ended for want of frames, on a busy computer, is given anew.
#[track_caller]
fn moves_until(user: &User, args: &[&str], so: impl Fn(&Value) -> bool) -> Child {
    let end = Instant::now() + LIMIT;
    loop {
        let mut command = user.command(args);
        let piped = command.stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = piped.spawn().unwrap();
        while child.try_wait().unwrap().is_none() {
            let status = user.json(&["status", "--node", "1"]);
            if so(&status) {
                return child;
            }
            assert!(Instant::now() < end, "{status}");
        }
        let told = text(&child.wait_with_output().unwrap().stderr);
        // The board may hear the end of a press before only now.
        assert!(told.contains("(9040)") || told.contains("4505"), "{told}");
    }
}

#[test]
fn a_step_that_is_cut_short_is_no_success() {
    let user = User::patient();
    for (order, why) in [
        (&["hold"][..], "a feed hold has ended it"),
        (&["stop"], "4300 emergency stop"),
        (&["sim", "estop", "press"], "4300 emergency stop"),
        (&["mode", "manual"], "another order"),
    ] {
        let step = moves(&user, &["jog", "Z-", "--by", "60"]);
        // An order that stops the machine tells of the alarm.
        let _ = user.does(order);
        let ended = step.wait_with_output().unwrap();
        let told = bad(&ended, 4);
        assert!(told.contains("Z has gone -"), "{order:?}: {told}");
        assert!(told.contains(" of -60 mm: "), "{order:?}: {told}");
        assert!(told.contains(why), "{order:?}: {told}");
        assert!(text(&ended.stdout).ends_with(", ended by the board\n"));
        good(&user.does(&["sim", "estop", "release"]));
        good(&user.does(&["reset"]));
        user.wait_for("idle");
    }
    good(&user.does(&["jog", "Z+", "--by", "1.5"]));
}

#[test]
fn what_another_moves_by_hand_goes_on() {
    let user = User::patient();
    let program = user.program("G98 G1 X-4 F3000\nM30\n");
    let press = moves(&user, &["jog", "Z-", "--hold", "--feed", "20"]);
    for (args, number) in [
        (&["jog", "X-", "--by", "5"][..], "4505"),
        (&["jog", "X-", "--hold"], "4505"),
        (&["handwheel", "X", "x10", "10"], "4505"),
        (&["home"], "4505"),
        (&["mdi", "G0 X-4"], "4505"),
        (&["run", &program], "4505"),
        (&["touch", "X", "38", "--tool", "1"], "4507"),
    ] {
        let told = bad(&user.does(args), 1);
        assert!(told.contains(number), "{args:?}: {told}");
    }
    let status = user.json(&["status"]);
    assert_eq!(
        (&status["state"], &status["mode"], &status["mx"]),
        (&"run".into(), &"manual".into(), &0.into())
    );
    // Who asks for a mode by its name means it.
    good(&user.does(&["mode", "automatic"]));
    bad(&press.wait_with_output().unwrap(), 4);
}

#[test]
fn the_spindle_turns_while_a_command_holds_it() {
    let user = User::patient();
    let commanded = || user.json(&["status"])["rpm_commanded"].clone();
    for (way, rpm) in [("S+", 80), ("S-", -80)] {
        let hold = ["jog", way, "--hold", "--speed", "80"];
        let end = Instant::now() + LIMIT;
        let mut press = loop {
            let mut press = moves_until(&user, &hold, |status| status["rpm_commanded"] == rpm);
            good(&user.does(&["override", "spindle", "50"]));
            let turns = commanded();
            good(&user.does(&["override", "spindle", "100"]));
            // One that has lapsed meanwhile is given anew.
            if press.try_wait().unwrap().is_none() {
                assert_eq!(turns, rpm / 2);
                break press;
            }
            assert!(Instant::now() < end, "each press lapses");
        };
        // Whoever dies turns nothing.
        press.kill().unwrap();
        press.wait().unwrap();
        while commanded() != 0 {
            assert!(Instant::now() < end, "it turns on");
        }
        user.wait_for("idle");
    }
    let hold = ["jog", "S+", "--hold"];
    let press = moves_until(&user, &hold, |status| status["rpm_commanded"] == 50);
    good(&user.does(&["hold"]));
    let told = bad(&press.wait_with_output().unwrap(), 4);
    assert!(told.contains("a feed hold has ended it"), "{told}");
    assert_eq!(commanded(), 0);
    let told = bad(&user.does(&["jog", "S+", "--hold"]), 1);
    assert!(told.contains("4506"), "{told}");
    good(&user.does(&["resume"]));
    let told = bad(&user.does(&["jog", "S+", "--hold", "--speed", "5000"]), 1);
    assert!(told.contains("4564 a spindle jog at 5000 rpm"), "{told}");
}
