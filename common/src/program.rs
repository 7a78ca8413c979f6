//! A program file as a stream of events, in bounded memory for any length. Macros, jumps and subprograms are carried out
//! on the way.

use std::collections::VecDeque;
use std::io;

use leadscrew_core::alarm::Alarm;
use leadscrew_core::params::Params;
use leadscrew_core::program::{Event, Options};
use leadscrew_language::flow::{Rules, Trouble};
use leadscrew_language::lines::Source;
use leadscrew_language::reader::Reader;
use leadscrew_language::variables::Kept;

use crate::source::{SourceFile, Text};

/// A program being read.
#[derive(Debug)]
pub struct Program<'p> {
    reader: Reader<'p, Again>,
    /// Events of the last step that have not been taken yet.
    queue: VecDeque<Event>,
    /// Steps so far.
    steps: u64,
    /// The alarm after the events in the queue.
    alarm: Option<Alarm>,
}

/// A text that is read from any of its bytes.
#[derive(Debug)]
struct Again {
    text: Text,
    /// The byte that comes next.
    at: u64,
}

impl Source for Again {
    fn read(&mut self, at: u64, buffer: &mut [u8]) -> io::Result<usize> {
        if at != self.at {
            self.text.go_to(at)?;
            self.at = at;
        }
        let count = io::Read::read(&mut self.text, buffer)?;
        self.at += count as u64;
        Ok(count)
    }
}

impl<'p> Program<'p> {
    /// Opens a file.
    pub fn open(source: &SourceFile, params: &'p Params, options: Options) -> io::Result<Self> {
        let text = Again {
            text: source.open()?,
            at: 0,
        };
        // No command keeps variables from one run to the next, and none runs a program without an end.
        let (kept, rules) = (Kept::default(), Rules::default());
        Ok(Self {
            reader: Reader::new(text, params, options, kept, rules),
            queue: VecDeque::new(),
            steps: 0,
            alarm: None,
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
            if self.reader.is_over() {
                return Ok(None);
            }
            self.steps += 1;
            let queue = &mut self.queue;
            match self.reader.step(&mut |event| queue.push_back(event)) {
                Ok(()) => {}
                Err(Trouble::Alarm(alarm)) => self.alarm = Some(alarm),
                Err(Trouble::Unreadable(error)) => return Err(error),
            }
        }
    }

    /// True where the line of the last event, or alarm, ends in inches.
    pub const fn is_inch(&self) -> bool {
        self.reader.interpreter().is_inch()
    }

    /// How many lines were carried out, the line of the last event included: a line that is carried out again counts again.
    pub const fn steps(&self) -> u64 {
        self.steps
    }

    /// The line of the last event; empty where it cannot be read again.
    pub fn line(&mut self) -> Vec<u8> {
        self.reader.text().map(<[u8]>::to_vec).unwrap_or_default()
    }
}
