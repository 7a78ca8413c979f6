//! The operator's settings and requests.

use super::command::Command;
use super::trouble::BusTrouble;
use crate::alarm::Code;
use crate::motion::Rate;
use crate::signals::Signals;
use crate::units::{Axes, Rpm};

/// The operator's settings. They act in the next tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Operator {
    /// Feed hold is on.
    pub hold: bool,
    /// Single block is on.
    pub single_block: bool,
    /// The inputs as last set.
    pub signals: Signals,
    feed: Override,
    rapid: Override,
    spindle: u8,
    /// An emergency stop, or a stop with another alarm, for the next tick.
    stop: Option<Code>,
    /// A trouble of the bus, for the next tick.
    trouble: Option<BusTrouble>,
    /// The drives cannot be reached any more, and the tick does not know it yet.
    cut_off: bool,
    /// A reset. It waits while the machine comes to rest on an alarm [D110].
    reset: bool,
    /// What becomes of a held program in the next tick.
    next: Next,
    /// Home these axes in the next tick.
    home: Option<Axes>,
    /// Give up homing in the next tick.
    cancel: bool,
}

impl Operator {
    /// The state at power-up: no hold, all overrides at 100 %.
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
            next: Next::Stay,
            home: None,
            cancel: false,
        }
    }

    /// Takes a command. The commands of one tick act in the order stop, reset, resume; a later one replaces an earlier one
    /// of its kind.
    pub(super) const fn take(&mut self, command: Command) {
        match command {
            Command::Hold => {
                self.hold = true;
                if !self.is_to_leave() {
                    self.next = Next::Stay;
                }
            }
            Command::Resume => self.next = Next::GoOn,
            Command::Leave => self.next = Next::Leave,
            Command::Return => self.next = Next::Return,
            Command::Home(axes) => self.home = Some(axes),
            Command::Cancel => self.cancel = true,
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
            // Presses, the handwheel and the block are the ticker's.
            Command::Release
            | Command::ByWheel(_)
            | Command::Turned(_)
            | Command::Block(_)
            | Command::BlockLost(_) => {}
        }
    }

    /// An earlier reset is void, because it was meant for another stop.
    const fn ask_for_stop(&mut self, code: Code) {
        self.stop = Some(code);
        self.reset = false;
    }

    /// The requested stop, once.
    pub(super) const fn takes_stop(&mut self) -> Option<Code> {
        self.stop.take()
    }

    /// True where the tick does not know of a trouble of the bus yet.
    #[inline]
    pub(super) const fn has_trouble(&self) -> bool {
        self.trouble.is_some()
    }

    /// The trouble of the bus, once.
    pub(super) const fn takes_trouble(&mut self) -> Option<BusTrouble> {
        self.trouble.take()
    }

    /// True, once, after the drives cannot be reached any more.
    pub(super) const fn takes_cut_off(&mut self) -> bool {
        core::mem::replace(&mut self.cut_off, false)
    }

    /// True, once, after a resume.
    pub(super) const fn takes_resume(&mut self) -> bool {
        let asked = matches!(self.next, Next::GoOn);
        if asked {
            self.next = Next::Stay;
        }
        asked
    }

    /// True, once, after a return.
    pub(super) const fn takes_return(&mut self) -> bool {
        let asked = matches!(self.next, Next::Return);
        if asked {
            self.next = Next::Stay;
        }
        asked
    }

    /// The program is to be left, as soon as it is held.
    pub(super) const fn is_to_leave(&self) -> bool {
        matches!(self.next, Next::Leave)
    }

    /// It has been left, or cannot be.
    pub(super) const fn leaves(&mut self) {
        self.next = Next::Stay;
    }

    /// True, once, after homing is to be given up.
    pub(super) const fn takes_cancel(&mut self) -> bool {
        core::mem::replace(&mut self.cancel, false)
    }

    /// The axes to home, once.
    pub(super) const fn takes_home(&mut self) -> Option<Axes> {
        self.home.take()
    }

    /// True while a stop, a trouble of the bus, a reset, a resume, a leave or a homing waits for the tick.
    #[must_use]
    pub(super) const fn asks(&self) -> bool {
        self.stop.is_some()
            || self.trouble.is_some()
            || self.reset
            || !matches!(self.next, Next::Stay)
            || self.home.is_some()
            || self.cancel
    }

    /// True while a requested reset is not done.
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

/// What becomes of a held program. The later order counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Next {
    /// Nothing.
    Stay,
    /// It goes on.
    GoOn,
    /// It goes on where it was left.
    Return,
    /// It is left.
    Leave,
}

/// An override, and its rate, which every tick needs.
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

/// A spindle speed with an override, rounded to the nearest, ties away from zero.
#[must_use]
pub fn overridden(rpm: Rpm, percent: u8) -> Rpm {
    let scaled = i64::from(rpm.get()).saturating_mul(i64::from(percent));
    let rounded = scaled.saturating_add(50_i64.saturating_mul(scaled.signum())) / 100;
    Rpm::new(i32::try_from(rounded).unwrap_or(0))
}
