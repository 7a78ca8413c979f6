//! Program flow: which block comes next.
//!
//! Carries out assignments, jumps, loops and calls; everything else goes to a [`Machine`]. A line without any of these
//! goes there as a whole, unchanged. Memory is bounded: one window of the text, whatever files it comes from, sixteen
//! calls, three loops in each. A loop without a motion ends with an alarm. This module must not know what words mean.

mod block;
mod calls;
mod contours;
mod frame;
mod jumps;
mod main_program;
mod returns;
mod search;
#[cfg(test)]
mod tests;

use std::collections::HashMap;
use std::io;
use std::num::NonZeroU32;

use leadscrew_core::alarm::{Alarm, Arg, Code, Span};

use crate::dialect::{Control, Setting, Translator};
use crate::heading::Allowed;
use crate::lines::{Lines, Place, Source};
use crate::outline::behind_leader;
use crate::roughing::Cycle;
use crate::stock::Stock;
use crate::text::{Glance, glance, has_blocks, span};
use crate::variables::{Kept, System, Variables};
use crate::whose::{self, Whose};
use crate::word::Word;
use frame::Frame;
use search::Memo;

/// What a block did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Done {
    /// An axis moves.
    pub moved: bool,
    /// The program has ended itself.
    pub ended: bool,
}

/// What is in force that no word of system A says.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Modes {
    /// G91 of the systems B and C.
    pub incremental: bool,
    /// G99 of the systems B and C: a hole ends at its level R.
    pub returns_to_r: bool,
    /// M24 of a Haas: threads have no run-out.
    pub without_run_out: bool,
    /// G66: a macro is called after each motion.
    pub calls: bool,
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

    /// What is in force for the next block.
    fn setting(&self) -> Setting {
        Setting::default()
    }

    /// Plain lines, too, come as words: a cycle is in force whose words the core does not know.
    fn wants_words(&self) -> bool {
        false
    }

    /// What the blocks so far have set that is none of the machine's.
    fn follow(&mut self, modes: Modes) {
        let _ = modes;
    }

    /// The latest M code is one that the machine does not see.
    fn heard(&mut self, code: u16) {
        let _ = code;
    }

    /// Tells the operator something.
    fn note(&mut self, warning: Alarm);

    /// A first line of G71, G72 or G73: the words of the cycle alone.
    ///
    /// # Errors
    /// The alarm that ends the program.
    fn first_line(&mut self, cycle: Cycle, words: &[Word]) -> Result<(), Alarm>;

    /// A contour cycle begins. The blocks that come until [`contour_ends`](Self::contour_ends) are its contour.
    ///
    /// # Errors
    /// The alarm that ends the program.
    fn contour_begins(&mut self, cycle: Cycle, words: &[Word], span: Span) -> Result<(), Alarm>;

    /// The contour is read: carries out its cycle.
    ///
    /// # Errors
    /// The alarm that ends the program.
    fn contour_ends(&mut self) -> Result<Done, Alarm>;

    /// The text is over, and the program has not ended itself.
    ///
    /// # Errors
    /// What may not be left open.
    fn finish(&mut self) -> Result<(), Alarm>;
}

/// How often a main program is carried out that begins itself again.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Passes {
    /// Once: who reads it is told that M99 would begin it again.
    #[default]
    Once,
    /// So many times, as was asked for.
    Number(NonZeroU32),
    /// Until somebody stops it.
    UntilStopped,
}

impl Passes {
    /// True where another pass follows the one with this number, from 1.
    const fn go_on_after(self, pass: u32) -> bool {
        match self {
            Self::Once => false,
            Self::Number(number) => pass < number.get(),
            Self::UntilStopped => true,
        }
    }
}

/// How a program is run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rules {
    /// The control that the program was written for, and each file of a subprogram that does not name another.
    pub control: Control,
    /// The stock that it declares.
    pub stock: Option<Stock>,
    /// Blocks with `/` in front are passed over.
    pub skip: bool,
    /// How often the main program is carried out where its M99 begins it again, or leads back. It ends with a note where
    /// M99 would begin one more pass.
    pub passes: Passes,
    /// Statements that a loop may carry out without a motion.
    pub budget: u32,
    /// How often the loops of a pass may begin again, whatever they move.
    pub turns: u32,
}

impl Default for Rules {
    fn default() -> Self {
        Self {
            control: Control::default(),
            stock: None,
            skip: false,
            passes: Passes::Once,
            budget: 1_000_000,
            turns: 1_000_000,
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

/// What the first lines of a subprogram's file say [D273].
#[derive(Clone, Copy, Debug)]
struct Own {
    control: Control,
    allowed: Allowed,
}

/// A program that runs.
#[derive(Debug)]
pub struct Flow<S> {
    lines: Lines<S>,
    variables: Variables,
    rules: Rules,
    translator: Translator,
    /// The files of subprograms that have been called: at most ten thousand.
    files: HashMap<Whose, Own>,
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
    /// Where the main program begins has been found.
    placed: bool,
    /// That numbers are rounded has been told.
    told_digits: bool,
    /// G of the latest thread that stands in one block.
    one_block: Option<Span>,
    over: bool,
    /// The next block belongs to the contour of a cycle.
    in_contour: bool,
    /// Statements since the last motion.
    idle: u32,
    /// How often a loop has begun again in this pass.
    turns: u32,
    /// The pass of the main program. After 2³² passes it counts from 0 again.
    pass: u32,
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
        let variables = Variables::new(kept);
        Self {
            lines: Lines::new(source),
            variables: match rules.control {
                Control::Gsk980td => variables.with_registers(),
                _ => variables,
            },
            rules,
            translator: Translator::new(rules.control),
            files: HashMap::new(),
            frames: vec![Frame::main()],
            at: Place::START,
            last: Place::START,
            depth: 0,
            started: false,
            placed: false,
            told_digits: false,
            one_block: None,
            over: false,
            in_contour: false,
            idle: 0,
            turns: 0,
            pass: 1,
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

    /// The control whose words the next block has: that of its file.
    #[must_use]
    pub fn control(&self) -> Control {
        match self.at.file() {
            Whose::Program => self.rules.control,
            file => self
                .files
                .get(&file)
                .map_or(self.rules.control, |own| own.control),
        }
    }

    /// The numbers that a subprogram's file silences; none of those of the program's own file.
    #[must_use]
    pub fn allowed(&self, file: Whose) -> Allowed {
        self.files
            .get(&file)
            .map_or(Allowed::NONE, |own| own.allowed)
    }

    /// The line of the latest step.
    #[must_use]
    pub const fn line(&self) -> u32 {
        self.last.line
    }

    /// G of the latest thread that stands in one block.
    #[must_use]
    pub const fn one_block(&self) -> Option<Span> {
        self.one_block
    }

    /// Puts in force what the text before has left, before the first step.
    pub const fn carry(&mut self, modes: Modes) {
        self.translator.carry(modes);
    }

    /// A subprogram is under way.
    #[must_use]
    pub const fn is_in_call(&self) -> bool {
        self.frames.len() > 1
    }

    /// The pass of the main program, from 1.
    #[must_use]
    pub const fn pass(&self) -> u32 {
        self.pass
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
        if let Whose::Subprogram(_) = self.at.file()
            && self.at.line == self.at.file().last_line()
        {
            let place = span(self.at.line, 0, 0);
            let limit = [Arg::Int(i64::from(whose::LINES - 1))];
            return Err(Alarm::new(Code::SubprogramLong, place).with(limit).into());
        }
        self.translator.read_as(self.control());
        // After each block with a motion there may be a modal call.
        let by_lines = self.at.column == 0
            && self.top().modals.is_empty()
            && !self.in_contour
            && self.reads_plain(machine);
        if !self.started {
            self.at = behind_leader(&mut self.lines, self.at)?;
        }
        if !std::mem::replace(&mut self.placed, true)
            && let Some((main, told)) = self.main_behind()?
        {
            machine.note(told);
            self.at = main;
            return Ok(());
        }
        let Some(line) = self.lines.line(self.at)? else {
            return self.text_over(machine);
        };
        let next = line.next;
        if by_lines {
            let mut depth = self.depth;
            if let Glance::Plain(until) = glance(line.text, &mut depth) {
                let text = &line.text[..until];
                let begins = !self.started && has_blocks(text, self.depth);
                // A program that stands after a `%` does not begin at the front of its line.
                if !begins || !text.contains(&b'%') {
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
        }
        let mut text = std::mem::take(&mut self.text);
        text.clear();
        text.extend_from_slice(line.text);
        let result = self.block(&text, next, machine);
        self.text = text;
        result
    }

    /// The core may have a block as it is: it is one of a GSK, as those of the program are.
    fn reads_plain(&self, machine: &impl Machine) -> bool {
        let control = self.translator.control();
        control.is_gsk() && self.rules.control.is_gsk() && !machine.wants_words()
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

    /// What is in force for the machine.
    #[must_use]
    pub fn modes(&self) -> Modes {
        Modes {
            calls: !self.top().modals.is_empty(),
            ..self.translator.modes()
        }
    }

    /// Refuses to go on in a loop that has not moved anything for long.
    fn mind_budget(&self, span: Span) -> Result<(), Alarm> {
        within(self.idle, self.rules.budget, Code::RunawayLoop, span)
    }

    /// A loop, or a pass of a call, begins again.
    fn turn(&mut self, span: Span) -> Result<(), Alarm> {
        self.mind_budget(span)?;
        self.turns = self.turns.saturating_add(1);
        within(self.turns, self.rules.turns, Code::EndlessProgram, span)
    }
}

fn within(count: u32, limit: u32, code: Code, span: Span) -> Result<(), Alarm> {
    if count <= limit {
        return Ok(());
    }
    Err(Alarm::new(code, span).with([Arg::Int(i64::from(limit))]))
}
