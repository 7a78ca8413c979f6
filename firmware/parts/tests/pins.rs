//! The pins of the NUCLEO-G474RE: what its image uses, and what the page about it says.

use std::path::{Path, PathBuf};

/// The sources of the image.
const IMAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../nucleo-g474re/src");
const PINS: &str = include_str!("../../nucleo-g474re/src/pins.rs");
const PAGE: &str = include_str!("../../../docs/hardware.md");

/// Pins with an owner of their own: debug probe and its serial line, crystal, boot pin.
const TAKEN: [&str; 8] = ["PA2", "PA3", "PA13", "PA14", "PB3", "PB8", "PF0", "PF1"];

/// The rows of a table of pins.
fn rows(text: &str) -> Vec<&str> {
    text.lines()
        .map(|line| line.trim_start_matches("//! ").trim())
        .filter(|line| line.starts_with("| P") && line.matches('|').count() == 5)
        .collect()
}

fn pin(row: &str) -> &str {
    row.trim_start_matches("| ")
        .split(' ')
        .next()
        .unwrap_or_default()
}

/// Every pin that is given a mode.
fn used(text: &str) -> Vec<String> {
    text.split(".moder().modify(")
        .zip(text.split(".moder().modify(").skip(1))
        .flat_map(|(before, behind)| {
            let port = before.chars().next_back().unwrap_or_default();
            let (modes, _) = behind.split_once("});").unwrap_or_default();
            modes.split("set_moder(").skip(1).map(move |rest| {
                let (number, _) = rest.split_once(',').unwrap_or_default();
                format!("P{port}{number}")
            })
        })
        .collect()
}

#[test]
fn the_page_and_the_image_have_one_table() {
    assert_eq!(rows(PINS), rows(PAGE));
    assert_eq!(rows(PINS).len(), 11);
}

#[test]
fn no_other_file_gives_a_pin_its_mode() {
    let mut files = Vec::new();
    let mut folders = vec![PathBuf::from(IMAGE)];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).expect("the sources of the image") {
            let path = entry.expect("the sources of the image").path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            let text = std::fs::read_to_string(&path).expect("a source");
            if text.contains(".moder()") {
                files.push(path);
            }
        }
    }
    assert_eq!(files, [Path::new(IMAGE).join("pins.rs")]);
}

#[test]
fn every_pin_has_one_use_and_no_other_owner() {
    let mut pins: Vec<&str> = rows(PINS).into_iter().map(pin).collect();
    pins.sort_unstable();
    let mut once = pins.clone();
    once.dedup();
    assert_eq!(pins, once);
    assert!(pins.iter().all(|pin| !TAKEN.contains(pin)), "{pins:?}");
    let mut used = used(PINS);
    used.sort_unstable();
    assert_eq!(used, pins);
}
