//! Messages for a command line that cannot be read: in its language, and as the one result with `--json`. The English words
//! are the parser's.

use std::error::Error as _;
use std::ffi::OsString;
use std::io::{self, Write as _};
use std::process::ExitCode;

use clap::Error;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use leadscrew_can::WrongAddress;
use leadscrew_core::alarm::Lang;

use crate::diagnostics;
use crate::failure::Failure;
use crate::output;
use crate::values::Mistake;
use crate::words::{is_obeyed, plain};

/// Prints the requested help or version, or the mistake, and gives the exit code.
#[must_use]
pub fn report(error: &Error, typed: &[OsString]) -> ExitCode {
    if !error.use_stderr() || error.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand {
        let printed = error.print().and_then(|()| io::stdout().flush());
        return match printed {
            Err(unwritten) if !error.use_stderr() => {
                Failure::stdout(&unwritten).report(lang(typed), false)
            }
            // Standard error is closed: nobody can be told.
            _ => exit(error),
        };
    }
    let chinese = match lang(typed) {
        Lang::En => None,
        Lang::Zh => chinese(error),
    };
    match &chinese {
        Some(words) => {
            let _ = writeln!(
                io::stderr(),
                "错误：{}\n\n更多说明请用 `--help` 查看。",
                plain(words.clone())
            );
        }
        // The typed words are in the message.
        None if typed
            .iter()
            .any(|word| word.to_string_lossy().contains(is_obeyed)) =>
        {
            diagnostics::say(&error.render().to_string());
        }
        None => {
            let _ = error.print();
        }
    }
    if typed.iter().any(|word| word == "--json") {
        let words = chinese.unwrap_or_else(|| english(error));
        let _ = output::json(|o| {
            o.flag("ok", false);
            o.integer("exit", i64::from(error.exit_code()));
            o.text("error", &words);
        });
    }
    exit(error)
}

fn exit(error: &Error) -> ExitCode {
    u8::try_from(error.exit_code()).map_or(ExitCode::FAILURE, ExitCode::from)
}

/// The language that `--lang` names, wherever it stands. A command line that cannot be read, or asks for help, has no
/// parsed options.
#[must_use]
pub fn lang(typed: &[OsString]) -> Lang {
    let options = typed.split(|word| word == "--").next().unwrap_or_default();
    let two = options
        .windows(2)
        .any(|two| two[0] == "--lang" && two[1] == "zh");
    if two || options.iter().any(|word| word == "--lang=zh") {
        Lang::Zh
    } else {
        Lang::En
    }
}

/// The first paragraph of the parser's message, without its heading.
fn english(error: &Error) -> String {
    let text = error.render().to_string();
    let words = text.strip_prefix("error: ").unwrap_or(&text);
    let end = words.find("\n\n").unwrap_or(words.len());
    words[..end].trim_end().to_owned()
}

/// The same in Chinese; `None` where only the parser has words.
fn chinese(error: &Error) -> Option<String> {
    let of = |kind| {
        error.get(kind).map(|value| match value {
            ContextValue::String(text) => text.clone(),
            ContextValue::Strings(texts) => texts.join(" "),
            other => other.to_string(),
        })
    };
    let argument = || of(ContextKind::InvalidArg);
    let value = || of(ContextKind::InvalidValue).filter(|value| !value.is_empty());
    let hint = |kind| of(kind).map_or(String::new(), |hint| format!("；是否要写 `{hint}`？"));
    Some(match error.kind() {
        ErrorKind::InvalidValue => {
            let all =
                of(ContextKind::ValidValue).map_or(String::new(), |all| format!("；可用：{all}"));
            match value() {
                Some(value) => format!("`{}` 不能是 `{value}`{all}", argument()?),
                None => format!("`{}` 缺少值{all}", argument()?),
            }
        }
        ErrorKind::ValueValidation => {
            let value = value().unwrap_or_default();
            format!("`{}` 不能是 `{value}`：{}", argument()?, reason(error))
        }
        ErrorKind::UnknownArgument => {
            format!(
                "没有选项或参数 `{}`{}",
                argument()?,
                hint(ContextKind::SuggestedArg)
            )
        }
        ErrorKind::InvalidSubcommand => format!(
            "没有命令 `{}`{}",
            of(ContextKind::InvalidSubcommand)?,
            hint(ContextKind::SuggestedSubcommand)
        ),
        ErrorKind::MissingRequiredArgument => format!("缺少：{}", argument()?),
        ErrorKind::MissingSubcommand => "缺少命令".into(),
        ErrorKind::ArgumentConflict => match of(ContextKind::PriorArg) {
            Some(other) if Some(&other) != argument().as_ref() => {
                format!("`{}` 不能与 `{other}` 一起用", argument()?)
            }
            _ => format!("`{}` 只能写一次", argument()?),
        },
        ErrorKind::TooManyValues => format!("`{}` 的值太多：`{}`", argument()?, value()?),
        ErrorKind::TooFewValues | ErrorKind::WrongNumberOfValues => {
            format!("`{}` 的值的个数不对", argument()?)
        }
        ErrorKind::InvalidUtf8 => "命令行中有不是 UTF-8 的字符".into(),
        _ => return None,
    })
}

/// The reason why a value is refused: our words, or the parser's words for numbers.
fn reason(error: &Error) -> String {
    let Some(source) = error.source() else {
        return "无效".into();
    };
    if let Some(mistake) = source.downcast_ref::<Mistake>() {
        return mistake.0.zh.clone();
    }
    if let Some(wrong) = source.downcast_ref::<WrongAddress>() {
        return wrong.chinese().to_owned();
    }
    match source.to_string().split_once(" is not in ") {
        Some((_, range)) => format!("范围是 {}", range.replace("..=", " 至 ")),
        None => "不是这里可用的整数".into(),
    }
}
