//! What can be typed: commands, options, and their help. Parsing only; nothing is done here.

use std::path::PathBuf;

use clap::builder::Styles;
use clap::builder::styling::AnsiColor;
use clap::{Args, Parser, Subcommand, ValueEnum};

use leadscrew_can::{Address, BitRate};
use leadscrew_core::alarm::Lang;
use leadscrew_core::bus::NodeId;

use crate::failure::{Failure, Outcome};
use crate::values::{At, Percent, Ripple, SetSignal, Tolerance};
use crate::words::both;

const STYLES: Styles = Styles::styled()
    .header(AnsiColor::Green.on_default().bold())
    .usage(AnsiColor::Green.on_default().bold())
    .literal(AnsiColor::Cyan.on_default().bold())
    .placeholder(AnsiColor::Cyan.on_default());

const EXAMPLES: &str = "\
Examples:
  leadscrew check examples/o0013-g76-m68x6.nc      find mistakes before anything moves
  leadscrew expand examples/o0013-g76-m68x6.nc     see every move of the cycle
  leadscrew plot examples/shaft.nc -o shaft.svg    a picture of path, speed and synchronism
  leadscrew run examples/shaft.nc                  run it on the simulated machine
  leadscrew simulate PROG -o setpoints.csv         the setpoints, tick by tick

Exit codes:
  0    done, warnings included
  1    the program or the parameters are wrong, or a check asked for has failed
  2    the command line is wrong
  3    no bus, no board, or the link was lost
  4    the machine stopped on an alarm while running
  130  interrupted; the board was brought to a controlled stop first";

/// Lathe threading and grooving cycles: from program text to drive setpoints.
#[derive(Debug, Parser)]
#[command(name = "leadscrew", version, about = "Lathe threading and grooving cycles: from program text to drive setpoints", after_help = EXAMPLES, styles = STYLES, max_term_width = 110)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
    /// What holds for every command.
    #[command(flatten)]
    pub global: Global,
}

/// Options that every command takes.
#[derive(Args, Debug)]
#[command(next_help_heading = "Options of every command")]
pub struct Global {
    /// Where the machine is: `sim`, a SocketCAN interface (`can0`, `socketcan:can0`), or an adapter:
    /// `slcan:/dev/ttyACM0[@BAUD]`, `slcan:tcp:HOST:PORT`, `slcan:unix:PATH`
    ///
    /// `sim` is a simulated board with drives and a spindle inside this process; it needs no device and no privileges.
    /// The others talk to a board, whose own parameters then count.
    #[arg(long, global = true, value_name = "BUS", default_value = "sim")]
    pub bus: Address,
    /// Bit rate of the CAN behind an `slcan:` adapter, in kbit/s: 10 20 50 100 125 250 500 800 1000 [default: 1000]
    ///
    /// `@BAUD` of the bus is the speed of the serial line to the adapter. An interface of the kernel has its bit rate from
    /// `ip link set can0 type can bitrate …`.
    #[arg(long, global = true, value_name = "KBIT", value_parser = bit_rate)]
    pub bitrate: Option<BitRate>,
    /// CANopen node of the board, 1 to 127 [default: 1]; 127 is the gateway's own number, and no board has it
    #[arg(long, global = true, value_name = "N", value_parser = clap::value_parser!(u8).range(1..=127))]
    pub node: Option<u8>,
    /// Parameter file of the machine (repeatable; later files win)
    #[arg(long, global = true, value_name = "FILE")]
    pub params: Vec<PathBuf>,
    /// One parameter, after all files: `182.7=1`, `1420.X=12000`, `rapid_rate.X=12m/min` (repeatable)
    ///
    /// A value without a unit has the one that `leadscrew params docs` prints.
    #[arg(long, global = true, value_name = "NO[.BIT|.AXIS]=VALUE")]
    pub set: Vec<String>,
    /// Control family: settles words the two families write alike and mean differently
    #[arg(long, global = true, value_enum, default_value_t)]
    pub dialect: DialectName,
    /// Block skip: leave out blocks that begin with `/`
    #[arg(long, global = true)]
    pub skip: bool,
    /// Stop at M01 (with `sim` it passes at once)
    #[arg(long, global = true)]
    pub optional_stop: bool,
    /// Stop after every block and every pass (with `sim` it passes at once)
    #[arg(long, global = true)]
    pub single_block: bool,
    /// Use the dry-run feed for every feed; thread strokes keep their lead
    #[arg(long, global = true)]
    pub dry_run: bool,
    /// Language of messages
    #[arg(long, global = true, value_enum, default_value_t)]
    pub lang: LangName,
    /// One machine-readable result on stdout
    #[arg(long, global = true)]
    pub json: bool,
    /// Seed of every noise source
    #[arg(
        long,
        global = true,
        value_name = "N",
        default_value_t = 1,
        allow_negative_numbers = true
    )]
    pub seed: u64,
    /// Where the machine powers up, in machine coordinates, X a diameter: `X=100,Z=50`
    #[arg(
        long,
        global = true,
        value_name = "X=…,Z=…",
        allow_hyphen_values = true
    )]
    pub at: Option<At>,
    /// File that keeps the simulated board's flash between commands; made where there is none
    #[arg(long, global = true, value_name = "FILE")]
    pub state: Option<PathBuf>,
    /// An input at the start (repeatable): G61.2, RGTAP, SWS1 to SWS4, RGTSP1 to RGTSP4
    #[arg(long, global = true, value_name = "NAME=0|1")]
    pub signal: Vec<SetSignal>,
    /// Takes the simulated board's power away at this tick (with `--state`)
    #[arg(long, global = true, value_name = "TICK")]
    pub cut_power: Option<u64>,
}

/// A bit rate that a Lawicel adapter can be set to.
fn bit_rate(text: &str) -> Result<BitRate, String> {
    let kbit = text.parse().map_err(|_| "expected kbit/s, as `500`")?;
    BitRate::of_kbit(kbit)
        .ok_or_else(|| "an adapter has 10, 20, 50, 100, 125, 250, 500, 800 and 1000 kbit/s".into())
}

impl Global {
    /// The board's number.
    #[must_use]
    pub fn node(&self) -> NodeId {
        self.node.and_then(NodeId::new).unwrap_or(NodeId::BOARD)
    }

    /// The same where a board is to be talked to.
    ///
    /// # Errors
    /// [`Failure::Usage`] for the number that this side has itself [D175].
    pub fn board(&self) -> Outcome<NodeId> {
        match self.node() {
            NodeId::GATEWAY => Err(Failure::Usage(both!(
                "`--node 127` is this side's own number on the bus; boards have 1 to 126",
                "`--node 127` 是本机在总线上的节点号；控制板的节点号为 1 至 126"
            ))),
            node => Ok(node),
        }
    }

    /// The bit rate for an adapter.
    ///
    /// # Errors
    /// [`Failure::Usage`] where it was given for a bus that has its own.
    pub fn bit_rate(&self) -> Outcome<BitRate> {
        match (&self.bus, self.bitrate) {
            (Address::Serial { .. } | Address::Tcp { .. } | Address::Unix(_), rate) => {
                Ok(rate.unwrap_or(BitRate::M1))
            }
            (_, None) => Ok(BitRate::M1),
            (bus, Some(rate)) => {
                let bits = rate.bits_per_second();
                Err(Failure::Usage(both!(
                    "`--bitrate` is for `slcan:` adapters, not for `--bus {bus}`; an interface of the kernel is set with `ip \
                     link set IFACE type can bitrate {bits}`",
                    "`--bitrate` 只用于 `slcan:` 适配器，不用于 `--bus {bus}`；内核接口请用 `ip link set IFACE type can bitrate \
                     {bits}` 设置"
                )))
            }
        }
    }

    /// The language of messages.
    pub fn lang(&self) -> Lang {
        match self.lang {
            LangName::En => Lang::En,
            LangName::Zh => Lang::Zh,
        }
    }
}

/// `--dialect`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum DialectName {
    /// GSK 980TD.
    #[default]
    Gsk980td,
    /// GSK 988.
    Gsk988,
}

/// `--lang`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum LangName {
    /// English.
    #[default]
    En,
    /// Chinese.
    Zh,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Verify programs against parameters and physics, without a machine
    #[command(after_help = CHECK_EXAMPLES)]
    Check(Check),
    /// Print the move list
    #[command(after_help = EXPAND_EXAMPLES)]
    Expand(Expand),
    /// Compute the setpoints, tick by tick, in virtual time
    #[command(after_help = SIMULATE_EXAMPLES)]
    Simulate(Simulate),
    /// Draw the X–Z tool path, and speed and synchronism over time
    #[command(after_help = PLOT_EXAMPLES)]
    Plot(Plot),
    /// Check all of a program, upload it and run it
    #[command(after_help = RUN_EXAMPLES)]
    Run(Run),
    /// The parameter table: what there is, what it is set to, whether it can work
    #[command(after_help = PARAMS_EXAMPLES)]
    Params {
        /// What to do with it
        #[command(subcommand)]
        command: ParamsCommand,
    },
    /// One look at the board; with `sim`, at what the flash in `--state` remembers
    ///
    /// Without `--node` it names the other boards on the bus, too, which takes as long as they are silent at a time.
    Status,
    /// A live view of the board (needs a real bus)
    Monitor,
    /// Feed hold (needs a real bus)
    Hold,
    /// Go on after a hold (needs a real bus)
    Resume,
    /// Reset the board (needs a real bus)
    Reset,
    /// Controlled stop (needs a real bus)
    Stop,
    /// Set an override (needs a real bus)
    Override {
        /// Which one
        #[arg(value_enum)]
        what: OverrideName,
        /// Whole percent: feed 0 to 150, rapid 0 to 100, spindle 50 to 120
        #[arg(allow_negative_numbers = true)]
        percent: Percent,
    },
    /// Set an input (needs a real bus)
    Signal {
        /// `NAME=0` or `NAME=1`
        #[arg(value_name = "NAME=0|1")]
        signal: SetSignal,
    },
    /// Brings a tap out of its hole in phase, the same as G30 P99
    ///
    /// With `--dry-run` it only shows what would move.
    #[command(after_help = RETRACT_EXAMPLES)]
    Retract {
        /// Spindle speed in turns per minute
        #[arg(long, value_name = "RPM", conflicts_with = "discard", value_parser = clap::value_parser!(u32).range(1..=9999))]
        speed: Option<u32>,
        /// Drop the record instead: no tap is in a hole
        #[arg(long)]
        discard: bool,
    },
    /// Capture the bus into a file, until Ctrl-C
    #[command(after_help = RECORD_EXAMPLES)]
    Record(Record),
    /// Print a completion script for a shell
    #[command(
        after_help = "Example:\n  leadscrew completions bash > ~/.local/share/bash-completion/completions/leadscrew"
    )]
    Completions {
        /// Which shell
        #[arg(value_enum)]
        shell: clap_complete::Shell,
    },
}

const RETRACT_EXAMPLES: &str = "\
Examples:
  leadscrew status --state board.flash              is a tap in a hole?
  leadscrew retract --dry-run --state board.flash   what would move
  leadscrew retract --speed 200 --state board.flash
  leadscrew retract --discard --state board.flash   the tap was taken out by hand";

const CHECK_EXAMPLES: &str = "\
Examples:
  leadscrew check part.nc
  leadscrew check --strict *.nc            a lead-in that is too short fails too
  leadscrew check --json part.nc           for editors and scripts
  leadscrew check --set 1430.Z=4000 part.nc";

/// `check`.
#[derive(Args, Debug)]
pub struct Check {
    /// Programs
    #[arg(required = true, value_name = "PROG")]
    pub programs: Vec<PathBuf>,
    /// Fail (exit 1) when a thread starts too close to the material for its lead-in
    #[arg(long)]
    pub strict: bool,
}

const EXPAND_EXAMPLES: &str = "\
Examples:
  leadscrew expand part.nc
  leadscrew expand part.nc --format jsonl | jq 'select(.cycle == \"G76\")'
  leadscrew expand part.nc --format csv > moves.csv";

/// `expand`.
#[derive(Args, Debug)]
pub struct Expand {
    /// Program
    #[arg(value_name = "PROG")]
    pub program: PathBuf,
    /// How to print the moves (`--json` is the same as `--format jsonl`)
    #[arg(long, value_enum)]
    pub format: Option<Format>,
}

/// `--format` of `expand`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// A table to read.
    Text,
    /// One JSON object a line.
    Jsonl,
    /// Comma-separated, with a header.
    Csv,
}

/// What drives the virtual machine.
#[derive(Args, Debug, Default)]
pub struct Drive {
    /// Spindle speed ripple: a sine of PERCENT of the commanded speed, as `10@5`
    #[arg(long, value_name = "PERCENT@HZ")]
    pub spindle_ripple: Option<Ripple>,
    /// Interpolation tick in microseconds, instead of parameter 9000
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(250..=10_000))]
    pub tick_us: Option<u32>,
}

const SIMULATE_EXAMPLES: &str = "\
Examples:
  leadscrew simulate part.nc                                    only the summary
  leadscrew simulate part.nc -o setpoints.csv
  leadscrew simulate part.nc --spindle-ripple 10@5 --tolerance 1.3
  leadscrew simulate part.nc --at X=100,Z=50 --json";

/// `simulate`.
#[derive(Args, Debug)]
pub struct Simulate {
    /// Program
    #[arg(value_name = "PROG")]
    pub program: PathBuf,
    /// Where the setpoints go, one row a tick
    #[arg(short, long, value_name = "FILE.csv")]
    pub output: Option<PathBuf>,
    /// The plant.
    #[command(flatten)]
    pub drive: Drive,
    /// Fail (exit 1) when the worst synchronism error of a thread or a hole is above this many micrometres
    #[arg(long, value_name = "UM", allow_negative_numbers = true)]
    pub tolerance: Option<Tolerance>,
}

const PLOT_EXAMPLES: &str = "\
Examples:
  leadscrew plot examples/shaft.nc -o shaft.svg
  leadscrew plot part.nc -o part.svg --spindle-ripple 10@5";

/// `plot`.
#[derive(Args, Debug)]
pub struct Plot {
    /// Program
    #[arg(value_name = "PROG")]
    pub program: PathBuf,
    /// Where the picture goes; the ending chooses the format (`svg`; `png` and `html` are not available yet)
    #[arg(short, long, value_name = "FILE.svg")]
    pub output: PathBuf,
    /// The plant.
    #[command(flatten)]
    pub drive: Drive,
}

const RECORD_EXAMPLES: &str = "\
Examples:
  leadscrew record --bus can0 -o bus.log           what candump writes and canplayer, Wireshark and python-can read
  leadscrew record --bus can0 -o setpoints.csv     setpoints, actual positions and events
  leadscrew record --bus can0 --params a.toml --further b.toml -o both.csv     of two boards
  leadscrew record --bus slcan:/dev/ttyACM0 -o bus.log --count 1000";

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

const RUN_EXAMPLES: &str = "\
Examples:
  leadscrew run examples/shaft.nc
  leadscrew run part.nc --tolerance 1.0 --json
  leadscrew run part.nc --spindle-ripple 10@5 --tolerance 1.3";

/// `run`.
#[derive(Args, Debug)]
pub struct Run {
    /// Program
    #[arg(value_name = "PROG")]
    pub program: PathBuf,
    /// Write the bus traffic as a candump log
    #[arg(long, value_name = "FILE")]
    pub record: Option<PathBuf>,
    /// The plant.
    #[command(flatten)]
    pub drive: Drive,
    /// Fail (exit 1) when the worst synchronism error of a thread or a hole is above this many micrometres
    #[arg(long, value_name = "UM", allow_negative_numbers = true)]
    pub tolerance: Option<Tolerance>,
}

/// The overrides.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum OverrideName {
    /// Feed.
    Feed,
    /// Rapid.
    Rapid,
    /// Spindle.
    Spindle,
}

const PARAMS_EXAMPLES: &str = "\
Examples:
  leadscrew params list thread                             all that have `thread` in their name or meaning
  leadscrew params get 1420.X --params lathe.toml          one value, and where it was set
  leadscrew params validate --params lathe.toml            find mistakes in a machine file
  leadscrew params docs > parameters.md                    the manual of all parameters
  leadscrew params pull -o lathe.toml --bus can0           a board's set as a file
  leadscrew params diff lathe.toml --bus can0              what pushing it would change
  leadscrew params push lathe.toml --bus can0              all of it, or nothing
  leadscrew params set 1420.X=11000 --bus can0             one value

A machine file is TOML, one value a line, keys by number or name, values with their unit:
  \"1420.X\" = \"12000 mm/min\"
  acceleration.Z = \"3 m/s²\"
  182.7 = 1";

/// `params`.
#[derive(Debug, Subcommand)]
pub enum ParamsCommand {
    /// Print all parameters with their values
    List {
        /// Only those with this in their number, name or meaning
        #[arg(value_name = "TEXT")]
        filter: Option<String>,
    },
    /// Print single parameters, with range and source
    Get {
        /// Number or name, with or without its bit or axis
        #[arg(required = true, value_name = "NO[.BIT|.AXIS]")]
        keys: Vec<String>,
    },
    /// Check the set that `--params` and `--set` make
    Validate,
    /// Print the manual of all parameters as Markdown
    Docs {
        /// The board's electronic data sheet (EDS) for CANopen tools
        #[arg(long)]
        eds: bool,
    },
    /// Write values: to a board, to the simulated flash in `--state`, or into the one file of `--params`
    #[command(name = "set")]
    Write(Write),
    /// Fetch the set of a board as a machine file
    Pull(Pull),
    /// Send machine files to a board, and the drives' own objects to the drives: all or nothing
    #[command(after_help = PUSH_EXAMPLES)]
    Push(Push),
    /// Take the last good set before the stored one back into force
    Restore(Restore),
    /// Compare: the board with a file, two files, or the board with the built-in machine
    Diff(Diff),
    /// Bring a file of an older version of the table up to date
    Migrate(Migrate),
}

const PUSH_EXAMPLES: &str = "\
Examples:
  leadscrew params push lathe.toml --bus can0 --dry-run    what would change
  leadscrew params push lathe.toml --bus can0
  leadscrew params push lathe.toml --state board.flash     the simulated board's flash";

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
