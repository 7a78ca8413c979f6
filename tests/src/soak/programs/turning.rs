//! Turning: grooves, cuts, holes that a drill makes, and parts by their contour.

use core::fmt::Write as _;

use super::{Writer, mm};

impl Writer<'_> {
    /// G75.
    pub(super) fn groove(&mut self) {
        let (x, z) = (
            self.random.within(40_000, 70_000) / 2 * 2,
            self.random.within(-10_000, 2_000),
        );
        self.to((x, z));
        let depth = self.random.within(500, 3_000);
        let width = if self.random.chance(40) {
            0
        } else {
            self.random.within(200, 2_500) * self.random.sign()
        };
        // A diameter, in input increments of 0.1 µm.
        let peck = depth * 2 * 10 / self.random.within(1, 4);
        let step = width.abs() * 10 / self.random.within(1, 3);
        let feed = self.random.within(300, 2_000);
        let back = mm(self.random.within(100, 400));
        let bottom = mm(x - 2 * depth);
        self.line(&format!("G75 R{back}"));
        let wide = if width == 0 {
            String::new()
        } else {
            format!(" Z{} Q{step}", mm(z + width))
        };
        self.line(&format!("G75 X{bottom}{wide} P{peck} F{feed}"));
    }

    /// G74: rings in a face, or one hole.
    pub(super) fn face_groove(&mut self) {
        let (x, z) = (
            self.random.within(30_000, 60_000) / 2 * 2,
            self.random.within(-2_000, 5_000),
        );
        self.to((x, z));
        let back = mm(self.random.within(100, 400));
        self.line(&format!("G74 R{back}"));
        let depth = self.random.within(500, 3_000);
        // Input increments of 0.1 µm; P is a diameter.
        let peck = depth * 10 / self.random.within(1, 4);
        let mut words = format!("G74 Z{} Q{peck}", mm(z - depth));
        if self.random.chance(60) {
            let width = self.random.within(200, 2_500) * self.random.sign();
            let step = width.abs() * 2 * 10 / self.random.within(1, 3);
            let _ = write!(words, " X{} P{step}", mm(x + 2 * width));
        }
        let feed = self.random.within(300, 2_000);
        self.line(&format!("{words} F{feed}"));
    }

    /// G90 and G94: cut by cut, straight or on a cone.
    pub(super) fn cuts(&mut self) {
        let faces = self.random.chance(50);
        let from = (
            self.random.within(50_000, 70_000) / 2 * 2,
            self.random.within(2_000, 6_000),
        );
        self.to(from);
        let (long, deep) = (
            self.random.within(4_000, 15_000),
            self.random.within(500, 2_000),
        );
        let slope = if self.random.chance(40) {
            self.random.within(-long / 3, deep)
        } else {
            0
        };
        let feed = self.random.within(500, 5_000);
        for cut in 1..=self.random.within(1, 3) {
            let words = match (faces, cut) {
                (false, 1) => format!("G90 X{} Z{}", mm(from.0 - 2 * deep), mm(from.1 - long)),
                (true, 1) => format!("G94 X{} Z{}", mm(from.0 - 2 * long), mm(from.1 - deep)),
                (false, _) => format!("X{}", mm(from.0 - 2 * deep * cut)),
                (true, _) => format!("Z{}", mm(from.1 - deep * cut)),
            };
            if cut == 1 {
                self.line(&format!("{words} R{} F{feed}", mm(slope)));
            } else {
                self.line(&words);
            }
        }
        self.to(from);
    }

    /// G83 and G87: holes in the face and in the side.
    pub(super) fn drill(&mut self) {
        let side = self.random.chance(40);
        if self.random.chance(60) {
            let rpm = self.random.within(500, 2_000);
            self.line(&format!("M3 S{rpm}"));
        }
        let (x, z) = (
            self.random.within(50_000, 70_000) / 2 * 2,
            self.random.within(3_000, 8_000),
        );
        self.to((x, z));
        let level = self.random.within(0, 3_000);
        let depth = self.random.within(1_000, 8_000);
        let below = level + depth;
        let mut words = match side {
            false => format!("G83 Z{}", mm(z - below)),
            true => format!("G87 X{}", mm(x - 2 * below)),
        };
        if level > 0 {
            let _ = write!(words, " R-{}", mm(level));
        }
        if self.random.chance(60) {
            let _ = write!(words, " Q{}", mm(depth / self.random.within(1, 4)));
        }
        if self.random.chance(40) {
            let _ = write!(words, " P{}", self.random.within(1, 200));
        }
        let feed = self.random.within(300, 2_000);
        self.line(&format!("{words} F{feed}"));
        if self.random.chance(40) {
            if side {
                self.at.1 = z - 5_000;
                self.line(&format!("Z{}", mm(self.at.1)));
            } else {
                self.at.0 = x + 5_000;
                self.line(&format!("X{}", mm(self.at.0)));
            }
        }
        if self.random.chance(20) {
            let c = self.random.within(-180, 180);
            self.line(&format!("C{c}."));
        }
        self.line("G80");
    }

    /// G71, G72 and G73, and G70 behind them.
    pub(super) fn contour(&mut self) {
        let cycle = self.random.within(71, 73);
        let around = (
            self.random.within(60_000, 66_000) / 2 * 2,
            self.random.within(2_000, 4_000),
        );
        self.to(around);
        let deep = mm(self.random.within(2_000, 4_000));
        let back = mm(self.random.within(200, 800));
        let passes = self.random.within(1, 3);
        self.line(&match cycle {
            71 => format!("G71 U{deep} R{back}"),
            72 => format!("G72 W{deep} R{back}"),
            _ => format!("G73 U{deep} W{back} R{passes}"),
        });
        // Numbers of their own for each contour of a program.
        let begin = 10 * self.next_line();
        let end = begin + 5;
        let feed = self.random.within(1_000, 5_000);
        let left = self.random.of(&[" U0.4 W0.1", " U0.2", ""]);
        self.line(&format!("G{cycle} P{begin} Q{end}{left} F{feed}"));
        if cycle == 72 {
            self.disc(begin, end);
        } else {
            self.shaft(begin, end, cycle == 73);
        }
        if self.random.chance(60) {
            self.line(&format!("G70 P{begin} Q{end}"));
        }
        self.to(around);
    }

    /// A shape from the face along the part, ever larger. `both`: its first block moves Z too.
    fn shaft(&mut self, begin: u32, end: u32, both: bool) {
        let mut x = self.random.within(20_000, 30_000) / 2 * 2;
        let (mut z, face) = if both {
            (1_000, " Z1.")
        } else {
            (self.at.1, "")
        };
        self.line(&format!("N{begin} G0 X{}{face}", mm(x)));
        for number in 0..self.random.within(1, 4) {
            let step = self.random.within(500, 3_000);
            let feed = if number == 0 {
                format!(" F{}", self.random.within(1_000, 4_000))
            } else {
                String::new()
            };
            let code = self.random.of(&["G1", "G1", "G2", "G3"]);
            if code == "G1" {
                let long = self.random.within(1_000, 6_000);
                z -= long;
                self.line(&format!("G1 Z{}{feed}", mm(z)));
                x += 2 * step;
                z -= self.random.of(&[0, step, 2 * step]);
                self.line(&format!("X{} Z{}", mm(x), mm(z)));
            } else {
                // A quarter of a circle.
                (x, z) = (x + 2 * step, z - step);
                let (x, z, step) = (mm(x), mm(z), mm(step));
                self.line(&format!("{code} X{x} Z{z} R{step}{feed}"));
            }
        }
        self.line(&format!("N{end} G1 X{}", mm((x + 1_000).max(50_000))));
    }

    /// A shape from its deepest place towards the face, ever smaller.
    fn disc(&mut self, begin: u32, end: u32) {
        let mut x = self.random.within(46_000, 50_000) / 2 * 2;
        let mut z = -self.random.within(8_000, 15_000);
        self.line(&format!("N{begin} G0 Z{}", mm(z)));
        let feed = self.random.within(1_000, 4_000);
        self.line(&format!("G1 X{} F{feed}", mm(x)));
        for _ in 0..self.random.within(1, 3) {
            let step = self.random.within(500, 2_500);
            (x, z) = (x - 2 * step, z + self.random.of(&[0, step]));
            self.line(&format!("X{} Z{}", mm(x), mm(z)));
        }
        self.line(&format!("N{end} G1 Z1."));
    }
}
