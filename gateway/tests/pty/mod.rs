//! A terminal of a test's own.

use nix::fcntl::{FcntlArg, FdFlag, fcntl};
use nix::pty::{OpenptyResult, Winsize, openpty};

/// Both ends of a terminal. No program inherits them but the one that is given them: a machine that is started meanwhile
/// goes on, and would keep the terminal open.
pub fn open(size: Option<&Winsize>) -> OpenptyResult {
    let ends = openpty(size, None).unwrap();
    for end in [&ends.master, &ends.slave] {
        fcntl(end, FcntlArg::F_SETFD(FdFlag::FD_CLOEXEC)).unwrap();
    }
    ends
}
