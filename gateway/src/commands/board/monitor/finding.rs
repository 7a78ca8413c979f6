//! The panel stays while its board is not heard, and finds it again by itself.
//!
//! ```text
//! link ─► Session, as long as the board is heard ─► lost: what was ordered is taken back, keys only leave
//!   ▲                                                        │
//!   └──────────── opened anew, greeted, read anew ◄──────────┘
//! ```
//!
//! Nothing is ordered by finding it. This must not know what is read of a board, or what keys mean but to leave.

use std::io;
use std::panic::resume_unwind;
use std::thread;
use std::time::{Duration, Instant};

use ratatui::crossterm::event::{Event as Input, KeyCode, KeyEventKind};

use super::super::heard;
use super::typed::Typed;
use super::view::{Row, Tone, View};
use super::{PICTURE, Session, draw, keys, terminal};
use crate::cli::Global;
use crate::failure::Failure;
use crate::interrupt;
use crate::link::Link;
use crate::words::{Both, both};

/// From one search to the next.
pub const AGAIN: Duration = Duration::from_millis(500);

/// What the panel has whether the board is heard or not.
pub struct Screen<'a> {
    /// Its options.
    pub global: &'a Global,
    /// Keys operate the machine; else they only end the view.
    pub keys: bool,
    /// The terminal tells when a key is let go.
    pub tells_release: bool,
    /// The terminal.
    pub drawn: terminal::Drawn,
    /// What it shows.
    pub view: View,
    /// The line that is being carried out: it has a link of its own.
    pub typed: Option<Typed>,
}

impl Screen<'_> {
    /// Shows the board of this link, and the next one that is found in its place, until a key ends it.
    ///
    /// # Errors
    /// The terminal fails.
    pub fn carry_out(mut self, link: Link) -> io::Result<()> {
        let mut link = Some(link);
        // One that greets and cannot be read has not been heard meanwhile.
        let mut silent: Option<Instant> = None;
        while let Some(own) = link.take() {
            let failure = match Session::new(&mut self, own) {
                Err(failure) => failure,
                Ok(mut session) => {
                    if let Some(since) = silent.take() {
                        session.answer(&again(since.elapsed()), Tone::Care);
                    }
                    match session.carry_out() {
                        Ok(ended) => return ended,
                        Err(failure) => {
                            silent = session.last();
                            failure
                        }
                    }
                }
            };
            let since = *silent.get_or_insert_with(Instant::now);
            link = self.look_for(failure, since)?;
        }
        Ok(())
    }

    /// Looks for the board until it answers; `None` where a key or a signal ends the panel.
    fn look_for(&mut self, failure: Failure, since: Instant) -> io::Result<Option<Link>> {
        let mut why = why(failure);
        loop {
            let again = Instant::now() + AGAIN;
            let global = self.global.clone();
            // A board that does not answer is waited for, and keys are not.
            let search = thread::spawn(move || heard(&global));
            while !search.is_finished() || Instant::now() < again {
                if terminal::said()?.iter().any(leaves) || interrupt::requested() {
                    return Ok(None);
                }
                self.draw_lost(&why, since.elapsed())?;
                thread::sleep(PICTURE);
            }
            match search.join() {
                Ok(Ok(link)) => return Ok(Some(link)),
                Ok(Err(failure)) => why = self::why(failure),
                Err(panic) => resume_unwind(panic),
            }
        }
    }

    fn draw_lost(&mut self, why: &Both, silent: Duration) -> io::Result<()> {
        let view = &mut self.view;
        // What was heard last is shown as old.
        if let Some((_, age)) = &mut view.pdo {
            *age = silent;
        }
        if let Some((_, age)) = &mut view.record {
            *age = silent;
        }
        let words = unheard(why, silent.as_secs());
        view.prompt = Row::new(words.get(view.lang), Tone::Bad);
        view.hint = both!("q quit", "q 退出").get(view.lang).to_owned();
        self.drawn.draw(|frame| draw::draw(frame, view)).map(drop)
    }
}

/// A key that ends a view.
pub fn leaves(input: &Input) -> bool {
    let Input::Key(key) = input else {
        return false;
    };
    key.kind == KeyEventKind::Press
        && (matches!(key.code, KeyCode::Char('q' | 'Q') | KeyCode::Esc)
            || keys::is_control(*key, 'c'))
}

/// Why a board is not heard.
pub fn why(failure: Failure) -> Both {
    // It may have told its reason elsewhere.
    failure
        .words()
        .unwrap_or_else(|| both!("it does not answer", "没有应答"))
}

fn unheard(Both { en, zh }: &Both, seconds: u64) -> Both {
    both!(
        "the board is not heard for {seconds} s; nothing is ordered, and what was ordered is taken back: look at the machine ({en})",
        "已有 {seconds} 秒收不到控制板；无法下达指令，此前的指令已撤回：请查看机床（{zh}）"
    )
}

fn again(silent: Duration) -> Both {
    let seconds = silent.as_secs();
    both!(
        "the board is heard again after {seconds} s: look at the machine before you order anything",
        "{seconds} 秒后重新收到控制板：下达指令前请查看机床"
    )
}
