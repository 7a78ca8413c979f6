//! A program that has been checked, call by call and move by move, without a machine. Where the tool stands and the hole
//! that a tap may be in go along.
//!
//! Must not know what the moves are for: a picture and the plan of a measurement are made of them.

use leadscrew_core::call::{Call, Position};
use leadscrew_core::cycle;
use leadscrew_core::moves::Move;
use leadscrew_core::program::Event;
use leadscrew_core::units::Length;
use leadscrew_language::drilling::Kind as Drilling;
use leadscrew_language::stock::Stock;
use leadscrew_verification::Hole;

use crate::failure::{Doing, Failure, Outcome};
use crate::movelist;
use crate::program::Program;
use crate::setup::Setup;
use crate::source::SourceFile;

/// A walk through a program.
#[derive(Debug)]
pub struct Walk<'s> {
    setup: &'s Setup<'s>,
    source: &'s SourceFile,
    program: Program<'s>,
    at: Position,
    hole: Hole,
}

impl<'s> Walk<'s> {
    /// Begins where the program of `setup` does.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn open(setup: &'s Setup<'s>, source: &'s SourceFile) -> Outcome<Self> {
        let program = Program::open(source, &setup.params, setup.begin());
        Ok(Self {
            setup,
            source,
            program: program.map_err(|error| unreadable(source, &error))?,
            at: setup.options().position,
            hole: Hole::new(setup.tap),
        })
    }

    /// The stock that the program declares.
    pub const fn stock(&self) -> Option<&Stock> {
        self.program.stock()
    }

    /// The work zero of a call whose zero with the tool is `origin`: without the tool that is in force after its block.
    pub fn work_zero(&self, origin: &Position) -> [Length; 2] {
        let tool = self.program.carried().offset;
        let [x, z] = self.program.offsets().tool(tool);
        [origin.x - x, origin.z - z]
    }

    /// Goes through the moves of the next call; `None` after the last call.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn next_call(&mut self, mut each: impl FnMut(&Call, &Move)) -> Outcome<Option<Call>> {
        self.next_with_drilling(|call, step, _| each(call, step))
    }

    /// As [`next_call`](Self::next_call), with the drilling cycle that the call is a move of.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn next_with_drilling(
        &mut self,
        mut each: impl FnMut(&Call, &Move, Option<Drilling>),
    ) -> Outcome<Option<Call>> {
        while let Some(Ok(event)) = self
            .program
            .next_event()
            .map_err(|error| unreadable(self.source, &error))?
        {
            let Event::Call(call) = event else { continue };
            // It has been checked: nothing is refused here.
            let Ok(moves) = cycle::expand(&call, &self.setup.context(self.at, &self.hole)) else {
                continue;
            };
            if self.hole.admit(&call, &moves).is_err() {
                continue;
            }
            let drilling = self.program.drilling(call.span);
            let in_one_block = self.program.is_in_one_block(call.span);
            for mut step in moves {
                movelist::name_as_written(&mut step, in_one_block);
                each(&call, &step, drilling);
                self.hole.push(&step);
                self.at = step.to;
            }
            return Ok(Some(call));
        }
        Ok(None)
    }
}

fn unreadable(source: &SourceFile, error: &std::io::Error) -> Failure {
    Failure::file(Doing::Read, source.name(), error)
}
