//! G10: what it writes, where it counts, what it refuses.

use super::*;
use crate::offsets::{Offset, Offsets};
use crate::units::Diameter;

/// The table that a program leaves, read with that table or with none.
fn left(text: &str, params: &Params, table: Option<Offsets>) -> Option<Offsets> {
    let options = Options {
        offsets: table,
        ..Options::default()
    };
    let mut interpreter = Interpreter::new(params, options);
    for (line, text) in (1..).zip(text.split('\n')) {
        interpreter
            .line(text.as_bytes(), line, &mut |_| {})
            .unwrap_or_else(|alarm| panic!("{alarm:?} in {text}"));
    }
    interpreter.written_offsets().copied()
}

/// X in diameter and Z, in 0.1 µm.
fn offset(x: i64, z: i64) -> Offset {
    Offset {
        x: Diameter::from_nm(x * 100),
        z: Length::from_nm(z * 100),
    }
}

/// What a block changes.
type Change = fn(&mut Offsets);

#[test]
fn each_form_writes_its_record_and_no_other() {
    let params = Params::sheets();
    let mut before = Offsets {
        shift: offset(10, 20),
        ..Offsets::default()
    };
    before.work[5] = offset(30, 40);
    before.tools[6].geometry = offset(1_000, 2_000);
    before.tools[6].wear = offset(3, 4);
    before.tools[6].radius = um(400);
    let after = |text: &str| left(text, &params, Some(before)).expect(text);
    let changed = |change: Change| {
        let mut table = before;
        change(&mut table);
        table
    };
    let rows: [(&str, Change); 15] = [
        ("G10 P0 X1 Z-2", |t| t.shift = offset(10_000, -20_000)),
        ("G10 L2 P0 W.5", |t| t.shift = offset(10, 5_020)),
        ("G10 L2 P6 X5", |t| t.work[5] = offset(50_000, 40)),
        ("G10 L2 P1 U-.1 Z3", |t| t.work[0] = offset(-1_000, 30_000)),
        ("G10 P7 U.01", |t| t.tools[6].wear = offset(103, 4)),
        ("G10 L11 P7 X.2 Z.3", |t| {
            t.tools[6].wear = offset(2_000, 3_000);
        }),
        ("G10 P10007 X-50 Z2 R.8 Q3", |t| {
            let tool = &mut t.tools[6];
            tool.geometry = offset(-500_000, 20_000);
            (tool.radius, tool.tip) = (um(800), 3);
            (tool.measured_x, tool.measured_z) = (true, true);
        }),
        ("G10 L10 P7 W1 C.1", |t| {
            let tool = &mut t.tools[6];
            tool.geometry = offset(1_000, 12_000);
            tool.radius = um(500);
            tool.measured_z = true;
        }),
        ("G10 L12 P7 R1.2", |t| t.tools[6].radius = um(1_200)),
        // A wear has no radius of its own, and the tip is that of the number.
        ("G10 P7 X.2 Z0 R0 Q2", |t| {
            (t.tools[6].wear, t.tools[6].tip) = (offset(2_000, 0), 2);
        }),
        ("G10 P7 R0 C0", |_| {}),
        ("G10 L11 P7 Q3", |t| t.tools[6].tip = 3),
        // In inches, to the nearest 0.1 µm: 25.4 and 2.54 mm; 2.54 µm.
        ("G20 G10 P0 X1 Z.1", |t| t.shift = offset(254_000, 25_400)),
        ("G20 G10 P0 Z.0001", |t| t.shift = offset(10, 25)),
        ("G10 P1 X1\nG10 P1 U1\nG10 P1 W1", |t| {
            t.tools[0].wear = offset(20_000, 10_000);
        }),
    ];
    for (text, change) in rows {
        assert_eq!(after(text), changed(change), "{text}");
    }
    assert_eq!(left("G0 X1\nM30", &params, Some(before)), None);
}

#[test]
fn without_a_table_the_parameters_begin_one() {
    let params = machine(&[("1222.X", "10"), ("9103.Z", "7")]);
    let mut expected = Offsets::of_params(&params).unwrap();
    assert_eq!(expected.work[1], offset(100_000, 0));
    expected.shift = offset(0, 10_000);
    assert_eq!(left("G10 P0 Z1", &params, None), Some(expected));
}

#[test]
fn what_is_written_counts_from_the_next_word_on() {
    let ends = |text: &str| {
        let rapid = |kind| match kind {
            CallKind::Rapid(to) => Some(to),
            _ => None,
        };
        kinds(text)
            .into_iter()
            .filter_map(rapid)
            .collect::<Vec<_>>()
    };
    assert_eq!(
        ends("G0 X10 Z5\nG10 L2 P1 X2 Z-1\nG0 X10 Z5\nG55 X10 Z5"),
        [
            at(100_000, 50_000),
            at(120_000, 40_000),
            at(100_000, 50_000)
        ]
    );
    // The tool in force, and one that comes later.
    assert_eq!(
        ends("T0101\nG10 P1 X.1\nG0 X1\nG10 P10002 X3\nX1\nT0202 X1"),
        [at(11_000, 0), at(11_000, 0), at(40_000, 0)]
    );
    // It moves nothing by itself, and words of the machine in its block are carried out.
    let [CallKind::Spindle(_)] = kinds("G10 P0 X1 M3 S100")[..] else {
        panic!()
    };
}

#[test]
fn a_refused_block_writes_nothing() {
    let params = Params::sheets();
    let mut interpreter = Interpreter::new(&params, Options::default());
    let alarm = interpreter
        .line(b"G10 P1 X.5 Z100.", 1, &mut |_| {})
        .unwrap_err();
    assert_eq!(
        (alarm.number(), alarm.args[0]),
        (4582, crate::alarm::Arg::Int(1))
    );
    assert_eq!(interpreter.written_offsets(), None);
}
