//! GOTO, IF, and the loops WHILE … DO … END.

use leadscrew_core::alarm::{Alarm, Arg, Code, Span};

use super::block::ended;
use super::{Flow, Machine, Trouble};
use crate::expression::Calculator;
use crate::lines::{Place, Source};
use crate::statement::Statement;
use crate::text::Cursor;
use crate::variables::Scope;

/// A loop that the next block lies in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Loop {
    /// Its number: 1 to 3.
    pub(super) number: u8,
    /// The block of its DO.
    pub(super) place: Place,
    /// The number of its DO.
    pub(super) span: Span,
}

impl<S: Source> Flow<S> {
    /// IF, from its bracket on.
    pub(super) fn branch(
        &mut self,
        cursor: &mut Cursor<'_>,
        machine: &mut impl Machine,
    ) -> Result<(), Trouble> {
        let holds = self.condition(cursor, machine)?;
        if cursor.take_word("GOTO") {
            if holds {
                self.go_to(cursor, machine)?;
            }
            return Ok(());
        }
        if !cursor.take_word("THEN") || cursor.peek() != Some(b'#') {
            return Err(cursor.alarm(Code::MacroStatement).into());
        }
        if holds {
            self.assign(cursor, machine)?;
        }
        Ok(())
    }

    fn condition(
        &mut self,
        cursor: &mut Cursor<'_>,
        machine: &mut impl Machine,
    ) -> Result<bool, Alarm> {
        let mut scope = Scope {
            variables: &mut self.variables,
            system: machine,
        };
        if cursor.peek() != Some(b'[') {
            return Err(cursor.alarm(Code::MacroStatement));
        }
        Calculator::new(cursor, &mut scope).condition()
    }

    /// GOTO, from its number on.
    pub(super) fn go_to(
        &mut self,
        cursor: &mut Cursor<'_>,
        machine: &mut impl Machine,
    ) -> Result<(), Trouble> {
        cursor.skip();
        let from = cursor.at();
        let mut scope = Scope {
            variables: &mut self.variables,
            system: machine,
        };
        let value = Calculator::new(cursor, &mut scope).sum()?;
        let span = cursor.span_from(from);
        ended(cursor)?;
        let number = value.whole().filter(|_| !value.is_null());
        let number = number.ok_or_else(|| no_label(0, span))?;
        self.jump(number, span)
    }

    /// Goes to the block with this N.
    pub(super) fn jump(&mut self, number: i64, span: Span) -> Result<(), Trouble> {
        let found = match u32::try_from(number) {
            Ok(number) => self.find_label(number, self.at)?,
            Err(_) => None,
        };
        let found = found.ok_or_else(|| no_label(number, span))?;
        if found.place.is_before(self.at) {
            self.turn(span)?;
        }
        self.at = found.place;
        self.top_mut().loops = found.loops;
        Ok(())
    }

    /// WHILE, from its bracket on, or DO, from its number on.
    pub(super) fn begin_loop(
        &mut self,
        kind: Statement,
        cursor: &mut Cursor<'_>,
        here: Place,
        machine: &mut impl Machine,
    ) -> Result<(), Trouble> {
        let mut holds = true;
        if kind == Statement::While {
            holds = self.condition(cursor, machine)?;
            if !cursor.take_word("DO") {
                return Err(cursor.alarm(Code::MacroStatement).into());
            }
        }
        let (number, span) = loop_number(cursor)?;
        let after = self.find_end(here, self.at, number, span)?;
        let loops = &mut self.top_mut().loops;
        if let Some(known) = loops.iter().position(|known| known.place == here) {
            loops.truncate(known);
        }
        if loops.iter().any(|outer| outer.number == number) {
            return Err(unmatched(number, span).into());
        }
        if holds {
            loops.push(Loop {
                number,
                place: here,
                span,
            });
        } else {
            self.at = after;
        }
        Ok(())
    }

    /// END, from its number on.
    pub(super) fn end_loop(&mut self, cursor: &mut Cursor<'_>) -> Result<(), Trouble> {
        let (number, span) = loop_number(cursor)?;
        match self.top().loops.last() {
            Some(inner) if inner.number == number => {
                let (place, span) = (inner.place, inner.span);
                self.turn(span)?;
                self.at = place;
                Ok(())
            }
            _ => Err(unmatched(number, span).into()),
        }
    }
}

/// The number of a loop, at the end of its statement.
fn loop_number(cursor: &mut Cursor<'_>) -> Result<(u8, Span), Alarm> {
    cursor.skip();
    let from = cursor.at();
    let digits = cursor.digits();
    let span = cursor.span_from(from);
    let number = std::str::from_utf8(digits)
        .ok()
        .and_then(|text| text.parse().ok());
    let Some(number @ 1..=3) = number else {
        return Err(Alarm::new(Code::LoopNumber, span));
    };
    ended(cursor)?;
    Ok((number, span))
}

/// The alarm of a DO or END without the other.
pub(super) fn unmatched(number: u8, span: Span) -> Alarm {
    Alarm::new(Code::LoopUnmatched, span).with([Arg::Int(i64::from(number))])
}

/// The alarm of a jump to nowhere.
pub(super) fn no_label(number: i64, span: Span) -> Alarm {
    Alarm::new(Code::JumpTarget, span).with([Arg::Int(number)])
}
