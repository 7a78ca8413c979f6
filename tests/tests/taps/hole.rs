//! Holes to tap, as calls.

use std::num::NonZeroU8;

use leadscrew_core::alarm::{At, Span};
use leadscrew_core::call::{
    Call, CallKind, HandChoice, Position, SpindleCall, SpindleChoice, TapAxis, TapCall, TapCycle,
    TapForm, TapMode, TapNotes, TapPeck, TapRepeat,
};
use leadscrew_core::units::{CentiRpm, Lead, Length, Millis, Rpm};

pub fn nm(nm: i64) -> Length {
    Length::from_nm(nm)
}

fn at<T>(value: T) -> At<T> {
    At::new(value, Span::default())
}

/// The sheet's hole at X0 Z0: 50 mm deep at lead 2 and S1000, without dwell, R at the initial level.
pub fn sheet() -> TapCall {
    let place = Position::ZERO;
    TapCall {
        cycle: TapCycle::G84,
        mode: TapMode::Rigid,
        axis: TapAxis::Z,
        start: place,
        hole: place,
        step: place,
        level: at(Length::ZERO),
        bottom: at(nm(-50_000_000)),
        form: TapForm::Standard,
        dwell: Millis::new(0),
        lead: at(Lead::new(2_000_000_000, 1000).expect("a lead")),
        hand: HandChoice::Signal,
        speed: CentiRpm::of_rpm(Rpm::new(1000)),
        extract: CentiRpm::of_rpm(Rpm::new(1000)),
        spindle: SpindleChoice::default(),
        repeat: TapRepeat::Holes(NonZeroU8::MIN),
        clamp: None,
        continues: false,
        notes: TapNotes::default(),
    }
}

/// Q and D in micrometres.
pub fn peck(infeed: i64, back: i64) -> TapPeck {
    TapPeck {
        infeed: at(nm(infeed * 1000)),
        back: at(nm(back * 1000)),
    }
}

pub fn high_speed(call: TapCall, infeed: i64, back: i64) -> TapCall {
    TapCall {
        form: TapForm::HighSpeed(peck(infeed, back)),
        ..call
    }
}

pub fn deep(call: TapCall, infeed: i64, back: i64) -> TapCall {
    TapCall {
        form: TapForm::Deep(peck(infeed, back)),
        ..call
    }
}

/// Bottom in micrometres from the machine's zero.
pub fn bottom(call: TapCall, um: i64) -> TapCall {
    TapCall {
        bottom: at(nm(um * 1000)),
        ..call
    }
}

/// Rigid mode, the holes, speed mode, the end.
pub fn program(holes: &[TapCall]) -> Vec<Call> {
    let call = |line: usize, kind| Call {
        span: Span {
            line: line as u32,
            column: 1,
            end: 4,
        },
        origin: Position::ZERO,
        kind,
    };
    let rigid = SpindleCall::rigid(Rpm::new(1000), SpindleChoice::default());
    let mut calls = vec![call(1, CallKind::Spindle(rigid))];
    for (index, hole) in holes.iter().enumerate() {
        calls.push(call(2 + index, CallKind::Tap(*hole)));
    }
    let after = 2 + holes.len();
    calls.push(call(after, CallKind::Spindle(SpindleCall::STOPPED)));
    calls.push(call(after + 1, CallKind::End(30)));
    calls
}
