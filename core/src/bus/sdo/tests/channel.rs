//! Server and client over a wire that loses, repeats and reorders frames.
//!
//! A bus and its controllers can do all of this. A full receiver loses a frame. A destroyed acknowledgement repeats a
//! frame. Two frames that wait in mailboxes at the same time leave in the wrong order.

use core::time::Duration;
use std::collections::VecDeque;
use std::vec::Vec;

use super::*;
use crate::bus::{SdoDownload, SdoError, SdoProtocol, SdoSink, SdoUpload};

const PROTOCOLS: [SdoProtocol; 3] = [
    SdoProtocol::Short,
    SdoProtocol::Segmented,
    SdoProtocol::Block,
];

/// One direction of the wire. Each error comes once in `trouble` frames on average; 0: never.
#[derive(Default)]
struct Wire {
    waiting: VecDeque<Frame>,
    trouble: u64,
}

impl Wire {
    fn send(&mut self, frame: Frame, dice: &mut Dice) {
        let once = |dice: &mut Dice, trouble| trouble > 0 && dice.below(trouble) == 0;
        if once(dice, self.trouble) {
            return;
        }
        self.waiting.push_back(frame);
        if once(dice, self.trouble) {
            self.waiting.push_back(frame);
        }
        if self.waiting.len() > 1 && once(dice, self.trouble) {
            let last = self.waiting.len() - 1;
            self.waiting.swap(last - 1, last);
        }
    }
}

impl SdoSink for Vec<u8> {
    fn begin(&mut self, size: Option<u32>) -> Result<(), Abort> {
        self.clear();
        self.reserve(size.unwrap_or_default() as usize);
        Ok(())
    }

    fn put(&mut self, bytes: &[u8]) -> Result<(), Abort> {
        self.extend_from_slice(bytes);
        Ok(())
    }
}

/// Runs one transfer to its end. Time passes only when no side has a frame to send.
fn transfer(
    server: &mut SdoServer,
    dictionary: &mut Dictionary,
    trouble: u64,
    dice: &mut Dice,
    mut poll: impl FnMut(Option<Frame>, Duration) -> (Option<Frame>, Option<Result<(), SdoError>>),
) -> Result<(), SdoError> {
    let mut there = Wire {
        trouble,
        ..Wire::default()
    };
    let mut back = Wire {
        trouble,
        ..Wire::default()
    };
    let mut now = Duration::ZERO;
    let mut heard = None;
    let mut ended = None;
    loop {
        let mut idle = true;
        // Bursts of up to eight frames wait together.
        for _ in 0..=dice.below(8) {
            let (frame, outcome) = poll(heard.take(), now);
            if let Some(frame) = frame {
                there.send(frame, dice);
                idle = false;
            } else if let Some(outcome) = outcome {
                ended = Some(outcome);
            }
        }
        for _ in 0..=dice.below(8) {
            if let Some(frame) = server.poll(dictionary) {
                back.send(frame, dice);
                idle = false;
            }
        }
        for _ in 0..=dice.below(8) {
            if let Some(frame) = there.waiting.pop_front() {
                idle = false;
                if let Some(answer) = server.receive(&frame, dictionary) {
                    back.send(answer, dice);
                }
            }
        }
        if let Some(frame) = back.waiting.pop_front() {
            heard = Some(frame);
            idle = false;
        }
        if !idle {
            continue;
        }
        match ended {
            // The server may still wait for a client that has gone.
            Some(outcome) if !server.is_busy() => return outcome,
            _ => {}
        }
        now += Duration::from_millis(100);
        if let Some(frame) = server.elapse(Periods::new(100), dictionary) {
            back.send(frame, dice);
        }
    }
}

fn write(
    server: &mut SdoServer,
    dictionary: &mut Dictionary,
    data: &[u8],
    protocol: SdoProtocol,
    trouble: u64,
    dice: &mut Dice,
) -> Result<(), SdoError> {
    let mut client = SdoDownload::new(NODE, DOMAIN, data, protocol, PATIENCE, Duration::ZERO);
    transfer(server, dictionary, trouble, dice, |frame, now| {
        if let Some(frame) = frame {
            client.receive(&frame, now);
        }
        (client.poll(now), client.outcome())
    })
}

fn read(
    server: &mut SdoServer,
    dictionary: &mut Dictionary,
    protocol: SdoProtocol,
    trouble: u64,
    dice: &mut Dice,
) -> (Vec<u8>, Result<(), SdoError>) {
    let mut data = Vec::new();
    let mut client = SdoUpload::new(NODE, DOMAIN, &mut data, protocol, PATIENCE, Duration::ZERO);
    let outcome = transfer(server, dictionary, trouble, dice, |frame, now| {
        if let Some(frame) = frame {
            client.receive(&frame, now);
        }
        (client.poll(now), client.outcome())
    });
    (data, outcome)
}

/// Most values are short; some are long, and some end at a border.
fn length(dice: &mut Dice) -> usize {
    (match dice.below(4) {
        0 => dice.below(16),
        1 => dice.below(2000),
        2 => 7 * 127 * dice.below(4) + dice.below(3),
        _ => dice.below(70_001),
    }) as usize
}

#[test]
fn a_good_wire_brings_everything() {
    leadscrew_seed::volume(0x5D0_0001, |seed| {
        let mut dice = Dice(seed);
        for size in [1, 2, 3, 127] {
            let mut server =
                SdoServer::new(NODE, Periods::new(1000), BlockSize::new(size).unwrap());
            let mut dictionary = Dictionary::new();
            for _ in 0..20 {
                for protocol in PROTOCOLS {
                    let len = length(&mut dice);
                    let data = dice.bytes(len);
                    let outcome =
                        write(&mut server, &mut dictionary, &data, protocol, 0, &mut dice);
                    assert_eq!(outcome, Ok(()), "{} bytes, {protocol:?}", data.len());
                    assert!(dictionary.values[&DOMAIN] == data);
                    let (back, outcome) =
                        read(&mut server, &mut dictionary, protocol, 0, &mut dice);
                    assert_eq!(outcome, Ok(()));
                    assert!(back == data);
                }
            }
            assert_eq!((dictionary.commits.len(), dictionary.abandoned), (60, 0));
        }
    });
}

#[test]
fn a_bad_wire_brings_all_of_a_value_or_nothing() {
    leadscrew_seed::volume(0x5D0_0002, |seed| {
        let rounds = leadscrew_seed::amount(1000, 10_000);
        let mut dice = Dice(seed);
        let mut server = server();
        let mut dictionary = Dictionary::new();
        let (mut written, mut read_well, mut repeated, mut mistaken) = (0_u32, 0_u32, 0_u32, 0_u32);
        let mut confused = 0_u32;
        for _ in 0..rounds {
            for protocol in PROTOCOLS {
                // From a wire that is hardly usable to one that seldom disturbs a long transfer.
                let trouble = [10, 100, 1000, 10_000][dice.below(4) as usize];
                let len = if protocol == SdoProtocol::Block || trouble > 1000 {
                    length(&mut dice)
                } else {
                    dice.below(2000) as usize
                };
                let data = dice.bytes(len);
                let before = dictionary.values[&DOMAIN].clone();
                dictionary.commits.clear();
                let outcome = write(
                    &mut server,
                    &mut dictionary,
                    &data,
                    protocol,
                    trouble,
                    &mut dice,
                );
                assert!(!dictionary.is_write_open());
                // As below: a second copy that comes late can stand for a later segment. Then the length is right.
                let overtaken = |came: &[u8], sent: &[u8]| {
                    let segments = protocol != SdoProtocol::Block && sent.len() > 4;
                    segments && came.len() == sent.len()
                };
                for (_, committed) in &dictionary.commits {
                    let is_other = *committed != data;
                    assert!(
                        !is_other || overtaken(committed, &data),
                        "{len} bytes, {protocol:?}: another value"
                    );
                    confused += u32::from(is_other);
                }
                match outcome {
                    Ok(()) => {
                        written += 1;
                        if dictionary.commits.is_empty() {
                            // A confirmation came twice, and that of the next segment overtook the second copy. One
                            // toggle bit distinguishes segments, so the client takes the copy for the confirmation of
                            // the last segment [CiA 301]. Blocks have a CRC.
                            let segments = protocol != SdoProtocol::Block && len > 4;
                            assert!(segments, "nothing was written: {len} bytes, {protocol:?}");
                            mistaken += 1;
                        }
                    }
                    // The server may have the value nevertheless: only the last answer was lost.
                    Err(_) if dictionary.commits.is_empty() => {
                        assert!(dictionary.values[&DOMAIN] == before);
                    }
                    Err(_) => {}
                }
                let kept = dictionary.values[&DOMAIN].clone();
                let (back, outcome) =
                    read(&mut server, &mut dictionary, protocol, trouble, &mut dice);
                if outcome == Ok(()) {
                    read_well += 1;
                    assert!(
                        back == kept || overtaken(&back, &kept),
                        "{} bytes, {protocol:?}: another value",
                        kept.len()
                    );
                    confused += u32::from(back != kept);
                    repeated += u32::from(
                        protocol == SdoProtocol::Block && kept.len() > 7 * trouble as usize,
                    );
                }
            }
        }
        // Not all transfers fail, and blocks with lost segments arrive nevertheless.
        let all = rounds * 3;
        assert!(written > all / 4 && written < all, "{written} of {all}");
        assert!(
            read_well > all / 4 && read_well < all,
            "{read_well} of {all}"
        );
        assert!(repeated > rounds / 100, "{repeated}");
        // This mistake needs a wire that loses, repeats and reorders one frame in ten.
        assert!(mistaken <= 1 + rounds / 1000, "{mistaken} of {all}");
        assert!(confused <= 1 + rounds / 1000, "{confused} of {all}");
    });
}
