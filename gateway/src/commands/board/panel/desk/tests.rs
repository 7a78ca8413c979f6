//! Orders between pages and the bus, without either: time and what was heard are given.

use std::io::Read as _;
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::thread::JoinHandle;

use clap::Parser as _;
use leadscrew_core::bus::{BoardBeat, BoardCommand};
use leadscrew_panel::When;
use serde_json::{Value, json};

use super::*;

const NODE: NodeId = NodeId::BOARD;

fn desk() -> Desk {
    with(None)
}

fn with(programs: Option<Arc<Programs>>) -> Desk {
    let typed = crate::cli::Cli::try_parse_from(["leadscrew", "panel"]).unwrap();
    Desk::new(NODE, 9, Arc::new(Views::new(&typed.global)), programs)
}

/// A folder with one program.
struct Folder {
    path: PathBuf,
    programs: Arc<Programs>,
    /// What names it in an order.
    args: Value,
}

impl Folder {
    fn new() -> Self {
        static NEXT: AtomicU32 = AtomicU32::new(0);
        let number = NEXT.fetch_add(1, Ordering::Relaxed);
        let path = std::env::temp_dir().join(format!("ls-orders-{}-{number}", std::process::id()));
        std::fs::create_dir_all(&path).unwrap();
        let programs = Programs::open(&path).unwrap();
        let tag = programs.write("a.nc", When::New, b"M30\n").unwrap();
        Self {
            path,
            programs: Arc::new(programs),
            args: json!({"name": "a.nc", "tag": tag}),
        }
    }

    fn desk(&self) -> Arc<Desk> {
        Arc::new(with(Some(Arc::clone(&self.programs))))
    }

    /// Whether its program is kept as it is.
    fn is_claimed(&self) -> bool {
        let tag = self.args["tag"].as_str().unwrap();
        let claim = self.programs.claim("a.nc", tag);
        claim.is_err_and(|refusal| refusal == Refusal::Runs)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.path);
    }
}

/// In mode automatic.
fn automatic(count: u8, beat: u16) -> Seen {
    let mut seen = heard(count, beat);
    seen.beat.as_mut().unwrap().mode = OperatingMode::Automatic;
    seen
}

/// What was heard: the count of the last order, and a beat.
fn heard(count: u8, beat: u16) -> Seen {
    let mut seen = Seen::default();
    seen.status = Some(BoardStatus {
        count,
        ..BoardStatus::default()
    });
    seen.statuses = u64::from(beat);
    seen.beat = Some(BoardBeat {
        beat: Beat::new(beat),
        mode: OperatingMode::Manual,
        session: 0,
        press: 0,
        state: PressState::None,
        refused: 0,
    });
    seen
}

/// A page that orders, in a thread of its own: the answer comes when the board has confirmed.
fn orders(desk: &Arc<Desk>, op: &str, echo: Option<u16>) -> JoinHandle<Value> {
    orders_with(desk, op, Value::Null, echo)
}

fn orders_with(desk: &Arc<Desk>, op: &str, args: Value, echo: Option<u16>) -> JoinHandle<Value> {
    let before = desk.shared().tickets;
    let own = Arc::clone(desk);
    let order = leadscrew_panel::Order {
        op: op.to_owned(),
        args,
        echo,
    };
    let page = std::thread::spawn(move || {
        let answer = own.order(&order).unwrap();
        serde_json::from_str(&answer).unwrap()
    });
    let waits = || {
        let shared = desk.shared();
        shared.waiting.iter().any(|asked| asked.ticket > before)
    };
    while !waits() && !page.is_finished() {
        std::thread::yield_now();
    }
    page
}

fn sent(frames: &[Frame]) -> Vec<(u8, Order, Option<Beat>)> {
    let decoded = frames.iter().filter_map(BoardCommand::decode);
    decoded
        .map(|(_, command)| (command.count, command.order.unwrap(), command.echo))
        .collect()
}

#[test]
fn an_order_shows_the_age_of_what_its_page_has_seen() {
    let (desk, now) = (Arc::new(desk()), Instant::now());
    desk.turn(&heard(4, 1_000), now);
    let page = orders(&desk, "start", Some(800));
    let echo = Some(Beat::new(800));
    let frames = desk.turn(&heard(4, 1_010), now);
    assert_eq!(sent(&frames), [(5, Order::Run, echo)]);
    // The repetition is no fresher.
    let frames = desk.turn(&heard(4, 1_030), now + Duration::from_millis(20));
    assert_eq!(sent(&frames), [(5, Order::Run, echo)]);
    assert!(desk.turn(&heard(5, 1_040), now).is_empty());
    // Whether it was let in the board has to say.
    let asks = desk.asks();
    assert_eq!(asks.reasons, [1]);
    desk.answer(1, Err(both!("4501 wrong", "4501 错")));
    let answer = json!({"ok": false, "en": "4501 wrong", "zh": "4501 错"});
    assert_eq!(page.join().unwrap(), answer);
}

#[test]
fn by_old_values_nothing_is_ordered_but_hold_stop_and_reset() {
    let (desk, now) = (Arc::new(desk()), Instant::now());
    let refused = |op: &str, echo, at| {
        let page = orders(&desk, op, echo);
        assert!(desk.turn(&heard(4, 1_000), at).is_empty());
        assert_eq!(page.join().unwrap()["ok"], false, "{op} {echo:?}");
    };
    desk.turn(&heard(4, 1_000), now);
    for echo in [None, Some(749), Some(1_001), Some(40_000)] {
        refused("resume", echo, now);
    }
    let later = now + Duration::from_millis(251);
    refused("home", Some(1_000), later);
    for (op, order) in [
        ("reset", Order::Reset),
        ("hold", Order::Hold),
        ("stop", Order::Stop),
    ] {
        let page = orders(&desk, op, None);
        let frames = desk.turn(&heard(4, 1_000), later);
        let given = sent(&frames);
        assert_eq!(given.len(), 1);
        assert_eq!((given[0].1, given[0].2), (order, None));
        desk.turn(&heard(given[0].0, 1_000), later);
        assert_eq!(page.join().unwrap(), json!({"ok": true}));
    }
}

#[test]
fn a_stop_passes_what_is_on_its_way_and_no_hold_takes_its_place() {
    let (desk, now) = (Arc::new(desk()), Instant::now());
    desk.turn(&heard(4, 1_000), now);
    let resume = orders(&desk, "resume", Some(1_000));
    assert_eq!(sent(&desk.turn(&heard(4, 1_000), now)).len(), 1);
    let second = orders(&desk, "reset", None);
    let stop = orders(&desk, "stop", None);
    let frames = desk.turn(&heard(4, 1_000), now);
    assert_eq!(sent(&frames), [(6, Order::Stop, None)]);
    assert_eq!(resume.join().unwrap()["ok"], false);
    assert_eq!(second.join().unwrap()["ok"], false);
    let hold = orders(&desk, "hold", None);
    let later = now + Duration::from_millis(20);
    let frames = desk.turn(&heard(4, 1_000), later);
    assert_eq!(sent(&frames), [(6, Order::Stop, None)]);
    desk.turn(&heard(6, 1_000), later);
    for page in [stop, hold] {
        assert_eq!(page.join().unwrap(), json!({"ok": true}));
    }
}

#[test]
fn a_press_is_as_many_frames_as_came_and_a_release_always_goes() {
    let (desk, now) = (desk(), Instant::now());
    let jog = |way: i8, echo| {
        let jog = Jog {
            press: 9,
            axes: [way, 0],
            spindle: 0,
            rapid: false,
            speed: 300,
            echo,
        };
        let answer = desk.press(&jog, now);
        serde_json::from_str::<Value>(&answer).unwrap()
    };
    // Nothing is known of the board yet.
    assert_eq!(jog(1, 5)["ok"], false);
    desk.turn(&heard(4, 1_000), now);
    let answer = jog(-1, 990);
    assert_eq!(
        answer,
        json!({"ok": true, "beat": 1_000, "press": null, "pressed": null})
    );
    jog(0, 991);
    let frames = desk.turn(&heard(4, 1_000), now);
    let frames: Vec<_> = frames.iter().filter_map(JogRequest::decode).collect();
    let expected = |x, echo| JogRequest {
        session: desk.session,
        press: 9,
        x,
        z: None,
        spindle: None,
        rapid: false,
        speed: 300,
        echo: Beat::new(echo),
    };
    let pressed = expected(Some(Towards::Minus), 990);
    assert_eq!(frames, [(NODE, pressed), (NODE, expected(None, 991))]);
    // None is renewed from here, however often there is a turn.
    for ms in 0..1_000 {
        assert!(
            desk.turn(&heard(4, 1_000), now + Duration::from_millis(ms))
                .is_empty()
        );
    }
    // A queue that nobody empties does not grow.
    for _ in 0..100 {
        jog(0, 992);
    }
    assert_eq!(desk.turn(&heard(4, 1_000), now).len(), FRAMES);
}

#[test]
fn a_hold_of_a_machine_at_rest_takes_back_the_program_that_is_to_be_sent() {
    let folder = Folder::new();
    let (desk, now) = (folder.desk(), Instant::now());
    let mut seen = automatic(4, 1_000);
    desk.turn(&seen, now);
    let start = || orders_with(&desk, "program", folder.args.clone(), Some(1_000));
    let page = start();
    desk.turn(&seen, now);
    // A second one has to wait for the first.
    let second = start();
    desk.turn(&seen, now);
    let refused = second.join().unwrap()["en"].clone();
    assert!(refused.as_str().unwrap().starts_with("4502 "), "{refused}");
    let hold = orders(&desk, "hold", None);
    desk.turn(&seen, now);
    let taken = page.join().unwrap();
    assert!(
        taken["en"].as_str().unwrap().contains("taken the place"),
        "{taken}"
    );
    let asks = desk.asks();
    assert!(asks.programs.is_empty() && asks.halts == 1);
    seen = automatic(5, 1_000);
    desk.turn(&seen, now);
    assert_eq!(hold.join().unwrap(), json!({"ok": true}));
    // Behind it another one may be begun.
    let page = start();
    desk.turn(&seen, now);
    let asks = desk.asks();
    assert_eq!((asks.programs.len(), asks.halts), (1, 1));
    desk.answer(asks.programs[0].ticket, Ok(()));
    assert_eq!(page.join().unwrap(), json!({"ok": true}));
}

#[test]
fn a_program_is_kept_as_it_is_before_the_bus_has_its_turn_and_begins_behind_no_hold() {
    let folder = Folder::new();
    let (desk, now) = (folder.desk(), Instant::now());
    let seen = automatic(4, 1_000);
    desk.turn(&seen, now);
    // What the disk says needs no turn.
    let other = json!({"name": "a.nc", "tag": "1-x"});
    let page = orders_with(&desk, "program", other, Some(1_000));
    let refused = page.join().unwrap();
    assert_eq!(refused["en"], Refusal::Changed.words()[0]);
    assert!(!folder.is_claimed());
    let page = orders_with(&desk, "program", folder.args.clone(), Some(1_000));
    assert!(folder.is_claimed());
    // A hold that comes before it has had its turn passes it.
    let hold = orders(&desk, "hold", None);
    assert_eq!(sent(&desk.turn(&seen, now)), [(5, Order::Hold, None)]);
    let taken = page.join().unwrap();
    assert!(
        taken["en"].as_str().unwrap().contains("taken the place"),
        "{taken}"
    );
    assert!(desk.asks().programs.is_empty() && !folder.is_claimed());
    desk.turn(&automatic(5, 1_000), now);
    assert_eq!(hold.join().unwrap(), json!({"ok": true}));
}

#[test]
fn a_change_of_a_table_is_ordered_by_what_is_fresh() {
    let desk = desk();
    let order = |echo| leadscrew_panel::Order {
        op: "tools".to_owned(),
        args: json!({"seen": "1", "set": {"T1.X": "1"}, "check": true}),
        echo,
    };
    let answer = |echo| -> Value {
        let answer = desk.order(&order(echo)).unwrap();
        serde_json::from_str(&answer).unwrap()
    };
    let now = Instant::now();
    desk.turn(&heard(0, 1_000), now);
    for old in [None, Some(700)] {
        assert_eq!(answer(old)["en"], keys::old().en, "{old:?}");
    }
    // Nothing of the board has been read here.
    let fresh = answer(Some(1_000));
    assert!(
        fresh["en"].as_str().unwrap().contains("not read yet"),
        "{fresh}"
    );
}

/// Orders of each kind on their way: one that was sent, one that waits, a program that is to be begun.
fn under_way(
    desk: &Arc<Desk>,
    folder: &Folder,
    seen: &Seen,
    now: Instant,
) -> Vec<JoinHandle<Value>> {
    let page = orders(desk, "start", Some(1_000));
    assert_eq!(desk.turn(seen, now).len(), 1);
    let program = orders_with(desk, "program", folder.args.clone(), Some(1_000));
    desk.turn(seen, now);
    let levels = orders_with(desk, "feed", json!({"percent": 80}), Some(1_000));
    let reset = orders(desk, "reset", None);
    drop(levels);
    vec![page, program, reset]
}

#[test]
fn nothing_that_was_on_its_way_is_sent_when_the_board_is_heard_again() {
    let folder = Folder::new();
    let (desk, now) = (folder.desk(), Instant::now());
    let automatic = |count, beat, boots| {
        let mut seen = automatic(count, beat);
        seen.boots = boots;
        seen
    };
    let seen = automatic(4, 1_000, 0);
    desk.turn(&seen, now);
    let pages = under_way(&desk, &folder, &seen, now);
    desk.lose(both!("unheard", "无"));
    for page in pages {
        assert_eq!(page.join().unwrap()["en"], "unheard");
    }
    for op in ["hold", "reset", "start"] {
        let page = orders(&desk, op, Some(1_000));
        assert_eq!(page.join().unwrap()["en"], "unheard", "{op}");
    }
    let jog = Jog {
        press: 1,
        axes: [0, 0],
        spindle: 0,
        rapid: false,
        speed: 0,
        echo: 1_000,
    };
    desk.press(&jog, now);
    desk.find(0);
    let now = now + Duration::from_millis(40);
    assert!(desk.turn(&automatic(4, 1_000, 0), now).is_empty());
    assert!(desk.asks().programs.is_empty());
    // It may be ordered again, and a start of the board in between takes it back as well.
    let seen = automatic(4, 1_010, 0);
    desk.turn(&seen, now);
    let pages = under_way(&desk, &folder, &seen, now);
    let seen = automatic(4, 1_010, 1);
    assert!(desk.turn(&seen, now).is_empty());
    for page in pages {
        let told = page.join().unwrap();
        assert!(
            told["en"].as_str().unwrap().contains("started again"),
            "{told}"
        );
    }
    assert!(desk.turn(&seen, now + Duration::from_millis(40)).is_empty());
    assert!(desk.asks().programs.is_empty());
}

/// A shell that has written its first line: from then on it takes signals as this script says.
fn shell(script: &str) -> Child {
    let mut command = Command::new("env");
    command.args(["--default-signal=INT", "sh", "-c", script]);
    let mut child = command.stdout(Stdio::piped()).spawn().unwrap();
    let _ = child.stdout.as_mut().unwrap().read(&mut [0]).unwrap();
    child
}

/// The bus or the panel's own thread has stood still for longer than a page waits: what the page was told to have had no
/// answer does not begin behind it.
#[test]
fn what_no_page_waits_for_any_more_does_not_begin() {
    let folder = Folder::new();
    let mut desk = with(Some(Arc::clone(&folder.programs)));
    desk.patience = Duration::from_millis(300);
    let (desk, now) = (Arc::new(desk), Instant::now());
    let seen = automatic(4, 1_000);
    desk.turn(&seen, now);
    let program = || orders_with(&desk, "program", folder.args.clone(), Some(1_000));
    // A computer that is busy may come to it too late itself: then it is ordered once more.
    let asked = || loop {
        let page = program();
        desk.turn(&seen, now);
        if !desk.shared().asks.programs.is_empty() {
            return page;
        }
        page.join().unwrap();
    };
    let page = asked();
    let told = page.join().unwrap();
    assert!(
        told["en"].as_str().unwrap().contains("has not answered"),
        "{told}"
    );
    assert!(desk.asks().programs.is_empty() && !folder.is_claimed());
    assert!(!desk.shared().typed, "the next one may be ordered");
    // One that was taken to be begun, and is begun too late.
    let (page, ticket) = loop {
        let page = asked();
        if let [program] = &desk.asks().programs[..] {
            break (page, program.ticket);
        }
    };
    assert_eq!(page.join().unwrap()["ok"], false);
    assert!(!desk.is_awaited(ticket));
    let own = Handle::of(shell("echo; exec sleep 300"));
    desk.note_begun(ticket, own.clone(), 0);
    let signal = std::os::unix::process::ExitStatusExt::signal(&own.status());
    assert_eq!(signal, Some(2));
    desk.note_ended();
    // Answers that nobody takes are not kept.
    desk.answer(ticket, Ok(()));
    let shared = desk.shared();
    assert!(shared.answers.is_empty());
}

/// A command in a process of its own: what is checked would begin on a machine that nobody watches from here any more.
#[test]
fn a_panel_that_ends_ends_what_has_not_begun_and_nothing_else() {
    // Which signal came first, whatever the tests were begun with.
    const WAITS: &str = "trap 'exit 7' INT; trap 'exit 8' TERM; echo; while :; do sleep 0.02; done";
    for (begun, lost, code) in [
        (false, false, 7),
        (true, false, 8),
        // What the machine had begun before it was not heard any more.
        (true, true, 8),
        (false, true, 7),
    ] {
        let (desk, now) = (desk(), Instant::now());
        let mut seen = heard(0, 10);
        seen.status.as_mut().unwrap().flags.program = begun;
        desk.turn(&seen, now);
        let child = shell(WAITS);
        let number = nix::unistd::Pid::from_raw(child.id() as i32);
        let own = Handle::of(child);
        // A page waits for it.
        desk.shared().answers.insert(1, None);
        desk.note_begun(1, own.clone(), 0);
        if lost {
            desk.lose(both!("gone", "断开"));
        }
        desk.settle();
        nix::sys::signal::kill(number, nix::sys::signal::Signal::SIGTERM).unwrap();
        assert_eq!(own.status().code(), Some(code), "{begun} {lost}");
    }
}
