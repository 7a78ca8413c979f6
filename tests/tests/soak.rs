//! Hours of work with everything that can go wrong in them; and nothing of a program is left in memory behind it.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use leadscrew_tests::soak::soak;

/// Ticks, in all.
const TICKS: u64 = if cfg!(debug_assertions) {
    1_500_000
} else {
    10_000_000
};

/// The allocator of these tests: it counts what lives, for each thread.
struct Counting;

thread_local! {
    /// Blocks and bytes.
    static LIVE: Cell<(i64, i64)> = const { Cell::new((0, 0)) };
}

fn count(blocks: i64, bytes: i64) {
    // A thread that ends frees its last blocks when this is gone.
    let _ = LIVE.try_with(|live| {
        let (some, size) = live.get();
        live.set((some + blocks, size + bytes));
    });
}

fn live() -> (i64, i64) {
    LIVE.with(Cell::get)
}

// SAFETY: every block comes from the system's allocator and goes back to it with the same layout; the counting in between
// allocates nothing.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count(1, layout.size() as i64);
        // SAFETY: the caller's promise is the one that is asked for here.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        count(-1, -(layout.size() as i64));
        // SAFETY: as above.
        unsafe { System.dealloc(block, layout) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

#[test]
fn whatever_happens_nothing_happens_that_must_not() {
    let mut empty = None;
    let soaked = soak(1, TICKS, |counts| {
        let now = live();
        let empty = *empty.get_or_insert(now);
        assert_eq!(
            now, empty,
            "blocks and bytes that live behind program {} and behind the first",
            counts.programs
        );
    });
    println!("{soaked}");
    let counts = soaked.counts;
    // It was a soak, and no bath.
    assert!(counts.finished * 3 > counts.programs, "{soaked}");
    assert!(counts.finished < counts.programs, "{soaked}");
    let often = TICKS / 250_000;
    let all = [
        counts.alarms,
        counts.bus,
        counts.troubles,
        counts.cuts,
        counts.pushed,
        counts.refused,
        counts.orders.iter().copied().min().unwrap_or(0),
    ];
    assert!(all.iter().all(|one| *one > often), "{soaked}");
    let judged = soaked.judged;
    let synchronous = [judged.threads, judged.taps, judged.floats];
    assert!(
        synchronous.iter().all(|rows| *rows > TICKS / 100),
        "{soaked}"
    );
}

#[test]
fn a_soak_is_repeated_by_its_seed() {
    let first = soak(7, 1, |_| {});
    let again = soak(7, 1, |_| {});
    assert_eq!(first.to_string(), again.to_string());
}
