//! `params migrate`: a file of an older version of the table becomes one of this version. Shows what it would do; writes
//! only where it is told to, and never over what is there.

use std::fmt::Write as _;

use crate::cli::{Global, Migrate};
use crate::failure::{Doing, Failure, Outcome};
use crate::output;
use crate::params::schema::{MIGRATIONS, Migrated, SCHEMA, Unmigratable, migrate};
use crate::params::{self};
use crate::replace::replace;
use crate::words::{self, both, pick};
use crate::{diagnostics, setup};

/// Shows, and writes where it may.
pub fn run(global: &Global, args: &Migrate) -> Outcome {
    let lang = global.lang();
    let name = words::path(&args.file);
    let text = params::read(&args.file, lang)?;
    let migrated = match migrate(&text, MIGRATIONS, SCHEMA, args.from) {
        Ok(migrated) => migrated,
        Err(Unmigratable::Version(version)) => {
            return Err(Failure::WrongBecause(both!(
                "`{name}` is of schema {version}, and this program knows the way to schema {SCHEMA} from {first} on: use a \
                 `leadscrew` that knows both",
                "`{name}` 的参数表版本是 {version}，而本程序只能从版本 {first} 迁移到 {SCHEMA}：请使用认识这两个版本的 `leadscrew`",
                first = MIGRATIONS.first().map_or(SCHEMA, |first| first.to - 1)
            )));
        }
        Err(Unmigratable::Unreadable) => {
            // The reader of files says where and why.
            let loaded = params::load_text(&name, &text, lang);
            setup::told_good(global, loaded)?;
            return Err(Failure::Wrong);
        }
    };
    // What the new file says is looked at like any other.
    let loaded = params::load_text(&name, &migrated.text, lang);
    if global.json {
        output::write(&report(&migrated, &loaded, lang))?;
    } else {
        output::write(words(&migrated, lang).as_bytes())?;
        loaded.tell(diagnostics::colour());
    }
    if let Some(path) = &args.output {
        if path.exists() {
            return Err(Failure::Usage(both!(
                "`{path}` is there already: name a new file",
                "`{path}` 已存在：请指定一个新文件",
                path = words::path(path)
            )));
        }
        replace(path, migrated.text.as_bytes())
            .map_err(|error| Failure::file(Doing::Write, path.display(), &error))?;
    }
    if loaded.is_good() {
        Ok(())
    } else {
        Err(Failure::Wrong)
    }
}

fn words(migrated: &Migrated, lang: leadscrew_core::alarm::Lang) -> String {
    let Migrated { from, to, .. } = migrated;
    let mut out = if from == to {
        both!("schema {to}: up to date\n", "schema {to}：已是最新\n")
    } else {
        both!("schema {from} → {to}\n", "schema {from} → {to}\n")
    }
    .get(lang)
    .to_owned();
    for note in &migrated.notes {
        let mark = if note.open { "!" } else { " " };
        // Writing into a string cannot fail.
        let _ = writeln!(out, "{mark} {}: {}", note.key, note.words.get(lang));
    }
    if migrated.notes.is_empty() && from != to {
        out.push_str(pick(lang, "  nothing in it changes\n", "  内容没有变化\n"));
    }
    out
}

fn report(
    migrated: &Migrated,
    loaded: &params::Loaded,
    lang: leadscrew_core::alarm::Lang,
) -> Vec<u8> {
    output::line(|o| {
        o.flag("ok", loaded.is_good());
        o.integer("from", i64::from(migrated.from));
        o.integer("to", i64::from(migrated.to));
        o.array_at("notes", |list| {
            for note in &migrated.notes {
                list.object(|o| {
                    o.text("kind", note.kind);
                    o.text("key", &note.key);
                    o.text("message", note.words.get(lang));
                    o.flag("open", note.open);
                });
            }
        });
        loaded.report_fields(o);
    })
}
