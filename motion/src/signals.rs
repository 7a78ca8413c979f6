//! Inputs of the board that a machine's PLC sets: which hand a tap has, which spindle turns it, whether rigid mode is on
//! ([G84/G88 sheet]). Levels only; what follows from them is said where they are used. Knows nothing of wires, buses or
//! commands.

use crate::alarm::{Alarm, Arg, Code, Span};
use crate::call::{Hand, HandChoice, Selection, SpindleChoice, TapSpindle};

/// One input, named as the makers' manuals name it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Signal {
    /// G61.2: a tap with a positive S is left hand.
    G61Dot2,
    /// RGTAP: rigid mode is on.
    Rgtap,
    /// SWS1–SWS4: spindle selection.
    Sws(TapSpindle),
    /// RGTSP1–RGTSP4: spindle selection for rigid tapping.
    Rgtsp(TapSpindle),
}

impl Signal {
    /// All of them.
    pub const ALL: [Self; 10] = [
        Self::G61Dot2,
        Self::Rgtap,
        Self::Sws(TapSpindle::First),
        Self::Sws(TapSpindle::Second),
        Self::Sws(TapSpindle::Third),
        Self::Sws(TapSpindle::Fourth),
        Self::Rgtsp(TapSpindle::First),
        Self::Rgtsp(TapSpindle::Second),
        Self::Rgtsp(TapSpindle::Third),
        Self::Rgtsp(TapSpindle::Fourth),
    ];

    /// Its name, as the command line writes it: `G61.2`, `RGTAP`, `SWS1`, `RGTSP1`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        use TapSpindle::{First, Fourth, Second, Third};
        match self {
            Self::G61Dot2 => "G61.2",
            Self::Rgtap => "RGTAP",
            Self::Sws(First) => "SWS1",
            Self::Sws(Second) => "SWS2",
            Self::Sws(Third) => "SWS3",
            Self::Sws(Fourth) => "SWS4",
            Self::Rgtsp(First) => "RGTSP1",
            Self::Rgtsp(Second) => "RGTSP2",
            Self::Rgtsp(Third) => "RGTSP3",
            Self::Rgtsp(Fourth) => "RGTSP4",
        }
    }

    /// The signal of this name, in capitals or not; `None` where there is none.
    #[must_use]
    pub fn find(name: &str) -> Option<Self> {
        Self::ALL
            .into_iter()
            .find(|signal| signal.name().eq_ignore_ascii_case(name))
    }
}

/// The levels of all inputs. At power-up all are 0, and RGTAP follows rigid mode.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Signals {
    /// G61.2.
    pub g61_2: bool,
    /// RGTAP; `None`: it follows the mode, as if a PLC answered at once.
    pub rgtap: Option<bool>,
    /// SWS1–SWS4 in bits 0 to 3; the others mean nothing.
    pub sws: u8,
    /// RGTSP1–RGTSP4 in bits 0 to 3; the others mean nothing.
    pub rgtsp: u8,
}

impl Signals {
    /// All inputs at 0, RGTAP following the mode.
    pub const POWER_UP: Self = Self {
        g61_2: false,
        rgtap: None,
        sws: 0,
        rgtsp: 0,
    };

    /// The bits that [`bits`](Self::bits) can have.
    pub const BITS: u16 = 0x0FF7;

    /// Behind them, what a board mirrors and nobody sets there: feed hold [D164].
    pub const HOLD: u16 = 1 << 12;

    /// The same: single block.
    pub const SINGLE_BLOCK: u16 = 1 << 13;

    /// The same: emergency stop.
    pub const STOP: u16 = 1 << 14;

    /// The same: the spindle's angle counts from its index.
    pub const INDEXED: u16 = 1 << 15;

    /// All that is mirrored.
    pub const MIRRORED: u16 = Self::HOLD | Self::SINGLE_BLOCK | Self::STOP | Self::INDEXED;

    const SPINDLES: u8 = 0x0F;

    /// Sets one input. RGTAP stops following the mode.
    pub const fn set(&mut self, signal: Signal, level: bool) {
        match signal {
            Signal::G61Dot2 => self.g61_2 = level,
            Signal::Rgtap => self.rgtap = Some(level),
            Signal::Sws(spindle) => self.sws = with(self.sws, spindle, level),
            Signal::Rgtsp(spindle) => self.rgtsp = with(self.rgtsp, spindle, level),
        }
    }

    /// As sixteen bits, for a bus:
    ///
    /// | bit | is |
    /// |---|---|
    /// | 0 | G61.2 |
    /// | 1 | RGTAP, where bit 2 is 1; else 0 |
    /// | 2 | 1: RGTAP has the level of bit 1; 0: it follows the mode |
    /// | 4–7 | SWS1–SWS4 |
    /// | 8–11 | RGTSP1–RGTSP4 |
    /// | 3, 12–15 | 0 |
    #[must_use]
    pub const fn bits(self) -> u16 {
        let rgtap = match self.rgtap {
            None => 0,
            Some(false) => 0b100,
            Some(true) => 0b110,
        };
        self.g61_2 as u16
            | rgtap
            | ((self.sws & Self::SPINDLES) as u16) << 4
            | ((self.rgtsp & Self::SPINDLES) as u16) << 8
    }

    /// The signals of such bits; `None` where one is set that has no meaning. What is [mirrored](Self::MIRRORED) may be
    /// among them and says nothing about the signals.
    #[must_use]
    pub const fn from_bits(bits: u16) -> Option<Self> {
        let rgtap = match bits & 0b110 {
            0 => None,
            0b100 => Some(false),
            0b110 => Some(true),
            _ => return None,
        };
        if bits & !(Self::BITS | Self::MIRRORED) != 0 {
            return None;
        }
        Some(Self {
            g61_2: bits & 1 != 0,
            rgtap,
            sws: (bits >> 4) as u8 & Self::SPINDLES,
            rgtsp: (bits >> 8) as u8 & Self::SPINDLES,
        })
    }
}

impl Signals {
    /// The hand of a tap.
    #[must_use]
    pub const fn hand(self, choice: HandChoice) -> Hand {
        match choice {
            HandChoice::Written(hand) => hand,
            HandChoice::Signal if self.g61_2 => Hand::Left,
            HandChoice::Signal => Hand::Right,
        }
    }

    /// The spindle that taps, for a block at `span`.
    ///
    /// # Errors
    /// More than one selection signal is on ([`Code::TapSpindlesSelected`]).
    pub fn spindle(self, choice: SpindleChoice, span: Span) -> Result<TapSpindle, Alarm> {
        let (mask, otherwise) = match choice {
            SpindleChoice::Written(spindle) => return Ok(spindle),
            SpindleChoice::Signals { by, otherwise } => match by {
                Selection::Sws => (self.sws, otherwise),
                Selection::Rgtsp => (self.rgtsp, otherwise),
            },
        };
        let mut selected = TapSpindle::ALL
            .into_iter()
            .filter(|spindle| mask & bit(*spindle) != 0);
        let Some(spindle) = selected.next() else {
            return Ok(otherwise);
        };
        match selected.next() {
            None => Ok(spindle),
            Some(other) => {
                let number = |spindle: TapSpindle| Arg::Int(i64::from(spindle.number()));
                let args = [number(spindle), number(other)];
                Err(Alarm::new(Code::TapSpindlesSelected, span).with(args))
            }
        }
    }
}

/// The bit of a spindle in a mask.
const fn bit(spindle: TapSpindle) -> u8 {
    match spindle {
        TapSpindle::First => 1,
        TapSpindle::Second => 2,
        TapSpindle::Third => 4,
        TapSpindle::Fourth => 8,
    }
}

/// `mask` with the bit of a spindle set or cleared.
const fn with(mask: u8, spindle: TapSpindle, level: bool) -> u8 {
    if level {
        mask | bit(spindle)
    } else {
        mask & !bit(spindle)
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use std::collections::HashSet;

    #[test]
    fn a_signal_is_found_by_its_name() {
        for signal in Signal::ALL {
            assert_eq!(Signal::find(signal.name()), Some(signal));
            assert_eq!(
                Signal::find(&signal.name().to_ascii_lowercase()),
                Some(signal)
            );
        }
        let names: HashSet<_> = Signal::ALL.map(Signal::name).into_iter().collect();
        assert_eq!(names.len(), Signal::ALL.len());
        for wrong in [
            "", "SWS", "SWS0", "SWS5", "RGTSP5", "G61", "G61.3", "RGTAP ",
        ] {
            assert_eq!(Signal::find(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn each_signal_has_a_bit_of_its_own() {
        let mut seen = HashSet::from([Signals::default().bits()]);
        for signal in Signal::ALL {
            let mut signals = Signals::default();
            signals.set(signal, true);
            assert!(seen.insert(signals.bits()), "{signal:?}");
            signals.set(signal, false);
            let expected = if signal == Signal::Rgtap { 0b100 } else { 0 };
            assert_eq!(signals.bits(), expected, "{signal:?}");
        }
        let mut all = Signals::default();
        for signal in Signal::ALL {
            all.set(signal, true);
        }
        assert_eq!(all.bits(), Signals::BITS);
    }

    #[test]
    fn g61_2_turns_a_positive_s_round() {
        let mut signals = Signals::default();
        assert_eq!(signals.hand(HandChoice::Signal), Hand::Right);
        signals.set(Signal::G61Dot2, true);
        assert_eq!(signals.hand(HandChoice::Signal), Hand::Left);
        for hand in [Hand::Left, Hand::Right] {
            assert_eq!(signals.hand(HandChoice::Written(hand)), hand);
        }
    }

    #[test]
    fn e_before_signals_before_m_codes() {
        let none = Signals::default();
        let by = |by| SpindleChoice::Signals {
            by,
            otherwise: TapSpindle::Third,
        };
        let e = SpindleChoice::Written(TapSpindle::Second);
        for spindle in TapSpindle::ALL {
            let (mut sws, mut rgtsp) = (none, none);
            sws.set(Signal::Sws(spindle), true);
            rgtsp.set(Signal::Rgtsp(spindle), true);
            let of = |signals: Signals, choice| signals.spindle(choice, Span::default());
            assert_eq!(of(sws, by(Selection::Sws)), Ok(spindle));
            assert_eq!(of(rgtsp, by(Selection::Rgtsp)), Ok(spindle));
            // The other group means nothing, and E counts before both.
            assert_eq!(of(sws, by(Selection::Rgtsp)), Ok(TapSpindle::Third));
            assert_eq!(of(rgtsp, by(Selection::Sws)), Ok(TapSpindle::Third));
            assert_eq!(of(sws, e), Ok(TapSpindle::Second));
        }
        let two = Signals {
            rgtsp: 0b1010,
            ..none
        };
        let alarm = two
            .spindle(by(Selection::Rgtsp), Span::default())
            .unwrap_err();
        assert_eq!(alarm.code, Code::TapSpindlesSelected);
        assert_eq!(alarm.args[..2], [Arg::Int(2), Arg::Int(4)]);
        assert_eq!(two.spindle(e, Span::default()), Ok(TapSpindle::Second));
    }

    #[test]
    fn bits_come_back_as_they_were_or_are_refused() {
        let mut known = 0;
        for bits in 0..=u16::MAX {
            match Signals::from_bits(bits) {
                Some(signals) => {
                    known += 1;
                    assert_eq!(signals.bits(), bits & !Signals::MIRRORED);
                }
                None => assert!(bits & 0x0008 != 0 || bits & 0b110 == 0b010),
            }
        }
        // Each with every value of the four bits that are mirrored.
        assert_eq!(known, 2 * 3 * 16 * 16 * 16);
    }
}
