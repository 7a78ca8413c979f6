//! A program of the panel's folder that is sent and begun: `leadscrew run` does it, in a process of its own.
//!
//! The text is the one that its page has shown, and nobody changes it here before it has ended. This must not know who has
//! ordered it.

use std::ffi::OsString;

use leadscrew_core::alarm::Lang;
use leadscrew_core::call::Position;
use leadscrew_panel::Claim;
use serde_json::Value;

use super::super::monitor::typed;
use super::super::own::{Handle, Own};
use super::desk::Program;
use super::{object, path};
use crate::cli::Global;
use crate::json::Json;
use crate::words::{Both, both};

/// A program under way.
#[derive(Debug)]
pub struct Sent {
    name: String,
    tag: String,
    /// The line that it was started at.
    start: Option<u32>,
    /// By which tables, and from where: as its path has them.
    by: Option<String>,
    from: Option<Position>,
    own: Own,
    /// It stays as it is until this goes.
    _claim: Claim,
}

impl Sent {
    /// Begins it.
    ///
    /// # Errors
    /// No process is to be had.
    pub fn begin(
        global: &Global,
        program: Program,
        (by, from): (Option<String>, Option<Position>),
    ) -> Result<Self, Both> {
        let start = program.start.as_ref();
        let claim = program.claim;
        let lang = if program.zh { Lang::Zh } else { Lang::En };
        let mut typed: Vec<OsString> = Vec::new();
        if let Some(start) = start {
            // Whether it is still what was shown is found out there, and there alone.
            let line = start.line.to_string();
            let shown = start.shown.to_string();
            typed.extend(["--from", &line, "--shown", &shown].map(OsString::from));
        }
        if program.wheel {
            typed.push("--handwheel".into());
        }
        typed.extend(["--".into(), claim.path.clone().into()]);
        let own = Own::begin(global, "run", &typed, lang).map_err(|error| {
            both!(
                "`leadscrew run` does not begin: {error}",
                "无法启动 `leadscrew run`：{error}"
            )
        })?;
        Ok(Self {
            start: start.map(|start| start.line),
            name: program.name,
            tag: program.tag,
            by,
            from,
            own,
            _claim: claim,
        })
    }

    /// To end it before its time.
    pub fn handle(&self) -> Handle {
        self.own.handle.clone()
    }

    /// What has become of it, once it has ended.
    pub fn ended(&self) -> Option<Result<Both, Both>> {
        let said = self.own.ended()?;
        let value: Value = serde_json::from_slice(&said.unwrap_or_default()).unwrap_or_default();
        let name = &self.name;
        if value["ok"] == true {
            return Some(Ok(both!("{name} has ended well", "{name} 已正常结束")));
        }
        let why = typed::why(&value).unwrap_or_else(|| {
            both!(
                "it was held or stopped before it had begun, or has ended without a result: look at the alarms",
                "在开始前被保持或停止，或未给出结果即结束：请查看报警"
            )
        });
        Some(Err(both!(
            "{name}: {en}",
            "{name}：{zh}",
            en = why.en,
            zh = why.zh
        )))
    }

    /// What all pages are told: which program it is, and its end.
    pub fn told(&self, end: Option<&Result<Both, Both>>) -> String {
        object(|json| {
            json.text("name", &self.name);
            json.text("tag", &self.tag);
            match self.start {
                Some(line) => json.integer("start", line.into()),
                None => json.null("start"),
            }
            // What is started at a line counts its moves from there on, as no path does.
            let whole = self.start.is_none();
            match self.by.as_ref().filter(|_| whole) {
                Some(by) => json.text("by", by),
                None => json.null("by"),
            }
            match self.from.as_ref().filter(|_| whole) {
                Some(from) => path::start(from, json),
                None => json.null("from"),
            }
            match end {
                Some(done) => json.object_at("end", |json| self::end(json, done)),
                None => json.null("end"),
            }
        })
    }
}

/// The end of a command of its own.
pub fn end(json: &mut Json, done: &Result<Both, Both>) {
    json.flag("ok", done.is_ok());
    let (Ok(words) | Err(words)) = done;
    json.text("en", &words.en);
    json.text("zh", &words.zh);
}
