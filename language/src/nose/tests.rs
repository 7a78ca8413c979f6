//! The vector of the specification, and what is refused. Corners by chance are in `by_chance`.

mod by_chance;

use leadscrew_core::alarm::{Code, Span};
use leadscrew_core::units::Length;

use super::{Entry, Filter, Input, Motion, Nose, Output, Post, STILLS, Side};
use crate::figures::{assert_path, at, elements};
use crate::plane::{Element, Point, Shape};

/// A tool whose centre is the programmed point.
fn round(millimetres: f64) -> Nose {
    Nose {
        radius: Length::from_nm((millimetres * 1e6).round() as i64),
        tip: 0,
    }
}

fn motions(path: &[Element], sides: &[Side], nose: Nose) -> Vec<Motion> {
    let last = *sides.last().expect("a side");
    let sides = sides.iter().copied().chain(std::iter::repeat(last));
    path.iter()
        .zip(sides)
        .map(|(element, side)| Motion {
            element: *element,
            side,
            nose,
        })
        .collect()
}

fn run_with(
    start: Point,
    motions: &[Motion],
    entry: Entry,
    post: Post,
) -> Result<Vec<Element>, Code> {
    let mut filter = Filter::new(start, entry, post);
    let mut out = Vec::new();
    let mut pull = |filter: &mut Filter<()>| {
        while let Some(next) = filter.pull() {
            if let Output::Motion(element, ()) | Output::Corner(element) = next {
                out.push(element);
            }
        }
    };
    for motion in motions {
        filter
            .push(Input::Motion(*motion, ()))
            .map_err(|alarm| alarm.code)?;
        pull(&mut filter);
    }
    filter.finish().map_err(|alarm| alarm.code)?;
    pull(&mut filter);
    Ok(out)
}

/// `text` with `side` from its first move on; the last move is without where it is a rapid one.
fn run(
    start: Point,
    text: &str,
    side: Side,
    nose: Nose,
    entry: Entry,
) -> Result<Vec<Element>, Code> {
    let path = elements(start, text);
    let mut motions = motions(&path, &[side], nose);
    if let Some(last) = motions
        .last_mut()
        .filter(|last| last.element.shape == Shape::Rapid)
    {
        last.side = Side::None;
    }
    run_with(start, &motions, entry, Post::Rear)
}

#[track_caller]
fn gives(start: Point, text: &str, side: Side, nose: Nose, entry: Entry, expected: &str) {
    let out = run(start, text, side, nose, entry).expect("no alarm");
    assert_path(start, &out, expected);
}

const SHAFT: &str = "F14,0 F20,-3 F20,-10 A26,-13/3ccw F30,-13 R34,-10";

#[test]
fn the_vector_of_an_outside_contour() {
    let nose = Nose {
        tip: 3,
        ..round(0.4)
    };
    gives(
        at(14.0, 2.0),
        "F14,0 F20,-3 F20,-10 A26,-13/3cw F30,-13 R34,-10",
        Side::Right,
        nose,
        Entry::A,
        "F13.765685,-0.117157 F20,-3.234315 F20,-10.4 A25.2,-13/2.6cw F29.2,-13 R34,-10",
    );
}

#[test]
fn a_negative_radius_and_a_front_post_exchange_the_sides() {
    let start = at(14.0, 2.0);
    let with = |side, radius, tip, post| {
        let nose = Nose {
            tip,
            ..round(radius)
        };
        let motions = motions(
            &elements(start, SHAFT),
            &[side, side, side, side, side, Side::None],
            nose,
        );
        run_with(start, &motions, Entry::A, post).expect("no alarm")
    };
    let right = with(Side::Right, 0.4, 3, Post::Rear);
    assert_eq!(right, with(Side::Left, -0.4, 3, Post::Rear));
    assert_eq!(right, with(Side::Left, 0.4, 2, Post::Front));
    assert_ne!(right, with(Side::Left, 0.4, 3, Post::Rear));
    let none = with(Side::Right, 0.0, 3, Post::Rear);
    assert_path(start, &none, SHAFT);
    assert_eq!(none, with(Side::None, 0.4, 3, Post::Rear));
}

#[test]
fn the_tip_directions_shift_the_path() {
    let start = at(14.0, 2.0);
    let centre = run(start, SHAFT, Side::Right, round(0.4), Entry::A).expect("no alarm");
    let signs = [
        (0, 0),
        (-1, -1),
        (-1, 1),
        (1, 1),
        (1, -1),
        (0, -1),
        (-1, 0),
        (0, 1),
        (1, 0),
        (0, 0),
    ];
    for (tip, (x, z)) in (0..).zip(signs) {
        let nose = Nose { tip, ..round(0.4) };
        let path = run(start, SHAFT, Side::Right, nose, Entry::A).expect("no alarm");
        for (place, centre) in path.iter().zip(&centre[..5]) {
            assert_eq!((centre.end.x - place.end.x).nm(), x * 400_000, "T{tip}");
            assert_eq!((centre.end.z - place.end.z).nm(), z * 400_000, "T{tip}");
        }
        // Without compensation it is the tip again.
        assert_eq!(path.last(), centre.last(), "T{tip}");
    }
}

/// Two lines along Z and at an angle to the right, in the middle of a path; radii are diameters halved.
#[test]
fn corners_of_two_lines() {
    let start = at(0.0, 10.0);
    let nose = round(1.0);
    let case =
        |text: &str, side, expected: &str| gives(start, text, side, nose, Entry::A, expected);
    // A right angle, inside and outside.
    case(
        "F0,5 F0,0 F20,0 F40,0",
        Side::Right,
        "F2,5 F2,1 F20,1 F40,1",
    );
    case(
        "F0,5 F0,0 F20,0 F40,0",
        Side::Left,
        "F-2,5 F-2,-1 F20,-1 F40,-1",
    );
    // 45° on: 0.414214 before and after the corner.
    case(
        "F0,5 F0,0 F20,-10 F40,-20",
        Side::Right,
        "F2,5 F2,0.414214 F21.414214,-9.292893 F41.414214,-19.292893",
    );
    case(
        "F0,5 F0,0 F20,-10 F40,-20",
        Side::Left,
        "F-2,5 F-2,-0.414214 F18.585786,-10.707107 F38.585786,-20.707107",
    );
    // Turned back by 45°: inside 2.414214, outside two places.
    case(
        "F0,5 F0,0 F20,10 F40,20",
        Side::Right,
        "F2,5 F2,2.414214 F18.585786,10.707107 F38.585786,20.707107",
    );
    case(
        "F0,5 F0,0 F20,10 F40,20",
        Side::Left,
        "F-2,5 F-2,-1 F0,-1.414214 F21.414214,9.292893 F41.414214,19.292893",
    );
    // Straight on, and straight back.
    case("F0,5 F0,0 F0,-5", Side::Left, "F-2,5 F-2,0 F-2,-5");
    case("F0,5 F0,0 F0,8", Side::Left, "F-2,5 F-2,-1 F2,-1 F2,8");
}

#[test]
fn start_up_and_cancel() {
    let start = at(0.0, 10.0);
    let nose = round(1.0);
    let case =
        |text: &str, side, entry, expected: &str| gives(start, text, side, nose, entry, expected);
    for entry in [Entry::A, Entry::B] {
        // Inside: perpendicular.
        case("F0,0 F20,0 R20,10", Side::Right, entry, "F0,1 F20,1 R20,10");
        case(
            "F0,0 F20,10 F40,20",
            Side::Right,
            entry,
            "F-1.414214,0.707107 F18.585786,10.707107 F38.585786,20.707107",
        );
    }
    let obtuse = "F0,0 F20,0 R20,-10";
    case(obtuse, Side::Left, Entry::A, "F0,-1 F20,-1 R20,-10");
    case(obtuse, Side::Left, Entry::B, "F-2,-1 F20,-1 R20,-10");
    let acute = "F0,0 F20,10 F40,20";
    case(
        acute,
        Side::Left,
        Entry::A,
        "F1.414214,-0.707107 F21.414214,9.292893 F41.414214,19.292893",
    );
    case(
        acute,
        Side::Left,
        Entry::B,
        "F-2,-1 F0,-1.414214 F21.414214,9.292893 F41.414214,19.292893",
    );
    // The way out is the way in, backwards.
    let out = "F0,5 F0,0 R20,0";
    case(out, Side::Left, Entry::A, "F-2,5 F-2,0 R20,0");
    case(out, Side::Left, Entry::B, "F-2,5 F-2,-1 R20,0");
    let out = "F0,5 F0,0 R20,10";
    case(out, Side::Left, Entry::A, "F-2,5 F-2,0 R20,10");
    case(
        out,
        Side::Left,
        Entry::B,
        "F-2,5 F-2,-1 F0,-1.414214 R20,10",
    );
    // One motion, and one between start and end.
    case("F0,0", Side::Left, Entry::A, "F-2,0");
    case("F0,0 R20,0", Side::Left, Entry::B, "F-2,0 R20,0");
}

#[test]
fn arcs_get_a_radius_more_or_less() {
    let start = at(0.0, 10.0);
    let text = "F0,5 F0,0 A20,-10/10ccw F40,-10";
    let case = |side, expected: &str| gives(start, text, side, round(1.0), Entry::A, expected);
    // Lines at a distance of 1 from the arc's centre: √(11² − 1) and √(9² − 1) from its middle.
    case(Side::Right, "F2,5 F2,0.954451 A21.908902,-9/11ccw F40,-9");
    case(
        Side::Left,
        "F-2,5 F-2,-1.055728 A17.888544,-11/9ccw F40,-11",
    );
    // Tangent; then outside below 90°: straight on from the end of the arc by the radius of the nose.
    let text = "F0,5 F0,0 A20,-10/10cw F0,-20";
    let expected = "F2,5 F2,0 A20,-9/9cw F22,-9 F22.828427,-10 F1.414214,-20.707107";
    gives(start, text, Side::Right, round(1.0), Entry::A, expected);
}

#[test]
fn what_is_refused() {
    let start = at(0.0, 10.0);
    let refused = |text: &str, side, radius, code| {
        assert_eq!(
            run(start, text, side, round(radius), Entry::A),
            Err(code),
            "{text}"
        );
    };
    refused("A20,0/10cw F20,-10", Side::Left, 1.0, Code::NoseStartUpArc);
    refused(
        "F0,0 A20,-10/10cw F40,-10",
        Side::Right,
        10.1,
        Code::NoseInterference,
    );
    // A groove of 1.9 with a nose of 1: its bottom would go backwards. One of 2.1 is wide enough.
    refused(
        "F40,10 F40,0 F20,0 F20,-1.9 F40,-1.9",
        Side::Right,
        1.0,
        Code::NoseInterference,
    );
    assert!(
        run(
            start,
            "F40,10 F40,0 F20,0 F20,-2.1 F40,-2.1",
            Side::Right,
            round(1.0),
            Entry::A
        )
        .is_ok()
    );
    // Its bottom broken in two: neither piece goes backwards, but the walls are as close.
    refused(
        "F40,10 F40,0 F20,0 F18,-0.9 F20,-1.8 F40,-1.8",
        Side::Right,
        1.0,
        Code::NoseInterference,
    );
}

#[test]
fn an_arc_ends_no_compensation() {
    let start = at(0.0, 10.0);
    let path = elements(start, "F0,5 F0,0 A20,-10/10cw");
    let motions = motions(&path, &[Side::Left, Side::Left, Side::None], round(1.0));
    assert_eq!(
        run_with(start, &motions, Entry::A, Post::Rear),
        Err(Code::NoseStartUpArc)
    );
}

#[test]
fn the_side_may_change_but_not_at_the_start() {
    let start = at(0.0, 10.0);
    let path = elements(start, "F0,8 F0,5 F0,0 F0,-5");
    let change = |after: usize| {
        let sides: Vec<_> = (0..4)
            .map(|i| if i < after { Side::Left } else { Side::Right })
            .collect();
        run_with(
            start,
            &motions(&path, &sides, round(1.0)),
            Entry::A,
            Post::Rear,
        )
    };
    assert_eq!(change(1), Err(Code::NoseSideChange));
    assert_eq!(change(2), Err(Code::NoseSideChange));
    let path = change(3).expect("allowed");
    assert_path(start, &path, "F-2,8 F-2,5 F-2,0 F2,0 F2,-5");
}

#[test]
fn other_blocks_keep_their_place() {
    let start = at(0.0, 10.0);
    let path = elements(start, "F0,5 F0,0 F20,10 F40,10");
    let motion = |i: usize| {
        let motion = Motion {
            element: path[i],
            side: Side::Left,
            nose: round(1.0),
        };
        Input::Motion(motion, i)
    };
    let mut filter = Filter::new(start, Entry::A, Post::Rear);
    let push = |filter: &mut Filter<usize>, input| filter.push(input).expect("no alarm");
    push(&mut filter, motion(0));
    push(&mut filter, Input::Still(10));
    push(&mut filter, motion(1));
    push(&mut filter, Input::Still(11));
    push(&mut filter, Input::Still(12));
    assert_eq!(filter.pull(), None);
    push(&mut filter, motion(2));
    push(
        &mut filter,
        Input::Break {
            at: path[3].end,
            payload: 13,
        },
    );
    push(&mut filter, Input::Still(14));
    let order: Vec<_> = std::iter::from_fn(|| filter.pull())
        .map(|out| match out {
            Output::Motion(_, i) | Output::Still(i) | Output::Break(i) => i,
            Output::Corner(_) => 99,
        })
        .collect();
    assert_eq!(order, [0, 10, 1, 99, 11, 12, 2, 13, 14]);
    // After the break it begins anew, from where the break has led.
    let arc = Element {
        shape: Shape::Arc {
            i: Length::from_nm(1),
            k: Length::ZERO,
            clockwise: true,
        },
        ..path[0]
    };
    let motion = Motion {
        element: arc,
        side: Side::Left,
        nose: round(1.0),
    };
    let refused = filter.push(Input::Motion(motion, 0)).expect_err("an arc");
    assert_eq!(refused.code, Code::NoseStartUpArc);
}

#[test]
fn blocks_without_motion_are_limited() {
    let start = at(0.0, 10.0);
    let path = elements(start, "F0,5");
    let mut filter = Filter::new(start, Entry::A, Post::Rear);
    for _ in 0..100 {
        filter
            .push(Input::Still(()))
            .expect("no limit without compensation");
        assert_eq!(filter.pull(), Some(Output::Still(())));
    }
    let motion = Motion {
        element: path[0],
        side: Side::Left,
        nose: round(1.0),
    };
    filter.push(Input::Motion(motion, ())).expect("no alarm");
    for _ in 0..STILLS {
        filter.push(Input::Still(())).expect("as many as may be");
    }
    // A motion that goes nowhere is a block without motion.
    let nowhere = Motion {
        element: Element {
            span: Span::default(),
            ..path[0]
        },
        ..motion
    };
    let refused = filter
        .push(Input::Motion(nowhere, ()))
        .expect_err("one more");
    assert_eq!(refused.code, Code::NoseStill);
}

#[test]
fn the_filter_holds_no_more_than_its_window() {
    let mut filter = Filter::new(Point::default(), Entry::A, Post::Rear);
    let mut held = 0;
    for i in 1..100 {
        let element = Element {
            end: at(f64::from(i % 2), -10.0 * f64::from(i)),
            shape: Shape::Line,
            span: Span::default(),
        };
        let motion = Motion {
            element,
            side: Side::Right,
            nose: round(0.4),
        };
        filter.push(Input::Motion(motion, ())).expect("no alarm");
        held += 1;
        held -= std::iter::from_fn(|| filter.pull()).count();
        assert!(held < super::WINDOW, "{held} held");
    }
    filter.finish().expect("no alarm");
    assert_eq!(std::iter::from_fn(|| filter.pull()).count(), held);
}
