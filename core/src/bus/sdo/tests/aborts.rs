//! Every mistake has its abort code, and no mistake writes anything.

use core::time::Duration;

use super::*;
use crate::bus::{SdoBuffer, SdoDownload, SdoError, SdoProtocol, SdoUpload};

/// Sends requests, of which the server refuses the last. Checks that answer and the state of the server after it.
fn refused(requests: &[[u8; 8]], object: Object, code: Abort) -> Dictionary {
    let mut server = server();
    let mut dictionary = Dictionary::new();
    let mut answer = None;
    for bytes in requests {
        answer = server.receive(&request(*bytes), &mut dictionary);
        while server.poll(&mut dictionary).is_some() {}
    }
    assert_eq!(answer, Some(abort(object, code)), "{requests:02X?}");
    assert!(!server.is_busy());
    assert!(!dictionary.is_write_open());
    assert_eq!(dictionary.commits, []);
    dictionary
}

const READ_NAME: [u8; 8] = [0x40, 0x08, 0x10, 0x00, 0, 0, 0, 0];
const READ_NAME_IN_BLOCKS: [u8; 8] = [0xA4, 0x08, 0x10, 0x00, 127, 0, 0, 0];
const WRITE_TEN: [u8; 8] = [0x21, 0x20, 0x50, 0x00, 10, 0, 0, 0];
const WRITE_TEN_IN_BLOCKS: [u8; 8] = [0xC6, 0x20, 0x50, 0x00, 10, 0, 0, 0];
const NOWHERE: Object = Object::new(0, 0);

#[test]
fn what_the_object_refuses() {
    let missing = Object::new(0x2999, 3);
    refused(
        &[[0x40, 0x99, 0x29, 3, 0, 0, 0, 0]],
        missing,
        Abort::NoObject,
    );
    refused(
        &[[0xA4, 0x99, 0x29, 3, 127, 0, 0, 0]],
        missing,
        Abort::NoObject,
    );
    refused(
        &[[0x2F, 0x99, 0x29, 3, 0, 0, 0, 0]],
        missing,
        Abort::NoObject,
    );
    refused(
        &[[0x21, 0x99, 0x29, 3, 9, 0, 0, 0]],
        missing,
        Abort::NoObject,
    );
    refused(
        &[[0xC6, 0x99, 0x29, 3, 9, 0, 0, 0]],
        missing,
        Abort::NoObject,
    );
    refused(&[[0x2F, 0x08, 0x10, 0, 1, 0, 0, 0]], FIXED, Abort::ReadOnly);
    refused(&[[0x2B, 0x10, 0x20, 1, 1, 2, 0, 0]], LONG, Abort::TooShort);
    refused(&[[0x21, 0x10, 0x20, 1, 5, 0, 0, 0]], LONG, Abort::TooLong);
    refused(
        &[[0x21, 0x20, 0x50, 0, 0, 0, 0, 1]],
        DOMAIN,
        Abort::OutOfMemory,
    );
}

#[test]
fn a_value_refused_in_the_middle_is_abandoned() {
    let begin = [0x21, 0x10, 0x50, 0x00, 9, 0, 0, 0];
    let dictionary = refused(&[begin, [0x00, 1, 2, 3, 4, 5, 6, 7]], PICKY, Abort::Value);
    assert_eq!(dictionary.abandoned, 1);
    let begin = [0xC6, 0x10, 0x50, 0x00, 9, 0, 0, 0];
    let dictionary = refused(
        &[begin, [1, 1, 2, 3, 4, 5, 6, 7], [0x82, 8, 9, 0, 0, 0, 0, 0]],
        PICKY,
        Abort::Value,
    );
    assert_eq!(dictionary.abandoned, 1);
}

#[test]
fn a_value_refused_at_the_end_is_not_abandoned_as_well() {
    let dictionary = refused(
        &[[0x2F, 0x11, 0x50, 0x00, 9, 0, 0, 0]],
        UNWILLING,
        Abort::TooHigh,
    );
    assert_eq!(dictionary.abandoned, 0);
    let dictionary = refused(
        &[
            [0x21, 0x11, 0x50, 0x00, 1, 0, 0, 0],
            [0x0D, 9, 0, 0, 0, 0, 0, 0],
        ],
        UNWILLING,
        Abort::TooHigh,
    );
    assert_eq!(dictionary.abandoned, 0);
    let dictionary = refused(
        &[
            [0xC2, 0x11, 0x50, 0x00, 1, 0, 0, 0],
            [0x81, 9, 0, 0, 0, 0, 0, 0],
            [0xD9, 0, 0, 0, 0, 0, 0, 0],
        ],
        UNWILLING,
        Abort::TooHigh,
    );
    assert_eq!(dictionary.abandoned, 0);
}

#[test]
fn a_toggle_bit_that_stays() {
    refused(
        &[READ_NAME, [0x70, 0, 0, 0, 0, 0, 0, 0]],
        FIXED,
        Abort::Toggle,
    );
    let first = [0x60, 0, 0, 0, 0, 0, 0, 0];
    refused(&[READ_NAME, first, first], FIXED, Abort::Toggle);
    let segment = [0x00, 1, 2, 3, 4, 5, 6, 7];
    let dictionary = refused(&[WRITE_TEN, segment, segment], DOMAIN, Abort::Toggle);
    assert_eq!(dictionary.abandoned, 1);
}

#[test]
fn a_length_that_is_not_the_one_told() {
    let segment = [0x00, 1, 2, 3, 4, 5, 6, 7];
    // 7 + 7 > 10, and 7 + 2 < 10.
    refused(
        &[WRITE_TEN, segment, [0x10, 1, 2, 3, 4, 5, 6, 7]],
        DOMAIN,
        Abort::TooLong,
    );
    refused(
        &[WRITE_TEN, segment, [0x1B, 1, 2, 0, 0, 0, 0, 0]],
        DOMAIN,
        Abort::TooShort,
    );
    let blocks = |last: [u8; 8], end: [u8; 8], code| {
        refused(
            &[
                // Without a CRC, so that only the length is wrong.
                [0xC2, 0x20, 0x50, 0x00, 10, 0, 0, 0],
                [1, 1, 2, 3, 4, 5, 6, 7],
                last,
                end,
            ],
            DOMAIN,
            code,
        );
    };
    let last = [0x82, 8, 9, 10, 0, 0, 0, 0];
    blocks(last, [0xCD, 0, 0, 0, 0, 0, 0, 0], Abort::TooLong);
    blocks(last, [0xD5, 0, 0, 0, 0, 0, 0, 0], Abort::TooShort);
    refused(
        &[
            WRITE_TEN_IN_BLOCKS,
            [1, 1, 2, 3, 4, 5, 6, 7],
            [2, 1, 2, 3, 4, 5, 6, 7],
            [3, 1, 2, 3, 4, 5, 6, 7],
        ],
        DOMAIN,
        Abort::TooLong,
    );
}

#[test]
fn a_wrong_checksum() {
    let dictionary = refused(
        &[
            WRITE_TEN_IN_BLOCKS,
            [1, 1, 2, 3, 4, 5, 6, 7],
            [0x82, 8, 9, 10, 0, 0, 0, 0],
            [0xD1, 0x34, 0x12, 0, 0, 0, 0, 0],
        ],
        DOMAIN,
        Abort::Crc,
    );
    assert_eq!(dictionary.abandoned, 1);
}

#[test]
fn block_sizes_and_sequence_numbers_that_do_not_exist() {
    let mut begin = READ_NAME_IN_BLOCKS;
    for block in [0, 128, 255] {
        begin[4] = block;
        refused(&[begin], FIXED, Abort::BlockSize);
    }
    let start = [0xA3, 0, 0, 0, 0, 0, 0, 0];
    refused(
        &[READ_NAME_IN_BLOCKS, start, [0xA2, 2, 0, 0, 0, 0, 0, 0]],
        FIXED,
        Abort::BlockSize,
    );
    refused(
        &[READ_NAME_IN_BLOCKS, start, [0xA2, 5, 127, 0, 0, 0, 0, 0]],
        FIXED,
        Abort::Sequence,
    );
    refused(
        &[WRITE_TEN_IN_BLOCKS, [0x00, 1, 2, 3, 4, 5, 6, 7]],
        DOMAIN,
        Abort::Sequence,
    );
    let mut server = SdoServer::new(NODE, Periods::new(1000), BlockSize::new(4).unwrap());
    let mut dictionary = Dictionary::new();
    let _ = server.receive(&request(WRITE_TEN_IN_BLOCKS), &mut dictionary);
    let answer = server.receive(&request([5, 0, 0, 0, 0, 0, 0, 0]), &mut dictionary);
    assert_eq!(answer, Some(abort(DOMAIN, Abort::Sequence)));
}

#[test]
fn commands_out_of_place() {
    for bytes in [
        [0x00, 0, 0, 0, 0, 0, 0, 0],
        [0x60, 0, 0, 0, 0, 0, 0, 0],
        [0xA1, 0, 0, 0, 0, 0, 0, 0],
        [0xA2, 0, 127, 0, 0, 0, 0, 0],
        [0xA3, 0, 0, 0, 0, 0, 0, 0],
        [0xC1, 0, 0, 0, 0, 0, 0, 0],
        [0xC3, 0, 0, 0, 0, 0, 0, 0],
        [0xE0, 0, 0, 0, 0, 0, 0, 0],
    ] {
        refused(&[bytes], NOWHERE, Abort::Specifier);
        // The specifier that is correct there.
        if bytes[0] != 0xA3 {
            refused(&[READ_NAME_IN_BLOCKS, bytes], FIXED, Abort::Specifier);
        }
    }
    // A segment in the wrong direction.
    refused(
        &[WRITE_TEN, [0x60, 0, 0, 0, 0, 0, 0, 0]],
        DOMAIN,
        Abort::Specifier,
    );
    refused(
        &[READ_NAME, [0x00, 0, 0, 0, 0, 0, 0, 0]],
        FIXED,
        Abort::Specifier,
    );
    // Before all segments are out, and before the blocks are over.
    refused(
        &[
            READ_NAME_IN_BLOCKS,
            [0xA3, 0, 0, 0, 0, 0, 0, 0],
            [0xA1, 0, 0, 0, 0, 0, 0, 0],
        ],
        FIXED,
        Abort::Specifier,
    );
    refused(
        &[
            READ_NAME_IN_BLOCKS,
            [0xA3, 0, 0, 0, 0, 0, 0, 0],
            [0xA3, 0, 0, 0, 0, 0, 0, 0],
        ],
        FIXED,
        Abort::Specifier,
    );
}

#[test]
fn an_object_that_ends_before_its_length() {
    let mut server = server();
    let mut dictionary = Dictionary::new();
    let _ = server.receive(
        &request([0xA4, 0x12, 0x50, 0, 127, 0, 0, 0]),
        &mut dictionary,
    );
    let _ = server.receive(&request([0xA3, 0, 0, 0, 0, 0, 0, 0]), &mut dictionary);
    let mut last = None;
    while let Some(frame) = server.poll(&mut dictionary) {
        last = Some(frame);
    }
    // 101 bytes are 15 segments, and the last of them cannot be filled.
    assert_eq!(last, Some(abort(LIAR, Abort::General)));
}

#[test]
fn a_silent_client_is_given_up() {
    for (requests, object, abandoned) in [
        (&[READ_NAME][..], FIXED, 0),
        (&[READ_NAME_IN_BLOCKS], FIXED, 0),
        (&[WRITE_TEN], DOMAIN, 1),
        (&[WRITE_TEN_IN_BLOCKS], DOMAIN, 1),
        (&[WRITE_TEN_IN_BLOCKS, [1, 1, 2, 3, 4, 5, 6, 7]], DOMAIN, 1),
    ] {
        let mut server = server();
        let mut dictionary = Dictionary::new();
        for bytes in requests {
            let _ = server.receive(&request(*bytes), &mut dictionary);
        }
        assert_eq!(server.elapse(Periods::new(1000), &mut dictionary), None);
        assert!(server.is_busy());
        assert_eq!(
            server.elapse(Periods::new(1), &mut dictionary),
            Some(abort(object, Abort::TimedOut))
        );
        assert!(!server.is_busy());
        assert_eq!(dictionary.abandoned, abandoned);
        assert_eq!(server.elapse(Periods::new(5000), &mut dictionary), None);
    }
}

#[test]
fn a_new_beginning_replaces_a_transfer() {
    let mut server = server();
    let mut dictionary = Dictionary::new();
    let name = reply([0x41, 0x08, 0x10, 0, 26, 0, 0, 0]);
    let _ = server.receive(&request(WRITE_TEN), &mut dictionary);
    let _ = server.receive(&request([0x00, 1, 2, 3, 4, 5, 6, 7]), &mut dictionary);
    assert_eq!(
        server.receive(&request(READ_NAME), &mut dictionary),
        Some(name)
    );
    assert_eq!(
        (dictionary.abandoned, dictionary.is_write_open()),
        (1, false)
    );
    // The old transfer is gone.
    assert_eq!(
        server.receive(&request([0x11, 1, 2, 3, 4, 5, 6, 7]), &mut dictionary),
        Some(abort(FIXED, Abort::Specifier))
    );
    assert_eq!(dictionary.commits, []);
}

#[test]
fn an_abort_or_a_reset_ends_a_transfer_without_a_word() {
    for begin in [
        READ_NAME,
        READ_NAME_IN_BLOCKS,
        WRITE_TEN,
        WRITE_TEN_IN_BLOCKS,
    ] {
        let mut server = server();
        let mut dictionary = Dictionary::new();
        let _ = server.receive(&request(begin), &mut dictionary);
        assert!(server.is_busy());
        let answer = server.receive(&request([0x80, 0, 0, 0, 0, 0, 4, 5]), &mut dictionary);
        assert_eq!(answer, None);
        assert!(!server.is_busy() && !dictionary.is_write_open());

        let _ = server.receive(&request(begin), &mut dictionary);
        server.reset(&mut dictionary);
        assert!(!server.is_busy() && !dictionary.is_write_open());
    }
}

/// Segment 35 begins with 23h, which as a command is a write of four bytes.
#[test]
fn the_rest_of_a_broken_block_is_no_command() {
    let mut server = server();
    let mut dictionary = Dictionary::new();
    let write_long = [0x23, 0x10, 0x20, 0x01, 9, 9, 9, 9];
    let _ = server.receive(&request(WRITE_TEN_IN_BLOCKS), &mut dictionary);
    let broken = server.receive(&request([0x00; 8]), &mut dictionary);
    assert_eq!(broken, Some(abort(DOMAIN, Abort::Sequence)));
    assert_eq!(server.receive(&request(write_long), &mut dictionary), None);
    assert_eq!(dictionary.values[&LONG], [1, 2, 3, 4]);
    // A read does no harm.
    assert_eq!(
        server.receive(&request([0x40, 0x10, 0x20, 1, 0, 0, 0, 0]), &mut dictionary),
        Some(reply([0x43, 0x10, 0x20, 1, 1, 2, 3, 4]))
    );

    // The last segment ends it, and so do an abort and silence.
    for end in [Some([0xA4; 8]), Some([0x80, 0, 0, 0, 0, 0, 0, 0]), None] {
        dictionary = Dictionary::new();
        let _ = server.receive(&request(WRITE_TEN_IN_BLOCKS), &mut dictionary);
        let _ = server.receive(&request([0x00; 8]), &mut dictionary);
        match end {
            Some(bytes) => assert_eq!(server.receive(&request(bytes), &mut dictionary), None),
            None => assert_eq!(server.elapse(Periods::new(1001), &mut dictionary), None),
        }
        let _ = server.receive(&request(write_long), &mut dictionary);
        assert_eq!(dictionary.values[&LONG], [9, 9, 9, 9]);
    }
}

/// When no segment of a block can follow any more, the server answers the next request of any kind. It always answers a
/// request to write in blocks, because that alone changes nothing.
#[test]
fn who_begins_anew_behind_a_refusal_is_answered() {
    let begin = [0xC6, 0x10, 0x50, 0x00, 9, 0, 0, 0];
    let first = [1, 1, 2, 3, 4, 5, 6, 7];
    let write_long = [0x23, 0x10, 0x20, 0x01, 9, 9, 9, 9];
    // Refused at the last segment of the value, and at the last segment of a block of two.
    for (most, last) in [(127, 0x82), (2, 0x02)] {
        let block = BlockSize::new(most).unwrap();
        let mut server = SdoServer::new(NODE, Periods::new(1000), block);
        let mut dictionary = Dictionary::new();
        let _ = server.receive(&request(begin), &mut dictionary);
        assert_eq!(server.receive(&request(first), &mut dictionary), None);
        let refused = server.receive(&request([last, 8, 9, 0, 0, 0, 0, 0]), &mut dictionary);
        assert_eq!(refused, Some(abort(PICKY, Abort::Value)), "{last:02X}h");
        assert!(!dictionary.is_write_open());
        let done = server.receive(&request(write_long), &mut dictionary);
        assert_eq!(done, Some(reply([0x60, 0x10, 0x20, 1, 0, 0, 0, 0])));
    }
    // Refused in the middle, where the rest may still come; and after a silence.
    for silent in [false, true] {
        let mut server = server();
        let mut dictionary = Dictionary::new();
        let _ = server.receive(&request(WRITE_TEN_IN_BLOCKS), &mut dictionary);
        if silent {
            assert!(server.elapse(Periods::new(1001), &mut dictionary).is_some());
        } else {
            let _ = server.receive(&request([0x00; 8]), &mut dictionary);
        }
        assert_eq!(server.receive(&request(write_long), &mut dictionary), None);
        let again = server.receive(&request(WRITE_TEN_IN_BLOCKS), &mut dictionary);
        assert_eq!(again, Some(reply([0xA4, 0x20, 0x50, 0, 127, 0, 0, 0])));
        assert_eq!(dictionary.values[&LONG], [1, 2, 3, 4]);
    }
}

/// With an even number from 72 to 94 the last segment of a block looks like a new write in blocks, except for bits that
/// are 0 there.
#[test]
fn the_last_segment_of_a_broken_block_begins_nothing() {
    // The segment names a writable object. 74 segments hold 512 bytes.
    let data = [0x20, 0x50, 0, 10, 0, 0, 0];
    for last in [72_u8, 74, 76, 78, 80, 86, 88, 94] {
        let mut server = server();
        let mut dictionary = Dictionary::new();
        let length = (u16::from(last) * 7).to_le_bytes();
        let begin = [0xC6, 0x20, 0x50, 0, length[0], length[1], 0, 0];
        let begun = Some(reply([0xA4, 0x20, 0x50, 0, 127, 0, 0, 0]));
        assert_eq!(server.receive(&request(begin), &mut dictionary), begun);
        let mut segment =
            |number: u8, [a, b, c, d, e, f, g]: [u8; 7], dictionary: &mut Dictionary| {
                if number == 10 {
                    let late = server.elapse(Periods::new(1001), dictionary);
                    assert_eq!(late, Some(abort(DOMAIN, Abort::TimedOut)));
                }
                let frame = request([number, a, b, c, d, e, f, g]);
                assert_eq!(
                    server.receive(&frame, dictionary),
                    None,
                    "{number} of {last}"
                );
            };
        for number in 1..last {
            segment(number, [7; 7], &mut dictionary);
        }
        segment(0x80 | last, data, &mut dictionary);
        assert!(!server.is_busy() && !dictionary.is_write_open());
        // A client that begins a new transfer gets its answer.
        assert_eq!(server.receive(&request(begin), &mut dictionary), begun);
        let first = server.receive(&request([1, 7, 7, 7, 7, 7, 7, 7]), &mut dictionary);
        assert_eq!(first, None);
        server.reset(&mut dictionary);
        // After that the server answers a mistake again.
        let refused = server.receive(&request([0xC6, 0x99, 0x29, 3, 9, 0, 0, 0]), &mut dictionary);
        let nowhere = Object::new(0x2999, 3);
        assert_eq!(refused, Some(abort(nowhere, Abort::NoObject)));
        assert_eq!(dictionary.commits, []);
    }
}

/// The last segment of a write, C1h, looks like the command that ends the write.
#[test]
fn the_last_segment_twice_is_not_the_end() {
    let mut server = server();
    let mut dictionary = Dictionary::new();
    let data = [0; 65 * 7];
    let begin = [0xC2, 0x20, 0x50, 0x00, 0xC7, 1, 0, 0];
    let _ = server.receive(&request(begin), &mut dictionary);
    for number in 1..65 {
        let mut segment = [0; 8];
        segment[0] = number;
        assert_eq!(server.receive(&request(segment), &mut dictionary), None);
    }
    let last = request([0xC1, 0, 0, 0, 0, 0, 0, 0]);
    let answer = reply([0xA2, 65, 127, 0, 0, 0, 0, 0]);
    assert_eq!(server.receive(&last, &mut dictionary), Some(answer));
    assert_eq!(server.receive(&last, &mut dictionary), None);
    assert_eq!(dictionary.commits, []);
    // The real end differs in a byte that is not used here, because this client makes no CRC.
    let end = request([0xC1, 0, 0, 0, 0, 0, 0, 1]);
    assert_eq!(
        server.receive(&end, &mut dictionary),
        Some(reply([0xA1, 0, 0, 0, 0, 0, 0, 0]))
    );
    assert_eq!(dictionary.commits, [(DOMAIN, data.to_vec())]);
}

fn write_broken(data: &[u8], protocol: SdoProtocol, replies: &[[u8; 8]], error: SdoError) {
    let now = Duration::ZERO;
    let mut client = SdoDownload::new(NODE, DOMAIN, data, protocol, PATIENCE, now);
    let mut last = None;
    for bytes in replies {
        while client.poll(now).is_some() {}
        client.receive(&reply(*bytes), now);
    }
    while let Some(frame) = client.poll(now) {
        last = Some(frame);
    }
    assert_eq!(client.outcome(), Some(Err(error)), "{replies:02X?}");
    told(error, last);
}

fn read_broken(protocol: SdoProtocol, replies: &[[u8; 8]], error: SdoError) {
    let now = Duration::ZERO;
    let mut into = [0; 100];
    let mut buffer = SdoBuffer::new(&mut into);
    let mut client = SdoUpload::new(NODE, DOMAIN, &mut buffer, protocol, PATIENCE, now);
    for bytes in replies {
        while client.poll(now).is_some() {}
        client.receive(&reply(*bytes), now);
    }
    assert_eq!(client.outcome(), Some(Err(error)), "{replies:02X?}");
    told(error, client.poll(now));
    assert_eq!(client.poll(now), None);
}

/// Checks that the last frame tells the server why the client broke the transfer off.
fn told(error: SdoError, last: Option<Frame>) {
    if let SdoError::Broken(abort) = error {
        let [a, b, c, d] = abort.code().to_le_bytes();
        assert_eq!(last, Some(request([0x80, 0x20, 0x50, 0, a, b, c, d])));
    }
}

const BEGUN: [u8; 8] = [0x60, 0x20, 0x50, 0, 0, 0, 0, 0];
const BLOCKS: [u8; 8] = [0xA4, 0x20, 0x50, 0, 127, 0, 0, 0];
const NO_OBJECT: [u8; 8] = [0x80, 0x20, 0x50, 0, 0, 0, 2, 6];

#[test]
fn a_client_that_writes_says_what_the_server_does_wrong() {
    use SdoError::{Broken, Refused};
    use SdoProtocol::{Block, Short};
    let ten = [0; 10];
    write_broken(&ten, Short, &[NO_OBJECT], Refused(0x0602_0000));
    assert_eq!(Refused(0x0602_0000).abort(), Some(Abort::NoObject));
    write_broken(
        &ten,
        Short,
        &[[0x80, 0, 0, 0, 1, 2, 3, 4]],
        Refused(0x0403_0201),
    );
    assert_eq!(Refused(0x0403_0201).abort(), None);
    let wrong = Broken(Abort::Specifier);
    write_broken(&ten, Short, &[[0x43, 0x20, 0x50, 0, 0, 0, 0, 0]], wrong);
    write_broken(&ten, Short, &[BLOCKS], wrong);
    write_broken(&ten, Block, &[BEGUN], wrong);
    write_broken(&ten, Short, &[BEGUN, [0xA1; 8]], wrong);
    write_broken(&ten, Short, &[BEGUN, [0xFF; 8]], wrong);
    write_broken(
        &ten,
        Short,
        &[BEGUN, [0x30, 0, 0, 0, 0, 0, 0, 0]],
        Broken(Abort::Toggle),
    );
    for block in [0, 128] {
        let begun = [0xA4, 0x20, 0x50, 0, block, 0, 0, 0];
        write_broken(&ten, Block, &[begun], Broken(Abort::BlockSize));
        let answer = [0xA2, 2, block, 0, 0, 0, 0, 0];
        write_broken(&ten, Block, &[BLOCKS, answer], Broken(Abort::BlockSize));
    }
    write_broken(
        &ten,
        Block,
        &[BLOCKS, [0xA2, 3, 127, 0, 0, 0, 0, 0]],
        Broken(Abort::Sequence),
    );
    write_broken(
        &ten,
        Block,
        &[BLOCKS, [0xA2, 2, 127, 0, 0, 0, 0, 0], BEGUN],
        wrong,
    );
    write_broken(&ten, Block, &[BLOCKS, NO_OBJECT], Refused(0x0602_0000));
}

#[test]
fn a_client_that_reads_says_what_the_server_does_wrong() {
    use SdoError::{Broken, Refused};
    use SdoProtocol::{Block, Short};
    let segments = [0x41, 0x20, 0x50, 0, 10, 0, 0, 0];
    let blocks = [0xC6, 0x20, 0x50, 0, 10, 0, 0, 0];
    let wrong = Broken(Abort::Specifier);
    read_broken(Short, &[NO_OBJECT], Refused(0x0602_0000));
    read_broken(Short, &[BEGUN], wrong);
    read_broken(Short, &[blocks], wrong);
    read_broken(Block, &[BLOCKS], wrong);
    read_broken(Short, &[segments, [0x60; 8]], wrong);
    read_broken(Short, &[segments, [0x10; 8]], Broken(Abort::Toggle));
    // 101 bytes do not fit into the buffer.
    let long = [0x41, 0x20, 0x50, 0, 101, 0, 0, 0];
    read_broken(Short, &[long], Broken(Abort::OutOfMemory));
    let zeros = [0x00; 8];
    read_broken(
        Short,
        &[segments, zeros, [0x10, 0, 0, 0, 0, 0, 0, 0]],
        Broken(Abort::TooLong),
    );
    read_broken(
        Short,
        &[segments, [0x01, 0, 0, 0, 0, 0, 0, 0]],
        Broken(Abort::TooShort),
    );
    read_broken(Block, &[blocks, zeros], Broken(Abort::Sequence));
    read_broken(Block, &[blocks, NO_OBJECT], Refused(0x0602_0000));
    let first = [0x01, 0, 0, 0, 0, 0, 0, 0];
    let second = [0x82, 0, 0, 0, 0, 0, 0, 0];
    read_broken(Block, &[blocks, first, second, BEGUN], wrong);
    let end = |unused: u8, crc: u8| [0xC1 | unused << 2, crc, 0, 0, 0, 0, 0, 0];
    read_broken(
        Block,
        &[blocks, first, second, end(4, 1)],
        Broken(Abort::Crc),
    );
    read_broken(
        Block,
        &[blocks, first, second, end(3, 0)],
        Broken(Abort::TooLong),
    );
    read_broken(
        Block,
        &[blocks, first, second, end(5, 0)],
        Broken(Abort::TooShort),
    );
}

#[test]
fn a_client_waits_so_long_and_no_longer() {
    let mut client = SdoDownload::new(
        NODE,
        DOMAIN,
        &[0; 10],
        SdoProtocol::Short,
        PATIENCE,
        Duration::from_secs(5),
    );
    assert!(client.poll(Duration::from_secs(5)).is_some());
    assert_eq!(client.deadline(), Duration::from_secs(6));
    assert_eq!(client.poll(Duration::from_secs(6)), None);
    // A late frame of another transfer is no answer.
    for bytes in [
        [0x60, 0x21, 0x50, 0, 0, 0, 0, 0],
        [0x20, 0, 0, 0, 0, 0, 0, 0],
        [0x80, 0x21, 0x50, 0, 0, 0, 0, 0],
    ] {
        client.receive(&reply(bytes), Duration::from_secs(5));
    }
    assert_eq!(client.outcome(), None);
    assert_eq!(
        client.poll(Duration::from_millis(6001)),
        Some(request([0x80, 0x20, 0x50, 0, 0, 0, 4, 5]))
    );
    assert_eq!(client.outcome(), Some(Err(SdoError::TimedOut)));
    // Too late.
    client.receive(&reply(BEGUN), Duration::from_secs(7));
    assert_eq!(client.poll(Duration::from_secs(7)), None);
    assert_eq!(client.outcome(), Some(Err(SdoError::TimedOut)));
}
