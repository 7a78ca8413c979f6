//! A pass planned: every figure the tick needs, from the moves of the pass, the axes' limits and the spindle's speed.

use super::ramp::{DIAGONAL, Machine, Slope, along, inverse, seen, slope};
use crate::alarm::{Alarm, Arg, Code, Span};
use crate::cycle::{Move, MoveKind, Stage, ThreadMove};
use crate::motion::ease::{Bounds, Ease, Fine};
use crate::motion::wide::{mul_div_up, ratio};
use crate::params::Params;
use crate::program::Position;
use crate::units::{Axis, Feed, Lead, Length, Rpm, TurnRate, Turns, mul_div};

/// A ramp of the short axis away from (or back to) the pass's line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Ramp {
    /// Signed slope behind the corner; 0 for no ramp.
    pub slope: Slope,
    pub ease: Ease,
    /// Run-in: where it ends; run-out: where it begins, along the long axis from the start.
    pub at: Fine,
}

impl Ramp {
    const NONE: Self = Self {
        slope: 0,
        ease: Ease::NONE,
        at: 0,
    };
}

/// One pass of a thread, ready for [`ThreadRun`](super::ThreadRun).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ThreadPlan {
    pub(super) span: Span,
    pub(super) start: Position,
    pub(super) end: Position,
    /// X is the long axis.
    pub(super) long_x: bool,
    /// The long axis runs towards minus.
    pub(super) backward: bool,
    /// M04: the spindle's angle falls.
    pub(super) reverse: bool,
    /// Travel per turn: whole nanometres, and the rest in 2⁻³² nm.
    pub(super) lead: (u64, u64),
    pub(super) start_angle: Turns,
    /// L.
    pub(super) length: Fine,
    pub(super) join: Ease,
    pub(super) brake: Ease,
    /// As the brake, for a stop anywhere outside the short axis' corners.
    pub(super) stop: Ease,
    /// The join's `H` and the end of the brake, as angles from where the helix is at the start point.
    pub(super) join_angle: Turns,
    pub(super) done_angle: Turns,
    pub(super) taper: Slope,
    pub(super) run_in: Ramp,
    /// How far beside the line's extension the start point lies.
    pub(super) run_in_rise: Fine,
    pub(super) run_out: Ramp,
    /// The ramp of a retract in mid-thread: `at` is unused; and the inverse of its slope.
    pub(super) retract: Ramp,
    pub(super) retract_inverse: Slope,
    /// Planned speed of the long axis in 2⁻¹⁶ nm per tick.
    pub(super) speed: Fine,
    speed_limit: TurnRate,
    short_lag: Length,
    way_needed: Length,
}

/// The run-in, stroke and run-out among the moves of a pass.
#[derive(Clone, Copy)]
struct Pass {
    run_in: Option<Position>,
    stroke: Position,
    run_out: Option<Position>,
    first: (Span, ThreadMove),
}

impl ThreadPlan {
    /// Plans the pass whose synchronous moves are `moves` (one to three, the first of them starting at `from`) for the
    /// faster of commanded and `measured` speed, with the margin of parameter 9010. Pass [`TurnRate::ZERO`] where
    /// nothing is measured yet.
    ///
    /// # Errors
    /// Spindle standing ([`Code::SpindleStopped`]); lead times speed above what the long axis may do
    /// ([`Code::LeadTooFast`]); the stroke too short for joining and braking at this speed
    /// ([`Code::StrokeTooShortForSpeed`]); the run-in too short for the short axis at this speed ([`Code::RunInTooFast`]).
    pub fn new(
        from: Position,
        moves: &[Move],
        params: &Params,
        measured: TurnRate,
    ) -> Result<Self, Alarm> {
        let (span, first) = first_thread(moves)?;
        Self::at_speed(from, moves, params, first.rpm, measured).map_err(|mut alarm| {
            alarm.span = span;
            alarm
        })
    }

    /// As [`ThreadPlan::new`], for another commanded speed than the moves'.
    pub(crate) fn at_speed(
        from: Position,
        moves: &[Move],
        params: &Params,
        commanded: Rpm,
        measured: TurnRate,
    ) -> Result<Self, Alarm> {
        let pass = collect(moves)?;
        let (span, thread) = pass.first;
        let fail = |code, word: Option<u8>, args| Alarm {
            code,
            span,
            word,
            args,
        };
        let long_x = thread.long_x;
        let (long_axis, short_axis) = if long_x {
            (Axis::X, Axis::Z)
        } else {
            (Axis::Z, Axis::X)
        };
        let split = |p: Position| if long_x { (p.x, p.z) } else { (p.z, p.x) };
        let fine = |length: Length| length.nm().wrapping_shl(16);

        // Speed.
        if commanded.get() == 0 && measured == TurnRate::ZERO {
            return Err(fail(Code::SpindleStopped, None, [Arg::None; 4]));
        }
        let reverse = if commanded.get() == 0 {
            measured.is_negative()
        } else {
            commanded.get() < 0
        };
        let nominal = TurnRate::of_rpm(commanded).abs().max(measured.abs());
        let margin = u64::from(params.spindle_variation_percent()).saturating_add(100);
        let nominal_raw = nominal.raw().unsigned_abs();
        let limit = mul_div_up(nominal_raw, margin, 100);
        let speed_limit = TurnRate::from_raw(i64::try_from(limit).unwrap_or(i64::MAX));
        let speed = travel(thread.lead, limit);
        let wanted = per_minute(travel(thread.lead, nominal_raw));
        let most = params.max_feed(long_axis);
        let never = params.rapid(long_axis);
        if wanted > most || per_minute(speed) > never {
            let (value, bound) = if wanted > most {
                (wanted, most)
            } else {
                (per_minute(speed), never)
            };
            let args = [
                Arg::Letter(long_axis.letter()),
                Arg::Feed(value),
                Arg::Feed(bound),
                Arg::Rpm(nominal.rpm()),
            ];
            return Err(fail(Code::LeadTooFast, Some(b'F'), args));
        }

        // Geometry, along the long axis from the start point.
        let (long_0, short_0) = split(from);
        let (line_start_long, line_start_short) = split(pass.run_in.unwrap_or(from));
        let (stroke_long, stroke_short) = split(pass.stroke);
        let (end_long, end_short) = split(pass.run_out.unwrap_or(pass.stroke));
        let length = (end_long - long_0).abs();
        let run_in_way = fine((line_start_long - long_0).abs());
        let run_out_way = fine((end_long - stroke_long).abs());
        let stroke_way = fine((stroke_long - line_start_long).abs());
        let taper = slope(fine(stroke_short - line_start_short), stroke_way.max(1));

        let machine = Machine {
            speed,
            long: bounds(params, long_axis),
            short: bounds(params, short_axis),
            short_speed: per_second(params.max_feed(short_axis)),
            taper: taper.unsigned_abs(),
        };

        // The run-in brings the short axis from beside the line's extension onto it; mirrored it is a ramp.
        let mut run_in = Ramp::NONE;
        let mut join = machine.plain();
        if run_in_way > 0 {
            let beside = fine(short_0 - line_start_short).wrapping_add(along(run_in_way, taper));
            let corner = machine.corner(beside, run_in_way);
            if !corner.whole {
                let args = [
                    Arg::Length(whole(machine.way_needed(beside))),
                    Arg::Rpm(nominal.rpm()),
                    Arg::None,
                    Arg::None,
                ];
                return Err(fail(Code::RunInTooFast, Some(b'E'), args));
            }
            join = corner.long;
            run_in = Ramp {
                slope: signed(corner.slope, beside),
                ease: corner.ease,
                at: run_in_way,
            };
        }

        // The run-out leaves the line. The margin on the speed is given up, step by step, before the run-out is.
        let mut run_out = Ramp::NONE;
        let mut brake = machine.plain();
        let mut way_needed = Length::ZERO;
        let beside = fine(end_short - stroke_short).wrapping_sub(along(run_out_way, taper));
        if run_out_way > 0 {
            let mut corner = machine.corner(beside, run_out_way);
            for less in MARGINS {
                if corner.whole || less >= margin {
                    continue;
                }
                let slower = Machine {
                    speed: travel(thread.lead, mul_div_up(nominal_raw, less, 100)),
                    ..machine
                };
                let tried = slower.corner(beside, run_out_way);
                if tried.whole {
                    corner = tried;
                }
            }
            brake = corner.long;
            run_out = Ramp {
                slope: signed(corner.slope, beside),
                ease: corner.ease,
                at: fine(length).wrapping_sub(run_out_way),
            };
            if !corner.whole {
                let slowest = Machine {
                    speed: travel(thread.lead, nominal_raw),
                    ..machine
                };
                way_needed = whole(slowest.way_needed(beside));
            }
        }

        // Everything has its place: join and run-in before, brake and run-out behind the locked part.
        let before = join.half().max(run_in_way);
        let behind = brake.half().max(run_out_way);
        if before.saturating_add(behind) > fine(length) {
            let args = [
                Arg::Length(length),
                Arg::Length(whole(before)),
                Arg::Length(whole(behind)),
                Arg::Rpm(nominal.rpm()),
            ];
            return Err(fail(
                Code::StrokeTooShortForSpeed,
                Some(if long_x { b'X' } else { b'Z' }),
                args,
            ));
        }

        // A retract in mid-thread takes the run-out's slope, 45° where there is none.
        let mean = if run_out_way > 0 {
            slope(beside, run_out_way).unsigned_abs()
        } else {
            DIAGONAL
        };
        let steep = mean.min(machine.steepest());
        let retract = Ramp {
            slope: i64::try_from(steep).unwrap_or(0),
            ease: Ease::new(speed, seen(speed, steep), machine.short),
            at: 0,
        };

        let slopes = [run_in.slope, run_out.slope].map(i64::unsigned_abs);
        let steepest = slopes.into_iter().max().unwrap_or(0);
        let done = fine(length).saturating_add(brake.half());
        let target = pass.run_out.unwrap_or(pass.stroke);
        let corner = run_in.ease.half();
        let mut plan = Self {
            span,
            start: from,
            end: target,
            long_x,
            backward: end_long < long_0,
            reverse,
            lead: (
                mul_div(
                    thread.lead.numerator().unsigned_abs(),
                    1,
                    thread.lead.denominator().unsigned_abs(),
                ),
                rest(thread.lead),
            ),
            start_angle: thread.pass_angle.turns(),
            length: fine(length),
            join,
            brake,
            stop: machine.straight(steepest),
            join_angle: angle_of(join.half(), thread.lead),
            done_angle: angle_of(done, thread.lead),
            taper,
            run_in,
            run_in_rise: along(run_in.ease.at(run_in.at.wrapping_sub(corner)), run_in.slope),
            run_out,
            retract,
            retract_inverse: inverse(steep),
            speed: i64::try_from(mul_div(speed << 16, u64::from(params.tick_us()), 1_000_000))
                .unwrap_or(i64::MAX)
                .max(1),
            speed_limit,
            short_lag: Length::ZERO,
            way_needed,
        };
        if way_needed > Length::ZERO {
            // By the tick's own arithmetic, so that the last setpoint is this one to the nanometre.
            plan.end = plan.position(plan.length, None);
            let (_, short) = split(plan.end);
            plan.short_lag = end_short - short;
        }
        Ok(plan)
    }

    /// True where X is the long axis.
    #[must_use]
    pub const fn long_x(&self) -> bool {
        self.long_x
    }

    /// Where the tool stands before the pass.
    #[must_use]
    pub const fn start(&self) -> Position {
        self.start
    }

    /// Where the tool stands after it: D's plane on the long axis; the short axis stands short of the run-out's end by
    /// [`ThreadPlan::run_out_lag`] where its limits do not let it keep up.
    #[must_use]
    pub const fn end(&self) -> Position {
        self.end
    }

    /// Lead-in: from the start point to where the axis stands on the exact helix.
    #[must_use]
    pub const fn lead_in(&self) -> Length {
        Length::from_nm(self.join.half_nm())
    }

    /// The way on which the axis has left the lead to come to rest in D's plane.
    #[must_use]
    pub const fn braking(&self) -> Length {
        Length::from_nm(self.brake.half_nm())
    }

    /// How much of the braking lies before the run-out: thread with a falling lead.
    #[must_use]
    pub fn falling_lead(&self) -> Length {
        let run_out = if self.run_out.slope == 0 {
            0
        } else {
            self.length.wrapping_sub(self.run_out.at)
        };
        whole(self.brake.half().wrapping_sub(run_out).max(0))
    }

    /// What the short axis still lacks at the end of the run-out (signed); a time-driven move has to follow.
    #[must_use]
    pub const fn run_out_lag(&self) -> Length {
        self.short_lag
    }

    /// Where the short axis lags: the K that would do at this speed. Zero where it does not.
    #[must_use]
    pub const fn run_out_needed(&self) -> Length {
        self.way_needed
    }

    /// The spindle speed up to which the plan keeps every limit (magnitude).
    #[must_use]
    pub const fn speed_limit(&self) -> TurnRate {
        self.speed_limit
    }

    /// Turns of the spindle from where the long axis leaves rest to where it is at rest again.
    #[must_use]
    pub fn turns(&self) -> Turns {
        self.join_angle + self.done_angle
    }
}

/// Percent of the spindle's speed for which a run-out is tried that does not fit with the whole margin.
const MARGINS: [u64; 4] = [110, 105, 102, 100];

/// The first synchronous move and its block.
fn first_thread(moves: &[Move]) -> Result<(Span, ThreadMove), Alarm> {
    let first = moves.first().map(|m| (m.span, m.kind));
    match first {
        Some((span, MoveKind::Thread(thread))) => Ok((span, thread)),
        Some((span, _)) => Err(Alarm::new(Code::ThreadMovesMixed, span)),
        None => Err(Alarm::new(Code::ThreadMovesMixed, Span::default())),
    }
}

/// Sorts the moves of a pass.
fn collect(moves: &[Move]) -> Result<Pass, Alarm> {
    let first = first_thread(moves)?;
    let mixed = Alarm::new(Code::ThreadMovesMixed, first.0);
    let mut run_in = None;
    let mut stroke = None;
    let mut run_out = None;
    for each in moves {
        if !matches!(each.kind, MoveKind::Thread(_)) {
            return Err(mixed);
        }
        let place = match each.tag.map(|tag| tag.stage) {
            Some(Stage::RunIn) => &mut run_in,
            Some(Stage::RunOut) => &mut run_out,
            _ => &mut stroke,
        };
        if place.replace(each.to).is_some() {
            return Err(mixed);
        }
    }
    let stroke = stroke.ok_or(mixed)?;
    Ok(Pass {
        run_in,
        stroke,
        run_out,
        first,
    })
}

/// Nanometres per second at 2⁻³² turns per second, rounded up.
fn travel(lead: Lead, rate: u64) -> u64 {
    let per_turn = mul_div_up(
        lead.numerator().unsigned_abs(),
        1 << 16,
        lead.denominator().unsigned_abs(),
    );
    mul_div_up(per_turn, rate, 1 << 48)
}

/// The part of the lead below a nanometre, 2⁻³² nm.
fn rest(lead: Lead) -> u64 {
    let below = lead
        .numerator()
        .checked_rem(lead.denominator())
        .unwrap_or(0);
    let fraction = ratio(below, lead.denominator().unsigned_abs(), 32);
    fraction.unsigned_abs().min(u64::from(u32::MAX))
}

/// The spindle's angle for a travel, rounded up.
fn angle_of(travel: Fine, lead: Lead) -> Turns {
    let scaled = mul_div_up(
        travel.max(0).unsigned_abs(),
        lead.denominator().unsigned_abs(),
        lead.numerator().unsigned_abs(),
    );
    // At most half the range, so that sums of two still count.
    let exact = if scaled < 1 << 40 {
        mul_div_up(
            travel.max(0).unsigned_abs(),
            lead.denominator().unsigned_abs().saturating_mul(1 << 16),
            lead.numerator().unsigned_abs(),
        )
    } else {
        1 << 56
    };
    Turns::from_raw(i64::try_from(exact).unwrap_or(1 << 56))
}

fn bounds(params: &Params, axis: Axis) -> Bounds {
    Bounds {
        acceleration: params.acceleration(axis).nm_per_s2().unsigned_abs(),
        jerk: params.jerk(axis).nm_per_s3().unsigned_abs(),
    }
}

fn per_second(feed: Feed) -> u64 {
    feed.nm_per_min().unsigned_abs() / 60
}

fn per_minute(speed: u64) -> Feed {
    Feed::from_nm_per_min(i64::try_from(speed.saturating_mul(60)).unwrap_or(i64::MAX))
}

/// Whole nanometres, rounded to the nearest.
pub(super) const fn whole(fine: Fine) -> Length {
    Length::from_nm(fine.wrapping_add(1 << 15) >> 16)
}

fn signed(magnitude: u64, sign_of: Fine) -> Slope {
    let magnitude = i64::try_from(magnitude).unwrap_or(i64::MAX);
    if sign_of < 0 {
        magnitude.wrapping_neg()
    } else {
        magnitude
    }
}
