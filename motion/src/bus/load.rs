//! The bus load of the cycle, with the most stuff bits possible in every frame.
//!
//! | sent | frame |
//! |---|---|
//! | every tick | SYNC with its counter; RPDO1 of each drive, or one CAN FD frame with all setpoints |
//! | every fourth tick | RPDO1 of each spindle that only taps, while it does not tap |
//! | every n-th SYNC | TPDO1 of each drive |
//! | every 16th SYNC | TPDO2 of each axis with a reference; as often, in homing, its RPDO2 |
//! | every status period | TPDO1–3 and TPDO5 of the board |

use super::fd::FdBits;
use crate::alarm::{Alarm, Arg, Code};
use crate::params::Params;
use crate::units::Axis;

/// Drives that get a setpoint in every tick: X, Z, C and one spindle.
const DRIVES: u32 = 4;

/// The frames and times of the cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cycle {
    /// Time from SYNC to SYNC in microseconds, above zero.
    pub tick_us: u32,
    /// Bit rate in kbit/s.
    pub kbit: u32,
    /// Drives that get a setpoint in every tick.
    pub drives: u32,
    /// Drives of spindles that only tap: they get a setpoint in every fourth tick while they do not tap.
    pub further: u32,
    /// Each drive answers once in this number of SYNCs.
    pub drive_syncs: u32,
    /// Axes with a reference to find: their drives tell mode and inputs.
    pub homing: u32,
    /// Time from status to status of the board in milliseconds.
    pub status_ms: u32,
    /// Data rate in kbit/s of the one CAN FD frame with all setpoints; 0: each drive gets its own RPDO1.
    pub fd_kbit: u32,
}

/// Bits of a classical frame with `bytes` bytes of data, with intermission and the most stuff bits possible.
#[must_use]
pub const fn frame_bits(bytes: u32) -> u32 {
    let data = bytes.saturating_mul(8);
    // Bit stuffing covers the data and 34 other bits: at worst one stuff bit for every four bits after the first. 13
    // bits are never stuffed.
    let stuffed = data.saturating_add(34);
    stuffed
        .saturating_add(13)
        .saturating_add(stuffed.saturating_sub(1) / 4)
}

impl Cycle {
    /// The largest load of a cycle, in tenths of a percent: the rest is for transfers and commands.
    pub const MOST: u32 = 900;

    /// The cycle of a board with these parameters.
    #[must_use]
    pub fn of(params: &Params) -> Self {
        let tells_inputs = |axis: &&Axis| params.drive_tells_inputs(**axis);
        Self {
            tick_us: params.tick_us(),
            kbit: params.bus_kbit(),
            drives: DRIVES,
            further: u32::from(params.tap_spindles()).saturating_sub(1),
            drive_syncs: params.drive_status_syncs(),
            homing: Axis::ALL.iter().filter(tells_inputs).count() as u32,
            status_ms: params.status_period_ms(),
            fd_kbit: match params.setpoint_frame() {
                1 => params.fd_kbit(),
                _ => 0,
            },
        }
    }

    /// The load in tenths of a percent.
    #[must_use]
    pub fn load(&self) -> u32 {
        let all = self.all();
        let [sync, setpoint, status] = const { [frame_bits(1), frame_bits(6), frame_bits(8)] };
        let report = const { frame_bits(5).saturating_add(frame_bits(1)) };
        let (alone, together) = match self.together() {
            Some(together) => ([0; 2], together),
            None => ([self.drives, self.further], 0),
        };
        let [drives, further] = alone;
        // Each row: bits of a frame, two factors of its period in microseconds, number of such frames.
        let sent = [
            (sync, self.tick_us, 1, 1),
            (setpoint, self.tick_us, 1, drives),
            (setpoint, self.tick_us, 4, further),
            (together, self.tick_us, 1, 1),
            (setpoint, self.tick_us, self.drive_syncs, all),
            (report, self.tick_us, 16, self.homing),
            (status, self.status_ms, 1000, 4),
        ];
        let mut thousandths = 0_u64;
        for (bits, times, us, frames) in &sent {
            // The product of two 32-bit numbers fits.
            let every_us = u64::from(*times).wrapping_mul(u64::from(*us));
            let bits = u64::from(*bits).wrapping_mul(100_000_000);
            // Load in thousandths of a percent: bits · 10⁸ / (kbit/s · µs). The sum is rounded to tenths of a percent.
            let share = bits
                .checked_div(every_us.saturating_mul(self.kbit.into()))
                .unwrap_or(u64::from(u32::MAX));
            let shares = share.saturating_mul(u64::from(*frames));
            thousandths = thousandths.saturating_add(shares);
        }
        u32::try_from(thousandths.saturating_add(50) / 100).unwrap_or(u32::MAX)
    }

    /// All drives.
    const fn all(&self) -> u32 {
        self.drives.saturating_add(self.further)
    }

    /// The bits of the frame of CAN FD with all setpoints; `None` where each drive has its own frame.
    fn together(&self) -> Option<u32> {
        let bits = FdBits::of(self.all().saturating_mul(6));
        (self.fd_kbit != 0).then(|| bits.at(self.kbit, self.fd_kbit))
    }

    /// The bits that SYNC and the setpoints of a period leave, and those of the longest frame that has to fit between
    /// them: what begins later would delay SYNC, and then a setpoint.
    fn gap(&self) -> (u32, u32) {
        let [sync, setpoint, longest] = const { [frame_bits(1), frame_bits(6), frame_bits(8)] };
        let alone = self.drives.saturating_add(self.further.div_ceil(4));
        let setpoints = self.together().unwrap_or(setpoint.saturating_mul(alone));
        let period = self.tick_us.saturating_mul(self.kbit) / 1000;
        let free = period.saturating_sub(sync).saturating_sub(setpoints);
        (free, longest)
    }

    /// Refuses a cycle with a load above [`Self::MOST`], or without room for a frame of eight bytes between the setpoints
    /// of two SYNCs.
    ///
    /// # Errors
    /// [`Code::BusOverload`], [`Code::BusNoGap`], with the figures.
    pub fn check(&self) -> Result<(), Alarm> {
        let load = self.load();
        if load > Self::MOST {
            let percent = load.saturating_add(5) / 10;
            let args = [
                Arg::Percent(i32::try_from(percent).unwrap_or(i32::MAX)),
                Arg::Int(self.tick_us.into()),
                Arg::Int(self.all().into()),
                Arg::Int(self.kbit.into()),
            ];
            return Err(Alarm::of(Code::BusOverload, &args));
        }
        let (free, longest) = self.gap();
        if free >= longest {
            return Ok(());
        }
        let us = |bits: u32| {
            let us = bits.saturating_mul(1000).checked_div(self.kbit);
            Arg::Int(us.unwrap_or(u32::MAX).into())
        };
        let args = [
            us(free),
            us(longest),
            Arg::Int(self.tick_us.into()),
            Arg::Int(self.kbit.into()),
        ];
        Err(Alarm::of(Code::BusNoGap, &args))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cycle(drives: u32, drive_syncs: u32) -> Cycle {
        Cycle {
            tick_us: 1000,
            kbit: 1000,
            drives,
            further: 0,
            drive_syncs,
            homing: 0,
            status_ms: 10,
            fd_kbit: 0,
        }
    }

    #[test]
    fn a_frame_of_each_length() {
        assert_eq!([1, 6, 8].map(frame_bits), [65, 115, 135]);
    }

    #[test]
    fn the_table_of_the_bus() {
        // SYNC 6.5, RPDO 11.5, TPDO/4 2.9, status 5.4.
        for (drives, every, load) in [
            (2, 4, 407),
            (3, 4, 550),
            (4, 4, 694),
            (2, 1, 579),
            (3, 1, 809),
            (4, 1, 1039),
        ] {
            assert_eq!(cycle(drives, every).load(), load);
        }
        let slow = Cycle {
            kbit: 500,
            tick_us: 2000,
            status_ms: 20,
            ..cycle(2, 4)
        };
        assert_eq!(slow.load(), 407);
        let four_spindles = Cycle {
            further: 3,
            ..cycle(4, 4)
        };
        assert_eq!(four_spindles.load(), 867);
    }

    #[test]
    fn an_axis_with_a_reference_costs_a_percent() {
        let homing = Cycle {
            homing: 2,
            ..cycle(2, 4)
        };
        // 105 and 65 bits in sixteen ticks, twice.
        assert_eq!(homing.load(), cycle(2, 4).load() + 21);
    }

    #[test]
    fn one_frame_for_all_setpoints_leaves_room() {
        // SYNC 6.5, TPDO/4 2.875 each, status 5.4, and 33 bits with 278, 358 or 518 at the rate of the data.
        for (further, fd_kbit, load) in [
            (0, 5000, 65 + 115 + 54 + 89),
            (0, 1000, 65 + 115 + 54 + 311),
            (1, 5000, 65 + 144 + 54 + 105),
            (3, 5000, 65 + 201 + 54 + 137),
        ] {
            let together = Cycle {
                further,
                fd_kbit,
                ..cycle(4, 4)
            };
            assert_eq!(together.load(), load, "{further} {fd_kbit}");
        }
        // Every drive sends a status at every SYNC: no room for eight such frames.
        let every = Cycle {
            fd_kbit: 5000,
            ..cycle(4, 1)
        };
        assert_eq!(every.check(), Ok(()));
    }

    #[test]
    fn what_leaves_no_room_is_refused_with_the_arithmetic() {
        assert_eq!(cycle(4, 4).check(), Ok(()));
        let alarm = cycle(4, 1).check().unwrap_err();
        assert_eq!(alarm.code, Code::BusOverload);
        assert_eq!(
            alarm.args,
            [
                Arg::Percent(104),
                Arg::Int(1000),
                Arg::Int(4),
                Arg::Int(1000)
            ]
        );
        // Seven drives every 250 µs: 202 of them go with SYNC and the setpoints. Twice as long is long enough.
        let fast = Cycle {
            tick_us: 250,
            further: 3,
            status_ms: 20,
            fd_kbit: 5000,
            ..cycle(4, 64)
        };
        let alarm = fast.check().unwrap_err();
        assert_eq!(alarm.code, Code::BusNoGap);
        assert_eq!(alarm.args, [48, 135, 250, 1000].map(Arg::Int));
        let half = Cycle {
            tick_us: 500,
            ..fast
        };
        assert_eq!(half.check(), Ok(()));
        let stopped = Cycle {
            kbit: 0,
            ..cycle(1, 4)
        };
        assert!(stopped.check().is_err());
    }
}
