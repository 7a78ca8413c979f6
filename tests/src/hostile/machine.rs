//! A program of any text on the simulated machine, with an operator who presses anything at any time.

use leadscrew_board_sim::plant::PlantOptions;
use leadscrew_board_sim::{Doing, Sim};
use leadscrew_core::board::Command;
use leadscrew_core::params::Params;
use leadscrew_core::program::{Event, Events, Options};

/// The most ticks of a run.
const TICKS: usize = 4000;

/// The most calls of one program.
const CALLS: usize = 64;

/// Up to the first zero byte: pairs of a pause in ticks and a command. After it: program text.
///
/// # Panics
/// Where an axis moves farther in a tick than its rapid rate allows, or moves while the machine says that it is idle.
pub fn machine(data: &[u8]) {
    let Some(cut) = data.iter().position(|byte| *byte == 0) else {
        return;
    };
    let (presses, text) = (&data[..cut], &data[cut + 1..]);
    let params = Params::sheets();
    let calls: Vec<_> = Events::new(text, &params, Options::default())
        .map_while(Result::ok)
        .filter_map(|event| match event {
            Event::Call(call) => Some(call),
            Event::Warning(_) => None,
        })
        .take(CALLS)
        .collect();
    let Ok(mut sim) = Sim::new(&params, &PlantOptions::default()) else {
        panic!("the built-in machine starts");
    };
    let mut presses = presses.chunks_exact(2);
    let mut pause = 0;
    let mut calls = calls.into_iter().peekable();
    let mut last = None;
    for _ in 0..TICKS {
        if pause == 0
            && let Some([wait, key]) = presses.next()
        {
            pause = usize::from(*wait) * 4;
            sim.command(command(*key));
        }
        pause = pause.saturating_sub(1);
        while calls.peek().is_some_and(|call| sim.offer(call)) {
            calls.next();
        }
        let Some(row) = sim.step() else { continue };
        if let Some(last) = last.replace(row) {
            let x = (row.position.x - last.position.x).nm().abs();
            let z = (row.position.z - last.position.z).nm().abs();
            // 12 000 and 16 000 mm/min, with half a nanometre of rounding at either end.
            assert!(x <= 200_001, "X by {x} nm: {row:?}");
            assert!(z <= 266_668, "Z by {z} nm: {row:?}");
            let idle = last.doing == Doing::Idle && row.doing == Doing::Idle;
            assert!(!idle || x == 0 && z == 0, "moves when idle: {row:?}");
        }
        while sim.event().is_some() {}
        if calls.peek().is_none() && !sim.is_busy() && presses.len() == 0 {
            return;
        }
    }
}

fn command(key: u8) -> Command {
    let value = key >> 3;
    match key & 7 {
        0 => Command::Hold,
        1 | 2 => Command::Resume,
        3 => Command::Reset,
        4 => Command::SingleBlock(value & 1 == 1),
        5 => Command::FeedOverride(value.saturating_mul(5)),
        6 => Command::RapidOverride(value.saturating_mul(4)),
        _ if value == 31 => Command::Stop,
        _ => Command::SpindleOverride(value.saturating_add(90)),
    }
}
