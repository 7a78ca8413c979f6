use super::*;
use leadscrew_board_sim::plant::{Interpolation, Late, ServoOptions};
use leadscrew_core::bus::{Increments, Mode};
use leadscrew_core::params::Params;
use leadscrew_core::units::{Acceleration, Axis, Length};

/// Where the tests of quirks are.
const QUIRK_TESTS: &str = include_str!("../../../board-sim/src/plant/tests/servos.rs");

fn named(name: &str) -> Profile {
    Profile::find(name, Lang::En).unwrap()
}

#[test]
fn every_built_in_profile_is_right_and_named_as_its_file() {
    for (name, text) in BUILT_IN {
        let read = read::profile(name, text);
        let profile = read.unwrap_or_else(|mistake| panic!("{mistake}"));
        assert_eq!(profile.name, *name);
        let streamed = profile.fact("mode.8.supported");
        if streamed.is_none_or(|fact| fact.value == facts::Value::Flag(true)) {
            for axis in [Axis::X, Axis::Z] {
                let options = profile.servo(axis, Mode::Position, 1000).unwrap();
                let zero = Increments::new(0);
                let servo = leadscrew_board_sim::plant::Servo::new(&options, (1, 1), 1000, zero);
                assert!(servo.is_some(), "{name}: {options:?}");
            }
        } else {
            assert!(
                profile.servo(Axis::Z, Mode::Position, 1000).is_err(),
                "{name}"
            );
            assert!(
                profile.servo(Axis::Z, Mode::Interpolated, 1000).is_ok(),
                "{name}"
            );
        }
    }
    assert_eq!(Profile::built_in().count(), BUILT_IN.len());
}

#[test]
fn every_file_is_built_in() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../params/drives");
    let mut files: Vec<String> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    let mut known: Vec<String> = BUILT_IN.iter().map(|of| format!("{}.toml", of.0)).collect();
    files.sort();
    known.sort();
    assert_eq!(files, known);
}

#[test]
fn every_simulated_quirk_has_the_test_that_it_names() {
    let quirks = Profile::built_in().flat_map(|profile| profile.quirks);
    let tests: Vec<String> = quirks.filter_map(|quirk| quirk.test).collect();
    assert!(tests.len() >= 2);
    for test in tests {
        let head = format!("#[test]\nfn {test}() {{");
        assert!(QUIRK_TESTS.contains(&head), "{test}");
    }
}

#[test]
fn a_profile_has_its_own_figures_and_those_of_the_typical_drive() {
    let options = named("technosoft-ipos")
        .servo(Axis::X, Mode::Position, 1000)
        .unwrap();
    assert_eq!(options.buffer, 9);
    assert_eq!(options.sliding, Acceleration::from_nm_per_s2(400_000_000));
    let expected = ServoOptions {
        buffer: 0,
        ..options
    };
    assert_eq!(
        named(TYPICAL).servo(Axis::X, Mode::Position, 1000).unwrap(),
        expected
    );
    let z = named("kv15").servo(Axis::Z, Mode::Position, 1000).unwrap();
    assert_eq!((z.kv_milli, z.current_loop_milli), (15_000, 5_026_548));
    assert_eq!(z.sliding, Acceleration::from_nm_per_s2(250_000_000));
    assert_eq!(
        (z.play, z.count),
        (Length::from_nm(10_000), Length::from_nm(100))
    );
    assert_eq!(z.following, Some((Length::from_nm(20_000_000), 100)));
    assert_eq!((z.interpolation, z.late), (Interpolation::Linear, None));
    let late = named("delta-asda-a2")
        .servo(Axis::Z, Mode::Position, 1000)
        .unwrap()
        .late;
    let expected = Late {
        extrapolate: 1,
        fault: 2,
    };
    assert_eq!(late, Some(expected));
}

#[test]
fn a_period_that_the_drive_does_not_take_is_refused() {
    let akd = named("kollmorgen-akd");
    assert!(akd.servo(Axis::Z, Mode::Position, 2000).is_ok());
    for tick in [250, 1500] {
        let words = akd
            .servo(Axis::Z, Mode::Position, tick)
            .unwrap_err()
            .words()
            .unwrap();
        assert!(
            words.en.contains(&format!("9000 is {tick} µs")),
            "{words:?}"
        );
    }
}

const GOOD: &str = r#"
name = "mine"
title = "My drive"
source = [
  { fact = "mode.8", kind = "manual", ref = "page 7", verified = true },
  { fact = "mode.8.buffer", kind = "issue", ref = "a#1", verified = false },
  { fact = "quirk.odd", kind = "assumed", ref = "", verified = false },
]
[mode.8]
supported = true
buffer = { default = 3 }
[[quirk]]
id = "odd"
note = "it is odd"
"#;

fn refused(text: &str) -> String {
    read::profile("mine.toml", text).unwrap_err().0.en
}

#[test]
fn each_fact_has_the_nearest_source() {
    let profile = read::profile("mine.toml", GOOD).unwrap();
    let told: Vec<(&str, String, String)> = profile
        .facts
        .iter()
        .map(|fact| {
            (
                fact.path.as_str(),
                fact.value.text(),
                fact.source.words().en,
            )
        })
        .collect();
    let fact = |path, value: &str, source: &str| (path, value.to_owned(), source.to_owned());
    assert_eq!(
        told,
        [
            fact("mode.8.supported", "yes", "manual: page 7"),
            fact("mode.8.buffer.default", "3", "issue: a#1, not verified"),
        ]
    );
    assert_eq!(profile.quirks[0].source.words().en, "assumed, not verified");
    assert_eq!(profile.quirks[0].source.words().zh, "assumed，未核实");
    assert_eq!(profile.counts(), (3, 2));
}

#[test]
fn what_is_wrong_is_refused_with_its_line() {
    let cases = [
        (
            "buffer = { default = 3 }",
            "buffer = { default = 17 }",
            ":11: `mode.8.buffer.default` has to be a decimal number from 0 to 16",
        ),
        (
            "buffer = { default = 3 }",
            "buffer = { default = \"3\" }",
            ":11: `mode.8.buffer.default` has to be a decimal number",
        ),
        (
            "supported = true\n",
            "supported = 1\n",
            ":10: `mode.8.supported` has to be true / false",
        ),
        (
            "supported = true\n",
            "possible = true\n",
            ":10: a profile has no key `mode.8.possible`",
        ),
        (
            "[mode.8]\n",
            "pdo.rpdo = 4\n[mode.8]\n",
            ":9: `pdo.rpdo` has no source",
        ),
        (
            "id = \"odd\"",
            "id = \"other\"",
            ":12: `quirk.other` has no source",
        ),
        (
            "buffer = { default = 3 }\n",
            "",
            ":6: the source of `mode.8.buffer` has no fact",
        ),
        (
            "kind = \"manual\"",
            "kind = \"rumour\"",
            ":5: a source has `fact`",
        ),
        (", verified = true }", " }", ":5: a source has `fact`"),
        ("note = \"it is odd\"", "", "`note` is missing, a text"),
        ("title = \"My drive\"\n", "", "`title` is missing, a text"),
        ("name = \"mine\"", "name = ", ":2: "),
    ];
    for (from, to, expected) in cases {
        let text = GOOD.replacen(from, to, 1);
        assert_ne!(text, GOOD);
        let told = refused(&text);
        assert!(told.starts_with("mine.toml:"), "{told}");
        assert!(told.contains(expected), "{told}\n{expected}");
    }
}

#[test]
fn axes_have_the_drives_that_the_options_say() {
    let chosen = |texts: &[&str]| {
        let choices: Vec<Choice> = texts.iter().map(|text| text.parse().unwrap()).collect();
        Chosen::of(&choices, Lang::En)
    };
    let kv = |texts: &[&str]| {
        let servos = chosen(texts).unwrap().servos(&Params::sheets()).unwrap();
        servos.map(|servo| servo.map(|servo| servo.kv_milli / 1000))
    };
    assert_eq!(kv(&[]), [None, None]);
    assert_eq!(kv(&["kv30"]), [Some(30), Some(30)]);
    assert_eq!(kv(&["x=kv15", "kv30"]), [Some(15), Some(30)]);
    assert_eq!(kv(&["kv30", "X=ideal"]), [None, Some(30)]);
    assert_eq!(kv(&["Z=kv100"]), [None, Some(100)]);
    assert_eq!(chosen(&["ideal"]).unwrap().words(), None);
    let words = chosen(&["Z=technosoft-ipos"]).unwrap().words().unwrap();
    assert_eq!(
        words.en,
        "X ideal, Z technosoft-ipos (13 of its 13 facts not verified)"
    );
    for wrong in [
        &["kv30", "kv15"][..],
        &["Z=kv30", "Z=kv15"],
        &["C=kv30"],
        &["Z=kv31"],
        &["Z="],
    ] {
        assert!(matches!(chosen(wrong), Err(Failure::Usage(_))), "{wrong:?}");
    }
    let none = chosen(&["infranor-xtrapuls"])
        .unwrap()
        .servos(&Params::sheets());
    let words = none.unwrap_err().words().unwrap();
    assert!(words.en.contains("has no mode 8 on CAN"), "{words:?}");
}
