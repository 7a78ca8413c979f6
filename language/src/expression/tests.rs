//! Expressions with known results, each mistake at its columns, and random trees calculated in another way.

mod trees;

use super::*;
use std::collections::HashMap;

/// Variables of a test; those that are missing do not exist.
#[derive(Debug, Default)]
pub struct Known(HashMap<i64, Value>);

impl Lookup for Known {
    fn look_up(&mut self, number: i64, span: Span) -> Result<Value, Alarm> {
        let alarm = Alarm::new(Code::VariableNumber, span).with([Arg::Int(number)]);
        self.0.get(&number).copied().ok_or(alarm)
    }
}

fn known() -> Known {
    Known(HashMap::from([
        (0, Value::Null),
        (1, Value::Number(2.0)),
        (2, Value::Number(-3.5)),
        (3, Value::Null),
        (4, Value::Increments(10.0)),
    ]))
}

fn calculate(text: &str, known: &mut Known) -> Result<Value, Alarm> {
    let mut cursor = Cursor::new(1, text.as_bytes(), 0);
    let value = Calculator::new(&mut cursor, known).sum()?;
    if !cursor.is_done() {
        return Err(cursor.alarm(Code::Formula));
    }
    Ok(value)
}

fn value(text: &str) -> f64 {
    match calculate(text, &mut known()) {
        Ok(Value::Number(number)) => number,
        other => panic!("{text}: {other:?}"),
    }
}

#[test]
fn printed_examples_have_their_results() {
    for (text, expected) in [
        ("2+3*4", 14.0),
        ("ROUND[-2.5]", -3.0),
        ("FIX[-2.7]", -2.0),
        ("FUP[-2.1]", -3.0),
        ("ATAN[1]/[-1]", 135.0),
        ("7MOD3", 1.0),
        ("1+6AND3", 3.0),
        ("5XOR3", 6.0),
    ] {
        assert_eq!(value(text), expected, "{text}");
    }
}

#[test]
fn operators_and_functions() {
    for (text, expected) in [
        ("-#1*3", -6.0),
        ("2*-3", -6.0),
        ("10-4-3", 3.0),
        ("8/4/2", 1.0),
        ("-7 MOD 4", -3.0),
        ("7.4MOD2.6", 1.0),
        ("12 AND 10 OR 1", 9.0),
        ("[1+2]*[3-1]", 6.0),
        ("##1+0", -3.5),
        ("#[1+1]+0", -3.5),
        ("sin[30] * 2", 1.0),
        ("COS[90]", 0.0),
        ("SIN[-180]", 0.0),
        ("TAN[45]-1", 0.0),
        ("TAN[-405]", -1.0),
        ("ASIN[1]", 90.0),
        ("ACOS[-1]", 180.0),
        ("ATAN[-1]", -45.0),
        ("ATAN[-1]/[1]", 315.0),
        ("ATAN[0]/[-5]", 180.0),
        ("ATAN[1,-1]", 135.0),
        ("ATAN[1]/3", 15.0),
        ("SQRT[2.25]", 1.5),
        ("ABS[#2]", 3.5),
        ("BIN[37]", 25.0),
        ("BCD[25]", 37.0),
        ("LN[EXP[2]]", 2.0),
        ("POW[2,10]", 1024.0),
        ("FUP[0.1]+FIX[1.9]", 2.0),
        ("ROUND[2.5]", 3.0),
        ("#3+1", 1.0),
        ("#4*2", 20.0),
        ("[#1EQ2]+[#1NE2]*10", 1.0),
        ("[[#1GT1]AND[#2LT0]]", 1.0),
        ("1. + .5 (a comment)", 1.5),
    ] {
        let found = value(text);
        assert!((found - expected).abs() < 1e-12, "{text}: {found}");
    }
}

#[test]
fn a_null_is_kept_until_something_is_calculated() {
    let all = |text| calculate(text, &mut known()).unwrap();
    assert_eq!(all("#0"), Value::Null);
    assert_eq!(all("[#3]"), Value::Null);
    assert_eq!(all("-#3"), Value::Number(0.0));
    assert_eq!(all("#3*5"), Value::Number(0.0));
    assert_eq!(all("#4"), Value::Increments(10.0));
    for (text, holds) in [
        ("[#3EQ0]", false),
        ("[#3NE0]", true),
        ("[#3EQ#0]", true),
        ("[#3NE#0]", false),
        ("[#3GE0]", true),
        ("[#3LE0]", true),
        ("[#3GT0]", false),
        ("[#3LT1]", true),
        ("[[0.1+0.2]EQ0.3]", true),
        ("[[0.1+0.2]GT0.3]", false),
        ("[[0.1+0.2]LE0.3]", true),
        ("[1EQ1.00001]", false),
    ] {
        assert_eq!(all(text).number() == 1.0, holds, "{text}");
    }
}

#[test]
fn round_in_a_word_keeps_the_decimals_of_its_increment() {
    let mut known = known();
    let mut rounded = |text: &str, decimals| {
        let mut cursor = Cursor::new(1, text.as_bytes(), 0);
        Calculator::in_word(&mut cursor, &mut known, decimals)
            .brackets()
            .unwrap()
            .number()
    };
    assert_eq!(rounded("[ROUND[1.23456]]", 3), 1.235);
    assert_eq!(rounded("[ROUND[-0.0005]]", 3), -0.001);
    assert_eq!(rounded("[ROUND[1.23456]]", 0), 1.0);
}

#[test]
fn a_mistake_is_told_at_its_columns() {
    let deep = |depth: usize| format!("{}1{}", "[".repeat(depth), "]".repeat(depth));
    assert_eq!(value(&deep(16)), 1.0);
    for (text, number, column, end) in [
        ("", 125, 1, 2),
        ("1+", 125, 3, 4),
        ("1+*2", 125, 3, 4),
        ("1 2", 125, 3, 4),
        ("[1+2", 125, 5, 6),
        ("1]", 125, 2, 3),
        ("1.2.3", 125, 1, 6),
        ("2+.", 125, 3, 4),
        ("SINE[1]", 125, 1, 5),
        ("2*sin 1", 125, 7, 8),
        ("#", 125, 2, 3),
        ("1+#1.5", 125, 3, 7),
        ("1+#77", 115, 3, 6),
        ("##2", 125, 1, 4),
        ("#[76+1]", 115, 1, 8),
        ("5/[#1-2]", 112, 2, 3),
        ("5MOD#0", 112, 2, 5),
        ("1+TAN[90]", 112, 3, 10),
        ("SQRT[-1]", 119, 1, 9),
        ("LN[0]", 119, 1, 6),
        ("ASIN[1.1]", 119, 1, 10),
        ("ATAN[0]/[0]", 119, 1, 12),
        ("BIN[10]", 119, 1, 8),
        ("BCD[-1]", 119, 1, 8),
        ("3000000000AND1", 119, 11, 14),
        ("POW[-1,.5]", 119, 1, 11),
        ("POW[2]", 125, 1, 7),
        ("EXP[1000]", 111, 1, 10),
        ("EXP[700]*EXP[700]", 111, 9, 10),
        ("[1LT2LT3]", 125, 6, 7),
        ("1EQ1", 125, 2, 3),
        (&deep(17), 118, 17, 18),
    ] {
        let alarm = calculate(text, &mut known()).expect_err(text);
        let Span {
            column: c, end: e, ..
        } = alarm.span;
        assert_eq!((alarm.number(), c, e), (number, column, end), "{text}");
    }
}

#[test]
fn the_tangent_and_the_sine_of_any_angle_are_those_of_the_angle() {
    for degrees in -1500..1500_i32 {
        let angle = f64::from(degrees) * 0.7;
        for (found, expected) in [
            (functions::sine(angle), angle.to_radians().sin()),
            (functions::cosine(angle), angle.to_radians().cos()),
        ] {
            assert!((found - expected).abs() < 1e-13, "{angle}");
        }
    }
    assert_eq!(functions::cosine(-270.0), 0.0);
    assert_eq!(functions::sine(450.0), 1.0);
    assert_eq!([30.0, 150.0, -390.0].map(functions::sine), [0.5, 0.5, -0.5]);
    assert_eq!(functions::cosine(60.0), 0.5);
    assert!((value("TAN[100]") - 100_f64.to_radians().tan()).abs() < 1e-12);
}

#[test]
fn bcd_goes_there_and_back() {
    for number in [0, 9, 10, 1234, 99_999_999] {
        let number = f64::from(number);
        assert_eq!(
            functions::to_bcd(number).and_then(functions::from_bcd),
            Ok(number)
        );
    }
    assert_eq!(functions::to_bcd(1e8), Err(Code::FunctionArgument));
}
