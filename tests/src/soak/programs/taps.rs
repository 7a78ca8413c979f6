//! Taps: in the face and in the side, rigid and ordinary.

use core::fmt::Write as _;

use super::{Writer, mm};

impl Writer<'_> {
    /// Lead in micrometres and speed of a tap.
    fn tap(&mut self) -> (i64, i64) {
        let rpm = self.random.within(300, 1500);
        (self.random.within(400, (3_500_000 / rpm).min(2_500)), rpm)
    }

    /// Goes in front of a hole in the face: lead and speed of its tap, and X and Z of where it stands.
    fn in_front(&mut self) -> ((i64, i64), (i64, i64)) {
        let tap = self.tap();
        let initial = self.random.within(3_000, 8_000);
        let x = self.random.within(20_000, 60_000) / 2 * 2;
        self.to((x, initial));
        (tap, (x, initial))
    }

    /// What a hole may have beside its depth.
    fn notes(&mut self, depth: i64) -> String {
        let mut words = String::new();
        if self.random.chance(50) {
            let infeed = depth / self.random.within(2, 4);
            let back = infeed * self.random.within(0, 100) / 100;
            let _ = write!(words, " Q{} D{}", mm(infeed), mm(back));
        }
        if self.random.chance(40) {
            let _ = write!(words, " P{}", self.random.within(1, 200));
        }
        words
    }

    fn rigid(&mut self, rpm: i64) {
        let hand = if self.random.chance(30) { "-" } else { "" };
        self.line(&format!("M29 S{hand}{rpm}"));
    }

    pub(super) fn face_tap(&mut self) {
        let ((lead, rpm), (x, initial)) = self.in_front();
        self.rigid(rpm);
        let level = self.random.within(1_000, 3_000);
        let depth = self.random.within(1_000, 8_000);
        let notes = self.notes(depth);
        let spindle = if self.random.chance(30) {
            format!(" E{}", self.random.within(1, 4))
        } else {
            String::new()
        };
        // Under G98 the feed is lead times speed: in whole micrometres a minute.
        self.line(&format!(
            "G84 Z{} R-{}{notes}{spindle} F{}",
            mm(initial - level - depth),
            mm(level),
            mm(lead * rpm)
        ));
        if self.random.chance(40) {
            self.at.0 = x + 10_000;
            self.line(&format!("X{}", mm(x + 10_000)));
        }
        if self.random.chance(20) {
            let c = self.random.within(-180, 180);
            self.line(&format!("C{c}."));
        }
        self.line("G80");
    }

    pub(super) fn side_tap(&mut self) {
        let (lead, rpm) = self.tap();
        let (x, z) = (
            self.random.within(50_000, 70_000) / 2 * 2,
            self.random.within(-20_000, 0),
        );
        self.to((x, z));
        self.rigid(rpm);
        let level = self.random.within(1_000, 3_000);
        let depth = self.random.within(1_000, 6_000);
        let notes = self.notes(depth);
        self.line(&format!(
            "G88 X{} R-{}{notes} F{}",
            mm(x - 2 * (level + depth)),
            mm(level),
            mm(lead * rpm)
        ));
        self.line("G80");
    }

    /// Stays at the bottom, and goes deeper.
    pub(super) fn deeper_tap(&mut self) {
        let ((lead, rpm), (_, initial)) = self.in_front();
        self.rigid(rpm);
        let level = self.random.within(1_000, 3_000);
        let depth = self.random.within(1_000, 5_000);
        let feed = mm(lead * rpm);
        self.line(&format!(
            "G84 Z{} R-{} F{feed} K198",
            mm(initial - level - depth),
            mm(level)
        ));
        let ms = self.random.within(10, 300);
        self.line(&format!("G4 P{ms}"));
        let further = self.random.within(500, 3_000);
        self.line(&format!(
            "G84 Z{} F{feed}",
            mm(initial - level - depth - further)
        ));
        self.line("G80");
    }

    pub(super) fn ordinary_tap(&mut self) {
        let ((lead, rpm), (_, initial)) = self.in_front();
        self.turn(rpm);
        let level = self.random.within(2_000, 5_000);
        let depth = self.random.within(3_000, 12_000);
        let notes = self.notes(depth);
        self.line(&format!(
            "G99 G84 Z{} R-{}{notes} F{}",
            mm(initial - level - depth),
            mm(level),
            mm(lead)
        ));
        self.line("G80 G98");
    }
}
