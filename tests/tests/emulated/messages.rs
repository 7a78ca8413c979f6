//! What the image with the feature `defmt` says on the emulator's output, read with the texts that lie in the image.

use std::collections::HashMap;

use object::{Object as _, ObjectSymbol as _};

use crate::board::{Board, eventually, field, image_of, program};

const IMAGE: &str = "LEADSCREW_IMAGE_DEFMT";

#[test]
fn what_happens_is_told() {
    let texts = texts(&std::fs::read(image_of(IMAGE)).expect("the image"));
    let board = Board::start_image(IMAGE, &[]);
    board.good(&["run", &program("O0001\nG98\nG1 Z-2 F600\nM30\n")]);
    board.order("stop");
    board.wait_for("it stands", |status| field(status, "state") == "alarm");
    let told = || -> Vec<String> {
        let said = board.said();
        // After the last end there may be half a frame.
        let end = said.iter().rposition(|byte| *byte == 0).unwrap_or(0);
        let frames = said[..end].split(|byte| *byte == 0);
        let frames = frames.filter(|frame| !frame.is_empty());
        frames.map(|frame| message(frame, &texts)).collect()
    };
    eventually("all of it", || told().len() >= 7);
    assert_eq!(
        told(),
        [
            "info: started by power",
            "info: ready",
            "warn: warning 4972",
            "debug: move 1 line 3",
            "debug: move 2 line 4",
            "info: finished",
            "error: alarm 4300",
        ]
    );
}

/// By number, level and text of each message of an image: names of symbols, as JSON.
fn texts(image: &[u8]) -> HashMap<u16, (String, String)> {
    let file = object::File::parse(image).expect("an image");
    let symbols = file.symbols().filter_map(|symbol| {
        let name = symbol.name().ok()?;
        let level = part(name, "\"tag\":\"defmt_")?;
        let text = part(name, "\"data\":\"")?;
        let number = u16::try_from(symbol.address()).ok()?;
        Some((number, (level.to_owned(), text.to_owned())))
    });
    symbols.collect()
}

/// What stands between `begin` and the next quotation mark.
fn part<'a>(name: &'a str, begin: &str) -> Option<&'a str> {
    let (_, rest) = name.split_once(begin)?;
    rest.split_once('"').map(|(part, _)| part)
}

/// A frame in words: a number of two bytes, then the values in the order of their places in the text.
#[track_caller]
fn message(frame: &[u8], texts: &HashMap<u16, (String, String)>) -> String {
    let bytes = unpacked(frame);
    let mut rest = &bytes[..];
    let mut take = |count: usize| {
        let (taken, left) = rest.split_at(count);
        rest = left;
        let mut value = [0; 4];
        value[..count.min(4)].copy_from_slice(&taken[..count.min(4)]);
        (taken, u32::from_le_bytes(value))
    };
    let (_, number) = take(2);
    let (level, text) = texts
        .get(&(number as u16))
        .unwrap_or_else(|| panic!("no message {number}: {frame:02X?}"));
    let mut words = format!("{level}: ");
    let mut pieces = text.split('{');
    words.push_str(pieces.next().expect("one at least"));
    for piece in pieces {
        let (kind, after) = piece.split_once('}').expect("a place");
        match kind {
            "=u16" => words.push_str(&take(2).1.to_string()),
            "=u32" => words.push_str(&take(4).1.to_string()),
            "=str" => {
                let (_, length) = take(4);
                words.push_str(std::str::from_utf8(take(length as usize).0).expect("a word"));
            }
            _ => panic!("`{kind}` is not read here"),
        }
        words.push_str(after);
    }
    words
}

/// A frame without its packing (rzCOBS). Read from its end: a byte below 128 tells
/// for seven bytes which are 0, one above it how many come that are none.
fn unpacked(frame: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut packed = frame.iter().rev().copied();
    while let Some(control) = packed.next() {
        let mut next = || packed.next().expect("the frame is whole");
        match control {
            0..=0x7F => {
                for bit in (0..7).rev() {
                    let zero = control & 1 << bit != 0;
                    bytes.push(if zero { 0 } else { next() });
                }
            }
            0x80..=0xFE => {
                bytes.push(0);
                bytes.extend((0..(control & 0x7F) + 7).map(|_| next()));
            }
            0xFF => bytes.extend((0..134).map(|_| next())),
        }
    }
    bytes.reverse();
    bytes
}
