//! A held program is left, its axes are moved by hand, and it goes on.

use crate::{User, bad, good, text};

/// Half a second at the first place, and a long way on.
const PART: &str = "G98 G1 X-20 F2000\nG1 Z-200 F600\nM30\n";

#[test]
fn hold_jog_away_resume_twice() {
    let user = User::patient();
    let run = user.run(PART);
    user.wait_for("run");
    good(&user.does(&["hold"]));
    let held = user.wait_for("hold");
    assert!(held["left"].is_null());
    let told = good(&user.does(&["jog", "X+", "--by", "20"]));
    let status = user.json(&["status"]);
    assert_eq!(
        (&status["state"], &status["mode"]),
        (&"hold".into(), &"step".into())
    );
    assert_eq!(
        (&status["left"]["mx"], &status["left"]["mz"]),
        (&held["mx"], &held["mz"])
    );
    assert_eq!(status["program"], true, "{told}");
    good(&user.does(&["jog", "Z+", "--by", "1.5"]));
    assert!(text(&user.does(&["status"]).stdout).contains("the program was left at X "));
    // The first says what moves, and the axes come back; the second lets the program go on.
    let told = good(&user.does(&["resume"]));
    assert!(told.contains("back to machine X "), "{told}");
    assert!(
        told.contains("at the point where the program was held"),
        "{told}"
    );
    let back = user.json(&["status"]);
    assert_eq!(
        (&back["mx"], &back["mz"], &back["state"]),
        (&held["mx"], &held["mz"], &"hold".into())
    );
    let told = user.json(&["resume"]);
    assert_eq!(told["state"], "run");
    let done = run.wait_with_output().unwrap();
    good(&done);
    let end = user.json(&["status"]);
    assert_eq!((&end["mx"], &end["mz"]), (&(-20).into(), &(-200).into()));
    assert!(end["left"].is_null());
}

#[test]
fn a_reset_gives_the_program_up_and_the_next_resume_says_so() {
    let user = User::patient();
    let run = user.run(PART);
    good(&user.does(&["hold"]));
    user.wait_for("hold");
    good(&user.does(&["jog", "X+", "--by", "2"]));
    good(&user.does(&["reset"]));
    drop(run.wait_with_output());
    let told = bad(&user.does(&["resume"]), 1);
    assert!(told.contains("4591"), "{told}");
    // What runs next moves: the run that was set aside is over.
    let program = user.program("G98 G1 W-1 F3000\nM30\n");
    let before = user.json(&["status"])["mz"].as_f64().unwrap();
    good(&user.does(&["run", &program]));
    let after = user.json(&["status"])["mz"].as_f64().unwrap();
    assert!((after - before + 1.0).abs() < 1e-6, "{before} {after}");
}
