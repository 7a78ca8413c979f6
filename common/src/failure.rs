//! The reasons for which a command ends badly, with their exit codes.

use std::fmt;
use std::io::{self, Write as _};
use std::process::ExitCode;

use leadscrew_can::CanError;
use leadscrew_core::alarm::Lang;
use leadscrew_language::lines::LONGEST;

use crate::json::Json;
use crate::output;
use crate::words::{Both, both, one_line, pick, plain};

/// A command's result.
pub type Outcome<T = ()> = Result<T, Failure>;

/// The reason for which a command did not end well.
#[derive(Debug, PartialEq, Eq)]
pub enum Failure {
    /// The program or the parameters are wrong, or a requested check has failed. The reasons have been reported.
    Wrong,
    /// The same, with a reason that is still to be reported.
    WrongBecause(Both),
    /// The command line asks for something impossible: exit 2.
    Usage(Both),
    /// No bus, no board, or the link was lost: exit 3.
    Bus(Both),
    /// The machine stopped on an alarm while running; the alarm has been reported.
    Machine,
    /// The same, with a reason that is still to be reported.
    MachineBecause(Both),
    /// The user interrupted; the machine has been stopped.
    Interrupted,
    /// The user interrupted a command that moves nothing.
    Ended,
    /// The reader of standard output is gone (`| head`).
    ReaderGone,
}

impl Failure {
    /// The exit code of an interruption by any signal.
    pub const INTERRUPTED: u8 = 130;

    /// A file that could not be read or written.
    pub fn file(doing: Doing, path: impl fmt::Display, error: &io::Error) -> Self {
        let reason = reason(error, doing);
        let doing = doing.words();
        let path = one_line(&path.to_string());
        Self::Usage(both!(
            "cannot {en} `{path}`: {why}",
            "无法{zh} `{path}`：{reason}",
            en = doing.en,
            zh = doing.zh,
            why = reason.en,
            reason = reason.zh
        ))
    }

    /// A bus that cannot be used, or cannot be used any more.
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
            let reason = reason(error, Doing::Write);
            Self::Usage(both!(
                "cannot write to standard output: {why}",
                "无法写入标准输出：{reason}",
                why = reason.en,
                reason = reason.zh
            ))
        }
    }

    /// The same failure with more to say about it, where its words are still to be reported.
    #[must_use]
    pub fn and(self, more: &Both) -> Self {
        let join = |words: Both| Both {
            en: words.en + &more.en,
            zh: words.zh + &more.zh,
        };
        match self {
            Self::WrongBecause(words) => Self::WrongBecause(join(words)),
            Self::Bus(words) => Self::Bus(join(words)),
            other => other,
        }
    }

    /// The words that are still to be reported, for a process that reports them elsewhere.
    #[must_use]
    pub fn words(self) -> Option<Both> {
        match self {
            Self::WrongBecause(words)
            | Self::Usage(words)
            | Self::Bus(words)
            | Self::MachineBecause(words) => Some(words),
            Self::Wrong | Self::Machine | Self::Interrupted | Self::Ended | Self::ReaderGone => {
                None
            }
        }
    }

    /// The exit code, and the words that are still to be reported.
    fn told(&self, lang: Lang) -> (u8, Option<&str>) {
        match self {
            Self::Wrong => (1, None),
            Self::WrongBecause(text) => (1, Some(text.get(lang))),
            Self::Usage(text) => (2, Some(text.get(lang))),
            Self::Bus(text) => (3, Some(text.get(lang))),
            Self::Machine => (4, None),
            Self::MachineBecause(text) => (4, Some(text.get(lang))),
            Self::Ended => (Self::INTERRUPTED, Some(pick(lang, "interrupted", "已中断"))),
            Self::Interrupted => (
                Self::INTERRUPTED,
                Some(pick(
                    lang,
                    "interrupted; the machine has been brought to a stop",
                    "已中断；机床已停稳",
                )),
            ),
            Self::ReaderGone => (0, None),
        }
    }

    /// `ok`, `exit` and `error` of a result that is this failure.
    pub fn fields(&self, lang: Lang, json: &mut Json) {
        let (code, text) = self.told(lang);
        json.flag("ok", false);
        json.integer("exit", i64::from(code));
        if let Some(text) = text {
            json.text("error", text);
        }
    }

    /// Reports the rest and gives the exit code. `json`: the reader of standard output wants one result; this failure is
    /// the result where nothing was written there.
    pub fn report(&self, lang: Lang, json: bool) -> ExitCode {
        let code = self.tell(lang);
        if json && *self != Self::ReaderGone && !output::is_written() {
            // A failing standard output has been reported, or is the failure itself.
            let _ = output::json(|json| self.fields(lang, json));
        }
        ExitCode::from(code)
    }

    /// The same, as the last report of this process, which may be in the middle of another report: that report is finished
    /// first.
    pub fn report_last(&self, lang: Lang, json: bool) {
        self.tell(lang);
        if json {
            output::last_json(|json| self.fields(lang, json));
        }
    }

    /// Reports it to a person.
    fn tell(&self, lang: Lang) -> u8 {
        let (code, text) = self.told(lang);
        if let Some(text) = text {
            // Standard error is closed: nobody can be told.
            let text = plain(text.to_owned());
            let _ = writeln!(io::stderr(), "{}{text}", pick(lang, "error: ", "错误："));
        }
        code
    }
}

/// An action on a file.
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

/// The reason for which a file is refused, where the system has no words for it.
#[derive(Debug)]
struct Unreadable(Both);

impl fmt::Display for Unreadable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0.en)
    }
}

impl std::error::Error for Unreadable {}

/// An error of reading with words of its own.
#[must_use]
pub fn unreadable(why: Both) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, Unreadable(why))
}

/// The same for another file than the one that is being read; {0} says which.
#[must_use]
pub fn unreadable_part(path: &str, error: &io::Error) -> io::Error {
    let why = reason(error, Doing::Read);
    let path = one_line(path);
    unreadable(both!(
        "its subprogram `{path}`: {en}",
        "其子程序 `{path}`：{zh}",
        en = why.en,
        zh = why.zh
    ))
}

/// The system's words without its error number.
fn reason(error: &io::Error, doing: Doing) -> Both {
    let inner = error.get_ref().and_then(|inner| inner.downcast_ref());
    if let Some(Unreadable(why)) = inner {
        return why.clone();
    }
    match (error.kind(), doing) {
        (io::ErrorKind::NotFound, Doing::Read) => both!("there is no such file", "没有这个文件"),
        // A file that is written need not exist. The folder for it is missing.
        (io::ErrorKind::NotFound, Doing::Write) => {
            both!("there is no such folder", "没有这个文件夹")
        }
        (io::ErrorKind::PermissionDenied, _) => both!("permission denied", "没有权限"),
        (io::ErrorKind::IsADirectory, _) => both!("is a directory", "这是一个文件夹"),
        (io::ErrorKind::NotADirectory, _) => {
            both!(
                "what should be a folder is a file",
                "路径中有一段不是文件夹"
            )
        }
        (io::ErrorKind::FileTooLarge, Doing::Read) => both!(
            "{mb} MB without the end of a line are no program",
            "{mb} MB 内没有换行，这不是程序",
            mb = LONGEST >> 20
        ),
        (io::ErrorKind::StorageFull, _) => both!("no space is left there", "存储空间已满"),
        (io::ErrorKind::ReadOnlyFilesystem, _) => {
            both!("nothing can be written there", "该处只读，不能写入")
        }
        _ => {
            let words = error.to_string();
            let end = words.find(" (os error").unwrap_or(words.len());
            Both::same(&words[..end])
        }
    }
}
