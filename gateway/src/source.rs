//! Program files: read in pieces, and read again where a message wants to show a line.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

use crate::failure::{Failure, Outcome};
use crate::words::both;

/// Longest line that is shown in a message.
const SHOWN: u64 = 4096;

/// A program file. Nothing of it is kept in memory.
#[derive(Clone, Debug)]
pub struct SourceFile {
    path: PathBuf,
}

impl SourceFile {
    /// Names the file; it is opened when it is read.
    pub fn new(path: &Path) -> Self {
        Self {
            path: path.to_owned(),
        }
    }

    /// The name as it was typed.
    pub fn name(&self) -> String {
        self.path.display().to_string()
    }

    /// Refuses `output` where it would overwrite the program.
    pub fn protect(&self, output: &Path) -> Outcome {
        match (self.path.canonicalize(), output.canonicalize()) {
            (Ok(program), Ok(output)) if program == output => Err(Failure::Usage(both!(
                "`{name}` is the program itself: write the output to another file",
                "`{name}` 就是程序本身：请把输出写到别的文件",
                name = self.name()
            ))),
            _ => Ok(()),
        }
    }

    /// Opens it.
    pub fn open(&self) -> io::Result<File> {
        let file = File::open(&self.path)?;
        if file.metadata()?.is_dir() {
            return Err(io::Error::from(io::ErrorKind::IsADirectory));
        }
        Ok(file)
    }

    /// Line `number` (from 1) without its end, at most a screenful of it; `None` where there is no such line.
    pub fn line(&self, number: u32) -> Option<Vec<u8>> {
        let mut reader = BufReader::with_capacity(1 << 16, self.open().ok()?);
        for _ in 1..number {
            if reader.skip_until(b'\n').ok()? == 0 {
                return None;
            }
        }
        let mut line = Vec::new();
        let read = reader.take(SHOWN).read_until(b'\n', &mut line).ok()?;
        if number == 0 || read == 0 {
            return None;
        }
        while line
            .last()
            .is_some_and(|byte| matches!(byte, b'\n' | b'\r'))
        {
            line.pop();
        }
        Some(line)
    }
}
