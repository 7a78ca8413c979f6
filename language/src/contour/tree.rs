//! The order in which levels and pockets are cut: each pocket to its bottom before the next.

use leadscrew_core::alarm::{Alarm, Arg, Code, Span};

use super::Contour;
use super::frame::Local;
use super::profile::{Interval, Place, Profile};

/// The most pockets of a contour.
const MOST_POCKETS: usize = 32;

/// The most pockets one inside another.
const MOST_NESTED: usize = 8;

/// A level that walls divide, and the place where the search for its next part goes on.
#[derive(Clone, Copy, Debug)]
struct Split {
    /// Height of the level above, which is open.
    above: i64,
    level: i64,
    next: usize,
    last: usize,
    /// Height of the last level that was open to the first block.
    open: i64,
}

/// One stroke to cut, and how the tool gets there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stroke {
    pub interval: Interval,
    /// Where its pocket begins.
    pub mouth: Place,
    /// Height of the last level cut above it.
    pub above: i64,
}

/// The strokes of a profile, one at a time.
#[derive(Clone, Debug)]
pub(super) struct Tree {
    level: i64,
    interval: Option<Interval>,
    lowest: i64,
    splits: Vec<Split>,
    open: i64,
    pockets: usize,
    deepest: usize,
}

impl Tree {
    /// From `A'` on. What comes after a place above `A'` is not roughed.
    pub fn new(profile: &Profile, start: Local) -> Self {
        let last = profile
            .pieces
            .iter()
            .position(|piece| piece.to.h > start.h)
            .unwrap_or_else(|| profile.pieces.len().saturating_sub(1));
        let at = Place {
            piece: 0,
            at: start,
        };
        let interval = (!profile.pieces.is_empty()).then_some(Interval {
            left: at,
            right: Place {
                piece: last,
                at: start,
            },
        });
        Self {
            level: start.h,
            interval,
            lowest: profile.lowest().unwrap_or(start.h),
            splits: Vec::new(),
            open: start.h,
            pockets: 0,
            deepest: 0,
        }
    }

    /// Height of the last level that is open from here to the first block.
    pub const fn open(&self) -> i64 {
        self.open
    }

    /// The next stroke; `below` gives the height of the next level from that of the last.
    pub fn next(
        &mut self,
        profile: &Profile,
        below: impl Fn(i64) -> Option<i64>,
    ) -> Option<Stroke> {
        let above = self.level;
        let level = below(above).filter(|level| *level > self.lowest);
        if let (Some(level), Some(parent)) = (level, self.interval) {
            let (first, last) = (parent.left.piece, parent.right.piece);
            if let Some(interval) = profile.interval(level, first, last) {
                let next = interval.right.piece + 1;
                if profile.interval(level, next, last).is_some() {
                    self.splits.push(Split {
                        above,
                        level,
                        next,
                        last,
                        open: self.open,
                    });
                    self.pockets += 1;
                    self.deepest = self.deepest.max(self.splits.len());
                }
                return Some(self.take(profile, interval, parent.left, above, level));
            }
        }
        while let Some(split) = self.splits.last_mut() {
            let (above, level) = (split.above, split.level);
            if let Some(interval) = profile.interval(level, split.next, split.last) {
                let begin = Place {
                    piece: split.next,
                    at: profile.pieces[split.next].from,
                };
                split.next = interval.right.piece + 1;
                self.open = split.open;
                self.pockets += 1;
                return Some(self.take(profile, interval, begin, above, level));
            }
            self.splits.pop();
        }
        self.interval = None;
        None
    }

    fn take(
        &mut self,
        profile: &Profile,
        interval: Interval,
        begin: Place,
        above: i64,
        level: i64,
    ) -> Stroke {
        self.level = level;
        self.interval = Some(interval);
        if interval.left.piece == 0 && profile.has_first {
            self.open = level;
        }
        Stroke {
            interval,
            mouth: profile.mouth(begin, interval.left, above),
            above,
        }
    }
}

/// Refuses a contour with too many pockets, or one that comes back from above the start.
pub(super) fn check(
    contour: &Contour,
    profile: &Profile,
    start: Local,
    depth: i64,
) -> Result<(), Alarm> {
    let span = |piece: usize| {
        let element = profile.pieces.get(piece).map_or(0, |piece| piece.element);
        contour
            .elements
            .get(element)
            .map_or(Span::default(), |element| element.span)
    };
    let above = profile.pieces.iter().position(|piece| piece.to.h > start.h);
    if let Some(above) = above {
        let mut after = profile.pieces.iter().enumerate().skip(above);
        if let Some((piece, _)) = after.find(|(_, piece)| piece.to.h < start.h) {
            return Err(Alarm::new(Code::ContourAboveStart, span(piece)));
        }
    }
    // Walls divide a level only where it is the first one below an end of a piece: the levels between need no look.
    let mut levels: Vec<i64> = profile
        .pieces
        .iter()
        .filter(|piece| piece.to.h < start.h)
        .map(|piece| start.h - ((start.h - piece.to.h) / depth + 1) * depth)
        .collect();
    levels.sort_unstable_by(|one, other| other.cmp(one));
    levels.dedup();
    let mut tree = Tree::new(profile, start);
    let below = |level: i64| {
        let next = levels.partition_point(|other| *other >= level);
        levels.get(next).copied()
    };
    while let Some(stroke) = tree.next(profile, below) {
        if tree.pockets > MOST_POCKETS || tree.deepest > MOST_NESTED {
            let place = span(stroke.interval.left.piece);
            return Err(Alarm::new(Code::ContourPockets, place).with([
                Arg::Int(tree.pockets.cast_signed() as i64),
                Arg::Int(tree.deepest.cast_signed() as i64),
            ]));
        }
    }
    Ok(())
}
