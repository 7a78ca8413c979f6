//! How fast a program is read: `parse [LINES | FILE] [ROUNDS]` prints bytes, lines, calls and a check sum.
//!
//! Without a file it makes a program of linear moves with a G76, a G78 and a G75 every hundred lines, as a CAM system
//! writes one. Under callgrind the difference of two runs that differ in ROUNDS alone is reading alone; with ROUNDS
//! above 1 the wall time is printed too.

#![allow(clippy::arithmetic_side_effects)]

use std::fmt::Write as _;
use std::hint::black_box;
use std::time::Instant;

use leadscrew_core::call::CallKind;
use leadscrew_core::params::Params;
use leadscrew_core::program::{Event, Events, Options};

fn main() {
    let mut args = std::env::args().skip(1);
    let source = args.next().unwrap_or_else(|| "100000".to_owned());
    let rounds: u32 = args.next().map_or(1, |text| {
        text.parse().unwrap_or_else(|_| usage("ROUNDS is a number"))
    });
    let text = match source.parse() {
        Ok(lines) => generate(lines),
        Err(_) => std::fs::read(&source).unwrap_or_else(|error| usage(&error.to_string())),
    };
    let lines = text.iter().filter(|byte| **byte == b'\n').count();
    let params = Params::sheets();
    let start = Instant::now();
    let (mut calls, mut sum) = (0_u64, 0_u64);
    for _ in 0..rounds {
        for event in Events::new(black_box(&text), &params, Options::default()) {
            match event {
                Ok(Event::Call(call)) => {
                    calls = calls.wrapping_add(1);
                    if let CallKind::Line(to, _) | CallKind::Rapid(to) = call.kind {
                        sum = sum.rotate_left(1)
                            ^ to.x.nm().cast_unsigned()
                            ^ to.z.nm().cast_unsigned();
                    }
                }
                Ok(Event::Warning(_)) => {}
                Err(alarm) => usage(&format!("{alarm:?}")),
            }
        }
    }
    let elapsed = start.elapsed();
    println!(
        "{} bytes, {lines} lines, {calls} calls, check sum {sum:016x}",
        text.len()
    );
    if rounds > 1 {
        let bytes = (text.len() as u128).saturating_mul(u128::from(rounds));
        let rate = bytes.saturating_mul(1000).checked_div(elapsed.as_nanos());
        println!("{} MB/s", rate.unwrap_or(0));
    }
}

fn usage(message: &str) -> ! {
    eprintln!("parse [LINES | FILE] [ROUNDS]: {message}");
    std::process::exit(2)
}

/// A program of about `lines` lines.
fn generate(lines: usize) -> Vec<u8> {
    let mut text = String::from("O1000 (GENERATED)\nG21 G98 G0 X80. Z10. S500 M3\n");
    let mut seed = 1_u64;
    let mut number = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        i64::from((seed >> 40) as u32 % 1_000_000)
    };
    let mut line = 2;
    while line < lines {
        let written = match line % 100 {
            0 => writeln!(text, "G0 X80 Z10"),
            1 => writeln!(text, "G76 P020560 Q1500 R0.1"),
            2 => writeln!(text, "G76 X60.64 Z-62 P36800 Q18000 F6"),
            3 => writeln!(text, "G78 P020245 Q0.15 R0.5"),
            4 => writeln!(text, "G78 X60 Z-60 P3 Q1.8 F3 J1.5 K2"),
            5 => writeln!(text, "G75 R0.5 F150"),
            6 => writeln!(text, "G75 X40 Z-50 P60000 Q30000"),
            _ => {
                let (x, z) = (number(), number());
                writeln!(
                    text,
                    "N{} G01 X{}.{:04} Z-{}.{:03} F{}",
                    line % 10_000,
                    x / 10_000,
                    x % 10_000,
                    z / 1_000,
                    z % 1_000,
                    100 + z % 900
                )
            }
        };
        written.unwrap_or_default();
        line += 1;
    }
    text.push_str("M30\n");
    text.into_bytes()
}
