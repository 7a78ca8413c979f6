//! Runs a program on the machine in this process: the simulated board, drives and spindle, in virtual time.

use leadscrew_board_sim::plant::{FineTurns, PlantError, PlantOptions, Ripple, ServoOptions};
use leadscrew_board_sim::{Direction, Row, Sim, SimError};
use leadscrew_core::alarm::{Alarm, Code};
use leadscrew_core::board::{Command, Event};
use leadscrew_core::bus::{FdFrame, Frame};
use leadscrew_core::call::{Aux, Call};
use leadscrew_core::offsets::Offsets;
use leadscrew_core::units::{Length, Turns};
use leadscrew_language::variables::Kept;

use crate::cli::Drive;
use crate::diagnostics::Diagnostic;
use crate::failure::{Failure, Outcome};
use crate::feeder::{Feeder, placed};
use crate::interrupt::{self, UnderWay};
use crate::setup::Setup;
use crate::source::SourceFile;
use crate::start::has_arrived;
use crate::threads::Threads;
use crate::trace::{Cut, Setpoint, SpindlePoint, TapPlace};
use crate::values;
use crate::words::{Both, both};

/// The end of a run.
#[derive(Debug, Default)]
pub struct Ended {
    /// Alarms that stopped the machine.
    pub alarms: Vec<Diagnostic>,
    /// Warnings of the machine; the first of each kind.
    pub warnings: Vec<Diagnostic>,
    /// The user has ended the run, and the machine has come to rest.
    pub interrupted: bool,
    /// The power was taken away, as requested.
    pub cut: bool,
    /// The board's measurements of each thread.
    pub threads: Threads,
    /// The variables that the program has left, or its last pass that came to its end.
    pub variables: Option<Kept>,
    /// The program has written offsets and come to its end.
    pub writes_offsets: bool,
}

/// Watches a run.
pub trait Observer {
    /// Takes the setpoint of the next tick.
    fn setpoint(&mut self, point: &Setpoint) -> Outcome;

    /// Takes a frame on the wire at the tick after `tick`.
    fn frame(&mut self, tick: u64, direction: Direction, frame: &Frame) {
        let _ = (tick, direction, frame);
    }

    /// Takes the frame with all setpoints, which follows the other frames of its tick.
    fn together(&mut self, tick: u64, frame: &FdFrame) {
        let _ = (tick, frame);
    }
}

/// What was typed of a ripple, for a plant.
///
/// # Errors
/// No spindle can have it.
pub fn ripple(typed: Option<values::Ripple>) -> Outcome<Option<Ripple>> {
    let Some(typed) = typed else {
        return Ok(None);
    };
    let ripple = Ripple::new(typed.milli_percent, typed.milli_hz);
    ripple.map(Some).ok_or_else(|| {
        Failure::Usage(both!(
            "the spindle cannot have this ripple",
            "主轴不可能有这样的波动"
        ))
    })
}

/// A machine at power-up.
fn power_up(setup: &Setup, drive: &Drive, servos: [Option<ServoOptions>; 2]) -> Outcome<Box<Sim>> {
    let ripple = ripple(drive.spindle_ripple)?;
    let options = PlantOptions {
        at: setup.power_up(),
        ripple,
        servos,
        ..PlantOptions::default()
    };
    let sim = match &setup.kept {
        Some((_, flash)) => Sim::with_flash(&setup.params, &options, flash.clone()),
        // A machine without a state file has the parameters of the options.
        None => match setup.offsets.map(|offsets| written(offsets).encode()) {
            Some(Ok(table)) => Sim::with_offsets(&setup.params, &options, table),
            // A table that was read has nothing out of its range.
            _ => Sim::new(&setup.params, &options),
        },
    };
    let mut sim = sim
        .map(Box::new)
        .map_err(|error| no_machine(setup, error))?;
    sim.signals(setup.signals);
    Ok(sim)
}

/// The table as one that a board keeps: without a revision its parameters would count.
const fn written(table: Offsets) -> Offsets {
    Offsets {
        revision: table.revision.next(),
        ..table
    }
}

/// Words for an impossible machine.
fn no_machine(setup: &Setup, error: SimError) -> Failure {
    let reason = match error {
        SimError::Plant(PlantError::Position(axis)) => both!(
            "`--at` puts {axis} where its drive cannot count to",
            "`--at` 把 {axis} 轴放到了驱动器计数范围之外",
            axis = char::from(axis.letter())
        ),
        SimError::Plant(error) => both!(
            "the parameters make no simulated machine: {error:?}",
            "这组参数构不成一台模拟机床：{error:?}"
        ),
        SimError::Board(alarm) => {
            let nowhere = SourceFile::new(std::path::Path::new("the simulated board"));
            Both::same(Diagnostic::new(&alarm, &nowhere, setup.lang, false).message)
        }
    };
    Failure::WrongBecause(reason)
}

/// Runs a program from its first to its last call, with these drives of X and Z.
pub fn run(
    setup: &Setup,
    drive: &Drive,
    servos: [Option<ServoOptions>; 2],
    source: &SourceFile,
    observer: &mut dyn Observer,
) -> Outcome<Ended> {
    let mut sim = power_up(setup, drive, servos)?;
    interrupt::defer(UnderWay::Computed);
    let ended = carry_out(&mut sim, setup, source, observer);
    // In any case, what is stored stays stored.
    if let Some((state, _)) = &setup.kept {
        state.save(sim.flash())?;
    }
    ended
}

fn carry_out(
    sim: &mut Sim,
    setup: &Setup,
    source: &SourceFile,
    observer: &mut dyn Observer,
) -> Outcome<Ended> {
    let mut feeder = Feeder::new(setup, source)?;
    let mut waiting = None;
    let mut ended = Ended::default();
    let mut stopping = false;
    let mut tick = 0;
    let mut line = 0;
    loop {
        if interrupt::requested() && !stopping {
            stopping = true;
            ended.interrupted = true;
            sim.command(Command::Hold);
        }
        let ticker = sim.board().ticker();
        let (speed, command) = (ticker.observer().speed().rpm(), ticker.spindle_command());
        let waits = feeder.awaits_spindle() && !has_arrived(speed, command, &setup.params);
        if !stopping && !waits {
            feed(&mut feeder, &mut waiting, sim, &mut ended)?;
        }
        if setup.global.cut_power == Some(tick) {
            ended.threads.take(sim.board().device().threads());
            ended.threads.give_up();
            sim.cut_power();
            ended.cut = true;
            return Ok(ended);
        }
        let row = sim.step_on(&mut |direction, frame| observer.frame(tick, direction, frame));
        if let Some(frame) = sim.together() {
            observer.together(tick, frame);
        }
        tick += 1;
        let newest = sim.board().device().threads().next();
        if newest.is_some_and(|thread| thread.number != ended.threads.newest()) {
            // The threads before the run.
            ended.threads.take(sim.board().device().threads());
        }
        if let Some(row) = row {
            observer.setpoint(&setpoint(&row))?;
        }
        while let Some(event) = sim.event() {
            match event {
                Event::Started { line: started, .. } => line = started,
                Event::Alarm(alarm) => {
                    stopping = true;
                    ended.alarms.push(feeder.words(&placed(alarm, line)));
                }
                // Whoever stands at a machine that lives in one command is quick.
                Event::Warning(Alarm {
                    code: Code::ToolByHand,
                    ..
                })
                | Event::Aux(Aux::M(0 | 1)) => sim.command(Command::Resume),
                Event::Warning(warning)
                    if ended.warnings.iter().all(|w| w.number != warning.number()) =>
                {
                    ended.warnings.push(feeder.words(&warning));
                }
                _ => {}
            }
        }
        if stopping {
            if at_rest(sim) {
                break;
            }
        } else if feeder.is_over() && waiting.is_none() && !sim.is_busy() {
            // Mistakes that the text has after all end it, too.
            if ended.alarms.is_empty() {
                ended.variables = Some(feeder.variables().clone());
                ended.writes_offsets = feeder.written_offsets().is_some();
            }
            if !feeder.next_pass() {
                break;
            }
        }
    }
    ended.threads.take(sim.board().device().threads());
    ended.threads.give_up();
    let mut result = Ok(());
    sim.last_rows(|row| {
        if result.is_ok() {
            result = observer.setpoint(&setpoint(&row));
        }
    });
    result.map(|()| ended)
}

/// Feeds as many calls as there is room for.
fn feed(
    feeder: &mut Feeder,
    waiting: &mut Option<Call>,
    sim: &mut Sim,
    ended: &mut Ended,
) -> Outcome {
    loop {
        if let Some(call) = waiting
            && !sim.offer(call)
        {
            return Ok(());
        }
        *waiting = feeder.next_call(&mut ended.alarms)?;
        if waiting.is_none() {
            return Ok(());
        }
    }
}

/// True when a hold or a stop has ended.
fn at_rest(sim: &Sim) -> bool {
    use leadscrew_core::board::State as Board;
    matches!(
        sim.board().ticker().state(),
        Board::Idle | Board::Held | Board::Alarm(_)
    )
}

fn micro_turns(turns: Turns) -> i64 {
    FineTurns::from_turns(turns).micro_turns()
}

fn setpoint(row: &Row) -> Setpoint {
    Setpoint {
        tick: row.tick,
        x_nm: row.position.x.nm(),
        z_nm: row.position.z.nm(),
        c_udeg: row.position.c.udeg(),
        s1_urev: row.spindle.micro_turns(),
        s1_set_urev: row.spindle_set.map(micro_turns),
        tappers: row.tappers.map(|spindle| SpindlePoint {
            urev: spindle.truth.micro_turns(),
            set_urev: spindle.set.map(micro_turns),
        }),
        line: row.line,
        step: u64::from(row.number),
        state: row.doing,
        error_nm: row.error.map(|error| error.nm()),
        tap: row.tap.map(|tap| TapPlace {
            depth_nm: tap.depth.nm(),
            turned_urev: micro_turns(tap.turned),
            skew_nm: tap.skew.nm(),
        }),
        actual_nm: row.actual.map(|actual| actual.map(Length::nm)),
        cut: row.cut.map(|cut| Cut {
            angle_raw: cut.angle.raw(),
            error_nm: cut.error.nm(),
            lead_nm: cut.lead.nm(),
        }),
    }
}
