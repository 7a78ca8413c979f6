//! What a program has written is kept when it has ended, on a board in this process.

use std::time::Duration;

use clap::Parser as _;
use leadscrew_board_sim::plant::Flash;
use leadscrew_core::bus::{BoardCommand, BoardState, Frame, Order};
use leadscrew_core::offsets::{Offsets, Revision};

use super::super::Greeted;
use super::*;
use crate::cli::Cli;
use crate::link::bench::{self, Fate};

/// Runs a program that writes a work offset and a variable. What happens `behind` its end, before anything is kept, another
/// client does. Gives the revision that it was kept under, or why it was not, and the table of the board.
fn runs(variables: &str, behind: fn(&mut Link)) -> (Result<Option<Revision>, String>, Offsets) {
    let typed = [
        "leadscrew",
        "run",
        "g10.nc",
        "--bus",
        "sim:desk",
        "--variables",
        variables,
    ];
    let global = Cli::try_parse_from(typed).unwrap().global;
    let source = SourceFile::text("g10.nc", "#500 = 1\nG10 L2 P2 X4\nM30\n".to_owned());
    let inside = bench::machine(Flash::erased());
    let mut other = bench::link(&inside);
    other.hear_status().unwrap();
    while other.status().unwrap().state == BoardState::Starting {
        other.idle(Duration::from_millis(5)).unwrap();
    }
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
