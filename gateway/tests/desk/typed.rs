//! What is typed wrongly, and the variable LEADSCREW_BUS.

use std::os::unix::fs::PermissionsExt as _;

use crate::{SHORT, User, bad, good, text};

#[test]
fn the_variable_names_the_bus_where_no_option_does() {
    let user = User::with_machine();
    assert_eq!(user.json(&["status"])["bus"], "sim:desk");
    let with = |bus: &str, args: &[&str]| user.command(args).env("LEADSCREW_BUS", bus).output();
    let told = bad(&with("sim:other", &["status"]).unwrap(), 3);
    assert!(told.contains("`other`"), "{told}");
    // The option wins.
    good(&with("sim:other", &["status", "--bus", "sim:desk"]).unwrap());
    let told = bad(&with("sim:a/b", &["status"]).unwrap(), 2);
    assert!(
        told.contains("the variable LEADSCREW_BUS is `sim:a/b`"),
        "{told}"
    );
    // An empty one is none.
    let told = bad(&with("", &["hold"]).unwrap(), 2);
    assert!(
        told.contains("`leadscrew up`, then `--bus sim:desk`"),
        "{told}"
    );
    // Commands without a bus, and those on a file, are as without the variable.
    let program = user.program(SHORT);
    for args in [
        &["simulate", &program][..],
        &["completions", "bash"],
        &[
            "params",
            "set",
            "rapid_rate.X=9000",
            "--state",
            "board.flash",
        ],
        &["status", "--state", "board.flash"],
        &["run", &program, "--state", "board.flash"],
    ] {
        good(&with("sim:other", args).unwrap());
    }
    // `up`, `down` and `sim` take its name.
    good(&with("sim:third", &["up"]).unwrap());
    good(&with("sim:third", &["sim", "state"]).unwrap());
    let told = good(&with("sim:third", &["down"]).unwrap());
    assert_eq!(told, "machine `third` has ended\n");
    // And with another bus in it they mean the usual one.
    good(&with("can0", &["sim", "state"]).unwrap());
}

#[test]
fn what_cannot_be_is_refused_with_a_remedy() {
    let user = User::new();
    for (args, code, words) in [
        (
            &["up", "--bus", "can0"][..],
            2,
            "leave out `--bus socketcan:can0`",
        ),
        (
            &["down", "--bus", "can0"],
            2,
            "`--name NAME` or `--bus sim:NAME`",
        ),
        (&["up", "--name", "../x"], 2, "names no simulated machine"),
        (&["up", "--speed", "9"], 2, "0.01 to 5 times real time"),
        (&["up", "--state", "x"], 2, "`--state` is not for `up`"),
        (
            &["up", "--signal", "SWS1=1"],
            2,
            "`--signal` is not for `up`",
        ),
        (
            &["up", "--machine", "none.toml"],
            2,
            "there is no such file",
        ),
        (&["up", "--node", "127"], 2, "this side's own number"),
        (&["up", "--node", "16"], 1, "does not start"),
        (&["sim", "speed", "0"], 2, "0.01 to 5 times real time"),
        (
            &["sim", "door", "ajar"],
            2,
            "[possible values: open, close]",
        ),
        (
            &["run", "part.nc", "--at", "X=1", "--bus", "sim:desk"],
            2,
            "one of its own",
        ),
    ] {
        let told = bad(&user.does(args), code);
        assert!(told.contains(words), "{args:?}: {told}");
    }
    let json = user.does(&["up", "--node", "16", "--json"]);
    let told: serde_json::Value = serde_json::from_str(&text(&json.stdout)).unwrap();
    assert_eq!((&told["ok"], &told["exit"]), (&false.into(), &1.into()));
}

#[test]
fn a_folder_that_others_can_enter_is_refused() {
    let user = User::new();
    let folder = user.socket("");
    std::fs::create_dir(&folder).unwrap();
    std::fs::set_permissions(&folder, std::fs::Permissions::from_mode(0o755)).unwrap();
    for args in [&["up"][..], &["status"], &["down"]] {
        let told = bad(&user.does(args), 3);
        assert!(
            told.contains("is open to others") && told.contains("XDG_RUNTIME_DIR"),
            "{told}"
        );
    }
}
