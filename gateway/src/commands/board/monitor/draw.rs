//! The picture of `monitor` on a terminal of any size: where each row of the view stands, and in which colour.

use ratatui::Frame;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::{Color, Modifier, Style};
use ratatui::text::{Line, Span};
use ratatui::widgets::{Block, Clear, Paragraph, Sparkline};

use super::view::{Row, Tone, View};
use crate::words::pick;

/// From this height on there is room for the course of the synchronism error.
const TALL: u16 = 32;

/// The most lines that an answer takes from the messages.
const ANSWER: usize = 4;

/// Draws it.
pub fn draw(frame: &mut Frame, view: &View) {
    let lang = view.lang;
    let tall = frame.area().height >= TALL;
    let answer = answer(view, usize::from(frame.area().width));
    let below = u16::try_from(answer.len()).unwrap_or(0);
    let [head, machine, program, errors, messages, foot] = Layout::vertical([
        Constraint::Length(1),
        Constraint::Length(6),
        Constraint::Length(6),
        Constraint::Length(if tall { 6 } else { 0 }),
        Constraint::Min(3),
        Constraint::Length(below),
    ])
    .areas(frame.area());
    draw_head(frame, view, head);
    let [axes, spindle] =
        Layout::horizontal([Constraint::Length(46), Constraint::Min(20)]).areas(machine);
    draw_block(
        frame,
        view.axes(),
        pick(lang, " axes, mm ", " 轴，mm "),
        axes,
    );
    draw_block(
        frame,
        view.spindle(),
        pick(lang, " spindle ", " 主轴 "),
        spindle,
    );
    draw_block(
        frame,
        view.program(),
        pick(lang, " program ", " 程序 "),
        program,
    );
    if tall {
        draw_errors(frame, view, errors);
    }
    draw_messages(frame, view, messages);
    frame.render_widget(Paragraph::new(lines(&answer)), foot);
}

/// What is asked or answered, and the keys below it.
fn answer(view: &View, width: usize) -> Vec<Row> {
    if view.hint.is_empty() {
        return Vec::new();
    }
    let tone = view.prompt.tone;
    let mut rows = folded(&view.prompt.text, width, "");
    rows.truncate(ANSWER);
    let rows = rows.into_iter().map(|text| Row::new(text, tone));
    rows.chain([Row::new(&*view.hint, Tone::Plain)]).collect()
}

/// Draws a page of help over everything but the head and the last lines: hold and stop work there, too.
pub fn draw_help(frame: &mut Frame, view: &View, page: &[Row]) {
    let area = frame.area();
    let over = Rect {
        y: area.y.saturating_add(1),
        height: area.height.saturating_sub(3),
        ..area
    }
    .intersection(area);
    frame.render_widget(Clear, over);
    let title = pick(view.lang, " keys ", " 按键 ");
    draw_block(frame, page.to_vec(), title, over);
}

fn draw_head(frame: &mut Frame, view: &View, area: Rect) {
    let (row, whose) = (view.head(), view.whose());
    let style = style(row.tone).add_modifier(Modifier::BOLD);
    let width = Span::raw(whose.as_str()).width();
    let right = Constraint::Length(u16::try_from(width).unwrap_or(u16::MAX));
    let [left, right] = Layout::horizontal([Constraint::Min(0), right]).areas(area);
    frame.render_widget(Line::styled(format!(" {}", row.text), style), left);
    frame.render_widget(Line::raw(whose), right);
}

fn draw_block(frame: &mut Frame, rows: Vec<Row>, title: &'static str, area: Rect) {
    let block = Block::bordered().title(title);
    frame.render_widget(Paragraph::new(lines(&rows)).block(block), area);
}

fn draw_errors(frame: &mut Frame, view: &View, area: Rect) {
    let room = usize::from(area.width.saturating_sub(2));
    let from = view.errors.len().saturating_sub(room);
    let shown: Vec<u64> = view.errors.iter().skip(from).copied().collect();
    let title = pick(view.lang, " synchronism error ", " 同步误差 ");
    frame.render_widget(
        Sparkline::default()
            .data(&shown)
            .style(style(Tone::Bad))
            .block(Block::bordered().title(title)),
        area,
    );
}

/// The newest messages, as many as have room; what helps stands below what has happened.
fn draw_messages(frame: &mut Frame, view: &View, area: Rect) {
    let width = usize::from(area.width.saturating_sub(2));
    let room = usize::from(area.height.saturating_sub(2));
    let mut rows = Vec::new();
    for told in view.messages.iter().rev() {
        if rows.len() >= room {
            break;
        }
        let mut these = folded(&told.text, width, "");
        if !told.help.is_empty() {
            these.extend(folded(&told.help, width, "     "));
        }
        rows.extend(
            these
                .into_iter()
                .rev()
                .map(|text| Row::new(text, told.tone)),
        );
    }
    rows.truncate(room);
    rows.reverse();
    let title = pick(view.lang, " alarms and events ", " 报警与事件 ");
    draw_block(frame, rows, title, area);
}

/// A text in lines of this width, each behind `indent`: broken at spaces, and within a word only where it has none, as
/// Chinese.
fn folded(text: &str, width: usize, indent: &str) -> Vec<String> {
    let wide = |text: &str| Span::raw(text).width();
    let mut lines = Vec::new();
    let mut line = indent.to_owned();
    // Behind this byte of the line there is a space.
    let mut last_space = None;
    for c in text.chars() {
        line.push(c);
        if wide(&line) > width && line.len() > indent.len() + c.len_utf8() {
            let cut = last_space
                .filter(|cut| *cut > indent.len())
                .unwrap_or(line.len() - c.len_utf8());
            let rest = line.split_off(cut);
            lines.push(line.trim_end().to_owned());
            line = format!("{indent}{}", rest.trim_start());
            last_space = None;
        }
        if c == ' ' {
            last_space = Some(line.len());
        }
    }
    lines.push(line);
    lines
}

fn lines(rows: &[Row]) -> Vec<Line<'_>> {
    rows.iter()
        .map(|row| Line::styled(row.text.as_str(), style(row.tone)))
        .collect()
}

fn style(tone: Tone) -> Style {
    match tone {
        Tone::Plain => Style::new(),
        Tone::Good => Style::new().fg(Color::Green),
        Tone::Care => Style::new().fg(Color::Yellow),
        Tone::Bad => Style::new().fg(Color::Red),
        Tone::Old => Style::new()
            .fg(Color::DarkGray)
            .add_modifier(Modifier::ITALIC),
    }
}

#[cfg(test)]
mod tests;
