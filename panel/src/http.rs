//! Requests as they come from a socket, and answers as they go to it: HTTP/1.1, one request for each connection.
//!
//! The whole request has one deadline, not each reading: a client that sends a letter at a time does not stay. This file
//! must not know what is asked for.

use std::io::{self, ErrorKind, Read as _, Write as _};
use std::net::{Shutdown, TcpStream};
use std::time::{Duration, Instant};

use crate::refusal::Refusal;

/// A request has come within this time, and an answer has gone; where it is hold or stop alone that may come, [`URGENT`].
/// A long text has more: [`with`].
pub const PATIENCE: Duration = Duration::from_secs(5);
/// The same of a request for which there is no place but one for hold and stop.
pub const URGENT: Duration = Duration::from_secs(1);
/// The longest head.
const HEAD: usize = 8 << 10;
/// The slowest network over which a long text still comes and goes, in bytes a second: 2 Mbit/s.
const SLOWEST: u64 = 256 << 10;
/// The most headers.
const HEADERS: usize = 64;
/// The longest text behind most heads.
pub const BODY: usize = 4 << 10;
/// The longest text of an order: one that changes every value of a table is far shorter.
pub const ORDER: usize = 32 << 10;
/// After an answer, what is still being sent is read away for so long, or the answer would be lost with it.
const LINGER: Duration = Duration::from_millis(500);
/// What every answer says: nothing is kept, framed or guessed, and the page loads nothing from elsewhere.
const ALWAYS: &str = "Connection: close\r\nCache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\n\
     Referrer-Policy: no-referrer\r\nCross-Origin-Resource-Policy: same-origin\r\nCross-Origin-Opener-Policy: same-origin\r\n\
     Content-Security-Policy: default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src data:; \
     base-uri 'none'; form-action 'none'; frame-ancestors 'none'\r\n";

/// What is asked.
#[derive(Debug)]
pub struct Request {
    /// `GET`, `POST` and others.
    pub method: String,
    /// The path, without what is behind `?`.
    pub path: String,
    /// Names in small letters.
    headers: Vec<(String, String)>,
    /// What follows the head.
    pub body: Vec<u8>,
}

impl Request {
    /// A header that is there once.
    pub fn header(&self, name: &str) -> Option<&str> {
        let mut found = self.headers.iter().filter(|(own, _)| own == name);
        match (found.next(), found.next()) {
            (Some((_, value)), None) => Some(value),
            _ => None,
        }
    }

    /// A cookie.
    pub fn cookie(&self, name: &str) -> Option<&str> {
        let pairs = self.header("cookie")?.split(';');
        pairs
            .filter_map(|pair| pair.trim().split_once('='))
            .find_map(|(own, value)| (own == name).then_some(value))
    }

    fn counts(&self, name: &str) -> usize {
        self.headers.iter().filter(|(own, _)| own == name).count()
    }
}

/// Reads a request that comes within this time; `most` says how long the text behind its head may be. `None`: who has
/// connected has said nothing and gone.
pub fn read(
    from: &mut TcpStream,
    patience: Duration,
    most: impl Fn(&Request) -> usize,
) -> Result<Option<Request>, Refusal> {
    let started = Instant::now();
    let end = started + patience;
    let mut bytes = Vec::new();
    let (mut request, head, length) = loop {
        if let Some(read) = head(&bytes)? {
            break read;
        }
        if bytes.len() >= HEAD {
            return Err(Refusal::TooLong);
        }
        if !more(from, &mut bytes, end)? {
            return if bytes.is_empty() {
                Ok(None)
            } else {
                Err(Refusal::Malformed)
            };
        }
    };
    if length > most(&request) {
        return Err(Refusal::TooLong);
    }
    let end = started + with(patience, length);
    let whole = head + length;
    while bytes.len() < whole {
        if !more(from, &mut bytes, end)? {
            return Err(Refusal::Malformed);
        }
    }
    request.body = bytes[head..whole].to_vec();
    Ok(Some(request))
}

/// This patience with a text of so many bytes: what is longer may take longer.
fn with(patience: Duration, length: usize) -> Duration {
    patience + Duration::from_millis(length as u64 * 1000 / SLOWEST)
}

/// Reads what has come. False at its end.
fn more(from: &mut TcpStream, bytes: &mut Vec<u8>, end: Instant) -> Result<bool, Refusal> {
    let left = end.saturating_duration_since(Instant::now());
    if left.is_zero() {
        return Err(Refusal::Slow);
    }
    let mut part = [0; 16 << 10];
    let read = from
        .set_read_timeout(Some(left))
        .and_then(|()| from.read(&mut part));
    match read {
        Ok(0) => Ok(false),
        Ok(count) => {
            bytes.extend_from_slice(&part[..count]);
            Ok(true)
        }
        Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {
            Err(Refusal::Slow)
        }
        Err(error) if error.kind() == ErrorKind::Interrupted => Ok(true),
        Err(_) => Ok(false),
    }
}

/// A head, its length and that of what follows; `None` where it is not complete.
fn head(bytes: &[u8]) -> Result<Option<(Request, usize, usize)>, Refusal> {
    let mut room = [httparse::EMPTY_HEADER; HEADERS];
    let mut parsed = httparse::Request::new(&mut room);
    let length = match parsed.parse(bytes) {
        Ok(httparse::Status::Complete(length)) => length,
        Ok(httparse::Status::Partial) => return Ok(None),
        Err(httparse::Error::TooManyHeaders) => return Err(Refusal::TooLong),
        Err(_) => return Err(Refusal::Malformed),
    };
    if length > HEAD {
        return Err(Refusal::TooLong);
    }
    let text = |value: &[u8]| String::from_utf8(value.to_vec()).map_err(|_| Refusal::Malformed);
    let mut headers = Vec::new();
    for header in parsed.headers.iter() {
        headers.push((header.name.to_ascii_lowercase(), text(header.value)?));
    }
    let path = parsed.path.unwrap_or_default();
    let request = Request {
        method: parsed.method.unwrap_or_default().to_owned(),
        path: path.split('?').next().unwrap_or_default().to_owned(),
        headers,
        body: Vec::new(),
    };
    // Two lengths, or one in pieces, are read in different ways by different programs.
    if request.counts("transfer-encoding") > 0 || request.counts("content-length") > 1 {
        return Err(Refusal::Malformed);
    }
    let follows = match request.header("content-length") {
        Some(digits) if digits.bytes().all(|digit| digit.is_ascii_digit()) => {
            digits.parse().map_err(|_| Refusal::TooLong)?
        }
        Some(_) => return Err(Refusal::Malformed),
        None => 0,
    };
    Ok(Some((request, length, follows)))
}

/// Begins an answer whose end is the end of the connection.
pub fn begin(to: &mut TcpStream, status: &str, kind: &str, more: &str) -> io::Result<()> {
    let head = format!("HTTP/1.1 {status}\r\nContent-Type: {kind}\r\n{ALWAYS}{more}\r\n");
    send(to, head.as_bytes())
}

/// Answers, and ends the connection.
pub fn answer(mut to: TcpStream, status: &str, kind: &str, more: &str, body: &[u8]) {
    let length = format!("{more}Content-Length: {}\r\n", body.len());
    let sent = begin(&mut to, status, kind, &length).and_then(|()| send(&mut to, body));
    if sent.is_err() || to.shutdown(Shutdown::Write).is_err() {
        return;
    }
    let end = Instant::now() + LINGER;
    let mut rest = Vec::new();
    while rest.len() < 64 << 10 && more_of(&mut to, &mut rest, end) {}
}

fn more_of(from: &mut TcpStream, rest: &mut Vec<u8>, end: Instant) -> bool {
    more(from, rest, end).unwrap_or(false)
}

/// Refuses.
pub fn refuse(to: TcpStream, refusal: Refusal) {
    let body = refusal.json();
    answer(
        to,
        refusal.status(),
        "application/json",
        "",
        body.as_bytes(),
    );
}

/// Sends all of it before the deadline, or none of it is of use: then the connection has to end.
pub fn send(to: &mut TcpStream, mut bytes: &[u8]) -> io::Result<()> {
    let end = Instant::now() + with(PATIENCE, bytes.len());
    while !bytes.is_empty() {
        let left = end.saturating_duration_since(Instant::now());
        if left.is_zero() {
            return Err(ErrorKind::TimedOut.into());
        }
        to.set_write_timeout(Some(left))?;
        match to.write(bytes) {
            Ok(0) => return Err(ErrorKind::WriteZero.into()),
            Ok(count) => bytes = &bytes[count..],
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    Ok(())
}
