//! The command line.

use std::path::PathBuf;
use std::str::FromStr;

use clap::{Args, Parser, Subcommand};
use leadscrew_board_sim::plant::{self, BlockOptions, DriveOptions, PlantOptions, ServoOptions};
use leadscrew_can::{Address, MachineName};
use leadscrew_common::diagnostics;
use leadscrew_common::failure::{Failure, Outcome};
use leadscrew_common::params;
use leadscrew_common::profiles::{Choice, Chosen};
use leadscrew_common::values::{At, Ripple, SetSignal};
use leadscrew_core::alarm::Lang;
use leadscrew_core::bus::NodeId;
use leadscrew_core::call::Position;
use leadscrew_core::params::Params;
use leadscrew_core::units::{Angle, Axis, Length};

use crate::spoil;
use crate::when::{Disturbance, Slip, Trouble};

const EXAMPLES: &str = "\
Examples:
  board-sim --bus vcan0                                     a lathe in real time, until Ctrl-C
  board-sim --bus vcan0 --lockstep                          the same in virtual time, for tests
  board-sim --bus vcan0 --name desk                         with a hand at it: `leadscrew sim door open`
  board-sim --bus vcan0 --drives elsewhere                  with the axis drives in another process:
  board-sim drives --bus vcan0
  board-sim drives --bus can0 --axes X,C --spindles           beside a real board that has its drive of Z, and no other yet
  board-sim --bus vcan0 --trouble X=fault:7305@4000         a drive that fails four seconds after the start
  board-sim --bus vcan0 --bus-off 4000..4500                its controller leaves the bus, and comes back
  board-sim --bus vcan0 --lose all=5 --swap all=2 --seed 7  a bad wire
  board-sim --bus vcan0 --lockstep --program part.nc        runs a program by itself, then ends

A virtual bus: ip link add dev vcan0 type vcan && ip link set vcan0 mtu 72 up";

/// A simulated board with its drives, spindle and encoder, on a real CAN bus.
#[derive(Debug, Parser)]
#[command(
    name = "board-sim",
    version,
    after_help = EXAMPLES,
    args_conflicts_with_subcommands = true,
    subcommand_negates_reqs = true,
    max_term_width = 110
)]
pub struct Cli {
    /// Something else than a board.
    #[command(subcommand)]
    pub command: Option<Command>,
    /// The board.
    #[command(flatten)]
    pub board: Board,
}

/// What else there is.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Drives alone, for a board in another process or a real one: of the axes, and of spindles
    Drives(Drives),
}

/// The machine and the bus.
#[derive(Args, Debug)]
pub struct Common {
    /// The bus: an interface (`vcan0`, `socketcan:can0`) or `slcan:…`
    #[arg(long, value_name = "BUS", required = true)]
    pub bus: Option<Address>,
    /// Parameter file of the machine (repeatable; later files win)
    #[arg(long, value_name = "FILE")]
    pub params: Vec<PathBuf>,
    /// One parameter, after all files (repeatable)
    #[arg(long, value_name = "NO[.BIT|.AXIS]=VALUE")]
    pub set: Vec<String>,
    /// Where the machine powers up, in machine coordinates, X a diameter: `X=100,Z=50`
    #[arg(long, value_name = "X=…,Z=…", allow_hyphen_values = true)]
    pub at: Option<At>,
    /// Drives answer every N-th SYNC
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u8).range(1..=240))]
    pub transmission: u8,
    /// SYNC periods that each change of a drive's power state takes
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub settling: u16,
    /// Time constant of the following lag of ideal drives, in SYNC periods
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub lag: u16,
    /// Drives tell emergency 8220h of every frame with their setpoint that is longer than what they map
    #[arg(long)]
    pub tells_longer: bool,
    /// Drive of X and Z, or of one axis, by its profile (`leadscrew drives list`): `kv30`, `Z=technosoft-ipos`, `X=my.toml`
    /// (repeatable) [default: ideal]
    #[arg(long, value_name = "[AXIS=]NAME")]
    pub drive: Vec<Choice>,
}

/// A board.
#[derive(Args, Debug)]
pub struct Board {
    /// The machine and the bus.
    #[command(flatten)]
    pub common: Common,
    /// A name: `leadscrew sim --name NAME` is then a hand at this machine, as at one of `leadscrew up`
    #[arg(long, value_name = "NAME")]
    pub name: Option<MachineName>,
    /// CANopen node of the board, 1 to 126, and none of its drives'
    #[arg(long, value_name = "N", default_value = "1", value_parser = board_node)]
    pub node: NodeId,
    /// Virtual time: a tick waits for the drives' answers and for the program, and for no clock
    #[arg(long)]
    pub lockstep: bool,
    /// Where the axis drives are: `here`, `elsewhere` on the bus, or the axes whose drives are here (`X,Z`)
    #[arg(long, value_name = "here|elsewhere|AXES", default_value = "here")]
    pub drives: Here,
    /// Where the block of inputs and outputs (9461) is: `here`, here and as delivered (`fresh`), `elsewhere` on the bus, or
    /// here at another node than the parameters say
    #[arg(long, value_name = "here|fresh|elsewhere|NODE", default_value = "here", value_parser = block)]
    pub block: BlockOptions,
    /// Speed ripple of the spindle: a sine of PERCENT of the commanded speed, as `10@5`
    #[arg(long, value_name = "PERCENT@HZ")]
    pub spindle_ripple: Option<Ripple>,
    /// An input from the start (repeatable)
    #[arg(long, value_name = "NAME=0|1")]
    pub signal: Vec<SetSignal>,
    /// Trouble of a drive from a tick on (repeatable): silent, cut-off, stuck,
    /// torque-off, fault:CODE, none; or once: restart
    #[arg(long, value_name = "X|Z|C|S=WHAT@TICK")]
    pub trouble: Vec<Trouble>,
    /// The encoder loses or gains counts at a tick (repeatable)
    #[arg(long, value_name = "COUNTS@TICK", allow_hyphen_values = true)]
    pub slip: Vec<Slip>,
    /// The encoder's index stays out from this tick on
    #[arg(long, value_name = "TICK")]
    pub lost_index: Option<u64>,
    /// The spindle is dragged to so many percent of its speed from a tick on (repeatable; negative: backwards)
    #[arg(long, value_name = "PERCENT@TICK", allow_hyphen_values = true)]
    pub drag: Vec<Disturbance>,
    /// What goes wrong with the wire and with the storage.
    #[command(flatten)]
    pub spoil: spoil::Options,
    /// Seed of every noise source
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// File that keeps the simulated flash between runs
    #[arg(long, value_name = "FILE")]
    pub state: Option<PathBuf>,
    /// Runs this program by itself once the drives are up, then ends
    #[arg(long, value_name = "PROG")]
    pub program: Option<PathBuf>,
    /// Nothing more of `--program` comes meanwhile, as from a gateway that hangs
    #[arg(long, value_name = "TICK[..TICK]", requires = "program")]
    pub stall: Option<spoil::Ticks>,
    /// The version of the link that the board says it speaks, as its key, instead of its own
    #[arg(long, value_name = "HEX", value_parser = key)]
    pub link_key: Option<u32>,
    /// Ends after so many ticks
    #[arg(long, value_name = "N")]
    pub ticks: Option<u64>,
}

/// A node number other than the gateway's. The drives' numbers are checked when the parameters are known.
fn board_node(text: &str) -> Result<NodeId, String> {
    let number = text.parse().ok().and_then(NodeId::new);
    let node = number.ok_or("expected a number from 1 to 126")?;
    if node == NodeId::GATEWAY {
        return Err(format!(
            "{text} is the gateway's; a board needs one of its own"
        ));
    }
    Ok(node)
}

/// How the block of inputs and outputs is.
fn block(text: &str) -> Result<BlockOptions, String> {
    let here = BlockOptions::default();
    Ok(match text {
        "here" => here,
        "fresh" => BlockOptions {
            fresh: true,
            ..here
        },
        "elsewhere" => BlockOptions { away: true, ..here },
        node => BlockOptions {
            node: Some(board_node(node)?),
            ..here
        },
    })
}

/// A key of eight hexadecimal digits.
fn key(text: &str) -> Result<u32, String> {
    let digits = text.strip_prefix("0x").unwrap_or(text);
    // Exactly eight digits, without a sign; the standard library would accept a sign.
    let eight = digits.len() == 8 && digits.bytes().all(|byte| byte.is_ascii_hexdigit());
    let key = u32::from_str_radix(digits, 16).ok().filter(|_| eight);
    key.ok_or_else(|| format!("`{text}`: expected a key of eight digits, as `0123abcd`"))
}

/// Drives alone.
#[derive(Args, Debug)]
pub struct Drives {
    /// The machine and the bus.
    #[command(flatten)]
    pub common: Common,
    /// Which axes: `X,C`, or `elsewhere` for none
    #[arg(long, value_name = "AXES", default_value = "X,Z,C")]
    pub axes: Here,
    /// The drives of the spindles as well, as many as 9014 says there are. They turn in taps, and not for M3
    #[arg(long)]
    pub spindles: bool,
    /// Number of the board that is their master: where setpoints come in one frame (9031), that is the board's
    #[arg(long, value_name = "NODE", default_value = "1", value_parser = board_node)]
    pub board: NodeId,
}

impl Drives {
    /// The plant to which these drives belong.
    pub fn plant(&self) -> PlantOptions {
        PlantOptions {
            board: Some(self.board),
            ..self.common.plant()
        }
    }
}

/// The axes whose drives are here, in the order of [`Axis::ALL`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Here(pub [bool; 3]);

impl FromStr for Here {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "here" => return Ok(Self([true; 3])),
            "elsewhere" => return Ok(Self([false; 3])),
            _ => {}
        }
        let mut here = [false; 3];
        for name in text.split(',') {
            let axis = Axis::ALL.into_iter().position(|axis| {
                name.trim()
                    .eq_ignore_ascii_case(&char::from(axis.letter()).to_string())
            });
            match axis.and_then(|axis| here.get_mut(axis)) {
                Some(place) => *place = true,
                None => {
                    return Err(format!(
                        "`{name}`: expected `here`, `elsewhere`, or axes as `X,Z`"
                    ));
                }
            }
        }
        Ok(Self(here))
    }
}

impl Common {
    /// The bus; the command line always gives one.
    pub fn address(&self) -> &Address {
        self.bus.as_ref().unwrap_or(&Address::Sim)
    }

    /// The parameters. Prints everything that is wrong with them.
    pub fn load(&self) -> Outcome<Params> {
        let loaded = params::load(&self.params, &self.set, Lang::En)?;
        loaded.tell(diagnostics::colour());
        if loaded.is_good() {
            Ok(loaded.params)
        } else {
            Err(Failure::Wrong)
        }
    }

    /// The drives of X and Z by their profiles.
    pub fn drives(&self) -> Outcome<Chosen> {
        Chosen::of(&self.drive, Lang::En)
    }

    /// The same on a machine with these parameters.
    pub fn servos(&self, params: &Params) -> Outcome<[Option<ServoOptions>; 2]> {
        self.drives()?.servos(params)
    }

    /// The options of the plant, without the spindle.
    pub fn plant(&self) -> PlantOptions {
        let at = self.at.unwrap_or_default();
        PlantOptions {
            at: Position {
                x: Length::from_nm(at.x_nm),
                z: Length::from_nm(at.z_nm),
                c: Angle::from_udeg(at.c_udeg),
            },
            drives: DriveOptions {
                transmission: self.transmission,
                start: 0,
                settling: self.settling,
                lag: self.lag,
                tells_longer: self.tells_longer,
            },
            ..PlantOptions::default()
        }
    }
}

impl Board {
    /// The options of the plant.
    pub fn plant(&self) -> Option<PlantOptions> {
        let ripple = match self.spindle_ripple {
            None => None,
            Some(ripple) => Some(plant::Ripple::new(ripple.milli_percent, ripple.milli_hz)?),
        };
        let Here(here) = self.drives;
        Some(PlantOptions {
            ripple,
            away: here.map(|here| !here),
            board: Some(self.node),
            block: self.block,
            ..self.common.plant()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_options_fit_together() {
        use clap::CommandFactory as _;
        Cli::command().debug_assert();
    }

    #[test]
    fn a_board_has_a_number_of_its_own() {
        assert_eq!(board_node("1"), Ok(NodeId::BOARD));
        assert_eq!(board_node("126"), Ok(NodeId::new(126).unwrap()));
        for wrong in ["0", "128", "x", "127"] {
            assert!(board_node(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_key_has_eight_digits() {
        assert_eq!(key("0123abcd"), Ok(0x0123_ABCD));
        assert_eq!(key("0xFFFFFFFF"), Ok(u32::MAX));
        for wrong in ["", "0x", "123abcd", "00123abcd", "+123abcd", "0123abcg"] {
            assert!(key(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn drives_are_here_or_not() {
        assert_eq!("here".parse(), Ok(Here([true; 3])));
        assert_eq!("elsewhere".parse(), Ok(Here([false; 3])));
        assert_eq!("x,C".parse(), Ok(Here([true, false, true])));
        assert!("Y".parse::<Here>().is_err());
    }

    #[test]
    fn drives_have_profiles() {
        let servos = |more: &[&str]| {
            let typed = [&["board-sim", "--bus", "vcan0"], more].concat();
            let common = Cli::try_parse_from(typed).unwrap().board.common;
            common.servos(&Params::slant_bed())
        };
        let kv = |more: &[&str]| servos(more).unwrap().map(|one| one.map(|one| one.kv_milli));
        assert_eq!(kv(&[]), [None, None]);
        assert_eq!(kv(&["--drive", "Z=kv100"]), [None, Some(100_000)]);
        assert!(servos(&["--drive", "kv31"]).is_err());
    }

    #[test]
    fn a_board_wants_a_bus_and_so_do_drives() {
        assert!(Cli::try_parse_from(["board-sim"]).is_err());
        assert!(Cli::try_parse_from(["board-sim", "drives"]).is_err());
        let cli = Cli::try_parse_from(["board-sim", "--bus", "vcan0", "--lockstep"]).unwrap();
        assert_eq!(
            cli.board.common.address(),
            &Address::SocketCan("vcan0".into())
        );
        let cli = Cli::try_parse_from(["board-sim", "drives", "--bus", "can1"]).unwrap();
        assert!(cli.command.is_some());
    }
}
