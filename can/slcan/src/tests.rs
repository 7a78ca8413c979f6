use std::string::String;
use std::vec::Vec;

use super::*;
use leadscrew_core::bus::{CobId, Frame};

fn cut(text: &[u8]) -> Vec<Option<Request>> {
    let mut lines = Lines::new();
    text.iter()
        .filter_map(|byte| lines.push(*byte).map(Request::of))
        .collect()
}

fn replies(text: &[u8]) -> Vec<Option<Reply>> {
    let mut lines = Lines::new();
    text.iter()
        .filter_map(|byte| lines.push(*byte).map(Reply::of))
        .collect()
}

fn data(id: u16, payload: &[u8]) -> SlcanFrame {
    SlcanFrame::Data(Frame::new(CobId::new(id).unwrap(), payload).unwrap())
}

fn extended(id: u32, payload: &[u8]) -> SlcanFrame {
    SlcanFrame::Extended(ExtendedFrame::new(ExtendedId::new(id).unwrap(), payload).unwrap())
}

fn remote(id: u16, len: u8) -> SlcanFrame {
    SlcanFrame::Remote(CobId::new(id).unwrap(), len)
}

fn remote_extended(id: u32, len: u8) -> SlcanFrame {
    SlcanFrame::RemoteExtended(ExtendedId::new(id).unwrap(), len)
}

#[test]
fn every_request_is_the_line_of_the_protocol_and_comes_back() {
    for (request, text) in [
        (Request::Rate(BitRate::M1), "S8\r"),
        (Request::Rate(BitRate::K10), "S0\r"),
        (Request::Timing(0x03, 0x1C), "s031C\r"),
        (Request::Open, "O\r"),
        (Request::Listen, "L\r"),
        (Request::Close, "C\r"),
        (Request::Send(data(0x100, &[])), "t1000\r"),
        (Request::Send(data(0x7FF, &[0x11, 0x33])), "t7FF21133\r"),
        (Request::Send(extended(0x100, &[])), "T000001000\r"),
        (
            Request::Send(extended(0x1FFF_FFFF, &[0xAA; 8])),
            "T1FFFFFFF8AAAAAAAAAAAAAAAA\r",
        ),
        (Request::Send(remote(0x100, 2)), "r1002\r"),
        (Request::Send(remote_extended(0x100, 8)), "R000001008\r"),
        (Request::Version, "V\r"),
        (Request::Serial, "N\r"),
        (Request::Flags, "F\r"),
        (Request::Stamps(true), "Z1\r"),
        (Request::Stamps(false), "Z0\r"),
        (Request::Code(0), "M00000000\r"),
        (Request::Mask(0xFFFF_FFFF), "mFFFFFFFF\r"),
    ] {
        let line = request.line();
        assert_eq!(String::from_utf8_lossy(line.bytes()), text);
        assert_eq!(cut(text.as_bytes()), [Some(request)]);
    }
}

#[test]
fn every_reply_is_the_line_of_the_protocol_and_comes_back() {
    for (reply, text) in [
        (Reply::Done, "\r"),
        (Reply::Refused, "\x07"),
        (Reply::Sent, "z\r"),
        (Reply::SentExtended, "Z\r"),
        (Reply::Version(0x10, 0x13), "V1013\r"),
        (Reply::Serial(*b"A123"), "NA123\r"),
        (Reply::Flags(Flags::PASSIVE.with(Flags::OVERRUN)), "F28\r"),
        (Reply::Frame(data(0x190, &[0x27, 6]), None), "t19022706\r"),
        (
            Reply::Frame(data(0x190, &[0x27, 6]), Some(Stamp::at(59_999))),
            "t19022706EA5F\r",
        ),
        (
            Reply::Frame(extended(0x1ABC_DEF0, &[1; 8]), Some(Stamp::at(60_001))),
            "T1ABCDEF0801010101010101010001\r",
        ),
        (Reply::Frame(remote(0x701, 1), None), "r7011\r"),
        (
            Reply::Frame(remote_extended(1, 0), Some(Stamp::at(16))),
            "R0000000100010\r",
        ),
    ] {
        let line = reply.line();
        assert_eq!(String::from_utf8_lossy(line.bytes()), text);
        assert_eq!(replies(text.as_bytes()), [Some(reply)]);
    }
}

#[test]
fn lower_case_digits_and_line_feeds_are_understood() {
    assert_eq!(
        cut(b"t7ff2ab0c\r\nO\r\n"),
        [
            Some(Request::Send(data(0x7FF, &[0xAB, 0x0C]))),
            Some(Request::Open)
        ]
    );
}

#[test]
fn what_is_no_request_is_refused_and_the_next_is_heard() {
    for wrong in [
        "X1",
        "S9",
        "S",
        "S10",
        "Z2",
        "O1",
        "t",
        "t10",
        "t1009",
        "t1001",
        "t10011",
        "t1001G0",
        "t800",
        "t10011122",
        "T2000000000",
        "T0000010",
        "r1009",
        "M0000000",
        "M000000000",
        "s0313C",
        "m0000000G",
        "sG31C",
        "t-110",
    ] {
        let text = std::format!("{wrong}\rV\r");
        assert_eq!(
            cut(text.as_bytes()),
            [None, Some(Request::Version)],
            "{wrong}"
        );
    }
    let mut long = std::vec![b't'; 200];
    long.extend(b"\rV\r");
    assert_eq!(cut(&long), [None, Some(Request::Version)]);
}

#[test]
fn a_bell_ends_what_came_before_it() {
    assert_eq!(
        replies(b"t190\x07z\r"),
        [Some(Reply::Refused), Some(Reply::Sent)]
    );
}

#[test]
fn any_bytes_at_all_are_survived_and_whole_frames_found() {
    leadscrew_seed::volume(1, |seed| {
        let mut random = leadscrew_seed::Random(seed);
        let mut random = |below| random.index(below);
        let letters = b"tTrRSsOLCVNFZMm0123456789ABCDEF\r\r\r\r\x07\n";
        let mut lines = Lines::new();
        let mut adapter = Adapter::new(0x10, 0x10, *b"TEST");
        talk(&mut adapter, "S8\rO\r");
        let (mut heard, mut sent) = (0, 0);
        for _ in 0..50_000 {
            // Noise, and a frame with one byte of it wrong.
            let mut text: Vec<u8> = (0..random(20))
                .map(|_| letters[random(letters.len())])
                .collect();
            let mut frame = b"\rt7FF21133\r".to_vec();
            let place = random(frame.len());
            frame[place] = letters[random(letters.len())];
            text.extend(frame);
            for byte in text {
                let Some(line) = lines.push(byte) else {
                    continue;
                };
                heard += 1;
                if let Some(frame) = adapter.handle(line).send {
                    sent += 1;
                    // A request that was read is written as a line with the same meaning.
                    let line = Request::Send(frame).line();
                    assert_eq!(cut(line.bytes()), [Some(Request::Send(frame))]);
                }
                if !adapter.is_open() {
                    talk(&mut adapter, "S8\rO\r");
                }
            }
        }
        assert!(
            heard > 100_000 && sent > 10_000,
            "{heard} lines, {sent} frames"
        );
    });
}

fn talk(adapter: &mut Adapter, text: &str) -> String {
    let mut lines = Lines::new();
    let mut said = String::new();
    for byte in text.bytes() {
        if let Some(heard) = lines.push(byte) {
            let handled = adapter.handle(heard);
            said.push_str(core::str::from_utf8(handled.reply.line().bytes()).unwrap());
        }
    }
    said
}

#[test]
fn an_adapter_opens_once_it_has_a_bit_rate_and_refuses_what_does_not_fit() {
    let mut adapter = Adapter::new(0x10, 0x13, *b"A123");
    assert_eq!(talk(&mut adapter, "V\rN\r\r"), "V1013\rNA123\r\r");
    // Closed: nothing to close, nothing to send, no bit rate.
    assert_eq!(
        talk(&mut adapter, "C\rt1000\rO\rL\rF\r"),
        "\x07\x07\x07\x07\x07"
    );
    assert_eq!(talk(&mut adapter, "S8\rO\r"), "\r\r");
    assert_eq!(adapter.bit_rate(), Some(BitRate::M1));
    // Open: the settings stand.
    assert_eq!(
        talk(&mut adapter, "O\rL\rS6\rs031C\rZ1\rM00000000\rm00000000\r"),
        "\x07\x07\x07\x07\x07\x07\x07"
    );
    assert_eq!(
        talk(&mut adapter, "t1000\rT000001000\rr1000\rR000001000\r"),
        "z\rZ\rz\rZ\r"
    );
    adapter.flag(Flags::BUS_ERROR);
    adapter.flag(Flags::WARNING);
    assert_eq!(talk(&mut adapter, "F\rF\rC\r"), "F84\rF00\r\r");
    // Listening: the adapter receives, and sends nothing.
    assert_eq!(talk(&mut adapter, "s031C\rL\rt1000\r"), "\r\r\x07");
    assert_eq!(adapter.timing(), Some((0x03, 0x1C)));
    assert_eq!(adapter.bit_rate(), None);
    assert!(adapter.is_open());
}

#[test]
fn an_adapter_hands_on_what_its_mask_lets_through() {
    let mut adapter = Adapter::new(1, 1, *b"0000");
    let frame = data(0x190, &[1]);
    assert_eq!(adapter.received(&frame, 0), None);
    talk(&mut adapter, "S8\rZ1\rO\r");
    assert_eq!(
        adapter.received(&frame, 60_005),
        Some(Reply::Frame(frame, Some(Stamp::at(5))))
    );

    // First filter: exactly identifier 190h, data frames. Second filter: 7xxh, any frame.
    let mut adapter = Adapter::new(1, 1, *b"0000");
    let code = 0x190_u32 << 21 | 0x700 << 5;
    let mask = 0x000F << 16 | (0x0FF << 5 | 0x1F);
    talk(
        &mut adapter,
        &std::format!("S8\rM{code:08X}\rm{mask:08X}\rO\r"),
    );
    for (frame, passes) in [
        (data(0x190, &[]), true),
        (data(0x191, &[]), false),
        (remote(0x190, 0), false),
        (data(0x700, &[]), true),
        (data(0x7FF, &[9]), true),
        (remote(0x777, 0), true),
        (data(0x600, &[]), false),
    ] {
        assert_eq!(adapter.received(&frame, 0).is_some(), passes, "{frame:?}");
    }
    // A half holds the upper 16 bits of an extended identifier.
    let mut adapter = Adapter::new(1, 1, *b"0000");
    talk(&mut adapter, "S8\rMABCD0000\rm0000FFFF\rO\r");
    talk(&mut adapter, "C\rMABCDABCD\rm00000000\rO\r");
    for (id, passes) in [
        (0xABCD << 13, true),
        (0xABCD << 13 | 0x1FFF, true),
        (0xABCC << 13, false),
    ] {
        assert_eq!(
            adapter.received(&extended(id, &[]), 0).is_some(),
            passes,
            "{id:X}"
        );
    }
    assert!(
        adapter
            .received(&remote_extended(0xABCD << 13, 0), 0)
            .is_some()
    );
}
