//! A primary host that comes and goes: nothing is sent while it is away.

use std::time::Duration;

use bytes::BytesMut;
use leadscrew_agent::sender::{Broker, Sending, Trouble};
use leadscrew_agent::sparkplug::{Host, Machines};
use mqttbytes::QoS;
use mqttbytes::v4::{Packet, Publish};

use crate::bench::{BIRTH, accept, acknowledge, keep, nowhere, packets, presence, sent, state};
use crate::births::Folder;

const NOW: Duration = Duration::ZERO;

fn says(online: bool, timestamp: u64) -> Vec<u8> {
    let payload = format!(r#"{{"online":{online},"timestamp":{timestamp}}}"#);
    let mut publish = Publish::new("spBv1.0/STATE/scada", QoS::AtMostOnce, payload);
    publish.retain = true;
    let mut bytes = BytesMut::new();
    publish.write(&mut bytes).unwrap();
    bytes.to_vec()
}

#[test]
fn all_is_kept_until_the_host_is_there_and_from_when_it_goes() {
    let folder = Folder::new("host");
    let store = folder.store();
    let mut values = Machines::default();
    keep(&store, &mut values, BIRTH.0, [presence(true), state(1)]);
    let broker = Broker {
        primary: Some(Host::new("scada")),
        ..nowhere()
    };
    let mut sending = Sending::new(&broker, &store, NOW).unwrap();
    sending.output().clear();
    sending.take(&accept(), &values, BIRTH, NOW).unwrap();
    let said = packets(&mut sending.output().split());
    let topics: Vec<_> = said
        .iter()
        .map(|packet| match packet {
            Packet::Subscribe(one) => one.filters[0].path.as_str(),
            other => panic!("{other:?}"),
        })
        .collect();
    assert_eq!(topics, ["spBv1.0/shop/NCMD/agent", "spBv1.0/STATE/scada"]);
    sending.take(&says(false, 1), &values, BIRTH, NOW).unwrap();
    assert!(sending.output().is_empty());
    sending.take(&says(true, 2), &values, BIRTH, NOW).unwrap();
    let (words, ids) = sent(&mut sending);
    assert_eq!(
        words,
        [
            "NBIRTH/agent 0",
            "DBIRTH/agent/lathe 1 line 1",
            "DDATA/agent/lathe 2",
            "DDATA/agent/lathe 3 line 1"
        ]
    );
    sending
        .take(&acknowledge(&ids), &values, BIRTH, NOW)
        .unwrap();
    assert!(sending.is_done());
    keep(&store, &mut values, BIRTH.0, [state(2)]);
    // The will of a connection before this one says nothing.
    sending.take(&says(false, 1), &values, BIRTH, NOW).unwrap();
    let (words, _) = sent(&mut sending);
    assert_eq!(words, ["DDATA/agent/lathe 4 line 2"]);
    keep(&store, &mut values, BIRTH.0, [state(3)]);
    let gone = sending.take(&says(false, 3), &values, BIRTH, NOW);
    assert!(matches!(gone, Err(Trouble::Host)), "{gone:?}");
    assert!(sending.output().is_empty());
    // Neither of the two was acknowledged.
    assert_eq!(store.figures().unwrap().records, 2);
}
