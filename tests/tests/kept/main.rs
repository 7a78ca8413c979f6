//! Parameters and offsets over a loss of power: cut at every byte of a change, and damaged at every bit of what is stored.

mod cuts;
mod damage;
mod flash;
mod offsets;
