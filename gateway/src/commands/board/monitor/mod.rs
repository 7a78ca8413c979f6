//! `monitor`: a live view of a board, drawn on the terminal until somebody has seen enough. It looks and changes nothing.

mod view;

use std::collections::VecDeque;
use std::io::IsTerminal as _;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use leadscrew_core::alarm::Alarm;
use leadscrew_core::board::Event;
use leadscrew_core::bus::{BoardSpindle, Frame, NodeId, Object};
use leadscrew_core::link::Logged;
use ratatui::crossterm::event::{self, Event as Input, KeyCode, KeyEventKind, KeyModifiers};

use super::open;
use crate::cli::Global;
use crate::diagnostics::Diagnostic;
use crate::failure::{Failure, Outcome};
use crate::interrupt::{self, UnderWay};
use crate::link::{Link, Traffic};
use crate::place::SourceLine;
use crate::source::SourceFile;
use crate::words::both;

pub use view::{View, draw};

/// Between two pictures.
const PICTURE: Duration = Duration::from_millis(50);
/// Between two readings of the status record.
const STATUS: Duration = Duration::from_millis(200);
/// Between two readings of the event log.
const LOG: Duration = Duration::from_secs(1);
/// Over which the load of the bus is measured.
const LOAD: Duration = Duration::from_millis(500);
/// Parameter with the bit rate of the bus in kbit/s.
const BUS_KBIT: Object = Object::new(0x2000 + 9020, 0);
/// The same of the data of CAN FD frames.
const FD_KBIT: Object = Object::new(0x2000 + 9032, 0);
/// Errors and messages kept for the picture.
const KEPT: usize = 240;

/// Shows the board until a key ends it.
pub fn monitor(global: &Global) -> Outcome {
    if !std::io::stdout().is_terminal() {
        return Err(Failure::Usage(both!(
            "`monitor` draws on a terminal, and standard output is none; `status --json` is for programs",
            "`monitor` 需要终端，而标准输出不是终端；程序请用 `status --json`"
        )));
    }
    let mut link = open(global)?;
    link.greet()?;
    link.hear_status()?;
    // The load of the bus is everybody's.
    link.hear_everything()?;
    let kbit = link.read_number(BUS_KBIT).unwrap_or(1000);
    let rates = [kbit, link.read_number(FD_KBIT).unwrap_or(kbit)];
    interrupt::defer(UnderWay::Computed);
    interrupt::before_the_end(give_back);
    DRAWING.store(true, Ordering::Relaxed);
    let taken = ratatui::try_init().map_err(|error| Failure::stdout(&error));
    let result = taken.and_then(|mut terminal| watch(global, &mut link, rates, &mut terminal));
    give_back();
    result
}

/// The whole terminal is drawn on.
static DRAWING: AtomicBool = AtomicBool::new(false);

/// Gives the terminal back as it was, where it was taken.
fn give_back() {
    if DRAWING.swap(false, Ordering::Relaxed) {
        // A terminal that is gone takes nothing back.
        let _ = ratatui::try_restore();
    }
}

fn watch(
    global: &Global,
    link: &mut Link,
    [kbit, fd_kbit]: [u64; 2],
    terminal: &mut ratatui::DefaultTerminal,
) -> Outcome {
    let mut view = View::new(&global.bus.to_string(), link.node().get(), global.lang());
    let node = link.node();
    link.seen.traffic = Traffic::default();
    let mut since = Instant::now();
    let (mut looked, mut read) = (None::<Instant>, None::<Instant>);
    let mut last_event = link.newest_event()?.saturating_sub(8);
    let mut boots = link.seen.boots;
    loop {
        let next = Instant::now() + PICTURE;
        let errors = &mut view.errors;
        link.listen(next, &mut |frame| {
            note_error(errors, frame, node);
            false
        })?;
        link.check_alive()?;
        if link.seen.boots != boots {
            // It says no process data before somebody has started it.
            boots = link.seen.boots;
            link.start_node()?;
        }
        if since.elapsed() >= LOAD {
            let ms = since.elapsed().as_millis() as u64;
            let traffic = std::mem::take(&mut link.seen.traffic);
            view.load_percent = traffic.load(kbit, fd_kbit, ms).min(999);
            since = Instant::now();
        }
        if looked.is_none_or(|at| at.elapsed() >= STATUS) {
            looked = Some(Instant::now());
            view.status = Some(link.status()?);
        }
        if read.is_none_or(|at| at.elapsed() >= LOG) {
            read = Some(Instant::now());
            for entry in link.events_behind(last_event)? {
                last_event = last_event.max(entry.number);
                note_event(&mut view, &entry);
            }
        }
        view.pdo = link.seen.status;
        view.spindle = link.seen.spindle;
        view.place = link.seen.place;
        terminal
            .draw(|frame| draw(frame, &view))
            .map_err(|error| Failure::stdout(&error))?;
        // Ctrl-C is a key here; where the signal comes from elsewhere, the terminal is left as it was all the same.
        if ends().map_err(|error| Failure::stdout(&error))? || interrupt::requested() {
            return Ok(());
        }
    }
}

/// A key that ends the view has been pressed.
fn ends() -> std::io::Result<bool> {
    while event::poll(Duration::ZERO)? {
        if let Input::Key(key) = event::read()?
            && key.kind == KeyEventKind::Press
        {
            let control = key.modifiers.contains(KeyModifiers::CONTROL);
            match key.code {
                KeyCode::Char('q') | KeyCode::Esc => return Ok(true),
                KeyCode::Char('c') if control => return Ok(true),
                _ => {}
            }
        }
    }
    Ok(false)
}

/// Keeps what this board says of its synchronism; another one's is not in its picture.
fn note_error(errors: &mut VecDeque<u64>, frame: &Frame, board: NodeId) {
    let spindle = BoardSpindle::decode(frame).filter(|(node, _)| *node == board);
    if let Some(error) = spindle.and_then(|(_, spindle)| spindle.sync_error) {
        if errors.len() == KEPT {
            errors.pop_front();
        }
        errors.push_back(error.nm().unsigned_abs());
    }
}

fn note_event(view: &mut View, entry: &Logged) {
    let words = |alarm: &Alarm| {
        let source = SourceFile::new(Path::new(""));
        let told = Diagnostic::new(alarm, &source, view.lang, false);
        format!("{:04} {}", told.number, told.message)
    };
    let (line, text) = match &entry.event {
        Event::Alarm(alarm) | Event::Warning(alarm) => (alarm.span.line, words(alarm)),
        Event::Finished => (
            0,
            both!("program finished", "程序结束").get(view.lang).into(),
        ),
        Event::Reset => (0, both!("reset", "复位").get(view.lang).into()),
        Event::Held => (0, both!("feed hold", "进给保持").get(view.lang).into()),
        _ => return,
    };
    let place = if line > 0 {
        both!("line {line}: ", "第 {line} 行：", line = SourceLine(line))
            .get(view.lang)
            .to_owned()
    } else {
        String::new()
    };
    if view.messages.len() == KEPT {
        view.messages.pop_front();
    }
    view.messages.push_back(format!("{place}{text}"));
}

#[cfg(test)]
mod tests {
    use leadscrew_core::units::Length;

    use super::*;

    #[test]
    fn each_board_has_its_own_synchronism() {
        let mut errors = VecDeque::new();
        let second = NodeId::new(2).unwrap();
        for (nm, node) in [(100, NodeId::BOARD), (700, second), (-300, NodeId::BOARD)] {
            let spindle = BoardSpindle {
                sync_error: Some(Length::from_nm(nm)),
                ..BoardSpindle::default()
            };
            note_error(&mut errors, &spindle.frame(node), NodeId::BOARD);
        }
        assert_eq!(errors, [100, 300]);
    }
}
