//! The modal state and what a block does to it: units, coordinate systems, tool offsets, dwell.
//!
//! `tap_mode` handles the blocks that belong to tapping.
//!
//! Power-on: G00 G18 G21 G40 G54 G64 G80 G97 G98, no feed, spindle standing, no shift, no tool offset. G17–G19 matter to
//! arcs alone; G40, G61, G64, G80 and G97 are accepted and change nothing, since nothing they would end exists.

use super::block::{Block, Letters, Word, g_arg};
use super::call::Position;
use super::codes::Group;
use super::groove::GrooveWords;
use super::options::Options;
use super::plan::Plan;
use super::scale::{Scale, seconds};
use super::speeds::ModalFeed;
use super::tap_mode::Tapping;
use super::tap_notes::LengthUnit;
use super::thread::ThreadWords;
use crate::alarm::{Alarm, Arg, Code};
use crate::params::Params;
use crate::units::{Length, Millis};

/// How axis words move (group 01).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Motion {
    /// G00.
    Rapid,
    /// G01.
    Line,
    /// G02.
    Clockwise,
    /// G03.
    CounterClockwise,
}

impl Motion {
    pub(super) const fn code(self) -> i64 {
        match self {
            Self::Rapid => 0,
            Self::Line => 1,
            Self::Clockwise => 2,
            Self::CounterClockwise => 3,
        }
    }
}

/// What a program has set so far.
#[derive(Clone, Debug)]
pub(super) struct State<'p> {
    pub(super) params: &'p Params,
    pub(super) options: Options,
    pub(super) scale: Scale,
    pub(super) motion: Motion,
    /// 17, 18 or 19.
    pub(super) plane: u8,
    /// Index of the work coordinate system: 0 is G54.
    pub(super) system: u8,
    /// Offset number in force, 0 for none.
    offset: u8,
    /// What G50 has added to every coordinate system.
    shift: Position,
    /// Machine coordinates of the work zero in force: coordinate system + G50 + tool offset.
    pub(super) origin: Position,
    /// Where the machine stands after the blocks so far.
    pub(super) position: Position,
    pub(super) per_turn: bool,
    pub(super) feed: ModalFeed,
    pub(super) speed: u32,
    /// −1, 0 or +1.
    pub(super) direction: i32,
    pub(super) speed_limit: Option<u32>,
    pub(super) thread: ThreadWords,
    pub(super) groove: GrooveWords,
    pub(super) tapping: Tapping,
    /// O of the program, if it has one.
    pub(super) program: Option<u32>,
    /// N of the latest block that has one.
    pub(super) sequence: Option<u32>,
    /// M02 or M30 was read.
    pub(super) ended: bool,
    /// A block was read.
    pub(super) started: bool,
}

/// Words that do not depend on the G codes.
const ALWAYS: Letters = Letters::of(b"NOSTF");
/// Words that place an axis.
pub(super) const AXES: Letters = Letters::of(b"XUZWCH");
/// Words that place X or Z.
pub(super) const PLANE_AXES: Letters = Letters::of(b"XUZW");
const MODES: u16 =
    Group::Plane.bit() | Group::Unit.bit() | Group::System.bit() | Group::FeedMode.bit();

impl<'p> State<'p> {
    pub(super) fn new(params: &'p Params, options: Options) -> Self {
        let mut state = Self {
            params,
            options,
            scale: Scale::new(false, params.increment_is_c()),
            motion: Motion::Rapid,
            plane: 18,
            system: 0,
            offset: 0,
            shift: Position::ZERO,
            origin: Position::ZERO,
            position: options.position,
            per_turn: false,
            feed: ModalFeed::None,
            speed: 0,
            direction: 0,
            speed_limit: None,
            thread: ThreadWords::new(),
            groove: GrooveWords::new(),
            tapping: Tapping::new(),
            program: None,
            sequence: None,
            ended: false,
            started: false,
        };
        state.place_origin();
        state
    }

    /// Takes in one block and writes what it does into `plan`. After an alarm the plan means nothing.
    pub(super) fn run(&mut self, block: &Block, plan: &mut Plan) -> Result<(), Alarm> {
        block.check_pairs()?;
        if block.has_any(Letters::of(b"NO")) {
            self.names(block)?;
        }
        self.started = true;
        if block.has_no_lead() {
            return Ok(());
        }
        if self.tapping.concerns(block) {
            self.around_taps(block, plan)?;
        } else {
            let motion_word = self.modal(block, plan)?;
            self.act(block, motion_word, plan)?;
        }
        if block.has_m() {
            self.after_motion(block, plan);
        }
        plan.set_origin(self.origin);
        Ok(())
    }

    /// What a block changes before it does anything: modes, the kind of motion, the tool.
    #[inline]
    pub(super) fn modal(&mut self, block: &Block, plan: &mut Plan) -> Result<Option<Word>, Alarm> {
        if block.has_groups(MODES) {
            self.modes(block);
        }
        let motion_word = block.g(Group::Motion);
        if let Some(word) = motion_word {
            self.motion = match word.value.mantissa() {
                0 => Motion::Rapid,
                1 => Motion::Line,
                2 => Motion::Clockwise,
                _ => Motion::CounterClockwise,
            };
        }
        if let Some(word) = block.find(b'T') {
            self.tool(&word, plan)?;
        }
        Ok(motion_word)
    }

    /// What a block does up to its motion.
    #[inline]
    pub(super) fn act(
        &mut self,
        block: &Block,
        motion_word: Option<Word>,
        plan: &mut Plan,
    ) -> Result<(), Alarm> {
        match block.g(Group::OneShot) {
            None => {
                if let Some(word) = block.find(b'F') {
                    self.set_feed(&word)?;
                }
                if block.has_m() || block.has_any(Letters::of(b"S")) {
                    self.before_motion(block, plan)?;
                }
                self.travel(block, motion_word, Letters::default(), plan)
            }
            Some(word) => self.one_shot(block, &word, motion_word, plan),
        }
    }

    /// N and O.
    fn names(&mut self, block: &Block) -> Result<(), Alarm> {
        const LIMIT: u32 = 99_999_999;
        if let Some(word) = block.find(b'N') {
            self.sequence = Some(word.count(LIMIT)?);
        }
        if let Some(word) = block.find(b'O') {
            let number = word.count(LIMIT)?;
            if self.started {
                let args = [Arg::Int(i64::from(number)), Arg::None, Arg::None, Arg::None];
                return Err(word.alarm(Code::SecondProgram).with(args));
            }
            self.program = Some(number);
        }
        Ok(())
    }

    /// G20 or G21.
    pub(super) const fn length_unit(&self) -> LengthUnit {
        if self.scale.is_inch() {
            LengthUnit::Inch
        } else {
            LengthUnit::Metric
        }
    }

    /// G17–G21, G54–G59, G98, G99.
    fn modes(&mut self, block: &Block) {
        if let Some(word) = block.g(Group::Plane) {
            self.plane = word.value.mantissa() as u8;
        }
        if let Some(word) = block.g(Group::Unit) {
            self.scale = Scale::new(word.value.mantissa() == 20, self.params.increment_is_c());
        }
        if let Some(word) = block.g(Group::System) {
            self.system = word.value.mantissa().saturating_sub(54) as u8;
            self.place_origin();
        }
        if let Some(word) = block.g(Group::FeedMode) {
            let per_turn = word.value.mantissa() == 99;
            if per_turn != self.per_turn {
                // A feed in millimetres a minute must not be read as millimetres a turn.
                self.per_turn = per_turn;
                self.feed = ModalFeed::None;
                self.tapping.forget_feed();
            }
        }
    }

    fn place_origin(&mut self) {
        let [x, z] = self.params.work_offset(self.system);
        let [tool_x, tool_z] = match self.offset {
            0 => [Length::ZERO; 2],
            number => self.params.tool_offset(number),
        };
        self.origin = Position {
            x: x + self.shift.x + tool_x,
            z: z + self.shift.z + tool_z,
            c: self.shift.c,
        };
    }

    /// `Txxyy`: tool xx with offset yy.
    fn tool(&mut self, word: &Word, plan: &mut Plan) -> Result<(), Alarm> {
        const OFFSETS: u32 = 32;
        let number = word.count(9999)?;
        let offset = number % 100;
        if offset > OFFSETS {
            let args = [
                Arg::Int(i64::from(offset)),
                Arg::Int(i64::from(OFFSETS)),
                Arg::None,
                Arg::None,
            ];
            return Err(word.alarm(Code::ToolOffset).with(args));
        }
        self.offset = offset as u8;
        self.place_origin();
        plan.tool(word.span, number as u16);
        Ok(())
    }

    /// The codes that hold for their own block.
    fn one_shot(
        &mut self,
        block: &Block,
        word: &Word,
        motion_word: Option<Word>,
        plan: &mut Plan,
    ) -> Result<(), Alarm> {
        let code = word.value.mantissa();
        if code == 30 {
            return self.tap_return(block, word, plan);
        }
        if let Some(other) = motion_word {
            let harmless = match code {
                4 => block.has_any(Letters::of(b"P")),
                53 => self.motion == Motion::Rapid,
                _ => false,
            };
            if block.has_any(AXES) && !harmless {
                let later = if other.span.column > word.span.column {
                    &other
                } else {
                    word
                };
                let args = [
                    g_arg(other.value.mantissa()),
                    g_arg(code),
                    Arg::None,
                    Arg::None,
                ];
                return Err(later.alarm(Code::AxisWordsTwice).with(args));
            }
        }
        let is_thread = matches!(code, 76 | 78);
        if !is_thread && let Some(word) = block.find(b'F') {
            self.set_feed(&word)?;
        }
        let sets_limit = code == 50 && !block.has_any(PLANE_AXES);
        if !sets_limit {
            self.before_motion(block, plan)?;
        }
        match code {
            4 => self.dwell(block, word, motion_word, plan),
            50 => {
                if sets_limit {
                    self.limit_speed(block, plan)?;
                    self.before_motion_codes(block, plan, None);
                }
                self.set_coordinates(block, word)
            }
            53 => self.machine_coordinates(block, word, plan),
            75 => self.groove(block, word, plan),
            76 => self.thread_g76(block, word, plan),
            78 => self.thread_g78(block, word, plan),
            // A code of this group needs an arm of its own.
            _ => Err(word.alarm(Code::GNotAvailable).with([
                g_arg(code),
                Arg::None,
                Arg::None,
                Arg::None,
            ])),
        }
    }

    /// Refuses the leftmost word that nothing in the block uses.
    #[inline]
    pub(super) fn only(&self, block: &Block, used: Letters) -> Result<(), Alarm> {
        let unused = block.letters().without(used.and(ALWAYS));
        if unused.is_empty() {
            return Ok(());
        }
        Err(match block.leftmost(unused) {
            Some(word) => word.alarm(Code::WordWithoutUse),
            None => Alarm::new(Code::WordWithoutUse, block.lead()),
        })
    }

    fn dwell(
        &mut self,
        block: &Block,
        word: &Word,
        motion_word: Option<Word>,
        plan: &mut Plan,
    ) -> Result<(), Alarm> {
        const LIMIT: u32 = 99_999_999;
        let by_axis = block.find(b'X').or_else(|| block.find(b'U'));
        match (block.find(b'P'), by_axis) {
            (Some(time), axis) => {
                if let (Some(axis), None) = (axis, motion_word) {
                    return Err(axis.alarm(Code::DwellTwice));
                }
                plan.dwell(word.span, Millis::new(time.count(LIMIT)?));
                let time = Letters::of(b"P");
                if motion_word.is_some() {
                    return self.travel(block, motion_word, time, plan);
                }
                self.only(block, time)
            }
            (None, Some(time)) => {
                self.only(block, Letters::of(b"XU"))?;
                plan.dwell(word.span, seconds(&time)?);
                Ok(())
            }
            (None, None) => Err(needs_words(word)),
        }
    }

    /// G50 X Z: the tool stands at these coordinates from now on; U W H move the zero by as much the other way.
    fn set_coordinates(&mut self, block: &Block, word: &Word) -> Result<(), Alarm> {
        if !block.has_any(AXES) && !block.has_any(Letters::of(b"S")) {
            return Err(needs_words(word));
        }
        self.only(block, AXES)?;
        let wanted = self.target(block, self.origin)?;
        // `wanted` is where the words would send the machine; the zero moves instead.
        self.shift.x += self.position.x - wanted.x;
        self.shift.z += self.position.z - wanted.z;
        self.shift.c += self.position.c - wanted.c;
        self.place_origin();
        let zero = self.origin;
        if !zero.x.is_in_range() || !zero.z.is_in_range() {
            let args = [
                Arg::Length(Length::INPUT_LIMIT),
                Arg::None,
                Arg::None,
                Arg::None,
            ];
            return Err(word.alarm(Code::PositionOutOfRange).with(args));
        }
        Ok(())
    }
}

/// The alarm of a code that says nothing without words.
#[cold]
pub(super) fn needs_words(word: &Word) -> Alarm {
    let args = [
        g_arg(word.value.mantissa()),
        Arg::None,
        Arg::None,
        Arg::None,
    ];
    word.alarm(Code::CodeNeedsWords).with(args)
}
