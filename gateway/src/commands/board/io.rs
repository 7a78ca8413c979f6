//! `io`: the inputs and outputs of a board by their names: what is on, an output switched, an input waited for.
//!
//! The names are those of a machine file; the board has numbers. An output is switched by the M code whose row does it, as
//! a typed line: so interlocks, answers and modes count as for any function [D361].

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use leadscrew_core::alarm::Lang;
use leadscrew_core::params::{Contact, FunctionAction, Params};

use super::{Machine, mdi, open};
use crate::beside;
use crate::cli::{Global, IoCommand};
use crate::failure::{Failure, Outcome};
use crate::json::Json;
use crate::link::MachineContacts;
use crate::output;
use crate::params::functions::{Io, Named, Side};
use crate::setup;
use crate::words::{both, pick};

/// From one look at the board to the next.
const LOOK: Duration = Duration::from_millis(20);

/// Does what was typed.
pub fn io(global: &Global, command: &IoCommand) -> Outcome {
    let names = names(global)?;
    match command {
        IoCommand::List => list(global, &names),
        IoCommand::Set { level } => set(global, &names, level),
        IoCommand::Wait { level, timeout } => wait(global, &names, level, *timeout),
    }
}

/// The names of the machine files; without `--params`, of the nearest `leadscrew.toml`.
pub(super) fn names(global: &Global) -> Outcome<Vec<Named>> {
    let beside = || -> Vec<PathBuf> { beside::find(Path::new("io")).into_iter().collect() };
    let files = match &global.params[..] {
        [] => beside(),
        files => files.to_vec(),
    };
    Ok(setup::alone(global, &files, &[])?.names)
}

/// `NAME=0`, `output:1=1`.
fn level<'a>(text: &'a str, names: &[Named]) -> Outcome<(&'a str, Io, bool)> {
    let parts = text.rsplit_once('=');
    let Some((name, level @ ("0" | "1"))) = parts else {
        return Err(Failure::Usage(both!(
            "`{text}`: write NAME=0 or NAME=1, as in `coolant=1` or `input:3=0`",
            "`{text}`：应写成 NAME=0 或 NAME=1，如 `coolant=1`、`input:3=0`"
        )));
    };
    let named = names.iter().find(|named| named.name == name);
    let io = named.map(|named| named.io).or_else(|| Io::at(name));
    let io = io.ok_or_else(|| {
        Failure::Usage(both!(
            "there is no input or output `{name}`: name it in the machine file (`[io.{name}]`, `--params FILE`), or write its \
             place, as `input:3`",
            "没有名为 `{name}` 的输入或输出：请在机床参数文件中命名（`[io.{name}]`，`--params FILE`），或直接写位置，如 `input:3`"
        ))
    })?;
    Ok((name, io, level == "1"))
}

/// True where it is on; `None` where nobody has told.
const fn is_on(contacts: &MachineContacts, io: Io) -> Option<bool> {
    let bit = io.contact.bit();
    match io.side {
        Side::Input if contacts.known & bit == 0 => None,
        Side::Input => Some(contacts.inputs & bit != 0),
        Side::Output => Some(contacts.outputs & bit != 0),
    }
}

const fn level_words(on: Option<bool>, lang: Lang) -> &'static str {
    match on {
        Some(true) => pick(lang, "on", "接通"),
        Some(false) => pick(lang, "off", "断开"),
        None => pick(lang, "unknown", "未知"),
    }
}

/// Every contact that is on, or has a name or a use.
fn list(global: &Global, names: &[Named]) -> Outcome {
    let mut machine = Machine::meet(global)?;
    let contacts = machine.link.contacts()?;
    let lang = global.lang();
    let all = rows(&contacts, names, &machine.params);
    if global.json {
        return output::json(|json| {
            json.flag("ok", true);
            fields(&all, json);
        });
    }
    let rows: Vec<_> = all.into_iter().flatten().collect();
    let width = |cell: fn(&Row) -> &str| rows.iter().map(|row| cell(row).chars().count()).max();
    let names = width(|row| &row.name).unwrap_or_default();
    let mut text = String::new();
    for row in &rows {
        let (place, level) = (row.io.to_string(), level_words(row.on, lang));
        let line = format!("{place:<10} {level:<8} {:<names$}  {}", row.name, row.uses);
        text.push_str(line.trim_end());
        text.push('\n');
    }
    if rows.is_empty() {
        text.push_str(pick(
            lang,
            "nothing is on, and no input or output has a name or a use\n",
            "没有接通的点，也没有已命名或已使用的输入输出\n",
        ));
    }
    output::write(text.as_bytes())
}

/// Inputs and outputs, each with what is on or has a name or a use.
pub(super) fn rows(contacts: &MachineContacts, names: &[Named], params: &Params) -> [Vec<Row>; 2] {
    [Side::Input, Side::Output].map(|side| {
        let of_side = Contact::all().map(move |contact| Io { side, contact });
        let rows = of_side.filter_map(|io| {
            let row = Row::of(io, contacts, names, params);
            row.is_shown().then_some(row)
        });
        rows.collect()
    })
}

/// `inputs` and `outputs`.
pub(super) fn fields(all: &[Vec<Row>; 2], json: &mut Json) {
    for (key, rows) in ["inputs", "outputs"].into_iter().zip(all) {
        json.array_at(key, |list| {
            for row in rows {
                list.object(|o| row.fields(o));
            }
        });
    }
}

/// A line of the list.
pub(super) struct Row {
    io: Io,
    on: Option<bool>,
    /// Its names.
    name: String,
    /// What M codes and interlocks have to do with it.
    uses: String,
}

impl Row {
    fn of(io: Io, contacts: &MachineContacts, names: &[Named], params: &Params) -> Self {
        let of_it = names.iter().filter(|named| named.io == io);
        let name: Vec<_> = of_it.map(|named| &*named.name).collect();
        Self {
            io,
            on: is_on(contacts, io),
            name: name.join(" "),
            uses: uses(io, params).join(", "),
        }
    }

    fn is_shown(&self) -> bool {
        self.on == Some(true) || !self.name.is_empty() || !self.uses.is_empty()
    }

    fn fields(&self, json: &mut Json) {
        json.integer("number", i64::from(self.io.contact.number()));
        match self.on {
            Some(on) => json.flag("on", on),
            None => json.null("on"),
        }
        json.text("name", &self.name);
        json.text("uses", &self.uses);
    }
}

/// `M8 on`, `M8 answers`, `door`: for people and programs alike.
fn uses(io: Io, params: &Params) -> Vec<String> {
    let mut out = Vec::new();
    for row in params.functions() {
        let code = row.code;
        if let Some((output, action)) = row.switches
            && io.side == Side::Output
            && output == io.contact
        {
            out.push(match action {
                FunctionAction::On => format!("M{code} on"),
                FunctionAction::Off => format!("M{code} off"),
                FunctionAction::Pulse => format!("M{code} pulse"),
            });
        }
        if let Some(answer) = row.answer
            && io.side == Side::Input
            && answer.input == io.contact
        {
            out.push(format!("M{code} answers"));
        }
    }
    let number = io.contact.number();
    let roles = match io.side {
        Side::Input => vec![
            (params.door_input(), "door"),
            (params.chuck_input(), "chuck"),
            (params.chuck_pressure_input(), "chuck pressure"),
            (params.tailstock_pressure_input(), "tailstock pressure"),
            (params.enable_input(), "enable"),
        ],
        Side::Output => vec![(params.tailstock_output(), "tailstock")],
    };
    let of_it = roles.into_iter().filter(|(of, _)| *of == number);
    out.extend(of_it.map(|(_, role)| role.to_owned()));
    out
}

/// Switches an output by the M code whose row does it.
fn set(global: &Global, names: &[Named], text: &str) -> Outcome {
    let (name, io, on) = level(text, names)?;
    if io.side == Side::Input {
        let number = io.contact.number();
        return Err(Failure::Usage(both!(
            "`{name}` is an input, which the machine sets; of a simulated one `leadscrew sim input {number} on` moves it",
            "`{name}` 是输入，由机床决定；模拟机床可用 `leadscrew sim input {number} on`"
        )));
    }
    let params = Machine::meet(global)?.params;
    let action = if on {
        FunctionAction::On
    } else {
        FunctionAction::Off
    };
    let row = params
        .functions()
        .find(|row| row.switches == Some((io.contact, action)));
    let Some(row) = row else {
        let key = if on { "set" } else { "clear" };
        return Err(Failure::Usage(both!(
            "no M code of the board switches {io} so: give it one, as `[m.60]` with `{key} = \"{name}\"`, and push the machine \
             file",
            "控制板上没有这样切换 {io} 的 M 代码：请在机床参数文件中写 `[m.60]` 与 `{key} = \"{name}\"`，然后下发"
        )));
    };
    mdi(global, Some(&format!("M{}", row.code)))
}

/// Waits until a contact is so.
fn wait(global: &Global, names: &[Named], text: &str, timeout: Option<u32>) -> Outcome {
    let (name, io, wanted) = level(text, names)?;
    let mut link = open(global)?;
    link.greet()?;
    let begun = Instant::now();
    loop {
        let is = is_on(&link.contacts()?, io);
        if is == Some(wanted) {
            break;
        }
        if timeout.is_some_and(|seconds| begun.elapsed() >= Duration::from_secs(seconds.into())) {
            let Some(is) = is.map(u8::from) else {
                return Err(Failure::WrongBecause(both!(
                    "nobody tells the level of `{name}`: look at the block of inputs and outputs with `leadscrew doctor`",
                    "没有设备报告 `{name}` 的电平：请用 `leadscrew doctor` 检查输入输出模块"
                )));
            };
            return Err(Failure::WrongBecause(both!(
                "`{name}` is {is} still",
                "`{name}` 仍为 {is}"
            )));
        }
        link.idle(LOOK)?;
    }
    if global.json {
        return output::json(|json| {
            json.flag("ok", true);
            json.text("name", name);
            json.flag("on", wanted);
        });
    }
    let level = u8::from(wanted);
    output::write(format!("{name}={level}\n").as_bytes())
}
