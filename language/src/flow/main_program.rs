//! Which program of a file is the main one: the first, unless it can only be a subprogram of one behind it [D367].

use std::io;

use leadscrew_core::alarm::{Alarm, Arg, Code, Span};

use super::Flow;
use crate::dialect::{Control, written};
use crate::lines::{Place, Source};
use crate::outline::{Outline, Scanner};
use crate::text::piece;
use crate::whose::Whose;

/// Blocks of a first program that is looked at: longer ones are no subprograms, and the text need not be held for them.
const BLOCKS: u32 = 2_000;

/// Blocks behind it that are looked at: a pipe can be read again up to a limit only.
const BEHIND: u32 = 100_000;

/// A program of the file.
#[derive(Clone, Copy)]
struct Program {
    number: u32,
    place: Place,
    span: Span,
}

/// What a block says of its program.
#[derive(Default)]
struct Signs {
    /// M30 or M02.
    ends: bool,
    /// M99.
    returns: bool,
    /// It calls the first program of the file.
    calls_first: bool,
}

impl Program {
    fn of(block: &Outline) -> Option<Self> {
        let (place, span) = (block.place, block.span);
        block.program.map(|number| Self {
            number,
            place,
            span,
        })
    }
}

impl<S: Source> Flow<S> {
    /// The front of the main program where it is not the first of the file, with what is to be told of it: the first one
    /// returns and has no end of its own, one behind it calls it, and the first behind it that has an end is the main one.
    pub(super) fn main_behind(&mut self) -> io::Result<Option<(Place, Alarm)>> {
        let mut scanner = Scanner::of(Whose::Program);
        let Some(first) = scanner
            .next(&mut self.lines)?
            .as_ref()
            .and_then(Program::of)
        else {
            return Ok(None);
        };
        let (mut blocks, mut returns) = (0, false);
        let mut here = loop {
            let Some(block) = scanner.next(&mut self.lines)? else {
                return Ok(None);
            };
            if let Some(next) = Program::of(&block) {
                break next;
            }
            let signs = self.signs(&block, first.number)?;
            blocks += 1;
            if signs.ends || blocks > BLOCKS {
                return Ok(None);
            }
            returns |= signs.returns;
        };
        if !returns {
            return Ok(None);
        }
        let (mut main, mut called) = (None, false);
        for _ in 0..BEHIND {
            let Some(block) = scanner.next(&mut self.lines)? else {
                break;
            };
            if let Some(next) = Program::of(&block) {
                here = next;
                continue;
            }
            let signs = self.signs(&block, first.number)?;
            called |= signs.calls_first;
            if signs.ends {
                main.get_or_insert(here);
            }
            if let (Some(main), true) = (main, called) {
                let number = [Arg::Int(i64::from(main.number))];
                let told = Alarm::new(Code::MainBehind, main.span).with(number);
                return Ok(Some((main.place, told)));
            }
        }
        Ok(None)
    }

    fn signs(&mut self, block: &Outline, first: u32) -> io::Result<Signs> {
        let Some(line) = self.lines.line(block.place)? else {
            return Ok(Signs::default());
        };
        let end = piece(line.text, block.place.column).end;
        let text = line.text.get(block.place.column..end).unwrap_or_default();
        let (mut signs, mut calls, mut called) = (Signs::default(), false, None);
        for (letter, number) in written(text) {
            match (letter, number) {
                (b'M', 2.0 | 30.0) => signs.ends = true,
                (b'M', 99.0) => signs.returns = true,
                (b'M', 98.0) | (b'G', 65.0 | 66.0) => calls = true,
                (b'P', number) => called = Some(number),
                _ => {}
            }
        }
        let first = f64::from(first);
        let passes_in_front = self.rules.control != Control::Haas;
        let is_first =
            |number: f64| number == first || (passes_in_front && number % 10_000.0 == first);
        signs.calls_first = calls && called.is_some_and(is_first);
        Ok(signs)
    }
}
