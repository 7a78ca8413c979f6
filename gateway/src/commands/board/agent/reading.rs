//! What a board says, as observations. Most of it comes by itself; the rest is asked for as seldom as does.

use std::path::Path;
use std::time::{Duration, Instant};

use leadscrew_agent::Observation;
use leadscrew_agent::metrics::Pulse;
use leadscrew_agent::model::{Entry, Met, Ran};
use leadscrew_agent::record::{State, Trouble, What};
use leadscrew_core::alarm::{Alarm, Lang};
use leadscrew_core::board::Event;
use leadscrew_core::board::device::objects::CYCLE_PERIOD;
use leadscrew_core::bus::{BoardState, BoardStatus};
use leadscrew_core::link::{Logged, Status, ThreadCertificate, ThreadState};

use super::super::heard;
use super::super::watch::{Starts, THREADS, bit_rates};
use super::cut::Cuts;
use super::reader::Reader;
use crate::cli::Global;
use crate::diagnostics::Diagnostic;
use crate::failure::Outcome;
use crate::interrupt;
use crate::link::{Link, LinkResult, Traffic};
use crate::source::SourceFile;
use crate::words::both;

/// Between two looks at what the board has said by itself: as many changes in a second are told.
const LOOK: Duration = Duration::from_millis(100);
/// Between two readings of the status record where nothing has changed: 0.2 % of a bus with 1 Mbit/s.
const STATUS: Duration = Duration::from_secs(2);
/// Between two readings while things change.
const CHANGED: Duration = Duration::from_millis(500);
/// The same where a reading brought several.
const MANY: (u32, Duration) = (3, Duration::from_millis(250));
/// Between two measurements of the load of the bus, and how long one takes: hearing every frame is most of the work here.
const LOAD: [Duration; 2] = [Duration::from_secs(5), Duration::from_millis(500)];
/// Thousandths of a turn in a turn.
const MILLI: i32 = 1000;

/// A board that is read.
pub struct Reading<'a> {
    global: &'a Global,
    link: Link,
    starts: Starts,
    /// The board is to be met: what it says belongs to a start that is not known, or not kept.
    unmet: bool,
    record: Status,
    read: Instant,
    mode: &'static str,
    /// The last that came by itself when the record was read.
    known: BoardStatus,
    /// Something is synchronised, or has been since the certificates were read, or a thread has not ended.
    cut: bool,
    /// When the certificates were read, the newest number then, and how many were new.
    threads: (Instant, u32, u32),
    /// Entries of the log wait, or a program has ended.
    ended: bool,
    cuts: Cuts,
    rates: [u64; 2],
    /// The load of the bus in per cent; when the measurement, or the pause before it, has begun; it is under way.
    load: (Option<u8>, Instant, bool),
}

impl<'a> Reading<'a> {
    /// Meets the board.
    ///
    /// # Errors
    /// There is no bus, or no board on it.
    pub fn begin(global: &'a Global, reader: &mut Reader) -> Outcome<Self> {
        let mut link = heard(global)?;
        let rates = bit_rates(&mut link);
        // The load of the bus is everybody's.
        link.hear_everything()?;
        link.seen.traffic = Traffic::default();
        let now = Instant::now();
        let mut reading = Self {
            global,
            starts: Starts::new(&link),
            unmet: true,
            record: link.status()?,
            read: now,
            mode: "",
            known: link.seen.status.unwrap_or_default(),
            cut: true,
            threads: (now, 0, 0),
            ended: true,
            cuts: Cuts::default(),
            rates,
            load: (None, now, true),
            link,
        };
        reading.meet(reader)?;
        let bus = global.bus.to_string();
        let node = reading.link.node().get();
        reader.say(both!(
            "node {node} on {bus} is read",
            "正在读取 {bus} 上的节点 {node}"
        ));
        Ok(reading)
    }

    /// Meets it; where that cannot be kept, again later.
    fn meet(&mut self, reader: &mut Reader) -> LinkResult {
        let name = self.link.board_name()?;
        let status = self.link.status()?;
        let tick_us = self.link.read_number(CYCLE_PERIOD)?;
        let (_, threads) = self.link.certificates()?;
        let last = reader.keeper.model().memory().last_event;
        let log = match last {
            0 => Vec::new(),
            last => self.link.events_behind(last - 1)?,
        };
        let entry = log.iter().find(|entry| entry.number == last);
        self.mode = self.link.mode()?.name();
        self.record = status;
        (self.cut, self.ended) = (true, true);
        let kept = reader.observe(&Observation::Met(Met {
            serial: name.serial,
            start: self.link.start()?,
            firmware: name.version,
            parameters: status.parameters,
            tick: status.tick,
            tick_us: u32::try_from(tick_us).unwrap_or(0),
            newest_event: status.newest_event,
            newest_thread: threads.first().map_or(0, |thread| thread.number),
            last_event: entry.map(|entry| entry.tick),
        }));
        self.unmet = !kept;
        Ok(())
    }

    /// Reads until the end, or until the board is lost.
    ///
    /// # Errors
    /// The board is lost.
    pub fn carry_out(&mut self, reader: &mut Reader) -> Outcome {
        let mut last = Instant::now();
        loop {
            self.link.listen(Instant::now() + LOOK, &mut |_| false)?;
            self.unmet |= self.starts.attend(&mut self.link)?;
            // What cannot be kept is read again, and need not be often.
            let pause = if reader.is_full() { STATUS } else { LOOK };
            if last.elapsed() >= pause {
                last = Instant::now();
                let read = match self.unmet {
                    true => self.meet(reader),
                    false => self.look(reader),
                };
                self.tolerate(read)?;
            }
            if interrupt::requested() {
                return Ok(());
            }
        }
    }

    /// What a board that lives does not answer is asked again later.
    fn tolerate(&mut self, read: LinkResult) -> Outcome {
        if read.is_err() {
            self.link.check_alive()?;
        }
        Ok(())
    }

    fn look(&mut self, reader: &mut Reader) -> LinkResult {
        let now = Instant::now();
        let said = self.link.seen.status.unwrap_or_default();
        self.cut |= said.flags.locked;
        let changed = said.state != self.known.state
            || said.alarm != self.known.alarm
            || said.flags.program != self.known.flags.program;
        let pause = if changed { CHANGED } else { STATUS };
        // The figures of a program that has ended are there until the next one begins.
        let over = self.known.flags.program && !said.flags.program;
        let due = over || now.duration_since(self.read) >= pause;
        if due {
            self.record = self.link.status()?;
            self.mode = self.link.mode()?.name();
            (self.read, self.known) = (now, said);
            reader.observe(&Observation::Parameters(self.record.parameters));
            reader.pulse(Pulse {
                ticks: self.record.tick,
                credit: self.record.credit,
                dropped: self.link.dropped(),
            });
        }
        self.measure(now)?;
        let state = self.state(&said);
        reader.observe(&Observation::State(state, self.record.tick));
        self.log(reader)?;
        self.certificates(reader, now)?;
        // Last: it is a state, and waits for no one.
        if due {
            reader.read_set(&mut self.link, self.record.parameters)?;
        }
        Ok(())
    }

    /// The record, and what has come by itself since.
    fn state(&self, said: &BoardStatus) -> State {
        let seen = &self.link.seen;
        let mut state = State::of(&self.record, self.mode);
        said.state.name().clone_into(&mut state.state);
        state.alarm = said.alarm.unwrap_or(0);
        (state.hold, state.single_block) = (said.flags.hold, said.flags.single_block);
        if let Some(place) = seen.place {
            (state.line, state.number) = (place.line, place.number);
        }
        if let Some(spindle) = seen.spindle {
            state.rpm = spindle.speed.get() / MILLI;
        }
        state.load_percent = self.load.0;
        state.bus_errors = self.link.health().errors;
        state
    }

    fn measure(&mut self, now: Instant) -> LinkResult {
        let (percent, since, under_way) = self.load;
        let over = now.duration_since(since);
        let [pause, length] = LOAD;
        if under_way && over >= length {
            let [kbit, fd_kbit] = self.rates;
            let ms = u64::try_from(over.as_millis()).unwrap_or(u64::MAX);
            let load = self.link.seen.traffic.load(kbit, fd_kbit, ms.max(1));
            self.load = (Some(u8::try_from(load).unwrap_or(u8::MAX)), now, false);
            self.link.hear_boards()?;
        } else if !under_way && over >= pause {
            self.link.hear_everything()?;
            self.link.seen.traffic = Traffic::default();
            self.load = (percent, now, true);
        }
        Ok(())
    }

    fn log(&mut self, reader: &mut Reader) -> LinkResult {
        let last = reader.keeper.model().memory().last_event;
        if self.record.newest_event <= last {
            return Ok(());
        }
        let lang = self.global.lang();
        let entries: Vec<Entry> = self
            .link
            .events_behind(last)?
            .iter()
            .map(|entry| told(entry, lang))
            .collect();
        self.ended |= entries.iter().any(|entry| ends(entry.what.as_ref()));
        reader.observe(&Observation::Log(entries));
        Ok(())
    }

    fn certificates(&mut self, reader: &mut Reader, now: Instant) -> LinkResult {
        let (last, before, new) = self.threads;
        let (many, soon) = MANY;
        let pause = if new >= many { soon } else { THREADS };
        let due = self.cut && now.duration_since(last) >= pause;
        if !due && !self.ended {
            return Ok(());
        }
        let at_work = |status: &Status| status.in_program && status.state != BoardState::Alarm;
        let at_first = at_work(&self.link.status()?);
        let (certificate, threads) = self.link.certificates()?;
        let ran = Ran {
            certificate,
            under_way: at_first || at_work(&self.link.status()?),
        };
        let told = reader.keeper.model().memory().last_thread();
        let (parameters, lang) = (self.record.parameters, self.global.lang());
        let newest = threads.first().map_or(0, |thread| thread.number);
        let under_way = |thread: &ThreadCertificate| thread.record.state == ThreadState::UnderWay;
        let goes_on = threads.first().is_some_and(under_way)
            || self.link.seen.status.is_some_and(|said| said.flags.locked);
        let threads = self.cuts.judge(
            &mut self.link,
            &mut reader.sets,
            parameters,
            told,
            threads,
            lang,
        )?;
        let kept = reader.observe(&Observation::Certificates(ran, threads));
        self.threads = (now, newest, newest.saturating_sub(before));
        if kept {
            (self.cut, self.ended) = (goes_on, false);
        }
        Ok(())
    }
}

fn ends(what: Option<&What>) -> bool {
    matches!(what, Some(What::Finished | What::Reset | What::Alarm(_)))
}

fn told(entry: &Logged, lang: Lang) -> Entry {
    let what = match &entry.event {
        Event::Alarm(alarm) => Some(What::Alarm(trouble(alarm, lang))),
        Event::Warning(alarm) => Some(What::Warning(trouble(alarm, lang))),
        Event::Refused(alarm) => Some(What::Refused(trouble(alarm, lang))),
        Event::Finished => Some(What::Finished),
        Event::Reset => Some(What::Reset),
        Event::Held => Some(What::Held),
        Event::Ready => Some(What::Ready),
        Event::Started { .. } | Event::Spindle(_) | Event::Rigid | Event::Aux(_) => None,
    };
    Entry {
        number: entry.number,
        tick: entry.tick,
        what,
    }
}

/// An alarm in words. The program stands on another computer, or nowhere any more.
fn trouble(alarm: &Alarm, lang: Lang) -> Trouble {
    let source = SourceFile::new(Path::new(""));
    let told = Diagnostic::new(alarm, &source, lang, false);
    Trouble {
        number: told.number,
        line: alarm.span.line,
        cause: told.message,
        remedy: told.help,
    }
}
