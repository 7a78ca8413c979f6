//! `measure`: what a program cuts, measured as an inspector does.

use crate::cli::Measure;
use crate::diagnostics;
use crate::execution::Execution;
use crate::failure::{Doing, Failure, Outcome};
use crate::inspection::plan::{Wish, plan};
use crate::inspection::samples::Cutting;
use crate::inspection::{Cut, result, sheet};
use crate::json::Json;
use crate::output;
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
    let mut execution = Execution::prepare(setup, &source)?;
    let wish = Wish {
        threads: args.thread.clone(),
        tools: args.tool.clone(),
        surface: args.surface.map(Into::into),
        face: args.face.map(Into::into),
    };
    let (jobs, along_x) = plan(setup, &source, &wish)?;
    let mut cutting = Cutting::new(Summary::new(&setup.params), jobs);
    execution.run(&args.drive, &mut cutting)?;
    if !execution.is_whole() {
        return execution.conclude(&cutting.summary, None);
    }
    let cuts = cutting.finish();
    let good = cuts.iter().all(|cut| cut.verdict() != Some(false));
    let json = || {
        let mut json = Json::new();
        json.object(|json| {
            json.flag("ok", good);
            result::fields(&cuts, along_x, json);
            execution.origin_fields(json);
        });
        json
    };
    if let Some(path) = &args.output {
        let mut bytes = json().into_bytes();
        bytes.push(b'\n');
        std::fs::write(path, bytes)
            .map_err(|error| Failure::file(Doing::Write, path.display(), &error))?;
    }
    if setup.global.json {
        output::json(|out| {
            out.flag("ok", good);
            result::fields(&cuts, along_x, out);
            execution.origin_fields(out);
        })?;
    } else {
        tell(setup, &cuts, along_x);
    }
    if good { Ok(()) } else { Err(Failure::Wrong) }
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
    let ending = output
        .extension()
        .and_then(|e| e.to_str())
        .unwrap_or_default();
    match ending.to_ascii_lowercase().as_str() {
        "json" => Ok(()),
        _ => Err(Failure::Usage(both!(
            "`{output}`: the ending of the file chooses the format: `.json`",
            "`{output}`：文件的扩展名决定格式：`.json`",
            output = words::path(output)
        ))),
    }
}
