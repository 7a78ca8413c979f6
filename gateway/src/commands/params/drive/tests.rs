//! Against the drives of a board inside this process.

use std::time::Duration;

use leadscrew_board_sim::plant::Flash;
use leadscrew_core::alarm::Lang;
use leadscrew_core::board::DriveNodes;
use leadscrew_core::bus::{
    Abort, CobId, Frame, Mapped, NmtCommand, NodeId, Object, Service, Setpoints,
};
use leadscrew_core::params::{Entry, Params};

use super::{Found, Pending, apply, check_setpoints, pending, read, with_drives};
use crate::commands::params::pdo::Pdo;
use crate::failure::{Failure, Outcome};
use crate::link::bench::{self, Fate, between, link, machine, machine_of};
use crate::link::{Inside, Link, Trouble};
use crate::params::drives::{Drive, DriveName, Kind, Setting, Wanted};
use crate::params::load_text;

const VELOCITY: Object = Object::new(0x607F, 0);
const X: Drive = Drive {
    name: DriveName::X,
    node: NodeId::DRIVE_X,
};
/// Of the first RPDO.
const COB_ID: Object = Object::new(0x1400, 1);

fn board() -> Inside {
    machine(Flash::erased())
}

/// On this end of the bus the drive of X does not do what is written to it `at` (command, index, sub-index, as SDO has it):
/// it `says` so, or nothing at all.
fn wayward(inside: &Inside, at: [u8; 4], says: bool) -> Link {
    bench::wayward(inside, X.node, move |request| request == at, says)
}

/// The limit of X's velocity is to be another one.
fn velocity(value: i64) -> Vec<Pending> {
    vec![Pending {
        drive: X,
        wanted: Wanted::Number {
            object: VELOCITY,
            kind: Kind::U32,
            value,
        },
        off: false,
        found: Found::Number(10_000_000),
    }]
}

fn number(link: &mut Link, object: Object) -> u32 {
    let bytes = link.read_of(X.node, object).unwrap();
    let mut raw = [0; 4];
    raw[..bytes.len()].copy_from_slice(&bytes);
    u32::from_le_bytes(raw)
}

#[track_caller]
fn ends_with(failure: Failure, end: &str) {
    let (Failure::WrongBecause(words) | Failure::Bus(words)) = failure else {
        panic!("{failure:?}");
    };
    assert!(words.en.ends_with(end), "{}", words.en);
}

#[test]
fn a_drive_that_falls_silent_when_it_is_to_keep_its_values_is_told_of_and_started() {
    let inside = board();
    let pending = velocity(500_000);
    let mut failing = wayward(&inside, [0x23, 0x10, 0x10, 1], false);
    let failure = apply(&mut failing, &pending, &mut || ()).unwrap_err();
    assert!(matches!(failure, Failure::Bus(_)));
    ends_with(failure, "and the board's set has not been changed");
    let mut link = link(&inside);
    assert_eq!(number(&mut link, VELOCITY), 500_000);
    // In pre-operational it would take this.
    let period = Object::new(0x60C2, 1);
    let written = link.write_of(X.node, period, &[1]);
    assert!(written.is_err_and(|trouble| trouble.is_abort(Abort::State)));
}

#[test]
fn drives_keep_their_new_values_where_it_is_open_which_set_the_board_has() {
    let inside = board();
    let mut link = link(&inside);
    let pending = velocity(500_000);
    apply(&mut link, &pending, &mut || ()).unwrap();
    let node = NodeId::BOARD.get();
    let aborted = Trouble::Transfer {
        node,
        object: Object::new(0x1020, 1),
        write: false,
        error: leadscrew_core::bus::SdoError::Refused(Abort::Internal.code()),
    };
    for (trouble, end) in [
        (
            Trouble::Unsettled {
                node,
                restarted: true,
            },
            "the drives have their new values",
        ),
        (
            aborted,
            "whether the board has the new set is not known: push again",
        ),
    ] {
        let failure = with_drives(&mut link, &pending, trouble, false);
        assert!(matches!(failure, Failure::Bus(_)), "{failure:?}");
        ends_with(failure, end);
        assert_eq!(number(&mut link, VELOCITY), 500_000);
    }
    let refusal = Trouble::Parameters { node, reason: None };
    let failure = with_drives(&mut link, &pending, refusal, false);
    ends_with(failure, "the drives have their old values again");
    assert_eq!(number(&mut link, VELOCITY), 10_000_000);
}

#[test]
fn a_drive_is_asked_where_the_set_says_that_it_is() {
    let mut params = Params::slant_bed();
    let entry = Entry::find_text("drive_node.X").unwrap();
    params.set(entry, 70).unwrap();
    let inside = machine_of(&params, Flash::erased());
    let mut link = link(&inside);
    link.set_patience(Duration::from_millis(50));
    let pending = velocity(500_000);
    let Pending { wanted, found, .. } = &pending[0];
    let there = DriveName::X.among(&DriveNodes::of(&params));
    assert_eq!(there.node.get(), 70);
    assert_eq!(read(&mut link, there, wanted).unwrap(), *found);
    let Err(Failure::Bus(words)) = read(&mut link, X, wanted) else {
        panic!("nobody is at 16");
    };
    assert!(
        words.en.starts_with("drive X (node 16): reading"),
        "{}",
        words.en
    );
}

#[test]
fn a_pdo_has_its_type_before_it_is_switched_on() {
    let inside = board();
    let (told, writes) = std::sync::mpsc::channel();
    let mut link = between(
        &inside,
        move |frame| {
            // What begins to write, as CiA 301 has it: the command, the object.
            if let [0x20..=0x3F, low, high, sub, ..] = *frame.payload()
                && frame.id() == CobId::of(Service::SdoRequest, X.node)
            {
                told.send((u16::from_le_bytes([low, high]), sub)).unwrap();
            }
            Fate::Arrives
        },
        |frame| frame,
    );
    // As a profile has them.
    let wanted = [(1, Kind::U32, 0x190), (2, Kind::U8, 2)];
    let pending: Vec<Pending> = wanted
        .into_iter()
        .map(|(sub, kind, value)| Pending {
            drive: X,
            wanted: Wanted::Number {
                object: Object::new(0x1800, sub),
                kind,
                value,
            },
            off: false,
            found: Found::Number(0),
        })
        .collect();
    apply(&mut link, &pending, &mut || ()).unwrap();
    // Its type, then off and on, then all is kept.
    let expected = [(0x1800, 2), (0x1800, 1), (0x1800, 1), (0x1010, 1)];
    assert_eq!(writes.try_iter().collect::<Vec<_>>(), expected);
}

/// What the sections have to say for a board of number 1 whose drives get their setpoints in one frame.
fn together(drive: DriveName) -> [Wanted; 2] {
    let mapping = Wanted::Mapping {
        mapping: 0x1600,
        communication: 0x1400,
        objects: Setpoints::mapping(drive as usize).collect(),
    };
    let id = Wanted::Number {
        object: COB_ID,
        kind: Kind::U32,
        value: 0x481,
    };
    [id, mapping]
}

#[test]
fn setpoints_in_one_frame_want_every_drive_at_its_place() {
    let old = Params::slant_bed();
    let mut new = old.clone();
    for (key, value) in [("9031", 1), ("9014", 1)] {
        new.set(Entry::find_text(key).unwrap(), value).unwrap();
    }
    let mut link = link(&board());
    let words = |result: Outcome| match result {
        Err(Failure::WrongBecause(words)) => words.en,
        other => panic!("{other:?}"),
    };
    // As delivered they have a frame each.
    let told = words(check_setpoints(&mut link, &[], &old, &new));
    assert!(
        told.starts_with("drive X takes its setpoints from 210h with 6040h/16 607Ah/32, and the board would send them (9031) with 481h"),
        "{told}"
    );
    assert!(
        told.contains(
            "`rpdo1_cob_id = 0x481` and `rpdo1 = [\"6040/16\", \"607A/32\"]` in `[drive.X]`"
        ),
        "{told}"
    );
    assert!(check_setpoints(&mut link, &[], &old, &old).is_ok());

    let drives = [DriveName::X, DriveName::Z, DriveName::C, DriveName::S1];
    let nodes = DriveNodes::of(&new);
    let mut pending = Vec::new();
    for name in drives {
        for wanted in together(name) {
            let drive = name.among(&nodes);
            let found = read(&mut link, drive, &wanted).unwrap();
            pending.push(Pending {
                drive,
                wanted,
                off: false,
                found,
            });
        }
    }
    // All but the last mapping: it would listen at the place of X.
    let last = pending.pop().unwrap();
    apply(&mut link, &pending, &mut || ()).unwrap();
    let told = words(check_setpoints(&mut link, &[], &old, &new));
    assert!(
        told.starts_with("drive S1 takes its setpoints from 481h with 6040h/16"),
        "{told}"
    );
    apply(&mut link, &[last], &mut || ()).unwrap();
    assert!(check_setpoints(&mut link, &[], &old, &new).is_ok());
    // A set that has X where Z is, with nothing else that is new.
    let mut exchanged = new.clone();
    for (key, value) in [("9015.X", 17), ("9015.Z", 16)] {
        let entry = Entry::find_text(key).unwrap();
        exchanged.set(entry, value).unwrap();
    }
    let told = words(check_setpoints(&mut link, &[], &new, &exchanged));
    assert!(
        told.starts_with("drive X takes its setpoints from 481h with 0007h/32 0006h/16"),
        "{told}"
    );
    // And none of them in a frame of its own any more.
    let told = words(check_setpoints(&mut link, &[], &new, &old));
    assert!(
        told.contains("the board would send them (9031) with 210h"),
        "{told}"
    );
}

/// X's first RPDO is to have something else in it, which the simulated drive does not take.
fn mapping(link: &mut Link) -> Vec<Pending> {
    let drive = X;
    let objects = vec![Mapped::new(0x6040, 0, 16), Mapped::new(0x6060, 0, 8)];
    let wanted = Wanted::Mapping {
        mapping: 0x1600,
        communication: 0x1400,
        objects,
    };
    let found = read(link, drive, &wanted).unwrap();
    vec![Pending {
        drive,
        wanted,
        off: false,
        found,
    }]
}

/// X has its first RPDO as `pending` found it, and the message says so.
#[track_caller]
fn is_back(inside: &Inside, pending: &[Pending], failure: Failure) {
    assert!(matches!(failure, Failure::WrongBecause(_)), "{failure:?}");
    ends_with(
        failure,
        "; what was written before it has its old value again, and nothing of the board's set has been changed",
    );
    let mut link = link(inside);
    for pending in pending {
        let found = read(&mut link, pending.drive, &pending.wanted).unwrap();
        assert_eq!(found, pending.found);
    }
}

#[test]
fn a_pdo_whose_mapping_is_fixed_stays_on() {
    let inside = board();
    let pending = mapping(&mut link(&inside));
    let mut fixed = wayward(&inside, [0x2F, 0x00, 0x16, 0], true);
    let failure = apply(&mut fixed, &pending, &mut || ()).unwrap_err();
    assert_eq!(number(&mut link(&inside), COB_ID), 0x210, "on");
    is_back(&inside, &pending, failure);
}

#[test]
fn a_pdo_gets_its_old_mapping_back_and_is_on_or_off_as_it_was() {
    for id in [0x210, 0x8000_0210_u32] {
        let inside = board();
        let mut link = link(&inside);
        let node = X.node;
        link.send(&[NmtCommand::PreOperational.frame(Some(node))])
            .unwrap();
        link.write_of(node, COB_ID, &id.to_le_bytes()).unwrap();
        let pending = mapping(&mut link);
        // The second object is refused, when the mapping is empty already.
        let failure = apply(&mut link, &pending, &mut || ()).unwrap_err();
        assert_eq!(number(&mut link, COB_ID), id);
        is_back(&inside, &pending, failure);
    }
}

const OFF: u32 = 0x8000_0210;

/// A board whose drive X takes its setpoints from the second place of a frame, and has that PDO off.
fn at_another_place_and_off() -> Inside {
    let inside = board();
    let mut link = link(&inside);
    link.send(&[NmtCommand::PreOperational.frame(Some(X.node))])
        .unwrap();
    let pdo = Pdo {
        node: X.node,
        mapping: 0x1600,
        communication: 0x1400,
    };
    let second: Vec<Mapped> = Setpoints::mapping(1).collect();
    pdo.map(&mut link, &second, OFF, OFF).unwrap();
    inside
}

/// Of a machine file that gives X the mapping of its first RPDO, and `more`.
fn sections(more: &str) -> Vec<Setting> {
    let text = format!("[drive.X]\nrpdo1 = [\"6040/16\", \"607A/32\"]\n{more}\n");
    load_text("machine.toml", &text, Lang::En).drives
}

#[test]
fn a_mapping_switches_its_pdo_on_where_its_section_does_not_say_off() {
    let nodes = DriveNodes::of(&Params::slant_bed());
    for (more, then) in [
        ("", 0x210),
        ("rpdo1_cob_id = 0x210", 0x210),
        ("rpdo1_cob_id = 0x8000_0210", OFF),
    ] {
        let mut link = link(&at_another_place_and_off());
        let settings = sections(more);
        let differ = pending(&mut link, &settings, &nodes).unwrap();
        apply(&mut link, &differ, &mut || ()).unwrap();
        assert_eq!(number(&mut link, COB_ID), then, "{more}");
        let differ = pending(&mut link, &settings, &nodes).unwrap();
        assert!(differ.is_empty(), "{more}: {differ:?}");
    }
}

#[test]
fn a_pdo_that_does_not_go_on_is_told() {
    let inside = at_another_place_and_off();
    // The drive says yes to its COB-ID, and leaves it as it is.
    let request = CobId::of(Service::SdoRequest, X.node);
    let deaf = move |frame: &Frame| match *frame.payload() {
        [0x23, 0x00, 0x14, 1, ..] if frame.id() == request => {
            let yes = [0x60, 0x00, 0x14, 1, 0, 0, 0, 0];
            Fate::Lost(Frame::new(CobId::of(Service::SdoReply, X.node), &yes))
        }
        _ => Fate::Arrives,
    };
    let mut link = between(&inside, deaf, |frame| frame);
    let nodes = DriveNodes::of(&Params::slant_bed());
    let differ = pending(&mut link, &sections(""), &nodes).unwrap();
    let failure = apply(&mut link, &differ, &mut || ()).unwrap_err();
    let words = format!("{failure:?}");
    assert!(words.contains("reads back otherwise"), "{words}");
    is_back(&inside, &differ, failure);
}
