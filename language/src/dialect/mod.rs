//! The controls whose programs are read: what each writes in another way than the GSK and FANUC of G-code system A.
//!
//! A block of another control becomes a block of system A before anything else looks at it: the codes of `codes`, the
//! forms of cycles in one block of [`one_line`]. What is only read in another way (a power-on state, a rapid escape) is
//! asked of [`Control`]. Messages name the codes that were written.
//!
//! This module knows words and codes; it must not know positions, calls or the machine.

mod codes;
pub mod digits;
mod looks;
mod name;
pub mod one_line;
mod points;
mod refusals;
pub mod remedies;
#[cfg(test)]
mod tests;
mod translator;

use leadscrew_core::program::Dialect;

pub use looks::Looks;
pub use name::{Named, named};
pub use points::{Written, lengths, written};
pub use translator::{Setting, Translator};
pub(crate) use translator::{code_of, has_code, in_milliseconds, is_m19};

/// True for the letters of X and Z.
#[must_use]
pub const fn is_of_axis(letter: u8) -> bool {
    matches!(letter, b'X' | b'U' | b'Z' | b'W')
}

/// A family of controls.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Control {
    /// GSK 980TD.
    #[default]
    Gsk980td,
    /// GSK 988.
    Gsk988,
    /// FANUC lathe, G-code system A.
    FanucA,
    /// FANUC lathe, system B: G77 to G79, G90 and G91.
    FanucB,
    /// FANUC lathe, system C: G20 G21 G24, G72 to G78.
    FanucC,
    /// Haas lathe.
    Haas,
}

impl Control {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::Gsk980td,
        Self::Gsk988,
        Self::FanucA,
        Self::FanucB,
        Self::FanucC,
        Self::Haas,
    ];

    /// Its name in options, machine files and comments.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Gsk980td => "gsk980td",
            Self::Gsk988 => "gsk988",
            Self::FanucA => "fanuc-a",
            Self::FanucB => "fanuc-b",
            Self::FanucC => "fanuc-c",
            Self::Haas => "haas",
        }
    }

    /// The control of this name, in letters of any case.
    #[must_use]
    pub fn of_name(name: &str) -> Option<Self> {
        let is = |control: &Self| control.name().eq_ignore_ascii_case(name);
        Self::ALL.into_iter().find(is)
    }

    /// The names of all, for a message.
    #[must_use]
    pub fn names() -> String {
        Self::ALL.map(Self::name).join(", ")
    }

    /// How the core reads words that the families write alike. FANUC and Haas have lengths on the radius there, and the
    /// angle of a run-out by its parameter.
    #[must_use]
    pub const fn family(self) -> Dialect {
        match self {
            Self::Gsk980td => Dialect::Gsk980td,
            _ => Dialect::Gsk988,
        }
    }

    /// The feed is per turn at power-on.
    #[must_use]
    pub const fn begins_per_turn(self) -> bool {
        !self.is_gsk()
    }

    /// S of G50 limits the speed under G97, too.
    #[must_use]
    pub const fn limits_every_speed(self) -> bool {
        !self.is_gsk()
    }

    /// The tool leaves the cut of G71 and G72 at feed.
    #[must_use]
    pub const fn retract_feeds(self) -> bool {
        self.is_gsk()
    }

    /// A GSK: its blocks are those of system A as they are.
    #[must_use]
    pub const fn is_gsk(self) -> bool {
        matches!(self, Self::Gsk980td | Self::Gsk988)
    }

    /// A FANUC of any system.
    #[must_use]
    pub const fn is_fanuc(self) -> bool {
        matches!(self, Self::FanucA | Self::FanucB | Self::FanucC)
    }

    /// G90 and G91 say how axis words count, and G98 and G99 where a hole ends.
    #[must_use]
    pub const fn has_system_b(self) -> bool {
        matches!(self, Self::FanucB | Self::FanucC)
    }
}
