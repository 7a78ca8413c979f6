//! The words of G76 and G78 ([G76 sheet], [G78 sheet]): first blocks kept per cycle [D21], leads apart from feeds [D20],
//! every word resolved or its parameter taken. G76 and G78 have one reading; [`Rules`] says what differs. The words of
//! G92 are those of `single`.

use super::pickup::follow;
use super::run_out::{Chamfer, KeptRunOut};
use super::single::Single;
use crate::alarm::{Alarm, Arg, At, Code, Span};
use crate::call::{CallKind, ChainPart, CutIn, Infeed, ThreadCall, ThreadCycle};
use crate::text::{Block, Dialect, Letters, Modal, PLANE_AXES, Plan, Range, Word};
use crate::units::{Lead, LeadChange, Length, StartAngle};

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
pub(super) struct Extras {
    pub(super) j: Option<At<Length>>,
    pub(super) k: Option<At<Length>>,
    e: Option<At<Length>>,
}

impl Extras {
    const NONE: Self = Self {
        j: None,
        k: None,
        e: None,
    };

    /// J, K and E.
    pub(super) fn read(modal: &Modal<'_>, block: &Block, range: Range) -> Result<Self, Alarm> {
        let read = |letter| match block.find(letter) {
            Some(word) => {
                word.not_negative()?;
                modal.scale.distance(&word, range).map(Some)
            }
            None => Ok(None),
        };
        Ok(Self {
            j: read(b'J')?,
            k: read(b'K')?,
            e: read(b'E')?,
        })
    }

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
pub(crate) struct ThreadWords {
    g76: First,
    g78: First,
    /// F or I of the latest thread block that had one.
    pub(super) lead: Option<At<Lead>>,
    /// K of the latest block of G34 that had one, as long as it is in force.
    pub(super) change: Option<At<LeadChange>>,
    /// L.
    pub(super) starts: At<u8>,
    /// What G92 keeps as long as its mode lasts.
    pub(super) g92: Single,
    /// J and K of the latest G32, G78 or G92 that had any.
    pub(super) run_out: KeptRunOut,
}

impl ThreadWords {
    pub(crate) const fn new() -> Self {
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
            change: None,
            starts: At::new(1, NOWHERE),
            g92: Single::NONE,
            run_out: KeptRunOut::NONE,
        }
    }
}

pub(super) fn parameter<T>(value: T) -> At<T> {
    At::new(value, Span::default())
}

/// A cycle of two blocks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum TwoBlock {
    G76,
    G78,
}

/// What differs between the two cycles in how their words are read.
struct Rules {
    cycle: TwoBlock,
    letters: Letters,
    /// J, K, E, and the depths in the cycle's block.
    length: Range,
    taper: Range,
    /// Δdmin.
    min_step: Range,
    /// d.
    allowance: Range,
}

impl Rules {
    fn of(cycle: TwoBlock, modal: &Modal<'_>) -> Self {
        match cycle {
            TwoBlock::G76 => Self {
                cycle,
                letters: Letters::of(b"PQRJKI"),
                length: Range::EIGHT_DIGITS,
                taper: Range::SIGNED_EIGHT_DIGITS,
                min_step: modal.scale.min_step(),
                allowance: modal.scale.small(),
            },
            TwoBlock::G78 => Self {
                cycle,
                letters: Letters::of(b"PQRJKIDLE"),
                length: Range::NINE_DIGITS,
                taper: Range::SIGNED_NINE_DIGITS,
                min_step: Range::NINE_DIGITS,
                allowance: Range::NINE_DIGITS,
            },
        }
    }

    /// A depth, P or Q.
    fn depth(&self, modal: &Modal<'_>, word: &Word, range: Range) -> Result<At<Length>, Alarm> {
        match self.cycle {
            TwoBlock::G76 => modal.p_or_q(word, range),
            TwoBlock::G78 => modal.scale.distance(word, range),
        }
    }

    /// A depth of the cycle's block, which has to be there.
    fn positive(
        &self,
        modal: &Modal<'_>,
        block: &Block,
        word: &Word,
        letter: u8,
    ) -> Result<At<Length>, Alarm> {
        let missing = [Arg::Letter(letter)];
        match block.find(letter) {
            None => Err(Alarm::new(Code::ThreadDepth, word.span).with(missing)),
            Some(word) if word.value.mantissa() <= 0 => {
                Err(word.alarm(Code::ThreadDepth).with(missing))
            }
            Some(word) => self.depth(modal, &word, self.length),
        }
    }

    /// The source of what J and K leave out. G76 writes its length as P(r).
    fn chamfer(&self, modal: &Modal<'_>, p: Option<Digits>) -> Chamfer {
        match (self.cycle, p) {
            (
                TwoBlock::G76,
                Some(Digits {
                    r: Some(r), span, ..
                }),
            ) => Chamfer::plain(modal, At::new(r, span)),
            (TwoBlock::G76, _) => Chamfer::plain(modal, parameter(modal.run_out_tenths())),
            (TwoBlock::G78, _) => Chamfer {
                tenths: parameter(modal.run_out_tenths()),
                degrees: chamfer_angle(modal),
            },
        }
    }

    /// How the tool enters: P(r) of G78, or 5144.
    fn cut_in(&self, modal: &Modal<'_>, p: Option<Digits>) -> At<CutIn> {
        match (self.cycle, p) {
            (TwoBlock::G76, _) => parameter(CutIn::Trailing),
            (
                TwoBlock::G78,
                Some(Digits {
                    r: Some(r @ 0..=4),
                    span,
                    ..
                }),
            ) => At::new(cut_in(r), span),
            _ => parameter(cut_in(modal.params.thread_cut_in())),
        }
    }

    /// How depth grows: D of G78, or 5145.
    fn infeed(&self, modal: &Modal<'_>, written: Option<At<Infeed>>) -> Infeed {
        match (self.cycle, written) {
            (TwoBlock::G76, _) => Infeed::Decreasing,
            (TwoBlock::G78, Some(infeed)) => infeed.value,
            (TwoBlock::G78, None) if modal.params.thread_infeed() == 0 => Infeed::Equal,
            (TwoBlock::G78, None) => Infeed::Decreasing,
        }
    }
}

impl ThreadWords {
    /// A block of G76 or G78 (`word`): the first block, or the cycle.
    pub(crate) fn read(
        &mut self,
        cycle: TwoBlock,
        modal: &Modal<'_>,
        block: &Block,
        word: &Word,
        plan: &mut Plan,
    ) -> Result<(), Alarm> {
        let rules = Rules::of(cycle, modal);
        block.only(PLANE_AXES.and(rules.letters))?;
        self.read_lead(modal, block)?;
        let extras = Extras::read(modal, block, rules.length)?;
        let written = match block.find(b'D') {
            Some(d) => Some(infeed(&d)?),
            None => None,
        };
        if let Some(l) = block.find(b'L') {
            self.starts = starts(&l)?;
        }
        let first = match cycle {
            TwoBlock::G76 => &mut self.g76,
            TwoBlock::G78 => &mut self.g78,
        };
        if !block.has_any(PLANE_AXES) {
            first.read(&rules, modal, block, plan)?;
            first.infeed = written.or(first.infeed);
            first.next = extras.or(first.next);
            return Ok(());
        }
        let (end, x, z) = modal.cycle_end(block)?;
        let taper = match block.find(b'R') {
            Some(r) => modal.scale.distance(&r, rules.taper)?,
            None => parameter(Length::ZERO),
        };
        let height = rules.positive(modal, block, word, b'P')?;
        let first_depth = rules.positive(modal, block, word, b'Q')?;
        let Some(lead) = self.lead else {
            let range = modal.scale.lead_range();
            return Err(Alarm::new(Code::LeadMissing, word.span).with(range));
        };
        let extras = extras.or(first.next);
        first.next = Extras::NONE;
        let First {
            p,
            min_step,
            allowance,
            infeed,
            ..
        } = *first;
        let (j, k) = match cycle {
            TwoBlock::G76 => (extras.j, extras.k),
            TwoBlock::G78 => {
                self.run_out.write(extras.j, extras.k);
                self.run_out.sizes()
            }
        };
        let params = modal.params;
        let call = ThreadCall {
            cycle: match cycle {
                TwoBlock::G76 => ThreadCycle::G76,
                TwoBlock::G78 => ThreadCycle::G78,
            },
            start: modal.position,
            end_x: At::new(end.x, x),
            end_z: At::new(end.z, z),
            taper,
            height,
            first_depth,
            min_step: min_step.unwrap_or_else(|| parameter(params.thread_min_step())),
            allowance: allowance.unwrap_or_else(|| parameter(params.thread_allowance())),
            finish_passes: match p {
                Some(Digits {
                    m: Some(m), span, ..
                }) => At::new(m, span),
                _ => parameter(params.thread_finish_passes()),
            },
            angle: match p {
                Some(p) => At::new(p.a, p.span),
                None => parameter(params.thread_angle()),
            },
            infeed: rules.infeed(modal, written.or(infeed)),
            cut_in: rules.cut_in(modal, p),
            starts: match cycle {
                TwoBlock::G76 => parameter(1),
                TwoBlock::G78 => self.starts,
            },
            run_in: extras.e.unwrap_or_else(|| parameter(Length::ZERO)),
            run_out: rules.chamfer(modal, p).resolve(j, k, lead.value),
            lead,
            change: parameter(LeadChange::NONE),
            first_angle: StartAngle::INDEX,
            part: ChainPart::Whole,
            increment: modal.scale.increment(),
            rpm: modal.rpm(),
        };
        let call = follow(call, modal, word.span, plan)?;
        plan.motion(word.span, CallKind::Thread(call));
        Ok(())
    }

    /// F or I: the lead from now on.
    pub(super) fn read_lead(&mut self, modal: &Modal<'_>, block: &Block) -> Result<(), Alarm> {
        let lead = match (block.find(b'F'), block.find(b'I')) {
            (None, None) => return Ok(()),
            (Some(f), Some(i)) => {
                let later = if i.span.column > f.span.column { i } else { f };
                return Err(later.alarm(Code::TwoLeads));
            }
            (Some(f), None) => modal.scale.lead(&f)?,
            (None, Some(i)) => modal.scale.turns_per_inch(&i)?,
        };
        self.lead = Some(lead);
        Ok(())
    }
}

impl First {
    /// P, Q and R of a first block.
    fn read(
        &mut self,
        rules: &Rules,
        modal: &Modal<'_>,
        block: &Block,
        plan: &mut Plan,
    ) -> Result<(), Alarm> {
        if let Some(p) = block.find(b'P') {
            let digits = digits(&p)?;
            if rules.cycle == TwoBlock::G78
                && let Some(r @ 5..) = digits.r
            {
                plan.warn(p.alarm(Code::CutInMode).with([Arg::Int(i64::from(r))]));
            }
            self.p = Some(digits);
        }
        if let Some(q) = block.find(b'Q') {
            q.not_negative()?;
            self.min_step = Some(rules.depth(modal, &q, rules.min_step)?);
        }
        if let Some(r) = block.find(b'R') {
            r.not_negative()?;
            self.allowance = Some(modal.scale.distance(&r, rules.allowance)?);
        }
        Ok(())
    }
}

impl Chamfer {
    /// The run-out of G76 and G92: the 980TD knows 45° alone.
    pub(super) fn plain(modal: &Modal<'_>, tenths: At<u8>) -> Self {
        let degrees = match modal.options.dialect {
            Dialect::Gsk980td => 45,
            Dialect::Gsk988 => chamfer_angle(modal),
        };
        Self { tenths, degrees }
    }
}

/// 5131, degrees; 0 is 45.
fn chamfer_angle(modal: &Modal<'_>) -> u8 {
    match modal.params.thread_chamfer_angle() {
        0 => 45,
        degrees => degrees,
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

pub(super) fn starts(word: &Word) -> Result<At<u8>, Alarm> {
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
