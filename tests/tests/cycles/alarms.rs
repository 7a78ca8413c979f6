//! Every alarm of the cycles' geometry: provoked, and gone with the smallest change that should cure it.

use leadscrew_core::alarm::{Alarm, Arg};
use leadscrew_core::call::*;
use leadscrew_core::cycle::*;
use leadscrew_core::units::*;

use crate::build::*;

fn refused(call: ThreadCall) -> Alarm {
    ThreadMoves::new(&call, place(1)).expect_err("an alarm")
}

fn fine(call: ThreadCall) {
    let moves = ThreadMoves::new(&call, place(1)).expect("no alarm");
    assert_eq!(moves.last().unwrap().to, call.start);
}

/// Number, word and column of an alarm.
fn blamed(alarm: &Alarm) -> (u16, Option<u8>, u16) {
    (alarm.number(), alarm.word, alarm.span.column)
}

fn one_nm() -> Length {
    Length::from_nm(1)
}

#[test]
fn no_length_no_side_no_depth() {
    let call = ThreadCall {
        end_z: word(mm(10.0), 20),
        ..o0013()
    };
    assert_eq!(blamed(&refused(call)), (4101, Some(b'Z'), 20));
    let call = ThreadCall {
        end_x: word(dia(80.0), 10),
        ..o0013()
    };
    assert_eq!(blamed(&refused(call)), (4102, Some(b'X'), 10));
    let call = GrooveCall {
        end_x: word(dia(125.0), 10),
        ..o0008()
    };
    let alarm = GrooveMoves::new(&call, place(1)).unwrap_err();
    assert_eq!(blamed(&alarm), (4109, Some(b'X'), 10));
}

#[test]
fn allowance_and_smallest_step_against_the_height() {
    let call = ThreadCall {
        allowance: word(mm(3.68), 50),
        ..o0013()
    };
    assert_eq!(blamed(&refused(call)), (4100, Some(b'R'), 50));
    fine(ThreadCall {
        allowance: word(mm(3.6799), 50),
        ..o0013()
    });
    // From the parameter the block is to blame, not a word.
    let call = ThreadCall {
        allowance: at(mm(4.0)),
        ..o0013()
    };
    assert_eq!(blamed(&refused(call)), (4100, None, 1));
    let call = ThreadCall {
        min_step: word(mm(3.6801), 45),
        ..o0013()
    };
    assert_eq!(blamed(&refused(call)), (316, Some(b'Q'), 45));
    fine(ThreadCall {
        min_step: word(mm(3.68), 45),
        ..o0013()
    });
}

#[test]
fn start_inside_the_thread() {
    // Crest at 60.64 + 2·3.68 = 68.
    let call = |x, taper| ThreadCall {
        start: point(x, 10.0),
        taper: at(mm(taper)),
        ..o0013()
    };
    fine(call(68.0, 0.0));
    let alarm = refused(call(67.9998, 0.0));
    assert_eq!(blamed(&alarm), (4103, Some(b'X'), 10));
    // How far inside, and no coordinate: G50 and offsets stay with the program.
    assert_eq!(alarm.args[0], Arg::Diameter(Diameter::from_nm(200)));
    fine(call(68.0, -1.0));
    fine(call(70.0, 1.0));
    assert_eq!(refused(call(69.9998, 1.0)).number(), 4103);
    let inside = |x| ThreadCall {
        start: point(x, 5.0),
        ..internal_taper()
    };
    // 30 − 2·0.92 − 2·0.5.
    fine(inside(27.16));
    let alarm = refused(inside(27.1602));
    assert_eq!(
        (alarm.number(), alarm.args[0]),
        (4103, Arg::Diameter(Diameter::from_nm(200)))
    );
}

#[test]
fn no_room_for_the_stroke_names_the_pass() {
    // The finishing pass starts 2.124649 from A; K = 3 before D.
    let call = |z: f64| ThreadCall {
        end_z: word(mm(z), 20),
        ..o0013()
    };
    fine(call(10.0 - 5.124650));
    let alarm = refused(call(10.0 - 5.124649));
    assert_eq!(blamed(&alarm), (4104, None, 1));
    assert_eq!(
        alarm.args,
        [
            Arg::Int(5),
            Arg::Length(mm(3.0)),
            Arg::Length(Length::ZERO),
            Arg::Length(mm(3.0)),
        ]
    );
    // A run-in of 1 leaves 1.2 for the shift: the second pass is the first to need more.
    let call = ThreadCall {
        run_in: word(mm(1.0), 80),
        cut_in: at(CutIn::Right),
        ..call(10.0 - 5.2)
    };
    let alarm = refused(call);
    assert_eq!((alarm.number(), alarm.args[0]), (4104, Arg::Int(2)));
    assert_eq!(alarm.args[2], Arg::Length(mm(1.0)));
}

#[test]
fn a_pass_that_starts_beyond_the_end() {
    let call = |z: f64| ThreadCall {
        end_z: word(mm(z), 20),
        run_out: None,
        ..o0013()
    };
    fine(call(10.0 - 2.124650));
    let alarm = refused(call(10.0 - 2.124649));
    assert_eq!(blamed(&alarm), (4105, None, 1));
    assert_eq!(
        alarm.args[..3],
        [
            Arg::Int(5),
            Arg::Length(mm(2.124649)),
            Arg::Length(mm(2.124649)),
        ]
    );
    // The leading flank starts furthest with the first pass.
    let call = ThreadCall {
        cut_in: at(CutIn::Left),
        ..call(10.0 - 3.0)
    };
    assert_eq!(refused(call).args[0], Arg::Int(1));
}

#[test]
fn a_taper_that_rises_into_the_run_out() {
    // i = −12 over 72: half a millimetre over K = 3.
    let call = |short: Length| ThreadCall {
        taper: word(mm(-12.0), 25),
        run_out: Some(RunOut {
            short: word(short, 60),
            long: word(mm(3.0), 70),
            short_rest: Remainder::ZERO,
            long_rest: Remainder::ZERO,
        }),
        ..o0013()
    };
    let alarm = refused(call(mm(0.5)));
    assert_eq!(blamed(&alarm), (4106, Some(b'J'), 60));
    assert_eq!(alarm.args[2], Arg::Length(mm(0.5)));
    fine(call(mm(0.5) + one_nm()));
    // The other way the line falls away from the tool.
    fine(ThreadCall {
        start: point(120.0, 10.0),
        taper: at(mm(12.0)),
        ..call(one_nm())
    });
}

#[test]
fn run_in_with_x_long() {
    let call = ThreadCall {
        taper: at(mm(-72.0)),
        run_in: word(mm(0.1), 80),
        ..o0013()
    };
    assert_eq!(blamed(&refused(call)), (4107, Some(b'E'), 80));
    fine(ThreadCall {
        taper: at(mm(-71.9999)),
        run_out: None,
        ..call
    });
}

#[test]
fn passes_are_counted() {
    let call = |infeed, depth: f64, step: f64| ThreadCall {
        infeed,
        height: word(mm(depth), 30),
        allowance: at(Length::ZERO),
        first_depth: word(mm(step), 40),
        min_step: at(Length::ZERO),
        finish_passes: at(99),
        ..o0013()
    };
    let count = |call: ThreadCall| {
        let summary = ThreadMoves::new(&call, place(1)).unwrap().summary();
        assert_eq!(summary.passes, summary.rough + 99);
        summary.rough
    };
    assert_eq!(count(call(Infeed::Equal, 0.9999, 0.0001)), 9999);
    let alarm = refused(call(Infeed::Equal, 1.0, 0.0001));
    assert_eq!((alarm.number(), alarm.args[0]), (4108, Arg::Int(9999)));
    // √9999 is 99.995; the smallest first depths go on in single increments.
    assert_eq!(count(call(Infeed::Decreasing, 2.9998, 0.03)), 9999);
    assert_eq!(
        refused(call(Infeed::Decreasing, 3.0002, 0.03)).number(),
        4108
    );
    assert_eq!(count(call(Infeed::Decreasing, 0.9999, 0.0001)), 9999);
    assert_eq!(
        refused(call(Infeed::Decreasing, 1.0, 0.0001)).number(),
        4108
    );
    // 0.03, 0.0424, then 296 steps of 0.01.
    let sticky = ThreadCall {
        min_step: at(mm(0.01)),
        ..call(Infeed::Decreasing, 3.0002, 0.03)
    };
    assert_eq!(count(sticky), 298);
}

#[test]
fn angle_and_starts() {
    let call = ThreadCall {
        angle: word(100, 15),
        ..o0013()
    };
    assert_eq!(blamed(&refused(call)), (315, Some(b'P'), 15));
    fine(ThreadCall {
        angle: word(99, 15),
        ..o0013()
    });
    let call = ThreadCall {
        starts: word(0, 15),
        ..o0013()
    };
    assert_eq!(blamed(&refused(call)), (4111, Some(b'L'), 15));
    fine(ThreadCall {
        starts: word(99, 15),
        ..o0013()
    });
}

#[test]
fn groove_steps() {
    let refused = |call: GrooveCall| blamed(&GrooveMoves::new(&call, place(1)).unwrap_err());
    let zero = Some(word(Length::ZERO, 30));
    assert_eq!(
        refused(GrooveCall {
            peck: None,
            ..o0008()
        }),
        (319, None, 1)
    );
    assert_eq!(
        refused(GrooveCall {
            peck: zero,
            ..o0008()
        }),
        (319, Some(b'P'), 30)
    );
    assert_eq!(
        refused(GrooveCall {
            step: None,
            ..o0008()
        }),
        (319, None, 1)
    );
    assert_eq!(
        refused(GrooveCall {
            step: zero,
            ..o0008()
        }),
        (319, Some(b'Q'), 30)
    );
    // One column asks for no step.
    let one = GrooveCall {
        end_z: at(mm(-24.0)),
        step: zero,
        ..o0008()
    };
    assert_eq!(GrooveMoves::new(&one, place(1)).unwrap().count(), 30);
}

#[test]
fn lengths_out_of_range() {
    let negative = Length::from_nm(-1);
    let huge = Length::INPUT_LIMIT + one_nm();
    let cases = [
        (
            ThreadCall {
                height: word(Length::ZERO, 5),
                ..o0013()
            },
            b'P',
        ),
        (
            ThreadCall {
                first_depth: word(Length::ZERO, 5),
                ..o0013()
            },
            b'Q',
        ),
        (
            ThreadCall {
                min_step: word(negative, 5),
                ..o0013()
            },
            b'Q',
        ),
        (
            ThreadCall {
                allowance: word(negative, 5),
                ..o0013()
            },
            b'R',
        ),
        (
            ThreadCall {
                run_in: word(negative, 5),
                ..o0013()
            },
            b'E',
        ),
        (
            ThreadCall {
                end_x: word(huge, 5),
                ..o0013()
            },
            b'X',
        ),
        (
            ThreadCall {
                end_z: word(-huge, 5),
                ..o0013()
            },
            b'Z',
        ),
        (
            ThreadCall {
                taper: word(huge, 5),
                ..o0013()
            },
            b'R',
        ),
        (
            ThreadCall {
                run_out: Some(RunOut {
                    short: word(Length::ZERO, 5),
                    long: at(one_nm()),
                    short_rest: Remainder::ZERO,
                    long_rest: Remainder::ZERO,
                }),
                ..o0013()
            },
            b'J',
        ),
        (
            ThreadCall {
                run_out: Some(RunOut {
                    short: at(one_nm()),
                    long: word(huge, 5),
                    short_rest: Remainder::ZERO,
                    long_rest: Remainder::ZERO,
                }),
                ..o0013()
            },
            b'K',
        ),
    ];
    for (call, letter) in cases {
        assert_eq!(blamed(&refused(call)), (4110, Some(letter), 5));
    }
    let start = Position {
        x: huge,
        ..o0013().start
    };
    assert_eq!(
        blamed(&refused(ThreadCall { start, ..o0013() })),
        (4110, None, 1)
    );
    let increment = Length::ZERO;
    assert_eq!(
        blamed(&refused(ThreadCall {
            increment,
            ..o0013()
        })),
        (4110, None, 1)
    );
    let groove = GrooveCall {
        retract: word(negative, 5),
        ..o0008()
    };
    let alarm = GrooveMoves::new(&groove, place(1)).unwrap_err();
    assert_eq!(blamed(&alarm), (4110, Some(b'R'), 5));
}

/// A cycle's alarm comes through the common door with the call's own place.
#[test]
fn expand_refuses_before_the_first_move() {
    let call = |kind| Call {
        span: place(9),
        origin: Position::default(),
        kind,
    };
    let thread = ThreadCall {
        allowance: at(mm(4.0)),
        ..o0013()
    };
    let alarm = expand(
        &call(CallKind::Thread(thread)),
        &Context::standing(thread.start),
    )
    .unwrap_err();
    assert_eq!((alarm.number(), alarm.span), (4100, place(9)));
    let groove = GrooveCall {
        peck: None,
        ..o0008()
    };
    let alarm = expand(
        &call(CallKind::Groove(groove)),
        &Context::standing(groove.start),
    )
    .unwrap_err();
    assert_eq!((alarm.number(), alarm.span), (319, place(9)));
    let relief = GrooveCall {
        relief: word(mm(0.1), 50),
        ..o0008()
    };
    let moves = expand(
        &call(CallKind::Groove(relief)),
        &Context::standing(relief.start),
    )
    .unwrap();
    assert_eq!(moves.warning().unwrap().number(), 4920);
}
