//! A thread that was cut, as the page shows it: what was measured, its profile, and the chip of each pass.
//!
//! Words are keys of the page's words. Knows no machine.

use leadscrew_core::call::{CutIn, ThreadCycle};
use leadscrew_inspection::{Cut, Job};
use leadscrew_metrology::{Feature, Inspection, Measured, Mm, Turns, Work};
use serde::Serialize;

/// Pitches of the profile that is drawn.
const PITCHES: f64 = 4.0;
/// Most passes whose chips are told.
const PASSES: usize = 60;

/// A thread that was cut.
#[derive(Debug, Serialize)]
pub struct Thread {
    line: u32,
    /// What it looks like; empty where no norm has it.
    name: String,
    /// Major diameter and pitch of what it should be, mm.
    major: f64,
    pitch: f64,
    /// A key of the words.
    cut_in: Option<&'static str>,
    /// Within its limits; none where there are none.
    good: Option<bool>,
    measured: Option<Figures>,
    /// Z and radius, nanometres in work coordinates.
    profile: Vec<[i64; 2]>,
    /// Pass, and mm³ towards −Z and +Z of the tool's middle.
    chips: Vec<(u32, f64, f64)>,
}

/// What was measured.
#[derive(Debug, Serialize)]
struct Figures {
    rows: Vec<Row>,
    /// Angles of the flanks towards −Z and +Z, degrees.
    flanks: [f64; 2],
    /// Error over all turns, and sway within a turn, µm.
    lead: f64,
    sway: f64,
    /// Full thread, turns.
    turns: f64,
    /// The GO gauge goes on, the NO-GO gauge stays out.
    gauges: Option<[bool; 2]>,
}

/// A diameter, mm.
#[derive(Debug, Serialize)]
struct Row {
    /// A key of the words.
    feature: &'static str,
    low: Option<f64>,
    high: Option<f64>,
    found: f64,
    good: Option<bool>,
}

impl Thread {
    /// Of a cut.
    pub fn of(cut: &Cut) -> Self {
        let Cut { job, work, found } = cut;
        let found = found.as_ref().ok();
        let thread = &job.thread;
        let chips = work.chips().iter().take(PASSES);
        Self {
            line: job.line,
            name: thread.text.clone(),
            major: thread.major.0,
            pitch: thread.pitch.0,
            cut_in: cut_in(job),
            good: cut.verdict(),
            measured: found.map(|(measured, inspection)| figures(job, measured, inspection)),
            profile: profile(work, job, found.map(|(measured, _)| measured)),
            chips: chips
                .map(|(pass, chip)| (*pass, chip.minus.0, chip.plus.0))
                .collect(),
        }
    }
}

/// Where the passes go down: strokes do not say.
const fn cut_in(job: &Job) -> Option<&'static str> {
    match job.cycle {
        ThreadCycle::G32 | ThreadCycle::G34 | ThreadCycle::G92 => None,
        ThreadCycle::G76 | ThreadCycle::G78 => Some(match job.cut_in {
            CutIn::Centre => "centre",
            CutIn::Left => "left",
            CutIn::Right => "right",
            CutIn::RightCentre => "right_centre",
            CutIn::LeftRight => "left_right",
            CutIn::Trailing => "trailing",
        }),
    }
}

fn figures(job: &Job, measured: &Measured, inspection: &Inspection) -> Figures {
    let row = |row: &leadscrew_metrology::Row| Row {
        feature: match row.feature {
            Feature::Major => "major",
            Feature::Pitch => "pitch",
            Feature::Minor => "minor",
            Feature::Functional => "functional",
        },
        low: row.band.low.map(|limit| limit.0),
        high: row.band.high.map(|limit| limit.0),
        found: row.found.mean,
        good: row.within,
    };
    Figures {
        rows: inspection.rows.iter().map(row).collect(),
        flanks: measured.flanks.map(|flank| flank.mean),
        lead: measured.lead.cumulative.um(),
        sway: measured.drunkenness.worst.um(),
        turns: measured.full.0 / job.thread.lead().0,
        gauges: inspection.go.zip(inspection.no_go).map(<[bool; 2]>::from),
    }
}

/// The surface about the middle of the full thread; from the face on where there is none.
fn profile(work: &Work, job: &Job, measured: Option<&Measured>) -> Vec<[i64; 2]> {
    let stock = work.stock();
    let room = PITCHES / 2.0 * job.thread.pitch.0;
    let middle = measured.map_or(stock.face.0 - room, |of| of.groove.0 - of.full.0 / 2.0);
    let points = work.section(Turns(0.0), Mm(middle - room), Mm(middle + room));
    let nm = |of: Mm| (of.0 * 1e6).round() as i64;
    points.map(|(z, radius)| [nm(z), nm(radius)]).collect()
}
