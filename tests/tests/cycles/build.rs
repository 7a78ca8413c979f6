//! Calls for tests, in the units people write: millimetres, X as a diameter.

use leadscrew_core::alarm::{At, Span};
use leadscrew_core::call::*;
use leadscrew_core::units::*;

/// Millimetres with at most six decimals to nanometres, exactly.
pub fn nm(mm: f64) -> i64 {
    let nm = mm * 1e6;
    assert!(
        (nm - nm.round()).abs() < 1e-3,
        "{mm} is no whole number of nanometres"
    );
    nm.round() as i64
}

pub fn mm(mm: f64) -> Length {
    Length::from_nm(nm(mm))
}

/// X as a diameter in millimetres to the radius.
pub fn dia(x: f64) -> Length {
    Diameter::from_nm(nm(x)).radius()
}

pub fn at<T>(value: T) -> At<T> {
    At::new(value, Span::default())
}

pub fn word<T>(value: T, column: u16) -> At<T> {
    At::new(value, place(column))
}

pub fn place(column: u16) -> Span {
    Span {
        line: 7,
        column,
        end: column + 2,
    }
}

pub fn point(x: f64, z: f64) -> Position {
    Position {
        x: dia(x),
        z: mm(z),
        c: Angle::from_udeg(12),
    }
}

pub fn lead(mm: f64) -> Lead {
    Lead::new(nm(mm), 1).unwrap()
}

pub fn run_out(short: f64, long: f64) -> Option<RunOut> {
    Some(RunOut {
        short: word(mm(short), 60),
        long: word(mm(long), 70),
        short_rest: Remainder::ZERO,
        long_rest: Remainder::ZERO,
    })
}

/// O0013 of the sheet, resolved.
pub fn o0013() -> ThreadCall {
    ThreadCall {
        cycle: ThreadCycle::G76,
        start: point(80.0, 10.0),
        end_x: word(dia(60.64), 10),
        end_z: word(mm(-62.0), 20),
        taper: at(Length::ZERO),
        height: word(mm(3.68), 30),
        first_depth: word(mm(1.8), 40),
        min_step: word(mm(0.15), 45),
        allowance: word(mm(0.1), 50),
        finish_passes: at(2),
        angle: at(60),
        infeed: Infeed::Decreasing,
        cut_in: at(CutIn::Trailing),
        starts: at(1),
        run_in: at(Length::ZERO),
        run_out: run_out(3.0, 3.0),
        lead: at(lead(6.0)),
        change: at(LeadChange::NONE),
        first_angle: StartAngle::INDEX,
        part: ChainPart::Whole,
        increment: Length::from_nm(100),
        rpm: Rpm::new(300),
    }
}

/// The straight thread of the G78 sheet.
pub fn g78() -> ThreadCall {
    ThreadCall {
        cycle: ThreadCycle::G78,
        end_x: word(dia(60.0), 10),
        end_z: word(mm(-60.0), 20),
        height: word(mm(3.0), 30),
        allowance: word(mm(0.5), 50),
        angle: at(45),
        cut_in: at(CutIn::Right),
        run_out: run_out(1.5, 2.0),
        lead: at(lead(300.0)),
        rpm: Rpm::STOPPED,
        ..o0013()
    }
}

/// The internal taper of the worked cases.
pub fn internal_taper() -> ThreadCall {
    ThreadCall {
        start: point(26.0, 5.0),
        end_x: word(dia(30.0), 10),
        end_z: word(mm(-30.0), 20),
        taper: word(mm(-0.5), 25),
        height: word(mm(0.92), 30),
        first_depth: word(mm(0.35), 40),
        min_step: word(mm(0.08), 45),
        allowance: word(mm(0.05), 50),
        finish_passes: at(1),
        run_out: run_out(1.5, 1.5),
        lead: at(lead(1.5)),
        ..o0013()
    }
}

/// O0008 of the sheet, resolved.
pub fn o0008() -> GrooveCall {
    GrooveCall {
        axis: TapAxis::X,
        start: point(125.0, -24.0),
        end_x: word(dia(40.0), 10),
        end_z: word(mm(-50.0), 20),
        last_written: true,
        peck: Some(word(dia(6.0), 30)),
        step: Some(word(mm(3.0), 40)),
        relief: at(Length::ZERO),
        retract: at(mm(0.5)),
        feed: FeedRate::PerMinute(Feed::from_nm_per_min(150_000_000)),
    }
}
