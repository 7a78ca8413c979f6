//! Tests of the contour cycles.

mod cases;
mod check;
mod notation;
mod vectors;
