//! What goes wrong while a machine works, at every place of a program, and the program after it: the alarm comes in
//! time, everything comes to rest, and behind a reset nothing is left of what was.

mod bench;
mod calls;
mod drives;
mod orders;
mod spindle;
