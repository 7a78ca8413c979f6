//! The control that a program is written for: by option, machine file or comment.

use serde_json::Value;

use crate::{Folder, code, leadscrew, stderr, stdout};

/// A turned shoulder and a thread, as two controls write them.
const SYSTEM_A: &str = "G50 X100. Z50.\nG99 G97 M3 S400\nG0 X52. Z2.\nG90 X48. Z-20. F0.2\nX46.\nG0 X50. Z6.\nG92 X47. Z-15. F2.\nG0 X100. Z50.\nM5\nM30\n";
const SYSTEM_B: &str = "G92 X100. Z50.\nG95 G97 M3 S400\nG90 G0 X52. Z2.\nG77 X48. Z-20. F0.2\nX46.\nG0 X50. Z6.\nG78 X47. Z-15. F2.\nG0 X100. Z50.\nM5\nM30\n";

fn moves(args: &[&str]) -> Vec<Value> {
    let output = leadscrew(&[&["expand", "--format", "jsonl"], args].concat());
    assert_eq!(code(&output), 0, "{args:?}: {}", stderr(&output));
    let lines = stdout(&output);
    lines
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect()
}

#[test]
fn the_three_ways_to_name_a_control_make_the_same_moves() {
    let folder = Folder::new("dialects");
    let write = |name: &str, text: &str| {
        let path = folder.file(name);
        std::fs::write(&path, text).unwrap();
        path
    };
    let expected = moves(&[&write("a.nc", SYSTEM_A)]);
    let program = write("b.nc", SYSTEM_B);
    assert_eq!(moves(&[&program, "--dialect", "fanuc-b"]), expected);
    let commented = write("comment.nc", &format!("(DIALECT FANUC-B)\n{SYSTEM_B}"));
    let without_line = |steps: Vec<Value>| -> Vec<Value> {
        let without = |mut step: Value| {
            step.as_object_mut().unwrap().remove("line");
            step
        };
        steps.into_iter().map(without).collect()
    };
    assert_eq!(
        without_line(moves(&[&commented])),
        without_line(expected.clone())
    );
    // The comment counts before the option: the program knows best what it was written for.
    assert_eq!(
        moves(&[&commented, "--dialect", "haas"]),
        moves(&[&commented])
    );
    write(
        "leadscrew.toml",
        "increment_is_c = 1\ndialect = \"fanuc-b\"\n",
    );
    assert_eq!(moves(&[&program]), expected);
    // The option counts before the file.
    assert_eq!(
        moves(&[&folder.file("a.nc"), "--dialect", "gsk980td"]),
        expected
    );
}

#[test]
fn a_program_of_another_control_is_told_so_and_codes_are_named_as_written() {
    let folder = Folder::new("looks");
    let program = folder.file("p.nc");
    std::fs::write(&program, SYSTEM_B).unwrap();
    let told = stderr(&leadscrew(&["check", &program]));
    assert!(told.contains("warning[4994]"), "{told}");
    assert!(
        told.contains("a program for fanuc-b, and it is read as one for gsk980td"),
        "{told}"
    );
    let told = stderr(&leadscrew(&["check", &program, "--dialect", "fanuc-b"]));
    assert!(!told.contains("4994"), "{told}");
    std::fs::write(&program, "(DIALECT FANUC-B)\nG77 X10. Z-5.\nM30\n").unwrap();
    let told = stderr(&leadscrew(&["check", &program]));
    assert!(told.contains("G77 cuts and no feed is set"), "{told}");
}

#[test]
fn a_program_for_no_control_that_is_read_is_told_so_where_it_is_refused() {
    let folder = Folder::new("foreign");
    let program = folder.file("p.nc");
    for text in [
        "G40 G90 G94\nG7\nM3 S500\nM2\n",
        "o100 sub\nG0 X5\no100 endsub\nM2\n",
        "#<dia>=20\nG0 X#<dia>\nM2\n",
    ] {
        std::fs::write(&program, text).unwrap();
        for more in [&[][..], &["--dialect", "haas"]] {
            let output = leadscrew(&[&["check", &program], more].concat());
            let told = stderr(&output);
            assert_eq!(code(&output), 1, "{told}");
            assert!(told.contains("for Mach or LinuxCNC"), "{told}");
            assert!(!told.contains("4994"), "{told}");
        }
        let told = stderr(&leadscrew(&["--lang", "zh", "check", &program]));
        assert!(told.contains("用于 Mach 或 LinuxCNC"), "{told}");
    }
    // One without an alarm of its own keeps its other remedies.
    std::fs::write(&program, "G21\nG0 X5 R3\nM2\n").unwrap();
    let told = stderr(&leadscrew(&["check", &program]));
    assert!(!told.contains("LinuxCNC"), "{told}");
}

#[test]
fn a_name_that_is_none_is_an_alarm_with_its_place() {
    let folder = Folder::new("no-dialect");
    let program = folder.file("p.nc");
    std::fs::write(&program, "O1\n(DIALECT FANUC-D)\nM30\n").unwrap();
    let output = leadscrew(&["check", &program]);
    assert_eq!(code(&output), 1);
    let told = stderr(&output);
    assert!(
        told.contains("alarm[4086]") && told.contains("p.nc:2:10"),
        "{told}"
    );
    std::fs::write(&program, "M30\n").unwrap();
    std::fs::write(folder.file("leadscrew.toml"), "dialect = \"fanuc\"\n").unwrap();
    let output = leadscrew(&["check", &program]);
    assert_eq!(code(&output), 1);
    let told = stderr(&output);
    assert!(
        told.contains("alarm[4416]") && told.contains("leadscrew.toml:1:"),
        "{told}"
    );
    let output = leadscrew(&["check", &program, "--dialect", "fanuc"]);
    assert_eq!(code(&output), 2);
    assert!(stderr(&output).contains("fanuc-a"), "{}", stderr(&output));
}

#[test]
fn the_nearest_machine_file_counts_is_named_and_gives_way_to_options() {
    let folder = Folder::new("beside");
    std::fs::create_dir_all(folder.file("part")).unwrap();
    let program = folder.file("part/p.nc");
    std::fs::write(
        &program,
        "G97 M3 S300\nG0 X24 Z8\nG76 P010060 Q50 R0.05\nG76 X17.546 Z-20 P1227 Q400 F2\nM30\n",
    )
    .unwrap();
    let height = |args: &[&str]| {
        let output = leadscrew(&[&["check", &program, "--json"], args].concat());
        let result: Value = serde_json::from_slice(&output.stdout).unwrap();
        (result["files"][0]["machine"].clone(), code(&output))
    };
    // In the folder above: 0.0001 mm, so the height is not that of a thread.
    let above = folder.file("leadscrew.toml");
    assert_eq!(height(&[]), (Value::from(above), 1));
    let own = folder.file("part/leadscrew.toml");
    std::fs::write(&own, "increment_is_c = 0\n").unwrap();
    assert_eq!(height(&[]), (Value::from(own), 0));
    assert_eq!(height(&["--set", "1004.1=1"]).1, 1);
}

#[test]
fn q_of_a_thread_in_one_block_turns_every_stroke_and_moves_nothing_else() {
    let folder = Folder::new("start-angle");
    let program = folder.file("p.nc");
    let of = |words: &str| {
        let text = format!(
            "(DIALECT HAAS)\nG97 M3 S500\nG0 X22 Z5\nG76 X17.546 Z-25 K1.227 D0.4 F2 A60{words}\nM30\n"
        );
        std::fs::write(&program, text).unwrap();
        moves(&[&program])
    };
    let turned = of(" Q120000 L2");
    // Both starts of each pass, half a turn apart.
    let strokes: Vec<(f64, f64)> = turned
        .iter()
        .filter(|step| step["kind"] == "thread" && step["stage"] != "runout")
        .map(|step| {
            (
                step["x"].as_f64().unwrap(),
                step["start_deg"].as_f64().unwrap(),
            )
        })
        .collect();
    let x = [
        19.2, 18.8686, 18.6144, 18.4, 18.2, 18.0, 17.8, 17.6, 17.546, 17.546,
    ];
    let expected: Vec<_> = x.iter().flat_map(|x| [(*x, 120.0), (*x, 300.0)]).collect();
    assert_eq!(strokes, expected);
    // A run-out goes on in phase with its stroke, and all else is that of the thread without Q.
    let plain = of(" L2");
    let degrees = |step: &Value| (step["start_deg"].as_f64().unwrap_or(0.0) * 1e5).round() as i64;
    for (plain, turned) in plain.iter().zip(&turned) {
        let further = (degrees(turned) - degrees(plain)).rem_euclid(36_000_000);
        let is_stroke = plain["kind"] == "thread";
        assert_eq!(further, if is_stroke { 12_000_000 } else { 0 }, "{turned}");
        let [mut plain, mut turned] = [plain.clone(), turned.clone()];
        for step in [&mut plain, &mut turned] {
            step.as_object_mut().unwrap().remove("start_deg");
        }
        assert_eq!(plain, turned);
    }
    assert_eq!((plain.len(), turned.len()), (103, 103));
    std::fs::write(
        &program,
        "(DIALECT HAAS)\nG97 M3 S500\nG0 X22 Z5\nG76 X17.546 Z-25 K1.227 D0.4 F2 Q120.\nM30\n",
    )
    .unwrap();
    let output = leadscrew(&["check", &program]);
    let told = stderr(&output);
    assert!(
        told.contains("alarm[4023]") && told.contains("p.nc:4:33"),
        "{told}"
    );
}

/// It becomes a G78 on the way [D226], and whoever wrote G76 reads G76.
#[test]
fn a_thread_in_one_block_is_told_as_g76_everywhere() {
    let folder = Folder::new("one-block");
    let program = folder.file("part.nc");
    let text = "M3 S300\nG0 X24. Z5.\nG76 X17.546 Z-25. K1.227 D.4 F2.\nM30\n";
    std::fs::write(&program, text).unwrap();
    for args in [
        &["check"][..],
        &["check", "--json"],
        &["expand"],
        &["expand", "--format", "jsonl"],
        &["expand", "--format", "csv"],
    ] {
        let output = leadscrew(&[args, &[&program, "--dialect", "haas"]].concat());
        assert_eq!(code(&output), 0, "{args:?}: {}", stderr(&output));
        let told = stdout(&output) + &stderr(&output);
        assert!(told.contains("G76") && !told.contains("G78"), "{told}");
    }
    // The two-line form of a GSK keeps its name.
    let text = "M3 S300\nG0 X24 Z5\nG78 P010060 Q0.1 R0.05\nG78 X17.546 Z-25 P1.227 Q0.4 F2\nM30\n";
    std::fs::write(&program, text).unwrap();
    let output = leadscrew(&["expand", &program]);
    assert!(stdout(&output).contains("G78"));
}
