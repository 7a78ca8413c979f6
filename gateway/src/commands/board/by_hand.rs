//! `mode` and `jog`: the machine is operated by hand.
//!
//! The board moves only while frames with its newest beat come, so this side has nothing to stop: where it dies, the axis
//! comes to rest.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use leadscrew_core::bus::{Beat, JogRequest, StepRequest};
use leadscrew_core::call::Position;
use leadscrew_core::link::Status;
use leadscrew_core::operating::{OperatingMode, PressState, Towards};

use super::heard;
use super::monitor::hand::broken;
use crate::cli::{AxisWay, Global, HandWay, Jog, ModeName, StepLength};
use crate::diagnostics::alarm_words;
use crate::failure::{Failure, Outcome};
use crate::interrupt;
use crate::link::{Link, Seen};
use crate::number;
use crate::output;
use crate::words::{Both, both};

/// A press is renewed so often: with the beat of up to 10 ms before, well within the dead man's 100 ms.
pub const RENEWAL: Duration = Duration::from_millis(20);
/// The board's answer to a press comes with its beat, every 10 ms by default.
pub const ANSWER: Duration = Duration::from_secs(1);

/// No axis brakes for longer.
const BRAKES: Duration = Duration::from_secs(5);

/// Enter has been pressed.
static ENTER: AtomicBool = AtomicBool::new(false);

/// Changes the mode.
pub fn mode(global: &Global, name: ModeName) -> Outcome {
    let mut link = heard(global)?;
    link.change_mode(name.mode())?;
    let mode = link.mode()?;
    if global.json {
        return output::json(|json| {
            json.flag("ok", true);
            json.integer("node", i64::from(link.node().get()));
            json.text("mode", mode.name());
        });
    }
    let text = both!(
        "node {node}: mode {mode}\n",
        "节点 {node}：{mode} 方式\n",
        node = link.node().get(),
        mode = mode.name()
    );
    output::write(text.get(global.lang()).as_bytes())
}

/// Moves axes, or turns the spindle, by hand.
pub fn jog(global: &Global, jog: &Jog) -> Outcome {
    let wish = Wish::of(jog)?;
    let mut link = heard(global)?;
    let mode = match wish {
        Wish::Step { .. } => OperatingMode::Step,
        Wish::Hold { .. } => OperatingMode::Manual,
    };
    link.set_mode(mode)?;
    if let Wish::Hold { .. } = wish {
        await_enter(global);
    }
    let from = link.status()?.position;
    let end = Press::new(&link, wish).carry_out(&mut link)?;
    match wish {
        Wish::Step { on_z, way } => {
            let asked = Asked { from, on_z, way };
            tell_way(global, &mut link, end, Some(asked))
        }
        Wish::Hold { .. } => tell(global, &mut link, end),
    }
}

/// What is asked.
#[derive(Clone, Copy)]
enum Wish {
    /// A step of one axis, signed, in 0.1 µm of the slide.
    Step { on_z: bool, way: i32 },
    /// Axes move, or the spindle turns, until the end.
    Hold {
        x: Option<Towards>,
        z: Option<Towards>,
        spindle: Option<Towards>,
        rapid: bool,
        /// Of the slide in mm/min, of the spindle in rpm; 0: the machine's own.
        speed: u16,
    },
}

impl Wish {
    fn of(jog: &Jog) -> Outcome<Self> {
        let usage = |words: Both| Err(Failure::Usage(words));
        match (jog.by, jog.ways.as_slice()) {
            // A step's frame has no room for a speed.
            (Some(_), _) if jog.feed.is_some() || jog.rapid => usage(both!(
                "a step goes at the speed of parameter 9041 times the feed override: change that with `leadscrew override feed`, \
                 or go with `--hold` instead of `--by`",
                "步进以参数 9041 乘以进给倍率的速度移动：请用 `leadscrew override feed` 改变倍率，或用 `--hold` 代替 `--by`"
            )),
            (Some(by), &[HandWay::Axis(way)]) => Self::step(by, way),
            (Some(_), &[HandWay::Spindle(_)]) => usage(both!(
                "the spindle turns as long as it is held: give it `--hold`",
                "主轴只在按住期间转动：请用 `--hold`"
            )),
            (Some(_), _) => usage(both!(
                "`--by` moves one axis: give the other one a step of its own",
                "`--by` 只移动一个轴：请对另一轴另行给出步距"
            )),
            (None, &[HandWay::Spindle(_)]) if jog.feed.is_some() || jog.rapid => usage(both!(
                "`--feed` and `--rapid` are of axes: the spindle has `--speed`",
                "`--feed` 和 `--rapid` 用于轴：主轴请用 `--speed`"
            )),
            (None, &[HandWay::Axis(_)]) | (None, &[_, _]) if jog.speed.is_some() => usage(both!(
                "`--speed` is of the spindle: an axis has `--feed`",
                "`--speed` 用于主轴：轴请用 `--feed`"
            )),
            (None, ways @ &[_]) => Ok(Self::hold(jog, ways)),
            (None, ways @ &[HandWay::Axis(one), HandWay::Axis(other)])
                if one.on_z != other.on_z =>
            {
                Ok(Self::hold(jog, ways))
            }
            (None, ways) if ways.iter().any(|way| way.of_spindle().is_some()) => usage(both!(
                "the spindle is turned alone: give the axis a command of its own",
                "主轴只能单独点动：轴请另用一条命令"
            )),
            (None, _) => usage(both!(
                "an axis goes one way at a time: give X and Z once each",
                "一个轴一次只能向一个方向移动：X 与 Z 各给一次"
            )),
        }
    }

    fn step(by: StepLength, way: AxisWay) -> Outcome<Self> {
        match by.of_slide(way) {
            Ok(slide) => Ok(Self::Step {
                on_z: way.on_z,
                way: slide,
            }),
            Err(mistake) => Err(Failure::Usage(mistake.0)),
        }
    }

    fn hold(jog: &Jog, ways: &[HandWay]) -> Self {
        let towards = |on_z| ways.iter().find_map(|way| way.of_axis(on_z));
        Self::Hold {
            x: towards(false),
            z: towards(true),
            spindle: ways.iter().find_map(|way| way.of_spindle()),
            rapid: jog.rapid,
            speed: jog.feed.or(jog.speed).unwrap_or(0),
        }
    }
}

/// How a press has ended.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum End {
    /// As it was asked.
    Done,
    /// At the limit of the travel.
    Limit,
    /// The board has ended it: a hold, an alarm, another order, or frames that came too late.
    Broken,
}

/// One press or step.
struct Press {
    session: u8,
    number: u8,
    wish: Wish,
}

impl Press {
    /// A session of this process, and a number that the board has not seen of it.
    fn new(link: &Link, wish: Wish) -> Self {
        let (session, number) = own(link);
        Self {
            session,
            number,
            wish,
        }
    }

    /// The frame with the newest beat.
    fn send(&self, link: &mut Link, released: bool) -> Outcome {
        let echo = link.beat()?;
        self.send_with(link, echo, released)
    }

    fn send_with(&self, link: &mut Link, echo: Beat, released: bool) -> Outcome {
        let frame = match self.wish {
            Wish::Step { on_z, way } => StepRequest {
                session: self.session,
                count: self.number,
                on_z,
                way,
                echo,
            }
            .frame(link.node()),
            Wish::Hold {
                x,
                z,
                spindle,
                rapid,
                speed,
            } => JogRequest {
                session: self.session,
                press: self.number,
                x: x.filter(|_| !released),
                z: z.filter(|_| !released),
                spindle: spindle.filter(|_| !released),
                rapid,
                speed,
                echo,
            }
            .frame(link.node()),
        };
        Ok(link.send(&[frame])?)
    }

    /// What became of it, once the board has it.
    fn state(&self, link: &Link) -> Option<PressState> {
        let told = link.seen.beat?;
        (told.session == self.session && told.press == self.number).then_some(told.state)
    }

    /// Renews the press until its end.
    fn carry_out(&self, link: &mut Link) -> Outcome<End> {
        let begun = Instant::now();
        let (mut released, mut ran) = (false, false);
        loop {
            released |= self.is_wanted_no_more();
            self.send(link, released)?;
            link.idle(RENEWAL)?;
            match self.state(link) {
                // What has ended a press that ran refuses its next frame; whoever tells the end tells that, too.
                Some(PressState::Refused) if ran => return Ok(End::Broken),
                Some(PressState::Refused) => {
                    return match link.refusal()? {
                        Some(reason) => Err(link.refused_by(reason).into()),
                        None => Ok(End::Broken),
                    };
                }
                Some(PressState::Limit) => return Ok(End::Limit),
                Some(PressState::Ended) if released || matches!(self.wish, Wish::Step { .. }) => {
                    return Ok(End::Done);
                }
                Some(PressState::Ended) => return Ok(End::Broken),
                Some(PressState::Runs) => ran = true,
                Some(PressState::None) => {}
                None if begun.elapsed() < ANSWER => {}
                None => return Err(refusal(link)),
            }
            link.check_alive()?;
        }
    }

    fn is_wanted_no_more(&self) -> bool {
        interrupt::requested() || ENTER.load(Ordering::Relaxed)
    }
}

/// A press of one axis that another command renews and ends.
pub struct Held(Press);

impl Held {
    /// Nothing has been sent yet.
    pub fn new(link: &Link, way: AxisWay, mm_per_min: u16) -> Self {
        let towards = |on_z| (way.on_z == on_z).then_some(way.towards);
        Self(Press::new(
            link,
            Wish::Hold {
                x: towards(false),
                z: towards(true),
                spindle: None,
                rapid: false,
                speed: mm_per_min,
            },
        ))
    }

    /// Renews it with this beat, or releases it; frames that have arrived are not read.
    ///
    /// # Errors
    /// The bus is closed.
    pub fn renew(&self, link: &mut Link, echo: Beat, released: bool) -> Outcome {
        self.0.send_with(link, echo, released)
    }

    /// What became of it, once the board has it.
    pub fn state(&self, link: &Link) -> Option<PressState> {
        self.0.state(link)
    }

    /// Why the board does not move.
    pub fn refusal(link: &mut Link) -> Failure {
        refusal(link)
    }
}

/// The session of this process, drawn when it is asked for first: in two containers processes have the same numbers. 255
/// is the board's own handwheel.
pub(super) fn session(seen: &Seen) -> u8 {
    static OWN: OnceLock<u8> = OnceLock::new();
    *OWN.get_or_init(|| {
        let mut chance = [0; 1];
        // A computer without random numbers has its processes told apart by their numbers.
        let chance = match getrandom::fill(&mut chance) {
            Ok(()) => chance[0],
            Err(_) => (std::process::id() % 254) as u8,
        };
        drawn(chance, seen.beat.map(|told| told.session))
    })
}

/// A session, not the one by which the machine was moved last.
fn drawn(chance: u8, last: Option<u8>) -> u8 {
    let session = chance % 254 + 1;
    if last == Some(session) {
        session % 254 + 1
    } else {
        session
    }
}

/// The session of this process, and a number that the board has not seen of it.
pub(super) fn own(link: &Link) -> (u8, u8) {
    let session = session(&link.seen);
    let last = link.seen.beat.filter(|told| told.session == session);
    (session, last.map_or(1, |told| told.press.wrapping_add(1)))
}

/// Why the board does not move.
pub(super) fn refusal(link: &mut Link) -> Failure {
    match link.refusal() {
        Err(trouble) => trouble.into(),
        Ok(Some(reason)) => link.refused_by(reason).into(),
        Ok(None) => {
            let node = link.node().get();
            Failure::Bus(both!(
                "node {node} does not answer to a press: its RPDO2 to RPDO4 and TPDO5 have to be in use (1401h to 1403h, 1804h)",
                "节点 {node} 对手动请求没有应答：其 RPDO2 至 RPDO4 与 TPDO5 须启用（1401h 至 1403h、1804h）"
            ))
        }
    }
}

/// Waits for Enter in a thread of its own. The end of the input is none: a script has no keyboard.
fn await_enter(global: &Global) {
    if !global.json {
        let text = both!(
            "moving until Enter or Ctrl-C",
            "移动中，按 Enter 或 Ctrl-C 停止"
        );
        eprintln!("{}", text.get(global.lang()));
    }
    std::thread::spawn(|| {
        let mut line = String::new();
        if std::io::stdin()
            .read_line(&mut line)
            .is_ok_and(|read| read > 0)
        {
            ENTER.store(true, Ordering::Relaxed);
        }
    });
}

/// The way that was asked for.
#[derive(Clone, Copy)]
struct Asked {
    from: Position,
    on_z: bool,
    /// Signed, in 0.1 µm of the slide.
    way: i32,
}

impl Asked {
    /// The way that was made, and the one that was asked for, in nanometres, X in diameter.
    fn lengths(&self, to: &Position) -> (i64, i64) {
        let asked = i64::from(self.way).saturating_mul(100);
        match self.on_z {
            true => ((to.z - self.from.z).nm(), asked),
            false => (
                (to.x - self.from.x).nm().saturating_mul(2),
                asked.saturating_mul(2),
            ),
        }
    }
}

/// Where the machine has come to.
pub(super) fn tell(global: &Global, link: &mut Link, end: End) -> Outcome {
    tell_way(global, link, end, None)
}

/// The machine stands. An alarm and a hold are told while it still brakes.
fn stands(link: &mut Link) -> Outcome<Status> {
    link.wait_at_rest()?;
    let mut status = link.status()?;
    let end = Instant::now() + BRAKES;
    loop {
        link.idle(RENEWAL)?;
        let now = link.status()?;
        if now.position == status.position || Instant::now() >= end {
            return Ok(now);
        }
        status = now;
    }
}

/// Where the machine has come to. The board tells of a step that something else has cut short as of one that was made: how
/// far it came says which.
fn tell_way(global: &Global, link: &mut Link, end: End, asked: Option<Asked>) -> Outcome {
    // The answer comes before the axis stands.
    let status = stands(link)?;
    let lengths = asked.map(|asked| (asked, asked.lengths(&status.position)));
    let short = lengths.filter(|(_, (made, asked))| made != asked);
    let end = match end {
        End::Done if short.is_some() => End::Broken,
        end => end,
    };
    let ok = end != End::Broken && short.is_none();
    let (x, z) = (
        status.position.x.nm().saturating_mul(2),
        status.position.z.nm(),
    );
    let name = match end {
        End::Done => "done",
        End::Limit => "limit",
        End::Broken => "ended",
    };
    if global.json {
        output::json(|json| {
            json.flag("ok", ok);
            json.integer("node", i64::from(link.node().get()));
            json.text("end", name);
            json.decimal::<6>("mx", x);
            json.decimal::<6>("mz", z);
        })?;
    } else {
        let why = match end {
            End::Done => both!("", ""),
            End::Limit => both!(
                ", at the limit of the travel or a zone",
                "，已到行程极限或禁区"
            ),
            End::Broken => both!(", ended by the board", "，由控制板结束"),
        };
        let text = both!(
            "node {node}: machine X {x} Z {z}{en}\n",
            "节点 {node}：机床坐标 X {x} Z {z}{zh}\n",
            node = link.node().get(),
            x = number::text::<6>(x),
            z = number::text::<6>(z),
            en = why.en,
            zh = why.zh
        );
        output::write(text.get(global.lang()).as_bytes())?;
    }
    if ok {
        return Ok(());
    }
    let reason = match end {
        End::Limit => both!("the travel or a zone ends there", "该处为行程极限或禁区"),
        _ => why_broken(&status),
    };
    let Some((asked, (made, wanted))) = short else {
        return Err(Failure::MachineBecause(reason));
    };
    Err(Failure::MachineBecause(both!(
        "{axis} has gone {made} of {wanted} mm: {en}",
        "{axis} 只移动了 {made} / {wanted} mm：{zh}",
        axis = if asked.on_z { 'Z' } else { 'X' },
        made = number::text::<6>(made),
        wanted = number::text::<6>(wanted),
        en = reason.en,
        zh = reason.zh
    )))
}

/// What has ended a motion, as far as the board tells it.
fn why_broken(status: &Status) -> Both {
    match status.alarm {
        Some(alarm) => alarm_words(&alarm),
        None if status.hold => both!(
            "a feed hold has ended it; `leadscrew resume` takes the hold away",
            "被进给保持结束；`leadscrew resume` 解除保持"
        ),
        None => broken(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_session_is_none_that_another_has() {
        for chance in 0..=u8::MAX {
            let own = drawn(chance, None);
            assert!((1..=254).contains(&own), "{chance}");
            let other = drawn(chance, Some(own));
            assert!((1..=254).contains(&other) && other != own, "{chance}");
        }
        // It stays as it was drawn, whoever moves the machine meanwhile.
        let seen = Seen::default();
        assert_eq!(session(&seen), session(&seen));
    }
}
