//! What a tick costs on the host: `tick line|arc|thread|observer TICKS` runs the steps that the emulated board counts.
//!
//! Under callgrind, two numbers of ticks give the instructions of one with the start-up subtracted.

use std::hint::black_box;
use std::process::ExitCode;

#[path = "../../firmware/audit/src/work/mod.rs"]
#[allow(dead_code, unused_imports, reason = "the board counts more than this")]
mod work;

use work::{ThreadPass, TimedMove, Tracking, Work};

fn main() -> ExitCode {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let [kind, ticks] = args.as_slice() else {
        return usage();
    };
    let Ok(ticks) = ticks.parse() else {
        return usage();
    };
    match kind.as_str() {
        "line" => run(&TimedMove::line(), ticks),
        "arc" => run(&TimedMove::arc(), ticks),
        "thread" => run(&ThreadPass::o0013(), ticks),
        "observer" => run(&Tracking::at_300_rpm(), ticks),
        _ => return usage(),
    }
    ExitCode::SUCCESS
}

/// Runs the steps from their beginning again and again. The state at the beginning is made once and copied.
fn run<W: Work>(work: &W, ticks: u64)
where
    W::State: Clone,
{
    let (begin, steps) = (work.begin(), work.steps());
    let mut left = ticks;
    while left > 0 {
        let mut state = begin.clone();
        for number in 0..steps {
            black_box(work.step(black_box(&mut state), number));
            left = left.saturating_sub(1);
            if left == 0 {
                break;
            }
        }
    }
    println!("{ticks} ticks");
}

fn usage() -> ExitCode {
    eprintln!("tick line|arc|thread|observer TICKS");
    ExitCode::from(2)
}
