#![no_std]
#![no_main]
//! Runs every example and 300 random programs on the emulated Cortex-M4F, the board in lock-step with its plant.
//! Prints a row `name hash ticks alarm` for each; a host prints the same rows. With `seed=S count=N` in its command
//! line it runs N random programs instead, from seed S on.

use core::fmt::Arguments;
use core::panic::PanicInfo;

use cortex_m_rt::entry;
use leadscrew_console::print;
use leadscrew_core::params::Params;

mod programs;
mod run;

/// Name and text of an example.
type Example = (&'static str, &'static [u8]);

static EXAMPLES: &[Example] = include!(concat!(env!("OUT_DIR"), "/examples.rs"));

/// The number of random programs.
const PROGRAMS: u64 = 300;

#[entry]
fn main() -> ! {
    let params = Params::sheets();
    let (mut first, mut count) = (None, PROGRAMS);
    for word in leadscrew_console::words(&mut [0; leadscrew_console::LONGEST]) {
        let number = |text: &str| text.parse().expect("a number");
        match word.split_once('=') {
            Some(("seed", text)) => first = Some(number(text)),
            Some(("count", text)) => count = number(text),
            _ => panic!("`{word}` is no option of this image"),
        }
    }
    if first.is_none() {
        for (name, text) in EXAMPLES {
            row(format_args!("{name}"), run::run(text, &params));
        }
    }
    let first = first.unwrap_or(0);
    for seed in (0..count).map(|number| first.wrapping_add(number)) {
        let outcome = run::run(programs::random(seed).as_bytes(), &params);
        row(format_args!("random-{seed}"), outcome);
    }
    leadscrew_console::done()
}

fn row(name: Arguments, outcome: run::Outcome) {
    let run::Outcome { hash, ticks, alarm } = outcome;
    print(format_args!("{name} {hash:016x} {ticks} {alarm}\n"));
}

#[panic_handler]
fn panic(info: &PanicInfo) -> ! {
    leadscrew_console::panicked(info)
}
