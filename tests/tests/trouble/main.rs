//! What goes wrong while a machine works, at every place of a program, and the program after it: the alarm comes in
//! time, everything comes to rest, and after a reset nothing is left of the trouble.

mod bench;
mod calls;
mod drives;
mod orders;
mod spindle;
