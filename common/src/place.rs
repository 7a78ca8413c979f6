//! The line of a place as people and other programs read it: alone in the program's file, with the name of the file in a
//! subprogram's own.

use std::fmt;

use leadscrew_language::whose::{Whose, line_in_file};

use crate::json::Json;

/// A line as the machine counts it ([`Whose`]): shown as `7`, or `O0020.nc:7`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SourceLine(pub u32);

impl SourceLine {
    /// The line in its file.
    #[must_use]
    pub const fn in_file(self) -> u32 {
        line_in_file(self.0)
    }

    /// The name of the subprogram's own file that it is in.
    #[must_use]
    pub fn file(self) -> Option<String> {
        Whose::line(self.0).name()
    }

    /// `line`, and `file` where it is in a subprogram's own file.
    pub fn fields(self, json: &mut Json) {
        json.number("line", self.in_file());
        if let Some(file) = self.file() {
            json.text("file", &file);
        }
    }
}

impl fmt::Display for SourceLine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(file) = self.file() {
            write!(f, "{file}:")?;
        }
        write!(f, "{}", self.in_file())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_of_another_file_has_its_name() {
        let within = Whose::Subprogram(20).first_line() + 6;
        assert_eq!(SourceLine(7).to_string(), "7");
        assert_eq!(SourceLine(within).to_string(), "O0020.nc:7");
        let written = |line: u32| {
            let mut json = Json::new();
            json.object(|json| SourceLine(line).fields(json));
            String::from_utf8(json.into_bytes()).unwrap()
        };
        assert_eq!(written(7), r#"{"line":7}"#);
        assert_eq!(written(within), r#"{"line":7,"file":"O0020.nc"}"#);
    }
}
