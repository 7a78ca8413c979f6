//! What a drive is set up with by its profile: the objects that a board needs, as far as the section does not say them
//! itself.
//!
//! It knows no bus: which value a drive has, and what it does not take, is seen when the objects are written.

use leadscrew_core::alarm::Code;
use leadscrew_core::board::DriveNodes;
use leadscrew_core::bus::{
    AxisMode, AxisReport, CobId, DriveStatus, Mapped, Mode, Object, Service, SpindleCommand,
};
use leadscrew_core::params::Params;

use super::objects::{DriveName, Kind, PDOS, PERIOD_EXPONENT, PERIOD_VALUE, RATE};
use super::{
    HOMING_METHOD, Setting, Wanted, command_mapping, homes, mode, period_of, tells_inputs,
};
use crate::params::Loader;
use crate::profiles::Profile;
use crate::words::{Both, both};

/// 1006h.
const CYCLE: Object = Object::new(0x1006, 0);
/// 1400h:02h.
const LATCHED: Object = Object::new(0x1400, 2);
/// At the next SYNC.
const AT_SYNC: i64 = 1;
/// 1801h:02h.
const REPORT: Object = Object::new(0x1801, 2);
/// When something changes.
const AT_CHANGE: i64 = 255;
/// 1801h:05h.
const REPORT_AGAIN: Object = Object::new(0x1801, 5);
/// The board waits for this many SYNCs and for two times more, until a drive that was to tell its inputs does not.
const REPORTS: u32 = 16;
/// 6060h.
const MODE: Object = Object::new(0x6060, 0);
/// 60C0h.
const INTERPOLATION: Object = Object::new(0x60C0, 0);
/// A straight line from setpoint to setpoint.
const LINEAR: i64 = 0;

/// Adds what the profiles say of their drives, where no section says it.
pub(in crate::params) fn fill(loader: &mut Loader) {
    for own in loader.loaded.profiles.clone() {
        let loaded = &mut loader.loaded;
        let (drive, profile) = (own.drive, &own.profile);
        let wanted = match refused(profile, drive, &loaded.drives, &loaded.params) {
            Some(words) => Err(words),
            None => wanted(profile, drive, &loaded.params),
        };
        let wanted = match wanted {
            Ok(wanted) => wanted,
            Err(words) => {
                let figures = [drive.to_string(), words.get(loader.lang).to_owned()];
                loader.report(Code::DriveProfile, &figures, &own.place);
                continue;
            }
        };
        for wanted in wanted {
            let is_said = |setting: &Setting| {
                setting.drive == drive && setting.wanted.object() == wanted.object()
            };
            if loaded.drives.iter().any(is_said) {
                continue;
            }
            loaded.drives.push(Setting {
                drive,
                wanted,
                layer: own.layer,
                place: own.place.clone(),
                span: own.span.clone(),
                by_profile: true,
            });
        }
    }
}

/// All that the board needs of this drive, by a profile.
///
/// # Errors
/// In words: what the profile says that the drive cannot do.
fn wanted(profile: &Profile, drive: DriveName, params: &Params) -> Result<Vec<Wanted>, Both> {
    let mode = mode(drive, params);
    profile.refuse(mode, params.tick_us())?;
    wire(profile, params)?;
    let mut all = pdos(profile, drive, params)?;
    all.push(number(LATCHED, Kind::U8, AT_SYNC));
    all.push(number(
        RATE,
        Kind::U8,
        i64::from(params.drive_status_syncs()),
    ));
    if tells_inputs(drive, params) {
        all.push(number(REPORT, Kind::U8, AT_CHANGE));
    }
    if !homes(drive, params) && tells_inputs(drive, params) {
        let ms = REPORTS.saturating_mul(params.tick_us()).div_ceil(1000);
        all.push(number(REPORT_AGAIN, Kind::U16, i64::from(ms)));
    }
    if !homes(drive, params) && !drive.is_spindle() {
        // Who homes or is a spindle is told its mode in process data.
        all.push(number(MODE, Kind::I8, mode as i64));
    }
    if mode == Mode::Interpolated && profile.word("mode.7.interpolation") == Some("linear") {
        all.push(number(INTERPOLATION, Kind::I16, LINEAR));
    }
    period(profile, params, &mut all)?;
    Ok(all)
}

/// What the section of the drive says against its profile.
fn refused(
    profile: &Profile,
    drive: DriveName,
    settings: &[Setting],
    params: &Params,
) -> Option<Both> {
    if !homes(drive, params) {
        return None;
    }
    let of = |setting: &Setting| match setting.wanted {
        Wanted::Number { object, value, .. }
            if setting.drive == drive && object == HOMING_METHOD =>
        {
            Some(value)
        }
        _ => None,
    };
    let method = settings.iter().find_map(of)?;
    let methods = others(profile, "homing.methods", method)?;
    let name = &profile.name;
    Some(both!(
        "`{name}` has no homing method {method} (6098h), but {methods}",
        "`{name}` 没有回零方式 {method}（6098h），只有 {methods}"
    ))
}

/// What a profile lists, where this number is not in its list.
fn others(profile: &Profile, path: &str, number: i64) -> Option<String> {
    let fact = profile.fact(path)?;
    let is_there = profile.numbers(path)?.contains(&number);
    (!is_there).then(|| fact.value.text())
}

/// The bit rate.
fn wire(profile: &Profile, params: &Params) -> Result<(), Both> {
    let name = &profile.name;
    let own = i64::from(params.bus_kbit());
    match others(profile, "bit_rates_kbit", own) {
        Some(rates) => Err(both!(
            "`{name}` has bit rates of {rates} kbit/s, and parameter 9020 is {own} kbit/s",
            "`{name}` 的波特率为 {rates} kbit/s，而参数 9020 为 {own} kbit/s"
        )),
        None => Ok(()),
    }
}

/// Mappings and identifiers.
fn pdos(profile: &Profile, drive: DriveName, params: &Params) -> Result<Vec<Wanted>, Both> {
    let homes = homes(drive, params);
    let command = command_mapping(drive, params);
    let second: &[Mapped] = match () {
        () if drive.is_spindle() => &SpindleCommand::MAPPING,
        () if homes => &AxisMode::MAPPING,
        () => &[],
    };
    let report: &[Mapped] = match tells_inputs(drive, params) {
        true => &AxisReport::MAPPING,
        false => &[],
    };
    let node = drive.among(&DriveNodes::of(params)).node;
    let mut all = Vec::new();
    for ((service, objects), (_, mapping, communication)) in [
        (Service::Rpdo1, &command[..]),
        (Service::Rpdo2, second),
        (Service::Tpdo1, &DriveStatus::MAPPING),
        (Service::Tpdo2, report),
    ]
    .into_iter()
    .zip(PDOS)
    {
        if objects.is_empty() {
            continue;
        }
        fits(profile, mapping, objects)?;
        all.push(Wanted::Mapping {
            mapping,
            communication,
            objects: objects.to_vec(),
        });
        // The frame with all setpoints has the number of the board, which nobody knows here.
        if service != Service::Rpdo1 || params.setpoint_frame() == 0 {
            let cob_id = i64::from(CobId::of(service, node).get());
            all.push(number(Object::new(communication, 1), Kind::U32, cob_id));
        }
    }
    Ok(all)
}

fn fits(profile: &Profile, mapping: u16, objects: &[Mapped]) -> Result<(), Both> {
    let name = &profile.name;
    let count = objects.len();
    if let Some(most) = profile.whole("pdo.entries")
        && most < count as i64
    {
        return Err(both!(
            "`{name}` maps {most} objects in a PDO at most, and {mapping:04X}h needs {count}",
            "`{name}` 的一个 PDO 最多映射 {most} 个对象，而 {mapping:04X}h 需要 {count} 个"
        ));
    }
    let is_dummy = |mapped: &Mapped| mapped.object.index < 0x0020;
    if profile.flag("pdo.dummy") == Some(false) && objects.iter().any(is_dummy) {
        return Err(both!(
            "`{name}` has no dummy entries, so it cannot take its part of one frame for all drives: set 9031 to 0",
            "`{name}` 没有占位条目，不能从所有驱动器共用的一帧中取值：请将 9031 设为 0"
        ));
    }
    Ok(())
}

/// 60C2h and 1006h, as far as the drive lets them be written.
fn period(profile: &Profile, params: &Params, all: &mut Vec<Wanted>) -> Result<(), Both> {
    let tick = i64::from(params.tick_us());
    let written = profile.words("sync.set");
    let says = |object: &str| written.as_ref().map(|all| all.contains(&object));
    let fixed = profile.numbers("sync.exponent");
    let fitting = |exponent: i64| {
        let value = (0..=255).find(|value| {
            super::period_ns(*value, exponent).is_some_and(|ns| Some(ns) == tick.checked_mul(1000))
        })?;
        Some((value, exponent))
    };
    let (value, exponent) = match &fixed {
        Some(exponents) => exponents.iter().find_map(|exponent| fitting(*exponent)),
        None => period_of(tick).map(|(value, exponent)| (i64::from(value), i64::from(exponent))),
    }
    .ok_or_else(|| {
        let name = &profile.name;
        both!(
            "60C2h of `{name}` cannot be {tick} µs (9000)",
            "`{name}` 的 60C2h 不能为 {tick} µs（9000）"
        )
    })?;
    if says("60C2.1") != Some(false) {
        all.push(number(PERIOD_VALUE, Kind::U8, value));
    }
    // A power of ten of its own cannot be written.
    if says("60C2.2").unwrap_or(fixed.is_none()) {
        all.push(number(PERIOD_EXPONENT, Kind::I8, exponent));
    }
    if says("1006") == Some(true) {
        all.push(number(CYCLE, Kind::U32, tick));
    }
    Ok(())
}

const fn number(object: Object, kind: Kind, value: i64) -> Wanted {
    Wanted::Number {
        object,
        kind,
        value,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::params::{Loaded, load_text};
    use leadscrew_core::alarm::Lang;

    fn load(text: &str) -> Loaded {
        load_text("lathe.toml", text, Lang::En)
    }

    /// Object and value of each number of a drive, and how many mappings there are.
    fn told(loaded: &Loaded, of: DriveName) -> (Vec<(u16, u8, i64)>, usize) {
        assert!(loaded.is_good(), "{:?}", loaded.diagnostics);
        let of = loaded.drives.iter().filter(|setting| setting.drive == of);
        let numbers = of.clone().filter_map(|setting| match setting.wanted {
            Wanted::Number { object, value, .. } => Some((object.index, object.sub, value)),
            Wanted::Mapping { .. } => None,
        });
        let numbers: Vec<_> = numbers.collect();
        let mappings = of.count() - numbers.len();
        (numbers, mappings)
    }

    #[test]
    fn a_profile_says_what_the_board_needs_of_its_drive() {
        let asda = load("[drive.Z]\nprofile = \"delta-asda-a2\"\n");
        let expected = vec![
            (0x1400, 1, 0x211),
            (0x1800, 1, 0x191),
            (0x1400, 2, 1),
            (0x1800, 2, 4),
            (0x6060, 0, 8),
            (0x60C2, 1, 1),
            (0x1006, 0, 1000),
        ];
        assert_eq!(told(&asda, DriveName::Z), (expected, 2));
        assert_eq!(told(&asda, DriveName::X), (vec![], 0));
        // One that homes is told its mode in process data; both halves of 60C2h where both can be written.
        let text = "9000 = \"2 ms\"\n9050.X = 1\n[drive.X]\nprofile = \"kollmorgen-akd\"\n";
        let expected = vec![
            (0x1400, 1, 0x210),
            (0x1401, 1, 0x310),
            (0x1800, 1, 0x190),
            (0x1801, 1, 0x290),
            (0x1400, 2, 1),
            (0x1800, 2, 4),
            (0x1801, 2, 255),
            (0x60C2, 1, 2),
            (0x60C2, 2, -3),
        ];
        assert_eq!(told(&load(text), DriveName::X), (expected, 4));
    }

    #[test]
    fn a_drive_with_the_switch_that_the_board_looks_for_tells_its_inputs() {
        let text = "9050.X = 2\n9051.X = 35\n[drive.X]\nprofile = \"kollmorgen-akd\"\n";
        let loaded = load(text);
        let (numbers, mappings) = told(&loaded, DriveName::X);
        // RPDO1, TPDO1 and TPDO2: its mode does not change, so it is written once.
        assert_eq!(mappings, 3);
        for wanted in [
            (0x1801, 1, 0x290),
            (0x1801, 2, 255),
            // At every 16th SYNC of 1 ms.
            (0x1801, 5, 16),
            (0x6060, 0, 8),
        ] {
            assert!(numbers.contains(&wanted), "{wanted:?}: {numbers:?}");
        }
        assert!(!numbers.iter().any(|(object, ..)| *object == 0x1401));
        // With a switch at the board it needs none of that.
        let (numbers, mappings) = told(&load(&text.replace("35", "5")), DriveName::X);
        assert_eq!(mappings, 2);
        assert!(!numbers.iter().any(|(object, ..)| *object == 0x1801));
    }

    #[test]
    fn the_inputs_alone_are_enough_where_the_board_looks_for_the_switch() {
        let refused = |params: &str, objects: &str| {
            let loaded = load(&format!("{params}[drive.X]\ntpdo2 = [{objects}]\n"));
            loaded.diagnostics.first().map(|first| first.number)
        };
        let (by_board, by_drive) = ("9050.X = 2\n9051.X = 33\n", "9050.X = 1\n");
        let (alone, both) = ("\"60FD/32\"", "\"6061/8\", \"60FD/32\"");
        let mapping = Some(Code::DriveMapping.number());
        assert_eq!(refused(by_board, alone), None);
        assert_eq!(refused(by_board, both), None);
        assert_eq!(refused(by_board, "\"6061/8\""), mapping);
        assert_eq!(refused(by_drive, alone), mapping);
        assert_eq!(refused(by_drive, both), None);
        // Nobody looks at it.
        assert_eq!(refused("9050.X = 2\n9051.X = 3\n", "\"6061/8\""), None);
    }

    #[test]
    fn a_drive_that_has_mode_7_alone_is_set_up_for_it() {
        let text = "9076.Z = 7\n[drive.Z]\nprofile = \"infranor-xtrapuls\"\n";
        let loaded = load(text);
        let (numbers, mappings) = told(&loaded, DriveName::Z);
        assert_eq!(mappings, 2);
        assert!(numbers.contains(&(0x6060, 0, 7)) && numbers.contains(&(0x60C0, 0, 0)));
        let target = loaded
            .drives
            .iter()
            .find_map(|setting| match &setting.wanted {
                Wanted::Mapping {
                    mapping: 0x1600,
                    objects,
                    ..
                } => objects.last().map(|last| last.raw()),
                _ => None,
            });
        assert_eq!(target, Some(0x60C1_0120));
    }

    #[test]
    fn what_the_section_says_stands() {
        let text = "[drive.Z]\ninterpolation_period = \"1000 µs\"\nmax_torque = 800\nprofile = \"delta-asda-a2\"\n";
        let (numbers, _) = told(&load(text), DriveName::Z);
        assert_eq!(
            numbers[..3],
            [(0x60C2, 1, 1), (0x60C2, 2, -3), (0x6072, 0, 800)]
        );
        assert_eq!(numbers.iter().filter(|it| it.0 == 0x60C2).count(), 2);
    }

    #[test]
    fn what_a_profile_cannot_be_is_said_with_its_line() {
        let drive = |more: &str| format!("{more}[drive.Z]\nprofile = \"delta-asda-a2\"\n");
        for (text, part) in [
            (drive("9000 = \"500 us\"\n"), "takes SYNC periods from 1000"),
            (
                drive("9000 = \"500 us\"\n").replace("delta-asda-a2", "bonfiglioli-active-cube"),
                "no mode 8",
            ),
            (
                drive("9050.Z = 1\n") + "homing_method = 37\n",
                "no homing method 37",
            ),
            (
                drive("").replace("asda-a2", "asda-a9"),
                "there is no drive `delta-asda-a9`",
            ),
            (
                drive("").replace("\"delta-asda-a2\"", "7"),
                "anything but a text",
            ),
        ] {
            let loaded = load(&text);
            let [alarm] = &loaded.diagnostics[..] else {
                panic!("{text}: {:?}", loaded.diagnostics);
            };
            let line = text.lines().nth(alarm.line as usize - 1);
            assert!(
                line.is_some_and(|line| line.starts_with("profile")),
                "{alarm:?}"
            );
            assert!(alarm.message.contains(part), "{text}: {alarm:?}");
        }
    }

    #[test]
    fn every_built_in_drive_that_can_be_streamed_to_is_set_up_in_full() {
        let mut streamed = 0;
        for profile in Profile::built_in() {
            let loaded = load(&format!("[drive.X]\nprofile = \"{}\"\n", profile.name));
            if profile.refuse(Mode::Position, 1000).is_err() || !loaded.is_good() {
                continue;
            }
            streamed += 1;
            let (numbers, mappings) = told(&loaded, DriveName::X);
            assert_eq!(mappings, 2, "{}", profile.name);
            assert!(numbers.contains(&(0x60C2, 1, 1)), "{}", profile.name);
        }
        assert!(streamed >= 12, "{streamed}");
    }
}
