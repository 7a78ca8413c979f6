//! What somebody else's NMT commands, and a loss of power, are to a run.

use leadscrew::link::Link;
use leadscrew_can::BitRate;
use leadscrew_core::bus::{NmtCommand, NodeId};

use crate::server::{Options, Server};
use crate::{Run, bad, command, good, json, leadscrew, slow, tallies, text, wait_for};

/// Another master on the same bus.
fn master(server: &Server) -> Link {
    Link::open(&server.bus().parse().unwrap(), NodeId::BOARD, BitRate::M1).unwrap()
}

fn is_locked(status: &serde_json::Value) -> bool {
    status["program"] == true && status["line"].as_u64() > Some(3)
}

/// A reset of the communication takes nothing from the machine, whatever is being cut, and however often it comes: the
/// gateway asks the board before it says a word, and goes on [D196].
#[test]
fn communication_that_somebody_begins_anew_ends_no_run() {
    for program in ["examples/o0013-g76-m68x6.nc", "examples/g84-peck.nc"] {
        let simulated = json(&leadscrew(&["run", program, "--json"], "sim"));
        let server = slow();
        let run = Run::start(program, &server.bus());
        wait_for(&server.bus(), "the program runs", |status| {
            status["program"] == true
        });
        let mut other = master(&server);
        let anew = NmtCommand::ResetCommunication.frame(Some(NodeId::BOARD));
        for _ in 0..3 {
            other.send(&[anew]).unwrap();
            // Until it is operational again.
            other.hear_status().unwrap();
        }
        server.hurry();
        let output = run.end();
        let ran = json(&output);
        assert_eq!(output.status.code(), Some(0), "{ran}");
        assert_eq!(ran["setpoint_hash"], simulated["setpoint_hash"]);
        assert_eq!(tallies(&ran), tallies(&simulated));
        assert_eq!(ran["threads_missing"], 0);
        let told = text(&output.stderr);
        assert!(
            told.contains("begun the communication of node 1 anew (NMT reset communication)"),
            "{told}"
        );
        assert!(told.contains("its program goes on"), "{told}");
        assert!(!told.contains("forgotten"), "{told}");
    }
}

#[test]
fn a_node_that_somebody_resets_stops_on_its_alarm() {
    let server = slow();
    let run = Run::start("examples/shaft.nc", &server.bus());
    wait_for(&server.bus(), "the program runs", is_locked);
    let reset = NmtCommand::ResetNode.frame(Some(NodeId::BOARD));
    master(&server).send(&[reset]).unwrap();
    server.hurry();
    let output = run.end();
    let ran = json(&output);
    assert_eq!(output.status.code(), Some(4), "{ran}");
    assert_eq!(ran["alarms"][0]["no"], 4331, "{ran}");
}

#[test]
fn a_node_that_somebody_stops_is_told_with_cause_and_remedy() {
    for lang in ["en", "zh"] {
        let server = slow();
        let run = Run::of(command(
            &["run", "examples/shaft.nc", "--lang", lang],
            &server.bus(),
        ));
        wait_for(&server.bus(), "the program runs", is_locked);
        let stop = NmtCommand::Stop.frame(Some(NodeId::BOARD));
        master(&server).send(&[stop]).unwrap();
        let told = bad(&run.end(), 3);
        let cause = match lang {
            "en" => "has stopped node 1 by NMT",
            _ => "用 NMT 停止了节点 1",
        };
        for words in [cause, "4331", "000#0101", "`leadscrew reset`"] {
            assert!(told.contains(words), "{words}: {told}");
        }
        assert!(
            !told.contains("5041h") && !told.contains("05040000h"),
            "{told}"
        );
    }
}

/// It refuses then what it has never heard of: that is not what is told.
#[test]
fn a_board_whose_power_went_is_not_told_of_as_a_refusal() {
    let hole = "G98\nG0 X40 Z5 C0\nM29 S1500\nG84 C0 Z-4 R-3 F1500\nG80\nM30\n";
    let path = std::env::temp_dir().join(format!("power-{}.nc", std::process::id()));
    std::fs::write(&path, hole).unwrap();
    let path = path.to_str().unwrap();
    let server = Server::start(&Options::default());
    good(&leadscrew(&["run", path], &server.bus()));
    // The second one says how many certificates it has from the first.
    server.cut_power_at(0x5042);
    let told = bad(&leadscrew(&["run", path], &server.bus()), 3);
    assert!(
        told.contains("has started again in the middle of the program"),
        "{told}"
    );
    assert!(!told.contains("5042h"), "{told}");
    // And the next one runs.
    good(&leadscrew(&["run", path], &server.bus()));
    let _ = std::fs::remove_file(path);
}
