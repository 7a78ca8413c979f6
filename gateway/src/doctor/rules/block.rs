//! Rules 49 and 50: the block of inputs and outputs that 9461 names. They are asked before those of drives.

use std::time::Duration;

use leadscrew_core::bus::Object;

use super::{Found, Group, Lack, Rule, Verdict, found};
use crate::block::{BYTES, INPUTS, OUTPUTS, is_as_wanted, wanted};
use crate::doctor::heard::Heard;
use crate::doctor::hits::Hits;
use crate::doctor::mend::Mend;
use crate::params::drives::object_text;
use crate::words::both;

/// So long it does not answer what it is told or asked.
const SILENT: Duration = Duration::from_millis(500);

/// Rules 49 and 50.
pub const RULES: &[Rule] = &[
    Rule {
        number: 49,
        group: Group::Network,
        fault: (
            "the block of inputs and outputs does not answer",
            "输入输出模块没有应答",
        ),
        remedy: (
            "look at its supply and plug; compare the number of its switch with 9461, and its bit rate with 9020",
            "检查其电源和插头；核对其节点开关与 9461、波特率与 9020",
        ),
        guard: (
            "it was told or asked something three times over half a second and was silent all that time, while others were heard",
            "半秒以上三次向它发送或询问，它始终无声，而其他节点有报文",
        ),
        judge: silent,
    },
    Rule {
        number: 50,
        group: Group::Pdo,
        fault: (
            "the block of inputs and outputs has other PDOs than the board's",
            "输入输出模块的 PDO 与控制板的不同",
        ),
        remedy: (
            "set it up: `params push` with the machine file does",
            "设置该模块：用机床参数文件执行 `params push` 即可",
        ),
        guard: (
            "its identifiers (1400h:01, 1800h:01) or mappings (1600h, 1A00h) were read and are not those for its bytes (6000h, 6200h)",
            "已读到其标识符（1400h:01、1800h:01）或映射（1600h、1A00h），与其字节数（6000h、6200h）所需的不同",
        ),
        judge: mapping,
    },
];

fn silent(heard: &Heard) -> Verdict {
    let Some(node) = heard.machine.block else {
        return Verdict::Clean;
    };
    let heard_any = heard.nodes.values().any(|node| node.frames > 0);
    let Some(of) = heard.nodes.get(&node).filter(|of| of.asked.enough()) else {
        return Verdict::Clean;
    };
    let (Some(first), Some(last)) = (of.asked.first, of.asked.last) else {
        return Verdict::Clean;
    };
    let time = last.since(of.last.map_or(first, |heard| heard.max(first)));
    if time < SILENT || !heard_any {
        return Verdict::Clean;
    }
    let (number, ms) = (node.get(), time.as_millis());
    let said = Found::at(
        node,
        &of.asked,
        both!(
            "node {number} (9461) was told or asked something for {ms} ms and sent nothing",
            "向节点 {number}（9461）发送或询问了 {ms} ms，它没有发出报文"
        ),
    );
    found([said.mended_by(Mend::Set("9461=NUMBER".into()))])
}

fn mapping(heard: &Heard) -> Verdict {
    let Some(node) = heard.machine.block else {
        return Verdict::Clean;
    };
    let machine = &heard.machine;
    let value = |object: Object| heard.objects.value(node, object.index, object.sub);
    let bytes = |object| value(object).map(|(_, count)| (count.min(BYTES.into())) as u8);
    let (Some(inputs), Some(outputs)) = (bytes(INPUTS), bytes(OUTPUTS)) else {
        return match heard.nodes.get(&node) {
            Some(of) if of.frames > 0 => Verdict::Not(Lack::Objects("6000h 6200h")),
            _ => Verdict::Clean,
        };
    };
    let is_of_pdo = |object: Object| match object.index {
        0x1600 | 0x1A00 => true,
        0x1400 | 0x1800 => object.sub == 1,
        _ => false,
    };
    let all = wanted(&machine.params, machine.board, node, inputs, outputs);
    let differs = all.into_iter().find_map(|(object, _, wanted)| {
        let (at, found) = value(object).filter(|_| is_of_pdo(object))?;
        (!is_as_wanted(object, found.into(), wanted)).then_some((object, wanted, at, found))
    });
    let said = differs.map(|(object, wanted, at, is)| {
        let name = machine.called(node);
        Found::at(
            node,
            &Hits::standing(at),
            both!(
                "{object} of {en} is {is:X}h, and the board needs {wanted:X}h",
                "{zh}的 {object} 为 {is:X}h，控制板需要 {wanted:X}h",
                object = object_text(object),
                en = name.en,
                zh = name.zh
            ),
        )
        .mended_by(Mend::Push(None))
    });
    found(said)
}
