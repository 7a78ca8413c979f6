//! `params`: what is typed about the parameters.

use std::path::PathBuf;

use clap::{Args, Subcommand};

use super::examples;

/// `params`.
#[derive(Debug, Subcommand)]
pub enum ParamsCommand {
    /// Print all parameters with their values
    #[command(after_help = examples::LIST)]
    List {
        /// Only those with this in their number, name or meaning
        #[arg(value_name = "TEXT")]
        filter: Option<String>,
    },
    /// Print single parameters, with range and source
    #[command(after_help = examples::GET)]
    Get {
        /// Number or name, with or without its bit or axis
        #[arg(required = true, value_name = "NO[.BIT|.AXIS]")]
        keys: Vec<String>,
    },
    /// Check the set that `--params` and `--set` make
    #[command(after_help = examples::VALIDATE)]
    Validate,
    /// Print the manual of all parameters as Markdown
    #[command(after_help = examples::DOCS)]
    Docs {
        /// The board's electronic data sheet (EDS) for CANopen tools
        #[arg(long)]
        eds: bool,
    },
    /// Write values: to a board, to the simulated flash in `--state`, or into the one file of `--params`
    #[command(name = "set", after_help = examples::WRITE)]
    Write(Write),
    /// Fetch the set of a board as a machine file
    #[command(after_help = examples::PULL)]
    Pull(Pull),
    /// Send machine files to a board, and the drives' own objects to the drives: all or nothing
    #[command(after_help = examples::PUSH)]
    Push(Push),
    /// Take the last good set before the stored one back into force
    #[command(after_help = examples::RESTORE)]
    Restore(Restore),
    /// Compare: the board with a file, two files, or the board with the built-in machine
    #[command(after_help = examples::DIFF)]
    Diff(Diff),
    /// Bring a file of an older version of the table up to date
    #[command(after_help = examples::MIGRATE)]
    Migrate(Migrate),
}

/// `params set`.
#[derive(Args, Debug)]
pub struct Write {
    /// Number or name, with its bit or axis, and the value; its unit may be left out
    #[arg(required = true, value_name = "NO[.BIT|.AXIS]=VALUE")]
    pub values: Vec<String>,
    /// Password of the board's parameters
    #[arg(long, value_name = "N")]
    pub password: Option<u32>,
}

/// `params pull`.
#[derive(Args, Debug)]
pub struct Pull {
    /// Where it goes; standard output where this is left out. A file that is there already is not written over
    #[arg(short, long, value_name = "FILE.toml")]
    pub output: Option<PathBuf>,
    /// A machine file that takes the values over, and keeps its comments, order and style
    #[arg(long, value_name = "FILE.toml", conflicts_with = "output")]
    pub into: Option<PathBuf>,
}

/// `params push`.
#[derive(Args, Debug)]
pub struct Push {
    /// Machine files, the later win; what they do not name stays as it is on the board
    #[arg(value_name = "FILE")]
    pub files: Vec<PathBuf>,
    /// What is not named becomes the built-in machine's, instead of staying as it is
    #[arg(long)]
    pub built_in: bool,
    /// Password of the board's parameters
    #[arg(long, value_name = "N")]
    pub password: Option<u32>,
}

/// `params restore`.
#[derive(Args, Debug)]
pub struct Restore {
    /// Password of the board's parameters
    #[arg(long, value_name = "N")]
    pub password: Option<u32>,
}

/// `params diff`.
#[derive(Args, Debug)]
pub struct Diff {
    /// None: the built-in machine against the set in force; one: the set in force against it with the file; two: each
    /// over the built-in machine
    #[arg(value_name = "FILE", num_args = 0..=2)]
    pub files: Vec<PathBuf>,
}

/// `params migrate`.
#[derive(Args, Debug)]
pub struct Migrate {
    /// A machine file of an older version
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// Where the new file goes; nothing is written without
    #[arg(short, long, value_name = "FILE.toml")]
    pub output: Option<PathBuf>,
    /// The version of a file that does not say its own
    #[arg(long, value_name = "SCHEMA")]
    pub from: Option<u32>,
}
