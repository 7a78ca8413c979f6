//! G30 P99.

use super::*;
use crate::alarm::Code;
use crate::params::Entry;
use crate::units::CentiRpm;

fn machine(settings: &[(&str, i64)]) -> Params {
    let mut params = Params::sheets();
    for (number, value) in settings {
        let entry = Entry::find_text(number).unwrap();
        params.set(entry, *value).unwrap();
    }
    params
}

/// The calls of a program and the alarm that ends it.
fn read_on(settings: &[(&str, i64)], text: &str) -> (Vec<CallKind>, Option<Alarm>) {
    let (events, alarm) = read_with(text.as_bytes(), &machine(settings), Options::default());
    let kinds = events.into_iter().map(|event| match event {
        Event::Call(call) => call.kind,
        Event::Warning(alarm) => panic!("{alarm:?} in {text}"),
    });
    (kinds.collect(), alarm)
}

fn tapped_out(rpm: Option<i32>) -> TapReturn {
    TapReturn {
        speed: rpm.map(|rpm| CentiRpm::new(rpm * 100)),
        highest: CentiRpm::new(300_000),
        beyond: Length::ZERO,
        unit: LengthUnit::Metric,
    }
}

#[test]
fn the_sheets_program() {
    assert_eq!(
        kinds("G30 P99 S500\nM30\n"),
        [
            CallKind::TapReturn(tapped_out(Some(500))),
            CallKind::End(30)
        ]
    );
    assert_eq!(
        kinds("N5 P99 G30"),
        [CallKind::TapReturn(tapped_out(None))],
        "S omitted"
    );
}

#[test]
fn limits_way_and_unit_go_with_it() {
    let (kinds, alarm) = read_on(
        &[("5382", 1_500_000), ("5241", 800)],
        "G20\nG30 P99 S800 M8\nG4 X1\nM9\n",
    );
    assert_eq!(alarm, None);
    let expected = TapReturn {
        highest: CentiRpm::new(80_000),
        beyond: um(1500),
        unit: LengthUnit::Inch,
        ..tapped_out(Some(800))
    };
    assert_eq!(kinds[0], CallKind::Aux(Aux::M(8)));
    assert_eq!(kinds[1], CallKind::TapReturn(expected));
    assert_eq!(kinds.len(), 4, "what moves nothing may follow");
    let (_, alarm) = read_on(&[("5241", 800)], "G30 P99 S801\n");
    assert_eq!(alarm.unwrap().code, Code::TapSpeed);
}

#[test]
fn not_with_the_g_code_that_begins_rigid_mode_itself() {
    let (kinds, alarm) = read_on(&[("5200.0", 1)], "G30 P99 S500\n");
    let alarm = alarm.unwrap();
    assert_eq!(kinds, []);
    assert_eq!(
        (alarm.code, alarm.span),
        (Code::TapReturnByGCode, span(1, 1, 4))
    );
}

/// Behind a K198 the text itself knows where the tap is, and goes on from there.
#[test]
fn out_of_a_hole_that_was_left_locked_the_program_goes_on() {
    let text = "G98 M29 S1000\nG84 Z-20 R-2 F2000 K198\nG30 P99\nG0 W1\nM3 S300\n";
    let (kinds, alarm) = read_on(&[("5382", 3_000_000)], text);
    assert_eq!(alarm, None);
    let out = TapReturn {
        beyond: mm(3),
        ..tapped_out(None)
    };
    assert_eq!(
        kinds[2..],
        [
            CallKind::TapReturn(out),
            // R at −2, 3 beyond, 1 more.
            CallKind::Rapid(at(0, 20_000)),
            spindle(300),
        ]
    );
    // S was cleared with the cycle.
    let (_, alarm) = read_on(&[], "M29 S1000\nG84 Z-20 F2000 K198\nG30 P99\nZ5\nG84 Z-9");
    assert!(alarm.is_some());
}
