//! Rules 6–13: nodes, NMT and heartbeats.

use std::time::Duration;

use leadscrew_core::bus::{NodeId, Service};

use super::{Found, Group, Lack, Rule, Verdict, found, found_or};
use crate::doctor::heard::Heard;
use crate::doctor::hits::Hits;
use crate::doctor::mend::Mend;
use crate::words::both;

/// Rules 6 and 8–13.
pub const RULES: &[Rule] = &[
    Rule {
        number: 6,
        group: Group::Network,
        fault: (
            "two nodes have one number, or two masters tell one drive",
            "两个节点同号，或两个主站同时控制一台驱动器",
        ),
        remedy: (
            "give each node a number of its own; one board alone is on a wire",
            "给每个节点各自的编号；一条总线上只能有一块控制板",
        ),
        guard: (
            "an identifier with two contents in a period that is whole; two boot-ups within 0.5 s that no NMT reset asked for",
            "完整周期内同一标识符有两种内容；0.5 s 内两次未经 NMT 复位的启动报文",
        ),
        judge: clash,
    },
    Rule {
        number: 8,
        group: Group::Network,
        fault: ("a node starts again and again", "某节点反复启动"),
        remedy: (
            "look at its supply: it drops under load",
            "检查其电源：带载时电压跌落",
        ),
        guard: (
            "three boot-ups that no NMT reset of the 5 s before has asked for",
            "三次启动报文，且之前 5 s 内没有 NMT 复位",
        ),
        judge: restarts,
    },
    Rule {
        number: 9,
        group: Group::Network,
        fault: (
            "a node was never started (NMT start)",
            "某节点从未被启动（NMT start）",
        ),
        remedy: (
            "let its master start it, or start it by hand: `cansend INTERFACE 000#0100` starts all nodes",
            "由主站启动它，或手动启动：`cansend INTERFACE 000#0100` 启动全部节点",
        ),
        guard: (
            "pre-operational for more than 2 s; a board only where somebody gives it orders meanwhile",
            "预运行状态超过 2 s；对控制板，仅当期间有人给它命令",
        ),
        judge: not_started,
    },
    Rule {
        number: 10,
        group: Group::Network,
        fault: ("a node was stopped by NMT", "某节点被 NMT 停止"),
        remedy: (
            "find the other master that stops it, and start the node again",
            "找出停止它的另一个主站，然后重新启动该节点",
        ),
        guard: (
            "heartbeats say 04, or the board says 4331 or 4375",
            "心跳为 04，或控制板报 4331、4375",
        ),
        judge: stopped,
    },
    Rule {
        number: 11,
        group: Group::Network,
        fault: ("a node sends no heartbeats", "某节点不发送心跳"),
        remedy: (
            "write its 1017h; the board's is 9023",
            "写入其 1017h；控制板为 9023",
        ),
        guard: (
            "its 1017h was read, is 0, and no heartbeat was heard",
            "已读到其 1017h 为 0，且没有心跳",
        ),
        judge: no_heartbeat,
    },
    Rule {
        number: 12,
        group: Group::Network,
        fault: (
            "heartbeats come more seldom than their consumer waits",
            "心跳周期长于消费者等待时间",
        ),
        remedy: (
            "shorten the producer's 1017h, or lengthen the consumer's 1016h (9024)",
            "缩短生产者的 1017h，或加长消费者的 1016h（9024）",
        ),
        guard: (
            "three gaps in a row, alike within a fifth: not a producer that ended",
            "连续三个间隔，彼此相差不超过五分之一：不是已结束的生产者",
        ),
        judge: too_seldom,
    },
    Rule {
        number: 13,
        group: Group::Network,
        fault: (
            "a node misses heartbeats (8130h)",
            "某节点丢失心跳（8130h）",
        ),
        remedy: (
            "look at who sends them; the time is 1016h (9024), or 100Ch and 100Dh",
            "检查心跳的发送者；时间为 1016h（9024）或 100Ch、100Dh",
        ),
        guard: ("not where rule 12 explains it", "规则 12 能解释时除外"),
        judge: missed,
    },
];

/// Rule 7 sees only that a node is silent: it is asked behind all that can tell why.
pub const SILENT: &[Rule] = &[Rule {
    number: 7,
    group: Group::Network,
    fault: ("a node does not answer at all", "某节点毫无应答"),
    remedy: (
        "look at its supply and plug; compare its number with 9015 and 9016; one that was heard before may have been stopped \
             (NMT) by another master",
        "检查其电源和插头；核对其编号与 9015、9016；先前有报文者可能被另一主站停止（NMT）",
    ),
    guard: (
        "it was told something for a second and was silent all that time, while others were heard",
        "一秒以上一直在向它发送，它始终无声，而其他节点有报文",
    ),
    judge: silent,
}];

fn clash(heard: &Heard) -> Verdict {
    let mut all = Vec::new();
    for (id, hits) in &heard.period.twice {
        if let (true, Some((service, node))) = (hits.enough(), id.service()) {
            let (id, count) = (id.get(), hits.count);
            let whose = match service {
                Service::Rpdo1 => both!("setpoints", "设定值"),
                _ => both!("statuses", "状态"),
            };
            all.push(Found::at(
                node,
                hits,
                both!(
                    "{count} times two {en} with different contents in one period, under {id:03X}h",
                    "{id:03X}h 在一个周期内出现两个内容不同的{zh}，共 {count} 次",
                    en = whose.en,
                    zh = whose.zh
                ),
            ));
        }
    }
    for (node, of) in &heard.nodes {
        if of.twins.enough() {
            let id = 0x700 + u16::from(node.get());
            all.push(Found::at(
                *node,
                &of.twins,
                both!(
                    "two boot-ups at once under {id:03X}h, and no NMT reset before",
                    "{id:03X}h 同时有两个启动报文，之前没有 NMT 复位"
                ),
            ));
        }
    }
    for alarm in [4332, 4374] {
        if let Some(hits) = heard.board.alarms.get(&alarm).filter(|hits| hits.enough())
            && all.is_empty()
        {
            all.push(Found::alarm(heard, alarm, hits));
        }
    }
    found(all)
}

fn silent(heard: &Heard) -> Verdict {
    // Where nobody is heard at all there is no board: rule 14.
    let heard_any = heard.nodes.values().any(|node| node.frames > 0);
    let second = Duration::from_secs(1);
    let all = heard.nodes.iter().filter_map(|(node, of)| {
        let (first, last) = (of.asked.first?, of.asked.last?);
        let from = of.last.map_or(first, |heard| heard.max(first));
        let time = last.since(from);
        // One that operates is no server.
        let asked = of.asked.enough() && *node != NodeId::GATEWAY;
        let board_rests = *node == heard.machine.board && heard.sync.count > 0;
        // That has a rule of its own.
        let is_block = Some(*node) == heard.machine.block;
        if !asked || time < second || !heard_any || board_rests || is_block {
            return None;
        }
        let name = heard.machine.called(*node);
        let (ms, frames) = (time.as_millis(), of.frames);
        let drive = heard
            .machine
            .drives
            .iter()
            .find(|drive| drive.node == *node);
        let said = match frames {
            0 => both!(
                "{en} was told something for {ms} ms and never sent a frame",
                "向{zh}发送了 {ms} ms，它从未发出报文",
                en = name.en,
                zh = name.zh
            ),
            _ => both!(
                "{en} has been silent for the last {ms} ms that it was told something",
                "{zh}在最近 {ms} ms 的发送中一直无声",
                en = name.en,
                zh = name.zh
            ),
        };
        let found = Found::at(*node, &of.asked, said);
        Some(match drive {
            Some(drive) if frames == 0 => {
                let no = if drive.name.is_spindle() {
                    "9016".to_owned()
                } else {
                    format!("9015.{}", drive.name)
                };
                found.mended_by(Mend::Set(format!("{no}=NUMBER")))
            }
            _ => found,
        })
    });
    found(all)
}

fn restarts(heard: &Heard) -> Verdict {
    found(heard.nodes.iter().filter_map(|(node, of)| {
        let count = of.unasked.count;
        if count < 3 {
            return None;
        }
        let name = heard.machine.called(*node);
        Some(Found::at(
            *node,
            &of.unasked,
            both!(
                "{count} boot-ups of {en}, and no NMT reset before them",
                "{zh} 启动 {count} 次，之前没有 NMT 复位",
                en = name.en,
                zh = name.zh
            ),
        ))
    }))
}

fn not_started(heard: &Heard) -> Verdict {
    found(heard.nodes.iter().filter_map(|(node, of)| {
        if !of.waits.enough() {
            return None;
        }
        let name = heard.machine.called(*node);
        let found = Found::at(
            *node,
            &of.waits,
            both!(
                "heartbeats of {en} say 7Fh (pre-operational), and nobody starts it",
                "{zh}的心跳为 7Fh（预运行），无人启动它",
                en = name.en,
                zh = name.zh
            ),
        );
        Some(found.mended_by(Mend::Start(*node)))
    }))
}

fn stopped(heard: &Heard) -> Verdict {
    let mut all = Vec::new();
    for (node, of) in &heard.nodes {
        if of.stopped.enough() {
            let name = heard.machine.called(*node);
            let found = Found::at(
                *node,
                &of.stopped,
                both!(
                    "heartbeats of {en} say 04h (stopped)",
                    "{zh}的心跳为 04h（停止）",
                    en = name.en,
                    zh = name.zh
                ),
            );
            all.push(found.mended_by(Mend::Start(*node)));
        }
    }
    for alarm in [4331, 4375] {
        if let Some(hits) = heard.board.alarms.get(&alarm).filter(|hits| hits.enough()) {
            all.push(Found::alarm(heard, alarm, hits));
        }
    }
    found(all)
}

fn no_heartbeat(heard: &Heard) -> Verdict {
    let mut known = false;
    let mut all = Vec::new();
    for (node, of) in &heard.nodes {
        let Some((at, ms)) = heard.objects.value(*node, 0x1017, 0) else {
            continue;
        };
        known = true;
        if ms == 0 && of.beats == 0 {
            let name = heard.machine.called(*node);
            let found = Found::at(
                *node,
                &Hits::standing(at),
                both!(
                    "1017h of {en} is 0",
                    "{zh}的 1017h 为 0",
                    en = name.en,
                    zh = name.zh
                ),
            );
            all.push(match *node == heard.machine.board {
                true => found.mended_by(Mend::Set("9023=500".into())),
                false => found,
            });
        }
    }
    found_or(all, known, Lack::Objects("1017h"))
}

fn too_seldom(heard: &Heard) -> Verdict {
    // Consumers by 1016h, or by the parameters where nobody has read it.
    let mut waits = Vec::new();
    for (consumer, object) in heard.objects.done.keys() {
        if object.index == 0x1016
            && object.sub > 0
            && let Some((_, raw)) = heard.objects.value(*consumer, 0x1016, object.sub)
            && let Some(producer) = NodeId::new((raw >> 16 & 0x7F) as u8)
        {
            waits.push((*consumer, producer, raw & 0xFFFF));
        }
    }
    let silence = heard.machine.params.gateway_silence_ms();
    if waits.is_empty() && heard.machine.told {
        waits.push((heard.machine.board, NodeId::GATEWAY, silence));
    }
    let mut all = Vec::new();
    for (consumer, producer, ms) in &waits {
        let Some(of) = heard.nodes.get(producer).filter(|_| *ms > 0) else {
            continue;
        };
        let limit = Duration::from_millis(u64::from(*ms));
        let run = of.gaps.windows(3).find(|gaps| {
            let times = gaps.iter().map(|(_, gap)| *gap);
            let (low, high) = (times.clone().min(), times.max());
            low.is_some_and(|low| low > limit && high.is_some_and(|high| high <= low * 6 / 5))
        });
        if let Some([.., (at, gap)]) = run {
            let names = [producer, consumer].map(|node| heard.machine.called(*node));
            let [from, to] = names;
            let gap = gap.as_millis();
            let found = Found::at(
                *producer,
                &Hits::standing(*at),
                both!(
                    "{from} sends a heartbeat every {gap} ms, and {to} waits {ms} ms for it",
                    "{from_zh}每 {gap} ms 发送心跳，而{to_zh}只等 {ms} ms",
                    from = from.en,
                    to = to.en,
                    from_zh = from.zh,
                    to_zh = to.zh
                ),
            );
            all.push(match *consumer == heard.machine.board {
                true => found.mended_by(Mend::Set(format!("9024={}", gap * 2))),
                false => found,
            });
        }
    }
    found_or(all, !waits.is_empty(), Lack::Parameters)
}

fn missed(heard: &Heard) -> Verdict {
    found(by_emergency(heard, 0x8130))
}

/// Nodes that tell an emergency with this code, often or long enough.
pub(super) fn by_emergency(heard: &Heard, code: u16) -> Vec<Found> {
    let tell = |(node, of): (&NodeId, &crate::doctor::heard::nodes::Node)| {
        let hits = of.emergencies.get(&code).filter(|hits| hits.enough())?;
        let name = heard.machine.called(*node);
        let count = hits.count;
        Some(Found::at(
            *node,
            hits,
            both!(
                "{en} tells emergency {code:04X}h, {count} times",
                "{zh}报告紧急报文 {code:04X}h，共 {count} 次",
                en = name.en,
                zh = name.zh
            ),
        ))
    };
    heard.nodes.iter().filter_map(tell).collect()
}
