//! Program text: read whole and in pieces, expanded, judged.

use leadscrew_common::line_ends::LineEnds;
use leadscrew_core::alarm::Alarm;
use leadscrew_core::call::{Call, CallKind, Position};
use leadscrew_core::cycle::{self, Context, Moves, expand};
use leadscrew_core::params::Params;
use leadscrew_core::program::{Dialect, Event, Events, Options, Reader};
use leadscrew_core::signals::Signals;

/// The most moves of one program that are checked; a few bytes can ask for millions.
const MOVES: usize = 5000;

/// A position is within ±2⁴² nm at the input, and what a cycle adds stays near it.
const FAR: i64 = 1 << 44;

/// The first byte chooses the dialect, the block skip and the pieces of the text. The rest is text.
///
/// # Panics
/// Where the pieces change the result, an alarm stands outside of the text, or a move leaves the range of positions.
pub fn program(data: &[u8]) {
    let Some((choice, text)) = data.split_first() else {
        return;
    };
    line_ends(text, usize::from(choice >> 4) + 1);
    let params = Params::sheets();
    let options = Options {
        dialect: if choice & 1 == 0 {
            Dialect::Gsk980td
        } else {
            Dialect::Gsk988
        },
        skip: choice & 2 != 0,
        optional_stop: choice & 4 != 0,
        dry_run: choice & 8 != 0,
        ..Options::default()
    };
    let (events, end) = whole(text, &params, options);
    let (again, same_end) = in_pieces(text, usize::from(choice >> 4) + 1, &params, options);
    assert_eq!(events, again, "pieces make a difference");
    assert_eq!(end, same_end, "pieces make a difference to the end");
    if let Err(alarm) = end {
        lies_within(&alarm, text);
    }
    let calls = events.into_iter().filter_map(|event| match event {
        Event::Call(call) => Some(call),
        Event::Warning(warning) => {
            lies_within(&warning, text);
            None
        }
    });
    look_at(calls, text, &params, options.position);
}

/// Line ends of any kind become line feeds, also in pieces, and all other bytes keep their places.
fn line_ends(text: &[u8], size: usize) {
    let (mut ends, mut whole) = (LineEnds::default(), text.to_vec());
    assert_eq!(ends.translate(&mut whole, true), text.len());
    let (mut ends, mut again, mut rest) = (LineEnds::default(), Vec::new(), Vec::new());
    for piece in text.chunks(size) {
        rest.extend_from_slice(piece);
        let done = ends.translate(&mut rest, false);
        again.extend(rest.drain(..done));
    }
    let done = ends.translate(&mut rest, true);
    again.extend(rest.drain(..done));
    assert_eq!(whole, again, "pieces make a difference to line ends");
    let end = |byte: &u8| matches!(byte, b'\r' | b'\n');
    let kept = |(old, new): (&u8, &u8)| old == new || (end(old) && matches!(new, b' ' | b'\n'));
    assert!(text.iter().zip(&whole).all(kept));
}

fn whole(text: &[u8], params: &Params, options: Options) -> (Vec<Event>, Result<(), Alarm>) {
    let mut events = Vec::new();
    for event in Events::new(text, params, options) {
        match event {
            Ok(event) => events.push(event),
            Err(alarm) => return (events, Err(alarm)),
        }
    }
    (events, Ok(()))
}

fn in_pieces(
    text: &[u8],
    size: usize,
    params: &Params,
    options: Options,
) -> (Vec<Event>, Result<(), Alarm>) {
    let mut events = Vec::new();
    let mut reader = Reader::new(params, options);
    let mut take = |event| events.push(event);
    let mut end = Ok(());
    for piece in text.chunks(size) {
        end = reader.push(piece, &mut take);
        if end.is_err() {
            break;
        }
    }
    if end.is_ok() {
        end = reader.finish(&mut take);
    }
    (events, end)
}

/// An alarm must name an existing line and columns in order.
fn lies_within(alarm: &Alarm, text: &[u8]) {
    let lines = text.iter().filter(|byte| **byte == b'\n').count() + 1;
    let span = alarm.span;
    assert!(span.line as usize <= lines, "{alarm:?} of {lines} lines");
    assert!(span.column <= span.end, "{alarm:?}");
    assert!(alarm.number() != 0, "{alarm:?}");
}

/// Expands every call as the board would, each from the end of the call before.
fn look_at(calls: impl Iterator<Item = Call>, text: &[u8], params: &Params, from: Position) {
    let mut at = from;
    let mut left = MOVES;
    for call in calls {
        let judged = match &call.kind {
            CallKind::Thread(thread) => cycle::thread_report(thread, call.span, params).err(),
            CallKind::Tap(tap) => {
                cycle::tap_report(tap, Signals::default(), call.span, params).err()
            }
            _ => None,
        };
        let moves = match expand(&call, &Context::standing(at)) {
            Ok(moves) => moves,
            Err(alarm) => return lies_within(&alarm, text),
        };
        if let Some(alarm) = judged {
            return lies_within(&alarm, text);
        }
        if let Moves::Groove(groove) = &moves {
            let totals = groove.totals();
            assert!(totals.infeeds * totals.columns <= 99_999, "{call:?}");
            let mut steps = 0;
            let all = groove.tally(&mut |_, _, _| {
                steps += 1;
                Ok(())
            });
            assert!(all.is_ok() && steps <= 32, "{call:?}: {steps} steps");
        }
        for next in moves.take(left) {
            left -= 1;
            at = next.to;
            for nm in [at.x.nm(), at.z.nm(), at.c.udeg()] {
                assert!(nm.abs() < FAR, "{next:?}");
            }
        }
        if left == 0 {
            return;
        }
    }
}
