//! A held motion is set aside while the axes are moved by hand, and taken up again where it was.

use super::{Active, Executor, Waited};
use crate::call::Position;

/// What was held. The run that belongs to it stays in the executor as it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Aside {
    kind: Kind,
    /// Where it was held.
    position: Position,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Between,
    Timed,
    Joined,
    Waiting,
    Dwell(u32),
}

impl Aside {
    /// Where it was held.
    #[must_use]
    pub const fn position(&self) -> Position {
        self.position
    }
}

impl Executor {
    /// Sets the held motion aside: the executor is free, and may be placed elsewhere. `None` where an axis is bound to the
    /// spindle, or the spindle turns to an angle. The caller has seen that the axes stand.
    pub fn set_aside(&mut self) -> Option<Aside> {
        let kind = match self.active {
            Active::Free => Kind::Between,
            Active::Timed => Kind::Timed,
            Active::Joined => Kind::Joined,
            // In a hold it counts no time.
            Active::Waiting(_) => Kind::Waiting,
            Active::Dwell(left) => Kind::Dwell(left),
            Active::Thread(_) | Active::Tap(_) | Active::Float(..) | Active::Turn(_) => {
                return None;
            }
        };
        self.active = Active::Free;
        Some(Aside {
            kind,
            position: self.position,
        })
    }

    /// The motion that was set aside is given up: what comes next begins from rest.
    pub const fn give_up_aside(&mut self) {
        self.run.begin_anew();
    }

    /// Takes the motion up again. The axes stand where it was held.
    pub fn take_up(&mut self, aside: &Aside) {
        self.followers = None;
        self.active = match aside.kind {
            Kind::Between => Active::Free,
            Kind::Timed => Active::Timed,
            Kind::Joined => Active::Joined,
            Kind::Waiting => Active::Waiting(Waited::default()),
            Kind::Dwell(left) => Active::Dwell(left),
        };
    }
}
