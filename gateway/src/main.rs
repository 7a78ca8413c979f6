//! The `leadscrew` command line.
fn main() {}
