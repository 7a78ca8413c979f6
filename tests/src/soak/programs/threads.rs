//! Threads: G76, G78, G92, strokes of G32 alone and in chains, and G34.

use core::fmt::Write as _;

use super::{Groove, Writer, mm};

impl Writer<'_> {
    /// Lead in micrometres and speed, as Z can go.
    fn lead_and_speed(&mut self) -> (i64, i64) {
        let rpm = self.random.within(300, 1500);
        let lead = self.random.within(300, (5_000_000 / rpm).min(4_000));
        (lead, rpm)
    }

    pub(super) fn thread(&mut self) {
        let (lead, rpm) = self.lead_and_speed();
        let first = self.next_line();
        let way = self.turn(rpm);
        let height = self.random.within(300, 1_200);
        let core = self.random.within(30_000, 60_000) / 2 * 2;
        let (start, length) = (
            self.random.within(4_000, 10_000),
            self.random.within(8_000, 20_000),
        );
        let towards = if self.random.chance(85) { -1 } else { 1 };
        let clear = self.random.within(500, 4_000);
        self.to((core + 2 * (height + clear), start));
        let run_out = self.random.of(&[0, 5, 10]);
        let angle = self.random.of(&[0, 0, 55, 60]);
        let depth = (height - 100).max(100) * 10 / self.random.within(1, 3);
        self.line(&format!(
            "G76 P01{run_out:02}{angle:02} Q{} R0.05",
            (depth / 4).min(height * 5)
        ));
        if angle == 0 {
            self.grooves.push(Groove {
                first,
                line: self.next_line(),
                on_x: false,
                start: start * 1000,
                lead: lead * 1000,
                sign: towards * way,
            });
        }
        self.line(&format!(
            "G76 X{} Z{} P{} Q{depth} F{}",
            mm(core),
            mm(start + towards * length),
            height * 10,
            mm(lead)
        ));
    }

    pub(super) fn enhanced_thread(&mut self) {
        let (lead, rpm) = self.lead_and_speed();
        self.turn(rpm);
        let height = self.random.within(300, 1_200);
        let core = self.random.within(30_000, 60_000) / 2 * 2;
        let (start, length) = (
            self.random.within(5_000, 12_000),
            self.random.within(8_000, 20_000),
        );
        let clear = self.random.within(1_000, 4_000);
        self.to((core + 2 * (height + clear), start));
        let mode = self.random.within(0, 4);
        let angle = self.random.of(&[0, 55, 60]);
        let starts = self.random.of(&[1, 1, 2]);
        let decreasing = self.random.within(0, 1);
        self.line(&format!(
            "G78 P01{mode:02}{angle:02} Q0.08 R0.05 L{starts} D{decreasing}"
        ));
        let first = (height - 100) / self.random.within(1, 2);
        let mut words = format!(
            "G78 X{} Z{} P{} Q{} F{}",
            mm(core),
            mm(start - length),
            mm(height),
            mm(first),
            mm(lead)
        );
        if self.random.chance(60) {
            let run_out = mm(self.random.within(500, 1_500));
            let _ = write!(words, " J{run_out} K{run_out}");
        }
        if self.random.chance(40) {
            let _ = write!(words, " E{}", mm(self.random.within(300, 900)));
        }
        self.line(&words);
    }

    /// J and K of a run-out that leads along `slope` more than the thread's own line, or J0.
    fn run_out(&mut self) -> String {
        if self.random.chance(50) {
            let size = mm(self.random.within(500, 1_500));
            format!(" J{size} K{size}")
        } else {
            " J0".into()
        }
    }

    /// A start angle in thousandths of a degree, mostly that of the index.
    fn start_angle(&mut self) -> i64 {
        if self.random.chance(30) {
            self.random.within(1, 359_999)
        } else {
            0
        }
    }

    /// G92: pass by pass, straight or on a cone, with one start or two.
    pub(super) fn single_passes(&mut self) {
        let (lead, rpm) = self.lead_and_speed();
        let first = self.next_line();
        let way = self.turn(rpm);
        let core = self.random.within(30_000, 60_000) / 2 * 2;
        let (start, length) = (
            self.random.within(4_000, 10_000),
            self.random.within(8_000, 20_000),
        );
        let towards = if self.random.chance(85) { -1 } else { 1 };
        let taper = if self.random.chance(40) {
            self.random.within(-length / 4, length / 4)
        } else {
            0
        };
        let clear = self.random.within(1_500, 4_000);
        self.to((core + 2 * (taper.abs() + clear), start));
        let run_out = self.run_out();
        let angle = self.start_angle();
        let starts = self.random.of(&[1, 1, 2]);
        let passes = self.random.within(1, 3);
        let ends = (1..=passes).rev().map(|left| core + 400 * left);
        for (number, x) in ends.enumerate() {
            if starts == 1 {
                self.grooves.push(Groove {
                    first,
                    line: self.next_line(),
                    on_x: false,
                    start: start * 1000 - turned(towards * lead * 1000, angle),
                    lead: lead * 1000,
                    sign: towards * way,
                });
            }
            let mut words = format!("X{}", mm(x));
            if number == 0 {
                words = format!("G92 {words} Z{}", mm(start + towards * length));
                let _ = write!(words, " R{} F{} L{starts}{run_out}", mm(taper), mm(lead));
            }
            if angle != 0 {
                let _ = write!(words, " Q{angle}");
            }
            self.line(&words);
        }
        self.to(self.at);
    }

    /// G32: along Z or across the face, straight or on a slope, alone or as a chain, whose lead may change.
    pub(super) fn strokes(&mut self) {
        let (lead, rpm) = self.lead_and_speed();
        let first = self.next_line();
        let way = self.turn(rpm);
        let on_x = self.random.chance(30);
        let (start, towards) = if on_x {
            let start = (
                self.random.within(70_000, 80_000) / 2 * 2,
                self.random.within(-500, 2_000),
            );
            (start, -1)
        } else {
            let start = (
                self.random.within(30_000, 60_000) / 2 * 2,
                self.random.within(5_000, 12_000),
            );
            (start, if self.random.chance(85) { -1 } else { 1 })
        };
        let run_out = self.run_out();
        let angle = self.start_angle();
        let strokes: Vec<_> = (0..self.random.of(&[1, 1, 2, 3]))
            .map(|number| self.stroke(number, lead, rpm))
            .collect();
        for pass in 0..self.random.within(1, 2) {
            // The next pass is deeper: smaller, or further into the face.
            let (mut x, mut z) = match on_x {
                true => (start.0, start.1 - 200 * pass),
                false => (start.0 - 400 * pass, start.1),
            };
            self.to((x, z));
            let mut turns = angle as f64 / 360_000.0;
            for (number, stroke) in strokes.iter().enumerate() {
                let (along, step) = match on_x {
                    true => (x * 500, (2 * towards * stroke.long, stroke.short)),
                    false => (z * 1000, (2 * stroke.short, towards * stroke.long)),
                };
                let per_turn = (towards * stroke.lead * 1000) as f64;
                self.grooves.push(Groove {
                    first,
                    line: self.next_line(),
                    on_x,
                    start: along - (per_turn * turns).round() as i64,
                    lead: stroke.lead * 1000,
                    sign: towards * way,
                });
                turns += stroke.long as f64 / stroke.lead as f64;
                (x, z) = (x + step.0, z + step.1);
                let mut words = format!("X{} Z{} F{}", mm(x), mm(z), mm(stroke.lead));
                if number == 0 {
                    words = format!("G32 {words}{run_out}");
                    if angle != 0 {
                        let _ = write!(words, " Q{angle}");
                    }
                }
                self.line(&words);
            }
            self.leave(on_x);
        }
        self.to((90_000, 8_000));
    }

    /// A stroke of a chain.
    fn stroke(&mut self, number: usize, lead: i64, rpm: i64) -> Stroke {
        // The first one has to get onto its lead.
        let shortest = if number == 0 { 8_000 } else { 4_000 };
        let long = self.random.within(shortest, shortest + 4_000);
        let short = if self.random.chance(50) {
            self.random.within(-long / 3, long / 3)
        } else {
            0
        };
        let other = number > 0 && self.random.chance(40);
        let lead = if other {
            let most = (5_000_000 / rpm).min(4_000);
            self.random.within((lead / 2).max(300), most)
        } else {
            lead
        };
        Stroke { long, short, lead }
    }

    /// G34: the lead grows or shrinks.
    pub(super) fn variable(&mut self) {
        let (lead, rpm) = self.lead_and_speed();
        self.turn(rpm);
        let at = (
            self.random.within(30_000, 60_000) / 2 * 2,
            self.random.within(5_000, 12_000),
        );
        let length = self.random.within(8_000, 20_000);
        let last = self.random.within(300, (5_000_000 / rpm).min(4_000));
        let change = match (last * last - lead * lead) / (2 * length) {
            0 => 1,
            change => change,
        };
        let angle = self.start_angle();
        for pass in 0..self.random.within(1, 2) {
            self.to((at.0 - 400 * pass, at.1));
            let (z, lead, change) = (mm(at.1 - length), mm(lead), mm(change));
            self.line(&format!("G34 Z{z} F{lead} K{change} Q{angle}"));
            self.leave(false);
        }
        self.to((90_000, 8_000));
    }

    /// Out of a thread that leaves the tool in it.
    fn leave(&mut self, on_x: bool) {
        self.line(if on_x { "G0 Z8." } else { "G0 X90." });
    }
}

/// A stroke of a chain in micrometres: along its lead and across, on the radius.
struct Stroke {
    long: i64,
    short: i64,
    lead: i64,
}

/// What the axis goes while the spindle turns by so many thousandths of a degree.
fn turned(lead: i64, mdeg: i64) -> i64 {
    (lead as f64 * mdeg as f64 / 360_000.0).round() as i64
}
