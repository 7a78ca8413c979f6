//! Sessions without sockets.

use std::time::Duration;

use bytes::BytesMut;
use leadscrew_agent::mqtt::{Client, Fault, Login, Refusal};
use leadscrew_agent::record::{Cut, Errors, Figure, Measured, Start, Thread};
use leadscrew_agent::sender::{Sending, Trouble};
use leadscrew_agent::sparkplug::payload::{Metric, Payload, Value};
use leadscrew_agent::sparkplug::{Machines, Message, Names, metrics};
use leadscrew_agent::{Body, Memory, Moment, Numbered, Record, Store};
use mqttbytes::QoS;
use mqttbytes::v4::{ConnAck, ConnectReturnCode, Packet, Publish};
use prost::Message as _;

use crate::bench::{
    BIRTH, accept, acknowledge, keep, keep_of, metric, nowhere, packets, presence, sent, state,
};

const NOW: Duration = Duration::ZERO;

/// A store on a disk of its own that is gone with it.
pub struct Folder(std::path::PathBuf);

impl Folder {
    pub fn new(name: &str) -> Self {
        let path = format!("leadscrew-sent-{name}-{}", std::process::id());
        let path = std::env::temp_dir().join(path);
        let _ = std::fs::remove_dir_all(&path);
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    pub fn store(&self) -> Store {
        Store::open(&self.0.join("store"), 1 << 20, Moment(77)).unwrap()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// A sender whose broker has heard of its one machine, and what is known of that.
fn born(store: &Store) -> (Sending<'_>, Machines) {
    let mut values = Machines::default();
    keep(store, &mut values, BIRTH.0, [presence(true)]);
    let mut sending = Sending::new(&nowhere(), store, NOW).unwrap();
    sending.take(&accept(), &values, BIRTH, NOW).unwrap();
    let (words, _) = sent(&mut sending);
    assert_eq!(words.len(), 3, "two births and its presence: {words:?}");
    (sending, values)
}

fn birth_number(payload: &[u8]) -> Option<Value> {
    let payload = Payload::decode(payload).unwrap();
    metric(&payload, "bdSeq").and_then(|metric| metric.value.clone())
}

#[test]
fn births_come_first_and_what_is_older_is_history() {
    let folder = Folder::new("births");
    let store = folder.store();
    let mut values = Machines::default();
    keep(&store, &mut values, 1_000, [presence(true), state(1)]);
    let mut sending = Sending::new(&nowhere(), &store, NOW).unwrap();
    let first = packets(&mut sending.output().split());
    let [Packet::Connect(connect)] = &first[..] else {
        panic!("{first:?}");
    };
    let will = connect.last_will.as_ref().unwrap();
    assert_eq!(connect.client_id, "leadscrew-shop-agent");
    assert_eq!(will.topic, "spBv1.0/shop/NDEATH/agent");
    assert_eq!((will.qos, will.retain), (QoS::AtLeastOnce, false));
    assert_eq!(birth_number(&will.message), Some(Value::Long(1)));
    // Nothing is said before the broker has taken it.
    sending.take(&[], &values, BIRTH, NOW).unwrap();
    assert!(sending.output().is_empty());
    sending.take(&accept(), &values, BIRTH, NOW).unwrap();
    let bytes = sending.output().clone();
    let said = packets(&mut bytes.clone());
    let Packet::Subscribe(orders) = &said[0] else {
        panic!("{said:?}");
    };
    assert_eq!(orders.filters[0].path, "spBv1.0/shop/NCMD/agent");
    let Packet::Publish(node) = &said[1] else {
        panic!("{said:?}");
    };
    assert_eq!(birth_number(&node.payload), Some(Value::Long(1)));
    let Packet::Publish(machine) = &said[2] else {
        panic!("{said:?}");
    };
    let machine = Payload::decode(&machine.payload[..]).unwrap();
    let names: Vec<_> = machine
        .metrics
        .iter()
        .map(|metric| metric.name.as_deref())
        .collect();
    let all: Vec<_> = metrics::TABLE.iter().map(|row| Some(row.name)).collect();
    assert_eq!(names, all);
    assert_eq!(metric(&machine, "Run/Ticks").unwrap().is_null, Some(true));
    assert_eq!(
        metric(&machine, "Program/Line").unwrap().value,
        Some(Value::Int(1))
    );
    keep(&store, &mut values, BIRTH.0, [state(2)]);
    sending.take(&[], &values, BIRTH, NOW).unwrap();
    let (words, _) = sent(&mut sending);
    assert_eq!(
        words,
        [
            "NBIRTH/agent 0",
            "DBIRTH/agent/lathe 1 line 1",
            "DDATA/agent/lathe 2",
            "DDATA/agent/lathe 3 line 1 old",
            "DDATA/agent/lathe 4 line 2"
        ]
    );
}

#[test]
fn a_clock_that_is_set_back_makes_nothing_old() {
    let folder = Folder::new("clock");
    let store = folder.store();
    let mut values = Machines::default();
    let early = Moment(BIRTH.0 / 2);
    keep(&store, &mut values, early.0, [presence(true), state(1)]);
    let mut sending = Sending::new(&nowhere(), &store, NOW).unwrap();
    sending.take(&accept(), &values, BIRTH, NOW).unwrap();
    // The clock is set back here.
    keep(&store, &mut values, early.0 + 1, [state(2)]);
    sending.take(&[], &values, early, NOW).unwrap();
    let (words, _) = sent(&mut sending);
    assert_eq!(
        words[3..],
        [
            "DDATA/agent/lathe 3 line 1 old",
            "DDATA/agent/lathe 4 line 2"
        ],
        "{words:?}"
    );
}

#[test]
fn what_is_not_acknowledged_is_sent_again_and_the_rest_is_gone() {
    let folder = Folder::new("again");
    let store = folder.store();
    let mut values = Machines::default();
    keep(&store, &mut values, BIRTH.0, [presence(true)]);
    keep(&store, &mut values, BIRTH.0, (1..=30).map(state));
    let mut sending = Sending::new(&nowhere(), &store, NOW).unwrap();
    sending.take(&accept(), &values, BIRTH, NOW).unwrap();
    let (words, ids) = sent(&mut sending);
    assert_eq!(words.len(), 16, "as many as there are under way: {words:?}");
    // Two births, presence and two states.
    sending
        .take(&acknowledge(&ids[..5]), &values, BIRTH, NOW)
        .unwrap();
    assert_eq!(store.figures().unwrap().records, 28);
    let (words, _) = sent(&mut sending);
    assert_eq!(words.len(), 5);
    drop(sending);
    let mut sending = Sending::new(&nowhere(), &store, NOW).unwrap();
    let connect = packets(&mut sending.output().split());
    let Packet::Connect(connect) = &connect[0] else {
        panic!("{connect:?}");
    };
    let will = connect.last_will.as_ref().unwrap();
    assert_eq!(birth_number(&will.message), Some(Value::Long(2)));
    let mut lines = Vec::new();
    sending.take(&accept(), &values, BIRTH, NOW).unwrap();
    while !sending.is_done() {
        let (words, ids) = sent(&mut sending);
        lines.extend(words.into_iter().filter(|word| word.starts_with("DDATA")));
        sending
            .take(&acknowledge(&ids), &values, BIRTH, NOW)
            .unwrap();
    }
    let expected = (3..=30).map(|line| format!("DDATA/agent/lathe {} line {line}", line - 1));
    assert_eq!(lines, expected.collect::<Vec<_>>());
    assert_eq!(store.figures().unwrap().records, 0);
}

#[test]
fn a_host_may_ask_for_births_and_for_nothing_else() {
    let folder = Folder::new("orders");
    let store = folder.store();
    let (mut sending, values) = born(&store);
    let order = |topic: &str, name: &str, value| {
        let metric = Metric {
            name: Some(name.to_owned()),
            value: Some(value),
            ..Metric::default()
        };
        let payload = Payload {
            metrics: vec![metric],
            ..Payload::default()
        };
        let mut publish = Publish::new(topic, QoS::AtMostOnce, payload.encode_to_vec());
        publish.pkid = 1;
        let mut bytes = BytesMut::new();
        publish.write(&mut bytes).unwrap();
        bytes.to_vec()
    };
    let topic = "spBv1.0/shop/NCMD/agent";
    let rebirth = "Node Control/Rebirth";
    for nothing in [
        order(topic, rebirth, Value::Boolean(false)),
        order(topic, "Node Control/Reboot", Value::Boolean(true)),
        order("spBv1.0/shop/NCMD/other", rebirth, Value::Boolean(true)),
        order(
            "spBv1.0/shop/DCMD/agent/lathe",
            "Machine/Hold",
            Value::Boolean(true),
        ),
    ] {
        sending.take(&nothing, &values, BIRTH, NOW).unwrap();
        assert_eq!(sent(&mut sending).0, Vec::<String>::new());
    }
    let asked = order(topic, rebirth, Value::Boolean(true));
    sending.take(&asked, &values, BIRTH, NOW).unwrap();
    let (words, _) = sent(&mut sending);
    assert_eq!(words, ["NBIRTH/agent 0", "DBIRTH/agent/lathe 1"]);
}

/// Of all machines of an edge node: a host keeps one table of them.
#[test]
fn no_two_metrics_have_the_same_alias() {
    let folder = Folder::new("aliases");
    let store = folder.store();
    let mut values = Machines::default();
    for machine in ["one", "two"] {
        keep_of(machine, &store, &mut values, BIRTH.0, [presence(true)]);
    }
    let mut sending = Sending::new(&nowhere(), &store, NOW).unwrap();
    sending.take(&accept(), &values, BIRTH, NOW).unwrap();
    keep_of("two", &store, &mut values, BIRTH.0, [state(7)]);
    sending.take(&[], &values, BIRTH, NOW).unwrap();
    let mut names = std::collections::BTreeMap::new();
    let mut lines = Vec::new();
    for packet in packets(&mut sending.output().split()) {
        let Packet::Publish(publish) = packet else {
            continue;
        };
        let machine = publish.topic.rsplit('/').next().unwrap().to_owned();
        let payload = Payload::decode(&publish.payload[..]).unwrap();
        for metric in payload.metrics {
            let Some(alias) = metric.alias else { continue };
            match metric.name {
                Some(name) => {
                    let before = names.insert(alias, (machine.clone(), name));
                    assert_eq!(before, None, "{alias}");
                }
                None => lines.push((names[&alias].clone(), metric.value)),
            }
        }
    }
    assert_eq!(names.len(), 2 * metrics::TABLE.len());
    let line = ("two".to_owned(), "Program/Line".to_owned());
    assert!(lines.contains(&(line, Some(Value::Int(7)))), "{lines:?}");
}

#[test]
fn a_huge_order_is_told_once_and_dropped() {
    let folder = Folder::new("huge");
    let store = folder.store();
    let (mut sending, values) = born(&store);
    for told in [Some("spBv1.0/shop/NCMD/agent/1".to_owned()), None] {
        let mut bytes = BytesMut::new();
        for number in 1..=3 {
            let topic = format!("spBv1.0/shop/NCMD/agent/{number}");
            let publish = Publish::new(topic, QoS::AtMostOnce, vec![0; 1 << 17]);
            publish.write(&mut bytes).unwrap();
        }
        sending.take(&bytes, &values, BIRTH, NOW).unwrap();
        assert_eq!(sent(&mut sending).0, Vec::<String>::new());
        assert_eq!(sending.huge(), told);
        assert_eq!(sending.huge(), None);
    }
}

#[test]
fn a_machine_that_goes_dies_behind_what_it_said() {
    let folder = Folder::new("death");
    let store = folder.store();
    let mut values = Machines::default();
    let mut sending = Sending::new(&nowhere(), &store, NOW).unwrap();
    let mut turn = |store: &Store, values: &Machines, bytes: &[u8]| {
        sending.take(bytes, values, BIRTH, NOW).unwrap();
        let (words, ids) = sent(&mut sending);
        sending
            .take(&acknowledge(&ids), values, BIRTH, NOW)
            .unwrap();
        assert_eq!(store.figures().unwrap().records, 0);
        words
    };
    assert_eq!(turn(&store, &values, &accept()), ["NBIRTH/agent 0"]);
    keep(&store, &mut values, BIRTH.0, [presence(true), state(1)]);
    assert_eq!(
        turn(&store, &values, &[]),
        [
            "DBIRTH/agent/lathe 1 line 1",
            "DDATA/agent/lathe 2",
            "DDATA/agent/lathe 3 line 1"
        ]
    );
    keep(&store, &mut values, BIRTH.0, [state(2), presence(false)]);
    assert_eq!(
        turn(&store, &values, &[]),
        [
            "DDATA/agent/lathe 4 line 2",
            "DDATA/agent/lathe 5",
            "DDEATH/agent/lathe 6"
        ]
    );
    assert_eq!(turn(&store, &values, &[]), Vec::<String>::new());
    keep(&store, &mut values, BIRTH.0, [presence(true)]);
    assert_eq!(
        turn(&store, &values, &[]),
        ["DBIRTH/agent/lathe 7 line 2", "DDATA/agent/lathe 8"]
    );
    // The number begins anew behind 255.
    keep(&store, &mut values, BIRTH.0, [state(3)]);
    let mut words = turn(&store, &values, &[]);
    for line in 0..248 {
        keep(&store, &mut values, BIRTH.0, [state(line)]);
        words.extend(turn(&store, &values, &[]));
    }
    assert_eq!(words[246], "DDATA/agent/lathe 255 line 245");
    assert_eq!(words[247], "DDATA/agent/lathe 0 line 246");
}

fn client(login: Option<&Login>) -> Client {
    let will = Message {
        topic: "t".to_owned(),
        payload: Vec::new(),
    };
    Client::new("name", login, Some(will), NOW)
}

#[test]
fn refusals_and_silence_are_told_apart() {
    let answer = |code| {
        let mut bytes = BytesMut::new();
        ConnAck::new(code, false).write(&mut bytes).unwrap();
        client(None).take(&bytes, NOW)
    };
    assert_eq!(
        answer(ConnectReturnCode::BadUserNamePassword),
        Err(Fault::Login)
    );
    assert_eq!(answer(ConnectReturnCode::NotAuthorized), Err(Fault::Login));
    for (code, refusal) in [
        (ConnectReturnCode::RefusedProtocolVersion, Refusal::Version),
        (ConnectReturnCode::BadClientId, Refusal::Name),
        (ConnectReturnCode::ServiceUnavailable, Refusal::Closed),
    ] {
        assert_eq!(answer(code), Err(Fault::Refused(refusal)));
    }
    // SUBACK that refuses.
    let mut taken = client(None);
    taken.take(&accept(), NOW).unwrap();
    assert_eq!(taken.take(&[0x90, 3, 0, 1, 0x80], NOW), Err(Fault::Orders));
    // Who has not answered yet has less time than who has.
    let second = Duration::from_secs(1);
    let mut mute = client(None);
    mute.attend(10 * second).unwrap();
    assert_eq!(mute.attend(11 * second), Err(Fault::Mute));
    let mut quiet = client(None);
    quiet.take(&accept(), NOW).unwrap();
    quiet.output().clear();
    quiet.attend(15 * second).unwrap();
    assert!(quiet.output().is_empty());
    quiet.attend(16 * second).unwrap();
    assert_eq!(quiet.output()[..], [0xC0, 0]);
    quiet.attend(45 * second).unwrap();
    assert_eq!(quiet.attend(46 * second), Err(Fault::Silent));
}

#[test]
fn what_is_no_broker_is_told_at_its_first_bytes() {
    let answer = |bytes: &[u8]| client(None).take(bytes, NOW);
    let quoted = |text: &str| Err(Fault::Nonsense(text.to_owned()));
    // MQTT would wait for more of both.
    assert_eq!(
        answer(b"HTTP/1.1 400 Bad Request\r\n"),
        quoted("\"HTTP/1.1 400 Bad\"")
    );
    assert_eq!(answer(b"SSH-2.0\r\n"), quoted("\"SSH-2.0\\r\\n\""));
    assert_eq!(answer(&[0, 0]), quoted("\"\\x00\\x00\""));
    // An alert and a handshake of TLS, in two parts too.
    assert_eq!(answer(&[0x15, 3, 1, 0, 2, 2, 70]), Err(Fault::Tls));
    assert_eq!(answer(&[0x16, 3, 3]), Err(Fault::Tls));
    let mut parts = client(None);
    assert_eq!(parts.take(&[0x15], NOW), Ok(Vec::new()));
    assert_eq!(parts.take(&[3, 1, 0, 2, 2, 70], NOW), Err(Fault::Tls));
    // And what goes wrong later, in no words of a library.
    let mut taken = client(None);
    taken.take(&accept(), NOW).unwrap();
    assert_eq!(
        taken.take(&[0x32, 2, 0x44, 0x4F], NOW),
        quoted("\"2\\x02DO\"")
    );
}

#[test]
fn user_and_password_go_along() {
    let login = Login {
        user: "u".to_owned(),
        password: "p".to_owned(),
    };
    assert_eq!(format!("{login:?}"), "Login(u)");
    let connect = packets(&mut client(Some(&login)).output().split());
    let [Packet::Connect(connect)] = &connect[..] else {
        panic!("{connect:?}");
    };
    let sent = connect.login.as_ref().unwrap();
    assert_eq!((sent.username.as_str(), sent.password.as_str()), ("u", "p"));
}

#[test]
fn nothing_that_a_broker_says_ends_the_agent() {
    leadscrew_seed::volume(1, |seed| {
        let folder = Folder::new("hostile");
        let store = folder.store();
        let values = Machines::default();
        let mut random = seed;
        let mut next = || {
            random = random
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (random >> 33) as u32
        };
        for _ in 0..leadscrew_seed::amount(300, 10_000) {
            let mut sending = Sending::new(&nowhere(), &store, NOW).unwrap();
            sending.take(&accept(), &values, BIRTH, NOW).unwrap();
            let kinds = [
                0x20, 0x30, 0x32, 0x34, 0x40, 0x50, 0x62, 0x70, 0x90, 0xB0, 0xD0,
            ];
            let mut bytes = Vec::new();
            for _ in 0..4 {
                let length = next() % 24;
                bytes.push(kinds[next() as usize % kinds.len()] | (next() % 16 / 15) as u8);
                bytes.push(length as u8);
                bytes.extend((0..length).map(|_| (next() % 4).wrapping_mul(next()) as u8));
            }
            match sending.take(&bytes, &values, BIRTH, NOW) {
                Ok(()) | Err(Trouble::Broker(_)) => {}
                Err(other) => panic!("{other:?}"),
            }
        }
    });
}

#[test]
fn names_that_are_no_part_of_a_topic_are_refused() {
    Names::new("a b", "ä", ["sim:desk"]).unwrap();
    for bad in ["", "a/b", "+", "a#", "a\nb"] {
        assert_eq!(Names::new("g", bad, ["d"]).unwrap_err().0, bad);
        assert_eq!(Names::new("g", "n", ["d", bad]).unwrap_err().0, bad);
    }
}

#[test]
fn the_cut_is_told_in_full_and_what_is_not_known_as_null() {
    let thread = |cut| {
        Body::Thread(Thread {
            start: Start::default(),
            number: 1,
            program: 1,
            line: 1,
            kind: "thread".to_owned(),
            end: "finished".to_owned(),
            passes: 2,
            late: 0,
            errors: Errors {
                measured: 0,
                largest_nm: 0,
                squares: 0,
            },
            cut,
        })
    };
    let told = |cut| {
        let record = Record {
            at: BIRTH,
            machine: String::new(),
            body: thread(cut),
        };
        let record = Numbered { number: 1, record };
        Payload {
            metrics: metrics::of_record(&record, 0, false),
            ..Payload::default()
        }
    };
    let value = |payload: &Payload, name: &str| metric(payload, name).unwrap().value.clone();
    let measured = told(Cut::Measured(Measured {
        axis: 'Z',
        age_known: false,
        positions: 90,
        passes: 1,
        lead_nm: 1_500_000,
        grooves: Some([Figure(-1_250, 300), Figure(-1_250, 301)]),
        apart: None,
        slope: Some(Figure(40, 9)),
        worst: Figure(2_500, 600),
        complete: false,
        why: "groove of one alone".to_owned(),
    }));
    let text = |text: &str| Some(Value::String(text.to_owned()));
    for (name, expected) in [
        ("Cut/Known", text("partly")),
        ("Cut/Why", text("groove of one alone")),
        ("Cut/Axis", text("Z")),
        ("Cut/Age Known", Some(Value::Boolean(false))),
        ("Cut/Positions", Some(Value::Int(90))),
        ("Cut/Passes", Some(Value::Int(1))),
        ("Cut/Lead", Some(Value::Double(1.5))),
        ("Cut/Least Groove", Some(Value::Double(-1.25))),
        ("Cut/Least Groove U", Some(Value::Double(0.3))),
        ("Cut/Most Groove U", Some(Value::Double(0.301))),
        ("Cut/Pass to Pass", None),
        ("Cut/Pass to Pass U", None),
        ("Cut/Lead Error", Some(Value::Double(0.04))),
        ("Cut/Worst", Some(Value::Double(2.5))),
        ("Cut/Worst U", Some(Value::Double(0.6))),
    ] {
        assert_eq!(value(&measured, name), expected, "{name}");
    }
    let is_null = metric(&measured, "Cut/Pass to Pass").unwrap().is_null;
    assert_eq!(is_null, Some(true));
    let unknown = told(Cut::Unknown("no position".to_owned()));
    assert_eq!(value(&unknown, "Cut/Known"), text("no"));
    assert_eq!(value(&unknown, "Cut/Why"), text("no position"));
    assert_eq!(value(&unknown, "Cut/Worst"), None);
    assert_eq!(value(&told(Cut::NotRead), "Cut/Known"), text("not_read"));
    assert_eq!(value(&told(Cut::Hole), "Cut/Known"), text("hole"));
}

#[test]
fn machines_of_one_agent_share_one_sequence_and_die_alone() {
    let folder = Folder::new("several");
    let store = folder.store();
    let mut machines = Machines::default();
    keep(&store, &mut machines, BIRTH.0, [presence(true), state(1)]);
    keep_of(
        "mill",
        &store,
        &mut machines,
        BIRTH.0,
        [presence(true), state(2)],
    );
    // One that was taken out of the agent has left a record, and is told too.
    let old = Record {
        at: Moment(1),
        machine: "old".to_owned(),
        body: state(9),
    };
    store.keep("old", &[old], &Memory::default()).unwrap();
    let mut sending = Sending::new(&nowhere(), &store, NOW).unwrap();
    let mut turn = |machines: &Machines, bytes: &[u8]| {
        sending.take(bytes, machines, BIRTH, NOW).unwrap();
        let (words, ids) = sent(&mut sending);
        sending
            .take(&acknowledge(&ids), machines, BIRTH, NOW)
            .unwrap();
        words
    };
    assert_eq!(
        turn(&machines, &accept()),
        [
            "NBIRTH/agent 0",
            "DBIRTH/agent/lathe 1 line 1",
            "DBIRTH/agent/mill 2 line 2",
            "DDATA/agent/lathe 3",
            "DDATA/agent/lathe 4 line 1",
            "DDATA/agent/mill 5",
            "DDATA/agent/mill 6 line 2",
            "DBIRTH/agent/old 7",
            "DDATA/agent/old 8 line 9 old",
            "DDEATH/agent/old 9",
        ]
    );
    keep(&store, &mut machines, BIRTH.0, [presence(false)]);
    keep_of("mill", &store, &mut machines, BIRTH.0, [state(3)]);
    assert_eq!(
        turn(&machines, &[]),
        [
            "DDATA/agent/lathe 10",
            "DDATA/agent/mill 11 line 3",
            "DDEATH/agent/lathe 12",
        ]
    );
    // Births that are asked for are of those that live.
    assert_eq!(store.figures().unwrap().records, 0);
    let mut again = Sending::new(&nowhere(), &store, NOW).unwrap();
    again.take(&accept(), &machines, BIRTH, NOW).unwrap();
    let (words, _) = sent(&mut again);
    assert_eq!(words, ["NBIRTH/agent 0", "DBIRTH/agent/mill 1 line 3"]);
}
