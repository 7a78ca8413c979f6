//! Tests of the contour cycles.

mod case;
mod cases;
mod check;
mod notation;
mod vectors;
