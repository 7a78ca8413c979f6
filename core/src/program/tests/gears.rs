//! M41 to M44 on a machine with gears: what a program may say before and behind them, and the order of a block.

use super::*;

/// Gear 1: 4 turns of the motor for one of the spindle, up to 600 rpm. Gear 2: 1:1, up to 2500.
fn geared() -> Params {
    parameters::machine(&[
        ("9431", "4"),
        ("9436", "1"),
        ("9441", "600"),
        ("9432", "1"),
        ("9437", "1"),
        ("9442", "2500"),
    ])
}

fn alarm_on(params: &Params, text: &str, gear: u8) -> Option<(u16, u32, u16, u16)> {
    let options = Options {
        gear,
        ..Options::default()
    };
    let (_, alarm) = read_with(text.as_bytes(), params, options);
    alarm.map(|alarm| {
        let span = alarm.span;
        (alarm.code.number(), span.line, span.column, span.end)
    })
}

#[test]
fn a_speed_needs_a_gear_and_keeps_below_its_highest() {
    let params = geared();
    for (text, gear, expected) in [
        ("S300\n", 0, Some((4554, 1, 1, 5))),
        ("M3 S300\n", 0, Some((4554, 1, 4, 8))),
        ("M41\nM3 S300\n", 0, None),
        ("M3 S300\n", 1, None),
        ("M41\nM3 S600\n", 0, None),
        ("M41\nM3 S601\n", 0, Some((4557, 2, 4, 8))),
        ("M42\nM3 S601\n", 0, None),
        ("M42\nM3 S2501\n", 0, Some((4557, 2, 4, 9))),
        ("M3 S601\n", 1, Some((4557, 1, 4, 8))),
        // S of the gear before.
        ("M42\nM3 S900\nM5\nM41\nM3\n", 0, Some((4557, 5, 1, 3))),
        ("M42\nM3 S900\nM5\nM41\nM3 S500\n", 0, None),
        // A gear is selected while the spindle stands.
        ("M41\nM3 S300\nM42\n", 0, Some((4556, 3, 1, 4))),
        ("M41\nM3 S300\nM5 M42\n", 0, Some((4556, 3, 4, 7))),
        ("M43\n", 0, Some((4558, 1, 1, 4))),
        ("M41 M42\n", 0, Some((4017, 1, 5, 8))),
        // Surface speed, and taps.
        ("G96 S100 M3\n", 0, Some((4554, 1, 10, 12))),
        ("M41\nG96 S100 M3\n", 0, None),
        ("M29 S300\n", 0, Some((4554, 1, 5, 9))),
        ("M41\nM29 S601\n", 0, Some((4033, 2, 5, 9))),
    ] {
        let found = alarm_on(&params, text, gear);
        match (found, expected) {
            // The number of a tap's own refusal is that of taps.
            (Some((_, line, from, to)), Some((4033, l, f, t))) => {
                assert_eq!((line, from, to), (l, f, t), "{text}");
            }
            _ => assert_eq!(found, expected, "{text}"),
        }
    }
    // Without gears they are M codes like any others.
    assert_eq!(
        alarm_on(&Params::sheets(), "M41\n", 0),
        Some((4550, 1, 1, 4))
    );
    assert_eq!(alarm_on(&Params::sheets(), "M3 S601\n", 0), None);
}

#[test]
fn a_gear_comes_before_the_speed_of_its_block_and_limits_surface_speed() {
    let params = geared();
    let kinds = |text: &str| {
        let (events, alarm) = read_with(text.as_bytes(), &params, Options::default());
        assert_eq!(alarm, None, "{text}");
        let call = |event| match event {
            Event::Call(call) => Some(call.kind),
            Event::Warning(_) => None,
        };
        events.into_iter().filter_map(call).collect::<Vec<_>>()
    };
    assert_eq!(
        kinds("M3 S300 M8 M41\n"),
        [
            CallKind::Aux(Aux::M(41)),
            CallKind::Spindle(SpindleCall::speed(Rpm::new(300))),
            CallKind::Aux(Aux::M(8)),
        ]
    );
    let most = |text: &str| match kinds(text).pop() {
        Some(CallKind::Spindle(call)) => call.law().map(|law| law.most),
        other => panic!("{other:?}"),
    };
    assert_eq!(most("M41\nG96 S100 M3\n"), Some(600));
    assert_eq!(most("M42\nG96 S100 M3\n"), Some(2500));
    assert_eq!(most("M42\nG50 S2000\nG96 S100 M3\n"), Some(2000));
}
