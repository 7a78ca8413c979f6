//! A program read once to its end: its calls, its path, and what is wrong with it or hardly meant.
//!
//! Knows no machine but its parameters: the path starts where the drives stand at power-up.

use std::io;

use leadscrew_core::alarm::{Alarm, Lang};
use leadscrew_core::call::{Call, CallKind, Position};
use leadscrew_core::cycle::{self, Context};
use leadscrew_core::moves::{Move, MoveKind};
use leadscrew_core::offsets::InPlace;
use leadscrew_core::params::Params;
use leadscrew_core::program::{Event, Options};
use leadscrew_core::signals::Signals;
use leadscrew_inspection::{Declared, Finder, Job, Wish};
use leadscrew_language::dialect::remedies;
use leadscrew_language::flow::{Rules, Trouble};
use leadscrew_language::heading::{Allowed, Heading};
use leadscrew_language::lines::Lines;
use leadscrew_language::reader::Reader;
use leadscrew_language::variables::Kept;
use leadscrew_language::whose::Whose;
use leadscrew_verification::{Findings, Machine, Verifier};
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
            help: remedies::help(alarm, lang)
                .unwrap_or_else(|| fill(alarm.code.help(lang), alarm, lang, inch)),
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
        let mut told = Told {
            found: Vec::new(),
            allowed: heading.allowed,
            lang,
            inch: false,
        };
        for alarm in heading.warning.iter().chain(&heading.alarm) {
            told.tell(alarm);
        }
        let mut verifier = Verifier::new(Machine {
            params,
            offsets: None,
            signals: Signals::default(),
            at: options.position,
            tap: None,
            tool: InPlace::default(),
            turning: false,
            dry_run: false,
            stock: heading.stock.as_ref(),
        });
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
            let interpreter = reader.interpreter();
            told.inch = interpreter.is_inch();
            for event in events.drain(..) {
                match event {
                    Event::Call(call) => {
                        // The way out of a hole depends on the machine.
                        if !matches!(call.kind, CallKind::TapReturn(_)) {
                            let tip = interpreter.offsets().tip(verifier.tool().number());
                            verifier.call(&call, tip, &mut told);
                        }
                        program.call(&call, &mut at, &mut finder);
                        finder.call(&call);
                    }
                    Event::Warning(alarm) => told.tell(&alarm),
                }
            }
            match ended {
                Ok(()) => {}
                Err(Trouble::Alarm(alarm)) => told.tell(&alarm),
                Err(Trouble::Unreadable(error)) => return Err(error),
            }
        }
        verifier.end(&mut told);
        program.found = told.found;
        // No name was given that could be refused.
        program.threads = finder
            .plan(&Wish {
                stock: heading
                    .stock
                    .map(|stock| Declared::new(stock.outside, stock.bore, stock.face)),
                ..Wish::default()
            })
            .map_or_else(|_| Vec::new(), |plan| plan.jobs);
        Ok(program)
    }

    /// Draws a call. One that cannot be made has been told.
    fn call(&mut self, call: &Call, at: &mut Position, finder: &mut Finder) {
        self.calls.push(*call);
        self.too_long |= self.calls.len() > MOST_CALLS;
        let Ok(moves) = cycle::expand(call, &Context::standing(*at)) else {
            return;
        };
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

/// What was found, in words.
struct Told {
    found: Vec<Found>,
    /// Numbers that the program silences.
    allowed: Allowed,
    lang: Lang,
    inch: bool,
}

impl Findings for Told {
    fn tell(&mut self, alarm: &Alarm) {
        let (number, line) = (alarm.number(), alarm.span.line);
        let known = |other: &Found| (other.number, other.line) == (number, line);
        let has_room = self.found.len() < MOST_FOUND;
        if has_room && !self.allowed.has(number) && !self.found.iter().any(known) {
            self.found.push(Found::new(alarm, self.lang, self.inch));
        }
    }

    fn doubt(&mut self, alarm: &Alarm) {
        let refused = |known: &Found| {
            known.line == alarm.span.line && !known.warning && !Allowed::may_have(known.number)
        };
        if !self.found.iter().any(refused) {
            self.tell(alarm);
        }
    }
}

impl std::fmt::Display for Found {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:04} {}; {}", self.number, self.message, self.help)
    }
}
