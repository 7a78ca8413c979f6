//! Where the drive of a thread's axis was, against the helix: the cut, as far as the drive's own encoder shows it [D380].
//!
//! 6064h of SYNC k says where the axis was at `t_k − d_a`, where d_a is its age (9072). So the error of the cut is that
//! position less the helix at the angle of the spindle at that instant. Angles of the last SYNCs are kept for it. Nothing
//! of this is in the tick.
//!
//! Must not know frames, or what becomes of an error.

use crate::bus::{Periods, Scale};
use crate::params::Params;
use crate::tick::{Followed, Snapshot};
use crate::units::{Axis, Length, Turns};

/// Angles kept. A position that is older is not judged.
const KEPT: usize = 8;

/// The error of the cut at one actual position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sample {
    /// The drive's position, less the helix.
    pub error: Length,
    /// The angle at that instant.
    pub angle: Turns,
    /// X is the long axis.
    pub on_x: bool,
    /// Way of the helix in a turn, with its sign.
    pub lead: Length,
    /// The way of the axis in a second.
    pub per_second: Length,
    /// Before so many ticks of a stroke the drive was not on its helix yet: the first setpoint there had not taken effect.
    pub after: u32,
}

/// The last angles and the last setpoint.
#[derive(Debug)]
pub struct Actual {
    angles: [Turns; KEPT],
    newest: usize,
    known: usize,
    /// The setpoint of the tick before, on X and Z.
    last: [Length; 2],
}

impl Actual {
    // [D146]
    #[inline(always)]
    pub const fn new() -> Self {
        Self {
            angles: [Turns::ZERO; KEPT],
            newest: 0,
            known: 0,
            last: [Length::ZERO; 2],
        }
    }

    /// Takes the next tick, and gives the error at the drive's position where one has come.
    pub fn judge(
        &mut self,
        elapsed: Periods,
        now: &Snapshot,
        followed: Option<&Followed>,
        params: &Params,
    ) -> Option<Sample> {
        if elapsed != Periods::new(1) {
            // Between two angles that are kept lies one SYNC.
            self.known = 0;
        }
        self.newest = self.newest.wrapping_add(1) % KEPT;
        if let Some(place) = self.angles.get_mut(self.newest) {
            *place = now.spindle;
        }
        self.known = self.known.saturating_add(1).min(KEPT);
        let sample = followed.and_then(|followed| self.sample(followed, now, params));
        self.last = [now.setpoint.position.x, now.setpoint.position.z];
        sample
    }

    #[inline(never)]
    fn sample(&self, followed: &Followed, now: &Snapshot, params: &Params) -> Option<Sample> {
        let [x, z] = self.last;
        let (axis, set) = if followed.on_x {
            (Axis::X, x)
        } else {
            (Axis::Z, z)
        };
        let (tick, age) = (params.tick_us(), params.actual_age_us(axis));
        // The status was sent for the SYNC before.
        let angle = self.angle(tick.saturating_add(age), tick)?;
        let lead = followed.lead();
        let turned = angle - now.spindle;
        let way = lead.nm().wrapping_mul(turned.raw()) >> 32;
        let helix = set - followed.off() + Length::from_nm(way);
        let scale = Scale::new(params.drive_numerator(axis), params.drive_denominator(axis))?;
        let actual = Length::from_nm(scale.position(followed.actual));
        let speed = (now.speed.raw() >> 16).wrapping_mul(lead.nm()) >> 16;
        let within = params.actual_age_doubt_us(axis);
        let delay = params.latency_us(axis).saturating_add(age);
        let delay = delay.saturating_add(within);
        Some(Sample {
            error: actual - helix,
            angle,
            on_x: followed.on_x,
            lead,
            per_second: Length::from_nm(speed).abs(),
            after: delay.div_ceil(tick.max(1)).saturating_add(2),
        })
    }

    /// The angle so long before the last SYNC.
    fn angle(&self, before_us: u32, tick_us: u32) -> Option<Turns> {
        let back = before_us.checked_div(tick_us)?;
        let rest = before_us.checked_rem(tick_us)?;
        let [later, earlier] = [back, back.saturating_add(1)].map(|back| self.kept(back as usize));
        let (later, earlier) = (later?, earlier?);
        // Below 2³¹: a tick is 20 ms at most.
        let part = rest.wrapping_shl(16).checked_div(tick_us)?;
        let turned = (later - earlier).raw().wrapping_mul(part.into()) >> 16;
        Some(later - Turns::from_raw(turned))
    }

    fn kept(&self, back: usize) -> Option<Turns> {
        if back >= self.known {
            return None;
        }
        let place = self.newest.wrapping_add(KEPT).wrapping_sub(back) % KEPT;
        self.angles.get(place).copied()
    }
}

#[cfg(test)]
#[allow(clippy::arithmetic_side_effects)]
mod tests {
    use super::*;
    use crate::board::{Board, Contacts};
    use crate::bus::Increments;
    use crate::motion::Setpoint;

    /// The error that is found where the drive is `off` nanometres off the helix of lead 6 mm at the instant of its
    /// position, `age_us` before the SYNC, while the spindle turns by 2²⁶ in a tick; 9072 is `told_us`.
    fn found(off: i64, age_us: i64, told_us: i64, lead: i64) -> Option<i64> {
        let mut params = Params::sheets();
        for (number, value) in [("9072.Z", told_us), ("9003.Z", 2_500)] {
            let entry = crate::params::Entry::find_text(number).unwrap();
            params.set(entry, value).unwrap();
        }
        let board = Board::new(&params, None, None).unwrap();
        let mut now = Snapshot::new(board.ticker(), &Setpoint::default(), Contacts::default());
        let mut actual = Actual::new();
        let helix = |tick: i64, before_us: i64| {
            let turned = tick * (1 << 26) - before_us * (1 << 26) / 1000;
            ((i128::from(lead) * i128::from(turned)) >> 32) as i64
        };
        let mut last = None;
        for tick in 0..40 {
            now.spindle = Turns::from_raw(tick << 26);
            // The setpoint is 700 nm off the helix at the angle of this SYNC.
            let place = (helix(tick - 1, age_us) + off) / 100;
            let followed = Followed::new(
                Increments::new(place as i32),
                false,
                Length::from_nm(lead),
                Length::from_nm(700),
            );
            now.setpoint.position.z = Length::from_nm(helix(tick + 1, 0) + 700);
            last = actual.judge(Periods::new(1), &now, Some(&followed), &params);
        }
        let sample = last?;
        assert_eq!(sample.after, 2 + (3_500 + told_us as u32).div_ceil(1000));
        assert_eq!(sample.lead, Length::from_nm(lead));
        Some(sample.error.nm())
    }

    #[test]
    fn an_error_put_in_comes_out_at_any_age() {
        for lead in [6_000_000, -6_000_000, 500_000] {
            for age in [0, 1, 250, 999, 1_000, 5_300] {
                for off in [0, 12_300, -45_600] {
                    let found = found(off, age, age, lead).unwrap();
                    assert!(
                        (found - off).abs() <= 102,
                        "lead {lead}, age {age}: {off} is {found}"
                    );
                }
            }
        }
    }

    /// 60 mm/s at a 64th of a turn in a tick of lead 6: 93.75 nm in a microsecond.
    #[test]
    fn a_wrong_age_is_an_error_of_the_way_in_that_time() {
        let found = found(0, 500, 300, 6_000_000).unwrap();
        assert!((found + 200 * 9375 / 100).abs() <= 102, "{found}");
    }

    #[test]
    fn what_is_older_than_the_angles_kept_is_not_judged() {
        assert!(found(0, 5_999, 5_999, 6_000_000).is_some());
        assert_eq!(found(0, 6_000, 6_000, 6_000_000), None);
    }

    #[test]
    fn after_a_missed_tick_the_angles_are_gathered_anew() {
        let board = Board::new(&Params::sheets(), None, None).unwrap();
        let now = Snapshot::new(board.ticker(), &Setpoint::default(), Contacts::default());
        let params = Params::sheets();
        let followed = Followed::new(Increments::new(0), false, Length::ZERO, Length::ZERO);
        let mut actual = Actual::new();
        let mut judged =
            |elapsed| actual.judge(Periods::new(elapsed), &now, Some(&followed), &params);
        let told = [1, 1, 1, 2, 1, 1].map(|elapsed| judged(elapsed).is_some());
        assert_eq!(told, [false, false, true, false, false, true]);
    }
}
