//! The calls of a program one after the other: geometry, travel, physics.

use leadscrew_core::alarm::{Alarm, Code, Span};
use leadscrew_core::call::{
    Aux, Call, CallKind, FeedRate, Position, SpindleCall, SpindleChoice, SpindleMode, TapCall,
    TapCycle, TapRepeat, ThreadCall,
};
use leadscrew_core::cycle::{self, Context, Forbidden, GrooveMoves, Moves};
use leadscrew_core::journal::TapRecord;
use leadscrew_core::moves::{Cycle, Move, MoveKind};
use leadscrew_core::offsets::{InPlace, Offsets};
use leadscrew_core::params::Params;
use leadscrew_core::signals::Signals;
use leadscrew_core::units::Length;
use leadscrew_language::stock::Stock;

use crate::figures::CycleFigures;
use crate::hole::Hole;
use crate::path;
use crate::plausible::Plausible;

/// The machine that a program is for, before its first call.
#[derive(Clone, Copy, Debug)]
pub struct Machine<'a> {
    /// Its parameters.
    pub params: &'a Params,
    /// Its table of offsets and tools, where it has one.
    pub offsets: Option<&'a Offsets>,
    /// Its inputs.
    pub signals: Signals,
    /// Where it stands.
    pub at: Position,
    /// The entry of its tap journal.
    pub tap: Option<TapRecord>,
    /// The tool in place.
    pub tool: InPlace,
    /// Its spindle turns already.
    pub turning: bool,
    /// Feeds go by the dry run's speed.
    pub dry_run: bool,
    /// The stock that the program declares.
    pub stock: Option<&'a Stock>,
}

/// Whoever is told what is found.
pub trait Findings {
    /// An alarm or a warning.
    fn tell(&mut self, alarm: &Alarm);
    /// One of what is hardly meant: it means nothing on a line that is refused anyway.
    fn doubt(&mut self, alarm: &Alarm);
    /// The place of a warning that [`doubt`](Self::doubt) is told next: Z and radius in millimetres, as the work has it.
    fn mark(&mut self, alarm: &Alarm, place: (f64, f64), call: &Call, at: Position, step: &Move) {
        let _ = (alarm, place, call, at, step);
    }
    /// A move ends beyond the travel of an axis, and this alarm is told of it.
    fn beyond(&mut self, alarm: &Alarm) {
        let _ = alarm;
    }
    /// A cycle, with its figures.
    fn cycle(&mut self, figures: CycleFigures) {
        let _ = figures;
    }
    /// The figures of the next cycle are wanted: some cost much.
    fn wants_figures(&self) -> bool {
        false
    }
}

/// The state of a verification.
#[derive(Debug)]
pub struct Verifier<'a> {
    pub(crate) machine: Machine<'a>,
    at: Position,
    hole: Hole,
    spindle: Spindle,
    tool: InPlace,
    plausible: Plausible,
    /// The strokes of a chain, until the last one.
    pub(crate) chain: Vec<(ThreadCall, Span)>,
    pub(crate) chain_us: i64,
    moves: u64,
    path_nm: f64,
    tappers: [bool; 3],
}

/// Whether the work piece, or the tool, turns during a feed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Spindle {
    /// It turns, or another spindle does.
    Turns,
    /// It stands.
    Stands,
    /// It stands, and a warning has said so.
    Told,
}

impl Spindle {
    /// The state after this call. M24–M27 select another spindle, whose state is unknown here.
    const fn behind(self, call: &Call) -> Self {
        match call.kind {
            CallKind::Spindle(call) if call.turns() => Self::Turns,
            CallKind::Spindle(_) => match self {
                Self::Turns => Self::Stands,
                stands => stands,
            },
            CallKind::Aux(Aux::M(24..=27)) => Self::Turns,
            _ => self,
        }
    }
}

impl<'a> Verifier<'a> {
    /// Begins.
    #[must_use]
    pub fn new(machine: Machine<'a>) -> Self {
        Self {
            at: machine.at,
            hole: Hole::new(machine.tap),
            spindle: if machine.turning {
                Spindle::Turns
            } else {
                Spindle::Stands
            },
            tool: machine.tool,
            plausible: Plausible::new(machine.params, machine.offsets, machine.stock),
            chain: Vec::new(),
            chain_us: 0,
            moves: 0,
            path_nm: 0.0,
            tappers: [false; 3],
            machine,
        }
    }

    /// Number of moves that could be made.
    #[must_use]
    pub const fn moves(&self) -> u64 {
        self.moves
    }

    /// The length of their path in the Z–X plane, in nanometres.
    #[must_use]
    pub const fn path_nm(&self) -> f64 {
        self.path_nm
    }

    /// True for each of the spindles 2 to 4 that taps.
    #[must_use]
    pub const fn tappers(&self) -> [bool; 3] {
        self.tappers
    }

    /// The tool in place.
    #[must_use]
    pub const fn tool(&self) -> InPlace {
        self.tool
    }

    /// Looks at the next call. `tip`: the offset of the tool in place, where it was measured.
    pub fn call(&mut self, call: &Call, tip: Option<[Length; 2]>, to: &mut dyn Findings) {
        let at = self.at;
        self.look(call, tip, to);
        self.plausible.call(call, at, &mut |alarm| to.doubt(&alarm));
    }

    /// The program is over.
    pub fn end(&mut self, to: &mut dyn Findings) {
        self.plausible.end(&mut |alarm| to.doubt(&alarm));
    }

    fn look(&mut self, call: &Call, tip: Option<[Length; 2]>, to: &mut dyn Findings) {
        let context = Context {
            at: self.at,
            signals: self.machine.signals,
            tap: self.hole.record(),
        };
        let moves = match cycle::expand(call, &context) {
            Ok(moves) => moves,
            Err(alarm) => {
                // The interpreter goes on at the end of the block. Cycles end where they begin, a stroke does not.
                if let CallKind::Thread(thread) = &call.kind {
                    if thread.cycle.is_stroke() {
                        (self.at.x, self.at.z) = (thread.end_x.value, thread.end_z.value);
                    }
                    self.causes(thread, call.span, to);
                }
                return to.tell(&alarm);
            }
        };
        if let Err(alarm) = self.hole.admit(call, &moves) {
            to.tell(&alarm);
        }
        if let Some(warning) = moves.warning() {
            to.tell(&warning);
        }
        self.mind_spindle(call, to);
        let params = self.machine.params;
        let within = cycle::within_limits(&moves, self.at, params);
        let number = self.tool.number();
        let clear = cycle::clear_of_zones(&moves, self.at, &Forbidden::of(params, number, tip));
        if let CallKind::Aux(Aux::T(code)) = call.kind {
            self.tool = self.tool.after(code);
        }
        let time = cycle::time(&moves, self.at, params);
        // The move that went beyond the limit has been reported already.
        if let Err(alarm) = within
            && moves.into_iter().any(|step| step.to != self.at)
        {
            to.beyond(&alarm);
            to.tell(&alarm);
        }
        if let Err(alarm) = clear {
            to.tell(&alarm);
        }
        let time_us = match time {
            Ok(time) => i64::try_from(time.as_micros()).unwrap_or(i64::MAX),
            // The findings for a thread say the same with more figures.
            Err(_) if matches!(call.kind, CallKind::Thread(_)) => 0,
            Err(alarm) => {
                to.tell(&alarm);
                0
            }
        };
        self.physics(call, time_us, to);
        if let Moves::Groove(groove) = &moves {
            // A cycle ends where it began.
            return self.groove(groove, call.span, time_us, to);
        }
        for step in moves {
            let at = self.at;
            self.plausible.step(call, at, &step, &mut |alarm, place| {
                to.mark(&alarm, place, call, at, &step);
                to.doubt(&alarm);
            });
            self.moves += 1;
            if let Some(used) = tapper(&step).and_then(|n| self.tappers.get_mut(n)) {
                *used = true;
            }
            self.hole.push(&step);
            self.path_nm += path::nanometres(&self.at, &step);
            self.at = step.to;
        }
    }

    fn physics(&mut self, call: &Call, time_us: i64, to: &mut dyn Findings) {
        match &call.kind {
            CallKind::Thread(thread) => self.thread(thread, call.span, time_us, to),
            CallKind::Groove(groove) => {
                if let Some(warning) = cycle::groove_warning(groove) {
                    to.tell(&warning);
                }
            }
            CallKind::Tap(tap) => self.tap(tap, call.span, time_us, to),
            _ => {
                let Machine {
                    signals, params, ..
                } = self.machine;
                if let Err(alarm) = cycle::tap_spindle(call, signals, params) {
                    to.tell(&alarm);
                }
            }
        }
    }

    /// A feed per minute goes on even if the spindle stands; a feed per turn and a thread would not [D199]. The first of
    /// several such moves in a row is reported.
    fn mind_spindle(&mut self, call: &Call, to: &mut dyn Findings) {
        let at = self.at;
        let feed = match &call.kind {
            CallKind::Line(end, feed) if end.c == at.c && *end != at => Some(feed),
            CallKind::Arc(arc) => Some(&arc.feed),
            CallKind::Groove(groove) => Some(&groove.feed),
            _ => None,
        };
        let cuts = matches!(feed, Some(FeedRate::PerMinute(_))) && !self.machine.dry_run;
        self.spindle = self.spindle.behind(call);
        if cuts && self.spindle == Spindle::Stands {
            self.spindle = Spindle::Told;
            to.tell(&Alarm::new(Code::CutStanding, call.span));
        }
    }

    /// A groove: each different move with its number of repeats.
    fn groove(&mut self, groove: &GrooveMoves, span: Span, time_us: i64, to: &mut dyn Findings) {
        let counted = groove.tally(&mut |from, step, times| {
            self.moves += times;
            self.path_nm += path::nanometres(from, step) * times as f64;
            Ok(())
        });
        debug_assert_eq!(counted, Ok(()));
        to.cycle(CycleFigures {
            line: span.line,
            cycle: if groove.cycle() == Cycle::G74 {
                "G74"
            } else {
                "G75"
            },
            passes: u32::try_from(groove.totals().columns).unwrap_or(u32::MAX),
            tap_speed: None,
            tap_lead_in_nm: None,
            thread: None,
            time_us,
        });
    }

    fn tap(&mut self, call: &TapCall, span: Span, time_us: i64, to: &mut dyn Findings) {
        let Machine {
            signals, params, ..
        } = self.machine;
        let report = match cycle::tap_report(call, signals, span, params) {
            Ok(report) => report,
            Err(alarm) => return to.tell(&alarm),
        };
        for warning in report.warnings() {
            to.tell(&warning);
        }
        to.cycle(CycleFigures {
            line: span.line,
            cycle: match call.cycle {
                TapCycle::G84 => "G84",
                TapCycle::G88 => "G88",
            },
            passes: match call.repeat {
                TapRepeat::Holes(holes) => u32::from(holes.get()),
                TapRepeat::Stay => 1,
            },
            tap_speed: Some(i64::from(report.fastest.get())),
            tap_lead_in_nm: report.join.map(|join| join.lead_in.nm()),
            thread: None,
            time_us,
        });
    }
}

/// The place, among spindles 2 to 4, of the spindle that a move taps with.
fn tapper(step: &Move) -> Option<usize> {
    let spindle = match step.kind {
        MoveKind::Tap(tap) => tap.spindle,
        MoveKind::Spindle(SpindleCall {
            mode: SpindleMode::Rigid(SpindleChoice::Written(spindle)),
            ..
        }) => spindle,
        _ => return None,
    };
    usize::from(spindle.number()).checked_sub(2)
}
