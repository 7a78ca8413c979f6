//! The strokes: presses of one axis, and what the bus shows of it meanwhile.

use std::time::Instant;

use leadscrew_core::board::DriveNodes;
use leadscrew_core::bus::{CobId, Frame, NodeId, Service};
use leadscrew_core::operating::{PressState, Towards};
use leadscrew_core::units::Axis;

use crate::cli::AxisWay;
use crate::commands::board::{ANSWER, Held, Machine, RENEWAL};
use crate::diagnostics::alarm_words;
use crate::failure::{Failure, Outcome};
use crate::interrupt;
use crate::link::Link;
use crate::tuning::Sample;
use crate::words::both;

/// Constant part of a stroke in seconds: 8/Kv of a drive of Kv 15, half a second, and a little.
const CONSTANT: f64 = 1.1;
/// Time at rest behind a stroke, in seconds.
const REST: f64 = 0.7;
/// The longest stroke, in seconds.
const LONGEST: f64 = 20.0;
/// Shares of the highest jogging speed, in tenths.
const SPEEDS: [u32; 3] = [1, 3, 5];

/// What has been heard.
pub struct Heard {
    pub runs: [Vec<Vec<Sample>>; 2],
    /// At the end of each stroke.
    pub rest: Vec<Sample>,
}

impl Heard {
    /// A count of the encoder: the shortest distance between two actual positions.
    pub fn quantum(&self, increment: f64) -> f64 {
        let all = self.runs.iter().flatten().flatten();
        let mut at: Vec<f64> = all.filter_map(|sample| sample.actual).collect();
        at.sort_by(f64::total_cmp);
        let steps = at.windows(2).map(|pair| pair[1] - pair[0]);
        let least = steps.filter(|step| *step > increment / 2.0);
        least.fold(f64::INFINITY, f64::min).max(increment)
    }
}

/// Moves to and fro at three speeds, twice.
pub fn make(
    machine: &mut Machine,
    way: AxisWay,
    axis: Axis,
    increment: f64,
    tick: f64,
) -> Outcome<Heard> {
    let node = DriveNodes::of(&machine.params).axis(axis);
    let highest = machine.params.manual_rapid().nm_per_min() / 1_000_000;
    let link = &mut machine.link;
    link.hear_everything()?;
    let mut runs = [Vec::new(), Vec::new()];
    let mut rest = Vec::new();
    for run in &mut runs {
        for tenths in SPEEDS {
            let speed = highest * i64::from(tenths) / 10;
            let speed = u16::try_from(speed.clamp(1, 60_000)).unwrap_or(u16::MAX);
            for towards in [way.towards, opposite(way.towards)] {
                let way = AxisWay { towards, ..way };
                let stroke = one(link, way, speed, Ear::new(node, increment, tick))?;
                let still = (0.2 / tick) as usize;
                // The rests have different places: only one is a measure of noise.
                rest = stroke[stroke.len().saturating_sub(still)..].to_vec();
                run.push(stroke);
            }
        }
    }
    Ok(Heard { runs, rest })
}

const fn opposite(towards: Towards) -> Towards {
    match towards {
        Towards::Plus => Towards::Minus,
        Towards::Minus => Towards::Plus,
    }
}

/// One stroke, from rest to rest.
fn one(link: &mut Link, way: AxisWay, speed: u16, mut ear: Ear) -> Outcome<Vec<Sample>> {
    link.beat()?;
    let lost = link.dropped();
    let held = Held::new(link, way, speed);
    let begun = Instant::now();
    let mut released = false;
    loop {
        let until = Instant::now() + RENEWAL;
        link.listen(until, &mut |frame| {
            ear.hear(frame);
            false
        })?;
        if interrupt::requested() {
            return Err(Failure::Interrupted);
        }
        released |= ear.constant() >= CONSTANT;
        match held.state(link) {
            Some(PressState::Refused) => return Err(Held::refusal(link)),
            Some(PressState::Limit) => {
                return Err(Failure::WrongBecause(both!(
                    "a stroke has come to the limit of the travel: begin farther from it, or with the other direction",
                    "行程已到极限：请从离极限更远处开始，或改用另一方向"
                )));
            }
            None if begun.elapsed() > ANSWER => return Err(Held::refusal(link)),
            _ if ear.samples.is_empty() && begun.elapsed() > ANSWER => return Err(unheard()),
            Some(PressState::Ended) if !released => return Err(broken(link)?),
            _ => {}
        }
        if ear.time() > LONGEST {
            return Err(broken(link)?);
        }
        if released && ear.still() >= REST {
            break;
        }
        if let Some(told) = link.seen.beat {
            held.renew(link, told.beat, released)?;
        }
        link.check_alive()?;
    }
    if link.dropped() != lost {
        return Err(Failure::Bus(both!(
            "this computer has lost frames of the bus: the samples have gaps",
            "本机丢失了总线报文：采样不完整"
        )));
    }
    Ok(ear.samples)
}

/// The setpoints are not on this bus as they are looked for.
fn unheard() -> Failure {
    Failure::Bus(both!(
        "no setpoints of this axis are heard: they are looked for in RPDO1 of its drive (9014, 9015), not in one frame for all \
         (9031)",
        "未听到该轴的设定值：只在其驱动器的 RPDO1（9014、9015）中查找，不支持合并报文（9031）"
    ))
}

/// Why a stroke has not reached its end.
fn broken(link: &mut Link) -> Outcome<Failure> {
    let why = match link.status()?.alarm {
        Some(alarm) => alarm_words(&alarm),
        None => both!(
            "a stroke has not reached its end: a feed hold, a feed override that changes, another operator, or frames that came \
             too late (9040)",
            "行程未能完成：进给保持、进给倍率变化、其他操作者，或报文到达过晚（9040）"
        ),
    };
    Ok(Failure::MachineBecause(why))
}

/// Hears the setpoints and actual positions of one drive.
struct Ear {
    node: NodeId,
    increment: f64,
    tick: f64,
    setpoint: Option<f64>,
    samples: Vec<Sample>,
    /// The step of the setpoint since the counter began.
    step: f64,
    /// Ticks with this step.
    same: u32,
}

impl Ear {
    const fn new(node: NodeId, increment: f64, tick: f64) -> Self {
        Self {
            node,
            increment,
            tick,
            setpoint: None,
            samples: Vec::new(),
            step: 0.0,
            same: 0,
        }
    }

    fn hear(&mut self, frame: &Frame) {
        if frame.id() == CobId::SYNC {
            self.sync();
            return;
        }
        let Some((service, node)) = frame.id().service() else {
            return;
        };
        if node != self.node {
            return;
        }
        let Some(&[_, _, a, b, c, d]) = frame.payload().get(..6).and_then(|of| of.as_array())
        else {
            return;
        };
        let at = f64::from(i32::from_le_bytes([a, b, c, d])) * self.increment;
        match service {
            Service::Rpdo1 => self.setpoint = Some(at),
            Service::Tpdo1 => {
                if let Some(sample) = self.samples.last_mut() {
                    sample.actual = Some(at);
                }
            }
            _ => {}
        }
    }

    /// This SYNC latches the setpoint before it; the actual positions behind it are of its time.
    fn sync(&mut self) {
        let Some(setpoint) = self.setpoint else {
            return;
        };
        if let Some(last) = self.samples.last() {
            let step = setpoint - last.setpoint;
            if (step - self.step).abs() > 1.5 * self.increment {
                (self.step, self.same) = (step, 0);
            }
            self.same += 1;
        }
        self.samples.push(Sample {
            setpoint,
            actual: None,
            following: None,
        });
    }

    fn is_moving(&self) -> bool {
        self.step.abs() > 1.5 * self.increment
    }

    /// For so long it has had the same speed.
    fn constant(&self) -> f64 {
        f64::from(self.same) * self.tick * f64::from(u8::from(self.is_moving()))
    }

    /// For so long it has been at rest.
    fn still(&self) -> f64 {
        f64::from(self.same) * self.tick * f64::from(u8::from(!self.is_moving()))
    }

    fn time(&self) -> f64 {
        self.samples.len() as f64 * self.tick
    }
}
