//! Speed, in figures that anyone can reproduce: instructions counted by callgrind, which noise cannot change, and in
//! addition the wall time.
//!
//! The instructions are the difference of two runs of different size, so that they exclude the start.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use anyhow::{Context, Result, anyhow, bail};

use crate::{emulator, run, setup};

/// `bench --write` renews the part of `docs/performance.md` between these lines.
const MARKS: (&str, &str) = ("<!-- measured: begin -->", "<!-- measured: end -->");

/// Measures everything. Prints it as Markdown or, with `write`, puts it into the document.
pub fn bench(write: bool) -> Result<()> {
    setup::everything()?;
    let root = run::root();
    let build = ["build", "--quiet", "--release", "--package"];
    run::show(run::cargo(
        &root,
        &[
            &build[..],
            &[
                "leadscrew-core",
                "--package",
                "leadscrew-tests",
                "--examples",
            ],
        ]
        .concat(),
    ))?;
    run::show(run::cargo(&root, &[&build[..], &["leadscrew"]].concat()))?;

    let mut text = conditions()?;
    text.push_str(&host()?);
    text.push_str(&works()?);
    tell(&text, MARKS, write)
}

/// Prints the result; with `write` it also replaces the part between the marks in docs/performance.md.
pub fn tell(text: &str, marks: (&str, &str), write: bool) -> Result<()> {
    println!("{text}");
    if write {
        let path = run::root().join("docs").join("performance.md");
        let document =
            fs::read_to_string(&path).with_context(|| format!("cannot read {}", path.display()))?;
        fs::write(&path, put_in(&document, text, marks)?)?;
        println!("written to {}", path.display());
    }
    Ok(())
}

/// The document with the part between the marks replaced.
fn put_in(document: &str, text: &str, (begin, end): (&str, &str)) -> Result<String> {
    let marks = || anyhow!("the document has no lines `{begin}` and `{end}`");
    let (before, rest) = document.split_once(begin).ok_or_else(marks)?;
    let (_, after) = rest.split_once(end).ok_or_else(marks)?;
    Ok(format!(
        "{before}{begin}\n\n{}\n\n{end}{after}",
        text.trim()
    ))
}

fn conditions() -> Result<String> {
    let cpu = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let cpu = cpu
        .lines()
        .find_map(|line| line.strip_prefix("model name")?.split_once(':'))
        .map_or("unknown", |(_, name)| name.trim());
    let compiler = run::read(run::command(&run::root(), "rustc", &["--version"]))?;
    let valgrind = run::read(run::command(&run::root(), "valgrind", &["--version"]))?;
    let emulator = run::read(run::command(
        &run::root(),
        "qemu-system-arm",
        &["--version"],
    ))?;
    let emulator = emulator.lines().next().unwrap_or("unknown");
    Ok(format!(
        "Host: {cpu}, {}, profile `release`, one thread; instructions by {}. Board: {emulator}, machine mps2-an386, \
         `-icount shift=0`, the profile that is flashed.\n\n",
        compiler.trim(),
        valgrind.trim()
    ))
}

/// One line of the host's table.
struct Row {
    what: &'static str,
    instructions: String,
    wall: String,
    aim: &'static str,
}

fn host() -> Result<String> {
    let mut text =
        String::from("| on the host | instructions | wall time | aim |\n|---|---|---|---|\n");
    for row in [parse()?, expand()?, file_to_json()?] {
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} |",
            row.what, row.instructions, row.wall, row.aim
        );
    }
    text.push('\n');
    Ok(text)
}

/// From text to calls: the example's program, read once and read three times.
fn parse() -> Result<Row> {
    let program = example("parse");
    let lines = 20_000;
    let size = lines.to_string();
    let once = instructions(&program, &[&size, "1"])?;
    let thrice = instructions(&program, &[&size, "3"])?;
    let each = thrice.saturating_sub(once) / (2 * lines);
    let mut rate = 0;
    for _ in 0..5 {
        let printed = run::read(run::command(
            &run::root(),
            &program.to_string_lossy(),
            &["400000", "5"],
        ))?;
        rate = rate.max(number_before(&printed, "MB/s")?);
    }
    Ok(Row {
        what: "parse: program text to calls",
        instructions: format!("{each} a line"),
        wall: format!("{rate} MB/s"),
        aim: "≤ 1 500 a line, ≥ 120 MB/s",
    })
}

/// From calls to moves: G76 cycles of 56 passes.
fn expand() -> Result<Row> {
    let program = example("expand");
    let moves = |cycles: &str| -> Result<u64> {
        let printed = run::read(run::command(
            &run::root(),
            &program.to_string_lossy(),
            &[cycles],
        ))?;
        number_before(&printed, "moves")
    };
    let few = instructions(&program, &["1000"])?;
    let many = instructions(&program, &["2000"])?;
    let difference = moves("2000")?.saturating_sub(moves("1000")?);
    let each = tenths(many.saturating_sub(few), difference);
    let cycles = "200000";
    let count = moves(cycles)?;
    let took = fastest(|| {
        run::read(run::command(
            &run::root(),
            &program.to_string_lossy(),
            &[cycles],
        ))
        .map(drop)
    })?;
    Ok(Row {
        what: "expand: G76 of 56 passes to moves",
        instructions: format!("{each} a move"),
        wall: format!("{} ns a move", tenths(nanoseconds(took), count)),
        aim: "≤ 60 a move",
    })
}

/// The whole path on the host: from a file with 1 000 G76 cycles of 56 passes to JSON lines.
fn file_to_json() -> Result<Row> {
    let dir = run::scratch("bench")?;
    let program = |name: &str, cycles: usize| -> Result<String> {
        let path = dir.join(name);
        let mut text = String::from("O1000\nG0 X80 Z10 M3 S300\n");
        for _ in 0..cycles {
            text.push_str("G76 P010560 Q10 R0.01\nG76 X60.64 Z-62 P3680 Q495 F6\n");
        }
        text.push_str("M30\n");
        fs::write(&path, text)?;
        Ok(path.to_string_lossy().into_owned())
    };
    let (few, many) = (program("500.nc", 500)?, program("1000.nc", 1000)?);
    let leadscrew = run::root().join("target").join("release").join("leadscrew");
    let out = dir.join("moves.jsonl");
    let to_file = |program: &str| -> Result<()> {
        let mut command = run::command(
            &dir,
            &leadscrew.to_string_lossy(),
            &["expand", "--format", "jsonl", program],
        );
        command.stdout(fs::File::create(&out)?);
        run::show(command)
    };
    let took = fastest(|| to_file(&many))?;
    let written = fs::read_to_string(&out)?;
    let moves = written.lines().count() as u64;
    if moves < 280_000 {
        bail!("1 000 cycles of 56 passes gave {moves} lines");
    }
    let args = |program| ["expand", "--format", "jsonl", program];
    let difference = instructions(&leadscrew, &args(&many))?
        .saturating_sub(instructions(&leadscrew, &args(&few))?);
    Ok(Row {
        what: "file to JSON lines: 1 000 G76 of 56 passes",
        instructions: format!("{} a move", difference * 2 / moves),
        wall: format!(
            "{:.2} s, {} MB",
            took.as_secs_f64(),
            written.len() / 1_000_000
        ),
        aim: "≤ 0.2 s",
    })
}

/// The works of `firmware/audit`, on the board and on the host.
fn works() -> Result<String> {
    let mut text =
        String::from("| | Cortex-M4F, mean | worst | x86-64, mean |\n|---|---:|---:|---:|\n");
    let program = example("tick");
    let path = program.to_string_lossy();
    let list = run::read(run::command(&run::root(), &path, &[]))?;
    let mut memory = String::from("| bytes on the Cortex-M4F | |\n|---|---:|\n");
    for row in emulator::measure()? {
        if row.name.starts_with("bytes/") || row.name.starts_with("stack/") {
            let _ = writeln!(memory, "| {} | {} |", row.name, row.worst);
            continue;
        }
        let of = |line: &&str| line.replace(' ', "") == row.name;
        let host = match list.lines().find(of).and_then(|line| line.split_once(' ')) {
            Some((name, kind)) => {
                let args: Vec<&str> = [name, kind]
                    .into_iter()
                    .filter(|arg| !arg.is_empty())
                    .collect();
                let steps = number_before(
                    &run::read(run::command(&run::root(), &path, &args))?,
                    "steps",
                )?;
                let all = callgrind(&program, &args, &["--toggle-collect=*counted_step*"])?;
                all.checked_div(steps).unwrap_or(0).to_string()
            }
            None => "–".into(),
        };
        let _ = writeln!(
            text,
            "| {} | {} | {} | {host} |",
            row.name, row.mean, row.worst
        );
    }
    text.push('\n');
    text.push_str(&memory);
    Ok(text)
}

fn example(name: &str) -> PathBuf {
    run::root()
        .join("target")
        .join("release")
        .join("examples")
        .join(name)
}

/// Instructions of a whole run.
fn instructions(program: &Path, args: &[&str]) -> Result<u64> {
    callgrind(program, args, &[])
}

/// Instructions that callgrind counts with these options.
fn callgrind(program: &Path, args: &[&str], options: &[&str]) -> Result<u64> {
    let dir = run::scratch("bench")?;
    let log = dir.join("callgrind.log");
    let mut command = run::command(
        &dir,
        "valgrind",
        &["--tool=callgrind", "--callgrind-out-file=callgrind.out"],
    );
    command
        .arg(format!("--log-file={}", log.display()))
        .args(options)
        .arg(program)
        .args(args);
    run::read(command)?;
    collected(&fs::read_to_string(&log)?)
}

/// The number of instructions in callgrind's log.
pub fn collected(log: &str) -> Result<u64> {
    log.lines()
        .find_map(|line| line.split_once("Collected :")?.1.trim().parse().ok())
        .ok_or_else(|| anyhow!("callgrind counted nothing:\n{log}"))
}

/// The shortest of five runs: a disturbance makes a run slower, never faster.
fn fastest(mut what: impl FnMut() -> Result<()>) -> Result<Duration> {
    let mut least = Duration::MAX;
    for _ in 0..5 {
        let started = Instant::now();
        what()?;
        least = least.min(started.elapsed());
    }
    Ok(least)
}

fn nanoseconds(duration: Duration) -> u64 {
    u64::try_from(duration.as_nanos()).unwrap_or(u64::MAX)
}

/// The quotient with one decimal.
pub fn tenths(sum: u64, count: u64) -> String {
    let tenths = sum.saturating_mul(10).checked_div(count).unwrap_or(0);
    format!("{}.{}", tenths / 10, tenths % 10)
}

/// The number before `word`.
fn number_before(text: &str, word: &str) -> Result<u64> {
    let words: Vec<&str> = text.split_whitespace().collect();
    words
        .windows(2)
        .find_map(|pair| match pair {
            [number, next] if *next == word => number.parse().ok(),
            _ => None,
        })
        .ok_or_else(|| anyhow!("no number of {word} in: {text}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_marked_part_is_replaced_and_the_rest_stays() {
        let (begin, end) = MARKS;
        let document = format!("a\n{begin}\nold\n{end}\nb\n");
        let new = put_in(&document, "| new |\n", MARKS).unwrap();
        assert_eq!(new, format!("a\n{begin}\n\n| new |\n\n{end}\nb\n"));
        assert_eq!(put_in(&new, "| new |", MARKS).unwrap(), new);
        assert!(put_in("nothing here", "x", MARKS).is_err());
    }

    #[test]
    fn numbers_are_read_and_divided() {
        assert_eq!(
            number_before("1000 cycles, 280000 moves", "moves").unwrap(),
            280_000
        );
        assert!(number_before("moves", "moves").is_err());
        assert_eq!(tenths(605, 10), "60.5");
    }
}
