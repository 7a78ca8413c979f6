//! The counter. With `-icount shift=0` an instruction takes one nanosecond of the emulator's time. TIMER0 counts down
//! at 25 MHz, so one count is 40 instructions. The same sequence of steps runs several times, each time a few
//! instructions later against the timer. The sum over the runs resolves single steps to a few instructions.

use core::cell::RefCell;
use core::hint::black_box;
use core::ptr::{read_volatile, write_volatile};
use core::sync::atomic::{AtomicU8, AtomicU32, Ordering};

use audit::work::{Counter, Work};

use leadscrew_console::print;

const TIMER0: usize = 0x4000_0000;
const CONTROL: *mut u32 = TIMER0 as *mut u32;
const VALUE: *mut u32 = (TIMER0 + 4) as *mut u32;
const RELOAD: *mut u32 = (TIMER0 + 8) as *mut u32;

/// Instructions in one count of the timer.
const PER_COUNT: u32 = 40;
/// Runs of each sequence, and the instructions by which each run begins later.
const RUNS: u32 = 20;
const SHIFT: u32 = PER_COUNT / RUNS;

/// The longest sequence of steps.
const MAX_STEPS: usize = 16384;
static SUMS: [AtomicU32; MAX_STEPS] = [const { AtomicU32::new(0) }; MAX_STEPS];
static KINDS: [AtomicU8; MAX_STEPS] = [const { AtomicU8::new(0) }; MAX_STEPS];
/// The sum over the runs for a step that does nothing.
static EMPTY: AtomicU32 = AtomicU32::new(0);

/// Starts the timer and measures the cost of measuring.
pub fn start() {
    // SAFETY: the registers of TIMER0, which nothing else uses.
    unsafe {
        write_volatile(RELOAD, u32::MAX);
        write_volatile(VALUE, u32::MAX);
        write_volatile(CONTROL, 1);
    }
    EMPTY.store(0, Ordering::Relaxed);
    let steps = Nothing.steps();
    collect(&Nothing, steps);
    let sums = SUMS.iter().take(steps);
    let sum: u32 = sums.map(|sum| sum.load(Ordering::Relaxed)).sum();
    EMPTY.store(sum / steps as u32, Ordering::Relaxed);
}

#[inline(always)]
fn now() -> u32 {
    // SAFETY: reading the counter has no effect.
    unsafe { read_volatile(VALUE) }
}

/// Uses up `2 n` instructions.
#[inline(never)]
pub fn spin(n: u32) {
    if n > 0 {
        // SAFETY: counts a register down and touches nothing else.
        unsafe {
            core::arch::asm!("2:", "subs {n}, {n}, #1", "bne 2b", n = inout(reg) n => _, options(nomem, nostack));
        }
    }
}

/// Leaves in [`SUMS`] the sum of every step over the runs, the cost of measuring included, and in [`KINDS`] the kinds.
fn collect<W: Work>(work: &W, steps: usize) {
    assert!(steps <= MAX_STEPS, "more steps than there is room for");
    for sum in &SUMS {
        sum.store(0, Ordering::Relaxed);
    }
    for run in 0..RUNS {
        let mut state = work.begin();
        spin(run * SHIFT / 2);
        for (number, (sum, kind)) in SUMS.iter().zip(&KINDS).enumerate().take(steps) {
            work.prepare(&mut state, number);
            let before = now();
            let out = black_box(work.step(black_box(&mut state), number));
            let after = now();
            sum.fetch_add(before.wrapping_sub(after), Ordering::Relaxed);
            kind.store(work.kind(&state) as u8, Ordering::Relaxed);
            work.finish(&mut state, &out);
        }
    }
}

/// Counts and prints.
pub struct Printer;

impl Counter for Printer {
    fn steps<W: Work>(&mut self, name: &str, work: &W) {
        let steps = work.steps();
        collect(work, steps);
        for (kind, ending) in work.kinds().iter().enumerate() {
            let (mut count, mut total, mut worst) = (0_u32, 0_u64, 0_u32);
            for (sum, of) in SUMS.iter().zip(&KINDS).take(steps) {
                if usize::from(of.load(Ordering::Relaxed)) == kind {
                    let empty = EMPTY.load(Ordering::Relaxed);
                    let sum = sum.load(Ordering::Relaxed).saturating_sub(empty);
                    count += 1;
                    total += u64::from(sum);
                    worst = worst.max(sum);
                }
            }
            // The sum over the runs is in counts of 40 instructions; times 40 and divided by RUNS it is a mean in
            // instructions.
            let mean = (total * u64::from(SHIFT))
                .checked_div(u64::from(count))
                .unwrap_or(0);
            print(format_args!("{name}{ending} {mean} {}\n", worst * SHIFT));
        }
    }

    fn once<R>(&mut self, name: &str, what: impl FnMut() -> R) {
        self.steps(name, &Once(RefCell::new(what)));
    }
}

/// A work of one step, for something that happens once.
struct Once<F>(RefCell<F>);

impl<R, F: FnMut() -> R> Work for Once<F> {
    type State = ();
    type Out = R;

    fn steps(&self) -> usize {
        1
    }

    fn begin(&self) {}

    fn step(&self, (): &mut (), _: usize) -> R {
        (self.0.borrow_mut())()
    }
}

/// A work that does nothing: its time is the cost of measuring.
struct Nothing;

impl Work for Nothing {
    type State = ();
    type Out = ();

    fn steps(&self) -> usize {
        64
    }

    fn begin(&self) {}

    fn step(&self, (): &mut (), _: usize) {}
}
