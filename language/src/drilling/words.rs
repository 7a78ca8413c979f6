//! The words of a drilling block.

use leadscrew_core::alarm::{Alarm, Arg, At, Code, Span};
use leadscrew_core::units::{Decimal, Diameter, Length};

use crate::dialect::{Control, in_milliseconds};
use crate::roughing::Unit;
use crate::value::Value;
use crate::word::{Given, Word};

/// A drilling cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// G83, along Z.
    Face,
    /// G87, along X.
    Side,
    /// G81, along Z: without pecks.
    Plain,
    /// G82, along Z: without pecks, with a dwell.
    Dwelling,
    /// G85, along Z: out at feed, in a FANUC after a dwell.
    Boring,
    /// G89 of a Haas, along Z: out at feed after a dwell.
    BoringDwelling,
    /// G89 of a FANUC, along X: the same.
    SideBoring,
}

impl Kind {
    /// The cycle of a G word, if the control has it.
    #[must_use]
    pub fn of(word: &Word, control: Control) -> Option<Self> {
        if word.letter != b'G' {
            return None;
        }
        let more = control.has_system_b() || control == Control::Haas;
        let bores = !control.is_gsk();
        Some(match word.value().whole()? {
            83 => Self::Face,
            87 if control != Control::Haas => Self::Side,
            81 if more => Self::Plain,
            82 if more => Self::Dwelling,
            85 if bores => Self::Boring,
            89 if control == Control::Haas => Self::BoringDwelling,
            89 if bores => Self::SideBoring,
            _ => return None,
        })
    }

    /// Its G code.
    #[must_use]
    pub const fn code(self) -> &'static str {
        match self {
            Self::Face => "G83",
            Self::Side => "G87",
            Self::Plain => "G81",
            Self::Dwelling => "G82",
            Self::Boring => "G85",
            Self::BoringDwelling | Self::SideBoring => "G89",
        }
    }

    /// The same as a figure of an alarm.
    #[must_use]
    pub const fn figure(self) -> Arg {
        Arg::GCode(match self {
            Self::Face => 830,
            Self::Side => 870,
            Self::Plain => 810,
            Self::Dwelling => 820,
            Self::Boring => 850,
            Self::BoringDwelling | Self::SideBoring => 890,
        })
    }

    /// It drills along X.
    #[must_use]
    pub const fn is_side(self) -> bool {
        matches!(self, Self::Side | Self::SideBoring)
    }

    /// The letters of the axis along which it drills: absolute, increment.
    #[must_use]
    pub const fn axis(self) -> [u8; 2] {
        if self.is_side() { *b"XU" } else { *b"ZW" }
    }

    /// The letters that place the hole.
    #[must_use]
    pub const fn place(self) -> &'static [u8] {
        if self.is_side() { b"ZWCH" } else { b"XUCH" }
    }

    /// Its tool leaves at feed.
    #[must_use]
    pub const fn feeds_out(self) -> bool {
        matches!(self, Self::Boring | Self::BoringDwelling | Self::SideBoring)
    }

    /// It has pecks.
    #[must_use]
    pub const fn pecks(self) -> bool {
        matches!(self, Self::Face | Self::Side)
    }
}

/// Where a level is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Level {
    /// At this coordinate, as it is written.
    Coordinate(Word),
    /// This far from the reference: the initial level for R, R for the bottom.
    Away(Length),
}

/// A drilling cycle in force, with the words that it keeps.
#[derive(Clone, Copy, Debug)]
pub struct Drill {
    /// Which.
    pub kind: Kind,
    /// Its G word.
    pub code: Span,
    /// R.
    pub level: Option<Level>,
    /// The bottom.
    pub bottom: Option<Level>,
    /// Q.
    pub peck: Option<At<Length>>,
    /// P, and the cycle that it was written for.
    pub dwell: (u32, Kind),
    /// A block has asked for a hole.
    pub drills: bool,
    /// What is odd about Q has been told.
    pub doubted: bool,
}

/// The words of a block, divided.
#[derive(Clone, Debug, Default)]
pub struct Parts {
    /// For the interpreter, before the hole: N F S T and M codes.
    pub before: Vec<Word>,
    /// For the interpreter, after the last hole: M00 M01 M02 M05 M09 M30.
    pub after: Vec<Word>,
    /// The place of the hole.
    pub place: Vec<Word>,
    /// K: how many holes.
    pub holes: u32,
    /// The M code that clamps.
    pub clamp: Option<Word>,
    /// The block has a word that asks for a hole.
    pub drills: bool,
}

impl Drill {
    /// A cycle that begins.
    #[must_use]
    pub const fn new(kind: Kind, code: Span) -> Self {
        Self {
            kind,
            code,
            level: None,
            bottom: None,
            peck: None,
            dwell: (0, kind),
            drills: false,
            doubted: false,
        }
    }

    /// A cycle that is written while this one is in force. Along the same axis its words stay [D545].
    #[must_use]
    pub fn then(self, kind: Kind, code: Span) -> Self {
        if self.kind.is_side() != kind.is_side() {
            return Self::new(kind, code);
        }
        Self {
            kind,
            code,
            drills: false,
            ..self
        }
    }

    /// The dwell at the bottom, in milliseconds. A cycle that has none of its own does not take over that of another.
    #[must_use]
    pub fn dwell(&self) -> u32 {
        let (dwell, written_for) = self.dwell;
        if self.kind == Kind::Plain && written_for != Kind::Plain {
            return 0;
        }
        dwell
    }

    /// A cycle is over. One that has only kept its words has lost the word that asks for the hole.
    ///
    /// # Errors
    /// [`Code::TapBottomMissing`].
    pub fn end(&self) -> Result<(), Alarm> {
        if self.drills {
            return Ok(());
        }
        Err(self.bottom_missing())
    }

    /// The alarm of a cycle that does not know how deep it goes.
    #[must_use]
    pub fn bottom_missing(&self) -> Alarm {
        let [letter, _] = self.kind.axis();
        let figures = [self.kind.figure(), Arg::Letter(letter)];
        Alarm::new(Code::TapBottomMissing, self.code).with(figures)
    }

    /// Reads a block: the cycle keeps its own words, and the others are divided. `counts`: Q counts increments.
    /// `is_free_m` is true for an M code without a meaning of its own.
    ///
    /// # Errors
    /// A word that is no length or count, or that the cycle has no use for.
    pub fn read(
        &mut self,
        words: &[Word],
        control: Control,
        unit: Unit,
        counts: bool,
        is_free_m: impl Fn(i64) -> bool,
    ) -> Result<Parts, Alarm> {
        let mut parts = Parts {
            holes: 1,
            ..Parts::default()
        };
        let [absolute, increment] = self.kind.axis();
        for word in words {
            let whole = || word.value().whole().unwrap_or(-1);
            match word.letter {
                b'G' if Kind::of(word, control).is_some() => {}
                letter if letter == absolute => {
                    self.bottom = Some(Level::Coordinate(*word));
                    parts.drills = true;
                }
                letter if letter == increment => {
                    let away = unit.length(word)?.value;
                    // U is a diameter.
                    let away = if letter == b'U' {
                        Diameter::from_nm(away.nm()).radius()
                    } else {
                        away
                    };
                    self.bottom = Some(Level::Away(away));
                    parts.drills = true;
                }
                letter if self.kind.place().contains(&letter) => {
                    parts.place.push(*word);
                    parts.drills = true;
                }
                b'R' if control == Control::Haas => self.level = Some(Level::Coordinate(*word)),
                b'R' => self.level = Some(Level::Away(unit.length(word)?.value)),
                b'Q' if self.kind.pecks() => {
                    let peck = unit.length(&in_length(word, unit, counts))?;
                    if peck.value < Length::ZERO {
                        return Err(word.alarm(Code::Negative));
                    }
                    self.peck = (peck.value > Length::ZERO).then_some(peck);
                    self.doubted = false;
                }
                b'P' if control == Control::Haas => {
                    let count = in_milliseconds(word).count(0, 99_999_999)?;
                    self.dwell = (count, self.kind);
                }
                b'P' => self.dwell = (word.count(0, 99_999_999)?, self.kind),
                b'K' | b'L' => parts.holes = word.count(1, 9999)?,
                b'M' if is_free_m(whole()) => {
                    if parts.clamp.is_some() {
                        return Err(word.alarm(Code::MGroupTwice));
                    }
                    parts.clamp = Some(*word);
                }
                b'M' if matches!(whole(), 0..=2 | 5 | 9 | 30) => parts.after.push(*word),
                b'N' | b'F' | b'S' | b'T' | b'M' | b'G' => parts.before.push(*word),
                _ => return Err(word.alarm(Code::WordWithoutUse)),
            }
        }
        self.drills |= parts.drills;
        Ok(parts)
    }
}

/// Q as a length.
fn in_length(word: &Word, unit: Unit, counts: bool) -> Word {
    let given = match word.given {
        Given::Written(number) if counts && !number.has_point() => {
            Given::Written(Decimal::new(number.mantissa(), unit.decimals))
        }
        Given::Calculated(Value::Number(number)) if counts => {
            Given::Calculated(Value::Increments(libm::round(number)))
        }
        given => given,
    };
    Word { given, ..*word }
}
