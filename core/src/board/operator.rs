//! What the operator has set, and what he asks for next.

use super::event::Command;
use crate::alarm::Code;
use crate::motion::Rate;
use crate::signals::Signals;

/// The operator's settings. They hold for the next tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Operator {
    /// Feed hold is on.
    pub hold: bool,
    /// Single block is on.
    pub single_block: bool,
    /// The inputs, as they were set last.
    pub signals: Signals,
    feed: u8,
    rapid: u8,
    spindle: u8,
    wish: Option<Wish>,
}

/// A command that is carried out once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Wish {
    /// Go on.
    Resume,
    /// Reset.
    Reset,
    /// Emergency stop, or a stop with an alarm of its own.
    Stop(Code),
}

impl Operator {
    /// As at power-up: nothing held, all overrides at 100 %.
    pub(super) const fn new() -> Self {
        Self {
            hold: false,
            single_block: false,
            signals: Signals::POWER_UP,
            feed: 100,
            rapid: 100,
            spindle: 100,
            wish: None,
        }
    }

    /// Takes a command. The stronger wish of one tick counts: stop before reset before resume.
    pub(super) const fn take(&mut self, command: Command) {
        match command {
            Command::Hold => {
                self.hold = true;
                // What was asked for last counts.
                if matches!(self.wish, Some(Wish::Resume)) {
                    self.wish = None;
                }
            }
            Command::Resume if self.wish.is_none() => self.wish = Some(Wish::Resume),
            Command::Reset if !matches!(self.wish, Some(Wish::Stop(_))) => {
                self.wish = Some(Wish::Reset);
            }
            Command::Resume | Command::Reset => {}
            Command::Stop => self.wish = Some(Wish::Stop(Code::EmergencyStop)),
            Command::Halt(code) => self.wish = Some(Wish::Stop(code)),
            Command::SingleBlock(on) => self.single_block = on,
            Command::FeedOverride(percent) => self.feed = clamp(percent, 0, 150),
            Command::RapidOverride(percent) => self.rapid = clamp(percent, 0, 100),
            Command::SpindleOverride(percent) => self.spindle = clamp(percent, 50, 120),
        }
    }

    pub(super) const fn wish(&mut self) -> Option<Wish> {
        self.wish.take()
    }

    /// Feed override.
    #[must_use]
    pub const fn feed(&self) -> Rate {
        Rate::percent(self.feed)
    }

    /// Rapid override.
    #[must_use]
    pub const fn rapid(&self) -> Rate {
        Rate::percent(self.rapid)
    }

    /// Feed override in percent.
    #[must_use]
    pub const fn feed_percent(&self) -> u8 {
        self.feed
    }

    /// Rapid override in percent.
    #[must_use]
    pub const fn rapid_percent(&self) -> u8 {
        self.rapid
    }

    /// Spindle override in percent.
    #[must_use]
    pub const fn spindle_percent(&self) -> u8 {
        self.spindle
    }
}

const fn clamp(percent: u8, low: u8, high: u8) -> u8 {
    if percent < low {
        low
    } else if percent > high {
        high
    } else {
        percent
    }
}
