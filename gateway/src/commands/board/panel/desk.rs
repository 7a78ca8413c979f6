//! What pages order, between the server's threads and the bus.
//!
//! ```text
//! server's threads ─ order, jog ─► desk ─► turn ─► frames, wherever the link waits
//!                  ◄─── answer ───  │ └─ asks ───► the panel's own thread: why an order was refused, lines and programs
//! ```
//!
//! Time and what was heard are arguments of [`Desk::turn`]; nothing here waits for the bus. So no transfer and no page
//! delays a hold. What the machine lets in is judged on the board. This file must not know who orders.

mod asks;

use std::collections::{BTreeMap, VecDeque};
use std::path::Path;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use leadscrew_core::bus::{Beat, BoardState, BoardStatus, Frame, JogRequest, NodeId, Order};
use leadscrew_core::operating::{OperatingMode, PressState, Towards};
use leadscrew_panel::{Claim, Jog, Machine, Programs, Refusal, Sheet, View};

pub use self::asks::{Asks, Line, Program, StartAt, What};
use super::super::monitor::hand::Hand;
use super::super::monitor::homing::Homing;
use super::super::monitor::keys::{self, Situation, Speed};
use super::super::monitor::orders::{self, Orders};
use super::super::monitor::view::OLD;
use super::super::own::Handle;
use super::tables::{Change, Tables, Touching};
use super::views::Views;
use super::wish::Wish;
use crate::cli::{AxisWay, HandWay};
use crate::json::Json;
use crate::link::Seen;
use crate::words::{Both, both};

/// An answer has come within this time: the board has confirmed, and said why not.
const ANSWERED: Duration = Duration::from_secs(10);
/// Frames of presses that wait for the next turn, which comes within milliseconds.
const FRAMES: usize = 8;

/// What became of an order: done, or why not.
pub type Done = Result<(), Both>;

/// One order, and the beat that its page has seen.
struct Asked {
    ticket: u64,
    wish: Wish,
    echo: Option<Beat>,
    /// Holds and stops that were given before it was ordered.
    halts: u64,
    /// The program that it names stays as it is.
    claim: Option<Claim>,
}

struct Shared {
    waiting: VecDeque<Asked>,
    orders: Orders,
    /// Those that the order on its way answers, and the beat that it shows.
    ordered: Option<(Order, Vec<u64>, Option<Beat>)>,
    hand: Hand,
    step: Option<u64>,
    /// The press of which a page has sent frames last.
    pressed: Option<u8>,
    homing: Homing,
    presses: VecDeque<Frame>,
    asks: Asks,
    /// Tickets whose pages still wait, with the answers that are on their way there. What no page waits for must not begin.
    answers: BTreeMap<u64, Option<Done>>,
    tickets: u64,
    /// The number of statuses heard, and when the last one came.
    statuses: (u64, Option<Instant>),
    /// The newest of what was heard.
    told: Told,
    /// A command in a process of its own is asked for, or under way.
    typed: bool,
    /// That process.
    own: Option<Handle>,
    /// Holds and stops that were given.
    halts: u64,
    /// Why nothing is ordered: the board is not heard.
    lost: Option<Both>,
    /// The last start of the board, by the number of its boot-up messages.
    boots: u32,
    /// How often all that was ordered has been taken back, and why the last time.
    taken_back: (u64, Both),
}

/// What a page is told in answer to a frame of a press.
#[derive(Clone, Copy, Default)]
struct Told {
    beat: Option<Beat>,
    mode: Option<OperatingMode>,
    /// Of this side's last press.
    press: Option<(u8, PressState)>,
    status: BoardStatus,
    beats: bool,
}

/// Takes the orders of pages.
pub struct Desk {
    node: NodeId,
    session: u8,
    shared: Mutex<Shared>,
    news: Condvar,
    tables: Tables,
    views: Arc<Views>,
    programs: Option<Arc<Programs>>,
    /// How long a page waits for its answer.
    patience: Duration,
}

impl Desk {
    /// Nothing is ordered. Without a folder there are no programs.
    pub fn new(
        node: NodeId,
        session: u8,
        views: Arc<Views>,
        programs: Option<Arc<Programs>>,
    ) -> Self {
        Self {
            node,
            session,
            shared: Mutex::new(Shared {
                waiting: VecDeque::new(),
                orders: Orders::new(node),
                ordered: None,
                hand: Hand::new(node, session),
                step: None,
                pressed: None,
                homing: Homing::default(),
                presses: VecDeque::new(),
                asks: Asks::default(),
                answers: BTreeMap::new(),
                tickets: 0,
                statuses: (0, None),
                told: Told::default(),
                typed: false,
                own: None,
                halts: 0,
                lost: None,
                boots: 0,
                taken_back: (0, Both::default()),
            }),
            news: Condvar::new(),
            tables: Tables::new(Arc::clone(&views)),
            views,
            programs,
            patience: ANSWERED,
        }
    }

    fn shared(&self) -> MutexGuard<'_, Shared> {
        // What a panic has left is asked again by a person; the board moves nothing by it.
        self.shared.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Has what pages have ordered act, and gives the frames that follow.
    pub fn turn(&self, seen: &Seen, now: Instant) -> Vec<Frame> {
        let mut shared = self.shared();
        if shared.boots != seen.boots {
            shared.boots = seen.boots;
            self.take_back(&mut shared, orders::restarted());
        }
        shared.hear(seen, self.session, now);
        while let Some(asked) = shared.waiting.pop_front() {
            shared.begin(asked, seen, now);
        }
        let status = seen.status.unwrap_or_default();
        let mut frames: Vec<Frame> = shared.homing.frame(status.state, now).into_iter().collect();
        let echo = shared.ordered.as_ref().and_then(|(.., echo)| *echo);
        frames.extend(shared.orders.frame(seen, echo, now));
        frames.extend(shared.hand.frame(seen, now));
        frames.extend(shared.presses.drain(..));
        shared.end();
        drop(shared);
        self.news.notify_all();
        frames
    }

    /// The board is not heard: whatever was ordered is taken back, and nothing is ordered until it is found.
    pub fn lose(&self, why: Both) {
        let mut shared = self.shared();
        if shared.lost.is_none() {
            self.take_back(&mut shared, why.clone());
        }
        shared.lost = Some(why);
    }

    /// The board is heard, by a link that has heard so many of its boot-up messages.
    pub fn find(&self, boots: u32) {
        let mut shared = self.shared();
        shared.lost = None;
        shared.boots = boots;
    }

    /// Nothing that is on its way is sent any more: those who have ordered it are told why.
    fn take_back(&self, shared: &mut Shared, why: Both) {
        shared.waiting.clear();
        shared.orders.forget();
        shared.ordered = None;
        shared.hand.forget();
        shared.step = None;
        shared.pressed = None;
        shared.homing = Homing::default();
        shared.presses.clear();
        shared.asks = Asks::default();
        shared.typed = shared.own.is_some();
        // It would begin on another start.
        shared.end_unbegun();
        shared.told = Told::default();
        shared.statuses.1 = None;
        shared.taken_back = (shared.taken_back.0 + 1, why);
        self.news.notify_all();
    }

    /// What the panel's own thread is asked; each once.
    pub fn asks(&self) -> Asks {
        let mut shared = self.shared();
        let halts = shared.halts;
        Asks {
            halts,
            ..std::mem::take(&mut shared.asks)
        }
    }

    /// Answers one of those.
    pub fn answer(&self, ticket: u64, done: Done) {
        self.shared().answer(ticket, done);
        self.news.notify_all();
    }

    /// Whether a page still waits for the answer to this.
    pub fn is_awaited(&self, ticket: u64) -> bool {
        self.shared().answers.contains_key(&ticket)
    }

    /// A line or a program has begun, which was asked for with this ticket after so many holds and stops. One that has come
    /// meanwhile ends it, and so does a page that was told meanwhile that nobody has answered. Any other page is told here:
    /// from now on it cannot be told otherwise.
    pub fn note_begun(&self, ticket: u64, handle: Handle, halts: u64) {
        let mut shared = self.shared();
        if shared.halts != halts || !shared.answers.contains_key(&ticket) {
            handle.interrupt();
        }
        shared.own = Some(handle);
        shared.answer(ticket, Ok(()));
        drop(shared);
        self.news.notify_all();
    }

    /// No line and no program is under way any more.
    pub fn note_ended(&self) {
        let mut shared = self.shared();
        shared.own = None;
        shared.typed = false;
    }

    /// Takes what a board that sends no beat was asked.
    pub fn note_asked(&self, beat: Beat, mode: OperatingMode) {
        let told = &mut self.shared().told;
        told.beat = Some(beat);
        told.mode = Some(mode);
    }

    /// The panel ends: no line and no program begins after it, and a change of a table that is under way is waited for
    /// [D537].
    pub fn settle(&self) {
        let shared = self.shared();
        // Of a board that is not heard nobody knows what it has begun; what it had not by then has ended already.
        if shared.lost.is_none() {
            shared.end_unbegun();
        }
        drop(shared);
        self.tables.settle();
    }

    /// The newest beat, and this side's last press.
    pub fn beat(&self, json: &mut Json) {
        self.shared().told.fields(json);
    }

    /// Keeps the program of this tag as it is. It waits for the disk.
    fn claim(&self, name: &str, tag: &str) -> Result<Claim, Both> {
        let programs = self.programs.as_ref().ok_or(Refusal::NoStore);
        let claim = programs.and_then(|programs| programs.claim(name, tag));
        claim.map_err(|refusal| {
            let [en, zh] = refusal.words().map(str::to_owned);
            Both { en, zh }
        })
    }

    fn order_wish(&self, wish: Wish, echo: Option<Beat>) -> Done {
        let mut shared = self.shared();
        shared.tickets += 1;
        if let Some(why) = &shared.lost {
            return Err(why.clone());
        }
        let (ticket, halts) = (shared.tickets, shared.halts);
        let (before, _) = shared.taken_back;
        let mut claim = None;
        if let Wish::Program { name, tag, .. } = &wish {
            if shared.typed {
                return Err(keys::under_way());
            }
            // In the thread of whoever has ordered it: neither the bus nor a hold waits for a disk.
            drop(shared);
            claim = Some(self.claim(name, tag)?);
            shared = self.shared();
            let (count, why) = &shared.taken_back;
            if *count != before {
                return Err(why.clone());
            }
        }
        let asked = Asked {
            ticket,
            wish,
            echo,
            halts,
            claim,
        };
        shared.answers.insert(ticket, None);
        // Hold and stop are not behind what others have ordered in the same moment.
        if asked.wish.halts() {
            shared.waiting.push_front(asked);
        } else {
            shared.waiting.push_back(asked);
        }
        let unanswered = |shared: &mut Shared| {
            let answered = shared.answers.get(&ticket).is_some_and(Option::is_some);
            !answered && shared.taken_back.0 == before
        };
        let (mut shared, _) = self
            .news
            .wait_timeout_while(shared, self.patience, unanswered)
            .unwrap_or_else(PoisonError::into_inner);
        let done = shared.forsake(ticket);
        done.unwrap_or_else(|| match &shared.taken_back {
            (count, why) if *count != before => Err(why.clone()),
            _ => Err(both!(
                "the board has not answered to the order: look at the machine",
                "控制板对指令没有应答：请查看机床"
            )),
        })
    }
}

impl Shared {
    fn hear(&mut self, seen: &Seen, session: u8, now: Instant) {
        if seen.statuses != self.statuses.0 {
            self.statuses = (seen.statuses, Some(now));
        }
        self.told.status = seen.status.unwrap_or_default();
        if let Some(told) = seen.beat {
            self.told.beats = true;
            self.told.beat = Some(told.beat);
            self.told.mode = Some(told.mode);
            let own = told.session == session;
            let before = self.told.press;
            self.told.press = own.then_some((told.press, told.state));
            // What a board has refused it does not take up again, so its page is told once.
            let refused = self.pressed.map(|press| (press, PressState::Refused));
            self.asks.press |=
                self.told.press != before && refused.is_some() && self.told.press == refused;
        }
    }

    /// Answers a page that still waits.
    fn answer(&mut self, ticket: u64, done: Done) {
        if let Some(answer) = self.answers.get_mut(&ticket) {
            *answer = Some(done);
        }
    }

    /// Has the board asked whether it has refused this, for a page that still waits.
    fn ask_reason(&mut self, ticket: u64) {
        if self.answers.contains_key(&ticket) {
            self.asks.reasons.push(ticket);
        }
    }

    /// Nobody waits for this any more: what is not begun yet must not begin. Gives the answer, if it has come.
    fn forsake(&mut self, ticket: u64) -> Option<Done> {
        self.waiting.retain(|asked| asked.ticket != ticket);
        let asks = &mut self.asks;
        let before = asks.lines.len() + asks.programs.len();
        asks.lines.retain(|line| line.ticket != ticket);
        asks.programs.retain(|program| program.ticket != ticket);
        asks.reasons.retain(|asked| *asked != ticket);
        if asks.lines.len() + asks.programs.len() < before {
            self.typed = false;
        }
        self.answers.remove(&ticket).flatten()
    }

    fn situation(&self, now: Instant) -> Situation {
        let (_, at) = self.statuses;
        let status = self.told.status;
        Situation {
            mode: self.told.mode,
            state: status.state,
            program: status.flags.program,
            hold: status.flags.hold,
            old: at.is_none_or(|at| now.saturating_duration_since(at) > OLD),
            beats: self.told.beats,
            tells_release: true,
            typed: self.typed,
        }
    }

    /// Whether a page with this beat, or this side, knows too little to order anything but hold, stop and reset.
    fn is_old(&self, echo: Option<Beat>, now: Instant) -> bool {
        let age = self.told.beat.zip(echo);
        let age = age.and_then(|(newest, echo)| newest.age_of(echo));
        self.situation(now).old || age.is_none_or(|ms| Duration::from_millis(u64::from(ms)) > OLD)
    }

    /// Why no table is changed by what a page with this beat has seen.
    fn no_change(&self, echo: Option<Beat>, now: Instant) -> Option<Both> {
        let old = || self.is_old(echo, now).then(keys::old);
        self.lost.clone().or_else(old)
    }

    /// What the machine has begun finds its end by itself; what is still checked or sent does not begin any more.
    fn end_unbegun(&self) {
        let begun = self.told.status.flags.program;
        if let Some(own) = self.own.as_ref().filter(|_| !begun) {
            own.interrupt();
        }
    }

    /// A machine at rest takes no notice of a hold: what is being checked or sent would begin after it.
    fn halt(&mut self) {
        self.halts += 1;
        let lines = self.asks.lines.drain(..).map(|line| line.ticket);
        let programs = self.asks.programs.drain(..).map(|program| program.ticket);
        let waiting: Vec<u64> = lines.chain(programs).collect();
        for ticket in waiting {
            self.answer(ticket, Err(halted()));
            self.typed = false;
        }
        let status = self.told.status;
        let is_at_rest = status.state == BoardState::Idle;
        if let Some(own) = self.own.as_ref().filter(|_| is_at_rest) {
            own.interrupt();
        }
    }

    /// Asks it of the panel's own thread, where nothing keeps it from that.
    fn ask(&mut self, ticket: u64, why: Option<Both>, put: impl FnOnce(&mut Asks)) {
        if let Some(why) = why {
            self.answer(ticket, Err(why));
            return;
        }
        self.typed = true;
        put(&mut self.asks);
    }

    fn begin(&mut self, asked: Asked, seen: &Seen, now: Instant) {
        let Asked {
            ticket,
            wish,
            echo,
            halts,
            claim,
        } = asked;
        if wish.halts() {
            self.halt();
        }
        // What a hold or a stop has overtaken would begin after it.
        if wish.begins() && halts != self.halts {
            self.answer(ticket, Err(halted()));
            return;
        }
        if wish.needs_fresh() && self.is_old(echo, now) {
            self.answer(ticket, Err(keys::old()));
            return;
        }
        match wish {
            Wish::Order(order) => self.give(order, ticket, echo, seen, now),
            Wish::Levels(levels) => {
                self.orders.set(levels, now);
                self.answer(ticket, Ok(()));
            }
            Wish::Step(way, length) => match length.of_slide(way) {
                _ if self.step.is_some() => {
                    self.answer(ticket, Err(orders::on_its_way()));
                }
                Ok(slide) => {
                    self.hand.step(way.on_z, slide, seen, now);
                    // Its own order is answered.
                    self.pressed = None;
                    self.step = Some(ticket);
                }
                Err(mistake) => {
                    self.answer(ticket, Err(mistake.0));
                }
            },
            Wish::Line { text, zh } => {
                let why = keys::refusal(keys::Wish::Line, self.situation(now));
                let what = What::Line(text);
                self.ask(ticket, why, |asks| {
                    asks.lines.push(Line { ticket, what, zh });
                });
            }
            Wish::Retract { speed, zh } => {
                let why = keys::no_program(self.situation(now));
                let what = What::Retract(speed);
                self.ask(ticket, why, |asks| {
                    asks.lines.push(Line { ticket, what, zh });
                });
            }
            Wish::Program {
                name,
                tag,
                start,
                wheel,
                zh,
            } => {
                let why = keys::no_program(self.situation(now));
                // Each has one.
                let Some(claim) = claim else { return };
                self.ask(ticket, why, |asks| {
                    asks.programs.push(Program {
                        ticket,
                        name,
                        tag,
                        claim,
                        start,
                        wheel,
                        zh,
                    });
                });
            }
        }
    }

    fn give(&mut self, order: Order, ticket: u64, echo: Option<Beat>, seen: &Seen, now: Instant) {
        // A hold adds nothing to a hold or a stop that is on its way, and must not take the place of the stop.
        if let Some((under_way, tickets, _)) = &mut self.ordered
            && (*under_way == order || (*under_way, order) == (Order::Stop, Order::Hold))
            && matches!(order, Order::Hold | Order::Stop)
        {
            tickets.push(ticket);
            return;
        }
        if !self.orders.give(order, seen, now) {
            self.answer(ticket, Err(orders::on_its_way()));
            return;
        }
        if let Some((_, replaced, _)) = self.ordered.replace((order, vec![ticket], echo)) {
            for ticket in replaced {
                self.answer(ticket, Err(halted()));
            }
        }
        if matches!(order, Order::Home(_)) {
            self.homing.begin(now);
        }
    }

    /// Tells what has come to its end.
    fn end(&mut self) {
        if let Some(outcome) = self.orders.outcome()
            && let Some((order, tickets, _)) = self.ordered.take()
        {
            for ticket in tickets {
                match outcome.words() {
                    None if order.needs_echo() => self.ask_reason(ticket),
                    None => {
                        self.answer(ticket, Ok(()));
                    }
                    Some(words) => {
                        self.answer(ticket, Err(words));
                    }
                }
            }
        }
        if let Some(ticket) = self.step.take_if(|_| self.hand.is_idle()) {
            match self.hand.ended().map(|end| end.words()) {
                None => {
                    self.answer(ticket, Ok(()));
                }
                Some(Some(words)) => {
                    self.answer(ticket, Err(words));
                }
                Some(None) => self.ask_reason(ticket),
            }
        }
    }

    /// Why this frame of a press is not passed on; a release always is.
    fn no_press(&self, jog: &Jog, now: Instant) -> Option<Both> {
        let axes = ways(jog).into_iter().flatten().map(HandWay::Axis);
        let spindle = towards(jog.spindle).map(HandWay::Spindle);
        let mut why = axes.chain(spindle).filter_map(|way| {
            let wish = keys::Wish::ByHand(way, Speed::Feed);
            keys::refusal(wish, self.situation(now))
        });
        why.next()
    }
}

impl Told {
    fn fields(&self, json: &mut Json) {
        match self.beat {
            Some(beat) => json.integer("beat", i64::from(beat.ms())),
            None => json.null("beat"),
        }
        match self.press {
            Some((press, state)) => {
                json.integer("press", i64::from(press));
                json.text(
                    "pressed",
                    match state {
                        PressState::None => "none",
                        PressState::Runs => "runs",
                        PressState::Ended => "ended",
                        PressState::Limit => "limit",
                        PressState::Refused => "refused",
                    },
                );
            }
            None => {
                json.null("press");
                json.null("pressed");
            }
        }
    }
}

impl Machine for Desk {
    fn order(&self, order: &leadscrew_panel::Order) -> Option<String> {
        let echo = order.echo.map(Beat::new);
        if let Some(change) = Change::of(&order.op, &order.args) {
            return Some(self.change(&change, echo));
        }
        if let Some(touching) = Touching::of(&order.op, &order.args) {
            return Some(self.touch(&touching, echo));
        }
        if order.op == "retract" && order.args["look"] == true {
            return Some(super::retract::shown(&self.tables.global(false)));
        }
        let wish = Wish::of(&order.op, &order.args)?;
        let done = self.order_wish(wish, echo);
        Some(super::object(|json| fields(json, &done)))
    }

    fn jog(&self, jog: &Jog) -> String {
        self.press(jog, Instant::now())
    }

    fn view(&self, program: &Path, view: View, zh: bool) -> String {
        self.views.of(program, view, zh)
    }

    fn sheet(&self, sheet: Sheet, zh: bool) -> String {
        self.tables.sheet(sheet, zh)
    }
}

impl Desk {
    /// It waits for the bus in the thread of whoever has ordered it, so everybody else goes on.
    fn change(&self, change: &Change, echo: Option<Beat>) -> String {
        let shared = self.shared();
        let (before, _) = shared.taken_back;
        let why = shared.no_change(echo, Instant::now());
        drop(shared);
        match why {
            Some(why) => super::object(|json| fields(json, &Err(why))),
            None => self.tables.change(change, &|| self.taken_back(before)),
        }
    }

    /// The same of a tool that is touched off.
    fn touch(&self, touching: &Touching, echo: Option<Beat>) -> String {
        let shared = self.shared();
        let (before, _) = shared.taken_back;
        let now = Instant::now();
        let why = shared.no_change(echo, now);
        let why = why.or_else(|| keys::no_touch(shared.situation(now)));
        drop(shared);
        match why {
            Some(why) => super::object(|json| fields(json, &Err(why))),
            None => self.tables.touch(touching, &|| self.taken_back(before)),
        }
    }

    /// Why what was ordered then does not hold any more.
    fn taken_back(&self, before: u64) -> Option<Both> {
        let shared = self.shared();
        let (count, why) = &shared.taken_back;
        (*count != before).then(|| why.clone())
    }

    fn press(&self, jog: &Jog, now: Instant) -> String {
        let mut shared = self.shared();
        let why = shared.lost.clone().or_else(|| shared.no_press(jog, now));
        if why.is_none() && shared.presses.len() < FRAMES {
            let [x, z] = ways(jog).map(|way| way.map(|way| way.towards));
            let frame = JogRequest {
                session: self.session,
                press: jog.press,
                x,
                z,
                spindle: towards(jog.spindle),
                rapid: jog.rapid,
                speed: jog.speed,
                echo: Beat::new(jog.echo),
            };
            shared.pressed = Some(jog.press);
            shared.presses.push_back(frame.frame(self.node));
        }
        let told = shared.told;
        drop(shared);
        super::object(|json| {
            fields(json, &why.map_or(Ok(()), Err));
            told.fields(json);
        })
    }
}

/// Which way each axis of a press goes.
fn ways(jog: &Jog) -> [Option<AxisWay>; 2] {
    let way = |on_z, way| {
        let towards = towards(way)?;
        Some(AxisWay { on_z, towards })
    };
    let [x, z] = jog.axes;
    [way(false, x), way(true, z)]
}

const fn towards(way: i8) -> Option<Towards> {
    match way {
        0 => None,
        1.. => Some(Towards::Plus),
        _ => Some(Towards::Minus),
    }
}

/// An order in whose place a hold or a stop was given.
fn halted() -> Both {
    both!(
        "a hold or a stop has taken the place of this order",
        "进给保持或停止已取代此指令"
    )
}

/// What a page is told of an order.
pub fn fields(json: &mut Json, done: &Done) {
    json.flag("ok", done.is_ok());
    if let Err(words) = done {
        json.text("en", &words.en);
        json.text("zh", &words.zh);
    }
}

#[cfg(test)]
mod tests;
