//! The place of a figure that no alarm has.

use postcard_schema::Schema;
use postcard_schema::schema::NamedType;
use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::units::Lead;

/// A lead among the figures of an alarm: there is none. On the link figures go by
/// their number, so its place stays, and what would stand there; in memory a numerator
/// and a denominator would make every figure of every alarm half as long again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoLead {}

impl Serialize for NoLead {
    fn serialize<S: Serializer>(&self, _: S) -> Result<S::Ok, S::Error> {
        match *self {}
    }
}

impl<'de> Deserialize<'de> for NoLead {
    fn deserialize<D: Deserializer<'de>>(_: D) -> Result<Self, D::Error> {
        Err(D::Error::custom("no alarm tells a lead"))
    }
}

impl Schema for NoLead {
    const SCHEMA: &'static NamedType = Lead::SCHEMA;
}

#[cfg(test)]
mod tests {
    use crate::alarm::Arg;

    #[test]
    fn what_claims_to_be_one_is_refused_and_the_figure_behind_it_has_kept_its_number() {
        assert!(postcard::from_bytes::<Arg>(&[7, 2, 2]).is_err());
        assert_eq!(postcard::from_bytes(&[8, 2]), Ok(Arg::Percent(1)));
        assert_eq!(size_of::<Arg>(), 16);
    }
}
