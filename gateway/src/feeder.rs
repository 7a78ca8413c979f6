//! The calls of a checked program one after the other, for whatever machine takes them.

use leadscrew_core::alarm::{Alarm, Span};
use leadscrew_core::program::{Call, CallKind, Event, Position};

use crate::diagnostics::Diagnostic;
use crate::failure::{Doing, Failure, Outcome};
use crate::program::Program;
use crate::setup::Setup;
use crate::source::SourceFile;

/// The text is over.
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
    /// M02 or M30 has come.
    ended: bool,
    over: bool,
}

impl<'a> Feeder<'a> {
    /// Opens the program.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn new(setup: &'a Setup, source: &'a SourceFile) -> Outcome<Self> {
        Ok(Self {
            setup,
            source,
            program: Program::open(source, &setup.params, setup.options())
                .map_err(|error| Failure::file(Doing::Read, source.name(), &error))?,
            ended: false,
            over: false,
        })
    }

    /// No further call comes.
    #[must_use]
    pub const fn is_over(&self) -> bool {
        self.over
    }

    /// An alarm or a warning of the machine in words.
    #[must_use]
    pub fn words(&self, alarm: &Alarm) -> Diagnostic {
        Diagnostic::new(alarm, self.source, self.setup.lang, self.program.is_inch())
    }

    /// The next call; the last one says that the text is over, where the program does not say so itself. What the text
    /// has wrong after all goes to `alarms`.
    ///
    /// # Errors
    /// A file that cannot be read any further.
    pub fn next_call(&mut self, alarms: &mut Vec<Diagnostic>) -> Outcome<Option<Call>> {
        while !self.over {
            let next = self
                .program
                .next_event()
                .map_err(|error| Failure::file(Doing::Read, self.source.name(), &error))?;
            match next {
                None => {
                    self.over = true;
                    // Without M02 or M30 nobody else tells the board that nothing more comes.
                    return Ok((!self.ended).then_some(OVER));
                }
                Some(Ok(Event::Call(call))) => {
                    self.ended = matches!(call.kind, CallKind::End(_));
                    return Ok(Some(call));
                }
                // Told when the program was checked.
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

/// An alarm that has no place in the text happened while `line` was carried out.
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
