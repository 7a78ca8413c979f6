//! Motion, coordinates, spindle, tools and the order of calls.

use super::*;
use crate::alarm::Code;
use crate::units::{Angle, Feed, FeedPerTurn, Millis};

fn per_minute(mm: i64) -> FeedRate {
    FeedRate::PerMinute(Feed::from_nm_per_min(mm * 1_000_000))
}

#[test]
fn absolute_and_incremental_words_mix() {
    assert_eq!(
        kinds("G0 X50 Z10\nU-4 Z5\nG01 X40 W-2.5 F120\nC90\nH-.5"),
        [
            CallKind::Rapid(at(500_000, 100_000)),
            CallKind::Rapid(at(460_000, 50_000)),
            CallKind::Line(at(400_000, 25_000), per_minute(120)),
            CallKind::Line(
                Position {
                    c: Angle::from_udeg(90_000_000),
                    ..at(400_000, 25_000)
                },
                per_minute(120)
            ),
            CallKind::Line(
                Position {
                    c: Angle::from_udeg(89_500_000),
                    ..at(400_000, 25_000)
                },
                per_minute(120)
            ),
        ]
    );
}

#[test]
fn g00_may_stand_beside_a_reference_point() {
    let two = kinds("G1 X50 F100\nG0\nG28 U4 W0\nG30 U2\nX9");
    let one = kinds("G1 X50 F100\nG28 G0 U4 W0\nG00 G30 P2 U2\nX9");
    assert_eq!(one, two);
    assert_eq!(one.len(), 6);
    assert_eq!(one[1], CallKind::Rapid(at(540_000, 0)));
    assert_eq!(one[5], CallKind::Rapid(at(90_000, 0)));
}

#[test]
fn blocks_that_change_modal_state_alone_make_no_call() {
    assert_eq!(
        calls(
            "G21 G40 G54 G64 G80 G97 G98\nN10\nG01 F100\nG17\nG19\nG18\nG50 S2000\nT\n"
                .trim_end_matches("T\n")
        ),
        []
    );
}

#[test]
fn g61_and_g64_are_calls_where_they_change_anything_before_the_motion_of_their_block() {
    assert_eq!(
        kinds("G64\nG61 G0 X2.\nG61\nG64\nG0 X4."),
        [
            CallKind::ExactStop(true),
            CallKind::Rapid(at(20_000, 0)),
            CallKind::ExactStop(false),
            CallKind::Rapid(at(40_000, 0)),
        ]
    );
}

#[test]
fn inches_and_millimetres_agree() {
    assert_eq!(
        kinds("G20 G0 X2 Z-.5\nG1 X1.5 F10"),
        kinds("G21 G0 X50.8 Z-12.7\nG1 X38.1 F254")
    );
    assert_eq!(
        kinds("G20 G0 X.00001"),
        [CallKind::Rapid(Position {
            x: Length::from_nm(127),
            ..Position::ZERO
        })]
    );
}

#[test]
fn feeds_by_minute_and_by_turn() {
    let last = |text: &str| kinds(text).pop();
    assert_eq!(
        last("M3 S200 G99 G1 X10 F.25"),
        Some(CallKind::Line(
            at(100_000, 0),
            FeedRate::PerTurn(FeedPerTurn::from_nm(250_000), Rpm::new(200))
        ))
    );
    assert_eq!(alarm("G1 X10 F100\nG99 X12").number(), 4034);
    let dry = Options {
        dry_run: true,
        ..Options::default()
    };
    let (events, alarm) = read_with(b"G1 X10 F.5", &Params::sheets(), dry);
    assert_eq!(alarm, None);
    let Event::Call(call) = events[0] else {
        panic!()
    };
    assert_eq!(
        call.kind,
        CallKind::Line(
            at(100_000, 0),
            FeedRate::PerMinute(Params::sheets().dry_run_feed())
        )
    );
}

#[test]
fn arcs_by_centre_and_by_radius() {
    let arc = |text: &str| match kinds(text).pop() {
        Some(CallKind::Arc(arc)) => arc,
        other => panic!("{other:?}"),
    };
    let by_centre = arc("G0 X0 Z0\nG3 X20 Z-10 K-10 F100");
    assert_eq!(
        (by_centre.i, by_centre.k, by_centre.clockwise),
        (mm(0), mm(-10), false)
    );
    assert_eq!(arc("G0 X0 Z0\nG3 X20 Z-10 R10 F100"), by_centre);
    let other = arc("G0 X0 Z0\nG2 X20 Z-10 R10 F100");
    assert_eq!((other.i, other.k, other.clockwise), (mm(10), mm(0), true));
    assert_eq!(arc("G0 X0 Z0\nG3 X20 Z-10 R-10 F100").i, mm(10));
    let full = arc("G0 X20 Z0\nG2 K-5 F100");
    assert_eq!((full.end, full.k), (at(200_000, 0), mm(-5)));
    assert_eq!(arc("G0 X20 Z0 F100\nG2 U20 W-10 I10\nW-20 K-10").k, mm(-10));
}

#[test]
fn coordinate_systems_shift_and_offset() {
    let all = calls("G50 X100 Z50\nG0 X80 Z10\nG50 U2 W1\nX80 Z10\nG53 X0 Z0\nG50 C30\nC0");
    assert_eq!(all[0].kind, CallKind::Rapid(at(-200_000, -400_000)));
    assert_eq!(all[0].origin, at(-1_000_000, -500_000));
    // The place called X80 Z10 is now called X82 Z11.
    assert_eq!(all[1].kind, CallKind::Rapid(at(-220_000, -410_000)));
    assert_eq!(all[2].kind, CallKind::Rapid(at(0, 0)));
    assert_eq!(
        all[3].kind,
        CallKind::Rapid(Position {
            c: Angle::from_udeg(-30_000_000),
            ..at(0, 0)
        })
    );
}

#[test]
fn s_in_g50_is_a_limit_only_alone() {
    assert_eq!(kinds("G50 X100 Z50 M3 S300"), [spindle(300)]);
    assert_eq!(kinds("G50 S1500\nM3 S1200"), [spindle(1200)]);
    // Under G97 it limits nothing.
    assert_eq!(kinds("G50 S800\nM3 S900"), [spindle(900)]);
    // What the spindle cannot do anyway is told.
    let (events, alarm) = read("G50 S3001");
    assert_eq!(alarm, None);
    let [Event::Warning(warning)] = events.as_slice() else {
        panic!("{events:?}");
    };
    assert_eq!(warning.code, Code::SpeedLimited);
}

/// The law of S m/min with the work zero at X0, where G50 S says `most`.
fn law(metres: i64, most: u32) -> SurfaceSpeed {
    SurfaceSpeed {
        speed: Feed::from_nm_per_min(metres * 1_000_000_000),
        centre: Length::ZERO,
        least: 0,
        most,
    }
}

fn surface(law: SurfaceSpeed, rpm: i32) -> CallKind {
    CallKind::Spindle(SpindleCall {
        rpm: Rpm::new(rpm),
        mode: SpindleMode::Surface(law),
    })
}

#[test]
fn constant_surface_speed_is_one_command_until_it_changes() {
    assert_eq!(
        kinds("G0 X100\nG50 S2000\nG96 S150 M3\nG0 X50\nS100\nM5\nM4"),
        [
            CallKind::Rapid(at(1_000_000, 0)),
            surface(law(150, 2000), 478),
            CallKind::Rapid(at(500_000, 0)),
            surface(law(100, 2000), 637),
            spindle(0),
            surface(law(100, 2000), -637),
        ]
    );
    // Until the spindle turns, nothing is told; a new limit or a new work zero is.
    assert_eq!(
        kinds("G96 S150\nG0 X100\nM3\nG50 S400\nG50 X102"),
        [
            CallKind::Rapid(at(1_000_000, 0)),
            surface(law(150, 3000), 478),
            surface(law(150, 400), 400),
            surface(
                SurfaceSpeed {
                    centre: Length::from_nm(-1_000_000),
                    ..law(150, 400)
                },
                400
            ),
        ]
    );
    // Feet a minute.
    let CallKind::Spindle(feet) = kinds("G20 G96 S500 M3")[0] else {
        panic!("no spindle");
    };
    assert_eq!(
        feet.law().map(|law| law.speed.nm_per_min()),
        Some(152_400_000_000)
    );
}

#[test]
fn g97_holds_the_speed_and_g96_takes_its_own_up_again() {
    assert_eq!(
        kinds("G0 X100\nG96 S150 M3\nG97\nG96\nG97 S300\nS310"),
        [
            CallKind::Rapid(at(1_000_000, 0)),
            surface(law(150, 3000), 478),
            spindle(477),
            surface(law(150, 3000), 478),
            spindle(300),
            spindle(310),
        ]
    );
}

#[test]
fn a_feed_per_turn_under_g96_has_the_highest_speed_of_its_way() {
    let rpm = |text: &str| {
        let text = std::format!("G99 G50 S2000\nG96 S150 M4\nG0 X100 Z0\n{text}");
        match kinds(&text).pop() {
            Some(
                CallKind::Line(_, FeedRate::PerTurn(_, rpm))
                | CallKind::Arc(ArcCall {
                    feed: FeedRate::PerTurn(_, rpm),
                    ..
                }),
            ) => rpm.get(),
            other => panic!("{other:?}"),
        }
    };
    assert_eq!(rpm("G1 X50 F0.2"), -955);
    assert_eq!(rpm("G1 X120 F0.2"), -478);
    // Across the centre.
    assert_eq!(rpm("G1 X-100 F0.2"), -2000);
    // Half a circle over X110, or under X90.
    assert_eq!(rpm("G3 Z-10 I0 K-5 F0.2"), -478);
    assert_eq!(rpm("G2 Z-10 I0 K-5 F0.2"), -531);
    // A quarter and three quarters, with the place nearest to the axis at their end or within.
    assert_eq!(rpm("G2 X80 Z-10 R10 F0.2"), -597);
    assert_eq!(rpm("G3 X80 Z-10 R10 F0.2"), -597);
    assert_eq!(rpm("G2 X80 Z-10 R-10 F0.2"), -796);
    assert_eq!(rpm("G3 X80 Z-10 R-10 F0.2"), -597);
    assert_eq!(rpm("G2 K-5 F0.2"), -531);
}

#[test]
fn calls_of_a_block_come_in_execution_order() {
    assert_eq!(
        kinds("M3 M8 S500 T0101 G0 X10"),
        [
            spindle(500),
            CallKind::Aux(Aux::M(8)),
            CallKind::Aux(Aux::T(101)),
            CallKind::Rapid(at(100_000, 0)),
        ]
    );
    assert_eq!(
        kinds("M3 S500\nM30 M5 M9 G0 Z1\nG0 X5"),
        [
            spindle(500),
            CallKind::Rapid(at(0, 10_000)),
            spindle(0),
            CallKind::Aux(Aux::M(9)),
            CallKind::End(30),
        ]
    );
    assert_eq!(
        kinds("G0 G4 P500 X1"),
        [
            CallKind::Dwell(Millis::new(500)),
            CallKind::Rapid(at(10_000, 0))
        ]
    );
}

#[test]
fn dwells_in_seconds_and_milliseconds() {
    let ms = |text: &str| match kinds(text)[..] {
        [CallKind::Dwell(time)] => time.get(),
        ref other => panic!("{other:?}"),
    };
    assert_eq!(ms("G04 X2"), 2_000);
    assert_eq!(ms("G04 U0.25"), 250);
    assert_eq!(ms("G4 P1500"), 1_500);
}

#[test]
fn stops_ends_and_what_follows() {
    assert_eq!(
        kinds("M0\nM1\nM2\nG99999"),
        [CallKind::Aux(Aux::M(0)), CallKind::End(2)]
    );
    let options = Options {
        optional_stop: true,
        ..Options::default()
    };
    let (events, _) = read_with(b"M1", &Params::sheets(), options);
    assert_eq!(events.len(), 1);
    assert_eq!(
        kinds("%\nO1\nG0 X1\n%\nnonsense"),
        [CallKind::Rapid(at(10_000, 0))]
    );
    assert_eq!(kinds("M30\n(never closed"), [CallKind::End(30)]);
}

#[test]
fn the_start_position_counts() {
    let options = Options {
        position: at(1_000_000, 500_000),
        ..Options::default()
    };
    let (events, _) = read_with(b"G0 U-2 W1", &Params::sheets(), options);
    let Event::Call(call) = events[0] else {
        panic!()
    };
    assert_eq!(call.kind, CallKind::Rapid(at(980_000, 510_000)));
}

#[test]
fn numbers_of_program_and_block_are_kept() {
    let params = Params::sheets();
    let mut interpreter = Interpreter::new(&params, Options::default());
    let mut count = 0;
    for (line, text) in ["%", "O0013 (THREAD)", "N10 G0 X1", "N20 Z1"]
        .iter()
        .enumerate()
    {
        let read = interpreter.line(text.as_bytes(), line as u32 + 1, &mut |_| count += 1);
        assert_eq!(read, Ok(()));
    }
    assert_eq!(
        (interpreter.program_number(), interpreter.sequence_number()),
        (Some(13), Some(20))
    );
    assert_eq!((count, interpreter.position()), (2, at(10_000, 10_000)));
}
