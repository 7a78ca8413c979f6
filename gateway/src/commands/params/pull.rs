//! `params pull`: the set in force as a machine file.

use std::path::Path;

use leadscrew_core::link::identity;
use leadscrew_core::params::Params;

use super::home::Home;
use super::json_list;
use crate::cli::{Global, Pull};
use crate::diagnostics::say;
use crate::failure::{Doing, Failure, Outcome};
use crate::output;
use crate::params::difference::changes;
use crate::params::{self, Loaded, edit, whole};
use crate::replace::replace;
use crate::setup::{self, told_good};
use crate::words::{self, Both, both};

/// Fetches it.
pub fn run(global: &Global, args: &Pull) -> Outcome {
    // What is wrong with the place for it needs no board to be told.
    let into = args.into.as_deref().map(|path| file(global, path));
    let into = into.transpose()?;
    if let Some(path) = &args.output
        && path.exists()
    {
        return Err(Failure::Usage(both!(
            "`{path}` is there already: `--into {path}` takes the values over and keeps its comments",
            "`{path}` 已存在：`--into {path}` 可更新其中的值并保留注释",
            path = words::path(path)
        )));
    }
    let mut home = Home::open(global)?;
    let params = match &home {
        // Without a board it is the set that the options make.
        Home::BuiltIn(_) => setup::load(global)?.params,
        Home::Board(machine) => machine.params.clone(),
    };
    if let Some(file) = into {
        return file.take(global, &mut home, &params);
    }
    if global.json && args.output.is_none() {
        let loaded = Loaded::of(params);
        return output::write(&json_list(
            leadscrew_core::params::Entry::all().iter(),
            &loaded,
            global.lang(),
        ));
    }
    let origin = both!(
        "Parameters of {en}, identity {id:08x}; written by `leadscrew params pull`.",
        "{zh}的参数，标识 {id:08x}；由 `leadscrew params pull` 写出。",
        en = home.name().en,
        zh = home.name().zh,
        id = identity(&params)
    );
    let text = whole::file(
        &params,
        &[origin.get(global.lang()).to_owned()],
        global.lang(),
    );
    let Some(path) = &args.output else {
        return output::write(text.as_bytes());
    };
    put(path, &text)?;
    told(global, path, &home.name())
}

/// A file that is to take the values over.
struct Into<'a> {
    path: &'a Path,
    text: String,
    loaded: Loaded,
}

/// It, as it is.
fn file<'a>(global: &Global, path: &'a Path) -> Outcome<Into<'a>> {
    let text = params::read(path, global.lang())?;
    let loaded = params::load(&[path.to_owned()], &[], global.lang())?;
    Ok(Into {
        path,
        text,
        loaded: told_good(global, loaded)?,
    })
}

impl Into<'_> {
    /// The values go into it, and it otherwise stays as it is.
    fn take(self, global: &Global, home: &mut Home, params: &Params) -> Outcome {
        let Self { path, text, loaded } = self;
        // What the file does not name is the built-in machine's, and has to be named where the board has another value.
        let values: Vec<_> = changes(&loaded.params, params)
            .into_iter()
            .map(|change| (change.entry, change.new))
            .collect();
        let new = home.drives_into(text.clone(), &loaded.drives)?;
        let new = edit::with_values(&new, &values);
        if new != text {
            put(path, &new)?;
        }
        told(global, path, &home.name())
    }
}

fn put(path: &Path, text: &str) -> Outcome {
    replace(path, text.as_bytes())
        .map_err(|error| Failure::file(Doing::Write, path.display(), &error))
}

fn told(global: &Global, path: &Path, from: &Both) -> Outcome {
    let words = both!(
        "`{path}` has the parameters of {en}\n",
        "`{path}` 已有{zh}的参数\n",
        path = words::path(path),
        en = from.en,
        zh = from.zh
    );
    say(words.get(global.lang()));
    Ok(())
}
