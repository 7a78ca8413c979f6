//! Subprograms and macros: M97, M98, M99, G65, G66, G67, and where a program begins and ends.

use leadscrew_core::alarm::{Alarm, Arg, Code, Span};
use leadscrew_core::units::Decimal;

use super::jumps::Loop;
use super::{Flow, Machine, Trouble};
use crate::arguments::arguments;
use crate::lines::{Place, Source};
use crate::macro_a::{self, After};
use crate::text::Cursor;
use crate::variables::{Locals, Scope};
use crate::word::{Given, Word};

/// How deep calls may be nested.
const LEVELS: usize = 16;

/// How many modal calls may be in force.
const MODALS: usize = 4;

/// Highest number of a program or a block.
const HIGHEST: u32 = 99_999_999;

/// A program that was called, or the main program.
#[derive(Clone, Debug)]
pub struct Frame {
    /// Its number.
    number: u32,
    /// The front of the program: searches begin there.
    pub(super) start: Place,
    /// The first block of each pass.
    pub(super) entry: Place,
    /// Where its caller goes on.
    back: Place,
    /// The word that called it.
    pub(super) called: Span,
    /// Passes after this one.
    left: u32,
    /// What its local variables are at the front of each pass; `None` where it has its caller's.
    arguments: Option<Box<Locals>>,
    /// The loops around the next block, from outside.
    pub(super) loops: Vec<Loop>,
    /// The modal calls in force, the latest last.
    pub(super) modals: Vec<InForce>,
}

/// A macro that is called after each motion.
#[derive(Clone, Debug)]
pub struct InForce {
    called: Span,
    number: u32,
    passes: u32,
    arguments: Box<Locals>,
}

impl Frame {
    /// The main program, before anything of it is known.
    pub(super) const fn main() -> Self {
        Self {
            number: 0,
            start: Place::START,
            entry: Place::START,
            back: Place::START,
            called: Span {
                line: 0,
                column: 0,
                end: 0,
            },
            left: 0,
            arguments: None,
            loops: Vec::new(),
            modals: Vec::new(),
        }
    }

    /// The alarm of a subprogram that does not return.
    pub(super) fn left_open(&self, span: Span) -> Alarm {
        let figure = [Arg::Int(i64::from(self.number))];
        Alarm::new(Code::SubprogramOpen, span).with(figure)
    }
}

/// The words of a block that calls.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Caller {
    /// M97: a part of the same program.
    Local,
    /// M98.
    Subprogram,
    /// M99.
    Return,
    /// G65.
    Macro,
    /// G66.
    InForce,
    /// G67.
    ModalEnd,
}

impl Caller {
    fn of(word: &Word) -> Option<Self> {
        Some(match (word.letter, word.value().whole()?) {
            (b'M', 97) => Self::Local,
            (b'M', 98) => Self::Subprogram,
            (b'M', 99) => Self::Return,
            (b'G', 65) => Self::Macro,
            (b'G', 66) => Self::InForce,
            (b'G', 67) => Self::ModalEnd,
            _ => return None,
        })
    }
}

impl<S: Source> Flow<S> {
    /// The program that runs.
    pub(super) fn top(&self) -> &Frame {
        // The main program is never taken away.
        &self.frames[self.frames.len() - 1]
    }

    pub(super) fn top_mut(&mut self) -> &mut Frame {
        let last = self.frames.len() - 1;
        &mut self.frames[last]
    }

    /// Carries out a block that calls or returns; false where it does neither.
    pub(super) fn call(
        &mut self,
        line: u32,
        words: &[Word],
        machine: &mut impl Machine,
    ) -> Result<bool, Trouble> {
        let mut callers = words
            .iter()
            .enumerate()
            .filter_map(|(index, word)| Some((index, *word, Caller::of(word)?)));
        let Some((index, word, caller)) = callers.next() else {
            return Ok(false);
        };
        if let Some((_, second, _)) = callers.next() {
            return Err(second.alarm(Code::MacroStatement).into());
        }
        let (before, after) = (&words[..index], &words[index + 1..]);
        match caller {
            Caller::Macro | Caller::InForce => {
                if let Some(word) = before.iter().find(|word| word.letter != b'N') {
                    return Err(word.alarm(Code::ArgumentAddress).into());
                }
                if !before.is_empty() {
                    machine.words(line, before)?;
                }
                if caller == Caller::Macro && after.first().is_some_and(|next| next.letter == b'H')
                {
                    self.macro_a(after, machine)?;
                } else {
                    self.macro_call(word, caller, after)?;
                }
            }
            _ => {
                let own: &[u8] = match caller {
                    Caller::ModalEnd => b"",
                    Caller::Return => b"P",
                    _ => b"PL",
                };
                let others: Vec<Word> = words
                    .iter()
                    .filter(|other| other.span != word.span && !own.contains(&other.letter))
                    .copied()
                    .collect();
                // What else stands in the block comes first.
                if !others.is_empty() {
                    let done = machine.words(line, &others)?;
                    self.note(done);
                    if self.over {
                        return Ok(true);
                    }
                }
                match caller {
                    Caller::Return => self.return_from(word, find(words, b'P')?, machine)?,
                    Caller::ModalEnd => drop(self.top_mut().modals.pop()),
                    Caller::Local => self.local_call(word, words)?,
                    _ => self.subprogram_call(word, words)?,
                }
            }
        }
        Ok(true)
    }

    /// M98 P L, or P with the passes in front of four digits.
    fn subprogram_call(&mut self, word: Word, words: &[Word]) -> Result<(), Trouble> {
        let target = find(words, b'P')?.ok_or_else(|| word.alarm(Code::CallWithoutTarget))?;
        let number = target.count(0, HIGHEST)?;
        let (number, passes) = match find(words, b'L')? {
            Some(passes) => (number, passes.count(1, 9999)?),
            None if number > 9999 => (number % 10_000, (number / 10_000).max(1)),
            None => (number, 1),
        };
        let modals = self.top().modals.clone();
        self.enter(target.span, number, passes, None, modals)
    }

    /// M97 P L.
    fn local_call(&mut self, word: Word, words: &[Word]) -> Result<(), Trouble> {
        let target = find(words, b'P')?.ok_or_else(|| word.alarm(Code::CallWithoutTarget))?;
        let number = target.count(0, HIGHEST)?;
        let passes = find(words, b'L')?.map_or(Ok(1), |passes| passes.count(1, 9999))?;
        let found = self.find_label(number, self.at)?;
        let Some(found) = found.filter(|found| found.loops.is_empty()) else {
            return Err(no_label(i64::from(number), target.span).into());
        };
        let mut frame = Frame {
            number,
            entry: found.place,
            ..self.top().clone()
        };
        frame.loops.clear();
        frame.arguments = None;
        self.push(frame, target.span, passes)?;
        Ok(())
    }

    /// G65, G66.
    fn macro_call(&mut self, word: Word, caller: Caller, words: &[Word]) -> Result<(), Trouble> {
        let target = find(words, b'P')?.ok_or_else(|| word.alarm(Code::CallWithoutTarget))?;
        let number = target.count(1, HIGHEST)?;
        let passes = find(words, b'L')?.map_or(Ok(1), |passes| passes.count(1, 9999))?;
        let arguments = Box::new(arguments(words)?);
        let modals = &mut self.top_mut().modals;
        if caller == Caller::Macro {
            let modals = modals.clone();
            return self.enter(target.span, number, passes, Some(arguments), modals);
        }
        if modals.len() == MODALS {
            let limit = [Arg::Int(MODALS as i64)];
            return Err(word.alarm(Code::ModalCallsTooMany).with(limit).into());
        }
        modals.push(InForce {
            called: target.span,
            number,
            passes,
            arguments,
        });
        Ok(())
    }

    /// Calls the macro of the latest G66. Inside of it the one before that is in force.
    pub(super) fn call_modal(&mut self) -> Result<(), Trouble> {
        let mut modals = self.top().modals.clone();
        let Some(modal) = modals.pop() else {
            return Ok(());
        };
        let (number, passes) = (modal.number, modal.passes);
        self.enter(modal.called, number, passes, Some(modal.arguments), modals)
    }

    /// `G65 Hm …`
    fn macro_a(&mut self, words: &[Word], machine: &mut impl Machine) -> Result<(), Trouble> {
        let Some((which, operands)) = words.split_first() else {
            return Ok(());
        };
        let mut scope = Scope {
            variables: &mut self.variables,
            system: machine,
        };
        match macro_a::carry_out(which, operands, &mut scope)? {
            After::Next => Ok(()),
            After::Jump(number) => self.jump(i64::from(number), which.span),
        }
    }

    /// Begins a program of this file.
    fn enter(
        &mut self,
        called: Span,
        number: u32,
        passes: u32,
        arguments: Option<Box<Locals>>,
        modals: Vec<InForce>,
    ) -> Result<(), Trouble> {
        let Some(start) = self.find_program(number)? else {
            let figure = [Arg::Int(i64::from(number))];
            return Err(Alarm::new(Code::ProgramNotFound, called)
                .with(figure)
                .into());
        };
        let frame = Frame {
            number,
            start,
            entry: start,
            arguments,
            modals,
            ..Frame::main()
        };
        self.push(frame, called, passes)?;
        Ok(())
    }

    fn push(&mut self, frame: Frame, called: Span, passes: u32) -> Result<(), Alarm> {
        if self.frames.len() > LEVELS {
            let limit = [Arg::Int(LEVELS as i64)];
            return Err(Alarm::new(Code::CallsTooDeep, called).with(limit));
        }
        self.mind_budget(called)?;
        if let Some(arguments) = &frame.arguments {
            self.variables.open(arguments);
        }
        let entry = frame.entry;
        self.frames.push(Frame {
            called,
            back: self.at,
            left: passes - 1,
            ..frame
        });
        self.at = entry;
        Ok(())
    }

    /// M99, with or without P.
    fn return_from(
        &mut self,
        word: Word,
        to: Option<Word>,
        machine: &mut impl Machine,
    ) -> Result<(), Trouble> {
        self.mind_budget(word.span)?;
        let to = to.map(|to| Ok::<_, Alarm>((to.count(0, HIGHEST)?, to.span)));
        let to = to.transpose()?;
        if self.frames.len() == 1 {
            return self.main_again(word, to, machine);
        }
        let frame = self.top_mut();
        frame.loops.clear();
        if frame.left > 0 {
            frame.left -= 1;
            let (entry, arguments) = (frame.entry, frame.arguments.clone());
            self.at = entry;
            if let Some(arguments) = arguments {
                self.variables.close();
                self.variables.open(&arguments);
            }
            return Ok(());
        }
        if let Some(frame) = self.frames.pop() {
            self.at = frame.back;
            if frame.arguments.is_some() {
                self.variables.close();
            } else {
                // A subprogram may begin and end modal calls of its caller.
                self.top_mut().modals = frame.modals;
            }
        }
        match to {
            Some((number, span)) => self.jump(i64::from(number), span),
            None => Ok(()),
        }
    }

    /// M99 in the main program.
    fn main_again(
        &mut self,
        word: Word,
        to: Option<(u32, Span)>,
        machine: &mut impl Machine,
    ) -> Result<(), Trouble> {
        let here = self.at;
        if let Some((number, span)) = to {
            self.jump(i64::from(number), span)?;
            let ahead = (self.at.byte, self.at.column) >= (here.byte, here.column);
            if ahead || self.rules.repeat {
                return Ok(());
            }
        } else if self.rules.repeat {
            let main = self.top_mut();
            main.loops.clear();
            self.at = main.entry;
            return Ok(());
        }
        machine.note(word.alarm(Code::MainRepeats));
        self.over = true;
        machine.finish()?;
        Ok(())
    }

    /// True where the number of a program opens the one that runs, at `here`.
    pub(super) fn opens(
        &mut self,
        number: u32,
        here: Place,
        machine: &mut impl Machine,
        cursor: &Cursor<'_>,
        sequence: Option<Word>,
    ) -> Result<bool, Alarm> {
        if self.started {
            return Ok(self.top().start == here);
        }
        self.start(here);
        self.frames[0].number = number;
        let word = Word {
            letter: b'O',
            given: Given::Written(Decimal::new(i64::from(number), 0)),
            variable: None,
            span: cursor.span_from(here.column),
        };
        let words: Vec<Word> = sequence.into_iter().chain([word]).collect();
        machine.words(here.line, &words)?;
        Ok(true)
    }

    /// Another program begins at the cursor: this one is over.
    pub(super) fn program_over(
        &mut self,
        cursor: &Cursor<'_>,
        machine: &mut impl Machine,
    ) -> Result<(), Trouble> {
        if self.frames.len() > 1 {
            let span = cursor.span_from(cursor.at().saturating_sub(1));
            return Err(self.top().left_open(span).into());
        }
        self.over = true;
        machine.finish()?;
        Ok(())
    }
}

/// The word of a letter that a call may have once.
fn find(words: &[Word], letter: u8) -> Result<Option<Word>, Alarm> {
    let mut found = words.iter().filter(|word| word.letter == letter);
    let first = found.next().copied();
    match found.next() {
        Some(second) => Err(second.alarm(Code::WordTwice)),
        None => Ok(first),
    }
}

/// The alarm of a jump to nowhere.
pub(super) fn no_label(number: i64, span: Span) -> Alarm {
    Alarm::new(Code::JumpTarget, span).with([Arg::Int(number)])
}
