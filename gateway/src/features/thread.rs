//! The passes of a program's threads, with what a picture says of each thread.

use leadscrew_core::alarm::Lang;
use leadscrew_core::call::{Call, CallKind, ChainPart};
use leadscrew_core::cycle;
use leadscrew_core::moves::{Move, Stage, ThreadMove};
use leadscrew_core::params::Params;

use super::PIECES;
use crate::drawing::mm;
use crate::inspection::Job;
use crate::inspection::edge::typed;
use crate::number::measured;
use crate::plot::{Pass, Shape, Thread};
use crate::words::both;

/// A move in the work: Z and radius in millimetres, and the line it is of.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lathe {
    pub(super) from: (f64, f64),
    pub(super) to: (f64, f64),
    pub(super) line: u32,
}

/// All threads along Z.
#[derive(Debug)]
pub(super) struct Threads {
    list: Vec<One>,
    /// The pass before is over.
    is_over: bool,
    pub(super) left_out: u64,
}

#[derive(Debug)]
struct One {
    job: Job,
    passes: Vec<Pass>,
    lead: f64,
    /// The spindle turns as for M3.
    forward: bool,
    lead_in: Option<f64>,
}

impl Threads {
    pub(super) fn new(jobs: Vec<Job>) -> Self {
        let one = |job| One {
            job,
            passes: Vec::new(),
            lead: 0.0,
            forward: true,
            lead_in: None,
        };
        Self {
            list: jobs.into_iter().map(one).collect(),
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
            let mut passes = one.job.passes.iter();
            passes.any(|(first, last, _)| (*first..=*last).contains(&step))
        };
        let number = self.list.iter().position(is_in)?;
        let one = self.list.get_mut(number)?;
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
            if stage != Some(Stage::RunOut) {
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

    /// The figures of a thread, and its geometry.
    pub(super) fn feature(&self, number: usize, lang: Lang) -> (Vec<String>, Shape) {
        let one = &self.list[number];
        let stock = &one.job.stock;
        let thread = Thread {
            side: stock.side,
            passes: one.passes.clone(),
            tool: one.job.tool,
            lead: one.lead,
            face: stock.face.0,
            surface: (stock.radius.0, stock.taper),
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
        let hand = match (toward_minus, self.forward) {
            (true, true) => both!("right-hand (M3, toward -Z)", "右旋（M3，向 -Z）"),
            (false, false) => both!("right-hand (M4, toward +Z)", "右旋（M4，向 +Z）"),
            (true, false) => both!("left-hand (M4, toward -Z)", "左旋（M4，向 -Z）"),
            (false, true) => both!("left-hand (M3, toward +Z)", "左旋（M3，向 +Z）"),
        };
        let lead = measured(self.lead);
        let passes = self.passes.len();
        let starts = self.passes.iter().map(|pass| pass.start).max().unwrap_or(1);
        let told = both!(
            "{en} · lead {lead} mm · starts: {starts} · passes: {passes}",
            "{zh} · 导程 {lead} mm · 头数 {starts} · 走刀 {passes} 次",
            en = hand.en,
            zh = hand.zh
        );
        told.get(lang).to_owned()
    }

    fn edge(&self, lang: Lang) -> String {
        let shape = typed(&self.job.tool);
        let face = measured(self.job.stock.face.0);
        let mut told = both!("edge {shape}", "刀刃 {shape}");
        if self.job.assumed.tool {
            let number = match self.job.tool_number {
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
        if self.job.assumed.face {
            told = both!(
                "{en} · face assumed at Z{face}",
                "{zh} · 假定端面在 Z{face}",
                en = told.en,
                zh = told.zh
            );
        }
        if self.job.assumed.surface {
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
