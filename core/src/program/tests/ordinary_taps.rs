//! G84 and G88 without rigid mode: the spindle turns by M03 or M04, and S is its own.

use super::*;
use crate::alarm::Code;
use crate::units::Millis;

fn taps(text: &str) -> Vec<TapCall> {
    let tap = |kind| match kind {
        CallKind::Tap(call) => Some(call),
        _ => None,
    };
    kinds_on(&[], text).0.into_iter().filter_map(tap).collect()
}

#[test]
fn a_turning_spindle_taps_without_rigid_mode() {
    let (kinds, warnings) = kinds_on(&[], "G98 M3 S500\nG84 Z-20 R-2 P300 Q4 F750\nX5\nG80\nM30");
    assert!(warnings.is_empty(), "{warnings:?}");
    let [
        turn,
        CallKind::Tap(first),
        CallKind::Tap(second),
        CallKind::End(30),
    ] = kinds.as_slice()
    else {
        panic!("{kinds:?}")
    };
    assert_eq!(*turn, spindle(500));
    assert_eq!(
        (first.mode, first.hand),
        (TapMode::Floating, HandChoice::Written(Hand::Right))
    );
    assert_eq!((first.speed, first.extract), (rpm(500), rpm(500)));
    assert_eq!(
        (lead_of(first), first.dwell),
        ((1_500_000, 1), Millis::new(300))
    );
    assert!(matches!(first.form, TapForm::HighSpeed(_)));
    assert_eq!(
        (second.mode, second.bottom.value),
        (TapMode::Floating, mm(-20))
    );
}

#[test]
fn m04_is_a_left_hand_tap() {
    let taps = taps("M4 S500\nG99 G84 Z-20 F1.5\nM3\nX5\nM4 S300\nX6");
    let seen: Vec<_> = taps.iter().map(|tap| (tap.hand, tap.speed)).collect();
    assert_eq!(
        seen,
        [
            (HandChoice::Written(Hand::Left), rpm(500)),
            (HandChoice::Written(Hand::Right), rpm(500)),
            (HandChoice::Written(Hand::Left), rpm(300))
        ]
    );
    assert!(taps.iter().all(|tap| lead_of(tap) == (1_500_000, 1)));
}

#[test]
fn the_spindle_is_free_between_the_holes_and_goes_on_after_them() {
    // M03 and S of the hole's own block come before it, M05 after it.
    let (kinds, _) = kinds_on(&[], "M3 S500\nG84 Z-20 F600 M4 S600\nX5 M5\nG80\nM3");
    assert_eq!(kinds[1], spindle(-600));
    let CallKind::Tap(tap) = kinds[2] else {
        panic!("{kinds:?}")
    };
    assert_eq!(
        (lead_of(&tap), tap.hand),
        ((1_000_000, 1), HandChoice::Written(Hand::Left))
    );
    assert!(matches!(kinds[3], CallKind::Tap(_)));
    // G80 stops nothing and clears nothing: after M05 the S is still there.
    assert_eq!(kinds[4..], [spindle(0), spindle(600)]);
    for end in ["G80", "G0 X80", "G80 G0 X80"] {
        let text = std::format!("M3 S500\nG84 Z-20 F600\n{end}\nM4");
        let (kinds, _) = kinds_on(&[], &text);
        assert_eq!(*kinds.last().unwrap(), spindle(-500), "{text}");
        assert!(!kinds.contains(&spindle(0)), "{text}");
    }
}

#[test]
fn a_standing_spindle_is_left_to_physics_where_the_lead_is_known() {
    let standing = taps("G99 G84 Z-20 F1.5");
    assert_eq!(
        (standing[0].mode, standing[0].speed),
        (TapMode::Floating, rpm(0))
    );
    let standing = taps("S300\nG84 Z-20 F600");
    assert_eq!(
        (lead_of(&standing[0]), standing[0].speed),
        ((2_000_000, 1), rpm(0))
    );
    // Without S no lead can be told, and with 5200.0 = 1 rigid mode is more likely meant.
    assert_eq!(alarm("G84 Z-20 F600").code, Code::TapSpindleStands);
    let by_g = |text: &str| {
        let values = [("5200.0", "1")];
        read_with(text.as_bytes(), &machine(&values), Options::default()).1
    };
    assert_eq!(
        by_g("G99 G84 Z-20 F1").map(|alarm| alarm.code),
        Some(Code::TapSpeed)
    );
    assert_eq!(by_g("M3 S500\nG84 Z-20 F600"), None);
}

#[test]
fn s_in_the_block_of_the_cycle_is_rigid_mode_where_5200_0_says_so() {
    let values = [("5200.0", "1")];
    let (kinds, _) = kinds_on(&values, "M3 S500\nG84 Z-20 F600\nX5 S300");
    let modes: Vec<_> = kinds
        .iter()
        .filter_map(|kind| match kind {
            CallKind::Tap(call) => Some((call.mode, call.speed)),
            _ => None,
        })
        .collect();
    // S without the G code is the spindle's own while the cycle is an ordinary one.
    assert_eq!(
        modes,
        [(TapMode::Floating, rpm(500)), (TapMode::Floating, rpm(300))]
    );
    assert_eq!(kinds[2], spindle(300));
    let (kinds, _) = kinds_on(&values, "M3 S500\nG84 Z-20 F600\nG84 X5 S400");
    assert_eq!(
        kinds[2],
        CallKind::Spindle(SpindleCall::rigid(Rpm::new(400), SpindleChoice::default()))
    );
    let CallKind::Tap(tap) = kinds[3] else {
        panic!("{kinds:?}")
    };
    assert_eq!((tap.mode, tap.speed), (TapMode::Rigid, rpm(400)));
}

#[test]
fn what_belongs_to_rigid_mode_does_not_apply() {
    // The extraction override.
    let values = [("5200.4", "1"), ("5201.4", "1"), ("5211", "150")];
    let (kinds, warnings) = kinds_on(&values, "M3 S500\nG84 Z-20 F600 J900");
    assert_eq!(warnings, [4909]);
    let CallKind::Tap(tap) = kinds[1] else {
        panic!("{kinds:?}")
    };
    assert_eq!((tap.speed, tap.extract), (rpm(500), rpm(500)));
    // 5241.
    let (kinds, _) = kinds_on(&[("5241", "400 rpm")], "M3 S500\nG84 Z-20 F600");
    assert!(matches!(kinds[1], CallKind::Tap(tap) if tap.speed == rpm(500)));
    // The dry run: the spindle turns as it does.
    let params = machine(&[("1410", "300 mm/min")]);
    let options = Options {
        dry_run: true,
        ..Options::default()
    };
    let (events, _) = read_with(b"M3 S500\nG84 Z-20 F600", &params, options);
    assert!(matches!(
        events[1],
        Event::Call(Call { kind: CallKind::Tap(tap), .. }) if tap.speed == rpm(500)
    ));
    // K198, and a cycle that goes on after it.
    assert_eq!(
        alarm("M3 S500\nG84 Z-20 F600 K198").code,
        Code::TapStayNotRigid
    );
}
