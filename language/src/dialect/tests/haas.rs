//! Programs of a Haas lathe: what they leave out, and what they switch.

use super::*;

fn haas(text: &str) -> Vec<String> {
    kinds(Control::Haas, text)
}

/// The run-outs of the threads, as text.
fn run_outs(control: Control, text: &str) -> Vec<bool> {
    let (events, alarm) = read(control, text);
    assert_eq!(alarm, None, "{text}");
    let run_out = |event: &Event| match event {
        Event::Call(call) => match &call.kind {
            CallKind::Thread(thread) => Some(thread.run_out.is_some()),
            _ => None,
        },
        Event::Warning(_) => None,
    };
    events.iter().filter_map(run_out).collect()
}

#[test]
fn a_tap_with_a_spindle_that_stands_is_rigid_by_itself() {
    let begins = &haas("M29 S500;G84 Z-1. F1.;G80")[0];
    let rigid = haas("G0 X0 Z5.;M29 S500;G84 Z-12. R2. F1.;G80");
    let cuts = |calls: &[String]| {
        let begins = calls.iter().position(|call| call == begins);
        calls[begins.expect("rigid mode")..].to_vec()
    };
    for text in [
        "G97 S500;G0 X0 Z5.;G84 Z-12. R2. F1.;G80",
        "G0 X0 Z5.;G84 Z-12. R2. F1. S500;G80",
        "M3 S500;M5;G0 X0 Z5.;G84 Z-12. R2. F1.;G80",
    ] {
        assert_eq!(cuts(&haas(text)), cuts(&rigid), "{text}");
    }
    // Where the parameter says so, S of the block does it.
    let by_code = machine(&[("5200.0", 1)]);
    let (events, alarm) = read_on(
        &by_code,
        Control::Haas,
        "S500;G0 X0 Z5.;G84 Z-12. R2. F1.;G80",
    );
    assert_eq!(alarm, None);
    assert_eq!(
        events.len(),
        read_on(
            &by_code,
            Control::Haas,
            "S500;G0 X0 Z5.;G84 Z-12. R2. F1. S500;G80"
        )
        .0
        .len()
    );
    // The next hole goes on in it, and after G80 it begins anew.
    let holes = "G84 Z-12. R2. F1.;X1.;G80";
    assert_eq!(
        haas(&format!("S500;G0 X0 Z5.;{holes};S300;{holes}")),
        haas(&format!(
            "S500;G0 X0 Z5.;M29 S500;{holes};S300;M29 S300;{holes}"
        ))
    );
    // Without any speed, with a spindle that turns, and on other controls, it is as it was.
    let tap = "G84 Z-12. R2. F1.;G80";
    for text in [
        format!("G0 X0 Z5.;{tap}"),
        format!("M3 S500;G0 X0 Z5.;{tap}"),
        "G0 X0 Z5.;G84 Z-12. R2. F1. M3 S500".to_owned(),
    ] {
        assert!(!haas(&text).contains(begins), "{text}");
    }
    let fanuc = kinds(Control::FanucA, "S500;G0 X0 Z5.;G84 Z-12. R-3. F1.;G80");
    assert!(!fanuc.contains(begins));
}

#[test]
fn m24_takes_the_run_out_of_threads_until_m23() {
    let start = "M3 S300;G0 X22. Z5.";
    let one = "G76 X17.546 Z-25. K1.227 D.4 F2.";
    let two = "G76 P010060 Q50 R.01;G76 X17.546 Z-25. P1227 Q400 F2.";
    let each = "G92 X20. Z-25. F2.";
    let text = format!("{start};{one};{each};M24;G0;{one};{each};X19.5;M23;G0;{one};{each}");
    assert_eq!(
        run_outs(Control::Haas, &text),
        [true, true, false, false, false, true, true]
    );
    // P(r) of the two-line form says it for itself.
    let said = format!("{start};M24;{two};G76 P010560 Q50 R.01;G76 X17.546 Z-25. P1227 Q400 F2.");
    assert_eq!(run_outs(Control::Haas, &said), [false, true]);
    // In a plain block, with others beside it, and nothing else comes of it.
    let plain = "G0 X5.;G1 Z-5. F.2";
    for word in ["M24", "M23", "M24 G0 X5."] {
        assert_eq!(haas(&format!("{word};{plain}")).last(), haas(plain).last());
    }
    assert_eq!(haas(&format!("M24;{plain}")), haas(plain));
}

#[test]
fn smoothness_is_passed_over_and_a_tolerance_is_not() {
    let plain = "G0 X5.;G1 Z-5. F.2";
    for word in ["G187", "G187 P1", "G187 P3.", "G103 P1;G187 P2;G103"] {
        assert_eq!(haas(&format!("{word};{plain}")), haas(plain), "{word}");
    }
    for control in [Control::Haas, Control::FanucA] {
        let refused = alarm(control, "G187 P1 E.05");
        assert_eq!(
            (refused.number(), refused.args[0]),
            (4097, Arg::GCode(1870))
        );
    }
    assert_eq!(alarm(Control::FanucA, "G187 P1").number(), 4097);
}

#[test]
fn what_the_machine_does_not_have_is_refused_by_name() {
    for (text, number, code) in [
        ("G14", 4864, 140),
        ("G15", 4864, 150),
        ("G31 Z-5. F.1", 4864, 310),
        ("G05 R90.", 4864, 50),
        ("G100 X0", 4864, 1000),
        ("G101 X0", 4864, 1010),
        ("G105 X-1.", 4864, 1050),
        ("G195", 4864, 1950),
        ("G198", 4864, 1980),
        ("G199", 4864, 1990),
        ("G87 Z-5. R2. F.1", 4097, 870),
        ("G51", 4097, 510),
        ("G52 X1.", 4097, 520),
        ("G54.1 P1", 4097, 541),
        ("G86 Z-5. R2. F.1", 4097, 860),
        ("G110", 4097, 1100),
        ("G129", 4097, 1290),
    ] {
        let refused = alarm(Control::Haas, text);
        assert_eq!(
            (refused.number(), refused.args[0]),
            (number, Arg::GCode(code)),
            "{text}"
        );
    }
    assert_eq!(alarm(Control::FanucA, "G05").number(), 4097);
    assert_eq!(alarm(Control::FanucA, "G199").number(), 4018);
    for text in ["DPRNT[X#1[42]]", "POPEN", "PCLOS", "N5 BPRNT[X#1[4]]"] {
        for control in [Control::Haas, Control::FanucA, Control::FanucB] {
            assert_eq!(alarm(control, text).number(), 4865, "{text}");
        }
    }
}

#[test]
fn i_and_k_of_roughing_are_lengths_off_the_last_pass() {
    let contour = "N1 G0 X20.;G1 Z-15.;N2 X48.";
    let start = "M3 S300;F.2;G0 X50. Z2.";
    let one = |words: &str| format!("{start};G71 P1 Q2 U.4 W.1 {words};{contour}");
    let two = |words: &str| format!("{start};G71 U2. R.5;G71 P1 Q2 U.4 W.1 {words};{contour}");
    for control in [Control::Haas, Control::FanucA] {
        let plain = kinds(control, &one("D2."));
        let left = kinds(control, &one("I.5 K.2 D2."));
        assert_ne!(plain, left);
        // The last pass and the way home are the same.
        assert_eq!(plain[plain.len() - 4..], left[left.len() - 4..]);
        assert_eq!(kinds(control, &one("I0 K0 D2.")), plain);
        assert_eq!(
            kinds(control, &two("I.5 K.2")),
            kinds(control, &format!("G0;{}", two("K.2 I.5")))
        );
        // A sign that leads into the part would cut below the finished contour, also where that ends above the start.
        for (words, letter) in [("I-.5 K.2", b'I'), ("I.5 K-.2", b'K')] {
            for text in [
                one(&format!("{words} D2.")),
                two(words),
                one(&format!("{words} D2.")).replace("X48.", "X54."),
            ] {
                let alarm = alarm(control, &text);
                assert_eq!((alarm.number(), alarm.word), (4868, Some(letter)), "{text}");
            }
        }
        // A first block at a slant is a wall that K would move, at rapid and at feed.
        for first in ["N1 G1 X20. Z-10.", "N1 G0 X20. Z1."] {
            let text = one("I.5 K.2 D2.").replace("N1 G0 X20.", first);
            let alarm = alarm(control, &text);
            assert_eq!((alarm.number(), alarm.word), (4866, Some(b'K')), "{text}");
            kinds(control, &one("I.5 D2.").replace("N1 G0 X20.", first));
        }
        let alarm = alarm(control, &two("J1"));
        assert_eq!((alarm.number(), alarm.word), (4028, Some(b'J')));
    }
    for control in [Control::Gsk980td, Control::Gsk988] {
        for word in ["I.5", "J1", "K1"] {
            let alarm = alarm(control, &two(word));
            assert_eq!(alarm.number(), 4863, "{word}");
            assert_eq!(alarm.word, word.bytes().next());
        }
        // D is the form of old controls in each of them.
        let (found, wanted) = (one("I.5 K.2 D2."), one("D2. K.2 I.5"));
        assert_eq!(kinds(control, &found), kinds(control, &wanted));
        assert_eq!(
            alarm(control, &format!("{start};G71 U2. K1")).number(),
            4028
        );
    }
    let face = "G72 P1 Q2 U.4 W.1 D2. I.1 K.2;N1 G0 Z-6.;G1 X40.;N2 Z1.";
    haas(&format!("M3 S300;F.2;G0 X60. Z2.;{face}"));
    let pattern = alarm(
        Control::Haas,
        &format!("{start};G73 U3. W1. R3;G73 P1 Q2 U.4 W.1 I1.;{contour}"),
    );
    assert_eq!(pattern.number(), 4028);
}

/// Each typed line is a text of its own.
#[test]
fn m24_holds_for_the_next_typed_line_and_so_does_g91() {
    let params = machine(&[]);
    let after = |control, lines: &[&str]| {
        let rules = Rules {
            control,
            ..Rules::default()
        };
        let mut carried = None;
        let mut events = Vec::new();
        for line in lines {
            let (options, kept) = (Options::default(), Kept::default());
            let mut reader = Reader::new(line.as_bytes(), &params, options, kept, rules);
            if let Some(carried) = &carried {
                reader.carry(carried);
            }
            events.clear();
            while !reader.is_over() {
                reader.step(&mut |event| events.push(event)).unwrap();
            }
            carried = Some(reader.carried());
        }
        events
    };
    let thread = "M3 S300 G0 X22. Z5.\nG92 X20. Z-25. F2.\n";
    let runs_out = |lines: &[&str]| {
        let has = |event: &Event| match event {
            Event::Call(call) => match &call.kind {
                CallKind::Thread(thread) => Some(thread.run_out.is_some()),
                _ => None,
            },
            Event::Warning(_) => None,
        };
        after(Control::Haas, lines).iter().find_map(has).unwrap()
    };
    assert!(runs_out(&["G0\n", thread]));
    assert!(!runs_out(&["M24\n", thread]));
    assert!(!runs_out(&["M24\n", "G0 X30.\n", thread]));
    assert!(runs_out(&["M24\n", "M23\n", thread]));
    // Another control has no such code.
    let end = |lines: &[&str]| {
        let events = after(Control::FanucB, lines);
        events.iter().find_map(|event| match event {
            Event::Call(call) => match &call.kind {
                CallKind::Rapid(to) => Some(to.z.nm()),
                _ => None,
            },
            Event::Warning(_) => None,
        })
    };
    assert_eq!(end(&["G0 Z10.\n", "G91\n", "G0 Z-3.\n"]), Some(-3_000_000));
}

#[test]
fn p_of_m19_is_its_angle_and_no_number_of_it_counts_increments() {
    for control in [Control::Haas, Control::FanucA, Control::Gsk980td] {
        let by_r = kinds(control, "M19 R90.");
        assert!(by_r[0].contains("Orient(Angle(90000000))"), "{by_r:?}");
        assert_eq!(kinds(control, "M19 R90"), by_r, "{control:?}");
        assert_eq!(kinds(control, "M19 R-270"), by_r, "{control:?}");
    }
    assert_eq!(haas("M19 P90"), haas("M19 R90."));
    assert_eq!(alarm(Control::FanucA, "M19 P90").number(), 4028);
    assert_eq!(alarm(Control::Haas, "M19 P90 R90").number(), 4013);
}

/// X and Z of later blocks would be absolute, and U and W say what is meant.
#[test]
fn g91_of_its_own_is_refused() {
    for text in ["G91", "G91 G1 F.2", "N5 G91 G99", "G91 M8", "G91 G4 P1."] {
        let alarm = alarm(Control::Haas, &format!("G0 X42. Z2.;{text};X-1."));
        assert_eq!((alarm.number(), alarm.span.line), (4097, 2), "{text}");
        let help = crate::dialect::remedies::help(&alarm, leadscrew_core::alarm::Lang::En);
        assert!(help.is_some_and(|help| help.contains("U and W")), "{text}");
    }
    let same = |text, plain| assert_eq!(haas(text), haas(plain), "{text}");
    same("G0 X42. Z2.;G91 G1 X-2. F.2", "G0 X42. Z2.;G1 U-2. F.2");
    same("G0 X42. Z2.;G91 G28", "G0 X42. Z2.;G28 U0 W0");
    same("G0 X42. Z2.;G91 G28 X0 Z0", "G0 X42. Z2.;G28 U0 W0");
    same("G0 X42. Z2.;G28 U0 W0 G91", "G0 X42. Z2.;G28 U0 W0");
}

/// Q of a tap of a FANUC, in any block of it.
#[test]
fn pecks_of_a_tap_are_increments_on_a_fanuc() {
    let begin = "M5;G0 X0 Z5.;M29 S300";
    let tap = |text: &str| kinds(Control::FanucA, &format!("{begin};{text};G80"));
    let gsk = |text: &str| kinds(Control::Gsk988, &format!("G99;{begin};{text};G80"));
    let pecked = gsk("G84 Z-20. R-3. Q5. F1.5");
    assert_ne!(pecked, gsk("G84 Z-20. R-3. F1.5"));
    for text in [
        "G84 Z-20. R-3. Q5000 F1.5",
        "G84 Z-20. R-3. Q5. F1.5",
        "#1=5000;G84 Z-20. R-3. Q#1 F1.5",
    ] {
        assert_eq!(tap(text)[..], pecked[..], "{text}");
    }
    assert_eq!(
        tap("G84 Z-20. R-3. Q5000 F1.5;X4. Q3000"),
        gsk("G84 Z-20. R-3. Q5. F1.5;X4. Q3."),
    );
    let side = "G88 X-20. R-3. Q5000 F1.5";
    assert_eq!(tap(side), gsk(&side.replace("Q5000", "Q5.")));
}
