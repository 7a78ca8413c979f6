//! Random contours whose cuts are joined: limits, the tolerance at corners, and where they end.

use crate::machine::{self, Watch};
use crate::operator::Operator;
use crate::random::Random;
use leadscrew_core::alarm::Span;
use leadscrew_core::call::{FeedRate, Position};
use leadscrew_core::lookahead::{Due, Lookahead};
use leadscrew_core::motion::{
    Action, Arrival, Conditions, Cut, Epoch, Executor, Limits, Pace, Rate, Segment, Setpoint,
    Stops, Stretch, Task, Timed, plan,
};
use leadscrew_core::moves::{Move, MoveKind};
use leadscrew_core::params::{Entry, Params};
use leadscrew_core::spindle::Observer;
use leadscrew_core::units::{Feed, Length, Ticks};
use std::collections::VecDeque;
use std::f64::consts::TAU;

fn contours() -> u32 {
    leadscrew_seed::amount(1_000, 2_500)
}
const CONTOURS_OF_A_MACHINE: u32 = 50;
/// As many as on a board.
const QUEUE: usize = 32;

#[test]
fn no_setpoint_exceeds_a_limit_or_leaves_the_tolerance() {
    leadscrew_seed::volume(3, |seed| {
        let mut random = Random::new(seed);
        let mut sum = Sum::default();
        while sum.contours < contours() {
            let mut params = machine::random(&mut random);
            let tolerance = random.decades(300.0, 1e6);
            let entry = Entry::find_text("9033").expect("the parameter exists");
            params.set(entry, tolerance).expect("within its range");
            let limits = Limits::from_params(&params);
            for _ in 0..CONTOURS_OF_A_MACHINE {
                let cuts = random_contour(&mut random, &limits);
                let mut driven = Driven::new(&params, &limits, &cuts, &mut random);
                if let Err(what) = driven.run(&mut random, tolerance as f64) {
                    panic!(
                        "contour {}: {what}\ntolerance {tolerance} nm, {limits:?}\n{}",
                        sum.contours,
                        told(&cuts)
                    );
                }
                sum.add(&driven, cuts.len());
            }
        }
        println!(
            "{} contours of {} cuts, {} corners passed without a stop, {} setpoints, {} given up; \
             most of speed, acceleration, jerk, tolerance used: {:.3?}, {:.3}",
            sum.contours, sum.cuts, sum.passed, sum.ticks, sum.given_up, sum.used, sum.off
        );
        // Most corners are passed, and the tolerance is used and not merely kept.
        assert!(sum.passed > sum.cuts / 4, "{}", sum.passed);
        assert!(sum.off > 0.5, "{}", sum.off);
        assert!(sum.given_up > contours() / 100);
    });
}

#[derive(Default)]
struct Sum {
    contours: u32,
    cuts: usize,
    passed: usize,
    ticks: u64,
    given_up: u32,
    used: [f64; 3],
    off: f64,
}

impl Sum {
    fn add(&mut self, driven: &Driven<'_>, cuts: usize) {
        self.contours += 1;
        self.cuts += cuts;
        self.passed += driven.passed;
        self.ticks += driven.tick;
        self.given_up += u32::from(driven.gave_up);
        self.off = self.off.max(driven.off);
        for (most, used) in self.used.iter_mut().zip(driven.watch.used) {
            *most = most.max(used);
        }
    }
}

/// The executor with its queues, as on a board.
struct Driven<'a> {
    cuts: &'a [Timed],
    limits: &'a Limits,
    executor: Executor,
    lookahead: Lookahead,
    segments: VecDeque<Segment>,
    stretches: VecDeque<Stretch>,
    observer: Observer,
    watch: Watch,
    /// Cuts that have come, and those that the tool has ended.
    came: usize,
    ended: usize,
    passed: usize,
    tick: u64,
    gave_up: bool,
    /// The largest distance from the contour, as a part of the tolerance.
    off: f64,
    /// Ticks between two calls, at most.
    pause: i64,
}

impl<'a> Driven<'a> {
    fn new(params: &Params, limits: &'a Limits, cuts: &'a [Timed], random: &mut Random) -> Self {
        let mut executor = Executor::new(Arrival {
            tolerance_percent: 5,
            speed_ticks: 1_000,
            ticks_per_minute: 60_000,
        });
        let start = cuts[0].path.start();
        executor.set_position(start);
        Self {
            cuts,
            limits,
            executor,
            lookahead: Lookahead::new(),
            segments: VecDeque::new(),
            stretches: VecDeque::new(),
            observer: Observer::new(4096, 100, 1000),
            watch: Watch::new(params, start),
            came: 0,
            ended: 0,
            passed: 0,
            tick: 0,
            gave_up: false,
            off: 0.0,
            pause: [0, 0, 3, 60, 400][random.below(5) as usize],
        }
    }

    /// Calls come, and cuts leave for the queue.
    fn feed(&mut self, random: &mut Random) {
        loop {
            let room = self.segments.len() < QUEUE && self.stretches.len() < 2 * QUEUE - 7;
            let all = self.came == self.cuts.len();
            if self.lookahead.is_full() || (all && !self.lookahead.is_empty()) {
                if !room {
                    return;
                }
                self.leave(all);
                continue;
            }
            let starves = self.segments.len() < 2 && !self.lookahead.is_empty();
            if all || (self.pause > 0 && !random.one_in(self.pause)) {
                if starves && room && random.one_in(20) {
                    self.leave(false);
                }
                return;
            }
            let segment = Segment {
                number: self.came as u32 + 1,
                span: Span::default(),
                epoch: Epoch::default(),
                cut: Cut::NONE,
                stops: Stops::NONE,
                action: Action::Timed(self.cuts[self.came]),
            };
            assert!(self.lookahead.push(&segment, self.limits));
            self.came += 1;
        }
    }

    fn leave(&mut self, closed: bool) {
        let mut due = Due::NONE;
        assert!(self.lookahead.pop(self.limits, closed, &mut due));
        self.segments.extend(due.segment);
        self.stretches.extend(due.stretches);
    }

    fn run(&mut self, random: &mut Random, tolerance: f64) -> Result<(), String> {
        let mut operator = Operator::random(random, Pace::Cutting);
        let single = random.one_in(8);
        let mut setpoint = Setpoint::default();
        let most = 2_000_000;
        let mut begun = false;
        loop {
            if !self.gave_up {
                self.feed(random);
            }
            if self.executor.is_free() {
                if begun {
                    self.segments.pop_front();
                    self.ended += 1;
                    begun = false;
                }
                let all = self.came == self.cuts.len() && self.lookahead.is_empty();
                if self.gave_up || (all && self.segments.is_empty()) {
                    break;
                }
                if let Some(segment) = self.segments.front() {
                    self.executor.begin(Task {
                        segment,
                        plan: None,
                    });
                    begun = true;
                }
            }
            let rate = operator.rate(random, self.tick);
            let conditions = Conditions {
                leads_out: true,
                observer: &self.observer,
                learner: None,
                ahead_x: Ticks::whole(0),
                ahead_z: Ticks::whole(0),
                feed: rate,
                rapid: rate,
                hold: false,
                more: false,
                single,
                stretch: self.stretches.front(),
            };
            let task = begun.then(|| Task {
                segment: &self.segments[0],
                plan: None,
            });
            if self.tick.is_multiple_of(8)
                && operator.gives_up(self.tick / 8)
                && begun
                && rate != Rate::HOLD
            {
                self.executor.stop(task);
                self.gave_up = true;
            }
            let task = begun.then(|| Task {
                segment: &self.segments[0],
                plan: None,
            });
            self.executor
                .tick(&conditions, task, &mut setpoint)
                .map_err(|alarm| format!("{alarm:?}"))?;
            if self.executor.has_taken() {
                self.stretches.pop_front();
            }
            if self.executor.has_crossed() {
                let over = self.segments.pop_front().expect("it was under way");
                let Action::Timed(over) = over.action else {
                    panic!("all are")
                };
                self.ended += 1;
                self.passed += 1;
                if self.segments.is_empty() {
                    return Err(format!("tick {}: nothing to go on with", self.tick));
                }
                let next = self.segments.front().map(|segment| Task {
                    segment,
                    plan: None,
                });
                self.executor.cross(over.length, next, &mut setpoint);
            }
            self.tick += 1;
            self.watch
                .setpoint(setpoint.position, Pace::Cutting)
                .map_err(|excess| format!("tick {}, cut {}: {excess}", self.tick, self.ended))?;
            // Looking at the contour takes longer than all else: not in every tick.
            if !(self.tick + self.cuts.len() as u64).is_multiple_of(5) {
                continue;
            }
            let off = self.off(setpoint.position);
            // Each mean rounds, and so does the path.
            if off > tolerance + 2.0 {
                return Err(format!(
                    "tick {}, cut {}: {off:.1} nm off the contour",
                    self.tick, self.ended
                ));
            }
            self.off = self.off.max((off - 2.0) / tolerance);
            if self.tick > most {
                return Err(format!(
                    "cut {} never ends: {} in the queue, {:?}, {} have come, single block {single}, given up {}, at {:?}",
                    self.ended,
                    self.segments.len(),
                    self.stretches,
                    self.came,
                    self.gave_up,
                    setpoint.position
                ));
            }
        }
        if self.gave_up {
            return Ok(());
        }
        let end = self.cuts[self.cuts.len() - 1].path.end();
        if self.ended != self.cuts.len() || setpoint.position != end {
            return Err(format!(
                "{} cuts ended, at {:?} and not at {end:?}",
                self.ended, setpoint.position
            ));
        }
        if !self.stretches.is_empty() {
            return Err(format!("{} stretches are left", self.stretches.len()));
        }
        Ok(())
    }

    /// The distance of a setpoint from the contour, near the cut under way.
    fn off(&self, at: Position) -> f64 {
        let first = self.ended.saturating_sub(24).min(self.cuts.len() - 1);
        let last = (self.ended + 2).min(self.cuts.len());
        let mut nearest = f64::MAX;
        for cut in self.cuts[first..last].iter().rev() {
            nearest = nearest.min(distance(cut, at));
            // Near enough: it is on this cut, and rounding is all.
            if nearest < 3.0 {
                break;
            }
        }
        nearest
    }
}

/// From a cut to a position. An arc is looked at in small steps near the place.
fn distance(cut: &Timed, at: Position) -> f64 {
    use leadscrew_core::motion::{Path, Travel};
    let off = |place: Position| {
        let (x, z) = ((place.x - at.x).nm() as f64, (place.z - at.z).nm() as f64);
        x.hypot(z)
    };
    match &cut.path {
        Path::Line(line) => {
            let (from, to) = (line.start(), line.end());
            let along = [(to.x - from.x).nm() as f64, (to.z - from.z).nm() as f64];
            let here = [(at.x - from.x).nm() as f64, (at.z - from.z).nm() as f64];
            let square = along[0] * along[0] + along[1] * along[1];
            let share = ((along[0] * here[0] + along[1] * here[1]) / square).clamp(0.0, 1.0);
            (here[0] - share * along[0]).hypot(here[1] - share * along[1])
        }
        Path::Arc(_) => {
            // Golden section would find a wrong place on a long arc: first coarse steps, then halves.
            let length = cut.length.nm();
            let place = |nm: i64| off(cut.path.at(Travel::of(Length::from_nm(nm))));
            let mut step = (length / 64).max(1);
            let mut best = (0..=64)
                .map(|i| (length * i / 64).min(length))
                .min_by(|a, b| place(*a).total_cmp(&place(*b)))
                .expect("there are some");
            while step > 1 {
                step = (step / 2).max(1);
                for next in [best - step, best + step] {
                    let next = next.clamp(0, length);
                    if place(next) < place(best) {
                        best = next;
                    }
                }
            }
            place(best)
        }
    }
}

/// Lines and arcs, one after the other: polylines of short chords, tangents, and corners of any angle.
fn random_contour(random: &mut Random, limits: &Limits) -> Vec<Timed> {
    let mut cuts = Vec::new();
    let mut at = Position::default();
    let mut heading = random.below(1 << 20) as f64 / (1 << 20) as f64 * TAU;
    let number = random.decades(2.0, 80.0);
    // Mostly small turns, or any.
    let turns = [0.002, 0.05, 0.5, 3.0][random.below(4) as usize];
    let size = random.decades(1e3, 3e6) as f64;
    // 3 to 1000 ticks for a usual cut, as far as the machine can.
    let tick = f64::from(limits.tick_us()) * 1e-6;
    let per_tick = 60.0 / tick;
    let usual =
        (size / random.decades(3.0, 1_000.0) as f64 * per_tick).clamp(60_000.0, 1e12) as i64;
    let mut feed = usual;
    while (cuts.len() as i64) < number {
        if random.one_in(12) {
            feed = usual / 4 + random.below(2 * usual);
        }
        let length = if random.one_in(10) {
            // Short against the others.
            random.decades(2.0, size) as f64
        } else {
            size * (0.5 + random.below(1_000) as f64 / 1_000.0)
        };
        let per_minute = FeedRate::PerMinute(Feed::from_nm_per_min(feed));
        heading += turns * (random.below(2_001) - 1_000) as f64 / 1_000.0;
        let mut to = at;
        let kind = if random.one_in(4) && length > 100.0 {
            // A tangent arc, at least at its beginning.
            let radius = random.decades((length / 5.0).max(20.0), 1e8) as f64;
            let turn = (length / radius).min(5.0);
            let side = if random.one_in(2) { 1.0 } else { -1.0 };
            let normal = heading + side * TAU / 4.0;
            let (i, k) = (
                (radius * normal.sin()).round(),
                (radius * normal.cos()).round(),
            );
            let out = normal + TAU / 2.0 + side * turn;
            to.x = at.x + Length::from_nm((i + radius * out.sin()).round() as i64);
            to.z = at.z + Length::from_nm((k + radius * out.cos()).round() as i64);
            heading += side * turn;
            MoveKind::Arc {
                i: Length::from_nm(i as i64),
                k: Length::from_nm(k as i64),
                clockwise: side < 0.0,
                feed: per_minute,
            }
        } else {
            to.x = at.x + Length::from_nm((length * heading.sin()).round() as i64);
            to.z = at.z + Length::from_nm((length * heading.cos()).round() as i64);
            MoveKind::Feed(per_minute)
        };
        let wanted = Move {
            span: Span::default(),
            to,
            kind,
            tag: None,
        };
        if let Ok(Some(timed)) = plan::timed(at, &wanted, limits)
            && Lookahead::joins(&timed, limits)
        {
            cuts.push(timed);
            at = to;
        }
    }
    cuts
}

fn told(cuts: &[Timed]) -> String {
    cuts.iter()
        .enumerate()
        .map(|(index, cut)| {
            format!(
                "{index}: {:?} {:?} nm at {:?}\n",
                cut.path, cut.length, cut.nominal
            )
        })
        .collect()
}
