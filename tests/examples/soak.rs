//! A soak of any length from any seed on all cores: `cargo xtask soak [--hours H | --ticks N] [--seed S]`.

use std::process::ExitCode;
use std::time::Duration;

use leadscrew_tests::soak::{Until, hours};

const USAGE: &str = "usage: soak SEED TICKS, whole numbers; or soak SEED HOURSh";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let Some((seed, until)) = read(&arguments) else {
        eprintln!("{USAGE}");
        return ExitCode::from(2);
    };
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    println!("seed {seed}, {threads} threads");
    let report = hours(seed, until, threads, |_| {}, &|words| println!("{words}"));
    println!("{report}");
    ExitCode::from(u8::from(report.failed() > 0))
}

fn read(arguments: &[String]) -> Option<(u64, Until)> {
    let [seed, length] = arguments else {
        return None;
    };
    let until = match length.strip_suffix('h') {
        Some(hours) => {
            let hours: f64 = hours.parse().ok()?;
            Until::Time(Duration::try_from_secs_f64(hours * 3600.0).ok()?)
        }
        None => Until::Ticks(length.parse().ok()?),
    };
    Some((seed.parse().ok()?, until))
}
