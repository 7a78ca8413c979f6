//! A line that was typed on the panel: `leadscrew mdi` carries it out, in a process of its own. So does `leadscrew retract`
//! with the way out of a hole.
//!
//! So the panel goes on meanwhile, and what is checked and kept is the same wherever a line is typed [D323].

use leadscrew_core::alarm::Lang;
use serde_json::Value;

use super::super::own::{Handle, Own};
use super::view::Tone;
use crate::cli::Global;
use crate::words::{Both, both};

/// A line that is being carried out.
#[derive(Debug)]
pub struct Typed(Own);

/// What has become of it.
pub type Answer = (Both, Tone);

impl Typed {
    /// Begins a line; the answer is in this language.
    pub fn begin(global: &Global, line: &str, lang: Lang) -> std::io::Result<Self> {
        Own::begin(global, "mdi", &["--".into(), line.into()], lang).map(Self)
    }

    /// Begins the way out of a hole, at this speed of the spindle.
    pub fn retract(global: &Global, speed: Option<u32>, lang: Lang) -> std::io::Result<Self> {
        let speed = speed.map(|rpm| ["--speed".into(), rpm.to_string().into()]);
        let options: Vec<_> = speed.into_iter().flatten().collect();
        Own::begin(global, "retract", &options, lang).map(Self)
    }

    /// To end it before its time.
    pub fn handle(&self) -> Handle {
        self.0.handle.clone()
    }

    /// The answer, once the line has come to its end.
    pub fn answer(&self) -> Option<Answer> {
        Some(match self.0.ended()? {
            Ok(said) => read(&said),
            Err(error) => not_begun(&error),
        })
    }
}

/// A process that does not begin.
pub fn not_begun(error: &std::io::Error) -> Answer {
    let words = both!(
        "`leadscrew` does not begin: {error}",
        "无法启动 `leadscrew`：{error}"
    );
    (words, Tone::Bad)
}

fn unanswered() -> Both {
    both!(
        "`leadscrew` has ended without an answer",
        "`leadscrew` 未给出结果即结束"
    )
}

/// Reads the result: what is in force after the line, or why it was not carried out.
fn read(stdout: &[u8]) -> Answer {
    let value: Value = serde_json::from_slice(stdout).unwrap_or_default();
    let text = |value: &Value, key: &str| value[key].as_str().map(str::to_owned);
    if let Some(modal) = text(&value["after"], "modal").filter(|_| value["ok"] == true) {
        return (both!("done: {modal}", "完成：{modal}"), Tone::Good);
    }
    if value["ok"] == true && value["moves"].is_u64() {
        return (both!("done", "完成"), Tone::Good);
    }
    match why(&value) {
        Some(told) => (told, Tone::Care),
        None => (unanswered(), Tone::Bad),
    }
}

/// Why a line or a program was not carried out, as its result says: its alarms where it is wrong, else what has kept it
/// from being begun, or what is not kept of it; else what was warned of.
pub fn why(value: &Value) -> Option<Both> {
    let text = |value: &Value, key: &str| value[key].as_str().map(str::to_owned);
    let first = |key: &str| {
        let alarm = value[key].get(0)?;
        let (message, help) = (text(alarm, "message")?, text(alarm, "help")?);
        Some(format!("{:04} {message}; {help}", alarm["no"].as_u64()?))
    };
    let told = first("alarms").or_else(|| text(value, "error"));
    told.or_else(|| first("warnings")).map(Both::same)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_answer_is_what_is_in_force_or_why_nothing_was_done() {
        for (json, words, tone) in [
            (
                r#"{"ok":true,"after":{"modal":"G00"},"alarms":[]}"#,
                "done: G00",
                Tone::Good,
            ),
            (
                r#"{"ok":false,"after":{"modal":"G00"},"alarms":[{"no":4300,"message":"m","help":"h"}]}"#,
                "4300 m; h",
                Tone::Care,
            ),
            (
                r#"{"ok":false,"exit":3,"error":"no board"}"#,
                "no board",
                Tone::Care,
            ),
            (r#"{"ok":true,"moves":3}"#, "done", Tone::Good),
            ("", "`leadscrew` has ended without an answer", Tone::Bad),
        ] {
            let (told, is) = read(json.as_bytes());
            assert_eq!((told.en.as_str(), is), (words, tone), "{json}");
        }
    }
}
