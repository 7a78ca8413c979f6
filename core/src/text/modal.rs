//! What earlier blocks have set, and how a word is read by it: units, coordinate systems, tool offset, feed, speed.

use super::block::{Block, Letters, Word, g_arg};
use super::options::{Dialect, Options};
use super::scale::{Range, Scale};
use crate::alarm::{Alarm, Arg, At, Code, Span};
use crate::call::{FeedRate, LengthUnit, Position, SurfaceSpeed};
use crate::offsets::Source;
use crate::params::Params;
use crate::units::{Angle, Diameter, Feed, FeedPerTurn, Length, Rpm};

/// Words that place an axis.
pub(crate) const AXES: Letters = Letters::of(b"XUZWCH");
/// Words that place X or Z.
pub(crate) const PLANE_AXES: Letters = Letters::of(b"XUZW");

/// The feed in force.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ModalFeed {
    None,
    PerMinute(Feed),
    PerTurn(FeedPerTurn),
}

/// What is in force for the words of any block. At power-on: G18 G21 G54 G98, no feed, spindle standing, no shift, no
/// tool offset.
#[derive(Clone, Debug)]
pub(crate) struct Modal<'p> {
    pub(crate) params: &'p Params,
    pub(crate) options: Options,
    pub(crate) scale: Scale,
    /// 17, 18 or 19.
    pub(crate) plane: u8,
    /// Index of the work coordinate system: 0 is G54.
    pub(crate) system: u8,
    /// Offset number in force, 0 for none.
    pub(crate) offset: u8,
    /// What G50 has added to every coordinate system.
    pub(crate) shift: Position,
    /// Machine coordinates of the work zero in force: coordinate system + G50 + tool offset.
    pub(crate) origin: Position,
    /// Where the machine stands after the blocks so far.
    pub(crate) position: Position,
    pub(crate) per_turn: bool,
    pub(crate) feed: ModalFeed,
    /// S under G97.
    pub(crate) speed: u32,
    /// −1, 0 or +1.
    pub(crate) direction: i32,
    /// G96.
    pub(crate) in_surface: bool,
    /// S under G96, once there was one.
    pub(crate) surface: Option<Feed>,
    /// S of G50: the highest speed under G96.
    pub(crate) speed_limit: Option<u32>,
    /// The gear that is in, from 1; 0: nobody knows.
    pub(crate) gear: u8,
    /// M24 of a Haas: threads have no run-out that their words do not ask for.
    pub(crate) without_run_out: bool,
    /// G99 of the FANUC systems B and C: a tap ends at R.
    pub(crate) taps_end_at_r: bool,
}

impl<'p> Modal<'p> {
    pub(crate) fn new(params: &'p Params, options: Options) -> Self {
        let gear = options.gear;
        let mut modal = Self {
            params,
            options,
            scale: Scale::new(false, params.increment_is_c()),
            plane: 18,
            system: 0,
            offset: 0,
            shift: Position::ZERO,
            origin: Position::ZERO,
            position: options.position,
            per_turn: options.per_turn,
            feed: ModalFeed::None,
            speed: 0,
            direction: 0,
            in_surface: false,
            surface: None,
            speed_limit: None,
            gear,
            without_run_out: false,
            taps_end_at_r: false,
        };
        modal.place_origin();
        modal
    }

    /// Tenths of the lead that a thread runs out over where its words do not say so.
    pub(crate) const fn run_out_tenths(&self) -> u8 {
        if self.without_run_out {
            return 0;
        }
        self.params.thread_chamfer()
    }

    /// What offsets are read from.
    pub(crate) const fn offsets(&self) -> Source<'_> {
        Source {
            params: self.params,
            table: self.options.offsets.as_ref(),
        }
    }

    /// The work zero of the coordinate system, shift and offset in force.
    pub(crate) fn place_origin(&mut self) {
        let source = self.offsets();
        let [x, z] = source.zero(self.system);
        let [tool_x, tool_z] = source.tool(self.offset);
        self.origin = Position {
            x: x + self.shift.x + tool_x,
            z: z + self.shift.z + tool_z,
            c: self.shift.c,
        };
    }

    /// G20 or G21.
    pub(crate) const fn length_unit(&self) -> LengthUnit {
        if self.scale.is_inch() {
            LengthUnit::Inch
        } else {
            LengthUnit::Metric
        }
    }

    /// Where the axis words send the machine, with the work zero at `origin`.
    #[inline]
    pub(crate) fn target(&self, block: &Block, origin: Position) -> Result<Position, Alarm> {
        let mut to = self.position;
        if let Some(word) = block.find(b'X') {
            to.x = within(origin.x + self.scale.radius(&word)?, &word)?;
        } else if let Some(word) = block.find(b'U') {
            to.x = within(to.x + self.scale.radius(&word)?, &word)?;
        }
        if let Some(word) = block.find(b'Z') {
            to.z = within(origin.z + self.scale.length(&word)?, &word)?;
        } else if let Some(word) = block.find(b'W') {
            to.z = within(to.z + self.scale.length(&word)?, &word)?;
        }
        if block.has_any(Letters::of(b"CH")) {
            if let Some(word) = block.find(b'C') {
                to.c = within_turns(origin.c + self.scale.angle(&word)?, &word)?;
            } else if let Some(word) = block.find(b'H') {
                to.c = within_turns(to.c + self.scale.angle(&word)?, &word)?;
            }
        }
        Ok(to)
    }

    /// The end point of a cycle on X and Z and the words to blame for it: nowhere where they are missing.
    pub(crate) fn cycle_end(&self, block: &Block) -> Result<(Position, Span, Span), Alarm> {
        let end = self.target(block, self.origin)?;
        let place = |absolute, increment| {
            block
                .find(absolute)
                .or_else(|| block.find(increment))
                .map_or(Span::default(), |word| word.span)
        };
        Ok((end, place(b'X', b'U'), place(b'Z', b'W')))
    }

    /// F outside threads.
    #[inline]
    pub(crate) fn set_feed(&mut self, word: &Word) -> Result<(), Alarm> {
        self.feed = if self.per_turn {
            ModalFeed::PerTurn(self.scale.feed_per_turn(word)?)
        } else {
            ModalFeed::PerMinute(self.scale.feed(word)?)
        };
        Ok(())
    }

    /// The feed of a cut at `span` whose X goes over `places`; in a dry run the dry-run feed, once there is one to replace.
    /// Under G96 a feed per turn is given with the highest speed on the way, which the measured one does not exceed.
    #[inline]
    pub(crate) fn feed(&self, span: Span, code: i64, places: &[Length]) -> Result<FeedRate, Alarm> {
        let feed = match self.feed {
            ModalFeed::None => {
                let args = [g_arg(code), Arg::None, Arg::None, Arg::None];
                return Err(Alarm::new(Code::FeedMissing, span).with(args));
            }
            ModalFeed::PerMinute(feed) => FeedRate::PerMinute(feed),
            ModalFeed::PerTurn(feed) => FeedRate::PerTurn(feed, self.fastest(places)),
        };
        if self.options.dry_run {
            return Ok(FeedRate::PerMinute(self.params.dry_run_feed()));
        }
        Ok(feed)
    }

    /// The surface speed that the spindle follows: under G96, once there is an S.
    pub(crate) fn law(&self) -> Option<SurfaceSpeed> {
        let speed = self.surface.filter(|_| self.in_surface)?;
        let highest = self.params.spindle_most(self.gear);
        Some(SurfaceSpeed {
            speed,
            centre: self.origin.x,
            least: self.params.surface_min_rpm(),
            most: self.speed_limit.map_or(highest, |limit| limit.min(highest)),
        })
    }

    /// Refuses a speed at `span` with no gear known, or above what the spindle turns at in its gear.
    pub(crate) fn refuse_by_gear(&self, span: Span, speed: u32) -> Result<(), Alarm> {
        if speed == 0 || !self.params.has_gears() {
            return Ok(());
        }
        if self.gear == 0 {
            return Err(Alarm::new(Code::GearUnknown, span));
        }
        let most = self.params.spindle_most(self.gear);
        if speed > most {
            let figures = [speed, most, self.gear.into()].map(|figure| Arg::Int(figure.into()));
            return Err(Alarm::new(Code::SpeedAboveGear, span).with(figures));
        }
        Ok(())
    }

    /// The highest commanded speed at any of `places`.
    #[inline]
    fn fastest(&self, places: &[Length]) -> Rpm {
        if !self.in_surface {
            return self.rpm();
        }
        let Some(law) = self.law() else {
            return Rpm::STOPPED;
        };
        // The place nearest to the axis: the axis itself where the way crosses it.
        let from_axis = |x: &Length| (*x - law.centre).nm();
        let least = places.iter().map(from_axis).min().unwrap_or(0);
        let most = places.iter().map(from_axis).max().unwrap_or(0);
        let nearest = if least > 0 { least } else { most.min(0) };
        law.rpm(law.centre + Length::from_nm(nearest), self.direction)
    }

    /// Commanded spindle speed under G97; S of G50 may limit it.
    pub(crate) fn rpm(&self) -> Rpm {
        let limit = self.speed_limit.filter(|_| self.options.limits_every_speed);
        let speed = limit.map_or(self.speed, |limit| self.speed.min(limit));
        let speed = i32::try_from(speed).unwrap_or(i32::MAX);
        Rpm::new(speed.saturating_mul(self.direction))
    }

    /// P and Q of G75 and G76 as lengths: increments or mm/inch by dialect and 182.7 [D4].
    pub(crate) fn p_or_q(&self, word: &Word, range: Range) -> Result<At<Length>, Alarm> {
        if self.options.dialect == Dialect::Gsk980td && !self.params.pq_in_mm() {
            self.scale.increments(word, range)
        } else {
            self.scale.distance(word, range)
        }
    }
}

/// A coordinate that the machine arithmetic can carry.
#[inline]
fn within(coordinate: Length, word: &Word) -> Result<Length, Alarm> {
    if coordinate.is_in_range() {
        return Ok(coordinate);
    }
    Err(out_of_range(word))
}

/// The same for a rotary axis.
fn within_turns(angle: Angle, word: &Word) -> Result<Angle, Alarm> {
    let limit = Length::INPUT_LIMIT.nm();
    if angle.udeg().unsigned_abs() <= limit.unsigned_abs() {
        return Ok(angle);
    }
    let limit = Arg::Angle(Angle::from_udeg(limit));
    Err(word.alarm(Code::PositionOutOfRange).with([limit]))
}

/// The alarm of a word that leads beyond what the machine arithmetic can carry.
#[cold]
pub(crate) fn out_of_range(word: &Word) -> Alarm {
    let limit = if matches!(word.letter, b'X' | b'U') {
        Arg::Diameter(Diameter::of_radius(Length::INPUT_LIMIT))
    } else {
        Arg::Length(Length::INPUT_LIMIT)
    };
    let args = [limit, Arg::None, Arg::None, Arg::None];
    word.alarm(Code::PositionOutOfRange).with(args)
}
