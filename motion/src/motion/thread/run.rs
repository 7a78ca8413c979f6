//! A threading pass under way: the spindle's angle in, one setpoint out per tick. No division, no loop.

use super::helix::Helix;
use super::path::Out;
use super::plan::ThreadPlan;
use super::ramp::along;
use crate::alarm::{Alarm, Code};
use crate::call::Position;
use crate::motion::ease::{Ease, Fine};
use crate::units::{Length, TurnRate, Turns, signed_product};

/// The phase of a pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// At rest at the start point, until the spindle reaches the angle at which the tool leaves.
    Waiting,
    /// Accelerating onto the helix.
    Joining,
    /// On the helix.
    Locked,
    /// Off the lead, coming to rest in the end plane.
    Braking,
    /// At rest; the pass is over.
    Done,
}

/// One setpoint of a pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ThreadPoint {
    /// The setpoint.
    pub position: Position,
    /// Phase of the pass at this setpoint.
    pub phase: Phase,
    /// The move of the pass to which the setpoint belongs, from 0 (run-in, stroke, run-out, in this order, as far as
    /// they exist).
    pub move_index: u8,
}

/// The outcome of a request to retract.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Retract {
    /// The pass had not begun or was already over: the tool stands.
    Standing,
    /// The short axis is on its way out while the long axis stays in lead; then both come to rest.
    Leaving,
    /// Too close to the end: the pass ends as planned, which is sooner.
    Finishing,
}

/// The master of the long axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Master {
    /// The measured spindle.
    Spindle,
    /// No measurement any more: the angle advances by this much each tick until the axis is at rest (stop).
    Coasting(i64),
    /// Stopping from the locked part. `left` is the rest of the stop's ease, which runs at the planned speed; `share`
    /// (2⁻³¹) scales the ease down to the speed at the beginning of the stop.
    Stopping { left: Fine, share: i64, rest: Fine },
    /// A stop in a chain, or of a spindle that hardly turns: over corners and all. The angle advances by `step` and ever
    /// less, for as many ticks as the plan says; these ones have gone by.
    Slowing { step: i64, ticks: u32 },
    /// At rest at this point for good.
    Rest(Fine),
}

/// The changing state of a pass under way.
///
/// The plan stays where it is. The caller passes the same plan to every call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ThreadRun {
    /// The whole turn plus start angle, in the turning direction, at which the exact helix is at the start point.
    base: Turns,
    master: Master,
    /// Where the long axis comes to rest; after a retract this is less than the plan's length.
    length: Fine,
    /// True if the long axis comes to rest with the ease of a stop, false for the planned braking.
    stops: bool,
    out: Option<Out>,
    /// State of the last tick: angle since `base`, the angle's change in that tick, and the long axis' way.
    angle: Turns,
    step: i64,
    way: Fine,
    /// In the corner to the stroke before: distance of the short axis from the line.
    aside: Option<Fine>,
    /// Where the drives of both axes differ in delay: by how much the short axis was ahead of the long one in the last tick
    /// in which the spindle led, as an angle and as a way.
    lead: i64,
    lead_way: Fine,
    /// In a stop: the angle is that of the axis that is short by now, because a stroke with another long axis took over.
    is_swapped: bool,
    phase: Phase,
    /// The plan has just taken over: the angle before may be that of another axis.
    is_fresh: bool,
}

impl ThreadRun {
    /// Begins to wait for the spindle. The spindle is at `angle` and turns at `speed`, both as the next
    /// [`tick`](Self::tick) will see them. The pass takes the first whole turn for which the axis need not have left
    /// yet.
    ///
    /// # Errors
    /// The spindle stands or turns the wrong way ([`Code::SpindleStopped`]), or faster than the pass is planned for
    /// ([`Code::SpindleTooFast`]).
    pub fn start(plan: &ThreadPlan, angle: Turns, speed: TurnRate) -> Result<Self, Alarm> {
        if speed == TurnRate::ZERO || speed.is_negative() != plan.reverse {
            return Err(Alarm::new(Code::SpindleStopped, plan.span));
        }
        if speed.abs() > plan.speed_limit() {
            return Err(plan.too_fast(speed));
        }
        let angle = plan.turned(angle);
        // The next whole turn after the position at which the axis would have to leave now.
        let leaving = angle + plan.join_angle - plan.start_angle;
        let base = leaving.next_whole() + plan.start_angle;
        Ok(Self {
            base,
            master: Master::Spindle,
            length: plan.link.straight,
            stops: false,
            out: None,
            angle: angle - base,
            step: 0,
            way: 0,
            aside: None,
            lead: 0,
            lead_way: 0,
            is_swapped: false,
            phase: Phase::Waiting,
            is_fresh: false,
        })
    }

    /// True while the spindle leads; false once a stop has taken over.
    #[must_use]
    pub fn is_led(&self) -> bool {
        self.master == Master::Spindle
    }

    /// The phase of the last setpoint.
    #[must_use]
    pub const fn phase(&self) -> Phase {
        self.phase
    }

    /// True where the run-in is over when the spindle is at `angle`.
    #[must_use]
    pub fn locks(&self, plan: &ThreadPlan, angle: Turns) -> bool {
        plan.travel.at(plan.turned(angle) - self.base) >= plan.join.half()
    }

    /// The exact helix of this pass.
    #[must_use]
    pub fn helix(&self, plan: &ThreadPlan) -> Helix {
        plan.helix(self.base)
    }

    /// The setpoint for the instant at which the spindle is at `angle`.
    pub fn tick(&mut self, plan: &ThreadPlan, angle: Turns) -> ThreadPoint {
        let ends = self.advance(plan, angle);
        self.point(plan, self.angle, ends)
    }

    /// Takes the angle on by a tick; true at the end of a stop that slows it down.
    #[inline]
    fn advance(&mut self, plan: &ThreadPlan, angle: Turns) -> bool {
        let mut ends = false;
        let (relative, step) = match self.master {
            Master::Coasting(step) => (self.angle + Turns::from_raw(step), step),
            Master::Slowing { step, ticks } => {
                let ticks = ticks.saturating_add(1);
                self.master = Master::Slowing { step, ticks };
                let (left, over) = left_of_pace(ticks, plan.link.stop);
                let step = scaled(step, left);
                ends = over;
                (self.angle + Turns::from_raw(step), step)
            }
            _ => {
                let measured = plan.turned(angle) - self.base;
                if core::mem::take(&mut self.is_fresh) {
                    (measured, self.step)
                } else {
                    (measured, (measured - self.angle).raw())
                }
            }
        };
        self.angle = relative;
        self.step = step;
        ends
    }

    /// The setpoint where the helix is at the angle `relative`. `ends`: it is the last one of a stop.
    #[inline]
    fn point(&mut self, plan: &ThreadPlan, relative: Turns, ends: bool) -> ThreadPoint {
        let (way, phase) = self.law(plan, relative);
        let phase = if ends { Phase::Done } else { phase };
        self.way = way;
        self.phase = phase;
        if phase == Phase::Done {
            self.master = Master::Rest(way);
        }
        ThreadPoint {
            position: plan.position(way, self.aside, self.out),
            phase,
            move_index: if self.aside.is_some() {
                0
            } else {
                plan.move_index(way, self.out.is_some())
            },
        }
    }

    /// The next setpoint if the drives of the short and the long axis differ in delay: each coordinate belongs to its
    /// own instant. `angle` and `short` are the predicted spindle angles at the instants of the long and of the short
    /// axis. The pass has begun when one axis has left, and is done when both have arrived [D528]. In a stop the short axis
    /// stays ahead by as much time, so its way ahead goes with the pace.
    pub fn tick_apart(&mut self, plan: &ThreadPlan, angle: Turns, short: Turns) -> ThreadPoint {
        let master = self.master;
        let mut beside = *self;
        let (mut point, other) = match master {
            Master::Spindle => {
                let point = self.tick(plan, angle);
                let other = beside.tick(plan, short);
                self.lead = (beside.angle - self.angle).raw();
                self.lead_way = beside.way.wrapping_sub(self.way);
                self.is_swapped = false;
                (point, other)
            }
            Master::Coasting(_) | Master::Slowing { .. } => self.run_on_apart(plan, &mut beside),
            Master::Stopping { .. } | Master::Rest(_) => {
                let before = self.way;
                let point = self.tick(plan, angle);
                (point, beside.stop_ahead(plan, self.way, before))
            }
        };
        if plan.long_x {
            point.position.z = other.position.z;
        } else {
            point.position.x = other.position.x;
        }
        if point.phase == Phase::Done && other.phase != Phase::Done {
            self.master = master;
            self.phase = Phase::Braking;
            point.phase = Phase::Braking;
        } else if point.phase == Phase::Waiting && other.phase != Phase::Waiting {
            self.phase = Phase::Joining;
            point.phase = Phase::Joining;
        }
        point
    }

    /// The setpoints of the long axis and, in `beside`, of the short one, in a stop whose angle runs on by itself.
    /// Each axis ends by itself, and at the end of a stop that slows down both are at the same angle.
    // Rare.
    #[inline(never)]
    fn run_on_apart(&mut self, plan: &ThreadPlan, beside: &mut Self) -> (ThreadPoint, ThreadPoint) {
        let ends = self.advance(plan, Turns::ZERO);
        let ahead = self.angle + self.left_of_lead(plan);
        let (long, short) = if self.is_swapped {
            (ahead, self.angle)
        } else {
            (self.angle, ahead)
        };
        (
            self.point(plan, long, ends),
            beside.point(plan, short, ends),
        )
    }

    /// By how much the other axis is ahead of the one whose angle is counted.
    fn left_of_lead(&self, plan: &ThreadPlan) -> Turns {
        Turns::from_raw(match self.master {
            Master::Slowing { ticks, .. } => {
                scaled(self.lead, left_of_pace(ticks, plan.link.stop).0)
            }
            _ => self.lead,
        })
    }

    /// The setpoint of the short axis in a stop along the line, where the long axis has just gone from the way `before` to
    /// `way`. The short one comes to rest with it.
    // Rare.
    #[inline(never)]
    fn stop_ahead(&mut self, plan: &ThreadPlan, way: Fine, before: Fine) -> ThreadPoint {
        let ahead = if let Master::Stopping { share, .. } = self.master {
            let pace = way.wrapping_sub(before).max(0);
            let pace = plan.of_speed.share(pace, plan.speed) as u32;
            // Of the pace at the beginning, 2⁻¹⁶.
            let part = pace.checked_div((share >> 16) as u32).unwrap_or(0);
            let part = i64::from(part.min(1 << 16));
            self.lead_way.wrapping_mul(part) >> 16
        } else {
            0
        };
        ThreadPoint {
            position: plan.position(way.wrapping_add(ahead), self.aside, self.out),
            phase: Phase::Done,
            move_index: 0,
        }
    }

    /// Takes the tool out of the thread now. The short axis ramps out with the run-out's slope (45° if there is no
    /// run-out) to `target`, plus the slope of a taper. `target` is an absolute coordinate of the short axis, away from
    /// the work. The long axis stays in lead during this ramp and then comes to rest, never beyond the end plane. If
    /// the remaining way is too short for the whole ramp, the short axis goes as far as there is room.
    pub fn retract(&mut self, plan: &ThreadPlan, target: Length) -> Retract {
        if self.out.is_some() {
            return Retract::Leaving;
        }
        if self.master != Master::Spindle && self.phase != Phase::Done {
            // A stop is under way already.
            return Retract::Finishing;
        }
        if plan.goes_on() && self.phase != Phase::Waiting {
            // No side to leave to is known before the last stroke.
            self.stop(plan);
            return Retract::Finishing;
        }
        match self.phase {
            Phase::Done => return Retract::Standing,
            Phase::Waiting => {
                self.master = Master::Rest(0);
                return Retract::Standing;
            }
            Phase::Braking => return Retract::Finishing,
            Phase::Joining | Phase::Locked => {}
        }
        // The retract begins after the join and the run-in, so that only one corner at a time uses the short axis'
        // limits. The short axis may be ahead.
        let way = self.way.wrapping_add(self.lead_way.max(0));
        let from = way.max(plan.join.half()).max(plan.run_in.at);
        if plan.run_out.slope != 0 && from >= plan.run_out.at {
            return Retract::Finishing;
        }
        let line = plan.line(from);
        let short = plan.short_start();
        let wanted = target
            .nm()
            .wrapping_shl(16)
            .wrapping_sub(short.nm().wrapping_shl(16).wrapping_add(line));
        let corner = plan.retract.ease.half().wrapping_mul(2);
        let room = self
            .length
            .wrapping_sub(plan.brake.half())
            .wrapping_sub(from)
            .wrapping_sub(corner);
        if room < corner {
            return Retract::Finishing;
        }
        // The ramp's start corner and end corner must not overlap; a short way out gets a flatter slope.
        let apart = along(wanted.unsigned_abs() as Fine, plan.retract_inverse).min(room);
        // A corner consists of two halves.
        let slope = scaled(plan.retract.slope, plan.retract.ease.share(apart >> 1));
        let apart = apart.max(corner);
        let slope = if wanted < 0 {
            slope.wrapping_neg()
        } else {
            slope
        };
        self.length = from
            .wrapping_add(corner)
            .wrapping_add(apart)
            .wrapping_add(plan.brake.half());
        self.out = Some(Out { from, slope, apart });
        Retract::Leaving
    }

    /// Brings both axes to rest together, driven by time and no longer by the spindle. This is for an emergency stop or
    /// a drive fault. The short axis stays on the path of the long axis, and no limit is exceeded. A corner of the
    /// short axis that has begun is finished first. If the rest of the pass is no longer than a stop, the pass ends as
    /// planned, at its present pace.
    pub fn stop(&mut self, plan: &ThreadPlan) {
        if self.master != Master::Spindle {
            return;
        }
        let from = match self.phase {
            Phase::Waiting | Phase::Done => {
                self.master = Master::Rest(self.way);
                return;
            }
            Phase::Braking => None,
            Phase::Joining if !plan.is_joined() => self.stop_from(plan, plan.join.half()),
            Phase::Joining => None,
            Phase::Locked => self.stop_from(plan, self.way),
        };
        let in_corner = (plan.is_joined() || plan.goes_on()) && from != Some(self.way);
        if in_corner || self.turns_back(plan) {
            self.slow_down(plan);
            return;
        }
        match from {
            Some(from) if self.phase == Phase::Locked && from == self.way => {
                // Stop at once from the present speed (a share of the planned speed), with the ease scaled down to that
                // speed.
                let pace = self.pace(plan);
                let share = plan.of_speed.share(pace, plan.speed);
                self.master = Master::Stopping {
                    left: plan.stop.half(),
                    share,
                    rest: self.way.wrapping_add(scaled(plan.stop.half(), share)),
                };
            }
            Some(from) => {
                self.length = from.wrapping_add(plan.stop.half());
                self.stops = true;
                self.coast(plan);
            }
            None => self.coast(plan),
        }
    }

    /// Delays a stop that may begin at `from` until neither axis meets a corner and it ends before the end plane. The short
    /// axis may be ahead of the long one, or behind. `None` if the pass should rather end as planned.
    #[inline]
    fn stop_from(&self, plan: &ThreadPlan, from: Fine) -> Option<Fine> {
        if self.out.is_some() {
            None
        } else if self.lead_way == 0 {
            self.stop_between(plan, from, 0, 0)
        } else {
            self.stop_apart(plan, from)
        }
    }

    /// The same where the drives differ in delay.
    #[cold]
    #[inline(never)]
    fn stop_apart(&self, plan: &ThreadPlan, from: Fine) -> Option<Fine> {
        let ahead = self.lead_way.max(0);
        let behind = self.lead_way.wrapping_neg().max(0);
        self.stop_between(plan, from, ahead, behind)
    }

    // Inlined so that the usual tick of a stop has no ways ahead and behind to add.
    #[inline(always)]
    fn stop_between(
        &self,
        plan: &ThreadPlan,
        from: Fine,
        ahead: Fine,
        behind: Fine,
    ) -> Option<Fine> {
        let stop = plan.stop.half();
        let corner = |ease: &Ease| ease.half().wrapping_mul(2);
        let clear_of = |place: Fine| place.wrapping_add(behind);
        // Where it does not begin at once, it begins where no axis is yet.
        let later = |place: Fine| match ahead > 0 && place > self.way {
            true => place.max(self.way.wrapping_add(ahead)),
            false => place,
        };
        let from = later(clear_of(plan.join.half()).max(from));
        let reach = from.wrapping_add(stop).wrapping_add(ahead);
        if reach <= plan.run_in.at.wrapping_sub(corner(&plan.run_in.ease)) {
            return Some(from);
        }
        let from = later(clear_of(plan.run_in.at).max(from));
        let end = from.wrapping_add(stop);
        let before = plan.run_out.slope == 0 || end.wrapping_add(ahead) <= plan.run_out.at;
        let past = from >= clear_of(plan.run_out.at.wrapping_add(corner(&plan.run_out.ease)));
        (end <= self.length && (before || past)).then_some(from)
    }

    /// Lets the angle come to rest from its present pace.
    fn slow_down(&mut self, plan: &ThreadPlan) {
        self.coast(plan);
        if let Master::Coasting(step) = self.master {
            self.master = Master::Slowing { step, ticks: 0 };
        }
    }

    /// True from when on the next stroke of the chain takes over. `ahead` is the angle of the axis that is ahead.
    #[must_use]
    pub fn is_over(&self, plan: &ThreadPlan, ahead: Turns) -> bool {
        let relative = match self.master {
            Master::Spindle => plan.turned(ahead) - self.base,
            Master::Coasting(_) | Master::Slowing { .. } => {
                self.angle + self.left_of_lead(plan).max(Turns::ZERO)
            }
            Master::Stopping { .. } | Master::Rest(_) => return false,
        };
        plan.goes_on() && relative >= plan.link.over
    }

    /// Another stroke takes over from `plan`: from now on the angle counts from its start.
    pub fn leave(&mut self, plan: &ThreadPlan) {
        self.base += plan.link.turns;
        self.angle -= plan.link.turns;
        self.is_swapped ^= plan.long_x;
    }

    /// `plan` takes over, where it is the same straight line as the one that was left.
    pub fn take_over(&mut self, plan: &ThreadPlan) {
        self.length = plan.link.straight;
        self.is_fresh = true;
        // Together with the stroke that was left: true where the long axis is another one.
        self.is_swapped ^= plan.long_x;
        // A stop may come before the next tick.
        (self.way, self.phase) = self.law(plan, self.angle);
    }

    /// The travel of the helix in the last tick.
    fn pace(&self, plan: &ThreadPlan) -> Fine {
        plan.travel.over(self.angle, Turns::from_raw(self.step))
    }

    /// The spindle turns back, and more than hardly.
    fn turns_back(&self, plan: &ThreadPlan) -> bool {
        self.pace(plan) <= (plan.speed >> 6).wrapping_neg()
    }

    /// Lets the angle run on at its present pace. If the spindle hardly moves, the axes rest where they are. Where one is
    /// ahead, or the spindle turns back, the angle slows down, and they come to rest together.
    // Rare, and called in three places.
    #[inline(never)]
    fn coast(&mut self, plan: &ThreadPlan) {
        let turns_back = self.turns_back(plan);
        self.master = if self.pace(plan) >= plan.speed >> 6 {
            Master::Coasting(self.step)
        } else if self.lead == 0 && !turns_back {
            Master::Rest(self.way)
        } else {
            let step = if turns_back {
                self.step
            } else {
                self.step.max(0)
            };
            Master::Slowing { step, ticks: 0 }
        };
    }

    /// The long axis' distance from the start point, and the phase.
    fn law(&mut self, plan: &ThreadPlan, relative: Turns) -> (Fine, Phase) {
        match &mut self.master {
            Master::Rest(way) => return (*way, Phase::Done),
            Master::Stopping { left, share, rest } => {
                *left = left.wrapping_sub(plan.speed);
                let way = rest.wrapping_sub(scaled(plan.stop.at(*left), *share));
                let over = *left <= plan.stop.half().wrapping_neg();
                return (way, if over { Phase::Done } else { Phase::Braking });
            }
            Master::Spindle | Master::Coasting(_) | Master::Slowing { .. } => {}
        }
        let link = &plan.link;
        if !link.is_joined && (relative + plan.join_angle).raw() <= 0 {
            return (0, Phase::Waiting);
        }
        let helix = plan.travel.at(relative);
        self.aside = None;
        if helix < plan.join.half() {
            let eased = plan.join.at(helix);
            if !link.is_joined {
                return (eased, Phase::Joining);
            }
            let short_of = helix.wrapping_sub(eased);
            self.aside = Some(along(short_of, link.bend));
            return (
                helix.wrapping_sub(along(short_of, link.gain)),
                Phase::Joining,
            );
        }
        if link.goes_on && !self.stops {
            return (helix, Phase::Locked);
        }
        let left = self.length.wrapping_sub(helix);
        let ease = if self.stops { &plan.stop } else { &plan.brake };
        let brake = ease.half();
        if left >= brake {
            (helix, Phase::Locked)
        } else if left > brake.wrapping_neg() {
            (self.length.wrapping_sub(ease.at(left)), Phase::Braking)
        } else {
            (self.length, Phase::Done)
        }
    }
}

/// What is left of a pace that slows down (2⁻³¹) after `ticks` of which each is this `part` (2⁻³¹) of the stop; and whether
/// that is nothing.
fn left_of_pace(ticks: u32, part: u32) -> (i64, bool) {
    const WHOLE: u64 = 1 << 31;
    let u = u64::from(ticks).wrapping_mul(u64::from(part)).min(WHOLE);
    // u²·(3 − 2·u)
    let square = u.wrapping_mul(u) >> 31;
    let lost = square.wrapping_mul((3 * WHOLE).wrapping_sub(u << 1)) >> 31;
    (WHOLE.wrapping_sub(lost) as i64, u == WHOLE)
}

/// `fine` · `share` (2⁻³¹).
fn scaled(fine: Fine, share: i64) -> Fine {
    (signed_product(fine, share) >> 31) as i64
}
