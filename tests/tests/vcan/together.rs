//! Two boards on one wire, each with its drives and its gateway: one gives the beat, the other follows.
//!
//! In virtual time they do what each does alone. In real time the computer has a say in whether the beat comes in time;
//! what a lost one does stands in the tests of `faults`.

use std::path::Path;

use crate::bus::{eventually, ours, scratch, sockets_on, tool};
use crate::machine::{
    Board, command, example, field, finish, good, interrupt, leadscrew, out, program, run,
};

/// Of both: on a bus where there is room for two.
const BOTH: [&str; 4] = ["--set", "9000=2000", "--set", "9030=33"];

/// Of the one that follows.
const FURTHER: [&str; 14] = [
    "--set",
    "9029=1",
    "--set",
    "9015.X=48",
    "--set",
    "9015.Z=49",
    "--set",
    "9015.C=50",
    "--set",
    "9016=64",
    "--set",
    "9014=1",
    "--node",
    "2",
];

/// Of both: with one frame of CAN FD for the drives of each there is room at 1 ms.
const BOTH_IN_FD: [&str; 4] = ["--set", "9031=1", "--set", "9030=25"];

/// What `--bus sim` makes of a program on such a board.
fn simulated(path: &Path, set: &[&str]) -> String {
    let args = [&["run", path.to_str().unwrap(), "--json"], set].concat();
    out(&tool(ours("leadscrew").to_str().unwrap(), &args))
}

#[test]
fn each_of_two_boards_has_the_setpoints_it_has_alone() {
    both_at_work(&BOTH, "64");
}

#[test]
fn each_of_two_boards_with_one_frame_for_its_drives_has_the_setpoints_it_has_alone() {
    both_at_work(&BOTH_IN_FD, "2");
}

/// The setpoints of each are those of the simulation of each alone, though both are
/// at work at once. `beside`: whose setpoint is the last one of the second.
fn both_at_work(both: &[&str], beside: &str) {
    let thread = program(
        "second.nc",
        "O0002\nG50 X40 Z20\nM3 S450\nG0 X34 Z5\nG76 P010060 Q600 R0.1\nG76 X30 Z-14 P6000 Q3000 F1.5\nG0 X40 Z20\nM30\n",
    );
    let first = example("o0013-g76-m68x6.nc");
    let set = &FURTHER[..12];
    let expected = [
        simulated(&first, both),
        simulated(&thread, &[both, set].concat()),
    ];
    let giver = Board::start_on(
        "vcan0",
        &[&["--lockstep", "--beside", beside], both].concat(),
    );
    let follower = Board::start(&[&["--lockstep"], both, &FURTHER[..]].concat());
    giver.wait_for("ready");
    let running = [
        run(&first, &["--node", "1"]),
        run(&thread, &["--node", "2"]),
    ];
    for (child, expected) in running.into_iter().zip(&expected) {
        let ran = good(&finish(child));
        for name in [
            "ok",
            "moves",
            "setpoint_hash",
            "late",
            "warnings",
            "max",
            "rms",
        ] {
            assert_eq!(
                field(&ran, name),
                field(expected, name),
                "{name}\n{ran}\n{expected}\n{}{}",
                giver.words(),
                follower.words()
            );
        }
    }
    for board in [follower, giver] {
        let (code, words) = board.interrupt();
        assert_eq!(code, Some(0), "{words}");
        assert!(words.contains(" 0 dropped"), "{words}");
    }
}

/// The values of `--set` as a machine file.
fn file(name: &str, sets: &[&str]) -> String {
    let values = sets.iter().filter_map(|word| word.split_once('='));
    let line = |(key, value): (&str, &str)| match key {
        "9000" => format!("{key} = \"{value} µs\"\n"),
        _ => format!("{key} = {value}\n"),
    };
    let text: String = values.map(line).collect();
    program(name, &text).to_str().unwrap().to_owned()
}

/// The setpoints of X and Z in these columns of a table, each as long as it lasts.
fn path(table: &str, columns: [&str; 2]) -> Vec<[String; 2]> {
    let mut lines = table.lines().map(|line| line.split(','));
    let header: Vec<&str> = lines.next().unwrap().collect();
    let places = columns.map(|name| header.iter().position(|column| *column == name).unwrap());
    let mut path: Vec<[String; 2]> = Vec::new();
    for line in lines {
        let fields: Vec<&str> = line.collect();
        let at = places.map(|place| fields[place].to_owned());
        if at.iter().all(|at| !at.is_empty()) && path.last() != Some(&at) {
            path.push(at);
        }
    }
    path
}

/// One program on both, one after the other: the table has it once in the columns of each.
#[test]
fn a_table_has_the_drives_of_both_side_by_side() {
    let table = scratch("both.csv");
    let files = [
        file("first.toml", &BOTH),
        file("second.toml", &[&BOTH[..], &FURTHER[..12]].concat()),
    ];
    let giver = Board::start_on(
        "vcan0",
        &[&["--lockstep", "--beside", "64"], &BOTH[..]].concat(),
    );
    let _follower = Board::start(&[&["--lockstep"], &BOTH[..], &FURTHER[..]].concat());
    giver.wait_for("ready");
    eventually("the second one is named", || {
        let told = good(&leadscrew(&["status"]));
        told.ends_with("also on this bus: node 2 (`leadscrew status --node 2`)\n")
    });
    let before = sockets_on("vcan0");
    let recorder = command(&["record", "-o", table.to_str().unwrap()])
        .args(["--params", &files[0], "--further", &files[1]])
        .spawn()
        .unwrap();
    eventually("the recorder listens", || sockets_on("vcan0") > before);
    let part = example("g84-tap.nc");
    for node in ["1", "2"] {
        good(&finish(run(&part, &["--node", node])));
    }
    interrupt(&recorder);
    good(&finish(recorder));
    let table = std::fs::read_to_string(table).unwrap();
    let first = path(&table, ["x_nm", "z_nm"]);
    assert!(first.len() > 500, "{}", first.len());
    // The first one has all of it behind it when the second one begins.
    let second = path(&table, ["b2_x_nm", "b2_z_nm"]);
    let apart = first.iter().zip(&second).position(|(a, b)| a != b);
    assert_eq!((apart, second.len()), (None, first.len()));
}
