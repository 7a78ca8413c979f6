//! Programs as text against the calls they make.

// Figures of tests are small and known.
#![allow(clippy::arithmetic_side_effects, clippy::float_arithmetic)]

extern crate std;

mod alarms;
mod calls;
mod cycles;
mod data;
mod forms;
mod gears;
mod in_phase;
mod ordinary_taps;
mod parameters;
mod pickup;
mod random;
mod returns;
mod rigid;
mod strokes;
mod taps;
mod turret;

use super::*;
use crate::alarm::{Alarm, Span};
use crate::call::*;
use crate::params::Params;
use crate::units::{CentiRpm, Length, Remainder, Rpm};
use parameters::machine;
use std::vec::Vec;

/// Everything `text` yields, and the alarm that ends it.
fn read_with(text: &[u8], params: &Params, options: Options) -> (Vec<Event>, Option<Alarm>) {
    let mut events = Vec::new();
    for event in Events::new(text, params, options) {
        match event {
            Ok(event) => events.push(event),
            Err(alarm) => return (events, Some(alarm)),
        }
    }
    (events, None)
}

fn read(text: &str) -> (Vec<Event>, Option<Alarm>) {
    read_with(text.as_bytes(), &Params::sheets(), Options::default())
}

/// The calls of a program without alarm or warning.
fn calls(text: &str) -> Vec<Call> {
    let (events, alarm) = read(text);
    assert_eq!(alarm, None, "{text}");
    events
        .into_iter()
        .map(|event| match event {
            Event::Call(call) => call,
            Event::Warning(alarm) => panic!("{alarm:?} in {text}"),
        })
        .collect()
}

fn kinds(text: &str) -> Vec<CallKind> {
    calls(text).into_iter().map(|call| call.kind).collect()
}

/// The alarm that ends a program.
fn alarm(text: &str) -> Alarm {
    read(text).1.unwrap_or_else(|| panic!("no alarm: {text}"))
}

/// A point: diameter and Z in millimetres · 10⁴.
fn at(x: i64, z: i64) -> Position {
    Position {
        x: Length::from_nm(x * 50),
        z: Length::from_nm(z * 100),
        ..Position::ZERO
    }
}

fn mm(value: i64) -> Length {
    Length::from_nm(value * 1_000_000)
}

fn um(value: i64) -> Length {
    Length::from_nm(value * 1_000)
}

fn span(line: u32, column: u16, end: u16) -> Span {
    Span { line, column, end }
}

fn spindle(rpm: i32) -> CallKind {
    CallKind::Spindle(SpindleCall::speed(Rpm::new(rpm)))
}

/// The calls of a right program on the built-in machine with these values, and the numbers of its warnings.
fn kinds_on(values: &[(&str, &str)], text: &str) -> (Vec<CallKind>, Vec<u16>) {
    let params = machine(values);
    let (events, alarm) = read_with(text.as_bytes(), &params, Options::default());
    assert_eq!(alarm, None, "{text}");
    let (mut kinds, mut warnings) = (Vec::new(), Vec::new());
    for event in events {
        match event {
            Event::Call(call) => kinds.push(call.kind),
            Event::Warning(alarm) => warnings.push(alarm.number()),
        }
    }
    (kinds, warnings)
}

fn lead_of(call: &TapCall) -> (i64, i64) {
    (call.lead.value.numerator(), call.lead.value.denominator())
}

fn rpm(value: i32) -> CentiRpm {
    CentiRpm::of_rpm(Rpm::new(value))
}
