//! A machine at work for hours of its own time, under an operator who presses anything.

use std::time::{SystemTime, UNIX_EPOCH};

use anyhow::{Context, Result, bail};

use crate::run;

/// The default number of ticks.
const TICKS: u64 = 10_000_000;

const USAGE: &str = "usage: cargo xtask soak [--hours H | --ticks N] [--seed S]: hours of the clock on all cores or a whole \
                     number of ticks, and the seed of the first shift, a whole number";

/// The options of the command.
#[derive(Debug, PartialEq, Eq)]
struct Wish {
    seed: Option<u64>,
    /// The length in the form that the soak program takes.
    length: String,
}

/// The command `cargo xtask soak [--hours H | --ticks N] [--seed S]`.
pub fn soak(arguments: &[&str]) -> Result<()> {
    let wish = read(arguments)?;
    let seed = match wish.seed {
        Some(seed) => seed,
        None => fresh()?,
    };
    let program = run::programs(&["--example", "soak"])?.join("examples/soak");
    let mut command = run::command(&run::root(), &program.to_string_lossy(), &[]);
    command.arg(seed.to_string()).arg(wish.length);
    run::show(command)
}

/// A seed that no earlier soak has had: the time in microseconds. A soak of some hours has fewer shifts than
/// microseconds, so the next soak begins after its seeds.
fn fresh() -> Result<u64> {
    let now = SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .context("the clock stands before 1970")?;
    Ok(u64::try_from(now.as_micros())?)
}

fn read(arguments: &[&str]) -> Result<Wish> {
    let (mut seed, mut length) = (None, None);
    let mut rest = arguments.iter();
    while let Some(name) = rest.next() {
        let value = rest.next().copied().unwrap_or_default();
        match *name {
            "--seed" if seed.is_none() => seed = Some(value.parse().context(USAGE)?),
            "--ticks" if length.is_none() => {
                let ticks: u64 = value.parse().context(USAGE)?;
                length = Some(ticks.to_string());
            }
            "--hours" if length.is_none() => {
                let hours: f64 = value.parse().context(USAGE)?;
                if !(hours.is_finite() && hours > 0.0) {
                    bail!("{USAGE}");
                }
                length = Some(format!("{hours}h"));
            }
            _ => bail!("{USAGE}"),
        }
    }
    Ok(Wish {
        seed,
        length: length.unwrap_or_else(|| TICKS.to_string()),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wish(seed: Option<u64>, length: &str) -> Wish {
        let length = length.into();
        Wish { seed, length }
    }

    #[test]
    fn hours_or_ticks_and_a_seed() {
        let of = |arguments: &[&str]| read(arguments).expect("a wish");
        assert_eq!(of(&[]), wish(None, "10000000"));
        assert_eq!(of(&["--seed", "5", "--ticks", "1"]), wish(Some(5), "1"));
        assert_eq!(of(&["--hours", "0.5"]), wish(None, "0.5h"));
        assert_eq!(of(&["--hours", "8", "--seed", "9"]), wish(Some(9), "8h"));
    }

    #[test]
    fn anything_else_is_refused() {
        let wrong: [&[&str]; 8] = [
            &["--hours"],
            &["--hours", "0"],
            &["--hours", "NaN"],
            &["--ticks", "-1"],
            &["--seed", "x"],
            &["--seed", "1", "--seed", "2"],
            &["--hours", "1", "--ticks", "1"],
            &["8"],
        ];
        for arguments in wrong {
            assert!(read(arguments).is_err(), "{arguments:?}");
        }
    }
}
