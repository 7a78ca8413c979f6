//! Programs of a file that stand behind the end of the one that was carried out, and are programs of their own.
//!
//! This module must not know what the program does.

use std::io;

use leadscrew_core::alarm::{Alarm, Arg, Code};

use crate::dialect::written;
use crate::lines::{Lines, Source};
use crate::outline::Scanner;
use crate::text::piece;
use crate::whose::Whose;

/// The first program behind a line that ends itself with M30 or M02, as a subprogram does not [D444].
///
/// # Errors
/// The text cannot be read.
pub fn not_carried_out<S: Source>(lines: &mut Lines<S>, line: u32) -> io::Result<Option<Alarm>> {
    let mut scanner = Scanner::of(Whose::Program);
    let mut program = None;
    while let Some(block) = scanner.next(lines)? {
        if block.place.line <= line {
            continue;
        }
        program = block.program.map(|number| (number, block.span)).or(program);
        let (Some((number, span)), Some(read)) = (program, lines.line(block.place)?) else {
            continue;
        };
        let end = piece(read.text, block.place.column).end;
        let text = read.text.get(block.place.column..end).unwrap_or_default();
        if written(text).any(|word| matches!(word, (b'M', 2.0 | 30.0))) {
            let number = [Arg::Int(i64::from(number))];
            return Ok(Some(Alarm::new(Code::ProgramBehind, span).with(number)));
        }
    }
    Ok(None)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_program_with_an_end_of_its_own_is_told() {
        let told = |text: &str, line| {
            let told = not_carried_out(&mut Lines::new(text.as_bytes()), line).expect("a text");
            told.map(|alarm| (alarm.number(), alarm.span.line, alarm.args[0]))
        };
        let text = "O1\nG0 X5\nM30\nO2\nG0 X6\nM99\nO3\nG0 X7 (M30)\nM02\n";
        assert_eq!(told(text, 3), Some((4977, 7, Arg::Int(3))));
        assert_eq!(told(text, 9), None);
        // A subprogram, and what stands behind the end without a number.
        assert_eq!(told("O1\nM30\nO2\nG0 X6\nM99\n", 2), None);
        assert_eq!(told("O1\nM30\nG0 X6\nM30\n", 2), None);
        assert_eq!(told("O1\nM30\n%\nO2\nM30\n", 2), None);
    }
}
