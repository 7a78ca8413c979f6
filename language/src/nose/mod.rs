//! Nose radius compensation (G40–G42): from the path of the drawing to the path of the imaginary tip.
//!
//! A [`Filter`] takes the motions of a program one by one, each with its side and tool, and gives back the
//! motions that keep
//! the round nose on the drawing. Where two motions meet, the end of the first depends on the second, and a
//! motion may turn
//! out not to fit, so the filter holds [`WINDOW`] motions. Everything else of the program (feeds, spindle
//! commands) passes
//! through as an opaque payload and keeps its place between the motions.
//!
//! This module must not know words, modal state, dialects, feeds or what a payload is. [`join`] says what
//! happens at a corner
//! and [`fit`] whether the nose fits; the filter keeps the order.

mod fit;
mod join;
#[cfg(test)]
mod tests;
mod track;

use std::collections::VecDeque;

use leadscrew_core::alarm::{Alarm, Arg, Code};
use leadscrew_core::units::Length;

use crate::plane::{Element, Point, Shape};
use track::{Begins, Track};

/// Motions that the filter holds while it looks ahead.
pub const WINDOW: usize = 11;

/// Blocks without motion that may stand between two motions while the compensation is in force.
pub const STILLS: usize = 8;

/// Where the tool is, seen in the direction of travel, with Z to the right and X upwards.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Side {
    /// G40: the tip is on the path.
    #[default]
    None,
    /// G41.
    Left,
    /// G42.
    Right,
}

/// How the compensation begins and ends at an outside corner (5003.0).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Entry {
    /// Perpendicular to the first compensated motion.
    #[default]
    A,
    /// Round the corner as in the middle of the path.
    B,
}

/// Which side of the spindle axis the tool post is on, where the control does not turn X with it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Post {
    /// X grows towards the tool: numbers and sides as in the picture with X upwards.
    #[default]
    Rear,
    /// X grows away from the tool: the picture is mirrored at the spindle axis. Tip numbers change the sign of
    /// X, and left
    /// and right are exchanged.
    Front,
}

/// The nose of a tool.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Nose {
    /// Its radius. Below zero: left and right are exchanged. Zero: no compensation.
    pub radius: Length,
    /// Tip direction, 0 to 9: where the centre is, seen from the imaginary tip. Any other number is read as 0.
    pub tip: u8,
}

/// A motion as it is programmed.
#[derive(Clone, Copy, Debug)]
pub struct Motion {
    /// The path of the drawing.
    pub element: Element,
    /// The side in force in its block.
    pub side: Side,
    /// The nose in force in its block.
    pub nose: Nose,
}

/// What goes in.
#[derive(Clone, Debug)]
pub enum Input<T> {
    /// A motion.
    Motion(Motion, T),
    /// A block without motion.
    Still(T),
    /// What takes the compensation off for one block (G28, G30, G53, G10, T, a cycle). The motion before it ends
    /// perpendicular; the next compensated one begins anew.
    Break {
        /// Where the programmed path goes on afterwards.
        at: Point,
        /// What is passed through.
        payload: T,
    },
}

/// What comes out.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Output<T> {
    /// A motion, for the imaginary tip.
    Motion(Element, T),
    /// A straight move that leads round a corner, at the feed of the motion before it.
    Corner(Element),
    /// A block without motion, or one whose motion has become nothing.
    Still(T),
    /// As it went in.
    Break(T),
}

/// The filter. After each [`push`](Self::push), call [`pull`](Self::pull) until it gives nothing: then it
/// never holds more
/// than [`WINDOW`] motions and the blocks between them.
#[derive(Debug)]
pub struct Filter<T> {
    entry: Entry,
    post: Post,
    /// Where the programmed path is.
    at: Point,
    held: VecDeque<Held<T>>,
    /// Things at the front of `held` that need not wait for the window.
    released: usize,
    /// The end of the last motion held waits for the next motion.
    is_open: bool,
    /// Blocks without motion since the last motion.
    stills: usize,
}

#[derive(Debug)]
enum Held<T> {
    Motion(Box<Track>, T),
    Corner(Element),
    Still(T),
    Break(T),
}

impl<T> Filter<T> {
    /// A filter for a path that begins at `at`, without compensation.
    #[must_use]
    pub fn new(at: Point, entry: Entry, post: Post) -> Self {
        Self {
            entry,
            post,
            at,
            held: VecDeque::new(),
            released: 0,
            is_open: false,
            stills: 0,
        }
    }

    /// The next thing of the program.
    ///
    /// # Errors
    /// 0033, 0034, 0041, 4600 or 4601, before the motion that the alarm names has come out. The filter is of no use
    /// afterwards.
    pub fn push(&mut self, input: Input<T>) -> Result<(), Alarm> {
        match input {
            Input::Motion(motion, payload) => self.motion(&motion, payload),
            Input::Still(payload) => self.still(payload),
            Input::Break { at, payload } => {
                self.finish()?;
                self.at = at;
                self.held.push_back(Held::Break(payload));
                self.release();
                Ok(())
            }
        }
    }

    /// The end of the path: the last motion ends perpendicular, and all that is held may come out.
    ///
    /// # Errors
    /// As [`push`](Self::push).
    pub fn finish(&mut self) -> Result<(), Alarm> {
        if let Some(open) = self.open() {
            let way = vec![open.foot_of_end()];
            self.close(way)?;
        }
        self.release();
        Ok(())
    }

    /// True where nothing is held, and the next motion need not have this filter.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.held.is_empty() && !self.is_open
    }

    /// The next thing that may go to the machine.
    pub fn pull(&mut self) -> Option<Output<T>> {
        let front = self.held.front()?;
        let is_corner = matches!(front, Held::Corner(_));
        let must_wait = matches!(front, Held::Motion(..)) && self.motions() < WINDOW;
        if must_wait && self.released == 0 {
            return None;
        }
        if !is_corner {
            self.released = self.released.saturating_sub(1);
        }
        Some(match self.held.pop_front()? {
            Held::Still(payload) => Output::Still(payload),
            Held::Break(payload) => Output::Break(payload),
            Held::Corner(element) => Output::Corner(element),
            Held::Motion(track, payload) => {
                for corner in track.corners().rev() {
                    self.held.push_front(Held::Corner(corner));
                }
                match track.output() {
                    Some(element) => Output::Motion(element, payload),
                    None => Output::Still(payload),
                }
            }
        })
    }

    fn motion(&mut self, motion: &Motion, payload: T) -> Result<(), Alarm> {
        let start = self.at;
        let is_straight = !matches!(motion.element.shape, Shape::Arc { .. });
        if is_straight && motion.element.end == start && motion.side != Side::None {
            return self.still(payload);
        }
        let mut track = Track::new(start, motion, self.post);
        if let Some(open) = self.open() {
            let way = if track.is_compensated() {
                self.go_on(open, &mut track)?
            } else {
                track.must_be_straight()?;
                join::cancel(
                    &open.piece_at(start),
                    &track.piece_at(start),
                    open.offset,
                    self.way_in(open),
                )
                .into_iter()
                .map(|place| open.tip_at(start, place))
                .collect()
            };
            self.close(way)?;
        } else if track.is_compensated() {
            track.must_be_straight()?;
        }
        fit::arc_takes(&track)?;
        self.at = motion.element.end;
        self.is_open = track.is_compensated();
        self.held.push_back(Held::Motion(Box::new(track), payload));
        if !self.is_open {
            self.release();
        }
        Ok(())
    }

    /// Where `open` ends before `next`, both with compensation, and how `next` begins.
    fn go_on(&self, open: &Track, next: &mut Track) -> Result<Vec<Point>, Alarm> {
        let corner = next.start;
        let (a, b) = (open.piece_at(corner), next.piece_at(corner));
        if !open.has_the_nose_of(next) {
            if open.begins != Begins::InForce {
                return Err(Alarm::new(Code::NoseSideChange, next.element.span));
            }
            next.begins = Begins::InForce;
            next.from = next.tip_at(corner, b.first().left() * next.offset);
            return Ok(vec![open.foot_of_end(), next.from]);
        }
        next.begins = open.begins.next();
        let places = match open.begins {
            Begins::StartUp => join::start_up(&a, &b, open.offset, self.entry),
            _ => join::corner(&a, &b, open.offset).ok_or_else(|| {
                Alarm::new(Code::NoseNoIntersection, next.element.span)
                    .with([Arg::Length(open.radius())])
            })?,
        };
        let way: Vec<_> = places
            .into_iter()
            .map(|place| open.tip_at(corner, place))
            .collect();
        if let Some(last) = way.last() {
            next.from = *last;
        }
        Ok(way)
    }

    fn way_in(&self, open: &Track) -> Entry {
        // A path of the start-up alone ends where it would without a way out.
        match open.begins {
            Begins::StartUp => Entry::A,
            _ => self.entry,
        }
    }

    fn still(&mut self, payload: T) -> Result<(), Alarm> {
        if self.is_open {
            self.stills += 1;
            if self.stills > STILLS {
                let span = self
                    .open()
                    .map_or_else(Default::default, |open| open.element.span);
                let limit = Arg::Int(STILLS as i64);
                return Err(Alarm::new(Code::NoseStill, span).with([limit]));
            }
        }
        self.held.push_back(Held::Still(payload));
        if !self.is_open {
            self.release();
        }
        Ok(())
    }

    /// The motion whose end is not known yet.
    fn open(&self) -> Option<&Track> {
        self.tracks().next().filter(|_| self.is_open)
    }

    /// The motions, the last one first, back to what is not a motion with compensation.
    fn tracks(&self) -> impl Iterator<Item = &Track> {
        let held = self.held.iter().rev();
        held.filter(|held| !matches!(held, Held::Still(_)))
            .map_while(|held| match held {
                Held::Motion(track, _) => Some(&**track),
                _ => None,
            })
    }

    /// Gives the open motion its end, and checks that the nose fits.
    fn close(&mut self, way: Vec<Point>) -> Result<(), Alarm> {
        self.is_open = false;
        self.stills = 0;
        let last = self.held.iter_mut().rev().find_map(|held| match held {
            Held::Motion(track, _) => Some(track),
            _ => None,
        });
        if let Some(track) = last {
            track.way = way;
            fit::leave_something(track)?;
        }
        fit::keep_clear(self.tracks())
    }

    fn release(&mut self) {
        self.released = self
            .held
            .iter()
            .filter(|held| !matches!(held, Held::Corner(_)))
            .count();
    }

    fn motions(&self) -> usize {
        let is_motion = |held: &&Held<T>| matches!(held, Held::Motion(..));
        self.held.iter().filter(is_motion).count()
    }
}
