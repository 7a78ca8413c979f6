//! `explain`: what is said to raise an alarm raises it, what is said to be right raises nothing, and every number has
//! something that raises it.

use std::path::Path;

use serde_json::Value;

use crate::{Folder, code, leadscrew, root, stderr, stdout};

/// What is told of each of these numbers.
fn explained(numbers: &[String]) -> Vec<Value> {
    let mut args = vec!["explain", "--json"];
    args.extend(numbers.iter().map(String::as_str));
    let output = leadscrew(&args);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let all: Value = serde_json::from_str(&stdout(&output)).unwrap();
    all["alarms"].as_array().unwrap().clone()
}

/// Every number that there is.
fn numbers() -> Vec<String> {
    let list = stdout(&leadscrew(&["explain"]));
    let number = |line: &str| line.split([' ', ':']).nth(1).unwrap().to_owned();
    list.lines().map(number).collect()
}

/// A text with its lines and words as often as it says.
fn written_out(text: &str) -> String {
    let mut all = String::new();
    for line in text.lines() {
        let times = line.rsplit_once(" (").and_then(|(_, behind)| {
            let times = behind.strip_suffix(" times)")?;
            times.parse().ok()
        });
        let words = line.split(' ').map(|word| match word.split_once('×') {
            Some((word, times)) => vec![word; times.parse().unwrap()].join(" "),
            None => word.to_owned(),
        });
        let line = words.collect::<Vec<_>>().join(" ") + "\n";
        all += &line.repeat(times.unwrap_or(1));
    }
    all
}

/// Writes the files beside a program; true where there are any.
fn put_files(folder: &Path, alarm: &Value, of: &str) -> bool {
    let mut any = false;
    for key in ["files", of] {
        for (name, text) in alarm[key].as_object().into_iter().flatten() {
            std::fs::write(folder.join(name), written_out(text.as_str().unwrap())).unwrap();
            any = true;
        }
    }
    any
}

/// The numbers that a result of `--json` tells.
fn told(result: &Value) -> Vec<u64> {
    let lists = ["alarms", "warnings"].map(|key| result[key].as_array().cloned());
    let all = lists.into_iter().flatten().flatten();
    all.map(|diagnostic| diagnostic["no"].as_u64().unwrap())
        .collect()
}

#[track_caller]
fn compare(number: u64, is_wrong: bool, told: &[u64]) {
    match is_wrong {
        true => assert!(told.contains(&number), "{number}: {told:?}"),
        false => assert!(told.is_empty(), "{number}: {told:?}"),
    }
}

/// What `check` tells of programs, one list for each.
fn checked(programs: &[String]) -> Vec<Vec<u64>> {
    let mut args = vec!["check", "--json"];
    args.extend(programs.iter().map(String::as_str));
    let output = leadscrew(&args);
    let result: Value = serde_json::from_str(&stdout(&output)).unwrap();
    let files = result["files"].as_array().unwrap();
    // A machine or its variables may be refused before any program is read.
    if files.is_empty() {
        return vec![told(&result)];
    }
    files.iter().map(told).collect()
}

#[test]
fn the_wrong_program_raises_the_alarm_and_the_right_one_raises_nothing() {
    let folder = Folder::new("explain");
    // The built-in machine.
    std::fs::write(folder.file("leadscrew.toml"), "").unwrap();
    let (mut files, mut expected) = (Vec::new(), Vec::new());
    for alarm in explained(&numbers()) {
        for (kind, of) in [("wrong", "wrong_files"), ("right", "right_files")] {
            let Some(program) = alarm[kind].as_str() else {
                continue;
            };
            let number = alarm["no"].as_u64().unwrap();
            let own = folder.0.join(format!("{number}-{kind}"));
            std::fs::create_dir(&own).unwrap();
            let has_files = put_files(&own, &alarm, of);
            if has_files && !own.join("leadscrew.toml").exists() {
                std::fs::write(own.join("leadscrew.toml"), "").unwrap();
            }
            let file = own.join("part.nc");
            std::fs::write(&file, written_out(program)).unwrap();
            let file = file.to_str().unwrap().to_owned();
            if has_files {
                let all = checked(&[file]);
                compare(number, kind == "wrong", &all[0]);
            } else {
                files.push(file);
                expected.push((number, kind == "wrong"));
            }
        }
    }
    assert!(files.len() > 300, "{}", files.len());
    let all = checked(&files);
    assert_eq!(all.len(), expected.len());
    for (told, (number, is_wrong)) in all.iter().zip(expected) {
        compare(number, is_wrong, told);
    }
}

#[test]
fn the_wrong_machine_file_raises_the_alarm_and_the_right_one_raises_nothing() {
    let folder = Folder::new("explain-machines");
    std::fs::remove_file(folder.file("leadscrew.toml")).unwrap();
    let machine = folder.file("machine.toml");
    let mut count = 0;
    for alarm in explained(&numbers()) {
        for kind in ["wrong", "right"] {
            let Some(text) = alarm[format!("{kind}_machine")].as_str() else {
                continue;
            };
            std::fs::write(&machine, text).unwrap();
            let output = leadscrew(&["params", "validate", "--json", "--params", &machine]);
            let result: Value = serde_json::from_str(&stdout(&output)).unwrap();
            let number = alarm["no"].as_u64().unwrap();
            compare(number, kind == "wrong", &told(&result));
            assert!(kind == "wrong" || code(&output) == 0, "{number}");
            count += 1;
        }
    }
    assert!(count > 100, "{count}");
}

/// Numbers whose cause is told in words, because nobody can provoke them at a desk, and the test that does: its file and
/// its name.
const ELSEWHERE: &[(&[u64], &str, &str)] = &[
    (
        &[4011],
        "language/src/word.rs",
        "what_is_no_word_is_told_at_its_columns",
    ),
    (
        &[4021],
        "core/src/program/tests/alarms.rs",
        "no_code_of_this_folder_is_left_out",
    ),
    (
        &[4030],
        "language/src/reader/tests.rs",
        "programs_without_macros_are_what_they_are_to_the_core",
    ),
    (
        &[315, 4111],
        "tests/tests/cycles/alarms.rs",
        "angle_and_starts",
    ),
    (
        &[4110],
        "tests/tests/cycles/alarms.rs",
        "lengths_out_of_range",
    ),
    (
        &[4131],
        "tests/tests/cycles/taps.rs",
        "what_cannot_be_tapped",
    ),
    (
        &[4201, 4202, 4203, 4204, 4205],
        "motion/src/motion/plan.rs",
        "what_cannot_be_planned_is_an_alarm",
    ),
    (&[4256], "core/src/cycle/tests.rs", "every_refusal"),
    (
        &[4257],
        "tests/tests/trouble/spindle.rs",
        "a_spindle_far_too_fast_in_a_stroke",
    ),
    (
        &[4307, 4308],
        "firmware/app/tests/apart/panel.rs",
        "a_clamp_that_does_not_answer_is_an_alarm_after_a_second_and_a_reset_lets_go",
    ),
    (
        &[4309],
        "tests/tests/kept/wear.rs",
        "the_warning_comes_at_eighty_per_cent_and_once",
    ),
    (
        &[4329, 4348, 4349],
        "tests/tests/device/protection.rs",
        "an_image_that_is_not_taken_has_its_reason",
    ),
    (
        &[4334],
        "tests/tests/device/programs.rs",
        "a_run_without_a_program_is_refused_visibly",
    ),
    (
        &[4362],
        "motion/src/bus/drive/tests.rs",
        "a_demand_elsewhere_never_moves_and_is_a_failure_in_the_end",
    ),
    (
        &[4301],
        "tests/python/chip/test_fd.py",
        "test_rates_that_do_not_go_together_are_an_alarm_at_the_next_start",
    ),
    (
        &[4369],
        "firmware/app/tests/apart/failures.rs",
        "a_reset_from_outside_is_in_the_event_log",
    ),
    (
        &[4974],
        "tests/tests/device/kept.rs",
        "a_table_without_its_mark_is_stored_and_told",
    ),
    (
        &[4383, 4388],
        "firmware/app/tests/apart/bus.rs",
        "setpoints_in_a_frame_that_its_controller_does_not_send_are_refused",
    ),
    (
        &[4363, 4367],
        "firmware/app/tests/apart/failures.rs",
        "behind_a_failure_nothing_moves_before_a_reset",
    ),
    (
        &[4364],
        "tests/tests/emulated/failure.rs",
        "a_fault_of_the_processor",
    ),
    (
        &[4365, 4368],
        "tests/tests/emulated/failure.rs",
        "again_and_again_until_it_stays_at_rest",
    ),
    (
        &[4366],
        "tests/tests/emulated/failure.rs",
        "a_stack_that_runs_over",
    ),
    (
        &[4376],
        "gateway/src/link/tests.rs",
        "a_board_says_why_it_does_not_take_a_set",
    ),
    (
        &[4385],
        "tests/tests/together.rs",
        "two_drives_at_one_place_are_found_before_either_has_torque",
    ),
    (
        &[4386],
        "firmware/app/tests/apart/bus.rs",
        "a_controller_that_has_stopped_sending_does_too",
    ),
    (
        &[4501],
        "core/src/board/device/mode.rs",
        "the_table_at_rest",
    ),
    (
        &[4508],
        "tests/tests/device/by_hand.rs",
        "an_old_order_starts_nothing",
    ),
    (
        &[4511],
        "tests/tests/device/by_hand.rs",
        "steps_are_made_whole_and_one_that_leaves_the_travel_not_at_all",
    ),
    (&[4521], "tests/tests/home/options.rs", "cancelled_by_reset"),
    (
        &[4581],
        "gateway/tests/board/offsets.rs",
        "of_two_consoles_the_one_that_has_not_seen_the_change_is_refused",
    ),
    (
        &[4585],
        "tests/tests/device/offsets.rs",
        "what_is_no_next_table_is_refused_and_changes_nothing",
    ),
    (
        &[4955],
        "tests/tests/device/wheel.rs",
        "a_wheel_that_is_too_fast_is_told_of_where_it_is_followed",
    ),
    (
        &[4973],
        "tests/tests/device/kept.rs",
        "a_set_without_its_mark_is_stored_and_told",
    ),
    (
        &[4304],
        "tests/tests/orientation.rs",
        "a_spindle_that_does_not_move_is_an_alarm_in_time",
    ),
];

/// Numbers told in words that no test provokes by their name. This list may only become shorter.
const NOWHERE: &[u64] = &[4200, 4259, 4266, 4523];

#[test]
fn every_number_has_what_raises_it_and_words_stand_only_where_a_test_elsewhere_does() {
    let mut in_words = Vec::new();
    for alarm in explained(&numbers()) {
        let number = alarm["no"].as_u64().unwrap();
        let kinds = ["wrong", "wrong_machine", "raise", "how"];
        let has = kinds.iter().filter(|key| alarm[**key].is_string()).count();
        assert_eq!(has, 1, "{number}");
        if alarm["how"].is_string() {
            in_words.push(number);
        }
    }
    let listed = ELSEWHERE.iter().flat_map(|(numbers, ..)| *numbers);
    let mut listed: Vec<u64> = listed.chain(NOWHERE).copied().collect();
    listed.sort_unstable();
    assert_eq!(in_words, listed);
    for (numbers, file, test) in ELSEWHERE {
        let text = std::fs::read_to_string(root().join(file)).unwrap();
        assert!(text.contains(test), "{numbers:?}: {file} has no {test}");
    }
}

#[test]
fn a_line_and_a_word_are_written_out_as_often_as_they_say() {
    assert_eq!(
        written_out("G1 U1  (3 times)\n(at a×2 b)\nX1 (2)\n"),
        "G1 U1  (3 times)\n".repeat(3) + "(at a a b)\nX1 (2)\n"
    );
}

#[test]
fn a_number_that_is_none_is_told() {
    let output = leadscrew(&["explain", "4036", "4986"]);
    assert_eq!(code(&output), 2);
    assert_eq!(
        stderr(&output),
        "error: there is no alarm and no warning 4986: `leadscrew explain` lists all\n"
    );
    let output = leadscrew(&["explain", "4036"]);
    assert!(stdout(&output).starts_with("alarm 4036: there is no tool offset …\n"));
}

/// What is erased by hand is what the board keeps, and all of it.
#[test]
fn the_command_that_erases_the_storage_names_its_pages() {
    let read = |path: &str| std::fs::read_to_string(root().join(path)).unwrap();
    let source = read("firmware/nucleo-g474re/src/flash.rs");
    let number = |name: &str| {
        let (_, rest) = source.split_once(&format!("const {name}: ")).unwrap();
        let (_, value) = rest.split_once(" = ").unwrap();
        let value = value.split_once(';').unwrap().0.replace('_', "");
        match value.strip_prefix("0x") {
            Some(hex) => u32::from_str_radix(hex, 16).unwrap(),
            None => value.parse().unwrap(),
        }
    };
    assert!(source.contains("const PAGE: usize = 2 * CHIP_PAGE;"));
    let long = 2 * number("CHIP_PAGE") * number("PAGES");
    assert!(source.contains("const FLASH: u32 = 512 * 1024;"));
    let from = 0x0800_0000 + 512 * 1024 - long;
    let range = format!("--range {from:#010x}..{:#010x}", from + long);
    let page = read("docs/hardware.md");
    assert!(page.contains(&range), "{range}");
    assert!(page.contains(&format!("erase_address {from:#010x} {long:#x};")));
    for lang in ["en", "zh"] {
        let output = leadscrew(&["explain", "4312", "--lang", lang]);
        let told = stdout(&output);
        assert!(
            told.contains(&range) && told.contains("docs/hardware.md"),
            "{told}"
        );
    }
}
