//! Strokes of G32 and G34: their points and what is refused, from program text to moves.

use super::*;
use crate::alarm::{Arg, Code};
use crate::cycle::ThreadMoves;
use crate::moves::{Move, MoveKind, Stage};

/// The thread calls of a text, and where the rapid after each goes.
fn threads(text: &str) -> Vec<(ThreadCall, Option<Position>)> {
    let mut found: Vec<(ThreadCall, Option<Position>)> = Vec::new();
    for call in calls(text) {
        match (call.kind, found.last_mut()) {
            (CallKind::Thread(thread), _) => found.push((thread, None)),
            (CallKind::Rapid(to), Some((_, next @ None))) => *next = Some(to),
            _ => {}
        }
    }
    found
}

fn moves(call: &ThreadCall) -> Result<Vec<Move>, Alarm> {
    Ok(ThreadMoves::new(call, Span::default())?.collect())
}

/// Stage and end (X on the radius, Z, micrometres) of each move of the last stroke of a text.
fn stroke(text: &str) -> Vec<(Stage, i64, i64)> {
    let (call, _) = *threads(text).last().unwrap();
    let points = moves(&call).unwrap();
    points
        .iter()
        .map(|step| {
            let nm = (step.to.x.nm(), step.to.z.nm());
            assert_eq!((nm.0 % 1000, nm.1 % 1000), (0, 0), "{text}: {nm:?}");
            (step.tag.unwrap().stage, nm.0 / 1000, nm.1 / 1000)
        })
        .collect()
}

fn refused(text: &str) -> (Code, Option<u8>) {
    let (call, _) = *threads(text).last().unwrap();
    let alarm = moves(&call).unwrap_err();
    (alarm.code, alarm.word)
}

#[test]
fn a_stroke_runs_out_over_the_last_k_to_the_side_of_j() {
    use Stage::{Finish, RunOut};
    let on = |block: &str| stroke(&std::format!("M3 S300\nG0 X20 Z5\n{block}"));
    assert_eq!(on("G32 Z-20 F2"), [(Finish, 10_000, -20_000)]);
    // Outwards, into a bore, with K as long as J, and with K of its own.
    assert_eq!(
        on("G32 Z-20 F2 J2"),
        [(Finish, 10_000, -18_000), (RunOut, 12_000, -20_000)]
    );
    assert_eq!(
        on("G32 Z-20 F2 J-2 K0"),
        [(Finish, 10_000, -18_000), (RunOut, 8_000, -20_000)]
    );
    assert_eq!(
        on("G32 Z30 F2 J-2 K4"),
        [(Finish, 10_000, 26_000), (RunOut, 8_000, 30_000)]
    );
    // J 0 and K alone are none.
    assert_eq!(on("G32 Z-20 F2 J0 K2"), [(Finish, 10_000, -20_000)]);
    assert_eq!(on("G32 Z-20 F2 K2"), [(Finish, 10_000, -20_000)]);
    // A taper of 1:5 on the radius: over 5 mm the line rises by 1 mm, and J counts from where the run-out begins.
    assert_eq!(
        on("G32 U10 W-25 F2 J3 K5"),
        [(Finish, 14_000, -15_000), (RunOut, 17_000, -20_000)]
    );
    assert_eq!(
        on("G32 U10 W-25 F2 J-1 K5"),
        [(Finish, 14_000, -15_000), (RunOut, 13_000, -20_000)]
    );
    // On a face the long axis is X: K on its radius, J along Z.
    assert_eq!(
        on("G32 X60 F2 J3 K2"),
        [(Finish, 28_000, 5_000), (RunOut, 30_000, 8_000)]
    );
    assert_eq!(
        on("G32 X4 F2 J3"),
        [(Finish, 5_000, 5_000), (RunOut, 2_000, 8_000)]
    );
    // A steep taper has X long as well: Z falls by 1 mm over 4 mm of X.
    assert_eq!(
        on("G32 U40 W-5 F2 J2 K4"),
        [(Finish, 26_000, 1_000), (RunOut, 30_000, 3_000)]
    );
    // At 45° Z is long.
    assert_eq!(
        on("G32 U20 W-10 F2 J3 K2"),
        [(Finish, 18_000, -3_000), (RunOut, 21_000, -5_000)]
    );
}

#[test]
fn what_follows_a_stroke_counts_from_the_end_of_its_run_out() {
    let found = threads("M3 S300\nG0 X20 Z5\nG32 Z-20 F2 J2\nG0 U10 W1");
    let to = found[0].1.unwrap();
    assert_eq!((to.x.nm(), to.z.nm()), (17_000_000, -19_000_000));
}

#[test]
fn j_and_k_stay_in_force_for_strokes_and_cycles() {
    let run_outs = |text: &str| -> Vec<Option<(i64, i64)>> {
        let text = std::format!("M3 S300\nG0 X20 Z5\n{text}");
        let run_out = |(call, _): (ThreadCall, Option<Position>)| {
            let run_out = call.run_out?;
            Some((
                run_out.short.value.nm() / 1000,
                run_out.long.value.nm() / 1000,
            ))
        };
        threads(&text).into_iter().map(run_out).collect()
    };
    // From stroke to stroke; K alone leaves J, and J alone ends K; J0 ends both.
    assert_eq!(
        run_outs(
            "G32 Z-20 F2 J-2 K3\nG0 X20 Z5\nG32 Z-20\nG0 Z5\nG32 Z-20 K1\nG0 Z5\nG32 Z-20 J4\nG0 Z5\nG32 Z-20 J0\nG0 Z5\nG32 Z-20"
        ),
        [
            Some((-2_000, 3_000)),
            Some((-2_000, 3_000)),
            Some((-2_000, 1_000)),
            Some((4_000, 4_000)),
            None,
            None
        ]
    );
    // A cycle knows its side and takes the size. Its own J has no side a stroke could take, unless it is none.
    assert_eq!(
        run_outs(
            "G32 Z-20 F2 J-2 K3\nG0 X20 Z5\nG92 X18 Z-20\nG0 X20 Z5\nG92 X18 Z-20 J0\nG0 X20 Z5\nG32 Z-20"
        ),
        [Some((-2_000, 3_000)), Some((2_000, 3_000)), None, None]
    );
}

#[test]
fn a_run_out_that_cannot_be_is_refused_at_its_word() {
    let at = |block: &str| refused(&std::format!("M3 S300\nG0 X20 Z5\n{block}"));
    assert_eq!(at("G32 Z-20 F2 J2 K25"), (Code::StrokeTooShort, Some(b'K')));
    assert_eq!(at("G32 X60 F2 J2 K20"), (Code::StrokeTooShort, Some(b'K')));
    // The line itself moves by 1 mm over K to the side of J.
    for j in ["1", "0.5"] {
        let block = std::format!("G32 U10 W-25 F2 J{j} K5");
        assert_eq!(at(&block), (Code::RunOutIntoThread, Some(b'J')), "{j}");
    }
    assert_eq!(
        at("G32 U-10 W-25 F2 J-1 K5"),
        (Code::RunOutIntoThread, Some(b'J'))
    );
    assert!(moves(&threads("M3 S300\nG0 X20 Z5\nG32 U10 W-25 F2 J1.001 K5")[0].0).is_ok());
    assert_eq!(
        at("G32 U0 W0 F2 J1"),
        (Code::ThreadWithoutLength, Some(b'Z'))
    );
}

#[test]
fn g34_has_a_lead_that_changes_and_no_run_out() {
    let of = |text: &str| threads(&std::format!("M3 S300\nG0 X20 Z0\n{text}"));
    let (call, _) = of("G34 Z-22 F2 K.1 Q90000")[0];
    assert_eq!(call.cycle, ThreadCycle::G34);
    assert_eq!(call.change.value.pm(), 100_000_000);
    assert_eq!(call.change.span, span(3, 13, 16));
    assert_eq!(
        (call.lead.value.rounded(), call.first_angle.mdeg()),
        (mm(2), 90_000)
    );
    let steps = moves(&call).unwrap();
    assert_eq!(steps.len(), 1);
    assert_eq!((steps[0].to.x, steps[0].to.z), (mm(10), mm(-22)));
    let MoveKind::Thread(thread) = steps[0].kind else {
        panic!("{:?}", steps[0]);
    };
    assert_eq!(
        (thread.change.pm(), thread.long_x, thread.last),
        (100_000_000, false, true)
    );
    // K stays while G34 is in force: a run-out of strokes before and after is not touched by it.
    let run_outs = of("G32 Z-20 J1 K2 F2\nG0 X20 Z0\nG34 Z-22 K-.01\nG0 Z0\nG32 Z-20");
    let seen: Vec<_> = run_outs
        .iter()
        .map(|(call, _)| {
            (
                call.run_out.map(|out| out.long.value),
                call.change.value.pm(),
            )
        })
        .collect();
    assert_eq!(
        seen,
        [(Some(mm(2)), 0), (None, -10_000_000), (Some(mm(2)), 0)]
    );
    // Inches, and turns to an inch.
    let (call, _) = of("G20 G34 Z-1 I11 K.000001")[0];
    assert_eq!(call.change.value.pm(), 25_400);
    // The face: the lead is on the radius.
    let (call, _) = of("G34 X60 F2 K.1")[0];
    assert!(matches!(
        moves(&call).unwrap()[0].kind,
        MoveKind::Thread(thread) if thread.long_x
    ));
    // K belongs to one G34.
    let text = "M3 S300\nG0 X20 Z0\nG34 Z-22 F2 K.1\nG0 Z0\nG34 Z-22";
    assert_eq!(alarm(text).code, Code::LeadChangeMissing);
}

#[test]
fn a_lead_that_leaves_its_range_is_refused_at_its_word() {
    let of = |block: &str| {
        let text = std::format!("M3 S300\nG0 X20 Z0\n{block}");
        let alarm = moves(&threads(&text)[0].0).unwrap_err();
        (alarm.code, alarm.word, [alarm.args[0], alarm.args[1]])
    };
    let length = |nm: i64| Arg::Length(Length::from_nm(nm));
    // 2² − 2·0.1·20 is nothing left.
    assert_eq!(
        of("G34 Z-20 F2 K-.1"),
        (
            Code::LeadUsedUp,
            Some(b'K'),
            [length(2_000_000), length(20_000_000)]
        )
    );
    assert_eq!(of("G34 Z-20 F2 K-.2").2[1], length(10_000_000));
    assert_eq!(of("G34 Z-100 F.2 K-.0002").0, Code::LeadUsedUp);
    assert_eq!(
        of("G34 Z-100 F501 K0"),
        (
            Code::LeadLeavesRange,
            Some(b'F'),
            [length(501_000_000), length(501_000_000)]
        )
    );
    // √(499² + 2·100·10) = 501.000…
    assert_eq!(
        of("G34 Z-10 F499 K100"),
        (
            Code::LeadLeavesRange,
            Some(b'K'),
            [length(499_000_000), length(501_000_000)]
        )
    );
    assert_eq!(of("G34 Z-11000 F2 K.1").0, Code::VariableStrokeTooLong);
    assert_eq!(of("G34 U0 W0 F2 K.1").0, Code::ThreadWithoutLength);
}

/// Part, start and run-out (K, millimetres) of each stroke, and its start angle in thousandths of a degree.
fn parts(text: &str) -> Vec<(ChainPart, i64, i64, Option<i64>, u32)> {
    let text = std::format!("M3 S300\nG0 X20 Z5\n{text}");
    threads(&text)
        .into_iter()
        .map(|(call, _)| {
            let out = call.run_out.map(|out| out.long.value.nm() / 1_000_000);
            let start = (call.start.x.nm() / 1000, call.start.z.nm() / 1000);
            (call.part, start.0, start.1, out, call.first_angle.mdeg())
        })
        .collect()
}

#[test]
fn strokes_that_follow_each_other_are_one_chain() {
    use ChainPart::{First, Last, Middle, Whole};
    // Lead, J and K may change on the way; the run-out is at the end alone, and 2.5 turns are half a turn.
    let chain = [
        (First, 10_000, 5_000, None, 90_000),
        (Middle, 10_000, 0, None, 270_000),
        (Last, 12_000, -20_000, Some(3), 270_000),
    ];
    assert_eq!(
        parts("G32 Z0 F2 J2 Q90000\nU4 W-20\n(a comment)\nF3\nK3 W-9\nG0 X60"),
        chain
    );
    // G32 may be written again; the text may end there, with M30 or without it.
    assert_eq!(
        parts("G32 Z0 F2 J2 Q90000\nN7 G32 U4 W-20 F2\nG32 W-9 K3"),
        chain
    );
    assert_eq!(parts("G32 Z0 F2 J2 Q90000\nU4 W-20\nW-9 K3\nM30"), chain);
    // A run-out that would not fit into a stroke that goes on is none.
    assert_eq!(
        parts("G32 W-2 F2 J2 K3\nW-9")[0],
        (First, 10_000, 5_000, None, 0)
    );
    // A move between them makes two threads, the second from the end of the first one's run-out.
    assert_eq!(
        parts("G32 Z0 F2 J2\nG0 W-1\nG32 W-5"),
        [
            (Whole, 10_000, 5_000, Some(2), 0),
            (Whole, 12_000, -1_000, Some(2), 0)
        ]
    );
    // An alarm does not swallow the stroke before it.
    let text = "M3 S300\nG0 X20 Z5\nG32 Z0 F2\nG32 Z-9 B1";
    let mut events: Vec<Event> = Vec::new();
    let params = Params::default();
    let end = Events::new(text.as_bytes(), &params, Options::default())
        .try_for_each(|event| event.map(|event| events.push(event)));
    assert!(end.is_err());
    assert!(matches!(
        events.last(),
        Some(Event::Call(Call { kind: CallKind::Thread(thread), .. })) if thread.part == Whole
    ));
}

#[test]
fn a_chain_has_one_start_angle_and_a_limit() {
    let text = "M3 S300\nG0 X20 Z5\nG32 Z0 F2\nZ-9 Q90000";
    assert_eq!(kinds_on(&[], text).1, [4904]);
    let many = |count: i64| -> std::string::String {
        (1..=count)
            .map(|n| std::format!("G32 Z{} F1\n", -n))
            .collect()
    };
    assert_eq!(parts(&many(64)).len(), 64);
    let alarm = alarm(&many(65));
    assert_eq!((alarm.code, alarm.span.line), (Code::ChainTooLong, 65));
}
