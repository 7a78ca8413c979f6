//! `up`, `sim`, `drives`, `record`, `doctor` and `io`: what is typed about a machine, its drives and its bus.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use leadscrew_can::MachineName;
use leadscrew_desk::control::{
    Block, Bus, Contact, Door, Drive, DriveFault, Encoder, Flash, Level, Power, Turret,
};

use super::{Drives, examples};
use crate::values::{Factor, Ripple};

/// `record`.
#[derive(Args, Debug)]
pub struct Record {
    /// Where to: `.log` a candump log, `.csv` a table of setpoints and events
    #[arg(short, long, value_name = "FILE.{log,csv}")]
    pub output: PathBuf,
    /// Machine file of a further board on the bus (repeatable): in a table its drives have columns of their own, `b2_x_nm`…
    #[arg(long, value_name = "FILE")]
    pub further: Vec<PathBuf>,
    /// End after this many packets
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub count: Option<u64>,
}

/// `doctor`.
#[derive(Args, Debug)]
pub struct Doctor {
    /// A candump log instead of a bus
    #[arg(long, value_name = "FILE")]
    pub log: Option<PathBuf>,
    /// How long to listen
    #[arg(long, value_name = "S", default_value_t = 10, value_parser = clap::value_parser!(u16).range(1..=3600))]
    pub seconds: u16,
    /// Send nothing: neither the board's parameters nor objects of drives are read
    #[arg(long, conflicts_with = "log")]
    pub listen_only: bool,
    /// Print the table of all rules
    #[arg(long, conflicts_with_all = ["log", "listen_only"])]
    pub rules: bool,
    /// The drives.
    #[command(flatten)]
    pub drives: Drives,
}

/// `up`.
#[derive(Args, Debug, Default)]
pub struct Up {
    /// Its name [default: the one of `--bus sim:NAME` or LEADSCREW_BUS, else desk]
    #[arg(long, value_name = "NAME")]
    pub name: Option<MachineName>,
    /// Machine file of a new board, which then keeps it (as `--params`) [default: the built-in machine]
    #[arg(long, value_name = "FILE")]
    pub machine: Option<PathBuf>,
    /// Begin with an empty board: what it has kept is forgotten
    #[arg(long)]
    pub new: bool,
    /// Machine time against real time, 0.01 to 5
    #[arg(long, value_name = "K")]
    pub speed: Option<Factor>,
    /// The drives.
    #[command(flatten)]
    pub drives: Drives,
    /// How the speed of its spindle varies: a sine of PERCENT of the commanded speed, as `10@5`
    #[arg(long, value_name = "PERCENT@HZ")]
    pub spindle_ripple: Option<Ripple>,
    /// Time that its spindle takes for each 1000 rpm, in ms [default: parameter 9004]
    #[arg(long, value_name = "MS", value_parser = clap::value_parser!(u32).range(1..=60_000))]
    pub spindle_ramp: Option<u32>,
    /// Stay in this terminal, with the log, until Ctrl-C or `leadscrew down`
    #[arg(long)]
    pub foreground: bool,
    /// This process was started by `up` itself: it leaves the terminal's session.
    #[arg(long, hide = true, requires = "foreground")]
    pub detached: bool,
}

/// `io`.
#[derive(Debug, Subcommand)]
pub enum IoCommand {
    /// Print those that are on, or have a name or a use
    #[command(after_help = examples::IO_LIST)]
    List,
    /// Switch an output, by the M code whose row does it
    #[command(after_help = examples::IO_SET)]
    Set {
        /// A name, or a place as `output:3`, and 0 or 1
        #[arg(value_name = "NAME=0|1")]
        level: String,
    },
    /// Wait until an input or output is so; exit code 1 where the time is over
    #[command(after_help = examples::IO_WAIT)]
    Wait {
        /// A name, or a place as `input:3`, and 0 or 1
        #[arg(value_name = "NAME=0|1")]
        level: String,
        /// Longest time in seconds [default: no limit]
        #[arg(long, value_name = "SECONDS", value_parser = clap::value_parser!(u32).range(1..=86_400))]
        timeout: Option<u32>,
    },
}

/// `drives`.
#[derive(Debug, Subcommand)]
pub enum DrivesCommand {
    /// All built-in profiles, a line each
    #[command(after_help = examples::DRIVES_LIST)]
    List,
    /// A profile: every fact with its source
    #[command(after_help = examples::DRIVES_SHOW)]
    Show {
        /// Its name, or a file that ends with `.toml`
        #[arg(value_name = "NAME")]
        name: String,
    },
}

/// `sim`.
#[derive(Clone, Copy, Debug, Subcommand)]
pub enum SimCommand {
    /// Open or close the door
    #[command(after_help = examples::SIM_DOOR)]
    Door {
        /// What happens to it
        #[arg(value_enum)]
        to: Door,
    },
    /// Press or release the emergency stop; it stays as it is
    #[command(after_help = examples::SIM_ESTOP)]
    Estop {
        /// What happens to it
        #[arg(value_enum)]
        to: Contact,
    },
    /// Press or release the contact of feed hold; it stays as it is
    #[command(after_help = examples::SIM_HOLD)]
    Hold {
        /// What happens to it
        #[arg(value_enum)]
        to: Contact,
    },
    /// Set an input of the board, or leave it to the simulated devices
    #[command(after_help = examples::SIM_INPUT)]
    Input {
        /// Its number
        #[arg(value_name = "N", value_parser = clap::value_parser!(u8).range(1..=32))]
        number: u8,
        /// How it is then; `auto`: as the simulated devices have it
        #[arg(value_enum)]
        to: Level,
    },
    /// Turn the handwheel at the board's own input; 9048 says which inputs choose what it leads
    #[command(after_help = examples::SIM_WHEEL)]
    Wheel {
        /// Detents, at two in ten milliseconds
        #[arg(value_name = "COUNTS", allow_negative_numbers = true, value_parser = clap::value_parser!(i32).range(-10_000..=10_000))]
        counts: i32,
    },
    /// Spoil the turret, or mend it
    #[command(after_help = examples::SIM_TURRET)]
    Turret {
        /// How it is then
        #[arg(value_enum)]
        to: Turret,
    },
    /// Spoil the block of inputs and outputs on the bus (9461), or mend it
    #[command(after_help = examples::SIM_BLOCK)]
    Block {
        /// How it is then
        #[arg(value_enum)]
        to: Block,
    },
    /// Spoil a drive, or mend it
    #[command(after_help = examples::SIM_DRIVE)]
    Drive {
        /// Which one; `S` is the spindle's
        #[arg(value_enum, ignore_case = true)]
        which: Drive,
        /// How it is then
        #[arg(value_enum)]
        to: DriveFault,
    },
    /// Let the spindle turn at another speed than it is told
    #[command(after_help = examples::SIM_SPINDLE)]
    Spindle {
        /// In percent of what it is told: 100 is as it is told, 0 stands, −100 turns the other way
        #[arg(value_name = "PERCENT", allow_negative_numbers = true, value_parser = clap::value_parser!(i16).range(-200..=200))]
        percent: i16,
    },
    /// Spoil the spindle's encoder, or mend it
    #[command(after_help = examples::SIM_ENCODER)]
    Encoder {
        /// How it is then
        #[arg(value_enum)]
        to: Encoder,
    },
    /// Spoil the wire at the board, or mend it
    #[command(after_help = examples::SIM_BUS)]
    Bus {
        /// How it is then
        #[arg(value_enum)]
        to: Bus,
    },
    /// Spoil the board's flash or what is in it, or mend it
    #[command(after_help = examples::SIM_FLASH)]
    Flash {
        /// How it is then
        #[arg(value_enum)]
        to: Flash,
    },
    /// Tell which inputs and outputs of the board are on
    #[command(after_help = examples::SIM_OUTPUTS)]
    Outputs,
    /// Take the power of board and drives, or give it; `cycle` does both
    #[command(after_help = examples::SIM_POWER)]
    Power {
        /// What happens to it
        #[arg(value_enum)]
        to: Power,
    },
    /// Machine time against real time, 0.01 to 5
    #[command(after_help = examples::SIM_SPEED)]
    Speed {
        /// `2` is twice as fast, `0.5` half as fast
        #[arg(value_name = "K", allow_negative_numbers = true)]
        factor: Factor,
    },
    /// Only tell how the machine is
    #[command(after_help = examples::SIM_STATE)]
    State,
}
