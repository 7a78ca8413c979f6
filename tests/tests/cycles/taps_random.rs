//! Holes at random from a fixed seed and from that of the commit, against a reference that is written from the text.

use leadscrew_core::call::*;
use leadscrew_core::moves::*;
use leadscrew_core::units::*;

use crate::build::*;
use leadscrew_tests::random::Random;

use crate::random::cycles;
use crate::taps::{holes, moves, tap_of};

/// Ends of the strokes of a hole below R, straight from the text: "targets are R ± n·q, clipped at the bottom".
fn reference(total: i64, from: i64, form: &TapForm) -> Vec<i64> {
    let (q, d, deep) = match form {
        TapForm::Standard => (total, 0, false),
        TapForm::HighSpeed(peck) => (peck.infeed.value.nm(), peck.back.value.nm(), false),
        TapForm::Deep(peck) => (peck.infeed.value.nm(), peck.back.value.nm(), true),
    };
    let mut ends = Vec::new();
    for n in 1.. {
        let target = (n * q).min(total);
        if target <= from {
            continue;
        }
        ends.push(target);
        if target == total {
            break;
        }
        if deep {
            ends.push(0);
        }
        ends.push((target - d).max(0));
    }
    // A stroke of no length is none.
    ends.dedup();
    ends
}

fn random_call(r: &mut Random) -> TapCall {
    let axis = if r.chance(60) { TapAxis::Z } else { TapAxis::X };
    let inward = r.sign();
    let grid = 100;
    let length = |r: &mut Random, most: i64| Length::from_nm(r.within(1, most) * grid);
    let start = Position {
        x: Length::from_nm(r.within(-2_000_000, 2_000_000) * grid),
        z: Length::from_nm(r.within(-2_000_000, 2_000_000) * grid),
        c: Angle::from_udeg(r.within(0, 360_000_000)),
    };
    let total = length(r, 600_000);
    let initial = axis.of(start);
    let level = if r.chance(40) {
        initial
    } else {
        initial + length(r, 100_000).times(inward)
    };
    let infeed = Length::from_nm((total.nm() / r.within(1, 20)).max(grid) / grid * grid);
    let back = Length::from_nm(infeed.nm() * r.within(0, 100) / 100 / grid * grid);
    let peck = TapPeck {
        infeed: at(infeed),
        back: at(back),
    };
    let form = match r.within(0, 2) {
        0 => TapForm::Standard,
        1 => TapForm::HighSpeed(peck),
        _ => TapForm::Deep(peck),
    };
    let rpm = r.within(1, 5000);
    let percent = r.within(1, 200);
    let repeat = match r.within(0, 9) {
        0 => TapRepeat::Stay,
        1..=3 => holes(r.within(2, 5) as u8),
        _ => holes(1),
    };
    let move_to = |r: &mut Random| Position {
        x: Length::from_nm(r.within(-1000, 1000) * grid),
        z: Length::from_nm(r.within(-1000, 1000) * grid),
        c: Angle::from_udeg(r.within(-1000, 1000)),
    };
    let (aside, step) = (move_to(r), move_to(r));
    let hole = Position {
        x: start.x + aside.x,
        z: start.z + aside.z,
        c: start.c + aside.c,
    };
    TapCall {
        cycle: TapCycle::G84,
        mode: TapMode::Rigid,
        axis,
        start,
        hole: axis.with(hole, initial),
        step: axis.with(step, Length::ZERO),
        level: at(level),
        bottom: at(level + total.times(inward)),
        form,
        dwell: Millis::new(if r.chance(50) { 0 } else { 500 }),
        lead: at(Lead::new(r.within(1, 5_000) * 1_000_000, rpm).unwrap()),
        hand: if r.chance(50) {
            HandChoice::Signal
        } else {
            HandChoice::Written(Hand::Left)
        },
        speed: CentiRpm::new(rpm as i32 * 100),
        extract: CentiRpm::new((rpm * percent) as i32),
        spindle: SpindleChoice::default(),
        repeat,
        clamp: r.chance(30).then_some(10),
        continues: false,
        notes: TapNotes::default(),
    }
}

/// Checks the strokes of the moves of one hole, which begin `from` below R; gives their number.
fn check_hole(call: &TapCall, list: &[Move], from: i64, stays: bool) -> u32 {
    let axis = call.axis;
    let inward = (call.bottom.value - call.level.value).signum();
    let total = (call.bottom.value - call.level.value).abs().nm();
    let below = |m: &Move| (axis.of(m.to) - call.level.value).times(inward).nm();
    let mut expected = reference(total, from, &call.form);
    if !stays {
        expected.push(0);
    }
    let strokes: Vec<_> = list
        .iter()
        .filter_map(|m| tap_of(m).map(|tap| (*m, tap)))
        .collect();
    let ends: Vec<_> = strokes.iter().map(|(m, _)| below(m)).collect();
    assert_eq!(ends, expected, "{call:?}");
    // Angle and axis on one line: the turns so far are the depth over the lead, exactly.
    let hand = if call.hand == HandChoice::Signal {
        1
    } else {
        -1
    };
    let mut numerator = i128::from(from) * i128::from(call.lead.value.denominator()) * hand;
    let mut at = from;
    for (m, tap) in &strokes {
        let end = below(m);
        assert!((0..=total).contains(&end));
        assert_ne!(end, at);
        numerator += i128::from(tap.turns.numerator());
        assert_eq!(tap.turns.denominator(), call.lead.value.numerator());
        let line = i128::from(end) * i128::from(call.lead.value.denominator()) * hand;
        assert_eq!(numerator, line);
        assert_eq!(tap.outward, end < at);
        let sign = i64::from(tap.speed.get()).signum();
        assert_eq!(sign, (end - at).signum() * hand as i64);
        assert_eq!(m.tag.unwrap().depth.nm(), end);
        assert_eq!(
            (tap.level, tap.bottom),
            (call.level.value, call.bottom.value)
        );
        let fast = m.tag.unwrap().stage != Stage::Tap;
        let speed = if fast { call.extract } else { call.speed };
        assert_eq!(tap.speed.get().abs(), speed.get());
        at = end;
    }
    let first = strokes.first().unwrap().1;
    assert_eq!(first.opens, !call.continues);
    assert!(strokes[1..].iter().all(|(_, tap)| !tap.opens));
    let closing = strokes.iter().filter(|(_, tap)| tap.closes).count();
    assert_eq!(closing, usize::from(!stays));
    assert_eq!(strokes.last().unwrap().1.closes, !stays);
    strokes.len() as u32
}

#[test]
fn holes_at_random() {
    leadscrew_seed::volume(84, |seed| {
        let mut r = Random(seed);
        let (mut strokes, mut stays) = (0, 0);
        for _ in 0..cycles() {
            let call = random_call(&mut r);
            let list = moves(&call);
            // Nothing but the tap axis moves between R and the bottom, and every move goes somewhere.
            let mut at = call.start;
            for m in &list {
                match m.kind {
                    MoveKind::Rapid => assert_ne!(m.to, at),
                    MoveKind::Tap(_) => {
                        assert_eq!(
                            call.axis.with(m.to, Length::ZERO),
                            call.axis.with(at, Length::ZERO)
                        );
                    }
                    _ => assert_eq!(m.to, at),
                }
                at = m.to;
            }
            match call.repeat {
                TapRepeat::Holes(holes) => {
                    for number in 1..=holes.get() {
                        let mine: Vec<_> = list
                            .iter()
                            .filter(|m| m.tag.unwrap().pass == u32::from(number))
                            .copied()
                            .collect();
                        strokes += check_hole(&call, &mine, 0, false);
                        let end = mine.last().unwrap().to;
                        let steps = i64::from(number) - 1;
                        assert_eq!(end.x, call.hole.x + call.step.x.times(steps));
                        assert_eq!(end.z, call.hole.z + call.step.z.times(steps));
                        assert_eq!(
                            end.c.udeg(),
                            call.hole.c.udeg() + call.step.c.udeg() * steps
                        );
                    }
                }
                TapRepeat::Stay => {
                    stays += 1;
                    strokes += check_hole(&call, &list, 0, true);
                    assert_eq!(call.axis.of(at), call.bottom.value);
                    // On from there, a little deeper, with the same words.
                    let from = (call.bottom.value - call.level.value).abs();
                    let inward = (call.bottom.value - call.level.value).signum();
                    // In no more infeeds than a hole may have.
                    let room = match call.form {
                        TapForm::Standard => i64::MAX,
                        TapForm::HighSpeed(peck) | TapForm::Deep(peck) => {
                            9_999 * peck.infeed.value.nm() - from.nm()
                        }
                    };
                    let more = Length::from_nm((r.within(1, 40_000) * 100).min(room));
                    let deeper = TapCall {
                        start: at,
                        bottom: leadscrew_core::alarm::At::new(
                            call.bottom.value + more.times(inward),
                            place(3),
                        ),
                        repeat: holes(1),
                        continues: true,
                        ..call
                    };
                    let list = moves(&deeper);
                    strokes += check_hole(&deeper, &list, from.nm(), false);
                    assert_eq!(list.last().unwrap().to, call.hole);
                }
            }
        }
        assert!(
            strokes > 10 * cycles() && stays > cycles() / 20,
            "{strokes} {stays}"
        );
    });
}

#[test]
fn turned_round_it_is_the_same() {
    leadscrew_seed::volume(88, |seed| {
        let mut r = Random(seed);
        for _ in 0..cycles() / 10 {
            let call = random_call(&mut r);
            let turn = |nm: Length| -nm;
            let mirror = |p: Position| call.axis.with(p, turn(call.axis.of(p)));
            let mirrored = TapCall {
                start: mirror(call.start),
                hole: mirror(call.hole),
                level: at(turn(call.level.value)),
                bottom: at(turn(call.bottom.value)),
                ..call
            };
            for (m, other) in moves(&call).iter().zip(moves(&mirrored)) {
                assert_eq!(mirror(m.to), other.to);
                assert_eq!(m.tag, other.tag);
                let turns = |m: &Move| tap_of(m).map(|tap| (tap.turns, tap.speed));
                assert_eq!(turns(m), turns(&other));
            }
        }
    });
}
