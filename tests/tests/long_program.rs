//! A program is as long as it likes: the text is made while it is read, and goes through the board in the 2 KiB that the
//! board has for it.

use std::io::Read as _;

use leadscrew_core::board::device::PROGRAM_BYTES;
use leadscrew_tests::long_program::LongProgram;
use leadscrew_tests::stream::{directly, over_the_wire};

/// A thousand times the board's memory for programs. `cargo xtask bench long` runs a hundred megabytes.
const BYTES: u64 = 5_000_000;

#[test]
fn a_long_program_goes_through_a_small_board() {
    const { assert!(PROGRAM_BYTES <= 16 << 10) };
    let mut text = LongProgram::new(BYTES);
    let (ran, certificate) = over_the_wire(&mut text);
    let share = text.share();
    assert!(share.bytes >= BYTES);
    // Four tenths of it are words, and every line of it is a block.
    assert!(share.code * 10 > share.bytes * 4, "{share:?}");
    // A thread is three calls, for its first block is a setting; the beginning is three more, the end two.
    let blocks = share.moves + 3 * share.threads;
    assert_eq!(ran.calls, blocks + 5, "{share:?}");
    assert!(ran.finished);
    assert_eq!(u64::from(ran.line), share.lines);
    let end = (ran.position.x.nm(), ran.position.z.nm());
    assert_eq!(end, (50_000_000, 50_000_000));
    assert_eq!(certificate.setpoint_hash, Some(ran.hash));

    let direct = directly(LongProgram::new(BYTES));
    assert_eq!(direct, ran);
}

#[test]
fn the_text_is_the_same_however_it_is_read() {
    let mut whole = Vec::new();
    let mut text = LongProgram::new(100_000);
    text.read_to_end(&mut whole).unwrap();
    assert_eq!(text.share().bytes, whole.len() as u64);
    let mut bits = Vec::new();
    let mut text = LongProgram::new(100_000);
    let mut some = [0; 13];
    loop {
        let count = text.read(&mut some).unwrap();
        if count == 0 {
            break;
        }
        bits.extend_from_slice(&some[..count]);
    }
    assert!(bits == whole);
    let lines = whole.iter().filter(|&&byte| byte == b'\n').count();
    assert_eq!(text.share().lines, lines as u64);
}
