//! Tables over sockets: who reads them, and how long an order that changes one may be.

use leadscrew_panel::Refusal;

use super::{Bench, LOOK, refused};

const TAKE: &str = "{\"c\":\"a\",\"do\":\"take\"}";

/// An order that is so long.
fn long(number: u32, bytes: usize) -> String {
    let head = format!("{{\"c\":\"a\",\"n\":{number},\"op\":\"tools\",\"args\":\"");
    let fill = "x".repeat(bytes - head.len() - 2);
    format!("{head}{fill}\"}}")
}

#[test]
fn a_table_is_read_by_who_looks_and_by_nobody_else() {
    let bench = Bench::new();
    let (operates, looks) = (bench.login(), bench.login_with(LOOK));
    for (path, name) in [("/tools", "Tools"), ("/params", "Params")] {
        refused(&bench.get(path, &[]), Refusal::Login);
        refused(&bench.post(path, "{}"), Refusal::Login);
        refused(&bench.post_as(&operates, path, "{}"), Refusal::Method);
        let foreign = "Origin: http://evil.example";
        refused(&bench.get(path, &[&looks, foreign]), Refusal::Origin);
        for cookie in [&operates, &looks] {
            for (language, zh) in [("en", false), ("zh", true)] {
                let answer = bench.get(path, &[cookie, &format!("Accept-Language: {language}")]);
                assert!(answer.starts_with("HTTP/1.1 200 OK\r\n"), "{answer}");
                let told = format!("{{\"sheet\":\"{name}\",\"zh\":{zh}}}");
                assert!(answer.ends_with(&told), "{answer}");
            }
        }
        refused(
            &bench.get(&format!("{path}/T1"), &[&looks]),
            Refusal::NotFound,
        );
    }
    assert!(bench.machine.0.lock().unwrap().is_empty());
}

#[test]
fn a_table_is_changed_by_the_page_that_operates_and_once() {
    let bench = Bench::new();
    let (operates, looks) = (bench.login(), bench.login_with(LOOK));
    let order =
        |n: u32, op: &str| format!("{{\"c\":\"a\",\"n\":{n},\"op\":\"{op}\",\"args\":{{}}}}");
    refused(&bench.post("/order", &order(1, "tools")), Refusal::Login);
    refused(
        &bench.post_as(&looks, "/order", &order(1, "tools")),
        Refusal::Looks,
    );
    refused(
        &bench.post_as(&operates, "/order", &order(1, "tools")),
        Refusal::NotOperating,
    );
    bench.post_as(&operates, "/lease", TAKE);
    // The number is used up: it does nothing after the lease either.
    refused(
        &bench.post_as(&operates, "/order", &order(1, "tools")),
        Refusal::NotOperating,
    );
    for _ in 0..2 {
        let answer = bench.post_as(&operates, "/order", &order(2, "params"));
        assert!(answer.ends_with("{\"ok\":true}"), "{answer}");
    }
    assert_eq!(*bench.machine.0.lock().unwrap(), ["params"]);
}

#[test]
fn an_order_is_as_long_as_a_table_and_only_of_who_may_give_it() {
    let bench = Bench::new();
    let (operates, looks) = (bench.login(), bench.login_with(LOOK));
    bench.post_as(&operates, "/lease", TAKE);
    let answer = bench.post_as(&operates, "/order", &long(1, 32 << 10));
    assert!(answer.ends_with("{\"ok\":true}"), "{answer}");
    refused(
        &bench.post_as(&operates, "/order", &long(2, (32 << 10) + 1)),
        Refusal::TooLong,
    );
    refused(
        &bench.post_as(&looks, "/order", &long(3, (4 << 10) + 1)),
        Refusal::TooLong,
    );
    refused(
        &bench.post("/order", &long(4, (4 << 10) + 1)),
        Refusal::TooLong,
    );
    // Nothing else has become longer, and depth is no way around it.
    refused(
        &bench.post_as(&operates, "/jog", &long(5, (4 << 10) + 1)),
        Refusal::TooLong,
    );
    let deep = "[".repeat(30 << 10);
    refused(
        &bench.post_as(&operates, "/order", &deep),
        Refusal::Malformed,
    );
    assert_eq!(*bench.machine.0.lock().unwrap(), ["tools"]);
}
