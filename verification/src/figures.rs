//! Figures of the cycles of a program.

/// Figures of a cycle.
#[derive(Clone, Copy, Debug)]
pub struct CycleFigures {
    /// Source line.
    pub line: u32,
    /// Its name.
    pub cycle: &'static str,
    /// Passes of a thread, columns of a groove, holes of a tap.
    pub passes: u32,
    /// The highest speed of a tap on the way in, in hundredths of a turn per minute.
    pub tap_speed: Option<i64>,
    /// The least distance of R from the material for an ordinary tap, in nanometres.
    pub tap_lead_in_nm: Option<i64>,
    /// Figures of a thread.
    pub thread: Option<ThreadFigures>,
    /// Approximate time in microseconds.
    pub time_us: i64,
}

/// Figures of a thread.
#[derive(Clone, Copy, Debug)]
pub struct ThreadFigures {
    /// Largest shift of its starts along Z, nanometres.
    pub z_shift_max_nm: i64,
    /// Distance from B to the point where the lead is reached, in nanometres.
    pub lead_in_nm: i64,
    /// The least distance of the start from the material, in nanometres.
    pub start_before_nm: i64,
    /// How far beside its place the encoder may leave it, in nanometres; `None` where that is nothing.
    pub encoder_error_nm: Option<i64>,
    /// The highest speed of the spindle that the axes can follow.
    pub rpm_max: i64,
    /// Where the lead changes: turns of the stroke in millionths, and the lead at its end in nanometres.
    pub variable: Option<(i64, i64)>,
}
