//! A line that was typed on the panel: `leadscrew mdi` carries it out, in a process of its own.
//!
//! So the panel goes on meanwhile, and what is checked and kept is the same wherever a line is typed [D323].

use std::process::{Command, Output, Stdio};
use std::sync::mpsc::{Receiver, TryRecvError, channel};

use leadscrew_core::alarm::Lang;
use serde_json::Value;

use super::view::Tone;
use crate::cli::Global;
use crate::words::{Both, both, pick};

/// A line that is being carried out.
#[derive(Debug)]
pub struct Typed {
    ended: Receiver<std::io::Result<Output>>,
}

/// What has become of it.
pub type Answer = (Both, Tone);

impl Typed {
    /// Begins a line; the answer is in this language.
    pub fn begin(global: &Global, line: &str, lang: Lang) -> std::io::Result<Self> {
        let mut command = Command::new(std::env::current_exe()?);
        command
            .args(["mdi", "--json", "--bus", &global.bus.to_string()])
            .args(["--lang", pick(lang, "en", "zh")]);
        if let Some(node) = global.node {
            command.args(["--node", &node.to_string()]);
        }
        if let Some(rate) = global.bitrate {
            let kbit = rate.bits_per_second() / 1_000;
            command.args(["--bitrate", &kbit.to_string()]);
        }
        let child = command
            .args(["--", line])
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()?;
        let (send, ended) = channel();
        std::thread::spawn(move || {
            // Nobody waits where the panel has ended.
            let _ = send.send(child.wait_with_output());
        });
        Ok(Self { ended })
    }

    /// The answer, once the line has come to its end.
    pub fn answer(&self) -> Option<Answer> {
        match self.ended.try_recv() {
            Ok(Ok(output)) => Some(read(&output.stdout)),
            Ok(Err(error)) => Some(not_begun(&error)),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => Some((unanswered(), Tone::Bad)),
        }
    }
}

/// A process that does not begin.
pub fn not_begun(error: &std::io::Error) -> Answer {
    let words = both!(
        "`leadscrew mdi` does not begin: {error}",
        "无法启动 `leadscrew mdi`：{error}"
    );
    (words, Tone::Bad)
}

fn unanswered() -> Both {
    both!(
        "`leadscrew mdi` has ended without an answer",
        "`leadscrew mdi` 未给出结果即结束"
    )
}

/// Reads the result: what is in force behind the line, or why it was not carried out.
fn read(stdout: &[u8]) -> Answer {
    let value: Value = serde_json::from_slice(stdout).unwrap_or_default();
    let text = |value: &Value, key: &str| value[key].as_str().map(str::to_owned);
    if let Some(modal) = text(&value["after"], "modal").filter(|_| value["ok"] == true) {
        return (both!("done: {modal}", "完成：{modal}"), Tone::Good);
    }
    // Of a line that is wrong, its alarms; of one that was not begun, why.
    let alarm = value["alarms"].get(0).or_else(|| value["warnings"].get(0));
    let told = alarm.and_then(|alarm| {
        let (message, help) = (text(alarm, "message")?, text(alarm, "help")?);
        Some(format!("{:04} {message}; {help}", alarm["no"].as_u64()?))
    });
    match told.or_else(|| text(&value, "error")) {
        Some(told) => (Both::same(told), Tone::Care),
        None => (unanswered(), Tone::Bad),
    }
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
            ("", "`leadscrew mdi` has ended without an answer", Tone::Bad),
        ] {
            let (told, is) = read(json.as_bytes());
            assert_eq!((told.en.as_str(), is), (words, tone), "{json}");
        }
    }
}
