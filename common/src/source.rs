//! Program texts: read in pieces, and read again where a message shows a line. Most are files; a program that a command
//! makes itself is a text in memory.

use std::cell::{Cell, RefCell};
use std::fs::File;
use std::io::{self, BufRead, BufReader, Cursor, Read, Seek as _, SeekFrom};
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;

use leadscrew_language::whose::Whose;

use crate::failure::{Failure, Outcome, unreadable};
use crate::line_ends::LineEnds;
use crate::words::{self, both};

/// The first line. Nothing is known of line ends yet.
const FIRST: (u32, u64, LineEnds) = (1, 0, LineEnds::Unknown);

/// Longest line in a message.
const SHOWN: u64 = 4096;
/// Bytes of a line behind those, up to which its end is looked for where lines are to be shown.
const SKIPPED: u64 = 1 << 20;

/// The most bytes of a pipe that are kept.
const KEPT: usize = 1 << 24;

/// A program. A file is not kept in memory.
#[derive(Clone, Debug)]
pub struct SourceFile {
    path: PathBuf,
    text: Option<Arc<[u8]>>,
    /// A source that is no file on a disk is opened once and kept, because its bytes come only once.
    pipe: RefCell<Option<Shared>>,
    /// The last shown line, its first byte, and the line ends. Messages come in the order of the program, so a long program
    /// is not read from its beginning for each of them.
    shown: Cell<(u32, u64, LineEnds)>,
}

/// A pipe and the bytes read from it.
#[derive(Debug)]
struct Pipe {
    from: File,
    kept: Vec<u8>,
    /// Number of these bytes.
    came: u64,
}

type Shared = Rc<RefCell<Pipe>>;

impl Pipe {
    /// Reads the bytes from `at` on.
    fn read(&mut self, at: u64, buffer: &mut [u8]) -> io::Result<usize> {
        if at < self.came {
            let at = usize::try_from(at).unwrap_or(usize::MAX);
            let Some(kept) = self.kept.get(at..).filter(|kept| !kept.is_empty()) else {
                return Err(unreadable(both!(
                    "it comes from a pipe, is read twice, and is longer than the {KEPT} bytes that are kept: save it to a file first",
                    "它来自管道，需要读两遍，而长度超过可保留的 {KEPT} 字节：请先保存为文件"
                )));
            };
            let count = kept.len().min(buffer.len());
            buffer[..count].copy_from_slice(&kept[..count]);
            return Ok(count);
        }
        let count = self.from.read(buffer)?;
        if self.kept.len() as u64 == self.came && self.kept.len() + count <= KEPT {
            self.kept.extend_from_slice(&buffer[..count]);
        }
        self.came += count as u64;
        Ok(count)
    }
}

/// A source without any translation.
#[derive(Debug)]
pub enum Raw {
    /// A file.
    File(File),
    /// Memory.
    Memory(Cursor<Arc<[u8]>>),
    /// A pipe, and the place in it.
    Pipe(Kept),
}

/// A place in the bytes of a pipe.
#[derive(Debug)]
pub struct Kept {
    pipe: Shared,
    at: u64,
}

/// A program that is being read. Its lines end with line feeds, whatever the source has.
#[derive(Debug)]
pub struct Text {
    from: Raw,
    ends: LineEnds,
    /// The first half of a line end whose second half has not been read yet.
    half: Option<u8>,
}

impl Read for Text {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        // There must be room for half of a line end and the byte after it.
        if buffer.len() < 2 {
            return Err(io::ErrorKind::InvalidInput.into());
        }
        loop {
            let begun = usize::from(self.half.is_some());
            let read = self.from.read(&mut buffer[begun..])?;
            if let Some(half) = self.half.take() {
                buffer[0] = half;
            }
            let all = begun + read;
            let done = self.ends.translate(&mut buffer[..all], read == 0);
            self.half = buffer[..all].get(done).copied();
            if done > 0 || read == 0 {
                return Ok(done);
            }
        }
    }
}

impl Text {
    /// Goes on at the front of a line, whose end may have been read before.
    pub fn go_to(&mut self, byte: u64) -> io::Result<()> {
        self.half = None;
        self.from.seek(byte)
    }
}

impl Read for Raw {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        match self {
            Self::File(file) => file.read(buffer),
            Self::Memory(text) => text.read(buffer),
            Self::Pipe(kept) => {
                let count = kept.pipe.borrow_mut().read(kept.at, buffer)?;
                kept.at += count as u64;
                Ok(count)
            }
        }
    }
}

impl Raw {
    /// Goes on at this byte.
    fn seek(&mut self, byte: u64) -> io::Result<()> {
        let to = SeekFrom::Start(byte);
        match self {
            Self::File(file) => file.seek(to),
            Self::Memory(text) => text.seek(to),
            Self::Pipe(kept) => {
                kept.at = byte;
                Ok(byte)
            }
        }
        .map(drop)
    }
}

impl SourceFile {
    /// Names the file. It is opened when it is read.
    pub fn new(path: &Path) -> Self {
        Self {
            path: path.to_owned(),
            text: None,
            pipe: RefCell::default(),
            shown: Cell::new(FIRST),
        }
    }

    /// A text that a command has made, with its name in messages.
    #[must_use]
    pub fn text(name: &str, text: String) -> Self {
        Self {
            path: name.into(),
            text: Some(text.into_bytes().into()),
            pipe: RefCell::default(),
            shown: Cell::new(FIRST),
        }
    }

    /// Another file of this program: the one that a subprogram may have for itself, beside it [D240], also in capitals, as
    /// a control writes it to a card. `None` where the program is no file.
    #[must_use]
    pub fn beside(&self, file: Whose) -> Option<Self> {
        let name = file.name().filter(|_| self.text.is_none())?;
        let [file, on_card] =
            [name.clone(), name.to_uppercase()].map(|name| self.path.with_file_name(name));
        let is_on_card = !file.exists() && on_card.exists();
        Some(Self::new(if is_on_card { &on_card } else { &file }))
    }

    /// The name in messages.
    pub fn shown(&self) -> String {
        words::path(&self.path)
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The name as typed.
    pub fn name(&self) -> String {
        self.path.display().to_string()
    }

    /// Refuses `output` where it would overwrite the program.
    pub fn protect(&self, output: &Path) -> Outcome {
        match (self.path.canonicalize(), output.canonicalize()) {
            (Ok(program), Ok(output)) if program == output => Err(Failure::Usage(both!(
                "`{name}` is the program itself: write the output to another file",
                "`{name}` 就是程序本身：请把输出写到别的文件",
                name = self.shown()
            ))),
            _ => Ok(()),
        }
    }

    /// Opens the program.
    pub fn open(&self) -> io::Result<Text> {
        Ok(Text {
            from: self.raw()?,
            ends: LineEnds::default(),
            half: None,
        })
    }

    /// Opens the program without any translation.
    pub fn raw(&self) -> io::Result<Raw> {
        if let Some(text) = self.text.clone() {
            return Ok(Raw::Memory(Cursor::new(text)));
        }
        let mut pipe = self.pipe.borrow_mut();
        if let Some(pipe) = &*pipe {
            let pipe = pipe.clone();
            return Ok(Raw::Pipe(Kept { pipe, at: 0 }));
        }
        let file = File::open(&self.path)?;
        let kind = file.metadata()?;
        if kind.is_dir() {
            return Err(io::Error::from(io::ErrorKind::IsADirectory));
        }
        if kind.is_file() {
            return Ok(Raw::File(file));
        }
        let shared = pipe.insert(Rc::new(RefCell::new(Pipe {
            from: file,
            kept: Vec::new(),
            came: 0,
        })));
        let pipe = shared.clone();
        Ok(Raw::Pipe(Kept { pipe, at: 0 }))
    }

    /// Line `number` (from 1) without its end, up to the longest shown line; `None` where there is no such line.
    pub fn line(&self, number: u32) -> Option<Vec<u8>> {
        let mut text = self.open().ok()?;
        let (mut at, mut begins, ends) = self.shown.get();
        if at <= number && text.from.seek(begins).is_ok() {
            text.ends = ends;
        } else {
            (at, begins, _) = FIRST;
            text.from.seek(0).ok()?;
        }
        let mut reader = BufReader::with_capacity(1 << 16, text);
        for _ in at..number {
            match reader.skip_until(b'\n').ok()? {
                0 => return None,
                skipped => begins += skipped as u64,
            }
        }
        let line = shown(&mut reader).ok()?;
        self.shown
            .set((number.max(1), begins, reader.get_ref().ends));
        (number > 0).then_some(line?.0)
    }

    /// The first lines, at most this many, each as [`Self::line`] has it.
    pub fn lines(&self, most: usize) -> Vec<Vec<u8>> {
        let mut lines = Vec::new();
        let Ok(text) = self.open() else {
            return lines;
        };
        let mut reader = BufReader::with_capacity(1 << 16, text);
        while lines.len() < most
            && let Ok(Some((line, is_whole))) = shown(&mut reader)
        {
            lines.push(line);
            if is_whole {
                continue;
            }
            // What has no end for so long has no lines.
            let skipped = reader.by_ref().take(SKIPPED).skip_until(b'\n');
            if skipped.map_or(true, |count| count as u64 == SKIPPED) {
                break;
            }
        }
        lines
    }
}

/// The next line without its end, up to the longest shown line, and whether it is whole; `None` at the end of the text.
fn shown(reader: &mut impl BufRead) -> io::Result<Option<(Vec<u8>, bool)>> {
    let mut line = Vec::new();
    if reader.take(SHOWN).read_until(b'\n', &mut line)? == 0 {
        return Ok(None);
    }
    let is_whole = line.ends_with(b"\n");
    while line.ends_with(b"\n") || line.ends_with(b"\r") {
        line.pop();
    }
    Ok(Some((line, is_whole)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_the_same_in_whatever_order_lines_are_asked_for() {
        let path = std::env::temp_dir().join(format!("leadscrew-lines-{}", std::process::id()));
        let text = |end| (1..=500).map(|n| format!("N{n} G1 X{n}{end}")).collect();
        let file = |end| {
            let path = path.with_extension(format!("{end:?}").replace('\\', ""));
            let text: String = text(end);
            std::fs::write(&path, text).unwrap();
            SourceFile::new(&path)
        };
        let files = ["\r\n", "\n", "\r", "\n\r"].map(file);
        let memory = SourceFile::text("memory", text("\r\n"));
        for source in files.iter().chain([&memory]) {
            for number in [1, 3, 2, 500, 499, 500, 500, 1, 250, 251, 501, 7] {
                let expected = (number <= 500).then(|| format!("N{number} G1 X{number}"));
                let line = source
                    .line(number)
                    .map(|line| String::from_utf8(line).unwrap().trim_end().to_owned());
                assert_eq!(line, expected, "{number}");
            }
            assert_eq!(source.line(0), None);
            let each: Vec<_> = (1..=500).filter_map(|n| source.line(n)).collect();
            assert_eq!(source.lines(2), each[..2]);
            assert_eq!(source.lines(501), each);
        }
        let long = format!("{}\nM30", "X".repeat(5_000));
        let lines = SourceFile::text("long", long).lines(9);
        assert_eq!(lines, [vec![b'X'; 4_096], b"M30".to_vec()]);
        for source in files {
            std::fs::remove_file(&source.path).unwrap();
        }
    }
}
