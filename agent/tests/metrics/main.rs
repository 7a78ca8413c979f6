//! The figures as a scraper gets them: over a socket, read by the rules of the text format.

mod contrib;

use std::collections::BTreeMap;
use std::io::{Read as _, Write as _};
use std::net::TcpStream;
use std::sync::Arc;
use std::time::Duration;

use leadscrew_agent::metrics::{Metrics, Pulse, Server};
use leadscrew_agent::record::{
    Cut, Errors, Event, Figure, Gap, Identity, Measured, Missing, Presence, Run, Start, State,
    Thread, Trouble, What,
};
use leadscrew_agent::{Body, Moment, Numbered, Record};

/// Nothing takes so long on any computer.
const LIMIT: Duration = Duration::from_secs(60);

fn take(metrics: &Metrics, bodies: impl IntoIterator<Item = Body>) {
    for body in bodies {
        let record = Record {
            at: Moment(0),
            machine: "lathe".to_owned(),
            body,
        };
        metrics.take(&[Numbered { number: 1, record }]);
    }
}

/// Samples by name with labels. Every line has to be a sample of a metric that was described before, or a description.
fn parse(text: &str) -> BTreeMap<String, f64> {
    let mut samples = BTreeMap::new();
    let mut described = Vec::new();
    let lines = text.strip_suffix("# EOF\n").expect("the end is told");
    for line in lines.lines() {
        if let Some(words) = line.strip_prefix("# ") {
            let words: Vec<&str> = words.splitn(3, ' ').collect();
            let [kind @ ("HELP" | "TYPE" | "UNIT"), name, _] = words[..] else {
                panic!("{line}");
            };
            if kind == "TYPE" {
                described.push(name.to_owned());
            }
            continue;
        }
        let (sample, value) = line.rsplit_once(' ').expect(line);
        let name = sample.split('{').next().unwrap();
        assert!(
            name.chars().all(|c| c.is_ascii_lowercase() || c == '_'),
            "{name}"
        );
        assert!(
            described.iter().any(|one| name.starts_with(one.as_str())),
            "{line}"
        );
        if let Some(labels) = sample
            .strip_prefix(name)
            .filter(|labels| !labels.is_empty())
        {
            let labels = labels
                .strip_prefix('{')
                .and_then(|labels| labels.strip_suffix('}'));
            for label in labels.expect(line).split(',') {
                let (_, value) = label.split_once('=').expect(line);
                assert!(
                    value.len() >= 2 && value.starts_with('"') && value.ends_with('"'),
                    "{line}"
                );
            }
        }
        let value: f64 = value.parse().expect(line);
        assert_eq!(
            samples.insert(sample.to_owned(), value),
            None,
            "twice: {line}"
        );
    }
    samples
}

fn state(state: &str) -> Body {
    Body::State(State {
        state: state.to_owned(),
        alarm: 4036,
        late: 3,
        feed_percent: 80,
        rpm: -600,
        load_percent: Some(42),
        ..State::default()
    })
}

fn thread(largest_nm: i64, cut: Cut) -> Body {
    Body::Thread(Thread {
        start: Start::default(),
        number: 1,
        program: 1,
        line: 1,
        kind: "thread".to_owned(),
        end: "finished".to_owned(),
        passes: 1,
        late: 0,
        errors: Errors {
            measured: 4,
            largest_nm,
            squares: 4 * 90_000,
        },
        cut,
    })
}

fn presence(alive: bool) -> Body {
    Body::Presence(Presence {
        alive,
        why: String::new(),
    })
}

fn measured(worst_nm: i64) -> Cut {
    Cut::Measured(Measured {
        axis: 'Z',
        age_known: true,
        positions: 90,
        passes: 2,
        lead_nm: 1_500_000,
        grooves: Some([Figure(1, 2), Figure(3, 4)]),
        apart: Some(Figure(1_200, 400)),
        slope: None,
        worst: Figure(worst_nm.abs(), 600),
        complete: true,
        why: String::new(),
    })
}

fn identity(parameters: u32) -> Body {
    Body::Identity(Identity {
        start: Start {
            serial: 10,
            count: 2,
        },
        parameters,
        firmware: "0.1.0".to_owned(),
    })
}

/// Figures of which each has a sample.
fn full() -> Metrics {
    let metrics = Metrics::default();
    parse(&metrics.text());
    let alarm = |number| {
        Body::Event(Event {
            start: Start::default(),
            number: 1,
            tick: 1,
            what: What::Alarm(Trouble {
                number,
                line: 1,
                cause: "c".to_owned(),
                remedy: "r".to_owned(),
            }),
        })
    };
    let warning = Body::Event(Event {
        start: Start::default(),
        number: 2,
        tick: 1,
        what: What::Warning(Trouble {
            number: 7001,
            line: 0,
            cause: "c".to_owned(),
            remedy: "r".to_owned(),
        }),
    });
    let run = Run {
        start: Start::default(),
        program: 1,
        finished: true,
        ticks: 1,
        setpoint_hash: None,
        late: 0,
        errors: Errors {
            measured: 0,
            largest_nm: 0,
            squares: 0,
        },
    };
    let gap = Gap {
        start: Start::default(),
        of: Missing::Threads,
        first: 3,
        last: 5,
    };
    take(
        &metrics,
        [
            presence(true),
            identity(1),
            identity(0x5EED),
            state("run"),
            state("alarm"),
            warning,
            alarm(4036),
            alarm(4036),
            alarm(1),
            thread(1_500, measured(3_000)),
            thread(700, measured(-40_000)),
            thread(700, Cut::Unknown("no position".to_owned())),
            thread(700, Cut::Hole),
            Body::Run(run),
            Body::Gap(gap),
        ],
    );
    metrics.pulse(
        "lathe",
        Pulse {
            ticks: 77,
            credit: 2000,
            dropped: 1,
        },
    );
    metrics
}

#[test]
fn what_records_say_is_in_the_figures() {
    let metrics = full();
    let samples = parse(&metrics.text());
    let board = r#"leadscrew_board{machine="lathe",serial="0000000a",start="2",firmware="0.1.0",parameters="00005eed"}"#;
    for (sample, value) in [
        (r#"leadscrew_board_up{machine="lathe"}"#, 1.0),
        (board, 1.0),
        (
            r#"leadscrew_machine_state{machine="lathe",state="alarm"}"#,
            1.0,
        ),
        (
            r#"leadscrew_machine_state{machine="lathe",state="run"}"#,
            0.0,
        ),
        (r#"leadscrew_machine_alarm{machine="lathe"}"#, 4036.0),
        (
            r#"leadscrew_alarms_total{machine="lathe",number="4036"}"#,
            2.0,
        ),
        (r#"leadscrew_alarms_total{machine="lathe",number="1"}"#, 1.0),
        (r#"leadscrew_late_setpoints{machine="lathe"}"#, 3.0),
        (r#"leadscrew_bus_load_ratio{machine="lathe"}"#, 0.42),
        (r#"leadscrew_bus_dropped_frames{machine="lathe"}"#, 1.0),
        (r#"leadscrew_board_ticks{machine="lathe"}"#, 77.0),
        (r#"leadscrew_queue_free_bytes{machine="lathe"}"#, 2000.0),
        (
            r#"leadscrew_override_percent{machine="lathe",of="feed"}"#,
            80.0,
        ),
        (
            r#"leadscrew_spindle_speed_rpm{machine="lathe",of="measured"}"#,
            -600.0,
        ),
        (
            r#"leadscrew_threads_total{machine="lathe",kind="thread",end="finished"}"#,
            4.0,
        ),
        (
            r#"leadscrew_thread_largest_error_metres_bucket{le="0.000001",machine="lathe"}"#,
            3.0,
        ),
        (
            r#"leadscrew_thread_largest_error_metres_bucket{le="0.000002",machine="lathe"}"#,
            4.0,
        ),
        (
            r#"leadscrew_thread_largest_error_metres_sum{machine="lathe"}"#,
            3.6e-6,
        ),
        (
            r#"leadscrew_thread_cuts_total{machine="lathe",known="yes"}"#,
            2.0,
        ),
        (
            r#"leadscrew_thread_cuts_total{machine="lathe",known="no"}"#,
            1.0,
        ),
        (
            r#"leadscrew_thread_cut_error_metres_bucket{le="0.000005",machine="lathe"}"#,
            1.0,
        ),
        (
            r#"leadscrew_thread_cut_error_metres_count{machine="lathe"}"#,
            2.0,
        ),
        (
            r#"leadscrew_thread_cut_error_metres_sum{machine="lathe"}"#,
            43e-6,
        ),
        (
            r#"leadscrew_thread_cut_uncertainty_metres_sum{machine="lathe"}"#,
            1.2e-6,
        ),
        (
            r#"leadscrew_thread_cut_pass_to_pass_metres_sum{machine="lathe"}"#,
            2.4e-6,
        ),
        (
            r#"leadscrew_thread_rms_error_metres_bucket{le="2e-7",machine="lathe"}"#,
            0.0,
        ),
        (
            r#"leadscrew_thread_rms_error_metres_bucket{le="5e-7",machine="lathe"}"#,
            4.0,
        ),
        (
            r#"leadscrew_runs_total{machine="lathe",end="finished"}"#,
            1.0,
        ),
        (
            r#"leadscrew_missing_total{machine="lathe",of="threads"}"#,
            3.0,
        ),
    ] {
        let told = samples.get(sample).copied();
        // A sum of floats.
        let same = told.is_some_and(|told| (told - value).abs() < 1e-12);
        assert!(same, "{sample}: {told:?} in {samples:#?}");
    }
    let boards = samples
        .keys()
        .filter(|name| name.starts_with("leadscrew_board{"));
    assert_eq!(boards.count(), 1, "the parameters before are gone");
    take(&metrics, [presence(false)]);
    let samples = parse(&metrics.text());
    assert_eq!(samples[r#"leadscrew_board_up{machine="lathe"}"#], 0.0);
    assert!(!samples.contains_key(r#"leadscrew_machine_state{machine="lathe",state="alarm"}"#));
}

#[test]
fn machines_are_told_apart_and_one_that_goes_takes_nothing_of_another() {
    let metrics = Metrics::default();
    let take_of = |machine: &str, body| {
        let record = Record {
            at: Moment(0),
            machine: machine.to_owned(),
            body,
        };
        metrics.take(&[Numbered { number: 1, record }]);
    };
    metrics.expect("a");
    metrics.expect("never");
    for machine in ["a", "b\""] {
        take_of(machine, presence(true));
        take_of(machine, identity(1));
        take_of(machine, state("run"));
        take_of(machine, thread(100, Cut::NotRead));
    }
    take_of("a", presence(false));
    let samples = parse(&metrics.text());
    for (sample, value) in [
        (r#"leadscrew_board_up{machine="a"}"#, Some(0.0)),
        (r#"leadscrew_board_up{machine="b\""}"#, Some(1.0)),
        (r#"leadscrew_board_up{machine="never"}"#, Some(0.0)),
        (r#"leadscrew_machine_state{machine="a",state="run"}"#, None),
        (
            r#"leadscrew_machine_state{machine="b\"",state="run"}"#,
            Some(1.0),
        ),
        (
            r#"leadscrew_thread_largest_error_metres_count{machine="a"}"#,
            Some(1.0),
        ),
        (
            r#"leadscrew_thread_cuts_total{machine="a",known="not_read"}"#,
            Some(1.0),
        ),
    ] {
        assert_eq!(samples.get(sample).copied(), value, "{sample}");
    }
    let boards = samples
        .keys()
        .filter(|name| name.starts_with("leadscrew_board{"));
    assert_eq!(boards.count(), 2);
}

fn ask(server: &Server, request: &[u8]) -> String {
    let mut stream = TcpStream::connect(server.address).unwrap();
    stream.set_read_timeout(Some(LIMIT)).unwrap();
    stream.write_all(request).unwrap();
    let mut answer = String::new();
    // What was not read of a request that is refused may end it early.
    let _ = stream.read_to_string(&mut answer);
    answer
}

#[test]
fn figures_are_given_to_who_asks_for_them_and_refused_otherwise() {
    let metrics = Arc::new(Metrics::default());
    let listen = "127.0.0.1:0".parse().unwrap();
    let server = Server::start(listen, Arc::new(move || metrics.text())).unwrap();
    let answer = ask(&server, b"GET /metrics HTTP/1.1\r\nHost: x\r\n\r\n");
    let (head, body) = answer.split_once("\r\n\r\n").unwrap();
    assert!(head.starts_with("HTTP/1.1 200 OK\r\n"), "{head}");
    assert!(
        head.contains("application/openmetrics-text; version=1.0.0"),
        "{head}"
    );
    parse(body);
    for (request, status) in [
        (&b"GET / HTTP/1.1\r\n\r\n"[..], "404"),
        (b"POST /metrics HTTP/1.1\r\n\r\n", "400"),
        (b"\x16\x03\x01 hello\r\n\r\n", "400"),
    ] {
        let answer = ask(&server, request);
        assert!(
            answer.starts_with(&format!("HTTP/1.1 {status} ")),
            "{answer}"
        );
    }
    // One who says nothing is left, and the next is served.
    let silent = TcpStream::connect(server.address).unwrap();
    assert!(ask(&server, b"GET /metrics HTTP/1.1\r\n\r\n").starts_with("HTTP/1.1 200"));
    drop(silent);
}
