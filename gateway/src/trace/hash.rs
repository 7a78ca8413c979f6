//! One number for a whole stream of setpoints.

use crc::{CRC_64_XZ, Crc, Digest, Table};
use leadscrew_board_sim::Doing;

use super::Setpoint;

static CRC: Crc<u64, Table<16>> = Crc::<u64, Table<16>>::new(&CRC_64_XZ);

/// CRC-64/XZ over the little-endian `x_nm, z_nm, c_udeg, s1_set_urev … s4_set_urev` of every tick from the first to the
/// last in state run.
pub struct SetpointHash {
    running: Option<Digest<'static, u64, Table<16>>>,
    /// Up to the last tick in state run: what follows counts only if another comes.
    settled: Digest<'static, u64, Table<16>>,
}

impl std::fmt::Debug for SetpointHash {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "SetpointHash({})", self.text())
    }
}

impl Default for SetpointHash {
    fn default() -> Self {
        Self {
            running: None,
            settled: CRC.digest(),
        }
    }
}

impl SetpointHash {
    /// Takes in the next tick.
    pub fn push(&mut self, point: &Setpoint) {
        let runs = point.state == Doing::Run;
        if self.running.is_none() && runs {
            self.running = Some(CRC.digest());
        }
        let Some(running) = &mut self.running else {
            return;
        };
        let mut bytes = [0; 56];
        let [s2, s3, s4] = point.tappers.map(|spindle| spindle.set_urev);
        let [s1, s2, s3, s4] = [point.s1_set_urev, s2, s3, s4].map(Option::unwrap_or_default);
        let values = [point.x_nm, point.z_nm, point.c_udeg, s1, s2, s3, s4];
        for (slot, value) in bytes.chunks_exact_mut(8).zip(values) {
            slot.copy_from_slice(&value.to_le_bytes());
        }
        running.update(&bytes);
        if runs {
            self.settled = running.clone();
        }
    }

    /// Sixteen hexadecimal digits.
    pub fn text(&self) -> String {
        format!("{:016x}", self.settled.clone().finalize())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::SpindlePoint;

    fn hash(states: &[(Doing, i64)]) -> String {
        let mut hash = SetpointHash::default();
        for &(state, x_nm) in states {
            hash.push(&Setpoint {
                x_nm,
                state,
                ..Setpoint::default()
            });
        }
        hash.text()
    }

    #[test]
    fn counts_from_the_first_to_the_last_run() {
        use Doing::{Dwell, Idle, Run};
        let bare = hash(&[(Run, 1), (Dwell, 1), (Run, 2)]);
        assert_eq!(
            bare,
            hash(&[
                (Idle, 0),
                (Run, 1),
                (Dwell, 1),
                (Run, 2),
                (Dwell, 2),
                (Idle, 2)
            ])
        );
        assert_ne!(bare, hash(&[(Run, 1), (Run, 2)]));
        assert_eq!(hash(&[]), "0000000000000000");
    }

    #[test]
    fn is_crc_64_xz_over_little_endian_fields() {
        let mut bytes = Vec::new();
        bytes.extend_from_slice(&(-5i64).to_le_bytes());
        bytes.resize(56, 0);
        assert_eq!(
            hash(&[(Doing::Run, -5)]),
            format!("{:016x}", CRC.checksum(&bytes))
        );
        let mut every = SetpointHash::default();
        let spindle = |set| SpindlePoint {
            urev: 99,
            set_urev: set,
        };
        every.push(&Setpoint {
            x_nm: 1,
            z_nm: 2,
            c_udeg: 3,
            s1_set_urev: Some(4),
            tappers: [spindle(Some(5)), spindle(None), spindle(Some(-7))],
            state: Doing::Run,
            ..Setpoint::default()
        });
        let fields = [1i64, 2, 3, 4, 5, 0, -7].map(i64::to_le_bytes).concat();
        assert_eq!(every.text(), format!("{:016x}", CRC.checksum(&fields)));
        // The catalogue's check value.
        assert_eq!(CRC.checksum(b"123456789"), 0x995d_c9bb_df19_39fa);
    }
}
