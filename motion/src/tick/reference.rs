//! The error of an axis that is held to the spindle. It is found one tick later, from the angle measured since.

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

use super::ticker::Ticker;
use crate::call::{Position, TapAxis, TapSpindle};
use crate::motion::{Cut, Law, Setpoint, Task};
use crate::units::Length;

/// The kind of synchronism between an axis and the spindle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
#[repr(u8)]
pub enum ThreadKind {
    /// Along the helix of a thread: a threading cycle.
    Thread,
    /// Along the line of a hole, with the spindle in position mode.
    RigidTap,
    /// Along the line of a hole, following the measured spindle.
    FloatingTap,
}

/// The data for judging the next measured angle. At first there are none.
#[derive(Clone, Copy, Debug, Default)]
pub struct Reference(Option<Held>);

/// The error of an axis that was held to the spindle, and the cut it belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Measured {
    /// Actual setpoint minus ideal setpoint.
    pub error: Length,
    /// Source line.
    pub line: u32,
    /// How the axis was held.
    pub kind: ThreadKind,
    /// The thread or hole.
    pub cut: Cut,
}

/// The law of an axis, its setpoint, and the cut.
#[derive(Clone, Copy, Debug)]
struct Held {
    law: Law,
    position: Position,
    line: u32,
    cut: Cut,
}

impl Held {
    fn error(&self, ticker: &Ticker) -> Length {
        match &self.law {
            Law::Thread(helix) => {
                let on_x = helix.long_x();
                let at = if on_x {
                    self.position.x
                } else {
                    self.position.z
                };
                at - helix.at(ticker.effective_angle(on_x))
            }
            Law::Tap(line) | Law::Float(line) => {
                let on_x = line.gear.axis() == TapAxis::X;
                line.error(self.position, ticker.effective_angle(on_x))
            }
        }
    }

    fn measured(&self, ticker: &Ticker) -> Measured {
        Measured {
            error: self.error(ticker),
            line: self.line,
            kind: match &self.law {
                Law::Thread(_) => ThreadKind::Thread,
                Law::Tap(_) => ThreadKind::RigidTap,
                Law::Float(_) => ThreadKind::FloatingTap,
            },
            cut: self.cut,
        }
    }
}

impl Reference {
    /// The error of the setpoint before `setpoint`. That setpoint has taken effect by now, and the error is judged at the
    /// angle just measured. `None` where no axis was held to the spindle. `head`: the head of the program's queue. Call
    /// this after the tick.
    pub fn error(
        &mut self,
        ticker: &Ticker,
        head: Option<Task<'_>>,
        setpoint: &Setpoint,
    ) -> Option<Measured> {
        let measured = self.0.as_ref().map(|held| held.measured(ticker));
        self.renew(ticker, head, setpoint);
        measured
    }

    /// As [`error`](Self::error), without judging: for missed ticks, or where no tick was taken.
    pub fn renew(&mut self, ticker: &Ticker, head: Option<Task<'_>>, setpoint: &Setpoint) {
        self.0 = None;
        if setpoint.locked
            && let Some(task) = head
            && let Some(law) = ticker.law(head)
            // The board has no encoder for the spindles that only tap [D91].
            && (ticker.tap_spindle() == TapSpindle::First || !matches!(law, Law::Tap(_)))
        {
            self.0 = Some(Held {
                law,
                position: setpoint.position,
                line: setpoint.line,
                cut: task.segment.cut,
            });
        }
    }
}
