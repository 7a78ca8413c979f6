//! `agent`: what is typed about boards, a broker, a store and figures.

use std::net::SocketAddr;
use std::path::PathBuf;
use std::str::FromStr;

use clap::Args;
use leadscrew_agent::mqtt::Address;
use leadscrew_can::{Address as Bus, BitRate, WrongAddress};
use leadscrew_core::bus::NodeId;

use super::bit_rate;
use crate::values::{Mistake, mistake};

/// `agent`.
#[derive(Args, Debug)]
pub struct Agent {
    /// A board of several, with the name of its machine (repeatable); each bus and each node once
    ///
    /// `lathe1=can0`, `lathe2=can0,node=2`, `mill=slcan:/dev/ttyACM0,bitrate=500`. It stands for `--machine`, `--bus`,
    /// `--node` and `--bitrate`, which are for one board.
    #[arg(
        long = "board",
        value_name = "NAME=BUS[,node=N][,bitrate=KBIT]",
        conflicts_with = "machine"
    )]
    pub boards: Vec<Board>,
    /// The broker: `mqtt://HOST[:1883]`, or by TLS `mqtts://HOST[:8883]`
    #[arg(long, value_name = "URL")]
    pub broker: Option<Address>,
    /// Whom the broker lets in.
    #[command(flatten)]
    pub access: Access,
    /// Edge node in the topics: this agent; no other of the broker may have it [default: computer and machine; with several
    /// boards the computer]
    #[arg(long, value_name = "NAME")]
    pub name: Option<String>,
    /// Device in the topics: the machine [default: bus and node]
    #[arg(long, value_name = "NAME")]
    pub machine: Option<String>,
    /// The primary host of Sparkplug: while it does not say that it is there, all is kept and nothing is sent
    #[arg(long, value_name = "ID", requires = "broker")]
    pub primary_host: Option<String>,
    /// Where what is told is kept until the broker and the archive have it
    /// [default: agent-MACHINE.redb, with several boards agent-NAME.redb, in $STATE_DIRECTORY, else in leadscrew/ of
    /// $XDG_STATE_HOME, else of ~/.local/state]
    #[arg(long, value_name = "FILE")]
    pub store: Option<PathBuf>,
    /// MiB of records that it keeps; then the oldest states go first, certificates never
    #[arg(long, value_name = "MIB", default_value_t = 64, value_parser = clap::value_parser!(u64).range(1..=65_536))]
    pub limit: u64,
    /// Writes all that is told to this folder too, each hour, as files of Parquet for DuckDB and others
    #[arg(long, value_name = "DIR")]
    pub archive: Option<PathBuf>,
    /// Gives figures to Prometheus at this address, without TLS and without a password
    #[arg(long, value_name = "ADDRESS")]
    pub metrics: Option<SocketAddr>,
    /// Gives the broker no parameter set: then `leadscrew fleet` knows none of these machines
    #[arg(long, requires = "broker")]
    pub no_set: bool,
}

/// What every command at a broker takes.
#[derive(Args, Debug)]
pub struct Access {
    /// Certificates of the authorities that the broker's certificate may be of, as PEM; no others are believed
    #[arg(long, value_name = "FILE", requires = "broker")]
    pub ca: Option<PathBuf>,
    /// User and password at the broker, on two lines of a file that its owner alone may read
    #[arg(long, value_name = "FILE", requires = "broker")]
    pub login: Option<PathBuf>,
    /// Certificate and private key of this client, as PEM in one file that its owner alone may read, for a broker that asks
    #[arg(long, value_name = "FILE", requires = "ca")]
    pub identity: Option<PathBuf>,
    /// Group in the topics: the shop
    #[arg(long, value_name = "NAME", default_value = "leadscrew")]
    pub group: String,
}

/// `--board`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Board {
    /// Its machine.
    pub machine: String,
    /// Where it is.
    pub bus: Bus,
    /// Its number there.
    pub node: Option<u8>,
    /// Of an adapter.
    pub bitrate: Option<BitRate>,
}

impl FromStr for Board {
    type Err = Mistake;

    fn from_str(text: &str) -> Result<Self, Mistake> {
        let Some((machine, mut bus)) = text.split_once('=').filter(|(name, _)| !name.is_empty())
        else {
            return Err(mistake!(
                "expected the name of a machine and its bus, such as `lathe1=can0` or `lathe2=can0,node=2`",
                "应为机床名称和总线，如 `lathe1=can0` 或 `lathe2=can0,node=2`"
            ));
        };
        let (mut node, mut bitrate) = (None, None);
        // The path of an adapter may have a comma.
        while let Some((rest, last)) = bus.rsplit_once(',') {
            if let Some(number) = last.strip_prefix("node=") {
                let number = number.parse().ok().filter(|number| {
                    NodeId::new(*number).is_some_and(|node| node != NodeId::GATEWAY)
                });
                node = Some(number.ok_or_else(|| {
                    mistake!(
                        "`{last}`: boards have 1 to 126",
                        "`{last}`：控制板的节点号为 1 至 126"
                    )
                })?);
            } else if let Some(rate) = last.strip_prefix("bitrate=") {
                bitrate = Some(bit_rate(rate)?);
            } else {
                break;
            }
            bus = rest;
        }
        let bus = bus.parse().map_err(|wrong: WrongAddress| {
            mistake!("`{bus}`: {wrong}", "`{bus}`：{zh}", zh = wrong.chinese())
        })?;
        if let Bus::SocketCan(name) = &bus
            && let Some((_, unknown)) = name.split_once(',')
        {
            return Err(mistake!(
                "`{unknown}`: what follows a bus is `node=N` and `bitrate=KBIT`",
                "`{unknown}`：总线后面只能写 `node=N` 和 `bitrate=KBIT`"
            ));
        }
        if bus == Bus::Sim {
            return Err(mistake!(
                "`sim` is inside of a process and nobody is there to be read; `leadscrew up --name {machine}` makes a machine \
                 that stays: `{machine}=sim:{machine}`",
                "`sim` 只存在于进程内部，无法读取；用 `leadscrew up --name {machine}` 启动常驻机床，再写 `{machine}=sim:{machine}`"
            ));
        }
        Ok(Self {
            machine: machine.to_owned(),
            bus,
            node,
            bitrate,
        })
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use clap::Parser as _;

    use super::*;
    use crate::cli::{Cli, Command};

    #[test]
    fn a_board_is_a_name_a_bus_and_what_follows() {
        let board: Board = "lathe 1=can0".parse().unwrap();
        assert_eq!(board.machine, "lathe 1");
        assert_eq!((board.node, board.bitrate), (None, None));
        let board: Board = "m=slcan:unix:/a,b=c,bitrate=500,node=2".parse().unwrap();
        assert_eq!(board.bus, Bus::Unix("/a,b=c".into()));
        assert_eq!(
            (board.node, board.bitrate),
            (Some(2), BitRate::of_kbit(500))
        );
        for (wrong, words) in [
            ("can0", "name of a machine"),
            ("=can0", "name of a machine"),
            ("a=", "expected `sim`"),
            ("a=sim", "leadscrew up --name a"),
            ("a=can0,node=0", "1 to 126"),
            ("a=can0,node=127", "1 to 126"),
            ("a=can0,node=x", "1 to 126"),
            ("a=can0,bitrate=3", "kbit/s"),
            ("a=can0,speed=3", "`speed=3`: what follows"),
        ] {
            let said = wrong.parse::<Board>().unwrap_err().to_string();
            assert!(said.contains(words), "{wrong}: {said}");
        }
    }

    #[test]
    fn the_shipped_units_give_options_that_are_known_and_write_where_they_may() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../contrib/systemd");
        for name in ["leadscrew-agent.service", "leadscrew-agent@.service"] {
            let unit = std::fs::read_to_string(folder.join(name)).unwrap();
            let of = |key: &str| {
                let mut lines = unit.lines();
                let value = lines.find_map(|line| line.strip_prefix(key)?.strip_prefix('='));
                value.unwrap_or_else(|| panic!("{name}: {key}"))
            };
            let typed = of("ExecStart")
                .replace("$OPTIONS", of("#   OPTIONS"))
                .replace("%d", "/credentials")
                .replace("%i", "can0");
            let Command::Agent(agent) = Cli::try_parse_from(typed.split_whitespace())
                .unwrap_or_else(|error| panic!("{name}: {error}"))
                .command
            else {
                panic!("{name}: {typed}");
            };
            let (secret, _) = of("LoadCredential").split_once(':').unwrap();
            let login = Path::new("/credentials").join(secret);
            assert_eq!(agent.access.login, Some(login), "{name}");
            // All else is closed to it.
            assert!(agent.store.is_none_or(|path| path.is_relative()), "{name}");
            assert!(agent.archive.unwrap().is_relative(), "{name}");
            let state = format!("%S/{}", of("StateDirectory"));
            assert_eq!(of("WorkingDirectory"), state, "{name}");
        }
    }
}
