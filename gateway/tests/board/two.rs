//! Two boards on one bus, with a gateway each.

use leadscrew::link::Link;
use leadscrew_can::BitRate;
use leadscrew_core::bus::{NmtCommand, NodeId};
use serde_json::Value;

use crate::server::{Options, Server};
use crate::{Run, bad, command, good, json, leadscrew, text, wait_until};

fn two(set: Vec<(&'static str, i64)>, speed: u32) -> Server {
    Server::start(&Options {
        nodes: vec![1, 2],
        set,
        speed,
        ..Options::default()
    })
}

fn status(bus: &str, node: &str) -> Value {
    json(&leadscrew(&["status", "--json", "--node", node], bus))
}

#[test]
fn each_is_told_by_its_number_and_the_other_is_named() {
    let server = two(vec![("9024", 0)], 20);
    let bus = server.bus();
    // One that says nothing for the two seconds that are listened is not named.
    wait_until("the other one is named", || {
        let told = good(&leadscrew(&["status"], &bus));
        assert!(told.starts_with("node 1   idle   mode manual\n"), "{told}");
        told.ends_with("also on this bus: node 2 (`leadscrew status --node 2`)\n")
            .then_some(())
    });
    let told = good(&leadscrew(&["status", "--node", "2"], &bus));
    assert!(told.starts_with("node 2   idle   mode manual\n"), "{told}");
    assert!(!told.contains("also"), "{told}");
    // What is done to one is not done to the other.
    good(&leadscrew(&["override", "feed", "50", "--node", "2"], &bus));
    good(&leadscrew(&["stop", "--node", "2"], &bus));
    let [first, second] = ["1", "2"].map(|node| status(&bus, node));
    assert_eq!(first["override"]["feed"], 100);
    assert_eq!(second["override"]["feed"], 50);
    assert_eq!(
        (&first["state"], &second["state"]),
        (&"idle".into(), &"alarm".into())
    );
    let address = bus.parse().unwrap();
    let mut link = Link::open(&address, NodeId::new(2).unwrap(), BitRate::M1).unwrap();
    let stop = NmtCommand::Stop.frame(Some(link.node()));
    link.send(&[stop]).unwrap();
    let told = bad(&leadscrew(&["status", "--node", "2"], &bus), 3);
    assert!(told.contains("has been stopped by NMT"), "{told}");
    assert!(told.contains("000#0102"), "{told}");
    let told = bad(&leadscrew(&["status", "--node", "3"], &bus), 3);
    assert!(told.contains("no board answers as node 3"), "{told}");
    assert!(told.contains("heard there: node 1, 2"), "{told}");
}

/// [D171]
#[test]
fn each_board_misses_its_own_gateway_and_no_other() {
    let server = two(vec![("9024", 2000)], 1);
    let bus = server.bus();
    let start = |program, node| Run::of(command(&["run", program, "--json", "--node", node], &bus));
    let runs = |node| {
        wait_until(&format!("board {node} runs"), || {
            let status = status(&bus, node);
            (status["program"] == true && status["line"].as_u64() > Some(3)).then_some(())
        });
    };
    let mut first = start("examples/shaft.nc", "1");
    runs("1");
    let second = start("examples/shaft.nc", "2");
    runs("2");
    first.0.kill().unwrap();
    let first = text(&first.end().stderr);
    wait_until("the board that has lost its gateway holds", || {
        (status(&bus, "1")["state"] == "hold").then_some(())
    });
    assert_eq!(status(&bus, "2")["program"], true, "the other goes on");
    server.hurry();
    let output = second.end();
    let ran = json(&output);
    assert_eq!(output.status.code(), Some(0), "{ran}");
    // The one that comes second, unless the first could not beat in time.
    let told = text(&output.stderr);
    let moved = |told: &str, node| {
        let words = format!("another gateway is on this bus; this one is node {node} meanwhile");
        told.contains(&words)
    };
    assert!(moved(&told, 124) || moved(&first, 125), "{first}{told}");
    let alone = command(&["run", "examples/shaft.nc", "--json"], "sim");
    let alone = json(&{ alone }.output().unwrap());
    assert_eq!(ran["setpoint_hash"], alone["setpoint_hash"]);
    // The next gateway of the first board is the one that it watches again.
    good(&leadscrew(&["reset"], &bus));
    good(&leadscrew(&["run", "examples/g84-peck.nc"], &bus));
}

/// The second one waits for its program's text where it checks it, until the first one runs. [D171]
#[test]
fn whoever_comes_too_late_leaves_the_board_to_the_gateway_it_has() {
    let server = Server::start(&Options {
        set: vec![("9024", 2000)],
        speed: 1,
        ..Options::default()
    });
    let bus = server.bus();
    let path = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("late.nc");
    let _ = std::fs::remove_file(&path);
    nix::unistd::mkfifo(&path, nix::sys::stat::Mode::S_IRWXU).unwrap();
    let second = Run::start(path.to_str().unwrap(), &bus);
    let mut text_of_second = std::fs::File::options().write(true).open(&path).unwrap();
    // The tap journal comes behind the first look at the board.
    wait_until("the second one has found the board ready", || {
        server.was_asked(1, [0x30, 0x50, 1]).then_some(())
    });
    let first = Run::start("examples/shaft.nc", &bus);
    wait_until("the first one runs", || {
        (status(&bus, "1")["program"] == true).then_some(())
    });
    std::io::Write::write_all(&mut text_of_second, b"G0 X40\nM30\n").unwrap();
    drop(text_of_second);
    let told = bad(&second.end(), 3);
    assert!(told.contains("node 1 is busy ("), "{told}");
    server.hurry();
    let output = first.end();
    let ran = json(&output);
    assert_eq!(output.status.code(), Some(0), "{ran}");
    let writes =
        |frame: &leadscrew_core::bus::Frame| frame.payload().starts_with(&[0x23, 0x16, 0x10, 1]);
    assert!(!server.dialogue().iter().any(writes));
}

#[test]
fn a_table_of_two_boards_needs_drives_with_numbers_of_their_own() {
    let tmp = std::path::Path::new(env!("CARGO_TARGET_TMPDIR"));
    let put = |name: &str, text: &str| {
        let path = tmp.join(name);
        std::fs::write(&path, text).unwrap();
        path.display().to_string()
    };
    let table = put("two.csv", "");
    // Its spindles begin where X of the first board is.
    let shared = put(
        "shared.toml",
        "9015.X = 48\n9015.Z = 49\n9015.C = 50\n9016 = 16\n",
    );
    let server = two(vec![("9024", 0)], 1);
    let record = |further| {
        let args = ["record", "-o", &table, "--further", further, "--count", "3"];
        leadscrew(&args, &server.bus())
    };
    let told = bad(&record(&shared), 1);
    assert!(
        told.contains("node 16 is a drive of another board"),
        "{told}"
    );
    assert_eq!(std::fs::read_to_string(&table).unwrap(), "", "not begun");
    let told = bad(&record("no-such.toml"), 2);
    assert!(told.contains("cannot read `no-such.toml`"), "{told}");
    let apart = put(
        "apart.toml",
        "9015.X = 48\n9015.Z = 49\n9015.C = 50\n9016 = 64\n",
    );
    good(&record(&apart));
    let text = std::fs::read_to_string(&table).unwrap();
    assert!(text.contains(",s4_actual_urev,b2_x_nm,"), "{text}");
}
