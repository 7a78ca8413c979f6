//! Random programs of loops, branches and calls: what comes out against the same program carried out as a tree.

use std::collections::HashMap;

use super::{Rules, run_with};
use crate::random::Random;

/// Programs of one text: the main program, and subprograms that call later ones only.
const PROGRAMS: usize = 4;
/// The most that a program may say; what says more is left out.
const MOST: usize = 3000;

#[derive(Clone, Debug)]
enum Node {
    /// `X#v`
    Say(u32),
    /// `#v=#w+k`
    Set(u32, u32, i32),
    /// A loop with a counter of its own, so often.
    Loop(u32, Vec<Node>),
    /// `IF[#v LT k]`
    Branch(u32, i32, Vec<Node>, Vec<Node>),
    /// `M98 P L`
    Subprogram(usize, u32),
    /// `G65 P A#v B k`
    Macro(usize, u32, i32),
}

/// A variable: a local or a common one.
fn variable(random: &mut Random) -> u32 {
    [1, 2, 3, 101, 102][random.below(5)]
}

fn nodes(random: &mut Random, program: usize, loops: u32, size: usize) -> Vec<Node> {
    let count = 1 + random.below(size.max(1));
    let one = |random: &mut Random| {
        let (v, k) = (variable(random), random.below(7) as i32 - 2);
        let inner = |random: &mut Random, loops| nodes(random, program, loops, size / 2);
        let later = program + 1 + random.below(PROGRAMS);
        match random.below(10) {
            0 | 1 if loops < 3 && size > 0 => {
                Node::Loop(random.below(4) as u32, inner(random, loops + 1))
            }
            2 | 3 if size > 0 => Node::Branch(v, k, inner(random, loops), inner(random, loops)),
            4 if later < PROGRAMS => Node::Subprogram(later, 1 + random.below(2) as u32),
            5 if later < PROGRAMS => Node::Macro(later, v, k),
            6 | 7 => Node::Set(v, variable(random), k),
            _ => Node::Say(v),
        }
    };
    (0..count).map(|_| one(random)).collect()
}

/// Writes programs as text.
struct Writer<'r> {
    random: &'r mut Random,
    text: String,
    labels: u32,
}

impl Writer<'_> {
    fn put(&mut self, block: &str) {
        self.text.push_str(block);
        let end = ["\n", "\n", ";", " ; ", "\n(N1 GOTO 1)\n", " (a) \n\n"][self.random.below(6)];
        self.text.push_str(end);
    }

    fn program(&mut self, program: usize, loops: u32, all: &[Node]) {
        for node in all {
            match node {
                Node::Say(v) => self.put(&format!("X#{v}")),
                Node::Set(v, w, k) => self.put(&format!("#{v}=#{w}+[{k}]")),
                Node::Loop(times, body) => {
                    let (counter, number) = (counter(program, loops), loops + 1);
                    self.put(&format!("#{counter}=0"));
                    self.put(&format!("WHILE[#{counter}LT{times}]DO{number}"));
                    self.program(program, loops + 1, body);
                    self.put(&format!("#{counter}=#{counter}+1"));
                    self.put(&format!("END{number}"));
                }
                Node::Branch(v, k, then, other) => {
                    let (first, second) = (self.labels, self.labels + 1);
                    self.labels += 2;
                    self.put(&format!("IF[#{v}LT{k}]GOTO {first}"));
                    self.program(program, loops, other);
                    self.put(&format!("GOTO[{second}]"));
                    self.put(&format!("N{first}"));
                    self.program(program, loops, then);
                    self.put(&format!("N{second}"));
                }
                Node::Subprogram(called, passes) => {
                    let number = called + 10;
                    if self.random.below(2) == 0 {
                        self.put(&format!("M98 P{number} L{passes}"));
                    } else {
                        self.put(&format!("M98 P{passes}{number:04}"));
                    }
                }
                Node::Macro(called, v, k) => {
                    self.put(&format!("G65 P{} A#{v} B{k}", called + 10));
                }
            }
        }
    }
}

/// Each loop of each program counts in a variable of its own.
fn counter(program: usize, loops: u32) -> u32 {
    21 + 3 * program as u32 + loops
}

/// Carries the tree out.
#[derive(Default)]
struct Walker {
    locals: Vec<HashMap<u32, f64>>,
    common: HashMap<u32, f64>,
    said: Vec<f64>,
    steps: usize,
}

impl Walker {
    fn get(&self, v: u32) -> Option<f64> {
        let known = if v > 100 {
            &self.common
        } else {
            self.locals.last().unwrap()
        };
        known.get(&v).copied()
    }

    fn walk(&mut self, programs: &[Vec<Node>], all: &[Node]) {
        for node in all {
            self.steps += 1;
            if self.steps > MOST {
                return;
            }
            match node {
                Node::Say(v) => self.said.extend(self.get(*v)),
                Node::Set(v, w, k) => {
                    let value = self.get(*w).unwrap_or(0.0) + f64::from(*k);
                    let known = if *v > 100 {
                        &mut self.common
                    } else {
                        self.locals.last_mut().unwrap()
                    };
                    known.insert(*v, value);
                }
                Node::Loop(times, body) => {
                    for _ in 0..*times {
                        self.walk(programs, body);
                    }
                }
                Node::Branch(v, k, then, other) => {
                    let less = self.get(*v).unwrap_or(0.0) < f64::from(*k);
                    self.walk(programs, if less { then } else { other });
                }
                Node::Subprogram(called, passes) => {
                    for _ in 0..*passes {
                        self.walk(programs, &programs[*called]);
                    }
                }
                Node::Macro(called, v, k) => {
                    let mut locals = HashMap::from([(2, f64::from(*k))]);
                    locals.extend(self.get(*v).map(|value| (1, value)));
                    self.locals.push(locals);
                    self.walk(programs, &programs[*called]);
                    self.locals.pop();
                }
            }
        }
    }
}

#[test]
fn random_programs_say_what_their_trees_say() {
    let count = leadscrew_seed::amount(600, 8_000);
    leadscrew_seed::volume(11, |seed| {
        let mut random = Random(seed);
        let (mut tried, mut words) = (0, 0);
        for _ in 0..count {
            let programs: Vec<Vec<Node>> = (0..PROGRAMS)
                .map(|program| nodes(&mut random, program, 0, 8))
                .collect();
            let mut walker = Walker {
                locals: vec![HashMap::new()],
                ..Walker::default()
            };
            walker.walk(&programs, &programs[0]);
            if walker.steps > MOST {
                continue;
            }
            let mut writer = Writer {
                random: &mut random,
                text: String::from("%\nO1\n"),
                labels: 100,
            };
            for (program, all) in programs.iter().enumerate() {
                if program > 0 {
                    writer.text += &format!("\nO{:04}\n", program + 10);
                }
                writer.program(program, 0, all);
                writer.text += if program == 0 { "\nM30\n" } else { "\nM99\n" };
            }
            let (machine, alarm) = run_with(&writer.text, Rules::default());
            assert_eq!(alarm, None, "{}", writer.text);
            let said: Vec<f64> = machine
                .heard
                .iter()
                .filter_map(|block| block.split_once('X')?.1.parse().ok())
                .collect();
            assert_eq!(said, walker.said, "{}", writer.text);
            tried += 1;
            words += said.len();
        }
        assert!(tried > count / 2 && words > count, "{tried} {words}");
    });
}
