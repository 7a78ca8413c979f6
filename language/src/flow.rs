//! Program flow: which block comes next.
//!
//! Carries out assignments, jumps, loops and calls; everything else goes to a [`Machine`]. A line without any of these
//! goes there as a whole, unchanged. Memory is bounded: one window of the text, sixteen calls, three loops in each. A loop
//! without a motion ends with an alarm. This module must not know what words mean.

mod calls;
mod jumps;
mod search;
#[cfg(test)]
mod tests;

use std::io;

use leadscrew_core::alarm::{Alarm, Arg, Code, Span};
use leadscrew_core::program::MAX_LINE;
use leadscrew_core::units::Decimal;

use crate::expression::Calculator;
use crate::lines::{Lines, Place, Source};
use crate::statement::{Head, Statement, head, statement};
use crate::text::{Cursor, Glance, Piece, comment_end, glance, has_blocks, piece, span};
use crate::value::Value;
use crate::variables::{Kept, Scope, System, Variables};
use crate::word::{self, Given, Word};
use calls::Frame;
use search::Memo;

/// What a block did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Done {
    /// An axis moves.
    pub moved: bool,
    /// The program has ended itself.
    pub ended: bool,
}

/// What carries out the words.
pub trait Machine: System {
    /// Carries out a line, or the front of one, in which nothing has to be calculated. Blocks of this line that were
    /// carried out before are blank.
    ///
    /// # Errors
    /// The alarm that ends the program.
    fn line(&mut self, line: u32, text: &[u8]) -> Result<Done, Alarm>;

    /// Carries out one block whose values were calculated.
    ///
    /// # Errors
    /// The alarm that ends the program.
    fn words(&mut self, line: u32, words: &[Word]) -> Result<Done, Alarm>;

    /// Decimals of the increment of a letter's word.
    fn decimals(&self, letter: u8) -> u8;

    /// Tells the operator something.
    fn note(&mut self, warning: Alarm);

    /// The text is over, and the program has not ended itself.
    ///
    /// # Errors
    /// What may not be left open.
    fn finish(&mut self) -> Result<(), Alarm>;
}

/// How a program is run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rules {
    /// Blocks with `/` in front are passed over.
    pub skip: bool,
    /// M99 in the main program begins it again; otherwise it ends there, with a note.
    pub repeat: bool,
    /// Statements that a loop may carry out without a motion.
    pub budget: u32,
}

impl Default for Rules {
    fn default() -> Self {
        Self {
            skip: false,
            repeat: false,
            budget: 1_000_000,
        }
    }
}

/// Why a program does not go on.
#[derive(Debug)]
pub enum Trouble {
    /// It is wrong.
    Alarm(Alarm),
    /// Its text cannot be read.
    Unreadable(io::Error),
}

impl From<Alarm> for Trouble {
    fn from(alarm: Alarm) -> Self {
        Self::Alarm(alarm)
    }
}

impl From<io::Error> for Trouble {
    fn from(error: io::Error) -> Self {
        Self::Unreadable(error)
    }
}

/// A program that runs.
#[derive(Debug)]
pub struct Flow<S> {
    lines: Lines<S>,
    variables: Variables,
    rules: Rules,
    /// The program, and what it has called. Never empty.
    frames: Vec<Frame>,
    /// The next block.
    at: Place,
    /// The block of the latest step.
    last: Place,
    /// Comments that are open in front of it.
    depth: u32,
    /// A block has been carried out.
    started: bool,
    over: bool,
    /// Statements since the last motion.
    idle: u32,
    memo: Memo,
    /// The line of a block that is carried out alone, its front blanked, and its words.
    text: Vec<u8>,
    blanked: Vec<u8>,
    words: Vec<Word>,
}

impl<S: Source> Flow<S> {
    /// Before the first line.
    #[must_use]
    pub fn new(source: S, kept: Kept, rules: Rules) -> Self {
        Self {
            lines: Lines::new(source),
            variables: Variables::new(kept),
            rules,
            frames: vec![Frame::main()],
            at: Place::START,
            last: Place::START,
            depth: 0,
            started: false,
            over: false,
            idle: 0,
            memo: Memo::default(),
            text: Vec::new(),
            blanked: Vec::new(),
            words: Vec::new(),
        }
    }

    /// The variables.
    #[must_use]
    pub const fn variables(&self) -> &Variables {
        &self.variables
    }

    /// The line of the latest step.
    #[must_use]
    pub const fn line(&self) -> u32 {
        self.last.line
    }

    /// The text of the line of the latest step.
    ///
    /// # Errors
    /// The text cannot be read again.
    pub fn line_text(&mut self) -> io::Result<&[u8]> {
        let line = self.lines.line(self.last)?;
        Ok(line.map_or(&[], |line| line.text))
    }

    /// True where nothing more comes.
    #[must_use]
    pub const fn is_over(&self) -> bool {
        self.over
    }

    /// Carries out the next line, or the next block of one.
    ///
    /// # Errors
    /// What ends the program; there is no further step.
    pub fn step(&mut self, machine: &mut impl Machine) -> Result<(), Trouble> {
        if self.over {
            return Ok(());
        }
        self.last = self.at;
        let result = self.try_step(machine);
        self.over |= result.is_err();
        result
    }

    fn try_step(&mut self, machine: &mut impl Machine) -> Result<(), Trouble> {
        // After each block with a motion there may be a modal call.
        let by_lines = self.at.column == 0 && self.top().modals.is_empty();
        let Some(line) = self.lines.line(self.at)? else {
            return self.text_over(machine);
        };
        let next = line.next;
        if by_lines {
            let mut depth = self.depth;
            if let Glance::Plain(until) = glance(line.text, &mut depth) {
                let text = &line.text[..until];
                let begins = !self.started && has_blocks(text, self.depth);
                let done = machine.line(self.at.line, text)?;
                if begins {
                    self.start(self.at);
                }
                (self.at, self.depth) = (next, depth);
                self.idle = self.idle.saturating_add(1);
                self.note(done);
                return Ok(());
            }
        }
        let mut text = std::mem::take(&mut self.text);
        text.clear();
        text.extend_from_slice(line.text);
        let result = self.block(&text, next, machine);
        self.text = text;
        result
    }

    /// Carries out the next block of a line.
    fn block(
        &mut self,
        text: &[u8],
        next: Place,
        machine: &mut impl Machine,
    ) -> Result<(), Trouble> {
        if self.depth > 0 {
            // The comment is the core's: it tells where one without an end begins.
            let end = comment_end(text, 0, self.depth);
            machine.line(self.at.line, &text[..end.unwrap_or(text.len())])?;
            match end {
                Ok(after) => (self.at.column, self.depth) = (after, 0),
                Err(depth) => {
                    (self.at, self.depth) = (next, depth);
                    return Ok(());
                }
            }
        }
        if text.len() > MAX_LINE {
            let place = span(self.at.line, MAX_LINE, MAX_LINE + 1);
            let limit = [Arg::Int(MAX_LINE as i64)];
            return Err(Alarm::new(Code::LineTooLong, place).with(limit).into());
        }
        let here = self.at;
        let piece = piece(text, here.column);
        self.at = piece.next.map_or(next, |next| here.in_line(next));
        self.idle = self.idle.saturating_add(1);
        let mut cursor = Cursor::new(here.line, &text[..piece.end], here.column);
        // In front of everything else a `%` means nothing; after that it ends the text, which the core sees.
        while !self.started && cursor.take(b'%') {}
        if cursor.peek() == Some(b'%') {
            return self.plain(here, text, piece, machine);
        }
        let head = head(&mut cursor);
        let from = here.in_line(head.skipped.unwrap_or(here.column));
        let skipped = head.skipped.is_some() && self.rules.skip;
        let kind = if skipped {
            Statement::Empty
        } else {
            statement(&mut cursor)
        };
        if !skipped && matches!(kind, Statement::Plain | Statement::Empty) {
            if kind == Statement::Plain || head.sequence.is_some() {
                self.start(here);
            }
            return self.plain(from, text, piece, machine);
        }
        if let Some((open, _)) = piece.open {
            let place = span(here.line, open, open + 1);
            return Err(Alarm::new(Code::CommentOpen, place).into());
        }
        if skipped {
            return Ok(());
        }
        let sequence = sequence(&head, here.line, text);
        if let Statement::Program(number) = kind {
            if !self.opens(number, here, machine, &cursor, sequence)? {
                return self.program_over(&cursor, machine);
            }
            // What else stands in the block is carried out like a block of its own.
            let from = here.in_line(cursor.at());
            return match statement(&mut cursor) {
                Statement::Empty => Ok(()),
                Statement::Plain => self.plain(from, text, piece, machine),
                kind => self.macro_block(kind, here, cursor, None, machine),
            };
        }
        self.start(here);
        self.macro_block(kind, here, cursor, sequence, machine)
    }

    /// Carries out a block in which something has to be calculated or called.
    fn macro_block(
        &mut self,
        kind: Statement,
        here: Place,
        mut cursor: Cursor<'_>,
        sequence: Option<Word>,
        machine: &mut impl Machine,
    ) -> Result<(), Trouble> {
        if kind == Statement::Words {
            let mut words = std::mem::take(&mut self.words);
            words.clear();
            words.extend(sequence);
            let result = self.words(&mut cursor, &mut words, machine);
            self.words = words;
            return result;
        }
        if let Some(word) = sequence {
            machine.words(here.line, &[word])?;
        }
        match kind {
            Statement::Assign => self.assign(&mut cursor, machine)?,
            Statement::If => self.branch(&mut cursor, machine)?,
            Statement::Goto => self.go_to(&mut cursor, machine)?,
            Statement::While | Statement::Do => {
                self.begin_loop(kind, &mut cursor, here, machine)?
            }
            Statement::End => self.end_loop(&mut cursor)?,
            // A second number of a program in one block.
            _ => return Err(cursor.alarm(Code::MacroStatement).into()),
        }
        Ok(())
    }

    /// `#i = …`
    fn assign(&mut self, cursor: &mut Cursor<'_>, machine: &mut impl Machine) -> Result<(), Alarm> {
        cursor.skip();
        let from = cursor.at();
        let mut scope = Scope {
            variables: &mut self.variables,
            system: machine,
        };
        let (number, place) = Calculator::new(cursor, &mut scope).variable()?;
        if !cursor.take(b'=') {
            return Err(cursor.alarm(Code::MacroStatement));
        }
        let value = Calculator::new(cursor, &mut scope).sum()?;
        let all = cursor.span_from(from);
        ended(cursor)?;
        match number {
            ALARM => {
                let number = value.whole().unwrap_or(0).clamp(0, 999);
                let figure = [Arg::Int(ALARM + number)];
                Err(Alarm::new(Code::ProgramAlarm, all).with(figure))
            }
            STOP => {
                let word = Word {
                    letter: b'M',
                    given: Given::Calculated(Value::Number(0.0)),
                    variable: None,
                    span: all,
                };
                let done = machine.words(cursor.line(), &[word])?;
                self.note(done);
                Ok(())
            }
            _ => scope.assign(number, value, place),
        }
    }

    /// Words, some of which have to be calculated, or which call.
    fn words(
        &mut self,
        cursor: &mut Cursor<'_>,
        words: &mut Vec<Word>,
        machine: &mut impl Machine,
    ) -> Result<(), Trouble> {
        let decimals: [u8; 26] =
            std::array::from_fn(|letter| machine.decimals(b'A' + letter as u8));
        let mut scope = Scope {
            variables: &mut self.variables,
            system: machine,
        };
        let of = |letter: u8| decimals[usize::from(letter - b'A') % 26];
        word::read(cursor, &mut scope, of, words)?;
        if self.call(cursor.line(), words, machine)? {
            return Ok(());
        }
        let done = machine.words(cursor.line(), words)?;
        self.done(done)
    }

    /// Hands a block to the machine as text, in its columns.
    fn plain(
        &mut self,
        from: Place,
        text: &[u8],
        piece: Piece,
        machine: &mut impl Machine,
    ) -> Result<(), Trouble> {
        self.depth = piece.open.map_or(0, |(_, depth)| depth);
        self.blanked.clear();
        self.blanked.resize(from.column, b' ');
        self.blanked
            .extend_from_slice(&text[from.column..piece.end]);
        let done = machine.line(from.line, &self.blanked)?;
        self.done(done)
    }

    /// The first block is the front of the program.
    fn start(&mut self, here: Place) {
        if !self.started {
            self.started = true;
            let main = &mut self.frames[0];
            (main.start, main.entry) = (here, here);
        }
    }

    /// Takes note of what a block did, and calls the macro of G66 after a motion.
    fn done(&mut self, done: Done) -> Result<(), Trouble> {
        self.note(done);
        if done.moved && !self.over {
            self.call_modal()?;
        }
        Ok(())
    }

    fn note(&mut self, done: Done) {
        if done.moved {
            self.idle = 0;
        }
        self.over |= done.ended;
    }

    /// The text has no more lines.
    fn text_over(&mut self, machine: &mut impl Machine) -> Result<(), Trouble> {
        self.over = true;
        // A comment that is still open is the cause of what else is missing.
        machine.finish()?;
        match self.frames.last() {
            Some(frame) if self.frames.len() > 1 => Err(frame.left_open(frame.called).into()),
            _ => Ok(()),
        }
    }

    /// Refuses to go on in a loop that has not moved anything for long.
    fn mind_budget(&self, span: Span) -> Result<(), Alarm> {
        if self.idle <= self.rules.budget {
            return Ok(());
        }
        let figure = [Arg::Int(i64::from(self.rules.budget))];
        Err(Alarm::new(Code::RunawayLoop, span).with(figure))
    }
}

/// The variable that raises an alarm, and the one that stops the program.
const ALARM: i64 = 3000;
const STOP: i64 = 3006;

/// N of a block as a word.
fn sequence(head: &Head, line: u32, text: &[u8]) -> Option<Word> {
    let (number, from, to) = head.sequence?;
    let text: Vec<u8> = text[from..to]
        .iter()
        .copied()
        .filter(u8::is_ascii_digit)
        .collect();
    debug_assert_eq!(Decimal::parse(&text).0.mantissa(), i64::from(number));
    Some(Word {
        letter: b'N',
        given: Given::Written(Decimal::parse(&text).0),
        variable: None,
        span: span(line, from, to),
    })
}

/// Refuses what stands after a statement.
fn ended(cursor: &mut Cursor<'_>) -> Result<(), Alarm> {
    match cursor.peek() {
        None => Ok(()),
        Some(b'A'..=b'Z' | b'#') => Err(cursor.alarm(Code::MacroAndWords)),
        Some(_) => Err(cursor.alarm(Code::Formula)),
    }
}
