//! What an operator orders of the board, and what a tick asks of the switches, as data.

use super::machine::{BlockInputs, BlockLoss};
use super::trouble::BusTrouble;
use crate::alarm::Code;
use crate::call::Aux;
use crate::units::{Axes, Length};

/// What a tick asks of the board's switches. This is part of the tick's output, because the next move may depend on it and
/// the queue of [`Event`](crate::tick::Event)s may be full [D191].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Switching {
    /// Nothing.
    #[default]
    Nothing,
    /// A machine function is switched.
    Function(Aux),
    /// The functions that programs have switched are forgotten: a reset is done, or the application starts again.
    Reset,
    /// As `Reset`, with a tap in its hole: the clamp of the work piece stays on, and nothing waits for a function any more.
    ResetInHole,
}

/// An operator's command. It acts in the next tick and never waits for a transfer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Command {
    /// Feed hold.
    Hold,
    /// Continue after feed hold or single block. A program that was left stays where it is.
    Resume,
    /// Leave the program that is held, so that its axes can be moved by hand.
    Leave,
    /// Go on with the program that was left, at the point where it was.
    Return,
    /// Stop, empty the queue, clear an alarm.
    Reset,
    /// Emergency stop: both axes of a synchronised move decelerate together [D18]. The queue is emptied, and the alarm
    /// stays until reset.
    Stop,
    /// A stop like [`Stop`](Self::Stop) with another alarm, from the supervision of the board.
    Halt(Code),
    /// A stop for a trouble of the bus. Drives that cannot be reached are told to let go, so that nothing pulls them when
    /// they can be reached again [D124].
    Trouble(BusTrouble),
    /// Find the references of these axes.
    Home(Axes),
    /// Give up finding references.
    Cancel,
    /// Single block on or off.
    SingleBlock(bool),
    /// Feed override in percent, 0…150.
    FeedOverride(u8),
    /// Rapid override in percent, 0…100.
    RapidOverride(u8),
    /// Spindle override in percent, 50…120; frozen inside a thread cycle.
    SpindleOverride(u8),
    /// The press that is alive is over: axes that are moved by hand brake.
    Release,
    /// The next program follows a handwheel, or does not.
    ByWheel(bool),
    /// The inputs of the block on the bus.
    Block(BlockInputs),
    /// The block on the bus is lost.
    BlockLost(BlockLoss),
    /// A handwheel that leads a program has been turned by this way along its path.
    Turned(Length),
}
