//! System variables: what a macro may ask of the program's state.

use leadscrew_core::call::FeedRate;
use leadscrew_core::program::InForce;
use leadscrew_core::units::Length;

use super::{Acting, Core};
use crate::value::Value;
use crate::variables::{System, Written};

impl Core<'_> {
    /// A length in the unit in force.
    fn shown(&self, length: Length) -> f64 {
        let unit = if self.interpreter.is_inch() {
            25_400_000.0
        } else {
            1_000_000.0
        };
        length.nm() as f64 / unit
    }

    /// F as it would be written.
    fn feed(&self, now: &InForce) -> Option<f64> {
        Some(match now.feed? {
            FeedRate::PerMinute(feed) => self.shown(Length::from_nm(feed.nm_per_min())),
            FeedRate::PerTurn(feed, _) => self.shown(Length::from_nm(feed.nm())),
        })
    }

    /// The value of a system variable.
    fn system(&self, number: u32) -> Option<Value> {
        let now = self.interpreter.in_force();
        let at = self.interpreter.position();
        let (x, z, c) = (at.x, at.z, at.c.udeg());
        let zero = now.origin;
        let number = match number {
            4001 => now.motion.into(),
            4002 => 97.0 - f64::from(u8::from(now.surface.is_some())),
            4005 => 98.0 + f64::from(u8::from(now.per_turn)),
            4007 => self.path.code().into(),
            4006 => 21.0 - f64::from(u8::from(self.interpreter.is_inch())),
            4014 => now.system.into(),
            4016 => now.plane.into(),
            4109 => return Some(self.feed(&now).map_or(Value::Null, Value::Number)),
            4114 => self.interpreter.sequence_number().unwrap_or(0).into(),
            4115 => self.interpreter.program_number().unwrap_or(0).into(),
            4119 => match now.surface {
                // Metres or feet a minute.
                Some(speed) => {
                    self.shown(Length::from_nm(speed.nm_per_min()))
                        / if self.interpreter.is_inch() {
                            12.0
                        } else {
                            1000.0
                        }
                }
                None => now.speed.into(),
            },
            4120 => self.tool.unwrap_or(0).into(),
            // What comes next is read after the board has got there, so the present place is that of the block's end.
            5001 | 5041 => self.shown(x - zero.x) * 2.0,
            5002 | 5042 => self.shown(z - zero.z),
            5003 | 5043 => (c - zero.c.udeg()) as f64 / 1e6,
            5021 => self.shown(x) * 2.0,
            5022 => self.shown(z),
            5023 => c as f64 / 1e6,
            5221..=5322 => {
                let (system, axis) = ((number - 5221) / 20, (number - 5221) % 20);
                let [x, z] = self.interpreter.offsets().work(system as u8);
                match axis {
                    0 => self.shown(x) * 2.0,
                    1 => self.shown(z),
                    _ => return None,
                }
            }
            _ => return None,
        };
        Some(Value::Number(number))
    }
}

impl System for Acting<'_, '_> {
    fn read(&mut self, number: u32) -> Option<Value> {
        self.core.system(number)
    }

    fn write(&mut self, number: u32, _value: Value) -> Written {
        match self.core.system(number) {
            Some(_) => Written::ReadOnly,
            None => Written::Unknown,
        }
    }
}
