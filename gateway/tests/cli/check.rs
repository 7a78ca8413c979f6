//! `check`: what people read when a program is wrong, and what scripts read.

use std::path::{Path, PathBuf};

use leadscrew_language::heading::Allowed;
use serde_json::Value;

use crate::{Folder, cases, code, examples, golden, leadscrew, root, stderr, stdout};

#[test]
fn golden_diagnostics_in_both_languages() {
    for case in cases("check") {
        for lang in ["en", "zh"] {
            let output = leadscrew(&["check", &format!("{case}/program.nc"), "--lang", lang]);
            golden(
                &root().join(&case).join(format!("expected.{lang}.txt")),
                &stderr(&output),
            );
            assert_eq!(code(&output), 1, "{case}");
        }
    }
}

#[test]
fn the_printed_g78_is_refused_for_the_spindle_and_for_the_lead() {
    let output = leadscrew(&["check", "--json", "examples/g78-as-printed.nc"]);
    assert_eq!(code(&output), 1);
    let result: Value = serde_json::from_str(&stdout(&output)).unwrap();
    assert_eq!(result["ok"], false);
    let file = &result["files"][0];
    assert_eq!(file["file"], "examples/g78-as-printed.nc");
    let alarms = file["alarms"].as_array().unwrap();
    let messages: Vec<&str> = alarms
        .iter()
        .map(|alarm| alarm["message"].as_str().unwrap())
        .collect();
    assert_eq!(alarms.len(), 2, "{messages:?}");
    assert!(messages[0].contains("spindle"), "{messages:?}");
    assert!(
        messages[1].contains("300 mm") && messages[1].contains("70 mm"),
        "{messages:?}"
    );
    for alarm in alarms {
        for field in [
            "file",
            "no",
            "line",
            "column",
            "end_column",
            "message",
            "help",
        ] {
            assert!(!alarm[field].is_null(), "{field}");
        }
    }
    assert_eq!(file["warnings"].as_array().unwrap().len(), 1);
}

#[test]
fn every_other_example_is_good() {
    for name in examples() {
        if name != "examples/g78-as-printed.nc" {
            let output = leadscrew(&["check", &name]);
            assert_eq!(code(&output), 0, "{name}: {}", stderr(&output));
        }
    }
}

/// A folder of `examples` and those below it: programs and machine files.
fn files_of_examples(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files_of_examples(&path, files);
        } else {
            files.push(path);
        }
    }
}

/// Each program says by `(ALLOW ..)` what looks wrong in it and is meant; a machine file would say so for all of them.
#[test]
fn nothing_in_the_examples_looks_wrong() {
    let mut files = Vec::new();
    files_of_examples(&root().join("examples"), &mut files);
    let of_kind = |end: &str| {
        let named = files
            .iter()
            .filter(|path| path.to_str().unwrap().ends_with(end));
        named.cloned().collect::<Vec<_>>()
    };
    for machine in of_kind("leadscrew.toml") {
        let text = std::fs::read_to_string(&machine).unwrap();
        let allows = text
            .lines()
            .any(|line| line.trim_start().starts_with("allow"));
        assert!(!allows, "{}", machine.display());
    }
    let programs = of_kind(".nc");
    let names: Vec<&str> = programs.iter().map(|path| path.to_str().unwrap()).collect();
    // Programs of the folder itself, and of those in it.
    assert!(names.len() > examples().len());
    for name in names {
        let result = checked(&[name]);
        let file = &result["files"][0];
        for warning in file["warnings"].as_array().unwrap() {
            let number = warning["no"].as_u64().unwrap() as u16;
            assert!(!Allowed::may_have(number), "{name}: {warning}");
        }
    }
}

#[test]
fn cycles_are_reported_with_what_they_need() {
    let output = leadscrew(&[
        "check",
        "--json",
        "examples/o0013-g76-m68x6.nc",
        "examples/o0008-g75-grooves.nc",
    ]);
    let result: Value = serde_json::from_str(&stdout(&output)).unwrap();
    assert_eq!(result["ok"], true);
    let thread = &result["files"][0]["cycles"][0];
    assert_eq!(thread["line"], 6);
    assert_eq!(thread["cycle"], "G76");
    assert_eq!(thread["passes"], 6);
    // The last pass stands 3.68 mm · tan 30° from A.
    assert_eq!(thread["z_shift_max_mm"], 2.124649);
    let sum = thread["z_shift_max_mm"].as_f64().unwrap() + thread["lead_in_mm"].as_f64().unwrap();
    assert!((thread["start_before_mm"].as_f64().unwrap() - sum).abs() < 1e-9);
    // 8000 mm/min at 6 mm a turn.
    assert_eq!(thread["rpm_max"], 1333);
    assert!(thread["time_s"].as_f64().unwrap() > 10.0);
    let groove = &result["files"][1]["cycles"][0];
    assert_eq!(
        (groove["cycle"].as_str(), groove["passes"].as_u64()),
        (Some("G75"), Some(10))
    );
}

#[test]
fn a_groove_in_the_face_has_its_own_name() {
    let folder = Folder::new("face-groove");
    let program = folder.file("p.nc");
    let text = "G98\nM3 S500\nG0 X40 Z2\nG74 R1\nG74 X20 Z-5 P6000 Q2000 F50\nM30\n";
    std::fs::write(&program, text).unwrap();
    let output = leadscrew(&["check", "--json", &program]);
    let result: Value = serde_json::from_str(&stdout(&output)).unwrap();
    assert_eq!(result["files"][0]["cycles"][0]["cycle"], "G74");
}

#[test]
fn a_retract_longer_than_an_infeed_is_a_warning_and_no_more() {
    let folder = Folder::new("retract");
    let program = folder.file("p.nc");
    let text = "M3 S500\nG0 X125 Z-24\nG75 R0.5 F150\nG75 X40 Z-50 P6000 Q30000\nM30\n";
    for (text, warnings) in [
        (text.to_owned(), vec![4921]),
        (text.replace("R0.5", "R0.3"), vec![]),
        // The last infeed that needs no retract.
        (text.replace("P6000", "P850000"), vec![]),
    ] {
        std::fs::write(&program, text).unwrap();
        let result = checked(&[&program]);
        let told = result["files"][0]["warnings"].as_array().unwrap();
        let numbers: Vec<_> = told.iter().map(|w| w["no"].as_u64().unwrap()).collect();
        assert_eq!((result["ok"].as_bool(), numbers), (Some(true), warnings));
    }
}

#[test]
fn one_bad_file_among_good_ones_fails() {
    let output = leadscrew(&["check", "examples/shaft.nc", "examples/g78-as-printed.nc"]);
    assert_eq!(code(&output), 1);
    assert!(stdout(&output).contains("examples/shaft.nc: ok"));
    assert!(stdout(&output).contains("examples/g78-as-printed.nc: 2 alarms"));
}

#[test]
fn strict_makes_a_long_lead_in_a_failure() {
    let folder = Folder::new("strict");
    let program = folder.file("short.nc");
    std::fs::write(
        &program,
        "M3 S1000\nG0 X80 Z4\nG76 P010060 Q1500 R0.1\nG76 X60.64 Z-14 P36800 Q18000 F6\nM30\n",
    )
    .unwrap();
    let relaxed = leadscrew(&["check", &program]);
    assert_eq!(code(&relaxed), 0, "{}", stderr(&relaxed));
    assert!(
        stderr(&relaxed).contains("warning[4940]"),
        "{}",
        stderr(&relaxed)
    );
    assert_eq!(code(&leadscrew(&["check", "--strict", &program])), 1);
}

#[test]
fn parameters_decide() {
    let good = leadscrew(&["check", "examples/o0013-g76-m68x6.nc"]);
    assert_eq!(code(&good), 0);
    // 300 rpm at 6 mm a turn are 1800 mm/min.
    let slow = leadscrew(&[
        "check",
        "examples/o0013-g76-m68x6.nc",
        "--set",
        "1430.Z=1700",
    ]);
    assert_eq!(code(&slow), 1);
    assert!(stderr(&slow).contains("1700 mm/min"), "{}", stderr(&slow));
}

/// Each place is told, not only the first, and no program makes a report without end.
#[test]
fn a_mistake_is_told_on_every_line_where_it_stands() {
    let folder = Folder::new("every-line");
    let program = folder.file("many.nc");
    let thread = "G78 P020045 Q0.15 R0.5\nG78 X60 Z-60 P3 Q1.8 F3 J1.5 K2\n";
    std::fs::write(&program, format!("G0 X80 Z10\n{}", thread.repeat(2))).unwrap();
    let told = checked(&[&program]);
    let lines = |told: &Value| -> Vec<u64> {
        let alarms = told["files"][0]["alarms"].as_array().unwrap();
        alarms
            .iter()
            .map(|alarm| alarm["line"].as_u64().unwrap())
            .collect()
    };
    assert_eq!(lines(&told), [3, 5]);
    assert!(told["files"][0].get("further").is_none());
    std::fs::write(&program, format!("G0 X80 Z10\n{}", thread.repeat(14))).unwrap();
    let told = checked(&[&program]);
    assert_eq!(lines(&told), [3, 5, 7, 9, 11, 13, 15, 17, 19, 21]);
    let further = serde_json::json!([{ "no": 4250, "lines": 4 }]);
    assert_eq!(told["files"][0]["further"], further);
    let output = leadscrew(&["check", &program]);
    assert!(stderr(&output).ends_with("4250: on 4 further lines, too\n"));
    assert!(
        stdout(&output).contains(": 14 alarms; "),
        "{}",
        stdout(&output)
    );
}

fn checked(args: &[&str]) -> Value {
    let output = leadscrew(&[&["check", "--json"][..], args].concat());
    serde_json::from_str(&stdout(&output)).unwrap()
}

#[test]
fn ten_thousand_cycles_are_listed_and_the_others_counted() {
    let folder = Folder::new("many-cycles");
    let program = folder.file("p.nc");
    let text = |calls: &str| {
        format!(
            "G99 G97 M3 S500\nG0 X40 Z-5\nM98 P20 L9999\n{calls}M30\nO20\nG75 X38 P2 F0.1\nM99\n"
        )
    };
    for (calls, further) in [("M98 P20\n", 0), ("M98 P20 L2\n", 1), ("M98 P20 L4\n", 3)] {
        std::fs::write(&program, text(calls)).unwrap();
        let result = checked(&[&program, "--set", "182.7=1"]);
        let file = &result["files"][0];
        assert_eq!(file["alarms"], serde_json::json!([]));
        assert_eq!(file["cycles"].as_array().unwrap().len(), 10_000);
        let counted = file
            .get("further_cycles")
            .map(|count| count.as_u64().unwrap());
        assert_eq!(counted, (further > 0).then_some(further));
        let output = leadscrew(&["check", &program, "--set", "182.7=1"]);
        let listed = stdout(&output);
        assert_eq!(listed.matches("line 7: G75").count(), 10_000);
        let last = match further {
            0 => String::new(),
            1 => "  and 1 further cycle\n".into(),
            _ => format!("  and {further} further cycles\n"),
        };
        assert!(listed.ends_with(&format!(" s\n{last}")), "{further}");
    }
    let output = leadscrew(&["check", &program, "--set", "182.7=1", "--lang", "zh"]);
    assert!(stdout(&output).ends_with("  另有 3 个循环\n"));
}
