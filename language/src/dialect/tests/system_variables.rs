//! System variables: what each control has in force, and what is known on the machine alone.

use super::*;
use crate::value::Value;

/// What `#number` is behind the blocks of `before`.
#[track_caller]
fn value(control: Control, before: &str, number: u32) -> Value {
    let rules = Rules {
        control,
        ..Rules::default()
    };
    let text = format!("{before}\n#500=#{number}\nM30\n").replace(';', "\n");
    let (params, options, kept) = (machine(&[]), Options::default(), Kept::default());
    let mut reader = Reader::new(text.as_bytes(), &params, options, kept, rules);
    while !reader.is_over() {
        if let Err(trouble) = reader.step(&mut |_| {}) {
            panic!("{control:?} {text}: {trouble:?}");
        }
    }
    let kept = reader.variables().kept().values().next();
    kept.map_or(Value::Null, |(_, value)| value)
}

#[track_caller]
fn is(control: Control, before: &str, number: u32, code: f64) {
    let found = value(control, before, number);
    assert_eq!(found, Value::Number(code), "{control:?} {before} #{number}");
}

#[test]
fn a_modal_code_is_that_which_the_control_writes() {
    use Control::{FanucA, FanucB, FanucC, Gsk980td, Haas};
    for control in Control::ALL {
        is(control, "", 4001, 0.0);
        is(control, "G1", 4001, 1.0);
        is(control, "", 4007, 40.0);
        is(control, "", 4015, 64.0);
        is(control, "G61", 4015, 61.0);
        is(control, "G61;G64", 4015, 64.0);
    }
    for control in Control::ALL.into_iter().filter(|control| *control != Haas) {
        is(control, "", 4002, 97.0);
        is(control, "G96 S100 M3", 4002, 96.0);
        is(control, "", 4010, 80.0);
        is(control, "", 4012, 67.0);
        is(control, "G55", 4014, 55.0);
        is(control, "G17", 4016, 17.0);
    }
    is(FanucA, "G32", 4001, 32.0);
    is(FanucB, "G33", 4001, 33.0);
    is(FanucB, "G77", 4001, 77.0);
    is(FanucC, "G21", 4001, 21.0);
    is(FanucC, "G70", 4006, 70.0);
    is(FanucC, "", 4006, 71.0);
    is(Haas, "G20", 4006, 20.0);
    is(Gsk980td, "", 4005, 98.0);
    is(FanucA, "", 4005, 99.0);
    is(FanucB, "G94", 4005, 94.0);
    is(FanucC, "", 4005, 95.0);
    for control in [FanucB, FanucC] {
        is(control, "", 4003, 90.0);
        is(control, "G91", 4003, 91.0);
        is(control, "G91;G90", 4003, 90.0);
        is(control, "", 4011, 98.0);
        is(control, "G99", 4011, 99.0);
    }
    for control in [FanucA, FanucB] {
        is(control, "", 4004, 69.0);
        is(control, "", 4008, 25.0);
        is(control, "", 4009, 23.0);
        is(control, "", 4021, 13.1);
    }
    is(FanucA, "M3 S300;G0 Z5.;G83 Z-5. R-2. F.1", 4010, 83.0);
    is(FanucA, "M3 S300;G0 Z5.;G83 Z-5. R-2. F.1;G80", 4010, 80.0);
    is(FanucA, "M3 S300;G0 Z5.;G84 Z-5. R-2. F1.", 4010, 84.0);
}

#[test]
fn a_modal_call_is_told_while_it_is_in_force() {
    let text = "G66 P9;G0 X#4012;G67;G0 X#4012;M30;O9;M99";
    assert_eq!(
        kinds(Control::FanucA, text),
        kinds(Control::FanucA, "G0 X66;X67;M30")
    );
}

#[test]
fn what_was_in_force_is_put_back() {
    for control in Control::ALL {
        for (before, other, number, cut) in [
            ("G1 F1.", "G0", 4001, "X5."),
            ("G98 F100.", "G99 F.1", 4005, "G1 X5. F100."),
            ("G20", "G21", 4006, "G0 X5."),
        ] {
            let is_other = control.has_system_b() && number != 4001;
            if is_other || control == Control::Haas && number == 4005 {
                continue;
            }
            let text = format!("{before};#1=#{number};{other};G#1;{cut}");
            let plain = format!("{before};{other};{before};{cut}");
            assert_eq!(kinds(control, &text), kinds(control, &plain), "{text}");
        }
    }
    // Codes that end nothing may be put back, too.
    let text = "#1=#4004;#2=#4021;#3=#4009;G#1;G#2;G#3;G0 X5.";
    assert_eq!(
        kinds(Control::FanucA, text),
        kinds(Control::FanucA, "G0 X5.")
    );
}

#[test]
fn the_latest_m_code_is_told() {
    for control in Control::ALL {
        assert_eq!(value(control, "G0 X5.", 4113), Value::Null);
        is(control, "M3 S300;M8;G0 X5.", 4113, 8.0);
        is(control, "M8 M3 S300", 4113, 3.0);
        is(control, "M3 M8 S300", 4113, 8.0);
        is(control, "M8;N5 M#0;G0 X5.", 4113, 8.0);
    }
    // Also one that the machine does not see.
    is(Control::Haas, "M8;M24;G0 X5.", 4113, 24.0);
    is(Control::Haas, "M24;M8", 4113, 8.0);
    is(Control::Haas, "M8 M23", 4113, 23.0);
    is(Control::Haas, "M23 M8", 4113, 8.0);
    is(Control::Haas, "M24;G0 X5.;#2=1", 4113, 24.0);
    // That of a contour that is read for a roughing cycle has not been carried out.
    let cycle =
        "M3 S300;F100.;G0 X40. Z2.;G71 U2. R1.;G71 P1 Q2 U0 W0;N1 G0 X20.;G1 Z-9. M8;N2 X40.";
    is(Control::Gsk988, cycle, 4113, 3.0);
    let finish = format!("{cycle};G70 P1 Q2");
    is(Control::Gsk988, &finish, 4113, 8.0);
}

#[test]
fn a_group_that_the_control_does_not_have_is_refused_by_name() {
    let gsk = [4003, 4004, 4008, 4009, 4011, 4013, 4017, 4020, 4021];
    for (control, numbers) in [
        (Control::Gsk980td, &gsk[..]),
        (Control::Gsk988, &gsk),
        (Control::FanucA, &[4003, 4011, 4013, 4017, 4018, 4019, 4020]),
        (
            Control::Haas,
            &[
                4002, 4003, 4005, 4008, 4009, 4010, 4011, 4012, 4013, 4014, 4016, 4111,
            ],
        ),
        (Control::FanucB, &[4013, 4020, 4111]),
    ] {
        for number in numbers {
            let refused = alarm(control, &format!("#1=#{number}"));
            assert_eq!(refused.number(), 4862, "{control:?} {number}");
            assert_eq!(refused.args[0], Arg::Int(*number));
            assert_eq!((refused.span.column, refused.span.end), (4, 9));
            let written = alarm(control, &format!("#{number}=1"));
            assert_eq!(written.number(), 116, "{control:?} {number}");
        }
    }
}

#[test]
fn what_only_the_machine_knows_is_refused_by_name() {
    for control in Control::ALL {
        for (numbers, code) in [
            (&[3001, 3002, 3011, 3012][..], 4858),
            (&[3901, 3902], 4859),
            (&[1000, 1015, 1032, 1100, 1135], 4861),
            (&[999_999, 1136, 3005, 3903, 4022, 4112], 115),
        ] {
            for number in numbers {
                for text in [format!("#1=#{number}"), format!("#{number}=0")] {
                    let refused = alarm(control, &text);
                    assert_eq!(refused.number(), code, "{text}");
                    assert_eq!(refused.args[0], Arg::Int(*number), "{text}");
                    assert_eq!(refused.span.line, 1);
                }
            }
        }
    }
}

#[test]
fn nothing_is_taken_from_the_operator() {
    for control in Control::ALL {
        for number in [3003, 3004] {
            is(control, "", number, 0.0);
            is(control, &format!("#{number}=0"), number, 0.0);
            is(control, &format!("#{number}=#0"), number, 0.0);
            for held in [1, 2, 4, 7] {
                let refused = alarm(control, &format!("#{number}={held}"));
                assert_eq!(refused.number(), 4860);
                assert_eq!(refused.args[0], Arg::Int(number.into()));
                assert_eq!((refused.span.column, refused.span.end), (1, 6));
            }
        }
    }
}
