//! The variables #500 to #999, from one run to the next.

use std::path::Path;

use serde_json::Value;

use crate::{Command, Folder, Output, code, leadscrew, root, stderr, stdout};

const COUNTS: &str =
    "O1\n#500=#500+1\n#999=0.1+0.2\nG65 H01 P#501 Q1500\n#100=7\nG0 X[#500*10]\nM30\n";

fn program(folder: &Folder, text: &str) -> String {
    let program = folder.file("p.nc");
    std::fs::write(&program, text).unwrap();
    program
}

/// X of the first move that `expand` prints.
fn first_x(args: &[&str]) -> f64 {
    let output = leadscrew(&[&["expand", "--format", "jsonl"], args].concat());
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let step: Value = serde_json::from_str(stdout(&output).lines().next().unwrap()).unwrap();
    step["x"].as_f64().unwrap()
}

#[test]
fn a_run_keeps_them_beside_the_machine_file_and_nothing_else_does() {
    let folder = Folder::new("keeps");
    let program = program(&folder, COUNTS);
    let kept = folder.file("leadscrew.variables");
    let picture = folder.file("p.svg");
    let others: [&[&str]; 4] = [
        &["check", &program],
        &["expand", &program],
        &["simulate", &program],
        &["plot", &program, "-o", &picture],
    ];
    let nothing_writes = || {
        let before = std::fs::read(&kept).ok();
        for args in others {
            let output = leadscrew(args);
            assert_eq!(code(&output), 0, "{args:?}: {}", stderr(&output));
            assert_eq!(std::fs::read(&kept).ok(), before, "{args:?}");
        }
    };
    nothing_writes();
    let heading = "(variables #500 to #999: written at the end of each run)\n";
    for pass in 1..=3 {
        assert_eq!(first_x(&[&program]), f64::from(pass) * 10.0);
        let output = leadscrew(&["run", &program]);
        assert_eq!(code(&output), 0, "{}", stderr(&output));
        let told = format!("\nvariables {kept}\n");
        assert!(stdout(&output).contains(&told), "{}", stdout(&output));
        let expected = format!(
            "{heading}#500 = {pass}.0\n#501 = 1500.0 increments\n#999 = 0.30000000000000004\n"
        );
        assert_eq!(std::fs::read_to_string(&kept).unwrap(), expected);
        nothing_writes();
    }
    // A variable without a value is not there any more.
    std::fs::write(&program, "#500=#0\n#999=#0\n#501=#0\nM30\n").unwrap();
    assert_eq!(code(&leadscrew(&["run", &program])), 0);
    assert_eq!(std::fs::read_to_string(&kept).unwrap(), heading);
    // What is as it was is not written.
    std::fs::write(&kept, "#510 = 5\n").unwrap();
    std::fs::write(&program, "#510=5\nM30\n").unwrap();
    let output = leadscrew(&["run", &program]);
    assert!(
        !stdout(&output).contains("variables"),
        "{}",
        stdout(&output)
    );
    assert_eq!(std::fs::read_to_string(&kept).unwrap(), "#510 = 5\n");
    // Nothing is left beside the file.
    let files: Vec<_> = std::fs::read_dir(&folder.0)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .filter(|name| name.contains("variables"))
        .collect();
    assert_eq!(files, ["leadscrew.variables"]);
}

#[test]
fn a_run_that_does_not_come_to_its_end_keeps_what_was_there() {
    let folder = Folder::new("stopped");
    let text = "O1\n#500=1\nG0 X10\n#500=2\nG50 X80 Z20\nG0 X40\n#3000=1(STOP)\nM30\n";
    let program = program(&folder, text);
    let kept = folder.file("leadscrew.variables");
    std::fs::write(&kept, "#500 = 7.0\n").unwrap();
    assert_eq!(code(&leadscrew(&["run", &program])), 1);
    // The power goes in the middle of it.
    std::fs::write(&program, "#500=1\nG0 X10\nG4 X5\nM30\n").unwrap();
    let state = folder.file("b.flash");
    let output = leadscrew(&["run", &program, "--state", &state, "--cut-power", "2000"]);
    assert_eq!(code(&output), 4, "{}", stderr(&output));
    assert_eq!(std::fs::read_to_string(&kept).unwrap(), "#500 = 7.0\n");
}

/// The command in an environment of its own.
fn with_folders(args: &[&str], state: Option<&Path>, home: Option<&Path>) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_leadscrew"));
    command.args(args).current_dir(root()).env("NO_COLOR", "1");
    for (name, folder) in [("XDG_STATE_HOME", state), ("HOME", home)] {
        match folder {
            Some(folder) => command.env(name, folder),
            None => command.env_remove(name),
        };
    }
    command.output().unwrap()
}

#[test]
fn an_option_names_the_file_and_without_a_machine_file_it_is_the_users() {
    let folder = Folder::new("where");
    std::fs::remove_file(folder.file("leadscrew.toml")).unwrap();
    let program = program(&folder, "O1\n#500=#500+1\nG0 X[#500*10]\nM30\n");
    let (state, home) = (folder.0.join("state"), folder.0.join("home"));
    let run = |state, home| {
        let output = with_folders(&["run", &program], state, home);
        assert_eq!(code(&output), 0, "{}", stderr(&output));
        stderr(&output)
    };
    let read = |path: &Path| std::fs::read_to_string(path.join("leadscrew/leadscrew.variables"));
    run(Some(&state), Some(&home));
    assert!(read(&state).unwrap().ends_with("#500 = 1.0\n"));
    assert!(!home.exists());
    run(None, Some(&home));
    run(Some(Path::new("relative")), Some(&home));
    assert!(
        read(&home.join(".local/state"))
            .unwrap()
            .ends_with("#500 = 2.0\n")
    );
    let told = run(None, None);
    assert!(
        told.contains("there is no folder to keep them in"),
        "{told}"
    );

    let own = folder.file("own");
    for pass in ["1.0", "2.0"] {
        assert_eq!(code(&leadscrew(&["run", &program, "--variables", &own])), 0);
        let text = std::fs::read_to_string(&own).unwrap();
        assert!(text.ends_with(&format!("#500 = {pass}\n")), "{text}");
    }
    assert_eq!(first_x(&[&program, "--variables", &own]), 30.0);
    // A folder that is not there is made; one that cannot be is told, with the machine at rest.
    let wrong = folder.file("own/below");
    let output = leadscrew(&["run", &program, "--variables", &wrong]);
    assert_eq!(code(&output), 2);
    assert!(
        stderr(&output).contains(&format!("`{wrong}`")),
        "{}",
        stderr(&output)
    );
}

#[test]
fn a_line_that_is_no_value_is_an_alarm_of_every_command() {
    let folder = Folder::new("spoilt");
    let program = program(&folder, COUNTS);
    let kept = folder.file("leadscrew.variables");
    std::fs::write(&kept, "(kept)\n#500 = 1\n#501 = 1,5\n#500 = 2\n").unwrap();
    for command in ["check", "simulate", "run"] {
        let output = leadscrew(&[command, &program, "--json"]);
        assert_eq!(code(&output), 1, "{command}");
        let result: Value = serde_json::from_str(&stdout(&output)).unwrap();
        let alarms = result["alarms"].as_array().unwrap();
        let found: Vec<_> = alarms
            .iter()
            .map(|a| (a["no"].as_u64(), a["file"].as_str(), a["line"].as_u64()))
            .collect();
        let expected =
            [(4856, 3), (4857, 4)].map(|(no, line)| (Some(no), Some(&*kept), Some(line)));
        assert_eq!(found, expected, "{command}");
    }
    let output = leadscrew(&["expand", &program]);
    assert_eq!((code(&output), &*stdout(&output)), (1, ""));
    assert!(
        stderr(&output).contains("leadscrew.variables:3:1\n"),
        "{}",
        stderr(&output)
    );
    // The file stays as it is, for its owner to mend.
    assert!(std::fs::read_to_string(&kept).unwrap().contains("1,5"));
    std::fs::write(&kept, " ".repeat(70_000)).unwrap();
    let output = leadscrew(&["check", &program]);
    assert_eq!(code(&output), 2);
    assert!(
        stderr(&output).contains("longer than the 65536 bytes"),
        "{}",
        stderr(&output)
    );
}

#[test]
fn numbers_without_a_meaning_are_no_variables() {
    let folder = Folder::new("numbers");
    for number in ["34", "99", "232", "499", "1136", "2033", "3005", "9999"] {
        for text in [
            format!("#{number}=1"),
            format!("#1=#{number}"),
            format!("G0 X#{number}"),
        ] {
            let program = program(&folder, &format!("{text}\nM30\n"));
            let output = leadscrew(&["check", &program, "--json"]);
            let result: Value = serde_json::from_str(&stdout(&output)).unwrap();
            let alarm = &result["files"][0]["alarms"][0];
            assert_eq!(alarm["no"], 115, "{text}");
        }
    }
}
