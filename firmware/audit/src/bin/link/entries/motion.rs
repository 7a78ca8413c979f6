//! From moves to setpoints.

use audit::any::{any, sink};
use leadscrew_core::call::Position;
use leadscrew_core::motion::{
    Arc, Gear, Limits, Line, PathRate, Profile, Rate, Run, Tap, TapLine, TapStep, ThreadPlan,
    ThreadRun, dwell_ticks, plan, stroke,
};
use leadscrew_core::moves::Move;

/// Calls all entries of this module.
pub fn all() {
    rates();
    path();
    profile();
    run();
    thread_plan();
    thread_run();
    tap();
}

#[inline(never)]
fn tap() {
    let Some(gear) = Gear::new(any(), any(), any(), any(), any()) else {
        return;
    };
    sink((gear.turns(any()), gear.position(any())));
    let line = TapLine::through(gear, any(), any());
    sink((line.angle(any()), line.error(any(), any())));
    let mut tap = Tap::new(gear, any(), any(), any());
    while any() {
        sink(tap.push(TapStep::Dwell(dwell_ticks(any(), any()))));
        if let Ok(stroke) = stroke(&any(), any(), &any(), &any(), any()) {
            sink((
                stroke.peak(),
                stroke.reaches_speed(),
                stroke.duration_ticks(),
            ));
            sink(tap.push(TapStep::Stroke(stroke)));
        }
        sink((tap.step(any()), tap.repeats(), tap.is_empty()));
    }
}

#[inline(never)]
fn rates() {
    sink(PathRate::of_feed(any(), any()).feed(any()));
    sink(any::<Rate>().times(Rate::percent(any())).of(any()));
}

#[inline(never)]
fn path() {
    let line = Line::new(any(), any());
    sink((
        line.length(),
        line.feed_length(),
        line.end(),
        line.at(any()),
    ));
    if let Ok(arc) = Arc::new(any(), any(), any(), any(), any()) {
        sink((arc.length(), arc.end(), arc.at(any())));
    }
}

#[inline(never)]
fn profile() {
    let mut profile = <Profile>::new();
    while any() {
        sink(profile.begin(any(), any(), any()));
        sink(profile.tick(any()));
        sink((profile.speed(), profile.remaining(), profile.at_rest()));
        if any() {
            profile.abandon();
        }
    }
}

#[inline(never)]
fn run() {
    let mut run = Run::new();
    let limits: Limits = any();
    let timed = || plan::timed(any::<Position>(), &any::<Move>(), &limits);
    while let Ok(Some(current)) = timed() {
        sink(current.duration_ticks());
        sink(run.begin(&current));
        sink(run.tick(any(), &current));
        if any() {
            run.abandon();
        }
    }
}

#[inline(never)]
fn any_thread_plan() -> Option<ThreadPlan> {
    let moves: [Move; 4] = [any(), any(), any(), any()];
    ThreadPlan::new(any(), moves.get(..any())?, &any(), any()).ok()
}

#[inline(never)]
fn thread_plan() {
    if let Some(plan) = any_thread_plan() {
        sink((
            plan.start(),
            plan.end(),
            plan.lead_in(),
            plan.braking(),
            plan.falling_lead(),
        ));
        sink((
            plan.run_out_lag(),
            plan.run_out_needed(),
            plan.speed_limit(),
            plan.turns(),
        ));
    }
}

#[inline(never)]
fn thread_run() {
    let Some(plan) = any_thread_plan() else {
        return;
    };
    let Ok(mut run) = ThreadRun::start(&plan, any(), any()) else {
        return;
    };
    while any() {
        sink(run.tick(&plan, any()));
        sink((run.phase(), run.helix(&plan).at(any())));
        if any() {
            sink(run.retract(&plan, any()));
        }
        if any() {
            run.stop(&plan);
        }
    }
}
