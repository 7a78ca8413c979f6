//! Lines and programs that pages have begun. They stay whatever becomes of the link: each has one of its own.

use std::sync::Arc;

use leadscrew_core::alarm::Lang;
use leadscrew_core::call::Position;
use leadscrew_panel::Feed;

use super::super::monitor::keys;
use super::super::monitor::typed::{self, Typed};
use super::super::monitor::view::Tone;
use super::desk::{Desk, Line, Program, What};
use super::object;
use super::sent::{self, Sent};
use super::views::Views;
use crate::cli::Global;

/// What the panel has whether the board is heard or not.
pub struct Begun<'a> {
    /// The options of the panel.
    pub global: &'a Global,
    /// What pages are told.
    pub feed: Arc<Feed>,
    /// What pages order.
    pub desk: Arc<Desk>,
    /// What is known of programs.
    pub views: Arc<Views>,
    typed: Option<Typed>,
    sent: Option<Sent>,
}

impl<'a> Begun<'a> {
    /// Nothing is under way.
    pub const fn new(
        global: &'a Global,
        feed: Arc<Feed>,
        desk: Arc<Desk>,
        views: Arc<Views>,
    ) -> Self {
        Self {
            global,
            feed,
            desk,
            views,
            typed: None,
            sent: None,
        }
    }

    /// Begins a line or the way out of a hole, asked for after so many holds and stops.
    pub fn begin_line(&mut self, Line { ticket, what, zh }: Line, halts: u64) {
        if !self.desk.is_awaited(ticket) {
            return;
        }
        let lang = if zh { Lang::Zh } else { Lang::En };
        let begun = if self.is_busy() {
            Err(keys::under_way())
        } else {
            let begun = match what {
                What::Line(text) => Typed::begin(self.global, &text, lang),
                What::Retract(speed) => Typed::retract(self.global, speed, lang),
            };
            begun.map_err(|error| typed::not_begun(&error).0)
        };
        match begun {
            Ok(typed) => {
                self.desk.note_begun(ticket, typed.handle(), halts);
                self.typed = Some(typed);
            }
            Err(why) => self.desk.answer(ticket, Err(why)),
        }
    }

    /// The same of a program, which begins with the axes there.
    pub fn begin_program(&mut self, program: Program, from: Option<Position>, halts: u64) {
        let ticket = program.ticket;
        if !self.desk.is_awaited(ticket) {
            return;
        }
        let begun = if self.is_busy() {
            // Whoever hears of it may order the next one at once.
            drop(program);
            Err(keys::under_way())
        } else {
            let of = (self.views.tag(), from);
            Sent::begin(self.global, program, of).inspect(|_| self.views.begin(from))
        };
        match begun {
            Ok(sent) => {
                self.feed.tell("program", sent.told(None));
                self.desk.note_begun(ticket, sent.handle(), halts);
                self.sent = Some(sent);
            }
            Err(why) => self.desk.answer(ticket, Err(why)),
        }
    }

    /// One command of its own is under way at a time.
    const fn is_busy(&self) -> bool {
        self.typed.is_some() || self.sent.is_some()
    }

    /// A line and a program may take long: who has begun it is told of its end as everybody else is. Whoever hears of it
    /// may write the program, or order the next one, at once: so all that it has kept is let go before.
    pub fn end_own(&mut self) {
        let mut ends = [None, None];
        if let Some((words, tone)) = self.typed.as_ref().and_then(Typed::answer) {
            self.typed = None;
            let done = if tone == Tone::Good {
                Ok(words)
            } else {
                Err(words)
            };
            ends[0] = Some(("line", object(|json| sent::end(json, &done))));
        }
        if let Some(sent) = &self.sent
            && let Some(done) = sent.ended()
        {
            ends[1] = Some(("program", sent.told(Some(&done))));
            self.sent = None;
            self.views.begin(None);
        }
        if !self.is_busy() {
            self.desk.note_ended();
        }
        for (event, told) in ends.into_iter().flatten() {
            self.feed.tell(event, told);
        }
    }
}
