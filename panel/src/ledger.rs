//! The numbers of orders: each acts once, however often it comes, and none after a newer one.
//!
//! Values in, answers out. This file must not know sockets, time, who may order, or what an order does.

use std::collections::VecDeque;

/// Clients whose numbers are kept; the one that has ordered least lately is forgotten.
const CLIENTS: usize = 64;

/// What was answered to an order: its HTTP status, and its text.
pub type Answer = (&'static str, String);

/// What is to be done with an order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Entry {
    /// It is new: it has to be done, and its answer [kept](Ledger::end).
    New,
    /// It has come before, and was answered so; `None`: it is being done.
    Again(Option<Answer>),
    /// A newer one has come before.
    Older,
}

/// The newest order of one kind: its number, and its answer once it has one.
#[derive(Clone, Debug, Default)]
struct Last {
    number: u64,
    answer: Option<Answer>,
}

#[derive(Debug)]
struct Client {
    name: String,
    order: Last,
    halt: Last,
}

/// The newest numbers of all clients.
#[derive(Debug, Default)]
pub struct Ledger(VecDeque<Client>);

impl Ledger {
    /// Enters an order. Hold and stop (`halts`) are never older than what starts something, and what starts something may
    /// be older than they are: a start that was sent before a hold and comes after it starts nothing. `operator` is never
    /// forgotten.
    pub fn begin(&mut self, name: &str, number: u64, halts: bool, operator: Option<&str>) -> Entry {
        let found = self.0.iter().position(|client| client.name == name);
        let mut client = match found.and_then(|at| self.0.remove(at)) {
            Some(client) => client,
            None => {
                if self.0.len() >= CLIENTS {
                    let idle = |client: &Client| Some(client.name.as_str()) != operator;
                    let oldest = self.0.iter().position(idle);
                    oldest.and_then(|at| self.0.remove(at));
                }
                Client {
                    name: name.to_owned(),
                    order: Last::default(),
                    halt: Last::default(),
                }
            }
        };
        let (own, floor) = if halts {
            (&mut client.halt, 0)
        } else {
            (&mut client.order, client.halt.number)
        };
        let entry = if number == own.number && number != 0 {
            Entry::Again(own.answer.clone())
        } else if number < own.number || number <= floor {
            Entry::Older
        } else {
            *own = Last {
                number,
                answer: None,
            };
            Entry::New
        };
        self.0.push_back(client);
        entry
    }

    /// Keeps the answer to an order.
    pub fn end(&mut self, name: &str, number: u64, halts: bool, answer: &Answer) {
        let Some(client) = self.0.iter_mut().find(|client| client.name == name) else {
            return;
        };
        let own = if halts {
            &mut client.halt
        } else {
            &mut client.order
        };
        if own.number == number {
            own.answer = Some(answer.clone());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn answer(text: &str) -> Answer {
        ("200 OK", text.to_owned())
    }

    #[test]
    fn an_order_acts_once_and_none_behind_a_newer_one() {
        let mut ledger = Ledger::default();
        let mut begin = |name: &str, number| ledger.begin(name, number, false, None);
        assert_eq!(begin("a", 0), Entry::Older);
        assert_eq!(begin("a", 3), Entry::New);
        assert_eq!(begin("a", 3), Entry::Again(None));
        assert_eq!(begin("a", 2), Entry::Older);
        assert_eq!(begin("b", 2), Entry::New);
        ledger.end("a", 3, false, &answer("x"));
        // Too late, for nobody.
        ledger.end("a", 2, false, &answer("y"));
        ledger.end("c", 1, false, &answer("y"));
        let again = Entry::Again(Some(answer("x")));
        assert_eq!(ledger.begin("a", 3, false, None), again);
        assert_eq!(ledger.begin("a", 4, false, None), Entry::New);
        assert_eq!(ledger.begin("a", 3, false, None), Entry::Older);
    }

    #[test]
    fn a_start_that_comes_behind_a_later_hold_starts_nothing_and_no_start_keeps_a_hold_out() {
        let mut ledger = Ledger::default();
        assert_eq!(ledger.begin("a", 7, true, None), Entry::New);
        assert_eq!(ledger.begin("a", 6, false, None), Entry::Older);
        assert_eq!(ledger.begin("a", 9, false, None), Entry::New);
        // A hold that was overtaken by a start holds all the same, once.
        assert_eq!(ledger.begin("a", 8, true, None), Entry::New);
        assert_eq!(ledger.begin("a", 8, true, None), Entry::Again(None));
        assert_eq!(ledger.begin("a", 7, true, None), Entry::Older);
        assert_eq!(ledger.begin("a", 9, false, None), Entry::Again(None));
    }

    #[test]
    fn who_operates_is_not_forgotten_for_others() {
        let mut ledger = Ledger::default();
        for name in ["operator", "other"] {
            assert_eq!(ledger.begin(name, 5, false, None), Entry::New);
        }
        for number in 0..CLIENTS {
            let name = number.to_string();
            let entry = ledger.begin(&name, 1, true, Some("operator"));
            assert_eq!(entry, Entry::New);
        }
        assert_eq!(ledger.0.len(), CLIENTS);
        assert_eq!(ledger.begin("operator", 4, false, None), Entry::Older);
        assert_eq!(ledger.begin("other", 4, false, None), Entry::New);
    }
}
