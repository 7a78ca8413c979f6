//! Failures on purpose, to see what becomes of them: never in an image that is not told to have them.

use core::hint::black_box;

/// A way to fail.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    Panic,
    /// An instruction that does not exist.
    Fault,
    /// Calls without end.
    Stack,
}

/// A failure at a tick.
#[derive(Clone, Copy, Debug)]
pub struct Provoke {
    way: Way,
    tick: u32,
    /// How often, one run after the other.
    pub times: u32,
}

impl Provoke {
    /// `panic@300`, `fault@300`, `stack@300*3`.
    pub fn read(text: &str) -> Option<Self> {
        let (way, tick) = text.split_once('@')?;
        let way = match way {
            "panic" => Way::Panic,
            "fault" => Way::Fault,
            "stack" => Way::Stack,
            _ => return None,
        };
        let (tick, times) = tick.split_once('*').unwrap_or((tick, "1"));
        Some(Self {
            way,
            tick: tick.parse().ok()?,
            times: times.parse().ok()?,
        })
    }

    /// Fails at its tick.
    pub fn act(self, tick: u32) {
        if tick != self.tick {
            return;
        }
        match self.way {
            Way::Panic => panic!("as asked"),
            Way::Fault => cortex_m::asm::udf(),
            Way::Stack => {
                black_box(deeper(0));
            }
        }
    }
}

#[inline(never)]
#[expect(unconditional_recursion, reason = "that is how a stack overflows")]
fn deeper(depth: u32) -> u32 {
    let room = black_box([depth; 64]);
    // What comes back is needed, so that no call replaces another.
    let below = deeper(depth.wrapping_add(1));
    below.wrapping_add(room[(depth % 64) as usize])
}
