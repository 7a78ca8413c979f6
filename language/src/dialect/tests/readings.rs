//! Words that look alike and mean something else on another control.

use super::*;

#[test]
fn i_in_a_thread_is_turns_per_inch_on_a_gsk_alone() {
    let threads = [
        (Control::FanucA, "G92 X48. Z-60. F2.;X47. I1.", 920),
        (Control::FanucA, "G92 X48. Z-60. I12.", 920),
        (Control::FanucA, "G92 X48. Z-60. F2. I-1.", 920),
        (Control::FanucA, "G32 Z-60. I12.", 320),
        (Control::FanucA, "G34 Z-60. I12. K.1", 340),
        (
            Control::FanucA,
            "G76 P010060 Q100 R.05;G76 X48. Z-60. P1200 Q400 I12.",
            760,
        ),
        (Control::FanucB, "G78 X48. Z-60. F2.;X47. I1.", 780),
        (Control::FanucB, "G33 Z-60. I12.", 330),
        (Control::FanucC, "G21 X48. Z-60. F2.;X47. I1.", 210),
        (Control::FanucC, "G33 Z-60. I12.", 330),
        (
            Control::FanucC,
            "G78 P010060 Q100 R.05;G78 X48. Z-60. P1200 Q400 I12.",
            780,
        ),
        (Control::Haas, "G32 Z-60. I12.", 320),
        (Control::Haas, "G76 X48. Z-60. P1.2 Q.4 I12.", 760),
    ];
    for (control, thread, code) in threads {
        let refused = alarm(control, &format!("M3 S300;G0 X50. Z5.;{thread}"));
        assert_eq!(
            (refused.number(), refused.word, refused.args[0]),
            (4091, Some(b'I'), Arg::GCode(code)),
            "{thread}"
        );
    }
    // A word without a value is not there, and a GSK has the turns.
    let thread = "M3 S300;G0 X50. Z5.;G92 X48. Z-60. ";
    same(
        Control::FanucA,
        &format!("{thread}F2. I#0"),
        &format!("{thread}F2."),
    );
    assert_eq!(
        kinds(Control::Gsk988, &format!("{thread}I12.7")),
        kinds(Control::Gsk988, &format!("{thread}F2."))
    );
}

#[test]
fn an_old_fanuc_writes_its_tapers_with_i_and_k() {
    let same = |own: &str, a: &str| same(Control::FanucA, own, a);
    same(
        "G0 X60 Z2;G90 X50 Z-40 I-3 F.2;X45 I-4.",
        "G0 X60 Z2;G90 X50 Z-40 R-3 F.2;X45 R-4.",
    );
    same(
        "G0 X60 Z2;G94 X20 Z-5 K-3 F.1",
        "G0 X60 Z2;G94 X20 Z-5 R-3 F.1",
    );
    for (control, text) in [
        (Control::FanucA, "G0 X60 Z2;G90 X50 Z-40 K-3 F.2"),
        (Control::FanucA, "G0 X60 Z2;G94 X20 Z-5 I-3 F.2"),
        (Control::FanucB, "G0 X60 Z2;G77 X50 Z-40 I-3 F.2"),
        (Control::FanucC, "G0 X60 Z2;G20 X50 Z-40 I-3 F.2"),
    ] {
        assert_eq!(alarm(control, text).number(), 4028, "{text}");
    }
}

#[test]
fn s_beside_the_coordinates_of_a_fanuc_is_the_limit() {
    for control in [Control::FanucA, Control::Haas] {
        assert_eq!(
            kinds(
                control,
                "G50 X10. Z200. S1300 T0100;G96 S180 M3;G0 X10. Z1.;X9."
            ),
            kinds(
                control,
                "T0100 G50 X10. Z200.;G50 S1300;G96 S180 M3;G0 X10. Z1.;X9."
            ),
        );
    }
    let warned = |control, text: &str| {
        let told = |event: &Event| match event {
            Event::Warning(alarm) => Some((alarm.number(), alarm.word)),
            Event::Call(_) => None,
        };
        let (events, refused) = read(control, text);
        assert_eq!(refused, None, "{text}");
        events.iter().filter_map(told).collect::<Vec<_>>()
    };
    // On a GSK it is an ordinary S.
    let told = [(4912, Some(b'S'))];
    for control in [Control::Gsk980td, Control::Gsk988] {
        assert_eq!(warned(control, "G50 X10. Z200. S1300"), told);
        assert_eq!(warned(control, "G50 X10. Z200. S1300 M3"), []);
        assert_eq!(warned(control, "G50 S1300"), []);
    }
    assert_eq!(warned(Control::FanucA, "G50 X10. Z200. S1300"), []);
}

#[test]
fn r_of_a_haas_tap_is_a_coordinate() {
    let same = |haas: &str, gsk: &str| {
        assert_eq!(
            kinds(Control::Haas, haas),
            kinds(Control::Gsk988, &format!("G99;{gsk}")),
            "{haas}"
        );
    };
    same(
        "M3 S300;G0 X0 Z1.;G84 Z-0.75 R0.2 F0.05;G80",
        "M3 S300;G0 X0 Z1.;G84 Z-0.75 R-0.8 F0.05;G80",
    );
    // In a later block, in inches, and in a work offset.
    same(
        "G20 M3 S300;G0 X0 Z1.;G84 Z-0.75 R0.2 F0.05;X1. R0.5;G80",
        "G20 M3 S300;G0 X0 Z1.;G84 Z-0.75 R-0.8 F0.05;X1. R-.5;G80",
    );
    same(
        "G50 X40 Z7.;M3 S300;G0 X0 Z1.;G84 Z-0.75 R#0 F0.05;G80",
        "G50 X40 Z7.;M3 S300;G0 X0 Z1.;G84 Z-0.75 F0.05;G80",
    );
    same(
        "G50 X40 Z7.;#1=.2;M3 S300;G0 X0 Z1.;G84 Z-0.75 R#1 F0.05;G80",
        "G50 X40 Z7.;M3 S300;G0 X0 Z1.;G84 Z-0.75 R-.8 F0.05;G80",
    );
    // Across X it is a diameter.
    same(
        "G17 M3 S300;G0 X50. Z0;G84 X20. R44. F0.5;G80",
        "G17 M3 S300;G0 X50. Z0;G84 X20. R-3. F0.5;G80",
    );
}

#[test]
fn the_help_for_a_hole_has_the_r_of_its_control() {
    for (control, number) in [(Control::Haas, 4092), (Control::FanucA, 4085)] {
        assert_eq!(
            alarm(control, "G99 G0 X0 Z1.;G83 Z-5. R9. F.1").number(),
            number
        );
    }
}

#[test]
fn r1_of_a_haas_says_that_there_are_pockets() {
    let text = |own: &str, first: &str| {
        format!(
            "M3 S500;G0 X40 Z2;{own};N1 G0 X20{first};G1 Z-10 F.1;X16 Z-15;X30 Z-20;N2 X40;G0 Z5"
        )
    };
    let haas = |own: &str, first: &str| kinds(Control::Haas, &text(own, first));
    let by_words = haas("G71 P1 Q2 U.4 W0 D2. F.2", " W0");
    assert_eq!(haas("G71 P1 Q2 U.4 W0 D2. R1 F.2", ""), by_words);
    assert_eq!(haas("G71 P1 Q2 U.4 W0 D2. R1. F.2", ""), by_words);
    // Without D the depth is the parameter's, with R1 too.
    assert_eq!(
        haas("G71 P1 Q2 U.4 W0 R1 F.2", ""),
        haas("G71 P1 Q2 U.4 W0 F.2", " W0")
    );
    for (control, own, number) in [
        (Control::Haas, "G71 P1 Q2 U.4 W0 D2. F.2", 64),
        (Control::Haas, "G71 P1 Q2 U.4 W0 D2. R0 F.2", 64),
        (Control::Haas, "G71 P1 Q2 U.4 W0 D2. R2 F.2", 4025),
        (Control::Haas, "G73 P1 Q2 U.4 W0 I1 K1 D2 R1 F.2", 4028),
        (Control::FanucA, "G71 P1 Q2 U.4 W0 D2. R1 F.2", 4028),
        (Control::FanucA, "G71 P1 Q2 U.4 W0 R1 F.2", 4028),
    ] {
        assert_eq!(alarm(control, &text(own, "")).number(), number, "{own}");
    }
}

#[test]
fn a_dwell_of_a_haas_with_a_point_is_seconds_in_every_cycle() {
    let hole = |own: &str| format!("M3 S300;G0 X0 Z2. F.1;{own};G80");
    for (seconds, milliseconds) in [
        ("G82 Z-30. P1.", "G82 Z-30. P1000"),
        ("G82 Z-30.;X1. P.25", "G82 Z-30.;X1. P250"),
        ("G83 Z-30. Q9. P1.5", "G83 Z-30. Q9. P1500"),
        ("G89 Z-30. P1.", "G89 Z-30. P1000"),
        ("G84 Z-30. F1. P1.5", "G84 Z-30. F1. P1500"),
        ("G84 Z-30. F1.;X1. P.5", "G84 Z-30. F1.;X1. P500"),
    ] {
        assert_eq!(
            kinds(Control::Haas, &hole(seconds)),
            kinds(Control::Haas, &hole(milliseconds)),
            "{seconds}"
        );
    }
    let text = hole("G83 Z-30. P1.");
    assert_eq!(alarm(Control::FanucA, &text).number(), 4023);
}

#[test]
fn codes_of_other_controls_are_refused_by_name() {
    for control in Control::ALL {
        for (text, number, code) in [
            ("G27 X0 Z0", 4093, 270),
            ("G29", 4093, 290),
            ("G35", 4094, 350),
            ("G36", 4094, 360),
            ("G107 C10", 4095, 1070),
            ("G7.1 C10", 4095, 71),
            ("G112", 4095, 1120),
            ("G09 G1 X5", 4097, 90),
            ("G26", 4097, 260),
            ("G184", 4097, 1840),
            ("G154 P3", 4097, 1540),
        ] {
            let refused = alarm(control, text);
            // On a GSK it sets tools.
            let number = if text == "G36" && control.is_gsk() {
                4864
            } else {
                number
            };
            assert_eq!(
                (refused.number(), refused.args[0]),
                (number, Arg::GCode(code)),
                "{control:?} {text}"
            );
        }
    }
}

#[test]
fn what_ends_nothing_is_passed_over() {
    let plain = "G0 X5.;G1 Z-5. F.2";
    for cancels in ["G69", "G25 G23 G49", "G13.1", "G113", "G40 G69 G80"] {
        for control in [Control::FanucA, Control::FanucB, Control::Haas] {
            let text = format!("{cancels};{plain}");
            assert_eq!(kinds(control, &text), kinds(control, plain), "{text}");
        }
        assert_ne!(read(Control::Gsk980td, cancels).1, None, "{cancels}");
    }
    assert_eq!(
        kinds(Control::FanucA, &format!("G11;{plain}")),
        kinds(Control::FanucA, plain)
    );
    for control in [Control::Gsk988, Control::Haas] {
        assert_eq!(alarm(control, "G11").number(), 4018, "{control:?}");
    }
    let haas = |text: &str| kinds(Control::Haas, &format!("{text};{plain}"));
    assert_eq!(haas("G103"), haas("M23"));
    assert_eq!(haas("G103 P1"), haas("G103"));
    assert_eq!(haas("G103 P1"), kinds(Control::Haas, plain));
    assert_eq!(alarm(Control::FanucA, "G103 P1").number(), 4018);
    let others = |control: &Control| !control.is_gsk();
    for control in Control::ALL.into_iter().filter(others) {
        let home = |word: &str| kinds(control, &format!("G0 X9.;G28 U0. {word} W0.;G30 U0 {word}"));
        assert_eq!(home("V0."), home(""), "{control:?}");
        assert_eq!(alarm(control, "G28 U0 V1. W0").number(), 4012);
        assert_eq!(alarm(control, "G0 X1. V0").number(), 4012);
    }
}

#[test]
fn a_length_without_a_point_that_cannot_be_is_told_in_increments() {
    use leadscrew_core::units::Length;
    let told = |control, cycle: &str| {
        let alarm = alarm(control, &format!("M3 S300 F.1;G0 X42. Z5.;{cycle}"));
        let lengths = [0, 1].map(|index| match alarm.args[index] {
            Arg::Length(length) => length,
            _ => Length::ZERO,
        });
        (alarm.number(), alarm.word, lengths)
    };
    let of = |nm: i64| Length::from_nm(nm);
    for (cycle, millimetres, line) in [
        ("G75 R500;G75 X38. Z-20. P2000 Q2000", 500, 3),
        ("G74 R1000;G74 Z-20. Q2000", 1000, 3),
        (
            "G76 P010060 Q100 R100;G76 X37.5 Z-20. P1227 Q400 F2.",
            100,
            3,
        ),
    ] {
        let lengths = [of(millimetres * 1_000_000), of(millimetres * 1000)];
        assert_eq!(
            told(Control::FanucA, cycle),
            (4098, Some(b'R'), lengths),
            "{cycle}"
        );
        let at = alarm(Control::FanucA, &format!("M3 S300 F.1;G0 X42. Z5.;{cycle}"));
        assert_eq!(at.span.line, line, "{cycle}");
    }
    // With a point it is what it is, and so it is on a GSK 980TD.
    let cycle = "G75 R500.;G75 X38. Z-20. P2000 Q2000";
    assert_eq!(told(Control::FanucA, cycle).0, 4025);
    let cycle = cycle.replace("500.", "500");
    assert_eq!(told(Control::Gsk980td, &cycle).0, 4025);
}

#[test]
fn a_gsk_980td_has_registers() {
    let text = "G65 H01 P#200 Q5000;G65 H02 P#231 Q#200 R1000;G65 H01 P#515 Q#231;G0 X#515";
    assert_eq!(
        kinds(Control::Gsk980td, text),
        kinds(Control::Gsk980td, "G0 X6.")
    );
    for (control, number) in [(Control::Gsk980td, 232), (Control::FanucA, 200)] {
        assert_eq!(alarm(control, &format!("#{number}=1")).number(), 115);
        assert_eq!(alarm(control, &format!("G0 X#{number}")).number(), 115);
    }
}
