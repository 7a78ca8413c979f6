//! Holes and programs of ordinary tapping.

/// One hole along Z, lengths in micrometres.
#[derive(Clone, Copy, Debug)]
pub struct Hole {
    /// Spindle speed, minus for M04.
    pub rpm: i32,
    /// Travel per turn.
    pub lead: i64,
    pub depth: i64,
    /// From the initial level to R.
    pub approach: i64,
    /// Q, 0 for none; and D.
    pub peck: (i64, i64),
    pub dwell: u32,
}

/// M8: 12 mm deep at 500 rpm, R 3 mm below the initial level.
pub fn plain() -> Hole {
    Hole {
        rpm: 500,
        lead: 1_250,
        depth: 12_000,
        approach: 3_000,
        peck: (0, 0),
        dwell: 0,
    }
}

/// Micrometres as a word.
pub fn mm(um: i64) -> String {
    let sign = if um < 0 { "-" } else { "" };
    format!("{sign}{}.{:03}", um.abs() / 1000, um.abs() % 1000)
}

impl Hole {
    pub fn pecked(self, infeed: i64, back: i64) -> Self {
        Self {
            peck: (infeed, back),
            ..self
        }
    }

    /// The block that taps it from Z`initial`.
    pub fn block(&self, initial: i64) -> String {
        let mut text = format!(
            "G99 G84 Z{} R-{} F{}",
            mm(initial - self.approach - self.depth),
            mm(self.approach),
            mm(self.lead)
        );
        if self.peck.0 > 0 {
            text += &format!(" Q{} D{}", mm(self.peck.0), mm(self.peck.1));
        }
        if self.dwell > 0 {
            text += &format!(" P{}", self.dwell);
        }
        text
    }

    /// The spindle on, the hole from Z0, the end.
    pub fn program(&self) -> String {
        let turn = if self.rpm < 0 { "M4" } else { "M3" };
        format!(
            "G18 {turn} S{}\n{}\nG80\nM30\n",
            self.rpm.abs(),
            self.block(0)
        )
    }

    /// R in nanometres.
    pub fn level(&self) -> i64 {
        -self.approach * 1000
    }

    pub fn total(&self) -> i64 {
        self.depth * 1000
    }
}
