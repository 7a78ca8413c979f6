//! `status`: one look at the board; with `sim`, at what its flash remembers.

use std::io::Write as _;

use crate::cli::Global;
use crate::failure::{Failure, Outcome};
use crate::json::Json;
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
    let record = state.journal(&state.load()?)?;
    let text = if global.json {
        let mut json = Json::new();
        json.object(|json| {
            json.flag("ok", true);
            json.text("bus", "sim");
            tapping::fields(record.as_ref(), json);
        });
        let mut bytes = json.into_bytes();
        bytes.push(b'\n');
        bytes
    } else {
        match record.filter(|record| record.in_hole) {
            Some(record) => tapping::text(&record, global.lang()),
            None => pick(global.lang(), "no tap is in a hole\n", "没有丝锥在孔里\n").to_owned(),
        }
        .into_bytes()
    };
    std::io::stdout()
        .write_all(&text)
        .map_err(|error| Failure::stdout(&error))
}
