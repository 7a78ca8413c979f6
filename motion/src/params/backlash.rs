//! What backlash (1851) leaves of the limits of an axis.

use super::Params;
use crate::units::{Acceleration, Axis, Jerk};

/// Where an axis has backlash, putting it in may use one part in so many of the axis' acceleration and jerk, and the
/// motion of the axis uses the others.
pub const TAKE_UP_PART: u64 = 4;

impl Params {
    fn has_backlash(&self, axis: Axis) -> bool {
        self.backlash(axis).is_some_and(|way| way != 0)
    }

    /// The largest acceleration of the motion of an axis: 1620, less what is kept for its backlash.
    #[must_use]
    pub fn motion_acceleration(&self, axis: Axis) -> Acceleration {
        let highest = self.acceleration(axis);
        if self.has_backlash(axis) {
            Acceleration::from_nm_per_s2(left(highest.nm_per_s2()))
        } else {
            highest
        }
    }

    /// The largest jerk of the motion of an axis: 1622, less what is kept for its backlash.
    #[must_use]
    pub fn motion_jerk(&self, axis: Axis) -> Jerk {
        let highest = self.jerk(axis);
        if self.has_backlash(axis) {
            Jerk::from_nm_per_s3(left(highest.nm_per_s3()))
        } else {
            highest
        }
    }
}

fn left(limit: i64) -> i64 {
    let kept = limit.unsigned_abs().checked_div(TAKE_UP_PART).unwrap_or(0);
    limit.saturating_sub_unsigned(kept)
}
