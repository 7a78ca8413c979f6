//! Where a program begins and ends: its number, M99, and the next program.

use leadscrew_core::alarm::{Alarm, Code, Span};
use leadscrew_core::units::Decimal;

use super::calls::HIGHEST;
use super::{Flow, Machine, Trouble};
use crate::lines::{Place, Source};
use crate::word::{Given, Word};

impl<S: Source> Flow<S> {
    /// M99, with or without P.
    pub(super) fn return_from(
        &mut self,
        word: Word,
        to: Option<Word>,
        machine: &mut impl Machine,
    ) -> Result<(), Trouble> {
        let to = to.map(|to| Ok::<_, Alarm>((to.count(0, HIGHEST)?, to.span)));
        let to = to.transpose()?;
        if self.frames.len() == 1 {
            return self.main_again(word, to, machine);
        }
        let frame = self.top_mut();
        frame.loops.clear();
        if frame.left > 0 {
            frame.left -= 1;
            let called = frame.called;
            let (entry, arguments) = (frame.entry, frame.arguments.clone());
            self.turn(called)?;
            self.at = entry;
            if let Some(arguments) = arguments {
                self.variables.close();
                self.variables.open(&arguments);
            }
            return Ok(());
        }
        if let Some(frame) = self.frames.pop() {
            self.at = frame.back;
            if frame.arguments.is_some() {
                self.variables.close();
            } else {
                // A subprogram may begin and end modal calls of its caller.
                self.top_mut().modals = frame.modals;
            }
        }
        match to {
            Some((number, span)) => self.jump(i64::from(number), span),
            None => Ok(()),
        }
    }

    /// M99 in the main program.
    fn main_again(
        &mut self,
        word: Word,
        to: Option<(u32, Span)>,
        machine: &mut impl Machine,
    ) -> Result<(), Trouble> {
        let here = self.at;
        if let Some((number, span)) = to {
            self.jump(i64::from(number), span)?;
            // A jump ahead goes on in the same pass.
            if !self.at.is_before(here) {
                return Ok(());
            }
        }
        if self.rules.passes.go_on_after(self.pass) {
            self.mind_budget(word.span)?;
            self.pass = self.pass.wrapping_add(1);
            // What one pass may do, the next one may, too.
            self.turns = 0;
            if to.is_none() {
                let main = self.top_mut();
                main.loops.clear();
                self.at = main.entry;
            }
            return Ok(());
        }
        machine.note(word.alarm(Code::MainRepeats));
        self.over = true;
        machine.finish()?;
        Ok(())
    }

    /// True where the number of a program, written at `span` in the block at `here`, opens the one that runs.
    pub(super) fn opens(
        &mut self,
        number: u32,
        here: Place,
        span: Span,
        sequence: Option<Word>,
        machine: &mut impl Machine,
    ) -> Result<bool, Alarm> {
        if self.started {
            return Ok(self.top().start == here);
        }
        self.start(here);
        self.frames[0].number = number;
        let word = Word {
            letter: b'O',
            given: Given::Written(Decimal::new(i64::from(number), 0)),
            variable: None,
            span,
        };
        let words: Vec<Word> = sequence.into_iter().chain([word]).collect();
        machine.words(here.line, &words)?;
        Ok(true)
    }

    /// Another program begins at `span`: this one is over.
    pub(super) fn program_over(
        &mut self,
        span: Span,
        machine: &mut impl Machine,
    ) -> Result<(), Trouble> {
        if self.frames.len() > 1 {
            return Err(self.top().left_open(span).into());
        }
        self.over = true;
        machine.finish()?;
        Ok(())
    }
}
