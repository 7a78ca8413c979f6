//! The errors of a bus, with a remedy in each message.

use std::fmt;
use std::io;

/// Why a bus cannot be opened, or cannot be used any longer.
#[derive(Debug)]
pub enum CanError {
    /// `sim` names no bus: it is inside the process that simulates it.
    NotABus,
    /// The kernel has no CAN support.
    NoCan,
    /// No interface has this name.
    NoInterface {
        /// The name asked for.
        name: String,
        /// The existing CAN interfaces.
        known: Vec<String>,
    },
    /// The interface is no CAN interface.
    NotCan {
        /// Its name.
        name: String,
    },
    /// The interface is not up, or was taken down.
    Down {
        /// Its name.
        name: String,
    },
    /// The interface has vanished.
    Gone {
        /// Its name.
        name: String,
    },
    /// The interface carries classical frames only.
    NoFd {
        /// Its name.
        name: String,
    },
    /// The adapter carries classical frames only, or FD frames not at this rate.
    AdapterNoFd {
        /// Its path or address.
        name: String,
        /// The data rate in kbit/s.
        kbit: u32,
    },
    /// The user has no permission.
    NoPermission {
        /// The interface, device or socket.
        name: String,
    },
    /// A kernel interface has sent no frame for a second.
    Stuck {
        /// The interface.
        name: String,
    },
    /// An adapter has acknowledged no frame for five seconds, or takes no bytes [D178].
    AdapterStuck {
        /// Its path or address.
        name: String,
    },
    /// No simulated machine of this name runs.
    NoMachine {
        /// The name asked for.
        name: String,
        /// Those of this user that run.
        running: Vec<String>,
    },
    /// The folder for simulated machines is not the user's alone.
    FolderOfOthers {
        /// Its path.
        folder: String,
        /// Its owner, where that is another user.
        owner: Option<u32>,
    },
    /// The device or socket does not exist.
    NoDevice {
        /// Its path or address.
        name: String,
    },
    /// The path is a file or a device, but no serial line.
    NotSerial {
        /// Its path.
        name: String,
    },
    /// Another program uses the device, or the connection was refused.
    Busy {
        /// Its path or address.
        name: String,
    },
    /// A baud rate that a serial line cannot have.
    NoSuchBaud {
        /// The device.
        name: String,
        /// The rate asked for.
        baud: u32,
    },
    /// The adapter does not answer.
    AdapterSilent {
        /// Its path or address.
        name: String,
        /// The command.
        command: &'static str,
    },
    /// The adapter refuses a command.
    AdapterRefused {
        /// Its path or address.
        name: String,
        /// The command.
        command: &'static str,
    },
    /// The other end of the line or connection is gone.
    Closed {
        /// The adapter or address.
        name: String,
    },
    /// Any other error of the system.
    System {
        /// The interface, device or socket.
        name: String,
        /// The failed action, as in "cannot … can0".
        doing: &'static str,
        /// The error of the system.
        error: io::Error,
    },
}

impl fmt::Display for CanError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotABus => f.write_str(
                "`sim` is inside the process that simulates it; give a real bus, such as `--bus can0`",
            ),
            Self::NoCan => f.write_str(
                "this kernel has no CAN: load it with `modprobe can can_raw vcan`, or use a kernel that has it (docs/can.md)",
            ),
            Self::NoInterface { name, known } => {
                write!(f, "there is no interface `{name}`")?;
                if known.is_empty() {
                    write!(
                        f,
                        ", nor any other CAN interface; a virtual one: `ip link add dev vcan0 type vcan && ip link set \
                         vcan0 up` (docs/can.md)"
                    )
                } else {
                    write!(f, "; the CAN interfaces here are {}", known.join(", "))
                }
            }
            Self::NotCan { name } => write!(
                f,
                "`{name}` is an interface, but not one of CAN; `ip -details link show type can` lists those"
            ),
            Self::NoFd { name } => write!(
                f,
                "interface `{name}` carries classical frames only. While it is down: `ip link set {name} mtu 72` for a virtual \
                 one, `ip link set {name} type can bitrate 1000000 dbitrate 5000000 fd on` for a real one that can (docs/can.md)"
            ),
            Self::AdapterNoFd { name, kbit } => write!(
                f,
                "the adapter at `{name}` carries no FD frames with their data at {kbit} kbit/s: one with firmware that knows `Y` \
                 (CANable 2.0) does, at 1, 2, 4, 5 or 8 Mbit/s (docs/can.md)"
            ),
            Self::Down { name } => write!(
                f,
                "interface `{name}` is down; bring it up: `ip link set {name} up` (a real one needs its bit rate first: `ip \
                 link set {name} type can bitrate 1000000`)"
            ),
            Self::Gone { name } => write!(
                f,
                "interface `{name}` has vanished: was the adapter unplugged or the interface deleted?"
            ),
            Self::NoPermission { name } => write!(
                f,
                "no permission to use `{name}`; a serial device needs its group (`usermod -a -G dialout $USER`, then log in \
                 again), a socket its owner's consent (docs/can.md)"
            ),
            Self::Stuck { name } => write!(
                f,
                "`{name}` has sent nothing for too long: nobody acknowledges (no other node, open wires, another bit rate), \
                 the bus is full, or its queue is too short (`ip link set {name} txqueuelen 1000`)"
            ),
            Self::AdapterStuck { name } => write!(
                f,
                "the adapter at `{name}` has sent nothing for too long: nobody acknowledges on the bus (no other node, open wires, \
                 another bit rate), or the adapter hangs; unplug it and plug it in again"
            ),
            Self::NoMachine { name, running } => {
                write!(f, "no simulated machine `{name}` is running")?;
                if !running.is_empty() {
                    write!(f, " (these are: {})", running.join(", "))?;
                }
                write!(f, "; `leadscrew up --name {name}` starts it")
            }
            Self::FolderOfOthers { folder, owner } => {
                write!(f, "`{folder}` is the folder for your simulated machines, and ")?;
                match owner {
                    Some(uid) => write!(f, "belongs to user {uid}: have it removed")?,
                    None => write!(f, "is open to others or no folder: remove it (`rm -r {folder}`)")?,
                }
                f.write_str(", or set XDG_RUNTIME_DIR to a folder of your own (docs/desk.md)")
            }
            Self::NoDevice { name } => {
                write!(f, "there is no `{name}`; is the adapter plugged in, the program that serves it started?")
            }
            Self::NotSerial { name } => write!(
                f,
                "`{name}` is no serial line: name the device of an adapter (`slcan:/dev/ttyACM0`), what answers behind a \
                 socket (`slcan:unix:{name}`), or an interface of the kernel by its name alone (`can0`)"
            ),
            Self::Busy { name } => write!(
                f,
                "`{name}` is in use by another program, or refuses the connection"
            ),
            Self::NoSuchBaud { name, baud } => write!(
                f,
                "a serial line does not run at {baud} baud; `{name}@115200` is what most adapters expect"
            ),
            Self::AdapterSilent { name, command } => write!(
                f,
                "the adapter at `{name}` does not answer to `{command}`: is it a Lawicel (SLCAN) adapter, and is this its \
                 baud rate (`slcan:{name}@115200`)?"
            ),
            Self::AdapterRefused { name, command } => write!(
                f,
                "the adapter at `{name}` refuses `{command}`; unplug it and plug it in again, and see that it knows this \
                 command"
            ),
            Self::Closed { name } => write!(
                f,
                "`{name}` closed the connection: the adapter was unplugged or its program has ended"
            ),
            Self::System { name, doing, error } => write!(f, "cannot {doing} `{name}`: {error}"),
        }
    }
}

impl std::error::Error for CanError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::System { error, .. } => Some(error),
            _ => None,
        }
    }
}
