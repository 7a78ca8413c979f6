//! Random programs: a seed gives the same text on a host and on the board.

use core::fmt::Write as _;

use heapless::String;

/// The longest program.
pub const LONGEST: usize = 2048;

/// The generator SplitMix64.
struct Random(u64);

impl Random {
    fn next_bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// A number from `low` to `high`, both included.
    fn within(&mut self, low: u64, high: u64) -> u64 {
        low + self.next_bits() % (high - low + 1)
    }
}

/// A program of a few blocks of every kind around a bar of 60 mm, and sometimes a hole in its face.
///
/// # Panics
/// Never: every program is shorter than [`LONGEST`].
#[must_use]
pub fn random(seed: u64) -> String<LONGEST> {
    let mut text = String::new();
    write(&mut text, &mut Random(seed)).expect("the longest program has room");
    text
}

fn write(text: &mut String<LONGEST>, random: &mut Random) -> core::fmt::Result {
    let (x, z) = (random.within(64, 80), random.within(2, 12));
    writeln!(
        text,
        "O{:04}\nM3 S{}\nG0 X{x} Z{z}",
        random.within(1, 9999),
        random.within(500, 1200)
    )?;
    for _ in 0..random.within(1, 3) {
        block(text, random)?;
    }
    if random.within(0, 3) == 0 {
        hole(text, random)?;
    }
    writeln!(
        text,
        "G0 X{} Z{}\nM30",
        random.within(64, 90),
        random.within(5, 15)
    )
}

fn block(text: &mut String<LONGEST>, random: &mut Random) -> core::fmt::Result {
    match random.within(0, 6) {
        0 => writeln!(
            text,
            "G0 X{}.{:03} Z{}",
            random.within(62, 90),
            random.within(0, 999),
            random.within(1, 15)
        ),
        1 => writeln!(
            text,
            "G98 G1 X{}.{:03} Z{}.{} C{} F{}",
            random.within(62, 80),
            random.within(0, 999),
            random.within(1, 15),
            random.within(0, 9),
            random.within(0, 90),
            random.within(1500, 5000)
        ),
        2 => writeln!(
            text,
            "G99 G1 X{}.{:03} Z{} F0.{:02}",
            random.within(62, 80),
            random.within(0, 999),
            random.within(1, 15),
            random.within(50, 99)
        ),
        3 => {
            // A quarter of a circle, outwards.
            let radius = random.within(1, 8);
            writeln!(
                text,
                "G0 X70 Z15\nG98 G{} X{} Z{} R{radius} F{}",
                random.within(2, 3),
                70 + 2 * radius,
                15 - radius,
                random.within(1000, 4000)
            )
        }
        4 => writeln!(
            text,
            "G0 X66 Z-5\nG98 G75 R0.5\nG75 X{} Z-{} P{}0000 Q30000 F{}\nG0 X66 Z10",
            random.within(58, 62),
            random.within(6, 9),
            random.within(2, 8),
            random.within(1000, 3000)
        ),
        5 => {
            let taper = ["0", "-0.5", "0.2"]
                .get(random.within(0, 2) as usize)
                .unwrap_or(&"0");
            writeln!(
                text,
                "G0 X70 Z{}\nG76 P0{}0{}60 Q{} R0.05\nG76 X{} Z-{} R{taper} P{} Q{} F{}",
                random.within(6, 12),
                random.within(1, 2),
                random.within(0, 9),
                random.within(1000, 2000),
                random.within(54, 58),
                random.within(2, 8),
                random.within(4000, 6000),
                random.within(3000, 5000),
                random.within(1, 2)
            )
        }
        _ => writeln!(text, "G4 P{}", random.within(1, 200)),
    }
}

/// A tap, rigid or ordinary, in one go or in pecks, right hand or left hand.
fn hole(text: &mut String<LONGEST>, random: &mut Random) -> core::fmt::Result {
    let speed = random.within(400, 1000);
    writeln!(text, "G98 G0 X0 Z{}", random.within(5, 8))?;
    if random.within(0, 3) > 0 {
        writeln!(text, "M29 S{speed}")?;
    } else {
        writeln!(text, "M3 S{speed}")?;
    }
    write!(
        text,
        "G84 Z-{} R-{}",
        random.within(6, 12),
        random.within(1, 3)
    )?;
    if random.within(0, 1) == 0 {
        write!(text, " Q{}.0", random.within(2, 5))?;
    }
    writeln!(
        text,
        " P{} F{}\nG80",
        random.within(0, 100),
        speed * random.within(1, 2)
    )
}
