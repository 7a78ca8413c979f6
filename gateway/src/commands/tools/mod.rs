//! `tools`, `offsets`, `touch` and `pickup`: the table that a board keeps; one file a verb.

mod file;
mod home;
mod list;
mod pickup;
mod set;
pub mod touch;

pub use home::{Home, of_params};
pub use pickup::pickup;
pub use touch::touch;

use crate::cli::{Global, OffsetsCommand, ToolsCommand};
use crate::failure::{Failure, Outcome};
use crate::tools::{Key, unknown};

/// Does what was typed after `tools`.
pub fn tools(global: &Global, command: &ToolsCommand) -> Outcome {
    match command {
        ToolsCommand::List => list::tools(global),
        ToolsCommand::Get { keys } => list::get(global, &found(keys, Key::is_of_tool)?),
        ToolsCommand::Write(args) => set::run(global, args, Key::is_of_tool),
        ToolsCommand::Pull(args) => file::pull(global, args),
        ToolsCommand::Push(args) => set::push(global, args),
        ToolsCommand::Diff(args) => file::diff(global, args),
    }
}

/// Does what was typed after `offsets`.
pub fn offsets(global: &Global, command: &OffsetsCommand) -> Outcome {
    let is_offset = |key: Key| !key.is_of_tool();
    match command {
        OffsetsCommand::List => list::offsets(global),
        OffsetsCommand::Get { keys } => list::get(global, &found(keys, is_offset)?),
        OffsetsCommand::Write(args) => set::run(global, args, is_offset),
    }
}

/// The keys that were typed.
fn found(typed: &[String], belongs: impl Fn(Key) -> bool) -> Outcome<Vec<Key>> {
    let mut keys = Vec::new();
    for text in typed {
        let named = Key::find(text);
        if named.is_empty() || !named.iter().all(|key| belongs(*key)) {
            return Err(Failure::Usage(unknown(text)));
        }
        keys.extend(named);
    }
    Ok(keys)
}
