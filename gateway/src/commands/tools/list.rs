//! `tools list`, `offsets list`, `get`.

use leadscrew_core::offsets::{Offsets, TOOLS, Tool};
use leadscrew_core::units::Axis;

use super::home::Home;
use crate::cli::Global;
use crate::failure::Outcome;
use crate::json::Json;
use crate::output;
use crate::tools::{Field, Groove, Key, value};
use crate::words::both;

/// Prints the tools that have any value.
pub fn tools(global: &Global) -> Outcome {
    let home = Home::open(global)?;
    home.warn(global);
    let table = &home.table;
    let used = (1..=TOOLS as u8).filter(|number| table.tool(*number) != Some(&Tool::default()));
    if global.json {
        return output::json(|o| {
            head(o, &home);
            o.array_at("tools", |list| {
                for number in used {
                    list.object(|o| {
                        o.integer("tool", number.into());
                        fields(o, table, number);
                    });
                }
            });
        });
    }
    let mut rows = vec![
        [
            "tool", "X", "Z", "wear X", "wear Z", "radius", "tip", "station", "measured",
        ]
        .map(String::from)
        .to_vec(),
    ];
    for number in used {
        let cells = Field::ALL.map(|field| shown(Key::Tool(number, field), table));
        rows.push([vec![format!("T{number}")], cells.to_vec()].concat());
    }
    tell(global, &home, &rows)
}

/// Prints the work offsets and the shift.
pub fn offsets(global: &Global) -> Outcome {
    let home = Home::open(global)?;
    home.warn(global);
    let table = &home.table;
    let axes = [Axis::X, Axis::Z];
    let records = std::iter::once(("shift".to_owned(), axes.map(Key::Shift)));
    let work = (54..=59).map(|code| (format!("G{code}"), axes.map(|axis| Key::Work(code, axis))));
    let records: Vec<_> = records.chain(work).collect();
    if global.json {
        return output::json(|o| {
            head(o, &home);
            if table.thread.angle.is_some() {
                o.object_at("thread", |o| {
                    for (name, key) in ["x", "z", "angle"]
                        .into_iter()
                        .zip(Groove::ALL.map(Key::Thread))
                    {
                        value(o, name, key, key.get(table));
                    }
                });
            }
            for (name, [x, z]) in &records {
                o.object_at(name, |o| {
                    value(o, "x", *x, x.get(table));
                    value(o, "z", *z, z.get(table));
                });
            }
        });
    }
    let mut rows = vec![["", "X", "Z"].map(String::from).to_vec()];
    if table.thread.angle.is_some() {
        let [x, z, angle] = Groove::ALL.map(|field| shown(Key::Thread(field), table));
        rows.push(vec!["thread".into(), x, z, format!("spindle {angle}°")]);
    }
    for (name, keys) in records {
        rows.push([vec![name], keys.map(|key| shown(key, table)).to_vec()].concat());
    }
    tell(global, &home, &rows)
}

/// Prints single values.
pub fn get(global: &Global, keys: &[Key]) -> Outcome {
    let home = Home::open(global)?;
    home.warn(global);
    let table = &home.table;
    if global.json {
        return output::json(|o| {
            head(o, &home);
            o.array_at("values", |list| {
                for key in keys {
                    list.object(|o| {
                        o.text("key", &key.to_string());
                        value(o, "value", *key, key.get(table));
                    });
                }
            });
        });
    }
    let line = |key: &Key| format!("{key} = {}\n", shown(*key, table));
    output::write(keys.iter().map(line).collect::<String>().as_bytes())
}

fn head(json: &mut Json, home: &Home) {
    json.flag("ok", true);
    json.integer("revision", home.table.revision.0.into());
}

/// The values of a tool, in the machine format.
fn fields(json: &mut Json, table: &Offsets, number: u8) {
    for field in Field::ALL {
        let key = Key::Tool(number, field);
        let name = field.name().to_ascii_lowercase().replace('.', "_");
        value(json, &name, key, key.get(table));
    }
}

fn shown(key: Key, table: &Offsets) -> String {
    match key.shown(key.get(table)) {
        text if text.is_empty() => "-".into(),
        text => text,
    }
}

/// Columns that end at the same place, then a line about the whole.
fn tell(global: &Global, home: &Home, rows: &[Vec<String>]) -> Outcome {
    let mut widths = vec![0; rows.iter().map(Vec::len).max().unwrap_or(0)];
    for row in rows {
        for (width, cell) in widths.iter_mut().zip(row) {
            *width = (*width).max(cell.len());
        }
    }
    let mut out = String::new();
    for row in rows {
        let cells: Vec<_> = row
            .iter()
            .zip(&widths)
            .map(|(cell, width)| format!("{cell:>width$}", width = *width))
            .collect();
        out.push_str(&cells.join("  "));
        out.push('\n');
    }
    let (revision, name) = (home.table.revision.0, &home.name);
    let end = both!(
        "revision {revision}, of {en}; mm, X in diameter\n",
        "修订号 {revision}，{zh}；单位 mm，X 为直径值\n",
        en = name.en,
        zh = name.zh
    );
    out.push_str(end.get(global.lang()));
    output::write(out.as_bytes())
}
