//! `agent`: what is typed about a broker, a store and figures.

use std::net::SocketAddr;
use std::path::PathBuf;

use clap::Args;
use leadscrew_agent::mqtt::Address;

/// `agent`.
#[derive(Args, Debug)]
pub struct Agent {
    /// The broker: `mqtt://HOST[:1883]`, or by TLS `mqtts://HOST[:8883]`
    #[arg(long, value_name = "URL")]
    pub broker: Option<Address>,
    /// Certificates of the authorities that the broker's certificate may be of, as PEM; no others are believed
    #[arg(long, value_name = "FILE", requires = "broker")]
    pub ca: Option<PathBuf>,
    /// User and password at the broker, on two lines of a file that its owner alone may read
    #[arg(long, value_name = "FILE", requires = "broker")]
    pub login: Option<PathBuf>,
    /// Group in Sparkplug's topics: the shop
    #[arg(long, value_name = "NAME", default_value = "leadscrew")]
    pub group: String,
    /// Edge node in the topics: this agent; no other of the broker may have it [default: computer and machine]
    #[arg(long, value_name = "NAME")]
    pub name: Option<String>,
    /// Device in the topics: the machine [default: bus and node]
    #[arg(long, value_name = "NAME")]
    pub machine: Option<String>,
    /// Where what is told is kept until the broker has it
    /// [default: agent-MACHINE.redb in $STATE_DIRECTORY, else in leadscrew/ of $XDG_STATE_HOME, else of ~/.local/state]
    #[arg(long, value_name = "FILE", requires = "broker")]
    pub store: Option<PathBuf>,
    /// MiB of records that it keeps; then the oldest states go first, certificates never
    #[arg(long, value_name = "MIB", default_value_t = 64, value_parser = clap::value_parser!(u64).range(1..=65_536))]
    pub limit: u64,
    /// Gives figures to Prometheus at this address, without TLS and without a password
    #[arg(long, value_name = "ADDRESS")]
    pub metrics: Option<SocketAddr>,
}
