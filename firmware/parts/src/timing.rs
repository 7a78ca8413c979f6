//! Segments of a CAN bit.

/// A nominal bit: one quantum for the synchronisation, `before` quanta up to the sample point, `after` quanta after it.
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

/// The finest division that is tried: more than 80 quanta gain nothing at 10 kbit/s to 1 Mbit/s.
const MOST_QUANTA: u32 = 80;
/// Fewer quanta do not place a sample point well.
const FEWEST_QUANTA: u32 = 8;

impl BitTiming {
    /// The finest bit of exactly `kbit` kilobits a second from a clock of `clock_hz`. The sample point is at seven
    /// eighths (CiA 301), rounded down to a quantum. `None` where no whole number of quanta gives this rate: a rate
    /// that is nearly right is worse than none.
    #[must_use]
    pub const fn of(clock_hz: u32, kbit: u32) -> Option<Self> {
        let Some(rate) = kbit.checked_mul(1000) else {
            return None;
        };
        if rate == 0 || !clock_hz.is_multiple_of(rate) {
            return None;
        }
        let clocks = clock_hz / rate;
        let mut quanta = MOST_QUANTA;
        while quanta >= FEWEST_QUANTA {
            if clocks.is_multiple_of(quanta) && clocks / quanta <= 512 {
                let sample = quanta * 7 / 8;
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

#[cfg(test)]
mod tests {
    use super::*;

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
