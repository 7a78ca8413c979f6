//! Nothing is lost and nothing is doubled behind its key, wherever the agent is killed: at each operation on a disk that
//! forgets what was not synced, and as a process.

mod archive;
mod bound;
mod disk;
mod earlier;
mod full;
mod killed;
mod machine;
mod process;
mod since;
