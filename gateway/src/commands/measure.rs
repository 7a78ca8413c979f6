//! `measure`: what a program cuts, measured as an inspector does.

use std::path::Path;

use crate::cli::Measure;
use crate::diagnostics;
use crate::execution::Execution;
use crate::failure::{Doing, Failure, Outcome};
use crate::inspection::plan::{Wish, plan};
use crate::inspection::samples::Cutting;
use crate::inspection::{Cut, picture, result, sheet};
use crate::json::Json;
use crate::output;
use crate::page;
use crate::plot;
use crate::profiles::Chosen;
use crate::setup::Setup;
use crate::source::SourceFile;
use crate::trace::Summary;
use crate::words::{self, both};

/// Cuts and measures the threads of a program.
pub fn run(setup: &Setup, args: &Measure) -> Outcome {
    let source = SourceFile::new(&args.program);
    if let Some(path) = &args.output {
        source.protect(path)?;
    }
    let chosen = Chosen::of(&args.drives.drive, setup.lang)?;
    let servos = chosen.servos(setup.params.tick_us())?;
    let mut execution = Execution::prepare(setup, &source)?;
    let wish = Wish {
        threads: args.thread.clone(),
        tools: args.tool.clone(),
        surface: args.surface.map(Into::into),
        face: args.face.map(Into::into),
    };
    let (jobs, along_x) = plan(setup, &source, &wish)?;
    let mut cutting = Cutting::new(Summary::new(&setup.params), jobs);
    execution.run(&args.drive, servos, &mut cutting)?;
    if !execution.is_whole() {
        return execution.conclude(&cutting.summary, None);
    }
    let cuts = cutting.finish();
    let good = cuts.iter().all(|cut| cut.verdict() != Some(false));
    if let Some(path) = &args.output {
        let written = match ending(path).as_str() {
            "json" => {
                let mut json = Json::new();
                json.object(|json| told(json, &execution, &cuts, along_x, good));
                let mut bytes = json.into_bytes();
                bytes.push(b'\n');
                bytes
            }
            ending => {
                let title = super::plot::title(&args.program);
                let drawn = plot::svg(&title, &picture::sheets(&cuts, setup.lang), setup.lang);
                let all = if ending == "html" {
                    page::sheet(&title, &drawn, &sheet::text(&cuts, setup.lang), setup.lang)
                } else {
                    drawn
                };
                all.into_bytes()
            }
        };
        std::fs::write(path, written)
            .map_err(|error| Failure::file(Doing::Write, path.display(), &error))?;
    }
    if setup.global.json {
        output::json(|json| told(json, &execution, &cuts, along_x, good))?;
    } else {
        tell(setup, &cuts, along_x);
    }
    if good { Ok(()) } else { Err(Failure::Wrong) }
}

/// The result for a program.
fn told(json: &mut Json, execution: &Execution, cuts: &[Cut], along_x: usize, good: bool) {
    json.flag("ok", good);
    result::fields(cuts, along_x, json);
    execution.origin_fields(json);
}

fn tell(setup: &Setup, cuts: &[Cut], along_x: usize) {
    diagnostics::say(&sheet::text(cuts, setup.lang));
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

/// Refuses formats by name, before anything is computed.
pub fn format(args: &Measure) -> Outcome {
    let Some(output) = &args.output else {
        return Ok(());
    };
    match ending(output).as_str() {
        "json" | "svg" | "html" => Ok(()),
        "png" => Err(Failure::Usage(both!(
            "pictures as `png` are not available yet; write `-o {svg}`",
            "尚不能输出 `png` 图片；请写 `-o {svg}`",
            svg = words::path(&output.with_extension("svg"))
        ))),
        _ => Err(Failure::Usage(both!(
            "`{output}`: the ending of the file chooses the format: `.svg`, `.html` or `.json`",
            "`{output}`：文件的扩展名决定格式：`.svg`、`.html` 或 `.json`",
            output = words::path(output)
        ))),
    }
}

/// The ending of a file's name, in small letters.
pub(super) fn ending(output: &Path) -> String {
    let ending = output.extension().and_then(|e| e.to_str());
    ending.unwrap_or_default().to_ascii_lowercase()
}
