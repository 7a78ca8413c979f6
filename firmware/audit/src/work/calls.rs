//! The calls of the programs that are counted.

use leadscrew_core::alarm::{At, Span};
use leadscrew_core::call::{
    ChainPart, CutIn, FeedRate, GrooveCall, Infeed, Position, RunOut, TapAxis, ThreadCall,
    ThreadCycle,
};
use leadscrew_core::units::{Angle, Feed, Lead, LeadChange, Length, Remainder, Rpm, StartAngle};

fn at<T>(value: T) -> At<T> {
    At::new(value, Span::default())
}

fn um(micrometres: i64) -> Length {
    Length::from_nm(micrometres * 1000)
}

/// A position from X as a diameter and Z, in micrometres.
fn position(x: i64, z: i64) -> Position {
    Position {
        x: um(x / 2),
        z: um(z),
        c: Angle::ZERO,
    }
}

/// O0013 of the [G76 sheet]: 30 moves.
pub fn o0013() -> ThreadCall {
    ThreadCall {
        cycle: ThreadCycle::G76,
        start: position(80_000, 10_000),
        end_x: at(um(30_320)),
        end_z: at(um(-62_000)),
        taper: at(Length::ZERO),
        height: at(um(3_680)),
        first_depth: at(um(1_800)),
        min_step: at(um(150)),
        allowance: at(um(100)),
        finish_passes: at(2),
        angle: at(60),
        infeed: Infeed::Decreasing,
        cut_in: at(CutIn::Trailing),
        starts: at(1),
        run_in: at(Length::ZERO),
        run_out: Some(RunOut {
            short: at(um(3_000)),
            long: at(um(3_000)),
            short_rest: Remainder::ZERO,
            long_rest: Remainder::ZERO,
        }),
        lead: at(lead(6_000)),
        change: at(LeadChange::NONE),
        first_angle: StartAngle::INDEX,
        part: ChainPart::Whole,
        increment: Length::from_nm(100),
        rpm: Rpm::new(300),
    }
}

/// O0008 of the [G75 sheet]: 310 moves.
pub fn o0008() -> GrooveCall {
    GrooveCall {
        axis: TapAxis::X,
        start: position(125_000, -24_000),
        end_x: at(um(20_000)),
        end_z: at(um(-50_000)),
        last_written: true,
        peck: Some(at(um(3_000))),
        step: Some(at(um(3_000))),
        relief: at(Length::ZERO),
        retract: at(um(500)),
        feed: FeedRate::PerMinute(Feed::from_nm_per_min(150_000_000)),
    }
}

fn lead(um_per_turn: i64) -> Lead {
    match Lead::new(um_per_turn * 1000, 1) {
        Some(lead) => lead,
        None => unreachable!("a lead is positive"),
    }
}
