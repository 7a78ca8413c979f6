//! `status`: one look at the board; with `sim`, at what its flash remembers.

use leadscrew_core::link::identity;

use crate::cli::Global;
use crate::failure::{Failure, Outcome};
use crate::output;
use crate::state::StateFile;
use crate::tapping;
use crate::words::{both, pick};

/// Tells what the simulated board has kept.
pub fn run(global: &Global) -> Outcome {
    let Some(path) = &global.state else {
        return Err(Failure::Usage(both!(
            "`status` with `--bus sim` looks at what a simulated board has kept: name it with `--state FILE`",
            "`status` 在 `--bus sim` 下查看模拟控制板保存的内容：请用 `--state FILE` 指定文件"
        )));
    };
    let state = StateFile::new(path);
    let flash = state.load()?;
    let record = state.journal(&flash)?;
    let (stored, damage) = match state.params(&flash) {
        Ok(stored) => (stored, None),
        Err(Failure::WrongBecause(words)) => (None, Some(words)),
        Err(failure) => return Err(failure),
    };
    let text = if global.json {
        output::line(|json| {
            json.flag("ok", true);
            json.text("bus", "sim");
            match &stored {
                Some(params) => json.text("parameters", &format!("{:08x}", identity(params))),
                None => json.null("parameters"),
            }
            if let Some(words) = &damage {
                json.text("parameters_alarm", words.get(global.lang()));
            }
            tapping::fields(record.as_ref(), json);
        })
    } else {
        let mut text = match record.filter(|record| record.in_hole) {
            Some(record) => tapping::text(&record, global.lang()),
            None => pick(global.lang(), "no tap is in a hole\n", "没有丝锥在孔里\n").to_owned(),
        };
        if let Some(words) = &damage {
            text.push_str(words.get(global.lang()));
            text.push('\n');
        }
        text.into_bytes()
    };
    output::write(&text)
}
