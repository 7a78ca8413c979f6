//! Tables of the norms, as they are printed: limits that no formula gives exactly, and sizes that are only agreed on.

/// ISO 965-1 by the pitch, micrometres.
pub(crate) struct OfPitch {
    pub(crate) pitch: f64,
    /// Fundamental deviations g (and G), f and e; f and e are none of every pitch.
    pub(crate) g: f64,
    pub(crate) f: Option<f64>,
    pub(crate) e: Option<f64>,
    /// Td of grade 6: the major diameter of a bolt.
    pub(crate) major: f64,
    /// TD1 of grade 6: the minor diameter of a nut; none of the finest pitches.
    pub(crate) minor: Option<f64>,
}

const fn row(pitch: f64, g: f64, f: f64, e: f64, major: f64, minor: f64) -> OfPitch {
    const fn some(value: f64) -> Option<f64> {
        if value > 0.0 { Some(value) } else { None }
    }
    OfPitch {
        pitch,
        g,
        f: some(f),
        e: some(e),
        major,
        minor: some(minor),
    }
}

/// Pitch, deviations g, f and e, Td and TD1 of grade 6; 0 is none.
pub(crate) const BY_PITCH: [OfPitch; 25] = [
    row(0.2, 17.0, 0.0, 0.0, 56.0, 0.0),
    row(0.25, 18.0, 0.0, 0.0, 67.0, 0.0),
    row(0.3, 18.0, 0.0, 0.0, 75.0, 85.0),
    row(0.35, 19.0, 34.0, 0.0, 85.0, 100.0),
    row(0.4, 19.0, 34.0, 0.0, 95.0, 112.0),
    row(0.45, 20.0, 35.0, 0.0, 100.0, 125.0),
    row(0.5, 20.0, 36.0, 50.0, 106.0, 140.0),
    row(0.6, 21.0, 36.0, 53.0, 125.0, 160.0),
    row(0.7, 22.0, 38.0, 56.0, 140.0, 180.0),
    row(0.75, 22.0, 38.0, 56.0, 140.0, 190.0),
    row(0.8, 24.0, 38.0, 60.0, 150.0, 200.0),
    row(1.0, 26.0, 40.0, 60.0, 180.0, 236.0),
    row(1.25, 28.0, 42.0, 63.0, 212.0, 265.0),
    row(1.5, 32.0, 45.0, 67.0, 236.0, 300.0),
    row(1.75, 34.0, 48.0, 71.0, 265.0, 335.0),
    row(2.0, 38.0, 52.0, 71.0, 280.0, 375.0),
    row(2.5, 42.0, 58.0, 80.0, 335.0, 450.0),
    row(3.0, 48.0, 63.0, 85.0, 375.0, 500.0),
    row(3.5, 53.0, 70.0, 90.0, 425.0, 560.0),
    row(4.0, 60.0, 75.0, 95.0, 475.0, 600.0),
    row(4.5, 63.0, 80.0, 100.0, 500.0, 670.0),
    row(5.0, 71.0, 85.0, 106.0, 530.0, 710.0),
    row(5.5, 75.0, 90.0, 112.0, 560.0, 750.0),
    row(6.0, 80.0, 95.0, 118.0, 600.0, 800.0),
    row(8.0, 100.0, 118.0, 140.0, 710.0, 1000.0),
];

/// Upper limit of the step of diameters, pitch, Td2 and TD2 of grade 6, micrometres.
pub(crate) const PITCH_DIAMETER: [[f64; 4]; 37] = [
    [5.6, 0.35, 56.0, 75.0],
    [5.6, 0.5, 75.0, 100.0],
    [5.6, 0.6, 85.0, 112.0],
    [5.6, 0.7, 90.0, 118.0],
    [5.6, 0.75, 90.0, 118.0],
    [5.6, 0.8, 95.0, 125.0],
    [11.2, 0.75, 100.0, 132.0],
    [11.2, 1.0, 112.0, 150.0],
    [11.2, 1.25, 118.0, 160.0],
    [11.2, 1.5, 132.0, 180.0],
    [22.4, 1.0, 118.0, 160.0],
    [22.4, 1.25, 132.0, 180.0],
    [22.4, 1.5, 140.0, 190.0],
    [22.4, 1.75, 150.0, 200.0],
    [22.4, 2.0, 160.0, 212.0],
    [22.4, 2.5, 170.0, 224.0],
    [45.0, 1.0, 125.0, 170.0],
    [45.0, 1.5, 150.0, 200.0],
    [45.0, 2.0, 170.0, 224.0],
    [45.0, 3.0, 200.0, 265.0],
    [45.0, 3.5, 212.0, 280.0],
    [45.0, 4.0, 224.0, 300.0],
    [45.0, 4.5, 236.0, 315.0],
    [90.0, 1.5, 160.0, 212.0],
    [90.0, 2.0, 180.0, 236.0],
    [90.0, 3.0, 212.0, 280.0],
    [90.0, 4.0, 236.0, 315.0],
    [90.0, 5.0, 250.0, 335.0],
    [90.0, 5.5, 265.0, 355.0],
    [90.0, 6.0, 280.0, 375.0],
    [180.0, 2.0, 190.0, 250.0],
    [180.0, 3.0, 224.0, 300.0],
    [180.0, 4.0, 250.0, 335.0],
    [180.0, 6.0, 300.0, 400.0],
    [355.0, 3.0, 250.0, 335.0],
    [355.0, 4.0, 280.0, 375.0],
    [355.0, 6.0, 315.0, 425.0],
];

/// Coarse pitches of ISO 261: the pitch of a size that is written without one.
pub(crate) const COARSE: [(f64, f64); 22] = [
    (3.0, 0.5),
    (4.0, 0.7),
    (5.0, 0.8),
    (6.0, 1.0),
    (8.0, 1.25),
    (10.0, 1.5),
    (12.0, 1.75),
    (14.0, 2.0),
    (16.0, 2.0),
    (18.0, 2.5),
    (20.0, 2.5),
    (22.0, 2.5),
    (24.0, 3.0),
    (27.0, 3.0),
    (30.0, 3.5),
    (33.0, 3.5),
    (36.0, 4.0),
    (39.0, 4.0),
    (42.0, 4.5),
    (48.0, 5.0),
    (56.0, 5.5),
    (64.0, 6.0),
];

/// ASME B1.20.1: size, outside diameter of the pipe, threads per inch, L1 (hand-tight engagement); inches.
pub(crate) const NPT: [(&str, f64, f64, f64); 10] = [
    ("1/16", 0.3125, 27.0, 0.160),
    ("1/8", 0.405, 27.0, 0.1615),
    ("1/4", 0.540, 18.0, 0.2278),
    ("3/8", 0.675, 18.0, 0.240),
    ("1/2", 0.840, 14.0, 0.320),
    ("3/4", 1.050, 14.0, 0.339),
    ("1", 1.315, 11.5, 0.400),
    ("1-1/4", 1.660, 11.5, 0.420),
    ("1-1/2", 1.900, 11.5, 0.420),
    ("2", 2.375, 11.5, 0.436),
];

/// Limits of the steps of nominal diameters (ISO 965-1).
const STEPS: [f64; 10] = [0.99, 1.4, 2.8, 5.6, 11.2, 22.4, 45.0, 90.0, 180.0, 355.0];

/// The row of a diameter and its pitch: Td2 and TD2.
pub(crate) fn pitch_diameter(d: f64, p: f64) -> Option<[f64; 2]> {
    let upper = STEPS[1..].iter().find(|limit| d <= **limit)?;
    let known = |row: &&[f64; 4]| d > STEPS[0] && row[0] == *upper && row[1] == p;
    PITCH_DIAMETER
        .iter()
        .find(known)
        .map(|row| [row[2], row[3]])
}

/// The geometric mean of the step that a diameter is in.
pub(crate) fn mean_diameter(d: f64) -> f64 {
    let at = STEPS.iter().position(|limit| d <= *limit);
    let upper = at.unwrap_or(STEPS.len() - 1).max(1);
    (STEPS[upper - 1] * STEPS[upper]).sqrt()
}

/// One decade of R40 as the norm rounds it from 100 µm on.
const R40: [f64; 40] = [
    100.0, 106.0, 112.0, 118.0, 125.0, 132.0, 140.0, 150.0, 160.0, 170.0, 180.0, 190.0, 200.0,
    212.0, 224.0, 236.0, 250.0, 265.0, 280.0, 300.0, 315.0, 335.0, 355.0, 375.0, 400.0, 425.0,
    450.0, 475.0, 500.0, 530.0, 560.0, 600.0, 630.0, 670.0, 710.0, 750.0, 800.0, 850.0, 900.0,
    950.0,
];

/// The nearest value of the series R40, in whole micrometres: 26.5 is written 26, 47.5 is 48.
pub(crate) fn r40(um: f64) -> f64 {
    of_place(nearest(um))
}

/// So many steps of R40 on.
pub(crate) fn steps_on(um: f64, steps: i32) -> f64 {
    of_place(nearest(um) + steps)
}

/// Where in R40 a value is; 0 is 100 µm.
fn nearest(um: f64) -> i32 {
    let all = -80..80;
    let off = |place: &i32| (exact(*place) - um).abs();
    all.min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(0)
}

fn exact(place: i32) -> f64 {
    R40[place.rem_euclid(40) as usize] * 10_f64.powi(place.div_euclid(40))
}

fn of_place(place: i32) -> f64 {
    // A product with a tenth is not exact, and these end in a half.
    ((exact(place) * 10.0).round() / 10.0).round_ties_even()
}
