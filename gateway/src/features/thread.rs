//! The passes of a program's threads, with what a picture says of each thread.

use std::ops::RangeInclusive;

use leadscrew_core::alarm::Lang;
use leadscrew_core::call::{Call, CallKind, ChainPart};
use leadscrew_core::cycle;
use leadscrew_core::moves::{Move, Stage, ThreadMove};
use leadscrew_core::params::Params;
use leadscrew_inspection::{Assumed, Job, Plan};
use leadscrew_metrology::{Side, Tool};

use super::PIECES;
use crate::drawing::mm;
use crate::inspection::edge::typed;
use crate::number::measured;
use crate::plot::{Across, Pass, Shape, Thread};
use crate::words::both;

/// A move in the work: Z and radius in millimetres, and the line it is of.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lathe {
    pub(super) from: (f64, f64),
    pub(super) to: (f64, f64),
    pub(super) line: u32,
}

impl Lathe {
    /// Along and across for a thread along X: as if Z and X were exchanged.
    const fn exchanged(self) -> Self {
        let Self { from, to, line } = self;
        Self {
            from: (from.1, from.0),
            to: (to.1, to.0),
            line,
        }
    }
}

/// What is known of a thread before its passes: lengths along it, and across it.
#[derive(Debug)]
struct Known {
    across: Across,
    /// Its moves: first, last, pass.
    moves: Vec<(u64, u64, u32)>,
    side: Side,
    tool: Tool,
    tool_number: u32,
    /// Where the part begins along it, where that is known.
    face: Option<f64>,
    /// The surface before the cut at the face, and its change along the thread.
    surface: (f64, f64),
    assumed: Assumed,
}

impl Known {
    fn along_z(job: Job) -> Self {
        Self {
            across: Across::X,
            moves: job.passes,
            side: job.stock.side,
            tool: job.tool,
            tool_number: job.tool_number,
            face: Some(job.stock.face.0),
            surface: (job.stock.radius.0, job.stock.taper),
            assumed: job.assumed,
        }
    }
}

/// All threads.
#[derive(Debug)]
pub(super) struct Threads {
    list: Vec<One>,
    /// The pass before is over.
    is_over: bool,
    pub(super) left_out: u64,
}

#[derive(Debug)]
struct One {
    known: Known,
    passes: Vec<Pass>,
    lead: f64,
    /// Change of the lead in a turn, millimetres.
    change: f64,
    /// The spindle turns as for M3.
    forward: bool,
    lead_in: Option<f64>,
}

impl Threads {
    /// Those of a plan; the part's outer radius, where it is known, is where those along X begin.
    pub(super) fn new(plan: Plan, rim: Option<f64>) -> Self {
        let along_x = plan.along_x.into_iter().map(|flat| Known {
            across: Across::Z,
            moves: flat.passes,
            side: Side::External,
            tool: flat.tool,
            tool_number: flat.tool_number,
            face: rim,
            surface: (flat.surface.0.0, flat.surface.1),
            assumed: flat.assumed,
        });
        let along_z = plan.jobs.into_iter().map(Known::along_z);
        let one = |known| One {
            known,
            passes: Vec::new(),
            lead: 0.0,
            change: 0.0,
            forward: true,
            lead_in: None,
        };
        Self {
            list: along_z.chain(along_x).map(one).collect(),
            is_over: true,
            left_out: 0,
        }
    }

    /// Adds the move with this number in the program; gives the number of its thread.
    pub(super) fn push(
        &mut self,
        step: u64,
        each: &Move,
        thread: &ThreadMove,
        at: Lathe,
    ) -> Option<usize> {
        let is_in = |one: &One| {
            let mut passes = one.known.moves.iter();
            passes.any(|(first, last, _)| (*first..=*last).contains(&step))
        };
        let number = self.list.iter().position(is_in)?;
        let one = self.list.get_mut(number)?;
        let is_flat = one.known.across == Across::Z;
        let at = if is_flat { at.exchanged() } else { at };
        let start = each.tag.map_or(1, |tag| tag.start.max(1));
        let stage = each.tag.map(|tag| tag.stage);
        let lead = thread.lead.numerator() as f64 / thread.lead.denominator() as f64 / 1e6;
        if std::mem::replace(&mut self.is_over, thread.last) {
            let before = one.passes.iter().filter(|pass| pass.start == start).count();
            let toward = if at.to.0 > at.from.0 { 1.0 } else { -1.0 };
            let turned = f64::from(thread.angle_udeg) / 360e6;
            let depth = each.tag.map(|tag| tag.depth.nm()).filter(|nm| *nm > 0);
            if one.passes.len() == PIECES {
                self.left_out += 1;
                return Some(number);
            }
            (one.lead, one.forward) = (lead, thread.rpm.get() >= 0);
            one.change = thread.change.pm() as f64 / 1e9;
            one.passes.push(Pass {
                number: u32::try_from(before).unwrap_or(u32::MAX).saturating_add(1),
                line: at.line,
                start,
                depth: depth.map(mm),
                points: vec![at.from],
                run_in: 0,
                run_out: 0,
                phase: at.from.0 - toward * lead * turned,
            });
        }
        if let Some(pass) = one.passes.last_mut() {
            pass.points.push(at.to);
            let now = pass.points.len() - 1;
            if stage == Some(Stage::RunIn) {
                pass.run_in = now;
            }
            // A chain may go out of the work by a stroke that is too steep for the thread.
            if stage != Some(Stage::RunOut) && thread.long_x == is_flat {
                pass.run_out = now;
            }
        }
        Some(number)
    }

    /// Notes the way in which the axis gets onto the lead, as the check tells it. A chain is known as a whole only.
    pub(super) fn lead_in(&mut self, call: &Call, params: &Params) {
        let CallKind::Thread(thread) = &call.kind else {
            return;
        };
        if thread.part != ChainPart::Whole {
            return;
        }
        let same = |one: &&mut One| {
            let mut passes = one.passes.iter();
            passes.any(|pass| pass.line == call.span.line)
        };
        let Some(one) = self.list.iter_mut().rev().find(same) else {
            return;
        };
        if let Ok(findings) = cycle::thread_findings(thread, call.span, params)
            && let Some(report) = findings.report
        {
            let long = mm(report.lead_in.nm());
            one.lead_in = Some(one.lead_in.map_or(long, |known| known.max(long)));
        }
    }

    /// The moves of a thread by their numbers, in their order.
    pub(super) fn steps(&self, number: usize) -> Vec<RangeInclusive<u64>> {
        let moves = &self.list[number].known.moves;
        let mut steps: Vec<_> = moves
            .iter()
            .map(|(first, last, _)| *first..=*last)
            .collect();
        steps.sort_unstable_by_key(|steps| *steps.start());
        steps
    }

    /// The figures of a thread, and its geometry.
    pub(super) fn feature(&self, number: usize, lang: Lang) -> (Vec<String>, Shape) {
        let one = &self.list[number];
        let known = &one.known;
        let thread = Thread {
            across: known.across,
            side: known.side,
            passes: one.passes.clone(),
            tool: known.tool,
            lead: one.lead,
            face: known.face,
            face_is_assumed: known.assumed.face,
            surface: known.surface,
            level: match known.across {
                Across::X => known.face.unwrap_or(0.0),
                Across::Z => 0.0,
            },
            lead_in: one.lead_in,
        };
        let figures = vec![one.figures(lang), one.edge(lang)];
        (figures, Shape::Thread(thread))
    }
}

impl One {
    fn figures(&self, lang: Lang) -> String {
        let toward_minus = self.passes.first().is_some_and(|pass| {
            pass.points.first().map(|point| point.0) > pass.points.get(1).map(|point| point.0)
        });
        let spindle = if self.forward { "M3" } else { "M4" };
        let hand = match (toward_minus, self.forward) {
            (toward_axis, _) if self.known.across == Across::Z => {
                let (en, zh) = if toward_axis {
                    ("toward the axis", "向轴线")
                } else {
                    ("away from the axis", "离开轴线")
                };
                both!("along X ({spindle}, {en})", "沿 X（{spindle}，{zh}）")
            }
            (true, true) => both!("right-hand (M3, toward -Z)", "右旋（M3，向 -Z）"),
            (false, false) => both!("right-hand (M4, toward +Z)", "右旋（M4，向 +Z）"),
            (true, false) => both!("left-hand (M4, toward -Z)", "左旋（M4，向 -Z）"),
            (false, true) => both!("left-hand (M3, toward +Z)", "左旋（M3，向 +Z）"),
        };
        let lead = measured(self.lead);
        let change = measured(self.change.abs());
        let change = match self.change {
            0.0 => both!("", ""),
            minus if minus < 0.0 => both!(
                ", less by {change} mm in each turn",
                "，每转减小 {change} mm"
            ),
            _ => both!(
                ", more by {change} mm in each turn",
                "，每转增大 {change} mm"
            ),
        };
        let passes = self.passes.len();
        let starts = self.passes.iter().map(|pass| pass.start).max().unwrap_or(1);
        let told = both!(
            "{en} · lead {lead} mm{more} · starts: {starts} · passes: {passes}",
            "{zh} · 导程 {lead} mm{more_zh} · 头数 {starts} · 走刀 {passes} 次",
            en = hand.en,
            zh = hand.zh,
            more = change.en,
            more_zh = change.zh
        );
        told.get(lang).to_owned()
    }

    fn edge(&self, lang: Lang) -> String {
        let known = &self.known;
        let shape = typed(&known.tool);
        let face = match known.across {
            Across::X => known.face.unwrap_or(0.0),
            Across::Z => {
                let rim = self.passes.first().and_then(|pass| pass.points.first());
                known.surface.0 + known.surface.1 * rim.map_or(0.0, |rim| rim.0)
            }
        };
        let face = measured(face);
        let mut told = both!("edge {shape}", "刀刃 {shape}");
        if known.assumed.tool {
            let number = match known.tool_number {
                0 => String::new(),
                tool => format!("T{tool}="),
            };
            told = both!(
                "{en}, of the norm: the tool is not known, add `--tool {number}{shape}`",
                "{zh}，按标准：刀具未知，请加 `--tool {number}{shape}`",
                en = told.en,
                zh = told.zh
            );
        }
        if known.assumed.face {
            told = both!(
                "{en} · face assumed at Z{face}",
                "{zh} · 假定端面在 Z{face}",
                en = told.en,
                zh = told.zh
            );
        }
        if known.assumed.surface {
            told = both!(
                "{en} · surface assumed",
                "{zh} · 表面直径为假定值",
                en = told.en,
                zh = told.zh
            );
        }
        told.get(lang).to_owned()
    }
}
