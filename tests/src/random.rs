//! Random numbers from a seed.

/// SplitMix64.
#[derive(Clone, Debug)]
pub struct Random(pub u64);

impl Random {
    /// The next 64 bits.
    pub fn next_bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// True in so many cases of a hundred.
    pub fn chance(&mut self, percent: u64) -> bool {
        chance(self.next_bits(), percent)
    }

    /// `low` to `high`, both included.
    pub fn within(&mut self, low: i64, high: i64) -> i64 {
        within(self.next_bits(), low, high)
    }

    /// A length between two numbers of micrometres, on a grid of `lsb` nanometres.
    pub fn length(&mut self, low_um: i64, high_um: i64, lsb: i64) -> i64 {
        self.within(low_um * 1000, high_um * 1000) / lsb * lsb
    }

    /// 1 or −1.
    pub fn sign(&mut self) -> i64 {
        if self.chance(50) { 1 } else { -1 }
    }

    /// One of a list.
    pub fn of<T: Copy>(&mut self, list: &[T]) -> T {
        of(self.next_bits(), list)
    }
}

/// True for so many bits of a hundred.
pub fn chance(bits: u64, percent: u64) -> bool {
    bits % 100 < percent
}

/// `low` to `high`, both included, by these bits.
pub fn within(bits: u64, low: i64, high: i64) -> i64 {
    low + (bits % (high - low + 1) as u64) as i64
}

/// One of a list, by these bits.
pub fn of<T: Copy>(bits: u64, list: &[T]) -> T {
    list[(bits % list.len() as u64) as usize]
}
