//! Which file a line is of: one number tells the file and the line in it.
//!
//! A place that goes to the board, and comes back in an alarm, is a line and two columns; there is no name of a file in it.
//! Subprograms may stand in files of their own, so the lines of such a file have numbers of their own, far above those of
//! the program's file [D240]. This module must not know where files are.

/// The highest O number that a file of its own can have: four digits are in its name.
pub const HIGHEST: u32 = 9_999;

/// Lines of such a file that have numbers of their own.
pub const LINES: u32 = 200_000;

/// The first number of a line that is not of the program's file.
const FIRST: u32 = 1 << 31;

/// A file of a program.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Whose {
    /// The one that was started.
    #[default]
    Program,
    /// That of the subprogram with this O number, 0 … [`HIGHEST`].
    Subprogram(u16),
}

impl Whose {
    /// The file that program `number` may have for itself; `None` where its name would need more than four digits.
    #[must_use]
    pub fn file_of(number: u32) -> Option<Self> {
        let number = u16::try_from(number).ok()?;
        (u32::from(number) <= HIGHEST).then_some(Self::Subprogram(number))
    }

    /// The file that a line is of.
    #[must_use]
    pub const fn line(line: u32) -> Self {
        match line.checked_sub(FIRST) {
            None => Self::Program,
            Some(beyond) => Self::Subprogram((beyond / LINES) as u16),
        }
    }

    /// The number of its first line.
    #[must_use]
    pub const fn first_line(self) -> u32 {
        match self {
            Self::Program => 1,
            Self::Subprogram(number) => FIRST + number as u32 * LINES,
        }
    }

    /// The number of the last line that is told apart; all that follow it have the same.
    #[must_use]
    pub const fn last_line(self) -> u32 {
        match self {
            Self::Program => FIRST - 1,
            Self::Subprogram(_) => self.first_line() + (LINES - 1),
        }
    }

    /// The name of a subprogram's file, such as `O0020.nc`.
    #[must_use]
    pub fn name(self) -> Option<String> {
        match self {
            Self::Program => None,
            Self::Subprogram(number) => Some(format!("O{number:04}.nc")),
        }
    }
}

/// The line in its file, from 1; 0 stays 0, which is no line.
#[must_use]
pub const fn line_in_file(line: u32) -> u32 {
    match Whose::line(line) {
        Whose::Program => line,
        file => line - file.first_line() + 1,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_line_of_every_file_has_a_number_of_its_own() {
        let mut last = Whose::Program.last_line();
        assert_eq!(
            (Whose::line(last), line_in_file(last)),
            (Whose::Program, last)
        );
        for number in 0..=HIGHEST {
            let file = Whose::file_of(number).unwrap();
            assert_eq!(file.first_line(), last + 1, "{number}");
            last = file.last_line();
            for (line, within) in [
                (file.first_line(), 1),
                (file.first_line() + 1, 2),
                (last, LINES),
            ] {
                assert_eq!((Whose::line(line), line_in_file(line)), (file, within));
            }
        }
        assert!(last < u32::MAX);
        assert_eq!(Whose::file_of(10_000), None);
        assert_eq!(Whose::file_of(65_536 + 20), None);
        assert_eq!(line_in_file(0), 0);
    }

    #[test]
    fn a_name_has_four_digits() {
        assert_eq!(Whose::Subprogram(20).name().as_deref(), Some("O0020.nc"));
        assert_eq!(Whose::Subprogram(9999).name().as_deref(), Some("O9999.nc"));
        assert_eq!(Whose::Program.name(), None);
    }
}
