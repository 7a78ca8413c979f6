//! The two sides of a board, joined by their queues only, against the same board in one piece: the same setpoints, whatever
//! the program; and what only two sides can get wrong.

mod anew;
mod bench;
mod board;
mod bus;
mod failures;
mod operator;
mod panel;
mod setpoints;
