//! Removed volume against other ways to compute it.

use std::f64::consts::{PI, TAU};

use super::{Made, within};
use crate::{Chip, Cutter, Degrees, Grid, Mm, Nose, Sample, Side, Stock, Tool, Turns, Work};

/// A ring at a standing Z: area times the way of its centre of gravity (Pappus).
#[test]
fn a_ring() {
    let (radius, depth, tip) = (20.0, 1.5, 0.3);
    let tool = Tool::vee(Degrees(60.0), Nose::Round(Mm(tip)));
    let flat = 2.0;
    for (tool, is_flat) in [(tool, false), (Tool::flat(Mm(flat)), true)] {
        let stock = Stock {
            side: Side::External,
            radius: Mm(radius),
            taper: 0.0,
            from: Mm(-10.0),
            face: Mm(0.0),
        };
        let grid = Grid {
            angles: 90,
            step: Mm(0.0005),
        };
        let mut cutter = Cutter::new(Work::new(stock, grid), tool);
        for n in 0..=60 {
            cutter.push(Sample {
                angle: Turns(f64::from(n) / 50.0),
                x: Mm(radius - depth),
                z: Mm(-5.000_1),
                pass: 3,
            });
        }
        let work = cutter.finish();
        // Slices of the ring, by the width at each radius.
        let width = |height: f64| {
            if is_flat {
                return flat;
            }
            let (sin, cos) = (PI / 6.0).sin_cos();
            if height < tip * (1.0 - sin) {
                2.0 * (tip * tip - (tip - height).powi(2)).sqrt()
            } else {
                2.0 * (tip * cos + (height - tip * (1.0 - sin)) * sin / cos)
            }
        };
        let slices = 200_000;
        let thick = depth / f64::from(slices);
        let asked: f64 = (0..slices)
            .map(|n| {
                let height = (f64::from(n) + 0.5) * thick;
                width(height) * TAU * (radius - depth + height) * thick
            })
            .sum();
        within(work.removed().0, asked, 5e-4);
        let [(3, Chip { minus, plus })] = work.chips() else {
            panic!("{:?}", work.chips())
        };
        within(minus.0, plus.0, 1e-3);
    }
}

/// Points at random in the part: removed are those that the tool has come over, by its path and profile alone.
#[test]
fn a_thread_against_points_at_random() {
    let made = Made::ideal("M20x2.5-6g", Side::External, 18.2);
    let work = made.cut();
    let (stock, tip) = (made.stock(), made.thread.tip().0);
    let (low, high) = (made.radius(), stock.radius.0);
    // Where the last sample stands: the helix ends there.
    let last = made.samples(0).last().unwrap().angle.0;
    let from = stock.from.0;
    let points = leadscrew_seed::amount(200_000, 4_000_000);
    leadscrew_seed::volume(0x2545_f491, |seed| {
        let mut random = random(seed);
        let mut hits = 0u32;
        for _ in 0..points {
            let z = from - random() * from;
            let angle = random();
            // Even over the area between two radii.
            let r = (low * low + random() * (high * high - low * low)).sqrt();
            let height = r - low;
            let (sin, cos) = (PI / 6.0).sin_cos();
            let half = if height < tip * (1.0 - sin) {
                (tip * tip - (tip - height).powi(2)).max(0.0).sqrt()
            } else {
                tip * cos + (height - tip * (1.0 - sin)) * sin / cos
            };
            let over = (-2..=9).any(|turn| {
                let at = f64::from(turn) + angle;
                at <= last && at >= -2.0 && (z + at * made.lead).abs() < half
            });
            hits += u32::from(over);
        }
        let share = f64::from(hits) / f64::from(points);
        let asked = share * PI * (high * high - low * low) * -from;
        // Six standard deviations of the points.
        let spread = ((1.0 - share) / (share * f64::from(points))).sqrt();
        within(work.removed().0, asked, 6.0 * spread);
    });
}

/// Numbers from 0 to 1 (xorshift).
fn random(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed | 1;
    move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// What each pass removes adds up to what is missing at the end.
#[test]
fn chips_add_up() {
    let made = Made::ideal("M12x1.75-6g", Side::External, 10.8);
    let stock = made.stock();
    let mut cutter = Cutter::new(Work::new(stock, Grid::of(&stock)), made.tool);
    for pass in 1..=4u32 {
        for mut sample in made.samples(0) {
            sample.x = sample.x + Mm(0.25 * f64::from(4 - pass));
            sample.pass = pass;
            cutter.push(sample);
        }
        cutter.interrupt();
    }
    let work = cutter.finish();
    let once = made.cut();
    within(work.removed().0, once.removed().0, 1e-9);
    assert_eq!(work.chips().len(), 4);
    assert!(work.chips().iter().all(|(_, chip)| chip.whole().0 > 0.0));
}
