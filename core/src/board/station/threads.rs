//! The threads and holes that were cut last, one by one: behind the certificate of the run in object 5041h [D169].
//!
//! A thread is one call of a threading cycle with all its passes and starts, or one hole. It begins with the first error
//! that is measured in it. Whether all of it was cut is told by what comes next: a segment behind its last stroke, another
//! thread, or the end of the program; where an alarm or a reset comes before, it was cut short.

use heapless::Vec;

use crate::board::event::Event;
use crate::board::reference::Measured;
use crate::board::snapshot::Snapshot;
use crate::board::ticker::State;
use crate::link::{
    BATCH_BYTES, Certificate, LinkError, Tally, ThreadCertificate, ThreadKind, ThreadRecord,
    ThreadState, encode_certificates,
};

/// So many are kept; the newest may be under way.
const KEPT: usize = 8;

const _: () = assert!(
    Certificate::BYTES + KEPT * ThreadCertificate::BYTES <= BATCH_BYTES,
    "all of them, and that of the run, have room in one reading"
);

/// The last threads.
// What is large last, as everywhere on this way.
#[cfg_attr(feature = "small", repr(C))]
#[derive(Debug)]
pub struct Threads {
    /// The cut of the newest.
    cut: u8,
    /// An axis was held to the spindle when it was last asked.
    in_stroke: bool,
    /// The stroke begun last is the last one of its thread.
    last: bool,
    /// Number of the last move in which an axis was held to the spindle.
    number: u32,
    /// Setpoints that had come late before the newest.
    late_before: u32,
    /// Number of the newest, from 1 since power-up.
    newest: u32,
    /// Whoever reads them knows all up to this number; `None`: nobody has read any.
    read: Option<u32>,
    /// The newest first.
    records: Vec<ThreadRecord, KEPT>,
}

impl Threads {
    // [D146]
    #[inline(always)]
    pub const fn new() -> Self {
        Self {
            cut: 0,
            in_stroke: false,
            last: false,
            number: 0,
            late_before: 0,
            newest: 0,
            read: None,
            records: Vec::new(),
        }
    }

    /// Somebody has read all that there is; what is under way will have to be read again.
    pub fn are_read(&mut self) {
        let newest = self.records.first();
        let under_way = newest.is_some_and(|newest| newest.state == ThreadState::UnderWay);
        self.read = Some(self.newest.saturating_sub(under_way.into()));
    }

    /// Another program comes: who has read those of the last one need not read those of this.
    pub const fn await_reader(&mut self) {
        self.read = None;
    }

    /// The next one takes the place of one that somebody who has read those before has not read.
    pub const fn is_unread(&self) -> bool {
        match self.read {
            Some(read) => self.newest.saturating_sub(read) >= KEPT as u32,
            None => false,
        }
    }

    /// The newest ends like this, if that is not known yet.
    fn end(&mut self, state: ThreadState) {
        if let Some(newest) = self.records.first_mut()
            && newest.state == ThreadState::UnderWay
        {
            newest.state = state;
        }
    }

    /// Takes an error that was measured.
    pub fn measure(&mut self, measured: &Measured, late: u32) {
        if self.records.is_empty() || self.cut != measured.cut.number {
            // The program has gone on.
            self.end(ThreadState::Finished);
            self.records.truncate(KEPT.saturating_sub(1));
            let record = ThreadRecord {
                line: measured.line,
                kind: measured.kind,
                state: ThreadState::UnderWay,
                tally: Tally::NONE,
            };
            // There is room now.
            let _ = self.records.insert(0, record);
            self.newest = self.newest.saturating_add(1);
            self.cut = measured.cut.number;
            self.in_stroke = false;
            self.late_before = late;
        }
        self.last = measured.cut.last;
        let Some(newest) = self.records.first_mut() else {
            return;
        };
        let tally = &mut newest.tally;
        if !self.in_stroke {
            self.in_stroke = true;
            // Feed hold may have left the last stroke, which is then done again.
            newest.state = ThreadState::UnderWay;
            // A hole is one, however often the tap turns round in it.
            if newest.kind == ThreadKind::Thread || tally.passes == 0 {
                tally.passes = tally.passes.saturating_add(1);
            }
        }
        let late = late.saturating_sub(self.late_before);
        tally.late = u16::try_from(late).unwrap_or(u16::MAX);
        tally.take(measured.error);
    }

    /// No axis is held to the spindle.
    pub const fn leave_stroke(&mut self) {
        self.in_stroke = false;
    }

    /// Takes how the machine is: behind its last stroke a thread is done as soon as the program goes on, and one in which the
    /// machine stands on an alarm is not, unless it is one of another block.
    pub fn go_on(&mut self, now: &Snapshot) {
        let setpoint = &now.setpoint;
        if setpoint.locked {
            self.number = setpoint.number;
            return;
        }
        let Some(newest) = self.records.first() else {
            return;
        };
        let state = if let State::Alarm(alarm) = &now.state {
            let line = alarm.span.line;
            if self.last && line != 0 && line != newest.line {
                ThreadState::Finished
            } else {
                ThreadState::CutShort
            }
        } else {
            // A hole is left with its last stroke, whatever comes; a thread, where feed hold retracts, in the middle of one.
            let left = setpoint.number == 0
                && newest.kind != ThreadKind::Thread
                && now.in_program
                && now.takes_calls();
            if !self.last || !left && setpoint.number <= self.number {
                return;
            }
            ThreadState::Finished
        };
        self.end(state);
    }

    /// Takes what has happened: at the end of a program all of it was cut, and behind a reset no more of it is. Its last error
    /// may still come.
    pub fn note(&mut self, event: &Event) {
        match event {
            Event::Finished => self.end(ThreadState::Finished),
            Event::Reset => self.end(ThreadState::CutShort),
            _ => {}
        }
    }

    /// All that are kept, the newest first.
    pub fn certificates(&self) -> impl Iterator<Item = ThreadCertificate> {
        let numbers = (1..=self.newest).rev();
        let with_number = |(number, record): (u32, &ThreadRecord)| ThreadCertificate {
            number,
            record: *record,
        };
        numbers.zip(&self.records).map(with_number)
    }

    /// Puts them behind the certificate of `run`, as [`encode_certificates`] does.
    pub fn encode(&self, run: &Certificate, bytes: &mut [u8]) -> Result<usize, LinkError> {
        encode_certificates(run, self.newest, &self.records, bytes)
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use std::vec::Vec;

    use super::*;
    use crate::alarm::{Alarm, Code, Span};
    use crate::board::{Board, Contacts};
    use crate::motion::{Cut, Setpoint};
    use crate::params::Params;
    use crate::units::Length;

    fn snapshot() -> Snapshot {
        let board = Board::new(&Params::slant_bed(), None, None).unwrap();
        let mut snapshot = Snapshot::new(board.ticker(), &Setpoint::default(), Contacts::default());
        snapshot.state = State::Running;
        snapshot
    }

    fn measured(number: u8, last: bool, nm: i64) -> Measured {
        Measured {
            error: Length::from_nm(nm),
            line: u32::from(number),
            kind: ThreadKind::Thread,
            cut: Cut { number, last },
        }
    }

    /// A stroke of three ticks in move `number`, and the tick behind it.
    fn stroke(threads: &mut Threads, now: &mut Snapshot, cut: (u8, bool), number: u32) {
        for tick in 0..4_i64 {
            now.setpoint.number = number;
            now.setpoint.locked = tick < 3;
            if tick > 0 {
                threads.measure(&measured(cut.0, cut.1, tick.saturating_neg()), 0);
            } else {
                threads.leave_stroke();
            }
            threads.go_on(now);
        }
        threads.leave_stroke();
        threads.go_on(now);
    }

    fn all(threads: &Threads) -> Vec<(u32, u32, ThreadState, u16)> {
        let one = |thread: ThreadCertificate| {
            let ThreadRecord {
                line, state, tally, ..
            } = thread.record;
            (thread.number, line, state, tally.passes)
        };
        threads.certificates().map(one).collect()
    }

    #[test]
    fn a_thread_is_done_when_the_program_goes_on_behind_its_last_stroke() {
        use ThreadState::{CutShort, Finished, UnderWay};
        let (mut threads, mut now) = (Threads::new(), snapshot());
        stroke(&mut threads, &mut now, (1, false), 2);
        stroke(&mut threads, &mut now, (1, true), 5);
        assert_eq!(all(&threads), [(1, 1, UnderWay, 2)]);
        // The way back is a move behind it.
        now.setpoint.number = 6;
        threads.go_on(&now);
        assert_eq!(all(&threads), [(1, 1, Finished, 2)]);
        // A stroke that is done again belongs to it.
        stroke(&mut threads, &mut now, (1, true), 5);
        assert_eq!(all(&threads), [(1, 1, UnderWay, 3)]);
        // The next one says so, too; a move behind a stroke that is not the last does not.
        stroke(&mut threads, &mut now, (2, false), 9);
        now.setpoint.number = 10;
        threads.go_on(&now);
        assert_eq!(all(&threads), [(2, 2, UnderWay, 1), (1, 1, Finished, 3)]);
        now.state = State::Alarm(Alarm::new(Code::EmergencyStop, Span::default()));
        threads.go_on(&now);
        assert_eq!(all(&threads)[0], (2, 2, CutShort, 1));
        // What is planned behind a reset is another one.
        now.state = State::Running;
        threads.note(&Event::Reset);
        stroke(&mut threads, &mut now, (3, true), 2);
        assert_eq!(
            all(&threads)[..2],
            [(3, 3, UnderWay, 1), (2, 2, CutShort, 1)]
        );
        threads.note(&Event::Finished);
        assert_eq!(all(&threads)[0], (3, 3, Finished, 1));
        let tally = threads.certificates().next().unwrap().record.tally;
        assert_eq!((tally.measured, tally.squares), (3, 1 + 4 + 9));
        assert_eq!(tally.largest, Length::from_nm(3));
    }

    #[test]
    fn the_last_error_of_a_thread_may_come_behind_the_reset() {
        let (mut threads, mut now) = (Threads::new(), snapshot());
        now.setpoint.locked = true;
        for _ in 0..3 {
            threads.measure(&measured(1, true, 5), 0);
            threads.go_on(&now);
        }
        threads.note(&Event::Reset);
        now.state = State::Idle;
        now.setpoint.locked = false;
        threads.measure(&measured(1, true, 9), 0);
        threads.go_on(&now);
        threads.leave_stroke();
        threads.go_on(&now);
        assert_eq!(all(&threads), [(1, 1, ThreadState::CutShort, 1)]);
        let tally = threads.certificates().next().unwrap().record.tally;
        assert_eq!((tally.measured, tally.largest), (4, Length::from_nm(9)));
        // Nothing is under way: whoever reads now has read it.
        threads.are_read();
        for number in 2..=8 {
            stroke(&mut threads, &mut now, (number, true), number.into());
        }
        assert!(!threads.is_unread());
    }

    #[test]
    fn an_alarm_of_another_block_is_behind_the_last_stroke() {
        let alarm = |line| {
            let span = Span {
                line,
                ..Span::default()
            };
            State::Alarm(Alarm::new(Code::TapFeed, span))
        };
        for (last, line, state) in [
            (true, 7, ThreadState::Finished),
            (true, 1, ThreadState::CutShort),
            (true, 0, ThreadState::CutShort),
            (false, 7, ThreadState::CutShort),
        ] {
            let (mut threads, mut now) = (Threads::new(), snapshot());
            stroke(&mut threads, &mut now, (1, last), 2);
            now.state = alarm(line);
            threads.go_on(&now);
            assert_eq!(all(&threads), [(1, 1, state, 1)], "{last} {line}");
        }
    }

    #[test]
    fn another_program_waits_for_nobody_who_has_read_the_last_one() {
        let (mut threads, mut now) = (Threads::new(), snapshot());
        threads.are_read();
        for number in 1..=8 {
            stroke(&mut threads, &mut now, (number, true), number.into());
        }
        assert!(threads.is_unread());
        threads.await_reader();
        assert!(!threads.is_unread());
    }

    #[test]
    fn the_newest_are_kept_without_gaps_and_who_reads_along_is_waited_for() {
        let (mut threads, mut now) = (Threads::new(), snapshot());
        for number in 1..=20 {
            assert!(!threads.is_unread());
            stroke(&mut threads, &mut now, (number, true), u32::from(number));
        }
        let kept: Vec<u32> = all(&threads).iter().map(|thread| thread.0).collect();
        assert_eq!(kept, [20, 19, 18, 17, 16, 15, 14, 13]);
        threads.are_read();
        for number in 21..=27 {
            assert!(!threads.is_unread(), "{number}");
            stroke(&mut threads, &mut now, (number, true), u32::from(number));
        }
        // The twentieth was under way when it was read.
        assert!(threads.is_unread());
        threads.are_read();
        assert!(!threads.is_unread());
        let mut bytes = [0; BATCH_BYTES];
        let run = crate::board::station::ledger::Ledger::new().certificate(0);
        let used = threads.encode(&run, &mut bytes).unwrap();
        let read: Result<Vec<_>, _> = crate::link::ThreadReader::new(&bytes[..used])
            .unwrap()
            .collect();
        assert_eq!(read.unwrap(), threads.certificates().collect::<Vec<_>>());
    }

    #[test]
    fn what_is_late_meanwhile_is_counted_as_far_as_there_is_room() {
        let mut threads = Threads::new();
        threads.measure(&measured(1, true, 0), 7);
        threads.measure(&measured(1, true, 0), 10);
        threads.measure(&measured(2, true, 0), 10);
        threads.measure(&measured(2, true, 0), 1_000_000);
        let late: Vec<u16> = threads
            .certificates()
            .map(|thread| thread.record.tally.late)
            .collect();
        assert_eq!(late, [u16::MAX, 3]);
    }
}
