//! The server: a thread for each connection, and few of them.
//!
//! It must not know a bus: what it shows comes from [`Feed`], and nothing that a client does keeps the side of the bus
//! waiting.

use std::io::{self, ErrorKind};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use nix::sys::socket::{setsockopt, sockopt};

use crate::assets;
use crate::feed::Feed;
use crate::guard::Place;
use crate::http::{self, Request};
use crate::ledger::Answer;
use crate::machine::{Machine, Sheet};
use crate::pace::Pace;
use crate::posted::{self, Posted};
use crate::programs::Programs;
use crate::refusal::Refusal;
use crate::seats::{Seat, Urgent, turn_away};
use crate::session::{Right, Sessions, Token, Tokens};
use crate::texts::{self, Sent};

/// Connections at a time. Beyond them hold and stop still come through.
pub const CONNECTIONS: usize = 32;
/// For each: as much as a command has, because an order does what a command does.
const STACK: usize = 8 << 20;
/// Those of them that watch. Others always find room.
pub const STREAMS: usize = 16;
/// A stream with no news says so often that it is there, and so finds out who has gone. A page waits
/// for three times as long.
const ALIVE: Duration = Duration::from_secs(1);
/// What the kernel keeps for one who does not read, in bytes: a few messages, so that nobody is shown old ones for long.
const KEPT: usize = 4096;
/// After a failure to accept; out of descriptors, it would come back at once.
const PAUSE: Duration = Duration::from_millis(50);

/// A token that nobody can guess.
///
/// # Errors
/// The computer gives no random numbers.
pub fn fresh_token() -> io::Result<Token> {
    let mut chance = [0; 16];
    getrandom::fill(&mut chance).map_err(io::Error::other)?;
    Ok(Token::new(chance))
}

struct Shared {
    place: Place,
    sessions: Mutex<Sessions>,
    feed: Arc<Feed>,
    posted: Posted,
    machine: Arc<dyn Machine>,
    programs: Option<Arc<Programs>>,
    connections: Arc<AtomicUsize>,
    streams: Arc<AtomicUsize>,
    urgent: Urgent,
    /// Connections for which only a place for hold and stop was left.
    late: AtomicU64,
    over: AtomicBool,
}

impl Shared {
    fn sessions(&self) -> MutexGuard<'_, Sessions> {
        // Nothing panics with it in hand; each cookie in it is whole all the same.
        self.sessions.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A server at work. It ends with the process, or when it is dropped.
pub struct Server {
    /// Where it listens.
    pub address: SocketAddr,
    shared: Arc<Shared>,
}

impl Server {
    /// Listens. Without a folder of programs the page has none.
    ///
    /// # Errors
    /// The address is not to be had.
    pub fn start(
        listen: SocketAddr,
        names: &[String],
        tokens: Tokens,
        feed: Arc<Feed>,
        machine: Arc<dyn Machine>,
        programs: Option<Arc<Programs>>,
    ) -> io::Result<Self> {
        let listener = TcpListener::bind(listen)?;
        let address = listener.local_addr()?;
        let shared = Arc::new(Shared {
            place: Place::new(address, names),
            sessions: Mutex::new(Sessions::new(tokens)),
            posted: Posted::new(Arc::clone(&machine), Arc::clone(&feed)),
            machine,
            programs,
            feed,
            connections: Arc::default(),
            streams: Arc::default(),
            urgent: Urgent::default(),
            late: AtomicU64::new(0),
            over: AtomicBool::new(false),
        });
        let accepts = Arc::clone(&shared);
        thread::Builder::new().spawn(move || accept(&listener, &accepts))?;
        Ok(Self { address, shared })
    }

    /// Tells all pages who operates, where it has changed; time changes it, so this has to be called again and again.
    pub fn attend(&self) {
        self.shared.posted.tell();
    }

    /// Nobody operates any more: whoever wants to, takes the lease anew.
    pub fn release(&self) {
        self.shared.posted.release();
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.shared.over.store(true, Ordering::Relaxed);
        self.shared.feed.end();
        // The thread that accepts looks at it once somebody connects.
        let _ = TcpStream::connect(self.address);
    }
}

fn accept(listener: &TcpListener, shared: &Arc<Shared>) {
    for connection in listener.incoming() {
        if shared.over.load(Ordering::Relaxed) {
            return;
        }
        let Ok(stream) = connection else {
            thread::sleep(PAUSE);
            continue;
        };
        let Some(seat) = Seat::take(&shared.connections, CONNECTIONS) else {
            serve_late(stream, shared);
            continue;
        };
        let own = Arc::clone(shared);
        // Where no thread is to be had, connection and seat go with what it would have done.
        let _ = thread::Builder::new().stack_size(STACK).spawn(move || {
            serve(stream, &own);
            drop(seat);
        });
    }
}

fn serve(mut stream: TcpStream, shared: &Shared) {
    match http::read(&mut stream, http::PATIENCE, |head| most(head, shared)) {
        Ok(None) => {}
        Err(refusal) => http::refuse(stream, refusal),
        Ok(Some(request)) => {
            if let Err((stream, refusal)) = route(stream, &request, shared) {
                http::refuse(stream, refusal);
            }
        }
    }
}

/// How long the text behind a head may be: programs and changes of tables are long, and only who may write them is listened
/// to for so long.
fn most(head: &Request, shared: &Shared) -> usize {
    let limit = match (&*head.method, &*head.path) {
        ("PUT", path) if texts::is_one(path) => crate::programs::LONGEST,
        ("POST", "/order") => http::ORDER,
        _ => http::BODY,
    };
    let may = || {
        let cookie = head.cookie(shared.place.cookie());
        shared.place.check(head).is_ok() && admit(cookie, shared) == Ok(Right::Operate)
    };
    if limit > http::BODY && may() {
        limit
    } else {
        http::BODY
    }
}

/// Serves one that has come when all seats were taken: hold and stop, and nothing else.
fn serve_late(mut stream: TcpStream, shared: &Arc<Shared>) {
    let number = shared.late.fetch_add(1, Ordering::Relaxed);
    if shared.urgent.wait(number, &stream).is_err() {
        return turn_away(&stream);
    }
    let own = Arc::clone(shared);
    let spawned = thread::Builder::new().spawn(move || {
        let read = http::read(&mut stream, http::URGENT, |_| http::BODY);
        if !own.urgent.has_said(number) {
            return;
        }
        match read {
            Ok(Some(request)) if is_halt(&request, &own) => {
                if let Err((stream, refusal)) = route(stream, &request, &own) {
                    http::refuse(stream, refusal);
                }
            }
            _ => turn_away(&stream),
        }
    });
    if spawned.is_err() {
        // The connection has gone with the thread that was to serve it.
        shared.urgent.has_said(number);
    }
}

/// Whether it is hold or stop, of somebody who may order: nobody else keeps a thread waiting beyond the seats.
fn is_halt(request: &Request, shared: &Shared) -> bool {
    let cookie = request.cookie(shared.place.cookie());
    request.method == "POST"
        && request.path == "/order"
        && posted::halts(&request.body)
        && admit(cookie, shared) == Ok(Right::Operate)
}

/// Answers, or gives the connection back with the reason why not.
fn route(
    stream: TcpStream,
    request: &Request,
    shared: &Shared,
) -> Result<(), (TcpStream, Refusal)> {
    if let Err(refusal) = shared.place.check(request) {
        return Err((stream, refusal));
    }
    match (request.method.as_str(), request.path.as_str()) {
        ("GET", "/state") => watch(stream, request, shared),
        ("POST", "/login") => match login(request, shared) {
            Ok(cookie) => {
                http::answer(stream, "200 OK", "application/json", &cookie, b"{}");
                Ok(())
            }
            Err(refusal) => Err((stream, refusal)),
        },
        ("POST", "/order") => post(stream, request, shared, Posted::order),
        (_, path) if texts::is_one(path) => match text_of(request, shared) {
            Ok(sent) => {
                http::answer(stream, sent.status, sent.kind, &sent.more, &sent.body);
                Ok(())
            }
            Err(refusal) => Err((stream, refusal)),
        },
        (_, path) if Sheet::at(path).is_some() => match sheet_of(request, shared) {
            Ok(text) => {
                http::answer(stream, "200 OK", "application/json", "", text.as_bytes());
                Ok(())
            }
            Err(refusal) => Err((stream, refusal)),
        },
        ("POST", "/jog") => post(stream, request, shared, Posted::jog),
        ("POST", "/lease") => post(stream, request, shared, Posted::lease),
        (method, path) => match assets::find(path) {
            Some((kind, text)) if method == "GET" => {
                http::answer(stream, "200 OK", kind, "", text.as_bytes());
                Ok(())
            }
            Some(_) => Err((stream, Refusal::Method)),
            None if matches!(path, "/state" | "/login" | "/order" | "/jog" | "/lease") => {
                Err((stream, Refusal::Method))
            }
            None => Err((stream, Refusal::NotFound)),
        },
    }
}

/// Does what a page that operates has sent, if its link is good for that.
fn post(
    stream: TcpStream,
    request: &Request,
    shared: &Shared,
    act: impl Fn(&Posted, &str, &[u8]) -> Result<Answer, Refusal>,
) -> Result<(), (TcpStream, Refusal)> {
    let cookie = request.cookie(shared.place.cookie());
    let answer = match admit(cookie, shared) {
        Ok(Right::Look) => Err(Refusal::Looks),
        Ok(Right::Operate) => act(&shared.posted, cookie.unwrap_or_default(), &request.body),
        Err(refusal) => Err(refusal),
    };
    match answer {
        Ok((status, text)) => {
            http::answer(stream, status, "application/json", "", text.as_bytes());
            Ok(())
        }
        Err(refusal) => Err((stream, refusal)),
    }
}

/// Answers what is about programs: whoever may look reads them, whoever may operate writes them.
fn text_of(request: &Request, shared: &Shared) -> Result<Sent, Refusal> {
    let right = admit(request.cookie(shared.place.cookie()), shared)?;
    let programs = shared.programs.as_ref().ok_or(Refusal::NoStore)?;
    texts::answer(request, right, programs, &*shared.machine)
}

/// What is in a table: whoever may look reads it. It is changed by an order.
fn sheet_of(request: &Request, shared: &Shared) -> Result<String, Refusal> {
    admit(request.cookie(shared.place.cookie()), shared)?;
    match (&*request.method, Sheet::at(&request.path)) {
        ("GET", Some(sheet)) => {
            let zh = request.header("accept-language") == Some("zh");
            Ok(shared.machine.sheet(sheet, zh))
        }
        _ => Err(Refusal::Method),
    }
}

fn admit(cookie: Option<&str>, shared: &Shared) -> Result<Right, Refusal> {
    shared.sessions().admit(cookie)
}

/// The header that sets the cookie; nothing where the one that there is stays.
fn login(request: &Request, shared: &Shared) -> Result<String, Refusal> {
    let body: serde_json::Value =
        serde_json::from_slice(&request.body).map_err(|_| Refusal::Malformed)?;
    let token = body["token"].as_str().ok_or(Refusal::Malformed)?;
    let fresh = fresh_token().map_err(|_| Refusal::Busy)?;
    let name = shared.place.cookie();
    let own = request.cookie(name);
    let operator = shared.posted.operator();
    let mut sessions = shared.sessions();
    let Some(cookie) = sessions.login(token, own, operator.as_deref(), fresh)? else {
        return Ok(String::new());
    };
    let cookie = cookie.text();
    let by_tls = request
        .header("origin")
        .is_some_and(|origin| origin.starts_with("https:"));
    let secure = if by_tls { "; Secure" } else { "" };
    Ok(format!(
        "Set-Cookie: {name}={cookie}; Path=/; HttpOnly; SameSite=Strict{secure}\r\n"
    ))
}

/// Tells one who watches what the machine says, until one of both is gone.
fn watch(
    mut stream: TcpStream,
    request: &Request,
    shared: &Shared,
) -> Result<(), (TcpStream, Refusal)> {
    let cookie = request.cookie(shared.place.cookie());
    let watching = shared.sessions().watch(cookie);
    let _watching = match watching {
        Ok(watching) => watching,
        Err(refusal) => return Err((stream, refusal)),
    };
    let Some(_seat) = Seat::take(&shared.streams, STREAMS) else {
        return Err((stream, Refusal::Busy));
    };
    // It ends with the first error, of which there is nobody left to be told.
    let _ = setsockopt(&stream, sockopt::SndBuf, &KEPT)
        .map_err(io::Error::from)
        .and_then(|()| stream.set_nodelay(true))
        .and_then(|()| http::begin(&mut stream, "200 OK", "text/event-stream", ""))
        .and_then(|()| pass_on(&mut stream, &shared.feed));
    Ok(())
}

fn pass_on(stream: &mut TcpStream, feed: &Feed) -> io::Result<()> {
    let mut last = 0;
    let mut pace = Pace::new(Instant::now());
    while let Some(news) = feed.behind(last, ALIVE) {
        let mut text = String::new();
        for (number, kind, json) in news {
            last = number;
            text.push_str(&format!("event: {kind}\ndata: {json}\n\n"));
        }
        if text.is_empty() {
            // No comment: of that a page is told nothing.
            text.push_str("event: alive\ndata: {}\n\n");
        }
        http::send(stream, text.as_bytes())?;
        // What is told meanwhile takes the place of what was told before.
        let now = Instant::now();
        thread::sleep(pace.next(now) - now);
    }
    Err(ErrorKind::UnexpectedEof.into())
}
