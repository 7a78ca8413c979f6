//! Drives that stand in for missing ones: a board comes up with them, and they stand still.

extern crate std;

use std::vec::Vec;

use super::super::*;
use leadscrew_core::board::{Board, Output, State};
use leadscrew_core::params::Entry;
use leadscrew_core::spindle::EncoderSample;

/// The sample of the encoder of a spindle at rest.
const AT_REST: EncoderSample = EncoderSample {
    count: 0,
    edge_age_ns: None,
    index: None,
};

/// The state after one second of a board with the drives of X and Z of a machine, and a stand-in for each of this many
/// spindles.
fn state_with(params: &Params, spindles: usize) -> State {
    let options = PlantOptions::default();
    let axes = Axis::ALL.map(|axis| axis_drive(params, &options, axis).unwrap());
    let stand_in = |spindle: &TapSpindle| tapper(params, &options, *spindle).unwrap();
    let mut spindles: Vec<Tapper> = TapSpindle::ALL[..spindles].iter().map(stand_in).collect();
    let mut drives = Vec::from(axes);
    let mut board = Board::new(params, None, None).unwrap();
    let (mut output, mut heard) = (Output::default(), Vec::new());
    for _ in 0..1000 {
        board.tick(AT_REST, &heard, &mut output);
        heard.clear();
        for frame in &output.frames {
            for drive in &mut drives {
                if is_sync(frame) {
                    drive.sync(None, |answer| heard.push(answer));
                } else {
                    drive.receive(frame);
                }
            }
            for spindle in &mut spindles {
                if is_sync(frame) {
                    spindle.advance();
                    spindle.sync(|answer| heard.push(answer));
                } else {
                    spindle.drive().receive(frame);
                }
            }
        }
    }
    assert!(spindles.iter().all(|spindle| spindle.actual().get() == 0));
    board.ticker().state()
}

#[test]
fn a_board_comes_up_where_every_spindle_it_has_is_stood_in_for() {
    for present in 1..=4_u8 {
        let mut params = Params::sheets();
        params
            .set(Entry::find_text("9014").unwrap(), present.into())
            .unwrap();
        assert_eq!(state_with(&params, present.into()), State::Idle);
        let state = state_with(&params, usize::from(present) - 1);
        assert!(matches!(state, State::Alarm(_)), "{state:?}");
    }
}
