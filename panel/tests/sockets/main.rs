//! The server over real sockets: each refusal, clients that are slow or say nothing, and what one who watches is told.

mod programs;
mod tables;

use std::io::{Read as _, Write as _};
use std::net::{Shutdown, SocketAddr, TcpStream};
use std::path::Path;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use leadscrew_panel::{
    CONNECTIONS, Feed, Jog, Machine, Order, Programs, Refusal, STREAMS, Server, Sheet, Token,
    Tokens, View,
};

/// Nothing takes so long on any computer.
const LIMIT: Duration = Duration::from_secs(60);
const TOKEN: Token = Token::new([0xA5; 16]);

const LOOK: Token = Token::new([0x5A; 16]);

/// Notes what it is asked. What is told to wait waits for the gate.
#[derive(Default)]
struct Noted(Mutex<Vec<String>>, Mutex<()>);

impl Machine for Noted {
    fn order(&self, order: &Order) -> Option<String> {
        self.0.lock().unwrap().push(order.op.clone());
        if order.args == "wait" {
            drop(self.1.lock().unwrap());
        }
        Some("{\"ok\":true}".into())
    }

    fn jog(&self, jog: &Jog) -> String {
        self.0.lock().unwrap().push(format!("{:?}", jog.axes));
        "{\"ok\":true}".into()
    }

    fn view(&self, program: &Path, view: View, zh: bool) -> String {
        let name = program.file_name().unwrap();
        format!("{{\"seen\":{name:?},\"view\":\"{view:?}\",\"zh\":{zh}}}")
    }

    fn sheet(&self, sheet: Sheet, zh: bool) -> String {
        format!("{{\"sheet\":\"{sheet:?}\",\"zh\":{zh}}}")
    }
}

struct Bench {
    server: Server,
    feed: Arc<Feed>,
    machine: Arc<Noted>,
}

impl Bench {
    fn new() -> Self {
        Self::with(None)
    }

    fn with(programs: Option<Arc<Programs>>) -> Self {
        let feed = Arc::new(Feed::default());
        let listen = SocketAddr::from(([127, 0, 0, 1], 0));
        let names = ["panel.example".to_owned()];
        let tokens = Tokens {
            look: LOOK,
            operate: Some(TOKEN),
        };
        let machine = Arc::new(Noted::default());
        let owned = Arc::clone(&machine);
        let told = Arc::clone(&feed);
        let server = Server::start(listen, &names, tokens, told, owned, programs).unwrap();
        Self {
            server,
            feed,
            machine,
        }
    }

    fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(self.server.address).unwrap();
        stream.set_read_timeout(Some(LIMIT)).unwrap();
        stream
    }

    /// All of the answer to these bytes; of a stream, which has no end, its head.
    fn ask(&self, bytes: &[u8]) -> String {
        let mut stream = self.connect();
        stream.write_all(bytes).unwrap();
        let mut answer = until(&mut stream, "\r\n\r\n");
        if !answer.contains("Content-Type: text/event-stream\r\n") {
            stream.read_to_string(&mut answer).unwrap();
        }
        answer
    }

    /// A request with this server's name, and these headers.
    fn request(&self, line: &str, headers: &[&str], body: &str) -> String {
        let host = format!("Host: {}", self.server.address);
        let length = format!("Content-Length: {}", body.len());
        let head = [&[line, &host, &length], headers].concat().join("\r\n");
        format!("{head}\r\n\r\n{body}")
    }

    fn get(&self, path: &str, headers: &[&str]) -> String {
        self.ask(
            self.request(&format!("GET {path} HTTP/1.1"), headers, "")
                .as_bytes(),
        )
    }

    fn origin(&self) -> String {
        format!("Origin: http://{}", self.server.address)
    }

    /// What the page itself sends.
    fn post(&self, path: &str, body: &str) -> String {
        self.post_as("X: y", path, body)
    }

    /// The same with a cookie.
    fn post_as(&self, cookie: &str, path: &str, body: &str) -> String {
        let headers = [
            &self.origin(),
            "X-Leadscrew: 1",
            "Content-Type: application/json",
            cookie,
        ];
        self.ask(
            self.request(&format!("POST {path} HTTP/1.1"), &headers, body)
                .as_bytes(),
        )
    }

    fn login(&self) -> String {
        self.login_with(TOKEN)
    }

    fn login_with(&self, token: Token) -> String {
        let answer = self.post("/login", &format!("{{\"token\":\"{}\"}}", token.text()));
        assert!(answer.starts_with("HTTP/1.1 200 OK\r\n"), "{answer}");
        let set = answer
            .lines()
            .find_map(|line| line.strip_prefix("Set-Cookie: "))
            .unwrap();
        let (cookie, rest) = set.split_once(';').unwrap();
        assert_eq!(rest, " Path=/; HttpOnly; SameSite=Strict");
        format!("Cookie: {cookie}")
    }

    /// A stream, and the end of what its head has brought.
    fn watch(&self, cookie: &str) -> TcpStream {
        let mut stream = self.connect();
        let request = self.request("GET /state HTTP/1.1", &[cookie], "");
        stream.write_all(request.as_bytes()).unwrap();
        until(&mut stream, "\r\n\r\n");
        stream
    }
}

/// Reads until this has come.
#[track_caller]
fn until(stream: &mut TcpStream, end: &str) -> String {
    let (mut text, mut byte) = (Vec::new(), [0]);
    while !text.ends_with(end.as_bytes()) {
        let read = stream.read(&mut byte).unwrap();
        assert_eq!(read, 1, "{}", String::from_utf8_lossy(&text));
        text.push(byte[0]);
    }
    String::from_utf8(text).unwrap()
}

#[track_caller]
fn refused(answer: &str, refusal: Refusal) {
    let status = format!("HTTP/1.1 {}\r\n", refusal.status());
    assert!(answer.starts_with(&status), "{answer}");
    assert!(answer.ends_with(&refusal.json()), "{answer}");
}

#[test]
fn the_page_is_given_out_and_loads_nothing_from_elsewhere() {
    let bench = Bench::new();
    for (path, kind) in [
        ("/", "text/html"),
        ("/?x", "text/html"),
        ("/panel.js", "text/javascript"),
        ("/press.js", "text/javascript"),
        ("/show.js", "text/javascript"),
        ("/transport.js", "text/javascript"),
        ("/words.js", "text/javascript"),
        ("/style.css", "text/css"),
    ] {
        let answer = bench.get(path, &[]);
        assert!(answer.starts_with("HTTP/1.1 200 OK\r\n"), "{answer}");
        assert!(answer.contains(&format!("Content-Type: {kind}; charset=utf-8\r\n")));
        assert!(answer.contains("Content-Security-Policy: default-src 'none'; script-src 'self'"));
        assert!(answer.contains("frame-ancestors 'none'\r\n"));
        assert!(
            !answer.contains("http://") && !answer.contains("https://"),
            "{path}"
        );
    }
}

#[test]
fn who_is_not_this_page_is_refused() {
    let bench = Bench::new();
    let address = bench.server.address;
    let ask = |text: &str| bench.ask(text.as_bytes());
    // A name that was pointed here, none, two, and another port.
    for host in [
        "Host: evil.example\r\n",
        "",
        "Host: 127.0.0.1\r\n",
        "Host: 127.0.0.1:1\r\n",
    ] {
        refused(
            &ask(&format!("GET / HTTP/1.1\r\n{host}\r\n")),
            Refusal::Host,
        );
    }
    let twice = format!("GET / HTTP/1.1\r\nHost: {address}\r\nHost: {address}\r\n\r\n");
    refused(&ask(&twice), Refusal::Host);
    for host in [
        format!("LOCALHOST:{}", address.port()),
        "panel.example".to_owned(),
    ] {
        let answer = ask(&format!("GET / HTTP/1.1\r\nHost: {host}\r\n\r\n"));
        assert!(answer.starts_with("HTTP/1.1 200 OK\r\n"), "{answer}");
    }
    let json = "Content-Type: application/json";
    let (own, mark) = (bench.origin(), "X-Leadscrew: 1");
    let post = |headers: &[&str]| ask(&bench.request("POST /login HTTP/1.1", headers, "{}"));
    for origin in [
        "Origin: null",
        "Origin: http://evil.example",
        "Origin: http://panel.example",
        "Origin: https://panel.example.evil",
        "X: y",
    ] {
        refused(&post(&[origin, mark, json]), Refusal::Origin);
    }
    refused(&post(&[&own, json]), Refusal::NotThePage);
    refused(&post(&[&own, mark]), Refusal::NotThePage);
    refused(
        &post(&[&own, mark, "Content-Type: text/plain"]),
        Refusal::NotThePage,
    );
    refused(
        &bench.get("/state", &["Origin: http://evil.example"]),
        Refusal::Origin,
    );
    refused(&bench.get("/nothing", &[]), Refusal::NotFound);
    refused(&bench.get("/../Cargo.toml", &[]), Refusal::NotFound);
    refused(&bench.get("/login", &[]), Refusal::Method);
    refused(&bench.post("/", "{}"), Refusal::Method);
    refused(&bench.post("/state", "{}"), Refusal::Method);
    for path in ["/order", "/jog", "/lease"] {
        refused(&bench.get(path, &[]), Refusal::Method);
    }
}

#[test]
fn an_order_needs_a_link_to_operate_and_comes_from_this_page() {
    let bench = Bench::new();
    let (operates, looks) = (bench.login(), bench.login_with(LOOK));
    let hold = "{\"c\":\"a\",\"n\":1,\"op\":\"hold\"}";
    let start = "{\"c\":\"a\",\"n\":2,\"op\":\"start\"}";
    let take = "{\"c\":\"a\",\"do\":\"take\"}";
    let jog = "{\"c\":\"a\",\"press\":1,\"axes\":[1,0],\"spindle\":0,\"rapid\":false,\"speed\":0,\"echo\":1}";
    for (path, body) in [("/order", hold), ("/lease", take), ("/jog", jog)] {
        refused(&bench.post(path, body), Refusal::Login);
        refused(&bench.post_as(&looks, path, body), Refusal::Looks);
        // Another page with the cookie of this one, and this page without what it sends.
        let (own, mark, json) = (
            bench.origin(),
            "X-Leadscrew: 1",
            "Content-Type: application/json",
        );
        let ask = |headers: &[&str]| {
            let line = format!("POST {path} HTTP/1.1");
            bench.ask(bench.request(&line, headers, body).as_bytes())
        };
        let foreign = "Origin: http://evil.example";
        refused(&ask(&[foreign, mark, json, &operates]), Refusal::Origin);
        refused(&ask(&[mark, json, &operates]), Refusal::Origin);
        refused(&ask(&[&own, json, &operates]), Refusal::NotThePage);
        refused(&ask(&[&own, mark, &operates]), Refusal::NotThePage);
        refused(&bench.post_as(&operates, path, "{"), Refusal::Malformed);
    }
    assert!(bench.machine.0.lock().unwrap().is_empty());
    let good = |path: &str, body: &str| {
        let answer = bench.post_as(&operates, path, body);
        assert!(answer.starts_with("HTTP/1.1 200 OK\r\n"), "{answer}");
    };
    good("/order", hold);
    refused(
        &bench.post_as(&operates, "/order", start),
        Refusal::NotOperating,
    );
    good("/lease", take);
    good("/jog", jog);
    good("/order", hold);
    good("/order", &start.replace('2', "3"));
    refused(&bench.post_as(&operates, "/order", start), Refusal::Older);
    assert_eq!(
        *bench.machine.0.lock().unwrap(),
        ["hold", "[1, 0]", "start"]
    );
}

#[test]
fn a_link_that_looks_takes_nothing_from_a_browser_that_operates() {
    let bench = Bench::new();
    let operates = bench.login();
    let login = |cookie: &str, token: Token| {
        let body = format!("{{\"token\":\"{}\"}}", token.text());
        bench.post_as(cookie, "/login", &body)
    };
    // Nor does its own link, opened once more: the lease is its cookie's.
    for token in [LOOK, TOKEN] {
        let answer = login(&operates, token);
        assert!(answer.starts_with("HTTP/1.1 200 OK\r\n"), "{answer}");
        assert!(!answer.contains("Set-Cookie"), "{answer}");
    }
    refused(&login(&operates, Token::new([1; 16])), Refusal::Token);
    let hold = "{\"c\":\"a\",\"n\":1,\"op\":\"hold\"}";
    let answer = bench.post_as(&operates, "/order", hold);
    assert!(answer.starts_with("HTTP/1.1 200 OK\r\n"), "{answer}");
    // The other way round it may operate from then on.
    let looks = bench.login_with(LOOK);
    assert!(login(&looks, TOKEN).contains("Set-Cookie: "));
}

#[test]
fn later_logins_take_nothing_from_who_watches_or_operates() {
    let bench = Bench::new();
    let (watches, operates, idle) = (bench.login(), bench.login(), bench.login());
    let take = "{\"c\":\"a\",\"do\":\"take\"}";
    let keep = "{\"c\":\"a\",\"do\":\"keep\"}";
    bench.post_as(&operates, "/lease", take);
    let _watching = bench.watch(&watches);
    for _ in 0..70 {
        bench.login_with(LOOK);
    }
    for kept in [&watches, &operates] {
        let answer = bench.post_as(kept, "/lease", keep);
        assert!(answer.starts_with("HTTP/1.1 200 OK\r\n"), "{answer}");
    }
    refused(&bench.post_as(&idle, "/lease", keep), Refusal::Login);
}

#[test]
fn hold_and_stop_come_through_where_all_connections_are_taken_and_nothing_else_does() {
    let bench = Bench::new();
    let cookie = bench.login();
    let orders = || bench.machine.0.lock().unwrap().len();
    // Holds that are not answered yet take all seats, for as long as this test wants.
    let gate = bench.machine.1.lock().unwrap();
    let line = "POST /order HTTP/1.1";
    let headers = [
        &*bench.origin(),
        "X-Leadscrew: 1",
        "Content-Type: application/json",
        &cookie,
    ];
    let waiting: Vec<_> = (0..CONNECTIONS)
        .map(|number| {
            let body = format!("{{\"c\":\"{number}\",\"n\":1,\"op\":\"hold\",\"args\":\"wait\"}}");
            let mut stream = bench.connect();
            let request = bench.request(line, &headers, &body);
            stream.write_all(request.as_bytes()).unwrap();
            stream
        })
        .collect();
    while orders() < CONNECTIONS {
        std::thread::yield_now();
    }
    // And far more are opened that say nothing.
    let open: Vec<_> = (0..CONNECTIONS).map(|_| bench.connect()).collect();
    let mut number = 0;
    for op in ["hold", "stop", "hold"] {
        let end = Instant::now() + LIMIT;
        let answer = loop {
            number += 1;
            let body = format!("{{\"c\":\"a\",\"n\":{number},\"op\":\"{op}\"}}");
            let answer = bench.post_as(&cookie, "/order", &body);
            // On a busy computer the seats for holds may all be taken for a moment: it is sent again.
            if !answer.starts_with("HTTP/1.1 503 ") || Instant::now() > end {
                break answer;
            }
        };
        assert!(answer.starts_with("HTTP/1.1 200 OK\r\n"), "{answer}");
    }
    let start = format!("{{\"c\":\"a\",\"n\":{},\"op\":\"start\"}}", number + 1);
    refused(&bench.post_as(&cookie, "/order", &start), Refusal::Busy);
    refused(&bench.get("/", &[]), Refusal::Busy);
    let hold = "{\"c\":\"a\",\"n\":8,\"op\":\"hold\"}";
    refused(&bench.post("/order", hold), Refusal::Busy);
    assert_eq!(
        bench.machine.0.lock().unwrap()[CONNECTIONS..],
        ["hold", "stop", "hold"]
    );
    drop((gate, waiting, open));
}

#[test]
fn all_are_told_who_operates() {
    let bench = Bench::new();
    let cookie = bench.login();
    bench.server.attend();
    let mut stream = bench.watch(&cookie);
    let told =
        |number: &str| format!("event: lease\ndata: {{\"notice_s\":null,\"number\":{number}}}\n\n");
    assert_eq!(until(&mut stream, "\n\n"), told("null"));
    bench.post_as(&cookie, "/lease", "{\"c\":\"a\",\"do\":\"take\"}");
    assert_eq!(until(&mut stream, "\n\n"), told("1"));
    bench.post_as(&cookie, "/lease", "{\"c\":\"a\",\"do\":\"give\"}");
    assert_eq!(until(&mut stream, "\n\n"), told("null"));
}

#[test]
fn nobody_sees_the_machine_without_the_token_on_loopback_too() {
    let bench = Bench::new();
    bench.feed.tell("s", "{\"x\":1}".into());
    let name = format!("leadscrew-{}", bench.server.address.port());
    refused(&bench.get("/state", &[]), Refusal::Login);
    let forged = format!("Cookie: {name}={}", TOKEN.text());
    refused(&bench.get("/state", &[&forged]), Refusal::Login);
    for wrong in ["{\"token\":\"\"}", "{\"token\":\"a5\"}"] {
        refused(&bench.post("/login", wrong), Refusal::Token);
    }
    for wrong in ["", "{", "{}", "[]", "{\"token\":1}"] {
        refused(&bench.post("/login", wrong), Refusal::Malformed);
    }
    let cookie = bench.login();
    assert_ne!(cookie, bench.login());
    let mut stream = bench.watch(&format!("{cookie}; other=1"));
    assert_eq!(until(&mut stream, "\n\n"), "event: s\ndata: {\"x\":1}\n\n");
    // Through a proxy with TLS the cookie goes by TLS alone.
    let body = format!("{{\"token\":\"{}\"}}", TOKEN.text());
    let answer = bench.ask(
        format!(
            "POST /login HTTP/1.1\r\nHost: panel.example\r\nOrigin: https://panel.example\r\nX-Leadscrew: 1\r\n\
             Content-Type: application/json\r\nContent-Length: {}\r\n\r\n{body}",
            body.len()
        )
        .as_bytes(),
    );
    assert!(
        answer.contains("; HttpOnly; SameSite=Strict; Secure\r\n"),
        "{answer}"
    );
}

#[test]
fn what_is_no_request_or_too_long_is_refused() {
    let bench = Bench::new();
    let long = "x".repeat(9 << 10);
    let many = "A: b\r\n".repeat(65);
    for (text, refusal) in [
        ("\0\r\n\r\n".to_owned(), Refusal::Malformed),
        ("GET / HTTP/9\r\n\r\n".to_owned(), Refusal::Malformed),
        (format!("GET /{long} HTTP/1.1\r\n\r\n"), Refusal::TooLong),
        (format!("GET / HTTP/1.1\r\nA: {long}"), Refusal::TooLong),
        (format!("GET / HTTP/1.1\r\n{many}\r\n"), Refusal::TooLong),
        (
            "POST /login HTTP/1.1\r\nContent-Length: 4097\r\n\r\n".to_owned(),
            Refusal::TooLong,
        ),
        (
            "POST /login HTTP/1.1\r\nContent-Length: 99999999999999999999\r\n\r\n".to_owned(),
            Refusal::TooLong,
        ),
        (
            "POST /login HTTP/1.1\r\nContent-Length: -1\r\n\r\n".to_owned(),
            Refusal::Malformed,
        ),
        (
            "POST /login HTTP/1.1\r\nContent-Length: 1\r\nContent-Length: 2\r\n\r\n".to_owned(),
            Refusal::Malformed,
        ),
        (
            "POST /login HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\n".to_owned(),
            Refusal::Malformed,
        ),
    ] {
        refused(&bench.ask(text.as_bytes()), refusal);
    }
    // Gone in the middle.
    let mut stream = bench.connect();
    stream.write_all(b"GET / HT").unwrap();
    stream.shutdown(Shutdown::Write).unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    refused(&answer, Refusal::Malformed);
}

#[test]
fn a_letter_at_a_time_and_silence_end_both() {
    let bench = Bench::new();
    let mut silent = bench.connect();
    let mut slow = bench.connect();
    let mut letters = slow.try_clone().unwrap();
    let writer = std::thread::spawn(move || {
        // Ends with an error once the server has had enough.
        while letters.write_all(b"G").is_ok() {
            std::thread::sleep(Duration::from_millis(20));
        }
    });
    for stream in [&mut silent, &mut slow] {
        let mut answer = String::new();
        let _ = stream.read_to_string(&mut answer);
        refused(&answer, Refusal::Slow);
    }
    drop((silent, slow));
    writer.join().unwrap();
}

#[test]
fn there_are_so_many_connections_and_the_next_is_told() {
    let bench = Bench::new();
    let cookie = bench.login();
    bench.feed.tell("s", "1".into());
    // All seats for those who watch.
    let watching: Vec<_> = (0..STREAMS)
        .map(|_| {
            let mut stream = bench.watch(&cookie);
            until(&mut stream, "\n\n");
            stream
        })
        .collect();
    refused(&bench.get("/state", &[&cookie]), Refusal::Busy);
    // The page is given out all the same, until nothing is left.
    assert!(bench.get("/", &[]).starts_with("HTTP/1.1 200 OK\r\n"));
    let mut half_open = Vec::new();
    loop {
        half_open.extend((STREAMS..CONNECTIONS).map(|_| bench.connect()));
        let answer = bench.ask(b"");
        // Who says nothing is let go in time: on a busy computer the first of them before the last has come.
        if !answer.ends_with(&Refusal::Slow.json()) {
            refused(&answer, Refusal::Busy);
            break;
        }
    }
    // A seat is free again once somebody has gone.
    drop((watching, half_open));
    let free = || bench.get("/", &[]).starts_with("HTTP/1.1 200 OK\r\n");
    while !free() {
        std::thread::yield_now();
    }
}

#[test]
fn who_does_not_read_keeps_nobody_waiting_and_gets_the_newest() {
    let bench = Bench::new();
    let cookie = bench.login();
    bench.feed.tell("s", "first".into());
    let mut slow = bench.watch(&cookie);
    until(&mut slow, "first\n\n");
    // Far more than any buffer holds, and it returns.
    for number in 0..10_000 {
        bench.feed.tell("s", format!("{number:01000}"));
    }
    bench.feed.tell("s", "last".into());
    let behind = until(&mut slow, "event: s\ndata: last\n\n");
    assert!(behind.matches("event: s").count() < 1_000);
}

#[test]
fn a_stream_without_news_says_that_it_is_there() {
    let bench = Bench::new();
    let cookie = bench.login();
    bench.feed.tell("s", "1".into());
    let mut stream = bench.watch(&cookie);
    assert_eq!(until(&mut stream, "\n\n"), "event: s\ndata: 1\n\n");
    // It is an event: of a comment a page is told nothing.
    for _ in 0..2 {
        assert_eq!(until(&mut stream, "\n\n"), "event: alive\ndata: {}\n\n");
    }
}

#[test]
fn thousands_of_requests_leave_it_as_it_was() {
    let bench = Bench::new();
    let cookie = bench.login();
    for number in 0..leadscrew_seed::amount(500, 10_000) {
        let mut stream = bench.connect();
        let request = match number % 4 {
            0 => bench.request("GET / HTTP/1.1", &[], ""),
            1 => "GET / HTTP/1.1\r\nHost: evil\r\n\r\n".to_owned(),
            2 => "\0\0\0\0".to_owned(),
            _ => String::new(),
        };
        let _ = stream.write_all(request.as_bytes());
    }
    bench.feed.tell("s", "still here".into());
    while !bench.get("/", &[]).starts_with("HTTP/1.1 200 OK\r\n") {
        std::thread::yield_now();
    }
    let mut stream = bench.watch(&cookie);
    assert_eq!(until(&mut stream, "\n\n"), "event: s\ndata: still here\n\n");
}

#[test]
fn the_whole_page_is_small() {
    let bench = Bench::new();
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("page");
    let mut bytes = 0;
    for entry in std::fs::read_dir(page).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        let path = format!("/{}", name.trim_start_matches("index.html"));
        let answer = bench.get(&path, &[]);
        assert!(answer.starts_with("HTTP/1.1 200"), "{path}");
        bytes += answer.len();
    }
    // About a third of it where it is packed.
    assert!(bytes < 128 << 10, "{bytes}");
}

#[test]
fn each_refusal_says_what_helps_in_two_languages() {
    for refusal in Refusal::ALL {
        let [en, zh] = refusal.words();
        assert!(en.contains("; ") && zh.contains('；'), "{refusal:?}");
        assert!(!en.contains("  ") && !zh.contains("  "), "{refusal:?}");
    }
}
