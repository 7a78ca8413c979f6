//! Programs on a board in this process: what others do meanwhile, and what is kept when they have ended.

use std::sync::{Arc, Mutex};
use std::time::Duration;

use clap::Parser as _;
use leadscrew_board_sim::plant::Flash;
use leadscrew_core::bus::{BoardCommand, BoardState, Frame, Object, Order};
use leadscrew_core::offsets::{Offsets, Revision};

use super::super::Greeted;
use super::*;
use crate::cli::Cli;
use crate::link::Inside;
use crate::link::bench::{self, Fate};

/// A board that has started, and a client of it.
fn machine() -> (Inside, Link) {
    let inside = bench::machine(Flash::erased());
    let mut other = bench::link(&inside);
    other.hear_status().unwrap();
    wait_for_start(&mut other);
    (inside, other)
}

fn wait_for_start(other: &mut Link) {
    while other.status().unwrap().state == BoardState::Starting {
        other.idle(Duration::from_millis(5)).unwrap();
    }
}

/// Another set is in force, and the drives are on with it.
fn other_parameters(other: &mut Link) {
    let before = other.parameters_identity().unwrap();
    other.write(Object::new(0x2000 + 9007, 0), &[13]).unwrap();
    while other.parameters_identity().unwrap() == before {
        other.idle(Duration::from_millis(5)).unwrap();
    }
    wait_for_start(other);
}

/// The options of a run that is typed like this.
fn global(more: &[&str]) -> Global {
    let typed = ["leadscrew", "run", "part.nc", "--bus", "sim:desk"];
    let typed = typed.iter().chain(more);
    Cli::try_parse_from(typed).unwrap().global
}

/// Runs a program by this link. Behind its check another client acts.
fn does(text: &str, own: Link, behind_check: impl FnOnce()) -> Result<(), String> {
    let global = global(&[]);
    let source = SourceFile::text("part.nc", text.to_owned());
    let (mut own, mut behind_check) = (Some(own), Some(behind_check));
    let done = perform_on(
        &global,
        &source,
        &Run::default(),
        Work::Program,
        &mut |_| Greeted::on(own.take().unwrap())?.read(),
        &mut |_, _| {
            behind_check.take().unwrap()();
            Ok(())
        },
    );
    let told = done.and_then(|done| done.verdict);
    told.map_err(|failure| failure.words().unwrap_or_default().en)
}

#[test]
fn a_program_that_was_checked_for_other_parameters_does_not_begin() {
    let (inside, mut other) = machine();
    let own = bench::link(&inside);
    let told = does("G0 X4 Z5\nM30\n", own, || other_parameters(&mut other));
    let why = told.unwrap_err();
    assert!(
        why.contains("have changed since this program was checked"),
        "{why}"
    );
    assert_eq!(other.status().unwrap().program, 0);
    let own = bench::link(&inside);
    assert_eq!(does("G0 X4 Z5\nM30\n", own, || {}), Ok(()));
}

/// It is checked once more when all of it is on the board: somebody may have changed them while it was sent.
#[test]
fn a_program_that_was_sent_for_other_parameters_does_not_begin() {
    let (inside, mut other) = machine();
    let (shared, mut acts) = (inside.clone(), true);
    let fate = move |frame: &Frame| {
        // The calls are written to 5020h:01h.
        if acts && let [0x21 | 0xC2 | 0xC6, 0x20, 0x50, 1, ..] = frame.payload() {
            acts = false;
            other_parameters(&mut bench::link(&shared));
        }
        Fate::Arrives
    };
    let own = bench::between(&inside, fate, |frame| frame);
    let before = other.status().unwrap().position;
    let why = does("G0 X4 Z5\nM30\n", own, || {}).unwrap_err();
    assert!(
        why.contains("have changed since this program was checked"),
        "{why}"
    );
    assert_eq!(other.status().unwrap().position, before);
}

/// A stroke that lasts longer than anybody waits goes on to its end.
#[test]
fn a_machine_that_has_not_come_to_rest_is_not_reset() {
    let (inside, _) = machine();
    let seen = Arc::new(Mutex::new(None));
    let (shared, told, mut begun) = (inside.clone(), Arc::clone(&seen), false);
    let fate = move |frame: &Frame| {
        let order = BoardCommand::decode(frame).and_then(|(_, told)| told.order);
        begun |= order == Some(Order::Run);
        // Something is asked again when the order is confirmed.
        let asks = begun && order.is_none() && matches!(frame.payload(), [_, _, 0x50, ..]);
        let mut told = told.lock().unwrap();
        if !asks || told.is_some() {
            return Fate::Arrives;
        }
        let mut other = bench::link(&shared);
        if other.status().unwrap().state != BoardState::Run {
            return Fate::Arrives;
        }
        other.hear_status().unwrap();
        let stands = work::bring_to_rest(&mut other, Duration::ZERO).unwrap();
        let state = loop {
            let state = other.status().unwrap().state;
            if matches!(state, BoardState::Hold | BoardState::Idle) {
                break state;
            }
            other.idle(Duration::from_millis(5)).unwrap();
        };
        *told = Some((stands, state));
        // The run has its end by somebody else's reset.
        other.order(Order::Reset).unwrap();
        Fate::Arrives
    };
    let own = bench::between(&inside, fate, |frame| frame);
    let why = does("G98 G1 X4 Z-5 F60\nM30\n", own, || {}).unwrap_err();
    assert!(why.contains("reset by somebody else"), "{why}");
    assert_eq!(*seen.lock().unwrap(), Some((false, BoardState::Hold)));
}

/// Runs a program that writes a work offset and a variable. What happens `behind` its end, before anything is kept, another
/// client does. Gives the revision that it was kept under, or why it was not, and the table of the board.
fn runs(variables: &str, behind: fn(&mut Link)) -> (Result<Option<Revision>, String>, Offsets) {
    let global = global(&["--variables", variables]);
    let source = SourceFile::text("g10.nc", "#500 = 1\nG10 L2 P2 X4\nM30\n".to_owned());
    let (inside, mut other) = machine();
    let (shared, mut begun, mut acts) = (inside.clone(), false, Some(behind));
    let fate = move |frame: &Frame| {
        let order = BoardCommand::decode(frame).and_then(|(_, told)| told.order);
        begun |= order == Some(Order::Run);
        // The certificates (5041h) are read when it has ended.
        if begun && matches!(frame.payload(), [_, 0x41, 0x50, ..]) {
            let mut other = bench::link(&shared);
            if !other.status().unwrap().in_program
                && let Some(act) = acts.take()
            {
                act(&mut other);
            }
        }
        Fate::Arrives
    };
    let mut own = Some(bench::between(&inside, fate, |frame| frame));
    let done = perform_on(
        &global,
        &source,
        &Run::default(),
        Work::Program,
        &mut |_| Greeted::on(own.take().unwrap())?.read(),
        &mut |_, _| Ok(()),
    );
    let done = done.and_then(|done| done.kept.map(|()| done.ran.revision));
    let told = done.map_err(|failure| failure.words().unwrap().en);
    (told, other.offsets().unwrap().table)
}

fn other_table(other: &mut Link) {
    let mut table = Offsets::default();
    table.tools[0].tip = 3;
    let last = other.offsets_revision().unwrap();
    other.commit_offsets(&table, last).unwrap();
}

#[test]
fn a_change_of_somebody_else_behind_the_end_is_not_overwritten() {
    let folder = std::env::temp_dir().join(format!("ls-kept-{}", std::process::id()));
    let file = folder.join("leadscrew.variables");
    let file = file.to_str().unwrap();
    let (told, table) = runs(file, |_| {});
    assert_eq!((told, table.revision), (Ok(Some(Revision(1))), Revision(1)));
    let written = table;
    std::fs::remove_file(file).unwrap();
    let (told, table) = runs(file, other_table);
    let why = told.unwrap_err();
    assert!(why.contains("4581 "), "{why}");
    assert_eq!(
        (table.revision, table.work),
        (Revision(1), Offsets::default().work)
    );
    assert_ne!(table.work, written.work);
    // The variables are kept all the same.
    assert!(std::fs::read_to_string(file).unwrap().contains("#500 = 1"));
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn variables_that_cannot_be_written_lose_no_offset() {
    let (told, table) = runs("/proc/leadscrew-nowhere/leadscrew.variables", |_| {});
    let why = told.unwrap_err();
    assert!(why.contains("leadscrew-nowhere"), "{why}");
    assert_eq!(table.revision, Revision(1));
    assert_ne!(table.work, Offsets::default().work);
}
