use super::*;

const TODAY: [OperatingMode; 6] = OperatingMode::ALL;

fn key(code: KeyCode) -> KeyEvent {
    KeyEvent::new(code, KeyModifiers::NONE)
}

fn letter(letter: char) -> KeyEvent {
    key(KeyCode::Char(letter))
}

/// A machine at rest in this mode, on a terminal that tells when a key is let go.
fn at_rest(mode: OperatingMode) -> Situation {
    Situation {
        mode: Some(mode),
        state: BoardState::Idle,
        program: false,
        hold: false,
        old: false,
        beats: true,
        tells_release: true,
        typed: false,
    }
}

#[test]
fn each_key_has_its_wish() {
    use OverrideName::{Feed, Rapid, Spindle};
    let way = |on_z, towards| HandWay::Axis(AxisWay { on_z, towards });
    let spindle = |towards| Some(Wish::ByHand(HandWay::Spindle(towards), Speed::Feed));
    for (keys, expected) in [
        ("  ", Some(Wish::Hold)),
        ("\u{3000}", Some(Wish::Hold)),
        ("sS", Some(Wish::Stop)),
        ("rR", Some(Wish::Resume)),
        ("e", Some(Wish::Reset)),
        ("g", Some(Wish::Start)),
        ("h", Some(Wish::Home)),
        ("m", Some(Wish::Modes)),
        ("uU", Some(Wish::Override(Feed, 10))),
        ("j", Some(Wish::Override(Feed, -10))),
        ("i", Some(Wish::Override(Rapid, 25))),
        ("k", Some(Wish::Override(Rapid, -25))),
        ("o", Some(Wish::Override(Spindle, 10))),
        ("l", Some(Wish::Override(Spindle, -10))),
        ("fF", spindle(Towards::Plus)),
        ("vV", spindle(Towards::Minus)),
        ("b", Some(Wish::SingleBlock)),
        ("1", Some(Wish::Increment(StepLength { tenths: 10 }))),
        ("2", Some(Wish::Increment(StepLength { tenths: 100 }))),
        ("3", Some(Wish::Increment(StepLength { tenths: 1_000 }))),
        ("4", Some(Wish::Increment(StepLength { tenths: 10_000 }))),
        ("w", Some(Wish::NextSystem)),
        ("t", Some(Wish::NextTool)),
        (":：", Some(Wish::Line)),
        ("?？", Some(Wish::Help)),
        ("q", Some(Wish::Quit)),
        ("acdnpxyz05-+.,/", None),
    ] {
        for one in keys.chars() {
            assert_eq!(wish(letter(one)), expected, "{one:?}");
        }
    }
    for (code, expected) in [
        (KeyCode::Up, way(false, Towards::Plus)),
        (KeyCode::Down, way(false, Towards::Minus)),
        (KeyCode::Right, way(true, Towards::Plus)),
        (KeyCode::Left, way(true, Towards::Minus)),
    ] {
        let arrow = |speed| Some(Wish::ByHand(expected, speed));
        assert_eq!(wish(key(code)), arrow(Speed::Feed));
        let shifted = KeyEvent::new(code, KeyModifiers::SHIFT);
        assert_eq!(wish(shifted), arrow(Speed::Rapid));
        assert_eq!(wish(KeyEvent::new(code, KeyModifiers::CONTROL)), None);
    }
    assert_eq!(wish(key(KeyCode::F(8))), Some(Wish::Hold));
    assert_eq!(wish(key(KeyCode::F(9))), Some(Wish::Stop));
    for code in [KeyCode::Enter, KeyCode::Esc, KeyCode::F(1), KeyCode::Tab] {
        assert_eq!(wish(key(code)), None, "{code:?}");
    }
    let control = |letter| KeyEvent::new(KeyCode::Char(letter), KeyModifiers::CONTROL);
    assert_eq!(wish(control('c')), Some(Wish::Quit));
    assert_eq!(wish(control('g')), None);
    assert_eq!(wish(control('s')), None);
}

#[test]
fn each_mode_has_its_letter() {
    let of: String = TODAY
        .map(|mode| {
            ('a'..='z')
                .filter(|letter| mode_of(*letter) == Some(mode))
                .collect::<String>()
        })
        .join(" ");
    assert_eq!(of, "m i w r d a");
}

/// Mode by mode: what is passed on is a dot, what is refused its alarm.
#[test]
fn what_a_mode_refuses_says_which_mode_is_needed() {
    let arrow = Wish::ByHand(
        HandWay::Axis(AxisWay {
            on_z: false,
            towards: Towards::Plus,
        }),
        Speed::Feed,
    );
    let spindle = Wish::ByHand(HandWay::Spindle(Towards::Plus), Speed::Feed);
    let table = |situation: &dyn Fn(OperatingMode) -> Situation, wish: Wish| {
        TODAY
            .map(|mode| match refusal(wish, situation(mode)) {
                None => ".".to_owned(),
                Some(words) => words.en.chars().take(4).collect(),
            })
            .join(" ")
    };
    for (wish, expected) in [
        (arrow, ". . 4501 4501 4501 4501"),
        (spindle, ". 4501 4501 4501 4501 4501"),
        (Wish::Home, "4501 4501 4501 . 4501 4501"),
        (Wish::Start, "4501 4501 4501 4501 . ."),
        (Wish::Line, "4501 4501 4501 4501 . 4501"),
        (Wish::Resume, ". . . . . ."),
        (Wish::Modes, ". . . . . ."),
        (Wish::Reset, ". . . . . ."),
        (Wish::Hold, ". . . . . ."),
        (Wish::Stop, ". . . . . ."),
    ] {
        assert_eq!(table(&at_rest, wish), expected, "{wish:?}");
    }
    let program = |mode| Situation {
        program: true,
        state: BoardState::Run,
        ..at_rest(mode)
    };
    let alarm = |mode| Situation {
        state: BoardState::Alarm,
        ..at_rest(mode)
    };
    for wish in [arrow, Wish::Home, Wish::Start, Wish::Line] {
        let all = |number: &str| [number; 6].join(" ");
        // In these modes a held program was left.
        let left = if wish == arrow { ". ." } else { "4502 4502" };
        let under_way = format!("{left} {}", ["4502"; 4].join(" "));
        assert_eq!(table(&program, wish), under_way, "{wish:?}");
        assert_eq!(table(&alarm, wish), all("4504"), "{wish:?}");
    }
    let words = refusal(arrow, at_rest(OperatingMode::Automatic)).unwrap();
    assert_eq!(
        words.en,
        "4501 this needs the machine in mode manual, and it is in mode automatic; change the mode first (`leadscrew mode \
         manual`), while the machine stands"
    );
    assert!(
        words.zh.starts_with("4501 此操作需要 manual 方式"),
        "{}",
        words.zh
    );
}

#[test]
fn arrows_need_a_key_that_is_let_go_a_beat_and_no_hold() {
    let arrow = Wish::ByHand(
        HandWay::Axis(AxisWay {
            on_z: true,
            towards: Towards::Minus,
        }),
        Speed::Rapid,
    );
    let told = |now| refusal(arrow, now).map_or(String::new(), |words| words.en);
    for mode in [OperatingMode::Manual, OperatingMode::Step] {
        let now = at_rest(mode);
        assert_eq!(told(now), "");
        let hold = Situation { hold: true, ..now };
        assert!(told(hold).starts_with("4506 "), "{}", told(hold));
        let beats = false;
        assert!(told(Situation { beats, ..now }).contains("sends no beat"));
    }
    let silent = |mode| Situation {
        tells_release: false,
        ..at_rest(mode)
    };
    let manual = told(silent(OperatingMode::Manual));
    assert!(
        manual.contains("does not tell when a key is let go"),
        "{manual}"
    );
    assert_eq!(told(silent(OperatingMode::Step)), "");
    let spindle = Wish::ByHand(HandWay::Spindle(Towards::Minus), Speed::Feed);
    let words = refusal(spindle, silent(OperatingMode::Manual)).unwrap().en;
    assert!(words.contains("leadscrew jog S+ --hold"), "{words}");
    assert_eq!(refusal(spindle, at_rest(OperatingMode::Manual)), None);
}

#[test]
fn by_old_values_nothing_is_ordered_but_what_halts() {
    let old = Situation {
        old: true,
        ..at_rest(OperatingMode::Mdi)
    };
    for wish in [
        Wish::Resume,
        Wish::Start,
        Wish::Home,
        Wish::Modes,
        Wish::Line,
        Wish::SingleBlock,
        Wish::Override(OverrideName::Feed, 10),
    ] {
        let words = refusal(wish, old).map(|words| words.en).unwrap_or_default();
        assert!(words.contains("is old"), "{wish:?}: {words}");
    }
    for wish in [Wish::Hold, Wish::Stop, Wish::Reset, Wish::Help, Wish::Quit] {
        assert_eq!(refusal(wish, old), None, "{wish:?}");
    }
    let typed = Situation {
        typed: true,
        ..at_rest(OperatingMode::Mdi)
    };
    assert!(refusal(Wish::Quit, typed).is_some());
    assert!(refusal(Wish::Line, typed).is_some());
    assert_eq!(refusal(Wish::Hold, typed), None);
}

#[test]
fn a_program_that_is_named_begins_in_automatic_where_nothing_is_under_way() {
    let told = |now| no_program(now).map_or(String::new(), |words| words.en);
    let now = at_rest(OperatingMode::Automatic);
    assert_eq!(told(now), "");
    for mode in [OperatingMode::Manual, OperatingMode::Mdi] {
        assert!(told(at_rest(mode)).starts_with("4501 "), "{mode:?}");
    }
    let (program, typed, old) = (true, true, true);
    assert!(told(Situation { program, ..now }).starts_with("4502 "));
    assert!(told(Situation { typed, ..now }).starts_with("4502 "));
    assert!(told(Situation { old, ..now }).contains("is old"));
}
