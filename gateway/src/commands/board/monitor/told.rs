//! Alarms and events of a board's log, in words: what has happened, and what helps.

use std::path::Path;

use leadscrew_core::alarm::{Alarm, Lang};
use leadscrew_core::board::Event;
use leadscrew_core::link::Logged;

use super::view::Tone;
use crate::diagnostics::Diagnostic;
use crate::place::SourceLine;
use crate::source::SourceFile;
use crate::words::{both, pick};

/// One message.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Told {
    /// What has happened.
    pub text: String,
    /// What helps; empty where nothing has to.
    pub help: String,
    /// How it is meant.
    pub tone: Tone,
}

/// An entry of the log; `None` for what is shown elsewhere.
pub fn told(entry: &Logged, lang: Lang) -> Option<Told> {
    let plain = |en, zh| {
        Some(Told {
            text: pick(lang, en, zh).to_owned(),
            help: String::new(),
            tone: Tone::Plain,
        })
    };
    match &entry.event {
        Event::Alarm(alarm) => Some(of_alarm(alarm, Tone::Bad, lang)),
        Event::Warning(alarm) => Some(of_alarm(alarm, Tone::Care, lang)),
        Event::Refused(alarm) => {
            let told = of_alarm(alarm, Tone::Care, lang);
            let text = format!("{}{}", pick(lang, "refused: ", "已拒绝："), told.text);
            Some(Told { text, ..told })
        }
        Event::Finished => plain("program finished", "程序结束"),
        Event::Reset => plain("reset", "复位"),
        Event::Held => plain("feed hold", "进给保持"),
        _ => None,
    }
}

/// An alarm with its line, its cause and its remedy.
pub fn of_alarm(alarm: &Alarm, tone: Tone, lang: Lang) -> Told {
    let source = SourceFile::new(Path::new(""));
    let told = Diagnostic::new(alarm, &source, lang, false);
    let place = if alarm.span.line > 0 {
        let line = SourceLine(alarm.span.line);
        both!("line {line}: ", "第 {line} 行：")
            .get(lang)
            .to_owned()
    } else {
        String::new()
    };
    Told {
        text: format!("{place}{:04} {}", told.number, told.message),
        help: told.help,
        tone,
    }
}
