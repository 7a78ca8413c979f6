//! The picture of `monitor`: what is known of a board, laid out on a terminal of any size.

use std::collections::VecDeque;

use leadscrew_core::alarm::Lang;
use leadscrew_core::bus::{BoardPlace, BoardSpindle, BoardState, BoardStatus};
use leadscrew_core::link::Status;
use ratatui::Frame;
use ratatui::layout::{Constraint, Layout};
use ratatui::style::{Color, Modifier, Style};
use ratatui::text::Line;
use ratatui::widgets::{Block, Gauge, Paragraph, Sparkline};

use crate::commands::board::state_words;
use crate::number;
use crate::place::SourceLine;
use crate::words::{both, pick};

/// What is known.
#[derive(Debug)]
pub struct View {
    bus: String,
    node: u8,
    /// Language of the labels.
    pub lang: Lang,
    /// The status record.
    pub status: Option<Status>,
    /// TPDO1, newer than the record.
    pub pdo: Option<BoardStatus>,
    /// TPDO2.
    pub place: Option<BoardPlace>,
    /// TPDO3.
    pub spindle: Option<BoardSpindle>,
    /// Load of the bus with the worst stuffing.
    pub load_percent: u64,
    /// Synchronism errors, oldest first, nanometres.
    pub errors: VecDeque<u64>,
    /// Alarms and events, oldest first.
    pub messages: VecDeque<String>,
}

impl View {
    /// Nothing is known yet.
    #[must_use]
    pub fn new(bus: &str, node: u8, lang: Lang) -> Self {
        Self {
            bus: bus.to_owned(),
            node,
            lang,
            status: None,
            pdo: None,
            place: None,
            spindle: None,
            load_percent: 0,
            errors: VecDeque::new(),
            messages: VecDeque::new(),
        }
    }
}

/// Draws it.
pub fn draw(frame: &mut Frame, view: &View) {
    let lang = view.lang;
    let [head, machine, program, errors, load, messages] = Layout::vertical([
        Constraint::Length(1),
        Constraint::Length(6),
        Constraint::Length(4),
        Constraint::Length(5),
        Constraint::Length(3),
        Constraint::Min(3),
    ])
    .areas(frame.area());
    frame.render_widget(headline(view), head);

    let [axes, spindle] =
        Layout::horizontal([Constraint::Percentage(50), Constraint::Percentage(50)]).areas(machine);
    frame.render_widget(
        Paragraph::new(axis_lines(view)).block(Block::bordered().title(pick(
            lang,
            " axes (machine) ",
            " 轴（机床坐标） ",
        ))),
        axes,
    );
    frame.render_widget(
        Paragraph::new(spindle_lines(view)).block(Block::bordered().title(pick(
            lang,
            " spindle ",
            " 主轴 ",
        ))),
        spindle,
    );
    frame.render_widget(
        Paragraph::new(program_lines(view)).block(Block::bordered().title(pick(
            lang,
            " program ",
            " 程序 ",
        ))),
        program,
    );
    let worst = view.errors.iter().max().copied().unwrap_or(0);
    let worst = number::text::<3>(i64::try_from(worst).unwrap_or(i64::MAX));
    let title = both!(
        " synchronism error, worst {worst} µm ",
        " 同步误差，最大 {worst} µm "
    );
    let shown: Vec<u64> = {
        let room = usize::from(errors.width.saturating_sub(2));
        let from = view.errors.len().saturating_sub(room);
        view.errors.iter().skip(from).copied().collect()
    };
    frame.render_widget(
        Sparkline::default()
            .data(&shown)
            .style(Style::new().fg(Color::Red))
            .block(Block::bordered().title(title.get(lang))),
        errors,
    );
    let full = view.load_percent.min(100);
    frame.render_widget(
        Gauge::default()
            .percent(u16::try_from(full).unwrap_or(100))
            .gauge_style(Style::new().fg(if full < 80 { Color::Green } else { Color::Red }))
            .block(Block::bordered().title(pick(lang, " bus load ", " 总线负载 "))),
        load,
    );
    let room = usize::from(messages.height.saturating_sub(2));
    let from = view.messages.len().saturating_sub(room);
    let lines: Vec<Line> = view
        .messages
        .iter()
        .skip(from)
        .map(|text| Line::raw(text.as_str()))
        .collect();
    frame.render_widget(
        Paragraph::new(lines).block(Block::bordered().title(pick(
            lang,
            " alarms and events ",
            " 报警与事件 ",
        ))),
        messages,
    );
}

fn headline(view: &View) -> Line<'static> {
    let state = view.pdo.map_or(BoardState::Starting, |status| status.state);
    let alarm = view.pdo.and_then(|status| status.alarm);
    let word = state_words(state, view.lang);
    let text = both!(
        " node {node} on {bus}   {word}{alarm}   (q ends the view)",
        " {bus} 上的节点 {node}   {word}{alarm}   （按 q 退出）",
        node = view.node,
        bus = view.bus,
        alarm = match alarm {
            Some(number) => format!(" {number:04}"),
            None => String::new(),
        }
    );
    let colour = match state {
        BoardState::Alarm => Color::Red,
        BoardState::Hold | BoardState::Stopping => Color::Yellow,
        _ => Color::Green,
    };
    let style = Style::new().fg(colour).add_modifier(Modifier::BOLD);
    Line::styled(text.get(view.lang).to_owned(), style)
}

fn axis_lines(view: &View) -> Vec<Line<'static>> {
    let Some(status) = &view.status else {
        return Vec::new();
    };
    let x = status.position.x.nm().saturating_mul(2);
    [
        ("X", x, " mm ⌀"),
        ("Z", status.position.z.nm(), " mm"),
        ("C", status.position.c.udeg(), "°"),
    ]
    .into_iter()
    .map(|(axis, value, unit)| {
        Line::raw(format!(
            "{axis} {:>14}{unit}",
            number::rounded::<6>(value, 4)
        ))
    })
    .collect()
}

fn spindle_lines(view: &View) -> Vec<Line<'static>> {
    let mut lines = Vec::new();
    if let Some(spindle) = view.spindle {
        let speed = number::rounded::<3>(i64::from(spindle.speed.get()), 1);
        let unit = pick(view.lang, "rpm", "r/min");
        lines.push(Line::raw(format!("{speed:>10} {unit}")));
    }
    if let Some(status) = &view.status {
        let text = both!(
            "commanded {rpm} rpm",
            "指令 {rpm} r/min",
            rpm = status.command.get()
        );
        lines.push(Line::raw(text.get(view.lang).to_owned()));
        // Two lines: on a terminal of 80 columns one would lose its end.
        let text = both!(
            "override feed {feed} %, rapid {rapid} %",
            "倍率：进给 {feed} %，快速 {rapid} %",
            feed = status.feed_percent,
            rapid = status.rapid_percent
        );
        lines.push(Line::raw(text.get(view.lang).to_owned()));
        let text = both!(
            "override spindle {spindle} %",
            "倍率：主轴 {spindle} %",
            spindle = status.spindle_percent
        );
        lines.push(Line::raw(text.get(view.lang).to_owned()));
    }
    lines
}

fn program_lines(view: &View) -> Vec<Line<'static>> {
    let place = view.place.unwrap_or_default();
    let pdo = view.pdo.unwrap_or_default();
    let first = both!(
        "line {line}, move {number}",
        "第 {line} 行，第 {number} 段移动",
        line = SourceLine(place.line),
        number = place.number
    );
    let second = both!(
        "late setpoints {late}, room for {credit} bytes of program",
        "迟到设定值 {late} 个，程序缓存余量 {credit} 字节",
        late = pdo.late,
        credit = pdo.credit
    );
    [first, second]
        .into_iter()
        .map(|text| Line::raw(text.get(view.lang).to_owned()))
        .collect()
}

#[cfg(test)]
mod tests {
    use ratatui::Terminal;
    use ratatui::backend::TestBackend;

    use super::*;
    use crate::link::bench;

    fn picture(view: &View, width: u16, height: u16) -> String {
        let mut terminal = Terminal::new(TestBackend::new(width, height)).unwrap();
        terminal.draw(|frame| draw(frame, view)).unwrap();
        terminal.backend().to_string()
    }

    #[test]
    fn everything_known_is_in_the_picture() {
        let mut view = View::new("can0", 3, Lang::En);
        view.pdo = Some(BoardStatus {
            state: BoardState::Alarm,
            alarm: Some(4300),
            late: 2,
            credit: 4096,
            ..BoardStatus::default()
        });
        view.place = Some(BoardPlace {
            line: 17,
            number: 42,
        });
        view.load_percent = 54;
        view.errors = [100, 400, 250].into();
        view.messages = ["line 17: 4300 emergency stop".to_owned()].into();
        let picture = picture(&view, 90, 26);
        for part in [
            "node 3 on can0",
            "alarm 4300",
            "line 17, move 42",
            "late setpoints 2, room for 4096",
            "worst 0.4 µm",
            "54%",
            "line 17: 4300 emergency stop",
        ] {
            assert!(picture.contains(part), "{part}: {picture}");
        }
    }

    #[test]
    fn nothing_is_cut_off_on_a_terminal_of_eighty_columns() {
        let mut view = View::new("socketcan:can0", 127, Lang::En);
        view.status = Some(Status {
            feed_percent: 150,
            rapid_percent: 100,
            spindle_percent: 120,
            ..bench::status()
        });
        let picture = picture(&view, 80, 24);
        for part in [
            "override feed 150 %, rapid 100 %",
            "override spindle 120 %",
            "(q ends the view)",
        ] {
            assert!(picture.contains(part), "{part}: {picture}");
        }
    }

    #[test]
    fn a_small_terminal_and_an_unknown_board_are_no_trouble() {
        for (width, height) in [(1, 1), (20, 5), (200, 60)] {
            for lang in [Lang::En, Lang::Zh] {
                picture(&View::new("vcan0", 1, lang), width, height);
            }
        }
    }
}
