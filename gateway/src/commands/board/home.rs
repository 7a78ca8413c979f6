//! `home`: the axes find their references. It waits for the end, and Ctrl-C cancels.
//!
//! The command sends the gateway's heartbeat: where it ends, or its bus does, the board stops homing (4521).

use std::path::Path;
use std::time::{Duration, Instant};

use leadscrew_core::alarm::{Alarm, Code, Lang};
use leadscrew_core::bus::{BoardState, Order};
use leadscrew_core::link::{Event, Status};
use leadscrew_core::operating::OperatingMode;
use leadscrew_core::units::{Axes, Axis};

use super::open;
use crate::cli::{Global, HomeAxis};
use crate::diagnostics::{self, Diagnostic};
use crate::failure::{Failure, Outcome};
use crate::interrupt::{self, UnderWay};
use crate::link::Link;
use crate::number;
use crate::output;
use crate::source::SourceFile;
use crate::words::both;

/// From one look at the board to the next.
const LOOK: Duration = Duration::from_millis(100);

/// An order acts within this time.
const BEGINS: Duration = Duration::from_millis(300);

/// The gateway's heartbeat.
const BEAT: Duration = Duration::from_millis(200);

/// Homes these axes; none: all that have a way to home.
pub fn home(global: &Global, axes: &[HomeAxis]) -> Outcome {
    let mut link = open(global)?;
    link.greet()?;
    link.keep_alive(BEAT);
    let asked = axes
        .iter()
        .fold(Axes::NONE, |all, axis| all.with(axis.axis()));
    let wanted = if asked.is_empty() { Axes::ALL } else { asked };
    let home = wanted.and(link.axes_that_home()?);
    interrupt::defer(UnderWay::Machine);
    link.set_mode(OperatingMode::Reference)?;
    let last = link.newest_event()?;
    let before = link.status()?.referenced;
    link.order(Order::Home(asked))?;
    let ended = wait(&mut link, global, before)?;
    // What the tick refuses is in the event log alone.
    let told = link.events_behind(last)?;
    if let Some(reason) = told.iter().find_map(|entry| no_method(&entry.event)) {
        return Err(link.refused_by(reason).into());
    }
    let status = ended.status;
    // An axis that was referenced before may have lost its reference and found it again between two looks.
    let is_quiet = !told.iter().any(|entry| is_against(&entry.event));
    if is_quiet && !ended.interrupted && status.alarm.is_none() {
        let found = home.and(status.referenced);
        found_at(global, &status, found.minus(ended.told))?;
    }
    let missing = wanted.minus(status.referenced);
    tell(global, link.node().get(), &status, missing)?;
    if let Some(alarm) = status.alarm {
        let source = SourceFile::new(Path::new("the program on the board"));
        let lang = global.lang();
        diagnostics::print(&Diagnostic::new(&alarm, &source, lang, false), false);
        return Err(Failure::Machine);
    }
    if ended.interrupted {
        return Err(Failure::Interrupted);
    }
    if !missing.is_empty() {
        return Err(Failure::MachineBecause(both!(
            "not referenced: {axes}",
            "未回零：{axes}",
            axes = names(missing)
        )));
    }
    Ok(())
}

/// The refusal to home axes of which none has a way to.
fn no_method(event: &Event) -> Option<Alarm> {
    match event {
        Event::Warning(alarm) if alarm.code == Code::HomeMethodNone => Some(*alarm),
        _ => None,
    }
}

/// Something was refused, or has failed.
const fn is_against(event: &Event) -> bool {
    matches!(event, Event::Warning(_) | Event::Alarm(_))
}

/// The end of homing.
struct Ended {
    status: Status,
    /// Axes whose references have been told.
    told: Axes,
    interrupted: bool,
}

/// Waits until nothing homes any more, and tells each axis that has found its reference.
fn wait(link: &mut Link, global: &Global, mut before: Axes) -> Outcome<Ended> {
    let begun = Instant::now();
    let mut interrupted = false;
    let mut told = Axes::NONE;
    loop {
        link.idle(LOOK)?;
        link.check_alive()?;
        if interrupt::requested() && !interrupted {
            interrupted = true;
            link.order(Order::Cancel)?;
        }
        let status = link.status()?;
        let found = status.referenced.minus(before);
        found_at(global, &status, found)?;
        told = told.or(found);
        before = status.referenced;
        let works = matches!(
            status.state,
            BoardState::Run | BoardState::Hold | BoardState::Stopping | BoardState::Starting
        );
        if !works && begun.elapsed() > BEGINS {
            return Ok(Ended {
                status,
                told,
                interrupted,
            });
        }
    }
}

/// Tells where these axes have found their references.
fn found_at(global: &Global, status: &Status, axes: Axes) -> Outcome {
    if global.json {
        return Ok(());
    }
    for axis in axes.each() {
        let place = position(status, axis);
        let line = both!(
            "{axis} referenced at {place}\n",
            "{axis} 已回零，位置 {place}\n",
            axis = char::from(axis.letter())
        );
        output::write(line.get(global.lang()).as_bytes())?;
    }
    Ok(())
}

/// Where an axis is in machine coordinates, X as a diameter.
fn position(status: &Status, axis: Axis) -> String {
    number::text::<6>(match axis {
        Axis::X => status.position.x.nm().saturating_mul(2),
        Axis::Z => status.position.z.nm(),
        Axis::C => status.position.c.udeg(),
    })
}

/// `X Z`.
pub fn names(axes: Axes) -> String {
    let names: Vec<String> = axes
        .each()
        .map(|axis| char::from(axis.letter()).to_string())
        .collect();
    names.join(" ")
}

fn tell(global: &Global, node: u8, status: &Status, missing: Axes) -> Outcome {
    if global.json {
        return output::json(|json| {
            json.flag("ok", missing.is_empty() && status.alarm.is_none());
            json.integer("node", i64::from(node));
            json.text("state", status.state.name());
            json.text("referenced", &names(status.referenced));
            json.text("unreferenced", &names(missing));
            match status.alarm {
                Some(alarm) => json.integer("alarm", i64::from(alarm.number())),
                None => json.null("alarm"),
            }
        });
    }
    let lang: Lang = global.lang();
    let line = both!(
        "node {node}: referenced {axes}\n",
        "节点 {node}：已回零 {axes}\n",
        axes = names(status.referenced)
    );
    output::write(line.get(lang).as_bytes())
}
