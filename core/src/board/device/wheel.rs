//! How far a handwheel has been turned since its claim.
//!
//! Must not know where the axis is, or whether it can follow.

use crate::bus::WheelRequest;
use crate::params::Params;
use crate::units::Length;

/// A wheel that has gone farther between two frames was away: it counts on from where it is now.
const FARTHEST: u16 = 16_384;

/// The way of one claim.
#[derive(Debug, Default)]
pub struct WheelWay {
    on_z: bool,
    /// The count of the last frame.
    count: u16,
    /// The way of the slide, signed.
    way: Length,
}

impl WheelWay {
    /// The claim of this frame: the wheel counts from here.
    pub const fn begin(request: &WheelRequest) -> Self {
        Self {
            on_z: request.on_z,
            count: request.count,
            way: Length::ZERO,
        }
    }

    /// The way of the slide since the claim.
    pub const fn way(&self) -> Length {
        self.way
    }

    /// Takes a frame. False for one with another axis: a claim is for one.
    pub fn turn(&mut self, request: &WheelRequest, params: &Params) -> bool {
        if request.on_z != self.on_z {
            return false;
        }
        let counts = request.count.wrapping_sub(self.count) as i16;
        self.count = request.count;
        if counts.unsigned_abs() <= FARTHEST {
            let one = request.factor.of(increment(self.on_z, params));
            let way = one.nm().saturating_mul(counts.into());
            self.way += Length::from_nm(way);
        }
        true
    }
}

/// The input increment, as the slide goes: X counts on the diameter.
fn increment(on_z: bool, params: &Params) -> Length {
    let increment = if params.increment_is_c() { 100 } else { 1000 };
    Length::from_nm(if on_z { increment } else { increment / 2 })
}
