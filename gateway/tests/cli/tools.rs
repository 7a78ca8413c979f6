//! The table of offsets and tools in the flash of a simulated board, and programs that are resolved with it.

use std::fs;

use serde_json::{Value, json};

use super::{Folder, code, leadscrew, stderr, stdout};

/// A command on the board of a flash.
struct Board {
    file: String,
}

impl Board {
    fn new(folder: &Folder) -> Self {
        Self {
            file: folder.file("board.flash"),
        }
    }

    fn output(&self, args: &[&str]) -> (i32, String, String) {
        let output = leadscrew(&[args, &["--state", &self.file]].concat());
        (code(&output), stdout(&output), stderr(&output))
    }

    fn good(&self, args: &[&str]) -> String {
        let (code, out, err) = self.output(args);
        assert_eq!(code, 0, "{args:?}: {out}{err}");
        out
    }

    fn json(&self, args: &[&str]) -> Value {
        let out = self.good(&[args, &["--json"]].concat());
        serde_json::from_str(&out).unwrap_or_else(|error| panic!("{out}: {error}"))
    }

    fn bad(&self, expected: i32, args: &[&str]) -> String {
        let (code, out, err) = self.output(args);
        assert_eq!(code, expected, "{args:?}: {out}{err}");
        err
    }
}

#[test]
fn values_are_set_listed_and_kept() {
    let folder = Folder::new("tools-set");
    let board = Board::new(&folder);
    assert_eq!(
        board.good(&[
            "tools",
            "set",
            "T1.X=-250.76",
            "1.radius=0.4",
            "1.tip=3",
            "T12.wear.Z=-0.02"
        ]),
        "T1.X        0 → -250.76\n\
         T1.radius   0 → 0.4\n\
         T1.tip      0 → 3\n\
         T12.wear.Z  0 → -0.02\n\
         stored and in force, revision 1\n"
    );
    assert_eq!(
        board.good(&["tools", "list"]),
        "tool        X  Z  wear X  wear Z  radius  tip  station  measured\n  \
           T1  -250.76  0       0       0     0.4    3        0         -\n \
           T12        0  0       0   -0.02       0    0        0         -\n\
         revision 1, of node 1 on sim; mm, X in diameter\n"
    );
    assert_eq!(
        board.good(&["offsets", "set", "G54.Z=-400", "shift.X=0.5"]),
        "shift.X  0 → 0.5\nG54.Z    0 → -400\nstored and in force, revision 2\n"
    );
    assert_eq!(
        board.good(&["offsets", "set", "G54.Z=-400"]),
        "nothing to change\n"
    );
    assert_eq!(
        board.good(&["offsets", "get", "g54"]),
        "G54.X = 0\nG54.Z = -400\n"
    );
    assert_eq!(
        board.json(&["offsets", "list"]),
        json!({
            "ok": true, "revision": 2,
            "shift": {"x": 0.5, "z": 0}, "G54": {"x": 0, "z": -400},
            "G55": {"x": 0, "z": 0}, "G56": {"x": 0, "z": 0}, "G57": {"x": 0, "z": 0},
            "G58": {"x": 0, "z": 0}, "G59": {"x": 0, "z": 0}
        })
    );
    assert_eq!(
        board.json(&["tools", "get", "T1.X", "T12.wear.Z", "1.measured"]),
        json!({
            "ok": true, "revision": 2, "values": [
                {"key": "T1.X", "value": -250.76},
                {"key": "T12.wear.Z", "value": -0.02},
                {"key": "T1.measured", "value": ""},
            ]
        })
    );
    assert_eq!(
        board.json(&["tools", "set", "T12.wear.Z-=0.01", "--dry-run"]),
        json!({
            "ok": true, "done": false, "revision": 2,
            "changes": [{"key": "T12.wear.Z", "old": -0.02, "new": -0.03}]
        })
    );
}

#[test]
fn what_cannot_be_set_is_refused_and_nothing_is_written() {
    let folder = Folder::new("tools-refused");
    let board = Board::new(&folder);
    board.good(&["tools", "set", "T1.X=1"]);
    let before = fs::read(&board.file).unwrap();
    for (exit, args, part) in [
        (
            1,
            &["tools", "set", "T2.X=1", "T1.X=10000"][..],
            "4582: T1.X: `10000` is outside",
        ),
        (
            1,
            &["tools", "set", "T1.wear.X=1.1"],
            "T1.wear.X changes by more than 1 mm",
        ),
        (2, &["tools", "set", "G54.X=1"], "there is no `G54.X`"),
        (2, &["offsets", "set", "T1.X=1"], "there is no `T1.X`"),
        (2, &["tools", "get", "T77"], "there is no `T77`"),
    ] {
        let told = board.bad(exit, args);
        assert!(told.contains(part), "{args:?}: {told}");
        assert_eq!(fs::read(&board.file).unwrap(), before, "{args:?}");
    }
    board.good(&["tools", "set", "T1.wear.X=1.1", "--yes"]);
    // Without a board there is no place for it.
    let output = leadscrew(&["tools", "set", "T1.X=1"]);
    assert_eq!(code(&output), 2);
    assert!(
        stderr(&output).contains("this needs a board"),
        "{}",
        stderr(&output)
    );
}

#[test]
fn a_file_is_pulled_compared_and_pushed() {
    let folder = Folder::new("tools-file");
    let board = Board::new(&folder);
    board.good(&[
        "tools",
        "set",
        "T1.X=-250.76",
        "T1.wear.Z=0.01",
        "T1.measured=X",
    ]);
    let file = folder.file("tools.toml");
    board.good(&["tools", "pull", "-o", &file]);
    let text = fs::read_to_string(&file).unwrap();
    let line = "T1 = { X = -250.76, Z = 0, wear = { X = 0, Z = 0.01 }, radius = 0, tip = 0, station = 0, measured = \"X\" }\n";
    assert!(text.contains(line), "{text}");
    assert!(
        text.starts_with("# Offsets and tools, revision 1, of node 1 on sim"),
        "{text}"
    );
    assert_eq!(board.good(&["tools", "diff", &file]), "no difference\n");
    board.bad(2, &["tools", "pull", "-o", &file]);
    fs::write(
        &file,
        text.replace("Z = 0.01", "Z = 0.02")
            .replace("G54 = { X = 0", "G54 = { X = 1"),
    )
    .unwrap();
    let (code, out, _) = board.output(&["tools", "diff", &file]);
    assert_eq!(
        (code, &*out),
        (1, "G54.X      0 → 1\nT1.wear.Z  0.01 → 0.02\n")
    );
    assert_eq!(
        board.good(&["tools", "push", &file]),
        format!("{out}stored and in force, revision 2\n")
    );
    // A part of a table leaves the others alone.
    fs::write(&file, "T2.X = 5\n").unwrap();
    assert_eq!(
        board.good(&["tools", "push", &file]),
        "T2.X  0 → 5\nstored and in force, revision 3\n"
    );
    fs::write(&file, "T1.X = 1\nT1.colour = 5\n").unwrap();
    let told = board.bad(1, &["tools", "push", &file]);
    assert!(
        told.contains("tools.toml:2: there is no `T1.colour`"),
        "{told}"
    );
}

/// The end of the first rapid of a program in machine coordinates: X and Z.
fn first_end(args: &[&str]) -> (f64, f64) {
    let output = leadscrew(args);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let out = stdout(&output);
    let moves: Vec<Value> = out
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .filter(|line: &Value| line["kind"] == "rapid")
        .collect();
    let of = |key: &str| {
        moves[0][key]
            .as_f64()
            .unwrap_or_else(|| panic!("{}", moves[0]))
    };
    (of("mx"), of("mz"))
}

#[test]
fn programs_are_resolved_with_the_table() {
    let folder = Folder::new("tools-resolve");
    let board = Board::new(&folder);
    let program = folder.file("p.nc");
    fs::write(&program, "T0101\nG55 G0 X20 Z-5\nM30\n").unwrap();
    let machine = folder.file("leadscrew.toml");
    fs::write(&machine, "9101.X = \"2 mm\"\n1222.Z = \"-10 mm\"\n").unwrap();
    let expand = ["expand", &program, "--format", "jsonl"];
    // Without a table the parameters of old count.
    let old = first_end(&expand);
    let tools = folder.file("tools.toml");
    fs::write(
        &tools,
        "T1 = { X = 4, wear = { X = -1, Z = 0.5 } }\nG55.Z = -20\nshift.Z = 1\n",
    )
    .unwrap();
    let new = first_end(&[&expand[..], &["--tools", &tools]].concat());
    assert_eq!((new.0 - old.0, new.1 - old.1), (1.0, -8.5));
    // A board has no table yet: its own parameters count.
    let kept = [&expand[..], &["--state", &board.file]].concat();
    fs::remove_file(&machine).unwrap();
    let none = first_end(&kept);
    board.good(&["tools", "push", &tools]);
    let with = first_end(&kept);
    assert_eq!(with, new);
    assert_ne!(none, with);
    // Another table than the board's is not simulated in its name.
    fs::write(&tools, "T1.X = 5\n").unwrap();
    let told = board.bad(1, &[&expand[..], &["--tools", &tools]].concat());
    assert!(
        told.contains("is not the tool table of the board"),
        "{told}"
    );
}

#[test]
fn touching_off_gives_the_worked_numbers() {
    let folder = Folder::new("tools-touch");
    let board = Board::new(&folder);
    board.good(&["offsets", "set", "G54.Z=-400"]);
    let at = ["--at", "X=-212.34,Z=-305.125"];
    let touch = |args: &[&str]| board.good(&[&["touch"], args, &at].concat());
    assert_eq!(
        touch(&["X", "38.42", "--tool", "1"]),
        "T1.X = -250.7600: X 38.4200 of the work is at -212.3400 of the machine\n\
         T1.X         0 → -250.76\n\
         T1.measured  - → X\n\
         stored and in force, revision 2\n"
    );
    board.good(&["tools", "set", "T1.wear.Z=0.3"]);
    assert_eq!(
        touch(&["z", "0", "--tool", "1"]),
        "T1.Z = 94.8750: Z 0.0000 of the work is at -305.1250 of the machine\n\
         T1.Z         0 → 94.875\n\
         T1.wear.Z    0.3 → 0\n\
         T1.measured  X → XZ\n\
         stored and in force, revision 4\n"
    );
    // The part came out 38.44 instead of 38.42.
    assert_eq!(
        board.good(&["tools", "set", "T1.wear.X-=0.02"]),
        "T1.wear.X  0 → -0.02\nstored and in force, revision 5\n"
    );
    assert_eq!(
        touch(&["Z", "0", "--work", "G55", "--tool", "1"]),
        "G55.Z = -400.0000: Z 0.0000 of the work is at -305.1250 of the machine\n\
         G55.Z  0 → -400\n\
         stored and in force, revision 6\n"
    );
    for (args, part) in [
        (&["touch", "X", "1"][..], "needs `--tool N`"),
        (&["touch", "X"], "needs the coordinate"),
    ] {
        let told = board.bad(2, args);
        assert!(told.contains(part), "{told}");
    }
}
