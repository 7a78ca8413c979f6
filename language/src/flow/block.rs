//! One block of a line: what it is, and who carries it out.

use leadscrew_core::alarm::{Alarm, Arg, Code};
use leadscrew_core::program::MAX_LINE;
use leadscrew_core::units::Decimal;

use super::{Flow, Machine, Trouble};
use crate::dialect::{Setting, digits, one_line};
use crate::expression::Calculator;
use crate::lines::{Place, Source};
use crate::roughing::Cycle;
use crate::statement::{Head, Statement, head, statement};
use crate::text::{Cursor, Piece, comment_end, piece, span};
use crate::value::Value;
use crate::variables::Scope;
use crate::word::{self, Given, Word};

impl<S: Source> Flow<S> {
    /// Carries out the next block of a line.
    pub(super) fn block(
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
        let mut behind = None;
        while !self.started && cursor.take(b'%') {
            behind = Some(cursor.at());
        }
        if cursor.peek() == Some(b'%') {
            return self.plain(here, text, piece, machine);
        }
        // The program begins behind it: there a second pass and a search for N go.
        let here = behind.map_or(here, |column| here.in_line(column));
        let head = head(&mut cursor);
        let from = here.in_line(head.numbered.unwrap_or(here.column));
        let skipped = head.skip && self.rules.skip;
        cursor.skip();
        let front = cursor.at();
        let kind = if skipped {
            Statement::Empty
        } else {
            self.statement(&mut cursor, machine)
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
            let place = cursor.span_from(front);
            if !self.opens(number, here, place, sequence, machine)? {
                return self.program_over(place, machine);
            }
            // What else stands in the block is carried out like a block of its own.
            let from = here.in_line(cursor.at());
            return match self.statement(&mut cursor, machine) {
                Statement::Empty => Ok(()),
                Statement::Plain => self.plain(from, text, piece, machine),
                kind => self.macro_block(kind, from, cursor, None, machine),
            };
        }
        self.start(here);
        self.macro_block(kind, here.in_line(front), cursor, sequence, machine)
    }

    /// What a block is. Only those of a GSK may be the core's as they are.
    fn statement(&self, cursor: &mut Cursor<'_>, machine: &impl Machine) -> Statement {
        match statement(cursor) {
            Statement::Plain if !self.reads_plain(machine) => Statement::Words,
            kind => kind,
        }
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
        machine.follow(self.modes());
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
        if self.in_contour && kind != Statement::Assign {
            let place = cursor.span_from(here.column);
            return Err(Alarm::new(Code::ContourFlow, place).into());
        }
        match kind {
            Statement::Assign => self.assign(&mut cursor, machine)?,
            Statement::If => self.branch(&mut cursor, machine)?,
            Statement::Goto => self.go_to(&mut cursor, machine)?,
            Statement::While | Statement::Do => {
                self.begin_loop(kind, &mut cursor, here, machine)?
            }
            Statement::End => self.end_loop(&mut cursor)?,
            Statement::Print => {
                let place = cursor.span_from(here.column);
                return Err(Alarm::new(Code::PrintStatement, place).into());
            }
            // A second number of a program in one block.
            _ => return Err(cursor.alarm(Code::MacroStatement).into()),
        }
        Ok(())
    }

    /// `#i = …`
    pub(super) fn assign(
        &mut self,
        cursor: &mut Cursor<'_>,
        machine: &mut impl Machine,
    ) -> Result<(), Alarm> {
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
        let now = machine.setting();
        let heard = self.translator.translate(words, now)?;
        self.translated(cursor, words, now, machine)?;
        if let Some(code) = heard {
            machine.heard(code);
        }
        Ok(())
    }

    /// Carries out the words of a block as they are in system A.
    fn translated(
        &mut self,
        cursor: &Cursor<'_>,
        words: &mut [Word],
        now: Setting,
        machine: &mut impl Machine,
    ) -> Result<(), Trouble> {
        digits::count(words, now)?;
        if !self.translator.control().is_gsk()
            && let Some(told) = digits::round(words, now)
            && !std::mem::replace(&mut self.told_digits, true)
        {
            machine.note(told);
        }
        machine.follow(self.modes());
        if let Some(blocks) = one_line::blocks(words, self.translator.control(), now)? {
            self.one_block = one_line::thread_word(words, self.translator.control());
            for block in &blocks {
                let done = machine.words(cursor.line(), block);
                let told = |alarm| match self.one_block {
                    Some(_) => one_line::as_written(alarm, words),
                    None => alarm,
                };
                self.done(done.map_err(told)?)?;
            }
            return Ok(());
        }
        if self.call(cursor.line(), words, machine)? {
            return Ok(());
        }
        let cycle = |(index, word): (usize, &Word)| Some((index, Cycle::of(word)?));
        if let Some((index, cycle)) = words.iter().enumerate().find_map(cycle) {
            return self.contour_cycle(cursor.line(), words, index, cycle, machine);
        }
        let done = machine.words(cursor.line(), words)?;
        self.done(done)
    }

    /// Hands a block to the machine as text, in its columns.
    pub(super) fn plain(
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
pub(super) fn ended(cursor: &mut Cursor<'_>) -> Result<(), Alarm> {
    match cursor.peek() {
        None => Ok(()),
        Some(b'A'..=b'Z' | b'#') => Err(cursor.alarm(Code::MacroAndWords)),
        Some(_) => Err(cursor.alarm(Code::Formula)),
    }
}
