//! Rules 1–5: the wire itself.

use super::{Found, Group, Lack, Rule, Verdict, found};
use crate::doctor::heard::Heard;
use crate::doctor::hits::Hits;
use crate::doctor::machine::Clock;
use crate::doctor::mend::Mend;
use crate::words::both;

/// Rules 1–5.
pub const RULES: &[Rule] = &[
    Rule {
        number: 1,
        group: Group::Wire,
        fault: (
            "a node has another bit rate than the others",
            "某节点的波特率与其他节点不同",
        ),
        remedy: (
            "set its bit rate to parameter 9020 (a drive by its switches or its own program; an interface by `ip link`)",
            "把它的波特率设为参数 9020（驱动器用拨码或其软件，接口用 `ip link`）",
        ),
        guard: (
            "8 error frames and more: with nearly all frames of one node and hardly any of the others, with no frame at all, \
             or while exactly one drive is silent",
            "至少 8 个错误帧：几乎都与同一节点的报文相伴，或根本没有报文，或恰有一台驱动器无声",
        ),
        judge: bit_rate,
    },
    Rule {
        number: 2,
        group: Group::Wire,
        fault: ("the terminator is missing or doubled", "终端电阻缺失或重复"),
        remedy: (
            "measure between CAN_H and CAN_L without power: 60 Ω is right, 120 Ω one missing, 40 Ω one too many",
            "断电测量 CAN_H 与 CAN_L 之间：60 Ω 正确，120 Ω 缺一个，40 Ω 多一个",
        ),
        guard: (
            "errors with frames of two nodes and more, over more than 10 s, and the counters grow where they are told",
            "错误涉及两个以上节点，持续 10 s 以上；若报告计数器，则其在增长",
        ),
        judge: termination,
    },
    Rule {
        number: 3,
        group: Group::Wire,
        fault: ("nobody acknowledges", "无人应答（ACK）"),
        remedy: (
            "plug the cable in, switch the others on, and compare the bit rates",
            "插好电缆，给其他节点上电，并核对波特率",
        ),
        guard: (
            "no frame of another node since, and the counter for sending at 128 where it is told",
            "此后没有其他节点的报文；若报告发送计数器，则已达 128",
        ),
        judge: alone,
    },
    Rule {
        number: 4,
        group: Group::Wire,
        fault: (
            "one node is error passive or bus-off",
            "某节点处于错误被动或离线状态",
        ),
        remedy: (
            "look at its plug, its stub (less than 30 cm at 1 Mbit/s) and its transceiver",
            "检查它的插头、支线（1 Mbit/s 时短于 30 cm）和收发器",
        ),
        guard: (
            "not where rule 1, 2 or 3 explains it",
            "规则 1、2、3 能解释时除外",
        ),
        judge: passive,
    },
    Rule {
        number: 5,
        group: Group::Wire,
        fault: (
            "process data take more than 90 % of the wire",
            "过程数据占用总线超过 90 %",
        ),
        remedy: (
            "let the drives answer less often (9021 and their 1800h:02, both), or lengthen the tick (9000)",
            "降低驱动器应答频率（9021 与其 1800h:02 同时修改），或加长周期（9000）",
        ),
        guard: (
            "over a second and longer; transfers (SDO) are not counted; not in virtual time",
            "持续一秒以上；不计 SDO 传输；虚拟时间下不判断",
        ),
        judge: load,
    },
];

fn bit_rate(heard: &Heard) -> Verdict {
    let errors = &heard.errors;
    let line = &errors.line;
    if line.count < 8 {
        return Verdict::Clean;
    }
    let count = line.count;
    if heard.frames == 0 {
        return found([Found::of_bus(
            line,
            both!(
                "{count} error frames and not one good frame: this interface has another bit rate than the bus",
                "{count} 个错误帧，没有一个正常报文：本接口的波特率与总线不同"
            ),
        )]);
    }
    let attributed: u64 = errors.with.values().sum();
    for (node, with) in &errors.with {
        let own = heard.nodes.get(node).map_or(0, |heard| heard.frames);
        if *with >= 8 && with * 10 >= own * 9 && with * 10 >= attributed * 9 {
            let name = heard.machine.called(*node);
            return found([Found::at(
                *node,
                line,
                both!(
                    "{with} of the {own} frames of {en} came with an error frame",
                    "{zh} 的 {own} 帧中有 {with} 帧伴有错误帧",
                    en = name.en,
                    zh = name.zh
                ),
            )]);
        }
    }
    let silent: Vec<_> = heard
        .machine
        .drives
        .iter()
        .filter(|drive| {
            heard
                .nodes
                .get(&drive.node)
                .is_none_or(|node| node.frames == 0)
        })
        .collect();
    match silent.as_slice() {
        [one] => {
            let name = heard.machine.called(one.node);
            found([Found::at(
                one.node,
                line,
                both!(
                    "{count} error frames, and {en} alone was never heard",
                    "{count} 个错误帧，且只有{zh}从未出现",
                    en = name.en,
                    zh = name.zh
                ),
            )])
        }
        _ => Verdict::Clean,
    }
}

fn termination(heard: &Heard) -> Verdict {
    let errors = &heard.errors;
    let line = &errors.line;
    let (Some(first), Some(last)) = (line.first, line.last) else {
        return Verdict::Clean;
    };
    let grow = errors.counters.is_none_or(|[first, most]| most > first);
    let several = errors.with.len() >= 2;
    if !line.enough() || !grow || !several {
        return Verdict::Clean;
    }
    let span = last.since(first);
    if span.as_secs() < 10 {
        return Verdict::Not(Lack::Time);
    }
    let (count, nodes, seconds) = (line.count, errors.with.len(), span.as_secs());
    let (tx, rx) = errors.counters.map_or((0, 0), |[_, most]| most);
    found([Found::of_bus(
        line,
        both!(
            "{count} error frames with frames of {nodes} nodes over {seconds} s; counters up to {tx} sending, {rx} receiving",
            "{seconds} s 内 {count} 个错误帧，涉及 {nodes} 个节点；计数器最高：发送 {tx}、接收 {rx}"
        ),
    )])
}

fn alone(heard: &Heard) -> Verdict {
    let errors = &heard.errors;
    let full = errors.counters.is_none_or(|[_, (tx, _)]| tx >= 128);
    if !errors.no_acknowledge.enough() || errors.heard_since > 0 || !full {
        return Verdict::Clean;
    }
    let count = errors.no_acknowledge.count;
    found([Found::of_bus(
        &errors.no_acknowledge,
        both!(
            "{count} frames that nobody acknowledged, and no frame of anybody since",
            "{count} 帧无人应答，此后没有任何节点的报文"
        ),
    )])
}

fn passive(heard: &Heard) -> Verdict {
    let mut all = Vec::new();
    let own = heard.errors.bus_off.clone().with(&heard.errors.passive);
    if own.enough() {
        all.push(Found::of_bus(
            &own,
            both!(
                "this computer's own controller is error passive or bus-off",
                "本机的控制器处于错误被动或离线状态"
            ),
        ));
    }
    for (node, of) in &heard.nodes {
        let mut hits = of.passive.clone();
        for code in [0x8120, 0x8140] {
            if let Some(emergency) = of.emergencies.get(&code) {
                hits = hits.with(emergency);
            }
        }
        if *node == heard.machine.board {
            for alarm in [4370, 4371, 4386] {
                if let Some(stands) = heard.board.alarms.get(&alarm) {
                    hits = hits.with(stands);
                }
            }
        }
        if hits.enough() {
            let name = heard.machine.called(*node);
            let count = hits.count;
            all.push(Found::at(
                *node,
                &hits,
                both!(
                    "{en} says {count} times that its controller is error passive or bus-off",
                    "{zh} {count} 次报告其控制器处于错误被动或离线状态",
                    en = name.en,
                    zh = name.zh
                ),
            ));
        }
    }
    found(all)
}

fn load(heard: &Heard) -> Verdict {
    if !heard.is_in_real_time() {
        return Verdict::Not(Lack::Clock);
    }
    let rate = u64::from(heard.machine.params.bus_kbit()) * 1000;
    let mut hits = Hits::default();
    let mut most = 0;
    match heard.machine.clock {
        Clock::Kernel => {
            for (at, bits) in &heard.load.seconds {
                most = most.max(*bits);
                if bits * 10 > rate * 9 {
                    hits = hits.with(&Hits::standing(*at));
                }
            }
        }
        // Stamps in bunches: a second of them may hold more than a second.
        Clock::Program => {
            most = heard.load.mean().unwrap_or(0);
            if most * 10 > rate * 9 {
                hits = Hits::standing(heard.now);
            }
        }
    }
    if !hits.enough() {
        return Verdict::Clean;
    }
    let percent = most * 100 / rate.max(1);
    let kbit = heard.machine.params.bus_kbit();
    let every = heard.machine.params.drive_status_syncs().saturating_mul(2);
    found([Found::of_bus(
        &hits,
        both!(
            "process data take {percent} % of {kbit} kbit/s",
            "过程数据占 {kbit} kbit/s 的 {percent} %"
        ),
    )
    // Both sides: the drives go on at their own 1800h:02.
    .mended_by(Mend::Push(Some(format!(
        "9021 = {every}, and in each [drive.*] tpdo1_transmission = {every}"
    ))))])
}
