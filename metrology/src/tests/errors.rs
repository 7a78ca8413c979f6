//! Errors that are put in come out within a twentieth.

use std::f64::consts::TAU;

use super::{Made, within};
use crate::{Cutter, Degrees, Grid, Measured, Mm, Nose, Sample, Side, Work, measure};

fn bolt() -> Made {
    Made::ideal("M40x3-6g", Side::External, 37.9)
}

fn found(made: &Made) -> Measured {
    measure(&made.cut(), &made.thread).unwrap()
}

#[test]
fn a_ring_counts_only_where_nobody_says_that_the_helix_ends_before_it() {
    let made = bolt();
    let stock = made.stock();
    let mut cutter = Cutter::new(Work::new(stock, Grid::of(&stock)), made.tool);
    let stroke = made.samples(0);
    // Six turns, and where the seventh would begin the tool stands for two.
    let end = -6.0 * made.lead;
    for sample in stroke {
        let z = Mm(sample.z.0.max(end));
        cutter.push(Sample { z, ..sample });
    }
    let mut work = cutter.finish();
    let off = |work: &Work| measure(work, &made.thread).unwrap().lead.error.um().abs();
    assert!(off(&work) > 10.0, "{}", off(&work));
    work.keep_thread_between(Mm(end), Mm(f64::INFINITY));
    let found = measure(&work, &made.thread).unwrap();
    assert!(off(&work) < 0.1, "{}", off(&work));
    within(found.pitch.mean, 37.9, 1e-4);
    // A pitch before the ring the flanks are those of the thread.
    within(found.run_out.0, made.lead, 0.5);
}

#[test]
fn a_wrong_lead() {
    for error in [0.004, -0.0015] {
        let made = Made {
            lead: 3.0 + error,
            ..bolt()
        };
        let found = found(&made);
        within(found.lead.error.0, error, 0.05);
        // Seven turns lie between the first full groove at an angle and the last one.
        let turns = (found.full.0 / 3.0).floor();
        within(found.lead.cumulative.0, turns * error.abs(), 0.15);
        let (turns, last) = found.lead.course.last().copied().unwrap();
        within(last.0, turns.0 * error, 0.05);
        assert!(
            found.drunkenness.worst.um() < 0.1,
            "{:?}",
            found.drunkenness
        );
        // The gauge is narrower by the error over its length, times the flanks' cotangent.
        let more = found.functional.unwrap().diameter.0 - 37.9;
        let length = found.functional.unwrap().length.0 / 3.0;
        within(more, length * error.abs() * 3f64.sqrt(), 0.06);
    }
}

/// A left-hand thread goes towards the face while the part turns the same way.
#[test]
fn towards_the_face() {
    let made = Made {
        lead: 3.002,
        ..bolt()
    };
    let stock = made.stock();
    let mut cutter =
        crate::Cutter::new(crate::Work::new(stock, crate::Grid::of(&stock)), made.tool);
    for mut sample in made.samples(0) {
        sample.z = Mm(-made.turns * 3.0) - sample.z;
        cutter.push(sample);
    }
    let found = measure(&cutter.finish(), &made.thread).unwrap();
    within(found.lead.error.0, 0.002, 0.05);
    within(found.pitch.mean, 37.9, 1e-5);
    assert!(
        found.drunkenness.worst.um() < 0.1,
        "{:?}",
        found.drunkenness
    );
}

#[test]
fn a_drunken_thread() {
    for (order, amplitude) in [(1, 0.005), (2, 0.002), (5, 0.003)] {
        let made = Made {
            off: Box::new(move |turn, _| amplitude * (TAU * f64::from(order) * turn).sin()),
            ..bolt()
        };
        let found = found(&made);
        within(found.drunkenness.worst.0, 2.0 * amplitude, 0.05);
        within(
            found.drunkenness.repeated[order as usize - 1].0,
            amplitude,
            0.05,
        );
        assert!(found.lead.error.um().abs() < 0.05, "{:?}", found.lead.error);
        assert!(found.lead.cumulative.um() < 0.5);
    }
}

#[test]
fn starts_that_lie_wrong() {
    let mut made = Made::ideal("M30x4P2-6g", Side::External, 28.5);
    made.turns = 4.0;
    made.off = Box::new(|_, start| if start == 1 { 0.012 } else { 0.0 });
    let found = found(&made);
    let apart = found.starts[1].0 - found.starts[0].0;
    within(apart.abs(), 0.012, 0.05);
}

#[test]
fn a_second_pass_in_another_groove_makes_it_wider() {
    let shift = 0.02;
    let made = bolt();
    let stock = made.stock();
    let mut cutter =
        crate::Cutter::new(crate::Work::new(stock, crate::Grid::of(&stock)), made.tool);
    made.samples(0).into_iter().for_each(|s| cutter.push(s));
    cutter.interrupt();
    for mut sample in made.samples(0) {
        sample.z = sample.z + Mm(shift);
        sample.pass = 2;
        cutter.push(sample);
    }
    let work = cutter.finish();
    let found = measure(&work, &made.thread).unwrap();
    // The groove is wider by the shift at every height, so it is half a pitch wide deeper down.
    within(37.9 - found.pitch.mean, shift * 3f64.sqrt(), 0.05);
    let chip = work.chips()[1].1;
    assert!(
        chip.plus.0 > 1.0 && chip.minus.0 < 1e-3 * chip.plus.0,
        "{chip:?}"
    );
}

#[test]
fn wrong_flanks() {
    let mut made = bolt();
    made.tool.minus = Degrees(30.5);
    made.tool.plus = Degrees(28.0);
    let found = found(&made);
    within(found.flanks[0].mean - 30.0, 0.5, 0.05);
    within(30.0 - found.flanks[1].mean, 2.0, 0.05);
    within(found.root.0, made.thread.tip().0, 0.01);
    assert!(found.functional.unwrap().diameter.0 > found.pitch.mean + 0.005);
}

#[test]
fn another_tip() {
    for tip in [0.1, 0.2, 0.5] {
        let mut made = bolt();
        made.tool.nose = Nose::Round(Mm(tip));
        let found = found(&made);
        within(found.root.0, tip, 0.01);
        within(found.pitch.mean, 37.9, 1e-5);
        within(found.minor.mean, 2.0 * made.radius(), 1e-5);
    }
}

#[test]
fn a_part_without_a_thread() {
    let made = bolt();
    let stock = made.stock();
    let work = crate::Work::new(stock, crate::Grid::of(&stock));
    assert_eq!(measure(&work, &made.thread), Err(crate::NoThread));
    let mut ring = crate::Cutter::new(work, made.tool);
    for n in 0..100 {
        ring.push(crate::Sample {
            angle: crate::Turns(f64::from(n) * 0.03),
            x: Mm(18.0),
            z: Mm(-9.0),
            pass: 1,
        });
    }
    // One ring is a groove, but there is no crest between it and another.
    assert_eq!(measure(&ring.finish(), &made.thread), Err(crate::NoThread));
}
