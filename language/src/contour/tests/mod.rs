//! Tests of the contour cycles.

mod case;
mod cases;
mod check;
mod columns;
mod notation;
mod programs;
mod remains;
mod repeated;
mod vectors;
