#![no_std]
#![forbid(unsafe_code)]
//! A simulated machine: the plant around a board, for tests, for `--bus sim` and for emulated firmware.
//!
//! The plant uses integers only and no allocation, so that the same plant gives the same bits on every computer. It
//! knows the board only by its frames.
//!
//! ```
//! use leadscrew_board_sim::Sim;
//! use leadscrew_board_sim::plant::PlantOptions;
//! use leadscrew_core::params::Params;
//!
//! // A board is larger than the stack of a test's thread.
//! let ticks = std::thread::Builder::new().stack_size(16 << 20).spawn(|| {
//!     let mut sim = Sim::new(&Params::slant_bed(), &PlantOptions::default()).expect("a machine that can be");
//!     let begun = std::iter::from_fn(|| sim.step());
//!     begun.take(100).count()
//! });
//! assert_eq!(ticks.expect("a thread").join().expect("its end"), 100);
//! ```

mod around;
mod fitted;
pub mod line;
mod pins;
pub mod plant;
mod sim;
mod storage;
mod turret;
mod wheel;

pub use around::Around;
pub use fitted::{fit_switches, places, switch};
pub use pins::show_pins;
pub use sim::{CutPoint, Direction, Doing, Row, Sim, SimError, SpindleAngle, TapPoint};
pub use storage::{Decay, count_start, decay, keep, stored_params, stored_start, stored_tap};
pub use turret::TurretFault;
pub use wheel::Wheel;
