//! G70 to G73: the blocks of a contour are read before what follows the cycle.

use leadscrew_core::alarm::{Alarm, Arg, Code};

use super::calls::{HIGHEST, find};
use super::search::keep;
use super::{Flow, Machine, Trouble};
use crate::lines::{Place, Source};
use crate::outline::Scanner;
use crate::roughing::Cycle;
use crate::whose::line_in_file;
use crate::word::Word;

impl<S: Source> Flow<S> {
    /// Carries out a block with G70 to G73 at word `index`: a first line, or a cycle with its contour.
    pub(super) fn contour_cycle(
        &mut self,
        line: u32,
        words: &[Word],
        index: usize,
        cycle: Cycle,
        machine: &mut impl Machine,
    ) -> Result<(), Trouble> {
        let code = words[index];
        self.refuse_in_contour(&code)?;
        let own = |word: &&Word| word.span == code.span || cycle.letters().contains(&word.letter);
        let others: Vec<Word> = words.iter().filter(|word| !own(word)).copied().collect();
        let mine: Vec<Word> = words.iter().filter(own).copied().collect();
        if !others.is_empty() {
            let done = machine.words(line, &others)?;
            self.note(done);
        }
        let (first, last) = match (find(words, b'P')?, find(words, b'Q')?) {
            (Some(first), Some(last)) => (first, last),
            (None, None) if cycle != Cycle::Finish => {
                machine.first_line(cycle, &mine)?;
                return Ok(());
            }
            (None, _) => return Err(missing(&code, b'P').into()),
            (_, None) => return Err(missing(&code, b'Q').into()),
        };
        let (begin, end) = self.contour(cycle, &first, &last)?;
        machine.contour_begins(cycle, &mine, code.span)?;
        let (back, around) = (self.at, self.top().loops.clone());
        let modes = self.translator;
        self.at = begin;
        self.in_contour = true;
        let read = self.read_contour(end, machine);
        self.in_contour = false;
        read?;
        let follows = Scanner::from(back).next(&mut self.lines)?;
        let is_next = follows.is_some_and(|block| !block.place.is_before(begin));
        if cycle == Cycle::Finish || !is_next || begin.is_before(back) {
            self.at = back;
        }
        self.top_mut().loops = around;
        if cycle != Cycle::Finish {
            // The contour was read, and not carried out.
            self.translator = modes;
        }
        let done = machine.contour_ends()?;
        self.done(done)
    }

    /// Carries out the blocks up to the one at `end`.
    fn read_contour(&mut self, end: Place, machine: &mut impl Machine) -> Result<(), Trouble> {
        while !self.over {
            let here = self.at;
            self.try_step(machine)?;
            if !here.is_before(end) {
                break;
            }
        }
        Ok(())
    }

    /// The first and the last block of a cycle's contour. Programs use their numbers again for the next tool: G70 takes the
    /// contour that was roughed last under its numbers [D540].
    fn contour(
        &mut self,
        cycle: Cycle,
        first: &Word,
        last: &Word,
    ) -> Result<(Place, Place), Trouble> {
        let numbers = [first.count(0, HIGHEST)?, last.count(0, HIGHEST)?];
        let key = (self.top().start, numbers);
        if cycle == Cycle::Finish
            && let Some(known) = self.memo.contours.get(&key)
        {
            return Ok(*known);
        }
        let from = self.at;
        let begin = self.contour_block(first, from)?;
        if cycle == Cycle::Finish || begin.is_before(from) {
            self.refuse_twice(first, numbers[0])?;
        }
        let end = self.contour_block(last, begin)?;
        if end.is_before(begin) {
            return Err(not_there(last).into());
        }
        keep(&mut self.memo.contours, key, (begin, end));
        Ok((begin, end))
    }

    /// The block that P or Q names, from `from` on.
    fn contour_block(&mut self, word: &Word, from: Place) -> Result<Place, Trouble> {
        let number = word.count(0, HIGHEST)?;
        match self.find_label(number, from)? {
            Some(target) => Ok(target.place),
            None => Err(not_there(word).into()),
        }
    }

    /// Refuses a number that two blocks of the program have, where nothing tells which of them is meant.
    fn refuse_twice(&mut self, word: &Word, number: u32) -> Result<(), Trouble> {
        let mut scanner = Scanner::from(self.top().start);
        let (mut at_front, mut one) = (true, None);
        while let Some(block) = scanner.next(&mut self.lines)? {
            if block.program.is_some() && !at_front {
                break;
            }
            at_front = false;
            if block.sequence != Some(number) {
                continue;
            }
            let line = line_in_file(block.place.line);
            match one {
                None => one = Some(line),
                Some(one) => {
                    let figures = [number, one, line].map(|figure| Arg::Int(i64::from(figure)));
                    return Err(word.alarm(Code::ContourTwice).with(figures).into());
                }
            }
        }
        Ok(())
    }

    /// Refuses a word that leads elsewhere while a contour is read.
    pub(super) fn refuse_in_contour(&self, word: &Word) -> Result<(), Alarm> {
        if self.in_contour {
            return Err(word.alarm(Code::ContourWord));
        }
        Ok(())
    }
}

fn missing(code: &Word, letter: u8) -> Alarm {
    Alarm::new(Code::ContourNumbers, code.span).word(letter)
}

fn not_there(word: &Word) -> Alarm {
    let number = word.value().whole().unwrap_or(0);
    word.alarm(Code::ContourMissing).with([Arg::Int(number)])
}
