//! The archive: each record is in one file, once, wherever store or folder fail; what waits for it stays.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::io;
use std::rc::Rc;
use std::sync::Arc;

use bytes::Bytes;
use leadscrew_agent::archive::{Archive, ArchiveError, Folder, Origin, Shelf};
use leadscrew_agent::record::{
    Cut, Errors, Figure, Gap, Identity, Loss, Measured, Missing, Presence, Run, Start, State,
    Thread, Trouble, What,
};
use leadscrew_agent::store::Readers;
use leadscrew_agent::{Body, Keeper, Memory, Moment, Record, Store, record};
use leadscrew_seed::amount;
use parquet::file::reader::{FileReader as _, SerializedFileReader};
use parquet::record::{Field, RowAccessor as _};

use crate::disk::Disk;
use crate::machine::{Board, Broker, Random, read, send};

const BOTH: Readers = Readers {
    broker: true,
    archive: true,
};
const ALONE: Readers = Readers {
    broker: false,
    archive: true,
};
const HOUR: u64 = 3_600_000;

#[derive(Debug, Default)]
struct Files {
    all: BTreeMap<String, Vec<u8>>,
    /// Operations until it fails; `None`: it does not.
    left: Option<u64>,
    done: u64,
}

/// A folder that fails at a chosen operation, before it or behind it. Its copies are the same one.
#[derive(Clone, Debug, Default)]
struct Place(Rc<RefCell<Files>>);

impl Place {
    fn fail_behind(&self, operations: Option<u64>) {
        self.0.borrow_mut().left = operations;
    }

    fn step(&self) -> io::Result<()> {
        let mut files = self.0.borrow_mut();
        files.done += 1;
        match &mut files.left {
            Some(0) => Err(io::ErrorKind::StorageFull.into()),
            Some(left) => {
                *left -= 1;
                Ok(())
            }
            None => Ok(()),
        }
    }

    /// The rows of all files by their store and number, with the path of each.
    fn rows(&self) -> BTreeMap<i64, (String, BTreeMap<String, Field>)> {
        let mut rows = BTreeMap::new();
        for (path, bytes) in &self.0.borrow().all {
            for (number, row) in rows_of(bytes) {
                let before = rows.insert(number, (path.clone(), row));
                assert!(before.is_none(), "number {number} is twice: {path}");
            }
        }
        rows
    }
}

fn rows_of(bytes: &[u8]) -> Vec<(i64, BTreeMap<String, Field>)> {
    let reader = SerializedFileReader::new(Bytes::copy_from_slice(bytes)).unwrap();
    let rows = reader.get_row_iter(None).unwrap().map(|row| {
        let row = row.unwrap();
        let cells = row.get_column_iter();
        let cells = cells.map(|(name, field)| (name.clone(), field.clone()));
        (row.get_long(5).unwrap(), cells.collect())
    });
    rows.collect()
}

impl Shelf for Place {
    fn has(&self, path: &str) -> io::Result<bool> {
        self.step()?;
        Ok(self.0.borrow().all.contains_key(path))
    }

    fn put(&self, path: &str, bytes: &[u8]) -> io::Result<()> {
        self.step()?;
        let mut files = self.0.borrow_mut();
        let before = files.all.insert(path.to_owned(), bytes.to_vec());
        assert!(before.is_none(), "{path} is written over");
        drop(files);
        // A kill between the file's name and what follows.
        self.step()
    }
}

fn archive(place: &Place) -> Archive<Place> {
    let origin = Origin {
        shop: "shop".to_owned(),
        node: "desk".to_owned(),
    };
    Archive::new(origin, place.clone())
}

fn keep(store: &Store, at: u64, bodies: impl IntoIterator<Item = Body>) {
    let record = |body| Record {
        at: Moment(at),
        machine: "lathe".to_owned(),
        body,
    };
    let records: Vec<Record> = bodies.into_iter().map(record).collect();
    store.keep("lathe", &records, &Memory::default()).unwrap();
}

fn state(line: u32) -> Body {
    Body::State(State {
        line,
        rpm: -500,
        ..State::default()
    })
}

/// From a start of the agent to its end, or until something fails.
fn live(
    disk: &Disk,
    place: &Place,
    board: &mut Board,
    broker: &mut Broker,
    threads: u32,
) -> Result<(), ArchiveError> {
    let store = Arc::new(disk.store(1 << 20)?);
    store.serve(BOTH);
    store.connect()?;
    let mut keeper = Keeper::new(Arc::clone(&store), "lathe")?;
    let archive = archive(place);
    let (mut sent, begun) = (0, Moment(1_000_000));
    read(&mut keeper, *board)?;
    while board.threads < threads {
        board.cut();
        read(&mut keeper, *board)?;
        if board.threads.is_multiple_of(2) {
            send(&store, broker, &mut sent)?;
        }
        if board.threads.is_multiple_of(3) {
            archive.attend(&store, Moment(begun.0 + HOUR), false)?;
        }
    }
    archive.attend(&store, begun, true)?;
    while send(&store, broker, &mut sent)? {}
    Ok(())
}

/// The same until all is told; store and folder fail behind these numbers of operations. Gives how many there were.
fn lives(failures: &[[Option<u64>; 2]], chance: &mut Random, threads: u32) -> [u64; 2] {
    let (disk, place) = (Disk::default(), Place::default());
    let (mut board, mut broker) = (Board::default(), Broker::default());
    for [of_disk, of_place] in failures {
        if let Some(operations) = of_disk {
            disk.fail_behind(*operations);
        }
        place.fail_behind(*of_place);
        // What fails at its end has told all.
        let _ = live(&disk, &place, &mut board, &mut broker, threads);
        disk.come_back(|| chance.below(2) == 0);
        if board.threads == 0 && disk.store(1 << 20).is_err() {
            disk.clear();
        }
    }
    place.fail_behind(None);
    live(&disk, &place, &mut board, &mut broker, threads).unwrap();
    broker.check(board);
    let rows = place.rows();
    let numbers: Vec<i64> = rows.keys().copied().collect();
    let newest = *numbers.last().unwrap();
    assert_eq!(numbers, (1..=newest).collect::<Vec<i64>>(), "{failures:?}");
    let keys = rows.values().filter_map(|(_, row)| row.get("thread_key"));
    assert_eq!(keys.count(), threads as usize);
    let store = disk.store(1 << 20).unwrap();
    assert_eq!(store.figures().unwrap().records, 0, "all have all");
    let done = place.0.borrow().done;
    [disk.operations(), done]
}

#[test]
fn each_record_is_in_one_file_wherever_store_or_folder_fail() {
    leadscrew_seed::only_fresh(|seed| {
        let mut chance = Random(seed);
        let threads = amount(6, 8);
        let [of_disk, of_place] = lives(&[], &mut chance, threads);
        assert!(of_disk > 100 && of_place > 8, "{of_disk} {of_place}");
        for operation in 0..of_place {
            lives(&[[None, Some(operation)]], &mut chance, threads);
        }
        let step = amount(5, 2);
        for operation in (0..of_disk).step_by(step) {
            lives(&[[Some(operation), None]], &mut chance, threads);
        }
        for _ in 0..amount(30, 120) {
            let failures: Vec<[Option<u64>; 2]> = (0..4)
                .map(|_| [Some(chance.below(of_disk)), Some(chance.below(of_place))])
                .collect();
            lives(&failures, &mut chance, threads);
        }
    });
}

#[test]
fn a_file_is_written_when_the_hour_is_over_or_much_waits() {
    let (disk, place) = (Disk::default(), Place::default());
    let store = disk.store(64 << 10).unwrap();
    store.serve(ALONE);
    let archive = archive(&place);
    let written = |now: u64| archive.attend(&store, Moment(now), false).unwrap();
    assert_eq!(written(HOUR), 0);
    keep(&store, HOUR, [state(1)]);
    assert_eq!(written(2 * HOUR - 1), 0);
    keep(&store, 2 * HOUR - 1, [state(2)]);
    assert_eq!(written(2 * HOUR), 2);
    assert_eq!(written(9 * HOUR), 0);
    // The clock is set back.
    keep(&store, 8 * HOUR, [state(3)]);
    assert_eq!(written(3 * HOUR), 1);
    // A sixty-fourth of its KiB for each record.
    keep(&store, 3 * HOUR, (0..63).map(state));
    assert_eq!(written(3 * HOUR), 0);
    keep(&store, 3 * HOUR, [state(64)]);
    assert_eq!(written(3 * HOUR), 64);
    assert_eq!(store.figures().unwrap().records, 0);
    assert_eq!(place.rows().len(), 67);
}

#[test]
fn a_file_is_of_one_kind_and_one_day() {
    let (disk, place) = (Disk::default(), Place::default());
    let store = disk.store(1 << 20).unwrap();
    store.serve(ALONE);
    keep(&store, 24 * HOUR - 1, [state(1), presence(true)]);
    keep(&store, 24 * HOUR, [state(2)]);
    archive(&place).attend(&store, Moment(0), true).unwrap();
    let paths: Vec<String> = place.0.borrow().all.keys().cloned().collect();
    assert_eq!(
        paths,
        [
            "record=presence/date=1970-01-01/shop.desk.1.000000000001.parquet",
            "record=state/date=1970-01-01/shop.desk.1.000000000001.parquet",
            "record=state/date=1970-01-02/shop.desk.1.000000000001.parquet",
        ]
    );
}

#[test]
fn what_waits_for_one_stays_for_it_alone() {
    let (disk, place) = (Disk::default(), Place::default());
    let store = disk.store(1 << 20).unwrap();
    store.serve(BOTH);
    keep(&store, 1, (1..=4).map(state));
    store.acknowledge(3).unwrap();
    let handed = store.hand(0, 9).unwrap();
    assert_eq!(handed.len(), 1, "the broker has the others");
    assert_eq!(store.figures().unwrap().records, 4);
    archive(&place).attend(&store, Moment(2), true).unwrap();
    assert_eq!(store.figures().unwrap().records, 1);
    // An agent without an archive keeps nothing for it.
    keep(&store, 1, [state(5)]);
    store.serve(Readers {
        broker: true,
        archive: false,
    });
    store.acknowledge(5).unwrap();
    assert_eq!(store.figures().unwrap().records, 0);
    assert_eq!(place.rows().len(), 4);
}

#[test]
fn a_folder_that_cannot_be_written_costs_states_and_no_certificate() {
    let (disk, place) = (Disk::default(), Place::default());
    let store = disk.store(8 << 10).unwrap();
    store.serve(BOTH);
    let archive = archive(&place);
    place.fail_behind(Some(0));
    let mut threads = 0;
    for turn in 0..60 {
        keep(&store, 1, [state(turn)]);
        if turn % 10 == 0 {
            threads += 1;
            keep(&store, 1, [thread(threads, Cut::Hole)]);
        }
        // The broker has all meanwhile.
        store.acknowledge(store.figures().unwrap().newest).unwrap();
        let wrong = archive.attend(&store, Moment(1), true).unwrap_err();
        assert!(matches!(wrong, ArchiveError::Folder(_)), "{wrong:?}");
    }
    let figures = store.figures().unwrap();
    assert!(figures.lost > 0 && figures.bytes <= 8 << 10, "{figures:?}");
    place.fail_behind(None);
    archive.attend(&store, Moment(1), true).unwrap();
    let rows = place.rows();
    let count = |kind: &str| {
        let of_kind = rows.values().filter(|(path, _)| path.starts_with(kind));
        of_kind.count()
    };
    assert_eq!(count("record=thread"), threads as usize);
    assert_eq!(count("record=loss"), 1);
    assert_eq!(count("record=state") as u64 + figures.lost, 60);
}

fn presence(alive: bool) -> Body {
    Body::Presence(Presence {
        alive,
        why: String::new(),
    })
}

const START: Start = Start {
    serial: 0xA5,
    count: 2,
};
const ERRORS: Errors = Errors {
    measured: 4,
    largest_nm: -2500,
    squares: 4_000_000,
};

fn thread(number: u32, cut: Cut) -> Body {
    Body::Thread(Thread {
        start: START,
        number,
        program: 7,
        line: 3,
        kind: "thread".to_owned(),
        end: "finished".to_owned(),
        passes: 5,
        late: 0,
        errors: ERRORS,
        cut,
    })
}

#[test]
fn every_record_has_its_row() {
    let (disk, place) = (Disk::default(), Place::default());
    let store = disk.store(1 << 20).unwrap();
    store.serve(ALONE);
    let measured = Cut::Measured(Measured {
        axis: 'Z',
        age_known: true,
        positions: 40,
        passes: 3,
        lead_nm: 1_500_000,
        grooves: None,
        apart: None,
        slope: Some(Figure(1200, 300)),
        worst: Figure(-2000, 500),
        complete: true,
        why: String::new(),
    });
    let event = |what| {
        Body::Event(record::Event {
            start: START,
            number: 9,
            tick: 1000,
            what,
        })
    };
    let bodies = [
        thread(1, measured),
        thread(2, Cut::NotRead),
        Body::Run(Run {
            start: START,
            program: 7,
            finished: true,
            ticks: 1000,
            setpoint_hash: Some(u64::MAX),
            late: 0,
            errors: Errors {
                measured: 0,
                ..ERRORS
            },
        }),
        event(What::Alarm(Trouble {
            number: 4300,
            line: 3,
            cause: "急停".to_owned(),
            remedy: "release".to_owned(),
        })),
        event(What::Ready),
        state(5),
        presence(false),
        Body::Identity(Identity {
            start: START,
            parameters: 0x1A,
            firmware: "0.1.0".to_owned(),
        }),
        Body::Gap(Gap {
            start: START,
            of: Missing::Threads,
            first: 3,
            last: 4,
        }),
        Body::Loss(Loss {
            records: 3,
            first: 1,
            last: 5,
        }),
    ];
    let count = bodies.len();
    keep(&store, 1234, bodies);
    archive(&place).attend(&store, Moment(0), true).unwrap();
    let rows = place.rows();
    assert_eq!(rows.len(), count);
    let cell = |number: i64, name: &str| rows[&number].1.get(name).expect(name).to_string();
    for (number, name, value) in [
        (1, "at_utc", "1970-01-01 00:00:01.234 +00:00"),
        (1, "shop", "\"shop\""),
        (1, "node", "\"desk\""),
        (1, "machine", "\"lathe\""),
        (1, "store", "1970-01-01 00:00:00.001 +00:00"),
        (1, "thread_key", "\"000000a5/2/1\""),
        (1, "start", "2"),
        (3, "run_key", "\"000000a5/2/7\""),
        (3, "start", "2"),
        (3, "run_program", "7"),
        (1, "thread_largest_error_um", "-2.5"),
        (1, "thread_rms_error_um", "1.0"),
        (1, "cut_lead_mm", "1.5"),
        (1, "cut_worst_um", "-2.0"),
        (1, "cut_worst_um_u", "0.5"),
        (1, "cut_age_known", "true"),
        (1, "cut_least_groove_um", "null"),
        (2, "cut_known", "\"not_read\""),
        (2, "cut_worst_um", "null"),
        (3, "run_setpoint_hash", "\"ffffffffffffffff\""),
        (3, "run_rms_error_um", "null"),
        (4, "event_cause", "\"急停\""),
        (5, "event_alarm", "null"),
        (6, "spindle_speed_rpm", "-500"),
        (6, "override_feed_percent", "0"),
        (6, "bus_load_percent", "null"),
        (7, "board_alive", "false"),
        (8, "board_parameters", "\"0000001a\""),
        (9, "gap_of", "\"threads\""),
        (10, "loss_records", "3"),
    ] {
        let cell = cell(number, name);
        // A fraction has more than one text.
        let is_same = match (cell.parse::<f64>(), value.parse::<f64>()) {
            (Ok(cell), Ok(value)) => cell == value,
            _ => cell == value,
        };
        assert!(is_same, "{name} of {number} is {cell}, not {value}");
    }
}

#[test]
fn a_folder_of_this_computer_holds_the_files() {
    let path = std::env::temp_dir().join(format!("leadscrew-archive-{}", std::process::id()));
    let _ = std::fs::remove_dir_all(&path);
    let disk = Disk::default();
    let store = disk.store(1 << 20).unwrap();
    store.serve(ALONE);
    keep(&store, 1, [state(1)]);
    let origin = Origin {
        shop: "shop".to_owned(),
        node: "desk".to_owned(),
    };
    let archive = Archive::new(origin, Folder::new(path.clone()));
    assert_eq!(archive.attend(&store, Moment(1), true).unwrap(), 1);
    let file = path.join("record=state/date=1970-01-01/shop.desk.1.000000000001.parquet");
    assert_eq!(rows_of(&std::fs::read(file).unwrap()).len(), 1);
    std::fs::remove_dir_all(&path).unwrap();
}
