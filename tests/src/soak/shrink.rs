//! Reduces a failing shift to the least that still fails in the same way, by leaving out jobs, chance events and lines of
//! programs.

use std::any::Any;
use std::backtrace::{Backtrace, BacktraceStatus};
use std::cell::{Cell, RefCell};
use std::panic::{AssertUnwindSafe, PanicHookInfo};
use std::sync::Once;

use leadscrew_core::params::{Entry, Params};

use super::bench::{Bench, Counts};
use super::script::{Draws, Script, Told};
use super::shift::Shift;
use super::{Judged, SHIFT_TICKS};

/// The most runs of one shift that are tried.
const MOST_RUNS: u32 = 3_000;
/// The part of a message that distinguishes one kind of failure from another, in letters.
const OF_A_KIND: usize = 200;

/// A condition after every tick, in addition to the bench's own checks.
pub type Must = fn(&Bench);

/// A shift that failed.
#[derive(Debug)]
pub struct Failure {
    /// The seed of the shift.
    pub seed: u64,
    /// Ticks before the failure.
    pub tick: u64,
    /// Place in the code, and the message without its numbers.
    pub kind: String,
    /// Place and the whole message.
    pub message: String,
    /// The backtrace, where `RUST_BACKTRACE` asks for it.
    trace: Backtrace,
    /// The work of the machine at that time.
    pub doing: String,
    payload: Box<dyn Any + Send>,
}

impl Failure {
    /// Continues the original panic.
    pub fn go_on(self) -> ! {
        std::panic::resume_unwind(self.payload)
    }
}

impl core::fmt::Display for Failure {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let Self {
            seed,
            tick,
            message,
            trace,
            doing,
            ..
        } = self;
        writeln!(f, "seed {seed}, tick {tick}, {doing}")?;
        writeln!(f, "{message}")?;
        if trace.status() == BacktraceStatus::Captured {
            writeln!(f, "{trace}")?;
        }
        write!(f, "to repeat it: cargo xtask soak --seed {seed} --ticks 1")
    }
}

/// A panic that was caught.
struct Caught {
    place: String,
    message: String,
    trace: Backtrace,
}

thread_local! {
    /// True while panics of this thread are caught and not shown.
    static CATCHES: Cell<bool> = const { Cell::new(false) };
    static CAUGHT: RefCell<Option<Caught>> = const { RefCell::new(None) };
}

fn hook(info: &PanicHookInfo) {
    let place = info.location().map(ToString::to_string).unwrap_or_default();
    let caught = Caught {
        place,
        message: info.payload_as_str().unwrap_or("no text").into(),
        trace: Backtrace::capture(),
    };
    CAUGHT.with(|last| last.replace(Some(caught)));
}

/// Calls `work` and returns its panic.
fn catch(work: impl FnOnce()) -> Result<(), (Caught, Box<dyn Any + Send>)> {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let before = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |info| {
            if CATCHES.get() {
                hook(info);
            } else {
                before(info);
            }
        }));
    });
    CATCHES.set(true);
    let done = std::panic::catch_unwind(AssertUnwindSafe(work));
    CATCHES.set(false);
    done.map_err(|payload| {
        let caught = CAUGHT.with(RefCell::take).expect("the hook was there");
        (caught, payload)
    })
}

/// A message without its numbers: the common part of two failures with one cause.
fn kind(place: &str, message: &str) -> String {
    let mut kind = format!("{place}: ");
    let mut in_number = false;
    let line = message.lines().next().unwrap_or_default();
    for letter in line.chars().take(OF_A_KIND) {
        let number = letter.is_ascii_digit() || in_number && letter == '.';
        if number && !in_number {
            let sign = kind.ends_with('-');
            kind.truncate(kind.len() - usize::from(sign));
            kind.push('#');
        } else if !number {
            kind.push(letter);
        }
        in_number = number;
    }
    kind
}

/// The result of a shift.
pub(super) struct Worked {
    /// What was done.
    pub counts: Counts,
    /// What was judged.
    pub judged: Judged,
    /// The failure.
    pub failure: Option<Failure>,
    /// The draws.
    pub draws: Draws,
    /// The machine, in words.
    machine: String,
}

/// Works a shift: `jobs`, or as many jobs as it takes.
pub(super) fn work(
    seed: u64,
    draws: Draws,
    jobs: Option<u32>,
    must: Must,
    mut between: impl FnMut(&Counts),
) -> Worked {
    let mut shift = None;
    let outcome = catch(|| {
        let shift = shift.insert(Shift::begin(draws));
        shift.bench.must = must;
        let mut done = 0;
        while jobs.map_or(shift.ticks() < SHIFT_TICKS, |jobs| done < jobs) {
            shift.work();
            between(shift.counts());
            done += 1;
        }
    });
    let failure = outcome.err().map(|(caught, payload)| {
        let (job, program, text) = shift.as_ref().map_or((0, 0, ""), Shift::under_way);
        let Caught {
            place,
            message,
            trace,
        } = caught;
        Failure {
            seed,
            tick: shift.as_ref().map_or(0, Shift::ticks),
            kind: kind(&place, &message),
            message: format!("{place}: {message}"),
            trace,
            doing: format!("job {job}, program {program}:\n{text}"),
            payload,
        }
    });
    let Some(mut shift) = shift else {
        return Worked {
            counts: Counts::default(),
            judged: Judged::default(),
            failure,
            draws: Draws::live(seed),
            machine: String::new(),
        };
    };
    let machine = match failure {
        Some(_) => machine(&shift),
        None => String::new(),
    };
    Worked {
        counts: *shift.counts(),
        judged: *shift.judged(),
        failure,
        draws: core::mem::replace(&mut shift.bench.random, Draws::live(seed)),
        machine,
    }
}

/// The differences from the built-in machine.
fn machine(shift: &Shift) -> String {
    let usual = Params::sheets();
    let others: Vec<String> = Entry::all()
        .iter()
        .filter(|entry| usual.get(entry) != shift.built_in.get(entry))
        .map(|entry| format!("{entry} = {}", shift.built_in.get(entry)))
        .collect();
    let bench = &shift.bench;
    format!(
        "machine: {}\nplant: {:?}\nwire of the gateway, in percent: {:?}",
        others.join(", "),
        bench.options,
        bench.wire
    )
}

/// The least that fails in the same way.
#[derive(Debug)]
pub struct Shortest {
    /// The rest of the script.
    pub script: Script,
    /// The report of playing it.
    pub told: Told,
    /// Its failure.
    pub failure: Failure,
    /// Jobs, chance events and lines of programs: in the whole shift, and in the rest.
    pub sizes: [[usize; 2]; 3],
    /// Number of runs.
    pub runs: u32,
    machine: String,
}

impl core::fmt::Display for Shortest {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let [jobs, chances, lines] = self.sizes.map(|[all, left]| format!("{left} of {all}"));
        writeln!(
            f,
            "the least that fails in this way, in {} runs: {jobs} jobs, {chances} things by chance, {lines} lines",
            self.runs
        )?;
        writeln!(f, "{}", self.machine)?;
        for line in &self.told.lines {
            writeln!(f, "{line}")?;
        }
        let Failure { tick, message, .. } = &self.failure;
        write!(f, "tick {tick} of the shift: {message}")
    }
}

struct Shrinker {
    seed: u64,
    kind: String,
    must: Must,
    script: Script,
    told: Told,
    failure: Option<Failure>,
    machine: String,
    runs: u32,
}

/// Reduces the shift of this seed. `None` where it does not fail, or does not fail in this way when its script is played.
pub fn shrink(seed: u64, must: Must) -> Option<Shortest> {
    let worked = work(seed, Draws::record(seed), None, must, |_| {});
    let kind = worked.failure?.kind;
    let (script, told) = worked.draws.into_script();
    let whole = sizes(&script);
    let mut shrinker = Shrinker {
        seed,
        kind,
        must,
        script: script.clone(),
        told,
        failure: None,
        machine: String::new(),
        runs: 0,
    };
    if !shrinker.fails(script) {
        return None;
    }
    shrinker.cut();
    let least = sizes(&shrinker.script);
    Some(Shortest {
        sizes: [0, 1, 2].map(|n| [whole[n], least[n]]),
        script: shrinker.script,
        told: shrinker.told,
        failure: shrinker.failure?,
        runs: shrinker.runs,
        machine: shrinker.machine,
    })
}

/// Number of jobs, chance events and lines of programs.
fn sizes(script: &Script) -> [usize; 3] {
    [script.jobs.len(), script.chances.len(), lines(script).len()]
}

/// The remaining lines, by the job of their program.
fn lines(script: &Script) -> Vec<(u32, usize)> {
    let programs = script.programs.iter();
    programs
        .filter(|(job, _)| script.jobs.contains(job))
        .flat_map(|(job, written)| {
            let left = written.lines().into_iter();
            left.filter(|line| !written.without.contains(line))
                .map(|line| (*job, line))
        })
        .collect()
}

impl Shrinker {
    /// Plays the script. If it fails in the same way, it replaces the script so far.
    fn fails(&mut self, mut script: Script) -> bool {
        if self.runs >= MOST_RUNS {
            return false;
        }
        self.runs += 1;
        let jobs = script.jobs.last().copied().unwrap_or(0);
        let draws = Draws::play(script.clone());
        let worked = work(self.seed, draws, Some(jobs), self.must, |_| {});
        let same = worked.failure.filter(|failure| failure.kind == self.kind);
        let Some(failure) = same else {
            return false;
        };
        let (_, told) = worked.draws.into_script();
        // Chance events that did not happen any more are left out too.
        script.chances.clone_from(&told.chances);
        self.script = script;
        self.told = told;
        self.failure = Some(failure);
        self.machine = worked.machine;
        true
    }

    fn cut(&mut self) {
        loop {
            let before = sizes(&self.script);
            self.leave_out(
                |script| script.jobs.clone(),
                |script, some| script.jobs.retain(|job| !some.contains(job)),
            );
            self.leave_out(
                |script| script.chances.iter().copied().collect(),
                |script, some| script.chances.retain(|chance| !some.contains(chance)),
            );
            self.leave_out(lines, |script, some| {
                for (job, line) in some {
                    if let Some(written) = script.programs.get_mut(job) {
                        written.without.insert(*line);
                    }
                }
            });
            if sizes(&self.script) == before {
                return;
            }
        }
    }

    /// Leaves out as many items as possible: all, halves, quarters, finally single ones.
    fn leave_out<T>(
        &mut self,
        list: impl Fn(&Script) -> Vec<T>,
        without: impl Fn(&mut Script, &[T]),
    ) {
        let mut size = list(&self.script).len();
        while size > 0 {
            let mut from = 0;
            loop {
                let all = list(&self.script);
                let Some(rest) = all.get(from..).filter(|rest| !rest.is_empty()) else {
                    break;
                };
                let some = &rest[..size.min(rest.len())];
                let mut script = self.script.clone();
                without(&mut script, some);
                if !self.fails(script) {
                    from += some.len();
                }
            }
            size /= 2;
        }
    }
}
