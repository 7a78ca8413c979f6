//! How far an axis that is held to the spindle is from where it should be, found out one tick later: at the angle that has
//! been measured since.

use super::ticker::Ticker;
use crate::motion::{Law, Setpoint, Task};
use crate::program::{Position, TapAxis};
use crate::units::Length;

/// What the next measured angle is judged by; nothing at first.
#[derive(Clone, Copy, Debug, Default)]
pub struct Reference(Option<Held>);

/// The law an axis follows, and where it was told to be.
#[derive(Clone, Copy, Debug)]
struct Held {
    law: Law,
    position: Position,
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
}

impl Reference {
    /// Behind a tick that gave `setpoint`: the error of the setpoint before, which has taken effect by now, at the angle just
    /// measured; `None` where no axis was held to the spindle. `head`: the head of the program's queue.
    pub fn error(
        &mut self,
        ticker: &Ticker,
        head: Option<Task<'_>>,
        setpoint: &Setpoint,
    ) -> Option<Length> {
        let error = self.0.as_ref().map(|held| held.error(ticker));
        self.renew(ticker, head, setpoint);
        error
    }

    /// The same where ticks were missed, or none was taken: nothing is judged.
    pub fn renew(&mut self, ticker: &Ticker, head: Option<Task<'_>>, setpoint: &Setpoint) {
        self.0 = None;
        if setpoint.locked
            && let Some(law) = ticker.law(head)
        {
            self.0 = Some(Held {
                law,
                position: setpoint.position,
            });
        }
    }
}
