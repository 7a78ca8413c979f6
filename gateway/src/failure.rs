//! Why a command did not end well, and the exit code of the contract for it.

use std::fmt;
use std::io::{self, Write as _};
use std::process::ExitCode;

/// A command's result.
pub type Outcome<T = ()> = Result<T, Failure>;

/// Why a command ended otherwise than well.
#[derive(Debug, PartialEq, Eq)]
pub enum Failure {
    /// The program or the parameters are wrong, or a check that was asked for has failed; the reasons have been
    /// reported.
    Wrong,
    /// The same, with the reason still to be told.
    WrongBecause(String),
    /// The command line asks for what cannot be: exit 2.
    Usage(String),
    /// The machine stopped on an alarm while running; the alarm has been reported.
    Machine,
    /// The user interrupted; the machine has been stopped.
    Interrupted,
    /// Whoever read standard output has had enough (`| head`).
    ReaderGone,
}

impl Failure {
    /// A file that could not be read or written.
    pub fn file(doing: &str, path: impl fmt::Display, error: &io::Error) -> Self {
        Self::Usage(format!("cannot {doing} `{path}`: {}", reason(error)))
    }

    /// Standard output that could not be written.
    pub fn stdout(error: &io::Error) -> Self {
        if error.kind() == io::ErrorKind::BrokenPipe {
            Self::ReaderGone
        } else {
            Self::file("write to", "standard output", error)
        }
    }

    /// Tells what is still to be told, and gives the exit code.
    pub fn report(&self) -> ExitCode {
        let (code, text) = match self {
            Self::Wrong => (1, None),
            Self::WrongBecause(text) => (1, Some(text.as_str())),
            Self::Usage(text) => (2, Some(text.as_str())),
            Self::Machine => (4, None),
            Self::Interrupted => (
                130,
                Some("interrupted; the machine has been brought to a stop"),
            ),
            Self::ReaderGone => (0, None),
        };
        if let Some(text) = text {
            // A closed standard error leaves nobody to tell.
            let _ = writeln!(io::stderr(), "error: {text}");
        }
        ExitCode::from(code)
    }
}

/// The system's words without its error number.
fn reason(error: &io::Error) -> String {
    match error.kind() {
        io::ErrorKind::NotFound => "there is no such file".into(),
        io::ErrorKind::PermissionDenied => "permission denied".into(),
        _ => error.to_string(),
    }
}
