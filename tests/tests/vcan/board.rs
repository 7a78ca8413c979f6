//! `board-sim` on the bus: what it puts on the wire is what the machine inside one process would have.

use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

use leadscrew_can::{Can as _, LogReader, Packet, SocketCan};
use leadscrew_core::bus::{CobId, FdFrame, Frame, NodeId, Service};

use crate::bus::{
    Running, SHEETS, code, eventually, frame, open, ours, packets, receive, scratch, sockets_on,
    tool,
};

fn example(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../examples")
        .join(name)
}

fn board_sim(args: &[&str]) -> Child {
    Command::new(ours("board-sim"))
        .args(args)
        .stdin(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

/// Its exit code and words.
fn end(mut child: Child) -> (Option<i32>, String) {
    let mut said = String::new();
    let code = code(&mut child);
    child
        .stderr
        .take()
        .unwrap()
        .read_to_string(&mut said)
        .unwrap();
    (code, said)
}

/// What belongs to drives: SYNC, NMT to drives, setpoints, statuses, emergencies.
fn is_motion(frame: &Frame) -> bool {
    let drives = [16, 17, 18, 32, 33, 34, 35];
    match frame.id().service() {
        Some((_, node)) => drives.contains(&node.get()),
        None => {
            let to = frame.payload().get(1);
            frame.id() == CobId::SYNC
                || frame.id() == CobId::NMT && to.is_some_and(|node| drives.contains(node))
        }
    }
}

/// The classical frames among these that belong to drives.
fn motion(packets: &[Packet]) -> Vec<Frame> {
    packets
        .iter()
        .filter_map(|packet| packet.frame().copied())
        .filter(is_motion)
        .collect()
}

/// The frames with the setpoints of all drives among these.
fn together(packets: &[Packet]) -> Vec<FdFrame> {
    packets
        .iter()
        .filter_map(|packet| match packet {
            Packet::Fd(frame) => frame.frame(),
            _ => None,
        })
        .collect()
}

/// What the machine inside one process puts on its bus.
fn inside(program: &str, more: &[&str]) -> Vec<Frame> {
    motion(&packets_inside(program, more))
}

fn packets_inside(program: &str, more: &[&str]) -> Vec<Packet> {
    let log = scratch(&format!("{program}.inside.log"));
    tool(
        ours("leadscrew").to_str().unwrap(),
        &[
            &[
                "run",
                example(program).to_str().unwrap(),
                "--record",
                log.to_str().unwrap(),
            ],
            more,
        ]
        .concat(),
    );
    let text = std::fs::read_to_string(log).unwrap();
    LogReader::new(text.as_bytes())
        .map(|entry| entry.unwrap_or_else(|wrong| panic!("{wrong}")).packet)
        .collect()
}

/// What a board puts on the wire that carries the program out by itself, in virtual time.
fn on_the_wire(program: &str, more: &[&str]) -> Vec<Frame> {
    motion(&packets_on_the_wire(program, more))
}

fn packets_on_the_wire(program: &str, more: &[&str]) -> Vec<Packet> {
    let mut to = open();
    let before = sockets_on("vcan0");
    let path = example(program);
    let mut board = board_sim(
        &[
            &[
                "--bus",
                "vcan0",
                "--lockstep",
                "--set",
                SHEETS,
                "--program",
                path.to_str().unwrap(),
            ],
            more,
        ]
        .concat(),
    );
    let mut heard = Vec::new();
    let mut over = false;
    while !over {
        over = board.try_wait().unwrap().is_some();
        while to
            .receive(&mut heard, std::time::Duration::from_millis(50))
            .unwrap()
            > 0
        {}
    }
    let (code, words) = end(board);
    assert_eq!(code, Some(0), "{words}");
    assert_eq!(to.dropped().unwrap(), 0);
    assert!(sockets_on("vcan0") <= before);
    crate::bus::packets(&heard)
}

/// All of `part` stands in `whole` as it is, and nothing but the start-up before it.
fn stands_in(whole: &[Frame], part: &[Frame]) {
    assert!(part.len() > 1000, "{} frames are no program", part.len());
    // The start-up is short: the program's first frames are found near the front.
    let begin = (0..whole.len().saturating_sub(part.len()) + 1)
        .take(2000)
        .find(|begin| whole[*begin..].starts_with(&part[..40]))
        .expect("the first frames of the program are nowhere on the wire");
    for (n, (wire, inside)) in whole[begin..].iter().zip(part).enumerate() {
        assert_eq!(wire, inside, "frame {n} of {}", part.len());
    }
    assert!(whole.len() - begin >= part.len(), "the wire ends early");
}

#[test]
fn the_stream_on_the_wire_is_that_inside_one_process_frame_for_frame() {
    for program in ["g84-tap.nc", "g84-left-hand.nc"] {
        stands_in(&on_the_wire(program, &[]), &inside(program, &[]));
    }
}

#[test]
fn so_it_is_with_a_spindle_that_ripples() {
    let ripple = ["--spindle-ripple", "10@5"];
    stands_in(
        &on_the_wire("o0013-g76-m68x6.nc", &ripple),
        &inside("o0013-g76-m68x6.nc", &ripple),
    );
}

/// The drives in a process of their own: the setpoints go over the wire and nowhere else.
#[test]
fn drives_elsewhere_make_no_difference_to_the_setpoints() {
    drives_elsewhere(&[]);
    // Under other numbers: board and drives have them from the same set.
    drives_elsewhere(&[
        "--set",
        "9015.X=70",
        "--set",
        "9015.C=5",
        "--set",
        "9016=18",
    ]);
}

fn drives_elsewhere(set: &[&str]) {
    let before = sockets_on("vcan0");
    let drives = Running(board_sim(&[&["drives", "--bus", "vcan0"], set].concat()));
    eventually("the drives listen", || sockets_on("vcan0") > before);
    let setpoints = |frames: &[Frame]| -> Vec<Frame> {
        frames
            .iter()
            .filter(|frame| {
                matches!(
                    frame.id().service(),
                    Some((Service::Rpdo1 | Service::Rpdo2, _))
                )
            })
            .filter(|frame| frame.payload().first() == Some(&0x0F))
            .copied()
            .collect()
    };
    let elsewhere = [&["--drives", "elsewhere"], set].concat();
    let there = setpoints(&on_the_wire("g88-side-tap.nc", &elsewhere));
    drop(drives);
    eventually("the drives are gone", || sockets_on("vcan0") == before);
    let here = setpoints(&inside("g88-side-tap.nc", set));
    assert!(here.len() > 1000, "{} frames are no program", here.len());
    // While they come up, drives elsewhere are held a little longer: that alone stands before it.
    assert!(there.len() < here.len() + 200);
    let same = |begin: usize| there[begin..].starts_with(&here);
    assert!((0..there.len()).any(same), "other setpoints");
}

/// With their setpoints in one frame of CAN FD: to drives in a process of their own they are those inside one process,
/// and the targets are those of a machine with a frame for each drive.
#[test]
fn setpoints_in_one_frame_of_can_fd_reach_drives_elsewhere() {
    for (spindles, bytes) in [("9014=1", 24), ("9014=2", 32)] {
        let set = ["--set", "9031=1", "--set", spindles];
        let before = sockets_on("vcan0");
        let drives = Running(board_sim(
            &[&["drives", "--bus", "vcan0"], &set[..]].concat(),
        ));
        eventually("the drives listen", || sockets_on("vcan0") > before);
        let elsewhere = [&["--drives", "elsewhere"], &set[..]].concat();
        let there = packets_on_the_wire("g88-side-tap.nc", &elsewhere);
        drop(drives);
        eventually("the drives are gone", || sockets_on("vcan0") == before);
        let here = packets_inside("g88-side-tap.nc", &set);
        for packets in [&there, &here] {
            let alone = motion(packets);
            let mut alone = alone.iter().filter_map(|frame| frame.id().service());
            assert!(alone.all(|(service, _)| service != Service::Rpdo1));
        }
        let enabled = |packets: &[Packet]| -> Vec<FdFrame> {
            let mut frames = together(packets);
            frames.retain(|frame| frame.payload().first() == Some(&0x0F));
            frames
        };
        let (there, here) = (enabled(&there), enabled(&here));
        assert!(here.len() > 1000, "{} frames are no program", here.len());
        let all = there.iter().chain(&here);
        for frame in all {
            assert_eq!((frame.id().get(), frame.payload().len()), (0x481, bytes));
            assert!(frame.is_rate_switched());
        }
        assert!(there.len() < here.len() + 200);
        let same = |begin: usize| there[begin..].starts_with(&here);
        assert!((0..there.len()).any(same), "other setpoints");

        let alone = inside("g88-side-tap.nc", &["--set", spindles]);
        let x_alone = alone.iter().filter(|frame| frame.id().get() == 0x210);
        let x_alone: Vec<&[u8]> = x_alone.map(Frame::payload).collect();
        let x: Vec<&[u8]> = here.iter().map(|frame| &frame.payload()[..6]).collect();
        assert_eq!(x, x_alone);
    }
}

/// Drives of an axis and of two spindles answer a SYNC, whoever sends it: a real board that has no such drives yet, say.
#[test]
fn drives_of_spindles_are_there_without_a_board() {
    let before = sockets_on("vcan0");
    let which = ["--axes", "Z", "--spindles", "--set", "9014=2"];
    let drives = [&["drives", "--bus", "vcan0"], &which[..]].concat();
    let drives = Running(board_sim(&drives));
    eventually("the drives listen", || sockets_on("vcan0") > before);
    let mut can = open();
    can.send(&[frame(0x080, &[1])]).unwrap();
    let boot_ups = [0x711, 0x720, 0x721].map(|id| Packet::Frame(frame(id, &[0])));
    assert_eq!(packets(&receive(&mut can, 3)), boot_ups);
    drop(drives);
}

/// Reads one expedited object of node 1.
fn read(can: &mut SocketCan, index: u16, sub: u8) -> [u8; 4] {
    let [low, high] = index.to_le_bytes();
    can.send(&[frame(0x601, &[0x40, low, high, sub, 0, 0, 0, 0])])
        .unwrap();
    let mut heard = Vec::new();
    let began = std::time::Instant::now();
    while began.elapsed() < crate::bus::PATIENCE {
        heard.clear();
        can.receive(&mut heard, crate::bus::PATIENCE).unwrap();
        let answer = heard.iter().find_map(|received| match received.packet {
            Packet::Frame(frame) if frame.id() == CobId::of(Service::SdoReply, NodeId::BOARD) => {
                frame.exactly::<8>()
            }
            _ => None,
        });
        if let Some([command, a, b, c, data @ ..]) = answer {
            assert_eq!((a, b, c), (low, high, sub));
            assert_eq!(command & 0xE0, 0x40, "refused: {data:02X?}");
            return data;
        }
    }
    panic!("the board does not answer");
}

#[test]
fn a_board_in_real_time_answers_and_ends_by_itself() {
    // A long tick: a kernel booted as a program is slow.
    let slow = ["--bus", "vcan0", "--set", "9000=5000"];
    let mut can = open();
    let board = Running(board_sim(&slow));
    let mut heard = Vec::new();
    // SYNC is there, with a counter that counts.
    let mut counters = Vec::new();
    while counters.len() < 50 {
        heard.clear();
        assert!(can.receive(&mut heard, crate::bus::PATIENCE).unwrap() > 0);
        counters.extend(
            heard
                .iter()
                .filter_map(|received| received.packet.frame())
                .filter(|frame| frame.id() == CobId::SYNC)
                .map(|frame| frame.payload()[0]),
        );
    }
    assert!(counters.windows(2).all(|pair| pair[1] == pair[0] % 240 + 1));
    // Device type, and the identity: any CANopen tool can read them.
    assert_ne!(read(&mut can, 0x1018, 0), [0; 4]);
    read(&mut can, 0x1000, 0);
    drop(board);
    let (code, words) = end(board_sim(&[&slow[..], &["--ticks", "300"]].concat()));
    assert_eq!(code, Some(0), "{words}");
    assert!(
        words.contains("ready") && words.contains("300 ticks"),
        "{words}"
    );
}

#[test]
fn trouble_of_a_drive_stops_the_machine_and_is_told() {
    let path = example("o0013-g76-m68x6.nc");
    let board = board_sim(&[
        "--bus",
        "vcan0",
        "--lockstep",
        "--set",
        SHEETS,
        "--program",
        path.to_str().unwrap(),
        "--trouble",
        "X=fault:7305@3000",
    ]);
    let mut can = open();
    let mut heard = Vec::new();
    let mut emergency = None;
    while emergency.is_none() {
        heard.clear();
        assert!(can.receive(&mut heard, crate::bus::PATIENCE).unwrap() > 0);
        emergency = heard
            .iter()
            .filter_map(|received| received.packet.frame())
            .find(|frame| frame.id().get() == 0x090)
            .copied();
    }
    assert_eq!(emergency.unwrap().payload()[..2], [0x05, 0x73]);
    let (code, words) = end(board);
    assert_eq!(code, Some(4), "{words}");
    assert!(words.contains("alarm") && words.contains('X'), "{words}");
}

#[test]
fn a_board_without_a_bus_says_so() {
    for (args, code, said) in [
        (["--bus", "vcan7"], 3, "there is no interface `vcan7`"),
        (["--bus", "sim"], 3, "give a real bus"),
    ] {
        let (got, words) = end(board_sim(&args));
        assert_eq!(got, Some(code), "{words}");
        assert!(words.contains(said), "{words}");
    }
}

#[test]
fn a_board_that_ends_with_a_tap_in_its_hole_leaves_the_entry_in_its_file() {
    let state = scratch("board.state");
    let state = state.to_str().unwrap();
    let path = example("g84-tap.nc");
    let board = board_sim(&[
        "--bus",
        "vcan0",
        "--lockstep",
        "--set",
        SHEETS,
        "--program",
        path.to_str().unwrap(),
        "--state",
        state,
        "--trouble",
        "Z=silent@2500",
    ]);
    let (code, words) = end(board);
    assert_eq!(code, Some(4), "{words}");
    let status = tool(
        ours("leadscrew").to_str().unwrap(),
        &["status", "--state", state],
    );
    let status = String::from_utf8_lossy(&status.stdout).into_owned();
    assert!(
        status.starts_with("a tap is in a hole"),
        "{words}\n{status}"
    );
}
