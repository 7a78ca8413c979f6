//! Time-driven motion at random: machines, moves and operators, every setpoint against every limit.

mod contours;
mod machine;
mod operator;
mod random;
mod targets;
mod volume;
