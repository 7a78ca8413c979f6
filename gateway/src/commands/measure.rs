//! `measure`: what a program cuts, measured as an inspector does.

use leadscrew_inspection::{Cut, Wish};

use super::picture::{self, Format, PictureFormat};
use crate::cli::Measure;
use crate::diagnostics;
use crate::execution::Execution;
use crate::failure::{Failure, Outcome};
use crate::features::{self, Tools};
use crate::inspection::plan::plan;
use crate::inspection::samples::Threads;
use crate::inspection::turned::{self, Found, Turning};
use crate::inspection::{picture as sheets, result, sheet};
use crate::json::Json;
use crate::machine::Observer;
use crate::output;
use crate::page;
use crate::plot;
use crate::profiles::Chosen;
use crate::setup::Setup;
use crate::source::SourceFile;
use crate::trace::{Setpoint, Summary};
use crate::words::both;

/// Cuts and measures the threads, grooves and contours of a program.
pub(super) fn run(setup: &Setup, args: &Measure, format: Option<&Format>) -> Outcome {
    let source = SourceFile::new(&args.program);
    if let Some(path) = &args.output {
        source.protect(path)?;
    }
    let chosen = Chosen::of(&args.drives.drive, setup.lang)?;
    let servos = chosen.servos(&setup.params)?;
    let mut execution = Execution::prepare(setup, &source)?;
    let wish = Wish {
        threads: args.thread.clone(),
        tools: args.tool.clone(),
        surface: args.surface.map(Into::into),
        face: args.face.map(Into::into),
        ..Wish::default()
    };
    let tools = Tools {
        edges: args.tool.clone(),
        widths: args.tool_width.clone(),
    };
    features::tell_idle(setup, &source, &tools)?;
    let planned = plan(setup, &source, &wish)?;
    let along_x = planned.along_x.len();
    let mut all = All {
        threads: Threads::new(Summary::new(&setup.params), planned.jobs),
        turning: Turning::new(turned::plan(setup, &source, &args.tool_width)?),
    };
    execution.run(&args.drive, servos, &mut all)?;
    let All { threads, turning } = all;
    if !execution.is_whole() {
        return execution.conclude(&threads.summary, None);
    }
    let cuts = threads.finish();
    let turned = turning.finish();
    let good = cuts.iter().all(|cut| cut.verdict() != Some(false));
    if let Some((path, format)) = args.output.as_ref().zip(format) {
        let title = super::plot::title(&args.program);
        let svg = || {
            let mut sheets = sheets::sheets(&cuts, setup.lang);
            sheets.extend(turned::picture::sheets(&turned, setup.lang));
            plot::svg(&title, &sheets, setup.lang)
        };
        match format {
            Format::Json => {
                let mut json = Json::new();
                json.object(|json| told(json, &execution, &cuts, &turned, along_x, good));
                let mut bytes = json.into_bytes();
                bytes.push(b'\n');
                picture::write(path, bytes)?;
            }
            Format::Picture(PictureFormat::Svg) => picture::write(path, svg())?,
            Format::Picture(PictureFormat::Png) => picture::write_png(setup.global, path, &svg())?,
            Format::Picture(PictureFormat::Html) => {
                let text =
                    sheet::text(&cuts, setup.lang) + &turned::sheet::text(&turned, setup.lang);
                picture::write(path, page::sheet(&title, &svg(), &text, setup.lang))?;
            }
        }
    }
    if setup.global.json {
        output::json(|json| told(json, &execution, &cuts, &turned, along_x, good))?;
    } else {
        tell(setup, &cuts, &turned, along_x);
    }
    if good { Ok(()) } else { Err(Failure::Wrong) }
}

/// All that is cut while the program runs.
struct All {
    threads: Threads,
    turning: Turning,
}

impl Observer for All {
    fn setpoint(&mut self, point: &Setpoint) -> Outcome {
        self.turning.push(point);
        self.threads.setpoint(point)
    }
}

/// The result for a program.
fn told(
    json: &mut Json,
    execution: &Execution,
    cuts: &[Cut],
    turned: &Found,
    along_x: usize,
    good: bool,
) {
    json.flag("ok", good);
    result::fields(cuts, along_x, json);
    turned::result::fields(turned, json);
    execution.origin_fields(json);
}

fn tell(setup: &Setup, cuts: &[Cut], turned: &Found, along_x: usize) {
    diagnostics::say(&sheet::text(cuts, setup.lang));
    diagnostics::say(&turned::sheet::text(turned, setup.lang));
    if along_x > 0 {
        let told = both!(
            "{along_x} threads along X are not measured\n",
            "{along_x} 个端面螺纹（沿 X）未测量\n"
        );
        diagnostics::say(told.get(setup.lang));
    }
    if cuts.is_empty() {
        let told = both!("the program cuts no thread\n", "程序没有车削螺纹\n");
        diagnostics::say(told.get(setup.lang));
    }
    if let Some(file) = setup.machine() {
        let told = both!("machine {file}\n", "机床 {file}\n");
        diagnostics::say(told.get(setup.lang));
    }
}
