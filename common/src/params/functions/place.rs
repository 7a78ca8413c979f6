//! Places of inputs and outputs as a machine file writes them: `input:3`, `output:1`, `pin:PC4`, and of the block at node 5
//! `401:5:in0`, `401:5:out15`.

use leadscrew_core::params::{Contact, FIRST_OF_BLOCK};

use super::Io;

/// Inputs or outputs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// What the board reads.
    Input,
    /// What the board switches.
    Output,
}

impl Side {
    /// The word of files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Input => "input",
            Self::Output => "output",
        }
    }
}

/// The pins of the NUCLEO-G474RE (`docs/hardware.md`) in the order of their contacts.
const INPUT_PINS: [&str; 8] = ["PC4", "PC5", "PC6", "PC7", "PC8", "PC9", "PC10", "PC11"];
const OUTPUT_PINS: [&str; 5] = ["PB11", "PB12", "PB13", "PB14", "PB15"];

impl Io {
    /// The contact at a place.
    #[must_use]
    pub fn at(place: &str) -> Option<Self> {
        let (kind, number) = place.split_once(':')?;
        let (side, contact) = match kind {
            "input" => (Side::Input, number.parse().ok()?),
            "output" => (Side::Output, number.parse().ok()?),
            "pin" => {
                let among = |pins: &[&str]| {
                    let place = pins.iter().position(|pin| *pin == number)?;
                    u8::try_from(place + 1).ok()
                };
                match (among(&INPUT_PINS), among(&OUTPUT_PINS)) {
                    (Some(input), _) => (Side::Input, input),
                    (None, output) => (Side::Output, output?),
                }
            }
            "401" => {
                let (_, side, bit) = at_block(number)?;
                (side, FIRST_OF_BLOCK + bit)
            }
            _ => return None,
        };
        let contact = Contact::new(contact)?;
        Some(Self { side, contact })
    }

    /// The node that a place names, where it is at a block.
    pub(super) fn node_at(place: &str) -> Option<u8> {
        let (node, ..) = at_block(place.strip_prefix("401:")?)?;
        Some(node)
    }
}

/// Node, side and bit of `5:in0`.
fn at_block(place: &str) -> Option<(u8, Side, u8)> {
    let (node, contact) = place.split_once(':')?;
    let (side, bit) = match (contact.strip_prefix("in"), contact.strip_prefix("out")) {
        (Some(bit), _) => (Side::Input, bit),
        (None, bit) => (Side::Output, bit?),
    };
    let node = node.parse().ok().filter(|node| (1..=126).contains(node))?;
    let bit = bit.parse().ok().filter(|bit| *bit < 16)?;
    Some((node, side, bit))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_is_a_number_or_a_pin() {
        for (place, shown) in [
            ("input:1", Some("input:1")),
            ("output:16", Some("output:16")),
            ("pin:PC4", Some("input:1")),
            ("pin:PC11", Some("input:8")),
            ("pin:PB11", Some("output:1")),
            ("pin:PB15", Some("output:5")),
            ("pin:PA0", None),
            ("401:5:in0", Some("input:17")),
            ("401:126:out15", Some("output:32")),
            ("401:5:in16", None),
            ("401:0:in0", None),
            ("401:127:in0", None),
            ("401:5:3", None),
            ("401:in0", None),
            ("input:32", Some("input:32")),
            ("input:0", None),
            ("input:33", None),
            ("output:", None),
            ("output", None),
            ("3", None),
            ("pdo:3", None),
        ] {
            let shown_now = Io::at(place).map(|io| io.to_string());
            assert_eq!(shown_now.as_deref(), shown, "{place}");
        }
    }
}
