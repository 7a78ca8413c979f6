//! G61 and G64: cuts that end in a stop, and cuts that are joined, on the simulated machine.

use serde_json::Value;

use crate::{Folder, code, leadscrew, stderr, stdout};

/// Ticks that a program takes, and X (a radius) and Z of its setpoints, in millimetres.
fn simulated(folder: &Folder, text: &str) -> (u64, Vec<(f64, f64)>) {
    let (program, table) = (folder.file("p.nc"), folder.file("p.csv"));
    std::fs::write(&program, text).unwrap();
    let output = leadscrew(&["simulate", &program, "--json", "-o", &table]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let result: Value = serde_json::from_str(&stdout(&output)).unwrap();
    let table = std::fs::read_to_string(&table).unwrap();
    let mut rows = table.lines().map(|row| row.split(',').collect::<Vec<_>>());
    let header = rows.next().unwrap();
    let column = |name: &str| header.iter().position(|column| *column == name).unwrap();
    let (x, z) = (column("x_nm"), column("z_nm"));
    let places = rows
        .map(|row| {
            (
                row[x].parse::<f64>().unwrap() / 1e6,
                row[z].parse::<f64>().unwrap() / 1e6,
            )
        })
        .collect();
    (result["ticks"].as_u64().unwrap(), places)
}

/// A quarter of a circle of 50 mm in chords of 0.1 mm.
fn chords(mode: &str) -> String {
    let mut text = format!("O1\n{mode} G97 M3 S500\nG0 X0 Z0\n");
    for chord in 1..=300 {
        let angle = f64::from(chord) * 0.1 / 50.0;
        let (x, z) = (100.0 * (1.0 - angle.cos()), -50.0 * angle.sin());
        text += &format!("G1 X{x:.3} Z{z:.3} F1000\n");
    }
    text + "M30\n"
}

#[test]
fn chords_are_cut_at_the_feed_and_stay_within_the_tolerance() {
    let folder = Folder::new("corners");
    let (stopping, _) = simulated(&folder, &chords("G61"));
    let (joined, places) = simulated(&folder, &chords("G64"));
    assert!(
        3 * joined < stopping,
        "{joined} ticks, {stopping} with stops"
    );
    // Chords of 0.1 mm are 0.025 µm from the circle, and their ends half a micrometre.
    let most = places
        .iter()
        .filter(|(x, z)| *z < 0.0 || *x > 0.0)
        .map(|(x, z)| ((x - 50.0).hypot(*z) - 50.0).abs())
        .fold(0.0, f64::max);
    assert!(most < 0.0107, "{most} mm from the circle");
}

#[test]
fn a_corner_is_rounded_under_g64_and_reached_under_g61() {
    let folder = Folder::new("corner");
    let text = |mode: &str| format!("{mode} G97 M3 S500\nG0 X20. Z0\nG1 Z-10. F200\nX40.\nM30\n");
    let nearest = |mode: &str| {
        let (_, places) = simulated(&folder, &text(mode));
        let off = places
            .iter()
            .map(|(x, z)| (x - 10.0).hypot(z + 10.0))
            .fold(f64::MAX, f64::min);
        (off, places.last().copied())
    };
    let (rounded, end) = nearest("G64");
    assert!((0.001..=0.01).contains(&rounded), "{rounded} mm");
    assert_eq!(end, Some((20.0, -10.0)));
    let (reached, end) = nearest("G61");
    assert_eq!((reached, end), (0.0, Some((20.0, -10.0))));
}

/// A half circle of `radius` in chords of 0.1 mm.
fn half_circle(radius: f64, feed: u32) -> String {
    let mut text = String::from("O1\nG64 G97 M3 S500\nG0 X0 Z0\n");
    let chords = (std::f64::consts::PI * radius / 0.1) as u32;
    for chord in 1..=chords {
        let angle = std::f64::consts::PI * f64::from(chord) / f64::from(chords);
        let (x, z) = (2.0 * radius * (1.0 - angle.cos()), -radius * angle.sin());
        text += &format!("G1 X{x:.3} Z{z:.3} F{feed}\n");
    }
    text + "M30\n"
}

#[test]
fn a_feed_that_the_machine_cannot_hold_is_no_slower_cut() {
    let folder = Folder::new("chords");
    for radius in [2.0, 10.0] {
        let ticks = |feed| simulated(&folder, &half_circle(radius, feed)).0;
        let first = ticks(1_500);
        for feed in [2_000, 3_000, 5_000, 8_000] {
            let took = ticks(feed);
            assert!(
                20 * took <= 21 * first,
                "radius {radius}: {took} ticks at F{feed}, {first} at F1500"
            );
        }
    }
}
