//! The two sides of a board, joined by their queues only, against the same board in one piece: any program gives the
//! same setpoints. Also tests of faults that only two sides can have.

mod anew;
mod bench;
mod board;
mod bus;
mod failures;
mod operator;
mod panel;
mod setpoints;
