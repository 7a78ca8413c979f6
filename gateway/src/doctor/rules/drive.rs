//! Rules 33–48 and 51: drives by CiA 402. They are asked last, and only where no other has fired.

use std::time::Duration;

use leadscrew_core::bus::{Mode, State};
use leadscrew_core::units::Axis;

use super::{Found, Group, Lack, Rule, Verdict, found, found_or};
use crate::doctor::heard::drive::{Drive, takes_setpoints};
use crate::doctor::heard::motion::Way;
use crate::doctor::heard::{FOLLOWING, Heard};
use crate::doctor::hits::Hits;
use crate::doctor::machine::Expected;
use crate::doctor::mend::Mend;
use crate::params::drives::{DriveName, mode};
use crate::words::{Both, both};

macro_rules! rules {
    ($($number:literal $judge:ident $fault:expr, $remedy:expr, $guard:expr;)*) => {
        /// Rules 33–48 and 51.
        pub const RULES: &[Rule] = &[$(Rule {
            number: $number,
            group: Group::Drive,
            fault: $fault,
            remedy: $remedy,
            guard: $guard,
            judge: $judge,
        },)*];
    };
}

rules! {
    51 faulty
        ("the drive has a fault", "驱动器故障"),
        ("look the error code up in the drive's manual, remove the cause, then reset", "在驱动器手册中查找错误代码，排除原因后复位"),
        ("fault (bit 3 of the statusword), or an emergency of a code that no other rule knows; following errors have rules of their own",
         "状态字第 3 位（故障），或其他规则未涉及的紧急报文；跟随误差另有规则");
    33 other_mode
        ("the drive is not in the mode that it was told", "驱动器不在所要求的模式"),
        ("look whether it has the mode, and let it stand before it changes", "确认它支持该模式，并在静止时切换"),
        ("6061h differs from 6060h for longer than 9011", "6061h 与 6060h 不同的时间超过 9011");
    34 not_following
        ("in its mode for setpoints the drive does not follow its targets", "在设定值模式下驱动器不跟随目标"),
        ("look whether it is synchronous: SYNC, 60C2h, 1400h:02", "检查是否同步：SYNC、60C2h、1400h:02"),
        ("enabled for 100 ms, bit 12 of the statusword 0; axes, not in homing", "使能 100 ms 以上而状态字第 12 位为 0；仅轴，不在回零中");
    35 interpolated
        ("the drive is in mode 7 and gets its targets in 607Ah (or in 8, and in 60C1h)", "驱动器处于模式 7，而目标在 607Ah（或处于模式 8，而目标在 60C1h）"),
        ("set its mode to that of 9076 of its axis, or 9076 to its mode; then push its section", "将其模式设为该轴的 9076，或将 9076 设为其模式；再推送其段"),
        ("6061h says 7 or 8 and 9076 the other, by TPDO2 or by SDO", "6061h 为 7 或 8，而 9076 为另一个（TPDO2 或 SDO）");
    36 no_mains
        ("the drive has no mains", "驱动器没有主电源"),
        ("look at contactor, fuse and mains of the drive", "检查驱动器的接触器、熔断器和主电源"),
        ("switch on disabled, bit 4 of the statusword 0, told 0006h for 100 ms, and not out of it later", "禁止接通，状态字第 4 位为 0，0006h 已持续 100 ms，且此后未脱离");
    37 not_enabled
        ("the drive stays ready to switch on", "驱动器停在准备接通状态"),
        ("look at its enable input; its master has to send 0007h and 000Fh", "检查其使能输入；主站须发送 0007h 和 000Fh"),
        ("told 0007h or 000Fh for 100 ms, and not enabled later", "0007h 或 000Fh 已持续 100 ms，且此后未使能");
    38 torque_off
        ("the drive lost its torque by itself", "驱动器自行失去力矩"),
        ("look at safe torque off (STO): its two channels, door and emergency stop", "检查安全转矩关断（STO）的两个通道、门和急停"),
        ("told 000Fh, without a fault, an emergency or a boot-up within a second; or the board says 4358", "仍为 000Fh，一秒内没有故障、紧急报文或启动；或控制板报 4358");
    39 following_in_motion
        ("following error while the axis moves", "运动中跟随误差过大"),
        ("raise the loop's gain or its feed-forward first, then 6065h (1828 at the board)", "先提高增益或前馈，再放宽 6065h（控制板为 1828）"),
        ("at least one outside threads", "至少一次不在螺纹中");
    40 following_in_threads
        ("following error in threads only", "仅在螺纹中跟随误差过大"),
        ("correct the latency (9003), and give the drive feed-forward", "修正延迟（9003），并给驱动器加前馈"),
        ("all of them while the board is on a helix", "全部发生在控制板沿螺旋线时");
    41 following_at_rest
        ("following error at rest", "静止时跟随误差过大"),
        ("look at brake, friction and current limit of the drive", "检查驱动器的制动器、摩擦和电流限制"),
        ("all of them while the target stands for 16 periods", "全部发生在目标静止 16 个周期时");
    42 gear
        ("the drive moves another distance than it is told", "驱动器移动的距离与指令不符"),
        ("make 6091h and 6092h of the drive and 9001 and 9002 the same", "使驱动器的 6091h、6092h 与 9001、9002 一致"),
        ("off by more than 2 % from rest to rest, 1000 counts and more; at rest targets and positions stand for 33 periods", "从静止到静止、1000 个脉冲以上，偏差大于 2 %；静止指目标与位置 33 个周期不变");
    43 reversed
        ("the drive moves the other way", "驱动器反向运动"),
        ("turn 607Eh of the drive (polarity)", "修改驱动器的 607Eh（极性）"),
        ("as rule 42, with a ratio within 2 % of −1", "同规则 42，比值在 −1 的 2 % 以内");
    44 stuck
        ("the drive stands while its target moves", "目标移动而驱动器不动"),
        ("look at brake, coupling and the free way of the axis", "检查制动器、联轴器和轴的行程是否受阻"),
        ("enabled; within 2 counts of one place while its target has been 1000 counts away for 100 ms", "已使能；目标相距 1000 个脉冲以上已 100 ms，而位置变化不超过 2");
    45 jump
        ("the drive is told a place elsewhere while it is being enabled", "使能时的目标与实际位置不同"),
        ("the master has to set 607Ah to 6064h before 000Fh", "主站须在 000Fh 之前令 607Ah 等于 6064h"),
        ("more than 100 counts, in three setpoints", "相差 100 个脉冲以上，三个设定值");
    46 buffer
        ("the drive holds targets back in a buffer", "驱动器的缓冲区推迟目标"),
        ("tell the board by 9003: one period each, and one of interpolation", "用 9003 告知控制板：每个目标一个周期，另加一个插补周期"),
        ("positions are the targets of 3 periods and more before, to 3 counts and in ramps too, or the profile says it; 9003 is \
          smaller", "位置等于 3 个周期以前的目标（误差 3 个脉冲以内，含加减速段），或配置如此；且 9003 较小");
    47 limited
        ("a limit of the drive is active", "驱动器的内部限制起作用"),
        ("widen 607Dh of the drive, or the travel of the board (1320, 1321) is too wide", "放宽驱动器的 607Dh，或控制板行程（1320、1321）过大"),
        ("enabled for 100 ms, bit 11 of the statusword", "使能 100 ms 以上，状态字第 11 位");
    48 homing
        ("homing fails", "回零失败"),
        ("look at the switch and at the method (6098h)", "检查开关和方法（6098h）"),
        ("bit 13 in homing, the board says 4520, 4522, 4526, 4530 or 4532, or three homings end without bit 12; not one cancelled by hand", "回零中第 13 位，或控制板报 4520、4522、4526、4530、4532，或三次回零结束而无第 12 位；手动取消除外");
}

/// A sign at each drive, with words for it.
fn each(
    heard: &Heard,
    sign: impl Fn(&Drive) -> &Hits,
    words: impl Fn(&Expected, &Drive) -> Both,
) -> Vec<Found> {
    let of = |expected: &Expected| {
        let drive = heard.drives.get(&expected.node)?;
        let hits = sign(drive);
        hits.enough()
            .then(|| Found::at(expected.node, hits, words(expected, drive)))
    };
    heard.machine.drives.iter().filter_map(of).collect()
}

/// The statusword in words.
fn word(drive: &Drive) -> String {
    let status = drive.status.map_or(0, |(_, status)| status.status.raw());
    format!("{status:04X}h")
}

/// Emergencies of drives that have rules of their own.
const KNOWN: [u16; 6] = [0x8120, 0x8130, 0x8210, 0x8220, 0x8240, FOLLOWING];

fn faulty(heard: &Heard) -> Verdict {
    found(heard.machine.drives.iter().filter_map(|expected| {
        let drive = heard.drives.get(&expected.node)?;
        let told = heard.nodes.get(&expected.node);
        let told = told.and_then(|node| {
            let mut all = node.emergencies.iter();
            all.find(|(code, hits)| !KNOWN.contains(*code) && hits.enough())
        });
        let hits = match told {
            Some((_, hits)) => hits.clone().with(&drive.fault),
            None if drive.fault.enough() && drive.following.is_empty() => drive.fault.clone(),
            None => return None,
        };
        let (name, word) = (expected.name, word(drive));
        let code = told.map_or_else(String::new, |(code, _)| format!(", {code:04X}h"));
        Some(Found::at(
            expected.node,
            &hits,
            both!(
                "drive {name} has a fault{code} (last statusword {word})",
                "驱动器 {name} 故障{code}（最后状态字 {word}）"
            ),
        ))
    }))
}

/// The mode in which the board gives it setpoints.
fn streamed(heard: &Heard, expected: &Expected) -> u32 {
    mode(expected.name, &heard.machine.params) as u32
}

/// The mode that the drive says, by SDO.
fn mode_told(heard: &Heard, expected: &Expected) -> Option<(Hits, u32)> {
    let (at, mode) = heard.objects.value(expected.node, 0x6061, 0)?;
    Some((Hits::standing(at), mode))
}

fn other_mode(heard: &Heard) -> Verdict {
    let mut all = each(
        heard,
        |drive| &drive.other_mode,
        |expected, drive| {
            let (name, told) = (expected.name, drive.mode.map_or(0, |(_, mode)| mode));
            both!(
                "drive {name} was told mode {told} and says another in its TPDO2",
                "驱动器 {name} 被要求模式 {told}，其 TPDO2 为另一模式"
            )
        },
    );
    let mut known = heard.drives.values().any(|drive| drive.mode.is_some());
    for expected in &heard.machine.drives {
        let Some((hits, mode)) = mode_told(heard, expected) else {
            continue;
        };
        known = true;
        let drive = heard.drives.get(&expected.node);
        let told = match drive.and_then(|drive| drive.mode) {
            Some((_, told)) => u32::from(told),
            None if expected.name.is_spindle() => continue,
            None => heard
                .objects
                .value(expected.node, 0x6060, 0)
                .map_or(streamed(heard, expected), |(_, mode)| mode),
        };
        if mode != told {
            let name = expected.name;
            all.push(Found::at(
                expected.node,
                &hits,
                both!(
                    "6061h of drive {name} is {mode}, 6060h {told}",
                    "驱动器 {name} 的 6061h 为 {mode}，6060h 为 {told}"
                ),
            ));
        }
    }
    found_or(all, known, Lack::Objects("6061h"))
}

fn not_following(heard: &Heard) -> Verdict {
    let all = each(
        heard,
        |drive| &drive.not_following,
        |expected, drive| {
            let (name, word) = (expected.name, word(drive));
            both!(
                "drive {name} is enabled with bit 12 at 0 (last statusword {word})",
                "驱动器 {name} 已使能而第 12 位为 0（最后状态字 {word}）"
            )
        },
    );
    let axis = |found: &Found| {
        let mut drives = heard.machine.drives.iter();
        drives.any(|drive| Some(drive.node) == found.node && !drive.name.is_spindle())
    };
    found(all.into_iter().filter(axis))
}

fn interpolated(heard: &Heard) -> Verdict {
    let mut all = each(
        heard,
        |drive| &drive.interpolated,
        |expected, _| {
            let (name, own) = (expected.name, streamed(heard, expected));
            both!(
                "drive {name} says mode {told} in its TPDO2, 9076 says {own}",
                "驱动器 {name} 的 TPDO2 为模式 {told}，9076 为 {own}",
                told = if own == Mode::Position as u32 {
                    Mode::Interpolated as u32
                } else {
                    Mode::Position as u32
                }
            )
        },
    );
    let mut known = heard.drives.values().any(|drive| drive.mode.is_some());
    for expected in &heard.machine.drives {
        if let Some((hits, mode)) = mode_told(heard, expected) {
            known = true;
            let name = expected.name;
            let own = streamed(heard, expected);
            if u8::try_from(mode).is_ok_and(takes_setpoints) && mode != own {
                all.push(Found::at(
                    expected.node,
                    &hits,
                    both!(
                        "6061h of drive {name} is {mode}, 9076 says {own}",
                        "驱动器 {name} 的 6061h 为 {mode}，9076 为 {own}"
                    ),
                ));
            }
        }
    }
    found_or(all, known, Lack::Objects("6061h"))
}

fn no_mains(heard: &Heard) -> Verdict {
    found(each(
        heard,
        |drive| &drive.no_mains,
        |expected, drive| {
            let (name, word) = (expected.name, word(drive));
            both!(
                "drive {name} stays at statusword {word} and is told 0006h",
                "驱动器 {name} 停在状态字 {word}，而控制字为 0006h"
            )
        },
    ))
}

fn not_enabled(heard: &Heard) -> Verdict {
    found(each(
        heard,
        |drive| &drive.not_enabled,
        |expected, drive| {
            let (name, word) = (expected.name, word(drive));
            both!(
                "drive {name} stays at statusword {word} and is told 0007h or 000Fh",
                "驱动器 {name} 停在状态字 {word}，而控制字为 0007h 或 000Fh"
            )
        },
    ))
}

fn torque_off(heard: &Heard) -> Verdict {
    let mut all = each(
        heard,
        |drive| &drive.torque_off,
        |expected, drive| {
            let (name, word) = (expected.name, word(drive));
            let state = State::SwitchOnDisabled.name();
            both!(
                "drive {name} went from operation enabled to {state} while told 000Fh (statusword {word})",
                "控制字为 000Fh 时驱动器 {name} 从运行使能变为禁止接通（状态字 {word}）"
            )
        },
    );
    // Before anybody listened.
    if let Some(hits) = heard.board.alarms.get(&4358).filter(|hits| hits.enough())
        && all.is_empty()
    {
        all.push(Found::alarm(heard, 4358, hits));
    }
    found(all)
}

/// Following errors, where all of them are of one of these kinds, or any is.
fn following(heard: &Heard, ways: &[Way], all_of_them: bool) -> Verdict {
    found(heard.machine.drives.iter().filter_map(|expected| {
        let drive = heard.drives.get(&expected.node)?;
        let is = |way: Way| ways.contains(&way);
        let mut hits = Hits::default();
        for one in &drive.following {
            hits = hits.with(&one.hits);
        }
        let fits = match all_of_them {
            true => drive.following.iter().all(|one| is(one.way)),
            false => drive.following.iter().any(|one| is(one.way)),
        };
        let first = drive.following.iter().find(|one| is(one.way))?;
        if !fits || !hits.enough() {
            return None;
        }
        let (name, count) = (expected.name, drive.following.len());
        let (distance, speed) = (first.distance, first.speed);
        let periods = distance.checked_div(speed).unwrap_or(0);
        Some(Found::at(
            expected.node,
            &hits,
            both!(
                "drive {name}: {count} following errors; {distance} counts at {speed} counts a period, {periods} periods of lag",
                "驱动器 {name}：{count} 次跟随误差；速度每周期 {speed} 个脉冲时相差 {distance} 个，滞后 {periods} 个周期"
            ),
        ))
    }))
}

fn following_in_motion(heard: &Heard) -> Verdict {
    following(heard, &[Way::Ramp, Way::Steady], false)
}

fn following_in_threads(heard: &Heard) -> Verdict {
    following(heard, &[Way::Thread], true)
}

fn following_at_rest(heard: &Heard) -> Verdict {
    following(heard, &[Way::Rest], true)
}

/// The ratio of positions to targets of each drive.
fn ratios(heard: &Heard, wrong: impl Fn(f64) -> bool) -> Vec<Found> {
    let of = |expected: &Expected| {
        let drive = heard.drives.get(&expected.node)?;
        // What stands is no gear.
        let gear = drive.motion.gear().filter(|_| !drive.stands.enough())?;
        if !wrong(gear.ratio) {
            return None;
        }
        let mut hits = Hits::standing(heard.now);
        hits.count = gear.ways;
        let name = expected.name;
        let (ratio, travel) = (gear.ratio, gear.travel);
        Some(Found::at(
            expected.node,
            &hits,
            both!(
                "drive {name} moves {ratio:.3} counts for one that it is told, over {travel} counts",
                "驱动器 {name} 每个指令脉冲移动 {ratio:.3} 个，行程 {travel} 个脉冲"
            ),
        ))
    };
    heard.machine.drives.iter().filter_map(of).collect()
}

fn is_reversed(ratio: f64) -> bool {
    (ratio + 1.0).abs() <= 0.02
}

/// Each axis that went far came to rest before and behind.
fn has_rested(heard: &Heard) -> bool {
    let mut drives = heard.drives.values().map(|drive| &drive.motion);
    drives.all(|motion| !motion.has_moved() || motion.gear().is_some())
}

fn gear(heard: &Heard) -> Verdict {
    let wrong = |ratio: f64| (ratio - 1.0).abs() > 0.02 && !is_reversed(ratio);
    found_or(ratios(heard, wrong), has_rested(heard), Lack::Rests)
}

fn reversed(heard: &Heard) -> Verdict {
    found_or(ratios(heard, is_reversed), has_rested(heard), Lack::Rests)
}

fn stuck(heard: &Heard) -> Verdict {
    found(each(
        heard,
        |drive| &drive.stands,
        |expected, _| {
            let name = expected.name;
            both!(
                "6064h of drive {name} stands while 607Ah moves",
                "驱动器 {name} 的 607Ah 移动而 6064h 不动"
            )
        },
    ))
}

fn jump(heard: &Heard) -> Verdict {
    found(each(
        heard,
        |drive| &drive.jump,
        |expected, _| {
            let name = expected.name;
            both!(
                "drive {name} is told 000Fh with a target elsewhere than 6064h",
                "驱动器 {name} 的控制字为 000Fh 时目标与 6064h 不同"
            )
        },
    ))
}

fn buffer(heard: &Heard) -> Verdict {
    let tick = heard.machine.params.tick_us();
    found(heard.machine.drives.iter().filter_map(|expected| {
        let axis = match expected.name {
            DriveName::X => Axis::X,
            DriveName::Z => Axis::Z,
            DriveName::C => Axis::C,
            _ => return None,
        };
        let drive = heard.drives.get(&expected.node)?;
        let seen = drive
            .motion
            .dead_time()
            .and_then(|dead| u32::try_from(dead).ok());
        let lag = drive.motion.lag().unwrap_or(0.0);
        // A profile only says so; the lag has to be there, too.
        let said = expected.known.and_then(|known| known.buffer);
        let said = said.filter(|targets| lag >= f64::from(*targets));
        // Positions come late by up to a period, and tell the period of interpolation with the buffer. A profile has
        // the buffer alone.
        let seen = seen.map(|periods| (periods, tick));
        let said = said.map(|targets| (targets.saturating_add(1), tick / 2));
        let (periods, within) = seen.or(said).filter(|(periods, _)| *periods >= 3)?;
        let latency = heard.machine.params.latency_us(axis);
        let wanted = periods.saturating_mul(tick);
        if latency.saturating_add(within) >= wanted {
            return None;
        }
        let name = expected.name;
        let mut hits = Hits::standing(heard.now);
        hits.count = drive.statuses;
        let found = Found::at(
            expected.node,
            &hits,
            both!(
                "drive {name} is where it was told {periods} periods before; 9003 is {latency} µs",
                "驱动器 {name} 处于 {periods} 个周期之前的目标；9003 为 {latency} µs"
            ),
        );
        Some(found.mended_by(Mend::Set(format!("9003.{name}={wanted}"))))
    }))
}

fn limited(heard: &Heard) -> Verdict {
    found(each(
        heard,
        |drive| &drive.limited,
        |expected, drive| {
            let (name, word) = (expected.name, word(drive));
            both!(
                "drive {name} says bit 11 (last statusword {word})",
                "驱动器 {name} 第 11 位为 1（最后状态字 {word}）"
            )
        },
    ))
}

fn homing(heard: &Heard) -> Verdict {
    let mut all = each(
        heard,
        |drive| &drive.homing_error,
        |expected, drive| {
            let (name, word) = (expected.name, word(drive));
            both!(
                "drive {name} says bit 13 in homing (last statusword {word})",
                "驱动器 {name} 回零中第 13 位为 1（最后状态字 {word}）"
            )
        },
    );
    all.extend(each(
        heard,
        |drive| &drive.homing_unfinished,
        |expected, _| {
            let name = expected.name;
            both!(
                "homing of drive {name} ended three times without bit 12",
                "驱动器 {name} 三次回零结束而无第 12 位"
            )
        },
    ));
    for alarm in [4520, 4522, 4526, 4530, 4532] {
        let hits = heard.board.alarms.get(&alarm);
        if let Some(hits) = hits.filter(|hits| hits.enough() && hits.longest > Duration::ZERO)
            && all.is_empty()
        {
            all.push(Found::alarm(heard, alarm, hits));
        }
    }
    found(all)
}
