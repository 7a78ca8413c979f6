//! The pins of the NUCLEO-G474RE: the image must use them as the hardware page says.

use std::path::{Path, PathBuf};

/// The sources of the image.
const IMAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../nucleo-g474re/src");
const PINS: &str = include_str!("../../nucleo-g474re/src/pins.rs");
const PAGE: &str = include_str!("../../../docs/hardware.md");

/// Pins that are not free: debug probe and its serial line, crystal, boot pin.
const TAKEN: [&str; 8] = ["PA2", "PA3", "PA13", "PA14", "PB3", "PB8", "PF0", "PF1"];

/// The alternate functions of the pins, by the data sheet's table: channels 1 to 3 of TIM2, and receive and transmit of
/// FDCAN1.
const CONNECTED: [(&str, &str); 7] = [
    ("PA0", "TIM2"),
    ("PA1", "TIM2"),
    ("PA11", "FDCAN"),
    ("PA12", "FDCAN"),
    ("PA8", "TIM1"),
    ("PA9", "TIM1"),
    ("PB10", "TIM2"),
];

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

/// The text with its loops over pins written out.
fn unrolled(text: &str) -> String {
    let mut lines = text.lines();
    let mut out = String::new();
    while let Some(line) = lines.next() {
        let range = line.trim().strip_prefix("for pin in ");
        let Some((first, last)) =
            range.and_then(|range| range.strip_suffix(" {")?.split_once(".."))
        else {
            out.push_str(line);
            out.push('\n');
            continue;
        };
        let body: Vec<&str> = lines
            .by_ref()
            .take_while(|line| line.trim() != "}")
            .collect();
        let number = |text: &str| text.parse::<u8>().expect("a number");
        for pin in number(first)..number(last) {
            for line in &body {
                out.push_str(&line.replace("(pin,", &format!("({pin},")));
                out.push('\n');
            }
        }
    }
    out
}

/// Every pin whose mode is set.
fn used(text: &str) -> Vec<String> {
    let text = &unrolled(text);
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

/// Every pin with which `setter` is called, and the value. A register for half a port says which half.
fn given(text: &str, setter: &str) -> Vec<(String, String)> {
    let (mut port, mut first) = (String::new(), 0);
    let mut given = Vec::new();
    for line in unrolled(text).lines() {
        if let Some((_, behind)) = line.split_once("GPIO") {
            port = behind.get(..1).unwrap_or_default().to_owned();
            first = if line.contains(".afr(1)") { 8 } else { 0 };
        }
        let Some((_, call)) = line.split_once(setter) else {
            continue;
        };
        let (pin, rest) = call.split_once(", ").expect("a pin");
        let pin: u8 = match pin.split_once(" - ") {
            Some((pin, minus)) => {
                assert_eq!(minus.parse(), Ok(first));
                pin.parse().expect("a number")
            }
            None => pin.parse::<u8>().expect("a number") + first,
        };
        let (value, _) = rest.split_once(')').expect("a value");
        given.push((format!("P{port}{pin}"), value.to_owned()));
    }
    given.sort_unstable();
    given
}

#[test]
fn pins_are_connected_as_the_data_sheet_has_it() {
    let expected = CONNECTED.map(|(pin, to)| (pin.to_owned(), to.to_owned()));
    assert_eq!(given(PINS, "set_afr("), expected);
    for number in [
        "const TIM1: u8 = 6;",
        "const TIM2: u8 = 1;",
        "const FDCAN: u8 = 9;",
    ] {
        assert!(PINS.contains(number), "{number}");
    }
}

#[test]
fn what_may_be_open_is_pulled_up_and_nothing_else() {
    let mut open: Vec<&str> = rows(PINS)
        .into_iter()
        .filter(|row| {
            ["pull-up", "closed", "from"]
                .iter()
                .any(|word| row.contains(&format!("| {word}")))
        })
        .map(pin)
        .collect();
    open.sort_unstable();
    let pulled = given(PINS, "set_pupdr(");
    assert!(pulled.iter().all(|(_, how)| how == "Pupdr::PULL_UP"));
    let pulled: Vec<&str> = pulled.iter().map(|(pin, _)| pin.as_str()).collect();
    assert_eq!(pulled, open);
}

#[test]
fn the_page_and_the_image_have_one_table() {
    assert_eq!(rows(PINS), rows(PAGE));
    assert_eq!(rows(PINS).len(), 26);
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
