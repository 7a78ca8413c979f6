//! `expand`: golden move lists, and the worked figures of the sheets' examples.

use std::io::Write as _;
use std::process::{Command, Output, Stdio};

use serde_json::Value;

use crate::{cases, code, examples, golden, leadscrew, root, stderr, stdout};

fn moves(program: &str) -> Vec<Value> {
    let output = leadscrew(&["expand", program, "--json"]);
    stdout(&output)
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect()
}

fn of_cycle<'a>(moves: &'a [Value], cycle: &str) -> Vec<&'a Value> {
    moves.iter().filter(|step| step["cycle"] == cycle).collect()
}

fn numbers(moves: &[&Value], field: &str) -> Vec<f64> {
    moves
        .iter()
        .map(|step| step[field].as_f64().unwrap())
        .collect()
}

#[test]
fn golden_move_lists() {
    for case in cases("expand") {
        let output = leadscrew(&["expand", &format!("{case}/program.nc"), "--format", "jsonl"]);
        let text = stdout(&output);
        golden(&root().join(&case).join("expected.jsonl"), &text);
        // An alarm is the last line and the only reason to fail.
        let alarm = text
            .lines()
            .last()
            .is_some_and(|line| line.starts_with("{\"alarm\""));
        assert_eq!(code(&output), i32::from(alarm), "{case}");
        assert_eq!(stderr(&output), "", "{case}");
    }
}

#[test]
fn o0013_is_thirty_moves_of_g76() {
    let all = moves("examples/o0013-g76-m68x6.nc");
    let g76 = of_cycle(&all, "G76");
    assert_eq!(g76.len(), 30);
    let strokes: Vec<&Value> = g76
        .iter()
        .copied()
        .filter(|step| step["stage"] == "approach")
        .collect();
    assert_eq!(
        numbers(&strokes, "x"),
        [64.4, 62.9088, 61.7646, 60.84, 60.64, 60.64]
    );
    assert_eq!(
        numbers(&strokes, "z"),
        [8.960770, 8.530297, 8.199995, 7.933086, 7.875351, 7.875351]
    );
    assert_eq!(numbers(&strokes, "pass"), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    assert_eq!(
        numbers(&strokes, "depth"),
        [1.8, 2.5456, 3.1177, 3.58, 3.68, 3.68]
    );
    let runouts: Vec<&Value> = g76
        .iter()
        .copied()
        .filter(|step| step["stage"] == "runout")
        .collect();
    assert_eq!(
        numbers(&runouts, "x"),
        [70.4, 68.9088, 67.7646, 66.84, 66.64, 66.64]
    );
    let last = g76.last().unwrap();
    assert_eq!(
        (last["x"].as_f64(), last["z"].as_f64()),
        (Some(80.0), Some(10.0))
    );
}

#[test]
fn o0008_is_310_moves_of_g75() {
    let all = moves("examples/o0008-g75-grooves.nc");
    let g75 = of_cycle(&all, "G75");
    assert_eq!(g75.len(), 310);
    assert_eq!(
        g75.iter().filter(|step| step["kind"] == "feed").count(),
        150
    );
    let columns: Vec<f64> = (1..=10)
        .map(|pass| {
            let first = g75.iter().find(|step| step["pass"] == pass).unwrap();
            first["z"].as_f64().unwrap()
        })
        .collect();
    assert_eq!(
        columns,
        [
            -24.0, -27.0, -30.0, -33.0, -36.0, -39.0, -42.0, -45.0, -48.0, -50.0
        ]
    );
}

#[test]
fn the_printed_g78_expands_to_twenty_moves_with_one_warning() {
    let all = moves("examples/g78-as-printed.nc");
    assert_eq!(
        all.iter().filter(|line| !line["warning"].is_null()).count(),
        1
    );
    let g78 = of_cycle(&all, "G78");
    assert_eq!(g78.len(), 20);
    let approaches: Vec<&Value> = g78
        .iter()
        .copied()
        .filter(|step| step["stage"] == "approach")
        .collect();
    assert_eq!(numbers(&approaches, "x"), [62.4, 61.0, 60.0, 60.0]);
    assert_eq!(numbers(&approaches, "depth"), [1.8, 2.5, 3.0, 3.0]);
}

#[test]
fn every_example_but_none_alarms() {
    for name in examples() {
        let output = leadscrew(&["expand", &name, "--json"]);
        assert_eq!(
            code(&output),
            0,
            "{name}: {}",
            stdout(&output).lines().last().unwrap_or_default()
        );
        assert!(output.stdout.len() > 100, "{name}");
    }
}

#[test]
fn the_three_formats_list_the_same_moves() {
    let program = "examples/o0013-g76-m68x6.nc";
    let json = moves(program).len();
    let csv = stdout(&leadscrew(&["expand", program, "--format", "csv"]));
    let text = stdout(&leadscrew(&["expand", program]));
    assert_eq!(csv.lines().count(), json + 1);
    assert_eq!(text.lines().count(), json + 1);
    let columns = csv.lines().next().unwrap().matches(',').count();
    assert!(csv.lines().all(|line| line.matches(',').count() == columns));
}

#[test]
fn the_table_is_in_the_language_asked_for() {
    let output = leadscrew(&["expand", "examples/g84-tap.nc", "--lang", "zh"]);
    assert_eq!(
        stdout(&output),
        "  序号  行号  循环  刀次 阶段      类型             X           Z          说明\n\
         \x20    1     3                       快速       50            0\n\
         \x20    2     4                       主轴       50            0         1000 r/min  刚性\n\
         \x20    3     5  G84      1 攻丝      攻丝       50          -50         深度 50  导程 2  25 转  1000 r/min\n\
         \x20    4     5  G84      1 暂停      暂停       50          -50         深度 50  3000 ms\n\
         \x20    5     5  G84      1 退出      攻丝       50            0         深度 0  导程 2  -25 转  -1000 r/min\n\
         \x20    6     6                       主轴       50            0         0 r/min\n\
         \x20    7     7                       辅助       50            0         M30\n"
    );
    // No stage and no kind is left without its word.
    for example in [
        "g78-two-start",
        "o0008-g75-grooves",
        "g84-bolt-circle",
        "g84-peck",
        "shaft",
    ] {
        let output = leadscrew(&["expand", &format!("examples/{example}.nc"), "--lang", "zh"]);
        for line in stdout(&output).lines() {
            assert!(
                !line.contains(|c: char| c.is_ascii_lowercase() && !"mrins/".contains(c)),
                "{line}"
            );
        }
    }
}

#[test]
fn a_table_of_nothing_has_no_heading() {
    let output = leadscrew(&["expand", "tests/golden/none.nc"]);
    assert_eq!((code(&output), stdout(&output).as_str()), (2, ""));
    let folder = crate::Folder::new("no-moves");
    let program = folder.file("wrong.nc");
    std::fs::write(&program, "G33 Z5 F1\n").unwrap();
    let output = leadscrew(&["expand", &program]);
    assert_eq!((code(&output), stdout(&output).as_str()), (1, ""));
    let output = leadscrew(&["expand", &program, "--format", "csv"]);
    assert_eq!(stdout(&output).lines().count(), 1);
}

/// What `expand` says of a program that comes through a pipe, which cannot be read twice.
fn piped(program: &str, args: &[&str]) -> Output {
    let mut child = Command::new(env!("CARGO_BIN_EXE_leadscrew"))
        .args(["expand", "/dev/stdin"])
        .args(args)
        .env("NO_COLOR", "1")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stdin = child.stdin.take().unwrap();
    stdin.write_all(program.as_bytes()).unwrap();
    drop(stdin);
    child.wait_with_output().unwrap()
}

/// A block whose cycle is refused, because it begins inside the work, behind `ahead`.
fn refused(ahead: &str) -> String {
    format!("{ahead}M3 S300 T0101 G76 X60 Z-50 P36800 Q18000 F1\n")
}

#[test]
fn of_a_line_through_a_pipe_the_blocks_before_the_refused_one_stay() {
    let folder = crate::Folder::new("piped");
    let file = folder.file("refused.nc");
    let listed = |output: &Output| -> Vec<Value> {
        assert_eq!(code(output), 1);
        let told = stdout(output);
        let all = told.lines().map(|line| serde_json::from_str(line).unwrap());
        all.map(|line: Value| match line.get("alarm") {
            Some(alarm) => alarm["no"].clone(),
            None => line["m"].clone(),
        })
        .collect()
    };
    // In the first piece that is read, on the seam of two (a piece is 16 KiB), behind several.
    for begins in [13, 16_330, 16_350, 16_380, 16_383, 16_384, 16_385, 40_000] {
        let mut program = String::from("G50 X64 Z10\n");
        program.extend(std::iter::repeat_n('\n', begins - program.len()));
        program += &refused("M8; (a; b) M9; ");
        let output = piped(&program, &["--format", "jsonl"]);
        assert_eq!(listed(&output), [8, 9, 4103], "{begins}");
        std::fs::write(&file, &program).unwrap();
        let output = leadscrew(&["expand", &file, "--format", "jsonl"]);
        assert_eq!(listed(&output), [8, 9, 4103], "{begins}");
    }
}

/// Wherever in the list a piece of it is written.
#[test]
fn of_a_refused_block_nothing_is_listed_in_a_long_program_either() {
    let fill = |lines: usize| -> String {
        let line = |n: usize| format!("G0 X{}\n", 64 + n % 2);
        String::from("G50 X64 Z10\n") + &(1..=lines).map(line).collect::<String>()
    };
    // So many moves fill a piece.
    let whole = stdout(&piped(&fill(2000), &["--format", "csv"]));
    let mut length = 0;
    let pieces = whole.lines().take_while(|line| {
        length += line.len() + 1;
        length < 1 << 16
    });
    let full = pieces.count();
    for lines in full - 4..full + 4 {
        let program = fill(lines) + &refused("");
        let output = piped(&program, &["--format", "csv"]);
        assert_eq!(
            (code(&output), stdout(&output).lines().count()),
            (1, lines + 1)
        );
    }
}

/// The same where the block has a warning: the warning is told, and after it the alarm.
#[test]
fn of_a_refused_block_with_a_warning_nothing_is_listed() {
    let tap = "M3 S300 T0101 G84 Z-3 R-3 F100 J100\n";
    let output = piped(&format!("M8\n{tap}"), &["--format", "csv"]);
    let told = stdout(&output);
    assert_eq!(told.lines().count(), 2, "{told}");
    let told = stderr(&output);
    let (warning, alarm) = (told.find("4909").unwrap(), told.find("alarm[").unwrap());
    assert!(warning < alarm, "{told}");
    // A table without a line has no heading.
    let output = piped(&tap.replace("T0101", ""), &[]);
    assert_eq!(stdout(&output), "");
}
