//! Against a block as delivered, and a board inside this process.

use leadscrew_board_sim::plant::{BlockOptions, Flash, PlantOptions};
use leadscrew_core::params::Entry;

use super::*;
use crate::link::Inside;
use crate::link::bench::{self, link, machine, machine_with};

const NODE: u8 = 5;

/// A board whose set names a block that is as delivered.
fn board() -> (Params, Inside) {
    let mut params = Params::slant_bed();
    for (key, value) in [("9461", i32::from(NODE)), ("9463", 1)] {
        let entry = Entry::find_text(key).unwrap();
        params.set(entry, value.into()).unwrap();
    }
    let options = PlantOptions {
        block: BlockOptions {
            fresh: true,
            ..BlockOptions::default()
        },
        ..PlantOptions::default()
    };
    let inside = machine_with(&params, &options, Flash::erased());
    (params, inside)
}

/// On this end of the bus the block does not take what is written to it `at` (index, sub-index): it `says` so, or nothing.
fn wayward(inside: &Inside, at: (u16, u8), says: bool) -> Link {
    let node = NodeId::new(NODE).unwrap();
    let is_meant = move |[command, low, high, sub]: [u8; 4]| {
        (0x20..=0x3F).contains(&command) && (u16::from_le_bytes([low, high]), sub) == at
    };
    bench::wayward(inside, node, is_meant, says)
}

/// What is not as wanted, in words.
fn changes(link: &mut Link, params: &Params) -> Vec<(String, String)> {
    let pending = pending(link, params).unwrap().into_iter();
    let change = |pending: Pending| pending.change();
    let words = pending
        .map(change)
        .map(|change| (change.object, change.old));
    words.collect()
}

#[track_caller]
fn words(failure: Failure) -> String {
    let (Failure::WrongBecause(words) | Failure::Bus(words)) = failure else {
        panic!("{failure:?}");
    };
    words.en
}

#[test]
fn a_block_that_refuses_half_way_has_its_old_values_again() {
    for says in [true, false] {
        let (params, inside) = board();
        let before = changes(&mut link(&inside), &params);
        assert!(before.len() > 3, "{before:?}");
        let mut failing = wayward(&inside, (0x6207, 1), says);
        let pending = pending(&mut failing, &params).unwrap();
        let failure = apply(&mut failing, &pending).unwrap_err();
        assert_eq!(matches!(failure, Failure::Bus(_)), !says);
        let told = words(failure);
        assert!(
            told.ends_with("; what was written to it before has its old value again, and the board's set is in force"),
            "{told}"
        );
        assert_eq!(changes(&mut link(&inside), &params), before);
        // Nothing is in the way of the next push.
        let mut link = link(&inside);
        apply(&mut link, &pending).unwrap();
        assert_eq!(changes(&mut link, &params), []);
    }
}

#[test]
fn what_a_block_does_not_take_back_is_named() {
    let (params, inside) = board();
    let pending = pending(&mut link(&inside), &params).unwrap();
    let first = pending.first().unwrap();
    // As if it had been another number before, which it refuses.
    let mut old = first.clone();
    old.object = Object::new(0x1800, 2);
    old.kind = Kind::U8;
    old.found = 1;
    let lost = undo(&mut link(&inside), first.node, &[Old::Number(old)]);
    assert_eq!(lost, ["1800h:02h tpdo1_transmission"]);
    let told = words(with(Failure::Bus(both!("a", "甲")), &lost));
    assert_eq!(
        told,
        "a; these did not take their old value back: 1800h:02h tpdo1_transmission. The board's set is in force"
    );
}

/// The simulated block has a fixed mapping; a drive has none, and does not take a mode in its setpoints.
#[test]
fn a_mapping_that_is_refused_half_way_is_the_old_one_again() {
    let inside = machine(Flash::erased());
    let mut link = link(&inside);
    let pdo = Pdo {
        node: NodeId::DRIVE_X,
        mapping: 0x1600,
        communication: 0x1400,
    };
    let before = pdo.found(&mut link).unwrap();
    let entries = [(1, 0x6040_0010_u32), (2, 0x6060_0008)];
    let mut pending: Vec<Pending> = entries
        .into_iter()
        .map(|(sub, wanted)| Pending {
            node: pdo.node,
            object: pdo.entry(sub),
            kind: Kind::U32,
            found: 0,
            wanted: wanted.into(),
        })
        .collect();
    let told = words(apply(&mut link, &pending).unwrap_err());
    assert!(told.contains("has its old value again"), "{told}");
    assert_eq!(pdo.found(&mut link).unwrap(), before);
    // One that it takes: with its number, and on.
    pending[1].wanted = 0x607A_0020;
    apply(&mut link, &pending).unwrap();
    assert_eq!(pdo.found(&mut link).unwrap(), before);
}
