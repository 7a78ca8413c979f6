//! The kernel's CAN interfaces.
//!
//! One system call receives or sends a whole burst of frames. Waiting needs no further call: the receive call itself
//! waits, up to [`SLICE`]. Only a remaining time shorter than that needs a poll, which is exact. The receive buffer is
//! as large as the kernel allows, because the default buffer holds only 278 frames.

mod interface;
mod raw;

pub use interface::is_virtual;

use std::io::{IoSlice, IoSliceMut};
use std::os::fd::{AsFd, AsRawFd, OwnedFd};
use std::time::Duration;

use leadscrew_core::bus::{self, Frame};
use nix::errno::Errno;
use nix::poll::{PollFd, PollFlags, ppoll};
use nix::sys::socket::{
    AddressFamily, ControlMessageOwned, MsgFlags, MultiHeaders, SockFlag, SockProtocol, SockType,
    recvmmsg, sendmmsg, setsockopt, socket, sockopt,
};
use nix::sys::time::TimeSpec;
use socketcan::{CanAddr, CanFdSocket, CanSocket, Socket as _, SocketOptions as _};

use crate::{Can, CanError, Filter, Received, Stamp};

/// The longest wait of one receive call.
const SLICE: Duration = Duration::from_millis(50);

/// Size of the receive buffer in bytes: frames of some 80 seconds at full load, as the kernel counts them.
const BUFFER: usize = 256 << 20;

/// The smallest and the largest room for frames in one system call.
const BATCH: (usize, usize) = (8, 256);

/// How long sending may be blocked.
const STUCK: Duration = Duration::from_secs(1);

/// Wait before the next attempt on a full queue of the interface; the kernel does not report free room.
const RETRY: Duration = Duration::from_millis(1);

/// `SOL_SOCKET` and `SO_MEMINFO` of Linux, and the index of the drop counter in the result.
const SOL_SOCKET: i32 = 1;
const SO_MEMINFO: i32 = 55;
const MEMINFO_DROPS: usize = 8;
const MEMINFO_WORDS: usize = 9;

/// An interface of the kernel.
#[derive(Debug)]
pub struct SocketCan {
    name: String,
    socket: CanFdSocket,
    /// Room for the frames of one system call; it grows when one call fills it.
    room: Vec<[u8; raw::FD]>,
}

impl SocketCan {
    /// Opens an interface: classical and FD frames, error frames of every kind.
    ///
    /// # Errors
    /// The interface does not exist, is no CAN interface, or is down.
    pub fn open(name: &str) -> Result<Self, CanError> {
        interface::check(name)?;
        let unbound = socket(
            AddressFamily::Can,
            SockType::Raw,
            SockFlag::SOCK_CLOEXEC,
            SockProtocol::CanRaw,
        )
        .map_err(|error| failure(name, "open", error))?;
        let unopened = |error| failed(name, "open", error);
        let fd = CanFdSocket::try_from(CanSocket::from(unbound)).map_err(unopened)?;
        let can = Self::new(name, fd)?;
        can.socket
            .set_error_filter_accept_all()
            .map_err(|error| can.failed("ask for the error frames of", error))?;
        // The bind comes last: from here on frames arrive, and a burst needs the whole buffer.
        let address = CanAddr::from_iface(name).map_err(unopened)?;
        can.socket
            .as_raw_socket()
            .bind(&address.into_sock_addr())
            .map_err(unopened)?;
        Ok(can)
    }

    /// Takes any datagram socket that carries frames in the form of the kernel's CAN sockets: for measurements without
    /// an interface.
    ///
    /// # Errors
    /// The socket refuses an option.
    pub fn over(socket: OwnedFd, name: &str) -> Result<Self, CanError> {
        Self::new(name, CanFdSocket::from(socket))
    }

    /// The socket itself.
    #[must_use]
    pub const fn socket(&self) -> &impl AsFd {
        &self.socket
    }

    fn new(name: &str, socket: CanFdSocket) -> Result<Self, CanError> {
        let can = Self {
            name: name.into(),
            socket,
            room: vec![[0; raw::FD]; BATCH.0],
        };
        let failed = |doing| move |error: Errno| failure(name, doing, error);
        let descriptor = &can.socket;
        // Only the administrator may go above the system's limit; others get the size that they are allowed.
        if setsockopt(descriptor, sockopt::RcvBufForce, &BUFFER).is_err() {
            setsockopt(descriptor, sockopt::RcvBuf, &BUFFER)
                .map_err(failed("enlarge the buffer of"))?;
        }
        setsockopt(descriptor, sockopt::ReceiveTimestampns, &true)
            .map_err(failed("get time stamps from"))?;
        can.socket
            .set_read_timeout(SLICE)
            .and_then(|()| can.socket.set_write_timeout(STUCK))
            .map_err(|error| can.failed("set the time-outs of", error))?;
        Ok(can)
    }

    fn failed(&self, doing: &'static str, error: std::io::Error) -> CanError {
        failed(&self.name, doing, error)
    }

    /// Receives with one system call; gives 0 where no frame arrives in the time that the flags allow.
    fn take(&mut self, into: &mut Vec<Received>, flags: MsgFlags) -> Result<usize, CanError> {
        let before = into.len();
        // Length and time of arrival of each frame.
        let mut facts = [(0, Stamp::default()); BATCH.1];
        let mut arrived = 0;
        {
            // New headers for every call: used headers only have room for the control data of the last call.
            let mut headers =
                MultiHeaders::<()>::preallocate(self.room.len(), Some(nix::cmsg_space!(TimeSpec)));
            let mut slices: Vec<[IoSliceMut; 1]> = self
                .room
                .iter_mut()
                .map(|bytes| [IoSliceMut::new(bytes)])
                .collect();
            let messages = match recvmmsg(
                self.socket.as_raw_fd(),
                &mut headers,
                slices.iter_mut(),
                flags,
                None,
            ) {
                Ok(messages) => messages,
                Err(Errno::EAGAIN | Errno::EINTR) => return Ok(0),
                Err(error) => return Err(failure(&self.name, "receive from", error)),
            };
            for (message, fact) in messages.zip(&mut facts) {
                let time = message.cmsgs().ok().and_then(|mut all| {
                    all.find_map(|control| match control {
                        ControlMessageOwned::ScmTimestampns(time) => Some(stamp(time)),
                        _ => None,
                    })
                });
                *fact = (message.bytes, time.unwrap_or_else(Stamp::now));
                arrived += 1;
            }
        }
        for (bytes, (len, time)) in self.room.iter().zip(facts).take(arrived) {
            if let Some(packet) = bytes.get(..len).and_then(raw::packet) {
                into.push(Received { time, packet });
            }
        }
        if arrived == self.room.len() && arrived < BATCH.1 {
            self.room.resize(arrived * 2, [0; raw::FD]);
        }
        Ok(into.len() - before)
    }

    /// Sends all frames, in order, with as few system calls as possible.
    fn put<const N: usize>(&self, bytes: &[[u8; N]]) -> Result<(), Errno> {
        let mut blocked = Duration::ZERO;
        let mut left = bytes;
        while !left.is_empty() {
            let some = left.get(..BATCH.1).unwrap_or(left);
            let slices: Vec<[IoSlice; 1]> =
                some.iter().map(|frame| [IoSlice::new(frame)]).collect();
            let mut headers = MultiHeaders::<()>::preallocate(some.len(), None);
            let sent = sendmmsg(
                self.socket.as_raw_fd(),
                &mut headers,
                slices.iter(),
                vec![None; some.len()],
                [],
                MsgFlags::empty(),
            );
            match sent.map(Iterator::count) {
                Ok(count) => {
                    left = left.get(count..).unwrap_or_default();
                    blocked = Duration::ZERO;
                }
                // The queue of the interface is full.
                Err(Errno::ENOBUFS) if blocked < STUCK => {
                    std::thread::sleep(RETRY);
                    blocked += RETRY;
                }
                Err(Errno::EINTR) => {}
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }

    /// Waits for the exact time; true where a frame can be received.
    fn wait(&self, patience: Duration) -> Result<bool, CanError> {
        let mut wanted = [PollFd::new(self.socket.as_fd(), PollFlags::POLLIN)];
        match ppoll(&mut wanted, Some(TimeSpec::from_duration(patience)), None) {
            Ok(ready) => Ok(ready > 0),
            Err(Errno::EINTR) => Ok(false),
            Err(error) => Err(failure(&self.name, "wait for", error)),
        }
    }
}

impl Can for SocketCan {
    fn name(&self) -> &str {
        &self.name
    }

    fn send(&mut self, frames: &[Frame]) -> Result<(), CanError> {
        let bytes: Vec<[u8; raw::CLASSICAL]> = frames.iter().map(raw::bytes).collect();
        self.put(&bytes)
            .map_err(|error| failure(&self.name, "send to", error))
    }

    fn use_fd(&mut self, _data_kbit: u32) -> Result<(), CanError> {
        interface::check_fd(&self.name)
    }

    fn send_fd(&mut self, frames: &[bus::FdFrame]) -> Result<(), CanError> {
        let bytes: Vec<[u8; raw::FD]> = frames.iter().map(raw::fd_bytes).collect();
        self.put(&bytes).map_err(|error| match error {
            // The kernel's error for a frame that is too long for the interface.
            Errno::EINVAL => CanError::NoFd {
                name: self.name.clone(),
            },
            error => failure(&self.name, "send to", error),
        })
    }

    fn receive(&mut self, into: &mut Vec<Received>, patience: Duration) -> Result<usize, CanError> {
        let mut left = patience;
        while left >= SLICE {
            let count = self.take(into, MsgFlags::MSG_WAITFORONE)?;
            if count > 0 {
                return Ok(count);
            }
            left -= SLICE;
        }
        let count = self.take(into, MsgFlags::MSG_DONTWAIT)?;
        if count > 0 || left.is_zero() || !self.wait(left)? {
            return Ok(count);
        }
        self.take(into, MsgFlags::MSG_DONTWAIT)
    }

    fn listen_for(&mut self, filters: &[Filter]) -> Result<(), CanError> {
        const EXTENDED: u32 = 1 << 31;
        const REMOTE: u32 = 1 << 30;
        let result = if filters.is_empty() {
            self.socket.set_filter_accept_all()
        } else {
            let filters: Vec<(u32, u32)> = filters
                .iter()
                .map(|filter| {
                    let (id, mask) = filter.bits();
                    (u32::from(id), u32::from(mask) | EXTENDED | REMOTE)
                })
                .collect();
            self.socket.set_filters(&filters)
        };
        result.map_err(|error| self.failed("filter", error))
    }

    fn dropped(&self) -> Result<u64, CanError> {
        let mut bytes = [0; 4 * MEMINFO_WORDS];
        self.socket
            .get_socket_option_bytes(SOL_SOCKET, SO_MEMINFO, &mut bytes)
            .map_err(|error| self.failed("count what was lost on", error))?;
        let (words, _) = bytes.as_chunks::<4>();
        Ok(words
            .get(MEMINFO_DROPS)
            .map_or(0, |word| u64::from(u32::from_ne_bytes(*word))))
    }
}

fn stamp(time: TimeSpec) -> Stamp {
    let duration = Duration::from(time);
    Stamp::from_nanos(u64::try_from(duration.as_nanos()).unwrap_or(u64::MAX))
}

/// Converts an error of the socket library.
fn failed(name: &str, doing: &'static str, error: std::io::Error) -> CanError {
    match error.raw_os_error() {
        Some(code) => failure(name, doing, Errno::from_raw(code)),
        None => CanError::System {
            name: name.to_owned(),
            doing,
            error,
        },
    }
}

/// Converts an error of the system.
fn failure(name: &str, doing: &'static str, error: Errno) -> CanError {
    let name = name.to_owned();
    match error {
        Errno::EAFNOSUPPORT | Errno::EPROTONOSUPPORT => CanError::NoCan,
        Errno::ENETDOWN => CanError::Down { name },
        Errno::ENODEV | Errno::ENXIO => CanError::Gone { name },
        Errno::EPERM | Errno::EACCES => CanError::NoPermission { name },
        Errno::EAGAIN | Errno::ENOBUFS => CanError::Stuck { name },
        error => CanError::System {
            name,
            doing,
            error: error.into(),
        },
    }
}
