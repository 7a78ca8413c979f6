//! Reads the calls of a checked program in order, for any machine.

use std::collections::VecDeque;

use leadscrew_core::alarm::{Alarm, Span};
use leadscrew_core::call::{Call, CallKind, Position};
use leadscrew_core::offsets::Offsets;
use leadscrew_core::program::{Carried, Event};
use leadscrew_language::variables::Kept;

use crate::diagnostics::Diagnostic;
use crate::failure::{Doing, Failure, Outcome};
use crate::program::{Begin, Program};
use crate::setup::Setup;
use crate::source::SourceFile;
use crate::start;
use crate::words::both;

/// The end of the text.
const OVER: Call = Call {
    span: Span {
        line: 0,
        column: 0,
        end: 0,
    },
    origin: Position::ZERO,
    kind: CallKind::Over,
};

/// A program being handed over.
#[derive(Debug)]
pub struct Feeder<'a> {
    setup: &'a Setup<'a>,
    source: &'a SourceFile,
    program: Program<'a>,
    /// The programs before this one, where it is started at a line.
    lead: VecDeque<VecDeque<Call>>,
    /// G61 of the lines that were skipped, until it is handed over.
    exact: bool,
    /// M02 or M30 has been read.
    ended: bool,
    over: bool,
}

impl<'a> Feeder<'a> {
    /// Opens the program.
    ///
    /// # Errors
    /// A file that cannot be read, or that has changed since its start at a line was found.
    pub fn new(setup: &'a Setup, source: &'a SourceFile) -> Outcome<Self> {
        let begin = Begin {
            passes: setup.passes,
            ..setup.begin()
        };
        let cannot = |error| Failure::file(Doing::Read, source.name(), &error);
        let mut program = Program::open(source, &setup.params, begin).map_err(cannot)?;
        let mut lead = VecDeque::new();
        if let Some(start) = &setup.from {
            // It has been found before, in a file that another program may have written since.
            let found = program.start_at(start.line).map_err(cannot)?;
            if !found.is_ok_and(|found| found == *start) {
                return Err(Failure::WrongBecause(both!(
                    "not begun: the program has changed since this start was found: look at it again; nothing has moved",
                    "未开始：找到此起点之后程序已改变：请重新查看；机床未移动"
                )));
            }
            lead = start::lead(start, setup);
        }
        Ok(Self {
            setup,
            source,
            program,
            lead,
            exact: setup.from.as_ref().is_some_and(|start| start.exact),
            ended: false,
            over: false,
        })
    }

    /// The next program may begin only with the spindle at its speed.
    #[must_use]
    pub fn awaits_spindle(&self) -> bool {
        self.setup.from.is_some() && self.lead.len() == 1
    }

    /// Begins the next pass of a main program that repeats itself. Its calls are a program of their own, so that the
    /// machine has carried out one pass before the next begins; so are those that lead to the start at a line. False where
    /// none follows.
    pub fn next_pass(&mut self) -> bool {
        if self.lead.pop_front().is_some() {
            self.over = false;
            return true;
        }
        let follows = self.program.is_between_passes();
        if follows {
            self.program.begin_pass();
            (self.ended, self.over) = (false, false);
        }
        follows
    }

    /// True where there is no further call of this pass.
    #[must_use]
    pub const fn is_over(&self) -> bool {
        self.over
    }

    /// The variables that outlive the program, as its last block has left them.
    #[must_use]
    pub const fn variables(&self) -> &Kept {
        self.program.kept()
    }

    /// The table that the program has written to by G10, as its last block has left it; `None` where it has not.
    #[must_use]
    pub fn written_offsets(&self) -> Option<&Offsets> {
        self.program.written_offsets()
    }

    /// What the text leaves in force for the next one; `None` after M02 or M30, which end it all.
    #[must_use]
    pub fn carried(&self) -> Option<Carried> {
        (!self.ended).then(|| self.program.carried())
    }

    /// Words for an alarm or a warning of the machine.
    #[must_use]
    pub fn words(&self, alarm: &Alarm) -> Diagnostic {
        Diagnostic::new(alarm, self.source, self.setup.lang, self.program.is_inch())
    }

    /// The next call. If the program does not end itself, the last call says that the text is over. Mistakes that the text
    /// has after all go to `alarms`.
    ///
    /// # Errors
    /// A file that cannot be read any further.
    pub fn next_call(&mut self, alarms: &mut Vec<Diagnostic>) -> Outcome<Option<Call>> {
        if !self.over
            && let Some(program) = self.lead.front_mut()
        {
            let next = program.pop_front();
            self.over = next.is_none();
            return Ok(next);
        }
        if !self.over && std::mem::take(&mut self.exact) {
            let kind = CallKind::ExactStop(true);
            return Ok(Some(Call { kind, ..OVER }));
        }
        while !self.over {
            let next = self
                .program
                .next_event()
                .map_err(|error| Failure::file(Doing::Read, self.source.name(), &error))?;
            match next {
                None => {
                    self.over = true;
                    // Without M02 or M30 this call tells the board that no more calls come.
                    let kind = match self.setup.carried {
                        Some(_) => CallKind::LineOver,
                        None => CallKind::Over,
                    };
                    return Ok((!self.ended).then_some(Call { kind, ..OVER }));
                }
                Some(Ok(Event::Call(call))) => {
                    self.ended = matches!(call.kind, CallKind::End(_));
                    return Ok(Some(call));
                }
                // Reported when the program was checked.
                Some(Ok(Event::Warning(_))) => {}
                Some(Err(alarm)) => {
                    self.over = true;
                    alarms.push(self.words(&alarm));
                }
            }
        }
        Ok(None)
    }
}

/// Gives an alarm without a place in the text the line that was being carried out.
#[must_use]
pub fn placed(mut alarm: Alarm, line: u32) -> Alarm {
    if alarm.span.line == 0 {
        alarm.span = Span {
            line,
            column: 1,
            end: u16::MAX,
        };
    }
    alarm
}
