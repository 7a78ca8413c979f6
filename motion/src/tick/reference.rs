//! The error of an axis that is held to the spindle. It is found one tick later, from the angle measured since.

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

use super::ticker::Ticker;
use crate::bus::Increments;
use crate::call::{Position, TapAxis, TapSpindle};
use crate::motion::{Cut, Law, Setpoint, TapLine, Task};
use crate::units::{Length, Turns};

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

impl ThreadKind {
    /// The name in results.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Thread => "thread",
            Self::RigidTap => "rigid_tap",
            Self::FloatingTap => "tap",
        }
    }
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
    /// What the drive has told since the tick before; `None` where it has told nothing, and outside of threads.
    pub followed: Option<Followed>,
}

/// Where the drive of an axis in a thread says that it is. It is judged in the background [D380].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Followed {
    /// 6064h, without what the drive counts in addition to the position. What is put in for backlash
    /// and for errors of the pitch is in it.
    pub actual: Increments,
    /// X is the long axis.
    pub on_x: bool,
    lead_nm: i32,
    off_nm: i32,
}

impl Followed {
    /// `lead`: way of the helix in a turn, with its sign. `off`: the setpoint of the tick before, less the helix at the
    /// angle of this tick, and less what is put in for backlash and for errors of the pitch. Each within ±2 m.
    #[must_use]
    pub const fn new(actual: Increments, on_x: bool, lead: Length, off: Length) -> Self {
        Self {
            actual,
            on_x,
            lead_nm: lead.nm() as i32,
            off_nm: off.nm() as i32,
        }
    }

    /// Way of the helix in a turn, with its sign.
    #[must_use]
    pub const fn lead(&self) -> Length {
        Length::from_nm(self.lead_nm as i64)
    }

    /// The setpoint of the tick before, less the helix at the angle of this tick, and less what is put in for backlash and
    /// for errors of the pitch.
    #[must_use]
    pub const fn off(&self) -> Length {
        Length::from_nm(self.off_nm as i64)
    }
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
    fn measured(&self, ticker: &Ticker) -> Measured {
        let (error, kind, followed) = match &self.law {
            Law::Thread(helix) => {
                let on_x = helix.long_x();
                let at = if on_x {
                    self.position.x
                } else {
                    self.position.z
                };
                let (angle, since) = ticker.angle_of_pass(on_x);
                let error = at - helix.at(angle);
                let told = ticker.has_told(on_x).zip(helix.lead_nm());
                let followed = told.map(|((actual, put_in), lead_nm)| Followed {
                    actual,
                    on_x,
                    lead_nm,
                    off_nm: off(error, lead_nm, since).wrapping_sub(put_in as i32),
                });
                (error, ThreadKind::Thread, followed)
            }
            Law::Tap(line) => (line_error(self, line, ticker), ThreadKind::RigidTap, None),
            Law::Float(line) => (
                line_error(self, line, ticker),
                ThreadKind::FloatingTap,
                None,
            ),
        };
        Measured {
            error,
            line: self.line,
            kind,
            cut: self.cut,
            followed,
        }
    }
}

fn line_error(held: &Held, line: &TapLine, ticker: &Ticker) -> Length {
    let on_x = line.gear.axis() == TapAxis::X;
    line.error(held.position, ticker.effective_angle(on_x))
}

/// The error of a setpoint by another angle, `ahead` before that of `error`. Both angles are less than half a turn apart.
const fn off(error: Length, lead_nm: i32, ahead: Turns) -> i32 {
    let way = (lead_nm as i64).wrapping_mul(ahead.raw() as i32 as i64) >> 32;
    (error.nm() as i32).wrapping_add(way as i32)
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
