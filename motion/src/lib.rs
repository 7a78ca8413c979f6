#![no_std]
//! What runs in the tick of a lathe: moves to segments, segments to setpoints, setpoints to CAN frames.
//!
//! ```text
//! moves ─► segments ─► setpoints ─► CAN frames ─► drives
//!   motion/      motion/      bus/
//!                │    tick/    │
//! ```
//!
//! The **tick** is an interrupt with a limit of instructions. It observes the spindle, executes one segment and makes the
//! frames, the same work every time. The **background** expands, checks and plans; it is `leadscrew-core`, which stands on
//! this crate. The two share the single-producer [queues](tick::Queues) and nothing else. The wall between the contexts is
//! the wall between the crates: the tick cannot call the background, because it cannot name it. So each side is compiled
//! for what it needs, this crate for speed and the other for size [D373].
//!
//! - [`units`], [`alarm`], [`params`], [`call`], [`moves`], [`signals`], [`operating`], [`journal`] and [`checksum`] are
//!   the values that both sides share; they do no work.
//! - [`motion`] plans a move into a [segment](motion::Segment) and executes one segment after another into a
//!   [setpoint](motion::Setpoint) a tick.
//! - [`spindle`] observes the encoder: angle, speed, and where the spindle will be when a setpoint takes effect.
//! - [`bus`] is CANopen: frames, and the master of each CiA 402 drive.
//! - [`zones`] are chuck, jaws and tailstock, which the tip of a tool may not enter.
//! - [`tick`] is the side of a board that runs in the interrupt.
//!
//! It must not know program text, the insides of cycles, messages of the gateway, storage or hardware.
//!
//! No allocation, no floating point, no `unsafe`, nothing that can panic, no clock. Time and input are arguments. The words
//! of both crates are explained in `leadscrew-core`, the citations (`[D7]`, `[G76 sheet]`) in `docs/decisions.md`.
//!
//! ```
//! use leadscrew_motion::bus::{CobId, Frame};
//! use leadscrew_motion::units::{Diameter, Lead};
//!
//! let lead = Lead::new(25_400_000, 14).expect("14 threads to the inch");
//! assert!(Lead::new(25_400_000, 0).is_none());
//! assert_eq!(Diameter::from_nm(40_000_000).radius().nm(), 20_000_000);
//! assert_eq!(Frame::new(CobId::SYNC, &[]).map(|sync| sync.payload().len()), Some(0));
//! # let _ = lead;
//! ```

pub mod alarm;
pub mod bus;
pub mod call;
pub mod checksum;
pub mod journal;
pub mod motion;
pub mod moves;
pub mod operating;
pub mod params;
pub mod signals;
pub mod spindle;
pub mod tick;
pub mod units;
pub mod zones;
