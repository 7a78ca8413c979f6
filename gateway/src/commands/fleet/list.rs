//! `fleet list`: the machines that agents have told of.

use super::heard::{Machine, ask};
use super::words;
use crate::cli::{Asked, Global};
use crate::commands::table::table;
use crate::failure::Outcome;
use crate::output;
use crate::words::{one_line, pick};

/// Prints them.
pub fn run(global: &Global, asked: &Asked) -> Outcome {
    let fleet = ask(global, asked)?;
    fleet.tell(global, asked)?;
    if global.json {
        return output::json(|json| {
            json.flag("ok", true);
            json.array_at("machines", |list| {
                for machine in &fleet.machines {
                    list.object(|o| machine.fields(o));
                }
            });
            fleet.fields(global, json);
        });
    }
    let lang = global.lang();
    let head = [
        pick(lang, "machine", "机床"),
        pick(lang, "node", "节点"),
        pick(lang, "serial", "序列号"),
        pick(lang, "firmware", "固件"),
        pick(lang, "parameters", "参数集"),
        pick(lang, "in force since", "生效时间"),
        pick(lang, "last seen", "最近读取"),
    ];
    let row = |machine: &Machine| {
        let set = &machine.set;
        [
            one_line(&machine.whose.machine),
            one_line(&machine.whose.node),
            format!("{:08x}", set.serial),
            one_line(&set.firmware),
            format!("{:08x}", set.parameters),
            words::since(set).get(lang).to_owned(),
            words::time(set.seen),
        ]
    };
    let rows: Vec<_> = fleet.machines.iter().map(row).collect();
    output::write(table(&head.map(String::from), &rows).as_bytes())
}
