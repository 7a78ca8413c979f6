//! Whole programs: from a buffer ([`Events`]), or piece by piece in bounded memory ([`Reader`]).

use super::interpreter::{Interpreter, without_mark};
use crate::alarm::Alarm;
use crate::params::Params;
use crate::text::{Cursor, Event, MAX_LINE, Options};

/// The events of a program that is in memory as a whole. Ends after the first alarm.
#[derive(Clone, Debug)]
pub struct Events<'t, 'p> {
    interpreter: Interpreter<'p>,
    /// The text from the front of the current line.
    text: &'t [u8],
    cursor: Cursor<'t>,
    line: u32,
    stage: Stage,
    /// It comes after what the blocks before it have yielded.
    alarm: Option<Alarm>,
}

/// Where the iterator stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// In a line.
    Line,
    /// At the end of one.
    LineEnd,
    /// At the end of the text.
    Over,
}

impl<'t, 'p> Events<'t, 'p> {
    /// Reads `text` from the front.
    #[must_use]
    pub fn new(text: &'t [u8], params: &'p Params, options: Options) -> Self {
        let text = without_mark(text, 1);
        Self {
            interpreter: Interpreter::new(params, options),
            text,
            cursor: Cursor::new(text, 1),
            line: 1,
            stage: Stage::Line,
            alarm: None,
        }
    }

    /// The interpreter, for what it knows of the program.
    #[must_use]
    pub const fn interpreter(&self) -> &Interpreter<'p> {
        &self.interpreter
    }

    /// Reads the next block, or finds the end.
    fn advance(&mut self) -> Result<(), Alarm> {
        if self.stage == Stage::LineEnd {
            self.text = self.text.get(self.cursor.consumed()..).unwrap_or(&[]);
            self.line = self.line.saturating_add(1);
            self.cursor = Cursor::new(self.text, self.line);
        }
        if self.interpreter.is_ended() || self.text.is_empty() {
            self.stage = Stage::Over;
            return self.interpreter.refuse_open();
        }
        self.stage = if self.interpreter.read_block(&mut self.cursor)? {
            Stage::Line
        } else {
            Stage::LineEnd
        };
        Ok(())
    }
}

impl Iterator for Events<'_, '_> {
    type Item = Result<Event, Alarm>;

    #[inline]
    fn next(&mut self) -> Option<Self::Item> {
        loop {
            if let Some(event) = self.interpreter.next_event() {
                return Some(Ok(event));
            }
            if self.stage == Stage::Over {
                return match self.interpreter.take_held(false) {
                    Some(held) => Some(Ok(Event::Call(held))),
                    None => self.alarm.take().map(Err),
                };
            }
            if let Err(alarm) = self.advance() {
                self.stage = Stage::Over;
                self.alarm = Some(alarm);
            }
        }
    }
}

/// Splits a stream into lines and interprets them: for programs of any size, in the memory of one line. How the text is
/// cut into pieces makes no difference to what comes out.
#[derive(Clone, Debug)]
pub struct Reader<'p> {
    interpreter: Interpreter<'p>,
    /// The beginning of a line whose end has not come yet.
    buffer: [u8; MAX_LINE],
    held: usize,
    line: u32,
}

impl<'p> Reader<'p> {
    /// Before the first byte.
    #[must_use]
    pub fn new(params: &'p Params, options: Options) -> Self {
        Self {
            interpreter: Interpreter::new(params, options),
            buffer: [0; MAX_LINE],
            held: 0,
            line: 1,
        }
    }

    /// The interpreter, for what it knows of the program.
    #[must_use]
    pub const fn interpreter(&self) -> &Interpreter<'p> {
        &self.interpreter
    }

    /// Takes in the next piece of text and hands what its complete lines yield to `out`.
    ///
    /// # Errors
    /// The alarm that ends the program; pieces after it yield nothing.
    pub fn push(&mut self, chunk: &[u8], out: &mut impl FnMut(Event)) -> Result<(), Alarm> {
        let mut rest = chunk;
        if self.held > 0 {
            rest = self.hold(rest, out)?;
        }
        let complete = rest.iter().rposition(|byte| *byte == b'\n');
        let complete = complete.map_or(0, |last| last.saturating_add(1));
        let Some((mut lines, tail)) = rest.split_at_checked(complete) else {
            return Ok(());
        };
        while !lines.is_empty() && !self.interpreter.is_ended() {
            let text = without_mark(lines, self.line);
            let mut cursor = Cursor::new(text, self.line);
            self.interpreter.read_line(&mut cursor, out)?;
            self.line = self.line.saturating_add(1);
            lines = text.get(cursor.consumed()..).unwrap_or(&[]);
        }
        self.hold(tail, out).map(|_| ())
    }

    /// Says that the text is over: reads the last line if it has no line ending.
    ///
    /// # Errors
    /// The alarm of that line, or of a comment that was never closed.
    pub fn finish(&mut self, out: &mut impl FnMut(Event)) -> Result<(), Alarm> {
        if self.held > 0 {
            self.held_line(false, out)?;
        }
        self.interpreter.finish(out)
    }

    /// Adds to the line in the buffer up to its line ending and reads it there; what follows is given back.
    fn hold<'t>(&mut self, text: &'t [u8], out: &mut impl FnMut(Event)) -> Result<&'t [u8], Alarm> {
        let mut rest = text;
        while let [byte, tail @ ..] = rest {
            if self.interpreter.is_ended() {
                return Ok(&[]);
            }
            if *byte == b'\n' {
                self.held_line(false, out)?;
                return Ok(tail);
            }
            match self.buffer.get_mut(self.held) {
                Some(place) => *place = *byte,
                None => {
                    self.held_line(true, out)?;
                    return Ok(&[]);
                }
            }
            self.held = self.held.saturating_add(1);
            rest = tail;
        }
        Ok(rest)
    }

    /// Reads the line in the buffer; `cut` where it goes on beyond.
    fn held_line(&mut self, cut: bool, out: &mut impl FnMut(Event)) -> Result<(), Alarm> {
        let text = self.buffer.get(..self.held).unwrap_or(&[]);
        let text = without_mark(text, self.line);
        let mut cursor = if cut {
            Cursor::cut(text, self.line)
        } else {
            Cursor::new(text, self.line)
        };
        self.held = 0;
        self.line = self.line.saturating_add(1);
        self.interpreter.read_line(&mut cursor, out)
    }
}
