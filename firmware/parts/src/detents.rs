//! Detents of a handwheel from a counter of edges.
//!
//! A handwheel stands still in its detents, four edges apart. There a line may be on an edge, so that the counter goes to
//! and fro by one: that is no detent.

/// Edges between two detents.
const EDGES: i32 = 4;

/// Counts detents.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Detents {
    /// The counter at the last reading.
    edges: u16,
    /// Edges since the detent that is told.
    beyond: i32,
    /// The detent that is told. It wraps.
    count: u16,
}

impl Detents {
    /// The detent of a counter of 16 bits that wraps. Needs a reading before the counter has gone half of its way round.
    pub const fn of(&mut self, edges: u16) -> u16 {
        let more = edges.wrapping_sub(self.edges).cast_signed();
        self.edges = edges;
        self.beyond = self.beyond.saturating_add(more as i32);
        // The nearest detent, once the counter is beyond the middle.
        let detents = if self.beyond.abs() > EDGES / 2 {
            self.beyond.saturating_add(EDGES / 2 * self.beyond.signum()) / EDGES
        } else {
            0
        };
        self.beyond = self.beyond.saturating_sub(detents.saturating_mul(EDGES));
        self.count = self.count.wrapping_add_signed(detents as i16);
        self.count
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn four_edges_are_a_detent_and_one_that_trembles_is_none() {
        let mut wheel = Detents::default();
        for (edges, count) in [
            (0_i16, 0_i16),
            (1, 0),
            (-1, 0),
            (2, 0),
            (4, 1),
            (3, 1),
            (5, 1),
            (4, 1),
            (0, 0),
            (-8, -2),
            (-7, -2),
            (-9, -2),
            (-12, -3),
            (400, 100),
            (405, 101),
            (394, 98),
        ] {
            assert_eq!(wheel.of(edges as u16).cast_signed(), count, "{edges}");
        }
    }

    /// However often it is read: the same detents, and both counters wrap.
    #[test]
    fn it_counts_on_over_the_end_of_both_counters() {
        for step in [1_u32, 3, 4, 7, 401, 30_000] {
            let mut wheel = Detents::default();
            let mut edges = 0_u32;
            while edges < 900_000 {
                edges += step;
                let detent = wheel.of(edges as u16);
                let beyond = (edges as u16).wrapping_sub(detent.wrapping_mul(4));
                assert!(beyond.cast_signed().abs() <= 2, "{step}: {edges}");
            }
            let rest = edges.next_multiple_of(4);
            assert_eq!(wheel.of(rest as u16), (rest / 4) as u16, "{step}");
        }
    }
}
