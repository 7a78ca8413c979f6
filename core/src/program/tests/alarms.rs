//! Every alarm and warning of this folder, provoked: number, word, line and columns.

use super::*;
use crate::alarm::{Arg, Code, Lang};
use std::collections::BTreeSet;
use std::string::String;

/// A G76 whose words are right, after an approach.
const AT: &str = "G0 X80 Z10\n";

/// Text, number, line, first column, column after the last, letter (`-` for none).
const CASES: &[(&str, u16, u32, u16, u16, char)] = &[
    // Characters and numbers.
    ("G0 X1\n  & X2", 4001, 2, 3, 4, '-'),
    ("G0 X1 -2", 4001, 1, 7, 8, '-'),
    ("G0\rX1", 4001, 1, 3, 4, '-'),
    ("G0 X１", 4003, 1, 4, 5, 'X'),
    ("G0 Ｘ1", 4002, 1, 4, 5, '-'),
    ("G0 X1\n\0", 4051, 2, 1, 2, '-'),
    ("O\0", 4051, 1, 1, 2, 'O'),
    ("G0 X 1", 4003, 1, 4, 5, 'X'),
    ("G0 X-.", 4003, 1, 4, 7, 'X'),
    ("X1234567890123456789", 4004, 1, 1, 21, 'X'),
    ("X1.5.2", 4005, 1, 1, 5, 'X'),
    ("G0 X1 (open", 4007, 1, 7, 8, '-'),
    ("(open\nstill", 4007, 1, 1, 2, '-'),
    ("（open", 4007, 1, 1, 2, '-'),
    ("G0 X1)", 4008, 1, 6, 7, '-'),
    ("G0 X1）", 4008, 1, 6, 7, '-'),
    ("G0 X1 /Z1", 4009, 1, 7, 8, '-'),
    ("G0 X1 %", 4010, 1, 7, 8, '-'),
    ("#1=5", 4011, 1, 1, 2, '-'),
    ("G0 X#1", 4011, 1, 4, 5, 'X'),
    ("G0 X[1+2]", 4011, 1, 4, 5, 'X'),
    // Words of a block.
    ("G0 Y5", 4012, 1, 4, 6, 'Y'),
    ("A5", 4012, 1, 1, 3, 'A'),
    ("G0 X1 Z2 X3", 4013, 1, 10, 12, 'X'),
    ("N1 N2", 4013, 1, 4, 6, 'N'),
    ("G0 N5", 4014, 1, 4, 6, 'N'),
    ("G0 O5", 4014, 1, 4, 6, 'O'),
    ("G0 X1 U2", 4015, 1, 7, 9, 'U'),
    ("G0 W1 Z2", 4015, 1, 7, 9, 'Z'),
    ("C1 H2", 4015, 1, 4, 6, 'H'),
    ("G0 G1", 4016, 1, 4, 6, 'G'),
    ("G76 G04 X1", 4016, 1, 5, 8, 'G'),
    ("G98 G99", 4016, 1, 5, 8, 'G'),
    ("M3 M4", 4017, 1, 4, 6, 'M'),
    ("M0 M30", 4017, 1, 4, 7, 'M'),
    ("G0 X1\nG5 X2", 4018, 2, 1, 3, 'G'),
    ("G100000", 4018, 1, 1, 8, 'G'),
    ("M77", 4019, 1, 1, 4, 'M'),
    ("G28 U0 W0", 4020, 1, 1, 4, 'G'),
    ("G92 X1", 4020, 1, 1, 4, 'G'),
    ("M98 P1", 4021, 1, 1, 4, 'M'),
    ("G33 Z1 F1", 4022, 1, 1, 4, 'G'),
    ("G1.5", 4023, 1, 1, 5, 'G'),
    ("M3 S100.", 4023, 1, 4, 9, 'S'),
    ("N1.5", 4023, 1, 1, 5, 'N'),
    ("T01.01", 4023, 1, 1, 7, 'T'),
    ("G4 P1.", 4023, 1, 4, 7, 'P'),
    ("G78 D1.", 4023, 1, 5, 8, 'D'),
    ("G76 Q1500.", 4023, 1, 5, 11, 'Q'),
    ("G75 X5 P60000.5", 4023, 1, 8, 16, 'P'),
    ("G78 L2.", 4023, 1, 5, 8, 'L'),
    ("M3 S-100", 4024, 1, 4, 9, 'S'),
    ("G-1", 4024, 1, 1, 4, 'G'),
    ("G0 X9999999", 4025, 1, 4, 12, 'X'),
    ("C9999999", 4025, 1, 1, 9, 'C'),
    ("G1 X1 F0", 4025, 1, 7, 9, 'F'),
    ("G1 X1 F-5", 4025, 1, 7, 10, 'F'),
    ("G1 X1 F1000000", 4025, 1, 7, 15, 'F'),
    ("G20 G1 X1 F100000", 4025, 1, 11, 18, 'F'),
    ("G1 X1 F999999999999999999", 4025, 1, 7, 26, 'F'),
    ("C999999999999999999", 4025, 1, 1, 20, 'C'),
    ("X999999999999999999", 4025, 1, 1, 20, 'X'),
    ("X-999999999999999999", 4025, 1, 1, 21, 'X'),
    ("G78 J999999999999999999", 4025, 1, 5, 24, 'J'),
    ("T10000", 4025, 1, 1, 7, 'T'),
    ("N100000000", 4025, 1, 1, 11, 'N'),
    ("G4 X-1", 4025, 1, 4, 7, 'X'),
    ("G75 R100", 4025, 1, 5, 9, 'R'),
    ("G76 R100", 4025, 1, 5, 9, 'R'),
    ("G76 Q10000000", 4025, 1, 5, 14, 'Q'),
    ("G75 X4 P100000000", 4025, 1, 8, 18, 'P'),
    ("G76 X60 Z-1 P100000000 Q1 F1", 4025, 1, 13, 23, 'P'),
    ("G78 J100000", 4025, 1, 5, 12, 'J'),
    ("G78 X1 R-100000 P1 Q1 F1", 4025, 1, 8, 16, 'R'),
    ("G0 X1.00001", 4026, 1, 4, 12, 'X'),
    ("C1.00001", 4026, 1, 1, 9, 'C'),
    ("G20 X1.000001", 4026, 1, 5, 14, 'X'),
    ("G4 X.0005", 4026, 1, 4, 10, 'X'),
    ("G1 X1 F.0000001", 4026, 1, 7, 16, 'F'),
    ("G76 X1 Z-1 P1 Q1 F.0000001", 4026, 1, 18, 27, 'F'),
    ("G0 Z4000000\nW4000000", 4027, 2, 1, 9, 'W'),
    ("G0 X4000000\nG50 X-4000000\nX4000000", 4027, 3, 1, 9, 'X'),
    ("C4000000\nH4000000", 4027, 2, 1, 9, 'H'),
    // Words and codes that do not fit together.
    ("G1 X1 P5 F1", 4028, 1, 7, 9, 'P'),
    ("G0 X1 I5", 4028, 1, 7, 9, 'I'),
    ("G2 X1 C5 R1 F1", 4028, 1, 7, 9, 'C'),
    ("G20 P5", 4028, 1, 5, 7, 'P'),
    ("G75 X1 P1 J5", 4028, 1, 11, 13, 'J'),
    ("G76 P60 D1", 4028, 1, 9, 11, 'D'),
    ("G4 P5 Z1", 4028, 1, 7, 9, 'Z'),
    ("G4 X5 Z1", 4028, 1, 7, 9, 'Z'),
    ("G50 X1 R5", 4028, 1, 8, 10, 'R'),
    ("G53 X1 R5", 4028, 1, 8, 10, 'R'),
    ("G1 G76 X1 P1 Q1 F1", 4029, 1, 4, 7, 'G'),
    ("G50 G0 X1", 4029, 1, 5, 7, 'G'),
    ("G53 G1 X1", 4029, 1, 5, 7, 'G'),
    ("G0 G4 X1", 4029, 1, 4, 6, 'G'),
    ("O1\nG0 X1\nO2", 4030, 3, 1, 3, 'O'),
    ("G04", 4031, 1, 1, 4, 'G'),
    ("G50", 4031, 1, 1, 4, 'G'),
    ("G53", 4031, 1, 1, 4, 'G'),
    ("G4 P5 X1", 4032, 1, 7, 9, 'X'),
    ("G53 X1 W1", 4033, 1, 8, 10, 'W'),
    ("G1 X1", 4034, 1, 1, 3, '-'),
    ("G1\nX1", 4034, 2, 1, 3, '-'),
    ("G75 X-1 P1", 4034, 1, 1, 4, '-'),
    ("M3 S3001", 4035, 1, 4, 9, 'S'),
    ("G50 S3001", 4035, 1, 5, 10, 'S'),
    ("T0133", 4036, 1, 1, 6, 'T'),
    // Arcs.
    ("G17 G2 X10 R5 F1", 4037, 1, 5, 7, '-'),
    ("G19 G3 X10 R5 F1", 4037, 1, 5, 7, '-'),
    ("G2 X10 F1", 4038, 1, 1, 3, '-'),
    ("G2 X10 R5 K1 F1", 4039, 1, 11, 13, 'K'),
    ("G2 X10 R0 F1", 4040, 1, 8, 10, 'R'),
    ("G2 X10 I0 F1", 4040, 1, 8, 10, 'I'),
    ("G2 X0 R5 F1", 4041, 1, 7, 9, 'R'),
    ("G2 X20 Z-10 R5 F1", 4042, 1, 13, 15, 'R'),
    ("G3 X20 Z-10 K-9 F1", 4043, 1, 13, 16, 'K'),
    // Cycles.
    ("G76 P1020560", 4044, 1, 5, 13, 'P'),
    ("G76 P60.", 4044, 1, 5, 9, 'P'),
    ("G78 P-60", 4044, 1, 5, 9, 'P'),
    ("G76 Q.15", 4045, 1, 5, 9, 'Q'),
    ("G76 X60 Z-1 P3.68 Q1 F1", 4045, 1, 13, 18, 'P'),
    ("G76 X60 Z-1 P36800 Q1.8 F1", 4045, 1, 20, 24, 'Q'),
    ("G75 X60 P3. F1", 4045, 1, 9, 12, 'P'),
    ("G76 Q-1", 4046, 1, 5, 8, 'Q'),
    ("G76 R-.1", 4046, 1, 5, 9, 'R'),
    ("G76 J-1", 4046, 1, 5, 8, 'J'),
    ("G78 K-1", 4046, 1, 5, 8, 'K'),
    ("G78 E-1", 4046, 1, 5, 8, 'E'),
    ("G75 R-1", 4046, 1, 5, 8, 'R'),
    ("G78 D2", 4047, 1, 5, 7, 'D'),
    ("G78 L0", 4048, 1, 5, 7, 'L'),
    ("G78 L100", 4048, 1, 5, 9, 'L'),
    ("G76 X60 Z-1 P1 Q1 F1 I8", 4049, 1, 22, 24, 'I'),
    ("G76 X60 Z-1 P1 Q1 I8 F1", 4049, 1, 22, 24, 'F'),
    ("G75 Z-1 P1 Q1 F1", 4050, 1, 1, 4, '-'),
    ("G75 P1", 4050, 1, 1, 4, '-'),
    ("G76 X60 Z-1 P1 Q1", 313, 1, 1, 4, '-'),
    ("F5\nG76 X60 Z-1 P1 Q1", 313, 2, 1, 4, '-'),
    ("G76 X60 Z-1 P1 Q1 F0", 313, 1, 19, 21, 'F'),
    ("G76 X60 Z-1 P1 Q1 F-1", 313, 1, 19, 22, 'F'),
    ("G76 X60 Z-1 P1 Q1 F10000", 313, 1, 19, 25, 'F'),
    ("G76 X60 Z-1 P1 Q1 F.00001", 313, 1, 19, 26, 'F'),
    ("G76 X60 Z-1 P1 Q1 I254.1", 313, 1, 19, 25, 'I'),
    ("G20 G76 X60 Z-1 P1 Q1 F10", 313, 1, 23, 26, 'F'),
    ("G20 G76 X60 Z-1 P1 Q1 I101", 313, 1, 23, 27, 'I'),
    ("G76 X60 Z-1 Q1 F1", 317, 1, 1, 4, '-'),
    ("G76 X60 Z-1 P1 F1", 317, 1, 1, 4, '-'),
    ("G78 X60 Z-1 P0 Q1 F1", 317, 1, 13, 15, 'P'),
    ("G78 X60 Z-1 P1 Q-1 F1", 317, 1, 16, 19, 'Q'),
    ("G75 X40 P1 R-1 F1", 318, 1, 12, 15, 'R'),
    ("G75 X40 F1", 319, 1, 1, 4, '-'),
    ("G75 X40 P0 F1", 319, 1, 9, 11, 'P'),
    ("G75 X40 Z-5 P1 F1", 319, 1, 1, 4, '-'),
    ("G75 X40 Z-5 P1 Q0 F1", 319, 1, 16, 18, 'Q'),
    ("G75 X40 P-1 F1", 320, 1, 9, 12, 'P'),
    ("G75 X40 P1 Q-1 F1", 320, 1, 12, 15, 'Q'),
    // Taps.
    ("M29", 200, 1, 1, 4, '-'),
    ("M29 S0", 200, 1, 5, 7, 'S'),
    ("M29 S3001", 200, 1, 5, 10, 'S'),
    ("S-3001 M29", 200, 1, 1, 7, 'S'),
    ("M29 S9\nG84 Z-9", 201, 2, 1, 4, '-'),
    ("M29 S9\nG84 Z-9 F0", 201, 2, 9, 11, 'F'),
    ("M29 S9\nG84 Z-9 F-1", 201, 2, 9, 12, 'F'),
    ("M29 S9\nG84 Z-9 F9\nG99\nX5", 201, 4, 1, 3, '-'),
    ("M29 S9\nM8", 203, 2, 1, 3, '-'),
    ("M29 S9\n\n(a)\nN5 G98", 203, 4, 4, 7, '-'),
    ("M29 S9\nM29 S9", 203, 2, 1, 4, 'M'),
    ("M29 S9\nG80", 203, 2, 1, 4, '-'),
    ("M29 S9\nM30", 203, 2, 1, 4, '-'),
    ("M29 S9\nG4 X1", 203, 2, 1, 3, '-'),
    ("M29 S9 G84 Z-9 F9", 203, 1, 1, 4, 'M'),
    ("M29 S9 G4 P5", 203, 1, 1, 4, 'M'),
    ("M29 S9\nG84 Z-9 F9\nM29 S9", 203, 3, 1, 4, 'M'),
    ("M29 S9\nG84 Z-9 F9 S9", 203, 2, 12, 14, 'S'),
    ("M29 S9\nG84 Z-9 F9\nX5 S9", 203, 3, 4, 6, 'S'),
    ("M29 S9 X5", 204, 1, 8, 10, 'X'),
    ("M29 S9\nG0 X5", 204, 2, 4, 6, 'X'),
    ("M29 S9\nH5 X5", 204, 2, 1, 3, 'H'),
    ("M29 S9\nG17 G84 X-9 F9", 206, 2, 1, 4, 'G'),
    ("M29 S9\nG84 Z-9 F9\nG19", 206, 3, 1, 4, 'G'),
    ("G84 Z-9 F9", 4060, 1, 1, 4, '-'),
    (
        "S500\nM5\nG80\nM29 S9\nG88 X5 F9\nG80\nG88 X5 F9",
        4060,
        7,
        1,
        4,
        '-',
    ),
    ("M3 S500\nG84 Z-9 F9 K198", 4078, 2, 12, 16, 'K'),
    ("M29 S9\nG84 Z-9 F9\nG80\nG84 Z-9 F9", 4060, 4, 1, 4, '-'),
    ("G19 M29 S9\nG84 Z-9 F9", 4061, 2, 1, 4, 'G'),
    ("G17 M29 S9\nG88 Z-9 F9", 4061, 2, 1, 4, 'G'),
    ("M29 S9\nG84 X5 F9", 4062, 2, 1, 4, '-'),
    ("M29 S9\nG88 Z-5 F9", 4062, 2, 1, 4, '-'),
    ("M29 S9\nG84 Z-9 F9 K0", 4063, 2, 12, 14, 'K'),
    ("M29 S9\nG84 Z-9 F9 K100", 4063, 2, 12, 16, 'K'),
    ("M29 S9\nG84 Z-9 F9 K199", 4063, 2, 12, 16, 'K'),
    ("M29 S9\nG84 Z-9 F9 K2.", 4023, 2, 12, 15, 'K'),
    ("M29 S9.", 4023, 1, 5, 8, 'S'),
    ("M29 S9\nG84 Z-9 F9 P5.", 4023, 2, 12, 15, 'P'),
    ("M29 S9\nG84 Z-9 F9 E1.", 4023, 2, 12, 15, 'E'),
    ("M29 S9\nG84 Z-9 F9 E0", 4025, 2, 12, 14, 'E'),
    ("M29 S9\nG84 Z-9 F9 E5", 4025, 2, 12, 14, 'E'),
    ("M29 S9\nG84 Z-9 F9 J100000", 4025, 2, 12, 19, 'J'),
    ("M29 S9\nG84 Z-9 F9 Q100000", 4025, 2, 12, 19, 'Q'),
    ("M29 S9\nG84 Z-9 F9 M9999", 4025, 2, 12, 17, 'M'),
    ("M29 S9\nG84 Z-9 F9 Q-1", 4046, 2, 12, 15, 'Q'),
    ("M29 S9\nG84 Z-9 F9 D-1", 4046, 2, 12, 15, 'D'),
    ("M29 S9\nG84 Z-9 F9 J-1", 4046, 2, 12, 15, 'J'),
    ("M29 S9\nG84 Z-9 H3999999 K9 F9", 4027, 2, 18, 20, 'K'),
    ("M29 S9\nG84 Z-9 F9\nZ-5 K2", 4028, 3, 5, 7, 'K'),
    ("M29 S9\nG84 Z-9 F9\nX5 I2", 4028, 3, 4, 6, 'I'),
    ("M29 S9\nG84 Z-9 F9 K198\nG80", 4064, 3, 1, 4, 'G'),
    ("M29 S9\nG84 Z-9 F9\nG53 X5", 4065, 3, 1, 4, 'G'),
    ("M29 S9\nG84 Z-9 F9\nG75 X5 P1", 4065, 3, 1, 4, 'G'),
    ("M29 S9\nG84 Z-9 F9\nM3", 4066, 3, 1, 3, 'M'),
    ("M29 S9\nG84 Z-9 F9\nX5 M5", 4066, 3, 4, 6, 'M'),
    ("M29 S9 M3", 4066, 1, 8, 10, 'M'),
    ("M29 S9\nG84 Z-9 F9 M7", 4067, 2, 12, 14, 'M'),
    ("M29 S9\nG84 Z-9 F9 M28", 4067, 2, 12, 15, 'M'),
    ("M29 S9\nG84 Z-9 F9 K198", 4068, 2, 1, 4, '-'),
    ("G0 G84 Z-9 F9", 4029, 1, 4, 7, 'G'),
    ("G84 G4 Z-9 F9", 4029, 1, 5, 7, 'G'),
    ("G80 G84 Z-9 F9", 4016, 1, 5, 8, 'G'),
    ("M24 M25", 4017, 1, 5, 8, 'M'),
    ("M29 S9\nG84 Z-9 F9\nG4 P5 M77", 4019, 3, 7, 10, 'M'),
    ("G30 P2", 4020, 1, 1, 4, 'G'),
    ("G30", 4020, 1, 1, 4, 'G'),
    ("G30 P99.0", 4020, 1, 1, 4, 'G'),
    ("G30 P99 X5", 4028, 1, 9, 11, 'X'),
    ("G30 F5 P99", 4028, 1, 5, 7, 'F'),
    ("G30 P99 T101", 4028, 1, 9, 13, 'T'),
    ("G0 G30 P99", 4028, 1, 1, 3, 'G'),
    ("G30 P99 M3", 4028, 1, 9, 11, 'M'),
    ("G30 P99 M77", 4028, 1, 9, 12, 'M'),
    ("G30 P99 S-5", 4024, 1, 9, 12, 'S'),
    ("G30 P99 S5.0", 4023, 1, 9, 13, 'S'),
    ("G30 P99 S0", 200, 1, 9, 11, 'S'),
    ("G30 P99 S3001", 200, 1, 9, 14, 'S'),
    ("M29 S9\nG84 Z-9 F9\nG30 P99", 4065, 3, 1, 4, 'G'),
    ("M29 S9\nG30 P99", 4065, 2, 1, 4, 'G'),
    ("G30 P99 S5\nM8\nG0 W5", 4083, 3, 4, 6, 'W'),
    ("G30 P99 S5\nG50 X5", 4083, 2, 5, 7, 'X'),
    ("G30 P99\nG2 I5", 4083, 2, 4, 6, 'I'),
];

#[test]
fn every_alarm_names_its_place() {
    for (text, number, line, column, end, word) in CASES {
        let alarm = alarm(text);
        let letter = alarm.word.map_or('-', char::from);
        assert_eq!(
            (alarm.number(), alarm.span, letter),
            (*number, span(*line, *column, *end), *word),
            "{text}"
        );
    }
}

#[test]
fn texts_have_the_figures_they_ask_for() {
    for (text, ..) in CASES {
        let alarm = alarm(text);
        for lang in [Lang::En, Lang::Zh] {
            let template = String::from_iter([alarm.code.cause(lang), alarm.code.help(lang)]);
            assert!(
                !template.contains("{w}") || alarm.word.is_some(),
                "{text}: {template}"
            );
            for (index, arg) in alarm.args.iter().enumerate() {
                let place = std::format!("{{{index}}}");
                assert!(
                    !template.contains(&place) || *arg != Arg::None,
                    "{text}: {template}"
                );
            }
        }
    }
}

#[test]
fn an_alarm_comes_before_any_call_of_its_block() {
    for (text, ..) in CASES {
        let text = std::format!("G0 X5 Z7\nG1 F1\n{text}");
        let (events, alarm) = read(&text);
        let Some(alarm) = alarm else { continue };
        for event in events {
            let Event::Call(call) = event else {
                panic!("{text}")
            };
            assert!(
                call.span.line < alarm.span.line || matches!(alarm.number(), 4007 | 4068),
                "{text}"
            );
        }
    }
}

#[test]
fn no_code_of_this_folder_is_left_out() {
    let provoked: BTreeSet<u16> = CASES.iter().map(|case| case.1).collect();
    // The length of a line, the warnings and what parameters refuse have tests of their own; what the tap journal
    // refuses has them with the journal, 0207 with the cycles.
    let elsewhere = [4006, 4080, 4081, 4082, 4900, 4901, 4902, 4909, 4910, 4911];
    for code in Code::ALL {
        let number = code.number();
        if (4001..4100).contains(&number)
            || (4900..4920).contains(&number)
            || (200..207).contains(&number)
            || (317..=320).contains(&number)
        {
            assert!(
                provoked.contains(&number) || elsewhere.contains(&number),
                "{code:?}"
            );
        }
    }
}

#[test]
fn figures_say_what_to_write() {
    assert_eq!(alarm("G76 Q.15").args[0], Arg::Int(1500));
    // A range is written as the word is: in increments where the word counts them.
    assert_eq!(
        alarm("G76 Q10000000").args[..2],
        [Arg::Decimal(0, 0), Arg::Decimal(9_999_999, 0)]
    );
    assert_eq!(alarm("G0 X1.00001").args[0], Arg::Decimal(1, 4));
    assert_eq!(
        alarm("G75 R100").args[..2],
        [Arg::Decimal(0, 4), Arg::Decimal(999_999, 4)]
    );
    assert_eq!(
        alarm("G3 X20 Z-10 K-9 F1").args[0],
        Arg::Length(Length::from_nm(1_049_875))
    );
    assert_eq!(alarm("G28 U0").args[0], Arg::GCode(280));
    assert_eq!(
        alarm("G76 G04 X1").args[..2],
        [Arg::GCode(760), Arg::GCode(40)]
    );
    assert_eq!(
        alarm("M3 S3001").args[..2],
        [Arg::Int(3001), Arg::Int(3000)]
    );
    // The range of a lead is that of the word, or of F where there is none.
    let lead = |unit, word| {
        let block = std::format!("G76 X60 Z-1 P1 Q1 {word}");
        alarm(&String::from_iter([unit, "G0 X80 Z10\n", &block])).args
    };
    let four = |low| Arg::Decimal(low, 4);
    assert_eq!(lead("", "F10000")[..2], [four(1), Arg::Decimal(9999, 0)]);
    assert_eq!(lead("", "I254.1")[..2], [four(1), Arg::Decimal(254, 0)]);
    assert_eq!(lead("", "")[..2], [four(1), Arg::Int(9999)]);
    assert_eq!(lead("G20 ", "I101")[..2], [four(1), Arg::Decimal(100, 0)]);
    let depth = alarm(&String::from_iter([AT, "G76 X60 Z-1 P36800 F1"]));
    assert_eq!((depth.args[0], depth.word), (Arg::Letter(b'Q'), None));
}
