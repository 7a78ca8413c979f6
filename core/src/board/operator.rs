//! What the operator has set, and what he asks for next.

use super::event::Command;
use super::trouble::BusTrouble;
use crate::alarm::Code;
use crate::motion::Rate;
use crate::signals::Signals;
use crate::units::Rpm;

/// The operator's settings. They hold for the next tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Operator {
    /// Feed hold is on.
    pub hold: bool,
    /// Single block is on.
    pub single_block: bool,
    /// The inputs, as they were set last.
    pub signals: Signals,
    feed: Override,
    rapid: Override,
    spindle: u8,
    /// An emergency stop, or a stop with an alarm of its own, for the next tick.
    stop: Option<Code>,
    /// The same for what is wrong with the bus.
    trouble: Option<BusTrouble>,
    /// The drives cannot be reached any more; the tick has not heard of it.
    cut_off: bool,
    /// A reset; it waits while the machine comes to rest on an alarm [D110].
    reset: bool,
    /// Go on, in the next tick.
    resume: bool,
}

impl Operator {
    /// As at power-up: nothing held, all overrides at 100 %.
    // [D146]
    #[inline(always)]
    pub(super) const fn new() -> Self {
        Self {
            hold: false,
            single_block: false,
            signals: Signals::POWER_UP,
            feed: Override::FULL,
            rapid: Override::FULL,
            spindle: 100,
            stop: None,
            trouble: None,
            cut_off: false,
            reset: false,
            resume: false,
        }
    }

    /// Takes a command. Those of one tick act in the order stop, reset, resume; what was asked for last counts.
    pub(super) const fn take(&mut self, command: Command) {
        match command {
            Command::Hold => {
                self.hold = true;
                self.resume = false;
            }
            Command::Resume => self.resume = true,
            Command::Reset => {
                self.reset = true;
                self.hold = false;
            }
            Command::Stop => self.ask_for_stop(Code::EmergencyStop),
            Command::Halt(code) => self.ask_for_stop(code),
            Command::Trouble(trouble) => {
                self.cut_off |= matches!(trouble, BusTrouble::Off(_) | BusTrouble::Restricted);
                self.trouble = Some(trouble);
                self.reset = false;
            }
            Command::SingleBlock(on) => self.single_block = on,
            Command::FeedOverride(percent) => self.feed = Override::of(clamp(percent, 0, 150)),
            Command::RapidOverride(percent) => self.rapid = Override::of(clamp(percent, 0, 100)),
            Command::SpindleOverride(percent) => self.spindle = clamp(percent, 50, 120),
        }
    }

    /// A reset that was asked for before is void: it was for another stop.
    const fn ask_for_stop(&mut self, code: Code) {
        self.stop = Some(code);
        self.reset = false;
    }

    /// The stop asked for, once.
    pub(super) const fn takes_stop(&mut self) -> Option<Code> {
        self.stop.take()
    }

    /// Something is wrong with the bus that the tick has not heard of.
    #[inline]
    pub(super) const fn has_trouble(&self) -> bool {
        self.trouble.is_some()
    }

    /// What is wrong with the bus, once.
    pub(super) const fn takes_trouble(&mut self) -> Option<BusTrouble> {
        self.trouble.take()
    }

    /// True, once, where the drives cannot be reached any more.
    pub(super) const fn takes_cut_off(&mut self) -> bool {
        core::mem::replace(&mut self.cut_off, false)
    }

    /// True where to go on was asked for, once.
    pub(super) const fn takes_resume(&mut self) -> bool {
        core::mem::replace(&mut self.resume, false)
    }

    /// Something waits to be carried out: a stop, a trouble of the bus, a reset or a resume.
    #[must_use]
    pub(super) const fn asks(&self) -> bool {
        self.stop.is_some() || self.trouble.is_some() || self.reset || self.resume
    }

    /// A reset has been asked for and is not done.
    #[must_use]
    pub const fn reset_waits(&self) -> bool {
        self.reset
    }

    pub(super) const fn reset_acts(&mut self) {
        self.reset = false;
    }

    /// Feed override.
    #[must_use]
    pub const fn feed(&self) -> Rate {
        self.feed.rate
    }

    /// Rapid override.
    #[must_use]
    pub const fn rapid(&self) -> Rate {
        self.rapid.rate
    }

    /// Feed override in percent.
    #[must_use]
    pub const fn feed_percent(&self) -> u8 {
        self.feed.percent
    }

    /// Rapid override in percent.
    #[must_use]
    pub const fn rapid_percent(&self) -> u8 {
        self.rapid.percent
    }

    /// Spindle override in percent.
    #[must_use]
    pub const fn spindle_percent(&self) -> u8 {
        self.spindle
    }
}

/// An override as it was set, and the rate that is, which every tick asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Override {
    percent: u8,
    rate: Rate,
}

impl Override {
    const FULL: Self = Self::of(100);

    const fn of(percent: u8) -> Self {
        Self {
            percent,
            rate: Rate::percent(percent),
        }
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

/// A spindle speed at an override, ties away from zero.
#[must_use]
pub fn overridden(rpm: Rpm, percent: u8) -> Rpm {
    let scaled = i64::from(rpm.get()).saturating_mul(i64::from(percent));
    let rounded = scaled.saturating_add(50_i64.saturating_mul(scaled.signum())) / 100;
    Rpm::new(i32::try_from(rounded).unwrap_or(0))
}
