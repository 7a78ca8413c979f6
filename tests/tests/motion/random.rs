//! Random numbers.

pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11
    }

    /// 0 … range − 1.
    pub fn below(&mut self, range: i64) -> i64 {
        (self.next() % range as u64) as i64
    }

    /// From `low` to `high`, every decade as likely as any other.
    pub fn decades(&mut self, low: f64, high: f64) -> i64 {
        let share = self.next() as f64 / (1_u64 << 53) as f64;
        (low.ln() + share * (high / low).ln()).exp().round() as i64
    }

    pub fn one_in(&mut self, n: i64) -> bool {
        self.below(n) == 0
    }
}
