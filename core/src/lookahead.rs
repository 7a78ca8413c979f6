//! Plans how fast joined cuts are passed (G64). Background work.
//!
//! Cuts wait here in a window until enough of the way after them is known. Then one after the other leaves, with the
//! [stretches](Stretch) of its way: each has the largest rate that the corners and bends near to it allow.
//!
//! # What a corner allows
//!
//! Two means of m ticks round the way ([`Corner`]). Over any m ticks the direction may turn by Θ with v·Θ at most
//! [`Corner::turning`]: then the tool stays within the tolerance, and the axes within their limits. Θ counts each corner
//! as the difference of the two directions, and each arc by its angle. A corner with others close to it is passed as slowly
//! as all of them together need.
//!
//! A corner is a stop where that takes less time than to slow down for it: between long cuts below half of the feed,
//! between short ones much later (`Side`).
//!
//! # Where a rate has to hold
//!
//! The profile's speed is a mean of its inputs over n1 + n2 ticks, and the corner is spread over 2·m ticks. So that no
//! speed above v comes out near a corner, no input above v may be put in for `zone` = n1 + n2 + 2·m ticks before and after
//! the corner, that is on `zone`·v of the way. For a stop this is nothing: the input may end at any rate.
//!
//! # What is not known yet
//!
//! A cut that has left cannot be slowed down any more, and a corner of any kind may follow at the end of what is known. If
//! the calls come slowly, the rate is at most the distance to that end, over `zone`: the machine slows down, to a rate at
//! which it could turn round.
//!
//! If the window is full, the way is expected to go on as it was lately: chords of a curve are followed by more of them. Of
//! the slowest place that was seen, an eighth is left for rounded figures. A corner that is slower than that, and known too
//! late, is passed more slowly still: at the distance to it, over `zone`. Where a stop takes less time it is a stop.
//!
//! # How fast a ramp may be
//!
//! The means of a high feed are long, and the input is ahead of the tool by half of them. No more cuts than
//! [`CUTS_AHEAD`] fit between the two. So for short cuts the ramp is for less than their feed: otherwise the input would
//! wait for the tool, and a higher feed would be a slower cut.
//!
//! This module knows planned cuts and the machine's limits. It knows nothing of calls, queues or overrides.

mod slow;
mod stop;
mod turning;

use heapless::{Deque, Vec};

use self::slow::{Bound, Bounds, cut_up, hold};
use self::stop::Side;
use self::turning::{allowed, per, ramp, turn_of_arc, window};

use crate::motion::{
    Action, CUTS_AHEAD, Corner, Heading, Limits, Path, Ramp, STRETCHES_OF_A_CUT, Scaling, Segment,
};
use crate::motion::{Stretch, Timed, to_units};
use crate::units::{div_wide, mul_div, product, root_wide};

/// Cuts in the window.
const WINDOW: usize = 24;

/// After a full window, so many eighths of the slowest rate that was seen lately are expected. With all of it, the next
/// corner of a rounded curve is too slow every few cuts.
const EXPECTED: u64 = 7;
/// Cuts after which a slow place is mostly forgotten.
const MEMORY: u64 = 64;

/// A cut that waits.
#[derive(Clone, Copy, Debug)]
struct Piece {
    segment: Segment,
    /// The way.
    length: u64,
    nominal: u64,
    /// The largest rate inside the cut.
    top: u64,
    /// How far the direction turns where it begins: the corner, and the arcs on both sides of it.
    turn: u64,
    /// The largest rate at its beginning, once that is known.
    passes: Option<u64>,
    /// That rate has been compared with what was under way when it became known. This is done once: from then on no cut
    /// leaves that is too fast for it.
    settled: bool,
    /// It begins after a stop. Once true, this stays true.
    stop: bool,
    /// Where it would have to be begun slower than this, a stop takes less time.
    least: u64,
}

/// The cuts that are under way without a stop.
#[derive(Clone, Copy, Debug)]
struct Chain {
    ramp: Ramp,
    limited: Limited,
}

/// What limits the ramp of joined cuts, and with it their rate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Limited {
    /// The fastest feed that was known when it was chosen.
    Feed,
    /// The machine.
    Machine,
    /// The number of cuts that can be on the way from the profile's input to the tool.
    Cuts,
}

/// A cut that leaves, and the stretches of its way; none if it begins and ends in an exact stop.
#[derive(Clone, Debug)]
pub struct Due {
    /// The cut.
    pub segment: Option<Segment>,
    /// Its way.
    pub stretches: Vec<Stretch, STRETCHES_OF_A_CUT>,
}

impl Due {
    /// No cut.
    pub const NONE: Self = Self {
        segment: None,
        stretches: Vec::new(),
    };
}

/// The window.
#[derive(Debug)]
pub struct Lookahead {
    window: Deque<Piece, WINDOW>,
    chain: Option<Chain>,
    /// Slow places behind the first cut of the window.
    behind: Bounds,
    /// What has left may be faster than a corner allows that is known too late: up to this rate, for corners within this
    /// distance.
    rash: Bound,
    /// The slowest place that was seen lately.
    lately: u64,
    /// Where the newest cut goes at its end, and how far an arc turns before.
    heading: Heading,
    turns: u64,
    /// The newest cut, for the stop that may be between it and the next one.
    newest: Side,
}

impl Default for Lookahead {
    fn default() -> Self {
        Self::new()
    }
}

impl Lookahead {
    /// Empty.
    #[must_use]
    // [D146]
    #[inline(always)]
    pub const fn new() -> Self {
        Self {
            window: Deque::new(),
            chain: None,
            behind: Vec::new(),
            rash: Bound::NONE,
            lately: u64::MAX,
            heading: Heading::NONE,
            turns: 0,
            newest: Side::NONE,
        }
    }

    /// Drops everything.
    pub fn clear(&mut self) {
        while self.window.pop_front().is_some() {}
        self.chain = None;
        self.behind.clear();
        self.rash = Bound::NONE;
    }

    /// What comes next begins with a stop, or is no cut. No cut may wait.
    pub const fn interrupt(&mut self) {
        self.chain = None;
    }

    /// True where no cut waits.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.window.is_empty()
    }

    /// True where the oldest cut has to leave before another one comes.
    #[must_use]
    pub fn is_full(&self) -> bool {
        self.window.is_full()
    }

    /// True for a cut that may be joined to others: it moves X or Z, and C stands.
    #[must_use]
    pub fn joins(timed: &Timed, limits: &Limits) -> bool {
        limits.corner().is_some()
            && timed.scaling != Scaling::Rapid
            && timed.length.nm() > 0
            && timed.path.start().c == timed.path.end().c
    }

    /// Takes a cut that [`joins`](Self::joins) at the end of the window. False where it is full, or where the segment is no
    /// such cut.
    #[must_use]
    pub fn push(&mut self, segment: &Segment, limits: &Limits) -> bool {
        let (Some(corner), Action::Timed(timed)) = (limits.corner(), &segment.action) else {
            return false;
        };
        let length = to_units(timed.length);
        let window = window(corner);
        let mut top = corner.along.speed.raw().into();
        // A tick passes no more than one end of a cut.
        top = length.min(top);
        if let Path::Arc(arc) = &timed.path {
            let bend = arc.bend();
            // v · (v · m / R) is at most `turning`, and a tick turns by an eighth of a radian at most.
            let square = product(corner.turning << 8, bend.radius);
            let square = div_wide(square, window);
            let even = root_wide(square).min(bend.radius.saturating_mul(32));
            top = top.min(mul_div(even, 1 << 32, bend.stretch)).max(1);
        }
        let top = top.max(1);
        let nominal = u64::from(timed.nominal.raw());
        let [first, last] = timed.path.headings();
        let begins_anew = self.window.is_empty() && self.chain.is_none();
        let corner_turn = if begins_anew {
            // What was before ended in a stop.
            0
        } else {
            first.turn_from(&self.heading).saturating_add(self.turns)
        };
        let newest = Side::of(timed);
        let mut piece = Piece {
            segment: *segment,
            length,
            nominal,
            top,
            turn: 0,
            passes: None,
            settled: false,
            stop: false,
            least: self.newest.least(&newest),
        };
        let turns = own_turn(&piece, corner);
        piece.turn = corner_turn.saturating_add(turns);
        piece.stop = !self.window.is_empty() && allowed(corner, piece.turn) < piece.least;
        if self.window.push_back(piece).is_err() {
            return false;
        }
        (self.heading, self.turns, self.newest) = (last, turns, newest);
        true
    }

    /// Takes out the oldest cut. `closed`: what comes after the window begins with a stop. Otherwise the way goes on, and
    /// how is not known. False where no cut waits.
    #[inline(never)]
    pub fn pop(&mut self, limits: &Limits, closed: bool, due: &mut Due) -> bool {
        due.stretches.clear();
        due.segment = None;
        let (Some(corner), Some(first)) = (limits.corner(), self.window.front().copied()) else {
            return false;
        };
        let horizon = Horizon {
            closed,
            // Calls come fast enough: there is no room for more.
            full: self.is_full(),
        };
        due.segment = Some(first.segment);
        if let Some(chain) = self.chain
            && self.stops_at(0, 0, corner, &chain, closed)
        {
            self.chain = None;
        }
        let anew = self.chain.is_none();
        if anew {
            self.begin_anew(corner, closed);
        }
        if let Some(chain) = self.chain {
            self.way_of(&first, anew, corner, &chain, &horizon, due);
        }
        self.window.pop_front();
        if closed && self.window.is_empty() {
            self.interrupt();
        }
        true
    }

    /// The first cut begins after a stop: others may be joined to it.
    fn begin_anew(&mut self, corner: &Corner, closed: bool) {
        self.behind.clear();
        self.rash = Bound::NONE;
        self.lately = u64::MAX;
        if let Some(first) = self.window.front_mut() {
            // No corner is before it.
            first.passes = None;
            first.turn = own_turn(first, corner);
        }
        let chain = self.chain_from_first(corner);
        self.chain = chain.filter(|chain| {
            let is_alone = if self.window.len() == 1 {
                closed
            } else {
                self.stops_at(1, 0, corner, chain, closed)
            };
            !is_alone
        });
    }

    /// Plans the way of the first cut, and keeps what the next ones have to know of it.
    fn way_of(
        &mut self,
        first: &Piece,
        anew: bool,
        corner: &Corner,
        chain: &Chain,
        horizon: &Horizon,
        due: &mut Due,
    ) {
        let cap = u64::from(chain.ramp.cap().raw());
        let zone = chain.zone(corner);
        let passes = self.passes(0, corner, cap, horizon.closed).rate;
        // The way of m ticks belongs to the corner, and the zone comes after that.
        let after = zone.saturating_add(window(corner));
        hold(&mut self.behind, cap, passes, passes.saturating_mul(after));
        let mut ahead = Bounds::new();
        self.look(first, corner, chain, horizon, &mut ahead);
        cut_up(first, anew, cap, &self.behind, &ahead, &mut due.stretches);
        if let Some(Segment {
            action: Action::Timed(timed),
            ..
        }) = &mut due.segment
        {
            timed.ramp = chain.ramp;
            timed.rounding = Some(corner.mean);
        }
        for bound in &mut self.behind {
            bound.reach = bound.reach.saturating_sub(first.length);
        }
        self.behind.retain(|bound| bound.reach > 0);
        hold(
            &mut self.behind,
            cap,
            first.top,
            first.top.saturating_mul(zone),
        );
    }

    /// True where the cut at `index` begins with a stop; it begins `distance` after what has left.
    #[inline(never)]
    fn stops_at(
        &mut self,
        index: usize,
        distance: u64,
        corner: &Corner,
        chain: &Chain,
        closed: bool,
    ) -> bool {
        let cap = u64::from(chain.ramp.cap().raw());
        let zone = chain.zone(corner);
        let mut passes = self.passes(index, corner, cap, closed);
        let rash = self.rash;
        let Some(piece) = self.window.iter_mut().nth(index) else {
            return true;
        };
        // The first of the window leaves now, whatever is known.
        if (passes.known || index == 0) && !piece.settled {
            piece.settled = true;
            let slowest = passes.rate.min(piece.top);
            let recovers = slowest.saturating_sub(self.lately) / MEMORY;
            self.lately = self.lately.saturating_add(recovers).min(slowest);
            let too_late =
                slowest < rash.top && distance < rash.reach.min(slowest.saturating_mul(zone));
            // At this rate, the way to its beginning takes as long as the rate has to hold.
            let in_time = per(distance, zone);
            if too_late && in_time < piece.least.min(cap) {
                piece.stop = true;
            } else if too_late {
                passes.rate = passes.rate.min(in_time);
                piece.passes = Some(passes.rate);
                piece.top = piece.top.min(in_time);
            }
        }
        piece.stop |= (passes.known && passes.rate < piece.least.min(cap))
            || piece.is_worth_a_stop(cap, chain.limited);
        piece.stop
    }

    /// The ramp of cuts that are joined from the first of the window on: for one and a half times their fastest feed, or as
    /// much of it as so short cuts allow.
    fn chain_from_first(&self, corner: &Corner) -> Option<Chain> {
        let first = self.window.front()?;
        let (mut feed, mut way, mut cuts) = (first.nominal, first.length, 1_u64);
        for piece in self.window.iter().skip(1).take_while(|piece| !piece.stop) {
            feed = feed.max(piece.nominal);
            way = way.saturating_add(piece.length);
            cuts = cuts.saturating_add(1);
        }
        let ahead = mul_div(way, CUTS_AHEAD, cuts);
        let fastest = u64::from(corner.along.speed.raw());
        let mut cap = feed.saturating_add(feed / 2).min(fastest).max(2);
        let mut limited = if cap == fastest {
            Limited::Machine
        } else {
            Limited::Feed
        };
        loop {
            if let Some(ramp) = ramp(cap, corner) {
                // The input is ahead of the tool by half of all means, at the feed: two thirds of the ramp's rate.
                let delay = u64::from(ramp.ticks() / 2).saturating_add(window(corner));
                if (cap / 3).saturating_mul(2).saturating_mul(delay) <= ahead {
                    return Some(Chain { ramp, limited });
                }
                limited = Limited::Cuts;
            } else {
                limited = Limited::Machine;
            }
            // Slower, the ramp is shorter.
            cap = cap.saturating_sub(cap / 8);
            if cap < 16 {
                return None;
            }
        }
    }

    /// The largest rate where the cut at `index` begins, with all that turns within the next m ticks.
    #[inline(never)]
    fn passes(&mut self, index: usize, corner: &Corner, cap: u64, closed: bool) -> Passes {
        if let Some(rate) = self.window.iter().nth(index).and_then(|piece| piece.passes) {
            return Passes { rate, known: true };
        }
        let window = window(corner);
        let (mut turned, mut distance) = (0_u64, 0_u64);
        let mut rate = cap;
        // What comes after the pieces that are counted begins with a stop, or is too far away to count.
        let mut known = closed;
        for (place, piece) in self.window.iter().enumerate().skip(index) {
            if place > index && piece.stop {
                known = true;
                break;
            }
            turned = turned.saturating_add(piece.turn);
            let now = allowed(corner, turned).min(cap);
            // Slow enough for its turn not to be among them.
            let without = per(distance, window).saturating_sub(1);
            distance = distance.saturating_add(piece.length);
            rate = now.max(without.min(rate));
            if now < without || rate.saturating_mul(window) <= distance {
                known = true;
                break;
            }
        }
        if !known {
            // A corner may follow.
            rate = rate.min(per(distance, window).saturating_sub(1));
        }
        let rate = rate.max(1);
        if known && let Some(piece) = self.window.iter_mut().nth(index) {
            piece.passes = Some(rate);
        }
        Passes { rate, known }
    }

    /// The slow places that reach back into the first cut from behind its end.
    fn look(
        &mut self,
        first: &Piece,
        corner: &Corner,
        chain: &Chain,
        horizon: &Horizon,
        ahead: &mut Bounds,
    ) {
        let cap = u64::from(chain.ramp.cap().raw());
        let zone = chain.zone(corner);
        let farthest = cap.saturating_mul(zone);
        self.rash.reach = self.rash.reach.saturating_sub(first.length);
        let mut distance = 0_u64;
        let mut slowest = cap;
        let mut index = 1;
        while let Some(piece) = self.window.iter().nth(index) {
            if distance >= farthest {
                return;
            }
            let length = piece.length;
            if self.stops_at(index, distance, corner, chain, horizon.closed) {
                return;
            }
            let passes = self.passes(index, corner, cap, horizon.closed);
            if !passes.known {
                slowest = slowest.min(passes.rate);
                break;
            }
            let top = self.window.iter().nth(index).map_or(0, |piece| piece.top);
            for slow in [top.min(passes.rate), passes.rate] {
                let reach = slow.saturating_mul(zone).saturating_sub(distance);
                hold(ahead, cap, slow, reach);
            }
            distance = distance.saturating_add(length);
            index = index.saturating_add(1);
        }
        if index == self.window.len() && horizon.closed {
            return;
        }
        // At a distance d before the end of what is known, the rate is at most d / zone.
        let expected = match self.lately {
            _ if !horizon.full => 0,
            slow if slow < cap => mul_div(slow, EXPECTED, 8).min(slowest),
            _ => slowest,
        };
        let floor = expected.max(corner.turning / 2);
        let mut from = distance;
        while from < farthest {
            let to = from.saturating_mul(2).max(zone);
            let rate = per(from, zone).max(floor).max(1);
            hold(ahead, cap, rate, to.saturating_sub(distance));
            from = to;
        }
        let reach = floor.saturating_mul(zone);
        if reach > distance {
            self.rash.top = self.rash.top.max(floor);
            self.rash.reach = self.rash.reach.max(reach);
        } else if self.rash.reach == 0 {
            self.rash = Bound::NONE;
        }
    }
}

/// How much is known.
#[derive(Clone, Copy, Debug)]
struct Horizon {
    /// After the window there is a stop.
    closed: bool,
    /// The window has no room for more.
    full: bool,
}

/// The largest rate where a cut begins.
#[derive(Clone, Copy, Debug)]
struct Passes {
    rate: u64,
    /// What comes later makes it neither larger nor smaller.
    known: bool,
}

impl Piece {
    /// True where a stop before the cut, after which a ramp for its feed can begin, takes less time than to cut it at the
    /// rate of the ramp that there is.
    fn is_worth_a_stop(&self, cap: u64, limited: Limited) -> bool {
        let Action::Timed(timed) = &self.segment.action else {
            return false;
        };
        match limited {
            _ if self.nominal <= cap => false,
            Limited::Feed => true,
            Limited::Machine => false,
            Limited::Cuts => Side::of(timed).is_faster_alone(cap),
        }
    }
}

impl Chain {
    /// Ticks before and after a corner in which its rate has to hold.
    fn zone(&self, corner: &Corner) -> u64 {
        u64::from(self.ramp.ticks()).saturating_add(window(corner).saturating_mul(2))
    }
}

/// The turn of a cut's beginning that is its own: an arc's.
fn own_turn(piece: &Piece, corner: &Corner) -> u64 {
    let Action::Timed(Timed {
        path: Path::Arc(arc),
        ..
    }) = &piece.segment.action
    else {
        return 0;
    };
    turn_of_arc(piece.length, piece.top, arc.bend().radius, corner)
}

#[cfg(test)]
#[allow(clippy::arithmetic_side_effects, clippy::float_arithmetic)]
mod tests;
