//! What a program hardly means, with the arithmetic: a thread far too high or too flat for its pitch, hundreds of pecks, a
//! feed of the other kind. Most of it is a number in another unit than the control reads.
//!
//! It sees the calls of a program in their order, and their moves. Alarms and warnings come with numbers that a program
//! or a machine file may silence. It must not know text.

use leadscrew_core::alarm::{Alarm, Arg, Code, Span};
use leadscrew_core::call::{
    Aux, Call, CallKind, FeedRate, GrooveCall, Position, TapAxis, ThreadCall, ThreadCycle,
};
use leadscrew_core::cycle::GrooveCount;
use leadscrew_core::moves::{Move, MoveKind};
use leadscrew_core::offsets::{Offsets, Source};
use leadscrew_core::params::Params;
use leadscrew_core::units::{Axis, Diameter, Length, StartAngle};
use leadscrew_language::steps;
use leadscrew_language::stock::Stock;

use crate::path::arc;
use crate::remains::{EDGE, Remains};

/// Height over pitch of a thread, in thousandths: flat square threads and deep buttress threads are inside.
const HEIGHT: core::ops::RangeInclusive<i64> = 150..=1_200;
/// Pecks of a whole groove.
const ALL_PECKS: u64 = 5_000;
/// Micrometres below which a first pass cuts nothing.
const FIRST_PASS_NM: i64 = 5_000;
/// Pitches in nanometres.
const PITCH: core::ops::RangeInclusive<i64> = 50_000..=50_000_000;
/// Turns a minute from which on a cut is meant: on a bar of 300 mm they are 9 m/min. A single digit selects a gear on a
/// control whose spindle is switched (S1 to S4 of a GSK).
const TURNS: i64 = 10;
/// The most different threads that are kept for their further starts.
const THREADS: usize = 256;

/// What has been seen of a program.
#[derive(Debug, Default)]
pub struct Plausible {
    rpm: i64,
    /// The block whose speed is below [`TURNS`], until a cut with it is told.
    slow: Option<Span>,
    /// Its speed follows the diameter.
    surface: bool,
    /// The highest cutting feeds of X and Z, in nanometres a minute; 0 where nothing is known of them.
    most: [i64; 2],
    /// Nose radii by the number of the offset, and that of the tool in use, in nanometres; 0 where nothing is known.
    noses: Vec<i64>,
    nose: i64,
    /// Where a stock is declared.
    remains: Option<Remains>,
    threads: Vec<Cut>,
}

/// Threads of the same end and lead. Each further start has another angle or begins elsewhere.
#[derive(Debug)]
struct Cut {
    end: (Length, Length),
    lead_nm: i64,
    height: Length,
    span: Span,
    starts: Vec<(Length, StartAngle)>,
    /// L.
    written: i64,
}

impl Plausible {
    /// A program for this machine that declares this stock.
    pub fn new(params: &Params, offsets: Option<&Offsets>, stock: Option<&Stock>) -> Self {
        let source = Source {
            params,
            table: offsets,
        };
        Self {
            most: [Axis::X, Axis::Z].map(|axis| params.max_feed(axis).nm_per_min()),
            noses: (0..=99)
                .map(|offset| source.nose(offset).radius.abs().nm())
                .collect(),
            remains: stock.map(Remains::new),
            ..Self::default()
        }
    }

    /// Looks at the next move of a call, for a tool at `at`. What is told comes with its place in the work: Z, radius in
    /// millimetres.
    pub fn step(
        &mut self,
        call: &Call,
        at: Position,
        step: &Move,
        tell: &mut dyn FnMut(Alarm, (f64, f64)),
    ) {
        let turns = self.rpm != 0;
        let Some(remains) = &mut self.remains else {
            return;
        };
        let of_work = |position: Position| {
            let (z, x) = (position.z - call.origin.z, position.x - call.origin.x);
            (z.nm() as f64 / 1e6, x.nm() as f64 / 1e6)
        };
        let (from, to) = (of_work(at), of_work(step.to));
        match step.kind {
            MoveKind::Rapid => {
                let Some((z, x)) = remains.entered(from, to) else {
                    return;
                };
                // Nobody looks for the place more closely than to a micrometre.
                let [diameter, z_there] =
                    [2.0 * x, z].map(|mm| length_of((mm * 1e3).round() / 1e3));
                let figures = [
                    Arg::Diameter(Diameter::from_nm(diameter.nm())),
                    Arg::Length(z_there),
                ];
                tell(
                    Alarm::new(Code::RapidInStock, step.span).with(figures),
                    (z, x),
                );
            }
            MoveKind::Feed(_) => {
                let depth = remains.depth(from, to);
                if turns && depth > EDGE + 1e-6 {
                    let figures = [depth, EDGE].map(|mm| Arg::Length(length_of(mm)));
                    tell(
                        Alarm::new(Code::CutBeyondInsert, step.span).with(figures),
                        to,
                    );
                }
                remains.cut(from, to);
            }
            MoveKind::Thread(_) | MoveKind::Tap(_) => remains.cut(from, to),
            MoveKind::Arc {
                i, k, clockwise, ..
            } => {
                let (z, x) = (k.nm() as f64 / 1e6, i.nm() as f64 / 1e6);
                let points = arc(from, to, (from.0 + z, from.1 + x), clockwise);
                for pair in points.windows(2) {
                    remains.cut(pair[0], pair[1]);
                }
            }
            MoveKind::Dwell(_) | MoveKind::Spindle(_) | MoveKind::Aux(_) => {}
        }
    }

    /// All columns of a groove at once: their moves may be many.
    fn groove(&mut self, groove: &GrooveCall, origin: &Position) {
        let Some(remains) = &mut self.remains else {
            return;
        };
        let mm = |length: Length| length.nm() as f64 / 1e6;
        let (z, x) = (mm(groove.start.z - origin.z), mm(groove.start.x - origin.x));
        let (end_z, end_x) = (
            mm(groove.end_z.value - origin.z),
            mm(groove.end_x.value - origin.x),
        );
        match groove.axis {
            TapAxis::X => remains.groove(z, end_z, x, end_x),
            TapAxis::Z if x.abs().max(end_x.abs()) < 1e-6 => remains.drill(z, end_z),
            TapAxis::Z => remains.trepan(end_z),
        }
    }

    /// Looks at the next call, for a tool at `at`.
    pub fn call(&mut self, call: &Call, at: Position, tell: &mut dyn FnMut(Alarm)) {
        self.mind_speed(call, at, tell);
        match &call.kind {
            CallKind::Spindle(spindle) => {
                self.surface = spindle.law().is_some();
                self.rpm = if spindle.turns() {
                    i64::from(spindle.rpm.get()).abs()
                } else {
                    0
                };
                self.slow = (!self.surface && (1..TURNS).contains(&self.rpm)).then_some(call.span);
            }
            CallKind::Rapid(to) => self.turned_to(at, *to, call.span, tell),
            CallKind::Line(to, feed) => {
                self.turned_to(at, *to, call.span, tell);
                if to.c == at.c {
                    self.feed(*feed, call.span, tell);
                    self.within_nose(*feed, call.span, tell);
                    let way = [to.x - at.x, to.z - at.z].map(|way| way.nm().unsigned_abs());
                    self.keeps_up(*feed, way, call.span, tell);
                }
            }
            CallKind::Arc(arc) => {
                self.feed(arc.feed, call.span, tell);
                self.within_nose(arc.feed, call.span, tell);
                // Somewhere near its quadrants either axis goes alone.
                self.keeps_up(arc.feed, [1, 0], call.span, tell);
                self.keeps_up(arc.feed, [0, 1], call.span, tell);
            }
            CallKind::Groove(groove) => {
                pecks(groove, call.span, tell);
                self.groove(groove, &call.origin);
                self.feed(groove.feed, call.span, tell);
                let way = match groove.axis {
                    TapAxis::X => [1, 0],
                    TapAxis::Z => [0, 1],
                };
                self.keeps_up(groove.feed, way, call.span, tell);
            }
            CallKind::Aux(Aux::T(number)) => {
                let known = self.noses.get(usize::from(number % 100));
                self.nose = known.copied().unwrap_or(0);
            }
            CallKind::Thread(thread) => self.thread(thread, call.span, tell),
            CallKind::Tap(tap) => lead(tap.lead.value.rounded(), tap.lead.span, tell),
            _ => {}
        }
    }

    /// A cut or a thread at a few turns a minute, told once at the block of its speed [D571].
    fn mind_speed(&mut self, call: &Call, at: Position, tell: &mut dyn FnMut(Alarm)) {
        let cuts = match call.kind {
            CallKind::Line(to, _) => to.c == at.c && to != at,
            CallKind::Arc(_) | CallKind::Groove(_) | CallKind::Thread(_) | CallKind::Tap(_) => true,
            _ => false,
        };
        if cuts && let Some(span) = self.slow.take() {
            let told = Alarm::new(Code::SpeedOdd, span).word(b'S');
            tell(told.with([Arg::Int(self.rpm)]));
        }
    }

    /// The program is over.
    pub fn end(&mut self, tell: &mut dyn FnMut(Alarm)) {
        for cut in self.threads.drain(..) {
            let starts = cut.written.max(cut.starts.len() as i64).max(1);
            let pitch = cut.lead_nm / starts;
            if pitch == 0 {
                continue;
            }
            let share = cut.height.nm().saturating_mul(1_000) / pitch;
            if !HEIGHT.contains(&share) {
                let figures = [
                    Arg::Length(cut.height),
                    Arg::Length(Length::from_nm(pitch)),
                    Arg::Decimal(share, 3),
                ];
                tell(
                    Alarm::new(Code::ThreadHeightOdd, cut.span)
                        .word(b'P')
                        .with(figures),
                );
            }
        }
    }

    fn thread(&mut self, thread: &ThreadCall, span: Span, tell: &mut dyn FnMut(Alarm)) {
        let nm = thread.lead.value.rounded().nm();
        let starts = i64::from(thread.starts.value.max(1));
        let of_lead = if thread.lead.span == Span::default() {
            span
        } else {
            thread.lead.span
        };
        lead(Length::from_nm(nm / starts), of_lead, tell);
        if !matches!(thread.cycle, ThreadCycle::G76 | ThreadCycle::G78) {
            return;
        }
        let (height, first) = (thread.height, thread.first_depth);
        let figures = [Arg::Length(first.value), Arg::Length(height.value)];
        if first.value > height.value {
            tell(
                Alarm::new(Code::FirstPassAboveHeight, first.span)
                    .word(b'Q')
                    .with(figures),
            );
        } else if first.value.nm() < FIRST_PASS_NM {
            tell(
                Alarm::new(Code::FirstPassTiny, first.span)
                    .word(b'Q')
                    .with(figures),
            );
        }
        let end = (thread.end_x.value, thread.end_z.value);
        let start = (thread.start.z, thread.first_angle);
        let is_another =
            |a: &(Length, StartAngle)| a.1 != start.1 || nm == 0 || (a.0 - start.0).nm() % nm != 0;
        let known = |cut: &&mut Cut| cut.end == end && cut.lead_nm == nm;
        let has_room = self.threads.len() < THREADS;
        match self.threads.iter_mut().find(known) {
            Some(cut) if cut.starts.iter().all(is_another) && cut.starts.len() < 99 => {
                cut.starts.push(start);
            }
            Some(_) => {}
            None if has_room => self.threads.push(Cut {
                end,
                lead_nm: nm,
                height: height.value,
                span: if height.span == Span::default() {
                    span
                } else {
                    height.span
                },
                starts: vec![start],
                written: starts,
            }),
            None => {}
        }
    }

    /// A feed that makes sense in the other of G98 and G99 alone.
    fn feed(&self, feed: FeedRate, span: Span, tell: &mut dyn FnMut(Alarm)) {
        if self.rpm == 0 {
            return;
        }
        let mm = 1_000_000;
        match feed {
            FeedRate::PerMinute(feed) => {
                let nm = feed.nm_per_min();
                // Two micrometres a turn.
                if nm > 0 && nm < 3 * mm && nm < self.rpm * 2_000 {
                    let figures = [Arg::Feed(feed), Arg::Int(self.rpm)];
                    tell(
                        Alarm::new(Code::FeedOfOtherMode, span)
                            .word(b'F')
                            .with(figures),
                    );
                }
            }
            FeedRate::PerTurn(feed, _) if feed.nm() > 3 * mm => {
                let figures = [Arg::Length(Length::from_nm(feed.nm())), Arg::Int(self.rpm)];
                tell(
                    Alarm::new(Code::FeedOfOtherMode, span)
                        .word(b'F')
                        .with(figures),
                );
            }
            FeedRate::PerTurn(..) => {}
        }
    }

    /// A feed per turn above the nose radius of the tool in use, where that is known [D276].
    fn within_nose(&self, feed: FeedRate, span: Span, tell: &mut dyn FnMut(Alarm)) {
        if let FeedRate::PerTurn(feed, _) = feed
            && self.rpm != 0
            && self.nose > 0
            && feed.nm() > self.nose
        {
            let figures = [feed.nm(), self.nose].map(|nm| Arg::Length(Length::from_nm(nm)));
            let alarm = Alarm::new(Code::CutBeyondInsert, span).word(b'F');
            tell(alarm.with(figures));
        }
    }

    /// A feed per turn that is faster than an axis cuts, at a speed that does not change [D252].
    fn keeps_up(&self, feed: FeedRate, way: [u64; 2], span: Span, tell: &mut dyn FnMut(Alarm)) {
        let FeedRate::PerTurn(feed, _) = feed else {
            return;
        };
        let length = (way[0] as f64).hypot(way[1] as f64);
        if self.rpm == 0 || self.surface || length < 0.5 || feed.nm() <= 0 {
            return;
        }
        let path = way
            .into_iter()
            .zip(self.most)
            .filter(|(way, most)| *way > 0 && *most > 0)
            .map(|(way, most)| most as f64 * length / way as f64)
            .fold(f64::INFINITY, f64::min);
        if (self.rpm * feed.nm()) as f64 > path * (1.0 + 1e-9) {
            let figures = [
                Arg::Length(Length::from_nm(feed.nm())),
                Arg::Int(self.rpm),
                Arg::Int((path / feed.nm() as f64).floor() as i64),
            ];
            tell(
                Alarm::new(Code::FeedBeyondAxis, span)
                    .word(b'F')
                    .with(figures),
            );
        }
    }

    /// C and another axis in one motion, while the spindle turns by itself.
    fn turned_to(&self, at: Position, to: Position, span: Span, tell: &mut dyn FnMut(Alarm)) {
        if self.rpm != 0 && to.c != at.c && (to.x != at.x || to.z != at.z) {
            tell(Alarm::new(Code::TurningAxisTurns, span).word(b'C'));
        }
    }
}

fn length_of(mm: f64) -> Length {
    Length::from_nm((mm * 1e6).round() as i64)
}

fn lead(pitch: Length, span: Span, tell: &mut dyn FnMut(Alarm)) {
    if pitch.nm() > 0 && !PITCH.contains(&pitch.nm()) {
        tell(
            Alarm::new(Code::LeadOdd, span)
                .word(b'F')
                .with([Arg::Length(pitch)]),
        );
    }
}

fn pecks(groove: &GrooveCall, span: Span, tell: &mut dyn FnMut(Alarm)) {
    let Some(peck) = groove.peck else {
        return;
    };
    let count = GrooveCount::of(groove);
    let depth = (groove.bottom().value - groove.level()).abs();
    let span = if peck.span == Span::default() {
        span
    } else {
        peck.span
    };
    let all = count.infeeds.saturating_mul(count.columns);
    if count.infeeds > steps::MOST || all > ALL_PECKS {
        let number = |count: u64| Arg::Int(i64::try_from(count).unwrap_or(i64::MAX));
        let figures = [
            number(count.infeeds),
            number(count.columns),
            Arg::Length(depth),
            Arg::Length(peck.value),
        ];
        tell(Alarm::new(Code::PecksMany, span).with(figures));
    } else if steps::is_beyond(peck.value, depth) {
        let figures = [Arg::Length(peck.value), Arg::Length(depth)];
        tell(Alarm::new(Code::PeckBeyondDepth, span).with(figures));
    }
    let width = groove.last().value - groove.first();
    if let Some(step) = groove
        .step
        .filter(|step| steps::is_of_other_unit(step.value, width))
    {
        let figures = [Arg::Length(step.value), Arg::Length(width.abs())];
        tell(Alarm::new(Code::PeckBeyondDepth, step.span).with(figures));
    }
}
