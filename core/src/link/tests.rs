extern crate std;

use core::num::NonZeroU8;
use std::vec::Vec;

use super::bounds::Beyond;
use super::*;
use crate::alarm::{Alarm, Arg, At, Code, Span};
use crate::bus::BoardState;
use crate::call::{
    ArcCall, Aux, Call, CallKind, ChainPart, CutIn, Extraction, FeedRate, GrooveCall, Hand,
    HandChoice, Infeed, LengthUnit, Plane, Position, RunOut, Selection, SpindleCall, SpindleChoice,
    TapAxis, TapCall, TapCycle, TapForm, TapMode, TapNotes, TapPeck, TapRepeat, TapReturn,
    TapSpindle, ThreadCall, ThreadCycle,
};
use crate::offsets::Revision;
use crate::params::Params;
use crate::units::{
    Angle, Axes, CentiRpm, Feed, FeedPerTurn, Lead, LeadChange, Length, Millis, Remainder, Rpm,
    StartAngle, TurnRate, Turns,
};

/// The span with the longest encoding.
const SPAN: Span = Span {
    line: u32::MAX,
    column: u16::MAX,
    end: u16::MAX,
};
const FAR: Length = Length::INPUT_LIMIT;
const FARTHEST: Position = Position {
    x: FAR,
    z: FAR,
    c: Angle::from_udeg(FAR.nm()),
};

fn at<T>(value: T) -> At<T> {
    At::new(value, SPAN)
}

fn call(kind: CallKind) -> Call {
    Call {
        span: SPAN,
        origin: FARTHEST,
        kind,
    }
}

/// A thread with the largest values in every field.
fn thread() -> ThreadCall {
    ThreadCall {
        cycle: ThreadCycle::G78,
        start: FARTHEST,
        end_x: at(-FAR),
        end_z: at(-FAR),
        taper: at(-FAR),
        height: at(FAR),
        first_depth: at(FAR),
        min_step: at(FAR),
        allowance: at(FAR),
        finish_passes: at(99),
        angle: at(99),
        infeed: Infeed::Decreasing,
        cut_in: at(CutIn::Trailing),
        starts: at(99),
        run_in: at(FAR),
        run_out: Some(RunOut {
            short: at(FAR),
            long: at(FAR),
            short_rest: Remainder::from_raw(1 << 14),
            long_rest: Remainder::from_raw(-(1 << 14)),
        }),
        lead: at(Lead::new((1 << 50) - 1, 1 << 28).unwrap()),
        change: at(LeadChange::NONE),
        first_angle: StartAngle::from_mdeg(359_999),
        part: ChainPart::Whole,
        increment: FAR,
        rpm: Rpm::new(-(1 << 20)),
    }
}

fn tap() -> TapCall {
    let peck = TapPeck {
        infeed: at(FAR),
        back: at(FAR),
    };
    TapCall {
        cycle: TapCycle::G88,
        mode: TapMode::Rigid,
        axis: TapAxis::X,
        start: FARTHEST,
        hole: FARTHEST,
        step: FARTHEST,
        level: at(FAR),
        bottom: at(-FAR),
        form: TapForm::Deep(peck),
        dwell: Millis::new(99_999_999),
        lead: at(Lead::new((1 << 50) - 1, 1 << 20).unwrap()),
        hand: HandChoice::Written(Hand::Left),
        speed: CentiRpm::new(100 << 20),
        extract: CentiRpm::new(100 << 20),
        spindle: SpindleChoice::Written(TapSpindle::Fourth),
        repeat: TapRepeat::Holes(NonZeroU8::MAX),
        clamp: Some(u16::MAX),
        continues: true,
        notes: TapNotes {
            unit: LengthUnit::Inch,
            plane: Plane::G19,
            extraction: Extraction::new(u32::MAX, u32::MAX).unwrap(),
        },
    }
}

fn groove() -> GrooveCall {
    GrooveCall {
        axis: TapAxis::X,
        start: FARTHEST,
        end_x: at(FAR),
        end_z: at(FAR),
        last_written: true,
        peck: Some(at(FAR)),
        step: Some(at(FAR)),
        relief: at(FAR),
        retract: at(FAR),
        feed: FeedRate::PerTurn(FeedPerTurn::from_nm(1 << 42), Rpm::new(-(1 << 20))),
    }
}

#[test]
fn calls_come_back_equal_and_the_longest_fits() {
    let mut longest = 0;
    for kind in [
        CallKind::Rapid(FARTHEST),
        CallKind::Line(FARTHEST, groove().feed),
        CallKind::Spindle(SpindleCall::rigid(
            Rpm::new(-(1 << 20)),
            SpindleChoice::default(),
        )),
        CallKind::Spindle(SpindleCall::orient(Angle::from_udeg(359_999_999))),
        CallKind::Aux(Aux::T(u16::MAX)),
        CallKind::Thread(thread()),
        CallKind::Thread(ThreadCall {
            cycle: ThreadCycle::G32,
            part: ChainPart::Last,
            ..thread()
        }),
        CallKind::Thread(ThreadCall {
            cycle: ThreadCycle::G32,
            part: ChainPart::Middle,
            run_out: None,
            ..thread()
        }),
        CallKind::Groove(groove()),
        CallKind::Tap(tap()),
        CallKind::End(30),
        CallKind::Over,
        CallKind::ExactStop(true),
        CallKind::LineOver,
    ] {
        let call = call(kind);
        assert_eq!(bounds::call(&call), Ok(()));
        let bytes = encode_call(&call).unwrap();
        assert_eq!(decode_call(&bytes), Ok((call, bytes.len())));
        longest = longest.max(bytes.len());
        // A byte less is no call.
        assert_eq!(
            decode_call(&bytes[..bytes.len() - 1]),
            Err(LinkError::Malformed)
        );
    }
    // The longest possible call, alone in a batch.
    assert!(longest > 200, "{longest}");
    assert!(longest <= CALL_BYTES, "{longest}");
    let mut batch = BatchWriter::new(u32::MAX, Revision(0), u32::MAX);
    assert!(batch.bytes().len() + CALL_BYTES <= BATCH_BYTES);
    let bytes = encode_call(&call(CallKind::Thread(thread()))).unwrap();
    batch.push(&bytes).unwrap();
    assert_eq!(batch.count(), 1);
}

#[test]
fn a_batch_gives_its_calls_and_their_bytes() {
    let calls: Vec<Call> = [
        CallKind::Rapid(Position::ZERO),
        CallKind::Thread(thread()),
        CallKind::Over,
    ]
    .map(call)
    .to_vec();
    let mut writer = BatchWriter::new(7, Revision(0), 41);
    for call in &calls {
        writer.push(&encode_call(call).unwrap()).unwrap();
    }
    let full = encode_call(&calls[1]).unwrap();
    let before = writer.bytes().len();
    while writer.push(&full).is_ok() {}
    assert_eq!((writer.bytes().len() - before) % full.len(), 0);

    let batch = Batch::new(&writer.bytes()[..before]).unwrap();
    assert_eq!((batch.program, batch.first), (7, 41));
    let read: Vec<_> = batch.map(Result::unwrap).collect();
    let bytes: Vec<_> = calls.iter().map(|c| encode_call(c).unwrap()).collect();
    assert_eq!(read.len(), 3);
    for ((call, taken), (expected, encoded)) in read.iter().zip(calls.iter().zip(&bytes)) {
        assert_eq!((call, *taken), (expected, &encoded[..]));
    }
}

#[test]
fn a_batch_of_another_version_is_not_looked_at_further() {
    let mut bytes = Vec::from(BatchWriter::new(1, Revision(0), 0).bytes());
    // The number is one byte; the key is the four bytes after it.
    bytes[1] ^= 0xFF;
    let other = Version {
        key: VERSION.key ^ 0xFF,
        ..VERSION
    };
    assert_eq!(
        Batch::new(&bytes).map(|_| ()),
        Err(BatchError::Version(other))
    );
    assert_eq!(Batch::new(&[1, 2]).map(|_| ()), Err(BatchError::Malformed));
}

#[test]
fn what_no_program_can_say_is_refused() {
    let beyond = Length::from_nm(FAR.nm() + 1);
    let further = Position {
        z: beyond,
        ..Position::ZERO
    };
    let turned = Position {
        c: Angle::from_udeg(i64::MIN),
        ..Position::ZERO
    };
    let cases = [
        (CallKind::Rapid(further), Beyond::Position),
        (CallKind::Rapid(turned), Beyond::Position),
        (
            CallKind::Line(Position::ZERO, FeedRate::PerMinute(Feed::default())),
            Beyond::Feed,
        ),
        (CallKind::Dwell(Millis::new(100_000_000)), Beyond::Dwell),
        (
            CallKind::Spindle(SpindleCall::speed(Rpm::new(i32::MIN))),
            Beyond::Speed,
        ),
        (
            CallKind::Thread(ThreadCall {
                height: at(Length::ZERO),
                ..thread()
            }),
            Beyond::Length,
        ),
        (
            CallKind::Thread(ThreadCall {
                min_step: at(Length::from_nm(-1)),
                ..thread()
            }),
            Beyond::Length,
        ),
        (
            CallKind::Thread(ThreadCall {
                starts: at(0),
                ..thread()
            }),
            Beyond::Count,
        ),
        (
            // Strokes of G32 alone make a chain.
            CallKind::Thread(ThreadCall {
                part: ChainPart::Last,
                ..thread()
            }),
            Beyond::Chain,
        ),
        (
            // A run-out before the end of a chain.
            CallKind::Thread(ThreadCall {
                cycle: ThreadCycle::G32,
                part: ChainPart::First,
                ..thread()
            }),
            Beyond::Chain,
        ),
        (
            // A lead changes in G34 alone.
            CallKind::Thread(ThreadCall {
                change: at(LeadChange::from_pm(1)),
                ..thread()
            }),
            Beyond::Lead,
        ),
        (
            CallKind::Thread(ThreadCall {
                cycle: ThreadCycle::G34,
                change: at(LeadChange::from_pm(-500_000_000_001)),
                run_out: None,
                ..thread()
            }),
            Beyond::Lead,
        ),
        (
            CallKind::Thread(ThreadCall {
                cycle: ThreadCycle::G34,
                ..thread()
            }),
            Beyond::Length,
        ),
        (
            CallKind::Thread(ThreadCall {
                lead: at(Lead::new((1 << 50) + 1, 1).unwrap()),
                ..thread()
            }),
            Beyond::Lead,
        ),
        (
            CallKind::Groove(GrooveCall {
                peck: Some(at(Length::from_nm(-1))),
                ..groove()
            }),
            Beyond::Length,
        ),
        (
            CallKind::Tap(TapCall {
                speed: CentiRpm::new(0),
                ..tap()
            }),
            Beyond::Speed,
        ),
        (
            CallKind::Tap(TapCall {
                mode: TapMode::Floating,
                speed: CentiRpm::new(-1),
                ..tap()
            }),
            Beyond::Speed,
        ),
        (
            CallKind::Tap(TapCall {
                lead: at(Lead::new(1, 1 << 28).unwrap()),
                ..tap()
            }),
            Beyond::Lead,
        ),
    ];
    for (kind, expected) in cases {
        let bad = call(kind);
        let mut batch = BatchWriter::new(0, Revision(0), 0);
        batch
            .push(&encode_call(&call(CallKind::Over)).unwrap())
            .unwrap();
        batch.push(&encode_call(&bad).unwrap()).unwrap();
        let mut read = Batch::new(batch.bytes()).unwrap();
        assert!(read.next().unwrap().is_ok());
        assert_eq!(read.next(), Some(Err(BatchError::Bounds(1, expected))));
        assert_eq!(read.next(), None, "nothing behind it is looked at");
    }
}

#[test]
fn a_lead_of_nothing_cannot_be_decoded() {
    let mut bytes = [0; 8];
    for ratio in [(0_i64, 1_i64), (1, 0), (-1, 1), (1, i64::MIN)] {
        let used = postcard::to_slice(&ratio, &mut bytes[..]);
        let encoded = match used {
            Ok(used) => Vec::from(used),
            Err(_) => continue,
        };
        assert!(postcard::from_bytes::<Lead>(&encoded).is_err(), "{ratio:?}");
    }
    let lead = postcard::from_bytes::<Lead>(postcard::to_slice(&(6, 4), &mut bytes).unwrap());
    assert_eq!(lead.ok(), Lead::new(3, 2));
}

/// The encoding is that of serde for the types: the hand-written reader accepts and refuses the same bytes.
#[test]
fn a_call_is_read_as_serde_reads_it() {
    let kinds = [
        CallKind::Rapid(FARTHEST),
        CallKind::Line(FARTHEST, groove().feed),
        CallKind::Arc(ArcCall {
            end: FARTHEST,
            i: -FAR,
            k: FAR,
            clockwise: true,
            feed: FeedRate::PerMinute(Feed::from_nm_per_min(1 << 42)),
        }),
        CallKind::Dwell(Millis::new(99_999_999)),
        CallKind::Spindle(SpindleCall::rigid(
            Rpm::new(-1),
            SpindleChoice::Signals {
                by: Selection::Rgtsp,
                otherwise: TapSpindle::Third,
            },
        )),
        CallKind::Aux(Aux::M(300)),
        CallKind::Thread(thread()),
        CallKind::Groove(groove()),
        CallKind::Tap(tap()),
        CallKind::TapReturn(TapReturn {
            speed: Some(CentiRpm::new(-7)),
            highest: CentiRpm::new(500_000),
            beyond: FAR,
            unit: LengthUnit::Inch,
        }),
        CallKind::End(30),
        CallKind::Over,
        CallKind::ExactStop(true),
        CallKind::LineOver,
    ];
    let mut state = 7_u64;
    let mut noise = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        state
    };
    let (mut taken, mut refused) = (0, 0);
    for kind in kinds {
        let encoded = encode_call(&call(kind)).unwrap();
        for _ in 0..20_000 {
            let mut bytes = Vec::from(&encoded[..]);
            // One to four bytes, each with any value or a small one, and sometimes a missing end.
            for _ in 0..=noise() % 4 {
                let place = noise() as usize % bytes.len();
                let byte = noise();
                bytes[place] = (byte >> 8) as u8 & if byte & 1 == 0 { 0xFF } else { 0x03 };
            }
            if noise() % 8 == 0 {
                bytes.truncate(noise() as usize % bytes.len());
            }
            let expected = postcard::take_from_bytes::<Call>(&bytes)
                .map(|(call, rest)| (call, bytes.len() - rest.len()))
                .map_err(|_| LinkError::Malformed);
            match expected {
                Ok(_) => taken += 1,
                Err(_) => refused += 1,
            }
            assert_eq!(decode_call(&bytes), expected, "{bytes:?}");
        }
    }
    assert!(taken > 30_000 && refused > 30_000, "{taken} {refused}");
}

#[test]
fn noise_never_panics_and_never_gives_a_call_beyond_its_bounds() {
    let mut state = 1_u64;
    let mut calls = 0;
    for _ in 0..50_000 {
        let mut bytes = Vec::from(BatchWriter::new(0, Revision(0), 0).bytes());
        let head = bytes.len();
        for _ in 0..80 {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            // Mostly small, as varints are.
            bytes.push((state >> 32) as u8 & if state & 3 == 0 { 0xFF } else { 0x07 });
        }
        for (call, _) in Batch::new(&bytes).unwrap().flatten() {
            assert_eq!(bounds::call(&call), Ok(()));
            calls += 1;
        }
        for entry in EventReader::new(&bytes[head..]) {
            let _ = entry;
        }
        let _ = Status::decode(&bytes);
    }
    assert!(calls > 10_000, "{calls}");
}

#[test]
fn events_and_status_come_back_equal() {
    let alarm = Alarm::new(Code::FollowingError, SPAN).word(b'P').with([
        Arg::Letter(b'X'),
        Arg::Int(i64::MIN),
        Arg::Length(FAR),
        Arg::Statusword(0x1237),
    ]);
    let entries = [
        Event::Ready,
        Event::Started { number: 7, line: 9 },
        Event::Spindle(Rpm::new(-300)),
        Event::Aux(Aux::M(8)),
        Event::Alarm(alarm),
        Event::Finished,
    ];
    let mut bytes = [0; 256];
    let mut used = 0;
    let entries: Vec<Logged> = (1..)
        .zip(entries)
        .map(|(number, event)| Logged {
            number,
            tick: u64::MAX,
            event,
        })
        .collect();
    for entry in &entries {
        used += encode_event(entry.number, entry.tick, &entry.event, &mut bytes[used..]).unwrap();
    }
    let read: Vec<_> = EventReader::new(&bytes[..used])
        .map(Result::unwrap)
        .collect();
    assert_eq!(read, entries);

    let status = Status {
        version: VERSION,
        tick: u64::MAX,
        state: BoardState::Alarm,
        alarm: Some(alarm),
        in_program: true,
        left: Some(FARTHEST),
        line: u32::MAX,
        number: u32::MAX,
        position: FARTHEST,
        spindle: Turns::from_raw(i64::MIN),
        speed: TurnRate::from_raw(i64::MIN),
        command: Rpm::new(i32::MIN),
        hold: true,
        single_block: true,
        feed_percent: 150,
        rapid_percent: 100,
        spindle_percent: 120,
        sync_error: Some(Length::from_nm(i64::MIN)),
        late: u32::MAX,
        program: u32::MAX,
        next_call: u32::MAX,
        credit: u16::MAX,
        newest_event: u32::MAX,
        signals: u16::MAX,
        referenced: Axes::ALL,
        unreferenced: Axes::ALL,
        parameters: identity(&Params::sheets()),
    };
    let mut bytes = [0; Status::BYTES];
    let used = status.encode(&mut bytes).unwrap();
    assert_eq!(Status::decode(&bytes[..used]), Ok(Ok(status)));
    let mut other = Vec::from(&bytes[..used]);
    other[1] ^= 1;
    let version = Version {
        key: VERSION.key ^ 1,
        ..VERSION
    };
    assert_eq!(Status::decode(&other), Ok(Err(version)));
}
