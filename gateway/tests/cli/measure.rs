//! `measure`: threads of programs, cut on the simulated machine and measured.

use super::*;

/// M40x3 in the middle of 6g, with the norm's tip: its flanks are 60° and its minor diameter is 36.2.
const GOOD: &str = "O0040\nG50 X80 Z20\nM3 S600\nT0303\nG0 X46 Z10\nG76 P020060 Q1500 R0.05 J1.9 K3\n\
                    G76 X36.18 Z-32 P18000 Q6000 F3\nG0 X80 Z20\nM5\nM30\n%\n";

fn measured(args: &[&str]) -> serde_json::Value {
    let output = leadscrew(&[&["measure", "--json"], args].concat());
    serde_json::from_slice(&output.stdout).unwrap_or_else(|_| panic!("{}", stderr(&output)))
}

#[track_caller]
fn near(value: &serde_json::Value, asked: f64, most: f64) {
    let value = value.as_f64().unwrap();
    assert!((value - asked).abs() <= most, "{value} instead of {asked}");
}

#[test]
fn a_good_thread_is_within_tolerance() {
    let folder = Folder::new("measure-good");
    let program = write(&folder, "good.nc", GOOD);
    let output = leadscrew(&["measure", &program, "--thread", "M40x3-6g"]);
    let told = stderr(&output);
    assert_eq!(code(&output), 0, "{told}");
    assert!(told.contains("thread 1, line 7: M40x3-6g\n"), "{told}");
    assert!(told.contains("GO goes on; NO-GO stays out"), "{told}");
    assert!(told.contains("  within tolerance\n"), "{told}");
    let result = measured(&[&program, "--thread", "M40x3-6g"]);
    assert_eq!(result["ok"], true);
    let thread = &result["threads"][0];
    // The tip of H/6 at 36.18 has its sharp end at 35.314; half a pitch wide are the flanks 2.598 above.
    near(&thread["pitch_mm"], 37.9121, 0.001);
    near(&thread["major_mm"], 39.78, 0.001);
    near(&thread["minor_mm"], 36.18, 0.001);
    near(
        &thread["wires_mm"],
        37.9121 + 3.0 * 1.732_05 - 2.598_08 + 0.0008,
        0.001,
    );
    near(&thread["lead_mm"], 3.0, 1e-6);
    near(&thread["lead_error_um"], 0.0, 0.01);
    near(&thread["drunkenness_um"], 0.0, 0.1);
    near(&thread["flank_deg"][0], 30.0, 1.0 / 60.0);
    near(&thread["flank_deg"][1], 30.0, 1.0 / 60.0);
    assert_eq!(thread["start_to_start_um"], serde_json::json!([0]));
    assert_eq!(
        (&thread["go"], &thread["no_go"]),
        (&true.into(), &true.into())
    );
    assert_eq!(thread["verdict"], "within");
    assert_eq!(thread["limits"], "table");
    assert_eq!(thread["tool"]["number"], 3);
    // What the passes take adds up.
    let passes = thread["passes"].as_array().unwrap();
    let sum: f64 = passes
        .iter()
        .map(|pass| pass["minus_mm3"].as_f64().unwrap() + pass["plus_mm3"].as_f64().unwrap())
        .sum();
    near(&thread["chip_mm3"], sum, 0.001);
}

#[test]
fn a_ring_at_the_end_of_a_stroke_is_no_thread() {
    let folder = Folder::new("measure-ring");
    let cycle = "G76 P020060 Q1500 R0.05 J1.9 K3\nG76 X36.18 Z-32 P18000 Q6000 F3\n";
    assert!(GOOD.contains(cycle));
    for speed in [100, 600, 1000, 2000] {
        for (what, cuts) in [
            ("run-out", cycle),
            // The strokes stop in the work, and the tool goes out of it while the spindle turns on.
            ("ring", "G92 X38 Z-32 F3\nX36.18\n"),
            ("rings", "G92 X38 Z-32 F3\nX36.18\nX36.18\n"),
        ] {
            let text = GOOD
                .replace(cycle, cuts)
                .replace("S600", &format!("S{speed}"));
            let program = write(&folder, "part.nc", &text);
            let thread = &measured(&[&program, "--thread", "M40x3-6g"])["threads"][0];
            let near = |key: &str, asked: f64, most: f64| {
                let found = thread[key].as_f64().unwrap();
                assert!(
                    (found - asked).abs() <= most,
                    "{what}, S{speed}: {key} {found} instead of {asked}"
                );
            };
            near("pitch_mm", 37.9121, 0.001);
            near("lead_error_um", 0.0, 0.1);
            near("drunkenness_um", 0.0, 0.5);
            assert_eq!(thread["verdict"], "within", "{what}, S{speed}");
            // From the first full groove at the face: the last turn or two belong to the end.
            let full = thread["full_mm"].as_f64().unwrap();
            assert!(full > 20.0, "{what}, S{speed}: {full}");
        }
    }
}

#[test]
fn what_was_assumed_is_told_in_both_languages() {
    let folder = Folder::new("measure-told");
    let program = write(&folder, "good.nc", GOOD);
    let told = stderr(&leadscrew(&["measure", &program]));
    assert!(
        told.contains("M40x3-6g (guessed; `--thread` says it)"),
        "{told}"
    );
    assert!(told.contains("tip radius 0.433 mm (assumed)"), "{told}");
    assert!(told.contains("face at Z0 (assumed)"), "{told}");
    let told = stderr(&leadscrew(&["measure", &program, "--lang", "zh"]));
    assert!(told.contains("M40x3-6g（推测；"), "{told}");
    assert!(told.contains("量规：通规可以通过；止规不能旋入"), "{told}");
    assert!(told.contains("  合格\n"), "{told}");
    let given = [
        "measure",
        &program,
        "--thread",
        "M40x3-6g",
        "--tool",
        "T3=V60:r0.433",
        "--face",
        "0",
        "--surface",
        "39.78",
    ];
    let told = stderr(&leadscrew(&given));
    assert!(
        !told.contains("assumed") && !told.contains("guessed"),
        "{told}"
    );
}

#[test]
fn a_chain_of_strokes_is_measured_as_one_thread() {
    let result = measured(&["examples/shop/nipple-g32.nc"]);
    let threads = result["threads"].as_array().unwrap();
    assert_eq!((threads.len(), &result["threads_along_x"]), (1, &0.into()));
    assert_eq!(threads[0]["thread"], "M40x2-6g");
    let passes = threads[0]["passes"].as_array().unwrap();
    assert_eq!(passes.len(), 4);
}

#[test]
fn what_is_declared_is_not_assumed() {
    let thread = &measured(&["examples/cycles/g32.nc"])["threads"][0];
    assert_eq!(
        (&thread["face_mm"], &thread["assumed"]["face"]),
        (&serde_json::json!(0), &false.into())
    );
    // A lead that changes is that of no norm, and the bar is no thicker than it was.
    let thread = &measured(&["examples/cycles/g34.nc"])["threads"][0];
    assert_eq!(thread["thread"], serde_json::Value::Null);
    near(&thread["surface_mm"], 40.0, 1e-6);
    // The first of two passes takes as much as the second: 21.7, then 21.1 at Z-16, 1:16 from the face.
    let thread = &measured(&["examples/shop/pipe-g92.nc"])["threads"][0];
    near(&thread["surface_mm"], 22.3 - 1.0, 1e-6);
    assert!(thread["assumed"]["surface"] == true);
    let folder = Folder::new("measure-stock");
    let program = "(STOCK X21 L60 Z0.5)\nM3 S350\nG0 X28 Z8\nG92 X21.7 Z-16 R-0.75 F1.8143\nX21.1\nG0 X60\nM30\n";
    let program = write(&folder, "pipe.nc", program);
    let thread = &measured(&[&program])["threads"][0];
    near(&thread["surface_mm"], 21.0, 1e-6);
    near(&thread["face_mm"], 0.5, 1e-6);
}

#[test]
fn a_bad_thread_fails() {
    // Its surface is turned to 40 and its groove is as deep as the basic profile: nothing is left for the clearance of g.
    let output = leadscrew(&["measure", "examples/shaft.nc"]);
    let told = stderr(&output);
    assert_eq!(code(&output), 1, "{told}");
    assert!(
        told.contains("GO does not go on; NO-GO stays out") && told.contains("OUT OF TOLERANCE"),
        "{told}"
    );
    // A sharper tool at the same diameter leaves more on the flanks.
    let sharp = measured(&["examples/shaft.nc", "--tool", "T3=V60:r0.2"]);
    near(&sharp["threads"][0]["root_radius_mm"], 0.2, 0.001);
    near(&sharp["threads"][0]["pitch_mm"], 38.5181, 0.001);
    // Another tool's edge is not that of this one.
    let other = measured(&["examples/shaft.nc", "--tool", "T1=V60:r0.2"]);
    near(&other["threads"][0]["root_radius_mm"], 0.433, 0.001);
    // A wrong angle comes out on the flank that the last pass cuts. The other one is the way in which the passes went down.
    let bent = measured(&["examples/shaft.nc", "--tool", "V28/28:r0.433"]);
    near(&bent["threads"][0]["flank_deg"][0], 28.0, 1.0 / 60.0);
    near(&bent["threads"][0]["flank_deg"][1], 30.0, 0.2);
}

#[test]
fn an_uneven_spindle_makes_a_drunken_thread() {
    let folder = Folder::new("measure-ripple");
    let program = write(&folder, "good.nc", GOOD);
    let even = measured(&[&program]);
    let uneven = measured(&[&program, "--spindle-ripple", "10@5"]);
    let sway =
        |result: &serde_json::Value| result["threads"][0]["drunkenness_um"].as_f64().unwrap();
    assert!(
        sway(&uneven) > 3.0 * sway(&even) + 0.05,
        "{} {}",
        sway(&even),
        sway(&uneven)
    );
    assert!(sway(&uneven) < 3.0);
}

/// What the ways of cutting in are for: which side of the tool works.
#[test]
fn the_chip_of_each_way_to_cut_in() {
    let folder = Folder::new("measure-cut-in");
    let shares: Vec<f64> = (0..5)
        .map(|way| {
            let text = format!(
                "O0001\nG50 X100 Z50\nM3 S200\nG00 X44 Z10\nG78 P01{way:02}60 Q0.08 R0.05 D1\n\
                 G78 X27.546 Z-30 P1.227 Q0.35 F2 J1.5 K1.5\nG00 X100 Z50\nM05\nM30\n"
            );
            let result = measured(&[&write(&folder, "p.nc", &text)]);
            let passes = result["threads"][0]["passes"].as_array().unwrap().clone();
            // The passes between the first, which has full sides, and the finishing one.
            let side = |key: &str| -> f64 {
                let between = &passes[1..passes.len() - 1];
                between.iter().map(|pass| pass[key].as_f64().unwrap()).sum()
            };
            side("minus_mm3") / (side("minus_mm3") + side("plus_mm3"))
        })
        .collect();
    let [centre, left, right, right_centre, left_right] = shares[..] else {
        panic!("{shares:?}")
    };
    assert!((centre - 0.5).abs() < 0.01, "{shares:?}");
    assert!(left > 0.7 || right > 0.7, "{shares:?}");
    assert!((left + right - 1.0).abs() < 0.05, "{shares:?}");
    assert!((left_right - 0.5).abs() < 0.2, "{shares:?}");
    assert!(
        (right_centre - 0.5).abs() < (right - 0.5).abs(),
        "{shares:?}"
    );
}

#[test]
fn two_threads_two_starts_and_none() {
    let two = measured(&["examples/g78-two-start.nc", "--thread", "M30x4P2-6g"]);
    let thread = &two["threads"][0];
    assert_eq!(thread["starts"], 2);
    near(&thread["lead_mm"], 4.0, 1e-6);
    near(&thread["start_to_start_um"][1], 0.0, 0.2);
    let inside = measured(&["examples/internal-taper.nc"]);
    assert_eq!(inside["threads"][0]["internal"], true);
    assert_eq!(inside["threads"][0]["verdict"], "not_judged");
    let none = leadscrew(&["measure", "examples/o0008-g75-grooves.nc"]);
    assert_eq!(code(&none), 0);
    assert!(
        stderr(&none).contains("the program cuts no thread"),
        "{}",
        stderr(&none)
    );
}

/// Cut by the norm: minor diameter at the face E0 - 0.8 p. E0, the pitch diameter at the face, is 0.75843 inch.
#[test]
fn a_pipe_thread_of_the_norm_is_good_without_its_tool() {
    let folder = Folder::new("measure-pipe");
    let text =
        "M3 S350\nG0 X26 Z6\nG92 X20.9 Z-14 R-0.625 F1.8143\nX20\nX19.4\nX18.687\nG0 X60\nM30\n";
    let program = write(&folder, "npt.nc", text);
    for name in ["1/2-14NPT", "1/2-14 NPT"] {
        let thread = &measured(&[&program, "--thread", name])["threads"][0];
        near(&thread["pitch_mm"], 0.75843 * 25.4, 0.005);
        assert_eq!(thread["verdict"], "within");
    }
}

/// Two starts of calls that each cut one: by Q, and by a start that is half a lead further away.
#[test]
fn starts_of_their_own_calls_are_one_thread() {
    let folder = Folder::new("measure-starts");
    let stroke = |x: &str, q: &str| format!("G0 X{x}\nG32 Z-25 F4{q}\nG0 X34\nZ8\n");
    let strokes = |q: &str| ["29.2", "28.4", "27.6"].map(|x| stroke(x, q)).concat();
    let (first, second) = (strokes(""), strokes(" Q180000"));
    let by_angle = format!("M3 S200\nG0 X34 Z8\n{first}{second}G0 X60\nM30\n");
    let passes = "G92 X29.2 Z-25 F4\nX28.4\nX27.6\n";
    let by_place = format!("M3 S200\nG0 X34 Z8\n{passes}G0 Z10\n{passes}G0 X60\nM30\n");
    for (file, text) in [("q.nc", by_angle), ("z.nc", by_place)] {
        let program = write(&folder, file, &text);
        for args in [&[&program[..]][..], &[&program, "--thread", "M30x4P2-6g"]] {
            let result = measured(args);
            let threads = result["threads"].as_array().unwrap();
            assert_eq!(threads.len(), 1, "{file}");
            let thread = &threads[0];
            assert_eq!(
                (&thread["thread"], &thread["starts"]),
                (&"M30x4P2-6g".into(), &2.into())
            );
            near(&thread["lead_mm"], 4.0, 1e-6);
            near(&thread["drunkenness_um"], 0.0, 0.1);
            near(&thread["start_to_start_um"][1], 0.0, 0.5);
        }
    }
}

/// A shift by hand that is an infeed along a flank is none of a start.
#[test]
fn passes_that_go_down_a_flank_are_one_start() {
    let folder = Folder::new("measure-flank");
    let text = "M3 S200\nG0 X34 Z8\nG92 X29.2 Z-25 F2\nG0 Z7.77\nG92 X28.4 Z-25 F2\nG0 Z7.54\nG92 X27.6 Z-25 F2\n\
                G0 X60\nM30\n";
    let thread = &measured(&[&write(&folder, "flank.nc", text)])["threads"][0];
    assert_eq!(
        (&thread["thread"], &thread["starts"]),
        (&"M30x2-6g".into(), &1.into())
    );
}

/// A name of fewer starts than are cut has another lead.
#[test]
fn a_name_with_other_starts_is_refused() {
    let folder = Folder::new("measure-lead");
    let text = "M3 S200\nG0 X34 Z8\nG92 X29.2 Z-25 F4 L2\nX28.4\nX27.6\nG0 X60\nM30\n";
    let program = write(&folder, "two.nc", text);
    let output = leadscrew(&["measure", &program, "--thread", "M30x2-6g"]);
    assert_eq!(code(&output), 2, "{}", stderr(&output));
    assert!(
        stderr(&output)
            .contains("one start with a lead of 2 mm, and line 3 cuts 2 starts with one of 4 mm"),
        "{}",
        stderr(&output)
    );
    let right = &measured(&[&program, "--thread", "M30x4P2-6g"])["threads"][0];
    assert_eq!(right["starts"], 2);
}

#[test]
fn grooves_and_contours_come_out_as_they_are_programmed() {
    let shaft = measured(&["examples/shaft.nc", "--tool-width", "T2=4"]);
    let grooves = shaft["grooves"].as_array().unwrap();
    assert_eq!(grooves.len(), 4);
    let first = &grooves[0];
    assert_eq!((&first["line"], &first["into"]), (&35.into(), &"x".into()));
    near(&first["width_mm"]["programmed"], 6.0, 1e-9);
    near(&first["width_mm"]["mean"], 6.0, 1e-5);
    near(&first["wall_minus_mm"]["mean"], -45.0, 1e-5);
    near(&first["wall_plus_mm"]["max"], -39.0, 1e-5);
    // Without a dwell the floor is a spiral: no deeper than programmed, and higher by less than a feed of 0.05 mm a turn.
    near(&first["floor_mm"]["programmed"], 34.0, 1e-9);
    near(&first["floor_mm"]["min"], 34.05, 0.05);
    near(&first["floor_mm"]["max"], 34.05, 0.05);
    // Roughing is not the surface.
    let contour = &shaft["contours"][0];
    let elements = contour["elements"].as_array().unwrap();
    let lines: Vec<u64> = elements
        .iter()
        .map(|one| one["line"].as_u64().unwrap())
        .collect();
    assert_eq!(lines, [22, 23, 24, 25, 26, 27, 28]);
    near(&elements[0]["angle_deg"]["mean"], 45.0, 0.001);
    near(&elements[1]["diameter_mm"]["mean"], 40.0, 0.000_5);
    near(&elements[2]["face_mm"]["mean"], -45.0, 0.000_5);
    near(&elements[5]["radius_mm"]["mean"], 5.0, 0.001);
    // Corners within the tolerance of 0.01 mm.
    near(&contour["least"]["off_um"], -5.0, 5.0);
    near(&contour["most"]["off_um"], 5.0, 5.0);
    assert_eq!(contour["internal"], false);
    let bore = measured(&["examples/shop/nose-bore.nc"]);
    assert_eq!(bore["contours"][0]["internal"], true);
}

#[test]
fn errors_of_grooves_and_contours_come_out() {
    // A tool that is wider by 0.05 mm.
    let wide = measured(&["examples/shaft.nc", "--tool-width", "T2=4.05"]);
    near(&wide["grooves"][0]["width_mm"]["mean"], 6.05, 0.002_5);
    near(&wide["grooves"][1]["width_mm"]["mean"], 4.05, 0.002_5);
    let told = stderr(&leadscrew(&["measure", "examples/shaft.nc"]));
    assert!(told.contains("add `--tool-width T2=MM`"), "{told}");
    // Axes that are behind cut a circle too small: a lag of 1/Kv by half of the square of what it is of a radian.
    let folder = Folder::new("measure-arc");
    let arc = "G97 G98 M3 S600\nT0101\nG0 X40 Z30\nG1 Z0 F2400\nG2 X120 Z-40 R40\nG0 X130\nM30\n";
    let arc = write(&folder, "arc.nc", arc);
    let limits = ["--set", "1828.X=20", "--set", "1828.Z=20"];
    let lag = measured(&[&[&arc, "--drive", "kv30"], &limits[..]].concat());
    let elements = lag["contours"][0]["elements"].as_array().unwrap();
    let radians_a_second: f64 = 40.0 / 40.0;
    let off = 40.0 / 2.0 * (radians_a_second / 30.0).powi(2);
    near(&elements[1]["radius_mm"]["mean"], 40.0 - off, 0.05 * off);
    near(&elements[1]["mean_um"], 1e3 * off, 0.2 * 1e3 * off);
}

/// Two faces at one place, which the slide has reached from either side, lie apart by its play; not where the board puts
/// the backlash in.
#[test]
fn backlash_that_is_put_in_cannot_be_measured() {
    let folder = Folder::new("measure-backlash");
    let plunge = "G1 X30 F200\nG0 X44\n";
    let text = format!(
        "G97 G98 M3 S600\nT0202\nG0 X44 Z20\nZ-10\n{plunge}Z-30\nZ-10\n{plunge}G0 X80 Z20\nM30\n"
    );
    let program = write(&folder, "faces.nc", &text);
    let drive = folder.file("loose.toml");
    let text = "name = \"loose\"\ntitle = \"Loose\"\nsource = [\n  \
                { fact = \"figures\", kind = \"assumed\", ref = \"\", verified = false },\n]\n\
                figures.kv_per_s = 100\nfigures.backlash_um = 40\nfigures.following_mm = 100\n";
    std::fs::write(&drive, text).unwrap();
    let drive = format!("Z={drive}");
    let args = [
        "--drive",
        &drive,
        "--set",
        "1828.Z=100",
        "--tool-width",
        "T2=4",
    ];
    let apart = |more: &[&str]| {
        let result = measured(&[&[program.as_str()], &args[..], more].concat());
        let face = &result["contours"][0]["elements"][0]["face_mm"];
        let [least, most] = ["min", "max"].map(|name| face[name].as_f64().unwrap());
        most - least
    };
    let near = |apart: f64, asked: f64| assert!((apart - asked).abs() <= 0.000_2, "{apart}");
    near(apart(&[]), 0.040);
    near(apart(&["--set", "1851.Z=0.03"]), 0.010);
    near(apart(&["--set", "1851.Z=0.04"]), 0.0);
    near(
        apart(&["--set", "1851.Z=0.04", "--set", "9070.Z=1000"]),
        0.0,
    );
}

/// A screw with a lead that is too long by 0.4 µm a millimetre, and a wave of 3 µm over 160 mm: what it does to a
/// thread and to a face is gone where the board takes it off.
#[test]
fn errors_of_the_pitch_that_are_taken_off_cannot_be_measured() {
    let folder = Folder::new("measure-pitch");
    let thread = write(&folder, "thread.nc", GOOD);
    let text = "G97 G98 M3 S600\nT0202\nG0 X44 Z20\nZ-60\nG1 X30 F200\nG0 X44\nG0 X80 Z20\nM30\n";
    let face = write(&folder, "face.nc", text);
    let drive = |name: &str, errors: &str| {
        let file = folder.file(&format!("{name}.toml"));
        let text = format!(
            "name = \"{name}\"\ntitle = \"A screw\"\nsource = [\n  \
             {{ fact = \"figures\", kind = \"assumed\", ref = \"\", verified = false }},\n]\n\
             figures.kv_per_s = 100\nfigures.backlash_um = 0\nfigures.following_mm = 100\n{errors}"
        );
        std::fs::write(&file, text).unwrap();
        format!("Z={file}")
    };
    let true_one = drive("true", "");
    let screw = drive(
        "screw",
        "figures.pitch_um_per_m = 400\nfigures.pitch_wave_um = 3\nfigures.pitch_wave_mm = 160\n",
    );
    let error = |z: f64| 0.4 * z + 3.0 * (z * core::f64::consts::TAU / 160.0).sin();
    let mut table = vec!["1861.Z=-200".to_owned(), "1862.Z=20".to_owned()];
    table.extend((0..16).map(|k| {
        let place = -200.0 + 20.0 * f64::from(k);
        format!("{}.Z={:.1}", 1871 + k, error(place))
    }));
    let told = |program: &str, drive: &str, taken_off: bool| {
        let mut args = vec![
            program,
            "--drive",
            drive,
            "--set",
            "1828.Z=100",
            "--tool-width",
            "T2=4",
        ];
        if taken_off {
            args.extend(table.iter().flat_map(|value| ["--set", value.as_str()]));
        }
        measured(&args)
    };
    let lead = |result: &serde_json::Value| result["threads"][0]["lead_mm"].as_f64().unwrap();
    let near = |value: f64, asked: f64, most: f64| {
        assert!((value - asked).abs() <= most, "{value} instead of {asked}");
    };
    near(lead(&told(&thread, &true_one, false)), 3.0, 2e-6);
    // The machine's Z is 20 mm less than the program's (G50).
    let slope = (error(-20.0) - error(-52.0)) / 32.0;
    near(
        lead(&told(&thread, &screw, false)),
        3.0 * (1.0 + slope / 1e3),
        5e-5,
    );
    near(lead(&told(&thread, &screw, true)), 3.0, 1e-5);
    let place = |result: &serde_json::Value| {
        result["contours"][0]["elements"][0]["face_mm"]["mean"]
            .as_f64()
            .unwrap()
    };
    let asked = place(&told(&face, &true_one, false));
    near(
        place(&told(&face, &screw, false)) - asked,
        error(-60.0) / 1e3,
        0.000_2,
    );
    near(place(&told(&face, &screw, true)), asked, 0.000_2);
}

/// Passes of one thread are less than a lead apart; at another diameter it is another thread, though it ends alike.
#[test]
fn strokes_at_another_diameter_are_another_thread() {
    let folder = Folder::new("measure-diameters");
    let pass = |x: &str| format!("G0 X40\nZ6\nG0 X{x}\nG32 Z-20 F2\n");
    let text = |passes: &[&str]| {
        let passes: String = passes.iter().map(|x| pass(x)).collect();
        format!("G97 M3 S300\nT0101\n{passes}G0 X60\nM30\n")
    };
    let told = |passes: &[&str]| {
        let program = write(&folder, "strokes.nc", &text(passes));
        let threads = measured(&[&program])["threads"].clone();
        let threads = threads.as_array().unwrap();
        let count = |thread: &serde_json::Value| thread["passes"].as_array().unwrap().len();
        threads.iter().map(count).collect::<Vec<_>>()
    };
    assert_eq!(told(&["29.2", "28.4", "27.6"]), [3]);
    assert_eq!(told(&["29.2", "28.4", "27.6", "23.5", "22.9"]), [3, 2]);
}

#[test]
fn what_cannot_be_measured_is_told() {
    let o = "examples/shaft.nc";
    for (args, told) in [
        (vec!["--thread", "M40x3"], "it needs a tolerance class"),
        (
            vec!["--thread", "M40x3-6H"],
            "its class is one of the other side",
        ),
        (vec!["--thread", "M41-6g"], "no coarse pitch in the table"),
        (vec!["--thread", "G1"], "names are written"),
        (
            vec!["--thread", "M40x2-6g"],
            "has a pitch of 2 mm, and line 44 cuts one of 3 mm",
        ),
        (
            vec!["--thread", "M40x3-6g", "--thread", "M40x3-6g"],
            "names 2 threads, and the program has 1",
        ),
        (vec!["--tool", "V60"], "is no edge"),
        (
            vec!["-o", "part.bmp"],
            "the ending of the file chooses the format",
        ),
        (vec!["--bus", "vcan0"], "talks to no board"),
    ] {
        let output = leadscrew(&[&["measure", o], &args[..]].concat());
        assert_eq!(code(&output), 2, "{args:?}: {}", stderr(&output));
        assert!(
            stderr(&output).contains(told),
            "{args:?}: {}",
            stderr(&output)
        );
    }
    // The tool never reaches this surface.
    let output = leadscrew(&["measure", o, "--surface", "30"]);
    assert_eq!(code(&output), 1);
    assert!(
        stderr(&output).contains("there is no full groove to measure"),
        "{}",
        stderr(&output)
    );
}

/// docs/metrology.md shows the thread of the README's shaft on an uneven spindle.
#[test]
fn the_picture_of_the_page_is_current() {
    let folder = Folder::new("measure-picture");
    let picture = folder.file("thread.svg");
    let args = [
        "measure",
        "examples/shaft.nc",
        "--spindle-ripple=10@5",
        "-o",
        &picture,
    ];
    assert_eq!(code(&leadscrew(&args)), 1);
    golden(
        &root().join("docs/images/thread.svg"),
        &std::fs::read_to_string(&picture).unwrap(),
    );
}

#[test]
fn pictures_pages_and_results_as_files() {
    let folder = Folder::new("measure-files");
    let program = write(&folder, "good.nc", GOOD);
    let [page, result] = ["p.html", "p.json"].map(|name| folder.file(name));
    assert_eq!(
        code(&leadscrew(&[
            "measure", &program, "-o", &page, "--lang", "zh"
        ])),
        0
    );
    let text = std::fs::read_to_string(&page).unwrap();
    assert!(
        text.starts_with("<!DOCTYPE html>") && text.contains("<svg ") && text.contains("</html>")
    );
    assert!(
        text.contains("通规可以通过") && text.contains("最大实体"),
        "{text}"
    );
    // Nothing is fetched from elsewhere.
    assert!(!text.contains("<script") && !text.contains("<link") && !text.contains("src="));
    assert_eq!(code(&leadscrew(&["measure", &program, "-o", &result])), 0);
    let written: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(&result).unwrap()).unwrap();
    assert_eq!(written["threads"][0], measured(&[&program])["threads"][0]);
    let [picture, drawn] = ["p.png", "p.svg"].map(|name| folder.file(name));
    let output = leadscrew(&["measure", &program, "-o", &picture]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    assert_eq!(code(&leadscrew(&["measure", &program, "-o", &drawn])), 0);
    let size = crate::plot::twice_the_size(&picture, &drawn);
    assert!(stderr(&output).contains(&format!("p.png: {size}\n")));
}
