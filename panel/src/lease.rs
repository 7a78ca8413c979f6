//! Who operates: one page at a time, for as long as it says so, and with a notice before another takes its place.
//!
//! Values in, answers out; time is an argument. This file must not know sockets, sessions or a machine. Hold and stop do
//! not ask it.

use std::time::{Duration, Instant};

/// A lease lasts so long from the last time that its page has said so.
const LASTS: Duration = Duration::from_secs(5);
/// Who takes the lease of another waits for so long.
pub const NOTICE: Duration = Duration::from_secs(3);
/// A press lasts at least so long from its last frame; it is renewed every 25 ms.
const PRESS: Duration = Duration::from_millis(300);

/// What a page asks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wish {
    /// It goes on with what it has, and takes nothing.
    Keep,
    /// It wants to operate.
    Take,
    /// It does not operate any more.
    Give,
}

/// What it is told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// It operates, by the lease of this number.
    Yours(u64),
    /// It will, after this time, if it goes on asking.
    Notice(Duration),
    /// It does not.
    NotYours,
}

#[derive(Clone, Debug)]
struct Holder {
    client: String,
    until: Instant,
    number: u64,
}

#[derive(Clone, Debug)]
struct Taker {
    client: String,
    from: Instant,
    until: Instant,
}

/// The lease.
#[derive(Debug, Default)]
pub struct Lease {
    holder: Option<Holder>,
    taker: Option<Taker>,
    /// The holder moves axes or turns the spindle by hand, at least until then.
    pressed: Option<Instant>,
    /// Leases that were given.
    count: u64,
}

impl Lease {
    /// Answers a page.
    pub fn ask(&mut self, client: &str, wish: Wish, now: Instant) -> Answer {
        self.pass(now);
        match wish {
            Wish::Give => {
                if self.holds(client) {
                    self.holder = None;
                    self.pressed = None;
                }
                self.taker = self.taker.take().filter(|taker| taker.client != client);
                self.pass(now);
                return Answer::NotYours;
            }
            Wish::Take if self.holder.is_none() => self.grant(client.to_owned(), now),
            Wish::Take if !self.holds(client) => {
                let until = now + LASTS;
                let taker = self.taker.get_or_insert_with(|| Taker {
                    client: client.to_owned(),
                    from: now + NOTICE,
                    until,
                });
                if taker.client == client {
                    taker.until = until;
                    return Answer::Notice(taker.from.saturating_duration_since(now));
                }
                return Answer::NotYours;
            }
            Wish::Keep | Wish::Take => {}
        }
        match &mut self.holder {
            Some(holder) if holder.client == client => {
                holder.until = now + LASTS;
                Answer::Yours(holder.number)
            }
            _ => Answer::NotYours,
        }
    }

    /// Whether this page operates.
    pub fn is_of(&mut self, client: &str, now: Instant) -> bool {
        self.pass(now);
        self.holds(client)
    }

    /// The page that operates.
    pub fn operator(&self) -> Option<&str> {
        self.holder.as_ref().map(|holder| holder.client.as_str())
    }

    /// Nobody operates any more, and nobody waits for it.
    pub fn end(&mut self) {
        (self.holder, self.taker, self.pressed) = (None, None, None);
    }

    /// The page that operates presses, or lets go.
    pub fn press(&mut self, is_down: bool, now: Instant) {
        self.pressed = is_down.then(|| now + PRESS);
    }

    /// What all pages are told: the number of the lease, and the whole seconds until somebody else has it.
    pub fn told(&mut self, now: Instant) -> (Option<u64>, Option<u64>) {
        self.pass(now);
        let left = |taker: &Taker| {
            let left = taker.from.saturating_duration_since(now).as_millis();
            u64::try_from(left).unwrap_or(u64::MAX).div_ceil(1_000)
        };
        let number = self.holder.as_ref().map(|holder| holder.number);
        (number, self.taker.as_ref().map(left))
    }

    fn holds(&self, client: &str) -> bool {
        self.operator() == Some(client)
    }

    fn grant(&mut self, client: String, now: Instant) {
        self.count += 1;
        self.pressed = None;
        self.taker = self.taker.take().filter(|taker| taker.client != client);
        self.holder = Some(Holder {
            client,
            until: now + LASTS,
            number: self.count,
        });
    }

    /// What time does.
    fn pass(&mut self, now: Instant) {
        self.holder = self.holder.take().filter(|holder| now < holder.until);
        self.taker = self.taker.take().filter(|taker| now < taker.until);
        let pressed = self.holder.is_some() && self.pressed.is_some_and(|until| now < until);
        let free = self.holder.is_none();
        if let Some(taker) = self
            .taker
            .take_if(|taker| free || now >= taker.from && !pressed)
        {
            self.grant(taker.client, now);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Bench(Lease, Instant);

    impl Bench {
        fn new() -> Self {
            Self(Lease::default(), Instant::now())
        }

        fn at(&self, ms: u64) -> Instant {
            self.1 + Duration::from_millis(ms)
        }

        fn ask(&mut self, client: &str, wish: Wish, ms: u64) -> Answer {
            let now = self.at(ms);
            self.0.ask(client, wish, now)
        }
    }

    fn notice(ms: u64) -> Answer {
        Answer::Notice(Duration::from_millis(ms))
    }

    #[test]
    fn one_page_operates_as_long_as_it_says_so() {
        let mut bench = Bench::new();
        // Nobody gets it who has not asked for it.
        assert_eq!(bench.ask("a", Wish::Keep, 0), Answer::NotYours);
        assert_eq!(bench.ask("a", Wish::Take, 0), Answer::Yours(1));
        assert_eq!(bench.ask("a", Wish::Keep, 4_999), Answer::Yours(1));
        let now = bench.at(9_998);
        assert!(bench.0.is_of("a", now) && !bench.0.is_of("b", now));
        let now = bench.at(9_999);
        assert!(!bench.0.is_of("a", now));
        // What has lapsed is not kept; it is taken anew.
        assert_eq!(bench.ask("a", Wish::Keep, 9_999), Answer::NotYours);
        assert_eq!(bench.ask("b", Wish::Take, 9_999), Answer::Yours(2));
        assert_eq!(bench.ask("b", Wish::Give, 10_000), Answer::NotYours);
        assert_eq!(bench.ask("a", Wish::Take, 10_000), Answer::Yours(3));
    }

    #[test]
    fn another_takes_it_after_a_notice() {
        let mut bench = Bench::new();
        assert_eq!(bench.ask("a", Wish::Take, 0), Answer::Yours(1));
        assert_eq!(bench.ask("b", Wish::Take, 1_000), notice(3_000));
        assert_eq!(bench.ask("c", Wish::Take, 1_000), Answer::NotYours);
        assert_eq!(bench.ask("a", Wish::Keep, 3_000), Answer::Yours(1));
        assert_eq!(bench.ask("b", Wish::Take, 3_999), notice(1));
        let now = bench.at(3_999);
        assert_eq!(bench.0.told(now), (Some(1), Some(1)));
        let now = bench.at(4_000);
        assert_eq!(bench.0.told(now), (Some(2), None));
        assert_eq!(bench.ask("a", Wish::Keep, 4_000), Answer::NotYours);
        assert_eq!(bench.ask("b", Wish::Keep, 4_001), Answer::Yours(2));
        // Who has gone before its time takes nothing.
        assert_eq!(bench.ask("a", Wish::Take, 5_000), notice(3_000));
        assert_eq!(bench.ask("a", Wish::Give, 6_000), Answer::NotYours);
        assert_eq!(bench.ask("b", Wish::Keep, 8_900), Answer::Yours(2));
        // A lease that is given back is theirs who wait for it, at once.
        assert_eq!(bench.ask("a", Wish::Take, 9_000), notice(3_000));
        assert_eq!(bench.ask("b", Wish::Give, 9_001), Answer::NotYours);
        assert_eq!(bench.ask("a", Wish::Keep, 9_002), Answer::Yours(3));
    }

    #[test]
    fn a_lease_that_is_ended_is_nobodys_and_who_waited_for_it_has_to_ask_anew() {
        let mut bench = Bench::new();
        assert_eq!(bench.ask("a", Wish::Take, 0), Answer::Yours(1));
        assert_eq!(bench.ask("b", Wish::Take, 0), notice(3_000));
        let now = bench.at(2_900);
        bench.0.press(true, now);
        bench.0.end();
        assert_eq!(bench.0.told(now), (None, None));
        assert_eq!(bench.ask("a", Wish::Keep, 2_901), Answer::NotYours);
        let now = bench.at(3_000);
        assert_eq!(bench.0.told(now), (None, None));
        assert_eq!(bench.ask("a", Wish::Take, 3_001), Answer::Yours(2));
    }

    #[test]
    fn nobody_takes_it_during_a_press() {
        let mut bench = Bench::new();
        assert_eq!(bench.ask("a", Wish::Take, 0), Answer::Yours(1));
        assert_eq!(bench.ask("b", Wish::Take, 0), notice(3_000));
        let now = bench.at(3_900);
        // The last frame of a press that nobody has let go counts for a moment.
        bench.0.press(true, bench.at(2_900));
        assert_eq!(bench.ask("b", Wish::Take, 3_000), notice(0));
        bench.0.press(true, bench.at(3_190));
        assert_eq!(bench.ask("a", Wish::Keep, 3_489), Answer::Yours(1));
        assert_eq!(bench.ask("b", Wish::Take, 3_489), notice(0));
        bench.0.press(true, bench.at(3_489));
        bench.0.press(false, bench.at(3_490));
        assert_eq!(bench.ask("b", Wish::Take, 3_490), Answer::Yours(2));
        assert!(!bench.0.is_of("a", now));
        // A page that has gone in the middle of a press presses no more.
        bench.0.press(true, bench.at(8_400));
        assert_eq!(bench.ask("a", Wish::Take, 8_489), notice(3_000));
        assert_eq!(bench.ask("a", Wish::Take, 8_490), Answer::Yours(3));
    }
}
