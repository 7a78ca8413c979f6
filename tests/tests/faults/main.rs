//! Faults of the bus and of the nodes on it. Each test injects a fault and checks everything that the machine does about
//! it: which alarm with which figures, how the machine comes to rest, what moves afterwards, and that the next program is
//! cut as the first would have been. What a drive, a spindle or an encoder can do wrong at any place of a program is in
//! `trouble`.

mod bench;
mod cable;
mod controller;
mod flash;
mod frames;
mod gateway;
mod late;
mod masters;
mod power;
