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
    /// What the latest piece of text has yielded and nobody has taken yet.
    queue: VecDeque<Event>,
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
            alarm: None,
            over: false,
        })
    }

    /// The next event, or the alarm that ends the program; `None` after the last.
    pub fn next_event(&mut self) -> io::Result<Option<Result<Event, Alarm>>> {
        loop {
            if let Some(event) = self.queue.pop_front() {
                return Ok(Some(Ok(event)));
            }
            if let Some(alarm) = self.alarm.take() {
                return Ok(Some(Err(alarm)));
            }
            if self.over {
                return Ok(None);
            }
            self.fill()?;
        }
    }

    /// The text read so far ends in inches.
    pub const fn is_inch(&self) -> bool {
        self.reader.interpreter().is_inch()
    }

    fn fill(&mut self) -> io::Result<()> {
        let read = match self.text.read(&mut self.chunk) {
            Err(error) if error.kind() == io::ErrorKind::Interrupted => return Ok(()),
            other => other?,
        };
        let queue = &mut self.queue;
        let mut take = |event| queue.push_back(event);
        let result = if read == 0 {
            self.over = true;
            self.reader.finish(&mut take)
        } else {
            self.reader.push(&self.chunk[..read], &mut take)
        };
        if let Err(alarm) = result {
            self.alarm = Some(alarm);
            self.over = true;
        } else if self.reader.interpreter().is_ended() {
            self.over = true;
        }
        Ok(())
    }
}
