//! What a page that operates sends: orders, frames of a press, and who it is that operates.
//!
//! ```text
//! order ─► right ─► ledger ─► lease ─► machine
//! hold, stop ─► right ─► ledger ────► machine
//! ```
//!
//! The number of an order is used up before anything else is looked at: an order that was refused for want of the lease
//! does not act when it is sent again behind it. This file must not know sockets or a bus.

use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use crate::feed::Feed;
use crate::lease::{self, Lease, Wish};
use crate::ledger::{Answer, Entry, Ledger};
use crate::machine::{Jog, Machine, Order};
use crate::refusal::Refusal;

const OK: &str = "200 OK";
/// The longest name that a page gives itself.
const NAME: usize = 64;
/// An order that is sent again while it is being done waits so long for its answer.
const UNDER_WAY: Duration = Duration::from_secs(10);

/// All that is posted comes here.
pub struct Posted {
    machine: Arc<dyn Machine>,
    feed: Arc<Feed>,
    state: Mutex<State>,
    answered: Condvar,
}

#[derive(Default)]
struct State {
    ledger: Ledger,
    lease: Lease,
    /// What all pages were told of the lease.
    told: Option<(Option<u64>, Option<u64>)>,
}

impl Posted {
    pub fn new(machine: Arc<dyn Machine>, feed: Arc<Feed>) -> Self {
        Self {
            machine,
            feed,
            state: Mutex::default(),
            answered: Condvar::new(),
        }
    }

    /// `{c, n, op, args, echo}` of who has this cookie.
    pub fn order(&self, cookie: &str, body: &[u8]) -> Result<Answer, Refusal> {
        let body = parsed(body)?;
        let client = client(cookie, &body)?;
        let number = body["n"].as_u64().ok_or(Refusal::Malformed)?;
        let order = order_of(&body).ok_or(Refusal::Malformed)?;
        let halts = order.halts();
        let mut state = self.state();
        let operator = state.lease.operator().map(str::to_owned);
        match state
            .ledger
            .begin(&client, number, halts, operator.as_deref())
        {
            Entry::Older => return Err(Refusal::Older),
            Entry::Again(Some(answer)) => return Ok(answer),
            Entry::Again(None) => return self.awaited(state, &client, number, halts),
            Entry::New => {}
        }
        let operates = halts || state.lease.is_of(&client, Instant::now());
        drop(state);
        let answer = if operates {
            match self.machine.order(&order) {
                Some(text) => (OK, text),
                None => refused(Refusal::Malformed),
            }
        } else {
            refused(Refusal::NotOperating)
        };
        self.state().ledger.end(&client, number, halts, &answer);
        self.answered.notify_all();
        Ok(answer)
    }

    /// The answer to an order that has come before and is being done.
    fn awaited(
        &self,
        mut state: MutexGuard<'_, State>,
        client: &str,
        number: u64,
        halts: bool,
    ) -> Result<Answer, Refusal> {
        let end = Instant::now() + UNDER_WAY;
        loop {
            let left = end.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return Err(Refusal::Busy);
            }
            (state, _) = self
                .answered
                .wait_timeout(state, left)
                .unwrap_or_else(PoisonError::into_inner);
            match state.ledger.begin(client, number, halts, None) {
                Entry::Again(Some(answer)) => return Ok(answer),
                Entry::Again(None) => {}
                Entry::New | Entry::Older => return Err(Refusal::Older),
            }
        }
    }

    /// `{c, press, axes, spindle, rapid, speed, echo}`: one frame.
    pub fn jog(&self, cookie: &str, body: &[u8]) -> Result<Answer, Refusal> {
        let body = parsed(body)?;
        let client = client(cookie, &body)?;
        let jog = jog_of(&body).ok_or(Refusal::Malformed)?;
        let now = Instant::now();
        let mut state = self.state();
        if !state.lease.is_of(&client, now) {
            return Err(Refusal::NotOperating);
        }
        state.lease.press(jog.is_held(), now);
        drop(state);
        Ok((OK, self.machine.jog(&jog)))
    }

    /// `{c, do}`: the page operates, wants to, or does not any more.
    pub fn lease(&self, cookie: &str, body: &[u8]) -> Result<Answer, Refusal> {
        let body = parsed(body)?;
        let client = client(cookie, &body)?;
        let wish = match body["do"].as_str() {
            Some("keep") => Wish::Keep,
            Some("take") => Wish::Take,
            Some("give") => Wish::Give,
            _ => return Err(Refusal::Malformed),
        };
        let answer = self.state().lease.ask(&client, wish, Instant::now());
        self.tell();
        let text = match answer {
            lease::Answer::Yours(number) => json!({"yours": number}),
            lease::Answer::Notice(left) => {
                json!({"notice_ms": u64::try_from(left.as_millis()).unwrap_or(u64::MAX)})
            }
            lease::Answer::NotYours => json!({}),
        };
        Ok((OK, text.to_string()))
    }

    /// Tells all pages who operates, where it has changed.
    pub fn tell(&self) {
        let mut state = self.state();
        let told = state.lease.told(Instant::now());
        if state.told != Some(told) {
            state.told = Some(told);
            let (number, notice) = told;
            self.feed.tell(
                "lease",
                json!({"number": number, "notice_s": notice}).to_string(),
            );
        }
    }

    /// The cookie of the page that operates.
    pub fn operator(&self) -> Option<String> {
        let state = self.state();
        let (cookie, _) = state.lease.operator()?.split_once('/')?;
        Some(cookie.to_owned())
    }

    /// Nobody operates any more, and all pages are told.
    pub fn release(&self) {
        self.state().lease.end();
        self.tell();
    }

    fn state(&self) -> MutexGuard<'_, State> {
        // Nothing panics with it in hand; the numbers in it are whole all the same.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Whether this is hold or stop; anything else has no place among few.
pub fn halts(body: &[u8]) -> bool {
    let order = parsed(body).ok().and_then(|body| order_of(&body));
    order.is_some_and(|order| order.halts())
}

fn refused(refusal: Refusal) -> Answer {
    (refusal.status(), refusal.json())
}

fn parsed(body: &[u8]) -> Result<Value, Refusal> {
    serde_json::from_slice(body).map_err(|_| Refusal::Malformed)
}

/// A page, by its cookie and the name that it has given itself.
fn client(cookie: &str, body: &Value) -> Result<String, Refusal> {
    let name = body["c"].as_str().ok_or(Refusal::Malformed)?;
    let fits = (1..=NAME).contains(&name.len());
    fits.then(|| format!("{cookie}/{name}"))
        .ok_or(Refusal::Malformed)
}

fn echo_of(body: &Value) -> Option<u16> {
    body["echo"].as_u64().and_then(|echo| echo.try_into().ok())
}

fn order_of(body: &Value) -> Option<Order> {
    Some(Order {
        op: body["op"].as_str()?.to_owned(),
        args: body["args"].clone(),
        echo: echo_of(body),
    })
}

fn jog_of(body: &Value) -> Option<Jog> {
    let way = |told: &Value| -> Option<i8> {
        let way = told.as_i64()?;
        (-1..=1).contains(&way).then_some(way as i8)
    };
    let jog = Jog {
        press: body["press"].as_u64()?.try_into().ok()?,
        axes: [way(&body["axes"][0])?, way(&body["axes"][1])?],
        spindle: way(&body["spindle"])?,
        rapid: body["rapid"].as_bool()?,
        speed: body["speed"].as_u64()?.try_into().ok()?,
        echo: echo_of(body)?,
    };
    // A frame on the bus has one speed, and a spindle has no rapid: the board would drop it without a word.
    (jog.spindle == 0 || jog.axes == [0; 2] && !jog.rapid).then_some(jog)
}

#[cfg(test)]
mod tests;
