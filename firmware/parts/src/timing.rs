//! Segments of a CAN bit, and the clock from which they come.

/// A bit: one quantum for the synchronisation, `before` quanta up to the sample point, `after` quanta after it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BitTiming {
    /// Periods of the controller's clock in a quantum, 1–512.
    pub prescaler: u16,
    /// Quanta between the synchronisation and the sample point, 1–256.
    pub before: u8,
    /// Quanta after the sample point, 1–128.
    pub after: u8,
    /// Quanta by which a receiver may shift, 1–128.
    pub jump: u8,
}

/// How a bit may be divided, and where it is sampled.
struct Rule {
    /// The finest division that is tried.
    most_quanta: u32,
    /// Fewer quanta do not place a sample point well.
    fewest_quanta: u32,
    most_prescaler: u32,
    /// The sample point in eighths of the bit, and the eighths of a quantum that are added before it is rounded down.
    sample: u32,
    round: u32,
}

/// More than 85 quanta gain nothing at 10 kbit/s to 1 Mbit/s. Sampled at seven eighths (CiA 301), rounded down.
const NOMINAL: Rule = Rule {
    most_quanta: 85,
    fewest_quanta: 8,
    most_prescaler: 512,
    sample: 7,
    round: 0,
};

/// An M_CAN has room for 32 quanta before the sample point and for 16 after it, and measures the delay of its
/// transceiver with a prescaler of 1 or 2 alone. Sampled at the quantum nearest to three quarters.
const DATA: Rule = Rule {
    most_quanta: 44,
    fewest_quanta: 6,
    most_prescaler: 2,
    sample: 6,
    round: 4,
};

impl BitTiming {
    /// The finest bit of exactly `kbit` kilobits a second from a clock of `clock_hz`. The sample point is at seven
    /// eighths (CiA 301), rounded down to a quantum. `None` where no whole number of quanta gives this rate: a rate
    /// that is nearly right is worse than none.
    #[must_use]
    pub const fn of(clock_hz: u32, kbit: u32) -> Option<Self> {
        Self::by(&NOMINAL, clock_hz, kbit)
    }

    /// The same of the data of a frame of CAN FD. The sample point is at three quarters, to the nearest quantum: behind
    /// it there is room for the edges that a fast transceiver makes of different lengths.
    #[must_use]
    pub const fn of_data(clock_hz: u32, kbit: u32) -> Option<Self> {
        Self::by(&DATA, clock_hz, kbit)
    }

    const fn by(rule: &Rule, clock_hz: u32, kbit: u32) -> Option<Self> {
        let Some(rate) = kbit.checked_mul(1000) else {
            return None;
        };
        if rate == 0 || !clock_hz.is_multiple_of(rate) {
            return None;
        }
        let clocks = clock_hz / rate;
        let mut quanta = rule.most_quanta;
        while quanta >= rule.fewest_quanta {
            if clocks.is_multiple_of(quanta) && clocks / quanta <= rule.most_prescaler {
                let sample = (quanta * rule.sample + rule.round) / 8;
                let after = quanta - sample;
                return Some(Self {
                    prescaler: (clocks / quanta) as u16,
                    before: (sample - 1) as u8,
                    after: after as u8,
                    // As far as the sample point permits: this tolerates the largest difference of oscillators.
                    jump: after as u8,
                });
            }
            quanta -= 1;
        }
        None
    }

    /// Periods of the controller's clock in a bit.
    #[must_use]
    pub const fn clocks(&self) -> u32 {
        self.prescaler as u32 * (1 + self.before as u32 + self.after as u32)
    }

    /// The place of the sample point, in thousandths of the bit.
    #[must_use]
    pub const fn sample_permille(&self) -> u32 {
        let before = 1 + self.before as u32;
        before * 1000 / (before + self.after as u32)
    }
}

/// The clock of a CAN controller, and its bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rates {
    /// Which of the clocks that it can have.
    pub clock: usize,
    /// The bit of all classical frames, and of the head and the end of others.
    pub nominal: BitTiming,
    /// The bit of the data of CAN FD frames; `None` where its rate does not come out.
    pub data: Option<BitTiming>,
}

impl Rates {
    /// The first of `clocks_hz` that gives both rates; where none does, the first that gives the nominal one.
    #[must_use]
    pub fn of(clocks_hz: &[u32], kbit: u32, data_kbit: u32) -> Option<Self> {
        let each = || {
            clocks_hz.iter().enumerate().filter_map(|(clock, hz)| {
                Some(Self {
                    clock,
                    nominal: BitTiming::of(*hz, kbit)?,
                    data: BitTiming::of_data(*hz, data_kbit),
                })
            })
        };
        each()
            .find(|rates| rates.data.is_some())
            .or_else(|| each().next())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The crystal and the PLL of the board.
    const CLOCKS: [u32; 2] = [24_000_000, 85_000_000];

    #[test]
    fn data_come_from_the_crystal_or_from_the_pll() {
        // kbit/s: the clock, prescaler, quanta before and after the sample point.
        let expected = [
            (1000, Some((0, 1, 17, 6))),
            (2000, Some((0, 1, 8, 3))),
            (4000, Some((0, 1, 4, 1))),
            (5000, Some((1, 1, 12, 4))),
            (8000, None),
        ];
        for (kbit, expected) in expected {
            for nominal in [125, 250, 500, 1000] {
                let rates = Rates::of(&CLOCKS, nominal, kbit).unwrap();
                let hz = CLOCKS[rates.clock];
                assert_eq!(Some(rates.nominal), BitTiming::of(hz, nominal));
                assert_eq!(rates.nominal.clocks() * nominal * 1000, hz);
                let found = rates.data.map(|data| {
                    assert_eq!(data.clocks() * kbit * 1000, hz);
                    assert_eq!(data.jump, data.after);
                    (rates.clock, data.prescaler, data.before, data.after)
                });
                assert_eq!(found, expected, "{nominal} and {kbit} kbit/s");
            }
        }
        // 800 kbit/s come from the crystal alone.
        let slow = Rates::of(&CLOCKS, 800, 5000).unwrap();
        assert_eq!((slow.clock, slow.data), (0, None));
        assert_eq!(Rates::of(&CLOCKS, 700, 5000), None);
    }

    #[test]
    fn every_bit_of_data_fits_the_registers() {
        for clock in [20_000_000, 24_000_000, 40_000_000, 80_000_000, 85_000_000] {
            for kbit in [1000, 2000, 4000, 5000, 8000] {
                let Some(timing) = BitTiming::of_data(clock, kbit) else {
                    continue;
                };
                assert_eq!(timing.clocks() * kbit * 1000, clock);
                assert!((1..=2).contains(&timing.prescaler));
                assert!((1..=32).contains(&timing.before));
                assert!((1..=16).contains(&timing.after) && timing.jump <= timing.after);
                assert!(
                    (700..=834).contains(&timing.sample_permille()),
                    "{timing:?}"
                );
            }
        }
        // CiA 601: 80 MHz give every rate.
        for kbit in [2000, 4000, 5000, 8000] {
            assert!(BitTiming::of_data(80_000_000, kbit).is_some());
        }
    }

    #[test]
    fn one_megabit_from_24_mhz() {
        let timing = BitTiming::of(24_000_000, 1000).unwrap();
        let expected = BitTiming {
            prescaler: 1,
            before: 20,
            after: 3,
            jump: 3,
        };
        assert_eq!(timing, expected);
        assert_eq!(timing.sample_permille(), 875);
    }

    #[test]
    fn every_rate_of_canopen_is_exact_and_fits_the_registers() {
        for clock in [24_000_000, 80_000_000, 170_000_000] {
            for kbit in [10, 20, 50, 125, 250, 500, 800, 1000] {
                let Some(timing) = BitTiming::of(clock, kbit) else {
                    // 170 MHz is not a multiple of 800 kbit/s.
                    assert_eq!(kbit, 800);
                    assert_ne!(clock % 800_000, 0);
                    continue;
                };
                assert_eq!(timing.clocks() * kbit * 1000, clock);
                assert!((1..=512).contains(&timing.prescaler));
                assert!((1..=128).contains(&timing.after) && timing.jump <= timing.after);
                assert!((825..=875).contains(&timing.sample_permille()));
            }
        }
    }

    #[test]
    fn a_rate_that_does_not_come_out_is_refused() {
        assert_eq!(BitTiming::of(24_000_000, 0), None);
        assert_eq!(BitTiming::of(24_000_000, 700), None);
        assert_eq!(BitTiming::of(24_000_000, u32::MAX), None);
        // Five clocks are too few for a bit.
        assert_eq!(BitTiming::of(5_000_000, 1000), None);
    }
}
