//! The tick that takes another parameter set over, at rest and with seven drives: what comes on top of the tick itself.

use leadscrew_core::board::{Board, Inputs, Output};
use leadscrew_core::bus::{NmtCommand, NodeId};
use leadscrew_core::params::{Entry, Params};

use super::Work;

/// The application begins anew, again and again.
pub struct BeginAnew {
    params: Params,
}

impl BeginAnew {
    /// The work.
    pub fn new() -> Self {
        let mut params = Params::sheets();
        let spindles = Entry::find_text("tap_spindles").expect("in the table");
        params.set(spindles, 4).expect("within its range");
        Self { params }
    }
}

impl Work for BeginAnew {
    type State = (Board, Output);
    type Out = ();

    fn steps(&self) -> usize {
        8
    }

    fn begin(&self) -> (Board, Output) {
        let mut board = Board::new(&self.params, None, None).expect("the built-in machine");
        board.join(NodeId::BOARD).expect("there is room on the bus");
        (board, Output::default())
    }

    fn prepare(&self, (board, _): &mut Self::State, _: usize) {
        let reset = NmtCommand::ResetNode.frame(Some(NodeId::BOARD));
        assert!(!board.receive(&reset), "it is for the board");
        board.serve();
    }

    fn step(&self, (board, _): &mut Self::State, _: usize) {
        let (mut tick, _) = board.split();
        tick.begin(&Inputs::default(), []);
    }

    fn finish(&self, (board, output): &mut Self::State, (): &()) {
        // The machine goes on coming up: nothing of the tick itself is wanted.
        let (mut tick, _) = board.split();
        tick.report(output, true);
        board.hear();
    }
}
