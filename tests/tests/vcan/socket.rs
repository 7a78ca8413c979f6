//! Our end of the bus against another of ours.

use std::time::Duration;

use leadscrew_can::{Can as _, CanError, Filter, Health, Id, Packet, SocketCan, Stamp, Suspicion};
use leadscrew_core::bus::{CobId, FdFrame, Frame, NodeId};

use crate::bus::{frame, open, open_on, packets, receive, tool};

/// Frames of the big burst.
const MANY: u32 = 500_000;

/// Frames in one go.
const BURST: u32 = 2_000;

#[test]
fn five_hundred_thousand_frames_in_bursts_arrive_complete_and_in_order() {
    let (mut from, mut to) = (open(), open());
    let sender = std::thread::spawn(move || {
        let mut burst: Vec<Frame> = Vec::new();
        for first in (0..MANY).step_by(BURST as usize) {
            burst.clear();
            burst.extend((first..first + BURST).map(|n| frame(0x100, &n.to_le_bytes())));
            from.send(&burst).unwrap();
        }
        from
    });
    let mut next = 0_u32;
    let mut heard = Vec::new();
    let mut last = Stamp::default();
    while next < MANY {
        heard.clear();
        let count = to.receive(&mut heard, crate::bus::PATIENCE).unwrap();
        assert!(count > 0, "{next} of {MANY} came");
        for received in &heard {
            let Packet::Frame(frame) = received.packet else {
                panic!("{:?} was not sent", received.packet);
            };
            let number = frame.exactly::<4>().map(u32::from_le_bytes);
            assert_eq!(number, Some(next), "one was lost or changed its place");
            assert!(received.time >= last, "time went back at {next}");
            last = received.time;
            next += 1;
        }
    }
    assert_eq!(to.dropped().unwrap(), 0);
    drop(sender.join().unwrap());
}

#[test]
fn what_nobody_takes_out_in_time_is_counted() {
    let (mut from, mut to) = (open(), open());
    // More than any buffer holds would take long to send; a small one shows it as well.
    nix::sys::socket::setsockopt(to.socket(), nix::sys::socket::sockopt::RcvBuf, &4096).unwrap();
    let frames: Vec<Frame> = (0..1000_u32)
        .map(|n| frame(0x100, &n.to_le_bytes()))
        .collect();
    from.send(&frames).unwrap();
    let mut heard = Vec::new();
    while to.receive(&mut heard, Duration::ZERO).unwrap() > 0 {}
    let dropped = to.dropped().unwrap();
    assert!(!heard.is_empty() && heard.len() < 1000, "{}", heard.len());
    assert_eq!(dropped as usize + heard.len(), 1000);
}

#[test]
fn the_kernel_filters_what_nobody_asked_for() {
    let (mut from, mut to) = (open(), open());
    let node = NodeId::new(0x10).unwrap();
    to.listen_for(&[Filter::node(node), Filter::exactly(CobId::SYNC)])
        .unwrap();
    let sent = [
        frame(0x190, &[1]),
        frame(0x191, &[2]),
        frame(0x080, &[3]),
        frame(0x710, &[4]),
        frame(0x000, &[5]),
    ];
    from.send(&sent).unwrap();
    let wanted = [sent[0], sent[2], sent[3]].map(Packet::Frame);
    assert_eq!(packets(&receive(&mut to, 3)), wanted);
    assert_eq!(to.receive(&mut Vec::new(), Duration::ZERO).unwrap(), 0);
    to.listen_for(&[]).unwrap();
    from.send(&sent).unwrap();
    assert_eq!(receive(&mut to, 5).len(), 5);
}

#[test]
fn fd_frames_are_received_and_told_as_such() {
    let mut to = open();
    tool("cansend", &["vcan0", "321##1000102030405060708090A0B"]);
    tool("cansend", &["vcan0", "123#AABB"]);
    let heard = receive(&mut to, 2);
    let Packet::Fd(fd) = heard[0].packet else {
        panic!("{:?}", heard[0].packet);
    };
    assert_eq!(fd.id, Id::Standard(CobId::new(0x321).unwrap()));
    assert_eq!(fd.data.bytes(), [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11]);
    assert!(fd.rate_switched);
    assert_eq!(heard[1].packet, Packet::Frame(frame(0x123, &[0xAA, 0xBB])));
    let mut health = Health::default();
    for received in &heard {
        health.note(&received.packet);
    }
    assert_eq!((health.frames, health.fd_frames), (2, 1));
}

#[test]
fn an_interface_for_classical_frames_refuses_fd_with_the_way_to_change_that() {
    let name = "vcan7";
    tool("ip", &["link", "add", "dev", name, "type", "vcan"]);
    tool("ip", &["link", "set", name, "mtu", "16", "up"]);
    let mut end = open_on(name);
    let asked = end.use_fd(5000).unwrap_err().to_string();
    let fd = FdFrame::new(CobId::new(0x481).unwrap(), &[0; 12], true).unwrap();
    let sent = end.send_fd(&[fd]).unwrap_err().to_string();
    tool("ip", &["link", "del", name]);
    assert_eq!(asked, sent);
    assert!(asked.contains("`ip link set vcan7 mtu 72`"), "{asked}");
}

#[test]
fn error_frames_come_through_filters_and_say_what_is_wrong() {
    let mut to = open();
    to.listen_for(&[Filter::exactly(CobId::SYNC)]).unwrap();
    // Bus-off and error passive, with the counters.
    tool("cansend", &["vcan0", "20000044#0020000000008800"]);
    let heard = receive(&mut to, 1);
    let Packet::Error(error) = heard[0].packet else {
        panic!("{:?}", heard[0].packet);
    };
    assert_eq!(
        error.to_string(),
        "bus-off, error passive (error counters: 136 sending, 0 receiving)"
    );
    let mut health = Health::default();
    health.note(&heard[0].packet);
    assert_eq!(health.suspicion(), Some(Suspicion::BusOff));
}

#[test]
fn an_interface_that_goes_down_in_mid_run_is_told_and_so_is_one_that_vanishes() {
    let name = "vcan9";
    tool("ip", &["link", "add", "dev", name, "type", "vcan"]);
    let down = SocketCan::open(name).unwrap_err();
    assert!(matches!(down, CanError::Down { .. }), "{down}");
    tool("ip", &["link", "set", name, "up"]);

    let (mut a, mut b) = (open_on(name), open_on(name));
    a.send(&[frame(0x80, &[1])]).unwrap();
    assert_eq!(receive(&mut b, 1).len(), 1);
    tool("ip", &["link", "set", name, "down"]);
    let mut heard = Vec::new();
    let error = b.receive(&mut heard, crate::bus::PATIENCE).unwrap_err();
    assert!(matches!(error, CanError::Down { .. }), "{error}");
    assert!(
        error.to_string().contains("ip link set vcan9 up"),
        "{error}"
    );
    let error = a.send(&[frame(0x80, &[2])]).unwrap_err();
    assert!(matches!(error, CanError::Down { .. }), "{error}");

    // It comes back, and so do the frames.
    tool("ip", &["link", "set", name, "up"]);
    let mut c = open_on(name);
    c.send(&[frame(0x80, &[3])]).unwrap();
    assert_eq!(
        packets(&receive(&mut b, 1)),
        [Packet::Frame(frame(0x80, &[3]))]
    );

    tool("ip", &["link", "delete", name]);
    let gone = (0..3)
        .find_map(|_| b.receive(&mut heard, Duration::from_millis(100)).err())
        .expect("an interface that is gone is told");
    assert!(
        matches!(gone, CanError::Gone { .. } | CanError::Down { .. }),
        "{gone}"
    );
    let error = SocketCan::open(name).unwrap_err();
    assert!(
        matches!(&error, CanError::NoInterface { known, .. } if known.contains(&"vcan0".to_owned())),
        "{error}"
    );
}

#[test]
fn an_interface_of_another_kind_is_refused_by_name() {
    let error = SocketCan::open("lo").unwrap_err();
    assert!(matches!(error, CanError::NotCan { .. }), "{error}");
}
