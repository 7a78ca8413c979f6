//! The last threads and holes, each with its certificate. In object 5041h they follow the certificate of the run [D169].
//!
//! A thread is one call of a threading cycle with all its passes and starts, or one hole. It begins with its first measured
//! error. It is finished where the tick has carried its last stroke to the end. It is cut short where an alarm, a reset or
//! the end of the program comes before that.
//!
//! Reading changes nothing here, so there may be several readers. The gateway that runs the program writes how many it has
//! read (5042h): in lock-step the board waits for this gateway only [D172].

use heapless::Vec;

use super::actual::Sample;
use super::pass::Pass;
use crate::bus::Abort;
use crate::link::Event;
use crate::link::{
    BATCH_BYTES, Certificate, CutTally, LinkError, Tally, ThreadCertificate, ThreadKind,
    ThreadRecord, ThreadState, encode_certificates,
};
use crate::motion::Cut;
use crate::tick::{Measured, Snapshot};

/// Certificates kept. The newest may be under way.
const KEPT: usize = 5;

const _: () = assert!(
    Certificate::BYTES + KEPT * ThreadCertificate::BYTES <= BATCH_BYTES,
    "all of them, and that of the run, have room in one reading"
);

/// The last threads.
#[derive(Debug)]
pub struct Threads {
    /// The cut of the newest certificate; `None` where it cannot go on. Numbers of cuts wrap, and not every cut has a
    /// certificate.
    cut: Option<u8>,
    /// An axis was held to the spindle at the last measurement.
    in_stroke: bool,
    pass: Pass,
    /// Late setpoints before the newest certificate.
    late_before: u32,
    /// Number of the newest certificate, from 1 since power-up.
    newest: u32,
    /// The gateway that runs the program has read all up to this number; `None`: it has not said so.
    taken: Option<u32>,
    /// The newest first.
    records: Vec<ThreadRecord, KEPT>,
}

impl Threads {
    // [D146]
    #[inline(always)]
    pub const fn new() -> Self {
        Self {
            cut: None,
            in_stroke: false,
            pass: Pass::new(),
            late_before: 0,
            newest: 0,
            taken: None,
            records: Vec::new(),
        }
    }

    /// The gateway that runs the program has read all up to `number`.
    ///
    /// # Errors
    /// [`Abort::TooHigh`]: there are not so many, or the last of them is still being cut and must be read again.
    pub fn take(&mut self, number: u32) -> Result<(), Abort> {
        if number > self.newest.saturating_sub(self.is_under_way().into()) {
            return Err(Abort::TooHigh);
        }
        self.taken = Some(number);
        Ok(())
    }

    /// The number up to which the gateway has read; 0 where it has not said so.
    pub fn taken(&self) -> u32 {
        self.taken.unwrap_or(0)
    }

    /// Another program begins: its gateway need not be the one that has read so far.
    pub const fn await_reader(&mut self) {
        self.taken = None;
    }

    /// True where the next certificate would overwrite one that the reading gateway has not read.
    pub const fn is_full(&self) -> bool {
        match self.taken {
            Some(taken) => self.newest.saturating_sub(taken) >= KEPT as u32,
            None => false,
        }
    }

    /// True where the newest has not ended.
    fn is_under_way(&self) -> bool {
        let newest = self.records.first();
        newest.is_some_and(|newest| newest.state == ThreadState::UnderWay)
    }

    /// Ends the newest in this state, if it has not ended yet.
    fn end(&mut self, state: ThreadState) {
        self.close_pass();
        if let Some(newest) = self.records.first_mut()
            && newest.state == ThreadState::UnderWay
        {
            newest.state = state;
        }
    }

    /// The pass is over: its groove counts.
    #[inline(never)]
    fn close_pass(&mut self) {
        if let Some(pass) = self.pass.close()
            && let Some(newest) = self.records.first_mut()
        {
            newest.cut.close(&pass);
        }
    }

    /// Takes a measured error, and that of the drive's own position where one has come.
    pub fn measure(&mut self, measured: &Measured, sample: Option<&Sample>, late: u32) {
        if self.cut != Some(measured.cut.number) {
            // The program has gone on.
            self.end(ThreadState::Finished);
            self.records.truncate(KEPT.saturating_sub(1));
            let record = ThreadRecord {
                line: measured.line,
                kind: measured.kind,
                state: ThreadState::UnderWay,
                tally: Tally::NONE,
                cut: CutTally::NONE,
            };
            // There is room now.
            let _ = self.records.insert(0, record);
            self.newest = self.newest.saturating_add(1);
            self.cut = Some(measured.cut.number);
            self.in_stroke = false;
            self.late_before = late;
        }
        let Some(newest) = self.records.first_mut() else {
            return;
        };
        let tally = &mut newest.tally;
        if !self.in_stroke {
            self.in_stroke = true;
            self.pass.begin();
            // A hole counts as one pass, however often the tap turns round in it.
            if newest.kind == ThreadKind::Thread || tally.passes == 0 {
                tally.passes = tally.passes.saturating_add(1);
            }
        }
        let late = late.saturating_sub(self.late_before);
        tally.late = u16::try_from(late).unwrap_or(u16::MAX);
        tally.take(measured.error);
        if let Some(change) = self.pass.take(sample)
            && let Some(sample) = sample
        {
            newest.cut.on_x = sample.on_x;
            let (error, lead) = (sample.error, sample.lead);
            newest.cut.take(error, change, lead, sample.per_second);
        }
    }

    /// No axis is held to the spindle.
    pub fn leave_stroke(&mut self) {
        self.in_stroke = false;
        self.close_pass();
    }

    /// Takes the state of the machine. The last error comes with the tick after the end.
    pub fn go_on(&mut self, now: &Snapshot) {
        if now.setpoint.locked {
            return;
        }
        let Cut { number, last } = now.done;
        let own = self.cut == Some(number);
        if !own && !self.in_stroke && !self.is_under_way() {
            self.cut = None;
        }
        if last && own {
            self.end(ThreadState::Finished);
        } else if !now.in_program {
            // On an alarm, after a reset, or at the end of a program that has left a tap in its hole.
            self.end(ThreadState::CutShort);
        }
    }

    /// Takes an event. After a reset the thread is not cut any further, but its last error may still come.
    pub fn note(&mut self, event: &Event) {
        if *event == Event::Reset {
            self.end(ThreadState::CutShort);
        }
    }

    /// All certificates, the newest first.
    pub fn certificates(&self) -> impl Iterator<Item = ThreadCertificate> {
        let numbers = (1..=self.newest).rev();
        let with_number = |(number, record): (u32, &ThreadRecord)| ThreadCertificate {
            number,
            record: *record,
        };
        numbers.zip(&self.records).map(with_number)
    }

    /// Puts them after the certificate of `run`, as [`encode_certificates`] does.
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
    use crate::board::{Board, Contacts, State};
    use crate::motion::{Cut, Setpoint};
    use crate::params::Params;
    use crate::units::Length;

    fn snapshot() -> Snapshot {
        let board = Board::new(&Params::sheets(), None, None).unwrap();
        let mut snapshot = Snapshot::new(board.ticker(), &Setpoint::default(), Contacts::default());
        snapshot.state = State::Running;
        snapshot.in_program = true;
        snapshot
    }

    fn measured(number: u8, last: bool, nm: i64) -> Measured {
        Measured {
            error: Length::from_nm(nm),
            line: u32::from(number),
            kind: ThreadKind::Thread,
            cut: Cut { number, last },
            followed: None,
        }
    }

    /// A stroke of three ticks, and the tick after it; `ends`: the tick has carried it to its end.
    fn stroke(threads: &mut Threads, now: &mut Snapshot, cut: (u8, bool), ends: bool) {
        for tick in 0..4_i64 {
            now.setpoint.locked = tick < 3;
            if tick > 0 {
                threads.measure(&measured(cut.0, cut.1, tick.saturating_neg()), None, 0);
            } else {
                threads.leave_stroke();
            }
            if ends && tick == 2 {
                (now.done.number, now.done.last) = cut;
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
    fn a_thread_is_done_when_its_last_stroke_has_come_to_its_end() {
        use ThreadState::{CutShort, Finished, UnderWay};
        let (mut threads, mut now) = (Threads::new(), snapshot());
        stroke(&mut threads, &mut now, (1, false), true);
        // Left on the way, and done again.
        stroke(&mut threads, &mut now, (1, true), false);
        assert_eq!(all(&threads), [(1, 1, UnderWay, 2)]);
        stroke(&mut threads, &mut now, (1, true), true);
        assert_eq!(all(&threads), [(1, 1, Finished, 3)]);
        // A tick after the end of a stroke that is not the last does not end the thread.
        stroke(&mut threads, &mut now, (2, false), true);
        assert_eq!(all(&threads), [(2, 2, UnderWay, 1), (1, 1, Finished, 3)]);
        now.in_program = false;
        threads.go_on(&now);
        assert_eq!(all(&threads)[0], (2, 2, CutShort, 1));
        // A thread planned after a reset is another one.
        now.in_program = true;
        threads.note(&Event::Reset);
        stroke(&mut threads, &mut now, (3, true), false);
        assert_eq!(
            all(&threads)[..2],
            [(3, 3, UnderWay, 1), (2, 2, CutShort, 1)]
        );
        // The program goes on and ends at once.
        (now.done.number, now.done.last) = (3, true);
        now.in_program = false;
        threads.note(&Event::Finished);
        threads.go_on(&now);
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
            threads.measure(&measured(1, true, 5), None, 0);
            threads.go_on(&now);
        }
        threads.note(&Event::Reset);
        now.state = State::Idle;
        now.in_program = false;
        now.setpoint.locked = false;
        threads.measure(&measured(1, true, 9), None, 0);
        threads.go_on(&now);
        threads.leave_stroke();
        threads.go_on(&now);
        assert_eq!(all(&threads), [(1, 1, ThreadState::CutShort, 1)]);
        let tally = threads.certificates().next().unwrap().record.tally;
        assert_eq!((tally.measured, tally.largest), (4, Length::from_nm(9)));
        // Nothing is under way: it can be taken.
        assert_eq!(threads.take(1), Ok(()));
        for number in 2..=5 {
            stroke(&mut threads, &mut now, (number, true), true);
        }
        assert!(!threads.is_full());
    }

    /// Holes of other spindles make no record.
    #[test]
    fn the_counter_of_cuts_may_go_round_between_two_threads() {
        for (ends, state) in [
            (true, ThreadState::Finished),
            (false, ThreadState::CutShort),
        ] {
            let (mut threads, mut now) = (Threads::new(), snapshot());
            stroke(&mut threads, &mut now, (7, true), ends);
            if !ends {
                threads.note(&Event::Reset);
                // Its last error comes after that.
                threads.measure(&measured(7, true, 2), None, 0);
                threads.leave_stroke();
                assert_eq!(all(&threads).len(), 1);
            }
            for hole in 1..=255 {
                now.done.number = 7_u8.wrapping_add(hole);
                threads.go_on(&now);
            }
            stroke(&mut threads, &mut now, (7, true), true);
            let kept: Vec<_> = all(&threads)
                .into_iter()
                .map(|thread| (thread.0, thread.2))
                .collect();
            assert_eq!(kept, [(2, ThreadState::Finished), (1, state)]);
        }
    }

    /// Its own end counts, wherever the alarm says that it came from.
    #[test]
    fn an_alarm_behind_the_last_stroke_cuts_nothing_short() {
        for (last, ends, state) in [
            (true, true, ThreadState::Finished),
            (true, false, ThreadState::CutShort),
            (false, true, ThreadState::CutShort),
        ] {
            for line in [0, 1, 7] {
                let (mut threads, mut now) = (Threads::new(), snapshot());
                now.setpoint.locked = true;
                threads.measure(&measured(1, last, 5), None, 0);
                threads.go_on(&now);
                if ends {
                    (now.done.number, now.done.last) = (1, last);
                }
                // In the very next tick, in which the last error comes.
                let span = Span {
                    line,
                    ..Span::default()
                };
                now.state = State::Alarm(Alarm::new(Code::TapFeed, span));
                now.in_program = false;
                now.setpoint.locked = false;
                threads.measure(&measured(1, last, 6), None, 0);
                threads.go_on(&now);
                assert_eq!(all(&threads), [(1, 1, state, 1)], "{last} {ends} {line}");
            }
        }
    }

    #[test]
    fn another_program_waits_for_nobody_who_has_taken_those_of_the_last_one() {
        let (mut threads, mut now) = (Threads::new(), snapshot());
        assert_eq!(threads.take(0), Ok(()));
        for number in 1..=5 {
            stroke(&mut threads, &mut now, (number, true), true);
        }
        assert!(threads.is_full());
        threads.await_reader();
        assert!(!threads.is_full());
    }

    #[test]
    fn the_newest_are_kept_without_gaps_and_who_takes_them_is_waited_for() {
        let (mut threads, mut now) = (Threads::new(), snapshot());
        for number in 1..=20 {
            assert!(!threads.is_full());
            stroke(&mut threads, &mut now, (number, true), number < 20);
        }
        let kept: Vec<u32> = all(&threads).iter().map(|thread| thread.0).collect();
        assert_eq!(kept, [20, 19, 18, 17, 16]);
        // The twentieth is under way, and there is no twenty-first.
        assert_eq!(
            (threads.taken(), threads.take(20)),
            (0, Err(Abort::TooHigh))
        );
        assert_eq!(threads.take(21), Err(Abort::TooHigh));
        assert_eq!((threads.take(19), threads.taken()), (Ok(()), 19));
        for number in 21..=24 {
            assert!(!threads.is_full(), "{number}");
            stroke(&mut threads, &mut now, (number, true), true);
        }
        assert!(threads.is_full());
        // Whoever only reads takes nothing.
        let mut bytes = [0; BATCH_BYTES];
        let run = crate::board::device::recorder::RunRecorder::new().certificate(0);
        let used = threads.encode(&run, &mut bytes).unwrap();
        let read: Result<Vec<_>, _> = crate::link::ThreadReader::new(&bytes[..used])
            .unwrap()
            .collect();
        assert_eq!(read.unwrap(), threads.certificates().collect::<Vec<_>>());
        assert!(threads.is_full());
        assert_eq!((threads.take(24), threads.is_full()), (Ok(()), false));
    }

    #[test]
    fn what_is_late_meanwhile_is_counted_as_far_as_there_is_room() {
        let mut threads = Threads::new();
        threads.measure(&measured(1, true, 0), None, 7);
        threads.measure(&measured(1, true, 0), None, 10);
        threads.measure(&measured(2, true, 0), None, 10);
        threads.measure(&measured(2, true, 0), None, 1_000_000);
        let late: Vec<u16> = threads
            .certificates()
            .map(|thread| thread.record.tally.late)
            .collect();
        assert_eq!(late, [u16::MAX, 3]);
    }
}
