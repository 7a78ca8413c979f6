//! Parameters and offsets over a loss of power: cut in the middle of a change, and damaged at any bit of what is stored.

mod cuts;
mod damage;
mod flash;
mod living;
mod offsets;
mod starts;
mod wear;
