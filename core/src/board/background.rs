//! The background: calls in, segments out.
//!
//! Expands one call after another, refuses what cannot be done before any of its moves, plans each move from where the
//! one before ends. A pass of a thread is queued together with its retract. Unbounded only in how often it is called:
//! one call of [`Background::step`] does one small piece of work. Knows nothing of ticks, drives or frames.

use heapless::{Deque, Vec};

use super::detour::Route;
use super::guard::Guard;
use super::queue::{CallOut, SegmentIn, filled, put, room, take};
use super::ticker::Notice;
use crate::alarm::{Alarm, Code, Span};
use crate::cycle::{Context, Cycle, Move, MoveKind, Moves, Stage, Tag, TapMove, expand};
use crate::feasible;
use crate::journal::{TapHole, TapRecord};
use crate::motion::{
    Action, Epoch, FloatPlan, Gear, Limits, Pass, Segment, Stops, Tap, TapStep, ThreadPlan,
    WaysOut, dwell_ticks, plan, stroke,
};
use crate::params::Params;
use crate::program::{
    Call, CallKind, HandChoice, Position, SpindleCall, SpindleChoice, SpindleMode, TapMode,
    TapNotes, ThreadCall,
};
use crate::signals::Signals;
use crate::units::{CentiRpm, Length, Rpm, TurnRate};

/// What planning depends on besides the program.
#[derive(Clone, Copy, Debug)]
pub struct Settings<'a> {
    /// The parameter set.
    pub params: &'a Params,
    /// The limits made of it.
    pub limits: &'a Limits,
    /// Spindle override in percent, as the operator has set it.
    pub spindle_percent: u8,
    /// The oldest segment in the queue is under way: it is there until it is done.
    pub begun: bool,
    /// The inputs.
    pub signals: Signals,
    /// The newest entry of the tap journal.
    pub tap: Option<&'a TapRecord>,
}

/// A tap whose strokes are being collected.
#[derive(Clone, Copy, Debug)]
struct Collecting {
    number: u32,
    span: Span,
    tap: Tap,
}

/// The state of the background.
#[derive(Debug)]
pub struct Background {
    moves: Option<Moves>,
    epoch: Epoch,
    /// The spindle override with which the call under expansion is planned.
    percent: u8,
    /// The inputs when the last hole began: one that goes on after K198 keeps them.
    hole_signals: Signals,
    /// The call under expansion asks for the end of the program.
    ending: Option<Span>,
    /// Where the last planned move ends.
    position: Position,
    /// Where the call under expansion starts: A of a cycle.
    home: Position,
    /// Moves so far.
    number: u32,
    /// The synchronous moves of the pass being collected, and where it starts.
    pass: Vec<Move, 3>,
    pass_start: Position,
    pass_number: u32,
    /// The tap being collected: from R until it is back there.
    tap: Option<Collecting>,
    /// The plan of an ordinary tapping call, and the number of the first stroke of the hole being collected.
    float: Option<FloatPlan>,
    float_number: Option<u32>,
    /// The move being taken is the last of its hole.
    hole_ends: bool,
    /// Planned and not queued yet; a pass waits here for its retract.
    planned: Deque<Segment, 4>,
    complete: bool,
    failed: bool,
    guard: Guard,
    /// For the tap journal: S of the call under expansion, and what else it keeps of the program.
    infeed: CentiRpm,
    notes: TapNotes,
}

impl Background {
    /// Nothing to do, at a position.
    #[must_use]
    pub fn new(position: Position) -> Self {
        Self::starting(position, Epoch::default())
    }

    const fn starting(position: Position, epoch: Epoch) -> Self {
        Self {
            moves: None,
            epoch,
            percent: 100,
            hole_signals: Signals::POWER_UP,
            ending: None,
            position,
            home: position,
            number: 0,
            pass: Vec::new(),
            pass_start: position,
            pass_number: 0,
            tap: None,
            float: None,
            float_number: None,
            hole_ends: false,
            planned: Deque::new(),
            complete: false,
            failed: false,
            guard: Guard::open(),
            infeed: CentiRpm::new(0),
            notes: TapNotes::METRIC,
        }
    }

    /// What the tick has to say: to forget everything, the calls not yet taken up too, or to plan a way out of the program.
    /// `tap`: the newest entry of the tap journal, that of the same tick included.
    pub fn heed(
        &mut self,
        notice: &Notice,
        calls: &mut CallOut<'_>,
        detours: &mut SegmentIn<'_>,
        limits: &Limits,
        tap: Option<&TapRecord>,
    ) {
        match notice {
            Notice::Restart(position, epoch) => {
                while take(calls).is_some() {}
                *self = Self::starting(*position, *epoch);
                self.guard = Guard::of(tap);
            }
            Notice::Route(route) => plan_route(route, limits, detours),
        }
    }

    /// True while a call is not fully planned and queued.
    #[must_use]
    pub fn is_busy(&self) -> bool {
        self.moves.is_some() || !self.planned.is_empty() || self.ending.is_some()
    }

    /// One piece of work. False where there is none that can be done now. A warning of the call just taken up comes back.
    pub fn step(
        &mut self,
        calls: &mut CallOut<'_>,
        segments: &mut SegmentIn<'_>,
        settings: &Settings<'_>,
    ) -> (bool, Option<Alarm>) {
        if self.complete {
            return (self.hand_over(segments), None);
        }
        if self.failed {
            return (false, None);
        }
        if let Some(moves) = &mut self.moves {
            if let Some(next) = moves.next() {
                self.hole_ends = ends_hole(&next, moves);
                if let Err(alarm) = self.take(&next, settings) {
                    self.fail(alarm);
                }
            } else {
                self.moves = None;
                // A hole that stays locked ends at its bottom, and nothing stops there.
                self.hole_ends = false;
                self.close_tap(settings);
                self.complete = !self.planned.is_empty();
            }
            return (true, None);
        }
        if let Some(span) = self.ending.take() {
            self.queue(span, Stops::default(), Action::End);
            // The next program counts its own moves.
            self.number = 0;
            return (true, None);
        }
        if calls
            .peek()
            .is_some_and(|call| filled(segments) > before(call, settings))
        {
            return (false, None);
        }
        // Where a return begins is known when everything before it has been done.
        if calls
            .peek()
            .is_some_and(|call| matches!(call.kind, CallKind::TapReturn(_)))
            && filled(segments) > 0
        {
            return (false, None);
        }
        let Some(call) = take(calls) else {
            return (false, None);
        };
        match self.open(&call, settings) {
            Ok(warning) => (true, warning),
            Err(alarm) => {
                self.fail(alarm);
                (true, None)
            }
        }
    }

    fn open(&mut self, call: &Call, settings: &Settings<'_>) -> Result<Option<Alarm>, Alarm> {
        let mut warning = None;
        let signals = self.latch(call, settings.signals);
        match &call.kind {
            CallKind::Thread(thread) => {
                feasible::thread(thread, call.span, settings.params)?;
                if settings.spindle_percent > 100 {
                    // The override makes it faster than the block says.
                    let faster = ThreadCall {
                        rpm: overridden(thread.rpm, settings.spindle_percent),
                        ..*thread
                    };
                    feasible::thread(&faster, call.span, settings.params)?;
                }
            }
            CallKind::Tap(tap) => {
                (self.infeed, self.notes) = (tap.speed, tap.notes);
                let report = feasible::tap(tap, signals, call.span, settings.params)?;
                warning = report.warnings().next();
                self.float = match tap.mode {
                    TapMode::Rigid => None,
                    TapMode::Floating => {
                        let hand = signals.hand(tap.hand);
                        Some(FloatPlan::new(tap, hand, call.span, settings.params)?)
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
    const fn latch(&mut self, call: &Call, now: Signals) -> Signals {
        if let CallKind::Tap(tap) = &call.kind {
            if tap.continues {
                return self.hole_signals;
            }
            self.hole_signals = now;
        }
        now
    }

    fn fail(&mut self, alarm: Alarm) {
        self.failed = true;
        self.moves = None;
        self.ending = None;
        self.pass.clear();
        self.tap = None;
        self.float_number = None;
        self.planned.clear();
        self.queue(alarm.span, Stops::default(), Action::Alarm(alarm));
    }

    fn hand_over(&mut self, segments: &mut SegmentIn<'_>) -> bool {
        if room(segments) < self.planned.len() {
            return false;
        }
        while let Some(segment) = self.planned.pop_front() {
            // There is room; the answer is always yes.
            if put(segments, segment).is_err() {
                self.failed = true;
            }
        }
        self.complete = false;
        true
    }

    /// Puts a segment behind what is planned and lets it all go to the queue.
    fn queue(&mut self, span: Span, stops: Stops, action: Action) {
        self.put(self.number, span, stops, action);
        self.complete = true;
    }

    fn put(&mut self, number: u32, span: Span, stops: Stops, action: Action) {
        let segment = Segment {
            number,
            span,
            epoch: self.epoch,
            stops,
            action,
        };
        // Four places: a pass, its completion, its retract and one to spare.
        if self.planned.push_back(segment).is_err() {
            self.failed = true;
        }
    }

    fn take(&mut self, next: &Move, settings: &Settings<'_>) -> Result<(), Alarm> {
        self.number = self.number.saturating_add(1);
        if let MoveKind::Thread(thread) = next.kind {
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
        if let (MoveKind::Dwell(time), Some(collecting)) = (&next.kind, &mut self.tap) {
            let ticks = dwell_ticks(*time, settings.params.tick_us());
            if collecting.tap.push(TapStep::Dwell(ticks)) {
                return Ok(());
            }
        }
        let stops = self.stops(next, settings.params);
        let action = match next.kind {
            MoveKind::Rapid | MoveKind::Feed(_) | MoveKind::Arc { .. } => {
                let timed = plan::timed(self.position, next, settings.limits)?;
                self.position = next.to;
                match timed {
                    Some(timed) => Action::Timed(timed),
                    None => return Ok(()),
                }
            }
            MoveKind::Dwell(time) => match dwell_ticks(time, settings.params.tick_us()) {
                0 => return Ok(()),
                ticks => Action::Dwell(ticks),
            },
            MoveKind::Spindle(SpindleCall {
                mode: SpindleMode::Rigid(choice),
                ..
            }) => Action::Rigid(settings.signals.spindle(choice, next.span)?),
            MoveKind::Spindle(spindle) => Action::Spindle(spindle.rpm),
            MoveKind::Aux(aux) => Action::Aux(aux),
            MoveKind::Thread(_) | MoveKind::Tap(_) => return Ok(()),
        };
        self.queue(next.span, stops, action);
        Ok(())
    }

    /// True for a stroke of an ordinary tap, and for the dwell between two: the whole hole is one segment, planned when its
    /// call was opened. It goes to the queue with its last stroke.
    fn take_float(&mut self, next: &Move, settings: &Settings<'_>) -> bool {
        let closes = match &next.kind {
            MoveKind::Tap(tap) if tap.mode == TapMode::Floating => tap.closes,
            MoveKind::Dwell(_) if self.float_number.is_some() => false,
            _ => return false,
        };
        let number = *self.float_number.get_or_insert(self.number);
        self.position = next.to;
        if closes && let Some(plan) = self.float {
            self.float_number = None;
            let stops = Stops {
                hold_not_inside: !settings.params.tap_hold_allowed(),
                ..self.tap_stops(settings.params)
            };
            self.put(number, next.span, stops, Action::Float(plan));
            self.complete = true;
        }
        true
    }

    /// A stroke of a tap. Back at R the way through the hole is complete and goes to the queue as one segment.
    fn take_stroke(
        &mut self,
        next: &Move,
        tap: &TapMove,
        settings: &Settings<'_>,
    ) -> Result<(), Alarm> {
        let travel = tap.axis.of(next.to) - tap.axis.of(self.position);
        let stroke = stroke(tap, travel, settings.params, settings.limits, next.span)?;
        let step = TapStep::Stroke(stroke);
        let taken = match &mut self.tap {
            Some(collecting) => collecting.tap.push(step),
            None => {
                let inward = (tap.bottom - tap.level).signum();
                let gear = Gear::new(tap.axis, tap.level, inward, tap.lead, tap.hand)
                    .ok_or_else(|| Alarm::new(Code::TapFeed, next.span))?;
                let feed_override = settings.params.tap_feed_override();
                let hole = TapHole {
                    axis: tap.axis,
                    level: tap.level,
                    bottom: tap.bottom,
                    lead: tap.lead,
                    hand: tap.hand,
                    spindle: tap.spindle,
                    speed: self.infeed,
                    notes: self.notes,
                };
                let mut collected = Tap::new(gear, hole, self.position, feed_override);
                let taken = collected.push(step);
                self.tap = Some(Collecting {
                    number: self.number,
                    span: next.span,
                    tap: collected,
                });
                taken
            }
        };
        if !taken {
            // Not reached: whatever the pecks, the way in and out has seven different steps at most.
            return Err(Alarm::new(Code::TapCallRange, next.span));
        }
        if let Some(collecting) = &mut self.tap {
            collecting.tap.part.closes |= tap.closes;
            collecting.tap.part.returns |= is_return(next);
        }
        self.position = next.to;
        if tap.axis.of(next.to) == tap.level {
            self.close_tap(settings);
            self.complete = true;
        }
        Ok(())
    }

    /// Lets the collected tap go to the queue.
    fn close_tap(&mut self, settings: &Settings<'_>) {
        let Some(collecting) = self.tap.take() else {
            return;
        };
        let stops = Stops {
            hold_not_inside: !settings.params.tap_hold_allowed(),
            ..self.tap_stops(settings.params)
        };
        self.put(
            collecting.number,
            collecting.span,
            stops,
            Action::Tap(collecting.tap),
        );
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
            // Threads stop at the end of each pass, a groove after every move (section 5 and 7 of the cycles' rules).
            single_block: !thread_cycle || tag.stage == Stage::Return,
            frozen: thread_cycle.then_some(self.percent),
            ..Stops::default()
        }
    }

    /// Single block stops behind each hole with 5200.6 = 1, else behind the last one only ([G84/G88 sheet], its table).
    fn tap_stops(&self, params: &Params) -> Stops {
        Stops {
            single_block: self.hole_ends,
            stops_after_last_hole: !params.tap_hold_allowed(),
            tap_cycle: true,
            ..Stops::default()
        }
    }

    fn plan_pass(&mut self, last: &Move, rpm: Rpm, settings: &Settings<'_>) -> Result<(), Alarm> {
        let rpm = overridden(rpm, self.percent);
        let plan = ThreadPlan::new(
            self.pass_start,
            &self.pass,
            settings.params,
            TurnRate::of_rpm(rpm),
        )?;
        let stops = Stops {
            hold_not_inside: true,
            frozen: Some(self.percent),
            ..Stops::default()
        };
        let pass = Pass {
            plan,
            ways: WaysOut::new(
                &plan,
                self.home,
                last.tag.map_or(Length::ZERO, |tag| tag.depth),
                settings.params.thread_clearance(),
            ),
            rpm,
        };
        self.put(self.pass_number, last.span, stops, Action::Thread(pass));
        // Where the short axis could not make up its lag inside K, time brings it to the end of the run-out.
        if plan.end() != last.to {
            let rest = Move {
                kind: MoveKind::Rapid,
                ..*last
            };
            if let Some(timed) = plan::timed(plan.end(), &rest, settings.limits)? {
                let stops = Stops {
                    hold_not_before: true,
                    ..stops
                };
                self.put(self.number, last.span, stops, Action::Timed(timed));
            }
        }
        Ok(())
    }
}

/// How many segments may be left in the queue when a call is taken up. The override of a thread cycle is that of its
/// beginning: only the move before it may be, and that under way. The signals of a hole are those of its beginning, too:
/// nothing may be left.
fn before(call: &Call, settings: &Settings<'_>) -> usize {
    const fn by_signal(spindle: SpindleChoice) -> bool {
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

/// A spindle speed at an override, ties away from zero.
#[must_use]
pub fn overridden(rpm: Rpm, percent: u8) -> Rpm {
    let scaled = i64::from(rpm.get()).saturating_mul(i64::from(percent));
    let rounded = scaled.saturating_add(50_i64.saturating_mul(scaled.signum())) / 100;
    Rpm::new(i32::try_from(rounded).unwrap_or(0))
}

/// True for the way out of a hole by itself.
fn is_return(next: &Move) -> bool {
    next.tag.is_some_and(|tag| tag.cycle == Cycle::G30P99)
}

/// True for the last move of a hole: never inside it, and the single block of a tapping cycle stops nowhere else.
fn ends_hole(next: &Move, rest: &Moves) -> bool {
    let Some(tag) = next.tag.filter(is_tap) else {
        return false;
    };
    let after = rest.clone().next().and_then(|after| after.tag);
    after.is_none_or(|after| after.pass != tag.pass)
}

const fn is_tap(tag: &Tag) -> bool {
    matches!(tag.cycle, Cycle::G84 | Cycle::G88 | Cycle::G30P99)
}

/// Plans a detour into its own queue, a mark behind it. A leg that cannot be planned ends it there: the tool stands.
fn plan_route(route: &Route, limits: &Limits, queue: &mut SegmentIn<'_>) {
    let mut at = route.from;
    let stops = Stops {
        hold_not_inside: true,
        hold_not_before: true,
        ..Stops::default()
    };
    let mut queue_up = |action| {
        let leg = Segment {
            number: 0,
            span: Span::default(),
            epoch: route.epoch,
            stops,
            action,
        };
        put(queue, leg).is_ok()
    };
    for to in route
        .via
        .into_iter()
        .flatten()
        .filter(|to| *to != route.from)
    {
        let leg = Move {
            span: Span::default(),
            to,
            kind: MoveKind::Rapid,
            tag: None,
        };
        let Ok(Some(timed)) = plan::timed(at, &leg, limits) else {
            break;
        };
        queue_up(Action::Timed(timed));
        at = to;
    }
    queue_up(Action::End);
}
