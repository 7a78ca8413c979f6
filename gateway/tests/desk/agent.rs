//! `agent` beside a machine that runs: what a broker gets, also one that comes late, and what is refused.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::{TcpListener, TcpStream};
use std::os::unix::fs::PermissionsExt as _;
use std::path::Path;
use std::process::{Child, Stdio};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use bytes::BytesMut;
use leadscrew_agent::sparkplug::payload::{Payload, Value};
use leadscrew_can::MachineName;
use mqttbytes::v4::{
    ConnAck, ConnectReturnCode, Packet, PubAck, SubAck, SubscribeReasonCode, read,
};
use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;
use prost::Message as _;

use crate::{LIMIT, User, bad, good};

/// A tapped hole, with an end.
const TAP: &str = "G98\nG0 X50 Z0\nM29 S1000\nG84 Z-5 F1000\nG80\nM30\n";

pub fn start(user: &User, args: &[&str]) -> Child {
    let mut command = user.command(&[&["agent"], args].concat());
    let piped = command.stdout(Stdio::piped()).stderr(Stdio::piped());
    piped.spawn().unwrap()
}

/// Ends it as a service manager does; what it has said on standard error.
pub fn end(mut child: Child) -> String {
    let pid = Pid::from_raw(i32::try_from(child.id()).unwrap());
    kill(pid, Signal::SIGTERM).unwrap();
    let mut said = String::new();
    child
        .stderr
        .take()
        .unwrap()
        .read_to_string(&mut said)
        .unwrap();
    child.wait().unwrap();
    said
}

/// A broker, and what it was told: metrics of data by their names. The death of a machine is one, too.
struct Told {
    stream: TcpStream,
    bytes: BytesMut,
    names: BTreeMap<u64, String>,
    all: Vec<(String, Value)>,
}

impl Told {
    fn new(stream: TcpStream) -> Self {
        stream.set_read_timeout(Some(LIMIT)).unwrap();
        Self {
            stream,
            bytes: BytesMut::new(),
            names: BTreeMap::new(),
            all: Vec::new(),
        }
    }

    /// Takes messages until what has come is enough.
    fn until(&mut self, enough: impl Fn(&[(String, Value)]) -> bool) {
        let mut room = [0; 4096];
        while !enough(&self.all) {
            let count = self.stream.read(&mut room).unwrap();
            assert!(count > 0, "the agent has gone: {:?}", self.all);
            self.bytes.extend_from_slice(&room[..count]);
            while let Ok(packet) = read(&mut self.bytes, 1 << 20) {
                let mut answer = BytesMut::new();
                match packet {
                    Packet::Connect(_) => {
                        let accept = ConnAck::new(ConnectReturnCode::Success, false);
                        accept.write(&mut answer).unwrap();
                    }
                    Packet::Subscribe(orders) => {
                        let code = SubscribeReasonCode::Success(mqttbytes::QoS::AtLeastOnce);
                        SubAck::new(orders.pkid, vec![code])
                            .write(&mut answer)
                            .unwrap();
                    }
                    Packet::Publish(publish) => {
                        PubAck::new(publish.pkid).write(&mut answer).unwrap();
                        // The set in force is no record.
                        if !publish.retain {
                            self.take(&publish.topic, &publish.payload);
                        }
                    }
                    _ => {}
                }
                self.stream.write_all(&answer).unwrap();
            }
        }
    }

    fn take(&mut self, topic: &str, payload: &[u8]) {
        let payload = Payload::decode(payload).unwrap();
        if topic.contains("/DBIRTH/") {
            for metric in payload.metrics {
                if let (Some(alias), Some(name)) = (metric.alias, metric.name) {
                    self.names.insert(alias, name);
                }
            }
            return;
        }
        if topic.contains("/DDEATH/") {
            let machine = topic.rsplit('/').next().unwrap();
            let machine = Value::String(machine.to_owned());
            self.all.push(("death".to_owned(), machine));
        }
        for metric in payload.metrics {
            let name = metric
                .alias
                .and_then(|alias| self.names.get(&alias).cloned());
            if let (Some(name), Some(value)) = (name, metric.value) {
                self.all.push((name, value));
            }
        }
    }
}

/// A broker beside the test: an agent that is not answered in time ends its connection.
fn broker_until(
    listener: TcpListener,
    enough: impl Fn(&[(String, Value)]) -> bool + Send + 'static,
) -> JoinHandle<Told> {
    thread::spawn(move || {
        let (stream, _) = listener.accept().unwrap();
        let mut told = Told::new(stream);
        told.until(enough);
        told
    })
}

/// Takes messages until one of these metrics has come.
fn take_until(stream: TcpStream, wanted: &str) -> Told {
    let mut told = Told::new(stream);
    told.until(|all| all.iter().any(|(name, _)| name == wanted));
    told
}

/// What stands at the address of the figures.
fn figures(url: &str) -> String {
    let place = url
        .trim_start_matches("http://")
        .trim_end_matches("/metrics");
    let mut stream = TcpStream::connect(place).unwrap();
    stream.write_all(b"GET /metrics HTTP/1.1\r\n\r\n").unwrap();
    let mut figures = String::new();
    stream.read_to_string(&mut figures).unwrap();
    figures
}

/// Waits until an agent has read the end of a run. Whoever ends it before does not hear of that run.
#[track_caller]
fn read_to_its_end(url: &str) {
    let end = Instant::now() + LIMIT;
    loop {
        let figures = figures(url);
        if figures.contains("leadscrew_runs_total{machine=\"lathe\",end=\"finished\"} 1\n") {
            return;
        }
        assert!(Instant::now() < end, "{figures}");
        thread::sleep(Duration::from_millis(50));
    }
}

fn text<'a>(all: &'a [(String, Value)], wanted: &str) -> Vec<&'a str> {
    let text = |(name, value): &'a (String, Value)| match value {
        Value::String(text) if name == wanted => Some(text.as_str()),
        _ => None,
    };
    all.iter().filter_map(text).collect()
}

#[test]
fn a_broker_that_comes_late_gets_the_certificate_and_the_run() {
    let user = User::with_machine();
    // No agent has seen the start before this one: the board has counted it.
    good(&user.does(&["sim", "power", "cycle"]));
    // Nobody listens there yet.
    // At an address at which no other test listens, for the port is free meanwhile.
    let listener = TcpListener::bind("127.0.0.2:0").unwrap();
    let address = listener.local_addr().unwrap();
    drop(listener);
    let broker = format!("mqtt://{address}");
    let args = [
        "--broker",
        &broker,
        "--machine",
        "lathe",
        "--name",
        "node",
        "--metrics",
        "127.0.0.1:0",
        "--json",
    ];
    let mut agent = start(&user, &args);
    let mut first = String::new();
    let mut output = BufReader::new(agent.stdout.take().unwrap());
    output.read_line(&mut first).unwrap();
    let first: serde_json::Value = serde_json::from_str(&first).unwrap();
    assert_eq!(
        first["boards"][0]["topic"],
        "spBv1.0/leadscrew/+/node/lathe"
    );
    // A second one for the same machine is refused.
    let second = user.does(&["agent", "--broker", &broker, "--machine", "lathe"]);
    assert_eq!(second.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&second.stderr).contains("one machine has one agent"));
    let program = user.program(TAP);
    let run: serde_json::Value =
        serde_json::from_str(&good(&user.does(&["run", &program, "--json"]))).unwrap();
    // Its figures are there without a broker.
    let figures = figures(first["metrics"].as_str().unwrap());
    assert!(
        figures.contains("leadscrew_board_up{machine=\"lathe\"} 1\n"),
        "{figures}"
    );
    assert!(
        figures.contains("leadscrew_agent_broker_up 0\n"),
        "{figures}"
    );
    let listener = TcpListener::bind(address).unwrap();
    let (stream, _) = listener.accept().unwrap();
    let told = take_until(stream, "Run/Setpoint Hash");
    let all = &told.all;
    assert_eq!(
        text(all, "Run/Setpoint Hash"),
        [run["setpoint_hash"].as_str().unwrap()]
    );
    let serial = MachineName::default().serial();
    assert_eq!(text(all, "Thread/Key"), [format!("{serial:08x}/2/1")]);
    assert_eq!(text(all, "Thread/Kind"), ["rigid_tap"]);
    let states: BTreeSet<&str> = text(all, "Machine/State").into_iter().collect();
    assert!(states.contains("run"), "{states:?}");
    drop(told);
    let said = end(agent);
    assert!(said.contains("the broker is not reached"), "{said}");
    assert!(said.contains("the broker takes what is kept"), "{said}");
}

/// The files of an archive: kind, and how many.
fn files(folder: &Path) -> BTreeMap<String, usize> {
    let mut files = BTreeMap::new();
    for kind in fs::read_dir(folder).into_iter().flatten() {
        let kind = kind.unwrap();
        let days = fs::read_dir(kind.path()).unwrap();
        let count = days.map(|day| fs::read_dir(day.unwrap().path()).unwrap().count());
        files.insert(kind.file_name().into_string().unwrap(), count.sum());
    }
    files
}

/// What an agent says when it begins.
fn begun(agent: &mut Child) -> String {
    let mut output = BufReader::new(agent.stdout.take().unwrap());
    let mut lines = String::new();
    while !lines.contains("Ctrl-C") {
        assert_ne!(output.read_line(&mut lines).unwrap(), 0);
    }
    lines
}

#[test]
fn an_archive_needs_no_broker_and_what_cannot_be_written_waits() {
    let user = User::with_machine();
    let archive = user.0.join("archive");
    let args = ["--archive", archive.to_str().unwrap(), "--machine", "lathe"];
    let metrics = ["--metrics", "127.0.0.1:0"];
    let mut agent = start(&user, &[&args[..], &metrics].concat());
    let lines = begun(&mut agent);
    let url = lines
        .lines()
        .find_map(|line| line.strip_prefix("figures are at "))
        .unwrap();
    fs::remove_dir(&archive).unwrap();
    fs::write(&archive, "a file in the place of the folder").unwrap();
    let program = user.program(TAP);
    good(&user.does(&["run", &program]));
    read_to_its_end(url);
    let said = end(agent);
    assert!(said.contains("is not written"), "{said}");
    assert!(said.contains("all is kept meanwhile"), "{said}");
    fs::remove_file(&archive).unwrap();
    // What was kept is written by the next one, and once.
    for _ in 0..2 {
        let mut agent = start(&user, &args);
        let lines = begun(&mut agent);
        assert!(lines.contains("each hour\n"), "{lines}");
        end(agent);
        let files = files(&archive);
        let of = |kind: &str| files.get(kind).copied().unwrap_or(0);
        let [threads, runs] = ["record=thread", "record=run"].map(of);
        assert_eq!((threads, runs), (1, 1), "{files:?}");
    }
}

/// A thread of three passes.
const THREAD: &str = "G98\nM3 S600\nG0 X30 Z5\nG92 X29 Z-10 F1.5\nX28.6\nX28.3\nM5\nM30\n";

#[test]
fn a_typed_line_that_is_refused_is_told_as_that_and_as_no_reset() {
    let user = User::new();
    fs::write(user.0.join("door.toml"), "door_input = 1\n").unwrap();
    good(&user.does(&["up", "--machine", "door.toml"]));
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let broker = format!("mqtt://{}", listener.local_addr().unwrap());
    let agent = start(&user, &["--broker", &broker, "--machine", "lathe"]);
    let told = broker_until(listener, |all| {
        text(all, "Event/Kind").contains(&"finished")
    });
    good(&user.does(&["sim", "door", "open"]));
    bad(&user.does(&["mdi", "M3 S500"]), 1);
    good(&user.does(&["sim", "door", "close"]));
    let program = user.program("M30\n");
    good(&user.does(&["run", &program]));
    let told = told.join().unwrap();
    let kinds = text(&told.all, "Event/Kind");
    assert!(kinds.contains(&"refused"), "{kinds:?}");
    assert!(
        !kinds.contains(&"reset") && !kinds.contains(&"warning"),
        "{kinds:?}"
    );
    let number =
        |(name, value): &(String, Value)| name == "Event/Alarm" && *value == Value::Int(4506);
    assert!(told.all.iter().any(number), "{:?}", told.all);
    drop(told);
    end(agent);
}

#[test]
fn the_cut_that_is_told_is_that_of_run() {
    let user = User::with_machine();
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let broker = format!("mqtt://{}", listener.local_addr().unwrap());
    let agent = start(&user, &["--broker", &broker, "--machine", "lathe"]);
    let told = broker_until(listener, |all| !text(all, "Run/Setpoint Hash").is_empty());
    let program = user.program(THREAD);
    let run: serde_json::Value =
        serde_json::from_str(&good(&user.does(&["run", &program, "--json"]))).unwrap();
    let told = told.join().unwrap();
    let all = &told.all;
    let threads = run["threads"].as_array().unwrap();
    assert_eq!(threads.len(), 3);
    let known = text(all, "Cut/Known");
    assert_eq!(known, ["yes"; 3]);
    for (metric, field) in [
        ("Cut/Worst", "worst_um"),
        ("Cut/Worst U", "worst_um_u"),
        ("Cut/Least Groove", "least_um"),
        ("Cut/Least Groove U", "least_um_u"),
        ("Cut/Lead Error", "lead_um_per_turn"),
        ("Cut/Lead Error U", "lead_um_per_turn_u"),
    ] {
        let told: Vec<f64> = all
            .iter()
            .filter_map(|(name, value)| match value {
                Value::Double(value) if name == metric => Some(*value),
                _ => None,
            })
            .collect();
        let said: Vec<f64> = threads
            .iter()
            .map(|thread| thread["cut"][field].as_f64().expect(field))
            .collect();
        assert_eq!(told, said, "{metric}");
    }
    drop(told);
    end(agent);
}

#[test]
fn a_board_that_goes_or_never_was_delays_none_of_the_others() {
    let user = User::new();
    good(&user.does(&["up", "--name", "other"]));
    good(&user.does(&["up", "--name", "third"]));
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let broker = format!("mqtt://{}", listener.local_addr().unwrap());
    let boards = [
        "--board",
        "other=sim:other",
        "--board",
        "third=sim:third",
        "--board",
        "gone=sim:none",
        "--board",
        "wrong=nosuchcan0",
    ];
    let options = [
        "--broker",
        &broker,
        "--name",
        "shop",
        "--metrics",
        "127.0.0.1:0",
        "--json",
    ];
    let mut agent = start(&user, &[&boards[..], &options].concat());
    let (stream, _) = listener.accept().unwrap();
    let mut first = String::new();
    let mut output = BufReader::new(agent.stdout.take().unwrap());
    output.read_line(&mut first).unwrap();
    let first: serde_json::Value = serde_json::from_str(&first).unwrap();
    let topics: Vec<&str> = first["boards"]
        .as_array()
        .unwrap()
        .iter()
        .map(|board| board["topic"].as_str().unwrap())
        .collect();
    let expected =
        ["other", "third", "gone", "wrong"].map(|of| format!("spBv1.0/leadscrew/+/shop/{of}"));
    assert_eq!(topics, expected);
    let program = user.program(TAP);
    let on_third = |words: &[&str]| user.does(&[words, &["--bus", "sim:third"]].concat());
    let on_other = |words: &[&str]| user.does(&[words, &["--bus", "sim:other"]].concat());
    good(&on_other(&["run", &program]));
    let mut told = take_until(stream, "Run/Setpoint Hash");
    good(&user.does(&["down", "--name", "other"]));
    good(&on_third(&["run", &program]));
    // The death and the run of the other come in any order.
    told.until(|all| {
        text(all, "death").contains(&"other") && text(all, "Run/Setpoint Hash").len() == 2
    });
    let all = &told.all;
    // One that is not heard for a moment, on a busy computer, is told as that, too.
    assert!(text(all, "death").contains(&"other"), "{all:?}");
    assert_eq!(text(all, "Thread/Kind"), ["rigid_tap"; 2]);
    let hashes = text(all, "Run/Setpoint Hash");
    assert_eq!(hashes[0], hashes[1]);
    // One store: its numbers follow each other.
    let numbers: Vec<u64> = all
        .iter()
        .filter_map(|(name, value)| match value {
            Value::Long(number) if name == "Record/Number" => Some(*number),
            _ => None,
        })
        .collect();
    let gapless: Vec<u64> = (1..=numbers.len() as u64).collect();
    assert_eq!(numbers, gapless);
    let figures = figures(first["metrics"].as_str().unwrap());
    for (machine, up) in [("other", 0), ("third", 1), ("gone", 0), ("wrong", 0)] {
        let line = format!("leadscrew_board_up{{machine=\"{machine}\"}} {up}\n");
        assert!(figures.contains(&line), "{figures}");
    }
    drop(told);
    let said = end(agent);
    assert!(said.contains("gone: "), "{said}");
    assert!(said.contains("wrong: "), "{said}");
    assert!(
        said.contains("third: node 1 on sim:third is read"),
        "{said}"
    );
}

/// How an agent ends whose broker takes the connection and says nothing: TLS waits for its first word.
fn ended_before_a_word() -> Option<i32> {
    let user = User::with_machine();
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let broker = format!("mqtts://{}", listener.local_addr().unwrap());
    let tls = Path::new(env!("CARGO_MANIFEST_DIR")).join("../agent/tests/sent/tls");
    let authority = tls.join("authority.pem");
    let args = ["--broker", &broker, "--ca", authority.to_str().unwrap()];
    let mut agent = start(&user, &args);
    let _silent = listener.accept().unwrap();
    let pid = Pid::from_raw(i32::try_from(agent.id()).unwrap());
    kill(pid, Signal::SIGTERM).unwrap();
    agent.wait().unwrap().code()
}

/// A computer that is busy may need the ten seconds that an agent has for its end; it is tried a few times.
#[test]
fn an_agent_whose_broker_does_not_answer_ends_well() {
    let codes: Vec<_> = (0..3)
        .map(|_| ended_before_a_word())
        .take_while(|code| *code != Some(0))
        .collect();
    assert!(codes.len() < 3, "{codes:?}");
}

#[test]
fn a_credential_of_the_service_manager_is_taken() {
    let user = User::new();
    let login = user.0.join("login");
    fs::write(&login, "user\npassword\n").unwrap();
    // So it looks with an access list.
    fs::set_permissions(&login, fs::Permissions::from_mode(0o440)).unwrap();
    let login = login.to_str().unwrap();
    // It would begin, but for its store.
    let args = ["--broker", "mqtt://x", "--login", login, "--store", login];
    let words = |folder: &Path| {
        let mut command = user.command(&[&["agent"], &args[..]].concat());
        let output = command.env("CREDENTIALS_DIRECTORY", folder).output();
        bad(&output.unwrap(), 2)
    };
    let said = words(&user.0);
    assert!(said.contains("is no store of an agent"), "{said}");
    let said = words(&user.0.join("run"));
    assert!(said.contains("chmod 600"), "{said}");
}

#[test]
fn what_cannot_be_is_refused_with_what_helps() {
    let user = User::new();
    let login = user.0.join("login");
    fs::write(&login, "user\npassword\n").unwrap();
    fs::set_permissions(&login, fs::Permissions::from_mode(0o644)).unwrap();
    let login = login.to_str().unwrap();
    let refused = |args: &[&str], words: &str| {
        let output = user.does(&[&["agent"], args].concat());
        assert_eq!(output.status.code(), Some(2), "{args:?}");
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(said.contains(words), "{args:?}: {said}");
    };
    refused(&[], "nobody is to be told");
    refused(
        &["--metrics", "127.0.0.1:0", "--store", "file"],
        "figures alone are not kept",
    );
    refused(&["--broker", "http://x"], "neither mqtt nor mqtts");
    refused(
        &["--broker", "mqtt://x", "--machine", "a/b"],
        "`a/b` can be no part of a topic",
    );
    refused(
        &["--archive", "/proc/nope"],
        "nothing can be written to the archive `/proc/nope`",
    );
    refused(
        &["--archive", "archive", "--store", login],
        "login` is no store of an agent: name another file",
    );
    refused(&["--broker", "mqtt://x", "--login", login], "chmod 600");
    refused(&["--broker", "mqtts://x"], "--ca");
    refused(&["--broker", "mqtts://x", "--ca", login], "no certificate");
    let identity = ["--ca", login, "--identity", login];
    refused(
        &[&["--broker", "mqtts://x"], &identity[..]].concat(),
        "holds a private key: chmod 600",
    );
    refused(&["--broker", "mqtts://x", "--identity", login], "--ca");
    // What is wrong with the authority is not blamed on a good identity.
    let file = |name: &str| {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../agent/tests/sent/tls");
        fs::read_to_string(folder.join(name)).unwrap()
    };
    let [authority, good] = ["authority", "identity"].map(|name| user.0.join(name));
    let nothing = "-----BEGIN CERTIFICATE-----\nAAAA\n-----END CERTIFICATE-----\n";
    fs::write(&authority, nothing).unwrap();
    fs::write(&good, file("broker.pem") + &file("broker.key")).unwrap();
    fs::set_permissions(&good, fs::Permissions::from_mode(0o600)).unwrap();
    let files = ["--ca", "--identity"].into_iter().zip([&authority, &good]);
    let files: Vec<_> = files
        .flat_map(|(option, path)| [option, path.to_str().unwrap()])
        .collect();
    refused(
        &[&["--broker", "mqtts://x"], &files[..]].concat(),
        "authority` of --ca",
    );
    refused(
        &["--broker", "mqtt://x", "--primary-host", "a/b"],
        "no part of a topic",
    );
    refused(
        &["--metrics", "127.0.0.1:0", "--primary-host", "scada"],
        "--broker",
    );
    refused(&["--broker", "mqtt://x", "--bus", "sim"], "sim");
    let boards = |boards: &[&str], words: &str| {
        refused(&[&["--metrics", "127.0.0.1:0"], boards].concat(), words);
    };
    boards(
        &["--board", "a=sim:a", "--board", "a=sim:b"],
        "two boards are called `a`",
    );
    boards(
        &["--board", "a=sim:a", "--board", "b=sim:a,node=1"],
        "are one board, node 1 on sim:a",
    );
    boards(
        &["--board", "a=sim:a", "--bus", "sim:b"],
        "`--bus` is of one board",
    );
    boards(
        &["--board", "a=sim:a", "--node", "2"],
        "`--node` is of one board",
    );
    boards(&["--board", "a=sim:a", "--machine", "b"], "--machine");
    boards(&["--board", "a=sim"], "leadscrew up --name a");
    boards(
        &["--board", "a=can0,bitrate=500"],
        "`--bitrate` is for `slcan:` adapters",
    );
    refused(
        &[
            "--broker",
            "mqtt://x",
            "--board",
            "a/b=sim:a",
            "--board",
            "c=sim:c",
        ],
        "no part of a topic",
    );
}
