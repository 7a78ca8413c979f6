//! The panel on a simulated board, in virtual time: one tick is one millisecond.

use leadscrew_board_sim::Sim;
use leadscrew_board_sim::plant::{Flash, PlantOptions};
use leadscrew_core::bus::{JogRequest, NmtCommand, NmtState, StepRequest};
use leadscrew_core::call::Position;
use leadscrew_core::operating::{PressState, Towards};
use leadscrew_core::params::Params;
use leadscrew_core::units::Length;

use super::*;
use crate::link::bench;

const NODE: NodeId = NodeId::BOARD;
const SESSION: u8 = 9;
/// Parameter 9040: the dead man.
const WINDOW: u64 = 100;
/// No axis takes longer to brake from the speed of 9041.
const BRAKING: u64 = 150;

struct Bench {
    sim: Box<Sim>,
    seen: Seen,
    panel: Panel,
    begun: Instant,
    ms: u64,
    sent: Vec<Frame>,
    /// Frames of the panel get to the board.
    connected: bool,
}

impl Bench {
    fn new(tells_release: bool) -> Self {
        let params = Params::sheets();
        let options = PlantOptions::default();
        let sim = Sim::power_up(&params, &options, Flash::erased());
        let mut sim = sim.map(Box::new).unwrap();
        sim.join(NODE).unwrap();
        assert_eq!(sim.tick_us(), 1_000);
        let mut bench = Self {
            sim,
            seen: Seen::default(),
            panel: Panel::new(NODE, SESSION, Lang::En, tells_release),
            begun: Instant::now(),
            ms: 0,
            sent: Vec::new(),
            connected: true,
        };
        bench.pass(100);
        bench.sim.receive(&NmtCommand::Start.frame(Some(NODE)));
        bench.until(|bench| bench.seen.status.map(|status| status.state) == Some(BoardState::Idle));
        bench.panel.note_record(bench::status(), bench.now());
        bench
    }

    fn in_mode(mode: OperatingMode, tells_release: bool) -> Self {
        let mut bench = Self::new(tells_release);
        if mode != OperatingMode::Manual {
            bench.types("m");
            let letter = ('a'..='z').find(|letter| keys::mode_of(*letter) == Some(mode));
            bench.types(&letter.unwrap().to_string());
            bench.until(|bench| bench.panel.mode(&bench.seen) == Some(mode));
            bench.pass(50);
            assert_eq!(bench.panel.asks(), [Ask::Refusal]);
        }
        bench.sent.clear();
        bench
    }

    fn now(&self) -> Instant {
        self.begun + Duration::from_millis(self.ms)
    }

    fn tick(&mut self) {
        self.ms += 1;
        for frame in self.panel.frames(&self.seen, self.now()) {
            self.sent.push(frame);
            if self.connected {
                self.sim.receive(&frame);
                self.sim.settle();
            }
        }
        self.sim.step();
        while self.sim.event().is_some() {}
        while let Some(frame) = self.sim.transmit() {
            self.seen.note(&frame, NODE, NodeId::GATEWAY);
        }
    }

    fn pass(&mut self, ms: u64) {
        for _ in 0..ms {
            self.tick();
        }
    }

    fn until(&mut self, done: impl Fn(&Self) -> bool) {
        for _ in 0..5_000 {
            if done(self) {
                return;
            }
            self.tick();
        }
        panic!("it does not come to pass: {:?} {:?}", self.seen, self.panel);
    }

    fn input(&mut self, input: &Input) {
        let now = self.now();
        self.panel.input(input, &self.seen, now);
    }

    fn key(&mut self, code: KeyCode, kind: KeyEventKind) {
        let key = KeyEvent::new_with_kind(code, KeyModifiers::NONE, kind);
        self.input(&Input::Key(key));
    }

    fn types(&mut self, text: &str) {
        for letter in text.chars() {
            if letter == '\n' {
                // As a person does.
                self.pass(50);
                self.key(KeyCode::Enter, KeyEventKind::Press);
            } else {
                self.key(KeyCode::Char(letter), KeyEventKind::Press);
            }
        }
    }

    /// Holds a key for so long, as a keyboard does: it repeats behind half a second.
    fn hold(&mut self, code: KeyCode, ms: u64) {
        self.key(code, KeyEventKind::Press);
        for passed in 0..ms {
            if passed >= 500 && passed % 33 == 0 {
                self.key(code, KeyEventKind::Repeat);
            }
            self.tick();
        }
    }

    fn somebody_else_holds(&mut self) {
        let count = self.seen.status.unwrap().count;
        let hold = BoardCommand::order(Order::Hold, count).frame(NODE);
        self.sim.receive(&hold);
        self.sim.settle();
    }

    fn at(&self) -> Position {
        self.sim.board().ticker().executor().position()
    }

    fn x(&self) -> Length {
        self.at().x
    }

    /// Passes so much time, and tells how far X has gone on in the last millisecond and in all.
    #[track_caller]
    fn comes_to_rest_within(&mut self, ms: u64) {
        self.pass(ms);
        let place = self.at();
        self.pass(50);
        assert_eq!(self.at(), place, "it moves on");
    }

    fn orders(&self) -> Vec<Order> {
        let order = |frame: &Frame| BoardCommand::decode(frame)?.1.order;
        let mut orders: Vec<Order> = self.sent.iter().filter_map(order).collect();
        orders.dedup();
        orders
    }
}

#[test]
fn an_axis_moves_while_its_key_is_held_and_rests_when_it_is_let_go() {
    let mut bench = Bench::in_mode(OperatingMode::Manual, true);
    let begun = bench.x();
    bench.hold(KeyCode::Up, 1_500);
    let pressed = bench.x();
    // 1000 mm/min of the slide for a second and a half, less its ramp.
    assert!(pressed - begun > Length::from_nm(20_000_000), "{pressed:?}");
    bench.key(KeyCode::Up, KeyEventKind::Release);
    // Without the dead man's time.
    bench.comes_to_rest_within(BRAKING);
    assert!(bench.x() > pressed);
    assert_eq!(bench.seen.beat.unwrap().state, PressState::Ended);
    // It was renewed every 20 ms, with a beat that was never older than 10 ms, and nothing is sent any more.
    let jogs = bench
        .sent
        .iter()
        .filter_map(JogRequest::decode)
        .filter(|(_, jog)| !jog.is_release())
        .count();
    assert_eq!(jogs, 75);
    bench.sent.clear();
    bench.pass(500);
    assert_eq!(bench.sent, []);
}

#[test]
fn a_key_that_is_let_go_before_its_first_frame_moves_nothing_then_or_later() {
    let mut bench = Bench::in_mode(OperatingMode::Manual, true);
    let place = bench.at();
    bench.key(KeyCode::Up, KeyEventKind::Press);
    bench.key(KeyCode::Up, KeyEventKind::Release);
    // It is released for a second, where the board says nothing of it.
    bench.pass(1_100);
    let (_, release) = bench.sent.iter().find_map(JogRequest::decode).unwrap();
    assert!(release.is_release());
    // A frame of it that has taken another way.
    let late = JogRequest {
        x: Some(Towards::Plus),
        echo: bench.seen.beat.unwrap().beat,
        ..release
    };
    bench.sim.receive(&late.frame(NODE));
    bench.sim.settle();
    bench.pass(1_500);
    assert_eq!(bench.at(), place);
    // There is nothing to say of it.
    assert_eq!(
        (bench.panel.prompt().text.as_str(), bench.panel.asks()),
        ("", vec![])
    );
    bench.hold(KeyCode::Up, 600);
    assert!(bench.x() > place.x);
}

#[test]
fn whatever_else_happens_ends_a_press() {
    let other_arrow = Input::Key(KeyEvent::new(KeyCode::Left, KeyModifiers::NONE));
    let fast = KeyEvent::new_with_kind(KeyCode::Up, KeyModifiers::SHIFT, KeyEventKind::Repeat);
    let letter = |letter| Input::Key(KeyEvent::new(KeyCode::Char(letter), KeyModifiers::NONE));
    for (input, orders) in [
        (Input::FocusLost, &[][..]),
        (Input::FocusGained, &[]),
        (Input::Resize(100, 30), &[]),
        (Input::Paste("r\n".to_owned()), &[]),
        (other_arrow, &[]),
        (Input::Key(fast), &[]),
        (letter('x'), &[]),
        // What would do something else is not done.
        (letter('m'), &[]),
        (letter(':'), &[]),
        (letter('q'), &[]),
        // But for what halts.
        (letter(' '), &[Order::Hold]),
        (letter('s'), &[Order::Stop]),
    ] {
        let mut bench = Bench::in_mode(OperatingMode::Manual, true);
        bench.hold(KeyCode::Up, 700);
        assert_eq!(bench.seen.beat.unwrap().state, PressState::Runs);
        bench.input(&input);
        // The key is still down, and goes on repeating: that begins nothing.
        for _ in 0..5 {
            bench.pass(30);
            bench.key(KeyCode::Up, KeyEventKind::Repeat);
        }
        let place = bench.at();
        bench.pass(100);
        assert_eq!(bench.at(), place, "{input:?}");
        assert_eq!(bench.panel.open, Open::Nothing, "{input:?}");
        assert!(!bench.panel.is_over());
        assert_eq!(bench.orders(), orders, "{input:?}");
    }
}

#[test]
fn a_terminal_that_tells_nothing_any_more_holds_no_key() {
    // From its first moment, and in the middle.
    for (held, rest) in [(0, 1_000), (2_000, 250)] {
        let mut bench = Bench::in_mode(OperatingMode::Manual, true);
        bench.hold(KeyCode::Down, held.max(1));
        bench.pass(rest - 100);
        assert_eq!(bench.seen.beat.unwrap().state, PressState::Runs, "{held}");
        bench.pass(100);
        bench.comes_to_rest_within(BRAKING);
        let told = bench.panel.prompt().text;
        assert!(told.contains("told no more that the key is held"), "{told}");
        // A repeat that comes late begins nothing.
        let place = bench.at();
        bench.key(KeyCode::Down, KeyEventKind::Repeat);
        bench.pass(300);
        assert_eq!(bench.at(), place);
    }
}

#[test]
fn a_panel_that_is_gone_lets_the_axis_rest_within_the_dead_mans_time() {
    let mut bench = Bench::in_mode(OperatingMode::Manual, true);
    bench.hold(KeyCode::Right, 600);
    assert_eq!(bench.seen.beat.unwrap().state, PressState::Runs);
    bench.connected = false;
    bench.comes_to_rest_within(WINDOW + BRAKING);
    assert_eq!(bench.seen.beat.unwrap().state, PressState::Ended);
}

#[test]
fn a_press_that_the_board_ends_is_told_and_not_begun_again() {
    let mut bench = Bench::in_mode(OperatingMode::Manual, true);
    bench.hold(KeyCode::Up, 600);
    bench.somebody_else_holds();
    for _ in 0..20 {
        bench.pass(30);
        bench.key(KeyCode::Up, KeyEventKind::Repeat);
    }
    assert_eq!(bench.panel.asks(), [Ask::NoPress]);
    let place = bench.at();
    // Pressed anew it is refused before anything is sent.
    bench.sent.clear();
    bench.hold(KeyCode::Up, 600);
    assert_eq!((bench.at(), bench.sent.len()), (place, 0));
    assert!(bench.panel.prompt().text.starts_with("4506 "));
    // Resume takes the hold away, and begins nothing.
    bench.key(KeyCode::Up, KeyEventKind::Release);
    bench.types("r\n");
    bench.pass(300);
    assert_eq!(bench.at(), place);
    bench.hold(KeyCode::Up, 600);
    assert!(bench.x() > place.x);
}

#[test]
fn the_spindle_turns_while_its_key_is_held_and_not_in_steps() {
    for (key, towards) in [('f', Towards::Plus), ('v', Towards::Minus)] {
        let mut bench = Bench::in_mode(OperatingMode::Manual, true);
        bench.hold(KeyCode::Char(key), 600);
        assert_eq!(bench.seen.beat.unwrap().state, PressState::Runs);
        for jog in bench.sent.iter().filter_map(JogRequest::decode) {
            let (_, told) = jog;
            assert_eq!((told.x, told.z, told.spindle), (None, None, Some(towards)));
        }
        // Parameter 9049 as built in.
        let rpm = if towards == Towards::Plus { 50 } else { -50 };
        assert_eq!(bench.sim.spindle_command().get(), rpm);
        bench.key(KeyCode::Char(key), KeyEventKind::Release);
        bench.pass(100);
        assert_eq!(bench.seen.beat.unwrap().state, PressState::Ended);
        assert_eq!(bench.sim.spindle_command().get(), 0);
    }
    let mut bench = Bench::in_mode(OperatingMode::Step, true);
    bench.hold(KeyCode::Char('f'), 300);
    assert_eq!(bench.sent, []);
    assert!(bench.panel.prompt().text.starts_with("4501 "));
}

/// The spindle as M03 turns it, by a key that is held.
fn turning() -> Bench {
    let mut bench = Bench::in_mode(OperatingMode::Manual, true);
    bench.hold(KeyCode::Char('f'), 700);
    assert_eq!(bench.seen.beat.unwrap().state, PressState::Runs);
    assert_eq!(bench.sim.spindle_command().get(), 50);
    bench
}

#[test]
fn whatever_else_happens_ends_a_press_of_the_spindle() {
    let key = |code| Input::Key(KeyEvent::new(code, KeyModifiers::NONE));
    let letter = |letter| key(KeyCode::Char(letter));
    for (input, orders) in [
        (Input::FocusLost, &[][..]),
        (Input::Resize(100, 30), &[]),
        (Input::Paste("v\n".to_owned()), &[]),
        // The other way, and an axis: the first press ends, and no other begins.
        (letter('v'), &[]),
        (key(KeyCode::Up), &[]),
        (letter('q'), &[]),
        (letter(' '), &[Order::Hold]),
        (letter('s'), &[Order::Stop]),
    ] {
        let mut bench = turning();
        let place = bench.at();
        bench.input(&input);
        // The key is still down, and goes on repeating.
        for _ in 0..20 {
            bench.pass(30);
            bench.key(KeyCode::Char('f'), KeyEventKind::Repeat);
            assert_eq!(bench.sim.spindle_command().get(), 0, "{input:?}");
        }
        assert_eq!(bench.at(), place, "{input:?}");
        assert_eq!(bench.orders(), orders, "{input:?}");
        assert!(!bench.panel.is_over());
    }
}

#[test]
fn a_panel_or_a_terminal_that_is_gone_lets_the_spindle_rest() {
    // The board's dead man: the last beat that it was shown is 30 ms old at most.
    let mut bench = turning();
    bench.connected = false;
    bench.pass(WINDOW - 35);
    assert_eq!(bench.sim.spindle_command().get(), 50);
    bench.pass(37);
    assert_eq!(bench.sim.spindle_command().get(), 0);
    assert_eq!(bench.seen.beat.unwrap().state, PressState::Ended);
    // The keyboard has repeated the key, and does not any more.
    let mut bench = turning();
    bench.pass(200);
    assert_eq!(bench.sim.spindle_command().get(), 50);
    bench.pass(60);
    assert_eq!(bench.sim.spindle_command().get(), 0);
    let told = bench.panel.prompt().text;
    assert!(told.contains("told no more that the key is held"), "{told}");
}

#[test]
fn a_spindle_that_the_board_stops_is_told_and_not_begun_again() {
    let mut bench = turning();
    bench.somebody_else_holds();
    for _ in 0..20 {
        bench.pass(30);
        bench.key(KeyCode::Char('f'), KeyEventKind::Repeat);
        assert_eq!(bench.sim.spindle_command().get(), 0);
    }
    assert_eq!(bench.panel.asks(), [Ask::NoPress]);
    // Pressed anew it is refused before anything is sent.
    bench.key(KeyCode::Char('f'), KeyEventKind::Release);
    bench.sent.clear();
    bench.hold(KeyCode::Char('f'), 600);
    assert_eq!(bench.sent, []);
    assert!(bench.panel.prompt().text.starts_with("4506 "));
    // Nor does the key that is still down begin anything when the hold is taken away.
    bench.types("r\n");
    for _ in 0..20 {
        bench.pass(30);
        bench.key(KeyCode::Char('f'), KeyEventKind::Repeat);
        assert_eq!(bench.sim.spindle_command().get(), 0);
    }
    assert!(!bench.seen.status.unwrap().flags.hold);
}

#[test]
fn without_a_release_arrows_are_steps_one_at_a_time_and_the_spindle_does_not_turn() {
    let mut bench = Bench::in_mode(OperatingMode::Manual, false);
    bench.hold(KeyCode::Up, 300);
    assert_eq!(bench.sent, []);
    assert!(bench.panel.prompt().text.contains("m i"));
    for key in ['f', 'v'] {
        bench.hold(KeyCode::Char(key), 300);
        assert_eq!(bench.sent, []);
        let told = bench.panel.prompt().text;
        assert!(told.contains("leadscrew jog S+ --hold"), "{told}");
    }

    let mut bench = Bench::in_mode(OperatingMode::Step, false);
    let begun = bench.at();
    // 0.1 mm of the diameter.
    bench.types("3");
    bench.key(KeyCode::Up, KeyEventKind::Press);
    bench.pass(300);
    assert_eq!(bench.x() - begun.x, Length::from_nm(50_000));
    // Of Z, towards minus.
    bench.types("4");
    bench.key(KeyCode::Left, KeyEventKind::Press);
    bench.pass(1_000);
    assert_eq!(bench.at().z - begun.z, Length::from_nm(-1_000_000));
    // A key that such a terminal repeats makes no queue: what moves when it is let go is one step.
    let place = bench.at();
    for _ in 0..30 {
        bench.key(KeyCode::Right, KeyEventKind::Press);
        bench.pass(10);
    }
    let let_go = bench.at();
    bench.pass(1_000);
    let (way, rest) = (bench.at().z - place.z, bench.at().z - let_go.z);
    assert!(way.nm() % 1_000_000 == 0 && way > Length::ZERO, "{way:?}");
    assert!(rest <= Length::from_nm(1_000_000), "{rest:?}");
    let counts: std::collections::BTreeSet<u8> = bench
        .sent
        .iter()
        .filter_map(StepRequest::decode)
        .map(|(_, step)| step.count)
        .collect();
    assert_eq!(counts.len() as i64, 2 + way.nm() / 1_000_000);
}

#[test]
fn what_moves_is_named_first_and_any_other_key_drops_it() {
    let mut bench = Bench::in_mode(OperatingMode::Automatic, true);
    for (key, words, order) in [
        ("r", "go on?", Order::Resume),
        ("e", "reset: a program under way is lost?", Order::Reset),
        ("g", "begin the program", Order::Run),
    ] {
        bench.sent.clear();
        bench.types(key);
        assert!(bench.panel.prompt().text.contains(words), "{key}");
        bench.pass(100);
        for other in ["x\n", "m\n", "\u{1b}\n"] {
            bench.types(other);
            bench.types(key);
        }
        bench.pass(100);
        assert_eq!(bench.orders(), [], "{key}");
        bench.types("\n");
        assert_eq!(bench.panel.open, Open::Nothing);
        bench.pass(100);
        assert_eq!(bench.orders(), [order]);
    }
    // What halts needs nothing, whatever is open.
    for open in ["", "r", "m", "?", ":G0 X1"] {
        for (code, order) in [(KeyCode::F(8), Order::Hold), (KeyCode::F(9), Order::Stop)] {
            let mut bench = Bench::in_mode(OperatingMode::Mdi, true);
            bench.types(open);
            bench.key(code, KeyEventKind::Press);
            bench.pass(50);
            assert_eq!(bench.orders(), [order], "{open:?}");
        }
    }
    for (open, order) in [("?", Order::Hold), ("m", Order::Hold), ("r", Order::Hold)] {
        let mut bench = Bench::in_mode(OperatingMode::Mdi, true);
        bench.types(open);
        bench.types(" ");
        bench.pass(50);
        assert_eq!(bench.orders(), [order], "{open:?}");
    }
}

/// The link stalls when the key has been pressed, and is well again after so long.
fn stalled(bench: &mut Bench, ms: u64) {
    bench.connected = false;
    bench.pass(ms);
    bench.connected = true;
}

#[test]
fn an_order_that_comes_late_is_as_old_as_its_key() {
    // Parameter 9047: an order is let in for a second, and given for five.
    for (ms, mode) in [(900, OperatingMode::Mdi), (1_100, OperatingMode::Manual)] {
        let mut bench = Bench::in_mode(OperatingMode::Manual, true);
        bench.types("md");
        stalled(&mut bench, ms);
        bench.pass(6_000);
        assert_eq!(bench.panel.mode(&bench.seen), Some(mode), "{ms}");
        let is_told = bench.panel.prompt().text.contains("not confirmed");
        assert_eq!(is_told, mode == OperatingMode::Manual, "{ms}");
    }
}

#[test]
fn a_step_that_comes_late_is_as_old_as_its_key() {
    // Parameter 9040: a step within 100 ms.
    for (ms, way) in [(50, 50_000), (WINDOW + 50, 0)] {
        let mut bench = Bench::in_mode(OperatingMode::Step, true);
        let begun = bench.x();
        bench.types("3");
        bench.key(KeyCode::Up, KeyEventKind::Press);
        stalled(&mut bench, ms);
        bench.pass(1_500);
        assert_eq!(bench.x() - begun, Length::from_nm(way), "{ms}");
    }
}

#[test]
fn what_is_pasted_as_keys_begins_nothing() {
    let mut bench = Bench::in_mode(OperatingMode::Mdi, true);
    for text in ["r", ":G0 X1"] {
        bench.types(text);
        bench.pass(49);
        bench.key(KeyCode::Enter, KeyEventKind::Press);
        bench.key(KeyCode::Enter, KeyEventKind::Press);
        assert_ne!(bench.panel.open, Open::Nothing);
        bench.pass(50);
        assert_eq!((bench.orders(), bench.panel.asks()), (vec![], vec![]));
        // Enter that a person presses then is meant.
        bench.key(KeyCode::Enter, KeyEventKind::Press);
        assert_eq!(bench.panel.open, Open::Nothing);
        bench.pass(100);
        let begun = bench.orders().len() + bench.panel.asks().len();
        assert!(begun > 0, "{text}");
        bench.sent.clear();
    }
}

#[test]
fn a_named_start_that_has_waited_asks_again_whether_it_may() {
    let mut bench = Bench::in_mode(OperatingMode::Automatic, true);
    bench.types("r");
    // Nothing is heard for so long.
    bench.ms += 251;
    bench.key(KeyCode::Enter, KeyEventKind::Press);
    assert!(bench.panel.prompt().text.contains("is old"));
    bench.pass(50);
    assert_eq!(bench.orders(), []);
}

#[test]
fn of_what_was_on_its_way_to_a_board_that_starts_again_nothing_is_left() {
    let restart = |bench: &mut Bench| {
        bench
            .sim
            .receive(&NmtCommand::ResetCommunication.frame(Some(NODE)));
        bench.sim.settle();
        let boots = bench.seen.boots;
        bench.until(|bench| bench.seen.boots != boots);
        bench.sent.clear();
        bench.connected = true;
        bench.sim.receive(&NmtCommand::Start.frame(Some(NODE)));
        bench.sim.settle();
    };
    let again = |bench: &Bench| bench.panel.prompt().text.contains("has started again");
    // An order that has not come, and one that was only named.
    for (open, enter) in [("md", ""), ("e", "\n")] {
        let mut bench = Bench::in_mode(OperatingMode::Manual, true);
        bench.connected = false;
        bench.types(open);
        bench.pass(100);
        restart(&mut bench);
        bench.pass(100);
        assert!(again(&bench), "{open}");
        bench.types(enter);
        bench.pass(500);
        assert_eq!(
            (bench.orders(), bench.panel.asks()),
            (vec![], vec![]),
            "{open}"
        );
        assert_eq!(bench.panel.mode(&bench.seen), Some(OperatingMode::Manual));
    }
    // A key that is still held presses nothing more.
    let mut bench = Bench::in_mode(OperatingMode::Manual, true);
    bench.hold(KeyCode::Up, 600);
    restart(&mut bench);
    for _ in 0..10 {
        bench.pass(30);
        bench.key(KeyCode::Up, KeyEventKind::Repeat);
    }
    assert!(again(&bench));
    assert_eq!(bench.sent, []);
    // Pressed anew it moves.
    bench.key(KeyCode::Up, KeyEventKind::Release);
    bench.panel.note_record(bench::status(), bench.now());
    let begun = bench.x();
    bench.hold(KeyCode::Up, 600);
    assert!(bench.x() > begun);
}

#[test]
fn a_line_is_typed_pasted_and_handed_on() {
    let mut bench = Bench::in_mode(OperatingMode::Mdi, true);
    bench.types(":G1 Xr");
    bench.key(KeyCode::Backspace, KeyEventKind::Press);
    bench.input(&Input::Paste("5 F100\u{1b}\nM30\n".to_owned()));
    assert!(bench.panel.prompt().text.starts_with("mdi> G1 X5 F100"));
    bench.types("\n");
    assert_eq!(bench.panel.asks(), [Ask::Line("G1 X5 F100".to_owned())]);
    assert_eq!(bench.panel.open, Open::Nothing);
    // Pasted where no line is open it is nothing.
    bench.input(&Input::Paste("r\n:M3\n".to_owned()));
    assert_eq!(bench.panel.open, Open::Nothing);
    bench.pass(50);
    assert_eq!((bench.orders(), bench.panel.asks()), (vec![], vec![]));
    // While it is under way no other is typed, and nobody leaves.
    bench.panel.typed = true;
    bench.types(":");
    assert!(bench.panel.prompt().text.starts_with("4502 "));
    bench.types("q");
    assert!(!bench.panel.is_over());
    bench.panel.typed = false;
    bench.types("q");
    assert!(bench.panel.is_over());
}

#[test]
fn overrides_and_single_block_are_levels() {
    let mut bench = Bench::in_mode(OperatingMode::Automatic, true);
    bench.types("jjjuikkko");
    bench.types("b");
    bench.pass(100);
    let status = bench.seen.status.unwrap();
    assert!(status.flags.single_block);
    let last = bench
        .sent
        .iter()
        .filter_map(BoardCommand::decode)
        .next_back();
    let (_, command) = last.unwrap();
    let expected = BoardCommand {
        count: status.count,
        single_block: Some(true),
        feed: Some(80),
        rapid: Some(25),
        spindle: Some(110),
        ..BoardCommand::default()
    };
    assert_eq!(command, expected);
    bench.types("lllllllllllll");
    bench.types("b");
    bench.pass(100);
    assert!(!bench.seen.status.unwrap().flags.single_block);
    let last = bench
        .sent
        .iter()
        .filter_map(BoardCommand::decode)
        .next_back();
    assert_eq!(last.unwrap().1.spindle, Some(50));
}

#[test]
fn a_search_for_references_has_the_heartbeat_of_this_side() {
    let mut bench = Bench::in_mode(OperatingMode::Reference, true);
    bench.types("h");
    bench.pass(50);
    assert_eq!(bench.sent, []);
    bench.types("\n");
    bench.pass(1_000);
    assert_eq!(bench.orders(), [Order::Home(Axes::NONE)]);
    let heartbeat = NmtState::Operational.frame(NodeId::GATEWAY);
    let position = |wanted: &dyn Fn(&Frame) -> bool| bench.sent.iter().position(wanted);
    let first = position(&|frame| *frame == heartbeat);
    let order = position(&|frame| BoardCommand::decode(frame).is_some());
    assert!(first.is_some() && first < order, "{first:?} {order:?}");
    // These axes have no way to home: it is over at once, and so are the heartbeats.
    bench.sent.clear();
    bench.pass(500);
    assert_eq!(bench.sent, []);
    // That the board has its word to say is asked.
    assert_eq!(bench.panel.asks(), [Ask::Refusal]);
}
