//! The board as a node on a simulated wire: what a gateway, or anybody's CANopen tool, sees and can do.

mod away;
mod backlash;
mod block;
mod by_hand;
mod hard_limits;
mod kept;
mod network;
mod objects;
mod offsets;
mod own_wheel;
mod parameters;
mod pitch;
mod position;
mod programs;
mod protection;
mod spindle_by_hand;
mod threads;
mod wheel;
mod wheel_program;
mod zones;
