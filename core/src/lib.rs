#![no_std]
//! Lathe threading, grooving and tapping cycles: from program text to drive setpoints.
//!
//! # One way through
//!
//! ```text
//! program text ─► blocks ─► calls ─►│ moves ─► segments ─► setpoints ─► CAN frames ─► drives
//!      text/       program/   call/   │  cycle/   motion/     motion/       bus/
//!               the side with the text │ the board
//! ```
//!
//! Data goes one way. Each arrow is one type, each type has one home, and each stage can be run, printed and tested
//! alone.
//!
//! - `text` turns bytes into words and blocks. It keeps what is modal for the words: units, zero points, feed.
//! - [`program`] turns blocks into [calls](call::Call): all their modal meaning resolved, in machine units, each with the
//!   place it came from. Its memory is bounded by a line, not by the program.
//! - [`cycle`] is a room for each family of cycles: how its words are read, what its geometry forbids, what the machine
//!   cannot do, and its [moves](moves::Move), made lazily and in constant memory.
//! - `feasible` asks of any moves whether the axes can do them, and how long they take.
//! - [`lookahead`] plans how fast joined cuts are passed.
//! - [`offsets`] are work offsets and tools: a table that a board keeps and a gateway resolves programs with.
//! - [`link`] is what gateway and board say to each other: calls, events, status, parameter sets, as bytes.
//! - [`board`] ties them together: calls, frames and encoder samples in; frames, events and alarms out.
//!
//! The second half of the way, and the words that both halves speak, are the crate `leadscrew-motion`. Its modules are
//! named from here as if they stood here.
//!
//! - [`motion`] plans a move into a [segment](motion::Segment) and executes one segment after another into a
//!   [setpoint](motion::Setpoint) a tick.
//! - [`spindle`] observes the encoder: angle, speed, and where the spindle will be when a setpoint takes effect.
//! - [`bus`] is CANopen: frames, and the master of each CiA 402 drive.
//! - [`tick`] is the side of a board that runs in the tick.
//! - [`operating`] is how a machine is operated: its modes, and what is asked of an axis by hand.
//! - [`signals`] are the inputs that a machine's PLC sets: hand and spindle of a tap.
//! - [`zones`] are chuck, jaws and tailstock, which the tip of a tool may not enter.
//! - [`journal`] is what survives a loss of power: the hole a tap is in.
//! - [`checksum`] tells whether what is kept or compared is whole.
//!
//! # One idea for all motion
//!
//! A path is driven by a **master**. Where the master is time (lines, arcs, rapids), a rectangle of path rate is smoothed
//! by two running means into the time-optimal jerk-limited profile; operator and spindle change its height in the tick,
//! and the limits hold whatever they do. Where the master is the spindle (threads), the position is a function of the
//! predicted angle and of nothing else: joining, the exact helix, braking in the end plane and the run-out are parts of
//! one function, so there is no state in which a phase error could hide.
//!
//! # Two contexts
//!
//! The **tick** (an interrupt on a microcontroller) is bounded and does the same work every time: observe, execute one
//! segment, make the frames. The **background** expands, checks and plans. They share single-producer queues and nothing
//! else. The tick is `leadscrew-motion`, which cannot name the background; the background is this crate [D373].
//!
//! # House rules
//!
//! No allocation, no floating point, no `unsafe`, nothing that can panic, no clock. Time and input are arguments, so the
//! same code runs on a host, in a test and on a microcontroller, and gives the same bits. Quantities carry their unit in
//! the type ([`units`]); operators on them saturate, and inputs are bounded far below that. What goes wrong is an
//! [`alarm::Alarm`]: data, with its place in the text; words are put to it where a person reads it. What a machine is
//! like stands in one typed table ([`params`]), generated from the definitions in `params/*.toml`.
//!
//! Sources. Doc comments cite the makers' sheets as `[G76 sheet]` and the decisions where these leave something open as
//! `[D7]`; both are explained in `docs/decisions.md`.
//!
//! # As a library
//!
//! Text to moves, without a machine. A front end draws them, a post-processor counts them.
//!
//! ```
//! use leadscrew_core::alarm::Alarm;
//! use leadscrew_core::cycle::{self, Context};
//! use leadscrew_core::moves::MoveKind;
//! use leadscrew_core::params::Params;
//! use leadscrew_core::program::{Event, Events, Options};
//!
//! let program = b"M3 S300\nG0 X80 Z10\nG76 P020560 Q150 R0.1\nG76 X60.64 Z-62 P3680 Q1800 F6\n";
//! let (params, options) = (Params::slant_bed(), Options::default());
//! let (mut at, mut moves, mut strokes) = (options.position, 0, 0);
//! for event in Events::new(program, &params, options) {
//!     let Event::Call(call) = event? else { continue };
//!     for step in cycle::expand(&call, &Context::standing(at))? {
//!         moves += 1;
//!         strokes += usize::from(matches!(step.kind, MoveKind::Thread(thread) if thread.last));
//!         at = step.to;
//!     }
//! }
//! assert_eq!((strokes, at.x.nm(), at.z.nm()), (6, 40_000_000, 10_000_000));
//! assert_eq!(moves, 32); // the spindle, a rapid, and six passes of five moves
//! # Ok::<(), Alarm>(())
//! ```

#[doc(inline)]
pub use leadscrew_motion::{
    alarm, call, checksum, journal, motion, moves, operating, params, signals, spindle, tick,
    units, zones,
};

pub mod board;
pub mod bus;
pub mod cycle;
mod feasible;
pub mod link;
pub mod lookahead;
pub mod offsets;
pub mod program;
mod text;
