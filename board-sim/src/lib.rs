//! The simulated plant.
#![no_std]
