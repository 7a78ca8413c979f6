//! The words of G76 and G78 ([G76 sheet], [G78 sheet]): first blocks kept per cycle [D21],
//! leads apart from feeds [D20], every word resolved or its parameter taken.

use super::block::{Block, Letters, Word};
use super::call::{CallKind, CutIn, Infeed, ThreadCall, ThreadCycle};
use super::groove::not_negative;
use super::options::Dialect;
use super::plan::Plan;
use super::run_out::Chamfer;
use super::scale::Range;
use super::state::{PLANE_AXES, State};
use crate::alarm::{Alarm, Arg, At, Code, Span};
use crate::units::{Lead, Length};

/// P(m)(r)(a): what its digits wrote.
#[derive(Clone, Copy, Debug)]
struct Digits {
    m: Option<u8>,
    r: Option<u8>,
    a: u8,
    span: Span,
}

/// First-block words of one cycle.
#[derive(Clone, Copy, Debug)]
struct First {
    p: Option<Digits>,
    min_step: Option<At<Length>>,
    allowance: Option<At<Length>>,
    infeed: Option<At<Infeed>>,
    /// J K E: for the next cycle block only.
    next: Extras,
}

/// Words that may stand in either block.
#[derive(Clone, Copy, Debug)]
struct Extras {
    j: Option<At<Length>>,
    k: Option<At<Length>>,
    e: Option<At<Length>>,
}

impl Extras {
    const NONE: Self = Self {
        j: None,
        k: None,
        e: None,
    };

    /// These words where written, else those of the first block [D5].
    fn or(self, first: Self) -> Self {
        Self {
            j: self.j.or(first.j),
            k: self.k.or(first.k),
            e: self.e.or(first.e),
        }
    }
}

/// What the threading cycles keep from block to block.
#[derive(Clone, Copy, Debug)]
pub(super) struct ThreadWords {
    g76: First,
    g78: First,
    /// F or I of the latest thread block that had one.
    lead: Option<At<Lead>>,
    /// L.
    starts: At<u8>,
    /// J and K of the latest G78 that had any: modal as words, because what they leave out follows each thread's own lead.
    run_out: (Option<At<Length>>, Option<At<Length>>),
}

impl ThreadWords {
    pub(super) const fn new() -> Self {
        const FIRST: First = First {
            p: None,
            min_step: None,
            allowance: None,
            infeed: None,
            next: Extras::NONE,
        };
        const NOWHERE: Span = Span {
            line: 0,
            column: 0,
            end: 0,
        };
        Self {
            g76: FIRST,
            g78: FIRST,
            lead: None,
            starts: At::new(1, NOWHERE),
            run_out: (None, None),
        }
    }
}

/// The words that make a block the cycle block, resolved alike for both cycles.
struct Common {
    start: super::call::Position,
    end_x: At<Length>,
    end_z: At<Length>,
    taper: At<Length>,
    height: At<Length>,
    first_depth: At<Length>,
    lead: At<Lead>,
}

fn parameter<T>(value: T) -> At<T> {
    At::new(value, Span::default())
}

impl State<'_> {
    /// A G76 block.
    pub(super) fn thread_g76(
        &mut self,
        block: &Block,
        word: &Word,
        plan: &mut Plan,
    ) -> Result<(), Alarm> {
        self.only(block, PLANE_AXES.and(Letters::of(b"PQRJKI")))?;
        self.read_lead(block)?;
        let extras = self.extras(block, Range::EIGHT_DIGITS)?;
        if !block.has_any(PLANE_AXES) {
            if let Some(p) = block.find(b'P') {
                self.thread.g76.p = Some(digits(&p)?);
            }
            if let Some(q) = block.find(b'Q') {
                not_negative(&q)?;
                self.thread.g76.min_step = Some(self.p_or_q(&q, self.scale.min_step())?);
            }
            if let Some(r) = block.find(b'R') {
                not_negative(&r)?;
                self.thread.g76.allowance = Some(self.scale.distance(&r, self.scale.small())?);
            }
            self.thread.g76.next = extras.or(self.thread.g76.next);
            return Ok(());
        }
        let common = self.common(block, word, Range::SIGNED_EIGHT_DIGITS, |p_or_q| {
            self.p_or_q(p_or_q, Range::EIGHT_DIGITS)
        })?;
        let first = self.thread.g76;
        self.thread.g76.next = Extras::NONE;
        let extras = extras.or(first.next);
        let chamfer = Chamfer {
            tenths: match first.p {
                Some(Digits {
                    r: Some(r), span, ..
                }) => At::new(r, span),
                _ => parameter(self.params.thread_chamfer()),
            },
            degrees: match self.options.dialect {
                Dialect::Gsk980td => 45,
                Dialect::Gsk988 => self.chamfer_angle(),
            },
        };
        let call = ThreadCall {
            cycle: ThreadCycle::G76,
            start: common.start,
            end_x: common.end_x,
            end_z: common.end_z,
            taper: common.taper,
            height: common.height,
            first_depth: common.first_depth,
            min_step: first
                .min_step
                .unwrap_or_else(|| parameter(self.params.thread_min_step())),
            allowance: first
                .allowance
                .unwrap_or_else(|| parameter(self.params.thread_allowance())),
            finish_passes: self.finish_passes(first.p),
            angle: self.angle(first.p),
            infeed: Infeed::Decreasing,
            cut_in: parameter(CutIn::Trailing),
            starts: parameter(1),
            run_in: parameter(Length::ZERO),
            run_out: chamfer.resolve(extras.j, extras.k, common.lead.value),
            lead: common.lead,
            increment: self.scale.increment(),
            rpm: self.rpm(),
        };
        plan.motion(word.span, CallKind::Thread(call));
        Ok(())
    }

    /// A G78 block.
    pub(super) fn thread_g78(
        &mut self,
        block: &Block,
        word: &Word,
        plan: &mut Plan,
    ) -> Result<(), Alarm> {
        self.only(block, PLANE_AXES.and(Letters::of(b"PQRJKIDLE")))?;
        self.read_lead(block)?;
        let extras = self.extras(block, Range::NINE_DIGITS)?;
        let infeed = match block.find(b'D') {
            Some(d) => Some(infeed(&d)?),
            None => None,
        };
        if let Some(l) = block.find(b'L') {
            self.thread.starts = starts(&l)?;
        }
        if !block.has_any(PLANE_AXES) {
            if let Some(p) = block.find(b'P') {
                let digits = digits(&p)?;
                if let Some(r @ 5..) = digits.r {
                    let args = [Arg::Int(i64::from(r)), Arg::None, Arg::None, Arg::None];
                    plan.warn(p.alarm(Code::CutInMode).with(args));
                }
                self.thread.g78.p = Some(digits);
            }
            if let Some(q) = block.find(b'Q') {
                not_negative(&q)?;
                self.thread.g78.min_step = Some(self.scale.distance(&q, Range::NINE_DIGITS)?);
            }
            if let Some(r) = block.find(b'R') {
                not_negative(&r)?;
                self.thread.g78.allowance = Some(self.scale.distance(&r, Range::NINE_DIGITS)?);
            }
            self.thread.g78.infeed = infeed.or(self.thread.g78.infeed);
            self.thread.g78.next = extras.or(self.thread.g78.next);
            return Ok(());
        }
        let common = self.common(block, word, Range::SIGNED_NINE_DIGITS, |p_or_q| {
            self.scale.distance(p_or_q, Range::NINE_DIGITS)
        })?;
        let first = self.thread.g78;
        self.thread.g78.next = Extras::NONE;
        let extras = extras.or(first.next);
        let chamfer = Chamfer {
            tenths: parameter(self.params.thread_chamfer()),
            degrees: self.chamfer_angle(),
        };
        if extras.j.is_some() || extras.k.is_some() {
            self.thread.run_out = (extras.j, extras.k);
        }
        let (j, k) = self.thread.run_out;
        let run_out = chamfer.resolve(j, k, common.lead.value);
        let infeed = match infeed.or(first.infeed) {
            Some(infeed) => infeed.value,
            None if self.params.thread_infeed() == 0 => Infeed::Equal,
            None => Infeed::Decreasing,
        };
        let cut_in = match first.p {
            Some(Digits {
                r: Some(r @ 0..=4),
                span,
                ..
            }) => At::new(cut_in(r), span),
            _ => parameter(cut_in(self.params.thread_cut_in())),
        };
        let call = ThreadCall {
            cycle: ThreadCycle::G78,
            start: common.start,
            end_x: common.end_x,
            end_z: common.end_z,
            taper: common.taper,
            height: common.height,
            first_depth: common.first_depth,
            min_step: first
                .min_step
                .unwrap_or_else(|| parameter(self.params.thread_min_step())),
            allowance: first
                .allowance
                .unwrap_or_else(|| parameter(self.params.thread_allowance())),
            finish_passes: self.finish_passes(first.p),
            angle: self.angle(first.p),
            infeed,
            cut_in,
            starts: self.thread.starts,
            run_in: extras.e.unwrap_or_else(|| parameter(Length::ZERO)),
            run_out,
            lead: common.lead,
            increment: self.scale.increment(),
            rpm: self.rpm(),
        };
        plan.motion(word.span, CallKind::Thread(call));
        Ok(())
    }

    /// F or I: the lead from now on.
    fn read_lead(&mut self, block: &Block) -> Result<(), Alarm> {
        let lead = match (block.find(b'F'), block.find(b'I')) {
            (None, None) => return Ok(()),
            (Some(f), Some(i)) => {
                let later = if i.span.column > f.span.column { i } else { f };
                return Err(later.alarm(Code::TwoLeads));
            }
            (Some(f), None) => self.scale.lead(&f)?,
            (None, Some(i)) => self.scale.turns_per_inch(&i)?,
        };
        self.thread.lead = Some(lead);
        Ok(())
    }

    /// J, K and E.
    fn extras(&self, block: &Block, range: Range) -> Result<Extras, Alarm> {
        let read = |letter| match block.find(letter) {
            Some(word) => {
                not_negative(&word)?;
                self.scale.distance(&word, range).map(Some)
            }
            None => Ok(None),
        };
        Ok(Extras {
            j: read(b'J')?,
            k: read(b'K')?,
            e: read(b'E')?,
        })
    }

    /// X Z R P Q and the lead of a cycle block.
    fn common(
        &self,
        block: &Block,
        word: &Word,
        taper: Range,
        depth: impl Fn(&Word) -> Result<At<Length>, Alarm>,
    ) -> Result<Common, Alarm> {
        let (end, x, z) = self.cycle_end(block)?;
        let taper = match block.find(b'R') {
            Some(r) => self.scale.distance(&r, taper)?,
            None => parameter(Length::ZERO),
        };
        let positive = |letter: u8| {
            let missing = [Arg::Letter(letter), Arg::None, Arg::None, Arg::None];
            match block.find(letter) {
                None => Err(Alarm::new(Code::ThreadDepth, word.span).with(missing)),
                Some(word) if word.value.mantissa() <= 0 => {
                    Err(word.alarm(Code::ThreadDepth).with(missing))
                }
                Some(word) => depth(&word),
            }
        };
        let lead = self.thread.lead.ok_or_else(|| {
            let [low, high] = self.scale.lead_range();
            Alarm::new(Code::LeadMissing, word.span).with([low, high])
        });
        Ok(Common {
            start: self.position,
            end_x: At::new(end.x, x),
            end_z: At::new(end.z, z),
            taper,
            height: positive(b'P')?,
            first_depth: positive(b'Q')?,
            lead: lead?,
        })
    }

    /// m, or 057/5142.
    fn finish_passes(&self, p: Option<Digits>) -> At<u8> {
        match p {
            Some(Digits {
                m: Some(m), span, ..
            }) => At::new(m, span),
            _ => parameter(self.params.thread_finish_passes()),
        }
    }

    /// a, or 058/5143.
    fn angle(&self, p: Option<Digits>) -> At<u8> {
        match p {
            Some(p) => At::new(p.a, p.span),
            None => parameter(self.params.thread_angle()),
        }
    }

    /// 5131, degrees; 0 is 45.
    fn chamfer_angle(&self) -> u8 {
        match self.params.thread_chamfer_angle() {
            0 => 45,
            degrees => degrees,
        }
    }
}

/// P(m)(r)(a) by the count of its digits.
fn digits(word: &Word) -> Result<Digits, Alarm> {
    let value = word.value;
    if value.has_point() || value.has_sign() || value.digits() > 6 {
        return Err(word.alarm(Code::PDigits));
    }
    // Below 10⁶: six digits.
    let number = value.mantissa();
    let part = |number: i64| (number % 100) as u8;
    Ok(Digits {
        m: (value.digits() > 4).then(|| part(number / 10_000)),
        r: (value.digits() > 2).then(|| part(number / 100)),
        a: part(number),
        span: word.span,
    })
}

fn infeed(word: &Word) -> Result<At<Infeed>, Alarm> {
    let infeed = match (word.value.has_point(), word.value.mantissa()) {
        (true, _) => return Err(word.alarm(Code::PointInInteger)),
        (false, 0) => Infeed::Equal,
        (false, 1) => Infeed::Decreasing,
        (false, _) => return Err(word.alarm(Code::InfeedMode)),
    };
    Ok(At::new(infeed, word.span))
}

fn starts(word: &Word) -> Result<At<u8>, Alarm> {
    match (word.value.has_point(), word.value.mantissa()) {
        (true, _) => Err(word.alarm(Code::PointInInteger)),
        (false, starts @ 1..=99) => Ok(At::new(starts as u8, word.span)),
        (false, _) => Err(word.alarm(Code::Starts)),
    }
}

/// P(r) of G78 or 5144, both 0 … 4.
fn cut_in(mode: u8) -> CutIn {
    match mode {
        0 => CutIn::Centre,
        1 => CutIn::Left,
        2 => CutIn::Right,
        3 => CutIn::RightCentre,
        _ => CutIn::LeftRight,
    }
}
