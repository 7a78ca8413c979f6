//! Hours of work with everything that can go wrong in them. After a program, nothing of it is left in memory.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use std::time::Duration;

use leadscrew_core::board::State;
use leadscrew_core::units::Length;
use leadscrew_tests::soak::{Bench, Luck, Soaked, Until, hours, shrink, soak};

/// Ticks from the fixed seed.
fn ticks() -> u64 {
    leadscrew_seed::amount(1_000_000, 2_000_000)
}
/// Ticks from the seed of the run.
fn fresh_ticks() -> u64 {
    leadscrew_seed::amount(500_000, 4_000_000)
}

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

/// Soaks, and looks whether anything of a program is left in memory.
fn soak_dry(seed: u64, ticks: u64) -> Soaked {
    let mut empty = None;
    let soaked = soak(seed, ticks, |counts| {
        let now = live();
        let empty = *empty.get_or_insert(now);
        assert_eq!(
            now, empty,
            "blocks and bytes that live behind program {} and behind the first",
            counts.programs
        );
    });
    println!("{soaked}");
    soaked
}

#[test]
fn whatever_happens_nothing_happens_that_must_not() {
    let soaked = soak_dry(1, ticks());
    let counts = soaked.counts;
    // It was a soak, and no bath.
    assert!(counts.finished * 3 > counts.programs, "{soaked}");
    assert!(counts.finished < counts.programs, "{soaked}");
    let often = ticks() / 250_000;
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
    let synchronous = [judged.threads.iter().sum(), judged.taps, judged.floats];
    assert!(
        synchronous.iter().all(|rows| *rows > ticks() / 100),
        "{soaked}"
    );
    // Machines with any encoder and with drives that lag: fewer of each.
    let grooves = [judged.grooves, judged.tools.iter().sum()];
    let classes = judged.threads.into_iter().chain(grooves);
    assert!(
        classes.into_iter().all(|rows| rows > ticks() / 2_000),
        "{soaked}"
    );
}

#[test]
fn a_soak_is_repeated_by_its_seed() {
    let first = soak(7, 1, |_| {});
    let again = soak(7, 1, |_| {});
    assert_eq!(first.to_string(), again.to_string());
}

#[test]
fn nor_where_nobody_has_looked_before() {
    leadscrew_seed::only_fresh(|seed| {
        let soaked = soak_dry(seed, fresh_ticks());
        assert!(soaked.counts.finished > 0, "{soaked}");
    });
}

/// A fault that this machine has not: a tap that is held below R.
fn plant(bench: &Bench) {
    let below = bench.sim.board().tap_line();
    let below = below.is_some_and(|line| line.gear.depth(bench.position()) > Length::ZERO);
    let held = bench.state() == State::Held;
    assert!(!(below && held), "planted");
}

/// Seeds whose shift has the fault. How soon a tap is held below R depends on what is drawn, and any change of the
/// parameters or programs draws anew.
fn planted() -> impl Iterator<Item = u64> {
    (0..20).flat_map(|round| {
        let report = hours(100 + 1000 * round, Until::Ticks(400_000), 1, plant, &|_| {});
        let seeds = report.failures.first_key_value().map(|(kind, failures)| {
            assert!(kind.ends_with("planted"), "{report}");
            failures.seeds.clone()
        });
        seeds.unwrap_or_default()
    })
}

#[test]
fn a_failure_is_cut_down_to_what_it_needs() {
    // A shift with single block or a silent gateway may need more than the hold, and one with a single job all of it. One
    // that needs the hold alone, and not all of its jobs, is looked for.
    let one_chance = |seed: &u64| {
        let shortest = shrink(*seed, plant).expect("it fails again");
        assert!(shortest.failure.kind.ends_with("planted"), "{shortest}");
        let [jobs, chances, _] = shortest.sizes;
        assert!(chances[1] <= chances[0], "{shortest}");
        chances[1] == 1 && jobs[1] < jobs[0]
    };
    let seed = planted().find(one_chance).expect("one of the shifts");
    let shortest = shrink(seed, plant).expect("it fails again");
    // The job with the hole, perhaps the one that brings the tap to where the hole begins, and whoever holds in it.
    let [jobs, chances, lines] = shortest.sizes;
    assert!(jobs[1] <= 2 && jobs[0] > jobs[1], "{shortest}");
    assert_eq!(chances[1], 1, "{shortest}");
    assert!(chances[0] > 1 && lines[0] > lines[1], "{shortest}");
    let what: Vec<_> = shortest.script.chances.iter().map(|one| one.luck).collect();
    assert_eq!(what, [Luck::Act]);
    let job = *shortest.script.jobs.last().expect("one at least");
    let text = shortest.script.programs[&job].left();
    let left: Vec<&str> = text.lines().filter(|line| !line.is_empty()).collect();
    // The first line, the way to the end and M30 stay in any case. A hole takes its own line, M29 or M3 ahead of it, and
    // perhaps the way to where it begins.
    let hole = &left[1..left.len() - 2];
    assert!(hole.len() <= 4, "{shortest}");
    let taps = |line: &&&str| line.contains("G84") || line.contains("G88");
    assert_eq!(hole.iter().filter(taps).count(), 1, "{shortest}");
    let told = shortest.to_string();
    for words in [hole[0], "order: Hold", "machine: ", "planted"] {
        assert!(told.contains(words), "{words} is not in\n{told}");
    }

    // It comes to the same each time.
    let again = shrink(seed, plant).expect("it fails again");
    assert_eq!(told, again.to_string());
}

#[test]
fn a_shift_that_does_not_fail_is_not_cut_down() {
    assert!(shrink(1, |_| {}).is_none());
}

/// It goes on after a failure, and all of them are counted.
#[test]
fn a_soak_goes_on_after_a_failure() {
    let seed = planted().next().expect("it is found");
    let told = std::sync::Mutex::new(Vec::new());
    let tell = |words: &str| told.lock().expect("nobody failed").push(words.to_owned());
    let report = hours(seed, Until::Ticks(1_500_000), 2, plant, &tell);
    assert!(report.soaked.shifts > 1 && report.failed() > 1, "{report}");
    assert_eq!(report.failures.len(), 1, "{report}");
    let failures = &report.failures.values().next().expect("one");
    assert_eq!(failures.count, report.failed());
    assert_eq!(failures.seeds[0], seed);
    // One of the kind is told whole, and cut down.
    let told = told.into_inner().expect("nobody failed");
    let [failure, shortest] = told.as_slice() else {
        panic!("{told:?}")
    };
    assert!(
        failure.contains("to repeat it: cargo xtask soak --seed"),
        "{failure}"
    );
    assert!(
        shortest.contains("the least that fails in this way"),
        "{shortest}"
    );
    let all = report.to_string();
    assert!(all.ends_with("failures of 1 kinds"), "{all}");
    assert!(all.contains(&format!("seeds {seed} ")), "{all}");
}

#[test]
fn time_that_is_over_is_a_soak_of_nothing() {
    let report = hours(1, Until::Time(Duration::ZERO), 2, |_| {}, &|_| {});
    assert_eq!((report.soaked.shifts, report.failed()), (0, 0));
}
