//! Chamfers and roundings: the figures of a program, every kind of corner, and corners by chance against what
//! a chamfer and a
//! rounding are: where the ends lie, how far apart, and which way they head.

use std::f64::consts::{PI, TAU};

use leadscrew_core::alarm::{Code, Span};
use leadscrew_core::units::Length;

use super::{Corner, Inserted, Toward, insert};
use crate::figures::{Chance, Stroke, assert_path, at, elements, is_same};
use crate::plane::{Element, Point, Shape};

fn millimetres(value: f64) -> Length {
    Length::from_nm((value * 1e6).round() as i64)
}

fn put(path: &[Element], start: Point, corner: Corner) -> Result<Inserted, Code> {
    insert(start, &path[0], path.get(1), corner, None, Span::default()).map_err(|alarm| alarm.code)
}

fn all(inserted: Inserted) -> Vec<Element> {
    let Inserted {
        first,
        between,
        second,
    } = inserted;
    [Some(first), between, Some(second)]
        .into_iter()
        .flatten()
        .collect()
}

#[track_caller]
fn gives(start: Point, text: &str, corner: Corner, expected: &str) {
    let path = elements(start, text);
    assert_path(
        start,
        &all(put(&path, start, corner).expect("it fits")),
        expected,
    );
}

#[test]
fn the_vectors() {
    let start = at(20.0, 2.0);
    let text = "F20,-20 F40,-20";
    gives(
        start,
        text,
        Corner::Chamfer(millimetres(2.0)),
        "F20,-18 F24,-20 F40,-20",
    );
    gives(
        start,
        text,
        Corner::ChamferLine(millimetres(2.0)),
        "F20,-18.585786 F22.828427,-20 F40,-20",
    );
    gives(
        start,
        text,
        Corner::Round(millimetres(3.0)),
        "F20,-17 A26,-20/3cw F40,-20",
    );
}

#[test]
fn both_hands_and_arcs() {
    let start = at(20.0, 0.0);
    // To the other hand.
    gives(
        start,
        "F20,-20 F10,-20",
        Corner::Round(millimetres(1.0)),
        "F20,-19 A18,-20/1ccw F10,-20",
    );
    // An arc of 10 that begins at a right angle: the rounding's centre is 11 from the arc's centre, and 1 from
    // the line.
    let text = "F20,-20 A40,-30/10ccw";
    let expected = "F20,-19.045549 A21.818182,-20.041408/1cw A40,-30/10ccw";
    gives(start, text, Corner::Round(millimetres(1.0)), expected);
    let path = elements(start, text);
    assert_eq!(
        put(&path, start, Corner::Round(millimetres(60.0))),
        Err(Code::CornerTooLong)
    );
    // The other end of the path.
    let back = "A20,-20/10cw F20,0";
    let expected = "A21.818182,-20.041408/10cw A20,-19.045549/1ccw F20,0";
    gives(
        at(40.0, -30.0),
        back,
        Corner::Round(millimetres(1.0)),
        expected,
    );
}

#[test]
fn what_is_refused() {
    let start = at(20.0, 2.0);
    let chamfer = |mm| Corner::Chamfer(millimetres(mm));
    let refused = |text: &str, corner, code| {
        assert_eq!(
            put(&elements(start, text), start, corner),
            Err(code),
            "{text}"
        );
    };
    refused("F20,-20", chamfer(1.0), Code::CornerNextMissing);
    refused("F20,-20 F20,-20", chamfer(1.0), Code::CornerNextMissing);
    refused("F20,-20 R40,-20", chamfer(1.0), Code::CornerNextWrong);
    refused("R20,-20 F40,-20", chamfer(1.0), Code::CornerNextWrong);
    refused("F20,-20 F40,-20", chamfer(10.1), Code::CornerTooLong);
    refused("F20,-20 F80,-20", chamfer(22.1), Code::CornerTooLong);
    refused(
        "F20,-20 F40,-20",
        Corner::Round(millimetres(10.1)),
        Code::CornerTooLong,
    );
    refused(
        "F20,-20 F40,-20",
        Corner::ChamferLine(millimetres(14.2)),
        Code::CornerTooLong,
    );
    refused(
        "F20,-20 F20,-10",
        Corner::Round(millimetres(1.0)),
        Code::CornerTooLong,
    );
    refused("F20,-20 F40,-20", chamfer(0.0), Code::CornerTooLong);
    refused(
        "F20,-20 F40,-20",
        Corner::Round(millimetres(-1.0)),
        Code::CornerTooLong,
    );
    // A leg may be all of its element, and a straight line has no corner.
    gives(
        start,
        "F20,-20 F40,-20",
        chamfer(10.0),
        "F20,-10 F40,-20 F40,-20",
    );
    gives(start, "F20,-20 F20,-40", chamfer(1.0), "F20,-20 F20,-40");
}

#[test]
fn a_sign_is_the_direction_of_the_next_motion() {
    let start = at(20.0, 2.0);
    let put = |text: &str, toward| {
        let path = elements(start, text);
        let corner = Corner::Chamfer(millimetres(1.0));
        insert(
            start,
            &path[0],
            path.get(1),
            corner,
            Some(toward),
            Span::default(),
        )
        .is_ok()
    };
    assert!(put("F20,-20 F40,-20", Toward::X(true)));
    assert!(put("F20,-20 F10,-20", Toward::X(false)));
    assert!(put("F40,2 F40,-20", Toward::Z(false)));
    assert!(!put("F20,-20 F40,-20", Toward::X(false)));
    assert!(!put("F20,-20 F40,-20", Toward::Z(true)));
    assert!(!put("F20,-20 F40,-21", Toward::X(true)));
    assert!(!put("F20,-20 A40,-10/10cw", Toward::X(true)));
}

/// The angle between two headings.
fn turned(a: f64, b: f64) -> f64 {
    (b - a + PI).rem_euclid(TAU) - PI
}

#[test]
fn corners_by_chance() {
    leadscrew_seed::volume(0x00c0_4e25, |seed| {
        let mut chance = Chance::new(seed);
        let mut done = [0; 2];
        for case in 0..leadscrew_seed::amount(5_000, 40_000) {
            let path = chance.path(2, 1e5, 3e7);
            let size = Length::from_nm(chance.size(1e4, 1e7) as i64);
            let corner = match chance.below(3) {
                0 => Corner::Chamfer(size),
                1 => Corner::ChamferLine(size),
                _ => Corner::Round(size),
            };
            let start = Point::default();
            match put(&path, start, corner) {
                Ok(inserted) => {
                    done[0] += usize::from(inserted.between.is_some());
                    check(&path, inserted, corner).unwrap_or_else(|why| {
                        panic!("seed {seed}, case {case}: {why}\n{corner:?} {path:?}")
                    });
                }
                Err(code) => {
                    assert_eq!(code, Code::CornerTooLong);
                    done[1] += 1;
                    if !is_too_long(&path, corner) {
                        panic!("seed {seed}, case {case}: refused\n{corner:?} {path:?}");
                    }
                }
            }
        }
        assert!(done[0] > 1000 && done[1] > 100, "{done:?}");
    });
}

/// What a corner has to be, measured.
fn check(path: &[Element], inserted: Inserted, corner: Corner) -> Result<(), String> {
    let start = Point::default();
    let Inserted {
        first,
        between,
        second,
    } = inserted;
    let whole = [
        Stroke::new(start, &path[0]),
        Stroke::new(path[0].end, &path[1]),
    ];
    let size = match corner {
        Corner::Chamfer(size) | Corner::ChamferLine(size) | Corner::Round(size) => size.nm() as f64,
    };
    let Some(between) = between else {
        // Tangent, or so nearly that the arc would be a few nanometres long.
        let turn = turned(whole[0].heading(1.0), whole[1].heading(0.0)).abs();
        let is_tangent = turn < 1e-4 || turn * size < 5.0;
        let is_kept = is_tangent && is_same(&first, &path[0]);
        return (is_kept || is_tip(&whole, first.end, corner, size))
            .then_some(())
            .ok_or("no corner".into());
    };
    let middle = Stroke::new(first.end, &between);
    let within = |what: &str, value: f64, expected: f64, room: f64| {
        let is_near = (value - expected).abs() <= room;
        is_near
            .then_some(())
            .ok_or(format!("{what} is {value}, expected {expected}"))
    };
    // Both ends lie on their elements, which are shorter than before.
    within("first end", whole[0].distance(middle.start), 0.0, 4.0)?;
    within("second start", whole[1].distance(middle.end), 0.0, 4.0)?;
    let left = [
        Stroke::new(start, &first),
        Stroke::new(between.end, &second),
    ];
    for (left, whole) in left.iter().zip(&whole) {
        if left.length() > whole.length() + 4.0 {
            return Err("an element has become longer".into());
        }
    }
    // An element that would be left with less than four nanometres is taken whole.
    let is_all = left.iter().any(|left| left.length() == 0.0);
    let spare = if is_all { 4.0 } else { 0.0 };
    let edge = whole[0].end;
    let leg = |place: (f64, f64)| (place.0 - edge.0).hypot(place.1 - edge.1);
    match corner {
        Corner::Chamfer(_) => {
            within("first leg", leg(middle.start), size, 3.0 + spare)?;
            within("second leg", leg(middle.end), size, 3.0 + spare)
        }
        Corner::ChamferLine(_) => {
            within("length", middle.length(), size, 4.0 + spare)?;
            within("legs", leg(middle.start), leg(middle.end), 3.0 + spare)
        }
        Corner::Round(_) => {
            let Some((centre, swept)) = middle.arc else {
                return Err("no arc".into());
            };
            let radius = |place: (f64, f64)| (place.0 - centre.0).hypot(place.1 - centre.1);
            within("radius at the start", radius(middle.start), size, 3.0)?;
            within("radius at the end", radius(middle.end), size, 3.0)?;
            let room = |stroke: &Stroke| 1e-6 + 8.0 / size + 8.0 / stroke.length();
            for (stroke, share, own) in [(&left[0], 1.0, 0.0), (&left[1], 0.0, 1.0)] {
                if stroke.length() > 1_000.0 {
                    let turn = turned(stroke.heading(share), middle.heading(own));
                    within("angle", turn, 0.0, room(stroke))?;
                }
            }
            (swept.abs() < PI + 0.01 || whole.iter().any(|whole| whole.arc.is_some()))
                .then_some(())
                .ok_or("the arc goes the long way round".into())
        }
    }
}

/// True where a chamfer has taken a tip away: its ends are one place, which lies on both elements.
fn is_tip(whole: &[Stroke; 2], end: Point, corner: Corner, size: f64) -> bool {
    let place = (end.x.nm() as f64, end.z.nm() as f64);
    let edge = whole[0].end;
    let leg = (place.0 - edge.0).hypot(place.1 - edge.1);
    matches!(corner, Corner::Chamfer(_))
        && (leg - size).abs() <= 3.0
        && whole.iter().all(|stroke| stroke.distance(place) <= 8.0)
}

#[test]
fn a_chamfer_whose_ends_are_one_place_takes_the_tip_away() {
    // The line comes back along the end of the arc, and crosses the arc where the legs end.
    let path = [
        Element {
            end: Point::from_nm(-157_624, 53_345),
            shape: Shape::Arc {
                i: Length::from_nm(-78_785),
                k: Length::from_nm(26_752),
                clockwise: true,
            },
            span: Span::default(),
        },
        Element {
            end: Point::from_nm(1_223_369, 3_383_714),
            shape: Shape::Line,
            span: Span::default(),
        },
    ];
    let corner = Corner::Chamfer(Length::from_nm(11_291));
    let inserted = put(&path, Point::default(), corner).expect("it fits");
    assert_eq!(inserted.between, None);
    assert_ne!(inserted.first.end, path[0].end);
    check(&path, inserted, corner).expect("a tip");
}

#[test]
fn a_leg_that_is_all_of_an_arc_leaves_no_full_circle() {
    let arc = |end: (i64, i64), i, k| Element {
        end: Point::from_nm(end.0, end.1),
        shape: Shape::Arc {
            i: Length::from_nm(i),
            k: Length::from_nm(k),
            clockwise: false,
        },
        span: Span::default(),
    };
    // The chord of the second arc is half a nanometre shorter than the leg, and half a nanometre is rounding.
    let path = [
        arc((502_928, 738_881), 125_950, 454_873),
        arc((474_937, 632_877), -55_726, -41_983),
    ];
    let corner = Corner::Chamfer(Length::from_nm(109_638));
    let inserted = put(&path, Point::default(), corner).expect("it fits");
    check(&path, inserted, corner).expect("no full circle");
    assert_eq!(inserted.second.shape, Shape::Line);
    assert_eq!(inserted.between.map(|it| it.end), Some(path[1].end));
    // The same at the end of the first motion: the path the other way round.
    let begin = path[1].end;
    let back = |end: Point, centre: (i64, i64), start: Point| Element {
        end: Point::from_nm(end.x.nm() - begin.x.nm(), end.z.nm() - begin.z.nm()),
        shape: Shape::Arc {
            i: Length::from_nm(centre.0 - start.x.nm()),
            k: Length::from_nm(centre.1 - start.z.nm()),
            clockwise: true,
        },
        span: Span::default(),
    };
    let path = [
        back(path[0].end, (447_202, 696_898), begin),
        back(Point::default(), (125_950, 454_873), path[0].end),
    ];
    let inserted = put(&path, Point::default(), corner).expect("it fits");
    check(&path, inserted, corner).expect("no full circle");
    assert_eq!(inserted.first.shape, Shape::Line);
    assert_eq!(inserted.first.end, Point::default());
}

/// There is no place for it on both elements: found by trying.
fn is_too_long(path: &[Element], corner: Corner) -> bool {
    let a = Stroke::new(Point::default(), &path[0]);
    let b = Stroke::new(path[0].end, &path[1]);
    let edge = a.end;
    let leg = |place: (f64, f64)| (place.0 - edge.0).hypot(place.1 - edge.1);
    const STEPS: u32 = 4000;
    let shares = || (0..=STEPS).map(|step| f64::from(step) / f64::from(STEPS));
    let reach = |stroke: &Stroke| {
        shares()
            .map(|share| leg(stroke.place(share)))
            .fold(0.0, f64::max)
    };
    match corner {
        Corner::Chamfer(size) => size.nm() as f64 >= reach(&a).min(reach(&b)) - 2.0,
        Corner::ChamferLine(size) => {
            // The widest line between two equal legs, before one of the elements comes back.
            let size = size.nm() as f64;
            let far = reach(&a).min(reach(&b));
            let at_leg = |stroke: &Stroke, from_end: bool, wanted: f64| {
                let place = |share: f64| stroke.place(if from_end { 1.0 - share } else { share });
                let is_far = |share: f64| leg(place(share)) >= wanted;
                // A step of a long element may be longer than the leg.
                let mut far = shares().find(|share| is_far(*share))?;
                let mut near = (far - 1.0 / f64::from(STEPS)).max(0.0);
                for _ in 0..40 {
                    let middle = (near + far) / 2.0;
                    if is_far(middle) {
                        far = middle;
                    } else {
                        near = middle;
                    }
                }
                Some(place(far))
            };
            let widest = (1..=100).filter_map(|step| {
                let wanted = far * f64::from(step) / 100.0;
                let (p, q) = (at_leg(&a, true, wanted)?, at_leg(&b, false, wanted)?);
                Some((p.0 - q.0).hypot(p.1 - q.1))
            });
            size >= widest.fold(0.0, f64::max) * 0.98 - 2.0
        }
        Corner::Round(size) => {
            // Two lines have one place for it. The places along an arc are many, and what is made of them is
            // checked above.
            let turn = turned(a.heading(1.0), b.heading(0.0));
            let leg = size.nm() as f64 * (turn.abs() / 2.0).tan();
            a.arc.is_some() || b.arc.is_some() || leg >= a.length().min(b.length()) - 2.0
        }
    }
}
