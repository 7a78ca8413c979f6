//! G32 and G34: strokes of a thread, with a run-out or with a lead that changes, as the commands show them.

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

/// The worked figures: 22 mm with a lead of 2 mm that grows by 0.1 mm a turn.
#[test]
fn a_lead_that_grows_is_told_with_its_turns_and_its_end() {
    let folder = Folder::new("variable");
    let program = folder.file("p.nc");
    std::fs::write(
        &program,
        "G97 M3 S300\nG0 X20. Z0\nG34 Z-22. F2. K0.1\nG0 X30.\nM5\nM30\n",
    )
    .unwrap();
    assert_eq!(
        strokes(&[&program]),
        [("finish".to_owned(), 20.0, -22.0, 0.0)]
    );
    let lines = stdout(&leadscrew(&["expand", &program, "--format", "jsonl"]));
    let line = lines.lines().find(|line| line.contains("G34")).unwrap();
    assert!(
        line.contains("\"lead\":2,\"lead_change\":0.1,\"start_deg\":0"),
        "{line}"
    );
    let output = leadscrew(&["check", &program, "--json"]);
    let result: Value = serde_json::from_slice(&output.stdout).unwrap();
    let cycle = &result["files"][0]["cycles"][0];
    assert_eq!(cycle["cycle"], "G34");
    assert_eq!(cycle["turns"], 8.982_753);
    assert_eq!(cycle["lead_end_mm"], 2.898_275);
    let told = stdout(&leadscrew(&["check", &program])) + &stderr(&leadscrew(&["check", &program]));
    assert!(
        told.contains("; 8.982753 turns, the lead at the end 2.898275 mm\n"),
        "{told}"
    );
}

/// The simulated machine, its spindle's true angle, and the law evaluated here.
#[test]
fn the_axis_follows_the_law_over_the_spindles_angle() {
    let folder = Folder::new("law");
    let program = folder.file("p.nc");
    let table = folder.file("p.csv");
    for (lead, change, end) in [(2.0, 0.1, -22.0), (6.0, -0.2, -60.0)] {
        let text = format!(
            "G97 M3 S300\nG0 X20. Z0\nG34 Z{end} F{lead} K{change} Q90000\nG0 X30.\nM5\nM30\n"
        );
        std::fs::write(&program, text).unwrap();
        let output = leadscrew(&[
            "simulate",
            &program,
            "--json",
            "-o",
            &table,
            "--spindle-ripple",
            "5@5",
        ]);
        assert_eq!(code(&output), 0, "{}", stderr(&output));
        let table = std::fs::read_to_string(&table).unwrap();
        let mut lines = table.lines();
        let header: Vec<&str> = lines.next().unwrap().split(',').collect();
        let column = |name: &str| header.iter().position(|column| *column == name).unwrap();
        let (z, angle, locked) = (column("z_nm"), column("s1_urev"), column("locked"));
        let (mut count, mut base) = (0, None);
        for line in lines {
            let fields: Vec<&str> = line.split(',').collect();
            let number = |column: usize| fields[column].parse::<f64>().unwrap();
            if fields[locked] != "1" {
                continue;
            }
            let (way, turned) = (-number(z) / 1e6, number(angle) / 1e6);
            // The stroke begins at a quarter of a turn: which one shows the first locked row.
            let t = (-lead + f64::sqrt(lead * lead + 2.0 * change * way)) / change;
            let base = *base.get_or_insert((turned - t - 0.25).round() + 0.25);
            let t = turned - base;
            let law = lead * t + change * t * t / 2.0;
            // A micrometre; the angle is written in millionths of a turn.
            assert!((way - law).abs() < 1e-3, "{line}: {law}");
            count += 1;
        }
        assert!(count > 1000, "{count}");
    }
}

#[test]
fn leads_that_cannot_be_are_refused_before_anything_moves() {
    let folder = Folder::new("bad-leads");
    let case = |block: &str, number: u64, column: u64, message: &str| {
        let found = found(&folder, block);
        assert_eq!(found, [(number, column, message.to_owned())], "{block}");
    };
    case(
        "G34 Z-15. F2. K-0.1",
        4115,
        15,
        "the lead 2 mm becomes shorter and is used up after 20 mm; the stroke is 20 mm long",
    );
    // At 300 rpm Z may have a lead of 26.7 mm in a feed; the stroke ends with 30.
    case(
        "G34 Z-95. F10. K4.",
        4251,
        11,
        "at 300 rpm the lead asks 9000 mm/min of Z; it may do 8000 mm/min",
    );
    case(
        "S1000 G34 Z-15. F1. K0.4",
        4274,
        21,
        "at 1000 rpm the change of the lead accelerates Z by 0.14 m/s² all the way; it may take 0.12 m/s²",
    );
    case(
        "G34 Z-15. F2.",
        4059,
        1,
        "G34 needs K, by how much the lead changes in each turn",
    );
    assert_eq!(found(&folder, "G34 Z-15. F2. K-0.05"), []);
}

#[test]
fn strokes_that_join_are_one_thread() {
    let folder = Folder::new("chain");
    let chain = "G32 Z-15. F2.\nX24. Z-25.\nX30. Z-27. F1.5";
    assert_eq!(found(&folder, chain), []);
    let program = folder.file("chain.nc");
    std::fs::write(
        &program,
        format!("M3 S300\nG0 X20. Z5.\n{chain}\nG0 X60.\nM30\n"),
    )
    .unwrap();
    let output = leadscrew(&["--json", "run", &program]);
    let result: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let threads = result["threads"].as_array().unwrap();
    assert_eq!(threads.len(), 1, "{result}");
    assert_eq!(threads[0]["line"], 3);
    assert!(
        threads[0]["sync_error_um"]["max"].as_f64().unwrap() <= 0.001,
        "{result}"
    );
    // A corner that takes more than the stroke has, at its word.
    assert_eq!(
        found(&folder, "S1500 G32 Z-15. F2.\nU1. W-.2\nX30. Z-27."),
        [(
            4265,
            1,
            "at 1500 rpm the stroke 0.5 mm of this chain is too short: the corner before it takes 1.952605 mm, and the corner after it 2.002247 mm".to_owned()
        )]
    );
    // What would stop the tool in the thread.
    assert_eq!(found(&folder, "G32 Z-15. F2.\nM8\nX24. Z-25.")[0].0, 4084);
}
