//! A held program is left: its axes are moved by hand, and go back to the point where it was held [D255].
//!
//! ```text
//! Held ── leave ─► Held, left ◄─► ByHand
//!   ▲                   │
//!   └──── return ───────┘  at the point alone
//! ```
//!
//! What was held is set aside untouched, so it goes on with the setpoints that would have come without all this. A stop, a
//! reset or an alarm forgets the point together with the program. Must not know who moves the axes, or why.

use super::course::Source;
use super::{Ends, State, Ticker};
use crate::alarm::Code;
use crate::call::Position;
use crate::motion::{Aside, AxisPress, Press};
use crate::operating::Towards;
use crate::units::Length;

/// The legs of the way back: out of the work, along it, and to the point.
const LAST: u8 = 2;

/// A program that was left.
#[derive(Clone, Copy, Debug)]
pub(super) struct Left {
    aside: Aside,
    /// Where its segment is, if one is under way.
    source: Source,
    /// How the tool left the point: this axis (Z, or X) comes back last, from this side [D256].
    first: (bool, Towards),
    /// The axes go back: how fast, and the legs that are done.
    back: Option<(Press, u8)>,
}

impl Ticker {
    /// The point where a held program was left, until it goes on or is given up.
    #[must_use]
    pub fn left(&self) -> Option<Position> {
        self.left.as_ref().map(|left| left.aside.position())
    }

    /// A program has been left.
    pub(in crate::tick) const fn has_left(&self) -> bool {
        self.left.is_some()
    }

    /// Leaves the program where it is held. One that goes on in this very tick is held first. The axes stand and stay
    /// where they are.
    #[cold]
    #[inline(never)]
    pub(super) fn leave(&mut self) {
        match self.state {
            State::Running => self.operator.hold = true,
            // It is left when the spindle is there.
            State::Held if self.spindle.is_orienting() => {}
            State::Held => {
                self.operator.leaves();
                if self.has_left() || self.journal.has_hole() {
                    return;
                }
                if let Some(aside) = self.executor.set_aside() {
                    self.left = Some(Left {
                        aside,
                        source: self.course.set_aside(),
                        first: (false, Towards::Plus),
                        back: None,
                    });
                    self.operator.hold = false;
                    // The spindle is waited for when the program goes on.
                    self.resuming = None;
                }
            }
            _ => self.operator.leaves(),
        }
    }

    /// The program goes on where it was left, if the axes stand there.
    #[cold]
    #[inline(never)]
    pub(super) fn go_on_from_left(&mut self, ends: &mut Ends<'_>) {
        let here = self.executor.position();
        if matches!(self.state, State::Held)
            && let Some(left) = &self.left
            && left.aside.position() == here
        {
            self.executor.take_up(&left.aside);
            self.course.take_from(left.source);
            self.left = None;
            // It is held until nothing keeps it, and until a spindle that was stopped turns.
            self.operator.hold = true;
            self.resume(ends);
        }
    }

    /// The axes go back to the point, one after the other. `press` has their speeds.
    #[cold]
    #[inline(never)]
    pub(super) fn go_back_to_left(&mut self, press: &Press) {
        if let State::Held = self.state
            && let Some(left) = &mut self.left
        {
            left.back = Some((*press, 0));
            self.operator.hold = false;
            // The way was checked where it was asked for.
            self.free = self.travel();
            if self.begin_leg() {
                return self.transition_to_by_hand();
            }
        }
        self.jog.refuse(press.number, Code::NotAtRest);
    }

    /// The axes go back no farther.
    pub(super) const fn stay_away(&mut self) {
        if let Some(left) = &mut self.left {
            left.back = None;
        }
    }

    /// The axes are on their way back.
    pub(super) const fn is_coming_back(&self) -> bool {
        matches!(&self.left, Some(Left { back: Some(_), .. }))
    }

    /// A press begins: one that leaves the point says how.
    #[cold]
    #[inline(never)]
    pub(super) fn note_way_out(&mut self, press: &Press) {
        let here = self.executor.position();
        if let Some(left) = &mut self.left {
            let point = left.aside.position();
            let out = |on_z| along(on_z, here) - along(on_z, point);
            // As long as one axis alone has left, its side counts, whichever way it went first.
            left.first = match (out(false), out(true)) {
                (Length::ZERO, Length::ZERO) => match (&press.x, &press.z) {
                    (None, Some(z)) => (true, press.side(z)),
                    (Some(x), _) => (false, press.side(x)),
                    (None, None) => left.first,
                },
                (x, Length::ZERO) => (false, Towards::of(x)),
                (Length::ZERO, z) => (true, Towards::of(z)),
                _ => left.first,
            };
        }
    }

    /// Begins the next leg of the way back. False after the last.
    #[cold]
    #[inline(never)]
    pub(super) fn begin_leg(&mut self) -> bool {
        let here = self.executor.position();
        while let Some(left) = &mut self.left
            && let Some((press, legs)) = &mut left.back
        {
            let (last, side) = left.first;
            let on_z = match *legs {
                0 | LAST => last,
                1 => !last,
                _ => {
                    left.back = None;
                    break;
                }
            };
            let way = along(on_z, left.aside.position()) - along(on_z, here);
            // The first leg leads away from the work alone.
            let is_none = way == Length::ZERO || *legs == 0 && Towards::of(way) != side;
            *legs = legs.saturating_add(1);
            if is_none {
                continue;
            }
            let towards = Towards::of(way);
            let turned = |motion: AxisPress| AxisPress { towards, ..motion };
            self.jog.begin(&Press {
                x: press.x.filter(|_| !on_z).map(turned),
                z: press.z.filter(|_| on_z).map(turned),
                way: Some(way.abs()),
                ..*press
            });
            return true;
        }
        false
    }
}

const fn along(on_z: bool, position: Position) -> Length {
    if on_z { position.z } else { position.x }
}
