//! What can be typed: commands, options, and their help. Parsing only; nothing is done here.

mod by_hand;
mod examples;

use std::num::NonZeroU32;
use std::path::PathBuf;

use clap::builder::Styles;
use clap::builder::styling::AnsiColor;
use clap::{Args, Parser, Subcommand, ValueEnum};

use leadscrew_can::{Address, BitRate, MachineName, WrongAddress};
use leadscrew_core::alarm::Lang;
use leadscrew_core::bus::NodeId;
use leadscrew_core::units::Axis;
use leadscrew_desk::control::{Contact, Door, Level, Power, Turret};
use leadscrew_language::dialect::Control;

pub use by_hand::{AxisWay, Jog, ModeName, StepLength, Tune, Wheel};

use crate::failure::{Failure, Outcome};
use crate::inspection::edge::{Edge, Millimetres};
use crate::profiles::Choice;
use crate::values::{At, Factor, Mistake, Percent, Ripple, SetSignal, Tolerance, mistake};
use crate::words::both;

const STYLES: Styles = Styles::styled()
    .header(AnsiColor::Green.on_default().bold())
    .usage(AnsiColor::Green.on_default().bold())
    .literal(AnsiColor::Cyan.on_default().bold())
    .placeholder(AnsiColor::Cyan.on_default());

/// Lathe threading and grooving cycles: from program text to drive setpoints.
#[derive(Debug, Parser)]
#[command(name = "leadscrew", version, about = "Lathe threading and grooving cycles: from program text to drive setpoints", after_help = examples::ALL, styles = STYLES, max_term_width = 110)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
    /// What holds for every command.
    #[command(flatten)]
    pub global: Global,
}

/// The variable that names the bus where `--bus` does not.
pub const BUS: &str = "LEADSCREW_BUS";

impl Cli {
    /// Decides which bus counts: the one that was typed, else that of the variable, else `sim`. A command that has no bus,
    /// or works on a file (`--state`), is not changed by the variable [D278].
    ///
    /// # Errors
    /// [`Failure::Usage`] where the variable names no bus.
    pub fn settle(&mut self) -> Outcome {
        let without = matches!(
            self.command,
            Command::Simulate(_)
                | Command::Plot(_)
                | Command::Explain(_)
                | Command::Drives { .. }
                | Command::Measure(_)
                | Command::Completions { .. }
        );
        let global = &mut self.global;
        if let Some(bus) = &global.typed_bus {
            global.bus = bus.clone();
            return Ok(());
        }
        let named = std::env::var_os(BUS).filter(|named| !named.is_empty());
        let Some(named) = named.filter(|_| !without && global.state.is_none()) else {
            return Ok(());
        };
        let named = named.to_string_lossy();
        global.bus = named.parse().map_err(|wrong: WrongAddress| {
            Failure::Usage(both!(
                "the variable {BUS} is `{named}`: {wrong}",
                "变量 {BUS} 的值是 `{named}`：{zh}",
                zh = wrong.chinese()
            ))
        })?;
        Ok(())
    }
}

/// Options that every command takes.
#[derive(Args, Debug)]
#[command(next_help_heading = "Options of every command")]
pub struct Global {
    /// Where the machine is: `sim`, `sim:NAME`, a SocketCAN interface (`can0`, `socketcan:can0`), or an adapter:
    /// `slcan:/dev/ttyACM0[@BAUD]`, `slcan:tcp:HOST:PORT`, `slcan:unix:PATH` [default: $LEADSCREW_BUS, else sim]
    ///
    /// `sim` is a simulated board with drives and a spindle inside this process; it needs no device and no privileges.
    /// `sim:NAME` is a simulated machine that `leadscrew up` keeps running. All but `sim` talk to a board, whose own
    /// parameters then count. `simulate` and `plot`, and every command with `--state`, are without a bus, whatever
    /// LEADSCREW_BUS says.
    #[arg(id = "bus", long = "bus", global = true, value_name = "BUS")]
    pub typed_bus: Option<Address>,
    /// The bus that counts: see [`Cli::settle`].
    #[arg(skip = Address::Sim)]
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
    ///
    /// The nearest `leadscrew.toml`, in the folder of the program or above, is read first.
    #[arg(long, global = true, value_name = "FILE")]
    pub params: Vec<PathBuf>,
    /// Tool table for programs that are read without a board: offsets, radius and tip come from it
    ///
    /// A board has a table of its own (`leadscrew tools`), and runs no program that was resolved with another. Without any
    /// table the parameters 1221 to 1226, 9101 to 9132, 9201 to 9216 and 9301 to 9316 count.
    #[arg(long, global = true, value_name = "FILE.toml")]
    pub tools: Option<PathBuf>,
    /// One parameter, after all files: `182.7=1`, `1420.X=12000`, `rapid_rate.X=12m/min` (repeatable)
    ///
    /// A value without a unit has the one that `leadscrew params docs` prints.
    #[arg(long, global = true, value_name = "NO[.BIT|.AXIS]=VALUE")]
    pub set: Vec<String>,
    /// The control that the program was written for [default: what the machine file says, else gsk980td]
    ///
    /// A comment `(DIALECT HAAS)` in the first lines of a program wins.
    #[arg(long, global = true, value_enum)]
    pub dialect: Option<DialectName>,
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
    /// File that keeps the variables #500 to #999 from run to run [default: `leadscrew.variables` beside `leadscrew.toml`]
    ///
    /// Without a `leadscrew.toml` it is `leadscrew/leadscrew.variables` in the folder for the state of programs
    /// (`$XDG_STATE_HOME`, else `~/.local/state`). Every command that reads a program reads it; the end of a `run` alone
    /// writes it, in one step.
    #[arg(long, global = true, value_name = "FILE")]
    pub variables: Option<PathBuf>,
    /// An input at the start (repeatable): G61.2, RGTAP, SWS1 to SWS4, RGTSP1 to RGTSP4
    #[arg(long, global = true, value_name = "NAME=0|1")]
    pub signal: Vec<SetSignal>,
    /// Takes the simulated board's power away at this tick (with `--state`)
    #[arg(long, global = true, value_name = "TICK")]
    pub cut_power: Option<u64>,
}

/// A bit rate that a Lawicel adapter can be set to.
fn bit_rate(text: &str) -> Result<BitRate, Mistake> {
    let rate = text.parse().ok().and_then(BitRate::of_kbit);
    rate.ok_or_else(|| {
        mistake!(
            "an adapter has 10, 20, 50, 100, 125, 250, 500, 800 and 1000 kbit/s",
            "适配器的波特率有 10、20、50、100、125、250、500、800 和 1000 kbit/s"
        )
    })
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
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum DialectName {
    /// GSK 980TD.
    Gsk980td,
    /// GSK 988.
    Gsk988,
    /// FANUC lathe, G-code system A.
    FanucA,
    /// FANUC lathe, G-code system B.
    FanucB,
    /// FANUC lathe, G-code system C.
    FanucC,
    /// Haas lathe.
    Haas,
}

impl DialectName {
    /// The control.
    #[must_use]
    pub const fn control(self) -> Control {
        match self {
            Self::Gsk980td => Control::Gsk980td,
            Self::Gsk988 => Control::Gsk988,
            Self::FanucA => Control::FanucA,
            Self::FanucB => Control::FanucB,
            Self::FanucC => Control::FanucC,
            Self::Haas => Control::Haas,
        }
    }
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
    #[command(after_help = examples::CHECK)]
    Check(Check),
    /// Print the move list
    #[command(after_help = examples::EXPAND)]
    Expand(Expand),
    /// Compute the setpoints, tick by tick, in virtual time
    #[command(after_help = examples::SIMULATE)]
    Simulate(Simulate),
    /// Draw the X–Z tool path, and speed and synchronism over time
    #[command(after_help = examples::PLOT)]
    Plot(Plot),
    /// Cut the threads of a program on the simulated machine, and measure them as an inspector does
    #[command(after_help = examples::MEASURE)]
    Measure(Measure),
    /// Check all of a program, upload it and run it
    #[command(after_help = examples::RUN)]
    Run(Run),
    /// The parameter table: what there is, what it is set to, whether it can work
    #[command(after_help = examples::PARAMS)]
    Params {
        /// What to do with it
        #[command(subcommand)]
        command: ParamsCommand,
    },
    /// The tool table that a board keeps: geometry, wear, nose
    #[command(after_help = examples::TOOLS)]
    Tools {
        /// What to do with it
        #[command(subcommand)]
        command: ToolsCommand,
    },
    /// Profiles of drives: what is known of them, and from where
    #[command(after_help = examples::DRIVES)]
    Drives {
        /// What to print
        #[command(subcommand)]
        command: DrivesCommand,
    },
    /// The work offsets G54 to G59 and their shift, in the same table
    #[command(after_help = examples::OFFSETS)]
    Offsets {
        /// What to do with them
        #[command(subcommand)]
        command: OffsetsCommand,
    },
    /// Touch off: a tool stands where the work has a known coordinate, and its geometry or the work offset follows
    #[command(after_help = examples::TOUCH)]
    Touch(Touch),
    /// Check and run a line that is typed, behind the lines typed before (not with `--bus sim`)
    ///
    /// What the lines before have set holds on: modes, coordinate system, tool offset, F and S. It is told before the line
    /// and behind it. It begins anew behind `run`, M30, and each time the board starts. Cycles, G41, G42 and G61 end
    /// with their line.
    #[command(after_help = examples::MDI)]
    Mdi {
        /// One or more blocks; without, lines are asked for one by one
        #[arg(value_name = "LINE", allow_hyphen_values = true)]
        line: Option<String>,
    },
    /// One look at the board; with `sim`, at what the flash in `--state` remembers
    ///
    /// Without `--node` it names the other boards on the bus, too, which takes as long as they are silent at a time.
    #[command(after_help = examples::STATUS)]
    Status,
    /// The panel: a live view of the board, and keys that operate it (not with `--bus sim`)
    ///
    /// `?` shows the keys. An axis moves while its arrow key is held where the terminal tells when a key is let go (kitty's
    /// keyboard protocol); else arrows are steps.
    #[command(after_help = examples::MONITOR)]
    Monitor {
        /// Look only: no key but q does anything
        #[arg(long)]
        watch: bool,
    },
    /// Feed hold (not with `--bus sim`)
    #[command(after_help = examples::HOLD)]
    Hold,
    /// Go on after a hold (not with `--bus sim`)
    #[command(after_help = examples::RESUME)]
    Resume,
    /// Reset the board (not with `--bus sim`)
    #[command(after_help = examples::RESET)]
    Reset,
    /// Controlled stop (not with `--bus sim`)
    #[command(after_help = examples::STOP)]
    Stop,
    /// Change the mode of the machine (not with `--bus sim`)
    #[command(after_help = examples::MODE)]
    Mode {
        /// Which one
        #[arg(value_enum)]
        mode: ModeName,
    },
    /// Move an axis by hand (not with `--bus sim`)
    ///
    /// The board moves only while this program lives: it comes to rest by itself when the frames stay away.
    #[command(after_help = examples::JOG)]
    Jog(Jog),
    /// Move an axis to and fro and find the lag of its drive (not with `--bus sim`)
    ///
    /// It jogs at three speeds, twice: limits, interlocks and the dead man hold as for `jog`.
    #[command(after_help = examples::TUNE)]
    Tune(Tune),
    /// Turn a simulated handwheel that leads an axis, or a program (not with `--bus sim`)
    ///
    /// Its frames go over the bus, as those of a real one.
    #[command(after_help = examples::WHEEL)]
    Wheel(Wheel),
    /// Find the references of the axes, and wait for the end (not with `--bus sim`)
    #[command(after_help = examples::HOME)]
    Home {
        /// Which ones; all that have a way to home (9050) where none is named
        #[arg(value_enum, ignore_case = true)]
        axes: Vec<HomeAxis>,
    },
    /// Set an override (not with `--bus sim`)
    #[command(after_help = examples::OVERRIDE)]
    Override {
        /// Which one
        #[arg(value_enum)]
        what: OverrideName,
        /// Whole percent: feed 0 to 150, rapid 0 to 100, spindle 50 to 120
        #[arg(allow_negative_numbers = true)]
        percent: Percent,
    },
    /// Set an input (not with `--bus sim`)
    #[command(after_help = examples::SIGNAL)]
    Signal {
        /// `NAME=0` or `NAME=1`
        #[arg(value_name = "NAME=0|1")]
        signal: SetSignal,
    },
    /// Inputs and outputs of the machine by their names: list, switch, wait (not with `--bus sim`)
    ///
    /// Names are those of the machine file (`[io.NAME]`): of `--params`, else of the nearest `leadscrew.toml`.
    #[command(after_help = examples::IO)]
    Io {
        /// What to do
        #[command(subcommand)]
        command: IoCommand,
    },
    /// Brings a tap out of its hole in phase, the same as G30 P99
    ///
    /// With `--dry-run` it only shows what would move.
    #[command(after_help = examples::RETRACT)]
    Retract {
        /// Spindle speed in turns per minute
        #[arg(long, value_name = "RPM", conflicts_with = "discard", value_parser = clap::value_parser!(u32).range(1..=9999))]
        speed: Option<u32>,
        /// Drop the record instead: no tap is in a hole
        #[arg(long)]
        discard: bool,
    },
    /// Keep a simulated machine running, for other commands with `--bus sim:NAME`
    ///
    /// It comes back once the machine answers. The machine goes on in the background until `leadscrew down`; its flash and
    /// its log are in the folder `leadscrew/NAME` of `$XDG_STATE_HOME`, else of `~/.local/state`.
    #[command(after_help = examples::UP)]
    Up(Up),
    /// End a simulated machine that `up` keeps running
    #[command(after_help = examples::DOWN)]
    Down {
        /// Which one [default: the one of `--bus sim:NAME` or LEADSCREW_BUS, else desk]
        #[arg(long, value_name = "NAME")]
        name: Option<MachineName>,
    },
    /// What happens around a simulated machine that `up` keeps running: door, emergency stop, power, time
    #[command(after_help = examples::SIM)]
    Sim {
        /// Which one [default: the one of `--bus sim:NAME` or LEADSCREW_BUS, else desk]
        #[arg(long, value_name = "NAME")]
        name: Option<MachineName>,
        /// What happens
        #[command(subcommand)]
        command: SimCommand,
    },
    /// Capture the bus into a file, until Ctrl-C
    #[command(after_help = examples::RECORD)]
    Record(Record),
    /// Say what is set up wrong on a bus, from what is heard on it or from a candump log
    #[command(after_help = examples::DOCTOR)]
    Doctor(Doctor),
    /// Say what an alarm or a warning means, what to do, and which program raises it
    #[command(after_help = examples::EXPLAIN)]
    Explain(Explain),
    /// Print a completion script for a shell
    #[command(after_help = examples::COMPLETIONS)]
    Completions {
        /// Which shell
        #[arg(value_enum)]
        shell: clap_complete::Shell,
    },
}

/// `explain`.
#[derive(Args, Debug)]
pub struct Explain {
    /// The numbers; without any, a list of all
    #[arg(value_name = "NUMBER")]
    pub numbers: Vec<u16>,
    /// All of them as Markdown, a page of the manual
    #[arg(long, conflicts_with = "numbers")]
    pub docs: bool,
}

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

/// The drives of the simulated axes.
#[derive(Args, Debug, Default)]
pub struct Drives {
    /// Drive of X and Z, or of one axis, by its profile (`leadscrew drives list`): `kv30`, `Z=technosoft-ipos`, `X=my.toml`
    /// (repeatable) [default: ideal]
    #[arg(long, value_name = "[AXIS=]NAME")]
    pub drive: Vec<Choice>,
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

/// `simulate`.
#[derive(Args, Debug)]
pub struct Simulate {
    /// Program
    #[arg(value_name = "PROG")]
    pub program: PathBuf,
    /// Where the setpoints go, one row a tick
    #[arg(short, long, value_name = "FILE.csv")]
    pub output: Option<PathBuf>,
    /// The drives.
    #[command(flatten)]
    pub drives: Drives,
    /// The plant.
    #[command(flatten)]
    pub drive: Drive,
    /// Fail (exit 1) when the worst synchronism error of a thread or a hole is above this many micrometres
    #[arg(long, value_name = "UM", allow_negative_numbers = true)]
    pub tolerance: Option<Tolerance>,
}

/// `plot`.
#[derive(Args, Debug)]
pub struct Plot {
    /// Program
    #[arg(value_name = "PROG")]
    pub program: PathBuf,
    /// Where the picture goes; the ending chooses the format (`png` is not available yet)
    ///
    /// `.html` is one file that a browser opens without a network: it zooms, tells the line under the pointer, and plays.
    #[arg(short, long, value_name = "FILE.{svg,html}")]
    pub output: PathBuf,
    /// The tool path alone, near the part: nothing is run, so there is nothing over time
    #[arg(long, conflicts_with_all = ["spindle_ripple", "tick_us"])]
    pub path: bool,
    /// The plant.
    #[command(flatten)]
    pub drive: Drive,
}

/// `measure`.
#[derive(Args, Debug)]
pub struct Measure {
    /// Program
    #[arg(value_name = "PROG")]
    pub program: PathBuf,
    /// What a thread should be: `M40x3-6g`, `M30x4P2-6H`, `1/4-20UNC-2A`, `1/2-14NPT` (repeatable: one for all, or one for
    /// each) [default: a guess by pitch, angle and diameter, which is said]
    #[arg(long, value_name = "NAME")]
    pub thread: Vec<String>,
    /// The edge of a tool: `V60:r0.1`, `T3=V30/27:f0.2` (repeatable) [default: the thread's angle and the norm's root
    /// radius, which is said]
    ///
    /// V and the angle between the flanks, or both from the normal of the axis, that towards -Z first; `:r` the radius of
    /// the tip, `:f` its width, mm.
    #[arg(long, value_name = "[TN=]EDGE")]
    pub tool: Vec<Edge>,
    /// Diameter of the surface before the cut, at the face [default: what the cycle's height says, else the middle of the
    /// norm's limits]
    #[arg(long, value_name = "MM")]
    pub surface: Option<Millimetres>,
    /// Z of the face in work coordinates [default: 0, or where the strokes begin]
    #[arg(long, value_name = "MM", allow_hyphen_values = true)]
    pub face: Option<Millimetres>,
    /// Where the result goes; the ending chooses the format: `json` all figures, `svg` a picture, `html` picture and sheet
    #[arg(short, long, value_name = "FILE.{svg,html,json}")]
    pub output: Option<PathBuf>,
    /// The plant.
    #[command(flatten)]
    pub drive: Drive,
    /// Its drives.
    #[command(flatten)]
    pub drives: Drives,
}

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

/// `run`.
#[derive(Args, Debug, Default)]
pub struct Run {
    /// Program
    #[arg(value_name = "PROG")]
    pub program: PathBuf,
    /// Start at this line of the file: the lines before are read without motion, and the line's number has to be typed
    #[arg(long, value_name = "LINE")]
    pub from: Option<NonZeroU32>,
    /// With `--from`: begin without asking
    #[arg(long, requires = "from")]
    pub yes: bool,
    /// End after this many passes of a main program that M99 begins again [default: no end]
    #[arg(long, value_name = "N")]
    pub passes: Option<NonZeroU32>,
    /// Go along the path as a handwheel is turned (not with `--bus sim`); threads and taps ask for a start
    #[arg(long)]
    pub handwheel: bool,
    /// Write the bus traffic as a candump log
    #[arg(long, value_name = "FILE")]
    pub record: Option<PathBuf>,
    /// The drives.
    #[command(flatten)]
    pub drives: Drives,
    /// The plant.
    #[command(flatten)]
    pub drive: Drive,
    /// Fail (exit 1) when the worst synchronism error of a thread or a hole is above this many micrometres
    #[arg(long, value_name = "UM", allow_negative_numbers = true)]
    pub tolerance: Option<Tolerance>,
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
        #[arg(value_name = "N", value_parser = clap::value_parser!(u8).range(1..=16))]
        number: u8,
        /// How it is then; `auto`: as the simulated devices have it
        #[arg(value_enum)]
        to: Level,
    },
    /// Spoil the turret, or mend it
    #[command(after_help = examples::SIM_TURRET)]
    Turret {
        /// How it is then
        #[arg(value_enum)]
        to: Turret,
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

/// The axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum HomeAxis {
    /// Cross slide.
    #[value(name = "X")]
    X,
    /// Carriage.
    #[value(name = "Z")]
    Z,
    /// Rotary axis.
    #[value(name = "C")]
    C,
}

impl HomeAxis {
    /// The axis.
    #[must_use]
    pub const fn axis(self) -> Axis {
        match self {
            Self::X => Axis::X,
            Self::Z => Axis::Z,
            Self::C => Axis::C,
        }
    }
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

impl OverrideName {
    /// The lowest and the highest percentage.
    #[must_use]
    pub const fn range(self) -> (u8, u8) {
        match self {
            Self::Feed => (0, 150),
            Self::Rapid => (0, 100),
            Self::Spindle => (50, 120),
        }
    }
}

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
    #[arg(required = true, value_name = "KEY=VALUE")]
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
