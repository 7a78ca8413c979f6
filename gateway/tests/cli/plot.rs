//! Pictures of the cut, compared with the moves of the program.

use std::collections::BTreeMap;

use serde_json::Value;

use crate::{Folder, code, leadscrew, stderr, stdout, write};

/// A picture or a page of a program, as it was written.
fn plotted(folder: &Folder, name: &str, program: &str, more: &[&str]) -> String {
    let picture = folder.file(name);
    let args = [&["plot", program, "-o", &picture][..], more].concat();
    let output = leadscrew(&args);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    std::fs::read_to_string(&picture).unwrap()
}

/// What is between two parts of a text.
fn between<'a>(text: &'a str, before: &str, behind: &str) -> &'a str {
    let (_, rest) = text.split_once(before).unwrap();
    rest.split_once(behind).unwrap().0
}

/// The texts of a picture of a program.
fn texts(folder: &Folder, program: &str, more: &[&str]) -> Vec<String> {
    let svg = plotted(folder, "picture.svg", program, more);
    let numbers = svg.replace("infeed", "");
    assert!(!numbers.contains("NaN") && !numbers.contains("inf"));
    let texts = svg.split("<text").skip(1);
    let content = |text: &str| between(text, ">", "</text>").trim().to_owned();
    texts.map(content).collect()
}

/// The size of a PNG in words: twice that of the same picture as SVG.
pub(crate) fn twice_the_size(png: &str, svg: &str) -> String {
    let (png, svg) = (
        std::fs::read(png).unwrap(),
        std::fs::read_to_string(svg).unwrap(),
    );
    assert!(png.starts_with(b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR"));
    let number = |at: usize| u32::from_be_bytes(png[at..at + 4].try_into().unwrap());
    let size = [number(16), number(20)];
    let (head, _) = svg.split_once('>').unwrap();
    let twice = |name: &str| {
        let (_, rest) = head.split_once(&format!(" {name}=\"")).unwrap();
        let pixels: f64 = rest.split_once('"').unwrap().0.parse().unwrap();
        (pixels * 2.0).ceil() as u32
    };
    assert_eq!(size, ["width", "height"].map(twice));
    format!("{} × {} px", size[0], size[1])
}

#[test]
fn a_picture_as_pixels_is_that_of_the_svg() {
    let folder = Folder::new("plot-png");
    let [png, svg] = ["p.PNG", "p.svg"].map(|name| folder.file(name));
    let output = leadscrew(&["plot", "examples/shaft.nc", "-o", &png, "--path"]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let args = ["plot", "examples/shaft.nc", "-o", &svg, "--path"];
    assert_eq!(code(&leadscrew(&args)), 0);
    let size = twice_the_size(&png, &svg);
    assert!(stderr(&output).contains(&format!("p.PNG: {size}\n")));
}

/// The depth of each pass of a program's thread with one start, as `expand` has it.
fn depths(program: &str) -> BTreeMap<u32, f64> {
    let output = leadscrew(&["expand", program, "--format", "jsonl"]);
    let moves = stdout(&output);
    let moves = moves
        .lines()
        .map(|line| serde_json::from_str::<Value>(line).unwrap());
    let cuts = moves.filter(|each| each["kind"] == "thread");
    let depth = |each: &Value| each["depth"].as_f64().unwrap();
    cuts.map(|each| (each["pass"].as_u64().unwrap() as u32, depth(&each)))
        .collect()
}

#[test]
fn the_depths_at_the_passes_are_those_of_the_moves() {
    let folder = Folder::new("plot-depths");
    let sixty =
        "M3 S300\nG0 X80 Z10\nG76 P020560 Q50 R0.02\nG76 X60.64 Z-62 P36800 Q4500 F6\nM30\n";
    let sixty = write(&folder, "sixty.nc", sixty);
    for program in ["examples/o0013-g76-m68x6.nc", "examples/shaft.nc", &sixty] {
        let depths = depths(program);
        let texts = texts(&folder, program, &[]);
        let labels = texts.iter().filter_map(|text| {
            let (pass, depth) = text.split_once(": ")?;
            Some((pass.parse::<u32>().ok()?, depth.parse::<f64>().ok()?))
        });
        let labels: BTreeMap<u32, f64> = labels.collect();
        assert!(labels.len() > 3, "{program}: {texts:?}");
        let last = depths.keys().last().unwrap();
        assert!(
            labels.contains_key(&1) && labels.contains_key(last),
            "{labels:?}"
        );
        for (pass, depth) in labels {
            let exact = depths[&pass];
            assert!(
                (exact - depth).abs() <= 0.000_051,
                "{program} {pass}: {exact} {depth}"
            );
        }
    }
    assert!(depths(&sixty).len() > 60);
}

#[test]
fn a_page_has_the_pass_and_the_line_of_each_line_of_the_close_views() {
    let folder = Folder::new("plot-told");
    let page = folder.file("shaft.html");
    let output = leadscrew(&["plot", "examples/shaft.nc", "-o", &page]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let page = std::fs::read_to_string(&page).unwrap();
    let has = |told: &str, count: usize| {
        assert_eq!(page.matches(told).count(), count, "{told}");
    };
    // Its groove, its pass, and its run-out.
    for (pass, depth) in depths("examples/shaft.nc") {
        let depth = format!("{depth:.4}");
        let depth = depth.trim_end_matches('0').trim_end_matches('.');
        let told = format!("data-line=\"44\" data-told=\"pass {pass}, ");
        has(&format!("{told}depth {depth}, line 44\""), 2);
        has(&format!("{told}depth {depth}, run-out, line 44\""), 1);
    }
    has("data-line=\"35\" data-told=\"column 2, line 35\"", 1);
    has("data-told=\"column 3, feed 2 to X43, line 37\"", 1);
    has("data-line=\"23\" data-told=\"line 23\"", 1);
    has("data-pane=\"", 5);
}

#[test]
fn a_thread_along_x_has_z_upwards() {
    let folder = Folder::new("plot-face");
    let scroll = include_str!("../../../examples/shop/face-g32.nc");
    let told = texts(&folder, "examples/shop/face-g32.nc", &[]).join("\n");
    for line in [
        "along X (M3, toward the axis) · lead 4 mm · starts: 1 · passes: 5",
        "edge V60:r0.5774, of the norm: the tool is not known, add `--tool T7=V60:r0.5774` · face assumed at Z0",
        "1: Z-0.4",
        "5: Z-2",
        "no run-out: ends at X24",
        "X modulo lead minus the helix",
    ] {
        assert!(told.contains(line), "{line}: {told}");
    }
    assert!(!told.contains("lead-in") && !told.contains("rim"), "{told}");
    // Where the stock is declared, its rim and its face are known.
    let scroll = scroll.replace("O2008 (", "O2008 (STOCK X90 L30)(");
    let scroll = write(&folder, "scroll.nc", &scroll);
    let told = texts(&folder, &scroll, &["--tool", "V60:r0.5"]).join("\n");
    for line in ["edge V60:r0.5\n", "rim X90", "mm to spare"] {
        assert!(told.contains(line), "{line}: {told}");
    }
}

#[test]
fn a_chain_of_g32_is_one_thread_though_its_last_stroke_goes_along_x() {
    let folder = Folder::new("plot-chain");
    let told = texts(&folder, "examples/shop/nipple-g32.nc", &[]);
    let has = |line: &str| told.iter().any(|text| text == line);
    for line in [
        "G32 · T7 · line 11–13",
        "right-hand (M3, toward -Z) · lead 2 mm · starts: 1 · passes: 4",
        "run-out from Z-44 to Z-47",
        "pass: ⌀ mm",
        "1: ⌀39.4",
        "4: ⌀37.6",
    ] {
        assert!(has(line), "{line}: {told:?}");
    }
    let views = told.iter().filter(|text| text.contains(" · line ")).count();
    assert_eq!(views, 1, "{told:?}");
    let told = told.join("\n");
    assert!(told.contains("filled: all 4 passes"), "{told}");
}

#[test]
fn a_drilled_hole_has_its_pecks_and_its_place() {
    let folder = Folder::new("plot-drill");
    let told = texts(&folder, "examples/cycles/g83.nc", &[]).join("\n");
    for line in [
        "G83 · line 6",
        "along Z · R Z2, bottom Z-40: 42 mm · holes: 1 · pecks of a hole: 6, the longest 8 mm",
        "on the axis",
        "from R to the surface 2 mm",
        "1: 8",
        "4: 32",
        "6: 42",
    ] {
        assert!(told.contains(line), "{line}: {told}");
    }
    assert!(!told.contains("turning"), "{told}");
    let told = texts(&folder, "examples/shop/side-holes.nc", &[]).join("\n");
    for line in [
        "G87 · T10 · line 7",
        "along X · R X44, bottom X30: 7 mm · holes: 4 · pecks of a hole: 3, the longest 3 mm",
        "at Z-15 C0 · Z-15 C90 · Z-15 C180 · Z-15 C270",
        "3: 7",
        "C270",
    ] {
        assert!(told.contains(line), "{line}: {told}");
    }
    // A way back leaves it, another R is another view.
    let two = "G98 M3 S800\nG0 X0 Z5\nG83 Z-20. R-3. Q8. F100\nZ-25.\nR-6. Z-25.\nG80\nG0 X100 Z50\nM30\n";
    let two = write(&folder, "two.nc", two);
    let page = folder.file("two.html");
    let output = leadscrew(&["plot", &two, "-o", &page]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let page = std::fs::read_to_string(&page).unwrap();
    for told in [
        "R Z2, bottom Z-25: 27 mm · holes: 2 · pecks of a hole: 4",
        "R Z-1, bottom Z-25: 24 mm · holes: 1 · pecks of a hole: 3",
        "data-line=\"3\" data-told=\"hole 2, peck 4 to 27 mm, 3 mm of it new, line 3\"",
    ] {
        assert!(page.contains(told), "{told}");
    }
}

#[test]
fn what_is_typed_for_a_tool_that_cuts_nothing_is_told() {
    let folder = Folder::new("plot-idle");
    let picture = folder.file("shaft.svg");
    let typed = |tool: &[&str]| {
        let output =
            leadscrew(&[&["plot", "examples/shaft.nc", "-o", &picture][..], tool].concat());
        assert_eq!(code(&output), 0, "{}", stderr(&output));
        stderr(&output)
    };
    let idle = "T9 was typed, and the program cuts nothing with it";
    for tool in [["--tool", "T9=V60:r0.1"], ["--tool-width", "T9=3"]] {
        assert!(typed(&tool).contains(idle));
    }
    let known = typed(&[
        "--tool",
        "T3=V60:r0.1",
        "--tool-width",
        "T2=3",
        "--tool",
        "V60:r0.2",
    ]);
    assert!(!known.contains("was typed"), "{known}");
}

#[test]
fn the_surface_of_strokes_is_below_that_of_the_stock_and_above_the_first_pass() {
    let folder = Folder::new("plot-surface");
    let told = texts(&folder, "examples/cycles/g34.nc", &[]).join("\n");
    assert!(
        told.contains("lead 4 mm, more by 0.5 mm in each turn · starts: 1 · passes: 2"),
        "{told}"
    );
    assert!(
        told.contains("pass: ⌀ mm") && !told.contains("pass: depth"),
        "{told}"
    );
    let told = texts(&folder, "examples/shop/face-g32.nc", &[]).join("\n");
    assert!(told.contains("pass: Z mm"), "{told}");
}

#[test]
fn a_groove_that_is_cut_again_elsewhere_counts_its_columns_on() {
    let folder = Folder::new("plot-again");
    let told = texts(&folder, "examples/shop/macro-a.nc", &[]);
    let has = |line: &str| told.iter().any(|text| text == line);
    let figures = told.iter().find(|text| text.contains("columns: 4"));
    assert!(
        figures.is_some_and(|text| text.starts_with("bottoms from ⌀38 to ⌀32 · ")),
        "{told:?}"
    );
    for column in ["1", "2", "3", "4"] {
        assert!(has(column), "{column}: {told:?}");
    }
}

#[test]
fn a_groove_of_g74_goes_into_the_face() {
    let folder = Folder::new("plot-g74");
    let program = "G97 G99 M3 S600\nT0303\nG0 X40 Z2\nG74 R0.5\nG74 X30 Z-8 P50000 Q30000 F0.1\n\
        G0 X100 Z50\nT0505\nG0 X0 Z2\nG74 R1\nG74 Z-30 Q80000 F0.1\nM30\n";
    let program = write(&folder, "g74.nc", program);
    let page = folder.file("g74.html");
    let args = ["--tool-width", "T3=3", "--tool-width", "T5=10"];
    let output = leadscrew(&[&["plot", &program, "-o", &page][..], &args].concat());
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let page = std::fs::read_to_string(&page).unwrap();
    for told in [
        "bottom Z-8 · columns: 3, feeds: 12",
        "tool 3 mm wide, programmed at its corner toward the axis",
        "bottom Z-30 · columns: 1, feeds: 4",
        "tool of ⌀10, on the axis",
        "data-told=\"column 3, feed 2 to Z-4, line 5\"",
        "data-names=\"X Z\"",
    ] {
        assert!(page.contains(told), "{told}");
    }
}

#[test]
fn a_thread_tells_its_hand_its_run_out_and_its_lead_in() {
    let folder = Folder::new("plot-thread");
    let program = "examples/o0013-g76-m68x6.nc";
    let told = texts(&folder, program, &["--tool", "V60:r0.5"]).join("\n");
    for line in [
        "G76 · line 6",
        "right-hand (M3, toward -Z) · lead 6 mm · starts: 1 · passes: 6",
        "edge V60:r0.5 · face assumed at Z0",
        "run-out from Z-59 to Z-62",
        // From Z7.875351 the lead is reached 0.827281 mm on.
        "lead-in 0.827 mm, 7.048 mm to spare",
    ] {
        assert!(told.contains(line), "{line}: {told}");
    }
    let told = texts(&folder, program, &["--lang", "zh"]).join("\n");
    assert!(
        told.contains("右旋（M3，向 -Z）") && told.contains("退尾 Z-59 至 Z-62"),
        "{told}"
    );
    assert!(
        told.contains("刀具未知，请加 `--tool V60:r0.866`"),
        "{told}"
    );
    // Left-hand, from a place where the lead-in has no room.
    let short = "M4 S300\nG0 X46 Z0.2\nG92 X39 Z-30 F3\nX38.5\nG0 X80\nM30\n";
    let short = write(&folder, "short.nc", short);
    let told = texts(&folder, &short, &[]).join("\n");
    assert!(
        told.contains("left-hand (M4, toward -Z) · lead 3 mm · starts: 1 · passes: 2"),
        "{told}"
    );
    assert!(
        told.contains("⚠ lead-in ") && told.contains(" mm of it are missing before the face"),
        "{told}"
    );
    assert!(
        told.contains("1: ⌀39") && told.contains("2: ⌀38.5"),
        "{told}"
    );
}

#[test]
fn grooves_have_the_width_of_their_tool_and_warnings_their_place() {
    let folder = Folder::new("plot-groove");
    let told = texts(&folder, "examples/shaft.nc", &[]).join("\n");
    assert!(
        told.contains("G75 · T2 · line 35\n") && told.contains("G75 · T2 · line 37\n"),
        "{told}"
    );
    assert!(told.contains("turning · T1 · line 10–28"), "{told}");
    assert!(
        told.replace('\n', " ").contains("`--tool-width T2=MM`"),
        "{told}"
    );
    let told = texts(&folder, "examples/shaft.nc", &["--tool-width", "T2=4"]).join(" ");
    assert!(told.contains("tool 4 mm wide"), "{told}");
    let output = leadscrew(&[
        "plot",
        "examples/shaft.nc",
        "--tool-width",
        "4",
        "-o",
        "x.svg",
    ]);
    assert_eq!(code(&output), 2);
    assert!(
        stderr(&output).contains("`4` is no width"),
        "{}",
        stderr(&output)
    );
    let hit =
        "(STOCK X60 L100)\nT0101\nM3 S600\nG0 X64 Z10\nG0 X50 Z-20\nG1 X40 F100\nG0 X80\nM30\n";
    let hit = write(&folder, "hit.nc", hit);
    let told = texts(&folder, &hit, &[]).join("\n");
    assert!(
        told.contains("⚠ line 5: rapid through the material"),
        "{told}"
    );
    // Of the moves of a line that alone is marked which is in the material, where it gets in, once for each.
    let twice = "(STOCK X60 L100)\nT0101\nM3 S600\nG0 X70 Z10\nZ-20\nG90 X64 Z-50 F100\nX59\nG0 X70 Z10\nX30\nG0 Z-10\nG0 Z10\n\
                 G0 X80\nM30\n";
    let twice = write(&folder, "twice.nc", twice);
    let picture = folder.file("twice.svg");
    let output = leadscrew(&["plot", &twice, "-o", &picture]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let svg = std::fs::read_to_string(&picture).unwrap();
    let of_class = |class: &str| svg.matches(&format!("class=\"{class}\"")).count();
    assert_eq!(
        (of_class("missing"), of_class("spot")),
        (3, 3),
        "{}",
        stderr(&output)
    );
}

#[test]
fn z_over_the_spindle_angle_is_told_to_be_ideal_where_it_is() {
    let folder = Folder::new("plot-phase");
    let program = "examples/o0013-g76-m68x6.nc";
    let ideal = "ideal spindle: add `--spindle-ripple`";
    let over = "over the spindle angle: from lowest to highest; filled: all 6 passes";
    let told = texts(&folder, program, &[]).join("\n");
    assert!(told.contains(ideal) && told.contains(over), "{told}");
    let told = texts(&folder, program, &["--spindle-ripple=10@5"]).join("\n");
    assert!(!told.contains(ideal) && told.contains(over), "{told}");
}

/// The data of a page: its strokes, and its way over time.
fn page_data(folder: &Folder, program: &str) -> Value {
    let page = plotted(folder, "data.html", program, &[]);
    serde_json::from_str(between(&page, "id=\"data\">", "</script>")).unwrap()
}

#[test]
fn each_move_is_drawn_by_the_zero_of_its_own_tool() {
    let folder = Folder::new("plot-tools");
    let program = "G10 P1 X0 Z0\nG10 P3 X-20. Z-15.\nG97 G98 M3 S300\nT0101\nG0 X42. Z2.\nX30.\nG1 Z-30. F500\n\
        G0 X42.\nX100. Z50.\nT0303\nG0 X42. Z2.\nX30.\nG1 Z-30. F500\nG0 X42.\nT0300\nM30\n";
    let program = write(&folder, "tools.nc", program);
    let data = page_data(&folder, &program);
    let numbers = |list: &Value| -> Vec<f64> {
        let list = list.as_array().unwrap().iter();
        list.map(|value| value.as_f64().unwrap()).collect()
    };
    let strokes = data["strokes"].as_array().unwrap().iter();
    let cuts: Vec<_> = strokes
        .filter(|stroke| stroke["k"] == "feed")
        .map(|stroke| (stroke["l"].as_u64().unwrap(), numbers(&stroke["p"])))
        .collect();
    let cut = vec![2.0, 15.0, -30.0, 15.0];
    assert_eq!(cuts, [(7, cut.clone()), (13, cut)]);
    // The way of the played tool lies on them.
    let run = &data["run"];
    let way = numbers(&run["l"])
        .into_iter()
        .zip(numbers(&run["x"]))
        .zip(numbers(&run["z"]));
    for line in [7.0, 13.0] {
        let on: Vec<_> = way.clone().filter(|((at, _), _)| *at == line).collect();
        assert!(on.len() > 100);
        for ((_, x), z) in on {
            assert!(x == 15.0 && (-30.0..=2.0).contains(&z), "{line}: {x} {z}");
        }
    }
}

#[test]
fn the_place_of_a_warning_is_by_the_zero_of_its_own_tool() {
    let folder = Folder::new("plot-marks");
    let cut = "G0 X50. Z5.\nX20. Z-10.\nX50.\nX100. Z50.\n";
    let program = format!(
        "O1\n(STOCK X40 L60)\nG10 P1 X0 Z0\nG10 P3 X-20. Z-15.\nG97 G98 M3 S300\nT0101\n{cut}T0303\n{cut}T0300\nM30\n"
    );
    let program = write(&folder, "marks.nc", &program);
    let svg = plotted(&folder, "marks.svg", &program, &[]);
    let spots = svg.split("<circle").filter(|one| one.contains("\"spot\""));
    let spots: Vec<_> = spots
        .map(|one| {
            let value = |key: &str| between(one, &format!(" {key}=\""), "\"");
            (value("cx"), value("cy"))
        })
        .collect();
    let (first, second) = spots.split_at(spots.len() / 2);
    assert!(!first.is_empty());
    assert_eq!(first, second);
}

#[test]
fn what_was_measured_is_of_the_moves_of_a_feature_and_not_of_its_lines() {
    let folder = Folder::new("plot-loop");
    let taps = "O1\nG98 G97 M3 S300\n#1=20\nWHILE[#1LE40]DO1\nG0 X0 Z5.\nM29 S300\nG84 Z[-#1] R-2. P500 F525\nG80\n\
        #1=#1+10\nEND1\nG0 Z60.\nM30\n";
    let taps = write(&folder, "taps.nc", taps);
    let told = texts(&folder, &taps, &[]).join("\n");
    assert_eq!(told.matches("overshoot 0 µm").count(), 3, "{told}");
    assert_eq!(told.matches("all 2 strokes").count(), 3, "{told}");
    let threads = "O1\nG97 M3 S300\nT0303\nG0 X40. Z10.\nM98 P20002\nG0 X60. Z50.\nM30\nO2\nG92 X29.2 W-20. F2.\nX28.6\n\
        X28.2\nX27.6\nG0 W-40.\nM99\n";
    let threads = write(&folder, "threads.nc", threads);
    let told = texts(&folder, &threads, &[]).join("\n");
    assert_eq!(told.matches("all 4 passes").count(), 2, "{told}");
    // Nobody has said where the face is.
    assert!(!told.contains("missing"), "{told}");
    assert!(told.contains("the face is not known"), "{told}");
}

#[test]
fn of_a_thread_that_begins_behind_the_face_no_lead_in_is_missing() {
    let folder = Folder::new("plot-behind");
    let program = "O1\n(STOCK X40 L120)\nG97 M3 S300\nT0303\nG0 X45. Z5.\nG92 X39.2 Z-20. F2.\nX38.6\nG0 X45. Z-30.\n\
        G92 X35.2 Z-60. F3.\nX34.6\nG0 X60. Z50.\nM30\n";
    let program = write(&folder, "behind.nc", program);
    let told = texts(&folder, &program, &[]);
    let count = |part: &str| told.iter().filter(|text| text.contains(part)).count();
    assert_eq!(count("missing before"), 0, "{told:?}");
    assert_eq!(count("begins behind the face: lead-in"), 1, "{told:?}");
    assert_eq!(count("mm to spare"), 1, "{told:?}");
    assert_eq!(
        told.iter().filter(|text| *text == "face Z0").count(),
        1,
        "{told:?}"
    );
}

/// A program with sixty lines of rapids through the material.
fn many_rapids(folder: &Folder) -> String {
    let rapids = "G0 X30. Z-10.\nX50. Z-20.\n".repeat(30);
    let program = format!("O1\n(STOCK X40 L60)\nG97 M3 S300\nG0 X50. Z5.\n{rapids}M30\n");
    write(folder, "many.nc", &program)
}

#[test]
fn of_many_rapids_through_the_material_a_few_lines_are_told() {
    let folder = Folder::new("plot-rapids");
    let program = many_rapids(&folder);
    let told = texts(&folder, &program, &[]);
    let of: Vec<_> = told.iter().filter(|text| text.starts_with('⚠')).collect();
    assert_eq!(of[..3].len() + 1, of.len(), "{of:?}");
    assert!(of[2].contains("line 7: rapid"), "{of:?}");
    assert!(of[3].contains("further lines, 8 to "), "{of:?}");
}

/// The warnings beside the path of a page.
fn warnings(page: &str) -> Vec<&str> {
    let Some((_, list)) = page.split_once("<ul id=\"warnings\"") else {
        return Vec::new();
    };
    let (list, _) = list.split_once("</ul>").unwrap();
    let items = list.split("<li").skip(1);
    items
        .map(|item| item.trim_end().trim_end_matches("</li>"))
        .collect()
}

#[test]
fn a_page_has_the_stock_and_the_warnings_of_the_picture() {
    let folder = Folder::new("plot-page");
    let program = "(STOCK X60 L100)\nT0101\nM3 S600\nG0 X64 Z10\nG0 X50 Z-20\nG1 X40 F100\nG0 X80\nG0 X64 Z-60\nG1 X46 F100\n\
        G0 Z-80\nG0 X80\nM30\n";
    let program = write(&folder, "hit.nc", program);
    for lang in ["en", "zh"] {
        let told = texts(&folder, &program, &["--lang", lang]);
        let page = plotted(&folder, "hit.html", &program, &["--lang", lang]);
        let warnings = warnings(&page);
        let rapids = told
            .iter()
            .filter(|text| text.starts_with('⚠') && !text.contains("4987"));
        let rapids: Vec<_> = [5, 10, 11].iter().zip(rapids).collect();
        assert_eq!(rapids.len(), 3, "{told:?}");
        let items: Vec<_> = rapids
            .iter()
            .map(|(row, words)| format!(" data-line=\"{row}\">{words}"))
            .collect();
        assert_eq!(warnings, items);
        assert_eq!(page.matches("color:var(--warn)\">").count(), 1);
    }
    let data = page_data(&folder, &program);
    assert_eq!(data["stock"].to_string(), "[-100,0,0,30]");
    let marks = data["marks"].as_array().unwrap();
    assert_eq!(marks[0]["p"].to_string(), "[10,32,-20,25]");
    let row = |mark: &Value| {
        mark["l"]
            .as_u64()
            .filter(|l| mark["line"].as_str() == Some(&l.to_string()))
    };
    let rows: Vec<_> = marks.iter().map(row).collect();
    assert_eq!(rows, [5, 10, 11].map(Some));
    // Where nothing is wrong nothing is told, and what is not declared is not drawn.
    let data = page_data(&folder, "examples/o0008-g75-grooves.nc");
    assert_eq!(
        (&data["stock"], data["marks"].to_string()),
        (&Value::Null, "[]".into())
    );
}

#[test]
fn of_many_warnings_a_page_lists_as_many_as_a_report() {
    let folder = Folder::new("plot-listed");
    let program = many_rapids(&folder);
    let page = plotted(&folder, "many.html", &program, &[]);
    let warnings = warnings(&page);
    assert_eq!(warnings.len(), 10, "{warnings:?}");
    assert!(
        warnings[8].contains(": rapid through the material"),
        "{warnings:?}"
    );
    assert!(warnings[9].contains("further lines, "), "{warnings:?}");
}

#[test]
fn the_words_of_the_marks_of_a_thread_do_not_meet() {
    let folder = Folder::new("plot-plus");
    let program = "O1\n(STOCK X40 L60)\nG97 M4 S300\nG0 X45. Z-45.\nG92 X39.2 Z5. F2.\nX38.6\nG0 X60. Z50.\nM30\n";
    let program = write(&folder, "plus.nc", program);
    let svg = plotted(&folder, "plus.svg", &program, &[]);
    let height = |words: &str| {
        let (before, _) = svg.split_once(words).unwrap();
        let (_, tag) = before.rsplit_once("<text").unwrap();
        between(tag, " y=\"", "\"")
    };
    assert_ne!(height("face Z0"), height("run-out from Z4 to Z5"));
}
