//! A pass running: the spindle's angle in, a setpoint out, once a tick. No division, no loop.

use super::plan::{ThreadPlan, whole};
use super::ramp::{Slope, along};
use crate::alarm::{Alarm, Arg, Code};
use crate::motion::ease::{Ease, Fine};
use crate::program::Position;
use crate::units::{Length, TurnRate, Turns};

/// Where in its pass the tool is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// At rest at the start point, until the spindle comes round.
    Waiting,
    /// Getting onto the helix.
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
    /// Where in the pass it lies.
    pub phase: Phase,
    /// Where the exact helix stands on the long axis at the angle given.
    pub exact: Length,
    /// Which move of the pass it belongs to, from 0 (run-in, stroke, run-out in order, as far as there are).
    pub move_index: u8,
}

/// What became of the wish to retract.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Retract {
    /// The pass had not begun or was over: the tool stands.
    Standing,
    /// The short axis is on its way out, the long one in lead meanwhile; then both are at rest.
    Leaving,
    /// Too close to the end: the pass ends as it was planned, which is sooner.
    Finishing,
}

/// The short axis' way out in mid-thread: a ramp up and, `apart` further on, one down.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Out {
    from: Fine,
    slope: Slope,
    apart: Fine,
}

/// What leads the long axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Master {
    /// The measured spindle.
    Spindle,
    /// Nothing any more: the angle goes on by this much a tick until the axis is at rest (stop).
    Coasting(i64),
    /// Stopping from the locked part: `left` of the brake's ease, run through at the planned speed and scaled by
    /// `share` (2⁻³¹) to the speed there was.
    Stopping { left: Fine, share: i64, rest: Fine },
    /// At rest there for good.
    Rest(Fine),
}

/// A pass under way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ThreadRun {
    plan: ThreadPlan,
    /// The whole turn plus start angle at which the exact helix is at the start point, in the turning direction.
    base: Turns,
    master: Master,
    /// Where the long axis comes to rest; less than the plan's after a retract.
    length: Fine,
    out: Option<Out>,
    /// The last tick: angle since `base`, how far it had come, the long axis.
    angle: Turns,
    step: i64,
    way: Fine,
    phase: Phase,
}

impl ThreadRun {
    /// Begins to wait for the spindle, which is at `angle` and turns at `speed`, both as the next
    /// [`tick`](Self::tick) will see them: the first whole turn is chosen for which the axis need not have left yet.
    ///
    /// # Errors
    /// The spindle stands or turns the wrong way ([`Code::SpindleStopped`]), or faster than the pass is planned for
    /// ([`Code::SpindleTooFast`]).
    pub fn start(plan: ThreadPlan, angle: Turns, speed: TurnRate) -> Result<Self, Alarm> {
        if speed == TurnRate::ZERO || speed.is_negative() != plan.reverse {
            return Err(Alarm::new(Code::SpindleStopped, plan.span));
        }
        if speed.abs() > plan.speed_limit() {
            let args = [
                Arg::Rpm(speed.abs().rpm()),
                Arg::Rpm(plan.speed_limit().rpm()),
                Arg::None,
                Arg::None,
            ];
            return Err(Alarm::new(Code::SpindleTooFast, plan.span).with(args));
        }
        let angle = turned(&plan, angle);
        // The whole turn after the point where the axis would have to leave now.
        let leaving = angle + plan.join_angle - plan.start_angle;
        let turn = (leaving.raw() >> 32).wrapping_add(1);
        let base = Turns::from_raw(turn.wrapping_shl(32)) + plan.start_angle;
        Ok(Self {
            plan,
            base,
            master: Master::Spindle,
            length: plan.length,
            out: None,
            angle: angle - base,
            step: 0,
            way: 0,
            phase: Phase::Waiting,
        })
    }

    /// The plan this pass follows.
    #[must_use]
    pub const fn plan(&self) -> &ThreadPlan {
        &self.plan
    }

    /// Where in the pass the last setpoint was.
    #[must_use]
    pub const fn phase(&self) -> Phase {
        self.phase
    }

    /// Where the exact helix of this pass stands on the long axis at a spindle angle.
    #[must_use]
    pub fn helix(&self, angle: Turns) -> Length {
        let way = whole(self.travel(turned(&self.plan, angle) - self.base));
        self.long_at(way)
    }

    /// The setpoint for the instant at which the spindle is at `angle`.
    pub fn tick(&mut self, angle: Turns) -> ThreadPoint {
        let measured = turned(&self.plan, angle) - self.base;
        let (relative, step) = match self.master {
            Master::Coasting(step) => (self.angle + Turns::from_raw(step), step),
            _ => (measured, (measured - self.angle).raw()),
        };
        self.angle = relative;
        self.step = step;
        let helix = self.travel(relative);
        let (way, phase) = self.law(relative, helix);
        self.way = way;
        self.phase = phase;
        if phase == Phase::Done {
            self.master = Master::Rest(way);
        }
        let exact = match self.master {
            Master::Spindle => helix,
            _ => self.travel(measured),
        };
        ThreadPoint {
            position: self.position(way),
            phase,
            exact: self.long_at(whole(exact)),
            move_index: self.move_index(way),
        }
    }

    /// Takes the tool out of the thread now: the short axis ramps out with the run-out's slope (45° where there is
    /// none) to `target`, an absolute coordinate of the short axis away from the work, with a taper's slope added; the
    /// long axis stays in lead meanwhile and then comes to rest, never beyond the end plane. Where the way left is too
    /// short for all of it, the short axis goes as far as there is room.
    pub fn retract(&mut self, target: Length) -> Retract {
        if self.out.is_some() {
            return Retract::Leaving;
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
        let plan = &self.plan;
        // Behind join and run-in, so that only one corner at a time asks for the short axis' limits.
        let from = self.way.max(plan.join.half()).max(plan.run_in.at);
        if plan.run_out.slope != 0 && from >= plan.run_out.at {
            return Retract::Finishing;
        }
        let line = self.line(from);
        let (_, short) = split(plan, plan.start);
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
        if room <= 0 {
            return Retract::Finishing;
        }
        let apart = along(wanted.saturating_abs(), plan.retract_inverse).min(room);
        let slope = if wanted < 0 {
            plan.retract.slope.wrapping_neg()
        } else {
            plan.retract.slope
        };
        self.length = from
            .wrapping_add(corner)
            .wrapping_add(apart)
            .wrapping_add(plan.brake.half());
        self.out = Some(Out { from, slope, apart });
        Retract::Leaving
    }

    /// Brings both axes to rest together, by time and no longer by the spindle: for an emergency stop or a drive
    /// fault. The short axis stays on the path of the long one.
    pub fn stop(&mut self) {
        let plan = &self.plan;
        match (self.phase, self.master) {
            (Phase::Locked, Master::Spindle) => {
                // From the speed there is (a share of the planned one), with the brake's ease scaled down to it.
                let speed = self.travel(Turns::from_raw(self.step)).max(0);
                let share = share_of(speed, plan.speed).min(share_of(
                    self.length.wrapping_sub(self.way),
                    plan.brake.half(),
                ));
                let brake = scaled(plan.brake.half(), share);
                self.master = Master::Stopping {
                    left: plan.brake.half(),
                    share,
                    rest: self.way.wrapping_add(brake),
                };
            }
            (Phase::Joining, Master::Spindle) => {
                // Joined or not: the shortest pass there is.
                self.length = self
                    .length
                    .min(plan.join.half().wrapping_add(plan.brake.half()));
                self.coast();
            }
            (Phase::Braking, Master::Spindle) => self.coast(),
            (Phase::Waiting | Phase::Done, _) => self.master = Master::Rest(self.way),
            _ => {}
        }
    }

    /// Lets the angle run on at its present pace; a spindle that hardly moves leaves the axis where it is.
    fn coast(&mut self) {
        let pace = self.travel(Turns::from_raw(self.step));
        self.master = if pace < self.plan.speed >> 6 {
            Master::Rest(self.way)
        } else {
            Master::Coasting(self.step)
        };
    }

    /// The long axis' way from the start point, and the phase.
    fn law(&mut self, relative: Turns, helix: Fine) -> (Fine, Phase) {
        let plan = &self.plan;
        match &mut self.master {
            Master::Rest(way) => return (*way, Phase::Done),
            Master::Stopping { left, share, rest } => {
                *left = left.wrapping_sub(plan.speed);
                let way = rest.wrapping_sub(scaled(plan.brake.at(*left), *share));
                let over = *left <= plan.brake.half().wrapping_neg();
                return (way, if over { Phase::Done } else { Phase::Braking });
            }
            Master::Spindle | Master::Coasting(_) => {}
        }
        if (relative + plan.join_angle).raw() <= 0 {
            return (0, Phase::Waiting);
        }
        if helix < plan.join.half() {
            return (plan.join.at(helix), Phase::Joining);
        }
        let left = self.length.wrapping_sub(helix);
        let brake = plan.brake.half();
        if left >= brake {
            (helix, Phase::Locked)
        } else if left > brake.wrapping_neg() {
            (
                self.length.wrapping_sub(plan.brake.at(left)),
                Phase::Braking,
            )
        } else {
            (self.length, Phase::Done)
        }
    }

    /// The helix' travel for an angle since `base`, limited to a turn around the pass.
    fn travel(&self, relative: Turns) -> Fine {
        let plan = &self.plan;
        let low = (-plan.join_angle - Turns::ONE).raw();
        let high = (plan.done_angle + Turns::ONE).raw();
        let relative = relative.raw().min(high).max(low);
        let turns = relative >> 32;
        let part = (relative as u64) & 0xffff_ffff;
        let (lead, rest) = plan.lead;
        // turns + part·2⁻³², times lead + rest·2⁻³², in 2⁻¹⁶.
        let whole_turns = turns
            .wrapping_mul(lead as i64)
            .wrapping_shl(16)
            .wrapping_add(turns.wrapping_mul(rest as i64) >> 16);
        let within =
            ((part >> 2).wrapping_mul(lead) >> 14).wrapping_add(part.wrapping_mul(rest) >> 48);
        whole_turns.wrapping_add(within as i64)
    }

    /// The pass's line with its run-in, relative to the start point on the short axis.
    fn line(&self, way: Fine) -> Fine {
        let plan = &self.plan;
        let line = along(way, plan.taper);
        if plan.run_in.slope == 0 {
            return line;
        }
        // Beside the line by what is left of the ramp, backwards from its end; at the start all of it is left.
        let ramp = |at: Fine| {
            let corner = plan.run_in.ease.half();
            along(
                plan.run_in
                    .ease
                    .at(plan.run_in.at.wrapping_sub(at).wrapping_sub(corner)),
                plan.run_in.slope,
            )
        };
        line.wrapping_add(ramp(way)).wrapping_sub(ramp(0))
    }

    fn position(&self, way: Fine) -> Position {
        let plan = &self.plan;
        let mut beside = self.line(way);
        if let Some(out) = self.out {
            let ease: &Ease = &plan.retract.ease;
            let since = way.wrapping_sub(out.from).wrapping_sub(ease.half());
            let ramp = ease
                .at(since)
                .wrapping_sub(ease.at(since.wrapping_sub(out.apart)));
            beside = beside.wrapping_add(along(ramp, out.slope));
        } else if plan.run_out.slope != 0 {
            let ease = &plan.run_out.ease;
            let since = way.wrapping_sub(plan.run_out.at).wrapping_sub(ease.half());
            beside = beside.wrapping_add(along(ease.at(since), plan.run_out.slope));
        }
        let long = self.long_at(whole(way));
        let (_, short) = split(plan, plan.start);
        let short = short + whole(beside);
        let (x, z) = if plan.long_x {
            (long, short)
        } else {
            (short, long)
        };
        Position {
            x,
            z,
            c: plan.start.c,
        }
    }

    fn long_at(&self, way: Length) -> Length {
        let (long, _) = split(&self.plan, self.plan.start);
        if self.plan.backward {
            long - way
        } else {
            long + way
        }
    }

    fn move_index(&self, way: Fine) -> u8 {
        let plan = &self.plan;
        let run_in = plan.run_in.at > 0;
        let behind_run_in = u8::from(run_in && way >= plan.run_in.at);
        let in_run_out =
            u8::from(plan.run_out.at > 0 && self.out.is_none() && way >= plan.run_out.at);
        behind_run_in.wrapping_add(in_run_out)
    }
}

/// An angle counted in the direction the spindle is to turn.
fn turned(plan: &ThreadPlan, angle: Turns) -> Turns {
    if plan.reverse { -angle } else { angle }
}

/// Long and short coordinate.
fn split(plan: &ThreadPlan, at: Position) -> (Length, Length) {
    if plan.long_x {
        (at.x, at.z)
    } else {
        (at.z, at.x)
    }
}

/// `part` / `whole` in 2⁻³¹, at most one.
fn share_of(part: Fine, whole: Fine) -> i64 {
    if part >= whole {
        return 1 << 31;
    }
    // Both brought to 32 bits first.
    let bits = i64::BITS
        .wrapping_sub(whole.leading_zeros())
        .saturating_sub(32);
    part.max(0)
        .wrapping_shr(bits)
        .wrapping_shl(31)
        .checked_div(whole.wrapping_shr(bits))
        .unwrap_or(0)
}

/// `fine` · `share` (2⁻³¹).
fn scaled(fine: Fine, share: i64) -> Fine {
    (i128::from(fine).wrapping_mul(i128::from(share)) >> 31) as i64
}
