//! The pins of the NUCLEO-G474RE: what its image uses, and what the page about it says.

const PINS: &str = include_str!("../../nucleo-g474re/src/pins.rs");
const PAGE: &str = include_str!("../../../docs/hardware.md");
const SOURCES: [&str; 4] = [
    PINS,
    include_str!("../../nucleo-g474re/src/main.rs"),
    include_str!("../../nucleo-g474re/src/can.rs"),
    include_str!("../../nucleo-g474re/src/encoder.rs"),
];

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

/// Every `…PXn` behind a word and a dot or colons.
fn used(text: &str) -> Vec<String> {
    ["peripherals::P", "hardware.P"]
        .into_iter()
        .flat_map(|mark| text.split(mark).skip(1))
        .map(|rest| {
            let end = rest
                .find(|c: char| !c.is_ascii_alphanumeric())
                .unwrap_or(rest.len());
            format!("P{}", &rest[..end])
        })
        .filter(|name| name[2..].parse::<u8>().is_ok())
        .collect()
}

#[test]
fn the_page_and_the_image_have_one_table() {
    assert_eq!(rows(PINS), rows(PAGE));
    assert_eq!(rows(PINS).len(), 11);
}

#[test]
fn every_pin_has_one_use_and_no_other_owner() {
    let mut pins: Vec<&str> = rows(PINS).into_iter().map(pin).collect();
    pins.sort_unstable();
    let mut once = pins.clone();
    once.dedup();
    assert_eq!(pins, once);
    assert!(pins.iter().all(|pin| !TAKEN.contains(pin)), "{pins:?}");
    let mut used: Vec<String> = SOURCES.iter().flat_map(|text| used(text)).collect();
    used.sort_unstable();
    used.dedup();
    assert_eq!(used, pins);
}
