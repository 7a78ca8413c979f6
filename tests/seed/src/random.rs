//! Numbers at random: from a seed the same ones on every computer.

/// A linear congruential generator modulo 2⁶⁴, with the constants of Knuth's MMIX.
#[derive(Clone, Debug)]
pub struct Random(pub u64);

impl Random {
    /// The next 64 bits. The upper ones are the better ones: the lowest only alternates.
    pub const fn bits(&mut self) -> u64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        self.0
    }

    /// The next number below a limit of at most 2³¹.
    ///
    /// # Panics
    /// Where the limit is 0.
    pub const fn below(&mut self, limit: u64) -> u64 {
        (self.bits() >> 33) % limit
    }

    /// The same of an index: below a length of at most 2³¹.
    ///
    /// # Panics
    /// Where the length is 0.
    pub const fn index(&mut self, length: usize) -> usize {
        self.below(length as u64) as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_seed_gives_its_numbers() {
        let mut random = Random(1);
        assert_eq!(random.bits(), 7_806_831_264_735_756_412);
        assert_eq!(random.below(10), (random.clone().0 >> 33) % 10);
        let (mut one, mut other) = (Random(7), Random(7));
        for limit in 1..100 {
            let below = one.below(limit);
            assert!(below < limit);
            assert_eq!(below as usize, other.index(limit as usize));
        }
    }
}
