//! The strokes: presses of one axis, and what the bus shows of it meanwhile.

use std::time::Instant;

use leadscrew_core::board::DriveNodes;
use leadscrew_core::bus::{Beat, CobId, Frame, NodeId, Service};
use leadscrew_core::operating::{PressState, Towards};
use leadscrew_core::units::Axis;

use crate::cli::AxisWay;
use crate::commands::board::{ANSWER, Held, Machine, RENEWAL};
use crate::diagnostics::alarm_words;
use crate::failure::{Failure, Outcome};
use crate::interrupt;
use crate::link::Link;
use crate::tuning::{Pace, Sample};
use crate::words::both;

/// Constant part of a stroke in seconds: 8/Kv of a drive of Kv 15, half a second, and a little.
const CONSTANT: f64 = 1.1;
/// Time at rest behind a stroke, in seconds.
const REST: f64 = 0.7;
/// The longest that a press is held, in seconds of the board: the constant part, ramps, and a drive of Kv 5 that knows
/// all of its speed beforehand.
const HELD: f64 = 4.0;
/// The longest stroke, in seconds: behind the press the axis only comes to rest.
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

/// What targets on the bus mean.
#[derive(Clone, Copy)]
pub struct Scale {
    /// An increment in µm.
    pub increment: f64,
    /// The SYNC period in seconds.
    pub tick: f64,
    pub pace: Pace,
}

/// Moves to and fro at three speeds, twice.
pub fn make(machine: &mut Machine, way: AxisWay, axis: Axis, scale: Scale) -> Outcome<Heard> {
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
                let stroke = one(link, way, speed, Ear::new(node, scale))?;
                let still = (0.2 / scale.tick) as usize;
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
    let mut pressed = Pressed::at(speed);
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
        if !released && pressed.is_over(ear.way()) {
            return Err(unsteady(ear.way()));
        }
        if ear.time() > LONGEST {
            return Err(broken(link)?);
        }
        if released && ear.still() >= REST {
            break;
        }
        if let Some(told) = link.seen.beat {
            pressed.goes_on(told.beat);
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

/// A press that was held for long enough, and its targets were not.
fn unsteady(way: f64) -> Failure {
    let mm = way / 1000.0;
    Failure::MachineBecause(both!(
        "the targets of a stroke have not come to one speed in {HELD} s and {mm:.1} mm, and it was ended: an acceleration (1620) \
         too low for its jog speed, a feed override that changes, or another board's targets under the number of this drive (9015)",
        "在 {HELD} s、{mm:.1} mm 内行程的目标值未达到恒定速度，已结束：加速度（1620）对其点动速度过低、进给倍率在变化，或另一控制板以此驱动器的编号（9015）发送目标值"
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

/// A press, by the board's own time: nothing that is heard, or not heard, holds it longer or moves its axis farther.
struct Pressed {
    last: Option<Beat>,
    /// In seconds.
    time: f64,
    /// The longest way, in µm.
    farthest: f64,
}

impl Pressed {
    /// At so many mm/min.
    fn at(speed: u16) -> Self {
        Self {
            last: None,
            time: 0.0,
            farthest: HELD * f64::from(speed) * 1000.0 / 60.0,
        }
    }

    fn goes_on(&mut self, beat: Beat) {
        let last = self.last.replace(beat);
        let ms = last.and_then(|last| beat.age_of(last)).unwrap_or(0);
        self.time += f64::from(ms) / 1000.0;
    }

    fn is_over(&self, way: f64) -> bool {
        self.time > HELD || way > self.farthest
    }
}

/// Hears the setpoints and actual positions of one drive.
struct Ear {
    node: NodeId,
    scale: Scale,
    setpoint: Option<f64>,
    samples: Vec<Sample>,
    /// The mean step of the setpoint when the counter began.
    step: f64,
    /// Ticks with this step.
    same: u32,
}

impl Ear {
    const fn new(node: NodeId, scale: Scale) -> Self {
        Self {
            node,
            scale,
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
        let at = f64::from(i32::from_le_bytes([a, b, c, d])) * self.scale.increment;
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
        self.samples.push(Sample {
            setpoint,
            actual: None,
            following: None,
        });
        let pace = self.scale.pace;
        let newest_first = self.samples.iter().rev().map(|sample| sample.setpoint);
        let Some(step) = pace.at_the_end(newest_first) else {
            return;
        };
        if !pace.is_one(step, self.step) {
            (self.step, self.same) = (step, 0);
        }
        self.same += 1;
    }

    fn is_moving(&self) -> bool {
        !self.scale.pace.rests(self.step)
    }

    /// For so long it has had the same speed.
    fn constant(&self) -> f64 {
        f64::from(self.same) * self.scale.tick * f64::from(u8::from(self.is_moving()))
    }

    /// For so long it has been at rest.
    fn still(&self) -> f64 {
        f64::from(self.same) * self.scale.tick * f64::from(u8::from(!self.is_moving()))
    }

    fn time(&self) -> f64 {
        self.samples.len() as f64 * self.scale.tick
    }

    /// How far the setpoint is from where it began.
    fn way(&self) -> f64 {
        let at = |sample: Option<&Sample>| sample.map_or(0.0, |sample| sample.setpoint);
        (at(self.samples.last()) - at(self.samples.first())).abs()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TICK: f64 = 1e-3;

    fn ear() -> Ear {
        let scale = Scale {
            increment: 0.1,
            tick: TICK,
            pace: Pace::of(0.1, TICK, Some(30.0)),
        };
        Ear::new(NodeId::new(17).unwrap(), scale)
    }

    fn told(ear: &mut Ear, um: f64) {
        let [a, b, c, d] = ((um * 10.0) as i32).to_le_bytes();
        let id = CobId::of(Service::Rpdo1, ear.node);
        ear.hear(&Frame::new(id, &[0x0F, 0, a, b, c, d]).unwrap());
        ear.hear(&Frame::new(CobId::SYNC, &[1]).unwrap());
    }

    #[test]
    fn a_press_ends_whatever_is_heard() {
        // At 600 mm/min, 10 mm/s. Nothing is heard, and the board's time goes on.
        let mut pressed = Pressed::at(600);
        for ms in (0_u16..).step_by(10).take(401) {
            assert!(!pressed.is_over(0.0), "{ms}");
            pressed.goes_on(Beat::new(ms.wrapping_add(65_000)));
        }
        pressed.goes_on(Beat::new(4010_u16.wrapping_add(65_000)));
        assert!(pressed.is_over(0.0));
        // It gets faster and faster, and the board's time stands.
        let (pressed, mut ear) = (Pressed::at(600), ear());
        let mut at = 0.0;
        for tick in 0.. {
            at -= f64::from(tick) * 0.05;
            told(&mut ear, at);
            if pressed.is_over(ear.way()) {
                break;
            }
            assert!(ear.constant() < CONSTANT, "{tick}");
        }
        assert!((40_000.0..40_100.0).contains(&ear.way()), "{}", ear.way());
    }

    #[test]
    fn a_stroke_is_constant_and_then_still() {
        let mut ear = ear();
        let mut at = 0.0;
        for tick in 0..1200 {
            // 8.33 mm/s, with what the lead makes of half nanometres.
            at -= 8.33;
            told(&mut ear, at + [0.066, -0.066, 0.03][tick % 3]);
        }
        assert!(ear.constant() > CONSTANT && ear.still() < TICK);
        for _ in 0..800 {
            told(&mut ear, at);
        }
        assert!(ear.constant() < TICK && ear.still() > REST);
    }
}
