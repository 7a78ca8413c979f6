//! A program file as a stream of events, in bounded memory whatever its length.

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
    /// What the latest piece of text has yielded and nobody has taken yet; whether its line ends in inches.
    queue: VecDeque<(Event, bool)>,
    /// The same of what was taken last.
    inch: bool,
    /// The alarm after the queue.
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

    /// The line of the latest event, or alarm, ends in inches.
    pub const fn is_inch(&self) -> bool {
        self.inch
    }

    fn fill(&mut self) -> io::Result<()> {
        let read = match self.text.read(&mut self.chunk) {
            Err(error) if error.kind() == io::ErrorKind::Interrupted => return Ok(()),
            other => other?,
        };
        self.over = read == 0;
        let result = if self.over {
            self.push(None)
        } else {
            // By lines, so that each event is told in the unit of its own one.
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
