#![no_std]
#![no_main]
//! Runs every example and a thousand random programs on the emulated Cortex-M4F, the board in lock-step with its plant, and
//! prints a row `name hash ticks alarm` for each: a host prints the same.

use core::fmt::{Arguments, Write};
use core::panic::PanicInfo;

use cortex_m_rt::entry;
use cortex_m_semihosting::debug::{self, EXIT_FAILURE, EXIT_SUCCESS};
use cortex_m_semihosting::hio;
use leadscrew_core::params::Params;

mod programs;
mod run;

/// Name and text.
type Example = (&'static str, &'static [u8]);

static EXAMPLES: &[Example] = include!(concat!(env!("OUT_DIR"), "/examples.rs"));

/// Random programs.
const PROGRAMS: u64 = 1000;

#[entry]
fn main() -> ! {
    let params = Params::slant_bed();
    for (name, text) in EXAMPLES {
        row(format_args!("{name}"), run::run(text, &params));
    }
    for seed in 0..PROGRAMS {
        let outcome = run::run(programs::random(seed).as_bytes(), &params);
        row(format_args!("random-{seed}"), outcome);
    }
    debug::exit(EXIT_SUCCESS);
    stop()
}

fn row(name: Arguments, outcome: run::Outcome) {
    let run::Outcome { hash, ticks, alarm } = outcome;
    print(format_args!("{name} {hash:016x} {ticks} {alarm}\n"));
}

#[panic_handler]
fn panic(info: &PanicInfo) -> ! {
    print(format_args!("{info}\n"));
    debug::exit(EXIT_FAILURE);
    stop()
}

/// Prints on the emulator's standard output.
fn print(text: Arguments) {
    // Where the host takes no output there is nobody to tell.
    if let Ok(mut out) = hio::hstdout() {
        let _ = out.write_fmt(text);
    }
}

fn stop() -> ! {
    loop {
        core::hint::spin_loop();
    }
}
