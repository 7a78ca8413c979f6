//! The counter. With `-icount shift=0` an instruction takes one nanosecond of the emulator's time, and TIMER0 counts
//! down at 25 MHz, so one count is 40 instructions. The same sequence of steps is run several times, each time a few
//! instructions later against the timer; the sum over the runs resolves single steps to a few instructions.

use core::hint::black_box;
use core::ptr::{read_volatile, write_volatile};
use core::sync::atomic::{AtomicU32, Ordering};

use crate::print;

const TIMER0: usize = 0x4000_0000;
const CONTROL: *mut u32 = TIMER0 as *mut u32;
const VALUE: *mut u32 = (TIMER0 + 4) as *mut u32;
const RELOAD: *mut u32 = (TIMER0 + 8) as *mut u32;

/// Instructions in one count of the timer.
const PER_COUNT: u32 = 40;
/// Runs of each sequence, and how much later each begins.
const RUNS: u32 = 20;
const SHIFT: u32 = PER_COUNT / RUNS;

/// Longest sequence of steps.
pub const MAX_STEPS: usize = 16384;
static SUMS: [AtomicU32; MAX_STEPS] = [const { AtomicU32::new(0) }; MAX_STEPS];
/// Sum over the runs for a step that does nothing.
static EMPTY: AtomicU32 = AtomicU32::new(0);

/// Starts the timer and measures what measuring costs.
pub fn start() {
    // SAFETY: the registers of TIMER0, which nothing else uses.
    unsafe {
        write_volatile(RELOAD, u32::MAX);
        write_volatile(VALUE, u32::MAX);
        write_volatile(CONTROL, 1);
    }
    EMPTY.store(0, Ordering::Relaxed);
    collect(64, || (), |(), _| ());
    let sum: u32 = SUMS
        .iter()
        .take(64)
        .map(|sum| sum.load(Ordering::Relaxed))
        .sum();
    EMPTY.store((sum + 32) / 64, Ordering::Relaxed);
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

fn collect<S, R>(
    steps: usize,
    mut begin: impl FnMut() -> S,
    mut step: impl FnMut(&mut S, usize) -> R,
) {
    for sum in &SUMS {
        sum.store(0, Ordering::Relaxed);
    }
    for run in 0..RUNS {
        let mut state = begin();
        spin(run * SHIFT / 2);
        for (number, sum) in SUMS.iter().enumerate().take(steps) {
            let before = now();
            black_box(step(black_box(&mut state), number));
            let after = now();
            sum.store(
                sum.load(Ordering::Relaxed) + before.wrapping_sub(after),
                Ordering::Relaxed,
            );
        }
    }
}

/// Runs `steps` steps from a state that `begin` makes, and prints mean and worst.
pub fn count<S, R>(
    name: impl core::fmt::Display,
    steps: usize,
    begin: impl FnMut() -> S,
    step: impl FnMut(&mut S, usize) -> R,
) {
    assert!(
        steps <= MAX_STEPS,
        "{name}: more steps than there is room for"
    );
    collect(steps, begin, step);
    let (mut total, mut worst) = (0_u64, 0_u32);
    for sum in SUMS.iter().take(steps) {
        let sum = sum
            .load(Ordering::Relaxed)
            .saturating_sub(EMPTY.load(Ordering::Relaxed));
        total += u64::from(sum);
        worst = worst.max(sum);
    }
    // A sum over the runs of counts of 40 is one of instructions times RUNS / 40.
    let mean = total * u64::from(SHIFT) / steps as u64;
    print(format_args!("{name} {mean} {}\n", worst * SHIFT));
}
