//! Homing of whole machines in virtual time: the drives' own homing, what is odd about drives, and what goes wrong.

mod bench;
mod faults;
mod inputs;
mod limits;
mod methods;
mod options;
mod orders;
mod pitch;
mod references;
mod switches;
