//! The panel: what the keys do to a machine, between the terminal and the bus.
//!
//! Keys, time and what was heard go in; frames, an answer for the last line and few requests come out. Knows no terminal
//! and no bus, so that a press can be let go, forgotten or interrupted in a test without either.

mod words;

use std::time::{Duration, Instant};

use leadscrew_core::alarm::Lang;
use leadscrew_core::bus::{Beat, BoardCommand, BoardState, Frame, NodeId, Order};
use leadscrew_core::link::Status;
use leadscrew_core::operating::OperatingMode;
use leadscrew_core::units::Axes;
use ratatui::crossterm::event::{Event as Input, KeyCode, KeyEvent, KeyEventKind, KeyModifiers};

use super::hand::Hand;
use super::homing::Homing;
use super::keys::{self, INCREMENTS, Situation, Speed, Wish};
use super::orders::{self, Orders, Outcome};
use super::view::{OLD, Row, Tone};
use crate::cli::{HandWay, OverrideName, StepLength};
use crate::link::Seen;
use crate::words::Both;

pub use words::help;

/// An override is counted from the last one that was sent within this time: the board's own comes later.
const JUST_SENT: Duration = Duration::from_millis(600);
/// Enter that comes sooner behind another key is none: text that is pasted into a terminal which does not say so comes as
/// keys, all at once.
const DELIBERATE: Duration = Duration::from_millis(50);
/// No block is longer.
const LONGEST_LINE: usize = 200;

/// What waits for a further key.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Open {
    /// Nothing.
    #[default]
    Nothing,
    /// Enter carries this out.
    Named(Wish),
    /// A letter chooses a mode.
    Modes,
    /// A line is typed.
    Line(String),
    /// The page of help.
    Help,
}

/// What is asked of whoever has a bus that answers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Ask {
    /// Say why the board has refused an order, if it has.
    Refusal,
    /// Say why it has refused a press.
    NoPress,
    /// Carry out this line.
    Line(String),
    /// Show positions by the next work coordinate system.
    NextSystem,
    /// Show positions by the next tool.
    NextTool,
}

/// The panel.
#[derive(Debug)]
pub struct Panel {
    lang: Lang,
    hand: Hand,
    orders: Orders,
    /// The status record, and when it was read.
    record: Option<(Status, Instant)>,
    /// The number of statuses heard, and when the last one came.
    statuses: (u64, Option<Instant>),
    /// The last start of the board, by the number of its boot-up messages.
    boots: Option<u32>,
    /// The beat and the mode of a board that sends none, as it was asked.
    asked: Option<(Beat, OperatingMode)>,
    tells_release: bool,
    /// A typed line is being carried out.
    pub typed: bool,
    /// What waits for a further key.
    pub open: Open,
    answer: Row,
    increment: StepLength,
    /// Overrides as they were sent last: feed, rapid, spindle.
    sent: [Option<(u8, Instant)>; 3],
    homing: Homing,
    asks: Vec<Ask>,
    /// When the last key was pressed.
    last_key: Option<Instant>,
    quit: bool,
}

impl Panel {
    /// Nothing has been pressed.
    #[must_use]
    pub fn new(node: NodeId, session: u8, lang: Lang, tells_release: bool) -> Self {
        let [_, _, increment, _] = INCREMENTS;
        Self {
            lang,
            hand: Hand::new(node, session),
            orders: Orders::new(node),
            record: None,
            statuses: (0, None),
            boots: None,
            asked: None,
            tells_release,
            typed: false,
            open: Open::Nothing,
            answer: Row::default(),
            increment,
            sent: [None; 3],
            homing: Homing::default(),
            asks: Vec::new(),
            last_key: None,
            quit: false,
        }
    }

    /// Takes the status record.
    pub const fn note_record(&mut self, record: Status, now: Instant) {
        self.record = Some((record, now));
    }

    /// Takes what a board without process data for it was asked.
    pub const fn note_asked(&mut self, beat: Beat, mode: OperatingMode) {
        self.asked = Some((beat, mode));
    }

    /// The age of the newest status.
    #[must_use]
    pub fn age(&self, now: Instant) -> Option<Duration> {
        let (_, at) = self.statuses;
        at.map(|at| now.saturating_duration_since(at))
    }

    /// The mode, where it is known.
    #[must_use]
    pub fn mode(&self, seen: &Seen) -> Option<OperatingMode> {
        let asked = self.asked.map(|(_, mode)| mode);
        seen.beat.map(|told| told.mode).or(asked)
    }

    /// Somebody wants to leave.
    #[must_use]
    pub const fn is_over(&self) -> bool {
        self.quit
    }

    /// What is asked; each once.
    pub fn asks(&mut self) -> Vec<Ask> {
        std::mem::take(&mut self.asks)
    }

    /// Answers on the last line.
    pub fn answer(&mut self, words: &Both, tone: Tone) {
        self.answer = Row::new(words.get(self.lang), tone);
    }

    fn situation(&self, seen: &Seen, now: Instant) -> Situation {
        let status = seen.status.unwrap_or_default();
        Situation {
            mode: self.mode(seen),
            state: status.state,
            program: status.flags.program,
            hold: status.flags.hold,
            old: self.age(now).is_none_or(|age| age > OLD),
            beats: seen.beat.is_some(),
            tells_release: self.tells_release,
            typed: self.typed,
        }
    }

    /// Takes what a terminal has said.
    pub fn input(&mut self, input: &Input, seen: &Seen, now: Instant) {
        self.hear(seen, now);
        match input {
            Input::Key(key) => self.key(*key, seen, now),
            Input::Paste(text) => {
                self.hand.release(now);
                // A paste is no sequence of keys: it goes into a line, or nowhere.
                if let Open::Line(line) = &mut self.open {
                    let pasted = text.lines().next().unwrap_or_default();
                    line.extend(pasted.chars().filter(|c| !crate::words::is_obeyed(*c)));
                }
            }
            // Focus comes or goes, another size, a mouse: whoever held a key may hold it no more.
            _ => self.hand.release(now),
        }
    }

    fn key(&mut self, key: KeyEvent, seen: &Seen, now: Instant) {
        let by_hand = match keys::wish(key) {
            Some(Wish::ByHand(way, speed)) => Some((way, speed)),
            _ => None,
        };
        match (key.kind, by_hand) {
            (KeyEventKind::Release, Some(_)) => return self.hand.release(now),
            (KeyEventKind::Release, None) => return,
            (KeyEventKind::Repeat, Some((way, speed))) if self.hand.presses() => {
                return self.hand.still_held(way, speed == Speed::Rapid, now);
            }
            // A key that is held asks once, but for those that are typed.
            (KeyEventKind::Repeat, _) if !matches!(self.open, Open::Line(_)) => return,
            (KeyEventKind::Repeat | KeyEventKind::Press, _) => {}
        }
        let before = self.last_key.replace(now);
        if key.code == KeyCode::Enter && before.is_some_and(|at| now < at + DELIBERATE) {
            return;
        }
        let pressed = self.hand.presses();
        self.hand.release(now);
        let halts = keys::halt_by_letter(key).is_some();
        if pressed && !halts {
            // Any other key ends a press, and does nothing else.
            return;
        }
        match std::mem::take(&mut self.open) {
            Open::Nothing => {
                self.answer = Row::default();
                if let Some(wish) = keys::wish(key) {
                    self.wish(wish, seen, now);
                }
            }
            Open::Line(line) => self.type_key(key, line, seen, now),
            open => {
                if let Some(halt) = keys::halt_by_letter(key) {
                    return self.wish(halt, seen, now);
                }
                if keys::is_control(key, 'c') {
                    return self.wish(Wish::Quit, seen, now);
                }
                match (open, key.code) {
                    (Open::Named(wish), KeyCode::Enter) => self.carry_out(wish, seen, now),
                    (Open::Modes, KeyCode::Char(letter)) => {
                        if let Some(mode) = keys::mode_of(letter) {
                            self.order(Order::Mode(mode), seen, now);
                        }
                    }
                    _ => {}
                }
            }
        }
    }

    /// A key while a line is typed. Space holds a machine that moves.
    fn type_key(&mut self, key: KeyEvent, mut line: String, seen: &Seen, now: Instant) {
        let moves = seen.status.unwrap_or_default().state != BoardState::Idle;
        let halt = match key.code {
            KeyCode::Char(' ') if moves => Some(Wish::Hold),
            _ => keys::halt(key),
        };
        if let Some(halt) = halt {
            self.open = Open::Line(line);
            return self.wish(halt, seen, now);
        }
        match key.code {
            KeyCode::Esc => return,
            KeyCode::Char('c') if key.modifiers.contains(KeyModifiers::CONTROL) => return,
            KeyCode::Enter => {
                let situation = self.situation(seen, now);
                if line.trim().is_empty() {
                    return;
                }
                // What has changed since the line was opened counts.
                match keys::refusal(Wish::Line, situation) {
                    Some(words) => self.answer(&words, Tone::Care),
                    None => {
                        self.asks.push(Ask::Line(line));
                        return;
                    }
                }
            }
            KeyCode::Backspace => {
                line.pop();
            }
            KeyCode::Char(c)
                if !key
                    .modifiers
                    .intersects(KeyModifiers::CONTROL | KeyModifiers::ALT)
                    && line.len() < LONGEST_LINE =>
            {
                line.push(c);
            }
            _ => {}
        }
        self.open = Open::Line(line);
    }

    /// Does what a key asks, or opens what it needs first.
    fn wish(&mut self, wish: Wish, seen: &Seen, now: Instant) {
        if let Some(words) = keys::refusal(wish, self.situation(seen, now)) {
            return self.answer(&words, Tone::Care);
        }
        match wish {
            Wish::Hold => self.order(Order::Hold, seen, now),
            Wish::Stop => self.order(Order::Stop, seen, now),
            Wish::Resume | Wish::Reset | Wish::Start | Wish::Home => {
                self.open = Open::Named(wish);
            }
            Wish::Modes => self.open = Open::Modes,
            Wish::Line => self.open = Open::Line(String::new()),
            Wish::Help => self.open = Open::Help,
            Wish::Override(what, by) => self.turn(what, by, now),
            Wish::SingleBlock => {
                let is_on = seen.status.unwrap_or_default().flags.single_block;
                let levels = BoardCommand {
                    single_block: Some(!is_on),
                    ..BoardCommand::default()
                };
                self.orders.set(levels, now);
            }
            Wish::Increment(increment) => self.increment = increment,
            Wish::ByHand(way, speed) => self.by_hand(way, speed, seen, now),
            Wish::NextSystem => self.asks.push(Ask::NextSystem),
            Wish::NextTool => self.asks.push(Ask::NextTool),
            Wish::Quit => self.quit = true,
        }
    }

    /// What was named, and is wanted.
    fn carry_out(&mut self, wish: Wish, seen: &Seen, now: Instant) {
        // What has changed since it was named counts.
        if let Some(words) = keys::refusal(wish, self.situation(seen, now)) {
            return self.answer(&words, Tone::Care);
        }
        match wish {
            Wish::Resume => self.order(Order::Resume, seen, now),
            Wish::Reset => self.order(Order::Reset, seen, now),
            Wish::Start => self.order(Order::Run, seen, now),
            Wish::Home => {
                self.homing.begin(now);
                self.order(Order::Home(Axes::NONE), seen, now);
            }
            _ => {}
        }
    }

    fn order(&mut self, order: Order, seen: &Seen, now: Instant) {
        if !self.orders.give(order, seen, now) {
            self.answer(&orders::on_its_way(), Tone::Care);
        }
    }

    fn by_hand(&mut self, way: HandWay, speed: Speed, seen: &Seen, now: Instant) {
        match (way, self.mode(seen)) {
            (HandWay::Axis(way), Some(OperatingMode::Step)) => match self.increment.of_slide(way) {
                Ok(slide) => self.hand.step(way.on_z, slide, seen, now),
                Err(mistake) => self.answer(&mistake.0, Tone::Care),
            },
            _ => self.hand.press(way, speed == Speed::Rapid, seen, now),
        }
    }

    /// Turns an override by so many percent.
    fn turn(&mut self, what: OverrideName, by: i16, now: Instant) {
        let Some((record, _)) = self.record else {
            return;
        };
        let (low, high) = what.range();
        let (index, present) = match what {
            OverrideName::Feed => (0, record.feed_percent),
            OverrideName::Rapid => (1, record.rapid_percent),
            OverrideName::Spindle => (2, record.spindle_percent),
        };
        let just_sent = |sent: &&(u8, Instant)| now < sent.1 + JUST_SENT;
        let slot = self.sent.get(index).and_then(Option::as_ref);
        let present = slot.filter(just_sent).map_or(present, |sent| sent.0);
        let wanted = (i16::from(present) + by).clamp(i16::from(low), i16::from(high));
        let wanted = u8::try_from(wanted).unwrap_or(present);
        if let Some(slot) = self.sent.get_mut(index) {
            *slot = Some((wanted, now));
        }
        let mut levels = BoardCommand::default();
        match what {
            OverrideName::Feed => levels.feed = Some(wanted),
            OverrideName::Rapid => levels.rapid = Some(wanted),
            OverrideName::Spindle => levels.spindle = Some(wanted),
        }
        self.orders.set(levels, now);
    }

    /// Notes when a status came, and whether the board has started again.
    fn hear(&mut self, seen: &Seen, now: Instant) {
        if self
            .boots
            .replace(seen.boots)
            .is_some_and(|boots| boots != seen.boots)
        {
            self.take_back(seen);
        }
        if seen.statuses != self.statuses.0 {
            self.statuses = (seen.statuses, Some(now));
        }
    }

    /// What was ordered, named or typed before the board has started again is for nobody, and nothing is known of it.
    fn take_back(&mut self, seen: &Seen) {
        self.hand.forget();
        self.orders.forget();
        self.homing = Homing::default();
        self.record = None;
        self.statuses = (seen.statuses, None);
        self.asked = None;
        self.open = Open::Nothing;
        self.sent = [None; 3];
        self.asks.clear();
        self.answer(&orders::restarted(), Tone::Care);
    }

    /// What is to be sent now.
    pub fn frames(&mut self, seen: &Seen, now: Instant) -> Vec<Frame> {
        self.hear(seen, now);
        let mut frames = Vec::new();
        let status = seen.status.unwrap_or_default();
        frames.extend(self.homing.frame(status.state, now));
        let asked = self.asked.map(|(beat, _)| beat);
        let beat = seen.beat.map(|told| told.beat).or(asked);
        frames.extend(self.orders.frame(seen, beat, now));
        frames.extend(self.hand.frame(seen, now));
        self.tell_ends();
        frames
    }

    /// Tells how orders and presses have ended, where that is worth a word.
    fn tell_ends(&mut self) {
        match self.orders.outcome() {
            Some(Outcome::Taken(order)) if order.needs_echo() => self.asks.push(Ask::Refusal),
            Some(outcome) => {
                let tone = match outcome {
                    Outcome::Unconfirmed(_) => Tone::Bad,
                    Outcome::Taken(_) | Outcome::Overtaken(_) => Tone::Care,
                };
                if let Some(words) = outcome.words() {
                    self.answer(&words, tone);
                }
            }
            None => {}
        }
        if let Some(end) = self.hand.ended() {
            match end.words() {
                Some(words) => self.answer(&words, Tone::Care),
                None => self.asks.push(Ask::NoPress),
            }
        }
    }
}

#[cfg(test)]
mod tests;
