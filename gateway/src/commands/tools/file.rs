//! `tools pull` and `tools diff`: the table and files.

use super::home::Home;
use crate::cli::{DiffTools, Global, PullTools};
use crate::diagnostics::say;
use crate::failure::{Doing, Failure, Outcome};
use crate::output;
use crate::replace::replace;
use crate::tools::{self, changes};
use crate::words::{self, both, pick};

/// Writes the table as a file.
pub fn pull(global: &Global, args: &PullTools) -> Outcome {
    if let Some(path) = &args.output
        && path.exists()
        && !args.force
    {
        return Err(Failure::Usage(both!(
            "`{path}` is there already: `--force` writes over it",
            "`{path}` 已存在：`--force` 可覆盖",
            path = words::path(path)
        )));
    }
    let home = Home::open(global)?;
    home.warn(global);
    let origin = both!(
        "Offsets and tools, revision {revision}, of {en}; written by `leadscrew tools pull`.",
        "偏置与刀具，修订号 {revision}，{zh}；由 `leadscrew tools pull` 写出。",
        revision = home.table.revision.0,
        en = home.name.en,
        zh = home.name.zh
    );
    let text = tools::whole(&home.table, origin.get(global.lang()), global.lang());
    let Some(path) = &args.output else {
        return output::write(text.as_bytes());
    };
    replace(path, text.as_bytes())
        .map_err(|error| Failure::file(Doing::Write, path.display(), &error))?;
    let told = both!(
        "`{path}` has the offsets and tools of {en}\n",
        "`{path}` 已有{zh}的偏置与刀具数据\n",
        path = words::path(path),
        en = home.name.en,
        zh = home.name.zh
    );
    say(told.get(global.lang()));
    Ok(())
}

/// Compares the table with itself under a file, or two files. Exit code 1 where anything differs.
pub fn diff(global: &Global, args: &DiffTools) -> Outcome {
    let lang = global.lang();
    let (old, new) = match &args.files[..] {
        [first, second] => (tools::read(first, lang)?, tools::read(second, lang)?),
        files => {
            let home = Home::open(global)?;
            home.warn(global);
            let mut new = home.table;
            for file in files {
                tools::apply(&mut new, file, lang)?;
            }
            (home.table, new)
        }
    };
    let changes = changes(&old, &new);
    if global.json {
        output::json(|o| {
            o.flag("ok", true);
            tools::fields(o, &changes);
        })?;
    } else if changes.is_empty() {
        output::write(pick(lang, "no difference\n", "没有差别\n").as_bytes())?;
    } else {
        output::write(tools::text(&changes).as_bytes())?;
    }
    if changes.is_empty() {
        Ok(())
    } else {
        Err(Failure::Wrong)
    }
}
