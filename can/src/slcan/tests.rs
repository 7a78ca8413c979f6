//! Tests against the adapter's side of the protocol, over each kind of line.

use std::io::{BufRead as _, ErrorKind, Read, Write};
use std::net::TcpListener;
use std::os::unix::net::{UnixListener, UnixStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use leadscrew_core::bus::{self, CobId, Frame};
use leadscrew_slcan::{Adapter, BitRate, Heard, Lines, SlcanFrame};
use nix::pty::openpty;

use super::WINDOW;
use crate::{Address, Can, CanError, Filter, Packet, Received, Slcan};

static NUMBER: AtomicU32 = AtomicU32::new(0);

/// A path that no other test uses.
fn path(name: &str) -> std::path::PathBuf {
    let number = NUMBER.fetch_add(1, Ordering::Relaxed);
    std::env::temp_dir().join(format!("leadscrew-{name}-{}-{number}", std::process::id()))
}

fn frame(id: u16, payload: &[u8]) -> Frame {
    Frame::new(CobId::new(id).unwrap(), payload).unwrap()
}

/// An adapter whose bus sends every frame back with its first byte incremented. The adapter ends with the line.
fn serve(mut line: impl Read + Write + Send + 'static) -> JoinHandle<Adapter> {
    std::thread::spawn(move || {
        let mut adapter = Adapter::new(0x10, 0x10, *b"TEST");
        let mut lines = Lines::new();
        let mut bytes = [0; 256];
        loop {
            let count = match line.read(&mut bytes) {
                Ok(0) => return adapter,
                Ok(count) => count,
                Err(error) if error.kind() == ErrorKind::Interrupted => continue,
                // The error of a terminal after its other end is gone.
                Err(_) => return adapter,
            };
            let mut answer = Vec::new();
            for byte in &bytes[..count] {
                let Some(heard) = lines.push(*byte) else {
                    continue;
                };
                // A terminal that is not set up yet echoes bytes; these are no requests.
                if heard == Heard::Bell {
                    continue;
                }
                let handled = adapter.handle(heard);
                answer.extend(handled.reply.line().bytes());
                if let Some(SlcanFrame::Data(sent)) = handled.send {
                    let mut payload = sent.payload().to_vec();
                    if let Some(first) = payload.first_mut() {
                        *first = first.wrapping_add(1);
                    }
                    let back = SlcanFrame::Data(frame(sent.id().get(), &payload));
                    let reply = adapter.received(&back, 0).unwrap();
                    answer.extend(reply.line().bytes());
                }
            }
            if line.write_all(&answer).is_err() {
                return adapter;
            }
        }
    })
}

/// Sends many frames and receives the same number back, in order.
fn exchange(address: &Address) {
    let mut can = Slcan::open(address, BitRate::M1).unwrap();
    let frames: Vec<Frame> = (0..1000_u16)
        .map(|n| frame(0x100 + n % 0x400, &n.to_le_bytes()))
        .collect();
    can.send(&frames).unwrap();
    let mut heard: Vec<Received> = Vec::new();
    while heard.len() < frames.len() {
        let count = can.receive(&mut heard, Duration::from_secs(60)).unwrap();
        assert!(count > 0, "{} frames came back", heard.len());
    }
    for (received, sent) in heard.iter().zip(&frames) {
        let back = received.packet.frame().unwrap();
        assert_eq!(back.id(), sent.id());
        assert_eq!(back.payload()[0], sent.payload()[0].wrapping_add(1));
    }
    // No further frame, and the wait takes its full time.
    let count = can.receive(&mut heard, Duration::from_millis(20)).unwrap();
    assert_eq!(count, 0);

    can.listen_for(&[Filter::exactly(CobId::new(0x123).unwrap())])
        .unwrap();
    heard.clear();
    can.send(&[frame(0x122, &[1]), frame(0x123, &[2])]).unwrap();
    while heard.is_empty() {
        can.receive(&mut heard, Duration::from_secs(60)).unwrap();
    }
    assert_eq!(heard.len(), 1);
    assert_eq!(heard[0].packet.frame(), Some(&frame(0x123, &[3])));
}

#[test]
fn over_a_unix_socket() {
    let path = path("unix");
    let listener = UnixListener::bind(&path).unwrap();
    let server = std::thread::spawn(move || serve(listener.accept().unwrap().0).join().unwrap());
    exchange(&Address::Unix(path.clone()));
    let adapter = server.join().unwrap();
    assert!(!adapter.is_open(), "it is closed at the end");
    assert_eq!(adapter.bit_rate(), Some(BitRate::M1));
    std::fs::remove_file(path).unwrap();
}

#[test]
fn over_tcp() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap().port();
    let server = std::thread::spawn(move || serve(listener.accept().unwrap().0).join().unwrap());
    exchange(&Address::Tcp {
        host: "localhost".into(),
        port,
    });
    assert!(!server.join().unwrap().is_open());
}

#[test]
fn over_a_terminal() {
    let pty = openpty(None, None).unwrap();
    let path = nix::unistd::ttyname(&pty.slave).unwrap();
    let server = serve(std::fs::File::from(pty.master));
    exchange(&Address::Serial {
        path,
        baud: 115_200,
    });
    drop(pty.slave);
    assert!(!server.join().unwrap().is_open());
}

#[test]
fn an_adapter_that_was_left_open_is_closed_first() {
    let path = path("open");
    let listener = UnixListener::bind(&path).unwrap();
    let server = std::thread::spawn(move || {
        let (line, _) = listener.accept().unwrap();
        let mut both = line.try_clone().unwrap();
        // An old frame, and half of another.
        both.write_all(b"t1230\rt456").unwrap();
        serve(line).join().unwrap()
    });
    let mut can = Slcan::open(&Address::Unix(path.clone()), BitRate::K500).unwrap();
    can.send(&[frame(0x111, &[1])]).unwrap();
    let mut heard = Vec::new();
    while heard.is_empty() {
        can.receive(&mut heard, Duration::from_secs(60)).unwrap();
    }
    assert_eq!(heard[0].packet.frame(), Some(&frame(0x111, &[2])));
    drop(can);
    assert_eq!(server.join().unwrap().bit_rate(), Some(BitRate::K500));
    std::fs::remove_file(path).unwrap();
}

/// An adapter like a CANable 2.0: it knows `Y` while it is closed, acknowledges with a line, and its bus sends every
/// frame back. Gives the received commands at its end.
fn serve_fd(mut line: impl Read + Write + Send + 'static) -> JoinHandle<Vec<String>> {
    std::thread::spawn(move || {
        let (mut told, mut heard, mut open) = (Vec::new(), Vec::new(), false);
        let mut bytes = [0; 256];
        while let Ok(count @ 1..) = line.read(&mut bytes) {
            heard.extend_from_slice(&bytes[..count]);
            while let Some(end) = heard.iter().position(|byte| *byte == b'\r') {
                let text = String::from_utf8(heard.drain(..=end).collect()).unwrap();
                let text = text.trim_end().to_owned();
                let answer = match (text.as_bytes(), open) {
                    ([], _) => "\r".into(),
                    ([b'V'], _) => "V1013\r".into(),
                    ([b'C'], _) => {
                        open = false;
                        "\r".into()
                    }
                    ([b'O'], _) => {
                        open = true;
                        "\r".into()
                    }
                    ([b'S', b'8'] | [b'Y', b'1' | b'2' | b'4' | b'5' | b'8'], false) => "\r".into(),
                    ([b't' | b'b' | b'd', ..], true) => format!("\r{text}\r"),
                    _ => "\x07".into(),
                };
                told.push(text);
                if line.write_all(answer.as_bytes()).is_err() {
                    return told;
                }
            }
        }
        told
    })
}

#[test]
fn an_adapter_that_knows_fd_frames_is_told_their_rate_and_carries_them_between_others() {
    let path = path("fd");
    let listener = UnixListener::bind(&path).unwrap();
    let server = std::thread::spawn(move || serve_fd(listener.accept().unwrap().0).join().unwrap());
    let mut can = Slcan::open(&Address::Unix(path.clone()), BitRate::M1).unwrap();
    let unknown = can.use_fd(3000).unwrap_err().to_string();
    assert!(
        unknown.contains("no FD frames with their data at 3000 kbit/s"),
        "{unknown}"
    );
    can.use_fd(5000).unwrap();
    let content: Vec<u8> = (1..=64).collect();
    let fd: Vec<bus::FdFrame> = (0..=64)
        .filter_map(|count| bus::FdFrame::new(CobId::new(0x481)?, &content[..count], count > 0))
        .collect();
    can.send(&[frame(0x80, &[1])]).unwrap();
    can.send_fd(&fd).unwrap();
    can.send(&[frame(0x80, &[2])]).unwrap();
    let mut heard: Vec<Received> = Vec::new();
    while heard.len() < fd.len() + 2 {
        assert!(can.receive(&mut heard, Duration::from_secs(60)).unwrap() > 0);
    }
    let back = |place: usize| match heard[place].packet {
        Packet::Frame(frame) => frame.payload().to_vec(),
        Packet::Fd(got) => {
            assert_eq!(got.frame(), Some(fd[place - 1]));
            Vec::new()
        }
        other => panic!("{other:?}"),
    };
    assert_eq!(back(0), [1]);
    assert!((1..=fd.len()).all(|place| back(place).is_empty()));
    assert_eq!(back(fd.len() + 1), [2]);
    drop(can);
    let told = server.join().unwrap();
    let commands: Vec<&str> = told
        .iter()
        .map(String::as_str)
        .filter(|line| !line.is_empty() && !line.starts_with(['t', 'b', 'd']))
        .collect();
    assert_eq!(commands, ["C", "V", "S8", "O", "C", "Y5", "O", "C"]);
    assert!(told.contains(&"b48190102030405060708090A0B0C".into()));
    std::fs::remove_file(path).unwrap();
}

/// A parameter set with another rate comes into force while frames are under way. Their acknowledgements must not pass
/// for the answer to a command, and must be counted.
#[test]
fn the_rate_can_change_while_frames_are_under_way() {
    let path = path("rate");
    let listener = UnixListener::bind(&path).unwrap();
    let server = std::thread::spawn(move || serve_fd(listener.accept().unwrap().0).join().unwrap());
    let mut can = Slcan::open(&Address::Unix(path.clone()), BitRate::M1).unwrap();
    let few: Vec<Frame> = (0..5).map(|n| frame(0x181, &[n])).collect();
    let mut heard: Vec<Received> = Vec::new();
    for round in 0..40 {
        can.send(&few).unwrap();
        can.use_fd(if round % 2 == 0 { 2000 } else { 5000 })
            .unwrap();
    }
    while heard.len() < 200 {
        assert!(can.receive(&mut heard, Duration::from_secs(60)).unwrap() > 0);
    }
    drop(can);
    let told = server.join().unwrap();
    let rates = told.iter().filter(|line| line.starts_with('Y')).count();
    assert_eq!(rates, 40);
    std::fs::remove_file(path).unwrap();
}

#[test]
fn an_adapter_that_knows_no_fd_frames_says_so() {
    let path = path("classical");
    let listener = UnixListener::bind(&path).unwrap();
    let server = std::thread::spawn(move || serve(listener.accept().unwrap().0).join().unwrap());
    let mut can = Slcan::open(&Address::Unix(path.clone()), BitRate::M1).unwrap();
    let error = can.use_fd(5000).unwrap_err().to_string();
    assert!(
        error.contains("carries no FD frames with their data at 5000 kbit/s"),
        "{error}"
    );
    drop(can);
    server.join().unwrap();
    std::fs::remove_file(path).unwrap();
}

fn message(address: &Address) -> String {
    match Slcan::open(address, BitRate::M1) {
        Ok(_) => "opened".into(),
        Err(error) => error.to_string(),
    }
}

#[test]
fn each_mistake_has_its_own_words() {
    let nowhere = path("nowhere");
    assert!(message(&Address::Unix(nowhere.clone())).contains("is the adapter plugged in"));
    let serial = |path: &std::path::Path, baud| Address::Serial {
        path: path.into(),
        baud,
    };
    assert!(message(&serial(&nowhere, 115_200)).contains("is the adapter plugged in"));
    assert!(message(&serial(&nowhere, 12_345)).contains("does not run at 12345 baud"));

    // A port without a listener.
    let port = TcpListener::bind("127.0.0.1:0")
        .unwrap()
        .local_addr()
        .unwrap()
        .port();
    let address = Address::Tcp {
        host: "127.0.0.1".into(),
        port,
    };
    assert!(message(&address).contains("refuses the connection"));

    // An adapter that sends nothing, one that refuses, and one that closes the connection.
    for (said, expected) in [
        (None, "does not answer to `S`"),
        (Some(b"\x07"), "refuses `S`"),
    ] {
        let path = path("silent");
        let listener = UnixListener::bind(&path).unwrap();
        let server = std::thread::spawn(move || {
            let (mut line, _) = listener.accept().unwrap();
            let mut bytes = [0; 64];
            // The bytes received so far. The answer comes only after an `S`.
            let mut heard = Vec::new();
            while let Ok(count @ 1..) = line.read(&mut bytes) {
                heard.extend_from_slice(&bytes[..count]);
                if let Some(said) = said
                    && heard.contains(&b'S')
                {
                    let _ = line.write_all(said);
                }
            }
        });
        let told = message(&Address::Unix(path.clone()));
        assert!(told.contains(expected), "{told}");
        server.join().unwrap();
        std::fs::remove_file(path).unwrap();
    }
    let path = path("gone");
    let listener = UnixListener::bind(&path).unwrap();
    let server = std::thread::spawn(move || drop(listener.accept().unwrap()));
    let told = message(&Address::Unix(path.clone()));
    assert!(told.contains("closed the connection"), "{told}");
    server.join().unwrap();
    std::fs::remove_file(path).unwrap();
}

#[test]
fn what_is_no_serial_line_is_told() {
    let file = path("file");
    std::fs::write(&file, "not an adapter").unwrap();
    let socket = path("socket");
    let listener = UnixListener::bind(&socket).unwrap();
    let folder = std::env::temp_dir();
    for wrong in [&file, &socket, &folder, &"/dev/null".into()] {
        let address = Address::Serial {
            path: wrong.clone(),
            baud: 115_200,
        };
        let opened = Slcan::open(&address, BitRate::M1);
        let error = opened.err().unwrap();
        assert!(matches!(error, CanError::NotSerial { .. }), "{error}");
        assert!(error.to_string().contains("is no serial line"), "{error}");
        assert!(error.chinese().contains("不是串口"));
    }
    assert_eq!(std::fs::read_to_string(&file).unwrap(), "not an adapter");
    drop(listener);
    std::fs::remove_file(file).unwrap();
    std::fs::remove_file(socket).unwrap();
}

#[test]
fn a_terminal_in_use_is_told() {
    let pty = openpty(None, None).unwrap();
    let path = nix::unistd::ttyname(&pty.slave).unwrap();
    let server = serve(std::fs::File::from(pty.master));
    let address = Address::Serial { path, baud: 9600 };
    let first = Slcan::open(&address, BitRate::M1).unwrap();
    assert!(message(&address).contains("in use by another program"));
    drop(first);
    drop(pty.slave);
    server.join().unwrap();
}

#[test]
fn a_line_that_ends_in_mid_run_is_told() {
    let path = path("ends");
    let listener = UnixListener::bind(&path).unwrap();
    let server = std::thread::spawn(move || {
        let (line, _) = listener.accept().unwrap();
        let other = line.try_clone().unwrap();
        (serve(line), other)
    });
    let mut can = Slcan::open(&Address::Unix(path.clone()), BitRate::M1).unwrap();
    let (adapter, line) = server.join().unwrap();
    line.shutdown(std::net::Shutdown::Both).unwrap();
    let error = can
        .receive(&mut Vec::new(), Duration::from_secs(60))
        .unwrap_err();
    assert!(matches!(error, CanError::Closed { .. }), "{error}");
    adapter.join().unwrap();
    std::fs::remove_file(path).unwrap();
}

/// An adapter that is open, with frames under way.
fn opened(stream: UnixStream, under_way: usize, patience: Duration) -> Slcan {
    let now = Instant::now();
    Slcan {
        name: "adapter".into(),
        stream: Box::new(stream),
        lines: Lines::with_room(),
        filters: Vec::new(),
        under_way,
        active: now,
        acknowledged: now,
        heard: now,
        refused: false,
        early: Vec::new(),
        patience,
    }
}

/// A serial line drops bytes. One acknowledgement in ten is lost; frames of others are heard.
#[test]
fn acknowledgements_that_are_lost_end_nothing() {
    let (adapter, stream) = UnixStream::pair().unwrap();
    let mut can = opened(stream, 0, Duration::from_secs(60));
    let mut says = adapter.try_clone().unwrap();
    let mut answers = adapter.try_clone().unwrap();
    let acknowledges = std::thread::spawn(move || {
        let lines = std::io::BufReader::new(adapter).split(b'\r');
        let mut told = 0;
        for (number, _) in lines.map_while(Result::ok).enumerate() {
            if number % 10 != 9 {
                let _ = answers.write_all(b"z\r");
            }
            told += 1;
        }
        told
    });
    let over = Arc::new(AtomicBool::new(false));
    let ends = Arc::clone(&over);
    let speaks = std::thread::spawn(move || {
        while !ends.load(Ordering::Relaxed) && says.write_all(b"t10012A\r").is_ok() {
            std::thread::sleep(Duration::from_millis(20));
        }
    });
    for number in 0..200 {
        can.send(&[frame(0x181, &[number])]).unwrap();
    }
    // Before a command all are waited for.
    can.settle(0).unwrap();
    assert_eq!(can.under_way, 0);
    over.store(true, Ordering::Relaxed);
    speaks.join().unwrap();
    drop(can);
    assert_eq!(
        acknowledges.join().unwrap(),
        201,
        "and the line that closes it"
    );
}

/// An adapter that acknowledges nothing at all is stuck, whatever is heard of others.
#[test]
fn an_adapter_that_hears_and_never_sends_is_stuck() {
    let (adapter, stream) = UnixStream::pair().unwrap();
    let mut can = opened(stream, WINDOW, Duration::from_millis(100));
    let mut says = adapter.try_clone().unwrap();
    let speaks = std::thread::spawn(move || {
        while says.write_all(b"t10012A\r").is_ok() {
            std::thread::sleep(Duration::from_millis(20));
        }
    });
    let ended = can.send(&[frame(0x181, &[1])]);
    assert!(
        matches!(ended, Err(CanError::AdapterStuck { .. })),
        "{ended:?}"
    );
    drop((can, adapter));
    speaks.join().unwrap();
}

/// This side stalled: the bytes that arrived meanwhile are read before the adapter counts as late, but no later bytes.
#[test]
fn acknowledgements_that_lie_there_are_not_late() {
    for (acknowledged, is_taken) in [(5, true), (4, false), (0, false)] {
        let (mut adapter, stream) = UnixStream::pair().unwrap();
        let mut can = opened(stream, 5, Duration::ZERO);
        let said = "z\r".repeat(acknowledged) + "t10012A\r";
        adapter.write_all(said.as_bytes()).unwrap();
        match can.settle(0) {
            Ok(()) => assert!(is_taken),
            Err(CanError::AdapterStuck { .. }) => assert!(!is_taken),
            other => panic!("{other:?}"),
        }
        let mut heard = Vec::new();
        can.receive(&mut heard, Duration::ZERO).unwrap();
        assert_eq!(heard.len(), 1, "what else it said is not lost");
        assert_eq!(heard[0].packet.frame(), Some(&frame(0x100, &[0x2A])));
    }
}
