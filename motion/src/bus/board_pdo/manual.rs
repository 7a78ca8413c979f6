//! The process data for moving by hand: presses and steps to the board, and the board's answer with its beat.
//!
//! | PDO | bytes | content |
//! |---|---|---|
//! | RPDO2 | 0 | session of the operator, 1–255 |
//! | | 1 | press: a new number for every press |
//! | | 2 | bits 0–3 axes, two each: X, Z; 01 towards plus, 10 towards minus. Bits 6–7 spindle 1, alone: 01 as M03, 10 as
//! | | | M04. All 0: released |
//! | | 3 | bit 0: rapid; not of the spindle |
//! | | 4–5 | speed of the slide in mm/min, of the spindle in rpm; 0: that of 9041, 9049 |
//! | | 6–7 | echo: the newest beat that the sender has heard |
//! | RPDO3 | 0 | session of the operator, 1–255 |
//! | | 1 | count: a new number for every step |
//! | | 2 | axis: 0 X, 1 Z |
//! | | 3–5 | way of the slide in 0.1 µm, signed |
//! | | 6–7 | echo |
//! | RPDO4 | 0 | session of the operator, 1–255 |
//! | | 1 | what the handwheel leads: 0 X, 1 Z, 2 a program along its path |
//! | | 2 | increments that a count is worth: 1, 10 or 100 |
//! | | 3 | claim: a new number for every claim |
//! | | 4–5 | count of the wheel; it wraps |
//! | | 6–7 | echo |
//! | TPDO5 | 0–1 | 5002h:01: beat, the board's time in ms |
//! | | 2 | 5002h:02: mode of operation of the machine, see [`OperatingMode`] |
//! | | 3 | 5002h:03: session that owns the jogging; 0: none |
//! | | 4 | 5002h:04: its last press, step or claim |
//! | | 5 | 5002h:05: what became of it, see [`PressState`] |
//! | | 6–7 | 5002h:06: number of the alarm for which the last request was refused; 0: none |
//!
//! A press is alive while its frames come: each carries an echo, and the board moves until the echo is older than the time
//! of 9040. So a frame that comes late, twice or out of order moves nothing. A press that has ended stays ended.

use super::order::Beat;
use crate::bus::frame::{CobId, Frame, NodeId, Service};
use crate::bus::mapping::Mapped;
use crate::operating::{Led, OperatingMode, PressState, Towards, WheelFactor};

/// RPDO2: a press, or its release.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct JogRequest {
    /// The operator who presses.
    pub session: u8,
    /// Number of the press.
    pub press: u8,
    /// Which way X is to go.
    pub x: Option<Towards>,
    /// Which way Z is to go.
    pub z: Option<Towards>,
    /// Which way the spindle is to turn, alone: plus as M03.
    pub spindle: Option<Towards>,
    /// At rapid instead of `speed`.
    pub rapid: bool,
    /// Speed of the slide in millimetres per minute, of the spindle in turns per minute; 0: the machine's own.
    pub speed: u16,
    /// The newest beat that the sender has heard.
    pub echo: Beat,
}

impl JogRequest {
    /// The frame to the board `node`.
    #[must_use]
    pub const fn frame(self, node: NodeId) -> Frame {
        const fn bits(towards: Option<Towards>) -> u8 {
            match towards {
                None => 0,
                Some(Towards::Plus) => 1,
                Some(Towards::Minus) => 2,
            }
        }
        let [a, b] = self.speed.to_le_bytes();
        let [c, d] = self.echo.ms().to_le_bytes();
        Frame::of(
            CobId::of(Service::Rpdo2, node),
            [
                self.session,
                self.press,
                bits(self.x) | bits(self.z) << 2 | bits(self.spindle) << 6,
                self.rapid as u8,
                a,
                b,
                c,
                d,
            ],
        )
    }

    /// The board and its request, if `frame` is an RPDO2 with bits that have a meaning.
    #[must_use]
    pub fn decode(frame: &Frame) -> Option<(NodeId, Self)> {
        let (Service::Rpdo2, node) = frame.id().service()? else {
            return None;
        };
        Some((node, Self::payload(frame)?))
    }

    /// The request in a frame that is known to carry one.
    pub fn payload(frame: &Frame) -> Option<Self> {
        const fn towards(bits: u8) -> Option<Option<Towards>> {
            match bits & 3 {
                0 => Some(None),
                1 => Some(Some(Towards::Plus)),
                2 => Some(Some(Towards::Minus)),
                _ => None,
            }
        }
        let [session, press, axes, flags, a, b, c, d] = frame.exactly()?;
        // An axis and the spindle would need a speed each.
        let spindle_alone = axes & 0x3F == 0 && flags == 0;
        let axes_alone = axes <= 0x0F && flags <= 1;
        if session == 0 || !spindle_alone && !axes_alone {
            return None;
        }
        Some(Self {
            session,
            press,
            x: towards(axes)?,
            z: towards(axes >> 2)?,
            spindle: towards(axes >> 6)?,
            rapid: flags != 0,
            speed: u16::from_le_bytes([a, b]),
            echo: Beat::new(u16::from_le_bytes([c, d])),
        })
    }

    /// Nothing is to move.
    #[must_use]
    pub const fn is_release(&self) -> bool {
        self.x.is_none() && self.z.is_none() && self.spindle.is_none()
    }
}

/// RPDO3: one step of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StepRequest {
    /// The operator who steps.
    pub session: u8,
    /// Number of the step.
    pub count: u8,
    /// Z, not X.
    pub on_z: bool,
    /// Way of the slide in 0.1 µm, within 24 bits with sign.
    pub way: i32,
    /// The newest beat that the sender has heard.
    pub echo: Beat,
}

impl StepRequest {
    /// The longest way in 0.1 µm: 838.8607 mm.
    pub const LONGEST: i32 = 0x7F_FFFF;

    /// The frame to the board `node`. A longer way is cut to the longest.
    #[must_use]
    pub fn frame(self, node: NodeId) -> Frame {
        let way = self
            .way
            .clamp(Self::LONGEST.saturating_neg(), Self::LONGEST);
        let [a, b, c, _] = way.to_le_bytes();
        let [d, e] = self.echo.ms().to_le_bytes();
        let on_z = u8::from(self.on_z);
        Frame::of(
            CobId::of(Service::Rpdo3, node),
            [self.session, self.count, on_z, a, b, c, d, e],
        )
    }

    /// The board and its request, if `frame` is an RPDO3 with an axis that a step can have.
    #[must_use]
    pub fn decode(frame: &Frame) -> Option<(NodeId, Self)> {
        let (Service::Rpdo3, node) = frame.id().service()? else {
            return None;
        };
        Some((node, Self::payload(frame)?))
    }

    /// The request in a frame that is known to carry one.
    pub fn payload(frame: &Frame) -> Option<Self> {
        let [session, count, axis, a, b, c, d, e] = frame.exactly()?;
        if session == 0 || axis > 1 {
            return None;
        }
        Some(Self {
            session,
            count,
            on_z: axis == 1,
            // The sign is in the 24th bit.
            way: i32::from_le_bytes([0, a, b, c]) >> 8,
            echo: Beat::new(u16::from_le_bytes([d, e])),
        })
    }
}

/// RPDO4: a handwheel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WheelRequest {
    /// The operator who turns it.
    pub session: u8,
    /// What it leads.
    pub leads: Led,
    /// What a count is worth.
    pub factor: WheelFactor,
    /// Number of the claim.
    pub claim: u8,
    /// Where the wheel is. It wraps.
    pub count: u16,
    /// The newest beat that the sender has heard.
    pub echo: Beat,
}

impl WheelRequest {
    /// The frame to the board `node`.
    #[must_use]
    pub const fn frame(self, node: NodeId) -> Frame {
        let [a, b] = self.count.to_le_bytes();
        let [c, d] = self.echo.ms().to_le_bytes();
        Frame::of(
            CobId::of(Service::Rpdo4, node),
            [
                self.session,
                self.leads as u8,
                self.factor as u8,
                self.claim,
                a,
                b,
                c,
                d,
            ],
        )
    }

    /// The board and its request, if `frame` is an RPDO4 with something to lead and a factor that a wheel can have.
    #[must_use]
    pub fn decode(frame: &Frame) -> Option<(NodeId, Self)> {
        let (Service::Rpdo4, node) = frame.id().service()? else {
            return None;
        };
        Some((node, Self::payload(frame)?))
    }

    /// The request in a frame that is known to carry one.
    pub fn payload(frame: &Frame) -> Option<Self> {
        let [session, leads, factor, claim, a, b, c, d] = frame.exactly()?;
        if session == 0 {
            return None;
        }
        Some(Self {
            session,
            leads: Led::from_raw(leads)?,
            factor: WheelFactor::from_raw(factor)?,
            claim,
            count: u16::from_le_bytes([a, b]),
            echo: Beat::new(u16::from_le_bytes([c, d])),
        })
    }
}

/// TPDO5 of the board: its beat, its mode, and what became of the last press.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BoardBeat {
    /// The board's time.
    pub beat: Beat,
    /// The mode.
    pub mode: OperatingMode,
    /// The session that owns the jogging; 0: none.
    pub session: u8,
    /// Number of its last press, step or claim.
    pub press: u8,
    /// What became of it.
    pub state: PressState,
    /// Number of the alarm for which the last request was refused; 0: none.
    pub refused: u16,
}

impl BoardBeat {
    /// The objects in its bytes.
    pub const MAPPING: [Mapped; 6] = [
        Mapped::new(0x5002, 1, 16),
        Mapped::new(0x5002, 2, 8),
        Mapped::new(0x5002, 3, 8),
        Mapped::new(0x5002, 4, 8),
        Mapped::new(0x5002, 5, 8),
        Mapped::new(0x5002, 6, 16),
    ];
    /// Identifier of node 0. CiA 301 leaves 680h to 6DFh free.
    pub const BASE: u16 = 0x680;
    /// The highest node with an identifier of its own in that range.
    pub const LAST_NODE: u8 = 31;

    /// The identifier of the board `node`.
    #[must_use]
    pub const fn id(node: NodeId) -> CobId {
        CobId::free(Self::BASE, node)
    }

    /// The frame of the board `node`.
    #[must_use]
    pub const fn frame(self, node: NodeId) -> Frame {
        let [a, b] = self.beat.ms().to_le_bytes();
        let [c, d] = self.refused.to_le_bytes();
        Frame::of(
            Self::id(node),
            [
                a,
                b,
                self.mode as u8,
                self.session,
                self.press,
                self.state as u8,
                c,
                d,
            ],
        )
    }

    /// The content, if `frame` is the TPDO5 of the board `node`.
    #[must_use]
    pub fn decode(frame: &Frame, node: NodeId) -> Option<Self> {
        if frame.id() != Self::id(node) {
            return None;
        }
        let [a, b, mode, session, press, state, c, d] = frame.exactly()?;
        Some(Self {
            beat: Beat::new(u16::from_le_bytes([a, b])),
            mode: OperatingMode::from_raw(mode)?,
            session,
            press,
            state: PressState::from_raw(state)?,
            refused: u16::from_le_bytes([c, d]),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NODE: NodeId = NodeId::BOARD;

    #[test]
    fn a_press_has_its_bytes() {
        let press = JogRequest {
            session: 7,
            press: 200,
            x: Some(Towards::Plus),
            z: Some(Towards::Minus),
            spindle: None,
            rapid: true,
            speed: 0x0102,
            echo: Beat::new(0x0304),
        };
        let frame = press.frame(NODE);
        assert_eq!(frame.id().get(), 0x301);
        assert_eq!(frame.payload(), [7, 200, 0b1001, 1, 2, 1, 4, 3]);
        assert_eq!(JogRequest::decode(&frame), Some((NODE, press)));
        let turn = JogRequest {
            x: None,
            z: None,
            spindle: Some(Towards::Minus),
            rapid: false,
            ..press
        };
        let frame = turn.frame(NODE);
        assert_eq!(frame.payload(), [7, 200, 0b1000_0000, 0, 2, 1, 4, 3]);
        assert_eq!(JogRequest::decode(&frame), Some((NODE, turn)));
        // Both ways at once, unknown axes, unknown flags, nobody, the spindle beside an axis, or at rapid.
        for bytes in [
            [1, 0, 3, 0, 0, 0, 0, 0],
            [1, 0, 16, 0, 0, 0, 0, 0],
            [1, 0, 1, 2, 0, 0, 0, 0],
            [0, 0, 1, 0, 0, 0, 0, 0],
            [1, 0, 0xC0, 0, 0, 0, 0, 0],
            [1, 0, 0x41, 0, 0, 0, 0, 0],
            [1, 0, 0x50, 0, 0, 0, 0, 0],
            [1, 0, 0x40, 1, 0, 0, 0, 0],
        ] {
            assert_eq!(JogRequest::decode(&Frame::of(frame.id(), bytes)), None);
        }
    }

    #[test]
    fn a_step_has_its_bytes_and_its_sign() {
        for way in [0, 1, -1, 10_000, -10_000, StepRequest::LONGEST] {
            let step = StepRequest {
                session: 1,
                count: 3,
                on_z: true,
                way,
                echo: Beat::new(9),
            };
            let frame = step.frame(NODE);
            assert_eq!(frame.id().get(), 0x401);
            assert_eq!(StepRequest::decode(&frame), Some((NODE, step)));
        }
    }

    #[test]
    fn a_wheel_has_its_bytes() {
        let wheel = WheelRequest {
            session: 3,
            leads: Led::Path,
            factor: WheelFactor::Hundred,
            claim: 9,
            count: 0xFFFE,
            echo: Beat::new(0x0102),
        };
        let frame = wheel.frame(NODE);
        assert_eq!(frame.id().get(), 0x501);
        assert_eq!(frame.payload(), [3, 2, 100, 9, 0xFE, 0xFF, 2, 1]);
        assert_eq!(WheelRequest::decode(&frame), Some((NODE, wheel)));
        // Nobody, an unknown axis, an unknown factor.
        for bytes in [
            [0, 0, 1, 0, 0, 0, 0, 0],
            [1, 3, 1, 0, 0, 0, 0, 0],
            [1, 0, 2, 0, 0, 0, 0, 0],
        ] {
            assert_eq!(WheelRequest::decode(&Frame::of(frame.id(), bytes)), None);
        }
    }

    #[test]
    fn the_beat_has_its_bytes() {
        let told = BoardBeat {
            beat: Beat::new(0x1234),
            mode: OperatingMode::Mdi,
            session: 9,
            press: 8,
            state: PressState::Limit,
            refused: 4502,
        };
        let frame = told.frame(NODE);
        assert_eq!(frame.id().get(), 0x681);
        assert_eq!(frame.payload(), [0x34, 0x12, 4, 9, 8, 3, 0x96, 0x11]);
        assert_eq!(BoardBeat::decode(&frame, NODE), Some(told));
        assert_eq!(BoardBeat::decode(&frame, NodeId::DRIVE_X), None);
    }
}
