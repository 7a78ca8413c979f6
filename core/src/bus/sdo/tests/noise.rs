//! Senseless frames in any order: the server keeps the call order of `Objects`, and the client comes to an end.

use core::time::Duration;

use super::*;
use crate::bus::{SdoBuffer, SdoDownload, SdoProtocol, SdoUpload};

/// Valid first bytes, and a few invalid ones.
const HEADS: [u8; 24] = [
    0x00, 0x01, 0x0F, 0x10, 0x11, 0x20, 0x21, 0x22, 0x23, 0x2F, 0x30, 0x40, 0x43, 0x60, 0x70, 0x80,
    0x81, 0xA0, 0xA1, 0xA2, 0xA3, 0xC1, 0xC6, 0xE0,
];
const OBJECTS: [Object; 7] = [
    DOMAIN,
    LONG,
    FIXED,
    PICKY,
    UNWILLING,
    LIAR,
    Object::new(0, 0),
];

fn bytes(dice: &mut Dice, number: &mut u8) -> [u8; 8] {
    let mut bytes = dice.next().to_le_bytes();
    let object = OBJECTS[dice.below(OBJECTS.len() as u64) as usize];
    match dice.below(8) {
        // The next segment of a block, now and then the last.
        0..=2 => {
            *number = *number % 127 + 1;
            bytes[0] = *number | u8::from(dice.below(20) == 0) << 7;
        }
        3 => *number = 0,
        _ => {
            bytes[0] = HEADS[dice.below(HEADS.len() as u64) as usize];
            bytes[1..3].copy_from_slice(&object.index.to_le_bytes());
            bytes[3] = object.sub;
            // Short lengths and block sizes, so that some transfers finish.
            bytes[4] %= 40;
            bytes[5..].fill(0);
        }
    }
    bytes
}

#[test]
fn a_server_keeps_its_promises_to_its_objects() {
    leadscrew_seed::volume(0x5D0_0003, |seed| {
        let rounds = leadscrew_seed::amount(300_000, 3_000_000);
        let mut dice = Dice(seed);
        let mut server = server();
        let mut dictionary = Dictionary::new();
        let mut number = 0;
        let (mut refused, mut answered) = (0_u32, 0_u32);
        for round in 0..rounds {
            let frame = request(bytes(&mut dice, &mut number));
            // The dictionary itself checks the order of the calls.
            if let Some(answer) = server.receive(&frame, &mut dictionary) {
                assert_eq!(answer.id().get(), 0x581);
                let bytes = answer.exactly::<8>().unwrap();
                if bytes[0] == 0x80 {
                    refused += 1;
                    assert!(!dictionary.is_write_open());
                    let code = u32::from_le_bytes(*bytes.last_chunk().unwrap());
                    assert!(Abort::from_code(code).is_some());
                } else {
                    answered += 1;
                }
            }
            for _ in 0..dice.below(3) {
                let _ = server.poll(&mut dictionary);
            }
            let _ = server.elapse(Periods::new(dice.below(300) as u32), &mut dictionary);
            assert!(server.is_busy() || !dictionary.is_write_open(), "{round}");
            // Limits the memory of the test.
            dictionary.commits.clear();
        }
        assert!(
            refused > rounds / 10 && answered > rounds / 10,
            "{refused} {answered}"
        );
        assert!(dictionary.abandoned > rounds / 100);
    });
}

#[test]
fn a_client_comes_to_an_end() {
    leadscrew_seed::volume(0x5D0_0004, |seed| {
        let rounds = leadscrew_seed::amount(3_000, 30_000);
        let mut dice = Dice(seed);
        let (mut read_ends, mut write_ends) = ([0_u32; 2], [0_u32; 2]);
        let mut number = 0;
        for round in 0..rounds {
            let protocol = [SdoProtocol::Short, SdoProtocol::Block][round % 2];
            let mut into = [0; 64];
            let mut buffer = SdoBuffer::new(&mut into);
            let start = Duration::ZERO;
            let data = dice.bytes(round % 40);
            let mut reads = SdoUpload::new(NODE, DOMAIN, &mut buffer, protocol, PATIENCE, start);
            let mut writes = SdoDownload::new(NODE, DOMAIN, &data, protocol, PATIENCE, start);
            for ms in 0_u64.. {
                // From 200 ms on no frame comes: the client must notice the silence.
                let now = Duration::from_millis(if ms < 200 { ms } else { ms * 100 });
                while reads.poll(now).is_some() {}
                while writes.poll(now).is_some() {}
                if reads.outcome().is_some() && writes.outcome().is_some() {
                    break;
                }
                if ms < 200 {
                    let frame = reply(bytes(&mut dice, &mut number));
                    reads.receive(&frame, now);
                    writes.receive(&frame, now);
                }
            }
            read_ends[usize::from(reads.outcome() == Some(Ok(())))] += 1;
            write_ends[usize::from(writes.outcome() == Some(Ok(())))] += 1;
            assert!(writes.progress() as usize <= data.len());
        }
        // Some reads and writes end with success, most do not.
        assert!(read_ends[0] > read_ends[1] && write_ends[0] > write_ends[1]);
        assert!(
            read_ends[1] + write_ends[1] > 0,
            "{read_ends:?} {write_ends:?}"
        );
    });
}
