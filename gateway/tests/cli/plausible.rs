//! What a program hardly means: one program for each rule, one beside it that is right, and the ways to say that it is
//! meant.

use serde_json::Value;

use crate::{Folder, code, leadscrew, stderr};

/// Numbers and lines of alarms and warnings.
fn found(program: &str) -> Vec<(u64, u64)> {
    let output = leadscrew(&["check", program, "--json"]);
    let result: Value = serde_json::from_slice(&output.stdout).unwrap();
    let mut found = Vec::new();
    for list in ["alarms", "warnings"] {
        for one in result["files"][0][list].as_array().unwrap() {
            found.push((one["no"].as_u64().unwrap(), one["line"].as_u64().unwrap()));
        }
    }
    found
}

/// A folder whose machine reads 0.001 mm.
fn shop(name: &str) -> Folder {
    let folder = Folder::new(name);
    std::fs::write(folder.file("leadscrew.toml"), "increment_is_c = 0\n").unwrap();
    folder
}

const THREAD: &str = "G97 M3 S300\nG0 X40 Z8\nG76 P011060 Q50 R0.05\n";

/// The number, the program, and one that says what was meant.
fn cases() -> Vec<(u64, String, String)> {
    let thread = |text: &str| format!("{THREAD}{text}\nM5\nM30\n");
    let groove = |text: &str| format!("G99 G97 M3 S500\nG0 X52 Z-5\nG75 R0.05\n{text}\nM5\nM30\n");
    let lines = |text: &str| format!("G97 M3 S1000\nG0 X50 Z2\n{text}\nM5\nM30\n");
    // To X50, at the end of the contour.
    let rough = |start: &str, words: &str, first: &str| {
        format!(
            "G97 M3 S500\nG99\n{start}\nG71 U2 R0.5\nGOTO 3\nN1 {first}\nG1 Z-20\nN2 X50\nN3 G71 P1 Q2 {words} F0.2\nM5\nM30\n"
        )
    };
    let face = |start: &str| {
        format!(
            "G97 M3 S500\nG99\n{start}\nG72 W2 R0.5\nGOTO 3\nN1 G0 Z-6\nG1 X40\nZ-3\nX20\nN2 Z1\nN3 G72 P1 Q2 W0.1 F0.2\nM5\nM30\n"
        )
    };
    let casting = |start: &str| {
        format!(
            "G97 M3 S500\nG99\n{start}\nG73 U3 W1 R3\nGOTO 3\nN1 G0 X20 Z1\nG1 Z-10\nN2 X40 Z-20\nN3 G73 P1 Q2 U0.4 F0.2\nM5\nM30\n"
        )
    };
    let one_block = |depth: &str| {
        let words = format!("U0.4 W0.1 {depth}");
        format!(
            "(DIALECT HAAS)\n{}",
            rough("G0 X50. Z2.", &words, "G0 X10.")
        )
    };
    let stock = |text: &str| format!("(STOCK X60 L100)\n{}", lines(&format!("X62\n{text}")));
    vec![
        // A height in units of 0.0001 mm.
        (
            4800,
            thread("G76 X12.12 Z-20 P12270 Q400 F2"),
            thread("G76 X17.546 Z-20 P1227 Q400 F2"),
        ),
        (
            4801,
            thread("G76 X17.546 Z-20 P1227 Q4000 F2"),
            thread("G76 X17.546 Z-20 P1227 Q400 F2"),
        ),
        (
            4981,
            thread("G76 X17.546 Z-20 P1227 Q4 F2"),
            thread("G76 X17.546 Z-20 P1227 Q400 F2"),
        ),
        (
            4802,
            groove("G75 X20 P20 F0.1"),
            groove("G75 X20 P2000 F0.1"),
        ),
        (
            4982,
            groove("G75 X48 P30000 F0.1"),
            groove("G75 X48 P4000 F0.1"),
        ),
        // A count of increments where millimetres are read: of a peck, and of the step to the next column.
        (
            4982,
            format!("(DIALECT GSK988)\n{}", groove("G75 X20 P3000 F0.1")),
            format!("(DIALECT GSK988)\n{}", groove("G75 X20 P3 F0.1")),
        ),
        (
            4982,
            groove("G75 X20 Z-30 P2000 Q3000000 F0.1"),
            groove("G75 X20 Z-30 P2000 Q3000 F0.1"),
        ),
        (
            4802,
            lines("G99 G83 Z-20 R-1 Q5 F0.1"),
            lines("G99 G83 Z-20 R-1 Q5000 F0.1"),
        ),
        (
            4982,
            lines("G99 G83 Z-20 R-1 Q5000000 F0.1"),
            lines("G99 G83 Z-20 R-1 Q30000 F0.1"),
        ),
        (4989, one_block("D0.002"), one_block("D2.")),
        (4803, lines("G98 G1 Z-20 F0.2"), lines("G99 G1 Z-20 F0.2")),
        (4803, lines("G99 G1 Z-20 F120"), lines("G98 G1 Z-20 F120")),
        (
            4808,
            lines("G98 G1 Z-20 C2 F100"),
            lines("G98 G1 Z-20 F100"),
        ),
        // 8400 mm/min where 8000 is the most, along Z and across it.
        (
            4806,
            lines("G99 S3000 G1 Z-20 F2.8"),
            lines("G99 S3000 G1 Z-20 F2.6"),
        ),
        (
            4806,
            lines("G99 S3000 G1 X2 F2.8"),
            lines("G99 S3000 G1 X2 Z-22 F2.8"),
        ),
        (
            4989,
            rough("G0 X50 Z2", "U-0.4 W0.1", "G0 X30"),
            rough("G0 X50 Z2", "U0.4 W0.1", "G0 X30"),
        ),
        (
            4989,
            rough("G0 X50 Z2", "U0.4 W-0.1", "G0 X30"),
            rough("G0 X50 Z2", "U0.4 W0", "G0 X30"),
        ),
        // A bore from the diameter of the drill.
        (
            4989,
            rough("G0 X50 Z2", "U0.4 W0.1", "G0 X60"),
            rough("G0 X50 Z2", "U-0.4 W0.1", "G0 X60"),
        ),
        // In one block, Δd stands in the line of the cycle; 10 mm is still meant.
        (4989, one_block("D11."), one_block("D10.")),
        (
            4990,
            rough("G0 X48 Z2", "U0.4 W0.1", "G0 X30"),
            rough("G0 X50 Z2", "U0.4 W0.1", "G0 X30"),
        ),
        (4990, face("G0 X60 Z0"), face("G0 X60 Z2")),
        (4990, casting("G0 X30 Z0"), casting("G0 X60 Z0")),
        // Beyond the travel as millimetres, and 5 mm as increments.
        (4991, lines("G0 Z1.5\nX5000"), lines("G0 Z1.5\nX5.")),
        (
            4987,
            stock("G0 X58 Z-20"),
            stock("G0 X60 Z-20\nG0 Z-100.02\nX0"),
        ),
        // Over what is turned, and not a shoulder further.
        (
            4987,
            stock("G1 X52 Z2 F200\nZ-30\nG0 X62\nZ2\nX52\nZ-30.2"),
            stock("G1 X52 Z2 F200\nZ-30\nG0 X62\nZ2\nX52\nZ-30"),
        ),
        // A gear of a switched spindle, under each kind of cut. Speeds of G96 are no turns a minute.
        (
            4978,
            lines("G98 S9 G1 Z-20 F100"),
            lines("G98 S10 G1 Z-20 F100"),
        ),
        (
            4978,
            lines("G98 S4 G2 X54 Z-2 R4 F100"),
            lines("G98 S4\nG0 Z5\nS600 G2 X54 Z-2 R4 F100"),
        ),
        (
            4978,
            lines("G99 S01 G75 X40 P1000 F0.1"),
            lines("G99 S10 G75 X40 P1000 F0.1"),
        ),
        (
            4978,
            lines("S9 G92 X49 Z-20 F2"),
            lines("G98 G96 S3 G1 Z-20 F100\nG97 S30"),
        ),
        (
            4978,
            lines("G0 X0\nS9 G84 Z-20 R-3 F2"),
            lines("G0 X0\nS20 G84 Z-20 R-3 F2"),
        ),
        // Half of a thin bar.
        (
            4989,
            format!("(STOCK X12 L100)\n{}", one_block("D3.1")),
            format!("(STOCK X12 L100)\n{}", one_block("D3.")),
        ),
        // A depth of 9 mm, and one of 8.
        (
            4807,
            stock("G0 X42\nG1 Z-30 F200"),
            stock("G0 X44\nG1 Z-30 F200"),
        ),
        (
            4807,
            format!("(STOCK X60 L100 X0=20)\n{}", lines("G0 X38\nG1 Z-30 F200")),
            format!("(STOCK X60 L100 X0=20)\n{}", lines("G0 X36\nG1 Z-30 F200")),
        ),
        // A shoulder that the tool comes up against is no depth, and a cut of a blade neither.
        (
            4807,
            stock("G0 X44\nG1 Z-30 F200\nX62\nG0 Z2\nX27\nG1 Z-28"),
            stock("G0 X44\nG1 Z-30 F200\nX62\nG0 Z2\nX44\nG1 Z-37.9\nX64\nG0 Z-60\nG1 X10"),
        ),
        (
            4985,
            lines("G92 X49 Z-20 F0.04"),
            lines("G92 X49 Z-20 F0.4 J0.5 K0.5"),
        ),
    ]
}

#[test]
fn each_doubt_is_told_at_its_line_and_what_was_meant_is_not() {
    let folder = shop("doubts");
    let program = folder.file("p.nc");
    for (number, odd, right) in cases() {
        std::fs::write(&program, &odd).unwrap();
        let line = odd.lines().position(|line| line == "M5").unwrap() as u64;
        let told = found(&program);
        assert!(told.contains(&(number, line)), "{number}: {told:?}\n{odd}");
        std::fs::write(&program, &right).unwrap();
        assert_eq!(found(&program), [], "{number}\n{right}");
    }
}

/// A head in front of the first O number is a program of its own, and ends where that stands.
#[test]
fn a_program_behind_blocks_without_an_end_is_told() {
    let folder = shop("head");
    let program = folder.file("p.nc");
    for (text, told) in [
        (
            "G21 G40\nO1\nM3 S500\nG98 G0 X50 Z2\nM30\n",
            &[(4977, 2)][..],
        ),
        ("G0 X50 Z2\nO1\nG0 X60\nM30\n", &[(4976, 1), (4977, 2)]),
        ("G0 X50 Z2\nM98 P2\nO2\nU1\nM99\n", &[(4976, 4)]),
        ("(HEAD)\nO1\nG0 X50 Z2\nM30\n", &[]),
        ("G21\n", &[]),
        ("(ALLOW 4977)\nG21\nO1\nG0 X60\nM30\n", &[]),
    ] {
        std::fs::write(&program, text).unwrap();
        assert_eq!(found(&program), told, "{text}");
    }
}

/// D1000 of an older Haas is 0.1 inch, and one stroke of 1000 inches here.
#[test]
fn a_depth_far_beyond_all_that_is_there_is_refused() {
    let folder = shop("far");
    let program = folder.file("p.nc");
    let one_block = |units: &str, x: &str, depth: &str| {
        format!(
            "(DIALECT HAAS)\n{units} G97 M3 S500\nG99\nG0 X{x} Z.1\nG71 P1 Q2 U.02 W.005 {depth} F.01\nN1 G0 X1.\nG1 Z-.5\nN2 X{x}\nM5\nM30\n"
        )
    };
    // The way is 12.7 and 10 mm.
    for (text, told) in [
        (one_block("G20", "2.", "D1000"), &[(62, 5)][..]),
        (one_block("G20", "2.", "D5.01"), &[(62, 5)]),
        (one_block("G20", "2.", "D4.99"), &[(4989, 5)]),
        (one_block("G21", "21.", "D101"), &[(62, 5)]),
        (one_block("G21", "21.", "D99"), &[(4989, 5)]),
        (one_block("G20", "2.", "D.1"), &[]),
        // A little is left, and the depth is one that tools take.
        (one_block("G20", "1.02", "D.2"), &[]),
    ] {
        std::fs::write(&program, &text).unwrap();
        assert_eq!(found(&program), told, "{text}");
    }
    std::fs::write(&program, one_block("G20", "2.", "D1000")).unwrap();
    let told = stderr(&leadscrew(&["check", &program]));
    assert!(
        told.contains("D of this cycle") && told.contains("D.08"),
        "{told}"
    );
    // Along Z, in two lines.
    let face = "G97 M3 S500\nG99\nG0 X60 Z1\nG72 W61 R0.5\nG72 P1 Q2 U0 W0.1 F0.2\nN1 G0 Z-5\nG1 X40\nN2 Z1\nM5\nM30\n";
    std::fs::write(&program, face).unwrap();
    assert_eq!(found(&program), [(62, 4)]);
    std::fs::write(&program, face.replace("W61", "W60")).unwrap();
    assert_eq!(found(&program), [(4989, 4)]);
}

#[test]
fn a_depth_of_g72_is_doubted_beside_the_length_of_the_stock() {
    let folder = shop("half");
    let program = folder.file("p.nc");
    let face = "G97 M3 S500\nG99\nG0 X60 Z2\nG72 W2 R0.5\nGOTO 3\nN1 G0 Z-6\nG1 X40\nZ-3\nX20\nN2 Z1\nN3 G72 P1 Q2 W0.1 F0.2\nM5\nM30\n";
    // It is told where it is written: in the first line of the cycle.
    for (length, told) in [("3.9", &[(4989, 5)][..]), ("4", &[])] {
        std::fs::write(&program, format!("(STOCK X60 L{length})\n{face}")).unwrap();
        assert_eq!(found(&program), told, "{length}");
    }
    // Of a tube it is half of the wall: 7 mm of this one.
    let turned = "G97 M3 S500\nG99\nG0 X60 Z2\nG71 U3.5 R0.5\nGOTO 3\nN1 G0 X50\nG1 Z-20\nN2 X60\nN3 G71 P1 Q2 U0.4 W0.1 F0.2\nM5\nM30\n";
    for (bore, told) in [("46.02", &[(4989, 5)][..]), ("46", &[])] {
        std::fs::write(&program, format!("(STOCK X60 L100 X0={bore})\n{turned}")).unwrap();
        assert_eq!(found(&program), told, "{bore}");
    }
    // Without a stock there is nothing to compare it with.
    std::fs::write(&program, face).unwrap();
    assert_eq!(found(&program), []);
}

#[test]
fn a_feed_above_the_nose_radius_is_refused_where_the_tool_has_one() {
    let folder = shop("nose-feed");
    let (program, machine) = (folder.file("p.nc"), folder.file("leadscrew.toml"));
    std::fs::write(
        &machine,
        "increment_is_c = 0\nnose_radius_3 = \"0.4 mm\"\nnose_radius_4 = \"-0.4 mm\"\n",
    )
    .unwrap();
    for (text, told) in [
        ("T0303\nG99 G1 X50 Z-5 F0.41", &[(4807, 4)][..]),
        ("T0303\nG99 G1 X50 Z-5 F0.4", &[]),
        ("T0404\nG99 G1 X50 Z-5 F0.41", &[(4807, 4)]),
        ("T0303\nG99 G2 X56 Z-5 R5 F0.5", &[(4807, 4)]),
        // Nothing is known of this nose, the spindle stands, or the feed is one per minute; a groove has a blade.
        ("T0505\nG99 G1 X50 Z-5 F0.5", &[]),
        ("T0303\nM5\nG99 G1 X50 Z-5 F0.5", &[]),
        ("T0303\nG98 G1 X50 Z-5 F500", &[]),
        ("T0303\nG99 G75 X40 P2000 F0.5", &[]),
        ("(ALLOW 4807)\nT0303\nG99 G1 X50 Z-5 F0.5", &[]),
    ] {
        std::fs::write(
            &program,
            format!("G97 M3 S500\nG0 X46 Z0\n{text}\nM5\nM30\n"),
        )
        .unwrap();
        let told_now: Vec<_> = found(&program)
            .into_iter()
            .filter(|(number, _)| *number == 4807)
            .collect();
        assert_eq!(told_now, told, "{text}");
    }
    std::fs::write(&program, "G97 M3 S500\nT0303\nG99 G1 X50 Z-5 F0.5\nM30\n").unwrap();
    let output = leadscrew(&["check", &program]);
    let told = stderr(&output);
    assert!(
        told.contains("alarm[4807]: this cut takes 0.5 mm where its insert takes 0.4 mm: "),
        "{told}"
    );
}

/// Programs whose rapids go near the stock or through where it was, with the lines that are told.
#[test]
fn a_rapid_is_told_where_the_stock_still_is() {
    let folder = shop("stock");
    let program = folder.file("p.nc");
    let told = |text: &str| {
        std::fs::write(&program, text).unwrap();
        let told = found(&program);
        let lines: Vec<u64> = told.iter().map(|(_, line)| *line).collect();
        assert!(told.iter().all(|(number, _)| *number == 4987), "{told:?}");
        lines
    };
    let bar = "(STOCK X60 L100)\nG97 M3 S500\n";
    let tube = "(STOCK X60 L100 X0=20 Z1)\nG97 M3 S500\nG98\n";
    for (text, lines) in [
        // From power-up at X0 Z0 straight through the bar; none is declared in the second.
        ("(STOCK X60 L100)\nG0 X60 Z-20\nM30\n".to_owned(), vec![2]),
        ("(STOCK 60 BY 100)\nG0 X60 Z-20\nM30\n".into(), vec![]),
        // The hole is free, its wall is not, and the face is where it is declared.
        (format!("{tube}G0 X19 Z5\nZ-50\nZ0.5\nX22\nM30\n"), vec![7]),
        // Bored, then back through the bore; below it there is the wall.
        (
            format!("{tube}G0 X24 Z5\nG1 Z-50 F50\nX18\nG0 Z5\nX24\nZ-50\nX26\nM30\n"),
            vec![10],
        ),
        // Faced: the bar begins at the face.
        (
            format!("{tube}G0 Z5\nX62\nZ0\nG1 X18 F50\nG0 Z0.5\nX62\nZ-1\nX18\nM30\n"),
            vec![11],
        ),
        // Parted off, so that nothing is in front.
        (
            format!("{tube}G0 Z5\nX62\nZ-30\nG1 X19 F50\nG0 X62\nZ-10\nX0\nZ-29\nZ-31\nM30\n"),
            vec![],
        ),
        // An arc, and rapids on either side of it: from X40 Z0 to X60 Z-10, radius 10.
        (
            format!("{bar}G98\nG0 X40 Z2\nG1 Z0 F50\nG3 X60 Z-10 R10\nG0 Z2\nX50\nZ-1.2\nM30\n"),
            vec![],
        ),
        (
            format!("{bar}G98\nG0 X40 Z2\nG1 Z0 F50\nG3 X60 Z-10 R10\nG0 Z2\nX50\nZ-1.6\nM30\n"),
            vec![9],
        ),
        // The work piece moves with its zero: the tool stands at X10 Z-10 of it.
        (
            "(STOCK X60 L100)\nG50 X100 Z50\nG0 X62 Z-5\nG50 X10 Z-10\nG0 Z-12\nM30\n".into(),
            vec![5],
        ),
        // A groove and its neighbour.
        (
            format!(
                "{bar}G99\nG0 Z5\nX62\nZ-20\nG75 R0.5\nG75 X50 P3000 F0.1\nG0 X51\nX62\nZ-22\nX58\nM30\n"
            ),
            vec![12],
        ),
    ] {
        assert_eq!(told(&text), lines, "{text}");
    }
    // The place is told to a micrometre.
    let text = format!("{bar}G98\nG0 X70 Z2\nG0 X58 Z-20\nM30\n");
    std::fs::write(&program, text).unwrap();
    let output = leadscrew(&["check", &program]);
    let text = stderr(&output);
    assert!(text.contains("at X 59.98 mm, Z -16.357 mm"), "{text}");
}

#[test]
fn a_stock_that_cannot_be_read_is_told_with_its_place() {
    let folder = shop("no-stock");
    let program = folder.file("p.nc");
    std::fs::write(&program, "O1\n(STOCK X60 L100 D5)\nG0 X60 Z-20\nM30\n").unwrap();
    assert_eq!(found(&program), [(4995, 2)]);
    let output = leadscrew(&["check", &program]);
    assert_eq!(code(&output), 0);
    let text = stderr(&output);
    assert!(
        text.contains("p.nc:2:2") && text.contains("`(STOCK X60 L100)`"),
        "{text}"
    );
}

#[test]
fn increments_are_doubted_beyond_the_travel_beside_points_or_where_they_are_large() {
    let folder = shop("points");
    let program = folder.file("p.nc");
    for (text, told) in [
        ("G0 X5000 Z1.5\nM30\n", &[(4258, 1), (4991, 1)][..]),
        ("G0 X5000 Z1\nM30\n", &[(4258, 1), (4991, 1)]),
        ("G0 X900 Z1\nM30\n", &[(4258, 1)]),
        ("G0 X5000. Z1.5\nM30\n", &[(4258, 1)]),
        ("G0 X500 Z1.5\nM30\n", &[]),
        // Beyond the travel in both readings.
        ("G0 X590. Z1.5\nU20000\nM30\n", &[(4258, 2)]),
        ("G0 X590. Z1.5\nU5000\nM30\n", &[(4258, 2), (4991, 2)]),
    ] {
        std::fs::write(&program, text).unwrap();
        assert_eq!(found(&program), told, "{text}");
    }
}

#[test]
fn what_is_meant_is_allowed_by_the_program_or_by_the_machine_file() {
    let folder = shop("allowed");
    let (program, machine) = (folder.file("p.nc"), folder.file("leadscrew.toml"));
    for (number, odd, _) in cases() {
        let is_told = || found(&program).iter().any(|(told, _)| *told == number);
        std::fs::write(&machine, "increment_is_c = 0\n").unwrap();
        std::fs::write(&program, format!("O1 (ODD) (ALLOW {number})\n{odd}")).unwrap();
        assert!(!is_told(), "{number}");
        // Another number allows nothing of it, and neither does a text that is no comment of the first lines.
        let other = if number == 4800 { 4801 } else { 4800 };
        std::fs::write(&program, format!("(ALLOW {other})\n{odd}")).unwrap();
        assert!(is_told(), "{number}");
        let allow = format!("increment_is_c = 0\nallow = [{number}]\n");
        std::fs::write(&machine, allow).unwrap();
        std::fs::write(&program, &odd).unwrap();
        assert!(!is_told(), "{number}");
    }
    // What is no doubt cannot be silenced.
    std::fs::write(&machine, "allow = [4019]\n").unwrap();
    let output = leadscrew(&["check", &program]);
    assert_eq!(code(&output), 1);
    assert!(
        stderr(&output).contains("alarm[4417]"),
        "{}",
        stderr(&output)
    );
}

#[test]
fn codes_of_the_family_are_passed_in_the_simulation_and_refused_where_they_would_act() {
    let folder = shop("m-codes");
    let program = folder.file("p.nc");
    let text = "G97 M3 S500\nM13\nG0 X50 Z2\nM12\nM5\nM30\n";
    std::fs::write(&program, text).unwrap();
    assert_eq!(found(&program), [(4903, 2), (4903, 4)]);
    assert_eq!(code(&leadscrew(&["run", &program])), 0);
    std::fs::write(&program, text.replace("M13", "M77")).unwrap();
    assert_eq!(found(&program), [(4550, 2)]);
}
