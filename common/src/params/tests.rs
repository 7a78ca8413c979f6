//! Files and options, right and wrong.

use leadscrew_core::units::Feed;

use super::*;

const SLANT_BED: &str = include_str!("../../../params/machines/slant-bed.toml");

/// Loads files given as texts, named `1.toml`, `2.toml` …, and options.
fn load_texts(files: &[&str], options: &[&str]) -> Loaded {
    let mut loader = Loader::new(None, Lang::En);
    for (number, text) in (1..).zip(files) {
        loader.layer += 1;
        file::apply(&mut loader, &format!("{number}.toml"), text.as_bytes());
    }
    for text in options {
        loader.layer += 1;
        option::apply(&mut loader, text).unwrap();
    }
    if loader.loaded.is_good() {
        loader.loaded.cross_check(Lang::En);
    }
    loader.loaded
}

/// `FILE:LINE:COLUMN-END NUMBER MESSAGE / HELP` of everything found.
fn told(loaded: &Loaded) -> Vec<String> {
    let text = |d: &Diagnostic| {
        format!(
            "{}:{}:{}-{} {} {} / {}",
            d.file, d.line, d.column, d.end_column, d.number, d.message, d.help
        )
    };
    loaded.diagnostics.iter().map(text).collect()
}

fn alone(file: &str) -> String {
    let loaded = load_texts(&[file], &[]);
    let told = told(&loaded);
    assert_eq!(told.len(), 1, "{file}: {told:?}");
    assert_eq!(loaded.params, Params::slant_bed(), "{file}");
    told.into_iter().next().unwrap()
}

fn text_of(entry: &Entry, raw: i64) -> String {
    if entry.none() == Some(raw) {
        "none".into()
    } else {
        entry.unit().text(raw).to_string()
    }
}

#[test]
fn the_file_of_the_built_in_machine_is_a_machine_file() {
    let loaded = load_texts(&[SLANT_BED], &[]);
    assert_eq!(told(&loaded), [""; 0]);
    assert_eq!(loaded.params, Params::slant_bed());
    let rapid = Entry::find_text("1420.X").unwrap();
    let line = 1 + SLANT_BED
        .lines()
        .position(|l| l.starts_with("rapid_rate.X"))
        .unwrap();
    assert_eq!(loaded.source(rapid), Some(format!("1.toml:{line}")));
    let chamfer = Entry::find_text("019").unwrap();
    assert_eq!(loaded.source(chamfer), None);
}

#[test]
fn every_value_can_be_written_by_number_alias_and_name_in_files_and_options() {
    for pick in [|e: &Entry| e.min(), |e: &Entry| e.max()] {
        let mut expected = Params::slant_bed();
        for entry in Entry::all() {
            expected.set(entry, pick(entry)).unwrap();
        }
        let keys: [fn(&Entry) -> String; 3] = [
            |e| e.to_string(),
            |e| match (e.alias(), e.part) {
                (Some(alias), Part::Whole) => alias.to_string(),
                _ => format!("000{e}"),
            },
            |e| match e.part {
                Part::Whole => e.text().name.to_owned(),
                Part::Bit(bit) => format!("{}.{bit}", e.text().name),
                Part::Axis(axis) => format!("{}.{}", e.text().name, char::from(axis.letter())),
            },
        ];
        for key in keys {
            let mut loader_file = String::new();
            let mut options = Vec::new();
            for entry in Entry::all() {
                let raw = pick(entry);
                let (key, text) = (key(entry), text_of(entry, raw));
                loader_file.push_str(&format!("\"{key}\" = \"{text}\"\n"));
                options.push(format!("{key}={}", entry.unit().number(raw)));
            }
            let by_file = load_texts(&[&loader_file], &[]);
            assert_eq!(by_file.params, expected);
            assert!(
                by_file.diagnostics.iter().all(|d| d.number >= 4377),
                "{:?}",
                told(&by_file)
            );
            let options: Vec<&str> = options.iter().map(String::as_str).collect();
            let by_option = load_texts(&[], &options);
            assert_eq!(by_option.params, expected);
        }
    }
}

#[test]
fn keys_may_be_dotted_quoted_or_in_a_table() {
    let files = [
        "\"1420.X\" = \"9000 mm/min\"\n182.7 = 1",
        "1420.X = \"9 m/min\"\n182.7 = true",
        "[rapid_rate]\nX = \"9000mm/min\"\n[182]\n7 = 1",
        "rapid_rate = { x = \"150 mm/s\" }\npq_in_mm = 1",
        "Rapid_Rate.X = '9000 mm/min'\npq_in_mm.7 = \"1\"",
    ];
    for file in files {
        let loaded = load_texts(&[file], &[]);
        // 9000 mm/min is still above the cutting feed of 8000.
        assert_eq!(told(&loaded), [""; 0], "{file}");
        assert_eq!(
            loaded.params.rapid(Axis::X),
            Feed::from_nm_per_min(9_000_000_000)
        );
        assert!(loaded.params.pq_in_mm());
    }
}

#[test]
fn later_layers_win_and_the_winner_is_named() {
    let files = [
        "057 = 2\n058 = \"55°\"\n5140 = \"0.2 mm\"",
        "thread_finish_passes = 3\n5143 = \"30 deg\"",
    ];
    let loaded = load_texts(&files, &["57=4", "0057=5"]);
    assert_eq!(told(&loaded), [""; 0]);
    let p = &loaded.params;
    assert_eq!((p.thread_finish_passes(), p.thread_angle()), (5, 30));
    assert_eq!(p.thread_min_step().nm(), 200_000);
    let source = |key| loaded.source(Entry::find_text(key).unwrap());
    assert_eq!(source("057").as_deref(), Some("--set 0057=5"));
    assert_eq!(source("058").as_deref(), Some("2.toml:2"));
    assert_eq!(source("059").as_deref(), Some("1.toml:3"));
    assert_eq!(source("060"), None);
}

#[test]
fn every_mistake_has_its_place_its_cause_and_its_remedy() {
    for (file, expected) in [
        (
            "# lathe\n  colour = 1",
            "1.toml:2:3-9 4401 there is no parameter `colour` / `leadscrew params list` prints all numbers and names",
        ),
        (
            "rapid_rat.X = \"1 m/min\"",
            "1.toml:1:1-10 4402 there is no parameter `rapid_rat` / did you mean `rapid_rate`?",
        ),
        (
            "1420 = 5",
            "1.toml:1:1-5 4403 `1420` does not say which bit or axis it means / write `1420.X` / `1420.Z` / `1420.C`",
        ),
        (
            "[1420]\nY = \"1 m/min\"",
            "1.toml:2:1-2 4404 there is no `1420.Y` / write `1420.X` / `1420.Z` / `1420.C`",
        ),
        (
            "1420.X.fast = \"1 m/min\"",
            "1.toml:1:6-7 4404 there is no `1420.X.…` / write `1420.X` / `1420.Z` / `1420.C`",
        ),
        (
            "5144 = \"two\"",
            "1.toml:1:8-13 4405 5144 (thread_cut_in): `two` is not a decimal number / write a value such as `0`",
        ),
        (
            "9005 = \"35 rpm\"",
            "1.toml:1:8-16 4406 9005 (observer_bandwidth_hz): `35 rpm` has a unit that does not belong to it / write one of these units: Hz, kHz",
        ),
        (
            "057 = \"2 mm\"",
            "1.toml:1:7-13 4407 057 (thread_finish_passes): `2 mm` is more than a number, and the value has no unit / write a plain number such as `1`",
        ),
        (
            "060 = 0.2",
            "1.toml:1:7-10 4408 060 (thread_allowance): `0.2` does not say its unit / write `\"0.2 mm\"`",
        ),
        (
            "9101.X = \"0.000001 mm\"",
            "1.toml:1:10-23 4409 9101.X (tool_offset_1): `0.000001 mm` is finer than can be kept / round it to steps of 0.000002 mm",
        ),
        (
            "5241 = \"10000 rpm\"",
            "1.toml:1:8-19 4410 5241 (tap_max_rpm): `10000 rpm` is out of range / write a value from 0 rpm to 9999 rpm",
        ),
        (
            "019 = 5\n\n5130 = 5",
            "1.toml:3:1-5 4411 019 (thread_chamfer) is already set in line 1 / keep one of the two",
        ),
        (
            "5144 = [1]",
            "1.toml:1:8-11 4412 5144 (thread_cut_in): a value is a whole number, or a text with a unit / write a value such as `0`",
        ),
        (
            "5144 = 0x1",
            "1.toml:1:8-11 4412 5144 (thread_cut_in): a value is a whole number, or a text with a unit / write a value such as `0`",
        ),
        (
            "5144 = true",
            "1.toml:1:8-12 4412 5144 (thread_cut_in): a value is a whole number, or a text with a unit / write a value such as `0`",
        ),
        (
            "主轴 = 1",
            "1.toml:1:1-2 4400 this is not TOML: invalid unquoted key, expected letters, numbers, `-`, `_` / write one value a line: `\"1420.X\" = \"12000 mm/min\"`",
        ),
    ] {
        let told = alone(file);
        if expected.contains(" 4400 ") {
            // The words are the reader's own.
            assert!(told.contains(" 4400 this is not TOML: "), "{told}");
        } else {
            assert_eq!(told, expected);
        }
    }
}

#[test]
fn one_mistake_does_not_hide_another_and_they_come_in_order() {
    let loaded = load_texts(&["zzz = 1\n5144 = 9\n[aaa]\nb = 1\nc = 2"], &["5145=7"]);
    let numbers: Vec<_> = loaded
        .diagnostics
        .iter()
        .map(|d| (d.number, d.line))
        .collect();
    assert_eq!(numbers, [(4401, 1), (4410, 2), (4401, 3), (4410, 1)]);
    assert!(!loaded.is_good());
}

#[test]
fn an_option_shows_where_in_it_the_mistake_is() {
    let loaded = load_texts(&[], &["1420.Y=5", "1420.X=fast", "1420.X=1"]);
    assert_eq!(
        told(&loaded)[..2],
        [
            "--set:1:1-7 4404 there is no `1420.Y` / write `1420.X` / `1420.Z` / `1420.C`",
            "--set:1:8-12 4405 1420.X (rapid_rate): `fast` is not a decimal number / write a value such as `12000`",
        ]
    );
    let error = option::apply(
        &mut Loader {
            loaded: load_texts(&[], &[]),
            lang: Lang::En,
            layer: 1,
            count: 0,
        },
        "1420.X",
    );
    assert!(
        matches!(error, Err(crate::failure::Failure::Usage(text)) if text.en.contains("1420.X=12000"))
    );
}

#[test]
fn a_cross_check_points_at_the_value_written_last() {
    let loaded = load_texts(
        &[
            "1430.Z = \"9 m/min\"\n1430.X = \"9 m/min\"",
            "1420.X = \"8500 mm/min\"",
        ],
        &[],
    );
    assert_eq!(
        told(&loaded),
        [
            "2.toml:1:10-23 4422 the cutting feed of X (1430.X) is above its rapid rate (1420.X) / lower 1430.X or raise 1420.X"
        ]
    );
    // The ramp is made of two axes; that of the longer part is to blame.
    let ramps = load_texts(&["1622.C = \"15000 °/s³\"", "1620.Z = \"0.3 m/s²\""], &[]);
    assert_eq!(
        told(&ramps),
        [
            "1.toml:1:10-22 4420 speeding up takes 2223 ticks, C most of them, and a profile holds 2048 / raise 1620.C or 1622.C, lower 1420.C, or make the tick (9000) longer"
        ]
    );
    let warned = load_texts(&[], &["5213=0"]);
    assert!(warned.is_good());
    assert_eq!(told(&warned).len(), 1);
    // Nothing is said about a set with a hole in it.
    let broken = load_texts(&["1420.X = \"8500\"\n1430.X = \"9 m/min\""], &[]);
    assert_eq!(
        broken
            .diagnostics
            .iter()
            .map(|d| d.number)
            .collect::<Vec<_>>(),
        [4408]
    );
}

#[test]
fn every_cross_check_can_be_blamed_on_a_value() {
    for code in Code::ALL {
        let number = code.number();
        if (4420..4440).contains(&number) || (4960..4970).contains(&number) {
            assert!(!numbers(*code).is_empty(), "{code:?}");
            for no in numbers(*code) {
                assert!(Entry::all().iter().any(|e| e.no == *no), "{code:?}: {no}");
            }
        }
    }
}

#[test]
fn no_file_and_no_option_brings_it_down_or_is_half_believed() {
    leadscrew_seed::volume(0x9e37_79b9_7f4a_7c15, |seed| {
        // xorshift64.
        let mut state = seed;
        let mut random = move |below: usize| {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            usize::try_from(state >> 33).unwrap() % below
        };
        let alphabet: Vec<char> = "0159.XZC=\"'[]{}#\n\r\t ,-+_exmµ°/ins²任\u{0}\u{feff}"
            .chars()
            .collect();
        let mut taken = 0;
        for round in 0..3_000 {
            let mut text: Vec<char> = if round % 3 == 0 {
                Vec::new()
            } else {
                SLANT_BED.chars().collect()
            };
            for _ in 0..1 + random(40) {
                let at = random(text.len() + 1);
                match random(3) {
                    0 if at < text.len() => drop(text.remove(at)),
                    1 if at < text.len() => text[at] = alphabet[random(alphabet.len())],
                    _ => text.insert(at, alphabet[random(alphabet.len())]),
                }
            }
            let text: String = text.into_iter().collect();
            let loaded = load_texts(&[&text], &[]);
            for entry in Entry::all() {
                let raw = loaded.params.get(entry);
                assert!(entry.allows(raw), "{entry} {raw} of {text}");
                if loaded.source(entry).is_none() {
                    assert_eq!(raw, Params::slant_bed().get(entry), "{entry} of {text}");
                }
            }
            for diagnostic in &loaded.diagnostics {
                assert!(!diagnostic.render(false).is_empty());
            }
            taken += usize::from(loaded.is_good());
            let option: String = text.chars().take(20).filter(|c| *c != '\n').collect();
            if option.contains('=') {
                load_texts(&[], &[&option]);
            }
        }
        // Some mutations must be harmless (comments), most must not.
        assert!((1..2_900).contains(&taken), "{taken}");
    });
}

#[test]
fn of_two_drives_with_one_number_the_one_written_last_is_shown() {
    for (text, place, drives) in [
        (
            "drive_node.C = 40\ndrive_node.X = 17\n",
            "1.toml:2:",
            "X and Z",
        ),
        (
            "drive_node.Z = 16\nspindle_node = 40\n",
            "1.toml:1:",
            "X and Z",
        ),
        (
            "drive_node.Z = 41\nspindle_node = 40\n",
            "1.toml:2:",
            "Z and S",
        ),
        (
            "spindle_node = 40\ndrive_node.Z = 43\n",
            "1.toml:2:",
            "Z and S",
        ),
    ] {
        let told = told(&load_texts(&[text], &[]));
        let words = format!(" 4377 drives {drives} have the same node, ");
        assert_eq!(told.len(), 1, "{told:?}");
        assert!(
            told[0].starts_with(place) && told[0].contains(&words),
            "{told:?}"
        );
    }
}

#[test]
fn drive_sections_are_read_in_order() {
    use drives::{DriveName, Kind, Wanted};
    use leadscrew_core::bus::{DriveCommand, Object};
    let text = "[drive.X]\nmax_profile_velocity = 500_000\nrpdo1 = [\"6040/16\", \"607Ah/32\"]\n\
                interpolation_period = \"1 ms\"\n\"2105.3\" = { type = \"i16\", value = -7 }\n60C5.0 = 0x10\n\
                [drive.s1]\n\"1017\" = 100\n";
    let loaded = load_texts(&[text, "[drive.X]\nmax_profile_velocity = 400000\n"], &[]);
    assert_eq!(told(&loaded), [""; 0]);
    let number = |index, sub, kind, value| Wanted::Number {
        object: Object::new(index, sub),
        kind,
        value,
    };
    let expected = [
        (DriveName::X, number(0x607F, 0, Kind::U32, 400_000)),
        (
            DriveName::X,
            Wanted::Mapping {
                mapping: 0x1600,
                communication: 0x1400,
                objects: DriveCommand::MAPPING.to_vec(),
            },
        ),
        (DriveName::X, number(0x60C2, 1, Kind::U8, 1)),
        (DriveName::X, number(0x60C2, 2, Kind::I8, -3)),
        (DriveName::X, number(0x2105, 3, Kind::I16, -7)),
        (DriveName::X, number(0x60C5, 0, Kind::U32, 16)),
        (DriveName::S1, number(0x1017, 0, Kind::U16, 100)),
    ];
    let found: Vec<_> = loaded
        .drives
        .iter()
        .map(|setting| (setting.drive, setting.wanted.clone()))
        .collect();
    assert_eq!(found, expected);
}

/// Every drive's place in the one frame (9031), as the board has it; the same in a frame of its own is a conflict.
#[test]
fn a_drive_section_can_have_any_place_in_the_frame_for_all() {
    use drives::{DriveName, command_mapping, mapping_literal};
    let board = load_texts(&["9031 = 1\n9014 = 4\n"], &[]).params;
    for drive in DriveName::ALL {
        let mapping = command_mapping(drive, &board);
        let text = format!(
            "9031 = 1\n[drive.{drive}]\nrpdo1_cob_id = 0x481\nrpdo1 = {}\n",
            mapping_literal(&mapping)
        );
        assert_eq!(told(&load_texts(&[&text], &[])), [""; 0], "{text}");
        let alone = load_texts(&[&text.replace("9031 = 1", "9031 = 0")], &[]);
        assert!(!alone.is_good(), "{text}");
    }
}

#[test]
fn every_mistake_in_a_drive_section_has_its_place_its_cause_and_its_remedy() {
    for (file, expected) in [
        (
            "drive = 1",
            "1.toml:1:1-6 4450 there is no drive `` / write `[drive.X]`, Z, C, or S1 to S4 for a spindle",
        ),
        (
            "[drive.Y]\nmax_torque = 1",
            "1.toml:1:8-9 4450 there is no drive `Y` / write `[drive.X]`, Z, C, or S1 to S4 for a spindle",
        ),
        (
            "[drive.X]\nmax_speed = 1",
            "1.toml:2:1-10 4451 drive X: there is no object called `max_speed` / write one of the names that `leadscrew params \
             docs` lists, or index and sub-index in hexadecimal: `\"60C2.1\"`",
        ),
        (
            "[drive.X]\n2105.3 = 1",
            "1.toml:2:10-11 4452 drive X: `2105.3` does not say its type / write both: `\"2105.3\".type = \"u16\"` and \
             `\"2105.3\".value = 0`; types are u8 u16 u32 i8 i16 i32",
        ),
        (
            "[drive.X]\nmax_torque = 65536",
            "1.toml:2:14-19 4453 drive X: `max_torque` cannot be `65536` / write 0 … 65535",
        ),
        (
            "[drive.X]\nmax_torque = \"5 Nm\"",
            "1.toml:2:14-20 4453 drive X: `max_torque` cannot be a text / write 0 … 65535",
        ),
        (
            "[drive.X]\nmax_torque = { type = \"u32\", value = 1 }",
            "1.toml:2:14-41 4453 drive X: `max_torque` cannot be such a table / write `u16`",
        ),
        (
            "[drive.X]\nrpdo1 = [\"6040/9\"]",
            "1.toml:2:9-19 4453 drive X: `rpdo1` cannot be `[\"6040/9\"]` / write objects with their bits, 512 at most: \
             `[\"6040/16\", \"607A/32\"]`",
        ),
        (
            "[drive.X]\nrpdo2 = [\"6060/8\", \"60FF/32\", \"607A/32\"]",
            "1.toml:2:9-41 4453 drive X: `rpdo2` cannot be `[\"6060/8\", \"60FF/32\", \"607A/32\"]` / write objects with their \
             bits, 64 at most: `[\"6040/16\", \"607A/32\"]`",
        ),
        (
            "[drive.X]\ninterpolation_period = \"257 µs\"",
            "1.toml:2:24-32 4453 drive X: `interpolation_period` cannot be `\"257 µs\"` / write a time such as `\"1 ms\"`, `\"250 µs\"`",
        ),
        (
            "[drive.X]\nmax_torque = 1\n6072.0 = 2",
            "1.toml:3:10-11 4454 drive X: 6072h:00h max_torque is already set in line 2 / keep one of the two",
        ),
        (
            "[drive.Z]\ninterpolation_period = \"2 ms\"",
            "1.toml:2:24-30 4455 drive Z would interpolate over 2 × 10^-3 s (60C2h), and a setpoint comes every 1000 µs (9000) / \
             give both the same time",
        ),
        (
            "[drive.Z]\ntpdo1_transmission = 1",
            "1.toml:2:22-23 4456 drive Z would send its status at every 1 SYNCs (1800h:02h), and the board expects it at every 4 \
             (9021) / give both the same number",
        ),
        (
            "[drive.C]\ntpdo1 = [\"6041/16\"]",
            "1.toml:2:9-20 4457 drive C: 1A00h would be 6041h/16, and the board needs 6041h/16 6064h/32 / write 6041h/16 \
             6064h/32, or leave the mapping out",
        ),
        (
            "[drive.X]\nrpdo1_cob_id = 0x211",
            "1.toml:2:16-21 4458 drive X: 1400h:01h rpdo1_cob_id would be 00000211h, and the board uses 00000210h / write \
             00000210h, or leave it out: a drive has it by itself; its number is 9015, or 9016 for spindle 1",
        ),
        // Switched off.
        (
            "[drive.S2]\nrpdo2_cob_id = 0x80000321",
            "1.toml:2:16-26 4458 drive S2: 1401h:01h rpdo2_cob_id would be 80000321h, and the board uses 00000321h / write \
             00000321h, or leave it out: a drive has it by itself; its number is 9015, or 9016 for spindle 1",
        ),
    ] {
        assert_eq!(alone(file), expected);
    }
}

#[test]
fn identifiers_of_a_drive_go_with_the_number_of_the_same_set() {
    let told_of = |section: &str| {
        let file = format!("\"9015.Z\" = 20\n[drive.Z]\n{section}");
        told(&load_texts(&[&file], &[]))
    };
    let mut told = told_of("tpdo1_cob_id = 0x191");
    assert_eq!(
        told.pop().unwrap(),
        "1.toml:3:16-21 4458 drive Z: 1800h:01h tpdo1_cob_id would be 00000191h, and the board uses 00000194h / write \
         00000194h, or leave it out: a drive has it by itself; its number is 9015, or 9016 for spindle 1"
    );
    assert_eq!(told, [""; 0]);
    // Without remote requests; the second one is not the board's.
    let good = "rpdo1_cob_id = 0x214\nrpdo2_cob_id = 0x80000314\ntpdo1_cob_id = 0x40000194";
    assert_eq!(told_of(good), [""; 0]);
}

#[test]
fn a_condition_of_one_axis_is_not_told_of_another_axis_value() {
    let mut board = Params::slant_bed();
    let tick = Entry::find_text("9000").unwrap();
    board.set(tick, 4000).unwrap();
    let set = ["1420.X=9000".to_owned()];
    let loaded = load_over(Some(board), &[], &set, Lang::En).unwrap();
    let rapid: Vec<_> = loaded
        .diagnostics
        .iter()
        .filter(|d| d.number == 4964)
        .collect();
    let [told] = rapid.as_slice() else {
        panic!("{rapid:?}")
    };
    assert!(told.message.contains("1420.C"), "{}", told.message);
    assert_eq!(told.file, "the board's parameters");
}

/// What the board refuses when it joins its bus is told before.
#[test]
fn a_cycle_that_leaves_no_room_on_the_bus_is_told() {
    for wrong in [
        &["9000=250"][..],
        &["9000=250", "9031=1"],
        &["9021=1"],
        &["9020=500", "9000=2000"],
    ] {
        let loaded = load_texts(&[], wrong);
        let told = told(&loaded);
        assert!(!loaded.is_good(), "{wrong:?}");
        let [told] = told.as_slice() else {
            panic!("{wrong:?}: {told:?}");
        };
        let (name, _) = wrong.last().unwrap().split_once('=').unwrap();
        assert!(
            told.contains(" 4333 ") && told.contains("of the bus"),
            "{told}"
        );
        assert!(told.starts_with("--set:") || told.contains(name), "{told}");
    }
    let right = ["9020=500", "9000=2000", "9022=20"];
    assert!(load_texts(&[], &right).is_good());
}
