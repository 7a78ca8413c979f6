//! A program that the board runs by itself. Its calls are handed over as there is room.

use std::path::Path;

use leadscrew_common::failure::{Doing, Failure, Outcome};
use leadscrew_common::program::{Begin, Program};
use leadscrew_common::source::SourceFile;
use leadscrew_core::alarm::Alarm;
use leadscrew_core::board::Board;
use leadscrew_core::call::{Call, Position};
use leadscrew_core::params::Params;
use leadscrew_core::program::{Event, Options};

/// The source of a board's calls.
pub struct Feeder {
    source: SourceFile,
    program: Program<'static>,
    next: Option<Call>,
    over: bool,
}

impl Feeder {
    /// Opens a program, for a tool at this position.
    pub fn open(path: &Path, params: &Params, position: Position) -> Outcome<Self> {
        let source = SourceFile::new(path);
        // Leaked once for the life of the process.
        let params: &'static Params = Box::leak(Box::new(params.clone()));
        let begin = Begin {
            options: Options {
                position,
                ..Options::default()
            },
            ..Begin::default()
        };
        let program = Program::open(&source, params, begin)
            .map_err(|error| Failure::file(Doing::Read, path.display(), &error))?;
        Ok(Self {
            source,
            program,
            next: None,
            over: false,
        })
    }

    /// The text of the program.
    pub const fn source(&self) -> &SourceFile {
        &self.source
    }

    /// Hands over as many calls as there is room for; true where it handed over any.
    ///
    /// # Errors
    /// The text is wrong from here on.
    pub fn feed(&mut self, board: &mut Board) -> Result<bool, Alarm> {
        let mut fed = false;
        loop {
            if self.next.is_none() && !self.over {
                self.next = self.read()?;
            }
            match &self.next {
                Some(call) if board.offer(call) => {
                    self.next = None;
                    fed = true;
                }
                _ => return Ok(fed),
            }
        }
    }

    fn read(&mut self) -> Result<Option<Call>, Alarm> {
        loop {
            match self.program.next_event() {
                Ok(Some(Ok(Event::Call(call)))) => return Ok(Some(call)),
                Ok(Some(Ok(Event::Warning(_)))) => {}
                Ok(Some(Err(alarm))) => {
                    self.over = true;
                    return Err(alarm);
                }
                // A file that cannot be read any further ends here.
                Ok(None) | Err(_) => {
                    self.over = true;
                    return Ok(None);
                }
            }
        }
    }

    /// True where the whole program was handed over.
    pub const fn is_over(&self) -> bool {
        self.over && self.next.is_none()
    }
}
