//! Plans a time-driven move for the tick: path, speed and ramp. Background work, with 128-bit divisions.
//!
//! This module knows moves and limits; it knows nothing of the moves before or after.

use super::arc::{Arc, ArcError};
use super::limits::{Limits, Pace, PathLimits};
use super::line::Line;
use super::path::Path;
use super::profile::{CAPACITY, Ramp};
use super::rate::{PathRate, Rate};
use super::rounding::Mean;
use super::shape;
use crate::alarm::{Alarm, Arg, Code, Span};
use crate::call::{FeedRate, Position};
use crate::moves::{Move, MoveKind};
use crate::units::{Divisor, Feed, Length, Rpm, TurnRate, mul_div};

/// The highest feed override for which the ramp of a feed has room.
pub const FEED_OVERRIDE_MAX: Rate = Rate::percent(150);

/// A motion driven by time, ready for the tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timed {
    /// The path of the motion.
    pub path: Path,
    /// Length of the path: in nm, or in µ° if C covers more.
    pub length: Length,
    /// Rate at [`Rate::FULL`].
    pub nominal: PathRate,
    /// The ramp: the two means and the largest rate.
    pub ramp: Ramp,
    /// The motion is joined to others: its corners are rounded by these means, its way comes as stretches, and only the
    /// stretches know where it stops. `None`: it begins and ends in an exact stop.
    pub rounding: Option<Mean>,
    /// What the tick multiplies the rate by.
    pub scaling: Scaling,
}

/// What a tick multiplies the programmed rate of a motion by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scaling {
    /// The rapid override.
    Rapid,
    /// The feed override.
    Feed,
    /// The feed override, and the measured spindle speed divided by the commanded one (G99). This is the commanded speed,
    /// in 2⁻¹⁶ turns per second.
    Turns(Divisor),
}

impl Scaling {
    fn of(feed: Option<FeedRate>) -> Self {
        match feed {
            None => Self::Rapid,
            Some(FeedRate::PerMinute(_)) => Self::Feed,
            Some(FeedRate::PerTurn(_, rpm)) => {
                let commanded = TurnRate::of_rpm(rpm).abs().raw() >> 16;
                Self::Turns(Divisor::new(u32::try_from(commanded).unwrap_or(u32::MAX)))
            }
        }
    }
}

impl Timed {
    /// Ticks from rest to rest at [`Rate::FULL`]; zero if nothing moves.
    #[must_use]
    pub fn duration_ticks(&self) -> u64 {
        shape::duration_ticks(self.length, self.nominal, &self.ramp)
    }

    /// End of the path.
    #[must_use]
    pub const fn end(&self) -> Position {
        self.path.end()
    }
}

/// Plans a rapid, a feed or an arc from the standing position `from`. `None` for all other moves: threads, taps,
/// dwells, spindle and machine functions.
///
/// # Errors
///
/// [`Code::MoveTooFar`], [`Code::FeedZero`], [`Code::SpeedOutOfReach`], [`Code::ArcNoRadius`], [`Code::ArcEndOff`],
/// [`Code::ArcMovesC`].
pub fn timed(from: Position, target: &Move, limits: &Limits) -> Result<Option<Timed>, Alarm> {
    let feed = match &target.kind {
        MoveKind::Rapid => None,
        MoveKind::Feed(feed) | MoveKind::Arc { feed, .. } => Some(*feed),
        MoveKind::Thread(_)
        | MoveKind::Tap(_)
        | MoveKind::Dwell(_)
        | MoveKind::Spindle(_)
        | MoveKind::Aux(_) => return Ok(None),
    };
    match &planned(from, target, feed, limits) {
        Ok(timed) => Ok(Some(*timed)),
        Err(refusal) => Err(refusal.alarm(target.span)),
    }
}

/// The reason why a move cannot be planned.
pub(super) enum Refusal {
    /// The move begins or ends out of range.
    TooFar,
    /// The feed is zero on this path.
    NoFeed,
    /// The feed is per turn, and the spindle stands.
    Standing,
    /// The arc is impossible.
    Arc(ArcError),
    /// The ramp up to this speed would be too long.
    OutOfReach(Feed),
}

#[inline(never)]
fn planned(
    from: Position,
    target: &Move,
    feed: Option<FeedRate>,
    limits: &Limits,
) -> Result<Timed, Refusal> {
    if !in_range(from) || !in_range(target.to) {
        return Err(Refusal::TooFar);
    }
    let path = match &path(from, target) {
        Ok(path) => *path,
        Err(error) => return Err(Refusal::Arc(*error)),
    };
    let length = path.length();
    let tick_us = limits.tick_us();
    let (nominal, mut bounds) = match (&path, feed) {
        (Path::Line(line), None) => {
            let bounds = limits.line(line, Pace::Rapid);
            (bounds.speed, bounds)
        }
        (Path::Line(line), Some(feed)) => (
            nominal(feed, length, line.feed_length(), tick_us),
            limits.line(line, Pace::Cutting),
        ),
        (Path::Arc(arc), feed) => {
            let nominal = feed.map_or(PathRate::ZERO, |feed| {
                nominal(feed, length, length, tick_us)
            });
            (nominal, arc_limits(arc, nominal, limits))
        }
    };
    if feed.is_some() {
        if nominal == PathRate::ZERO {
            return Err(match feed {
                Some(FeedRate::PerTurn(_, Rpm::STOPPED)) => Refusal::Standing,
                _ => Refusal::NoFeed,
            });
        }
        bounds.speed = bounds.speed.min(FEED_OVERRIDE_MAX.of(nominal));
    }
    let Some(ramp) = shape::ramp(length, nominal, &bounds) else {
        return Err(Refusal::OutOfReach(bounds.speed.feed(tick_us)));
    };
    Ok(Timed {
        path,
        length,
        nominal,
        ramp,
        rounding: None,
        scaling: Scaling::of(feed),
    })
}

#[inline(never)]
fn path(from: Position, target: &Move) -> Result<Path, ArcError> {
    if let MoveKind::Arc {
        i, k, clockwise, ..
    } = target.kind
    {
        Arc::new(from, target.to, i, k, clockwise).map(Path::Arc)
    } else {
        Ok(Path::Line(Line::new(from, target.to)))
    }
}

/// The limits of an arc. The bend uses part of the acceleration and jerk, so a ramp that a line could just make may be
/// too long here. The arc is then driven slower: this frees some acceleration and jerk and makes the ramp shorter.
#[inline(never)]
fn arc_limits(arc: &Arc, nominal: PathRate, limits: &Limits) -> PathLimits {
    let bend = arc.bend();
    let mut path = limits.arc(&bend, FEED_OVERRIDE_MAX.of(nominal));
    for _ in 0..u32::BITS {
        if shape::ramp(arc.length(), nominal, &path).is_some() {
            break;
        }
        path = limits.arc(&bend, Rate::percent(75).of(path.speed));
    }
    path
}

fn in_range(position: Position) -> bool {
    let c = Length::from_nm(position.c.udeg());
    position.x.is_in_range() && position.z.is_in_range() && c.is_in_range()
}

impl Refusal {
    /// The alarm for a move of the block at `span`.
    #[inline(never)]
    pub(super) fn alarm(&self, span: Span) -> Alarm {
        let (code, word, args) = match *self {
            Self::TooFar | Self::Arc(ArcError::TooFar) => (
                Code::MoveTooFar,
                None,
                [Arg::Length(Length::INPUT_LIMIT), Arg::None],
            ),
            Self::NoFeed => (Code::FeedZero, Some(b'F'), [Arg::None; 2]),
            Self::Standing => (Code::SpindleStopped, Some(b'F'), [Arg::None; 2]),
            Self::Arc(ArcError::NoRadius) => (Code::ArcNoRadius, None, [Arg::None; 2]),
            Self::Arc(ArcError::NotOnCircle(start, end)) => (
                Code::ArcEndOff,
                None,
                [Arg::Length(start), Arg::Length(end)],
            ),
            Self::Arc(ArcError::MovesC) => (Code::ArcMovesC, Some(b'C'), [Arg::None; 2]),
            Self::OutOfReach(speed) => (
                Code::SpeedOutOfReach,
                None,
                [Arg::Feed(speed), Arg::Int(i64::from(CAPACITY))],
            ),
        };
        let [first, second] = args;
        let mut alarm = Alarm::new(code, span).with([first, second]);
        alarm.word = word;
        alarm
    }
}

/// The programmed speed as a rate on a path of `length`. The feed is measured on the part `measured` of this length.
fn nominal(feed: FeedRate, length: Length, measured: Length, tick_us: u32) -> PathRate {
    let own = PathRate::of_feed(feed.nominal(), tick_us);
    if length == measured {
        return own;
    }
    let (length, measured) = (length.nm() as u64, measured.nm() as u64);
    let scaled = mul_div(u64::from(own.raw()), length, measured);
    PathRate::from_raw(u32::try_from(scaled).unwrap_or(u32::MAX))
}

#[cfg(test)]
#[allow(clippy::arithmetic_side_effects)]
mod tests {
    use super::*;
    use crate::params::Params;
    use crate::units::{Angle, FeedPerTurn, Millis};

    fn position(x: i64, z: i64, c: i64) -> Position {
        Position {
            x: Length::from_nm(x),
            z: Length::from_nm(z),
            c: Angle::from_udeg(c),
        }
    }

    fn plan_to(to: Position, kind: MoveKind) -> Result<Option<Timed>, Alarm> {
        let target = Move {
            span: Span::default(),
            to,
            kind,
            tag: None,
        };
        timed(
            Position::default(),
            &target,
            &Limits::from_params(&Params::sheets()),
        )
    }

    fn feed(mm_per_min: i64) -> FeedRate {
        FeedRate::PerMinute(Feed::from_nm_per_min(mm_per_min * 1_000_000))
    }

    #[test]
    fn a_rapid_along_z() {
        // 16 m/min = 266 667 nm a tick; 3 m/s² = 3000, 60 m/s³ = 60: 89 ticks and 266667/(89·60) = 50.
        let timed = plan_to(position(0, 100_000_000, 0), MoveKind::Rapid)
            .unwrap()
            .unwrap();
        assert_eq!(timed.ramp.means(), (89, 50));
        assert_eq!(timed.nominal, timed.ramp.cap());
        // ⌈100 000 000 / 266 666.66⌉ + 139.
        assert_eq!(timed.duration_ticks(), 376 + 139);
        assert_eq!(timed.end(), position(0, 100_000_000, 0));
    }

    #[test]
    fn a_feed_has_room_for_its_override_up_to_the_axis() {
        let slow = plan_to(position(0, 50_000_000, 0), MoveKind::Feed(feed(600)))
            .unwrap()
            .unwrap();
        assert_eq!(slow.nominal.raw(), 10_000 * 256);
        assert_eq!(slow.ramp.cap().raw(), 15_000 * 256);
        // 8 m/min is the largest feed: 133 333 nm a tick.
        let fast = plan_to(position(0, 500_000_000, 0), MoveKind::Feed(feed(7_000)))
            .unwrap()
            .unwrap();
        assert_eq!(fast.ramp.cap().raw() / 256, 133_333);
    }

    #[test]
    fn a_feed_is_that_of_all_axes_together_a_degree_as_a_millimetre() {
        // 30 mm with 40° of C are 50: at 60 a minute they take 50 s, and the path is 40 000 000 µ° long.
        let timed = plan_to(
            position(0, 30_000_000, 40_000_000),
            MoveKind::Feed(feed(60)),
        )
        .unwrap()
        .unwrap();
        assert_eq!(timed.length, Length::from_nm(40_000_000));
        assert_eq!(timed.nominal.raw(), 800 * 256);
    }

    #[test]
    fn a_feed_per_turn_goes_by_the_commanded_speed() {
        let per_turn = FeedRate::PerTurn(FeedPerTurn::from_nm(200_000), Rpm::new(-300));
        let timed = plan_to(position(0, 50_000_000, 0), MoveKind::Feed(per_turn))
            .unwrap()
            .unwrap();
        // 0.2 mm · 300/min = 60 mm/min.
        assert_eq!(timed.nominal.raw(), 1_000 * 256);
        // 5 turns a second.
        assert_eq!(timed.scaling, Scaling::Turns(Divisor::new(5 << 16)));
        let standing = FeedRate::PerTurn(FeedPerTurn::from_nm(200_000), Rpm::STOPPED);
        let alarm = plan_to(position(0, 50_000_000, 0), MoveKind::Feed(standing)).unwrap_err();
        assert_eq!((alarm.code, alarm.word), (Code::SpindleStopped, Some(b'F')));
        let nothing = FeedRate::PerTurn(FeedPerTurn::from_nm(0), Rpm::new(300));
        let alarm = plan_to(position(0, 50_000_000, 0), MoveKind::Feed(nothing)).unwrap_err();
        assert_eq!((alarm.code, alarm.word), (Code::FeedZero, Some(b'F')));
    }

    #[test]
    fn an_arc_is_as_fast_as_its_bend_allows() {
        let arc = |radius: i64| {
            let kind = MoveKind::Arc {
                i: Length::ZERO,
                k: Length::from_nm(-radius),
                clockwise: false,
                feed: feed(6_000),
            };
            plan_to(position(radius, -radius, 0), kind)
                .unwrap()
                .unwrap()
        };
        // 100 mm/s on a radius of 100 mm: 0.1 m/s² across the path, so the feed and its override stay as they are.
        assert_eq!(arc(100_000_000).nominal.raw(), 100_000 * 256);
        assert!(arc(100_000_000).ramp.cap().raw() > 130_000 * 256);
        // On a radius of 1 mm two limits hold: √(a·R/2) with a = 2 m/s² · 15/16 is 30.6 mm/s, and ∛(j·R²/4) with
        // 60 m/s³ · 7/8 is 23.6 mm/s.
        let tight = arc(1_000_000).ramp.cap().raw() / 256;
        assert!((15_000..23_600).contains(&tight), "{tight}");
    }

    #[test]
    fn nothing_to_do_takes_no_time() {
        let timed = plan_to(Position::default(), MoveKind::Rapid)
            .unwrap()
            .unwrap();
        assert_eq!((timed.length, timed.duration_ticks()), (Length::ZERO, 0));
        assert_eq!(
            plan_to(Position::default(), MoveKind::Dwell(Millis::new(3))),
            Ok(None)
        );
    }

    #[test]
    fn what_cannot_be_planned_is_an_alarm() {
        let code = |to, kind| plan_to(to, kind).unwrap_err().code;
        let far = position(0, (1 << 42) + 1, 0);
        assert_eq!(code(far, MoveKind::Rapid), Code::MoveTooFar);
        assert_eq!(
            code(position(0, 1, 0), MoveKind::Feed(feed(0))),
            Code::FeedZero
        );
        let arc = |k, i| MoveKind::Arc {
            i: Length::from_nm(i),
            k: Length::from_nm(k),
            clockwise: true,
            feed: feed(100),
        };
        assert_eq!(code(position(5, 5, 0), arc(0, 0)), Code::ArcNoRadius);
        assert_eq!(
            code(position(0, 300_000, 0), arc(100_000, 0)),
            Code::ArcEndOff
        );
        assert_eq!(
            code(position(0, 200_000, 1), arc(100_000, 0)),
            Code::ArcMovesC
        );
    }
}
