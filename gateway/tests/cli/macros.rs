//! Programs with macros and subprograms: what the commands do with them.

use std::io::Write as _;
use std::process::{Command, Stdio};

use serde_json::Value;

use crate::{Folder, code, leadscrew, root, stderr, stdout};

/// The moves of a program, without their lines.
fn moves(program: &str) -> Vec<Value> {
    let output = leadscrew(&["expand", program, "--format", "jsonl"]);
    assert_eq!(code(&output), 0, "{program}: {}", stderr(&output));
    let without_line = |line: &str| {
        let mut step: Value = serde_json::from_str(line).unwrap();
        step.as_object_mut().unwrap().remove("line");
        step
    };
    stdout(&output).lines().map(without_line).collect()
}

fn shop() -> Vec<String> {
    let files = std::fs::read_dir(root().join("examples/shop")).unwrap();
    let name = |entry: std::io::Result<std::fs::DirEntry>| {
        let name = entry.unwrap().file_name();
        format!("examples/shop/{}", name.to_str().unwrap())
    };
    files
        .map(name)
        .filter(|name| name.ends_with(".nc"))
        .collect()
}

#[test]
fn the_programs_of_the_shop_are_checked_simulated_and_run() {
    let folder = Folder::new("shop");
    let trace = folder.file("trace.csv");
    let programs = shop();
    assert!(programs.len() >= 3);
    for program in programs {
        for args in [
            &["check", &program][..],
            &["simulate", &program, "-o", &trace],
            &["run", &program],
        ] {
            let output = leadscrew(args);
            assert_eq!(code(&output), 0, "{args:?}: {}", stderr(&output));
            assert!(!stdout(&output).contains("warning"), "{}", stdout(&output));
        }
    }
}

#[test]
fn the_golden_copies_are_the_programs_of_the_shop() {
    let read = |path: String| std::fs::read_to_string(root().join(path)).unwrap();
    for program in shop() {
        let name = program
            .trim_start_matches("examples/shop/")
            .trim_end_matches(".nc");
        assert_eq!(
            read("examples/shop/leadscrew.toml".into()),
            read(format!("tests/golden/expand/shop-{name}/leadscrew.toml"))
        );
        assert_eq!(
            read(format!("examples/shop/{name}.nc")),
            read(format!("tests/golden/expand/shop-{name}/program.nc"))
        );
    }
}

#[test]
fn a_macro_makes_the_moves_of_the_blocks_it_stands_for() {
    let folder = Folder::new("unrolled");
    let unrolled = folder.file("p.nc");
    let grooves = (0..4).map(|n| format!("G75 R0.3\nG75 X{} P20000 F0.12\nG0 W-8\n", 38 - 2 * n));
    let text = format!(
        "G50 X80 Z20\nT0202\nG99 M3 S900\nG0 X44 Z-10\n{}G0 X80 Z20\nM5\nM30\n",
        String::from_iter(grooves)
    );
    std::fs::write(&unrolled, text).unwrap();
    assert_eq!(moves("examples/shop/macro-a.nc"), moves(&unrolled));
    let step = |bar: f64, step: f64, length: f64, depth: f64, feed: f64| {
        let mut text = String::new();
        let mut x = bar - 2.0 * depth;
        while x > step {
            text += &format!("G0 X{x}\nG1 Z{:.1} F{feed}\nG0 U1 W1\nZ2\n", 0.1 - length);
            x -= 2.0 * depth;
        }
        let finish = feed * 0.6;
        text += &format!(
            "G0 X{step}\nG1 Z{} F{finish:.3}\nX{}\nG0 Z2\n",
            -length,
            bar + 1.0
        );
        text
    };
    let text = format!(
        "G50 X80 Z20\nT0101\nG99 M3 S1200\nM8\nG0 X44 Z2\n{}{}{}M9\nG0 X80 Z20\nM5\nM30\n",
        step(40.0, 34.0, 50.0, 1.5, 0.25),
        step(34.0, 28.5, 32.0, 1.5, 0.25),
        step(28.5, 20.0, 12.0, 2.0, 0.2)
    );
    std::fs::write(&unrolled, text).unwrap();
    assert_eq!(moves("examples/shop/part-family.nc"), moves(&unrolled));
}

#[test]
fn a_program_that_jumps_may_come_from_a_pipe() {
    let text = "#1=0\nWHILE[#1LT3]DO1\n#1=#1+1\nG0 X[#1*10]\nEND1\nM98 P2\nM30\nO2\nZ5\nM99\n";
    let mut child = Command::new(env!("CARGO_BIN_EXE_leadscrew"))
        .args(["expand", "/dev/stdin", "--json"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    child
        .stdin
        .take()
        .unwrap()
        .write_all(text.as_bytes())
        .unwrap();
    let output = child.wait_with_output().unwrap();
    let lines: Vec<Value> = stdout(&output)
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    let numbers: Vec<_> = lines.iter().map(|step| step["line"].as_i64()).collect();
    assert_eq!(numbers, [4, 4, 4, 9, 7].map(Some), "{lines:?}");
}

#[test]
fn a_far_jump_reads_the_text_again_whatever_its_line_ends() {
    let folder = Folder::new("far");
    let program = folder.file("p.nc");
    for end in ["\n", "\r\n", "\r", "\n\r"] {
        // More than a window of text between the jump and its end, both ways.
        let between: String = (0..9000).map(|n| format!("(line {n}){end}")).collect();
        let text = format!(
            "N1 #1=#1+1{end}{between}G0 X#1{end}IF[#1LT3]GOTO 1{end}M98 P7{end}M30{end}{between}O7{end}G0 Z#1{end}M99{end}"
        );
        std::fs::write(&program, text).unwrap();
        let found: Vec<_> = moves(&program)
            .iter()
            .map(|step| (step["x"].as_f64(), step["z"].as_f64()))
            .collect();
        let at = |x: f64, z: f64| (Some(x), Some(z));
        let expected = [
            at(1.0, 0.0),
            at(2.0, 0.0),
            at(3.0, 0.0),
            at(3.0, 3.0),
            at(3.0, 3.0),
        ];
        assert_eq!(found, expected, "{end:?}");
    }
}

#[test]
fn a_refused_call_takes_back_its_own_pass_of_a_loop_alone() {
    let folder = Folder::new("pass");
    let program = folder.file("p.nc");
    let text = "#1=3\nWHILE[1]DO1\nG0 X#1;G1 Z-#1 F[#1*10]\n#1=#1-1\nEND1\n";
    std::fs::write(&program, text).unwrap();
    let output = leadscrew(&["expand", &program, "--format", "jsonl"]);
    assert_eq!(code(&output), 1);
    let lines: Vec<Value> = stdout(&output)
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    // F0 in the fourth pass: six moves of three passes, the rapid of the fourth, and the alarm.
    assert_eq!(lines.len(), 8, "{lines:?}");
    assert_eq!(lines[7]["alarm"]["no"], 4025);
    assert_eq!(lines[7]["alarm"]["line"], 3);
}

#[test]
fn the_main_program_is_read_once_with_a_note() {
    let folder = Folder::new("m99");
    let program = folder.file("p.nc");
    std::fs::write(&program, "O1\nG0 X50 Z5\nG0 X[40-#1]\nM99\n").unwrap();
    let output = leadscrew(&["check", &program, "--json"]);
    assert_eq!(code(&output), 0);
    let result: Value = serde_json::from_str(&stdout(&output)).unwrap();
    let warnings = result["files"][0]["warnings"].as_array().unwrap();
    assert_eq!(warnings.len(), 1);
    assert_eq!(
        (&warnings[0]["no"], &warnings[0]["line"]),
        (&4992.into(), &4.into())
    );
}

/// Starts of the moves of a run, from its trace.
fn steps(result: &str) -> u64 {
    let result: Value = serde_json::from_str(result).unwrap();
    result["moves"].as_u64().unwrap()
}

#[test]
fn a_run_repeats_the_main_program_as_often_as_it_is_told_to() {
    let folder = Folder::new("passes");
    let program = folder.file("p.nc");
    let text = "O1\n#500=#500+1\nG0 X50 Z5\nG1 X[40-#500] F100 G98 M3 S500\nM99\n";
    std::fs::write(&program, text).unwrap();
    let kept = || std::fs::read_to_string(folder.file("leadscrew.variables")).unwrap();
    for (passes, count) in [("1", 1), ("3", 4)] {
        let output = leadscrew(&["run", &program, "--passes", passes, "--json"]);
        assert_eq!(code(&output), 0, "{}", stderr(&output));
        assert_eq!(stderr(&output), "");
        assert!(
            kept().ends_with(&format!("#500 = {count}.0\n")),
            "{}",
            kept()
        );
    }
    // The moves of the passes are those of a program that has them one after another.
    let once = |passes: &str, text: &str, name: &str| {
        let program = folder.file(name);
        std::fs::write(&program, text).unwrap();
        let own = folder.file(&format!("{name}.variables"));
        let output = leadscrew(&[
            "run",
            &program,
            "--passes",
            passes,
            "--json",
            "--variables",
            &own,
        ]);
        assert_eq!(code(&output), 0, "{}", stderr(&output));
        steps(&stdout(&output))
    };
    let body = text.trim_start_matches("O1\n").trim_end_matches("M99\n");
    assert_eq!(
        once("3", text, "again.nc"),
        once("1", &format!("{body}{body}{body}M99\n"), "thrice.nc")
    );
    // A way back to a block is a pass, too, and M30 ends it whatever is left.
    let ends = "O1\nN5 #500=#500+1\nG0 X[50+#500]\nIF[#500GE4]GOTO 9\nM99 P5\nN9 M30\n";
    assert_eq!(once("9", ends, "ends.nc"), 4 + 1);
    let output = leadscrew(&["run", &program, "--passes", "0"]);
    assert_eq!(code(&output), 2);
}

#[test]
fn the_commands_that_only_look_stop_at_the_second_pass_and_say_so() {
    let folder = Folder::new("second");
    let program = folder.file("p.nc");
    for (text, line, moves) in [
        ("O1\nG0 X50 Z5\nG0 X40\nM99\n", 4, 2),
        ("O1\nG0 X50 Z5\nN5 G0 X40\nM99 P5\n", 4, 2),
        ("O1\nG0 X50 Z5\nM99 P7\nG0 X30\nN7 G0 X40\nM99\n", 6, 2),
    ] {
        std::fs::write(&program, text).unwrap();
        let place = format!("{program}:{line}:1\n");
        for command in ["check", "expand", "simulate"] {
            let output = leadscrew(&[command, &program]);
            assert_eq!(code(&output), 0, "{command}: {}", stderr(&output));
            let told = stderr(&output);
            assert!(
                told.contains(
                    "warning[4992]: M99 begins the main program again: it is read once here\n"
                ),
                "{command}: {told}"
            );
            assert!(told.contains(&place), "{command}: {told}");
        }
        let output = leadscrew(&["simulate", &program, "--json"]);
        assert_eq!(steps(&stdout(&output)), moves);
    }
}
