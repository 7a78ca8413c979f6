//! Programs over sockets: who reads and who writes them, by which names, and in place of what.

use std::path::PathBuf;
use std::sync::Arc;

use leadscrew_panel::{LONGEST, Programs, Refusal};

use super::{Bench, LOOK, refused};

/// A server with a folder of programs.
struct Store {
    bench: Bench,
    folder: PathBuf,
}

impl Store {
    fn new(name: &str) -> Self {
        let folder = std::env::temp_dir().join(format!("ls-store-{}-{name}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let programs = Programs::open(&folder).unwrap();
        Self {
            bench: Bench::with(Some(Arc::new(programs))),
            folder,
        }
    }

    /// What a page sends to write a program, with these headers in addition.
    fn put(&self, cookie: &str, name: &str, more: &[&str], body: &str) -> String {
        let own = [
            &*self.bench.origin(),
            "X-Leadscrew: 1",
            "Content-Type: application/octet-stream",
            cookie,
        ];
        let line = format!("PUT /programs/{name} HTTP/1.1");
        let headers = [&own[..], more].concat();
        self.bench
            .ask(self.bench.request(&line, &headers, body).as_bytes())
    }
}

impl Drop for Store {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}

const NEW: &str = "If-None-Match: *";

fn tag(answer: &str) -> &str {
    let tag = answer.lines().find_map(|line| line.strip_prefix("ETag: "));
    tag.unwrap_or_else(|| panic!("{answer}"))
}

#[test]
fn a_program_is_read_by_who_looks_and_written_by_who_operates() {
    let store = Store::new("rights");
    let bench = &store.bench;
    let (operates, looks) = (bench.login(), bench.login_with(LOOK));
    for path in ["/programs", "/programs/a.nc", "/programs/a.nc/check"] {
        refused(&bench.get(path, &[]), Refusal::Login);
    }
    refused(&store.put("X: y", "a.nc", &[NEW], "M30\n"), Refusal::Login);
    refused(&store.put(&looks, "a.nc", &[NEW], "M30\n"), Refusal::Looks);
    let written = store.put(&operates, "a.nc", &[NEW], "M30\n");
    assert!(written.starts_with("HTTP/1.1 200 OK\r\n"), "{written}");
    let text = bench.get("/programs/a.nc", &[&looks]);
    assert!(text.ends_with("\r\n\r\nM30\n"), "{text}");
    assert!(
        text.contains("Content-Type: application/octet-stream\r\n"),
        "{text}"
    );
    assert_eq!(tag(&text), tag(&written));
    let list = bench.get("/programs", &[&looks]);
    assert!(
        list.ends_with("{\"further\":0,\"programs\":[{\"name\":\"a.nc\",\"size\":4}]}"),
        "{list}"
    );
    let seen = bench.get("/programs/a.nc/check", &[&looks, "Accept-Language: zh"]);
    assert!(
        seen.ends_with("{\"seen\":\"a.nc\",\"view\":\"Check\",\"zh\":true}"),
        "{seen}"
    );
    let seen = bench.get("/programs/a.nc/path", &[&looks]);
    assert!(
        seen.ends_with("{\"seen\":\"a.nc\",\"view\":\"Path\",\"zh\":false}"),
        "{seen}"
    );
    let seen = bench.get("/programs/a.nc/start/12", &[&looks]);
    assert!(
        seen.ends_with("{\"seen\":\"a.nc\",\"view\":\"Start(12)\",\"zh\":false}"),
        "{seen}"
    );
    refused(
        &bench.get("/programs/a.nc/start/x", &[&looks]),
        Refusal::NotFound,
    );
    refused(
        &bench.get("/programs/a.nc/other", &[&looks]),
        Refusal::NotFound,
    );
    refused(
        &bench.get("/programs/b.nc/path", &[&looks]),
        Refusal::NoProgram,
    );
    refused(
        &bench.post_as(&operates, "/programs/a.nc", "{}"),
        Refusal::Method,
    );
    refused(
        &bench.post_as(&operates, "/programs", "{}"),
        Refusal::Method,
    );
}

#[test]
fn a_program_replaces_what_its_writer_has_seen_and_nothing_else() {
    let store = Store::new("tags");
    let cookie = store.bench.login();
    let written = store.put(&cookie, "a.nc", &[NEW], "1");
    let seen = format!("If-Match: {}", tag(&written));
    refused(&store.put(&cookie, "a.nc", &[NEW], "2"), Refusal::Changed);
    let written = store.put(&cookie, "a.nc", &[&seen], "2");
    assert!(written.starts_with("HTTP/1.1 200 OK\r\n"), "{written}");
    refused(&store.put(&cookie, "a.nc", &[&seen], "3"), Refusal::Changed);
    for more in [
        &[][..],
        &["If-Match: *"],
        &["If-Match: bare"],
        &["If-Match: \"a\", \"b\""],
        &["If-None-Match: \"a\""],
        &[NEW, &seen],
        &[&seen, &seen],
    ] {
        refused(
            &store.put(&cookie, "a.nc", more, "4"),
            Refusal::Unconditional,
        );
    }
    assert_eq!(std::fs::read(store.folder.join("a.nc")).unwrap(), b"2");
}

#[test]
fn what_no_page_sends_writes_nothing_and_no_name_leads_elsewhere() {
    let store = Store::new("hostile");
    let bench = &store.bench;
    let cookie = bench.login();
    for name in ["..", "../a", "%2e%2e", ".a", "a%00", "", &"x".repeat(65)] {
        let refusal = if name == "../a" {
            Refusal::Method
        } else {
            Refusal::Name
        };
        refused(&store.put(&cookie, name, &[NEW], "M30\n"), refusal);
    }
    for path in [
        "/programs/../Cargo.toml",
        "/programs/..",
        "/programs//etc/passwd",
        "/programs/",
    ] {
        let answer = bench.get(path, &[&cookie]);
        assert!(answer.starts_with("HTTP/1.1 40"), "{path}: {answer}");
    }
    let (own, mark, kind) = (
        bench.origin(),
        "X-Leadscrew: 1",
        "Content-Type: application/octet-stream",
    );
    let ask = |headers: &[&str]| {
        let line = "PUT /programs/a.nc HTTP/1.1";
        bench.ask(bench.request(line, headers, "M30\n").as_bytes())
    };
    let foreign = "Origin: http://evil.example";
    refused(&ask(&[foreign, mark, kind, &cookie, NEW]), Refusal::Origin);
    refused(&ask(&[mark, kind, &cookie, NEW]), Refusal::Origin);
    refused(&ask(&[&own, kind, &cookie, NEW]), Refusal::NotThePage);
    refused(&ask(&[&own, mark, &cookie, NEW]), Refusal::NotThePage);
    let plain = "Content-Type: text/plain";
    refused(
        &ask(&[&own, mark, plain, &cookie, NEW]),
        Refusal::NotThePage,
    );
    assert_eq!(std::fs::read_dir(&store.folder).unwrap().count(), 0);
}

#[test]
fn a_long_text_is_read_of_who_may_write_it_alone() {
    let store = Store::new("long");
    let (operates, looks) = (store.bench.login(), store.bench.login_with(LOOK));
    let text = "G1 X1 Z1\n".repeat(LONGEST / 9);
    let written = store.put(&operates, "a.nc", &[NEW], &text);
    assert!(written.starts_with("HTTP/1.1 200 OK\r\n"), "{written}");
    let read = store.bench.get("/programs/a.nc", &[&looks]);
    assert!(read.ends_with(&text));
    // Nothing of it is waited for.
    let head = |cookie: &str, length: usize| {
        format!(
            "PUT /programs/b.nc HTTP/1.1\r\nHost: {}\r\nOrigin: http://{0}\r\nX-Leadscrew: 1\r\n\
             Content-Type: application/octet-stream\r\n{NEW}\r\n{cookie}\r\nContent-Length: {length}\r\n\r\n",
            store.bench.server.address
        )
    };
    for head in [
        head(&looks, 5_000),
        head("X: y", 5_000),
        head(&operates, LONGEST + 1),
    ] {
        refused(&store.bench.ask(head.as_bytes()), Refusal::TooLong);
    }
    assert!(!store.folder.join("b.nc").exists());
}

#[test]
fn a_panel_without_a_folder_says_so() {
    let bench = Bench::new();
    let cookie = bench.login();
    refused(&bench.get("/programs", &[&cookie]), Refusal::NoStore);
    refused(&bench.get("/programs", &[]), Refusal::Login);
}
