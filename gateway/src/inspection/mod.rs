//! Virtual metrology of a program: its threads, cut by the simulated machine's positions and measured, and its grooves and
//! contours ([`turned`]).
//!
//! [`plan`] finds the threads in the text, [`samples`] turns the machine's ticks into cuts, [`sheet`], [`result`] and
//! [`picture`] tell what was found. How threads are found and cut is in `leadscrew_inspection`, how a part is measured in
//! `leadscrew_metrology`.

pub mod edge;
pub mod picture;
pub mod plan;
pub mod result;
pub mod samples;
pub mod sheet;
pub mod turned;
