//! Grooves and turned contours made by formula, and the errors that are put into them.

use std::f64::consts::{SQRT_2, TAU};

use super::within;
use crate::{
    Contour, Cutter, Element, Grid, Mm, Place, Recess, Sample, Side, Size, Stock, Tool, Turned,
    Turns, Work, recess,
};

/// A groove 4 mm wide at Z-10 in a shaft of 54 mm, to a radius that depends on the angle.
fn groove(side: Side, width: f64, radius: impl Fn(f64) -> f64) -> Option<Recess> {
    let stock = Stock {
        side,
        radius: Mm(27.0),
        taper: 0.0,
        from: Mm(-15.0),
        face: Mm(-5.0),
    };
    let work = Work::new(stock, Grid::of(&stock));
    let mut cutter = Cutter::new(work, Tool::flat(Mm(width)));
    for n in 0..400 {
        let turn = f64::from(n) / 97.3;
        cutter.push(Sample {
            angle: Turns(turn),
            x: Mm(radius(turn)),
            z: Mm(-10.0),
            pass: 1,
        });
    }
    recess(&cutter.finish())
}

#[test]
fn a_perfect_groove_and_none() {
    for (side, radius) in [(Side::External, 20.0), (Side::Internal, 30.0)] {
        let found = groove(side, 4.0, |_| radius).unwrap();
        assert!((found.floor.mean - radius).abs() < 1e-6, "{found:?}");
        assert!(found.floor.high - found.floor.low < 1e-6, "{found:?}");
        // A wall is between two nodes.
        assert!((found.width.mean - 4.0).abs() <= 0.002_001, "{found:?}");
        assert!((found.walls[0].mean + 12.0).abs() <= 0.001_001, "{found:?}");
        assert!((found.walls[1].mean + 8.0).abs() <= 0.001_001, "{found:?}");
    }
    assert_eq!(groove(Side::External, 4.0, |_| 27.5), None);
}

#[test]
fn errors_of_a_groove() {
    let wide = groove(Side::External, 4.05, |_| 20.0).unwrap();
    within(wide.width.mean - 4.0, 0.05, 0.05);
    let high = groove(Side::External, 4.0, |_| 20.03).unwrap();
    within(high.floor.mean - 20.0, 0.03, 0.05);
    let oval = groove(Side::External, 4.0, |turn| {
        20.0 + 0.02 * (2.0 * TAU * turn).cos()
    });
    let floor = oval.unwrap().floor;
    within(floor.high - floor.low, 0.04, 0.05);
    // What is off the axis has everywhere the same diameter.
    let off = groove(Side::External, 4.0, |turn| 20.0 + 0.02 * (TAU * turn).cos());
    let floor = off.unwrap().floor;
    assert!(floor.high - floor.low < 0.001, "{floor:?}");
}

fn at(z: f64, r: f64) -> Place {
    (Mm(z), Mm(r))
}

/// A chamfer, a cylinder of 40 mm, a fillet of 5 mm and a shoulder, toward the chuck.
fn shaft() -> Vec<Element> {
    let line = |from, to| Element {
        from,
        to,
        arc: None,
    };
    vec![
        line(at(0.0, 18.0), at(-2.0, 20.0)),
        line(at(-2.0, 20.0), at(-30.0, 20.0)),
        Element {
            from: at(-30.0, 20.0),
            to: at(-35.0, 25.0),
            arc: Some((at(-30.0, 25.0), true)),
        },
        line(at(-35.0, 25.0), at(-35.0, 30.0)),
    ]
}

/// The programmed place at a share of an element of the shaft.
fn place(n: usize, share: f64) -> (f64, f64) {
    let element = shaft()[n];
    if element.arc.is_some() {
        let angle = -TAU / 4.0 - share * TAU / 4.0;
        return (-30.0 + 5.0 * angle.cos(), 25.0 + 5.0 * angle.sin());
    }
    let mix = |a: Mm, b: Mm| a.0 + (b.0 - a.0) * share;
    (
        mix(element.from.0, element.to.0),
        mix(element.from.1, element.to.1),
    )
}

/// The shaft, each place moved by a formula.
fn turned(side: Side, moved: impl Fn(usize, (f64, f64)) -> (f64, f64)) -> Vec<Turned> {
    let mut contour = Contour::new(&shaft(), side);
    for n in 0..shaft().len() {
        for k in 0..=1000 {
            let (z, r) = moved(n, place(n, f64::from(k) / 1000.0));
            contour.push(n, at(z, r));
        }
    }
    contour.finish().into_iter().map(Option::unwrap).collect()
}

#[test]
fn a_perfect_contour_has_its_sizes() {
    let found = turned(Side::External, |_, place| place);
    for part in &found {
        assert!(
            part.off.low.abs() < 1e-9 && part.off.high.abs() < 1e-9,
            "{part:?}"
        );
    }
    let sizes: Vec<Size> = found.iter().map(|part| part.size.unwrap()).collect();
    let [
        Size::Cone(cone),
        Size::Cylinder(cylinder),
        Size::Arc(arc),
        Size::Face(face),
    ] = sizes[..]
    else {
        panic!("{sizes:?}");
    };
    assert!((cone.0 - 45.0).abs() < 1e-9 && (cylinder.mean - 40.0).abs() < 1e-9);
    assert!((arc.0 - 5.0).abs() < 1e-9 && (face.mean + 35.0).abs() < 1e-9);
}

#[test]
fn errors_of_a_contour() {
    // All of it 5 µm too large, away from the axis and from the chuck.
    let found = turned(Side::External, |n, (z, r)| match n {
        1 => (z, r + 0.005),
        3 => (z + 0.005, r),
        _ => (z, r),
    });
    let Some(Size::Cylinder(diameter)) = found[1].size else {
        panic!("{found:?}")
    };
    within(diameter.mean - 40.0, 0.01, 0.05);
    within(found[1].off.mean, 0.005, 0.05);
    within(found[3].off.mean, 0.005, 0.05);
    // The same in a bore is material that is missing.
    let found = turned(Side::Internal, |_, (z, r)| (z, r + 0.005));
    within(found[1].off.mean, -0.005, 0.05);
    // Half a degree more.
    let found = turned(Side::External, |n, (z, r)| {
        let lean = (45.5f64.to_radians()).tan();
        if n == 0 { (z, 18.0 - z * lean) } else { (z, r) }
    });
    let Some(Size::Cone(angle)) = found[0].size else {
        panic!("{found:?}")
    };
    within(angle.0 - 45.0, 0.5, 0.05);
    // A fillet of 5.02 about the same centre: its material is missing.
    let found = turned(Side::External, |n, (z, r)| {
        let off = 1.004;
        if n == 2 {
            (-30.0 + (z + 30.0) * off, 25.0 + (r - 25.0) * off)
        } else {
            (z, r)
        }
    });
    let Some(Size::Arc(radius)) = found[2].size else {
        panic!("{found:?}")
    };
    within(radius.0 - 5.0, 0.02, 0.05);
    within(found[2].off.mean, -0.02, 0.05);
}

/// An outer corner that is rounded by 0.5 mm misses (√2 − 1) times as much.
#[test]
fn a_rounded_corner_is_the_worst_place() {
    let line = |from, to| Element {
        from,
        to,
        arc: None,
    };
    let corner = [
        line(at(-5.0, 10.0), at(-5.0, 20.0)),
        line(at(-5.0, 20.0), at(-30.0, 20.0)),
    ];
    let mut contour = Contour::new(&corner, Side::External);
    for k in 0..=1000 {
        let r = 10.0 + 9.5 * f64::from(k) / 1000.0;
        contour.push(0, at(-5.0, r));
    }
    for k in 0..=1000 {
        let angle = TAU / 4.0 * f64::from(k) / 1000.0;
        let (z, r) = (-5.5 + 0.5 * angle.cos(), 19.5 + 0.5 * angle.sin());
        contour.push(usize::from(k > 500), at(z, r));
    }
    for k in 0..=1000 {
        contour.push(1, at(-5.5 - 24.5 * f64::from(k) / 1000.0, 20.0));
    }
    let found: Vec<Turned> = contour.finish().into_iter().map(Option::unwrap).collect();
    // The way to the nearer of two lines square to each other.
    let most = 0.5 - 0.5 / SQRT_2;
    for part in &found {
        within(part.off.low, -most, 0.05);
        assert!(part.off.high.abs() < 1e-9, "{part:?}");
    }
}

/// A drive that is behind is where it was before, and not beside the contour.
#[test]
fn a_lag_along_the_way_is_no_error() {
    let mut contour = Contour::new(&shaft(), Side::External);
    let ways: Vec<(usize, (f64, f64))> = (0..4)
        .flat_map(|n| (0..=1000).map(move |k| (n, place(n, f64::from(k) / 1000.0))))
        .collect();
    for n in 400..ways.len() {
        let (z, r) = ways[n - 400].1;
        contour.push(ways[n].0, at(z, r));
    }
    for part in contour.finish().into_iter().flatten() {
        assert!(
            part.off.low.abs() < 1e-9 && part.off.high.abs() < 1e-9,
            "{part:?}"
        );
    }
}
