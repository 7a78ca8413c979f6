//! Quantities with their units in the type.
//!
//! Knows nothing of the rest of the core. Every quantity is exact: lengths are nanometres (a nanometre divides
//! every metric and inch input increment exactly, halved for a diameter too), rotary axes are millionths of a degree,
//! a lead is an exact ratio of nanometres to turns. What is a binary fraction (turns, rates, ticks) is a type of the crate
//! `fixed` inside, with its point in the type. `+`, `-` and negation
//! saturate at the range of the type; inputs are bounded far below it ([`Length::INPUT_LIMIT`]), so a saturated
//! value is never a legal position.

/// A binary fraction travels as its bits.
macro_rules! as_bits {
    ($type:ident) => {
        impl serde::Serialize for $type {
            fn serialize<S: serde::Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
                self.raw().serialize(to)
            }
        }
        impl<'de> serde::Deserialize<'de> for $type {
            fn deserialize<D: serde::Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
                i64::deserialize(from).map(Self::from_raw)
            }
        }
        impl postcard_schema::Schema for $type {
            const SCHEMA: &'static postcard_schema::schema::NamedType =
                &postcard_schema::schema::NamedType {
                    name: stringify!($type),
                    ty: &postcard_schema::schema::DataModelType::NewtypeStruct(i64::SCHEMA),
                };
        }
    };
}

mod angle;
mod axis;
mod change;
mod decimal;
mod feed;
mod length;
pub mod plane;
mod rate;
mod ratio;
mod root;
mod trig;
mod wide;

pub use angle::{Angle, StartAngle, Turns};
pub use axis::{Acceleration, Axes, Axis, Jerk};
pub use change::LeadChange;
pub use decimal::{Decimal, DecimalError};
pub use feed::{CentiRpm, Feed, FeedPerTurn, Lead, Millis, Rpm};
pub use length::{Diameter, Length, Remainder};
pub use rate::{Ticks, TurnRate};
pub use ratio::TurnRatio;
pub use root::{root, root_wide};
pub use trig::Direction;
pub use wide::{Divisor, mul_div, mul_high};
pub use wide::{div_wide, mul_wide, narrow_div, product, signed, signed_product};
