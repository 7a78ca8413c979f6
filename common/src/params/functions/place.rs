//! Places of inputs and outputs as a machine file writes them: `input:3`, `output:1`, `pin:PC4`.

use leadscrew_core::params::Contact;

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
            _ => return None,
        };
        let contact = Contact::new(contact)?;
        Some(Self { side, contact })
    }
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
            ("input:0", None),
            ("input:17", None),
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
