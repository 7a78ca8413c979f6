//! A fixed seed is a list of cases; only a new seed finds something new. So each random test runs twice: with a seed of its
//! own, whose cases stay, and with the seed of the commit, whose cases no commit before has tried. Full volumes are for the
//! second: what stays need not be tried at length each time.
//!
//! The commit's seed is the beginning of its hash. It stays the same while a change is being made, so that a failure is
//! still there after an attempt to mend it. `LEADSCREW_SEED` takes its place: that is how a failure is repeated, and a
//! test that fails says the command. Outside git the seed is a fixed one; `cargo xtask test` prints the seed and where it
//! is from.
//!
//! How much a test tries is [`amount`]: a part of it each time, all of it with `LEADSCREW_FULL=1`, which is what
//! `cargo xtask test --full` sets.

mod random;

use std::cell::Cell;
use std::fmt;
use std::process::Command;
use std::sync::OnceLock;

pub use random::Random;

/// The variable that takes the place of the commit.
pub const VARIABLE: &str = "LEADSCREW_SEED";

/// The variable that asks for full volumes: 1.
pub const FULL: &str = "LEADSCREW_FULL";

/// Where there is no commit.
const NO_COMMIT: u64 = 1;

/// Digits of the hash that make the seed: 60 bits, so that it fits whatever counts from it.
const DIGITS: usize = 15;

/// Where the seed is from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// From `LEADSCREW_SEED`.
    Given,
    /// From the hash of the commit that is checked out.
    Commit,
    /// From nowhere: this is no working copy of git.
    Fixed,
}

impl fmt::Display for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Given => "from LEADSCREW_SEED",
            Self::Commit => "from the commit",
            Self::Fixed => "a fixed one, for there is no commit here",
        })
    }
}

/// The seed of this run, and where it is from.
///
/// # Panics
/// Where `LEADSCREW_SEED` is no whole number from 1 on.
pub fn of_run() -> (u64, Source) {
    static SEED: OnceLock<(u64, Source)> = OnceLock::new();
    *SEED.get_or_init(|| match std::env::var(VARIABLE) {
        Ok(given) => (read(&given), Source::Given),
        Err(_) => match commit().as_deref().and_then(of_hash) {
            Some(seed) => (seed, Source::Commit),
            None => (NO_COMMIT, Source::Fixed),
        },
    })
}

/// True where this run tries full volumes.
///
/// # Panics
/// Where `LEADSCREW_FULL` is neither 1 nor 0.
pub fn full() -> bool {
    static IS_FULL: OnceLock<bool> = OnceLock::new();
    *IS_FULL.get_or_init(|| std::env::var(FULL).is_ok_and(|asked| is_full(&asked)))
}

thread_local! {
    /// True while this test tries its own seed in [`volume`].
    static IS_FIXED: Cell<bool> = const { Cell::new(false) };
}

/// How much a test tries, or how far apart the places are that it tries: `full` in a run of full volumes; `usual` in all
/// others, and for the fixed cases of [`volume`].
///
/// # Panics
/// As [`full`].
pub fn amount<T>(usual: T, full: T) -> T {
    if self::full() && !IS_FIXED.get() {
        full
    } else {
        usual
    }
}

/// The seed of this run.
///
/// # Panics
/// As [`of_run`].
pub fn fresh() -> u64 {
    of_run().0
}

/// Runs a random test with its own seed, of which it tries the usual [`amount`], and with that of this run. Where the
/// second fails, the command that repeats it is printed.
///
/// # Panics
/// Where the test does.
pub fn volume(fixed: u64, mut test: impl FnMut(u64)) {
    IS_FIXED.set(true);
    test(fixed);
    IS_FIXED.set(false);
    only_fresh(test);
}

/// Runs a random test with the seed of this run alone, where its fixed cases are another test.
///
/// # Panics
/// Where the test does.
pub fn only_fresh(test: impl FnOnce(u64)) {
    let repeat = Repeat { seed: fresh() };
    test(repeat.seed);
}

fn read(given: &str) -> u64 {
    match given.parse() {
        Ok(seed) if seed > 0 => seed,
        _ => panic!("{VARIABLE}={given} is no whole number from 1 on"),
    }
}

fn is_full(asked: &str) -> bool {
    match asked {
        "1" => true,
        "0" => false,
        _ => panic!("{FULL}={asked} is neither 1 nor 0"),
    }
}

fn commit() -> Option<String> {
    let asked = Command::new("git")
        .args(["rev-parse", "--verify", "HEAD"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .ok()?;
    let hash = String::from_utf8(asked.stdout).ok()?;
    asked.status.success().then(|| hash.trim().into())
}

fn of_hash(hash: &str) -> Option<u64> {
    let digits = hash.get(..DIGITS)?;
    u64::from_str_radix(digits, 16).ok().map(|seed| seed.max(1))
}

/// Says how to repeat what fails.
struct Repeat {
    seed: u64,
}

impl Drop for Repeat {
    fn drop(&mut self) {
        if std::thread::panicking() {
            eprintln!("to repeat what failed: {}", again(self.seed));
        }
    }
}

/// The command that runs this test, which is that of this thread, with a seed.
fn again(seed: u64) -> String {
    let own = std::env::current_exe().unwrap_or_default();
    // Cargo adds a hash: `whole-0123456789abcdef`.
    let stem = own.file_stem().unwrap_or_default().to_string_lossy();
    let target = stem.rsplit_once('-').map_or(&*stem, |(name, _)| name);
    let package = std::env::var("CARGO_PKG_NAME").unwrap_or_default();
    let settings = settings(seed, full());
    let thread = std::thread::current();
    let test = thread.name().filter(|name| *name != "main").unwrap_or("");
    // Some need more than cargo: a bus, an image.
    if ["vcan", "emulated"].contains(&target) {
        return format!("{settings} cargo xtask {target} {test}");
    }
    let which = if target.replace('_', "-") == package {
        String::new()
    } else {
        format!(" --test {target}")
    };
    let only = if test.is_empty() {
        String::new()
    } else {
        format!(" {test} -- --exact")
    };
    format!("{settings} cargo test -p {package}{which}{only}")
}

/// The variables of a run, as a shell takes them.
pub fn settings(seed: u64, full: bool) -> String {
    let full = if full {
        format!("{FULL}=1 ")
    } else {
        String::new()
    };
    format!("{full}{VARIABLE}={seed}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_commit_has_a_seed_and_another_commit_another() {
        let of = |hash: &str| of_hash(hash).expect("a hash");
        let one = of("e1e1e65d0f0a4b1c9a7700000000000000000000");
        assert_eq!(one, 0x0E1E_1E65_D0F0_A4B1);
        assert_ne!(one, of("e1e1e65d0f0a4b2c9a7700000000000000000000"));
        // A seed of 0 would make some generators stand still.
        assert_eq!(of("000000000000000000000000000000000000000a"), 1);
        assert_eq!(of_hash("e1e1e65"), None);
        assert_eq!(of_hash("not a hash at all"), None);
    }

    #[test]
    fn a_given_seed_is_a_number_or_refused() {
        assert_eq!(read("12"), 12);
        for wrong in ["", "0", "-1", "x", "1.5", "18446744073709551616"] {
            assert!(std::panic::catch_unwind(|| read(wrong)).is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_test_runs_with_its_own_seed_and_with_that_of_the_run() {
        let mut tried = Vec::new();
        volume(7, |seed| tried.push((seed, amount(2, 9))));
        assert_eq!(tried, [(7, 2), (fresh(), amount(2, 9))]);
    }

    #[test]
    fn what_repeats_a_test_is_one_command() {
        let own =
            "cargo test -p leadscrew-seed tests::what_repeats_a_test_is_one_command -- --exact";
        let full = if full() { "LEADSCREW_FULL=1 " } else { "" };
        assert_eq!(again(5), format!("{full}LEADSCREW_SEED=5 {own}"));
    }

    #[test]
    fn a_run_of_full_volumes_is_asked_for_in_one_way() {
        assert_eq!(settings(5, true), "LEADSCREW_FULL=1 LEADSCREW_SEED=5");
        assert_eq!(settings(5, false), "LEADSCREW_SEED=5");
        assert_eq!(amount(2, 9), if full() { 9 } else { 2 });
        assert!(is_full("1") && !is_full("0"));
        for wrong in ["", "yes", "2", "true"] {
            assert!(
                std::panic::catch_unwind(|| is_full(wrong)).is_err(),
                "{wrong}"
            );
        }
    }
}
