//! Failures on purpose, to test how the board handles them. Only an image with the feature `provoke` has them.

use core::hint::black_box;
use core::sync::atomic::{AtomicU32, Ordering};

/// The source line of the move that was started last.
static LINE: AtomicU32 = AtomicU32::new(0);

/// Notes the line of a move that was started.
pub fn line(line: u32) {
    LINE.store(line, Ordering::Relaxed);
}

/// A way to fail.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    Panic,
    /// A panic within the library: a division by zero.
    Divide,
    /// An instruction that does not exist.
    Fault,
    /// Calls without end.
    Stack,
    /// The tick does not end.
    Hang,
}

/// A failure at a tick.
#[derive(Clone, Copy, Debug)]
pub struct Provoke {
    way: Way,
    /// The ticks count from the first move of this line; `None`: from power-up.
    line: Option<u32>,
    /// Ticks until the failure.
    ticks: u32,
    /// The number of runs that fail, one after the other.
    pub times: u32,
}

impl Provoke {
    /// `panic@300`, `fault@300`, `hang@300`, `stack@300*3`; `panic@line5+300`.
    pub fn read(text: &str) -> Option<Self> {
        let (way, when) = text.split_once('@')?;
        let way = match way {
            "panic" => Way::Panic,
            "divide" => Way::Divide,
            "fault" => Way::Fault,
            "stack" => Way::Stack,
            "hang" => Way::Hang,
            _ => return None,
        };
        let (when, times) = when.split_once('*').unwrap_or((when, "1"));
        let (line, ticks) = match when.strip_prefix("line") {
            Some(rest) => {
                let (line, ticks) = rest.split_once('+')?;
                (Some(line.parse().ok()?), ticks)
            }
            None => (None, when),
        };
        Some(Self {
            way,
            line,
            ticks: ticks.parse().ok()?,
            times: times.parse().ok()?,
        })
    }

    /// Counts a tick, and fails at the last one.
    pub fn tick(&mut self) {
        if self
            .line
            .is_some_and(|line| line != LINE.load(Ordering::Relaxed))
        {
            return;
        }
        self.line = None;
        self.ticks = self.ticks.saturating_sub(1);
        if self.ticks > 0 {
            return;
        }
        match self.way {
            Way::Panic => panics(black_box(0)),
            Way::Divide => {
                black_box(divides(black_box(0)));
            }
            Way::Fault => cortex_m::asm::udf(),
            Way::Stack => {
                black_box(deeper(0));
            }
            Way::Hang => loop {
                core::hint::spin_loop();
            },
        }
    }
}

// Functions of their own: the compiler would merge several panics of one function, and their line would be lost.
#[inline(never)]
fn panics(number: u32) {
    assert!(number > 0, "as asked");
}

#[inline(never)]
fn divides(number: u32) -> u32 {
    1000 / number
}

#[inline(never)]
#[expect(unconditional_recursion, reason = "that is how a stack overflows")]
fn deeper(depth: u32) -> u32 {
    let room = black_box([depth; 64]);
    // The result is used, so that the compiler keeps every call on the stack.
    let below = deeper(depth.wrapping_add(1));
    below.wrapping_add(room[(depth % 64) as usize])
}
