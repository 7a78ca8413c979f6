//! From the number of a word to a quantity: millimetres or inches, input increments, printed ranges.

use super::block::Word;
use crate::alarm::{Alarm, Arg, At, Code};
use crate::units::{
    Angle, Decimal, DecimalError, Diameter, Feed, FeedPerTurn, Lead, LeadChange, Length, Millis,
};

/// The input system in force: G20 or G21, IS-B or IS-C.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Scale {
    inch: bool,
    /// Decimals of the input increment.
    decimals: u8,
    /// The input increment in nanometres: even, so that half a diameter is exact.
    step_nm: i64,
    /// Decimals of the increment of a rotary axis, and that increment in µ°.
    angle_decimals: u8,
    step_udeg: i64,
}

/// A printed range, in input increments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Range {
    low: i64,
    high: i64,
}

impl Range {
    pub(crate) const fn new(low: i64, high: i64) -> Self {
        Self { low, high }
    }

    /// 0 … 99 999 999 increments: G76's J K, G75's R(Δd), all P and Q ([G75 sheet], [G76 sheet]).
    pub(crate) const EIGHT_DIGITS: Self = Self::new(0, 99_999_999);
    /// ± the same: R(i) of G76.
    pub(crate) const SIGNED_EIGHT_DIGITS: Self = Self::new(-99_999_999, 99_999_999);
    /// 0 … 999 999 999 increments: the distances of the [G78 sheet].
    pub(crate) const NINE_DIGITS: Self = Self::new(0, 999_999_999);
    /// ± the same: R(i) of G78.
    pub(crate) const SIGNED_NINE_DIGITS: Self = Self::new(-999_999_999, 999_999_999);
}

impl Scale {
    /// True for inches.
    pub(crate) const fn is_inch(&self) -> bool {
        self.inch
    }

    pub(crate) const fn new(inch: bool, is_c: bool) -> Self {
        let (decimals, step_nm) = match (inch, is_c) {
            (false, false) => (3, 1_000),
            (false, true) => (4, 100),
            (true, false) => (4, 2_540),
            (true, true) => (5, 254),
        };
        Self {
            inch,
            decimals,
            step_nm,
            angle_decimals: if is_c { 4 } else { 3 },
            step_udeg: if is_c { 100 } else { 1_000 },
        }
    }

    const fn is_c(&self) -> bool {
        self.angle_decimals == 4
    }

    /// The input increment.
    pub(crate) const fn increment(&self) -> Length {
        Length::from_nm(self.step_nm)
    }

    /// R(d) of G76 and R(e) of G75: 0–99.999 (IS-B), 0–99.9999 (IS-C).
    pub(crate) const fn small(&self) -> Range {
        Range::new(0, if self.is_c() { 999_999 } else { 99_999 })
    }

    /// Q(Δdmin) of G76: 0–999999 (IS-B), 0–9999999 (IS-C) increments.
    pub(crate) const fn min_step(&self) -> Range {
        Range::new(0, if self.is_c() { 9_999_999 } else { 999_999 })
    }

    /// An axis word, I, K or R of an arc: any length within ±2⁴² nm.
    #[inline]
    pub(crate) fn length(&self, word: &Word) -> Result<Length, Alarm> {
        match word.value.scaled(self.decimals) {
            Ok(count) => {
                let length = Length::from_nm(count.saturating_mul(self.step_nm));
                if length.is_in_range() {
                    Ok(length)
                } else {
                    Err(self.too_far(word))
                }
            }
            Err(error) => Err(self.refused(word, error)),
        }
    }

    /// An X word: the radius.
    #[inline]
    pub(crate) fn radius(&self, word: &Word) -> Result<Length, Alarm> {
        Ok(Diameter::from_nm(self.length(word)?.nm()).radius())
    }

    /// A C word.
    #[inline]
    pub(crate) fn angle(&self, word: &Word) -> Result<Angle, Alarm> {
        const LIMIT: i64 = Length::INPUT_LIMIT.nm();
        let count = match word.value.scaled(self.angle_decimals) {
            Ok(count) => count,
            Err(DecimalError::Inexact) => return Err(beyond_increment(word, self.angle_decimals)),
            Err(DecimalError::TooLarge) => i64::MAX,
        };
        let udeg = count.saturating_mul(self.step_udeg);
        if udeg.unsigned_abs() > LIMIT.unsigned_abs() {
            let limit = |udeg| Arg::Angle(Angle::from_udeg(udeg));
            return Err(word.out_of_range(limit(LIMIT.wrapping_neg()), limit(LIMIT)));
        }
        Ok(Angle::from_udeg(udeg))
    }

    /// A distance of a cycle in millimetres or inches, within a printed range.
    pub(crate) fn distance(&self, word: &Word, range: Range) -> Result<At<Length>, Alarm> {
        match word.value.scaled(self.decimals) {
            Ok(count) => self.in_range(word, count, range, self.decimals),
            Err(error) => Err(self.refused(word, error)),
        }
    }

    /// A distance of a cycle counted in input increments: no point.
    pub(crate) fn increments(&self, word: &Word, range: Range) -> Result<At<Length>, Alarm> {
        if word.value.has_point() {
            let shown = word.value.scaled(self.decimals);
            let args = match shown {
                // No such length is possible: what is written is a count already.
                Ok(count) if count > range.high => return Err(word.alarm(Code::PointInInteger)),
                Ok(count) => [Arg::Int(count), Arg::None, Arg::None, Arg::None],
                Err(error) => return Err(self.refused(word, error)),
            };
            return Err(word.alarm(Code::PointInIncrements).with(args));
        }
        self.in_range(word, word.value.mantissa(), range, 0)
    }

    /// `shown`: decimals in which the word is written, and so the range of its alarm.
    fn in_range(
        &self,
        word: &Word,
        count: i64,
        range: Range,
        shown: u8,
    ) -> Result<At<Length>, Alarm> {
        if count < range.low || count > range.high {
            return Err(word.out_of_range(
                Arg::Decimal(range.low, shown),
                Arg::Decimal(range.high, shown),
            ));
        }
        // At most 10⁹ increments of 2 540 nm.
        let length = Length::from_nm(count.saturating_mul(self.step_nm));
        Ok(At::new(length, word.span))
    }

    /// F as a path speed under G98.
    #[inline]
    pub(crate) fn feed(&self, word: &Word) -> Result<Feed, Alarm> {
        self.feed_nm(word).map(Feed::from_nm_per_min)
    }

    /// F as a path feed under G99.
    #[inline]
    pub(crate) fn feed_per_turn(&self, word: &Word) -> Result<FeedPerTurn, Alarm> {
        self.feed_nm(word).map(FeedPerTurn::from_nm)
    }

    #[inline]
    fn feed_nm(&self, word: &Word) -> Result<i64, Alarm> {
        // A nanometre a minute or turn; in inches the smallest decimal that is whole nanometres.
        let (decimals, step, limit, most) = if self.inch {
            (5, 254, 99_999, 99_999 * 25_400_000)
        } else {
            (6, 1, 999_999, 999_999 * 1_000_000)
        };
        let count = match word.value.scaled(decimals) {
            Ok(count) => count,
            Err(DecimalError::Inexact) => return Err(beyond_increment(word, decimals)),
            Err(DecimalError::TooLarge) => i64::MAX,
        };
        let nm = count.saturating_mul(step);
        if nm <= 0 || nm > most {
            return Err(word.out_of_range(Arg::Decimal(1, decimals), Arg::Int(limit)));
        }
        Ok(nm)
    }

    /// F of a thread: millimetres or inches a turn ([G78 sheet]: 0.0001–9999, inch 0.00001–9.99).
    pub(crate) fn lead(&self, word: &Word) -> Result<At<Lead>, Alarm> {
        let (low, high) = if self.inch {
            (Decimal::new(1, 5), Decimal::new(999, 2))
        } else {
            (Decimal::new(1, 4), Decimal::new(9999, 0))
        };
        let millionths = millionths(word, low, high)?;
        // An inch is 25.4 million nanometres.
        let lead = if self.inch {
            Lead::new(millionths.saturating_mul(254), 10)
        } else {
            Lead::new(millionths, 1)
        };
        in_lead_range(word, lead, low, high)
    }

    /// K of G34: millimetres or inches a turn, with a sign (±500, inch ±9.999999).
    pub(crate) fn lead_change(&self, word: &Word) -> Result<At<LeadChange>, Alarm> {
        const INCH: i64 = 9_999_999;
        let (pm, most) = if self.inch {
            // A millionth of an inch is 25.4 nanometres.
            (25_400, INCH)
        } else {
            (1000, LeadChange::LIMIT.pm() / 1000)
        };
        match word.value.scaled(6) {
            Ok(count) if count.saturating_abs() <= most => {
                let change = LeadChange::from_pm(count.saturating_mul(pm));
                Ok(At::new(change, word.span))
            }
            Err(DecimalError::Inexact) => Err(beyond_increment(word, 6)),
            _ => Err(word.out_of_range(
                Arg::Decimal(most.saturating_neg(), 6),
                Arg::Decimal(most, 6),
            )),
        }
    }

    /// The range of F in a thread, as figures.
    pub(crate) const fn lead_range(&self) -> [Arg; 2] {
        if self.inch {
            [Arg::Decimal(1, 5), Arg::Decimal(999, 2)]
        } else {
            [Arg::Decimal(1, 4), Arg::Int(9999)]
        }
    }

    /// I of a thread: turns to an inch ([G78 sheet]: 0.0001–254, inch 0.0001–100).
    pub(crate) fn turns_per_inch(&self, word: &Word) -> Result<At<Lead>, Alarm> {
        let high = Decimal::new(if self.inch { 100 } else { 254 }, 0);
        let low = Decimal::new(1, 4);
        let millionths = millionths(word, low, high)?;
        let lead = Lead::new(25_400_000 * 1_000_000, millionths);
        in_lead_range(word, lead, low, high)
    }

    #[cold]
    fn refused(&self, word: &Word, error: DecimalError) -> Alarm {
        match error {
            DecimalError::Inexact => beyond_increment(word, self.decimals),
            DecimalError::TooLarge => self.too_far(word),
        }
    }

    #[cold]
    fn too_far(&self, word: &Word) -> Alarm {
        let limit = Length::INPUT_LIMIT;
        word.out_of_range(Arg::Length(-limit), Arg::Length(limit))
    }
}

/// X or U of G04: seconds, exact to the millisecond.
pub(crate) fn seconds(word: &Word) -> Result<Millis, Alarm> {
    const LIMIT: i64 = 99_999_999;
    match word.value.scaled(3) {
        Ok(ms) if (0..=LIMIT).contains(&ms) => Ok(Millis::new(ms as u32)),
        Err(DecimalError::Inexact) => Err(beyond_increment(word, 3)),
        _ => Err(word.out_of_range(Arg::Int(0), Arg::Decimal(LIMIT, 3))),
    }
}

#[cold]
fn beyond_increment(word: &Word, decimals: u8) -> Alarm {
    let args = [Arg::Decimal(1, decimals), Arg::None, Arg::None, Arg::None];
    word.alarm(Code::DigitBeyondIncrement).with(args)
}

/// The number of a lead word in millionths, `low` … `high`.
fn millionths(word: &Word, low: Decimal, high: Decimal) -> Result<i64, Alarm> {
    match word.value.scaled(6) {
        Ok(count) if at_least(count, low) && at_most(count, high) => Ok(count),
        Err(DecimalError::Inexact) => Err(beyond_increment(word, 6)),
        _ => Err(lead_alarm(word, low, high)),
    }
}

fn at_least(millionths: i64, low: Decimal) -> bool {
    low.scaled(6).is_ok_and(|low| millionths >= low)
}

fn at_most(millionths: i64, high: Decimal) -> bool {
    high.scaled(6).is_ok_and(|high| millionths <= high)
}

fn in_lead_range(
    word: &Word,
    lead: Option<Lead>,
    low: Decimal,
    high: Decimal,
) -> Result<At<Lead>, Alarm> {
    lead.map(|lead| At::new(lead, word.span))
        .ok_or_else(|| lead_alarm(word, low, high))
}

#[cold]
fn lead_alarm(word: &Word, low: Decimal, high: Decimal) -> Alarm {
    word.alarm(Code::LeadMissing).with([
        Arg::Decimal(low.mantissa(), low.decimals()),
        Arg::Decimal(high.mantissa(), high.decimals()),
    ])
}
