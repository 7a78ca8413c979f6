//! Two boards on one wire, each with its drives and its gateway: one gives the beat, the other follows.

use std::path::Path;

use crate::bus::{ours, tool};
use crate::machine::{Board, example, field, finish, good, out, program, run};

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

/// What `--bus sim` makes of a program on such a board.
fn simulated(path: &Path, set: &[&str]) -> String {
    let args = [&["run", path.to_str().unwrap(), "--json"], set].concat();
    out(&tool(ours("leadscrew").to_str().unwrap(), &args))
}

/// The setpoints of each are those of the simulation of each alone, though both are at work at once.
#[test]
fn each_of_two_boards_has_the_setpoints_it_has_alone() {
    let thread = program(
        "second.nc",
        "O0002\nG50 X40 Z20\nM3 S450\nG0 X34 Z5\nG76 P010060 Q600 R0.1\nG76 X30 Z-14 P6000 Q3000 F1.5\nG0 X40 Z20\nM30\n",
    );
    let first = example("o0013-g76-m68x6.nc");
    let set = &FURTHER[..12];
    let expected = [
        simulated(&first, &BOTH),
        simulated(&thread, &[&BOTH[..], set].concat()),
    ];
    let giver = Board::start_on(
        "vcan0",
        &[&["--lockstep", "--beside", "48"], &BOTH[..]].concat(),
    );
    let follower = Board::start(&[&["--lockstep"], &BOTH[..], &FURTHER[..]].concat());
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
