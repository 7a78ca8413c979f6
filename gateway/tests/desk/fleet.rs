//! `fleet` beside a machine and its agent: what a broker has retained of it, and files against that.

use std::collections::BTreeMap;
use std::fs;
use std::io::{Read as _, Write as _};
use std::net::{TcpListener, TcpStream};
use std::process::Output;
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

use bytes::BytesMut;
use leadscrew_agent::set::{Set, topic};
use leadscrew_can::MachineName;
use mqttbytes::QoS;
use mqttbytes::v4::{
    ConnAck, ConnectReturnCode, Packet, PingResp, PubAck, Publish, SubAck, SubscribeReasonCode,
    read,
};
use serde_json::Value;

use crate::agent::{end, start};
use crate::{LIMIT, User, bad, good, text};

type Retained = Arc<Mutex<BTreeMap<String, Vec<u8>>>>;

/// A broker that retains, and tells all of it to whoever subscribes to sets.
struct Broker {
    url: String,
    retained: Retained,
}

impl Broker {
    fn new() -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let url = format!("mqtt://{}", listener.local_addr().unwrap());
        let retained = Retained::default();
        let shared = Arc::clone(&retained);
        thread::spawn(move || {
            for stream in listener.incoming() {
                let (stream, retained) = (stream.unwrap(), Arc::clone(&shared));
                thread::spawn(move || serve(stream, &retained));
            }
        });
        Self { url, retained }
    }

    fn put(&self, topic: &str, message: &[u8]) {
        let mut retained = self.retained.lock().unwrap();
        retained.insert(topic.to_owned(), message.to_vec());
    }

    /// The set of the machine, once it is enough.
    #[track_caller]
    fn wait(&self, enough: impl Fn(&Set) -> bool) -> Set {
        let end = Instant::now() + LIMIT;
        loop {
            let message = self.retained.lock().unwrap().get(&own()).cloned();
            let set = message.map(|message| Set::read(&message).unwrap());
            if let Some(set) = set.filter(|set| enough(set)) {
                return set;
            }
            assert!(Instant::now() < end, "{:?}", self.retained);
            thread::sleep(Duration::from_millis(50));
        }
    }
}

/// The topic of the machine that is read.
fn own() -> String {
    topic("leadscrew", "node", "lathe")
}

fn serve(mut stream: TcpStream, retained: &Retained) {
    let mut bytes = BytesMut::new();
    let mut room = [0; 4096];
    while let Ok(count @ 1..) = stream.read(&mut room) {
        bytes.extend_from_slice(&room[..count]);
        while let Ok(packet) = read(&mut bytes, 1 << 20) {
            let mut answer = BytesMut::new();
            match packet {
                Packet::Connect(_) => {
                    let accept = ConnAck::new(ConnectReturnCode::Success, false);
                    accept.write(&mut answer).unwrap();
                }
                Packet::Subscribe(asked) => {
                    let code = SubscribeReasonCode::Success(QoS::AtMostOnce);
                    let taken = SubAck::new(asked.pkid, vec![code]);
                    taken.write(&mut answer).unwrap();
                    if asked.filters[0].path == "leadscrew/v1/leadscrew/+/+/set" {
                        for (topic, message) in retained.lock().unwrap().iter() {
                            let mut tell = Publish::new(topic, QoS::AtMostOnce, &message[..]);
                            tell.retain = true;
                            tell.write(&mut answer).unwrap();
                        }
                    }
                }
                Packet::Publish(publish) => {
                    PubAck::new(publish.pkid).write(&mut answer).unwrap();
                    if publish.retain {
                        let mut retained = retained.lock().unwrap();
                        retained.insert(publish.topic, publish.payload.to_vec());
                    }
                }
                Packet::PingReq => drop(PingResp.write(&mut answer).unwrap()),
                _ => {}
            }
            if stream.write_all(&answer).is_err() {
                return;
            }
        }
    }
}

/// A user with a machine, its agent's options, and a folder of machine files.
struct Shop {
    user: User,
    broker: Broker,
}

impl Shop {
    fn new() -> Self {
        let user = User::with_machine();
        fs::create_dir(user.0.join("machines")).unwrap();
        Self {
            user,
            broker: Broker::new(),
        }
    }

    fn agent(&self, more: &[&str]) -> std::process::Child {
        let args = [
            "--broker",
            &self.broker.url,
            "--machine",
            "lathe",
            "--name",
            "node",
        ];
        start(&self.user, &[&args[..], more].concat())
    }

    fn fleet(&self, args: &[&str]) -> Output {
        let args = [&["fleet"], args, &["--broker", &self.broker.url]].concat();
        self.user.does(&args)
    }

    fn file(&self, name: &str, text: &str) {
        fs::write(self.user.0.join("machines").join(name), text).unwrap();
    }

    fn diff(&self) -> (i32, Value) {
        let output = self.fleet(&["diff", "machines", "--json"]);
        let code = output.status.code().unwrap();
        (code, serde_json::from_str(&text(&output.stdout)).unwrap())
    }
}

#[test]
fn a_file_is_the_same_differs_and_is_the_same_again_after_a_push() {
    let shop = Shop::new();
    let user = &shop.user;
    let agent = shop.agent(&[]);
    let first = shop.broker.wait(|_| true);
    assert_eq!(first.after, None, "it was in force before");
    good(&user.does(&["params", "pull", "-o", "machines/lathe.toml"]));
    let same = good(&shop.fleet(&["diff", "machines"]));
    assert!(same.starts_with("lathe (node): the same, in force since "));
    assert!(same.contains("Z or earlier, last seen 2"), "{same}");
    // Somebody changes a value at the machine.
    good(&user.does(&["params", "set", "1420.X=11000"]));
    let changed = shop.broker.wait(|set| set.parameters != first.parameters);
    assert!(changed.after.is_some() && changed.since > first.since);
    let values = changed.values.clone().unwrap();
    assert_eq!(values["rapid_rate.X"], "11000 mm/min");
    let output = shop.fleet(&["diff", "machines"]);
    bad(&output, 1);
    let differs = text(&output.stdout);
    assert!(
        differs.contains("lathe (node): differs, in force since 2"),
        "{differs}"
    );
    let line = "  1420.X  rapid_rate.X  11000 mm/min  → 12000 mm/min\n";
    assert!(differs.contains(line), "{differs}");
    let chinese = shop.fleet(&["diff", "machines", "--lang", "zh"]);
    assert!(text(&chinese.stdout).contains("lathe（node）：不同，生效时间："));
    let (code, told) = shop.diff();
    let machine = &told["machines"][0];
    assert_eq!((code, &told["same"]), (1, &Value::Bool(false)));
    assert_eq!(machine["state"], "differs");
    assert_eq!(machine["parameters"], format!("{:08x}", changed.parameters));
    let change = &machine["changes"][0];
    assert_eq!(
        (&change["key"], &change["old"], &change["new"]),
        (&"1420.X".into(), &11000.into(), &12000.into())
    );
    // Changing is the machine's own command.
    good(&user.does(&["params", "push", "machines/lathe.toml"]));
    let pushed = shop.broker.wait(|set| set.parameters == first.parameters);
    assert!(pushed.after.is_some() && pushed.since > changed.since);
    good(&shop.fleet(&["diff", "machines"]));
    // An agent that begins again does not know less.
    end(agent);
    let seen = shop
        .broker
        .wait(|set| set.parameters == first.parameters)
        .seen;
    let agent = shop.agent(&[]);
    let again = shop.broker.wait(|set| set.seen > seen);
    assert_eq!((again.since, again.after), (pushed.since, pushed.after));
    let list: Value = serde_json::from_str(&good(&shop.fleet(&["list", "--json"]))).unwrap();
    let machine = &list["machines"][0];
    assert_eq!(
        (&machine["machine"], &machine["node"]),
        (&"lathe".into(), &"node".into())
    );
    let serial = MachineName::default().serial();
    assert_eq!(machine["serial"], format!("{serial:08x}"));
    assert_eq!(machine["firmware"], first.firmware);
    let table = good(&shop.fleet(&["list"]));
    let head = table.lines().next().unwrap();
    for column in [
        "machine",
        "node",
        "serial",
        "firmware",
        "parameters",
        "in force since",
        "last seen",
    ] {
        assert!(head.contains(column), "{table}");
    }
    end(agent);
}

#[test]
fn an_agent_may_keep_the_set_to_itself() {
    let shop = Shop::new();
    let mut agent = shop.agent(&["--no-set", "--json"]);
    let mut first = String::new();
    let mut output = std::io::BufReader::new(agent.stdout.take().unwrap());
    std::io::BufRead::read_line(&mut output, &mut first).unwrap();
    let first: Value = serde_json::from_str(&first).unwrap();
    assert!(first["boards"][0]["topic"].is_string());
    assert!(first["boards"][0]["set"].is_null());
    // It is read in time for a set, and ends.
    let program = shop.user.program(crate::SHORT);
    good(&shop.user.does(&["run", &program]));
    end(agent);
    assert!(shop.broker.retained.lock().unwrap().is_empty());
    let nobody = shop.fleet(&["list"]);
    assert!(bad(&nobody, 3).contains("retains no set of the group `leadscrew`"));
    // Silence is no consent either.
    shop.file("lathe.toml", "schema = 2\n");
    let nobody = shop.fleet(&["diff", "machines"]);
    assert!(bad(&nobody, 3).contains("retains no set of the group `leadscrew`"));
}

#[test]
fn what_others_put_there_is_named_and_harms_nobody() {
    let user = User::new();
    fs::create_dir(user.0.join("machines")).unwrap();
    let shop = Shop {
        user,
        broker: Broker::new(),
    };
    let set = |values: &str| {
        format!(
            r#"{{"serial":"00000007","firmware":"0.1.0","parameters":"{:08x}","schema":2,"since":1764150000123,"after":null,"seen":1764150000123,"values":{values}}}"#,
            leadscrew_core::link::identity(&leadscrew_core::params::Params::slant_bed()),
        )
    };
    let of = |node: &str, machine: &str| topic("leadscrew", node, machine);
    let put = |node: &str, machine: &str, message: &str| {
        shop.broker.put(&of(node, machine), message.as_bytes());
    };
    // Two machines of one name, one without a file, and one whose set nobody knows.
    put("hall1", "lathe", &set("{}"));
    put("hall2", "lathe", &set("{}"));
    put("hall1", "mill", &set("{}"));
    put("hall1", "odd", &set(r#"{"warp_drive":"9"}"#));
    put("hall1", "wrong", &set("{}"));
    // And what is none.
    put("x", "junk", "\u{1b}[2J not JSON");
    put("x", "esc\u{1b}[31m", &set("{}"));
    put("x", "huge", &"9".repeat(200_000));
    put("x", "types", &set("[1]"));
    shop.file("lathe.toml", "schema = 2\n");
    shop.file("odd.toml", "schema = 2\n");
    shop.file("wrong.toml", "schema = 2\nrapid_rate.X = \"fast\"\n");
    shop.file("absent.toml", "schema = 2\n");
    shop.file("README.md", "no machine file");
    let output = shop.fleet(&["diff", "machines"]);
    let said = bad(&output, 1);
    let told = text(&output.stdout);
    for words in [
        "lathe (hall1): the same, in force since 2025-11-26T09:40:00Z or earlier, last seen 2",
        "lathe (hall2): the same, ",
        "mill (hall1): no file mill.toml\n",
        "odd (hall1): its set is not known here: `warp_drive = 9` is no value",
        "wrong (hall1): its file wrong.toml is refused",
        "machines/absent.toml: no machine of this name was heard\n",
    ] {
        assert!(told.contains(words), "{words}: {told}");
    }
    for words in [
        "left out: leadscrew/v1/leadscrew/x/junk/set: not the JSON of a set",
        "left out: leadscrew/v1/leadscrew/x/esc\\u{1b}[31m/set: no agent has such a topic",
        "left out: leadscrew/v1/leadscrew/x/huge/set: too large for a set",
        "left out: leadscrew/v1/leadscrew/x/types/set: not the JSON",
        "wrong.toml:2",
    ] {
        assert!(said.contains(words), "{words}: {said}");
    }
    let is_raw = |c: char| c.is_control() && c != '\n';
    assert!(!said.contains(is_raw) && !told.contains(is_raw));
    let (code, json) = shop.diff();
    let states: Vec<&str> = json["machines"]
        .as_array()
        .unwrap()
        .iter()
        .map(|machine| machine["state"].as_str().unwrap())
        .collect();
    let expected = ["same", "same", "no_file", "set_not_known", "file_refused"];
    assert_eq!((code, &states[..]), (1, &expected[..]));
    assert_eq!(json["ignored"].as_array().unwrap().len(), 4);
    assert_eq!(json["files_without_machine"][0], "machines/absent.toml");
    // What all machines have stands below the file of each.
    shop.file(
        "../common.toml",
        "schema = 2\nrapid_rate.Z = \"9000 mm/min\"\n",
    );
    let over = shop.fleet(&["diff", "machines", "--params", "common.toml"]);
    assert!(text(&over.stdout).contains("→ 9000 mm/min"));
}

#[test]
fn a_broker_that_does_not_answer_or_is_not_there_is_named() {
    let user = User::new();
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let broker = format!("mqtt://{}", listener.local_addr().unwrap());
    let list = |args: &[&str]| user.does(&[&["fleet", "list"], args].concat());
    let said = bad(&list(&["--broker", &broker, "--wait", "1"]), 3);
    assert!(said.contains("has not answered within 1 s"), "{said}");
    drop(listener);
    let said = bad(&list(&["--broker", &broker]), 3);
    assert!(said.contains("is not reached"), "{said}");
    let said = bad(&list(&["--broker", &broker, "--group", "a/b"]), 2);
    assert!(said.contains("no part of a topic"), "{said}");
    let said = bad(&list(&["--broker", "mqtts://x"]), 2);
    assert!(said.contains("--ca"), "{said}");
    bad(&list(&[]), 2);
    let said = bad(&list(&["--broker", &broker, "--bus", "can0"]), 2);
    assert!(
        said.contains("talks to no board: leave out `--bus socketcan:can0`"),
        "{said}"
    );
    let diff = |folder: &str| user.does(&["fleet", "diff", folder, "--broker", &broker]);
    let said = bad(&diff("nowhere"), 2);
    assert!(said.contains("cannot read `nowhere`"), "{said}");
    fs::create_dir(user.0.join("empty")).unwrap();
    let said = bad(&diff("empty"), 2);
    assert!(said.contains("holds no machine file"), "{said}");
}
