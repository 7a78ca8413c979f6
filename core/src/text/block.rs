//! One block: its words by letter, each with its place, and its G and M codes by group.
//!
//! Refuses what is wrong whatever the words mean: a word twice, two codes of one group, X with U, a code or an address
//! that does not exist. Knows nothing of modal state.

use super::codes::{Group, Known, MGroup, g_code, m_code};
use super::plan::FUNCTIONS;
use crate::alarm::{Alarm, Arg, Code, Span};
use crate::units::Decimal;

/// A word of the program text: its letter, number and place.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Word {
    pub(crate) letter: u8,
    pub(crate) value: Decimal,
    pub(crate) span: Span,
}

impl Word {
    /// An alarm that blames this word.
    #[cold]
    pub(crate) fn alarm(&self, code: Code) -> Alarm {
        Alarm::new(code, self.span).word(self.letter)
    }

    /// Refuses a minus where the sheets print "unsigned".
    pub(crate) fn not_negative(&self) -> Result<(), Alarm> {
        if self.value.mantissa() < 0 {
            return Err(self.alarm(Code::Negative));
        }
        Ok(())
    }

    /// The number of a word that is a count, 0 … `max`.
    ///
    /// # Errors
    /// A point, a sign, or a number beyond `max`.
    pub(crate) fn count(&self, max: u32) -> Result<u32, Alarm> {
        if self.value.has_point() {
            return Err(self.alarm(Code::PointInInteger));
        }
        if self.value.has_sign() {
            return Err(self.alarm(Code::SignInInteger));
        }
        match u32::try_from(self.value.mantissa()) {
            Ok(number) if number <= max => Ok(number),
            _ => Err(self.out_of_range(Arg::Int(0), Arg::Int(i64::from(max)))),
        }
    }

    /// The alarm for a number outside `low` … `high`.
    #[cold]
    pub(crate) fn out_of_range(&self, low: Arg, high: Arg) -> Alarm {
        self.alarm(Code::WordOutOfRange).with([low, high])
    }
}

/// A set of letters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Letters(u32);

impl Letters {
    /// The letters of `text`, all `A` … `Z`.
    pub(crate) const fn of(text: &[u8]) -> Self {
        let mut set = 0;
        let mut rest = text;
        while let [letter, tail @ ..] = rest {
            set |= Self::one(*letter).0;
            rest = tail;
        }
        Self(set)
    }

    const fn one(letter: u8) -> Self {
        Self(1 << (letter.wrapping_sub(b'A') & 31))
    }

    pub(crate) const fn and(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    pub(crate) const fn without(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }

    pub(crate) const fn common(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }

    pub(crate) const fn is_empty(self) -> bool {
        self.0 == 0
    }

    pub(crate) const fn contains_all(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }
}

/// Letters a word of this control can have, G and M aside.
const ADDRESSES: Letters = Letters::of(b"CDEFHIJKLNOPQRSTUWXZ");
/// Words that do not depend on the G codes.
const ALWAYS: Letters = Letters::of(b"NOSTF");
/// Letters that name a block or a program.
const NAMES: Letters = Letters::of(b"NO");
/// The most M words without a meaning of their own behind the first one.
const MORE: usize = FUNCTIONS - 1;
/// Words that exclude each other: absolute and increment of one axis.
const PAIRS: [(u8, u8); 3] = [(b'X', b'U'), (b'Z', b'W'), (b'C', b'H')];

/// The content of the slot of a letter or a group.
#[derive(Clone, Copy, Debug, Default)]
struct Slot {
    value: Decimal,
    column: u16,
    end: u16,
}

/// The words of one block. Slots keep old content. The sets say which slots are filled, so clearing a block costs nothing.
#[derive(Clone, Debug)]
pub(crate) struct Block {
    line: u32,
    /// The M code of rigid tapping.
    rigid: u8,
    present: Letters,
    groups: u16,
    m_groups: u8,
    /// Place of the first word that is not N.
    lead: (u16, u16),
    words: [Slot; 26],
    g: [Slot; Group::COUNT],
    m: [Slot; MGroup::COUNT],
    /// Codes without a meaning of their own, behind the first one of the block.
    more: [Slot; MORE],
    more_count: u8,
}

impl Block {
    /// An empty block; `rigid` is the M code of rigid tapping.
    pub(crate) const fn new(rigid: u8) -> Self {
        const EMPTY: Slot = Slot {
            value: Decimal::new(0, 0),
            column: 0,
            end: 0,
        };
        Self {
            line: 0,
            rigid,
            present: Letters(0),
            groups: 0,
            m_groups: 0,
            lead: (0, 0),
            words: [EMPTY; 26],
            g: [EMPTY; Group::COUNT],
            m: [EMPTY; MGroup::COUNT],
            more: [EMPTY; MORE],
            more_count: 0,
        }
    }

    /// Turns this block into the empty block of `line`.
    #[inline]
    pub(crate) fn clear(&mut self, line: u32) {
        self.line = line;
        self.present = Letters(0);
        self.groups = 0;
        self.m_groups = 0;
        self.more_count = 0;
        self.lead = (0, 0);
    }

    /// True without any word.
    #[inline]
    pub(crate) const fn is_empty(&self) -> bool {
        self.present.is_empty() && self.lead.0 == 0
    }

    /// True without any word but N.
    #[inline]
    pub(crate) const fn has_no_lead(&self) -> bool {
        self.lead.0 == 0
    }

    /// Letters of the words, G and M aside.
    #[inline]
    pub(crate) const fn letters(&self) -> Letters {
        self.present
    }

    /// The first word that is not N.
    pub(crate) const fn lead(&self) -> Span {
        Span {
            line: self.line,
            column: self.lead.0,
            end: self.lead.1,
        }
    }

    /// Takes in one word.
    #[inline]
    pub(crate) fn add(
        &mut self,
        letter: u8,
        value: Decimal,
        column: u16,
        end: u16,
    ) -> Result<(), Alarm> {
        let set = Letters::one(letter);
        let new = set.common(ADDRESSES).without(self.present);
        if new.is_empty() {
            return self.add_code(letter, Slot { value, column, end });
        }
        if !new.common(NAMES).is_empty() {
            let first = if letter == b'N' {
                self.is_empty()
            } else {
                self.has_no_lead()
            };
            if !first {
                let slot = Slot { value, column, end };
                return Err(self.word(letter, &slot).alarm(Code::WordNotFirst));
            }
        }
        if letter != b'N' {
            self.mark(column, end);
        }
        self.present = self.present.and(set);
        if let Some(place) = self.words.get_mut(usize::from(letter.wrapping_sub(b'A'))) {
            *place = Slot { value, column, end };
        }
        Ok(())
    }

    /// Takes in a word that fills no free slot of a letter: a G word, an M word, or a word to refuse.
    fn add_code(&mut self, letter: u8, slot: Slot) -> Result<(), Alarm> {
        self.mark(slot.column, slot.end);
        match letter {
            b'G' => self.add_g(slot),
            b'M' => self.add_m(slot),
            _ if Letters::one(letter).common(ADDRESSES).is_empty() => {
                Err(self.word(letter, &slot).alarm(Code::UnknownAddress))
            }
            _ => Err(self.word(letter, &slot).alarm(Code::WordTwice)),
        }
    }

    /// Refuses an axis given both ways.
    #[inline]
    pub(crate) fn check_pairs(&self) -> Result<(), Alarm> {
        const INCREMENTS: Letters = Letters::of(b"UWH");
        if self.present.common(INCREMENTS).is_empty() {
            return Ok(());
        }
        for (absolute, increment) in PAIRS {
            if let (Some(a), Some(b)) = (self.find(absolute), self.find(increment)) {
                let later = if a.span.column > b.span.column { a } else { b };
                let args = [
                    Arg::Letter(absolute),
                    Arg::Letter(increment),
                    Arg::None,
                    Arg::None,
                ];
                return Err(later.alarm(Code::AbsoluteAndIncrement).with(args));
            }
        }
        Ok(())
    }

    #[inline]
    fn mark(&mut self, column: u16, end: u16) {
        if self.lead.0 == 0 {
            self.lead = (column, end);
        }
    }

    fn word(&self, letter: u8, slot: &Slot) -> Word {
        Word {
            letter,
            value: slot.value,
            span: Span {
                line: self.line,
                column: slot.column,
                end: slot.end,
            },
        }
    }

    #[inline]
    fn add_g(&mut self, slot: Slot) -> Result<(), Alarm> {
        let word = self.word(b'G', &slot);
        let code = i64::from(word.count(u32::MAX)?);
        let named = [g_arg(code), Arg::None, Arg::None, Arg::None];
        let group = match g_code(code) {
            Known::Yes(group) => group,
            Known::NotYet => return Err(word.alarm(Code::GNotAvailable).with(named)),
            Known::Tapping => return Err(word.alarm(Code::G33Tapping)),
            Known::No => return Err(word.alarm(Code::UnknownG).with(named)),
        };
        if let Some(first) = self.g(group) {
            // The same again says nothing new [D568].
            if first.value.mantissa() == code {
                return Ok(());
            }
            let args = [
                g_arg(first.value.mantissa()),
                g_arg(code),
                Arg::None,
                Arg::None,
            ];
            return Err(word.alarm(Code::GroupTwice).with(args));
        }
        self.groups |= group.bit();
        if let Some(place) = self.g.get_mut(group as usize) {
            *place = slot;
        }
        Ok(())
    }

    fn add_m(&mut self, slot: Slot) -> Result<(), Alarm> {
        let word = self.word(b'M', &slot);
        let code = i64::from(word.count(u32::MAX)?);
        let named = [Arg::Int(code), Arg::None, Arg::None, Arg::None];
        let group = match m_code(code, self.rigid) {
            Known::Yes(group) => group,
            _ => return Err(word.alarm(Code::MNotAvailable).with(named)),
        };
        if let Some(first) = self.m(group) {
            let differs = |word: Word| word.value.mantissa() != code;
            if group == MGroup::Clamp
                && self.free_m().all(differs)
                && let Some(place) = self.more.get_mut(usize::from(self.more_count))
            {
                *place = slot;
                self.more_count = self.more_count.saturating_add(1);
                return Ok(());
            }
            if group != MGroup::Clamp && !differs(first) {
                return Ok(());
            }
            let args = [
                Arg::Int(first.value.mantissa()),
                Arg::Int(code),
                Arg::None,
                Arg::None,
            ];
            return Err(word.alarm(Code::MGroupTwice).with(args));
        }
        self.m_groups |= group.bit();
        if let Some(place) = self.m.get_mut(group as usize) {
            *place = slot;
        }
        Ok(())
    }

    /// The word of a letter.
    #[inline]
    pub(crate) fn find(&self, letter: u8) -> Option<Word> {
        if self.present.common(Letters::one(letter)).is_empty() {
            return None;
        }
        let slot = self.words.get(usize::from(letter.wrapping_sub(b'A')))?;
        Some(self.word(letter, slot))
    }

    /// True where a word of one of these letters stands in the block.
    #[inline]
    pub(crate) const fn has_any(&self, letters: Letters) -> bool {
        !self.present.common(letters).is_empty()
    }

    /// True with a G word of any of these groups.
    #[inline]
    pub(crate) const fn has_groups(&self, groups: u16) -> bool {
        self.groups & groups != 0
    }

    /// The G word of a group.
    #[inline]
    pub(crate) fn g(&self, group: Group) -> Option<Word> {
        if !self.has_groups(group.bit()) {
            return None;
        }
        let slot = self.g.get(group as usize)?;
        Some(self.word(b'G', slot))
    }

    /// True with any M word.
    #[inline]
    pub(crate) const fn has_m(&self) -> bool {
        self.m_groups != 0
    }

    /// True with an M word of any of these groups.
    #[inline]
    pub(crate) const fn has_m_groups(&self, groups: u8) -> bool {
        self.m_groups & groups != 0
    }

    /// The M word of a group.
    #[inline]
    pub(crate) fn m(&self, group: MGroup) -> Option<Word> {
        if self.m_groups & group.bit() == 0 {
            return None;
        }
        let slot = self.m.get(group as usize)?;
        Some(self.word(b'M', slot))
    }

    /// The M word that stands last; `None` without any.
    pub(crate) fn last_m(&self) -> Option<Word> {
        let more = self.more.iter().take(usize::from(self.more_count));
        let groups = self.m.iter().zip(0_u8..);
        let written = groups.filter(|(_, group)| self.m_groups >> group & 1 != 0);
        let slots = written.map(|(slot, _)| slot).chain(more);
        let last = slots.max_by_key(|slot| slot.column)?;
        Some(self.word(b'M', last))
    }

    /// The M words without a meaning of their own, in their order.
    pub(crate) fn free_m(&self) -> impl Iterator<Item = Word> {
        let more = self.more.iter().take(usize::from(self.more_count));
        let first = self.m(MGroup::Clamp).into_iter();
        first.chain(more.map(|slot| self.word(b'M', slot)))
    }

    /// Refuses the leftmost word that nothing in the block uses.
    #[inline]
    pub(crate) fn only(&self, used: Letters) -> Result<(), Alarm> {
        let unused = self.letters().without(used.and(ALWAYS));
        if unused.is_empty() {
            return Ok(());
        }
        Err(match self.leftmost(unused) {
            Some(word) => word.alarm(Code::WordWithoutUse),
            None => Alarm::new(Code::WordWithoutUse, self.lead()),
        })
    }

    /// The leftmost word whose letter is in `letters`.
    #[cold]
    pub(crate) fn leftmost(&self, letters: Letters) -> Option<Word> {
        (b'A'..=b'Z')
            .filter(|letter| letters.contains_all(Letters::one(*letter)))
            .filter_map(|letter| self.find(letter))
            .min_by_key(|word| word.span.column)
    }
}

/// `G<code>` as a figure of an alarm.
pub(crate) fn g_arg(code: i64) -> Arg {
    match u16::try_from(code) {
        Ok(code) if code <= 999 => Arg::GCode(code.saturating_mul(10)),
        _ => Arg::Int(code),
    }
}
