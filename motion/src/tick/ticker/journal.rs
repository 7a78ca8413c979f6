//! The tap journal in the tick: an entry before a hole, at every reversal, after the hole, and at every stop in between
//! ([G84/G88 sheet], G30 P99).
//!
//! Only the newest entry matters. The tick puts it into its output. The owner of the storage writes it and reports the
//! result ([`Ticker::stored`]). Before a hole, the tap waits for this report. Inside a hole nothing waits, so that the way
//! out stays possible. Knows entries; knows nothing of flash.

use super::super::stored::StoreError;
use super::{Ends, Output, State, Ticker, emit};
use crate::alarm::{Alarm, Arg, Code};
use crate::call::Position;
use crate::journal::{TapHole, TapRecord};
use crate::motion::{Motion, Tap, TapPart, Task};
use crate::tick::Event;
use crate::units::Turns;

/// The journal's state in the tick.
#[derive(Clone, Copy, Debug)]
pub(super) struct Journal {
    /// The newest entry.
    record: Option<TapRecord>,
    /// The entry is not in an output yet.
    fresh: bool,
    /// Number of the entry that first named the hole, and whether this entry or a later one is known to be stored.
    named: u32,
    confirmed: bool,
    /// The last write was refused.
    failed: bool,
    /// The tap has begun the hole of the entry, or the entry says so since power-up.
    begun: bool,
    /// The power went while the tap was in the hole. The position of its axis is unknown, and the bottom is taken for it
    /// [D26].
    assumed: bool,
    /// The part of a tap under way.
    part: Option<TapPart>,
    /// The tap is out of its hole: the spindle leaves position mode.
    returned: bool,
    /// Ticks for which a hole has waited.
    waited: u32,
    /// The most ticks for which a hole waits.
    patience: u32,
}

impl Journal {
    /// `record`: the newest entry. A hole waits for a second at most.
    pub(super) fn new(record: Option<TapRecord>, ticks_per_second: u32) -> Self {
        let (in_hole, named) = match &record {
            Some(record) => (record.in_hole, record.sequence),
            None => (false, 0),
        };
        Self {
            record,
            fresh: false,
            named,
            confirmed: in_hole,
            failed: false,
            begun: in_hole,
            assumed: in_hole,
            part: None,
            returned: false,
            waited: 0,
            patience: ticks_per_second,
        }
    }

    /// An entry is not in an output yet.
    pub(super) const fn has_entry(&self) -> bool {
        self.fresh
    }

    /// A tap is in its hole, as far as is known.
    pub(super) const fn has_hole(&self) -> bool {
        matches!(&self.record, Some(TapRecord { in_hole: true, .. }))
    }

    /// The alarm of a guarded hole.
    pub(super) fn hole_alarm(&self) -> Option<Alarm> {
        let hole = &self.record.as_ref().filter(|record| record.in_hole)?.hole;
        let figures = [Arg::Letter(hole.letter()), hole.figure(hole.bottom)];
        Some(Alarm::of(Code::TapInHole, &figures))
    }

    /// The tick side starts again while the power stays on. The knowledge of a hole stays.
    pub(super) const fn begin_anew(&mut self, ticks_per_second: u32) {
        self.part = None;
        self.returned = false;
        self.patience = ticks_per_second;
    }

    /// A new entry: a hole is about to begin, or to go deeper.
    fn name(&mut self, hole: &TapHole, stand: &Stand) {
        let last = self.record.as_ref().map_or(0, |record| record.sequence);
        let sequence = last.wrapping_add(1);
        self.record = Some(TapRecord {
            sequence,
            in_hole: true,
            hole: *hole,
            position: hole.axis.of(stand.position),
            angle: stand.angle,
        });
        self.fresh = true;
        self.failed = false;
        self.named = sequence;
        self.confirmed = false;
        self.waited = 0;
    }

    /// Changes the entry of the same hole, in place, because an entry is large. False where there is none. One that would
    /// say the same again is not made: each wears the storage.
    fn renew(&mut self, in_hole: bool, stand: &Stand) -> bool {
        let Some(record) = &mut self.record else {
            return false;
        };
        let is_at = record.position == record.hole.axis.of(stand.position);
        if record.in_hole == in_hole && is_at && record.angle == stand.angle {
            return true;
        }
        record.sequence = record.sequence.wrapping_add(1);
        record.in_hole = in_hole;
        record.position = record.hole.axis.of(stand.position);
        record.angle = stand.angle;
        self.fresh = true;
        self.failed = false;
        true
    }

    /// The newest entry names this hole.
    fn knows(&self, hole: &TapHole) -> bool {
        self.record
            .as_ref()
            .is_some_and(|record| record.in_hole && record.hole == *hole)
    }
}

/// The position of axes and spindle.
struct Stand {
    position: Position,
    angle: Turns,
}

impl Ticker {
    /// The newest entry of the tap journal, stored or not.
    #[must_use]
    pub const fn tap_record(&self) -> Option<&TapRecord> {
        self.journal.record.as_ref()
    }

    /// A copy of the newest entry.
    pub const fn tap_entry(&self) -> Option<TapRecord> {
        self.journal.record
    }

    /// The owner has stored the entry with this number, or has failed to.
    pub(in crate::tick) fn stored(&mut self, sequence: u32, result: Result<(), StoreError>) {
        match result {
            // An older entry does not count. The difference wraps.
            Ok(()) => {
                let behind = sequence.wrapping_sub(self.journal.named);
                self.journal.confirmed |= behind <= u32::MAX / 2;
            }
            Err(_) => self.journal.failed = true,
        }
    }

    /// Drops the entry: the operator says that the tap is out. Returns false and changes nothing where there is no entry or
    /// the machine moves. A position taken from the entry is dropped too; the drive's position counts again.
    pub fn discard_tap(&mut self) -> bool {
        let stands = matches!(self.state, State::Starting | State::Idle | State::Alarm(_));
        let record = self.journal.record.as_ref();
        // What the axes are told has to change with what their drives count.
        let can_move_over = !matches!(self.state, State::Alarm(_)) || self.executor.is_free();
        if !stands || !can_move_over || !record.is_some_and(|record| record.in_hole) {
            return false;
        }
        let stand = self.stand();
        self.journal.renew(false, &stand);
        self.journal.begun = false;
        self.journal.assumed = false;
        let moved = self.drives.forget_places();
        let position = if moved {
            self.drives.position(None)
        } else {
            self.executor.position()
        };
        match self.state {
            State::Idle => {
                self.executor.set_position(position);
                self.restart(position);
            }
            // The drives may still follow: what they are told from now on is where they are.
            State::Alarm(_) if moved => {
                self.executor.set_position(position);
                self.remembered = Some(position);
            }
            _ => {}
        }
        if moved {
            self.drives.rest_at(position);
        }
        true
    }

    fn stand(&self) -> Stand {
        Stand {
            position: self.executor.position(),
            angle: self
                .executor
                .spindle()
                .unwrap_or_else(|| self.observer.angle()),
        }
    }

    /// The drives have just been enabled. If a tap is in its hole since before the power went, its axis stands at the
    /// bottom [D26]. A warning tells so.
    pub(super) fn place_tap(&mut self, position: &mut Position, ends: &mut Ends<'_>) {
        if !core::mem::take(&mut self.journal.assumed) {
            return;
        }
        let Some(TapRecord { hole, .. }) = &self.journal.record else {
            return;
        };
        let placed = hole.axis.with(*position, hole.bottom);
        if self.drives.place(*position, placed) {
            *position = placed;
        }
        let args = [Arg::Letter(hole.letter()), hole.figure(hole.bottom)];
        let warning = Alarm::of(Code::TapInHoleSincePower, &args);
        emit(&mut ends.events, Event::Warning(warning));
    }

    /// A hole may begin once its entry is known to be stored. `Some`: the hole waits, or has failed.
    pub(super) fn wait_for_journal(&mut self, ends: &mut Ends<'_>) -> Option<(u32, u32, Motion)> {
        let tap = ends.segments.peek()?.tap()?;
        if tap.part.returns || tap.hole.spindle != self.spindle.taps_with() {
            return None;
        }
        if self.journal.confirmed && self.journal.knows(&tap.hole) {
            return None;
        }
        self.wait_for_entry(ends)
    }

    #[cold]
    #[inline(never)]
    fn wait_for_entry(&mut self, ends: &mut Ends<'_>) -> Option<(u32, u32, Motion)> {
        let task = ends.segments.peek()?;
        let (segment, tap) = (task.segment, task.tap()?);
        let (number, span) = (segment.number, segment.span);
        if !self.journal.knows(&tap.hole) {
            let stand = self.stand();
            self.journal.name(&tap.hole, &stand);
        }
        self.journal.waited = self.journal.waited.saturating_add(1);
        if self.journal.failed || self.journal.waited > self.journal.patience {
            self.raise(&Alarm::new(Code::TapJournalNotWritten, span), ends);
        }
        Some((number, span.line, Motion::Wait))
    }

    /// A tap begins.
    pub(super) const fn tap_begins(&mut self, tap: &Tap) {
        self.journal.part = Some(tap.part);
        self.journal.begun = true;
    }

    /// At the end of a tick: writes entries for reversals and for the end of a hole, and the entry of the next hole, so
    /// that this hole need not wait.
    pub(super) fn keep_journal(&mut self, ends: &mut Ends<'_>, output: &mut Output) {
        if self.executor.has_turned() {
            self.note();
        }
        if self.executor.is_free() {
            self.between_holes(ends);
        }
        if self.journal.failed && self.journal.begun {
            self.journal.failed = false;
            let warning = Alarm::of(Code::TapJournalStale, &[]);
            emit(&mut ends.events, Event::Warning(warning));
        }
        output.journal = None;
        if self.journal.fresh {
            self.journal.fresh = false;
            output.journal = self.journal.record;
        }
    }

    fn between_holes(&mut self, ends: &Ends<'_>) {
        if core::mem::take(&mut self.journal.returned) {
            self.spindle.leave();
        }
        if !self.state.takes_calls() {
            return;
        }
        if let Some(part) = self.journal.part.take()
            && part.closes
        {
            self.tap_is_out();
            self.journal.returned = part.returns;
        }
        if !self.spindle.is_rigid() || self.operator.hold || self.course.is_paused() {
            return;
        }
        let epoch = self.course.epoch();
        let next = ends.segments.peek();
        let next = next.filter(|next| next.segment.epoch == epoch);
        let Some(tap) = next.and_then(Task::tap) else {
            return;
        };
        let here = tap.hole.spindle == self.spindle.taps_with();
        if here && !tap.part.returns && !self.journal.knows(&tap.hole) {
            let stand = self.stand();
            self.journal.name(&tap.hole, &stand);
        }
    }

    /// Clears the entry.
    pub(super) fn tap_is_out(&mut self) {
        let stand = self.stand();
        if self.journal.renew(false, &stand) {
            self.journal.begun = false;
        }
    }

    /// Notes a reversal in the hole.
    fn note(&mut self) {
        if self.journal.begun {
            let stand = self.stand();
            self.journal.renew(true, &stand);
        }
    }

    /// Notes a stop: the position, if the hole has begun; otherwise that no tap is in it.
    pub(super) fn note_stop(&mut self) {
        self.journal.part = None;
        if !self.journal.has_hole() {
            return;
        }
        let stand = self.stand();
        self.journal.renew(self.journal.begun, &stand);
    }
}
