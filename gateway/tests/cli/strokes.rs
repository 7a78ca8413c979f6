//! G32: strokes of a thread with their run-out, as the commands show them.

use serde_json::Value;

use crate::{Folder, code, leadscrew, stderr, stdout};

/// Stage, X, Z and start angle of each move of a cycle.
fn strokes(args: &[&str]) -> Vec<(String, f64, f64, f64)> {
    let output = leadscrew(&[&["expand", "--format", "jsonl"], args].concat());
    assert_eq!(code(&output), 0, "{args:?}: {}", stderr(&output));
    let mut found = Vec::new();
    for line in stdout(&output).lines() {
        let step: Value = serde_json::from_str(line).unwrap();
        if let Some(stage) = step["stage"].as_str() {
            let number = |field: &str| step[field].as_f64().unwrap();
            found.push((
                stage.to_owned(),
                number("x"),
                number("z"),
                number("start_deg"),
            ));
        }
    }
    found
}

const RUN_OUTS: &str = "G97 M3 S300\nG0 X20. Z5.\nG32 Z-20. F2. J2. K3.\nG0 X30.\nZ5.\nG0 X40.\nG32 X20. F4. J2. K5. Q90000\nM5\nM30\n";

#[test]
fn a_run_out_leaves_the_line_and_the_next_block_begins_where_it_ends() {
    let folder = Folder::new("strokes");
    let program = folder.file("p.nc");
    std::fs::write(&program, RUN_OUTS).unwrap();
    let expected = [
        ("finish", 20.0, -17.0, 0.0),
        ("runout", 24.0, -20.0, 0.0),
        ("finish", 30.0, 5.0, 90.0),
        ("runout", 20.0, 7.0, 180.0),
    ]
    .map(|(stage, x, z, angle)| (stage.to_owned(), x, z, angle));
    for dialect in ["gsk980td", "gsk988"] {
        assert_eq!(strokes(&[&program, "--dialect", dialect]), expected);
    }
    // The machine goes where the moves say: the drives stand at the end of the last run-out.
    let table = folder.file("p.csv");
    let output = leadscrew(&["simulate", &program, "--json", "-o", &table]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let result: Value = serde_json::from_str(&stdout(&output)).unwrap();
    assert!(
        result["sync_error_um"]["max"].as_f64().unwrap() < 0.01,
        "{result}"
    );
    let table = std::fs::read_to_string(&table).unwrap();
    let header: Vec<&str> = table.lines().next().unwrap().split(',').collect();
    let last: Vec<&str> = table.lines().last().unwrap().split(',').collect();
    let value = |name: &str| -> f64 {
        let column = header.iter().position(|column| *column == name);
        last[column.unwrap_or_else(|| panic!("{name} in {header:?}"))]
            .parse()
            .unwrap()
    };
    assert_eq!((value("x_nm"), value("z_nm")), (10e6, 7e6));
}

#[test]
fn a_run_out_is_refused_by_name_where_the_control_has_none() {
    let folder = Folder::new("no-run-out");
    let program = folder.file("p.nc");
    for (dialect, code_name, word) in [
        ("fanuc-a", "G32", "J2."),
        ("fanuc-b", "G33", "K2."),
        ("fanuc-c", "G33", "J2."),
        ("haas", "G32", "K2."),
    ] {
        let text = format!(
            "G97 M3 S300\nG0 X20. Z5.\n{code_name} Z-20. F2.\nG0 X30.\nZ5.\n{code_name} Z-20. {word}\nM30\n"
        );
        std::fs::write(&program, text).unwrap();
        let output = leadscrew(&["check", &program, "--dialect", dialect]);
        let told = stderr(&output);
        let letter = &word[..1];
        let message = format!(
            "alarm[4058]: {letter} is no word of {code_name} on this control: a stroke ends where its block ends, without a run-out\n --> {program}:6:11\n"
        );
        assert_eq!(code(&output), 1, "{told}");
        assert!(told.contains(&message), "{dialect}: {told}");
        assert!(
            told.contains(&format!("help: leave {letter} out and lift the tool")),
            "{told}"
        );
    }
}

/// Numbers, columns and messages that `check` finds in a stroke.
fn found(folder: &Folder, block: &str) -> Vec<(u64, u64, String)> {
    let program = folder.file("p.nc");
    std::fs::write(
        &program,
        format!("G97 M3 S300\nG0 X20. Z5.\n{block}\nM30\n"),
    )
    .unwrap();
    let output = leadscrew(&["check", &program, "--json"]);
    let result: Value = serde_json::from_slice(&output.stdout).unwrap();
    let mut found = Vec::new();
    for list in ["alarms", "warnings"] {
        for one in result["files"][0][list].as_array().unwrap() {
            found.push((
                one["no"].as_u64().unwrap(),
                one["column"].as_u64().unwrap(),
                one["message"].as_str().unwrap().to_owned(),
            ));
        }
    }
    found
}

#[test]
fn run_outs_that_cannot_be_are_refused_before_anything_moves() {
    let folder = Folder::new("bad-run-outs");
    let case = |block: &str, number: u64, column: u64, message: &str| {
        let found = found(&folder, block);
        assert_eq!(found, [(number, column, message.to_owned())], "{block}");
    };
    case(
        "G32 Z-20. F2. J2. K25.",
        4104,
        19,
        "pass 1 has no room to cut: stroke 25 mm, run-in 0 mm, run-out 25 mm",
    );
    case(
        "G32 U10. W-25. F2. J1. K5.",
        4106,
        20,
        "the run-out retracts 1 mm over 5 mm, but the taper rises 1 mm there: it would cut into the thread",
    );
    // 8 m/min are what X may do.
    case(
        "S3000 G32 Z-20. F2. J9. K4.",
        4252,
        21,
        "at 3000 rpm the run-out asks 13500 mm/min of X; it may do 8000 mm/min",
    );
    case(
        "G92 X19. Z-20. F2. J1.\nG0 X20. Z5.\nG32 Z-20.",
        4057,
        1,
        "the run-out J 1 mm of an earlier G78 or G92 is in force, and says not to which side this stroke leaves the thread",
    );
    assert_eq!(found(&folder, "G32 Z-20. F2. J-3. K4."), []);
}
