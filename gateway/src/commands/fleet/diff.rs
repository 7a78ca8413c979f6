//! `fleet diff`: a folder of machine files against the sets in force. Exit code 1 where anything differs, or cannot be
//! compared.
//!
//! A file is laid over the set in force, as `params push` does, and compared as `params diff` does. What an agent does not
//! read is not compared: the objects of drives.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use leadscrew_core::params::{PASSWORD, PASSWORD_KEPT, Params};

use super::heard::{Fleet, Machine, ask};
use super::words;
use crate::cli::{Asked, Global};
use crate::diagnostics::colour;
use crate::failure::{Doing, Failure, Outcome};
use crate::in_force;
use crate::json::Json;
use crate::output;
use crate::params::difference::{self, Change, changes};
use crate::params::{self, Loaded};
use crate::words::{Both, both, one_line};

/// How the name of a machine file ends.
const FILE: &str = "toml";

/// What came of a machine.
enum Found {
    /// What differs, from the set in force to the file.
    Compared(Vec<Change>, Loaded),
    /// There is no file of its name.
    NoFile,
    /// Its set is not known here.
    Unknown(Both),
    /// Its file has mistakes.
    Mistakes(Loaded),
    /// Its file cannot be read.
    Unreadable(Both),
}

/// A machine, its file, and what came of them.
struct Row<'a> {
    machine: &'a Machine,
    found: Found,
}

/// Compares.
pub fn run(global: &Global, folder: &Path, asked: &Asked) -> Outcome {
    let files = files(folder)?;
    let fleet = ask(global, asked)?;
    let rows: Vec<Row<'_>> = fleet
        .machines
        .iter()
        .map(|machine| Row {
            machine,
            found: compared(global, machine, files.get(&machine.whose.machine)),
        })
        .collect();
    let is_heard = |name: &str| fleet.machines.iter().any(|of| of.whose.machine == name);
    let silent: Vec<&PathBuf> = files
        .iter()
        .filter(|(name, _)| !is_heard(name))
        .map(|(_, path)| path)
        .collect();
    fleet.tell(global, asked)?;
    let same = silent.is_empty() && rows.iter().all(|row| row.found.is_same());
    if global.json {
        json(global, &fleet, &rows, &silent, same)?;
    } else {
        text(global, &rows, &silent)?;
    }
    if same { Ok(()) } else { Err(Failure::Wrong) }
}

/// The machine files of a folder, by the names of their machines.
fn files(folder: &Path) -> Outcome<BTreeMap<String, PathBuf>> {
    let failed = |error: io::Error| Failure::file(Doing::Read, folder.display(), &error);
    let mut files = BTreeMap::new();
    for entry in fs::read_dir(folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        let name = path.file_stem().map(|name| name.to_string_lossy());
        // An editor's own files begin with a dot.
        if path.extension().is_some_and(|end| end == FILE)
            && let Some(name) = name.filter(|name| !name.starts_with('.'))
        {
            files.insert(name.into_owned(), path);
        }
    }
    if files.is_empty() {
        return Err(Failure::Usage(both!(
            "`{folder}` holds no machine file: each is MACHINE.toml, by the name that its agent gives to the machine; `params \
             pull -o` writes one",
            "`{folder}` 中没有机床参数文件：文件名应为 MACHINE.toml，与代理程序使用的机床名称一致；可用 `params pull -o` 写出",
            folder = crate::words::path(folder)
        )));
    }
    Ok(files)
}

fn compared(global: &Global, machine: &Machine, file: Option<&PathBuf>) -> Found {
    let Some(file) = file else {
        return Found::NoFile;
    };
    let in_force = match in_force::params(&machine.set) {
        Ok(params) => params,
        Err(why) => return Found::Unknown(why),
    };
    let files: Vec<_> = global.params.iter().chain([file]).cloned().collect();
    let base = Some(in_force.clone());
    match params::load_over(base, &files, &global.set, global.lang()) {
        Ok(loaded) if loaded.is_good() => Found::Compared(told(&in_force, &loaded.params), loaded),
        Ok(loaded) => Found::Mistakes(loaded),
        Err(failure) => Found::Unreadable(failure.words().unwrap_or_default()),
    }
}

/// What differs. A board tells that it has a password and not which: whether it is that of the file is not known.
fn told(in_force: &Params, wanted: &Params) -> Vec<Change> {
    let mut changes = changes(in_force, wanted);
    changes.retain(|of| of.entry.no != PASSWORD || of.old != PASSWORD_KEPT || of.new == 0);
    changes
}

impl Found {
    fn is_same(&self) -> bool {
        matches!(self, Self::Compared(changes, _) if changes.is_empty())
    }

    const fn state(&self) -> &'static str {
        match self {
            Self::Compared(changes, _) if changes.is_empty() => "same",
            Self::Compared(..) => "differs",
            Self::NoFile => "no_file",
            Self::Unknown(_) => "set_not_known",
            Self::Mistakes(_) | Self::Unreadable(_) => "file_refused",
        }
    }

    /// The file wants something of drives, which is not compared.
    const fn has_drives(&self) -> bool {
        matches!(self, Self::Compared(_, loaded) if !loaded.drives.is_empty())
    }
}

fn text(global: &Global, rows: &[Row<'_>], silent: &[&PathBuf]) -> Outcome {
    let lang = global.lang();
    let mut out = String::new();
    let mut add = |words: &Both| {
        out.push_str(words.get(lang));
        out.push('\n');
    };
    for Row { machine, found } in rows {
        let name = one_line(&machine.whose.machine);
        let node = one_line(&machine.whose.node);
        let since = words::since(&machine.set);
        let seen = words::time(machine.set.seen);
        let who = both!("{name} ({node}): ", "{name}（{node}）：");
        let what = match found {
            Found::Compared(changes, _) if changes.is_empty() => both!(
                "the same, in force since {en}, last seen {seen}",
                "相同，生效时间：{zh}，最近读取：{seen}",
                en = since.en,
                zh = since.zh
            ),
            Found::Compared(changes, _) => both!(
                "differs, in force since {en}, last seen {seen}; values that differ: {n}, in force → in the file",
                "不同，生效时间：{zh}，最近读取：{seen}；不同的值：{n} 个，当前值 → 文件中的值",
                n = changes.len(),
                en = since.en,
                zh = since.zh
            ),
            Found::NoFile => both!("no file {name}.toml", "没有文件 {name}.toml"),
            Found::Unknown(why) => both!(
                "its set is not known here: {en}",
                "无法得知其参数集：{zh}",
                en = why.en,
                zh = why.zh
            ),
            Found::Mistakes(loaded) => {
                // As `params diff` shows them.
                loaded.tell(colour());
                both!(
                    "its file {name}.toml is refused, for the mistakes that are told",
                    "其文件 {name}.toml 有错误（见报告），不能比较"
                )
            }
            Found::Unreadable(why) => why.clone(),
        };
        add(&Both {
            en: who.en + &what.en,
            zh: who.zh + &what.zh,
        });
        if let Found::Compared(changes, _) = found {
            for line in difference::text(changes, &[], lang).lines() {
                add(&Both::same(format!("  {line}")));
            }
        }
        if found.has_drives() {
            add(&both!(
                "  its drive sections are not compared: `params diff` at the machine does",
                "  未比较驱动器部分：请在机床上用 `params diff` 比较"
            ));
        }
    }
    for path in silent {
        add(&both!(
            "{file}: no machine of this name was heard",
            "{file}：没有收到该名称机床的数据",
            file = crate::words::path(path)
        ));
    }
    output::write(out.as_bytes())
}

fn json(
    global: &Global,
    fleet: &Fleet,
    rows: &[Row<'_>],
    silent: &[&PathBuf],
    same: bool,
) -> Outcome {
    output::json(|json| {
        json.flag("ok", true);
        json.flag("same", same);
        json.array_at("machines", |list| {
            for row in rows {
                list.object(|o| row.fields(global, o));
            }
        });
        json.array_at("files_without_machine", |list| {
            for path in silent {
                list.text_item(&path.display().to_string());
            }
        });
        fleet.fields(global, json);
    })
}

impl Row<'_> {
    fn fields(&self, global: &Global, json: &mut Json) {
        self.machine.fields(json);
        json.text("state", self.found.state());
        match &self.found {
            Found::Compared(changes, _) => {
                difference::fields(json, changes, &[]);
                json.flag("drive_sections_not_compared", self.found.has_drives());
            }
            Found::NoFile => {}
            Found::Unknown(why) | Found::Unreadable(why) => {
                json.text("why", why.get(global.lang()));
            }
            Found::Mistakes(loaded) => loaded.report_fields(json),
        }
    }
}
