//! Start and end of a machine, and what it keeps.

use std::os::unix::net::UnixStream;
use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use crate::{LIMIT, SHORT, User, bad, exists, good};

/// A step by hand is not ended for want of frames by a computer that has other work.
const PATIENT: &str = "dead_man_ms = \"500 ms\"\n";

#[test]
fn a_machine_runs_until_down_and_a_program_runs_on_it() {
    let user = User::new();
    let told = good(&user.does(&["up"]));
    for words in [
        "machine `desk` is running: node 1 on sim:desk\n",
        "  export LEADSCREW_BUS=sim:desk   ",
        "  leadscrew down  ",
    ] {
        assert!(told.contains(words), "{told}");
    }
    let program = user.program(SHORT);
    assert_eq!(user.json(&["run", &program])["ok"], true);
    let status = user.json(&["status"]);
    assert_eq!(status["bus"], "sim:desk");
    assert_eq!(status["mx"], -4);
    assert_eq!(status["mz"], -1);

    let again = bad(&user.does(&["up"]), 2);
    assert!(
        again.contains("machine `desk` is running already"),
        "{again}"
    );
    let again = bad(&user.does(&["up", "--foreground"]), 2);
    assert!(
        again.contains("machine `desk` is running already"),
        "{again}"
    );
    assert_eq!(user.json(&["status"])["mx"], status["mx"]);

    assert_eq!(good(&user.does(&["down"])), "machine `desk` has ended\n");
    assert!(!exists(&user.socket("desk.sock")) && !exists(&user.socket("desk.ctl")));
    for args in [&["status"][..], &["down"], &["sim", "state"]] {
        let told = bad(&user.does(args), 3);
        let words = "no simulated machine `desk` is running; `leadscrew up --name desk` starts it";
        assert!(told.contains(words), "{told}");
    }
}

#[test]
fn a_machine_that_was_killed_starts_again_with_what_it_had_kept() {
    let user = User::with_machine();
    good(&user.does(&["params", "set", "rapid_rate.X=9000"]));
    let pid = user.machine()["pid"].to_string();
    assert!(
        Command::new("kill")
            .args(["-KILL", &pid])
            .status()
            .unwrap()
            .success()
    );
    // The kernel takes its time to end a process, and accepts connections until then.
    let end = Instant::now() + LIMIT;
    while UnixStream::connect(user.socket("desk.sock")).is_ok() {
        assert!(Instant::now() < end, "process {pid} does not end");
        thread::sleep(Duration::from_millis(5));
    }
    // The sockets lie there, and nobody serves them.
    let told = bad(&user.does(&["status"]), 3);
    assert!(
        told.contains("no simulated machine `desk` is running"),
        "{told}"
    );
    assert!(exists(&user.socket("desk.sock")) && exists(&user.socket("desk.ctl")));
    good(&user.does(&["up"]));
    assert_ne!(user.machine()["pid"].to_string(), pid);
    let rate = good(&user.does(&["params", "get", "rapid_rate.X"]));
    assert!(rate.contains("= 9000 mm/min"), "{rate}");
}

#[test]
fn a_power_cycle_keeps_parameters_and_places_and_nothing_else() {
    let user = User::with_machine();
    let program = user.program(SHORT);
    good(&user.does(&["run", &program]));
    good(&user.does(&["override", "feed", "50"]));
    assert_eq!(user.machine()["outdated"], false);
    good(&user.does(&["params", "set", "rapid_rate.X=9000"]));
    assert_eq!(user.machine()["outdated"], true);

    let off = user.json(&["sim", "power", "off"]);
    assert_eq!(off["machine"]["power"], false);
    let told = bad(&user.does(&["status"]), 3);
    assert!(
        told.contains("no board answers as node 1 on `sim:desk`: is it on"),
        "{told}"
    );
    let on = user.json(&["sim", "power", "on"]);
    assert_eq!(on["machine"]["power"], true);
    assert_eq!(on["machine"]["outdated"], false);
    let rate = good(&user.does(&["params", "get", "rapid_rate.X"]));
    assert!(rate.contains("= 9000 mm/min"), "{rate}");
    let status = user.json(&["status"]);
    assert_eq!(status["state"], "idle");
    assert_eq!(status["override"]["feed"], 100);
    assert_eq!(status["mx"], -4);
    assert_eq!(status["mz"], -1);
}

#[test]
fn a_power_cycle_in_a_move_leaves_the_axes_where_they_are_and_the_run_says_so() {
    let user = User::with_machine();
    let run = user.run(crate::LONG);
    good(&user.does(&["sim", "power", "cycle"]));
    let ended = run.wait_with_output().unwrap();
    let told = bad(&ended, 3);
    assert!(told.contains("started again"), "{told}");
    let status = user.wait_for("idle");
    let z: f64 = status["mz"].to_string().parse().unwrap();
    assert!(-30.0 < z && z < 0.0, "{status}");
}

#[test]
fn a_machine_file_is_that_of_a_new_board() {
    let user = User::new();
    let file = user.0.join("lathe.toml");
    std::fs::write(&file, "rapid_rate.X = \"8000 mm/min\"\n").unwrap();
    let up: [&str; 3] = ["up", "--machine", file.to_str().unwrap()];
    good(&user.does(&up));
    let rate = || good(&user.does(&["params", "get", "rapid_rate.X"]));
    assert!(rate().contains("= 8000 mm/min"));
    good(&user.does(&["down"]));
    // It is the board's own from now on, and the file may be named again as long as it says the same.
    good(&user.does(&["up"]));
    assert!(rate().contains("= 8000 mm/min"));
    good(&user.does(&["down"]));
    good(&user.does(&up));
    good(&user.does(&["params", "set", "rapid_rate.X=9000"]));
    good(&user.does(&["down"]));
    let told = bad(&user.does(&up), 2);
    assert!(
        told.contains("keeps other parameters") && told.contains("--new"),
        "{told}"
    );
    // The one that was refused has left nothing behind.
    good(&user.does(&["up"]));
    assert!(rate().contains("= 9000 mm/min"));
    good(&user.does(&["down"]));
    good(&user.does(&[&up[..], &["--new"]].concat()));
    assert!(rate().contains("= 8000 mm/min"));
    good(&user.does(&["down"]));
    std::fs::write(&file, "rapid_rate.Q = \"8000 mm/min\"\n").unwrap();
    let told = bad(&user.does(&up), 1);
    assert!(told.contains("rapid_rate.Q"), "{told}");
}

#[test]
fn machines_of_two_names_know_nothing_of_each_other() {
    let user = User::with_machine();
    let told = good(&user.does(&["up", "--name", "other", "--node", "3"]));
    assert!(told.contains("node 3 on sim:other"), "{told}");
    let program = user.program(SHORT);
    good(&user.does(&["run", &program, "--bus", "sim:other", "--node", "3"]));
    assert_eq!(user.json(&["status"])["mx"], 0);
    let told = bad(&user.does(&["status", "--bus", "sim:none"]), 3);
    assert!(told.contains("(these are: desk, other)"), "{told}");
    good(&user.does(&["down", "--name", "other"]));
    assert_eq!(user.json(&["status"])["state"], "idle");
}

#[test]
fn in_the_foreground_it_ends_with_an_interruption() {
    let user = User::new();
    let mut up = user.command(&["up", "--foreground"]);
    let piped = up.stdout(Stdio::piped()).stderr(Stdio::piped());
    let machine = piped.spawn().unwrap();
    let pid = machine.id().to_string();
    let end = Instant::now() + LIMIT;
    while !user.does(&["status"]).status.success() {
        assert!(Instant::now() < end);
    }
    assert_eq!(user.machine()["pid"].to_string(), pid);
    assert!(
        Command::new("kill")
            .args(["-INT", &pid])
            .status()
            .unwrap()
            .success()
    );
    let ended = machine.wait_with_output().unwrap();
    let log = crate::text(&ended.stderr);
    assert!(good(&ended).contains("Ctrl-C"));
    assert!(
        log.contains(" running\n") && log.contains(" ended\n"),
        "{log}"
    );
    assert!(!exists(&user.socket("desk.sock")));
}

#[test]
fn an_axis_homes_onto_the_switch_at_its_mark_and_stays_there_without_power() {
    let user = User::new();
    let machine = "home_method.Z = 1\nhome_position.Z = \"5 mm\"\n";
    let file = user.0.join("lathe.toml");
    std::fs::write(&file, format!("{machine}{PATIENT}")).unwrap();
    let file = file.to_str().unwrap();
    good(&user.does(&["up", "--machine", file, "--at", "Z=2"]));
    // From both sides of the switch, and from where the power went.
    for from in ["Z+", "Z-"] {
        let told = good(&user.does(&["home"]));
        assert!(told.contains("Z referenced at 5\n"), "{told}");
        good(&user.does(&["jog", from, "--by", "1.5"]));
        let stands = user.json(&["status"])["mz"].clone();
        good(&user.does(&["sim", "power", "cycle"]));
        let told = bad(&user.does(&["mdi", "G0 Z0"]), 1);
        assert!(
            told.contains("4503 not referenced: Z; home first"),
            "{told}"
        );
        assert_eq!(user.json(&["status"])["mz"], stands);
    }
    let told = good(&user.does(&["home"]));
    assert!(told.contains("Z referenced at 5\n"), "{told}");
}

#[test]
fn an_axis_homes_onto_a_switch_at_the_board_and_keeps_its_reference_over_other_parameters() {
    let user = User::new();
    let file = user.0.join("lathe.toml");
    let machine = "home_method.Z = 2\nhome_input.Z = 5\nhome_position.Z = \"5 mm\"\nhome_retreat.Z = \"3 mm\"\n";
    let machine = format!("{machine}home_travel.Z = \"30 mm\"\n{PATIENT}");
    std::fs::write(&file, machine).unwrap();
    let file = file.to_str().unwrap();
    // A drive that is 0.3 mm behind on the way to the switch.
    good(&user.does(&["up", "--machine", file, "--at", "Z=-2", "--drive", "kv30"]));
    let place = |user: &User| user.json(&["status"])["mz"].as_f64().unwrap();
    let homes = |user: &User| {
        good(&user.does(&["home"]));
        assert!((place(user) - 2.0).abs() < 0.002, "{}", place(user));
    };
    homes(&user);
    good(&user.does(&["sim", "power", "cycle"]));
    let told = bad(&user.does(&["mdi", "G0 Z0"]), 1);
    assert!(told.contains("4503 not referenced: Z"), "{told}");
    homes(&user);
    let referenced = |user: &User| user.json(&["status"])["referenced"].clone();
    let before = place(&user);
    good(&user.does(&["params", "set", "9055.Z=4 mm"]));
    assert_eq!(referenced(&user), "X Z C");
    assert!((place(&user) - before).abs() < 0.001, "{}", place(&user));
    good(&user.does(&["params", "set", "9058.Z=7 mm"]));
    assert_eq!(referenced(&user), "X C");
    // The switch of the simulated machine is at the new mark: it is built as the parameters say.
    good(&user.does(&["home"]));
    assert!((place(&user) - 3.0).abs() < 0.002, "{}", place(&user));
    good(&user.does(&["sim", "input", "5", "on"]));
    let told = bad(&user.does(&["home"]), 4);
    assert!(
        told.contains("[4526]: the reference switch of axis Z, input 5"),
        "{told}"
    );
    good(&user.does(&["sim", "input", "5", "auto"]));
    good(&user.does(&["reset"]));
    // It has gone back all the way that 9062 lets it.
    good(&user.does(&["jog", "Z+", "--by", "25"]));
    good(&user.does(&["home"]));
    let refused = bad(&user.does(&["params", "set", "9051.Z=0"]), 1);
    assert!(
        refused.contains("[4435]: axis Z homes by a switch at the board"),
        "{refused}"
    );
}

#[test]
fn a_machine_has_the_drives_that_up_names() {
    let user = User::new();
    let told = bad(&user.does(&["up", "--drive", "Z=kv31"]), 2);
    assert!(told.contains("there is no drive `kv31`"), "{told}");
    good(&user.does(&["up", "--drive", "kv30"]));
    // A rapid is 9 mm ahead of such a drive, and the board bears 1 mm.
    let far = user.program("G0 Z-50\nM30\n");
    let told = bad(&user.does(&["run", &far]), 4);
    assert!(told.contains("following error of drive Z"), "{told}");
    good(&user.does(&["down"]));
    good(&user.does(&["up"]));
    assert_eq!(user.json(&["run", &far])["ok"], true);
}
