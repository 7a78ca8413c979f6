//! Pages wear: what has been erased is counted, is told, and is warned of in time; and what wears them is no more than it
//! has to be.

use core::cell::Cell;
use leadscrew_board_sim::plant::{Flash, FlashError, PlantOptions, Tear};

use embedded_storage::nor_flash::{ErrorType, NorFlash, ReadNorFlash};
use leadscrew_board_sim::{Sim, count_start};
use leadscrew_core::alarm::{Arg, Code};
use leadscrew_core::board::{Event, Found, GUARANTEED_ERASES, Mark, Region, WORN};
use leadscrew_core::bus::{Object, SdoProtocol};
use leadscrew_core::journal::TapRecord;
use leadscrew_core::link::EventReader;
use leadscrew_core::params::{Entry, Params};
use leadscrew_store::{BUFFER, Store, StoreError};
use leadscrew_tests::gateway::Gateway;
use leadscrew_tests::machine::calls;
use leadscrew_tests::params::with;

use super::cuts::{Bench, first};
use super::flash::{PAGES, entry, in_force, note, noted, offsets_in_force, power_up};

/// Bytes that an entry of the tap journal takes in the flash.
const ENTRY: u32 = 88;

/// Erases of all pages, by the board's own count.
fn counted(flash: &mut Flash) -> u32 {
    let mut buffer = [0; BUFFER];
    let mut store = Store::new(flash).expect("a store");
    let held = store.read(Region::Erases, &mut buffer).expect("readable");
    held.map_or(0, |bytes| Mark::decode(bytes).expect("a count").0)
}

/// A board whose pages have been erased so often.
fn worn(pages: usize, erases: u32) -> Flash {
    let mut flash = Flash::with_pages(pages);
    let mut store = Store::new(&mut flash).expect("a store");
    let bytes = Mark(erases).encode();
    store.write(Region::Erases, &bytes).expect("written");
    flash
}

/// The warnings of worn pages that a board has told, with their figures.
fn warnings(sim: &mut Sim, gateway: &mut Gateway) -> Vec<[Arg; 2]> {
    let log = gateway.read(sim, Object::new(0x5040, 3), SdoProtocol::Block);
    let log = log.expect("a log");
    let events = EventReader::new(&log).map(|entry| entry.expect("an entry").event);
    let worn = events.filter_map(|event| match event {
        Event::Warning(alarm) if alarm.code == Code::StorageWorn => {
            Some([alarm.args[0], alarm.args[1]])
        }
        _ => None,
    });
    worn.collect()
}

/// Has a set stored over the bus.
fn store(sim: &mut Sim, gateway: &mut Gateway, number: i64) {
    let object = Object::new(0x2000 + 1221, 2);
    let value =
        with(&[("1221.Z", number * 1000)]).get(Entry::find_text("1221.Z").expect("a work offset"));
    // While the drives are brought up with the set before, it is refused.
    while gateway
        .write(sim, object, &value.to_le_bytes(), SdoProtocol::Segmented)
        .is_err()
    {
        sim.step();
    }
    while gateway.number(sim, 0x5010, 2) != Ok(2) {
        sim.step();
    }
}

fn told(sim: &mut Sim, gateway: &mut Gateway) -> u32 {
    let number = gateway.number(sim, 0x5044, 0).expect("a number");
    u32::try_from(number).expect("of 32 bits")
}

#[test]
fn every_erase_is_counted_and_the_count_outlives_the_power() {
    let mut flash = Flash::erased();
    // A board that has sets, tables and a start, as each has.
    count_start(&mut flash);
    let mut entries = 0;
    for number in 1..=2 {
        let mut bench = Bench::new(&mut flash);
        bench.ask(number);
        (_, entries) = bench.store(&mut flash, entries);
        let mut bench = Bench::new(&mut flash);
        bench.ask_offsets(number);
        (_, entries) = bench.store(&mut flash, entries);
    }
    let begin = flash.written();
    let mut turn = Vec::new();
    while flash.erases() < 2 * Flash::PAGES as u32 {
        let before = (flash.erases(), flash.written());
        entries += 1;
        note(&mut flash, entries).expect("written");
        let erased = flash.erases() - before.0;
        assert_eq!(counted(&mut flash), flash.erases());
        // Where nothing is erased nothing is written but the entry, and the marks of the pages before and after it.
        assert!(erased > 0 || flash.written() - before.1 <= ENTRY + 16);
        if erased > 0 {
            turn.push(entries);
            let pages = flash.erases().div_ceil(Flash::PAGES as u32);
            assert_eq!(power_up(&mut flash).erases, pages);
        }
    }
    // What docs/hardware.md reckons with.
    let turn = turn[2 * Flash::PAGES - 1] - turn[Flash::PAGES - 1];
    println!("{turn} entries for a turn, {} bytes a set", Region::LONGEST);
    assert!((1_300..1_400).contains(&turn), "{turn} entries for a turn");
    assert!(flash.written() - begin > 2 * Flash::SIZE as u32);
    assert_eq!(in_force(&mut flash), Some(2));
    assert_eq!(offsets_in_force(&mut flash), 2);
}

#[test]
fn a_cut_at_any_byte_loses_one_erase_at_most() {
    let stride = leadscrew_seed::amount(37, 19);
    let (mut cuts, mut lost) = (0, 0);
    for (place, tear) in Tear::ALL.into_iter().enumerate() {
        let mut flash = Flash::with_pages(PAGES);
        flash.set_tear(tear);
        for sequence in 1..=600 {
            let before = flash.clone();
            note(&mut flash, sequence).expect("written");
            if flash.erases() == before.erases() {
                continue;
            }
            let bytes = flash.written() - before.written();
            let last = first(place, stride);
            // The few bytes at the end, where entry and count are, are cut at each.
            let each = bytes.saturating_sub(150)..bytes;
            for cut in (last..bytes).step_by(stride).chain(each) {
                let mut flash = before.clone();
                flash.cut_after(cut);
                let _ = note(&mut flash, sequence);
                power_up(&mut flash);
                let (counted, erased) = (counted(&mut flash), flash.erases());
                assert!(
                    (erased.saturating_sub(1)..=erased).contains(&counted),
                    "{counted} of {erased}, cut at {cut}"
                );
                lost += u32::from(counted < erased);
                cuts += 1;
                assert!((sequence - 1..=sequence).contains(&noted(&mut flash).unwrap_or(0)));
            }
        }
    }
    assert!(lost > 0 && cuts > 1_000, "{lost} of {cuts}");
}

#[test]
fn a_hole_writes_its_beginning_its_reversals_and_its_end() {
    let params = Params::sheets();
    for (text, reversals) in [
        ("G98 G0 X50 Z5\nM29 S1000\nG84 Z-4 R-5 F2000\nG80\nM30\n", 1),
        (
            "G98 G0 X50 Z5\nM29 S1000\nG84 Z-4 R-5 Q1.5 F2000\nG80\nM30\n",
            5,
        ),
        (
            "G98 G0 X50 Z5\nM29 S1000\nG84 Z-8 R-5 Q1 P20 F2000\nG80\nM30\n",
            15,
        ),
    ] {
        let mut flash = Flash::erased();
        // An entry of a hole that is done.
        note(&mut flash, 28).expect("written");
        let sim = Sim::with_flash(&params, &PlantOptions::default(), flash);
        let mut sim = sim.expect("it starts");
        Gateway::connect(&mut sim);
        let before = sim.flash().written();
        let mut waiting = calls(text, &params).into_iter().peekable();
        while waiting.peek().is_some() || sim.is_busy() {
            while waiting.peek().is_some_and(|call| sim.offer(call)) {
                waiting.next();
            }
            sim.step();
            while let Some(event) = sim.event() {
                assert!(!matches!(event, Event::Alarm(_)), "{text}: {event:?}");
            }
        }
        for _ in 0..20 {
            sim.step();
        }
        let mut flash = sim.flash().clone();
        assert_eq!(flash.written() - before, (reversals + 2) * ENTRY, "{text}");
        let mut buffer = [0; BUFFER];
        let mut store = Store::new(&mut flash).expect("a store");
        let held = store
            .read(Region::TapJournal, &mut buffer)
            .expect("readable");
        let entry = TapRecord::decode(held.expect("an entry")).expect("whole");
        assert!(!entry.expect("an entry").in_hole, "{text}");
    }
}

#[test]
fn the_warning_comes_at_eighty_per_cent_and_once() {
    assert_eq!(WORN * 100, GUARANTEED_ERASES * 80);
    let figures = [WORN, GUARANTEED_ERASES].map(|figure| Arg::Int(figure.into()));
    let built_in = Params::sheets();
    let pages = PAGES as u32;
    let power_up = |flash: Flash| {
        let sim = Sim::with_flash(&built_in, &PlantOptions::default(), flash);
        let mut sim = sim.expect("it starts");
        let gateway = Gateway::connect(&mut sim);
        (sim, gateway)
    };
    // Right before, and while it works.
    let (mut sim, mut gateway) = power_up(worn(PAGES, (WORN - 1) * pages));
    assert_eq!(told(&mut sim, &mut gateway), WORN - 1);
    let mut sequence = 0;
    while sim.flash().erases() == 0 {
        assert!(warnings(&mut sim, &mut gateway).is_empty());
        sequence += 1;
        store(&mut sim, &mut gateway, sequence);
    }
    assert_eq!(told(&mut sim, &mut gateway), WORN);
    assert_eq!(warnings(&mut sim, &mut gateway), [figures]);
    while sim.flash().erases() < 3 {
        sequence += 1;
        store(&mut sim, &mut gateway, sequence);
    }
    assert_eq!(warnings(&mut sim, &mut gateway), [figures]);
    // At each power-up from then on.
    let (mut sim, mut gateway) = power_up(sim.flash().clone());
    assert_eq!(warnings(&mut sim, &mut gateway), [figures]);
    // A board of an earlier version has counted nothing.
    let (mut sim, mut gateway) = power_up(Flash::erased());
    assert_eq!(told(&mut sim, &mut gateway), 0);
    assert!(warnings(&mut sim, &mut gateway).is_empty());
}

/// A flash, and the bytes that are read of it.
struct Read<'a>(&'a mut Flash, &'a Cell<usize>);

impl ErrorType for Read<'_> {
    type Error = FlashError;
}

impl ReadNorFlash for Read<'_> {
    const READ_SIZE: usize = Flash::READ_SIZE;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), FlashError> {
        self.1.set(self.1.get() + bytes.len());
        self.0.read(offset, bytes)
    }

    fn capacity(&self) -> usize {
        self.0.capacity()
    }
}

impl NorFlash for Read<'_> {
    const WRITE_SIZE: usize = Flash::WRITE_SIZE;
    const ERASE_SIZE: usize = Flash::ERASE_SIZE;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), FlashError> {
        self.0.erase(from, to)
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), FlashError> {
        self.0.write(offset, bytes)
    }
}

/// While the board stores, its background does nothing else, and its watchdog waits for a quarter of a second at most.
#[test]
fn a_write_looks_at_a_few_pages_however_old_what_it_moves_is() {
    // Where nothing was ever counted, all is looked through once.
    let mut flash = worn(Flash::PAGES, 1);
    for number in 1..=2 {
        let mut bench = Bench::new(&mut flash);
        bench.ask(number);
        bench.store(&mut flash, 0);
        let mut bench = Bench::new(&mut flash);
        bench.ask_offsets(number);
        bench.store(&mut flash, 0);
    }
    let (mut up, mut most, mut rounds) = (0, 0, 0);
    // Two pages of entries, then starts alone until they are the oldest, and the other way round.
    for round in 0..2 {
        for sequence in 1..=100 {
            note(&mut flash, sequence).expect("written");
        }
        let starts = if round == 0 { 5500 } else { 200 };
        for number in 0..starts {
            // Before that the entries are not the oldest.
            if starts - number > 500 {
                count_start(&mut flash);
                continue;
            }
            let before = flash.erases();
            let read = Cell::new(0);
            let mut store = Store::new(Read(&mut flash, &read)).expect("a store");
            store.recover().expect("recovered");
            let mut buffer = [0; BUFFER];
            store
                .read(Region::TapJournal, &mut buffer)
                .expect("readable");
            store.power_up(Params::sheets);
            up = up.max(read.take());
            assert_ne!(store.count_start(), 0);
            most = most.max(read.get());
            rounds += flash.erases() - before;
        }
    }
    let read = Cell::new(0);
    let mut store = Store::new(Read(&mut flash, &read)).expect("a store");
    store.recover().expect("recovered");
    store.power_up(Params::sheets);
    for sequence in 1..=3000 {
        read.set(0);
        let bytes = entry(sequence).encode();
        store.write(Region::TapJournal, &bytes).expect("written");
        most = most.max(read.get());
    }
    println!("{up} bytes at power-up, {most} for a write, {rounds} pages");
    assert!(most < 8 * Flash::PAGE, "{most} bytes for a write");
    assert!(
        up < (Region::ALL.len() + 2) * Flash::SIZE,
        "{up} bytes at power-up"
    );
}

/// Copies eight pages from one place to another, in a flash that is erased. A torn word that cannot be read stays one that
/// nobody takes for a value.
fn copied(from: (&mut Flash, usize), (mut to, at): (Flash, usize)) -> Flash {
    for offset in (0..PAGES * Flash::PAGE).step_by(Flash::WORD) {
        let mut word = [0; Flash::WORD];
        if from.0.read((from.1 + offset) as u32, &mut word).is_err() {
            word = [0; Flash::WORD];
        }
        if word != [0xFF; Flash::WORD] {
            to.write((at + offset) as u32, &word).expect("written");
        }
    }
    to
}

/// Where the last eight pages begin.
const LAST: usize = Flash::SIZE - PAGES * Flash::PAGE;

/// The flash of a board that is flashed anew, whose storage was the last eight pages.
fn flashed_over(small: &mut Flash) -> Flash {
    copied((small, 0), (Flash::erased(), LAST))
}

/// The last eight pages, for the image that has no more.
fn flashed_back(flash: &mut Flash) -> Flash {
    copied((flash, LAST), (Flash::with_pages(PAGES), 0))
}

/// Starts such a board again and again, and pushes a set: it has what the old image has, or it tells the damage and keeps
/// its hands off, and the old image finds everything. True where it has it.
fn has_all_or_tells(mut flash: Flash, old: (Option<u32>, Option<u32>)) -> bool {
    let mut untouched = None;
    for _ in 0..4 {
        let mut store = Store::new(&mut flash).expect("a store");
        match store.recover() {
            Ok(()) => {
                assert_eq!((in_force(&mut flash), noted(&mut flash)), old);
                return true;
            }
            Err(error) => assert_eq!(error, StoreError::Damaged),
        }
        assert_eq!(store.power_up(Params::sheets).found, Found::Lost);
        assert_eq!(store.count_start(), 0);
        let pushed = store.write(Region::ParametersA, &[7; 64]);
        assert_eq!(pushed, Err(StoreError::Damaged));
        // The first start may end an erase that was cut.
        let changes = (flash.written(), flash.erases());
        assert_eq!(*untouched.get_or_insert(changes), changes);
        let found = leadscrew_board_sim::stored_tap(&mut flash).expect_err("an alarm");
        assert_eq!(found.code, Code::TapJournalDamaged);
    }
    let mut small = flashed_back(&mut flash);
    power_up(&mut small);
    assert_eq!((in_force(&mut small), noted(&mut small)), old);
    false
}

#[test]
fn pages_that_were_a_ring_of_fewer_are_read_whole_or_not_at_all() {
    let mut small = Flash::with_pages(PAGES);
    let mut bench = Bench::new(&mut small);
    bench.ask(1);
    bench.store(&mut small, 0);
    let (mut whole, mut told) = (0, 0);
    let mut judge = |image: Flash, old| {
        let has_all = has_all_or_tells(image, old);
        whole += u32::from(has_all);
        told += u32::from(!has_all);
    };
    let stride = leadscrew_seed::amount(97, 19);
    for sequence in 3..=700_u32 {
        let before = small.clone();
        note(&mut small, sequence).expect("written");
        let bytes = small.written() - before.written();
        // The page in use was full.
        let turned = bytes > ENTRY;
        if turned || sequence.is_multiple_of(19) {
            let old = (in_force(&mut small), noted(&mut small));
            judge(flashed_over(&mut small), old);
        }
        if !turned {
            continue;
        }
        // The old board was halted anywhere in it: also at each word of the marks with which it begins.
        let marks = (0..6 * Flash::WORD as u32).step_by(Flash::WORD / 2);
        let anywhere = (first(sequence as usize, stride)..bytes).step_by(stride);
        for cut in marks.chain(anywhere) {
            let mut halted = before.clone();
            halted.set_tear(Tear::ALL[(sequence + cut) as usize % Tear::ALL.len()]);
            halted.cut_after(cut);
            let _ = note(&mut halted, sequence);
            halted.power(true);
            let image = flashed_over(&mut halted);
            // What the old image would find.
            power_up(&mut halted);
            let old = (in_force(&mut halted), noted(&mut halted));
            judge(image, old);
        }
    }
    assert!(whole > 20 && told > 20, "{whole} whole, {told} told");
}
