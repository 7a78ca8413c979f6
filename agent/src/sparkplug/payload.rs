//! The protobuf message of Sparkplug B: those of its fields that are used here. A reader skips the others.

use prost::{Message, Oneof};

/// A payload.
#[derive(Clone, PartialEq, Message)]
pub struct Payload {
    /// When it was sent: milliseconds since 1970.
    #[prost(uint64, optional, tag = "1")]
    pub timestamp: Option<u64>,
    /// What it says.
    #[prost(message, repeated, tag = "2")]
    pub metrics: Vec<Metric>,
    /// The sequence number of the connection.
    #[prost(uint64, optional, tag = "3")]
    pub seq: Option<u64>,
}

/// A metric.
#[derive(Clone, PartialEq, Message)]
pub struct Metric {
    /// Its name; in births alone where it has an alias.
    #[prost(string, optional, tag = "1")]
    pub name: Option<String>,
    /// Its alias.
    #[prost(uint64, optional, tag = "2")]
    pub alias: Option<u64>,
    /// When it was so: milliseconds since 1970.
    #[prost(uint64, optional, tag = "3")]
    pub timestamp: Option<u64>,
    /// Its [`Kind`]; in births alone.
    #[prost(uint32, optional, tag = "4")]
    pub datatype: Option<u32>,
    /// It was so before the birth, and says nothing of the present.
    #[prost(bool, optional, tag = "5")]
    pub is_historical: Option<bool>,
    /// Nobody knows it.
    #[prost(bool, optional, tag = "7")]
    pub is_null: Option<bool>,
    /// Its unit; in births alone.
    #[prost(message, optional, tag = "9")]
    pub properties: Option<Properties>,
    /// Its value.
    #[prost(oneof = "Value", tags = "10, 11, 13, 14, 15")]
    pub value: Option<Value>,
}

/// A value.
#[derive(Clone, PartialEq, Oneof)]
pub enum Value {
    /// To 32 bits; below zero as two's complement.
    #[prost(uint32, tag = "10")]
    Int(u32),
    /// 64 bits.
    #[prost(uint64, tag = "11")]
    Long(u64),
    /// A number with a fraction.
    #[prost(double, tag = "13")]
    Double(f64),
    /// Yes or no.
    #[prost(bool, tag = "14")]
    Boolean(bool),
    /// Text.
    #[prost(string, tag = "15")]
    String(String),
}

/// Properties of a metric.
#[derive(Clone, PartialEq, Message)]
pub struct Properties {
    /// Their names.
    #[prost(string, repeated, tag = "1")]
    pub keys: Vec<String>,
    /// What they are, in the same order.
    #[prost(message, repeated, tag = "2")]
    pub values: Vec<Property>,
}

/// A property: text.
#[derive(Clone, PartialEq, Message)]
pub struct Property {
    /// Its [`Kind`].
    #[prost(uint32, optional, tag = "1")]
    pub kind: Option<u32>,
    /// Its text.
    #[prost(string, optional, tag = "8")]
    pub text: Option<String>,
}

impl Properties {
    /// The unit of a metric, under the name that SCADA systems look for.
    #[must_use]
    pub fn unit(unit: &str) -> Self {
        Self {
            keys: vec!["engUnit".to_owned()],
            values: vec![Property {
                kind: Some(Kind::String as u32),
                text: Some(unit.to_owned()),
            }],
        }
    }
}

/// Kinds of values, with the numbers of the specification.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A whole number of 32 bits.
    Int32 = 3,
    /// A whole number of 64 bits.
    Int64 = 4,
    /// To 255.
    UInt8 = 5,
    /// To 65 535.
    UInt16 = 6,
    /// From 0, of 32 bits.
    UInt32 = 7,
    /// From 0, of 64 bits.
    UInt64 = 8,
    /// A number with a fraction.
    Double = 10,
    /// Yes or no.
    Boolean = 11,
    /// Text.
    String = 12,
    /// Milliseconds since 1970.
    DateTime = 13,
}
