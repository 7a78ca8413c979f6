//! On a real CAN interface of the kernel: what is sent arrives, complete, in order, with what went wrong told as such.
//!
//! Nothing here is skipped. Without an interface every test fails and says how to get one; `cargo xtask vcan` finds or
//! makes one. Counts, order and contents are asserted, never time.

mod board;
mod bus;
mod by_hand;
mod faults;
mod hour;
mod killed;
mod machine;
mod mistakes;
mod operate;
mod other;
mod params;
mod python;
mod record;
mod run;
mod socket;
