//! The hand at the machine: lines of words on a serial line of its own, of which the board knows nothing.
//!
//! | line | what the hand does |
//! |---|---|
//! | `door open`, `door close` | the door |
//! | `estop press`, `estop release` | the emergency stop |
//! | `hold press`, `hold release` | feed hold |
//! | `power cycle` | takes the power of board and drives, and gives it again |
//! | `speed 5000` | machine time in thousandths of real time, where the image runs in real time |
//!
//! Each line is answered: `ok`, or `no` where it is none of these. A start says `up`, which is the answer to the power that
//! goes and comes.

use heapless::spsc::Producer;
use heapless::{Deque, Vec};

use crate::around::Touch;
use crate::uart::Uart;

/// The longest line.
const LONGEST: usize = 32;
/// Room for answers; whoever asks waits for them.
const OUT: usize = 32;
/// What waits for the next tick.
pub const TOUCHES: usize = 8;

/// The serial line.
pub struct Hand {
    line: Vec<u8, LONGEST>,
    out: Deque<u8, OUT>,
    touches: Producer<'static, Touch>,
    /// When it was heard last.
    ms: u64,
}

impl Hand {
    /// A hand that begins to say so.
    pub fn new(touches: Producer<'static, Touch>) -> Self {
        Uart::HAND.start();
        let mut hand = Self {
            line: Vec::new(),
            out: Deque::new(),
            touches,
            ms: 0,
        };
        hand.say("up\n");
        hand
    }

    /// Reads a byte and sends one, once a millisecond: while a register is read, the emulator hears nothing on the other
    /// line. Gives the speed of time, where a line says so.
    pub fn pump(&mut self, ms: u64) -> Option<u32> {
        if core::mem::replace(&mut self.ms, ms) == ms {
            return None;
        }
        if Uart::HAND.has_room()
            && let Some(byte) = self.out.pop_front()
        {
            Uart::HAND.send(byte);
        }
        match Uart::HAND.receive()? {
            b'\n' => {
                let line = core::mem::take(&mut self.line);
                let heard = core::str::from_utf8(&line).ok().and_then(heard);
                let (answer, speed) = match heard {
                    Some(Heard::Speed(thousandths)) => ("ok\n", Some(thousandths)),
                    Some(Heard::Touch(touch)) => {
                        let answer = match touch {
                            Touch::Power => "",
                            _ => "ok\n",
                        };
                        // Whoever asks has waited for the answer to the line before.
                        let _ = self.touches.enqueue(touch);
                        (answer, None)
                    }
                    None => ("no\n", None),
                };
                self.say(answer);
                speed
            }
            byte => {
                // A line that is too long is none that is known.
                let _ = self.line.push(byte);
                None
            }
        }
    }

    fn say(&mut self, text: &str) {
        for byte in text.bytes() {
            let _ = self.out.push_back(byte);
        }
    }
}

enum Heard {
    Touch(Touch),
    Speed(u32),
}

fn heard(line: &str) -> Option<Heard> {
    let (what, how) = line.split_once(' ')?;
    Some(Heard::Touch(match (what, how) {
        ("door", "open") => Touch::Door(true),
        ("door", "close") => Touch::Door(false),
        ("estop", "press") => Touch::Stop(true),
        ("estop", "release") => Touch::Stop(false),
        ("hold", "press") => Touch::Hold(true),
        ("hold", "release") => Touch::Hold(false),
        ("power", "cycle") => Touch::Power,
        ("speed", thousandths) => {
            let thousandths = thousandths.parse().ok().filter(|speed| *speed > 0);
            return thousandths.map(Heard::Speed);
        }
        _ => return None,
    }))
}
