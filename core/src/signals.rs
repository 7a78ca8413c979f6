//! Inputs of the board that a machine's PLC sets: which hand a tap has, which spindle turns it, whether rigid mode is on
//! ([G84/G88 sheet]). Levels only; what follows from them is said where they are used. Knows nothing of wires, buses or
//! commands.

use crate::program::TapSpindle;

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
    /// The bits that [`bits`](Self::bits) can have.
    pub const BITS: u16 = 0x0FF7;

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

    /// The signals of such bits; `None` where one is set that has no meaning.
    #[must_use]
    pub const fn from_bits(bits: u16) -> Option<Self> {
        let rgtap = match bits & 0b110 {
            0 => None,
            0b100 => Some(false),
            0b110 => Some(true),
            _ => return None,
        };
        if bits & !Self::BITS != 0 {
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

/// `mask` with the bit of a spindle set or cleared.
const fn with(mask: u8, spindle: TapSpindle, level: bool) -> u8 {
    let bit = 1 << spindle.number().saturating_sub(1);
    if level { mask | bit } else { mask & !bit }
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
    fn bits_come_back_as_they_were_or_are_refused() {
        let mut known = 0;
        for bits in 0..=u16::MAX {
            match Signals::from_bits(bits) {
                Some(signals) => {
                    known += 1;
                    assert_eq!(signals.bits(), bits);
                }
                None => assert!(bits & !Signals::BITS != 0 || bits & 0b110 == 0b010),
            }
        }
        assert_eq!(known, 2 * 3 * 16 * 16);
    }
}
