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
/// path: threads, dwells, spindle and machine functions.
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
            let path = limits.line(line.length().nm() as u64, line.distances(), Pace::Rapid);
            plan(Path::Line(line), path.speed, &path, None, span, limits).map(Some)
        }
        MoveKind::Feed(feed) => {
            let line = line(from, target)?;
            let path = limits.line(line.length().nm() as u64, line.distances(), Pace::Cutting);
            let nominal = nominal(feed, line.length(), line.feed_length(), limits, span)?;
            plan(Path::Line(line), nominal, &path, Some(feed), span, limits).map(Some)
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
            let path = limits.arc(&arc.bend(), FEED_OVERRIDE_MAX.of(nominal));
            plan(Path::Arc(arc), nominal, &path, Some(feed), span, limits).map(Some)
        }
        MoveKind::Thread(_) | MoveKind::Dwell(_) | MoveKind::Spindle(_) | MoveKind::Aux(_) => {
            Ok(None)
        }
    }
}

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

fn plan(
    path: Path,
    nominal: PathRate,
    bounds: &PathLimits,
    feed: Option<FeedRate>,
    span: Span,
    limits: &Limits,
) -> Result<Timed, Alarm> {
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
    Ok(Timed {
        path,
        length,
        nominal,
        ramp,
        exit: PathRate::ZERO,
        feed,
    })
}
