//! Why a command did not end well, and the exit code of the contract for it.

use std::fmt;
use std::io::{self, Write as _};
use std::process::ExitCode;

use leadscrew_can::CanError;
use leadscrew_core::alarm::Lang;

use crate::words::{Both, both, pick};

/// A command's result.
pub type Outcome<T = ()> = Result<T, Failure>;

/// Why a command ended otherwise than well.
#[derive(Debug, PartialEq, Eq)]
pub enum Failure {
    /// The program or the parameters are wrong, or a check that was asked for has failed; the reasons have been
    /// reported.
    Wrong,
    /// The same, with the reason still to be told.
    WrongBecause(Both),
    /// The command line asks for what cannot be: exit 2.
    Usage(Both),
    /// No bus, no board, or the link was lost: exit 3.
    Bus(Both),
    /// The machine stopped on an alarm while running; the alarm has been reported.
    Machine,
    /// The same, with the reason still to be told.
    MachineBecause(Both),
    /// The user interrupted; the machine has been stopped.
    Interrupted,
    /// Whoever read standard output has had enough (`| head`).
    ReaderGone,
}

impl Failure {
    /// A file that could not be read or written.
    pub fn file(doing: Doing, path: impl fmt::Display, error: &io::Error) -> Self {
        let reason = reason(error);
        let doing = doing.words();
        Self::Usage(both!(
            "cannot {en} `{path}`: {why}",
            "无法{zh} `{path}`：{reason}",
            en = doing.en,
            zh = doing.zh,
            why = reason.en,
            reason = reason.zh
        ))
    }

    /// A bus that cannot be used, or no longer.
    #[must_use]
    pub fn bus(error: CanError) -> Self {
        Self::Bus(Both {
            en: error.to_string(),
            zh: error.chinese(),
        })
    }

    /// Standard output that could not be written.
    pub fn stdout(error: &io::Error) -> Self {
        if error.kind() == io::ErrorKind::BrokenPipe {
            Self::ReaderGone
        } else {
            let reason = reason(error);
            Self::Usage(both!(
                "cannot write to standard output: {why}",
                "无法写入标准输出：{reason}",
                why = reason.en,
                reason = reason.zh
            ))
        }
    }

    /// Tells what is still to be told, and gives the exit code.
    pub fn report(&self, lang: Lang) -> ExitCode {
        let (code, text) = match self {
            Self::Wrong => (1, None),
            Self::WrongBecause(text) => (1, Some(text.get(lang))),
            Self::Usage(text) => (2, Some(text.get(lang))),
            Self::Bus(text) => (3, Some(text.get(lang))),
            Self::Machine => (4, None),
            Self::MachineBecause(text) => (4, Some(text.get(lang))),
            Self::Interrupted => (
                130,
                Some(pick(
                    lang,
                    "interrupted; the machine has been brought to a stop",
                    "已中断；机床已停稳",
                )),
            ),
            Self::ReaderGone => (0, None),
        };
        if let Some(text) = text {
            // A closed standard error leaves nobody to tell.
            let _ = writeln!(io::stderr(), "{}{text}", pick(lang, "error: ", "错误："));
        }
        ExitCode::from(code)
    }
}

/// What was being done with a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Doing {
    /// Reading it.
    Read,
    /// Writing it.
    Write,
}

impl Doing {
    fn words(self) -> Both {
        match self {
            Self::Read => both!("read", "读取"),
            Self::Write => both!("write", "写入"),
        }
    }
}

/// The system's words without its error number.
fn reason(error: &io::Error) -> Both {
    match error.kind() {
        io::ErrorKind::NotFound => both!("there is no such file", "没有这个文件"),
        io::ErrorKind::PermissionDenied => both!("permission denied", "没有权限"),
        io::ErrorKind::IsADirectory => both!("is a directory", "这是一个文件夹"),
        _ => Both::same(error.to_string()),
    }
}
