//! How far an axis that is held to the spindle is from where it should be, found out one tick later: at the angle that has
//! been measured since.

use super::ticker::Ticker;
use crate::link::ThreadKind;
use crate::motion::{Cut, Law, Setpoint, Task};
use crate::program::{Position, TapAxis, TapSpindle};
use crate::units::Length;

/// What the next measured angle is judged by; nothing at first.
#[derive(Clone, Copy, Debug, Default)]
pub struct Reference(Option<Held>);

/// How far an axis that is held to the spindle was from where it should have been, and what it was cutting.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Measured {
    /// Where it was, less where it should have been.
    pub error: Length,
    /// Source line.
    pub line: u32,
    /// By what it was held.
    pub kind: ThreadKind,
    /// In which thread or hole.
    pub cut: Cut,
}

/// The law an axis follows, where it was told to be, and for what.
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
    /// Behind a tick that gave `setpoint`: the error of the setpoint before, which has taken effect by now, at the
    /// angle just measured; `None` where no axis was held to the spindle. `head`: the head of the program's queue.
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

    /// The same where ticks were missed, or none was taken: nothing is judged.
    pub fn renew(&mut self, ticker: &Ticker, head: Option<Task<'_>>, setpoint: &Setpoint) {
        self.0 = None;
        if setpoint.locked
            && let Some(task) = head
            && let Some(law) = ticker.law(head)
            // No encoder on the board measures the spindles that only tap [D91].
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
