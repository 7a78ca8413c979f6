//! Taking up a call: when it may be, and refusing what cannot be done before any of its moves.

use super::{Background, Settings, overridden};
use crate::alarm::Alarm;
use crate::cycle::{Context, MoveKind, expand};
use crate::feasible;
use crate::motion::{Action, FloatPlan, Plan, Stops};
use crate::program::{
    Call, CallKind, HandChoice, SpindleCall, SpindleChoice, SpindleMode, TapMode, ThreadCall,
};
use crate::signals::Signals;

impl Background {
    /// Checks a call and makes it the one under expansion; a warning of it comes back.
    pub(super) fn open(
        &mut self,
        call: &Call,
        settings: &Settings<'_>,
    ) -> Result<Option<Alarm>, Alarm> {
        let mut warning = None;
        self.plan = None;
        let signals = self.latch(call, settings.signals);
        match &call.kind {
            CallKind::Thread(thread) => {
                feasible::thread_can_run(thread, call.span, settings.params)?;
                if settings.spindle_percent > 100 {
                    // The override makes it faster than the block says.
                    let faster = ThreadCall {
                        rpm: overridden(thread.rpm, settings.spindle_percent),
                        ..*thread
                    };
                    feasible::thread_can_run(&faster, call.span, settings.params)?;
                }
            }
            CallKind::Tap(tap) => {
                (self.infeed, self.notes) = (tap.speed, tap.notes);
                let report = feasible::tap(tap, signals, call.span, settings.params)?;
                warning = report.warnings().next();
                self.plan = match tap.mode {
                    TapMode::Rigid => None,
                    TapMode::Floating => {
                        let hand = signals.hand(tap.hand);
                        Some(Plan::Float(FloatPlan::new(
                            tap,
                            hand,
                            call.span,
                            settings.params,
                        )?))
                    }
                };
            }
            _ => feasible::tap_spindle(call, signals, settings.params)?,
        }
        let context = Context {
            at: self.position,
            signals,
            tap: settings.tap,
        };
        let moves = expand(call, &context)?;
        if let CallKind::TapReturn(_) = call.kind {
            if let Some(record) = settings.tap {
                (self.infeed, self.notes) = (record.hole.speed, record.hole.notes);
            }
            match moves.clone().next().map(|next| next.kind) {
                Some(MoveKind::Tap(out)) => {
                    feasible::tap_return(&out, call.span, settings.params)?;
                }
                // It was stopped where it is out.
                _ => self.put(self.number, call.span, Stops::default(), Action::TapOut),
            }
        }
        let warning = moves.warning().or(warning);
        self.guard.admit(call, &moves)?;
        // Before anything of the call moves; what has expanded once expands a second time to the same.
        feasible::within_limits(moves.clone(), self.position, settings.params)?;
        self.home = self.position;
        self.percent = settings.spindle_percent;
        self.moves = Some(moves);
        if let CallKind::End(_) | CallKind::Over = call.kind {
            self.ending = Some(call.span);
        }
        Ok(warning)
    }

    /// The inputs with which a call is carried out, whatever they do meanwhile.
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

/// How many segments may be left in the queue when a call is taken up. The override of a thread cycle is that of its
/// beginning: only the move before it may be, and that under way. The signals of a hole are those of its beginning, too:
/// nothing may be left.
pub(super) fn before(call: &Call, settings: &Settings<'_>) -> usize {
    pub(super) const fn by_signal(spindle: SpindleChoice) -> bool {
        matches!(spindle, SpindleChoice::Signals { .. })
    }
    let heeds_signals = match &call.kind {
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
