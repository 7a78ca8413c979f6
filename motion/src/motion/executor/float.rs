//! An ordinary (floating) tap in the executor: the axis follows the spindle, and the tap commands the spindle's speed.

use super::{Active, Conditions, Executor, Setpoint};
use crate::alarm::Alarm;
use crate::call::TapAxis;
use crate::motion::tap::{FloatPlan, FloatTick};
use crate::units::TurnRate;

impl Executor {
    /// True while an ordinary tap is under way.
    #[must_use]
    pub const fn is_floating(&self) -> bool {
        matches!(self.active, Active::Float(..))
    }

    /// The speed that an ordinary tap commands the spindle, while one is under way. It replaces the speed of M03 and
    /// the override.
    #[must_use]
    pub const fn spindle_speed(&self) -> Option<TurnRate> {
        match self.active {
            Active::Float(_, speed) => speed,
            _ => None,
        }
    }

    /// A tick of an ordinary tap.
    pub(super) fn float_on(
        &mut self,
        now: &Conditions<'_>,
        plan: &FloatPlan,
        setpoint: &mut Setpoint,
    ) -> Result<(), Alarm> {
        let Active::Float(run, speed) = &mut self.active else {
            return Ok(());
        };
        let point = run.tick(
            plan,
            &FloatTick {
                observer: now.observer,
                ahead: match plan.axis() {
                    TapAxis::X => now.ahead_x,
                    TapAxis::Z => now.ahead_z,
                },
                hold: now.hold,
                inside: !self.stops.hold_not_inside,
                arrival: &self.arrival,
            },
        );
        let alarm = point.alarm.map(|code| run.alarm(code, plan, now.observer));
        self.position = point.position;
        *speed = Some(run.command(plan));
        if point.done {
            self.active = Active::Free;
        }
        if let Some(alarm) = alarm {
            return Err(alarm);
        }
        self.tell(setpoint, point.motion);
        setpoint.locked = point.locked;
        setpoint.number = self.number.saturating_add(point.offset);
        Ok(())
    }
}
