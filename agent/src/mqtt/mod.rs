//! MQTT 3.1.1 to a broker: a client of packets without a socket, and the sockets.

pub mod client;
pub mod wire;

pub use client::{Client, Fault, Said};
pub use wire::{Address, Login, Tls, Wire, WireError};
