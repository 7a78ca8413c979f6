//! Instructions per tick on the emulated Cortex-M4F, compared with the table under version control.

use std::fmt::Write as _;

use anyhow::{Context, Result, anyhow, bail};

use crate::{audit, run, target};

/// The most instructions of a whole tick: X, Z, C and a spindle in any motion, and between two motions.
const TICK_LIMIT: u64 = 2500;
/// Rows whose name begins like this count whole ticks of the board.
const WHOLE_TICK: &str = "board/";
/// The rows with a higher limit: three more spindles are three more drives, a joined cut rounds two axes besides, and
/// taking off the lag of drives is one more step for two axes.
const DEARER: [&str; 5] = [
    "board/seven-drives",
    "board/lags",
    "board/lags-forward",
    "board/joined-line",
    "board/joined-arc",
];
/// Their limit.
const DEARER_LIMIT: u64 = 2650;
/// Rows where the angle of an encoder of few counts is learned: two swings and what goes after the angle.
const LEARNED: &str = "board/learned";
/// Their limit. Such an encoder has no faster ticks than others, and a tick of 250 µs has twelve times as many.
const LEARNED_LIMIT: u64 = 3950;
/// A row may grow by this much, in percent, before the table has to be renewed on purpose.
const GROWTH_PERCENT: u64 = 5;
/// A loop of known length. It shows that the emulated clock counts instructions.
const KNOWN_LOOP: &str = "known-loop-2000";

/// Instructions of one kind of step.
#[derive(Debug, PartialEq, Eq)]
pub struct Row {
    /// The name of the step.
    pub name: String,
    /// Mean over the run.
    pub mean: u64,
    /// The most expensive step of the run.
    pub worst: u64,
}

/// Measures. Compares with the table or, with `write`, renews it.
pub fn ticks(write: bool) -> Result<()> {
    let rows = measure()?;
    print!("{}", table(&rows));
    let dear = too_dear(&rows);
    if !dear.is_empty() {
        bail!("{}", dear.join("\n"));
    }
    let path = run::firmware().join("audit").join("ticks.txt");
    if write {
        std::fs::write(&path, table(&rows))?;
        println!("written to {}", path.display());
    } else {
        let text = std::fs::read_to_string(&path).context("there is no table to compare with")?;
        let complaints = compare(&parse(&text)?, &rows);
        if !complaints.is_empty() {
            bail!(
                "{}\nwhere that is meant, renew firmware/audit/ticks.txt with `cargo xtask ticks --write`",
                complaints.join("\n")
            );
        }
    }
    Ok(())
}

/// Builds the image and runs it in the emulator.
pub fn measure() -> Result<Vec<Row>> {
    // An instruction takes one nanosecond of virtual time.
    let rows = parse(&emulate("audit", "ticks", &["-icount", "shift=0"])?)?;
    let known = rows
        .iter()
        .find(|row| row.name == KNOWN_LOOP)
        .ok_or_else(|| anyhow!("no row {KNOWN_LOOP}"))?;
    if known.mean.abs_diff(2000) > 20 {
        bail!(
            "a loop of 2000 instructions counts {}: the emulated clock does not count instructions",
            known.mean
        );
    }
    let (flash, ram) = audit::of_board()?;
    let of_image = |name: &str, bytes| Row {
        name: format!("bytes/{name}"),
        mean: bytes,
        worst: bytes,
    };
    let sizes = [of_image("image-flash", flash), of_image("image-ram", ram)];
    Ok(rows.into_iter().chain(sizes).collect())
}

/// The emulator of the board's processor.
pub const EMULATOR: &str = "qemu-system-arm";

/// The options of every run: the place of the serial line, and what the image may ask of the host.
pub const fn machine<'a>(serial: &'a str, semihosting: &'a str) -> [&'a str; 9] {
    [
        "-M",
        "mps2-an386",
        "-nographic",
        "-monitor",
        "none",
        "-serial",
        serial,
        "-semihosting-config",
        semihosting,
    ]
}

/// Builds an image, runs it in the emulator, and gives its output.
pub fn emulate(package: &str, image: &str, options: &[&str]) -> Result<String> {
    emulate_with(package, image, options, &[])
}

/// As [`emulate`], with these words in the image's command line.
pub fn emulate_with(
    package: &str,
    image: &str,
    options: &[&str],
    words: &[&str],
) -> Result<String> {
    let firmware = run::firmware();
    let path = target::build(package, image, &[])?;
    let path = path.to_string_lossy();
    let mut semihosting = format!("enable=on,target=native,arg={image}");
    for word in words {
        semihosting.push_str(",arg=");
        semihosting.push_str(word);
    }
    // The time limit is for an image that hangs.
    let mut args = vec!["3000", EMULATOR];
    args.extend(machine("none", &semihosting));
    args.extend_from_slice(options);
    args.extend_from_slice(&["-kernel", &path]);
    run::read(run::command(&firmware, "timeout", &args))
}

fn parse(text: &str) -> Result<Vec<Row>> {
    text.lines()
        .filter(|line| !line.is_empty() && !line.starts_with('#'))
        .map(|line| {
            let mut words = line.split_whitespace();
            match (
                words.next(),
                words.next().map(str::parse),
                words.next().map(str::parse),
                words.next(),
            ) {
                (Some(name), Some(Ok(mean)), Some(Ok(worst)), None) => Ok(Row {
                    name: name.into(),
                    mean,
                    worst,
                }),
                _ => bail!("not a row of `name mean worst`: {line}"),
            }
        })
        .collect()
}

fn table(rows: &[Row]) -> String {
    let mut text = String::from(
        "# Instructions a step on a Cortex-M4F: mps2-an386 in QEMU, -icount shift=0, in the profile that is flashed.\n\
         # bytes/…: a part of the board in memory; stack/…: its stack at the deepest, in bytes.\n",
    );
    // Writing to a string cannot fail.
    let _ = writeln!(text, "# {:<30} {:>7} {:>7}", "step", "mean", "worst");
    for row in rows {
        let _ = writeln!(text, "{:<32} {:>7} {:>7}", row.name, row.mean, row.worst);
    }
    text
}

/// Complaints about whole ticks above the limit.
fn too_dear(rows: &[Row]) -> Vec<String> {
    rows.iter()
        .filter(|row| row.name.starts_with(WHOLE_TICK))
        .map(|row| {
            let limit = if row.name.starts_with(LEARNED) {
                LEARNED_LIMIT
            } else if DEARER.contains(&row.name.as_str()) {
                DEARER_LIMIT
            } else {
                TICK_LIMIT
            };
            (row, limit)
        })
        .filter(|(row, limit)| row.worst > *limit)
        .map(|(row, limit)| {
            format!(
                "{}: worst {} instructions; this tick may cost {limit}",
                row.name, row.worst
            )
        })
        .collect()
}

fn compare(table: &[Row], now: &[Row]) -> Vec<String> {
    let mut complaints = Vec::new();
    for row in now {
        if row.worst == 0 {
            complaints.push(format!("{}: no such step in the run", row.name));
        }
        match table.iter().find(|old| old.name == row.name) {
            None => complaints.push(format!("{}: not in the table", row.name)),
            Some(old) if row.worst * 100 > old.worst * (100 + GROWTH_PERCENT) => complaints.push(format!(
                "{}: worst {} instructions, more than {GROWTH_PERCENT} % above the {} of the table",
                row.name, row.worst, old.worst
            )),
            Some(_) => {}
        }
    }
    for old in table
        .iter()
        .filter(|old| !now.iter().any(|row| row.name == old.name))
    {
        complaints.push(format!("{}: in the table and no longer measured", old.name));
    }
    complaints
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(name: &str, worst: u64) -> Row {
        Row {
            name: name.into(),
            mean: 1,
            worst,
        }
    }

    #[test]
    fn a_table_reads_back() {
        let rows = [row("line", 300), row("board/idle", 12)];
        assert_eq!(parse(&table(&rows)).unwrap(), rows);
        assert!(parse("line 1\n").is_err());
        assert!(parse("panicked at 3 5 7\n").is_err());
    }

    #[test]
    fn whole_ticks_have_a_limit() {
        let rows = [
            row("board/line", TICK_LIMIT),
            row("board/arc", TICK_LIMIT + 1),
            row("board/seven-drives", DEARER_LIMIT),
            row("board/seven-drives", DEARER_LIMIT + 1),
            row("plan/line", 30_000),
        ];
        let dear = too_dear(&rows);
        assert_eq!(dear.len(), 2, "{dear:?}");
        let worst = |name: &str, limit: u64| format!("{name}: worst {} ", limit + 1);
        assert!(dear[0].starts_with(&worst("board/arc", TICK_LIMIT)));
        assert!(dear[1].starts_with(&worst("board/seven-drives", DEARER_LIMIT)));
    }

    #[test]
    fn growth_and_empty_and_missing_rows_are_found() {
        let table = [row("line", 100), row("board/arc", 1990), row("gone", 5)];
        let now = [row("line", 106), row("board/arc", 0), row("new", 1)];
        let complaints = compare(&table, &now);
        assert_eq!(complaints.len(), 4, "{complaints:?}");
        assert!(
            compare(
                &table,
                &[row("line", 105), row("board/arc", 2000), row("gone", 1)]
            )
            .is_empty()
        );
    }
}
