//! Flash and RAM of the board's images, compared with the table under version control.

use std::fmt::Write as _;
use std::path::Path;

use anyhow::{Context, Result, anyhow, bail};
use object::{Object, ObjectSection, ObjectSymbol, SectionFlags};

use crate::stack::{self, Users};
use crate::{run, target};

/// The most that an image may take of the first bank of the flash, in bytes, of 256 KiB; a few bytes more or less from one
/// computer to another do not decide. The linker's script has the limit of the second bank.
const FLASH_LIMIT: u64 = 240 * 1024;
/// The most of the second bank, as in `memory.x`, whose linker keeps to it: the rest is the storage's.
const SECOND_LIMIT: u64 = 128 * 1024;
/// Where the second bank of the chip's flash begins.
const SECOND_BANK: u64 = 0x0804_0000;
/// What must not use code of the second bank, beside interrupts: it waits while that bank changes.
const CHANGES: [&str; 2] = [
    "<nucleo_g474re::flash::Bank as leadscrew_parts::flash::WordDevice>::write",
    "<nucleo_g474re::flash::Bank as leadscrew_parts::flash::WordDevice>::erase",
];
/// The most RAM that an image may take, its stack included, in bytes, of the chip's 128 KiB.
const RAM_LIMIT: u64 = 108 * 1024;
/// A figure may grow by this much, in percent, before the table has to be renewed on purpose.
const GROWTH_PERCENT: u64 = 5;
/// The users of the stack of the NUCLEO-G474RE's image: the start, while interrupts are masked, and after it the rest
/// of the thread with the interrupts on top.
const USERS: Users = Users {
    thread: "main",
    start: "nucleo_g474re::start",
    interrupts: &["FDCAN1_IT0", "TIM6_DAC"],
    always: &["NonMaskableInt"],
    ends: &["Reset", "HardFault", "DefaultHandler_"],
};

/// An image.
struct Image {
    /// The image's name in the table.
    name: &'static str,
    package: &'static str,
    program: &'static str,
    features: &'static str,
    /// For an image of a chip: its users of the stack. The limits hold, and the free stack must have room for the
    /// deepest use.
    chip: Option<Users>,
}

const IMAGES: [Image; 4] = [
    Image {
        name: "nucleo-g474re",
        package: "nucleo-g474re",
        program: "nucleo-g474re",
        features: "",
        chip: Some(USERS),
    },
    Image {
        name: "nucleo-g474re+defmt",
        package: "nucleo-g474re",
        program: "nucleo-g474re",
        features: "defmt",
        chip: Some(USERS),
    },
    // These images contain the plant.
    Image {
        name: "mps2-bus",
        package: "mps2-an386",
        program: "mps2-bus",
        features: "",
        chip: None,
    },
    Image {
        name: "mps2-bus+defmt",
        package: "mps2-an386",
        program: "mps2-bus",
        features: "defmt",
        chip: None,
    },
];

/// The bytes that an image takes.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Row {
    name: String,
    /// Code, constants, and the initial values of variables; of a chip's image what lies in the first bank.
    flash: u64,
    /// Code in the second bank.
    second: u64,
    /// Variables.
    ram: u64,
    /// The memory kept free for the stack.
    stack: u64,
    /// The deepest possible use of the stack, for an image of a chip.
    deepest: Option<u64>,
}

impl Row {
    const fn whole_ram(&self) -> u64 {
        self.ram + self.stack
    }
}

/// The README tells what the larger of the flashed images takes, by the table, in whole KiB.
fn untold(table: &[Row], readme: &str) -> Option<String> {
    let Some(row) = table.iter().find(|row| row.name == IMAGES[1].name) else {
        return Some("the table has no row of the image that the README tells of".into());
    };
    let kib = |bytes: u64| bytes.div_ceil(1024);
    let said = format!(
        "takes {} of the {} KiB that it may take of the first bank of the flash, {} of {} KiB of the second, and {} of {} KiB of RAM",
        kib(row.flash),
        kib(FLASH_LIMIT),
        kib(row.second),
        kib(SECOND_LIMIT),
        kib(row.whole_ram()),
        kib(RAM_LIMIT)
    );
    let words: Vec<_> = readme.split_whitespace().collect();
    (!words.join(" ").contains(&said)).then(|| format!("README.md has to say by hand: {said}"))
}

/// Builds and measures the images. Compares with the table or, with `write`, renews it.
pub fn sizes(write: bool) -> Result<()> {
    let mut rows = Vec::new();
    for image in &IMAGES {
        rows.push(measure(image)?);
    }
    print!("{}", table(&rows));
    let path = run::firmware().join("audit").join("sizes.txt");
    let readme = std::fs::read_to_string(run::root().join("README.md"))?;
    let mut complaints = too_large(&rows);
    complaints.extend(too_deep(&rows));
    if write {
        std::fs::write(&path, table(&rows))?;
        complaints.extend(untold(&rows, &readme));
        println!("{}\nwritten to {}", complaints.join("\n"), path.display());
        return Ok(());
    }
    let old = parse(&std::fs::read_to_string(&path).unwrap_or_default())?;
    complaints.extend(compare(&old, &rows));
    complaints.extend(untold(&old, &readme));
    if !complaints.is_empty() {
        bail!(
            "{}\nwhere that is meant, renew firmware/audit/sizes.txt with `cargo xtask sizes --write`",
            complaints.join("\n")
        );
    }
    Ok(())
}

fn measure(image: &Image) -> Result<Row> {
    let features: &[&str] = match image.features {
        "" => &[],
        features => &["--features", features],
    };
    let path = target::build(image.package, image.program, features)?;
    size(image, &path)
}

fn size(image: &Image, path: &Path) -> Result<Row> {
    let name = image.name;
    let data = std::fs::read(path).with_context(|| format!("there is no {}", path.display()))?;
    let file = object::File::parse(data.as_slice())?;
    let (mut flash, mut second, mut ram) = (0, 0, 0);
    let mut folders = Vec::new();
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
        // The initial values of variables are in the flash too.
        if !is_variable || section.name() == Ok(".data") {
            if image.chip.is_some() && section.address() >= SECOND_BANK && !is_variable {
                second += section.size();
            } else {
                flash += section.size();
            }
            folders.extend(folders_in(section.data()?));
        }
    }
    if image.chip.is_some() && !folders.is_empty() {
        bail!(
            "{name}: the image holds paths of source files ({}), so that its size depends on the folder it was built in",
            folders.join(", ")
        );
    }
    let symbol = |wanted: &str| {
        file.symbols()
            .find(|symbol| symbol.name() == Ok(wanted))
            .map(|symbol| symbol.address())
            .ok_or_else(|| anyhow!("{name}: no symbol {wanted}"))
    };
    let stack = symbol("_stack_start")?.saturating_sub(symbol("_stack_end")?);
    let deepest = image.chip.as_ref().map(|users| deepest(name, path, users));
    if let Some(users) = &image.chip {
        keep_to_the_first_bank(path, users)?;
    }
    Ok(Row {
        name: name.into(),
        flash,
        second,
        ram,
        stack,
        deepest: deepest.transpose()?,
    })
}

/// Complains about interrupts, and about what changes the flash, where they may use code of the second bank.
fn keep_to_the_first_bank(path: &Path, users: &Users) -> Result<()> {
    let from = [users.interrupts, users.always, &CHANGES].concat();
    let ways = stack::ways_into(path, SECOND_BANK, &from)?;
    if ways.is_empty() {
        return Ok(());
    }
    let ways: Vec<String> = ways.iter().map(|way| way.join("\n    ")).collect();
    bail!(
        "code of the second bank of the flash may be wanted while that bank changes:\n{}",
        ways.join("\n")
    )
}

/// Texts in the flash that name a source file by its folder: the places of panics, where a handler prints them.
fn folders_in(bytes: &[u8]) -> Vec<String> {
    const SOURCE: &[u8] = b".rs";
    let is_path = |byte: &u8| byte.is_ascii_alphanumeric() || b"/._-\\:".contains(byte);
    bytes
        .split(|byte| !is_path(byte))
        .filter(|text| {
            text.windows(SOURCE.len()).any(|three| three == SOURCE)
                && text.iter().any(|byte| b"/\\".contains(byte))
        })
        .map(|text| String::from_utf8_lossy(text).into_owned())
        .collect()
}

fn deepest(name: &str, path: &Path, users: &Users) -> Result<u64> {
    let (deepest, parts) = stack::deepest(path, users)?;
    println!("{name}: the deepest ways of the stack");
    for part in parts {
        for (function, bytes) in part.way {
            println!("  {bytes:>6} {function}");
        }
        println!("  {:>6} in all", part.bytes);
    }
    Ok(deepest)
}

/// Complaints about images of a chip that are above a limit.
fn too_large(now: &[Row]) -> Vec<String> {
    now.iter()
        .filter(|row| row.deepest.is_some())
        .flat_map(|row| {
            [
                ("flash", row.flash, FLASH_LIMIT),
                ("RAM with stack", row.whole_ram(), RAM_LIMIT),
            ]
            .into_iter()
            .filter(|(_, bytes, limit)| bytes > limit)
            .map(|(what, bytes, limit)| {
                format!("{}: {bytes} bytes of {what}, at most {limit}", row.name)
            })
        })
        .collect()
}

/// Complaints about images whose stack may get deeper than the memory kept free for it.
fn too_deep(now: &[Row]) -> Vec<String> {
    now.iter()
        .filter_map(|row| {
            let deepest = row.deepest.filter(|deepest| row.stack < *deepest)?;
            Some(format!(
                "{}: {} bytes of stack, and {deepest} may be needed",
                row.name, row.stack
            ))
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
            ("the second bank", old.second, row.second),
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
        "# Bytes of the images, in the profile that is flashed: flash is the first bank of a chip. RAM is variables; stack is what is kept free for it, deepest what of that\n\
         # can ever be used, by the calls in the image. What is not for a chip (-) has the plant in it, and no limits.\n",
    );
    // Writing to a string cannot fail.
    let _ = writeln!(
        text,
        "# {:<30} {:>7} {:>7} {:>7} {:>7} {:>9} {:>7}",
        "image", "flash", "bank2", "RAM", "stack", "RAM+stack", "deepest"
    );
    for row in rows {
        let _ = writeln!(
            text,
            "{:<32} {:>7} {:>7} {:>7} {:>7} {:>9} {:>7}",
            row.name,
            row.flash,
            row.second,
            row.ram,
            row.stack,
            row.whole_ram(),
            row.deepest
                .map_or_else(|| "-".to_owned(), |deepest| deepest.to_string())
        );
    }
    text
}

fn parse(text: &str) -> Result<Vec<Row>> {
    text.lines()
        .filter(|line| !line.is_empty() && !line.starts_with('#'))
        .map(|line| {
            let words: Vec<&str> = line.split_whitespace().collect();
            let [name, flash, second, ram, stack, _, deepest] = words.as_slice() else {
                bail!("not a row of `image flash bank2 RAM stack RAM+stack deepest`: {line}");
            };
            Ok(Row {
                name: (*name).into(),
                flash: flash.parse()?,
                second: second.parse()?,
                ram: ram.parse()?,
                stack: stack.parse()?,
                deepest: match *deepest {
                    "-" => None,
                    bytes => Some(bytes.parse()?),
                },
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
            second: flash / 2,
            ram,
            stack,
            deepest: Some(stack),
        }
    }

    #[test]
    fn a_table_reads_back() {
        let mut rows = [row("a", 1000, 200, 30), row("b+defmt", 1, 2, 3)];
        rows[1].deepest = None;
        assert_eq!(parse(&table(&rows)).unwrap(), rows);
        assert!(parse("a 1 2 3 4\n").is_err());
        assert!(parse("a 1 2 x 3 4 5\n").is_err());
    }

    #[test]
    fn paths_of_source_files_are_found() {
        let flash = b"\0\x07core/src/lib.rs\0alarm 4300\0a/b\0main.rs\0C:\\me\\x.rsindex";
        assert_eq!(folders_in(flash), ["core/src/lib.rs", r"C:\me\x.rsindex"]);
        assert!(folders_in(&[0xFF, b'.', b'r', 0]).is_empty());
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
    fn what_is_for_a_chip_has_to_fit() {
        let below = [row("a", FLASH_LIMIT, RAM_LIMIT - 100, 100)];
        assert!(too_large(&below).is_empty());
        let mut above = [row("a", FLASH_LIMIT + 1, RAM_LIMIT - 100, 101)];
        assert_eq!(too_large(&above).len(), 2);
        above[0].deepest = None;
        assert!(too_large(&above).is_empty());
    }

    #[test]
    fn the_deepest_stack_has_to_fit() {
        let mut rows = [row("a", 1, 1, 3000)];
        assert!(too_deep(&rows).is_empty());
        rows[0].deepest = Some(3001);
        assert_eq!(too_deep(&rows).len(), 1);
    }
}
