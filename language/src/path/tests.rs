//! Programs with corners and the round nose, as moves.

use leadscrew_core::call::{Aux, CallKind};
use leadscrew_core::params::Params;
use leadscrew_core::program::Event;
use leadscrew_core::units::Length;

use crate::dialect::Control;
use crate::reading::{Outcome, read_on, with};

/// A machine of 0.001 mm whose tool 3 has a nose of 0.4 mm with tip direction 3, and whose tool 4 is a bar of 0.8 mm with
/// direction 2.
fn machine() -> Params {
    with(
        Params::sheets(),
        &[
            ("1004.1", 0),
            ("nose_radius_3", 400_000),
            ("nose_direction_3", 3),
            ("nose_radius_4", 800_000),
            ("nose_direction_4", 2),
        ],
    )
}

fn read(text: &str) -> Outcome {
    read_on(&machine(), Control::default(), text)
}

fn mm(length: Length) -> String {
    let text = format!("{:.6}", length.nm() as f64 / 1e6);
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// Letter, X as a diameter, Z; arcs with their radius and direction, other calls by their name.
pub(crate) fn moves_of(events: &[Event]) -> String {
    let mut list = Vec::new();
    for event in events {
        let call = match event {
            Event::Call(call) => call,
            Event::Warning(alarm) => {
                list.push(format!("w{}", alarm.number()));
                continue;
            }
        };
        let place = |to: &leadscrew_core::call::Position| {
            let (x, z) = (to.x - call.origin.x, to.z - call.origin.z);
            format!("{},{}", mm(Length::from_nm(x.nm() * 2)), mm(z))
        };
        list.push(match &call.kind {
            CallKind::Rapid(to) => format!("R{}", place(to)),
            CallKind::Line(to, _) => format!("F{}", place(to)),
            CallKind::Arc(arc) => {
                let radius = (arc.i.nm() as f64).hypot(arc.k.nm() as f64).round();
                let radius = mm(Length::from_nm(radius as i64));
                let way = if arc.clockwise { "cw" } else { "ccw" };
                format!("A{}/{radius}{way}", place(&arc.end))
            }
            CallKind::Aux(Aux::M(code)) => format!("M{code}"),
            CallKind::Aux(Aux::T(code)) => format!("T{code}"),
            CallKind::End(code) => format!("M{code}"),
            CallKind::Spindle(_) => "S".into(),
            CallKind::Dwell(_) => "D".into(),
            other => format!("{other:?}"),
        });
    }
    list.join(" ")
}

#[track_caller]
fn same(text: &str, expected: &str) {
    let (events, alarm) = read(text);
    assert_eq!(
        (moves_of(&events).as_str(), alarm),
        (expected, None),
        "{text}"
    );
}

#[track_caller]
fn refused(text: &str, number: u16, line: u32, before: &str) {
    let (events, alarm) = read(text);
    let alarm = alarm.unwrap_or_else(|| panic!("no alarm: {text}"));
    let found = (alarm.number(), alarm.span.line, moves_of(&events));
    assert_eq!(found, (number, line, before.to_owned()), "{text}");
}

#[test]
fn a_chamfer_and_a_rounding_shorten_both_motions() {
    same(
        "F100;G0 X20 Z2;G1 Z-20 ,C2;X40",
        "R20,2 F20,-18 F24,-20 F40,-20",
    );
    same(
        "F100;G0 X20 Z2;G1 Z-20 ,R3;X40",
        "R20,2 F20,-17 A26,-20/3cw F40,-20",
    );
    same(
        "F100;#1=2;G0 X20 Z2;G1 Z-20, C#1;X40 , R[#1-1];Z-30",
        "R20,2 F20,-18 F24,-20 F38,-20 A40,-21/1ccw F40,-30",
    );
    // Of the second motion nothing is left; M codes stay between.
    same(
        "F100;G0 X20 Z2;G1 Z-20 ,C2;M8;X24;Z-30",
        "R20,2 F20,-18 F24,-20 M8 F24,-20 F24,-30",
    );
}

#[test]
fn a_corner_without_two_cutting_motions_is_refused_before_the_first() {
    refused("F100;G0 X20 Z2;G1 Z-20 ,C2;G0 X40", 52, 3, "R20,2");
    refused("F100;G0 X20 Z2;G1 Z-20 ,C2;M30", 51, 3, "R20,2");
    refused("F100;G0 X20 Z2;G1 Z-20 ,C2", 51, 3, "R20,2");
    refused("F100;G0 X20 Z2 ,R2;G1 X40", 52, 2, "");
    refused("F100;G0 X20 Z2;M8 ,R2", 52, 3, "R20,2 M8");
    // The core's alarm at the block is the cause, and not the motion that it has kept away.
    refused("F100;G0 X20 Z2;G1 X40 B5 ,C2;Z-5", 4012, 3, "R20,2");
    refused("F100;G0 X20 Z2;G1 Z-20 ,C25;X40", 55, 3, "R20,2");
    refused("F100;G0 X20 Z2;G1 Z-20 ,C0;X40", 55, 3, "R20,2");
    refused("F100;G0 X20 Z2;G1 Z-20 ,C1 ,R1;X40", 4013, 3, "R20,2");
    refused("F100;G0 X20 Z2;G1 Z-20 ,A1;X40", 4028, 3, "R20,2");
}

#[test]
fn corners_stand_in_contours_of_the_roughing_cycles() {
    let program = |corner: &str, rest: &str| {
        format!(
            "F100;G0 X40 Z2;G71 U20 R0.5;G71 P1 Q2 U0 W0;N1 G0 X20;G1 Z-10 {corner};{rest}N2 X40;G0 Z5"
        )
    };
    let (short, alarm) = read(&program(",C2", ""));
    assert_eq!(alarm, None);
    let (long, alarm) = read(&program("", "Z-8;X24 Z-10;").replace("G1 Z-10 ;Z-8", "G1 Z-8"));
    assert_eq!(alarm, None);
    assert_eq!(moves_of(&short), moves_of(&long));
    refused(
        "F100;G0 X40 Z2;G71 U20 R0.5;G71 P1 Q2 U0 W0;N1 G0 X20;G1 Z-10;N2 X40 ,C1;G0 Z5",
        51,
        7,
        "R40,2",
    );
}

#[test]
fn the_nose_keeps_to_the_drawing() {
    same(
        "F100;T0303;G0 X14 Z2;G42 G1 Z0;X20 Z-3;Z-10;G2 X26 Z-13 R3;G1 X30;G40 G0 X34 Z-10",
        "T303 R14,2 F13.765686,-0.117157 F20,-3.234315 F20,-10.4 A25.2,-13/2.6cw F29.2,-13 R34,-10",
    );
    // What stands between comes out in its place.
    same(
        "F100;T0303;G0 X20 Z2;G42 G1 Z0;M8;Z-10;G4 P5;Z-20;M9;G40 X30;M30",
        "T303 R20,2 F20,-0.4 M8 F20,-10.4 D F20,-20.4 M9 F30,-20 M30",
    );
}

#[test]
fn a_tool_without_a_radius_is_told_and_cuts_as_written() {
    same(
        "F100;T0101;G0 X20 Z2;G42 G1 Z0;X30 Z-5;G40 X40",
        "T101 R20,2 w4993 F20,0 F30,-5 F40,-5",
    );
    // The radius of the tool that the same block calls counts.
    same(
        "F100;T0303;G0 X20 Z2;G42 T0101;G1 Z0;G40 X40",
        "T303 R20,2 w4993 T101 F20,0 F40,0",
    );
}

#[test]
fn reference_points_and_machine_coordinates_are_reached_without_the_nose() {
    let (events, alarm) =
        read("F100;T0303;G0 X20 Z2;G42 G1 Z0;Z-20;X30;G28 U0 W0;G0 X20 Z2;G1 Z-5;G40 X30");
    assert_eq!(alarm, None);
    let list = moves_of(&events);
    assert!(list.contains("F29.2,-20 R30,-20 R"), "{list}");
}

#[test]
fn what_the_nose_cannot_do_is_refused_before_it_moves() {
    let front = "F100;T0303;G0 X20 Z2;G42 G1 Z0;Z-10;";
    for (rest, number, line) in [
        ("G75 R0.5;G75 X10 Z-12 P3000 Q3000", 4602, 7),
        ("G90 X18 Z-20", 4602, 6),
        ("G1 C90", 4602, 6),
        ("G2 X20.4 Z-10.2 R0.2;G1 Z-20", 41, 6),
        ("G41 G42", 4016, 6),
    ] {
        let (_, alarm) = read(&format!("{front}{rest}"));
        let alarm = alarm.unwrap_or_else(|| panic!("no alarm: {rest}"));
        assert_eq!((alarm.number(), alarm.span.line), (number, line), "{rest}");
    }
}

#[test]
fn the_finishing_cut_of_a_contour_has_the_nose_and_the_roughing_has_not() {
    let contour = "N1 G0 X16;G42 G1 Z0;X20 Z-2;Z-10;N2 G40 X40";
    let with = format!("F100;T0303;G0 X40 Z2;G71 U20 R0.5;G71 P1 Q2 U0 W0;{contour};G70 P1 Q2;M30");
    let without = with.replace("G42 ", "").replace("G40 ", "");
    let cut = |text: &str| {
        let (events, alarm) = read(text);
        assert_eq!(alarm, None, "{text}");
        moves_of(&events)
    };
    let (with, without) = (cut(&with), cut(&without));
    let roughing = |list: &str| {
        list.split_once("R40,2 R16,2")
            .map(|(front, _)| front.to_owned())
    };
    assert_eq!(roughing(&with), roughing(&without));
    assert!(
        with.ends_with("R16,2 F15.765686,-0.117157 F20,-2.234315 F20,-10.4 F40,-10 R40,2 M30"),
        "{with}"
    );
}

#[test]
fn the_side_in_force_can_be_asked_for() {
    for (side, x) in [("G40", 40), ("G41", 41), ("G42", 42)] {
        let (events, alarm) = read(&format!(
            "F100;T0303;G0 X10 Z50;{side} Z40;#1=#4007;G40 G1 X[#1+60]"
        ));
        assert_eq!(alarm, None);
        let list = moves_of(&events);
        assert!(list.contains(&format!("F{},", x + 60)), "{side}: {list}");
    }
}
