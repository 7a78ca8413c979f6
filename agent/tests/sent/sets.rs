//! Sets in force: what is retained at a broker, when, and what somebody hears of it who comes later.

use std::time::Duration;

use bytes::BytesMut;
use leadscrew_agent::Moment;
use leadscrew_agent::mqtt::client::{Client, Said};
use leadscrew_agent::mqtt::retained::{Deaf, Listener, hear};
use leadscrew_agent::sender::Sending;
use leadscrew_agent::set::{Set, Sets, topic, topics};
use leadscrew_agent::sparkplug::Machines;
use mqttbytes::QoS;
use mqttbytes::v4::{Packet, PingResp, Publish, SubAck, SubscribeReasonCode};

use crate::bench::{BIRTH, accept, acknowledge, keep, nowhere, packets, presence, state};
use crate::births::Folder;

const NOW: Duration = Duration::ZERO;

fn set(parameters: u32) -> Set {
    Set {
        serial: 1,
        firmware: "0.1.0".to_owned(),
        parameters,
        schema: 2,
        since: Moment(1),
        after: None,
        seen: Moment(2),
        values: None,
    }
}

/// What has been sent since: topics of records, and whose sets with their checksums; identifiers to acknowledge.
fn sent(sending: &mut Sending<'_>) -> (Vec<String>, Vec<u16>) {
    let mut words = Vec::new();
    let mut ids = Vec::new();
    for packet in packets(&mut sending.output().split()) {
        let Packet::Publish(publish) = packet else {
            continue;
        };
        ids.push(publish.pkid);
        assert_eq!(publish.qos, QoS::AtLeastOnce);
        assert_eq!(publish.retain, publish.topic.starts_with("leadscrew/v1/"));
        words.push(if publish.retain {
            let set = Set::read(&publish.payload).unwrap();
            format!("{} {}", publish.topic, set.parameters)
        } else {
            publish.topic
        });
    }
    (words, ids)
}

#[test]
fn a_set_is_retained_at_each_connection_and_where_it_changes() {
    let folder = Folder::new("sets");
    let store = folder.store();
    let machines = Machines::default();
    let mut sets = Sets::default();
    sets.take("lathe", &set(1));
    sets.take("mill", &set(7));
    let mut sending = Sending::new(&nowhere(), &store, NOW).unwrap();
    let turn = |sending: &mut Sending<'_>, bytes: &[u8], sets: &Sets| {
        sending.take(bytes, &machines, BIRTH, NOW).unwrap();
        sending.retain(sets, NOW);
        sent(sending).0
    };
    // Nothing before the broker takes it.
    assert_eq!(turn(&mut sending, &[], &sets), Vec::<String>::new());
    let both = [
        "spBv1.0/shop/NBIRTH/agent",
        "leadscrew/v1/shop/agent/lathe/set 1",
        "leadscrew/v1/shop/agent/mill/set 7",
    ];
    assert_eq!(turn(&mut sending, &accept(), &sets), both);
    assert_eq!(turn(&mut sending, &[], &sets), Vec::<String>::new());
    // The newest is what counts.
    sets.take("lathe", &set(2));
    sets.take("lathe", &set(3));
    let changed = ["leadscrew/v1/shop/agent/lathe/set 3"];
    assert_eq!(turn(&mut sending, &[], &sets), changed);
    // Another connection may be to a broker that has forgotten all.
    let mut again = Sending::new(&nowhere(), &store, NOW).unwrap();
    let all = turn(&mut again, &accept(), &sets);
    assert_eq!(all[1..], [changed[0], both[2]]);
}

#[test]
fn records_go_before_sets_and_nothing_goes_beyond_the_window() {
    let folder = Folder::new("behind");
    let store = folder.store();
    let mut machines = Machines::default();
    keep(&store, &mut machines, BIRTH.0, [presence(true)]);
    keep(&store, &mut machines, BIRTH.0, (1..=40).map(state));
    let mut sets = Sets::default();
    for number in 0..20 {
        sets.take(&format!("m{number}"), &set(number));
    }
    let mut sending = Sending::new(&nowhere(), &store, NOW).unwrap();
    let mut bytes = accept();
    let mut all = Vec::new();
    // Each turn of at most 16 messages makes room for the next.
    for _ in 0..20 {
        sending.take(&bytes, &machines, BIRTH, NOW).unwrap();
        sending.retain(&sets, NOW);
        let (words, ids) = sent(&mut sending);
        assert!(ids.len() <= 16, "{words:?}");
        all.extend(words);
        bytes = acknowledge(&ids);
    }
    assert!(sending.is_done());
    let records = 2 + 41;
    assert!(all[..records].iter().all(|topic| topic.starts_with("spB")));
    assert_eq!(all.len(), records + 20);
}

fn retained(topic: &str, payload: Vec<u8>) -> Vec<u8> {
    let mut publish = Publish::new(topic, QoS::AtMostOnce, payload);
    publish.retain = true;
    let mut bytes = BytesMut::new();
    publish.write(&mut bytes).unwrap();
    bytes.to_vec()
}

fn subscribed() -> Vec<u8> {
    let mut bytes = BytesMut::new();
    let code = SubscribeReasonCode::Success(QoS::AtMostOnce);
    SubAck::new(1, vec![code]).write(&mut bytes).unwrap();
    bytes.to_vec()
}

fn alive() -> Vec<u8> {
    let mut bytes = BytesMut::new();
    PingResp.write(&mut bytes).unwrap();
    bytes.to_vec()
}

#[test]
fn who_comes_later_hears_the_newest_of_each_and_knows_when_that_is_all() {
    let ms = Duration::from_millis;
    let mut listener = Listener::new("late", None, &topics("shop"));
    let first = packets(&mut listener.output().split());
    let [Packet::Connect(connect)] = &first[..] else {
        panic!("{first:?}");
    };
    assert!(connect.last_will.is_none() && connect.clean_session);
    listener.take(&accept(), NOW).unwrap();
    let asked = packets(&mut listener.output().split());
    let [Packet::Subscribe(asked)] = &asked[..] else {
        panic!("{asked:?}");
    };
    assert_eq!(asked.filters[0].path, "leadscrew/v1/shop/+/+/set");
    // An answer to nothing is none.
    listener.take(&alive(), NOW).unwrap();
    assert!(!listener.is_done(ms(1_000)));
    listener.take(&subscribed(), NOW).unwrap();
    assert_eq!(listener.output().split()[..], [0xC0, 0]);
    let (lathe, mill) = (topic("shop", "a", "lathe"), topic("shop", "a", "mill"));
    listener.take(&retained(&lathe, vec![1]), NOW).unwrap();
    // No quiet is long enough before the answer.
    assert!(!listener.is_done(ms(60_000)));
    listener.take(&alive(), ms(60_000)).unwrap();
    listener
        .take(&retained(&mill, vec![2]), ms(60_400))
        .unwrap();
    assert!(!listener.is_done(ms(60_600)));
    // What is told anew does not hold it up, and counts.
    let mut news = retained(&lathe, vec![3]);
    news[0] &= !1;
    listener.take(&news, ms(60_800)).unwrap();
    assert!(listener.is_done(ms(60_900)));
    let heard = listener.heard();
    assert_eq!(heard.messages[&lathe], [3]);
    assert_eq!(heard.messages[&mill], [2]);
    // An empty one says that there is none any more.
    listener.take(&retained(&mill, vec![]), NOW).unwrap();
    assert!(!listener.heard().messages.contains_key(&mill));
    assert_eq!(listener.heard().left_out, 0);
}

#[test]
fn a_huge_message_is_named_and_takes_no_memory() {
    let client = || {
        let mut client = Client::new("name", None, None, NOW);
        client.take(&accept(), NOW).unwrap();
        client
    };
    let mut bytes = retained("a/huge", vec![7; 1 << 20]);
    bytes.extend(retained("a/small", vec![9]));
    let expected = [
        Said::Huge("a/huge".to_owned()),
        Said::Message {
            topic: "a/small".to_owned(),
            payload: vec![9],
            retained: true,
        },
    ];
    assert_eq!(client().take(&bytes, NOW).unwrap(), expected);
    // In pieces of any size.
    for size in [1, 2, 3, 7, 4096, 100_000] {
        let mut client = client();
        let mut said = Vec::new();
        for piece in bytes.chunks(size) {
            said.extend(client.take(piece, NOW).unwrap());
        }
        assert_eq!(said, expected, "{size}");
    }
    // One that wants an answer gets it: the broker would tell nothing more.
    let mut publish = Publish::new("t", QoS::AtLeastOnce, vec![0; 1 << 17]);
    publish.pkid = 0x1234;
    let mut bytes = BytesMut::new();
    publish.write(&mut bytes).unwrap();
    let mut asked = client();
    asked.output().clear();
    asked.take(&bytes, NOW).unwrap();
    assert_eq!(asked.output()[..], [0x40, 2, 0x12, 0x34]);
    // No other packet is so large, and no topic is larger than its message.
    assert!(asked.take(&[0x20, 0xFF, 0xFF, 0x7F], NOW).is_err());
    let wrong = [0x32, 0x81, 0x80, 4, 0xFF, 0xFF];
    assert!(client().take(&wrong, NOW).is_err());
}

#[test]
fn more_than_there_is_room_for_is_counted() {
    let mut listener = Listener::new("late", None, "#");
    listener.take(&accept(), NOW).unwrap();
    let mut bytes = Vec::new();
    for number in 0..10_010 {
        bytes.extend(retained(&format!("t/{number}"), vec![1]));
    }
    listener.take(&bytes, NOW).unwrap();
    assert_eq!(listener.heard().messages.len(), 10_000);
    assert_eq!(listener.heard().left_out, 10);
    let mut listener = Listener::new("late", None, "#");
    listener.take(&accept(), NOW).unwrap();
    for number in 0..1_100 {
        let message = retained(&format!("t/{number:04}"), vec![1; 65_000]);
        listener.take(&message, NOW).unwrap();
    }
    let bytes: usize = listener.heard().messages.values().map(Vec::len).sum();
    assert!(bytes <= 64 << 20, "{bytes}");
    let heard = listener.heard();
    assert_eq!(heard.messages.len() as u64 + heard.left_out, 1_100);
}

#[test]
fn a_broker_that_never_answers_is_no_wait_without_end() {
    let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    let address = format!("mqtt://{address}").parse().unwrap();
    let limit = Duration::from_millis(100);
    let deaf = hear(&address, None, None, "late", "#", limit);
    assert!(matches!(deaf, Err(Deaf::NoAnswer)), "{deaf:?}");
}
