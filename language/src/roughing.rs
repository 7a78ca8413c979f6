//! The words of G70 to G73, and the moves that their contour becomes.
//!
//! Lengths are read here with the unit and the increment of the program; what has been written in a first line stays until
//! reset. This module must not know where a block stands in its text.

use leadscrew_core::alarm::{Alarm, Arg, At, Code, Span};
use leadscrew_core::params::Params;
use leadscrew_core::units::{Diameter, Length};

use crate::contour::{Allowance, Along, Axes, Contour, Cut, Repeats, Roughing, without_way_back};
use crate::dialect::Control;
use crate::plane::{Element, Point};
use crate::stock::Stock;
use crate::word::{Given, Word};

/// A contour cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cycle {
    /// G70.
    Finish,
    /// G71, G72.
    Rough(Along),
    /// G73.
    Pattern,
}

impl Cycle {
    /// The cycle of a G word.
    #[must_use]
    pub fn of(word: &Word) -> Option<Self> {
        if word.letter != b'G' {
            return None;
        }
        Some(match word.value().whole()? {
            70 => Self::Finish,
            71 => Self::Rough(Along::Z),
            72 => Self::Rough(Along::X),
            73 => Self::Pattern,
            _ => return None,
        })
    }

    /// The letters of its own words. Others, as F, S and T, are those of an ordinary block.
    #[must_use]
    pub const fn letters(self) -> &'static [u8] {
        match self {
            Self::Finish => b"PQ",
            Self::Rough(_) => b"PQUWRIJKD",
            Self::Pattern => b"PQUWRIKD",
        }
    }
}

/// The unit of a program's lengths.
#[derive(Clone, Copy, Debug)]
pub struct Unit {
    /// Decimals of the input increment.
    pub decimals: u8,
    /// The input increment in nanometres.
    pub step_nm: i64,
}

impl Unit {
    /// The length of a word.
    ///
    /// # Errors
    /// More digits than the increment has, or a length out of range.
    pub(crate) fn length(self, word: &Word) -> Result<At<Length>, Alarm> {
        let number = word.decimal(self.decimals, self.decimals);
        let count = number.and_then(|number| number.scaled(self.decimals).ok());
        let nm = count.and_then(|count| count.checked_mul(self.step_nm));
        let length = nm
            .map(Length::from_nm)
            .filter(|length| length.is_in_range());
        match length {
            Some(length) => Ok(At::new(length, word.span)),
            None => {
                let step = [Arg::Decimal(1, self.decimals)];
                Err(word.alarm(Code::DigitBeyondIncrement).with(step))
            }
        }
    }
}

/// What the first lines of the cycles have said, and how their control cuts.
#[derive(Clone, Copy, Debug, Default)]
pub struct FirstLines {
    control: Control,
    /// Those of G71 and of G72.
    rough: [RoughLine; 2],
    pattern: PatternLine,
}

/// A first line of G71 or G72.
#[derive(Clone, Copy, Debug, Default)]
struct RoughLine {
    /// Δd.
    depth: Option<At<Length>>,
    /// e.
    retract: Option<At<Length>>,
}

/// A first line of G73.
#[derive(Clone, Copy, Debug, Default)]
struct PatternLine {
    /// i.
    x: Option<At<Length>>,
    /// k.
    z: Option<At<Length>>,
    /// d.
    passes: Option<At<i64>>,
}

/// The most passes of a pattern.
const MOST_PASSES: u32 = 9999;

/// Words of a block by letter.
struct Words<'w>(&'w [Word]);

impl Words<'_> {
    fn find(&self, letter: u8) -> Option<&Word> {
        self.0.iter().find(|word| word.letter == letter)
    }

    fn length(&self, letter: u8, unit: Unit) -> Result<Option<At<Length>>, Alarm> {
        self.find(letter).map(|word| unit.length(word)).transpose()
    }

    /// A count. Programs write `R3.` too; a part of one is refused.
    fn count(&self, letter: u8, low: u32, high: u32) -> Result<Option<At<i64>>, Alarm> {
        let Some(word) = self.find(letter) else {
            return Ok(None);
        };
        let plain = Word {
            given: Given::Calculated(word.value()),
            ..*word
        };
        Ok(Some(At::new(i64::from(plain.count(low, high)?), word.span)))
    }

    /// Refuses a word that this line of the cycle does not have.
    fn without(&self, letters: &[u8]) -> Result<(), Alarm> {
        match self.0.iter().find(|word| letters.contains(&word.letter)) {
            Some(word) => Err(word.alarm(Code::WordWithoutUse)),
            None => Ok(()),
        }
    }
}

const fn index(along: Along) -> usize {
    match along {
        Along::Z => 0,
        Along::X => 1,
    }
}

impl FirstLines {
    /// Nothing has been said to this control.
    #[must_use]
    pub fn new(control: Control) -> Self {
        Self {
            control,
            ..Self::default()
        }
    }

    /// The blocks that follow are those of this control.
    pub const fn read_as(&mut self, control: Control) {
        self.control = control;
    }

    /// Takes in a first line: a block of the cycle without P and Q.
    ///
    /// # Errors
    /// A word that does not belong there, or a length that is none.
    pub fn read(&mut self, cycle: Cycle, words: &[Word], unit: Unit) -> Result<(), Alarm> {
        let words = Words(words);
        match cycle {
            Cycle::Finish => {}
            Cycle::Rough(along) => {
                let (depth, other) = match along {
                    Along::Z => (b'U', b'W'),
                    Along::X => (b'W', b'U'),
                };
                words.without(&[other, b'D', b'I', b'J', b'K'])?;
                let kept = &mut self.rough[index(along)];
                kept.depth = words.length(depth, unit)?.or(kept.depth);
                kept.retract = words.length(b'R', unit)?.or(kept.retract);
            }
            Cycle::Pattern => {
                words.without(b"IKD")?;
                let kept = &mut self.pattern;
                kept.x = words.length(b'U', unit)?.or(kept.x);
                kept.z = words.length(b'W', unit)?.or(kept.z);
                kept.passes = words.count(b'R', 1, MOST_PASSES)?.or(kept.passes);
            }
        }
        Ok(())
    }

    /// R of the block of this cycle says whether the contour has pockets, as the words of its first block do.
    fn has_pockets_by_word(&self, cycle: Cycle) -> bool {
        self.control == Control::Haas && matches!(cycle, Cycle::Rough(_))
    }

    /// R1 of a Haas.
    fn pockets(&self, cycle: Cycle, block: &[Word]) -> Result<bool, Alarm> {
        if !self.has_pockets_by_word(cycle) {
            return Ok(false);
        }
        Ok(Words(block)
            .count(b'R', 0, 1)?
            .is_some_and(|r| r.value == 1))
    }

    /// The figures of a cycle: from its own block, where that is the one-line form (D), else from its first line, else from
    /// the parameters.
    fn figures(
        &self,
        cycle: Cycle,
        block: &[Word],
        unit: Unit,
        params: &Params,
        span: Span,
    ) -> Result<Figures, Alarm> {
        let retract_feeds = self.control.retract_feeds();
        let words = Words(block);
        let given = |length| At::new(length, Span::default());
        let allowance = Allowance {
            x: Diameter::from_nm(words.length(b'U', unit)?.map_or(0, |u| u.value.nm())),
            z: words.length(b'W', unit)?.map_or(Length::ZERO, |w| w.value),
        };
        let one_line = words.find(b'D').is_some();
        let rough = matches!(cycle, Cycle::Rough(_));
        if !one_line && rough && self.control.is_gsk() {
            let of_gsk = |word: &&Word| matches!(word.letter, b'I' | b'J' | b'K');
            if let Some(word) = block.iter().find(of_gsk) {
                return Err(word.alarm(Code::RoughWordOfGsk));
            }
        }
        if rough {
            words.without(b"J")?;
        } else if !one_line {
            words.without(b"IK")?;
        }
        if !self.has_pockets_by_word(cycle) {
            words.without(b"R")?;
        }
        Ok(match cycle {
            Cycle::Finish => Figures::Finish(span),
            Cycle::Rough(along) => {
                let RoughLine { depth, retract } = self.rough[index(along)];
                let depth = if one_line {
                    words.length(b'D', unit)?
                } else {
                    depth
                };
                Figures::Rough(
                    along,
                    Roughing {
                        depth: depth.unwrap_or_else(|| given(params.rough_depth())),
                        retract: retract.unwrap_or_else(|| given(params.rough_retract())),
                        retract_feeds,
                        allowance,
                        left: Allowance {
                            x: words.length(b'I', unit)?.map_or(Diameter::from_nm(0), |i| {
                                Diameter::from_nm(i.value.nm().saturating_mul(2))
                            }),
                            z: words.length(b'K', unit)?.map_or(Length::ZERO, |k| k.value),
                        },
                        semi_finish: true,
                        tolerance: Length::ZERO,
                        span,
                    },
                )
            }
            Cycle::Pattern => {
                let PatternLine { x, z, passes } = if one_line {
                    PatternLine {
                        x: words.length(b'I', unit)?,
                        z: words.length(b'K', unit)?,
                        passes: words.count(b'D', 1, MOST_PASSES)?,
                    }
                } else {
                    self.pattern
                };
                let written = passes.unwrap_or_else(|| {
                    At::new(i64::from(params.pattern_passes()), Span::default())
                });
                Figures::Pattern(Repeats {
                    x: x.map_or_else(|| params.pattern_x(), |x| x.value),
                    z: z.map_or_else(|| params.pattern_z(), |z| z.value),
                    passes: written,
                    allowance,
                    span,
                })
            }
        })
    }
}

/// A cycle with its figures.
#[derive(Clone, Copy, Debug)]
enum Figures {
    /// The place of its code.
    Finish(Span),
    Rough(Along, Roughing),
    Pattern(Repeats),
}

/// Deeper cuts are hardly meant.
const DEEPEST_NM: i64 = 10_000_000;
/// Strokes of a cycle that are not asked about.
const MOST_STROKES: i64 = crate::steps::MOST as i64;

/// How far a contour reaches below and above the place where the tool begins, in nanometres; both are 0 or more.
#[derive(Clone, Copy, Debug)]
struct Reach {
    below: i64,
    above: i64,
}

impl Reach {
    fn of(start: Length, ends: impl Iterator<Item = Length>) -> Self {
        let mut reach = Self { below: 0, above: 0 };
        for end in ends {
            let way = end.nm() - start.nm();
            reach = Self {
                below: reach.below.max(-way),
                above: reach.above.max(way),
            };
        }
        reach
    }

    /// True for an allowance that leads from the tool's side into the part, where the tool has one side.
    const fn is_against(self, allowance: i64) -> bool {
        (self.above == 0 && self.below > 0 && allowance < 0)
            || (self.below == 0 && self.above > 0 && allowance > 0)
    }

    /// The way of the strokes to the end of the contour that is farthest from the start.
    fn longest(self) -> i64 {
        self.below.max(self.above)
    }

    /// How far the tool stands inside.
    fn inside(self) -> i64 {
        self.below.min(self.above)
    }
}

/// A contour that is being collected for its cycle.
#[derive(Clone, Debug)]
pub struct Collected {
    figures: Figures,
    start: Point,
    axes: Option<Axes>,
    /// The block of the cycle says that there are pockets: the first block need not.
    pockets: bool,
    elements: Vec<Element>,
}

impl Collected {
    /// The block of a cycle, with P and Q.
    ///
    /// # Errors
    /// A word that does not belong there, or a length that is none.
    pub fn new(
        cycle: Cycle,
        words: &[Word],
        first: &FirstLines,
        unit: Unit,
        params: &Params,
        span: Span,
        start: Point,
    ) -> Result<Self, Alarm> {
        Ok(Self {
            figures: first.figures(cycle, words, unit, params, span)?,
            start,
            axes: None,
            pockets: first.pockets(cycle, words)?,
            elements: Vec::new(),
        })
    }

    /// The blocks of the contour are cut as they are read: G70.
    #[must_use]
    pub const fn is_finish(&self) -> bool {
        matches!(self.figures, Figures::Finish(_))
    }

    /// The place of the cycle's code.
    #[must_use]
    pub const fn span(&self) -> Span {
        match &self.figures {
            Figures::Finish(span) => *span,
            Figures::Rough(_, words) => words.span,
            Figures::Pattern(words) => words.span,
        }
    }

    /// Where the tool stood before the cycle.
    #[must_use]
    pub const fn start(&self) -> Point {
        self.start
    }

    /// The next block has these letters, and perhaps a G00 or G01 of its own; only those of the first block count.
    ///
    /// # Errors
    /// [`Code::ContourFirst`] where the first block goes on with the motion in force: that is another one in G70 than in
    /// the cycle before it [D541].
    pub fn block(
        &mut self,
        letters: impl Iterator<Item = u8>,
        is_straight: bool,
        span: Span,
    ) -> Result<(), Alarm> {
        if self.axes.is_none() {
            if !is_straight {
                return Err(Alarm::new(Code::ContourFirst, span));
            }
            let mut axes = Axes {
                x: self.pockets,
                z: self.pockets,
            };
            for letter in letters {
                axes.x |= matches!(letter, b'X' | b'U');
                axes.z |= matches!(letter, b'Z' | b'W');
            }
            self.axes = Some(axes);
        }
        Ok(())
    }

    /// Adds a piece of the contour. One more than a contour may have is kept, so that the alarm can name it.
    pub fn push(&mut self, element: Element) {
        if self.elements.len() <= Contour::MAX {
            self.elements.push(element);
        }
    }

    /// Leaves out rapids at the end of the contour of G71 or G72 that lead back clear of it; what is to be told then.
    pub fn leave_out_way_back(&mut self) -> Option<Alarm> {
        let Figures::Rough(along, _) = self.figures else {
            return None;
        };
        let kept = without_way_back(self.start, self.axes?, along, &self.elements)?;
        let told = Alarm::new(Code::ContourWayBack, self.elements.get(kept)?.span);
        self.elements.truncate(kept);
        Some(told)
    }

    /// What looks wrong about the cycle, though it can be cut [D252]: its depth beside the declared stock, too [D275].
    #[must_use]
    pub fn doubts(&self, stock: Option<&Stock>) -> Vec<Alarm> {
        let (allowance, depth) = match &self.figures {
            Figures::Finish(_) => return Vec::new(),
            Figures::Rough(_, words) => (words.allowance, Some(words.depth)),
            Figures::Pattern(words) => (words.allowance, None),
        };
        let span = self.span();
        let ends = || self.elements.iter().map(|element| element.end);
        let x = Reach::of(self.start.x, ends().map(|end| end.x));
        let z = Reach::of(self.start.z, ends().map(|end| end.z));
        let mut doubts = Vec::new();
        let mut odd = |letter, length, span| {
            let alarm = Alarm::new(Code::AllowanceOdd, span);
            doubts.push(alarm.word(letter).with([length]));
        };
        let wall = self.wall_that_is_cut();
        if x.is_against(allowance.x.nm()) || wall == Some(Along::X) {
            odd(b'U', Arg::Diameter(allowance.x), span);
        }
        if z.is_against(allowance.z.nm()) || wall == Some(Along::Z) {
            odd(b'W', Arg::Length(allowance.z), span);
        }
        let letter = match self.figures {
            Figures::Rough(Along::X, _) => b'W',
            _ => b'U',
        };
        let half = match (stock, &self.figures) {
            (Some(stock), Figures::Rough(Along::Z, _)) => (stock.outside - stock.bore) / 2,
            (Some(stock), Figures::Rough(Along::X, _)) => stock.length / 2,
            _ => DEEPEST_NM,
        };
        let most = half.min(DEEPEST_NM);
        let place = |depth: At<Length>| {
            if depth.span == Span::default() {
                span
            } else {
                depth.span
            }
        };
        if let Some(depth) = depth.filter(|depth| depth.value.nm() > most) {
            odd(letter, Arg::Length(depth.value), place(depth));
        }
        let way = match self.figures {
            Figures::Rough(Along::X, _) => z.longest(),
            _ => x.longest(),
        };
        if let Some(depth) = depth.filter(|depth| way / depth.value.nm().max(1) > MOST_STROKES) {
            odd(letter, Arg::Length(depth.value), place(depth));
        }
        let further = match self.figures {
            Figures::Rough(Along::X, _) => z.inside(),
            Figures::Rough(Along::Z, _) => x.inside(),
            // A pattern may begin in front of its middle, or beside it, but not in both.
            _ => x.inside().min(z.inside()),
        };
        if further > 0 {
            let further = Arg::Length(Length::from_nm(further));
            doubts.push(Alarm::new(Code::StartInContour, span).with([further]));
        }
        doubts
    }

    /// Refuses a depth that takes everything in one stroke and is a number in another unit: far more than there is to cut,
    /// and more than tools take [D572].
    ///
    /// # Errors
    /// [`Code::ContourDepth`] with the depth.
    pub fn refuse_depth(&self) -> Result<(), Alarm> {
        const TIMES: i64 = 10;
        let Figures::Rough(along, words) = &self.figures else {
            return Ok(());
        };
        let way = match along {
            Along::X => Reach::of(self.start.z, self.elements.iter().map(|cut| cut.end.z)),
            Along::Z => Reach::of(self.start.x, self.elements.iter().map(|cut| cut.end.x)),
        };
        let depth = words.depth.value;
        if depth.nm() <= way.longest().saturating_mul(TIMES).max(DEEPEST_NM) {
            return Ok(());
        }
        let span = match words.depth.span {
            span if span == Span::default() => self.span(),
            span => span,
        };
        let letter = match along {
            Along::X => b'W',
            Along::Z => b'U',
        };
        let alarm = Alarm::new(Code::ContourDepth, span).word(letter);
        Err(alarm.with([Arg::Length(depth)]))
    }

    /// The strokes of G71 or G72 whose allowance leads into a wall of a pocket: the last pass would cut that too deep.
    fn wall_that_is_cut(&self) -> Option<Along> {
        let Figures::Rough(along, words) = &self.figures else {
            return None;
        };
        let contour = Contour::new(self.start, self.axes?, self.elements.clone()).ok()?;
        let cuts = contour.rough(*along, words).ok()?.cuts_into_a_wall();
        cuts.then_some(*along)
    }

    /// Hands the moves of the cycle to `each`.
    ///
    /// # Errors
    /// What the contour or the figures forbid, before the first move; the first error that `each` returns.
    pub fn moves(self, mut each: impl FnMut(&Cut) -> Result<(), Alarm>) -> Result<(), Alarm> {
        let axes = self.axes.unwrap_or(Axes { x: false, z: false });
        let contour = Contour::new(self.start, axes, self.elements)?;
        match &self.figures {
            Figures::Finish(_) => Ok(()),
            Figures::Rough(along, words) => {
                let mut moves = contour.rough(*along, words)?;
                moves.try_for_each(|cut| each(&cut))
            }
            Figures::Pattern(words) => {
                let mut moves = contour.pattern(words)?;
                moves.try_for_each(|cut| each(&cut))
            }
        }
    }
}
