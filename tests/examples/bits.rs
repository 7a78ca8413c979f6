//! Random programs as the emulated board runs them, on this host: `bits SEED COUNT`, the rows that the board prints.

use leadscrew_core::params::Params;

#[path = "../../firmware/mps2-an386/src/programs.rs"]
mod programs;
#[path = "../../firmware/mps2-an386/src/run.rs"]
mod run;

fn main() {
    let numbers: Vec<u64> = std::env::args()
        .skip(1)
        .map(|argument| {
            argument
                .parse()
                .expect("usage: bits SEED COUNT, whole numbers")
        })
        .collect();
    let [first, count] = numbers.as_slice() else {
        panic!("usage: bits SEED COUNT");
    };
    let params = Params::sheets();
    for seed in (0..*count).map(|number| first.wrapping_add(number)) {
        let run::Outcome { hash, ticks, alarm } =
            run::run(programs::random(seed).as_bytes(), &params);
        println!("random-{seed} {hash:016x} {ticks} {alarm}");
    }
}
