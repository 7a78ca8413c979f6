//! Lines in, events out: the sans-IO driver of lexer, block and modal state.

use super::carried::Carried;
use super::in_force::InForce;
use super::motion::Way;
use super::state::State;
use crate::alarm::{Alarm, Code, Span};
use crate::call::{Call, CallKind, Position, ThreadCycle};
use crate::cycle::rigid_code;
use crate::offsets::{Offsets, Source};
use crate::params::Params;
use crate::text::{
    Block, Comment, Cursor, Dialect, Ended, Event, Known, MGroup, Options, Plan, m_code,
};
use crate::units::Decimal;

/// Reads a program line by line and resolves all of its modal meaning. Memory is bounded by one line.
///
/// An alarm ends the program: it comes before any call of its own block, after all calls of the blocks before. What
/// follows M02, M30 or the closing `%` is not read.
#[derive(Clone, Debug)]
pub struct Interpreter<'p> {
    state: State<'p>,
    block: Block,
    comment: Comment,
    plan: Plan,
    /// A stroke of G32, until it is known whether another one is joined to it.
    held: Option<Call>,
    failed: bool,
    closed: bool,
}

impl<'p> Interpreter<'p> {
    /// The power-on state, the machine standing at `options.position`.
    #[must_use]
    pub fn new(params: &'p Params, options: Options) -> Self {
        Self {
            state: State::new(params, options),
            block: Block::new(rigid_code(params)),
            comment: Comment::default(),
            plan: Plan::new(),
            held: None,
            failed: false,
            closed: false,
        }
    }

    /// What offsets are read from.
    #[must_use]
    pub const fn offsets(&self) -> Source<'_> {
        self.state.modal.offsets()
    }

    /// The table that the program has written to by G10; `None` where it has not.
    #[must_use]
    pub fn written_offsets(&self) -> Option<&Offsets> {
        let table = self.state.modal.options.offsets.as_ref();
        table.filter(|_| self.state.offsets_written.0 > 0)
    }

    /// How often the program has written offsets, and where it did so last: whoever keeps what it has read of them reads
    /// again when this changes.
    #[must_use]
    pub const fn offsets_writes(&self) -> (u32, Span) {
        self.state.offsets_written
    }

    /// Puts in force what the text before has left, and makes no call of it. This is for the start, before the first line.
    pub fn carry(&mut self, carried: &Carried) {
        self.state.carry(carried);
    }

    /// What the lines so far leave in force for the next text.
    #[must_use]
    pub fn carried(&self) -> Carried {
        self.state.carried()
    }

    /// Takes in one line, with or without its line ending, and hands what it yields to `out`. `line` is its number in
    /// the file, from 1.
    ///
    /// # Errors
    /// The alarm that ends the program; lines after it yield nothing.
    #[inline]
    pub fn line(
        &mut self,
        text: &[u8],
        line: u32,
        out: &mut impl FnMut(Event),
    ) -> Result<(), Alarm> {
        let mut cursor = Cursor::new(without_mark(text, line), line);
        self.read_line(&mut cursor, out)?;
        if cursor.is_done() || self.is_ended() {
            return Ok(());
        }
        self.failed = true;
        Err(Alarm::new(Code::UnknownCharacter, cursor.here()))
    }

    /// Takes in one block of line `line` as words: a capital letter, a number and a place for each. This is for a reader
    /// that has calculated the numbers; the rules for them are those of a text.
    ///
    /// # Errors
    /// The alarm that ends the program; blocks after it yield nothing.
    pub fn words(
        &mut self,
        line: u32,
        words: impl IntoIterator<Item = (u8, Decimal, Span)>,
        out: &mut impl FnMut(Event),
    ) -> Result<(), Alarm> {
        self.plan.clear();
        if self.is_ended() {
            return Ok(());
        }
        if let Err(alarm) = self.try_words(line, words) {
            self.failed = true;
            self.plan.clear();
            self.release(out);
            return Err(alarm);
        }
        while let Some(event) = self.next_event() {
            out(event);
        }
        Ok(())
    }

    fn try_words(
        &mut self,
        line: u32,
        words: impl IntoIterator<Item = (u8, Decimal, Span)>,
    ) -> Result<(), Alarm> {
        self.block.clear(line);
        for (letter, value, place) in words {
            self.block.add(letter, value, place.column, place.end)?;
        }
        if !self.block.is_empty() {
            self.state.run(&self.block, &mut self.plan)?;
        }
        Ok(())
    }

    /// Takes in one move that a reader has calculated, from where the machine stands. Feed, dry run and origin in force
    /// hold for it.
    ///
    /// # Errors
    /// The move cuts and no feed is set. The program ends with the alarm.
    pub fn trace(
        &mut self,
        span: Span,
        to: Position,
        way: Way,
        out: &mut impl FnMut(Event),
    ) -> Result<(), Alarm> {
        if self.is_ended() {
            return Ok(());
        }
        self.release(out);
        match self.state.trace(span, to, way) {
            Ok(call) => {
                out(Event::Call(call));
                Ok(())
            }
            Err(alarm) => {
                self.failed = true;
                Err(alarm)
            }
        }
    }

    /// Reads on from `cursor` to the end of its line.
    #[inline]
    pub(super) fn read_line(
        &mut self,
        cursor: &mut Cursor<'_>,
        out: &mut impl FnMut(Event),
    ) -> Result<(), Alarm> {
        loop {
            let read = self.read_block(cursor);
            if read.is_err() {
                self.release(out);
            }
            let more = read?;
            while let Some(event) = self.next_event() {
                out(event);
            }
            if !more {
                return Ok(());
            }
        }
    }

    /// Reads one block into the plan; false where the line ends with it.
    #[inline]
    pub(super) fn read_block(&mut self, cursor: &mut Cursor<'_>) -> Result<bool, Alarm> {
        self.plan.clear();
        if self.is_ended() {
            return Ok(false);
        }
        match self.try_block(cursor) {
            Ok(more) => Ok(more),
            Err(alarm) => {
                self.failed = true;
                self.plan.clear();
                Err(alarm)
            }
        }
    }

    #[inline]
    fn try_block(&mut self, cursor: &mut Cursor<'_>) -> Result<bool, Alarm> {
        let skip = self.state.modal.options.skip;
        let start = !self.state.started;
        let ended = cursor.block(&mut self.block, &mut self.comment, skip, start)?;
        if !self.block.is_empty() {
            self.state.run(&self.block, &mut self.plan)?;
        }
        self.closed = ended == Ended::Text;
        Ok(ended == Ended::Block)
    }

    /// The next event of the block that was read, or of one before it: a stroke waits for what follows it.
    #[inline]
    pub(super) fn next_event(&mut self) -> Option<Event> {
        if self.held.is_some() && self.plan.has_call() {
            return self.take_held(self.plan.is_joined()).map(Event::Call);
        }
        match self.plan.next()? {
            Event::Call(call) if is_stroke(&call) => {
                self.held = Some(call);
                self.plan.next()
            }
            event => Some(event),
        }
    }

    /// The stroke that waits. Where another one is joined to it, it goes on and has no run-out.
    #[cold]
    pub(super) fn take_held(&mut self, goes_on: bool) -> Option<Call> {
        let mut held = self.held.take()?;
        if let CallKind::Thread(thread) = &mut held.kind
            && goes_on
        {
            thread.part = thread.part.with_next();
            thread.run_out = None;
        }
        Some(held)
    }

    /// Hands over a stroke that waits for what follows it: nothing is joined to it.
    pub fn release(&mut self, out: &mut impl FnMut(Event)) {
        if let Some(held) = self.take_held(false) {
            out(Event::Call(held));
        }
    }

    /// Says that the text is over.
    ///
    /// # Errors
    /// A comment that was never closed, a tap that was left in its hole.
    pub fn finish(&mut self, out: &mut impl FnMut(Event)) -> Result<(), Alarm> {
        self.release(out);
        self.refuse_open()
    }

    /// What may not be open at the end of the text.
    pub(super) fn refuse_open(&self) -> Result<(), Alarm> {
        if !self.failed {
            self.state.tapping.refuse_left()?;
        }
        match self.comment.open() {
            Some(span) if !self.is_ended() => Err(Alarm::new(Code::CommentOpen, span)),
            _ => Ok(()),
        }
    }

    /// True after M02, M30, the closing `%` or an alarm: nothing more is read.
    #[inline]
    #[must_use]
    pub const fn is_ended(&self) -> bool {
        self.state.ended || self.closed || self.failed
    }

    /// Reads the words of the lines that follow as this family of controls does; what is in force stays.
    pub const fn read_as(&mut self, dialect: Dialect) {
        self.state.modal.options.dialect = dialect;
    }

    /// Threads of the lines that follow have a run-out by parameter, or none but that of their words.
    pub const fn run_out_by_words_alone(&mut self, alone: bool) {
        self.state.modal.without_run_out = alone;
    }

    /// Taps of the lines that follow end at R, or at the initial level.
    pub const fn taps_end_at_r(&mut self, at_r: bool) {
        self.state.modal.taps_end_at_r = at_r;
    }

    /// The latest M code is one that was taken out of the text.
    pub const fn heard(&mut self, code: u16) {
        self.state.m = Some(code);
    }

    /// The M code of rigid tapping.
    #[must_use]
    pub fn rigid_code(&self) -> u8 {
        rigid_code(self.state.modal.params)
    }

    /// Where the machine stands after the blocks so far.
    #[must_use]
    pub const fn position(&self) -> Position {
        self.state.modal.position
    }

    /// What the blocks so far have set.
    #[must_use]
    pub fn in_force(&self) -> InForce {
        self.state.in_force()
    }

    /// True after G20: the program's lengths are inches.
    #[must_use]
    pub const fn is_inch(&self) -> bool {
        self.state.modal.scale.is_inch()
    }

    /// The program's O-number, if it has one.
    #[must_use]
    pub const fn program_number(&self) -> Option<u32> {
        self.state.program
    }

    /// N of the latest block that has one.
    #[must_use]
    pub const fn sequence_number(&self) -> Option<u32> {
        self.state.sequence
    }
}

/// True for a stroke to which another one can be joined.
fn is_stroke(call: &Call) -> bool {
    matches!(&call.kind, CallKind::Thread(thread) if thread.cycle == ThreadCycle::G32)
}

/// True for an M code without a meaning of its own, which may clamp an axis.
#[must_use]
pub fn is_free_m(code: i64) -> bool {
    // No code is that of rigid tapping here: a drilling block does not begin it.
    (0..=999).contains(&code)
        && matches!(m_code(code, u8::MAX), Known::Yes(MGroup::Clamp))
        && code != 29
}

/// The first line without the byte order mark some editors put there.
#[inline]
pub(super) fn without_mark(text: &[u8], line: u32) -> &[u8] {
    match text {
        [0xEF, 0xBB, 0xBF, rest @ ..] if line == 1 => rest,
        _ => text,
    }
}
