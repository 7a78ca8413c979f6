//! `monitor`: the panel of a terminal. It shows a board, and its keys operate it.
//!
//! ```text
//! terminal ─ events ─► panel ─► keys     which wish, and whether it may be
//!                        │ ├──► hand     a press while its key is held, a step
//!                        │ └──► orders   orders and levels until the board has them
//!                        └ asks ─► here: reads the board, begins typed lines (typed), has it drawn (view, draw)
//! ```
//!
//! Where the board is not heard any more, the panel stays and looks for it (`finding`).
//! The panel has its turn wherever the link waits ([`Link::meanwhile`]): no transfer delays a hold or a release.

mod draw;
pub(super) mod finding;
pub(super) mod hand;
pub(super) mod homing;
pub(super) mod keys;
pub(super) mod orders;
mod panel;
mod terminal;
pub(super) mod told;
pub(super) mod typed;
pub(super) mod view;
pub(super) mod zeros;

use std::collections::VecDeque;
use std::io::{self, IsTerminal as _};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use leadscrew_core::board::device::objects::BEAT;
use leadscrew_core::bus::{Beat, BoardSpindle, Frame, NodeId};

use self::finding::{Screen, leaves};
use self::panel::{Ask, Open, Panel};
use self::typed::Typed;
use self::view::{Tone, View};
use super::watch::{Every, LOG, STATUS, Watch, bit_rates};
use super::{by_hand, heard, mdi, single_block};
use crate::cli::Global;
use crate::diagnostics::alarm_words;
use crate::failure::{Failure, Outcome};
use crate::interrupt::{self, UnderWay};
use crate::link::{Link, LinkResult, Seen, Traffic};
use crate::words::{Both, both};

/// Between two pictures.
const PICTURE: Duration = Duration::from_millis(50);
/// Over which the load of the bus is measured.
const LOAD: Duration = Duration::from_millis(500);
/// Errors and messages kept for the picture.
const KEPT: usize = 240;

/// Shows the board, and lets keys operate it unless `watch`, until a key ends it.
pub fn monitor(global: &Global, watch: bool) -> Outcome {
    if !io::stdout().is_terminal() {
        return Err(Failure::Usage(both!(
            "`monitor` draws on a terminal, and standard output is none; `status --json` is for programs",
            "`monitor` 需要终端，而标准输出不是终端；程序请用 `status --json`"
        )));
    }
    let mut link = heard(global)?;
    if !watch {
        single_block(global, &mut link)?;
    }
    interrupt::defer(UnderWay::Computed);
    interrupt::before_the_end(terminal::give_back);
    let keys = !watch && terminal::has_keys();
    let result = terminal::take()
        .and_then(|drawn| Ok((drawn, keys && terminal::listen()?)))
        .and_then(|(drawn, tells_release)| {
            let screen = Screen {
                global,
                keys,
                tells_release,
                drawn,
                view: blank(global, &link),
                typed: None,
            };
            screen.carry_out(link)
        });
    terminal::give_back();
    result.map_err(|error| Failure::stdout(&error))
}

/// A picture of this board before anything is known of it.
fn blank(global: &Global, link: &Link) -> View {
    View::new(&global.bus.to_string(), link.node().get(), global.lang())
}

/// What the terminal and the bus share.
struct Shared {
    panel: Panel,
    /// Keys operate the machine; else they only end the view.
    keys: bool,
    /// The first picture has been drawn, or is about to be.
    shown: bool,
    over: bool,
    /// The terminal cannot be read any more.
    trouble: Option<io::Error>,
}

impl Shared {
    /// Has what the terminal has said act, and gives the frames that follow.
    fn turn(&mut self, seen: &Seen, now: Instant) -> Vec<Frame> {
        if !self.shown {
            return Vec::new();
        }
        match terminal::said() {
            Ok(said) => {
                for input in &said {
                    if self.keys {
                        self.panel.input(input, seen, now);
                    } else {
                        self.over |= leaves(input);
                    }
                }
            }
            Err(error) => self.trouble = Some(error),
        }
        self.over |= self.panel.is_over();
        self.panel.frames(seen, now)
    }
}

/// One panel at work, as long as the board is heard.
struct Session<'a, 'b> {
    screen: &'b mut Screen<'a>,
    link: Link,
    shared: Arc<Mutex<Shared>>,
    watch: Watch,
    rates: [u64; 2],
    record_read: Option<Instant>,
    /// The board has started again, and all of it is to be read anew.
    anew: bool,
}

impl<'a, 'b> Session<'a, 'b> {
    /// Whatever was read of a board before is read anew.
    fn new(screen: &'b mut Screen<'a>, mut link: Link) -> Outcome<Self> {
        // The load of the bus is everybody's.
        link.hear_everything()?;
        let rates = bit_rates(&mut link);
        let watch = Watch::new(&mut link)?;
        let (node, lang) = (link.node(), screen.global.lang());
        let session = by_hand::session(&link.seen);
        let shared = Arc::new(Mutex::new(Shared {
            panel: Panel::new(node, session, lang, screen.tells_release),
            keys: screen.keys,
            shown: false,
            over: false,
            trouble: None,
        }));
        let turns = Arc::clone(&shared);
        link.meanwhile(move |seen, now| locked(&turns).turn(seen, now));
        link.seen.traffic = Traffic::default();
        screen.view = blank(screen.global, &link);
        Ok(Self {
            screen,
            link,
            shared,
            watch,
            rates,
            record_read: None,
            anew: false,
        })
    }

    /// When the board was heard last.
    fn last(&self) -> Option<Instant> {
        self.link.seen.last
    }

    fn shared(&self) -> MutexGuard<'_, Shared> {
        locked(&self.shared)
    }

    fn answer(&self, words: &Both, tone: Tone) {
        self.shared().panel.answer(words, tone);
    }

    /// What a board that lives does not answer is told, and asked again later.
    fn tolerate<T>(&mut self, read: LinkResult<T>) -> Outcome<Option<T>> {
        match read {
            Ok(read) => Ok(Some(read)),
            Err(trouble) => {
                self.link.check_alive()?;
                if let Some(words) = Failure::from(trouble).words() {
                    self.answer(&words, Tone::Bad);
                }
                Ok(None)
            }
        }
    }

    /// Until a key ends it, or the terminal fails; with a failure once the board is not heard.
    fn carry_out(&mut self) -> Outcome<io::Result<()>> {
        let (mut status, mut log, mut load) =
            (Every::new(STATUS), Every::new(LOG), Every::new(LOAD));
        let mut loaded = Instant::now();
        self.read_log()?;
        self.read_status()?;
        // What was typed before anything could be seen was not meant for a machine.
        if let Err(error) = terminal::said() {
            return Ok(Err(error));
        }
        self.shared().shown = true;
        loop {
            if let Err(error) = self.draw() {
                return Ok(Err(error));
            }
            let mut shared = self.shared();
            if let Some(error) = shared.trouble.take() {
                return Ok(Err(error));
            }
            // Ctrl-C is a key here; where the signal comes from elsewhere, the terminal is left as it was all the same.
            if shared.over || interrupt::requested() {
                return Ok(Ok(()));
            }
            drop(shared);
            let node = self.link.node();
            let errors = &mut self.screen.view.errors;
            self.link.listen(Instant::now() + PICTURE, &mut |frame| {
                note_error(errors, frame, node);
                false
            })?;
            if self.watch.attend(&mut self.link)? {
                // What was ordered the panel takes back by itself.
                self.anew = true;
                (self.screen.view.record, self.record_read) = (None, None);
                (log, status) = (Every::new(LOG), Every::new(STATUS));
            }
            let now = Instant::now();
            if load.is_due(now) {
                let ms = loaded.elapsed().as_millis() as u64;
                let traffic = std::mem::take(&mut self.link.seen.traffic);
                let [kbit, fd_kbit] = self.rates;
                let percent = traffic.load(kbit, fd_kbit, ms.max(1)).min(999);
                self.screen.view.load_percent = percent;
                loaded = Instant::now();
            }
            if log.is_due(now) {
                self.read_log()?;
            }
            if status.is_due(now) {
                self.read_status()?;
            }
            self.do_asked()?;
        }
    }

    fn read_status(&mut self) -> Outcome {
        let read = self.link.status();
        if let Some(status) = self.tolerate(read)? {
            let now = Instant::now();
            self.record_read = Some(now);
            self.screen.view.record = Some((status, Duration::ZERO));
            self.shared().panel.note_record(status, now);
        }
        if self.link.seen.beat.is_none() {
            // A board above node 31 sends no beat.
            let read = self.link.read_number(BEAT);
            let beat = self.tolerate(read)?;
            let read = self.link.mode();
            let mode = self.tolerate(read)?;
            if let (Some(beat), Some(mode)) = (beat, mode) {
                self.shared().panel.note_asked(Beat::new(beat as u16), mode);
            }
        }
        Ok(())
    }

    fn read_log(&mut self) -> Outcome {
        if self.anew {
            let read = Watch::new(&mut self.link);
            let Some(watch) = self.tolerate(read)? else {
                return Ok(());
            };
            (self.watch, self.anew) = (watch, false);
            self.screen.view.messages.clear();
        }
        let read = self.watch.log(&mut self.link);
        for entry in self.tolerate(read)?.unwrap_or_default() {
            if let Some(told) = told::told(&entry, self.screen.view.lang) {
                if self.screen.view.messages.len() == KEPT {
                    self.screen.view.messages.pop_front();
                }
                self.screen.view.messages.push_back(told);
            }
        }
        if let Some((status, _)) = self.screen.view.record {
            let read = self
                .watch
                .follow(self.screen.global, &mut self.link, &status);
            self.tolerate(read)?;
        }
        Ok(())
    }

    /// Does what the panel has asked, and asks a typed line whether it has ended.
    fn do_asked(&mut self) -> Outcome {
        let asks = self.shared().panel.asks();
        for ask in asks {
            match ask {
                Ask::Refusal | Ask::NoPress => {
                    let read = self.link.refusal();
                    match self.tolerate(read)? {
                        Some(Some(reason)) => self.answer(&alarm_words(&reason), Tone::Care),
                        Some(None) if ask == Ask::NoPress => {
                            self.answer(&hand::broken(), Tone::Care);
                        }
                        _ => {}
                    }
                }
                Ask::Line(line) => {
                    match Typed::begin(self.screen.global, &line, self.screen.global.lang()) {
                        Ok(typed) => {
                            self.screen.typed = Some(typed);
                            let words = both!("under way: {line}", "正在执行：{line}");
                            self.answer(&words, Tone::Plain);
                        }
                        Err(error) => {
                            let (words, tone) = typed::not_begun(&error);
                            self.answer(&words, tone);
                        }
                    }
                }
                Ask::NextSystem => self.watch.zeros.next_system(),
                Ask::NextTool => self.watch.zeros.next_tool(),
            }
        }
        if let Some((words, tone)) = self.screen.typed.as_ref().and_then(Typed::answer) {
            self.screen.typed = None;
            self.answer(&words, tone);
        }
        self.shared().panel.typed = self.screen.typed.is_some();
        Ok(())
    }

    fn draw(&mut self) -> io::Result<()> {
        let now = Instant::now();
        let seen = &self.link.seen;
        let shared = locked(&self.shared);
        let panel = &shared.panel;
        let Screen {
            view, drawn, keys, ..
        } = &mut *self.screen;
        view.pdo = seen.status.zip(panel.age(now));
        if let (Some((_, age)), Some(read)) = (&mut view.record, self.record_read) {
            *age = now.saturating_duration_since(read);
        }
        view.mode = panel.mode(seen);
        view.spindle = seen.spindle;
        view.place = seen.place;
        view.zero = self.watch.zeros.zero();
        view.modal = self.watch.zeros.carried.as_ref().map(mdi::modal_words);
        let mut page = Vec::new();
        if *keys {
            view.prompt = panel.prompt();
            view.hint = panel.hint(seen);
            if panel.open == Open::Help {
                page = panel::help(view.lang);
            }
        }
        drop(shared);
        let picture = |frame: &mut ratatui::Frame| {
            draw::draw(frame, view);
            if !page.is_empty() {
                draw::draw_help(frame, view, &page);
            }
        };
        drawn.draw(picture).map(drop)
    }
}

fn locked(shared: &Mutex<Shared>) -> MutexGuard<'_, Shared> {
    // What a panic has left is only shown; the board moves nothing by it.
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Keeps what this board says of its synchronism; another one's is not in its picture.
fn note_error(errors: &mut VecDeque<u64>, frame: &Frame, board: NodeId) {
    let spindle = BoardSpindle::decode(frame).filter(|(node, _)| *node == board);
    if let Some(error) = spindle.and_then(|(_, spindle)| spindle.sync_error) {
        if errors.len() == KEPT {
            errors.pop_front();
        }
        errors.push_back(error.nm().unsigned_abs());
    }
}

#[cfg(test)]
mod tests {
    use leadscrew_core::units::Length;

    use super::*;

    #[test]
    fn each_board_has_its_own_synchronism() {
        let mut errors = VecDeque::new();
        let second = NodeId::new(2).unwrap();
        for (nm, node) in [(100, NodeId::BOARD), (700, second), (-300, NodeId::BOARD)] {
            let spindle = BoardSpindle {
                sync_error: Some(Length::from_nm(nm)),
                ..BoardSpindle::default()
            };
            note_error(&mut errors, &spindle.frame(node), NodeId::BOARD);
        }
        assert_eq!(errors, [100, 300]);
    }
}
