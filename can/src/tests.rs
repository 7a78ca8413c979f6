//! Tests for every kind of bus, and for recordings.

use std::os::unix::net::UnixDatagram;
use std::time::{Duration, Instant};

use leadscrew_core::bus::{self, CobId, Frame, NodeId, Service};

use crate::{
    Can, CanError, Data, Entry, ErrorFrame, Fault, FdFrame, Filter, Health, Id, LogReader,
    LogWriter, Packet, SocketCan, Stamp, Suspicion, pair,
};

fn frame(id: u16, payload: &[u8]) -> Frame {
    Frame::new(CobId::new(id).unwrap(), payload).unwrap()
}

fn standard(id: u16) -> Id {
    Id::Standard(CobId::new(id).unwrap())
}

/// One packet of each kind, with the line that `candump -l` writes for it.
fn samples() -> Vec<(Packet, &'static str)> {
    vec![
        (
            Packet::Frame(frame(0x190, &[0x27, 0x06, 0xAB])),
            "190#2706AB",
        ),
        (Packet::Frame(frame(0x080, &[])), "080#"),
        (
            Packet::Extended(0x1ABC_DEF0, Data::new(&[1; 8]).unwrap()),
            "1ABCDEF0#0101010101010101",
        ),
        (Packet::Remote(standard(0x701), 0), "701#R"),
        (Packet::Remote(Id::Extended(0x12), 5), "00000012#R5"),
        (
            Packet::Fd(FdFrame {
                id: standard(0x321),
                data: Data::new(&[0xEE; 12]).unwrap(),
                rate_switched: true,
                sender_passive: true,
            }),
            "321##3EEEEEEEEEEEEEEEEEEEEEEEE",
        ),
        (
            Packet::Error(ErrorFrame {
                class: 0x44,
                data: [0, 0x20, 0, 0, 0, 0, 0x88, 0],
            }),
            "20000044#0020000000008800",
        ),
    ]
}

#[test]
fn recordings_are_candump_s_and_are_read_back() {
    let mut log = LogWriter::new(Vec::new(), "can0");
    let mut expected = String::new();
    for (index, (packet, text)) in (1..).zip(samples()) {
        let time = Stamp::from_nanos(1_700_000_000_000_000_000 + index * 1_234_567);
        log.push(time, &packet).unwrap();
        let us = index * 1_234_567 / 1000;
        expected.push_str(&format!("(1700000000.{us:06}) can0 {text}\n"));
    }
    let text = String::from_utf8(log.finish().unwrap()).unwrap();
    assert_eq!(text, expected);

    let entries: Vec<Entry> = LogReader::new(text.as_bytes())
        .map(Result::unwrap)
        .collect();
    assert_eq!(entries.len(), samples().len());
    for (entry, (packet, _)) in entries.iter().zip(samples()) {
        assert_eq!(entry.packet, packet);
        assert_eq!(entry.bus, "can0");
    }
    assert_eq!(entries[0].time, Stamp::from_micros(1_700_000_000_001_234));
}

#[test]
fn virtual_time_begins_with_ten_digits_of_nothing() {
    let mut log = LogWriter::new(Vec::new(), "a bus");
    log.push(
        Stamp::from_micros(1_234_000),
        &Packet::Frame(frame(0x80, &[7])),
    )
    .unwrap();
    let text = String::from_utf8(log.finish().unwrap()).unwrap();
    assert_eq!(text, "(0000000001.234000) a_bus 080#07\n");
}

#[test]
fn what_is_no_recording_is_told_by_line() {
    for (text, said) in [
        (
            "(1.000000) can0 190#1\n",
            "line 1 of the recording: its frame is none",
        ),
        (
            "\n(1.000000) can0 1900#11\n",
            "line 2 of the recording: its frame",
        ),
        ("(1.0) can0 190#11\n", "its time is none"),
        ("1.000000 can0 190#11\n", "its time is none"),
        ("(1.000000) can0\n", "less than three words"),
        (
            "(1.000000) can0 190#112233445566778899\n",
            "its frame is none",
        ),
        ("(1.000000) can0 900#11\n", "its frame is none"),
        ("(1.000000) can0 701#R9\n", "its frame is none"),
    ] {
        let error = LogReader::new(text.as_bytes())
            .find_map(Result::err)
            .unwrap()
            .to_string();
        assert!(error.contains(said), "{text}: {error}");
    }
}

#[test]
fn what_one_end_of_a_pair_sends_the_other_receives_in_order() {
    let (mut a, mut b) = pair();
    let frames: Vec<Frame> = (0..200).map(|n| frame(0x100 + n, &[n as u8])).collect();
    a.send(&frames).unwrap();
    let mut heard = Vec::new();
    assert_eq!(b.receive(&mut heard, Duration::ZERO).unwrap(), 200);
    let got: Vec<Frame> = heard
        .iter()
        .filter_map(|received| received.packet.frame().copied())
        .collect();
    assert_eq!(got, frames);
    assert_eq!(a.receive(&mut heard, Duration::ZERO).unwrap(), 0);
    assert_eq!(b.dropped().unwrap(), 0);

    drop(a);
    assert!(matches!(
        b.receive(&mut heard, Duration::ZERO),
        Err(CanError::Closed { .. })
    ));
}

#[test]
fn fd_frames_go_through_a_pair_and_a_socket_between_classical_ones() {
    let content: Vec<u8> = (1..=64).collect();
    let fd: Vec<bus::FdFrame> = (0..=64)
        .filter_map(|count| bus::FdFrame::new(CobId::SYNC, &content[..count], count % 2 == 0))
        .collect();
    let (here, there) = UnixDatagram::pair().unwrap();
    let sockets = [here, there].map(|end| SocketCan::over(end.into(), "no interface").unwrap());
    let [mut a, mut b] = sockets;
    let (mut c, mut d) = pair();
    let ends: [(&mut dyn Can, &mut dyn Can); 2] = [(&mut a, &mut b), (&mut c, &mut d)];
    for (from, to) in ends {
        from.use_fd(5000).unwrap();
        from.send(&[frame(0x80, &[1])]).unwrap();
        from.send_fd(&fd).unwrap();
        from.send(&[frame(0x80, &[2])]).unwrap();
        let mut heard = Vec::new();
        while heard.len() < fd.len() + 2 {
            assert!(to.receive(&mut heard, Duration::from_secs(60)).unwrap() > 0);
        }
        let packets: Vec<Packet> = heard.iter().map(|received| received.packet).collect();
        let (last, rest) = packets.split_last().unwrap();
        assert_eq!(rest[0], Packet::Frame(frame(0x80, &[1])));
        assert_eq!(*last, Packet::Frame(frame(0x80, &[2])));
        for (packet, sent) in rest[1..].iter().zip(&fd) {
            let Packet::Fd(got) = packet else {
                panic!("{packet:?}");
            };
            assert_eq!(got.frame(), Some(*sent));
        }
    }
}

#[test]
fn what_comes_as_an_fd_frame_is_one_of_ours_with_a_short_identifier_and_a_length_there_is() {
    let heard = |id, count| FdFrame {
        id,
        data: Data::new(&[7; 64][..count]).unwrap(),
        rate_switched: true,
        sender_passive: true,
    };
    let frame = heard(standard(0x481), 12).frame().unwrap();
    assert_eq!((frame.id().get(), frame.payload()), (0x481, &[7; 12][..]));
    assert_eq!(heard(standard(0x481), 11).frame(), None);
    assert_eq!(heard(Id::Extended(0x481), 12).frame(), None);
}

#[test]
fn filters_let_through_what_they_name_and_error_frames() {
    let node = NodeId::new(0x10).unwrap();
    let all = [
        Packet::Frame(frame(0x190, &[])),
        Packet::Frame(frame(0x210, &[])),
        Packet::Frame(frame(0x191, &[])),
        Packet::Frame(frame(0x080, &[])),
        Packet::Extended(0x190, Data::new(&[]).unwrap()),
        Packet::Error(ErrorFrame::default()),
    ];
    let passing = |filters: &[Filter]| -> Vec<usize> {
        let (mut a, mut b) = pair();
        b.listen_for(filters).unwrap();
        for packet in all {
            a.inject(packet).unwrap();
        }
        let mut heard = Vec::new();
        b.receive(&mut heard, Duration::ZERO).unwrap();
        heard
            .iter()
            .filter_map(|got| all.iter().position(|packet| *packet == got.packet))
            .collect()
    };
    assert_eq!(passing(&[]), [0, 1, 2, 3, 4, 5]);
    assert_eq!(passing(&[Filter::node(node)]), [0, 1, 5]);
    assert_eq!(passing(&[Filter::service(Service::Tpdo1)]), [0, 2, 5]);
    assert_eq!(passing(&[Filter::exactly(CobId::SYNC)]), [3, 5]);
    assert_eq!(
        passing(&[Filter::exactly(CobId::SYNC), Filter::node(node)]),
        [0, 1, 3, 5]
    );
}

fn error(class: u32, controller: u8, sending: u8) -> Packet {
    Packet::Error(ErrorFrame {
        class,
        data: [0, controller, 0, 0, 0, 0, sending, 0],
    })
}

#[test]
fn error_frames_say_what_is_wrong_worst_first() {
    let Packet::Error(frame) = error(0x44, 0x20, 130) else {
        unreachable!()
    };
    let faults: Vec<Fault> = frame.faults().collect();
    assert_eq!(faults, [Fault::BusOff, Fault::Passive]);
    assert_eq!(
        frame.to_string(),
        "bus-off, error passive (error counters: 130 sending, 0 receiving)"
    );
    let unknown = ErrorFrame {
        class: 0x400,
        data: [0; 8],
    };
    assert_eq!(unknown.to_string(), "error class 400h");
}

#[test]
fn errors_add_up_to_a_suspicion() {
    let mut health = Health::default();
    for _ in 0..15 {
        health.note(&error(0x88, 0, 0));
    }
    assert_eq!(health.suspicion(), None);
    health.note(&error(0x88, 0, 0));
    assert_eq!(health.suspicion(), Some(Suspicion::BitRate));
    // A good frame clears the suspicion.
    health.note(&Packet::Frame(frame(1, &[])));
    assert_eq!(health.suspicion(), None);

    for _ in 0..16 {
        health.note(&error(0x20, 0, 0));
    }
    assert_eq!(health.suspicion(), Some(Suspicion::Alone));
    health.note(&Packet::Frame(frame(1, &[])));

    health.note(&error(0x04, 0x20, 140));
    assert_eq!(health.suspicion(), Some(Suspicion::Passive(Some((140, 0)))));
    health.note(&error(0x40, 0, 0));
    assert_eq!(health.suspicion(), Some(Suspicion::BusOff));
    health.note(&error(0x100, 0, 0));
    assert_eq!(health.suspicion(), None);
    assert_eq!((health.frames, health.errors), (2, 35));
}

/// Tests the kernel's receive path over a pair of sockets that any kernel supports.
#[test]
fn bursts_over_a_socket_arrive_whole_in_order_and_with_times() {
    let (here, there) = UnixDatagram::pair().unwrap();
    let (mut a, mut b) = (
        SocketCan::over(here.into(), "a").unwrap(),
        SocketCan::over(there.into(), "b").unwrap(),
    );
    let frames: Vec<Frame> = (0..20_000_u32)
        .map(|n| frame(0x100, &n.to_le_bytes()))
        .collect();
    let started = Stamp::now();
    let sender = {
        let frames = frames.clone();
        std::thread::spawn(move || {
            for burst in frames.chunks(700) {
                a.send(burst).unwrap();
            }
            a
        })
    };
    let mut heard = Vec::new();
    while heard.len() < frames.len() {
        let before = heard.len();
        let count = b.receive(&mut heard, Duration::from_secs(60)).unwrap();
        assert_eq!(heard.len() - before, count);
        assert!(count > 0, "nothing came for a minute");
    }
    let got: Vec<Frame> = heard
        .iter()
        .filter_map(|received| received.packet.frame().copied())
        .collect();
    assert!(got == frames, "frames were lost or changed places");
    assert!(heard.is_sorted_by_key(|received| received.time));
    assert!(heard[0].time >= started && heard[0].time <= Stamp::now());
    drop(sender.join().unwrap());
}

#[test]
fn patience_ends_with_nothing() {
    let (here, there) = UnixDatagram::pair().unwrap();
    let mut end = SocketCan::over(here.into(), "a").unwrap();
    let mut heard = Vec::new();
    for patience in [0, 3, 120].map(Duration::from_millis) {
        let started = Instant::now();
        assert_eq!(end.receive(&mut heard, patience).unwrap(), 0);
        assert!(started.elapsed() >= patience);
    }
    drop(there);
}
