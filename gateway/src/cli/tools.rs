//! `tools`, `offsets` and `touch`: what is typed about tools and work offsets.

use std::path::PathBuf;

use clap::{Args, Subcommand, ValueEnum};

/// `tools`.
#[derive(Debug, Subcommand)]
pub enum ToolsCommand {
    /// Print the tools
    List,
    /// Print single values
    Get {
        /// `T1`, `T1.X`, `T1.wear.Z`, `T1.radius`
        #[arg(required = true, value_name = "KEY")]
        keys: Vec<String>,
    },
    /// Change single values
    #[command(name = "set")]
    Write(Assign),
    /// Fetch the table, offsets included, as a file
    Pull(PullTools),
    /// Send files to a board: all or nothing; what they do not name stays
    Push(PushTools),
    /// Compare: the table with a file, or two files
    Diff(DiffTools),
}

/// `offsets`.
#[derive(Debug, Subcommand)]
pub enum OffsetsCommand {
    /// Print the offsets
    List,
    /// Print single values
    Get {
        /// `G54`, `G54.Z`, `shift.X`
        #[arg(required = true, value_name = "KEY")]
        keys: Vec<String>,
    },
    /// Change single values
    #[command(name = "set")]
    Write(Assign),
}

/// `tools set` and `offsets set`.
#[derive(Args, Debug)]
pub struct Assign {
    /// Millimetres or with a unit, X in diameter; `+=` and `-=` add
    #[arg(
        required = true,
        value_name = "KEY=VALUE",
        allow_negative_numbers = true
    )]
    pub values: Vec<String>,
    /// Do not ask where a wear changes by more than 1 mm
    #[arg(long)]
    pub yes: bool,
}

/// `tools pull`.
#[derive(Args, Debug)]
pub struct PullTools {
    /// Where it goes; standard output where this is left out
    #[arg(short, long, value_name = "FILE.toml")]
    pub output: Option<PathBuf>,
    /// Write over a file that is there already
    #[arg(long)]
    pub force: bool,
}

/// `tools push`.
#[derive(Args, Debug)]
pub struct PushTools {
    /// Files, the later win
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
    /// Do not ask where a wear changes by more than 1 mm
    #[arg(long)]
    pub yes: bool,
}

/// `tools diff`.
#[derive(Args, Debug)]
pub struct DiffTools {
    /// One: the table against it with the file; two: each by itself
    #[arg(required = true, value_name = "FILE", num_args = 1..=2)]
    pub files: Vec<PathBuf>,
}

/// `touch`.
#[derive(Args, Debug)]
pub struct Touch {
    /// The axis
    #[arg(value_enum, ignore_case = true)]
    pub axis: AxisName,
    /// Coordinate of the work where the tool touches: of X the measured diameter, of Z often 0
    #[arg(value_name = "VALUE", allow_negative_numbers = true)]
    pub value: Option<String>,
    /// Offset number of the tool: its geometry is set and its wear becomes 0; with `--work` the tool that touches
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(1..=32))]
    pub tool: Option<u8>,
    /// Set this work offset instead, by the known geometry of `--tool` (none: 0)
    #[arg(long, value_enum, ignore_case = true, value_name = "G54")]
    pub work: Option<SystemName>,
    /// The work coordinate system that VALUE is of
    #[arg(
        long = "in",
        value_enum,
        ignore_case = true,
        value_name = "G54",
        default_value = "G54",
        conflicts_with = "work"
    )]
    pub system: SystemName,
    /// Remember where the axis stands: the next touch counts from there (cut, mark, move off, measure)
    #[arg(long, conflicts_with_all = ["value", "tool", "work"])]
    pub mark: bool,
}

/// `pickup`.
#[derive(Args, Debug)]
pub struct Pickup {
    /// Offset number of the tool whose tip stands in the groove
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(1..=32))]
    pub tool: Option<u8>,
    /// Threads begin at their own start angle again
    #[arg(long, conflicts_with = "tool")]
    pub clear: bool,
}

/// An axis that is touched off.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum AxisName {
    /// X.
    #[value(name = "X")]
    X,
    /// Z.
    #[value(name = "Z")]
    Z,
}

/// A work coordinate system.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SystemName {
    /// G54.
    #[value(name = "G54")]
    G54,
    /// G55.
    #[value(name = "G55")]
    G55,
    /// G56.
    #[value(name = "G56")]
    G56,
    /// G57.
    #[value(name = "G57")]
    G57,
    /// G58.
    #[value(name = "G58")]
    G58,
    /// G59.
    #[value(name = "G59")]
    G59,
}
