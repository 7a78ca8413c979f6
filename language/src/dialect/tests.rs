//! Programs of other controls against the same program of system A, call by call.

mod haas;
mod readings;
mod remedies;
mod system_variables;
mod taps;

use leadscrew_core::alarm::{Alarm, Arg};
use leadscrew_core::call::{CallKind, CutIn, Infeed, ThreadCall};
use leadscrew_core::params::Params;
use leadscrew_core::program::{Event, Options};

use super::{Control, Named, named};
use crate::flow::Rules;
use crate::reader::Reader;
use crate::reading::{Outcome, read_on, with};
use crate::variables::Kept;

fn machine(sets: &[(&str, i64)]) -> Params {
    with(Params::slant_bed(), sets)
}

fn read(control: Control, text: &str) -> Outcome {
    read_on(&machine(&[]), control, text)
}

/// What a program does, without places.
#[track_caller]
fn kinds(control: Control, text: &str) -> Vec<String> {
    let (events, alarm) = read(control, text);
    assert_eq!(alarm, None, "{text}");
    let kind = |event: &Event| match event {
        Event::Call(call) => without_places(&call.kind),
        Event::Warning(alarm) => format!("w{}", alarm.number()),
    };
    events.iter().map(kind).collect()
}

/// A call as text, its columns and lines left out.
fn without_places(kind: &CallKind) -> String {
    let text = format!("{kind:?}");
    let mut shown = String::new();
    let mut rest = text.as_str();
    while let Some(at) = rest.find("Span {") {
        shown.push_str(&rest[..at]);
        let end = rest[at..].find('}').expect("a span ends");
        rest = &rest[at + end + 1..];
    }
    shown + rest
}

#[track_caller]
fn same(control: Control, text: &str, a: &str) {
    assert_eq!(kinds(control, text), kinds(Control::FanucA, a), "{text}");
}

fn alarm(control: Control, text: &str) -> Alarm {
    read(control, text).1.expect(text)
}

fn thread(control: Control, text: &str) -> ThreadCall {
    let (events, alarm) = read(control, text);
    assert_eq!(alarm, None, "{text}");
    let thread = events.iter().find_map(|event| match event {
        Event::Call(call) => match call.kind {
            CallKind::Thread(thread) => Some(thread),
            _ => None,
        },
        Event::Warning(_) => None,
    });
    thread.expect("a thread")
}

#[test]
fn system_b_is_system_a_with_other_codes() {
    let same = |b: &str, a: &str| same(Control::FanucB, b, a);
    same(
        "G0 X60 Z2;G77 X50 Z-40 R-3 F0.2;X45",
        "G0 X60 Z2;G90 X50 Z-40 R-3 F0.2;X45",
    );
    same("G0 X60 Z2;G79 X20 Z-5 F.1", "G0 X60 Z2;G94 X20 Z-5 F.1");
    same(
        "M3 S500;G0 X40 Z5;G78 X29.3 Z-30 F2;X28.7",
        "M3 S500;G0 X40 Z5;G92 X29.3 Z-30 F2;X28.7",
    );
    same(
        "G92 X100 Z50;G92 S2000;G96 S150 M3;G0 X50 Z0",
        "G50 X100 Z50;G50 S2000;G96 S150 M3;G0 X50 Z0",
    );
    same(
        "G94 F100;G1 X10;G95 F0.2;Z-5",
        "G98 F100;G1 X10;G99 F0.2;Z-5",
    );
    // G91 counts X, Z and C from where the tool is, and G90 ends it.
    same(
        "G0 X60 Z2;G91;G1 X-2 Z-3 F.2;G90 X10",
        "G0 X60 Z2;G1 U-2 W-3 F.2;X10",
    );
    same("G91 G28 X0 Z0;G90 G0 X5", "G28 U0 W0;G0 X5");
    same("G91;G4 X1;G92 X10 Z5", "G4 X1;G50 X10 Z5");
}

#[test]
fn system_c_is_system_a_with_other_codes() {
    let same = |c: &str, a: &str| same(Control::FanucC, c, a);
    same("G0 X60 Z2;G20 X50 Z-40 F.2", "G0 X60 Z2;G90 X50 Z-40 F.2");
    same("G0 X60 Z2;G24 X20 Z-5 F.1", "G0 X60 Z2;G94 X20 Z-5 F.1");
    same(
        "M3 S500;G0 X40 Z5;G21 X29.3 Z-30 F2",
        "M3 S500;G0 X40 Z5;G92 X29.3 Z-30 F2",
    );
    same("G70;G0 X1;G71;X1", "G20;G0 X1;G21;X1");
    let contour = "N1 G0 X20;G1 Z-10;N2 X40;";
    same(
        &format!("G0 X40 Z2;G73 U3 R0.5;G73 P1 Q2 U0.4 W0.1 F.2;{contour}G72 P1 Q2"),
        &format!("G0 X40 Z2;G71 U3 R0.5;G71 P1 Q2 U0.4 W0.1 F.2;{contour}G70 P1 Q2"),
    );
    same(
        "G0 X40 Z2;G77 R.5;G77 X20 Z-6 P2000 Q3000 F.1",
        "G0 X40 Z2;G75 R.5;G75 X20 Z-6 P2000 Q3000 F.1",
    );
    same(
        "M3 S500;G0 X40 Z5;G78 P010060 Q100 R.05;G78 X28 Z-20 P1000 Q300 F1.5",
        "M3 S500;G0 X40 Z5;G76 P010060 Q100 R.05;G76 X28 Z-20 P1000 Q300 F1.5",
    );
}

#[test]
fn a_code_of_another_system_is_refused_as_it_is_written() {
    for (control, text, code) in [
        (Control::FanucB, "G50 S1000", 50),
        (Control::FanucB, "G32 Z-5 F1", 32),
        (Control::FanucC, "G32 Z-5 F1", 32),
        (Control::Haas, "G77 X5", 77),
    ] {
        let alarm = alarm(control, text);
        assert_eq!(
            (alarm.number(), alarm.args[0]),
            (4018, Arg::GCode(code * 10))
        );
    }
    // Codes in messages are those of the program.
    let alarm = alarm(Control::FanucB, "G0 X50 Z2;G77 X40 Z-5 G0");
    assert_eq!(alarm.number(), 4016);
    assert!(alarm.args.contains(&Arg::GCode(770)), "{alarm:?}");
}

#[test]
fn codes_with_a_point_are_refused_by_name() {
    for control in Control::ALL {
        for (text, number, code) in [
            ("G12.1", 4095, 121),
            ("G0 X1 G84.1", 4097, 841),
            ("G5.4", 4020, 54),
        ] {
            let alarm = alarm(control, text);
            assert_eq!((alarm.number(), alarm.args[0]), (number, Arg::GCode(code)));
        }
    }
}

#[test]
fn p_and_q_of_a_fanuc_are_counts_on_the_radius() {
    same(
        Control::Gsk988,
        "G99;G0 X40 Z2;G75 R.5;G75 X20 Z-6 P2. Q3. F.1",
        "G0 X40 Z2;G75 R.5;G75 X20 Z-6 P2000 Q3000 F.1",
    );
    let refused = alarm(
        Control::FanucA,
        "G0 X40 Z2;G75 R.5;G75 X20 Z-6 P2. Q3000 F.1",
    );
    assert_eq!(refused.number(), 4045);
    same(
        Control::FanucA,
        "#1=2;G0 X40 Z2;G75 R.5;G75 X20 Z-6 P[#1*1000] Q3000 F.1",
        "G0 X40 Z2;G75 R.5;G75 X20 Z-6 P2000 Q3000 F.1",
    );
}

#[test]
fn grooves_and_pecks_in_one_block() {
    let two = "G99;G0 X40 Z2;G75 X20 Z-6 P2. Q3. R.2 F.1";
    let one = "G0 X40 Z2;G75 X20. Z-6. I2. K3. D.2 F.1";
    assert_eq!(kinds(Control::Haas, one), kinds(Control::Gsk988, two));
    // The 980TD counts increments, P on the diameter.
    assert_eq!(
        kinds(
            Control::Gsk980td,
            "G99;G0 X40 Z2;G75 X20 Z-6 I2. K3. D.2 F.1"
        ),
        kinds(
            Control::Gsk980td,
            "G99;G0 X40 Z2;G75 X20 Z-6 P4000 Q3000 R.2 F.1"
        ),
    );
    // D without a point: increments of a FANUC.
    same(
        Control::FanucA,
        "G0 X40 Z2;G75 X20 Z-6 I2. K3. D200 F.1",
        "G0 X40 Z2;G75 X20 Z-6 P2000 Q3000 R.2 F.1",
    );
    assert_eq!(
        kinds(Control::Haas, "G0 X0 Z2;G74 Z-12. K5. F.1"),
        kinds(Control::Gsk988, "G99;G0 X0 Z2;G74 Z-12. Q5. F.1"),
    );
    assert_eq!(
        alarm(Control::Haas, "G0 X40;G75 X20 I2 P3 F.1").number(),
        4028
    );
}

#[test]
fn a_thread_in_one_block_has_its_words() {
    let text = "M3 S500;G0 X22 Z5;G76 X17.546 Z-25 K1.227 D0.4 F2 A60";
    let thread = thread(Control::Haas, text);
    assert_eq!(
        (thread.height.value.nm(), thread.first_depth.value.nm()),
        (1_227_000, 400_000)
    );
    assert_eq!(
        (thread.infeed, thread.cut_in.value),
        (Infeed::Decreasing, CutIn::Left)
    );
    assert_eq!((thread.angle.value, thread.allowance.value.nm()), (60, 0));
    let with = |words: &str| self::thread(Control::Haas, &format!("{text} {words}"));
    assert_eq!(with("P2").cut_in.value, CutIn::LeftRight);
    assert_eq!(
        (with("P3").infeed, with("P3").cut_in.value),
        (Infeed::Equal, CutIn::Left)
    );
    assert_eq!(with("I-0.5").taper.value.nm(), -500_000);
    assert_eq!(with("").first_angle.mdeg(), 0);
    assert_eq!(with("Q60000").first_angle.mdeg(), 60_000);
    assert_eq!(alarm(Control::Haas, &format!("{text} P9")).number(), 4025);
    assert_eq!(alarm(Control::Haas, &format!("{text} R1")).number(), 4028);
}

#[test]
fn q_of_a_thread_in_one_block_is_its_start_angle_in_every_dialect() {
    for control in Control::ALL {
        let text = match control {
            Control::FanucC => "G97 M3 S500;G0 X22. Z5.;G78 X17.546 Z-25. K1.227 D0.4 F2. A60",
            _ => "G97 M3 S500;G0 X22. Z5.;G76 X17.546 Z-25. K1.227 D0.4 F2. A60",
        };
        let with = |words: &str| thread(control, &format!("{text} {words}"));
        let thread = with("Q120000");
        assert_eq!(thread.first_angle.mdeg(), 120_000, "{control:?}");
        assert_eq!(thread.first_depth.value.nm(), 400_000, "{control:?}");
        // It is for its block alone, and a macro may calculate it.
        let after = format!(
            "{text} Q120000;G0 X22. Z5.;{}",
            text.rsplit(';').next().unwrap()
        );
        let (events, refused) = read(control, &after);
        assert_eq!(refused, None, "{after}");
        let angle = |event: &Event| match event {
            Event::Call(call) => match call.kind {
                CallKind::Thread(thread) => Some(thread.first_angle.mdeg()),
                _ => None,
            },
            Event::Warning(_) => None,
        };
        let threads: Vec<u32> = events.iter().filter_map(angle).collect();
        assert_eq!(threads, [120_000, 0], "{control:?}");
        assert_eq!(with("Q[90*1000]").first_angle.mdeg(), 90_000);
        assert_eq!(with("Q360000").first_angle.mdeg(), 0);
        assert_eq!(with("Q#1").first_angle.mdeg(), 0);
        for (words, number) in [
            ("Q360001", 4025),
            ("Q-1", 4025),
            ("Q120.", 4023),
            ("Q1 Q2", 4013),
        ] {
            let refused = alarm(control, &format!("{text} {words}"));
            assert_eq!(
                (refused.number(), refused.word),
                (number, Some(b'Q')),
                "{control:?} {words}"
            );
        }
    }
}

#[test]
fn words_that_a_haas_writes_with_another_letter() {
    let same = |haas, a| {
        assert_eq!(
            kinds(Control::Haas, haas),
            kinds(Control::Gsk988, a),
            "{haas}"
        );
    };
    same("G4 P1.5", "G4 X1.5");
    same("G4 P1500", "G4 P1500");
    same(
        "G0 X60 Z2;G90 X50 Z-40 I-3 F.2;X45",
        "G99;G0 X60 Z2;G90 X50 Z-40 R-3 F.2;X45",
    );
    same(
        "G0 X60 Z2;G94 X20 Z-5 K-3 F.1",
        "G99;G0 X60 Z2;G94 X20 Z-5 R-3 F.1",
    );
    same("G0 X60;G91 G28 X0 Z0;G0 X5", "G0 X60;G28 U0 W0;G0 X5");
    // G28 without an axis is X and Z; words beside it are another matter.
    same("G0 X60;G28;G0 X5", "G0 X60;G28 U0 W0;G0 X5");
    same("G0 X60;N5 G28 M9;G0 X5", "G0 X60;G28 U0 W0 M9;G0 X5");
    same("G0 X60;G28 U0;G0 X5", "G0 X60;G28 U0;G0 X5");
    assert_eq!(alarm(Control::FanucA, "G28").number(), 4031);
}

#[test]
fn corners_without_a_comma_have_a_direction() {
    let path = "M3 S500;G0 X20 Z2;G1 Z-20 {};X40 F.1";
    let text = |word: &str| path.replace("{}", &format!("{word} F.1"));
    for (own, comma) in [("C2.", ",C2."), ("I2.", ",C2."), ("R3.", ",R3.")] {
        for control in [Control::FanucA, Control::FanucB, Control::Haas] {
            assert_eq!(
                kinds(control, &text(own)),
                kinds(Control::FanucA, &text(comma)),
                "{own}"
            );
        }
    }
    for wrong in ["C-2.", "R-3."] {
        assert_eq!(alarm(Control::Haas, &text(wrong)).number(), 55, "{wrong}");
    }
    // A GSK has L and D.
    let gsk = |params: &Params, word: &str| {
        let (events, alarm) = read_on(params, Control::Gsk980td, &format!("G99;{}", text(word)));
        assert_eq!(alarm, None, "{word}");
        crate::path::tests::moves_of(&events)
    };
    let short = machine(&[]);
    assert_eq!(gsk(&short, "D3."), gsk(&short, ",R3."));
    let legs = machine(&[("181.0", 1)]);
    assert_eq!(gsk(&legs, "L2."), gsk(&legs, ",C2."));
    assert!(
        gsk(&short, "L2.").contains("F20,-18.585786 F22.82842"),
        "{}",
        gsk(&short, "L2.")
    );
}

#[test]
fn c_beside_x_or_z_is_the_axis_where_the_spindle_stands() {
    for control in [Control::FanucA, Control::Haas] {
        let same = |c: &str, h: &str| {
            let [c, h] = [c, h].map(|words| format!("G98;G0 X50 Z-5;{words} F100;X38"));
            assert_eq!(kinds(control, &c), kinds(control, &h), "{control:?} {c}");
        };
        same("G1 X40 C30", "G1 X40 H30");
        same("M3 S500;M5;G1 Z-8 C-30", "M3 S500;M5;G1 Z-8 H-30");
        same("M3 S500;M19;G1 X40 C1", "M3 S500;M19;G1 X40 H1");
        same("M3 S500;M19;G1 X40 Z-5 C1", "M3 S500;M19;G1 X40 C1");
        // A chamfer where the spindle turns, from this block on too, and until it has stopped.
        let cut = |words: &str| format!("G98;G0 X50 Z2;{words};X60");
        for words in ["M3 S500;G1 Z-5 {} F100", "M3 S500;G1 Z-5 {} F100 M5"] {
            assert_eq!(
                kinds(control, &cut(&words.replace("{}", "C1."))),
                kinds(control, &cut(&words.replace("{}", ",C1."))),
                "{words}"
            );
        }
        assert_eq!(
            kinds(control, &cut("S500;G1 Z-5 C1. M4 F100")),
            kinds(control, &cut("S500;G1 Z-5 ,C1. M4 F100"))
        );
    }
}

#[test]
fn a_contour_has_no_c() {
    let rough = |word: &str| {
        format!("G98;G0 X50 Z2;G71 U2 R1;G71 P1 Q2 U0 W0 F100;N1 G0 X30;G1 Z-10 {word};N2 X50")
    };
    for (control, wrong) in [
        (Control::Gsk980td, "C2"),
        (Control::Gsk980td, "H2"),
        (Control::Gsk988, "C[1+1]"),
        (Control::FanucA, "H2."),
        (Control::FanucA, "X30. C2."),
    ] {
        let alarm = alarm(control, &rough(wrong));
        assert_eq!(alarm.number(), 66, "{control:?} {wrong}");
        let letter = wrong
            .split(';')
            .next_back()
            .and_then(|text| text.bytes().find(|byte| b"CH".contains(byte)));
        assert_eq!(alarm.word, letter, "{wrong}");
    }
    // A chamfer of a contour is one with the spindle at rest, too.
    assert_eq!(
        kinds(Control::FanucA, &rough("C2.")),
        kinds(Control::FanucA, &rough(",C2."))
    );
}

#[test]
fn a_limit_holds_under_g97_where_the_control_says_so() {
    let text = "G50 S800;G97 M3 S1000;G50 S500";
    let speeds = |control| {
        let (events, _) = read(control, text);
        let speed = |event: &Event| match event {
            Event::Call(call) => match call.kind {
                CallKind::Spindle(call) => Some(call.rpm.get()),
                _ => None,
            },
            Event::Warning(_) => None,
        };
        events.iter().filter_map(speed).collect::<Vec<_>>()
    };
    assert_eq!(speeds(Control::Gsk980td), [1000]);
    assert_eq!(speeds(Control::FanucA), [800, 500]);
    let warned = read(Control::Haas, text).0;
    let warned = warned
        .iter()
        .any(|event| matches!(event, Event::Warning(alarm) if alarm.number() == 4901));
    assert!(warned);
    // It is told what to do here, and not at G50.
    let limited = read(Control::FanucA, "G50 S1500;G97 S2500 M3").0;
    let told = limited.iter().find_map(|event| match event {
        Event::Warning(alarm) => super::remedies::help(alarm, leadscrew_core::alarm::Lang::En),
        Event::Call(_) => None,
    });
    assert!(told.is_some_and(|told| told.contains("higher G50 S")));
}

#[test]
fn a_comment_names_the_control() {
    let control = |text: &str| named(text.as_bytes());
    assert_eq!(
        control("(DIALECT FANUC-B)"),
        Named::Control(Control::FanucB)
    );
    assert_eq!(
        control("O1 ( dialect  haas )"),
        Named::Control(Control::Haas)
    );
    assert_eq!(control("(A DIALECT OF ITS OWN)"), Named::Nothing);
    assert_eq!(control("(DIALECTS)"), Named::Nothing);
    assert_eq!(
        control("(DIALECT MAZAK)"),
        Named::Unknown { from: 9, to: 14 }
    );
    for control in Control::ALL {
        assert_eq!(Control::of_name(control.name()), Some(control));
    }
}

#[test]
fn a_pattern_counts_its_passes_with_a_point_too() {
    let text = |passes: &str| {
        format!(
            "M3 S500;G0 X60 Z5;G73 U4. W4. R{passes};G73 P1 Q2 U.4 W.2 F.3;N1 G0 X20 Z1;N2 G1 Z-9;G70 P1 Q2"
        )
    };
    let control = Control::FanucA;
    assert_eq!(kinds(control, &text("3.")), kinds(control, &text("3")));
    assert_eq!(alarm(control, &text("2.5")).number(), 4023);
    assert_eq!(alarm(control, &text("0.")).number(), 4025);
}
