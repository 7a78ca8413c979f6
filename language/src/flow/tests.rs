//! Programs against the words that come out, in their order.

mod calls;
mod jumps;
mod macros_a;
mod random;

use super::*;
use crate::value::Value;
use crate::variables::Written;

/// Keeps what it is given, as text.
#[derive(Debug, Default)]
pub struct Recorder {
    /// `line:words`, one for each block that is not empty.
    pub heard: Vec<String>,
    pub notes: Vec<u16>,
    pub finished: bool,
}

impl Recorder {
    fn hear(&mut self, line: u32, text: &str) -> Done {
        let text = text.trim();
        if !text.is_empty() {
            self.heard.push(format!("{line}:{text}"));
        }
        Done {
            moved: text.contains(['X', 'Z']),
            ended: text.contains("M30"),
        }
    }
}

impl System for Recorder {
    fn read(&mut self, number: u32) -> Result<Option<Value>, Alarm> {
        Ok((number == 5001).then_some(Value::Number(self.heard.len() as f64)))
    }

    fn write(&mut self, number: u32, _value: Value) -> Written {
        if number == 5001 {
            Written::ReadOnly
        } else {
            Written::Unknown
        }
    }
}

impl Machine for Recorder {
    fn line(&mut self, line: u32, text: &[u8]) -> Result<Done, Alarm> {
        Ok(self.hear(line, &String::from_utf8_lossy(text)))
    }

    fn words(&mut self, line: u32, words: &[Word]) -> Result<Done, Alarm> {
        let word = |word: &Word| {
            let number = word.decimal(3, 3)?;
            let value = number.scaled(3).unwrap() as f64 / 1000.0;
            Some(format!("{}{value}", char::from(word.letter)))
        };
        let text: Vec<String> = words.iter().filter_map(word).collect();
        Ok(self.hear(line, &text.join(" ")))
    }

    fn decimals(&self, _letter: u8) -> u8 {
        3
    }

    fn note(&mut self, warning: Alarm) {
        self.notes.push(warning.number());
    }

    fn first_line(&mut self, _: Cycle, _: &[Word]) -> Result<(), Alarm> {
        Ok(())
    }

    fn contour_begins(&mut self, _: Cycle, _: &[Word], _: Span) -> Result<(), Alarm> {
        Ok(())
    }

    fn contour_ends(&mut self) -> Result<Done, Alarm> {
        Ok(Done::default())
    }

    fn finish(&mut self) -> Result<(), Alarm> {
        self.finished = true;
        Ok(())
    }
}

/// Runs a program to its end, or to its alarm.
pub fn run_with(text: &str, rules: Rules) -> (Recorder, Option<Alarm>) {
    let mut machine = Recorder::default();
    let mut flow = Flow::new(text.as_bytes(), Kept::default(), rules);
    for _ in 0..100_000 {
        match flow.step(&mut machine) {
            Ok(()) if flow.is_over() => return (machine, None),
            Ok(()) => {}
            Err(Trouble::Alarm(alarm)) => return (machine, Some(alarm)),
            Err(Trouble::Unreadable(error)) => panic!("{error}"),
        }
    }
    panic!("no end: {text}");
}

/// What a right program says, in one line.
pub fn run(text: &str) -> String {
    let (machine, alarm) = run_with(text, Rules::default());
    assert_eq!(alarm, None, "{text}");
    machine.heard.join(" | ")
}

/// The number, line, first column and column after the last of the alarm of a program.
pub fn refused(text: &str) -> (u16, u32, u16, u16) {
    let rules = Rules {
        budget: 1000,
        ..Rules::default()
    };
    let (_, alarm) = run_with(text, rules);
    let alarm = alarm.unwrap_or_else(|| panic!("no alarm: {text}"));
    let span = alarm.span;
    (alarm.number(), span.line, span.column, span.end)
}

#[test]
fn plain_lines_go_on_unchanged() {
    let text =
        "%\nO1 (A)\nN5 G0 X1 ; (b) Z2\n(c [\nO2 #) M8\nG1 X5; to the end\n; only a note\nM30\n";
    assert_eq!(
        run(text),
        "1:% | 2:O1 | 3:N5 G0 X1 ; (b) Z2 | 4:(c [ | 5:O2 #) M8 | 6:G1 X5 | 8:M30"
    );
}

#[test]
fn a_block_that_is_carried_out_alone_keeps_its_columns() {
    let mut machine = Recorder::default();
    let text = b"M8; G0 X5; #1=3; G1 Z7 (n)";
    let mut flow = Flow::new(&text[..], Kept::default(), Rules::default());
    struct Columns<'r>(&'r mut Recorder, Vec<usize>);
    impl System for Columns<'_> {
        fn read(&mut self, _: u32) -> Result<Option<Value>, Alarm> {
            Ok(None)
        }
        fn write(&mut self, _: u32, _: Value) -> Written {
            Written::Unknown
        }
    }
    impl Machine for Columns<'_> {
        fn line(&mut self, line: u32, text: &[u8]) -> Result<Done, Alarm> {
            self.1.extend(text.iter().position(|byte| *byte != b' '));
            self.0.line(line, text)
        }
        fn words(&mut self, line: u32, words: &[Word]) -> Result<Done, Alarm> {
            self.0.words(line, words)
        }
        fn decimals(&self, _: u8) -> u8 {
            3
        }
        fn note(&mut self, _: Alarm) {}
        fn first_line(&mut self, _: Cycle, _: &[Word]) -> Result<(), Alarm> {
            Ok(())
        }
        fn contour_begins(&mut self, _: Cycle, _: &[Word], _: Span) -> Result<(), Alarm> {
            Ok(())
        }
        fn contour_ends(&mut self) -> Result<Done, Alarm> {
            Ok(Done::default())
        }
        fn finish(&mut self) -> Result<(), Alarm> {
            Ok(())
        }
    }
    let mut columns = Columns(&mut machine, Vec::new());
    while !flow.is_over() {
        flow.step(&mut columns).unwrap();
    }
    assert_eq!(columns.1, [0, 4, 17]);
}

#[test]
fn values_are_calculated_where_they_stand() {
    assert_eq!(run("#1=5\n#2=#1*2\nN7 G0 X[#2+1] Z-#1"), "3:N7 G0 X11 Z-5");
    assert_eq!(run("G0 X 50 Z\t-2"), "1:G0 X50 Z-2");
    assert_eq!(run("#2=#0+1;#3=#0; G0 X10 Z#3"), "1:G0 X10");
    assert_eq!(run("G0 X1\nG0 X#5001"), "1:G0 X1 | 2:G0 X1");
    assert_eq!(run("#500=1;#[500+#500]=7;X#501"), "1:X7");
    assert_eq!(
        run("/G0 X1\n/2 G0 X2\n/#1=4\nX#1"),
        "1:/G0 X1 | 2:G0 X2 | 4:X4"
    );
}

#[test]
fn a_skip_may_stand_after_the_number_of_its_block() {
    assert_eq!(run("N5 /X[1+1]\nN6 /2 X[1+2]"), "1:N5 X2 | 2:N6 X3");
}

#[test]
fn a_skipped_block_is_not_carried_out() {
    let rules = Rules {
        skip: true,
        ..Rules::default()
    };
    let (machine, alarm) = run_with("/3 X[1/0]\n/#1=\nN5 /GOTO 7\n#1=2\nX#1", rules);
    assert_eq!((machine.heard.join("|"), alarm), ("5:X2".into(), None));
}

#[test]
fn a_stop_and_an_alarm_may_be_statements() {
    assert_eq!(run("X1;#3006=1(look)\nX2"), "1:X1 | 1:M0 | 2:X2");
    let (_, alarm) = run_with("X1\nIF[1EQ1]THEN#3000=12(TOO LONG)", Rules::default());
    let alarm = alarm.unwrap();
    assert_eq!((alarm.number(), alarm.args[0]), (3000, Arg::Int(3012)));
    assert_eq!((alarm.span.column, alarm.span.end), (13, 21));
}

#[test]
fn mistakes_are_told_at_their_columns() {
    for (text, expected) in [
        ("X1\n#1=1/0", (112, 2, 5, 6)),
        ("#5=", (125, 1, 4, 5)),
        ("#5 7", (114, 1, 4, 5)),
        ("#5=1 X3", (127, 1, 6, 7)),
        ("X3 #5=1", (127, 1, 4, 5)),
        ("G0 X1 GOTO 5", (127, 1, 7, 8)),
        ("#0=1", (116, 1, 1, 3)),
        ("#5001=1", (116, 1, 1, 6)),
        ("#34=1", (115, 1, 1, 4)),
        ("X#232", (115, 1, 2, 6)),
        ("#1=3 (open", (4007, 1, 6, 7)),
        ("IF#1EQ2", (114, 1, 3, 4)),
        ("IF[1EQ1] X5", (114, 1, 10, 11)),
        ("IF[1EQ1]THEN X5", (114, 1, 14, 15)),
    ] {
        assert_eq!(refused(text), expected, "{text}");
    }
}

#[test]
fn a_line_that_is_too_long_is_refused_where_it_must_be_read() {
    let text = format!("#1=1{}", " ".repeat(2000));
    assert_eq!(refused(&text), (4006, 1, 1025, 1026));
}
