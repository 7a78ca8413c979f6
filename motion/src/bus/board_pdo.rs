//! The process data of the board itself, byte by byte: the commands of the operator, and the board's periodic status.
//!
//! | PDO | bytes | object | content |
//! |---|---|---|---|
//! | RPDO1 | 0 | 5000h:01 | count: a new value for every new order |
//! | | 1 | 5000h:02 | order: 0 none, 1 run, 2 hold, 3 resume, 4 reset, 5 stop, 6 cancel, 16–21 mode, 32–39 reference |
//! | | 2 | 5000h:03 | switches: bit 0 single block, bit 1 dry run; bits 4 and 5: change that switch |
//! | | 3 | 5000h:04 | feed override in percent; 255: no change |
//! | | 4 | 5000h:05 | rapid override in percent; 255: no change |
//! | | 5 | 5000h:06 | spindle override in percent; 255: no change |
//! | | 6–7 | 5000h:07 | echo: the newest beat that the sender has heard; run, resume, mode and reference need one (9047) |
//! | TPDO1 | 0 | 5001h:02 | state, see [`BoardState`] |
//! | | 1 | 5001h:03 | flags, see [`BoardFlags`] |
//! | | 2–3 | 5001h:04 | number of the alarm; 0: none |
//! | | 4 | 5001h:05 | count of the last order that was taken |
//! | | 5 | 5001h:06 | setpoints that were late for their SYNC; 255: that many or more |
//! | | 6–7 | 5001h:07 | program credit |
//! | TPDO2 | 0–3 | 5001h:08 | source line of the current move; 0: none |
//! | | 4–7 | 5001h:09 | number of the current move; 0: none |
//! | TPDO3 | 0–1 | 5001h:0A | spindle angle in 1/65536 turn |
//! | | 2–5 | 5001h:0B | spindle speed in 0.001 rpm, positive M03 |
//! | | 6–7 | 5001h:0C | synchronism error in 10 nm; −32768: nothing is synchronised |
//!
//! What moves by hand is in [`manual`].
//!
//! All values are little-endian. **A frame that is lost or comes twice does no harm** [D96]. Overrides and switches are
//! levels: a repetition changes nothing. An order needs a count: the board takes the order once and sends its count in
//! TPDO1. The sender repeats the frame until TPDO1 has that count. Two senders may use the same count. The board still
//! takes both orders if they differ; two equal orders are no conflict.

mod manual;
mod order;

pub use self::manual::{BoardBeat, JogRequest, StepRequest, WheelRequest};
pub use self::order::{Beat, Order, OrderGate};

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

use super::frame::{CobId, Frame, NodeId, Service};
use super::mapping::Mapped;
use super::pdo::MilliRpm;
use crate::units::{Length, Turns};

/// RPDO1 of the board. `None` means no change.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BoardCommand {
    /// Distinguishes an order from the last one.
    pub count: u8,
    /// The order, which the board does once.
    pub order: Option<Order>,
    /// Single block on or off.
    pub single_block: Option<bool>,
    /// Dry run on or off.
    pub dry_run: Option<bool>,
    /// Feed override in percent, up to 254.
    pub feed: Option<u8>,
    /// Rapid override in percent, up to 254.
    pub rapid: Option<u8>,
    /// Spindle override in percent, up to 254.
    pub spindle: Option<u8>,
    /// The newest beat that the sender has heard.
    pub echo: Option<Beat>,
}

impl BoardCommand {
    /// The objects in its bytes.
    pub const MAPPING: [Mapped; 7] = [
        Mapped::new(0x5000, 1, 8),
        Mapped::new(0x5000, 2, 8),
        Mapped::new(0x5000, 3, 8),
        Mapped::new(0x5000, 4, 8),
        Mapped::new(0x5000, 5, 8),
        Mapped::new(0x5000, 6, 8),
        Mapped::new(0x5000, 7, 16),
    ];
    const AS_IT_IS: u8 = 255;

    /// A command with `order`; its count is the next after `last`.
    #[must_use]
    pub fn order(order: Order, last: u8) -> Self {
        Self {
            count: last.wrapping_add(1),
            order: Some(order),
            ..Self::default()
        }
    }

    /// The frame to the board `node`.
    #[must_use]
    pub const fn frame(self, node: NodeId) -> Frame {
        const fn switch(wanted: Option<bool>, bit: u8) -> u8 {
            match wanted {
                Some(on) => 0x10 << bit | (on as u8) << bit,
                None => 0,
            }
        }
        const fn percent(wanted: Option<u8>) -> u8 {
            match wanted {
                Some(percent) => percent,
                None => BoardCommand::AS_IT_IS,
            }
        }
        let order = match self.order {
            Some(order) => order.raw(),
            None => 0,
        };
        let switches = switch(self.single_block, 0) | switch(self.dry_run, 1);
        let (feed, rapid) = (percent(self.feed), percent(self.rapid));
        let (id, spindle) = (CobId::of(Service::Rpdo1, node), percent(self.spindle));
        match self.echo {
            None => Frame::of(id, [self.count, order, switches, feed, rapid, spindle]),
            Some(echo) => {
                let [low, high] = echo.ms().to_le_bytes();
                Frame::of(
                    id,
                    [self.count, order, switches, feed, rapid, spindle, low, high],
                )
            }
        }
    }

    /// A frame that is known to carry a command.
    pub fn raw(frame: &Frame) -> Option<RawCommand<'_>> {
        let (&[count, order], settings) = frame.payload().split_first_chunk::<2>()?;
        let order = match order {
            0 => None,
            _ => Some(Order::from_raw(order)?),
        };
        let (settings, behind) = settings.split_first_chunk::<4>()?;
        let echo = behind.first_chunk::<2>();
        Some(RawCommand {
            count,
            order,
            settings,
            echo: echo.map(|bytes| Beat::new(u16::from_le_bytes(*bytes))),
        })
    }

    /// The board and its command, if `frame` is a board command. A frame of six bytes has no echo. A frame with an unknown
    /// order is no command.
    #[must_use]
    pub fn decode(frame: &Frame) -> Option<(NodeId, Self)> {
        let (Service::Rpdo1, node) = frame.id().service()? else {
            return None;
        };
        let RawCommand {
            count,
            order,
            settings: &[switches, feed, rapid, spindle],
            echo,
        } = Self::raw(frame)?;
        let switch = |bit: u8| (switches >> bit & 0x10 != 0).then_some(switches >> bit & 1 != 0);
        let percent = |percent| (percent != Self::AS_IT_IS).then_some(percent);
        Some((
            node,
            Self {
                count,
                order,
                single_block: switch(0),
                dry_run: switch(1),
                feed: percent(feed),
                rapid: percent(rapid),
                spindle: percent(spindle),
                echo,
            },
        ))
    }
}

/// RPDO1 as it came.
pub struct RawCommand<'f> {
    pub count: u8,
    pub order: Option<Order>,
    /// 5000h:03 to 06.
    pub settings: &'f [u8; 4],
    /// 5000h:07, in a frame of eight bytes.
    pub echo: Option<Beat>,
}

/// State of the machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, Schema)]
#[repr(u8)]
pub enum BoardState {
    /// The drives are being enabled.
    #[default]
    Starting = 0,
    /// The machine does nothing.
    Idle = 1,
    /// Moving, or changing from one move to the next.
    Run = 2,
    /// In feed hold or single block.
    Hold = 3,
    /// In a dwell.
    Dwell = 4,
    /// Waiting for the spindle, or for the next segment.
    Wait = 5,
    /// Coming to rest after a reset.
    Stopping = 6,
    /// Stopping or stopped because of an alarm.
    Alarm = 7,
}

impl BoardState {
    /// All states; each at the index of its number.
    pub const ALL: [Self; 8] = [
        Self::Starting,
        Self::Idle,
        Self::Run,
        Self::Hold,
        Self::Dwell,
        Self::Wait,
        Self::Stopping,
        Self::Alarm,
    ];

    /// The English name of the state.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Starting => "starting",
            Self::Idle => "idle",
            Self::Run => "run",
            Self::Hold => "hold",
            Self::Dwell => "dwell",
            Self::Wait => "wait",
            Self::Stopping => "stopping",
            Self::Alarm => "alarm",
        }
    }

    fn from_raw(raw: u8) -> Option<Self> {
        Self::ALL.get(usize::from(raw)).copied()
    }
}

/// The board's flags.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct BoardFlags {
    /// Bit 0: feed hold.
    pub hold: bool,
    /// Bit 1: single block.
    pub single_block: bool,
    /// Bit 2: dry run.
    pub dry_run: bool,
    /// Bit 3: a program is under way.
    pub program: bool,
    /// Bit 4: an axis is synchronised with the spindle.
    pub locked: bool,
}

impl BoardFlags {
    const fn raw(self) -> u8 {
        self.hold as u8
            | (self.single_block as u8) << 1
            | (self.dry_run as u8) << 2
            | (self.program as u8) << 3
            | (self.locked as u8) << 4
    }

    const fn from_raw(raw: u8) -> Self {
        Self {
            hold: raw & 1 != 0,
            single_block: raw & 1 << 1 != 0,
            dry_run: raw & 1 << 2 != 0,
            program: raw & 1 << 3 != 0,
            locked: raw & 1 << 4 != 0,
        }
    }
}

/// TPDO1 of the board: its status.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BoardStatus {
    /// State of the machine.
    pub state: BoardState,
    /// The flags.
    pub flags: BoardFlags,
    /// Number of the present alarm; an alarm 0 does not exist.
    pub alarm: Option<u16>,
    /// Count of the last order that was taken.
    pub count: u8,
    /// Setpoints that were late for their SYNC. The frame holds at most 255.
    pub late: u32,
    /// Program credit: how much the sender may still send, in the unit of the program object. The frame holds at most
    /// 65535.
    pub credit: u32,
}

impl BoardStatus {
    /// The objects in its bytes.
    pub const MAPPING: [Mapped; 6] = [
        Mapped::new(0x5001, 2, 8),
        Mapped::new(0x5001, 3, 8),
        Mapped::new(0x5001, 4, 16),
        Mapped::new(0x5001, 5, 8),
        Mapped::new(0x5001, 6, 8),
        Mapped::new(0x5001, 7, 16),
    ];

    /// The frame of the board `node`.
    #[must_use]
    pub fn frame(self, node: NodeId) -> Frame {
        let [alarm, alarm_high] = self.alarm.unwrap_or(0).to_le_bytes();
        let credit = self.credit.min(u16::MAX.into()) as u16;
        let [credit, credit_high] = credit.to_le_bytes();
        Frame::of(
            CobId::of(Service::Tpdo1, node),
            [
                self.state as u8,
                self.flags.raw(),
                alarm,
                alarm_high,
                self.count,
                self.late.min(u8::MAX.into()) as u8,
                credit,
                credit_high,
            ],
        )
    }

    /// The board and its status, if `frame` is a TPDO1 with a state that [`BoardState`] has.
    #[must_use]
    pub fn decode(frame: &Frame) -> Option<(NodeId, Self)> {
        let (Service::Tpdo1, node) = frame.id().service()? else {
            return None;
        };
        let [state, flags, a, b, count, late, c, d] = frame.exactly()?;
        let alarm = u16::from_le_bytes([a, b]);
        Some((
            node,
            Self {
                state: BoardState::from_raw(state)?,
                flags: BoardFlags::from_raw(flags),
                alarm: (alarm != 0).then_some(alarm),
                count,
                late: late.into(),
                credit: u16::from_le_bytes([c, d]).into(),
            },
        ))
    }
}

/// TPDO2 of the board: its position in the program.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BoardPlace {
    /// Source line of the current move, from 1; 0: none.
    pub line: u32,
    /// Number of the current move, from 1; 0: none.
    pub number: u32,
}

impl BoardPlace {
    /// The objects in its bytes.
    pub const MAPPING: [Mapped; 2] = [Mapped::new(0x5001, 8, 32), Mapped::new(0x5001, 9, 32)];

    /// The frame of the board `node`.
    #[must_use]
    pub const fn frame(self, node: NodeId) -> Frame {
        let [a, b, c, d] = self.line.to_le_bytes();
        let [e, f, g, h] = self.number.to_le_bytes();
        Frame::of(CobId::of(Service::Tpdo2, node), [a, b, c, d, e, f, g, h])
    }

    /// The board and its place, if `frame` is a TPDO2.
    #[must_use]
    pub fn decode(frame: &Frame) -> Option<(NodeId, Self)> {
        let (Service::Tpdo2, node) = frame.id().service()? else {
            return None;
        };
        let [a, b, c, d, e, f, g, h] = frame.exactly()?;
        Some((
            node,
            Self {
                line: u32::from_le_bytes([a, b, c, d]),
                number: u32::from_le_bytes([e, f, g, h]),
            },
        ))
    }
}

/// TPDO3 of the board: the spindle, and the synchronism error of an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BoardSpindle {
    /// Angle at the last SYNC. The frame holds the fraction of a turn, in steps of 1/65536 turn, rounded down.
    pub angle: Turns,
    /// Measured speed.
    pub speed: MilliRpm,
    /// Setpoint minus the ideal axis position at the measured angle; `None` while nothing is synchronised. The frame
    /// holds ±327.67 µm, in steps of 10 nm, rounded towards zero.
    pub sync_error: Option<Length>,
}

impl BoardSpindle {
    /// The objects in its bytes.
    pub const MAPPING: [Mapped; 3] = [
        Mapped::new(0x5001, 0x0A, 16),
        Mapped::new(0x5001, 0x0B, 32),
        Mapped::new(0x5001, 0x0C, 16),
    ];
    const NOT_SYNCHRONISED: i16 = i16::MIN;
    const ERROR_STEP_NM: i64 = 10;
    /// Shift from 2⁻³² turn to 1/65536 turn.
    const ANGLE_SHIFT: u32 = 16;

    /// The frame of the board `node`.
    #[must_use]
    pub fn frame(self, node: NodeId) -> Frame {
        let [a, b] = ((self.angle.raw() >> Self::ANGLE_SHIFT) as u16).to_le_bytes();
        let [c, d, e, f] = self.speed.get().to_le_bytes();
        let steps = self.sync_error.map_or(Self::NOT_SYNCHRONISED, |error| {
            let most = i64::from(i16::MAX);
            (error.nm() / Self::ERROR_STEP_NM).clamp(most.saturating_neg(), most) as i16
        });
        let [g, h] = steps.to_le_bytes();
        Frame::of(CobId::of(Service::Tpdo3, node), [a, b, c, d, e, f, g, h])
    }

    /// The board and its spindle, if `frame` is a TPDO3.
    #[must_use]
    pub fn decode(frame: &Frame) -> Option<(NodeId, Self)> {
        let (Service::Tpdo3, node) = frame.id().service()? else {
            return None;
        };
        let [a, b, c, d, e, f, g, h] = frame.exactly()?;
        let steps = i16::from_le_bytes([g, h]);
        Some((
            node,
            Self {
                angle: Turns::from_raw(i64::from(u16::from_le_bytes([a, b])) << Self::ANGLE_SHIFT),
                speed: MilliRpm::new(i32::from_le_bytes([c, d, e, f])),
                sync_error: (steps != Self::NOT_SYNCHRONISED).then_some(Length::from_nm(
                    i64::from(steps).saturating_mul(Self::ERROR_STEP_NM),
                )),
            },
        ))
    }
}

#[cfg(test)]
mod tests;
