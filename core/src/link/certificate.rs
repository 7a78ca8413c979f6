//! The certificates of a program's run and of each thread cut in it, made by the board itself: object 5041h.

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

use super::cut::CutTally;
use super::writer::{Put, Writer};
use super::{LinkError, VERSION, Version};
use crate::call::{Position, TapSpindle};
use crate::tick::ThreadKind;
use crate::units::{Length, Turns};

/// CRC-64/XZ by half bytes, with a table of 128 bytes. A table for whole bytes takes 2 KiB of a board's flash; a step
/// bit by bit takes four times as long.
#[derive(Clone, Copy)]
struct Crc64(u64);

impl Crc64 {
    /// The polynomial, its bits in reverse.
    const POLYNOMIAL: u64 = 0xC96C_5795_D787_0F42;

    /// The CRC of each value of four bits.
    const HALF_BYTES: [u64; 16] = {
        let mut table = [0; 16];
        let (mut places, mut number): (&mut [u64], u64) = (&mut table, 0);
        while let [place, rest @ ..] = places {
            let mut bits = number;
            let mut left = 4;
            while left > 0 {
                let carry = if bits & 1 == 0 { 0 } else { Self::POLYNOMIAL };
                bits = (bits >> 1) ^ carry;
                left = u8::saturating_sub(left, 1);
            }
            *place = bits;
            (places, number) = (rest, number.saturating_add(1));
        }
        table
    };

    const fn new() -> Self {
        Self(u64::MAX)
    }

    fn update(&mut self, bytes: &[u8]) {
        static TABLE: [u64; 16] = Crc64::HALF_BYTES;
        for &byte in bytes {
            self.0 ^= u64::from(byte);
            for _ in 0..2 {
                let carry = TABLE.get((self.0 & 15) as usize).copied();
                self.0 = (self.0 >> 4) ^ carry.unwrap_or(0);
            }
        }
    }

    const fn finalize(self) -> u64 {
        !self.0
    }
}

/// The certificate of a program's run, so far or to its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Certificate {
    /// The version of the board's link.
    pub version: Version,
    /// Number of the program.
    pub program: u32,
    /// Ticks from the first to the last in state run.
    pub ticks: u64,
    /// CRC-64/XZ over the setpoints of these ticks; `None` where the board could not include every tick.
    pub setpoint_hash: Option<u64>,
    /// Ticks in which the error of a synchronised axis was measured.
    pub measured: u64,
    /// The largest of these errors.
    pub largest: Length,
    /// Sum of their squares in nm².
    pub squares: u64,
    /// Setpoints that came late for their SYNC, since power-up.
    pub late: u32,
}

impl Certificate {
    /// The largest size of a certificate in bytes.
    pub const BYTES: usize = 72;

    /// Writes the certificate to the front of `bytes` and gives the number of bytes.
    ///
    /// # Errors
    /// [`LinkError::TooLong`]; never with [`Certificate::BYTES`] bytes of room.
    pub fn encode(&self, bytes: &mut [u8]) -> Result<usize, LinkError> {
        let mut writer = Writer::new(bytes);
        self.put(&mut writer);
        writer.finish()
    }

    /// Reads a certificate. For a certificate of another link version, gives only that version.
    ///
    /// # Errors
    /// [`LinkError::Malformed`].
    pub fn decode(bytes: &[u8]) -> Result<Result<Self, Version>, LinkError> {
        let (version, _) =
            postcard::take_from_bytes::<Version>(bytes).map_err(|_| LinkError::Malformed)?;
        if version != VERSION {
            return Ok(Err(version));
        }
        postcard::from_bytes(bytes)
            .map(Ok)
            .map_err(|_| LinkError::Malformed)
    }
}

/// The state of a thread.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
#[repr(u8)]
pub enum ThreadState {
    /// The thread is being cut.
    UnderWay,
    /// The whole thread was cut.
    Finished,
    /// An alarm, a stop or a reset came before its end.
    CutShort,
}

impl ThreadState {
    /// The name in results.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::UnderWay => "under_way",
            Self::Finished => "finished",
            Self::CutShort => "cut_short",
        }
    }
}

/// The synchronism errors during a cut.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Tally {
    /// Number of strokes begun along the helix of a thread, with the strokes of every start and repeated strokes, and
    /// of holes; 65 535 also stands for more.
    pub passes: u16,
    /// Setpoints that came late for their SYNC meanwhile; 65 535 also stands for more.
    pub late: u16,
    /// Ticks in which the error was measured; 4 294 967 295 also stands for more.
    pub measured: u32,
    /// The largest of these errors.
    pub largest: Length,
    /// Sum of their squares in nm².
    pub squares: u64,
}

impl Tally {
    /// A tally without a measurement.
    pub const NONE: Self = Self {
        passes: 0,
        late: 0,
        measured: 0,
        largest: Length::ZERO,
        squares: 0,
    };

    /// Adds a measured error.
    // Called for the run and for the thread, so it is not inlined twice.
    #[inline(never)]
    pub(crate) fn take(&mut self, error: Length) {
        // An error of more than four metres counts as four metres.
        let nm = u32::try_from(error.abs().nm()).unwrap_or(u32::MAX);
        let square = u64::from(nm).wrapping_mul(nm.into());
        self.measured = self.measured.saturating_add(1);
        self.largest = self.largest.max(Length::from_nm(nm.into()));
        self.squares = self.squares.saturating_add(square);
    }
}

/// The record of a thread or of a tapped hole.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct ThreadRecord {
    /// Source line.
    pub line: u32,
    /// The kind of synchronism.
    pub kind: ThreadKind,
    /// The state of the thread or hole.
    pub state: ThreadState,
    /// Its synchronism errors: those of the setpoint.
    pub tally: Tally,
    /// Those of the drive's own positions.
    pub cut: CutTally,
}

/// The certificate of a thread or a hole.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct ThreadCertificate {
    /// Counted from 1 since power-up; a gap means that older certificates were dropped.
    pub number: u32,
    /// The record.
    pub record: ThreadRecord,
}

impl ThreadCertificate {
    /// The largest size of a thread certificate in bytes.
    pub const BYTES: usize = 87;
}

/// Writes the certificate of a run and after it those of its threads to the front of `bytes`. Gives the number of
/// bytes. `newest` is the number of the first of the `records`; each following record has a number one less.
///
/// # Errors
/// [`LinkError::TooLong`]; never with [`Certificate::BYTES`] bytes of room and [`ThreadCertificate::BYTES`] for each
/// record.
pub fn encode_certificates(
    run: &Certificate,
    newest: u32,
    records: &[ThreadRecord],
    bytes: &mut [u8],
) -> Result<usize, LinkError> {
    let mut writer = Writer::new(bytes);
    run.put(&mut writer);
    let mut number = newest;
    for record in records {
        number.put(&mut writer);
        record.put(&mut writer);
        number = number.wrapping_sub(1);
    }
    writer.finish()
}

/// Iterates over the certificates of threads after that of a run, the newest first.
#[derive(Clone, Copy, Debug)]
pub struct ThreadReader<'a> {
    rest: &'a [u8],
}

impl<'a> ThreadReader<'a> {
    /// Reads `bytes` of object 5041h after the certificate of the run, which must have this [`VERSION`].
    ///
    /// # Errors
    /// [`LinkError::Malformed`].
    pub fn new(bytes: &'a [u8]) -> Result<Self, LinkError> {
        match postcard::take_from_bytes::<Certificate>(bytes) {
            Ok((_, rest)) => Ok(Self { rest }),
            Err(_) => Err(LinkError::Malformed),
        }
    }
}

impl Iterator for ThreadReader<'_> {
    type Item = Result<ThreadCertificate, LinkError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.rest.is_empty() {
            return None;
        }
        match postcard::take_from_bytes(self.rest) {
            Ok((thread, rest)) => {
                self.rest = rest;
                Some(Ok(thread))
            }
            Err(_) => {
                self.rest = &[];
                Some(Err(LinkError::Malformed))
            }
        }
    }
}

/// CRC-64/XZ over the little-endian X and Z in nm, C in µ°, and the commanded angles of spindles 1 to 4 in millionths of a
/// turn (0 where a spindle is not in position mode) of every tick from the first to the last in state run.
#[derive(Clone)]
pub struct SetpointHash {
    running: Option<Crc64>,
    seen: u64,
    /// The hash up to the last tick in state run. Later ticks count only if another tick in state run follows.
    settled: u64,
    ticks: u64,
}

impl core::fmt::Debug for SetpointHash {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "SetpointHash({:016x})", self.settled)
    }
}

impl Default for SetpointHash {
    fn default() -> Self {
        Self::new()
    }
}

impl SetpointHash {
    /// The hash before the first tick.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            running: None,
            seen: 0,
            settled: Crc64::new().finalize(),
            ticks: 0,
        }
    }

    /// Adds the next tick. `spindle`: the spindle in position mode and its angle; `runs`: the machine is in state run.
    pub fn push(&mut self, position: Position, spindle: Option<(TapSpindle, Turns)>, runs: bool) {
        if self.running.is_none() && runs {
            self.running = Some(Crc64::new());
        }
        let Some(running) = &mut self.running else {
            return;
        };
        for value in [position.x.nm(), position.z.nm(), position.c.udeg()] {
            running.update(&value.to_le_bytes());
        }
        for number in 1..=4 {
            let value = match spindle {
                Some((spindle, angle)) if spindle.number() == number => angle.micro(),
                _ => 0,
            };
            running.update(&value.to_le_bytes());
        }
        // The number of ticks never reaches 2⁶⁴.
        self.seen = self.seen.wrapping_add(1);
        if runs {
            self.settled = running.finalize();
            self.ticks = self.seen;
        }
    }

    /// The hash up to the last tick in state run.
    #[must_use]
    pub const fn value(&self) -> u64 {
        self.settled
    }

    /// Number of ticks in the hash.
    #[must_use]
    pub const fn ticks(&self) -> u64 {
        self.ticks
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::Angle;

    fn at(x: i64) -> Position {
        Position {
            x: Length::from_nm(x),
            z: Length::from_nm(2),
            c: Angle::from_udeg(3),
        }
    }

    /// A certificate with the longest encoding of every number.
    const LONGEST: Certificate = Certificate {
        version: VERSION,
        program: u32::MAX,
        ticks: u64::MAX,
        setpoint_hash: Some(u64::MAX),
        measured: u64::MAX,
        largest: Length::from_nm(i64::MIN),
        squares: u64::MAX,
        late: u32::MAX,
    };

    #[test]
    fn the_hash_is_that_of_the_bytes_from_first_to_last_run() {
        let mut hash = SetpointHash::new();
        assert_eq!((hash.value(), hash.ticks()), (0, 0));
        hash.push(at(9), None, false);
        let turns = Turns::from_raw(3 << 31);
        hash.push(at(1), Some((TapSpindle::Second, turns)), true);
        hash.push(at(1), None, false);
        hash.push(at(-1), None, true);
        hash.push(at(5), None, false);
        let crc = crc::Crc::<u64>::new(&crc::CRC_64_XZ);
        let mut expected = crc.digest();
        for row in [
            [1, 2, 3, 0, 1_500_000, 0, 0],
            [1, 2, 3, 0, 0, 0, 0],
            [-1, 2, 3, 0, 0, 0, 0_i64],
        ] {
            for value in row {
                expected.update(&value.to_le_bytes());
            }
        }
        assert_eq!((hash.value(), hash.ticks()), (expected.finalize(), 3));
    }

    #[test]
    fn a_certificate_comes_back_equal() {
        let mut bytes = [0; Certificate::BYTES];
        let used = LONGEST.encode(&mut bytes).unwrap();
        assert_eq!(Certificate::decode(&bytes[..used]), Ok(Ok(LONGEST)));
    }

    #[test]
    fn the_longest_certificates_have_the_room_that_is_said() {
        let record = ThreadRecord {
            line: u32::MAX,
            kind: ThreadKind::FloatingTap,
            state: ThreadState::CutShort,
            tally: Tally {
                passes: u16::MAX,
                late: u16::MAX,
                measured: u32::MAX,
                largest: Length::from_nm(i64::MIN),
                squares: u64::MAX,
            },
            cut: CutTally::of_parts(u16::MAX - (1 << 14), u32::MAX >> 1, i32::MIN),
        };
        let run = LONGEST;
        let mut bytes = [0; Certificate::BYTES + 2 * ThreadCertificate::BYTES];
        let records = [record, record];
        let used = encode_certificates(&run, u32::MAX, &records, &mut bytes).unwrap();
        let alone = run.encode(&mut [0; Certificate::BYTES]).unwrap();
        assert_eq!(used, alone + 2 * ThreadCertificate::BYTES);
        // A reader of the run's certificate alone ignores the bytes after it.
        assert_eq!(Certificate::decode(&bytes[..used]), Ok(Ok(run)));
        let mut read = ThreadReader::new(&bytes[..used]).unwrap();
        for number in [u32::MAX, u32::MAX - 1] {
            assert_eq!(read.next(), Some(Ok(ThreadCertificate { number, record })));
        }
        assert_eq!(read.next(), None);
        let mut read = ThreadReader::new(&bytes[..used - 1]).unwrap();
        assert!(read.next().unwrap().is_ok());
        assert_eq!(read.next(), Some(Err(LinkError::Malformed)));
        assert_eq!(read.next(), None);
    }

    #[test]
    fn a_tally_counts_both_signs_and_holds_at_the_end() {
        let mut tally = Tally::NONE;
        for nm in [3, -4, 0] {
            tally.take(Length::from_nm(nm));
        }
        let expected = Tally {
            measured: 3,
            largest: Length::from_nm(4),
            squares: 25,
            ..Tally::NONE
        };
        assert_eq!(tally, expected);
        tally.measured = u32::MAX;
        tally.take(Length::from_nm(i64::MIN));
        assert_eq!(
            (tally.measured, tally.squares),
            (u32::MAX, u64::from(u32::MAX).pow(2) + 25)
        );
        tally.take(Length::from_nm(i64::MAX));
        assert_eq!(tally.squares, u64::MAX);
        assert_eq!(tally.largest, Length::from_nm(u32::MAX.into()));
    }
}
