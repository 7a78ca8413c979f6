//! What the picture says: all that is known of a board, as rows of words for each of its parts.
//!
//! Pure: values in, words out. Knows no terminal, no bus and no key; where the words stand is `draw`'s.

use std::collections::VecDeque;
use std::time::Duration;

use leadscrew_core::alarm::Lang;
use leadscrew_core::bus::{BoardPlace, BoardSpindle, BoardState, BoardStatus};
use leadscrew_core::link::Status;
use leadscrew_core::operating::OperatingMode;
use leadscrew_core::signals::{Signal, Signals};
use leadscrew_core::units::{Axis, Length};

use super::told::Told;
use crate::commands::board::state_words;
use crate::number;
use crate::place::SourceLine;
use crate::words::{Both, both, pick};

/// Values that are older are shown as old.
pub const OLD: Duration = Duration::from_millis(250);

/// How a row is meant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tone {
    /// As it comes.
    #[default]
    Plain,
    /// All is well.
    Good,
    /// Something waits, or is held.
    Care,
    /// An alarm.
    Bad,
    /// What it says was true some time ago.
    Old,
}

/// Words on one line.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Row {
    /// The words.
    pub text: String,
    /// How they are meant.
    pub tone: Tone,
}

impl Row {
    /// Words in a tone.
    pub fn new(text: impl Into<String>, tone: Tone) -> Self {
        let text = text.into();
        Self { text, tone }
    }
}

/// A work zero by which positions are shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Zero {
    /// 54 to 59.
    pub system: u8,
    /// The tool offset; 0: none.
    pub tool: u8,
    /// Where it is in machine coordinates, X on the radius.
    pub at: [Length; 2],
}

/// All that is known.
#[derive(Clone, Debug)]
pub struct View {
    /// The bus, as it was named.
    pub bus: String,
    /// The board.
    pub node: u8,
    /// Language of the words.
    pub lang: Lang,
    /// The status record, and its age.
    pub record: Option<(Status, Duration)>,
    /// TPDO1, newer than the record, and the age of its last frame.
    pub pdo: Option<(BoardStatus, Duration)>,
    /// The mode.
    pub mode: Option<OperatingMode>,
    /// TPDO2.
    pub place: Option<BoardPlace>,
    /// TPDO3.
    pub spindle: Option<BoardSpindle>,
    /// The work zero that positions are shown by; `None`: the board's offsets are not known.
    pub zero: Option<Zero>,
    /// What the last typed line has left in force, as words that would set it; `None`: something else has run since.
    pub modal: Option<String>,
    /// Load of the bus with the worst stuffing.
    pub load_percent: u64,
    /// Synchronism errors, oldest first, nanometres.
    pub errors: VecDeque<u64>,
    /// Alarms and events, oldest first.
    pub messages: VecDeque<Told>,
    /// The last line: what is asked, typed or answered.
    pub prompt: Row,
    /// What the keys do, below it; empty where there are none.
    pub hint: String,
}

impl View {
    /// Nothing is known yet.
    #[must_use]
    pub fn new(bus: &str, node: u8, lang: Lang) -> Self {
        Self {
            bus: bus.to_owned(),
            node,
            lang,
            record: None,
            pdo: None,
            mode: None,
            place: None,
            spindle: None,
            zero: None,
            modal: None,
            load_percent: 0,
            errors: VecDeque::new(),
            messages: VecDeque::new(),
            prompt: Row::default(),
            hint: String::new(),
        }
    }

    fn word(&self, words: &Both) -> String {
        words.get(self.lang).to_owned()
    }

    /// Mode and state, and how old they are.
    #[must_use]
    pub fn head(&self) -> Row {
        let Some((status, age)) = self.pdo else {
            let text = both!("the board says nothing yet", "控制板尚无数据");
            return Row::new(self.word(&text), Tone::Care);
        };
        let mut parts = Vec::new();
        if let Some(mode) = self.mode {
            parts.push(mode_words(mode, self.lang).to_uppercase());
        }
        let state = state_words(status.state, self.lang);
        parts.push(match status.alarm {
            Some(number) => format!("{state} {number:04}"),
            None => state.to_owned(),
        });
        for (is_on, words) in [
            (
                status.flags.hold && status.state != BoardState::Hold,
                pick(self.lang, "feed hold", "进给保持"),
            ),
            (
                status.flags.single_block,
                pick(self.lang, "single block", "单段"),
            ),
            (status.flags.dry_run, pick(self.lang, "dry run", "空运行")),
        ] {
            if is_on {
                parts.push(words.to_owned());
            }
        }
        let tone = match status.state {
            _ if age > OLD => Tone::Old,
            BoardState::Alarm => Tone::Bad,
            BoardState::Hold | BoardState::Stopping => Tone::Care,
            _ if status.flags.hold => Tone::Care,
            _ => Tone::Good,
        };
        if age > OLD {
            parts.push(self.word(&aged(age)));
        }
        Row::new(parts.join("   "), tone)
    }

    /// Whose picture this is.
    #[must_use]
    pub fn whose(&self) -> String {
        let (bus, node) = (&self.bus, self.node);
        self.word(&both!("node {node} on {bus}", "{bus} 上的节点 {node}"))
    }

    /// The axes: by the work zero where it is known, and by the machine's.
    #[must_use]
    pub fn axes(&self) -> Vec<Row> {
        let Some((status, age)) = self.record else {
            return Vec::new();
        };
        let tone = if age > OLD { Tone::Old } else { Tone::Plain };
        let place = status.position;
        let zero = self.zero.map(|zero| zero.at);
        let by_zero = |at: Length, axis: usize, factor: i64| {
            zero.and_then(|zero| Some((at - *zero.get(axis)?).nm().saturating_mul(factor)))
        };
        let column = |value: Option<i64>| value.map_or(String::new(), fixed);
        let mut rows = vec![Row::new(self.axes_head(age), tone)];
        let values = [
            (
                Axis::X,
                "X ⌀",
                by_zero(place.x, 0, 2),
                place.x.nm().saturating_mul(2),
            ),
            (Axis::Z, "Z", by_zero(place.z, 1, 1), place.z.nm()),
            (Axis::C, "C °", None, place.c.udeg()),
        ];
        for (axis, name, work, machine) in values {
            let reference = if status.unreferenced.contains(axis) {
                pick(self.lang, "not ref.", "未回零")
            } else if status.referenced.contains(axis) {
                pick(self.lang, "ref.", "已回零")
            } else {
                ""
            };
            rows.push(Row::new(
                format!(
                    "{name:<3} {:>13} {:>13}  {reference}",
                    column(work),
                    fixed(machine)
                ),
                tone,
            ));
        }
        rows
    }

    /// Over the columns. A name in Chinese is two columns a letter wide.
    fn axes_head(&self, age: Duration) -> String {
        let mut text = match self.zero {
            None => " ".repeat(17),
            Some(zero) => {
                let name = format!("G{} T{:02}", zero.system, zero.tool);
                format!("{name:>17}")
            }
        };
        text += pick(self.lang, "       machine", "          机床");
        if age > OLD {
            text += "  ";
            text += &self.word(&aged(age));
        }
        text
    }

    /// The spindle and the overrides.
    #[must_use]
    pub fn spindle(&self) -> Vec<Row> {
        let mut rows = Vec::new();
        let old = |age: Duration| if age > OLD { Tone::Old } else { Tone::Plain };
        if let (Some(spindle), Some((_, age))) = (self.spindle, self.pdo) {
            let speed = number::rounded::<3>(i64::from(spindle.speed.get()), 1);
            let text = both!("measured {speed} rpm", "实测 {speed} r/min");
            rows.push(Row::new(self.word(&text), old(age)));
        }
        let Some((status, age)) = self.record else {
            return rows;
        };
        for text in [
            both!(
                "commanded {rpm} rpm",
                "指令 {rpm} r/min",
                rpm = status.command.get()
            ),
            both!(
                "override feed {feed} %, rapid {rapid} %",
                "倍率：进给 {feed} %，快速 {rapid} %",
                feed = status.feed_percent,
                rapid = status.rapid_percent
            ),
            both!(
                "override spindle {spindle} %",
                "倍率：主轴 {spindle} %",
                spindle = status.spindle_percent
            ),
        ] {
            rows.push(Row::new(self.word(&text), old(age)));
        }
        rows
    }

    /// The program, what is in force, the inputs, the bus.
    #[must_use]
    pub fn program(&self) -> Vec<Row> {
        let place = self.place.unwrap_or_default();
        let (pdo, age) = self.pdo.unwrap_or_default();
        let tone = if age > OLD { Tone::Old } else { Tone::Plain };
        let line = if place.line == 0 {
            both!("no line is under way", "没有正在执行的程序行")
        } else {
            both!(
                "line {line}, move {number}",
                "第 {line} 行，第 {number} 段移动",
                line = SourceLine(place.line),
                number = place.number
            )
        };
        let modal = match &self.modal {
            Some(words) => both!(
                "in force for the next typed line: {words}",
                "下一输入行的有效状态：{words}"
            ),
            None => both!("in force: the board does not say", "有效状态：控制板不提供"),
        };
        let rows = [
            (line, tone),
            (modal, Tone::Plain),
            (self.inputs(), tone),
            (self.network(pdo), tone),
        ];
        rows.into_iter()
            .map(|(words, tone)| Row::new(self.word(&words), tone))
            .collect()
    }

    /// The inputs that are on.
    fn inputs(&self) -> Both {
        let bits = self.record.map_or(0, |(status, _)| status.signals);
        let (mut en, mut zh) = (Vec::new(), Vec::new());
        if let Some(signals) = Signals::from_bits(bits) {
            for signal in Signal::ALL {
                let mut alone = Signals::POWER_UP;
                alone.set(signal, true);
                // RGTAP has a second bit: whether it has a level at all.
                if signals.bits() & alone.bits() == alone.bits() {
                    en.push(signal.name());
                    zh.push(signal.name());
                }
            }
        }
        for (bit, words) in [
            (Signals::HOLD, ["feed hold", "进给保持"]),
            (Signals::SINGLE_BLOCK, ["single block", "单段"]),
            (Signals::STOP, ["stop circuit open", "停止回路断开"]),
        ] {
            if bits & bit != 0 {
                let [english, chinese] = words;
                en.push(english);
                zh.push(chinese);
            }
        }
        let list = |words: Vec<&str>, none: &str| {
            if words.is_empty() {
                none.to_owned()
            } else {
                words.join(" · ")
            }
        };
        let (en, zh) = (list(en, "none"), list(zh, "无"));
        both!("inputs on: {en}", "有效输入：{zh}")
    }

    fn network(&self, pdo: BoardStatus) -> Both {
        let error = self.spindle.and_then(|spindle| spindle.sync_error);
        let worst = self.errors.iter().max().copied().unwrap_or(0);
        let worst = number::text::<3>(i64::try_from(worst).unwrap_or(i64::MAX));
        let error = error.map_or_else(
            || "-".to_owned(),
            |error| number::text::<3>(error.abs().nm()),
        );
        both!(
            "bus load {load} %   late setpoints {late}   synchronism {error} µm, worst {worst} µm",
            "总线负载 {load} %   迟到设定值 {late} 个   同步误差 {error} µm，最大 {worst} µm",
            load = self.load_percent,
            late = pdo.late
        )
    }
}

/// How old values are.
fn aged(age: Duration) -> Both {
    let seconds = number::text::<1>(i64::try_from(age.as_millis() / 100).unwrap_or(i64::MAX));
    both!("{seconds} s old", "{seconds} 秒前的数据")
}

/// A mode, for people.
#[must_use]
pub const fn mode_words(mode: OperatingMode, lang: Lang) -> &'static str {
    match mode {
        OperatingMode::Manual => pick(lang, "manual", "手动"),
        OperatingMode::Step => pick(lang, "step", "增量"),
        OperatingMode::Wheel => pick(lang, "wheel", "手轮"),
        OperatingMode::Reference => pick(lang, "reference", "回零"),
        OperatingMode::Mdi => pick(lang, "mdi", "MDI"),
        OperatingMode::Automatic => pick(lang, "automatic", "自动"),
    }
}

/// Millionths as a decimal with four places, all of them: a figure that changes stays where it is.
fn fixed(value: i64) -> String {
    let tenths = value.saturating_add(value.signum().saturating_mul(50)) / 100;
    let (whole, part) = (
        tenths.unsigned_abs() / 10_000,
        tenths.unsigned_abs() % 10_000,
    );
    let sign = if tenths < 0 { "-" } else { "" };
    format!("{sign}{whole}.{part:04}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_figure_keeps_its_places() {
        for (value, text) in [
            (0, "0.0000"),
            (49, "0.0000"),
            (-49, "0.0000"),
            (50, "0.0001"),
            (-50, "-0.0001"),
            (-1_234_567_890, "-1234.5679"),
            (38_420_000, "38.4200"),
        ] {
            assert_eq!(fixed(value), text);
        }
    }
}
