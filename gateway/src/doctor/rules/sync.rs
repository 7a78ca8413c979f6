//! Rules 14–21: SYNC and periods.

use std::time::Duration;

use leadscrew_core::bus::Object;

use super::network::by_emergency;
use super::{Found, Group, Lack, Rule, Verdict, found, found_or};
use crate::doctor::heard::Heard;
use crate::doctor::heard::sdo::Deed;
use crate::doctor::hits::Hits;
use crate::doctor::machine::{Clock, Expected};
use crate::doctor::mend::Mend;
use crate::params::drives::period_ns;
use crate::words::both;

/// Rules 14–21.
pub const RULES: &[Rule] = &[
    Rule {
        number: 14,
        group: Group::Sync,
        fault: ("there is no SYNC", "没有 SYNC"),
        remedy: (
            "switch the board on; one that does not join says why on its own output (4333, 4378)",
            "给控制板上电；未加入总线的控制板会在自己的输出上说明原因（4333、4378）",
        ),
        guard: (
            "none for a second, at the end of listening",
            "结束监听前一秒内没有",
        ),
        judge: absent,
    },
    Rule {
        number: 15,
        group: Group::Sync,
        fault: ("two nodes send SYNC", "两个节点发送 SYNC"),
        remedy: (
            "clear bit 30 of 1005h at all but the board; a second board gets a wire of its own",
            "除控制板外，其余节点的 1005h 第 30 位清零；第二块控制板另用一条总线",
        ),
        guard: (
            "a counter that does not follow, or SYNC with and without one; a frame that comes twice is none",
            "计数器不连续，或有计数器与无计数器混杂；重复的同一报文不算",
        ),
        judge: second,
    },
    Rule {
        number: 16,
        group: Group::Sync,
        fault: ("SYNCs are lost", "SYNC 丢失"),
        remedy: (
            "look for a full receive queue or filter, and for errors on the line",
            "检查接收队列或过滤器是否溢出，以及线路错误",
        ),
        guard: (
            "the setpoints between were heard: a gap in the recording is none",
            "其间的设定值仍在：记录中断不算",
        ),
        judge: lost,
    },
    Rule {
        number: 17,
        group: Group::Sync,
        fault: (
            "the period of SYNC is not that of the drive or of the parameters",
            "SYNC 周期与驱动器或参数不符",
        ),
        remedy: ("make 60C2h and 9000 the same", "使 60C2h 与 9000 一致"),
        guard: (
            "off by more than 0.1 %, over a second and 100 SYNCs in real time; 60C2h where it was told, else 9000 of the \
             parameters; not where rule 18 explains it",
            "偏差大于 0.1 %，实时下至少一秒且 100 个 SYNC；有 60C2h 时按其，否则按 9000；规则 18 能解释时除外",
        ),
        judge: period,
    },
    Rule {
        number: 18,
        group: Group::Sync,
        fault: (
            "the drive keeps another 60C2h than was written",
            "驱动器保存的 60C2h 与写入值不同",
        ),
        remedy: (
            "choose a tick that is a multiple of the drive's step (9000)",
            "选用驱动器步长整数倍的周期（9000）",
        ),
        guard: (
            "written and read back, without a boot-up between",
            "写入后读回，其间没有重新启动",
        ),
        judge: step,
    },
    Rule {
        number: 19,
        group: Group::Sync,
        fault: (
            "SYNC jitters more than the drive allows",
            "SYNC 抖动超出驱动器允许范围",
        ),
        remedy: (
            "keep the wire free before SYNC; a board gives the beat, not a computer",
            "SYNC 之前保持总线空闲；由控制板而不是计算机产生节拍",
        ),
        guard: (
            "the window is in the drive's profile (`--drive`), and the stamps are the kernel's",
            "窗口取自驱动器配置（`--drive`），时间戳须来自内核",
        ),
        judge: jitter,
    },
    Rule {
        number: 20,
        group: Group::Sync,
        fault: (
            "the length of SYNC is not what a node expects (8240h)",
            "SYNC 长度与节点预期不符（8240h）",
        ),
        remedy: (
            "write 1019h at both sides, or at none",
            "两侧都写 1019h，或都不写",
        ),
        guard: ("none", "无"),
        judge: length,
    },
    Rule {
        number: 21,
        group: Group::Sync,
        fault: ("1006h is not the period of SYNC", "1006h 与 SYNC 周期不符"),
        remedy: ("write the period in µs to 1006h", "把周期（µs）写入 1006h"),
        guard: ("1006h was read and is not 0", "已读到 1006h 且不为 0"),
        judge: told_period,
    },
];

fn absent(heard: &Heard) -> Verdict {
    let second = Duration::from_secs(1);
    if heard.span() < second {
        return Verdict::Not(Lack::Time);
    }
    let last = heard.sync.last.or(heard.began);
    let Some(last) = last.filter(|last| heard.now.since(*last) >= second) else {
        return Verdict::Clean;
    };
    let ms = heard.now.since(last).as_millis();
    let frames = heard.frames;
    found([Found::of_bus(
        &Hits::standing(last),
        both!(
            "no 080h for {ms} ms; {frames} frames in all",
            "{ms} ms 内没有 080h；共 {frames} 帧"
        ),
    )])
}

fn second(heard: &Heard) -> Verdict {
    let mut hits = heard.sync.foreign.clone();
    let alarm = heard.board.alarms.get(&4373);
    if let Some(alarm) = alarm {
        hits = hits.with(alarm);
    }
    if !hits.enough() {
        return Verdict::Clean;
    }
    let (count, all) = (heard.sync.foreign.count, heard.sync.count);
    let said = match alarm.is_some() {
        true => both!("; the board stands on alarm 4373", "；控制板停在报警 4373"),
        false => both!("", ""),
    };
    found([Found::of_bus(
        &hits,
        both!(
            "{count} of {all} SYNCs do not follow from the one before{en}",
            "{all} 个 SYNC 中有 {count} 个与前一个不连续{zh}",
            en = said.en,
            zh = said.zh
        ),
    )])
}

fn lost(heard: &Heard) -> Verdict {
    let hits = &heard.sync.lost;
    if !hits.enough() {
        return Verdict::Clean;
    }
    let count = hits.count;
    found([Found::of_bus(
        hits,
        both!(
            "the counter of SYNC goes on by more than one {count} times, with the setpoints between",
            "SYNC 计数器 {count} 次跳跃，其间的设定值仍在"
        ),
    )])
}

/// The period of SYNC as measured; where it cannot be, that of the parameters.
fn actual(heard: &Heard) -> (u64, bool) {
    // Stamps in bunches are off by more than a thousandth of what was listened to.
    let exact = heard.machine.clock == Clock::Kernel && heard.is_in_real_time();
    let measured = heard.sync.period().filter(|_| exact);
    let nominal = u64::from(heard.machine.params.tick_us()) * 1000;
    match measured.and_then(|period| u64::try_from(period.as_nanos()).ok()) {
        Some(ns) => (ns, true),
        None => (nominal, false),
    }
}

fn differs(a: u64, b: u64) -> bool {
    a.abs_diff(b) * 1000 > b
}

/// 60C2h of a drive in nanoseconds.
fn interpolation(heard: &Heard, drive: &Expected) -> Option<u64> {
    let (_, value) = heard.objects.value(drive.node, 0x60C2, 1)?;
    let (_, power) = heard.objects.value(drive.node, 0x60C2, 2)?;
    let ns = period_ns(value.into(), i64::from(power as u8 as i8))?;
    u64::try_from(ns).ok()
}

fn period(heard: &Heard) -> Verdict {
    let (actual, measured) = actual(heard);
    let us = actual / 1000;
    let nominal = heard.machine.params.tick_us();
    let at = heard.sync.last.unwrap_or(heard.now);
    let mut known = measured && heard.machine.told;
    let mut all = Vec::new();
    for drive in &heard.machine.drives {
        let Some(theirs) = interpolation(heard, drive) else {
            continue;
        };
        known = true;
        if differs(actual, theirs) && readback(heard, drive).is_none() {
            let theirs = theirs / 1000;
            let name = drive.name;
            let found = Found::at(
                drive.node,
                &Hits::standing(at),
                both!(
                    "SYNC every {us} µs, 60C2h of drive {name} {theirs} µs, 9000 {nominal} µs",
                    "SYNC 每 {us} µs，驱动器 {name} 的 60C2h 为 {theirs} µs，9000 为 {nominal} µs"
                ),
            );
            all.push(found.mended_by(Mend::Push(Some(format!(
                "[drive.{name}] interpolation_period = \"{nominal} µs\""
            )))));
        }
    }
    let own = u64::from(nominal) * 1000;
    if all.is_empty() && measured && heard.machine.told && differs(actual, own) {
        let found = Found::of_bus(
            &Hits::standing(at),
            both!(
                "SYNC every {us} µs, 9000 {nominal} µs",
                "SYNC 每 {us} µs，9000 为 {nominal} µs"
            ),
        );
        all.push(found.mended_by(Mend::Set(format!("9000={us}"))));
    }
    found_or(all, known, Lack::Objects("60C2h"))
}

/// 60C2h as written and as read behind it, where they differ.
fn readback(heard: &Heard, drive: &Expected) -> Option<(Hits, u32, u32)> {
    let boots = heard
        .nodes
        .get(&drive.node)
        .map(|node| node.boots.as_slice());
    for sub in [1, 2] {
        let Some(all) = heard
            .objects
            .done
            .get(&(drive.node, Object::new(0x60C2, sub)))
        else {
            continue;
        };
        let mut written = None;
        for transfer in all {
            match (transfer.deed, written) {
                (Deed::Written(value), _) => written = Some((transfer.at, value)),
                (Deed::Read(value), Some((at, wanted))) if value != wanted => {
                    let between = boots
                        .unwrap_or_default()
                        .iter()
                        .any(|boot| *boot > at && *boot < transfer.at);
                    if !between {
                        return Some((Hits::standing(transfer.at), wanted, value));
                    }
                }
                _ => {}
            }
        }
    }
    None
}

fn step(heard: &Heard) -> Verdict {
    let drives = &heard.machine.drives;
    let all = drives.iter().filter_map(|drive| {
        let (hits, wanted, told) = readback(heard, drive)?;
        let name = drive.name;
        Some(Found::at(
            drive.node,
            &hits,
            both!(
                "60C2h of drive {name}: {wanted} was written and {told} is read",
                "驱动器 {name} 的 60C2h：写入 {wanted}，读回 {told}"
            ),
        ))
    });
    let all: Vec<Found> = all.collect();
    let known = drives.iter().any(|drive| {
        let object = Object::new(0x60C2, 1);
        heard.objects.done.contains_key(&(drive.node, object))
    });
    found_or(all, known, Lack::Objects("60C2h"))
}

fn jitter(heard: &Heard) -> Verdict {
    let windows = heard.machine.drives.iter().filter_map(|drive| {
        let window = drive.known?.window_us?;
        Some((drive, window))
    });
    let windows: Vec<_> = windows.collect();
    if windows.is_empty() {
        return Verdict::Not(Lack::Profile);
    }
    if heard.machine.clock == Clock::Program || !heard.is_in_real_time() {
        return Verdict::Not(Lack::Clock);
    }
    let Some(period) = heard.sync.period() else {
        return Verdict::Not(Lack::Time);
    };
    found(windows.into_iter().filter_map(|(drive, window)| {
        let limit = Duration::from_micros(window.into());
        let off = heard.sync.times.iter().map(|time| time.abs_diff(period));
        let count = off.clone().filter(|off| *off > limit).count();
        let worst = off.max()?.as_micros();
        let name = drive.name;
        let mut hits = Hits::standing(heard.now);
        hits.count = u64::try_from(count).unwrap_or(u64::MAX);
        (count >= 3).then(|| {
            Found::at(
                drive.node,
                &hits,
                both!(
                    "{count} SYNCs outside the ±{window} µs of drive {name}, up to {worst} µs",
                    "{count} 个 SYNC 超出驱动器 {name} 的 ±{window} µs，最大 {worst} µs"
                ),
            )
        })
    }))
}

fn length(heard: &Heard) -> Verdict {
    found(by_emergency(heard, 0x8240))
}

fn told_period(heard: &Heard) -> Verdict {
    let (actual, _) = actual(heard);
    let us = actual / 1000;
    let mut known = false;
    let mut all = Vec::new();
    for node in heard.nodes.keys() {
        let Some((at, told)) = heard.objects.value(*node, 0x1006, 0) else {
            continue;
        };
        known = true;
        if told != 0 && differs(actual, u64::from(told) * 1000) {
            let name = heard.machine.called(*node);
            all.push(Found::at(
                *node,
                &Hits::standing(at),
                both!(
                    "1006h of {en} is {told} µs, SYNC comes every {us} µs",
                    "{zh}的 1006h 为 {told} µs，SYNC 每 {us} µs",
                    en = name.en,
                    zh = name.zh
                ),
            ));
        }
    }
    found_or(all, known, Lack::Objects("1006h"))
}
