//! `plot`: a picture of a program's path and of what the machine does over time.

use std::path::Path;

use leadscrew_core::alarm::{Code, Lang};

use super::picture::{self, PictureFormat};
use crate::checking::{self, Report};
use crate::cli::Plot;
use crate::diagnostics::{self, Diagnostic};
use crate::drawing::{Drawing, Drawn, Zeros};
use crate::execution::{self, Execution};
use crate::failure::{Failure, Outcome};
use crate::features::{self, Tools};
use crate::machine::Observer;
use crate::number;
use crate::output;
use crate::page::{Page, Way};
use crate::place::SourceLine;
use crate::plot::{Envelope, Feature, Mark, Picture, Sample, Shape, View};
use crate::setup::Setup;
use crate::source::SourceFile;
use crate::trace::{Setpoint, Summary};
use crate::walk::Walk;
use crate::words::{self, both, pick};

/// Draws a program.
pub(super) fn run(setup: &Setup, args: &Plot, format: PictureFormat) -> Outcome {
    let source = SourceFile::new(&args.program);
    source.protect(&args.output)?;
    if args.path {
        return without_time(setup, &source, args, format);
    }
    let mut execution = Execution::prepare(setup, &source)?;
    let drawn = drawn(setup, &source)?;
    let tools = Tools {
        edges: args.tool.clone(),
        widths: args.tool_width.clone(),
    };
    features::tell_idle(setup, &source, &tools)?;
    let mut features = features::collect(setup, &source, &execution.report, &tools)?;
    if features.left_out > 0 {
        let told = both!(
            "{left_out} features, or pieces of them, are not drawn near by: they did not fit\n",
            "有 {left_out} 个特征或其组成部分画不下，未画局部视图\n",
            left_out = features.left_out
        );
        diagnostics::say(told.get(setup.lang));
    }
    let tick_us = f64::from(setup.params.tick_us());
    let mut watcher = Watcher {
        tick_us,
        summary: Summary::new(&setup.params),
        series: Envelope::new(tick_us / 1e6),
        way: Way::new(tick_us / 1e6),
        zeros: drawn.zeros,
        spindle: None,
        step: 0,
        locked: 0,
        features: &mut features.list,
    };
    execution.run(&args.drive, [None; 2], &mut watcher)?;
    let Watcher {
        summary,
        series,
        way,
        ..
    } = watcher;
    if !execution.is_interrupted() {
        let picture = Picture {
            title: title(&args.program),
            subtitle: summary.line(setup.lang),
            lang: setup.lang,
            path: drawn.strokes,
            view: View::Whole,
            ideal: args.drive.spindle_ripple.is_none(),
            features: features.list,
            stock: features.stock,
            marks: marks(&execution.report, setup.lang),
            series: Some(series),
        };
        write(setup, &source, args, format, &picture, Some(way))?;
    }
    execution.conclude(&summary, None)
}

/// Draws a program that has been checked and is not run.
fn without_time(setup: &Setup, source: &SourceFile, args: &Plot, format: PictureFormat) -> Outcome {
    let report = execution::tell_report(setup, source)?;
    let ok = report.alarms.is_empty();
    if ok {
        let length = number::rounded::<6>(report.path_nm.round() as i64, 3);
        let line = both!(
            "{words} · path {length} mm",
            "移动 {moves} 段 · 路径 {length} mm",
            words = checking::plural(report.moves, "move"),
            moves = report.moves
        );
        let picture = Picture {
            title: title(&args.program),
            subtitle: line.get(setup.lang).to_owned(),
            lang: setup.lang,
            path: drawn(setup, source)?.strokes,
            view: View::Part,
            features: Vec::new(),
            ideal: true,
            stock: None,
            marks: Vec::new(),
            series: None,
        };
        write(setup, source, args, format, &picture, None)?;
    }
    if setup.global.json {
        output::json(|json| {
            json.flag("ok", ok);
            json.integer("moves", i64::try_from(report.moves).unwrap_or(i64::MAX));
            json.decimal::<6>("path_mm", report.path_nm.round() as i64);
            report.diagnostics(json);
        })?;
    }
    if ok { Ok(()) } else { Err(Failure::Wrong) }
}

/// Writes a picture and says so.
fn write(
    setup: &Setup,
    source: &SourceFile,
    args: &Plot,
    format: PictureFormat,
    picture: &Picture,
    way: Option<Way>,
) -> Outcome {
    match format {
        PictureFormat::Png => picture::write_png(setup.global, &args.output, &picture.svg())?,
        PictureFormat::Html => {
            let page = Page {
                title: &picture.title,
                subtitle: &picture.subtitle,
                lang: picture.lang,
                path: &picture.path,
                stock: picture.stock.as_ref(),
                marks: &picture.marks,
                told: picture.told(checking::LISTED),
                program: listing(source),
                way,
                cuts: picture.cuts(),
                over_time: picture.over_time(),
            };
            picture::write(&args.output, page.html())?;
        }
        PictureFormat::Svg => picture::write(&args.output, picture.svg())?,
    }
    if !setup.global.json {
        let (output, line) = (words::path(&args.output), &picture.subtitle);
        let told = both!("{output}: {line}\n", "{output}：{line}\n");
        diagnostics::say(told.get(setup.lang));
    }
    Ok(())
}

/// The lines of the program beside its path, as many as a page can carry.
fn listing(source: &SourceFile) -> Vec<String> {
    const MOST: usize = 5_000;
    let text = |line: Vec<u8>| String::from_utf8_lossy(&line).trim_end().to_owned();
    source.lines(MOST).into_iter().map(text).collect()
}

/// Where warnings of moves are.
fn marks(report: &Report, lang: Lang) -> Vec<Mark> {
    let mark = |mark: &checking::Mark| {
        let line = SourceLine(mark.line);
        let is_rapid = mark.number == Code::RapidInStock.number();
        let words = if is_rapid {
            pick(lang, "rapid through the material", "快速移动穿过毛坯").to_owned()
        } else {
            let mut warnings = report.warnings.iter();
            let is_it = |one: &&Diagnostic| (one.number, one.counted) == (mark.number, mark.line);
            match warnings.find(is_it) {
                Some(warning) => format!("{} {}", mark.number, warning.message),
                // A report has words for some lines of a kind.
                None => mark.number.to_string(),
            }
        };
        Mark {
            number: mark.number,
            line: line.to_string(),
            row: line.file().map_or(mark.line, |_| 0),
            words,
            is_rapid,
            way: [mark.from, mark.to],
            at: mark.at,
        }
    };
    report.marks.iter().map(mark).collect()
}

pub(super) fn title(program: &Path) -> String {
    words::path(Path::new(
        program.file_name().unwrap_or(program.as_os_str()),
    ))
}

/// The tool path of a program that has been checked.
fn drawn(setup: &Setup, source: &SourceFile) -> Outcome<Drawn> {
    let mut drawing = Drawing::new(setup.options().position);
    let mut walk = Walk::open(setup, source)?;
    while walk
        .next_call(|call, step| drawing.push(step, &call.origin))?
        .is_some()
    {}
    let drawn = drawing.finish();
    if drawn.left_out > 0 {
        let (left_out, shown) = (drawn.left_out, drawn.strokes.len());
        let told = both!(
            "the picture shows the first {shown} moves; {left_out} more did not fit\n",
            "图中只画了前 {shown} 段移动，还有 {left_out} 段画不下\n"
        );
        diagnostics::say(told.get(setup.lang));
    }
    Ok(drawn)
}

/// Collects the time series.
struct Watcher<'a> {
    tick_us: f64,
    summary: Summary,
    series: Envelope,
    way: Way,
    zeros: Zeros,
    /// The spindle in the picture and its angle in the tick before.
    spindle: Option<(u8, i64)>,
    /// The move of the tick before.
    step: u64,
    /// The last move that was locked to the spindle.
    locked: u64,
    features: &'a mut [Feature],
}

impl Watcher<'_> {
    /// The distance from the helix belongs to the thread whose move it is of, or to the tap.
    fn phase(&mut self, point: &Setpoint) {
        let micrometres = point.error_nm.map(|nm| nm as f64 / 1e3);
        let urev = point.turning_spindle().1;
        let step = std::mem::replace(&mut self.step, point.step);
        for feature in self.features.iter_mut() {
            let is_here = feature.is_of(point.step);
            let Feature { shape, phase, .. } = feature;
            let off = match shape {
                Shape::Thread(_) => {
                    if !is_here || micrometres.is_none() || point.tap.is_some() {
                        continue;
                    }
                    // The moves of a pass, and of a chain, follow each other; between passes there are others.
                    if point.step > self.locked + 1
                        && let Some(phase) = phase
                    {
                        phase.interrupt();
                    }
                    micrometres
                }
                Shape::Tap(tap) => match point.tap.filter(|_| is_here) {
                    Some(place) => {
                        // Each stroke is a move, and counts while it moves.
                        if step != point.step
                            && let Some(phase) = phase
                        {
                            phase.interrupt();
                        }
                        let (mm, turns) = (place.depth_nm as f64, place.turned_urev as f64);
                        if !tap.push(mm / 1e6, turns / 1e6) {
                            continue;
                        }
                        micrometres
                    }
                    None => {
                        tap.leave();
                        None
                    }
                },
                Shape::Groove(_) | Shape::Contour(_) | Shape::Drilled(_) => continue,
            };
            match (off, phase) {
                (Some(off), phase) => phase.get_or_insert_default().push(urev, off),
                (None, Some(phase)) => phase.interrupt(),
                (None, None) => {}
            }
        }
        if micrometres.is_some() {
            self.locked = point.step;
        }
    }
}

impl Observer for Watcher<'_> {
    fn setpoint(&mut self, point: &Setpoint) -> Outcome {
        let [x, z, _] = self.summary.push(point);
        let spindle = point.turning_spindle();
        let turned = match self.spindle.replace(spindle) {
            Some((number, angle)) if number == spindle.0 => spindle.1 - angle,
            _ => 0,
        };
        // Nanometres a tick to millimetres a minute, millionths of a turn a tick to turns a minute.
        let minute = 60e6 / self.tick_us;
        let zero = self.zeros.at(point.step);
        self.way
            .push(point.line, point.x_nm - zero.0, point.z_nm - zero.1);
        self.phase(point);
        self.series.push(&Sample {
            x: x as f64 * minute / 1e6,
            z: z as f64 * minute / 1e6,
            rpm: turned as f64 * minute / 1e6,
            error: point.error_nm.map(|nm| nm as f64 / 1e3),
            depth: point.tap.map(|tap| tap.depth_nm as f64 / 1e6),
            turned: point.tap.map(|tap| tap.turned_urev as f64 / 1e6),
        });
        Ok(())
    }
}
