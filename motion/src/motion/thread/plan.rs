//! The plan of a threading pass: every figure the tick needs, from the moves of the pass, the axes' limits and the
//! spindle's speed.

use super::chain::{Corner, Joints};
use super::helix::HelixTravel;
use super::pace::Pace;
use super::ramp::{Ramp, Slope, inverse};
use super::shape::Shape;
use super::swing::limits;
use super::variable::VariableTravel;
use crate::alarm::{Alarm, Arg, Code, Span};
use crate::call::Position;
use crate::motion::ease::{Ease, Fine, Fraction, whole};
use crate::motion::lead::{travel_of, turns_of};
use crate::motion::limits::bounds;
use crate::moves::Move;
use crate::params::Params;
use crate::spindle::Limits;
use crate::units::{Axis, LeadChange, Length, Rpm, TurnRate, Turns, mul_div, signed};

/// Between the corners of a stroke of a chain the axes run straight for at least this many microseconds. One plan takes
/// over from the other in this time, and the background makes the one after it.
const STRAIGHT_US: u64 = 10_000;

/// Over this many microseconds a stop slows the angle down where the spindle hardly turns.
const SLOW_US: u32 = 100_000;

/// One threading pass, ready for [`ThreadRun`](super::ThreadRun).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ThreadPlan {
    pub(super) span: Span,
    pub(super) start: Position,
    pub(super) end: Position,
    /// X is the long axis.
    pub(super) long_x: bool,
    /// The long axis moves in the minus direction.
    pub(super) backward: bool,
    /// The spindle turns by M04: its angle falls.
    pub(super) reverse: bool,
    pub(super) travel: HelixTravel,
    pub(super) start_angle: Turns,
    /// L, the whole way on the long axis.
    pub(super) length: Fine,
    pub(super) join: Ease,
    pub(super) brake: Ease,
    /// Like the brake, but for a stop anywhere outside the short axis' corners.
    pub(super) stop: Ease,
    /// The join's `H` and the end of the brake, as angles since the helix was at the start point.
    pub(super) join_angle: Turns,
    pub(super) done_angle: Turns,
    pub(super) taper: Slope,
    pub(super) run_in: Ramp,
    /// Distance of the start point from the line's extension.
    pub(super) run_in_rise: Fine,
    pub(super) run_out: Ramp,
    /// The ramp of a retract in mid-thread (its `at` is unused), and the inverse of its slope.
    pub(super) retract: Ramp,
    pub(super) retract_inverse: Slope,
    /// Planned speed of the long axis in 2⁻¹⁶ nm per tick.
    pub(super) speed: Fine,
    pub(super) of_speed: Fraction,
    speed_limit: TurnRate,
    /// What a follower may do, where the spindle's angle is learned.
    follower: Limits,
    short_lag: Length,
    way_needed: Length,
    pub(super) link: Link,
}

/// The place of a plan in a chain. The default is none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Link {
    /// The corner to the stroke before: changes of both axes for each way on the helix. The join is its ease.
    pub gain: Slope,
    pub bend: Slope,
    /// Turns of the stroke.
    pub turns: Turns,
    /// From this angle on the next stroke takes over.
    pub over: Turns,
    /// Where the axes still run straight, or else the whole way.
    pub straight: Fine,
    /// A tick as a part (2⁻³¹) of a stop that slows the angle down.
    pub stop: u32,
    /// Begins where another stroke ends, and goes on with another.
    pub is_joined: bool,
    pub goes_on: bool,
}

impl ThreadPlan {
    /// Plans the pass for the faster of commanded and `measured` speed, with the margin of parameter 9010. `moves` are
    /// the pass's synchronous moves, one to three; the first of them starts at `from`. Pass [`TurnRate::ZERO`] if there
    /// is no measurement yet.
    ///
    /// # Errors
    /// - The spindle stands: [`Code::SpindleStopped`].
    /// - Lead times speed exceeds the limit of the long axis or, along a taper, of the short axis:
    ///   [`Code::LeadTooFast`].
    /// - The stroke is too short for joining and braking at this speed: [`Code::StrokeTooShortForSpeed`].
    /// - The run-in is too short for the short axis at this speed: [`Code::RunInTooFast`].
    pub fn new(
        from: Position,
        moves: &[Move],
        params: &Params,
        measured: TurnRate,
    ) -> Result<Self, Alarm> {
        Self::at_speed(from, moves, params, None, measured)
    }

    /// Like [`ThreadPlan::new`], but for the given commanded speed instead of that of the moves.
    pub fn for_rpm(
        from: Position,
        moves: &[Move],
        params: &Params,
        commanded: Rpm,
    ) -> Result<Self, Alarm> {
        Self::at_speed(from, moves, params, Some(commanded), TurnRate::ZERO)
    }

    /// Plans at a given speed. The plan and its parts are large, so each part is made in its final place.
    fn at_speed(
        from: Position,
        moves: &[Move],
        params: &Params,
        commanded: Option<Rpm>,
        measured: TurnRate,
    ) -> Result<Self, Alarm> {
        let mut plan = Self::default();
        if let Some(shape) = &Shape::of(from, moves) {
            plan.fill(shape, params, commanded, measured, None)?;
            Ok(plan)
        } else {
            let span = moves.first().map_or_else(Span::default, |first| first.span);
            Err(Alarm::new(Code::ThreadMovesMixed, span))
        }
    }

    #[inline(never)]
    pub(super) fn fill(
        &mut self,
        shape: &Shape,
        params: &Params,
        commanded: Option<Rpm>,
        measured: TurnRate,
        joints: Option<&Joints>,
    ) -> Result<(), Alarm> {
        let commanded = commanded.unwrap_or(shape.thread.rpm);
        let mut pace = Pace::new(params, commanded, measured);
        if joints.is_some() {
            pace = pace.in_chain();
        }
        pace.check(shape, params, commanded, measured)?;
        let machine = pace.machine(shape, params, pace.margin);
        let length = shape.fine_length();
        self.link.straight = length;
        match joints.and_then(|joints| joints.before) {
            Some(corner) => self.join_after(&corner),
            None => pace.run_in(shape, &machine, &mut self.join, &mut self.run_in)?,
        }
        let lag_way = match joints.and_then(|joints| joints.after) {
            Some(corner) => {
                self.go_on(shape, &pace, corner, params);
                None
            }
            None => pace.run_out(shape, &machine, params, &mut self.brake, &mut self.run_out),
        };
        let stop = match joints {
            Some(joints) => joints.stop,
            None => SLOW_US.checked_div(params.tick_us()).unwrap_or(1),
        };
        let part = (1_u32 << 31).checked_div(stop).unwrap_or(u32::MAX);
        self.link.stop = part.saturating_add(1);

        // Everything must fit: join and run-in before the locked part, brake and run-out after it.
        let before = self.join.half().max(shape.run_in);
        let behind = self.brake.half().max(shape.run_out);
        let behind = behind.max(length.saturating_sub(self.link.straight));
        let long_x = shape.thread.long_x;
        if before.saturating_add(behind) > length {
            let word = if long_x { b'X' } else { b'Z' };
            let code = if joints.is_some() {
                Code::StrokeTooShortInChain
            } else {
                Code::StrokeTooShortForSpeed
            };
            let alarm = shape.alarm(code).word(word);
            return Err(alarm.with([
                Arg::Length(shape.length),
                Arg::Length(whole(before)),
                Arg::Length(whole(behind)),
                Arg::Rpm(pace.nominal.rpm()),
            ]));
        }

        self.span = shape.span;
        (self.start, self.end) = (shape.from, shape.end);
        self.long_x = long_x;
        self.backward = shape.backward;
        self.reverse = pace.reverse;
        self.length = length;
        self.put_helix(shape)?;
        self.start_angle = shape.thread.pass_angle.turns();
        self.taper = shape.taper;
        self.run_in_rise = self.run_in.beside_at_start();
        let slopes = [self.run_in.slope, self.run_out.slope].map(i64::unsigned_abs);
        self.stop = machine.stop(slopes[0].max(slopes[1]), params.latency_apart_us());
        pace.retract(shape, &machine, &mut self.retract);
        self.retract_inverse = inverse(self.retract.slope as u64);
        let per_tick = mul_div(machine.speed << 16, u64::from(params.tick_us()), 1_000_000);
        self.speed = per_tick.clamp(1, i64::MAX as u64) as i64;
        self.of_speed = Fraction::of(self.speed);
        self.speed_limit = pace.limit;
        if params.learns_spindle() {
            self.follower = match joints {
                None => {
                    let long = bounds(params, shape.axes().0);
                    limits(params, &long, [machine.speed; 2], pace.limit)
                }
                // One follower goes through all strokes.
                Some(joints) => {
                    let least = bounds(params, Axis::X).least(&bounds(params, Axis::Z));
                    let fastest =
                        [joints.speed, joints.helix].map(|speed| speed.max(machine.speed));
                    limits(params, &least, fastest, pace.limit)
                }
            };
        }
        if let Some(way) = lag_way {
            // Uses the tick's own arithmetic, so that the last setpoint equals this position to the nanometre.
            self.end = self.position(length, None, None);
            self.short_lag = if long_x {
                shape.end.z - self.end.z
            } else {
                shape.end.x - self.end.x
            };
            self.way_needed = whole(way);
        }
        Ok(())
    }

    /// The stroke begins with a corner to the one before.
    fn join_after(&mut self, corner: &Corner) {
        self.join = corner.ease;
        self.link.is_joined = true;
        self.link.gain = corner.gain;
        self.link.bend = corner.bend;
    }

    /// Another stroke takes over: before the half `corner` to it, and [`STRAIGHT_US`] after the corner to the one before.
    fn go_on(&mut self, shape: &Shape, pace: &Pace, corner: Turns, params: &Params) {
        let during = |micros: u64| {
            let raw = mul_div(pace.limit.raw() as u64, micros, 1_000_000);
            Turns::from_raw(signed(raw))
        };
        let lead = shape.thread.lead;
        let lag = params.latency_apart_us();
        let straight = during(STRAIGHT_US.saturating_add(lag));
        let turns = turns_of(lead, shape.fine_length());
        self.link.goes_on = true;
        self.link.turns = turns;
        // Two ticks go by from the decision to the first tick of the next plan.
        self.link.over = turns - corner - during(u64::from(params.tick_us()).saturating_mul(2));
        let behind = travel_of(lead, corner + straight);
        self.link.straight = shape.fine_length().saturating_sub(behind);
    }

    /// The helix, and the angles at which the axis leaves rest and is at rest again.
    #[inline(never)]
    fn put_helix(&mut self, shape: &Shape) -> Result<(), Alarm> {
        let lead = shape.thread.lead;
        self.join_angle = turns_of(lead, self.join.half());
        let behind = turns_of(shape.last, self.brake.half());
        let variable = VariableTravel::new(
            lead,
            shape.thread.change,
            shape.last,
            shape.length,
            self.join_angle + Turns::ONE,
            behind + Turns::ONE,
        );
        self.done_angle = match &variable {
            Some(law) => law.turns() + behind,
            None if shape.thread.change != LeadChange::NONE => {
                return Err(shape.alarm(Code::ThreadMovesMixed));
            }
            None => turns_of(lead, self.length.saturating_add(self.brake.half())),
        };
        let half = lead.parts().1 >> 1;
        self.travel = HelixTravel::new(lead, self.join_angle, self.done_angle, half);
        self.travel.variable = variable.unwrap_or_default();
        Ok(())
    }

    /// Turns of the stroke, where the lead changes.
    #[must_use]
    pub fn variable_turns(&self) -> Option<Turns> {
        let law = &self.travel.variable;
        (!law.is_none()).then(|| law.turns())
    }

    /// The block.
    #[must_use]
    pub const fn span(&self) -> Span {
        self.span
    }

    /// Another stroke takes over before this one comes to rest.
    #[must_use]
    pub const fn goes_on(&self) -> bool {
        self.link.goes_on
    }

    /// The stroke goes on where another one ends.
    #[must_use]
    pub const fn is_joined(&self) -> bool {
        self.link.is_joined
    }

    /// True if X is the long axis.
    #[must_use]
    pub const fn long_x(&self) -> bool {
        self.long_x
    }

    /// True if the spindle must turn by M04: its angle falls.
    #[must_use]
    pub const fn is_reverse(&self) -> bool {
        self.reverse
    }

    /// Where the tool stands before the pass.
    #[must_use]
    pub const fn start(&self) -> Position {
        self.start
    }

    /// Where the tool stands after the pass: D's plane on the long axis. If the short axis' limits do not let it keep
    /// up, it stands short of the run-out's end by [`ThreadPlan::run_out_lag`].
    #[must_use]
    pub const fn end(&self) -> Position {
        self.end
    }

    /// The end of the pass's line that is nearer to `home` on the short axis. The run-out does not count.
    #[must_use]
    #[inline(never)]
    pub fn level_towards(&self, home: Length) -> Length {
        let start = self.short_start();
        let end = start + whole(self.line(self.length));
        if (home - end).abs() < (home - start).abs() {
            end
        } else {
            start
        }
    }

    /// How far the run-out ends beside the line, signed along the short axis; zero without one.
    #[must_use]
    pub fn beyond_line(&self) -> Length {
        if self.run_out.slope == 0 {
            return Length::ZERO;
        }
        let end = if self.long_x { self.end.z } else { self.end.x };
        end - self.short_start() - whole(self.line(self.length))
    }

    /// Lead-in: the way from the start point to the point from which the axis stands on the exact helix.
    #[must_use]
    pub const fn lead_in(&self) -> Length {
        Length::from_nm(self.join.half_nm())
    }

    /// How the axis gets onto the helix: over twice the lead-in of the helix' travel its speed grows to that of the
    /// helix, with an acceleration that rises over this part of it, is steady, and falls over the same part. At any speed
    /// of the spindle.
    #[must_use]
    pub const fn join_rise(&self) -> Length {
        Length::from_nm(self.join.rise_nm())
    }

    /// Travel of the short axis along the thread's line for travel of the long one, in 2⁻⁴⁰.
    #[must_use]
    pub const fn taper(&self) -> i64 {
        self.taper
    }

    /// The way over which the axis leaves the lead and comes to rest in D's plane.
    #[must_use]
    pub const fn braking(&self) -> Length {
        Length::from_nm(self.brake.half_nm())
    }

    /// The part of the braking that lies before the run-out: thread with a falling lead.
    #[must_use]
    pub fn falling_lead(&self) -> Length {
        let run_out = if self.run_out.slope == 0 {
            0
        } else {
            self.length.wrapping_sub(self.run_out.at)
        };
        whole(self.brake.half().wrapping_sub(run_out).max(0))
    }

    /// The distance that the short axis still lacks at the end of the run-out (signed). A time-driven move has to
    /// follow.
    #[must_use]
    pub const fn run_out_lag(&self) -> Length {
        self.short_lag
    }

    /// The K that would suffice at this speed. Zero if the short axis does not lag.
    #[must_use]
    pub const fn run_out_needed(&self) -> Length {
        self.way_needed
    }

    /// The spindle speed up to which the plan keeps every limit (magnitude).
    #[must_use]
    pub const fn speed_limit(&self) -> TurnRate {
        self.speed_limit
    }

    /// What a follower of the spindle's angle may do in this pass; zero where nothing is learned.
    #[must_use]
    pub const fn follower(&self) -> &Limits {
        &self.follower
    }

    /// Spindle angle at which the long axis leaves rest, counted in the turning direction from the index. Whole turns
    /// of this angle have no meaning.
    #[must_use]
    pub fn leaves_at(&self) -> Turns {
        self.start_angle - self.join_angle
    }

    /// The alarm for a spindle whose `speed` exceeds [`ThreadPlan::speed_limit`].
    #[must_use]
    pub fn too_fast(&self, speed: TurnRate) -> Alarm {
        Alarm::new(Code::SpindleTooFast, self.span).with([
            Arg::Rpm(speed.abs().rpm()),
            Arg::Rpm(self.speed_limit.rpm()),
        ])
    }

    /// Turns of the spindle from the instant the long axis leaves rest until it is at rest again.
    #[must_use]
    pub fn turns(&self) -> Turns {
        self.join_angle + self.done_angle
    }
}
