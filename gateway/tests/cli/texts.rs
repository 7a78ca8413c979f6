//! Texts as computers and controls write them: encodings, line ends, sizes, and characters that a terminal would obey.

use super::*;

/// What a terminal obeys instead of showing it: an escape, a C1 control, a turn of the direction of writing, a bell.
const OBEYED: &str = "\u{1b}[31m\u{9b}7m\u{202e}\u{7}";

fn utf16(text: &str, little: bool, mark: bool) -> Vec<u8> {
    let mark = mark.then_some(0xFEFF);
    let units = mark.into_iter().chain(text.encode_utf16());
    let bytes = |unit: u16| {
        if little {
            unit.to_le_bytes()
        } else {
            unit.to_be_bytes()
        }
    };
    units.flat_map(bytes).collect()
}

/// `G0 X50（快）`, as an editor on a Chinese computer saves it.
const GBK_FULL_WIDTH: &[u8] = b"G0 X50\xA3\xA8\xBF\xEC\xA3\xA9\r\nM30\r\n";
/// `# 快速` and a value.
const GBK_MACHINE: &[u8] = b"\"1420.X\" = \"11 m/min\"\r\n# \xBF\xEC\xCB\xD9\r\n";

/// Each alarm as number, line and column.
#[track_caller]
fn alarms(output: &Output) -> Vec<(u64, u64, u64)> {
    let result: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let of = result["files"].get(0).unwrap_or(&result);
    let field = |alarm: &serde_json::Value, name: &str| alarm[name].as_u64().unwrap();
    let alarms = of["alarms"].as_array().unwrap().iter();
    alarms
        .map(|alarm| {
            (
                field(alarm, "no"),
                field(alarm, "line"),
                field(alarm, "column"),
            )
        })
        .collect()
}

#[test]
fn programs_in_another_encoding_are_named() {
    let folder = Folder::new("encodings");
    let program = folder.file("p.nc");
    let text = "O0001\r\n(车)\r\nG0 X50\r\nM30\r\n";
    for (bytes, place) in [
        (utf16(text, true, true), (4051, 1, 1)),
        (utf16(text, false, true), (4051, 1, 1)),
        (utf16(text, true, false), (4051, 1, 1)),
        (utf16(text, false, false), (4051, 1, 1)),
        (utf16("%\r\nG0 X50\r\n", true, false), (4051, 1, 2)),
        (utf16("(车)\r\nG0 X50\r\n", false, false), (4051, 1, 1)),
        (GBK_FULL_WIDTH.to_vec(), (4002, 1, 7)),
    ] {
        std::fs::write(&program, &bytes).unwrap();
        let output = leadscrew(&["check", &program, "--json"]);
        assert_eq!(code(&output), 1);
        assert_eq!(alarms(&output), [place], "{bytes:X?}");
        let chinese = stderr(&leadscrew(&["check", &program, "--lang", "zh"]));
        let remedy = if place.0 == 4051 { "UTF-8" } else { "GBK" };
        assert!(
            chinese.contains("措施") && chinese.contains(remedy),
            "{chinese}"
        );
    }
    // In comments between plain parentheses any encoding is read over.
    std::fs::write(&program, b"O0001 (\xB3\xB5)\r\nG0 X50 Z0\r\nM30\r\n").unwrap();
    assert_eq!(code(&leadscrew(&["check", &program])), 0);
}

#[test]
fn machine_files_in_another_encoding_are_named_with_their_place() {
    let folder = Folder::new("machine-encodings");
    let machine = folder.file("m.toml");
    let text = "\"1420.X\" = \"11 m/min\"\r\n";
    for (bytes, place, name) in [
        (utf16(text, true, true), (4414, 1, 1), "UTF-16"),
        (utf16(text, false, true), (4414, 1, 1), "UTF-16"),
        (utf16(text, true, false), (4414, 1, 1), "UTF-16"),
        (utf16(text, false, false), (4414, 1, 1), "UTF-16"),
        (GBK_MACHINE.to_vec(), (4414, 2, 3), "GBK"),
        (b"9000 = 1\n# \xE9t\xE9\n".to_vec(), (4415, 2, 3), "E9h"),
    ] {
        std::fs::write(&machine, &bytes).unwrap();
        let validate = ["params", "validate", "--params", &machine];
        let output = leadscrew(&[&validate[..], &["--json"]].concat());
        assert_eq!(code(&output), 1);
        assert_eq!(alarms(&output), [place], "{name}");
        for lang in ["en", "zh"] {
            for args in [
                vec!["params", "validate", "--params", &machine],
                vec!["params", "migrate", &machine],
                vec!["check", "examples/shaft.nc", "--params", &machine],
            ] {
                let output = leadscrew(&[&args[..], &["--lang", lang]].concat());
                assert_eq!(code(&output), 1, "{args:?}");
                let told = stderr(&output);
                let at = format!("{machine}:{}:{}", place.1, place.2);
                assert!(told.contains(name) && told.contains("UTF-8"), "{told}");
                assert!(told.contains(&at), "{told}");
                assert_eq!(lang == "zh", told.contains("另存为"), "{told}");
            }
        }
    }
}

#[test]
fn line_ends_of_old_controls_are_line_ends() {
    let folder = Folder::new("line-ends");
    let program = folder.file("p.nc");
    let text = std::fs::read_to_string(root().join("examples/shaft.nc")).unwrap();
    let listed = |text: String| {
        std::fs::write(&program, text).unwrap();
        let output = leadscrew(&["expand", &program, "--format", "jsonl"]);
        assert_eq!(code(&output), 0, "{}", stderr(&output));
        stdout(&output)
    };
    let expected = listed(text.clone());
    for end in ["\r", "\n\r", "\r\n"] {
        assert_eq!(listed(text.replace('\n', end)), expected, "{end:?}");
    }
    // Far into a program that is read in pieces, the place and the line are the right ones.
    for (end, last) in [("\r", ""), ("\n\r", " "), ("\r\n", ""), ("\n", "")] {
        let long: String = (0..5000)
            .map(|n| format!("G0 X{} Z1{end}{end}", n % 97))
            .collect();
        std::fs::write(&program, format!("{long}G1 X1 XX{end}M30{end}")).unwrap();
        let output = leadscrew(&["check", &program, "--json"]);
        assert_eq!(alarms(&output), [(4003, 10_001, 7)], "{end:?}");
        let shown = stderr(&leadscrew(&["check", &program]));
        assert!(
            shown.contains(&format!("10001 | G1 X1 XX{last}\n")),
            "{end:?}: {shown}"
        );
    }
    let machine = folder.file("m.toml");
    std::fs::write(&machine, "\"1420.X\" = \"11 m/min\"\r\r9999 = 1\r").unwrap();
    let output = leadscrew(&["params", "validate", "--params", &machine, "--json"]);
    assert_eq!(alarms(&output), [(4401, 3, 1)]);
}

/// What never has the end of a line never comes to an end.
#[test]
fn what_has_no_line_in_64_megabytes_is_no_program() {
    for command in ["check", "expand", "run"] {
        for (lang, word) in [("en", "end of a line"), ("zh", "换行")] {
            let output = leadscrew(&[command, "/dev/zero", "--lang", lang]);
            assert_eq!(code(&output), 2, "{command}: {}", stderr(&output));
            assert!(stderr(&output).contains(word), "{}", stderr(&output));
        }
    }
}

#[test]
fn a_machine_file_has_a_size() {
    let folder = Folder::new("sizes");
    let machine = folder.file("m.toml");
    let line = "# a comment of sixty-four characters with its line feed, no more\n";
    let fits = line.repeat((1 << 18) / line.len());
    std::fs::write(&machine, &fits).unwrap();
    assert_eq!(
        code(&leadscrew(&["params", "validate", "--params", &machine])),
        0
    );
    std::fs::write(&machine, fits + line + line).unwrap();
    for file in [machine.as_str(), "/dev/zero"] {
        for args in [
            vec!["params", "validate", "--params", file],
            vec!["params", "migrate", file],
            vec!["check", "examples/shaft.nc", "--params", file],
            vec!["record", "-o", "r.csv", "--bus", "none0", "--further", file],
        ] {
            for (lang, word) in [("en", "262144 bytes"), ("zh", "262144 字节")] {
                let output = leadscrew(&[&args[..], &["--lang", lang]].concat());
                assert_eq!(code(&output), 2, "{args:?}: {}", stderr(&output));
                assert!(stderr(&output).contains(word), "{}", stderr(&output));
            }
        }
    }
    // Many mistakes on one line: each has its place, and the line is not shown whole with each of them.
    let keys: Vec<_> = (0..5000).map(|n| format!("k{n}=1")).collect();
    std::fs::write(&machine, format!("1420 = {{{}}}\n", keys.join(","))).unwrap();
    let output = leadscrew(&["params", "validate", "--params", &machine, "--json"]);
    let told = alarms(&output);
    assert_eq!(told.len(), 5000);
    assert_eq!((told[0], told[1]), ((4404, 1, 9), (4404, 1, 14)));
    assert!(
        stderr(&output).len() < 5000 * 1500,
        "{}",
        stderr(&output).len()
    );
}

#[test]
fn nothing_that_a_terminal_obeys_reaches_it() {
    let folder = Folder::new("obeyed");
    let named = |ending: &str| folder.file(&format!("{OBEYED}\n{ending}"));
    let (program, good, missing) = (named("p.nc"), named("g.nc"), named("no.nc"));
    let (machine, state, svg) = (named("m.toml"), named("s.flash"), named("o.svg"));
    let (csv, other) = (named("o.csv"), named("o.png"));
    std::fs::write(&program, format!("G0 X50 ({OBEYED}) XX{OBEYED}\n")).unwrap();
    std::fs::write(&good, "M3 S300\nG0 X50 Z10\nM30\n").unwrap();
    std::fs::write(&machine, format!("\"{}\" = \"{OBEYED}\"\n", "9000")).unwrap();
    std::fs::write(&state, OBEYED).unwrap();
    for args in [
        vec!["check", &program],
        vec!["check", &good],
        vec!["check", &missing],
        vec!["expand", &program],
        vec!["run", &program],
        vec!["run", &good],
        vec!["simulate", &good, "-o", &csv],
        vec!["simulate", &good, "-o", &good],
        vec!["plot", &good, "-o", &svg],
        vec!["plot", &good, "-o", &other],
        vec!["plot", &good, "-o", "/no/\u{1b}[2J/o.svg"],
        vec!["check", &good, "--params", &machine],
        vec!["check", &good, "--params", &missing],
        vec!["params", "migrate", &machine],
        vec!["params", "get", OBEYED],
        vec!["params", "list", "--set", OBEYED],
        vec!["params", "list", "--set", "9000=\u{1b}[2J"],
        vec!["params", "list", "--set", "\u{1b}[2J=1"],
        vec!["status", "--state", &state],
        vec!["run", &good, "--state", &state],
        vec!["status", "--bus", OBEYED],
        vec!["check", &good, "--node", OBEYED],
        vec!["check", &good, OBEYED, "--signal", OBEYED],
        vec![OBEYED],
    ] {
        for lang in ["en", "zh"] {
            let output = leadscrew(&[&args[..], &["--lang", lang]].concat());
            for told in [stdout(&output), stderr(&output)] {
                let obeyed = |c: char| (c.is_control() && c != '\n') || c == '\u{202e}';
                assert!(!told.contains(obeyed), "{args:?}: {told:?}");
            }
            let told = stderr(&output) + &stdout(&output);
            assert!(!told.is_empty(), "{args:?}");
        }
    }
    // What is for programs names the file as it is.
    let output = leadscrew(&["check", &good, "--json"]);
    let result: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(result["files"][0]["file"], good);
}
