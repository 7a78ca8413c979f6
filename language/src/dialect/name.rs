//! `(DIALECT FANUC-B)` in front of a program.

use super::Control;

/// What a line says of its control.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Named {
    /// Nothing.
    Nothing,
    /// A control that is known.
    Control(Control),
    /// A name that is none; its bytes in the line.
    Unknown {
        /// Where it begins.
        from: usize,
        /// Where it ends.
        to: usize,
    },
}

/// Reads the comment of a line.
#[must_use]
pub fn named(line: &[u8]) -> Named {
    const WORD: &[u8] = b"DIALECT";
    let is = |window: &[u8]| window.eq_ignore_ascii_case(WORD);
    let Some(at) = line.windows(WORD.len()).position(is) else {
        return Named::Nothing;
    };
    let opens = line[..at].trim_ascii_end().ends_with(b"(");
    let after = at + WORD.len();
    let rest = &line[after..];
    if !opens || !rest.first().is_some_and(u8::is_ascii_whitespace) {
        return Named::Nothing;
    }
    let Some(close) = rest.iter().position(|byte| *byte == b')') else {
        return Named::Nothing;
    };
    let name = rest[..close].trim_ascii();
    let from = after + (rest.len() - rest.trim_ascii_start().len()).min(close);
    let control = std::str::from_utf8(name).ok().and_then(Control::of_name);
    control.map_or(
        Named::Unknown {
            from,
            to: from + name.len(),
        },
        Named::Control,
    )
}
