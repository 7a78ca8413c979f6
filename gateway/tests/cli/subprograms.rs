//! Subprograms in files of their own, beside the program's file.

use serde_json::Value;

use crate::{Folder, code, leadscrew, stderr, stdout};

const MAIN: &str =
    "O1\nG50 X80 Z20\nG99 M3 S800\nG0 X40 Z5\nM98 P30020\nG65 P21 A2.\nG0 X80 Z20\nM30\n";
const TURN: &str = "%\nO0020 (TURN)\nG0 U-2\nG1 W-10 F0.2\nG0 W10\nM99\n%\n";
const THREAD: &str =
    "(NO NUMBER OF ITS OWN)\nG0 X24 Z5\nG92 X20 Z-15 F#1\nX19.5\nG0 X40\nM98 P20\nM99\n";

fn json_lines(text: &str) -> Vec<Value> {
    let parse = |line: &str| serde_json::from_str(line).unwrap();
    text.lines().map(parse).collect()
}

/// A folder with the program and the files of its two subprograms.
fn parts(name: &str) -> (Folder, String) {
    let folder = Folder::new(name);
    std::fs::write(folder.file("O0020.nc"), TURN).unwrap();
    std::fs::write(folder.file("O0021.nc"), THREAD).unwrap();
    let program = folder.file("p.nc");
    std::fs::write(&program, MAIN).unwrap();
    (folder, program)
}

#[test]
fn a_subprogram_beside_the_program_makes_the_moves_of_one_in_the_file() {
    let (folder, program) = parts("beside");
    let whole = folder.file("whole.nc");
    let turn = TURN.trim_start_matches("%\n").trim_end_matches("%\n");
    std::fs::write(&whole, format!("{MAIN}{turn}O21\n{THREAD}")).unwrap();
    let moves = |program: &str| {
        let output = leadscrew(&["expand", program, "--format", "jsonl"]);
        assert_eq!(code(&output), 0, "{}", stderr(&output));
        json_lines(&stdout(&output))
    };
    let without_place = |mut step: Value| {
        let fields = step.as_object_mut().unwrap();
        fields.remove("line");
        fields.remove("file");
        step
    };
    let (split, together) = (moves(&program), moves(&whole));
    let places: Vec<_> = split
        .iter()
        .map(|step| {
            (
                step["file"].as_str().unwrap_or("-"),
                step["line"].as_u64().unwrap(),
            )
        })
        .collect();
    let turn = [("O0020.nc", 3), ("O0020.nc", 4), ("O0020.nc", 5)];
    assert_eq!(places[..4], [("-", 3), ("-", 4), turn[0], turn[1]]);
    assert_eq!(places[4..6], [turn[2], turn[0]]);
    assert_eq!(places[11], ("O0021.nc", 2));
    // The subprogram of the subprogram stands beside the program, too.
    assert_eq!(places[places.len() - 5..places.len() - 2], turn);
    assert_eq!(places[places.len() - 2..], [("-", 7), ("-", 8)]);
    let [split, together] =
        [split, together].map(|moves| moves.into_iter().map(without_place).collect::<Vec<_>>());
    assert_eq!(split, together);

    let hash = |command: &str, program: &str| {
        let output = leadscrew(&[command, program, "--json"]);
        assert_eq!(code(&output), 0, "{}", stderr(&output));
        let result: Value = serde_json::from_str(&stdout(&output)).unwrap();
        result["setpoint_hash"].as_str().unwrap().to_owned()
    };
    let expected = hash("run", &whole);
    for command in ["simulate", "run"] {
        assert_eq!(hash(command, &program), expected, "{command}");
    }
}

#[test]
fn every_command_says_which_file_a_line_is_of() {
    let (folder, program) = parts("whose-line");
    let output = leadscrew(&["check", &program, "--json"]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let result: Value = serde_json::from_str(&stdout(&output)).unwrap();
    let cycles = result["files"][0]["cycles"].as_array().unwrap();
    let places: Vec<_> = cycles
        .iter()
        .map(|c| (c["file"].as_str(), c["line"].as_u64()))
        .collect();
    assert_eq!(places, [3, 4].map(|line| (Some("O0021.nc"), Some(line))));
    let text = stdout(&leadscrew(&["check", &program]));
    assert!(text.contains("line O0021.nc:3: G92, 1 pass"), "{text}");

    let output = leadscrew(&["expand", &program, "--format", "csv"]);
    let text = stdout(&output);
    let row = text.lines().find(|row| row.starts_with("3,")).unwrap();
    assert!(row.starts_with("3,3,O0020.nc,,,"), "{row}");

    let csv = folder.file("t.csv");
    assert_eq!(code(&leadscrew(&["simulate", &program, "-o", &csv])), 0);
    let rows = std::fs::read_to_string(&csv).unwrap();
    let column = rows
        .lines()
        .next()
        .unwrap()
        .split(',')
        .position(|name| name == "line")
        .unwrap();
    let mut lines: Vec<&str> = rows
        .lines()
        .skip(1)
        .map(|row| row.split(',').nth(column).unwrap())
        .collect();
    lines.dedup();
    let cut = lines.iter().position(|line| *line == "O0020.nc:4").unwrap();
    assert_eq!(
        lines[cut - 1..cut + 2],
        ["O0020.nc:3", "O0020.nc:4", "O0020.nc:5"]
    );

    let output = leadscrew(&["run", &program, "--json"]);
    let result: Value = serde_json::from_str(&stdout(&output)).unwrap();
    let thread = &result["threads"][0];
    assert_eq!(
        (thread["line"].as_u64(), thread["file"].as_str()),
        (Some(3), Some("O0021.nc"))
    );
}

/// Controls write names in capitals to a card.
#[test]
fn the_name_of_such_a_file_may_be_in_capitals() {
    let (folder, program) = parts("capitals");
    std::fs::rename(folder.file("O0020.nc"), folder.file("O0020.NC")).unwrap();
    let output = leadscrew(&["check", &program]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    std::fs::write(folder.file("O0020.NC"), "O20\nG0 U-2\nY3\nM99\n").unwrap();
    let told = stderr(&leadscrew(&["check", &program]));
    assert!(told.contains("O0020.NC:3:1\n"), "{told}");
    // Where none is there, the usual name is told.
    std::fs::remove_file(folder.file("O0020.NC")).unwrap();
    let told = stderr(&leadscrew(&["check", &program]));
    assert!(told.contains("O0020.nc"), "{told}");
}

#[test]
fn a_mistake_in_such_a_file_is_told_with_its_file_line_and_column() {
    let (folder, program) = parts("mistake");
    let own = folder.file("O0020.nc");
    std::fs::write(&own, "O20\nG0 U-2\n  G1 W-10 F0.2 Y3\nM99\n").unwrap();
    for command in ["check", "simulate", "run"] {
        let output = leadscrew(&[command, &program, "--json"]);
        assert_eq!(code(&output), 1, "{command}");
        let result: Value = serde_json::from_str(&stdout(&output)).unwrap();
        let of = if command == "check" {
            &result["files"][0]
        } else {
            &result
        };
        let alarm = &of["alarms"][0];
        assert_eq!(alarm["file"], own.as_str(), "{command}");
        assert_eq!(
            (&alarm["line"], &alarm["column"]),
            (&3.into(), &16.into()),
            "{command}"
        );
        let told = stderr(&leadscrew(&[command, &program]));
        assert!(told.contains("O0020.nc:3:16\n"), "{told}");
        assert!(told.contains("3 |   G1 W-10 F0.2 Y3\n"), "{told}");
    }
    let output = leadscrew(&["expand", &program, "--format", "jsonl"]);
    let lines = json_lines(&stdout(&output));
    let alarm = &lines.last().unwrap()["alarm"];
    assert_eq!(
        (&alarm["file"], &alarm["line"]),
        (&own.as_str().into(), &3.into())
    );
    // What the machine finds has the same place: a thread that it cannot follow.
    std::fs::write(&own, "O20\nG0 X24 Z5\nG92 X20 Z-15 F40\nM99\n").unwrap();
    let output = leadscrew(&["check", &program]);
    assert!(
        stderr(&output).contains("O0020.nc:3:"),
        "{}",
        stderr(&output)
    );
}

#[test]
fn the_same_line_of_two_files_is_told_twice() {
    let (folder, program) = parts("twice");
    for file in ["O0020.nc", "O0021.nc"] {
        std::fs::write(
            folder.file(file),
            "G1 W-1 F0.2\nG41 G1 W-1\nG40 G1 W-1\nM99\n",
        )
        .unwrap();
    }
    let output = leadscrew(&["check", &program, "--json"]);
    let result: Value = serde_json::from_str(&stdout(&output)).unwrap();
    let warnings = result["files"][0]["warnings"].as_array().unwrap();
    let places: Vec<_> = warnings
        .iter()
        .map(|w| {
            (
                w["file"].as_str().unwrap().rsplit('/').next().unwrap(),
                w["line"].as_u64(),
            )
        })
        .collect();
    assert_eq!(
        places,
        [("O0020.nc", Some(2)), ("O0021.nc", Some(2))],
        "{warnings:?}"
    );
}

#[test]
fn a_subprogram_that_is_nowhere_is_an_alarm_that_names_both_places() {
    let (folder, program) = parts("nowhere");
    std::fs::remove_file(folder.file("O0020.nc")).unwrap();
    let message = |args: &[&str]| {
        let output = leadscrew(args);
        assert_eq!(code(&output), 1, "{}", stderr(&output));
        let result: Value = serde_json::from_str(&stdout(&output)).unwrap();
        let alarm = result["files"][0]["alarms"][0].clone();
        let place = (
            alarm["no"].as_u64(),
            alarm["line"].as_u64(),
            alarm["column"].as_u64(),
        );
        (place, alarm["message"].as_str().unwrap().to_owned())
    };
    let beside = folder.file("O0020.nc");
    let expected = format!("there is no program O20 in `{program}`, and no file `{beside}`");
    let found = message(&["check", &program, "--json"]);
    assert_eq!(found, ((Some(78), Some(5), Some(5)), expected));
    let expected = format!("`{program}` 中没有程序 O20，也没有文件 `{beside}`");
    assert_eq!(
        message(&["check", &program, "--json", "--lang", "zh"]).1,
        expected
    );

    // From a file of its own: that one, then the program's.
    std::fs::write(&program, "G65 P21 A2.\nM30\n").unwrap();
    std::fs::write(folder.file("O0021.nc"), "M98 P20\nM99\n").unwrap();
    let caller = folder.file("O0021.nc");
    let expected =
        format!("there is no program O20 in `{caller}` and `{program}`, and no file `{beside}`");
    let found = message(&["check", &program, "--json"]);
    assert_eq!(found, ((Some(78), Some(1), Some(5)), expected));

    // A number of more than four digits has no file.
    std::fs::write(&program, "M98 P12345 L1\nM30\n").unwrap();
    let found = message(&["check", &program, "--json"]);
    assert_eq!(found.0.0, Some(4853));
    assert_eq!(found.1, "there is no program O12345 in this file");
}

#[test]
fn a_program_in_the_file_comes_before_one_beside_it() {
    let (folder, program) = parts("before");
    let x = |text: &str| {
        std::fs::write(&program, text).unwrap();
        let output = leadscrew(&["expand", &program, "--format", "jsonl"]);
        assert_eq!(code(&output), 0, "{}", stderr(&output));
        let steps = json_lines(&stdout(&output));
        steps
            .iter()
            .filter_map(|step| step["x"].as_f64())
            .collect::<Vec<_>>()
    };
    let same = "O1\nM98 P20\nM30\nO20\nG0 X77\nM99\n";
    assert_eq!(x(same)[0], 77.0);
    // The file that calls has its own first, and the program's after it.
    std::fs::write(
        folder.file("O0021.nc"),
        "O21\nM98 P20\nM98 P30\nM99\nO20\nG0 X66\nM99\n",
    )
    .unwrap();
    assert_eq!(
        x("O1\nM98 P21\nM30\nO20\nG0 X77\nM99\nO30\nG0 X55\nM99\n")[..2],
        [66.0, 55.0]
    );
}

#[test]
fn jumps_loops_and_local_calls_stay_in_their_file() {
    let (folder, program) = parts("jumps");
    std::fs::write(&program, "O1\nG0 X1\nM98 P20\nN10 G0 X9\nM30\n").unwrap();
    let own = "#1=0\nN5 #1=#1+1\nG0 X[10+#1]\nIF[#1LT2]GOTO 5\nWHILE[#1LT4]DO1\n#1=#1+1\nG0 X[20+#1]\nEND1\n\
               M97 P50 L2\nGOTO 10\nG0 X99\nN10 G0 X30\nM99\nN50 G0 U1\nM99\n";
    std::fs::write(folder.file("O0020.nc"), own).unwrap();
    let output = leadscrew(&["expand", &program, "--format", "jsonl"]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let steps = json_lines(&stdout(&output));
    let x: Vec<_> = steps
        .iter()
        .filter(|s| s["kind"] == "rapid")
        .map(|s| s["x"].as_f64().unwrap())
        .collect();
    assert_eq!(x, [1.0, 11.0, 12.0, 23.0, 24.0, 25.0, 26.0, 30.0, 9.0]);
}

#[test]
fn what_a_file_of_a_subprogram_may_not_be_is_told() {
    let (folder, program) = parts("unfit");
    let own = folder.file("O0020.nc");
    let alarm = || {
        let output = leadscrew(&["check", &program, "--json"]);
        assert_eq!(code(&output), 1, "{}", stderr(&output));
        let result: Value = serde_json::from_str(&stdout(&output)).unwrap();
        let alarm = &result["files"][0]["alarms"][0];
        let file = alarm["file"]
            .as_str()
            .unwrap()
            .rsplit('/')
            .next()
            .unwrap()
            .to_owned();
        (
            alarm["no"].as_u64().unwrap(),
            file,
            alarm["line"].as_u64().unwrap(),
        )
    };
    std::fs::write(&own, "(x)\nO7\nG0 X1\nM99\n").unwrap();
    assert_eq!(alarm(), (4854, "O0020.nc".into(), 2));
    for open in ["", "O20\nG0 X1\n", "O20\nG0 X1\nO21\nM99\n"] {
        std::fs::write(&own, open).unwrap();
        assert_eq!(alarm().0, 4851, "{open:?}");
    }
    // Lines beyond those that have a number of their own.
    let text = |lines: usize| "\n".repeat(lines - 1) + "M99\n";
    std::fs::write(&own, text(199_999)).unwrap();
    assert_eq!(code(&leadscrew(&["check", &program])), 0);
    std::fs::write(&own, text(200_000)).unwrap();
    assert_eq!(alarm(), (4855, "O0020.nc".into(), 200_000));
    // Something that cannot be read.
    std::fs::remove_file(&own).unwrap();
    std::fs::create_dir(&own).unwrap();
    let output = leadscrew(&["check", &program]);
    assert_eq!(code(&output), 2);
    let expected =
        format!("error: cannot read `{program}`: its subprogram `{own}`: is a directory\n");
    assert_eq!(stderr(&output), expected);
}

#[test]
fn more_files_than_are_open_at_a_time_are_read_in_turn() {
    let folder = Folder::new("many");
    let program = folder.file("p.nc");
    let mut main = String::from("O1\n#100=0\nWHILE[#100LT3]DO1\n#100=#100+1\n");
    for number in 100..140 {
        main += &format!("M98 P{number}\n");
        let own = format!("\r\nO{number}\r\nG0 X{number}\r\nZ[{number}+#100]\r\nM99\r\n");
        std::fs::write(folder.file(&format!("O0{number}.nc")), own).unwrap();
    }
    std::fs::write(&program, main + "END1\nM30\n").unwrap();
    let output = leadscrew(&["expand", &program, "--format", "jsonl"]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let steps = json_lines(&stdout(&output));
    let x: Vec<_> = steps.iter().filter_map(|step| step["x"].as_f64()).collect();
    assert_eq!(steps.len(), 241);
    let expected = (0..3)
        .flat_map(|_| 100..140)
        .flat_map(|n| [f64::from(n); 2]);
    assert_eq!(x[..240], expected.collect::<Vec<_>>());
}

/// The moves of `expand`, as kind, file, X and Z.
fn steps(program: &str) -> Vec<(String, String, f64, f64)> {
    let output = leadscrew(&["expand", program, "--format", "jsonl"]);
    assert_eq!(code(&output), 0, "{}{}", stdout(&output), stderr(&output));
    let (mut x, mut z) = (0.0, 0.0);
    let mut found = Vec::new();
    for step in json_lines(&stdout(&output)) {
        x = step["x"].as_f64().unwrap_or(x);
        z = step["z"].as_f64().unwrap_or(z);
        let text = |key: &str| step[key].as_str().unwrap_or("-").to_owned();
        found.push((text("kind"), text("file"), x, z));
    }
    found
}

/// The moves whose lines are in this file.
fn steps_of(file: &str, program: &str) -> Vec<(String, f64, f64)> {
    let of_file = steps(program)
        .into_iter()
        .filter(|(_, own, ..)| own == file);
    of_file.map(|(kind, _, x, z)| (kind, x, z)).collect()
}

#[test]
fn a_file_of_a_subprogram_is_read_in_the_dialect_that_it_names() {
    let (folder, program) = parts("own-dialect");
    let own = folder.file("O0020.nc");
    let moves = |control: &str, main: &str, sub: &str| {
        let name = if control.is_empty() {
            String::new()
        } else {
            format!("(DIALECT {control})\n")
        };
        std::fs::write(&program, main).unwrap();
        std::fs::write(&own, name + sub).unwrap();
        steps_of("O0020.nc", &program)
    };
    let at = |kind: &str, x, z| (kind.to_owned(), x, z);
    let main =
        "O1\nG50 X80 Z20\nG99 M3 S800\nG0 X40 Z5\nM98 P20\nG90 X38 Z-4 F0.2\nG0 X80 Z20\nM30\n";
    // G77 of system B is G90 of system A, and G90 there is no cycle; after the call G90 is a cycle again.
    let turned = [
        at("rapid", 36.0, 5.0),
        at("feed", 36.0, -10.0),
        at("feed", 40.0, -10.0),
        at("rapid", 40.0, 5.0),
    ];
    let sub = "O20\nG90 G77 X36 Z-10 F0.2\nM99\n";
    assert_eq!(moves("FANUC-B", main, sub), turned);
    let after: Vec<_> = steps(&program)
        .into_iter()
        .skip(6)
        .map(|(kind, _, x, z)| (kind, x, z))
        .collect();
    assert_eq!(
        after[..4],
        [
            at("rapid", 38.0, 5.0),
            at("feed", 38.0, -4.0),
            at("feed", 40.0, -4.0),
            at("rapid", 40.0, 5.0),
        ]
    );
    // G91 of system B counts in the files of that system alone, and is still in force when the next one is read.
    let sub = "O20\nG91 G0 X-4 Z-1\nM98 P21\nZ-1\nM99\n";
    std::fs::write(
        folder.file("O0021.nc"),
        "(DIALECT GSK980TD)\nG0 X50 Z3\nM99\n",
    )
    .unwrap();
    let there = moves("FANUC-B", main, sub);
    assert_eq!(there, [at("rapid", 36.0, 4.0), at("rapid", 50.0, 2.0)]);
    // A taper is I in G90 of a Haas, whose main program has it so, and R in that of a GSK.
    let haas = main
        .replace("O1\n", "(DIALECT HAAS)\nO1\n")
        .replace("X38 Z-4", "X38 Z-4 I-1");
    let sub = "O20\nG90 X36 Z-10 R-2 F0.2\nM99\n";
    assert_eq!(
        moves("GSK980TD", &haas, sub),
        [
            at("rapid", 32.0, 5.0),
            at("feed", 36.0, -10.0),
            at("feed", 40.0, -10.0),
            at("rapid", 40.0, 5.0),
        ]
    );
    assert_eq!(steps(&program)[6].2, 36.0);
    // P of G75 is a diameter on the 980TD and a radius on the 988; a name that is the program's own changes nothing.
    let sub = "O20\nG0 X40 Z0\nG75 R0\nG75 X32 Z0 P20000 F0.1\nM99\n";
    let depths = |control: &str| -> Vec<f64> {
        let found = moves(
            control,
            main,
            &sub.replace(
                "P20000",
                if control.contains("988") {
                    "P2"
                } else {
                    "P20000"
                },
            ),
        );
        found
            .into_iter()
            .filter(|(kind, ..)| kind == "feed")
            .map(|(_, x, _)| x)
            .collect()
    };
    assert_eq!(depths(""), [38.0, 36.0, 34.0, 32.0]);
    assert_eq!(depths("gsk980td"), [38.0, 36.0, 34.0, 32.0]);
    assert_eq!(depths("gsk988"), [36.0, 32.0]);
}

#[test]
fn a_dialect_that_cannot_be_kept_to_is_an_alarm_in_its_file() {
    let (folder, program) = parts("dialect-refused");
    let own = folder.file("O0020.nc");
    let alarm = |sub: &str| {
        std::fs::write(&own, sub).unwrap();
        let output = leadscrew(&["check", &program, "--json"]);
        assert_eq!(code(&output), 1, "{}", stdout(&output));
        let result: Value = serde_json::from_str(&stdout(&output)).unwrap();
        let alarms = result["files"][0]["alarms"].as_array().unwrap().clone();
        let file = alarms[0]["file"].as_str().unwrap();
        assert_eq!((alarms.len(), file), (1, own.as_str()));
        let place = ["no", "line", "column"].map(|key| alarms[0][key].as_u64().unwrap());
        let text = ["message", "help"].map(|key| alarms[0][key].as_str().unwrap().to_owned());
        (place, text)
    };
    let (place, [message, help]) = alarm("O20\n (DIALECT FANUC)\nG0 X1\nM99\n");
    assert_eq!(place, [4086, 2, 11]);
    assert_eq!(message, "there is no dialect of this name");
    assert!(help.contains("fanuc-a, fanuc-b"), "{help}");
    // On a FANUC the limit holds under G97, too: the program that was started is one of a GSK.
    let (place, [message, help]) = alarm("(DIALECT FANUC-B)\nO20\nG92 S1000\nM99\n");
    assert_eq!(place, [4087, 3, 5]);
    assert_eq!(
        message,
        "G92 S in a file of another dialect: under G97 it limits the speed on FANUC and Haas, and not on GSK"
    );
    assert!(
        help.starts_with("set the highest speed in the program that was started"),
        "{help}"
    );
    // The words of a dialect are those of its file.
    let (place, _) = alarm("(DIALECT FANUC-B)\nO20\nG94 F100\nG32 Z-5 F1\nM99\n");
    assert_eq!(place, [4018, 4, 1]);
}

#[test]
fn a_file_of_a_subprogram_silences_its_own_lines_alone() {
    let (folder, program) = parts("own-allow");
    let pitch = "G0 X30 Z5\nG92 X29 Z-10 F0.04\nG0 X40\n";
    let warned = |main: &str, sub: &str| {
        std::fs::write(
            &program,
            format!("{main}G50 X80 Z20\nM3 S300\n{pitch}M98 P20\nM30\n"),
        )
        .unwrap();
        std::fs::write(folder.file("O0020.nc"), format!("{sub}{pitch}M99\n")).unwrap();
        let output = leadscrew(&["check", &program, "--json"]);
        let result: Value = serde_json::from_str(&stdout(&output)).unwrap();
        let mut told = Vec::new();
        for warning in result["files"][0]["warnings"].as_array().unwrap() {
            if warning["no"] == 4985 {
                let file = warning["file"].as_str().unwrap();
                told.push((
                    file.ends_with("O0020.nc"),
                    warning["line"].as_u64().unwrap(),
                ));
            }
        }
        told
    };
    assert_eq!(warned("", ""), [(false, 4), (true, 2)]);
    assert_eq!(warned("", "(ALLOW 4985)\n"), [(false, 4)]);
    assert_eq!(warned("(ALLOW 4985)\n", ""), []);
    assert_eq!(warned("", "(ALLOW 4984)\n"), [(false, 4), (true, 3)]);
}
