//! Program text in, events of the core out: macros, jumps and calls are carried out on the way.
//!
//! A line in which nothing has to be calculated goes to [`Interpreter::line`] as it is, with the same events and alarms. A
//! block with expressions goes there as words, each with its place in the text. This module knows which increment a word
//! has; it must not know files.

mod angle;
#[cfg(test)]
mod contour_tests;
mod drill;
mod glimpse;
mod pointless;
#[cfg(test)]
mod published;
mod rigid;
mod system;
mod tap_level;
#[cfg(test)]
mod tests;

use std::collections::VecDeque;

use leadscrew_core::alarm::{Alarm, Code, Span};
use leadscrew_core::call::{Aux, Call, CallKind, Position};
use leadscrew_core::params::Params;
use leadscrew_core::program::{Carried, Dialect, Event, Interpreter, Options, Way};
use leadscrew_core::units::{Decimal, StartAngle};

use crate::dialect::{Control, Setting, code_of, has_code};
use crate::drilling::{Drill, Kind};
use crate::flow::{Done, Flow, Machine, Modes, Rules, Trouble};
use crate::heading::Allowed;
use crate::lines::Source;
use crate::nose::Side;
use crate::path::Path;
use crate::plane::{Element, Point, Shape};
use crate::roughing::{Collected, Cycle, FirstLines, Unit};
use crate::stock::Stock;
use crate::variables::{Kept, Variables};
use crate::whose::Whose;
use crate::word::Word;
use glimpse::{blanked, codes, letters, place_of, place_of_code};

/// A program being read.
#[derive(Debug)]
pub struct Reader<'p, S> {
    flow: Flow<S>,
    core: Core<'p>,
}

/// The core's side of a reader.
#[derive(Debug)]
struct Core<'p> {
    interpreter: Interpreter<'p>,
    params: &'p Params,
    control: Control,
    /// The stock that the program declares.
    stock: Option<Stock>,
    /// T of the latest block that has one.
    tool: Option<u16>,
    /// How often offsets had been written when the nose was read.
    writes: u32,
    /// What the first lines of the contour cycles have said.
    first: FirstLines,
    /// The contour that is being read. For all cycles but G70 the interpreter is then a copy, whose moves are collected;
    /// the program's own one waits here.
    contour: Option<(Collected, Option<Interpreter<'p>>)>,
    /// The drilling cycle in force, and where the tool was before its first hole.
    drill: Option<(Drill, Position)>,
    /// The latest drilling cycle, in force or over, and its G word.
    drilled: Option<(Kind, Span)>,
    /// A line that is given by its angle and ends where the next one says.
    open_line: Option<angle::Open>,
    /// Corners and the round nose.
    path: Path,
    /// Events of the core that go through the path.
    events: VecDeque<Event>,
}

impl<'p, S: Source> Reader<'p, S> {
    /// Before the first line. `rules.skip` is that of the options.
    #[must_use]
    pub fn new(source: S, params: &'p Params, options: Options, kept: Kept, rules: Rules) -> Self {
        let rules = Rules {
            skip: options.skip,
            ..rules
        };
        let control = rules.control;
        let options = Options {
            dialect: control.family(),
            per_turn: control.begins_per_turn(),
            limits_every_speed: control.limits_every_speed(),
            ..options
        };
        Self {
            flow: Flow::new(source, kept, rules),
            core: Core {
                interpreter: Interpreter::new(params, options),
                params,
                control,
                stock: rules.stock,
                tool: None,
                writes: 0,
                first: FirstLines::new(control),
                contour: None,
                drill: None,
                drilled: None,
                open_line: None,
                path: Path::new(),
                events: VecDeque::new(),
            },
        }
    }

    /// Carries out the next line, or the next block of one, and hands what it yields to `out`.
    ///
    /// # Errors
    /// What ends the program; there is no further step.
    pub fn step(&mut self, out: &mut dyn FnMut(Event)) -> Result<(), Trouble> {
        let control = self.flow.control();
        self.core.read_as(control);
        let out = &mut |event| {
            out(match event {
                Event::Warning(warning) => Event::Warning(control.in_own_codes(warning)),
                call => call,
            });
        };
        let mut acting = Acting {
            core: &mut self.core,
            modes: Modes::default(),
            out,
        };
        let mut result = self.flow.step(&mut acting);
        if self.flow.is_over() {
            // Also where the step has failed.
            let _ = acting.release();
            // What was held before an alarm is right as far as it goes.
            let finished = self.core.path.finish();
            while let Some(event) = self.core.path.next() {
                out(event);
            }
            if result.is_ok() {
                result = finished.map_err(Trouble::Alarm);
            }
        }
        result.map_err(|trouble| match trouble {
            Trouble::Alarm(alarm) => Trouble::Alarm(control.in_own_codes(alarm)),
            unreadable => unreadable,
        })
    }

    /// True where nothing more comes.
    #[must_use]
    pub const fn is_over(&self) -> bool {
        self.flow.is_over()
    }

    /// The line of the latest step.
    #[must_use]
    pub const fn line(&self) -> u32 {
        self.flow.line()
    }

    /// The next block begins something of its own: it is in the main program, not in a contour, a cycle of holes or a path
    /// that a corner or the nose makes of several blocks.
    #[must_use]
    pub fn is_between_parts(&self) -> bool {
        let core = &self.core;
        !self.flow.is_in_call()
            && core.contour.is_none()
            && core.drill.is_none()
            && core.open_line.is_none()
            && core.path.is_idle()
            && !core.interpreter.in_force().taps
    }

    /// The latest T.
    #[must_use]
    pub const fn tool(&self) -> Option<u16> {
        self.core.tool
    }

    /// The pass of the main program, from 1.
    #[must_use]
    pub const fn pass(&self) -> u32 {
        self.flow.pass()
    }

    /// The text of the line of the latest step.
    ///
    /// # Errors
    /// The text cannot be read again.
    pub fn text(&mut self) -> std::io::Result<&[u8]> {
        self.flow.line_text()
    }

    /// Puts in force what the text before has left, before the first step.
    pub fn carry(&mut self, carried: &Carried) {
        self.core.interpreter.carry(carried);
        self.flow.carry(Modes {
            incremental: carried.incremental,
            without_run_out: carried.without_run_out,
            ..Modes::default()
        });
    }

    /// What the blocks so far leave in force for the next text.
    #[must_use]
    pub fn carried(&self) -> Carried {
        Carried {
            incremental: self.flow.modes().incremental,
            ..self.core.interpreter.carried()
        }
    }

    /// True for a call of the last step, with this place in the text, whose thread stands in one block: it is a G76, and
    /// not the G78 that it was turned into [D226].
    #[must_use]
    pub fn is_in_one_block(&self, place: Span) -> bool {
        self.flow.one_block() == Some(place)
    }

    /// The interpreter, for what it knows of the program.
    #[must_use]
    pub const fn interpreter(&self) -> &Interpreter<'p> {
        &self.core.interpreter
    }

    /// The drilling cycle that a call of the last step, with this place in the text, is a move of.
    #[must_use]
    pub fn drilling(&self, place: Span) -> Option<Kind> {
        let (kind, word) = self.core.drilled?;
        (word == place).then_some(kind)
    }

    /// The numbers that a subprogram's file silences; none of those of the program's own file.
    #[must_use]
    pub fn allowed(&self, file: Whose) -> Allowed {
        self.flow.allowed(file)
    }

    /// The variables, of which the kept ones are to be stored.
    #[must_use]
    pub const fn variables(&self) -> &Variables {
        self.flow.variables()
    }
}

impl Core<'_> {
    /// The next block is one of this control.
    const fn read_as(&mut self, control: Control) {
        self.control = control;
        self.first.read_as(control);
        self.interpreter.read_as(control.family());
    }

    /// T of a block.
    fn call_tool(&mut self, number: u16) {
        self.tool = Some(number);
        self.path.tool(number, self.interpreter.offsets());
    }

    /// After G10: the nose is that of the table as it is now. A contour is read before it is cut, several times, and writes
    /// nothing.
    fn follow_offsets(&mut self) -> Result<(), Alarm> {
        let (writes, span) = self.interpreter.offsets_writes();
        if writes == self.writes {
            return Ok(());
        }
        if matches!(self.contour, Some((_, Some(_)))) {
            return Err(Alarm::new(Code::ContourWord, span).word(b'G'));
        }
        self.writes = writes;
        if let Some(number) = self.tool {
            self.path.tool(number, self.interpreter.offsets());
        }
        Ok(())
    }

    /// Decimals to which a value of this letter's word is rounded, in inches or millimetres.
    fn decimals(&self, letter: u8, inch: bool) -> u8 {
        let angle = 3 + u8::from(self.params.increment_is_c());
        let length = angle + u8::from(inch);
        match letter {
            b'X' | b'Z' | b'U' | b'W' | b'I' | b'J' | b'K' | b'R' | b'D' | b'E' => length,
            b'C' | b'H' => angle,
            b'F' => 6 - u8::from(inch),
            b'P' | b'Q' if !self.counts() => length,
            _ => 0,
        }
    }

    /// A number without a point counts increments. On a GSK 980TD it does not, whatever the parameter.
    fn counts_increments(&self) -> bool {
        self.control != Control::Gsk980td && !self.params.whole_units()
    }

    /// P and Q of G74 to G76 count increments.
    fn counts(&self) -> bool {
        self.control.family() == Dialect::Gsk980td && !self.params.pq_in_mm()
    }

    /// Decimals of one increment where macro A has counted it.
    fn increment(&self, letter: u8, inch: bool) -> u8 {
        match letter {
            b'F' if self.interpreter.in_force().per_turn => 4,
            b'F' => 0,
            _ => self.decimals(letter, inch),
        }
    }

    /// The words of a block for the interpreter. A word without a value is not there.
    fn numbers<'w>(
        &'w self,
        words: &'w [Word],
    ) -> impl Iterator<Item = (u8, Decimal, Span)> + use<'w> {
        let has = |code| has_code(words, code);
        let dwell = has(4);
        let offsets = has(10);
        let enhanced = has(78);
        let inch = has(20) || (self.interpreter.is_inch() && !has(21));
        words.iter().filter_map(move |word| {
            let (decimals, step) = match word.letter {
                // Milliseconds, and seconds.
                b'P' if dwell => (0, 0),
                // Numbers of offsets and of a tip.
                b'P' | b'Q' if offsets => (0, 0),
                b'X' | b'U' if dwell => (3, 3),
                // Lengths, whatever P and Q of the other cycles are.
                b'P' | b'Q' if enhanced => (self.decimals(b'X', inch), self.increment(b'X', inch)),
                letter => (self.decimals(letter, inch), self.increment(letter, inch)),
            };
            Some((word.letter, word.decimal(decimals, step)?, word.span))
        })
    }

    /// The unit of lengths that is in force.
    fn unit(&self) -> Unit {
        let (inch, fine) = (self.interpreter.is_inch(), self.params.increment_is_c());
        Unit {
            decimals: 3 + u8::from(inch) + u8::from(fine),
            step_nm: match (inch, fine) {
                (false, false) => 1_000,
                (false, true) => 100,
                (true, false) => 2_540,
                (true, true) => 254,
            },
        }
    }
}

/// A core that carries out one step.
struct Acting<'a, 'p> {
    core: &'a mut Core<'p>,
    /// What the flow has in force.
    modes: Modes,
    out: &'a mut dyn FnMut(Event),
}

impl Acting<'_, '_> {
    /// Does something with the interpreter, and tells what came of it.
    fn act(
        &mut self,
        action: impl FnOnce(&mut Core<'_>, &mut dyn FnMut(Event)) -> Result<(), Alarm>,
    ) -> Result<Done, Alarm> {
        let mut contour = self.core.contour.take();
        let collected = match &mut contour {
            Some((collected, Some(_))) => Some(collected),
            _ => None,
        };
        self.core.path.begin(self.core.interpreter.position());
        let result = if self.core.path.is_idle() {
            self.act_at_once(action, collected)
        } else {
            let mut events = std::mem::take(&mut self.core.events);
            let acted = action(self.core, &mut |event| events.push_back(event));
            // What came before an alarm of the core was right. The motion that a corner asks for may be missing then.
            let result = self.along_path(&mut events, collected, acted.is_ok());
            events.clear();
            self.core.events = events;
            result.and_then(|moved| acted.map(|()| moved))
        };
        self.core.contour = contour;
        let moved = result?;
        self.core.follow_offsets()?;
        Ok(Done {
            moved,
            ended: self.core.interpreter.is_ended(),
        })
    }

    /// With no corner and no nose on the way: hands each event on as it comes. True where an axis moves.
    fn act_at_once(
        &mut self,
        action: impl FnOnce(&mut Core<'_>, &mut dyn FnMut(Event)) -> Result<(), Alarm>,
        collected: Option<&mut Collected>,
    ) -> Result<bool, Alarm> {
        if let Some(collected) = collected {
            return action(self.core, &mut |event| {
                if let Event::Call(call) = &event {
                    collect(collected, call);
                }
            })
            .map(|()| false);
        }
        let (mut moved, mut tool) = (false, None);
        let out = &mut *self.out;
        let result = action(self.core, &mut |event| {
            if let Event::Call(call) = &event {
                moved |= moves(call);
                if let CallKind::Aux(Aux::T(number)) = call.kind {
                    tool = Some(number);
                }
            }
            out(event);
        });
        if let Some(number) = tool {
            self.core.call_tool(number);
        }
        result.map(|()| moved)
    }

    /// Takes the events of a block through corners and nose; `whole`: they are all of it. True where an axis moves.
    fn along_path(
        &mut self,
        events: &mut VecDeque<Event>,
        mut collected: Option<&mut Collected>,
        whole: bool,
    ) -> Result<bool, Alarm> {
        let mut moved = false;
        let in_cycle = matches!(
            self.core.interpreter.in_force().motion,
            32 | 34 | 90 | 92 | 94
        );
        for event in events.drain(..) {
            let mut tool = None;
            if let (None, Event::Call(call)) = (&collected, &event) {
                moved |= moves(call);
                // A stroke comes out when the block after it is read.
                let in_cycle = in_cycle
                    || matches!(&call.kind, CallKind::Thread(thread) if thread.cycle.is_stroke());
                if in_cycle && moves(call) && self.core.path.side() != Side::None {
                    return Err(Alarm::new(Code::NoseInCycle, call.span));
                }
                if let CallKind::Aux(Aux::T(number)) = call.kind {
                    tool = Some(number);
                }
            }
            let collected = &mut collected;
            self.core.path.shape(
                event,
                &mut |path, event, how| match (collected.as_mut(), &event) {
                    (Some(collected), Event::Call(call)) => {
                        collect(collected, call);
                        Ok(())
                    }
                    (Some(_), Event::Warning(_)) => Ok(()),
                    (None, _) => path.compensate(event, how),
                },
            )?;
            if let Some(number) = tool {
                self.core.call_tool(number);
            }
        }
        if whole {
            self.core.path.end_block()?;
        }
        while let Some(event) = self.core.path.next() {
            (self.out)(event);
        }
        Ok(moved)
    }

    /// Carries out a block that goes to a place of the machine with the nose not compensated.
    fn without_nose(
        &mut self,
        goes_home: bool,
        action: impl FnOnce(&mut Self) -> Result<Done, Alarm>,
    ) -> Result<Done, Alarm> {
        self.core.path.suspend(goes_home);
        let done = action(self);
        self.core.path.suspend(false);
        done
    }
}

/// The start angle of a thread in one block; `None` where it is not written.
fn first_angle(words: &[Word]) -> Result<Option<StartAngle>, Alarm> {
    let word = words.iter().find(|word| word.letter == Word::START_ANGLE);
    let angle = word
        .filter(|word| !word.value().is_null())
        .map(|word| word.count(0, StartAngle::FULL));
    Ok(angle.transpose()?.map(StartAngle::from_mdeg))
}

/// True for the codes that take the tool to a place of the machine: G28, G30, G53.
const fn goes_home(code: i64) -> bool {
    matches!(code, 28 | 30 | 53)
}

/// True for the codes that have no place in a contour: the roughing would leave out what they do, or take it for the
/// contour.
const fn is_no_motion(code: i64) -> bool {
    matches!(
        code,
        20 | 21 | 28 | 30 | 32 | 34 | 50 | 53 | 74..=76 | 78 | 84 | 88 | 90 | 92 | 94
    )
}

/// Adds a call of a contour's block to the contour.
fn collect(collected: &mut Collected, call: &Call) {
    let (to, shape) = match &call.kind {
        CallKind::Rapid(to) => (*to, Shape::Rapid),
        CallKind::Line(to, _) => (*to, Shape::Line),
        CallKind::Arc(arc) => (
            arc.end,
            Shape::Arc {
                i: arc.i,
                k: arc.k,
                clockwise: arc.clockwise,
            },
        ),
        _ => return,
    };
    collected.push(Element {
        end: Point { x: to.x, z: to.z },
        shape,
        span: call.span,
    });
}

/// True for a call that moves an axis.
const fn moves(call: &Call) -> bool {
    !matches!(
        call.kind,
        CallKind::Dwell(_)
            | CallKind::Spindle(_)
            | CallKind::Aux(_)
            | CallKind::End(_)
            | CallKind::Over
            | CallKind::LineOver
    )
}

impl Acting<'_, '_> {
    /// Takes the words out of a block that are not the core's. `None` where there are none.
    fn take_words(&mut self, words: &[Word]) -> Result<Option<Vec<Word>>, Alarm> {
        if !words.iter().any(crate::path::is_word) {
            return Ok(None);
        }
        let core = &mut *self.core;
        let called = words.iter().find(|word| word.letter == b'T');
        let called = called.and_then(|word| u16::try_from(word.value().whole()?).ok());
        let offset = called.or(core.tool).unwrap_or(0);
        let acts = !matches!(core.contour, Some((_, Some(_))));
        let unit = core.unit();
        let taken = core
            .path
            .take(words, unit, acts, offset, core.interpreter.offsets())?;
        if let Some(warning) = taken.warning {
            (self.out)(warning);
        }
        Ok(Some(taken.words))
    }

    /// Carries out the words of a block that is none of a drilling cycle.
    fn plain_words(&mut self, line: u32, words: &[Word]) -> Result<Done, Alarm> {
        let without_tool: Vec<Word>;
        let mut words = words;
        if let Some((collected, own)) = &mut self.core.contour {
            let is_straight = |word: &Word| matches!(code_of(word), Some(0 | 1));
            let letters = words.iter().map(|word| word.letter);
            let span = words.first().map_or(Span::default(), |word| word.span);
            collected.block(letters, words.iter().any(is_straight), span)?;
            let is_stray = |word: &&Word| code_of(word).is_some_and(is_no_motion);
            let turns = |word: &&Word| matches!(word.letter, b'C' | b'H');
            if let Some(word) = words.iter().find(|word| is_stray(word) || turns(word)) {
                return Err(word.alarm(Code::ContourWord));
            }
            // The offsets of the tool that finishes are not those of the one that roughs.
            if own.is_some() && words.iter().any(|word| word.letter == b'T') {
                let others = words.iter().filter(|word| word.letter != b'T');
                without_tool = others.copied().collect();
                words = &without_tool;
            }
        }
        let taken = self.take_words(words)?;
        let words = taken.as_deref().unwrap_or(words);
        let home = words
            .iter()
            .any(|word| code_of(word).is_some_and(goes_home));
        let first_angle = first_angle(words)?;
        self.without_nose(home, |acting| {
            acting.act(|core, out| {
                let is_of_core = |(letter, ..): &(u8, Decimal, Span)| *letter != Word::START_ANGLE;
                let numbers: Vec<_> = core.numbers(words).filter(is_of_core).collect();
                core.interpreter.words(line, numbers, &mut |mut event| {
                    if let (Some(angle), Event::Call(call)) = (first_angle, &mut event)
                        && let CallKind::Thread(thread) = &mut call.kind
                    {
                        thread.first_angle = angle;
                    }
                    out(event);
                })
            })
        })
    }

    /// Hands over a stroke that waits for what follows it.
    fn release(&mut self) -> Result<(), Alarm> {
        self.act(|core, out| {
            core.interpreter.release(&mut |event| out(event));
            Ok(())
        })
        .map(drop)
    }

    /// Makes a move that was calculated. Its path is that of the tip.
    fn trace(&mut self, span: Span, to: Point, way: Way) -> Result<Done, Alarm> {
        self.without_nose(true, |acting| {
            acting.act(|core, out| {
                let to = Position {
                    x: to.x,
                    z: to.z,
                    c: core.interpreter.position().c,
                };
                core.interpreter
                    .trace(span, to, way, &mut |event| out(event))
            })
        })
    }
}

impl Machine for Acting<'_, '_> {
    fn line(&mut self, line: u32, text: &[u8]) -> Result<Done, Alarm> {
        let without_tool;
        let mut text = text;
        if let Some((collected, own)) = &mut self.core.contour {
            let is_straight = codes(text).any(|code| matches!(code, 0 | 1));
            let span = crate::text::span(line, 0, text.len());
            collected.block(letters(text), is_straight, span)?;
            let stray = place_of_code(text, is_no_motion).map(|place| (place, b'G'));
            let turns = || [b'C', b'H'].map(|letter| Some((place_of(text, letter)?, letter)));
            if let Some(((from, to), letter)) =
                stray.or_else(|| turns().into_iter().flatten().next())
            {
                let span = crate::text::span(line, from, to);
                return Err(Alarm::new(Code::ContourWord, span).word(letter));
            }
            if own.is_some() && letters(text).any(|letter| letter == b'T') {
                without_tool = blanked(text, b'T');
                text = &without_tool;
            }
        }
        let home = self.core.path.side() != Side::None && codes(text).any(goes_home);
        self.without_nose(home, |acting| {
            acting.act(|core, out| core.interpreter.line(text, line, &mut |event| out(event)))
        })
    }

    fn words(&mut self, line: u32, words: &[Word]) -> Result<Done, Alarm> {
        if let Some(done) = self.line_by_angle(line, words)? {
            return Ok(done);
        }
        if let Some(done) = self.drill(line, words)? {
            return Ok(done);
        }
        let tap = self.tap_level(line, words)?;
        let tap = tap.as_deref().unwrap_or(words);
        let rigid = self.rigid_by_itself(line, tap)?;
        self.plain_words(line, rigid.as_deref().unwrap_or(tap))
            .map_err(|alarm| self.core.without_point(alarm, words))
    }

    fn wants_words(&self) -> bool {
        self.core.drill.is_some() || self.core.counts_increments()
    }

    fn follow(&mut self, modes: Modes) {
        self.modes = modes;
        let interpreter = &mut self.core.interpreter;
        interpreter.run_out_by_words_alone(modes.without_run_out);
        interpreter.taps_end_at_r(modes.returns_to_r);
    }

    fn heard(&mut self, code: u16) {
        self.core.interpreter.heard(code);
    }

    fn decimals(&self, letter: u8) -> u8 {
        self.core.decimals(letter, self.core.interpreter.is_inch())
    }

    fn setting(&self) -> Setting {
        let now = self.core.interpreter.in_force();
        // An open line has not been carried out, and is one of G01.
        let motion = match self.core.open_line {
            Some(_) => 1,
            None => now.motion,
        };
        Setting {
            motion,
            increment: self.core.unit().decimals,
            counts: self.core.counts(),
            holes: now.taps,
            drills: self.core.drill.is_some(),
            inch: self.core.interpreter.is_inch(),
            per_turn: now.per_turn,
            counts_increments: self.core.counts_increments(),
            c_is_axis: !now.turns && self.core.contour.is_none(),
        }
    }

    fn note(&mut self, warning: Alarm) {
        (self.out)(Event::Warning(warning));
    }

    fn first_line(&mut self, cycle: Cycle, words: &[Word]) -> Result<(), Alarm> {
        let unit = self.core.unit();
        self.core.first.read(cycle, words, unit)
    }

    fn contour_begins(&mut self, cycle: Cycle, words: &[Word], span: Span) -> Result<(), Alarm> {
        self.refuse_open_line()?;
        self.release()?;
        let core = &mut *self.core;
        let at = core.interpreter.position();
        let start = Point { x: at.x, z: at.z };
        let (unit, first, params) = (core.unit(), core.first, core.params);
        let collected = Collected::new(cycle, words, &first, unit, params, span, start)?;
        let own = (!collected.is_finish()).then(|| core.interpreter.clone());
        core.contour = Some((collected, own));
        Ok(())
    }

    fn contour_ends(&mut self) -> Result<Done, Alarm> {
        self.refuse_open_line()?;
        let core = &mut *self.core;
        let Some((mut collected, own)) = core.contour.take() else {
            return Ok(Done::default());
        };
        let Some(own) = own else {
            // G70 has been cut as it was read; what is left is the way back.
            let start = collected.start();
            return self.trace(collected.span(), start, Way::Rapid);
        };
        core.path.end_contour()?;
        core.interpreter = own;
        let mut done = Done::default();
        let stock = core.stock;
        if let Some(told) = collected.leave_out_way_back() {
            self.note(told);
        }
        collected.refuse_depth()?;
        for doubt in collected.doubts(stock.as_ref()) {
            self.note(doubt);
        }
        collected.moves(|cut| {
            let way = match cut.element.shape {
                Shape::Rapid => Way::Rapid,
                Shape::Line => Way::Line,
                Shape::Arc { i, k, clockwise } => Way::Arc { i, k, clockwise },
            };
            done = self.trace(cut.element.span, cut.element.end, way)?;
            Ok(())
        })?;
        Ok(done)
    }

    fn finish(&mut self) -> Result<(), Alarm> {
        self.refuse_open_line()?;
        self.act(|core, out| core.interpreter.finish(&mut |event| out(event)))
            .map(drop)
    }
}
