//! Parameters over a bus: pushed, compared, fetched, refused.

use std::path::PathBuf;

use leadscrew_core::bus::{Frame, frame_bits};
use leadscrew_core::link::ImageWriter;
use serde_json::json;

use crate::server::{Options, Server};
use crate::{Run, bad, good, json as parsed, leadscrew, slow, text, wait_for};

const LATHE: &str = "# My lathe\nschema = 2\n\"1420.X\" = \"11 m/min\" # rapid\n\n[drive.X]\nrpdo1 = [\"6040/16\", \"607A/32\"]\n\
                     max_profile_velocity = 0x7A120 # 500000\n[drive.S1]\ninterpolation_period = \"1 ms\"\nprofile_acceleration = 7000\n";

/// A file of this test alone.
fn file(name: &str, content: &str) -> String {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::write(&path, content).unwrap();
    path.display().to_string()
}

#[test]
fn a_file_goes_to_board_and_drives_and_comes_back() {
    let server = Server::start(&Options::default());
    let bus = server.bus();
    let lathe = file("bus.toml", LATHE);
    // The server's machine watches for a gateway in its own way: that stays.
    let differs = leadscrew(&["params", "diff", &lathe, "--json"], &bus);
    assert_eq!(differs.status.code(), Some(1));
    let value = parsed(&differs);
    assert_eq!(value["changes"].as_array().unwrap().len(), 1);
    assert_eq!(value["changes"][0]["key"], json!("1420.X"));
    assert_eq!(
        value["drives"],
        json!([
            {"drive": "X", "object": "607Fh:00h max_profile_velocity", "old": "10000000", "new": "500000"},
            {"drive": "S1", "object": "6083h:00h profile_acceleration", "old": "100000000", "new": "7000"}
        ])
    );
    let pushed = parsed(&leadscrew(&["params", "push", &lathe, "--json"], &bus));
    assert_eq!(pushed["done"], json!(true));
    assert_eq!(pushed["drives"], value["drives"]);
    let status = wait_for(&bus, "the drives come up again", |status| {
        status["state"] == "idle"
    });
    assert_eq!(status["parameters"], pushed["parameters"]);
    assert_eq!(
        good(&leadscrew(&["params", "push", &lathe], &bus)),
        "nothing to change\n"
    );
    assert_eq!(
        good(&leadscrew(&["params", "diff", &lathe], &bus)),
        "no difference\n"
    );
    // A file takes over what the board and the drives have; its words stay.
    let other = LATHE
        .replace("11 m/min", "9 m/min")
        .replace("0x7A120", "1")
        .replace("7000", "1");
    let other = file("other.toml", &other);
    good(&leadscrew(&["params", "pull", "--into", &other], &bus));
    let expected = LATHE
        .replace("\"11 m/min\"", "\"11000 mm/min\"")
        .replace("0x7A120", "500000");
    let taken = std::fs::read_to_string(&other).unwrap();
    let taken: String = taken
        .split_inclusive('\n')
        .filter(|line| {
            !line.starts_with("gateway_silence_ms") && !line.starts_with("increment_is_c")
        })
        .collect();
    assert_eq!(taken, expected);
    // Drives alone: the machine is ready again afterwards.
    let drive = file("drive-alone.toml", "[drive.Z]\nprofile_acceleration = 5\n");
    good(&leadscrew(&["params", "push", &drive], &bus));
    wait_for(&bus, "the machine is ready", |status| {
        status["state"] == "idle"
    });
}

/// A value of the board is not called the built-in machine's, neither where it is told nor where it is warned of.
#[test]
fn what_a_board_has_is_told_as_its_own() {
    let server = Server::start(&Options {
        set: vec![("9024", 0), ("9000", 4000)],
        ..Options::default()
    });
    let output = leadscrew(&["params", "get", "9000"], &server.bus());
    let told = good(&output);
    assert!(
        told.contains("9000 tick_us = 4000 µs")
            && told.contains("the board's value, built in 1000"),
        "{told}"
    );
    let warned = text(&output.stderr);
    assert!(
        warned.contains("warning[4963]") && warned.contains("--> the board's parameters"),
        "{warned}"
    );
    assert!(!format!("{told}{warned}").contains("the built-in machine"));
}

#[test]
fn a_machine_at_work_keeps_its_set() {
    let server = slow();
    let bus = server.bus();
    let drive = file(
        "at-work.toml",
        "9007 = \"12 %\"\n[drive.Z]\nprofile_acceleration = 5\n",
    );
    let run = Run::start("examples/shaft.nc", &bus);
    wait_for(&bus, "the program runs", |status| status["program"] == true);
    let told = bad(&leadscrew(&["params", "set", "9007=12"], &bus), 1);
    assert!(
        told.contains("4344 ") && told.contains("its set has not been changed"),
        "{told}"
    );
    let told = bad(
        &leadscrew(&["params", "push", &drive, "--lang", "zh"], &bus),
        1,
    );
    assert!(
        told.contains("4344 ") && told.contains("其参数集未作改动"),
        "{told}"
    );
    // The switch itself would be taken, but no drive is touched for it.
    let switch = file(
        "switch-at-work.toml",
        "\"9026.0\" = 0\n[drive.Z]\nprofile_acceleration = 5\n",
    );
    let told = bad(&leadscrew(&["params", "push", &switch], &bus), 1);
    assert!(told.contains("4344 "), "{told}");
    good(&leadscrew(&["reset"], &bus));
    run.end();
    wait_for(&bus, "it stands", |status| status["program"] == false);
    let built_in = leadscrew(&["params", "diff"], &bus);
    assert_eq!(
        text(&built_in.stdout),
        "1004.1  increment_is_c      0        → 1\n9024    gateway_silence_ms  1000 ms  → 20000 ms\n"
    );
}

/// A whole table costs hardly more than its bytes: every frame of the dialogue counts, in both directions.
#[test]
fn a_push_of_the_whole_table_is_counted_in_frames() {
    let server = Server::start(&Options::default());
    let bus = server.bus();
    let whole = file("whole.toml", "");
    std::fs::remove_file(&whole).unwrap();
    good(&leadscrew(&["params", "pull", "-o", &whole], &bus));
    let pulled = std::fs::read_to_string(&whole).unwrap();
    let changed = [
        ("12000 mm/min", "11500 mm/min"),
        ("16000 mm/min", "15500 mm/min"),
        ("8000 mm/min", "7500 mm/min"),
        ("4096", "8192"),
        ("3000 rpm", "2500 rpm"),
    ]
    .into_iter()
    .fold(pulled, |text, (old, new)| text.replace(old, new));
    let before = file("before.toml", &std::fs::read_to_string(&whole).unwrap());
    let whole = file("whole.toml", &changed);
    // Where something was not answered for a second and asked again, it is counted anew.
    let push = || {
        server.dialogue();
        let told = good(&leadscrew(&["params", "push", &whole], &bus));
        let dialogue = server.dialogue();
        let abort = |frame: &Frame| frame.payload().first() == Some(&0x80);
        if dialogue.iter().any(abort) {
            good(&leadscrew(&["params", "push", &before], &bus));
            return None;
        }
        Some((told, dialogue))
    };
    let pushed = std::iter::repeat_with(push).take(10).flatten().next();
    let (told, dialogue) = pushed.expect("a push without a time-out");
    let (told, end) = told.rsplit_once("stored").unwrap();
    assert!(
        told.contains("→ 11500 mm/min") && told.contains("→ 8192"),
        "{told}"
    );
    assert!(end.starts_with(" and in force, identity "), "{end}");
    // Both directions, from the first question to the last answer. Heartbeats, and how often it is asked whether the set is
    // stored yet, are a matter of time; all else is the same each time.
    let asks = |frame: &&Frame| frame.payload().get(1..4) == Some(&[0x10, 0x50, 2]);
    let polls = dialogue.iter().filter(asks).count();
    let beats = dialogue.iter().filter(|frame| frame.payload().len() == 1);
    let beats = beats.count();
    // Segments of seven bytes, an answer to each block of 127, and 38 frames for what is asked before and after.
    let image = ImageWriter::BYTES.div_ceil(7);
    let answers = image.div_ceil(127);
    assert_eq!(
        dialogue.len() - polls - beats,
        (image + answers) as usize + 38
    );
    // Without stuffing, and with as much of it as can be.
    let bits = |frame: &Frame| 47 + 8 * frame.payload().len() as u32;
    let stuffed = |frame: &Frame| frame_bits(frame.payload().len() as u32);
    let counted = || {
        let timeless = |frame: &&Frame| !asks(frame) && frame.payload().len() != 1;
        dialogue.iter().filter(timeless)
    };
    // A heartbeat, and one question and answer about the store, belong to it.
    for (bits, each) in [
        (counted().map(bits).sum::<u32>() + 55 + 2 * 111, 111),
        (
            counted().map(stuffed).sum::<u32>() + frame_bits(1) + 2 * frame_bits(8),
            frame_bits(8),
        ),
    ] {
        let limit = image * each * 13 / 10;
        assert!(bits <= limit, "{bits} bits, limit {limit}");
    }
    // The same again is one question.
    assert_eq!(
        good(&leadscrew(&["params", "push", &whole], &bus)),
        "nothing to change\n"
    );
    assert!(server.dialogue().len() <= 16);
}

/// The transaction is one over board and drives.
#[test]
fn drives_get_their_old_values_back_where_the_board_cannot_store_its_set() {
    let server = Server::start(&Options {
        flash_fails: true,
        ..Options::default()
    });
    let bus = server.bus();
    let lathe = file("unstored.toml", LATHE);
    let told = bad(&leadscrew(&["params", "push", &lathe], &bus), 1);
    assert!(
        told.contains("its set has not been changed: 4343 ")
            && told.ends_with("; the drives have their old values again\n"),
        "{told}"
    );
    wait_for(&bus, "the machine is ready", |status| {
        status["state"] == "idle"
    });
    let differs = parsed(&leadscrew(&["params", "diff", &lathe, "--json"], &bus));
    assert_eq!(differs["changes"].as_array().unwrap().len(), 1);
    assert_eq!(
        differs["drives"],
        json!([
            {"drive": "X", "object": "607Fh:00h max_profile_velocity", "old": "10000000", "new": "500000"},
            {"drive": "S1", "object": "6083h:00h profile_acceleration", "old": "100000000", "new": "7000"}
        ])
    );
}
