//! Opens the connection to an adapter.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, ErrorKind, IsTerminal as _};
use std::net::{TcpStream, ToSocketAddrs as _};
use std::os::unix::fs::OpenOptionsExt as _;
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::time::Duration;

use nix::errno::Errno;
use nix::fcntl::OFlag;
use nix::sys::termios::{self, BaudRate, SetArg, SpecialCharacterIndices};

use super::{ANSWER, Stream};
use crate::{Address, CanError, Port};

/// Time limit for a connection.
const CONNECT: Duration = Duration::from_secs(3);

/// The name of the adapter for messages, and the connection.
pub fn open(address: &Address) -> Result<(String, Box<dyn Stream>), CanError> {
    match address {
        Address::Sim | Address::SocketCan(_) => Err(CanError::NotABus),
        Address::Serial { path, baud } => {
            let name = path.display().to_string();
            let line = serial(path, &name, *baud)?;
            Ok((name, Box::new(line)))
        }
        Address::Tcp { host, port } => {
            let name = format!("tcp:{host}:{port}");
            let line = tcp(host, *port).map_err(|error| failed(&name, error))?;
            Ok((name, Box::new(line)))
        }
        Address::Machine(machine) => {
            let line = crate::connect(machine, Port::Bus)?;
            let name = format!("sim:{machine}");
            line.set_write_timeout(Some(ANSWER))
                .map_err(|error| failed(&name, error))?;
            Ok((name, Box::new(line)))
        }
        Address::Unix(path) => {
            let name = format!("unix:{}", path.display());
            let line = UnixStream::connect(path)
                .and_then(|line| line.set_write_timeout(Some(ANSWER)).map(|()| line))
                .map_err(|error| failed(&name, error))?;
            Ok((name, Box::new(line)))
        }
    }
}

fn tcp(host: &str, port: u16) -> io::Result<TcpStream> {
    let host = host
        .strip_prefix('[')
        .and_then(|host| host.strip_suffix(']'))
        .unwrap_or(host);
    let mut last = io::Error::from(ErrorKind::NotFound);
    for address in (host, port).to_socket_addrs()? {
        match TcpStream::connect_timeout(&address, CONNECT) {
            Ok(line) => {
                line.set_nodelay(true)?;
                line.set_write_timeout(Some(ANSWER))?;
                return Ok(line);
            }
            Err(error) => last = error,
        }
    }
    Err(last)
}

fn serial(path: &Path, name: &str, baud: u32) -> Result<File, CanError> {
    let rate = rate(baud).ok_or_else(|| CanError::NoSuchBaud {
        name: name.into(),
        baud,
    })?;
    // Without this flag the open call would block on a line without carrier. The flag stays set: later only the poll
    // blocks.
    let line = OpenOptions::new()
        .read(true)
        .write(true)
        .custom_flags((OFlag::O_NOCTTY | OFlag::O_NONBLOCK).bits())
        .open(path)
        .map_err(|error| match error.raw_os_error().map(Errno::from_raw) {
            // The path is a folder or a socket.
            Some(Errno::EISDIR | Errno::ENXIO) => CanError::NotSerial { name: name.into() },
            _ => failed(name, error),
        })?;
    if !line.is_terminal() {
        return Err(CanError::NotSerial { name: name.into() });
    }
    match line.try_lock() {
        Ok(()) => {}
        Err(TryLockError::WouldBlock) => {
            return Err(CanError::Busy { name: name.into() });
        }
        Err(TryLockError::Error(error)) => return Err(failed(name, error)),
    }
    let set = || -> nix::Result<()> {
        let mut settings = termios::tcgetattr(&line)?;
        termios::cfmakeraw(&mut settings);
        termios::cfsetspeed(&mut settings, rate)?;
        for (index, value) in [
            (SpecialCharacterIndices::VMIN, 1),
            (SpecialCharacterIndices::VTIME, 0),
        ] {
            if let Some(place) = settings.control_chars.get_mut(index as usize) {
                *place = value;
            }
        }
        termios::tcsetattr(&line, SetArg::TCSANOW, &settings)
    };
    set().map_err(|error| CanError::System {
        name: name.into(),
        doing: "set up the line of",
        error: error.into(),
    })?;
    Ok(line)
}

fn failed(name: &str, error: io::Error) -> CanError {
    let name = name.to_owned();
    match error.kind() {
        ErrorKind::PermissionDenied => CanError::NoPermission { name },
        ErrorKind::ConnectionRefused | ErrorKind::ResourceBusy => CanError::Busy { name },
        ErrorKind::NotFound
        | ErrorKind::TimedOut
        | ErrorKind::HostUnreachable
        | ErrorKind::NetworkUnreachable => CanError::NoDevice { name },
        _ => CanError::System {
            name,
            doing: "open",
            error,
        },
    }
}

/// The baud rates of a terminal.
fn rate(baud: u32) -> Option<BaudRate> {
    Some(match baud {
        9_600 => BaudRate::B9600,
        19_200 => BaudRate::B19200,
        38_400 => BaudRate::B38400,
        57_600 => BaudRate::B57600,
        115_200 => BaudRate::B115200,
        230_400 => BaudRate::B230400,
        460_800 => BaudRate::B460800,
        500_000 => BaudRate::B500000,
        576_000 => BaudRate::B576000,
        921_600 => BaudRate::B921600,
        1_000_000 => BaudRate::B1000000,
        1_152_000 => BaudRate::B1152000,
        1_500_000 => BaudRate::B1500000,
        2_000_000 => BaudRate::B2000000,
        2_500_000 => BaudRate::B2500000,
        3_000_000 => BaudRate::B3000000,
        3_500_000 => BaudRate::B3500000,
        4_000_000 => BaudRate::B4000000,
        _ => return None,
    })
}
