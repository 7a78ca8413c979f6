//! What mends a fault that was found: a line to be typed. Rules know the setting or the node; the name of the bus comes
//! where the report is written, because a log does not say which bus it is of.

use leadscrew_can::Address;
use leadscrew_core::bus::NodeId;

/// A line that mends a fault.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Mend {
    /// A parameter of the board, as `leadscrew params set` takes it.
    Set(String),
    /// The machine's file is pushed again, with this change in it where one is told.
    Push(Option<String>),
    /// A node is started (NMT start).
    Start(NodeId),
    /// The page of an alarm says what to do.
    Explain(u16),
}

impl Mend {
    /// The line for this bus; `BUS` stands for one that nobody has named.
    #[must_use]
    pub fn line(&self, bus: &Address) -> String {
        let name = match bus {
            Address::Sim => "BUS".to_owned(),
            Address::SocketCan(name) => name.to_string(),
            named => named.to_string(),
        };
        match self {
            Self::Set(assignment) => format!("leadscrew params set {assignment} --bus {name}"),
            Self::Push(None) => format!("leadscrew params push MACHINE.toml --bus {name}"),
            Self::Push(Some(change)) => {
                format!("leadscrew params push MACHINE.toml --bus {name}   # {change}")
            }
            Self::Start(node) => format!("cansend {name} 000#01{:02X}", node.get()),
            Self::Explain(alarm) => format!("leadscrew explain {alarm}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_has_the_bus_that_was_listened_on() {
        let on = |mend: &Mend, bus: &str| mend.line(&bus.parse().unwrap());
        let set = Mend::Set("9024=500".into());
        assert_eq!(on(&set, "can1"), "leadscrew params set 9024=500 --bus can1");
        assert_eq!(
            set.line(&Address::Sim),
            "leadscrew params set 9024=500 --bus BUS"
        );
        assert_eq!(
            on(&Mend::Push(Some("9021 = 8".into())), "sim:b"),
            "leadscrew params push MACHINE.toml --bus sim:b   # 9021 = 8"
        );
        assert_eq!(
            on(&Mend::Push(None), "can1"),
            "leadscrew params push MACHINE.toml --bus can1"
        );
        let node = NodeId::new(16).unwrap();
        assert_eq!(on(&Mend::Start(node), "can1"), "cansend can1 000#0110");
        assert_eq!(on(&Mend::Explain(4359), "can1"), "leadscrew explain 4359");
    }
}
