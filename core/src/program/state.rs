//! What a block does: modes, coordinate systems, tool offsets, dwell, and which cycle reads its words.
//!
//! Power-on: G00 G18 G21 G40 G54 G64 G80 G97 G98, no feed, spindle standing, no shift, no tool offset. G17–G19 matter to
//! arcs alone; G40 and G80 are accepted and change nothing, since nothing they would end exists.

use crate::alarm::{Alarm, Arg, Code, Span};
use crate::call::{SurfaceSpeed, TapAxis};
use crate::cycle::{
    GrooveWords, Stroked, TapPart, Tapping, ThreadWords, Turning, TurningWords, TwoBlock,
    is_tap_return, orientation,
};
use crate::params::Params;
use crate::text::{
    AXES, Block, Group, Letters, MGroup, Modal, ModalFeed, Options, PLANE_AXES, Plan, Scale, Word,
    g_arg, seconds,
};
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
    /// G90, G94.
    Turning(Turning),
    /// G92.
    Thread,
    /// G32.
    Stroke,
    /// G34.
    VariableStroke,
}

impl Motion {
    pub(super) const fn code(self) -> i64 {
        match self {
            Self::Rapid => 0,
            Self::Line => 1,
            Self::Clockwise => 2,
            Self::CounterClockwise => 3,
            Self::Turning(cycle) => cycle.code(),
            Self::Thread => 92,
            Self::Stroke => 32,
            Self::VariableStroke => 34,
        }
    }

    /// F of its blocks is the lead of a thread.
    pub(super) const fn cuts_thread(self) -> bool {
        matches!(self, Self::Thread | Self::Stroke | Self::VariableStroke)
    }
}

/// What a program has set so far.
#[derive(Clone, Debug)]
pub(super) struct State<'p> {
    pub(super) modal: Modal<'p>,
    pub(super) motion: Motion,
    /// The surface speed and the sense that the spindle was told last.
    pub(super) told: Option<(SurfaceSpeed, i32)>,
    pub(super) thread: ThreadWords,
    pub(super) groove: GrooveWords,
    pub(super) turning: TurningWords,
    pub(super) tapping: Tapping,
    /// The latest motion, where it is a stroke of G32 or G34.
    pub(super) stroked: Option<Stroked>,
    /// G61.
    pub(super) exact_stop: bool,
    /// O of the program, if it has one.
    pub(super) program: Option<u32>,
    /// N of the latest block that has one.
    pub(super) sequence: Option<u32>,
    /// The latest M word.
    pub(super) m: Option<u16>,
    /// How often the program has written offsets, and where it did so last.
    pub(super) offsets_written: (u32, Span),
    /// M02 or M30 was read.
    pub(super) ended: bool,
    /// A block was read.
    pub(super) started: bool,
}

const MODES: u16 =
    Group::Plane.bit() | Group::Unit.bit() | Group::System.bit() | Group::FeedMode.bit();

impl<'p> State<'p> {
    pub(super) fn new(params: &'p Params, options: Options) -> Self {
        Self {
            modal: Modal::new(params, options),
            motion: Motion::Rapid,
            told: None,
            thread: ThreadWords::new(),
            groove: GrooveWords::new(),
            turning: TurningWords::default(),
            tapping: Tapping::new(),
            stroked: None,
            exact_stop: false,
            program: None,
            sequence: None,
            m: None,
            offsets_written: (0, Span::default()),
            ended: false,
            started: false,
        }
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
        if block.has_groups(Group::Path.bit()) {
            self.path_mode(block, plan);
        }
        if let Some(stroked) = &mut self.stroked {
            stroked.then(block);
        }
        let from = self.modal.position.x;
        if self.tapping.concerns(block) {
            self.around_taps(block, plan)?;
        } else {
            let motion_word = self.set_modes(block, plan)?;
            self.act(block, motion_word, plan)?;
        }
        if block.has_m() {
            self.after_motion(block, plan);
            self.m = block
                .last_m()
                .and_then(|word| u16::try_from(word.value.mantissa()).ok());
        }
        if self.modal.in_surface {
            self.follow_surface(block, from, plan);
        }
        if self.modal.direction != 0 {
            self.refuse_by_gear(block)?;
        }
        plan.set_origin(self.modal.origin);
        Ok(())
    }

    /// What a block changes before it does anything: modes, the kind of motion, the tool.
    #[inline]
    fn set_modes(&mut self, block: &Block, plan: &mut Plan) -> Result<Option<Word>, Alarm> {
        if block.has_groups(MODES) {
            self.modes(block);
        }
        if let Some(word) = block.g(Group::SpeedMode) {
            self.speed_mode(block, &word, plan)?;
        }
        let motion_word = block.g(Group::Motion);
        if let Some(word) = motion_word {
            self.begin_motion(match word.value.mantissa() {
                0 => Motion::Rapid,
                1 => Motion::Line,
                2 => Motion::Clockwise,
                90 => Motion::Turning(Turning::Along),
                92 => Motion::Thread,
                32 => Motion::Stroke,
                34 => Motion::VariableStroke,
                94 => Motion::Turning(Turning::Across),
                _ => Motion::CounterClockwise,
            });
        }
        if let Some(word) = block.find(b'T') {
            self.tool(&word, plan)?;
        }
        Ok(motion_word)
    }

    /// A kind of motion is in force from now on. A cycle keeps its words as long as it is.
    fn begin_motion(&mut self, motion: Motion) {
        if motion == self.motion {
            return;
        }
        match motion {
            Motion::Turning(_) => self.turning = TurningWords::default(),
            Motion::Thread => self.thread.begin_single(),
            Motion::VariableStroke => self.thread.begin_variable(),
            _ => {}
        }
        self.motion = motion;
    }

    /// A block in rigid mode or with a cycle in force, and one with G80, G84, G88, the rigid M code or an M code without a
    /// meaning of its own.
    #[inline(never)]
    fn around_taps(&mut self, block: &Block, plan: &mut Plan) -> Result<(), Alarm> {
        let part = self.tapping.begin(&mut self.modal, block, plan)?;
        let motion_word = self.set_modes(block, plan)?;
        match part {
            TapPart::Return(word) => {
                self.tapping
                    .tap_return(&mut self.modal, block, &word, plan)?;
                self.before_motion_codes(block, plan, None);
                return Ok(());
            }
            TapPart::Cycle(word, rigid) => {
                self.refuse_surface(word.as_ref().map_or(block.lead(), |word| word.span))?;
                if rigid {
                    self.before_motion_codes(block, plan, None);
                } else {
                    // The spindle is in speed mode, and S is its own.
                    self.before_motion(block, plan)?;
                }
                self.tapping
                    .tap(&mut self.modal, block, word.as_ref(), plan)?;
            }
            TapPart::RigidCode => {
                self.refuse_surface(block.lead())?;
                block.only(Letters::default())?;
                self.before_motion_codes(block, plan, None);
            }
            TapPart::Other => self.act(block, motion_word, plan)?,
        }
        self.tapping.end(&mut self.modal, block, plan)
    }

    /// What a block does up to its motion.
    #[inline]
    fn act(
        &mut self,
        block: &Block,
        motion_word: Option<Word>,
        plan: &mut Plan,
    ) -> Result<(), Alarm> {
        match block.g(Group::OneShot) {
            None => {
                // F of a thread is its lead.
                if !self.motion.cuts_thread()
                    && let Some(word) = block.find(b'F')
                {
                    self.modal.set_feed(&word)?;
                }
                if block.has_m() || block.has_any(Letters::of(b"S")) {
                    self.before_motion(block, plan)?;
                }
                if block.has_m() && orientation(block, self.modal.params).is_some() {
                    return block.only(Letters::of(b"R"));
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

    /// G17–G21, G54–G59, G98, G99.
    fn modes(&mut self, block: &Block) {
        if let Some(word) = block.g(Group::Plane) {
            self.modal.plane = word.value.mantissa() as u8;
        }
        if let Some(word) = block.g(Group::Unit) {
            self.modal.scale = Scale::new(
                word.value.mantissa() == 20,
                self.modal.params.increment_is_c(),
            );
        }
        if let Some(word) = block.g(Group::System) {
            self.modal.system = word.value.mantissa().saturating_sub(54) as u8;
            self.modal.place_origin();
        }
        if let Some(word) = block.g(Group::FeedMode) {
            let per_turn = word.value.mantissa() == 99;
            if per_turn != self.modal.per_turn {
                // A feed in millimetres a minute must not be read as millimetres a turn.
                self.modal.per_turn = per_turn;
                self.modal.feed = ModalFeed::None;
                self.tapping.forget_feed();
            }
        }
    }

    /// G61 and G64.
    fn path_mode(&mut self, block: &Block, plan: &mut Plan) {
        if let Some(word) = block.g(Group::Path) {
            let exact = word.value.mantissa() == 61;
            if exact != self.exact_stop {
                self.exact_stop = exact;
                plan.exact_stop(word.span, exact);
            }
        }
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
        let station = number / 100;
        let params = self.modal.params;
        if params.tool_changer() == 2 && station > u32::from(params.turret_stations()) {
            let figures = [station, params.turret_stations().into()];
            let figures = figures.map(|figure| Arg::Int(figure.into()));
            return Err(word.alarm(Code::StationMissing).with(figures));
        }
        self.modal.offset = offset as u8;
        self.modal.place_origin();
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
        // A dwell moves nothing.
        if code != 4 {
            self.stroked = None;
        }
        if code == 30 && is_tap_return(block) {
            self.tapping
                .tap_return(&mut self.modal, block, word, plan)?;
            self.before_motion_codes(block, plan, None);
            return Ok(());
        }
        if let Some(other) = motion_word {
            let harmless = match code {
                4 => block.has_any(Letters::of(b"P")),
                28 | 30 | 53 => self.motion == Motion::Rapid,
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
        if is_thread {
            self.refuse_surface(word.span)?;
        }
        if !is_thread && let Some(word) = block.find(b'F') {
            self.modal.set_feed(&word)?;
        }
        let sets_limit =
            code == 50 && (self.modal.options.limits_every_speed || !block.has_any(PLANE_AXES));
        if !sets_limit {
            self.before_motion(block, plan)?;
            if code == 50 {
                tell_ordinary_speed(block, plan);
            }
        }
        match code {
            4 => self.dwell(block, word, motion_word, plan),
            10 => self.write_offsets(block, word),
            50 => {
                if sets_limit {
                    self.limit_speed(block, plan)?;
                    self.before_motion_codes(block, plan, None);
                }
                self.set_coordinates(block, word)
            }
            28 | 30 => self.reference_point(block, word, plan),
            53 => self.machine_coordinates(block, word, plan),
            74 => self.groove.read(TapAxis::Z, &self.modal, block, word, plan),
            75 => self.groove.read(TapAxis::X, &self.modal, block, word, plan),
            76 => self
                .thread
                .read(TwoBlock::G76, &self.modal, block, word, plan),
            78 => self
                .thread
                .read(TwoBlock::G78, &self.modal, block, word, plan),
            // A code of this group needs an arm of its own.
            _ => Err(word.alarm(Code::GNotAvailable).with([
                g_arg(code),
                Arg::None,
                Arg::None,
                Arg::None,
            ])),
        }
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
                block.only(time)
            }
            (None, Some(time)) => {
                block.only(Letters::of(b"XU"))?;
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
        block.only(AXES)?;
        let wanted = self.modal.target(block, self.modal.origin)?;
        // `wanted` is where the words would send the machine; the zero moves instead.
        self.modal.shift.x += self.modal.position.x - wanted.x;
        self.modal.shift.z += self.modal.position.z - wanted.z;
        self.modal.shift.c += self.modal.position.c - wanted.c;
        self.modal.place_origin();
        let zero = self.modal.origin;
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

/// Warns of S beside the coordinates of G50 where nothing says that it is meant as a speed [D441].
fn tell_ordinary_speed(block: &Block, plan: &mut Plan) {
    let turns = |word: Word| word.value.mantissa() != 5;
    if let Some(speed) = block.find(b'S')
        && !block.m(MGroup::Spindle).is_some_and(turns)
    {
        plan.warn(speed.alarm(Code::SpeedNoLimit));
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
