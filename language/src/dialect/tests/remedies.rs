//! What to write in place of a code that is refused: words for this code, on this control.

use leadscrew_core::alarm::{Code, Lang};

use super::*;
use crate::dialect::refusals::REFUSALS;
use crate::dialect::remedies::{help, helps};

#[test]
fn each_code_has_a_remedy_of_its_own_in_both_languages() {
    let codes: Vec<Code> = REFUSALS.iter().map(|row| row.code).collect();
    for control in Control::ALL {
        for (row, tenths) in REFUSALS.iter().flat_map(|row| {
            let codes = row.codes(control);
            codes.into_iter().map(move |tenths| (row, tenths))
        }) {
            let text = match tenths % 10 {
                0 => format!("G{}", tenths / 10),
                tenth => format!("G{}.{tenth}", tenths / 10),
            };
            let text = match tenths {
                1870 => format!("{text} E.05"),
                _ => text,
            };
            let refused = alarm(control, &text);
            // A row above may be for the same code on this control.
            assert!(codes.contains(&refused.code), "{control:?} {text}");
            assert!(row.code == refused.code || tenths == 360, "{text}");
            for lang in [Lang::En, Lang::Zh] {
                let told = help(&refused, lang).expect(&text);
                assert!(told.len() < 150, "{told}");
                let all = helps(refused.code, lang);
                assert!(all.iter().any(|(_, help)| *help == told), "{text}: {told}");
                // No list: no other code of this number stands in it as one that is meant.
                assert!(!told.contains("; G"), "{told}");
            }
        }
    }
}

#[test]
fn the_same_code_has_another_remedy_on_another_control() {
    let told = |control, text: &str| help(&alarm(control, text), Lang::En).unwrap();
    assert!(told(Control::Haas, "G51").starts_with("write G50 with U and W"));
    assert!(told(Control::Gsk980td, "G51").starts_with("nothing is scaled"));
    assert!(told(Control::Gsk988, "G05").starts_with("write the arc"));
    assert!(told(Control::FanucB, "G05").starts_with("leave it out"));
    assert!(!told(Control::Gsk988, "G86").contains("G85"));
    assert!(told(Control::FanucA, "G86").contains("G85"));
    assert!(told(Control::Gsk988, "G85").contains("fanuc-a, fanuc-b"));
    assert!(told(Control::Gsk980td, "G95").contains("fanuc-b, fanuc-c:"));
    assert!(told(Control::Gsk980td, "G81").contains("fanuc-b, fanuc-c, haas:"));
    assert!(told(Control::FanucA, "G103").contains("a code of haas:"));
    assert_eq!(help(&alarm(Control::Gsk980td, "G198"), Lang::En), None);
    for (text, part) in [
        ("GO X50. Z2.", "digit 0"),
        ("G0 X5O. Z2.", "digit 0"),
        ("TO101", "digit 0"),
        ("G0 X1. ROUGH", "parentheses"),
        ("O1 PART 12", "parentheses"),
    ] {
        for control in Control::ALL {
            let refused = alarm(control, text);
            assert_eq!(refused.number(), 4003, "{control:?} {text}");
            let told = help(&refused, Lang::En).expect(text);
            assert!(told.contains(part), "{control:?} {text}: {told}");
        }
    }
    assert_eq!(help(&alarm(Control::FanucA, "G0 X Z5."), Lang::En), None);
    for (text, part) in [
        ("G83 Z-12. R-3. Q5. F.1", "write Q5000:"),
        ("G74 R1.;G74 Z-9. Q.0004 F.1", "write Q0:"),
        ("G74 R1.;G74 Z-9. Q974. F.1", "write Q974:"),
        ("M3 S9;G0 X40. Z5.;G76 P010060 Q0.1 R0.05", "write Q100:"),
    ] {
        let told = told(Control::FanucA, text);
        assert!(told.starts_with(part) && !told.contains("182"), "{told}");
    }
    assert!(
        told(Control::FanucA, "G0 X40. Z5.;G75 R.5;G75 X20. P2. F.1").starts_with("write P2000:")
    );
    assert!(told(Control::Gsk980td, "#3003=1").starts_with("leave it out: a thread"));
    assert!(told(Control::Haas, "#3004=4").contains("G64"));
    assert!(told(Control::Gsk980td, "G28").contains("--dialect haas"));
    assert!(told(Control::Gsk980td, "G04").contains("milliseconds"));
    assert!(told(Control::FanucB, "G92").contains("highest speed"));
    assert!(told(Control::FanucA, "G0 X5. R3.").contains("`,R`"));
    assert!(told(Control::FanucA, "M198 P20").contains("M98"));
    for control in [Control::FanucB, Control::FanucC] {
        assert!(told(control, "G50 S2000").starts_with("write G92"));
    }
    assert!(told(Control::Haas, "M96 P20").contains("no program reads an input"));
    assert!(told(Control::FanucA, "M98 P20;M30;%;O20;M99").contains("take that `%` out"));
    let nowhere = alarm(Control::FanucA, "M98 P20;M30;%;O21;M99");
    assert_eq!((nowhere.number(), help(&nowhere, Lang::En)), (78, None));
}

#[test]
fn a_thread_in_one_block_is_told_as_the_g76_that_it_is() {
    let text = "M3 S300;G0 X22. Z5.;G76 X17.5 Z-25. K1.2 D.4 F2. P9";
    let refused = alarm(Control::Haas, text);
    assert!(!refused.args.contains(&Arg::GCode(780)), "{refused:?}");
    let without = "M3 S300;G0 X22. Z5.;G76 X17.5 Z-25. K1.2 D.4";
    let refused = alarm(Control::Haas, without);
    assert!(!refused.args.contains(&Arg::GCode(780)), "{refused:?}");
}

#[test]
fn what_a_thread_in_one_block_lacks_is_told_by_its_letter() {
    let whole = [("K1.3", b'K'), ("D.3", b'D')];
    for control in [Control::FanucA, Control::Haas] {
        for (missing, letter) in whole {
            for angle in ["", "A60"] {
                let words: String = whole
                    .map(|(word, _)| word)
                    .join(" ")
                    .replace(missing, angle);
                let text = format!("M3 S300;G0 X30. Z5.;G76 X27.4 Z-20. {words} F2.");
                let refused = alarm(control, &text);
                assert_eq!(
                    (refused.number(), refused.args[0]),
                    (317, Arg::Letter(letter)),
                    "{control:?} {text}"
                );
            }
        }
    }
    let told = |words: &str| {
        let refused = alarm(
            Control::Haas,
            &format!("M3 S300;G0 X30. Z5.;G76 X27.4 Z-20. {words} F2."),
        );
        (refused.number(), refused.word)
    };
    // P is the way of the infeed there, and not the height.
    assert_eq!(told("D.3 P2"), (317, None));
    assert_eq!(told("K1.3 P2"), (317, None));
    assert_eq!(told("K0 D.3"), (317, Some(b'K')));
    assert_eq!(told("K1.3 D0"), (317, Some(b'D')));
    assert_eq!(told("K1.3 D.3 I1000000."), (4025, Some(b'I')));
    // K beside P and Q of a GSK, and two lines of a Haas, are what they were.
    for (control, text) in [
        (
            Control::Gsk988,
            "G76 P010060 Q0.1 R0.05;G76 X27.4 Z-20 P1.3 Q0.3 K2 F2",
        ),
        (
            Control::Haas,
            "G76 P010060 Q.1 R.05;G76 X27.4 Z-20. P1.3 Q.3 F2.",
        ),
    ] {
        let cut = super::thread(control, &format!("M3 S300;G0 X30. Z5.;{text}"));
        assert_eq!(cut.height.value.nm(), 1_300_000, "{text}");
    }
}
