//! Pictures as texts: `golden/LANG-WIDTHxHEIGHT.txt`. LEADSCREW_BLESS=1 (`cargo xtask renew`) writes them anew, and the
//! one that docs/panel.md shows.

use std::path::PathBuf;
use std::time::Duration;

use leadscrew_core::alarm::{Alarm, Arg, Code, Lang};
use leadscrew_core::bus::{BoardFlags, BoardPlace, BoardSpindle, BoardState, BoardStatus};
use leadscrew_core::bus::{MilliRpm, NodeId};
use leadscrew_core::call::Position;
use leadscrew_core::link::Status;
use leadscrew_core::operating::OperatingMode;
use leadscrew_core::signals::Signals;
use leadscrew_core::units::{Axes, Axis, Length, Rpm};
use ratatui::Terminal;
use ratatui::backend::TestBackend;
use ratatui::buffer::Buffer;

use super::super::panel::{Panel, help};
use super::super::told::of_alarm;
use super::super::view::Zero;
use super::*;
use crate::diagnostics::alarm_words;
use crate::link::Seen;
use crate::link::bench;
use leadscrew_core::units::Angle;

/// The page that shows the English picture of 80 by 24.
const PAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/panel.md");

fn text(buffer: &Buffer) -> String {
    let mut out = String::new();
    for y in 0..buffer.area.height {
        let (mut line, mut x) = (String::new(), 0);
        while x < buffer.area.width {
            let symbol = buffer[(x, y)].symbol();
            line += symbol;
            // Behind a wide letter stands a cell that is not drawn.
            x += (Span::raw(symbol).width() as u16).max(1);
        }
        out += line.trim_end();
        out.push('\n');
    }
    out
}

fn picture(view: &View, width: u16, height: u16) -> String {
    let mut terminal = Terminal::new(TestBackend::new(width, height)).unwrap();
    terminal.draw(|frame| draw(frame, view)).unwrap();
    text(terminal.backend().buffer())
}

/// A machine on an alarm in the middle of a thread.
fn view(lang: Lang) -> View {
    let mm = |um: i64| Length::from_nm(um * 1_000);
    let status = Status {
        position: Position {
            x: mm(-86_960),
            z: mm(-412_000),
            c: Angle::ZERO,
        },
        command: Rpm::new(600),
        feed_percent: 150,
        rapid_percent: 25,
        spindle_percent: 120,
        signals: Signals::HOLD | 0x0010,
        referenced: Axes::NONE.with(Axis::X),
        unreferenced: Axes::NONE.with(Axis::Z),
        ..bench::status()
    };
    let pdo = BoardStatus {
        state: BoardState::Alarm,
        flags: BoardFlags {
            hold: true,
            single_block: true,
            ..BoardFlags::default()
        },
        alarm: Some(4300),
        late: 2,
        credit: 4096,
        ..BoardStatus::default()
    };
    let young = Duration::from_millis(40);
    let wrong = Alarm::of(
        Code::WrongMode,
        &[
            Arg::Mode(OperatingMode::Manual),
            Arg::Mode(OperatingMode::Automatic),
        ],
    );
    View {
        record: Some((status, young)),
        pdo: Some((pdo, young)),
        mode: Some(OperatingMode::Automatic),
        place: Some(BoardPlace {
            line: 17,
            number: 42,
        }),
        spindle: Some(BoardSpindle {
            speed: MilliRpm::new(599_840),
            sync_error: Some(Length::from_nm(-400)),
            ..BoardSpindle::default()
        }),
        zero: Some(Zero {
            system: 54,
            tool: 1,
            at: [mm(-106_170), mm(-400_000)],
        }),
        modal: Some("G01 G18 G21 G54 G98 G97 F100 S600 M03 T--01".to_owned()),
        load_percent: 54,
        errors: [100, 400, 250].into(),
        messages: [
            of_alarm(&wrong, Tone::Care, lang),
            of_alarm(&Alarm::of(Code::EmergencyStop, &[]), Tone::Bad, lang),
        ]
        .into(),
        prompt: Row::new(alarm_words(&wrong).get(lang), Tone::Care),
        hint: Panel::new(NodeId::BOARD, 1, lang, true).hint(&Seen::default()),
        ..View::new("sim:desk", 1, lang)
    }
}

#[test]
fn the_picture_is_that_of_its_file_and_of_the_page() {
    let folder =
        PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("src/commands/board/monitor/golden");
    for (lang, name) in [(Lang::En, "en"), (Lang::Zh, "zh")] {
        for (width, height) in [(80, 24), (120, 40)] {
            let drawn = picture(&view(lang), width, height);
            let path = folder.join(format!("{name}-{width}x{height}.txt"));
            if std::env::var_os("LEADSCREW_BLESS").is_some() {
                if let Ok(before) = std::fs::read_to_string(&path) {
                    let page = std::fs::read_to_string(PAGE).unwrap();
                    std::fs::write(PAGE, page.replace(&before, &drawn)).unwrap();
                }
                std::fs::write(&path, &drawn).unwrap();
            }
            let expected = std::fs::read_to_string(&path).unwrap();
            let path = path.display();
            assert_eq!(
                drawn, expected,
                "{path}; `cargo xtask renew` writes it anew"
            );
        }
    }
    let page = std::fs::read_to_string(PAGE).unwrap();
    assert!(
        page.contains(&picture(&view(Lang::En), 80, 24)),
        "docs/panel.md does not show it; `cargo xtask renew` writes it anew"
    );
}

#[test]
fn what_is_old_says_so() {
    let mut view = view(Lang::En);
    let age = |ms| Duration::from_millis(ms);
    view.pdo = view.pdo.map(|(pdo, _)| (pdo, age(250)));
    assert_eq!(view.head().tone, Tone::Bad);
    view.pdo = view.pdo.map(|(pdo, _)| (pdo, age(251)));
    assert_eq!(view.head().tone, Tone::Old);
    view.record = view.record.map(|(record, _)| (record, age(1_240)));
    assert!(view.axes().iter().all(|row| row.tone == Tone::Old));
    let picture = picture(&view, 80, 24);
    for part in ["0.2 s old", "machine  1.2 s old"] {
        assert!(picture.contains(part), "{part}: {picture}");
    }
}

#[test]
fn a_small_terminal_and_an_unknown_board_are_no_trouble() {
    for (width, height) in [(1, 1), (20, 5), (200, 60)] {
        for lang in [Lang::En, Lang::Zh] {
            picture(&View::new("vcan0", 1, lang), width, height);
            let mut terminal = Terminal::new(TestBackend::new(width, height)).unwrap();
            let page = [Row::new("help", Tone::Plain)];
            terminal
                .draw(|frame| draw_help(frame, &view(lang), &page))
                .unwrap();
        }
    }
}

#[test]
fn the_page_of_help_has_room_on_a_small_terminal() {
    for lang in [Lang::En, Lang::Zh] {
        let page = help(lang);
        let mut terminal = Terminal::new(TestBackend::new(80, 24)).unwrap();
        terminal
            .draw(|frame| draw_help(frame, &view(lang), &page))
            .unwrap();
        let picture = text(terminal.backend().buffer());
        for row in &page {
            assert!(picture.contains(&*row.text), "{}: {picture}", row.text);
        }
    }
}

#[test]
fn words_are_broken_at_spaces_and_chinese_anywhere() {
    assert_eq!(folded("", 5, ""), [""]);
    assert_eq!(folded("one two three", 8, ""), ["one two", "three"]);
    assert_eq!(folded("abcdefgh", 5, " "), [" abcd", " efgh"]);
    assert_eq!(folded("机床处于报警", 5, ""), ["机床", "处于", "报警"]);
    // A width of nothing ends all the same.
    assert_eq!(folded("ab", 0, "  "), ["  a", "  b"]);
}
