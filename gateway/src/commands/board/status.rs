//! `status` of a board on a real bus: one look at all of it.

use std::path::Path;

use leadscrew_core::alarm::{Arg, Lang};
use leadscrew_core::board::{GUARANTEED_ERASES, Interlocks};
use leadscrew_core::journal::TapRecord;
use leadscrew_core::link::Status;
use leadscrew_core::operating::{Interlock, OperatingMode};
use leadscrew_core::params::Contact;
use leadscrew_core::signals::Signals;

use super::{names, open, state_words};
use crate::cli::Global;
use crate::commands::{contact_numbers, or_none};
use crate::diagnostics::{Diagnostic, figure};
use crate::failure::Outcome;
use crate::link::{Link, MachineContacts};
use crate::number;
use crate::output;
use crate::place::SourceLine;
use crate::source::SourceFile;
use crate::tapping;
use crate::words::{both, pick};

/// Looks once.
pub fn status(global: &Global) -> Outcome {
    let mut link = open(global)?;
    link.greet()?;
    let status = link.status()?;
    let mode = link.mode()?;
    let contacts = link.contacts()?;
    let journal = link.journal()?;
    let erases = link.erases()?;
    let record = TapRecord::decode(&journal).ok().flatten();
    let node = link.node().get();
    let lang = global.lang();
    let alarm = status.alarm.map(|alarm| {
        let source = SourceFile::new(Path::new("the program on the board"));
        Diagnostic::new(&alarm, &source, lang, false)
    });
    if global.json {
        return output::json(|json| {
            json.flag("ok", true);
            json.text("bus", &global.bus.to_string());
            json.integer("node", i64::from(node));
            json.text("state", status.state.name());
            json.text("mode", mode.name());
            match &alarm {
                Some(alarm) => json.object_at("alarm", |json| alarm.fields(json, false)),
                None => json.null("alarm"),
            }
            json.flag("program", status.in_program);
            match status.left {
                Some(point) => json.object_at("left", |json| {
                    json.decimal::<6>("mx", point.x.nm().saturating_mul(2));
                    json.decimal::<6>("mz", point.z.nm());
                }),
                None => json.null("left"),
            }
            SourceLine(status.line).fields(json);
            json.integer("move", i64::from(status.number));
            json.decimal::<6>("mx", status.position.x.nm().saturating_mul(2));
            json.decimal::<6>("mz", status.position.z.nm());
            json.decimal::<6>("mc", status.position.c.udeg());
            json.integer("rpm", i64::from(status.speed.rpm().get()));
            json.integer("rpm_commanded", i64::from(status.command.get()));
            json.text("referenced", &names(status.referenced));
            json.text("unreferenced", &names(status.unreferenced));
            json.flag("hold", status.hold);
            json.flag("feed_hold", mirrors(&status, Signals::HOLD));
            json.flag("single_block", status.single_block);
            json.flag("emergency_stop", mirrors(&status, Signals::STOP));
            json.object_at("override", |json| {
                json.integer("feed", i64::from(status.feed_percent));
                json.integer("rapid", i64::from(status.rapid_percent));
                json.integer("spindle", i64::from(status.spindle_percent));
            });
            match status.sync_error {
                Some(error) => json.decimal::<3>("sync_error_um", error.nm()),
                None => json.null("sync_error_um"),
            }
            json.integer("late", i64::from(status.late));
            json.integer("credit", i64::from(status.credit));
            json.integer("signals", i64::from(status.signals & Signals::BITS));
            match contacts.known {
                0 => json.null("inputs"),
                _ => json.text("inputs", &numbers(contacts.inputs)),
            }
            json.text("outputs", &numbers(contacts.outputs));
            match contacts.gear {
                0 => json.null("gear"),
                gear => json.integer("gear", i64::from(gear)),
            }
            json.text("interlocks", &names_of(contacts.interlocks));
            json.text("parameters", &format!("{:08x}", status.parameters));
            match erases {
                Some(erases) => json.integer("storage_erases", i64::from(erases)),
                None => json.null("storage_erases"),
            }
            json.integer("storage_erases_guaranteed", i64::from(GUARANTEED_ERASES));
            tapping::fields(record.as_ref(), json);
        });
    }
    let mut text = words(&status, mode, node, lang);
    text.push_str(&contact_words(&contacts, lang));
    text.push_str(&wear_words(erases.unwrap_or(0), lang));
    if let Some(alarm) = alarm {
        text.push_str(&format!(
            "{:04} {}\n     {}\n",
            alarm.number, alarm.message, alarm.help
        ));
    }
    if let Some(record) = record.filter(|record| record.in_hole) {
        text.push_str(&tapping::text(&record, lang));
    }
    output::write(text.as_bytes())?;
    // Programs name the board they mean.
    if global.node.is_none() {
        tell_others(&mut link, lang)?;
    }
    Ok(())
}

/// The numbers of the contacts that are on, from 1 on.
fn numbers(on: u32) -> String {
    contact_numbers(Contact::of_bits(on).map(Contact::number))
}

fn names_of(interlocks: Interlocks) -> String {
    let names: Vec<&str> = interlocks.each().map(Interlock::name).collect();
    names.join(" ")
}

/// What is on, where anything is, and what keeps the machine from starting.
fn contact_words(contacts: &MachineContacts, lang: Lang) -> String {
    let mut text = String::new();
    let on = contacts.inputs;
    if on != 0 || contacts.outputs != 0 {
        let list = |on| or_none(numbers(on), lang);
        let (inputs, outputs) = (list(on), list(contacts.outputs));
        let line = both!(
            "inputs on: {inputs}; outputs on: {outputs}\n",
            "接通的输入：{inputs}；接通的输出：{outputs}\n"
        );
        text.push_str(line.get(lang));
    }
    if contacts.gear != 0 {
        let line = both!("gear {gear}\n", "第 {gear} 档\n", gear = contacts.gear);
        text.push_str(line.get(lang));
    }
    for interlock in contacts.interlocks.each() {
        let words = figure(Arg::Interlock(interlock), lang, false);
        let line = both!("interlock: {words}\n", "联锁：{words}\n");
        text.push_str(line.get(lang));
    }
    text
}

/// How far the storage is worn, from one per cent on.
fn wear_words(erases: u32, lang: Lang) -> String {
    let percent = erases / (GUARANTEED_ERASES / 100);
    if percent == 0 {
        return String::new();
    }
    let line = both!(
        "storage: each page erased {erases} times, {percent} % of the {GUARANTEED_ERASES} that are guaranteed\n",
        "存储器：每页已擦除 {erases} 次，为保证次数 {GUARANTEED_ERASES} 的 {percent} %\n"
    );
    line.get(lang).to_owned()
}

/// Names the other boards on the bus.
fn tell_others(link: &mut Link, lang: Lang) -> Outcome {
    for other in link.other_boards()? {
        let told = both!(
            "also on this bus: node {other} (`leadscrew status --node {other}`)\n",
            "此总线上还有：节点 {other}（`leadscrew status --node {other}`）\n",
            other = other.get()
        );
        output::write(told.get(lang).as_bytes())?;
    }
    Ok(())
}

/// One of the bits that the board mirrors behind its signals.
const fn mirrors(status: &Status, bit: u16) -> bool {
    status.signals & bit != 0
}

fn words(status: &Status, mode: OperatingMode, node: u8, lang: Lang) -> String {
    let state = state_words(status.state, lang);
    let place = if status.line > 0 {
        both!(
            ", line {line}, move {number}",
            "，第 {line} 行，第 {number} 段移动",
            line = SourceLine(status.line),
            number = status.number
        )
    } else {
        both!("", "")
    };
    let mut text = both!(
        "node {node}   {state}{en}   mode {mode}\n\
         X {x}  Z {z}  C {c}   (machine coordinates, X a diameter)\n\
         spindle {measured} rpm (commanded {commanded})\n\
         overrides feed {feed} %, rapid {rapid} %, spindle {spindle} %\n",
        "节点 {node}   {state}{zh}   {mode} 方式\n\
         X {x}  Z {z}  C {c}   （机床坐标，X 为直径）\n\
         主轴 {measured} r/min（指令 {commanded}）\n\
         倍率 进给 {feed} %，快速 {rapid} %，主轴 {spindle} %\n",
        mode = mode.name(),
        en = place.en,
        zh = place.zh,
        x = number::text::<6>(status.position.x.nm().saturating_mul(2)),
        z = number::text::<6>(status.position.z.nm()),
        c = number::text::<6>(status.position.c.udeg()),
        measured = status.speed.rpm().get(),
        commanded = status.command.get(),
        feed = status.feed_percent,
        rapid = status.rapid_percent,
        spindle = status.spindle_percent
    )
    .get(lang)
    .to_owned();
    if !status.unreferenced.is_empty() {
        let line = both!(
            "not referenced: {axes}\n",
            "未回零：{axes}\n",
            axes = names(status.unreferenced)
        );
        text.push_str(line.get(lang));
    }
    if let Some(point) = &status.left {
        let line = both!(
            "the program was left at X {x}  Z {z}; `leadscrew resume` goes back there\n",
            "程序在 X {x}  Z {z} 处中途离开；`leadscrew resume` 返回该处\n",
            x = number::text::<6>(point.x.nm().saturating_mul(2)),
            z = number::text::<6>(point.z.nm())
        );
        text.push_str(line.get(lang));
    }
    if status.hold {
        text.push_str(pick(lang, "feed hold is on\n", "进给保持已打开\n"));
    } else if mirrors(status, Signals::HOLD) {
        text.push_str(pick(
            lang,
            "the contact of feed hold is pressed; it acts when it is pressed anew\n",
            "进给保持触点处于按下状态；再次按下时才起作用\n",
        ));
    }
    if status.single_block {
        text.push_str(pick(lang, "single block is on\n", "单段已打开\n"));
    }
    if mirrors(status, Signals::STOP) {
        text.push_str(pick(
            lang,
            "stopped: by the emergency stop or by `leadscrew stop`\n",
            "已停止：急停或 `leadscrew stop`\n",
        ));
    }
    if let Some(error) = status.sync_error {
        let error = number::text::<3>(error.nm());
        let line = both!("synchronism error {error} µm\n", "同步误差 {error} µm\n");
        text.push_str(line.get(lang));
    }
    if status.late > 0 {
        let line = both!(
            "{late} setpoints came late for their SYNC\n",
            "{late} 个设定值晚于 SYNC 到达\n",
            late = status.late
        );
        text.push_str(line.get(lang));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::link::bench;

    #[test]
    fn a_contact_that_is_pressed_is_told_apart_from_a_hold() {
        let told = |hold, signals| {
            let status = Status {
                hold,
                signals,
                ..bench::status()
            };
            let line = |lang| {
                let text = words(&status, OperatingMode::Manual, 1, lang);
                text.lines().nth(4).unwrap_or_default().to_owned()
            };
            [line(Lang::En), line(Lang::Zh)]
        };
        assert_eq!(told(false, 0), ["", ""]);
        let [en, zh] = told(false, Signals::HOLD);
        assert_eq!(
            en,
            "the contact of feed hold is pressed; it acts when it is pressed anew"
        );
        assert!(zh.starts_with("进给保持触点"), "{zh}");
        for signals in [0, Signals::HOLD] {
            assert_eq!(told(true, signals), ["feed hold is on", "进给保持已打开"]);
        }
        let stop = told(false, Signals::STOP);
        assert_eq!(
            stop,
            [
                "stopped: by the emergency stop or by `leadscrew stop`",
                "已停止：急停或 `leadscrew stop`"
            ]
        );
    }
}
