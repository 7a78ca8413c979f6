//! Quantities with their units in the type.
//!
//! Knows nothing of the rest of the core. Every quantity is an integer: lengths are nanometres (a nanometre divides
//! every metric and inch input increment exactly, halved for a diameter too), rotary axes are millionths of a degree,
//! the spindle is counted in 2⁻³² turns, and a lead is an exact ratio of nanometres to turns. `+`, `-` and negation
//! saturate at the range of the integer; inputs are bounded far below it ([`Length::INPUT_LIMIT`]), so a saturated
//! value is never a legal position.

mod angle;
mod axis;
mod decimal;
mod feed;
mod length;
pub(crate) mod plane;
mod rate;
mod ratio;
mod root;
mod trig;
mod wide;

pub use angle::{Angle, StartAngle, Turns};
pub use axis::{Acceleration, Axis, Jerk};
pub use decimal::{Decimal, DecimalError};
pub use feed::{CentiRpm, Feed, FeedPerTurn, Lead, Millis, Rpm};
pub use length::{Diameter, Length, Remainder};
pub use rate::{Ticks, TurnRate};
pub use ratio::TurnRatio;
pub(crate) use root::{root, root_wide};
pub use trig::Direction;
pub use wide::{Divisor, mul_div, mul_high};
pub(crate) use wide::{div_wide, mul_wide, narrow_div, product, signed, signed_product};
