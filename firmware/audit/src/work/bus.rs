//! The bus side of an axis.

use leadscrew_core::bus::{
    DriveConfig, DriveMaster, DriveOutput, DriveStatus, FollowingLimit, Frame, Increments, Mode,
    NodeId, Periods, Scale, Statusword,
};

use super::Work;

/// An enabled drive: nanometres to increments, the drive's answer at every fourth tick, RPDO.
pub struct Commanding {
    scale: Scale,
    status: Frame,
}

impl Commanding {
    /// The work.
    pub fn x() -> Self {
        Self {
            scale: Scale::new(1, 100).expect("a ratio"),
            status: status(0x1237),
        }
    }
}

impl Work for Commanding {
    type State = DriveMaster;
    type Out = DriveOutput;

    fn steps(&self) -> usize {
        2000
    }

    fn begin(&self) -> DriveMaster {
        let mut master = DriveMaster::new(DriveConfig {
            letter: b'X',
            node: NodeId::DRIVE_X,
            scale: self.scale,
            step: Periods::new(500),
            silence: Periods::new(12),
            following: Some(FollowingLimit {
                increments: 10_000,
                time: Periods::new(10),
                standing: false,
            }),
            reach: 10_000,
            homes: None,
            mode: Mode::Position,
        });
        master.enable().expect("a new master has no failure");
        master.tick(None);
        for word in [0x0250, 0x0231, 0x0233, 0x1237] {
            master.receive(&status(word));
            master.tick(Some(Increments::new(0)));
        }
        assert!(master.is_enabled(), "it was answered as it should be");
        master
    }

    fn step(&self, master: &mut DriveMaster, number: usize) -> DriveOutput {
        if number.is_multiple_of(4) {
            master.receive(&self.status);
        }
        master.tick(self.scale.increments(number as i64 * 345))
    }
}

fn status(word: u16) -> Frame {
    DriveStatus {
        status: Statusword::from_raw(word),
        actual: Increments::new(0),
    }
    .frame(NodeId::DRIVE_X)
}
