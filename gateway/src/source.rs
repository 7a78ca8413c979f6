//! Programs as text: read in pieces, and read again where a message wants to show a line. Mostly files; what a command
//! carries out of itself is a text in memory.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Cursor, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::failure::{Failure, Outcome};
use crate::words::both;

/// Longest line that is shown in a message.
const SHOWN: u64 = 4096;

/// A program. Of a file nothing is kept in memory.
#[derive(Clone, Debug)]
pub struct SourceFile {
    path: PathBuf,
    text: Option<Arc<[u8]>>,
}

/// A program being read.
#[derive(Debug)]
pub enum Text {
    /// From a file.
    File(File),
    /// From memory.
    Memory(Cursor<Arc<[u8]>>),
}

impl Read for Text {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        match self {
            Self::File(file) => file.read(buffer),
            Self::Memory(text) => text.read(buffer),
        }
    }
}

impl SourceFile {
    /// Names the file; it is opened when it is read.
    pub fn new(path: &Path) -> Self {
        Self {
            path: path.to_owned(),
            text: None,
        }
    }

    /// A text that a command has made, under the name messages show.
    #[must_use]
    pub fn text(name: &str, text: String) -> Self {
        Self {
            path: name.into(),
            text: Some(text.into_bytes().into()),
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
    pub fn open(&self) -> io::Result<Text> {
        if let Some(text) = self.text.clone() {
            return Ok(Text::Memory(Cursor::new(text)));
        }
        let file = File::open(&self.path)?;
        if file.metadata()?.is_dir() {
            return Err(io::Error::from(io::ErrorKind::IsADirectory));
        }
        Ok(Text::File(file))
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
