//! `simulate`, `plot` and `run`: setpoints, certificates, pictures, interruption.

use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;

use crate::{Folder, code, golden, leadscrew, root, stderr, stdout};

const THREAD: &str = "examples/o0013-g76-m68x6.nc";

fn result(args: &[&str]) -> Value {
    let output = leadscrew(args);
    serde_json::from_str(&stdout(&output))
        .unwrap_or_else(|error| panic!("{args:?}: {error}: {}", stderr(&output)))
}

#[test]
fn setpoints_as_csv_begin_and_end_standing() {
    let folder = Folder::new("csv");
    let csv = folder.file("setpoints.csv");
    let output = leadscrew(&["simulate", THREAD, "-o", &csv]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    assert!(output.stdout.is_empty());
    assert!(
        stderr(&output).contains("synchronism worst"),
        "{}",
        stderr(&output)
    );
    let text = std::fs::read_to_string(csv).unwrap();
    let mut lines = text.lines();
    assert_eq!(
        lines.next(),
        Some("tick,t_us,x_nm,z_nm,c_udeg,s1_urev,s1_set_urev,line,move,state,locked")
    );
    assert_eq!(lines.next(), Some("0,0,0,0,0,0,,0,0,idle,0"));
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    for (n, row) in rows.iter().enumerate() {
        assert_eq!(row.len(), 11);
        assert_eq!(row[0], (n + 1).to_string());
        assert_eq!(row[1], ((n + 1) * 1000).to_string());
        assert!(
            ["idle", "run", "hold", "dwell", "wait", "alarm"].contains(&row[9]),
            "{row:?}"
        );
    }
    // G50 X100 Z50 at power-up: back there at the end is back at the machine's zero.
    let last = rows.last().unwrap();
    assert_eq!((last[2], last[3], last[10]), ("0", "0", "0"));
    assert!(rows.iter().any(|row| row[9] == "dwell" && row[7] == "3"));
    assert!(rows.iter().any(|row| row[9] == "wait" && row[7] == "6"));
    // Six passes, each locked once without a gap.
    let starts = rows
        .windows(2)
        .filter(|pair| pair[0][10] == "0" && pair[1][10] == "1")
        .count();
    assert_eq!(starts, 6);
}

#[test]
fn locked_rows_lie_on_one_helix() {
    let folder = Folder::new("helix");
    let csv = folder.file("setpoints.csv");
    let output = leadscrew(&["simulate", THREAD, "-o", &csv, "--spindle-ripple", "5@2"]);
    assert_eq!(code(&output), 0);
    let text = std::fs::read_to_string(csv).unwrap();
    let mut by_move: std::collections::BTreeMap<u32, Vec<f64>> = std::collections::BTreeMap::new();
    for line in text.lines().skip(1) {
        let row: Vec<&str> = line.split(',').collect();
        if row[10] == "1" {
            let z: f64 = row[3].parse().unwrap();
            let turns = row[5].parse::<f64>().unwrap() / 1e6;
            // Lead 6 mm towards −Z: what is left after taking the helix out, in nanometres.
            let pass = row[8].parse().unwrap();
            by_move.entry(pass).or_default().push(z + 6e6 * turns);
        }
    }
    assert!(by_move.len() >= 6);
    for (pass, residue) in by_move {
        let (low, high) = residue
            .iter()
            .fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(*v), h.max(*v)));
        // The angle is printed to a millionth of a turn: 6 nm; the error allowed is 1 µm.
        assert!(high - low < 2000.0, "move {pass}: {low}…{high}");
    }
}

#[test]
fn simulate_and_run_give_the_same_setpoints_every_time() {
    for flags in [
        &[][..],
        &["--spindle-ripple", "10@5"],
        &["--tick-us", "2000"],
        &["--at", "X=20,Z=-5"],
    ] {
        let json = |command: &str| {
            let mut args = vec![command, THREAD, "--json"];
            args.extend_from_slice(flags);
            result(&args)
        };
        let first = json("simulate");
        assert_eq!(first["ok"], true, "{flags:?}: {first}");
        assert_eq!(first, json("simulate"), "{flags:?}");
        assert_eq!(first, json("run"), "{flags:?}");
        assert_eq!(first["setpoint_hash"].as_str().unwrap().len(), 16);
        assert_eq!(
            (first["moves"].as_u64(), first["late"].as_u64()),
            (Some(35), Some(0))
        );
    }
    let plain = result(&["run", THREAD, "--json"]);
    let rippled = result(&["run", THREAD, "--json", "--spindle-ripple", "10@5"]);
    assert_ne!(plain["setpoint_hash"], rippled["setpoint_hash"]);
}

#[test]
fn every_row_is_there_whatever_the_latency() {
    let folder = Folder::new("latency");
    let csv = folder.file("setpoints.csv");
    let rows = |latency: &str| {
        let set = [format!("9003.X={latency}"), format!("9003.Z={latency}")];
        let mut args = vec!["simulate", THREAD, "-o", &csv, "--json"];
        // A drive that is late is that far behind: leave it the room.
        for value in [&set[0], &set[1], "1828.X=100", "1828.Z=100"] {
            args.extend(["--set", value]);
        }
        let summary = result(&args);
        let text = std::fs::read_to_string(&csv).unwrap();
        assert_eq!(
            summary["ticks"].as_u64(),
            Some(text.lines().count() as u64 - 2),
            "{latency}"
        );
        assert!(
            summary["sync_error_um"]["max"].as_f64().unwrap() < 1.0,
            "{latency}: {summary}"
        );
        let last = text.lines().last().unwrap().to_owned();
        assert!(last.split(',').nth(9) == Some("idle"), "{last}");
    };
    for latency in ["0", "400", "1000", "5500", "20000"] {
        rows(latency);
    }
}

#[test]
fn a_machine_that_stops_on_an_alarm_is_exit_4() {
    // Drives 6 ms late at 16 m/min are 1.6 mm behind; 1 mm is allowed.
    let late = ["--set", "9003.X=6000", "--set", "9003.Z=6000"];
    let output = leadscrew(&[&["run", THREAD][..], &late].concat());
    assert_eq!(code(&output), 4);
    assert!(
        stderr(&output).contains("alarm[4361]: following error of drive Z"),
        "{}",
        stderr(&output)
    );
    // What was set wrong here is among the causes, in both languages.
    let zh = leadscrew(&[&["run", THREAD, "--lang", "zh"][..], &late].concat());
    for told in [stderr(&output), stderr(&zh)] {
        assert!(told.contains("4361") && told.contains("9003"), "{told}");
    }
    // The line that was being carried out.
    assert!(
        stderr(&output).contains(&format!("{THREAD}:4:1")),
        "{}",
        stderr(&output)
    );
    assert!(
        stdout(&output).starts_with(&format!("{THREAD}: stopped: ")),
        "{}",
        stdout(&output)
    );
    let json = result(&[&["simulate", THREAD, "--json"][..], &late].concat());
    assert_eq!(
        (json["ok"].as_bool(), json["alarms"][0]["line"].as_u64()),
        (Some(false), Some(4))
    );
}

#[test]
fn the_hash_can_be_made_from_the_csv() {
    let folder = Folder::new("hash");
    let csv = folder.file("setpoints.csv");
    let program = folder.file("short.nc");
    std::fs::write(&program, "G0 X3 Z2\nG4 P20\nG1 X2 F300\nM30\n").unwrap();
    let summary = result(&["simulate", &program, "-o", &csv, "--json"]);
    let text = std::fs::read_to_string(csv).unwrap();
    let rows: Vec<Vec<&str>> = text
        .lines()
        .skip(1)
        .map(|line| line.split(',').collect())
        .collect();
    let runs = |row: &&Vec<&str>| row[9] == "run";
    let first = rows.iter().position(|row| runs(&row)).unwrap();
    let last = rows.iter().rposition(|row| runs(&row)).unwrap();
    let crc = crc::Crc::<u64>::new(&crc::CRC_64_XZ);
    let mut digest = crc.digest();
    for row in &rows[first..=last] {
        for field in [row[2], row[3], row[4], "0", "0", "0", "0"] {
            digest.update(&field.parse::<i64>().unwrap().to_le_bytes());
        }
    }
    assert_eq!(
        summary["setpoint_hash"],
        format!("{:016x}", digest.finalize())
    );
}

#[test]
fn tolerance_is_a_verdict() {
    let flags = [
        "simulate",
        THREAD,
        "--spindle-ripple",
        "10@5",
        "--tolerance",
    ];
    let with = |tolerance: &str| leadscrew(&[&flags[..], &[tolerance]].concat());
    assert_eq!(code(&with("1.3")), 0);
    let refused = with("0.01");
    assert_eq!(code(&refused), 1);
    assert!(
        stderr(&refused).contains("above the tolerance of 0.01 µm: line 6"),
        "{}",
        stderr(&refused)
    );
}

/// The simulation knows where the spindle truly is, the board where it measures it:
/// both are told, each by its name, and the tolerance judges the worse.
#[test]
fn the_true_error_and_the_measured_one_are_told_apart() {
    let worst = |told: &Value, field: &str| told[field]["max"].as_f64().unwrap();
    for (args, truly_worse) in [
        // A virtual gear: no error at all, but for what the board cannot measure.
        (&["examples/g84-tap.nc"][..], false),
        (&[THREAD, "--spindle-ripple", "10@5"][..], true),
    ] {
        let told = result(&[&["simulate", "--json"], args].concat());
        let (truly, measured) = (
            worst(&told, "sync_error_um"),
            worst(&told, "measured_error_um"),
        );
        assert!(truly != measured, "{told}");
        assert_eq!(truly > measured, truly_worse, "{told}");
        let threads = told["threads"].as_array().unwrap();
        let of_threads = threads.iter().map(|thread| worst(thread, "sync_error_um"));
        assert_eq!(of_threads.fold(0.0, f64::max), measured);
        let ran = result(&[&["run", "--json"], args].concat());
        for field in ["sync_error_um", "measured_error_um", "threads"] {
            assert_eq!(ran[field], told[field]);
        }
        let line = threads[0]["line"].as_u64().unwrap();
        for command in ["simulate", "run"] {
            let with = |tolerance: f64| {
                let tolerance = format!("{tolerance:.3}");
                leadscrew(&[&[command, "--tolerance", &tolerance], args].concat())
            };
            assert_eq!(code(&with(truly.max(measured))), 0);
            let between = f64::midpoint(truly, measured);
            let refused = with(between);
            assert_eq!(code(&refused), 1, "{command} {between}");
            let words = stderr(&refused);
            assert!(words.contains(&format!(" µm: line {line}")), "{words}");
        }
        let words = stderr(&leadscrew(&[&["simulate"], args].concat()));
        assert!(
            words.contains("locked ticks, by the spindle's true angle\nmeasured    worst "),
            "{words}"
        );
        let words = stdout(&leadscrew(&[&["run"], args].concat()));
        let line = words.lines().next().unwrap();
        assert!(
            line.contains(&format!(", as measured {measured} µm (")),
            "{words}"
        );
    }
    let nothing = result(&["simulate", "examples/o0008-g75-grooves.nc", "--json"]);
    assert!(nothing["measured_error_um"]["max"].is_null(), "{nothing}");
}

/// Nobody tells of a thread any more in which the power goes: the result says that it was cut short.
#[test]
fn a_thread_in_which_the_power_goes_is_cut_short() {
    let folder = Folder::new("no-power");
    let csv = folder.file("rows.csv");
    assert_eq!(code(&leadscrew(&["simulate", THREAD, "-o", &csv])), 0);
    let rows = std::fs::read_to_string(&csv).unwrap();
    let locked = rows
        .lines()
        .position(|row| row.ends_with(",run,1"))
        .unwrap();
    let (tick, state) = ((locked + 200).to_string(), folder.file("flash.bin"));
    let output = leadscrew(&[
        "run",
        THREAD,
        "--json",
        "--cut-power",
        &tick,
        "--state",
        &state,
    ]);
    assert_eq!(code(&output), 4);
    let told: Value = serde_json::from_str(&stdout(&output)).unwrap();
    assert_eq!(told["threads"][0]["state"], "cut_short", "{told}");
    assert_eq!(told["threads"][0]["passes"], 1);
}

#[test]
fn a_result_says_which_program_it_is_of_and_which_parameters() {
    let told = result(&["simulate", THREAD, "--json"]);
    assert_eq!(told["program"], THREAD);
    assert_eq!(told["gateway"], env!("CARGO_PKG_VERSION"));
    assert!(
        told["board"].is_null() && told["started"].is_null(),
        "{told}"
    );
    let parameters = told["parameters"].as_str().unwrap();
    assert_eq!(parameters.len(), 8);
    assert_eq!(result(&["run", THREAD, "--json"])["parameters"], parameters);
    assert_ne!(
        result(&["simulate", THREAD, "--json", "--set", "9007=12"])["parameters"],
        parameters
    );
}

/// Of three threads the one in the middle is cut faster than the spindle's ripple allows for.
#[test]
fn each_thread_is_judged_by_itself() {
    let folder = Folder::new("threads");
    let program = folder.file("three.nc");
    let text = "G98\nG0 X0 Z5\nM29 S200\nG84 Z-8 R-3 F250\nG80\nG0 X80 Z10\nM3 S300\n\
                G76 P010560 Q1500 R0.1\nG76 X76 Z-30 P20000 Q15000 F3\nG0 X0 Z5\nM3 S100\nG84 Z-8 R-3 F100\nG80\nM30\n";
    std::fs::write(&program, text).unwrap();
    let told = result(&["run", &program, "--json", "--spindle-ripple", "10@5"]);
    let threads = told["threads"].as_array().unwrap();
    let of = |name: &str| -> Vec<serde_json::Value> {
        threads.iter().map(|thread| thread[name].clone()).collect()
    };
    assert_eq!(of("n"), [1, 2, 3]);
    assert_eq!(of("line"), [4, 9, 12]);
    assert_eq!(of("kind"), ["rigid_tap", "thread", "tap"]);
    assert_eq!(of("state"), ["finished"; 3]);
    assert_eq!(of("passes"), [1, 3, 1]);
    assert_eq!(told["threads_missing"], 0);
    let worst = |place: usize| threads[place]["sync_error_um"]["max"].as_f64().unwrap();
    assert!(worst(1) > 0.01, "{told}");
    let simulated = result(&["simulate", &program, "--json", "--spindle-ripple", "10@5"]);
    assert_eq!(simulated["threads"], told["threads"]);
    let ran = leadscrew(&["run", &program, "--spindle-ripple", "10@5"]);
    let lines: Vec<String> = stdout(&ran).lines().map(str::to_owned).collect();
    assert_eq!(lines.len(), 8, "{lines:?}");
    assert!(
        lines[4].starts_with("1: line 4: rigid tap: worst "),
        "{lines:?}"
    );
    assert!(
        lines[5].starts_with("2: line 9: thread, 3 passes: worst "),
        "{lines:?}"
    );
    assert!(lines[6].starts_with("   cut: grooves "), "{lines:?}");
    assert!(
        lines[7].starts_with("3: line 12: ordinary tap: worst "),
        "{lines:?}"
    );
}

#[test]
fn a_program_with_an_alarm_does_not_move() {
    for command in ["simulate", "run"] {
        let output = leadscrew(&[command, "examples/g78-as-printed.nc", "--json"]);
        assert_eq!(code(&output), 1, "{command}");
        let result: Value = serde_json::from_str(&stdout(&output)).unwrap();
        assert_eq!(result["ok"], false);
        assert_eq!(result["ticks"], 0);
        assert_eq!(result["alarms"].as_array().unwrap().len(), 2);
    }
    let folder = Folder::new("refused");
    let picture = folder.file("x.svg");
    assert_eq!(
        code(&leadscrew(&[
            "plot",
            "examples/g78-as-printed.nc",
            "-o",
            &picture
        ])),
        1
    );
    assert!(!std::path::Path::new(&picture).exists());
}

#[test]
fn run_tells_its_result_on_stdout() {
    let output = leadscrew(&["run", THREAD]);
    assert_eq!(code(&output), 0);
    let text = stdout(&output);
    assert!(
        text.starts_with(&format!("{THREAD}: done: 35 moves")),
        "{text}"
    );
    assert!(text.contains("worst synchronism error"), "{text}");
}

#[test]
fn the_bus_can_be_recorded() {
    let folder = Folder::new("record");
    let log = folder.file("bus.log");
    assert_eq!(code(&leadscrew(&["run", THREAD, "--record", &log])), 0);
    let text = std::fs::read_to_string(log).unwrap();
    // SYNC with its counter, then the X drive's target.
    let syncs = text.lines().filter(|line| line.contains(" 080#")).count();
    let targets = text.lines().filter(|line| line.contains(" 210#")).count();
    assert!(
        syncs > 20_000 && syncs.abs_diff(targets) <= 2,
        "{syncs} {targets}"
    );
}

#[test]
fn pictures_show_every_kind_of_move() {
    let folder = Folder::new("plot");
    let picture = folder.file("shaft.svg");
    let output = leadscrew(&["plot", "examples/shaft.nc", "-o", &picture]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let svg = std::fs::read_to_string(picture).unwrap();
    for part in [
        "line rapid",
        "line feed",
        "line thread",
        "line x",
        "line z",
        "line rpm",
        "line error",
        "class=\"start\"",
        "class=\"end\"",
        "shaft.nc",
        "X ⌀ mm",
        "Z mm",
        "centre",
    ] {
        assert!(svg.contains(part), "{part}");
    }
    assert!(!svg.contains("NaN"));
    assert!(svg.len() < 200_000, "{}", svg.len());
}

/// The page has the strokes of the picture, the program, and the way of the tool, each line in its place.
#[test]
fn a_page_has_path_program_and_way() {
    let folder = Folder::new("page");
    let file = folder.file("shaft.html");
    for (args, runs) in [(&["--lang", "en"][..], true), (&["--path"], false)] {
        let program = "examples/shaft.nc";
        let output = leadscrew(&[&["plot", program, "-o", &file], args].concat());
        assert_eq!(code(&output), 0, "{}", stderr(&output));
        let page = std::fs::read_to_string(&file).unwrap();
        let (_, data) = page.split_once("id=\"data\">").unwrap();
        let (data, _) = data.split_once("</script>").unwrap();
        let data: Value = serde_json::from_str(data).unwrap();
        let text = std::fs::read_to_string(root().join(program)).unwrap();
        let lines: Vec<_> = text.lines().map(str::trim_end).collect();
        assert_eq!(data["program"], serde_json::json!(lines));
        let strokes = data["strokes"].as_array().unwrap();
        let moves = leadscrew(&["expand", program, "--format", "jsonl"]);
        let moves: Vec<Value> = stdout(&moves)
            .lines()
            .map(|line| serde_json::from_str(line).unwrap())
            .filter(|step: &Value| {
                ["rapid", "feed", "arc", "thread", "tap"].contains(&step["kind"].as_str().unwrap())
            })
            .collect();
        assert_eq!(strokes.len(), moves.len());
        for (stroke, step) in strokes.iter().zip(&moves) {
            assert_eq!(stroke["l"], step["line"]);
            let points = stroke["p"].as_array().unwrap();
            let [.., z, x] = &points[..] else { panic!() };
            let [x, z, to_x, to_z] = [x, z, &step["x"], &step["z"]].map(|v| v.as_f64().unwrap());
            assert!(
                (2.0 * x - to_x).abs() < 2e-4 && (z - to_z).abs() < 1e-4,
                "{step}"
            );
        }
        assert_eq!(data["run"].is_object(), runs);
        assert_eq!(page.contains("<figure>"), runs);
        if runs {
            let way = ["l", "x", "z"].map(|key| data["run"][key].as_array().unwrap().len());
            assert!(way[0] > 1_000 && way == [way[0]; 3], "{way:?}");
        }
    }
}

#[test]
fn a_picture_of_the_path_alone_runs_nothing_and_shows_the_part() {
    let folder = Folder::new("path");
    let picture = folder.file("bush.svg");
    let args = ["plot", "examples/shop/bush.nc", "--path", "-o", &picture];
    let output = leadscrew(&args);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let svg = std::fs::read_to_string(&picture).unwrap();
    assert!(svg.contains("70 moves · path 1246.474 mm"), "{svg}");
    assert!(svg.contains("line feed") && svg.contains("line rapid"));
    assert!(!svg.contains("line rpm") && !svg.contains("class=\"start\""));
    let output = leadscrew(&[&args[..], &["--json"]].concat());
    let result: Value = serde_json::from_str(&stdout(&output)).unwrap();
    assert_eq!(result["ok"], true);
    assert_eq!(result["moves"], 70);
    assert_eq!(result["path_mm"], 1246.473508);
    // What drives a machine has no sense where none runs.
    let output = leadscrew(&[&args[..], &["--tick-us", "500"]].concat());
    assert_eq!(code(&output), 2);
    // A program with an alarm has no picture.
    std::fs::remove_file(&picture).unwrap();
    let wrong = [
        "plot",
        "examples/g78-as-printed.nc",
        "--path",
        "-o",
        &picture,
    ];
    assert_eq!(code(&leadscrew(&wrong)), 1);
    assert!(!std::path::Path::new(&picture).exists());
}

/// The README shows what `cargo xtask demo` draws.
#[test]
fn the_picture_of_the_readme_is_current() {
    let folder = Folder::new("readme");
    let picture = folder.file("shaft.svg");
    let output = leadscrew(&[
        "plot",
        "examples/shaft.nc",
        "--spindle-ripple=10@5",
        "-o",
        &picture,
    ]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    golden(
        &root().join("docs/images/shaft.svg"),
        &std::fs::read_to_string(picture).unwrap(),
    );
}

#[test]
fn an_unwritable_output_is_told_before_the_work() {
    let output = leadscrew(&["simulate", THREAD, "-o", "/no/such/folder/out.csv"]);
    assert_eq!(code(&output), 2);
    assert!(
        stderr(&output).contains("cannot write `/no/such/folder/out.csv`"),
        "{}",
        stderr(&output)
    );
}

#[test]
fn the_program_is_never_overwritten() {
    let folder = Folder::new("overwrite");
    let program = folder.file("p.svg");
    std::fs::write(&program, "G0 X1\nM30\n").unwrap();
    for args in [["simulate", "-o"], ["plot", "-o"], ["run", "--record"]] {
        let output = leadscrew(&[args[0], &program, args[1], &program]);
        assert_eq!(code(&output), 2, "{args:?}");
        assert!(
            stderr(&output).contains("is the program itself"),
            "{}",
            stderr(&output)
        );
    }
    assert_eq!(std::fs::read_to_string(&program).unwrap(), "G0 X1\nM30\n");
}

/// Long enough in virtual time that the signal arrives while it runs.
#[cfg(unix)]
#[test]
fn ctrl_c_brings_the_machine_to_a_stop() {
    let folder = Folder::new("interrupt");
    let program = folder.file("long.nc");
    let csv = folder.file("long.csv");
    let mut text = String::from("M3 S300\n");
    for _ in 0..2000 {
        text.push_str("G1 X20 Z-100 F60\nG1 X10 Z0\n");
    }
    std::fs::write(&program, text).unwrap();
    let child = Command::new(env!("CARGO_BIN_EXE_leadscrew"))
        .args(["simulate", &program, "-o", &csv])
        .current_dir(root())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // The file appears when the machine starts.
    let patience = Instant::now();
    while std::fs::metadata(&csv).map_or(0, |data| data.len()) == 0 {
        assert!(
            patience.elapsed() < Duration::from_secs(300),
            "it never started"
        );
        std::thread::sleep(Duration::from_millis(5));
    }
    let signal = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status()
        .unwrap();
    assert!(signal.success());
    let output = child.wait_with_output().unwrap();
    assert_eq!(code(&output), 130, "{}", stderr(&output));
    let text = std::fs::read_to_string(&csv).unwrap();
    let mut ends = text
        .lines()
        .rev()
        .map(|line| line.split(',').collect::<Vec<_>>());
    let (last, before) = (ends.next().unwrap(), ends.next().unwrap());
    assert_eq!(last[2..5], before[2..5], "the axes stand at the end");
    assert_ne!(last[9], "alarm");
}

#[test]
fn a_text_that_just_stops_ends_its_program() {
    let folder = Folder::new("open-end");
    for (text, moves) in [
        ("G0 X50 Z10\n", 1),
        ("G0 X50 Z10", 1),
        ("%\nM3 S300\nG0 X50 Z10\n%\n", 2),
        (
            "M3 S300\nG0 X50 Z10\nG78 P010060 Q0.1 R0.05\nG78 X46 Z-10 P1.2 Q0.8 F2",
            22,
        ),
        ("", 0),
    ] {
        let program = folder.file("open.nc");
        std::fs::write(&program, text).unwrap();
        for command in ["simulate", "run"] {
            let result = result(&[command, &program, "--json"]);
            assert_eq!(result["ok"], true, "{text}");
            assert_eq!(result["moves"], moves, "{text}");
        }
    }
}

#[test]
fn the_time_of_a_cycle_is_known_before_it_runs() {
    let folder = Folder::new("time");
    let (program, csv) = (folder.file("time.nc"), folder.file("time.csv"));
    // The second run-out is too short for its displacement: X makes it up by itself, and every pass takes longer.
    for cycle in [
        "G76 P010060 Q1000 R0.05\nG76 X56 Z-30 P9000 Q3000 F2",
        "G76 P010930 Q1000 R0.05\nG76 X56 Z-30 P8124 Q3000 F4 J1 K2",
        "G78 P010460 Q0.1 R0.05 L3\nG78 X56 Z-30 P1.2 Q0.5 F3 J1 K2",
    ] {
        let text = format!("M3 S598\nG4 P1000\nG0 X66 Z8\n{cycle}\nM30\n");
        std::fs::write(&program, text).unwrap();
        let check = result(&["check", &program, "--json"]);
        let foreseen = check["files"][0]["cycles"][0]["time_s"].as_f64().unwrap();
        assert_eq!(
            code(&leadscrew(&["simulate", &program, "-o", &csv])),
            0,
            "{cycle}"
        );
        let rows = std::fs::read_to_string(&csv).unwrap();
        let rows = rows
            .lines()
            .filter(|row| row.split(',').nth(7) == Some("5"));
        let taken = rows.count() as f64 * 1e-3;
        // The first pass waits for its start angle, up to half a turn longer or shorter than foreseen.
        let doubt = 0.5 * 60.0 / 598.0 + 0.02;
        assert!(
            (taken - foreseen).abs() < doubt,
            "{foreseen} s foreseen, {taken} s taken: {cycle}"
        );
    }
}
