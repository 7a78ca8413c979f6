//! Power that goes at any byte of a change of parameters, with entries of the tap journal in between: the old set or the
//! new one, the old entry or the new one, and never anything to say about it. Each commit tries other bytes.

use core::time::Duration;

use leadscrew_board_sim::plant::{Flash, Tear};
use leadscrew_core::board::device::CommitState;
use leadscrew_core::board::device::objects::{COMMIT_OFFSETS, STAGED_OFFSETS};
use leadscrew_core::board::{Board, Region};
use leadscrew_core::bus::{Object, SdoDownload, SdoProtocol};
use leadscrew_core::offsets::image::sum;
use leadscrew_core::params::Entry;
use leadscrew_store::{BUFFER, Store};
use leadscrew_tests::gateway::NODE;
use leadscrew_tests::random::Random;

use super::flash::{COUNT, PAGES, in_force, note, noted, offsets_in_force, power_up, set, table};

/// Changes until every page has been erased more than once.
const CHANGES: u32 = 14;

/// A board without a machine around it, which stands.
pub struct Bench {
    board: Board,
}

impl Bench {
    pub fn new(flash: &mut Flash) -> Self {
        let up = power_up(flash);
        let mut board = Board::power_up(&up, None, None).expect("a set that works");
        board.join(NODE).expect("there is room on the bus");
        Self { board }
    }

    /// Asks for a set over the bus. It is not stored by that.
    pub fn ask(&mut self, number: u32) {
        let offset = Entry::find_text("1221.Z").expect("a work offset");
        let data = set(number).get(offset).to_le_bytes();
        self.write(Object::new(0x2000 + 1221, 2), &data);
    }

    /// Asks for a table of offsets over the bus.
    pub fn ask_offsets(&mut self, revision: u32) {
        let image = table(revision).encode().expect("within its ranges");
        self.write(STAGED_OFFSETS, &image);
        self.write(COMMIT_OFFSETS, &sum(&image).to_le_bytes());
    }

    fn write(&mut self, object: Object, data: &[u8]) {
        let (now, patience) = (Duration::ZERO, Duration::from_secs(1));
        let protocol = SdoProtocol::Segmented;
        let mut transfer = SdoDownload::new(NODE, object, data, protocol, patience, now);
        while transfer.outcome().is_none() {
            while let Some(frame) = transfer.poll(now) {
                assert!(!self.board.receive(&frame), "for the board");
            }
            self.board.serve();
            while let Some(frame) = self.board.transmit() {
                transfer.receive(&frame, now);
            }
        }
        assert_eq!(transfer.outcome(), Some(Ok(())));
    }

    /// Carries out what the board asks to store, with an entry of the journal after each write. Returns true if everything
    /// is stored, and the number of the newest entry that may be there.
    pub fn store(&mut self, flash: &mut Flash, mut sequence: u32) -> (bool, u32) {
        let mut whole = true;
        while let Some(request) = self.board.store() {
            let region = request.region;
            let written = Store::new(&mut *flash).and_then(|mut store| store.keep(&request));
            whole &= written.is_ok();
            self.board.stored(region, written);
            sequence += 1;
            if note(flash, sequence).is_err() {
                return (false, sequence);
            }
        }
        (whole, sequence)
    }
}

/// A change to this set, from power-up on. As [`Bench::store`].
fn change(flash: &mut Flash, number: u32, sequence: u32) -> (bool, u32) {
    let mut bench = Bench::new(flash);
    bench.ask(number);
    bench.store(flash, sequence)
}

/// What a cut of the change to set `number` may leave; the newest entry of the journal comes back.
fn after_cut(flash: &mut Flash, number: u32, entries: core::ops::RangeInclusive<u32>) -> u32 {
    let old = number.checked_sub(1).filter(|old| *old > 0);
    let found = in_force(flash);
    assert!(
        found == old || found == Some(number),
        "{found:?} after the power went while {number} was stored"
    );
    let newest = noted(flash).unwrap_or(0);
    assert!(entries.contains(&newest), "{newest} of {entries:?}");
    newest
}

/// What a change begins with, and the bytes it writes and erases.
pub struct Step {
    pub before: Flash,
    pub sequence: u32,
    pub bytes: u32,
}

impl Step {
    /// The flash after the change that `ask` asks for, with the power gone after so many bytes; and the newest entry of
    /// the journal that may be there.
    pub fn cut(&self, at: u32, ask: impl Fn(&mut Bench)) -> (Flash, u32) {
        let mut flash = self.before.clone();
        let mut bench = Bench::new(&mut flash);
        ask(&mut bench);
        flash.cut_after(at);
        let (whole, newest) = bench.store(&mut flash, self.sequence);
        // Behind the last entry a page's erase may be counted.
        assert!(!whole || self.bytes - at <= COUNT, "cut at {at}");
        (flash, newest)
    }
}

fn history(tear: usize) -> Vec<Step> {
    let mut flash = Flash::with_pages(PAGES);
    flash.set_tear(Tear::ALL[tear]);
    let mut sequence = 0;
    let mut history = Vec::new();
    for number in 1..=CHANGES {
        let before = flash.clone();
        let (whole, newest) = change(&mut flash, number, sequence);
        assert!(whole, "set {number}");
        assert_eq!(newest, sequence + 2, "behind the set and behind its mark");
        history.push(Step {
            bytes: flash.written() - before.written(),
            before,
            sequence,
        });
        sequence = newest;
    }
    history
}

/// The first byte at which the power goes.
pub fn first(tear: usize, stride: usize) -> u32 {
    ((leadscrew_seed::fresh() as usize % stride + tear) % stride) as u32
}

#[test]
fn a_cut_at_any_byte_leaves_the_old_set_or_the_new_one() {
    let stride = leadscrew_seed::amount(17, 13);
    let (mut cuts, mut erases, mut new) = (0, 0, 0);
    for tear in 0..Tear::ALL.len() {
        for (step, number) in history(tear).iter().zip(1..) {
            erases += u32::from(step.bytes > Flash::PAGE as u32);
            for cut in (first(tear, stride)..step.bytes).step_by(stride) {
                let (mut flash, newest) = step.cut(cut, |bench| bench.ask(number));
                let newest = after_cut(&mut flash, number, step.sequence..=newest);
                new += u32::from(in_force(&mut flash) == Some(number));
                cuts += 1;
                // Everything works again, now and then: it is the slowest part.
                if cut.is_multiple_of(11) {
                    assert!(change(&mut flash, number + 1, newest).0);
                    assert_eq!(in_force(&mut flash), Some(number + 1));
                }
            }
        }
    }
    assert!(erases >= 20, "{erases}");
    assert!(new > cuts / 40, "{new} of {cuts} behind the set itself");
    assert!(cuts >= 150_000 / stride as u32, "{cuts}");
}

/// Power that goes again and again, also in the repair; sets, tables and entries in no order.
#[test]
fn cuts_upon_cuts_lose_nothing() {
    leadscrew_seed::volume(11, |seed| {
        let mut random = Random(seed);
        let rounds = leadscrew_seed::amount(12, 40);
        let mut cuts = 0;
        for round in 0..rounds {
            let mut flash = Flash::with_pages(PAGES);
            flash.set_tear(Tear::ALL[round % Tear::ALL.len()]);
            let (mut stored, mut tables, mut newest) = (None, 0, 0);
            for _ in 0..100 {
                for _ in 0..random.within(0, 12) {
                    newest += 1;
                    note(&mut flash, newest).expect("written");
                }
                let number = stored.unwrap_or(0) + 1;
                let mut bench = Bench::new(&mut flash);
                let of_offsets = random.chance(40);
                if of_offsets {
                    bench.ask_offsets(tables + 1);
                } else {
                    bench.ask(number);
                }
                if random.chance(60) {
                    flash.cut_after(random.within(0, 5000) as u32);
                }
                let (whole, most) = bench.store(&mut flash, newest);
                if !whole {
                    cuts += 1;
                    flash.power(true);
                    while random.chance(40) {
                        flash.cut_after(random.within(0, 2300) as u32);
                        let mut buffer = [0; BUFFER];
                        let repaired = Store::new(&mut flash).and_then(|mut store| {
                            store.recover()?;
                            store.read(Region::TapJournal, &mut buffer)?;
                            Ok(())
                        });
                        cuts += u32::from(repaired != Ok(()));
                        flash.power(true);
                    }
                }
                flash.power(true);
                let found = in_force(&mut flash);
                let may = [stored, if of_offsets { stored } else { Some(number) }];
                assert!(
                    may.contains(&found),
                    "round {round}: {found:?} where {stored:?} was stored"
                );
                assert!(!whole || found == may[1]);
                stored = found;
                let table = offsets_in_force(&mut flash);
                let may = [tables, tables + u32::from(of_offsets)];
                assert!(may.contains(&table), "round {round}: {table} of {may:?}");
                assert!(!whole || table == may[1]);
                tables = table;
                let entry = noted(&mut flash).unwrap_or(0);
                assert!((newest..=most).contains(&entry));
                newest = entry;
            }
        }
        assert!(cuts > 30 * rounds as u32, "{cuts}");
    });
}

#[test]
fn a_change_that_is_told_as_done_is_there() {
    let mut flash = Flash::with_pages(PAGES);
    let mut bench = Bench::new(&mut flash);
    bench.ask(1);
    assert!(bench.board.device().is_changing());
    assert!(bench.store(&mut flash, 0).0);
    assert!(!bench.board.device().is_changing());
    assert_eq!(bench.board.device().commit_state(), CommitState::Done);
    assert_eq!(in_force(&mut flash), Some(1));
}
