//! Gives the text of the figures to who asks for it by HTTP, one after the other: each has little time.

use std::io::{self, Read as _, Write as _};
use std::net::{Shutdown, SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::thread;
use std::time::Duration;

use httparse::{EMPTY_HEADER, Request, Status};

/// For the request, and for each piece of the answer.
const PATIENCE: Duration = Duration::from_secs(2);
/// Bytes of a request, and its headers; a scraper sends about 300 bytes.
const LONGEST: usize = 4096;
const HEADERS: usize = 32;
/// Behind a failure to accept; out of descriptors, it would come back at once.
const PAUSE: Duration = Duration::from_millis(50);
const KIND: &str = "application/openmetrics-text; version=1.0.0; charset=utf-8";

/// A server; it ends with the process.
#[derive(Debug)]
pub struct Server {
    /// Where it listens.
    pub address: SocketAddr,
}

impl Server {
    /// Listens, and gives what `text` makes.
    ///
    /// # Errors
    /// The address is not to be had.
    pub fn start(
        listen: SocketAddr,
        text: Arc<dyn Fn() -> String + Send + Sync>,
    ) -> io::Result<Self> {
        let listener = TcpListener::bind(listen)?;
        let address = listener.local_addr()?;
        thread::Builder::new().spawn(move || {
            for stream in listener.incoming() {
                match stream {
                    // Who does not take the answer asks again.
                    Ok(stream) => drop(answer(&stream, &*text)),
                    Err(_) => thread::sleep(PAUSE),
                }
            }
        })?;
        Ok(Self { address })
    }
}

fn answer(mut stream: &TcpStream, text: &dyn Fn() -> String) -> io::Result<()> {
    stream.set_read_timeout(Some(PATIENCE))?;
    stream.set_write_timeout(Some(PATIENCE))?;
    let (status, body) = match request(stream)? {
        Some(path) if path == "/metrics" => ("200 OK", text()),
        Some(_) => ("404 Not Found", "the figures are at /metrics\n".to_owned()),
        None => ("400 Bad Request", "GET /metrics\n".to_owned()),
    };
    let kind = if status.starts_with("200") {
        KIND
    } else {
        "text/plain"
    };
    let length = body.len();
    let answer = format!(
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {length}\r\nConnection: close\r\n\r\n{body}"
    );
    stream.write_all(answer.as_bytes())?;
    stream.shutdown(Shutdown::Write)
}

/// The path of a `GET`; nothing for what is none.
fn request(mut stream: &TcpStream) -> io::Result<Option<String>> {
    let mut bytes = Vec::new();
    let mut room = [0; 1024];
    while bytes.len() < LONGEST {
        let count = stream.read(&mut room)?;
        bytes.extend_from_slice(&room[..count]);
        let mut headers = [EMPTY_HEADER; HEADERS];
        let mut request = Request::new(&mut headers);
        match request.parse(&bytes) {
            Ok(Status::Complete(_)) if request.method == Some("GET") => {
                return Ok(request.path.map(str::to_owned));
            }
            Ok(Status::Partial) if count > 0 => {}
            _ => return Ok(None),
        }
    }
    Ok(None)
}
