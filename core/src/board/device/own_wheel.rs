//! The handwheel at the board's own input: it asks as one at the bus does, with frames that are never late.
//!
//! Four inputs of the machine in a row, from 9048 on, are its switches: X, Z, ×10, ×100. In mode *wheel* it leads the axis
//! that is chosen, and a program that follows a wheel whichever is. Between two switches, with both or with none, it leads
//! nothing.
//!
//! A claim lives while the wheel is turned, and half a second after that: then others may move the axes. The next claim
//! begins where the wheel has stood, so no count is lost to it. A claim that was refused, or that an alarm has ended, is
//! not made again before the wheel has stood: what is turned on does not move anything after the reset.
//!
//! Must not know pins, or how an axis follows.

use super::values::ObjectValues;
use crate::bus::WheelRequest;
use crate::operating::{Led, OperatingMode, WheelFactor};
use crate::params::Params;

/// The session of the board's own wheel. Others have 1 to 254.
const SESSION: u8 = 255;

/// Time between two looks, as between two frames of a wheel at the bus.
const LOOK_MS: u16 = 20;
/// A wheel that has stood for so long leads nothing.
const REST_MS: u16 = 500;

/// What is known of the wheel.
#[derive(Debug, Default)]
pub struct OwnWheel {
    /// The count of the last look.
    count: u16,
    /// The beats of the last look and of the last count.
    looked: u16,
    turned: u16,
    claim: u8,
    /// What the claim is for, while it lives.
    leads: Option<Led>,
}

impl ObjectValues {
    /// The wheel at the board's own input stands at `count`, which wraps. True where it asks for anything.
    pub fn own_wheel(&mut self, count: u16, params: &Params) -> bool {
        let now = self.operating.beat().ms();
        let wheel = &mut self.own_wheel;
        if now.wrapping_sub(wheel.looked) < LOOK_MS {
            return false;
        }
        wheel.looked = now;
        let before = core::mem::replace(&mut wheel.count, count);
        let Some((leads, factor)) = self.chosen(params) else {
            self.own_wheel.leads = None;
            return false;
        };
        let has_turned = count != before;
        let wheel = &mut self.own_wheel;
        if has_turned {
            wheel.turned = now;
        } else if now.wrapping_sub(wheel.turned) >= REST_MS {
            wheel.leads = None;
        }
        if wheel.leads != Some(leads) {
            if !has_turned {
                return false;
            }
            wheel.leads = Some(leads);
            wheel.claim = wheel.claim.wrapping_add(1);
            self.ask(leads, factor, before, params);
        }
        self.ask(leads, factor, count, params);
        true
    }

    fn ask(&mut self, leads: Led, factor: WheelFactor, count: u16, params: &Params) {
        let request = WheelRequest {
            session: SESSION,
            leads,
            factor,
            claim: self.own_wheel.claim,
            count,
            echo: self.operating.beat(),
        };
        self.wheel(&request, params);
    }

    /// What its switches choose, where the machine is in a mode for it.
    fn chosen(&self, params: &Params) -> Option<(Led, WheelFactor)> {
        let first = params.wheel_inputs().checked_sub(1)?;
        let known = self.snapshot.machine_known.checked_shr(first)?;
        let switches = self.snapshot.machine_inputs.checked_shr(first)?;
        if known & 0b1111 != 0b1111 {
            return None;
        }
        let axis = match switches & 0b11 {
            0b01 => Led::X,
            0b10 => Led::Z,
            _ => return None,
        };
        let factor = match switches & 0b1100 {
            0b0000 => WheelFactor::One,
            0b0100 => WheelFactor::Ten,
            0b1000 => WheelFactor::Hundred,
            _ => return None,
        };
        if self.operating.by_wheel() {
            return Some((Led::Path, factor));
        }
        (self.operating.mode() == OperatingMode::Wheel).then_some((axis, factor))
    }
}
