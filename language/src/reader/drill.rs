//! Drilling: words to a hole, and the hole to calls of the core.

use leadscrew_core::alarm::{Alarm, Arg, Code, Span};
use leadscrew_core::call::{Aux, Call, CallKind, Position};
use leadscrew_core::program::{Event, Way, is_free_m};
use leadscrew_core::units::{Decimal, Length};

use super::Acting;
use crate::dialect::{Control, code_of, is_m19};
use crate::drilling::{Drill, Hole, Kind, Level, Parts, Step};
use crate::flow::{Done, Machine};
use crate::plane::Point;
use crate::steps;
use crate::word::{Given, Word};

/// More pecks than any hole needs.
const MOST_PECKS: u64 = 9_999;

/// True for a code that ends a drilling cycle.
fn ends(word: &Word) -> bool {
    matches!(
        code_of(word),
        Some(0..=3 | 32 | 34 | 74..=76 | 78 | 80 | 84 | 88 | 90 | 92 | 94)
    )
}

/// True for a code that has all words of its block, so that none of them is one of the hole's.
fn is_of_its_block(word: &Word) -> bool {
    matches!(code_of(word), Some(4 | 10 | 28 | 30 | 50 | 53))
}

/// True for G28 and G30, which end a cycle.
fn goes_to_reference(word: &Word) -> bool {
    matches!(code_of(word), Some(28 | 30))
}

/// True for M02 and M30.
fn ends_program(word: &Word) -> bool {
    matches!(word.value().whole(), Some(2 | 30))
}

impl Acting<'_, '_> {
    /// Carries out a block of a drilling cycle; `None` where it is none.
    pub(super) fn drill(&mut self, line: u32, words: &[Word]) -> Result<Option<Done>, Alarm> {
        let control = self.core.control;
        let begins = words
            .iter()
            .find_map(|word| Some((word, Kind::of(word, control)?)));
        match begins {
            Some((word, kind)) => {
                if words.iter().any(ends) {
                    let code = word.value().whole().unwrap_or(0);
                    let code = u16::try_from(code).unwrap_or(0);
                    return Err(word.alarm(Code::TapCycleKept).with([Arg::GCode(code * 10)]));
                }
                let drill = match self.core.drill {
                    Some((drill, initial)) if drill.kind.axis() == kind.axis() => {
                        (drill.then(kind, word.span), initial)
                    }
                    _ => {
                        self.end_drilling()?;
                        let here = self.core.interpreter.position();
                        (Drill::new(kind, word.span), here)
                    }
                };
                self.core.drill = Some(drill);
                self.core.drilled = Some((kind, word.span));
            }
            None if words.iter().any(ends) => self.end_drilling()?,
            None => {}
        }
        let Some((mut drill, initial)) = self.core.drill else {
            return Ok(None);
        };
        if self.core.contour.is_some() {
            return Err(Alarm::new(Code::ContourWord, drill.code).word(b'G'));
        }
        if begins.is_none() && words.iter().any(is_of_its_block) {
            if words.iter().any(goes_to_reference) {
                self.end_drilling()?;
            }
            return Ok(None);
        }
        // A spindle that stands at an angle drills no hole, and R of the block would be its level.
        if self.core.params.orients_by_m19()
            && let Some(word) = words.iter().find(|word| is_m19(word))
        {
            return Err(word.alarm(Code::MNotAvailable).with([Arg::Int(19)]));
        }
        let (unit, counts) = (self.core.unit(), self.core.counts());
        let parts = drill.read(words, control, unit, counts, is_free_m)?;
        self.core.drill = Some((drill, initial));
        let mut done = Done::default();
        if !parts.before.is_empty() {
            done = self.plain_words(line, &parts.before)?;
        }
        if parts.drills {
            self.holes(line, &drill, initial, &parts)?;
            done.moved = true;
        }
        if parts.after.iter().any(ends_program) {
            drill.end()?;
        }
        if !parts.after.is_empty() {
            let moved = done.moved;
            done = self.plain_words(line, &parts.after)?;
            done.moved |= moved;
        }
        Ok(Some(done))
    }

    /// The cycle in force is over, if there is one.
    fn end_drilling(&mut self) -> Result<(), Alarm> {
        let ended = self.core.drill.take();
        ended.map_or(Ok(()), |(drill, _)| drill.end())
    }

    /// Drills the holes of a block.
    fn holes(
        &mut self,
        line: u32,
        drill: &Drill,
        initial: Position,
        parts: &Parts,
    ) -> Result<(), Alarm> {
        for _ in 0..parts.holes {
            if !parts.place.is_empty() {
                let mut words = vec![code(0, drill.code)];
                words.extend(&parts.place);
                // The motion in force stays that of the program.
                let motion = i64::from(self.core.interpreter.in_force().motion);
                self.plain_words(line, &words)?;
                self.plain_words(line, &[code(motion, drill.code)])?;
            }
            let hole = self.hole(line, drill, initial)?;
            self.doubt(drill, &hole);
            if let Some(clamp) = &parts.clamp {
                self.clamp(clamp, 0)?;
            }
            let span = drill.code;
            let side = drill.kind.is_side();
            hole.steps(|step| {
                let at = self.core.interpreter.position();
                let to = |to: Length| {
                    if side {
                        Point { x: to, z: at.z }
                    } else {
                        Point { x: at.x, z: to }
                    }
                };
                match step {
                    Step::Rapid(place) => self.trace(span, to(place), Way::Rapid).map(drop),
                    Step::Feed(place) => self.trace(span, to(place), Way::Line).map(drop),
                    Step::Dwell(ms) => {
                        let words = [code(4, span), word(b'P', i64::from(ms), span)];
                        self.plain_words(line, &words).map(drop)
                    }
                }
            })?;
            if let Some(clamp) = &parts.clamp {
                self.clamp(clamp, 1)?;
            }
        }
        Ok(())
    }

    /// Tells once what is odd about Q.
    fn doubt(&mut self, drill: &Drill, hole: &Hole) {
        let Some((in_force, _)) = &mut self.core.drill else {
            return;
        };
        let Some(peck) = drill.peck.filter(|_| drill.kind.pecks()) else {
            return;
        };
        if std::mem::replace(&mut in_force.doubted, true) {
            return;
        }
        let (count, depth) = (hole.pecks(), (hole.bottom - hole.level).abs());
        if count > steps::MOST {
            let number = |count: u64| Arg::Int(i64::try_from(count).unwrap_or(i64::MAX));
            let figures = [
                number(count),
                number(1),
                Arg::Length(depth),
                Arg::Length(peck.value),
            ];
            self.note(Alarm::new(Code::PecksMany, peck.span).with(figures));
        } else if steps::is_beyond(peck.value, depth) {
            let figures = [Arg::Length(peck.value), Arg::Length(depth)];
            self.note(Alarm::new(Code::PeckBeyondDepth, peck.span).with(figures));
        }
    }

    /// The hole at the present place.
    fn hole(&mut self, line: u32, drill: &Drill, initial: Position) -> Result<Hole, Alarm> {
        let at = self.core.interpreter.position();
        let side = drill.kind.is_side();
        let of = |position: Position| if side { position.x } else { position.z };
        let [letter, _] = drill.kind.axis();
        let outside = of(at);
        let level = match drill.level {
            None => of(initial),
            Some(Level::Away(away)) => of(initial) + away,
            Some(Level::Coordinate(word)) => of(self.probe(line, letter, &word)?),
        };
        let bottom = match drill.bottom {
            None => return Err(drill.bottom_missing()),
            Some(Level::Away(away)) => level + away,
            Some(Level::Coordinate(word)) => of(self.probe(line, letter, &word)?),
        };
        let hole = Hole {
            initial: outside,
            level,
            bottom,
            peck: drill
                .peck
                .filter(|_| drill.kind.pecks())
                .map(|peck| peck.value),
            // A Haas goes back to R whatever its parameters [D572].
            deep: self.core.control == Control::Haas || self.core.params.drill_deep_peck(),
            clearance: self.core.params.drill_clearance(),
            dwell: drill.dwell(),
            feeds_out: drill.kind.feeds_out(),
            ends_at_r: self.modes.returns_to_r,
        };
        let beyond = |a: Length, b: Length| (bottom - level).signum() * (a - b).signum() < 0;
        if bottom == level || beyond(level, of(initial)) || hole.pecks() > MOST_PECKS {
            let code = match self.core.control {
                Control::Haas => Code::HoleLevels,
                _ => Code::HoleDepth,
            };
            return Err(Alarm::new(code, drill.code));
        }
        Ok(hole)
    }

    /// Where a coordinate would take the tool.
    pub(super) fn probe(
        &self,
        line: u32,
        letter: u8,
        coordinate: &Word,
    ) -> Result<Position, Alarm> {
        let mut probe = self.core.interpreter.clone();
        let place = Word {
            letter,
            ..*coordinate
        };
        let words = [code(0, coordinate.span), place];
        let numbers: Vec<_> = self.core.numbers(&words).collect();
        probe.words(line, numbers, &mut |_| {})?;
        Ok(probe.position())
    }

    /// The code that clamps the C axis, or the one after it, which unclamps.
    fn clamp(&mut self, word: &Word, further: u16) -> Result<(), Alarm> {
        let number = word.count(0, 998)?;
        let number = u16::try_from(number).unwrap_or(u16::MAX);
        if !is_free_m(i64::from(number) + 1) {
            let codes = [number, number + 1].map(|code| Arg::Int(i64::from(code)));
            return Err(word.alarm(Code::TapClampCode).with(codes));
        }
        let call = Call {
            span: word.span,
            origin: self.core.interpreter.in_force().origin,
            kind: CallKind::Aux(Aux::M(number + further)),
        };
        self.act(|_, out| {
            out(Event::Call(call));
            Ok(())
        })
        .map(drop)
    }
}

/// A G word that the program does not have.
fn code(number: i64, span: Span) -> Word {
    word(b'G', number, span)
}

fn word(letter: u8, number: i64, span: Span) -> Word {
    Word {
        letter,
        given: Given::Written(Decimal::new(number, 0)),
        variable: None,
        span,
    }
}
