//! Opens a call: decides when it may be opened, and refuses an impossible call before any of its moves.

use super::{Planner, Settings};
use crate::alarm::{Alarm, Code, Span};
use crate::call::{
    Aux, Call, CallKind, ChainPart, Hand, HandChoice, Position, SpindleCall, SpindleChoice,
    SpindleMode, TapCall, TapMode, ThreadCall,
};
use crate::cycle::{self, Context, Forbidden, Moves, TapMoves, TapReport};
use crate::motion::{Action, FloatPlan, Plan, Stops};
use crate::moves::{Move, MoveKind};
use crate::offsets::{InPlace, image::tip_of};
use crate::params::Params;
use crate::signals::Signals;
use crate::tick::overridden;

impl Planner {
    /// Checks a call and makes it the call under expansion. `warning` receives its warning.
    #[inline(never)]
    pub(super) fn open(
        &mut self,
        call: &Call,
        settings: &Settings<'_>,
        warning: &mut Option<Alarm>,
    ) -> Result<(), Alarm> {
        let signals = self.latch(call, settings.signals);
        self.plan = None;
        let part = match &call.kind {
            CallKind::Thread(thread) => thread.part,
            _ => ChainPart::Whole,
        };
        if !self.chain.admits(part) {
            return Err(Alarm::new(Code::ThreadMovesMixed, call.span));
        }
        match &call.kind {
            CallKind::Thread(thread) => {
                can_cut(thread, call.span, settings)?;
                if !part.is_joined() {
                    self.cut = self.cut.next();
                }
            }
            CallKind::Tap(tap) => {
                self.prepare_tap(tap, signals, call.span, settings, warning)?;
            }
            CallKind::ExactStop(exact) => self.joined.set_exact(*exact),
            _ => cycle::tap_spindle(call, signals, settings.params)?,
        }
        self.expand(call, signals, settings)?;
        if let CallKind::TapReturn(_) = call.kind {
            self.prepare_return(call, settings)?;
        }
        let Some(moves) = &self.moves else {
            return Ok(());
        };
        if let Moves::Groove(groove) = moves {
            *warning = groove.warning();
        }
        self.guard.admit(call, moves)?;
        // Before any move of the call. A call that has expanded once expands again to the same moves.
        within_limits(moves, self.position, settings.params)?;
        let tool = self.tool.unwrap_or(settings.tool);
        if let CallKind::Aux(Aux::T(code)) = call.kind {
            self.tool = Some(tool.after(code));
        }
        clear_of_zones(moves, self.position, tool, settings)?;
        self.home = self.position;
        if !part.is_joined() {
            self.percent = settings.spindle_percent;
        }
        if let CallKind::End(_) | CallKind::Over | CallKind::LineOver = call.kind {
            let typed = matches!(call.kind, CallKind::LineOver);
            self.ending = Some((call.span, typed));
            self.joined.set_exact(false);
        }
        Ok(())
    }

    #[inline(never)]
    fn expand(
        &mut self,
        call: &Call,
        signals: Signals,
        settings: &Settings<'_>,
    ) -> Result<(), Alarm> {
        let context = Context {
            at: self.position,
            signals,
            tap: settings.tap,
        };
        let begun = self.moves.insert(Moves::One(None)).begin(call, &context);
        if begun.is_err() {
            self.moves = None;
        }
        begun
    }

    #[inline(never)]
    fn prepare_tap(
        &mut self,
        tap: &TapCall,
        signals: Signals,
        span: Span,
        settings: &Settings<'_>,
        warning: &mut Option<Alarm>,
    ) -> Result<(), Alarm> {
        (self.infeed, self.notes) = (tap.speed, tap.notes);
        let params = settings.params;
        let spindle = cycle::tap_can_begin(tap, signals, span, params)?;
        let hand = signals.hand(tap.hand);
        if tap.mode == TapMode::Floating {
            self.plan_float(tap, hand, span, params)?;
        }
        let plan = match &self.plan {
            Some(Plan::Float(plan)) => Some(plan),
            _ => None,
        };
        let moves = &mut TapMoves::of(tap, hand, spindle, span);
        let report = &mut TapReport::default();
        cycle::tap_strokes(moves, tap, plan, params, settings.limits, report)?;
        *warning = report.first_warning().copied();
        Ok(())
    }

    #[inline(never)]
    fn plan_float(
        &mut self,
        tap: &TapCall,
        hand: Hand,
        span: Span,
        params: &Params,
    ) -> Result<(), Alarm> {
        let plan = FloatPlan::new(tap, hand, span, params)?;
        self.plan = Some(Plan::Float(plan));
        Ok(())
    }

    /// The way out of the hole in the journal.
    #[inline(never)]
    fn prepare_return(&mut self, call: &Call, settings: &Settings<'_>) -> Result<(), Alarm> {
        if let Some(record) = settings.tap {
            (self.infeed, self.notes) = (record.hole.speed, record.hole.notes);
        }
        match &self.moves {
            Some(Moves::One(Some(Move {
                kind: MoveKind::Tap(out),
                ..
            }))) => cycle::tap_return(out, call.span, settings.params)?,
            // The tap was stopped where it is out of the hole.
            _ => self.put(self.number, call.span, Stops::default(), Action::TapOut),
        }
        Ok(())
    }

    /// The inputs for a call. Later changes of the inputs do not affect it.
    pub(super) const fn latch(&mut self, call: &Call, now: Signals) -> Signals {
        if let CallKind::Tap(tap) = &call.kind {
            if tap.continues {
                return self.hole_signals;
            }
            self.hole_signals = now;
        }
        now
    }
}

/// Checks a thread at the speed of its block, and also with the override where that makes the spindle faster.
#[inline(never)]
fn can_cut(thread: &ThreadCall, span: Span, settings: &Settings<'_>) -> Result<(), Alarm> {
    let (rpm, percent) = (thread.rpm, settings.spindle_percent);
    cycle::thread_can_run(thread, rpm, span, settings.params)?;
    if percent <= 100 {
        return Ok(());
    }
    cycle::thread_can_run(thread, overridden(rpm, percent), span, settings.params)
}

#[inline(never)]
fn within_limits(moves: &Moves, from: Position, params: &Params) -> Result<(), Alarm> {
    cycle::within_limits(moves, from, params)
}

#[inline(never)]
fn clear_of_zones(
    moves: &Moves,
    from: Position,
    tool: InPlace,
    settings: &Settings<'_>,
) -> Result<(), Alarm> {
    let number = tool.number();
    let tip = tip_of(number, settings.params, settings.offsets);
    let forbidden = Forbidden::of(settings.params, number, tip);
    cycle::clear_of_zones(moves, from, &forbidden)
}

/// The most segments that may be left in the queue when a call is opened. The override of a thread cycle is the override at
/// its beginning, so only the move before it and the move under way may be left. The signals of a hole are the signals at
/// its beginning too: no segment may be left.
pub(super) fn before(call: &Call, settings: &Settings<'_>) -> usize {
    const fn by_signal(spindle: SpindleChoice) -> bool {
        matches!(spindle, SpindleChoice::Signals { .. })
    }
    let heeds_signals = match &call.kind {
        // A chain waits for its last stroke, and its first one has the override.
        CallKind::Thread(thread) if thread.part.is_joined() => false,
        CallKind::Thread(_) => return usize::from(settings.begun),
        CallKind::Tap(tap) => {
            !tap.continues && (matches!(tap.hand, HandChoice::Signal) || by_signal(tap.spindle))
        }
        CallKind::Spindle(SpindleCall {
            mode: SpindleMode::Rigid(spindle),
            ..
        }) => by_signal(*spindle),
        _ => false,
    };
    if heeds_signals { 0 } else { usize::MAX }
}
