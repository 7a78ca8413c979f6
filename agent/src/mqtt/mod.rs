//! MQTT 3.1.1 to a broker: a client of packets without a socket, and the sockets; what a broker retains, heard once.

pub mod client;
pub mod retained;
pub mod wire;

pub use client::{Client, Fault, Refusal, Said};
pub use wire::{Address, Identity, Login, Tls, Wire, WireError};
