//! How far a handwheel has been turned since its claim.
//!
//! Must not know where the axis is, or whether anything can follow.

use crate::bus::WheelRequest;
use crate::operating::Led;
use crate::params::Params;
use crate::units::Length;

/// A wheel that has gone farther between two frames was away: it counts on from where it is now.
const FARTHEST: u16 = 16_384;

/// The way of one claim.
#[derive(Debug, Default)]
pub struct WheelWay {
    leads: Led,
    /// The count of the last frame.
    count: u16,
    /// The way of the slide, or along the path, signed.
    way: Length,
}

impl WheelWay {
    /// The claim of this frame: the wheel counts from here.
    pub const fn begin(request: &WheelRequest) -> Self {
        Self {
            leads: request.leads,
            count: request.count,
            way: Length::ZERO,
        }
    }

    /// The way since the claim, or since it was taken.
    pub const fn way(&self) -> Length {
        self.way
    }

    /// Takes the way: it counts from here.
    pub const fn take(&mut self) -> Length {
        core::mem::replace(&mut self.way, Length::ZERO)
    }

    /// Takes a frame. False for one that leads something else: a claim is for one.
    pub fn turn(&mut self, request: &WheelRequest, params: &Params) -> bool {
        if request.leads != self.leads {
            return false;
        }
        let counts = request.count.wrapping_sub(self.count) as i16;
        self.count = request.count;
        if counts.unsigned_abs() <= FARTHEST {
            let one = request.factor.of(increment(self.leads, params));
            let way = one.nm().saturating_mul(counts.into());
            self.way += Length::from_nm(way);
        }
        true
    }
}

/// What a count is worth: an input increment of the axis (X counts on the diameter), or a micrometre of the path.
fn increment(leads: Led, params: &Params) -> Length {
    let increment = if params.increment_is_c() { 100 } else { 1000 };
    Length::from_nm(match leads {
        Led::X => increment / 2,
        Led::Z => increment,
        Led::Path => 1000,
    })
}
