//! `check`, `expand`, `simulate`, `plot`, `measure` and `run`: what is typed to work on a program.

use std::num::NonZeroU32;
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use leadscrew_inspection::Edge;

use crate::features::Width;
use crate::inspection::edge::{Millimetres, edge};
use crate::profiles::Choice;
use crate::start::{Consent, Shown};
use crate::values::{Ripple, Tolerance};

/// `check`.
#[derive(Args, Debug)]
pub struct Check {
    /// Programs
    #[arg(required = true, value_name = "PROG")]
    pub programs: Vec<PathBuf>,
    /// Fail (exit 1) when a thread starts too close to the material for its lead-in
    #[arg(long)]
    pub strict: bool,
}

/// `expand`.
#[derive(Args, Debug)]
pub struct Expand {
    /// Program
    #[arg(value_name = "PROG")]
    pub program: PathBuf,
    /// How to print the moves (`--json` is the same as `--format jsonl`)
    #[arg(long, value_enum)]
    pub format: Option<Format>,
}

/// `--format` of `expand`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// A table to read.
    Text,
    /// One JSON object a line.
    Jsonl,
    /// Comma-separated, with a header.
    Csv,
}

/// The drives of the simulated axes.
#[derive(Args, Debug, Default)]
pub struct Drives {
    /// Drive of X and Z, or of one axis, by its profile (`leadscrew drives list`): `kv30`, `Z=technosoft-ipos`, `X=my.toml`
    /// (repeatable) [default: ideal]
    #[arg(long, value_name = "[AXIS=]NAME")]
    pub drive: Vec<Choice>,
}

/// What drives the virtual machine.
#[derive(Args, Debug, Default)]
pub struct Drive {
    /// Spindle speed ripple: a sine of PERCENT of the commanded speed, as `10@5`
    #[arg(long, value_name = "PERCENT@HZ")]
    pub spindle_ripple: Option<Ripple>,
    /// Interpolation tick in microseconds, instead of parameter 9000
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(250..=10_000))]
    pub tick_us: Option<u32>,
}

/// `simulate`.
#[derive(Args, Debug)]
pub struct Simulate {
    /// Program
    #[arg(value_name = "PROG")]
    pub program: PathBuf,
    /// Where the setpoints go, one row a tick
    #[arg(short, long, value_name = "FILE.csv")]
    pub output: Option<PathBuf>,
    /// The drives.
    #[command(flatten)]
    pub drives: Drives,
    /// The plant.
    #[command(flatten)]
    pub drive: Drive,
    /// Fail (exit 1) when the worst synchronism error of a thread or a hole is above this many micrometres
    #[arg(long, value_name = "UM", allow_negative_numbers = true)]
    pub tolerance: Option<Tolerance>,
}

/// `plot`.
#[derive(Args, Debug)]
pub struct Plot {
    /// Program
    #[arg(value_name = "PROG")]
    pub program: PathBuf,
    /// Where the picture goes; the ending chooses the format
    ///
    /// `.png` is twice the size of `.svg`.
    /// `.html` is one file that a browser opens without a network: it zooms, tells the line under the pointer, and plays.
    #[arg(short, long, value_name = "FILE.{svg,png,html}")]
    pub output: PathBuf,
    /// The tool path alone, near the part: nothing is run, so there is nothing over time
    #[arg(long, conflicts_with_all = ["spindle_ripple", "tick_us", "tool", "tool_width"])]
    pub path: bool,
    /// The edge of a threading tool: `V60:r0.1`, `T3=V30/27:f0.2` (repeatable) [default: the thread's angle and the norm's
    /// root]
    #[arg(long, value_name = "[Tn=]SHAPE", value_parser = edge)]
    pub tool: Vec<Edge>,
    /// The width of a grooving tool, from its programmed corner toward +Z: `T2=4` (repeatable)
    #[arg(long, value_name = "Tn=MM")]
    pub tool_width: Vec<Width>,
    /// The plant.
    #[command(flatten)]
    pub drive: Drive,
}

/// `measure`.
#[derive(Args, Debug)]
pub struct Measure {
    /// Program
    #[arg(value_name = "PROG")]
    pub program: PathBuf,
    /// What a thread should be: `M40x3-6g`, `M30x4P2-6H`, `1/4-20UNC-2A`, `1/2-14NPT` (repeatable: one for all, or one for
    /// each) [default: a guess by pitch, angle and diameter, which is said]
    #[arg(long, value_name = "NAME")]
    pub thread: Vec<String>,
    /// The edge of a tool: `V60:r0.1`, `T3=V30/27:f0.2` (repeatable) [default: the thread's angle and the norm's root
    /// radius, which is said]
    ///
    /// V and the angle between the flanks, or both from the normal of the axis, that towards -Z first; `:r` the radius of
    /// the tip, `:f` its width, mm.
    #[arg(long, value_name = "[TN=]EDGE", value_parser = edge)]
    pub tool: Vec<Edge>,
    /// Width of a grooving tool from its programmed corner toward +Z, of G74 away from the axis, mm: `T2=4` (repeatable)
    /// [default: not known, and its grooves are not measured]
    #[arg(long, value_name = "TN=MM")]
    pub tool_width: Vec<Width>,
    /// Diameter of the surface before the cut, at the face [default: what the cycle's height says, else the middle of the
    /// norm's limits]
    #[arg(long, value_name = "MM")]
    pub surface: Option<Millimetres>,
    /// Z of the face in work coordinates [default: 0, or where the strokes begin]
    #[arg(long, value_name = "MM", allow_hyphen_values = true)]
    pub face: Option<Millimetres>,
    /// Where the result goes; the ending chooses the format: `json` all figures, `svg` and `png` a picture, `html`
    /// picture and sheet
    #[arg(short, long, value_name = "FILE.{svg,png,html,json}")]
    pub output: Option<PathBuf>,
    /// The plant.
    #[command(flatten)]
    pub drive: Drive,
    /// Its drives.
    #[command(flatten)]
    pub drives: Drives,
}

/// `run`.
#[derive(Args, Debug, Default)]
pub struct Run {
    /// Program
    #[arg(value_name = "PROG")]
    pub program: PathBuf,
    /// Start at this line of the file: the lines before are read without motion, and the line's number has to be typed
    #[arg(long, value_name = "LINE")]
    pub from: Option<NonZeroU32>,
    /// With `--from`: begin without asking
    #[arg(long, requires = "from")]
    pub yes: bool,
    /// With `--from`: begin without asking what was shown before, and nothing else
    #[arg(long, hide = true, requires = "from", conflicts_with = "yes")]
    pub shown: Option<Shown>,
    /// End after this many passes of a main program that M99 begins again [default: no end]
    #[arg(long, value_name = "N")]
    pub passes: Option<NonZeroU32>,
    /// Go along the path as a handwheel is turned (not with `--bus sim`); threads and taps ask for a start
    #[arg(long)]
    pub handwheel: bool,
    /// Write the bus traffic as a candump log
    #[arg(long, value_name = "FILE")]
    pub record: Option<PathBuf>,
    /// The drives.
    #[command(flatten)]
    pub drives: Drives,
    /// The plant.
    #[command(flatten)]
    pub drive: Drive,
    /// Fail (exit 1) when the worst synchronism error of a thread or a hole is above this many micrometres
    #[arg(long, value_name = "UM", allow_negative_numbers = true)]
    pub tolerance: Option<Tolerance>,
}

impl Run {
    /// How whoever has typed it agrees to a start at a line.
    pub fn consent(&self) -> Consent {
        let given = if self.yes {
            Consent::Given
        } else {
            Consent::Asked
        };
        self.shown.map_or(given, Consent::To)
    }
}
