//! A soak of any length from any seed: `cargo xtask soak [--ticks N] [--seed S]`.

use leadscrew_tests::soak::soak;

fn main() {
    let mut arguments = std::env::args().skip(1).map(|argument| {
        argument
            .parse::<u64>()
            .expect("usage: soak SEED TICKS, whole numbers")
    });
    let seed = arguments.next().unwrap_or(1);
    let ticks = arguments.next().unwrap_or(10_000_000);
    println!("{}", soak(seed, ticks, |_| {}));
}
