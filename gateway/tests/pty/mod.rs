//! A terminal of a test's own.

use std::os::fd::OwnedFd;

use rustix::fs::{Mode, OFlags};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{Winsize, tcsetwinsize};

/// Both ends of a terminal.
pub struct Ends {
    pub master: OwnedFd,
    pub slave: OwnedFd,
}

/// Opens a terminal. No program inherits its ends but the one that is given them, not even one that another test starts at
/// this moment: a machine goes on, and would keep the terminal open.
pub fn open(size: Option<Winsize>) -> Ends {
    let flags = OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC;
    let master = openpt(flags).unwrap();
    grantpt(&master).unwrap();
    unlockpt(&master).unwrap();
    let name = ptsname(&master, Vec::new()).unwrap();
    let flags = OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC;
    let slave = rustix::fs::open(name, flags, Mode::empty()).unwrap();
    if let Some(size) = size {
        tcsetwinsize(&slave, size).unwrap();
    }
    Ends { master, slave }
}
