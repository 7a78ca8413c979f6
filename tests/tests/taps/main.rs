//! Rigid taps on the whole machine: axis and spindle on one line in every tick, whatever happens.

mod alarms;
mod hole;
mod limits;
mod modes;
mod operation;
mod random;
mod signals;
mod spindles;
mod stops;
mod watch;
