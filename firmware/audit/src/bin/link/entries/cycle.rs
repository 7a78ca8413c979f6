//! From calls to moves.

use audit::any::{any, sink};
use leadscrew_core::call::{Call, GrooveCall, TapCall, ThreadCall};
use leadscrew_core::cycle::{Context, GrooveMoves, TapMoves, ThreadMoves, expand};
use leadscrew_core::journal::TapRecord;
use leadscrew_core::signals::{Signal, Signals};

/// Calls all entries of this module.
pub fn all() {
    any_call();
    thread();
    groove();
    tap();
    signals();
}

#[inline(never)]
fn any_call() {
    let record: Option<TapRecord> = any();
    let context = Context {
        at: any(),
        signals: any(),
        tap: record.as_ref(),
    };
    if let Ok(moves) = expand(&any::<Call>(), &context) {
        sink(moves.warning());
        moves.for_each(sink);
    }
}

#[inline(never)]
fn thread() {
    if let Ok(moves) = ThreadMoves::new(&any::<ThreadCall>(), any()) {
        sink(moves.summary());
        moves.for_each(sink);
    }
}

#[inline(never)]
fn groove() {
    if let Ok(moves) = GrooveMoves::new(&any::<GrooveCall>(), any()) {
        sink(moves.warning());
        moves.for_each(sink);
    }
}

#[inline(never)]
fn tap() {
    if let Ok(moves) = TapMoves::new(&any::<TapCall>(), any(), any()) {
        moves.for_each(sink);
    }
}

#[inline(never)]
fn signals() {
    let mut signals: Signals = any();
    for signal in Signal::ALL {
        signals.set(signal, any());
    }
    sink(Signals::from_bits(any()));
    sink(signals.bits());
    sink(signals.hand(any()));
    sink(signals.spindle(any(), any()));
    let name: [u8; 4] = any();
    sink(core::str::from_utf8(&name).map(Signal::find));
}
