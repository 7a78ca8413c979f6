//! The command line itself.

use std::process::{Command, Output, Stdio};

use crate::{Folder, code, leadscrew, stderr, stdout, write};

#[test]
fn help_and_version_are_on_every_command() {
    let version = leadscrew(&["--version"]);
    assert_eq!(code(&version), 0);
    assert!(stdout(&version).starts_with("leadscrew "));
    for command in [
        "check",
        "expand",
        "simulate",
        "plot",
        "measure",
        "run",
        "status",
        "monitor",
        "agent",
        "fleet",
        "hold",
        "resume",
        "reset",
        "stop",
        "override",
        "signal",
        "retract",
        "params",
        "drives",
        "record",
        "mdi",
        "up",
        "down",
        "sim",
        "completions",
        "man",
    ] {
        let help = leadscrew(&[command, "--help"]);
        assert_eq!(code(&help), 0, "{command}: {}", stderr(&help));
        assert!(stdout(&help).contains("Usage:"), "{command}");
        assert!(stdout(&help).contains("Example"), "{command}");
    }
    for verb in [
        "list", "get", "set", "pull", "push", "diff", "validate", "migrate", "docs", "restore",
    ] {
        let help = leadscrew(&["params", verb, "--help"]);
        assert_eq!(code(&help), 0, "{verb}: {}", stderr(&help));
        let example = format!("  leadscrew params {verb}");
        assert!(stdout(&help).contains(&example), "{verb}");
    }
    for verb in ["list", "show"] {
        let help = leadscrew(&["drives", verb, "--help"]);
        assert_eq!(code(&help), 0, "{verb}: {}", stderr(&help));
        let example = format!("  leadscrew drives {verb}");
        assert!(stdout(&help).contains(&example), "{verb}");
    }
    for verb in [
        "door", "estop", "hold", "input", "outputs", "power", "speed", "state",
    ] {
        let help = leadscrew(&["sim", verb, "--help"]);
        assert_eq!(code(&help), 0, "{verb}: {}", stderr(&help));
        let example = format!("  leadscrew sim {verb}");
        assert!(stdout(&help).contains(&example), "{verb}");
    }
}

#[test]
fn a_help_is_in_the_language_asked_for_wherever_that_stands() {
    let help = stdout(&leadscrew(&["run", "--help"]));
    assert!(help.starts_with("Check all of a program, upload it and run it\n\nUsage: "));
    for args in [
        &["run", "--help", "--lang", "zh"][..],
        &["--lang", "zh", "run", "--help"],
        &["--lang=zh", "help", "run"],
    ] {
        let output = leadscrew(args);
        assert_eq!(code(&output), 0, "{args:?}");
        assert_eq!(stderr(&output), "", "{args:?}");
        let help = stdout(&output);
        assert!(
            help.starts_with("检查整个程序，发送并运行\n\n用法： leadscrew run [选项] <PROG>\n"),
            "{args:?}: {help}"
        );
        assert!(
            help.contains("可用的值：\n          - en: 英语\n"),
            "{help}"
        );
    }
    // What was not asked for is told as a mistake, as in English.
    for lang in ["en", "zh"] {
        let output = leadscrew(&["--lang", lang, "params"]);
        assert_eq!(code(&output), 2);
        assert_eq!(stdout(&output), "");
        assert_eq!(stderr(&output).contains("用法："), lang == "zh");
    }
    // A program that is called so.
    let output = leadscrew(&["run", "--help", "--", "--lang", "zh"]);
    assert!(stdout(&output).contains("Usage:"));
}

#[test]
fn a_command_line_that_cannot_be_read_is_answered_in_the_language_asked_for() {
    let shaft = "examples/shaft.nc";
    for (args, words) in [
        (&["check"][..], "缺少：<PROG>..."),
        (&["chek", shaft], "没有命令 `chek`；是否要写 `check`？"),
        (
            &["check", shaft, "--nod", "5"],
            "没有选项或参数 `--nod`；是否要写 `--node`？",
        ),
        (
            &["check", shaft, "--node", "200"],
            "`--node <N>` 不能是 `200`：范围是 1 至 127",
        ),
        (
            &["check", shaft, "--at", "Y=1"],
            "`--at <X=…,Z=…>` 不能是 `Y=1`：没有轴 `Y`：只有 X、Z 和 C",
        ),
        (
            &["check", shaft, "--bus", "slcan:unix:"],
            "`--bus <BUS>` 不能是 `slcan:unix:`：`slcan:unix:` 后面要写套接字的路径",
        ),
        (
            &["check", shaft, "--dialect", "x"],
            "`--dialect <DIALECT>` 不能是 `x`；可用：gsk980td gsk988 fanuc-a fanuc-b fanuc-c haas",
        ),
        (
            &["retract", "--speed", "1", "--discard"],
            "`--speed <RPM>` 不能与 `--discard` 一起用",
        ),
        (
            &["check", shaft, "--seed", "1", "--seed", "2"],
            "`--seed <N>` 只能写一次",
        ),
        (
            &["params", "diff", "a", "b", "c"],
            "`[FILE]...` 的值太多：`c`",
        ),
        (&["params"], "缺少命令"),
    ] {
        let output = leadscrew(&[args, &["--lang", "zh", "--json"]].concat());
        assert_eq!(code(&output), 2, "{args:?}");
        assert_eq!(
            stderr(&output),
            format!("错误：{words}\n\n更多说明请用 `--help` 查看。\n")
        );
        let told: serde_json::Value = serde_json::from_str(&stdout(&output)).unwrap();
        assert_eq!(told["ok"], false, "{args:?}");
        assert_eq!(told["exit"], 2, "{args:?}");
        assert_eq!(told["error"], words, "{args:?}");
    }
    // In English the parser has words of its own.
    let output = leadscrew(&["check", shaft, "--at", "Y=1", "--json"]);
    let told: serde_json::Value = serde_json::from_str(&stdout(&output)).unwrap();
    let words = "invalid value 'Y=1' for '--at <X=…,Z=…>': there is no axis `Y`: X, Z and C are";
    assert_eq!(told["error"], words);
    assert!(stderr(&output).starts_with(&format!("error: {words}\n")));
    // Without it nothing is on standard output.
    assert!(
        leadscrew(&["check", shaft, "--at", "Y=1"])
            .stdout
            .is_empty()
    );
}

#[test]
fn a_format_that_there_is_none_of_is_refused_before_anything_is_computed() {
    for (command, name, formats) in [
        ("plot", "shaft.pdf", "`.svg`, `.png` or `.html`"),
        ("plot", "shaft.json", "`.svg`, `.png` or `.html`"),
        ("plot", "png", "`.svg`, `.png` or `.html`"),
        ("measure", "shaft.jpg", "`.svg`, `.png`, `.html` or `.json`"),
    ] {
        let output = leadscrew(&[command, "examples/none.nc", "-o", name]);
        assert_eq!(code(&output), 2);
        assert_eq!(
            stderr(&output),
            format!("error: `{name}`: the ending of the file chooses the format: {formats}\n")
        );
        assert!(output.stdout.is_empty());
    }
}

#[test]
fn what_needs_a_board_says_so_and_how_to_name_one() {
    for args in [
        &["hold"][..],
        &["resume"],
        &["reset"],
        &["stop"],
        &["monitor"],
        &["override", "feed", "50"],
        &["signal", "RGTAP=1"],
        &["mdi", "G0 X1"],
        &["record", "-o", "bus.log"],
    ] {
        let output = leadscrew(args);
        assert_eq!(code(&output), 2, "{args:?}");
        let told = stderr(&output);
        assert!(
            told.contains("`--bus sim` lives inside one command") && told.contains("--bus can0"),
            "{args:?}: {told}"
        );
        assert!(output.stdout.is_empty(), "{args:?}");
    }
    for args in [
        &["run", "examples/shaft.nc"][..],
        &["status"],
        &["hold"],
        &["params", "list"],
    ] {
        let args = [args, &["--bus", "no-such-can"]].concat();
        let output = leadscrew(&args);
        assert_eq!(code(&output), 3, "{args:?}: {}", stderr(&output));
    }
}

#[test]
fn a_signal_that_is_not_there_is_answered_with_those_that_are() {
    for command in ["check", "expand", "simulate", "run"] {
        let output = leadscrew(&[command, "examples/shaft.nc", "--signal", "SWS5=1"]);
        assert_eq!(code(&output), 2, "{command}");
        let told = stderr(&output);
        for name in ["G61.2", "RGTAP", "SWS1", "SWS4", "RGTSP1", "RGTSP4"] {
            assert!(told.contains(name), "{command}: {told}");
        }
        assert!(output.stdout.is_empty(), "{command}");
    }
}

#[test]
fn operating_a_board_that_is_not_there_gives_the_reason() {
    let output = leadscrew(&["hold"]);
    assert!(
        stderr(&output).contains("`--bus sim` lives inside one command"),
        "{}",
        stderr(&output)
    );
}

#[test]
fn a_wrong_command_line_is_exit_2() {
    for args in [
        &[][..],
        &["frobnicate"],
        &["expand"],
        &["expand", "no-such-file.nc"],
        &["expand", "examples"],
        &["expand", "examples/shaft.nc", "--format", "xml"],
        &["expand", "examples/shaft.nc", "--format", "csv", "--json"],
        &["simulate", "examples/shaft.nc", "--spindle-ripple", "10"],
        &["simulate", "examples/shaft.nc", "--at", "X=1,X=2"],
        &["simulate", "examples/shaft.nc", "--tolerance", "-1"],
        &["plot", "examples/shaft.nc", "-o", "shaft.bmp"],
        &["check", "examples/shaft.nc", "--node", "128"],
        &["check", "examples/shaft.nc", "--dialect", "fanuc"],
        &["override", "feed", "300"],
        &["run", "examples/shaft.nc", "--bus", "/dev/ttyACM0"],
    ] {
        let output = leadscrew(args);
        assert_eq!(code(&output), 2, "{args:?}: {}", stderr(&output));
        assert!(!output.stderr.is_empty(), "{args:?}");
    }
}

#[test]
fn a_missing_file_is_named() {
    let output = leadscrew(&["expand", "no-such-file.nc"]);
    assert_eq!(
        stderr(&output),
        "error: cannot read `no-such-file.nc`: there is no such file\n"
    );
}

#[test]
fn what_cannot_be_written_says_what_is_missing() {
    for (args, why) in [
        (
            &["simulate", "examples/shaft.nc", "-o", "/no/such/x.csv"][..],
            "error: cannot write `/no/such/x.csv`: there is no such folder\n",
        ),
        (
            &["run", "examples/shaft.nc", "--record", "README.md/x.log"],
            "error: cannot write `README.md/x.log`: what should be a folder is a file\n",
        ),
        (
            &["simulate", "examples/g84-tap.nc", "-o", "/dev/full"],
            "error: cannot write `/dev/full`: no space is left there\n",
        ),
    ] {
        let output = leadscrew(args);
        assert_eq!(code(&output), 2, "{args:?}");
        assert_eq!(stderr(&output), why, "{args:?}");
    }
}

/// A command whose results go there.
fn printing_to(there: impl Into<Stdio>, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_leadscrew"))
        .args(args)
        .current_dir(crate::root())
        .stdout(there)
        .stderr(Stdio::piped())
        .output()
        .unwrap()
}

/// Nobody has read it then, be it the help.
#[test]
fn what_cannot_be_printed_is_no_success() {
    for (args, lang) in [
        (&["--help"][..], "en"),
        (&["--version"], "en"),
        (&["params", "set", "--help"], "en"),
        (&["--help", "--lang", "zh"], "zh"),
        (&["completions", "bash"], "en"),
        (&["man", "run"], "en"),
        (&["params", "docs"], "en"),
    ] {
        let full = std::fs::File::create("/dev/full").unwrap();
        let output = printing_to(full, args);
        let why = match lang {
            "en" => "error: cannot write to standard output: no space is left there\n",
            _ => "错误：无法写入标准输出：存储空间已满\n",
        };
        assert_eq!(stderr(&output), why, "{args:?}");
        assert_eq!(code(&output), 2, "{args:?}");
    }
}

/// As where `head` has read enough.
#[test]
fn the_exit_code_tells_the_verdict_where_nobody_reads_the_words() {
    let folder = Folder::new("nobody-reads");
    let bad = write(&folder, "bad.nc", "G1 X5\n");
    let bad = bad.as_str();
    let tap = "examples/g84-tap.nc";
    for (args, exit) in [
        (&["check", tap][..], 0),
        (&["check", bad, "--json"], 1),
        (&["run", bad, "--json"], 1),
        (&["run", tap], 0),
        (
            &[
                "run",
                "examples/o0013-g76-m68x6.nc",
                "--spindle-ripple",
                "10@5",
                "--tolerance",
                "0.000001",
            ],
            1,
        ),
    ] {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let output = printing_to(writer, args);
        assert_eq!(code(&output), exit, "{args:?}: {}", stderr(&output));
    }
}

/// Also where nothing would have to be written: the flash of that board could never be kept.
#[test]
fn a_state_in_a_folder_that_is_not_there_is_no_board() {
    for args in [
        &["params", "set", "9000=1000"][..],
        &["params", "set", "9007=12"],
        &["params", "list"],
        &["status"],
        &["run", "examples/g84-tap.nc"],
    ] {
        let output = leadscrew(&[args, &["--state", "no/such/board.flash"]].concat());
        assert!(
            stderr(&output).contains("`no/such/board.flash`"),
            "{args:?}: {}",
            stderr(&output)
        );
        assert_eq!(code(&output), 2, "{args:?}");
        assert_eq!(stdout(&output), "", "{args:?}");
    }
}

#[test]
fn a_negative_figure_is_answered_as_a_figure() {
    for (args, why) in [
        (
            &["run", "examples/shaft.nc", "--tolerance", "-1"][..],
            "a tolerance is not negative",
        ),
        (
            &["override", "feed", "-5"],
            "expected a whole number of percent",
        ),
        (&["check", "examples/shaft.nc", "--seed", "-1"], "--seed"),
        (
            &["offsets", "set", "G54.Z", "-400", "--bus", "can0"],
            "sets nothing: write KEY=VALUE",
        ),
    ] {
        let output = leadscrew(args);
        let told = stderr(&output);
        assert_eq!(code(&output), 2, "{args:?}");
        assert!(told.contains(why) && !told.contains("unexpected"), "{told}");
    }
}

/// [D175]
#[test]
fn a_jog_says_what_it_can_be_given() {
    for (args, part) in [
        (&["X-"][..], "<--by <MM>|--hold>"),
        (&["X-", "--by", "-5"], "its direction stands with the axis"),
        (&["X-", "--by", "5", "--hold"], "cannot be used with"),
        (
            &["X-", "--by", "5", "--feed", "100"],
            "`leadscrew override feed`",
        ),
        (&["X-", "--by", "5", "--rapid"], "parameter 9041"),
    ] {
        let told = leadscrew(&[&["jog", "--bus", "can0"], args].concat());
        assert_eq!(code(&told), 2, "{args:?}");
        assert!(stderr(&told).contains(part), "{}", stderr(&told));
    }
}

#[test]
fn the_number_of_this_side_is_no_boards() {
    let output = leadscrew(&["check", "examples/shaft.nc", "--node", "127"]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    for args in [&["status"][..], &["run", "examples/shaft.nc"]] {
        let bus = ["--node", "127", "--bus", "slcan:unix:/no/such"];
        let output = leadscrew(&[args, &bus].concat());
        assert_eq!(code(&output), 2, "{args:?}: {}", stderr(&output));
        assert!(
            stderr(&output).contains("this side's own number"),
            "{args:?}"
        );
    }
}

#[test]
fn completions_exist_for_the_usual_shells() {
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let output = leadscrew(&["completions", shell]);
        assert_eq!(code(&output), 0, "{shell}");
        assert!(stdout(&output).contains("leadscrew"), "{shell}");
    }
}

/// The commands that `--help` lists under this command, but `help` itself.
fn commands_below(command: &[&str]) -> Vec<String> {
    let help = stdout(&leadscrew(&[command, &["--help"]].concat()));
    let list = help.split_once("Commands:\n").map_or("", |(_, list)| list);
    let lines = list.lines().take_while(|line| !line.is_empty());
    // What is wrapped is indented further.
    let rows = lines.filter_map(|line| line.strip_prefix("  ").filter(|row| !row.starts_with(' ')));
    let names = rows.filter_map(|row| row.split_whitespace().next());
    names
        .filter(|name| *name != "help")
        .map(str::to_owned)
        .collect()
}

#[test]
fn manual_pages_are_in_chinese_too_and_completions_in_english() {
    let folder = Folder::new("man-zh");
    let to = folder.0.to_str().unwrap();
    let output = leadscrew(&["man", "--lang", "zh", "--to", to]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let page = std::fs::read_to_string(folder.file("leadscrew-run.1")).unwrap();
    assert!(
        page.contains("\n.SH 名称\nleadscrew\\-run \\- 检查整个程序，发送并运行\n"),
        "{page}"
    );
    let printed = stdout(&leadscrew(&["man", "run", "--lang", "zh"]));
    assert_eq!(printed, page);
    let script = |lang| stdout(&leadscrew(&["completions", "zsh", "--lang", lang]));
    assert_eq!(script("zh"), script("en"));
}

#[test]
fn each_command_and_verb_has_a_manual_page_that_the_one_above_names() {
    let folder = Folder::new("man");
    let output = leadscrew(&["man", "--to", folder.0.to_str().unwrap()]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let page = |name: &str| std::fs::read_to_string(folder.file(&format!("{name}.1"))).unwrap();
    let commands = commands_below(&[]);
    assert!(commands.len() > 30, "{commands:?}");
    for command in &commands {
        let named = format!("leadscrew\\-{}(1)", command.replace('-', "\\-"));
        assert!(page("leadscrew").contains(&named), "{named}");
        let own = page(&format!("leadscrew-{command}"));
        for option in ["\\-\\-bus\\fR", "\\-\\-lang\\fR"] {
            assert!(own.contains(option), "{command}: {option}");
        }
        let printed = stdout(&leadscrew(&["man", command]));
        assert_eq!(printed, own, "{command}");
        for verb in commands_below(&[command]) {
            let own = page(&format!("leadscrew-{command}-{verb}"));
            assert_eq!(
                stdout(&leadscrew(&["man", command, &verb])),
                own,
                "{command} {verb}"
            );
        }
    }
}

#[test]
fn a_page_of_no_command_is_refused() {
    let output = leadscrew(&["man", "params", "lst"]);
    assert_eq!(code(&output), 2);
    assert!(
        stderr(&output).contains("no command `params lst`"),
        "{}",
        stderr(&output)
    );
    let output = leadscrew(&["man", "--to", "/dev/null/here"]);
    assert_eq!(code(&output), 2);
    assert!(stderr(&output).contains("/dev/null/here"));
}

#[test]
fn status_without_a_board_says_where_to_look() {
    let output = leadscrew(&["status"]);
    assert_eq!(code(&output), 2);
    assert!(
        stderr(&output).contains("`--state FILE`"),
        "{}",
        stderr(&output)
    );
    let output = leadscrew(&["status", "--state", "no-such-flash.bin"]);
    assert_eq!(code(&output), 2);
    assert_eq!(
        stderr(&output),
        "error: cannot read `no-such-flash.bin`: there is no such file\n"
    );
    let output = leadscrew(&["status", "--state", "README.md"]);
    assert_eq!(code(&output), 2);
    assert!(
        stderr(&output).contains("no image of a simulated board's flash"),
        "{}",
        stderr(&output)
    );
}

#[test]
fn what_is_wrong_with_files_is_told_before_a_board_is_looked_for() {
    // Nobody listens there.
    let bus = ["--bus", "slcan:unix:/no/such/socket"];
    for args in [
        &["params", "diff", "no-such.toml"][..],
        &["params", "push", "no-such.toml"],
        &["params", "pull", "--into", "no-such.toml"],
        &["params", "list", "--params", "no-such.toml"],
        &["params", "get", "9000", "--params", "no-such.toml"],
        &["check", "examples/shaft.nc", "--params", "no-such.toml"],
        &["run", "examples/shaft.nc", "--params", "no-such.toml"],
    ] {
        let output = leadscrew(&[args, &bus].concat());
        assert_eq!(code(&output), 2, "{args:?}: {}", stderr(&output));
        assert_eq!(
            stderr(&output),
            "error: cannot read `no-such.toml`: there is no such file\n",
            "{args:?}"
        );
    }
    for args in [
        &["params", "diff", "--set", "9000=0"][..],
        &["run", "examples/shaft.nc", "--set", "9000=0"],
    ] {
        let output = leadscrew(&[args, &bus].concat());
        assert_eq!(code(&output), 1, "{args:?}: {}", stderr(&output));
        assert!(stderr(&output).contains("is out of range"), "{args:?}");
    }
    let output = leadscrew(&[&["params", "pull", "-o", "README.md"][..], &bus].concat());
    assert_eq!(code(&output), 2);
    assert!(
        stderr(&output).contains("`README.md` is there already"),
        "{}",
        stderr(&output)
    );
    let output = leadscrew(&[&["params", "diff"][..], &bus].concat());
    assert_eq!(code(&output), 3, "{}", stderr(&output));
}
