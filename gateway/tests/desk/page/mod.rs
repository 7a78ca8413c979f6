//! The page at the machine against a machine that stays: what it is told, what it orders, and what its end changes.

#[cfg(feature = "browser")]
mod browser;
mod jog;
mod lost;
mod orders;
mod programs;
mod retract;
mod shown;
mod spindle;
mod tables;
mod touch;

use std::cell::Cell;
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::TcpStream;
use std::process::{Child, Stdio};
use std::sync::mpsc::{Receiver, TrySendError, sync_channel};
use std::time::Instant;

use serde_json::{Value, json};

use crate::{LIMIT, LONG, User, bad, good};

/// A thread of a few short passes.
const THREAD: &str =
    "G98\nM3 S800\nG0 X30 Z4\nG76 P011060 Q150 R0.02\nG76 X29 Z-8 P500 Q300 F1.5\nM5\nM30\n";

/// Numbers below a limit, always the same ones from a seed.
fn chance(seed: u64) -> impl FnMut(u64) -> u64 {
    let mut random = leadscrew_seed::Random(seed);
    move |limit| random.below(limit)
}

/// A panel at work.
struct Page {
    child: Child,
    address: String,
    /// To operate; where nobody does, none.
    token: Option<String>,
    /// To look.
    look: String,
}

impl Page {
    fn start(user: &User) -> Self {
        Self::with(user, &[])
    }

    fn with(user: &User, more: &[&str]) -> Self {
        let args = [&["panel", "--listen", "127.0.0.1:0", "--json"], more].concat();
        let mut command = user.command(&args);
        let mut child = command.stdout(Stdio::piped()).spawn().unwrap();
        let mut line = String::new();
        let mut output = BufReader::new(child.stdout.take().unwrap());
        output.read_line(&mut line).unwrap();
        let told: Value = serde_json::from_str(&line).unwrap();
        let link = |key: &str| told[key][0].as_str().map(parts);
        let (address, look) = link("look").unwrap();
        Self {
            child,
            address,
            token: link("links").map(|(_, token)| token),
            look,
        }
    }

    fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(&self.address).unwrap();
        stream.set_read_timeout(Some(LIMIT)).unwrap();
        stream
    }

    /// The answer to a request with these headers besides the host: its status and what follows its head.
    fn ask(&self, line: &str, headers: &[&str], body: &str) -> (u16, String, String) {
        let mut stream = self.connect();
        let head = headers.join("\r\n");
        write!(
            stream,
            "{line} HTTP/1.1\r\nHost: {}\r\nContent-Length: {}\r\n{head}\r\n\r\n{body}",
            self.address,
            body.len()
        )
        .unwrap();
        let mut answer = String::new();
        stream.read_to_string(&mut answer).unwrap();
        let (head, body) = answer.split_once("\r\n\r\n").unwrap();
        let status = head.split(' ').nth(1).unwrap().parse().unwrap();
        (status, head.to_owned(), body.to_owned())
    }

    /// What a page of it sends.
    fn post(&self, cookie: &str, path: &str, body: &Value) -> (u16, Value) {
        let origin = format!("Origin: http://{}", self.address);
        let cookie = format!("Cookie: {cookie}");
        let headers = [
            &*origin,
            "X-Leadscrew: 1",
            "Content-Type: application/json",
            &cookie,
        ];
        let (status, _, text) = self.ask(&format!("POST {path}"), &headers, &body.to_string());
        (status, serde_json::from_str(&text).unwrap())
    }

    /// The cookie for a token.
    fn login(&self, token: &str) -> String {
        let origin = format!("Origin: http://{}", self.address);
        let headers = [&*origin, "X-Leadscrew: 1", "Content-Type: application/json"];
        let body = json!({"token": token}).to_string();
        let (_, head, _) = self.ask("POST /login", &headers, &body);
        head.lines()
            .find_map(|line| line.strip_prefix("Set-Cookie: "))
            .and_then(|set| set.split(';').next())
            .unwrap()
            .to_owned()
    }

    /// What is told from now on, behind the head.
    fn watch(&self) -> BufReader<TcpStream> {
        let cookie = self.login(&self.look);
        let mut stream = self.connect();
        let address = &self.address;
        write!(
            stream,
            "GET /state HTTP/1.1\r\nHost: {address}\r\nCookie: {cookie}\r\n\r\n"
        )
        .unwrap();
        BufReader::new(stream)
    }

    /// A page that may operate.
    fn client<'a>(&'a self, name: &str) -> Client<'a> {
        Client {
            page: self,
            cookie: self.login(self.token.as_deref().unwrap()),
            name: name.to_owned(),
            number: 0,
            operates: Cell::new(false),
            told: Told::from(self.watch()),
        }
    }
}

impl Drop for Page {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Address and token of a link.
fn parts(link: &str) -> (String, String) {
    let (address, token) = link
        .strip_prefix("http://")
        .and_then(|link| link.split_once("/#"))
        .unwrap();
    (address.to_owned(), token.to_owned())
}

/// A page as it stands in a browser.
struct Client<'a> {
    page: &'a Page,
    cookie: String,
    name: String,
    number: u64,
    operates: Cell<bool>,
    told: Told,
}

/// What the page shows: the newest state, as it comes.
struct Told(Receiver<Value>);

impl Told {
    fn from(mut stream: BufReader<TcpStream>) -> Self {
        // Nobody waits for it: what is not taken is not the newest any more.
        let (send, told) = sync_channel(0);
        std::thread::spawn(move || {
            while let Some(s) = next(&mut stream, "s") {
                if let Err(TrySendError::Disconnected(_)) = send.try_send(s) {
                    return;
                }
            }
        });
        Self(told)
    }
}

impl Client<'_> {
    /// The next state that the machine tells.
    fn state(&self) -> Value {
        loop {
            let s = self.told.0.recv_timeout(LIMIT).unwrap();
            if s["beat"].is_u64() {
                return s;
            }
        }
    }

    fn lease(&self, what: &str) -> Value {
        let body = json!({"c": self.name, "do": what});
        let (status, answer) = self.page.post(&self.cookie, "/lease", &body);
        assert_eq!(status, 200, "{answer}");
        answer
    }

    /// Operates from now on.
    #[track_caller]
    fn take(&self) {
        let answer = self.lease("take");
        assert!(answer["yours"].is_u64(), "{answer}");
        self.operates.set(true);
    }

    /// Still operates: on a busy computer a lease lapses between two steps of a test.
    fn renew(&self) {
        if self.operates.get() {
            self.lease("take");
        }
    }

    /// An order with this number and this beat.
    fn numbered(&self, number: u64, op: &str, args: &Value, echo: &Value) -> (u16, Value) {
        self.renew();
        let body = json!({"c": self.name, "n": number, "op": op, "args": args, "echo": echo});
        self.page.post(&self.cookie, "/order", &body)
    }

    /// The next order, with the newest beat. On a computer that is busy that may be old when it comes: then it is given
    /// again, as a person would, and the lease is kept meanwhile.
    fn orders(&mut self, op: &str, args: &Value) -> (u16, Value) {
        let end = Instant::now() + LIMIT;
        loop {
            self.number += 1;
            let (status, answer) = self.numbered(self.number, op, args, &self.state()["beat"]);
            let why = answer["en"].as_str().unwrap_or_default();
            if !why.starts_with("what the board says is old") {
                return (status, answer);
            }
            assert!(Instant::now() < end, "{answer}");
        }
    }

    /// The same of one that is done.
    #[track_caller]
    fn does(&mut self, op: &str, args: &Value) {
        assert_eq!(self.orders(op, args), (200, json!({"ok": true})), "{op}");
    }
}

/// Reads until a message of this kind is so.
#[track_caller]
fn wait(told: &mut impl std::io::BufRead, kind: &str, done: impl Fn(&Value) -> bool) -> Value {
    let end = Instant::now() + LIMIT;
    while let Some(message) = next(told, kind) {
        if done(&message) {
            return message;
        }
        assert!(Instant::now() < end, "{message}");
    }
    panic!("the page ends");
}

/// The next message of this kind; `None` at the end.
fn next(told: &mut impl std::io::BufRead, kind: &str) -> Option<Value> {
    let mut last = String::new();
    for line in told.lines() {
        let line = line.ok()?;
        if let Some(kind) = line.strip_prefix("event: ") {
            last = kind.to_owned();
        } else if let Some(json) = line.strip_prefix("data: ")
            && last == kind
        {
            return Some(serde_json::from_str(json).unwrap());
        }
    }
    None
}

#[test]
fn the_page_is_told_what_the_machine_does_and_its_end_changes_nothing() {
    let user = User::with_machine();
    let page = Page::start(&user);
    let mut told = page.watch();
    let hello = wait(&mut told, "hello", |_| true);
    assert_eq!(hello["bus"], "sim:desk");
    let idle = wait(&mut told, "s", |s| s["state"] == "idle");
    assert_eq!(
        (&idle["mode"], &idle["alarm"], &idle["line"], &idle["feed"]),
        (&"manual".into(), &Value::Null, &Value::Null, &100.into())
    );
    let mut run = user.run(LONG);
    let s = wait(&mut told, "s", |s| s["state"] == "run" && s["line"] == "1");
    assert!(s["mz"].as_f64().unwrap() <= 0.0);
    // Positions by the work's zero follow once the table of offsets is read.
    wait(&mut told, "s", |s| {
        s["zero"] == "G54 T00" && s["wz"] == s["mz"]
    });
    good(&user.does(&["override", "feed", "80"]));
    wait(&mut told, "s", |s| s["feed"] == 80);
    // The page dies, and the program goes on.
    drop(page);
    assert_eq!(user.json(&["status"])["state"], "run");
    // Another one sees what has happened before it.
    good(&user.does(&["stop"]));
    let _ = run.wait().unwrap();
    let page = Page::start(&user);
    let mut told = page.watch();
    let s = wait(&mut told, "s", |s| s["state"] == "alarm");
    let number = s["number"].as_i64().unwrap();
    for key in ["text", "help"] {
        let [en, zh] = [0, 1].map(|at| s["alarm"][key][at].as_str().unwrap());
        assert!(!en.is_empty() && en.is_ascii() && !zh.is_ascii(), "{s}");
    }
    let text = format!("{number:04}");
    // The log is told before the state, and once.
    wait(&mut page.watch(), "log", |log| {
        let list = log.as_array().unwrap();
        list.iter()
            .any(|entry| entry["text"][0].as_str().unwrap().contains(&text))
    });
    // Its place is taken.
    let taken = bad(&user.does(&["panel", "--listen", &page.address]), 2);
    assert!(taken.contains("choose another address"), "{taken}");
}
