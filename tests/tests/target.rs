//! The setpoints of the emulated board, bit by bit: a host makes the same from the same programs. What the board printed is
//! under version control (`cargo xtask bits` runs it again).

use std::path::{Path, PathBuf};

use leadscrew_core::params::Params;

#[path = "../../firmware/mps2-an386/src/programs.rs"]
mod programs;
#[path = "../../firmware/mps2-an386/src/run.rs"]
mod run;

/// Of the random programs one of so many.
fn every() -> usize {
    leadscrew_seed::amount(25, 1)
}

/// No example of more ticks.
fn most_ticks() -> u64 {
    leadscrew_seed::amount(50_000, u64::MAX)
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

#[test]
fn the_board_and_a_host_make_the_same_setpoints() {
    let golden = root().join("firmware/mps2-an386/hashes.txt");
    let golden = std::fs::read_to_string(golden).expect("the board's rows are there");
    let params = Params::sheets();
    let (mut examples, mut random) = (0, 0);
    for row in golden.lines().filter(|row| !row.starts_with('#')) {
        let words: Vec<&str> = row.split_whitespace().collect();
        let [name, hash, ticks, alarm] = words.as_slice() else {
            panic!("not a row of four words: {row}");
        };
        let text = match name.strip_prefix("random-") {
            Some(seed) => {
                random += 1;
                let seed: u64 = seed.parse().expect("a seed");
                if !(seed as usize).is_multiple_of(every()) {
                    continue;
                }
                programs::random(seed).as_bytes().to_vec()
            }
            None => {
                examples += 1;
                if ticks.parse::<u64>().expect("a number") > most_ticks() {
                    continue;
                }
                std::fs::read(root().join("examples").join(name)).expect("an example")
            }
        };
        let outcome = run::run(&text, &params);
        let run::Outcome {
            hash: own_hash,
            ticks: own_ticks,
            alarm: own_alarm,
        } = outcome;
        let own = format!("{own_hash:016x} {own_ticks} {own_alarm}");
        assert_eq!(own, format!("{hash} {ticks} {alarm}"), "{name}");
    }
    let programs = std::fs::read_dir(root().join("examples")).expect("there are examples");
    let programs = programs
        .filter_map(Result::ok)
        .filter(|entry| entry.path().extension().is_some_and(|end| end == "nc"))
        .count();
    assert_eq!(examples, programs, "an example is missing");
    assert!(random >= 300, "{random} random programs");
}
