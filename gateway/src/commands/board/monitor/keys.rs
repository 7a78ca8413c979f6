//! What each key asks for, and whether it may be asked now.
//!
//! Pure: a key and what is known of the machine in; a wish or the words of a refusal out.

use leadscrew_core::alarm::{Alarm, Arg, Code};
use leadscrew_core::bus::BoardState;
use leadscrew_core::operating::{Interlock, OperatingMode, Towards};
use ratatui::crossterm::event::{KeyCode, KeyEvent, KeyModifiers};

use crate::cli::{AxisWay, HandWay, OverrideName, StepLength};
use crate::diagnostics::alarm_words;
use crate::words::{Both, both};

/// What a key asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wish {
    /// Feed hold, at once.
    Hold,
    /// Stop, at once.
    Stop,
    /// Go on; named first.
    Resume,
    /// Reset; named first.
    Reset,
    /// Begin the program that the board has; named first.
    Start,
    /// Find the references; named first.
    Home,
    /// Choose a mode.
    Modes,
    /// An override by this many percent.
    Override(OverrideName, i16),
    /// Single block on or off.
    SingleBlock,
    /// The way of a step.
    Increment(StepLength),
    /// What moves by hand.
    ByHand(HandWay, Speed),
    /// Show positions by the next work coordinate system.
    NextSystem,
    /// Show positions by the next tool.
    NextTool,
    /// Type a line.
    Line,
    /// What the keys do.
    Help,
    /// Leave.
    Quit,
}

/// At which speed an axis is to move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Speed {
    /// Parameter 9041.
    Feed,
    /// Parameter 9042.
    Rapid,
}

/// The ways of a step, by the keys 1 to 4.
pub const INCREMENTS: [StepLength; 4] = [
    StepLength { tenths: 10 },
    StepLength { tenths: 100 },
    StepLength { tenths: 1_000 },
    StepLength { tenths: 10_000 },
];

/// The wish of a key where nothing is open.
#[must_use]
pub fn wish(key: KeyEvent) -> Option<Wish> {
    if let Some(halt) = halt_by_letter(key) {
        return Some(halt);
    }
    if is_control(key, 'c') {
        return Some(Wish::Quit);
    }
    if key
        .modifiers
        .intersects(KeyModifiers::CONTROL | KeyModifiers::ALT | KeyModifiers::SUPER)
    {
        return None;
    }
    let arrow = |on_z, towards| {
        let speed = if key.modifiers.contains(KeyModifiers::SHIFT) {
            Speed::Rapid
        } else {
            Speed::Feed
        };
        Some(Wish::ByHand(
            HandWay::Axis(AxisWay { on_z, towards }),
            speed,
        ))
    };
    let letter = match key.code {
        KeyCode::Up => return arrow(false, Towards::Plus),
        KeyCode::Down => return arrow(false, Towards::Minus),
        KeyCode::Right => return arrow(true, Towards::Plus),
        KeyCode::Left => return arrow(true, Towards::Minus),
        KeyCode::Char(letter) => letter.to_ascii_lowercase(),
        _ => return None,
    };
    Some(match letter {
        'r' => Wish::Resume,
        'e' => Wish::Reset,
        'g' => Wish::Start,
        'h' => Wish::Home,
        'm' => Wish::Modes,
        'u' => Wish::Override(OverrideName::Feed, 10),
        'j' => Wish::Override(OverrideName::Feed, -10),
        'i' => Wish::Override(OverrideName::Rapid, 25),
        'k' => Wish::Override(OverrideName::Rapid, -25),
        'o' => Wish::Override(OverrideName::Spindle, 10),
        'l' => Wish::Override(OverrideName::Spindle, -10),
        'f' => Wish::ByHand(HandWay::Spindle(Towards::Plus), Speed::Feed),
        'v' => Wish::ByHand(HandWay::Spindle(Towards::Minus), Speed::Feed),
        'b' => Wish::SingleBlock,
        '1'..='4' => {
            let index = usize::from(letter as u8 - b'1');
            Wish::Increment(*INCREMENTS.get(index)?)
        }
        'w' => Wish::NextSystem,
        't' => Wish::NextTool,
        ':' | '：' => Wish::Line,
        '?' | '？' => Wish::Help,
        'q' => Wish::Quit,
        _ => return None,
    })
}

/// Hold and stop by the keys that mean it everywhere, also while a line is typed.
#[must_use]
pub const fn halt(key: KeyEvent) -> Option<Wish> {
    match key.code {
        KeyCode::F(8) => Some(Wish::Hold),
        KeyCode::F(9) => Some(Wish::Stop),
        _ => None,
    }
}

/// The same where no line is typed: Space and `s` too.
#[must_use]
pub const fn halt_by_letter(key: KeyEvent) -> Option<Wish> {
    match key.code {
        KeyCode::Char(' ' | '\u{3000}') => Some(Wish::Hold),
        KeyCode::Char('s' | 'S') if !key.modifiers.contains(KeyModifiers::CONTROL) => {
            Some(Wish::Stop)
        }
        _ => halt(key),
    }
}

/// Ctrl with this letter.
#[must_use]
pub fn is_control(key: KeyEvent, letter: char) -> bool {
    key.modifiers.contains(KeyModifiers::CONTROL) && key.code == KeyCode::Char(letter)
}

/// The mode of a letter.
#[must_use]
pub const fn mode_of(letter: char) -> Option<OperatingMode> {
    Some(match letter.to_ascii_lowercase() {
        'm' => OperatingMode::Manual,
        'i' => OperatingMode::Step,
        'w' => OperatingMode::Wheel,
        'r' => OperatingMode::Reference,
        'd' => OperatingMode::Mdi,
        'a' => OperatingMode::Automatic,
        _ => return None,
    })
}

/// What is known of the machine when a key is pressed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Situation {
    /// Its mode, where it is known.
    pub mode: Option<OperatingMode>,
    /// Its state.
    pub state: BoardState,
    /// A program is under way or held.
    pub program: bool,
    /// Feed hold is on.
    pub hold: bool,
    /// What is known is older than the page may be.
    pub old: bool,
    /// The board sends its beat.
    pub beats: bool,
    /// The terminal tells when a key is let go.
    pub tells_release: bool,
    /// A typed line is being carried out.
    pub typed: bool,
}

/// Why a wish is not passed on; `None` where it is. The board itself may refuse it all the same: here only that is refused
/// which would do something else, or nothing.
#[must_use]
pub fn refusal(wish: Wish, now: Situation) -> Option<Both> {
    if wish == Wish::Quit && now.typed {
        return Some(both!(
            "a typed line is under way: let it end, or stop it (s)",
            "输入行正在执行：请等其结束，或停止（s）"
        ));
    }
    let acts = matches!(
        wish,
        Wish::Resume
            | Wish::Start
            | Wish::Home
            | Wish::Modes
            | Wish::Override(..)
            | Wish::SingleBlock
            | Wish::ByHand(..)
            | Wish::Line
    );
    if acts && now.old {
        return Some(old());
    }
    match wish {
        Wish::ByHand(way, _) => by_hand(way, now),
        Wish::Home => by_mode(now, &[OperatingMode::Reference]),
        Wish::Start => by_mode(now, &[OperatingMode::Automatic, OperatingMode::Mdi]),
        Wish::Line if now.typed => Some(under_way()),
        Wish::Line => by_mode(now, &[OperatingMode::Mdi]),
        _ => None,
    }
}

/// Why a program that is named is not sent and begun; `None` where it is.
#[must_use]
pub fn no_program(now: Situation) -> Option<Both> {
    if now.old {
        return Some(old());
    }
    if now.typed {
        return Some(under_way());
    }
    by_mode(now, &[OperatingMode::Automatic])
}

/// A command in a process of its own is asked for, or under way.
#[must_use]
pub fn under_way() -> Both {
    alarm_words(&Alarm::of(Code::ProgramUnderWay, &[]))
}

/// Why a tool is not touched off; `None` where the board is asked. The mode for references would be left for it, and a page
/// changes no mode.
#[must_use]
pub fn no_touch(now: Situation) -> Option<Both> {
    let alarm = match now.mode {
        _ if now.old => return Some(old()),
        _ if now.typed => Alarm::of(Code::OffsetsAtWork, &[]),
        Some(mode @ OperatingMode::Reference) => Alarm::of(
            Code::WrongMode,
            &[Arg::Mode(OperatingMode::Manual), Arg::Mode(mode)],
        ),
        _ => return None,
    };
    Some(alarm_words(&alarm))
}

/// What is known of the machine is older than what may be ordered by.
#[must_use]
pub fn old() -> Both {
    both!(
        "what the board says is old: nothing is ordered by it; hold and stop are sent all the same",
        "控制板数据已过时：不据此下达指令；保持与停止仍会发送"
    )
}

/// The same of what moves by hand. The spindle turns while it is held, and has no steps.
fn by_hand(way: HandWay, now: Situation) -> Option<Both> {
    let modes: &[OperatingMode] = match way {
        HandWay::Axis(_) => &[OperatingMode::Manual, OperatingMode::Step],
        HandWay::Spindle(_) => &[OperatingMode::Manual],
    };
    // A program in these modes is held and was left: its axes may move.
    let is_left = now.mode.is_some_and(|mode| modes.contains(&mode));
    let program = now.program && !is_left;
    if let Some(words) = by_mode(Situation { program, ..now }, modes) {
        return Some(words);
    }
    if now.hold {
        let hold = [Arg::Interlock(Interlock::Hold)];
        return Some(alarm_words(&Alarm::of(Code::Interlocked, &hold)));
    }
    if !now.beats {
        return Some(both!(
            "this board sends no beat (TPDO5, nodes 1 to 31), and nothing moves by hand without one",
            "此控制板不发送节拍（TPDO5，节点 1 至 31），没有节拍不能手动移动"
        ));
    }
    if now.mode != Some(OperatingMode::Manual) || now.tells_release {
        return None;
    }
    Some(match way {
        HandWay::Axis(_) => both!(
            "this terminal does not tell when a key is let go: arrows move in steps, in mode step (m i)",
            "此终端不报告按键松开：方向键只能按增量移动，请切换到增量方式（m i）"
        ),
        HandWay::Spindle(_) => both!(
            "this terminal does not tell when a key is let go: turn the spindle by `leadscrew jog S+ --hold`",
            "此终端不报告按键松开：请用 `leadscrew jog S+ --hold` 转动主轴"
        ),
    })
}

/// What a program, an alarm and another mode than these refuse.
fn by_mode(now: Situation, modes: &[OperatingMode]) -> Option<Both> {
    let alarm = if now.program {
        Alarm::of(Code::ProgramUnderWay, &[])
    } else if now.state == BoardState::Alarm {
        Alarm::of(Code::AlarmStands, &[])
    } else {
        let (mode, needed) = (now.mode?, modes.first()?);
        if modes.contains(&mode) {
            return None;
        }
        Alarm::of(Code::WrongMode, &[Arg::Mode(*needed), Arg::Mode(mode)])
    };
    Some(alarm_words(&alarm))
}

#[cfg(test)]
mod tests;
