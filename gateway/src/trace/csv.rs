//! Setpoints as CSV, one row a tick.

use std::io::{self, Write};

use super::Setpoint;
use crate::number::{integer, signed};
use crate::place::SourceLine;

/// The contract's header, up to the further spindles and from there on.
const HEADER: (&[u8], &[u8]) = (
    b"tick,t_us,x_nm,z_nm,c_udeg,s1_urev,s1_set_urev",
    b",line,move,state,locked\n",
);
/// What each of the spindles 2 to 4 adds to it.
const TAPPERS: [&[u8]; 3] = [
    b",s2_urev,s2_set_urev",
    b",s3_urev,s3_set_urev",
    b",s4_urev,s4_set_urev",
];
/// Bytes collected before they are written.
const CHUNK: usize = 1 << 16;

/// A CSV file being written.
#[derive(Debug)]
pub struct Csv<W: Write> {
    to: W,
    buffer: Vec<u8>,
    tick_us: u64,
    tappers: [bool; 3],
}

impl<W: Write> Csv<W> {
    /// Starts with the header. `tick_us`: microseconds from row to row; `tappers`: which of the spindles 2 to 4 have
    /// columns.
    pub fn new(to: W, tick_us: u32, tappers: [bool; 3]) -> Self {
        let mut buffer = Vec::with_capacity(CHUNK + 256);
        buffer.extend_from_slice(HEADER.0);
        for (columns, used) in TAPPERS.into_iter().zip(tappers) {
            if used {
                buffer.extend_from_slice(columns);
            }
        }
        buffer.extend_from_slice(HEADER.1);
        Self {
            to,
            buffer,
            tick_us: u64::from(tick_us),
            tappers,
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
        for (spindle, used) in point.tappers.iter().zip(self.tappers) {
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
            b",1\n"
        } else {
            b",0\n"
        });
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
        let mut csv = Csv::new(Vec::new(), 1000, [false; 3]);
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
            tap: None,
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
    fn further_spindles_have_columns_where_the_program_uses_them() {
        let mut csv = Csv::new(Vec::new(), 1000, [true, false, true]);
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
