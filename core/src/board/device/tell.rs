//! The frames that a device sends by itself or has to send: answers, heartbeats, emergencies, statuses.
//!
//! Received frames are not read here.

use super::Device;
use super::served::Served;
use super::values::Told;
use crate::alarm::Code;
use crate::bus::{Emcy, Frame, Periods};
use crate::params::Params;

/// Emergency codes of CiA 301: "voltage inside the device", "device hardware", "internal software", "CAN in error passive
/// mode", "heartbeat error", "recovered from bus-off".
const VOLTAGE: u16 = 0x3200;
const HARDWARE: u16 = 0x5000;
const SOFTWARE: u16 = 0x6100;
const ERROR_PASSIVE: u16 = 0x8120;
pub(super) const HEARTBEAT_ERROR: u16 = 0x8130;
const RECOVERED: u16 = 0x8140;

impl Device {
    /// The next frame to send, after the frames of the tick: emergencies and statuses before answers.
    pub fn transmit(&mut self) -> Option<Frame> {
        if self.controller.state.is_cut_off() {
            return None;
        }
        self.urgent.pop_front().or_else(|| self.answers.pop_front())
    }

    pub(super) fn say(&mut self, frame: Frame) {
        // The bus takes no frame: newer frames replace older ones.
        if self.urgent.is_full() {
            self.urgent.pop_front();
        }
        let _ = self.urgent.push_back(frame);
    }

    pub(super) fn answer(&mut self, frame: Frame) {
        // A client waits for one answer at a time. Only blocks are longer, and they ask for room first.
        let _ = self.answers.push_back(frame);
    }

    pub(super) fn tell_alarms(&mut self) {
        let code = self.values.snapshot.alarm().map(|alarm| alarm.code);
        if self.told == code {
            return;
        }
        self.told = code;
        match code {
            Some(code) => {
                let mut emcy = Emcy::of_alarm(code.number());
                emcy.code = match code {
                    Code::GatewayLost => HEARTBEAT_ERROR,
                    Code::BusPassive => ERROR_PASSIVE,
                    Code::BusOff => RECOVERED,
                    Code::BusRestricted => HARDWARE,
                    Code::PowerDropped => VOLTAGE,
                    Code::FirmwareHung
                    | Code::FirmwareFault
                    | Code::FirmwarePanic
                    | Code::FirmwareStack
                    | Code::FailsAgain => SOFTWARE,
                    _ => emcy.code,
                };
                if let Code::BusPassive | Code::BusOff = code {
                    let errors = self.controller.errors;
                    let [low, high, ..] = emcy.detail;
                    emcy.detail = [low, high, errors.sending, errors.receiving, 0];
                }
                self.values.emcy.raise(emcy);
            }
            None => self.values.emcy.clear(),
        }
    }

    pub(super) fn transfer(&mut self, elapsed: Periods, params: &Params) {
        let mut served = Served {
            values: &mut self.values,
            params,
        };
        if let Some(abort) = self.sdo.elapse(elapsed, &mut served) {
            let _ = self.answers.push_back(abort);
        }
        while !self.answers.is_full()
            && let Some(segment) = self.sdo.poll(&mut served)
        {
            let _ = self.answers.push_back(segment);
        }
    }

    pub(super) fn heartbeat(&mut self, elapsed: Periods, params: &Params) {
        if self.values.heartbeat.elapse(elapsed) {
            let heartbeat = self.nmt.heartbeat();
            self.say(heartbeat);
        }
        if !self.values.watch.elapse(elapsed).is_empty() {
            self.lose(params);
        }
        self.values.emcy.elapse(elapsed);
        if self.nmt.state().allows_emcy()
            && !self.controller.state.is_cut_off()
            && let Some(frame) = self.values.emcy.poll()
        {
            self.say(frame);
        }
    }

    pub(super) fn tell_status(&mut self, elapsed: Periods, params: &Params) {
        if !self.nmt.state().allows_pdo() {
            return;
        }
        for (place, told) in Told::ALL.into_iter().enumerate() {
            let (Some(pdo), Some(since)) =
                (self.values.pdos.sent(place), self.since.get_mut(place))
            else {
                break;
            };
            *since = since.plus(elapsed);
            let period = Periods::from_ms(pdo.event_ms().into(), params.tick_us());
            if pdo.is_valid() && pdo.event_ms() != 0 && period.is_some_and(|p| *since >= p) {
                *since = Periods::new(0);
                let frame = self.values.tell(told);
                self.say(frame);
            }
        }
    }
}
