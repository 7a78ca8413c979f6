//! The sender over sockets: a broker that cuts connections, with TLS and a password, and refusals on the way.

use std::collections::BTreeMap;
use std::fs::Permissions;
use std::io::{Read, Write};
use std::net::TcpListener;
use std::os::unix::fs::PermissionsExt as _;
use std::path::PathBuf;
use std::sync::mpsc::channel;
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::Duration;

use bytes::BytesMut;
use leadscrew_agent::mqtt::{Identity, Login, Tls, Wire, WireError};
use leadscrew_agent::sender::{Broker, News, Shared, Trouble, send};
use leadscrew_agent::sparkplug::payload::{Payload, Value};
use leadscrew_agent::{Memory, Moment, Record, Store};
use mqttbytes::v4::{ConnAck, ConnectReturnCode, Packet, read};
use prost::Message as _;
use rustls::pki_types::pem::PemObject as _;
use rustls::pki_types::{CertificateDer, PrivateKeyDer};
use rustls::{ServerConfig, ServerConnection, StreamOwned};

use crate::bench::{acknowledge, metric, names, state};

fn file(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("tests/sent/tls")
        .join(name)
}

fn server() -> Arc<ServerConfig> {
    let chain = CertificateDer::pem_file_iter(file("broker.pem")).unwrap();
    let chain: Vec<_> = chain.map(Result::unwrap).collect();
    let key = PrivateKeyDer::from_pem_file(file("broker.key")).unwrap();
    let provider = Arc::new(rustls_graviola::default_provider());
    let config = ServerConfig::builder_with_provider(provider)
        .with_safe_default_protocol_versions()
        .unwrap()
        .with_no_client_auth()
        .with_single_cert(chain, key);
    Arc::new(config.unwrap())
}

/// What a broker has: lines by the number of their record.
type Has = Arc<Mutex<BTreeMap<u64, u32>>>;

/// One connection; over once so many messages have been taken, the last without an answer.
fn serve(mut stream: impl Read + Write, has: &Has, messages: usize) {
    let mut bytes = BytesMut::new();
    let mut room = [0; 4096];
    let mut left = messages;
    loop {
        let Ok(count @ 1..) = stream.read(&mut room) else {
            return;
        };
        bytes.extend_from_slice(&room[..count]);
        while let Ok(packet) = read(&mut bytes, 1 << 20) {
            let mut answer = BytesMut::new();
            match packet {
                Packet::Connect(connect) => {
                    let right = connect.login.is_some_and(|login| login.password == "right");
                    let code = if right {
                        ConnectReturnCode::Success
                    } else {
                        ConnectReturnCode::BadUserNamePassword
                    };
                    ConnAck::new(code, false).write(&mut answer).unwrap();
                }
                Packet::Publish(publish) => {
                    let payload = Payload::decode(&publish.payload[..]).unwrap();
                    let number = metric(&payload, "Record/Number").map(|one| one.value.clone());
                    let line = metric(&payload, "Program/Line").map(|one| one.value.clone());
                    if let (Some(Some(Value::Long(number))), Some(Some(Value::Int(line)))) =
                        (number, line)
                    {
                        has.lock().unwrap().insert(number, line);
                    }
                    left -= 1;
                    if left == 0 {
                        return;
                    }
                    answer.extend_from_slice(&acknowledge(&[publish.pkid]));
                }
                _ => {}
            }
            if stream.write_all(&answer).is_err() {
                return;
            }
        }
    }
}

/// A sender with these credentials until `enough` says so; what came of it.
fn run(
    password: &str,
    authority: &str,
    lines: u32,
    enough: impl Fn(&News, &Store) -> bool,
) -> Vec<News> {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap().port();
    let has = Has::default();
    let (config, taken) = (server(), Arc::clone(&has));
    thread::spawn(move || {
        // Cut behind 5 messages, behind 10, and so on.
        for (number, stream) in listener.incoming().enumerate() {
            let connection = ServerConnection::new(Arc::clone(&config)).unwrap();
            let stream = StreamOwned::new(connection, stream.unwrap());
            serve(stream, &taken, 5 + 5 * number);
        }
    });
    let name = format!("leadscrew-sockets-{port}-{}", std::process::id());
    let path = std::env::temp_dir().join(name);
    let store = Arc::new(Store::open(&path, 1 << 20, Moment(1)).unwrap());
    let records: Vec<Record> = (1..=lines)
        .map(|line| Record {
            at: Moment(1),
            machine: "lathe".to_owned(),
            body: state(line),
        })
        .collect();
    store.keep("lathe", &records, &Memory::default()).unwrap();
    let broker = Broker {
        address: format!("mqtts://localhost:{port}").parse().unwrap(),
        login: Some(Login {
            user: "agent".to_owned(),
            password: password.to_owned(),
        }),
        tls: Some(Tls::of(&file(authority)).unwrap()),
        names: names(),
        primary: None,
    };
    let shared = Arc::new(Shared::default());
    let (tell, news) = channel();
    let sender = {
        let (store, shared) = (Arc::clone(&store), Arc::clone(&shared));
        thread::spawn(move || send(&broker, &store, &shared, |news| drop(tell.send(news))))
    };
    let mut all = Vec::new();
    while let Ok(one) = news.recv() {
        let done = enough(&one, &store);
        all.push(one);
        if done {
            break;
        }
    }
    shared.end();
    sender.join().unwrap();
    all.extend(news.try_iter());
    if lines > 0 {
        let left = store.figures().unwrap().records;
        assert_eq!(left, 0);
        let has = has.lock().unwrap();
        let expected = (1..=lines).map(|line| (u64::from(line), line));
        assert_eq!(*has, expected.collect::<BTreeMap<_, _>>());
    }
    let _ = std::fs::remove_file(&path);
    let _ = std::fs::remove_file(format!("{}.reserve", path.display()));
    all
}

#[test]
fn a_broker_that_cuts_connections_gets_all_by_tls() {
    let cut = |news: &News, _: &Store| matches!(news, News::Trouble(Trouble::Wire(_)));
    // The end of the agent sends the rest.
    let times = std::sync::atomic::AtomicU32::new(0);
    let twice = |news: &News, store: &Store| {
        let cuts = cut(news, store);
        let connected = matches!(news, News::Connected);
        let before = times.fetch_add(u32::from(cuts), std::sync::atomic::Ordering::Relaxed);
        connected && before == 2
    };
    let all = run("right", "authority.pem", 12, twice);
    assert!(
        all.iter()
            .filter(|news| matches!(news, News::Connected))
            .count()
            >= 3
    );
}

#[test]
fn a_wrong_password_and_a_wrong_authority_are_named() {
    let any = |_: &News, _: &Store| true;
    let login = run("wrong", "authority.pem", 0, any);
    assert!(
        matches!(&login[0], News::Trouble(Trouble::Broker(fault)) if fault.to_string().contains("password")),
        "{login:?}"
    );
    let authority = run("right", "another.pem", 0, any);
    assert!(
        matches!(
            &authority[0],
            News::Trouble(Trouble::Wire(WireError::Tls(_)))
        ),
        "{authority:?}"
    );
}

/// A broker that lets nobody in without a certificate: what a client hears that comes as this one.
fn comes_as(identity: Option<&Identity>) -> Result<Vec<u8>, WireError> {
    let mut authorities = rustls::RootCertStore::empty();
    let authority = CertificateDer::from_pem_file(file("authority.pem")).unwrap();
    authorities.add(authority).unwrap();
    let provider = Arc::new(rustls_graviola::default_provider());
    let verifier = rustls::server::WebPkiClientVerifier::builder_with_provider(
        Arc::new(authorities),
        Arc::clone(&provider),
    );
    let chain = vec![CertificateDer::from_pem_file(file("broker.pem")).unwrap()];
    let key = PrivateKeyDer::from_pem_file(file("broker.key")).unwrap();
    let config = ServerConfig::builder_with_provider(provider)
        .with_safe_default_protocol_versions()
        .unwrap()
        .with_client_cert_verifier(verifier.build().unwrap())
        .with_single_cert(chain, key)
        .unwrap();
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap().port();
    let broker = thread::spawn(move || {
        let (stream, _) = listener.accept().unwrap();
        let connection = ServerConnection::new(Arc::new(config)).unwrap();
        let mut stream = StreamOwned::new(connection, stream);
        let mut room = [0; 16];
        if stream.read(&mut room).is_ok() {
            stream.write_all(b"welcome").unwrap();
            stream.flush().unwrap();
            // Until the client goes.
            let _ = stream.read(&mut room);
        }
    });
    let address = format!("mqtts://localhost:{port}").parse().unwrap();
    let tls = Tls::with(&file("authority.pem"), identity)?;
    let mut wire = Wire::open(&address, Some(&tls), Duration::from_millis(20))?;
    wire.write(b"words")?;
    let mut room = [0; 16];
    let heard = loop {
        match wire.read(&mut room) {
            Ok([]) => {}
            Ok(bytes) => break Ok(bytes.to_vec()),
            Err(error) => break Err(error),
        }
    };
    drop(wire);
    broker.join().unwrap();
    heard
}

#[test]
fn a_broker_that_asks_for_a_certificate_gets_it() {
    let refused = comes_as(None);
    assert!(matches!(refused, Err(WireError::Tls(_))), "{refused:?}");
    let path = std::env::temp_dir().join(format!("leadscrew-identity-{}", std::process::id()));
    let write = |names: &[&str], mode: u32| {
        let parts = names
            .iter()
            .map(|name| std::fs::read_to_string(file(name)).unwrap());
        std::fs::write(&path, parts.collect::<String>()).unwrap();
        std::fs::set_permissions(&path, Permissions::from_mode(mode)).unwrap();
        Identity::read(&path)
    };
    let read = write(&["broker.pem", "broker.key"], 0o644);
    assert!(matches!(read, Err(WireError::Open)), "{read:?}");
    let read = write(&["broker.pem"], 0o600);
    assert!(matches!(read, Err(WireError::NoKey)), "{read:?}");
    let read = write(&["broker.key"], 0o600);
    assert!(matches!(read, Err(WireError::NoCertificate)), "{read:?}");
    let mine = write(&["broker.pem", "broker.key"], 0o600).unwrap();
    assert_eq!(comes_as(Some(&mine)).unwrap(), b"welcome");
    // A key of another certificate is refused before anything is sent.
    let other = write(&["another.pem", "broker.key"], 0o600).unwrap();
    let refused = comes_as(Some(&other));
    assert!(matches!(refused, Err(WireError::Tls(_))), "{refused:?}");
    std::fs::remove_file(&path).unwrap();
}

#[test]
fn nobody_at_the_address_is_named() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap().port();
    drop(listener);
    let address = format!("mqtt://127.0.0.1:{port}").parse().unwrap();
    let wire = Wire::open(&address, None, Duration::from_millis(1));
    assert!(matches!(wire, Err(WireError::Socket(_))));
}

/// What a client hears of somebody who takes its first bytes, says this, and goes.
fn heard_of(scheme: &str, says: &'static [u8]) -> WireError {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap().port();
    let other = thread::spawn(move || {
        let (mut stream, _) = listener.accept().unwrap();
        let _ = stream.read(&mut [0; 4096]).unwrap();
        stream.write_all(says).unwrap();
    });
    let address = format!("{scheme}://localhost:{port}").parse().unwrap();
    let tls = (scheme == "mqtts").then(|| Tls::of(&file("authority.pem")).unwrap());
    let mut wire = Wire::open(&address, tls.as_ref(), Duration::from_millis(20)).unwrap();
    let mut room = [0; 16];
    let error = loop {
        let done = wire
            .write(b"words")
            .and_then(|()| wire.read(&mut room).map(drop));
        if let Err(error) = done {
            break error;
        }
    };
    other.join().unwrap();
    error
}

#[test]
fn a_port_of_the_other_kind_is_named() {
    // One with TLS ends what is none, one without ends a handshake; or it answers in its own way.
    let ended = heard_of("mqtt", b"");
    assert!(matches!(ended, WireError::Ended), "{ended:?}");
    let ended = heard_of("mqtts", b"");
    assert!(matches!(ended, WireError::NoTls), "{ended:?}");
    let plain = heard_of("mqtts", &[0x20, 2, 0, 0]);
    assert!(matches!(plain, WireError::NoTls), "{plain:?}");
    // Who has spoken before is no port of the other kind.
    // Whether its end is heard when reading or when writing hangs on how far the client has come by then.
    let cut = heard_of("mqtt", &[0x20, 2, 0, 0]);
    let is_cut = matches!(cut, WireError::Socket(_) | WireError::Ended);
    assert!(is_cut, "{cut:?}");
}

#[test]
fn a_handshake_may_take_longer_than_a_glance() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap().port();
    let (tell, told) = channel();
    let broker = thread::spawn(move || {
        let (stream, _) = listener.accept().unwrap();
        // The client has looked for an answer in vain by then.
        told.recv().unwrap();
        let connection = ServerConnection::new(server()).unwrap();
        let mut room = [0; 16];
        let mut stream = StreamOwned::new(connection, stream);
        let count = stream.read(&mut room).unwrap();
        room[..count].to_vec()
    });
    let address = format!("mqtts://localhost:{port}").parse().unwrap();
    let tls = Tls::of(&file("authority.pem")).unwrap();
    let mut wire = Wire::open(&address, Some(&tls), Duration::from_millis(1)).unwrap();
    thread::spawn(move || {
        thread::sleep(Duration::from_millis(100));
        tell.send(()).unwrap();
    });
    wire.write(b"words").unwrap();
    assert_eq!(broker.join().unwrap(), b"words");
}
