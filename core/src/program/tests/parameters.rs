//! What parameters change: increments, units of P and Q, offsets, defaults of cycles.

use super::*;
use crate::params::{Entry, Writing};

/// The built-in machine with these numbers changed.
pub(super) fn machine(values: &[(&str, &str)]) -> Params {
    let mut params = Params::sheets();
    for (key, text) in values {
        let entry = Entry::find_text(key).unwrap_or_else(|_| panic!("{key}"));
        let raw = entry.parse(text, Writing::UnitOptional).expect(text);
        params.set(entry, raw).expect(text);
    }
    params
}

fn kinds_on(params: &Params, text: &str) -> Vec<CallKind> {
    let (events, alarm) = read_with(text.as_bytes(), params, Options::default());
    assert_eq!(alarm, None, "{text}");
    let call = |event| match event {
        Event::Call(call) => Some(call.kind),
        Event::Warning(_) => None,
    };
    events.into_iter().filter_map(call).collect()
}

fn thread_on(params: &Params, text: &str) -> ThreadCall {
    match kinds_on(params, text).pop() {
        Some(CallKind::Thread(call)) => call,
        other => panic!("{other:?}"),
    }
}

fn number_on(params: &Params, text: &str) -> u16 {
    let (_, alarm) = read_with(text.as_bytes(), params, Options::default());
    alarm.expect(text).number()
}

#[test]
fn is_b_has_ten_times_the_increment() {
    let b = machine(&[("1004.1", "0")]);
    assert_eq!(kinds_on(&b, "G0 X1.001"), [CallKind::Rapid(at(10_010, 0))]);
    assert_eq!(number_on(&b, "G0 X1.0001"), 4026);
    assert_eq!(number_on(&b, "C1.0001"), 4026);
    assert_eq!(number_on(&b, "G20 X1.00001"), 4026);
    let call = thread_on(&b, "G0 X80 Z10\nG76 Q150\nG76 X60.64 Z-62 P3680 Q1800 F6");
    assert_eq!(call.height.value, um(3_680));
    assert_eq!(call.min_step.value, um(150));
    assert_eq!(call.increment, um(1));
    let call = thread_on(&b, "G20 G0 X8 Z1\nG76 X6 Z-6 P1000 Q500 I8");
    assert_eq!(call.increment, Length::from_nm(2_540));
    assert_eq!(call.height.value, Length::from_nm(2_540_000));
    assert_eq!(number_on(&b, "G76 Q1000000"), 4025);
    assert_eq!(number_on(&b, "G75 R99.9999"), 4026);
    assert_eq!(number_on(&b, "G75 R100"), 4025);
    // Nine digits of increments.
    assert_eq!(number_on(&b, "G78 J1000000"), 4025);
    assert_eq!(kinds_on(&b, "G78 J999999.999"), []);
}

#[test]
fn p_and_q_in_millimetres() {
    let params = machine(&[("182.7", "1")]);
    let call = thread_on(
        &params,
        "G0 X80 Z10\nG76 Q.15\nG76 X60.64 Z-62 P3.68 Q1.8 F6",
    );
    assert_eq!(call.height.value, um(3_680));
    assert_eq!(call.first_depth.value, um(1_800));
    assert_eq!(call.min_step.value, um(150));
    // Without a point it is millimetres all the same.
    let call = thread_on(&params, "G0 X80 Z10\nG76 X60.64 Z-62 P3 Q1 F6");
    assert_eq!(call.height.value, mm(3));
    let groove = kinds_on(&params, "G0 X50 F1\nG75 X40 P3").pop();
    let Some(CallKind::Groove(groove)) = groove else {
        panic!("{groove:?}");
    };
    assert_eq!(groove.peck.map(|peck| peck.value), Some(um(1_500)));
}

#[test]
fn words_left_out_are_parameters() {
    let params = machine(&[
        ("019", "20"),
        ("057", "3"),
        ("058", "55"),
        ("059", "0.2"),
        ("060", "0.3"),
        ("5131", "30"),
        ("5144", "2"),
        ("5145", "0"),
        ("056", "0.7"),
    ]);
    let call = thread_on(&params, "G0 X80 Z10\nG78 X60 Z-20 P1 Q.3 F2");
    assert_eq!((call.finish_passes.value, call.angle.value), (3, 55));
    assert_eq!(
        (call.min_step.value, call.allowance.value),
        (um(200), um(300))
    );
    assert_eq!(
        (call.cut_in.value, call.infeed),
        (CutIn::Right, Infeed::Equal)
    );
    let run_out = call.run_out.expect("by 5130");
    assert_eq!(run_out.long.value, mm(4));
    // 4 mm · tan 30°
    assert_eq!(run_out.short.value, Length::from_nm(2_309_401));
    let g76 = "G0 X80 Z10\nG76 X60 Z-20 P10000 Q3000 F2";
    let run_out = thread_on(&params, g76).run_out.expect("by 019");
    assert_eq!((run_out.short.value, run_out.long.value), (mm(4), mm(4)));
    let options = Options {
        dialect: Dialect::Gsk988,
        ..Options::default()
    };
    let text = b"G0 X80 Z10\nG76 X60 Z-20 P1 Q.3 F2";
    let (events, _) = read_with(text, &params, options);
    let Some(Event::Call(Call {
        kind: CallKind::Thread(call),
        ..
    })) = events.last()
    else {
        panic!("{events:?}");
    };
    let run_out = call.run_out.expect("by 5130 and 5131");
    assert_eq!(run_out.short.value, Length::from_nm(2_309_401));
    let groove = kinds_on(&params, "G0 X50 F1\nG75 X40 P3").pop();
    let Some(CallKind::Groove(groove)) = groove else {
        panic!("{groove:?}");
    };
    assert_eq!(groove.retract.value, um(700));
    // 0 in 5131 is 45°, no run-out where the length is 0.
    let params = machine(&[("019", "0"), ("5131", "0")]);
    assert_eq!(thread_on(&params, g76).run_out, None);
}

#[test]
fn offsets_add_up() {
    let params = machine(&[
        ("1222.X", "20"),
        ("1222.Z", "-30"),
        ("9102.X", "1"),
        ("9102.Z", "2"),
    ]);
    assert_eq!(
        kinds_on(&params, "G55 G0 X0 Z0\nT0202\nX0 Z0\nG54 X0\nT0200 X0 Z0"),
        [
            CallKind::Rapid(at(200_000, -300_000)),
            CallKind::Aux(Aux::T(202)),
            CallKind::Rapid(at(210_000, -280_000)),
            CallKind::Rapid(at(10_000, -280_000)),
            CallKind::Aux(Aux::T(200)),
            CallKind::Rapid(at(0, 0)),
        ]
    );
    // G50 names the place where the tool stands, whatever offsets are in force, and they still count afterwards.
    assert_eq!(
        kinds_on(
            &params,
            "G55 T0202\nG50 X100 Z50\nG0 X99 Z50\nT0200\nX99 Z50"
        )[1..],
        [
            CallKind::Rapid(at(-10_000, 0)),
            CallKind::Aux(Aux::T(200)),
            CallKind::Rapid(at(-20_000, -20_000)),
        ]
    );
}

/// The codes of the functions that a text switches, with the line's motion as 0.
fn functions_on(params: &Params, text: &str) -> Vec<u16> {
    let code = |kind| match kind {
        CallKind::Aux(Aux::M(code)) => Some(code),
        CallKind::Rapid(_) | CallKind::Line(..) => Some(0),
        _ => None,
    };
    kinds_on(params, text)
        .into_iter()
        .filter_map(code)
        .collect()
}

#[test]
fn a_row_gives_a_code_its_place_in_the_block() {
    // M60 before the motion, M61 after it, M62 without an output, M8 with that of M60.
    let params = machine(&[
        ("9401", "601010000000"),
        ("9402", "617020000000"),
        ("9416", "620001010100"),
        ("9405", "81010000000"),
    ]);
    assert_eq!(functions_on(&params, "M61 M62 M60 G0 X1"), [62, 60, 0, 61]);
    assert_eq!(functions_on(&params, "G0 X1 M61\nM60"), [0, 61, 60]);
    // A fifth code, a code twice, two of one output, and one without a row.
    for (text, number) in [
        ("M60 M60", 4017),
        ("M61 M62 M61", 4017),
        ("M8 M60", 4017),
        ("M60 M8", 4017),
        ("M63", 4550),
        ("M60 M63", 4550),
        ("M60 M62 M61 M63 M64", 4017),
        ("M1000", 4019),
    ] {
        assert_eq!(number_on(&params, text), number, "{text}");
    }
}

#[test]
fn a_tapping_block_has_one_clamp() {
    let params = machine(&[("9401", "601010000000"), ("9402", "617020000000")]);
    let text = "M29 S100\nG84 Z-9 R-2 F100 M60";
    assert_eq!(
        read_with(text.as_bytes(), &params, Options::default()).1,
        None
    );
    let text = "M29 S100\nG84 Z-9 R-2 F100 M60 M61";
    assert_eq!(number_on(&params, text), 4017);
}
