//! Whether a request may be answered at all: by its host, its origin, and what only this page sends.
//!
//! A name that has been pointed at this computer (rebinding) is a foreign host; a form of another page is a foreign origin.
//! Values in, answers out. This file must not know sockets, sessions or a machine.

use std::net::SocketAddr;

use crate::http::Request;
use crate::refusal::Refusal;

/// Where the page is.
#[derive(Clone, Debug)]
pub struct Place {
    /// `host:port`, as browsers name it.
    hosts: Vec<String>,
    origins: Vec<String>,
    /// Cookies are not told apart by port; their names are.
    cookie: String,
}

impl Place {
    /// A page at this address and, through proxies with TLS, at these names.
    #[must_use]
    pub fn new(address: SocketAddr, names: &[String]) -> Self {
        let port = address.port();
        let mut hosts = vec![address.to_string()];
        if address.ip().is_loopback() {
            hosts.push(format!("localhost:{port}"));
        }
        let mut origins: Vec<String> = hosts.iter().map(|host| format!("http://{host}")).collect();
        for name in names {
            let name = name.to_ascii_lowercase();
            origins.push(format!("https://{name}"));
            hosts.push(name);
        }
        Self {
            hosts,
            origins,
            cookie: format!("leadscrew-{port}"),
        }
    }

    /// The name of the cookie.
    pub(crate) fn cookie(&self) -> &str {
        &self.cookie
    }

    /// Lets a request in, whoever sends it.
    pub(crate) fn check(&self, request: &Request) -> Result<(), Refusal> {
        let host = request.header("host").map(str::to_ascii_lowercase);
        if !host.is_some_and(|host| self.hosts.contains(&host)) {
            return Err(Refusal::Host);
        }
        let orders = matches!(request.method.as_str(), "POST" | "PUT");
        let is_own = |origin: &str| self.origins.iter().any(|own| own == origin);
        match request.header("origin") {
            Some(origin) if !is_own(&origin.to_ascii_lowercase()) => return Err(Refusal::Origin),
            None if orders => return Err(Refusal::Origin),
            _ => {}
        }
        // No page from elsewhere may send either of these types without asking first.
        let typed = match request.header("content-type") {
            Some("application/json") => true,
            Some("application/octet-stream") => request.method == "PUT",
            _ => false,
        };
        let named = request.header("x-leadscrew") == Some("1");
        if orders && !(named && typed) {
            return Err(Refusal::NotThePage);
        }
        Ok(())
    }
}
