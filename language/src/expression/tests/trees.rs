//! Random trees: each is printed with the brackets that it needs and calculated from the tree itself, so precedence,
//! order and brackets are told by something that has no parser.

use super::{Known, calculate};
use crate::expression::{DEPTH, functions};
use crate::random::Random;
use crate::value::Value;
use std::collections::HashMap;

#[derive(Clone, Debug)]
enum Tree {
    Literal(u32, u32),
    Variable(u8),
    Indirect(Box<Tree>),
    Minus(Box<Tree>),
    Function(usize, Box<Tree>),
    Arctangent(Box<Tree>, Box<Tree>),
    Two(usize, Box<Tree>, Box<Tree>),
    Compare(usize, Box<Tree>, Box<Tree>),
}

const FUNCTIONS: [&str; 12] = [
    "SIN", "COS", "ABS", "SQRT", "ROUND", "FIX", "FUP", "BIN", "BCD", "LN", "ASIN", "EXP",
];
const OPERATORS: [&str; 8] = ["*", "/", "MOD", "AND", "+", "-", "OR", "XOR"];
const COMPARISONS: [&str; 6] = ["EQ", "NE", "GT", "GE", "LT", "LE"];

/// The variables of every tree: 0 … 5; those from 4 on are null.
fn variables() -> Vec<Option<f64>> {
    vec![Some(1.0), Some(3.0), Some(-2.5), Some(100.25), None, None]
}

fn tree(random: &mut Random, size: u32) -> Tree {
    let part = |random: &mut Random| Box::new(tree(random, size.saturating_sub(1) / 2));
    if size == 0 {
        return match random.below(3) {
            0 => Tree::Variable(random.below(6) as u8),
            _ => Tree::Literal(random.below(400) as u32, random.below(3) as u32),
        };
    }
    match random.below(12) {
        0 => Tree::Minus(part(random)),
        1 | 2 => Tree::Function(random.below(FUNCTIONS.len()), part(random)),
        3 => Tree::Arctangent(part(random), part(random)),
        4 => Tree::Compare(random.below(6), part(random), part(random)),
        5 => Tree::Indirect(Box::new(Tree::Literal(random.below(6) as u32, 0))),
        _ => Tree::Two(random.below(8), part(random), part(random)),
    }
}

/// What a tree is worth; the error is the number of the alarm.
fn worth(tree: &Tree) -> Result<Option<f64>, u16> {
    let number = |tree: &Tree| worth(tree).map(|value| value.unwrap_or(0.0));
    let finite = |value: f64| {
        if value.is_finite() {
            Ok(Some(value))
        } else {
            Err(111)
        }
    };
    match tree {
        Tree::Literal(digits, decimals) => Ok(Some(literal(*digits, *decimals).parse().unwrap())),
        Tree::Variable(index) => Ok(variables()[usize::from(*index)]),
        Tree::Indirect(index) => {
            let index = number(index)?;
            Ok(variables()[index as usize])
        }
        Tree::Minus(inner) => Ok(Some(-number(inner)?)),
        Tree::Function(which, inner) => {
            let a = number(inner)?;
            finite(call(FUNCTIONS[*which], a)?)
        }
        Tree::Arctangent(above, below) => {
            let (a, b) = (number(above)?, number(below)?);
            if a == 0.0 && b == 0.0 {
                return Err(119);
            }
            let angle = libm::atan2(a, b).to_degrees();
            Ok(Some(if angle < 0.0 { angle + 360.0 } else { angle }))
        }
        Tree::Two(which, left, right) => {
            let (a, b) = (number(left)?, number(right)?);
            finite(operate(OPERATORS[*which], a, b)?)
        }
        Tree::Compare(which, left, right) => {
            let (left, right) = (worth(left)?, worth(right)?);
            let (a, b) = (left.unwrap_or(0.0), right.unwrap_or(0.0));
            let near = (a - b).abs() <= 1e-9 * a.abs().max(b.abs()).max(1.0);
            let equal = near && left.is_some() == right.is_some();
            let holds = match COMPARISONS[*which] {
                "EQ" => equal,
                "NE" => !equal,
                "GT" => !near && a > b,
                "GE" => near || a > b,
                "LT" => !near && a < b,
                _ => near || a < b,
            };
            Ok(Some(if holds { 1.0 } else { 0.0 }))
        }
    }
}

fn call(name: &str, a: f64) -> Result<f64, u16> {
    Ok(match name {
        // The sine by degrees has a test of its own, against the standard library.
        "SIN" => functions::sine(a),
        "COS" => functions::cosine(a),
        "ASIN" if a.abs() <= 1.0 => libm::asin(a).to_degrees(),
        "ABS" => a.abs(),
        "SQRT" if a >= 0.0 => a.sqrt(),
        "ROUND" => a.round(),
        "FIX" => a.abs().floor().copysign(a),
        "FUP" => a.abs().ceil().copysign(a),
        "BIN" => {
            let digits = whole(a).filter(|whole| (0..1 << 32).contains(whole));
            let text = format!("{:x}", digits.ok_or(119_u16)?);
            text.parse::<u32>().map_err(|_| 119_u16)?.into()
        }
        "BCD" => {
            let digits = whole(a).filter(|whole| (0..100_000_000).contains(whole));
            let text = digits.ok_or(119_u16)?.to_string();
            u32::from_str_radix(&text, 16).unwrap().into()
        }
        "LN" if a > 0.0 => libm::log(a),
        "EXP" => libm::exp(a),
        _ => return Err(119),
    })
}

/// The whole number next to `a`.
fn whole(a: f64) -> Option<i64> {
    let whole = a.round();
    (whole.abs() < 1e15).then_some(whole as i64)
}

fn operate(operator: &str, a: f64, b: f64) -> Result<f64, u16> {
    let bits = |number: f64| {
        let whole = whole(number).ok_or(119_u16)?;
        i32::try_from(whole).map_err(|_| 119_u16)
    };
    Ok(match operator {
        "*" => a * b,
        "/" if b == 0.0 => return Err(112),
        "/" => a / b,
        "MOD" => {
            let divisor = b.round();
            if divisor == 0.0 {
                return Err(112);
            }
            a.round() % divisor
        }
        "AND" => f64::from(bits(a)? & bits(b)?),
        "OR" => f64::from(bits(a)? | bits(b)?),
        "XOR" => f64::from(bits(a)? ^ bits(b)?),
        "+" => a + b,
        _ => a - b,
    })
}

fn literal(digits: u32, decimals: u32) -> String {
    match decimals {
        0 => digits.to_string(),
        1 => format!("{}.{}", digits / 10, digits % 10),
        _ => format!(".{digits:03}"),
    }
}

/// How tightly a printed tree holds together: 3 alone, 2 a product, 1 a sum, 0 a comparison.
fn bond(tree: &Tree) -> u8 {
    match tree {
        Tree::Two(which, ..) if *which < 4 => 2,
        Tree::Two(..) => 1,
        Tree::Compare(..) => 0,
        _ => 3,
    }
}

/// Prints a tree, and tells how deep its brackets are.
struct Printer<'r> {
    random: &'r mut Random,
    text: String,
    depth: u32,
    deepest: u32,
}

impl Printer<'_> {
    fn put(&mut self, part: &str) {
        let spaced = match self.random.below(12) {
            0 => " ",
            1 => " (a [ note) ",
            _ => "",
        };
        self.text.push_str(spaced);
        if self.random.below(4) == 0 {
            self.text.push_str(&part.to_lowercase());
        } else {
            self.text.push_str(part);
        }
    }

    fn bracketed(&mut self, tree: &Tree) {
        self.put("[");
        self.depth += 1;
        self.deepest = self.deepest.max(self.depth);
        self.print(tree, 0);
        self.depth -= 1;
        self.put("]");
    }

    /// Prints where something of at least this bond is wanted.
    fn print(&mut self, tree: &Tree, wanted: u8) {
        if bond(tree) < wanted || self.random.below(8) == 0 {
            return self.bracketed(tree);
        }
        match tree {
            Tree::Literal(digits, decimals) => {
                let text = literal(*digits, *decimals);
                self.put(&text);
            }
            Tree::Variable(index) => self.put(&format!("#{index}")),
            Tree::Indirect(index) => {
                self.put("#");
                self.bracketed(index);
            }
            Tree::Minus(inner) => {
                self.put("-");
                self.print(inner, 3);
            }
            Tree::Function(which, inner) => {
                self.put(FUNCTIONS[*which]);
                // What stands in a function is no comparison.
                if bond(inner) == 0 {
                    self.put("[");
                    self.depth += 1;
                    self.bracketed(inner);
                    self.depth -= 1;
                    self.put("]");
                } else {
                    self.argument(inner);
                }
            }
            Tree::Arctangent(above, below) => {
                self.put("ATAN");
                self.put("[");
                self.depth += 1;
                self.deepest = self.deepest.max(self.depth);
                self.print(above, 1);
                self.depth -= 1;
                self.put("]");
                self.put("/");
                self.bracketed(below);
            }
            Tree::Two(which, left, right) => {
                let own = bond(tree);
                self.print(left, own);
                self.put(OPERATORS[*which]);
                self.print(right, own + 1);
            }
            Tree::Compare(which, left, right) => {
                self.print(left, 1);
                self.put(COMPARISONS[*which]);
                self.print(right, 1);
            }
        }
    }

    fn argument(&mut self, inner: &Tree) {
        self.put("[");
        self.depth += 1;
        self.deepest = self.deepest.max(self.depth);
        self.print(inner, 1);
        self.depth -= 1;
        self.put("]");
    }
}

/// Prints a tree as the right side of an assignment, with the depth of its brackets.
fn printed(random: &mut Random, tree: &Tree) -> (String, u32) {
    let mut printer = Printer {
        random,
        text: String::new(),
        depth: 0,
        deepest: 0,
    };
    printer.print(tree, 1);
    (printer.text, printer.deepest)
}

#[test]
fn random_trees_are_worth_what_their_texts_are() {
    let count = leadscrew_seed::amount(4_000, 60_000);
    let values = (0_i64..).zip(variables());
    let mut known =
        Known(HashMap::from_iter(values.map(|(number, value)| {
            (number, value.map_or(Value::Null, Value::Number))
        })));
    leadscrew_seed::volume(7, |seed| {
        let mut random = Random(seed);
        let (mut numbers, mut refused) = (0, 0);
        for _ in 0..count {
            let size = random.below(40) as u32;
            let tree = tree(&mut random, size);
            let (text, deepest) = printed(&mut random, &tree);
            if deepest > DEPTH {
                continue;
            }
            let found = calculate(&text, &mut known);
            let shown = || format!("{text}: {found:?}");
            match worth(&tree) {
                Ok(expected) => {
                    numbers += 1;
                    let found = found.as_ref().unwrap_or_else(|_| panic!("{}", shown()));
                    let bits = |value: f64| (value + 0.0).to_bits();
                    match expected {
                        None => assert!(found.is_null(), "{}", shown()),
                        Some(number) => {
                            assert!(!found.is_null(), "{}", shown());
                            assert_eq!(bits(found.number()), bits(number), "{}", shown());
                        }
                    }
                }
                Err(_) => {
                    refused += 1;
                    assert!(found.is_err(), "{}", shown());
                }
            }
        }
        assert!(
            numbers > count / 4 && refused > count / 50,
            "{numbers} {refused}"
        );
    });
}
