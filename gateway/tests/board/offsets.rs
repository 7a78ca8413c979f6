//! Offsets and tools on a board: changed by any console, never under a program, and touched off from where it stands.

use leadscrew::link::{Link, Trouble};
use leadscrew_can::BitRate;
use leadscrew_core::alarm::{Arg, Code};
use leadscrew_core::bus::NodeId;

use crate::server::{Options, Server};
use crate::{Run, bad, good, leadscrew, slow, wait_for};

fn file(name: &str, text: &str) -> String {
    let path = std::env::temp_dir().join(format!("leadscrew-{}-{name}", std::process::id()));
    std::fs::write(&path, text).unwrap();
    path.to_str().unwrap().to_owned()
}

#[test]
fn a_tool_is_touched_off_where_it_was_marked() {
    let server = Server::start(&Options::default());
    let bus = server.bus();
    let go = |name: &str, text: &str| {
        let program = file(name, text);
        good(&leadscrew(&["run", &program], &bus));
    };
    go("cut.nc", "G0 X50 Z10\nM30\n");
    let told = good(&leadscrew(&["touch", "X", "--mark"], &bus));
    assert_eq!(told, "X marked at 50.0000 (machine)\n");
    // Moved off and measured.
    go("off.nc", "G0 X80 Z20\nM30\n");
    assert_eq!(
        good(&leadscrew(&["touch", "X", "38.42", "--tool", "1"], &bus)),
        "T1.X = 11.5800: X 38.4200 of the work is at 50.0000 of the machine\n\
         T1.X         0 → 11.58\n\
         T1.measured  - → X\n\
         stored and in force, revision 1\n"
    );
    // The mark is taken: the next one counts from where the axis stands.
    assert_eq!(
        good(&leadscrew(&["touch", "X", "38.42", "--tool", "2"], &bus)),
        "T2.X = 41.5800: X 38.4200 of the work is at 80.0000 of the machine\n\
         T2.X         0 → 41.58\n\
         T2.measured  - → X\n\
         stored and in force, revision 2\n"
    );
    // The program goes where the table says.
    go("tool.nc", "T0101\nG0 X30 Z20\nM30\n");
    let told = good(&leadscrew(&["touch", "X", "30", "--tool", "1"], &bus));
    assert!(
        told.contains("T1.X = 11.5800: X 30.0000 of the work is at 41.5800"),
        "{told}"
    );
    // The parameters of old have no effect any more, and that is said.
    let output = leadscrew(&["params", "set", "9101.X=5"], &bus);
    let told = String::from_utf8(output.stderr.clone()).unwrap();
    good(&output);
    assert!(told.contains("have no effect"), "{told}");
}

#[test]
fn nothing_is_written_under_a_program_or_a_hold() {
    let server = slow();
    let bus = server.bus();
    good(&leadscrew(&["tools", "set", "T1.radius=0.4"], &bus));
    let run = Run::start("examples/shaft.nc", &bus);
    wait_for(&bus, "the program runs", |status| status["program"] == true);
    let refuses = || {
        for args in [
            &["tools", "set", "T1.radius=0.8"][..],
            &["offsets", "set", "G54.Z=1"],
            &["touch", "Z", "0", "--tool", "1"],
            &["touch", "Z", "--mark"],
        ] {
            let told = bad(&leadscrew(args, &bus), 1);
            assert!(told.contains("4580 "), "{args:?}: {told}");
        }
    };
    refuses();
    good(&leadscrew(&["hold"], &bus));
    server.hurry();
    wait_for(&bus, "the machine is held", |status| {
        status["state"] == "hold"
    });
    refuses();
    good(&leadscrew(&["resume"], &bus));
    good(&run.end());
    good(&leadscrew(&["tools", "set", "T1.radius=0.8"], &bus));
}

#[test]
fn of_two_consoles_the_one_that_has_not_seen_the_change_is_refused() {
    let server = Server::start(&Options::default());
    let open = || {
        let bus = server.bus().parse().unwrap();
        Link::open(&bus, NodeId::BOARD, BitRate::M1).unwrap()
    };
    let (mut first, mut second) = (open(), open());
    let [old, same] = [&mut first, &mut second].map(|link| link.offsets().unwrap());
    assert_eq!(old, same);
    assert_eq!((old.resolving(), old.last.0), (Ok(None), 0));
    let mut table = old.table;
    table.tools[0].tip = 3;
    let revision = second.commit_offsets(&table, same.last).unwrap();
    assert_eq!(revision.0, 1);
    let refused = first.commit_offsets(&old.table, old.last);
    let Err(Trouble::Offsets {
        reason: Some(alarm),
        ..
    }) = refused
    else {
        panic!("{refused:?}");
    };
    assert_eq!(alarm.code, Code::OffsetsOtherRevision);
    assert_eq!(alarm.args[..2], [Arg::Int(0), Arg::Int(1)]);
    let now = first.offsets().unwrap();
    assert_eq!((now.table.tools, now.last.0), (table.tools, 1));
}

/// Both hear the board's answers to both.
#[test]
fn of_two_consoles_that_write_at_once_the_one_whose_table_is_lost_is_told() {
    const ROUNDS: u8 = 8;
    let server = Server::start(&Options::default());
    let open = || {
        let bus = server.bus().parse().unwrap();
        Link::open(&bus, NodeId::BOARD, BitRate::M1).unwrap()
    };
    let mut links = [open(), open()];
    let mut stored = 0;
    for round in 1..=ROUNDS {
        let old = links[0].offsets().unwrap();
        let [one, other] = &mut links;
        let writes = |link: &mut Link, tool: usize| {
            let mut table = old.table;
            table.tools[tool].tip = round;
            link.commit_offsets(&table, old.last)
        };
        let written = std::thread::scope(|scope| {
            let one = scope.spawn(|| writes(one, 0));
            [writes(other, 1), one.join().unwrap()]
        });
        let now = links[0].offsets().unwrap().table;
        for (written, tool) in written.iter().rev().zip(&now.tools) {
            assert_eq!(written.is_ok(), tool.tip == round, "{written:?}");
        }
        assert!(!written.iter().all(Result::is_ok), "{written:?}");
        stored += written.iter().filter(|written| written.is_ok()).count();
    }
    assert!(stored > 0);
}

#[test]
fn a_table_that_cannot_be_stored_is_told() {
    let server = Server::start(&Options {
        flash_fails: true,
        ..Options::default()
    });
    let told = bad(
        &leadscrew(&["offsets", "set", "G54.Z=-400"], &server.bus()),
        1,
    );
    assert!(
        told.contains("4584 ") && told.contains("nothing has been changed"),
        "{told}"
    );
    let list = good(&leadscrew(&["offsets", "get", "G54"], &server.bus()));
    assert_eq!(list, "G54.X = 0\nG54.Z = 0\n");
}
