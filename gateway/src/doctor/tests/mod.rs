//! Each rule with a fault that is seeded into a sound wire, and with what is none.

mod guards;
mod scene;
mod seeds;

use super::Report;
use super::rules;
use crate::doctor::tests::scene::Scene;

fn numbers(report: &Report) -> Vec<u8> {
    report
        .findings
        .iter()
        .map(|found| found.rule.number)
        .collect()
}

#[test]
fn a_sound_wire_has_no_finding() {
    for scene in [Scene::new(), Scene::moving(|target, k| target(k - 1))] {
        let report = scene.report();
        let told: Vec<_> = report
            .findings
            .iter()
            .map(|one| &one.found.evidence.en)
            .collect();
        assert!(told.is_empty(), "{told:?}");
    }
}

#[test]
fn every_fault_that_is_seeded_is_named_first() {
    let (mut seeded, mut wrong) = (Vec::new(), Vec::new());
    for (number, scene) in seeds::all() {
        let told = numbers(&scene.report());
        if told.first() != Some(&number) {
            wrong.push((number, told));
        }
        seeded.push(number);
    }
    assert!(wrong.is_empty(), "seeded, and found: {wrong:?}");
    seeded.dedup();
    let mut all: Vec<u8> = rules::all().map(|rule| rule.number).collect();
    all.sort_unstable();
    assert_eq!(all, (1..=52).collect::<Vec<u8>>());
    assert_eq!(seeded, all, "each rule has its seed");
}

#[test]
fn what_is_no_fault_is_not_told() {
    let (mut guarded, mut wrong) = (Vec::new(), Vec::new());
    for (number, scene) in guards::all() {
        let told = numbers(&scene.report());
        if told.contains(&number) {
            wrong.push((number, told));
        }
        guarded.push(number);
    }
    assert!(wrong.is_empty(), "guarded, and found: {wrong:?}");
    guarded.dedup();
    assert_eq!(
        guarded,
        (1..=52).collect::<Vec<u8>>(),
        "each rule has its guard"
    );
}

#[test]
fn drives_are_asked_only_where_the_rest_is_sound() {
    let mut scene = Scene::new().word(|_| 0x1A37);
    scene.frame(2000, 0x080 + 16, &[0x20, 0x82, 0, 0, 0, 0, 0, 0]);
    let report = scene.report();
    assert_eq!(numbers(&report), [24]);
    let earlier = report
        .not_judged
        .iter()
        .filter(|(rule, _)| (33..=48).contains(&rule.number))
        .count();
    assert_eq!(earlier, 16);
    let mut scene = Scene::with_block().word(|_| 0x1A37);
    for n in 0..10 {
        scene.frame(1000 + n * 100, 0x200 + 70, &[1, 0]);
    }
    assert_eq!(numbers(&scene.report()), [49]);
}

#[test]
fn the_page_has_the_table_of_the_code() {
    let page = include_str!("../../../../docs/doctor.md");
    let table = super::page::table(leadscrew_core::alarm::Lang::En);
    assert!(
        page.contains(&table),
        "docs/doctor.md needs what `leadscrew doctor --rules` prints:\n{table}"
    );
}
