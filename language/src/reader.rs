//! Program text in, events of the core out: macros, jumps and calls are carried out on the way.
//!
//! A line in which nothing has to be calculated goes to [`Interpreter::line`] as it is, with the same events and alarms. A
//! block with expressions goes there as words, each with its place in the text. This module knows which increment a word
//! has; it must not know files.

use leadscrew_core::alarm::{Alarm, Span};
use leadscrew_core::call::{Aux, Call, CallKind, FeedRate, Position};
use leadscrew_core::params::Params;
use leadscrew_core::program::{Dialect, Event, InForce, Interpreter, Options, Way};
use leadscrew_core::units::{Decimal, Length};

use crate::flow::{Done, Flow, Machine, Rules, Trouble};
use crate::lines::Source;
use crate::plane::{Element, Point, Shape};
use crate::roughing::{Collected, Cycle, FirstLines, Unit};
use crate::value::Value;
use crate::variables::{Kept, System, Variables, Written};
use crate::word::Word;

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
    dialect: Dialect,
    /// T of the latest block that has one.
    tool: Option<u16>,
    /// What the first lines of the contour cycles have said.
    first: FirstLines,
    /// The contour that is being read. For all cycles but G70 the interpreter is then a copy, whose moves are collected;
    /// the program's own one waits here.
    contour: Option<(Collected, Option<Interpreter<'p>>)>,
}

impl<'p, S: Source> Reader<'p, S> {
    /// Before the first line. `rules.skip` is that of the options.
    #[must_use]
    pub fn new(source: S, params: &'p Params, options: Options, kept: Kept, rules: Rules) -> Self {
        let rules = Rules {
            skip: options.skip,
            ..rules
        };
        Self {
            flow: Flow::new(source, kept, rules),
            core: Core {
                interpreter: Interpreter::new(params, options),
                params,
                dialect: options.dialect,
                tool: None,
                first: FirstLines::default(),
                contour: None,
            },
        }
    }

    /// Carries out the next line, or the next block of one, and hands what it yields to `out`.
    ///
    /// # Errors
    /// What ends the program; there is no further step.
    pub fn step(&mut self, out: &mut dyn FnMut(Event)) -> Result<(), Trouble> {
        let mut acting = Acting {
            core: &mut self.core,
            out,
        };
        self.flow.step(&mut acting)
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

    /// The text of the line of the latest step.
    ///
    /// # Errors
    /// The text cannot be read again.
    pub fn text(&mut self) -> std::io::Result<&[u8]> {
        self.flow.line_text()
    }

    /// The interpreter, for what it knows of the program.
    #[must_use]
    pub const fn interpreter(&self) -> &Interpreter<'p> {
        &self.core.interpreter
    }

    /// The variables, of which the kept ones are to be stored.
    #[must_use]
    pub const fn variables(&self) -> &Variables {
        self.flow.variables()
    }
}

impl Core<'_> {
    /// Decimals to which a value of this letter's word is rounded, in inches or millimetres.
    fn decimals(&self, letter: u8, inch: bool) -> u8 {
        let angle = 3 + u8::from(self.params.increment_is_c());
        let length = angle + u8::from(inch);
        match letter {
            b'X' | b'Z' | b'U' | b'W' | b'I' | b'J' | b'K' | b'R' | b'D' | b'E' => length,
            b'C' | b'H' => angle,
            b'F' => 6 - u8::from(inch),
            b'P' | b'Q' if self.dialect == Dialect::Gsk988 || self.params.pq_in_mm() => length,
            _ => 0,
        }
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
        let has = |code| {
            let is = |word: &Word| word.letter == b'G' && word.value().whole() == Some(code);
            words.iter().any(is)
        };
        let dwell = has(4);
        let inch = has(20) || (self.interpreter.is_inch() && !has(21));
        words.iter().filter_map(move |word| {
            let (decimals, step) = match word.letter {
                // Milliseconds, and seconds.
                b'P' if dwell => (0, 0),
                b'X' | b'U' if dwell => (3, 3),
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

    /// A length in the unit in force.
    fn shown(&self, length: Length) -> f64 {
        let unit = if self.interpreter.is_inch() {
            25_400_000.0
        } else {
            1_000_000.0
        };
        length.nm() as f64 / unit
    }

    /// F as it would be written.
    fn feed(&self, now: &InForce) -> Option<f64> {
        Some(match now.feed? {
            FeedRate::PerMinute(feed) => self.shown(Length::from_nm(feed.nm_per_min())),
            FeedRate::PerTurn(feed, _) => self.shown(Length::from_nm(feed.nm())),
        })
    }

    /// The value of a system variable.
    fn system(&self, number: u32) -> Option<Value> {
        let now = self.interpreter.in_force();
        let at = self.interpreter.position();
        let (x, z, c) = (at.x, at.z, at.c.udeg());
        let zero = now.origin;
        let number = match number {
            4001 => now.motion.into(),
            4002 => 97.0 - f64::from(u8::from(now.surface.is_some())),
            4005 => 98.0 + f64::from(u8::from(now.per_turn)),
            4006 => 21.0 - f64::from(u8::from(self.interpreter.is_inch())),
            4014 => now.system.into(),
            4016 => now.plane.into(),
            4109 => return Some(self.feed(&now).map_or(Value::Null, Value::Number)),
            4114 => self.interpreter.sequence_number().unwrap_or(0).into(),
            4115 => self.interpreter.program_number().unwrap_or(0).into(),
            4119 => match now.surface {
                // Metres or feet a minute.
                Some(speed) => {
                    self.shown(Length::from_nm(speed.nm_per_min()))
                        / if self.interpreter.is_inch() {
                            12.0
                        } else {
                            1000.0
                        }
                }
                None => now.speed.into(),
            },
            4120 => self.tool.unwrap_or(0).into(),
            // What comes next is read after the board has got there, so the present place is that of the block's end.
            5001 | 5041 => self.shown(x - zero.x) * 2.0,
            5002 | 5042 => self.shown(z - zero.z),
            5003 | 5043 => (c - zero.c.udeg()) as f64 / 1e6,
            5021 => self.shown(x) * 2.0,
            5022 => self.shown(z),
            5023 => c as f64 / 1e6,
            5221..=5322 => {
                let (system, axis) = ((number - 5221) / 20, (number - 5221) % 20);
                let [x, z] = self.params.work_offset(system as u8);
                match axis {
                    0 => self.shown(x) * 2.0,
                    1 => self.shown(z),
                    _ => return None,
                }
            }
            _ => return None,
        };
        Some(Value::Number(number))
    }
}

/// A core that carries out one step.
struct Acting<'a, 'p> {
    core: &'a mut Core<'p>,
    out: &'a mut dyn FnMut(Event),
}

impl Acting<'_, '_> {
    /// Does something with the interpreter, and tells what came of it.
    fn act(
        &mut self,
        action: impl FnOnce(&mut Core<'_>, &mut dyn FnMut(Event)) -> Result<(), Alarm>,
    ) -> Result<Done, Alarm> {
        let (mut moved, mut tool) = (false, None);
        let out = &mut *self.out;
        let mut contour = self.core.contour.take();
        let collected = match &mut contour {
            Some((collected, Some(_))) => Some(collected),
            _ => None,
        };
        let result = if let Some(collected) = collected {
            action(self.core, &mut |event| {
                if let Event::Call(call) = &event {
                    collect(collected, call);
                }
            })
        } else {
            action(self.core, &mut |event| {
                if let Event::Call(call) = &event {
                    moved |= moves(call);
                    if let CallKind::Aux(Aux::T(number)) = call.kind {
                        tool = Some(number);
                    }
                }
                out(event);
            })
        };
        self.core.contour = contour;
        result?;
        self.core.tool = tool.or(self.core.tool);
        Ok(Done {
            moved,
            ended: self.core.interpreter.is_ended(),
        })
    }
}

/// The letters of the words of a plain text, without its comments.
fn letters(text: &[u8]) -> impl Iterator<Item = u8> {
    let mut depth = 0_u32;
    text.iter().filter_map(move |byte| {
        match byte {
            b'(' => depth += 1,
            b')' => depth = depth.saturating_sub(1),
            _ => {}
        }
        let letter = byte.to_ascii_uppercase();
        (depth == 0 && letter.is_ascii_uppercase()).then_some(letter)
    })
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
    )
}

impl Acting<'_, '_> {
    /// Makes a move that was calculated.
    fn trace(&mut self, span: Span, to: Point, way: Way) -> Result<Done, Alarm> {
        self.act(|core, out| {
            let to = Position {
                x: to.x,
                z: to.z,
                c: core.interpreter.position().c,
            };
            core.interpreter
                .trace(span, to, way, &mut |event| out(event))
        })
    }
}

impl System for Acting<'_, '_> {
    fn read(&mut self, number: u32) -> Option<Value> {
        self.core.system(number)
    }

    fn write(&mut self, number: u32, _value: Value) -> Written {
        match self.core.system(number) {
            Some(_) => Written::ReadOnly,
            None => Written::Unknown,
        }
    }
}

impl Machine for Acting<'_, '_> {
    fn line(&mut self, line: u32, text: &[u8]) -> Result<Done, Alarm> {
        if let Some((collected, Some(_))) = &mut self.core.contour {
            collected.block(letters(text));
        }
        self.act(|core, out| core.interpreter.line(text, line, &mut |event| out(event)))
    }

    fn words(&mut self, line: u32, words: &[Word]) -> Result<Done, Alarm> {
        if let Some((collected, Some(_))) = &mut self.core.contour {
            collected.block(words.iter().map(|word| word.letter));
        }
        self.act(|core, out| {
            let numbers: Vec<_> = core.numbers(words).collect();
            core.interpreter
                .words(line, numbers, &mut |event| out(event))
        })
    }

    fn decimals(&self, letter: u8) -> u8 {
        self.core.decimals(letter, self.core.interpreter.is_inch())
    }

    fn note(&mut self, warning: Alarm) {
        (self.out)(Event::Warning(warning));
    }

    fn first_line(&mut self, cycle: Cycle, words: &[Word]) -> Result<(), Alarm> {
        let unit = self.core.unit();
        self.core.first.read(cycle, words, unit)
    }

    fn contour_begins(&mut self, cycle: Cycle, words: &[Word], span: Span) -> Result<(), Alarm> {
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
        let core = &mut *self.core;
        let Some((collected, own)) = core.contour.take() else {
            return Ok(Done::default());
        };
        let Some(own) = own else {
            // G70 has been cut as it was read; what is left is the way back.
            let start = collected.start();
            return self.trace(Span::default(), start, Way::Rapid);
        };
        core.interpreter = own;
        let mut done = Done::default();
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
        self.core.interpreter.finish()
    }
}

#[cfg(test)]
mod tests;
