//! The board's certificate of a cut, against what the simulated tool has truly cut.

use serde_json::Value;

use crate::{Folder, code, leadscrew, stderr, stdout};

/// Two passes of one thread, at 100 and at 600 revolutions.
const TWO_SPEEDS: &str = include_str!("two-speeds.nc");

/// A drive of Z: its figures, and what the board is told of it.
#[derive(Clone, Copy)]
struct Case {
    kv: u32,
    per_mille: u32,
    buffer: u32,
    /// The age that 6064h has, and the one that the board is told, to within so much.
    age_us: u32,
    told_us: u32,
    within_us: u32,
    /// The board takes the lag off.
    taken_off: bool,
    /// What the screw of Z is too long by, which the board takes off.
    um_per_m: i32,
}

const CASE: Case = Case {
    kv: 30,
    per_mille: 0,
    buffer: 0,
    age_us: 0,
    told_us: 0,
    within_us: 20,
    taken_off: true,
    um_per_m: 0,
};

fn args(folder: &Folder, case: Case) -> Vec<String> {
    let Case { kv, buffer, .. } = case;
    let share = format!("{}.{:03}", case.per_mille / 1000, case.per_mille % 1000);
    let file = folder.file("mine.toml");
    // Play is behind the encoder: the board cannot see it.
    let text = format!(
        "name = \"mine\"\ntitle = \"Mine\"\nsource = [\n  \
         {{ fact = \"figures\", kind = \"assumed\", ref = \"\", verified = false }},\n  \
         {{ fact = \"actual\", kind = \"assumed\", ref = \"\", verified = false }},\n  \
         {{ fact = \"mode.8\", kind = \"assumed\", ref = \"\", verified = false }},\n]\n\
         figures.feed_forward = {share}\nfigures.kv_per_s = {kv}\nmode.8.buffer.default = {buffer}\n\
         figures.following_mm = 100\nfigures.backlash_um = 0\nfigures.pitch_um_per_m = {screw}\nactual.age_us = {age}\n",
        age = case.age_us,
        screw = case.um_per_m,
    );
    std::fs::write(&file, text).unwrap();
    let mut args = vec![
        "--drive".to_owned(),
        format!("Z={file}"),
        "--set".to_owned(),
        "1828.Z=100".to_owned(),
    ];
    let mut set = |text: String| args.extend(["--set".to_owned(), text]);
    if case.taken_off {
        set(format!("9070.Z={kv}0"));
        set(format!("9071.Z={}", case.per_mille));
        set(format!("9003.Z={}", (buffer + 1) * 1000 - 125));
    }
    if case.um_per_m != 0 {
        set("1861.Z=-200".to_owned());
        set("1862.Z=25".to_owned());
        for point in 0..16 {
            // In tenths of a micrometre.
            let error = (25 * point - 200) * case.um_per_m / 100;
            set(format!(
                "{}.Z={}.{}",
                1871 + point,
                error / 10,
                (error % 10).abs()
            ));
        }
    }
    set(format!("9072.Z={}", case.told_us));
    set(format!("9075.Z={}", case.within_us));
    args
}

/// `simulate`: exit code, what it says to a person or as JSON, and what it says of a failure.
fn ran(folder: &Folder, program: &str, case: Case, more: &[&str]) -> (i32, String, String) {
    let file = folder.file("part.nc");
    std::fs::write(&file, program).unwrap();
    let args = args(folder, case);
    let mut all = vec!["simulate", file.as_str()];
    all.extend(args.iter().map(String::as_str));
    all.extend(more);
    let ran = leadscrew(&all);
    (code(&ran), stdout(&ran), stderr(&ran))
}

fn told(folder: &Folder, program: &str, case: Case, more: &[&str]) -> Value {
    let (code, out, err) = ran(folder, program, case, &[&["--json"], more].concat());
    assert_eq!(code, 0, "{out}{err}");
    serde_json::from_str(&out).unwrap()
}

fn number(of: &Value, key: &str) -> f64 {
    of[key].as_f64().unwrap_or_else(|| panic!("{key} in {of}"))
}

/// All that the board says of the cut is within its own uncertainty of the truth, and the uncertainty is not more than
/// `most` for a groove.
fn agrees(told: &Value, most: f64) {
    let (threads, truth) = (&told["threads"], &told["cut"]);
    let passes = truth["passes"].as_array().unwrap();
    assert_eq!(threads.as_array().unwrap().len(), passes.len());
    for (thread, pass) in threads.as_array().unwrap().iter().zip(passes) {
        let cut = &thread["cut"];
        assert_eq!(thread["line"], pass["line"]);
        for (key, true_key) in [
            ("least_um", "groove_um"),
            ("most_um", "groove_um"),
            ("lead_um_per_turn", "lead_um_per_turn"),
            ("worst_um", "worst_um"),
        ] {
            let off = number(cut, key) - number(pass, true_key);
            let u = number(cut, &format!("{key}_u"));
            assert!(off.abs() <= u, "{key}: {cut} {pass}");
        }
        assert!(number(cut, "least_um_u") <= most, "{cut}");
    }
    let off = number(told, "cut_apart_um") - number(truth, "shift_um");
    assert!(off.abs() <= number(told, "cut_apart_um_u"), "{off}");
}

#[test]
fn what_the_board_says_of_the_cut_is_true_within_its_uncertainty() {
    let folder = Folder::new("certified-truth");
    for case in [
        CASE,
        Case { kv: 15, ..CASE },
        Case { kv: 100, ..CASE },
        Case {
            taken_off: false,
            ..CASE
        },
        Case {
            um_per_m: -800,
            ..CASE
        },
        Case {
            // The drive is 2 mm behind, where the error is another one.
            taken_off: false,
            um_per_m: 1000,
            ..CASE
        },
        Case {
            kv: 15,
            per_mille: 500,
            age_us: 1000,
            told_us: 990,
            ..CASE
        },
        Case {
            kv: 100,
            per_mille: 1000,
            buffer: 5,
            age_us: 300,
            told_us: 310,
            ..CASE
        },
        Case {
            buffer: 10,
            per_mille: 500,
            age_us: 62,
            told_us: 62,
            within_us: 1,
            ..CASE
        },
        Case {
            taken_off: false,
            kv: 100,
            age_us: 750,
            told_us: 740,
            ..CASE
        },
    ] {
        // 1.2 µm of 20 µs at 60 mm/s, a count of 0.1 µm, and what scatters.
        agrees(&told(&folder, TWO_SPEEDS, case, &[]), 1.6);
    }
}

#[test]
fn it_is_true_under_ripple_and_off_round_speeds() {
    let folder = Folder::new("certified-ripple");
    let program = TWO_SPEEDS.replace("S100", "S304").replace("S600", "S608");
    for case in [
        CASE,
        Case {
            kv: 15,
            age_us: 500,
            told_us: 500,
            ..CASE
        },
    ] {
        let told = told(&folder, &program, case, &["--spindle-ripple", "10@5"]);
        agrees(&told, 4.0);
    }
}

#[test]
fn a_lag_that_is_not_taken_off_is_said() {
    let folder = Folder::new("certified-lag");
    let case = Case {
        taken_off: false,
        ..CASE
    };
    let told = told(&folder, TWO_SPEEDS, case, &[]);
    // (1/Kv + an interpolation − an inner step) · 50 mm/s.
    let apart = number(&told, "cut_apart_um");
    assert!((apart - 1710.4).abs() < 0.3, "{apart}");
    let (_, _, text) = ran(&folder, TWO_SPEEDS, case, &[]);
    assert!(
        text.contains(
            "\n   cut: groove 2052.5 ± 1.4 µm off, lead 0 ± 0.1 µm a turn off, worst 2052.5 ± 2."
        ),
        "{text}"
    );
    assert!(
        text.contains("\ncut: grooves of the same lead 1710.4 ± 1.2 µm apart\n"),
        "{text}"
    );
    let (_, _, text) = ran(&folder, TWO_SPEEDS, case, &["--lang", "zh"]);
    assert!(
        text.contains("切削：相同导程的螺旋槽相互偏移 1710.4 ± 1.2 µm\n"),
        "{text}"
    );
}

/// 9003 is wrong by 100 µs, 6 µm at 60 mm/s; 9072 by 200 µs, 12 µm the other way round.
#[test]
fn what_is_put_in_comes_out() {
    let folder = Folder::new("certified-put-in");
    let more = ["--set", "9003.Z=975"];
    let found = told(&folder, TWO_SPEEDS, CASE, &more);
    agrees(&found, 1.6);
    let groove = number(&found["threads"][1]["cut"], "most_um");
    assert!((groove + 6.0).abs() < 0.3, "{groove}");
    let wrong = Case {
        age_us: 700,
        told_us: 500,
        ..CASE
    };
    let found = told(&folder, TWO_SPEEDS, wrong, &[]);
    let groove = number(&found["threads"][1]["cut"], "most_um");
    assert!((groove - 12.0).abs() < 0.3, "{groove}");
}

#[test]
fn an_age_that_nobody_knows_is_said_and_counts_as_a_period() {
    let folder = Folder::new("certified-age");
    for age_us in [0, 400, 1000] {
        let case = Case {
            age_us,
            within_us: 0,
            ..CASE
        };
        let told = told(&folder, TWO_SPEEDS, case, &[]);
        agrees(&told, 60.5);
        for (thread, u) in [(0, 10.0), (1, 60.0)] {
            let cut = &told["threads"][thread]["cut"];
            assert_eq!(cut["age_known"], false);
            assert!(number(cut, "least_um_u") >= u, "{cut}");
        }
    }
    let case = Case {
        within_us: 0,
        ..CASE
    };
    let (_, _, text) = ran(&folder, TWO_SPEEDS, case, &[]);
    assert!(
        text.contains("; the age of 6064h is not known: 9072.Z, 9075.Z\n"),
        "{text}"
    );
}

#[test]
fn a_tolerance_is_judged_by_the_cut_where_that_is_known() {
    let folder = Folder::new("certified-tolerance");
    let judged = |case: Case, tolerance: &str| {
        let (code, _, text) = ran(&folder, TWO_SPEEDS, case, &["--tolerance", tolerance]);
        (code, text)
    };
    // Beyond it, although the setpoint is true.
    let lags = Case {
        taken_off: false,
        within_us: 0,
        ..CASE
    };
    let (code, text) = judged(lags, "500");
    assert_eq!(code, 1);
    assert!(
        text.contains(
            "the worst error of the cut 2052.5 µm is above the tolerance of 500 µm: line 10"
        ),
        "{text}"
    );
    assert!(!text.contains("not judged by the cut"), "{text}");
    // Within it, uncertainty included.
    let (code, text) = judged(CASE, "25");
    assert_eq!(code, 0, "{text}");
    assert!(!text.contains("not judged by the cut"), "{text}");
    // Nobody can say.
    let unknown = Case {
        within_us: 0,
        ..CASE
    };
    let (code, text) = judged(unknown, "25");
    assert_eq!(code, 0, "{text}");
    assert!(
        text.contains(
            "\ntolerance: not judged by the cut, which is not known well enough: line 10\n"
        ),
        "{text}"
    );
    let found = told(&folder, TWO_SPEEDS, unknown, &["--tolerance", "25"]);
    let within = |thread: usize| found["threads"][thread]["cut"]["within_tolerance"].clone();
    assert_eq!((within(0), within(1)), (Value::Bool(true), Value::Null));
}
