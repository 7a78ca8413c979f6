//! The panel stays while its board is not heard, and finds it again by itself.
//!
//! ```text
//! link ─► Side, as long as the board is heard ─► lost: orders and lease are taken back, pages are told
//!   ▲                                                        │
//!   └──────────── opened anew, greeted, read anew ◄──────────┘
//! ```
//!
//! Nothing is ordered by finding it: its switches are as the board has them, and nobody operates. This must not know what
//! is read of a board.

use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use leadscrew_panel::Server;

use super::super::heard;
use super::super::monitor::finding::{AGAIN, why};
use super::begun::Begun;
use super::{Side, object};
use crate::failure::{Failure, Outcome};
use crate::interrupt;
use crate::link::Link;
use crate::words::{Both, both};

/// Between two looks at what goes on without a board.
const GLANCE: Duration = Duration::from_millis(50);

/// Gives out the page until it is interrupted, whether the board of this link is heard or not.
pub fn carry_out(mut begun: Begun<'_>, server: &Server, link: Link) -> Outcome {
    let mut link = Some(link);
    // One that greets and cannot be read has not been heard meanwhile.
    let mut silent: Option<SystemTime> = None;
    while let Some(own) = link.take() {
        let failure = match Side::new(&mut begun, own) {
            Err(failure) => failure,
            Ok(mut side) => {
                // Who had the lease before looks at the machine first.
                server.release();
                side.begun.tell_heard(None);
                let Err(failure) = side.carry_out(server) else {
                    begun.desk.settle();
                    return Ok(());
                };
                // With the link goes its adapter, which has one user.
                let last = side.link.seen.last;
                let silent_for = last.map_or(Duration::ZERO, |last| last.elapsed());
                silent = Some(SystemTime::now() - silent_for);
                failure
            }
        };
        let lost = Lost {
            since: *silent.get_or_insert_with(SystemTime::now),
            why: Both::default(),
        };
        link = lost.look_for(&mut begun, server, failure);
    }
    Ok(())
}

/// The board is not heard.
pub struct Lost {
    /// Since then.
    since: SystemTime,
    /// What is wrong, as far as that can be told.
    why: Both,
}

impl Lost {
    /// Looks for the board until it answers; `None` where the panel is interrupted.
    fn look_for(
        mut self,
        begun: &mut Begun<'_>,
        server: &Server,
        mut failure: Failure,
    ) -> Option<Link> {
        begun.views.forget();
        // What was told last is no state of the machine for who comes now.
        begun.feed.forget("s");
        loop {
            let why = why(failure);
            if why != self.why {
                self.why = why;
                begun.desk.lose(self.words());
                begun.tell_heard(Some(&self));
            }
            server.release();
            let again = Instant::now() + AGAIN;
            while Instant::now() < again {
                if interrupt::requested() {
                    begun.desk.settle();
                    return None;
                }
                begun.end_own();
                server.attend();
                std::thread::sleep(GLANCE);
            }
            match heard(begun.global) {
                Ok(link) => return Some(link),
                Err(other) => failure = other,
            }
        }
    }

    /// Why nothing is ordered.
    fn words(&self) -> Both {
        let Both { en, zh } = &self.why;
        both!(
            "the board is not heard, and nothing is ordered: look at the machine ({en})",
            "收不到控制板，无法下达指令：请查看机床（{zh}）"
        )
    }
}

impl Begun<'_> {
    /// Tells all pages whether the board is heard.
    fn tell_heard(&self, lost: Option<&Lost>) {
        let text = object(|json| match lost {
            None => json.null("since_ms"),
            Some(Lost { since, why }) => {
                let since = since.duration_since(UNIX_EPOCH).unwrap_or_default();
                json.integer(
                    "since_ms",
                    i64::try_from(since.as_millis()).unwrap_or(i64::MAX),
                );
                json.text("en", &why.en);
                json.text("zh", &why.zh);
            }
        });
        self.feed.tell("board", text);
        if lost.is_none() {
            // Events are counted anew by a board that has started again.
            self.feed.tell("log", "[]".to_owned());
        }
    }
}
