//! The trade's alarms of tapping, from text: each before anything moves.

use leadscrew_core::call::{CallKind, Position};
use leadscrew_core::cycle::{Context, expand};
use leadscrew_core::program::{Event, Events, Options};

use leadscrew_tests::params::with;

/// The number of the alarm of a program, and whether a call that moves an axis came before it.
fn alarm(settings: &[(&str, i64)], text: &str) -> (Option<u16>, bool) {
    let params = with(settings);
    let mut moved = false;
    for event in Events::new(text.as_bytes(), &params, Options::default()) {
        match event {
            Err(alarm) => return (Some(alarm.number()), moved),
            Ok(Event::Warning(_)) => {}
            Ok(Event::Call(call)) => {
                if let Err(alarm) = expand(&call, &Context::standing(Position::ZERO)) {
                    return (Some(alarm.number()), moved);
                }
                moved |= !matches!(call.kind, CallKind::Spindle(_) | CallKind::Aux(_));
            }
        }
    }
    (None, moved)
}

#[test]
fn each_is_provoked_before_any_motion() {
    let refused = |number, settings: &[(&str, i64)], text: &str| {
        assert_eq!(alarm(settings, text), (Some(number), false), "{text}");
    };
    // S missing, 0, above 5241; in the cycle's block with 5200.0 = 1.
    refused(200, &[], "M29\nG84 Z-9 F100");
    refused(200, &[], "M29 S0\nG84 Z-9 F100");
    refused(200, &[], "M29 S3001\nG84 Z-9 F100");
    refused(200, &[("5241", 800)], "M29 S801\nG84 Z-9 F100");
    refused(200, &[("5200.0", 1)], "G84 Z-9 F100 S0");
    // No feed, a feed of zero.
    refused(201, &[], "M29 S500\nG84 Z-9");
    refused(201, &[], "M29 S500\nG84 Z-9 F0");
    // M29 in the wrong place.
    refused(203, &[], "M29 S500\nM8\nG84 Z-9 F500");
    refused(203, &[("5200.0", 1)], "M29 S500\nG84 Z-9 F500");
    // An axis between M29 and the cycle, or in the block of M29.
    refused(204, &[], "M29 S500\nG0 X5\nG84 Z-9 F500");
    refused(204, &[], "M29 S500 X5\nG84 Z-9 F500");
    // Another plane inside the mode.
    refused(206, &[], "G18 M29 S500\nG17 G84 Z-9 F500");
    // Bottom at R, on the wrong side; d above q.
    refused(207, &[], "M29 S500\nG84 Z0 F500");
    refused(207, &[], "M29 S500\nG84 Z5 R-3 F500");
    refused(207, &[], "M29 S500\nG84 Z-9 Q2 D3 F500");
    // And what is right is none of them.
    assert_eq!(alarm(&[], "M29 S500\nG84 Z-9 Q2 D2 F500\nG80").0, None);
}
