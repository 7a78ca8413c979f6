//! What can be typed: commands, options, and their help. Parsing only; nothing is done here.
//!
//! The list of all commands is here, with what holds for each of them; the arguments of a family of commands have a file
//! of their own.

mod agent;
mod by_hand;
pub mod chinese;
mod examples;
mod fleet;
mod machine;
mod params;
mod programs;
mod tools;

use std::path::PathBuf;

use clap::builder::Styles;
use clap::builder::styling::AnsiColor;
use clap::{Args, Parser, Subcommand, ValueEnum};

use leadscrew_can::{Address, BitRate, MachineName, WrongAddress};
use leadscrew_core::alarm::Lang;
use leadscrew_core::bus::NodeId;
use leadscrew_language::dialect::Control;

pub use agent::{Access, Agent, Board};
pub use by_hand::{
    AxisWay, HandWay, Handwheel, HomeAxis, Jog, ModeName, OverrideName, StepLength, Tune, Tuned,
};
pub use fleet::{Asked, FleetCommand};
pub use machine::{Doctor, DrivesCommand, IoCommand, Record, SimCommand, Up};
pub use params::{Diff, Migrate, ParamsCommand, Pull, Push, Restore, Write};
pub use programs::{Check, Drive, Drives, Expand, Format, Measure, Plot, Run, Simulate};
pub use tools::{
    Assign, AxisName, DiffTools, OffsetsCommand, Pickup, PullTools, PushTools, SystemName,
    ToolsCommand, Touch,
};

use crate::failure::{Failure, Outcome};
use crate::values::{At, Mistake, Percent, SetSignal, mistake};
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
                | Command::Fleet { .. }
                | Command::Completions { .. }
                | Command::Man { .. }
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
#[derive(Args, Clone, Debug)]
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
    /// Stop after every block and every pass: `=on`, which may be left out, or `=off` (with `sim` it passes at once)
    ///
    /// For run, mdi, retract, resume, panel and monitor. It sets the switch of the machine, which stays so; without this
    /// option the switch stays as it is.
    #[arg(
        long,
        global = true,
        value_name = "on|off",
        value_parser = on_or_off,
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "on"
    )]
    pub single_block: Option<bool>,
    /// Use the dry-run feed for every feed; thread strokes keep their lead
    ///
    /// This option alone makes a dry run: no switch of the machine does.
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

/// A switch that is set.
fn on_or_off(text: &str) -> Result<bool, Mistake> {
    match text {
        "on" => Ok(true),
        "off" => Ok(false),
        _ => Err(mistake!("it is `on` or `off`", "只能是 `on` 或 `off`")),
    }
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
    /// Pick a thread up: the tip stands in a groove that was cut before, and all threads follow this groove
    ///
    /// The spindle stands, after at least one turn since power-up. What is kept is the place of the tip and the angle of
    /// the spindle there, in the table of offsets, over a loss of power. G32, G76, G78 and G92 begin so that their last
    /// pass runs in that groove, from wherever they start and with any tool; G34 is refused. Without an option it tells
    /// what is picked up.
    #[command(after_help = examples::PICKUP)]
    Pickup(Pickup),
    /// Check and run a line that is typed, after the lines typed before (not with `--bus sim`)
    ///
    /// What the lines before have set holds on: modes, coordinate system, tool offset, F and S. It is told before the line
    /// and after it. It begins anew after `run`, M30, and each time the board starts. Cycles, G41, G42 and G61 end
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
    /// The page at the machine: it shows the board on a tablet and operates it, in a browser (not with `--bus sim`)
    ///
    /// It prints two links with tokens that are new at each start: one to operate, one to look only. It ends with Ctrl-C.
    #[command(after_help = examples::PANEL)]
    Panel {
        /// Where it listens; beyond this computer only behind a proxy with TLS
        #[arg(long, value_name = "ADDRESS", default_value = "127.0.0.1:8080")]
        listen: std::net::SocketAddr,
        /// The name by which a proxy with TLS is reached, with its port where that is not 443; may be given several times
        #[arg(long = "host", value_name = "NAME")]
        hosts: Vec<String>,
        /// No link to operate: the page looks only
        #[arg(long)]
        look: bool,
        /// A folder of programs that the page lists, shows, changes and starts; without it the page has none
        #[arg(long, value_name = "DIR")]
        programs: Option<PathBuf>,
    },
    /// Tell a broker and a metrics store what the machine does (not with `--bus sim`)
    ///
    /// It reads the board and never moves anything; no broker can make it. What it tells is kept in a file first, until the
    /// broker has it. It stays until it is interrupted, whether a board or a broker is there or not. docs/agent.md says
    /// what leaves the machine.
    #[command(after_help = examples::AGENT)]
    Agent(Agent),
    /// The parameters of all machines, as their agents have told a broker: which differ, since when, in what
    ///
    /// It reads and compares; it changes nothing. `params push` at the machine does.
    #[command(after_help = examples::FLEET)]
    Fleet {
        /// What to do
        #[command(subcommand)]
        command: FleetCommand,
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
    /// Move an axis, or turn the spindle, by hand (not with `--bus sim`)
    ///
    /// The board moves only while this program lives: it comes to rest by itself when the frames stay away.
    #[command(after_help = examples::JOG)]
    Jog(Jog),
    /// Find the lag of an axis' drive, or ramp and ripple of the spindle (not with `--bus sim`)
    ///
    /// It jogs at three speeds, twice: limits, interlocks and the dead man hold as for `jog`. With `spindle` it runs the
    /// spindle up to the speeds that are named, as typed lines would, and finds its ramp and how its speed varies.
    #[command(after_help = examples::TUNE)]
    Tune(Tune),
    /// Turn a simulated handwheel that leads an axis, or a program (not with `--bus sim`)
    ///
    /// Its frames go over the bus, as those of a real one.
    #[command(after_help = examples::HANDWHEEL)]
    Handwheel(Handwheel),
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
    /// Print a manual page, or write all of them into a folder
    #[command(after_help = examples::MAN)]
    Man {
        /// The command, with its verb where it has one [default: `leadscrew` itself]
        #[arg(value_name = "COMMAND")]
        command: Vec<String>,
        /// Write the page of every command into this folder
        #[arg(long, value_name = "FOLDER", conflicts_with = "command")]
        to: Option<PathBuf>,
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
