//! The machine of the page, on this host, makes the setpoints of the emulated board, and refuses in words.

use std::path::Path;

use leadscrew_common::params::{difference, load_text};
use leadscrew_core::alarm::Lang;
use leadscrew_core::params::{Params, Part};
use leadscrew_web::{Session, answer};
use serde_json::{Value, json};

mod jobs;

use jobs::{job, on_host};

/// The module has the programs of the folders, and what their machine files say. `LEADSCREW_BLESS=1` writes the list anew.
#[test]
fn the_page_offers_the_programs_of_the_folders_on_their_machines() {
    let list = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/examples/list.rs");
    let found = list_of_examples();
    if std::env::var_os("LEADSCREW_BLESS").is_some() {
        std::fs::write(&list, &found).expect("the list can be written");
    }
    let kept = std::fs::read_to_string(&list).expect("the list is there");
    assert_eq!(kept, found, "`cargo xtask renew` writes it anew");
}

/// The list as Rust: of each folder what its machine file says otherwise than the built-in machine, and its programs.
fn list_of_examples() -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples");
    let mut out = String::from("&[\n");
    for folder in ["", "shop"] {
        let dir = root.join(folder);
        let file = std::fs::read_to_string(dir.join("leadscrew.toml")).expect("a machine file");
        let loaded = load_text("leadscrew.toml", &file, Lang::En);
        assert!(loaded.is_good(), "the machine file of {folder} is right");
        out += &format!("    Folder {{\n        name: {folder:?},\n        values: &[\n");
        for change in difference::changes(&Params::slant_bed(), &loaded.params) {
            let part = match change.entry.part {
                Part::Whole => "Part::Whole".to_owned(),
                Part::Bit(bit) => format!("Part::Bit({bit})"),
                Part::Axis(axis) => format!("Part::Axis(Axis::{axis:?})"),
            };
            out += &format!(
                "            ({}, {part}, {}),\n",
                change.entry.no, change.new
            );
        }
        out += "        ],\n        programs: &[\n";
        let mut programs: Vec<_> = std::fs::read_dir(&dir)
            .expect("a folder of examples")
            .map(|entry| entry.expect("a file").file_name())
            .filter_map(|name| name.into_string().ok())
            .filter(|name| name.ends_with(".nc"))
            .collect();
        programs.sort();
        for name in programs {
            let path = Path::new("../../../examples").join(folder).join(&name);
            out += &format!("            ({name:?}, include_str!({path:?})),\n");
        }
        out += "        ],\n    },\n";
    }
    out + "]\n"
}

/// The emulated board has read the same programs; its rows are under version control.
#[test]
fn the_page_has_the_setpoints_of_the_emulated_board() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let golden = root.join("firmware/mps2-an386/hashes.txt");
    let golden = std::fs::read_to_string(golden).expect("the board's rows are there");
    let most = leadscrew_seed::amount(50_000, u64::MAX);
    let mut compared = 0;
    for row in golden.lines().filter(|row| row.contains(".nc ")) {
        let words: Vec<&str> = row.split_whitespace().collect();
        let (name, hash, ticks) = (words[0], words[1], words[2]);
        let count: u64 = ticks.parse().expect("a number");
        if count == 0 || count > most {
            continue;
        }
        let text = std::fs::read_to_string(root.join("examples").join(name)).expect("an example");
        let own = on_host("", &text);
        if words[3] != "0" {
            // The board runs up to the alarm; the page refuses the program before anything moves.
            let found = own["found"].as_array().expect("a list");
            let has = found
                .iter()
                .any(|one| one["number"].as_u64() == words[3].parse().ok());
            assert!(has, "{name}: {found:?}");
            continue;
        }
        assert_eq!(
            (&own["hash"], &own["ticks"]),
            (&json!(hash), &json!(count)),
            "{name}"
        );
        compared += 1;
    }
    assert!(compared >= 5, "{compared} examples");
}

/// A message that makes no sense is refused in words, never by a trap.
#[test]
fn every_refusal_has_a_key_of_the_words() {
    const WORDS: &str = include_str!("../page/words.js");
    let mut session = Session::default();
    let mut ask = |text: &str| -> Value {
        let said: Value =
            serde_json::from_slice(&answer(&mut session, text.as_bytes())).expect("JSON");
        if let Some(key) = said["refused"].as_str() {
            // A key that is a word of the page already has this before it.
            let has = |key: &str| WORDS.contains(&format!("\n  {key}: ["));
            assert!(has(key) || has(&format!("refused_{key}")), "{key}");
        }
        said
    };
    assert_eq!(ask("{")["refused"], "message");
    assert_eq!(ask(r#"{"do":"step","ticks":1}"#)["refused"], "nothing");
    assert_eq!(
        ask(&job("check", "none", "").to_string())["refused"],
        "folder"
    );
    let mut wrong = job("load", "", "M30\n");
    wrong["counts"] = json!(1);
    assert_eq!(ask(&wrong.to_string())["refused"], "counts");
    wrong["counts"] = json!(null);
    wrong["ripple"] = json!([99_000, 1]);
    assert_eq!(ask(&wrong.to_string())["refused"], "ripple");
    let found = ask(&job("check", "", "G0 X10\nG1 Q\n").to_string());
    assert_eq!(found["found"][0]["line"], 2, "{found}");
    assert_eq!(found["good"], false);
}

/// What `leadscrew check` finds in this program is found as it is typed: a rapid through the stock, a feed with a standing
/// spindle, one of the other mode, a way before a thread that is too short.
#[test]
fn what_is_hardly_meant_is_told_while_it_is_typed() {
    const DOUBTFUL: &str = "(STOCK X50 L60)\nG0 X52. Z2.\nG98 G1 X48. F200.\nM3 S800\nG1 Z-10. F1.\nG0 X30. Z-30.\n\
                            G0 X52. Z2.\nG0 X32. Z1.\nG92 X29. Z-20. F2.\nG92 X28.5\nG0 X60. Z5.\nM5\nM30\n";
    let found = |text: &str| {
        let mut session = Session::default();
        let said = answer(
            &mut session,
            job("check", "shop", text).to_string().as_bytes(),
        );
        let said: Value = serde_json::from_slice(&said).expect("JSON");
        let list = said["found"].as_array().expect("a list");
        let each = list
            .iter()
            .map(|one| (one["line"].clone(), one["number"].clone()));
        let mut each: Vec<(u64, u64)> = each
            .map(|(line, number)| {
                (
                    line.as_u64().expect("a line"),
                    number.as_u64().expect("a number"),
                )
            })
            .collect();
        each.sort_unstable();
        (said["good"] == true, each)
    };
    let warnings = [(3, 4984), (6, 4987), (7, 4987), (9, 4942), (10, 4942)];
    let (good, all) = found(DOUBTFUL);
    let mut expected = warnings.to_vec();
    expected.insert(1, (5, 4803));
    assert_eq!((good, all), (false, expected));
    // The program silences what is meant.
    let (good, all) = found(&DOUBTFUL.replacen('\n', " (ALLOW 4803 4987)\n", 1));
    let rest: Vec<_> = warnings.into_iter().filter(|one| one.1 != 4987).collect();
    assert_eq!((good, all), (true, rest));
}

/// Runs a program to its end or to its alarm, and gives the answers of the steps; `fault` comes after five seconds.
fn steps(job: &Value, fault: Option<&str>) -> Vec<Value> {
    let mut session = Session::default();
    let mut ask = |message: &Value| -> Value {
        serde_json::from_slice(&answer(&mut session, message.to_string().as_bytes())).expect("JSON")
    };
    let loaded = ask(job);
    assert_eq!(loaded["good"], true, "{loaded}");
    let mut said = vec![ask(&json!({"do": "step", "ticks": 5_000}))];
    if let Some(what) = fault {
        said.push(ask(&json!({"do": "fault", "what": what})));
    }
    while said
        .last()
        .is_some_and(|last| last["state"]["over"] == false)
    {
        said.push(ask(&json!({"do": "step", "ticks": 1_000})));
        assert!(said.len() < 300, "it does not end: {:?}", said.last());
    }
    said
}

fn list<'a>(said: &'a [Value], key: &str) -> Vec<&'a Value> {
    let each = said.iter().map(|one| one[key].as_array().expect("a list"));
    each.flatten().collect()
}

const SHAFT: &str = include_str!("../../examples/shaft.nc");

/// The figures are those of `leadscrew measure examples/shaft.nc`.
#[test]
fn threads_are_measured_where_that_is_asked() {
    let mut wanted = job("load", "", SHAFT);
    let plain = steps(&wanted, None);
    assert_eq!(list(&plain, "threads"), Vec::<&Value>::new());
    wanted["measure"] = json!(true);
    let said = steps(&wanted, None);
    let state = |said: &[Value]| said.last().expect("a step")["state"].clone();
    assert_eq!(state(&said), state(&plain));
    let threads = list(&said, "threads");
    let [thread] = threads[..] else {
        panic!("{threads:?}");
    };
    assert_eq!(
        (&thread["name"], &thread["line"], &thread["cut_in"]),
        (&json!("M40x3-6g"), &json!(44), &json!("trailing"))
    );
    let pitch = &thread["measured"]["rows"][1];
    assert_eq!(pitch["feature"], "pitch");
    let found = pitch["found"].as_f64().expect("a number");
    assert!((found - 38.0521).abs() < 1e-4, "{pitch}");
    // It is cut to the basic profile, and 6g begins 48 µm below.
    assert_eq!(
        (&pitch["high"], &thread["good"]),
        (&json!(38.003), &json!(false))
    );
    assert_eq!(thread["chips"].as_array().map(Vec::len), Some(10));
    // Four pitches: crests at 20 mm, roots below 18.2.
    let profile = thread["profile"].as_array().expect("a list");
    let radii = profile.iter().filter_map(|point| point[1].as_i64());
    let (low, high) = radii.fold((i64::MAX, 0), |(low, high), x| (low.min(x), high.max(x)));
    assert_eq!(high, 20_000_000);
    assert!((18_100_000..18_200_000).contains(&low), "{low}");
}

/// What the page offers is what the machine knows, and each fault ends in the alarm that names it.
#[test]
fn each_fault_has_its_alarm() {
    const PAGE: &str = include_str!("../page/page.js");
    let list_of = PAGE.split_once("const FAULTS = [").expect("the list").1;
    let names = list_of.split_once("];").expect("its end").0;
    let names: Vec<&str> = names.split('"').skip(1).step_by(2).collect();
    let alarms = [
        ("estop", 4300),
        ("spindle_stalls", 4303),
        ("spindle_slow", 4303),
        ("encoder_slips", 4261),
        ("drive_hot", 4357),
        ("drive_silent", 4360),
        ("axis_blocked", 4361),
        ("bus_unplugged", 4360),
    ];
    assert_eq!(names, alarms.map(|(name, _)| name));
    for (what, alarm) in alarms {
        let mut wanted = job("load", "", SHAFT);
        wanted["measure"] = json!(true);
        let said = steps(&wanted, Some(what));
        let told: Vec<&Value> = list(&said, "told")
            .into_iter()
            .map(|one| &one["number"])
            .collect();
        assert_eq!(told, [&json!(alarm)], "{what}");
        // No thread was finished, but for what the next index sets right.
        let threads = list(&said, "threads").len();
        assert_eq!(threads, usize::from(what == "encoder_slips"), "{what}");
    }
}
