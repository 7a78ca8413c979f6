//! The address of a bus, as a user writes it.

use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

use crate::MachineName;

/// Default baud rate of a serial adapter. Adapters on USB ignore the baud rate.
pub const DEFAULT_BAUD: u32 = 115_200;

/// A bus by its name: `sim`, `can0`, `socketcan:can0`, `slcan:/dev/ttyACM0@115200`, `slcan:tcp:HOST:PORT`,
/// `slcan:unix:PATH`, `sim:NAME`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Address {
    /// Inside this process.
    Sim,
    /// An interface of the kernel.
    SocketCan(String),
    /// A Lawicel adapter on a serial line.
    Serial {
        /// The device.
        path: PathBuf,
        /// The line's baud rate.
        baud: u32,
    },
    /// A Lawicel adapter that is reached over TCP.
    Tcp {
        /// Host name or address; an IPv6 address in brackets.
        host: String,
        /// Port.
        port: u16,
    },
    /// A Lawicel adapter that is reached over a Unix socket.
    Unix(PathBuf),
    /// A simulated machine that `leadscrew up` keeps running.
    Machine(MachineName),
}

/// A text that names no bus.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WrongAddress {
    english: String,
    chinese: String,
}

impl WrongAddress {
    pub(crate) fn new(english: impl Into<String>, chinese: impl Into<String>) -> Self {
        Self {
            english: english.into(),
            chinese: chinese.into(),
        }
    }

    /// The message in Chinese.
    #[must_use]
    pub fn chinese(&self) -> &str {
        &self.chinese
    }
}

impl fmt::Display for WrongAddress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.english)
    }
}

impl std::error::Error for WrongAddress {}

impl FromStr for Address {
    type Err = WrongAddress;

    fn from_str(text: &str) -> Result<Self, WrongAddress> {
        if text == "sim" {
            return Ok(Self::Sim);
        }
        if let Some(name) = text.strip_prefix("sim:") {
            return name.parse().map(Self::Machine);
        }
        if let Some(target) = text.strip_prefix("slcan:") {
            return adapter(target);
        }
        let name = text.strip_prefix("socketcan:").unwrap_or(text);
        // The kernel's rule for names of interfaces: 1 to 15 bytes, no slash, no colon, no space.
        let possible = !name.is_empty()
            && name.len() <= 15
            && !name.contains(|c: char| c == '/' || c == ':' || c.is_whitespace());
        if !possible {
            let (hint, chinese_hint) = if name.starts_with("/dev/") {
                (
                    format!("; did you mean `slcan:{name}`?"),
                    format!("；是否要写 `slcan:{name}`？"),
                )
            } else {
                (String::new(), String::new())
            };
            return Err(WrongAddress::new(
                format!(
                    "expected `sim`, `sim:NAME`, an interface such as `can0`, `socketcan:can0`, or `slcan:/dev/ttyACM0`{hint}"
                ),
                format!(
                    "应为 `sim`、`sim:NAME`、接口名（如 `can0`、`socketcan:can0`）或 `slcan:/dev/ttyACM0`{chinese_hint}"
                ),
            ));
        }
        Ok(Self::SocketCan(name.to_owned()))
    }
}

fn adapter(target: &str) -> Result<Address, WrongAddress> {
    if let Some(place) = target.strip_prefix("tcp:") {
        let wrong = || {
            WrongAddress::new(
                format!(
                    "`slcan:tcp:{place}`: expected host and port, as `slcan:tcp:localhost:3000`"
                ),
                format!("`slcan:tcp:{place}`：应写主机和端口，如 `slcan:tcp:localhost:3000`"),
            )
        };
        let (host, port) = place.rsplit_once(':').ok_or_else(wrong)?;
        let port = port.parse().map_err(|_| wrong())?;
        if host.is_empty() || port == 0 {
            return Err(wrong());
        }
        return Ok(Address::Tcp {
            host: host.to_owned(),
            port,
        });
    }
    if let Some(path) = target.strip_prefix("unix:") {
        if path.is_empty() {
            return Err(WrongAddress::new(
                "`slcan:unix:` wants the path of a socket behind it",
                "`slcan:unix:` 后面要写套接字的路径",
            ));
        }
        return Ok(Address::Unix(path.into()));
    }
    let (path, baud) = match target.rsplit_once('@') {
        None => (target, DEFAULT_BAUD),
        Some((path, baud)) => match baud.parse() {
            Ok(baud) if baud > 0 => (path, baud),
            _ => {
                return Err(WrongAddress::new(
                    format!("`{baud}` is no baud rate; expected `slcan:{path}@115200`"),
                    format!("`{baud}` 不是波特率；应写成 `slcan:{path}@115200`"),
                ));
            }
        },
    };
    if path.is_empty() {
        return Err(WrongAddress::new(
            "`slcan:` wants a device (`/dev/ttyACM0`), `tcp:HOST:PORT` or `unix:PATH` behind it",
            "`slcan:` 后面要写设备（`/dev/ttyACM0`）、`tcp:HOST:PORT` 或 `unix:PATH`",
        ));
    }
    Ok(Address::Serial {
        path: path.into(),
        baud,
    })
}

impl fmt::Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Sim => f.write_str("sim"),
            Self::SocketCan(name) => write!(f, "socketcan:{name}"),
            Self::Serial { path, baud } => write!(f, "slcan:{}@{baud}", path.display()),
            Self::Tcp { host, port } => write!(f, "slcan:tcp:{host}:{port}"),
            Self::Machine(name) => write!(f, "sim:{name}"),
            Self::Unix(path) => write!(f, "slcan:unix:{}", path.display()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_form_is_read_and_written_back() {
        for (text, address) in [
            ("sim", Address::Sim),
            ("can0", Address::SocketCan("can0".into())),
            ("socketcan:vcan0", Address::SocketCan("vcan0".into())),
            (
                "slcan:/dev/ttyACM0",
                Address::Serial {
                    path: "/dev/ttyACM0".into(),
                    baud: 115_200,
                },
            ),
            (
                "slcan:/dev/ttyS1@9600",
                Address::Serial {
                    path: "/dev/ttyS1".into(),
                    baud: 9600,
                },
            ),
            (
                "slcan:tcp:[::1]:3000",
                Address::Tcp {
                    host: "[::1]".into(),
                    port: 3000,
                },
            ),
            ("slcan:unix:/tmp/bus", Address::Unix("/tmp/bus".into())),
            ("sim:desk", Address::Machine(MachineName::default())),
        ] {
            assert_eq!(text.parse(), Ok(address.clone()), "{text}");
            assert_eq!(address.to_string().parse(), Ok(address), "{text}");
        }
    }

    #[test]
    fn what_names_no_bus_says_what_would() {
        for (text, said) in [
            ("", "expected `sim`"),
            ("socketcan:", "expected `sim`"),
            ("an-interface-too-long", "expected `sim`"),
            ("/dev/ttyACM0", "did you mean `slcan:/dev/ttyACM0`?"),
            ("sim:", "names no simulated machine"),
            ("sim:../x", "names no simulated machine"),
            ("slcan:", "wants a device"),
            ("slcan:/dev/ttyACM0@fast", "`fast` is no baud rate"),
            ("slcan:/dev/ttyACM0@0", "`0` is no baud rate"),
            ("slcan:tcp:localhost", "host and port"),
            ("slcan:tcp::3000", "host and port"),
            ("slcan:tcp:h:70000", "host and port"),
            ("slcan:unix:", "path of a socket"),
        ] {
            let error = text.parse::<Address>().unwrap_err().to_string();
            assert!(error.contains(said), "{text}: {error}");
        }
    }
}
