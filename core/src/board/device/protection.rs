//! The password that protects parameters [D118]: against mistakes, not against attackers, who can read it on the wire.
//!
//! The right password opens writing. Writing closes when the gateway has been silent for its time, or when the power goes.
//! After a wrong password no other is accepted for a second, after the next for two seconds, then four, up to a minute.

use crate::alarm::{Alarm, Arg, Code};
use crate::bus::Periods;
use crate::params::Params;

/// The longest wait after a wrong password.
const LONGEST_WAIT_S: u32 = 60;

/// Without supervision of the gateway's heartbeat (9024 = 0), the gateway counts as silent after this time.
const SILENCE_MS: u32 = 60_000;

#[derive(Debug, Default)]
pub struct WriteProtection {
    open: bool,
    /// Time since the last frame of the gateway.
    silent: Periods,
    /// Wrong passwords in a row.
    wrong: u32,
    /// Time until the next password is accepted.
    wait: Periods,
}

impl WriteProtection {
    /// The gateway has sent a frame.
    pub const fn hear(&mut self) {
        self.silent = Periods::new(0);
    }

    /// Lets time pass.
    pub fn elapse(&mut self, by: Periods, params: &Params) {
        self.wait = self.wait.minus(by);
        self.silent = self.silent.plus(by);
        let limit = match params.gateway_silence_ms() {
            0 => SILENCE_MS,
            ms => ms,
        };
        self.open &= periods(limit, params) > self.silent;
    }

    /// True where parameters may be written.
    pub const fn is_open(&self, params: &Params) -> bool {
        self.open || params.parameter_password() == 0
    }

    /// Tries a password.
    ///
    /// # Errors
    /// [`Code::PasswordWrong`], also for a password that comes too soon.
    pub fn knock(&mut self, password: u32, params: &Params) -> Result<(), Alarm> {
        if self.wait == Periods::new(0) {
            if password == params.parameter_password() || params.parameter_password() == 0 {
                self.open = true;
                self.wrong = 0;
                return Ok(());
            }
            self.open = false;
            self.wait = periods(wait_s(self.wrong).saturating_mul(1000), params);
            self.wrong = self.wrong.saturating_add(1);
        }
        let seconds = wait_s(self.wrong.saturating_sub(1));
        let args = [Arg::Int(self.wrong.into()), Arg::Int(seconds.into())];
        Err(Alarm::of(Code::PasswordWrong, &args))
    }
}

/// Seconds to wait after a wrong password, with so many wrong ones before it.
fn wait_s(before: u32) -> u32 {
    let seconds = 1_u32.checked_shl(before).unwrap_or(LONGEST_WAIT_S);
    seconds.min(LONGEST_WAIT_S)
}

fn periods(ms: u32, params: &Params) -> Periods {
    Periods::from_ms(ms, params.tick_us()).unwrap_or_default()
}
