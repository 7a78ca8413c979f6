//! Rules 22–32: process data, and the settings behind them.

use std::collections::BTreeMap;
use std::time::Duration;

use leadscrew_core::bus::{DriveStatus, Mapped, NodeId, Object};

use super::network::by_emergency;
use super::{Found, Group, Lack, Rule, Verdict, found, found_or};
use crate::doctor::heard::Heard;
use crate::doctor::heard::sdo::Deed;
use crate::doctor::hits::Hits;
use crate::doctor::machine::Expected;
use crate::doctor::mend::Mend;
use crate::params::drives::command_mapping;
use crate::words::both;

/// Rules 22–32.
pub const RULES: &[Rule] = &[
    Rule {
        number: 22,
        group: Group::Pdo,
        fault: (
            "setpoints come after the SYNC that was to latch them",
            "设定值晚于应锁存它的 SYNC",
        ),
        remedy: (
            "give the board's computer less else to do; how many may be late is 9027",
            "减轻控制板计算机的其他负担；允许的迟到数为 9027",
        ),
        guard: (
            "the board counts them, stands on 4372, or a period without a setpoint is followed by one with two",
            "控制板计数、停在 4372，或一个周期没有设定值而下一周期有两个",
        ),
        judge: late,
    },
    Rule {
        number: 23,
        group: Group::Pdo,
        fault: (
            "a PDO is shorter than its mapping (8210h)",
            "PDO 短于其映射（8210h）",
        ),
        remedy: (
            "write the mapping that the board needs: `params push`",
            "写入控制板所需的映射：`params push`",
        ),
        guard: ("none", "无"),
        judge: shorter,
    },
    Rule {
        number: 24,
        group: Group::Pdo,
        fault: (
            "a PDO is longer than its mapping (8220h)",
            "PDO 长于其映射（8220h）",
        ),
        remedy: (
            "write the mapping that the board needs; with a frame for all (9031 = 1) silence it by 1029h, or set 9031 = 0",
            "写入控制板所需的映射；使用合并报文（9031 = 1）时用 1029h 关闭该紧急报文，或设 9031 = 0",
        ),
        guard: ("none", "无"),
        judge: longer,
    },
    Rule {
        number: 25,
        group: Group::Pdo,
        fault: (
            "a PDO has another mapping than the board needs",
            "PDO 映射与控制板所需不同",
        ),
        remedy: (
            "`leadscrew params push` writes it",
            "用 `leadscrew params push` 写入",
        ),
        guard: ("1600h and 1A00h were told", "已得知 1600h、1A00h"),
        judge: mapping,
    },
    Rule {
        number: 26,
        group: Group::Pdo,
        fault: (
            "setpoints act at once, not at SYNC",
            "设定值立即生效，而非在 SYNC 时",
        ),
        remedy: ("write 1 to 1400h:02", "向 1400h:02 写入 1"),
        guard: ("1400h:02 was told", "已得知 1400h:02"),
        judge: at_once,
    },
    Rule {
        number: 27,
        group: Group::Pdo,
        fault: (
            "a drive answers at other SYNCs than 9021 says",
            "驱动器的应答间隔与 9021 不符",
        ),
        remedy: (
            "make 1800h:02 of the drive and 9021 the same",
            "使驱动器的 1800h:02 与 9021 一致",
        ),
        guard: (
            "16 answers and more, nine tenths of them at the same distance",
            "至少 16 次应答，九成间隔相同",
        ),
        judge: cadence,
    },
    Rule {
        number: 28,
        group: Group::Pdo,
        fault: (
            "all drives answer at the same SYNC",
            "所有驱动器在同一个 SYNC 应答",
        ),
        remedy: (
            "give each drive another 1800h:06",
            "给各驱动器不同的 1800h:06",
        ),
        guard: (
            "three drives and more, and 9021 above 1; not where rule 27 explains it",
            "至少三台驱动器且 9021 大于 1；规则 27 能解释时除外",
        ),
        judge: bunched,
    },
    Rule {
        number: 29,
        group: Group::Pdo,
        fault: (
            "a PDO is switched off (bit 31 of its COB-ID)",
            "PDO 被关闭（COB-ID 第 31 位）",
        ),
        remedy: (
            "write its COB-ID without bit 31",
            "写入第 31 位为 0 的 COB-ID",
        ),
        guard: (
            "1400h:01 and 1800h:01 were told",
            "已得知 1400h:01、1800h:01",
        ),
        judge: switched_off,
    },
    Rule {
        number: 30,
        group: Group::Pdo,
        fault: (
            "an object cannot be mapped, or a mapping is too long",
            "对象不可映射，或映射过长",
        ),
        remedy: (
            "map what the drive's manual lists, eight bytes at most",
            "只映射驱动器手册列出的对象，最多八字节",
        ),
        guard: (
            "06040041h or 06040042h, and not written well within a second",
            "06040041h 或 06040042h，且一秒内未成功写入",
        ),
        judge: not_mappable,
    },
    Rule {
        number: 31,
        group: Group::Pdo,
        fault: (
            "a setting was written outside pre-operational",
            "在非预运行状态写入设置",
        ),
        remedy: (
            "bring the drive to pre-operational first; `params push` does",
            "先让驱动器进入预运行；`params push` 会这样做",
        ),
        guard: (
            "08000022h for 1400h–1BFFh or 60C2h, and not written well within a second",
            "对 1400h–1BFFh 或 60C2h 返回 08000022h，且一秒内未成功写入",
        ),
        judge: wrong_state,
    },
    Rule {
        number: 32,
        group: Group::Pdo,
        fault: ("settings are gone after power-up", "上电后设置丢失"),
        remedy: (
            "write `save` (65766173h) to 1010h:01 of the drive",
            "向驱动器 1010h:01 写入 `save`（65766173h）",
        ),
        guard: (
            "told before and after a boot-up, and different",
            "启动前后均已得知且不同",
        ),
        judge: forgotten,
    },
];

fn late(heard: &Heard) -> Verdict {
    let mut hits = heard.board.late.clone().with(&heard.period.late);
    if let Some(alarm) = heard.board.alarms.get(&4372) {
        hits = hits.with(alarm);
    }
    if !hits.enough() && heard.board.late_setpoints < 3 {
        return Verdict::Clean;
    }
    let (told, seen) = (heard.board.late_setpoints, heard.period.late.count);
    found([Found::at(
        heard.machine.board,
        &hits,
        both!(
            "the board counts {told} late setpoints; {seen} seen a period late",
            "控制板计有 {told} 个迟到设定值；观察到 {seen} 个迟到一个周期"
        ),
    )])
}

fn shorter(heard: &Heard) -> Verdict {
    let all = by_emergency(heard, 0x8210).into_iter();
    found(all.map(|found| found.mended_by(Mend::Push(None))))
}

fn longer(heard: &Heard) -> Verdict {
    let mend = match heard.machine.params.setpoint_frame() {
        0 => Mend::Push(None),
        _ => Mend::Set("9031=0".into()),
    };
    let all = by_emergency(heard, 0x8220).into_iter();
    found(all.map(|found| found.mended_by(mend.clone())))
}

fn mapping(heard: &Heard) -> Verdict {
    let mut known = false;
    let mut all = Vec::new();
    for drive in &heard.machine.drives {
        let command = command_mapping(drive.name, &heard.machine.params);
        for (index, wanted) in [(0x1600, command), (0x1A00, DriveStatus::MAPPING.to_vec())] {
            let Some((at, told)) = heard.objects.mapping(drive.node, index) else {
                continue;
            };
            known = true;
            let wanted: Vec<u32> = wanted.into_iter().map(Mapped::raw).collect();
            if told == wanted {
                continue;
            }
            let name = drive.name;
            let list = |all: &[u32]| {
                let all: Vec<String> = all.iter().map(|raw| format!("{raw:08X}h")).collect();
                all.join(" ")
            };
            let (told, wanted) = (list(&told), list(&wanted));
            let found = Found::at(
                drive.node,
                &Hits::standing(at),
                both!(
                    "{index:04X}h of drive {name} is {told}, the board needs {wanted}",
                    "驱动器 {name} 的 {index:04X}h 为 {told}，控制板需要 {wanted}"
                ),
            );
            all.push(found.mended_by(Mend::Push(None)));
        }
    }
    found_or(all, known, Lack::Objects("1600h, 1A00h"))
}

/// What one object of each drive says.
fn objects(heard: &Heard, index: u16, sub: u8) -> impl Iterator<Item = (&Expected, Hits, u32)> {
    heard.machine.drives.iter().filter_map(move |drive| {
        let (at, value) = heard.objects.value(drive.node, index, sub)?;
        Some((drive, Hits::standing(at), value))
    })
}

fn at_once(heard: &Heard) -> Verdict {
    let known = objects(heard, 0x1400, 2).next().is_some();
    let wrong = objects(heard, 0x1400, 2).filter(|(_, _, value)| *value >= 254);
    let all = wrong.map(|(drive, hits, value)| {
        let name = drive.name;
        Found::at(
            drive.node,
            &hits,
            both!(
                "1400h:02 of drive {name} is {value}",
                "驱动器 {name} 的 1400h:02 为 {value}"
            ),
        )
        .mended_by(Mend::Push(Some(format!(
            "[drive.{name}] rpdo1_transmission = 1"
        ))))
    });
    found_or(all, known, Lack::Objects("1400h:02"))
}

/// SYNCs from answer to answer, where nearly all are alike.
fn every(heard: &Heard, node: NodeId) -> Option<u64> {
    let cadence = &heard.drives.get(&node)?.cadence;
    let all: u64 = cadence.values().sum();
    let (every, count) = cadence.iter().max_by_key(|(_, count)| **count)?;
    (all >= 16 && count * 10 >= all * 9).then_some(*every)
}

fn cadence(heard: &Heard) -> Verdict {
    let wanted = u64::from(heard.machine.params.drive_status_syncs());
    let mut known = false;
    let mut all = Vec::new();
    for drive in &heard.machine.drives {
        let Some(every) = every(heard, drive.node) else {
            continue;
        };
        known = true;
        if every != wanted {
            let name = drive.name;
            let mut hits = Hits::standing(heard.now);
            hits.count = heard
                .drives
                .get(&drive.node)
                .map_or(0, |drive| drive.statuses);
            let found = Found::at(
                drive.node,
                &hits,
                both!(
                    "drive {name} answers at every {every}th SYNC, 9021 is {wanted}",
                    "驱动器 {name} 每 {every} 个 SYNC 应答一次，9021 为 {wanted}"
                ),
            );
            all.push(found.mended_by(Mend::Push(Some(format!(
                "[drive.{name}] tpdo1_transmission = {wanted}"
            )))));
        }
    }
    found_or(all, known, Lack::Time)
}

fn bunched(heard: &Heard) -> Verdict {
    let wanted = u64::from(heard.machine.params.drive_status_syncs());
    let mut places: BTreeMap<NodeId, u64> = BTreeMap::new();
    for drive in &heard.machine.drives {
        let Some(of) = heard.drives.get(&drive.node) else {
            continue;
        };
        let all: u64 = of.places.values().sum();
        let most = of.places.iter().max_by_key(|(_, count)| **count);
        if let Some((place, count)) = most
            && all >= 16
            && count * 10 >= all * 9
            && every(heard, drive.node) == Some(wanted)
        {
            places.insert(drive.node, *place);
        }
    }
    let mut values = places.values();
    let first = values.next();
    if wanted < 2 || places.len() < 3 || !values.all(|place| Some(place) == first) {
        return Verdict::Clean;
    }
    let drives = places.len();
    found([Found::of_bus(
        &Hits::standing(heard.now),
        both!(
            "{drives} drives answer at every {wanted}th SYNC, and all at the same one",
            "{drives} 台驱动器每 {wanted} 个 SYNC 应答，且都在同一个"
        ),
    )
    .mended_by(Mend::Push(Some("[drive.Z] tpdo1_start = 2".into())))])
}

fn switched_off(heard: &Heard) -> Verdict {
    let mut known = false;
    let mut all = Vec::new();
    for index in [0x1400, 0x1800] {
        for (drive, hits, value) in objects(heard, index, 1) {
            known = true;
            if value & 1 << 31 != 0 {
                let name = drive.name;
                all.push(Found::at(
                    drive.node,
                    &hits,
                    both!(
                        "{index:04X}h:01 of drive {name} is {value:08X}h",
                        "驱动器 {name} 的 {index:04X}h:01 为 {value:08X}h"
                    ),
                ));
            }
        }
    }
    found_or(all, known, Lack::Objects("1400h:01, 1800h:01"))
}

/// Writes that were refused with one of these codes, and not taken within a second.
fn refused(heard: &Heard, codes: &[u32], of: impl Fn(NodeId, Object) -> bool) -> Vec<Found> {
    let second = Duration::from_secs(1);
    let mut all = Vec::new();
    for ((node, object), transfers) in &heard.objects.done {
        if !of(*node, *object) {
            continue;
        }
        let mut hits = Hits::default();
        let mut code = 0;
        for transfer in transfers {
            match transfer.deed {
                Deed::NotWritten(why) if codes.contains(&why) => {
                    code = why;
                    hits.begin(transfer.at, &transfer.packet);
                }
                Deed::Written(_) => hits.end(transfer.at),
                _ => {}
            }
        }
        hits.end(heard.now);
        if hits.enough() && hits.longest >= second {
            let name = heard.machine.called(*node);
            let Object { index, sub } = *object;
            all.push(Found::at(
                *node,
                &hits,
                both!(
                    "{en} refuses {index:04X}h:{sub:02X} with {code:08X}h",
                    "{zh}以 {code:08X}h 拒绝 {index:04X}h:{sub:02X}",
                    en = name.en,
                    zh = name.zh
                ),
            ));
        }
    }
    all
}

fn not_mappable(heard: &Heard) -> Verdict {
    found(refused(heard, &[0x0604_0041, 0x0604_0042], |_, _| true))
}

fn wrong_state(heard: &Heard) -> Verdict {
    let setting = |_, object: Object| matches!(object.index, 0x1400..=0x1BFF | 0x60C2);
    let all = refused(heard, &[0x0800_0022], setting).into_iter();
    found(all.map(|found| found.mended_by(Mend::Push(None))))
}

/// Objects that are settings, not values of the moment.
const fn is_setting(index: u16) -> bool {
    matches!(
        index,
        0x1005..=0x1007 | 0x1014..=0x1019 | 0x1400..=0x1BFF | 0x6007 | 0x6065..=0x6068 | 0x607C..=0x607F
            | 0x6083..=0x6092 | 0x6098..=0x609A | 0x60C2 | 0x60C5
    )
}

fn forgotten(heard: &Heard) -> Verdict {
    let mut known = false;
    let mut all = Vec::new();
    for ((node, object), transfers) in &heard.objects.done {
        let Some(of) = heard.nodes.get(node).filter(|_| is_setting(object.index)) else {
            continue;
        };
        let mut before = None;
        for transfer in transfers {
            let now = match transfer.deed {
                Deed::Read(value) | Deed::Written(value) => value,
                Deed::NotRead(_) | Deed::NotWritten(_) => continue,
            };
            if let Some((at, value)) = before
                && of
                    .boots
                    .iter()
                    .any(|boot| *boot > at && *boot < transfer.at)
                && matches!(transfer.deed, Deed::Read(_))
            {
                known = true;
                if value != now {
                    let name = heard.machine.called(*node);
                    let Object { index, sub } = *object;
                    all.push(Found::at(
                        *node,
                        &Hits::standing(transfer.at),
                        both!(
                            "{index:04X}h:{sub:02X} of {en} was {value:X}h before its boot-up and is {now:X}h",
                            "{zh}的 {index:04X}h:{sub:02X} 启动前为 {value:X}h，现为 {now:X}h",
                            en = name.en,
                            zh = name.zh
                        ),
                    ));
                }
            }
            before = Some((transfer.at, now));
        }
    }
    found_or(all, known, Lack::Objects("1400h–1BFFh, 60C2h"))
}
