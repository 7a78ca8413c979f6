//! Ordinary taps: from the spindle's angle to setpoints and speeds.

use audit::any::{any, sink};
use leadscrew_core::motion::{Arrival, FloatPlan, FloatRun, FloatTick, float_ticks};
use leadscrew_core::spindle::Observer;
use leadscrew_core::units::Ticks;

/// Calls all entries of this module.
pub fn all() {
    sink(float_ticks(&any(), any(), &any()));
    let Ok(plan) = FloatPlan::new(&any(), any(), any(), &any()) else {
        return;
    };
    sink((
        plan.lead_in(),
        plan.ahead(),
        plan.past_bottom(),
        plan.entry_speed(),
        plan.peak(any()),
    ));
    run(&plan);
}

#[inline(never)]
fn run(plan: &FloatPlan) {
    let mut observer = Observer::new(any(), any(), any());
    let arrival = Arrival {
        tolerance_percent: any(),
        speed_ticks: any(),
        ticks_per_minute: any(),
    };
    let mut run = FloatRun::new(plan, any());
    while any() {
        sink(observer.tick(any()));
        let now = FloatTick {
            observer: &observer,
            ahead: Ticks::one_and(any(), any()),
            hold: any(),
            inside: any(),
            arrival: &arrival,
        };
        sink(run.tick(plan, &now));
        sink((run.command(plan), run.line(plan)));
        if any() {
            sink(run.stop());
        }
    }
}
