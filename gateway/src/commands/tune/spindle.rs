//! `tune spindle`: runs the spindle up to speeds and back to rest, as typed lines would, and hears what the board tells of
//! it meanwhile.
//!
//! The lines go the way of every program, so checks, interlocks and a hold are those of a program. What the bus carries is
//! heard beside it, by [`Overheard`]; `crate::tuning::spindle` computes, [`turned`](super::turned) tells.

use std::fmt::Write as _;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use leadscrew_can::{Can, CanError, Filter, Received};
use leadscrew_core::bus::{BoardSpindle, CobId, FdFrame, Frame, NodeId};
use leadscrew_core::link::Status;
use leadscrew_core::params::Params;
use leadscrew_core::units::Rpm;

use super::telling;
use super::turned::{self, Swing, Told};
use crate::cli::{Global, Run, Tune};
use crate::commands::board::{Greeted, Machine, Work, perform_on};
use crate::failure::{Failure, Outcome};
use crate::link::Link;
use crate::source::SourceFile;
use crate::tuning::spindle::{Known, Look, look};
use crate::words::both;

/// Name of the lines in messages.
const NAME: &str = "tune spindle";
/// Seconds for each speed where none are given.
const SECONDS: u16 = 20;
/// Most speeds.
const MOST: usize = 6;
/// The ramp may take so many times as long as 9004 says.
const PATIENCE: u64 = 3;
/// Time besides ramp and speed, in ms: before the spindle starts, and around the time that is looked at.
const AROUND: u64 = 2_000;

/// Turns, finds, tells, and writes where that was asked.
pub fn run(global: &Global, args: &Tune) -> Outcome {
    refuse(args)?;
    let file = telling::file(args)?;
    let seconds = args.seconds.unwrap_or(SECONDS);
    let params = Machine::meet(global)?.params;
    within(&args.speeds, &params)?;
    let lines = SourceFile::text(NAME, lines(&args.speeds, seconds, params.spindle_ramp_ms()));
    let ear = Arc::new(Mutex::new(Ear::new(global.board()?, &params)));
    let mut meet = |global: &Global| {
        let inner = leadscrew_can::open(&global.bus, global.bit_rate()?).map_err(Failure::bus)?;
        let ear = Arc::clone(&ear);
        let can = Box::new(Overheard { inner, ear });
        let mut link = Link::on(can, global.board()?);
        link.hear_boards()?;
        Greeted::on(link)?.read()
    };
    let mut begin = |_: &mut _, status: &Status| at_rest(status);
    let done = perform_on(
        global,
        &lines,
        &Run::default(),
        Work::Typed,
        &mut meet,
        &mut begin,
    )?;
    let dropped = done.link.dropped();
    drop(done.link);
    done.verdict?;
    let mut ear = ear.lock().unwrap_or_else(PoisonError::into_inner);
    let looks = ear.take(dropped)?;
    let asked: Vec<f64> = args.speeds.iter().copied().map(f64::from).collect();
    let known = Known {
        seconds: f64::from(seconds),
        band: band(&params, &args.speeds),
    };
    let found = look(&looks, &asked, &known).map_err(|why| turned::refusal(&why))?;
    let told = Told {
        ramp_ms: params.spindle_ramp_ms(),
        variation: params.spindle_variation_percent().into(),
        swing: Swing {
            before: params.spindle_swing(),
            is_learned: params.resolution().with_swing().is_learned(),
        },
        known,
        looks,
        found,
    };
    telling::finish(global, args, file, &told)
}

/// Refuses what would be ignored, and too few speeds.
fn refuse(args: &Tune) -> Outcome {
    let option = if args.dead_time.is_some() {
        "--dead-time"
    } else if args.feed_forward.is_some() {
        "--feed-forward"
    } else if args.age.is_some() {
        "--age"
    } else {
        if !(2..=MOST).contains(&args.speeds.len()) {
            return Err(Failure::Usage(both!(
                "name the speeds that this spindle and what it holds may turn at, two to {MOST}: `tune spindle --speeds \
                 210,500,890`",
                "请给出主轴及其夹持物允许的转速，两到 {MOST} 个：`tune spindle --speeds 210,500,890`"
            )));
        }
        return Ok(());
    };
    Err(Failure::Usage(both!(
        "`{option}` is for the drive of an axis, not for `tune spindle`",
        "`{option}` 用于轴的驱动器，不能用于 `tune spindle`"
    )))
}

/// No speed is above what the machine allows.
fn within(speeds: &[u16], params: &Params) -> Outcome {
    let highest = params.spindle_max_rpm();
    match speeds.iter().find(|speed| u32::from(**speed) > highest) {
        None => Ok(()),
        Some(speed) => Err(Failure::Usage(both!(
            "`--speeds {speed}`: the highest speed of this spindle is {highest} rpm (3772)",
            "`--speeds {speed}`：此主轴的最高转速为 {highest} r/min（3772）"
        ))),
    }
}

/// The program: from rest to each speed, and to rest again.
fn lines(speeds: &[u16], seconds: u16, ramp_ms: u32) -> String {
    let mut lines = format!("G97\nG4 P{AROUND}\n");
    for speed in speeds {
        let ramp = u64::from(ramp_ms) * u64::from(*speed) / 1000 * PATIENCE;
        let turning = u64::from(seconds) * 1000 + ramp + AROUND;
        let resting = ramp + AROUND;
        let _ = write!(lines, "M3 S{speed}\nG4 P{turning}\nM5\nG4 P{resting}\n");
    }
    lines
}

/// What changes faster than this is not seen whole: half of the rate of looks with some room, and the board's observer at
/// the lowest of the speeds.
fn band(params: &Params, speeds: &[u16]) -> f64 {
    let looks_a_second = 1000.0 / f64::from(params.status_period_ms());
    let slowest = speeds.iter().copied().min().unwrap_or(0);
    let observer = params.resolution().bandwidth_at(slowest.into());
    f64::min(0.4 * looks_a_second, f64::from(observer))
}

/// The spindle stands, and its override leaves the speeds as they are.
fn at_rest(status: &Status) -> Outcome {
    if status.command != Rpm::STOPPED {
        return Err(Failure::MachineBecause(both!(
            "the spindle turns: `leadscrew mdi M5` stops it, and run-ups begin from rest",
            "主轴正在转动：请先用 `leadscrew mdi M5` 停止，测量从静止开始"
        )));
    }
    let percent = status.spindle_percent;
    if percent != 100 {
        return Err(Failure::MachineBecause(both!(
            "the spindle override is {percent} %, so the speeds would not be those that were named: `leadscrew override spindle 100`",
            "主轴倍率为 {percent} %，转速将与所给不符：请执行 `leadscrew override spindle 100`"
        )));
    }
    Ok(())
}

/// What was heard of the spindle.
#[derive(Debug)]
struct Ear {
    node: NodeId,
    /// SYNC period in seconds.
    tick: f64,
    /// SYNCs from one status to the next.
    period: u64,
    syncs: u64,
    /// SYNCs before the last look.
    last: Option<u64>,
    looks: Vec<Look>,
    /// A status did not come where it had to.
    uneven: bool,
}

impl Ear {
    fn new(node: NodeId, params: &Params) -> Self {
        let ticks = u64::from(params.status_period_ms()) * 1000 / u64::from(params.tick_us());
        Self {
            node,
            tick: f64::from(params.tick_us()) * 1e-6,
            period: ticks.max(1),
            syncs: 0,
            last: None,
            looks: Vec::new(),
            uneven: false,
        }
    }

    fn hear(&mut self, frame: &Frame) {
        if frame.id() == CobId::SYNC {
            self.syncs += 1;
            return;
        }
        let Some((node, spindle)) = BoardSpindle::decode(frame) else {
            return;
        };
        if node != self.node {
            return;
        }
        if let Some(last) = self.last {
            self.uneven |= self.syncs - last != self.period;
        }
        self.last = Some(self.syncs);
        self.looks.push(Look {
            time: self.syncs as f64 * self.tick,
            angle: spindle.angle.raw() as f64 / (1_u64 << 32) as f64,
            speed: f64::from(spindle.speed.get()) / 1000.0,
        });
    }

    /// The looks, where none is missing.
    fn take(&mut self, dropped: u64) -> Outcome<Vec<Look>> {
        if self.looks.is_empty() || self.syncs == 0 {
            return Err(Failure::Bus(both!(
                "the board tells nothing of its spindle: TPDO3 (1802h) or SYNC is not on this bus",
                "控制板未报告主轴：此总线上没有 TPDO3（1802h）或 SYNC"
            )));
        }
        if dropped > 0 || self.uneven {
            return Err(Failure::Bus(both!(
                "frames were lost, or the board's status did not come at its period (9022, 1802h): the looks have gaps; try again with \
                 less beside it on this computer",
                "报文丢失，或控制板状态未按周期（9022、1802h）到达：采样不完整；请减少本机其他负载后重试"
            )));
        }
        Ok(std::mem::take(&mut self.looks))
    }
}

/// A bus of which every frame is shown to an ear, too.
struct Overheard {
    inner: Box<dyn Can>,
    ear: Arc<Mutex<Ear>>,
}

impl Can for Overheard {
    fn name(&self) -> &str {
        self.inner.name()
    }

    fn send(&mut self, frames: &[Frame]) -> Result<(), CanError> {
        self.inner.send(frames)
    }

    fn use_fd(&mut self, data_kbit: u32) -> Result<(), CanError> {
        self.inner.use_fd(data_kbit)
    }

    fn send_fd(&mut self, frames: &[FdFrame]) -> Result<(), CanError> {
        self.inner.send_fd(frames)
    }

    fn receive(&mut self, into: &mut Vec<Received>, patience: Duration) -> Result<usize, CanError> {
        let before = into.len();
        let count = self.inner.receive(into, patience)?;
        let mut ear = self.ear.lock().unwrap_or_else(PoisonError::into_inner);
        for received in into.iter().skip(before) {
            if let Some(frame) = received.packet.frame() {
                ear.hear(frame);
            }
        }
        Ok(count)
    }

    fn listen_for(&mut self, filters: &[Filter]) -> Result<(), CanError> {
        if filters.is_empty() {
            return self.inner.listen_for(filters);
        }
        // SYNC is the clock of the looks.
        let with_sync = [filters, &[Filter::exactly(CobId::SYNC)]].concat();
        self.inner.listen_for(&with_sync)
    }

    fn dropped(&self) -> Result<u64, CanError> {
        self.inner.dropped()
    }
}

#[cfg(test)]
mod tests {
    use leadscrew_core::params::Entry;

    use super::*;

    #[test]
    fn the_lines_leave_time_for_a_slow_spindle() {
        assert_eq!(
            lines(&[200, 500], 20, 600),
            "G97\nG4 P2000\nM3 S200\nG4 P22360\nM5\nG4 P2360\nM3 S500\nG4 P22900\nM5\nG4 P2900\n"
        );
    }

    #[test]
    fn what_an_encoder_of_few_counts_hides_is_not_looked_for() {
        let of = |sets: &[(&str, i64)]| {
            let mut params = Params::slant_bed();
            for (number, value) in sets {
                params
                    .set(Entry::find_text(number).unwrap(), *value)
                    .unwrap();
            }
            band(&params, &[500, 211])
        };
        // 35 Hz of 9005, and statuses every 10 ms.
        assert_eq!(of(&[]), 35.0);
        assert_eq!(of(&[("9022", 20)]), 20.0);
        // 64 counts at 211 rpm are 225 a second: an eighth of them with times, a twentieth without.
        assert_eq!(of(&[("3720", 64), ("9006.0", 1)]), 28.0);
        assert_eq!(of(&[("3720", 64), ("9006.0", 0)]), 11.0);
    }

    #[test]
    fn a_look_that_is_missing_is_noticed() {
        let status = BoardSpindle::default().frame(NodeId::BOARD);
        let sync = Frame::new(CobId::SYNC, &[]).unwrap();
        let heard = |gaps: &[u32], dropped| {
            let mut ear = Ear::new(NodeId::BOARD, &Params::slant_bed());
            for gap in gaps {
                for _ in 0..*gap {
                    ear.hear(&sync);
                }
                ear.hear(&status);
            }
            ear.take(dropped)
        };
        assert_eq!(heard(&[3, 10, 10], 0).unwrap().len(), 3);
        for (gaps, dropped) in [(&[3, 10, 9][..], 0), (&[3, 20, 10], 0), (&[3, 10, 10], 1)] {
            let told = heard(gaps, dropped).unwrap_err();
            assert!(matches!(told, Failure::Bus(_)), "{gaps:?}");
        }
        assert!(heard(&[], 0).is_err());
    }
}
