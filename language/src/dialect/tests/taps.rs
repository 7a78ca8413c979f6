//! G98 and G99 of the FANUC systems B and C: where a tap ends.

use leadscrew_core::call::CallKind;
use leadscrew_core::cycle::{self, Context};
use leadscrew_core::moves::MoveKind;
use leadscrew_core::signals::Signals;

use super::*;

/// The moves of the taps and rapids of a program: R or T, X as a radius and Z.
fn taps(control: Control, text: &str) -> Result<String, u16> {
    let params = Params::slant_bed();
    let (events, alarm) = read_on(&params, control, text);
    if let Some(alarm) = alarm {
        return Err(alarm.number());
    }
    let mut at = Options::default().position;
    let mut list = Vec::new();
    for event in events {
        let Event::Call(call) = event else { continue };
        if !matches!(call.kind, CallKind::Rapid(_) | CallKind::Tap(_)) {
            continue;
        }
        let context = Context {
            at,
            signals: Signals::default(),
            tap: None,
        };
        let moves = cycle::expand(&call, &context).map_err(|alarm| alarm.number())?;
        for step in moves {
            let letter = match step.kind {
                MoveKind::Rapid => 'R',
                MoveKind::Tap(_) => 'T',
                _ => continue,
            };
            at = step.to;
            let [x, z] = [at.x, at.z].map(|length| length.nm() as f64 / 1e6);
            list.push(format!("{letter}{x},{z}"));
        }
    }
    Ok(list.join(" "))
}

#[test]
fn a_tap_ends_at_r_with_g99_and_at_the_initial_level_with_g98() {
    let start = "G97 M3 S300;G94 G0 X0 Z5";
    for control in [Control::FanucB, Control::FanucC] {
        for (holes, expected) in [
            ("G98 G84 Z-9 R-3 F300", "R0,2 T0,-9 T0,2 R0,5"),
            ("G99 G84 Z-9 R-3 F300", "R0,2 T0,-9 T0,2"),
            // The place first, at the level of the start; the next one at R. R stays where it is.
            (
                "G99 G84 X4 Z-9 R-3 F300;X8;X12 R-1",
                "R2,5 R2,2 T2,-9 T2,2 R4,2 T4,-9 T4,2 R6,2 R6,4 T6,-9 T6,4",
            ),
            // Repeats, and back to the level of the start with G98.
            (
                "G99 G84 U4 Z-9 R-3 F300 K2;G98 X12;X16",
                "R2,5 R2,2 T2,-9 T2,2 R4,2 T4,-9 T4,2 R6,2 T6,-9 T6,2 R6,5 R8,5 R8,2 T8,-9 T8,2 R8,5",
            ),
            // A new cycle has a level of its own.
            (
                "G99 G84 Z-9 R-3 F300;G80;G84 Z-9 R-1 F300",
                "R0,2 T0,-9 T0,2 R0,1 T0,-9 T0,1",
            ),
        ] {
            let text = format!("{start};{holes};G80");
            let found = taps(control, &text);
            assert_eq!(found, Ok(format!("R0,5 {expected}")), "{control:?} {holes}");
            let rigid = format!("G94 G0 X0 Z5;M29 S300;{holes};G80");
            let rigid = taps(control, &rigid);
            if !holes.contains("G80") {
                assert_eq!(rigid, found, "{control:?} {holes}");
            }
        }
        let wrong = format!("{start};G99 G84 Z-9 R3 F300;G80");
        assert_eq!(taps(control, &wrong), Err(207));
        assert_eq!(taps(control, &wrong.replace("G99", "G98")), Err(207));
    }
    // G99 is the feed of the other controls.
    let text = "G97 M3 S300;G99 G0 X0 Z5;G84 Z-9 R-3 F1;G80";
    let ends = "R0,5 R0,2 T0,-9 T0,2 R0,5";
    assert_eq!(taps(Control::FanucA, text).as_deref(), Ok(ends));
}
