//! Programs of a Haas lathe.

use super::*;

fn haas(text: &str) -> Vec<String> {
    kinds(Control::Haas, text)
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
        let odd = kinds(control, &one("I-.5 K.2 D2."));
        assert!(odd.contains(&"w4989".to_owned()), "{control:?}");
        assert!(!left.contains(&"w4989".to_owned()), "{control:?}");
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
