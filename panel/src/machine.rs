//! What the server asks the side of the bus for. Knows neither.

use std::path::Path;

use serde_json::Value;

/// One frame of a press. Where no way is told, it is let go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Jog {
    /// The number of the press.
    pub press: u8,
    /// Which way X and Z are to go: above 0 towards plus, below towards minus.
    pub axes: [i8; 2],
    /// Which way the spindle is to turn, alone: above 0 as M03, below as M04.
    pub spindle: i8,
    /// At the rapid of moving by hand; not of the spindle.
    pub rapid: bool,
    /// Speed of the slide in mm/min, of the spindle in rpm; 0: the machine's own.
    pub speed: u16,
    /// The newest beat that the page has.
    pub echo: u16,
}

impl Jog {
    /// True where something is to move.
    pub(crate) const fn is_held(&self) -> bool {
        let [x, z] = self.axes;
        x != 0 || z != 0 || self.spindle != 0
    }
}

/// One order: its name, what belongs to it, and the newest beat that the page has.
#[derive(Clone, Debug, PartialEq)]
pub struct Order {
    /// Its name.
    pub op: String,
    /// What belongs to it.
    pub args: Value,
    /// The newest beat that the page has; hold, stop and reset need none.
    pub echo: Option<u16>,
}

impl Order {
    /// Hold and stop: they need no lease, and pass all queues.
    pub(crate) fn halts(&self) -> bool {
        matches!(self.op.as_str(), "hold" | "stop")
    }
}

/// What is to be known of a program without running it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum View {
    /// What is wrong with it.
    Check,
    /// The path of its tools.
    Path,
    /// What would happen if it were started at this line.
    Start(u32),
}

/// A table of the board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sheet {
    /// Tools and work offsets.
    Tools,
    /// Parameters.
    Params,
}

impl Sheet {
    /// The one that is asked for by this path.
    pub(crate) fn at(path: &str) -> Option<Self> {
        match path {
            "/tools" => Some(Self::Tools),
            "/params" => Some(Self::Params),
            _ => None,
        }
    }
}

/// The side of the bus. It is called by the thread of each connection.
pub trait Machine: Send + Sync {
    /// Does an order and says what has become of it, as JSON; `None`: there is no such order.
    fn order(&self, order: &Order) -> Option<String>;

    /// Passes one frame on, and says what has become of its press, as JSON.
    fn jog(&self, jog: &Jog) -> String;

    /// Says what is to be known of a program, as JSON: in Chinese, else in English.
    fn view(&self, program: &Path, view: View, zh: bool) -> String;

    /// Says what is in a table, as JSON: with its texts in Chinese, else in English.
    fn sheet(&self, sheet: Sheet, zh: bool) -> String;
}
