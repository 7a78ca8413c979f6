//! Requests about programs: which are there, what one says, what is wrong with it, where its tools go; and a new text.
//!
//! ```text
//! GET /programs                      the list
//! GET /programs/NAME                 the text, with its ETag
//! GET /programs/NAME/check, …/path, …/start/LINE   what the machine's side says of it
//! PUT /programs/NAME                 If-Match: the ETag that was seen, or If-None-Match: * for a new one
//! ```
//!
//! This file must not know sockets, cookies, or a folder.

use std::sync::Arc;

use serde_json::json;

use crate::http::Request;
use crate::machine::{Machine, View};
use crate::programs::{Programs, When};
use crate::refusal::Refusal;
use crate::session::Right;

const JSON: &str = "application/json";
/// A browser that opens it by its address shows nothing of it, and carries nothing out.
const TEXT: &str = "application/octet-stream";

/// An answer.
#[derive(Debug)]
pub struct Sent {
    pub status: &'static str,
    pub kind: &'static str,
    /// Headers.
    pub more: String,
    pub body: Vec<u8>,
}

impl Sent {
    fn json(json: String) -> Self {
        Self {
            status: "200 OK",
            kind: JSON,
            more: String::new(),
            body: json.into_bytes(),
        }
    }

    fn tagged(self, tag: &str) -> Self {
        Self {
            more: format!("ETag: \"{tag}\"\r\n"),
            ..self
        }
    }
}

/// Whether a path is about programs.
pub fn is_one(path: &str) -> bool {
    path == "/programs" || path.starts_with("/programs/")
}

/// Answers who has this right.
pub fn answer(
    request: &Request,
    right: Right,
    programs: &Arc<Programs>,
    machine: &dyn Machine,
) -> Result<Sent, Refusal> {
    let path = request.path.trim_start_matches("/programs");
    let mut parts = path.strip_prefix('/').unwrap_or(path).splitn(2, '/');
    let (name, view) = (parts.next().unwrap_or_default(), parts.next());
    match (request.method.as_str(), name, view) {
        ("GET", "", None) if path.is_empty() => list(programs),
        ("GET", name, None) => {
            let text = programs.read(name)?;
            let sent = Sent {
                status: "200 OK",
                kind: TEXT,
                more: String::new(),
                body: text.bytes,
            };
            Ok(sent.tagged(&text.tag))
        }
        ("GET", name, Some(view)) => {
            let view = match view {
                "check" => View::Check,
                "path" => View::Path,
                other => {
                    let line = other.strip_prefix("start/");
                    let line = line.and_then(|line| line.parse().ok());
                    View::Start(line.ok_or(Refusal::NotFound)?)
                }
            };
            let zh = request.header("accept-language") == Some("zh");
            let place = programs.path(name)?;
            Ok(Sent::json(machine.view(&place, view, zh)))
        }
        ("PUT", name, None) => {
            if right != Right::Operate {
                return Err(Refusal::Looks);
            }
            let tag = programs.write(name, when(request)?, &request.body)?;
            Ok(Sent::json("{\"ok\":true}".into()).tagged(&tag))
        }
        _ => Err(Refusal::Method),
    }
}

fn list(programs: &Programs) -> Result<Sent, Refusal> {
    let (list, further) = programs.list()?;
    let each = |one: &crate::programs::Listed| json!({"name": one.name, "size": one.size});
    let list: Vec<_> = list.iter().map(each).collect();
    Ok(Sent::json(
        json!({"programs": list, "further": further}).to_string(),
    ))
}

/// What a text is to replace.
fn when(request: &Request) -> Result<When<'_>, Refusal> {
    match (request.header("if-match"), request.header("if-none-match")) {
        (None, Some("*")) => Ok(When::New),
        (Some(tag), None) => {
            let bare = tag.strip_prefix('"').and_then(|tag| tag.strip_suffix('"'));
            // `*` and lists would replace what nobody has seen.
            bare.filter(|tag| !tag.contains('"'))
                .map(When::Is)
                .ok_or(Refusal::Unconditional)
        }
        _ => Err(Refusal::Unconditional),
    }
}
