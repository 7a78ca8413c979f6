//! The file that keeps the variables #500 to #999 from one run to the next.
//!
//! They belong to a machine, so the file lies beside its `leadscrew.toml`; without one it is the user's, in the folder for
//! the state of programs [D241]. Every command that reads a program reads it; only the end of a run writes it. It is text,
//! a line a variable: `#500 = 1.5`. Macro A of the GSK 980TD counts in increments, and such a value says so.

use std::io::Read as _;
use std::path::{Path, PathBuf};

use leadscrew_core::alarm::{Code, Lang};
use leadscrew_language::value::Value;
use leadscrew_language::variables::Kept;

use crate::cli::Global;
use crate::diagnostics::{self, Diagnostic, Place};
use crate::failure::{Doing, Failure, Outcome, unreadable};
use crate::replace::replace;
use crate::state;
use crate::words::{self, both};

/// Name of the file beside a machine file.
pub const NAME: &str = "leadscrew.variables";

/// The first line of a file that is written.
const HEADING: &str = "(variables #500 to #999: written at the end of each run)\n";

/// Longest file in bytes: more than 500 lines of the longest numbers.
const LONGEST: u64 = 1 << 16;

/// What stands behind a count of increments.
const INCREMENTS: &str = "increments";

/// The variables that are kept, and where.
#[derive(Debug, Default)]
pub struct VariableFile {
    path: Option<PathBuf>,
    /// The values at the start of the command.
    pub values: Kept,
}

impl VariableFile {
    /// Reads the file of a machine; mistakes go to `told`. Where there is no file, no variable has a value.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn load(
        global: &Global,
        machine: Option<&Path>,
        told: &mut Vec<Diagnostic>,
    ) -> Outcome<Self> {
        let path = place(global, machine);
        let mut values = Kept::default();
        if let Some(path) = &path {
            let text =
                read(path).map_err(|error| Failure::file(Doing::Read, path.display(), &error))?;
            take(&text, path, global.lang(), &mut values, told);
        }
        Ok(Self { path, values })
    }

    /// Keeps the values that a run has left, if they are others than before; gives the file where it was written.
    ///
    /// # Errors
    /// It cannot be written; the old one is unchanged.
    pub fn save(&self, values: &Kept, lang: Lang) -> Outcome<Option<String>> {
        if *values == self.values {
            return Ok(None);
        }
        let Some(path) = &self.path else {
            let told = both!(
                "note: #500 to #999 have changed, and there is no folder to keep them in: `--variables FILE` names a file\n",
                "注意：#500 至 #999 已改变，但没有可保存的文件夹：请用 `--variables FILE` 指定文件\n"
            );
            diagnostics::say(told.get(lang));
            return Ok(None);
        };
        let written = path.parent().map_or(Ok(()), std::fs::create_dir_all);
        written
            .and_then(|()| replace(path, text(values).as_bytes()))
            .map_err(|error| Failure::file(Doing::Write, path.display(), &error))?;
        Ok(Some(words::path(path)))
    }
}

/// Where they are kept: by the option, beside the machine file, or in the folder for the state of programs.
fn place(global: &Global, machine: Option<&Path>) -> Option<PathBuf> {
    if let Some(path) = &global.variables {
        return Some(path.clone());
    }
    if let Some(machine) = machine {
        return Some(machine.with_file_name(NAME));
    }
    Some(state::folder()?.join(NAME))
}

fn read(path: &Path) -> std::io::Result<Vec<u8>> {
    let file = match std::fs::File::open(path) {
        Ok(file) => file,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(Vec::new()),
        Err(error) => return Err(error),
    };
    let mut text = Vec::new();
    file.take(LONGEST + 1).read_to_end(&mut text)?;
    if text.len() as u64 > LONGEST {
        return Err(unreadable(both!(
            "it is longer than the {LONGEST} bytes that a file of variables may have: name another one with `--variables`",
            "它超过变量文件允许的 {LONGEST} 字节：请用 `--variables` 指定另一个文件"
        )));
    }
    Ok(text)
}

/// Takes the values of a text, and tells what is none.
fn take(text: &[u8], path: &Path, lang: Lang, values: &mut Kept, told: &mut Vec<Diagnostic>) {
    let mut known = [0_u32; 1000];
    for (number, line) in (1..).zip(text.split(|byte| *byte == b'\n')) {
        let line = String::from_utf8_lossy(line);
        let line = line.trim_end();
        if line.is_empty() || line.starts_with('(') {
            continue;
        }
        let (code, figures) = match entry(line) {
            None => (Code::VariableEntry, vec![line.to_owned()]),
            Some((variable, value)) => {
                let before = std::mem::replace(&mut known[usize::from(variable)], number);
                if before == 0 {
                    values.set(variable, value);
                    continue;
                }
                let figures = vec![variable.to_string(), before.to_string()];
                (Code::VariableEntryTwice, figures)
            }
        };
        let place = Place {
            file: path.display().to_string(),
            line: number,
            column: 1,
            end_column: line.chars().count() + 1,
            text: line.to_owned(),
        };
        told.push(Diagnostic::of_option(code, &figures, &place, lang));
    }
}

/// The variable and the value of a line.
fn entry(line: &str) -> Option<(u16, Value)> {
    let (variable, value) = line.strip_prefix('#')?.split_once('=')?;
    let variable = variable.trim_end().parse().ok()?;
    if !(500..=999).contains(&variable) {
        return None;
    }
    let value = value.trim_start();
    let (value, counts) = match value.strip_suffix(INCREMENTS) {
        Some(count) => (count.trim_end(), true),
        None => (value, false),
    };
    let number = value
        .parse()
        .ok()
        .filter(|number: &f64| number.is_finite())?;
    let value = match counts {
        true => Value::Increments(number),
        false => Value::Number(number),
    };
    Some((variable, value))
}

/// The text of a file. Each number has the digits that give the same bits again.
fn text(values: &Kept) -> String {
    let mut text = HEADING.to_owned();
    for (variable, value) in values.values() {
        text += &match value {
            Value::Increments(count) => format!("#{variable} = {count:?} {INCREMENTS}\n"),
            value => format!("#{variable} = {:?}\n", value.number()),
        };
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_value_comes_back_with_the_same_bits() {
        let mut values = Kept::default();
        let numbers = [0.1 + 0.2, -0.0, 1e300, 5e-324, f64::MAX, -1234.5, 7.0];
        for (number, value) in (500..).zip(numbers) {
            assert!(values.set(number, Value::Number(value)));
            assert!(values.set(number + 400, Value::Increments(value)));
        }
        let (mut again, mut told) = (Kept::default(), Vec::new());
        take(
            text(&values).as_bytes(),
            Path::new("v"),
            Lang::En,
            &mut again,
            &mut told,
        );
        assert!(told.is_empty());
        assert_eq!(again, values);
        let bits = |kept: &Kept| {
            kept.values()
                .map(|(_, v)| v.number().to_bits())
                .collect::<Vec<_>>()
        };
        assert_eq!(bits(&again), bits(&values));
    }

    #[test]
    fn what_is_no_value_is_told_with_its_line() {
        let wrong = [
            "500 = 1",
            "#500",
            "#499 = 1",
            "#1000 = 1",
            "#500 = x",
            "#500 = nan",
            "#500 = inf",
            "#500 = 1 mm",
            "#x = 1",
            "#500 = 1e999",
            "#70000 = 1",
            "\u{fffd}",
        ];
        for line in wrong {
            let text = format!("(a)\n\n#501 = 2\r\n{line}\n");
            let (mut values, mut told) = (Kept::default(), Vec::new());
            take(
                text.as_bytes(),
                Path::new("v"),
                Lang::En,
                &mut values,
                &mut told,
            );
            let found: Vec<_> = told.iter().map(|told| (told.number, told.line)).collect();
            assert_eq!(found, [(4856, 4)], "{line}");
            assert_eq!(
                values.values().collect::<Vec<_>>(),
                [(501, Value::Number(2.0))]
            );
        }
        let (mut values, mut told) = (Kept::default(), Vec::new());
        take(
            b"#500=1\n#500=1\n",
            Path::new("v"),
            Lang::En,
            &mut values,
            &mut told,
        );
        assert_eq!((told.len(), told[0].number, told[0].line), (1, 4857, 2));
        assert_eq!(told[0].message, "#500 is here a second time, after line 1");
    }
}
