//! Whatever is wrong with the bus or the board has its own words, and exit code 3.

use crate::bus::{INTERFACE, ours, tool};
use crate::machine::{Board, bad, example, leadscrew};

/// `leadscrew` on another bus.
fn on(bus: &str, args: &[&str]) -> std::process::Output {
    std::process::Command::new("timeout")
        .arg("300")
        .arg(ours("leadscrew"))
        .args(args)
        .args(["--bus", bus])
        .output()
        .unwrap()
}

#[test]
fn a_bus_that_cannot_be_used_is_told_by_its_reason() {
    let program = example("g84-tap.nc");
    let program = program.to_str().unwrap();
    tool("ip", &["link", "add", "dev", "vcan6", "type", "vcan"]);
    for args in [&["status"][..], &["run", program], &["hold"], &["stop"]] {
        for (bus, said) in [
            (
                "vcan7",
                "there is no interface `vcan7`; the CAN interfaces here are",
            ),
            ("vcan6", "ip link set vcan6 up"),
            ("lo", "not one of CAN"),
            (INTERFACE, "no board answers as node 1 on"),
        ] {
            let words = bad(&on(bus, args), 3);
            assert!(words.contains(said), "{args:?} on {bus}: {words}");
            assert_eq!(words.lines().count(), 1, "{words}");
        }
    }
    tool("ip", &["link", "delete", "vcan6"]);
}

#[test]
fn another_number_and_a_number_twice_are_told() {
    let first = Board::start(&["--set", "9000=5000"]);
    let words = bad(&leadscrew(&["status", "--node", "5"]), 3);
    assert!(words.contains("no board answers as node 5"), "{words}");
    assert!(words.contains("heard there: node 1"), "{words}");
    // A drive is a node, and no board.
    let second = Board::start_on(INTERFACE, &["--set", "9000=5000"]);
    second.wait_for("node 1 on");
    let words = bad(&leadscrew(&["status"]), 3);
    assert!(words.contains("two boards answer as node 1"), "{words}");
    // Each of them has noticed as well.
    first.wait_for("alarm");
    drop(second);
}
