//! Where a jump, a call or a loop leads. The text does not change while a program runs, so an answer that was found once
//! is kept; there is room for a bounded number of them.

use std::collections::HashMap;
use std::hash::Hash;

use leadscrew_core::alarm::{Alarm, Arg, Code, Span};

use super::jumps::{Loop, unmatched};
use super::{Flow, Own, Trouble};
use crate::heading::Heading;
use crate::lines::{Place, Source};
use crate::outline::{Mark, Outline, Scanner, is_behind_end};
use crate::whose::Whose;

/// Answers of one kind that are kept.
const KEPT: usize = 512;

/// Loops around a block that a search counts.
const DEEPEST: usize = 8;

/// A block that a jump leads to.
#[derive(Clone, Debug)]
pub struct Target {
    /// Where it begins.
    pub(super) place: Place,
    /// The loops that it lies in.
    pub(super) loops: Vec<Loop>,
}

/// The answers of earlier searches.
#[derive(Debug, Default)]
pub struct Memo {
    labels: HashMap<(Place, u32), Option<Target>>,
    programs: HashMap<(Whose, u32), Option<Place>>,
    ends: HashMap<Place, Place>,
    /// The contours of the latest cycles by the front of their program, P and Q. One that has gone is looked for anew, and
    /// refused where its numbers stand twice.
    pub(super) contours: HashMap<(Place, [u32; 2]), (Place, Place)>,
}

/// Keeps an answer; all others go where there are too many.
pub(super) fn keep<K: Eq + Hash, V>(answers: &mut HashMap<K, V>, key: K, answer: V) {
    if answers.len() >= KEPT {
        answers.clear();
    }
    answers.insert(key, answer);
}

impl<S: Source> Flow<S> {
    /// The block with this N: from `from` on to the end of the program, then from its front. A block inside of a loop in
    /// which `from` does not lie is none.
    pub(super) fn find_label(
        &mut self,
        number: u32,
        from: Place,
    ) -> Result<Option<Target>, Trouble> {
        if let Some(known) = self.memo.labels.get(&(from, number)) {
            return Ok(known.clone());
        }
        let active = self.top().loops.clone();
        let mut found = self.search(number, Scanner::from(from), None, &active)?;
        if found.is_none() {
            let start = Scanner::from(self.top().start);
            found = self.search(number, start, Some(from), &[])?;
        }
        // A loop in which the jump does not stand cannot be entered from outside.
        let found = found.and_then(|found| {
            let known = |inner: &Loop| active.iter().find(|known| known.place == inner.place);
            let loops = found.loops.iter().map(|inner| known(inner).copied());
            Some(Target {
                place: found.place,
                loops: loops.collect::<Option<_>>()?,
            })
        });
        keep(&mut self.memo.labels, (from, number), found.clone());
        Ok(found)
    }

    /// Looks for N up to the end of the program, or to `until`. `loops` are around the first block.
    fn search(
        &mut self,
        number: u32,
        mut scanner: Scanner,
        until: Option<Place>,
        loops: &[Loop],
    ) -> Result<Option<Target>, Trouble> {
        let mut loops = loops.to_vec();
        let mut first = true;
        while let Some(block) = scanner.next(&mut self.lines)? {
            let at_front = std::mem::take(&mut first) && until.is_some();
            let passed =
                |until: Place| (block.place.byte, block.place.column) >= (until.byte, until.column);
            if (block.program.is_some() && !at_front) || until.is_some_and(passed) {
                break;
            }
            if block.sequence == Some(number) {
                return Ok(Some(Target {
                    place: block.place,
                    loops,
                }));
            }
            pass(&block, &mut loops);
        }
        Ok(None)
    }

    /// The front of a program: in the file that calls it at `called`, in that of the main program, or in a file of its own.
    pub(super) fn find_program(&mut self, number: u32, called: Span) -> Result<Place, Trouble> {
        for file in [self.at.file(), Whose::Program] {
            if let Some(found) = self.find_in(file, number)? {
                return Ok(found);
            }
        }
        let figure = [Arg::Int(i64::from(number))];
        let Some(own) = Whose::file_of(number) else {
            return Err(Alarm::new(Code::ProgramNotInFile, called)
                .with(figure)
                .into());
        };
        if !self.lines.has(own)? {
            let mut alarm = Alarm::new(Code::ProgramNotFound, called).with(figure);
            for file in [self.at.file(), Whose::Program] {
                if is_behind_end(&mut self.lines, file, number)? {
                    alarm.args[1] = Arg::Letter(b'%');
                }
            }
            return Err(alarm.into());
        }
        self.read_heading(own)?;
        if let Some(found) = self.find_in(own, number)? {
            return Ok(found);
        }
        // A file of its own need not tell its number again, but it may not tell another.
        match Scanner::of(own).next(&mut self.lines)? {
            Some(block) => match block.program {
                Some(other) => {
                    let figures = [number, other].map(|number| Arg::Int(i64::from(number)));
                    Err(Alarm::new(Code::ProgramFileOfOther, block.span)
                        .with(figures)
                        .into())
                }
                None => Ok(block.place),
            },
            None => Ok(Place::start_of(own)),
        }
    }

    /// Takes note of what the first lines of a subprogram's file say, once.
    fn read_heading(&mut self, file: Whose) -> Result<(), Trouble> {
        if self.files.contains_key(&file) {
            return Ok(());
        }
        let heading = Heading::read(&mut self.lines, file)?;
        if let Some(alarm) = heading.alarm {
            return Err(alarm.into());
        }
        let own = Own {
            control: heading.control.unwrap_or(self.rules.control),
            allowed: heading.allowed,
        };
        self.files.insert(file, own);
        Ok(())
    }

    /// The front of a program in this file.
    fn find_in(&mut self, file: Whose, number: u32) -> Result<Option<Place>, Trouble> {
        if let Some(known) = self.memo.programs.get(&(file, number)) {
            return Ok(*known);
        }
        let mut scanner = Scanner::of(file);
        let mut found = None;
        while let Some(block) = scanner.next(&mut self.lines)? {
            if block.program == Some(number) {
                found = Some(block.place);
                break;
            }
        }
        keep(&mut self.memo.programs, (file, number), found);
        Ok(found)
    }

    /// The block after the END of a loop whose DO is at `place`, and whose first block is at `from`.
    pub(super) fn find_end(
        &mut self,
        place: Place,
        from: Place,
        number: u8,
        span: Span,
    ) -> Result<Place, Trouble> {
        if let Some(known) = self.memo.ends.get(&place) {
            return Ok(*known);
        }
        let mut open = vec![number];
        let mut scanner = Scanner::from(from);
        while let Some(block) = scanner.next(&mut self.lines)? {
            if block.program.is_some() {
                break;
            }
            match block.mark {
                Some(Mark::Do(inner)) if open.contains(&inner) => {
                    return Err(unmatched(inner, block.span).into());
                }
                Some(Mark::Do(inner)) => open.push(inner),
                Some(Mark::End(inner)) if open.last() == Some(&inner) => {
                    open.pop();
                    if open.is_empty() {
                        keep(&mut self.memo.ends, place, block.after);
                        return Ok(block.after);
                    }
                }
                Some(Mark::End(inner)) => return Err(unmatched(inner, block.span).into()),
                None => {}
            }
        }
        Err(unmatched(number, span).into())
    }
}

/// Keeps count of the loops around the block after this one.
fn pass(block: &Outline, loops: &mut Vec<Loop>) {
    match block.mark {
        // More than three are a mistake, which is told where it is carried out.
        Some(Mark::Do(number)) if loops.len() < DEEPEST => loops.push(Loop {
            number,
            place: block.place,
            span: block.span,
        }),
        Some(Mark::End(number)) if loops.last().is_some_and(|inner| inner.number == number) => {
            loops.pop();
        }
        _ => {}
    }
}
