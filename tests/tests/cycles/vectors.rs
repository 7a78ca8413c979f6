//! Turning cycles, G92, reference points and pecking along Z: programs against moves that were computed by other means.
//!
//! A move is a letter, X as a diameter, and Z: `R` rapid, `F` feed, `T` in step with the spindle, `@` its start angle in
//! degrees. The rapid to the start of a program is left out.

use crate::random::groove;
use leadscrew_core::alarm::Span;
use leadscrew_core::call::{GrooveCall, Position, TapAxis};
use leadscrew_core::cycle::{Context, GrooveMoves, expand};
use leadscrew_core::moves::{Move, MoveKind};
use leadscrew_core::params::{Entry, Params};
use leadscrew_core::program::{Event, Events, Options};
use leadscrew_tests::random::Random;

/// IS-B.
fn machine(settings: &[(&str, i64)]) -> Params {
    let mut params = Params::default();
    let is_b = [("1004.1", 0)];
    for (key, value) in is_b.iter().chain(settings) {
        let entry = Entry::find_text(key).expect("a parameter");
        params.set(entry, *value).expect("in range");
    }
    params
}

fn figure(nm: i64) -> String {
    let text = format!("{:.6}", nm as f64 / 1e6);
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0" } else { text }.to_owned()
}

/// A move in the notation, in work coordinates.
fn written(step: &Move, origin: &Position, angles: bool) -> Option<String> {
    let (letter, angle) = match step.kind {
        MoveKind::Rapid => ('R', None),
        MoveKind::Feed(_) => ('F', None),
        MoveKind::Thread(thread) => {
            let degrees = thread.pass_angle.mdeg() / 1000;
            ('T', angles.then_some(degrees))
        }
        _ => return None,
    };
    let (x, z) = (step.to.x - origin.x, step.to.z - origin.z);
    let end = format!("{letter}{},{}", figure(x.nm() * 2), figure(z.nm()));
    Some(match angle {
        Some(angle) => format!("{end}@{angle}"),
        None => end,
    })
}

/// The moves of a program after its first, or the number of its alarm.
fn moves(text: &str, params: &Params, angles: bool) -> Result<String, u16> {
    let mut here = Options::default().position;
    let mut list = Vec::new();
    for event in Events::new(text.as_bytes(), params, Options::default()) {
        if let Event::Call(call) = event.map_err(|alarm| alarm.number())? {
            for step in expand(&call, &Context::standing(here)).map_err(|alarm| alarm.number())? {
                here = step.to;
                list.extend(written(&step, &call.origin, angles));
            }
        }
    }
    list.remove(0);
    Ok(list.join(" "))
}

#[track_caller]
fn same(text: &str, expected: &str) {
    let angles = expected.contains('@');
    assert_eq!(
        moves(text, &machine(&[]), angles).as_deref(),
        Ok(expected),
        "{text}"
    );
}

#[track_caller]
fn refused(text: &str, number: u16) {
    assert_eq!(moves(text, &machine(&[]), false), Err(number), "{text}");
}

#[test]
fn turning_along_z_repeats_with_what_is_kept() {
    same(
        "G0 X60 Z2\nG90 X50 Z-40 R-3 F100\nX45\n",
        "R44,2 F50,-40 F60,-40 R60,2 R39,2 F45,-40 F60,-40 R60,2",
    );
    // R stays until it is written again, and ends with the mode.
    same(
        "G0 X60 Z2\nG90 X50 Z-40 R-3 F100\nX45 R0\nG1 X44\nG90 X40 Z-30\n",
        "R44,2 F50,-40 F60,-40 R60,2 R45,2 F45,-40 F60,-40 R60,2 F44,2 R40,2 F40,-30 F44,-30 R44,2",
    );
    // A block without X and Z moves nothing.
    same(
        "G0 X60 Z2\nG90 U-10 W-42 F100\nS500 M3\nF80\nU-12\n",
        "R50,2 F50,-40 F60,-40 R60,2 R48,2 F48,-40 F60,-40 R60,2",
    );
}

#[test]
fn turning_across_repeats_with_what_is_kept() {
    same(
        "G0 X60 Z2\nG94 X20 Z-5 R-3 F100\nZ-8\n",
        "R60,-8 F20,-5 F20,2 R60,2 R60,-11 F20,-8 F20,2 R60,2",
    );
}

#[test]
fn turning_needs_both_ends_a_feed_and_a_taper_that_fits() {
    refused("G0 X60 Z2\nG90 X50 F100\n", 4052);
    refused("G0 X60 Z2\nG94 Z-3 F100\n", 4052);
    refused("G0 X60 Z2\nG90 X50 Z-40\n", 4034);
    refused("G0 X60 Z2\nG90 X50 Z-40 R6 F100\n", 4053);
    refused("G0 X60 Z2\nG94 X50 Z-1 R4 F100\n", 4053);
    refused("G0 X60 Z2\nG90 X50 Z-40 Q1 F100\n", 4028);
    // The longest R that still begins at the start.
    same("G0 X60 Z2\nG90 X50 Z-40 R5 F100\n", "F50,-40 F60,-40 R60,2");
    // R alone feeds in, deeper with each block.
    same(
        "G0 X120 Z-30\nG90 X120 Z-44 R-7.5 F150\nZ-56 R-15\n",
        "R105,-30 F120,-44 R120,-30 R90,-30 F120,-56 R120,-30",
    );
}

#[test]
fn g92_is_one_pass_a_block() {
    same(
        "G0 X40 Z5\nG92 X29.3 Z-30 F2\nX28.7\n",
        "R29.3,5 T29.3,-29 T31.3,-30 R40,-30 R40,5 R28.7,5 T28.7,-29 T30.7,-30 R40,-30 R40,5",
    );
    same(
        "G0 X40 Z5\nG92 X30 Z-20 R-2.5 F3 J0 L2\n",
        "R25,5 T30,-20@0 R40,-20 R40,5 R25,5 T30,-20@180 R40,-20 R40,5",
    );
    // Q is the angle of the first start, and counts for its block alone.
    same(
        "G0 X40 Z5\nG92 X30 Z-20 F3 J0 L2 Q270000\nX29\n",
        "R30,5 T30,-20@270 R40,-20 R40,5 R30,5 T30,-20@90 R40,-20 R40,5 \
         R29,5 T29,-20@0 R40,-20 R40,5 R29,5 T29,-20@180 R40,-20 R40,5",
    );
    // F of a thread is no feed, and a feed is no lead.
    refused("G0 X40 Z5\nG92 X30 Z-20 F3\nG1 X20\n", 4034);
    refused("G0 X40 Z5\nG1 X39 F100\nG92 X30 Z-20\n", 313);
    refused("G0 X40 Z5\nG92 X30 F3\n", 4052);
    refused("G0 X40 Z5\nG92 X30 Z-20 R6 F3\n", 4103);
}

#[test]
fn reference_points_are_reached_over_the_point_between() {
    same("G50 X50 Z10\nG0 X20 Z-5\nG28 U10 W0\n", "R30,-5 R50,10");
    // An axis that is not named stays.
    same("G50 X50 Z10\nG0 X20 Z-5\nG28 U0\n", "R50,-5");
    let params = machine(&[
        ("1241.X", 30_000_000),
        ("1241.Z", 70_000_000),
        ("1242.Z", 9_000_000),
    ]);
    let far = |text: &str| moves(text, &params, false);
    assert_eq!(far("G0 X20 Z5\nG30 U0 W0\n").as_deref(), Ok("R60,70"));
    assert_eq!(far("G0 X20 Z5\nG30 P2 U0\n").as_deref(), Ok("R60,5"));
    assert_eq!(far("G0 X20 Z5\nG30 P3 W0\n").as_deref(), Ok("R20,9"));
    assert_eq!(far("G0 X20 Z5\nG30 P5 W0\n"), Err(4025));
    assert_eq!(far("G0 X20 Z5\nG28\n"), Err(4031));
    // It ends a turning cycle.
    same(
        "G0 X60 Z2\nG90 X50 Z-40 F100\nG28 U0 W0\nX45\n",
        "R50,2 F50,-40 F60,-40 R60,2 R0,0 R45,0",
    );
}

#[test]
fn pecking_along_z() {
    same(
        "G0 X40 Z2\nG74 R0.5\nG74 X20 Z-6 P10000 Q3000 F100\n",
        "F40,-1 R40,-0.5 F40,-4 R40,-3.5 F40,-6 R40,2 R30,2 F30,-1 R30,-0.5 F30,-4 R30,-3.5 F30,-6 R30,2 \
         R20,2 F20,-1 R20,-0.5 F20,-4 R20,-3.5 F20,-6 R20,2 R40,2",
    );
    // A drill: no X, and R has nowhere to go.
    same(
        "G0 X0 Z2\nG74 R1\nG74 Z-12 Q5000 R2 F100\n",
        "F0,-3 R0,-2 F0,-8 R0,-7 F0,-12 R0,2",
    );
    refused("G0 X0 Z2\nG74 X10 Q5000 F100\n", 4054);
    refused("G0 X0 Z2\nG74 Z-12 F100\n", 319);
    refused("G0 X40 Z2\nG74 X20 Z-6 Q3000 F100\n", 319);
    refused("G0 X40 Z2\nG74 X20 Z-6 P-1 Q3000 F100\n", 320);
    refused("G0 X40 Z2\nG74 X20 Z2 P1000 Q3000 F100\n", 4109);
}

/// G74 is G75 with X and Z exchanged.
#[test]
fn g74_mirrors_g75() {
    let swap = |place: Position| Position {
        x: place.z,
        z: place.x,
        ..place
    };
    leadscrew_seed::volume(74, |seed| {
        let mut random = Random(seed);
        for _ in 0..2000 {
            let along_x = groove(&mut random);
            let along_z = GrooveCall {
                axis: TapAxis::Z,
                start: swap(along_x.start),
                end_x: along_x.end_z,
                end_z: along_x.end_x,
                ..along_x
            };
            let made = |call| {
                let moves =
                    GrooveMoves::new(&call, Span::default()).map_err(|alarm| alarm.number())?;
                Ok::<_, u16>(moves.map(|step| (step.kind, step.to)).collect::<Vec<_>>())
            };
            let mirrored = made(along_x).map(|moves| {
                let turned = moves.into_iter().map(|(kind, to)| (kind, swap(to)));
                turned.collect::<Vec<_>>()
            });
            assert_eq!(made(along_z), mirrored, "{along_x:?}");
        }
    });
}
