//! Flash and RAM of the board's images, held against the table under version control.

use std::fmt::Write as _;
use std::path::Path;

use anyhow::{Context, Result, anyhow, bail};
use object::{Object, ObjectSection, ObjectSymbol, SectionFlags};

use crate::{emulator, run, target};

/// What an image may take of the flash, in bytes.
const FLASH_LIMIT: u64 = 128 * 1024;
/// What an image may take of the RAM, its stack included, in bytes.
const RAM_LIMIT: u64 = 48 * 1024;
/// A figure may grow by this much, in percent, before the table has to be renewed on purpose.
const GROWTH_PERCENT: u64 = 5;
/// Stack that the two interrupts need on top of the background's, beside what the tick itself is measured with: what the
/// processor stores of the background and of the interrupt of the bus (with floating-point registers), and what that uses.
const INTERRUPTS: u64 = 2 * 104 + 256;

/// An image: its name here, its package, and its features.
const IMAGES: [(&str, &str, &str); 2] = [
    ("nucleo-g474re", "nucleo-g474re", ""),
    ("nucleo-g474re+defmt", "nucleo-g474re", "defmt"),
];

/// What an image takes, in bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Row {
    name: String,
    /// Code, constants, and the initial values of variables.
    flash: u64,
    /// Variables.
    ram: u64,
    /// What is kept free for the stack.
    stack: u64,
}

impl Row {
    const fn whole_ram(&self) -> u64 {
        self.ram + self.stack
    }
}

/// Builds and measures the images, and compares with the table or (`write`) renews it.
pub fn sizes(write: bool) -> Result<()> {
    let mut rows = Vec::new();
    for (name, package, features) in IMAGES {
        rows.push(measure(name, package, features)?);
    }
    print!("{}", table(&rows));
    let path = run::firmware().join("audit").join("sizes.txt");
    let old = std::fs::read_to_string(&path).unwrap_or_default();
    let old = parse(&old)?;
    let mut complaints = too_large(&old, &rows);
    complaints.extend(too_deep(&rows, emulator::deepest_stack()?));
    if write {
        std::fs::write(&path, table(&rows))?;
        println!("{}\nwritten to {}", complaints.join("\n"), path.display());
        return Ok(());
    }
    complaints.extend(compare(&old, &rows));
    if !complaints.is_empty() {
        bail!(
            "{}\nwhere that is meant, renew firmware/audit/sizes.txt with `cargo xtask sizes --write`",
            complaints.join("\n")
        );
    }
    Ok(())
}

fn measure(name: &str, package: &str, features: &str) -> Result<Row> {
    let firmware = run::firmware();
    let mut build = vec!["build", "--quiet", "--release"];
    if !features.is_empty() {
        build.extend(["--features", features]);
    }
    // In its own folder: the settings there are the ones it is flashed with.
    run::show(run::cargo(&firmware.join(package), &build))?;
    let path = firmware
        .join("target")
        .join(target::TARGET)
        .join("release")
        .join(package);
    size(name, &path)
}

fn size(name: &str, path: &Path) -> Result<Row> {
    let data = std::fs::read(path).with_context(|| format!("there is no {}", path.display()))?;
    let file = object::File::parse(data.as_slice())?;
    let (mut flash, mut ram) = (0, 0);
    for section in file.sections() {
        let SectionFlags::Elf { sh_flags, .. } = section.flags() else {
            continue;
        };
        if sh_flags.0 & object::elf::SHF_ALLOC.0 == 0 {
            continue;
        }
        let is_variable = sh_flags.0 & object::elf::SHF_WRITE.0 != 0;
        if is_variable {
            ram += section.size();
        }
        // Initial values lie in the flash too.
        if !is_variable || section.name() == Ok(".data") {
            flash += section.size();
        }
    }
    let symbol = |wanted: &str| {
        file.symbols()
            .find(|symbol| symbol.name() == Ok(wanted))
            .map(|symbol| symbol.address())
            .ok_or_else(|| anyhow!("{name}: no symbol {wanted}"))
    };
    let stack = symbol("_stack_start")?.saturating_sub(symbol("_stack_end")?);
    Ok(Row {
        name: name.into(),
        flash,
        ram,
        stack,
    })
}

/// Images above a limit that they have kept before, or that are new. One that the table has above it is printed plainly.
fn too_large(table: &[Row], now: &[Row]) -> Vec<String> {
    let mut complaints = Vec::new();
    for row in now {
        let old = table.iter().find(|old| old.name == row.name);
        let limits = [
            ("flash", row.flash, old.map(|old| old.flash), FLASH_LIMIT),
            (
                "RAM with stack",
                row.whole_ram(),
                old.map(Row::whole_ram),
                RAM_LIMIT,
            ),
        ];
        for (what, bytes, before, limit) in limits {
            if bytes <= limit {
                continue;
            }
            let line = format!("{}: {bytes} bytes of {what}, the aim is {limit}", row.name);
            if before.is_some_and(|before| before > limit) {
                println!("{line}: not reached yet");
            } else {
                complaints.push(line);
            }
        }
    }
    complaints
}

/// Images whose stack has no room for what was measured: (background, tick).
fn too_deep(now: &[Row], (background, tick): (u64, u64)) -> Vec<String> {
    let needed = background + tick + INTERRUPTS;
    now.iter()
        .filter(|row| row.stack < needed)
        .map(|row| {
            format!(
                "{}: {} bytes of stack, and {needed} may be needed ({background} background, {tick} tick, {INTERRUPTS} interrupts)",
                row.name, row.stack
            )
        })
        .collect()
}

fn compare(table: &[Row], now: &[Row]) -> Vec<String> {
    let mut complaints = Vec::new();
    for row in now {
        let Some(old) = table.iter().find(|old| old.name == row.name) else {
            complaints.push(format!("{}: not in the table", row.name));
            continue;
        };
        let figures = [
            ("flash", old.flash, row.flash),
            ("RAM", old.ram, row.ram),
            ("stack", old.stack, row.stack),
        ];
        for (what, old, new) in figures {
            if new * 100 > old * (100 + GROWTH_PERCENT) {
                complaints.push(format!(
                    "{}: {new} bytes of {what}, more than {GROWTH_PERCENT} % above the {old} of the table",
                    row.name
                ));
            }
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

fn table(rows: &[Row]) -> String {
    let mut text = String::from(
        "# Bytes of the images: fat LTO, profile release. RAM is variables; stack is what is kept free for it.\n",
    );
    // Writing to a string cannot fail.
    let _ = writeln!(
        text,
        "# {:<30} {:>7} {:>7} {:>7} {:>9}",
        "image", "flash", "RAM", "stack", "RAM+stack"
    );
    for row in rows {
        let _ = writeln!(
            text,
            "{:<32} {:>7} {:>7} {:>7} {:>9}",
            row.name,
            row.flash,
            row.ram,
            row.stack,
            row.whole_ram()
        );
    }
    text
}

fn parse(text: &str) -> Result<Vec<Row>> {
    text.lines()
        .filter(|line| !line.is_empty() && !line.starts_with('#'))
        .map(|line| {
            let words: Vec<&str> = line.split_whitespace().collect();
            let [name, flash, ram, stack, _] = words.as_slice() else {
                bail!("not a row of `image flash RAM stack RAM+stack`: {line}");
            };
            Ok(Row {
                name: (*name).into(),
                flash: flash.parse()?,
                ram: ram.parse()?,
                stack: stack.parse()?,
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(name: &str, flash: u64, ram: u64, stack: u64) -> Row {
        Row {
            name: name.into(),
            flash,
            ram,
            stack,
        }
    }

    #[test]
    fn a_table_reads_back() {
        let rows = [row("a", 1000, 200, 30), row("b+defmt", 1, 2, 3)];
        assert_eq!(parse(&table(&rows)).unwrap(), rows);
        assert!(parse("a 1 2 3\n").is_err());
        assert!(parse("a 1 2 x 3\n").is_err());
    }

    #[test]
    fn growth_and_missing_rows_are_found() {
        let table = [row("a", 1000, 1000, 1000), row("gone", 1, 1, 1)];
        assert_eq!(compare(&table, &[row("a", 1051, 1000, 1000)]).len(), 2);
        let now = [row("a", 1050, 900, 1050), row("gone", 1, 1, 1)];
        assert!(compare(&table, &now).is_empty());
        assert_eq!(compare(&table, &[row("new", 1, 1, 1)]).len(), 3);
    }

    #[test]
    fn a_limit_that_was_kept_is_kept() {
        let below = [row("a", FLASH_LIMIT, RAM_LIMIT - 100, 100)];
        assert!(too_large(&[], &below).is_empty());
        let above = [row("a", FLASH_LIMIT + 1, RAM_LIMIT - 100, 101)];
        assert_eq!(too_large(&below, &above).len(), 2);
        assert_eq!(too_large(&[], &above).len(), 2);
        // Known to be above: growth is what is watched then.
        assert!(too_large(&above, &above).is_empty());
    }

    #[test]
    fn the_measured_stack_has_to_fit() {
        let rows = [row("a", 1, 1, 3000 + INTERRUPTS)];
        assert!(too_deep(&rows, (2000, 1000)).is_empty());
        assert_eq!(too_deep(&rows, (2000, 1001)).len(), 1);
    }
}
