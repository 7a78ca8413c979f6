//! Ordinary tapping on the whole machine: the axis follows the measured spindle through stop and reversal, comes to rest at
//! the bottom and at R exactly, and stays with the spindle whatever stops it.

mod few;
mod forms;
mod hole;
mod jerk;
mod operation;
mod random;
mod ripple;
mod stops;
mod trouble;
mod watch;
