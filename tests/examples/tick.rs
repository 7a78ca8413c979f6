//! What the emulated board counts, on the host: `tick` lists the works, `tick NAME` runs one.
//!
//! Under `valgrind --tool=callgrind --toggle-collect='*counted_step*'` only the steps themselves are counted; the
//! instructions of one are the total over the number that is printed.

use std::hint::black_box;
use std::process::ExitCode;

#[path = "../../firmware/audit/src/work/mod.rs"]
mod work;

use work::{Counter, Work};

fn main() -> ExitCode {
    let mut args = std::env::args().skip(1);
    let mut runner = Runner {
        wanted: args.next(),
        kind: args.next(),
        steps: 0,
    };
    work::all(&mut runner);
    if runner.wanted.is_some() {
        println!("{} steps", runner.steps);
        if runner.steps == 0 {
            eprintln!("no such work: `tick` lists them");
            return ExitCode::FAILURE;
        }
    }
    ExitCode::SUCCESS
}

/// Runs the one that is wanted, or lists all.
struct Runner {
    wanted: Option<String>,
    kind: Option<String>,
    steps: u32,
}

impl Counter for Runner {
    fn steps<W: Work>(&mut self, name: &str, work: &W) {
        let Some(wanted) = &self.wanted else {
            for kind in work.kinds() {
                println!("{name} {kind}");
            }
            return;
        };
        if wanted != name {
            return;
        }
        // Several works may have a name in common, and kinds of their own.
        if let Some(kind) = &self.kind
            && !work.kinds().contains(&kind.as_str())
        {
            return;
        }
        // Which kind a step is shows only afterwards: the sequence is the same every time, so a first run tells.
        let of_kind = self
            .kind
            .as_deref()
            .and_then(|kind| work.kinds().iter().position(|one| *one == kind));
        let kinds = run(work, |_| false);
        let count = kinds
            .iter()
            .filter(|kind| of_kind.is_none_or(|wanted| wanted == **kind))
            .count();
        self.steps = u32::try_from(count).unwrap_or(u32::MAX);
        run(work, |number| {
            of_kind.is_none() || kinds.get(number).copied() == of_kind
        });
    }

    fn once<R>(&mut self, name: &str, mut what: impl FnMut() -> R) {
        match &self.wanted {
            None => println!("{name} "),
            Some(wanted) if wanted == name => {
                counted_step(|| black_box(what()));
                self.steps = 1;
            }
            Some(_) => {}
        }
    }
}

/// Runs all steps, those that are `counted` through a door of their own, and gives the kind of each.
fn run<W: Work>(work: &W, counted: impl Fn(usize) -> bool) -> Vec<usize> {
    let mut state = work.begin();
    let mut kinds = Vec::new();
    for number in 0..work.steps() {
        work.prepare(&mut state, number);
        let state_now = black_box(&mut state);
        let out = if counted(number) {
            counted_step(|| work.step(state_now, number))
        } else {
            work.step(state_now, number)
        };
        let out = black_box(out);
        kinds.push(work.kind(&state));
        work.finish(&mut state, &out);
    }
    kinds
}

/// What callgrind counts.
#[inline(never)]
fn counted_step<R>(step: impl FnOnce() -> R) -> R {
    step()
}
