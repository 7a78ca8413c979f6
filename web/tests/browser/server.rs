//! A server for one browser: the files of the page, the jobs, and the report that comes back.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::Duration;

const CHECK: &str = "<!doctype html><meta charset=utf-8><link rel=icon href=data:,><body><script type=module src=check.js></script>";

pub struct Server {
    pub address: String,
    report: Receiver<String>,
}

impl Server {
    /// Serves until the test ends.
    pub fn start(page: PathBuf, jobs: String) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let address = format!("http://{}", listener.local_addr().expect("an address"));
        let (sender, report) = channel();
        std::thread::spawn(move || {
            for stream in listener.incoming().flatten() {
                let (page, jobs, sender) = (page.clone(), jobs.clone(), sender.clone());
                // A browser opens connections that it does not use.
                std::thread::spawn(move || serve(stream, &page, &jobs, &sender));
            }
        });
        Self { address, report }
    }

    /// What the page reports, or nothing within that time.
    pub fn report(&self, within: Duration) -> Option<String> {
        self.report.recv_timeout(within).ok()
    }
}

/// A browser that goes away ends its connection, which is no fault.
fn serve(stream: TcpStream, page: &Path, jobs: &str, report: &Sender<String>) -> Option<()> {
    let mut reader = BufReader::new(stream);
    let mut request = String::new();
    reader.read_line(&mut request).ok()?;
    let mut length = 0;
    loop {
        let mut line = String::new();
        reader.read_line(&mut line).ok()?;
        if let Some((name, value)) = line.split_once(':')
            && name.eq_ignore_ascii_case("content-length")
        {
            length = value.trim().parse().ok()?;
        }
        if line.trim().is_empty() {
            break;
        }
    }
    let mut sent = vec![0; length];
    reader.read_exact(&mut sent).ok()?;
    let path = request.split_whitespace().nth(1)?.trim_start_matches('/');
    let (kind, body) = match path {
        "report" => {
            report.send(String::from_utf8(sent).ok()?).ok()?;
            ("text/plain", Vec::new())
        }
        "check.html" => ("text/html", CHECK.into()),
        "check.js" => ("text/javascript", include_bytes!("check.js").to_vec()),
        "jobs.json" => ("application/json", jobs.into()),
        name => (kind(name), std::fs::read(page.join(name)).ok()?),
    };
    let head = format!(
        "HTTP/1.1 200 OK\r\nContent-Type: {kind}\r\nContent-Length: {}\r\nConnection: close\r\n\r\n",
        body.len()
    );
    let mut stream = reader.into_inner();
    stream.write_all(head.as_bytes()).ok()?;
    stream.write_all(&body).ok()
}

fn kind(name: &str) -> &'static str {
    match Path::new(name).extension().and_then(|end| end.to_str()) {
        Some("html") => "text/html",
        Some("js") => "text/javascript",
        Some("css") => "text/css",
        Some("wasm") => "application/wasm",
        _ => "application/octet-stream",
    }
}
