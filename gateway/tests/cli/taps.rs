//! Taps in summaries and pictures, in both languages.

use serde_json::Value;

use crate::{Folder, code, leadscrew, stderr, stdout, write};

fn simulated(args: &[&str]) -> Value {
    let mut all = vec!["simulate", "--json"];
    all.extend_from_slice(args);
    let output = leadscrew(&all);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    serde_json::from_str(&stdout(&output)).unwrap()
}

/// The worked figures of the sheet's example.
#[test]
fn summaries_count_turns_and_travel() {
    let standard = &simulated(&["examples/g84-tap.nc"])["tap"];
    assert_eq!(standard["turns_deep"], 25);
    assert_eq!(standard["turns"], 50);
    assert_eq!(standard["travel_mm"], 100);
    assert_eq!(standard["rpm_max"], 1000.02);
    assert_eq!(standard["skew_um"]["max"], 0);
    assert_eq!(
        simulated(&["examples/g84-peck.nc"])["tap"]["travel_mm"],
        124
    );
    let deep = simulated(&["examples/g84-peck.nc", "--set", "5200.5=1"]);
    assert_eq!(deep["tap"]["travel_mm"], 724);
    assert!(simulated(&["examples/shaft.nc"])["tap"].is_null());
}

#[test]
fn summaries_are_in_the_language_asked_for() {
    let program = "examples/g84-tap.nc";
    let english = stderr(&leadscrew(&["simulate", program]));
    let line = "taps        25 turns deep; 50 turns and 100 mm in and out; up to 1000 rpm; worst skew of axis and spindle \
                below 0.001 µm\n";
    assert!(english.contains(line), "{english}");
    let chinese = stderr(&leadscrew(&["simulate", program, "--lang", "zh"]));
    let line = "攻丝        最深 25 转；进出共 50 转、100 mm；最高 1000 r/min；轴与主轴最大偏差 小于 0.001 µm\n";
    assert!(chinese.contains(line), "{chinese}");
    let ran = stdout(&leadscrew(&["run", program, "--lang", "zh"]));
    assert!(
        ran.starts_with("examples/g84-tap.nc：完成：移动 7 段")
            && ran.contains("\n攻丝 最深 25 转"),
        "{ran}"
    );
    let missing = leadscrew(&["check", "missing.nc", "--lang", "zh"]);
    assert_eq!(
        stderr(&missing),
        "错误：无法读取 `missing.nc`：没有这个文件\n"
    );
}

#[test]
fn pictures_show_depth_and_spindle_angle() {
    let folder = Folder::new("plot-taps");
    let picture = folder.file("tap.svg");
    for (lang, labels) in [
        (
            "en",
            [
                "tap, axis and spindle together",
                "depth of the tap below R",
                "spindle angle since R",
            ],
        ),
        (
            "zh",
            [
                "攻丝，轴与主轴联动",
                "丝锥在 R 平面以下的深度",
                "自 R 平面起的主轴转角",
            ],
        ),
    ] {
        let program = "examples/g84-left-hand.nc";
        let output = leadscrew(&["plot", program, "-o", &picture, "--lang", lang]);
        assert_eq!(code(&output), 0, "{}", stderr(&output));
        let svg = std::fs::read_to_string(&picture).unwrap();
        for part in ["line tap", "line depth", "line turned", "line error"]
            .iter()
            .chain(&labels)
        {
            assert!(svg.contains(part), "{part}");
        }
        // A left-hand tap turns backwards into the hole.
        assert!(svg.contains("\n-10\n"));
        assert!(!svg.contains("NaN"));
    }
    let thread = folder.file("thread.svg");
    leadscrew(&["plot", "examples/o0013-g76-m68x6.nc", "-o", &thread]);
    let svg = std::fs::read_to_string(&thread).unwrap();
    assert!(!svg.contains("line depth") && !svg.contains("line tap"));
}

/// Through a disc of 15 mm from R 2 mm before it, and two side taps that are alike.
#[test]
fn a_picture_has_each_hole_near_by() {
    let folder = Folder::new("plot-holes");
    let program = "(STOCK X50 L15 X0=6)\nG98\nG0 X0 Z5\nM29 S400\nG84 Z-20 R-3 Q6 F500\nG80\nG0 Z50\nX54\nZ-8\n\
                   T0202\nM29 S-300\nG88 X30 R-1 F300\nZ-10\nG80\nM30\n";
    let program = write(&folder, "holes.nc", program);
    let page = folder.file("holes.html");
    let plot = |more: &[&str]| {
        let output = leadscrew(&[&["plot", &program, "-o", &page][..], more].concat());
        assert_eq!(code(&output), 0, "{}", stderr(&output));
        std::fs::read_to_string(&page).unwrap()
    };
    let english = plot(&[]);
    for told in [
        "G84 · line 5\n",
        "rigid, right-hand · lead 1.25 mm along Z · R Z2, bottom Z-20: 17.6 turns · holes: 1\n",
        "infeeds: 4 · longest chip 4.8 turns · back by 1 mm after each infeed: the tap stays in the hole\n",
        "from R to the surface 2 mm · comes out 5 mm behind\n",
        // Its chip begins at the surface, and there is none behind the disc.
        "data-line=\"5\" data-told=\"hole 1, infeed 1 to 6 mm, chip of 3.2 turns, line 5\"",
        "\n4: 22 / 0\n",
        "G88 · T2 · line 12–13\n",
        "rigid, left-hand · lead 1 mm along X · R X52, bottom X30: 11 turns · holes: 2\n",
        "data-line=\"13\" data-told=\"hole 2, back to 0 mm, line 13\"",
        "filled: all 8 strokes",
        "filled: all 4 strokes",
        "in position mode it turns exactly as commanded",
        "data-names=\"turns depth\"",
    ] {
        assert!(english.contains(told), "{told}");
    }
    assert_eq!(english.matches("\novershoot 0 µm, 0°\n").count(), 2);
    let deep = plot(&["--set", "5200.5=1", "--lang", "zh"]);
    for told in [
        "进给 4 次 · 最长切屑 4.8 转 · 每次进给后退出孔外",
        "第 1 孔，再次进入至 5 mm，第 5 行",
        "R 至工件表面 2 mm · 穿出 5 mm",
    ] {
        assert!(deep.contains(told), "{told}");
    }
}

/// A floating holder follows the spindle that truly turns: how true the phase is, is seen over its angle.
#[test]
fn a_picture_of_an_ordinary_tap_has_its_phase() {
    let folder = Folder::new("plot-floating");
    let picture = folder.file("tap.svg");
    let plot = |more: &[&str]| {
        let program = "examples/g84-floating.nc";
        let output = leadscrew(&[&["plot", program, "-o", &picture][..], more].concat());
        assert_eq!(code(&output), 0, "{}", stderr(&output));
        std::fs::read_to_string(&picture).unwrap()
    };
    let (ideal, ripple) = (plot(&[]), plot(&["--spindle-ripple=10@5"]));
    let told = "ideal spindle: add `--spindle-ripple`";
    assert!(ideal.contains(told) && !ripple.contains(told));
    for told in [
        "with a floating holder, right-hand · lead 1.25 mm along Z",
        "which is assumed at Z0",
        "Z minus its place in phase, over the spindle angle: from lowest to highest; filled: all 2 strokes",
        "line turned",
    ] {
        assert!(ripple.contains(told), "{told}");
    }
}

/// A hole that goes on after K198 goes on where it was cut.
#[test]
fn a_picture_of_a_hole_that_goes_on_has_both_bottoms() {
    let folder = Folder::new("plot-on");
    let program = "G98\nG0 X0 Z5\nM29 S600\nG84 Z-20 R-3 F900 K198\nG84 Z-29 F900\nG80\nM30\n";
    let program = write(&folder, "on.nc", program);
    let page = folder.file("on.html");
    let output = leadscrew(&["plot", &program, "-o", &page]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let page = std::fs::read_to_string(&page).unwrap();
    for told in [
        "bottom Z-20: 14.6667 turns · holes: 1",
        "infeed 1 to 22 mm, chip of 13.3333 turns, line 4",
        "bottom Z-29: 20.6667 turns · holes: 1",
        "infeed 1 to 31 mm, chip of 6 turns, line 5",
    ] {
        assert!(page.contains(told), "{told}");
    }
    assert_eq!(page.matches("\novershoot 0 µm, 0°\n").count(), 2);
}

/// The axis follows the measured spindle: no commanded angle, and the error is that of the locked part.
#[test]
fn checks_are_in_the_language_asked_for() {
    let check = |program: &str, lang: &str| stdout(&leadscrew(&["check", program, "--lang", lang]));
    for (program, english, chinese) in [
        (
            "examples/g84-tap.nc",
            "G84, 1 hole, 7 s; up to 1000 rpm\n",
            "G84，1 个孔，7 s；最高 1000 r/min\n",
        ),
        (
            "examples/g84-floating.nc",
            "mm before the material; up to ",
            " mm；最高 ",
        ),
        ("examples/o0008-g75-grooves.nc", "10 columns, ", "，10 列，"),
        ("examples/o0013-g76-m68x6.nc", "6 passes, ", "，6 刀，"),
    ] {
        let (en, zh) = (check(program, "en"), check(program, "zh"));
        assert!(en.contains(english), "{en}");
        assert!(zh.contains(chinese), "{zh}");
        for word in [
            "line", "move", "hole", "pass", "column", "least", "ok", "up to",
        ] {
            let beside = zh.replace(program, "");
            assert!(!beside.contains(word), "{word}: {zh}");
        }
    }
}

/// The speed in a picture is that of the spindle that taps, whichever it is.
#[test]
fn a_picture_of_another_spindle_is_the_same() {
    let folder = Folder::new("plot-spindles");
    let svg = |name: &str, args: &[&str]| {
        let picture = folder.file(name);
        let mut all = vec!["plot", "examples/g84-tap.nc", "-o", &picture];
        all.extend_from_slice(args);
        let output = leadscrew(&all);
        assert_eq!(code(&output), 0, "{}", stderr(&output));
        std::fs::read_to_string(&picture).unwrap()
    };
    let first = svg("1.svg", &[]);
    assert!(first.contains("line rpm"));
    assert!(first == svg("2.svg", &["--signal", "SWS2=1"]));
}

#[test]
fn an_ordinary_tap_is_judged_by_the_measured_spindle() {
    let result = simulated(&["examples/g84-floating.nc", "--spindle-ripple", "5@5"]);
    let error = result["sync_error_um"]["max"].as_f64().unwrap();
    assert!(error > 0.0 && error < 1.0, "{error}");
    let taps = &result["tap"];
    let deep = taps["turns_deep"].as_f64().unwrap();
    assert!((19.9..20.0).contains(&deep), "{deep}");
    let output = leadscrew(&["check", "--json", "examples/g84-floating.nc"]);
    let checked: Value = serde_json::from_str(&stdout(&output)).unwrap();
    let cycle = &checked["files"][0]["cycles"][0];
    assert_eq!(
        (&cycle["cycle"], &cycle["rpm_max"]),
        (&"G84".into(), &400.into())
    );
    let lead_in = cycle["lead_in_mm"].as_f64().unwrap();
    assert!((0.01..1.0).contains(&lead_in), "{lead_in}");
    let output = leadscrew(&["check", "examples/g84-floating.nc"]);
    assert!(stdout(&output).contains("mm before the material; up to 400 rpm"));
}

/// Spindles 2 to 4 have no encoder on the board: what it measures of spindle 1 says nothing of their holes.
#[test]
fn nothing_is_measured_of_a_hole_that_another_spindle_taps() {
    let folder = Folder::new("unmeasured");
    let program = folder.file("hole.nc");
    let hole =
        |spindle| format!("G98 G0 X40 Z5\nM29 S600\nG84 Z-12 R-3 P500 F600 E{spindle}\nG80\nM30\n");
    std::fs::write(&program, hole(1)).unwrap();
    let told = simulated(&[&program, "--tolerance", "1"]);
    assert_eq!(told["threads"][0]["kind"], "rigid_tap");
    std::fs::write(&program, hole(2)).unwrap();
    let told = simulated(&[&program, "--tolerance", "1"]);
    assert_eq!(told["threads"], Value::Array(vec![]));
    // The simulation knows its angle all the same.
    assert_eq!(told["sync_error_um"]["max"], 0);
    assert_eq!(told["tap"]["turns_deep"], 14);
}
