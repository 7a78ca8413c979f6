//! A program file as a stream of events, in bounded memory for any length.

use std::collections::VecDeque;
use std::io::{self, Read as _};

use leadscrew_core::alarm::Alarm;
use leadscrew_core::params::Params;
use leadscrew_core::program::{Event, Options, Reader};

use crate::source::{SourceFile, Text};

/// Bytes read at a time.
const CHUNK: usize = 1 << 14;

/// A program being read.
#[derive(Debug)]
pub struct Program<'p> {
    text: Text,
    reader: Reader<'p>,
    chunk: Vec<u8>,
    /// Used bytes of `chunk`.
    filled: usize,
    /// The line in which that piece begins, and the part of this line before the piece.
    first: (u32, Vec<u8>),
    /// Events of the last piece of text that have not been taken yet, each with whether its line ends in inches.
    queue: VecDeque<(Event, bool)>,
    /// Whether the line of the last taken event ends in inches.
    inch: bool,
    /// The alarm after the events in the queue.
    alarm: Option<Alarm>,
    over: bool,
}

impl<'p> Program<'p> {
    /// Opens a file.
    pub fn open(source: &SourceFile, params: &'p Params, options: Options) -> io::Result<Self> {
        Ok(Self {
            text: source.open()?,
            reader: Reader::new(params, options),
            chunk: vec![0; CHUNK],
            filled: 0,
            first: (1, Vec::new()),
            queue: VecDeque::new(),
            inch: false,
            alarm: None,
            over: false,
        })
    }

    /// The next event, or the alarm that ends the program; `None` after the last.
    pub fn next_event(&mut self) -> io::Result<Option<Result<Event, Alarm>>> {
        loop {
            if let Some((event, inch)) = self.queue.pop_front() {
                self.inch = inch;
                return Ok(Some(Ok(event)));
            }
            if let Some(alarm) = self.alarm.take() {
                self.inch = self.reader.interpreter().is_inch();
                return Ok(Some(Err(alarm)));
            }
            if self.over {
                return Ok(None);
            }
            self.fill()?;
        }
    }

    /// True where the line of the last event, or alarm, ends in inches.
    pub const fn is_inch(&self) -> bool {
        self.inch
    }

    /// The line of the last event, also for a text that cannot be read twice; empty where it was read too long ago.
    pub fn line(&self, number: u32) -> Vec<u8> {
        let (first, begun) = &self.first;
        let Some(behind) = number.checked_sub(*first) else {
            return Vec::new();
        };
        let mut lines = self.chunk[..self.filled].split(|byte| *byte == b'\n');
        let text = lines.nth(behind as usize).unwrap_or_default();
        let line = if behind == 0 {
            [begun, text].concat()
        } else {
            text.to_vec()
        };
        match line.strip_prefix("\u{feff}".as_bytes()) {
            Some(text) if number == 1 => text.to_vec(),
            _ => line,
        }
    }

    /// Makes room for the next piece. The started line is kept, up to the longest line.
    fn clear_chunk(&mut self) {
        let piece = &self.chunk[..self.filled];
        let (first, begun) = &mut self.first;
        let mut rest = piece;
        if let Some(last) = piece.iter().rposition(|byte| *byte == b'\n') {
            *first += piece.iter().filter(|byte| **byte == b'\n').count() as u32;
            begun.clear();
            rest = &piece[last + 1..];
        }
        let room = CHUNK.saturating_sub(begun.len()).min(rest.len());
        begun.extend_from_slice(&rest[..room]);
        self.filled = 0;
    }

    fn fill(&mut self) -> io::Result<()> {
        self.clear_chunk();
        let read = match self.text.read(&mut self.chunk) {
            Err(error) if error.kind() == io::ErrorKind::Interrupted => return Ok(()),
            other => other?,
        };
        self.filled = read;
        self.over = read == 0;
        let result = if self.over {
            self.push(None)
        } else {
            // Line by line, so that each event has the unit of its own line.
            let chunk = std::mem::take(&mut self.chunk);
            let mut lines = chunk[..read].split_inclusive(|byte| *byte == b'\n');
            let result = lines.try_for_each(|line| self.push(Some(line)));
            self.chunk = chunk;
            result
        };
        if let Err(alarm) = result {
            self.alarm = Some(alarm);
            self.over = true;
        } else if self.reader.interpreter().is_ended() {
            self.over = true;
        }
        Ok(())
    }

    /// Hands the reader a piece of text, or the end of it.
    fn push(&mut self, text: Option<&[u8]>) -> Result<(), Alarm> {
        let known = self.queue.len();
        let queue = &mut self.queue;
        let mut take = |event| queue.push_back((event, false));
        let result = match text {
            Some(text) => self.reader.push(text, &mut take),
            None => self.reader.finish(&mut take),
        };
        if self.reader.interpreter().is_inch() {
            for (_, inch) in self.queue.range_mut(known..) {
                *inch = true;
            }
        }
        result
    }
}
