//! From a move to what the tick needs: path, speed and ramp. Background work, with 128-bit divisions.
//!
//! Knows moves and limits; knows nothing of what was planned before or comes after.

use super::arc::{Arc, ArcError};
use super::limits::{Limits, Pace, PathLimits};
use super::line::Line;
use super::path::Path;
use super::profile::{CAPACITY, Ramp};
use super::rate::{PathRate, Rate};
use super::shape;
use crate::alarm::{Alarm, Arg, Code, Span};
use crate::cycle::{Move, MoveKind};
use crate::program::{FeedRate, Position};
use crate::units::{Feed, Length, mul_div};

/// The feed override up to which a feed leaves room in its ramp.
pub const FEED_OVERRIDE_MAX: Rate = Rate::percent(150);

/// A motion driven by time, ready for the tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timed {
    /// Where it goes.
    pub path: Path,
    /// Its length: nm, or µ° where C covers more.
    pub length: Length,
    /// Rate at [`Rate::FULL`].
    pub nominal: PathRate,
    /// Its means and its largest rate.
    pub ramp: Ramp,
    /// Rate at which it may hand over to the next motion; zero asks for an exact stop, and the planner always does.
    pub exit: PathRate,
    /// The programmed speed, `None` for a rapid. Under G99 the tick's rate is the measured spindle speed over the
    /// commanded one, times the override.
    pub feed: Option<FeedRate>,
}

impl Timed {
    /// Ticks from rest to rest at [`Rate::FULL`]; zero where nothing moves.
    #[must_use]
    pub fn duration_ticks(&self) -> u64 {
        shape::duration_ticks(self.length, self.nominal, &self.ramp)
    }

    /// Where it ends.
    #[must_use]
    pub const fn end(&self) -> Position {
        self.path.end()
    }
}

/// Plans a rapid, a feed or an arc from the standing position `from`. `None` for moves that time does not drive along a
/// path: threads, taps, dwells, spindle and machine functions.
///
/// # Errors
///
/// [`Code::MoveTooFar`], [`Code::FeedZero`], [`Code::SpeedOutOfReach`], [`Code::ArcNoRadius`], [`Code::ArcEndOff`],
/// [`Code::ArcMovesC`].
pub fn timed(from: Position, target: &Move, limits: &Limits) -> Result<Option<Timed>, Alarm> {
    let span = target.span;
    match target.kind {
        MoveKind::Rapid => {
            let line = line(from, target)?;
            let path = limits.line(&line, Pace::Rapid);
            plan(Path::Line(line), path.speed, &path, None, span, limits)
        }
        MoveKind::Feed(feed) => {
            let line = line(from, target)?;
            let path = limits.line(&line, Pace::Cutting);
            let nominal = nominal(feed, line.length(), line.feed_length(), limits, span)?;
            plan(Path::Line(line), nominal, &path, Some(feed), span, limits)
        }
        MoveKind::Arc {
            i,
            k,
            clockwise,
            feed,
        } => {
            in_range(from, span)?;
            in_range(target.to, span)?;
            let arc =
                Arc::new(from, target.to, i, k, clockwise).map_err(|error| refusal(error, span))?;
            let nominal = nominal(feed, arc.length(), arc.length(), limits, span)?;
            let path = arc_limits(&arc, nominal, limits);
            plan(Path::Arc(arc), nominal, &path, Some(feed), span, limits)
        }
        MoveKind::Thread(_)
        | MoveKind::Tap(_)
        | MoveKind::Dwell(_)
        | MoveKind::Spindle(_)
        | MoveKind::Aux(_) => Ok(None),
    }
}

/// The limits of an arc. The bend takes its part of acceleration and jerk, so that a ramp which a line could just make
/// may be too long here: then the arc is driven slower, which gives back some of both and makes the ramp shorter.
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

#[inline(never)]
fn line(from: Position, target: &Move) -> Result<Line, Alarm> {
    in_range(from, target.span)?;
    in_range(target.to, target.span)?;
    Ok(Line::new(from, target.to))
}

fn in_range(position: Position, span: Span) -> Result<(), Alarm> {
    let c = Length::from_nm(position.c.udeg());
    if position.x.is_in_range() && position.z.is_in_range() && c.is_in_range() {
        Ok(())
    } else {
        Err(too_far(span))
    }
}

fn too_far(span: Span) -> Alarm {
    Alarm::new(Code::MoveTooFar, span).with([
        Arg::Length(Length::INPUT_LIMIT),
        Arg::None,
        Arg::None,
        Arg::None,
    ])
}

fn refusal(error: ArcError, span: Span) -> Alarm {
    match error {
        ArcError::NoRadius => Alarm::new(Code::ArcNoRadius, span),
        ArcError::NotOnCircle(start, end) => Alarm::new(Code::ArcEndOff, span).with([
            Arg::Length(start),
            Arg::Length(end),
            Arg::None,
            Arg::None,
        ]),
        ArcError::TooFar => too_far(span),
        ArcError::MovesC => Alarm::new(Code::ArcMovesC, span).word(b'C'),
    }
}

/// The programmed speed as a rate on a path of `length`, of which `measured` counts for the feed.
fn nominal(
    feed: FeedRate,
    length: Length,
    measured: Length,
    limits: &Limits,
    span: Span,
) -> Result<PathRate, Alarm> {
    let own = PathRate::of_feed(feed.nominal(), limits.tick_us());
    let scaled = if length == measured {
        own.raw()
    } else {
        let scaled = mul_div(
            u64::from(own.raw()),
            length.nm() as u64,
            measured.nm() as u64,
        );
        u32::try_from(scaled).unwrap_or(u32::MAX)
    };
    if scaled == 0 {
        return Err(Alarm::new(Code::FeedZero, span).word(b'F'));
    }
    Ok(PathRate::from_raw(scaled))
}

#[inline(never)]
fn plan(
    path: Path,
    nominal: PathRate,
    bounds: &PathLimits,
    feed: Option<FeedRate>,
    span: Span,
    limits: &Limits,
) -> Result<Option<Timed>, Alarm> {
    let mut bounds = *bounds;
    if feed.is_some() {
        bounds.speed = bounds.speed.min(FEED_OVERRIDE_MAX.of(nominal));
    }
    let length = path.length();
    let Some(ramp) = shape::ramp(length, nominal, &bounds) else {
        let speed: Feed = bounds.speed.feed(limits.tick_us());
        return Err(Alarm::new(Code::SpeedOutOfReach, span).with([
            Arg::Feed(speed),
            Arg::Int(i64::from(CAPACITY)),
            Arg::None,
            Arg::None,
        ]));
    };
    Ok(Some(Timed {
        path,
        length,
        nominal,
        ramp,
        exit: PathRate::ZERO,
        feed,
    }))
}

#[cfg(test)]
#[allow(clippy::arithmetic_side_effects)]
mod tests {
    use super::*;
    use crate::params::Params;
    use crate::units::{Angle, FeedPerTurn, Millis, Rpm};

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
            &Limits::from_params(&Params::slant_bed()),
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
        // 8 m/min is the most: 133 333 nm a tick.
        let fast = plan_to(position(0, 500_000_000, 0), MoveKind::Feed(feed(7_000)))
            .unwrap()
            .unwrap();
        assert_eq!(fast.ramp.cap().raw() / 256, 133_333);
    }

    #[test]
    fn a_feed_is_the_speed_of_the_tool_where_c_turns_further() {
        // 1 mm with a full turn of C: the path is 360 000 000 µ° long, the tool does 1 mm at 60 mm/min = 1 s.
        let timed = plan_to(
            position(0, 1_000_000, 360_000_000),
            MoveKind::Feed(feed(60)),
        )
        .unwrap()
        .unwrap();
        assert_eq!(timed.length, Length::from_nm(360_000_000));
        assert_eq!(timed.nominal.raw(), 360_000 * 256);
    }

    #[test]
    fn a_feed_per_turn_goes_by_the_commanded_speed() {
        let per_turn = FeedRate::PerTurn(FeedPerTurn::from_nm(200_000), Rpm::new(-300));
        let timed = plan_to(position(0, 50_000_000, 0), MoveKind::Feed(per_turn))
            .unwrap()
            .unwrap();
        // 0.2 mm · 300/min = 60 mm/min.
        assert_eq!(timed.nominal.raw(), 1_000 * 256);
        assert_eq!(timed.feed, Some(per_turn));
        let standing = FeedRate::PerTurn(FeedPerTurn::from_nm(200_000), Rpm::STOPPED);
        let alarm = plan_to(position(0, 50_000_000, 0), MoveKind::Feed(standing)).unwrap_err();
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
        // 100 mm/s round 100 mm: 0.1 m/s² across; the feed and its override stand.
        assert_eq!(arc(100_000_000).nominal.raw(), 100_000 * 256);
        assert!(arc(100_000_000).ramp.cap().raw() > 130_000 * 256);
        // Round 1 mm the most is √(a·R/2) with a = 2 m/s² · 15/16: 30.6 mm/s, and ∛(j·R²/4) with 60 m/s³ · 7/8: 23.6.
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
