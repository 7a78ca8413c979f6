//! The planner: calls in, segments out.
//!
//! It expands one call after another, refuses an impossible call before any of its moves, and plans each move from the end
//! of the move before. A pass of a thread is queued together with its retract. One call of [`Planner::step`] does one small
//! piece of work; only the number of steps is unbounded. Opening a call, passes, holes and detours have files of their own.
//! Knows nothing of ticks, drives or frames.

mod chain;
mod hole;
mod joined;
mod open;
mod pass;
mod route;

use heapless::Vec;
use heapless::spsc::{Consumer, Queue};

use self::chain::Chained;
use self::hole::{ends_hole, is_tap};
use self::joined::Joined;
use self::open::before;
use self::route::plan_route;
use super::guard::Guard;
use crate::alarm::{Alarm, Code, Span};
use crate::call::{Aux, Call, CallKind, ChainPart, Position, SpindleCall, SpindleMode, TapNotes};
use crate::cycle::Moves;
use crate::journal::TapRecord;
use crate::motion::{
    Action, Cut, Epoch, Limits, Orientation, Plan, Segment, Stops, TapStep, dwell_ticks, plan,
};
use crate::moves::{Move, MoveKind, Stage};
use crate::offsets::InPlace;
use crate::offsets::image::Image;
use crate::params::{FunctionRow, Params};
use crate::signals::Signals;
use crate::tick::Notice;
use crate::tick::queue::{DetourIn, SegmentIn, take};
use crate::units::CentiRpm;

/// Calls on their way to the planner. One place of a ring stays empty.
pub(super) type Calls = Queue<Call, 4>;
/// The planner's end of them.
pub(super) type CallOut<'a> = Consumer<'a, Call>;

/// The inputs of planning in addition to the program.
#[derive(Clone, Copy, Debug)]
pub struct Settings<'a> {
    /// The parameter set.
    pub params: &'a Params,
    /// The limits that follow from it.
    pub limits: &'a Limits,
    /// Spindle override in per cent, as the operator has set it.
    pub spindle_percent: u8,
    /// The oldest segment in the queue is under way. It stays in the queue until it is done.
    pub begun: bool,
    /// The inputs.
    pub signals: Signals,
    /// The newest entry of the tap journal.
    pub tap: Option<&'a TapRecord>,
    /// The tool in place by what the machine has carried out.
    pub tool: InPlace,
    /// The table of offsets in force.
    pub offsets: &'a Image,
    /// The time, in ticks; it wraps.
    pub now: u32,
}

/// The first stroke of a tap whose strokes are being collected.
#[derive(Clone, Copy, Debug)]
struct Collecting {
    number: u32,
    span: Span,
}

/// The state of the planner.
#[derive(Debug)]
pub struct Planner {
    moves: Option<Moves>,
    epoch: Epoch,
    /// The thread or hole being expanded, or the last one.
    cut: Cut,
    /// The spindle override for which the call under expansion is planned.
    percent: u8,
    /// The inputs at the start of the last hole. A hole that continues after K198 keeps them.
    hole_signals: Signals,
    /// The call under expansion ends the program; true: it ends a line that was typed.
    ending: Option<(Span, bool)>,
    /// End of the last planned move.
    position: Position,
    /// Start of the call under expansion: A of a cycle.
    home: Position,
    /// Moves so far.
    number: u32,
    /// The synchronous moves of the pass being collected, and the start of this pass.
    pass: Vec<Move, 3>,
    pass_start: Position,
    pass_number: u32,
    /// The strokes of a chain, until all of them are planned.
    chain: Chained,
    /// The plan being made, or waiting for the queue. The plan of an ordinary tapping call stays for all its holes.
    plan: Option<Plan>,
    /// A tap is being collected in this plan: from R until the tap is back at R.
    tap: Option<Collecting>,
    /// The number of the first stroke of the ordinary hole being collected.
    float_number: Option<u32>,
    /// The move being planned is the last of its hole.
    hole_ends: bool,
    /// Segments that are planned and not queued yet. A pass waits here for its retract.
    planned: Vec<Segment, 4>,
    complete: bool,
    failed: bool,
    /// Cuts that wait to be joined, and how they leave.
    joined: Joined,
    guard: Guard,
    /// The tool in place after the calls so far; `None`: no call has changed it.
    tool: Option<InPlace>,
    /// For the tap journal: S of the call under expansion, and other values of the program.
    infeed: CentiRpm,
    notes: TapNotes,
}

impl Planner {
    /// No work, at a position.
    // Part of the background, which is written where it will be [D146].
    #[must_use]
    #[inline(always)]
    pub fn new(position: Position) -> Self {
        Self::starting(position, Epoch::default())
    }

    #[inline(always)]
    const fn starting(position: Position, epoch: Epoch) -> Self {
        Self {
            moves: None,
            epoch,
            cut: Cut::NONE,
            percent: 100,
            hole_signals: Signals::POWER_UP,
            ending: None,
            position,
            home: position,
            number: 0,
            pass: Vec::new(),
            pass_start: position,
            pass_number: 0,
            chain: Chained::new(),
            plan: None,
            tap: None,
            float_number: None,
            hole_ends: false,
            planned: Vec::new(),
            complete: false,
            failed: false,
            joined: Joined::new(),
            guard: Guard::open(),
            tool: None,
            infeed: CentiRpm::new(0),
            notes: TapNotes::METRIC,
        }
    }

    /// Drops everything. The machine stands at `position`, and segments planned from now on carry `epoch`.
    // Field by field: a whole new planner would be copied through the stack.
    pub fn begin_anew(&mut self, position: Position, epoch: Epoch) {
        let Self {
            moves,
            epoch: own_epoch,
            // Segments planned from now on are new, so its number goes on.
            cut,
            percent,
            hole_signals,
            ending,
            position: own_position,
            home,
            number,
            pass,
            pass_start,
            pass_number,
            chain,
            plan,
            tap,
            float_number,
            hole_ends,
            planned,
            complete,
            failed,
            joined,
            guard,
            tool,
            infeed,
            notes,
        } = self;
        (*moves, *plan, *tap, *float_number, *ending) = (None, None, None, None, None);
        *own_epoch = epoch;
        *cut = Cut {
            number: cut.number,
            ..Cut::NONE
        };
        (*percent, *number, *pass_number) = (100, 0, 0);
        *hole_signals = Signals::POWER_UP;
        (*own_position, *home, *pass_start) = (position, position, position);
        pass.clear();
        chain.begin_anew();
        planned.clear();
        (*hole_ends, *complete, *failed) = (false, false, false);
        joined.begin_anew();
        *guard = Guard::open();
        *tool = None;
        (*infeed, *notes) = (CentiRpm::new(0), TapNotes::METRIC);
    }

    /// Obeys the tick's message: drops everything, including calls that wait, or plans a way that is not in the program.
    /// `tap`: the newest entry of the tap journal, including an entry of the same tick.
    pub fn heed(
        &mut self,
        notice: &Notice,
        calls: &mut CallOut<'_>,
        detours: &mut DetourIn<'_>,
        limits: &Limits,
        tap: Option<&TapRecord>,
    ) {
        match notice {
            Notice::Restart(position, epoch) => {
                while calls.ready() {
                    drop_oldest(calls);
                }
                self.begin_anew(*position, *epoch);
                self.guard = Guard::of(tap);
            }
            Notice::Route(route) => plan_route(route, limits, detours),
        }
    }

    /// New segments carry this epoch.
    pub(super) const fn epoch(&self) -> Epoch {
        self.epoch
    }

    /// True while a call is not fully planned and queued.
    #[must_use]
    pub fn is_busy(&self) -> bool {
        self.moves.is_some()
            || !self.planned.is_empty()
            || self.ending.is_some()
            || self.chain.is_whole()
            || !self.joined.is_empty()
    }

    /// Does one piece of work. False where no work can be done now. Returns a warning of the call that was just opened.
    pub fn step(
        &mut self,
        calls: &mut CallOut<'_>,
        segments: &mut SegmentIn<'_>,
        settings: &Settings<'_>,
    ) -> (bool, Option<Alarm>) {
        if self.complete {
            // What has waited longer goes first.
            if !self.joined.is_empty() {
                return (self.joined.close(segments, settings), None);
            }
            return (self.hand_over(segments), None);
        }
        if self.joined.must_leave() {
            return (self.joined.leave(segments, settings), None);
        }
        if self.failed {
            return (false, None);
        }
        if self.moves.is_some() {
            self.go_on(settings);
            return (true, None);
        }
        if self.chain.is_whole() {
            if let Err(alarm) = self.go_on_with_chain(settings) {
                self.fail(&alarm);
            }
            return (true, None);
        }
        if let Some((span, typed)) = self.ending.take() {
            let action = if typed { Action::LineEnd } else { Action::End };
            self.queue(span, Stops::default(), action);
            // The next program counts its own moves.
            self.number = 0;
            return (true, None);
        }
        let Some(call) = calls.peek() else {
            return (self.joined.wait(segments, settings), None);
        };
        if !self.joined.is_empty() && !joined::goes_on(call) {
            return (self.joined.close(segments, settings), None);
        }
        if segments.filled() > before(call, settings) {
            return (false, None);
        }
        // The start of a return is known once all earlier segments are done.
        if matches!(call.kind, CallKind::TapReturn(_)) && segments.filled() > 0 {
            return (false, None);
        }
        let mut warning = None;
        let opened = self.open(call, settings, &mut warning);
        drop_oldest(calls);
        if let Err(alarm) = &opened {
            self.fail(alarm);
            warning = None;
        }
        (true, warning)
    }

    /// Plans the next move of the call under expansion, or ends this call.
    #[inline(never)]
    fn go_on(&mut self, settings: &Settings<'_>) {
        let Some(moves) = &mut self.moves else {
            return;
        };
        if let Some(next) = moves.next() {
            self.hole_ends = ends_hole(&next, moves);
            if let Err(alarm) = self.take(&next, settings) {
                self.fail(&alarm);
            }
        } else {
            self.moves = None;
            // A hole that stays locked ends at its bottom, and the machine does not stop there.
            self.hole_ends = false;
            if let Some(tap) = self.collected()
                && !tap.part.returns
            {
                self.guard = Guard::in_phase(tap.hole);
            }
            self.close_tap(settings);
            self.complete = !self.planned.is_empty();
        }
    }

    #[inline(never)]
    fn fail(&mut self, alarm: &Alarm) {
        self.failed = true;
        self.moves = None;
        self.ending = None;
        self.pass.clear();
        self.chain.begin_anew();
        self.plan = None;
        self.tap = None;
        self.float_number = None;
        self.planned.clear();
        self.queue(alarm.span, Stops::default(), Action::Alarm(*alarm));
    }

    #[inline(never)]
    fn hand_over(&mut self, segments: &mut SegmentIn<'_>) -> bool {
        let has_plan = |segment: &Segment| matches!(segment.action, Action::Planned);
        let needs_plan = self.planned.iter().any(has_plan);
        if segments.room() < self.planned.len() || (needs_plan && !segments.takes_plan()) {
            return false;
        }
        self.joined.interrupt();
        // The queue has room, so the answer is always yes.
        if needs_plan && let Some(plan) = &self.plan {
            self.failed |= !segments.put_plan(plan);
        }
        for segment in &self.planned {
            self.failed |= !segments.put(segment);
        }
        self.planned.clear();
        self.complete = false;
        true
    }

    // Large values stay out of each other's stack frames, here and in the files below: the planner of a pass is at the
    // bottom of all of them [D140].

    /// Appends a segment to the planned ones and moves them all into the queue.
    fn queue(&mut self, span: Span, stops: Stops, action: Action) {
        self.put(self.number, span, stops, action);
        self.complete = true;
    }

    const fn segment(&self, number: u32, span: Span, stops: Stops, action: Action) -> Segment {
        Segment {
            number,
            span,
            epoch: self.epoch,
            cut: self.cut,
            stops,
            action,
        }
    }

    #[inline(never)]
    fn put(&mut self, number: u32, span: Span, stops: Stops, action: Action) {
        let segment = self.segment(number, span, stops, action);
        // Four places: a pass, its completion, its retract and one to spare.
        if self.planned.push(segment).is_err() {
            self.failed = true;
        }
    }

    #[inline(never)]
    fn take(&mut self, next: &Move, settings: &Settings<'_>) -> Result<(), Alarm> {
        self.number = self.number.saturating_add(1);
        if let MoveKind::Thread(thread) = next.kind {
            if thread.part != ChainPart::Whole {
                let taken = self.chain.take(self.position, next, self.number);
                self.position = next.to;
                return taken;
            }
            if self.pass.is_empty() {
                self.pass_start = self.position;
                self.pass_number = self.number;
            }
            if self.pass.push(*next).is_err() {
                return Err(Alarm::new(Code::StrokeTooShort, next.span));
            }
            self.position = next.to;
            if thread.last {
                self.plan_pass(next, thread.rpm, settings)?;
                self.pass.clear();
            }
            return Ok(());
        }
        if self.take_float(next, settings) {
            return Ok(());
        }
        if let MoveKind::Tap(tap) = &next.kind {
            return self.take_stroke(next, tap, settings);
        }
        if let (MoveKind::Dwell(time), Some(tap)) = (&next.kind, self.collected()) {
            let ticks = dwell_ticks(*time, settings.params.tick_us());
            if tap.push(TapStep::Dwell(ticks)) {
                return Ok(());
            }
        }
        let stops = self.stops(next, settings.params);
        let action = match next.kind {
            MoveKind::Rapid | MoveKind::Feed(_) | MoveKind::Arc { .. } => {
                return self.take_timed(next, stops, settings);
            }
            MoveKind::Dwell(time) => match dwell_ticks(time, settings.params.tick_us()) {
                0 => return Ok(()),
                ticks => Action::Dwell(ticks),
            },
            MoveKind::Spindle(SpindleCall {
                mode: SpindleMode::Rigid(choice),
                ..
            }) => Action::Rigid(settings.signals.spindle(choice, next.span)?),
            MoveKind::Spindle(SpindleCall {
                mode: SpindleMode::Orient(angle),
                ..
            }) => {
                let Settings { params, limits, .. } = settings;
                Action::Orient(Orientation::new(angle, params, limits, next.span)?)
            }
            MoveKind::Spindle(spindle) => Action::Spindle(spindle.rpm, spindle.law()),
            MoveKind::Aux(aux) => Action::Aux(aux, row_of(aux, settings.params)),
            MoveKind::Thread(_) | MoveKind::Tap(_) => return Ok(()),
        };
        self.queue(next.span, stops, action);
        Ok(())
    }

    /// A move driven by time.
    #[inline(never)]
    fn take_timed(
        &mut self,
        next: &Move,
        stops: Stops,
        settings: &Settings<'_>,
    ) -> Result<(), Alarm> {
        let timed = plan::timed(self.position, next, settings.limits)?;
        self.position = next.to;
        let Some(timed) = timed else {
            return Ok(());
        };
        if next.tag.is_none() && self.joined.takes(&timed, settings) {
            let segment = self.segment(self.number, next.span, stops, Action::Timed(timed));
            self.failed |= !self.joined.push(&segment, settings);
        } else {
            self.queue(next.span, stops, Action::Timed(timed));
        }
        Ok(())
    }

    fn stops(&self, next: &Move, params: &Params) -> Stops {
        let Some(tag) = next.tag else {
            return Stops {
                single_block: !matches!(next.kind, MoveKind::Spindle(_)),
                ..Stops::default()
            };
        };
        if is_tap(&tag) {
            return self.tap_stops(params);
        }
        let thread_cycle = tag.start != 0;
        let behind_stroke = thread_cycle && tag.stage == Stage::Retract;
        Stops {
            hold_not_inside: behind_stroke,
            hold_not_before: behind_stroke,
            // Threads stop at the end of each pass, a groove stops after every move.
            single_block: !thread_cycle || tag.stage == Stage::Return,
            frozen: thread_cycle.then_some(self.percent),
            ..Stops::default()
        }
    }
}

/// The row of a machine function.
#[inline(never)]
fn row_of(aux: Aux, params: &Params) -> Option<FunctionRow> {
    match aux {
        Aux::M(code) => params.function(code),
        Aux::T(_) => None,
    }
}

/// Drops the oldest call. The queue gives back a copy, which lies in no other stack frame.
#[inline(never)]
fn drop_oldest(calls: &mut CallOut<'_>) {
    take(calls);
}
