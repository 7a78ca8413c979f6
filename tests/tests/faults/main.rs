//! Faults of the bus and of what is on it: each is injected, and what the machine does about it is looked at in full:
//! which alarm with which figures, how it comes to rest, what moves afterwards, and that the next program is cut as the
//! first would have been. What a drive, a spindle or an encoder can do wrong at any place of a program is in `trouble`.

mod bench;
mod cable;
mod controller;
mod flash;
mod frames;
mod gateway;
mod late;
mod masters;
mod power;
