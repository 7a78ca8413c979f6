//! What the page is told beside the state: threads pass by pass, inputs and outputs.

use serde_json::Value;

use super::{Page, THREAD, next, wait};
use crate::{LIMIT, User, good};

#[test]
fn a_thread_is_told_pass_by_pass_as_it_is_cut_with_the_figures_of_run() {
    let user = User::with_machine();
    // A thread takes a while on a slow computer too.
    good(&user.does(&["sim", "speed", "0.25"]));
    let page = Page::start(&user);
    let mut told = page.watch();
    wait(&mut told, "threads", |all| {
        all["threads"] == Value::Array(vec![])
    });
    let run = user.run(THREAD);
    let mut under_way = 0;
    let end = std::time::Instant::now() + LIMIT;
    let thread = loop {
        let all = next(&mut told, "threads").unwrap();
        let thread = &all["threads"][0];
        if thread["state"] == "finished" {
            break thread.clone();
        }
        under_way += thread["passes"].as_array().map_or(0, Vec::len);
        assert!(std::time::Instant::now() < end, "{all}");
    };
    // It was told before its end.
    assert!(under_way > 0);
    let output = run.wait_with_output().unwrap();
    let result: Value = serde_json::from_slice(&output.stdout).unwrap();
    let (of_run, cut) = (&result["threads"][0], &result["threads"][0]["cut"]);
    assert_eq!(thread["line"], of_run["line"].to_string());
    assert_eq!(thread["strokes"], of_run["passes"]);
    assert_eq!(thread["worst_um"], cut["worst_um"]);
    assert_eq!(thread["worst_um_u"], cut["worst_um_u"]);
    assert_eq!(thread["age_known"], cut["age_known"]);
    let passes = thread["passes"].as_array().unwrap();
    assert_eq!(passes.len() as u64, of_run["passes"].as_u64().unwrap());
    let ends = |key: &str, which: fn(f64, f64) -> f64| {
        let all = passes.iter().filter_map(|pass| pass[key].as_f64());
        all.reduce(which)
    };
    assert_eq!(ends("least", f64::min), cut["least_um"].as_f64());
    assert_eq!(ends("most", f64::max), cut["most_um"].as_f64());
    assert_eq!(thread["apart_um_u"], cut["apart_um_u"]);
    let words = thread["en"].as_str().unwrap();
    assert!(words.contains("worst "), "{words}");
    assert!(!thread["zh"].as_str().unwrap().is_empty());
}

#[test]
fn inputs_and_outputs_are_told_where_they_change() {
    let user = User::with_machine();
    let page = Page::start(&user);
    let mut told = page.watch();
    let is = |io: &Value, number: u64, on: bool| {
        let rows = io["inputs"].as_array().unwrap();
        rows.iter()
            .any(|row| row["number"] == number && row["on"] == on)
    };
    let io = wait(&mut told, "io", |_| true);
    assert_eq!(io["note"], Value::Array(vec![]));
    good(&user.does(&["sim", "input", "3", "on"]));
    let io = wait(&mut told, "io", |io| is(io, 3, true));
    let list = user.json(&["io", "list"]);
    assert_eq!(
        (&io["inputs"], &io["outputs"]),
        (&list["inputs"], &list["outputs"])
    );
    good(&user.does(&["sim", "input", "3", "off"]));
    wait(&mut told, "io", |io| !is(io, 3, true));
}
