//! What goes to a broker: births and sequence numbers, what is sent again, orders, refusals; over sockets and TLS too.

mod bench;
mod births;
mod host;
mod sets;
mod sockets;
