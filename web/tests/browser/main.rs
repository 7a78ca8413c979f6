//! The page in headless Chromium: its machine has the host's setpoints, and it works as somebody would use it.
//!
//! `cargo xtask page --check` writes the page and starts this test. Without Chromium it fails.

use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use leadscrew_web::FOLDERS;
use serde_json::{Value, json};

#[path = "../../../firmware/mps2-an386/src/programs.rs"]
mod programs;

#[path = "../jobs/mod.rs"]
mod jobs;
mod server;

/// All jobs in full volume, several times over.
const PATIENCE: Duration = Duration::from_secs(900);

struct Browser(Child);

impl Drop for Browser {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn browser(dir: &Path, address: &str) -> Browser {
    let log = std::fs::File::create(dir.join("chromium.log")).expect("a log");
    let child = Command::new("chromium")
        .args([
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--disable-dev-shm-usage",
        ])
        .args(["--no-first-run", "--disable-background-networking"])
        .args(["--enable-logging=stderr", "--lang=en"])
        // Without it headless Chromium ends when the page is loaded.
        .arg("--remote-debugging-port=0")
        .arg(format!("--user-data-dir={}", dir.join("profile").display()))
        .arg(address)
        .stdout(Stdio::null())
        .stderr(log)
        .spawn()
        .expect(
            "chromium starts: the Debian package is `chromium`, installed by `cargo xtask setup`",
        );
    Browser(child)
}

/// All examples, and random programs: fixed ones, and those from this seed on.
fn wanted(seed: u64) -> Vec<(String, Value)> {
    let mut wanted = Vec::new();
    for folder in FOLDERS {
        for (name, text) in folder.programs {
            wanted.push((
                format!("{}/{name}", folder.name),
                json!({"folder": folder.name, "text": text}),
            ));
        }
    }
    let count = leadscrew_seed::amount(25, 500);
    let fresh = (0..count).map(|more| seed.wrapping_add(more));
    for seed in (0..count).chain(fresh) {
        let text = programs::random(seed).as_str().to_owned();
        wanted.push((
            format!("random {seed}"),
            json!({"folder": "", "text": text}),
        ));
    }
    wanted
}

fn on_host(job: &Value) -> Value {
    let text = |key: &str| job[key].as_str().expect("a text");
    jobs::on_host(text("folder"), text("text"))
}

#[test]
fn the_page_has_the_setpoints_of_the_host_and_works() {
    leadscrew_seed::only_fresh(check);
}

fn check(seed: u64) {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../out/page");
    assert!(
        page.join("leadscrew.wasm").is_file(),
        "the page is not written: cargo xtask page"
    );
    let dir = Path::new(env!("CARGO_TARGET_TMPDIR")).join("browser");
    std::fs::create_dir_all(&dir).expect("a folder");
    let wanted = wanted(seed);
    let list: Vec<&Value> = wanted.iter().map(|(_, job)| job).collect();
    let server = server::Server::start(page, json!(list).to_string());
    let browser = browser(&dir, &format!("{}/check.html", server.address));
    let report = server.report(PATIENCE);
    drop(browser);
    let log = std::fs::read_to_string(dir.join("chromium.log")).unwrap_or_default();
    let report = report.unwrap_or_else(|| panic!("the page did not report; Chromium said:\n{log}"));
    let report: Value = serde_json::from_str(&report).expect("JSON");
    assert_eq!(report["failure"], Value::Null);
    let said: Vec<&str> = log
        .lines()
        .filter(|line| line.contains("CONSOLE"))
        .collect();
    assert!(said.is_empty(), "the page wrote to the console: {said:?}");

    let results = report["results"].as_array().expect("a list");
    assert_eq!(results.len(), wanted.len());
    for ((name, job), result) in wanted.iter().zip(results) {
        assert_eq!(result, &on_host(job), "{name}");
    }
    let shaft = wanted.iter().find(|(name, _)| name == "/shaft.nc");
    let host = on_host(&shaft.expect("an example").1);
    let used = &report["page"];
    assert_eq!(used["hash"], host["hash"], "{used}");
    assert_eq!(used["alarm"], "", "{used}");
    assert_eq!(used["run"], "运行", "{used}");
    let text = |of: &Value| of.as_str().expect("a text").to_owned();
    let measured = text(&used["measured"]);
    assert!(
        measured.contains("M40x3-6g") && measured.contains("38.0521"),
        "{measured}"
    );
    let faulty = &used["faulty"];
    assert!(text(&faulty["alarm"]).contains("4303"), "{faulty}");
    assert_eq!(faulty["hidden"], true, "{faulty}");
    let found = used["found"].as_str().expect("a text");
    assert!(found.contains(" 2:") && found.contains("Remedy"), "{found}");
    println!(
        "{} programs, {:.0} times real time; ready after {:.0} ms, result after {:.0} ms",
        results.len(),
        report["factor"].as_f64().unwrap_or(0.0),
        used["ready_ms"].as_f64().unwrap_or(0.0),
        used["result_ms"].as_f64().unwrap_or(0.0),
    );
}
