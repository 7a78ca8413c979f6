//! Peak speed, acceleration and jerk by finite differences of the setpoints, exact in nanometres per tick.

use super::Setpoint;

/// The largest magnitudes of one axis, in nanometres (C: millionths of a degree) per tick, tick² and tick³.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Peak {
    /// First difference.
    pub speed: i64,
    /// Second difference.
    pub acceleration: i64,
    /// Third difference.
    pub jerk: i64,
}

impl Peak {
    fn take(&mut self, differences: [i64; 3]) {
        self.speed = self.speed.max(differences[0].abs());
        self.acceleration = self.acceleration.max(differences[1].abs());
        self.jerk = self.jerk.max(differences[2].abs());
    }
}

/// Peaks of X, Z and C; apart for ticks that are locked to the spindle, where the spindle makes the speed.
#[derive(Clone, Debug, Default)]
pub struct Peaks {
    /// Where time is the master.
    pub free: [Peak; 3],
    /// Where the spindle is: any of the four setpoints of a difference is locked.
    pub locked: [Peak; 3],
    last: Option<[i64; 3]>,
    differences: [[i64; 2]; 3],
    since_locked: u8,
}

impl Peaks {
    /// Takes in the next tick; gives the speeds of X, Z and C in nanometres per tick.
    pub fn push(&mut self, point: &Setpoint) -> [i64; 3] {
        let now = [point.x_nm, point.z_nm, point.c_udeg];
        let Some(last) = self.last.replace(now) else {
            return [0; 3];
        };
        // A third difference looks at four setpoints: those that follow a locked one still contain it.
        self.since_locked = if point.error_nm.is_some() {
            0
        } else {
            self.since_locked.saturating_add(1)
        };
        let peaks = if self.since_locked < 4 {
            &mut self.locked
        } else {
            &mut self.free
        };
        let mut speeds = [0; 3];
        for (axis, peak) in peaks.iter_mut().enumerate() {
            let [old_speed, old_acceleration] = self.differences[axis];
            let speed = now[axis] - last[axis];
            let acceleration = speed - old_speed;
            peak.take([speed, acceleration, acceleration - old_acceleration]);
            self.differences[axis] = [speed, acceleration];
            speeds[axis] = speed;
        }
        speeds
    }

    /// Both kinds of ticks together.
    pub fn overall(&self) -> [Peak; 3] {
        std::array::from_fn(|axis| Peak {
            speed: self.free[axis].speed.max(self.locked[axis].speed),
            acceleration: self.free[axis]
                .acceleration
                .max(self.locked[axis].acceleration),
            jerk: self.free[axis].jerk.max(self.locked[axis].jerk),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_are_exact() {
        let mut peaks = Peaks {
            since_locked: 9,
            ..Peaks::default()
        };
        for (tick, x_nm) in [0, 0, 1, 4, 9, 10, 10].into_iter().enumerate() {
            peaks.push(&Setpoint {
                tick: tick as u64,
                x_nm,
                ..Setpoint::default()
            });
        }
        // Speeds 0 1 3 5 1 0, second 1 2 2 −4 −1, third 1 1 0 −6 3.
        let expected = Peak {
            speed: 5,
            acceleration: 4,
            jerk: 6,
        };
        assert_eq!(peaks.free[0], expected);
        assert_eq!(peaks.overall()[0], expected);
        assert_eq!(peaks.free[1], Peak::default());
    }
}
