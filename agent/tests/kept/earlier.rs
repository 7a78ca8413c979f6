//! Records of earlier versions: what they kept is read, and nothing of it is lost.

use leadscrew_agent::record::{Cut, Figure, Measured, Start};
use leadscrew_agent::{Body, Memory, Record, StoreError};
use redb::{Database, TableDefinition};

use crate::disk::Disk;

/// The certificate of a thread as version 0.1.0 kept it, before cuts were read.
const THREAD: &str = r#"{"at":1764150000123,"body":{"Thread":{"start":{"serial":41003,"count":12},"number":345,"program":7,"line":12,"kind":"thread","end":"finished","passes":6,"late":0,"errors":{"measured":4200,"largest_nm":-812,"squares":1234567}}}}"#;

fn thread() -> Record {
    serde_json::from_str(THREAD).unwrap()
}

#[test]
fn a_certificate_that_was_kept_before_cuts_were_read_is_read() {
    let record = thread();
    let Body::Thread(told) = &record.body else {
        panic!("{record:?}");
    };
    assert_eq!(told.start.key(told.number), "0000a02b/12/345");
    assert_eq!((told.errors.largest_nm, told.passes), (-812, 6));
    assert_eq!((&told.cut, told.cut.known()), (&Cut::NotRead, "not_read"));
}

#[test]
fn a_certificate_with_its_cut_stays_small() {
    let mut record = thread();
    let Body::Thread(told) = &mut record.body else {
        panic!("{record:?}");
    };
    let most = Figure(-2_147_483_648, 4_294_967_295);
    told.cut = Cut::Measured(Measured {
        axis: 'Z',
        age_known: false,
        positions: u16::MAX,
        passes: u8::MAX,
        lead_nm: 4_294_967_295,
        grooves: Some([most; 2]),
        apart: Some(most),
        slope: Some(most),
        worst: most,
        complete: false,
        why: "groove known of 2 passes of 3 alone".to_owned(),
    });
    let text = serde_json::to_string(&record).unwrap();
    assert!(text.len() < 800, "{} bytes: {text}", text.len());
    assert_eq!(serde_json::from_str::<Record>(&text).unwrap(), record);
}

/// What version 0.1.0 remembered, and the figures of its store.
const MEMORY: &str = r#"{"start":{"serial":41003,"count":12},"power_up":1764149000000,"tick":500,"at":1764150000123,"tick_us":1000,"last_event":20,"event_tick":200,"thread":345,"run":null,"ended":null,"identity":null,"alive":true,"state":null}"#;
const FIGURES: &str = r#"{"made":1764100000000,"newest":9,"records":1,"bytes":250,"lost":0,"connections":3,"loss":null}"#;

/// A store as version 0.1.0 left it: one certificate that no broker had.
fn left() -> Disk {
    const HEAD: TableDefinition<'_, &str, &[u8]> = TableDefinition::new("head");
    const CERTIFICATES: TableDefinition<'_, u64, &[u8]> = TableDefinition::new("certificates");
    let disk = Disk::default();
    let database = Database::builder()
        .create_with_backend(disk.clone())
        .unwrap();
    let writing = database.begin_write().unwrap();
    {
        let mut head = writing.open_table(HEAD).unwrap();
        head.insert("memory", MEMORY.as_bytes()).unwrap();
        head.insert("figures", FIGURES.as_bytes()).unwrap();
        let mut certificates = writing.open_table(CERTIFICATES).unwrap();
        certificates.insert(9, THREAD.as_bytes()).unwrap();
    }
    writing.commit().unwrap();
    drop(database);
    disk
}

#[test]
fn a_store_of_one_machine_is_that_of_the_one_that_is_named_first() {
    let disk = left();
    let store = disk.store(1 << 20).unwrap();
    store.adopt(&["lathe"]).unwrap();
    let memory = store.memory("lathe").unwrap();
    let start = Start {
        serial: 41_003,
        count: 12,
    };
    assert_eq!((memory.start, memory.last_thread()), (start, 345));
    drop(store);
    // Its record stays that machine's, whoever comes along.
    let store = disk.store(1 << 20).unwrap();
    store.adopt(&["mill", "lathe"]).unwrap();
    assert_eq!(store.memory("lathe").unwrap(), memory);
    assert_eq!(store.memory("mill").unwrap(), Memory::default());
    let records = store.hand(0, 9).unwrap();
    assert_eq!((records.len(), records[0].number), (1, 9));
    assert_eq!(records[0].record.machine, "lathe");
    assert_eq!(records[0].record.body, thread().body);
    assert_eq!(store.figures().unwrap().newest, 9);
}

#[test]
fn a_store_of_one_machine_is_not_guessed_to_be_one_of_several() {
    let disk = left();
    let store = disk.store(1 << 20).unwrap();
    let refused = store.adopt(&["mill", "lathe"]);
    assert!(matches!(refused, Err(StoreError::Nameless)), "{refused:?}");
    assert_eq!(store.hand(0, 9).unwrap().len(), 1, "nothing has gone");
    store.adopt(&["mill"]).unwrap();
}

#[test]
fn machines_of_one_store_share_its_numbers_and_not_their_memory() {
    let store = Disk::default().store(1 << 20).unwrap();
    store.adopt(&["a", "b"]).unwrap();
    let of = |machine: &str| Record {
        machine: machine.to_owned(),
        ..thread()
    };
    let memory: Memory = serde_json::from_str(MEMORY).unwrap();
    let one = store.keep("a", &[of("a")], &memory).unwrap();
    let two = store.keep("b", &[of("b")], &Memory::default()).unwrap();
    assert_eq!((one[0].number, two[0].number), (1, 2));
    assert_eq!(store.memory("a").unwrap(), memory);
    assert_eq!(store.memory("b").unwrap(), Memory::default());
}
