//! Who asks over the control socket of a machine: their lines, and the answers. It must not know what a request does.

use std::fs;
use std::io::{ErrorKind, Read as _, Write as _};
use std::os::fd::{AsFd as _, BorrowedFd};
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::Path;

use leadscrew_can::CanError;
use leadscrew_common::failure::{Failure, Outcome};
use leadscrew_common::words::both;

use crate::control::{Answer, LONGEST, Request};

/// Opens a socket. One that lies there is left over from a process that was killed.
///
/// # Errors
/// It cannot be made.
pub fn bind(path: &Path) -> Outcome<UnixListener> {
    let failed = |error| {
        Failure::bus(CanError::System {
            name: path.display().to_string(),
            doing: "open",
            error,
        })
    };
    match fs::remove_file(path) {
        Err(error) if error.kind() != ErrorKind::NotFound => return Err(failed(error)),
        _ => {}
    }
    let listener = UnixListener::bind(path).map_err(failed)?;
    listener.set_nonblocking(true).map_err(failed)?;
    Ok(listener)
}

/// Somebody who asks.
struct Caller {
    stream: UnixStream,
    text: Vec<u8>,
}

impl Caller {
    /// Takes what has come; false where nothing comes any more.
    fn hear(&mut self) -> bool {
        let mut bytes = [0; 1024];
        match self.stream.read(&mut bytes) {
            Ok(0) => false,
            Ok(count) => {
                self.text.extend(bytes.get(..count).unwrap_or_default());
                self.text.len() <= LONGEST
            }
            Err(error) => matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted),
        }
    }

    /// The next whole line.
    fn line(&mut self) -> Option<Vec<u8>> {
        let end = self.text.iter().position(|byte| *byte == b'\n')?;
        Some(self.text.drain(..=end).collect())
    }

    /// Sends an answer; false where it is gone, or reads nothing.
    fn tell(&mut self, answer: &Answer) -> bool {
        let Ok(mut line) = serde_json::to_vec(answer) else {
            return false;
        };
        line.push(b'\n');
        // An answer has room in an empty socket.
        self.stream.write_all(&line).is_ok()
    }
}

/// All who ask.
#[derive(Default)]
pub struct Callers(Vec<Caller>);

impl Callers {
    /// Their sockets, to wait for them.
    pub fn sockets(&self) -> impl Iterator<Item = BorrowedFd<'_>> {
        self.0.iter().map(|caller| caller.stream.as_fd())
    }

    /// Lets in who has come. Waits for nobody.
    pub fn welcome(&mut self, listener: &UnixListener) {
        while let Ok((stream, _)) = listener.accept() {
            if stream.set_nonblocking(true).is_ok() {
                let text = Vec::new();
                self.0.push(Caller { stream, text });
            }
        }
    }

    /// Answers what was asked. Waits for nobody.
    pub fn answer(&mut self, mut carry_out: impl FnMut(&Request) -> Answer) {
        self.0.retain_mut(|caller| {
            let mut stays = caller.hear();
            while let Some(line) = caller.line() {
                let answer = match serde_json::from_slice(&line) {
                    Ok(request) => carry_out(&request),
                    Err(error) => {
                        let why = error.to_string();
                        Answer::refused(both!(
                            "this machine does not know the request ({why}): was it started by another version?",
                            "这台机床不认识该请求（{why}）：它是由其它版本启动的吗？"
                        ))
                    }
                };
                stays &= caller.tell(&answer);
            }
            stays
        });
    }
}
