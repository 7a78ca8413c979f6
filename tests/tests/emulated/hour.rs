//! The first hour at a machine on the emulated board: as on the machine of `leadscrew up`, command by command.

use leadscrew_desk::control::Power;
use leadscrew_desk::hand::Handled as _;
use leadscrew_tests::hour::{AT, NAME, PARAMS, PATIENT, POWER, Place, repository, type_hour};

use crate::board::{Board, PATIENCE, ours, scratch};
use crate::desk::Named;

#[test]
fn the_first_hour_is_the_same_on_the_emulated_board() {
    let [x, z] = AT;
    let board = Board::start_with(&["time=real", &format!("x={x}"), &format!("z={z}")]);
    // The machine of the page: the board keeps its parameters, and its drives are fitted for it when the power comes.
    let params = repository().join(PARAMS).display().to_string();
    board.good(&["params", "push", &params]);
    board.good(&[&["params", "set"], &PATIENT[..]].concat());
    let folder = scratch("hour");
    let sockets = scratch("hour-sockets");
    for folder in [&folder, &sockets] {
        std::fs::create_dir_all(folder).expect("a folder");
    }
    let mut machine = Named::new(&board, NAME, &sockets);
    machine.power(Power::Cycle).expect("it comes");
    let machine = std::thread::spawn(|| machine.run());
    let place = Place {
        folder,
        sockets,
        program: ours(),
        patience: PATIENCE,
    };
    type_hour(&place, &[POWER], &[]);
    // `down` has ended it.
    machine.join().expect("the machine");
}
