//! A hand at the machine: `leadscrew sim --name NAME` reaches this process as it does a machine of `leadscrew up`, over the
//! same socket and in the same language. It must not know what a request does.

use std::fs::File;
use std::os::unix::net::UnixListener;
use std::path::PathBuf;

use leadscrew_can::{Desk, MachineName, Port};
use leadscrew_common::failure::{Failure, Outcome};
use leadscrew_common::words::Both;
use leadscrew_desk::callers::{Callers, bind};
use leadscrew_desk::control::{Answer, Request};

/// The socket of a machine with a name.
pub struct Hand {
    name: MachineName,
    listener: UnixListener,
    callers: Callers,
    socket: PathBuf,
    /// Held as long as the machine runs. It is dropped last.
    _claim: File,
}

impl Hand {
    /// Opens it.
    ///
    /// # Errors
    /// A machine of this name runs already; the socket cannot be made.
    pub fn open(name: &MachineName) -> Outcome<Self> {
        let desk = Desk::make().map_err(Failure::bus)?;
        let claim = desk.claim(name).map_err(Failure::bus)?;
        let claim = claim.ok_or_else(|| {
            Failure::Usage(Both::same(format!(
                "a simulated machine `{name}` runs already: `leadscrew down --name {name}` ends it, or take another `--name`"
            )))
        })?;
        let socket = desk.socket(name, Port::Control);
        Ok(Self {
            name: name.clone(),
            listener: bind(&socket)?,
            callers: Callers::default(),
            socket,
            _claim: claim,
        })
    }

    /// The machine's name.
    pub const fn name(&self) -> &MachineName {
        &self.name
    }

    /// Answers what was asked. Waits for nobody.
    pub fn answer(&mut self, carry_out: impl FnMut(&Request) -> Answer) {
        self.callers.welcome(&self.listener);
        self.callers.answer(carry_out);
    }
}

impl Drop for Hand {
    fn drop(&mut self) {
        // A socket that is gone already need not be removed.
        let _: std::io::Result<()> = std::fs::remove_file(&self.socket);
    }
}
