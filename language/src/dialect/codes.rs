//! Which code of a control is which of system A.

use leadscrew_core::alarm::{Alarm, Arg, Code};

use super::Control;

/// Pairs: as the control writes it, and as system A does.
type Pairs = &'static [(i64, i64)];

const SYSTEM_B: Pairs = &[
    (77, 90),
    (78, 92),
    (79, 94),
    (33, 32),
    (92, 50),
    (94, 98),
    (95, 99),
];

const SYSTEM_C: Pairs = &[
    (20, 90),
    (21, 92),
    (24, 94),
    (33, 32),
    (92, 50),
    (72, 70),
    (73, 71),
    (74, 72),
    (75, 73),
    (76, 74),
    (77, 75),
    (78, 76),
    (70, 20),
    (71, 21),
    (94, 98),
    (95, 99),
];

impl Control {
    const fn pairs(self) -> Pairs {
        match self {
            Self::FanucB => SYSTEM_B,
            Self::FanucC => SYSTEM_C,
            Self::Gsk980td | Self::Gsk988 | Self::FanucA | Self::Haas => &[],
        }
    }

    /// The code of system A for `code` of this control; `None` for a code of system A that this control writes in another
    /// way, or has with another meaning.
    #[must_use]
    pub fn to_a(self, code: i64) -> Option<i64> {
        let pairs = self.pairs();
        match pairs.iter().find(|(own, _)| *own == code) {
            Some((_, a)) => Some(*a),
            None if pairs.iter().any(|(_, a)| *a == code) => None,
            None => Some(code),
        }
    }

    /// How this control writes `code` of system A.
    #[must_use]
    pub fn written(self, code: i64) -> i64 {
        let pair = self.pairs().iter().find(|(_, a)| *a == code);
        pair.map_or(code, |(own, _)| *own)
    }

    /// The alarm with the codes as this control writes them.
    #[must_use]
    pub fn in_own_codes(self, mut alarm: Alarm) -> Alarm {
        if alarm.code == Code::UnknownG {
            // It names what was written.
            return alarm;
        }
        for arg in &mut alarm.args {
            if let Arg::GCode(tenths) = arg
                && let Ok(own) = u16::try_from(self.written(i64::from(*tenths / 10)))
                && *tenths % 10 == 0
            {
                *tenths = own * 10;
            }
        }
        alarm
    }
}
