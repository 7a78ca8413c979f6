//! A program file as a stream of events, in bounded memory for any length. Macros, jumps and subprograms are carried out
//! on the way.

mod start;

use std::collections::VecDeque;
use std::io;

use leadscrew_core::alarm::{Alarm, Span};
use leadscrew_core::call::Position;
use leadscrew_core::offsets::{self, Offsets};
use leadscrew_core::params::Params;
use leadscrew_core::program::{Carried, Event, Options};
use leadscrew_language::dialect::Control;
use leadscrew_language::drilling::Kind as Drilling;
use leadscrew_language::flow::{Passes, Rules, Trouble};
use leadscrew_language::heading::{Allowed, Heading};
use leadscrew_language::lines::{Lines, Source};
use leadscrew_language::reader::Reader;
use leadscrew_language::stock::Stock;
use leadscrew_language::variables::Kept;
use leadscrew_language::whose::Whose;

use crate::failure::unreadable_part;
use crate::source::{SourceFile, Text};
pub use start::{Start, Unfit};

/// How often the loops of a line that goes on behind others may begin again: whoever has typed it waits for it.
const LINE_TURNS: u32 = 10_000;

/// What a program begins with.
#[derive(Clone, Debug, Default)]
pub struct Begin {
    /// How the core reads it.
    pub options: Options,
    /// The control that it was written for, if its first lines do not name another.
    pub control: Control,
    /// The variables that outlive a program.
    pub kept: Kept,
    /// How often a main program is carried out that begins itself again.
    pub passes: Passes,
    /// Numbers that the machine silences.
    pub allowed: Allowed,
    /// What the text before has left in force, if the program goes on behind one.
    pub carried: Option<Carried>,
}

/// A program being read.
#[derive(Debug)]
pub struct Program<'p> {
    reader: Reader<'p, Again>,
    /// Events of the last step that have not been taken yet.
    queue: VecDeque<Event>,
    /// Steps so far.
    steps: u64,
    /// The pass that the reader of events knows of.
    pass: u32,
    /// The alarm after the events in the queue.
    alarm: Option<Alarm>,
    /// Nothing is read at all.
    over: bool,
    /// Numbers that are not to be told: those of the machine, and of `(ALLOW …)`.
    allowed: Allowed,
    /// What `(STOCK …)` says.
    stock: Option<Stock>,
    /// The control, where the program does not name it.
    control: Option<Control>,
}

/// The files of a program, each read from any of its bytes.
#[derive(Debug)]
struct Again {
    source: SourceFile,
    /// The one that is read comes first, and the others in the order in which they were read last.
    open: Vec<Opened>,
}

/// A file that is open.
#[derive(Debug)]
struct Opened {
    file: Whose,
    text: Text,
    /// The byte that comes next.
    at: u64,
}

impl Again {
    /// Files that are open at a time: those of all calls that can be nested, and the program's.
    const FILES: usize = 17;

    fn open(source: &SourceFile) -> io::Result<Self> {
        Ok(Self {
            source: source.clone(),
            open: vec![Opened {
                file: Whose::Program,
                text: source.open()?,
                at: 0,
            }],
        })
    }
}

impl Source for Again {
    fn read(&mut self, at: u64, buffer: &mut [u8]) -> io::Result<usize> {
        let Some(opened) = self.open.first_mut() else {
            return Ok(0);
        };
        if at != opened.at {
            opened.text.go_to(at)?;
            opened.at = at;
        }
        let count = io::Read::read(&mut opened.text, buffer)?;
        opened.at += count as u64;
        Ok(count)
    }

    fn turn_to(&mut self, file: Whose) -> io::Result<bool> {
        if let Some(known) = self.open.iter().position(|opened| opened.file == file) {
            self.open[..=known].rotate_right(1);
            return Ok(true);
        }
        let Some(source) = self.source.beside(file) else {
            return Ok(false);
        };
        let text = match source.open() {
            Ok(text) => text,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(false),
            Err(error) => return Err(unreadable_part(&source.name(), &error)),
        };
        if self.open.len() >= Self::FILES {
            // The program's own file stays: a pipe can be opened once.
            let last = self
                .open
                .iter()
                .rposition(|opened| opened.file != Whose::Program);
            last.map(|last| self.open.remove(last));
        }
        self.open.insert(0, Opened { file, text, at: 0 });
        Ok(true)
    }
}

impl<'p> Program<'p> {
    /// Opens a file.
    pub fn open(source: &SourceFile, params: &'p Params, begin: Begin) -> io::Result<Self> {
        let Begin {
            options,
            control,
            kept,
            passes,
            allowed,
            carried,
        } = begin;
        let mut text = Again::open(source)?;
        let heading = Heading::read(&mut Lines::new(&mut text), Whose::Program)?;
        let mut rules = Rules {
            control: heading.control.unwrap_or(control),
            stock: heading.stock,
            passes,
            ..Rules::default()
        };
        if carried.is_some() {
            rules.turns = LINE_TURNS;
        }
        let mut reader = Reader::new(text, params, options, kept, rules);
        if let Some(carried) = &carried {
            reader.carry(carried);
        }
        Ok(Self {
            reader,
            queue: [heading.warning, heading.unknown]
                .into_iter()
                .flatten()
                .map(Event::Warning)
                .collect(),
            steps: 0,
            pass: 1,
            over: heading.alarm.is_some(),
            alarm: heading.alarm,
            allowed: allowed.and(heading.allowed),
            stock: heading.stock,
            control: heading.control.is_none().then_some(rules.control),
        })
    }

    /// The control that it is read for; `None` where it names this control itself.
    pub const fn assumed(&self) -> Option<Control> {
        self.control
    }

    /// The stock that the program declares.
    pub const fn stock(&self) -> Option<&Stock> {
        self.stock.as_ref()
    }

    /// True for an alarm, or a warning, that is not to be told: the machine silences it, or the file that was started, or
    /// the subprogram's file that its line is of [D273].
    #[must_use]
    pub fn allows(&self, alarm: &Alarm) -> bool {
        let own = self.reader.allowed(Whose::line(alarm.span.line));
        self.allowed.and(own).has(alarm.number())
    }

    /// The drilling cycle that the latest call, with this place in the text, is a move of.
    #[must_use]
    pub fn drilling(&self, place: Span) -> Option<Drilling> {
        self.reader.drilling(place)
    }

    /// The next event, or the alarm that ends the program; `None` after the last. Between two passes of the main program
    /// there is nothing until [`begin_pass`](Self::begin_pass).
    pub fn next_event(&mut self) -> io::Result<Option<Result<Event, Alarm>>> {
        loop {
            if let Some(event) = self.queue.pop_front() {
                return Ok(Some(Ok(event)));
            }
            if let Some(alarm) = self.alarm.take() {
                return Ok(Some(Err(alarm)));
            }
            if self.over || self.reader.is_over() || self.is_between_passes() {
                return Ok(None);
            }
            self.steps += 1;
            let queue = &mut self.queue;
            match self.reader.step(&mut |event| queue.push_back(event)) {
                Ok(()) => {}
                Err(Trouble::Alarm(alarm)) => self.alarm = Some(alarm),
                Err(Trouble::Unreadable(error)) => return Err(error),
            }
        }
    }

    /// True where the line of the last event, or alarm, ends in inches.
    pub const fn is_inch(&self) -> bool {
        self.reader.interpreter().is_inch()
    }

    /// A pass of the main program is over, and another one follows.
    pub const fn is_between_passes(&self) -> bool {
        self.pass != self.reader.pass()
    }

    /// Goes on with the next pass.
    pub const fn begin_pass(&mut self) {
        self.pass = self.reader.pass();
    }

    /// What the blocks so far leave in force for the next text.
    #[must_use]
    pub fn carried(&self) -> Carried {
        self.reader.carried()
    }

    /// True for the latest call, with this place in the text, where its thread is a G76 in one block.
    #[must_use]
    pub fn is_in_one_block(&self, place: Span) -> bool {
        self.reader.is_in_one_block(place)
    }

    /// Where offsets come from, with what the program has written of them.
    pub const fn offsets(&self) -> offsets::Source<'_> {
        self.reader.interpreter().offsets()
    }

    /// Machine coordinates of the work zero in force.
    #[must_use]
    pub fn origin(&self) -> Position {
        self.reader.interpreter().in_force().origin
    }

    /// The variables that outlive the program, as its last block has left them.
    pub const fn kept(&self) -> &Kept {
        self.reader.variables().kept()
    }

    /// The table of offsets and tools that the program has written to; `None` where it has not.
    pub fn written_offsets(&self) -> Option<&Offsets> {
        self.reader.interpreter().written_offsets()
    }

    /// How many lines were carried out, the line of the last event included: a line that is carried out again counts again.
    pub const fn steps(&self) -> u64 {
        self.steps
    }

    /// The line of the last event; empty where it cannot be read again.
    pub fn line(&mut self) -> Vec<u8> {
        self.reader.text().map(<[u8]>::to_vec).unwrap_or_default()
    }
}
