//! Server and client against frames written by hand.

use core::time::Duration;
use std::vec::Vec;

use super::*;
use crate::bus::{SdoBuffer, SdoDownload, SdoProtocol, SdoUpload};

const ZERO: Duration = Duration::ZERO;

/// Requests of the client and answers of the server. Where one side sends several frames in a row, the other side has
/// empty lists.
type Talk<'a> = &'a [(&'a [[u8; 8]], &'a [[u8; 8]])];

fn serve(talk: Talk, dictionary: &mut Dictionary) {
    let mut server = server();
    for (requests, replies) in talk {
        let mut heard = Vec::new();
        for bytes in *requests {
            heard.extend(server.receive(&request(*bytes), dictionary));
        }
        while let Some(frame) = server.poll(dictionary) {
            heard.push(frame);
        }
        let wanted: Vec<Frame> = replies.iter().map(|bytes| reply(*bytes)).collect();
        assert_eq!(heard, wanted, "after {requests:02X?}");
    }
    assert!(!server.is_busy());
}

fn write(talk: Talk, object: Object, data: &[u8], protocol: SdoProtocol) {
    let mut client = SdoDownload::new(NODE, object, data, protocol, PATIENCE, ZERO);
    for (requests, replies) in talk {
        let sent: Vec<Frame> = core::iter::from_fn(|| client.poll(ZERO)).collect();
        let wanted: Vec<Frame> = requests.iter().map(|bytes| request(*bytes)).collect();
        assert_eq!(sent, wanted, "before {replies:02X?}");
        for bytes in *replies {
            client.receive(&reply(*bytes), ZERO);
        }
    }
    assert_eq!(client.poll(ZERO), None);
    assert_eq!(client.outcome(), Some(Ok(())));
    assert_eq!(client.progress() as usize, data.len());
}

fn read(talk: Talk, object: Object, wanted_data: &[u8], protocol: SdoProtocol) {
    let mut into = [0; 200];
    let mut buffer = SdoBuffer::new(&mut into);
    let mut client = SdoUpload::new(NODE, object, &mut buffer, protocol, PATIENCE, ZERO);
    for (requests, replies) in talk {
        let sent: Vec<Frame> = core::iter::from_fn(|| client.poll(ZERO)).collect();
        let wanted: Vec<Frame> = requests.iter().map(|bytes| request(*bytes)).collect();
        assert_eq!(sent, wanted, "before {replies:02X?}");
        for bytes in *replies {
            client.receive(&reply(*bytes), ZERO);
        }
    }
    assert_eq!(client.poll(ZERO), None);
    assert_eq!(client.outcome(), Some(Ok(())));
    assert_eq!(client.progress() as usize, wanted_data.len());
    assert_eq!(buffer.bytes(), wanted_data);
}

#[test]
fn expedited() {
    let talk: Talk = &[(
        &[[0x40, 0x10, 0x20, 0x01, 0, 0, 0, 0]],
        &[[0x43, 0x10, 0x20, 0x01, 1, 2, 3, 4]],
    )];
    serve(talk, &mut Dictionary::new());
    read(talk, LONG, &[1, 2, 3, 4], SdoProtocol::Short);

    let talk: Talk = &[(
        &[[0x2B, 0x20, 0x50, 0x00, 0xE8, 0x03, 0, 0]],
        &[[0x60, 0x20, 0x50, 0x00, 0, 0, 0, 0]],
    )];
    let mut dictionary = Dictionary::new();
    serve(talk, &mut dictionary);
    assert_eq!(dictionary.commits, [(DOMAIN, [0xE8, 0x03].to_vec())]);
    write(talk, DOMAIN, &[0xE8, 0x03], SdoProtocol::Short);

    // Lengths 1 to 4 have their own specifiers.
    for (data, write_head, read_head) in [
        (&[7][..], 0x2F, 0x4F),
        (&[7, 8], 0x2B, 0x4B),
        (&[7, 8, 9], 0x27, 0x47),
        (&[7, 8, 9, 10], 0x23, 0x43),
    ] {
        let mut four = [0; 4];
        four[..data.len()].copy_from_slice(data);
        let [a, b, c, d] = four;
        let talk: Talk = &[
            (
                &[[write_head, 0x20, 0x50, 0x00, a, b, c, d]],
                &[[0x60, 0x20, 0x50, 0x00, 0, 0, 0, 0]],
            ),
            (
                &[[0x40, 0x20, 0x50, 0x00, 0, 0, 0, 0]],
                &[[read_head, 0x20, 0x50, 0x00, a, b, c, d]],
            ),
        ];
        serve(talk, &mut Dictionary::new());
        write(&talk[..1], DOMAIN, data, SdoProtocol::Short);
        read(&talk[1..], DOMAIN, data, SdoProtocol::Short);
    }
}

#[test]
fn expedited_without_a_length_has_that_of_the_object() {
    let talk: Talk = &[(
        &[[0x22, 0x10, 0x20, 0x01, 9, 8, 7, 6]],
        &[[0x60, 0x10, 0x20, 0x01, 0, 0, 0, 0]],
    )];
    let mut dictionary = Dictionary::new();
    serve(talk, &mut dictionary);
    assert_eq!(dictionary.values[&LONG], [9, 8, 7, 6]);
    dictionary.values.insert(DOMAIN, [0, 0].to_vec());
    serve(
        &[(
            &[[0x22, 0x20, 0x50, 0x00, 9, 8, 7, 6]],
            &[[0x60, 0x20, 0x50, 0x00, 0, 0, 0, 0]],
        )],
        &mut dictionary,
    );
    assert_eq!(dictionary.values[&DOMAIN], [9, 8]);
    // The client takes all four bytes.
    read(
        &[(
            &[[0x40, 0x10, 0x20, 0x01, 0, 0, 0, 0]],
            &[[0x42, 0x10, 0x20, 0x01, 1, 2, 3, 4]],
        )],
        LONG,
        &[1, 2, 3, 4],
        SdoProtocol::Short,
    );
}

/// The transfer that manuals print.
#[test]
fn segmented_read() {
    let talk: Talk = &[
        (
            &[[0x40, 0x08, 0x10, 0x00, 0, 0, 0, 0]],
            &[[0x41, 0x08, 0x10, 0x00, 0x1A, 0, 0, 0]],
        ),
        (
            &[[0x60, 0, 0, 0, 0, 0, 0, 0]],
            &[[0x00, 0x54, 0x69, 0x6E, 0x79, 0x20, 0x4E, 0x6F]],
        ),
        (
            &[[0x70, 0, 0, 0, 0, 0, 0, 0]],
            &[[0x10, 0x64, 0x65, 0x20, 0x2D, 0x20, 0x4D, 0x65]],
        ),
        (
            &[[0x60, 0, 0, 0, 0, 0, 0, 0]],
            &[[0x00, 0x67, 0x61, 0x20, 0x44, 0x6F, 0x6D, 0x61]],
        ),
        (
            &[[0x70, 0, 0, 0, 0, 0, 0, 0]],
            &[[0x15, 0x69, 0x6E, 0x73, 0x20, 0x21, 0, 0]],
        ),
    ];
    serve(talk, &mut Dictionary::new());
    read(
        talk,
        FIXED,
        b"Tiny Node - Mega Domains !",
        SdoProtocol::Short,
    );
}

#[test]
fn segmented_write() {
    let talk: Talk = &[
        (
            &[[0x21, 0x20, 0x50, 0x00, 0x0A, 0, 0, 0]],
            &[[0x60, 0x20, 0x50, 0x00, 0, 0, 0, 0]],
        ),
        (
            &[[0x00, 1, 2, 3, 4, 5, 6, 7]],
            &[[0x20, 0, 0, 0, 0, 0, 0, 0]],
        ),
        (
            &[[0x19, 8, 9, 10, 0, 0, 0, 0]],
            &[[0x30, 0, 0, 0, 0, 0, 0, 0]],
        ),
    ];
    let data = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10];
    let mut dictionary = Dictionary::new();
    serve(talk, &mut dictionary);
    assert_eq!(dictionary.values[&DOMAIN], data);
    for protocol in [SdoProtocol::Short, SdoProtocol::Segmented] {
        write(talk, DOMAIN, &data, protocol);
    }
}

#[test]
fn an_empty_value_is_a_segment_without_bytes() {
    let talk: Talk = &[
        (
            &[[0x21, 0x20, 0x50, 0x00, 0, 0, 0, 0]],
            &[[0x60, 0x20, 0x50, 0x00, 0, 0, 0, 0]],
        ),
        (
            &[[0x0F, 0, 0, 0, 0, 0, 0, 0]],
            &[[0x20, 0, 0, 0, 0, 0, 0, 0]],
        ),
        (
            &[[0x40, 0x20, 0x50, 0x00, 0, 0, 0, 0]],
            &[[0x41, 0x20, 0x50, 0x00, 0, 0, 0, 0]],
        ),
        (
            &[[0x60, 0, 0, 0, 0, 0, 0, 0]],
            &[[0x0F, 0, 0, 0, 0, 0, 0, 0]],
        ),
    ];
    serve(talk, &mut Dictionary::new());
    write(&talk[..2], DOMAIN, &[], SdoProtocol::Short);
    read(&talk[2..], DOMAIN, &[], SdoProtocol::Short);
}

#[test]
fn a_write_of_unknown_length() {
    let mut dictionary = Dictionary::new();
    serve(
        &[
            (
                &[[0x20, 0x20, 0x50, 0x00, 0, 0, 0, 0]],
                &[[0x60, 0x20, 0x50, 0x00, 0, 0, 0, 0]],
            ),
            (
                &[[0x0D, 5, 0, 0, 0, 0, 0, 0]],
                &[[0x20, 0, 0, 0, 0, 0, 0, 0]],
            ),
        ],
        &mut dictionary,
    );
    assert_eq!(dictionary.values[&DOMAIN], [5]);
}

#[test]
fn block_write() {
    // CRC-16/XMODEM of "123456789" is 31C3h.
    let talk: Talk = &[
        (
            &[[0xC6, 0x20, 0x50, 0x00, 9, 0, 0, 0]],
            &[[0xA4, 0x20, 0x50, 0x00, 127, 0, 0, 0]],
        ),
        (
            &[
                [0x01, b'1', b'2', b'3', b'4', b'5', b'6', b'7'],
                [0x82, b'8', b'9', 0, 0, 0, 0, 0],
            ],
            &[[0xA2, 2, 127, 0, 0, 0, 0, 0]],
        ),
        (
            &[[0xD5, 0xC3, 0x31, 0, 0, 0, 0, 0]],
            &[[0xA1, 0, 0, 0, 0, 0, 0, 0]],
        ),
    ];
    let mut dictionary = Dictionary::new();
    serve(talk, &mut dictionary);
    assert_eq!(dictionary.values[&DOMAIN], b"123456789");
    write(talk, DOMAIN, b"123456789", SdoProtocol::Block);
}

#[test]
fn block_read() {
    let talk: Talk = &[
        (
            &[[0xA4, 0x08, 0x10, 0x00, 127, 14, 0, 0]],
            &[[0xC6, 0x08, 0x10, 0x00, 26, 0, 0, 0]],
        ),
        (
            &[[0xA3, 0, 0, 0, 0, 0, 0, 0]],
            &[
                [0x01, b'T', b'i', b'n', b'y', b' ', b'N', b'o'],
                [0x02, b'd', b'e', b' ', b'-', b' ', b'M', b'e'],
                [0x03, b'g', b'a', b' ', b'D', b'o', b'm', b'a'],
                [0x84, b'i', b'n', b's', b' ', b'!', 0, 0],
            ],
        ),
        (
            &[[0xA2, 4, 127, 0, 0, 0, 0, 0]],
            &[[0xC9, 0x40, 0xE1, 0, 0, 0, 0, 0]],
        ),
        (&[[0xA1, 0, 0, 0, 0, 0, 0, 0]], &[]),
    ];
    let crc = crc::Crc::<u16>::new(&crc::CRC_16_XMODEM).checksum(b"Tiny Node - Mega Domains !");
    assert_eq!(crc, 0xE140);
    serve(talk, &mut Dictionary::new());
    read(
        talk,
        FIXED,
        b"Tiny Node - Mega Domains !",
        SdoProtocol::Block,
    );
}

#[test]
fn an_empty_value_in_blocks() {
    let talk: Talk = &[
        (
            &[[0xC6, 0x20, 0x50, 0x00, 0, 0, 0, 0]],
            &[[0xA4, 0x20, 0x50, 0x00, 127, 0, 0, 0]],
        ),
        (
            &[[0x81, 0, 0, 0, 0, 0, 0, 0]],
            &[[0xA2, 1, 127, 0, 0, 0, 0, 0]],
        ),
        (
            &[[0xDD, 0, 0, 0, 0, 0, 0, 0]],
            &[[0xA1, 0, 0, 0, 0, 0, 0, 0]],
        ),
    ];
    serve(talk, &mut Dictionary::new());
    write(talk, DOMAIN, &[], SdoProtocol::Block);
    let talk: Talk = &[
        (
            &[[0xA4, 0x20, 0x50, 0x00, 127, 0, 0, 0]],
            &[[0xC6, 0x20, 0x50, 0x00, 0, 0, 0, 0]],
        ),
        (
            &[[0xA3, 0, 0, 0, 0, 0, 0, 0]],
            &[[0x81, 0, 0, 0, 0, 0, 0, 0]],
        ),
        (
            &[[0xA2, 1, 127, 0, 0, 0, 0, 0]],
            &[[0xDD, 0, 0, 0, 0, 0, 0, 0]],
        ),
        (&[[0xA1, 0, 0, 0, 0, 0, 0, 0]], &[]),
    ];
    serve(talk, &mut Dictionary::new());
}

#[test]
fn a_short_value_is_read_the_short_way_where_the_client_allows_it() {
    let talk: Talk = &[(
        &[[0xA4, 0x10, 0x20, 0x01, 127, 14, 0, 0]],
        &[[0x43, 0x10, 0x20, 0x01, 1, 2, 3, 4]],
    )];
    serve(talk, &mut Dictionary::new());
    read(talk, LONG, &[1, 2, 3, 4], SdoProtocol::Block);
    // 26 bytes are above 25.
    let mut server = server();
    let mut dictionary = Dictionary::new();
    let answer = |server: &mut SdoServer, dictionary: &mut Dictionary, threshold| {
        let frame = request([0xA4, 0x08, 0x10, 0x00, 127, threshold, 0, 0]);
        server.receive(&frame, dictionary).unwrap().payload()[0]
    };
    assert_eq!(answer(&mut server, &mut dictionary, 25), 0xC6);
    assert_eq!(answer(&mut server, &mut dictionary, 26), 0x41);
    assert_eq!(answer(&mut server, &mut dictionary, 0), 0xC6);
}

/// Blocks of two; the second segment of the first block and the first of the second block are lost.
#[test]
fn lost_segments_are_sent_again() {
    let block = |number| BlockSize::new(number).unwrap();
    let data = b"123456789";
    let mut server = SdoServer::new(NODE, Periods::new(1000), block(2));
    let mut dictionary = Dictionary::new();
    let mut client = SdoDownload::new(NODE, DOMAIN, data, SdoProtocol::Block, PATIENCE, ZERO);
    let mut sent = 0;
    let mut acknowledged = Vec::new();
    while client.outcome().is_none() {
        let frame = client.poll(ZERO).expect("it is the client's turn");
        sent += 1;
        // Frames 2 and 3 are the segments of the first block.
        if sent == 2 {
            continue;
        }
        if let Some(answer) = server.receive(&frame, &mut dictionary) {
            if answer.payload()[0] == 0xA2 {
                acknowledged.push(answer.payload()[1]);
            }
            client.receive(&answer, ZERO);
        }
    }
    assert_eq!(acknowledged, [0, 2]);
    assert_eq!(dictionary.commits, [(DOMAIN, data.to_vec())]);

    // In a read the client reports the received segments, and the server adds no segment to the checksum twice.
    let mut server = super::server();
    let mut into = [0; 30];
    let mut buffer = SdoBuffer::new(&mut into);
    let mut client = SdoUpload::new(NODE, FIXED, &mut buffer, SdoProtocol::Block, PATIENCE, ZERO);
    let mut segments = 0;
    while client.outcome().is_none() {
        while let Some(frame) = client.poll(ZERO) {
            let answer = server.receive(&frame, &mut dictionary);
            if let Some(answer) = answer {
                client.receive(&answer, ZERO);
            }
        }
        while let Some(frame) = server.poll(&mut dictionary) {
            segments += 1;
            if segments != 2 {
                client.receive(&frame, ZERO);
            }
        }
    }
    assert_eq!(client.outcome(), Some(Ok(())));
    assert_eq!(segments, 4 + 3);
    assert_eq!(buffer.bytes(), b"Tiny Node - Mega Domains !");
}

#[test]
fn what_is_not_for_the_server_does_nothing() {
    let mut server = server();
    let mut dictionary = Dictionary::new();
    let other = Frame::of(
        CobId::of(Service::SdoRequest, NodeId::DRIVE_X),
        [0x40, 0x10, 0x20, 0x01, 0, 0, 0, 0],
    );
    assert_eq!(server.receive(&other, &mut dictionary), None);
    let short = Frame::of(
        CobId::of(Service::SdoRequest, NODE),
        [0x40, 0x10, 0x20, 0x01],
    );
    assert_eq!(server.receive(&short, &mut dictionary), None);
    assert_eq!(
        server.receive(&reply([0x40, 0x10, 0x20, 1, 0, 0, 0, 0]), &mut dictionary),
        None
    );
    assert_eq!(server.poll(&mut dictionary), None);
    assert_eq!(server.elapse(Periods::new(u32::MAX), &mut dictionary), None);
}
