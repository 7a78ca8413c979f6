//! Orders, presses and the lease without sockets or a bus.

use std::sync::mpsc::{Receiver, Sender, channel};

use super::*;

/// What it was asked, and a gate that each order waits at.
struct Machinery {
    done: Mutex<Vec<String>>,
    gate: Mutex<Receiver<()>>,
}

impl Machine for Machinery {
    fn order(&self, order: &Order) -> Option<String> {
        if order.op == "unknown" {
            return None;
        }
        let mut done = self.done.lock().unwrap();
        done.push(format!("{} {} {:?}", order.op, order.args, order.echo));
        let count = done.len();
        drop(done);
        if order.op == "slow" {
            self.gate.lock().unwrap().recv().unwrap();
        }
        Some(format!("{count}"))
    }

    fn jog(&self, jog: &Jog) -> String {
        format!("{jog:?}")
    }

    fn view(&self, _: &std::path::Path, _: crate::View, _: bool) -> String {
        unreachable!("it is not asked for by posting")
    }

    fn sheet(&self, _: crate::Sheet, _: bool) -> String {
        unreachable!("it is not asked for by posting")
    }
}

struct Bench {
    posted: Posted,
    machine: Arc<Machinery>,
    gate: Sender<()>,
}

impl Bench {
    fn new() -> Self {
        let (send, gate) = channel();
        let machine = Arc::new(Machinery {
            done: Mutex::default(),
            gate: Mutex::new(gate),
        });
        Self {
            posted: Posted::new(Arc::clone(&machine) as _, Arc::default()),
            machine,
            gate: send,
        }
    }

    fn order(&self, client: &str, number: u64, op: &str) -> Result<Answer, Refusal> {
        let body = json!({"c": client, "n": number, "op": op, "args": 1, "echo": 7});
        self.posted.order("cookie", body.to_string().as_bytes())
    }

    fn lease(&self, client: &str, what: &str) -> String {
        let body = json!({"c": client, "do": what}).to_string();
        self.posted.lease("cookie", body.as_bytes()).unwrap().1
    }

    fn done(&self) -> Vec<String> {
        self.machine.done.lock().unwrap().clone()
    }
}

fn ok(text: &str) -> Result<Answer, Refusal> {
    Ok((OK, text.to_owned()))
}

#[test]
fn an_order_needs_the_lease_and_hold_and_stop_do_not() {
    let bench = Bench::new();
    let refusal = Ok(refused(Refusal::NotOperating));
    assert_eq!(bench.order("a", 1, "start"), refusal);
    assert_eq!(bench.order("a", 2, "hold"), ok("1"));
    assert_eq!(bench.order("b", 1, "stop"), ok("2"));
    assert_eq!(bench.lease("a", "take"), r#"{"yours":1}"#);
    // What was refused does not act after the lease.
    assert_eq!(bench.order("a", 1, "start"), refusal);
    assert_eq!(bench.order("a", 3, "start"), ok("3"));
    assert_eq!(bench.order("b", 2, "reset"), refusal);
    assert_eq!(bench.order("b", 2, "reset"), refusal);
    // The same page under another cookie is another page.
    let body = json!({"c": "a", "n": 9, "op": "start"}).to_string();
    assert_eq!(bench.posted.order("other", body.as_bytes()), refusal);
    let done = ["hold 1 Some(7)", "stop 1 Some(7)", "start 1 Some(7)"];
    assert_eq!(bench.done(), done);
}

#[test]
fn the_same_order_has_the_same_answer_and_acts_once_also_while_it_is_done() {
    let bench = Bench::new();
    bench.lease("a", "take");
    std::thread::scope(|scope| {
        let both = [0, 1].map(|_| scope.spawn(|| bench.order("a", 1, "slow")));
        bench.gate.send(()).unwrap();
        for one in both {
            assert_eq!(one.join().unwrap(), ok("1"));
        }
    });
    assert_eq!(bench.order("a", 1, "slow"), ok("1"));
    assert_eq!(bench.order("a", 1, "start"), ok("1"));
    assert_eq!(bench.order("a", 0, "start"), Err(Refusal::Older));
    let malformed = Ok(refused(Refusal::Malformed));
    assert_eq!(bench.order("a", 2, "unknown"), malformed);
    assert_eq!(bench.done().len(), 1);
}

#[test]
fn a_press_is_passed_on_frame_by_frame_for_who_operates() {
    let bench = Bench::new();
    let sent = |client: &str, axes: Value, spindle: Value, rapid: bool| {
        let body = json!({"c": client, "press": 3, "axes": axes, "spindle": spindle, "rapid": rapid, "speed": 0, "echo": 9});
        bench.posted.jog("cookie", body.to_string().as_bytes())
    };
    let jog = |client: &str, axes: Value| sent(client, axes, json!(0), true);
    let turn = |client: &str, axes: Value, spindle: Value| sent(client, axes, spindle, false);
    assert_eq!(jog("a", json!([0, 1])), Err(Refusal::NotOperating));
    bench.lease("a", "take");
    let frame = Jog {
        press: 3,
        axes: [0, -1],
        spindle: 0,
        rapid: true,
        speed: 0,
        echo: 9,
    };
    assert_eq!(jog("a", json!([0, -1])), ok(&format!("{frame:?}")));
    let turned = Jog {
        axes: [0, 0],
        spindle: 1,
        rapid: false,
        ..frame
    };
    assert_eq!(
        turn("a", json!([0, 0]), json!(1)),
        ok(&format!("{turned:?}"))
    );
    assert!(bench.lease("b", "take").contains("notice_ms"));
    assert_eq!(turn("a", json!([1, 0]), json!(1)), Err(Refusal::Malformed));
    // The board has no such frame, and would say nothing.
    let fast = sent("a", json!([0, 0]), json!(1), true);
    assert_eq!(fast, Err(Refusal::Malformed));
    for wrong in [json!(2), json!("S+"), Value::Null] {
        assert_eq!(turn("a", json!([0, 0]), wrong), Err(Refusal::Malformed));
    }
    for wrong in [json!([0]), json!([2, 0]), json!("X+"), Value::Null] {
        assert_eq!(jog("a", wrong), Err(Refusal::Malformed));
    }
    assert_eq!(jog("b", json!([0, 0])), Err(Refusal::NotOperating));
}

#[test]
fn a_spindle_that_is_held_keeps_the_lease_as_an_axis_does() {
    for (axes, spindle, keeps) in [
        (json!([0, 0]), 0, false),
        (json!([0, 1]), 0, true),
        (json!([0, 0]), -1, true),
    ] {
        let bench = Bench::new();
        bench.lease("a", "take");
        let now = Instant::now();
        let body = json!({"c": "a", "press": 3, "axes": axes, "spindle": spindle, "rapid": false, "speed": 0, "echo": 9});
        let passed = bench.posted.jog("cookie", body.to_string().as_bytes());
        assert!(passed.is_ok());
        // Another has asked for so long that only a press keeps it from the lease.
        let lease = &mut bench.posted.state().lease;
        lease.ask("cookie/b", Wish::Take, now - lease::NOTICE);
        let answer = lease.ask("cookie/b", Wish::Take, now);
        assert_eq!(
            answer == lease::Answer::Notice(Duration::ZERO),
            keeps,
            "{answer:?}"
        );
    }
}

#[test]
fn what_is_no_order_is_refused() {
    let bench = Bench::new();
    let long = "x".repeat(NAME + 1);
    for body in [
        json!({}),
        json!({"c": "a", "n": -1, "op": "hold"}),
        json!({"c": "a", "n": 1.5, "op": "hold"}),
        json!({"c": "a", "n": 1}),
        json!({"c": 1, "n": 1, "op": "hold"}),
        json!({"c": "", "n": 1, "op": "hold"}),
        json!({"c": long, "n": 1, "op": "hold"}),
        json!([]),
    ] {
        let body = body.to_string();
        let answer = bench.posted.order("cookie", body.as_bytes());
        assert_eq!(answer, Err(Refusal::Malformed), "{body}");
        let answer = bench.posted.lease("cookie", body.as_bytes());
        assert_eq!(answer, Err(Refusal::Malformed), "{body}");
    }
    assert!(bench.done().is_empty());
    assert!(halts(br#"{"op":"hold"}"#) && halts(br#"{"op":"stop"}"#));
    assert!(!halts(br#"{"op":"start"}"#) && !halts(b"") && !halts(b"[]"));
}
