//! The hole that a tap may be in, followed through a program without a machine: the start of G30 P99, and what may not move
//! before it. `check`, `expand` and `plot` use it; the board uses its own journal.

use leadscrew_core::alarm::Alarm;
use leadscrew_core::board::Guard;
use leadscrew_core::call::{Call, CallKind, TapMode, TapNotes};
use leadscrew_core::cycle::Moves;
use leadscrew_core::journal::{TapHole, TapRecord};
use leadscrew_core::moves::{Move, MoveKind};
use leadscrew_core::units::{CentiRpm, Turns};

/// The newest entry of the tap journal, as the program makes it.
#[derive(Clone, Copy, Debug)]
pub struct Hole {
    record: Option<TapRecord>,
    guard: Guard,
    /// Values of the last admitted call: S, and what the journal keeps of the program around it.
    infeed: CentiRpm,
    notes: TapNotes,
}

impl Hole {
    /// Starts with the machine's entry.
    #[must_use]
    pub fn new(record: Option<TapRecord>) -> Self {
        Self {
            guard: Guard::of(record.as_ref()),
            record,
            infeed: CentiRpm::default(),
            notes: TapNotes::default(),
        }
    }

    /// The entry.
    #[must_use]
    pub const fn record(&self) -> Option<&TapRecord> {
        self.record.as_ref()
    }

    /// Admits a call that does not move a tap in its hole.
    ///
    /// # Errors
    /// As the board's guard.
    pub fn admit(&mut self, call: &Call, moves: &Moves) -> Result<(), Alarm> {
        match (&call.kind, &self.record) {
            (CallKind::Tap(tap), _) => (self.infeed, self.notes) = (tap.speed, tap.notes),
            (CallKind::TapReturn(_), Some(record)) => {
                (self.infeed, self.notes) = (record.hole.speed, record.hole.notes);
            }
            _ => {}
        }
        self.guard.admit(call, moves)
    }

    /// Takes a move.
    pub fn push(&mut self, step: &Move) {
        let MoveKind::Tap(tap) = step.kind else {
            return;
        };
        if tap.mode != TapMode::Rigid {
            return;
        }
        self.record = Some(TapRecord {
            sequence: self.record.map_or(1, |last| last.sequence.wrapping_add(1)),
            in_hole: !tap.closes,
            hole: TapHole {
                axis: tap.axis,
                level: tap.level,
                bottom: tap.bottom,
                lead: tap.lead,
                hand: tap.hand,
                spindle: tap.spindle,
                speed: self.infeed,
                notes: self.notes,
            },
            position: tap.axis.of(step.to),
            angle: Turns::default(),
        });
    }
}
