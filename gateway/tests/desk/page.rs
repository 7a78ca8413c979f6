//! The page at the machine against a machine that stays: what it is told, and what its end changes.

use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::TcpStream;
use std::process::{Child, Stdio};
use std::time::Instant;

use serde_json::Value;

use crate::{LIMIT, LONG, User, bad, good};

/// A panel at work.
struct Page {
    child: Child,
    address: String,
    token: String,
}

impl Page {
    fn start(user: &User) -> Self {
        let mut command = user.command(&["panel", "--listen", "127.0.0.1:0", "--json"]);
        let mut child = command.stdout(Stdio::piped()).spawn().unwrap();
        let mut line = String::new();
        let mut output = BufReader::new(child.stdout.take().unwrap());
        output.read_line(&mut line).unwrap();
        let told: Value = serde_json::from_str(&line).unwrap();
        let link = told["links"][0].as_str().unwrap();
        let (address, token) = link
            .strip_prefix("http://")
            .and_then(|link| link.split_once("/#"))
            .unwrap();
        Self {
            child,
            address: address.to_owned(),
            token: token.to_owned(),
        }
    }

    fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(&self.address).unwrap();
        stream.set_read_timeout(Some(LIMIT)).unwrap();
        stream
    }

    /// What is told from now on, behind the head.
    fn watch(&self) -> BufReader<TcpStream> {
        let address = &self.address;
        let body = format!("{{\"token\":\"{}\"}}", self.token);
        let mut stream = self.connect();
        let length = body.len();
        write!(
            stream,
            "POST /login HTTP/1.1\r\nHost: {address}\r\nOrigin: http://{address}\r\nX-Leadscrew: 1\r\n\
             Content-Type: application/json\r\nContent-Length: {length}\r\n\r\n{body}"
        )
        .unwrap();
        let mut answer = String::new();
        stream.read_to_string(&mut answer).unwrap();
        let cookie = answer
            .lines()
            .find_map(|line| line.strip_prefix("Set-Cookie: "))
            .and_then(|set| set.split(';').next())
            .unwrap();
        let mut stream = self.connect();
        write!(
            stream,
            "GET /state HTTP/1.1\r\nHost: {address}\r\nCookie: {cookie}\r\n\r\n"
        )
        .unwrap();
        BufReader::new(stream)
    }
}

impl Drop for Page {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Reads until a message of this kind is so.
#[track_caller]
fn wait(told: &mut impl std::io::BufRead, kind: &str, done: impl Fn(&Value) -> bool) -> Value {
    let (end, mut last) = (Instant::now() + LIMIT, String::new());
    for line in told.lines() {
        let line = line.unwrap();
        if let Some(kind) = line.strip_prefix("event: ") {
            last = kind.to_owned();
        } else if let Some(json) = line.strip_prefix("data: ") {
            let message: Value = serde_json::from_str(json).unwrap();
            if last == kind && done(&message) {
                return message;
            }
            assert!(Instant::now() < end, "{message}");
        }
    }
    panic!("the page ends");
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
