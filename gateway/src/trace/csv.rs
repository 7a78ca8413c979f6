//! Setpoints as CSV, one row a tick.

use std::io::{self, Write};

use super::Setpoint;
use crate::number::{integer, signed};
use crate::place::SourceLine;

/// The contract's header, up to the further spindles and from there on.
const HEADER: (&[u8], &[u8]) = (
    b"tick,t_us,x_nm,z_nm,c_udeg,s1_urev,s1_set_urev",
    b",line,move,state,locked",
);
/// What drives that are not ideal add at the end.
const ACTUAL: &[u8] = b",x_actual_nm,z_actual_nm";
/// What each of the spindles 2 to 4 adds to it.
const TAPPERS: [&[u8]; 3] = [
    b",s2_urev,s2_set_urev",
    b",s3_urev,s3_set_urev",
    b",s4_urev,s4_set_urev",
];
/// Bytes collected before they are written.
const CHUNK: usize = 1 << 16;

/// Columns that not every run has.
#[derive(Clone, Copy, Debug, Default)]
pub struct Columns {
    /// Which of the spindles 2 to 4.
    pub tappers: [bool; 3],
    /// Where the tool truly is at the instant of `s1_urev`, where a drive is not ideal.
    pub actual: bool,
}

/// A CSV file being written.
#[derive(Debug)]
pub struct Csv<W: Write> {
    to: W,
    buffer: Vec<u8>,
    tick_us: u64,
    columns: Columns,
}

impl<W: Write> Csv<W> {
    /// Starts with the header. `tick_us`: microseconds from row to row.
    pub fn new(to: W, tick_us: u32, columns: Columns) -> Self {
        let mut buffer = Vec::with_capacity(CHUNK + 256);
        buffer.extend_from_slice(HEADER.0);
        for (tapper, used) in TAPPERS.into_iter().zip(columns.tappers) {
            if used {
                buffer.extend_from_slice(tapper);
            }
        }
        buffer.extend_from_slice(HEADER.1);
        if columns.actual {
            buffer.extend_from_slice(ACTUAL);
        }
        buffer.push(b'\n');
        Self {
            to,
            buffer,
            tick_us: u64::from(tick_us),
            columns,
        }
    }

    /// Appends a row.
    pub fn push(&mut self, point: &Setpoint) -> io::Result<()> {
        let out = &mut self.buffer;
        integer(out, point.tick);
        out.push(b',');
        integer(out, point.tick.saturating_mul(self.tick_us));
        for value in [point.x_nm, point.z_nm, point.c_udeg, point.s1_urev] {
            out.push(b',');
            signed(out, value);
        }
        out.push(b',');
        if let Some(angle) = point.s1_set_urev {
            signed(out, angle);
        }
        for (spindle, used) in point.tappers.iter().zip(self.columns.tappers) {
            if !used {
                continue;
            }
            out.push(b',');
            signed(out, spindle.urev);
            out.push(b',');
            if let Some(angle) = spindle.set_urev {
                signed(out, angle);
            }
        }
        out.push(b',');
        let line = SourceLine(point.line);
        if let Some(file) = line.file() {
            out.extend_from_slice(file.as_bytes());
            out.push(b':');
        }
        integer(out, u64::from(line.in_file()));
        out.push(b',');
        integer(out, point.step);
        out.push(b',');
        out.extend_from_slice(point.state.name().as_bytes());
        out.extend_from_slice(if point.error_nm.is_some() {
            b",1"
        } else {
            b",0"
        });
        if self.columns.actual {
            for value in point.actual_nm.unwrap_or([point.x_nm, point.z_nm]) {
                out.push(b',');
                signed(out, value);
            }
        }
        out.push(b'\n');
        if out.len() >= CHUNK {
            self.to.write_all(out)?;
            out.clear();
        }
        Ok(())
    }

    /// Writes what is left.
    pub fn finish(mut self) -> io::Result<W> {
        self.to.write_all(&self.buffer)?;
        self.to.flush()?;
        Ok(self.to)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::SpindlePoint;
    use leadscrew_board_sim::Doing;

    #[test]
    fn rows_are_as_the_contract_says() {
        let mut csv = Csv::new(Vec::new(), 1000, Columns::default());
        csv.push(&Setpoint::default()).unwrap();
        csv.push(&Setpoint {
            tick: 7,
            x_nm: -1,
            z_nm: 2,
            c_udeg: 3,
            s1_urev: -1_000_001,
            s1_set_urev: Some(5),
            tappers: Default::default(),
            line: 6,
            step: 9,
            state: Doing::Run,
            error_nm: Some(-250),
            ..Setpoint::default()
        })
        .unwrap();
        let text = String::from_utf8(csv.finish().unwrap()).unwrap();
        assert_eq!(
            text,
            "tick,t_us,x_nm,z_nm,c_udeg,s1_urev,s1_set_urev,line,move,state,locked\n\
             0,0,0,0,0,0,,0,0,idle,0\n7,7000,-1,2,3,-1000001,5,6,9,run,1\n"
        );
    }

    #[test]
    fn drives_that_are_not_ideal_have_columns_at_the_end() {
        let columns = Columns {
            actual: true,
            ..Columns::default()
        };
        let mut csv = Csv::new(Vec::new(), 1000, columns);
        csv.push(&Setpoint {
            x_nm: 5,
            z_nm: 6,
            actual_nm: Some([-7, 8]),
            ..Setpoint::default()
        })
        .unwrap();
        let text = String::from_utf8(csv.finish().unwrap()).unwrap();
        assert_eq!(
            text,
            "tick,t_us,x_nm,z_nm,c_udeg,s1_urev,s1_set_urev,line,move,state,locked,x_actual_nm,z_actual_nm\n\
             0,0,5,6,0,0,,0,0,idle,0,-7,8\n"
        );
    }

    #[test]
    fn further_spindles_have_columns_where_the_program_uses_them() {
        let columns = Columns {
            tappers: [true, false, true],
            actual: false,
        };
        let mut csv = Csv::new(Vec::new(), 1000, columns);
        let spindle = |urev, set_urev| SpindlePoint { urev, set_urev };
        csv.push(&Setpoint {
            s1_urev: 1,
            tappers: [
                spindle(2, None),
                spindle(3, Some(33)),
                spindle(-4, Some(-44)),
            ],
            ..Setpoint::default()
        })
        .unwrap();
        let text = String::from_utf8(csv.finish().unwrap()).unwrap();
        assert_eq!(
            text,
            "tick,t_us,x_nm,z_nm,c_udeg,s1_urev,s1_set_urev,s2_urev,s2_set_urev,s4_urev,s4_set_urev,line,move,state,locked\n\
             0,0,0,0,0,1,,2,,-4,-44,0,0,idle,0\n"
        );
    }
}
