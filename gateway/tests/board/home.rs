//! Axes that find their reference, by `leadscrew home`, and what waits for it.

use std::process::Command;

use leadscrew::link::Link;
use leadscrew_can::BitRate;
use leadscrew_core::bus::{NodeId, Object};
use leadscrew_core::units::Axis;
use serde_json::{Value, json};

use crate::server::{Options, Server};
use crate::{Run, bad, command, good, json, leadscrew, slow, text, wait_for};

/// A method whose switch is far away: homing does not end by itself.
const FAR: u8 = 24;

/// A method that homes where the axis is.
const HERE: u8 = 37;

/// X and Z need a reference; the mark of X is at a diameter of 24.6912 mm.
fn server() -> Server {
    Server::start(&Options {
        set: vec![
            ("9024", 20_000),
            ("9050.X", 1),
            ("9050.Z", 1),
            ("9058.X", 12_345_600),
        ],
        speed: 1,
        ..Options::default()
    })
}

fn link(server: &Server) -> Link {
    let bus = server.bus().parse().unwrap();
    Link::open(&bus, NodeId::BOARD, BitRate::M1).unwrap()
}

/// Writes the homing method of X into its drive.
fn set_method(server: &Server, method: u8) {
    let object = Object::new(0x6098, 0);
    let mut link = link(server);
    link.write_of(NodeId::DRIVE_X, object, &[method]).unwrap();
}

#[test]
fn nothing_that_counts_from_the_reference_goes_before_it_is_found() {
    let server = server();
    let bus = server.bus();
    for args in [
        &["touch", "X", "--mark"][..],
        &["touch", "X", "38.42", "--tool", "1"],
    ] {
        let told = bad(&leadscrew(args, &bus), 1);
        assert!(told.contains("4503 not referenced: X"), "{args:?}: {told}");
    }
    // The board refuses the run, which ends with its reason.
    let told = bad(&leadscrew(&["run", "examples/shaft.nc"], &bus), 1);
    assert!(told.contains("4503 not referenced: X Z"), "{told}");
    // The reference comes before what a check says of the travel.
    let told = bad(&leadscrew(&["mdi", "G0 X-9000"], &bus), 1);
    assert!(told.contains("4503 not referenced: X Z"), "{told}");
    assert!(!told.contains("4258"), "{told}");
    let ran = leadscrew(&["run", "examples/shaft.nc", "--json"], &bus);
    bad(&ran, 1);
    assert_eq!(
        (&json(&ran)["ok"], &json(&ran)["exit"]),
        (&json!(false), &json!(1))
    );

    assert_eq!(
        good(&leadscrew(&["home"], &bus)),
        "X referenced at 24.6912\nZ referenced at 0\nnode 1: referenced X Z C\n"
    );
    // Each axis is told again, and one without a way to home is not.
    let again = good(&leadscrew(&["home"], &bus));
    for axis in ["X referenced at 24.6912\n", "Z referenced at 0\n"] {
        assert!(again.contains(axis), "{again}");
    }
    assert_eq!(again.lines().count(), 3, "{again}");
    // What changes offsets leaves the mode that finds the reference.
    let mode = || json(&leadscrew(&["status", "--json"], &bus))["mode"].clone();
    assert_eq!(mode(), "reference");
    let told = good(&leadscrew(&["touch", "X", "--mark"], &bus));
    assert_eq!(told, "X marked at 24.6912 (machine)\n");
    assert_eq!(mode(), "manual");
    assert_eq!(link(&server).mark(Axis::X).unwrap(), Some(246_912));
    // Homed anew, with its result as one object.
    let homed = leadscrew(&["home", "X", "--json"], &bus);
    good(&homed);
    assert_eq!(
        json(&homed),
        json!({
            "ok": true, "node": 1, "state": "idle",
            "referenced": "X Z C", "unreferenced": "", "alarm": null,
        })
    );
    assert_eq!(link(&server).mark(Axis::X).unwrap(), None);
}

fn cancelled(server: &Server, args: &[&str]) -> std::process::Output {
    let bus = server.bus();
    let home = Run::of(command(args, &bus));
    wait_for(&bus, "it homes", |status| status["state"] == "run");
    let pid = home.0.id().to_string();
    let killed = Command::new("kill").args(["-INT", &pid]).status();
    assert!(killed.unwrap().success());
    let output = home.end();
    let status = json(&leadscrew(&["status", "--json"], &bus));
    assert_eq!(status["state"], "idle");
    output
}

#[test]
fn interrupted_it_is_cancelled_and_can_be_begun_again() {
    let server = server();
    set_method(&server, FAR);
    let output = cancelled(&server, &["home"]);
    bad(&output, 130);
    assert_eq!(text(&output.stdout), "node 1: referenced C\n");
    let output = cancelled(&server, &["home", "--json"]);
    bad(&output, 130);
    let told: Value = json(&output);
    assert_eq!(
        (&told["ok"], &told["unreferenced"]),
        (&json!(false), &json!("X Z"))
    );
    set_method(&server, HERE);
    let told = good(&leadscrew(&["home"], &server.bus()));
    assert!(told.ends_with("node 1: referenced X Z C\n"), "{told}");
}

#[test]
fn what_it_does_not_do_has_a_reason() {
    let server = slow();
    let bus = server.bus();
    // No axis of this machine needs a reference.
    for args in [&["home"][..], &["home", "X"]] {
        let told = bad(&leadscrew(args, &bus), 1);
        assert!(told.contains("4528 axis X has no way to home"), "{told}");
    }
    let run = Run::start("examples/shaft.nc", &bus);
    wait_for(&bus, "the program runs", |status| status["program"] == true);
    let told = bad(&leadscrew(&["home"], &bus), 1);
    assert!(told.contains("4502 "), "{told}");
    server.hurry();
    good(&run.end());
}
