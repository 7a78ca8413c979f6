//! From text to calls. This code runs where the text is, which is not the board. The link test still proves that it
//! reads arbitrary bytes without a panic.

use audit::any::{any, sink};
use leadscrew_core::params::Params;
use leadscrew_core::program::{Events, Interpreter, Reader};
use leadscrew_core::units::Decimal;

/// Calls all entries of this module.
pub fn all() {
    events();
    lines();
    chunks();
    traced();
    decimal();
}

const BYTES: usize = 600;

#[inline(never)]
fn events() {
    let params: Params = any();
    let bytes: [u8; BYTES] = any();
    let text = bytes.get(..any()).unwrap_or(&bytes);
    Events::new(text, &params, any()).for_each(sink);
}

#[inline(never)]
fn lines() {
    let params: Params = any();
    let mut interpreter = Interpreter::new(&params, any());
    while any() {
        let bytes: [u8; BYTES] = any();
        let text = bytes.get(..any()).unwrap_or(&bytes);
        sink(interpreter.line(text, any(), &mut sink));
        sink((
            interpreter.is_ended(),
            interpreter.position(),
            interpreter.finish(&mut sink),
        ));
    }
}

#[inline(never)]
fn chunks() {
    let params: Params = any();
    let mut reader = Reader::new(&params, any());
    while any() {
        let bytes: [u8; BYTES] = any();
        let text = bytes.get(..any()).unwrap_or(&bytes);
        sink(reader.push(text, &mut sink));
    }
    sink(reader.finish(&mut sink));
}

#[inline(never)]
fn traced() {
    let params: Params = any();
    let mut interpreter = Interpreter::new(&params, any());
    while any() {
        sink(interpreter.line(&any::<[u8; 80]>(), any(), &mut sink));
        sink(interpreter.trace(any(), any(), any(), &mut sink));
        sink(interpreter.in_force());
    }
}

#[inline(never)]
fn decimal() {
    let bytes: [u8; 64] = any();
    let (decimal, rest) = Decimal::parse(bytes.get(..any()).unwrap_or(&bytes));
    sink((decimal.scaled(any()), rest.len()));
    sink(Decimal::new(any(), any()).scaled(any()));
}
