//! Calls of subprograms and macros: M97, M98, G65, G66, G67.

use leadscrew_core::alarm::{Alarm, Arg, Code, Span};

use super::frame::{Frame, Modal};
use super::jumps::no_label;
use super::{Flow, Machine, Trouble};
use crate::arguments::arguments;
use crate::dialect::Control;
use crate::lines::Source;
use crate::macro_a::{self, After};
use crate::variables::{Locals, Scope};
use crate::word::Word;

/// How deep calls may be nested.
const LEVELS: usize = 16;

/// How many modal calls may be in force.
const MODALS: usize = 4;

/// Highest number of a program or a block.
pub(super) const HIGHEST: u32 = 99_999_999;

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
    Modal,
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
            (b'G', 66) => Self::Modal,
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
        self.refuse_in_contour(&word)?;
        if let Some((_, second, _)) = callers.next() {
            return Err(second.alarm(Code::MacroStatement).into());
        }
        let (before, after) = (&words[..index], &words[index + 1..]);
        match caller {
            Caller::Macro | Caller::Modal => {
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

    /// M98 P L, or P with the passes in front of four digits [D542].
    fn subprogram_call(&mut self, word: Word, words: &[Word]) -> Result<(), Trouble> {
        let target = find(words, b'P')?.ok_or_else(|| word.alarm(Code::CallWithoutTarget))?;
        let number = target.count(0, HIGHEST)?;
        let (number, passes) = match find(words, b'L')? {
            Some(passes) => (number, passes.count(1, 9999)?),
            // A Haas has programs of five digits, and L alone counts.
            None if number > 9999 && self.translator.control() != Control::Haas => {
                (number % 10_000, (number / 10_000).max(1))
            }
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
        modals.push(Modal {
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

    /// Begins a program.
    fn enter(
        &mut self,
        called: Span,
        number: u32,
        passes: u32,
        arguments: Option<Box<Locals>>,
        modals: Vec<Modal>,
    ) -> Result<(), Trouble> {
        let start = self.find_program(number, called)?;
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
}

/// The word of a letter that a call may have once.
pub(super) fn find(words: &[Word], letter: u8) -> Result<Option<Word>, Alarm> {
    let mut found = words.iter().filter(|word| word.letter == letter);
    let first = found.next().copied();
    match found.next() {
        Some(second) => Err(second.alarm(Code::WordTwice)),
        None => Ok(first),
    }
}
