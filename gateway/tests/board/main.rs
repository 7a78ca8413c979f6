//! The command line against a board: the built binary, a serial-line adapter on a TCP port, and a whole machine behind it.

#[path = "../folder/mod.rs"]
mod folder;
mod home;
mod long;
#[path = "../../../tests/src/long_program.rs"]
mod long_program;
mod nmt;
mod offsets;
mod params;
mod passes;
#[path = "../pty/mod.rs"]
mod pty;
mod server;
mod terminal;
mod turns;
mod two;

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use leadscrew::link::Link;
use leadscrew_can::BitRate;
use leadscrew_core::bus::{NodeId, Object};
use leadscrew_core::link::{VERSION, Version};
use serde_json::Value;

use server::{Options, Server};

/// Nothing takes so long on any computer.
const LIMIT: Duration = Duration::from_secs(300);

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn command(args: &[&str], bus: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_leadscrew"));
    command
        .args(args)
        .args(["--bus", bus])
        .current_dir(root())
        .env("NO_COLOR", "1");
    command
}

#[track_caller]
fn leadscrew(args: &[&str], bus: &str) -> Output {
    Run::of(command(args, bus)).end()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

#[track_caller]
fn good(output: &Output) -> String {
    assert_eq!(
        output.status.code(),
        Some(0),
        "{}{}",
        text(&output.stdout),
        text(&output.stderr)
    );
    text(&output.stdout)
}

#[track_caller]
fn bad(output: &Output, code: i32) -> String {
    assert_eq!(
        output.status.code(),
        Some(code),
        "{}{}",
        text(&output.stdout),
        text(&output.stderr)
    );
    text(&output.stderr)
}

fn json(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout)
        .unwrap_or_else(|error| panic!("{error}: {}{}", text(&output.stdout), text(&output.stderr)))
}

/// A board whose time goes by as it does here: whoever is slow still comes in the middle of a program of a minute.
fn slow() -> Server {
    Server::start(&Options {
        speed: 1,
        ..Options::default()
    })
}

/// A run in the background.
struct Run(Child);

impl Run {
    fn start(program: &str, bus: &str) -> Self {
        Self::of(command(&["run", program, "--json"], bus))
    }

    fn of(mut command: Command) -> Self {
        let piped = command.stdout(Stdio::piped()).stderr(Stdio::piped());
        Self(piped.spawn().unwrap())
    }

    /// What hangs is ended, and tells what it has said.
    #[track_caller]
    fn end(self) -> Output {
        let pid = self.0.id().to_string();
        let (ended, end) = std::sync::mpsc::channel();
        std::thread::spawn(move || ended.send(self.0.wait_with_output().unwrap()));
        end.recv_timeout(LIMIT).unwrap_or_else(|_| {
            let _ = Command::new("kill").args(["-KILL", &pid]).status();
            let output = end.recv().unwrap();
            panic!(
                "it does not end: {}{}",
                text(&output.stdout),
                text(&output.stderr)
            )
        })
    }
}

/// Waits until a look at the board shows what is wanted.
#[track_caller]
fn wait_for(bus: &str, what: &str, wanted: impl Fn(&Value) -> bool) -> Value {
    wait_until(what, || {
        let status = json(&leadscrew(&["status", "--json"], bus));
        wanted(&status).then_some(status)
    })
}

/// Waits until there is something.
#[track_caller]
fn wait_until<T>(what: &str, mut look: impl FnMut() -> Option<T>) -> T {
    let end = Instant::now() + Duration::from_secs(300);
    loop {
        if let Some(seen) = look() {
            return seen;
        }
        assert!(Instant::now() < end, "it did not come: {what}");
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// The threads of a result. Which of the drive's positions are judged depends on the tick in which a program begins, so of
/// the cut there is only what does not.
fn tallies(result: &Value) -> Value {
    let mut threads = result["threads"].clone();
    for thread in threads.as_array_mut().unwrap() {
        if thread["cut"].is_object() {
            let cut = &thread["cut"];
            thread["cut"] = serde_json::json!([cut["axis"], cut["lead_mm"], cut["passes"]]);
        }
    }
    threads
}

#[test]
fn a_run_makes_the_setpoints_of_the_simulation() {
    for program in ["examples/shaft.nc", "examples/g84-peck.nc"] {
        let simulated = Command::new(env!("CARGO_BIN_EXE_leadscrew"))
            .args(["run", program, "--json"])
            .current_dir(root())
            .output()
            .unwrap();
        let simulated = json(&simulated);
        let server = Server::start(&Options::default());
        let output = leadscrew(&["run", program, "--json"], &server.bus());
        let ran = json(&output);
        assert_eq!(output.status.code(), Some(0), "{ran}");
        assert_eq!(ran["ok"], true);
        assert_eq!(ran["moves"], simulated["moves"]);
        assert_eq!(ran["late"], 0);
        // The same book of the same ticks.
        assert_eq!(tallies(&ran), tallies(&simulated));
        assert!(
            ran["threads"]
                .as_array()
                .is_some_and(|threads| !threads.is_empty())
        );
        // That of the moves, and that from setpoint to setpoint: a pass joins its helix and leaves it on a curve.
        let path = |result: &Value| result["path_mm"].as_f64().unwrap();
        let apart = path(&ran) - path(&simulated);
        assert!(apart.abs() < 1e-3 * path(&simulated), "{apart}");
        assert_eq!(ran["setpoint_hash"], simulated["setpoint_hash"]);
        assert_eq!(
            server.hash(),
            simulated["setpoint_hash"].as_str().unwrap(),
            "{program}"
        );
    }
}

/// Three times as many holes as the board keeps certificates of: it does not go on before whoever runs them has taken them,
/// however many somebody else reads meanwhile.
#[test]
fn every_hole_has_its_certificate_and_is_judged_by_it() {
    let mut holes = String::from("G98\nG0 X40 Z5 C0\nM29 S1500\nG84 C0 Z-4 R-3 F1500\n");
    for hole in 1..24 {
        holes.push_str(&format!("C{}\n", hole * 15));
    }
    holes.push_str("G80\nM30\n");
    let path = std::env::temp_dir().join(format!("holes-{}.nc", std::process::id()));
    std::fs::write(&path, holes).unwrap();
    let program = path.to_str().unwrap();
    let simulated = Command::new(env!("CARGO_BIN_EXE_leadscrew"))
        .args(["run", program, "--json"])
        .output()
        .unwrap();
    let simulated = json(&simulated);
    let server = Server::start(&Options {
        // Watched, or nobody is waited for: a heartbeat that is seconds late is still one in time.
        set: vec![("9024", 60_000)],
        speed: 8,
        ..Options::default()
    });
    let bus = server.bus();
    let over = AtomicBool::new(false);
    let (told, looked) = std::thread::scope(|scope| {
        let other = scope.spawn(|| {
            let mut link = Link::open(&bus.parse().unwrap(), NodeId::BOARD, BitRate::M1).unwrap();
            let mut newest = 0;
            while !over.load(Ordering::Relaxed) {
                let (_, threads) = link.certificates().unwrap();
                assert!(threads.len() <= 5);
                newest = threads.first().map_or(0, |thread| thread.number);
                link.idle(Duration::from_millis(25)).unwrap();
            }
            newest
        });
        let told = json(&leadscrew(&["run", program, "--json"], &bus));
        over.store(true, Ordering::Relaxed);
        (told, other.join().unwrap())
    });
    // From the number of the newest he knows how many there were.
    assert!(looked > 8, "{looked}");
    assert_eq!(told["threads_missing"], 0, "{told}");
    // What a shop would keep with the part.
    let mut link = Link::open(&bus.parse().unwrap(), NodeId::BOARD, BitRate::M1).unwrap();
    let parameters = format!("{:08x}", link.parameters_identity().unwrap());
    drop(link);
    assert_eq!(told["program"], program);
    assert_eq!(told["parameters"], parameters);
    assert_eq!(told["gateway"], env!("CARGO_PKG_VERSION"));
    assert_eq!(
        told["board"],
        serde_json::json!({"node": 1, "serial": "00000000", "version": env!("CARGO_PKG_VERSION")})
    );
    let started = told["started"].as_str().unwrap();
    assert!(
        started.starts_with("20") && started.ends_with('Z'),
        "{started}"
    );
    assert_eq!(told["sync_error_um"], told["measured_error_um"]);
    assert_eq!(told["measured_error_um"], simulated["measured_error_um"]);
    assert_eq!(tallies(&told), tallies(&simulated));
    let threads = told["threads"].as_array().unwrap();
    let lines: Vec<u64> = threads.iter().filter_map(|t| t["line"].as_u64()).collect();
    assert_eq!(lines, (4..28).collect::<Vec<_>>());
    // Once more on the same board: its numbers go on, those of the run begin at 1.
    let again = leadscrew(
        &["run", program, "--json", "--tolerance", "0.001"],
        &server.bus(),
    );
    assert_eq!(again.status.code(), Some(1));
    assert!(
        text(&again.stderr).contains("above the tolerance of 0.001 µm: line 4, 5, "),
        "{}",
        text(&again.stderr)
    );
    let again = json(&again);
    assert_eq!(again["ok"], false);
    assert_eq!(again["threads"][23]["n"], 24);
    let _ = std::fs::remove_file(&path);
}

#[test]
fn an_operator_holds_resumes_and_sets_overrides_while_it_runs() {
    let server = slow();
    let bus = server.bus();
    let run = Run::start("examples/shaft.nc", &bus);
    wait_for(&bus, "the program runs", |status| {
        status["program"] == true && status["line"].as_u64() > Some(3)
    });
    good(&leadscrew(&["hold"], &bus));
    let held = wait_for(&bus, "it holds", |status| status["state"] == "hold");
    assert_eq!(held["hold"], true);
    assert_eq!(held["emergency_stop"], false);
    let told = good(&leadscrew(&["override", "feed", "150%"], &bus));
    assert_eq!(told, "node 1: feed override 150 %\n");
    good(&leadscrew(&["override", "rapid", "100"], &bus));
    let signal = good(&leadscrew(&["signal", "SWS1=1", "--json"], &bus));
    assert!(
        signal.contains("\"signal\":\"SWS1\",\"level\":1"),
        "{signal}"
    );
    let still = json(&leadscrew(&["status", "--json"], &bus));
    assert_eq!(still["state"], "hold");
    assert_eq!(still["override"]["feed"], 150);
    assert_eq!(still["signals"], 1 << 4);
    good(&leadscrew(&["resume"], &bus));
    server.hurry();
    let output = run.end();
    let ran = json(&output);
    assert_eq!(output.status.code(), Some(0), "{ran}");
    assert_eq!(ran["ok"], true);
    let told = text(&output.stderr);
    assert!(told.contains("feed hold"), "{told}");
}

#[test]
fn a_stop_is_an_alarm_with_its_line_and_reset_clears_it() {
    let server = slow();
    let bus = server.bus();
    let run = Run::start("examples/shaft.nc", &bus);
    wait_for(&bus, "the program runs", |status| {
        status["line"].as_u64() > Some(3)
    });
    let stopped = json(&leadscrew(&["stop", "--json"], &bus));
    assert_eq!(stopped["ok"], true);
    server.hurry();
    let output = run.end();
    assert_eq!(output.status.code(), Some(4));
    let ran = json(&output);
    assert_eq!(ran["ok"], false);
    assert_eq!(ran["alarms"][0]["no"], 4300);
    assert!(ran["alarms"][0]["line"].as_u64() > Some(3), "{ran}");
    assert!(text(&output.stderr).contains("examples/shaft.nc:"));

    let status = json(&leadscrew(&["status", "--json"], &bus));
    assert_eq!(
        (status["state"].as_str(), status["alarm"]["no"].as_u64()),
        (Some("alarm"), Some(4300))
    );
    assert_eq!(
        (&status["emergency_stop"], &status["signals"]),
        (&Value::Bool(true), &Value::from(0))
    );
    let told = good(&leadscrew(&["status"], &bus));
    assert!(
        told.contains("\nstopped: by the emergency stop or by `leadscrew stop`\n"),
        "{told}"
    );
    let refused = bad(&leadscrew(&["run", "examples/g84-tap.nc"], &bus), 4);
    assert!(refused.contains("`leadscrew reset`"), "{refused}");
    good(&leadscrew(&["reset"], &bus));
    let status = json(&leadscrew(&["status", "--json"], &bus));
    assert_eq!(status["emergency_stop"], false);
    // The next program counts its own moves and is none the worse.
    let output = leadscrew(&["run", "examples/g84-tap.nc", "--json"], &bus);
    let ran = json(&output);
    assert_eq!(
        (ran["ok"].as_bool(), ran["moves"].as_u64()),
        (Some(true), Some(7)),
        "{ran}"
    );
}

#[test]
fn interrupted_the_machine_is_brought_to_rest_first() {
    for signal in ["-INT", "-TERM"] {
        interrupted_by(signal);
    }
}

fn interrupted_by(signal: &str) {
    let server = slow();
    let bus = server.bus();
    let run = Run::start("examples/shaft.nc", &bus);
    wait_for(&bus, "the program runs", |status| {
        status["line"].as_u64() > Some(3)
    });
    let pid = run.0.id().to_string();
    assert!(
        Command::new("kill")
            .args([signal, &pid])
            .status()
            .unwrap()
            .success()
    );
    let output = run.end();
    assert_eq!(output.status.code(), Some(130), "{}", text(&output.stderr));
    // What was done until then is told.
    let ran = json(&output);
    assert_eq!(ran["ok"], false);
    assert_eq!(ran["setpoint_hash"], server.hash());
    assert!(ran["time_s"].as_f64() > Some(0.0), "{ran}");
    let status = json(&leadscrew(&["status", "--json"], &bus));
    assert_eq!(status["state"], "idle");
    assert_eq!(status["program"], false);
}

#[test]
fn nobody_or_too_many_under_the_number_each_have_their_message() {
    let server = Server::start(&Options::default());
    let told = bad(&leadscrew(&["status", "--node", "5"], &server.bus()), 3);
    assert!(
        told.contains("no board answers as node 5") && told.contains("node 1"),
        "{told}"
    );
    let told = bad(&leadscrew(&["hold", "--node", "5"], &server.bus()), 3);
    assert!(told.contains("no board answers as node 5"), "{told}");
    drop(server);
    let two = Server::start(&Options {
        nodes: vec![1, 1],
        ..Options::default()
    });
    // Nor is a board needed to tell that there is no such program.
    let told = bad(&leadscrew(&["run", "no-such.nc"], &two.bus()), 2);
    assert!(told.contains("cannot read `no-such.nc`"), "{told}");
    let told = bad(&leadscrew(&["run", "examples/shaft.nc"], &two.bus()), 3);
    assert!(told.contains("two boards answer as node 1"), "{told}");
    let chinese = bad(&leadscrew(&["status", "--lang", "zh"], &two.bus()), 3);
    assert!(chinese.contains("两块控制板"), "{chinese}");
}

#[test]
fn a_board_that_goes_silent_is_lost() {
    let server = slow();
    let bus = server.bus();
    let run = Run::start("examples/shaft.nc", &bus);
    wait_for(&bus, "the program runs", |status| {
        status["line"].as_u64() > Some(3)
    });
    server.unplug();
    let told = bad(&run.end(), 3);
    assert!(
        told.contains("has gone silent") || told.contains("timed out, abort code 05040000h"),
        "{told}"
    );
    let told = bad(&leadscrew(&["status"], "slcan:tcp:127.0.0.1:1"), 3);
    assert!(told.contains("127.0.0.1:1"), "{told}");
}

/// A run that loses its board behind two holes.
fn lost_behind_two_holes(options: &[&str]) -> Output {
    let server = slow();
    let bus = server.bus();
    let holes =
        "G98\nG0 X40 Z5 C0\nM29 S1500\nG84 C0 Z-4 R-3 F1500 K2\nG80\nG0 X80\nG98 G1 X90 F5\nM30\n";
    let path = std::env::temp_dir().join(format!("silent-{}.nc", std::process::id()));
    std::fs::write(&path, holes).unwrap();
    let run = Run::of(command(
        &[&["run", path.to_str().unwrap()], options].concat(),
        &bus,
    ));
    // The board knows how far whoever runs them has got.
    let mut link = Link::open(&bus.parse().unwrap(), NodeId::BOARD, BitRate::M1).unwrap();
    wait_until("both holes are taken", || {
        let taken = link.read(Object::new(0x5042, 0)).unwrap();
        (taken == [2, 0, 0, 0]).then_some(())
    });
    server.unplug();
    let output = run.end();
    let _ = std::fs::remove_file(&path);
    output
}

#[test]
fn what_a_board_has_told_of_its_threads_is_not_lost_with_it() {
    let output = lost_behind_two_holes(&[]);
    bad(&output, 3);
    let told = text(&output.stdout);
    assert!(told.contains("2: line 4: rigid tap: worst "), "{told}");
    let output = lost_behind_two_holes(&["--json"]);
    let said = bad(&output, 3);
    let told: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((&told["ok"], &told["exit"]), (&false.into(), &3.into()));
    let error = told["error"].as_str().unwrap();
    assert!(said.contains(error), "{said}{told}");
    assert_eq!(told["threads"].as_array().unwrap().len(), 2, "{told}");
    assert_eq!(told["threads"][1]["state"], "finished", "{told}");
    // Nor are its warnings: S is not reached.
    assert_eq!(told["alarms"], Value::Array(vec![]), "{told}");
    assert_eq!(told["warnings"][0]["no"], 4945, "{told}");
    assert_eq!(told["threads_missing"], 0, "{told}");
}

#[test]
fn the_board_s_own_parameters_count() {
    let server = Server::start(&Options {
        set: vec![("9024", 0), ("1430.Z", 1_700_000_000)],
        ..Options::default()
    });
    let bus = server.bus();
    let value = json(&leadscrew(&["params", "get", "1430.Z", "--json"], &bus));
    assert_eq!(value["params"][0]["value"], 1700, "{value}");
    // 300 rpm at 6 mm a turn are 1800 mm/min: too fast for this machine, and known before anything moves.
    let told = bad(&leadscrew(&["run", "examples/o0013-g76-m68x6.nc"], &bus), 1);
    assert!(told.contains("1700 mm/min"), "{told}");
    let told = bad(
        &leadscrew(&["run", "examples/shaft.nc", "--set", "9007=1"], &bus),
        1,
    );
    assert!(told.contains("another machine"), "{told}");
    assert_eq!(json(&leadscrew(&["status", "--json"], &bus))["move"], 0);
}

/// What is wrong with options is told in the form of a run's result, whether it shows without the board's set or only over
/// it: there the cutting feed of X lies above its rapid rate of 8000 mm/min.
#[test]
fn wrong_parameters_leave_a_run_its_form() {
    let server = Server::start(&Options {
        set: vec![("9024", 0), ("1430.X", 2_000_000_000)],
        ..Options::default()
    });
    let bus = server.bus();
    let shaft = "examples/shaft.nc";
    let keys =
        |told: &Value| -> Vec<String> { told.as_object().unwrap().keys().cloned().collect() };
    // A program that is refused has the whole form.
    let folder = std::env::temp_dir().join(format!("refused-{}.nc", std::process::id()));
    std::fs::write(&folder, "G33 Z5 F1\n").unwrap();
    let refused = json(&leadscrew(
        &["run", folder.to_str().unwrap(), "--json"],
        &bus,
    ));
    let _ = std::fs::remove_file(&folder);
    for (set, number) in [("1420.X=0", 4410), ("1420.X=1000", 4422)] {
        let output = leadscrew(&["run", shaft, "--set", set, "--json"], &bus);
        let told = json(&output);
        assert_eq!(output.status.code(), Some(1), "{told}");
        assert_eq!(told["alarms"][0]["no"], number, "{told}");
        assert_eq!(keys(&told), keys(&refused), "{set}");
        assert_eq!((&told["ok"], &told["moves"]), (&false.into(), &0.into()));
        assert_eq!(
            (&told["program"], &told["bus"]),
            (&shaft.into(), &bus.clone().into())
        );
        for unknown in ["path_mm", "setpoint_hash", "parameters", "board", "started"] {
            assert_eq!(told[unknown], Value::Null, "{unknown}");
        }
    }
}

#[test]
fn what_only_a_simulated_machine_can_do_is_a_usage_error() {
    for args in [
        &["simulate", "examples/shaft.nc"][..],
        &["plot", "examples/shaft.nc", "-o", "out.svg"],
        &["run", "examples/shaft.nc", "--spindle-ripple", "10@5"],
        &["run", "examples/shaft.nc", "--at", "X=10"],
        &["run", "examples/shaft.nc", "--tick-us", "500"],
        &["run", "examples/shaft.nc", "--record", "bus.log"],
        &["run", "examples/shaft.nc", "--state", "flash.bin"],
        &["run", "examples/shaft.nc", "--cut-power", "5"],
        &["override", "spindle", "30"],
        &["override", "rapid", "101"],
        &["override", "feed", "500"],
    ] {
        // Nobody listens there: it does not come to that.
        let told = bad(&leadscrew(args, "slcan:tcp:127.0.0.1:1"), 2);
        assert!(told.starts_with("error: `"), "{told}");
    }
}

/// A second reader of the event log moves the place to read from: nothing of the log is lost on the first one. Both read
/// until the run has ended, however long that takes.
#[test]
fn two_clients_read_the_event_log_without_losing_any_of_it() {
    let server = Server::start(&Options {
        speed: 8,
        ..Options::default()
    });
    let bus = server.bus();
    let open = || Link::open(&bus.parse().unwrap(), NodeId::BOARD, BitRate::M1).unwrap();
    let over = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let meddler = scope.spawn(|| {
            let mut other = open();
            while !over.load(Ordering::Relaxed) {
                // Only the newest one.
                let newest = other.newest_event().unwrap();
                let from = Object::new(0x5040, 2);
                other.write(from, &newest.to_le_bytes()).unwrap();
                other.idle(Duration::from_millis(25)).unwrap();
            }
        });
        let reader = scope.spawn(|| {
            let mut link = open();
            let mut last = 0;
            loop {
                let ended = over.load(Ordering::Relaxed);
                let entries = link.events_behind(last).unwrap();
                for entry in &entries {
                    assert_eq!(entry.number, last + 1);
                    last = entry.number;
                }
                if ended && entries.is_empty() {
                    assert_eq!(last, link.newest_event().unwrap());
                    break last;
                }
                link.idle(Duration::from_millis(10)).unwrap();
            }
        });
        let output = leadscrew(&["run", "examples/shaft.nc", "--json"], &bus);
        over.store(true, Ordering::Relaxed);
        let ran = json(&output);
        assert_eq!(output.status.code(), Some(0), "{ran}");
        meddler.join().unwrap();
        // Every move begins with one.
        let last = reader.join().unwrap();
        assert!(u64::from(last) > ran["moves"].as_u64().unwrap(), "{last}");
    });
}

/// Several clients share one server on the board: one that asks without a pause does not keep another from its turn, and
/// is answered itself.
#[test]
fn a_program_is_fed_while_others_ask_without_a_pause() {
    let server = Server::start(&Options::default());
    let bus = server.bus();
    let over = AtomicBool::new(false);
    std::thread::scope(|scope| {
        // One that stays and asks on and on, and one that comes anew each time.
        let stays = scope.spawn(|| {
            let address = bus.parse().unwrap();
            let mut link = Link::open(&address, NodeId::BOARD, BitRate::M1).unwrap();
            let mut looks = 0_u32;
            while !over.load(Ordering::Relaxed) {
                link.status().unwrap();
                looks += 1;
            }
            looks
        });
        let comes = scope.spawn(|| {
            let mut looks = 0_u32;
            while !over.load(Ordering::Relaxed) {
                good(&leadscrew(&["status", "--json"], &bus));
                looks += 1;
            }
            looks
        });
        let output = leadscrew(&["run", "examples/shaft.nc", "--json"], &bus);
        over.store(true, Ordering::Relaxed);
        let ran = json(&output);
        assert_eq!(
            output.status.code(),
            Some(0),
            "{ran}{}",
            text(&output.stderr)
        );
        assert_eq!(ran["setpoint_hash"], server.hash());
        assert!(stays.join().unwrap() > 0);
        assert!(comes.join().unwrap() > 0);
    });
}

/// Where every answer takes longer than a transfer elsewhere, clients still let each other finish. [D178]
#[test]
fn clients_of_a_slow_board_do_not_break_into_each_other_s_transfers_for_ever() {
    let server = Server::start(&Options {
        lag: Duration::from_millis(70),
        ..Options::default()
    });
    let bus = server.bus();
    std::thread::scope(|scope| {
        for _ in 0..3 {
            scope.spawn(|| {
                let address = bus.parse().unwrap();
                let mut link = Link::open(&address, NodeId::BOARD, BitRate::M1).unwrap();
                for _ in 0..8 {
                    link.status().unwrap();
                }
            });
        }
    });
}

/// A board that speaks another version of the link is refused before anything of it is read.
#[test]
fn another_version_of_the_link_is_named_with_both_versions() {
    let server = Server::start(&Options {
        key: Some(0x0002_1234),
        ..Options::default()
    });
    let bus = server.bus();
    let theirs = Version {
        key: 0x0002_1234,
        ..VERSION
    };
    let (theirs, ours) = (theirs.to_string(), VERSION.to_string());
    let told = bad(&leadscrew(&["status"], &bus), 3);
    assert!(told.contains(&theirs) && told.contains(&ours), "{told}");
    assert!(told.contains("to one version"), "{told}");
    let told = bad(
        &leadscrew(&["run", "examples/shaft.nc", "--lang", "zh"], &bus),
        3,
    );
    assert!(told.contains(&theirs) && told.contains(&ours), "{told}");
    assert!(told.contains("更新到同一版本"), "{told}");
}

/// A socket that only its owner may use, asked by somebody else.
#[test]
fn a_missing_permission_says_how_to_get_it_in_both_languages() {
    use std::os::unix::fs::PermissionsExt as _;
    use std::os::unix::process::CommandExt as _;
    let dir = std::env::temp_dir().join(format!("leadscrew-closed-{}", std::process::id()));
    std::fs::create_dir_all(&dir).unwrap();
    let path = dir.join("adapter");
    let _listener = std::os::unix::net::UnixListener::bind(&path).unwrap();
    // Nobody's: an administrator would be let in.
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o000)).unwrap();
    let program = dir.join("leadscrew");
    // By another process: while this one has a program open to write, a child that another test starts may keep it open,
    // and nobody can start it (ETXTBSY).
    let copied = Command::new("cp")
        .arg(env!("CARGO_BIN_EXE_leadscrew"))
        .arg(&program)
        .status();
    assert!(copied.unwrap().success());
    let bus = format!("slcan:unix:{}", path.display());
    let ask = |lang: &str| {
        let mut command = Command::new(&program);
        command
            .args(["status", "--bus", &bus, "--lang", lang])
            .current_dir("/");
        if is_administrator() {
            command.uid(65_534);
        }
        command.output().unwrap()
    };
    let told = bad(&ask("en"), 3);
    assert!(told.contains("no permission to use"), "{told}");
    assert!(told.contains("docs/can.md"), "{told}");
    let told = bad(&ask("zh"), 3);
    assert!(told.contains("没有使用"), "{told}");
    std::fs::remove_dir_all(&dir).unwrap();
}

fn is_administrator() -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let line = status.lines().find_map(|line| line.strip_prefix("Uid:"));
    line.and_then(|line| line.split_whitespace().nth(1)) == Some("0")
}

#[test]
fn an_entry_of_the_tap_journal_is_dropped_over_the_bus() {
    let server = slow();
    let bus = server.bus();
    let refused = bad(&leadscrew(&["retract", "--discard"], &bus), 1);
    assert!(refused.contains("no tap is in a hole"), "{refused}");
    // Half a minute in the hole.
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("slow-tap.nc");
    let text = "G98\nG0 X50 Z0\nM29 S200\nG84 Z-30 P9999 F200\nG80\nM30\n";
    std::fs::write(&path, text).unwrap();
    let run = Run::start(path.to_str().unwrap(), &bus);
    wait_for(&bus, "the tap is in its hole", |status| {
        status["tap"]["in_hole"] == true
    });
    good(&leadscrew(&["stop"], &bus));
    server.hurry();
    assert_eq!(run.end().status.code(), Some(4));
    good(&leadscrew(&["reset"], &bus));
    wait_for(&bus, "it is ready again", |status| {
        status["state"] == "idle"
    });
    // Nothing moves while it is in there.
    bad(&leadscrew(&["run", "examples/shaft.nc"], &bus), 1);
    let told = good(&leadscrew(&["retract", "--discard"], &bus));
    assert!(told.contains("dropped"), "{told}");
    wait_for(&bus, "the entry is gone", |status| {
        status["tap"]["in_hole"] != true
    });
    bad(&leadscrew(&["retract", "--discard"], &bus), 1);
    good(&leadscrew(&["run", "examples/shaft.nc", "--json"], &bus));
}

#[test]
fn the_bit_rate_of_an_adapter_can_be_chosen_and_that_of_an_interface_cannot() {
    let server = Server::start(&Options::default());
    good(&leadscrew(&["status", "--bitrate", "500"], &server.bus()));
    assert_eq!(server.bit_rate(), Some(BitRate::K500));
    good(&leadscrew(&["status"], &server.bus()));
    assert_eq!(server.bit_rate(), Some(BitRate::M1));
    let told = bad(&leadscrew(&["status", "--bitrate", "500"], "can0"), 2);
    assert!(told.contains("bitrate 500000"), "{told}");
    bad(&leadscrew(&["status", "--bitrate", "333"], "can0"), 2);
}
