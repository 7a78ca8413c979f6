//! Lines of any content on both ends of a serial CAN adapter.

use leadscrew_slcan::{Adapter, Heard, Lines, Reply, Request};

/// What is understood must mean the same when it is written again.
///
/// # Panics
/// Where it does not.
pub fn slcan(data: &[u8]) {
    let mut lines = Lines::new();
    let mut adapter = Adapter::new(0x10, 0x10, *b"0001");
    for byte in data {
        let Some(heard) = lines.push(*byte) else {
            continue;
        };
        if let Some(request) = Request::of(heard) {
            let line = request.line();
            let (text, end) = line.bytes().split_at(line.bytes().len() - 1);
            assert_eq!(end, b"\r");
            assert_eq!(Request::of(Heard::Line(text)), Some(request));
        }
        if let Some(reply) = Reply::of(heard) {
            let again = reply.line();
            assert!(!again.bytes().is_empty());
        }
        let handled = adapter.handle(heard);
        assert!(!handled.reply.line().bytes().is_empty());
    }
}
