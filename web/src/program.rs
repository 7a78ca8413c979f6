//! A program read once to its end: its calls, its path, and what is wrong with it.
//!
//! Knows no machine: the path starts where the drives stand at power-up.

use std::io;

use leadscrew_core::alarm::{Alarm, Lang};
use leadscrew_core::call::{Call, CallKind, Position};
use leadscrew_core::cycle::{self, Context};
use leadscrew_core::moves::{Move, MoveKind};
use leadscrew_core::params::Params;
use leadscrew_core::program::{Event, Options};
use leadscrew_inspection::{Finder, Job, Wish};
use leadscrew_language::flow::{Rules, Trouble};
use leadscrew_language::heading::Heading;
use leadscrew_language::lines::Lines;
use leadscrew_language::reader::Reader;
use leadscrew_language::variables::Kept;
use leadscrew_language::whose::Whose;
use leadscrew_wording::fill;
use serde::Serialize;

/// The most calls of a program in a tab: they are all in memory.
const MOST_CALLS: usize = 50_000;
/// The most pieces of a path that are drawn.
const MOST_PIECES: usize = 100_000;
/// The most findings that are told.
const MOST_FOUND: usize = 100;

/// An alarm or a warning.
#[derive(Clone, Debug, Serialize)]
pub struct Found {
    number: u16,
    warning: bool,
    line: u32,
    column: u16,
    end: u16,
    message: String,
    help: String,
}

impl Found {
    /// Puts an alarm into words.
    pub fn new(alarm: &Alarm, lang: Lang, inch: bool) -> Self {
        Self {
            number: alarm.number(),
            warning: alarm.code.is_warning(),
            line: alarm.span.line,
            column: alarm.span.column,
            end: alarm.span.end,
            message: fill(alarm.code.cause(lang), alarm, lang, inch),
            help: fill(alarm.code.help(lang), alarm, lang, inch),
        }
    }
}

/// A piece of the path, in machine coordinates; X is a radius.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Piece {
    kind: &'static str,
    line: u32,
    pass: u32,
    from: [i64; 2],
    to: [i64; 2],
    /// Where X0 Z0 of the program is.
    origin: [i64; 2],
    /// Centre minus start in X and Z, and 1 for G02.
    #[serde(skip_serializing_if = "Option::is_none")]
    arc: Option<[i64; 3]>,
}

/// A program that was read.
#[derive(Debug, Default)]
pub struct Program {
    /// In order.
    pub calls: Vec<Call>,
    /// In order.
    pub path: Vec<Piece>,
    /// Its threads, in order.
    pub threads: Vec<Job>,
    /// In order.
    pub found: Vec<Found>,
    /// It is longer than a tab takes.
    pub too_long: bool,
}

impl Program {
    /// True for one that may run.
    pub fn is_good(&self) -> bool {
        !self.too_long && self.found.iter().all(|found| found.warning)
    }

    /// Reads a program.
    ///
    /// # Errors
    /// The text cannot be read, which a text in memory always can.
    pub fn read(text: &[u8], params: &Params, lang: Lang) -> io::Result<Self> {
        let heading = Heading::read(&mut Lines::new(text), Whose::Program)?;
        let options = Options {
            passes_machine_codes: true,
            ..Options::default()
        };
        let rules = Rules {
            control: heading.control.unwrap_or_default(),
            stock: heading.stock,
            ..Rules::default()
        };
        let mut program = Self::default();
        let first = heading.warning.iter().chain(&heading.alarm);
        program
            .found
            .extend(first.map(|alarm| Found::new(alarm, lang, false)));
        let mut at = options.position;
        let mut finder = Finder::default();
        let mut reader = Reader::new(text, params, options, Kept::default(), rules);
        let mut events = Vec::new();
        while heading.alarm.is_none()
            && !reader.is_over()
            && !program.too_long
            && reader.pass() == 1
        {
            let ended = reader.step(&mut |event| events.push(event));
            let inch = reader.interpreter().is_inch();
            for event in events.drain(..) {
                match event {
                    Event::Call(call) => {
                        program.call(&call, params, &mut at, &mut finder, |alarm| {
                            Found::new(alarm, lang, inch)
                        });
                        finder.call(&call);
                    }
                    Event::Warning(alarm) => program.tell(Found::new(&alarm, lang, inch)),
                }
            }
            match ended {
                Ok(()) => {}
                Err(Trouble::Alarm(alarm)) => program.tell(Found::new(&alarm, lang, inch)),
                Err(Trouble::Unreadable(error)) => return Err(error),
            }
        }
        // No name was given that could be refused.
        program.threads = finder
            .plan(&Wish::default())
            .map_or_else(|_| Vec::new(), |plan| plan.jobs);
        Ok(program)
    }

    fn tell(&mut self, found: Found) {
        let known = |other: &Found| (other.number, other.line) == (found.number, found.line);
        if self.found.len() < MOST_FOUND && !self.found.iter().any(known) {
            self.found.push(found);
        }
    }

    fn call(
        &mut self,
        call: &Call,
        params: &Params,
        at: &mut Position,
        finder: &mut Finder,
        words: impl Fn(&Alarm) -> Found,
    ) {
        self.calls.push(*call);
        self.too_long |= self.calls.len() > MOST_CALLS;
        let moves = match cycle::expand(call, &Context::standing(*at)) {
            // The way out of a hole depends on the machine.
            Err(_) if matches!(call.kind, CallKind::TapReturn(_)) => return,
            Err(alarm) => return self.tell(words(&alarm)),
            Ok(moves) => moves,
        };
        if let Some(warning) = moves.warning() {
            self.tell(words(&warning));
        }
        let within = cycle::within_limits(&moves, *at, params);
        if let Err(alarm) = within.and_then(|()| cycle::time(&moves, *at, params).map(drop)) {
            self.tell(words(&alarm));
        }
        for step in moves {
            finder.step(&step);
            self.piece(*at, &step, call.origin);
            *at = step.to;
        }
    }

    fn piece(&mut self, from: Position, step: &Move, origin: Position) {
        let arc = match step.kind {
            MoveKind::Arc {
                i, k, clockwise, ..
            } => Some([i.nm(), k.nm(), i64::from(clockwise)]),
            _ => None,
        };
        let kind = match step.kind {
            MoveKind::Rapid => "rapid",
            MoveKind::Feed(_) | MoveKind::Arc { .. } => "feed",
            MoveKind::Thread(_) => "thread",
            MoveKind::Tap(_) => "tap",
            MoveKind::Dwell(_) | MoveKind::Spindle(_) | MoveKind::Aux(_) => return,
        };
        let place = |position: Position| [position.x.nm(), position.z.nm()];
        let (from, to) = (place(from), place(step.to));
        if from == to && arc.is_none() {
            return;
        }
        self.too_long |= self.path.len() >= MOST_PIECES;
        self.path.push(Piece {
            kind,
            line: step.span.line,
            pass: step.tag.map_or(0, |tag| tag.pass),
            from,
            to,
            origin: place(origin),
            arc,
        });
    }
}

impl std::fmt::Display for Found {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:04} {}; {}", self.number, self.message, self.help)
    }
}
